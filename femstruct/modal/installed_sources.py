"""Structure-borne sources in place: mobilities, contact forces, power into a structure, resonances with it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import ClassVar, Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import Positive, checked
from femstruct.errors import InputError
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import Complex, modal_amplitudes
from femstruct.modal.steady import Resonances
from femstruct.model.probe import Probe
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Mobilities of sources at their contacts: what a machine gives way by when the structure below it moves.
# ----------------------------------------------------------------------------------------------------------------------


class SourceMobility(ABC):
    """Mobility of a source at each of its contacts, over frequency; contacts do not act on each other through it.

    has_phase : whether it is known with its phase. band : from where to where it is known [Hz].
    """

    has_phase: ClassVar[bool] = True

    @abstractmethod
    def impedance(self, frequency_hz: Floats) -> Complex:
        """One over it [nf] [N s/m] at frequencies [nf] [Hz]; without phase its magnitude."""

    @property
    def band(self) -> tuple[float, float]:
        """From where to where it is known [Hz]."""
        return 0.0, np.inf


@stored_as("source mobility of a force/1")
@dataclass(frozen=True)
@checked("mobility")
class ForceSource(SourceMobility):
    """A source that gives way without resistance: its blocked force acts on whatever is below it. No free velocity.

    >>> ForceSource().impedance(np.array([100.0])).tolist()
    [0j]
    """

    def impedance(self, frequency_hz: Floats) -> Complex:
        return np.zeros(len(frequency_hz), dtype=np.complex128)


@stored_as("source mobility of a rigid mass/1")
@dataclass(frozen=True)
@checked("mobility")
class RigidMass(SourceMobility):
    """A rigid mass at each contact [kg], as a hammer or a block without springs: Y = 1 / (j omega m).

    Raises InputError for a mass that is not positive.

    >>> RigidMass(0.5).impedance(np.array([100.0])).round(2).tolist()
    [314.16j]
    """

    mass: Positive

    def impedance(self, frequency_hz: Floats) -> Complex:
        return np.asarray(2j * pi * frequency_hz * self.mass, dtype=np.complex128)


@stored_as("source mobility by band/1")
@dataclass(frozen=True)
@checked("mobility")
class BandMobility(SourceMobility):
    """Magnitudes of the mobility by frequency, as EN 15657 states it for equivalent sources: values (frequency [Hz],
    magnitude [m/(N s)]), frequencies rising; between them straight in double logarithmic paper, beyond the first and
    the last by up to half an octave the same.

    Raises InputError for fewer than two values, frequencies that do not rise, and magnitudes that are not positive.

    >>> BandMobility(((100.0, 1e-4), (400.0, 4e-4))).impedance(np.array([200.0])).real.round(6).tolist()
    [5000.0]
    """

    has_phase = False
    values: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        _refuse_values(self.values)

    def impedance(self, frequency_hz: Floats) -> Complex:
        known, values = np.log(np.array(self.values)).T
        return np.asarray(np.exp(-np.interp(np.log(frequency_hz), known, values)), dtype=np.complex128)

    @property
    def band(self) -> tuple[float, float]:
        return self.values[0][0] / 2**0.5, self.values[-1][0] * 2**0.5


@stored_as("measured source mobility/1")
@dataclass(frozen=True)
@checked("mobility")
class MeasuredMobility(SourceMobility):
    """Measured mobility with its phase: lines (frequency [Hz], real, imaginary part [m/(N s)]), e^{+j omega t},
    frequencies rising; straight lines between them.

    Raises InputError for fewer than two lines, frequencies that do not rise, and mobilities whose real part is
    negative by more than 1 % of the magnitude: a source that is at rest gives no energy.

    >>> lines = MeasuredMobility(((50.0, 1e-4, -2e-4), (150.0, 1e-4, 2e-4)))
    >>> lines.impedance(np.array([100.0])).real.round(6).tolist()
    [10000.0]
    """

    lines: tuple[tuple[float, float, float], ...]

    def __post_init__(self) -> None:
        _refuse_values(tuple((f, abs(complex(real, imaginary))) for f, real, imaginary in self.lines))
        for f, real, imaginary in self.lines:
            if real < -0.01 * abs(complex(real, imaginary)):
                got = f"a real part of {real:.3g} m/(N s) at {f:g} Hz"
                do = "correct the sign or the phase: e^{+j omega t}, velocity and force in one direction"
                raise InputError("mobility", got=got, expected="0 or more: a passive source", do=do)

    def impedance(self, frequency_hz: Floats) -> Complex:
        f, real, imaginary = np.array(self.lines).T
        mobility = np.interp(frequency_hz, f, real) + 1j * np.interp(frequency_hz, f, imaginary)
        return np.asarray(1.0 / mobility, dtype=np.complex128)

    @property
    def band(self) -> tuple[float, float]:
        return self.lines[0][0], self.lines[-1][0]


def _refuse_values(values: tuple[tuple[float, float], ...]) -> None:
    if len(values) < 2:
        raise InputError("mobility", got=f"{len(values)} values", expected="two or more")
    before = 0.0
    for frequency, value in values:
        if not frequency > before:
            got = f"{frequency:g} Hz after {before:g} Hz"
            raise InputError("mobility", got=got, expected="frequencies that rise from above 0 Hz")
        if not value > 0.0:
            raise InputError("mobility", got=f"{value:g} at {frequency:g} Hz", expected="values above 0")
        before = frequency


# ----------------------------------------------------------------------------------------------------------------------
# Structure-borne sources in place: contact forces and the power they send into a structure, from what was measured of
# the source alone (EN 15657: blocked force or free velocity, and mobility).
# ----------------------------------------------------------------------------------------------------------------------


class Contacts(NamedTuple):
    """Forces at contacts per blocked force of one of them, forces [n, n, nf] (at, of), and the power over the mean
    square of that blocked force, power [n, nf] [W/N^2].

    least, most [n, nf] : between which shares of this power the true one lies; 1 where the phase of the source's
    mobility is known.
    """

    forces: Complex
    power: Floats
    least: Floats
    most: Floats


def receiver_mobility(basis: ModalBasis, contacts: Sequence[Probe], frequency_hz: Floats) -> Complex:
    """Mobilities of a structure between contacts [n, n, nf] (at, of) [m/(N s)], by superposition of modes.

    Parameters
    ----------
    basis : ModalBasis
        Damped, with residual vectors for the contacts.

    Examples
    --------
    >>> from femstruct.modal.closed_form import oscillator
    >>> basis, points = oscillator(2.0, stiffness=0.0)  # a free mass: 1 / (j omega m)
    >>> abs(receiver_mobility(basis, [points["m"].probe("x")], np.array([100.0])) * 2 * np.pi * 100.0 * 2.0).round(9)
    array([[[1.]]])
    """
    rows = np.array([probe.of(basis.shapes) for probe in contacts])
    rate = 2j * np.pi * np.asarray(frequency_hz)
    columns = [rate * (rows @ modal_amplitudes(basis, probe, frequency_hz)) for probe in contacts]
    return np.asarray(np.stack(columns, axis=1), dtype=np.complex128)


def contact_forces(mobility: Complex, impedance: Complex, has_phase: bool = True) -> Contacts:
    """What reaches a structure of a source, per unit of the blocked force at each contact.

    Parameters
    ----------
    mobility : Complex [n, n, nf]
        Of the structure [m/(N s)].
    impedance : Complex [nf]
        Of the source at each contact [N s/m], 0 for a source of forces.
    has_phase : bool
        Whether that is complex, or a magnitude only.

    Notes
    -----
    (Y_s + Y_r) F = Y_s F_b: with Z_s = 1 / Y_s, F = (1 + Z_s Y_r)^-1 F_b, all contacts together, and W = F^H Re(Y_r) F.
    At one contact that is F = F_b Y_s / (Y_s + Y_r), W = |v_free|^2 Re Y_r / |Y_s + Y_r|^2, v_free = Y_s F_b.

    Without phase, |Y_s + Y_r|^2 is taken as |Y_s|^2 + |Y_r|^2 at each contact by itself, as EN 15657 and EN 12354-5
    have it of magnitudes in bands; it lies between (|Y_s| - |Y_r|)^2, or (Re Y_r)^2 where that is more as both are
    passive, and (|Y_s| + |Y_r|)^2.

    Examples
    --------
    A rigid mass m on a dashpot Z: 1 / (1 + j omega m / Z), the limit of a hammer that does not rebound:

    >>> found = contact_forces(np.full((1, 1, 1), 1 / 1620.0 + 0j), np.array([2j * np.pi * 500.0 * 0.5]))
    >>> bool(abs(found.forces[0, 0, 0] - 1 / (1 + 2j * np.pi * 500.0 * 0.5 / 1620.0)) < 1e-15)
    True
    """
    n, lines = len(mobility), mobility.shape[2]
    own = np.diagonal(mobility).T  # [n, nf]
    one = np.ones((n, lines))
    if has_phase:
        matrix = np.eye(n)[:, :, None] + impedance * mobility
        inverse = np.linalg.inv(np.moveaxis(matrix, 2, 0))
        forces: Complex = np.asarray(np.moveaxis(inverse, 0, 2), dtype=np.complex128)
        power = np.einsum("aif,abf,bif->if", forces.conj(), mobility.real, forces).real
        return Contacts(forces, np.asarray(power, dtype=np.float64), one, one)
    ratio = np.abs(impedance * own)  # |Y_r| / |Y_s|
    share = 1.0 / (1.0 + ratio**2)
    forces = np.zeros(mobility.shape, dtype=np.complex128)
    forces[range(n), range(n)] = np.sqrt(share)
    closest = np.maximum((1.0 - ratio) ** 2, (np.abs(impedance) * own.real) ** 2)
    return Contacts(forces, share * own.real, 1.0 / (1.0 + ratio) ** 2 / share, 1.0 / closest / share)


def band_integrals(values: Floats, frequency_hz: Floats, edges: Floats) -> Floats:
    """Integrals over bands [.., n] of values [.., nf] along lines [nf] [Hz], all of whose edges [n, 2] are lines.

    >>> band_integrals(np.ones(5), np.linspace(1.0, 5.0, 5), np.array([[2.0, 4.0]])).tolist()
    [2.0]
    """
    steps = 0.5 * (values[..., 1:] + values[..., :-1]) * np.diff(frequency_hz)
    total = np.concatenate([np.zeros((*values.shape[:-1], 1)), np.cumsum(steps, axis=-1)], axis=-1)
    low, high = np.searchsorted(frequency_hz, edges.T * (1.0 - 1e-12))
    found: Floats = total[..., high] - total[..., low]
    return found


# ----------------------------------------------------------------------------------------------------------------------
# Where a structure resonates with a measured source on it: between its own natural frequencies.
# ----------------------------------------------------------------------------------------------------------------------

ROUNDS: Final = 12  # of false position: between two lines a susceptance is nearly straight
CLOSE: Final = 1e-4  # of a frequency: from where to where a slope is taken


def resonances_with(
    basis: ModalBasis, contacts: Sequence[Probe], source: SourceMobility, lines_hz: Floats
) -> Resonances:
    """Resonances of a structure and a source at all its contacts together, between lines that follow the structure's
    own.

    Parameters
    ----------
    lines_hz : Floats [nf]
        Rising [Hz]. None for a source of forces, or one whose phase is not known.

    Notes
    -----
    Forces are largest where the mobilities of both cancel but for their losses. Susceptances of what is passive rise
    with frequency and fall only at their own resonances (R. M. Foster, Bell System Technical Journal 3 (1924) 259-267),
    so one of their sum that comes from below zero has such a frequency between two lines. Half of the half-power
    bandwidth is the conductance there over the slope of the susceptance.

    A mass of 3 kg on one of 1 kg whose spring is tuned to 10 Hz: 5 Hz, with half of its damping ratio.

    Examples
    --------
    >>> from femstruct.modal.closed_form import oscillator
    >>> from femstruct.modal.damping import Damping, Ratio, with_damping
    >>> from femstruct.modal.installed_sources import RigidMass
    >>> bare, points = oscillator(1.0, frequency_hz=10.0)
    >>> basis, here = with_damping(bare, Damping(Ratio(0.001))), points["m"].probe("x")
    >>> found = resonances_with(basis, [here], RigidMass(3.0), np.arange(1.0, 20.0, 0.9))
    >>> found.hz.round(5), (found.half / found.hz).round(6)
    (array([5.]), array([0.0005]))
    """
    if not source.has_phase or not np.abs(source.impedance(lines_hz[:1])).any():
        return Resonances(np.zeros(0), np.zeros(0))

    def both(hz: Floats) -> Complex:
        """Mobilities of structure and source together [n, contact, contact]."""
        own = np.moveaxis(receiver_mobility(basis, contacts, hz), 2, 0)
        return np.asarray(own + np.eye(len(contacts)) / source.impedance(hz)[:, None, None], dtype=np.complex128)

    def rising(hz: Floats, which: np.ndarray) -> Floats:
        """The susceptance of this number at each frequency."""
        return np.asarray(np.take_along_axis(np.linalg.eigvalsh(both(hz).imag), which[:, None], axis=1)[:, 0])

    sizes = np.linalg.eigvalsh(both(lines_hz).imag)
    at, which = np.nonzero((sizes[:-1] < 0.0) & (sizes[1:] >= 0.0))
    low, high, below, above = lines_hz[at], lines_hz[at + 1], sizes[at, which], sizes[at + 1, which]
    if not len(at):
        return Resonances(low, low)
    hz, before = high.copy(), np.zeros(len(at))
    for _ in range(ROUNDS):
        hz = low - below * (high - low) / (above - below)
        size = rising(hz, which)
        side = np.sign(size)
        again = np.where(side == before, 0.5, 1.0)  # an end that stays twice counts half: the Illinois rule
        left = size < 0.0
        low, high = np.where(left, hz, low), np.where(left, high, hz)
        below, above = np.where(left, size, again * below), np.where(left, again * above, size)
        before = side
    step = np.minimum(CLOSE * hz, 0.5 * np.diff(lines_hz)[at])
    slope = (rising(hz + step, which) - rising(hz - step, which)) / (2.0 * step)
    there = both(hz)
    _, vectors = np.linalg.eigh(there.imag)
    vector = np.take_along_axis(vectors, which[:, None, None], axis=2)[:, :, 0]
    lost = np.einsum("ia,iab,ib->i", vector, there.real, vector)
    sharp = (slope > 0.0) & (lost > 0.0)
    return Resonances(hz[sharp], (lost / np.where(sharp, slope, 1.0))[sharp])
