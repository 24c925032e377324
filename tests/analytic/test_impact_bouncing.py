"""A ball that falls back under gravity bounces ever less and comes to rest, in finitely many bounces."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from femstruct.impact.laws.hertz import Hertz
from femstruct.impact.laws.linear import Linear
from femstruct.impact.result.response import Outcome, Response
from femstruct.impact.scene.bodies import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.modal.analytic import given_modes

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
