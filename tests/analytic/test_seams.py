"""Two meshes that meet along a line with different nodes: patch tests across, rigid motions, balance, convergence."""

from __future__ import annotations

import re

import numpy as np
import pytest
from numpy.typing import NDArray

import femstruct as fs
from femstruct.assembly.matrices import Assembly
from femstruct.errors import InputError
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.model import Model
from femstruct.model.seams import mortar

LIMP = fs.Material("limp", E=1e9, nu=0.0, rho=1000.0)
STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)


def sheet(x0: float, nx: int, ny: int, skew: float = 0.0) -> ImportedMesh:
    """A square of 1 m in nx x ny cells, inner nodes moved by a share of a cell; sets "left" and "right"."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, nx + 1), np.linspace(0.0, 1.0, ny + 1), indexing="ij")
    moved = skew / nx * np.sin(3.0 * np.pi * x) * np.sin(2.0 * np.pi * y)
    points = np.stack([x0 + x + moved, y + moved, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    n = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    cells = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
    sets = {"left": n[0].tolist(), "right": n[-1].tolist()}
    return ImportedMesh("sheet.msh", points, n.ravel() + 1, {"quad4": cells}, {"quad4": np.arange(len(cells))}, sets)


def sheets(material: fs.Material, fine: int, coarse: int, across: tuple[int, int] = (4, 3)) -> Model:
    """Two squares side by side, x from 0 to 1 and from 1 to 2, with so many cells along the line x = 1 and across."""
    one = fs.Shell("one", sheet(0.0, across[0], fine, 0.1), material, 0.02)
    two = fs.Shell("two", sheet(1.0, across[1], coarse, 0.1), material, 0.02)
    seam = fs.Seam("seam", "one", fs.Region("set", named="right"), "two", fs.Region("set", named="left"))
    return fs.mesh_structure(fs.Structure("sheets", (one, two), constraints=(seam,)))


def stretching(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Constant strains in the plane, with the rotation that goes with them."""
    u = np.zeros((len(x), 7))
    u[:, 0], u[:, 1], u[:, 5] = 1.0 * x + 0.4 * y, -0.3 * x + 0.7 * y, (-0.3 - 0.4) / 2.0
    return u


