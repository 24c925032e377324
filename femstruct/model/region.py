"""Regions of a plane face, and the words for places that all parts share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Vector = tuple[float, float, float]
Pair = tuple[float, float]
Side = Literal["above", "below"]


@dataclass(frozen=True)
class Region:
    """A region of a plate: all of it, a rectangle, the rim of a rectangle, or a line.

    size : sides of the rectangle or rim [m]. at : its centre from the part's origin corner along the part's own axes
    [m], None for the centre of the part. line : the two ends of a line, part coordinates [m].
    """

    kind: Literal["whole", "rectangle", "rim", "line"]
    size: Pair | None = None
    at: Pair | None = None
    line: tuple[Pair, Pair] | None = None
