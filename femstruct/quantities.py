"""Quantities within limits, as fields are annotated: one declaration for files, for values in Python and the schema."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Final, NamedTuple

from femstruct.errors import quote_value
from femstruct.units import DIMENSIONS, Dimension, QuantityError, power_stiffness, quantity_of

SMALLEST, LARGEST = 1e-30, 1e20  # beyond them nothing is meant, and squares and cubes of it leave what numbers can hold
FARTHEST = 1e6  # metres
_PATTERN: Final = (
    r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*[A-Za-z%°µμ1].*$|^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*$"
)


class Measured(NamedTuple):
    """A value in SI units and its dimension, None for a plain number."""

    value: float
    dimension: str | None


def refuse(got: object, expected: str, do: str = "") -> QuantityError:
    """A refusal of what is written; `got` is shown as a value unless it is a sentence already."""
    return QuantityError("", got=str(got), expected=expected, do=do)


@dataclass(frozen=True)
class Quantity:
    """Annotation of a field that holds a quantity of one of these dimensions, within limits.

    too_small, too_large : what to do about a value beyond `least` or `most`; {number} in it is the value in SI units,
    {thousandfold} a thousand times that. at_limit : what to do about the value `above` itself. words : what the
    quantity is where its dimension does not say it.
    """

    dimensions: tuple[str, ...]
    above: float | None = None
    least: float | None = None
    below: float | None = None
    most: float | None = None
    which: bool = False
    too_small: str = "remove the sign"
    too_large: str = ""
    at_limit: str = ""
    words: str = ""

    def read(self, value: object) -> Any:
        """The value in SI units, or a Measured when `which` is set. Raises QuantityError for what is none."""
        number, dimension = quantity_of(value, self.dimensions)
        named = DIMENSIONS[dimension or self.dimensions[0]]
        self.refuse_beyond(number, value, named)
        largest = FARTHEST if named.unit == "m" else LARGEST
        if number and not SMALLEST <= abs(number) <= largest:
            raise refuse(
                quote_value(value),
                f"{named.words} between {SMALLEST:g} and {largest:g} {named.unit}",
                "correct its power of ten",
            )
        return Measured(number, dimension) if self.which else number

    def refuse_beyond(self, number: float, value: object, named: Dimension) -> None:
        """Raise QuantityError for a number [SI] beyond the limits.

        Parameters
        ----------
        value : object
            As it is written.
        """
        if self.above is not None and not number > self.above:
            if named.unit == "1" and number < 0.0 == self.above:
                raise refuse(quote_value(value), "a positive value", f"write {-number:g}")
            do = self.at_limit if number == self.above and self.at_limit else f"write it like {named.example}"
            raise refuse(quote_value(value), f"a positive value: {named.words}", do)
        if self.least is not None and not number >= self.least:
            raise refuse(
                quote_value(value),
                f"{self.words or named.words} of at least {self._shown(self.least)}",
                self.too_small.format(number=number, thousandfold=1e3 * number),
            )
        if self.below is not None and not number < self.below:
            raise refuse(
                quote_value(value), f"{named.words} below {self.below:g}", f"2 % is 0.02: did you mean {number:g} %?"
            )
        if self.most is not None and not number <= self.most:
            raise refuse(
                quote_value(value),
                f"{self.words or named.words} of at most {self._shown(self.most)}",
                self.too_large.format(number=number, thousandfold=1e3 * number),
            )

    def _shown(self, limit: float) -> str:
        unit = DIMENSIONS[self.dimensions[0]].unit
        return f"{limit:g}" if unit == "1" or not limit else f"{limit:g} {unit}"

    @property
    def unit(self) -> str:
        """Its unit in tables, "" of a ratio."""
        return DIMENSIONS[self.dimensions[0]].unit.replace("*", " ").removesuffix("1")

    @property
    def description(self) -> str:
        """What it is, with its unit: a length [m]."""
        return " or ".join(f"{DIMENSIONS[name].words} [{DIMENSIONS[name].unit}]" for name in self.dimensions)

    # What pydantic asks of an annotation, in mappings of its own: nothing here needs that package.

    def __get_pydantic_core_schema__(self, source: Any, handler: Callable[[Any], Any]) -> dict[str, Any]:
        return {"type": "function-plain", "function": {"type": "no-info", "function": self.read}}

    def __get_pydantic_json_schema__(self, schema: Mapping[str, Any], handler: object) -> dict[str, Any]:
        example = DIMENSIONS[self.dimensions[0]].example
        return {
            "anyOf": [{"type": "number"}, {"type": "string", "pattern": _PATTERN}],
            "description": f"{self.description}; a plain number is in SI units",
            "examples": [example],
        }


@dataclass(frozen=True)
class PowerStiffness:
    """Annotation of the positive stiffness k [N/m^n] of a force k d^n. exponent : the field that holds n."""

    exponent: str = "exponent"

    def read(self, value: object, exponent: float) -> float:
        """The value in SI units. Raises QuantityError for what is none."""
        number = power_stiffness(value, exponent)
        if not number > 0.0:
            raise refuse(quote_value(value), "a positive stiffness", f"write it like 1e6 {self.unit_of(exponent)}")
        return number

    def unit_of(self, exponent: float) -> str:
        """Its unit in tables."""
        return f"N/m^{exponent:g}"

    def _read(self, value: object, info: Any) -> float:
        return self.read(value, info.data[self.exponent]) if self.exponent in info.data else 1.0  # refused already

    def __get_pydantic_core_schema__(self, source: Any, handler: Callable[[Any], Any]) -> dict[str, Any]:
        return {"type": "function-plain", "function": {"type": "with-info", "function": self._read}}

    def __get_pydantic_json_schema__(self, schema: Mapping[str, Any], handler: object) -> dict[str, Any]:
        return {
            "anyOf": [{"type": "number"}, {"type": "string", "pattern": _PATTERN}],
            "description": f"a stiffness [N/m^{self.exponent}]; a plain number is in SI units",
            "examples": ["1e6 N/m^1.5"],
        }


Ratio = Annotated[float, Quantity(("ratio",), least=0.0, below=1.0)]
AnyRatio = Annotated[float, Quantity(("ratio",))]
Factor = Annotated[float, Quantity(("ratio",), above=0.0)]
LossFactor = Annotated[
    float, Quantity(("ratio",), least=0.0, most=1.0, too_large="2 % is 0.02: did you mean {number:g} %?")
]
Coordinate = Annotated[float, Quantity(("length",))]
Component = Annotated[float, Quantity(("ratio",))]
_MILLIMETRES: Final = "a plain number is in metres: did you mean {number:g} mm?"
SideLength = Annotated[float, Quantity(("length",), above=0.0, most=1000.0, too_large=_MILLIMETRES)]
LENGTH: Final = Quantity(("length",), above=0.0)
CELL: Final = Quantity(("length",), above=0.0, most=10.0, too_large=_MILLIMETRES)  # no element is longer
Length = Annotated[float, LENGTH]
Gap = Annotated[float, Quantity(("length",), least=0.0)]
MassKg = Annotated[float, Quantity(("mass",), above=0.0)]
FREQUENCY: Final = Quantity(("frequency",), above=0.0)
Frequency = Annotated[float, FREQUENCY]
Band = tuple[Annotated[float, Quantity(("frequency",), least=0.0)], Frequency]
Duration = Annotated[float, Quantity(("time",), above=0.0)]
Instant = Annotated[float, Quantity(("time",), least=0.0)]
Speed = Annotated[float, Quantity(("speed",))]
Modulus = Annotated[float, Quantity(("pressure",), above=0.0)]
Stiffness = Annotated[float, Quantity(("stiffness",), least=0.0)]
Dashpot = Annotated[float, Quantity(("damping",), least=0.0)]
Position2 = tuple[Coordinate, Coordinate]
Position3 = tuple[Coordinate, Coordinate, Coordinate]
Direction3 = tuple[Component, Component, Component]
