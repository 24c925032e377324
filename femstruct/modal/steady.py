"""Steady vibration under harmonic and random loads and on shaken bases: excitations, lines, answers, stresses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import log, log10, sqrt
from threading import Lock
from typing import Annotated, Final, Literal, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.declared import checked
from femstruct.elements.stresses import von_mises, von_mises_in_a_cycle
from femstruct.errors import Finding, InputError
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.frf import Complex, Rows, amplitudes, of_force, of_motion, read_rows
from femstruct.modal.oscillators import eigenvalues
from femstruct.modal.residuals import AXES
from femstruct.model.probe import Probe, StressPlaces
from femstruct.reported import OWN_UNIT, Held, Reported
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# A spectrum as it is given: an amplitude or a power spectral density at some frequencies, and between them.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("spectrum of an excitation/1")
@dataclass(frozen=True)
@checked("spectrum")
class Spectrum:
    """What excites a structure, along frequency: points (frequency [Hz], value), two or more, frequencies rising.

    Between its points the logarithm of the value is straight over the logarithm of the frequency, as slopes in dB per
    octave are meant; below the first and above the last point there is nothing.

    Raises InputError for fewer than two points, frequencies that do not rise from above 0, values not above 0.

    A slope of 3 dB an octave doubles a power spectral density from one octave to the next:

    >>> Spectrum(((20.0, 0.01), (80.0, 0.04))).at(np.array([40.0])).round(9)
    array([0.02])
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        if len(self.points) < 2:
            raise InputError("spectrum", got=f"{len(self.points)} points", expected="two or more")
        before = 0.0
        for frequency, value in self.points:
            if not frequency > before:
                got = f"{frequency:g} Hz after {before:g} Hz"
                raise InputError("spectrum", got=got, expected="frequencies that rise from above 0 Hz")
            if not value > 0.0:
                raise InputError("spectrum", got=f"{value:g} at {frequency:g} Hz", expected="values above 0")
            before = frequency

    @property
    def band(self) -> tuple[float, float]:
        """Its first and its last frequency [Hz]."""
        return self.points[0][0], self.points[-1][0]

    def at(self, frequency_hz: Floats) -> Floats:
        """Its values [nf] at frequencies [nf] of its band [Hz]."""
        known, values = np.log(np.array(self.points)).T
        found: Floats = np.exp(np.interp(np.log(frequency_hz), known, values))
        return found


# ----------------------------------------------------------------------------------------------------------------------
# A spectrum as analysers measure it: rms values in octaves or third octaves.
# ----------------------------------------------------------------------------------------------------------------------

Fraction = Literal[1, 3]


@stored_as("band spectrum/1")
@dataclass(frozen=True)
@checked("spectrum")
class BandSpectrum:
    """Root mean squares in bands: values (nominal centre [Hz], rms [N] of forces, [m/s] of velocities), centres rising;
    fraction : 3 for third octaves, 1 for octaves.

    Within a band the power spectral density is taken to be the same at all frequencies; between bands that are not
    beside each other, and beyond the first and the last, there is nothing.

    Raises InputError for no band, centres that do not rise or are none, values below 0.

    A force of 3 N in the third octave at 100 Hz, which is 23.2 Hz wide:

    >>> force = BandSpectrum(((100.0, 3.0),))
    >>> force.edges.round(2).tolist(), force.psd.round(3).tolist()
    ([[89.13, 112.2]], [0.39])
    """

    values: tuple[tuple[float, float], ...]
    fraction: Fraction = 3

    def __post_init__(self) -> None:
        if not self.values:
            raise InputError("spectrum", got="no bands", expected="one or more")
        steps = [10.0 * log10(centre / 1000.0) if centre > 0.0 else 0.1 for centre, _ in self.values]
        for (centre, value), step in zip(self.values, steps, strict=True):
            octave = self.fraction == 3 or round(step) % 3 == 0
            if abs(step - round(step)) > 0.1 or not octave:
                expected = f"nominal centres of {'third octaves' if self.fraction == 3 else 'octaves'}"
                raise InputError("spectrum", got=f"a band at {centre:g} Hz", expected=expected)
            if not value >= 0.0:
                raise InputError("spectrum", got=f"{value:g} at {centre:g} Hz", expected="values of 0 or more")
        if any(not round(b) > round(a) for a, b in pairwise(steps)):
            raise InputError("spectrum", got="bands that do not rise", expected="each band once, rising")

    @property
    def edges(self) -> Floats:
        """Lower and upper edge of every band [n, 2] [Hz], of exact centres 1000 x 10^(k/10)."""
        half = 0.05 if self.fraction == 3 else 0.15
        steps = np.round(10.0 * np.log10(np.array([centre for centre, _ in self.values]) / 1000.0)) / 10.0
        found: Floats = 1000.0 * 10.0 ** (steps[:, None] + np.array([-half, half]))
        return found

    @property
    def band(self) -> tuple[float, float]:
        """From the lower edge of its first band to the upper edge of its last [Hz]."""
        edges = self.edges
        return float(edges[0, 0]), float(edges[-1, 1])

    @property
    def psd(self) -> Floats:
        """Power spectral density in every band, one-sided [n]: its mean square over its width."""
        edges = self.edges
        found: Floats = np.array([value for _, value in self.values]) ** 2 / (edges[:, 1] - edges[:, 0])
        return found


