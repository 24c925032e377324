"""Impacts at the edge of rounding: each was refused once, found among random systems and cut down to what it is.

Their truths are closed forms, or the exact march beside collocation; ends are compared to the rounding they allow.
"""

from __future__ import annotations

import numpy as np
import pytest

import femstruct.impact.simulate as engine
from femstruct.impact.batch import simulate_batch
from femstruct.impact.contact_events import TRIALS
from femstruct.impact.response import Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Link, Scene
from femstruct.laws.hertz import Hertz
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.laws.stop import Stop
from femstruct.modal.closed_form import given_modes

FREE = given_modes([], [], {})[0]


def by_collocation(monkeypatch: pytest.MonkeyPatch, scene: Scene, clock: Clock) -> Response:
    with monkeypatch.context() as patch:
        patch.setattr(engine, "is_piecewise_linear", lambda *_: False)
        return engine.simulate(FREE, scene, clock)


def test_a_light_body_on_a_strong_dashpot_lets_go(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mite of 0.23 g on 10 N/m and 10.4 N s/m: after the impact it creeps back, and the contact would have to pull.

    It lets go where k x + c x' = -m x'' = 0. The force changes by 3e-20 N in a tick there, less than the last digit of
    the speed is worth: in steps of a tick the state stands still. x = v (e^-bt - e^-at) / (a - b) with
    a, b = (c +- sqrt(c^2 - 4 k m)) / 2 m, so that b^2 e^-bt = a^2 e^-at at t = 2 ln(a / b) / (a - b).
    """
    m, k, c, v = 2.3e-4, 10.0, 10.4, 1.88
    scene = Scene((Body("mite", m, v),), (Contact("floor", GROUND, "mite", Linear(k, c)),))
    clock = Clock(1e-3, 2e5)
    root = np.sqrt(c**2 - 4.0 * k * m)
    a = (c + root) / (2.0 * m)
    b = k / (m * a)
    t = 2.0 * np.log(a / b) / (a - b)
    speed = v * (a * np.exp(-a * t) - b * np.exp(-b * t)) / (a - b)
    for response in (engine.simulate(FREE, scene, clock), by_collocation(monkeypatch, scene, clock)):
        assert [event.what for event in response.events] == ["closes", "opens"]
        # the force, 4e-4 N of each law's part, is zero within 1e-18 N; it changes by 4e-4 N/s
        assert response.events[1].t == pytest.approx(t, abs=1e-13)
        # steps and rounding: 1e-17 here
        assert float(response.bodies["mite"].velocity[-1]) == pytest.approx(speed, rel=1e-13)
        assert response.ledger.residual < 1e-13


def test_a_light_body_lets_go_of_a_moving_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.1 g hits 20 kg that moves, on 10 N/m and 154 N s/m, 12.5 um from its start: it lets go, and creeps no more.

    As above with the reduced mass. The dashpot's rate of 1.5e6 1/s says nothing of what rounding of the displacement
    makes a speed: that is for the spring, with 0.07 1/s. Where it counted, the contact held and the body crept on:
    3.4e-12 m/s too fast at the end.
    """
    heavy, light, k, c, gap, u, v = 19.56, 1e-4, 10.0, 153.6, 1.25e-5, 0.936, 0.987
    scene = Scene(
        (Body("heavy", heavy, u), Body("light", light, u + v)), (Contact("c", "heavy", "light", Linear(k, c), gap=gap),)
    )
    m = heavy * light / (heavy + light)
    root = np.sqrt(c**2 - 4.0 * k * m)
    a = (c + root) / (2.0 * m)
    b = k / (m * a)
    t = 2.0 * np.log(a / b) / (a - b)
    drift = v * (a * np.exp(-a * t) - b * np.exp(-b * t)) / (a - b)
    end = u + light / (heavy + light) * v + heavy / (heavy + light) * drift
    response = engine.simulate(FREE, scene, Clock(1.3e-3, 1.5e5))
    assert [event.what for event in response.events] == ["closes", "opens"]
    # after it the force stays within 3e-13 N of zero: rounding of 1.9 m/s in c x', 6e-14 N, is a part of that
    assert response.events[1].t == pytest.approx(gap / v + t, rel=1e-2)
    # steps and rounding: 4e-16 here
    assert float(response.bodies["light"].velocity[-1]) == pytest.approx(end, abs=1e-14)


@pytest.mark.parametrize("exact", [True, False])
@pytest.mark.parametrize("damping", [0.0, 0.75])
@pytest.mark.parametrize("speed", [17.0, 100.0])
def test_a_preloaded_contact_that_travels_counts_its_turns(
    monkeypatch: pytest.MonkeyPatch, speed: float, damping: float, exact: bool
) -> None:
    """Two bodies pressed together swing on their contact while both fly: its force exceeds the preload every other
    half turn, though the rounding of where they are is worth more of it than 1e-9. Once 500000 closings by the exact
    march, and a refusal by collocation."""
    k, heavy, light, preload, turns = 1e9, 5.0, 1.0, 0.135, 40
    m = heavy * light / (heavy + light)
    omega = np.sqrt(k / m)
    v = 0.2 * preload / (m * omega)  # a fifth of the preload
    bodies = (Body("heavy", heavy, speed), Body("light", light, speed + v))
    scene = Scene(bodies, (Contact("c", "heavy", "light", Linear(k, damping), preload=preload),))
    end = (turns + 0.5) * np.pi / omega
    clock = Clock(end, 200 / end)
    response = engine.simulate(FREE, scene, clock) if exact else by_collocation(monkeypatch, scene, clock)
    assert [event.what for event in response.events] == ["closes", "opens"] * (turns // 2) + ["closes"]
    # the force must differ by 4e-15 of the places it is the difference of, or by 1e-9 of the preload, to be told
    late = 2.0 * (4e-15 * 2.0 * speed * end / v + 1e-9 * preload / (m * omega * v) / omega)
    zeta = damping / (2.0 * m * omega)
    expected = (np.arange(turns + 1) * np.pi - np.where(np.arange(turns + 1) > 0, 2.0 * zeta, 0.0)) / omega
    assert np.abs(np.array([event.t for event in response.events]) - expected).max() < late


def closings(monkeypatch: pytest.MonkeyPatch, scene: Scene, clock: Clock) -> set[int]:
    """Of the first contact, by every march that can."""
    runs = [engine.simulate(FREE, scene, clock), by_collocation(monkeypatch, scene, clock)]
    batch = simulate_batch(FREE, scene, clock, {f"{scene.bodies[0].name}.velocity": [scene.bodies[0].velocity]})
    name = scene.contacts[0].name
    return {run.contacts[name].closings for run in runs} | {int(batch.closings[name][0])}


@pytest.mark.parametrize("law", [Linear(1e6), Hertz(1e8), Stop(1e6), Stop(1e6, tensile=True)])
def test_what_is_set_down_on_a_spring_never_leaves_it(monkeypatch: pytest.MonkeyPatch, law: Law) -> None:
    """1 kg without speed on a spring swings by x = m g / k (1 - cos omega t), some 48 times: it only just touches after
    every turn. Linear springs had 46 closings by one march and 10 by the other, the shortest 80 ps long."""
    scene = Scene((Body("weight", 1.0, falls=True),), (Contact("floor", "weight", GROUND, law),), gravity=9.81)
    clock = Clock(0.3, 1e4)
    assert closings(monkeypatch, scene, clock) == {1}
    response = engine.simulate(FREE, scene, clock)
    assert [event.what for event in response.events] == ["closes"]
    assert response.contacts["floor"].first_open is None
    assert response.outcome is engine.Outcome.RESTING
    assert not response.findings


@pytest.mark.parametrize("zeta", [0.05, 0.3])
def test_a_stop_without_play_counts_until_nothing_is_left(monkeypatch: pytest.MonkeyPatch, zeta: float) -> None:
    """Thrown from one side of its stop to the other a body keeps a share of its speed, for ever: what is told are the
    times until its way is 1e-12 of what it was. It went on to 1e-74 of it, and no two marches counted alike.

    Of x'' + 2 delta x' + omega^2 x = 0 from x = 0 the force is zero, and the speed then exp(-delta t) of the first, at
    t = (pi - 2 asin(zeta)) / omega_d: x'' is the same wave, 2 acos(zeta) earlier.
    """
    m, k, v = 1e-3, 1e9, 0.8
    omega = np.sqrt(k / m)
    scene = Scene((Body("pin", m, v),), (Contact("stop", "pin", GROUND, Stop(k, 2.0 * zeta * m * omega)),))
    turned = 2.0 * np.arccos(zeta) / np.sqrt(1.0 - zeta**2)
    kept = np.exp(-zeta * turned)
    expected = np.log(1e-12) / np.log(kept)
    (found,) = closings(monkeypatch, scene, Clock(8e-3, 4e4))
    assert abs(found - expected) < 2.0  # what 1e-12 is of, the largest way, is seen to a part of it


@pytest.mark.parametrize("speed", [1e-4, 1e-6])
def test_forces_in_balance_leave_nothing_but_rounding(monkeypatch: pytest.MonkeyPatch, speed: float) -> None:
    """16 kg between two springs of 3 N each: it is pushed by what the other end gives, not by the rounding of 3 N."""
    bodies = (Body("middle", 16.0), Body("end", 100.0, -speed))
    links = (
        Link("upper", "end", "middle", 1.5e4, preload=3.0),
        Link("lower", "middle", GROUND, 9.5e5, opening=50.0, preload=3.0),
    )
    scene, clock = Scene(bodies, (), links), Clock(5e-3, 4e4)
    exact, steps = engine.simulate(FREE, scene, clock), by_collocation(monkeypatch, scene, clock)
    for body in ("middle", "end"):
        # rounding of 3 N gives the 16 kg 2e-16 m/s each step; a step's error is 1e-9 of the speed
        assert np.abs(steps.bodies[body].velocity - exact.bodies[body].velocity).max() < 1e-13
    assert steps.ledger.residual < 1e-13  # steps and rounding: 4e-16 here


def test_a_light_part_clamped_hard_takes_no_million_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.1 g held by 4.2 N: it moves with 3e-15 m/s, what its clamp's rounding would give it in a microsecond."""
    seen = []
    march = engine.collocate

    def counting(*args: object) -> engine.Ended:
        ended: engine.Ended = march(*args)  # type: ignore[arg-type]
        seen.append(float(args[4].totals[TRIALS]))  # type: ignore[attr-defined]
        return ended

    monkeypatch.setattr(engine, "collocate", counting)
    bodies = (Body("part", 1e-4), Body("hammer", 12.5, 1.4e-9))
    contacts = (
        Contact("clamp", "part", GROUND, Hertz(2.77e9, 306.9, True), preload=4.2),
        Contact("stop", "hammer", "part", Stop(10.0, 0.0, True)),
    )
    response = by_collocation(monkeypatch, Scene(bodies, contacts), Clock(6e-4, 3.2e5))
    assert float(response.bodies["hammer"].velocity[-1]) == pytest.approx(1.4e-9, rel=1e-8)  # 10 N/m and 12.5 kg
    assert seen[0] < 5000  # steps of some samples; they were two million, and half an hour where it moved by 1e-7 m/s


def test_a_hertz_contact_that_hardly_touches_has_a_force(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two bodies caught without play between Hertz and a stop come to rest: the last forces are lost in rounding.

    Momentum is kept.
    """
    heavy, light, v = 3.67e-3, 1e-4, -0.99
    bodies = (Body("heavy", heavy), Body("light", light, v))
    contacts = (
        Contact("one", "light", "heavy", Hertz(1.04e10, 15.87)),
        Contact("other", "heavy", "light", Stop(1e9, 69.7)),
    )
    response = engine.simulate(FREE, Scene(bodies, contacts), Clock(6.24e-4, 3.2e5))
    for name in ("heavy", "light"):
        # steps and rounding: 4e-13 here
        assert float(response.bodies[name].velocity[-1]) == pytest.approx(light * v / (heavy + light), rel=1e-10)
    assert response.ledger.residual < 1e-12  # steps and rounding: 4e-14 here


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_gap_of_1e_26_m_is_a_gap(side: float) -> None:
    """1 kg is drawn off its wall by a weak spring for 25 ns, and hit towards it by a dashpot: gap, then contact.

    The gap is k u t^3 / 6 at the hit; the dashpot's c v closes it after sqrt(2 gap / c v), 4 fs later.
    """
    k, u, gap, c, v = 2.8, 1.2e-3, 3.3e-8, 998.0, 1.3
    bodies = (Body("block", 1.0), Body("hammer", 1.6e-3, side * v), Body("far", 100.0, -side * u))
    ends, wall = (("block", "hammer"), (GROUND, "block")) if side > 0 else (("hammer", "block"), ("block", GROUND))
    contacts = (
        Contact("hit", ends[0], ends[1], Linear(3.14e6, c), gap=gap),
        Contact("wall", wall[0], wall[1], Linear(49.0)),
    )
    response = engine.simulate(FREE, Scene(bodies, contacts, (Link("spring", "block", "far", k),)), Clock(3.2e-3, 1e5))
    assert [(event.contact, event.what) for event in response.events] == [
        ("hit", "closes"), ("wall", "closes"), ("hit", "opens"),
    ]  # fmt: skip
    hit = gap / v
    later = np.sqrt(2.0 * k * u * hit**3 / 6.0 / (c * v))
    # times are known to 1e-16 of 25 ns, the force of the dashpot changes by 1e-8 in so short a time
    assert response.events[1].t - response.events[0].t == pytest.approx(later, rel=1e-5)
    assert response.ledger.residual < 1e-13  # steps and rounding: 7e-15 here


@pytest.mark.parametrize("law", [Linear(0.25 * 99.0**2), Linear(0.25 * 110.0**2, 0.1)])
def test_a_damper_that_parts_slowly(monkeypatch: pytest.MonkeyPatch, law: Law) -> None:
    """Bodies of 0.5, 1 and 0.25 kg joined by contacts: the last parts at 6e-5 m/s, in the midst of a slow impact."""
    bodies = (Body("ball", 0.5, 1.0), Body("middle", 1.0), Body("damper", 0.25))
    contacts = (Contact("ball", "middle", "ball", Linear(0.5)), Contact("damper", "damper", "middle", law))
    scene, clock = Scene(bodies, contacts), Clock(8.0, 10.0)
    exact, steps = engine.simulate(FREE, scene, clock), by_collocation(monkeypatch, scene, clock)
    assert [(e.contact, e.what) for e in steps.events] == [(e.contact, e.what) for e in exact.events]
    for name in ("ball", "middle", "damper"):
        # steps of 1e-8 of a force each
        assert float(steps.bodies[name].velocity[-1]) == pytest.approx(float(exact.bodies[name].velocity[-1]), rel=1e-9)
