"""Files that other programs of structural dynamics read and write: matrices, universal files, tables, VTK."""