# ----------------------------------------------------------------------------------------------------------------------
# What excites a structure and what is looked at of it, in modal coordinates.
# ----------------------------------------------------------------------------------------------------------------------

_RIGID = 1e-6  # of the mass: what a rigid mode has of it along an axis that the structure is held in is rounding


@dataclass(frozen=True, eq=False)
class Excitation:
    """What excites a structure: pushed [k] : modal forces per unit of it. probe : a force or a pressure there [N, Pa];
    None for a base with the acceleration along `axis` [m/s^2]."""

    pushed: Floats
    probe: Probe | None = None
    axis: int | None = None


@dataclass(frozen=True, eq=False)
class Looked:
    """Something that is looked at: rows of modal coordinates, differentiated `rate` times; rigid : the share of the
    motion of a base that it has itself; direct : what passes on of what excites without any motion."""

    rows: Rows
    rate: int = 0
    rigid: float = 0.0
    direct: float = 0.0

    def of(self, q: Complex, omega: Floats) -> Complex:
        """Its transfer function [lines] from modal coordinates [lines, k] at omega [lines], all above 0."""
        turning = 1j * omega
        moved = read_rows(self.rows, q, omega) + self.rigid / turning**2
        return np.asarray(turning**self.rate * moved + self.direct, dtype=np.complex128)


def force_excitation(basis: ModalBasis, probe: Probe) -> Excitation:
    """A force [N] at a probe, or a pressure [Pa] at that of a surface."""
    return Excitation(probe.of(basis.shapes), probe)


def base_excitation(basis: ModalBasis, axis: str, where: str) -> Excitation:
    """A base that moves along x, y or z, and with it all that stands on the ground: supports, springs, foundations.

    Modal coordinates are of the motion on the base: M u'' + C u' + K u = -M r a, so their forces are the momenta of the
    modes along r, a rigid translation, with the other sign. Losses belong to the motion on the base.

    Raises InputError, from `where`, if the structure is free to stay behind, or nothing of it moves along that axis.

    >>> from femstruct.modal.closed_form import oscillator
    >>> basis, _ = oscillator(4.0, stiffness=100.0)
    >>> base_excitation(basis, "x", "vibration.shaker").pushed
    array([-2.])
    """
    number = AXES.index(axis)
    momentum = basis.momentum[number]
    free = np.array([kind == "rigid" for kind in basis.kind], dtype=bool)
    if (momentum[free] ** 2).sum() > _RIGID * basis.total_mass:
        raise InputError(
            where,
            got=f"a structure that is free to stay behind along {axis}",
            expected=f"supports or springs to the ground that hold it along {axis}",
            do="a base moves what stands on the ground; a free structure is excited by a force",
        )
    if not np.abs(momentum).max(initial=0.0) > 0.0:
        got = f"a structure of which no mode has a momentum along {axis}"
        raise InputError(where, got=got, expected="an axis along which the base can move it")
    return Excitation(-momentum, axis=number)


def motion(excitation: Excitation, basis: ModalBasis, probe: Probe, rate: int, relative: bool = False) -> Looked:
    """A displacement (rate 0), velocity (1) or acceleration (2) at a probe.

    Parameters
    ----------
    relative : bool
        To the base that moves.
    """
    along = probe.weights[probe.components == excitation.axis].sum() if excitation.axis is not None else 0.0
    return Looked(of_motion(probe.of(basis.shapes)), rate, 0.0 if relative else float(along))


def force(excitation: Excitation, basis: ModalBasis, row: ForceRow) -> Looked:
    """A force of the structure."""
    if excitation.axis is not None:
        return Looked(of_force(basis, row), direct=float(row.carried[excitation.axis]))
    assert excitation.probe is not None
    return Looked(of_force(basis, row), direct=row.direct.meets(excitation.probe))


