"""What shells, slabs and solids are made of: what parts of mesh files have in common, thickness, surfaces, stresses."""
