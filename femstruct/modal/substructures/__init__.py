"""Parts reduced to their interfaces."""
