"""Sparse symmetric systems: patterns, nested dissection, dense fronts, and the one interface to solvers."""
