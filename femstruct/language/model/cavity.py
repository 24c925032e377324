"""Cavities as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.language.air import AirSpec
from femstruct.language.model.like import entry_for, told_of
from femstruct.language.yaml import (
    LENGTH,
    Frequency,
    Gap,
    Here,
    Length,
    Quantity,
    SideLength,
    Spec,
    SurfaceName,
    Text,
    brought,
    read_by,
    several,
)
from femstruct.model.library.all_entries import library, names_for
from femstruct.model.library.library_entry import Use
from femstruct.model.materials.air_between import AirBetween, Bays, Fill

Resistivity = Annotated[
    float,
    Quantity(
        ("flow resistivity",),
        above=0.0,
        least=100.0,
        most=1e6,
        too_small="mineral wool has 5 to 30 kPa*s/m^2; a plain number is in Pa*s/m^2",
        too_large="mineral wool has 5 to 30 kPa*s/m^2; a plain number is in Pa*s/m^2",
    ),
]
Bulk = Annotated[
    float,
    Quantity(
        ("density",),
        above=0.0,
        least=1.0,
        most=500.0,
        too_small="mineral wool has 10 to 200 kg/m^3",
        too_large="it is the density of the wool, not of its fibres: 10 to 200 kg/m^3",
    ),
]
Places = Annotated[tuple[float, ...], read_by(several(LENGTH.read), Length | list[Length])]


class FillSpec(Spec):
    """Wool in a cavity, against its second surface: all of the depth, or a thickness. frame: limp for loose wool, held
    for wool that is fixed. like: one of the library, which brings what is not given."""

    model_config = brought("flow_resistivity", "density")

    makes = Fill
    like: Annotated[Text | None, entry_for(Use.FILL, "a wool of the library", "wool")] = None
    flow_resistivity: Resistivity
    density: Bulk
    thickness: SideLength | None = None
    frame: Literal["limp", "held"] = "limp"

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        like, known = given.get("like"), names_for(Use.FILL)
        if like is None and given.keys() <= cls.keys():
            return given
        entry = library()[like if like in known else known[0]]  # a misspelt name or key is one mistake
        return {"flow_resistivity": entry.number("flow_resistivity"), "density": entry.number("rho"), **given}

    def given(self) -> dict[str, Any]:
        return {**super().given(), "like": told_of(self.like)}


class BaysSpec(Spec):
    """Joists that close a cavity: where their middles are along x or y of the first surface, from the corner of the
    cavity, and their width."""

    makes = Bays
    across: Literal["x", "y"]
    at: Places
    width: Gap = 0.0


class CavitySpec(Spec):
    """Air between two surfaces that face each other: a void over a ceiling, the inside of a double wall."""

    makes = AirBetween
    only_written = ("between", "air")
    between: tuple[SurfaceName, SurfaceName] = Field(
        description="two surfaces that face each other; wool lies on the second"
    )
    depth: SideLength
    air: AirSpec = AirSpec()
    fill: FillSpec | None = None
    bays: BaysSpec | None = None
    up_to: Frequency | None = None

    def check(self, here: Here) -> None:
        first, second = self.between
        here.at("between").need(first != second, f"'{first}' twice", "two surfaces that face each other")
        self.air.check(here.at("air"))
        thickness = None if self.fill is None else self.fill.thickness
        here.at("fill", "thickness").need(
            thickness is None or thickness <= self.depth * (1 + 1e-9),
            f"{thickness} m of wool in a cavity {self.depth:g} m deep",
            "at most the depth",
            "leave it out to fill the cavity",
        )

    def given(self) -> dict[str, Any]:
        first, second = self.between
        return {**super().given(), "first": first, "second": second, "c": self.air.c, "rho": self.air.rho}
