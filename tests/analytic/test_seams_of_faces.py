"""Flat faces of solids with different nodes: patch tests across, rigid motions, balance, a bar of two pieces."""

from __future__ import annotations

import re

import numpy as np
import pytest
from numpy.typing import NDArray

import femstruct as fs
from femstruct.elements.solid import reference_nodes, shapes
from femstruct.errors import InputError
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.model import Model
from femstruct.model.seams import Faces, across_faces

Array = NDArray[np.float64]
STUFF = fs.Material("stuff", E=1e9, nu=0.3, rho=1000.0)
TETRAHEDRA = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))


def block(kind: str, counts: tuple[int, int, int], z0: float, moved: float = 0.0, shear: float = 0.0) -> ImportedMesh:
    """A unit cube on z = z0. moved : inner lines of nodes, as a share of a cell; shear : of x by y. Sets of faces
    "bottom" and "top"."""
    x, y, z = np.meshgrid(*(np.linspace(0.0, 1.0, n + 1) for n in counts), indexing="ij")
    moves = np.random.default_rng(3).uniform(-moved, moved, (2, counts[0] + 1, counts[1] + 1, 1))
    moves[:, [0, -1]] = moves[:, :, [0, -1]] = 0.0
    grid = np.stack([x + moves[0] / counts[0], y + moves[1] / counts[1], z0 + z], axis=-1)
    grid[..., 0] += shear * grid[..., 1]
    i, j, k = (one.ravel() for one in np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"))
    steps = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    corners = np.stack([grid[i + a, j + b, k + c] for a, b, c in steps], axis=1)
    if kind.startswith("tet"):
        corners = corners[:, TETRAHEDRA].reshape(-1, 4, 3)
    linear = "tet4" if kind.startswith("tet") else "hex8"
    values = shapes(linear, reference_nodes(kind))[0]
    nodes = np.einsum("nk,mkd->mnd", values, corners).reshape(-1, 3)
    _, first, number = np.unique(np.round(nodes, 9), axis=0, return_index=True, return_inverse=True)
    points, cells = nodes[first], number.ravel().reshape(len(corners), -1)
    sets = {name: np.flatnonzero(np.abs(points[:, 2] - at) < 1e-9) for name, at in (("bottom", z0), ("top", z0 + 1.0))}
    return ImportedMesh(
        "block", points, np.arange(1, len(points) + 1), {kind: cells}, {kind: np.arange(len(cells))}, sets
    )


def stacked(fine: ImportedMesh, coarse: ImportedMesh, **more: object) -> Model:
    """One block on another: the upper one follows."""
    upper, lower = fs.Solid("upper", fine, STUFF), fs.Solid("lower", coarse, STUFF)
    seam = fs.Seam("glue", "upper", fs.Region("set", named="bottom"), "lower", fs.Region("set", named="top"))
    return fs.mesh_structure(fs.Structure("stack", (upper, lower), constraints=(seam,)))


@pytest.mark.parametrize(
    ("one", "other", "moved", "shear", "within"),
    [
        ("hex8", "hex8", 0.0, 0.3, 1e-10),  # rounding: shape functions are polynomials over parallelograms
        ("tet4", "tet4", 0.2, 0.0, 1e-10),  # and over triangles
        ("tet10", "tet4", 0.2, 0.0, 1e-10),
        ("tet10", "tet10", 0.2, 0.0, 1e-10),
        ("hex20", "hex20", 0.0, 0.3, 1e-10),
        ("hex27", "tet10", 0.0, 0.3, 1e-10),
        ("hex8", "hex8", 0.2, 0.0, 1e-10),  # and quotients of polynomials over other quadrilaterals
    ],
)
def test_constant_stresses_go_across(one: str, other: str, moved: float, shear: float, within: float) -> None:
    """A column that is pulled: the exact motion violates no equation, and leaves no force but at both ends. All
    directions go across by the same factors."""
    model = stacked(block(one, (3, 2, 2), 1.0, moved, shear), block(other, (2, 2, 1), 0.0, moved, shear))
    assembly = fs.assemble(model)
    exact = np.zeros((model.mesh.n_nodes, 7))
    exact[:, :3] = model.mesh.points * [-STUFF.nu, -STUFF.nu, 1.0]
    (tie,) = model.ties
    assert np.abs(tie.rows @ exact.ravel()).max() < 1e-12  # rounding
    free = np.linalg.lstsq(assembly.dofs.T.toarray(), exact.ravel(), rcond=None)[0]
    assert assembly.dofs.T @ free == pytest.approx(exact.ravel(), abs=1e-11)  # rounding of least squares
    forces = assembly.K @ free
    node = np.array([int(re.findall(r"node (\d+)", label)[0]) for label in assembly.dofs.labels])
    inside = np.abs(assembly.points[node, 2] - 1.0) < 1.0 - 1e-6
    assert np.abs(forces[inside]).max() < within * np.abs(forces[~inside]).max()


def test_a_seam_of_faces_keeps_six_rigid_motions_and_the_frequencies_of_one_block() -> None:
    basis = fs.modal_basis(
        fs.assemble(stacked(block("hex20", (4, 4, 4), 1.0), block("tet10", (3, 3, 3), 0.0))), count=12
    )
    cube = block("hex20", (3, 3, 6), 0.0)
    numbers = {"hex20": np.arange(len(cube.cells["hex20"]))}
    long = ImportedMesh("one", np.asarray(cube.points) * [1.0, 1.0, 2.0], cube.numbers, cube.cells, numbers)
    one = fs.mesh_structure(fs.Structure("one", (fs.Solid("one", long, STUFF),)))
    whole = fs.modal_basis(fs.assemble(one), count=12)
    assert basis.n_rigid == 6
    assert basis.frequency_hz[6:] == pytest.approx(whole.frequency_hz[6:], rel=5e-3)  # three tetrahedra a metre


def test_factors_keep_forces_and_moments() -> None:
    """Of any load on the nodes of one side, which the other side carries on."""
    rng = np.random.default_rng(2)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    middle = np.vstack([square, [[0.45, 0.6]]])
    first = Faces({"tri3": np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])}, middle)
    second = Faces({"quad4": np.array([[0, 1, 2, 3]])}, square * 1.5 - 0.2)
    found = across_faces(first, second)
    assert found.covered == pytest.approx(1.0, rel=1e-12)  # rounding, here and below
    pushes = rng.standard_normal(5)
    passed = found.factors.T @ pushes
    assert passed.sum() == pytest.approx(pushes.sum(), rel=1e-10)  # rounding
    assert passed @ second.places == pytest.approx(pushes @ first.places, rel=1e-10)  # rounding


@pytest.mark.parametrize(
    ("fine", "coarse", "told"),
    [
        (
            block("hex8", (2, 2, 1), 1.0, 0.0, 0.3),
            block("hex8", (2, 2, 1), 0.0),
            "none of the second part against them",
        ),
        (block("hex8", (2, 2, 1), 1.2), block("hex8", (2, 2, 1), 0.0), "m off one plane"),
    ],
    ids=["overhang", "gap"],
)
def test_faces_that_do_not_meet_are_refused(fine: ImportedMesh, coarse: ImportedMesh, told: str) -> None:
    with pytest.raises(InputError) as caught:
        stacked(fine, coarse)
    assert told in str(caught.value) and "constraints.glue" in str(caught.value)