def bending_across(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    u = np.zeros((len(x), 7))
    u[:, 2], u[:, 4] = x**2 / 2.0, -x
    return u


def twisting(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    u = np.zeros((len(x), 7))
    u[:, 2], u[:, 3], u[:, 4] = x * y, x, -y
    return u


def inner(assembly: Assembly) -> NDArray[np.bool_]:
    """Free degrees of freedom of nodes that are not on the outer edges."""
    node = np.array([int(re.findall(r"node (\d+)", label)[0]) for label in assembly.dofs.labels])
    x, y, _ = assembly.points[node].T
    return (x > 1e-9) & (x < 2.0 - 1e-9) & (y > 1e-9) & (y < 1.0 - 1e-9)


@pytest.mark.parametrize("field", [stretching, bending_across, twisting])
@pytest.mark.parametrize(("fine", "coarse"), [(7, 5), (6, 3), (5, 4)])
def test_constant_strains_go_across(field, fine: int, coarse: int) -> None:
    """The exact motion violates no equation, and leaves no force inside nor on the seam."""
    model = sheets(LIMP, fine, coarse)
    assembly = fs.assemble(model)
    exact = field(*model.mesh.points[:, :2].T).ravel()
    (tie,) = model.ties
    assert np.abs(tie.rows @ exact).max() < 1e-13  # rounding
    free = np.linalg.lstsq(assembly.dofs.T.toarray(), exact, rcond=None)[0]
    assert assembly.dofs.T @ free == pytest.approx(exact, abs=1e-11)  # rounding of least squares
    forces = assembly.K @ free
    kept = inner(assembly)
    assert np.abs(forces[kept]).max() < 1e-9 * np.abs(forces[~kept]).max()  # rounding of sums of stiffness 1e7


def test_a_seam_keeps_six_rigid_motions_and_hardly_changes_a_plate() -> None:
    """Against one mesh: what bends along the line, the seam takes as well as the coarser mesh can."""
    basis = fs.modal_basis(fs.assemble(sheets(STEEL, 9, 7, (9, 7))), count=12)
    n = 8
    x, y = np.meshgrid(np.linspace(0.0, 2.0, 2 * n + 1), np.linspace(0.0, 1.0, n + 1), indexing="ij")
    points = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(2 * n + 1, n + 1)
    cells = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    mesh = ImportedMesh("one.msh", points, number.ravel() + 1, {"quad4": cells}, {"quad4": np.arange(len(cells))})
    one = fs.mesh_structure(fs.Structure("one", (fs.Shell("one", mesh, STEEL, 0.02),)))
    whole = fs.modal_basis(fs.assemble(one), count=12)
    assert basis.n_rigid == 6
    exact = whole.frequency_hz[6:]
    assert basis.frequency_hz[6:] == pytest.approx(exact, rel=0.015)  # meshes of 7, 9 and 8 cells a metre


def test_a_seam_between_different_meshes_converges_to_one_between_equal_ones() -> None:
    """0.26 % at most with 9 and 7 cells along the line against 8 and 8, 0.008 % with twice as many."""
    for n, share in ((8, 4e-3), (16, 2e-4)):  # and a margin of half as much again or more
        unlike, alike = (
            fs.modal_basis(fs.assemble(sheets(STEEL, a, b, (a, b))), count=12).frequency_hz[6:]
            for a, b in ((n + 1, n - 1), (n, n))
        )
        assert unlike == pytest.approx(alike, rel=share)  # from the measured ones above


def test_factors_keep_linear_functions_and_forces() -> None:
    s, t = np.array([0.1, 0.25, 0.3, 0.62, 0.9]), np.array([0.0, 0.4, 0.55, 1.0])
    factors = mortar(s, t)
    assert factors.sum(axis=1) == pytest.approx(np.ones(5), rel=1e-13)  # rounding
    assert factors @ t == pytest.approx(s, rel=1e-13)  # rounding
    pushes = np.array([3.0, -1.0, 2.0, 5.0, -4.0])
    passed = factors.T @ pushes
    assert passed.sum() == pytest.approx(pushes.sum(), rel=1e-12)  # rounding: force
    assert passed @ t == pytest.approx(pushes @ s, rel=1e-12)  # and moment


@pytest.mark.parametrize(
    ("of", "there", "told"),
    [
        ("right", "right", "constraints.seam: got nodes"),
        ("left", "left", "m off the straight line"),
        ("right", "nothing", "nothing"),
    ],
)
def test_what_is_no_seam_is_refused(of: str, there: str, told: str) -> None:
    one = fs.Shell("one", sheet(0.0, 4, 6), STEEL, 0.02)
    two = fs.Shell("two", sheet(1.0, 3, 5), STEEL, 0.02)
    seam = fs.Seam("seam", "one", fs.Region("set", named=of), "two", fs.Region("set", named=there))
    with pytest.raises(InputError) as caught:
        fs.mesh_structure(fs.Structure("sheets", (one, two), constraints=(seam,)))
    assert told in str(caught.value)


def test_the_finer_side_must_lie_within_the_other() -> None:
    one = fs.Shell("one", sheet(0.0, 4, 6), STEEL, 0.02)
    two = fs.Shell("two", sheet(1.0, 3, 8), STEEL, 0.02)
    half = fs.Region("box", box=((0.99, -0.1, -0.1), (1.01, 0.6, 0.1)))
    seam = fs.Seam("seam", "one", fs.Region("set", named="right"), "two", half)
    with pytest.raises(InputError, match=r"constraints.seam.seam: got nodes that reach 0.5 m beyond"):
        fs.mesh_structure(fs.Structure("sheets", (one, two), constraints=(seam,)))
