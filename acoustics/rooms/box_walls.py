"""The six walls of a rectangular room: each is the ceiling of the same room turned."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import inf
from typing import Final, TypeVar

import numpy as np

from acoustics.arrays import Complexes, Floats, Integers
from acoustics.errors import AcousticsError, Advice
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import (
    Box,
    band_orders,
    cosines,
    horizontal_wavenumber,
    order_grid,
    orders_not_in,
    overlaps,
    refuse_outside,
    resolved_orders,
    room_modes,
    vertical_wavenumber,
    wavenumber_squared,
)
from acoustics.rooms.box_coupling import (
    FINEST,
    MOST,
    NO_END,
    CoupledAir,
    added_mass,
    coupled_air,
    join_air,
    kept_modes,
    multiplicity,
)
from acoustics.rooms.box_harmonic import PressureMap, harmonic_pressure, pressure_map
from acoustics.rooms.box_pressure import RoomTransfer, pressures_and_transfer
from acoustics.rooms.room_advice import truncation
from acoustics.source import (
    SurfaceShapes,
    SurfaceVelocity,
    SurfaceVibration,
    refuse_unlike,
    side_by_side,
    with_own_coordinates,
)

CEILING: Final = "ceiling"
AXIS: Final = {"x": 0, "y": 1, "floor": 2, "ceiling": 2}
WALLS: Final = (CEILING, "floor", "x0", "x1", "y0", "y1")
ON: Final = 1e-6  # of the room's size, by which points may miss their wall
_TURNED: Final = ((1, 2, 0), (0, 2, 1), (0, 1, 2))  # which axis is which of the turned room, by the wall's normal
Shapes = TypeVar("Shapes", bound=SurfaceShapes)


@dataclass(frozen=True)
class Turn:
    """A room turned so that one of its walls is the ceiling.

    wall : its name. The pressure of a surface on it is that of the ceiling of the turned room.

    >>> Turn("x0").points(Box([4.0, 3.0, 2.5]), np.array([[1.0, 0.5, 0.2]])).tolist()
    [[0.5, 0.2, 3.0]]
    """

    wall: str

    @property
    def axis(self) -> int:
        """Along which axis its normal lies."""
        return AXIS[self.wall] if self.wall in AXIS else AXIS[self.wall[0]]

    @property
    def at_end(self) -> bool:
        """Whether it is the wall at the far end of that axis."""
        return self.wall == CEILING or self.wall.endswith("1")

    @property
    def axes(self) -> tuple[int, int, int]:
        """Which axis of the room every axis of the turned one is; the last is the wall's normal."""
        return _TURNED[self.axis]

    @property
    def inward(self) -> Floats:
        """Unit normal into the room [3]."""
        normal = np.zeros(3)
        normal[self.axis] = -1.0 if self.at_end else 1.0
        return normal

    def box(self, room: Box) -> Box:
        """The turned room."""
        return room if self.wall == CEILING else Box(room.size[list(self.axes)], room.air, room.losses)

    def points(self, room: Box, points: Floats) -> Floats:
        """Places of the room [p, 3] in the turned one."""
        if self.wall == CEILING:
            return points
        there = points[:, list(self.axes)]
        if not self.at_end:
            there[:, 2] = room.size[self.axis] - there[:, 2]
        return there

    def surface(self, room: Box, surface: Shapes) -> Shapes:
        """A surface on the wall as one on the ceiling of the turned room."""
        return surface if self.wall == CEILING else replace(surface, points=self.points(room, surface.points))

    def receivers(self, room: Box, receivers: list[Receiver]) -> list[Receiver]:
        """Who listens, in the turned room."""
        if self.wall == CEILING:
            return receivers
        return [Receiver(one.name, self.points(room, one.position[None, :])[0]) for one in receivers]

    def distance(self, room: Box, points: Floats) -> Floats:
        """How far points [p, 3] are from the plane of the wall [p] [m]."""
        end = room.size[self.axis] if self.at_end else 0.0
        return np.asarray(np.abs(points[:, self.axis] - end))


