"""What plates are made of: their meshes, their motion, patches on them, their stresses."""
