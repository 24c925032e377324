"""Hangers and channels of ceilings as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.language.model.like import entry_for, need_losses, told_of
from femstruct.language.model.material import Losses
from femstruct.language.parts.part import CEILING, FLOOR, PartSpec
from femstruct.language.yaml import (
    LENGTH,
    Here,
    Length,
    Measured,
    Position2,
    Quantity,
    Refers,
    Spec,
    Text,
    read_by,
    several,
)
from femstruct.model.library.all_entries import library
from femstruct.model.library.library_entry import Entry, Use
from femstruct.parts.hangers import Hangers

Hung = Annotated[Measured, Quantity(("stiffness", "stiffness/length"), least=0.0, which=True)]
OwnMass = Annotated[Measured, Quantity(("mass", "mass/length"), least=0.0, which=True)]
Spacing = Annotated[
    tuple[float, ...],
    read_by(several(LENGTH.read), Length | Annotated[list[Length], Field(min_length=1, max_length=2)]),
]


class HungSpec(Spec):
    """Stiffness of hangers: along the normal of the ceiling and both ways along it, of each or per length."""

    short = "normal"
    normal: Hung
    shear: Hung = Measured(0.0, None)


class HangersSpec(PartSpec):
    """Hangers, clips or channels between a floor, or its joists, and a ceiling: springs at places in a regular spacing
    (N/m each) or along lines (N/m^2); like: one of the library."""

    one_of = (("stiffness", "like"),)
    at_most_one_of = (("spacing", "at"), ("along", "at"))

    makes = Hangers
    type: Literal["hangers"]
    between: tuple[Annotated[Text, Refers(FLOOR)], Annotated[Text, Refers(CEILING)]] = Field(
        description="what carries, a floor or its joists, and the ceiling that hangs from it"
    )
    stiffness: HungSpec | None = None
    like: Annotated[Text | None, entry_for(Use.HANGERS, "hangers or channels of the library", "hangers")] = None
    spacing: Spacing = ()
    along: Literal["x", "y"] | None = None
    at: Annotated[list[Position2] | None, Field(min_length=1)] = None
    loss_factor: Losses = 0.0
    mass: OwnMass = Measured(0.0, None)

    @property
    def entry(self) -> Entry | None:
        """Of the library, that it is like."""
        return library()[self.like] if self.like else None

    @property
    def per(self) -> Literal["piece", "length"]:
        """What its stiffness is of."""
        if self.entry is not None:
            return "piece" if self.entry.fact("stiffness") else "length"
        written = self.stiffness.given().values() if self.stiffness else ()
        return "length" if any(one.dimension == "stiffness/length" for one in written) else "piece"

    def check(self, here: Here) -> None:
        first, second = self.between
        here.at("between").need(first != second, f"'{first}' twice", "two different parts")
        lines = self.per == "length"
        written = self.stiffness.given() if self.stiffness else {}
        kinds = {one.dimension == "stiffness/length" for one in written.values() if one.value}
        there = here.at("stiffness")
        if not there.need(len(kinds) < 2, "one stiffness per length, one of each", "both of one kind"):
            return
        something = self.stiffness is None or any(one.value for one in written.values())
        there.need(something, "no stiffness at all", "a positive normal or shear stiffness")
        here.at("mass").need(
            self.mass.value == 0.0 or (self.mass.dimension == "mass/length") == lines,
            "a mass of each" if lines else "a mass per length",
            "kg/m, as the stiffness is per length" if lines else "kg, as the stiffness is of each",
        )
        known = here.names.known
        if first in known["plate or frame"] and first not in known["plate or shell"]:
            self._check_bars(here, lines)
        else:
            self._check_below(here, lines)

    def _check_bars(self, here: Here, lines: bool) -> None:
        for key in ("at", "along"):
            got = f"'{key}' below a frame"
            here.at(key).need(getattr(self, key) is None, got, "places along its bars", f"remove '{key}'", of_key=True)
        if lines:
            here.at("spacing").need(not self.spacing, "a spacing", "lines along all bars", "remove it", of_key=True)
        else:
            got = f"{len(self.spacing)} numbers" if self.spacing else "nothing"
            here.at("spacing").need(
                len(self.spacing) == 1, got, "the spacing along the bars", "add 'spacing: 500 mm'", of_key=True
            )

    def _check_below(self, here: Here, lines: bool) -> None:
        there = here.at("spacing")
        if not lines:
            here.at("along").need(
                self.along is None, "a direction of springs one by one", "none", "remove 'along'", of_key=True
            )
            there.need(
                bool(self.spacing or self.at),
                "nothing",
                "'spacing' or 'at'",
                "add 'spacing: [600 mm, 900 mm]'",
                of_key=True,
            )
            return
        here.at("at").need(self.at is None, "places of lines", "lines in a 'spacing'", "remove 'at'", of_key=True)
        got = f"{len(self.spacing)} numbers" if self.spacing else "nothing"
        there.need(len(self.spacing) == 1, got, "one, across the lines", "add 'spacing: 500 mm'", of_key=True)
        here.at("along").need(
            self.along is not None,
            "nothing",
            "the axis of the ceiling that lines run along",
            "add 'along: x'",
            of_key=True,
        )

    def check_losses(self, here: Here) -> None:
        need_losses(here, self.like, "loss_factor" in self.model_fields_set)

    def given(self) -> dict[str, Any]:
        values, entry = super().given(), self.entry
        (on, to), written = values.pop("between"), values.pop("stiffness")
        spread = {key: one.value for key, one in (written or {}).items()}
        if entry is not None:
            spread["normal"] = entry.number("stiffness" if self.per == "piece" else "stiffness_per_length")
            if "loss_factor" not in self.model_fields_set:
                values["loss_factor"] = entry.number("loss_factor") or 0.0
        at = tuple(self.at or ())
        made = {"on": on, "to": to, "per": self.per, "at": at, "mass": self.mass.value, "like": told_of(self.like)}
        return {**values, **spread, **made}