def transfers(basis: ModalBasis, excitation: Excitation, looked: Sequence[Looked], frequency_hz: Floats) -> Complex:
    """Transfer functions [n, nf] of all that is looked at, per unit of what excites.

    A base under an oscillator at its resonance, with 1 % of damping: the mass accelerates by
    sqrt(1 + 4 zeta^2) / 2 zeta of it:

    >>> from femstruct.modal.closed_form import oscillator
    >>> from femstruct.modal.damping import Damping, Ratio, with_damping
    >>> bare, points = oscillator(2.0, frequency_hz=10.0)
    >>> basis = with_damping(bare, Damping(Ratio(0.01)))
    >>> shaker = base_excitation(basis, "x", "vibration.shaker")
    >>> seen = motion(shaker, basis, points["m"].probe("x"), rate=2)
    >>> float(abs(transfers(basis, shaker, [seen], np.array([10.0]))[0, 0]).round(3))
    50.01
    """
    omega = 2.0 * np.pi * frequency_hz
    found: Complex = np.empty((len(looked), len(omega)), dtype=np.complex128)
    for lines, q in amplitudes(basis, excitation.pushed, omega):
        for number, one in enumerate(looked):
            found[number, lines] = one.of(q, omega[lines])
    return found


# ----------------------------------------------------------------------------------------------------------------------
# Where a structure resonates and how sharply, also where its damping couples modes.
# ----------------------------------------------------------------------------------------------------------------------

BARE: Final = 1e-10  # of a frequency: a half-power bandwidth below it is rounding of an eigenvalue


class Resonances(NamedTuple):
    """hz [n] : natural frequencies [Hz]. half [n] : half of their half-power bandwidths, zeta f [Hz]; 0 undamped."""

    hz: Floats
    half: Floats

    def inside(self, low: float, high: float) -> Resonances:
        """Those in a band [Hz], without its ends."""
        kept = (self.hz > low) & (self.hz < high)
        return Resonances(self.hz[kept], self.half[kept])


_found: Final[WeakKeyDictionary[ModalBasis, Resonances]] = WeakKeyDictionary()  # each response of a study asks
_lock: Final = Lock()


def resonances(basis: ModalBasis) -> Resonances:
    """Resonances of a basis: its elastic modes, or where damping couples modes the motions that swing then.

    Notes
    -----
    A strong dashpot holds the place it acts on: the structure then resonates, with little damping, where none of the
    modes does that are free there, and what the diagonal of the damping says of these is the damping of no motion.

    A mass of 1 kg on a spring of 100 N/m to a plate of 1 kg that oil of 1000 N s/m holds resonates at 10 rad/s:

    >>> from dataclasses import replace
    >>> from femstruct.modal.closed_form import given_modes
    >>> squares, shapes = np.linalg.eigh([[200.0, -100.0], [-100.0, 100.0]])
    >>> basis, _ = given_modes(np.sqrt(squares) / 2 / np.pi, [0.0, 0.0], {"plate": shapes[0], "mass": shapes[1]})
    >>> found = resonances(replace(basis, viscous=1000.0 * np.outer(shapes[0], shapes[0])))
    >>> (2 * np.pi * found.hz).round(3), (found.half / found.hz).round(4)
    (array([10.]), array([0.005]))
    """
    with _lock:
        if basis not in _found:
            _found[basis] = _of_coupled(basis) if _coupled(basis) else uncoupled_resonances(basis)
        return _found[basis]


def uncoupled_resonances(basis: ModalBasis) -> Resonances:
    """The elastic modes of a basis with what is their own of its damping, whatever couples them."""
    elastic = np.array([kind == "elastic" for kind in basis.kind], dtype=bool)
    return _resonances_of(basis.frequency_hz[elastic], (basis.damping_ratio * basis.frequency_hz)[elastic])


def _coupled(basis: ModalBasis) -> bool:
    damping = basis.time_damping
    return bool((damping - np.diag(np.diag(damping))).any())


def _of_coupled(basis: ModalBasis) -> Resonances:
    values = eigenvalues(basis.omega, basis.time_damping) / (2.0 * np.pi)
    swings = values[values.imag > 0.0]
    found, top = _resonances_of(np.abs(swings), -swings.real), float(uncoupled_resonances(basis).hz.max(initial=0.0))
    true = (found.half > 0.0) | (found.hz <= top * (1.0 + BARE))  # an undamped residual vector is no resonance
    return Resonances(found.hz[true], found.half[true])


def _resonances_of(hz: Floats, half: Floats) -> Resonances:
    return Resonances(hz, np.where(half > BARE * hz, half, 0.0))


# ----------------------------------------------------------------------------------------------------------------------
# Lines along frequency that are as dense as the resonances of a structure are sharp.
# ----------------------------------------------------------------------------------------------------------------------

FINENESS: Final = 24.0
"""Lines in half the half-power bandwidth of a mode, or in the distance to it: the mean square of one oscillator under
white noise is then within 1e-3 of its closed form."""
MOST_LINES: Final = 1_000_000


