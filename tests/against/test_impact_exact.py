"""The exact march against 40 digits of mpmath (tests/data/impact_exact.py), against collocation, and against itself."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from femstruct.errors import NotConverged
from femstruct.impact import numerical_error as estimate
from femstruct.impact import simulate as engine
from femstruct.impact.contact_events import DONE, STICKS, empty_record, ended
from femstruct.impact.exact import ExactSteps, exact_rule, exact_workspace, integrate_exactly
from femstruct.impact.numerical_error import error_of
from femstruct.impact.propagation import State
from femstruct.impact.response import EnergyBalance, Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, End, HalfSine, Link, Load, Scene, Table
from femstruct.impact.simulate import simulate
from femstruct.impact.system import compile_scene
from femstruct.laws.linear import Linear
from femstruct.laws.stop import Stop
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes

ROUNDING = 1e-13  # steps and rounding: 9e-16 here at most

CASES = json.loads((Path(__file__).parents[1] / "data" / "impact_exact.json").read_text())["cases"]
NONE = given_modes([], [], {})[0]


@pytest.fixture(autouse=True)
def _always_exact(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "is_piecewise_linear", lambda *_: True)


def built(told: dict) -> tuple[ModalBasis, Scene]:
    """The basis and scene that a case of the file tells."""
    basis, points = given_modes(told["frequency_hz"], told["ratio"], told["shapes"])
    if "dashpots" in told:
        basis = replace(basis, viscous=basis.viscous + np.array(told["dashpots"]))

    def end(name: str) -> End:
        return GROUND if name == "ground" else (points[name].probe("z") if name in points else name)

    contacts = tuple(
        Contact(
            c["name"],
            end(c["upper"]),
            end(c["lower"]),
            Stop(c["stiffness"])
            if c.get("stop")
            else Linear(c["stiffness"], c.get("damping", 0.0), c.get("tensile", False)),
            c.get("gap", 0.0),
            c.get("preload", 0.0),
        )
        for c in told["contacts"]
    )
    links = tuple(
        Link(**{**link, "upper": end(link["upper"]), "lower": end(link["lower"])}) for link in told.get("links", [])
    )
    loads = ()
    if "load" in told:
        loads = (Load("load", end(told["load"]["on"]), HalfSine(told["load"]["amplitude"], told["load"]["frequency"])),)
    velocity = np.array(told["velocity"]) if "velocity" in told else None
    bodies = tuple(Body(**body) for body in told["bodies"])
    return basis, Scene(bodies, contacts, links, loads, velocity, told.get("gravity", 0.0))


def same(found: EnergyBalance, exact: dict, total: float) -> None:
    """To 1e-12 of each term, or of a hundredth of all energy for those that nearly vanish."""

    def close(a: float, b: str) -> None:
        assert a == pytest.approx(float(b), rel=1e-12, abs=1e-14 * total)  # steps and rounding: 4e-13 here

    assert found.t == pytest.approx(float(exact["t"]), rel=1e-12)
    close(found.structure, exact["structure"])
    close(found.dissipated, exact["lost"])
    close(found.work, exact["work"])
    for kind in ("bodies", "contacts", "links"):
        for name, value in getattr(found, kind).items():
            close(value, exact[kind][name])


FAINT = "graze 1e-09"


@pytest.mark.parametrize(
    "case", [c for c in CASES if c["scene"]["name"] != FAINT], ids=lambda case: case["scene"]["name"]
)
def test_forty_digits(case: dict) -> None:
    """Times of all events, energies at separation and at the end."""
    basis, scene = built(case["scene"])
    duration = case["scene"]["duration"]
    response = simulate(basis, scene, Clock(duration, 100 / duration))
    assert [(e.contact, e.what) for e in response.events] == [(name, what) for _, name, what in case["events"]]
    for event, (t, _, _) in zip(response.events, case["events"], strict=True):
        assert event.t == pytest.approx(float(t), rel=1e-12, abs=0.0)  # steps and rounding: 2e-13 here
    total = abs(response.ledger.start.total) + float(case["end"]["work"])
    if case["separation"]:
        assert response.ledger.at_separation is not None
        same(response.ledger.at_separation, case["separation"], total)
    same(response.ledger.end, case["end"], total)
    assert response.ledger.residual <= 1e-13  # steps and rounding: 1e-14 here


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["scene"]["name"])
def test_estimate_of_rounding(case: dict, monkeypatch: pytest.MonkeyPatch) -> None:
    """End speeds against 40 digits: within three times the estimate, which is small where nothing grazes."""
    monkeypatch.setattr(estimate, "is_piecewise_linear", lambda *_: True)
    basis, scene = built(case["scene"])
    duration = case["scene"]["duration"]
    response = simulate(basis, scene, Clock(duration, 100 / duration))
    found = error_of(response)
    assert found.exact
    for body in scene.bodies:
        speed = found.velocity[body.name]
        exact = np.sqrt(2 * float(case["end"]["bodies"][body.name]) / body.mass)
        assert abs(abs(speed.value) - exact) <= 3 * speed.error
    closed = {name for name, contact in response.contacts.items() if contact.closings}
    assert set(found.peak) == closed
    grazes = case["scene"]["name"].startswith("graze")
    # rounding; grazing is worse by the root of its depth, 2e-9
    assert max(one.relative for one in (*found.peak.values(), *found.velocity.values())) < (1e-4 if grazes else 1e-12)


def test_estimate_of_a_linear_bounce() -> None:
    """F = v sqrt(k m): within the estimate, which is rounding."""
    m, k, v = 0.3, 2e4, 1.7
    scene = Scene((Body("ball", m, -v),), (Contact("wall", "ball", GROUND, Linear(k)),))
    found = error_of(simulate(NONE, scene, Clock(0.05, 1e4)))
    assert found.against is None
    assert abs(found.first_peak["wall"].value - v * np.sqrt(k * m)) <= 3 * found.first_peak["wall"].error
    assert found.first_peak["wall"].relative < 1e-12  # steps and rounding: 1e-13 here
    assert found.first_until == 0.05


def test_estimate_of_a_body_that_nothing_holds() -> None:
    """No stiffness, no rate: a constant force on a free body, v = F t / m."""
    push = Load("push", "ball", Table(np.array([0.0, 1.0]), np.array([3.0, 3.0])))
    found = error_of(simulate(NONE, Scene((Body("ball", 2.0),), loads=(push,)), Clock(0.5, 100.0)))
    assert not found.peak
    assert abs(found.velocity["ball"].value - 0.75) <= 3 * found.velocity["ball"].error < 1e-12  # rounding


def test_the_faintest_touch() -> None:
    """An excursion of 1e-9 of the amplitude is met; how well is what rounding of the displacement, 1e-15, leaves of it:
    the gap is crossed with sqrt(2e-9) of the speed."""
    case = next(c for c in CASES if c["scene"]["name"] == FAINT)
    basis, scene = built(case["scene"])
    response = simulate(basis, scene, Clock(20.0, 5.0))
    for event, (t, _, what) in zip(response.events, case["events"], strict=True):
        assert event.what == what
        assert event.t == pytest.approx(float(t), abs=1e-15 / np.sqrt(2e-9))
    exact = np.sqrt(2 * float(case["end"]["bodies"]["d"]))
    assert response.bodies["d"].velocity[-1] == pytest.approx(exact, rel=1e-15 / 1e-9)


def everything() -> tuple[ModalBasis, Scene]:
    """Every kind of linear law and load in one scene, with full damping and gravity."""
    shapes = {"p": [0.5, 1.0, -0.8, 0.7], "r": [0.5, -1.0, 0.4, 0.3]}
    basis, points = given_modes([0.0, 22.0, 90.0, 350.0], [0.0, 0.02, 0.3, 1.5], shapes)
    basis = replace(basis, viscous=basis.viscous + 3.0 * np.outer([0, 1, 0.5, -0.5], [0, 1, 0.5, -0.5]))
    p, r = points["p"].probe("z"), points["r"].probe("z")
    scene = Scene(
        (Body("ball", 0.2, -1.5, falls=True), Body("d", 0.4), Body("e", 0.1)),
        (
            Contact("ball", "ball", p, Linear(3e5, 80.0), gap=1e-3),
            Contact("d", p, "d", Linear(2e5, 40.0, tensile=True), preload=12.0),
            Contact("e", "e", r, Stop(5e4, 3.0), gap=2e-4),
        ),
        (
            Link("one", "d", r, 500.0, opening=20.0),
            Link("two", "e", GROUND, 300.0, closing=4.0, opening=1.0, release_at=0.0117, preload=3.0),
        ),
        (
            Load("sine", r, HalfSine(60.0, 35.0)),
            Load("table", "e", Table(np.array([0.003, 0.0101, 0.02, 0.034]), np.array([0.0, 9.0, -4.0, 2.0]))),
        ),
        gravity=9.81,
    )
    return basis, scene


def test_collocation_says_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both marches through all laws and loads: samples, forces, events, peaks and every energy."""
    basis, scene = everything()
    exact = simulate(basis, scene, Clock(0.05, 4e3))
    monkeypatch.setattr(engine, "is_piecewise_linear", lambda *_: False)
    other = simulate(basis, scene, Clock(0.05, 4e3, tolerance=1e-11))
    assert exact.ledger.residual < 1e-13  # steps and rounding: 4e-15 here
    assert [(e.contact, e.what) for e in exact.events] == [(e.contact, e.what) for e in other.events]
    assert len(exact.events) > 5
    # what collocation leaves at its tolerance, over some contacts
    assert np.allclose([e.t for e in exact.events], [e.t for e in other.events], rtol=1e-8, atol=1e-12)
    for a, b in ((exact.q, other.q), (exact.qd, other.qd), (exact.pushes, other.pushes)):
        assert np.abs(a - b).max() < 1e-8 * np.abs(b).max()
    for name, contact in exact.contacts.items():
        assert contact.peak_force == pytest.approx(other.contacts[name].peak_force, rel=1e-8)
        # a flat top: the root of what the force lacks
        assert contact.peak_time == pytest.approx(other.contacts[name].peak_time, abs=1e-8)
        # steps and rounding: 2e-12 here
        assert np.abs(contact.force - other.contacts[name].force).max() < 1e-9 * contact.peak_force
    for word in ("lost_modes", "work", "structure"):
        assert getattr(exact.ledger.end, word) == pytest.approx(getattr(other.ledger.end, word), rel=1e-8)
    for word in ("lost_contacts", "lost_links", "bodies", "links", "contacts"):
        for name, value in getattr(exact.ledger.end, word).items():
            # steps and rounding: 6e-12 here
            assert value == pytest.approx(getattr(other.ledger.end, word)[name], rel=1e-11, abs=1e-11), (word, name)


