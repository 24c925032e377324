"""Cards of Nastran that state what is beside the mesh: supports, links, masses."""

from __future__ import annotations

import re

import numpy as np

from femstruct.files.inputs.mesh_files.nastran.bulk_cards import Card
from femstruct.files.inputs.mesh_files.nastran.nastran_bulk import Bulk
from femstruct.files.inputs.mesh_files.nastran.nastran_words import CONTROL, PARAMETERS
from femstruct.model.imported.imported_mesh import StatedLink, StatedMass
from femstruct.model.imported.stated.left_out import Makes


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
