"""A run that gets nowhere says so in seconds, not after the last of twenty million steps."""

from __future__ import annotations

import numpy as np
import pytest

import femstruct.impact.collocate as march
from femstruct.errors import NotConverged
from femstruct.impact.bodies import GROUND, Body, Clock, Contact, Link, Scene
from femstruct.impact.laws import Hertz
from femstruct.impact.simulate import simulate
from femstruct.modal.analytic import given_modes


def test_a_march_that_stalls_says_so_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """25 000 periods in one sample, and steps for a sixth more than the 50 000 that are looked at, as if each sample of
    a long run were to take all of its steps. No scene is known that does it by itself."""
    monkeypatch.setattr(march, "MAX_STEPS", 60_000)
    bodies = (Body("mite", 1.0, 1e-3), Body("ball", 1.0))
    links = (Link("spring", "mite", GROUND, (2 * np.pi * 25_000.0) ** 2),)
    scene = Scene(bodies, (Contact("wall", "ball", GROUND, Hertz(1.0), gap=1.0),), links)
    with pytest.raises(NotConverged, match=r"no progress in 50000 steps at t = 0\.\d+ s, .* contact 'wall'"):
        simulate(given_modes([], [], {})[0], scene, Clock(1.0, 1.0))
