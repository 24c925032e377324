"""Fatigue under random excitations: how many cycles of which range a power spectral density makes on the average."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from scipy.special import gamma

from femstruct.arrays import Floats
from femstruct.impact.result.fatigue import BELOW, BINS, Fatigue, SNLine, normals_of, plane, plane_weights

FARTHEST: Final = 12.0  # standard deviations: beyond them are 1e-31 of all cycles
_STEPS: Final = 6001
_STEP_ERROR: Final = 1e-6  # of the sum over steps beside the closed form
POWERS: Final = (0, 1, 2, 4)  # of the frequency, of the moments that Dirlik's density has
_NARROW: Final = 1e-6  # a process whose irregularity is this near to 1 has Rayleigh's amplitudes


def expected(
    channel: str,
    unit: str,
    psd: Floats,
    frequency_hz: Floats,
    duration: float,
    line: SNLine | None,
    on: str = "",
) -> Fatigue:
    """Rainflow cycles that a stationary Gaussian process makes on the average in a duration [s].

    psd [nf] : one-sided [unit^2/Hz] at frequency_hz [nf].

    Notes
    -----
    The ranges have Dirlik's density, which was fitted to rainflow counts of simulated processes: T. Dirlik, Application
    of Computers in Fatigue Analysis, University of Warwick (1985). `largest` is the range that is exceeded once. Beside
    counts of 2000 s of simulated noise the damage with slopes of 3 and 5 is right for one hump in the spectrum, 6 and
    8 % low for a flat one, and up to 20 % low for two humps far apart.

    One frequency band of 1 Hz at 100 Hz with a standard deviation of 10 MPa, for 1000 s: 100 000 cycles, as good as all
    with Rayleigh's amplitudes, whose mean cube is 3 sqrt(pi / 2) sigma^3:

    >>> lines = np.linspace(99.5, 100.5, 201)
    >>> found = expected("weld", "Pa", np.full(201, 1e14), lines, 1e3, SNLine(100e6, at=2e6))
    >>> rayleigh = 1e5 / 2e6 * 0.2**3 * 3 * float(np.sqrt(np.pi / 2))
    >>> round(found.cycles, -3), round(found.damage / rayleigh, 2)
    (100000.0, 1.0)
    """
    moments = np.array([float(np.trapezoid(frequency_hz**n * psd, frequency_hz)) for n in POWERS])
    return _of_moments(channel, unit, moments, duration, line, on)


def _of_moments(channel: str, unit: str, moments: Floats, duration: float, line: SNLine | None, on: str) -> Fatigue:
    m0, m1, m2, m4 = map(float, moments)
    if not m0 > 0.0:
        return Fatigue(channel, unit, np.zeros(BINS), np.zeros(BINS), 0.0, None if line is None else 0.0, on)
    deviation, count = np.sqrt(m0), np.sqrt(m4 / m2) * duration
    z = np.linspace(0.0, FARTHEST, _STEPS)
    density, below = _dirlik(z, m1 / m0 * np.sqrt(m2 / m4), m2 / np.sqrt(m0 * m4))
    above = count * (1.0 - below)
    largest = float(2.0 * deviation * z[int(np.argmax(above <= 1.0))])
    ends = largest * np.arange(1, BINS + 1) / BINS
    passed = np.interp(ends, 2.0 * deviation * z, count * below)
    counts = np.diff(np.concatenate([[0.0], passed[:-1], [count]]))
    damage = None
    if line is not None:
        rate = np.divide(density, line.endured(2.0 * deviation * z), out=np.zeros_like(z), where=z > 0.0)
        damage = float(count * np.trapezoid(rate, z))
    return Fatigue(channel, unit, ends, counts, largest, damage, on)


def expected_on_planes(
    channel: str,
    stresses: np.ndarray,
    components: tuple[str, ...],
    psd: Floats,
    frequency_hz: Floats,
    duration: float,
    line: SNLine | None,
    place: str,
    uneven: float = 0.0,
    axes: Floats | None = None,
) -> Fatigue:
    """The same of the normal stress on the worst of many planes at one place.

    stresses [c, nf] : complex components per unit of what excites [Pa]; psd [nf] : of that. uneven : the share of
    the stress that the mesh leaves open, 0 if little. axes [3, 3] : rows are their local axes; None for global ones.
    """
    normals = normals_of(components)
    squares = np.abs(plane_weights(normals, components) @ stresses) ** 2 * psd
    found = [expected(channel, "Pa", one, frequency_hz, duration, line) for one in squares]
    sizes = [one.largest if one.damage is None else one.damage for one in found]
    worst = int(np.argmax(sizes))
    one, on = found[worst], f"{place}, {plane(normals[worst], axes)}"
    beside = None
    if uneven > 0.0:
        beside = expected(channel, "Pa", (1.0 - uneven) ** 2 * squares[worst], frequency_hz, duration, line).damage
    return replace(one, on=on, damage_beside=beside)


def most_damaged(moments: Floats, components: tuple[str, ...], duration: float, line: SNLine | None) -> int:
    """The place with the most damage on its worst plane, without an S-N line the largest range.

    moments [4, p, c, c] : of the components of the stress at every place, of the frequency to the powers of POWERS.

    Notes
    -----
    Dirlik's damage along a line of one slope has a closed form, and a detail category has no more damage than either of
    its slopes alone. Of every place the plane that has most by this is counted, in its order, until it is below what
    was found: the others have less.
    """
    weights = plane_weights(normals_of(components), components)
    on_planes = np.einsum("nc,mpcd,nd->mpn", weights, moments, weights, optimize=True).clip(0.0)
    bounds = _bounds(on_planes, duration, line)
    planes, found, largest = bounds.argmax(axis=1), 0, -1.0
    for place in np.argsort(-bounds.max(axis=1), kind="stable"):
        if bounds[place, planes[place]] <= largest:
            break
        one = _of_moments("", "Pa", on_planes[:, place, planes[place]], duration, line, "")
        size = one.largest if one.damage is None else one.damage
        if size > largest:
            found, largest = int(place), size
    return found


def _bounds(moments: Floats, duration: float, line: SNLine | None) -> Floats:
    """What processes of these moments [4, ...] have at most: damage, or without a line the largest range."""
    m0, m1, m2, m4 = moments
    if line is None:
        return np.asarray(2.0 * FARTHEST * np.sqrt(m0), dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        count, g = np.sqrt(m4 / m2) * duration, np.minimum(m2 / np.sqrt(m0 * m4), 1.0)
        d1, d2, d3, q, r = _parameters(m1 / m0 * np.sqrt(m2 / m4), g)
        slopes = [line.slope, BELOW] if line.category else [line.slope]
        lines = [
            count
            / line.at_one(slope)
            * (2.0 * np.sqrt(m0)) ** slope
            * (
                d1 * np.abs(q) ** slope * gamma(1.0 + slope)
                + 2.0 ** (slope / 2.0) * gamma(1.0 + slope / 2.0) * (d2 * np.abs(r) ** slope + d3)
            )
            for slope in slopes
        ]
    found: Floats = np.nan_to_num(np.minimum.reduce(lines), nan=0.0, posinf=np.inf)
    return (1.0 + _STEP_ERROR) * found


def _parameters(mean: Floats, irregularity: Floats) -> tuple[Floats, ...]:
    """Dirlik's d1, d2, d3, q and r; Rayleigh's density where the irregularity is 1."""
    g = irregularity
    narrow = 1.0 - g < _NARROW
    d1 = 2.0 * (mean - g**2) / (1.0 + g**2)
    r = (g - mean - d1**2) / (1.0 - g - d1 + d1**2)
    d2 = (1.0 - g - d1 + d1**2) / (1.0 - r)
    d3 = 1.0 - d1 - d2
    q = 1.25 * (g - d3 - d2 * r) / d1
    plain = ((d1, 0.0), (d2, 0.0), (d3, 1.0), (q, 1.0), (r, 1.0))
    return tuple(np.where(narrow, value, one) for one, value in plain)


def _dirlik(z: Floats, mean: float, irregularity: float) -> tuple[Floats, Floats]:
    """Dirlik's density of amplitudes over standard deviations, and the share of amplitudes below them. mean : mean
    frequency over that of the peaks. The share is no sum of the density: small ripples can be narrower than steps of z.
    """
    g = irregularity
    rayleigh, lower = z * np.exp(-(z**2) / 2.0), -np.expm1(-(z**2) / 2.0)
    if 1.0 - g < _NARROW:
        return rayleigh, lower
    d1, d2, d3, q, r = map(float, _parameters(np.array(mean), np.array(g)))
    found: Floats = d1 / q * np.exp(-z / q) + d2 * z / r**2 * np.exp(-(z**2) / (2.0 * r**2)) + d3 * rayleigh
    return found, -d1 * np.expm1(-z / q) - d2 * np.expm1(-(z**2) / (2.0 * r**2)) + d3 * lower