def resonant_lines(
    basis: ModalBasis,
    band: tuple[float, float],
    also: tuple[float, ...] = (),
    fineness: float = FINENESS,
    more: Resonances | None = None,
) -> Floats:
    """Frequencies [nf] [Hz] that follow every resonance of a basis in a band, rising, both ends among them.

    Parameters
    ----------
    also : tuple[float, ...]
        Further frequencies in the band, such as the points of a spectrum.
    fineness : float
        Of a mean square the error goes with one over its square.
    more : Resonances | None
        Further resonances, as of a structure with a source on it.

    Raises
    ------
    InputError
        Where that would be more than a million, as with hardly any damping.

    Notes
    -----
    At a frequency f lines are 1/24 of the least of three apart: f, and of the nearest resonance half its half-power
    bandwidth zeta f_r and the distance |f - f_r| together (the root of the sum of squares). All natural frequencies in
    the band are lines. Where damping couples modes, resonances are where the structure swings with it.

    Examples
    --------
    >>> from femstruct.modal.closed_form import given_modes
    >>> basis, _ = given_modes([50.0], [0.01], {"P": [1.0]})
    >>> lines = resonant_lines(basis, (10.0, 100.0))
    >>> float(lines[0]), float(lines[-1]), 50.0 in lines, int(((lines > 49.5) & (lines < 50.5)).sum())
    (10.0, 100.0, True, 43)
    """
    low, high = band
    all_of_them = resonances(basis)
    damped = all_of_them.half > 0.0
    modes, half = all_of_them.hz[damped], all_of_them.half[damped]
    if more is not None:
        modes, half = np.append(modes, more.hz), np.append(half, more.half)
    found, f = [low], low
    while f < high:
        nearest = float(np.sqrt((modes - f) ** 2 + half**2).min(initial=np.inf))
        f += min(f, nearest) / fineness
        found.append(f)
        if len(found) > MOST_LINES:
            got = f"more than {MOST_LINES:,} lines to follow its resonances from {low:g} to {high:g} Hz"
            raise InputError("vibration", got=got, expected="more damping, or a narrower band")
    inside = [*found[:-1], *modes[(modes > low) & (modes < high)].tolist(), *also]
    lines: Floats = np.unique(np.array([*(one for one in inside if low <= one < high), high]))
    return lines


# ----------------------------------------------------------------------------------------------------------------------
# The largest value of a frequency response, also between its lines, and whether its lines show it.
# ----------------------------------------------------------------------------------------------------------------------

MISSED: Final = 0.05  # of the largest value, by which the lines may be lower
PLACES: Final = 8  # the highest lines and natural frequencies, around which is looked
NARROWER: Final = 128  # times as narrow is the next round: where damping couples modes, rounds cost, and lines do not
AROUND: Final = np.linspace(-1.0, 1.0, 2 * NARROWER + 1)  # of a width
ROUNDS: Final = 2  # 128^-2 of a step: 1e-6 of a peak whose half-power bandwidth is a twentieth of the step
FOLLOWED: Final = 1000  # modes, up to which their coupling by damping is looked into: 6 s, and 90 s of 2,400
DIGITS: Final = (5.0, 2.0, 1.0)  # of a step that is proposed

Respond = Callable[[Floats], Complex]


@stored_as("largest value between lines/1")
@dataclass(frozen=True)
class Highest:
    """The largest value of a response in a band, on its lines or between them.

    frequency_hz : where [Hz]. size : magnitude there. line : the largest magnitude on a line. step : from line to line
    [Hz]. needed : a step [Hz] that shows the value to 5 %; that of the lines where they do.
    """

    frequency_hz: float
    size: float
    line: float
    step: float
    needed: float

    @property
    def missed(self) -> float:
        """Share of the value by which the lines are lower [1]."""
        return 1.0 - self.line / self.size if self.size > 0.0 else 0.0

    def on(self, lines_hz: Floats, sizes: Floats) -> Highest:
        """The same of finer lines in that band, where its own lines miss it.

        Parameters
        ----------
        lines_hz : Floats [nf]
            Equally spaced [Hz].
        sizes : Floats [nf]
            Magnitudes there.

        Examples
        --------
        >>> Highest(11.97, 0.0342, 0.0116, 1.0, 0.2).on(np.array([11.8, 12.0, 12.2]), np.array([0.01, 0.0335, 0.02]))
        Highest(frequency_hz=11.97, size=0.0342, line=0.0335, step=0.2, needed=0.2)
        """
        top = int(sizes.argmax())
        line, step = float(sizes[top]), round(float(lines_hz[1] - lines_hz[0]), 12)
        hz, size = (self.frequency_hz, self.size) if self.size >= line else (float(lines_hz[top]), line)
        return Highest(hz, size, line, step, step if line >= (1.0 - MISSED) * size else self.needed)


