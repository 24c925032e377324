"""What a part of a model file is to the language; its kinds stand beside, one file each."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import ClassVar

from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Steps
from femstruct.language.yaml.spec import Spec
from femstruct.model.material import Material
from femstruct.model.part import Part
from femstruct.model.section import Section

ROUNDING = 1e-9  # of a side: what a coordinate written in decimals may be off the edge
Places = str | tuple[tuple[float, ...], ...]
"""Where a point is, as it is written: center, top, bottom, or coordinates [m]."""


@dataclass(frozen=True)
class Surroundings:
    """What the names in a part may stand for. points : names of points and of their single places."""

    check: Checker
    points: Collection[str]
    materials: Collection[str]
    sections: Collection[str]
    parts: Mapping[str, PartSpec]

    def named(self, trait: str) -> list[str]:
        """Names of the parts that have a trait of `PartSpec`."""
        return [name for name, part in self.parts.items() if getattr(part, trait)]


@dataclass(frozen=True)
class Library:
    """What parts are made of, by name."""

    materials: Mapping[str, Material]
    sections: Mapping[str, Section]


class PartSpec(Spec):
    """A part; a kind overrides what it has.

    has_nodes : joints, points and supports can be on it. has_faces : layers can lie against it. has_edges : supports,
    surfaces and patches can be on its edges and areas. is_lined : masses can be spread along or over it.
    """

    has_nodes: ClassVar[bool] = False
    has_faces: ClassVar[bool] = False
    has_edges: ClassVar[bool] = False
    is_lined: ClassVar[bool] = False
    type: str

    def check(self, steps: Steps, around: Surroundings) -> None:
        """Note names that are not there, and keys that do not agree with each other."""

    @abstractmethod
    def build(self, name: str, of: Library) -> Part:
        """The noun it describes."""

    def check_place(self, steps: Steps, places: Places, check: Checker) -> None:
        """Note what is wrong with a point on it."""

    def place(self, word: str) -> tuple[float, ...]:
        """Coordinates of center, top or bottom."""
        raise NotImplementedError


def check_coordinates(
    steps: Steps, places: tuple[tuple[float, ...], ...], kind: str, size: tuple[float, ...], hint: str, check: Checker
) -> None:
    """Note coordinates of another number than the sides of a part, and places that are not on it."""
    if any(len(place) != len(size) for place in places):
        check.wrong(steps, f"{len(places[0])} coordinates", f"{len(size)} on a {kind}", hint)
        return
    for place in places:
        if not all(-ROUNDING * side <= x <= side * (1 + ROUNDING) for x, side in zip(place, size, strict=True)):
            expected = f"a place on the {kind}, {' x '.join(f'{side:g} m' for side in size)}"
            do = f"measure from the {kind}'s own corner, along its own axes"
            check.wrong(steps, f"{list(place)} m", expected, do)
