"""Solids on meshes through the whole path: bars, joints with frames and shells, sets, stresses, materials with axes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

import femstruct as fs
from femstruct.elements import solid
from femstruct.errors import InputError
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.sections import rectangle
from femstruct.parts.wave_findings import mesh_findings, mesh_limit_hz

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
FLAT = fs.Material("flat", E=210e9, nu=0.0, rho=7850.0)
FACES = {"left": (0, 0.0), "right": (0, 1.0), "top": (2, 1.0)}


def block(kind: str, counts: tuple[int, int, int], size: tuple[float, float, float]) -> ImportedMesh:
    """A box of hexahedra with sets of nodes on its left and right end, and of faces (corners alone) on its top."""
    axes = [np.arange(n) for n in counts]
    first = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    places = first[:, None] + solid.reference_nodes(kind)
    whole, cells = np.unique(np.rint(2 * places.reshape(-1, 3)).astype(int), axis=0, return_inverse=True)
    shares = whole / 2.0 / counts
    cells = cells.reshape(-1, solid.node_count(kind))
    sets = {name: np.flatnonzero(shares[:, axis] == side) for name, (axis, side) in FACES.items() if name != "top"}
    tops = cells[np.isin(cells[:, 4:8], np.flatnonzero(shares[:, 2] == 1.0)).all(axis=1)][:, 4:8]
    numbers = np.arange(1, len(cells) + 1)
    return ImportedMesh(
        "block",
        shares * size,
        np.arange(1, len(shares) + 1),
        {kind: cells, "quad4": tops},
        {kind: numbers, "quad4": len(cells) + np.arange(1, len(tops) + 1)},
        sets,
        {"top": {"quad4": np.arange(len(tops))}},
    )


def meshed(*parts: fs.Solid | fs.Shell | fs.Frame | fs.Plate, **more: object) -> object:
    return fs.mesh_structure(fs.Structure("a", parts, **more))  # type: ignore[arg-type]


def frequencies(model: object, up_to: float) -> np.ndarray:
    basis = fs.modal_basis(fs.assemble(model), up_to=up_to)  # type: ignore[arg-type]
    return np.asarray(basis.frequency_hz[basis.modes])


def clamped(name: str = "left") -> fs.Support:
    return fs.Support("wall", ("x", "y", "z"), on="bar", region=fs.Region("set", named=name))


def moved(model: object, load: object) -> np.ndarray:
    """Nodal components [node, 7, 1] under a load, a row over all components."""
    assembly = fs.assemble(model)  # type: ignore[arg-type]
    u = spsolve(assembly.K, np.asarray((load @ assembly.dofs.T).todense()).ravel())
    return np.asarray((assembly.dofs.T @ u).reshape(-1, 7, 1))


@pytest.mark.parametrize(("kind", "cells", "within"), [("hex8", 40, 8e-3), ("hex20", 24, 1e-3), ("hex27", 24, 1e-3)])
def test_a_cantilever_of_a_mesh_is_a_timoshenko_bar(kind: str, cells: int, within: float) -> None:
    """Bending both ways of a bar 1 m x 0.06 m x 0.04 m, nu = 0, against bars of three nodes.

    What is left is h^2 of hex8 in the fifth mode, and that the clamp holds the warping of the shear.
    """
    bar = fs.Solid("bar", block(kind, (cells, 2, 2), (1.0, 0.06, 0.04)), FLAT)
    solid_hz = frequencies(meshed(bar, supports=(clamped(),)), 650.0)
    frame = fs.Frame("bar", FLAT, rectangle("s", 0.06, 0.04), (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), mesh=0.05)
    foot = fs.PlaceOn("foot", "bar", at=((0.0, 0.0, 0.0),))
    bar_hz = frequencies(meshed(frame, points=(foot,), supports=(fs.Support("wall", "clamped", at="foot"),)), 650.0)
    assert len(solid_hz) == len(bar_hz) == 5
    np.testing.assert_allclose(solid_hz, bar_hz, rtol=within)


def test_mass_outline_and_names_of_what_it_has() -> None:
    part = meshed(fs.Solid("bar", block("hex20", (2, 1, 1), (2.0, 1.0, 0.5)), STEEL)).parts["bar"]  # type: ignore[attr-defined]
    assert part.mass == pytest.approx(7850.0, rel=1e-12)  # rounding
    assert part.lumps.sum() == pytest.approx(7850.0, rel=1e-12)  # rounding
    assert part.cells.facets.areas.sum() == pytest.approx(2 * (2 + 1 + 0.5), rel=1e-12)  # rounding


def test_a_set_of_faces_radiates_outwards() -> None:
    bar = fs.Solid("bar", block("hex20", (3, 2, 1), (0.3, 0.2, 0.1)), STEEL)
    model = meshed(bar, surfaces=(fs.SurfaceOn("lid", "bar", region=fs.Region("set", named="top")),))
    lid = model.surfaces["lid"]  # type: ignore[attr-defined]
    assert lid.weights.sum() == pytest.approx(0.06, rel=1e-12)  # rounding
    np.testing.assert_allclose(lid.normals, np.tile([0, 0, 1.0], (len(lid.weights), 1)), atol=1e-12)  # rounding
    lifted = np.zeros((model.mesh.n_nodes, 7, 1))  # type: ignore[attr-defined]
    lifted[:, 2] = 2.0
    np.testing.assert_allclose(lid.shapes(lifted), 2.0, rtol=1e-12)  # rounding
    with pytest.raises(InputError, match="faces all round bar"):
        meshed(bar, surfaces=(fs.SurfaceOn("all", "bar"),))


def test_points_on_faces_and_of_sets_follow_a_rigid_motion() -> None:
    bar = fs.Solid("bar", block("hex20", (3, 2, 1), (0.3, 0.2, 0.1)), STEEL)
    places = (
        fs.PlaceOn("spot", "bar", at=((0.13, 0.07, 0.1),)),
        fs.PlaceOn("end", "bar", at=(), named="right"),
    )
    model = meshed(bar, points=places)
    turn, shift = np.array([0.01, -0.02, 0.03]), np.array([1.0, 2.0, 3.0])
    nodal = np.zeros((model.mesh.n_nodes, 7, 1))  # type: ignore[attr-defined]
    nodal[:, :3, 0] = shift + np.cross(turn, model.mesh.points)  # type: ignore[attr-defined]
    for name, at in (("spot", [0.13, 0.07, 0.1]), ("end", [0.3, 0.1, 0.05])):
        point = model.points[name]  # type: ignore[attr-defined]
        got = [point.probe(d).of(nodal)[0] for d in ("x", "y", "z", "rx", "ry", "rz")]
        np.testing.assert_allclose(got, [*(shift + np.cross(turn, at)), *turn], rtol=1e-9)  # rounding
    np.testing.assert_allclose(model.points["end"].normal, [1, 0, 0], atol=1e-12)  # type: ignore[attr-defined]  # rounding


@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_tension_and_bending_stress(kind: str) -> None:
    """N / A along a bar, and M y / I of a load across its end; nu = 0.3, away from the ends."""
    size = (1.0, 0.1, 0.1)
    bar = fs.Solid("bar", block(kind, (20, 2, 2), size), STEEL)
    end = fs.PlaceOn("end", "bar", at=(), named="right")
    model = meshed(bar, points=(end,), supports=(clamped(),))
    n_nodes = model.mesh.n_nodes  # type: ignore[attr-defined]
    places = model.parts["bar"].stresses(n_nodes)  # type: ignore[attr-defined]
    pulled = places.of(moved(model, 1e4 * model.points["end"].probe("x").row(n_nodes)))[:, :, 0]  # type: ignore[attr-defined]
    inside = (places.places[:, 0] > 0.25) & (places.places[:, 0] < 0.75)
    np.testing.assert_allclose(pulled[inside, 0], 1e6, rtol=1e-3)  # what is left of the ends two depths away
    np.testing.assert_allclose(pulled[inside, 1:], 0.0, atol=1e3)  # the same
    bent = places.of(moved(model, 1e3 * model.points["end"].probe("z").row(n_nodes)))[:, 0, 0]  # type: ignore[attr-defined]
    x, _, z = places.places.T
    exact = -1e3 * (1.0 - x) * (z - 0.05) / (0.1**4 / 12)
    np.testing.assert_allclose(bent[inside], exact[inside], atol=0.01 * np.abs(exact[inside]).max())  # h^2 of a cell


def test_a_rib_of_orthotropic_material_bends_by_the_modulus_along_it() -> None:
    """A bar along y of timber whose x is laid along the bar: the deflection of a beam with Ex, shear with Gxy."""
    timber = fs.Orthotropic("timber", E=(11e9, 0.4e9, 0.4e9), G=(0.7e9, 0.07e9, 0.7e9), nu=(0.0, 0.0, 0.0), rho=450.0)
    mesh = block("hex20", (1, 20, 1), (0.05, 1.0, 0.05))
    near = np.flatnonzero(np.asarray(mesh.points)[:, 1] == 0.0)
    far = np.flatnonzero(np.asarray(mesh.points)[:, 1] == 1.0)
    mesh = ImportedMesh(
        "rib", mesh.points, mesh.numbers, {"hex20": mesh.cells["hex20"]}, {"hex20": mesh.cell_numbers["hex20"]},
        {"left": near, "right": far},
    )  # fmt: skip
    bar = fs.Solid("bar", mesh, timber, orientation=(0.0, 1.0, 0.0))
    model = meshed(bar, points=(fs.PlaceOn("end", "bar", at=(), named="right"),), supports=(clamped(),))
    load = model.points["end"].probe("z").row(model.mesh.n_nodes)  # type: ignore[attr-defined]
    end = model.points["end"].probe("z").of(moved(model, load))[0]  # type: ignore[attr-defined]
    exact = 1.0 / (3 * 11e9 * 0.05**4 / 12) + 1.0 / (5 / 6 * 0.7e9 * 0.05**2)
    assert end == pytest.approx(exact, rel=3e-3)  # the clamp holds the warping of the shear


def welded(kind: str, joint: fs.Joint) -> np.ndarray:
    """The first four frequencies of a block and a bar of its section, end to end, clamped: two pairs in bending."""
    section = rectangle("s", 0.06, 0.06)
    first = fs.Solid("bar", block(kind, (10, 2, 2), (0.5, 0.06, 0.06)), FLAT)
    second = fs.Frame("rest", FLAT, section, (((0.5, 0.03, 0.03), (1.0, 0.03, 0.03)),), mesh=0.05)
    return frequencies(meshed(first, second, joints=(joint,), supports=(clamped(),)), 400.0)[:4]


def one_bar() -> np.ndarray:
    whole = fs.Frame("all", FLAT, rectangle("s", 0.06, 0.06), (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), mesh=0.05)
    foot = fs.PlaceOn("foot", "all", at=((0.0, 0.0, 0.0),))
    return frequencies(meshed(whole, points=(foot,), supports=(fs.Support("wall", "clamped", at="foot"),)), 400.0)[:4]


@pytest.mark.parametrize("kind", ["hex8", "hex20"])
@pytest.mark.parametrize("ends", [("bar", "rest"), ("rest", "bar")])
def test_a_frame_joined_to_a_face_hands_its_moment_over(kind: str, ends: tuple[str, str]) -> None:
    """Every node of the end follows the bar: frequencies are those of one bar of both lengths."""
    joint = fs.Joint("weld", *ends, sets={"bar": "right"}, reach=0.05)
    within = {"hex8": 8e-3, "hex20": 1e-3}[kind]  # h^2 of hex8 in the second pair; the clamp holds warping
    np.testing.assert_allclose(welded(kind, joint), one_bar(), rtol=within)


@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_a_frame_joined_to_one_node_turns_with_the_surface_around(kind: str) -> None:
    """A weld of a few millimetres gives way, and more with smaller cells: softer than one bar, and no hinge."""
    found = welded(kind, fs.Joint("weld", "rest", "bar")) / one_bar()
    assert (found < 1.005).all()
    assert (found > 0.9).all()


def test_a_turn_of_a_welded_bar_is_the_turn_of_the_surface() -> None:
    """A rigid motion of block and bar together strains nothing: six rigid modes, no more."""
    first = fs.Solid("bar", block("hex8", (4, 2, 2), (0.4, 0.1, 0.1)), STEEL)
    second = fs.Frame("rest", STEEL, rectangle("s", 0.02, 0.02), (((0.4, 0.05, 0.05), (0.9, 0.05, 0.05)),), mesh=0.1)
    basis = fs.modal_basis(fs.assemble(meshed(first, second, joints=(fs.Joint("weld", "rest", "bar"),))), count=8)  # type: ignore[arg-type]
    assert basis.kind[:7] == ("rigid",) * 6 + ("elastic",)


def test_cells_turned_inside_out_are_named_as_the_file_does() -> None:
    mesh = block("hex8", (2, 1, 1), (2.0, 1.0, 1.0))
    cells = np.array(mesh.cells["hex8"])
    cells[1] = cells[1][[4, 5, 6, 7, 0, 1, 2, 3]]
    wrong = ImportedMesh("block", mesh.points, mesh.numbers, {"hex8": cells}, {"hex8": [17, 18]})
    with pytest.raises(InputError, match=r"parts\.bar\.mesh: got 1 of 2 hex8 cells turned inside out or folded: 18"):
        meshed(fs.Solid("bar", wrong, STEEL))


def test_linear_tetrahedra_are_told() -> None:
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    mesh = ImportedMesh("t", corners, range(4), {"tet4": [[0, 1, 2, 3]]}, {"tet4": [1]})
    (found,) = fs.Solid("t", mesh, STEEL).implausible(False)
    assert found.code == "stiff-cells"
    assert "tetrahedra of 10 nodes" in found.message


@pytest.mark.parametrize(("kind", "cells", "within"), [("hex8", 16.0, 0.025), ("hex20", 8.0, 0.02)])
def test_cells_a_wave_that_the_finding_asks_for(kind: str, cells: float, within: float) -> None:
    """With as many cells a bending wave as it needs, a bar is off by what the catalogue says; with half, it is told."""
    bar = fs.Solid("bar", block(kind, (48, 2, 2), (1.0, 0.06, 0.04)), FLAT)
    fine = meshed(bar, supports=(clamped(),))
    exact = frequencies(fine, 650.0)[4]
    count = round(cells / (2 * np.pi / 7.8548))  # of the third bending mode of a cantilever
    coarse = meshed(fs.Solid("bar", block(kind, (count, 1, 1), (1.0, 0.06, 0.04)), FLAT), supports=(clamped(),))
    assert abs(frequencies(coarse, 650.0)[4] / exact - 1) < within
    carried = mesh_limit_hz(coarse)  # type: ignore[arg-type]
    assert 0.35 * exact < carried < 1.1 * exact  # of a plate as thick as twice the volume over the area
    assert not mesh_findings(coarse, 0.9 * carried)  # type: ignore[arg-type]
    (told,) = mesh_findings(coarse, 4.0 * carried)  # type: ignore[arg-type]
    assert told.code == "coarse-mesh"
    assert not told.severe
    (told,) = mesh_findings(coarse, 100.0 * carried)  # type: ignore[arg-type]
    assert told.severe
