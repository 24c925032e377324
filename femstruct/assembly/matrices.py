"""Assembly: the matrices of a meshed model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array, vstack
from scipy.sparse.linalg import SuperLU, splu

from femstruct.arrays import Floats, freeze, frozen
from femstruct.assembly.ties import DofLabels, Elimination, RawDofs, eliminate, number_dofs
from femstruct.declared import expect
from femstruct.errors import FemstructError, InputError, SingularSystem, list_some
from femstruct.model.materials import Loss
from femstruct.model.model import Model, part_masses
from femstruct.model.part import Elastic, Tie


@dataclass(frozen=True, eq=False)
class DofMap:
    """Which degrees of freedom exist and how the nodes follow them.

    T [n_nodes * 7, n_free] : nodal components from the free degrees of freedom; ties, joints and supports are in it.
    labels [n_free] : a name for each, for messages, made when asked for: "floor node 12 (0.1, 0.2, 0) RX".

    Two degrees of freedom of one node, UX and UZ, that is held along y and does not turn:

    >>> from scipy.sparse import csr_array
    >>> places = csr_array(([1.0, 1.0], ([0, 2], [0, 1])), shape=(7, 2))
    >>> DofMap(places, ("UX", "UZ")).T.shape
    (7, 2)
    """

    T: csr_array
    labels: Sequence[str]

    def __post_init__(self) -> None:
        if self.T.shape[1] != len(self.labels):
            raise FemstructError("DofMap labels", got=f"{len(self.labels)}", expected=f"{self.T.shape[1]}")


@dataclass(frozen=True, eq=False)
class ForceRows:
    """A force of the structure as rows on the free degrees of freedom: S u + B u' + A u'', and of loads: + D f.

    Each is [3, n_free], direct [3, n_nodes * 7], the global x, y, z components [N]. The sign is that of the force on
    what carries the part away from it: on the ground for springs to ground, foundations and supports (so a weight
    pressing down is negative along z), on the second end for a spring between two places, on the second part for a
    joint or a foundation between two.

    carried [3, 3] : the force [N] per acceleration of the base along x, y, z [m/s^2] (columns) when all that stands on
    the ground moves with it and nothing moves on it: what is held carries the mass of its own nodes along.

    direct acts on the loads f at the nodal components: what of them acts on held or joined nodes themselves passes on
    without moving anything. So does a load in the plane of a plate held in its plane, or a part of one in a cell next
    to a support, whose shape functions give it to the held nodes.
    """

    stiffness: csr_array
    damping: csr_array
    inertia: csr_array
    direct: csr_array
    carried: Floats = field(default_factory=lambda: np.zeros((3, 3)))

    def __post_init__(self) -> None:
        freeze(self, carried=frozen("ForceRows carried", self.carried, (3, 3)))


@dataclass(frozen=True, eq=False)
class Assembly:
    """Matrices on the free degrees of freedom, and all that is read off them.

    M, K, C [n_free, n_free] : sparse, symmetric; C holds the permanent dashpots only.
    dofs : the map to the nodes. points [n_nodes, 3] : node coordinates [m].
    part_stiffness : K of every part that deforms, [n_free, n_free]; they add up to K.
    loss_factors : eta of every part in part_stiffness [1].
    forces : of every spring, foundation, support and joint by name, and "ground": the sum of what reaches the ground.
    momentum [3, n_free] : r^T M of the rigid translations along x, y, z. total_mass [kg].
    grounded : names of the forces that add up to "ground". growing : parts whose stiffness grows with the square root
    of frequency, as walls at edges, and the frequency [Hz] at which K and part_stiffness have it.

    Its matrices are scipy's, for any other program; `given_matrices` makes one of those of another program:

    >>> from femstruct import Block, PlaceOn, Spring, Structure, assemble, mesh_structure
    >>> block = Block("block", 500.0, origin=(0.0, 0.0, 0.0), size=(1.0, 0.5, 0.2))
    >>> feet = PlaceOn("feet", "block", at=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.5, 0.0), (1.0, 0.5, 0.0)))
    >>> springs = Spring("springs", "feet", None, stiffness=(0.0, 0.0, 1e6, 0.0, 0.0, 0.0))
    >>> assembly = assemble(mesh_structure(Structure("a block on springs", (block, springs), points=(feet,))))
    >>> float(assembly.K[2, 2]), float(assembly.M[2, 2]), assembly.dofs.labels[2]
    (4000000.0, 500.0, 'block node 0 (0.5, 0.25, 0.1) UZ')
    """

    M: csc_array
    K: csc_array
    C: csc_array
    dofs: DofMap
    points: Floats
    part_stiffness: Mapping[str, csc_array]
    loss_factors: Mapping[str, Loss]
    forces: Mapping[str, ForceRows]
    momentum: Floats
    total_mass: float
    grounded: tuple[str, ...] = ()
    growing: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n = self.dofs.T.shape[1]
        freeze(
            self,
            points=frozen("Assembly points", self.points, (None, 3)),
            momentum=frozen("Assembly momentum", self.momentum, (3, n)),
        )
        for name in ("M", "K", "C"):
            if getattr(self, name).shape != (n, n):
                raise FemstructError(f"Assembly.{name}", got=f"{getattr(self, name).shape}", expected=f"{(n, n)}")


# ----------------------------------------------------------------------------------------------------------------------
# Forces of springs, foundations, supports, joints and on the ground, as rows on the free degrees of freedom.
# ----------------------------------------------------------------------------------------------------------------------

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

    equations [m, n_raw] with the stretch of each tie in `owners`.

    Parameters
    ----------
    matrices : tuple[csr_array, csr_array, csr_array]
        Stiffness, damping and mass on the raw degrees of freedom [n_raw, n_raw].
    pushed : Floats [n_raw, 3]
        What unit accelerations of everything push them with [kg].

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


# ----------------------------------------------------------------------------------------------------------------------
# Model -> Assembly.
# ----------------------------------------------------------------------------------------------------------------------

_CANCELLED = 16 * float(np.finfo(float).eps)  # of the terms of a sum: sums of many terms keep two or three eps of them


def assemble(model: Model) -> Assembly:
    """Mass, stiffness and damping matrices of a model on its free degrees of freedom.

    Joints and supports are eliminated, not penalised. Raises SingularSystem for a degree of freedom with neither
    stiffness nor mass, naming part, node and component; InputError where supports hold all of them.

    Notes
    -----
    The matrices are exactly symmetric. A rigid motion of a free structure strains nothing to rounding, and the
    mass it moves is the sum of the parts.

    >>> from femstruct.model.materials import Material
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
    terms = _terms_of_parts(model, dofs)
    for elastic in model.elastics:
        _add_springs(terms, elastic, csr_array(elastic.rows @ dofs.output))
    masses = [*terms.masses, *(_congruent(csr_array(one.rows @ dofs.output), one.mass) for one in model.inerts)]
    total, damping, mass = (
        _sum_of_matrices(some, dofs.count) for some in (list(terms.stiffness.values()), terms.dashpots, masses)
    )
    pushed = np.asarray(mass @ dofs.translations)
    for name, (first, own) in dofs.parts.items():
        if (beside := model.parts[name].beside_mass) is not None:
            pushed[first : first + own.count] += beside
    equations, owners = _equations(model, dofs)
    solved = eliminate(equations)
    if not len(solved.free):
        raise InputError(
            "supports",
            got=f"every motion of {list_some(model.mesh.nodes)} held ({model.mesh.n_nodes} nodes)",
            expected="something that can move",
            do="hold less, or use a finer mesh",
        )
    labels = DofLabels(model, dofs, solved.free)
    part_stiffness = {
        name: _without_rounding(_on_free(matrix, solved), matrix, solved) for name, matrix in terms.stiffness.items()
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
        loss_factors=terms.loss_factors,
        forces=force_rows(model, dofs, solved, equations, owners, (total, damping, mass), pushed),
        momentum=np.asarray(pushed.T @ solved.E),
        total_mass=sum(part_masses(model).values()),
        grounded=grounded(model),
        growing={one.name: one.grows_from for one in model.elastics if one.grows_from is not None},
    )


