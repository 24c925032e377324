"""Coverings below a tapping machine, as laboratories measure them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ValidationInfo

from femstruct.errors import shown_as
from femstruct.language.yaml import BandFile, Quantity, Spec, by_band, read_by, refuse
from femstruct.study.acting import Covering

_DECIBEL = Quantity(
    ("level",),
    least=-20.0,
    most=80.0,
    too_small="what a covering takes off is positive",
    too_large="coverings reach 40 dB or so",
    words="a reduction",
)
_WORDS = ("a reduction for each band", "write it like {100 Hz: 2 dB, 125 Hz: 3 dB, ..} or {file: NAME}")
_READ = by_band(_DECIBEL, *_WORDS)


def _reduction(value: object, info: ValidationInfo) -> object:
    if not isinstance(value, dict):
        raise refuse(shown_as(value), *_WORDS)
    return _READ(value, info)


class CoveringSpec(Spec):
    """What a covering takes off the impact sound of a tapping machine, by band: Delta L, measured on a heavy reference
    floor (ISO 10140-3), or Delta L_t of a light one. It is a ratio of forces, so that floors must be alike: a study
    with the other kind of floor is refused."""

    makes = Covering
    called = (("reduction", "reduction_db"),)

    reduction: Annotated[dict[float, float], read_by(_reduction, BandFile | dict[str, Annotated[float, _DECIBEL]])]
    measured_on: Literal["heavy", "light"] = "heavy"

    def missing(self, bands: tuple[float, ...]) -> list[float]:
        """Bands that it lacks [Hz]."""
        return [band for band in bands if band not in self.reduction]
