"""How strongly people feel a recorded vibration of a building: weighted by frequency, by its largest running mean."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi, sqrt
from typing import Annotated, ClassVar, Final, Literal, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.errors import Finding, InputError
from femstruct.evaluations.evaluation import Evaluation, Of
from femstruct.reported import OWN_UNIT, Held, Reported
from femstruct.tags import stored_as

Complexes = NDArray[np.complex128]
Weighting = Literal["KB", "Wk", "Wd", "Wm"]
HIGHEST_HZ: Final = 100.0  # where all weightings end, by their low-pass filter
FELT_HZ: Final = 80.0  # upper end of what ISO 2631 and DIN 4150-2 judge
SAMPLES: Final = 20.0  # a period there, at least
FINE_HZ: Final = 40e3
"""Sampling of the filters: the bilinear transform bends them near half of it. A mode of 300 Hz, of which the low-pass
lets a tenth through, was 18 % too small at 2 kHz."""
_Section = tuple[tuple[float, ...], tuple[float, ...]]  # numerator and denominator in s, from the highest power


class _Curve(NamedTuple):
    """A weighting as sections of second order. seconds : time constant of the running mean. unit, scale : of the
    weighted motion, and what a unit of the history is in it."""

    sections: tuple[_Section, ...]
    seconds: float
    unit: str
    scale: float


def _ends(lowest: float) -> tuple[_Section, _Section]:
    """Butterworth filters of second order at both ends of the band, corners in Hz."""
    low, high = 2.0 * pi * lowest, 2.0 * pi * HIGHEST_HZ
    below = (1.0, sqrt(2.0) * low, low**2)
    return ((1.0, 0.0, 0.0), below), ((high**2,), (1.0, sqrt(2.0) * high, high**2))


def _transition(corner: float, quality: float) -> _Section:
    """From acceleration to velocity above a corner in Hz: (1 + s/w) / (1 + s/(Q w) + (s/w)^2)."""
    w = 2.0 * pi * corner
    return (1.0 / w, 1.0), (1.0 / w**2, 1.0 / (quality * w), 1.0)


def _step(low: float, high: float, quality: float) -> _Section:
    """Upward step between two frequencies in Hz, to 1: (s^2 + s w5/Q + w5^2) / (s^2 + s w6/Q + w6^2)."""
    w5, w6 = 2.0 * pi * low, 2.0 * pi * high
    return (1.0, w5 / quality, w5**2), (1.0, w6 / quality, w6**2)


def _of_acceleration(lowest: float, *parts: _Section) -> _Curve:
    return _Curve((*_ends(lowest), *parts), 1.0, "m/s^2", 1.0)


_CURVES: Final = {
    "KB": _Curve((*_ends(0.8), ((1.0, 0.0), (1.0, 2.0 * pi * 5.6))), 0.125, "mm/s", 1e3),
    "Wk": _of_acceleration(0.4, _transition(12.5, 0.63), _step(2.37, 3.35, 0.91)),
    "Wd": _of_acceleration(0.4, _transition(2.0, 0.63)),
    "Wm": _of_acceleration(10**-0.1, _transition(1.0 / (0.028 * 2.0 * pi), 0.5)),
}


@stored_as("perceived vibration/1")
@dataclass(frozen=True, eq=False)
class Perceived:
    """How strongly people feel a vibration.

    channel, weighting : what was weighted, and by which curve. unit : of the weighted motion, mm/s of KB, whose values
    are stated without it, m/s^2 of the others. rms [unit] : over the record. largest [unit] : of the running root mean
    square, KB_Fmax with a time constant of 0.125 s, MTVV of accelerations with 1 s; at [s] : when. dose [m/s^1.75] :
    vibration dose value, the fourth root of the integral of the fourth power; None of KB.
    """

    table: ClassVar = Held("Vibration as people feel it, weighted by frequency", "One motion", key="perception")
    channel: Annotated[str, Reported("1", "Recorded motion")]
    weighting: Annotated[str, Reported("1", "Frequency weighting", symbol="weighting")]
    unit: Annotated[str, Reported("1", "Unit of the weighted motion")]
    rms: Annotated[float, Reported(OWN_UNIT, "Root mean square over the record", symbol="rms")]
    largest: Annotated[float, Reported(OWN_UNIT, "Largest running rms, KB_Fmax or MTVV", symbol="KB_Fmax, MTVV")]
    at: Annotated[float, Reported("s", "When it is largest", symbol="at")]
    dose: Annotated[float | None, Reported("m/s^1.75", "Vibration dose value", key="vdv", symbol="VDV")]


@stored_as("perception request/1")
@dataclass(frozen=True)
@checked("perception")
class PerceptionRequest(Evaluation):
    """How strongly people feel a recorded motion, of: POINT.z. weighting: KB of a velocity (DIN 4150-2, DIN 45669-1);
    of an acceleration Wk (vertical) or Wd (horizontal) of ISO 2631-1, or Wm of ISO 2631-2.

    >>> PerceptionRequest("bed", "bed.z", "KB").channel, PerceptionRequest("bed", "bed.z", "Wm").channel
    ('bed.z velocity', 'bed.z acceleration')
    """

    gives: ClassVar = Perceived
    name: str
    of: Of
    weighting: Weighting

    def mistakes(self, sampling: float | None) -> Iterator[InputError]:
        """A sampling that is too low for the weighting's filters."""
        least = SAMPLES * HIGHEST_HZ
        if sampling is not None and sampling < least:
            got, do = f"a sampling of {sampling:g} Hz", f"write 'sampling: {least:g} Hz' or more under 'time'"
            expected = f"{least:g} Hz or more for weightings up to {HIGHEST_HZ:g} Hz"
            yield InputError("", got=got, expected=expected, do=do)

    @property
    def quantity(self) -> Literal["velocity", "acceleration"]:
        """KB weights velocities, the others accelerations."""
        return "velocity" if self.weighting == "KB" else "acceleration"

    def answer(self, values: Floats, sampling: float) -> Perceived:
        """The numbers of the channel, which was at rest before."""
        return perceived(values, sampling, self.weighting, self.channel)

    def doubts(self, complete_below_hz: float) -> Iterator[Finding]:
        """Modes that end below what people feel."""
        if complete_below_hz < FELT_HZ:
            yield Finding(
                "perception-beyond-modes",
                f"{self.name}: the modes are complete below {complete_below_hz:.4g} Hz only, and people feel vibration "
                f"up to {FELT_HZ:g} Hz: the numbers may be too small. Compute modes up to {FELT_HZ:g} Hz or more",
                {"complete_below_hz": complete_below_hz, "needed_hz": FELT_HZ},
            )


