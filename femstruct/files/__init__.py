"""The only code that writes files, each whole or not at all: results, tables, sounds, meshes of room modes."""
