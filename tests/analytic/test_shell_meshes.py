"""Shells on meshes against closed forms: plates, an L-shaped slab, cylinders; and what must not change a frequency."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

import femstruct as fs
from femstruct.elements.stresses import von_mises
from femstruct.errors import InputError
from femstruct.model.imported_mesh import ImportedMesh

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
T = 3e-3
D = STEEL.E * T**3 / 12.0 / (1.0 - STEEL.nu**2)


def sheet(nx: int, ny: int, a: float, b: float, moved: float = 0.0, keep: object = None) -> ImportedMesh:
    """A rectangle of quadrilaterals, inner nodes moved by a share of a cell; keep(x, y) : which cells there are."""
    x, y = np.meshgrid(np.linspace(0.0, a, nx + 1), np.linspace(0.0, b, ny + 1), indexing="ij")
    rng = np.random.default_rng(4)
    x[1:-1, 1:-1] += moved * a / nx * (rng.random((nx - 1, ny - 1)) - 0.5)
    y[1:-1, 1:-1] += moved * b / ny * (rng.random((nx - 1, ny - 1)) - 0.5)
    n = np.arange(x.size).reshape(nx + 1, ny + 1)
    quads = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
    points = np.stack([x, y, 0.0 * x], axis=-1).reshape(-1, 3)
    if keep is not None:
        middle = points[quads].mean(axis=1)
        quads = quads[keep(middle[:, 0], middle[:, 1])]  # type: ignore[operator]
    sides = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges, times = np.unique(sides, axis=0, return_counts=True)
    rim = edges[times == 1]
    along_y = np.abs(points[rim[:, 0], 0] - points[rim[:, 1], 0]) < 1e-9
    sets = {"along x": np.unique(rim[~along_y]), "along y": np.unique(rim[along_y])}
    numbers = np.arange(1, len(points) + 1)
    return ImportedMesh("sheet", points, numbers, {"quad4": quads}, {"quad4": numbers[: len(quads)]}, sets)


def held(name: str, fix: tuple[str, ...], part: str = "part") -> fs.Support:
    return fs.Support(name.replace(" ", "_"), fix, on=part, region=fs.Region("set", named=name))


HARD = (held("along x", ("x", "y", "z", "ry")), held("along y", ("x", "y", "z", "rx")))


def frequencies(*parts: fs.Shell | fs.Plate | fs.Frame, up_to: float, **more: object) -> np.ndarray:
    model = fs.mesh_structure(fs.Structure("a", parts, **more))  # type: ignore[arg-type]
    basis = fs.modal_basis(fs.assemble(model), up_to=up_to)
    return np.asarray(basis.frequency_hz[basis.modes])


def thin(waves: object) -> np.ndarray:
    """Natural frequencies [Hz] of a thin simply supported plate with these squared wavenumbers."""
    return np.asarray(waves) / (2.0 * np.pi) * np.sqrt(D / (STEEL.rho * T))


def test_a_simply_supported_plate_of_moved_nodes_converges_with_the_square() -> None:
    """The closed form of Mindlin's plate: (1, 1), (2, 1) and (1, 2) of 0.5 m x 0.4 m, hard support."""
    k2 = np.array([np.pi**2 * ((i / 0.5) ** 2 + (j / 0.4) ** 2) for i, j in ((1, 1), (2, 1), (1, 2))])
    G, rho = 5.0 / 6.0 * STEEL.G, STEEL.rho
    b = rho * T + k2 * (rho * T**3 / 12.0 + rho * D / G)  # of w^2, divided by that of w^4
    squared = (b - np.sqrt(b**2 - 4.0 * D * k2**2 * rho**2 * T**3 / 12.0 / G)) / (rho**2 * T**3 / 6.0 / G)
    exact = np.sqrt(squared) / (2.0 * np.pi)
    errors = []
    for n in (10, 20):
        part = fs.Shell("part", sheet(n, n, 0.5, 0.4, 0.4), STEEL, T)
        errors.append(frequencies(part, up_to=260.0, supports=HARD)[:3] / exact - 1.0)
    assert (np.abs(errors[1]) < k2 * 0.025**2 / 12.0).all()  # of waves along one direction (k h)^2 / 12, of others less
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.25)  # the order, nodes moved anew


