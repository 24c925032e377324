"""What `export` and `mac` do: matrices and modes to other programs, measured modes from them."""
