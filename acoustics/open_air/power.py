"""Sound power that a flat surface in a rigid baffle radiates, and where it goes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, freeze, frozen
from acoustics.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# A flat surface that radiates, as few sources on a grid: what makes its power cheap at many frequencies.
# ----------------------------------------------------------------------------------------------------------------------

_MORE: Final = 6  # nodes beyond those a plane wave needs
_SLOW: Final = 8.0  # of z^(1/3): beyond z + 8 z^(1/3) a Bessel function of argument z is below 1e-9 of its largest
_AT_ONCE: Final = 1 << 22  # numbers
_STEP: Final = 8  # directions by which groups of frequencies differ


@dataclass(frozen=True, eq=False)
class RadiatingSheet:
    """Sources on a grid of Chebyshev nodes whose far field is that of a flat surface, up to a wavenumber.

    half [2] : half the lengths of the grid along its two sides [m]. diagonal : of the surface [m].
    sources [2, 2, hx, hy, k] : sums (0) and differences (1) of what is mirrored along the first and the second side, by
    shape: even and odd parts radiate into the half space by themselves.
    """

    half: Floats
    diagonal: float
    sources: Floats


def sheet(points: Floats, weights: Floats, shapes: Floats, wavenumber: float) -> RadiatingSheet:
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
    return RadiatingSheet(half, float(np.hypot(*(2 * half))), _parities(moved))


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


def sheet_power(whole: RadiatingSheet, rates: Complexes, wavenumbers: Floats) -> Floats:
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


def _quarter(part: RadiatingSheet, rates: Complexes, k: Floats, n: int) -> Floats:
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


def _coarser(whole: RadiatingSheet, wavenumber: float) -> RadiatingSheet:
    """The same sources on a grid that is fine enough for a lower wavenumber."""
    even = whole.sources
    for axis in (0, 1):
        fine, coarse = 2 * even.shape[2 + axis], nodes(wavenumber * float(whole.half[axis]))
        if coarse < fine:
            onto = _onto(_chebyshev(fine)[fine // 2 :], coarse)  # [fine / 2, coarse]
            plus, minus = onto[:, coarse // 2 :], onto[:, coarse // 2 - 1 :: -1]
            halves = np.stack([plus + minus, plus - minus])  # a wave's own parity decides: sums or differences
            even = np.einsum(("pqayk,pab->pqbyk", "pqxak,qab->pqxbk")[axis], even, halves, optimize=True)
    return RadiatingSheet(whole.half, whole.diagonal, even)


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


# ----------------------------------------------------------------------------------------------------------------------
# Power that a surface in a rigid baffle radiates: by its far field, its efficiency, its modes and its impedance.
# ----------------------------------------------------------------------------------------------------------------------

_MORE_DIRECTIONS: Final = 12  # directions in each angle beyond those a plane wave across the surface needs
_DIRECTIONS_AT_ONCE: Final = 1 << 22  # complex numbers


def radiated_power(
    points: Floats, weights: Floats, shapes: Floats, rates: Complexes, frequency_hz: Floats, air: Air
) -> Floats:
    """Mean sound power [nf] [W] that a baffled flat surface radiates to one side.

    Parameters
    ----------
    points, weights, shapes : Floats [p, 3], Floats [p], Floats [p, k]
        As of a `SurfaceVelocity` [m], [m^2].
    rates : Complexes [k, nf]
        Complex velocities (peak values) of the modal coordinates; shapes times rates is m/s.

    Notes
    -----
    Over the far field, W = rho c k^2 / (16 pi^2) int |Q(e)|^2 d Omega on the whole sphere, of which the baffled surface
    fills one half and its mirror the other; Q(e) = sum of w v exp(j k e . x). By few sources on a grid that radiate as
    the points do, see `RadiatingSheet`: to 1e-8. 200 shapes on 5,000 points of 5 x 4 m at 1,000 frequencies
    up to 1 kHz take about 1 s.

    F. Fahy, P. Gardonio, Sound and Structural Vibration, 2nd ed., section 3.3.

    Examples
    --------
    A small source: rho c k^2 |Q|^2 / (4 pi) of volume velocity Q:

    >>> power = radiated_power(np.zeros((1, 3)), np.array([1e-4]), np.ones((1, 1)), np.ones((1, 1), complex),
    ...                        np.array([100.0]), Air())
    >>> k = 2 * np.pi * 100 / 343
    >>> print(f"{power[0] / (1.21 * 343 * k**2 * 1e-8 / (4 * np.pi)):.9f}")
    1.000000000
    """
    wavenumbers = 2 * np.pi * np.asarray(frequency_hz, dtype=np.float64) / air.c
    whole = sheet(points, weights, shapes, float(wavenumbers.max(initial=0.0)))
    power: Floats = air.rho * air.c * sheet_power(whole, rates, wavenumbers)
    return power


def plane_wave_power(weights: Floats, shapes: Floats, rates: Complexes, air: Air) -> Floats:
    """Power [nf] [W] that plane waves would carry away: rho c S <v^2>, <v^2> the mean square over surface and time.

    As `radiated_power`.
    """
    both = shapes.T @ (weights[:, None] * shapes)
    parts = rates.real, rates.imag
    power: Floats = air.rho * air.c / 2 * np.sum([((both @ part) * part).sum(axis=0) for part in parts], axis=0)
    return power


def radiation_efficiency(
    points: Floats, weights: Floats, shapes: Floats, rates: Complexes, frequency_hz: Floats, air: Air
) -> Floats:
    """Radiated power over that of a plane wave, rho c S <v^2> [nf] [-]; nan where nothing moves.

    As `radiated_power`.
    """
    plane = plane_wave_power(weights, shapes, rates, air)
    power = radiated_power(points, weights, shapes, rates, frequency_hz, air)
    efficiency: Floats = np.divide(power, plane, out=np.full_like(power, np.nan), where=plane > 0)
    return efficiency


def radiation_modes(points: Floats, weights: Floats, wavenumber: float) -> tuple[Floats, Floats]:
    """Velocity patterns of a baffled flat surface that radiate by themselves: efficiencies [m] and patterns [p, m].

    wavenumber [1/m]. Strongest first; patterns of unit mean square over the surface, which radiate rho c S / 2 times
    their efficiency and share no power. As many as radiate more than 1e-12 of the first.

    References: S. J. Elliott, M. E. Johnson, J. Acoust. Soc. Am. 94 (1993) 2194-2204.

    >>> x = (np.arange(8) + 0.5) / 8
    >>> points = np.array([[a, b, 0] for a in x for b in x])
    >>> strength, patterns = radiation_modes(points, np.full(64, 1 / 64), wavenumber=0.5)
    >>> print(f"{strength[0] / (0.5**2 / (2 * np.pi)):.2f} {np.ptp(patterns[:, 0]):.2f}")
    0.99 0.02
    """
    root = np.sqrt(weights)
    far = far_field(points, root, np.eye(len(points)), wavenumber)
    both = np.concatenate([far.real, far.imag])
    _, sizes, patterns = np.linalg.svd(both, full_matrices=False)
    efficiency = 2 * wavenumber**2 * sizes**2
    kept = efficiency > 1e-12 * efficiency[0]
    shapes = patterns[kept].T / root[:, None] * np.sqrt(weights.sum())
    shapes *= np.sign(shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])])
    return efficiency[kept], shapes


def radiation_impedance(points: Floats, weights: Floats, shapes: Floats, wavenumber: float, air: Air) -> Complexes:
    """Impedance [k, k] of the air in front of a baffled flat surface: generalised force over velocity of the shapes.

    wavenumber [1/m]. N s/m for dimensionless shapes. The imaginary part over omega is the mass of air that moves along.

    Notes
    -----
    Rayleigh's integral over pairs of points; what a point does to itself is that of a disc of its area,
    2 pi (1 - exp(-j k a)) / (j k). First order in the distance of the points.
    """
    omega, p = wavenumber * air.c, len(points)
    radius = np.sqrt(weights / np.pi)
    own = 2 * np.pi * (1 - np.exp(-1j * wavenumber * radius)) / (1j * wavenumber)
    answers = np.empty((p, shapes.shape[1]), dtype=np.complex128)
    weighted = weights[:, None] * shapes
    step = max(1, _DIRECTIONS_AT_ONCE // p)
    for start in range(0, p, step):
        rows = np.arange(start, min(start + step, p))
        far = np.linalg.norm(points[rows, None] - points, axis=2)
        alone = far == 0
        kernel = np.exp(-1j * wavenumber * far) / np.where(alone, 1.0, far)
        kernel[alone] = 0.0
        answers[rows] = kernel @ weighted + own[rows, None] * shapes[rows]
    impedance: Complexes = 1j * omega * air.rho / (2 * np.pi) * (weighted.T @ answers)
    return impedance


def far_field(points: Floats, weights: Floats, shapes: Floats, wavenumber: float) -> Complexes:
    """Far-field factors [d, k] of shapes over directions of the sphere, each times the root of its solid angle over
    16 pi^2: W = rho c k^2 |far v|^2."""
    across = wavenumber * float(np.linalg.norm(np.ptp(points, axis=0)))
    n = int(np.ceil(across / 2)) + _MORE_DIRECTIONS
    height, share = np.polynomial.legendre.leggauss(n)
    angle = 2 * np.pi * np.arange(2 * n) / (2 * n)
    ring = np.sqrt(1 - height**2)
    e = np.stack(
        [np.outer(ring, np.cos(angle)), np.outer(ring, np.sin(angle)), np.outer(height, np.ones(2 * n))], axis=-1
    ).reshape(-1, 3)
    root = np.sqrt(np.repeat(share, 2 * n) * (np.pi / n) / (16 * np.pi**2))
    middle = points.mean(axis=0)
    weighted, found = weights[:, None] * shapes, np.empty((len(e), shapes.shape[1]), dtype=np.complex128)
    step = max(1, _DIRECTIONS_AT_ONCE // len(points))
    for start in range(0, len(e), step):
        some = slice(start, start + step)
        found[some] = root[some, None] * (np.exp(1j * wavenumber * (e[some] @ (points - middle).T)) @ weighted)
    return found


# ----------------------------------------------------------------------------------------------------------------------
# Where a surface in a baffle sends its sound: far-field levels on half circles through its normal.
# ----------------------------------------------------------------------------------------------------------------------

ANGLES_DEG: Final = np.arange(-90.0, 91.0)
FLOOR_DB: Final = -120.0


@stored_as("directivity/1")
@dataclass(frozen=True, eq=False)
class Directivity:
    """Far field of a baffled surface on two half circles, along its first and its second side.

    frequency_hz [nf]. angle_deg [n] : from the normal, positive along the side. along [2, 3] : the sides, unit vectors
    that point along the global axes rather than against them. pressure [nf, 2, n] : |p| times the
    distance [Pa m], or per whatever the rates are per. half_sphere [nf] : root of the mean of its square over the whole
    half sphere.
    """

    frequency_hz: Floats
    angle_deg: Floats
    along: Floats
    pressure: Floats
    half_sphere: Floats

    def __post_init__(self) -> None:
        frequency_hz = frozen("pattern.frequency_hz", self.frequency_hz, (None,))
        angle_deg, lines = frozen("pattern.angle_deg", self.angle_deg, (None,)), len(frequency_hz)
        freeze(
            self,
            frequency_hz=frequency_hz,
            angle_deg=angle_deg,
            along=frozen("pattern.along", self.along, (2, 3)),
            pressure=frozen("pattern.pressure", self.pressure, (lines, 2, len(angle_deg))),
            half_sphere=frozen("pattern.half_sphere", self.half_sphere, (lines,)),
        )

    @property
    def sides(self) -> tuple[str, str]:
        """Names of the sides: the global axis they lie along, or "first side" and "second side"."""
        first, second = (
            "xyz"[int(side.argmax())] if side.max() > 1 - 1e-6 else f"{word} side"
            for side, word in zip(self.along, ("first", "second"), strict=True)
        )
        return first, second

    @property
    def level_db(self) -> Floats:
        """Levels [nf, 2, n] re the loudest direction on the two half circles [dB], -120 where nothing goes."""
        loudest = self.pressure.max(axis=(1, 2), keepdims=True)
        share = np.divide(self.pressure, loudest, out=np.zeros_like(self.pressure), where=loudest > 0)
        levels: Floats = np.maximum(20 * np.log10(np.maximum(share, 1e-300)), FLOOR_DB)
        return levels

    @property
    def index_db(self) -> Floats:
        """How much louder the loudest direction is than the mean square over the half sphere [nf] [dB]: 0 for a source
        small beside the wave; nan in silence."""
        with np.errstate(divide="ignore", invalid="ignore"):
            index: Floats = 20 * np.log10(self.pressure.max(axis=(1, 2)) / self.half_sphere)
        return index

    def loudest(self, line: int) -> tuple[int, float]:
        """The half circle, 0 or 1, and the angle [deg] of the loudest direction of a frequency; the one nearest to the
        normal where several are as loud."""
        size = self.pressure[line]
        alike = size >= size.max() * (1 - 1e-6)
        off = np.where(alike, np.abs(self.angle_deg), np.inf)
        circle, place = np.unravel_index(int(off.argmin()), off.shape)
        return int(circle), float(self.angle_deg[place])


def radiation_pattern(
    points: Floats,
    weights: Floats,
    shapes: Floats,
    rates: Complexes,
    frequency_hz: Floats,
    air: Air,
    normal: Floats,
    along: Floats,
) -> Directivity:
    """Far field of a baffled flat surface that moves with exp(+j omega t).

    Parameters
    ----------
    points, weights, shapes, rates : Floats [p, 3], Floats [p], Floats [p, k], Complexes [k, nf]
        As of `acoustics.radiated_power`.
    normal, along : Floats [3], Floats [2, 3]
        Unit vectors into the air and along the surface's two sides.

    Notes
    -----
    The exact phase of every point (Fraunhofer): r |p| = omega rho / (2 pi) |sum of w v exp(j k e . x)|.

    Examples
    --------
    A source small beside the wave sends the same everywhere:

    >>> small = radiation_pattern(np.zeros((1, 3)), np.array([1e-4]), np.ones((1, 1)), np.ones((1, 1), complex),
    ...                     np.array([100.0]), Air(), np.array([0.0, 0, 1]), np.eye(3)[:2])
    >>> bool(np.abs(small.level_db).max() < 1e-9), bool(abs(small.index_db[0]) < 1e-9)
    (True, True)
    """
    frequency_hz = np.asarray(frequency_hz, dtype=np.float64)
    angle = np.radians(ANGLES_DEG)
    main = np.take_along_axis(along, np.abs(along).argmax(axis=1)[:, None], axis=1)
    along = along * np.sign(main)
    e = np.cos(angle)[:, None] * normal + np.sin(angle)[:, None] * along[:, None]  # [2, n, 3]
    path = (points - points.mean(axis=0)) @ e.reshape(-1, 3).T  # [p, 2 n]
    weighted = weights[:, None] * shapes
    pressure = np.empty((len(frequency_hz), 2, len(angle)))
    for line, f in enumerate(frequency_hz):
        k = 2 * np.pi * f / air.c
        moved = weighted @ rates[:, line]
        pressure[line] = np.abs(f * air.rho * (moved @ np.exp(1j * k * path))).reshape(2, -1)
    power = radiated_power(points, weights, shapes, rates, frequency_hz, air)
    return Directivity(frequency_hz, ANGLES_DEG, along, pressure, np.sqrt(power * air.rho * air.c / np.pi))
