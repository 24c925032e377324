"""Every contact law against scipy's DOP853, the laws written out again; the ledger; other steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import minimize_scalar

from femstruct.impact.scene import GROUND, Body, Clock, Contact, HalfSine, Link, Load, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.cubic import Cubic
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.lankarani_nikravesh import LankaraniNikravesh
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.laws.tabulated import Tabulated
from femstruct.modal.closed_form import given_modes

NONE = given_modes([], [], {})[0]
Force = Callable[[float, float], float]  # of indentation and its rate, without a clamp
DEPTHS = np.array([0.0, 0.2e-3, 0.5e-3, 1.1e-3, 1.6e-3, 2.5e-3])
FORCES = np.array([0.0, 40.0, 160.0, 300.0, 900.0, 2500.0])
CURVE = PchipInterpolator(DEPTHS, FORCES)

LAWS: dict[str, tuple[Law, Force]] = {
    "hertz": (Hertz(1e8), lambda d, u: 1e8 * d**1.5),
    "hertz with dashpot": (Hertz(1e8, 2e4), lambda d, u: d**0.5 * (1e8 * d + 2e4 * u)),
    "linear": (Linear(5e5, 120.0), lambda d, u: 5e5 * d + 120.0 * u),
    "linear that pulls": (Linear(5e5, 120.0, True), lambda d, u: 5e5 * d + 120.0 * u),
    "hunt-crossley": (HuntCrossley(1e8, 1.5, 0.3), lambda d, u: 1e8 * d**1.5 * (1 + 0.3 * u)),
    "hunt-crossley of 2.2": (HuntCrossley(1e10, 2.2, 1.5), lambda d, u: 1e10 * d**2.2 * (1 + 1.5 * u)),
    "lankarani-nikravesh": (
        LankaraniNikravesh(1e8, 0.8, 2.5),
        lambda d, u: 1e8 * d**1.5 * (1 + 3 * (1 - 0.64) / 10 * u),
    ),
    "cubic": (Cubic(1e5, 3e11, 0.2), lambda d, u: (1e5 * d + 3e11 * d**3) * (1 + 0.2 * u)),
    "table": (Tabulated(DEPTHS, FORCES, 0.1, smooth=True), lambda d, u: float(CURVE(d)) * (1 + 0.1 * u)),
}
MASSES, SPEEDS = (0.2, 0.7), (-2.0, 0.5)


@pytest.mark.parametrize("name", LAWS)
def test_two_bodies_collide(name: str) -> None:
    """Peak force, contact time and rebound of a free collision, 1e-8; the ledger; other steps, the same answer."""
    law, force = LAWS[name]
    reduced, meeting = np.prod(MASSES) / sum(MASSES), SPEEDS[1] - SPEEDS[0]

    def rate(_: float, y: np.ndarray) -> list[float]:
        return [y[1], -force(max(y[0], 0.0), y[1]) / reduced]

    def opens(t: float, y: np.ndarray) -> float:
        beside = name.startswith(("linear", "hertz with")) and not name.endswith("pulls")
        # the sign of the force without its factor d^0.5, which is zero at the end as well
        return (force(y[0], y[1]) / y[0] ** 0.5 if beside else y[0]) if t > 0 and y[0] > 0 else (-1.0 if t > 0 else 1.0)

    opens.terminal, opens.direction = True, -1.0  # type: ignore[attr-defined]
    path = solve_ivp(
        rate, (0.0, 0.1), [0.0, meeting], "DOP853", events=opens, rtol=1e-13, atol=1e-18, dense_output=True,
        max_step=2e-5,
    )  # fmt: skip
    lasting, parting = path.t_events[0][0], -path.y_events[0][0][1]
    steps = [force(max(d, 0.0), u) for d, u in path.y.T]
    top = int(np.argmax(steps))
    peak = steps[top]
    if top > 0:
        peak = -minimize_scalar(
            lambda t: -force(*path.sol(t)), bounds=(path.t[top - 1], path.t[top + 1]), method="bounded",
            options={"xatol": 1e-12},
        ).fun  # fmt: skip
    scene = Scene((Body("a", MASSES[0], SPEEDS[0]), Body("b", MASSES[1], SPEEDS[1])), (Contact("c", "a", "b", law),))
    clock = Clock(1.5 * lasting, 200 / lasting)
    response = simulate(NONE, scene, clock)
    contact = response.contacts["c"]
    after = [response.bodies[body].velocity[-1] for body in "ab"]
    assert contact.peak_force == pytest.approx(peak, rel=1e-8)
    assert contact.first_open == pytest.approx(lasting, rel=1e-8)
    assert after[0] - after[1] == pytest.approx(parting, rel=1e-8)
    # rounding: 2e-15 here
    assert MASSES[0] * after[0] + MASSES[1] * after[1] == pytest.approx(np.dot(MASSES, SPEEDS), rel=1e-12)
    # smooth laws close to rounding of some hundred steps of an error of 1e-9 each at most
    assert response.ledger.residual < 1e-9
    lost = 0.5 * reduced * (meeting**2 - parting**2)
    # steps of 1e-9 and DOP853's: 1e-9 N m of rounding
    assert response.ledger.end.lost_contacts["c"] == pytest.approx(lost, rel=1e-7, abs=1e-9)
    for other in (Clock(clock.duration, 37 / lasting), replace(clock, tolerance=1e-10)):
        again = simulate(NONE, scene, other).contacts["c"]
        assert again.peak_force == pytest.approx(contact.peak_force, rel=1e-8)
        assert again.first_open == pytest.approx(contact.first_open, rel=1e-8)


PRESSED: dict[str, tuple[Law, Force]] = {
    "hunt-crossley": (HuntCrossley(1e7, 1.5, 4.0), lambda d, u: 1e7 * d**1.5 * (1 + 4.0 * u)),
    "cubic": (Cubic(1e4, 1e11, 4.0), lambda d, u: (1e4 * d + 1e11 * d**3) * (1 + 4.0 * u)),
    "table": (Tabulated(DEPTHS, FORCES, 4.0, smooth=True), lambda d, u: float(CURVE(d)) * (1 + 4.0 * u)),
}


@pytest.mark.parametrize("tensile", [False, True])
@pytest.mark.parametrize("name", PRESSED)
def test_torn_apart_faster_than_the_dashpot_lets_go(name: str, tensile: bool) -> None:
    """A body falls on a plate and is pulled off faster than 1 / chi: the clamp of a dashpot that is a factor.

    With the clamp there is no force while 1 + chi u < 0, and the spring's energy goes into its own dashpot; with
    tension the contact pulls. Two modes, a link and a load act as well.
    """
    law, force = PRESSED[name]
    law = replace(law, tensile=tensile)
    m, p = 0.3, np.array([1.2, -0.8])
    basis, points = given_modes([60.0, 700.0], [0.02, 0.02], {"p": list(p)})
    place = points["p"].probe("z")
    scene = Scene(
        (Body("b", m, -1.0),),
        (Contact("c", "b", place, law),),
        (Link("l", "b", GROUND, 2e3, 5.0, 5.0),),
        (Load("pull", "b", HalfSine(900.0, 150.0)),),
    )
    clock = Clock(0.006, 50e3)
    response = simulate(basis, scene, clock)
    w, c = basis.omega, np.diag(basis.time_damping)

    def contact_force(y: np.ndarray) -> float:
        d, u = p @ y[:2] - y[2], p @ y[3:5] - y[5]
        f = force(d, u) if d > 0 else 0.0
        return f if tensile else max(f, 0.0)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        f = contact_force(y)
        pull = 900.0 * np.sin(2 * np.pi * 150.0 * t) if t < 1 / 300 else 0.0
        body = (f + pull - 2e3 * y[2] - 5.0 * y[5]) / m
        return np.concatenate((y[3:], -p * f - w**2 * y[:2] - c * y[3:5], [body]))

    y = solve_ivp(
        rate, (0, response.t[-1]), [0, 0, 0, 0, 0, -1.0], "DOP853", t_eval=response.t, rtol=1e-11, atol=1e-15,
        max_step=5e-6,
    ).y  # fmt: skip
    felt = np.array([contact_force(one) for one in y.T])
    contact = response.contacts["c"]
    pulled = np.flatnonzero((contact.indentation > 1e-9) & (p @ y[3:5] - y[5] < -0.26))
    assert pulled.size > 3  # the case is what it says
    assert (felt[pulled] < 0).any() if tensile else (contact.force[pulled] == 0).all()
    # DOP853 steps over the kinks of clamp and load end
    assert np.abs(contact.force - felt).max() < 1e-6 * felt.max()
    # the same, once integrated: 6e-10 here
    assert np.abs(response.bodies["b"].velocity - y[5]).max() < 1e-8 * np.abs(y[5]).max()
    assert response.ledger.residual < 1e-9  # rounding: 4e-12 here