def largest_peak(respond: Respond, basis: ModalBasis, lines_hz: Floats, sizes: Floats) -> Highest | None:
    """The largest response in the band of some lines, by what lies between them, too.

    Parameters
    ----------
    respond : Respond
        Values [n] at frequencies [n] [Hz].
    lines_hz : Floats [nf]
        Equally spaced [Hz].
    sizes : Floats [nf]
        Magnitudes there. None where there is no such number: one line or none, or a mode without damping in the band.

    Notes
    -----
    Looked for around the highest lines and natural frequencies, so that a resonance much narrower than the step is
    found; where damping couples up to 1000 modes, around the frequencies at which they swing with it. What is no
    resonance of the structure and narrower than the step can be missed: a transmissibility is largest where the driven
    point stands still.

    Examples
    --------
    >>> from femstruct.modal.closed_form import oscillator
    >>> from femstruct.modal.damping import Damping, LossFactor, with_damping
    >>> from femstruct.modal.frf import frf
    >>> basis, points = oscillator(2.0, stiffness=50.0)
    >>> damped, here = with_damping(basis, Damping(LossFactor(0.04))), points["m"].probe("x")
    >>> lines = np.array([0.5, 0.7, 0.9])
    >>> found = largest_peak(lambda f: frf(damped, here, here, f), damped, lines, abs(frf(damped, here, here, lines)))
    >>> round(found.size, 9), round(found.missed, 2), found.needed
    (0.5, 0.83, 0.01)
    """
    low, high = (float(one) for one in lines_hz[[0, -1]]) if len(lines_hz) else (0.0, 0.0)
    own, half = (resonances if len(basis.omega) <= FOLLOWED else uncoupled_resonances)(basis).inside(low, high)
    if len(lines_hz) < 2 or (half <= 0.0).any():
        return None
    step = float(lines_hz[1] - low)
    hz = np.concatenate((lines_hz, own))
    values = np.concatenate((sizes, np.abs(respond(own))))
    width = np.concatenate((np.full(len(sizes), step), np.minimum(step, 2.0 * half)))
    best = np.argsort(values)[-PLACES:]
    hz, values, width = hz[best], values[best], width[best]
    for _ in range(ROUNDS):
        tried = np.clip(hz[:, None] + width[:, None] * AROUND, low, high)
        found = np.abs(respond(tried.ravel())).reshape(tried.shape)
        at = found.argmax(axis=1)[:, None]
        hz, values = (np.take_along_axis(one, at, 1)[:, 0] for one in (tried, found))
        width = width / NARROWER
    top, line = int(values.argmax()), float(sizes.max())
    size = float(values[top])
    shown = line >= (1.0 - MISSED) * size
    needed = step if shown else _step_for(respond, float(hz[top]), (1.0 - MISSED) * size, lines_hz)
    return Highest(float(hz[top]), size, line, step, needed)


def missed_peak(one: Highest | None, unit: str) -> tuple[Finding, ...]:
    """A finding where the lines of a response are lower than its largest value by more than 5 %.

    Parameters
    ----------
    unit : str
        Of the values.

    Examples
    --------
    >>> missed_peak(Highest(11.97, 0.0342, 0.0116, 1.0, 0.2), "m/(N s^2)")[0].values["needed_hz"]
    0.2
    """
    if one is None or one.missed <= MISSED:
        return ()
    size, line = (f"{value:.3g} {unit}".removesuffix(" 1") for value in (one.size, one.line))
    message = (
        f"the largest value, {size} at {one.frequency_hz:.5g} Hz, is between two lines. The lines are {one.step:g} Hz "
        f"apart, and the largest value on one is {line}, {100.0 * one.missed:.0f} % lower. "
        f"Use a step of {one.needed:g} Hz or less"
    )
    values = {"peak": one.size, "peak_hz": one.frequency_hz, "largest_line": one.line}
    return (Finding("peak-between-lines", message, values | {"step_hz": one.step, "needed_hz": one.needed}),)


def _step_for(respond: Respond, peak_hz: float, least: float, lines_hz: Floats) -> float:
    """The largest step [Hz] of one digit whose lines are never so far from a peak that they are below `least`."""
    step = lines_hz[1] - lines_hz[0]
    decades = 10.0 ** (np.floor(np.log10(step)) - np.arange(8.0))
    steps = (decades[:, None] * DIGITS).ravel()
    steps = steps[steps < step]
    ends = np.clip(peak_hz + np.array([[-0.5], [0.5]]) * steps, lines_hz[0], lines_hz[-1])
    enough = (np.abs(respond(ends.ravel())).reshape(ends.shape) >= least).all(axis=0)
    return float(steps[enough.argmax() if enough.any() else -1])


# ----------------------------------------------------------------------------------------------------------------------
# What a structure answers to harmonic and random excitations, and the numbers an engineer asks of it.
# ----------------------------------------------------------------------------------------------------------------------