def test_an_l_shaped_slab_has_the_smooth_modes_of_its_squares() -> None:
    """sin(pi x) sin(pi y) vanishes with its curvature on every edge of three unit squares, the inner corner too."""
    mesh = sheet(24, 24, 2.0, 2.0, keep=lambda x, y: (x < 1.0) | (y < 1.0))
    found = frequencies(fs.Shell("part", mesh, STEEL, T), up_to=1.1 * thin(5.0 * np.pi**2), supports=HARD)
    for waves in (2.0 * np.pi**2, 5.0 * np.pi**2):
        assert np.abs(found / thin(waves) - 1.0).min() < waves / 24**2 / 3.0  # (k h)^2 / 12 with 12 cells a side


def tube(count: int, along: int, radius: float, length: float, thickness: float) -> fs.Shell:
    angle = 2.0 * np.pi * np.arange(count) / count
    z = np.linspace(0.0, length, along + 1)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    points = np.stack([np.tile(x, along + 1), np.tile(y, along + 1), np.repeat(z, count)], axis=1)
    n = np.arange(len(points)).reshape(along + 1, count)
    ahead = np.roll(n, -1, axis=1)
    quads = np.stack([n[:-1], ahead[:-1], ahead[1:], n[1:]], axis=-1).reshape(-1, 4)
    numbers = np.arange(1, len(points) + 1)
    mesh = ImportedMesh("tube", points, numbers, {"quad4": quads}, {"quad4": numbers[: len(quads)]})
    return fs.Shell("part", mesh, STEEL, thickness)


def test_a_long_cylinder_breathes_and_ovals() -> None:
    """Plane strain: n = 2, 3 bend without stretching (Rayleigh), n = 0 stretches without bending."""
    radius, t, count = 0.5, 5e-3, 96
    part = tube(count, 1, radius, 0.05, t)
    flat = fs.Support("plane", ("z", "rx", "ry"), on="part")
    elastic = STEEL.E / (1.0 - STEEL.nu**2)
    n = np.array([2.0, 3.0])
    bending = np.sqrt(elastic * t**2 / 12.0 / STEEL.rho * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)) / radius**2 / (2 * np.pi)
    found = frequencies(part, up_to=1.02 * bending[1], supports=(flat,))
    elastic_modes = found[found > 1.0]
    # Facets (pi n / count)^2 and discretisation; Rayleigh's form leaves out (t / R)^2 and shear.
    assert elastic_modes == pytest.approx(np.repeat(bending, 2), rel=6e-3)
    breathing = np.sqrt(elastic / STEEL.rho) / radius / (2.0 * np.pi)
    model = fs.mesh_structure(fs.Structure("a", (part,), supports=(flat,)))
    basis = fs.modal_basis(fs.assemble(model), up_to=1.05 * breathing)
    outwards = model.mesh.points * [1.0, 1.0, 0.0] / radius
    shares = np.einsum("nck,nc->k", basis.shapes[:, :3], outwards) / len(outwards)
    best = int(np.argmax(np.abs(shares)))
    assert basis.frequency_hz[best] == pytest.approx(breathing, rel=1e-3)  # facets: (pi / count)^2


def split(mesh: ImportedMesh, at: float) -> tuple[fs.Shell, fs.Shell]:
    """Its cells on both sides of a line, each with nodes of its own along it."""
    left = mesh.points[mesh.cells["quad4"]].mean(axis=1)[:, 0] < at
    seam = np.flatnonzero(np.abs(mesh.points[:, 0] - at) < 1e-9)
    of = [
        ImportedMesh(
            "half",
            mesh.points,
            mesh.numbers,
            {"quad4": mesh.cells["quad4"][own]},
            {"quad4": np.arange(own.sum())},
            {"seam": seam},
        )
        for own in (left, ~left)
    ]
    return fs.Shell("left", of[0], STEEL, T), fs.Shell("right", of[1], STEEL, T)