def weighting_at(weighting: Weighting, frequency_hz: Floats) -> Complexes:
    """A frequency weighting [nf] at frequencies [nf] [Hz]: of velocities KB, of accelerations the others.

    Wk is 1.039 at 5 Hz and .513 at 25 Hz (ISO 2631-1:1997, Table 3):

    >>> np.abs(weighting_at("Wk", np.array([5.0, 25.0]))).round(3).tolist()
    [1.039, 0.513]
    """
    at = 2j * pi * np.asarray(frequency_hz)
    sections = [np.polyval(above, at) / np.polyval(below, at) for above, below in _CURVES[weighting].sections]
    return np.asarray(np.prod(sections, axis=0))


def perceived(values: Floats, sampling: float, weighting: Weighting, channel: str = "") -> Perceived:
    """How strongly people feel a history.

    Parameters
    ----------
    values : Floats [nt]
        Velocity [m/s] for KB, else acceleration [m/s^2], from rest; sampling [Hz], 2 kHz or more.

    Raises
    ------
    InputError
        For a lower sampling.

    Notes
    -----
    KB: the velocity in mm/s through 1 / (1 + 5.6 Hz / (j f)), between 0.8 and 100 Hz (DIN 45669-1); KB_F(t) is its
    running root mean square with an exponential window of 0.125 s. Wk, Wd: ISO 2631-1:1997, Annex A. Wm: ISO
    2631-2:2003, Annex A. Their running rms has 1 s, exponentially (ISO 2631-1, 6.3.1), its largest value is the maximum
    transient vibration value. The filters are made digital by the bilinear transform, at 40 kHz or more: histories
    with fewer samples are interpolated. What is asked of a day or a night (KB_FTr, eVDV) needs how often the impact
    comes, and is not here.

    Examples
    --------
    A steady 10 Hz of 1 mm/s (peak): .707 / sqrt(1 + .56^2), and 3 % for the ripple of the running mean:

    >>> t = np.arange(40_000) / 10e3
    >>> round(perceived(1e-3 * np.sin(2 * pi * 10 * t), 10e3, "KB").largest, 2)
    0.64
    """
    if sampling < SAMPLES * HIGHEST_HZ:
        expected = f"{SAMPLES * HIGHEST_HZ:g} Hz or more, {SAMPLES:g} samples a period at {HIGHEST_HZ:g} Hz"
        raise InputError("sampling", got=f"{sampling:g} Hz", expected=expected, do="sample faster")
    curve = _CURVES[weighting]
    finer = int(np.ceil(FINE_HZ / sampling))
    weighted = curve.scale * scipy.signal.resample_poly(np.asarray(values, dtype=np.float64), finer, 1)
    sampling *= finer
    for above, below in curve.sections:
        weighted = scipy.signal.lfilter(*scipy.signal.bilinear(above, below, sampling), weighted)
    kept = np.exp(-1.0 / (curve.seconds * sampling))
    running = np.sqrt(scipy.signal.lfilter([1.0 - kept], [1.0, -kept], weighted**2))
    when = int(running.argmax())
    return Perceived(
        channel=channel,
        weighting=weighting,
        unit=curve.unit,
        rms=float(np.sqrt(np.mean(weighted**2))),
        largest=float(running[when]),
        at=when / sampling,
        dose=None if weighting == "KB" else float((np.sum(weighted**4) / sampling) ** 0.25),
    )
