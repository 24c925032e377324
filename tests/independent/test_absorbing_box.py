"""A box with an absorbing wall against plane waves in a tube, and without one against a piston by cosines of a wall."""

import numpy as np
import pytest

from tests.independent.absorbing_box import AbsorbingBox, admittance_of
from tests.independent.box_pistons import Piston, PistonsBox
from tests.independent.pistons import Tube

S = 2j * np.pi * np.array([5.0, 40.0, 86.0])


def test_a_tube_with_an_absorbing_floor() -> None:
    """Plane waves of the box are those of the tube."""
    tube = Tube(0.2, 2.0, gamma=4.0).per_velocity(S, 0.7, 1.21 * 343.0 / admittance_of(0.4) + 0 * S)
    only = AbsorbingBox((1e-3, 1e-3, 2.0), {"floor": {100.0: 0.4}}, 420.0 * 40, gamma=4.0)
    found = only.per_velocity(S, Piston("ceiling", (0.0, 0.0), (1e-3, 1e-3)), (0.0, 0.0, 0.7))
    assert found == pytest.approx(tube, rel=5e-3)  # modes end at 200: 1 / 200 of what the floor adds


def test_rigid_walls() -> None:
    size, moved, place = (1.3, 1.0, 0.8), Piston("x1", (0.2, 0.1), (0.5, 0.6)), (0.4, 0.3, 0.2)
    wanted = PistonsBox(size, gamma=6.0).at(S, [moved], place)[0]
    assert AbsorbingBox(size, {}, 3000.0, gamma=6.0).per_velocity(S, moved, place) == pytest.approx(
        wanted, rel=3e-3
    )  # modes end
