"""Pistons in the walls of a box: reciprocity, and the compression of all the air; one in a ceiling is done by hand."""

import numpy as np
import pytest

from tests.independent.box_pistons import Piston, PistonsBox

SIZE = (3.0, 2.5, 2.0)
S = 2j * np.pi * np.array([3.0, 40.0, 90.0]) + 1.0


def test_forces_between_all_walls_are_mutual() -> None:
    """To the cosines that are left out: of walls that meet at an edge 1e-4."""
    walls = ("ceiling", "floor", "x0", "x1", "y0", "y1")
    pistons = [Piston(wall, (0.3 + 0.05 * n, 0.5), (0.9, 0.7)) for n, wall in enumerate(walls)]
    forces = PistonsBox(SIZE, gamma=5.0, tau=1e-5).between(S, pistons)
    off = np.abs(forces - np.swapaxes(forces, 1, 2)).max()
    assert off < 2e-4 * np.abs(forces).max()  # cosines of walls that meet end at 80
    slow = PistonsBox(SIZE, 340.0, 1.2).between(np.array([0.1j]), pistons)[0]
    assert slow == pytest.approx(np.full((6, 6), 1.2 * 340.0**2 * (0.9 * 0.7) ** 2 / (15.0 * 0.1j)), rel=1e-4)
