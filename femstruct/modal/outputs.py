"""What is read off modes while the matrices are at hand: forces, shares of the parts, modal masses, convergence."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import csc_array

from femstruct.arrays import Floats
from femstruct.assembly.matrices import Assembly, ForceRows
from femstruct.conventions import N_COMPONENTS
from femstruct.modal.basis import ForceRow
from femstruct.model.probe import Probe

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


def projected(matrix: csc_array, shapes: Floats) -> Floats:
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
