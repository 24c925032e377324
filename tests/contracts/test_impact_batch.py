"""What a batch must keep: each row is the simulation of its own scene, whatever the threads and the other rows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from femstruct.errors import FemstructError
from femstruct.impact.batch import Batch, Energies, simulate_batch
from femstruct.impact.blow_by_blow import unresolved
from femstruct.impact.response import EnergyBalance, Outcome
from femstruct.impact.scene import GROUND, Blows, Body, Clock, Contact, HalfSine, Link, Load, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.lankarani_nikravesh import LankaraniNikravesh
from femstruct.laws.linear import Linear
from femstruct.laws.stop import Stop
from femstruct.laws.tabulated import Tabulated
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.model.probe import Point

ROUNDING = 1e-10  # steps and rounding: 4e-13 here at most

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
        # a batch takes the steps of its hardest run: 1e-10 here
        assert batch.peak_force[name][i] == pytest.approx(contact.peak_force, rel=2e-8), name
        assert batch.peak_time[name][i] == pytest.approx(contact.peak_time, abs=1e-8), name  # steps, too: 4e-11 s here
        if contact.first_open is None:
            assert np.isnan(batch.first_open[name][i])
        else:
            assert batch.first_open[name][i] == pytest.approx(contact.first_open, abs=1e-9), name
    for name, body in alone.bodies.items():
        reach = np.abs(np.diff(body.velocity)).max() + 1e-6  # steps, where nothing is touched
        # steps, too: 2e-11 m/s here
        assert batch.end_velocity[name][i] == pytest.approx(body.end_velocity, abs=1e-8), name
        sampled = np.abs(body.displacement).max()
        assert batch.travel[name][i] >= sampled * (1 - 1e-9)
        assert batch.travel[name][i] == pytest.approx(
            sampled, abs=(np.abs(body.velocity).max() + reach) / CLOCK.sampling
        )
    assert batch.residual[i] < ROUNDING
    pairs = [(batch.end, alone.ledger.end)]
    assert bool(batch.separated[i]) == (alone.ledger.at_separation is not None)
    if alone.ledger.at_separation is not None:
        pairs.append((batch.at_separation, alone.ledger.at_separation))
    for rows, single in pairs:
        expected = terms(single, None)
        largest = max(abs(value) for name, value in expected.items() if not name.startswith("t "))
        for name, value in terms(rows, i).items():
            assert value == pytest.approx(expected[name], abs=2e-8 * largest), name  # steps, too: 2e-10 here


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
        assert batch.residual[i] < 1e-12  # steps and rounding: 7e-15 here
        for name, contact in alone.contacts.items():
            assert batch.closings[name][i] == contact.closings
            assert batch.peak_force[name][i] == pytest.approx(contact.peak_force, rel=ROUNDING)
            assert batch.peak_time[name][i] == pytest.approx(contact.peak_time, abs=ROUNDING)
            if contact.first_open is not None:
                assert batch.first_open[name][i] == pytest.approx(contact.first_open, rel=ROUNDING)
        for name, body in alone.bodies.items():
            # between two samples a body is further out by no more than what its speed changes there, times the interval
            reach = np.abs(np.diff(body.velocity)).max() / fine.sampling
            inside, last = np.abs(body.displacement).max(), abs(body.displacement[-1] + body.velocity[-1] / 200e3)
            assert batch.travel[name][i] == pytest.approx(max(inside, last), abs=reach), name
        expected = terms(alone.ledger.end, None)
        largest = max(abs(value) for name, value in expected.items() if not name.startswith("t "))
        for name, value in terms(batch.end, i).items():
            assert value == pytest.approx(expected[name], abs=ROUNDING * largest), name


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
    assert batch.first_open["wall"] == pytest.approx(gap / v + np.pi * np.sqrt(m / k), rel=ROUNDING)
    # a flat top: the root of the error in force; 1.5e-8 here
    assert batch.peak_time["wall"] == pytest.approx(gap / v + np.pi / 2 * np.sqrt(m / k), rel=1e-6)
    assert batch.end_velocity["ball"] == pytest.approx(v, rel=1e-8)  # steps: 3e-10 here
    assert batch.at_separation.bodies["ball"] == pytest.approx(m * v**2 / 2, rel=1e-8)  # steps: 6e-10 here
    assert (batch.closings["wall"] == 1).all()
    assert batch.outcome == (Outcome.SEPARATED,) * 40
    flight = v * (2.0 - batch.first_open["wall"]) - gap
    # steps: 3e-10 here
    assert batch.travel["ball"] == pytest.approx(np.maximum(flight, gap + v * np.sqrt(m / k)), rel=3e-8)


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
    # steps of a batch: 1.4e-10 here
    assert batch.peak_force["late"] == pytest.approx([run.contacts["late"].peak_force for run in alone], rel=2e-8)


def test_a_run_that_fails_has_its_row() -> None:
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("wall", "ball", GROUND, Hertz(1e6)),))
    batch = simulate_batch(NONE, scene, Clock(0.1, 1e3), {"wall.stiffness": [1e6, 1e306, 2e6]})
    assert batch.status.tolist()[::2] == [0, 0]
    assert batch.status[1] != 0
    assert batch.trouble(1)
    assert batch.outcome[1] is None
    assert np.isnan(batch.peak_force["wall"][1])
    assert np.isnan(batch.end.bodies["ball"][1])
    # steps and rounding: 4e-12 here
    assert batch.peak_force["wall"][[0, 2]] == pytest.approx((2.5 * 0.5) ** 0.6 * np.array([1e6, 2e6]) ** 0.4, rel=1e-9)


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ({"ball.mas": [1.0]}, r"vary.ball.mas: got an unknown name, expected one of .*; did you mean 'ball.mass'"),
        ({"ball.mass": [1.0, 2.0], "wall.gap": [0.0]}, r"vary.wall.gap: got 1 values, expected 2, as ball.mass has"),
        ({"ball.mass": [1.0, np.nan]}, r"vary.ball.mass: got nan"),
        ({"ball.mass": [1.0, -2.0]}, r"bodies.ball.mass: got -2 kg"),
        ({"wall.stiffness": [1.0, 0.0]}, r"hertz law stiffness"),
        ({"wall.gap": [1.0, 0.0], "wall.preload": [2.0, 1.0]}, r"a gap of 1 m"),
        ({"wall.exponent": [1.0]}, r"expected one of .*, wall.damping$"),
        ({}, r"vary: got no run"),
        ({"ball.mass": []}, r"vary: got no run"),
    ],
)
def test_refusals(vary: dict[str, list[float]], message: str) -> None:
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("wall", "ball", GROUND, Hertz(1e6)),))
    with pytest.raises(FemstructError, match=message):
        simulate_batch(NONE, scene, Clock(0.1, 1e3), vary)


def test_interruption_leaves_between_chunks() -> None:
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("wall", "ball", GROUND, Hertz(1e6)),))
    seen: list[int] = []

    def interrupt(done: int, runs: int) -> None:
        seen.append(done)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate_batch(NONE, scene, Clock(0.1, 1e3), {"ball.mass": np.linspace(1, 2, 2000)}, 1, interrupt)
    assert len(seen) == 1


OF_HISTORIES = {
    "structure-not-decayed",
    "contact-coarsely-sampled",
    "blow-before-rest",
}  # what only histories and samples tell


def flagged(batch: Batch, i: int) -> set[str]:
    """Codes of the flags of a run."""
    return {code for code, flags in batch.flags.items() if flags[i]}


@pytest.mark.parametrize("law", [Linear(2e4, 8.0), HuntCrossley(1e6, 1.5, 1.0)], ids=["exact", "collocation"])
def test_a_row_ends_as_its_own_simulation(law: Linear | HuntCrossley) -> None:
    """Balls that come to rest, bounce on, hang on a strip without weight, miss: outcomes, and what is said of them."""
    basis, points = given_modes([12.0, 20.0, 150.0], [0.03] * 3, {"p": [0.5, -1.0, 0.4]})
    place = points["p"].probe("z")
    scene = Scene(
        (Body("ball", 0.3, -1.0, falls=True), Body("light", 0.1, -1.0)),
        (Contact("ball", "ball", place, law), Contact("light", "light", place, law, gap=0.1)),
        gravity=9.81,
    )
    vary = {
        "ball.velocity": [-1.0, -3.0, -0.2, -1.0, -1.0],
        "light.velocity": [1.0, 1.0, 1.0, -0.1006, 1.0],  # it touches in the last milliseconds
        "ball.gap": [0.0, 0.0, 0.0, 0.0, 90.0],
    }
    clock = Clock(1.0, 5e3)
    batch = simulate_batch(basis, scene, clock, vary)
    seen = set()
    for i in range(5):
        alone = simulate(basis, batch.scene(i), clock)
        assert batch.outcome[i] is alone.outcome, i
        shared = [found for found in alone.findings if found.code not in OF_HISTORIES]
        assert [(f.code, f.message.split(",")[0], f.severe) for f in batch.findings(i)] == [
            (f.code, f.message.split(",")[0], f.severe) for f in shared
        ]
        assert flagged(batch, i) == {found.code for found in shared}
        for one, other in zip(batch.findings(i), shared, strict=True):
            assert one.values == pytest.approx(dict(other.values), rel=ROUNDING)
        for name, contact in alone.contacts.items():
            closed = batch.closed_since[name][i]
            last = max((event.t for event in alone.events if event.contact == name), default=np.nan)
            # roots in time between other steps: 5e-11 s here
            assert np.isnan(closed) or closed == pytest.approx(last, abs=5e-9)
            assert np.isfinite(batch.shortest[name][i]) == (contact.first_open is not None)
        seen.add(alone.outcome)
    assert {Outcome.RESTING, Outcome.CLOSED_AT_END, Outcome.NEVER_TOUCHED} <= seen


def test_findings_of_laws_and_of_the_march() -> None:
    """Beyond a table's last point, a restitution that the law misses, a coarse march, a run that failed: the words of a
    single run, and both numbers."""
    table = Tabulated(np.array([0.0, 1e-3, 2e-3]), np.array([0.0, 200.0, 500.0]))
    law = LankaraniNikravesh(1e8, restitution=0.7, speed=2.0)
    scene = Scene(
        (Body("ball", 0.1, -1.0), Body("hard", 0.1, -2.0), Body("third", 1.0, -1.0)),
        (
            Contact("pad", "ball", GROUND, table),
            Contact("steel", "hard", GROUND, law),
            Contact("far", "third", GROUND, Hertz(1e6), gap=0.02),
        ),
    )
    clock = Clock(0.05, 10e3, tolerance=1e-2)
    batch = simulate_batch(NONE, scene, clock, {"ball.velocity": [-0.3, -5.0], "far.stiffness": [1e6, 1e6]})
    for i in range(2):
        told = {found.code: found for found in batch.findings(i)}
        alone = {found.code: found for found in simulate(NONE, batch.scene(i), clock).findings}
        assert told.keys() == flagged(batch, i)
        for code in ("beyond-table", "restitution-missed"):
            assert (code in told) == (code in alone)
            if code in told:
                assert told[code].message == alone[code].message
        assert told["restitution-missed"].values["returned"] == law.returns
        assert ("energy-drift" in told) == (batch.residual[i] > 1e-8)
        assert batch.severe[i] == any(found.severe for found in told.values())
    assert batch.flags["energy-drift"].any()  # the case is what it says
    assert batch.flags["beyond-table"].tolist() == [False, True]
    failed = simulate_batch(NONE, scene, clock, {"far.stiffness": [1e6, 1e306]})
    assert flagged(failed, 1) == {"failed"}
    (found,) = failed.findings(1)
    assert found.severe and failed.severe[1] and failed.trouble(1) in found.message


def test_a_contact_too_short_for_its_window_is_told() -> None:
    """A steel ball in a window of hours: the closing is a few ticks long, and the closed-form peak is missed; what is
    told of nothing is right to 1e-3. The same short touch without energy is nobody's concern."""
    law = Hertz(1e14)
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("wall", "ball", GROUND, law),))
    vary = {"wall.gap": [1e3, 1.0]}
    seen = []
    for window in (2e5, 3e4, 8e3, 2e3):
        batch = simulate_batch(NONE, scene, Clock(window, 10 / window), vary, threads=1)
        missed = np.abs(batch.peak_force["wall"] / (1e14 * (5 / 4e14) ** 0.6) - 1)
        for i in range(2):
            found = {one.code: one for one in batch.findings(i)}
            assert found.keys() == flagged(batch, i)
            assert bool(batch.severe[i]) == any(one.severe for one in found.values())
            told = found.get("contact-unresolved")
            if told is None:
                assert missed[i] < 1e-3
            else:
                assert found["energy-drift"].severe
                assert told.values["resolved_s"] == batch.tick > 0.0
                assert told.values["contact_s"] == batch.shortest["wall"][i]
            seen.append((told is None, bool(missed[i] > 1e-3)))
    assert {(True, False), (False, True)} <= set(seen)
    assert unresolved(batch.tick * np.ones(2), batch.tick, np.array([1e-12, 1e-6])).tolist() == [False, True]


