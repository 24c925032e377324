"""A ball that falls back under gravity bounces ever less and comes to rest, in finitely many bounces."""

from __future__ import annotations

from time import perf_counter

import numpy as np
import pytest
from scipy.optimize import brentq

from femstruct.impact.numerical_error import error_of, unresolved_findings
from femstruct.impact.response import Outcome, Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, End, Scene
from femstruct.impact.shares import mode_energies
from femstruct.impact.simulate import simulate
from femstruct.laws.cubic import Cubic
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.laws.tabulated import Tabulated
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes

ROUNDING = 1e-11  # steps and rounding: 7e-14 here at most

NONE = given_modes([], [], {})[0]
G = 9.81
M, K, V = 0.1, 1e6, 1.0
OMEGA = np.sqrt(K / M)


def restitution(zeta: float) -> float:
    """Of a spring and dashpot that may not pull: Schwager and Poeschel, Granular Matter 9 (2007) 465."""
    root = np.sqrt(1 - zeta**2)
    return float(np.exp(-2 * zeta / root * np.arctan2(root, zeta)))


def drop(zeta: float, duration: float, tolerance: float = 1e-8) -> Response:
    law = Linear(K, damping=2 * zeta * OMEGA * M)
    scene = Scene((Body("ball", M, -V, falls=True),), (Contact("floor", "ball", GROUND, law),), gravity=G)
    return simulate(NONE, scene, Clock(duration, 20e3, tolerance=tolerance))


def bounces(zeta: float) -> list[tuple[float, float]]:
    """Times at which the ball closes and opens its contact, piece by piece in closed form; the last one stays closed.

    In contact u = indentation - m g / k is a damped free vibration until k delta + c delta' = 0; then the ball flies.
    """
    sigma, ringing = zeta * OMEGA, OMEGA * np.sqrt(1 - zeta**2)
    t, delta, speed, found = 0.0, 0.0, V, []
    while True:
        u = delta - M * G / K

        def motion(s: float, u: float = u, speed: float = speed) -> tuple[float, float]:
            a, b = u, (speed + sigma * u) / ringing
            cosine, sine, decay = np.cos(ringing * s), np.sin(ringing * s), np.exp(-sigma * s)
            place = decay * (a * cosine + b * sine)
            return M * G / K + place, decay * ringing * (b * cosine - a * sine) - sigma * place

        def pull(s: float) -> float:
            place, rate = motion(s)
            return K * place + 2 * sigma * M * rate

        times = np.linspace(0.0, 6 * np.pi / ringing, 6001)[1:]
        below = [s for s in times if pull(s) < 0.0]
        if not below:
            found.append((t, np.inf))
            return found
        leaves = brentq(pull, below[0] - times[0], below[0], xtol=1e-18, rtol=1e-15)
        delta, speed = motion(leaves)
        found.append((t, t + leaves))
        # free flight until it touches again: either from above, or still indented and falling back
        fall = max(np.roots([0.5 * G, speed, delta]).real)
        assert speed < 0 and fall > 0 and speed**2 > 2 * G * delta  # it clears the floor
        t += leaves + fall
        delta, speed = 0.0, speed + G * fall


@pytest.mark.parametrize("zeta", [0.1, 0.2])
def test_every_bounce_is_where_it_should_be(zeta: float) -> None:
    expected = bounces(zeta)
    response = drop(zeta, 0.7, tolerance=1e-11)
    closes = [event.t for event in response.events if event.what == "closes"]
    opens = [event.t for event in response.events if event.what == "opens"]
    assert len(closes) == len(expected) == len(opens) + 1
    # 1e-10 s: errors of the leaving speed grow with the flights
    assert closes == pytest.approx([first for first, _ in expected], abs=1e-10)
    assert opens == pytest.approx([last for _, last in expected[:-1]], abs=1e-10)


@pytest.mark.parametrize("zeta", [0.05, 0.1, 0.3])
def test_a_ball_comes_to_rest_in_finitely_many_bounces(zeta: float) -> None:
    """It bounces while e^n v omega > g, about: the contact's own frequency is what ends the geometric series."""
    e = restitution(zeta)
    response = drop(zeta, 2.0 * V / G * e / (1 - e) + 0.4)
    closings = response.contacts["floor"].closings
    assert response.outcome is Outcome.RESTING
    assert "contact-closed-at-end" not in {finding.code for finding in response.findings}
    ends = np.log(V * OMEGA / G) / np.log(1 / e)
    # the weight takes its share of the last, slow contacts, so it ends a few bounces before that
    assert 0.75 * ends < closings <= ends + 1
    floor = response.contacts["floor"]
    assert floor.force[-1] == pytest.approx(M * G, rel=ROUNDING)
    assert floor.indentation[-1] == pytest.approx(M * G / K, rel=ROUNDING)
    assert response.ledger.residual < 1e-8  # the steps' tolerance: 1.5e-10 here
    # all it fell with is lost in the dashpot, and m g delta more; the spring keeps half of that
    lost = response.ledger.end.lost_contacts["floor"]
    assert lost == pytest.approx(0.5 * M * V**2 + 0.5 * (M * G) ** 2 / K, rel=ROUNDING)
    last = max(event.t for event in response.events)
    geometric = 2 * V / G * e / (1 - e)
    assert last == pytest.approx(geometric, rel=0.1)  # bounces of stiff contact: a series


