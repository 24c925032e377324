"""Slabs with outlines and openings: closed forms of an L-shape, a plate cut in two, columns, walls; wrong outlines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.errors import InputError, InputErrors
from femstruct.language.models import read_model
from femstruct.model.sections import rectangle

CONCRETE = fs.Material("concrete", E=30e9, nu=0.2, rho=2400.0)
T = 0.2
CORNER = ((0.0, 0.0), (8.0, 0.0), (8.0, 4.0), (4.0, 4.0), (4.0, 8.0), (0.0, 8.0))


def frequencies(*parts: fs.Slab | fs.Plate | fs.Frame, count: int, **more: object) -> np.ndarray:
    model = fs.mesh_structure(fs.Structure("a", parts, **more))  # type: ignore[arg-type]
    basis = fs.modal_basis(fs.assemble(model), count=count)
    return np.asarray(basis.frequency_hz[basis.modes])[:count]


def held(part: str, name: str, *fix: str) -> fs.Support:
    return fs.Support(f"{name} {fix[0]}", fix, on=part, region=fs.Region("set", named=name))


def test_an_l_shaped_floor_has_the_mode_of_its_squares() -> None:
    """sin sin of three squares of 4 m is a mode of the L, hard supported: Mindlin's frequency of a square."""
    slab = fs.Slab("floor", CONCRETE, T, CORNER, mesh=0.25)
    hard = [held("floor", f"side {k}", "z", "ry" if k % 2 else "rx") for k in range(1, 7)]
    found = frequencies(slab, count=8, supports=(*hard, held("floor", "side 1", "x", "y")))
    k2, G, rho = 2.0 * (np.pi / 4.0) ** 2, 5.0 / 6.0 * CONCRETE.G, CONCRETE.rho
    D = CONCRETE.E * T**3 / 12.0 / (1.0 - 0.2**2)
    b = rho * T + k2 * (rho * T**3 / 12.0 + rho * D / G)
    squared = (b - np.sqrt(b**2 - 4.0 * D * k2**2 * rho**2 * T**3 / 12.0 / G)) / (rho**2 * T**3 / 6.0 / G)
    exact = float(np.sqrt(squared) / (2.0 * np.pi))
    assert np.abs(found / exact - 1.0).min() < k2 * 0.25**2 / 12.0  # discretisation: (k h)^2 / 12 along one direction
    assert found[0] < exact  # the L as a whole is softer than its squares


def test_a_slab_without_a_hole_is_the_plate_of_its_outline() -> None:
    """Against bfs16 with its membrane, thin: they differ by (k h)^2 / 12 and by shear."""
    slab = fs.Slab("a", CONCRETE, 0.05, ((0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)), 0.1)
    plate = fs.Plate("a", CONCRETE, 0.05, (0.0, 0.0, 0.0), (3.0, 2.0), 0.25, in_plane="elastic")
    # discretisation: the fourth free mode has 1.5 waves across 30 cells, and 2 % of shear in thin theory
    assert frequencies(slab, count=10)[6:] == pytest.approx(frequencies(plate, count=10)[6:], rel=0.02)


def test_a_slab_cut_in_two_and_joined_is_the_slab() -> None:
    whole = fs.Slab("whole", CONCRETE, T, CORNER, 0.5, ((((1.0, 1.0), (2.0, 2.0))),))
    leg = fs.Slab("leg", CONCRETE, T, ((4.0, 0.0), (8.0, 0.0), (8.0, 4.0), (4.0, 4.0)), 0.5)
    rest = fs.Slab("rest", CONCRETE, T, ((0.0, 0.0), (4.0, 0.0), (4.0, 8.0), (0.0, 8.0)), 0.5, whole.holes)
    found = frequencies(leg, rest, count=14, joints=(fs.Joint("cast", "leg", "rest"),))
    assert found[6:] == pytest.approx(frequencies(whole, count=14)[6:], rel=1e-7)  # rounding of two solutions


