"""Mesh files that Gmsh writes, in every format of both, against the geometry that they were made of: the whole area or
volume, the middle of every edge, and the members of every group."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

import femstruct as fs
from femstruct.decks.mesh_file import read_mesh_file
from femstruct.elements.stresses import von_mises
from femstruct.model.imported_mesh import KINDS, ImportedMesh

SIDES = (1.2, 0.7, 0.5)
FORMATS = {"2.2 text": (2.2, 0), "2.2 binary": (2.2, 1), "4.1 text": (4.1, 0), "4.1 binary": (4.1, 1)}
CELLS = ("tri3", "quad4", "tri6", "quad8", "quad9", "tet4", "hex8", "tet10", "hex20", "hex27")


@pytest.fixture(scope="module")
def gmsh() -> Iterator[Any]:
    try:
        import gmsh
    except (ImportError, OSError) as error:  # its wheel needs libGLU and X libraries
        pytest.skip(f"gmsh cannot be loaded here: {error}")
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    yield gmsh
    gmsh.finalize()


def build(gmsh: Any, kind: str) -> None:
    """A box, or its lower side, of cells of one kind, with two groups of all cells, one of a side, one of a corner."""
    of, order = KINDS[kind], 2 if KINDS[kind].quadratic else 1
    gmsh.clear()
    gmsh.model.add("box")
    regular = kind.startswith(("quad", "hex"))
    face = gmsh.model.occ.addRectangle(0, 0, 0, *SIDES[:2])
    if of.dimension == 3:
        gmsh.model.occ.extrude([(2, face)], 0, 0, SIDES[2], [2] if regular else [], recombine=regular)
    gmsh.model.occ.synchronize()
    for _, tag in gmsh.model.getEntities(1) if regular else ():
        gmsh.model.mesh.setTransfiniteCurve(tag, 4)
    for _, tag in gmsh.model.getEntities(2) if regular else ():
        gmsh.model.mesh.setTransfiniteSurface(tag)
        gmsh.model.mesh.setRecombine(2, tag)
    whole = [tag for _, tag in gmsh.model.getEntities(of.dimension)]
    side = gmsh.model.getEntities(of.dimension - 1)[0][1]
    for dimension, tags, number, name in (
        (of.dimension, whole, 1, "all cells"),
        (of.dimension, whole, 2, "again"),
        (of.dimension - 1, [side], 3, "side"),
        (0, [1], 4, "corner"),
    ):
        gmsh.model.addPhysicalGroup(dimension, tags, number, name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", int(kind in ("quad8", "hex20")))
    gmsh.model.mesh.generate(of.dimension)
    gmsh.model.mesh.setOrder(order)


def size(mesh: ImportedMesh, kind: str) -> float:
    """Area or volume of the cells by their corners, positive where they are numbered as VTK numbers them."""
    p = mesh.points[mesh.cells[kind]]
    if KINDS[kind].dimension == 2:
        corners = p[:, : KINDS[kind].corners]
        return float(np.cross(corners, np.roll(corners, -1, axis=1)).sum(axis=1)[:, 2].sum() / 2.0)
    total = 0.0
    for face in KINDS[kind].faces:  # divergence of x / 3; the faces of a box's cells are flat
        corners = p[:, list(face)]
        for i in range(1, len(face) - 1):
            one, two, three = corners[:, 0], corners[:, i], corners[:, i + 1]
            total += float(np.einsum("ci,ci->", one, np.cross(two, three)) / 6.0)
    return total


def off_the_middle(mesh: ImportedMesh, kind: str) -> float:
    """How far nodes in the middles of edges, faces and cells are from there; the cells are straight."""
    of, p = KINDS[kind], mesh.points[mesh.cells[kind]]
    edges = np.array(of.edges)
    last = of.corners + len(edges)
    found = [p[:, of.corners : last] - p[:, edges].mean(axis=2)]
    if of.nodes > last and of.faces:
        found.append(p[:, last:-1] - p[:, np.array(of.faces)].mean(axis=2))
    if of.nodes > last:
        found.append(p[:, -1] - p[:, : of.corners].mean(axis=1))
    return max(float(np.abs(one).max()) for one in found)


def check(mesh: ImportedMesh, kind: str, digits: float) -> None:
    of = KINDS[kind]
    assert size(mesh, kind) == pytest.approx(np.prod(SIDES[: of.dimension]), rel=digits)
    if of.quadratic:
        assert off_the_middle(mesh, kind) < digits


@pytest.mark.parametrize("written", FORMATS)
@pytest.mark.parametrize("kind", CELLS)
def test_a_mesh_of_gmsh_is_read_as_it_is(gmsh: Any, kind: str, written: str, tmp_path: Path) -> None:
    build(gmsh, kind)
    version, binary = FORMATS[written]
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.write(str(tmp_path / "box.msh"))
    mesh = read_mesh_file(tmp_path / "box.msh", scale=1e-3)
    in_place = ImportedMesh(mesh.source, 1e3 * mesh.points, mesh.numbers, mesh.cells, mesh.cell_numbers)
    check(in_place, kind, 1e-12)  # rounding: Gmsh writes 16 digits
    count = len(mesh.cells[kind])
    assert {name: len(of.get(kind, ())) for name, of in mesh.cell_sets.items()} == {
        "all cells": count, "again": count, "side": 0
    }  # fmt: skip
    assert mesh.merged == (count if version < 3 else 0)  # 2.2 has the cells once for each of their groups
    assert mesh.points[mesh.nodes_of("corner")].tolist() == [[0.0, 0.0, 0.0]]


@pytest.mark.parametrize("suffix", [".inp", ".bdf", ".unv"])
@pytest.mark.parametrize("kind", [kind for kind in CELLS if kind not in ("quad9", "hex27")])
def test_formats_of_other_programs_that_gmsh_writes(gmsh: Any, kind: str, suffix: str, tmp_path: Path) -> None:
    build(gmsh, kind)
    gmsh.write(str(tmp_path / f"box{suffix}"))
    mesh = read_mesh_file(tmp_path / f"box{suffix}")
    # .inp has 14 digits; small fields of .bdf have eight characters, of which 6 are digits
    check(mesh, kind, 1e-5 if suffix == ".bdf" else 1e-12)
    names = {".inp": ("all_cells", "again"), ".unv": ("all_cells", "again"), ".bdf": ("property 1",)}[suffix]
    for name in names:
        assert len(mesh.cell_sets[name][kind]) == len(mesh.cells[kind])


@pytest.mark.parametrize("kind", CELLS)
def test_the_same_cells_through_vtk(gmsh: Any, kind: str, tmp_path: Path) -> None:
    """meshio reads .msh by its own tables and writes .vtu: an order of nodes that differs from ours would show."""
    import meshio

    build(gmsh, kind)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.write(str(tmp_path / "box.msh"))
    ours = read_mesh_file(tmp_path / "box.msh")
    other = meshio.read(tmp_path / "box.msh")
    meshio.write(tmp_path / "box.vtu", meshio.Mesh(other.points, other.cells))
    mesh = read_mesh_file(tmp_path / "box.vtu")
    check(mesh, kind, 1e-12)  # rounding: binary
    assert mesh.cells[kind].tolist() == ours.cells[kind].tolist()


def test_groups_of_one_name_in_two_dimensions_are_one_set(gmsh: Any, tmp_path: Path) -> None:
    """What meshio loses: the second group of a name, and groups without one."""
    build(gmsh, "quad4")
    gmsh.model.addPhysicalGroup(1, [2], 7, "all cells")
    gmsh.model.addPhysicalGroup(1, [3], 9)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.write(str(tmp_path / "box.msh"))
    mesh = read_mesh_file(tmp_path / "box.msh")
    assert {kind: len(rows) for kind, rows in mesh.cell_sets["all cells"].items()} == {"quad4": 9, "line2": 3}
    assert len(mesh.cell_sets["physical 9"]["line2"]) == 3


def plate_of(gmsh: Any, quads: bool, side: float, path: Path) -> None:
    """A rectangle of 0.5 m x 0.4 m in millimetres, meshed freely, with its edges."""
    gmsh.clear()
    gmsh.model.add("plate")
    face = gmsh.model.occ.addRectangle(0, 0, 0, 500, 400)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [face], 1, "plate")
    gmsh.model.addPhysicalGroup(1, [tag for _, tag in gmsh.model.getEntities(1)], 2, "rim")
    # a line across it from which cells grow: no two rows are alike
    for option, value in {
        "Mesh.MeshSizeMax": side,
        "Mesh.MeshSizeMin": side,
        "Mesh.Algorithm": 8 if quads else 6,
    }.items():
        gmsh.option.setNumber(option, value)
    gmsh.option.setNumber("Mesh.RecombineAll", int(quads))
    gmsh.model.mesh.generate(2)
    gmsh.option.setNumber("Mesh.RecombineAll", 0)
    gmsh.write(str(path))


@pytest.mark.parametrize("quads", [True, False], ids=["quadrilaterals", "triangles"])
def test_a_plate_of_free_cells_is_the_plate_of_a_grid(gmsh: Any, quads: bool, tmp_path: Path) -> None:
    """Free and simply supported, against bfs16: two elements and two theories; they differ by the square of a cell."""
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    grid = fs.Plate("plate", steel, 3e-3, (0.0, 0.0, 0.0), (0.5, 0.4), (20, 16))
    edges = fs.Support("edges", "simple", on="plate", edge="all")
    rim = fs.Support("edges", ("x", "y", "z"), on="plate", region=fs.Region("set", named="rim"))
    errors = {}
    for side in (40.0, 20.0):
        plate_of(gmsh, quads, side, tmp_path / "plate.msh")
        part = fs.Shell("plate", read_mesh_file(tmp_path / "plate.msh", 1e-3), steel, 3e-3, "plate")
        for name, supports in (("held", ((edges,), (rim,))), ("free", ((), ()))):
            exact, found = (
                first_modes(structure, 9 if name == "free" else 4)
                for structure in (
                    fs.Structure("a", (grid,), supports=supports[0]),
                    fs.Structure("a", (part,), supports=supports[1]),
                )
            )
            errors[name, side] = np.abs(found / exact - 1.0).max()
    for name in ("held", "free"):
        assert errors[name, 20.0] < 3e-3  # (k h)^2 / 24 with 20 mm, and shear, which the grid has not
        assert errors[name, 20.0] < 0.5 * errors[name, 40.0]  # with the square of the cell, to what shear leaves


def first_modes(structure: fs.Structure, count: int) -> np.ndarray:
    """The first elastic natural frequencies [Hz] of `count` modes."""
    basis = fs.modal_basis(fs.assemble(fs.mesh_structure(structure)), count=count)
    found = np.asarray(basis.frequency_hz[basis.modes])
    return found[found > 1.0][: min(count, 3)]


def test_one_plate_in_every_format_has_the_same_frequencies(gmsh: Any, tmp_path: Path) -> None:
    steel, found = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0), {}
    for suffix in (".msh", ".inp", ".unv", ".bdf"):
        plate_of(gmsh, True, 50.0, tmp_path / f"plate{suffix}")
        part = fs.Shell("plate", read_mesh_file(tmp_path / f"plate{suffix}", 1e-3), steel, 3e-3)
        found[suffix] = first_modes(fs.Structure("a", (part,)), 9)
    for suffix, one in found.items():
        # rounding of two solutions; a field of .bdf has six digits
        assert one == pytest.approx(found[".msh"], rel=1e-5 if suffix == ".bdf" else 1e-8)


def test_a_hole_in_a_wide_sheet_has_three_times_the_stress(gmsh: Any, tmp_path: Path) -> None:
    """Kirsch: 3 in an infinite sheet; 3.003 times the stress of the full section at a hole of a twentieth of the width
    (Howland, by Pilkey, Peterson's Stress Concentration Factors, chart 4.1)."""
    gmsh.clear()
    gmsh.model.add("sheet")
    square, hole = gmsh.model.occ.addRectangle(-100, -100, 0, 200, 200), gmsh.model.occ.addDisk(0, 0, 0, 5, 5)
    gmsh.model.occ.cut([(2, square)], [(2, hole)])
    gmsh.model.occ.synchronize()
    around = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(around, "F", "0.4 + 0.12 * (Sqrt(x*x + y*y) - 5)")
    gmsh.model.mesh.field.setAsBackgroundMesh(around)
    for option, value in {
        "MeshSizeMax": 20,
        "MeshSizeMin": 0.1,
        "MeshSizeExtendFromBoundary": 0,
        "Algorithm": 8,
    }.items():
        gmsh.option.setNumber(f"Mesh.{option}", value)
    gmsh.option.setNumber("Mesh.RecombineAll", 1)
    gmsh.model.mesh.generate(2)
    gmsh.option.setNumber("Mesh.RecombineAll", 0)
    gmsh.write(str(tmp_path / "sheet.msh"))
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    part = fs.Shell("sheet", read_mesh_file(tmp_path / "sheet.msh", 1e-3), steel, 1e-3)
    model = fs.mesh_structure(fs.Structure("a", (part,)))
    shell, points = model.parts["sheet"], model.mesh.points
    load = np.zeros((len(points), 7))
    for side in (-1.0, 1.0):  # 1 MPa along x
        edge = np.flatnonzero(np.abs(points[:, 0] - side * 0.1) < 1e-9)
        edge = edge[np.argsort(points[edge, 1])]
        lengths = np.diff(points[edge, 1])
        load[edge[:-1], 0] += side * 1e3 * lengths / 2.0
        load[edge[1:], 0] += side * 1e3 * lengths / 2.0
    K, _ = shell.stiffness_and_mass()
    corners = [int(np.argmin(np.linalg.norm(points - [x, y, 0.0], axis=1))) for x, y in ((-0.1, -0.1), (0.1, -0.1))]
    fixed = [6 * corners[0] + c for c in range(6)] + [6 * corners[1] + 1]
    free = np.setdiff1d(np.arange(K.shape[0]), fixed)
    moved = np.zeros(K.shape[0])
    moved[free] = spsolve(K[free][:, free].tocsc(), load[:, :6].ravel()[free])
    nodal = np.zeros((len(points), 7, 1))
    nodal[:, :6, 0] = moved.reshape(-1, 6)
    places = shell.stresses(len(points))
    stresses = von_mises(places.of(nodal), places.components)[:, 0]
    worst = places.places[int(np.argmax(stresses))]
    assert stresses.max() == pytest.approx(3.003e6, rel=0.02)  # discretisation: cells of 0.4 mm at a hole of 5 mm
    assert abs(worst[1]) == pytest.approx(5e-3, rel=0.01)  # at the sides of the hole; a node nearby
