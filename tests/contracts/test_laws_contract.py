"""What every contact law must have, run on all registered ones: code that fits its energy, a word in the language."""

from __future__ import annotations

import ast
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

import femstruct
from femstruct.compiled.records import INTERFACE, System
from femstruct.impact.propagation import law as force_at
from femstruct.impact.propagation import sense
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.system import compile_scene
from femstruct.language.bodies import LAW_KINDS
from femstruct.laws.cubic import Cubic
from femstruct.laws.flores import Flores
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.lankarani_nikravesh import LankaraniNikravesh
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.laws.own import OwnLaw
from femstruct.laws.registry import CODES, DOUBTS, LAWS, beside, spring
from femstruct.laws.stop import Stop
from femstruct.laws.tabulated import Tabulated
from femstruct.modal.closed_form import given_modes

ROUNDING = 1e-13  # rounding: 3e-16 here at most

ROOT = Path(femstruct.__file__).parent


def own_force(d: float, rate: float, p: np.ndarray) -> float:
    return p[0] * d * (1.0 + d) * max(0.0, 1.0 + p[1] * rate)


def own_energy(d: float, p: np.ndarray) -> float:
    return p[0] * d * d * (0.5 + d / 3.0)


EXAMPLES: list[Law] = [
    Cubic(1e5, 3e11, 0.2),
    Flores(1e8, 0.5, 2.5),
    Hertz(1e8, 2e4),
    HuntCrossley(1e10, 2.2, 1.5),
    LankaraniNikravesh(1e8, 0.8, 2.5),
    Linear(5e5, 120.0),
    OwnLaw(own_force, own_energy, [2e6, 0.3], deepest=3e-3, fastest=3.0),
    Stop(5e5, 120.0),
    Tabulated(np.array([0.0, 0.2e-3, 0.5e-3, 3e-3]), np.array([0.0, 40.0, 160.0, 2500.0]), 0.1),
]
DEPTHS = np.array([1e-5, 1.3e-4, 6e-4, 2.1e-3])
every_law = pytest.mark.parametrize("law", EXAMPLES, ids=lambda law: type(law).__name__)


def compiled(law: Law) -> System:
    scene = Scene((Body("b", 1.0, -1.0),), (Contact("c", "b", GROUND, law),))
    return compile_scene(given_modes([], [], {})[0], scene, Clock(1.0, 1.0)).system


def test_all_laws_are_here() -> None:
    assert {type(law) for law in EXAMPLES} == set(LAWS)
    assert len({law.code for law in EXAMPLES}) == len(CODES)


@every_law
def test_the_spring_is_the_derivative_of_its_energy(law: Law) -> None:
    system = compiled(law)
    for depth in DEPTHS:
        h = 1e-4 * depth  # central differences: their error is 1e-8, that of rounding 1e-12
        force, slope, energy = spring(system, 0, depth)
        (below, _, held), (above, _, more) = spring(system, 0, depth - h), spring(system, 0, depth + h)
        assert force > 0.0
        assert slope > 0.0
        assert energy > 0.0
        assert force == pytest.approx((more - held) / (2 * h), rel=1e-6)  # central differences, h^2: 9e-9 here
        assert slope == pytest.approx((above - below) / (2 * h), rel=1e-6)  # central differences, h^2: 3e-9 here
        assert law.indentation(force) == pytest.approx(depth, rel=ROUNDING)
        for moved in (0.3 * depth, -0.2 * depth):
            taken = spring(system, 0, depth + moved)[2] - energy - force * moved
            assert beside(system, 0, depth, moved) == pytest.approx(taken, rel=1e-12)  # rounding: 2e-15 here


@every_law
def test_the_force_has_its_derivatives_and_a_dashpot_that_only_takes(law: Law) -> None:
    system = compiled(law)
    for depth in DEPTHS:
        for speed in (-1.1, -0.2, 0.0, 0.4, 3.0):
            force, by_depth, by_speed, drag = force_at(system, 0, depth, speed)
            h, w = 1e-4 * depth, 1e-4
            ahead, behind = (force_at(system, 0, depth + side * h, speed)[0] for side in (1, -1))
            faster, slower = (force_at(system, 0, depth, speed + side * w)[0] for side in (1, -1))
            still = spring(system, 0, depth)[0]
            # relative to its terms: with a dashpot that pulls they cancel
            assert by_depth == pytest.approx((ahead - behind) / (2 * h), rel=1e-6, abs=1e-6 * still / depth)
            # central differences, h^2: 3e-10 here
            assert by_speed == pytest.approx((faster - slower) / (2 * w), rel=1e-8)
            assert drag >= 0.0
            assert force == pytest.approx(still + drag * speed, rel=ROUNDING, abs=ROUNDING * still)
            if not law.tensile:
                constant, of_depth, of_speed = sense(system, 0)
                pushes = constant + of_depth * depth + of_speed * speed
                assert np.sign(pushes) == np.sign(force)


@every_law
def test_what_varies_is_where_the_engine_has_it(law: Law) -> None:
    """Numbers that differ between the runs of a batch take the place of the law's own."""
    system, names = compiled(law), {one.name for one in fields(law)}  # type: ignore[arg-type]
    for word, place in law.varies.items():
        assert word in names
        assert place in (INTERFACE.names or ())
        assert system.interfaces[0][place] == getattr(law, word)
    assert law.doubted_from.keys() == law.doubts.keys() <= DOUBTS.keys()


def test_a_study_file_knows_every_law_with_a_word() -> None:
    words = {law.word for law in LAWS if law.word}
    types = {spec.model_fields["type"].annotation.__args__[0] for spec in LAW_KINDS}  # type: ignore[union-attr]
    assert words == types


def test_nobody_else_asks_which_law_it_is() -> None:
    """Outside their package no module tests for the class of a law, or matches on it."""
    names = {law.__name__ for law in LAWS}
    for path in ROOT.rglob("*.py"):
        if path.parent.name == "laws":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            asked: list[ast.AST] = []
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "isinstance":
                asked = [node.args[1]]
            if isinstance(node, ast.MatchClass):
                asked = [node.cls]
            used = {one.id for each in asked for one in ast.walk(each) if isinstance(one, ast.Name)}
            assert not used & names, f"{path}: {used & names}"