def test_an_opening_takes_its_mass_and_its_stiffness() -> None:
    places = [((2.0, 2.0), (2.0, 2.0)), ((1.0, 2.0), (3.5, 6.0))]
    for holes in ((), (places[0],), tuple(places)):
        slab = fs.Slab("floor", CONCRETE, T, CORNER, 0.5, holes)
        part = fs.mesh_structure(fs.Structure("a", (slab,))).parts["floor"]
        area = 48.0 - sum(a * b for (a, b), _ in holes)
        assert part.mass == pytest.approx(CONCRETE.rho * T * area, rel=1e-12)  # rounding


def test_outlines_with_bays_have_the_area_of_their_corners() -> None:
    """A U and a comb: a line from a place inside crosses sides of other legs."""
    u = ((0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (4.0, 4.0), (4.0, 2.0), (2.0, 2.0), (2.0, 4.0), (0.0, 4.0))
    comb = ((0, 0), (5, 0), (5, 2), (4, 2), (4, 1), (3, 1), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2))
    for outline, area in ((u, 20.0), (u[::-1], 20.0), (comb, 8.0)):
        slab = fs.Slab("floor", CONCRETE, T, outline, 0.5)
        part = fs.mesh_structure(fs.Structure("a", (slab,))).parts["floor"]
        assert part.mass == pytest.approx(CONCRETE.rho * T * area, rel=1e-12)  # rounding


def test_columns_stand_under_a_slab_and_walls_at_its_edge() -> None:
    """Columns at `through` carry the weight to the ground; a wall along a side joins all nodes of it."""
    feet = ((1.0, 1.0), (7.0, 1.0), (1.0, 7.0))
    slab = fs.Slab("floor", CONCRETE, T, CORNER, 0.7, through=feet)
    lines = tuple(((x, y, -3.0), (x, y, 0.0)) for x, y in feet)
    columns = fs.Frame("columns", CONCRETE, rectangle("square", 0.3, 0.3), lines, mesh=1.0)
    upright = {"normal": (1.0, 0.0, 0.0), "x_direction": (0.0, 1.0, 0.0), "in_plane": "elastic"}
    wall = fs.Plate("wall", CONCRETE, T, (8.0, 0.0, -3.0), (4.0, 3.0), 1.0, **upright)  # type: ignore[arg-type]
    joints = (fs.Joint("heads", "columns", "floor"), fs.Joint("edge", "wall", "floor", sets={"floor": "side 2"}))
    ground = fs.Support("foot", "clamped", on="wall", edge="y0")
    points = (fs.PlaceOn("feet", "columns", tuple(line[0] for line in lines)),)
    base = fs.Support("base", "clamped", at="feet")
    model = fs.mesh_structure(fs.Structure("a", (slab, columns, wall), joints, points, supports=(ground, base)))
    basis = fs.modal_basis(fs.assemble(model), count=4)
    assert basis.n_rigid == 0 and (basis.frequency_hz[basis.modes] > 1.0).all()
    slab_nodes = model.mesh.points[model.parts["floor"].nodes]
    along = slab_nodes[np.abs(slab_nodes[:, 0] - 8.0) < 1e-9]
    top = model.mesh.points[model.parts["wall"].nodes]
    top = top[np.abs(top[:, 2]) < 1e-9]
    # rounding: the wall takes the slab's nodes
    assert sorted(along[:, 1]) == pytest.approx(sorted(top[:, 1]), abs=1e-12)


MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts:
  floor: {type: slab, material: concrete, thickness: 20 cm, mesh: 0.5,
    outline: [[0, 0], [8, 0], [8, 4], [4, 4], [4, 8], [0, 8]],
    holes: [{rectangle: [2, 1 m], at: [2, 6]}], through: [[1, 1.1]], origin: [0, 0, 3]}
