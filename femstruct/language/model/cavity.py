"""Cavities as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from femstruct.language.air import AirSpec
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
    read_by,
    several,
)
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
    for wool that is fixed."""

    makes = Fill
    flow_resistivity: Resistivity
    density: Bulk
    thickness: SideLength | None = None
    frame: Literal["limp", "held"] = "limp"


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
    between: tuple[SurfaceName, SurfaceName]
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
        values = super().given()
        first, second = values.pop("between")
        values.pop("air")
        return {**values, "first": first, "second": second, "c": self.air.c, "rho": self.air.rho}
