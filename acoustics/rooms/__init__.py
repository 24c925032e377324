"""Rectangular rooms: pressures by cosines, in time and harmonic, maps, and air that reacts on the structure."""
