"""Frames as they are written."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from femstruct.language.parts.base import Library, PartSpec, Places, Surroundings
from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Steps
from femstruct.language.yaml.spec import Direction3, Length, Position3, Spec, Text
from femstruct.parts.frame import Frame


class OffsetsSpec(Spec):
    """Rigid arms from the ends of every line to the flexible bar, global axes."""

    start: Position3 = (0.0, 0.0, 0.0)
    end: Position3 = (0.0, 0.0, 0.0)


class FrameSpec(PartSpec):
    """Bars along polylines of global points; element: timoshenko18, bars of three nodes, or the bars of two nodes
    timoshenko, which needs more of them where shear matters, and euler, which has neither shear nor rotary inertia."""

    type: Literal["frame"]
    material: Text
    section: Text
    lines: Annotated[list[Annotated[list[Position3], Field(min_length=2)]], Field(min_length=1)]
    mesh: Length | None = None
    orientation: Direction3 | None = None
    element: Literal["timoshenko18", "timoshenko", "euler"] = "timoshenko18"
    offsets: OffsetsSpec = OffsetsSpec()

    has_nodes: ClassVar[bool] = True
    is_lined: ClassVar[bool] = True

    def check(self, steps: Steps, around: Surroundings) -> None:
        around.check.known((*steps, "material"), self.material, "material", around.materials)
        around.check.known((*steps, "section"), self.section, "section", around.sections)

    def check_place(self, steps: Steps, places: Places, check: Checker) -> None:
        if isinstance(places, str):
            check.wrong(steps, f"{places} of a frame", "global coordinates", "write [x, y, z]")
        elif any(len(place) != 3 for place in places):
            check.wrong(steps, f"{len(places[0])} coordinates", "3 on a frame", "global axes")

    def build(self, name: str, of: Library) -> Frame:
        return Frame(
            name,
            of.materials[self.material],
            of.sections[self.section],
            tuple(tuple(line) for line in self.lines),
            self.mesh,
            self.orientation,
            self.element,
            self.offsets.start,
            self.offsets.end,
        )
