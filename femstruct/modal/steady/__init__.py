"""Steady vibration of a structure: harmonic and random loads, and a base that moves."""