FEWEST: Final = 10.0  # crossings of zero upwards in a duration: of fewer the largest has no such distribution
_EULER: Final = 0.5772156649015329
_LINES: Final = ("frequency_hz",)


@stored_as("harmonic answer/1")
@dataclass(frozen=True, eq=False)
class HarmonicAnswer:
    """One thing under a harmonic excitation. values [nf] : its complex amplitude, in `unit`; of an equivalent stress,
    which is no harmonic, the largest of a cycle. where : the place of the largest, "" of a channel that has one place.
    """

    unit: Annotated[str, Reported("1", "Unit of the amplitude")]
    frequency_hz: Floats
    values: Complex
    where: Annotated[str, Reported("1", "Where it is largest")] = ""

    @property
    def largest(self) -> Annotated[float, Reported(OWN_UNIT, "Largest amplitude")]:
        """Largest amplitude along frequency [unit]."""
        return float(np.abs(self.values).max())

    @property
    def largest_at_hz(self) -> Annotated[float, Reported("Hz", "Where the amplitude is largest")]:
        """Where it is largest [Hz]."""
        return float(self.frequency_hz[np.abs(self.values).argmax()])


@stored_as("random answer/1")
@dataclass(frozen=True, eq=False)
class RandomAnswer:
    """One thing under a stationary random excitation of mean zero.

    unit : of rms and peak. psd [nf] : its power spectral density, one-sided [unit^2/Hz]. rms [unit]. crossings : how
    often it crosses zero upwards [Hz]; None of an equivalent stress, which does not. peak : the expected largest in
    the duration [unit]; None without a duration, of an equivalent stress, and with fewer than ten crossings in it.
    where, place : the place of the largest rms of a stress and its number, "" of a channel that has one place. uneven :
    the share of a stress that the mesh leaves open there, 0 if little.
    """

    unit: Annotated[str, Reported("1", "Unit of rms and peak")]
    frequency_hz: Floats
    psd: Floats
    rms: Annotated[float, Reported(OWN_UNIT, "Root mean square")]
    crossings: Annotated[float | None, Reported("Hz", "Zero-upcrossing frequency", key="zero_upcrossings_hz")] = None
    peak: Annotated[float | None, Reported(OWN_UNIT, "Expected largest in the duration", key="expected_peak")] = None
    where: Annotated[str, Reported("1", "Where it is largest")] = ""
    place: int = 0
    uneven: float = 0.0


@stored_as("moved mass/1")
@dataclass(frozen=True, eq=False)
class MovedMass:
    """What of a structure the modes of a basis let a base move along one axis.

    frequency_hz [k] : of the true modes. mass [k] : their effective masses [kg]. total : of the structure [kg].
    """

    axis: Annotated[str, Reported("1", "Axis along which the base moves")]
    frequency_hz: Annotated[Floats, Reported("Hz", "Natural frequency", along=("mode",))]
    mass: Annotated[Floats, Reported("kg", "Effective mass", along=("mode",))]
    total: Annotated[float, Reported("kg", "Mass of the structure", key="total_mass_kg")]

    @property
    def moved(self) -> Annotated[float, Reported("kg", "Sum of the effective masses", key="effective_mass_kg")]:
        """Their sum [kg]."""
        return float(self.mass.sum())

    @property
    def share(self) -> Annotated[float, Reported("1", "Sum of the effective masses over the mass")]:
        """Their sum over the mass of the structure [1]."""
        return self.moved / self.total if self.total > 0.0 else 0.0


@stored_as("answers to a vibration/1")
@dataclass(frozen=True, eq=False)
class Vibrated:
    """What came of one excitation. kind : "harmonic", an amplitude, or "psd", a power spectral density of it.

    excited_by : where it acts. unit : of `excitation` [nf], its values along frequency_hz [nf] [Hz]. answers : by
    channel, "middle.z acceleration" and, of a base, "middle.z acceleration relative to the base". base : if it moves.
    """

    kind: Annotated[Literal["harmonic", "psd"], Reported("1", "Harmonic or random (psd)")]
    excited_by: Annotated[str, Reported("1", "Where it acts")]
    unit: Annotated[str, Reported("1", "Unit of the excitation")]
    frequency_hz: Annotated[Floats, Reported("Hz", "Frequency, lines as dense as resonances need", along=_LINES)]
    excitation: Annotated[Floats, Reported(OWN_UNIT, "What excites", along=_LINES)]
    answers: Annotated[
        Mapping[str, HarmonicAnswer | RandomAnswer], Held("What answers, by channel", "What one channel answers")
    ] = field(default_factory=dict)
    base: Annotated[MovedMass | None, Held("What of the structure a base moves")] = None


