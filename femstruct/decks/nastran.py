"""Bulk data files of Nastran (.bdf, .dat, .nas): coordinate systems, case control, sections, supports, and the mesh."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, Literal, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.decks.nastran_cards import (
    COMMANDS,
    CONTROL,
    FIELDS_WITHOUT_EFFECT,
    LEFT_OUT,
    OF_GRID,
    OUTPUT,
    PARAMETERS,
    READ_COMMANDS,
    WITHOUT_EFFECT,
    Bulk,
    Card,
    DeckLine,
    Shelled,
    SpreadMass,
    cards_of,
)
from femstruct.decks.stated import in_global_directions
from femstruct.errors import InputError, list_some
from femstruct.files.text_tables import lines_of, wrong_line
from femstruct.model.imported_mesh import (
    CellBlock,
    Gathered,
    Makes,
    Stated,
    StatedHold,
    StatedLayer,
    StatedLink,
    StatedMass,
    StatedMaterial,
    StatedProperty,
    StatedSpread,
)

# ----------------------------------------------------------------------------------------------------------------------
# Coordinate systems of Nastran: rectangular, cylindrical and spherical, by points or by nodes, and places in them.
# ----------------------------------------------------------------------------------------------------------------------

BASIC: Final = 0
_NEAR: Final = 1e-12  # of unit vectors: rounding


class _Frame(NamedTuple):
    """A system: its origin [3] and its axes [3, 3] as rows, in basic coordinates; the letter of its kind, R, C or S."""

    origin: Floats
    axes: Floats
    kind: str

    def basic(self, places: Floats) -> Floats:
        """Basic coordinates [n, 3] of places [n, 3] in it; angles are in degrees."""
        first, second, third = places.T
        if self.kind == "C":  # r, theta, z
            angle = np.radians(second)
            places = np.stack([first * np.cos(angle), first * np.sin(angle), third], axis=1)
        elif self.kind == "S":  # r, theta from the z axis, phi about it
            tilt, turn = np.radians(second), np.radians(third)
            flat = first * np.sin(tilt)
            places = np.stack([flat * np.cos(turn), flat * np.sin(turn), first * np.cos(tilt)], axis=1)
        return np.asarray(self.origin + places @ self.axes)


class Systems:
    """Systems of a file by their numbers. cards : CORD2R and its like, each with those of CORD1R apart."""

    def __init__(self, cards: Sequence[Card]) -> None:
        self._cards: dict[int, tuple[Card, int]] = {}
        for card in cards:
            for first in (0, 4) if card.name[4] == "1" else (0,):
                if first == 0 or card.field(first):
                    number = card.whole(first)
                    if number in self._cards:
                        raise card.refuse(f"the number {number} again", "systems whose numbers differ")
                    self._cards[number] = card, first
        self._found: dict[int, _Frame] = {BASIC: _Frame(np.zeros(3), np.eye(3), "R")}
        self._asked: list[int] = []

    def places(self, numbers: Integers, points: Floats, of: Integers, where: Mapping[int, Card]) -> Floats:
        """Basic coordinates [n, 3] of nodes.

        Parameters
        ----------
        numbers : Integers [n]
            Of them.
        points : Floats [n, 3]
            In the system of each.
        of : Integers [n]
            Numbers of these.
        where : Mapping[int, Card]
            Cards of those that are in another system than the basic one.

        Raises
        ------
        InputErrors
        """
        found = np.array(points)
        self._rows = {int(node): row for row, node in enumerate(numbers.tolist())} if self._cards else {}
        self._points, self._of, self._where = points, of, where
        for system in np.unique(of[of != BASIC]).tolist():
            rows = np.flatnonzero(of == system)
            found[rows] = self._frame(int(system), where[int(numbers[rows[0]])]).basic(points[rows])
        return found

    def turned(self, numbers: Integers, of: Integers, where: Mapping[int, Card]) -> Integers:
        """Nodes whose directions are not the basic ones.

        Parameters
        ----------
        of : Integers [n]
            Numbers of the systems of their motion.
        """
        along = [
            system
            for system in np.unique(of).tolist()
            if (frame := self._frame(int(system), where[int(numbers[of == system][0])]) if system else None) is None
            or (frame.kind == "R" and np.abs(frame.axes - np.eye(3)).max() < _NEAR)
        ]
        return numbers[~np.isin(of, along)]

    def _frame(self, system: int, asking: Card) -> _Frame:
        """A system by its number, whatever it is defined in."""
        if system in self._found:
            return self._found[system]
        if system not in self._cards:
            raise asking.refuse(f"the coordinate system {system}, which the file does not have", "one of its own")
        if system in self._asked:
            raise asking.refuse(f"the coordinate system {system}, which is defined by itself", "one that is not")
        self._asked.append(system)
        card, first = self._cards[system]
        if card.name[4] == "1":
            three = np.stack([self._node(card, card.whole(first + 1 + at)) for at in range(3)])
        else:
            given = np.array([card.real(2 + at, 0.0) for at in range(9)]).reshape(3, 3)
            three = self._frame(card.whole(1, default=BASIC), card).basic(given)
        z, to = three[1] - three[0], three[2] - three[0]
        y = np.cross(z, to)
        if not np.linalg.norm(y) > _NEAR * np.linalg.norm(z) * np.linalg.norm(to):
            raise card.refuse("three points on a line", "three that span its plane x z")
        z, y = z / np.linalg.norm(z), y / np.linalg.norm(y)
        self._found[system] = _Frame(three[0], np.stack([np.cross(y, z), y, z]), card.name[5])
        self._asked.pop()
        return self._found[system]

    def _node(self, card: Card, node: int) -> Floats:
        if node not in self._rows:
            raise card.refuse(f"node {node}, which the file does not have", "nodes of its own")
        row = self._rows[node]
        system = int(self._of[row])
        frame = self._found[BASIC] if system == BASIC else self._frame(system, self._where[node])
        return np.asarray(frame.basic(self._points[row][None])[0])


# ----------------------------------------------------------------------------------------------------------------------
# The case control of a bulk data file of Nastran: its sets, the supports that it puts to use, and its commands.
# ----------------------------------------------------------------------------------------------------------------------


class Control(NamedTuple):
    """What the case control says. sets : by name. chosen : numbers of the sets of supports that hold; masses : of
    mass on cells. commands : each
    command NAME = VALUE with its first line, from 1. whole : whether there is a case control at all."""

    sets: dict[str, list[int]]
    chosen: list[int]
    commands: dict[str, int]
    whole: bool
    masses: list[int]


def case_control(lines: Sequence[DeckLine]) -> Control:
    """What lines of the case control say.

    SET 5 = 1, 2, 7 THRU 9: a line that ends in a comma goes on. SPC = 1 names the supports. Raises InputErrors.

    >>> from pathlib import Path
    >>> texts = ["CEND", "SPC = 2", "SET 5 = 1,", "7 THRU 9"]
    >>> found = case_control([DeckLine(Path("a.bdf"), number, text) for number, text in enumerate(texts, 1)])
    >>> found.sets, found.chosen, found.commands
    ({'SET 5': [1, 7, 8, 9]}, [2], {'SPC': 2})
    """
    sets: dict[str, list[int]] = {}
    chosen: list[int] = []
    masses: list[int] = []
    commands: dict[str, int] = {}
    pending, first = "", 0
    for one in lines:
        text = one.text.split("$", 1)[0].strip()
        pending, first = (pending + " " + text, first) if pending else (text, one.number)
        if pending.endswith(","):
            continue
        if (spc := re.match(r"SPC\s*=\s*(\d+)\s*$", pending, re.IGNORECASE)) is not None:
            chosen.append(int(spc[1]))
        if (nsm := re.match(r"NSM\s*=\s*(\d+)\s*$", pending, re.IGNORECASE)) is not None:
            masses.append(int(nsm[1]))
        command = re.match(r"(\w+)\s*(?:\([^)]*\))?\s*=\s*(\S+)", pending)
        if command is not None and command[2].upper() != "NONE":
            commands.setdefault(command[1].upper(), first)
        found = re.match(r"SET\s+(\d+)\s*=\s*(.*)", pending, re.IGNORECASE)
        pending = ""
        if found is None or "ALL" in found[2].upper():
            continue
        card = Card(one.path, first, "SET", [found[1], *re.split(r"[,\s]+", found[2].strip())], set())
        if "EXCEPT" in (word.upper() for word in card.fields):
            raise wrong_line(one.path, first, "SET with EXCEPT", "the numbers that belong to it")
        sets[f"SET {found[1]}"] = card.several(1)
    whole = any(one.text.strip().upper().startswith("CEND") for one in lines)
    return Control(sets, chosen, commands, whole, masses)


# ----------------------------------------------------------------------------------------------------------------------
# Sections of the shells of Nastran: what PSHELL, PCOMP and elements state of cells, and what of it is not made.
# ----------------------------------------------------------------------------------------------------------------------

SAME: Final = 1e-3  # of a thickness or a factor: cards have few digits
_SHEAR: Final = 5.0 / 6.0  # TS/T of a homogeneous shell, as it is here


def pshell(card: Card, bulk: Bulk) -> None:
    """A section, which is judged once its cells are known."""
    thickness = card.real(2) if card.field(2) else None
    materials = (card.whole(1, 0), card.whole(3, 0), card.whole(5, 0), card.whole(10, 0))
    number = card.whole(0)
    bulk.shells[number] = Shelled(
        thickness, materials, card.real(4, 1.0), card.real(6, _SHEAR), card.real(7, 0.0), card
    )


def pcomp(card: Card, bulk: Bulk) -> None:
    """A lay-up: rows of a material, a thickness and an angle, which stand for the former ones where they are blank."""
    number, named = card.whole(0), card.name == "PCOMPG"
    doubled = card.field(7).upper() == "SYM"
    layers: list[StatedLayer] = []
    material, thickness, angle = "", 0.0, 0.0
    first, width = 8, 8 if named else 4
    for at in range(first, len(card.fields), width):
        shift = 1 if named else 0
        words = [card.field(at + shift + one) for one in range(3)]
        if not any(words):
            continue
        material = f"material {words[0]}" if words[0] else material
        thickness = card.real(at + shift + 1, thickness)
        angle = card.real(at + shift + 2, 0.0)
        layers.append(StatedLayer(material, thickness, angle))
    card.seen.update(range(len(card.fields)))
    made = bulk.lay_ups[number] = tuple(layers + layers[::-1] if doubled else layers)
    owner, line = f"{card.name} {number}", card.number
    bulk.leave_out_of(number, owner, Makes.LAY_UP, f"{len(made)} layers", line)
    if card.real(2, 0.0):
        bulk.spread.append(SpreadMass(f"NSM of {owner}", card.real(2), "area", line, (number,)))
    if (word := card.field(7).upper()) not in ("", "SYM"):
        bulk.leave_out_of(number, f"LAM {word} of {owner}", Makes.SECTION, "layers that act otherwise", line)
    total = sum(one.thickness for one in made)
    if card.field(1) and made and abs(card.real(1) + total / 2.0) > SAME * total:
        what = "the lowest face is not half the thickness below the nodes"
        bulk.leave_out_of(number, f"Z0 of {owner}", Makes.OFFSET, what, line)


def nsm(card: Card, bulk: Bulk) -> bool:
    """Mass on the cells of properties or elements: NSM and NSML with a number and a value each, NSM1 and NSML1 with one
    value; NSML and NSML1 have all of it, the others what is on an area. False for that of bars."""
    kind = card.field(1).upper()
    if kind not in ("PSHELL", "PCOMP", "ELEMENT"):
        return False
    per: Literal["area", "total"] = "total" if card.name.startswith("NSML") else "area"
    if card.name.endswith("1"):
        if "ALL" in (word.upper() for word in card.fields[3:]):
            return False
        pairs = [(card.several(3), card.real(2))]
    else:
        pairs = [([card.whole(at)], card.real(at + 1)) for at in range(2, len(card.fields), 2) if card.field(at)]
    for numbers, amount in pairs:
        what = f"{card.name} of {kind} {list_some([str(one) for one in numbers])}"
        if kind == "ELEMENT" or per == "total":
            properties = () if kind == "ELEMENT" else tuple(numbers)
            elements = tuple(numbers) if kind == "ELEMENT" else ()
            bulk.spread.append(SpreadMass(what, amount, per, card.number, properties, elements))
        else:
            bulk.spread += [SpreadMass(what, amount, per, card.number, (one,)) for one in numbers]
    return True


def spread_on(bulk: Bulk) -> list[StatedSpread]:
    """Mass on cells that are there, and count it, for parts that do not take it."""
    found = []
    for one in bulk.spread:
        cells = [*one.elements, *(cell for number in one.properties for cell in bulk.by_property.get(number, []))]
        if cells:
            amount = bulk.mass_factor * one.amount
            changes = f"{amount:g} of mass {'per area' if one.per == 'area' else 'in all'}, which does not stiffen"
            bulk.left_out.add(one.what, Makes.SPREAD, changes, one.line, cells)
            found.append(StatedSpread(one.what, np.array(cells, np.int64), amount, one.per))
    return found


def judge_shells(bulk: Bulk) -> None:
    """Count what is stated of cells and not made: mass per area, membranes, other materials of bending, factors, and
    thicknesses at corners that are not those of the section."""
    left = bulk.left_out
    for number, what, makes, changes, line in bulk.of_property:
        if cells := bulk.by_property.get(number):
            left.add(what, makes, changes, line, cells)
    constants = {one.name: dict(one.constants) for one in bulk.materials}
    for number, one in bulk.shells.items():
        if cells := bulk.by_property.get(number):
            owner, line = f"PSHELL {number}", one.card.number
            if one.nsm:
                bulk.spread.append(SpreadMass(f"NSM of {owner}", one.nsm, "area", line, (number,)))
            for what, makes, changes in (*_bends_otherwise(owner, one, constants), *_shears(owner, one, constants)):
                left.add(what, makes, changes, line, cells)
    _judge_corners(bulk)


_LeftOut = tuple[str, Makes, str]  # what is not made, what that makes wrong, and how


def _bends_otherwise(whose: str, one: Shelled, constants: Mapping[str, Mapping[str, float]]) -> Iterator[_LeftOut]:
    """What a section has of bending that a plate of its first material does not have.

    Parameters
    ----------
    constants : Mapping[str, Mapping[str, float]]
        By material.
    """
    membrane, bending, _, _ = one.materials
    differ = [m for m in (membrane, bending) if m > 0]
    if not bending:
        yield f"{whose} without MID2", Makes.SECTION, "a membrane, without stiffness in bending"
    elif not membrane:
        yield f"{whose} without MID1", Makes.SECTION, "bending without stiffness in its plane"
    elif bending < 0 or (len(set(differ)) > 1 and not _same(differ, constants)):
        what = "another material of bending than in the plane" if bending > 0 else "plane strain"
        yield f"MID2 of {whose}", Makes.SECTION, what
    if abs(one.bending - 1.0) > SAME:
        yield f"12I/T^3 of {whose}", Makes.SECTION, f"stiffness in bending times {one.bending:g}"


def _shears(whose: str, one: Shelled, constants: Mapping[str, Mapping[str, float]]) -> Iterator[_LeftOut]:
    """The same of shear across the thickness, and of bending that stretches."""
    _, bending, shear, coupled = one.materials
    if bending and not shear:
        yield f"{whose} without MID3", Makes.SLIGHT, "no shear across the thickness, here it has"
    elif shear and (abs(one.shear - _SHEAR) > SAME or not _same([shear, bending], constants)):
        yield f"MID3 or TS/T of {whose}", Makes.SECTION, "another stiffness in shear"
    if coupled:
        yield f"MID4 of {whose}", Makes.SECTION, "bending that is coupled to stretch"


def _judge_corners(bulk: Bulk) -> None:
    """Count cells whose thickness at the corners is not that of their section."""
    for card, number, of, values in bulk.corners:
        section = bulk.shells.get(of)
        t = None if section is None else section.thickness
        if values and t is not None and all(one < 0.0 or abs(one - t) <= SAME * t for one in values):
            continue
        what = f"T1, T2, .. of {card.name}"
        bulk.left_out.add(what, Makes.THICKNESS, "a thickness at each corner", card.number, [number])


def _same(numbers: list[int], constants: Mapping[str, Mapping[str, float]]) -> bool:
    """Whether materials are one, or have the same constants."""
    first, *others = [constants.get(f"material {number}", {"": float(number)}) for number in numbers]
    return len(set(numbers)) == 1 or (bool(first) and all(one == first for one in others))


# ----------------------------------------------------------------------------------------------------------------------
# Cards of Nastran that state what is beside the mesh: supports, links, masses.
# ----------------------------------------------------------------------------------------------------------------------


def conm2(card: Card, bulk: Bulk) -> None:
    """A mass with its offset and its moments of inertia."""
    if card.whole(2, default=0):
        raise card.refuse(f"the coordinate system {card.field(2)}", "0, the basic one")
    i11, i21, i22, i31, i32, i33 = (card.real(8 + at, 0.0) for at in range(6))
    offset = (card.real(4, 0.0), card.real(5, 0.0), card.real(6, 0.0))
    # the card has the products of inertia with the sign that they have here: minus those of the tensor
    inertia = (i11, i22, i33, i21, i32, i31)
    bulk.masses.append(StatedMass(card.whole(1), card.real(3), offset, inertia))


def rbe2(card: Card, bulk: Bulk) -> None:
    """Nodes that follow another as a rigid body does."""
    fields = card.fields
    last = next((at for at in range(len(fields) - 1, 2, -1) if fields[at]), 2)
    if last > 3 and "." in fields[last]:  # a coefficient of thermal expansion ends it
        card.seen.add(last)
        fields = fields[:last]
    nodes = card._replace(fields=fields).several(3)
    if not nodes:
        raise card.refuse("no node that follows", "GM1, GM2, ...")
    bulk.links.append(StatedLink(card.whole(1), np.array(nodes), _directions(card, 2)))


def rbe3(card: Card, bulk: Bulk) -> None:
    """A node that follows the mean of others: groups of a weight, directions of theirs, and their numbers."""
    nodes: list[int] = []
    weights: list[float] = []
    weight, of_group, fresh = 0.0, "", False
    for index in range(4, len(card.fields)):
        word = card.field(index)
        if word.upper() in ("UM", "ALPHA"):
            if word.upper() == "UM":
                card.seen.update(range(len(card.fields)))
                bulk.left_out.add("RBE3 with UM", Makes.LINKS, "an average of nodes", card.number)
                return
            card.seen.update(range(index, len(card.fields)))  # thermal expansion
            break
        if "." in word:
            weight, fresh = card.real(index), True
        elif word and fresh:
            of_group, fresh = word, False
        elif word:
            if "".join(sorted(of_group)) != "123":
                what = f"RBE3 of directions {of_group}"
                card.seen.update(range(len(card.fields)))
                bulk.left_out.add(what, Makes.LINKS, "an average of nodes", card.number)
                return
            nodes.append(card.whole(index))
            weights.append(weight)
    if not nodes or not min(weights) >= 0.0 < sum(weights):
        raise card.refuse(f"{len(nodes)} nodes with a weight", "WT1, C1, G1,1, ...")
    bulk.links.append(StatedLink(card.whole(2), np.array(nodes), _directions(card, 3), tuple(weights)))


def spc1(card: Card, bulk: Bulk) -> None:
    """Nodes that are held in the same directions."""
    nodes = card.several(2)
    if "THRU" in (word.upper() for word in card.fields):
        bulk.ranged |= set(nodes)
    hold(card, bulk, card.whole(0), 1, nodes)


def spc(card: Card, bulk: Bulk) -> None:
    """One or two nodes, their directions and what they are moved by."""
    for first in (1, 4):
        if first == 4 and not card.field(first):
            continue
        if card.real(first + 2, 0.0):
            card.seen.update(range(7))
            bulk.left_out.add("SPC that moves a node", Makes.SUPPORTS, "a held node", card.number)
        else:
            hold(card, bulk, card.whole(0), first + 1, [card.whole(first)])


def hold(card: Card, bulk: Bulk, number: int, directions: int, nodes: list[int]) -> None:
    """Nodes of a set of supports, held in the directions of a field of a card."""
    held = "".join(str(one + 1) for one in _directions(card, directions))
    bulk.holds.setdefault((number, held), []).extend(nodes)


def spcadd(card: Card, bulk: Bulk) -> None:
    """Sets of supports that hold together."""
    bulk.added[card.whole(0)] = card.several(1)


def param(card: Card, bulk: Bulk) -> None:
    """The factor of all masses; of the others a table says whether they matter to a linear model of vibration."""
    name = card.field(0).upper()
    card.seen.update(range(len(card.fields)))
    if name == "WTMASS":
        bulk.mass_factor = card.real(1)
    elif name in PARAMETERS:
        bulk.left_out.add(f"PARAM, {name}", *PARAMETERS[name], card.number)
    elif name in CONTROL:
        bulk.left_out.add("PARAM", Makes.NOTHING, "control of the solution and its output", card.number)
    else:
        bulk.left_out.add(f"PARAM, {name}", Makes.SLIGHT, "a parameter that is not known here", card.number)


def _directions(card: Card, index: int) -> tuple[int, ...]:
    word = card.field(index)
    if not re.fullmatch(r"[1-6]+", word):
        raise card.refuse(f"'{word}' in field {index + 2}", "directions out of 1 to 6")
    return tuple(sorted({int(digit) - 1 for digit in word}))


# ----------------------------------------------------------------------------------------------------------------------
# Meshes of Nastran: bulk data files, .bdf, .dat, .nas.
#
# Cards and the order of nodes are those of the Quick Reference Guide of MSC Nastran.
# ----------------------------------------------------------------------------------------------------------------------

# Corner nodes and all nodes of a kind, and the first field of its nodes.
_CELLS: Final[Mapping[str, tuple[tuple[str, int], ...]]] = {
    "CTRIA3": (("tri3", 3),),
    "CQUAD4": (("quad4", 4),),
    "CTRIAR": (("tri3", 3),),
    "CQUADR": (("quad4", 4),),
    "CTRIA6": (("tri6", 6),),
    "CQUAD8": (("quad8", 8),),
    "CTETRA": (("tet4", 4), ("tet10", 10)),
    "CHEXA": (("hex8", 8), ("hex20", 20)),
    "CBAR": (("line2", 2),),
    "CBEAM": (("line2", 2),),
}
_BARS: Final = ("CBAR", "CBEAM")
_HEX20: Final = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]  # edges between the faces come before those of the top
# First field of THETA, of ZOFFS, and of thicknesses at corners, and that which says what those are.
_OF_SHELLS: Final[Mapping[str, tuple[int, int, int, int]]] = {
    "CQUAD4": (6, 7, 10, 9),
    "CQUADR": (6, 7, 10, 9),
    "CTRIA3": (5, 6, 10, 9),
    "CTRIAR": (5, 6, 10, 9),
    "CQUAD8": (14, 15, 10, 16),
    "CTRIA6": (8, 9, 10, 13),
}
_NSM_OF_BARS: Final = {"PBAR": 6, "PBEAM": 7, "PROD": 5, "PTUBE": 4}  # field of the mass per length
_SPREAD: Final = ("NSM", "NSM1", "NSML", "NSML1")
_CHOSEN_BY: Final[Mapping[str, tuple[str, ...]]] = {  # cards that act only where the case control names their set
    **dict.fromkeys(_SPREAD, ("NSM",)),
    **dict.fromkeys(("MPC", "MPCAX", "MPCY"), ("MPC",)),
    **dict.fromkeys(("DMIG", "DMI", "DMIJ", "DMIJI", "DMIK"), ("K2GG", "M2GG", "K2PP", "M2PP", "B2GG", "B2PP", "A2GG")),
}


def read_nastran(path: Path, data: bytes) -> Gathered:
    """What a bulk data file has: nodes, elements, properties, materials, SPC, SPC1, RBE2, RBE3, CONM2, and sets.

    Sets are named "SET 5" (of the case control, SET1 or SET3), cells by their property "PSHELL 2" or "PSOLID 2", held
    nodes "SPC 1", those that GRID holds itself "GRID PS". Masses are those of the cards times PARAM, WTMASS. Every
    other card, and every field that no reader reads, is counted among what is left out, after the tables of `words`.
    Raises InputErrors with file and line.
    """
    lines, cards, ended = cards_of(path, lines_of(path, data))
    bulk = Bulk()
    if not ended and cards:
        bulk.open_end = f"ENDDATA: its last card is {cards[-1].name} of line {cards[-1].number}"
    control = case_control(lines)
    bulk.sets, bulk.chosen = control.sets, control.chosen
    for word, number in control.commands.items():
        makes, changes = COMMANDS.get(word, (Makes.NOTHING, "control of the solution and its output"))
        if word not in COMMANDS and word[:4] not in OUTPUT:
            makes, changes = Makes.SLIGHT, "a command that is not known here"
        if word not in READ_COMMANDS:
            bulk.left_out.add(f"{word} of the case control", makes, changes, number)
    bulk.of_grids = next((card for card in cards if card.name == "GRDSET"), None)
    if any(card.name == "NSMADD" for card in cards):  # which sets it is the sum of is not looked for: all are named
        control = control._replace(masses=[])
    for card in cards:
        _take(card, bulk, control)
    if not bulk.numbers:
        raise InputError("", got=f"'{path.name}' without GRID", expected="a bulk data file with nodes and elements")
    every = [*(one.path for one in lines), *(card.path for card in cards)]
    files = [one for one in dict.fromkeys(every) if one != path]
    return _gathered(bulk)._replace(included=tuple(files))


def _take(card: Card, bulk: Bulk, control: Control) -> None:
    """Read a card, or count it among what is left out; there is no third way."""
    name, left = card.name, bulk.left_out
    name = "BEGIN" if name.startswith("BEGIN ") else name  # BEGIN SUPER = 1
    if name in _CELLS or name in _READERS:
        (_cell if name in _CELLS else _READERS[name])(card, bulk)
        of_no_effect = FIELDS_WITHOUT_EFFECT.get(name, {})
        for index in card.unread:
            if index not in of_no_effect:
                left.add(f"field {index + 2} of {name}", Makes.UNKNOWN, "a field that is not read", card.number)
    elif name in WITHOUT_EFFECT:
        left.add(name, Makes.NOTHING, WITHOUT_EFFECT[name], card.number)
        if name in _NSM_OF_BARS and card.real(_NSM_OF_BARS[name], 0.0):
            what = f"{card.real(_NSM_OF_BARS[name]):g} of mass per length on bars"
            left.add(f"NSM of {name} {card.field(0)}", Makes.MASSES, what, card.number)
    elif _not_chosen(card, control):
        left.add(name, Makes.NOTHING, "the case control does not choose it", card.number)
    elif name in _SPREAD and set(control.masses) == {card.whole(0)} and nsm(card, bulk):
        pass
    elif name in LEFT_OUT:
        left.add(name, *LEFT_OUT[name], card.number)
    else:
        left.add(name, Makes.UNKNOWN, "a card that is not known: is it misspelt?", card.number)


def _not_chosen(card: Card, control: Control) -> bool:
    """Whether a card acts only where the case control names its set, and does not."""
    if card.name in _SPREAD and control.masses:
        return card.whole(0) not in control.masses
    commands = _CHOSEN_BY.get(card.name, ())
    return control.whole and bool(commands) and not any(one in control.commands for one in commands)


def _gathered(bulk: Bulk) -> Gathered:
    systems = Systems(bulk.systems)
    known, placed, moving = np.array(bulk.numbers), np.array(bulk.placed), np.array(bulk.moving)
    points = systems.places(known, np.array(bulk.points), placed, bulk.of_systems)
    turned = systems.turned(known, moving, bulk.of_systems)
    blocks = []
    for kind, rows in bulk.cells.items():
        table = np.array(rows, np.int64)
        nodes = table[:, 1:][:, _HEX20] if kind == "hex20" else table[:, 1:]
        blocks.append(CellBlock(kind, table[:, 0], nodes))
    cell_sets = {_property(bulk, number): np.array(some) for number, some in bulk.by_property.items()}
    judge_shells(bulk)
    if missing := bulk.ranged.difference(bulk.numbers):
        kept = {key: [node for node in some if node not in missing] for key, some in bulk.holds.items()}
        bulk.holds = {key: some for key, some in kept.items() if some}
    node_sets: dict[str, Integers] = {}
    for (number, _), some in bulk.holds.items():
        name = _support(number)
        node_sets[name] = np.unique(np.concatenate([node_sets.get(name, np.zeros(0, np.int64)), some]))
    cells = np.concatenate([block.numbers for block in blocks] or [np.zeros(0, np.int64)])
    for name, members in bulk.sets.items():  # a set of the case control may be one of nodes or of elements
        if np.isin(members, known).all():
            node_sets[name] = np.array(members, np.int64)
        if np.isin(members, cells).all():
            cell_sets[name] = np.array(members, np.int64)
    return Gathered(known, points, blocks, node_sets, cell_sets, _stated(bulk, turned))


def _stated(bulk: Bulk, turned: Integers) -> Stated:
    """What is stated beside the mesh; masses times the factor of all.

    Parameters
    ----------
    turned : Integers
        Nodes with directions of their own.
    """
    holds = [
        StatedHold(_support(number), np.array(some), tuple(int(digit) - 1 for digit in held))
        for (number, held), some in bulk.holds.items()
    ]
    line = bulk.of_systems[int(turned[0])].number if len(turned) else 0
    why = "in directions of CD of GRID"
    kept, links = in_global_directions(holds, bulk.links, turned, bulk.left_out, why, line)
    properties = [
        *((n, StatedProperty(_property(bulk, n), one.thickness, _name(one))) for n, one in bulk.shells.items()),
        *((n, StatedProperty(_property(bulk, n), None, one)) for n, one in bulk.solids.items()),
        *((n, StatedProperty(_property(bulk, n), None, "", one)) for n, one in bulk.lay_ups.items()),
    ]
    factor = bulk.mass_factor
    used = {one for number in bulk.chosen for one in bulk.added.get(number, [number])}
    of_cards = {number for number, _ in bulk.holds if number != OF_GRID}
    used = of_cards if not used and len(of_cards) == 1 else used
    spread = tuple(spread_on(bulk))
    left_out = bulk.left_out.found
    return Stated(
        tuple(one for number, one in properties if number in bulk.by_property),
        tuple(_weighed(one, factor) for one in bulk.materials),
        tuple(
            replace(one, mass=factor * one.mass, inertia=tuple(factor * value for value in one.inertia))
            for one in bulk.masses
        ),
        tuple(links),
        tuple(kept),
        left_out,
        elements={name: np.array(some) for name, some in bulk.bars.items()},
        open_end=bulk.open_end,
        active=tuple(_support(number) for number in (*sorted(used), OF_GRID)) if used else (),
        spread=spread,
    )


def _weighed(material: StatedMaterial, factor: float) -> StatedMaterial:
    """A material with the factor of all masses in its density."""
    rho = material.constants.get("rho")
    return material if rho is None else replace(material, constants={**material.constants, "rho": factor * rho})


def _name(shell: Shelled) -> str:
    number = next((one for one in shell.materials[:2] if one), 0)
    return f"material {number}" if number else ""


def _support(number: int) -> str:
    return "GRID PS" if number == OF_GRID else f"SPC {number}"


def _property(bulk: Bulk, number: int) -> str:
    kinds: dict[str, Collection[int]] = {"PSHELL": bulk.shells, "PSOLID": bulk.solids, "PCOMP": bulk.lay_ups}
    return f"{next((kind for kind, some in kinds.items() if number in some), 'property')} {number}"


def _cell(card: Card, bulk: Bulk) -> None:
    number = card.whole(0)
    property_number = card.whole(1, default=number)
    most = _CELLS[card.name][-1][1]
    nodes = [card.whole(2 + at, default=0) for at in range(most)]
    given = sum(1 for node in nodes if node)
    for kind, count in _CELLS[card.name]:
        if given == count and all(nodes[:count]):
            bulk.cells.setdefault(kind, []).append([number, *nodes[:count]])
            bulk.by_property.setdefault(property_number, []).append(number)
            break
    else:
        counts = " or ".join(str(count) for _, count in _CELLS[card.name])
        raise card.refuse(f"{given} nodes", f"{counts} nodes", "elements without some middle nodes are not read")
    if card.name in _BARS:
        bulk.bars.setdefault(card.name, []).append(number)
    elif card.name in _OF_SHELLS:
        _of_shell(card, number, property_number, bulk)


def _of_shell(card: Card, number: int, property_number: int, bulk: Bulk) -> None:
    """What an element of a shell states of itself: direction of its material, offset, thicknesses at its corners."""
    theta, shift, first, flag = _OF_SHELLS[card.name]
    count, left = 4 if "QUAD" in card.name else 3, bulk.left_out
    if card.field(theta).strip("0.+-"):
        what = "a direction of the material"
        left.add(f"THETA or MCID of {card.name}", Makes.ORIENTATION, what, card.number, [number])
    if card.field(shift) and card.real(shift) != 0.0:
        what = "the middle of the thickness lies beside the nodes"
        left.add(f"ZOFFS of {card.name}", Makes.OFFSET, what, card.number, [number])
    if any(card.field(first + at) for at in range(count)):
        values = [card.real(first + at, -1.0) for at in range(count)]
        bulk.corners.append((card, number, property_number, [] if card.whole(flag, default=0) else values))
    card.field(flag)


def _grid(card: Card, bulk: Bulk) -> None:
    general = bulk.of_grids
    if general is not None:
        filled = [*card.fields, *[""] * (8 - len(card.fields))]
        filled = [word or (general.field(at) if at in (1, 5, 6, 7) else "") for at, word in enumerate(filled)]
        card = card._replace(fields=filled)
    number, placed, moving = card.whole(0), card.whole(1, default=0), card.whole(5, default=0)
    if placed or moving:
        bulk.of_systems[number] = card
    bulk.placed.append(placed)
    bulk.moving.append(max(moving, 0))  # -1 is a node of a fluid
    if moving < 0:
        bulk.left_out.add("GRID of a fluid", Makes.ELEMENTS, "a fluid", card.number)
    if card.whole(7, default=0):
        bulk.left_out.add("SEID of GRID", Makes.ELEMENTS, "superelements: other parts of the structure", card.number)
    bulk.numbers.append(number)
    bulk.points.append((card.real(2, 0.0), card.real(3, 0.0), card.real(4, 0.0)))
    if card.field(6).strip("0"):
        hold(card, bulk, OF_GRID, 6, [number])


def _grdset(card: Card, bulk: Bulk) -> None:
    """What GRID leaves out; `_grid` takes it, wherever it stands. Raises InputErrors for a second one that differs."""
    if bulk.of_grids is not None and card.fields != bulk.of_grids.fields:
        raise card.refuse("a second one", "one GRDSET")
    for index in (1, 5, 6, 7):
        card.field(index)


def _system(card: Card, bulk: Bulk) -> None:
    """A coordinate system, which is made where nodes are in it."""
    card.seen.update(range(8 if card.name[4] == "1" else 11))
    bulk.systems.append(card)


def _psolid(card: Card, bulk: Bulk) -> None:
    bulk.solids[card.whole(0)] = f"material {card.field(1)}" if card.field(1) else ""
    if card.field(2).strip("0-"):
        what = f"CORDM of PSOLID {card.whole(0)}"
        bulk.leave_out_of(card.whole(0), what, Makes.ORIENTATION, "directions of the material", card.number)
    if card.field(6).upper() not in ("", "SMECH"):
        bulk.left_out.add("FCTN of PSOLID", Makes.ELEMENTS, "a fluid or another field than of a solid", card.number)


def _mat1(card: Card, bulk: Bulk) -> None:
    E, G, nu = (card.real(index) if card.field(index) else None for index in (1, 2, 3))
    if E is None and G is not None and nu is not None:
        E = 2.0 * (1.0 + nu) * G
    if nu is None and E is not None and G:
        nu = E / (2.0 * G) - 1.0
    constants = {"E": E, "nu": nu, "rho": card.real(4, 0.0)}
    named = {key: value for key, value in constants.items() if value is not None}
    bulk.materials.append(StatedMaterial(f"material {card.whole(0)}", named))


def _other_material(card: Card, bulk: Bulk) -> None:
    """A material whose constants are not read: its name alone, to see where it is."""
    bulk.materials.append(StatedMaterial(f"material {card.whole(0)}", {}))


def _mat8(card: Card, bulk: Bulk) -> None:
    words = ("E1", "E2", "nu12", "G12", "G1z", "G2z", "rho")
    named = {word: card.real(1 + at) for at, word in enumerate(words) if card.field(1 + at)}
    bulk.materials.append(StatedMaterial(f"material {card.whole(0)}", named))


def _set1(card: Card, bulk: Bulk) -> None:
    bulk.sets[f"SET {card.whole(0)}"] = card.several(1)


def _set3(card: Card, bulk: Bulk) -> None:
    if card.field(1).upper() not in ("GRID", "ELEM", "ELEMENT"):
        raise card.refuse(f"'{card.field(1)}'", "GRID or ELEM")
    bulk.sets[f"SET {card.whole(0)}"] = card.several(2)


_READERS: Final[Mapping[str, Callable[[Card, Bulk], None]]] = {
    "GRID": _grid,
    "GRDSET": _grdset,
    **dict.fromkeys(("CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S"), _system),
    "PSHELL": pshell,
    "PCOMP": pcomp,
    "PCOMPG": pcomp,
    "PSOLID": _psolid,
    "MAT1": _mat1,
    **dict.fromkeys(("MAT2", "MAT3", "MAT9", "MAT10", "MAT11"), _other_material),
    "MAT8": _mat8,
    "CONM2": conm2,
    "RBE2": rbe2,
    "RBE3": rbe3,
    "SPC": spc,
    "SPC1": spc1,
    "SPCADD": spcadd,
    "PARAM": param,
    "SET1": _set1,
    "SET3": _set3,
}
