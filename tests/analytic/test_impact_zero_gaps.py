"""Starts and ends at which a gap, its rate and its acceleration are zero together: a wave under a boat.

The wave of section 5.2 is a half-sine: a boat at rest that touches what it carries begins with its third derivative,
what that carries with the fifth.
"""

from __future__ import annotations

import numpy as np
import pytest

import femstruct.impact.simulate as engine
from femstruct.arrays import Floats
from femstruct.impact.response import Response
from femstruct.impact.scene import Body, Clock, Contact, HalfSine, Load, Scene
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes

F, OMEGA = 1.0, 2.0 * np.pi  # of the wave: 1 N, 1 Hz


def under_a_wave(masses: list[float], stiffnesses: list[float], clock: Clock) -> Response:
    names = ["boat", "cargo", "parcel"][: len(masses)]
    bodies = tuple(Body(name, mass) for name, mass in zip(names, masses, strict=True))
    contacts = tuple(
        Contact(upper, upper, lower, Linear(k))
        for lower, upper, k in zip(names[:-1], names[1:], stiffnesses, strict=True)
    )
    wave = Load("wave", "boat", HalfSine(F, OMEGA / (2.0 * np.pi)))
    return engine.simulate(given_modes([], [], {})[0], Scene(bodies, contacts, (), (wave,)), clock)


def forces_of_three(masses: list[float], stiffnesses: list[float], t: Floats) -> Floats:
    """Forces of the two contacts of three bodies in a row, as long as both push.

    Indentations d: d'' = - S k d + (F / m1, 0) sin(omega t), S = [[1/m1 + 1/m2, -1/m2], [-1/m2, 1/m2 + 1/m3]]; with
    y = sqrt(k) d that is symmetric, and each of its modes is (sin(omega t) - omega / p sin(p t)) / (p^2 - omega^2).
    """
    m1, m2, m3 = masses
    root = np.sqrt(stiffnesses)
    inverse = np.array([[1.0 / m1 + 1.0 / m2, -1.0 / m2], [-1.0 / m2, 1.0 / m2 + 1.0 / m3]])
    squares, modes = np.linalg.eigh(root[:, None] * inverse * root)
    p = np.sqrt(squares)[:, None]
    push = modes.T @ (root * [F / m1, 0.0])
    answer = (np.sin(OMEGA * t) - OMEGA / p * np.sin(p * t)) / (p**2 - OMEGA**2)
    forces: Floats = root[:, None] * (modes @ (push[:, None] * answer))
    return forces


@pytest.fixture(params=["exact", "collocation"])
def march(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "is_piecewise_linear", lambda *_: request.param == "exact")


@pytest.mark.usefixtures("march")
@pytest.mark.parametrize(
    ("masses", "stiffnesses", "rounding"),
    [  # the smaller the indentation beside the displacement, the less of it is known: 1e-16 k x / force
        ([1.0, 0.6, 0.3], [133.0, 50.0], 1e-12),
        ([1.0, 0.6, 0.3], [1e3, 1e5], 1e-9),
        ([1.0, 1e-3, 0.3], [1e4, 0.1], 1e-8),  # what collocation allows a step
        ([1e-2, 1e-1, 1e2], [1e1, 1e6], 1e-7),
    ],
)
def test_three_bodies_that_touch_begin_in_turn(masses: list[float], stiffnesses: list[float], rounding: float) -> None:
    response = under_a_wave(masses, stiffnesses, Clock(0.45, 2e3))
    expected = forces_of_three(masses, stiffnesses, response.t)
    assert (expected[:, 1:] > -1e-9).all()  # what this formula holds for
    assert [(event.contact, event.what) for event in response.events] == [("cargo", "closes"), ("parcel", "closes")]
    # collocation sees the cargo's fifth-order indentation within the rounding of 1e-3 of a sample's
    assert response.events[1].t < 1e-6
    for name, force in zip(("cargo", "parcel"), expected, strict=True):
        assert np.abs(response.contacts[name].force - force).max() < rounding * np.abs(force).max()
    assert response.ledger.residual < 1e-12  # steps and rounding: 1e-14 here


@pytest.mark.usefixtures("march")
@pytest.mark.parametrize("ratio", [0.3, 0.6, 1.0])
def test_a_contact_that_ends_with_a_triple_zero_stays_at_rest(ratio: float) -> None:
    """With p = 3 omega the indentation is (F / m) sin^3(omega t) / (6 omega^2): zero with its rate and acceleration
    when the wave ends. Then boat and damper move on together; whether they touch is not to be known."""
    mass = ratio  # of a boat of 1 kg
    stiffness = 9.0 * OMEGA**2 / (1.0 + 1.0 / mass)
    response = under_a_wave([1.0, mass], [stiffness], Clock(2.0, 2e3))
    t = response.t
    force = np.where(t < 0.5, stiffness * F * np.sin(OMEGA * t) ** 3 / (6.0 * OMEGA**2), 0.0)
    # steps and rounding: 4e-13 here
    assert np.abs(response.contacts["cargo"].force - force).max() < 1e-12 * force.max()
    for body in ("boat", "cargo"):
        after = response.bodies[body].velocity[t > 0.5]
        assert np.abs(after - 2.0 * F / (OMEGA * (1.0 + mass))).max() < 1e-13  # the wave's impulse is 2 F / omega
    assert len(response.events) <= 3  # closes; may open within rounding of the end, and meet again
