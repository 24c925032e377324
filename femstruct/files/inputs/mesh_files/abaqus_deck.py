"""Keywords of an input file of Abaqus, and what has been read of it so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from femstruct.arrays import Floats, Integers
from femstruct.files.inputs.mesh_files.text_lines import wrong_line
from femstruct.model.imported.gathering import Block
from femstruct.model.imported.imported_mesh import StatedHold, StatedLink, StatedMass, StatedProperty


class Keyword(NamedTuple):
    """A line with a star and the data that follow it. number : of the line, from 1."""

    path: Path
    number: int
    word: str
    options: Mapping[str, str]
    rows: list[tuple[int, list[str]]]

    def option(self, name: str) -> str:
        """The value of an option that it must have."""
        if not self.options.get(name):
            raise wrong_line(self.path, self.number, f"*{self.word} without {name}", f"{name}=...")
        return self.options[name]


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
    left_out: dict[str, int] = field(default_factory=dict)
    elements: dict[str, list[Integers]] = field(default_factory=dict)
    parts: list[str] = field(default_factory=list)
    instances: list[str] = field(default_factory=list)
