"""Fatigue of what is recorded: cycles by the rainflow method, and the damage they sum to by an S-N line."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Final, NamedTuple

import numpy as np
from scipy.special import gamma

from femstruct.arrays import Floats
from femstruct.declared import Positive, checked
from femstruct.reported import OWN_UNIT, Reported
from femstruct.tags import stored_as

BINS: Final = 50
"""Ranges that are told apart in tables and pictures; the damage is that of the ranges themselves."""
PLANES: Final = 36  # 5 degrees apart: the range on the worst is within 0.4 %, the cosine of 5 degrees, in pure shear
DIRECTIONS: Final = 400  # over half a sphere, about 7 degrees apart: within 1.5 % in tension
KNEE, CUT_OFF = 5e6, 1e8
"""Cycles of EN 1993-1-9: where the slope changes, and where ranges are small enough to do no damage."""
_CLASSES: Final = "Upper end of the class of ranges; damage from these is too high, the attribute damage is exact"
BELOW: Final = 5.0  # slope of EN 1993-1-9 beyond the knee
AT_ONCE: Final = 4_000_000  # stresses in hand at once: 32 MB
ROUNDING: Final = 1e-9  # of bounds, far above that of their sums
_TURN: Final = np.pi * (3.0 - np.sqrt(5.0))  # the golden angle


@stored_as("SN line/1")
@dataclass(frozen=True)
@checked("fatigue.sn")
class SNLine:
    """An S-N line: range [unit of what is counted], at : cycles it is endured, slope : its exponent m, N = at (range /
    S)^m. category : as EN 1993-1-9 has it for direct stress, with slope 5 from 5e6 cycles and no damage by ranges that
    are endured 1e8 times or more. Partial factors are not in it.

    Detail category 71 endures 71 MPa two million times, 52.3 MPa five million times, and 28.7 MPa for ever:

    >>> SNLine(71e6, category=True).endured(np.array([71e6, 52.3e6, 28.7e6])).round(-5)
    array([2000000., 5000000.,      inf])
    """

    range: Positive
    at: Positive = 2e6
    slope: Positive = 3.0
    category: bool = False

    def at_one(self, slope: float) -> float:
        """Cycles that a range of 1 [unit] is endured along the line of this slope, `slope` or the one below it."""
        if slope == self.slope:
            return float(self.at * self.range**slope)
        return float(KNEE * (self.range * (self.at / KNEE) ** (1.0 / self.slope)) ** slope)

    def endured(self, ranges: Floats) -> Floats:
        """Cycles [n] that ranges [n] are endured; infinite below the cut-off of a category."""
        with np.errstate(divide="ignore", over="ignore"):
            cycles: Floats = self.at * (self.range / ranges) ** self.slope
            if not self.category:
                return cycles
            knee = self.range * (self.at / KNEE) ** (1.0 / self.slope)
            beyond = KNEE * (knee / ranges) ** BELOW
            low = knee * (KNEE / CUT_OFF) ** (1.0 / BELOW)
        return np.where(ranges >= knee, cycles, np.where(ranges >= low, beyond, np.inf))


@stored_as("fatigue/1")
@dataclass(frozen=True, eq=False)
class Fatigue:
    """Rainflow cycles of a record. channel : what is counted, in `unit`; on : of a stress, the place and the plane.

    ranges [n] : upper ends of equal classes [unit]. counts [n] : cycles in each, halves among them; damage summed from
    these is too high, as every range is rounded up. damage : of one record by Miner's rule [1], of the ranges
    themselves; None without an S-N line.

    converged : False where it rests on a peak that changes with the modes or the mesh. largest_modes_alone [unit],
    damage_modes_alone : of the history without residual vectors; None without any. damage_beside : of a stress that is
    uneven, with what it is one cell further or in another of the cells that meet at its place; None of others.
    """

    channel: Annotated[str, Reported("1", "What is counted")]
    unit: Annotated[str, Reported("1", "Unit of the ranges")]
    ranges: Annotated[Floats, Reported(OWN_UNIT, _CLASSES, along=("ranges",))]
    counts: Annotated[Floats, Reported("1", "Cycles, halves among them", along=("ranges",))]
    largest: Annotated[float, Reported(OWN_UNIT, "Largest range", key="largest_range")]
    damage: Annotated[float | None, Reported("1", "Damage of one record by Miner's rule")] = None
    on: Annotated[str, Reported("1", "Place and plane of a stress")] = ""
    converged: Annotated[bool, Reported("1", "Whether modes left out and the mesh change little of it")] = True
    largest_modes_alone: Annotated[float | None, Reported(OWN_UNIT, "Largest range without residual vectors")] = None
    damage_modes_alone: Annotated[float | None, Reported("1", "Damage without residual vectors")] = None
    damage_beside: Annotated[float | None, Reported("1", "Damage with the stress that the mesh may have as well")] = (
        None
    )

    @property
    def cycles(self) -> Annotated[float, Reported("1", "Cycles, halves among them")]:
        """How many cycles [1]."""
        return float(self.counts.sum())

    @property
    def life(self) -> Annotated[float | None, Reported("1", "Records until a damage of 1", key="records_to_failure")]:
        """How often the record may come until the damage is 1; None without an S-N line, and for ever."""
        return 1.0 / self.damage if self.damage else None


class Cycles(NamedTuple):
    """ranges [n], counts [n] : of every cycle, 1 or 0.5."""

    ranges: Floats
    counts: Floats

    def damage(self, line: SNLine) -> float:
        """The sum of counts over the cycles endured [1]: M. A. Miner, J. Applied Mechanics 12 (1945) A159-A164."""
        return float((self.counts / line.endured(self.ranges)).sum())

    @property
    def largest(self) -> float:
        """The largest range."""
        return float(self.ranges.max(initial=0.0))


def rainflow_cycles(history: Floats) -> Cycles:
    """Cycles of a history [nt] by the rainflow method of ASTM E1049-85, section 5.4.4; what does not close counts half.

    >>> rainflow_cycles(np.array([0.0, 2.0, 1.0, 3.0, 0.0]))
    Cycles(ranges=array([1., 3., 3.]), counts=array([1. , 0.5, 0.5]))
    """
    from rainflow import extract_cycles  # few studies count cycles

    kept = np.concatenate([[True], np.diff(history) != 0.0])
    moving = history[kept]
    steps = np.sign(np.diff(moving))
    turns = np.concatenate([[True], steps[1:] != steps[:-1], [True]]) if len(moving) > 1 else np.ones(len(moving), bool)
    found = [(size, count) for size, _, count, _, _ in extract_cycles(moving[turns].tolist())]
    ranges, counts = np.array(found, dtype=np.float64).reshape(-1, 2).T
    return Cycles(ranges, counts)


def counted(
    channel: str, unit: str, history: Floats, line: SNLine | None, on: str = "", alone: Floats | None = None
) -> Fatigue:
    """Rainflow cycles of a history [nt] [unit] and what they do by an S-N line.

    Parameters
    ----------
    alone : Floats | None
        Without residual vectors.
    """
    found = _fatigue_of(channel, unit, rainflow_cycles(history), line, on)
    return found if alone is None else _beside_modes_alone(found, rainflow_cycles(alone), line)


def counted_on_planes(
    channel: str,
    stresses: Floats,
    components: tuple[str, ...],
    line: SNLine | None,
    place: str,
    alone: Floats | None = None,
    uneven: float = 0.0,
    axes: Floats | None = None,
) -> Fatigue:
    """The same of the normal stress on the worst of many planes.

    stresses [c, nt] [Pa] : components at one place.

    Parameters
    ----------
    alone : Floats | None [c, nt]
        The same without residual vectors. On a face planes stand on it, 5 degrees apart; in a solid they are spread
        over all directions. The worst has the most damage; without an S-N line the largest range.
    uneven : float
        The share of the stress that the mesh leaves open, 0 if little.
    axes : Floats | None
        Local ones of the components [3, 3], its rows; None for global ones.
    """
    normals = normals_of(components)
    worst = _worst_plane(plane_weights(normals, components) @ stresses, line, -np.inf)
    assert worst is not None  # there are planes
    found = _fatigue_of(channel, "Pa", worst[2], line, f"{place}, {plane(normals[worst[1]], axes)}")
    if uneven > 0.0 and line is not None:
        smaller = worst[2]._replace(ranges=(1.0 - uneven) * worst[2].ranges)
        found = replace(found, damage_beside=smaller.damage(line))
    if alone is None:
        return found
    history = plane_weights(normals[[worst[1]]], components)[0] @ alone
    return _beside_modes_alone(found, rainflow_cycles(history), line)


def most_damaged(rows: Floats, q: Floats, components: tuple[str, ...], line: SNLine | None) -> int:
    """The place with the most damage on its worst plane, without an S-N line the largest range.

    Parameters
    ----------
    rows : Floats [p, c, k]
        Stress components of every place by modal coordinates.
    q : Floats [k, nt]
        These.

    Notes
    -----
    A cycle of a range r takes 2 r of the variation V of a history, the sum of all its rises and falls, and no range is
    above its largest R: damage is at most V / 2 R times that of R, where lines are as steep as 1 or more. On a plane R
    and V are at most the sums of those of the components. Places are counted in the order of this bound, until it is
    below what was found: the others cannot have more.
    """
    weights = plane_weights(normals_of(components), components)
    bounds = np.empty(len(rows))
    step = max(1, AT_ONCE // max(len(components) * q.shape[1], 1))
    for first in range(0, len(rows), step):
        stresses = np.einsum("pck,kt->pct", rows[first : first + step], q, optimize=True)
        sizes, moved = np.ptp(stresses, axis=2), np.abs(np.diff(stresses, axis=2)).sum(axis=2)
        bounds[first : first + step] = _bound(sizes @ np.abs(weights).T, moved @ np.abs(weights).T, line).max(axis=1)
    found, largest = 0, -np.inf
    for place in np.argsort(-bounds, kind="stable"):
        if bounds[place] <= largest:
            break
        worst = _worst_plane(weights @ (rows[place] @ q), line, largest)
        if worst is not None:
            found, largest = int(place), worst[0]
    return found


def _bound(ranges: Floats, moved: Floats, line: SNLine | None) -> Floats:
    """What histories can have at most, by their largest ranges and their variation: damage, or the range."""
    if line is None:
        return ranges
    if line.slope < 1.0:
        return np.full_like(ranges, np.inf)
    cycles = np.divide(moved, 2.0 * ranges, out=np.zeros_like(ranges), where=ranges > 0.0)
    bound: Floats = (1.0 + ROUNDING) * cycles / line.endured(ranges)
    return bound


def _worst_plane(histories: Floats, line: SNLine | None, above: float) -> tuple[float, int, Cycles] | None:
    """What the worst of histories [n, nt] has, its number and cycles; None where none has more than `above`."""
    bounds = _bound(np.ptp(histories, axis=1), np.abs(np.diff(histories, axis=1)).sum(axis=1), line)
    worst: tuple[float, int, Cycles] | None = None
    for number in np.argsort(-bounds, kind="stable"):
        if bounds[number] < above:
            break
        cycles = rainflow_cycles(histories[number])
        size = cycles.largest if line is None else cycles.damage(line)
        if size > above:
            worst, above = (size, int(number), cycles), size
    return worst


def _beside_modes_alone(found: Fatigue, alone: Cycles, line: SNLine | None) -> Fatigue:
    damage = None if line is None else alone.damage(line)
    return replace(found, largest_modes_alone=alone.largest, damage_modes_alone=damage)


def _fatigue_of(channel: str, unit: str, cycles: Cycles, line: SNLine | None, on: str) -> Fatigue:
    largest = cycles.largest
    ends = largest * np.arange(1, BINS + 1) / BINS
    which = np.minimum(np.searchsorted(ends, cycles.ranges * (1.0 - 1e-12)), BINS - 1)
    counts = np.bincount(which, weights=cycles.counts, minlength=BINS).astype(np.float64)
    return Fatigue(channel, unit, ends, counts, largest, None if line is None else cycles.damage(line), on)


def plane(normal: Floats, axes: Floats | None) -> str:
    """A plane in words, by its normal in global components.

    Parameters
    ----------
    axes : Floats | None [3, 3]
        Rows are the local axes of the normal [3].

    Examples
    --------
    >>> plane(np.array([0.0, 1.0, 0.0]), np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]]))
    'normal to (0, 0, 1)'
    """
    x, y, z = (normal if axes is None else normal @ axes).round(2) + 0.0
    return f"normal to ({x:g}, {y:g}, {z:g})"


def normals_of(components: tuple[str, ...]) -> Floats:
    """Normals of the planes that are looked at where a stress has these components [n, 3]."""
    return _in_plane() if set(components) <= {"xx", "yy", "xy"} else _anywhere()


def plane_weights(normals: Floats, components: tuple[str, ...]) -> Floats:
    """Normal stresses on planes from components of a stress [n, c]."""
    return np.array([[_weight(one, name) for name in components] for one in normals])


def _weight(normal: Floats, name: str) -> float:
    """What a component of stress adds to the normal stress on a plane."""
    i, j = ("xyz".index(axis) for axis in name)
    return float(normal[i] * normal[j] * (1.0 if i == j else 2.0))


def _in_plane() -> Floats:
    angles = np.pi * np.arange(PLANES) / PLANES
    return np.stack([np.cos(angles), np.sin(angles), np.zeros(PLANES)], axis=1)


def _anywhere() -> Floats:
    """The axes, and unit vectors spread evenly over half a sphere along a spiral [n, 3]."""
    z = (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    turn, radius = _TURN * np.arange(DIRECTIONS), np.sqrt(1.0 - z**2)
    return np.concatenate([np.eye(3), np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1)])


# ----------------------------------------------------------------------------------------------------------------------
# Fatigue under random excitations: how many cycles of which range a power spectral density makes on the average.
# ----------------------------------------------------------------------------------------------------------------------

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

    Parameters
    ----------
    psd : Floats [nf]
        One-sided [unit^2/Hz] at frequency_hz [nf].

    Notes
    -----
    The ranges have Dirlik's density, which was fitted to rainflow counts of simulated processes: T. Dirlik, Application
    of Computers in Fatigue Analysis, University of Warwick (1985). `largest` is the range that is exceeded once. Beside
    counts of 2000 s of simulated noise the damage with slopes of 3 and 5 is right for one hump in the spectrum, 6 and
    8 % low for a flat one, and up to 20 % low for two humps far apart.

    Examples
    --------
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

    Parameters
    ----------
    stresses : np.ndarray [c, nf]
        Complex components per unit of what excites [Pa].
    psd : Floats [nf]
        Of that.
    uneven : float
        The share of the stress that the mesh leaves open, 0 if little.
    axes : Floats | None [3, 3]
        Rows are their local axes; None for global ones.
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


def most_damaged_by_spectra(moments: Floats, components: tuple[str, ...], duration: float, line: SNLine | None) -> int:
    """The place with the most damage on its worst plane, without an S-N line the largest range.

    Parameters
    ----------
    moments : Floats [4, p, c, c]
        Of the components of the stress at every place, of the frequency to the powers of POWERS.

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
    """Dirlik's density of amplitudes over standard deviations, and the share of amplitudes below them.

    Parameters
    ----------
    mean : float
        Mean frequency over that of the peaks. The share is no sum of the density: small ripples can be narrower than
        steps of z.
    """
    g = irregularity
    rayleigh, lower = z * np.exp(-(z**2) / 2.0), -np.expm1(-(z**2) / 2.0)
    if 1.0 - g < _NARROW:
        return rayleigh, lower
    d1, d2, d3, q, r = map(float, _parameters(np.array(mean), np.array(g)))
    found: Floats = d1 / q * np.exp(-z / q) + d2 * z / r**2 * np.exp(-(z**2) / (2.0 * r**2)) + d3 * rayleigh
    return found, -d1 * np.expm1(-z / q) - d2 * np.expm1(-(z**2) / (2.0 * r**2)) + d3 * lower
