"""What the modes left out contributes at given probes, and what else is read off while the matrices are at hand."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.linalg import eigh, qr
from scipy.sparse import csc_array

from femstruct.arrays import Floats
from femstruct.assembly.matrices import Assembly, ForceRows
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import NotConverged
from femstruct.modal.basis import ForceRow
from femstruct.modal.eigen import Factor, Modes, factorise, fix_signs, orthonormalise
from femstruct.model.probe import Probe

# ----------------------------------------------------------------------------------------------------------------------
# What is read off modes while the matrices are at hand: forces, shares of the parts, modal masses, convergence.
# ----------------------------------------------------------------------------------------------------------------------

AXES = ("x", "y", "z")


def nodal_shapes(assembly: Assembly, shapes: Floats) -> Floats:
    """Shapes on the free degrees of freedom [n_free, k] as nodal components [n_nodes, 7, k]."""
    nodal: Floats = assembly.dofs.T @ shapes
    return nodal.reshape(len(assembly.points), N_COMPONENTS, shapes.shape[1])


def force_rows(forces: Mapping[str, ForceRows], shapes: Floats) -> dict[str, ForceRow]:
    """Forces of the structure in modal coordinates, "NAME.x", "NAME.y", "NAME.z" [N]; shapes [n_free, k]."""
    rows: dict[str, ForceRow] = {}
    for name, force in forces.items():
        stiffness, damping, inertia = force.stiffness @ shapes, force.damping @ shapes, force.inertia @ shapes
        for i, axis in enumerate(AXES):
            weights = force.direct[[i]].toarray()[0]
            carried = force.carried[i]
            loaded = np.flatnonzero(weights)
            direct = Probe(loaded // N_COMPONENTS, loaded % N_COMPONENTS, weights[loaded])
            rows[f"{name}.{axis}"] = ForceRow(stiffness[i], damping[i], inertia[i], direct=direct, carried=carried)
    return rows


def project(matrix: csc_array, shapes: Floats) -> Floats:
    """phi^T A phi [k, k], exactly symmetric."""
    product: Floats = shapes.T @ (matrix @ shapes)
    return 0.5 * (product + product.T)


def unit_diagonal(K: csc_array) -> Floats:
    """Scale [n] that makes the diagonal of K one; what has no stiffness takes that of the softest degree of freedom."""
    diagonal = K.diagonal()
    stiff = diagonal > 0.0
    scale: Floats = 1.0 / np.sqrt(
        np.where(stiff, diagonal, diagonal[stiff].min(initial=np.inf) if stiff.any() else 1.0)
    )
    return scale


def convergence(K: csc_array, M: csc_array, eigenvalues: Floats, shapes: Floats) -> Floats:
    """|K phi - omega^2 M phi| of each shape over |K| |phi|, both scaled by the diagonal of K [k].

    Rounding (1e-16) for modes; for residual pseudo-modes, which are not modes, up to one.
    """
    scale = unit_diagonal(K)[:, None]
    left_over = np.linalg.norm(scale * (K @ shapes - (M @ shapes) * eigenvalues), axis=0)
    terms = np.linalg.norm(scale * (abs(K) @ np.abs(shapes)), axis=0)
    share: Floats = np.divide(left_over, terms, out=np.zeros_like(terms), where=terms > 0)
    return share


# ----------------------------------------------------------------------------------------------------------------------
# Residual vectors: what the modes left out contributes to the response at given probes.
# ----------------------------------------------------------------------------------------------------------------------

_SAME = 1e-10  # of its length: a static residual this close to the others is one of them (two probes at one place)
_NEARLY = 1e-6  # the same for the second order, which is a correction only
_SOLVES = 200


def residual_vectors(K: csc_array, M: csc_array, found: Modes, loads: Floats, orders: int = 2) -> tuple[Floats, Floats]:
    """Pseudo-modes that complete the response to unit forces: (omega^2 [m], shapes [n, m]), mass-normalised.

    They span R0 = K^+ b and R1 = K^+ M R0, the static and the first dynamic correction for the modes left out, K^+
    being the inverse on what is M-orthogonal to the modes found; with `orders` above 2 R2 = K^+ M R1 and so on. With
    them the static response to every b is exact; the error in frequency falls as (omega / omega_next)^(2 orders). K and
    M are diagonal on modes and pseudo-modes together.

    Parameters
    ----------
    loads : Floats [n, p]
        A column of forces for every probe. m <= orders p: dependent vectors are dropped.

    Notes
    -----
    Solved with the shifted factor of the eigen solver, see `complement_solve`. Free structures need no special case.

    Source: R. J. Craig, A. J. Kurdila, Fundamentals of Structural Dynamics (2006), section 11.2 (static part); Krylov
    vectors after E. L. Wilson, M. W. Yuan, J. M. Dickens, Earthquake Eng. Struct. Dyn. 10 (1982) 813-821.
    """
    scale = unit_diagonal(K)
    left = loads - (M @ found.shapes) @ (found.shapes.T @ loads)
    answered = np.linalg.norm(scale[:, None] * left, axis=0) <= _SAME * np.linalg.norm(scale[:, None] * loads, axis=0)
    if answered.all():  # no probe, held probes, or a basis that holds every mode
        return np.zeros(0), np.zeros((len(loads), 0))
    factor = factorise(found.pencil, found.sigma)
    static = complement_solve(M, found.shapes, factor, left[:, ~answered])
    vectors, last = _independent(static, static, 1.0 / scale, _SAME), static
    for _ in range(orders - 1):
        dynamic = complement_solve(M, found.shapes, factor, M @ last)
        new = _without(M, orthonormalise(M, vectors), _without(M, found.shapes, dynamic))
        last = _independent(new, dynamic, 1.0 / scale, _NEARLY)
        if not last.shape[1]:
            break
        vectors = np.concatenate([vectors, last], axis=1)
    for _ in range(2):
        vectors = orthonormalise(M, _without(M, found.shapes, vectors))
    projected = vectors.T @ (K @ vectors)
    values, turn = eigh(0.5 * (projected + projected.T))
    return values, fix_signs(vectors @ turn, np.sqrt(np.abs(M.diagonal())))


def complement_solve(M: csc_array, shapes: Floats, factor: Factor, loads: Floats) -> Floats:
    """K^+ loads: the deflection under the loads less what the modes found take of it, M-orthogonal to them.

    Parameters
    ----------
    shapes : Floats [n, k]
        Of the modes.
    factor : Factor
        Of K - sigma M.

    Notes
    -----
    (I + sigma (K - sigma M)^-1 M) y = (K - sigma M)^-1 b by conjugate gradients in the product of M, without a product
    with K, whose rounding would be that of the stiffest spring. The eigenvalues, omega^2 / (omega^2 - sigma), lie close
    to 1 but for the first of those left out; a last step of the plain iteration measures what is left.
    """
    loads = loads - (M @ shapes) @ (shapes.T @ loads)
    answer = start = _without(M, shapes, factor.solve(loads))
    residual = _without(M, shapes, -factor.sigma * factor.solve(M @ answer))
    along, size, change = residual, _inner(M, residual, residual), np.inf
    for _ in range(_SOLVES):
        turned = along + _without(M, shapes, factor.sigma * factor.solve(M @ along))
        step = size / _inner(M, along, turned).clip(1e-300)
        answer, residual = answer + step * along, residual - step * turned
        before, change = change, float(np.max(step * _length(M, along) / _length(M, answer).clip(1e-300)))
        if change < 1e-14 or (change < 1e-11 and change > 0.5 * before):  # rounding
            break
        was, size = size, _inner(M, residual, residual)
        along = residual + size / was.clip(1e-300) * along
    better = start + _without(M, shapes, -factor.sigma * factor.solve(M @ answer))
    change = float(np.max(_length(M, better - answer) / _length(M, better).clip(1e-300)))
    if change > 1e-11:
        got = f"a change of {change:.1e} after {_SOLVES} solves"
        raise NotConverged("residual vectors", got=got, do="ask for one more mode")
    return better


def _without(M: csc_array, shapes: Floats, vectors: Floats) -> Floats:
    """The vectors made M-orthogonal to M-orthonormal shapes; twice, for the rounding of the first pass."""
    for _ in range(2):
        vectors = vectors - shapes @ (shapes.T @ (M @ vectors))
    return vectors


def _independent(vectors: Floats, of: Floats, weights: Floats, tolerance: float) -> Floats:
    """M-independent directions of the vectors, each measured by its length in `of`; nearly dependent ones dropped."""
    length = np.linalg.norm(weights[:, None] * of, axis=0)
    directions, triangle, _ = qr(weights[:, None] * vectors / length.clip(1e-300), mode="economic", pivoting=True)
    kept = np.abs(np.diag(triangle)) > tolerance
    independent: Floats = directions[:, kept] / weights[:, None]
    return independent


def _inner(M: csc_array, a: Floats, b: Floats) -> Floats:
    """Products of M, column by column."""
    product: Floats = (a * (M @ b)).sum(axis=0)
    return product


def _length(M: csc_array, vectors: Floats) -> Floats:
    size: Floats = np.sqrt((vectors * (M @ vectors)).sum(axis=0).clip(0.0))
    return size
