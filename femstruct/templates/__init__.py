"""Files to start from, as `femstruct new` writes them, and the writing."""
