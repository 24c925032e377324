"""Rooms of any shape: their mesh, finite elements, walls that take up sound or yield, pressures, air that pushes
back."""
