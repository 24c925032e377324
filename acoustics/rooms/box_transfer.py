"""Transfer of the rectangular room: from the velocity of its ceiling to the pressure inside.

With s = j omega + a (a = 0 on the frequency axis), the pressure of the cosine (l, m) of the ceiling velocity is

    P(z) = -rho d(s) V cos(mu z) / (mu sin(mu Lz)),      mu^2 = k^2(s) - k_lm^2,      k_lm^2 = (l pi/Lx)^2 + (m pi/Ly)^2

for a rigid floor and a ceiling velocity positive into the room (so that uniform compression is rho c^2 times the
displaced volume over V, positive). d(s) = s, but s + 2 gamma with a constant decay rate, where the pressure is
rho (phi_t + 2 gamma phi).
"""

from __future__ import annotations

from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, Integers
from acoustics.losses import Losses
from acoustics.rooms.box import Box
from acoustics.source import SurfaceVelocity

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
    ways = _ways(mu, float(room.size[2]), z)
    whole = ways[0][0] * ways[0][1]  # E(Lz), the same at all heights
    front = -room.air.rho * (s + 2 * room.losses.decay_rate) / (mu * (1 - whole * whole))
    return [front * (down * (1 + up * up)) for up, down in ways]


def _ways(mu: Complexes, height: float, levels: Floats) -> list[tuple[Complexes | float, Complexes | float]]:
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
