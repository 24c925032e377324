"""Universal files of meshes: data sets 2411 (nodes), 2412 (elements), 2467 and 2477 (groups).

Written after the descriptions of the data sets by the University of Cincinnati; meshio reads none of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.errors import InputError
from femstruct.files.text_tables import floats, integers, lines_of, wrong_line
from femstruct.model.imported_mesh import KINDS, CellBlock, Gathered, Makes, Stated, Tally

Lines = list[tuple[int, list[str]]]
_KINDS: Final = {
    "line2": (11, 21, 22),
    "line3": (23, 24),
    "tri3": (41, 51, 61, 74, 81, 91),
    "tri6": (42, 52, 62, 72, 82, 92),
    "quad4": (44, 54, 64, 71, 84, 94),
    "quad8": (45, 55, 65, 75, 85, 95),
    "tet4": (111,),
    "tet10": (118,),
    "hex8": (115,),
    "hex20": (116,),
}
_KIND_OF: Final = {code: kind for kind, codes in _KINDS.items() for code in codes}
_BEAMS: Final = (11, 21, 22, 23, 24)
_ORDER: Final = {  # corners and middles alternate there, layer by layer
    "line3": [0, 2, 1],
    "tri6": [0, 2, 4, 1, 3, 5],
    "quad8": [0, 2, 4, 6, 1, 3, 5, 7],
    "tet10": [0, 2, 4, 9, 1, 3, 5, 6, 7, 8],
    "hex20": [0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11],
}
_NODES, _ELEMENTS = 7, 8  # what members of a group are
_GROUPS: Final = ("2467", "2477")
_KNOWN: Final = ("2411", "2412", *_GROUPS)
_READ_OTHERWISE: Final = (
    "151",
    "164",
    "2420",
    "2400",
    "2410",
)  # header, units, coordinate systems of which none is used
_CLASSES: Final[tuple[tuple[Makes, str, tuple[str, ...]], ...]] = (
    (Makes.NOTHING, "results", ("55", "56", "57", "58", "58b", "2414", "2413", "1858", "82", "2478", "2479")),
    (Makes.NOTHING, "a load", ("782", "790", "792", "2449", "2451")),
    (Makes.SECTION, "thicknesses and sections, which the model states", ("772", "788", "2437", "776", "2438", "2470")),
    (Makes.NOTHING, "materials, which the model states", ("773", "1703", "1710", "1716", "2464")),
    (Makes.SUPPORTS, "held nodes", ("755", "791", "2417", "754")),
    (Makes.LINKS, "equations between nodes", ("754", "2439", "793")),
)
_CLASS_OF: Final = {word: (makes, changes) for makes, changes, words in _CLASSES for word in words}


def read_unv(path: Path, data: bytes) -> Gathered:
    """What a universal file has. Other data sets are named as left out. Raises InputErrors with the line."""
    sets = list(_data_sets(path, lines_of(path, data)))
    of: dict[str, list[Lines]] = {}
    for word, lines in sets:
        of.setdefault(word, []).append(lines)
    if "2411" not in of:
        raise InputError("", got=f"'{path.name}' without data set 2411", expected="a universal file with nodes")
    tables = [_nodes(path, lines) for lines in of["2411"]]
    blocks = [block for lines in of.get("2412", ()) for block in _elements(path, lines)]
    node_sets: dict[str, Integers] = {}
    cell_sets: dict[str, Integers] = {}
    for word in _GROUPS:
        for lines in of.get(word, ()):
            _groups(path, lines, node_sets, cell_sets)
    left_out = Tally()
    for word in of:
        if word not in (*_KNOWN, *_READ_OTHERWISE):
            makes, changes = _CLASS_OF.get(word, (Makes.UNKNOWN, "a data set that is not known"))
            left_out.add(f"data set {word}", makes, changes, 0, count=len(of[word]))
    cells = np.concatenate([*(block.numbers for block in blocks), np.zeros(0, np.int64)])
    for name, members in cell_sets.items():  # Gmsh names points there that it does not write
        there = np.isin(members, cells)
        if not there.all():
            what = f"elements of group '{name}' that are not there"
            left_out.add(
                what, Makes.SLIGHT, "points, which Gmsh names and does not write", 0, count=int((~there).sum())
            )
        cell_sets[name] = members[there]
    return Gathered(
        np.concatenate([numbers for numbers, _ in tables]),
        np.concatenate([points for _, points in tables]),
        blocks,
        node_sets,
        {name: some for name, some in cell_sets.items() if len(some)},
        Stated(left_out=left_out.found),
    )


def _data_sets(path: Path, lines: list[str]) -> Iterator[tuple[str, Lines]]:
    """Number and lines of every data set."""
    inside: Lines | None = None
    word, begun = "", 0
    for number, line in enumerate(lines, 1):
        words = line.split()
        if words == ["-1"]:
            if inside is not None:
                yield word, inside
                inside, word = None, ""
            else:
                inside, begun = [], number
        elif inside is not None and not word:
            word = words[0] if words else ""
        elif inside is not None:
            inside.append((number, words))
    if inside is not None:
        raise wrong_line(path, begun, "a data set without its end", "a line with -1", "the file is cut off")


def _nodes(path: Path, lines: Lines) -> tuple[Integers, np.ndarray]:
    heads, places = lines[::2], lines[1::2]
    for number, words in heads:
        if len(words) != 4:
            raise wrong_line(path, number, f"{len(words)} numbers", "four: node, coordinate systems, colour")
    for number, words in places:
        if len(words) != 3:
            raise wrong_line(path, number, f"{len(words)} coordinates", "x, y and z")
    if len(heads) != len(places):
        raise wrong_line(path, heads[-1][0], "a node without a place", "x, y and z in the next line")
    return integers(path, heads).reshape(-1, 4)[:, 0], floats(path, places).reshape(-1, 3)


def _elements(path: Path, lines: Lines) -> list[CellBlock]:
    rows: dict[str, list[list[int]]] = {}
    at = 0
    while at < len(lines):
        number, words = lines[at]
        head = integers(path, [(number, words)]).tolist()
        if len(head) != 6:
            raise wrong_line(path, number, f"{len(head)} numbers", "six: element, kind, .., number of nodes")
        if head[1] not in _KIND_OF:
            expected = "bars, shells, tetrahedra or hexahedra, linear or quadratic"
            raise wrong_line(path, number, f"an element of kind {head[1]}", expected)
        kind = _KIND_OF[head[1]]
        at += 2 if head[1] in _BEAMS else 1
        nodes: list[int] = []
        while len(nodes) < head[5] and at < len(lines):
            nodes += integers(path, [lines[at]]).tolist()
            at += 1
        if len(nodes) != KINDS[kind].nodes or head[5] != len(nodes):
            raise wrong_line(
                path, number, f"{len(nodes)} nodes of an element of kind {head[1]}", f"{KINDS[kind].nodes}"
            )
        rows.setdefault(kind, []).append([head[0], *nodes])
    blocks = []
    for kind, some in rows.items():
        table = np.array(some, np.int64)
        order = _ORDER.get(kind, list(range(KINDS[kind].nodes)))
        blocks.append(CellBlock(kind, table[:, 0], table[:, 1:][:, order]))
    return blocks


def _groups(path: Path, lines: Lines, node_sets: dict[str, Integers], cell_sets: dict[str, Integers]) -> None:
    """Groups by their names; eight numbers a line, two members of four each."""
    at = 0
    while at + 1 < len(lines):
        number, words = lines[at]
        head = integers(path, [(number, words)]).tolist()
        if len(head) != 8:
            raise wrong_line(path, number, f"{len(head)} numbers", "eight: group, .., number of members")
        name = " ".join(lines[at + 1][1]) or f"group {head[0]}"
        many = (head[7] + 1) // 2
        flat = integers(path, lines[at + 2 : at + 2 + many])
        if len(flat) != 4 * head[7]:
            raise wrong_line(path, number, f"{len(flat) // 4} members of group '{name}'", f"{head[7]}")
        members = flat.reshape(-1, 4)
        for code, sets in ((_NODES, node_sets), (_ELEMENTS, cell_sets)):
            if (own := members[members[:, 0] == code, 1]).size:
                sets[name] = np.concatenate([sets.get(name, np.zeros(0, np.int64)), own])
        at += 2 + many