def by_wall(room: Box, surface: Shapes) -> dict[Turn, Shapes]:
    """The parts of a surface by the wall on which their points lie; one part is the surface itself.

    Raises AcousticsError: points off all walls.
    """
    turns = [Turn(wall) for wall in WALLS]
    apart = np.stack([turn.distance(room, surface.points) for turn in turns])
    nearest = apart.argmin(axis=0)
    off = apart.min(axis=0)
    if off.max() > ON * room.size.max():
        raise AcousticsError(
            "surface.points",
            got=f"a point {off.max():.3g} m off the walls, at {surface.points[off.argmax()].tolist()} m",
            expected=f"the ceiling of the room, z = {room.size[2]:g} m, or another of its walls",
            do="measure from the room's lower corner, z up",
        )
    found = {}
    for number, turn in enumerate(turns):
        rows = nearest == number
        if rows.all():
            return {turn: surface}
        if rows.any():
            points, weights, shapes = (getattr(surface, word)[rows] for word in ("points", "weights", "shapes"))
            found[turn] = replace(surface, points=points, weights=weights, shapes=shapes)
    return found


def mode_overlaps(room: Box, indices: Integers, turn: Turn, surface: SurfaceShapes) -> Floats:
    """Integrals [n, k] over a surface on a wall of the modes with `indices` [n, 3] times its shapes.

    The modes are cosines of unit amplitude, positive where the corner x = y = 0 meets the ceiling.
    """
    along = list(turn.axes[:2])
    flat, place = np.unique(indices[:, along], axis=0, return_inverse=True)
    there = turn.surface(room, surface)
    found = overlaps(turn.box(room), flat, there.points, there.weights[:, None] * there.shapes)[place.ravel()]
    return np.asarray(signs_at(indices, turn)[:, None] * found)


def signs_at(indices: Integers, turn: Turn) -> Floats:
    """What the modes [n] are at the wall, beside their cosines along it."""
    upside = 1.0 - 2.0 * (indices[:, 2] % 2)  # positive at the ceiling
    return np.asarray(upside * (1.0 - 2.0 * (indices[:, turn.axis] % 2)) if turn.at_end else upside)


# ----------------------------------------------------------------------------------------------------------------------
# What a point source in a rectangular room does to surfaces on its walls that are held still.
# ----------------------------------------------------------------------------------------------------------------------

BLOCK: Final = 4  # orders more in the next block
ENOUGH: Final = 1e-10  # share of the last block in the loads at which no more are added: they fall exponentially
_AT_ONCE: Final = 1 << 20  # complex numbers


