"""Regions of a plane face, and the words for places that all parts share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from femstruct.declared import checked
from femstruct.tags import stored_as

Vector = tuple[float, float, float]
Pair = tuple[float, float]
Side = Literal["above", "below"]
Facing = Literal["above", "below", "x", "-x", "y", "-y"]  # also of what stands upright: along global axes
Touched = Facing | Literal["middle"]  # where a foundation acts: on a face, or at the mid-surface


@stored_as("region/1")
@dataclass(frozen=True)
@checked("region")
class Region:
    """A region of a part: all of it; of a plate a rectangle, the rim of a rectangle or a line; of a part that is a mesh
    a named set of it, or what lies in a box.

    size : sides of the rectangle or rim [m]. at : its centre from the part's origin corner along the part's own axes
    [m], None for the centre of the part. line : the two ends of a line, part coordinates [m]. named : a set.
    box : lower and upper corner of a box, global axes [m].

    A rectangle of 0.3 m x 0.2 m about a place, the rim of one in the middle, and a line:

    >>> Region("rectangle", size=(0.3, 0.2), at=(1.0, 0.5)).at, Region("rim", size=(0.3, 0.2)).at
    ((1.0, 0.5), None)
    >>> print(Region("line", line=((0.0, 0.5), (2.0, 0.5))))
    line from (0, 0.5) to (2, 0.5) m
    """

    kind: Literal["whole", "rectangle", "rim", "line", "set", "box"]
    size: Pair | None = None
    at: Pair | None = None
    line: tuple[Pair, Pair] | None = None
    named: str | None = None
    box: tuple[Vector, Vector] | None = None

    def __str__(self) -> str:
        """The region in words.

        >>> str(Region("rectangle", size=(0.3, 0.2), at=(1.0, 0.5)))
        'rectangle of 0.3 x 0.2 m at (1, 0.5) m'
        """
        size = "" if self.size is None else f" of {self.size[0]:g} x {self.size[1]:g} m"
        at = "" if self.at is None else f" at ({self.at[0]:g}, {self.at[1]:g}) m"
        ends = "" if self.line is None else " from ({:g}, {:g}) to ({:g}, {:g}) m".format(*self.line[0], *self.line[1])
        named = "" if self.named is None else f" '{self.named}'"
        box = (
            ""
            if self.box is None
            else " from ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) m".format(*self.box[0], *self.box[1])
        )
        return f"{self.kind}{size}{at}{ends}{named}{box}"