class _Terms(NamedTuple):
    """Matrices on raw degrees of freedom, before anything is eliminated; stiffnesses and their loss factors by name."""

    stiffness: dict[str, csr_array]
    loss_factors: dict[str, Loss]
    masses: list[csr_array]
    dashpots: list[csr_array]


def _terms_of_parts(model: Model, dofs: RawDofs) -> _Terms:
    """What the cells of all parts give."""
    terms = _Terms({}, {}, [], [])
    for name, part in model.parts.items():
        own_stiffness, own_mass = part.stiffness_and_mass()
        terms.masses.append(dofs.placed(name, own_mass))
        shares = part.shares()
        for share in shares:  # of layers that lose differently: each by its own share of the energy
            terms.stiffness[f"{name} ({share.name})"] = dofs.placed(name, share.stiffness)
            terms.loss_factors[f"{name} ({share.name})"] = share.loss_factor
        if own_stiffness is not None and not shares:
            terms.stiffness[name] = dofs.placed(name, own_stiffness)
            terms.loss_factors[name] = part.loss_factor
        if (own_dashpots := part.dashpots()) is not None:
            terms.dashpots.append(dofs.placed(name, own_dashpots))
    return terms


def _add_springs(terms: _Terms, elastic: Elastic, rows: csr_array) -> None:
    """Add springs and dashpots along rows of raw degrees of freedom, under the name of the part that has them, if any.

    Raises FemstructError for springs that lose another share than the cells of that part.
    """
    name, added = elastic.name, _congruent(rows, elastic.stiffness)
    if name in terms.stiffness:
        if elastic.loss_factor != terms.loss_factors[name]:
            both = (terms.loss_factors[name], elastic.loss_factor)
            told = " and ".join(f"{one:g}" if isinstance(one, float) else f"{one}" for one in both)
            raise FemstructError(
                f"parts.{name}", got=f"loss factors of {told}", expected="one for all that has its name"
            )
        added = csr_array(terms.stiffness[name] + added)
    terms.stiffness[name] = added
    terms.dashpots.append(_congruent(rows, elastic.damping))
    terms.loss_factors[name] = elastic.loss_factor


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
    return parts[0] if len(parts) == 1 else _symmetric(_sum_of_matrices([csr_array(part) for part in parts], count))


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


def _sum_of_matrices(matrices: list[csr_array], count: int) -> csr_array:
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
