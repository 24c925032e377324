"""Impacts with a solution on paper."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import gamma

from femstruct.impact.response import Outcome
from femstruct.impact.scene import GROUND, Body, Clock, Contact, HalfSine, Link, Load, Scene, Table
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.laws.stop import Stop
from femstruct.modal.closed_form import given_modes, oscillator

ROUNDING = 1e-12  # steps and rounding: 4e-15 here at most

NONE = given_modes([], [], {})[0]


def test_linear_rebound() -> None:
    """Half a period of contact, peak v sqrt(k m), speed reversed."""
    m, k, v = 0.7, 3.1e5, 1.3
    scene = Scene((Body("ball", m, -v),), (Contact("wall", "ball", GROUND, Linear(k)),))
    response = simulate(NONE, scene, Clock(0.02, 48e3))
    wall = response.contacts["wall"]
    # rounding: the contact is some 30 steps of exact motion
    assert wall.peak_force == pytest.approx(v * np.sqrt(k * m), rel=1e-11)
    assert wall.first_open == pytest.approx(np.pi * np.sqrt(m / k), rel=ROUNDING)
    assert response.bodies["ball"].velocity[-1] == pytest.approx(v, rel=1e-13)  # steps and rounding: none here
    assert response.outcome is Outcome.SEPARATED


@pytest.mark.parametrize("zeta", [0.02, 0.3, 0.9])
def test_restitution_of_a_clamped_dashpot(zeta: float) -> None:
    """e = exp(-2 zeta / sqrt(1 - zeta^2) atan(sqrt(1 - zeta^2) / zeta)) when the contact may not pull.

    Schwager and Poeschel, Granular Matter 9 (2007) 465: the ball leaves when the force, not the indentation, is zero.
    """
    m, k, v = 1.0, 1e4, 1.0
    law = Linear(k, damping=2 * zeta * np.sqrt(k * m))
    scene = Scene((Body("ball", m, -v),), (Contact("wall", "ball", GROUND, law),))
    response = simulate(NONE, scene, Clock(0.1, 10e3))
    root = np.sqrt(1 - zeta**2)
    assert response.bodies["ball"].velocity[-1] == pytest.approx(
        np.exp(-2 * zeta / root * np.arctan(root / zeta)), rel=ROUNDING
    )
    assert response.ledger.residual < 1e-12  # steps and rounding: 2e-14 here


@pytest.mark.parametrize("struck", [None, 0.3])
def test_hertz_rebound(struck: float | None) -> None:
    """delta_max = (5 m v^2 / 4 k)^(2/5), contact 4 sqrt(pi) Gamma(2/5) / (5 Gamma(9/10)) delta_max / v, m reduced."""
    m, k, v = 0.054, 3.7e5, 2.1
    reduced = m if struck is None else m * struck / (m + struck)
    bodies = (Body("ball", m, -v),) + (() if struck is None else (Body("other", struck),))
    scene = Scene(bodies, (Contact("touch", "ball", GROUND if struck is None else "other", Hertz(k)),))
    response = simulate(NONE, scene, Clock(0.02, 48e3))
    depth = (1.25 * reduced * v**2 / k) ** 0.4
    touch = response.contacts["touch"]
    assert touch.peak_force == pytest.approx(k * depth**1.5, rel=1e-9)  # steps and rounding: 2e-12 here
    # steps and rounding: 3e-13 here
    assert touch.first_open == pytest.approx(4 * np.sqrt(np.pi) * gamma(0.4) / (5 * gamma(0.9)) * depth / v, rel=1e-10)
    assert response.ledger.residual < 1e-9  # steps and rounding: 2e-12 here
    if struck is None:
        assert response.bodies["ball"].velocity[-1] == pytest.approx(v, rel=1e-9)  # steps and rounding: 1e-12 here
    else:
        # steps and rounding: 7e-13 here
        assert response.bodies["other"].velocity[-1] == pytest.approx(-2 * m * v / (m + struck), rel=1e-10)


def test_free_modes_of_every_damping() -> None:
    """Under-, critically and overdamped, undamped and rigid modes decay as on paper; samples do not need steps."""
    omega, zeta = np.array([0.0, 50.0, 50.0, 50.0, 2e5]), np.array([0.0, 0.0, 0.3, 1.0, 3.0])
    speed = np.array([5.0, 1.0, 2.0, 3.0, 4.0])
    basis = given_modes(list(omega / (2 * np.pi)), list(zeta), {"p": [1.0] * 5})[0]
    response = simulate(basis, Scene(velocity=speed), Clock(0.5, 1000.0))
    t = response.t
    ringing = 50.0 * np.sqrt(1 - 0.09)
    spread = np.sqrt(8.0) * 2e5
    exact = [
        5 * t,
        np.sin(50 * t) / 50,
        2 * np.exp(-15 * t) * np.sin(ringing * t) / ringing,
        3 * t * np.exp(-50 * t),
        4 * (np.exp((spread - 6e5) * t) - np.exp(-(spread + 6e5) * t)) / (2 * spread),
    ]
    for q, value in zip(response.q, exact, strict=True):
        assert np.abs(q - value).max() < 1e-13 * np.abs(value).max() + 1e-18  # rounding: 8e-16 here
    assert response.outcome is Outcome.NO_CONTACTS
    assert response.ledger.residual < 1e-12  # steps and rounding: 2e-14 here
    assert response.ledger.end.lost_modes == pytest.approx(
        0.5 * (4 * (1 - np.exp(-15.0)) + 9 + 16), rel=2e-6
    )  # the second mode keeps about exp(-15) of its energy; the third and fourth nothing


def test_half_sine_on_an_oscillator() -> None:
    """The response during and after a half-sine, and its work."""
    m, k, force, f = 2.0, 800.0, 3.0, 7.3
    basis, points = oscillator(m, stiffness=k, axis="z")
    load = Load("push", points["m"].probe("z"), HalfSine(force, f))
    response = simulate(basis, Scene(loads=(load,)), Clock(0.5, 2000.0))
    w, p = np.sqrt(k / m), 2 * np.pi * f
    x = response.q[0] / np.sqrt(m)
    t, end = response.t, 0.5 / f

    def during(s: np.ndarray) -> np.ndarray:
        return force / m / (w**2 - p**2) * (np.sin(p * s) - p / w * np.sin(w * s))

    after = np.where(t < end, during(t), during(t) + during(t - end))  # a second half-sine cancels the rest
    # the force is a polynomial good to the tolerance of 1e-9 in each step
    assert np.abs(x - after).max() < 1e-9 * np.abs(after).max()
    assert response.ledger.residual < ROUNDING
    assert response.ledger.end.work > 0


def test_table_is_straight_lines() -> None:
    """A ramp of force on a free body: exactly a cubic, then a straight line."""
    table = Table(np.array([0.0, 0.1, 0.3]), np.array([0.0, 2.0, 0.0]))
    response = simulate(NONE, Scene((Body("b", 0.5),), loads=(Load("ramp", "b", table),)), Clock(0.4, 1000.0))
    b, t = response.bodies["b"], response.t
    early = t <= 0.1
    assert np.allclose(b.displacement[early], 20.0 * t[early] ** 3 / 6 / 0.5, rtol=0, atol=1e-15)  # m, rounding
    assert b.velocity[-1] == pytest.approx(0.3 / 0.5, rel=1e-13)  # impulse: area of the triangle
    assert response.ledger.residual < 1e-13


def test_preloaded_contact_is_a_spring_until_it_opens() -> None:
    """Small motion about a preload is a linear spring of the tangent stiffness; the preload balances itself."""
    m, k, preload = 1.0, 1e4, 50.0
    contact = Contact("held", "b", GROUND, Linear(k), preload=preload)
    response = simulate(NONE, Scene((Body("b", m, -0.1),), (contact,)), Clock(0.2, 5000.0))
    w = np.sqrt(k / m)
    # m, rounding
    assert np.allclose(response.bodies["b"].displacement, -0.1 / w * np.sin(w * response.t), rtol=0, atol=1e-14)
    assert response.contacts["held"].peak_force == pytest.approx(preload + 0.1 * w * m, rel=ROUNDING)
    # "closed" is: above the preload; first below it after half a period
    assert response.ledger.at_separation is not None
    assert response.ledger.at_separation.t == pytest.approx(np.pi / w, rel=1e-8)  # seen 1e-9 of the preload late


def test_a_light_preload_opens_and_pulls_back() -> None:
    """Beyond the preload the body moves under the constant pull that the preload balanced at rest."""
    m, k, preload, v = 1.0, 1e4, 50.0, 2.0
    contact = Contact("held", "b", GROUND, Linear(k), preload=preload)
    response = simulate(NONE, Scene((Body("b", m, v),), (contact,)), Clock(0.1, 20e3))
    rest, w = preload / k, np.sqrt(k / m)
    opens = np.arcsin(rest * w / v) / w
    speed = np.sqrt(v**2 - (rest * w) ** 2)
    flight = 2 * speed * m / preload
    t, x = response.t, response.bodies["b"].displacement
    flying = (t > opens) & (t < opens + flight)
    s = t[flying] - opens
    assert np.abs(x[flying] - (rest + speed * s - 0.5 * preload / m * s**2)).max() < ROUNDING
    assert response.ledger.residual < 1e-12  # steps and rounding: 2e-14 here


def test_stop_on_both_sides() -> None:
    """A body between two bumpers: 4 g / v of flight and 2 pi / w of contact a period."""
    m, k, v, gap = 1.0, 1e6, 1.0, 0.01
    scene = Scene((Body("b", m, v),), (Contact("stop", "b", GROUND, Stop(k), gap=gap),))
    response = simulate(NONE, scene, Clock(0.2, 10e3))
    closings = [event.t for event in response.events if event.what == "closes"]
    half = 2 * gap / v + np.pi / np.sqrt(k / m)
    # rounding of sums of nine flights
    assert np.allclose(closings, gap / v + half * np.arange(len(closings)), rtol=1e-12, atol=0)
    assert len(closings) == 9
    force = response.contacts["stop"].force
    assert force.max() > 900.0  # pushed back from one side
    assert force.min() < -900.0  # and from the other


def test_released_link_pushes_off() -> None:
    """A compressed spring between two bodies, let go at a time between samples: energy to speed by the masses."""
    k, preload, at = 1e3, 20.0, 0.0503
    link = Link("charge", "up", "low", stiffness=k, release_at=at, preload=preload)
    scene = Scene((Body("up", 1.0), Body("low", 3.0)), links=(link,))
    response = simulate(NONE, scene, Clock(0.2, 1000.0))
    w = np.sqrt(k * (1 + 1 / 3))
    s = np.maximum(response.t - at, 0.0)
    apart = response.bodies["up"].displacement - response.bodies["low"].displacement
    assert np.abs(apart - preload / k * (1 - np.cos(w * s))).max() < 1e-13  # steps and rounding: 3e-15 here
    # steps and rounding: none here
    assert response.ledger.start.links["charge"] == pytest.approx(0.5 * preload**2 / k, rel=1e-14)
    assert response.ledger.residual < 1e-12  # steps and rounding: 2e-14 here


def test_one_way_dashpot_acts_one_way() -> None:
    """opening = c: a body thrown off decays as exp(-c t / m); closing = 0: thrown at, it does not."""
    out = simulate(NONE, Scene((Body("b", 2.0, 1.0),), links=(Link("d", "b", GROUND, opening=4.0),)), Clock(1.0, 100.0))
    assert np.abs(out.bodies["b"].velocity - np.exp(-2.0 * out.t)).max() < ROUNDING
    back = simulate(
        NONE, Scene((Body("b", 2.0, -1.0),), links=(Link("d", "b", GROUND, opening=4.0),)), Clock(1.0, 100.0)
    )
    assert np.abs(back.bodies["b"].velocity + 1.0).max() < 1e-14  # steps and rounding: none here
    assert (out.links["d"][1:] < 0).all()  # pulls: it resists moving apart


def test_falling_body_bounces() -> None:
    """Gravity works on bodies that fall: 2 v / g between bounces, and the work is in the ledger."""
    g, v = 9.81, 1.0
    scene = Scene((Body("b", 1.0, -v, falls=True),), (Contact("floor", "b", GROUND, Linear(1e8)),), gravity=g)
    response = simulate(NONE, scene, Clock(0.5, 1000.0))
    opens = [e.t for e in response.events if e.what == "opens"]
    closes = [e.t for e in response.events if e.what == "closes"]
    assert closes[1] - opens[0] == pytest.approx(2 * v / g, rel=ROUNDING)
    assert response.ledger.residual < 1e-12  # steps and rounding: 2e-14 here
    quiet = simulate(NONE, scene, Clock(0.5, 1000.0, quiet=0.3))
    assert response.ledger.at_separation is not None
    assert quiet.ledger.at_separation is None  # the next bounce comes within 0.3 s


def test_a_load_that_outlasts_the_window_by_far() -> None:
    """A free mass under sin(w t) with a half period of five hours: in 1 s it gains F (1 - cos w t) / (m w)."""
    basis, points = oscillator(2.0, frequency_hz=0.0, axis="z")
    place, w = points["m"].probe("z"), 2 * np.pi * 2.9e-5
    response = simulate(basis, Scene(loads=(Load("push", place, HalfSine(3.0, 2.9e-5)),)), Clock(1.0, 1e3))
    gained = 3.0 * (1.0 - np.cos(w * response.t[-1])) / (2.0 * w)
    # 1 - cos of a small angle, as told: 1e-13 here
    assert float(response.velocity(place.of(basis.shapes))[-1]) == pytest.approx(gained, rel=1e-11)
