"""Rectangular rooms: pressures by cosines, in time and harmonic, maps, and air that pushes back."""
