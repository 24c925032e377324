"""Power that a surface in a rigid baffle radiates: by its far field, its efficiency, its modes and its impedance."""

from __future__ import annotations

from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats
from acoustics.open_air.sheet import sheet, sheet_power

_MORE: Final = 12  # directions in each angle beyond those a plane wave across the surface needs
_AT_ONCE: Final = 1 << 22  # complex numbers


def radiated_power(
    points: Floats, weights: Floats, shapes: Floats, rates: Complexes, frequency_hz: Floats, air: Air
) -> Floats:
    """Mean sound power [nf] [W] that a baffled flat surface radiates to one side.

    points [p, 3], weights [p], shapes [p, k] : as of a `SurfaceVelocity` [m], [m^2].
    rates [k, nf] : complex velocities (peak values) of the modal coordinates; shapes times rates is m/s.

    Notes
    -----
    Over the far field, W = rho c k^2 / (16 pi^2) int |Q(e)|^2 d Omega on the whole sphere, of which the baffled surface
    fills one half and its mirror the other; Q(e) = sum of w v exp(j k e . x). By few sources on a grid that radiate as
    the points do, see `acoustics.open_air.sheet`: to 1e-8. 200 shapes on 5,000 points of 5 x 4 m at 1,000 frequencies
    up to 1 kHz take about 1 s.

    F. Fahy, P. Gardonio, Sound and Structural Vibration, 2nd ed., section 3.3.

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
    step = max(1, _AT_ONCE // p)
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
    n = int(np.ceil(across / 2)) + _MORE
    height, share = np.polynomial.legendre.leggauss(n)
    angle = 2 * np.pi * np.arange(2 * n) / (2 * n)
    ring = np.sqrt(1 - height**2)
    e = np.stack(
        [np.outer(ring, np.cos(angle)), np.outer(ring, np.sin(angle)), np.outer(height, np.ones(2 * n))], axis=-1
    ).reshape(-1, 3)
    root = np.sqrt(np.repeat(share, 2 * n) * (np.pi / n) / (16 * np.pi**2))
    middle = points.mean(axis=0)
    weighted, found = weights[:, None] * shapes, np.empty((len(e), shapes.shape[1]), dtype=np.complex128)
    step = max(1, _AT_ONCE // len(points))
    for start in range(0, len(e), step):
        some = slice(start, start + step)
        found[some] = root[some, None] * (np.exp(1j * wavenumber * (e[some] @ (points - middle).T)) @ weighted)
    return found
