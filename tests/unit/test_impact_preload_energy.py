"""Energy of a preloaded contact near its rest: of motions that are small beside its indentation, by 50 digits."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from femstruct.impact.collocation import state_at_start
from femstruct.impact.energies import stored
from femstruct.impact.propagation import CLOSED
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.impact.system import compile_scene
from femstruct.laws.cubic import Cubic
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes

FREE = given_modes([], [], {})[0]
PRELOAD = 4.2
SPRINGS = {
    Linear(2e6): lambda d: mp.mpf(2e6) * d,
    Hertz(2.77e9): lambda d: mp.mpf(2.77e9) * d ** mp.mpf(1.5),
    Cubic(1e5, 1e13): lambda d: mp.mpf(1e5) * d + mp.mpf(1e13) * d**3,
    HuntCrossley(1e9, 1.5): lambda d: mp.mpf(1e9) * d ** mp.mpf(1.5),
}


@pytest.mark.parametrize("law", SPRINGS)
@pytest.mark.parametrize("share", [1.0, 1e-3, -1e-3, 1e-9, -0.999, -1.5])
def test_energy_beside_rest_is_the_integral_of_the_force(law: Law, share: float) -> None:
    scene = Scene((Body("part", 1.0),), (Contact("clamp", GROUND, "part", law, preload=PRELOAD),))
    compiled = compile_scene(FREE, scene, Clock(1.0, 1.0))
    state = state_at_start(compiled)
    state.status[0] = CLOSED
    rest = float(compiled.system.interfaces["offset"][0])
    moved = share * rest
    with mp.workdps(50):
        push = SPRINGS[law]
        at_rest = push(mp.mpf(rest))  # the preload to the digits of its indentation
        bends = [mp.mpf(0), max(mp.mpf(moved), -mp.mpf(rest)), mp.mpf(moved)]
        expected = mp.quad(lambda x: push(max(mp.mpf(rest) + x, mp.mpf(0))) - at_rest, bends)
    # the law without a formula of its own is a difference of energies
    allowed = 1e-13 if not isinstance(law, HuntCrossley) else 1e-15 / share**2
    assert stored(compiled.system, state, 0, moved) == pytest.approx(float(expected), rel=allowed)


@pytest.mark.parametrize("law", [Linear(2e6), Hertz(2.77e9)])
def test_a_ledger_of_attojoules_beside_a_clamp(law: Law) -> None:
    """1 mg on a clamp of 4.2 N at 1e-7 m/s, 5e-21 J: the preload holds 1e15 times as much, and the ledger closes."""
    scene = Scene((Body("part", 1e-6, 1e-7),), (Contact("clamp", GROUND, "part", law, preload=PRELOAD),))
    response = simulate(FREE, scene, Clock(1e-3, 1e5))
    assert np.ptp(response.bodies["part"].velocity) > 1.9e-7  # it oscillates
    assert response.ledger.residual < 1e-6  # its force is known to 1e-16 of 4.2 N, over motions of 1e-13 m
