"""What a model file says, a noun a file: what is written, what is checked, what is made of it."""
