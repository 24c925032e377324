"""What a batch must keep: each row is the simulation of its own scene, whatever the threads and the other rows."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from femstruct.errors import FemstructError, InputError
from femstruct.impact.batch import simulate_batch
from femstruct.impact.bodies import GROUND, Blows, Body, Clock, Contact, HalfSine, Link, Load, Scene
from femstruct.impact.laws import Hertz, HuntCrossley, Linear, Stop
from femstruct.impact.metrics import Batch, Energies
from femstruct.impact.response import EnergyBalance, Outcome
from femstruct.impact.simulate import simulate
from femstruct.modal.analytic import given_modes
from femstruct.modal.basis import ModalBasis
from femstruct.model.probe import Point

NONE = given_modes([], [], {})[0]
CLOCK = Clock(0.12, 20e3)


def plate() -> tuple[ModalBasis, dict[str, Point]]:
    """Eight made-up modes of a floor and a slab."""
    rng = np.random.default_rng(11)
    shapes = {"f": list(rng.uniform(-2, 2, 8)), "s": list(rng.uniform(-0.4, 0.4, 8))}
    return given_modes([12.0, 19.9, 31.0, 150.0, 280.0, 420.0, 900.0, 1700.0], [0.02] * 8, shapes)


def floor_scene(points: dict[str, Point]) -> Scene:
    """A ball, a damper under the floor, a one-way link, a push, weight, a stop and a preloaded seat."""
    f, s = points["f"].probe("z"), points["s"].probe("z")
    return Scene(
        (Body("ball", 0.054, -2.1, falls=True), Body("damper", 0.45), Body("foot", 0.8)),
        (
            Contact("ball on floor", "ball", f, Hertz(3.7e5, 150.0)),
            Contact("floor on damper", f, "damper", Hertz(6.1e8)),
            Contact("seat", "foot", s, HuntCrossley(2e7, 1.5, 0.1), preload=20.0),
            Contact("bumper", "foot", f, Stop(1e5, 3.0), gap=2e-4),
        ),
        (Link("link", "damper", s, 507.0, 0.0, 40.0), Link("hold", GROUND, "foot", 900.0, 2.0, 2.0)),
        (Load("push", s, HalfSine(5.0, 80.0)),),
        gravity=9.81,
    )


VARY: dict[str, Any] = {
    "ball.mass": [0.054, 0.03, 0.2, 0.054, 0.08, 0.054],
    "ball.velocity": [-2.1, -1.0, -0.3, -3.0, 0.4, -2.1],
    "damper.mass": [0.45, 0.9, 0.2, 0.45, 0.45, 0.45],
    "ball on floor.stiffness": [3.7e5, 2e5, 1e7, 3.7e5, 3.7e5, 3.7e5],
    "ball on floor.damping": [150.0, 0.0, 20.0, 150.0, 150.0, 150.0],
    "ball on floor.gap": [0.0, 1e-3, 0.0, 5e-3, 2e-3, 0.0],
    "seat.preload": [20.0, 5.0, 40.0, 20.0, 1.0, 20.0],
    "seat.dissipation": [0.1, 0.0, 0.3, 0.1, 0.1, 0.1],
    "bumper.stiffness": [1e5, 1e6, 1e5, 1e5, 1e4, 1e5],
    "link.opening": [40.0, 0.0, 10.0, 40.0, 40.0, 40.0],
    "link.stiffness": [507.0, 800.0, 507.0, 507.0, 0.0, 507.0],
    "push.amplitude": [5.0, 0.0, -20.0, 5.0, 5.0, 5.0],
}


@pytest.fixture(scope="module")
def batch() -> Batch:
    basis, points = plate()
    return simulate_batch(basis, floor_scene(points), CLOCK, VARY, threads=1)


def terms(energies: Energies | EnergyBalance, i: int | None) -> dict[str, float]:
    """All terms of a balance, flat."""
    found = {}
    for name in energies.__dataclass_fields__:
        value = getattr(energies, name)
        for key, part in value.items() if isinstance(value, dict) else [("", value)]:
            found[f"{name} {key}"] = float(part if i is None else part[i])
    return found


@pytest.mark.parametrize("i", range(5))
def test_a_row_is_its_own_simulation(batch: Batch, i: int) -> None:
    """A batch takes longer steps and coarser ticks: both march within 1e-9 of a contact's speed a step, and chaos of
    some bounces multiplies that; wrong wiring of a number shows in percents."""
    alone = simulate(plate()[0], batch.scene(i), CLOCK)
    assert batch.status[i] == 0
    assert batch.trouble(i) == ""
    assert batch.outcome[i] is alone.outcome
    for name, contact in alone.contacts.items():
        assert batch.closings[name][i] == contact.closings, name
        assert batch.peak_force[name][i] == pytest.approx(contact.peak_force, rel=1e-6), name
        assert batch.peak_time[name][i] == pytest.approx(contact.peak_time, abs=1e-7), name
        if contact.first_open is None:
            assert np.isnan(batch.first_open[name][i])
        else:
            assert batch.first_open[name][i] == pytest.approx(contact.first_open, abs=1e-9), name
    for name, body in alone.bodies.items():
        # the last sample is an interval before the end
        last = body.velocity[-1] + (body.velocity[-1] - body.velocity[-2])
        reach = np.abs(np.diff(body.velocity)).max() + 1e-6
        assert batch.end_velocity[name][i] == pytest.approx(last, abs=reach), name
        sampled = np.abs(body.displacement).max()
        assert batch.travel[name][i] >= sampled * (1 - 1e-9)
        assert batch.travel[name][i] == pytest.approx(
            sampled, abs=(np.abs(body.velocity).max() + reach) / CLOCK.sampling
        )
    assert batch.residual[i] < 1e-7
    pairs = [(batch.end, alone.ledger.end)]
    assert bool(batch.separated[i]) == (alone.ledger.at_separation is not None)
    if alone.ledger.at_separation is not None:
        pairs.append((batch.at_separation, alone.ledger.at_separation))
    for rows, single in pairs:
        expected = terms(single, None)
        largest = max(abs(value) for name, value in expected.items() if not name.startswith("t "))
        for name, value in terms(rows, i).items():
            assert value == pytest.approx(expected[name], abs=1e-6 * largest), name


def test_a_linear_row_is_its_own_exact_simulation() -> None:
    """Piecewise-linear scenes take the exact march alone and in batches: what differs is rounding, in steps that
    samples do not cut."""
    basis, points = plate()
    f, s = points["f"].probe("z"), points["s"].probe("z")
    scene = Scene(
        (Body("ball", 0.3, -1.5, falls=True), Body("foot", 0.8)),
        (Contact("ball", "ball", f, Linear(2e4, 3.0)), Contact("bumper", "foot", f, Stop(1e5, 3.0), gap=2e-4)),
        (Link("link", "foot", s, 900.0, 0.0, 40.0),),
        (Load("push", s, HalfSine(5.0, 80.0)),),
        gravity=9.81,
    )
    vary = {
        "ball.mass": [0.3, 0.1, 1.0],
        "ball.velocity": [-1.5, -0.5, -2.0],
        "ball.stiffness": [2e4, 4e4, 1e4],
        "foot.mass": [0.8, 0.8, 0.5],
        "link.opening": [40.0, 0.0, 10.0],
        "push.amplitude": [5.0, -5.0, 0.0],
    }
    fine = Clock(0.12, 200e3)
    batch = simulate_batch(basis, scene, fine, vary)
    for i in range(3):
        alone = simulate(basis, batch.scene(i), fine)
        assert batch.closings["ball"][i] > 0
        assert batch.residual[i] < 1e-12
        for name, contact in alone.contacts.items():
            assert batch.closings[name][i] == contact.closings
            assert batch.peak_force[name][i] == pytest.approx(contact.peak_force, rel=1e-9)
            assert batch.peak_time[name][i] == pytest.approx(contact.peak_time, abs=1e-9)
            if contact.first_open is not None:
                assert batch.first_open[name][i] == pytest.approx(contact.first_open, rel=1e-9)
        for name, body in alone.bodies.items():
            # between two samples a body is further out by no more than what its speed changes there, times the interval
            reach = np.abs(np.diff(body.velocity)).max() / fine.sampling
            inside, last = np.abs(body.displacement).max(), abs(body.displacement[-1] + body.velocity[-1] / 200e3)
            assert batch.travel[name][i] == pytest.approx(max(inside, last), abs=reach), name
        expected = terms(alone.ledger.end, None)
        largest = max(abs(value) for name, value in expected.items() if not name.startswith("t "))
        for name, value in terms(batch.end, i).items():
            assert value == pytest.approx(expected[name], abs=1e-9 * largest), name


def test_rows_do_not_depend_on_threads_or_neighbours(batch: Batch) -> None:
    basis, points = plate()
    long = {name: np.tile(column, 3) for name, column in VARY.items()}  # in chunks of other runs
    two = simulate_batch(basis, floor_scene(points), CLOCK, long, threads=2)
    for name in ("peak_force", "end_velocity", "travel", "first_open"):
        for key, column in getattr(two, name).items():
            assert np.array_equal(column, np.tile(getattr(batch, name)[key], 3), equal_nan=True), (name, key)
    assert np.array_equal(two.end.lost_modes, np.tile(batch.end.lost_modes, 3))
    assert np.array_equal(two.steps, np.tile(batch.steps, 3))


def test_closed_form_of_a_linear_contact() -> None:
    """Half a period: F = v sqrt(k m) at a quarter of it, T = pi sqrt(m / k), then back at the same speed."""
    rng = np.random.default_rng(3)
    m, k, v, gap = (rng.uniform(*limits, 40) for limits in ((0.1, 5.0), (1e3, 1e6), (0.1, 3.0), (0.0, 0.05)))
    gap[:5] = 0.0
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("wall", "ball", GROUND, Linear(1.0)),))
    vary = {"ball.mass": m, "ball.velocity": -v, "wall.stiffness": k, "wall.gap": gap}
    batch = simulate_batch(NONE, scene, Clock(2.0, 1e3), vary)
    # the step of a change is as long as the tolerance allows, 1e-9 of the speed
    assert batch.peak_force["wall"] == pytest.approx(v * np.sqrt(k * m), rel=1e-8)
    assert batch.first_open["wall"] == pytest.approx(gap / v + np.pi * np.sqrt(m / k), rel=1e-8)
    assert batch.peak_time["wall"] == pytest.approx(gap / v + np.pi / 2 * np.sqrt(m / k), rel=1e-6)
    assert batch.end_velocity["ball"] == pytest.approx(v, rel=1e-8)
    assert batch.at_separation.bodies["ball"] == pytest.approx(m * v**2 / 2, rel=1e-8)
    assert (batch.closings["wall"] == 1).all()
    assert batch.outcome == (Outcome.SEPARATED,) * 40
    flight = v * (2.0 - batch.first_open["wall"]) - gap
    assert batch.travel["ball"] == pytest.approx(np.maximum(flight, gap + v * np.sqrt(m / k)), rel=1e-7)


def test_a_late_second_contact_is_not_missed() -> None:
    """A ball flies for 0.9 s towards a plate that it does not reach before; another has it back after a bounce."""
    basis, points = given_modes([30.0, 170.0, 410.0], [0.0, 0.0, 0.0], {"p": [1.0, -0.8, 0.6]})
    p = points["p"].probe("z")
    scene = Scene(
        (Body("ball", 0.3, -1.0), Body("late", 0.02, -0.5)),
        (Contact("ball", "ball", p, Hertz(1e7)), Contact("late", "late", p, Hertz(1e6), gap=0.45)),
    )
    vary = {"late.velocity": [-0.5, -0.45, -2.0, -0.1]}
    batch = simulate_batch(basis, scene, Clock(1.2, 1e4), vary)
    alone = [simulate(basis, batch.scene(i), Clock(1.2, 1e4)) for i in range(4)]
    for name in ("ball", "late"):
        assert batch.closings[name].tolist() == [run.contacts[name].closings for run in alone]
    assert batch.closings["late"][0] > 0
    assert batch.closings["late"][3] == 0
    assert batch.peak_force["late"] == pytest.approx([run.contacts["late"].peak_force for run in alone], rel=1e-6)


def test_a_run_that_fails_has_its_row() -> None:
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("wall", "ball", GROUND, Hertz(1e6)),))
    batch = simulate_batch(NONE, scene, Clock(0.1, 1e3), {"wall.stiffness": [1e6, 1e306, 2e6]})
    assert batch.status.tolist()[::2] == [0, 0]
    assert batch.status[1] != 0
    assert batch.trouble(1)
    assert batch.outcome[1] is None
    assert np.isnan(batch.peak_force["wall"][1])
    assert np.isnan(batch.end.bodies["ball"][1])
    assert batch.peak_force["wall"][[0, 2]] == pytest.approx((2.5 * 0.5) ** 0.6 * np.array([1e6, 2e6]) ** 0.4, rel=1e-8)


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ({"ball.mas": [1.0]}, r"vary.ball.mas: got an unknown name, expected ball.mass"),
        ({"ball.mass": [1.0, 2.0], "wall.gap": [0.0]}, r"vary.wall.gap: got 1 values, expected 2, as ball.mass has"),
        ({"ball.mass": [1.0, np.nan]}, r"vary.ball.mass: got nan"),
        ({"ball.mass": [1.0, -2.0]}, r"bodies.ball.mass: got -2 kg"),
        ({"wall.stiffness": [1.0, 0.0]}, r"hertz law stiffness"),
        ({"wall.gap": [1.0, 0.0], "wall.preload": [2.0, 1.0]}, r"a gap of 1 m"),
        ({"wall.exponent": [1.0]}, r"expected wall"),
        ({}, r"vary: got no run"),
        ({"ball.mass": []}, r"vary: got no run"),
    ],
)
def test_refusals(vary: dict[str, list[float]], message: str) -> None:
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("wall", "ball", GROUND, Hertz(1e6)),))
    with pytest.raises(FemstructError, match=message):
        simulate_batch(NONE, scene, Clock(0.1, 1e3), vary)


def test_a_scene_with_blows_is_refused() -> None:
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("wall", "ball", GROUND, Hertz(1e6)),))
    with pytest.raises(InputError, match="scene: got blows"):
        simulate_batch(
            NONE, replace(scene, blows=(Blows("ball", GROUND, 0.1, 2),)), Clock(1.0, 1e3), {"ball.mass": [1.0]}
        )


def test_interruption_leaves_between_chunks() -> None:
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("wall", "ball", GROUND, Hertz(1e6)),))
    seen: list[int] = []

    def interrupt(done: int, runs: int) -> None:
        seen.append(done)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate_batch(NONE, scene, Clock(0.1, 1e3), {"ball.mass": np.linspace(1, 2, 2000)}, 1, interrupt)
    assert len(seen) == 1
