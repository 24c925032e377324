"""A spectrum as analysers measure it: rms values in octaves or third octaves."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import log10
from typing import Literal

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.tags import stored_as

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
