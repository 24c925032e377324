"""Losses of a room and absorption of its walls, as they are written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final, Literal, Self

from pydantic import model_validator

from acoustics.air import Air
from acoustics.losses import Losses, losses_from_beta, losses_from_loss_factor, losses_from_t60, losses_from_t60_bands
from acoustics.meshed.walls import MOST_ABSORBED, AnyWall, Wall, YieldingWall, absorbing
from femstruct.language.yaml import (
    BandFile,
    Duration,
    Frequency,
    LossFactor,
    Quantity,
    Ratio,
    Spec,
    by_band,
    exactly_one,
    read_by,
    refuse,
)

SCALE_HZ: Final = 1000.0  # a wall's one admittance is the same at all frequencies: this is as good as any
_SECONDS: Final = Quantity(
    ("time",),
    above=0.0,
    least=1e-3,
    most=120.0,
    too_small="a plain number is in seconds: did you mean {thousandfold:g} s?",
    too_large="a plain number is in seconds: did you mean {number:g} ms?",
)
"""The longest reverberation known is 112 s at 125 Hz, in an oil tank under a hill (T. J. Cox, A. G. Kilpatrick,
J. Acoust. Soc. Am. 137 (2015) 1602, doi:10.1121/1.4908218); in a millisecond sound has gone 0.3 m."""
_SHARE: Final = Quantity(("ratio",), least=0.0, most=MOST_ABSORBED)
_t60 = by_band(_SECONDS, "a reverberation time for one band or more", "write it like {63 Hz: 0.9 s, 125 Hz: 0.8 s}")
_absorption = by_band(_SHARE, "an absorption coefficient for one band or more", "write it like {125 Hz: 0.1}")
ByBand = float | dict[float, float] | None
SpecificImpedance = Quantity(("specific impedance",), least=0.0)


class LossesSpec(Spec):
    """How sound dies away: a damping ratio or loss factor at a frequency, or a reverberation time."""

    short = "t60"
    beta: Annotated[float, Quantity(("ratio",), above=0.0, below=1.0)] | None = None
    loss_factor: LossFactor | None = None
    t60: Annotated[ByBand, read_by(_t60, Duration | BandFile | dict[str, Duration])] = None
    at: Frequency | None = None

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        exactly_one(given, ("beta", "loss_factor", "t60"))
        if ("t60" in given) == ("at" in given):
            raise refuse(
                "t60 with a frequency" if "at" in given else "no frequency",
                "'at' with beta or loss_factor only",
                "write it like {beta: 1.16 %, at: 293 Hz}",
            )

    @property
    def asked(self) -> dict[float, float]:
        """The reverberation times that are given by bands."""
        return self.t60 if isinstance(self.t60, dict) else {}

    @property
    def shortest(self) -> float | None:
        """The shortest reverberation time that is given [s]."""
        return min(self.asked.values()) if isinstance(self.t60, dict) else self.t60

    def losses(self, form: Literal["causal", "source"]) -> Losses:
        """The losses it describes."""
        if isinstance(self.t60, dict):
            return losses_from_t60_bands(self.t60)
        if self.t60 is not None:
            return losses_from_t60(self.t60)
        at = self.at or 0.0
        if self.beta is not None:
            return losses_from_beta(self.beta, at, form)
        return losses_from_loss_factor(self.loss_factor or 0.0, at, form)


class WallSpec(Spec):
    """What a wall absorbs: a random-incidence absorption coefficient, one or by frequency, or its impedance. Or a
    compliant wall: mass, stiffness and resistance, each per area, one or more of them. A resistance without the others
    is an impedance.
    """

    absorption: Annotated[ByBand, read_by(_absorption, Ratio | BandFile | dict[str, Ratio])] = None
    impedance: Annotated[float, Quantity(("specific impedance",), above=0.0)] | None = None
    mass: Annotated[float, Quantity(("mass/area",), above=0.0)] | None = None
    stiffness: Annotated[float, Quantity(("stiffness/area",), least=0.0)] = 0.0
    resistance: Annotated[float, SpecificImpedance] = 0.0

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        ways = ("mass", "stiffness", "resistance")
        exactly_one(given, ("absorption", "impedance", *([key for key in ways if key in given][:1] or ways)))

    @model_validator(mode="after")
    def _of_something(self) -> Self:
        if (self.absorption, self.impedance, self.mass) == (None, None, None) and not self.stiffness + self.resistance:
            raise refuse("a wall of no mass, no stiffness and no resistance", "one of them above 0")
        return self

    @property
    def absorbs(self) -> bool:
        """Whether it takes up sound."""
        most = max(self.absorption.values()) if isinstance(self.absorption, dict) else self.absorption
        return bool(most or self.impedance or self.resistance)

    def wall(self, air: Air) -> AnyWall:
        """The wall it describes."""
        if self.mass is not None or self.stiffness > 0:
            return YieldingWall(self.mass or 0.0, self.stiffness, self.resistance)
        if self.absorption is None:
            return Wall({SCALE_HZ: air.rho * air.c / (self.impedance or self.resistance)})
        return absorbing(self.absorption)
