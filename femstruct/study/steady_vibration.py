"""Steady excitations as they are asked for: harmonic or random, a force, a pressure or a base that moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from femstruct.declared import Positive, checked
from femstruct.modal.steady.spectrum import Spectrum
from femstruct.study.asked import Spot
from femstruct.tags import stored_as


@stored_as("vibration/1")
@dataclass(frozen=True)
@checked("vibration")
class Vibration:
    """A steady excitation of a structure, by itself: what else a study does to it has no part in its answers.

    on : a point's direction (kind "point"), a surface that a uniform pressure acts on ("surface"), or "x", "y", "z"
    ("base"): everything that stands on the ground moves along it as one. what : "harmonic", `spectrum` being amplitudes
    [N, N m, Pa, m/s^2], or "psd", one-sided power spectral densities of them [their unit^2/Hz]. duration [s] : of a
    random one, for the expected largest values.

    A shaker under a machine, 10 minutes of 0.01 g^2/Hz from 20 to 500 Hz:

    >>> from femstruct.conventions import GRAVITY
    >>> level = 0.01 * GRAVITY**2
    >>> Vibration("shaker", "z", "base", "psd", Spectrum(((20.0, level), (500.0, level))), duration=600.0).unit
    '(m/s^2)^2/Hz'
    """

    name: str
    on: Spot | str
    kind: Literal["point", "surface", "base"]
    what: Literal["harmonic", "psd"]
    spectrum: Spectrum
    duration: Positive | None = None

    @property
    def unit(self) -> str:
        """Of the values of its spectrum."""
        turned = isinstance(self.on, Spot) and self.on.what.startswith("r")
        unit = {"point": "N m" if turned else "N", "surface": "Pa", "base": "m/s^2"}[self.kind]
        return unit if self.what == "harmonic" else per_hertz(unit)

    @property
    def told(self) -> str:
        """Where it acts, in a word."""
        return f"base {self.on}" if self.kind == "base" else str(self.on)


def per_hertz(unit: str) -> str:
    """The unit of the power spectral density of something.

    >>> per_hertz("N"), per_hertz("m/s^2")
    ('N^2/Hz', '(m/s^2)^2/Hz')
    """
    return f"{unit}^2/Hz" if unit.isalpha() else f"({unit})^2/Hz"
