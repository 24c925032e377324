"""Forces of springs, foundations, supports, joints and on the ground, as rows on the free degrees of freedom."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array
from scipy.sparse.linalg import SuperLU, splu

from femstruct.arrays import Floats
from femstruct.assembly.dofs import RawDofs
from femstruct.assembly.matrices import ForceRows
from femstruct.assembly.ties import Elimination
from femstruct.model.fastened import Elastic, Tie
from femstruct.model.model import Model

GROUND = "ground"


def force_rows(
    model: Model,
    dofs: RawDofs,
    solved: Elimination,
    equations: csr_array,
    owners: Mapping[str, slice],
    matrices: tuple[csr_array, csr_array, csr_array],
    pushed: Floats,
) -> dict[str, ForceRows]:
    """Force rows of every spring, foundation, support and joint by name, and "ground".

    equations [m, n_raw] with the stretch of each tie in `owners`; matrices : stiffness, damping and mass on the raw
    degrees of freedom [n_raw, n_raw]; pushed [n_raw, 3] : what unit accelerations of everything push them with [kg].

    Notes
    -----
    The force of a tie is found by virtual work: the nodes of its side are moved by a unit translation, all other
    equations kept, and the work of the loads less that of K u + C u' + M u'' is the force. The work of loads is the
    direct share: they reach held nodes through the shape functions of a cell next to a support. That of the inertia of
    everything moving along as one with the base is what is carried.
    """
    n_free = solved.E.shape[1]
    forces: dict[str, ForceRows] = {}
    for elastic in model.elastics:
        _add(forces, elastic.name, _elastic_rows(elastic, dofs, solved.E))
    if model.ties:
        # Products with E once for all ties: rows of the pivots are all that virtual work needs.
        onto = [csr_array(matrix[solved.pivots] @ solved.E) for matrix in matrices]
        output = csr_array(dofs.output[:, solved.pivots].T)
        along = pushed[solved.pivots]
        factor = splu(csc_array(equations[solved.kept][:, solved.pivots])) if len(solved.kept) else None
        for tie in model.ties:
            _add(forces, tie.name, _tie_rows(tie, owners[tie.name], solved, factor, onto, output, along))
    nothing = csr_array((3, n_free))
    ground = ForceRows(nothing, nothing, nothing, csr_array((3, dofs.output.shape[0])))
    for name in grounded(model):
        ground = _sum(ground, forces[name])
    forces[GROUND] = ground
    return forces


def grounded(model: Model) -> tuple[str, ...]:
    """Names of the springs, foundations and supports that stand on the ground."""
    elastics = (item.name for item in model.elastics if item.grounded)
    return (*elastics, *(tie.name for tie in model.ties if tie.grounded))


def _elastic_rows(elastic: Elastic, dofs: RawDofs, E: csr_array) -> ForceRows:
    rows = csr_array(elastic.rows @ dofs.output) @ E
    directions = csr_array(elastic.directions.T)
    stiffness = csr_array(directions @ (diags_array(elastic.stiffness) @ rows))
    damping = csr_array(directions @ (diags_array(elastic.damping) @ rows))
    return ForceRows(stiffness, damping, csr_array(stiffness.shape), csr_array((3, elastic.rows.shape[1])))


def _tie_rows(
    tie: Tie,
    owner: slice,
    solved: Elimination,
    factor: SuperLU | None,
    onto: list[csr_array],
    output: csr_array,
    along: Floats,
) -> ForceRows:
    """along [m, 3] : inertial forces of the pivots under unit accelerations of everything along x, y, z."""
    violations = np.zeros((len(solved.kept), 3))
    mine = (solved.kept >= owner.start) & (solved.kept < owner.stop)
    violations[mine] = tie.directions[solved.kept[mine] - owner.start]
    moved: Floats = factor.solve(violations) if factor is not None else violations
    moved[np.abs(moved) < 1e-14] = 0.0
    virtual = csr_array(-moved.T)
    stiffness, damping, inertia = (csr_array(virtual @ matrix) for matrix in onto)
    return ForceRows(stiffness, damping, inertia, csr_array(-virtual @ output), np.asarray(virtual @ along))


def _add(forces: dict[str, ForceRows], name: str, rows: ForceRows) -> None:
    forces[name] = _sum(forces[name], rows) if name in forces else rows


def _sum(one: ForceRows, other: ForceRows) -> ForceRows:
    return ForceRows(
        csr_array(one.stiffness + other.stiffness),
        csr_array(one.damping + other.damping),
        csr_array(one.inertia + other.inertia),
        csr_array(one.direct + other.direct),
        one.carried + other.carried,
    )
