"""Structures in closed form as they are written: `structure:` in place of parts."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.errors import FemstructError
from femstruct.language.model.material import Modulus
from femstruct.language.model.point import PointSpec
from femstruct.language.model.section import Area
from femstruct.language.yaml import (
    Component,
    Coordinate,
    Count,
    Frequency,
    Here,
    Length,
    MassKg,
    Quantity,
    Ratio,
    Spec,
    read_by,
)
from femstruct.study.structures import BeamEnd, BeamModel, ModesModel, NoStructure, OscillatorModel, RodModel


class ClosedSpec(Spec):
    """A structure known in closed form."""

    type: str

    def structure(self, points: Mapping[str, PointSpec]) -> Any:
        """The noun it describes, with points along it."""
        return self.noun()

    def check_point(self, here: Here, point: PointSpec) -> None:
        """Note what is wrong with a point on it."""
        here.wrong(
            f"a point of structure '{self.type}'",
            "the structure's own 'points'" if self.type == "modes" else "no points: there is no structure",
            "move or remove it",
            of_key=True,
        )


class NoStructureSpec(ClosedSpec):
    """Only bodies and the ground."""

    makes = NoStructure
    type: Literal["none"]


class OscillatorSpec(ClosedSpec):
    """A mass on a spring, by its frequency or its stiffness."""

    one_of = (("frequency", "stiffness"),)

    type: Literal["oscillator"]
    mass: MassKg
    frequency: Frequency | None = None
    stiffness: Annotated[float, Quantity(("stiffness",), above=0.0)] | None = None

    def structure(self, points: Mapping[str, PointSpec]) -> OscillatorModel:
        return OscillatorModel(self.mass, self.frequency, self.stiffness, dict.fromkeys(points, 0.0))

    def check_point(self, here: Here, point: PointSpec) -> None:
        here.need(point.at is None and point.on is None, "a place", "{} for a point of an oscillator")


class AlongSpec(ClosedSpec):
    """What lies along x."""

    length: Length

    def structure(self, points: Mapping[str, PointSpec]) -> Any:
        along = {name: one.at[0][0] if isinstance(one.at, tuple) else self.length / 2 for name, one in points.items()}
        return self.noun(points=along)

    def check_point(self, here: Here, point: PointSpec) -> None:
        expected = f"a position from 0 to {self.length:g} m"
        for one in point.at if isinstance(point.at, tuple) else ():
            here.at("at").need(
                len(one) == 1 and 0 <= one[0] <= self.length,
                f"{one[0]:g} m" if len(one) == 1 else f"{len(one)} coordinates",
                f"{expected} along it",
            )
        here.at("at").need(point.at not in ("top", "bottom"), f"{point.at} of a {self.type}", expected, "write center")
        here.need(point.at is not None, "nothing", "'at'", "add 'at: 0'", of_key=True)
        here.at("on").need(point.on is None, "'on'", f"a position along the {self.type} only", "remove it", of_key=True)


class RodSpec(AlongSpec):
    """A free elastic rod along x."""

    makes = RodModel
    type: Literal["rod"]
    length: Length
    E: Modulus
    rho: Annotated[float, Quantity(("density",), above=0.0)]
    area: Area
    modes: Count = 50


class BeamSpec(AlongSpec):
    """A beam along x that deflects along z."""

    makes = BeamModel
    type: Literal["beam"]
    length: Length
    ends: tuple[BeamEnd, BeamEnd]
    EI: Annotated[float, Quantity(("bending stiffness",), above=0.0)]
    mass_per_length: Annotated[float, Quantity(("mass/length",), above=0.0)]
    modes: Count = 6


class GivenPointSpec(Spec):
    """A point of given modes: mass-normalised shapes [1/sqrt(kg)], and where it is along the axis they move along."""

    shape: list[Component]
    at: Coordinate | None = None


def _given_point(value: object) -> object:
    """The shapes alone, or with a position."""
    return {"shape": value} if isinstance(value, list) else value


GivenPoint = Annotated[GivenPointSpec, read_by(_given_point, list[Component] | GivenPointSpec)]


class GivenModesSpec(ClosedSpec):
    """Given modes: frequencies, damping ratios and mass-normalised shapes at points [1/sqrt(kg)]; a point that is above
    or below another says where, {shape: [..], at: 0.2 m}."""

    type: Literal["modes"]
    frequency: Annotated[list[Annotated[float, Quantity(("frequency",), least=0.0)]], Field(min_length=1)]
    ratio: list[Ratio] | None = None
    points: dict[str, GivenPoint]

    def structure(self, points: Mapping[str, PointSpec]) -> ModesModel:
        count = len(self.frequency)
        ratios = self.ratio if self.ratio is not None else [0.0] * count
        if len(ratios) != count:
            raise FemstructError("structure.ratio", got=f"{len(ratios)} ratios", expected=f"{count}, one a frequency")
        if any(later < former for former, later in pairwise(self.frequency)):
            told = ", ".join(f"{frequency:g}" for frequency in self.frequency)
            raise FemstructError("structure.frequency", got=f"[{told}] Hz", expected="frequencies that ascend")
        for name, point in self.points.items():
            if len(point.shape) != count:
                raise FemstructError(
                    f"structure.points.{name}", got=f"{len(point.shape)} values", expected=f"{count}, one a mode"
                )
        shapes = {name: tuple(point.shape) for name, point in self.points.items()}
        at = {name: point.at for name, point in self.points.items() if point.at is not None}
        return ModesModel(tuple(self.frequency), tuple(ratios), shapes, at)


def _structure(value: object) -> object:
    return {"type": "none"} if value == "none" else value


_Structures = Annotated[
    NoStructureSpec | OscillatorSpec | RodSpec | BeamSpec | GivenModesSpec, Field(discriminator="type")
]
StructureSpec = Annotated[_Structures, read_by(_structure, Literal["none"] | _Structures)]