@pytest.mark.parametrize("sets", [{}, {"left": "seam", "right": "seam"}])
def test_two_halves_that_are_joined_are_the_whole(sets: dict[str, str]) -> None:
    mesh = sheet(12, 6, 0.6, 0.4)
    whole = frequencies(fs.Shell("part", mesh, STEEL, T), up_to=400.0)
    joint = fs.Joint("weld", "left", "right", sets=sets)
    # rounding of two solutions
    assert frequencies(*split(mesh, 0.3), up_to=400.0, joints=(joint,))[6:] == pytest.approx(whole[6:], rel=1e-8)


def test_halves_apart_are_joined_by_rigid_arms_within_reach() -> None:
    """Arms as long as a gap of 1 mm change little; without `reach` nothing touches, and the message says how far."""
    mesh = sheet(12, 6, 0.6, 0.4)
    left, right = split(mesh, 0.3)
    off = ImportedMesh("half", right.mesh.points + np.array([1e-3, 0, 0]), right.mesh.numbers, right.mesh.cells,
                       right.mesh.cell_numbers, right.mesh.node_sets)  # fmt: skip
    right = fs.Shell("right", off, STEEL, T)
    whole = frequencies(fs.Shell("part", mesh, STEEL, T), up_to=400.0)
    ends = {"left": "seam", "right": "seam"}
    found = frequencies(left, right, up_to=400.0, joints=(fs.Joint("weld", "left", "right", sets=ends, reach=2e-3),))
    assert found[6:] == pytest.approx(whole[6:], rel=5e-3)  # 1 mm of 600 stands for nothing that bends
    with pytest.raises(InputError, match=r"joints\.weld: got .* the nearest two are 0\.001 m apart, .*'reach: 1 mm'"):
        frequencies(left, right, up_to=400.0, joints=(fs.Joint("weld", "left", "right", sets=ends),))


def test_an_offset_of_a_free_plate_changes_no_frequency_and_of_a_held_one_does() -> None:
    mesh = sheet(8, 6, 0.5, 0.4, 0.3)
    middle, beside = (fs.Shell("part", mesh, STEEL, T, offset=e) for e in (0.0, 20e-3))
    free = frequencies(middle, up_to=500.0)
    assert frequencies(beside, up_to=500.0)[6:] == pytest.approx(free[6:], rel=1e-8)  # rounding of two solutions
    stiffer = frequencies(beside, up_to=900.0, supports=HARD)[0] / frequencies(middle, up_to=900.0, supports=HARD)[0]
    assert stiffer > 1.5  # an arch


def test_a_shell_is_joined_to_a_plate_of_its_own_grid() -> None:
    """Half as a plate, half as a shell, clamped across the joint: a cantilever's first modes are those of the plate."""
    whole = fs.Plate("plate", STEEL, T, (0.0, 0.0, 0.0), (0.6, 0.2), (24, 8), in_plane="elastic")
    root = fs.Support("root", "clamped", on="plate", edge="x0")
    near = fs.Plate("plate", STEEL, T, (0.0, 0.0, 0.0), (0.3, 0.2), (12, 8), in_plane="elastic")
    mesh = sheet(24, 16, 0.3, 0.2)
    far = ImportedMesh("far", mesh.points + np.array([0.3, 0, 0]), mesh.numbers, mesh.cells, mesh.cell_numbers)
    parts = near, fs.Shell("shell", far, STEEL, T)
    exact = frequencies(whole, up_to=160.0, supports=(root,))
    found = frequencies(*parts, up_to=160.0, supports=(root,), joints=(fs.Joint("weld", "plate", "shell"),))
    assert found == pytest.approx(exact, rel=6e-3)  # discretisation of the shell's half: cells of 12.5 mm


