"""Stresses of shells on meshes against closed forms: bending, a beam on edge, a pipe, a fold, a plate with a hole."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

import femstruct as fs
from femstruct.elements.stresses import von_mises
from femstruct.model.imported_mesh import ImportedMesh

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)


def moved(model: object, load: object) -> np.ndarray:
    """Nodal components [node, 7, 1] under a load, a row over all components."""
    assembly = fs.assemble(model)  # type: ignore[arg-type]
    u = spsolve(assembly.K, (csr_array(load) @ assembly.dofs.T).toarray().ravel())
    return np.asarray((assembly.dofs.T @ u).reshape(-1, 7, 1))


def mesh_of(points: object, quads: np.ndarray, triangles: bool, sets: dict[str, np.ndarray]) -> ImportedMesh:
    """Quadrilaterals as they are, or each cut into two triangles."""
    cells = {"quad4": quads} if not triangles else {"tri3": np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])}
    points = np.asarray(points, dtype=np.float64)
    numbers = {kind: np.arange(1, len(one) + 1) for kind, one in cells.items()}
    return ImportedMesh("mesh", points, np.arange(1, len(points) + 1), cells, numbers, sets)


def grid(nx: int, ny: int, place: object, triangles: bool = False, closed: bool = False) -> ImportedMesh:
    """Cells between lines of u and v from 0 to 1, at place(u, v) [.., 3]; sets of the four sides."""
    u, v = np.meshgrid(np.linspace(0, 1, nx + 1), np.linspace(0, 1, ny + 1), indexing="ij")
    n = np.arange(u.size).reshape(u.shape)
    if closed:
        u, v, n = u[:-1], v[:-1], np.arange((nx) * (ny + 1)).reshape(nx, ny + 1)
        n = np.concatenate([n, n[:1]])
    quads = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
    sets = {"u0": n[0], "u1": n[-1], "v0": np.unique(n[:, 0]), "v1": np.unique(n[:, -1]), "first": n[0, :1]}
    return mesh_of(place(u.ravel(), v.ravel()), quads, triangles, sets)  # type: ignore[operator]


def flat(a: float, b: float) -> object:
    return lambda u, v: np.stack([a * u, b * v, 0.0 * u], axis=-1)


def held(name: str, *fix: str, named: str) -> fs.Support:
    return fs.Support(name, fix, on="part", region=fs.Region("set", named=named))


@pytest.mark.parametrize(("triangles", "within"), [(False, 1e-2), (True, 2e-2)])
def test_simply_supported_square_under_pressure(triangles: bool, within: float) -> None:
    """6 * 0.0479 p a^2 / t^2 in the middle (Timoshenko, Woinowsky-Krieger, table 8); h^2 of 20 cells."""
    shell = fs.Shell("part", grid(20, 20, flat(1.0, 1.0), triangles), STEEL, thickness=0.01)
    rim = [
        held(f"s{i}", "x", "y", "z", "ry" if i > 1 else "rx", named=n) for i, n in enumerate(("u0", "u1", "v0", "v1"))
    ]
    model = fs.mesh_structure(fs.Structure("p", (shell,), supports=tuple(rim), surfaces=(fs.SurfaceOn("top", "part"),)))
    places = model.parts["part"].stresses(model.mesh.n_nodes)
    found = places.of(moved(model, 1e3 * model.surfaces["top"].pressure().row(model.mesh.n_nodes)))[:, :, 0]
    middle = np.flatnonzero(np.linalg.norm(places.places[:, :2] - 0.5, axis=1) < 1e-9)
    for place in middle:
        sign = -1.0 if places.places[place, 2] > 0 else 1.0  # the upper face is pressed
        np.testing.assert_allclose(found[place, :2], sign * 6 * 0.0479 * 1e3 / 1e-4, rtol=within)
        assert places.sides[place % 2] == ("front" if places.places[place, 2] > 0 else "back")
    assert len(middle) == 2


@pytest.mark.parametrize(("triangles", "within"), [(False, 5e-3), (True, 0.25)])
def test_a_strip_bent_in_its_plane(triangles: bool, within: float) -> None:
    """M y / I of a cantilever on edge, 1 m by 0.1 m, away from its ends; at the rim a node has one triangle alone."""
    shell = fs.Shell("part", grid(40, 4, flat(1.0, 0.1), triangles), STEEL, thickness=0.01)
    end = fs.PlaceOn("end", "part", at=(), named="u1")
    wall = held("wall", "x", "y", "z", "rx", "ry", "rz", named="u0")
    model = fs.mesh_structure(fs.Structure("p", (shell,), points=(end,), supports=(wall,)))
    places = model.parts["part"].stresses(model.mesh.n_nodes)
    found = places.of(moved(model, 1e3 * model.points["end"].probe("y").row(model.mesh.n_nodes)))[:, :, 0]
    x, y, _ = places.places.T
    exact = -1e3 * (1.0 - x) * (y - 0.05) / (0.01 * 0.1**3 / 12)
    inside = (x > 0.2) & (x < 0.8)
    along = np.abs(np.abs(found[:, 0]) - np.abs(exact))[inside]  # axes at a place are any of the global ones
    assert along.max() < within * np.abs(exact[inside]).max()


@pytest.mark.parametrize("offset", [0.0, 2e-3])
def test_a_pipe_under_pressure(offset: float) -> None:
    """p r / t around it, nothing along it, away from its rims: there the moments that the drilling rotations of flat
    cells hand on leave something of the cube of their size."""
    r, t = 0.5, 5e-3

    def pipe(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.stack([r * np.cos(2 * np.pi * u), r * np.sin(2 * np.pi * u), 0.5 * v], axis=-1)

    shell = fs.Shell("part", grid(72, 12, pipe, closed=True), STEEL, thickness=t, offset=offset)
    rims = (held("low", "z", named="v0"), held("rest", "x", "y", named="first"), held("turn", "rz", named="first"))
    model = fs.mesh_structure(fs.Structure("p", (shell,), supports=rims))
    part = model.parts["part"]
    cells, load = part.cells, np.zeros((model.mesh.n_nodes, 7))
    outwards = cells.normals * np.sign((cells.normals * cells.points[cells.quads[:, 0]])[:, :2].sum(axis=1))[:, None]
    np.add.at(load[:, :3], cells.quads, (1e5 * cells.areas / 4)[:, None, None] * outwards[:, None])
    places = part.stresses(model.mesh.n_nodes)
    found = von_mises(places.of(moved(model, load.reshape(1, -1)))[:, :, 0], places.components)
    inside = np.abs(places.places[:, 2] - 0.25) < 0.06
    middle = r + offset * np.sign(outwards[0] @ cells.normals[0])
    np.testing.assert_allclose(found[inside], 1e5 * r / t * r / middle, rtol=1e-2)  # cells of 5 degrees; see above


def test_stresses_are_not_averaged_across_a_fold() -> None:
    """A plate pulled along x with a wing that hangs at a right angle and carries nothing: its fold has both."""
    points = [[0, 0, 0], [1, 0, 0], [0, 0.5, 0], [1, 0.5, 0], [0, 0, -0.5], [1, 0, -0.5]]
    mesh = mesh_of(points, np.array([[0, 1, 3, 2], [0, 1, 5, 4]]), False, {})
    shell = fs.Shell("part", mesh, STEEL, thickness=0.01)
    places = fs.mesh_structure(fs.Structure("p", (shell,))).parts["part"].stresses(6)
    assert len(places.places) == 2 * 8  # both faces of four corners of each cell
    nodal = np.zeros((6, 7, 1))
    nodal[:, 0, 0] = 1e-3 * np.array(points)[:, 0]
    stresses = von_mises(places.of(nodal)[:, :, 0], places.components)
    np.testing.assert_allclose(stresses, 1e-3 * 210e9 / (1 - 0.09) * np.sqrt(1 - 0.3 + 0.09), rtol=1e-9)  # rounding


@pytest.mark.parametrize(("triangles", "within"), [(False, 0.02), (True, 0.08)])
def test_a_plate_with_a_hole(triangles: bool, within: float) -> None:
    """Kirsch: three times the stress far away at the side of a small hole; a hole of a twentieth of the width has
    3.00 of the gross stress (Peterson's fit of Howland's solution)."""
    a, half = 0.01, 0.2

    def ring(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        angle = 2 * np.pi * u
        square = half / np.maximum(np.abs(np.cos(angle)), np.abs(np.sin(angle)))
        grown = a * (square / a) ** (v**1.15)  # cells grow outwards
        return np.stack([grown * np.cos(angle), grown * np.sin(angle), 0.0 * u], axis=-1)

    mesh = grid(80, 28, ring, triangles, closed=True)
    x = np.asarray(mesh.points)[:, 0]
    sets = {"left": np.flatnonzero(x < -half + 1e-9), "right": np.flatnonzero(x > half - 1e-9), "first": np.array([0])}
    mesh = ImportedMesh("hole", mesh.points, mesh.numbers, mesh.cells, mesh.cell_numbers, sets)
    shell = fs.Shell("part", mesh, STEEL, thickness=1e-3)
    supports = (held("left", "x", "z", "ry", named="left"), held("one", "y", "rx", named="first"))
    model = fs.mesh_structure(fs.Structure("p", (shell,), supports=supports))
    load = np.zeros((model.mesh.n_nodes, 7))
    right = sets["right"][np.argsort(np.asarray(mesh.points)[sets["right"], 1])]
    gaps = np.diff(np.asarray(mesh.points)[right, 1])
    load[right[:-1], 0] += 1e6 * 1e-3 * gaps / 2
    load[right[1:], 0] += 1e6 * 1e-3 * gaps / 2
    places = model.parts["part"].stresses(model.mesh.n_nodes)
    found = von_mises(places.of(moved(model, load.reshape(1, -1)))[:, :, 0], places.components)
    worst = int(found.argmax())
    assert found[worst] == pytest.approx(3.0e6, rel=within)  # h^2 of cells of 4.5 degrees; h of triangles
    assert np.abs(places.places[worst, :2]) == pytest.approx([0.0, a], abs=1e-6)  # of the place of a node
