"""A spectrum as it is given: an amplitude or a power spectral density at some frequencies, and between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.tags import stored_as


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
