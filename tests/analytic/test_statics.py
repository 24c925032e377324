"""Structures at rest against closed forms: weight, forces, what the supports take."""

from __future__ import annotations

import numpy as np
import pytest

import femstruct as fs
from femstruct.conventions import GRAVITY
from femstruct.errors import InputError
from femstruct.model.section import rectangle

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)


def at_rest(structure: fs.Structure, *forces: tuple[str, str, float], weight: bool = False) -> tuple[object, fs.AtRest]:
    model = fs.mesh_structure(structure)
    probes = [(model.points[name].probe(direction), force) for name, direction, force in forces]
    return model, fs.statics(model, fs.assemble(model), probes, weight)


def test_a_beam_on_two_supports_under_its_weight_and_a_force() -> None:
    """5 q L^4 / 384 E I + F L^3 / 48 E I with shear; each support takes half of both."""
    bar = fs.Frame("bar", STEEL, rectangle("s", 0.02, 0.04), (((0.0, 0.0, 0.0), (2.0, 0.0, 0.0)),), mesh=0.05)
    points = tuple(
        fs.PlaceOn(name, "bar", at=((x, 0.0, 0.0),)) for name, x in (("a", 0.0), ("middle", 1.0), ("b", 2.0))
    )
    supports = (fs.Support("left", ("x", "y", "z", "rx"), at="a"), fs.Support("right", ("y", "z"), at="b"))
    structure = fs.Structure("a beam", (bar,), points=points, supports=supports)
    model, rest = at_rest(structure, ("middle", "z", -100.0), weight=True)
    A, I, q = 8e-4, 0.02 * 0.04**3 / 12, 7850.0 * 8e-4 * GRAVITY  # noqa: E741 - the second moment of area
    shear = (q * 4.0 / 8 + 100.0 * 2.0 / 4) / (5 / 6 * STEEL.G * A)
    exact = 5 * q * 16.0 / (384 * STEEL.E * I) + 100.0 * 8.0 / (48 * STEEL.E * I) + shear
    assert rest.of(model.points["middle"].probe("z")) == pytest.approx(-exact, rel=2e-3)  # weight at nodes: h^2
    for name in ("left", "right"):
        assert rest.forces[name][2] == pytest.approx(-(q * 2.0 + 100.0) / 2, rel=1e-9)  # solved to rounding
    np.testing.assert_allclose(rest.load, [0, 0, -q * 2.0 - 100.0], atol=1e-9)  # rounding
    np.testing.assert_allclose(rest.forces["ground"], rest.load, atol=1e-6)  # rounding of 200 N over stiff bars


def test_a_slab_under_its_weight() -> None:
    """0.00406 q a^4 / D in the middle of a simply supported square, and q a^2 on its edges."""
    slab = fs.Plate("slab", STEEL, 0.01, origin=(0.0, 0.0, 0.0), size=(1.0, 1.0), mesh=(32, 32))
    middle = fs.PlaceOn("middle", "slab", at=((0.5, 0.5),))
    rim = fs.Support("rim", "simple", on="slab", edge="all")
    model, rest = at_rest(fs.Structure("a slab", (slab,), points=(middle,), supports=(rim,)), weight=True)
    q, D = 7850.0 * 0.01 * GRAVITY, 210e9 * 1e-6 / 12 / 0.91
    assert rest.of(model.points["middle"].probe("z")) == pytest.approx(-0.00406 * q / D, rel=4e-3)  # three digits
    assert rest.forces["rim"][2] == pytest.approx(-q, rel=1e-9)  # solved to rounding


def test_masses_and_blocks_weigh() -> None:
    block = fs.Block("block", 120.0, origin=(0.0, 0.0, 0.0), size=(1.0, 0.5, 0.2))
    feet = fs.PlaceOn("feet", "block", at=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.5, 0.0), (1.0, 0.5, 0.0)))
    springs = fs.Spring("springs", "feet", None, stiffness=(1e5, 1e5, 1e5, 0.0, 0.0, 0.0))
    top = fs.PlaceOn("top", "block", at=((0.5, 0.25, 0.2),))
    load = fs.Mass("load", 30.0, at="top")
    model, rest = at_rest(fs.Structure("on springs", (block, springs, load), points=(feet, top)), weight=True)
    assert rest.of(model.points["top"].probe("z")) == pytest.approx(-150.0 * GRAVITY / 4e5, rel=1e-9)  # rounding
    assert rest.forces["ground"][2] == pytest.approx(-150.0 * GRAVITY, rel=1e-9)  # rounding


def test_what_can_move_as_a_whole_is_refused() -> None:
    slab = fs.Plate("slab", STEEL, 0.01, origin=(0.0, 0.0, 0.0), size=(1.0, 1.0), mesh=(2, 2))
    with pytest.raises(InputError, match="a structure that can move as a whole"):
        at_rest(fs.Structure("free", (slab,)), weight=True)
