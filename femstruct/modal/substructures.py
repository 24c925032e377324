"""Parts reduced to their interfaces by the method of Craig and Bampton."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import eigh, qr
from scipy.sparse import csc_array, csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.assembly.given_matrices import mapped_matrices
from femstruct.assembly.matrices import Assembly, DofMap
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import FemstructError, InputError, list_some
from femstruct.modal.eigen import MOST_MODES, UNSTRAINED, factorise, fix_signs, modes, orthonormalise, relative_energy
from femstruct.modal.residuals import complement_solve, project, unit_diagonal
from femstruct.model.materials import LossByFrequency
from femstruct.model.model import Model
from femstruct.model.part import Elastic, Inert, LossShare, Meshed, Tie

# ----------------------------------------------------------------------------------------------------------------------
# Fixed-interface reduction of a substructure: constraint modes and modes with the interface held.
# ----------------------------------------------------------------------------------------------------------------------

NEGLIGIBLE: Final = 1e-4  # of the dynamic stiffness at the highest mode; at half its frequency, a sixteenth of that
_WEIGHTLESS: Final = 1e-12  # of the largest: rounding of sums over the inside
_SAME: Final = 1e-8  # of its length: a correction this close to the others is one of them


@dataclass(frozen=True, eq=False)
class Reduced:
    """A substructure on its interface and some of its modes with the interface held.

    M, K, C [r, r] : on the b degrees of freedom of the interface, as they are, and then on the modal coordinates.
    recovery [n, r] : all degrees of freedom from these. boundary [b] : which of the n the interface is.
    frequency_hz [r - b] : of the modes with the interface held, and after them of the corrections [Hz].
    n_modes : how many are modes.

    Two masses and two springs, joined at the first mass, with the one mode in which it does not move:

    >>> piece = craig_bampton([[2.0, 0.0], [0.0, 1.0]], [[100.0, -100.0], [-100.0, 500.0]], [0], count=1)
    >>> isinstance(piece, Reduced), piece.n_modes, piece.frequency_hz.round(3)
    (True, 1, array([3.559]))
    """

    M: Floats
    K: Floats
    C: Floats
    recovery: Floats
    boundary: Integers
    frequency_hz: Floats
    n_modes: int

    def __post_init__(self) -> None:
        r = self.recovery.shape[1]
        freeze(
            self,
            M=frozen("Reduced M", self.M, (r, r)),
            K=frozen("Reduced K", self.K, (r, r)),
            C=frozen("Reduced C", self.C, (r, r)),
            recovery=frozen("Reduced recovery", self.recovery, (None, r)),
            boundary=frozen_integers("Reduced boundary", self.boundary, (None,)),
            frequency_hz=frozen("Reduced frequency_hz", self.frequency_hz, (r - len(self.boundary),)),
        )


def craig_bampton(
    M: Any,
    K: Any,
    boundary: ArrayLike,
    *,
    up_to: float | None = None,
    count: int | None = None,
    C: Any = None,
    labels: Sequence[str] = (),
) -> Reduced:
    """A substructure reduced to its interface and its modes with the interface held, by Craig and Bampton.

    Deflections under forces on the interface are exact, and so is the mass of rigid motions. With modes up to twice the
    band, frequencies of what it is joined to are too high by less than 1e-4, as a rule.

    Parameters
    ----------
    M, K : Any [n, n]
        Mass and stiffness [kg, N/m].
    boundary : ArrayLike [b]
        Degrees of freedom of the interface, which stay as they are.
    up_to : float | None
        Upper frequency of the modes with the interface held [Hz].
    count : int | None
        How many of them. Give one of the two.
    C : Any [n, n]
        Dashpots [N s/m].
    labels : Sequence[str] [n]
        Names of degrees of freedom, for messages.

    Raises
    ------
    FemstructError
        For matrices of different sizes and for a boundary that is none.

    Notes
    -----
    u_i = Psi u_b + Phi q with K_ii Psi = -K_ib and K_ii Phi = M_ii Phi omega^2. Psi is solved for on the complement of
    Phi with the shifted factor of the eigen solver, so an interior that can still move with the interface held is no
    special case: its motions are modes of frequency zero.

    Source: R. R. Craig, M. C. C. Bampton, Coupling of substructures for dynamic analyses, AIAA Journal 6 (1968)
    1313-1319, doi:10.2514/3.4741.

    Examples
    --------
    Three masses of 1 kg in a row on springs of 1 kN/m, free at both ends; the last is the interface:

    >>> K = 1e3 * np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    >>> whole = craig_bampton(np.eye(3), K, [2], count=2)
    >>> bool(abs(whole.K[0, 0]) < 1e-9), round(float(whole.M[0, 0]), 9)  # it is free: no stiffness, all of the mass
    (True, 3.0)
    """
    mass, stiffness = csc_array(M, dtype=np.float64), csc_array(K, dtype=np.float64)
    n = mass.shape[0]
    dashpots = csc_array((n, n)) if C is None else csc_array(C, dtype=np.float64)
    for name, matrix in (("M", mass), ("K", stiffness), ("C", dashpots)):
        if matrix.shape != (n, n):
            raise FemstructError(f"craig_bampton {name}", got=f"{matrix.shape}", expected=f"{(n, n)}")
    held = np.unique(frozen_integers("craig_bampton boundary", np.asarray(boundary, dtype=np.int64), (None,)))
    if not (held.size and held[0] >= 0 and held[-1] < n):
        got = f"{held[0]} to {held[-1]}" if held.size else "none"
        raise FemstructError("craig_bampton boundary", got=got, expected=f"numbers from 0 to {n - 1}")
    inner = np.setdiff1d(np.arange(n), held)
    names = [labels[i] for i in inner] if len(labels) else []
    psi, shapes, values, n_modes = _inside(mass, stiffness, held, inner, up_to, count, names)
    b, k = len(held), len(values)
    recovery = np.zeros((n, b + k))
    recovery[held, np.arange(b)] = 1.0
    recovery[inner, :b], recovery[inner, b:] = psi, shapes
    K_r = np.zeros((b + k, b + k))  # the blocks between interface and modes vanish: what rounding leaves is left out
    K_r[:b, :b] = _without_rounding(project(stiffness, recovery[:, :b]), stiffness, recovery[:, :b])
    K_r[np.arange(b, b + k), np.arange(b, b + k)] = values
    return Reduced(
        M=project(mass, recovery),
        K=K_r,
        C=project(dashpots, recovery),
        recovery=recovery,
        boundary=held,
        frequency_hz=np.sqrt(values) / (2.0 * np.pi),
        n_modes=n_modes,
    )


def _inside(
    mass: csc_array,
    stiffness: csc_array,
    held: Integers,
    inner: Integers,
    up_to: float | None,
    count: int | None,
    names: Sequence[str],
) -> tuple[Floats, Floats, Floats, int]:
    """Constraint modes [i, b], shapes of modes and corrections [i, k], their omega^2 [k], and how many are modes."""
    if not len(inner):
        return np.zeros((0, len(held))), np.zeros((0, 0)), np.zeros(0), 0
    M, K = csc_array(mass[inner][:, inner]), csc_array(stiffness[inner][:, inner])
    requested = None if count is None else min(count, len(inner), MOST_MODES)
    found = modes(K, M, up_to_hz=up_to, count=requested, labels=names)
    elastic = found.eigenvalues > 0.0
    loads = -stiffness[inner][:, held].toarray()
    factor = factorise(found.pencil, found.sigma)
    psi = complement_solve(M, found.shapes, factor, loads)
    psi += found.shapes[:, elastic] @ ((found.shapes[:, elastic].T @ loads) / found.eigenvalues[elastic][:, None])
    top = (2.0 * np.pi * up_to) ** 2 if up_to is not None else float(found.eigenvalues.max(initial=0.0))
    pushes = M @ psi + mass[inner][:, held].toarray()
    corrections = complement_solve(M, found.shapes, factor, pushes)
    beside = mass[inner][:, held].toarray()
    inertia = psi.T @ (pushes + beside) + mass[held][:, held].toarray()
    resistance = stiffness[held][:, held].toarray() - loads.T @ psi
    values, vectors = np.zeros(0), np.zeros((len(inner), 0))
    kept = np.zeros((len(held), 0))
    if top > 0.0:
        kept = _that_matter(
            _symmetric(corrections.T @ pushes), _symmetric(inertia + resistance / top), NEGLIGIBLE / top
        )
    if kept.shape[1]:
        vectors = orthonormalise(M, _independent(corrections @ kept, K))
        vectors = orthonormalise(M, vectors - found.shapes @ (found.shapes.T @ (M @ vectors)))
        values, turn = eigh(project(K, vectors))
        vectors = fix_signs(vectors @ turn, np.sqrt(np.abs(M.diagonal())))
    every = np.concatenate([found.shapes, vectors], axis=1)
    return psi, every, np.concatenate([found.eigenvalues, values]), len(found.eigenvalues)


def _without_rounding(reduced: Floats, K: csc_array, recovery: Floats) -> Floats:
    """The stiffness [b, b] of the interface without what rounding makes of its rigid motions.

    That is rounding of all the terms inside, which are many more, and stiffer, than those that are left of them: joined
    or free, rigid modes would strain by it.

    Parameters
    ----------
    recovery : Floats [n, b]
        The motions of the whole by it.
    """
    scale = unit_diagonal(csc_array(reduced))
    values, motions = eigh(reduced * scale * scale[:, None])
    rigid = relative_energy(K, recovery @ (scale[:, None] * motions)) < UNSTRAINED
    pushes = motions[:, rigid] / scale[:, None]
    return reduced - _symmetric((pushes * values[rigid]) @ pushes.T)


def _that_matter(missing: Floats, whole: Floats, least: float) -> Floats:
    """Motions of the interface [b, c] of which more than a share is missing; missing, whole [b, b]."""
    scale = 1.0 / np.sqrt(np.diag(whole).clip(_WEIGHTLESS * np.diag(whole).max(initial=0.0)))
    own = _symmetric(whole * scale * scale[:, None]) + _WEIGHTLESS * np.eye(len(whole))
    shares, motions = eigh(_symmetric(missing * scale * scale[:, None]), own)
    found: Floats = scale[:, None] * motions[:, shares > least]
    return found


def _independent(vectors: Floats, K: csc_array) -> Floats:
    """The vectors without those that are combinations of others, all of length one."""
    weights = 1.0 / unit_diagonal(K)
    length = np.linalg.norm(weights[:, None] * vectors, axis=0)
    directions, triangle, _ = qr(weights[:, None] * vectors / length, mode="economic", pivoting=True)
    found: Floats = directions[:, np.abs(np.diag(triangle)) > _SAME] / weights[:, None]
    return found


def _symmetric(matrix: Floats) -> Floats:
    mean: Floats = 0.5 * (matrix + matrix.T)
    return mean


# ----------------------------------------------------------------------------------------------------------------------
# One part of a model, reduced to the nodes that others touch.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class ReducedPart:
    """A part of a model on its interface and modes.

    assembly : its reduced matrices, and the motion of all its nodes. interface : nodes that others touch. quads,
    lines : of its cells. axes [3, 3] : of a plate whose nodes have a twist, none for others. girth [m], beside
    [n_nodes, 3] [m] : of its bars, which joints with plates need. depth [m] : of a plate or shell, which joints with
    bars need. loss_factor : of its stiffness. shares : of its stiffness by the loss factors of its layers, where these
    lose differently. reduced : what the reduction gave. sets : nodes of the interface by the name of the support, joint
    or spring that touches them in the model. supports : which of these names are supports; they stay in the model.
    """

    assembly: Assembly
    interface: Integers
    quads: Integers
    lines: Integers
    axes: Floats
    girth: float
    depth: float
    beside: Floats
    loss_factor: float
    shares: tuple[LossShare, ...]
    reduced: Reduced
    sets: Mapping[str, Integers]
    supports: tuple[str, ...]


def reduce_part(model: Model, name: str, *, up_to: float | None = None, count: int | None = None) -> ReducedPart:
    """A part reduced to the nodes that joints, supports, springs, masses and constraints of a model touch, and to
    those of its points: what is struck there has its local compliance.

    Parameters
    ----------
    up_to, count : float | None, int | None
        Of the modes with the interface held, as of `craig_bampton`. What touches it stays in the model.

    Raises
    ------
    InputError
        For a part that is not there, is rigid, is touched by nothing, or whose loss factor depends on frequency.
    """
    where = f"parts.{name}"
    part = model.parts.get(name)
    if part is None:
        raise InputError("--part", got=f"'{name}'", expected=f"a part with nodes: {list_some(model.parts)}")
    K, M = part.stiffness_and_mass()
    if K is None:
        raise InputError(where, got="a rigid part", expected="one that deforms")
    loss, shares = part.loss_factor, part.shares()
    if isinstance(loss, LossByFrequency):
        raise InputError(where, got="a loss factor by frequency", expected="one number", do="give the material one")
    sets = _touched_by(model, part)
    pointed = [np.zeros(0, np.int64), *(point.nodes for point in model.points.values())]
    needed = np.concatenate([*(part.first + nodes for nodes in sets.values()), *pointed])
    interface = np.intersect1d(needed, part.nodes) - part.first
    if not len(interface):
        raise InputError(where, got="a part that nothing touches", expected="a joint, a support or a point on it")
    own = part.dofs()
    used = own.values != 0.0
    boundary = np.unique(own.columns[used & np.isin(own.rows // N_COMPONENTS, interface)])
    reduced = craig_bampton(M, K, boundary, up_to=up_to, count=count, C=part.dashpots())
    n_rows = len(part.places) * N_COMPONENTS
    nodal = csr_array((own.values[used], (own.rows[used], own.columns[used])), shape=(n_rows, own.count))
    labels = [f"interface {number}" for number in range(len(boundary))]
    labels += [f"mode {number + 1}" for number in range(reduced.n_modes)]
    labels += [f"correction {number + 1}" for number in range(len(reduced.frequency_hz) - reduced.n_modes)]
    momentum = (M @ own.translations).T @ reduced.recovery
    motion = csr_array(nodal @ reduced.recovery)
    assembly = mapped_matrices(
        reduced.M, reduced.K, DofMap(motion, tuple(labels)), part.places, momentum, part.mass, reduced.C
    )
    axes = part.own_axes if len(part.flat) else None
    return ReducedPart(
        assembly,
        interface,
        quads=part.quads - part.first,
        lines=part.lines - part.first,
        axes=np.zeros((0, 3)) if axes is None else axes,
        girth=part.girth,
        depth=part.depth,
        beside=part.beside(part.nodes),
        loss_factor=loss,
        shares=_reduced_shares(shares, reduced),
        reduced=reduced,
        sets=sets,
        supports=tuple(one.name for one in model.structure.supports if one.name in sets),
    )


def _reduced_shares(shares: Sequence[LossShare], reduced: Reduced) -> tuple[LossShare, ...]:
    """Shares of the reduced stiffness; the last is what the others leave of it, so that they add up to it."""
    found: list[LossShare] = []
    left = np.array(reduced.K)
    for number, one in enumerate(shares, 1):
        own = project(csc_array(one.stiffness), reduced.recovery) if number < len(shares) else left
        left = left - own
        found.append(one._replace(stiffness=csr_array(own)))
    return tuple(found)


def _touched_by(model: Model, part: Meshed) -> dict[str, Integers]:
    """Nodes of a part, counted from its first one, by the name of what is fastened to them."""
    found: dict[str, Integers] = {}
    fastened: tuple[Tie | Elastic | Inert, ...] = (*model.ties, *model.elastics, *model.inerts)
    for one in fastened:
        used = csr_array(one.rows)
        nodes = np.intersect1d(used.indices // N_COMPONENTS, part.nodes) - part.first
        if len(nodes):
            found[one.name] = np.union1d(found.get(one.name, nodes), nodes)
    return found
