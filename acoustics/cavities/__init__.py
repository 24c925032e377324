"""Air between two surfaces of one structure: boxes, wool in them, layers."""
