"""Levels from statistical energies: infinite plates, their radiation, diffuse rooms; where modes are many."""
