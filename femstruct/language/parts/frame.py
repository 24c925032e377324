"""Frames as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.elements.frame import FrameElement
from femstruct.language.parts.part import FLOOR, STRESSED, MaterialName, PartSpec, SectionName
from femstruct.language.yaml import CellSide, Direction3, Position3, Spec
from femstruct.parts.frame import Frame


class OffsetsSpec(Spec):
    """Rigid arms from the ends of every line to the flexible bar, global axes."""

    start: Position3 = (0.0, 0.0, 0.0)
    end: Position3 = (0.0, 0.0, 0.0)


class FrameSpec(PartSpec):
    """Bars along polylines of global points; element: timoshenko18, bars of three nodes, or the bars of two nodes
    timoshenko, which needs more of them where shear matters, and euler, which has neither shear nor rotary inertia."""

    makes = Frame
    known_as = ("part", "plate or frame", STRESSED, FLOOR)
    type: Literal["frame"]
    material: MaterialName
    section: SectionName
    lines: Annotated[list[Annotated[list[Position3], Field(min_length=2)]], Field(min_length=1)]
    mesh: CellSide | None = Field(
        default=None, description="largest side of an element [m]; without it one element a segment"
    )
    orientation: Direction3 | None = None
    element: FrameElement = "timoshenko18"
    offsets: OffsetsSpec = OffsetsSpec()

    def given(self) -> dict[str, Any]:
        values = super().given()
        arms = values.pop("offsets")
        lines = tuple(tuple(line) for line in self.lines)
        return {**values, "lines": lines, "start_offset": arms["start"], "end_offset": arms["end"]}