def with_axis(channel: str, unit: str) -> str:
    """The name of a channel as it is shown: that of a force along z, which has a plain name, with its axis.

    >>> with_axis("west force", "N"), with_axis("west force x", "N"), with_axis("tip.z velocity", "m/s")
    ('west force z', 'west force x', 'tip.z velocity')
    """
    return f"{channel} z" if unit == "N" and channel.endswith(" force") else channel


def random_answer(
    unit: str, transfer: Complex, excitation: Floats, frequency_hz: Floats, duration: float | None = None
) -> RandomAnswer:
    """What a linear thing answers to a power spectral density.

    Parameters
    ----------
    transfer : Complex [nf]
        Its transfer function [unit per unit of what excites].
    excitation : Floats [nf]
        The power spectral density of that, one-sided [its unit^2/Hz].
    duration : float | None [s]
        For the expected largest.

    Notes
    -----
    |H|^2 S, and its moments by the trapezoidal rule along lines that follow the resonances (`resonant_lines`). Zero is
    crossed upwards sqrt(m2 / m0) times a second (S. O. Rice, Bell System Technical Journal 24 (1945) 46-156). The
    expected largest of a Gaussian one is rms (g + 0.5772 / g), g = sqrt(2 ln(crossings x duration)): A. G. Davenport,
    Proc. Institution of Civil Engineers 28 (1964) 187-196.

    Examples
    --------
    White noise from 0 to 100 Hz of 1 unit^2/Hz as it is:

    >>> lines = np.linspace(1e-9, 100.0, 2001)
    >>> found = random_answer("N", np.ones(2001, complex), np.ones(2001), lines, duration=100.0)
    >>> round(found.rms, 3), round(found.crossings, 2), round(found.peak / found.rms, 2)
    (10.0, 57.74, 4.3)
    """
    psd: Floats = np.abs(transfer) ** 2 * excitation
    square = float(np.trapezoid(psd, frequency_hz))
    if not square > 0.0:
        return RandomAnswer(unit, frequency_hz, psd, 0.0)
    crossings = sqrt(float(np.trapezoid(frequency_hz**2 * psd, frequency_hz)) / square)
    peak = None
    if duration is not None and crossings * duration >= FEWEST:
        g = sqrt(2.0 * log(crossings * duration))
        peak = sqrt(square) * (g + _EULER / g)
    return RandomAnswer(unit, frequency_hz, psd, sqrt(square), crossings, peak)


# ----------------------------------------------------------------------------------------------------------------------
# The equivalent stress of von Mises under harmonic and random excitations, over all places of a part.
# ----------------------------------------------------------------------------------------------------------------------

AT_ONCE: Final = 2_000_000
"""Complex stresses that are evaluated at once, 32 MB: of all places at as many lines as that makes."""
_NOTHING: Final = 1e-14  # of the largest eigenvalue of a covariance: the others are its rounding

Amount = Callable[[Floats], Floats]
"""From the stresses [p, c, k] of places in the shapes of a basis to their equivalent stress [p]."""


class Stressed(NamedTuple):
    """largest [p] : of every place. along [nf] : over frequency. amount : how `largest` follows from shapes."""

    largest: Floats
    along: Floats
    amount: Amount


