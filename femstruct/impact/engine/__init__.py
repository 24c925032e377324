"""What both marches share: records of the kernels, tables of modes, motion, forces, energies, booking."""
