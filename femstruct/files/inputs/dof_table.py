"""Which node and direction each degree of freedom of foreign matrices is: a table of commas, a row for each."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS
from femstruct.errors import InputError, shown_as
from femstruct.files.inputs.mesh_files.text_lines import floats, lines_of, wrong_line
from femstruct.files.inputs.opening import content

LARGEST: Final = 2**28  # bytes
_HEAD: Final = ("node", "x", "y", "z", "direction")
_OF_EXPORT: Final = {"dof", "component", "momentum_x_kg"}  # columns of NAME.dofs.csv
_WHAT: Final = f"a table of commas with the columns {', '.join(_HEAD)}, a row for each degree of freedom"
_NEAR: Final = 1e-6  # of the size of all: places of one node, written with few digits, differ by less


class DofTable(NamedTuple):
    """Of each degree of freedom its node, counted from 0 on in their order, and its direction out of 0 to 5 [n]; points
    [n_nodes, 3] : where the nodes are, in the unit of length of the file."""

    nodes: Integers
    components: Integers
    points: Floats


def read_dof_table(path: Path) -> DofTable:
    """The table of a file. Nodes are called as one likes; directions are x y z rx ry rz, or 1 to 6.

    Raises InputError, with the line.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     table = Path(folder, "a.csv")
    ...     _ = table.write_text("node,x,y,z,direction\\n7,0,0,0,z\\n9,1,0,0,z\\n9,1,0,0,rx\\n", encoding="utf-8")
    ...     found = read_dof_table(table)
    >>> found.nodes.tolist(), found.components.tolist(), found.points.tolist()
    ([0, 1, 1], [2, 2, 3], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    """
    lines = lines_of(path, content(path, LARGEST, _WHAT))
    rows = [
        (number, [word.strip() for word in words])
        for number, words in enumerate(csv.reader(io.StringIO("\n".join(lines))), 1)
        if any(word.strip() for word in words)
    ]
    head = [word.lower() for word in rows[0][1]] if rows else []
    if set(head) >= _OF_EXPORT:
        name = path.name.removesuffix(".dofs.csv")
        do = f"write 'file: {name}.json' without 'nodes': it names all files of the export"
        raise wrong_line(path, rows[0][0], "the table of an export of femstruct", _WHAT, do)
    if sorted(head) != sorted(_HEAD):
        raise wrong_line(path, rows[0][0] if rows else 1, shown_as(", ".join(head)), _WHAT)
    short = next((number for number, words in rows[1:] if len(words) != len(head)), None)
    if short is not None or len(rows) < 2:
        raise wrong_line(path, short or 1, "a row of another length" if short else "no rows", _WHAT)
    node, direction = head.index("node"), head.index("direction")
    axes = [head.index(axis) for axis in "xyz"]
    places = floats(path, ((number, [words[axis] for axis in axes]) for number, words in rows[1:])).reshape(-1, 3)
    numbers: dict[str, int] = {}
    nodes, components, points = [], [], []
    near = _NEAR * float(np.ptp(places, axis=0).max())
    for (number, words), place in zip(rows[1:], places, strict=True):
        name = words[node]
        if name not in numbers:
            numbers[name] = len(numbers)
            points.append(place)
        elif np.abs(points[numbers[name]] - place).max() > near:
            raise wrong_line(path, number, f"a second place of node {name}", "one place of each node")
        nodes.append(numbers[name])
        components.append(_direction(path, number, words[direction]))
    twice = np.array(nodes) * len(DIRECTIONS) + np.array(components)
    _, first, times = np.unique(twice, return_index=True, return_counts=True)
    if (times > 1).any():
        again = int(np.flatnonzero(twice == twice[first[times > 1][0]])[1])
        raise wrong_line(path, rows[1 + again][0], "a direction of a node that is above", "each one once")
    return DofTable(np.array(nodes), np.array(components), np.array(points))


def _direction(path: Path, number: int, word: str) -> int:
    if word.lower() in DIRECTIONS:
        return DIRECTIONS.index(word.lower())
    if word in ("1", "2", "3", "4", "5", "6"):
        return int(word) - 1
    raise wrong_line(path, number, f"the direction {shown_as(word)}", "x, y, z, rx, ry, rz or 1 to 6")


def refuse_size(path: Path, table: DofTable, count: int, what: str) -> None:
    """Raise InputError where matrices have another number of degrees of freedom than a table has rows."""
    if len(table.nodes) != count:
        raise InputError(
            "", got=f"{len(table.nodes)} rows in '{path.name}'", expected=f"{count}, one for each row of {what}"
        )