def marched(response: Response, z: np.ndarray, v: np.ndarray) -> tuple[int, State]:
    """How the kernel itself ends, from any state, without samples; and where."""
    compiled = compile_scene(response.basis, response.scene, response.clock)
    system, m = compiled.system, len(compiled.system.interfaces)
    state = State(z.copy(), v.copy(), np.zeros(m, dtype=np.int64), np.zeros(m), np.zeros(len(system.rows)), np.zeros(m))
    record = empty_record(system, 0)
    steps = ExactSteps(response.clock.duration, interval=1.0, longest=np.inf, max_steps=10**6)
    how = integrate_exactly(system, state, exact_rule(), exact_workspace(system), record, steps)
    return how, state


def test_time_reversed() -> None:
    """A structure with stiffness, two bodies, contacts that close and open: back to the start."""
    basis, points = given_modes([3.0, 17.0, 60.0], [0.0] * 3, {"p": [0.6, 1.0, -0.8]})
    place = points["p"].probe("z")
    scene = Scene(
        (Body("ball", 0.3, -1.0), Body("d", 0.6)),
        (Contact("a", "ball", place, Linear(2e4), gap=1e-3), Contact("b", place, "d", Linear(3e4), gap=2e-3)),
    )
    response = simulate(basis, scene, Clock(0.2, 100.0))
    assert len(response.events) >= 4
    compiled = compile_scene(basis, scene, response.clock)
    status, there = marched(response, compiled.start[0], compiled.start[1])
    again, back = marched(response, there.z, -there.v)
    assert status == again == DONE
    assert np.abs(back.z - compiled.start[0]).max() < ROUNDING * np.abs(there.z).max()
    assert np.abs(back.v + compiled.start[1]).max() < 1e-12 * np.abs(there.v).max()  # steps and rounding: 5e-15 here


