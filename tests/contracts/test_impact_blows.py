"""Bodies that strike several times: every blow is exact in time, like a single one, and booked in the ledger."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from femstruct.errors import FemstructError
from femstruct.impact.response import Response
from femstruct.impact.scene import GROUND, Blows, Body, Clock, Contact, HalfSine, Link, Load, Scene, Table
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes

ROUNDING = 1e-11  # steps and rounding: 5e-14 here at most

NONE = given_modes([], [], {})[0]


def codes(response: Response) -> list[str]:
    return [finding.code for finding in response.findings]


@pytest.fixture(scope="module")
def tapping() -> Response:
    """Five hammers of 0.5 kg, 4 cm of fall, ten blows a second in all, on a floor that rings on; with gravity."""
    rng = np.random.default_rng(3)
    f = np.array([19.9, 55.0, 151.0, 274.0, 448.0])
    basis, points = given_modes(list(f), [0.03] * 5, {f"p{i}": list(rng.uniform(-1.0, 1.0, 5)) for i in range(5)})
    hammers = [f"hammer {i}" for i in range(5)]
    over = [points[f"p{i}"].probe("z") for i in range(5)]
    return simulate(
        basis,
        Scene(
            tuple(Body(name, 0.5, -np.sqrt(2 * 9.81 * 0.04), falls=True) for name in hammers),
            tuple(Contact(f"{n} on floor", n, p, Hertz(3e7, 500.0)) for n, p in zip(hammers, over, strict=True)),
            gravity=9.81,
            blows=tuple(Blows(n, p, 0.5, 2, 0.1 * i) for i, (n, p) in enumerate(zip(hammers, over, strict=True))),
        ),
        Clock(1.05, 10e3),
    )


def test_hammers_strike_in_turn(tapping: Response) -> None:
    assert [blow.body for blow in tapping.blows] == [f"hammer {i}" for i in range(5)] * 2
    assert [blow.number for blow in tapping.blows] == [1] * 5 + [2] * 5
    # a tick is 1e-4 s / 2^36: times are exact but for their own rounding
    assert [blow.t for blow in tapping.blows] == pytest.approx(0.1 * np.arange(10), abs=1e-14)
    closes = {(event.contact, event.t) for event in tapping.events if event.what == "closes"}
    for blow in tapping.blows:
        assert (f"{blow.body} on floor", blow.t) in closes
        assert blow.closings >= 1 and blow.peak_force > 100.0
    last = tapping.bodies["hammer 4"]  # held still until its first blow, while the floor moves under it
    before = tapping.t < 0.4
    assert not last.displacement[before].any() and not last.velocity[before].any()
    assert not tapping.contacts["hammer 4 on floor"].force[before].any()
    assert np.abs(tapping.q[:, before]).max() > 1e-5
    # what the floor does before the second hammer strikes is none of its business: position is taken from the floor
    assert max(contact.peak_force for contact in tapping.contacts.values()) == max(b.peak_force for b in tapping.blows)


def test_the_ledger_closes_with_blows(tapping: Response) -> None:
    assert tapping.ledger.residual < 1e-8  # 1e-9 of a contact's speed a step; some thousand steps
    start, end = tapping.ledger.start.total, tapping.ledger.end
    given = 0.5 * 9.81 * 0.04
    assert start == pytest.approx(given, rel=1e-12)  # one hammer moves at t = 0, four are held
    assert abs(replace(end, blows=0.0).total - start) > 0.1 * start
    # a blow at t = 0 is the start itself; the others are in the term of the blows
    assert end.blows == pytest.approx(sum(blow.energy for blow in tapping.blows[1:]), rel=1e-12)
    for blow in tapping.blows[1:5]:
        assert blow.energy == pytest.approx(given, rel=1e-13)  # steps and rounding: 6e-17 here
    for i, blow in enumerate(tapping.blows[5:]):  # lifted off in flight: it takes its motion along
        body, at = tapping.bodies[f"hammer {i}"], round(blow.t * 10e3)
        flying = body.velocity[at - 1] - 9.81e-4
        assert blow.energy == pytest.approx(given - 0.25 * flying**2, rel=ROUNDING)
        assert blow.impulse == pytest.approx(-0.5 * (np.sqrt(2 * 9.81 * 0.04) + flying), rel=ROUNDING)
    assert np.diff(tapping.ledger.t).min() == 0.0  # rows before and after a blow
    total = tapping.ledger.start.total + tapping.ledger.work + tapping.ledger.blows
    stored = sum(tapping.ledger.bodies.values()) + tapping.ledger.structure + tapping.ledger.stored
    # steps and rounding: 1e-13 here
    assert np.abs(stored + tapping.ledger.dissipated - total).max() < 1e-10 * np.abs(total).max()


def test_blows_that_come_too_early_for_rest_are_told(tapping: Response) -> None:
    found = next(finding for finding in tapping.findings if finding.code == "blow-before-rest")
    assert found.values["interval_s"] == pytest.approx(0.1, rel=ROUNDING)
    assert found.values["energy_left"] > found.values["allowed"] == 0.01
    restless = [blow for blow in tapping.blows if blow.rest_after is None]
    assert found.values["blows"] == len([blow for blow in restless if blow.seen]) > 0
    # the last blow's own interval is cut by the window: nothing is said of it
    assert not tapping.blows[-1].seen and tapping.blows[-2].seen


def test_every_blow_is_a_single_blow_when_the_structure_has_come_to_rest() -> None:
    """Energy falls by e^-2 zeta omega t: after 0.6 s by e^-136."""
    basis, points = given_modes([30.0, 283.0], [0.6, 0.6], {"p": [1.0, 0.7]})
    place = points["p"].probe("z")
    press = Scene((Body("ram", 1.2, -1.2),), (Contact("c", "ram", place, Linear(2e6)),))
    clock = Clock(3.0, 20e3, tolerance=1e-11)  # so that what steps of other lengths differ by is below 1e-10
    blows = simulate(basis, replace(press, blows=(Blows("ram", place, 0.6, 5),)), clock)
    single = simulate(basis, press, replace(clock, duration=0.6))
    assert len(blows.blows) == 5
    for i, blow in enumerate(blows.blows):
        assert blow.peak_force == pytest.approx(single.contacts["c"].peak_force, rel=ROUNDING)
        assert blow.rest_after == pytest.approx(blows.blows[0].rest_after, rel=ROUNDING)
        part = slice(12000 * i, 12000 * (i + 1))
        assert np.abs(blows.qd[:, part] - single.qd).max() < ROUNDING * np.abs(single.qd).max()
        assert np.abs(blows.contacts["c"].force[part] - single.contacts["c"].force).max() < ROUNDING * blow.peak_force
        rebound = blows.bodies["ram"].velocity[part] - single.bodies["ram"].velocity
        assert np.abs(rebound).max() < ROUNDING * 1.2
    assert blows.ledger.residual < ROUNDING
    assert blows.contacts["c"].peak_force == max(blow.peak_force for blow in blows.blows)
    assert "blow-before-rest" not in codes(blows)


def test_momentum_of_a_free_mass_is_what_the_blows_brought() -> None:
    """A mass of 2 kg that nothing holds, hit from above four times: it runs away, and each blow meets it as it goes."""
    basis, points = given_modes([0.0], [0.0], {"p": [1 / np.sqrt(2.0)]})
    place = points["p"].probe("z")
    scene = Scene(
        (Body("ram", 1.0, -3.0),),
        (Contact("c", "ram", place, Linear(1e6, 100.0)),),
        blows=(Blows("ram", place, 0.05, 4),),
    )
    response = simulate(basis, scene, Clock(0.2, 20e3))
    momentum = np.sqrt(2.0) * response.qd[0] + response.bodies["ram"].velocity
    given = np.cumsum([blow.impulse for blow in response.blows])
    for i in range(4):  # rounding
        # steps and rounding: 1e-15 here
        assert momentum[1000 * i : 1000 * (i + 1)] == pytest.approx(np.full(1000, given[i]), rel=1e-12)
    # its speed at a blow is one in space: what it brings does not depend on how the mass runs
    assert [event.what for event in response.events] == ["closes", "opens"] * 4
    speeds = [-response.qd[0, 1000 * i] / np.sqrt(2.0) for i in range(4)]
    expected = [(3.0 - speed) * np.sqrt(1e6 / 1.5) for speed in speeds]  # undamped: v sqrt(k m), m = 2/3 kg
    peaks = [blow.peak_force for blow in response.blows]
    assert np.ptp(np.array(peaks) / np.array(expected)) < 1e-9  # one law, so one ratio: proportional to closing speed


def test_a_body_lifted_in_contact_takes_the_springs_energy_along() -> None:
    """Lifted after a quarter of its period of contact: at rest, its spring full, the force v sqrt(k m)."""
    m, k, v = 0.7, 1e5, 1.3
    quarter = 0.5 * np.pi * np.sqrt(m / k)
    scene = Scene(
        (Body("ram", m, -v),), (Contact("c", "ram", GROUND, Linear(k)),), blows=(Blows("ram", GROUND, quarter, 3),)
    )
    response = simulate(NONE, scene, Clock(4 * quarter, 20e3))
    second = response.blows[1]
    assert second.t == pytest.approx(quarter, rel=ROUNDING)
    # it brings half m v^2 and takes half m v^2 of the spring along; 1e-9: times are rounded to ticks
    assert second.energy == pytest.approx(0.0, abs=1e-9 * m * v * v)
    assert response.blows[0].held_force == pytest.approx(v * np.sqrt(k * m), rel=ROUNDING)
    assert response.blows[0].held_since == 0.0
    assert response.blows[2].held_since is None and response.blows[2].closings == 1
    assert response.ledger.residual < 1e-12  # steps and rounding: 5e-15 here
    assert [(event.what, round(event.t / quarter, 9)) for event in response.events] == [
        ("closes", 0.0), ("opens", 1.0), ("closes", 1.0), ("opens", 2.0), ("closes", 2.0), ("opens", 4.0),
    ][: len(response.events)]  # fmt: skip
    assert len(response.events) >= 5
    found = next(finding for finding in response.findings if finding.code == "lifted-in-contact")
    assert found.values["blows"] == 2
    assert found.values["force_n"] == pytest.approx(v * np.sqrt(k * m), rel=ROUNDING)
    assert found.values["contact_s"] == pytest.approx(quarter, rel=ROUNDING) == found.values["every_s"]


def test_a_gap_is_given_back_with_the_start() -> None:
    """1 mm above the ground at 2 m/s: every blow closes 0.5 ms after it begins."""
    scene = Scene(
        (Body("ram", 0.7, -2.0),),
        (Contact("c", "ram", GROUND, Hertz(1e8), gap=1e-3),),
        blows=(Blows("ram", GROUND, 0.01, 3, first=0.002),),
    )
    response = simulate(NONE, scene, Clock(0.03, 20e3))
    closes = [event.t for event in response.events if event.what == "closes"]
    assert closes == pytest.approx([0.0025, 0.0125, 0.0225], abs=1e-13)  # steps and rounding: none here
    assert response.ledger.start.total == 0.0 and response.ledger.end.blows == pytest.approx(1.4, rel=ROUNDING)
    assert response.blows[0].closings == 1


def test_blows_beyond_the_window_are_told() -> None:
    scene = Scene((Body("ram", 1.0, -1.0),), (Contact("c", "ram", GROUND, Linear(1e6)),), blows=(
        Blows("ram", GROUND, 0.1, 10),))  # fmt: skip
    found = next(f for f in simulate(NONE, scene, Clock(0.25, 5e3)).findings if f.code == "blows-left-out")
    assert found.values == {"blows": 3, "count": 10, "duration_s": 0.25}


@pytest.mark.parametrize("overlap", [0.03, 0.012])
def test_repeated_loads_are_delayed_loads(overlap: float) -> None:
    """A history that comes three times is the sum of three; overlapping ones add."""
    basis, points = given_modes([0.0, 40.0], [0.0, 0.05], {"p": [0.7, 1.1]})
    place = points["p"].probe("z")
    step = Table([0.0, 0.004, 0.012, 0.02], [0.0, 80.0, 60.0, 0.0])
    pulse = HalfSine(50.0, 30.0)
    repeated = (Load("a", place, step, 0.005, overlap, 3), Load("b", place, pulse, 0.011, overlap, 3))
    apart = tuple(
        Load(f"{load.name}{i}", place, load.history, load.first + i * overlap) for load in repeated for i in range(3)
    )
    clock = Clock(0.128, 8e3, tolerance=1e-11)
    one, other = (simulate(basis, Scene(loads=loads), clock) for loads in (repeated, apart))
    assert np.abs(one.qd - other.qd).max() < ROUNDING * np.abs(other.qd).max()
    impulse = 3 * (0.7 * (0.5 * 4e-3 * 80 + 0.5 * 8e-3 * 140 + 0.5 * 8e-3 * 60) + 0.7 * 50.0 / (np.pi * 30.0))
    assert one.qd[0, -1] == pytest.approx(impulse, rel=ROUNDING)
    assert one.ledger.residual < ROUNDING


@pytest.mark.parametrize(
    ("blows", "more", "said"),
    [
        ((Blows("rm", GROUND, 0.1, 2),), {}, "expected a body: ram"),
        ((Blows("ram", GROUND, 0.1, 2),) * 2, {}, "'ram' twice"),
        ((Blows("ram", GROUND, 0.1, 2),), {"links": (Link("rope", "ram", GROUND, 1.0),)}, "'rope' holds"),
        ((Blows("ram", GROUND, 0.1, 2),), {"contacts": (Contact("c", "ram", GROUND, Linear(1.0), preload=1.0),)},
         "'c' holds"),
    ],
)  # fmt: skip
def test_a_scene_that_contradicts_its_blows_is_refused(blows, more, said) -> None:
    with pytest.raises(FemstructError, match=said):
        simulate(NONE, Scene((Body("ram", 1.0, -1.0),), blows=blows, **more), Clock(1.0, 1e3))


@pytest.mark.parametrize("wrong", [{"count": 0}, {"every": 0.0}, {"first": -1.0}])
def test_blows_without_a_rhythm_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(FemstructError, match=r"bodies\.ram\.blows"):
        Blows("ram", GROUND, **({"every": 0.1, "count": 2} | wrong))


def test_the_energy_a_blow_leaves_is_the_oscillators_own() -> None:
    """Of a ball of its own mass an undamped oscillator takes all: m v^2 / 2, and keeps it."""
    basis, points = given_modes([5.0], [0.0], {"p": [1.0]})
    place = points["p"].probe("z")
    scene = Scene((Body("ball", 1.0, -2.0),), (Contact("c", "ball", place, Linear(1e9)),))
    response = simulate(basis, replace(scene, blows=(Blows("ball", place, 1.0, 1),)), Clock(0.05, 20e3))
    (blow,) = response.blows
    # the contact lasts 70 us, in which the oscillator's own spring moves by 2e-3 of its period: 1e-5 of the energy
    assert blow.largest_energy == pytest.approx(2.0, rel=1e-4)
    assert blow.left_energy == pytest.approx(response.ledger.end.structure, rel=ROUNDING)


def test_one_blow_left_out_is_told() -> None:
    scene = Scene((Body("ball", 1.0, -2.0),), (Contact("c", "ball", GROUND, Linear(1e6)),))
    rows = [
        simulate(NONE, replace(scene, blows=(Blows("ball", GROUND, 0.1, count),)), Clock(0.25, 10e3))
        for count in (3, 4)
    ]
    assert "blows-left-out" not in codes(rows[0])
    found = next(finding for finding in rows[1].findings if finding.code == "blows-left-out")
    assert (found.values["blows"], found.values["count"]) == (3, 4)


@pytest.mark.parametrize("damping", [2000.0, 0.0])
def test_a_body_that_lies_still_is_not_lifted_in_contact(damping: float) -> None:
    """Under gravity a damped ball comes to rest before the next blow: its weight alone is no contact that lasts."""
    ball = Body("ball", 1.0, -0.5, falls=True)
    scene = Scene((ball,), (Contact("c", "ball", GROUND, Linear(1e6, damping)),), gravity=9.81)
    response = simulate(NONE, replace(scene, blows=(Blows("ball", GROUND, 0.5, 2),)), Clock(1.0, 10e3))
    if damping:
        assert response.blows[0].held_force == pytest.approx(9.81, rel=ROUNDING)
    assert "lifted-in-contact" not in codes(response)