def test_thicknesses_by_set_and_those_that_the_file_states() -> None:
    from femstruct.model.imported_mesh import Stated, StatedProperty

    mesh = sheet(4, 2, 0.4, 0.2)
    sets = {"left": {"quad4": np.arange(4)}, "right": {"quad4": np.arange(4, 8)}}
    stated = Stated((StatedProperty("left", 2e-3, ""), StatedProperty("right", 4e-3, "")))
    named = ImportedMesh("a", mesh.points, mesh.numbers, mesh.cells, mesh.cell_numbers, {}, sets, stated)
    for given in (None, {"left": 2e-3, "right": 4e-3}):
        part = fs.mesh_structure(fs.Structure("a", (fs.Shell("part", named, STEEL, given),))).parts["part"]
        assert part.mass == pytest.approx(STEEL.rho * 0.04 * 6e-3, rel=1e-12)  # rounding
    for wrong, message in (
        ({"left": 2e-3}, "4 of 8 cells without one"),
        ({"left": 2e-3, "none": 1e-3}, "'none', no set of a"),
        ({"left": -2e-3}, "a positive length"),
    ):
        with pytest.raises(InputError, match=rf"parts\.part\.thickness: got .*{message}|expected {message}"):
            fs.mesh_structure(fs.Structure("a", (fs.Shell("part", named, STEEL, wrong),)))
    with pytest.raises(
        InputError,
        match=r"parts\.part\.thickness: got none, and none in sheet, expected a thickness; write 'thickness: 2 mm'",
    ):
        fs.mesh_structure(fs.Structure("a", (fs.Shell("part", mesh, STEEL),)))


