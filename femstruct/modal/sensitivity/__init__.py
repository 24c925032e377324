"""Derivatives by a parameter: of matrices, of natural frequencies and shapes, of frequency responses."""
