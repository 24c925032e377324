"""A flat surface that radiates, as few sources on a grid: what makes its power cheap at many frequencies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats

_MORE: Final = 6  # nodes beyond those a plane wave needs
_SLOW: Final = 8.0  # of z^(1/3): beyond z + 8 z^(1/3) a Bessel function of argument z is below 1e-9 of its largest
_AT_ONCE: Final = 1 << 22  # numbers
_STEP: Final = 8  # directions by which groups of frequencies differ


@dataclass(frozen=True, eq=False)
class Sheet:
    """Sources on a grid of Chebyshev nodes whose far field is that of a flat surface, up to a wavenumber.

    half [2] : half the lengths of the grid along its two sides [m]. diagonal : of the surface [m].
    sources [2, 2, hx, hy, k] : sums (0) and differences (1) of what is mirrored along the first and the second side, by
    shape: even and odd parts radiate into the half space by themselves.
    """

    half: Floats
    diagonal: float
    sources: Floats


def sheet(points: Floats, weights: Floats, shapes: Floats, wavenumber: float) -> Sheet:
    """Sources for the far field of shapes [p, k] on points [p, 3] of a plane, up to a wavenumber [1/m].

    Notes
    -----
    A plane wave along a side of length L is, on it, a polynomial of degree k L / 2 and a little more: its values at as
    many Chebyshev nodes give those at every point. Weights times shapes go the other way, from the points to the nodes.
    """
    flat = points - points.mean(axis=0)
    along = sides(flat)
    flat = flat @ along.T
    low, high = flat.min(axis=0), flat.max(axis=0)
    half = np.maximum((high - low) / 2, 1e-300)
    t = (flat - (low + high) / 2) / half
    to_x, to_y = (_onto(t[:, axis], nodes(wavenumber * float(half[axis]))) for axis in (0, 1))
    moved = np.empty((to_x.shape[1], to_y.shape[1], shapes.shape[1]))
    weighted = weights[:, None] * shapes
    for row in range(to_x.shape[1]):
        moved[row] = (to_x[:, row, None] * to_y).T @ weighted
    return Sheet(half, float(np.hypot(*(2 * half))), _parities(moved))


def sides(flat: Floats) -> Floats:
    """Unit vectors [2, 3] in the plane of centred points [p, 3], the first nearest to a global axis."""
    _, _, frame = np.linalg.svd(flat.T @ flat)
    normal = frame[2]
    first = np.eye(3)[np.abs(normal).argmin()]
    first = first - normal * (normal @ first)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)])


def nodes(z: float) -> int:
    """How many Chebyshev nodes, an even number, carry exp(j z t) on -1..1 to about 1e-9."""
    return 2 * int(np.ceil((z + _SLOW * np.cbrt(z) + _MORE) / 2))


def sheet_power(whole: Sheet, rates: Complexes, wavenumbers: Floats) -> Floats:
    """Power [nf] over rho c [m^2 times the square of a rate] that the shapes radiate with complex rates [k, nf].

    wavenumbers [nf] [1/m] : none above that of the sheet.

    Notes
    -----
    k^2 / (16 pi^2) int |Q|^2 over the sphere. Its poles lie in the plane: Gauss-Legendre from pole to pole along the
    first side, equal steps round it. Both are even about the middle, so a quarter of the half space is enough for each
    of the four parities of the sources, and kernels are real.
    """
    power = np.zeros(len(wavenumbers))
    counts = np.array([_directions(k * whole.diagonal) for k in wavenumbers], dtype=np.int64)
    for n in np.unique(counts).tolist():
        lines = np.flatnonzero(counts == n)
        part = _coarser(whole, float(wavenumbers[lines].max()))
        hy = part.sources.shape[3]
        step = max(1, _AT_ONCE // (n * n // 2 * hy))
        for start in range(0, len(lines), step):
            some = lines[start : start + step]
            power[some] = _quarter(part, rates[:, some], wavenumbers[some], n)
    return power


def _directions(z: float) -> int:
    """Directions from pole to pole, and as many round half the circle, for |Q|^2 of a surface of z = k D."""
    needed = (z + _SLOW * np.cbrt(z)) / 2 + _MORE
    return _STEP * int(np.ceil(needed / _STEP))


def _quarter(part: Sheet, rates: Complexes, k: Floats, n: int) -> Floats:
    """The sum over a quarter of the half space, four times."""
    _, _, hx, hy, shapes = part.sources.shape
    height, share = np.polynomial.legendre.leggauss(n)
    height, share = height[n // 2 :], share[n // 2 :]
    round_ = np.cos(np.pi * (np.arange(n // 2) + 0.5) / n)
    x, y = (half * _chebyshev(2 * count)[count:] for half, count in zip(part.half, (hx, hy), strict=True))
    moving = part.sources.reshape(-1, shapes) @ rates
    moving = moving.reshape(2, 2, hx, hy, len(k)).transpose(4, 0, 1, 2, 3)  # [f, px, py, hx, hy]
    parts = np.concatenate([moving.real, moving.imag], axis=-1)  # [f, px, py, hx, 2 hy]
    phase = k[:, None, None] * height[:, None] * x
    first = np.stack([np.cos(phase), np.sin(phase)], axis=1)[:, :, None]  # [f, px, 1, nu, hx]
    across = (first @ parts).reshape(len(k), 2, 2, len(height), 2, hy)
    columns = across.transpose(0, 2, 3, 5, 1, 4).reshape(len(k), 2, len(height), hy, 4)  # [f, py, nu, hy, px re/im]
    ring = np.sqrt(1 - height**2)
    angle = k[:, None, None, None] * ring[:, None, None] * round_[:, None] * y
    total = np.zeros((len(k), len(height)))
    for parity, wave in enumerate((np.cos, np.sin)):
        total += ((wave(angle) @ columns[:, parity]) ** 2).sum(axis=(2, 3))
    return k**2 / (2 * np.pi * n) * (total @ share)


def _coarser(whole: Sheet, wavenumber: float) -> Sheet:
    """The same sources on a grid that is fine enough for a lower wavenumber."""
    even = whole.sources
    for axis in (0, 1):
        fine, coarse = 2 * even.shape[2 + axis], nodes(wavenumber * float(whole.half[axis]))
        if coarse < fine:
            onto = _onto(_chebyshev(fine)[fine // 2 :], coarse)  # [fine / 2, coarse]
            plus, minus = onto[:, coarse // 2 :], onto[:, coarse // 2 - 1 :: -1]
            halves = np.stack([plus + minus, plus - minus])  # a wave's own parity decides: sums or differences
            even = np.einsum(("pqayk,pab->pqbyk", "pqxak,qab->pqxbk")[axis], even, halves, optimize=True)
    return Sheet(whole.half, whole.diagonal, even)


def _parities(moved: Floats) -> Floats:
    """Sources [mx, my, k] as sums and differences of mirrored ones [2, 2, mx / 2, my / 2, k]."""
    hx, hy = moved.shape[0] // 2, moved.shape[1] // 2
    up, down = moved[hx:], moved[hx - 1 :: -1]
    both = np.stack([up + down, up - down])
    right, left = both[:, :, hy:], both[:, :, hy - 1 :: -1]
    return np.stack([right + left, right - left], axis=1)


def _chebyshev(count: int) -> Floats:
    """Chebyshev nodes of the first kind, ascending [count]."""
    angles: Floats = np.cos(np.pi * (np.arange(count, 0, -1) - 0.5) / count)
    return angles


def _onto(t: Floats, count: int) -> Floats:
    """Lagrange polynomials of the Chebyshev nodes at places -1 <= t <= 1 [n, count]."""
    orders = np.arange(count)
    here = np.cos(np.arccos(np.clip(t, -1, 1))[:, None] * orders)
    there = np.cos(np.arccos(_chebyshev(count))[:, None] * orders)
    there[:, 0] *= 0.5
    polynomials: Floats = 2 / count * here @ there.T
    return polynomials