def struck_scene() -> tuple[ModalBasis, Scene]:
    """Two rams strike in turn under gravity, one on a floor, one on a body that lies on it by a spring; the second
    begins late, and its blows are more than the window holds."""
    basis, points = given_modes([19.9, 55.0, 151.0], [0.04] * 3, {"p": [0.6, -0.8, 0.5], "q": [0.3, 0.9, -0.2]})
    p, q = points["p"].probe("z"), points["q"].probe("z")
    scene = Scene(
        (Body("ram", 0.5, -0.9, falls=True), Body("hammer", 0.2, -0.6, falls=True), Body("anvil", 2.0)),
        (
            Contact("ram on floor", "ram", p, Hertz(3e7, 500.0)),
            Contact("hammer on anvil", "hammer", "anvil", HuntCrossley(1e7, 1.5, 0.2)),
        ),
        (Link("seat", "anvil", q, 4e4, 30.0, 30.0),),
        gravity=9.81,
        blows=(Blows("ram", p, 0.125, 3), Blows("hammer", "anvil", 0.125, 9, 0.0625)),
    )
    return basis, scene


STRUCK: dict[str, Any] = {
    "ram.mass": [0.5, 0.2, 0.5, 0.5],
    "ram.velocity": [-0.9, -2.0, -0.9, -0.9],
    "hammer.mass": [0.2, 0.2, 0.6, 0.2],
    "hammer.velocity": [-0.6, -0.6, -0.05, -0.6],
    "anvil.mass": [2.0, 2.0, 1.0, 2.0],
    "ram on floor.stiffness": [3e7, 1e7, 3e7, 2e3],
}


