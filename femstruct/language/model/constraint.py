"""Constraints as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Final

from femstruct.conventions import DIRECTIONS
from femstruct.errors import shown_as
from femstruct.language.model.region import RegionSpec
from femstruct.language.yaml import (
    AnyRatio,
    Here,
    PointName,
    Refers,
    Spec,
    Text,
    exactly_one,
    read_by,
    refuse,
    words_of,
)
from femstruct.model.equations.average import Average
from femstruct.model.equations.constraint import Constraint
from femstruct.model.equations.equation import Equation
from femstruct.model.equations.rigid_link import RigidLink
from femstruct.model.equations.seam import Seam
from femstruct.model.region import Region

_REGIONS: Final = ("rim", "rectangle", "line", "set", "box")
_MEANT: Final = "write [P, Q], or {on: PART, set: NAME}"


class OthersSpec(RegionSpec):
    """Names of points, or a region of a part."""

    one_of = (("points", "on"),)
    points: tuple[Text, ...] | None = None
    on: Annotated[Text, Refers("part")] | None = None

    def check(self, here: Here) -> None:
        for number, name in enumerate(self.points or ()):
            there = here.at(number)
            (there if there.steps in here.tree.values else here).known(name, "point")


def _others(value: object) -> object:
    """One name of a point, several, or a region of a part."""
    names = [value] if isinstance(value, str) else value
    if isinstance(names, list) and names and all(isinstance(one, str) for one in names):
        return {"points": tuple(names)}
    if not isinstance(value, dict) or "points" in value:
        raise refuse(shown_as(value), "names of points, or a region of a part", _MEANT)
    if value.keys() <= {"on", "at", *_REGIONS}:
        exactly_one(value, _REGIONS, or_none=True)
    return value


Others = Annotated[OthersSpec, read_by(_others, Text | list[Text] | OthersSpec)]


class ConstraintSpec(Spec):
    """Equations between points: `rigid`, a point that others follow on rigid arms; `average`, a point that moves as the
    rigid motion that fits others best; `equation`, a sum of displacements, each by its factor, that stays zero; `seam`,
    the finer of two meshes that meet along a line, or solids with flat faces, with different nodes, and `onto`, the
    other."""

    one_of = (("rigid", "average", "equation", "seam"),)
    needs = (
        ("rigid", ("to",)),
        ("average", ("of",)),
        ("to", ("rigid",)),
        ("of", ("average",)),
        ("seam", ("onto",)),
        ("onto", ("seam",)),
    )
    at_most_one_of = (("directions", "equation"),)

    rigid: PointName | None = None
    to: Others | None = None
    average: PointName | None = None
    of: Others | None = None
    equation: dict[str, AnyRatio] | None = None
    seam: Others | None = None
    onto: Others | None = None
    directions: Annotated[tuple[str, ...], words_of(DIRECTIONS)] | None = None

    def check(self, here: Here) -> None:
        for spot in self.equation or ():
            here.at("equation", spot).spot(spot, of_key=True)
        for key in ("rigid", "average"):
            if (name := getattr(self, key)) is not None:
                here.at(key).place(name)
        for key in ("to", "of", "seam", "onto"):
            if (others := getattr(self, key)) is not None:
                others.check(here.at(key))
        for key in ("seam", "onto"):
            side = getattr(self, key)
            here.at(key).need(
                side is None or side.set is not None or side.box is not None,
                "no nodes of a mesh",
                "a set or a box of a part that is a mesh",
                "write {on: PART, set: NAME}",
            )
        if self.to is not None and self.to.on is not None:
            here.at("to").need(
                self.to.set is not None or self.to.box is not None,
                f"a region of {self.to.on}",
                "a set or a box of a part that is a mesh",
                "lay a rigid block on a plate: parts.NAME: {type: block, ...}, and a joint",
            )

    def noun(self, **others: Any) -> Constraint:
        """The kind of constraint that its keys say."""
        name: str = others["name"]
        if self.equation is not None:
            return Equation(name, self.equation)
        directions = self.directions or DIRECTIONS
        if self.seam is not None and self.onto is not None:
            sides = [(side.on or "", Region(**side.given())) for side in (self.seam, self.onto)]
            return Seam(name, *sides[0], *sides[1], directions)
        among = self.to if self.rigid is not None else self.of
        assert among is not None  # `needs` has seen to it
        region = None if among.on is None else Region(**among.given())
        if self.rigid is not None:
            return RigidLink(name, self.rigid, among.points or (), among.on, region, directions)
        return Average(name, self.average or "", among.points or (), among.on, region, directions)
