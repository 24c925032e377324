"""What a study file says, a noun a file: what is written, what is checked, what is made of it."""