def harmonic_stress(
    basis: ModalBasis, excitation: Excitation, places: StressPlaces, amplitude: Floats, frequency_hz: Floats
) -> Stressed:
    """The equivalent stress under a harmonic excitation: the largest of a cycle.

    Parameters
    ----------
    amplitude : Floats [nf]
        Of what excites. along : the largest of all places at each frequency.
    """
    omega = 2.0 * np.pi * frequency_hz
    rows = _with_base(basis, excitation, places)
    count, components, k = rows.shape
    flat = rows.reshape(-1, k)
    along, largest = np.empty(len(omega)), np.full(count, -1.0)
    highest, there = -1.0, np.zeros(k, dtype=np.complex128)
    step = max(1, AT_ONCE // max(1, len(flat)))
    for lines, q in _driven(basis, excitation, omega):
        scaled = q * amplitude[lines, None]
        for first in range(0, len(scaled), step):
            part = scaled[first : first + step]
            stress = (flat @ part.T).reshape(count, components, -1)
            cycle = von_mises_in_a_cycle(stress, places.components)
            along[lines[first : first + step]] = cycle.max(axis=0)
            largest = np.maximum(largest, cycle.max(axis=1))
            if cycle.max() > highest:
                highest = float(cycle.max())
                there = part[int(cycle.max(axis=0).argmax())]

    def amount(stresses: Floats) -> Floats:
        return von_mises_in_a_cycle((stresses @ there[:-1])[:, :, None], places.components)[:, 0]

    return Stressed(largest, along, amount)


def random_stress(
    basis: ModalBasis, excitation: Excitation, places: StressPlaces, psd: Floats, frequency_hz: Floats
) -> Stressed:
    """The equivalent stress under a random excitation: its root mean square.

    Parameters
    ----------
    psd : Floats [nf]
        Of what excites. along : the power spectral density at the place of the largest rms.

    Notes
    -----
    The mean square of the stress of von Mises is the trace of A C, A its quadratic form and C the covariance of the
    stresses: D. J. Segalman, C. W. G. Fulcher, G. M. Reese, R. V. Field, An Efficient Method for Calculating RMS von
    Mises Stress in a Random Vibration Environment, SAND98-0260 (1998). C follows from the covariance of the modal
    coordinates, which is the same for all places.
    """
    omega = 2.0 * np.pi * frequency_hz
    weights = psd * _trapezoids(frequency_hz)
    k = len(basis.omega) + 1
    covariance = np.zeros((k, k))
    for lines, q in _driven(basis, excitation, omega):
        scaled = q * np.sqrt(weights[lines, None])
        covariance += scaled.real.T @ scaled.real + scaled.imag.T @ scaled.imag
    values, vectors = np.linalg.eigh(covariance)
    kept = values > _NOTHING * values.max(initial=0.0)
    columns = vectors[:, kept] * np.sqrt(values[kept])

    def amount(stresses: Floats) -> Floats:
        rms: Floats = np.sqrt((von_mises(stresses @ columns[: stresses.shape[2]], places.components) ** 2).sum(axis=-1))
        return rms

    rows = _with_base(basis, excitation, places)
    largest = amount(rows)
    worst = rows[[int(largest.argmax())]]
    along = np.empty(len(omega))
    for lines, q in _driven(basis, excitation, omega):
        stress = worst @ q.T
        squares = von_mises(stress.real, places.components) ** 2 + von_mises(stress.imag, places.components) ** 2
        along[lines] = squares[0] * psd[lines]
    return Stressed(largest, along, amount)


def stress_components(
    basis: ModalBasis, excitation: Excitation, places: StressPlaces, place: int, frequency_hz: Floats
) -> Complex:
    """Complex components [c, nf] of the stress at one place, per unit of what excites [Pa]."""
    rows = _with_base(basis, excitation, places)[place]
    found: Complex = np.empty((len(rows), len(frequency_hz)), dtype=np.complex128)
    for lines, q in _driven(basis, excitation, 2.0 * np.pi * frequency_hz):
        found[:, lines] = rows @ q.T
    return found


def stress_moments(
    basis: ModalBasis,
    excitation: Excitation,
    places: StressPlaces,
    psd: Floats,
    frequency_hz: Floats,
    powers: tuple[int, ...],
) -> Floats:
    """Spectral moments of the components of the stress at every place [m, p, c, c], of these powers of the frequency
    [Pa^2 Hz^power], in phase.

    Parameters
    ----------
    psd : Floats [nf]
        Of what excites. They follow from those of the modal coordinates.
    """
    k, weights = len(basis.omega) + 1, psd * _trapezoids(frequency_hz)
    moments = np.zeros((len(powers), k, k))
    for lines, q in _driven(basis, excitation, 2.0 * np.pi * frequency_hz):
        for found, power in zip(moments, powers, strict=True):
            scaled = q * np.sqrt(weights[lines] * frequency_hz[lines] ** power)[:, None]
            found += scaled.real.T @ scaled.real + scaled.imag.T @ scaled.imag
    rows = _with_base(basis, excitation, places)
    return np.array([rows @ one @ np.swapaxes(rows, 1, 2) for one in moments])


def _with_base(basis: ModalBasis, excitation: Excitation, places: StressPlaces) -> Floats:
    """Stresses [p, c, k + 1] in the shapes of a basis, and those of bars that are carried along by a base that moves,
    per acceleration of it: zero without one, and for other parts, whose strains have it."""
    rows = places.of(basis.shapes)
    carried = np.zeros((*rows.shape[:2], 1))
    if excitation.axis is not None and places.carried is not None:
        carried[..., 0] = places.carried[..., excitation.axis]
    return np.concatenate([rows, carried], axis=2)


def _driven(basis: ModalBasis, excitation: Excitation, omega: Floats) -> Iterator[tuple[Integers, Complex]]:
    """Lines and modal coordinates there [lines, k + 1], the last one being what excites."""
    for lines, q in amplitudes(basis, excitation.pushed, omega):
        yield lines, np.asarray(np.concatenate([q, np.ones((len(q), 1))], axis=1), dtype=np.complex128)


def _trapezoids(frequency_hz: Floats) -> Floats:
    """Weights [nf] of the trapezoidal rule [Hz]."""
    steps = np.diff(frequency_hz)
    weights = np.zeros(len(frequency_hz))
    weights[:-1] += 0.5 * steps
    weights[1:] += 0.5 * steps
    return weights
