"""Keywords of an input file of Abaqus, and what has been read of it so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from femstruct.arrays import Floats, Integers
from femstruct.files.inputs.mesh_files.text_lines import wrong_line
from femstruct.model.imported.gathering import Block
from femstruct.model.imported.imported_mesh import StatedHold, StatedLink, StatedMass, StatedProperty, StatedSpread
from femstruct.model.imported.stated.left_out import Makes, Tally


class Keyword(NamedTuple):
    """A line with a star and the data that follow it. number : of the line, from 1. word : in capitals, without blanks;
    written : with those of the file."""

    path: Path
    number: int
    word: str
    options: Mapping[str, str]
    rows: list[tuple[int, list[str]]]
    written: str

    def option(self, name: str) -> str:
        """The value of an option that it must have."""
        if not self.options.get(name):
            raise wrong_line(self.path, self.number, f"*{self.word} without {name}", f"{name}=...")
        return self.options[name]

    def leave_out(self, deck: Deck, makes: Makes, changes: str, what: str = "") -> None:
        """Count it, or what it does, among what is left out."""
        deck.left_out.add(f"*{what or self.written}", makes, changes, self.number)


def known_as(sets: Mapping[str, object], name: str) -> str:
    """The name of a set as it was written first: Abaqus does not tell small letters from large ones."""
    name = name.strip().strip('"')
    return next((one for one in sets if one.upper() == name.upper()), name) if name not in sets else name


@dataclass
class Deck:
    """What has been read so far. lumps : nodes of elements of type MASS, by their sets. surfaces : nodes of
    those of TYPE=NODE, and their weights. coupling : the last *COUPLING, which the next keyword completes."""

    nodes: list[Integers] = field(default_factory=list)
    points: list[Floats] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    node_sets: dict[str, list[Integers]] = field(default_factory=dict)
    cell_sets: dict[str, list[Integers]] = field(default_factory=dict)
    properties: list[StatedProperty] = field(default_factory=list)
    materials: dict[str, dict[str, float]] = field(default_factory=dict)
    masses: list[StatedMass] = field(default_factory=list)
    links: list[StatedLink] = field(default_factory=list)
    holds: list[StatedHold] = field(default_factory=list)
    lumps: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, tuple[Integers, tuple[float, ...]]] = field(default_factory=dict)
    coupling: Keyword | None = None
    left_out: Tally = field(default_factory=Tally)
    of_sets: list[tuple[str, str, Makes, str, int]] = field(default_factory=list)  # left out, of cells to come
    spread: list[tuple[str, StatedSpread, int]] = field(default_factory=list)  # set, mass on it, line
    others: list[int] = field(default_factory=list)  # elements that are left out, which sets may name
    turned: list[Integers] = field(default_factory=list)  # nodes with directions of their own, of *TRANSFORM
    turned_at: int = 0
    anew: int = 0  # the last step that lets go of what was held before
    elements: dict[str, list[Integers]] = field(default_factory=dict)
    parts: list[str] = field(default_factory=list)
    instances: list[str] = field(default_factory=list)