def wall_loads(
    room: Box, surface: SurfaceShapes, place: Floats, frequency_hz: Floats
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Integrals [k, nf] over surfaces that are held, of the pressure that a point source makes per volume velocity,
    times their shapes; and advice on it.

    Parameters
    ----------
    surface : SurfaceShapes
        On any walls.
    place : Floats [3]
        Of the source, in the room [m].
    frequency_hz : Floats [nf]
        Above 0 [Hz].

    Raises
    ------
    AcousticsError
        A source outside the room, points on no wall, a room without losses at a resonance.

    Notes
    -----
    The source is a flow that enters the air, as that of a wall does: its pressure solves the room's wave equation with
    rho d(s) on its place. Cosine (l, m) along a wall has of it the share eps cos cos / S there, which sends the wave
    rho d(s) exp(-j mu z) / (2 j mu) to both sides; mirrored at the wall and at the one opposite,

        p = rho d(s) / (j mu) (E(h) + E(2 L - h)) / (1 - E(2 L)),      E(x) = exp(-j mu x),

    on the wall, h from the source; d(s), mu and E are those of `acoustics.rooms.box`. Cosines are added until
    the last ones make less than 1e-10, or the points resolve no more.

    Examples
    --------
    Far below its first mode a room is compressed as a whole, by rho c^2 / (s V):

    >>> box = Box([0.58, 0.47, 0.1])
    >>> piston = SurfaceShapes([[0.29, 0.235, 0.1]], [box.ceiling_area], [[1]])
    >>> loads, _ = wall_loads(box, piston, np.array([0.1, 0.2, 0.02]), np.array([1.0]))
    >>> print(f"{loads[0, 0].imag:.1f} {-box.air.bulk_modulus * box.ceiling_area / box.volume / (2 * np.pi):.1f}")
    -226565.6 -226565.5
    """
    refuse_outside(room, "source", place[None, :])
    found = np.zeros((surface.shapes.shape[1], len(frequency_hz)), dtype=np.complex128)
    advice: tuple[Advice, ...] = ()
    for turn, part in by_wall(room, surface).items():
        there, source = turn.surface(room, part), turn.points(room, place[None, :])
        loads, more = _ceiling_loads(turn.box(room), there, source, frequency_hz)
        found += loads
        advice = advice or more
    return found, advice


def _ceiling_loads(
    room: Box, surface: SurfaceShapes, source: Floats, frequency_hz: Floats
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Of surfaces on the ceiling; source [1, 3]."""
    weighted = surface.weights[:, None] * surface.shapes
    found = np.zeros((weighted.shape[1], len(frequency_hz)), dtype=np.complex128)
    most = resolved_orders(room, surface.points) + 1
    least = max(band_orders(room, float(frequency_hz.max())))
    done, share = np.zeros((0, 2), dtype=np.int64), 0.0
    for size in range(BLOCK, int(most.max()) + BLOCK, BLOCK):
        new = orders_not_in(order_grid(*np.minimum(size, most).tolist()), done)
        part = _of_orders(room, new, surface.points, weighted, source, frequency_hz)
        found += part
        done = np.concatenate([done, new])
        share = float(np.linalg.norm(part) / (np.linalg.norm(found) or 1.0))
        if share < ENOUGH and size >= least:
            break
    return found, truncation(share, done)


def _of_orders(
    room: Box, orders: Integers, points: Floats, weighted: Floats, source: Floats, frequency_hz: Floats
) -> Complexes:
    """Loads [k, nf] of the cosines `orders` [n, 2]."""
    height, z = float(room.size[2]), float(source[0, 2])
    strength = np.where(orders > 0, 2.0, 1.0).prod(axis=1) / room.ceiling_area * cosines(room, orders, source)[0]
    felt = overlaps(room, orders, points, weighted).T * strength
    k_lm = horizontal_wavenumber(room, orders)
    found = np.empty((len(felt), len(frequency_hz)), dtype=np.complex128)
    step = max(1, _AT_ONCE // len(orders))
    for start in range(0, len(frequency_hz), step):
        lines = slice(start, start + step)
        s = np.asarray(2j * np.pi * frequency_hz[lines])
        j_mu = 1j * vertical_wavenumber(room, s, k_lm)
        with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
            waves = (np.exp(-j_mu * (height - z)) + np.exp(-j_mu * (height + z))) / (1 - np.exp(-2 * j_mu * height))
            found[:, lines] = felt @ (room.air.rho * (s + 2 * room.losses.decay_rate) / j_mu * waves)
    if not np.isfinite(found).all():
        raise AcousticsError("frequency", got="a resonance of a room without losses", expected="losses")
    return found


# ----------------------------------------------------------------------------------------------------------------------
# The air of a rectangular room as a mechanical system joined to surfaces on any of its walls.
# ----------------------------------------------------------------------------------------------------------------------

Parts = Mapping[Turn, SurfaceShapes]


def coupled_walls(room: Box, surface: SurfaceShapes, up_to_hz: float, most: int = MOST) -> CoupledAir:
    """The air of a closed room joined to the shapes of surfaces on any of its walls, which share their coordinates.

    Parameters
    ----------
    up_to_hz, most : float, int
        Cavity modes up to it are kept [Hz], at most so many, and none finer than the points resolve along any wall; the
        others act as added mass.

    Notes
    -----
    As `acoustics.rooms.box_coupling.coupled_air`, with one mass more for every pair of walls. What the modes that are
    left out do between opposite walls is, summed over the orders from one to the other, rho / (k sinh(k L)) of every
    cosine, -rho L / 6 of the uniform one; between walls that meet at an edge it is the sum over all three orders that
    the points of both resolve.
    """
    parts = by_wall(room, surface)
    if [*parts] == [Turn(CEILING)] and most == MOST:
        return coupled_air(room, surface, up_to_hz)
    refuse_outside(room, "surface.points", surface.points)
    frequency_hz, indices, complete = kept_modes(room, up_to_hz, finest_of(room, parts), most)
    displaced = displacements(room, parts, indices)
    added = left_out_mass(room, parts, indices)
    return join_air(room.air, room.losses, room.volume, frequency_hz, displaced, added, complete_below_hz=complete)


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
    orders = order_grid(*counts.tolist())
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
        grid = order_grid(int(counts[edge]), int(counts[free]))
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


# ----------------------------------------------------------------------------------------------------------------------
# Active power that every surface of a rectangular room gives its air: total pressure times its own velocity.
# ----------------------------------------------------------------------------------------------------------------------

BEYOND: Final = 3.0  # of the highest frequency: modes of the room above it answer as at rest
MOST_AT_ONCE: Final = 4000  # modes of the room
_POWERS_AT_ONCE: Final = 1 << 21  # complex numbers


def wall_powers(room: Box, surfaces: Sequence[SurfaceVibration], up_to_hz: float | None = None) -> Floats:
    """Mean power [n_surfaces, nf] [W] that each of several surfaces gives the air of a room.

    Parameters
    ----------
    surfaces : Sequence[SurfaceVibration]
        On any walls, of the same frequencies.
    up_to_hz : float | None
        Modes of the room above it, and beyond 4000 of them, answer as at rest; three times the highest frequency if
        left out.

    Returns
    -------
    Floats
        1/2 Re of the integral over each surface of the pressure that all make together, times the conjugate of its own
        velocity. A surface that the others push takes power out of the air: its power is negative. The powers sum to
        what the room takes up.

    Raises
    ------
    AcousticsError
        Surfaces of other frequencies, points on no wall, a room without losses at a resonance.

    Notes
    -----
    Mode n is driven by L_n v, L_n the integrals of its shape over what moves, and answers rho d(s) L_n v / (V (k_n^2 -
    k^2)), as in `acoustics.rooms.box`; those left out as the added mass of `coupled_walls`, d(s) M.

    Examples
    --------
    A piston that moves the air of a box of 10 cm, a third of whose mass is dragged at the rate 2 gamma:

    >>> from acoustics.air import Air
    >>> from acoustics.losses import losses_from_t60
    >>> box = Box([0.58, 0.47, 0.1], Air(340, 1.29), losses_from_t60(0.5))
    >>> x, y = (along.ravel() for along in np.meshgrid(*2 * [(np.arange(8) + 0.5) / 8]))
    >>> points, weights = np.stack([0.58 * x, 0.47 * y, 0.1 + 0 * x], axis=1), np.full(64, box.ceiling_area / 64)
    >>> piston = SurfaceVibration(points, weights, np.ones((64, 1)), [[1]], [20.0])
    >>> round(float(wall_powers(box, [piston])[0, 0] / box.ceiling_area), 4), round(13.8155 * 1.29 * 0.1 / 3, 4)
    (0.5941, 0.5941)
    """
    hz = surfaces[0].frequency_hz
    shapes, rates, columns = with_own_coordinates(surfaces)
    parts = by_wall(room, side_by_side(shapes))
    reach = BEYOND * float(hz.max()) if up_to_hz is None else up_to_hz
    indices = room_modes(room, reach)[1]
    indices = indices[(indices <= finest_of(room, parts)).all(axis=1)][:MOST_AT_ONCE]  # others the points do not tell
    integrals, mass = displacements(room, parts, indices), left_out_mass(room, parts, indices)
    squared = np.append(0.0, ((indices / room.size) ** 2).sum(axis=1) * np.pi**2)[:, None]
    s = np.asarray(2j * np.pi * hz)
    power = np.zeros((len(surfaces), len(hz)))
    width = max(1, _POWERS_AT_ONCE // max(1, len(integrals)))
    for start in range(0, len(hz), width):
        band = slice(start, start + width)
        driving = s[band] + 2 * room.losses.decay_rate
        with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
            below = squared - wavenumber_squared(room.losses, room.air, s[band])
            answers = room.air.rho * driving / (room.volume * below)
        pushed = answers * (integrals @ rates[:, band])
        rest = driving * (mass @ rates[:, band])
        for number, own in enumerate(columns):
            given = integrals[:, own] @ rates[own, band]
            power[number, band] = 0.5 * (_flow(given, pushed) + _flow(rates[own, band], rest[own]))
    if not np.isfinite(power).all():
        raise AcousticsError("frequency", got="a resonance of a room without losses", expected="losses")
    return power


def _flow(velocity: Complexes, pressure: Complexes) -> Floats:
    """Real part of conj(velocity) pressure, summed over the rows [nf]."""
    return np.asarray((velocity.conj() * pressure).real.sum(axis=0))


# ----------------------------------------------------------------------------------------------------------------------
# Sound of surfaces on several walls of a rectangular room: a sum over them, each the ceiling of a turned room.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class WallTransfers:
    """Kept transfers of the walls of a room, summed; of : motions of the surface that they were found with."""

    room: Box
    receivers: tuple[Receiver, ...]
    walls: tuple[tuple[Turn, RoomTransfer], ...]

    def of(self, surface: SurfaceVelocity, room: object, receivers: Sequence[Receiver], up_to_hz: float) -> bool:
        """Whether a motion is one of these surfaces in this room, in a record of the same length and sampling."""
        mine = self.room
        if not isinstance(room, Box) or (*room.size, room.air, room.losses) != (*mine.size, mine.air, mine.losses):
            return False
        parts = by_wall(room, surface)
        if [*parts] != [turn for turn, _ in self.walls]:
            return False
        return all(
            kept.of(turn.surface(room, parts[turn]), turn.box(room), turn.receivers(room, [*receivers]), up_to_hz)
            for turn, kept in self.walls
        )

    def prepare(self) -> None:
        """Find the ways of all walls now."""
        for _, kept in self.walls:
            kept.prepare()

    @property
    def per_rate(self) -> Complexes:
        """As that of each wall, summed."""
        whole: Complexes = np.sum([kept.per_rate for _, kept in self.walls], axis=0)
        return whole

    def pressures(self, surfaces: Sequence[SurfaceVelocity]) -> list[RoomResponse] | None:
        """Pressures of other motions; None where a wall needs other cosines."""
        split = [by_wall(self.room, surface) for surface in surfaces]
        pressures = []
        for turn, kept in self.walls:
            found = kept.pressures([turn.surface(self.room, parts[turn]) for parts in split])
            if found is None:
                return None
            pressures.append(found)
        return [_sum(self.receivers, each) for each in zip(*pressures, strict=True)]


def wall_pressures(
    surfaces: Sequence[SurfaceVelocity], room: Box, receivers: Sequence[Receiver], up_to_hz: float = inf
) -> tuple[list[RoomResponse], RoomTransfer | WallTransfers | None]:
    """Pressures of each of several motions of surfaces on any walls, and what is kept for further ones.

    Raises AcousticsError as `acoustics.rooms.box_pressure.pressures` does, and for points on no wall.

    Notes
    -----
    The field of every wall is the closed form along its own normal, those of the others being rigid meanwhile; the
    pressure is their sum. The search for cosines ends at every wall as it does at a ceiling alone.
    """
    refuse_unlike(surfaces)
    positions(receivers)
    split = [by_wall(room, surface) for surface in surfaces]
    turns = [*split[0]]
    if turns == [Turn("ceiling")]:
        return pressures_and_transfer(surfaces, room, receivers, up_to_hz)
    pressures, kept = [], []
    for turn in turns:
        moving = [turn.surface(room, parts[turn]) for parts in split]
        found, transfer = pressures_and_transfer(moving, turn.box(room), turn.receivers(room, [*receivers]), up_to_hz)
        pressures.append(found)
        kept.append((turn, transfer))
    whole = [(turn, one) for turn, one in kept if one is not None]
    transfers = WallTransfers(room, tuple(receivers), tuple(whole)) if len(whole) == len(turns) else None
    return [_sum(receivers, each) for each in zip(*pressures, strict=True)], transfers


def wall_harmonic(
    surface: SurfaceVibration, room: Box, receivers: Sequence[Receiver]
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Complex pressure [n_receivers, nf] [Pa] of surfaces on any walls, and advice on it; each wall as
    `acoustics.rooms.box_harmonic.harmonic_pressure` has a ceiling."""
    p = np.zeros((len(positions(receivers)), len(surface.frequency_hz)), dtype=np.complex128)
    advice: list[Advice] = []
    for turn, part in by_wall(room, surface).items():
        own, more = harmonic_pressure(turn.surface(room, part), turn.box(room), turn.receivers(room, [*receivers]))
        p += own
        advice += more
    return p, _once(advice)


def wall_map(
    surface: SurfaceVelocity,
    room: Box,
    frequencies_hz: Sequence[float] | Floats,
    *,
    normal: str,
    at: float,
    divisions: tuple[int, int],
) -> PressureMap:
    """Spectrum of the pressure on a plane of the room, of surfaces on any walls: see
    `acoustics.rooms.box_harmonic.pressure_map`."""
    maps = []
    for turn, part in by_wall(room, surface).items():
        moved = turn.surface(room, part)
        if turn == Turn("ceiling") or normal not in ("x", "y", "z"):
            maps.append(pressure_map(moved, room, frequencies_hz, normal=normal, at=at, divisions=divisions))
            continue
        fixed = turn.axes.index("xyz".index(normal))
        mirrored = not turn.at_end
        others = [turn.axes[axis] for axis in range(3) if axis != fixed]
        swapped = others[0] > others[1]
        there = room.size[turn.axis] - at if mirrored and fixed == 2 else at
        cut = (divisions[1], divisions[0]) if swapped else divisions
        own = pressure_map(moved, turn.box(room), frequencies_hz, normal="xyz"[fixed], at=float(there), divisions=cut)
        spectrum = own.spectrum[:, :, ::-1] if mirrored and fixed != 2 else own.spectrum
        first, second, spectrum = (
            (own.second, own.first, spectrum.swapaxes(1, 2)) if swapped else (own.first, own.second, spectrum)
        )
        maps.append(PressureMap(normal, at, first, second, own.frequency_hz, spectrum))
    first_map = maps[0]
    if len(maps) == 1:
        return first_map
    whole: Complexes = np.sum([one.spectrum for one in maps], axis=0)
    return PressureMap(normal, at, first_map.first, first_map.second, first_map.frequency_hz, whole)


def _sum(receivers: Sequence[Receiver], parts: Sequence[RoomResponse]) -> RoomResponse:
    if len(parts) == 1:
        return RoomResponse(tuple(receivers), parts[0].t, parts[0].p, parts[0].findings)
    p: Floats = np.sum([one.p for one in parts], axis=0)
    p.flags.writeable = False
    return RoomResponse(tuple(receivers), parts[0].t, p, _once([finding for one in parts for finding in one.findings]))


def _once(findings: Sequence[Advice]) -> tuple[Advice, ...]:
    """The first advice of every code: walls have their own."""
    return tuple({one.code: one for one in reversed(findings)}.values())[::-1]
