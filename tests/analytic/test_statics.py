"""Structures at rest against closed forms: weight, forces, what the supports take."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import femstruct as fs
from femstruct.conventions import GRAVITY
from femstruct.errors import InputError
from femstruct.files.matrices_input import read_component
from femstruct.model.sections import rectangle, tube
from femstruct.workflow.bases import sags
from femstruct.workflow.model_answers import statics_table as table_at_rest
from femstruct.workflow.recorded_channels import stress_at_rest, stress_findings

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
    assert rest.of(model.points["middle"].probe("z")) == pytest.approx(-exact, rel=1e-9)  # rounding
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


RIBBED = """
title: a rib under a strip of slab
materials: {concrete: {E: 30 GPa, nu: 0, rho: 2400}, steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {bar: {shape: rectangle, width: 0.1, height: 0.2}}
parts:
  slab: {type: plate, material: concrete, thickness: 180 mm, origin: [0, 0, 0], size: [8, 1], mesh: 0.25}
  rib: {type: frame, material: steel, section: bar, lines: [[[0, 0.5, 0], [8, 0.5, 0]]],
        offsets: {start: [0, 0, -0.19], end: [0, 0, -0.19]}}
joints: {studs: {connect: [rib, slab]}}
supports: {left: {on: slab, edge: x0, fix: simple}, right: {on: slab, edge: x1, fix: roller}}
points: {middle: {on: slab, at: [4, 0.5]}}
"""


@pytest.mark.parametrize("held", [False, True])
def test_a_sag_of_a_plate_that_does_not_stretch_is_not_to_be_trusted(held: bool, tmp_path: Path) -> None:
    """5 q L^4 / 384 E I with E I of the T; where the plate cannot stretch it is stiffer, and that is said."""
    text = RIBBED.replace("mesh: 0.25", "mesh: 0.25, in_plane: rigid") if held else RIBBED
    (tmp_path / "ribbed.yaml").write_text(text)
    table = table_at_rest(tmp_path / "ribbed.yaml", [], weight=True)
    slab, rib = 30e9 * 0.18, 210e9 * 0.02  # E A
    bending = 30e9 * 0.18**3 / 12 + 210e9 * 0.1 * 0.2**3 / 12 + 0.19**2 * slab * rib / (slab + rib)
    sag = -5 * (0.18 * 2400 + 0.02 * 7850) * GRAVITY * 8.0**4 / (384 * bending)
    forbids = [finding["code"] for finding in table["findings"] if finding["severe"]]
    if held:
        assert abs(table["points"]["middle"][2]) < 0.9 * abs(sag)
        assert forbids == ["eccentric-bars"]
    else:
        assert table["points"]["middle"][2] == pytest.approx(sag, rel=2e-2)  # shear of the rib, bending across the slab
        assert forbids == []


BLOCK_AT_ITS_CORNER = """
title: a block that leans
parts:
  block: {type: block, mass: 100 kg, origin: [0, 0, 0], size: [0.4, 0.2, 0.3]}
  bed: {type: foundation, on: block, stiffness: {normal: 10 MN/m^3, shear: 2 MN/m^3}}
points:
  top: {on: block, at: [0.4, 0.2, 0.3]}
"""


def test_the_largest_displacement_of_a_block_is_that_of_a_corner(tmp_path: Path) -> None:
    """A pull along x at a top corner, by the rigidity of the bed: shift k_s A, rocking k_n I, turn k_s (Ix + Iy)."""
    (tmp_path / "block.yaml").write_text(BLOCK_AT_ITS_CORNER)
    table = table_at_rest(tmp_path / "block.yaml", ["top.x=50 N"], weight=False)
    a, b, h, force = 0.4, 0.2, 0.3, 50.0
    shift = force / (2e6 * a * b)
    rocking = force * h / (1e7 * b * a**3 / 12)
    turn = -force * (b / 2) / (2e6 * a * b * (a**2 + b**2) / 12)
    corners = [
        (shift + rocking * z - turn * y, turn * x, -rocking * x)
        for x in (-a / 2, a / 2)
        for y in (-b / 2, b / 2)
        for z in (0.0, h)
    ]
    largest = max(np.linalg.norm(one) for one in corners)
    assert table["parts_m"]["block"] == pytest.approx(largest, rel=1e-9)  # both are exact, rounding
    assert np.linalg.norm(table["points"]["top"][:3]) == pytest.approx(largest, rel=1e-9)  # where it is largest


def test_what_can_move_as_a_whole_is_refused() -> None:
    slab = fs.Plate("slab", STEEL, 0.01, origin=(0.0, 0.0, 0.0), size=(1.0, 1.0), mesh=(2, 2))
    with pytest.raises(InputError, match="a structure that can move as a whole"):
        at_rest(fs.Structure("free", (slab,)), weight=True)


@pytest.mark.parametrize("bars", [1, 2, 5])
def test_a_cantilever_under_its_weight_is_exact_at_its_nodes(bars: int) -> None:
    """w L^4 / 8 E I + w L^2 / 2 k G A at the tip; the wall takes all of it, what stands on it, too."""
    line = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    bar = fs.Frame("bar", STEEL, rectangle("s", 0.01, 0.02), (line,), mesh=1.0 / bars)
    points = tuple(fs.PlaceOn(name, "bar", at=((x, 0.0, 0.0),)) for name, x in (("foot", 0.0), ("tip", 1.0)))
    wall, lump = fs.Support("wall", "clamped", at="foot"), fs.Mass("lump", 3.0, at="foot")
    model, rest = at_rest(fs.Structure("a bar", (bar, lump), points=points, supports=(wall,)), weight=True)
    A, I, w = 2e-4, 0.01 * 0.02**3 / 12, 7850.0 * 2e-4 * GRAVITY  # noqa: E741 - the second moment of area
    exact = w / (8 * STEEL.E * I) + w / (2 * 5 / 6 * STEEL.G * A)
    assert rest.of(model.points["tip"].probe("z")) == pytest.approx(-exact, rel=1e-9)  # rounding
    for name in ("wall", "ground"):
        assert rest.forces[name] == pytest.approx([0.0, 0.0, -w - 3.0 * GRAVITY], abs=1e-7)  # rounding of stiff bars
    np.testing.assert_allclose(rest.load, [0.0, 0.0, -w - 3.0 * GRAVITY], rtol=1e-12)  # rounding


def test_matrices_weigh_where_their_mass_is(tmp_path: Path) -> None:
    """Masses of 1 and 99 kg on a spring of 300 N/mm: the upper one sinks by 99 g / k, the foot takes both."""
    K = np.zeros((6, 6))
    for axis, k in enumerate((1e5, 2e5, 3e5)):
        K[np.ix_([axis, axis + 3], [axis, axis + 3])] = [[k, -k], [-k, k]]
    places = {"nodes": [0, 0, 0, 1, 1, 1], "components": [0, 1, 2] * 2, "points": [[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]]}
    np.savez(tmp_path / "two.npz", M=np.diag([1.0, 1.0, 1.0, 99.0, 99.0, 99.0]), K=K, **places)
    fan = fs.Substructure("fan", read_component(tmp_path / "two.npz"))
    points = tuple(fs.PlaceOn(name, "fan", at=((0.0, 0.0, z),)) for name, z in (("foot", 0.0), ("head", 0.5)))
    wall = fs.Support("wall", ("x", "y", "z"), at="foot")
    structure = fs.Structure("a fan", (fan,), points=points, supports=(wall,))
    model, rest = at_rest(structure, weight=True)
    assert rest.of(model.points["head"].probe("z")) == pytest.approx(-99.0 * GRAVITY / 3e5, rel=1e-12)  # rounding
    assert rest.forces["wall"] == pytest.approx([0.0, 0.0, -100.0 * GRAVITY], abs=1e-9)  # rounding
    (sag,) = sags(model, fs.modal_basis(fs.assemble(model), count=3))
    assert sag.sag == pytest.approx(99.0 * GRAVITY / 3e5, rel=1e-9)  # check says the same


@pytest.mark.parametrize("element", ["euler", "timoshenko", "timoshenko18"])
@pytest.mark.parametrize("bars", [1, 3])
@pytest.mark.parametrize("end", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.48, 0.36, 0.8)])
def test_the_foot_of_a_bar_is_stressed_by_all_of_its_weight(element: str, bars: int, end: tuple[float, ...]) -> None:
    """w sin / A + w cos (r / I) / 2 of a tube of 1 m: axial force and moment are largest at the foot."""
    mast = fs.Frame("mast", STEEL, tube("s", 0.03, 0.002), (((0.0, 0.0, 0.0), end),), mesh=1.0 / bars, element=element)
    foot = fs.PlaceOn("foot", "mast", at=((0.0, 0.0, 0.0),))
    wall = fs.Support("wall", "clamped", at="foot")
    model, rest = at_rest(fs.Structure("a mast", (mast,), points=(foot,), supports=(wall,)), weight=True)
    section, level = mast.section, float(np.hypot(*end[:2]))
    w = 7850.0 * section.A * GRAVITY
    found = stress_at_rest(model.parts["mast"].stresses(model.mesh.n_nodes), rest.displacement, weight=True)
    exact = w * end[2] / section.A + w * level / 2.0 * 0.015 / section.Iy  # its axes stand: a point is uppermost
    assert found.largest.max() == pytest.approx(exact, rel=1e-8)  # rounding of bars of three nodes, which are stiff
    assert abs(found.places[found.largest.argmax()] @ end) < 0.02  # at the foot
    assert (found.jump, found.falls) == (0.0, 0.0)


def test_a_moment_that_falls_along_a_bar_is_not_uneven() -> None:
    """F L / (b h^2 / 6) at the wall of a cantilever of four bars, a quarter less at the next node: both are exact."""
    bar = fs.Frame("bar", STEEL, rectangle("s", 0.02, 0.04), (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), mesh=0.25)
    points = tuple(fs.PlaceOn(name, "bar", at=((x, 0.0, 0.0),)) for name, x in (("foot", 0.0), ("tip", 1.0)))
    wall = fs.Support("wall", "clamped", at="foot")
    model, rest = at_rest(fs.Structure("a bar", (bar,), points=points, supports=(wall,)), ("tip", "z", -100.0))
    found = stress_at_rest(model.parts["bar"].stresses(model.mesh.n_nodes), rest.displacement)
    assert found.largest.max() == pytest.approx(100.0 / (0.02 * 0.04**2 / 6), rel=1e-9)  # rounding
    assert not list(stress_findings({"bar": found}))


ENDS = {"hinged": (("x", "y", "z", "rx"), ("x", "y", "z")), "clamped": ("clamped", "clamped")}


def beam(element: str, ends: str, **also: Any) -> fs.Structure:
    """A bar of 1 m, 20 by 40 mm, of one element where no point asks for more, held at both ends."""
    bar = fs.Frame("bar", STEEL, rectangle("s", 0.02, 0.04), (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), element=element)
    places = {"left": 0.0, "right": 1.0} | also.get("points", {})
    points = tuple(fs.PlaceOn(name, "bar", at=((x, 0.0, 0.0),)) for name, x in places.items())
    supports = tuple(fs.Support(f"at {at}", fix, at=at) for at, fix in zip(places, ENDS[ends], strict=False))
    return fs.Structure("a beam", (bar, *also.get("parts", ())), points=points, supports=supports)


@pytest.mark.parametrize(
    ("element", "ends"),
    [("euler", "hinged"), ("timoshenko", "hinged"), ("timoshenko18", "hinged"), ("timoshenko18", "clamped")],
)
@pytest.mark.parametrize("paint", [None, 40.0])
def test_one_bar_sags_and_is_stressed_between_its_ends(element: str, ends: str, paint: float | None) -> None:
    """w L^2 / 8 in the middle of a beam on hinges, w L^2 / 12 at clamped ends; 5 or 1 w L^4 / 384 E I, and the shear
    w L^2 / 8 k G A beside. With a mass along it, too."""
    moment, bent = {"hinged": (1 / 8, 5 / 384), "clamped": (1 / 12, 1 / 384)}[ends]
    parts = () if paint is None else (fs.Mass("paint", paint, on="bar", per="length"),)
    model, rest = at_rest(beam(element, ends, parts=parts), weight=True)
    A, I, W = 8e-4, 0.02 * 0.04**3 / 12, 0.02 * 0.04**2 / 6  # noqa: E741 - the second moment of area
    w = GRAVITY * (7850.0 * A + (paint or 0.0))
    found = stress_at_rest(model.parts["bar"].stresses(model.mesh.n_nodes), rest.displacement, weight=True)
    assert found.largest.max() == pytest.approx(w * moment / W, rel=1e-8)  # rounding of bars of three nodes
    sag = w * bent / (STEEL.E * I) + (0.0 if element == "euler" else w / (8 * 5 / 6 * STEEL.G * A))
    moved = model.parts["bar"].moved(rest.displacement, GRAVITY)
    assert -moved[:, 2].min() == pytest.approx(sag, rel=1e-8)  # rounding
    (one,) = sags(model, fs.modal_basis(fs.assemble(model), count=1))
    assert one.sag == pytest.approx(sag, rel=1e-8)  # check says the same


@pytest.mark.parametrize("element", ["euler", "timoshenko", "timoshenko18"])
def test_a_rod_stretches_between_its_ends(element: str) -> None:
    """An upright bar held at both ends: w L^2 / 8 E A in its middle, w L / 2 A at both ends."""
    line = (((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),)
    bar = fs.Frame("bar", STEEL, rectangle("s", 0.02, 0.04), line, element=element)
    points = tuple(fs.PlaceOn(name, "bar", at=((0.0, 0.0, z),)) for name, z in (("foot", 0.0), ("head", 1.0)))
    held = {"foot": ("x", "y", "z", "rz"), "head": ("x", "y", "z")}
    supports = tuple(fs.Support(f"at {at}", fix, at=at) for at, fix in held.items())
    model, rest = at_rest(fs.Structure("a rod", (bar,), points=points, supports=supports), weight=True)
    moved = model.parts["bar"].moved(rest.displacement, GRAVITY)
    assert -moved[:, 2].min() == pytest.approx(7850.0 * GRAVITY / 8 / STEEL.E, rel=1e-8)  # rounding
    found = stress_at_rest(model.parts["bar"].stresses(model.mesh.n_nodes), rest.displacement, weight=True)
    assert found.largest.max() == pytest.approx(7850.0 * GRAVITY / 2, rel=1e-8)  # rounding


@pytest.mark.parametrize("element", ["euler", "timoshenko", "timoshenko18"])
@pytest.mark.parametrize("at", [0.5, 0.3])
def test_a_force_anywhere_along_a_bar_bends_it_as_a_beam(element: str, at: float) -> None:
    """On hinges P a b / L under the force; P a^2 b^2 / 3 E I L, and the shear P a b / k G A L: also the static limit of
    a frequency response."""
    model, rest = at_rest(beam(element, "hinged", points={"hit": at}), ("hit", "z", -100.0))
    I, W, ab = 0.02 * 0.04**3 / 12, 0.02 * 0.04**2 / 6, at * (1.0 - at)  # noqa: E741 - the second moment of area
    found = stress_at_rest(model.parts["bar"].stresses(model.mesh.n_nodes), rest.displacement)
    assert found.largest.max() == pytest.approx(100.0 * ab / W, rel=1e-8)  # rounding
    each = ab**2 / (3 * STEEL.E * I) + (0.0 if element == "euler" else ab / (5 / 6 * STEEL.G * 8e-4))
    hit = model.points["hit"].probe("z")
    assert rest.of(hit) == pytest.approx(-100.0 * each, rel=1e-8)  # rounding
    basis = fs.modal_basis(fs.assemble(model), count=1, probes=[hit])
    assert fs.frf(basis, hit, hit, [0.0])[0].real == pytest.approx(each, rel=1e-8)  # rounding


@pytest.mark.parametrize("kind", ["plate", "slab"])
def test_a_point_of_a_rib_leaves_the_grid_of_its_plate(kind: str) -> None:
    """Where bars have the nodes of a plate or slab, a point of them moves none, as one of the plate does not: between
    two of them it would not be joined."""
    corners = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.8), (0.0, 0.8))
    plate: fs.Plate | fs.Slab = fs.Slab("plate", STEEL, 0.01, corners, mesh=0.25, through=((0.5, 0.4),))
    if kind == "plate":
        plate = fs.Plate("plate", STEEL, 0.01, origin=(0.0, 0.0, 0.0), size=(1.0, 0.8), mesh=(4, 4))
    rib = fs.Frame("rib", STEEL, rectangle("s", 0.02, 0.04), (((0.0, 0.4, 0.0), (1.4, 0.4, 0.0)),), mesh=0.4)
    joint = fs.Joint("weld", "plate", "rib")
    counts = []
    for x in ((), (0.37,), (1.13,)):
        points = tuple(fs.PlaceOn("hit", "rib", at=((one, 0.4, 0.0),)) for one in x)
        model = fs.mesh_structure(fs.Structure("ribbed", (plate, rib), joints=(joint,), points=points))
        counts.append((len(model.parts["plate"].nodes), len(model.parts["rib"].lines)))
    assert counts == [(25, 5), (25, 5), (25, 6)]  # beyond the plate the rib has a node of its own more
