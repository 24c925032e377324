"""The contact laws of a study file. What a restitution stands for is found in `build_laws`: it takes masses or speeds.

d is the indentation, d' its rate, positive while the ends approach.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator

from femstruct.language.schema_parts import Dashpot, Modulus, Stiffness
from femstruct.language.spec import AnyRatio, Flag, Length, Quantity, Spec, Text, read_by, refuse
from femstruct.units import QuantityError, power_stiffness, shown_as

Positive = Annotated[float, Quantity(("stiffness",), above=0.0)]
Restitution = Annotated[float, Quantity(("ratio",), above=0.0, most=1.0)]
Exponent = Annotated[float, Quantity(("ratio",), least=1.0, most=9.0)]
MeetingSpeed = Annotated[float, Quantity(("speed",), above=0.0)]
Depth = Annotated[float, Quantity(("length",), least=0.0)]
Push = Annotated[float, Quantity(("force",), least=0.0)]


def _radii(value: object) -> object:
    """One radius, of a sphere on a flat face, or two."""
    return value if isinstance(value, list) else [value]


class HertzSpec(Spec):
    """f = k d^1.5 + c d^0.5 d', two rounded bodies: their stiffness, or E and nu of both and the radius (one, or two)
    where they touch, that of the bodies themselves when left out."""

    one_of = (("stiffness", "E"),)
    needs = (("radius", ("E", "nu")), ("E", ("nu",)), ("nu", ("E",)))

    type: Literal["hertz"]
    stiffness: Annotated[float, Quantity(("hertz stiffness",), above=0.0)] | None = None
    radius: (
        Annotated[
            tuple[Length, ...], Field(min_length=1, max_length=2), read_by(_radii, Length | tuple[Length, Length])
        ]
        | None
    ) = None
    E: tuple[Modulus, Modulus] | None = None
    nu: tuple[AnyRatio, AnyRatio] | None = None
    damping: Annotated[float, Quantity(("hertz damping",), least=0.0)] = 0.0
    tensile: Flag = False


class LinearSpec(Spec):
    """f = k d + c d', spring and dashpot side by side (Kelvin and Voigt): k and c, or the restitution with k or with
    the duration of the contact. These count for the body alone against a wall, two bodies by their reduced mass."""

    one_of = (("stiffness", "duration"),)
    at_most_one_of = (("damping", "restitution"),)
    needs = (("duration", ("restitution",)),)

    type: Literal["linear"]
    stiffness: Positive | None = None
    damping: Dashpot = 0.0
    restitution: Restitution | None = None
    duration: Annotated[float, Quantity(("time",), above=0.0)] | None = None
    tensile: Flag = False


class StopSpec(Spec):
    """A bumper on both sides."""

    type: Literal["stop"]
    stiffness: Positive
    damping: Dashpot = 0.0
    tensile: Flag = False


class FactoredSpec(Spec):
    """f = s(d) (1 + chi d'): the dissipation chi, or the restitution at a speed. Without at_speed it is the speed with
    which a body placed at the other end starts."""

    at_most_one_of = (("dissipation", "restitution"),)
    needs = (("at_speed", ("restitution",)),)

    dissipation: Annotated[float, Quantity(("dissipation",), least=0.0)] = 0.0
    restitution: Restitution | None = None
    at_speed: MeetingSpeed | None = None
    tensile: Flag = False


def _power(value: Any, info: ValidationInfo) -> Any:
    if "exponent" not in info.data:  # refused already
        return 1.0
    try:
        stiffness = power_stiffness(value, info.data["exponent"])
    except QuantityError as error:
        raise refuse(error.got, error.expected, error.do) from None
    if not stiffness > 0.0:
        raise refuse(shown_as(value), "a positive stiffness")
    return stiffness


class HuntCrossleySpec(FactoredSpec):
    """f = k d^n (1 + chi d'), exactly the restitution asked for; k in N/m^n, n = 1.5 unless given."""

    type: Literal["hunt-crossley"]
    exponent: Exponent = 1.5
    stiffness: float

    _read = field_validator("stiffness", mode="before", json_schema_input_type=float | str)(_power)


class LankaraniNikraveshSpec(Spec):
    """f = k d^n (1 + chi d') with the published chi = 3 (1 - e^2) / (4 v): for restitutions near 1 only."""

    type: Literal["lankarani-nikravesh"]
    exponent: Exponent = 1.5
    stiffness: float
    restitution: Restitution
    at_speed: MeetingSpeed | None = None
    tensile: Flag = False

    _read = field_validator("stiffness", mode="before", json_schema_input_type=float | str)(_power)


class CubicSpec(FactoredSpec):
    """f = (k d + k3 d^3) (1 + chi d')."""

    type: Literal["cubic"]
    stiffness: Stiffness = 0.0
    cubic: Annotated[float, Quantity(("stiffness/area",), above=0.0)]


class TableSpec(FactoredSpec):
    """f = s(d) (1 + chi d') through measured points: [[indentation, force], ...], or a CSV file of these columns."""

    one_of = (("curve", "file"),)

    type: Literal["table"]
    curve: Annotated[list[tuple[Depth, Push]], Field(min_length=2)] | None = None
    file: Text | None = None


LawSpec = Annotated[
    HertzSpec | LinearSpec | StopSpec | HuntCrossleySpec | LankaraniNikraveshSpec | CubicSpec | TableSpec,
    Field(discriminator="type"),
]
