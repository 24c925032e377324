"""Mobilities of sources at their contacts: what a machine gives way by when the structure below it moves."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import pi
from typing import ClassVar

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import Positive, checked
from femstruct.errors import InputError
from femstruct.modal.superposition import Complex
from femstruct.tags import stored_as


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
