"""Joints of parts whose nodes do not coincide where they touch: patch tests across, rigid motions, and one-piece parts.

The exact motions are constant strains, curvatures and twist; the frequencies compared with are those of models in which
all nodes coincide.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.errors import InputError
from femstruct.language.models import read_model
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.model import Model
from femstruct.model.sections import rectangle
from femstruct.parts.arrangement_findings import arrangement_findings
from femstruct.parts.joint_findings import joined_over, joint_open_findings, joint_spring_findings

WOOD = fs.Material("wood", E=11e9, nu=0.3, rho=450.0)
CONCRETE = fs.Material("concrete", E=30e9, nu=0.2, rho=2400.0)


def sheet(x0: float, nx: int, ny: int) -> ImportedMesh:
    """A square of 1 m in nx x ny cells, oblique inside."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, nx + 1), np.linspace(0.0, 1.0, ny + 1), indexing="ij")
    moved = 0.1 / nx * np.sin(3.0 * np.pi * x) * np.sin(2.0 * np.pi * y)
    points = np.stack([x0 + x + moved, y + moved, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    n = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    cells = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
    return ImportedMesh("sheet.msh", points, n.ravel() + 1, {"quad4": cells}, {"quad4": np.arange(len(cells))}, {})


def stretching(x, y):
    u = np.zeros((len(x), 7))
    u[:, 0], u[:, 1], u[:, 5] = 1.0 * x + 0.4 * y, -0.3 * x + 0.7 * y, (-0.3 - 0.4) / 2.0
    return u


def bending_across(x, y):
    u = np.zeros((len(x), 7))
    u[:, 2], u[:, 4] = x**2 / 2.0, -x
    return u


def bending_along(x, y):
    u = np.zeros((len(x), 7))
    u[:, 2], u[:, 3] = y**2 / 2.0, y
    return u


def twisting(x, y):
    u = np.zeros((len(x), 7))
    u[:, 2], u[:, 3], u[:, 4] = x * y, x, -y
    return u


@pytest.mark.parametrize("field", [stretching, bending_across, bending_along, twisting])
@pytest.mark.parametrize(("one", "two"), [(7, 5), (3, 6), (4, 5)])
def test_constant_strains_go_across_a_joint(field, one: int, two: int) -> None:
    """The exact motion violates no equation; where the outer edges have it, all other nodes take it, those on the line
    too, and no force is left there."""
    stuff = fs.Material("stuff", E=1e9, nu=0.3, rho=1000.0)
    parts = (fs.Shell("one", sheet(0.0, 4, one), stuff, 0.02), fs.Shell("two", sheet(1.0, 3, two), stuff, 0.02))
    model = fs.mesh_structure(fs.Structure("sheets", parts, joints=(fs.Joint("line", "one", "two"),)))
    assembly = fs.assemble(model)
    exact = field(*model.mesh.points[:, :2].T).ravel()
    (tie,) = model.ties
    assert np.abs(tie.rows @ exact).max() < 1e-13  # rounding
    x, y, _ = model.mesh.points.T
    outer = np.repeat((x < 1e-9) | (x > 2.0 - 1e-9) | (y < 1e-9) | (y > 1.0 - 1e-9), 7)
    T, K = assembly.dofs.T.toarray(), assembly.K.toarray()
    held = np.linalg.lstsq(T[outer], exact[outer], rcond=None)[0]
    _, sizes, rows = np.linalg.svd(T[outer])
    loose = rows[(sizes > 1e-9 * sizes[0]).sum() :].T  # what leaves the outer edges as they are
    free = held - loose @ np.linalg.solve(loose.T @ K @ loose, loose.T @ K @ held)
    assert np.abs(T @ free - exact).max() < 1e-10 * np.abs(exact).max()  # rounding times a condition of 1e5
    forces = K @ np.linalg.lstsq(T, exact, rcond=None)[0]
    # Rounding of sums of stiffnesses in the plane of 1e7, over forces of bending that are t^2 / h^2 of those.
    assert np.abs(loose.T @ forces).max() < 1e-9 * np.abs(forces).max()


def slab(name: str, mesh: float, size: tuple[float, float], **more: object) -> fs.Slab:
    material, thickness = more.pop("material", WOOD), more.pop("thickness", 0.04)
    a, b = size
    outline = ((0.0, 0.0), (a, 0.0), (a, b), (0.0, b))
    return fs.Slab(name, material, thickness, outline, mesh=mesh, **more)  # type: ignore[arg-type]


def first(parts: tuple[fs.Slab, ...], held: tuple[tuple[str, str], ...], count: int = 3, **joint: object) -> np.ndarray:
    """Frequencies of slabs of which sets of these names are held, the second joined to the first [Hz]."""
    joints = (fs.Joint("line", parts[0].name, parts[1].name, **joint),) if len(parts) > 1 else ()  # type: ignore[arg-type]
    supports = tuple(
        fs.Support(f"s{i}", ("x", "y", "z"), on=part, region=fs.Region("set", named=name))
        for i, (part, name) in enumerate(held)
    )
    model = fs.mesh_structure(fs.Structure("slabs", parts, joints, supports=supports))
    basis = fs.modal_basis(fs.assemble(model), count=count)
    return np.asarray(basis.frequency_hz[basis.modes])[:count]


def six_motions(points: np.ndarray) -> np.ndarray:
    found = np.zeros((len(points), 7, 6))
    found[:, :6] = np.eye(6)
    for axis in range(3):
        found[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], points)
    return found.reshape(-1, 6)


@pytest.mark.parametrize("other", [0.13, 0.075])
def test_two_slabs_are_one(other: float) -> None:
    """Meshes of 0.1 m and another size side by side, against one slab of half the mesh."""
    halves = slab("a", 0.1, (1.2, 1.2)), slab("b", other, (1.2, 1.2), origin=(1.2, 0.0, 0.0))
    whole = first((slab("a", 0.05, (2.4, 1.2)),), (("a", "side 4"), ("a", "side 2")))
    found = first(halves, (("a", "side 4"), ("b", "side 2")))
    assert found == pytest.approx(whole, rel=0.01)  # meshes of 0.13 m; hung at the nodes that coincide: 20 %


def wall_on_floor(mesh: float, on: float, through: tuple[tuple[float, float], ...], **joint: object) -> np.ndarray:
    floor = slab("floor", on, (4.0, 3.0), material=CONCRETE, thickness=0.2, through=through)
    turned = {"origin": (2.0, 0.0, 0.0), "normal": (1.0, 0.0, 0.0), "x_direction": (0.0, 1.0, 0.0)}
    wall = slab("wall", mesh, (3.0, 2.0), material=CONCRETE, thickness=0.15, **turned)
    return first((floor, wall), (("floor", "rim"),), **joint)


def test_a_wall_stands_on_any_line_of_a_floor() -> None:
    """Nodes of a wall between those of the line below it, and across insides of cells, against nodes that coincide."""
    right = wall_on_floor(0.2, 0.2, ())
    assert wall_on_floor(0.2, 0.2, ((2.0, 0.5),)) == pytest.approx(right, rel=0.01)  # a line more; was -60 %
    assert wall_on_floor(0.25, 0.2, ()) == pytest.approx(right, rel=0.01)  # a coarser wall; was -31 %
    assert wall_on_floor(0.2, 0.22, ((2.1, 0.0),)) == pytest.approx(right, rel=0.02)  # lines beside the wall, coarser


@pytest.mark.parametrize("kind", ["pinned", "rigid"])
def test_a_joint_across_meshes_leaves_six_rigid_motions(kind: str) -> None:
    """Every rigid motion of both violates no equation, and nothing else is free but the hinge of a pinned joint."""
    parts = slab("a", 0.3, (1.2, 1.2)), slab("b", 0.4, (1.2, 1.2), origin=(1.2, 0.0, 0.0))
    joints = (fs.Joint("line", "a", "b", kind=kind),)  # type: ignore[arg-type]
    model = fs.mesh_structure(fs.Structure("free", parts, joints))
    assert np.abs(model.ties[0].rows @ six_motions(model.mesh.points)).max() < 1e-12  # rounding
    assert fs.modal_basis(fs.assemble(model), count=8).n_rigid == {"rigid": 6, "pinned": 7}[kind]


def test_a_joint_that_slides_across_meshes_holds_with_its_slip() -> None:
    """A stiff slip is rigid, and the springs add to slip times length."""
    parts = slab("a", 0.1, (1.2, 1.2)), slab("b", 0.13, (1.2, 1.2), origin=(1.2, 0.0, 0.0))
    model = fs.mesh_structure(fs.Structure("s", parts, (fs.Joint("line", "a", "b", kind="sliding", slip=2e6),)))
    assert model.elastics[0].stiffness.sum() == pytest.approx(2e6 * 1.2, rel=1e-12)  # rounding
    held = (("a", "side 4"), ("b", "side 2"))
    assert first(parts, held, kind="sliding", slip=1e13) == pytest.approx(first(parts, held), rel=1e-5)  # 1 / slip


def test_a_short_part_is_joined_along_its_side() -> None:
    """A slab of 0.75 m beside one of 1.2 m: all of its side, coarser or finer, as one slab with a corner cut out."""
    outline = ((0.0, 0.0), (2.4, 0.0), (2.4, 0.75), (1.2, 0.75), (1.2, 1.2), (0.0, 1.2))
    whole = first((fs.Slab("a", WOOD, 0.04, outline, mesh=0.05),), (("a", "side 6"),))
    for fine, coarse in ((0.1, 0.13), (0.13, 0.1)):
        parts = slab("a", fine, (1.2, 1.2)), slab("b", coarse, (1.2, 0.75), origin=(1.2, 0.0, 0.0))
        assert first(parts, (("a", "side 4"),)) == pytest.approx(whole, rel=0.02)  # meshes of 0.13 m


RIB = (((0.1, 0.13, 0.0), (1.9, 1.07, 0.0)),)


def ribbed(of: fs.Slab | fs.Plate, lines: object, mesh: float | None, count: int = 4, **joint: object) -> np.ndarray:
    """Frequencies of a slab or plate, all edges held, with ribs of 60 x 100 mm under it [Hz]."""
    under = (0.0, 0.0, -0.07)
    rib = fs.Frame(
        "rib",
        WOOD,
        rectangle("b", 0.06, 0.1),
        lines,
        mesh=mesh,
        start_offset=under,
        end_offset=under,  # type: ignore[arg-type]
    )
    region = {"region": fs.Region("set", named="rim")} if isinstance(of, fs.Slab) else {"edge": "all"}
    held = fs.Support("rim", ("x", "y", "z"), on=of.name, **region)  # type: ignore[arg-type]
    joints = (fs.Joint("glue", "rib", of.name, **joint),)  # type: ignore[arg-type]
    model = fs.mesh_structure(fs.Structure("ribbed", (of, rib), joints, supports=(held,)))
    basis = fs.modal_basis(fs.assemble(model), count=count)
    return np.asarray(basis.frequency_hz[basis.modes])[:count]


@pytest.mark.parametrize(("mesh", "bars"), [(0.1, 0.1), (0.05, 0.1), (0.1, 0.03), (0.1, None)])
def test_an_oblique_rib_acts_wherever_its_nodes_are(mesh: float, bars: float | None) -> None:
    """Against a thin plate, which has nodes where the rib has, and 98.38 Hz of a Ritz series of plate and beam."""
    plate = fs.Plate("floor", WOOD, 0.04, origin=(0.0, 0.0, 0.0), size=(2.0, 1.2), mesh=0.1)
    found = ribbed(slab("floor", mesh, (2.0, 1.2)), RIB, bars)
    assert found[0] == pytest.approx(98.38, rel=0.01)  # shear of slab and rib 0.5 %; one node joined 40.6 Hz
    assert found == pytest.approx(ribbed(plate, RIB, 0.1), rel=0.02)  # shear in higher modes


UNDER = "{start: [0, 0, -70 mm], end: [0, 0, -70 mm]}"  # half of 40 mm and half of 100 mm; right as RIB above


@pytest.mark.parametrize("kind", ["slab", "plate"])
def test_a_rib_at_its_true_height_is_answered_with_the_offsets_to_write(kind: str) -> None:
    lines = tuple(tuple((x, y, z - 0.07) for x, y, z in line) for line in RIB)
    rib = fs.Frame("rib", WOOD, rectangle("b", 0.06, 0.1), lines, mesh=0.1)
    flat = fs.Plate("floor", WOOD, 0.04, origin=(0.0, 0.0, 0.0), size=(2.0, 1.2), mesh=0.1)
    floor = flat if kind == "plate" else slab("floor", 0.1, (2.0, 1.2))
    with pytest.raises(InputError) as caught:
        fs.mesh_structure(fs.Structure("r", (floor, rib), (fs.Joint("glue", "rib", "floor"),)))
    assert "move its lines by [0, 0, 70 mm] into the mid-surface of floor" in str(caught.value)
    assert f"'offsets: {UNDER}'" in str(caught.value)
    model = fs.mesh_structure(fs.Structure("r", (floor, rib)))
    (found,) = (one for one in arrangement_findings(model) if one.code == "parts-not-joined")
    assert f"'offsets: {UNDER}'" in found.message and found.severe


def test_a_frame_that_is_not_at_one_height_has_no_offsets_proposed() -> None:
    post = fs.Frame("post", WOOD, rectangle("b", 0.06, 0.1), (((0.55, 0.85, -0.1), (0.55, 0.85, -1.0)),), mesh=0.5)
    with pytest.raises(InputError) as caught:
        joint = fs.Joint("foot", "floor", "post")
        fs.mesh_structure(fs.Structure("r", (slab("floor", 0.1, (2.0, 1.2)), post), (joint,)))
    assert "offsets" not in str(caught.value) and "reach" in str(caught.value)


def test_a_rib_beside_lines_of_cells_is_as_one_on_them() -> None:
    at = 0.63
    lines = (((0.0, at, 0.0), (2.0, at, 0.0)),)
    on = ribbed(slab("floor", 0.1, (2.0, 1.2), through=((1.0, at),)), lines, 0.1)
    assert ribbed(slab("floor", 0.1, (2.0, 1.2)), lines, 0.1) == pytest.approx(on, rel=0.005)  # mesh of 0.1 m
    slides = ribbed(slab("floor", 0.1, (2.0, 1.2)), lines, 0.1, kind="sliding", slip=1e13)
    assert slides == pytest.approx(ribbed(slab("floor", 0.1, (2.0, 1.2)), lines, 0.1), rel=1e-4)  # 1 / slip
    free = ribbed(slab("floor", 0.1, (2.0, 1.2), through=((1.0, at),)), lines, 0.1, kind="sliding", slip=2e6)
    loose = ribbed(slab("floor", 0.1, (2.0, 1.2)), lines, 0.1, kind="sliding", slip=2e6)
    assert loose == pytest.approx(free, rel=0.01)  # mesh of 0.1 m


@pytest.mark.parametrize("kind", ["rigid", "pinned"])
def test_ribs_and_posts_beside_nodes_leave_six_rigid_motions(kind: str) -> None:
    """Every rigid motion violates no equation; a pinned line rib turns about its axis no more than its arms let it."""
    under = (0.0, 0.0, -0.07)
    section = rectangle("b", 0.06, 0.1)
    rib = fs.Frame("rib", WOOD, section, RIB, mesh=0.1, start_offset=under, end_offset=under)
    post = fs.Frame("post", WOOD, section, (((0.55, 0.85, 0.0), (0.55, 0.85, -1.0)),), mesh=0.5)
    joints = (fs.Joint("glue", "rib", "floor"), fs.Joint("foot", "floor", "post", kind=kind))  # type: ignore[arg-type]
    model = fs.mesh_structure(fs.Structure("free", (slab("floor", 0.2, (2.0, 1.2)), rib, post), joints))
    motions = six_motions(model.mesh.points)
    assert all(np.abs(tie.rows @ motions).max() < 1e-12 for tie in model.ties)  # rounding
    assert fs.modal_basis(fs.assemble(model), count=10).n_rigid == {"rigid": 6, "pinned": 9}[kind]


def test_frames_that_cross_between_their_ends_are_joined_there() -> None:
    """Each has a node there, and both move as one body; they were refused as 0.6 m apart."""
    section = rectangle("b", 0.06, 0.1)
    length = 2.0
    along = fs.Frame("along", WOOD, section, (((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), element="euler")
    turned = (((1.2, -0.6, 0.0), (0.8, 0.6, 0.0)),)  # oblique, not at right angles
    across = fs.Frame("across", WOOD, section, turned, element="euler")
    model = fs.mesh_structure(fs.Structure("cross", (along, across), (fs.Joint("cross", "along", "across"),)))
    places = model.mesh.points
    met = np.linalg.norm(places - [1.0, 0.0, 0.0], axis=1) < 1e-9
    assert met.sum() == 2 and len(places) == 6
    (tie,) = model.ties
    assert np.abs(tie.rows @ six_motions(places)).max() < 1e-12  # rounding
    assert fs.modal_basis(fs.assemble(model), count=8).n_rigid == 6


def findings_of(model: Model) -> dict[str, bool]:
    return {one.code: one.severe for one in joint_open_findings(model)}


def told(model: Model) -> dict[str, float]:
    (one,) = joint_open_findings(model)
    assert one.code == "joint-open" and one.severe
    return dict(one.values)


def test_what_finds_no_partner_is_said_with_its_length_or_area() -> None:
    """On a cube of 2 x 2 cells: a sheet on edge and one that lies on it, half of it beyond, and a bar; an edge or a
    cell with one free node is open. By hand: 1 m, 1 m^2 and 1 m; with nodes on those of the cube nothing."""
    cube = fs.Solid("cube", block(0.0, 2), CONCRETE)

    def on_cube(cells: int, long: float, lying: bool) -> Model:
        flat = sheet(0.0, 1, cells)
        x, y, _ = flat.points.T
        one = np.ones_like(x)
        places = np.stack([y * long, x, one] if lying else [one, y * long, 1.0 + x], axis=1)
        mesh = ImportedMesh("sheet.msh", places, flat.numbers, flat.cells, flat.cell_numbers, {})
        parts = cube, fs.Shell("sheet", mesh, WOOD, 0.02)
        joint = fs.Joint("j", "sheet", "cube", kind="pinned" if lying else "rigid")
        return fs.mesh_structure(fs.Structure("s", parts, (joint,)))

    joined = joined_over(on_cube(5, 1.0, lying=False))["j"]
    assert (joined.size, joined.of) == pytest.approx((0.0, 1.0), abs=1e-9)  # rounding
    found = told(on_cube(5, 1.0, lying=False))
    assert (found["free"], found["touching"]) == (4, 6)
    assert (found["open_m"], found["touching_m"]) == pytest.approx((1.0, 1.0), rel=1e-9)  # rounding
    for cells, long in ((2, 1.0), (4, 2.0), (3, 1.5)):
        assert joint_open_findings(on_cube(cells, long, lying=False)) == ()
    found = {one.message.split()[-1]: dict(one.values) for one in joint_open_findings(on_cube(3, 2.0, lying=True))}
    for values in found.values():
        assert (values["open_m2"], values["touching_m2"]) == pytest.approx((1.0, 1.0), rel=1e-9)  # rounding
    bar = fs.Frame("bar", WOOD, rectangle("b", 0.06, 0.1), (((0.0, 0.5, 1.0), (1.5, 0.5, 1.0)),), mesh=0.25)
    joint = fs.Joint("j", "bar", "cube", kind="pinned")
    found = told(fs.mesh_structure(fs.Structure("s", (cube, bar), (joint,))))
    assert (found["open_m"], found["touching_m"]) == pytest.approx((1.0, 1.0), rel=1e-9)  # rounding


def test_what_a_joint_leaves_open_or_bridges_is_a_finding() -> None:
    """A rib on rigid arms to nodes beside it limits trust; solids of 2 against 3 cells are joined."""
    one, other, same = (block(x0, n) for x0, n in ((0.0, 2), (1.0, 3), (1.0, 2)))
    joints = (fs.Joint("face", "a", "b", kind="pinned"),)

    def solids(second: ImportedMesh) -> Model:
        parts = fs.Solid("a", one, CONCRETE), fs.Solid("b", second, CONCRETE)
        return fs.mesh_structure(fs.Structure("solids", parts, joints))

    assert findings_of(solids(other)) == {}
    assert findings_of(solids(same)) == {}
    rib = fs.Frame("rib", WOOD, rectangle("b", 0.06, 0.1), RIB, mesh=0.1)
    floor = slab("floor", 0.1, (2.0, 1.2))

    def glued(reach: float | None) -> Model:
        return fs.mesh_structure(fs.Structure("r", (floor, rib), (fs.Joint("glue", "rib", "floor", reach=reach),)))

    assert findings_of(glued(None)) == {}
    assert findings_of(glued(0.06)) == {"joint-rigid-arms": False}


def block(x0: float, n: int) -> ImportedMesh:
    """A cube of 1 m in one cell along x and n x n across."""
    line = np.linspace(0.0, 1.0, n + 1)
    x, y, z = np.meshgrid([x0, x0 + 1.0], line, line, indexing="ij")
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    k = np.arange(len(points)).reshape(x.shape)
    low = [k[:1, :-1, :-1], k[1:, :-1, :-1], k[1:, 1:, :-1], k[:1, 1:, :-1]]
    high = [k[:1, :-1, 1:], k[1:, :-1, 1:], k[1:, 1:, 1:], k[:1, 1:, 1:]]
    cells = np.stack([*low, *high], axis=-1).reshape(-1, 8)
    return ImportedMesh("b.msh", points, k.ravel() + 1, {"hex8": cells}, {"hex8": np.arange(len(cells))}, {})


STIFF = fs.Material("stiff", E=1e14, nu=0.0, rho=1000.0)
MESHES = [(0.3, 0.3), (0.3, 0.4), (0.4, 0.15)]  # of both slabs: nodes that coincide, that do at both ends, in part


def elastic(meshes: tuple[float, float], held: tuple[fs.Support, ...], joint: fs.Joint) -> float:
    """First frequency of two rigid slabs of 1.2 m x 1.2 m side by side, 24 kg/m^2 [Hz]."""
    parts = tuple(
        slab(name, mesh, (1.2, 1.2), origin=(x, 0.0, 0.0), material=STIFF, thickness=0.024)
        for name, mesh, x in zip("ab", meshes, (0.0, 1.2), strict=True)
    )
    model = fs.mesh_structure(fs.Structure("elastic", parts, (joint,), supports=held))
    assert sum(one.stiffness.sum() for one in model.elastics) == pytest.approx(1.2 * 5e4, rel=1e-9)  # rounding
    assert {one.code for one in joint_spring_findings(model)} == set()
    return float(fs.modal_basis(fs.assemble(model), count=1).frequency_hz[0])


@pytest.mark.parametrize("meshes", MESHES)
def test_springs_per_length_of_a_joint_are_those_of_the_line_whatever_the_meshes(meshes: tuple[float, float]) -> None:
    """Rigid slabs: one that shifts on the line alone, and two that fold at it, turning by 2 w / a: the energy is
    k b (2 w / a)^2 / 2, the inertia of both 2 m a^2 / 3 about their far edges."""
    mass = 24.0 * 1.2**2
    whole = fs.Support("whole", "clamped", on="a")
    guide = fs.Support("guide", ("x", "y", "rx", "ry", "rz"), on="b")
    shift = fs.Joint("line", "a", "b", stiffness={"z": 5e4}, per="length")
    right = np.sqrt(5e4 * 1.2 / mass) / (2.0 * np.pi)
    assert elastic(meshes, (whole, guide), shift) == pytest.approx(right, rel=1e-4)  # slabs that hardly bend
    edges = tuple(
        fs.Support(f"s{part}", ("x", "y", "z"), on=part, region=fs.Region("set", named=f"side {side}"))
        for part, side in (("a", 4), ("b", 2))
    )
    fold = fs.Joint("line", "a", "b", stiffness={"ry": 5e4}, per="length")
    right = np.sqrt(6.0 * 5e4 * 1.2 / (mass * 1.2**2)) / (2.0 * np.pi)
    assert elastic(meshes, edges, fold) == pytest.approx(right, rel=1e-3)  # slabs that hardly bend


def test_stiff_springs_per_length_are_a_rigid_joint() -> None:
    parts = slab("a", 0.1, (1.2, 1.2)), slab("b", 0.13, (1.2, 1.2), origin=(1.2, 0.0, 0.0))
    held = (("a", "side 4"), ("b", "side 2"))
    stiff = dict.fromkeys(("x", "y", "z", "rx", "ry", "rz"), 1e12)
    sprung = first(parts, held, stiffness=stiff, per="length")
    assert sprung == pytest.approx(first(parts, held), rel=5e-3)  # all points of the line are held, not their means


def test_springs_per_length_of_ribs_and_what_has_no_line() -> None:
    """Bars beside nodes: the length of the rib; a post, an area and solids have none."""
    rib = fs.Frame("rib", WOOD, rectangle("b", 0.06, 0.1), RIB, mesh=0.1)
    floor = slab("floor", 0.1, (2.0, 1.2))
    joint = fs.Joint("glue", "rib", "floor", stiffness={"z": 3e6}, per="length")
    model = fs.mesh_structure(fs.Structure("r", (floor, rib), (joint,)))
    assert model.elastics[0].stiffness.sum() == pytest.approx(3e6 * np.hypot(1.8, 0.94), rel=1e-9)  # rounding
    post = fs.Frame("post", WOOD, rectangle("b", 0.06, 0.1), (((0.55, 0.85, 0.0), (0.55, 0.85, -1.0)),), mesh=0.5)
    cubes = fs.Solid("p", block(0.0, 2), CONCRETE), fs.Solid("q", block(1.0, 3), CONCRETE)
    for parts in ((floor, post), (floor, slab("upper", 0.1, (2.0, 1.2))), cubes):
        kind = "pinned" if parts is cubes else "rigid"
        joint = fs.Joint("j", parts[0].name, parts[1].name, kind, stiffness={"z": 1e6}, per="length")  # type: ignore[arg-type]
        with pytest.raises(InputError, match="do not touch along lines"):
            fs.mesh_structure(fs.Structure("r", parts, (joint,)))


def test_springs_per_length_are_written_with_their_unit(tmp_path: Path) -> None:
    outline = "outline: [[0, 0], [1, 0], [1, 1], [0, 1]], mesh: 0.5"
    text = f"""materials: {{c: {{E: 11 GPa, nu: 0.3, rho: 450}}}}
parts:
  a: {{type: slab, material: c, thickness: 40 mm, {outline}}}
  b: {{type: slab, material: c, thickness: 40 mm, {outline}, origin: [1, 0, 0]}}
joints: {{j: {{connect: [a, b], stiffness: {{z: 3 MN/m^2, ry: 40 kN*m/m}}}}}}
"""
    path = tmp_path / "m.yaml"
    for per, written in (("length", text), ("pair", text.replace("MN/m^2", "MN/m").replace("kN*m/m", "kN*m"))):
        path.write_text(written, encoding="utf-8")
        (joint,) = read_model(path).structure.joints
        assert (joint.per, dict(joint.stiffness)) == (per, {"z": 3e6, "ry": 4e4})


def test_sheets_that_touch_at_a_corner_alone_are_said_to() -> None:
    """A square of the same corner is shifted along its neighbour's edge until one corner is left."""
    square = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))

    def model_of(shift: float) -> Model:
        slabs = (
            fs.Slab("a", CONCRETE, 0.1, square, mesh=0.25),
            fs.Slab("b", CONCRETE, 0.1, square, mesh=0.25, origin=(1.0, shift, 0.0)),
        )
        return fs.mesh_structure(fs.Structure("s", slabs, (fs.Joint("j", "a", "b"),)))

    assert findings_of(model_of(1.0)) == {"joint-at-a-point": True}
    assert joined_over(model_of(1.0))["j"].size is None
    for shift in (0.0, 0.75, 0.6):
        model = model_of(shift)
        joined = joined_over(model)["j"]
        assert findings_of(model) == {} and joined.unit == "m"
        assert (joined.size, joined.of) == pytest.approx(
            (1.0 - shift, 1.0 - shift), abs=0.25 / 8
        )  # an eighth of a cell


def strip_with_wall(mesh: float, through: bool, kind: str = "rigid") -> tuple[np.ndarray, Model]:
    """A strip of 2.25 m held at both ends, a thick wall on it at 0.8 m, clamped above: first frequencies [Hz]."""
    named = ((0.8, 0.0), (0.8, 0.3)) if through else ()
    stuff = fs.Material("stuff", E=12e9, nu=0.0, rho=500.0)
    floor = slab("floor", mesh, (2.25, 0.3), material=stuff, thickness=0.05, through=named)
    turned = {"origin": (0.8, 0.0, 0.0), "normal": (1.0, 0.0, 0.0), "x_direction": (0.0, 1.0, 0.0)}
    wall = slab("wall", 0.1, (0.3, 2.0), material=stuff, thickness=0.3, **turned)
    held = [
        fs.Support("l", ("x", "y", "z"), on="floor", region=fs.Region("set", named="side 4")),
        fs.Support("r", ("x", "y", "z"), on="floor", region=fs.Region("set", named="side 2")),
        fs.Support("t", ("x", "y", "z", "rx", "ry", "rz"), on="wall", region=fs.Region("set", named="side 3")),
    ]
    joints = (fs.Joint("foot", "wall", "floor", kind=kind),)
    model = fs.mesh_structure(fs.Structure("strip", (floor, wall), joints, supports=tuple(held)))
    basis = fs.modal_basis(fs.assemble(model), count=4)
    return np.asarray(basis.frequency_hz[basis.modes])[:4], model


@pytest.mark.parametrize("mesh", [0.15, 0.1, 0.07])
def test_a_wall_inside_cells_is_said_to_stiffen_them_by_about_what_it_does(mesh: float) -> None:
    """What a line of cells under the wall takes away is below what the finding says and above a fourth of it; with that
    line nothing is said, nor of a hinge, which passes no moment on."""
    inside, model = strip_with_wall(mesh, False)
    on_line, same = strip_with_wall(mesh, True)
    (one,) = joint_open_findings(model)
    assert one.code == "joint-inside-cells" and one.severe == (one.values["too_high"] > 0.05)
    off = float((inside / on_line - 1.0).max())
    assert one.values["too_high"] / 4.0 < off < one.values["too_high"]
    assert joint_open_findings(same) == ()
    assert joint_open_findings(strip_with_wall(mesh, False, "pinned")[1]) == ()


def floor_with_wall(through: bool, floor: float, wall: float, E: float) -> tuple[np.ndarray, Model]:
    """A floor of 4 x 3 m in cells of 0.3 m with a wall beside its third point: first frequencies [Hz]."""
    named = ((1.33, 0.0), (1.33, 3.0)) if through else ()
    parts = (
        slab("floor", 0.3, (4.0, 3.0), material=CONCRETE, thickness=floor, through=named),
        slab("wall", 0.13, (3.0, 2.6), material=fs.Material("w", E, 0.2, 1000.0), thickness=wall,
             origin=(1.33, 0.0, 0.0), normal=(1.0, 0.0, 0.0), x_direction=(0.0, 1.0, 0.0)),
    )  # fmt: skip
    held = (("floor", "rim"), ("wall", "side 3"))
    supports = tuple(
        fs.Support(f"s{k}", ("x", "y", "z"), on=part, region=fs.Region("set", named=name))
        for k, (part, name) in enumerate(held)
    )
    joints = (fs.Joint("foot", "wall", "floor"),)
    model = fs.mesh_structure(fs.Structure("floor", parts, joints, supports=supports))
    basis = fs.modal_basis(fs.assemble(model), count=6)
    return np.asarray(basis.frequency_hz[basis.modes])[:6], model


@pytest.mark.parametrize(
    ("floor", "wall", "E"), [(0.2, 0.3, 30e9), (0.2, 0.15, 30e9), (0.1, 0.3, 30e9), (0.2, 0.1, 3e9)]
)
def test_what_a_wall_stiffens_hangs_on_what_holds_what(floor: float, wall: float, E: float) -> None:
    """A stiff wall, one like the floor, a thick one on a thin floor, and a partition, of which nothing is said."""
    (inside, model), (on_line, _) = (floor_with_wall(through, floor, wall, E) for through in (False, True))
    off = float((inside / on_line - 1.0).max())
    found = joint_open_findings(model)
    said = found[0].values["too_high"] if found else 0.01
    assert off < said
    assert bool(found) == (E > 3e9)
    assert not found or off > said / 4.0
