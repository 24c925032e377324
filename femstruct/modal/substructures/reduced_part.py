"""One part of a model, reduced to the nodes that others touch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array

from femstruct.arrays import Floats, Integers
from femstruct.assembly.given_matrices import mapped_matrices
from femstruct.assembly.matrices import Assembly, DofMap
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import InputError, some_of
from femstruct.modal.outputs import projected
from femstruct.modal.substructures.craig_bampton import Reduced, craig_bampton
from femstruct.model.fastened import Elastic, Inert, Tie
from femstruct.model.materials.loss_by_frequency import LossByFrequency
from femstruct.model.meshed import LossShare, Meshed
from femstruct.model.model import Model


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


def reduced_part(model: Model, name: str, *, up_to: float | None = None, count: int | None = None) -> ReducedPart:
    """A part reduced to the nodes that joints, supports, springs, masses and constraints of a model touch, and to those
    of its points: what is struck there has its local compliance.

    up_to, count : of the modes with the interface held, as of `craig_bampton`. What touches it stays in the model.

    Raises InputError for a part that is not there, is rigid, is touched by nothing, or whose loss factor depends on
    frequency.
    """
    where = f"parts.{name}"
    part = model.parts.get(name)
    if part is None:
        raise InputError("--part", got=f"'{name}'", expected=f"a part with nodes: {some_of(model.parts)}")
    K, M = part.stiffness_and_mass()
    if K is None:
        raise InputError(where, got="a rigid part", expected="one that deforms")
    loss, shares = part.loss_factor, part.shares()
    if isinstance(loss, LossByFrequency):
        raise InputError(where, got="a loss factor by frequency", expected="one number", do="give the material one")
    sets = _touched_by(model, part)
    pointed = [np.zeros(0, np.int64), *(point.nodes for point in model.points.values())]
    wanted = np.concatenate([*(part.first + nodes for nodes in sets.values()), *pointed])
    interface = np.intersect1d(wanted, part.nodes) - part.first
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
        part.quads - part.first,
        part.lines - part.first,
        np.zeros((0, 3)) if axes is None else axes,
        part.girth,
        part.depth,
        part.beside(part.nodes),
        loss,
        _reduced_shares(shares, reduced),
        reduced,
        sets,
        tuple(one.name for one in model.structure.supports if one.name in sets),
    )


def _reduced_shares(shares: Sequence[LossShare], reduced: Reduced) -> tuple[LossShare, ...]:
    """Shares of the reduced stiffness; the last is what the others leave of it, so that they add up to it."""
    found: list[LossShare] = []
    left = np.array(reduced.K)
    for number, one in enumerate(shares, 1):
        own = projected(csc_array(one.stiffness), reduced.recovery) if number < len(shares) else left
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
