"""Numbers that universal files have for quantities and directions, and the units that go with them.

Source: descriptions of data sets 55, 58, 164 and 2414, Structural Dynamics Research Laboratory, University of
Cincinnati, https://www.ceas3.uc.edu/sdrluff/.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from femstruct.conventions import DIRECTIONS, GRAVITY
from femstruct.modal.frf import FrfKind
from femstruct.modal.measured.measurement import Kind

TIME, FREQUENCY = 17, 18
DISPLACEMENT, VELOCITY, ACCELERATION, FORCE = 8, 11, 12, 13
HISTORY, RESPONSE = 1, 4
KINDS: Final[dict[FrfKind, tuple[int, int]]] = {  # what is over what
    "receptance": (DISPLACEMENT, FORCE),
    "mobility": (VELOCITY, FORCE),
    "accelerance": (ACCELERATION, FORCE),
    "transmissibility": (DISPLACEMENT, DISPLACEMENT),
}
QUANTITIES: Final = {
    DISPLACEMENT: ("displacement", "m"),
    VELOCITY: ("velocity", "m/s"),
    ACCELERATION: ("acceleration", "m/s^2"),
    FORCE: ("force", "N"),
}
GRAVITIES: Final = ("g", "g's", "gn")


@dataclass(frozen=True)
class Units:
    """How many of the file's units a metre and a newton are: data set 164.

    >>> Units(1000.0, 1.0).si(ACCELERATION, 3, "", (0, 0)), Units().si(ACCELERATION, 3, "g", (0, 0))
    (0.001, 9.80665)
    """

    length: float = 1.0
    force: float = 1.0

    def si(self, quantity: int, direction: int, label: str, exponents: tuple[int, int]) -> float:
        """What makes SI of a value; exponents of length and force count for a quantity that is not told.

        A label in g counts whatever the units are: it is what analysers write.
        """
        if quantity == ACCELERATION and label.strip().lower() in GRAVITIES:
            return GRAVITY
        turning = abs(direction) > 3
        if quantity in (DISPLACEMENT, VELOCITY, ACCELERATION):
            exponents = (0, 0) if turning else (1, 0)
        elif quantity == FORCE:
            exponents = (1, 1) if turning else (0, 1)
        return float(self.length ** -exponents[0] * self.force ** -exponents[1])


def kind_of(numerator: int, denominator: int) -> Kind:
    """The kind of a frequency response by what it is of what.

    >>> kind_of(12, 13), kind_of(11, 11), kind_of(0, 13)
    ('accelerance', 'transmissibility', 'unknown')
    """
    if numerator == denominator and numerator in (DISPLACEMENT, VELOCITY, ACCELERATION):
        return "transmissibility"
    return next((kind for kind, codes in KINDS.items() if codes == (numerator, denominator)), "unknown")


def direction_code(direction: str) -> int:
    """1 to 6 of x, y, z, rx, ry, rz; 0 of none."""
    return DIRECTIONS.index(direction) + 1 if direction else 0


def direction_of(code: int) -> tuple[str, float]:
    """The direction of a number and its sign: -3 is z the other way round.

    >>> direction_of(-3), direction_of(0)
    (('z', -1.0), ('', 1.0))
    """
    return (DIRECTIONS[abs(code) - 1] if code else ""), (-1.0 if code < 0 else 1.0)
