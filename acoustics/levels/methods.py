"""How standards rate impact sound: what is measured in which bands, how it is averaged, what numbers are made of it.

The one place that knows what a standard's name means.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, log10
from typing import Annotated, Final, Literal

import numpy as np

from acoustics.arrays import Floats
from acoustics.errors import AcousticsError
from acoustics.levels.bands import Fraction
from acoustics.levels.ending import passed_by
from acoustics.levels.iso import (
    A_THIRDS,
    CURVE_THIRDS,
    energy_average,
    equal_parts,
    heavy_impact_level,
    shifted_curve,
    standardised_impact_level,
    standardised_maximum_level,
    weighted_impact_level,
)
from acoustics.levels.jis_ks import (
    HEAVY_OCTAVES,
    LIGHT_OCTAVES,
    grade_curve,
    impact_grade,
    inverse_a_curve,
    inverse_a_level,
    mean_of_places,
)
from acoustics.levels.single_number import Number, SingleNumber
from acoustics.reported import Reported
from acoustics.tags import stored_as

FIELD: Final = "ISO 16283-2"
RATING: Final = "ISO 717-2"
GRADES: Final = "JIS A 1419-2"
INVERSE: Final = "KS F 2863-2"
STANDARDS: Final = (FIELD, RATING, GRADES, INVERSE)
Blows = Literal["heavy", "tapping"]
BALL: Final = "rubber ball"
BANG_MACHINE: Final = "bang machine"
TAPPING_MACHINE: Final = "tapping machine"
_NOT_FOUND: Final = "has no accessible source to check it against"
_OF_BALL: Final = f"its rating of a rubber ball {_NOT_FOUND}: write {RATING}"
_REFUSED: Final = {  # (standard, source): (expected, why)
    (GRADES, BALL): ("a bang machine or a tapping machine", _OF_BALL),
    (INVERSE, BALL): ("a bang machine", _OF_BALL),
    (INVERSE, TAPPING_MACHINE): ("a bang machine", f"KS F 2863-1 {_NOT_FOUND}: write {GRADES} or {RATING}"),
}  # fmt: skip
_RATED_BY: Final = {  # source: standards that make a number of it
    BALL: (RATING,),
    BANG_MACHINE: (GRADES, INVERSE),
    TAPPING_MACHINE: (RATING, GRADES),
}
_SYMBOLS: Final = {  # (blows, standardised): of the bands, of the single number
    ("heavy", True): ("L'_i,Fmax,V,T", "L'_iA,Fmax,V,T"),
    ("heavy", False): ("L_i,Fmax", "L_iA,Fmax"),
    ("tapping", True): ("L'_nT", "L'_nT,w"),
    ("tapping", False): ("L_i", "L_i,w"),
}


def band_quantity_of(symbol: str) -> str:
    """The symbol of the bands that a single number of ISO is made of; "" for other numbers.

    >>> band_quantity_of("L'_nT,w"), band_quantity_of("L-50")
    ("L'_nT", '')
    """
    return next((bands for bands, number in _SYMBOLS.values() if number == symbol), "")


@stored_as("method of rating/1")
@dataclass(frozen=True)
class Method:
    """How standards rate one kind of blows.

    standards : of `STANDARDS`. blows : heavy (largest Fast levels) or tapping (levels of the mean square). source :
    what must strike. fraction : 3 for third octaves, 1 for octaves. bands_hz : nominal centres [Hz]. band_quantity :
    symbol of the levels. average : of levels [places, bands] over the places of the blow; over receivers all average
    the energy. numbers : what is made of them, in order. correct : standardises levels {band: [dB]} for a room's volume
    [m^3] and reverberation times {band: [s]}, None where nothing is.
    measured_by : the standard of measurement, "" where none is applied. fewest : places of the source, and of
    microphones, that it has, 0 where that is not known. volume_m3 : the least and the largest room it is for, or None.
    """

    standards: Annotated[tuple[str, ...], Reported("1", "Standards that were applied")]
    blows: Annotated[Blows, Reported("1", "Kind of blows")]
    source: str
    fraction: Fraction
    bands_hz: tuple[float, ...]
    band_quantity: Annotated[str, Reported("1", "Symbol of the levels by band")]
    average: Callable[[Floats], Floats]
    numbers: tuple[Number, ...]
    correct: Callable[[Mapping[float, float], float, Mapping[float, float]], dict[float, float]] | None = None
    measured_by: str = ""
    fewest: int = 0
    volume_m3: tuple[float, float] | None = None

    @property
    def bands(self) -> Annotated[str, Reported("1", "What the bands are called")]:
        """What the bands are called."""
        return "octave" if self.fraction == 1 else "third octave"

    @property
    def highest_hz(self) -> float:
        """Where the last band ends [Hz]: the upper edge beside its exact centre, 3162.28 Hz of the band 3150 Hz."""
        return self._last_exact * _half(self.fraction)

    @property
    def passed_hz(self) -> float:
        """Up to where the filter of the last band passes what matters to its level [Hz]."""
        return self._last_exact * passed_by(self.fraction)

    @property
    def _last_exact(self) -> float:
        return float(10 ** (round(10 * log10(self.bands_hz[-1])) / 10))

    @property
    def least_sampling_hz(self) -> float:
        """The sampling that has all bands, in hundreds [Hz]: the last ends below 0.47 of it."""
        return 100.0 * ceil(self.highest_hz / 47.0)


def method_of(standards: Sequence[str], blows: Blows = "heavy") -> Method:
    """How the standards asked for rate blows.

    standards : of `STANDARDS`, those of ISO or JIS A 1419-2 and KS F 2863-2.

    Raises AcousticsError: none, another, both kinds in one room, blows that one of them does not rate.

    >>> method_of(["KS F 2863-2", "JIS A 1419-2"]).standards
    ('JIS A 1419-2', 'KS F 2863-2')
    """
    others = [one for one in standards if one not in STANDARDS]
    if others or not standards:
        raise AcousticsError("levels", got=others[0] if others else "nothing", expected=" or ".join(STANDARDS))
    wanted = tuple(one for one in STANDARDS if one in standards)
    in_thirds = [one for one in wanted if one in (FIELD, RATING)]
    in_octaves = [one for one in wanted if one not in in_thirds]
    if in_thirds and in_octaves:
        raise AcousticsError(
            "levels",
            got=f"{in_thirds[0]}, in third octaves, with {in_octaves[0]}, in octaves",
            expected="standards of the same bands",
            do="for the other, add a second room of the same size at the same place",
        )
    if blows == "tapping":
        refuse_source(wanted, TAPPING_MACHINE)
    return _by_thirds(wanted, blows) if in_thirds else _by_octaves(wanted, blows)


def refuse_source(standards: Sequence[str], source: str) -> None:
    """AcousticsError where a standard source is one whose rating by one of the standards is not known here."""
    for standard in standards:
        if (standard, source) in _REFUSED:
            expected, why = _REFUSED[standard, source]
            raise AcousticsError("levels", got=f"a {source} by {standard}", expected=expected, do=why)


def sources_of(standards: Sequence[str]) -> tuple[str, ...]:
    """The standard sources whose levels all of these standards have.

    >>> sources_of(["ISO 16283-2", "ISO 717-2"]), sources_of(["KS F 2863-2"])
    (('rubber ball', 'tapping machine'), ('bang machine',))
    """
    thirds = (FIELD, RATING)
    wanted = [RATING if one in thirds else one for one in standards]
    return tuple(source for source, rated in _RATED_BY.items() if set(wanted) <= set(rated))


def rating_of(source: str) -> tuple[str, ...]:
    """The standards that make a single number of what a source makes heard; none of what is no standard source.

    >>> rating_of("bang machine")
    ('JIS A 1419-2', 'KS F 2863-2')
    """
    return _RATED_BY.get(source, ())


def _by_thirds(standards: tuple[str, ...], blows: Blows) -> Method:
    """ISO: third octaves, energy averages over all places, standardised or not."""
    measured = FIELD in standards
    heavy = blows == "heavy"
    rate = _a_weighted if heavy else _weighted
    stated = dict.fromkeys((measured, False)) if RATING in standards else {}
    return Method(
        standards=standards,
        blows=blows,
        source=BALL if heavy else TAPPING_MACHINE,
        fraction=3,
        bands_hz=tuple(A_THIRDS if heavy else CURVE_THIRDS),
        band_quantity=_SYMBOLS[blows, measured][0],
        average=energy_average,
        numbers=tuple(Number(_SYMBOLS[blows, one][1], one, rate) for one in stated),
        correct=(standardised_maximum_level if heavy else _standardised) if measured else None,
        measured_by=FIELD if measured else "",
        # of the ball "quattro o più posizioni differenti": https://www.sonorasrl.com, La palla in gomma; of microphones
        # the text was not at hand
        fewest=4 if measured else 0,
        # scope: https://standards.iteh.ai/catalog/standards/sist/cace4e42-6d16-453c-81f2-2bc2bce32e99
        volume_m3=(10.0, 250.0) if measured else None,
    )


def _by_octaves(standards: tuple[str, ...], blows: Blows) -> Method:
    """JIS and KS: octaves, arithmetic averages over the places of the blow, levels as they are in the room."""
    heavy = blows == "heavy"
    octaves = HEAVY_OCTAVES if heavy else LIGHT_OCTAVES
    numbers = {
        GRADES: Number(*(("L_i,Fmax,r,H(1)", False, _heavy_grade) if heavy else ("L_i,r,L", False, _light_grade))),
        INVERSE: Number("L_i,Fmax,AW", False, _inverse_a),
    }
    return Method(
        standards=standards,
        blows=blows,
        source=BANG_MACHINE if heavy else TAPPING_MACHINE,
        fraction=1,
        bands_hz=octaves,
        band_quantity=_SYMBOLS[blows, False][0],
        average=_arithmetic,
        numbers=tuple(numbers[one] for one in standards),
    )


@stored_as("A-weighted number/1")
def _a_weighted(places_db: Floats) -> SingleNumber:
    found = heavy_impact_level(dict(zip(A_THIRDS, energy_average(places_db).tolist(), strict=True)))
    curve = equal_parts(found.unrounded_db)
    return SingleNumber(
        float(found.rating_db),
        found.unrounded_db,
        found.deciding_hz,
        curve,
        "levels at which all bands have equal shares in it",
    )


@stored_as("weighted number/1")
def _weighted(places_db: Floats) -> SingleNumber:
    levels = dict(zip(CURVE_THIRDS, energy_average(places_db).tolist(), strict=True))
    found, finely = weighted_impact_level(levels), weighted_impact_level(levels, step_db=0.1)
    return SingleNumber(
        found.weighted_db,
        finely.weighted_db,
        found.deciding_hz,
        shifted_curve(found.weighted_db),
        "shifted reference curve",
        {"C_I": found.adaptation_db},
    )


@stored_as("grade of heavy blows/1")
def _heavy_grade(places_db: Floats) -> SingleNumber:
    return _grade(HEAVY_OCTAVES, places_db)


@stored_as("grade of light blows/1")
def _light_grade(places_db: Floats) -> SingleNumber:
    return _grade(LIGHT_OCTAVES, places_db)


def _grade(octaves: tuple[float, ...], places_db: Floats) -> SingleNumber:
    found = impact_grade(dict(zip(octaves, mean_of_places(places_db).tolist(), strict=True)), octaves)
    curve = grade_curve(found.grade, octaves)
    return SingleNumber(
        float(found.grade),
        found.unrounded_db,
        found.deciding_hz,
        curve,
        "curve of the grade",
        {"L number": float(found.number)},
    )


@stored_as("inverse A number/1")
def _inverse_a(places_db: Floats) -> SingleNumber:
    levels = dict(zip(HEAVY_OCTAVES, _arithmetic(places_db).tolist(), strict=True))
    found, finely = inverse_a_level(levels), inverse_a_level(levels, step_db=0.1)
    curve = inverse_a_curve(found.level_db)
    return SingleNumber(found.level_db, finely.level_db, found.deciding_hz, curve, "shifted inverse A curve")


@stored_as("standardised level/1")
def _standardised(levels_db: Mapping[float, float], volume: float, t60_s: Mapping[float, float]) -> dict[float, float]:
    return standardised_impact_level(levels_db, t60_s)


@stored_as("arithmetic average/1")
def _arithmetic(levels_db: Floats) -> Floats:
    return np.asarray(np.mean(levels_db, axis=0))


def _half(fraction: Fraction) -> float:
    """A band's upper edge over its centre."""
    return float(10 ** (0.15 if fraction == 1 else 0.05))