def rigid(places: np.ndarray, shift: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Nodal components [n, 7, 1] of a rigid motion."""
    nodal = np.zeros((len(places), 7, 1))
    nodal[:, :3, 0] = shift + np.cross(turn, places)
    nodal[:, 3:6, 0] = turn
    return nodal


def test_points_and_surfaces_follow_a_rigid_motion() -> None:
    part = tube(24, 4, 0.5, 0.6, 8e-3)
    on_it = 0.5 * np.cos(np.pi / 24) + 4e-3  # half the thickness off a facet
    at = (on_it * np.cos(np.pi / 24), on_it * np.sin(np.pi / 24), 0.22)
    upper = fs.SurfaceOn("half", "part", "above", fs.Region("box", box=((-1.0, -1e-6, 0.0), (1.0, 1.0, 1.0))))
    model = fs.mesh_structure(
        fs.Structure("a", (part,), points=(fs.PlaceOn("spot", "part", (at,)),), surfaces=(upper,))
    )
    shift, turn = np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.4, -0.3])
    nodal = rigid(model.mesh.points, shift, turn)
    point, surface = model.points["spot"], model.surfaces["half"]
    moved = np.array([point.probe(axis).of(nodal)[0] for axis in "xyz"])
    assert moved == pytest.approx(shift + np.cross(turn, at), abs=1e-12)  # rounding
    assert point.normal == pytest.approx([np.cos(np.pi / 24), np.sin(np.pi / 24), 0.0], abs=1e-12)  # rounding
    chord = 2.0 * 0.5 * np.sin(np.pi / 24)
    assert surface.weights.sum() == pytest.approx(12 * chord * 0.6, rel=1e-12)  # rounding
    there = np.einsum("pi,pi->p", surface.normals, shift + np.cross(turn, surface.points))
    assert surface.shapes(nodal)[:, 0] == pytest.approx(there, abs=1e-12)  # rounding
    # A shift along y displaces the air in front of the diameter.
    pushed = surface.pressure().of(rigid(model.mesh.points, np.array([0.0, 1.0, 0.0]), np.zeros(3)))
    assert pushed[0] == pytest.approx(-1.0 * 0.6, rel=1e-12)  # rounding
    with pytest.raises(InputError, match=r"surfaces\.all\.region: got all of part, which is closed, expected a side"):
        fs.mesh_structure(fs.Structure("a", (part,), surfaces=(fs.SurfaceOn("all", "part"),)))
    with pytest.raises(InputError, match=r"points\.far\.at: got .* m off part, expected a place on it; the nearest is"):
        fs.mesh_structure(fs.Structure("a", (part,), points=(fs.PlaceOn("far", "part", ((0.6, 0.0, 0.1),)),)))


def test_cells_that_are_too_long_for_a_frequency_are_found_and_those_that_are_not_are_right() -> None:
    """Eight cells a wave of a plate that bends along one direction: 2.6 % too high, and no finding from there on."""
    from femstruct.parts.wave_findings import mesh_findings, mesh_limit_hz

    mesh = sheet(8, 1, 0.5, 0.0625)
    model = fs.mesh_structure(fs.Structure("a", (fs.Shell("part", mesh, STEEL, T),)))
    frequency = float(thin((2.0 * np.pi / 0.5) ** 2))  # of a wave as long as eight cells
    assert mesh_limit_hz(model) == pytest.approx(frequency, rel=1e-12)  # rounding
    assert not mesh_findings(model, 0.99 * frequency)  # shear shortens the wave by less than that
    (found,) = mesh_findings(model, 1.05 * frequency)
    assert found.code == "coarse-mesh" and not found.severe
    assert found.message.startswith("part: the bending wavelength at") and "8 of 8 cells are too long" in found.message
    assert mesh_findings(model, 30.0 * frequency)[0].severe


def deflected(model: fs.Model, load: np.ndarray) -> np.ndarray:
    """Nodal components [node, 7, 1] under a static load [n_nodes * 7]."""
    assembly = fs.assemble(model)
    u = spsolve(assembly.K, np.asarray(load @ assembly.dofs.T).ravel())
    return np.asarray((assembly.dofs.T @ u).reshape(-1, 7, 1))


@pytest.mark.parametrize("edges", ["simple", "clamped"])
def test_stresses_of_a_square_plate_under_pressure(edges: str) -> None:
    """Moments over p a^2, nu = 0.3: 0.0479 in the middle (Timoshenko, Woinowsky-Krieger, Theory of Plates and Shells,
    table 8); clamped 0.02291, and -0.05133 in the middle of an edge (Taylor, Govindjee, doi:10.1002/cnm.717)."""
    mesh = sheet(32, 32, 1.0, 1.0, 0.2)
    clamp = (held("along x", ("x", "y", "z", "rx", "ry")), held("along y", ("x", "y", "z", "rx", "ry")))
    part = fs.Shell("part", mesh, STEEL, 0.01)
    top = (fs.SurfaceOn("top", "part"),)
    model = fs.mesh_structure(fs.Structure("a", (part,), supports=HARD if edges == "simple" else clamp, surfaces=top))
    load = 1e3 * model.surfaces["top"].pressure().row(model.mesh.n_nodes).toarray().ravel()
    places = model.parts["part"].stresses(model.mesh.n_nodes)
    found = von_mises(places.of(deflected(model, load)), places.components)[:, 0] / (1e3 * 6 / 0.01**2)

    def at(x: float, y: float) -> np.ndarray:
        near = np.argsort(np.linalg.norm(places.places[:, :2] - [x, y], axis=1))[:2]  # both faces of one node
        return found[near]

    middle = 0.0479 if edges == "simple" else 0.02291  # of both directions, so of von Mises, too
    assert at(0.5, 0.5) == pytest.approx(middle, rel=0.01)  # discretisation, h^2, moved nodes
    if edges == "clamped":
        edge = 0.05133 * np.sqrt(1.0 - 0.3 + 0.3**2)  # with 0.3 of it along the edge
        assert at(0.5, 0.0) == pytest.approx(edge, rel=0.03)  # discretisation: h at an edge where moments vary fast


def test_stresses_know_the_offset_and_where_cells_meet_smoothly() -> None:
    mesh = sheet(4, 3, 0.5, 0.4, 0.3)
    found = {}
    for offset in (0.0, 20e-3):
        part = fs.mesh_structure(fs.Structure("a", (fs.Shell("part", mesh, STEEL, T, offset=offset),))).parts["part"]
        nodal = np.random.default_rng(6).normal(size=(len(part.places), 7, 1))
        nodal[:, 6] = 0.0
        nodal[:, :3, 0] -= np.cross(nodal[:, 3:6, 0], [0.0, 0.0, offset])  # so that the plate itself moves alike
        places = part.stresses(len(part.places))
        found[offset] = places.of(nodal)
        assert places.places[:2, 2].tolist() == pytest.approx([offset + T / 2, offset - T / 2])
    assert found[20e-3] == pytest.approx(found[0.0], rel=1e-9)  # rounding
    tray = tube(24, 2, 0.5, 0.2, T)
    assert len(fs.mesh_structure(fs.Structure("a", (tray,))).parts["part"].stresses(72).places) == 2 * 72  # 15 degrees
    prism = tube(6, 2, 0.5, 0.2, T)
    assert len(fs.mesh_structure(fs.Structure("a", (prism,))).parts["part"].stresses(18).places) == 4 * 18  # folds


def test_equal_cells_are_computed_once_and_differ_where_anything_does() -> None:
    """A grid of equal cells, half of them thicker and two of them moved: the sum of what each cell alone gives."""
    mesh = sheet(6, 4, 0.6, 0.4)
    points = np.array(mesh.points)
    points[8, 0] += 1e-6
    sets = {"left": {"quad4": np.arange(12)}, "right": {"quad4": np.arange(12, 24)}}
    named = ImportedMesh("a", points, mesh.numbers, mesh.cells, mesh.cell_numbers, {}, sets)
    thickness = {"left": 2e-3, "right": 3e-3}
    whole = fs.mesh_structure(fs.Structure("a", (fs.Shell("part", named, STEEL, thickness, offset=1e-3),))).parts[
        "part"
    ]
    K, M = whole.stiffness_and_mass()
    summed = np.zeros((2, *K.shape))
    for number, cell in enumerate(mesh.cells["quad4"]):
        own = ImportedMesh("one", points[cell], np.arange(4), {"quad4": [[0, 1, 2, 3]]}, {"quad4": [1]})
        alone = fs.Shell("one", own, STEEL, thickness["left" if number < 12 else "right"], offset=1e-3)
        part = fs.mesh_structure(fs.Structure("a", (alone,))).parts["one"]
        at = (6 * cell[:, None] + np.arange(6)).ravel()
        for total, matrix in zip(summed, part.stiffness_and_mass(), strict=True):
            total[np.ix_(at, at)] += matrix.toarray()
    for total, matrix in zip(summed, (K, M), strict=True):
        assert np.abs(total - matrix).max() < 1e-11 * np.abs(total).max()  # rounding, and the 11 digits of a shape


def test_a_floor_on_a_wall_faces_one_way_however_its_halves_are_numbered() -> None:
    """Three cells meet at an edge over the wall: each half of the floor is a patch of its own."""
    points = [[x, y, 0.0] for x in (0.0, 1.0, 2.0) for y in (0.0, 1.0)] + [[1.0, 0.0, -1.0], [1.0, 1.0, -1.0]]
    quads = [[0, 2, 3, 1], [2, 3, 5, 4], [2, 3, 7, 6]]  # up, down, and the wall
    sets = {"floor": {"quad4": [0, 1]}}
    mesh = ImportedMesh("a", points, np.arange(8), {"quad4": quads}, {"quad4": [1, 2, 3]}, {}, sets)
    for side, up in (("above", 1.0), ("below", -1.0)):
        under = (fs.SurfaceOn("s", "part", side, fs.Region("set", named="floor")),)  # type: ignore[arg-type]
        model = fs.mesh_structure(fs.Structure("a", (fs.Shell("part", mesh, STEEL, T),), surfaces=under))
        surface = model.surfaces["s"]
        assert (surface.normals == [0.0, 0.0, up]).all()
        pushed = surface.pressure().of(rigid(model.mesh.points, np.array([0.0, 0.0, 1.0]), np.zeros(3)))
        assert pushed[0] == pytest.approx(-2.0 * up, rel=1e-12)  # rounding
