"""The air of a rectangular room as a mechanical system joined to surfaces on any of its walls."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from acoustics.arrays import Floats, Integers
from acoustics.rooms.box import Box, inside
from acoustics.rooms.box_transfer import overlaps
from acoustics.rooms.box_two_way import (
    FINEST,
    MOST,
    NO_END,
    CoupledAir,
    added_mass,
    coupled_air,
    joined,
    kept_modes,
    multiplicity,
)
from acoustics.rooms.by_wall.box_walls import CEILING, Turn, by_wall, mode_overlaps, signs_at
from acoustics.rooms.cosine_orders import resolved_orders, square
from acoustics.source import SurfaceShapes

Parts = Mapping[Turn, SurfaceShapes]


def coupled_walls(room: Box, surface: SurfaceShapes, up_to_hz: float, most: int = MOST) -> CoupledAir:
    """The air of a closed room joined to the shapes of surfaces on any of its walls, which share their coordinates.

    up_to_hz, most : cavity modes up to it are kept [Hz], at most so many, and none finer than the points resolve along
        any wall; the others act as added mass.

    Notes
    -----
    As `acoustics.rooms.box_two_way.coupled_air`, with one mass more for every pair of walls. What the modes that are
    left out do between opposite walls is, summed over the orders from one to the other, rho / (k sinh(k L)) of every
    cosine, -rho L / 6 of the uniform one; between walls that meet at an edge it is the sum over all three orders that
    the points of both resolve.
    """
    parts = by_wall(room, surface)
    if [*parts] == [Turn(CEILING)] and most == MOST:
        return coupled_air(room, surface, up_to_hz)
    inside(room, "surface.points", surface.points)
    frequency_hz, indices, complete = kept_modes(room, up_to_hz, finest_of(room, parts), most)
    displaced = displacements(room, parts, indices)
    added = left_out_mass(room, parts, indices)
    return joined(room.air, room.losses, room.volume, frequency_hz, displaced, added, complete_below_hz=complete)


def displacements(room: Box, parts: Parts, indices: Integers) -> Floats:
    """Integrals [1 + n, k] of the uniform mode and of those with `indices` [n, 3], of unit mean square, times the
    shapes of surfaces."""
    uniform = np.sum([part.weights @ part.shapes for part in parts.values()], axis=0)
    each = np.sum([mode_overlaps(room, indices, turn, part) for turn, part in parts.items()], axis=0)
    return np.vstack([uniform, np.sqrt(multiplicity(indices))[:, None] * each])


def finest_of(room: Box, parts: Parts) -> Integers:
    """Highest order along every axis [3] that the points of all walls resolve."""
    finest = np.full(3, NO_END, dtype=np.int64)
    for turn, part in parts.items():
        along = list(turn.axes[:2])
        finest[along] = np.minimum(finest[along], _resolved(room, turn, part))
    return finest


def left_out_mass(room: Box, parts: Parts, kept: Integers) -> Floats:
    """Mass [k, k] of the air in the cavity modes that are not kept."""
    columns = next(iter(parts.values())).shapes.shape[1]
    mass = np.zeros((columns, columns))
    for turn, part in parts.items():
        there = turn.surface(room, part)
        mass += added_mass(
            turn.box(room),
            there.points,
            there.weights[:, None] * there.shapes,
            kept[:, list(turn.axes)],
            _resolved(room, turn, part),
        )
    for one, other in combinations(parts, 2):
        between = _opposite if one.axis == other.axis else _adjacent
        both = between(room, (one, parts[one]), (other, parts[other]), kept)
        mass += both + both.T
    return mass


def _resolved(room: Box, turn: Turn, part: SurfaceShapes) -> Integers:
    """Highest orders [2] along a wall that the points of a surface resolve."""
    return resolved_orders(turn.box(room), turn.points(room, part.points)).clip(0, FINEST)


def _cosines_on(room: Box, turn: Turn, part: SurfaceShapes, orders: Integers) -> Floats:
    """Integrals [n, k] of the cosines along a wall times the shapes of a surface on it."""
    there = turn.surface(room, part)
    return overlaps(turn.box(room), orders, there.points, there.weights[:, None] * there.shapes)


def _opposite(room: Box, one: tuple[Turn, SurfaceShapes], other: tuple[Turn, SurfaceShapes], kept: Integers) -> Floats:
    """Mass [k, k] between two opposite walls."""
    turn = one[0]
    along = list(turn.axes[:2])
    length = float(room.size[turn.axis])
    counts = np.minimum(_resolved(room, *one), _resolved(room, *other)) + 1
    orders = square(*counts.tolist())
    k = np.pi * np.hypot(*(orders / room.size[along]).T)
    uniform = k == 0
    safe = np.where(uniform, 1.0, k)
    with np.errstate(over="ignore"):  # cosines that do not reach the other wall
        whole = np.where(uniform, -length / 6, 1 / (safe * np.sinh(safe * length)))
    known = kept[(kept[:, along] < counts).all(axis=1)]
    squared = ((known / room.size) ** 2).sum(axis=1) * np.pi**2
    terms = np.where(known[:, turn.axis] > 0, 2.0, 1.0) / length * (1.0 - 2.0 * (known[:, turn.axis] % 2))
    np.subtract.at(whole, known[:, along[0]] * counts[1] + known[:, along[1]], terms / squared)
    area = float(np.prod(room.size[along]))
    factor = room.air.rho / area * multiplicity(orders) * whole
    return np.asarray((factor[:, None] * _cosines_on(room, *one, orders)).T @ _cosines_on(room, *other, orders))


def _adjacent(room: Box, one: tuple[Turn, SurfaceShapes], other: tuple[Turn, SurfaceShapes], kept: Integers) -> Floats:
    """Mass [k, k] between two walls that meet at an edge: sums over the order along the edge, and over both others."""
    edge = ({0, 1, 2} - {one[0].axis, other[0].axis}).pop()
    limits = np.full(3, NO_END, dtype=np.int64)
    shares = []
    for turn, part in (one, other):
        along = list(turn.axes[:2])
        limits[along] = np.minimum(limits[along], _resolved(room, turn, part))
    counts = limits + 1
    for turn, part in (one, other):
        free = ({0, 1, 2} - {turn.axis, edge}).pop()
        grid = square(int(counts[edge]), int(counts[free]))
        orders = grid if turn.axes[0] == edge else grid[:, ::-1]
        found = _cosines_on(room, turn, part, np.ascontiguousarray(orders))
        shares.append(found.reshape(counts[edge], counts[free], -1))
    # the order along the edge, that along the first surface's other side, that along the second one's
    axes = [edge, other[0].axis, one[0].axis]
    indices = np.stack(np.meshgrid(*(np.arange(counts[axis]) for axis in axes), indexing="ij"), axis=-1)
    indices = indices.reshape(-1, 3)[:, np.argsort(axes)]
    squared = ((indices / room.size) ** 2).sum(axis=1) * np.pi**2
    width = int(max(indices.max(), kept.max(initial=0))) + 1
    numbers = np.array([width * width, width, 1])
    left = (squared > 0) & ~np.isin(indices @ numbers, kept @ numbers)
    signs = signs_at(indices, one[0]) * signs_at(indices, other[0])
    weight = np.divide(multiplicity(indices) * signs, squared, out=np.zeros(len(squared)), where=left)
    weight = (room.air.rho / room.volume * weight).reshape(*(int(counts[axis]) for axis in axes))
    return np.asarray(np.einsum("eij,ejk->ik", np.swapaxes(shares[0], 1, 2) @ weight, shares[1]))
