"""Reduction to an interface: against the whole structure, condensation by dense matrices, and rigid motions."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eig, eigh
from scipy.sparse import block_diag, csr_array

import femstruct as fs
from femstruct.assembly.matrices import _equations
from femstruct.assembly.ties import RawDofs, eliminate, number_dofs
from femstruct.errors import FemstructError
from femstruct.model.model import Model

CONCRETE = fs.Material("concrete", E=30e9, nu=0.2, rho=2400.0)
STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
PLATE = fs.Plate("plate", STEEL, 0.01, (0.0, 0.0, 0.0), (1.0, 0.8), (6, 5))


def floor() -> Model:
    """Two slabs of 3 m and 2.5 m x 4 m joined along a line, on walls at both ends."""
    left = fs.Plate("left", CONCRETE, 0.18, (0.0, 0.0, 0.0), (3.0, 4.0), (12, 16))
    right = fs.Plate("right", CONCRETE, 0.18, (3.0, 0.0, 0.0), (2.5, 4.0), (10, 16))
    walls = (fs.Support("west", "simple", "left", edge="x0"), fs.Support("east", "simple", "right", edge="x1"))
    return fs.mesh_structure(fs.Structure("floor", (left, right), (fs.Joint("line", "left", "right"),), supports=walls))


def interface(model: Model, dofs: RawDofs, name: str) -> NDArray[np.int64]:
    """Degrees of freedom of a part that joints and supports touch."""
    equations, _ = _equations(model, dofs)
    first, own = dofs.parts[name]
    used = np.unique(equations.indices)
    return used[(used >= first) & (used < first + own.count)] - first


def test_ten_frequencies_of_a_floor_of_two_parts_are_those_of_the_whole() -> None:
    model = floor()
    whole = fs.modal_basis(fs.assemble(model), count=10).frequency_hz
    dofs = number_dofs(model)
    pieces = []
    for name, part in model.parts.items():
        K, M = part.stiffness_and_mass()
        pieces.append(fs.craig_bampton(M, K, interface(model, dofs, name), up_to=2.0 * whole[-1]))
    equations, _ = _equations(model, dofs)
    recovery = block_diag([csr_array(one.recovery) for one in pieces], format="csr")
    E = eliminate(csr_array(equations @ recovery)).E
    K, M = (E.T @ block_diag([getattr(one, name) for one in pieces]) @ E for name in "KM")
    values = eigh(K.toarray(), M.toarray(), eigvals_only=True)[:10]
    found = np.sqrt(values) / (2.0 * np.pi)
    assert found == pytest.approx(whole, rel=1e-4)  # what the issue asks for
    assert found == pytest.approx(whole, rel=1e-6)  # 4e-7 measured, by the highest of the ten
    assert max(len(one.frequency_hz) for one in pieces) < 40  # beside 105 of the interface, of 1496


def free_plate() -> tuple[csr_array, csr_array, NDArray[np.float64], NDArray[np.int64]]:
    """K, M, unit translations, and the degrees of freedom of the nodes of one edge."""
    model = fs.mesh_structure(fs.Structure("plate", (PLATE,)))
    part = model.parts["plate"]
    K, M = part.stiffness_and_mass()
    own = part.dofs()
    edge = np.flatnonzero(part.places[:, 0] < 1e-9)
    assert K is not None
    return K, M, own.translations, np.unique(own.columns[np.isin(own.rows // 7, edge)])


def test_statics_are_condensed_exactly_and_rigid_motions_weigh_what_they_weigh() -> None:
    K, M, shifts, edge = free_plate()
    piece = fs.craig_bampton(M, K, edge, up_to=200.0)
    inner = np.setdiff1d(np.arange(K.shape[0]), edge)
    dense = K.toarray()
    schur = dense[np.ix_(edge, edge)] - dense[np.ix_(edge, inner)] @ np.linalg.solve(
        dense[np.ix_(inner, inner)], dense[np.ix_(inner, edge)]
    )
    b = len(edge)
    assert piece.K[:b, :b] == pytest.approx(schur, abs=1e-10 * np.abs(schur).max())  # rounding of the condensation
    assert not piece.K[:b, b:].any()
    moved = np.concatenate([shifts[edge], np.zeros((len(piece.frequency_hz), 3))])
    assert piece.recovery @ moved == pytest.approx(shifts, abs=1e-9)  # rounding: the edge alone carries the plate
    assert moved.T @ piece.M @ moved == pytest.approx(7850.0 * 0.008 * np.eye(3), rel=1e-9, abs=1e-8)  # the same


def test_all_modes_are_the_whole_structure() -> None:
    K, M, _, edge = free_plate()
    piece = fs.craig_bampton(M, K, edge, count=K.shape[0])
    assert len(piece.frequency_hz) == piece.n_modes == K.shape[0] - len(edge)
    exact, found = (eigh(np.asarray(A), np.asarray(B), eigvals_only=True) for A, B in (
        (K.toarray(), M.toarray()), (piece.K, piece.M)
    ))  # fmt: skip
    assert found[6:30] == pytest.approx(exact[6:30], rel=1e-6)  # dense solvers err by 1e-16 of the highest, 1e10 above


def test_an_inside_that_can_move_with_its_interface_held() -> None:
    """A free row of masses held at one place of a plane frame of springs: the rest still slides across."""
    chain = 1e3 * (2.0 * np.eye(5) - np.eye(5, k=1) - np.eye(5, k=-1))
    chain[0, 0] = chain[-1, -1] = 1e3
    K = np.kron(np.diag([1.0, 0.0]), chain)  # along x it is a chain, along y nothing resists
    piece = fs.craig_bampton(np.eye(10), K, [0], up_to=3.0)
    assert piece.frequency_hz[:5] == pytest.approx(np.zeros(5), abs=1e-6)  # the five along y
    assert piece.M[0, 0] == pytest.approx(5.0, rel=1e-12)  # rounding
    assert abs(piece.K[0, 0]) < 1e-9  # rounding of 1e3


def test_dashpots_come_along() -> None:
    rng = np.random.default_rng(5)
    root = rng.normal(size=(8, 8))
    M, K = np.diag(rng.uniform(1.0, 2.0, 8)), root @ root.T * 1e3 + np.eye(8)
    C = np.zeros((8, 8))
    C[2, 2], C[6, 6], C[2, 6], C[6, 2] = 9.0, 4.0, -3.0, -3.0
    piece = fs.craig_bampton(M, K, [0, 5], count=6, C=C)

    def poles(*matrices: NDArray[np.float64]) -> NDArray[np.complex128]:
        mass, stiffness, damping = matrices
        n = len(mass)
        first = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]])
        second = np.block([[np.eye(n), np.zeros((n, n))], [np.zeros((n, n)), mass]])
        found = eig(first, second, right=False)
        return found[np.argsort(found.imag)]

    assert poles(piece.M, piece.K, piece.C) == pytest.approx(poles(M, K, C), rel=1e-8)  # of a matrix of 16, unsymmetric


@pytest.mark.parametrize(
    ("boundary", "size", "told"),
    [([], 4, "boundary: got none"), ([4], 4, "got 4 to 4, expected numbers from 0 to 3"), ([0], 5, "K: got (5, 5)")],
)
def test_what_does_not_fit_is_refused(boundary: list[int], size: int, told: str) -> None:
    with pytest.raises(FemstructError) as caught:
        fs.craig_bampton(np.eye(4), np.eye(size), boundary, count=1)
    assert told in str(caught.value)