def test_a_ball_comes_to_rest_on_an_oscillator() -> None:
    """10 kg on 1e5 N/m: in the end the ball's weight is on the spring, and sinks it by m g / K."""
    basis, points = given_modes([100.0 / (2 * np.pi)], [0.2], {"m": [1 / np.sqrt(10.0)]})
    place = points["m"].probe("z")
    ball = Body("ball", 0.5, -1.0, falls=True)
    scene = Scene((ball,), (Contact("c", "ball", place, Hertz(1e7, 3e3)),), gravity=G)
    response = simulate(basis, scene, Clock(2.0, 20e3))
    assert response.outcome is Outcome.RESTING
    assert response.contacts["c"].closings < 60
    assert response.contacts["c"].force[-1] == pytest.approx(0.5 * G, rel=ROUNDING)
    sunk = place.of(basis.shapes) @ response.q[:, -1]
    assert sunk == pytest.approx(-0.5 * G / 1e5, rel=ROUNDING)
    assert response.bodies["ball"].displacement[-1] == pytest.approx(sunk - (0.5 * G / 1e7) ** (2 / 3), rel=ROUNDING)
    assert response.ledger.residual < 1e-8  # the steps' tolerance: 1.5e-10 here


def test_in_the_middle_of_a_bounce_it_does_not_rest() -> None:
    """Contact of 1 ms, a window of 0.5 ms: closed for all of the last tenth, and far from rest."""
    response = drop(0.1, 5e-4)
    assert response.outcome is Outcome.CLOSED_AT_END
    assert "contact-closed-at-end" in {finding.code for finding in response.findings}


def test_without_gravity_nothing_rests() -> None:
    """A ram caught between the floor and a dashpot that has taken its speed: still a contact that is closed."""
    law = Linear(1e3, damping=2 * 5.0 * np.sqrt(1e3 * M), tensile=True)
    scene = Scene((Body("ball", M, -V),), (Contact("floor", "ball", GROUND, law),))
    assert simulate(NONE, scene, Clock(0.02, 20e3)).outcome is Outcome.CLOSED_AT_END


def lying(mass: float, law: Law, name: str = "x", end: End = GROUND) -> tuple[Body, Contact]:
    """A body that lies on its contact when the window begins."""
    return Body(name, mass), Contact(f"{name} lies", name, end, law, preload=mass * 9.80665)


@pytest.mark.parametrize("law", [Hertz(1e9), Hertz(3.3e7, 50.0), HuntCrossley(1e9, 1.5, 0.1), Linear(1.7e6, 100.0),
                                 Cubic(1e6, 3e11), Tabulated([0.0, 1e-3, 2e-3], [0.0, 70.0, 300.0])])  # fmt: skip
def test_what_lies_still_does_not_move_at_all(law: Law) -> None:
    """The rounding of a preload was a force for ever: 1e-16 m/s, and findings about it."""
    body, contact = lying(1.3, law)
    response = simulate(NONE, Scene((body,), (contact,), gravity=G), Clock(2.0, 1e3))
    assert response.outcome is Outcome.HELD
    assert not response.bodies["x"].velocity.any() and not response.findings
    assert response.contacts["x lies"].force[-1] == pytest.approx(1.3 * 9.80665, rel=ROUNDING)
    assert not unresolved_findings(error_of(response))


def test_a_body_that_lies_is_struck_and_lies_again() -> None:
    """0.1 kg at 2 m/s on 0.5 kg that lies on 2 kg on a spring of 20 Hz: all energy is lost by 20 s."""
    basis, points = given_modes([20.0], [0.03], {"m": [1 / np.sqrt(2.0)]})
    place = points["m"].probe("z")
    rest, lay = lying(0.5, Linear(5e5, 100.0), "rest", place)
    scene = Scene(
        (rest, Body("a", 0.1, -2.0, falls=True)), (lay, Contact("ca", "a", "rest", Hertz(1e8))), gravity=9.80665
    )
    response = simulate(basis, scene, Clock(20.0, 5e3))
    assert response.outcome is Outcome.RESTING
    assert "contact-closed-at-end" not in {one.code for one in response.findings}
    assert response.contacts["rest lies"].force[-1] == pytest.approx(0.6 * 9.80665, rel=1e-9)  # both weights


def test_a_clamp_that_has_come_to_rest_is_held() -> None:
    """A preloaded pad without gravity, hit once by a ball that flies off."""
    basis, points = given_modes([20.0], [0.3], {"m": [1.0]})
    pad = Contact("pad", "block", points["m"].probe("z"), Linear(1e6, 2e3), preload=5e3)
    scene = Scene((Body("block", 1.0), Body("ball", 0.01, -1.0)), (pad, Contact("hit", "ball", "block", Linear(1e6))))
    response = simulate(basis, scene, Clock(3.0, 5e3))
    assert response.outcome in (Outcome.HELD, Outcome.SEPARATED)  # its last event may be either, within rounding


@pytest.mark.parametrize("sampling", [100.0, 2e3, 20e3])
def test_energies_of_a_body_at_rest_are_found_at_once(sampling: float) -> None:
    """A stiff contact holds 1 kg on the ground, or on a structure that has come to rest: an integration to 3e-14 of
    1e-16 m/s had no end. The work of the weight ends in the spring and as heat."""
    law = Linear.returning(0.3, mass=1.0, stiffness=1e8)
    for basis, end in ((NONE, GROUND), _oscillating()):
        scene = Scene((Body("x", 1.0, -4.0, falls=True),), (Contact("c", "x", end, law),), gravity=G)
        response = simulate(basis, scene, Clock(5.0, sampling))
        begun = perf_counter()
        found = mode_energies(response)
        assert perf_counter() - begun < 5.0  # s; 0.1 s here
        # both are sums of the same energies: rounding of 1 J
        assert sum(one.energy for one in found.end) == pytest.approx(response.ledger.end.structure, abs=1e-13)


def _oscillating() -> tuple[ModalBasis, End]:
    basis, points = given_modes([50.0], [0.1], {"m": [1 / np.sqrt(10.0)]})
    return basis, points["m"].probe("z")
