"""A law of your own: the built-in one written again gives its numbers, and one that contradicts itself is refused."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt, tanh

import numpy as np
import pytest
from numba import njit

from femstruct.errors import FemstructError
from femstruct.impact.batch import simulate_batch
from femstruct.impact.response import Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.law import Law
from femstruct.laws.own import OwnLaw
from femstruct.modal.closed_form import given_modes

BASIS, POINTS = given_modes([60.0, 700.0], [0.02, 0.02], {"p": [1.2, -0.8]})


def hertz(d: float, rate: float, p: np.ndarray) -> float:
    return sqrt(d) * (p[0] * d + p[1] * rate)


def clamped(d: float, rate: float, p: np.ndarray) -> float:
    return max(0.0, sqrt(d) * (p[0] * d + p[1] * rate))


def held(d: float, p: np.ndarray) -> float:
    return 0.4 * p[0] * d**2.5


def own(k: float, c: float, force: Callable[..., float] = hertz) -> OwnLaw:
    return OwnLaw(force, held, [k, c], deepest=1e-3, fastest=5.0)


def scene(law: Law, preload: float = 0.0) -> Scene:
    hit = Contact("hit", "ball", POINTS["p"].probe("z"), law, preload=preload)
    return Scene((Body("ball", 0.3, -1.0),), (hit,))


def run(law: Law, preload: float = 0.0) -> Response:
    return simulate(BASIS, scene(law, preload), Clock(0.01, 1e5))


def assert_equal(mine: Response, other: Response, within: float) -> None:
    one, two = mine.contacts["hit"], other.contacts["hit"]
    assert one.peak_force == pytest.approx(two.peak_force, rel=within)
    assert [event.what for event in mine.events] == [event.what for event in other.events]
    for here, there in zip(mine.events, other.events, strict=True):
        assert here.t == pytest.approx(there.t, rel=within)
    assert np.abs(one.force - two.force).max() <= within * two.peak_force
    assert np.abs(mine.bodies["ball"].velocity - other.bodies["ball"].velocity).max() <= within
    lost, also = (one.ledger.end.lost_contacts["hit"] for one in (mine, other))
    assert lost == pytest.approx(also, rel=within, abs=within)
    assert mine.ledger.residual < 1e-10  # steps and rounding: 4e-13 here


@pytest.mark.parametrize("preload", [0.0, 30.0])
@pytest.mark.parametrize("c", [0.0, 2e4])
def test_hertz_of_your_own_is_hertz(c: float, preload: float) -> None:
    """With a dashpot that pulls; the preloaded one rings about its rest."""
    assert_equal(run(own(1e8, c), preload), run(Hertz(1e8, c, tensile=True), preload), 1e-9)


def test_a_clamp_of_your_own() -> None:
    """A bend inside the function is no event: steps are short there, 1e-7 is left, and it opens where d is zero."""
    mine, other = run(own(1e8, 2e4, clamped)), run(Hertz(1e8, 2e4))
    felt, also = mine.contacts["hit"], other.contacts["hit"]
    assert np.abs(felt.force - also.force).max() <= 1e-7 * also.peak_force
    assert np.abs(mine.bodies["ball"].velocity - other.bodies["ball"].velocity).max() <= 1e-7
    assert mine.ledger.end.lost_contacts["hit"] == pytest.approx(other.ledger.end.lost_contacts["hit"], rel=1e-7)
    assert felt.first_open is not None
    assert also.first_open is not None
    assert felt.first_open > also.first_open


def test_functions_that_are_compiled_already_and_batches() -> None:
    law = OwnLaw(njit(hertz), njit(held), [1e8, 0.0], deepest=1e-3, fastest=5.0)
    mine, other = (
        simulate_batch(BASIS, scene(one), Clock(0.01, 1e5), {"ball.velocity": [-0.5, -1.0, -2.0]})
        for one in (law, Hertz(1e8))
    )
    # the built-in law is taken with a longer tick: what an event may miss is below the tolerance, 1e-8
    assert mine.peak_force["hit"] == pytest.approx(other.peak_force["hit"], rel=1e-7)


def test_a_run_beyond_what_was_checked_is_told() -> None:
    shallow = OwnLaw(hertz, held, [1e8, 0.0], deepest=1e-4, fastest=5.0)
    assert "beyond-checked" in {found.code for found in run(shallow).findings}
    assert "beyond-checked" not in {found.code for found in run(own(1e8, 0.0)).findings}
    batch = simulate_batch(BASIS, scene(shallow), Clock(0.01, 1e5), {"ball.velocity": [-0.1, -1.0]})
    assert batch.flags["beyond-checked"].tolist() == [False, True]


def soft(d: float, rate: float, p: np.ndarray) -> float:
    return p[0] * d * (1.0 - d / 1e-3)  # largest at half a millimetre


def of_soft(d: float, p: np.ndarray) -> float:
    return p[0] * d * d * (0.5 - d / 3e-3)


def half(d: float, p: np.ndarray) -> float:
    return 0.5 * p[0] * d**2.5


def jumping(d: float, rate: float, p: np.ndarray) -> float:
    return p[0] * d**1.5 + 10.0 * rate


def driving(d: float, rate: float, p: np.ndarray) -> float:
    return p[0] * d**1.5 * (1.0 - 0.1 * tanh(rate))


def worded(d: float, rate: float, p: np.ndarray) -> float:
    return "much"  # type: ignore[return-value]


WRONG: list[tuple[Callable[..., float], Callable[..., float], str]] = [
    (soft, of_soft, r"force: got \d+\.?\d* N at 0\.00074\d+ m and rate 0, after .* expected a force that rises"),
    (hertz, half, r"energy: got a slope of 0\.00395285 J/m at 1e-07 m, where the force at rate 0 is .* N"),
    (jumping, held, r"force: got -50 N at 1e-12 m and -5 m/s, expected a force that starts at zero"),
    (
        driving,
        held,
        r"force: got .* N in addition to the spring at 1e-07 m and -5 m/s, expected a dashpot that dissipates energy",
    ),
    (worded, held, r"own law worded: got what numba cannot compile"),
]


@pytest.mark.parametrize(("force", "energy", "message"), WRONG, ids=lambda one: getattr(one, "__name__", ""))
def test_laws_that_contradict_themselves(
    force: Callable[..., float], energy: Callable[..., float], message: str
) -> None:
    with pytest.raises(FemstructError, match=message):
        OwnLaw(force, energy, [1e8, 0.0], deepest=1e-3, fastest=5.0)


def test_a_preload_beyond_the_deepest_is_refused() -> None:
    with pytest.raises(FemstructError, match=r"got 5000 N, expected at most 3162\.28 N, its force at the deepest"):
        run(own(1e8, 0.0), preload=5000.0)
    # steps and rounding: none here
    assert own(1e8, 0.0).indentation(100.0) == pytest.approx((100.0 / 1e8) ** (2 / 3), rel=1e-13)


def test_a_body_may_bounce_on_it() -> None:
    ground = Scene(
        (Body("ball", 0.3, -1.0, falls=True),), (Contact("hit", "ball", GROUND, own(1e8, 0.0)),), gravity=9.8
    )
    response = simulate(BASIS, ground, Clock(0.5, 1e4))
    assert response.contacts["hit"].closings == 3
    assert response.ledger.residual < 1e-10  # steps and rounding: 7e-13 here
