"""Mesh files: one format a file, from bytes to what `femstruct.model.imported` makes a mesh of."""
