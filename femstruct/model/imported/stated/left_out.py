"""What a mesh file states and no reader makes: what it is, how often, and what it would change.

Whatever a file states is of one of four classes: used; of no effect on a linear model of vibration, with the reason
(`Makes.NOTHING`); not made, with what it would change; or malformed, which is refused with its line.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.tags import stored_as


@stored_as("what an unread entry makes/1")
class Makes(Enum):
    """What something of a file would make in a model; the most harmful first."""

    UNKNOWN = "unknown: stiffness, mass or supports, or a misspelt word"
    PRELOAD = "stiffness by the forces of a state before"
    ELEMENTS = "elements with stiffness and mass"
    SECTION = "stiffness or mass of cells"
    SPREAD = "mass of cells that does not stiffen"
    MATERIAL = "materials of cells"
    LAY_UP = "layers of cells"
    THICKNESS = "thickness of cells"
    OFFSET = "place of the middle of the thickness"
    ORIENTATION = "direction of the material of cells"
    BARS = "bars with stiffness and mass"
    SPRINGS = "springs and dashpots"
    MASSES = "masses"
    LINKS = "links between nodes"
    SUPPORTS = "held nodes"
    SLIGHT = "little"
    NOTHING = "nothing in a linear model of vibration"


HARMLESS: Final = (Makes.SLIGHT, Makes.NOTHING)
_ORDER: Final = list(Makes)


@stored_as("unread entry of a mesh file/1")
@dataclass(frozen=True, eq=False)
class LeftOut:
    """Something that a file states and no reader makes.

    what : as the file calls it. count : how often. line : of the first; 0 of a file without lines. makes : what it
    would make. changes : in words, what it would change, or why that is nothing. cells [n] : numbers of the elements
    that it is of; None for what is of the whole file.
    """

    what: str
    count: int
    line: int
    makes: Makes
    changes: str
    cells: Integers | None = None

    @property
    def named(self) -> str:
        """Its count, name and line: "3 CROD (line 7)"."""
        return f"{self.count} {self.what}{f' (line {self.line})' if self.line else ''}"

    @property
    def told(self) -> str:
        """As `named`, with what it would change."""
        return f"{self.named}: {self.changes}"


@dataclass
class Tally:
    """What a reader has left out so far, by its name.

    >>> tally = Tally()
    >>> for line in (7, 9):
    ...     tally.add("CROD", Makes.BARS, "rods: stiffness and mass", line)
    >>> [one.told for one in tally.found]
    ['2 CROD (line 7): rods: stiffness and mass']
    """

    _counts: dict[str, int] = field(default_factory=dict)
    _firsts: dict[str, tuple[int, Makes, str]] = field(default_factory=dict)
    _cells: dict[str, list[Integers]] = field(default_factory=dict)

    def add(
        self, what: str, makes: Makes, changes: str, line: int, cells: Iterable[int] | None = None, count: int = 1
    ) -> None:
        """Count it once more."""
        self._counts[what] = self._counts.get(what, 0) + count
        self._firsts.setdefault(what, (line, makes, changes))
        if cells is not None:
            self._cells.setdefault(what, []).append(np.fromiter(cells, np.int64))

    @property
    def found(self) -> tuple[LeftOut, ...]:
        """All of it, the most harmful first."""
        every = [
            LeftOut(
                what,
                count,
                *self._firsts[what],
                np.unique(np.concatenate(self._cells[what])) if what in self._cells else None,
            )
            for what, count in self._counts.items()
        ]
        return tuple(sorted(every, key=lambda one: (_ORDER.index(one.makes), one.line)))
