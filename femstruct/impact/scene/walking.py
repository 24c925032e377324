"""A walker: the vertical force of footsteps as a Fourier series, at one place or handed on along a path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.conventions import GRAVITY
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.impact.scene.bodies import Table
from femstruct.tags import stored_as

PACES_HZ: Final = (1.0, 2.8)  # of the coefficients below
# Design values of CCIP-016 (M. Willford, P. Young, A Design Guide for Footfall Induced Vibration of Structures, 2006):
# (offset, slope over the harmonic's frequency, most), as quoted in
# https://github.com/knippershelbig/StructuralDesignKit_Holz (StructuralDesignKitLibrary/Vibrations/Vibrations -
# Legacy.cs, HarmonicCoefficient); the first is 0.41 (f - 0.95), at most 0.56
_DESIGN: Final = ((-0.41 * 0.95, 0.41, 0.56), (0.069, 0.0056, np.inf), (0.033, 0.0064, np.inf), (0.013, 0.0065, np.inf))
_FINE: Final = 32  # points to a period of the highest harmonic: straight lines miss (2 pi / 32)^2 / 8 = .5 % of it


def design_harmonics(pace_hz: float) -> tuple[float, ...]:
    """Amplitudes of the first four harmonics of a walker's force over the weight [1], design values of CCIP-016.

    Raises InputError: a pace outside 1 to 2.8 Hz.

    >>> [round(a, 3) for a in design_harmonics(2.0)]
    [0.43, 0.091, 0.071, 0.065]
    """
    if not PACES_HZ[0] <= pace_hz <= PACES_HZ[1]:
        raise InputError("pace", got=f"{pace_hz:g} Hz", expected=f"{PACES_HZ[0]:g} to {PACES_HZ[1]:g} Hz")
    return tuple(min(start + slope * h * pace_hz, most) for h, (start, slope, most) in enumerate(_DESIGN, 1))


@stored_as("walk/1")
@dataclass(frozen=True)
@checked("walk")
class Walk:
    """A walker of `mass` [kg] with `pace` steps a second [Hz], `steps` of them, and the amplitudes of the harmonics of
    the force over the weight [1], the first at the pace.

    Notes
    -----
    The force, downwards, is m g (1 + sum a_h sin(2 pi h f t)). It increases over the first step and decreases over the
    last as half a cosine. There is no phase in the source of `design_harmonics`. Heel strikes are left out: it
    covers resonance of a floor with a harmonic, not floors whose first mode is above them, and not audible footsteps.

    >>> from femstruct.impact.scene.walking import design_harmonics
    >>> Walk(80.0, pace=2.0, steps=8, harmonics=design_harmonics(2.0)).steps
    8
    """

    mass: float
    pace: float
    steps: int
    harmonics: tuple[float, ...]

    def __post_init__(self) -> None:
        for word in ("mass", "pace"):
            if not getattr(self, word) > 0:
                raise InputError(word, got=f"{getattr(self, word):g}", expected="a positive value")
        if self.steps < 2:
            raise InputError(
                "steps",
                got=f"{self.steps}",
                expected="2 or more: the force increases over the first and decreases over the last",
            )
        if not self.harmonics:
            raise InputError("harmonics", got="none", expected="one or more")

    @property
    def duration(self) -> float:
        """Time of all steps [s]."""
        return self.steps / self.pace

    @property
    def highest_hz(self) -> float:
        """Frequency of the last harmonic [Hz]."""
        return len(self.harmonics) * self.pace

    def force(self, t: Floats) -> Floats:
        """Force at the times `t` [nt] [s], downwards [N].

        >>> walk = Walk(70.0, 2.0, 6, (0.4, 0.1))
        >>> float(walk.force(np.array([1.0]))[0].round(3))  # between two steps all sines are zero: the weight
        686.465
        """
        order = np.arange(1, len(self.harmonics) + 1)
        series = 1.0 + np.sin(2 * np.pi * self.pace * np.outer(t, order)) @ np.asarray(self.harmonics)
        ends = np.clip(np.minimum(t, self.duration - t) * self.pace, 0.0, 1.0)
        return np.asarray(self.mass * GRAVITY * series * 0.5 * (1.0 - np.cos(np.pi * ends)))

    def tables(self, places: int) -> tuple[Table, ...]:
        """Force histories along z (downwards is negative) of every place of a path that is walked from the first place
        to the last, at an even speed: between two places the force is shared as it is nearer to one or the other."""
        count = int(np.ceil(self.duration * self.highest_hz * _FINE)) + 1
        t = np.linspace(0.0, self.duration, count)
        force = self.force(t)
        along = (places - 1) * t / self.duration
        return tuple(Table(t, -force * np.clip(1.0 - np.abs(along - i), 0.0, 1.0)) for i in range(places))
