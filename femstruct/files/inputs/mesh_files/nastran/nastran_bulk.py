"""What has been read of a bulk data file of Nastran so far."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, Literal, NamedTuple

from femstruct.files.inputs.mesh_files.nastran.bulk_cards import Card
from femstruct.model.imported.imported_mesh import StatedLayer, StatedLink, StatedMass, StatedMaterial
from femstruct.model.imported.stated.left_out import Makes, Tally

OF_GRID: Final = 0  # in place of the number of a set of supports: those of GRID, which always hold


class Shelled(NamedTuple):
    """A PSHELL. materials : of membrane, bending, shear and their coupling, 0 where it names none. bending : 12 I/T^3.
    shear : TS/T. nsm : mass per area. card : itself."""

    thickness: float | None
    materials: tuple[int, int, int, int]
    bending: float
    shear: float
    nsm: float
    card: Card


class Spread(NamedTuple):
    """Mass on the cells of properties, or on elements, by their numbers. what : as the card calls it. line : its first
    one. per : "area", or all of it."""

    what: str
    amount: float
    per: Literal["area", "total"]
    line: int
    properties: tuple[int, ...]
    elements: tuple[int, ...] = ()


@dataclass
class Bulk:
    """What has been read so far."""

    numbers: list[int] = field(default_factory=list)
    points: list[tuple[float, float, float]] = field(default_factory=list)
    placed: list[int] = field(default_factory=list)  # systems of the places of nodes
    moving: list[int] = field(default_factory=list)  # systems of their motion
    of_systems: dict[int, Card] = field(default_factory=dict)  # cards of nodes that have such a system
    systems: list[Card] = field(default_factory=list)
    cells: dict[str, list[list[int]]] = field(default_factory=dict)
    by_property: dict[int, list[int]] = field(default_factory=dict)
    bars: dict[str, list[int]] = field(default_factory=dict)  # numbers of bars by their card
    shells: dict[int, Shelled] = field(default_factory=dict)
    solids: dict[int, str] = field(default_factory=dict)  # material
    lay_ups: dict[int, tuple[StatedLayer, ...]] = field(default_factory=dict)  # layers of PCOMP
    corners: list[tuple[Card, int, int, list[float]]] = field(default_factory=list)  # card, element, property, T1..
    materials: list[StatedMaterial] = field(default_factory=list)
    masses: list[StatedMass] = field(default_factory=list)
    links: list[StatedLink] = field(default_factory=list)
    holds: dict[tuple[int, str], list[int]] = field(default_factory=dict)
    sets: dict[str, list[int]] = field(default_factory=dict)
    left_out: Tally = field(default_factory=Tally)
    of_property: list[tuple[int, str, Makes, str, int]] = field(default_factory=list)  # left out, of cells to come
    spread: list[Spread] = field(default_factory=list)
    added: dict[int, list[int]] = field(default_factory=dict)  # sets of supports that SPCADD makes one
    chosen: list[int] = field(default_factory=list)  # sets of supports by SPC = N of the case control
    open_end: str = ""  # the word that would end the file, and its last card, where it has none
    mass_factor: float = 1.0
    ranged: set[int] = field(default_factory=set)  # nodes of cards with FIRST THRU LAST, some of which may be missing
    of_grids: Card | None = None  # GRDSET: what GRID leaves out

    def leave_out_of(self, number: int, what: str, makes: Makes, changes: str, line: int) -> None:
        """Count what is not made of all cells of a property, which may stand further down."""
        self.of_property.append((number, what, makes, changes, line))
