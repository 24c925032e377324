"""Meshes of Nastran: bulk data files, .bdf, .dat, .nas.

Cards and the order of nodes are those of the Quick Reference Guide of MSC Nastran.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.errors import InputError
from femstruct.files.inputs.mesh_files.nastran.bulk_cards import Card, cards_of
from femstruct.files.inputs.mesh_files.nastran.case_control import Control, case_control
from femstruct.files.inputs.mesh_files.nastran.coordinate_systems import Systems
from femstruct.files.inputs.mesh_files.nastran.nastran_bulk import OF_GRID, Bulk, Shelled
from femstruct.files.inputs.mesh_files.nastran.nastran_shells import judge_shells, nsm, pcomp, pshell, spread_on
from femstruct.files.inputs.mesh_files.nastran.nastran_stated import conm2, hold, param, rbe2, rbe3, spc, spc1, spcadd
from femstruct.files.inputs.mesh_files.nastran.nastran_words import (
    COMMANDS,
    FIELDS_WITHOUT_EFFECT,
    LEFT_OUT,
    OUTPUT,
    READ_COMMANDS,
    WITHOUT_EFFECT,
)
from femstruct.files.inputs.mesh_files.own_directions import in_global_directions
from femstruct.files.inputs.mesh_files.text_lines import lines_of
from femstruct.model.imported.gathering import Block, Gathered
from femstruct.model.imported.imported_mesh import (
    Stated,
    StatedHold,
    StatedMaterial,
    StatedProperty,
)
from femstruct.model.imported.stated.left_out import Makes

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
        blocks.append(Block(kind, table[:, 0], nodes))
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
    """What is stated beside the mesh; masses times the factor of all. turned : nodes with directions of their own."""
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