def test_a_one_way_dashpot_at_rest_does_not_chatter() -> None:
    """A body pressed on a contact until it rests, and one-way dashpots that act on rounding only: few steps, all
    the dashpots' signs decided."""
    scene = Scene(
        (Body("b", 1.0, -0.5, falls=True), Body("still", 2.0)),
        (Contact("floor", "b", GROUND, Linear(1e4, 60.0)),),
        (Link("l", "b", GROUND, opening=30.0), Link("s", "still", GROUND, 100.0, closing=5.0)),
        gravity=9.81,
    )
    response = simulate(NONE, scene, Clock(20.0, 100.0))
    assert response.contacts["floor"].force[-1] == pytest.approx(9.81, rel=ROUNDING)
    assert len(response.events) < 10
    assert (response.bodies["still"].displacement == 0).all()
    assert response.ledger.residual < ROUNDING


def test_two_bodies_that_stay_in_touch_without_force() -> None:
    """Zero gap, equal speeds: no derivative says that they close. (Masses with exact roots: no rounding drifts.)"""
    scene = Scene((Body("a", 1.0, 0.7), Body("b", 4.0, 0.7)), (Contact("c", "a", "b", Linear(1e6)),))
    response = simulate(NONE, scene, Clock(1.0, 100.0))
    assert not response.events


def test_endless_switching_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    def sticks(*args: Any) -> int:
        return ended(args[4], STICKS, 0.25, 1, 0)

    monkeypatch.setattr(engine, "integrate_exactly", sticks)
    with pytest.raises(NotConverged, match=r"switch endlessly at t = 0.25 s"):
        simulate(NONE, Scene((Body("b", 1.0),)), Clock(1.0, 100.0))


def test_step_cap_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "MAX_STEPS", 20)
    scene = Scene((Body("b", 1.0, -1.0),), (Contact("c", "b", GROUND, Linear(1e4)),))
    with pytest.raises(NotConverged, match="20 steps by t = "):
        simulate(NONE, scene, Clock(1.0, 100.0))
