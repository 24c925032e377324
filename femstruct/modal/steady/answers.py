"""What a structure answers to harmonic and random excitations, and the numbers an engineer asks of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import log, sqrt
from typing import Annotated, Final, Literal

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.superposition import Complex
from femstruct.reported import OWN_UNIT, Held, Reported
from femstruct.tags import stored_as

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

    transfer [nf] : its transfer function [unit per unit of what excites]. excitation [nf] : the power spectral density
    of that, one-sided [its unit^2/Hz]. duration [s] : for the expected largest.

    Notes
    -----
    |H|^2 S, and its moments by the trapezoidal rule along lines that follow the resonances (`resonant_lines`). Zero is
    crossed upwards sqrt(m2 / m0) times a second (S. O. Rice, Bell System Technical Journal 24 (1945) 46-156). The
    expected largest of a Gaussian one is rms (g + 0.5772 / g), g = sqrt(2 ln(crossings x duration)): A. G. Davenport,
    Proc. Institution of Civil Engineers 28 (1964) 187-196.

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