def test_a_row_with_blows_is_its_own_simulation() -> None:
    """All that a blow does to the whole window: forces, energies, what blows brought, bodies lifted in contact."""
    basis, scene = struck_scene()
    clock = Clock(
        0.5, 8192.0
    )  # measured: 5e-13; blows fall on ticks of both: bounces would multiply what is rounded away
    batch = simulate_batch(basis, scene, clock, STRUCK, threads=1)
    for i in range(4):
        alone = simulate(basis, batch.scene(i), clock)
        assert batch.outcome[i] is alone.outcome
        for name, contact in alone.contacts.items():
            assert batch.closings[name][i] == contact.closings, (i, name)
            assert batch.peak_force[name][i] == pytest.approx(contact.peak_force, rel=ROUNDING), (i, name)
            # steps and rounding: 9e-12 here
            assert batch.peak_time[name][i] == pytest.approx(contact.peak_time, abs=1e-10)
        for name, body in alone.bodies.items():
            # steps and rounding: 2e-12 here
            assert batch.end_velocity[name][i] == pytest.approx(body.end_velocity, abs=1e-10)
        expected = terms(alone.ledger.end, None)
        largest = max(abs(value) for name, value in expected.items() if not name.startswith("t "))
        assert abs(expected["blows "]) > 0.1 * largest
        for name, value in terms(batch.end, i).items():
            assert value == pytest.approx(expected[name], abs=ROUNDING * largest), (i, name)
        assert batch.residual[i] < ROUNDING
        shared = {found.code: found for found in alone.findings if found.code not in OF_HISTORIES}
        told = {found.code: found for found in batch.findings(i)}
        assert told.keys() == shared.keys() == flagged(batch, i)
        for code, found in told.items():
            # steps of a batch: 1.4e-11 here
            assert found.values == pytest.approx(dict(shared[code].values), rel=2e-9), (i, code)
            assert found.severe == shared[code].severe
    assert batch.flags["lifted-in-contact"].any() and not batch.flags["lifted-in-contact"].all()
    assert batch.flags["blows-left-out"].all()
    two = simulate_batch(basis, scene, clock, {name: np.tile(column, 3) for name, column in STRUCK.items()}, threads=2)
    for name, column in two.peak_force.items():
        assert np.array_equal(column, np.tile(batch.peak_force[name], 3))
    assert np.array_equal(two.end.blows, np.tile(batch.end.blows, 3))
    assert two.outcome == batch.outcome * 3
