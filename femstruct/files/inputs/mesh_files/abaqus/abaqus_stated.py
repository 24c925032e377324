"""What an input file of Abaqus states beside its mesh: held nodes, masses, rigid bodies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.files.inputs.mesh_files.abaqus.abaqus_deck import Deck, Keyword
from femstruct.files.inputs.mesh_files.own_directions import in_global_directions
from femstruct.files.inputs.mesh_files.text_lines import floats, integers, wrong_line
from femstruct.model.imported.imported_mesh import StatedHold, StatedLink, StatedMass
from femstruct.model.imported.stated.left_out import Makes

_DIRECTIONS: Final = {  # held by the types of *BOUNDARY, counted from 1
    "ENCASTRE": (1, 2, 3, 4, 5, 6), "PINNED": (1, 2, 3), "XSYMM": (1, 5, 6), "YSYMM": (2, 4, 6), "ZSYMM": (3, 4, 5),
    "XASYMM": (2, 3, 4), "YASYMM": (1, 3, 5), "ZASYMM": (1, 2, 6),
}  # fmt: skip


def is_number(word: str) -> bool:
    """Whether a word is a whole number."""
    return word.lstrip("+-").isdigit()


def nodes_named(keyword: Keyword, number: int, which: str, deck: Deck) -> Integers:
    """A node by its number, or those of a set."""
    which = which.strip('"')
    if is_number(which):
        return np.array([int(which)])
    by_case = {one.upper(): one for one in deck.node_sets}
    if which.upper() not in by_case:
        raise wrong_line(keyword.path, number, f"'{which}', no set of nodes above", "a node or a set of nodes")
    return np.concatenate([np.zeros(0, np.int64), *deck.node_sets[by_case[which.upper()]]])


def held_nodes(keyword: Keyword, deck: Deck) -> None:
    """Nodes held at zero, by number or set."""
    for number, words in keyword.rows:
        which = words[0].strip('"')
        nodes = nodes_named(keyword, number, which, deck)
        if len(words) > 1 and words[1].upper() in _DIRECTIONS:
            held = _DIRECTIONS[words[1].upper()]
        else:
            given = [word for word in words[1:3] if word]
            ends = integers(keyword.path, [(number, given)]).tolist()
            if not ends:
                raise wrong_line(keyword.path, number, f"'{', '.join(words)}'", "a first and a last direction")
            held = tuple(one for one in range(ends[0], ends[-1] + 1) if 1 <= one <= 6)
        moved = [word for word in words[3:4] if word and floats(keyword.path, [(number, [word])])[0] != 0.0]
        if moved:
            keyword.leave_out(deck, Makes.SUPPORTS, "held nodes", "BOUNDARY that moves nodes")
        elif held:
            deck.holds.append(StatedHold(f"boundary {which}", nodes, tuple(one - 1 for one in held)))


def masses(keyword: Keyword, deck: Deck) -> None:
    """A mass at each node of a set of elements of type MASS."""
    name = keyword.option("ELSET")
    nodes = {one.upper(): some for one, some in deck.lumps.items()}.get(name.upper())
    if nodes is None:
        keyword.leave_out(deck, Makes.MASSES, "masses at nodes")
        return
    value = float(floats(keyword.path, keyword.rows[:1])[0]) if keyword.rows else 0.0
    deck.masses += [StatedMass(node, value, (0.0, 0.0, 0.0), (0.0,) * 6) for node in nodes]


def rigid_body(keyword: Keyword, deck: Deck) -> None:
    """Nodes that follow a reference node: with their rotations (NSET, TIE NSET), or their shifts only (PIN NSET)."""
    sets = {"NSET": range(6), "TIENSET": range(6), "PINNSET": range(3)}
    leads = nodes_named(keyword, keyword.number, keyword.option("REFNODE"), deck)
    if (
        len(leads) != 1
        or not sets.keys() & keyword.options.keys()
        or {"ELSET", "ANALYTICALSURFACE"} & keyword.options.keys()
    ):
        keyword.leave_out(deck, Makes.LINKS, "a rigid body of elements or of a surface")
        return
    for key, follows in sets.items():
        if key in keyword.options:
            nodes = nodes_named(keyword, keyword.number, keyword.options[key], deck)
            nodes = nodes[nodes != leads[0]]
            if len(nodes):
                deck.links.append(StatedLink(int(leads[0]), nodes, tuple(follows)))


def node_surface(keyword: Keyword, deck: Deck) -> None:
    """Nodes of a surface of TYPE=NODE, with a weight each; surfaces of faces of elements are not read."""
    if keyword.options.get("TYPE", "ELEMENT").upper() != "NODE":
        return
    nodes, weights = [], []
    for number, words in keyword.rows:
        some = nodes_named(keyword, number, words[0], deck)
        given = [word for word in words[1:2] if word]
        nodes.append(some)
        weights += len(some) * [float(floats(keyword.path, [(number, given)])[0]) if given else 1.0]
    deck.surfaces[keyword.option("NAME").upper()] = np.concatenate([np.zeros(0, np.int64), *nodes]), tuple(weights)


def coupling(keyword: Keyword, deck: Deck) -> None:
    """What *KINEMATIC or *DISTRIBUTING behind it completes; one that nothing completes says nothing."""
    deck.coupling = keyword


def coupled(keyword: Keyword, deck: Deck) -> None:
    """Nodes of a surface that follow a reference node, or whose mean motion it follows."""
    head = deck.coupling
    if head is None:
        raise wrong_line(keyword.path, keyword.number, f"*{keyword.word} alone", "*COUPLING before it")
    found = deck.surfaces.get(head.option("SURFACE").upper())
    leads = nodes_named(head, head.number, head.option("REFNODE"), deck)
    follows = _directions(keyword, keyword.rows)
    mean = keyword.word == "DISTRIBUTING"
    if found is None or len(leads) != 1 or "ORIENTATION" in head.options or (mean and not sum(found[1]) > 0.0):
        head.leave_out(deck, Makes.LINKS, "faces that follow a node")
        return
    nodes, weights = found
    others = nodes != leads[0]
    if not others.any():
        return
    kept = tuple(weight for weight, other in zip(weights, others.tolist(), strict=True) if other)
    deck.links.append(StatedLink(int(leads[0]), nodes[others], follows, kept if mean else None))


def kinematic_coupling(keyword: Keyword, deck: Deck) -> None:
    """Nodes or sets, each with a first and a last direction, that follow a reference node."""
    leads = nodes_named(keyword, keyword.number, keyword.option("REFNODE"), deck)
    if len(leads) != 1 or "ORIENTATION" in keyword.options:
        keyword.leave_out(deck, Makes.LINKS, "nodes that follow a node")
        return
    for number, words in keyword.rows:
        nodes = nodes_named(keyword, number, words[0], deck)
        follows = _directions(keyword, [(number, words[1:])])
        if (nodes != leads[0]).any():
            deck.links.append(StatedLink(int(leads[0]), nodes[nodes != leads[0]], follows))


def _directions(keyword: Keyword, rows: list[tuple[int, list[str]]]) -> tuple[int, ...]:
    """Directions out of 0 to 5 of rows of a first and a last one; all of them where none is given."""
    found: set[int] = set()
    for number, words in rows:
        ends = integers(keyword.path, [(number, [word for word in words[:2] if word])]).tolist()
        found |= set(range(ends[0], ends[-1] + 1)) if ends else set()
    return tuple(one for one in range(6) if one + 1 in found) or tuple(range(6))


def transform(keyword: Keyword, deck: Deck) -> None:
    """Nodes whose supports and links are along directions of their own; see `along_own_directions`."""
    kind = keyword.options.get("TYPE", "R").upper()
    row = floats(keyword.path, keyword.rows[:1])
    if kind == "R" and len(row) >= 6:
        x, y = row[:3], row[3:6]
        if not x[1:].any() and x[0] > 0.0 and y[1] > 0.0 and y[2] == 0.0:
            return  # along the global directions
    deck.turned.append(nodes_named(keyword, keyword.number, keyword.option("NSET"), deck))
    deck.turned_at = deck.turned_at or keyword.number


def along_own_directions(deck: Deck) -> None:
    """Leave out supports and links in some of the directions of *TRANSFORM; in all three they have no direction."""
    turned = np.unique(np.concatenate([np.zeros(0, np.int64), *deck.turned]))
    why = "in directions of *TRANSFORM"
    found = in_global_directions(deck.holds, deck.links, turned, deck.left_out, why, deck.turned_at)
    deck.holds, deck.links = found


def initial_conditions(keyword: Keyword, deck: Deck) -> None:
    """What is there from the start: stress changes the stiffness, the rest has no effect."""
    kind = keyword.options.get("TYPE", "").upper().replace(" ", "")
    if kind in ("STRESS", "PLASTICSTRAIN", "HARDENING"):
        keyword.leave_out(deck, Makes.PRELOAD, "stress that is there from the start", f"{keyword.written}, TYPE={kind}")
    else:
        keyword.leave_out(deck, Makes.NOTHING, "temperatures, speeds or other states at the start")


STATED: Final[Mapping[str, Callable[[Keyword, Deck], None]]] = {
    "BOUNDARY": held_nodes,
    "MASS": masses,
    "RIGIDBODY": rigid_body,
    "SURFACE": node_surface,
    "COUPLING": coupling,
    "KINEMATIC": coupled,
    "DISTRIBUTING": coupled,
    "KINEMATICCOUPLING": kinematic_coupling,
    "TRANSFORM": transform,
    "INITIALCONDITIONS": initial_conditions,
}
