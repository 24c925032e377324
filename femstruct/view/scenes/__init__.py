"""Three-dimensional pictures of structures and rooms."""
