"""Rooms of any shape: their mesh, finite elements, absorbing and compliant walls, pressures, two-way coupling."""
