"""The rectangular room with rigid walls as its formulas know it: size, air, losses, modes, what lies in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import ceil
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, Integers, freeze, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.losses import Losses, modal_damping_ratios
from acoustics.source import SurfaceShapes, SurfaceVelocity


@dataclass(frozen=True, eq=False)
class Box:
    """The size, the air and the losses of a rectangular room with rigid walls and floor; its ceiling, z = Lz, moves.

    size : Lx, Ly, Lz [m]. Coordinates are measured from the lower corner, z up.

    >>> from acoustics.losses import losses_from_beta
    >>> room = Box([0.58, 0.47, 0.1], Air(340, 1.29), losses_from_beta(0.0116, 293))
    >>> round(room.volume, 5), round(room.ceiling_area, 4)
    (0.02726, 0.2726)
    """

    size: Floats
    air: Air = field(default_factory=Air)
    losses: Losses = field(default_factory=Losses)

    def __post_init__(self) -> None:
        size = frozen("room.size", self.size, (3,))
        if (size <= 0).any():
            raise AcousticsError("room.size", got=f"{size.tolist()} m", expected="positive lengths")
        freeze(self, size=size)

    @property
    def volume(self) -> float:
        """Volume Lx Ly Lz [m^3]."""
        return float(np.prod(self.size))

    @property
    def ceiling_area(self) -> float:
        """Area Lx Ly of the ceiling [m^2]."""
        return float(self.size[0] * self.size[1])


def refuse_outside(room: Box, name: str, points: Floats) -> None:
    """Refuse `points` [n, 3] outside the room; raises AcousticsError with the first of them.

    A rounding error of 1e-9 of the room's size is let through.
    """
    slack = 1e-9 * room.size.max()
    outside = ((points < -slack) | (points > room.size + slack)).any(axis=1)
    if outside.any():
        raise AcousticsError(
            name,
            got=f"{points[outside.argmax()].tolist()} m",
            expected=f"a point of the room of {room.size.tolist()} m",
            do="measure from the room's lower corner, z up",
        )


def room_modes(room: Box, up_to_hz: float) -> tuple[Floats, Integers]:
    """Frequencies [n] [Hz] and indices (l, m, n) [n, 3] of the modes up to `up_to_hz`, without the uniform one at 0.

    f = (c / 2) sqrt((l/Lx)^2 + (m/Ly)^2 + (n/Lz)^2), without losses.

    >>> frequency_hz, indices = room_modes(Box([0.58, 0.47, 0.1], Air(340, 1.29)), 500)
    >>> frequency_hz.round(1).tolist(), indices.tolist()
    ([293.1, 361.7, 465.6], [[1, 0, 0], [0, 1, 0], [1, 1, 0]])
    """
    top = positive("up_to_hz", up_to_hz, "Hz")
    counts = [ceil(2 * top * length / room.air.c) + 1 for length in room.size.tolist()]
    indices = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3).astype(np.int64)
    frequency_hz: Floats = room.air.c / 2 * np.sqrt(((indices / room.size) ** 2).sum(axis=1))
    order = np.argsort(frequency_hz, kind="stable")
    order = order[(frequency_hz[order] > 0) & (frequency_hz[order] <= top)]
    return frequency_hz[order], indices[order]


def refuse_off_ceiling(surface: SurfaceShapes, room: Box) -> None:
    """Refuse a surface whose points do not lie on the room's ceiling, or cover more than it has.

    Raises AcousticsError: a point off the plane z = Lz by more than 1e-6 of the room's size, a point outside the
    rectangle, weights that sum to more than the area of the ceiling.
    """
    off = np.abs(surface.points[:, 2] - room.size[2])
    if off.max() > 1e-6 * room.size.max():
        raise AcousticsError(
            "surface.points",
            got=f"z = {surface.points[off.argmax(), 2]:g} m",
            expected=f"the ceiling of the room, z = {room.size[2]:g} m",
            do="measure from the room's lower corner, z up",
        )
    flat = surface.points.copy()
    flat[:, 2] = room.size[2]
    refuse_outside(room, "surface.points", flat)
    if surface.area > room.ceiling_area * (1 + 1e-6):
        raise AcousticsError(
            "surface.weights",
            got=f"a sum of {surface.area:g} m^2",
            expected=f"at most the ceiling, {room.ceiling_area:g} m^2",
            do="give each point its share of the area",
        )


# ----------------------------------------------------------------------------------------------------------------------
# Transfer of the rectangular room: from the velocity of its ceiling to the pressure inside.
#
# With s = j omega + a (a = 0 on the frequency axis), the pressure of the cosine (l, m) of the ceiling velocity is
#
#   P(z) = -rho d(s) V cos(mu z) / (mu sin(mu Lz)),      mu^2 = k^2(s) - k_lm^2,      k_lm^2 = (l pi/Lx)^2 + (m pi/Ly)^2
#
# for a rigid floor and a ceiling velocity positive into the room (so that uniform compression is rho c^2 times the
# displaced volume over V, positive). d(s) = s, but s + 2 gamma with a constant decay rate, where the pressure is
# rho (phi_t + 2 gamma phi).
# ----------------------------------------------------------------------------------------------------------------------

_SAME: Final = 1e-13  # of the room's height: lengths this close are one, which moves a wave of 1/1000 of it by 1e-9
_MOST_PARTS: Final = 4  # of the shortest length that may be the step of all
_MOST_STEPS: Final = 64


def wavenumber_squared(losses: Losses, air: Air, s: Complexes) -> Complexes:
    """k^2 [1/m^2] at the complex frequencies `s` [1/s] under these losses, its imaginary part never positive."""
    squared = -(s**2 + 2 * losses.decay_rate * s) / (air.c**2 * (1 + losses.relaxation_time * s))
    return squared * (1 - 1j * losses.beta) ** 2


def horizontal_wavenumber(room: Box, orders: Integers) -> Floats:
    """k_lm [n] [1/m] of the cosines `orders` [n, 2]."""
    wavenumber: Floats = np.pi * np.hypot(orders[:, 0] / room.size[0], orders[:, 1] / room.size[1])
    return wavenumber


def cosines(room: Box, orders: Integers, points: Floats) -> Floats:
    """cos(l pi x/Lx) cos(m pi y/Ly) [p, n] of the cosines `orders` [n, 2] at `points` [p, 2 or 3]."""
    along_x = np.cos(np.pi / room.size[0] * np.outer(points[:, 0], np.arange(orders[:, 0].max(initial=0) + 1)))
    along_y = np.cos(np.pi / room.size[1] * np.outer(points[:, 1], np.arange(orders[:, 1].max(initial=0) + 1)))
    product: Floats = along_x[:, orders[:, 0]] * along_y[:, orders[:, 1]]
    return product


def project(surface: SurfaceVelocity, room: Box, orders: Integers) -> Floats:
    """Cosine coefficients [n, k] of the surface's shapes: its velocity is the sum of coefficient times cosine.

    Notes
    -----
    The mean of cos^2 is 1 for order 0 and 1/2 for the others, so that the factor is 1 or 2 in each direction; taking
    1/2 for all would add 6 dB for every zero order.
    """
    factor = np.where(orders > 0, 2.0, 1.0).prod(axis=1) / room.ceiling_area
    coefficients: Floats = factor[:, None] * overlaps(
        room, orders, surface.points, surface.weights[:, None] * surface.shapes
    )
    return coefficients


def overlaps(room: Box, orders: Integers, points: Floats, weighted: Floats) -> Floats:
    """Sums over points [p, 2 or 3] of cosines times weighted shapes [p, k]: [n, k] for the cosines `orders` [n, 2].

    Notes
    -----
    Points that are all crossings of a few x with a few y, those of a meshed plate, are summed along y and then along x:
    a hundred times less work than a cosine for every point and pair of orders.
    """
    grid = _crossings(points)
    if grid is None or not len(orders):
        return np.asarray(cosines(room, orders, points).T @ weighted)
    x, y, order = grid
    rows, columns = (np.unique(orders[:, axis], return_inverse=True) for axis in (0, 1))
    along_x = np.cos(np.pi / room.size[0] * np.outer(rows[0], x))
    along_y = np.cos(np.pi / room.size[1] * np.outer(columns[0], y))
    shapes = weighted[order].reshape(len(x), -1)
    if len(rows[0]) > len(columns[0]):  # the fewer cosines first
        shapes = np.ascontiguousarray(weighted[order].reshape(len(x), len(y), -1).swapaxes(0, 1)).reshape(len(y), -1)
        rows, columns, along_x, along_y, x = columns, rows, along_y, along_x, y
    summed = (along_x @ shapes).reshape(len(rows[0]), -1, weighted.shape[1])
    found = np.empty((len(orders), weighted.shape[1]))
    for number in range(len(rows[0])):
        here = np.flatnonzero(rows[1] == number)
        found[here] = along_y[columns[1][here]] @ summed[number]
    return found


def _crossings(points: Floats) -> tuple[Floats, Floats, Integers] | None:
    """The x and y whose crossings the points are, and the order [p] that sorts them by x, then y; None if they are not
    all crossings, each once."""
    x, at_x = np.unique(points[:, 0].round(9), return_inverse=True)
    y, at_y = np.unique(points[:, 1].round(9), return_inverse=True)
    if len(x) * len(y) != len(points):
        return None
    place = at_x * len(y) + at_y
    order = np.argsort(place, kind="stable").astype(np.int64)
    if not np.array_equal(place[order], np.arange(len(points))):
        return None
    sorted_points = points[order].reshape(len(x), len(y), -1)
    return sorted_points[:, 0, 0], sorted_points[0, :, 1], order


def vertical_wavenumber(room: Box, s: Complexes, k_lm: Floats) -> Complexes:
    """mu [n, nf] [1/m], the root with Re mu >= 0 and Im mu <= 0: waves that decay away from the ceiling.

    In real arithmetic, some three times faster than a complex root.
    """
    squared = wavenumber_squared(room.losses, room.air, s)
    real = squared.real - (k_lm**2)[:, None]
    imaginary = squared.imag
    larger = np.sqrt(0.5 * (np.sqrt(real**2 + imaginary**2) + np.abs(real)))
    smaller = np.divide(0.5 * imaginary, larger, out=np.zeros_like(larger), where=larger > 0)
    mu = np.empty(real.shape, dtype=np.complex128)
    mu.real = np.where(real > 0, larger, -smaller)
    mu.imag = np.where(real > 0, smaller, -larger)
    return mu


def transfer(room: Box, s: Complexes, k_lm: Floats, z: Floats) -> list[Complexes]:
    """Pressure over ceiling velocity [Pa s/m] of cosines `k_lm` [n] [1/m] at each height `z`: arrays [n, nf].

    Notes
    -----
    Written with decaying exponentials only, E(x) = exp(-j mu x),

        cos(mu z) / (mu sin(mu Lz)) = j (E(Lz - z) + E(Lz + z)) / (mu (1 - E(2 Lz))),

    since sine and cosine overflow where |Im mu| Lz > 710. Where a room without losses resonates, s on the frequency
    axis, the result is not finite.
    """
    mu = -1j * vertical_wavenumber(room, s, k_lm)  # now exp(mu x) = E(x)
    waves = _propagate_to_levels(mu, float(room.size[2]), z)
    whole = waves[0][0] * waves[0][1]  # E(Lz), the same at all heights
    front = -room.air.rho * (s + 2 * room.losses.decay_rate) / (mu * (1 - whole * whole))
    return [front * (down * (1 + up * up)) for up, down in waves]


def _propagate_to_levels(
    mu: Complexes, height: float, levels: Floats
) -> list[tuple[Complexes | float, Complexes | float]]:
    """E(z) and E(Lz - z) at every level z, products of the exponentials of the gaps between them."""
    ascending, place = np.unique(levels, return_inverse=True)
    gaps = np.diff(ascending, prepend=0.0, append=height)
    across = _exponentials(mu, gaps.tolist(), _SAME * height)
    up, down = [across[0]], [across[-1]]
    for inner, outer in zip(across[1:-1], across[-2:0:-1], strict=True):
        up.append(up[-1] * inner)
        down.append(down[-1] * outer)
    return [(up[i], down[len(ascending) - 1 - i]) for i in place]


def _exponentials(mu: Complexes, lengths: list[float], tolerance: float) -> list[Complexes | float]:
    """exp(mu x) for lengths x: powers of one of them where all are multiples of a length, else one for each.

    Exponentials are the dearest of what a room takes: fifteen products.
    """
    counts, step = _multiples([x for x in lengths if x > tolerance], tolerance)
    known: dict[int, Complexes] = {1: np.exp(mu * step)} if counts else {}
    if counts:
        return [_power(known, round(x / step)) if x > tolerance else 1.0 for x in lengths]
    return [np.exp(mu * x) if x > tolerance else 1.0 for x in lengths]


def _power(known: dict[int, Complexes], n: int) -> Complexes:
    """The n-th power of known[1], kept with those on its way.

    Not a function inside another one: such a function that calls itself is a cycle, which keeps its arrays until cycles
    are collected.
    """
    if n not in known:
        known[n] = _power(known, n // 2) * _power(known, n - n // 2)
    return known[n]


def _multiples(lengths: list[float], tolerance: float) -> tuple[list[int], float]:
    """How often a step is in each length, and the step; no counts where there is none that few multiples are made of.

    >>> _multiples([1.0, 0.2, 0.3], 1e-9)
    ([10, 2, 3], 0.1)
    """
    for parts in range(1, _MOST_PARTS + 1):
        step = min(lengths) / parts
        counts = [round(x / step) for x in lengths]
        close = all(abs(n * step - x) <= tolerance for n, x in zip(counts, lengths, strict=True))
        if close and max(counts) <= _MOST_STEPS:
            return counts, step
    return [], 0.0


# ----------------------------------------------------------------------------------------------------------------------
# Which cosines of the ceiling a response needs: grown from few, until more add less than a stated share.
# ----------------------------------------------------------------------------------------------------------------------

ENOUGH: Final = 1e-4  # share (rms, 0.001 dB) of the last orders in the pressure at which no more are added
SEEN: Final = 1 << 14  # samples of the record that tell well enough how much a cosine moves
FIRST_ORDERS: Final = 3  # cosines l, m to begin with, all of them evaluated
FINER: Final = 0.1  # share of the most driven cosine above which one that is left out keeps the search going
GROWTH: Final = 0.15  # of a large set of orders by its next block
MOST: Final = 40  # orders beyond those of the band that the search for convergence may add


def order_grid(n_l: int, n_m: int) -> Integers:
    """All pairs of orders below n_l and n_m [n_l n_m, 2]."""
    grid = np.stack(np.meshgrid(np.arange(n_l), np.arange(n_m), indexing="ij"), axis=-1)
    return grid.reshape(-1, 2).astype(np.int64)


def orders_not_in(block: Integers, done: Integers) -> Integers:
    """Orders of a block that have not been done."""
    width = 1 + max(block.max(initial=0), done.max(initial=0))
    return block[~np.isin(block @ [width, 1], done @ [width, 1])]


def order_blocks(room: Box, orders: int | None, highest_hz: float) -> list[Integers]:
    """Growing sets of cosines; the last two orders, which tell the truncation, are a block of their own."""
    if orders is not None:
        if orders < 1:
            raise AcousticsError("orders", got=str(orders), expected="at least 1")
        return [order_grid(n, n) for n in sorted({max(1, orders - 2), orders})]
    most = max(max(band_orders(room, highest_hz)) + MOST, FIRST_ORDERS + 2)
    sizes = [FIRST_ORDERS]
    while sizes[-1] + 2 <= most:
        sizes.append(min(most, sizes[-1] + max(2, int(GROWTH * sizes[-1]))))
    return [order_grid(n, n) for n in sizes]


def band_orders(room: Box, highest_hz: float) -> tuple[int, int]:
    """Cosines that propagate below a frequency, in both directions, and three more."""
    n_l, n_m = (int(np.ceil(2 * length * highest_hz / room.air.c)) + 3 for length in room.size[:2].tolist())
    return n_l, n_m


def resolved_orders(room: Box, points: Floats) -> Integers:
    """Highest orders l, m [2] that points of the ceiling [p, 3] integrate, four of them to a wave; 0 for a lone point.

    Beyond them sums over the points see other waves than are there.
    """
    extent = np.ptp(points[:, :2], axis=0)
    many = [len(np.unique(points[:, axis].round(9))) for axis in (0, 1)]
    per_length = np.divide(many, extent, out=np.zeros(2), where=extent > 0)
    return np.asarray(0.5 * per_length * room.size[:2], dtype=np.int64)


def undriven(surfaces: Sequence[SurfaceVelocity], room: Box, done: Integers, highest_hz: float) -> bool:
    """Whether no cosine of the sources' band that is left out is driven nearly as much as those that are in.

    Parameters
    ----------
    surfaces : Sequence[SurfaceVelocity]
        Motions of one surface. Blocks that add nothing end the search; a surface that moves in a pattern finer than the
        last block would end it too early.
    """
    left = orders_not_in(order_grid(*band_orders(room, highest_hz)), done)
    patterns = [np.abs(project(surfaces[0], room, some)) for some in (left, done)]
    return all(
        (patterns[0] @ one.sizes).max(initial=0.0) <= FINER * (patterns[1] @ one.sizes).max() for one in surfaces
    )


def audible(
    coefficients: Floats, products: Sequence[Floats], room: Box, orders: Integers, quietest: Sequence[float]
) -> NDArray[np.bool_]:
    """Which cosines `orders` [n, 2] could matter: the others, each in resonance all the time, would together stay
    below ENOUGH.

    Parameters
    ----------
    coefficients : Floats [n, k]
        Of the modes in them.
    products : Sequence[Floats]
        Of every motion, of `motion_products`.
    quietest : Sequence[float]
        Of each, the energy so far at the quietest receiver, a sum of squares [Pa^2].

    Notes
    -----
    A resonance of cosine (l, m) makes no more than rho c^2 v / (Lz zeta omega_lm) of the velocity v; motions that only
    rounding or a mesh without symmetry excites are left out so.
    """
    k_lm = horizontal_wavenumber(room, orders)
    omega = room.air.c * np.where(k_lm > 0, k_lm, np.pi / float(room.size[:2].max()))
    ratio = modal_damping_ratios(room.losses, omega / (2 * np.pi))
    kept = np.zeros(len(orders), dtype=bool)
    for product, energy in zip(products, quietest, strict=True):
        loudest = np.sqrt(np.einsum("nk,nk->n", coefficients @ product, coefficients).clip(0.0))
        loudest *= room.air.bulk_modulus / float(room.size[2])
        bound = np.divide(loudest, ratio * omega, out=np.full_like(loudest, np.inf), where=ratio > 0)
        quiet = np.argsort(bound)
        together = np.sqrt(np.cumsum(bound[quiet] ** 2))
        kept[quiet[together >= ENOUGH * np.sqrt(energy)]] = True
    return kept


def motion_products(surface: SurfaceVelocity) -> Floats:
    """Summed products of the modal rates [k, k]: a motion c @ rates has the sum of squares c @ products @ c. From some
    16,000 samples at least, which tell well enough."""
    every = max(1, surface.rates.shape[1] // SEEN)
    seen = surface.rates[:, ::every]
    products: Floats = every * (seen @ seen.T)
    return products
