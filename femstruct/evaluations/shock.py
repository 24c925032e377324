"""Shock response spectra: what a recorded acceleration does to oscillators that stand where it was recorded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, log
from typing import Annotated, ClassVar, Final, Literal

import numpy as np
import scipy

from femstruct.arrays import Floats
from femstruct.declared import Count, Key, checked
from femstruct.errors import Finding, InputError
from femstruct.evaluations.evaluation import Evaluation, Of, Quoted
from femstruct.quantities import Band, Ratio
from femstruct.reported import Held, Reported
from femstruct.tags import stored_as

SAMPLES: Final = 10.0
"""Samples a period of an oscillator: with fewer its largest acceleration is taken more than 5 % too low."""
FEWEST: Final = 12  # frequencies an octave
MOST: Final = 192  # the same, of oscillators that hardly lose
APART: Final = 0.5  # of the damping ratio: half of that off a resonance an oscillator answers 3 % less
_AXIS: Final = ("frequency_hz",)


@stored_as("shock spectrum/1")
@dataclass(frozen=True, eq=False)
class ShockSpectrum:
    """Largest absolute accelerations of oscillators on a moving base, by their natural frequency [Hz].

    channel : the recorded acceleration. damping_ratio [1] : of the oscillators. positive, negative [n] [m/s^2] :
    largest upwards and downwards, both as magnitudes, during the record and while they ring after it.
    """

    table: ClassVar = Held(
        "Shock response spectra of recorded accelerations", "Largest accelerations of oscillators", key="shock_spectra"
    )
    channel: Annotated[str, Reported("1", "Recorded acceleration")]
    damping_ratio: Annotated[float, Reported("1", "Of the oscillators", symbol="damping ratio")]
    frequency_hz: Annotated[Floats, Reported("Hz", "Natural frequency", along=_AXIS)]
    positive: Annotated[Floats, Reported("m/s^2", "Largest positive acceleration", along=_AXIS)]
    negative: Annotated[Floats, Reported("m/s^2", "Largest negative acceleration, as a magnitude", along=_AXIS)]

    @property
    def maximax(self) -> Annotated[Floats, Reported("m/s^2", "The larger of both", along=_AXIS)]:
        """The larger of both [n] [m/s^2]."""
        return np.maximum(self.positive, self.negative)

    @property
    def largest(self) -> Annotated[float, Reported("m/s^2", "Largest of the spectrum", symbol="largest")]:
        """Of the spectrum [m/s^2]."""
        return float(self.maximax.max())

    @property
    def largest_at_hz(self) -> Annotated[float, Reported("Hz", "Where it is largest", symbol="at")]:
        """Natural frequency where it is largest [Hz]."""
        return float(self.frequency_hz[self.maximax.argmax()])


@stored_as("shock request/1")
@dataclass(frozen=True)
@checked("shock_spectra")
class ShockRequest(Evaluation):
    """The largest accelerations of oscillators that stand where an acceleration is recorded: of: POINT.z, their damping
    ratio, the band of their frequencies and how many there are an octave, by default as many as show a resonance within
    3 % (28 for 5 % of damping), between 12 and 192.

    At the foot of a machine, with 5 % of damping (Q = 10), from 5 Hz to 2 kHz:

    >>> ShockRequest("foot", "foot.z", damping=0.05, band=(5.0, 2000.0)).lines_per_octave
    28
    """

    gives: ClassVar = ShockSpectrum
    name: str
    of: Of
    damping: Annotated[Ratio, Key(default=0.05)]
    band: Band
    per_octave: Count | None = None

    def mistakes(self, sampling: float | None) -> Iterator[InputError]:
        """A band that does not rise from above 0 Hz, or ends above a tenth of the sampling."""
        low, high = self.band
        if not 0.0 < low < high:
            yield InputError("band", got=f"{low:g} to {high:g} Hz", expected="a rising band above 0 Hz")
        if sampling is not None and high > sampling / SAMPLES:
            got, expected = (
                f"{high:g} Hz, {sampling / high:.3g} samples a period",
                f"{SAMPLES:g} samples a period or more",
            )
            do = f"sample at {SAMPLES * high:g} Hz, or end the band at {sampling / SAMPLES:g} Hz"
            yield InputError("band", got=got, expected=expected, do=do)

    @property
    def quantity(self) -> Literal["acceleration"]:
        """It takes accelerations."""
        return "acceleration"

    @property
    def lines_per_octave(self) -> int:
        """Frequencies an octave, `APART` of the damping ratio apart where none are stated."""
        if self.per_octave is not None:
            return self.per_octave
        return int(min(max(FEWEST, ceil(log(2.0) / (APART * max(self.damping, 1e-6)))), MOST))

    def answer(self, values: Floats, sampling: float) -> ShockSpectrum:
        """The spectrum at frequencies that are even over the logarithm."""
        low, high = self.band
        count = max(2, round(self.lines_per_octave * np.log2(high / low)) + 1)
        return shock_spectrum(values, sampling, np.geomspace(low, high, count), self.damping, self.channel)

    def quoted(self, answer: ShockSpectrum) -> tuple[Quoted, ...]:
        """The largest, and every value of the spectrum."""
        spectrum = zip(answer.frequency_hz, answer.maximax, strict=True)
        values = (Quoted(f"value at {f:.4g} Hz", float(value), "m/s^2", float(f)) for f, value in spectrum)
        return (Quoted("largest", answer.largest, "m/s^2", float(answer.frequency_hz[-1])), *values)

    def doubts(self, complete_below_hz: float) -> Iterator[Finding]:
        """Oscillators beyond the modes."""
        if complete_below_hz < self.band[1]:
            yield Finding(
                "spectrum-beyond-modes",
                f"{self.name}: the modes are complete below {complete_below_hz:.4g} Hz only, and the spectrum goes to "
                f"{self.band[1]:.4g} Hz. Do not quote it above {complete_below_hz:.4g} Hz. Compute modes up to "
                f"{self.band[1]:.4g} Hz or more",
                {"complete_below_hz": complete_below_hz, "needed_hz": self.band[1]},
            )


def shock_spectrum(
    acceleration: Floats, sampling: float, frequency_hz: Floats, damping_ratio: float, channel: str = ""
) -> ShockSpectrum:
    """The shock response spectrum of an acceleration.

    acceleration [nt] [m/s^2], sampling [Hz].

    Parameters
    ----------
    frequency_hz : Floats [n]
        Natural frequencies of the oscillators, all above 0 and at most a tenth of the sampling.
    damping_ratio : float
        From 0 to below 1; 0.05 is usual (Q = 10).

    Raises
    ------
    InputError
        For other frequencies and ratios.

    Notes
    -----
    Exact for an acceleration that is straight between samples: the ramp-invariant recursion of ISO 18431-4 (D. O.
    Smallwood, Shock and Vibration Bulletin 51 (1981) 279-287). The base moves on with no acceleration after the record,
    for one period of each oscillator.

    Examples
    --------
    A step of 1 m/s^2 makes an undamped oscillator reach twice that, except for what lies between samples:

    >>> found = shock_spectrum(np.ones(1000), 1000.0, np.array([5.0, 10.0]), 0.0)
    >>> found.positive.round(2)
    array([2., 2.])
    """
    f = np.asarray(frequency_hz, dtype=np.float64)
    if not ((f > 0.0) & (f <= sampling / SAMPLES)).all():
        expected = f"above 0 and at most a tenth of the sampling, {sampling / SAMPLES:g} Hz"
        raise InputError("frequencies", got=f"{f.min():g} to {f.max():g} Hz", expected=expected, do="sample faster")
    if not 0.0 <= damping_ratio < 1.0:
        raise InputError("damping", got=f"{damping_ratio:g}", expected="a ratio from 0 to below 1")
    extremes = np.array([_extremes(acceleration, sampling, one, damping_ratio) for one in f])
    return ShockSpectrum(channel, damping_ratio, f, np.maximum(extremes[:, 1], 0.0), np.maximum(-extremes[:, 0], 0.0))


def _extremes(acceleration: Floats, sampling: float, frequency: float, ratio: float) -> tuple[float, float]:
    """Least and largest absolute acceleration of one oscillator [m/s^2]."""
    rate = 2.0 * np.pi * frequency / sampling
    damped = rate * np.sqrt(1.0 - ratio**2)
    E = np.exp(-ratio * rate)
    C, S = E * np.cos(damped), E * np.sin(damped)
    share = S / damped
    ringing = np.zeros(int(np.ceil(sampling / frequency)) + 1)
    moved = scipy.signal.lfilter(
        [1.0 - share, 2.0 * (share - C), E**2 - share], [1.0, -2.0 * C, E**2], np.concatenate([acceleration, ringing])
    )
    return float(moved.min()), float(moved.max())
