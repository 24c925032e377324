"""Meshes and decks of other programs: one format a file, from bytes to an `ImportedMesh`."""