points: {spot: {on: floor, at: [6, 2]}}
surfaces: {under: {on: floor, side: below}}
supports: {walls: {on: floor, set: rim, fix: [z]}, shaft: {on: floor, set: hole 1, fix: simple}}
"""


def test_the_underside_of_an_l_has_the_outline_of_the_l() -> None:
    """What a room is placed by: the rectangle round it would reach beyond an L-shaped room."""
    slab = fs.Slab("floor", CONCRETE, T, CORNER, 0.7, ((((1.0, 1.0), (2.0, 2.0))),), origin=(1.0, 0.0, 3.0))
    model = fs.mesh_structure(fs.Structure("a", (slab,), surfaces=(fs.SurfaceOn("under", "floor", "below"),)))
    outline = model.surfaces["under"].outline
    assert {tuple(np.round(corner, 9)) for corner in outline} == {(x + 1.0, y, 3.0) for x, y in CORNER}
    assert model.surfaces["under"].along.tolist() == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]  # not mirrored from below
    plain = fs.mesh_structure(fs.Structure("a", (slab.shell(),), surfaces=(fs.SurfaceOn("under", "floor", "below"),)))
    assert plain.surfaces["under"].along.tolist() == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    steps = np.roll(outline, -1, axis=0) - outline
    assert np.abs(steps).sum() == pytest.approx(32.0, rel=1e-12)  # round it in turn; rounding


def test_what_is_written_is_meshed(tmp_path: Path) -> None:
    (tmp_path / "floor.yaml").write_text(MODEL, encoding="utf-8")
    model = read_model(tmp_path / "floor.yaml")
    assert model.points["spot"].position == pytest.approx([6.0, 2.0, 3.0])
    assert model.surfaces["under"].weights.sum() == pytest.approx(46.0, rel=1e-12)  # rounding
    assert np.abs(model.mesh.points - [1.0, 1.1, 3.0]).max(axis=1).min() < 1e-12


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[4, 4], [4, 8]", "[4, 5], [4, 8]", r"parts\.floor\.outline: got a side from \(8, 4\) to \(4, 5\) m"),
        ("[[0, 0], [8, 0], [8, 4], [4, 4], [4, 8], [0, 8]]", "[[0, 0], [8, 0], [8, 4]]", r"parts\.floor\.outline: .*4"),
        ("[8, 4], [4, 4], [4, 8], [0, 8]]", "[8, 8], [4, 8], [4, -2], [0, -2]]", r"got an outline that crosses"),
        ("at: [2, 6]}", "at: [3.5, 6]}", r"parts\.floor\.holes: got a hole of 2 m x 1 m at \(3\.5, 6\) m that is not"),
        ("at: [2, 6]}", "at: [4, 4]}", r"parts\.floor\.holes: got a hole .* not inside, expected holes inside"),
        ("through: [[1, 1.1]]", "through: [[5, 5]]", r"parts\.floor\.through: got \(5, 5\) m, expected a place on it"),
        ("mesh: 0.5", "mesh: 1 mm", r"parts\.floor\.mesh: got 0\.001 m, 6400\d* cells, expected at most"),
        ("at: [6, 2]", "at: [6, 6]", r"points\.spot\.at: got .* off floor, expected a place on it; the nearest is"),
        ("at: [6, 2]", "at: [6, 2, 3]", r"points\.spot\.at: got 3 coordinates, expected 2 on a slab"),
        ("at: [6, 2]", "at: center", r"points\.spot\.at: got center of a slab, .* outline, whose middle is \["),
        ("set: rim", "set: hole 2", r"supports\.walls\.set: got 'hole 2', no set of floor, expected side 1, side 2"),
        ("thickness: 20 cm, ", "", r"parts\.floor\.thickness: got nothing, expected 'thickness'"),
    ],
)  # fmt: skip
def test_wrong_outlines_are_refused_in_a_line(old: str, new: str, message: str, tmp_path: Path) -> None:
    assert old in MODEL
    (tmp_path / "floor.yaml").write_text(MODEL.replace(old, new), encoding="utf-8")
    with pytest.raises(InputErrors, match=message) as caught:
        read_model(tmp_path / "floor.yaml")
    assert len(caught.value.errors) == 1 and caught.value.errors[0].startswith(f"{tmp_path}/floor.yaml:")


def test_holes_and_thicknesses_in_python() -> None:
    for change, message in (
        ({"holes": (((0.0, 1.0), (2.0, 2.0)),)}, "two positive sides"),
        ({"thickness": -0.1}, "a positive length"),
        ({"mesh": 0.0}, "a positive length"),
    ):
        with pytest.raises(InputError, match=message):
            fs.Slab(**{"name": "a", "material": CONCRETE, "thickness": T, "outline": CORNER, "mesh": 0.5} | change)
