"""A component: matrices from a file, and how nodes move with their degrees of freedom."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import lsqr

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import FemstructError
from femstruct.model.part import LossShare
from femstruct.tags import stored_as

_EXACT = 1e-14  # residual of the least-squares solver: rounding
_FITS = 1e-9  # of what is wanted: degrees of freedom that miss it by more do not have the motion


@stored_as("component of a substructure/1")
@dataclass(frozen=True, eq=False)
class Component:
    """Matrices of a structure on its own degrees of freedom, as another program or a reduction gives them.

    source : the file. M, C, K [r, r] : mass, dashpots, stiffness. motion [n_nodes * 7, r] : nodal components from the
    degrees of freedom. points [n_nodes, 3] : where the nodes are [m]. mass : in all [kg]. labels [r] : of the degrees
    of freedom. interface : nodes that can be joined to others; the motion of the rest follows. quads [q, 4],
    lines [l, 2] : nodes of faces and bars, for pictures. axes [3, 3] : of a plate whose nodes have a twist; none for
    others. girth [m], beside [n_nodes, 3] [m] : of bars, as of `Meshed`; 0 and none for others, and in files of before.
    depth [m] : of a plate or shell that stretches, as of `Meshed`; 0 for others, and in files of before.
    loss_factor : of the stiffness [1]. shares : of the stiffness by loss factors, of a part of layers that lose
    differently; they add up to it. reduced_to_hz : highest frequency of the modes that were kept, of a
    reduction; None for a whole structure. sets : nodes of the interface by the name of what touched them when it was
    reduced, as a support.

    momentum [3, r] : of all of it, along x, y, z, when each degree of freedom moves at unit rate and, of matrices that
    were exported with their supports, with the mass that they couple to what is held; None, M times the translations.

    translations [r, 3] : what shifts all of it along x, y, z. free : whether there are such, nothing inside being held.
    unweighed : axes along which its momentum is not known: some of its nodes are held along them, and M, which has mass
    between nodes, does not say how much lies between those and the rest.

    One mass of 2 kg on a spring along z:

    >>> from scipy.sparse import csr_array
    >>> one = csr_array([[2.0]])
    >>> motion = csr_array(([1.0], ([2], [0])), shape=(7, 1))
    >>> Component("a.npz", one, csr_array((1, 1)), one, motion, [[0.0, 0.0, 0.0]], 2.0, ("z",), [0]).free
    False
    """

    source: str
    M: csr_array
    C: csr_array
    K: csr_array
    motion: csr_array
    points: Floats
    mass: float
    labels: tuple[str, ...]
    interface: Integers
    quads: Integers = field(default_factory=lambda: np.zeros((0, 4), np.int64))
    lines: Integers = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    axes: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    girth: float = 0.0
    depth: float = 0.0
    beside: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    loss_factor: float = 0.0
    shares: tuple[LossShare, ...] = ()
    reduced_to_hz: float | None = None
    sets: Mapping[str, Integers] = field(default_factory=dict)
    momentum: Floats | None = None
    translations: Floats = field(init=False)
    free: bool = field(init=False)
    unweighed: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        points = frozen("component points", self.points, (None, 3))
        r = len(self.labels)
        for name in ("M", "C", "K"):
            if getattr(self, name).shape != (r, r):
                raise FemstructError(f"component {name}", got=f"{getattr(self, name).shape}", expected=f"{(r, r)}")
        if self.motion.shape != (len(points) * N_COMPONENTS, r):
            expected = f"({len(points)} nodes x {N_COMPONENTS}, {r})"
            raise FemstructError("component motion", got=f"{self.motion.shape}", expected=expected)
        strange = [name for name, nodes in self.sets.items() if not np.isin(nodes, self.interface).all()]
        if strange:
            raise FemstructError(f"component set '{strange[0]}'", got="other nodes", expected="nodes of the interface")
        translations, shifts = _translations(self.motion, len(points))
        free = bool(shifts.all())
        partly = ~shifts & (np.abs(translations).max(axis=0, initial=0.0) > 0.0)
        known = self.momentum is not None or not partly.any() or _lumped(self.M, self.motion)
        freeze(
            self,
            points=points,
            interface=frozen_integers("component interface", self.interface, (None,)),
            quads=frozen_integers("component quads", self.quads, (None, 4)),
            lines=frozen_integers("component lines", self.lines, (None, 2)),
            axes=frozen("component axes", self.axes, (None, 3)),
            beside=frozen("component beside", self.beside, (None, 3)),
            sets={name: frozen_integers(f"component set '{name}'", one, (None,)) for name, one in self.sets.items()},
            momentum=None if self.momentum is None else frozen("component momentum", self.momentum, (3, r)),
            translations=frozen("component translations", translations, (r, 3)),
            free=free,
            unweighed=() if known else tuple(axis for axis, one in zip("xyz", partly, strict=True) if one),
        )

    @property
    def beside_mass(self) -> Floats:
        """What unit accelerations of all of it push its degrees of freedom with beside M [r, 3] [kg]: the mass that
        they couple to what is held."""
        if self.momentum is None or self.free:
            return np.zeros_like(self.translations)
        return np.asarray(self.momentum.T - self.M @ self.translations)

    @property
    def reduced(self) -> bool:
        """Whether it is a reduction."""
        return self.reduced_to_hz is not None


def _lumped(M: csr_array, motion: csr_array) -> bool:
    """Whether no mass lies between two nodes."""
    moves = motion.tocsc()
    node = np.full(M.shape[0], -1)
    for dof in range(M.shape[0]):
        rows = moves.indices[moves.indptr[dof] : moves.indptr[dof + 1]] // N_COMPONENTS
        node[dof] = rows[0] if len(rows) and (rows == rows[0]).all() else -1 - dof
    entries = M.tocoo()
    row, column = entries.coords
    return bool((node[row] == node[column])[entries.data != 0.0].all())


def rigid_masses(component: Component) -> Floats:
    """Its mass as M has it along x, y and z [3] [kg]: r^T M r of unit shifts of all nodes."""
    shifts = component.translations
    return np.asarray((shifts * (component.M @ shifts)).sum(axis=0))


def rigid_resistance(component: Component) -> Floats:
    """What K resists shifts of all nodes along x, y, z and rotations of them about those axes with [6], by the energy
    that the diagonal of K alone would have: 0 of a free part, about 1 where nodes stand in wrong places. NaN for a
    motion that its degrees of freedom do not have.

    Rotations are about the middle of the nodes; where nodes have none, only their shifts take part.

    Two masses along x, a spring across between them: shifts are free, a rotation about y stretches it, being no
    element that could stand there.

    >>> motion = csr_array(([1.0] * 6, ([0, 1, 2, 7, 8, 9], range(6))), shape=(14, 6))
    >>> K = np.zeros((6, 6)); K[np.ix_([2, 5], [2, 5])] = [[3.0, -3.0], [-3.0, 3.0]]
    >>> M, K, nothing = csr_array(np.eye(6)), csr_array(K), csr_array((6, 6))
    >>> ends = Component("a.npz", M, nothing, K, motion, np.eye(2, 3), 2.0, tuple("abcdef"), [0, 1])
    >>> [round(float(one), 9) for one in rigid_resistance(ends)[[0, 2, 4]]]
    [0.0, 0.0, 2.0]
    """
    found = np.full(6, np.nan)
    motions = [*component.translations.T] if component.free else [None] * 3
    for axis in np.eye(3):
        motions.append(_rotation(component, axis) if component.free else None)
    diagonal = np.abs(component.K.diagonal())
    for at, motion in enumerate(motions):
        if motion is not None:
            scale = float(diagonal @ motion**2)
            found[at] = abs(float(motion @ (component.K @ motion))) / scale if scale > 0.0 else 0.0
    return found


def _rotation(component: Component, axis: Floats) -> Floats | None:
    """Degrees of freedom of a unit rotation of all nodes about an axis [3] through their middle; None without any."""
    points = component.points - component.points.mean(axis=0)
    rigid = np.zeros((len(points), N_COMPONENTS))
    rigid[:, :3], rigid[:, 3:6] = np.cross(axis, points), axis
    rows = csr_array(component.motion)
    moves = (np.diff(rows.indptr) > 0).reshape(rigid.shape)
    rigid[:, 3:6] *= moves[:, 3:6]
    size = float(np.linalg.norm(rigid))
    answer, off = _fitted(rows, rigid.reshape(-1, 1))
    return answer[:, 0] if size > 0.0 and off[0] < _FITS * size else None


def _translations(motion: csr_array, n_nodes: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Degrees of freedom of unit shifts of all nodes along x, y, z [r, 3], and whether there are such [3]: nothing
    inside is held."""
    shifts = np.zeros((n_nodes, N_COMPONENTS, 3))
    shifts[:, :3] = np.eye(3)
    found, off = _fitted(motion, shifts.reshape(-1, 3))
    return found, off < _FITS * n_nodes**0.5


def _fitted(motion: csr_array, motions: Floats) -> tuple[Floats, Floats]:
    """Degrees of freedom [r, k] that move nodes as wanted [n_nodes * 7, k], and what each of them misses [k].

    By least squares; columns are scaled, since modal coordinates have other units than displacements.
    """
    size = np.sqrt(np.asarray(motion.multiply(motion).sum(axis=0)).ravel())
    scale = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0.0)
    scaled = csr_array(motion.multiply(scale[None, :]))
    found, off = [], []
    for one in motions.T:
        answer, _, _, residual, *_ = lsqr(scaled, one, atol=_EXACT, btol=_EXACT, iter_lim=10 * motion.shape[1] + 100)
        off.append(float(residual))
        found.append(scale * answer)
    return np.stack(found, axis=1), np.array(off)
