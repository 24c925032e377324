"""What has been read of a bulk data file of Nastran so far."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from femstruct.model.imported.imported_mesh import StatedLink, StatedMass, StatedMaterial

OF_GRID: Final = 0  # in place of the number of a set of supports: those of GRID, which always hold


@dataclass
class Bulk:
    """What has been read so far."""

    numbers: list[int] = field(default_factory=list)
    points: list[tuple[float, float, float]] = field(default_factory=list)
    cells: dict[str, list[list[int]]] = field(default_factory=dict)
    by_property: dict[int, list[int]] = field(default_factory=dict)
    shells: dict[int, tuple[float | None, str]] = field(default_factory=dict)
    solids: dict[int, tuple[None, str]] = field(default_factory=dict)
    materials: list[StatedMaterial] = field(default_factory=list)
    masses: list[StatedMass] = field(default_factory=list)
    links: list[StatedLink] = field(default_factory=list)
    holds: dict[tuple[int, str], list[int]] = field(default_factory=dict)
    sets: dict[str, list[int]] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    added: dict[int, list[int]] = field(default_factory=dict)  # sets of supports that SPCADD makes one
    chosen: list[int] = field(default_factory=list)  # sets of supports by SPC = N of the case control
    open_end: str = ""  # the word that would end the file, and its last card, where it has none
    mass_factor: float = 1.0
    ranged: set[int] = field(default_factory=set)  # nodes of cards with FIRST THRU LAST, some of which may be missing

    def leave_out(self, what: str) -> None:
        """Count what is not read."""
        self.left_out[what] = self.left_out.get(what, 0) + 1
