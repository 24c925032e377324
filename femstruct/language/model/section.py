"""Cross-sections of bars as they are written."""

from __future__ import annotations

from collections.abc import Callable
from inspect import getdoc, signature
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Tag, create_model

from femstruct.language.yaml import Factor, Here, Length, Quantity, Spec
from femstruct.model import section

Area = Annotated[float, Quantity(("area",), above=0.0)]
SecondMoment = Annotated[float, Quantity(("second moment",), above=0.0)]


class ConstantsSpec(Spec):
    """A cross-section by its constants; shear coefficients 5/6 unless given."""

    makes = section.Section
    A: Area
    Iy: SecondMoment
    Iz: SecondMoment
    J: SecondMoment
    ky: Factor = 5.0 / 6.0
    kz: Factor = 5.0 / 6.0


class ShapeSpec(Spec):
    """A cross-section by its outline."""

    shape: str

    def check(self, here: Here) -> None:
        """Note a wall thicker than half of what it is the wall of."""
        sides = self.given()
        thickness, least = sides.pop("thickness", 0.0), min(sides.values())
        here.at("thickness").need(2 * thickness < least, f"{thickness:g} m", f"less than half of {least:g} m")


def _outlined(word: str, function: Callable[..., section.Section]) -> Any:
    """The spec of a shape: the keys are the arguments of its function, all of them lengths."""
    keys: Any = dict.fromkeys(list(signature(function).parameters)[1:], (Length, ...))
    doc = (getdoc(function) or "").partition("\n\n")[0]
    keys["shape"] = (Literal[word], ...)
    spec = create_model(f"{word.capitalize()}Spec", __base__=ShapeSpec, __doc__=doc, **keys)
    spec.makes = function
    return Annotated[spec, Tag(word)]


def _shape(value: Any) -> Any:
    """Its shape; `given` for one with a constant and without a shape, None for one with neither."""
    if not isinstance(value, dict):
        return "given"
    return value.get("shape", "given" if value.keys() & ConstantsSpec.keys() else None)


if TYPE_CHECKING:
    AnySection = ConstantsSpec | ShapeSpec
else:
    AnySection = Annotated[
        _outlined("rectangle", section.rectangle)
        | _outlined("circle", section.circle)
        | _outlined("tube", section.tube)
        | _outlined("box", section.box)
        | _outlined("I", section.i_section)
        | Annotated[ConstantsSpec, Tag("given")],
        Discriminator(_shape),
    ]
