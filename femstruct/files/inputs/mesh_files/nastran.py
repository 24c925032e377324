"""Meshes of Nastran: bulk data files, .bdf, .dat, .nas.

Cards and the order of nodes are those of the Quick Reference Guide of MSC Nastran.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.errors import InputError, InputErrors, sentence
from femstruct.files.inputs.mesh_files.bulk_cards import Card, cards_of
from femstruct.files.inputs.mesh_files.case_control import case_control
from femstruct.files.inputs.mesh_files.nastran_bulk import OF_GRID, Bulk
from femstruct.files.inputs.mesh_files.nastran_stated import conm2, hold, param, rbe2, rbe3, spc, spc1, spcadd
from femstruct.files.inputs.mesh_files.text_lines import lines_of
from femstruct.model.imported.gathering import Block, Gathered
from femstruct.model.imported.imported_mesh import (
    Stated,
    StatedHold,
    StatedMaterial,
    StatedProperty,
)

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
_HEX20: Final = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]  # edges between the faces come before those of the top
_HARMLESS: Final = ("MDLPRM", "EIGRL", "EIGR", "EIGC")  # of no effect on a mesh and its properties
_PASSED_OVER: Final = (
    *_HARMLESS, "TABDMP1", "FREQ", "FREQ1", "FREQ2", "FREQ3", "FREQ4", "TSTEP", "FORCE", "MOMENT", "PLOAD", "PLOAD2",
    "PLOAD4", "GRAV", "LOAD", "DLOAD", "RLOAD1", "RLOAD2", "TLOAD1", "TLOAD2", "DAREA", "TABLED1", "TABLED2",
    "PBAR", "PBARL", "PBEAM", "PBEAML", "CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S",
)  # fmt: skip
MOST_NAMED: Final = 12  # unknown cards named at once


def read_nastran(path: Path, data: bytes) -> Gathered:
    """What a bulk data file has: nodes, elements, properties, materials, SPC, SPC1, RBE2, RBE3, CONM2, and sets.

    Sets are named "SET 5" (of the case control, SET1 or SET3), cells by their property "PSHELL 2" or "PSOLID 2", held
    nodes "SPC 1", those that GRID holds itself "GRID PS". Masses are those of the cards times PARAM, WTMASS. Loads and
    what controls a solution are passed over; every other card is refused by name.
    Raises InputErrors with file and line, for all unknown cards at once.
    """
    control, cards, ended = cards_of(path, lines_of(path, data))
    bulk = Bulk()
    if not ended and cards:
        bulk.open_end = f"ENDDATA: its last card is {cards[-1].name} of line {cards[-1].number}"
    unknown: dict[str, Card] = {}
    bulk.sets, bulk.chosen = case_control(path, control)
    for card in cards:
        if card.name in _CELLS:
            _cell(card, bulk)
        elif card.name in _READERS:
            _READERS[card.name](card, bulk)
        elif card.name not in _PASSED_OVER:
            unknown.setdefault(card.name, card)
        elif card.name not in _HARMLESS:
            bulk.leave_out(card.name)
    if unknown:
        expected = "cards of a mesh: GRID, CQUAD4, CTETRA, CHEXA, CBAR, PSHELL, PSOLID, MAT1, SPC1, RBE2, RBE3, ..."
        named = list(unknown.values())[:MOST_NAMED]
        raise InputErrors(
            tuple(f"{path}:{one.number}:1: {sentence('', f'a card {one.name}', expected)}" for one in named)
        )
    if not bulk.numbers:
        raise InputError("", got=f"'{path.name}' without GRID", expected="a bulk data file with nodes and elements")
    return _gathered(bulk)


def _gathered(bulk: Bulk) -> Gathered:
    blocks = []
    for kind, rows in bulk.cells.items():
        table = np.array(rows, np.int64)
        nodes = table[:, 1:][:, _HEX20] if kind == "hex20" else table[:, 1:]
        blocks.append(Block(kind, table[:, 0], nodes))
    cell_sets = {_property(bulk, number): np.array(some) for number, some in bulk.by_property.items()}
    properties = [
        StatedProperty(_property(bulk, number), *given)
        for number, given in (*bulk.shells.items(), *bulk.solids.items())
        if number in bulk.by_property
    ]
    if missing := bulk.ranged.difference(bulk.numbers):
        kept = {key: [node for node in some if node not in missing] for key, some in bulk.holds.items()}
        bulk.holds = {key: some for key, some in kept.items() if some}
    node_sets: dict[str, Integers] = {}
    for (number, _), some in bulk.holds.items():
        name = _support(number)
        node_sets[name] = np.unique(np.concatenate([node_sets.get(name, np.zeros(0, np.int64)), some]))
    known = np.array(bulk.numbers)
    cells = np.concatenate([block.numbers for block in blocks] or [np.zeros(0, np.int64)])
    for name, members in bulk.sets.items():  # a set of the case control may be one of nodes or of elements
        if np.isin(members, known).all():
            node_sets[name] = np.array(members, np.int64)
        if np.isin(members, cells).all():
            cell_sets[name] = np.array(members, np.int64)
    factor = bulk.mass_factor
    used = {one for number in bulk.chosen for one in bulk.added.get(number, [number])}
    of_cards = {number for number, _ in bulk.holds if number != OF_GRID}
    used = of_cards if not used and len(of_cards) == 1 else used
    stated = Stated(
        tuple(properties),
        tuple(bulk.materials),
        tuple(
            replace(one, mass=factor * one.mass, inertia=tuple(factor * value for value in one.inertia))
            for one in bulk.masses
        ),
        tuple(bulk.links),
        tuple(
            StatedHold(_support(number), np.array(some), tuple(int(digit) - 1 for digit in held))
            for (number, held), some in bulk.holds.items()
        ),
        tuple(f"{count} {name}" for name, count in bulk.left_out.items()),
        open_end=bulk.open_end,
        active=tuple(_support(number) for number in (*sorted(used), OF_GRID)) if used else (),
    )
    return Gathered(known, np.array(bulk.points), blocks, node_sets, cell_sets, stated)


def _support(number: int) -> str:
    return "GRID PS" if number == OF_GRID else f"SPC {number}"


def _property(bulk: Bulk, number: int) -> str:
    return f"{'PSHELL ' if number in bulk.shells else 'PSOLID ' if number in bulk.solids else 'property '}{number}"


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
    shift = {"CTRIA3": 6, "CTRIAR": 6, "CQUAD4": 7, "CQUADR": 7}.get(card.name)
    if shift is not None and card.field(shift) and card.real(shift) != 0.0:
        bulk.leave_out(f"ZOFFS of {card.name}")


def _grid(card: Card, bulk: Bulk) -> None:
    for index, what in ((1, "of its place"), (5, "of its motion")):
        if card.whole(index, default=0):
            raise card.refuse(
                f"the coordinate system {card.field(index)} {what}",
                "0, the basic one",
                "write the file in basic coordinates",
            )
    bulk.numbers.append(card.whole(0))
    bulk.points.append((card.real(2, 0.0), card.real(3, 0.0), card.real(4, 0.0)))
    if card.field(6).strip("0"):
        hold(card, bulk, OF_GRID, 6, [card.whole(0)])


def _pshell(card: Card, bulk: Bulk) -> None:
    thickness = card.real(2) if card.field(2) else None
    bulk.shells[card.whole(0)] = thickness, f"material {card.field(1)}" if card.field(1) else ""
    factor, shear = card.real(4, 1.0), card.real(6, 5.0 / 6.0)
    if factor != 1.0 or abs(shear - 5.0 / 6.0) > 1e-3:
        bulk.left_out["PSHELL with factors of bending or shear"] = card.whole(0)


def _psolid(card: Card, bulk: Bulk) -> None:
    bulk.solids[card.whole(0)] = None, f"material {card.field(1)}"


def _mat1(card: Card, bulk: Bulk) -> None:
    E, G, nu = (card.real(index) if card.field(index) else None for index in (1, 2, 3))
    if E is None and G is not None and nu is not None:
        E = 2.0 * (1.0 + nu) * G
    if nu is None and E is not None and G:
        nu = E / (2.0 * G) - 1.0
    constants = {"E": E, "nu": nu, "rho": card.real(4, 0.0)}
    named = {key: value for key, value in constants.items() if value is not None}
    bulk.materials.append(StatedMaterial(f"material {card.whole(0)}", named))


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
    "PSHELL": _pshell,
    "PSOLID": _psolid,
    "MAT1": _mat1,
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
