"""Sections of the shells of Nastran: what PSHELL, PCOMP and elements state of cells, and what of it is not made."""

from __future__ import annotations

from typing import Final, Literal

import numpy as np

from femstruct.errors import some_of
from femstruct.files.inputs.mesh_files.nastran.bulk_cards import Card
from femstruct.files.inputs.mesh_files.nastran.nastran_bulk import Bulk, Shelled, Spread
from femstruct.model.imported.imported_mesh import StatedLayer, StatedSpread
from femstruct.model.imported.stated.left_out import Makes

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
    whose, line = f"{card.name} {number}", card.number
    bulk.leave_out_of(number, whose, Makes.LAY_UP, f"{len(made)} layers", line)
    if card.real(2, 0.0):
        bulk.spread.append(Spread(f"NSM of {whose}", card.real(2), "area", line, (number,)))
    if (word := card.field(7).upper()) not in ("", "SYM"):
        bulk.leave_out_of(number, f"LAM {word} of {whose}", Makes.SECTION, "layers that act otherwise", line)
    total = sum(one.thickness for one in made)
    if card.field(1) and made and abs(card.real(1) + total / 2.0) > SAME * total:
        what = "the lowest face is not half the thickness below the nodes"
        bulk.leave_out_of(number, f"Z0 of {whose}", Makes.OFFSET, what, line)


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
        what = f"{card.name} of {kind} {some_of([str(one) for one in numbers])}"
        if kind == "ELEMENT" or per == "total":
            properties = () if kind == "ELEMENT" else tuple(numbers)
            elements = tuple(numbers) if kind == "ELEMENT" else ()
            bulk.spread.append(Spread(what, amount, per, card.number, properties, elements))
        else:
            bulk.spread += [Spread(what, amount, per, card.number, (one,)) for one in numbers]
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
        cells, line = bulk.by_property.get(number, []), one.card.number
        if not cells:
            continue
        whose = f"PSHELL {number}"
        membrane, bending, shear, coupled = one.materials
        differ = [m for m in (membrane, bending) if m > 0]
        if one.nsm:
            bulk.spread.append(Spread(f"NSM of {whose}", one.nsm, "area", line, (number,)))
        if not bending:
            left.add(f"{whose} without MID2", Makes.SECTION, "a membrane, without stiffness in bending", line, cells)
        elif not membrane:
            left.add(f"{whose} without MID1", Makes.SECTION, "bending without stiffness in its plane", line, cells)
        elif bending < 0 or (len(set(differ)) > 1 and not _same(differ, constants)):
            what = "another material of bending than in the plane" if bending > 0 else "plane strain"
            left.add(f"MID2 of {whose}", Makes.SECTION, what, line, cells)
        if abs(one.bending - 1.0) > SAME:
            left.add(f"12I/T^3 of {whose}", Makes.SECTION, f"stiffness in bending times {one.bending:g}", line, cells)
        if bending and not shear:
            left.add(f"{whose} without MID3", Makes.SLIGHT, "no shear across the thickness, here it has", line, cells)
        elif shear and (abs(one.shear - _SHEAR) > SAME or not _same([shear, bending], constants)):
            left.add(f"MID3 or TS/T of {whose}", Makes.SECTION, "another stiffness in shear", line, cells)
        if coupled:
            left.add(f"MID4 of {whose}", Makes.SECTION, "bending that is coupled to stretch", line, cells)
    for card, number, of, values in bulk.corners:
        section = bulk.shells.get(of)
        t = None if section is None else section.thickness
        if values and t is not None and all(one < 0.0 or abs(one - t) <= SAME * t for one in values):
            continue
        left.add(f"T1, T2, .. of {card.name}", Makes.THICKNESS, "a thickness at each corner", card.number, [number])


def _same(numbers: list[int], constants: dict[str, dict[str, float]]) -> bool:
    """Whether materials are one, or have the same constants."""
    first, *others = [constants.get(f"material {number}", {"": float(number)}) for number in numbers]
    return len(set(numbers)) == 1 or (bool(first) and all(one == first for one in others))
