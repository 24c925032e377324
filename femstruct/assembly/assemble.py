"""Model -> Assembly."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, csr_array, vstack

from femstruct.assembly.dofs import DofLabels, RawDofs, number_dofs, rigid_translations
from femstruct.assembly.forces import force_rows
from femstruct.assembly.matrices import Assembly, DofMap
from femstruct.assembly.scatter import elastic_matrices, frame_matrices, inert_matrix, plate_matrices
from femstruct.assembly.ties import Elimination, eliminate
from femstruct.errors import SingularSystem
from femstruct.model.facts import part_masses
from femstruct.model.model import Model


def assemble(model: Model) -> Assembly:
    """Mass, stiffness and damping matrices of a model on its free degrees of freedom.

    Joints and supports are eliminated, not penalised. Raises SingularSystem for a degree of freedom with neither
    stiffness nor mass, naming part, node and component.

    Notes: the matrices are exactly symmetric. A rigid motion of a free structure strains nothing to rounding, and the
    mass it moves is the sum of the parts.
    """
    dofs = number_dofs(model)
    stiffness: dict[str, csr_array] = {}
    loss_factors: dict[str, float] = {}
    mass = csr_array((dofs.count, dofs.count))
    damping = csr_array((dofs.count, dofs.count))
    for name, plate in model.plates.items():
        stiffness[name], inertia = plate_matrices(plate, dofs)
        mass = mass + inertia
        loss_factors[name] = plate.part.material.loss_factor
    for name, frame in model.frames.items():
        stiffness[name], inertia = frame_matrices(frame, dofs, int(model.mesh.nodes[name][0]))
        mass = mass + inertia
        loss_factors[name] = frame.part.material.loss_factor
    for elastic in model.elastics:
        stiffness[elastic.name], dashpots = elastic_matrices(elastic, dofs)
        damping = damping + dashpots
        loss_factors[elastic.name] = elastic.loss_factor
    for inert in model.inerts:
        mass = mass + inert_matrix(inert, dofs)
    total = csr_array((dofs.count, dofs.count))
    for matrix in stiffness.values():
        total = total + matrix
    equations, owners = _equations(model, dofs)
    solved = eliminate(equations)
    labels = DofLabels(model, dofs, solved.free)
    part_stiffness = {name: _on_free(matrix, solved) for name, matrix in stiffness.items()}
    K = part_stiffness[next(iter(stiffness))] if len(stiffness) == 1 else _on_free(total, solved)
    M = _on_free(mass, solved)
    _check_singular(K, M, labels)
    translations = rigid_translations(model, dofs)
    return Assembly(
        M=M,
        K=K,
        C=_on_free(damping, solved),
        dofs=DofMap(csr_array(dofs.output @ solved.E), labels),
        points=model.mesh.points,
        part_stiffness=part_stiffness,
        loss_factors=loss_factors,
        forces=force_rows(model, dofs, solved, equations, owners, (total, damping, mass)),
        momentum=np.asarray((mass @ translations).T @ solved.E),
        total_mass=sum(part_masses(model).values()),
    )


def _equations(model: Model, dofs: RawDofs) -> tuple[csr_array, dict[str, slice]]:
    """All ties as equations on raw degrees of freedom, and the rows of each."""
    owners: dict[str, slice] = {}
    count = 0
    for tie in model.ties:
        owners[tie.name] = slice(count, count + tie.rows.shape[0])
        count += tie.rows.shape[0]
    if not model.ties:
        return csr_array((0, dofs.count)), owners
    return csr_array(csr_array(vstack([tie.rows for tie in model.ties])) @ dofs.output), owners


def _on_free(matrix: csr_array, solved: Elimination) -> csc_array:
    """E^T matrix E, exactly symmetric; plain selection where nothing is coupled."""
    if solved.E.nnz == len(solved.free):
        part = csr_array(matrix)[solved.free][:, solved.free]
    else:
        part = csr_array(solved.E.T @ (matrix @ solved.E))
    # Sums of duplicates round differently above and below the diagonal.
    result = csc_array((part + part.T) * 0.5)
    result.sort_indices()
    return result


def _check_singular(K: csc_array, M: csc_array, labels: DofLabels) -> None:
    empty = np.flatnonzero((K.diagonal() == 0.0) & (M.diagonal() == 0.0))
    if len(empty):
        more = f" and {len(empty) - 1} more" if len(empty) > 1 else ""
        raise SingularSystem(
            f"{labels[int(empty[0])]}{more}",
            got="neither stiffness nor mass",
            expected="one of them",
            do="give the part a density, hold it or join it",
        )
