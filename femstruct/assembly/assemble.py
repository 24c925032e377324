"""Model -> Assembly."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array, vstack

from femstruct.arrays import Floats
from femstruct.assembly.dofs import DofLabels, RawDofs, number_dofs
from femstruct.assembly.forces import force_rows, grounded
from femstruct.assembly.matrices import Assembly, DofMap
from femstruct.assembly.ties import Elimination, eliminate
from femstruct.declared import expect
from femstruct.errors import FemstructError, InputError, SingularSystem, some_of
from femstruct.model.facts import part_masses
from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.model.model import Model

_CANCELLED = 16 * float(np.finfo(float).eps)  # of the terms of a sum: sums of many terms keep two or three eps of them


def assemble(model: Model) -> Assembly:
    """Mass, stiffness and damping matrices of a model on its free degrees of freedom.

    Joints and supports are eliminated, not penalised. Raises SingularSystem for a degree of freedom with neither
    stiffness nor mass, naming part, node and component; InputError where supports hold all of them.

    Notes
    -----
    The matrices are exactly symmetric. A rigid motion of a free structure strains nothing to rounding, and the
    mass it moves is the sum of the parts.

    >>> from femstruct.model.material import Material
    >>> from femstruct.model.mesher import mesh_structure
    >>> from femstruct.model.structure import Structure
    >>> from femstruct.parts.plate import Plate
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=8000.0)
    >>> plate = Plate("plate", steel, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=(4, 3))
    >>> assembly = assemble(mesh_structure(Structure("a free plate", (plate,))))
    >>> round(assembly.total_mass, 9), assembly.K.shape == assembly.M.shape
    (4.8, True)
    """
    expect("assemble", model, Model, "mesh_structure makes one of a Structure, read_model of a file")
    dofs = number_dofs(model)
    stiffness: dict[str, csr_array] = {}
    loss_factors: dict[str, Loss] = {}
    masses: list[csr_array] = []
    dashpots: list[csr_array] = []
    for name, part in model.parts.items():
        own_stiffness, own_mass = part.stiffness_and_mass()
        masses.append(dofs.placed(name, own_mass))
        shares = part.shares()
        for share in shares:  # of layers that lose differently: each by its own share of the energy
            stiffness[f"{name} ({share.name})"] = dofs.placed(name, share.stiffness)
            loss_factors[f"{name} ({share.name})"] = share.loss_factor
        if own_stiffness is not None and not shares:
            stiffness[name] = dofs.placed(name, own_stiffness)
            loss_factors[name] = part.loss_factor
        if (own_dashpots := part.dashpots()) is not None:
            dashpots.append(dofs.placed(name, own_dashpots))
    for elastic in model.elastics:
        rows = csr_array(elastic.rows @ dofs.output)
        added = _congruent(rows, elastic.stiffness)
        if elastic.name in stiffness:  # of a part that has both cells and springs
            if elastic.loss_factor != loss_factors[elastic.name]:
                both = (loss_factors[elastic.name], elastic.loss_factor)
                told = " and ".join(f"{one:g}" if isinstance(one, float) else f"{one}" for one in both)
                got = f"loss factors of {told}"
                raise FemstructError(f"parts.{elastic.name}", got=got, expected="one for all that has its name")
            added = csr_array(stiffness[elastic.name] + added)
        stiffness[elastic.name] = added
        dashpots.append(_congruent(rows, elastic.damping))
        loss_factors[elastic.name] = elastic.loss_factor
    masses += [_congruent(csr_array(inert.rows @ dofs.output), inert.mass) for inert in model.inerts]
    total, damping, mass = (_sum(terms, dofs.count) for terms in (list(stiffness.values()), dashpots, masses))
    pushed = np.asarray(mass @ dofs.translations)
    for name, (first, own) in dofs.parts.items():
        if (beside := model.parts[name].beside_mass) is not None:
            pushed[first : first + own.count] += beside
    equations, owners = _equations(model, dofs)
    solved = eliminate(equations)
    if not len(solved.free):
        raise InputError(
            "supports",
            got=f"every motion of {some_of(model.mesh.nodes)} held ({model.mesh.n_nodes} nodes)",
            expected="something that can move",
            do="hold less, or use a finer mesh",
        )
    labels = DofLabels(model, dofs, solved.free)
    part_stiffness = {
        name: _without_rounding(_on_free(matrix, solved), matrix, solved) for name, matrix in stiffness.items()
    }
    K = _total(part_stiffness, len(solved.free))
    M = _on_free(mass, solved)
    if np.array_equal(K.indptr, M.indptr) and np.array_equal(K.indices, M.indices):
        M = csc_array((M.data, K.indices, K.indptr), shape=K.shape)  # an eighth of the memory of both
    _check_singular(K, M, labels)
    return Assembly(
        M=M,
        K=K,
        C=_on_free(damping, solved),
        dofs=DofMap(csr_array(dofs.output @ solved.E), labels),
        points=model.mesh.points,
        part_stiffness=part_stiffness,
        loss_factors=loss_factors,
        forces=force_rows(model, dofs, solved, equations, owners, (total, damping, mass), pushed),
        momentum=np.asarray(pushed.T @ solved.E),
        total_mass=sum(part_masses(model).values()),
        grounded=grounded(model),
        growing={one.name: one.grows_from for one in model.elastics if one.grows_from is not None},
    )


def _congruent(rows: csr_array, values: Floats) -> csr_array:
    """rows^T diag(values) rows."""
    return csr_array(rows.T @ (diags_array(values) @ rows))


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
    if solved.E.nnz > len(solved.free):
        return _symmetric(csr_array(solved.E.T @ (matrix @ solved.E)))
    if len(solved.free) == matrix.shape[0]:
        return _symmetric(matrix)
    return _symmetric(csr_array(matrix[solved.free][:, solved.free]))


def _total(part_stiffness: Mapping[str, csc_array], count: int) -> csc_array:
    """Sum of the stiffnesses of the parts [count, count]; the one itself where there is one."""
    parts = list(part_stiffness.values())
    return parts[0] if len(parts) == 1 else _symmetric(_sum([csr_array(part) for part in parts], count))


def _without_rounding(reduced: csc_array, matrix: csr_array, solved: Elimination) -> csc_array:
    """The reduced matrix without the entries that are rounding of the terms that cancel in E^T matrix E.

    A bar in a plate that is rigid in its plane only follows when the plate shifts, so its stiff ends leave nothing
    there; what rounding leaves would be a spring to the ground, of either sign.
    """
    if solved.E.nnz == len(solved.free):
        return reduced
    E = csr_array(abs(solved.E))
    terms = _symmetric(csr_array(E.T @ (abs(matrix) @ E)))
    kept = csc_array(reduced.multiply(abs(reduced) > _CANCELLED * terms))
    kept.eliminate_zeros()
    return kept


def _symmetric(matrix: csr_array) -> csc_array:
    """Mean of a matrix and its transpose: sums of duplicates round differently above and below the diagonal."""
    matrix.sort_indices()
    mirrored = csr_array(matrix.T)
    if np.array_equal(matrix.indptr, mirrored.indptr) and np.array_equal(matrix.indices, mirrored.indices):
        mirrored.data = (matrix.data + mirrored.data) * 0.5
    else:
        mirrored = csr_array((matrix + mirrored) * 0.5)
        mirrored.sort_indices()
    # Rows of a symmetric matrix are its columns.
    return csc_array((mirrored.data, mirrored.indices, mirrored.indptr), shape=matrix.shape)


def _sum(matrices: list[csr_array], count: int) -> csr_array:
    """Sum of matrices [count, count], possibly of none."""
    if not matrices:
        return csr_array((count, count))
    total = matrices[0]
    for matrix in matrices[1:]:
        total = csr_array(total + matrix)
    return total


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
