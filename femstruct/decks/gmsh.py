"""Meshes of Gmsh: .msh of versions 2.2 and 4.1, text and binary.

Written after the description of both in the reference manual of Gmsh, chapter "File formats". meshio 5.3 reads the
cells of both rightly, but loses a group whose name a group of another dimension has too, and groups without a name.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.files.text_tables import wrong_line
from femstruct.model.imported_mesh import KINDS, CellBlock, Gathered, Makes, Stated, Tally

_POINT: Final = 15
_TYPES: Final = {
    1: "line2", 2: "tri3", 3: "quad4", 4: "tet4", 5: "hex8", 8: "line3", 9: "tri6", 10: "quad9", 11: "tet10",
    12: "hex27", 16: "quad8", 17: "hex20",
}  # fmt: skip
_HEX20: Final = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]
_ORDER: Final = {  # nodes of Gmsh in the order of VTK, where it is another
    "tet10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    "hex20": _HEX20,
    "hex27": [*_HEX20, 22, 23, 21, 24, 20, 25, 26],
}
_OTHERS: Final = {6: "a wedge", 7: "a pyramid", 13: "a wedge", 14: "a pyramid", 18: "a wedge", 19: "a pyramid"}
_READ: Final = ("MeshFormat", "PhysicalNames", "Entities", "Nodes", "Elements")
_WITHOUT_EFFECT: Final = {  # sections by why they make nothing
    **dict.fromkeys(("PartitionedEntities", "GhostElements", "Partitions"), "how the mesh is divided for computing"),
    **dict.fromkeys(("Parametrizations", "NOD", "ELM", "ParametricNodes"), "how the mesh was made"),
    **dict.fromkeys(("NodeData", "ElementData", "ElementNodeData", "InterpolationScheme", "View"), "results"),
    "Periodic": "which nodes were meshed alike",
    "Comments": "notes",
}
Group = tuple[int, int]  # dimension and number


class _Section:
    """The numbers of a section, one after the other, from text or binary."""

    def __init__(self, path: Path, data: bytes, start: int, end: int, order: str) -> None:
        self._path, self._data, self._start, self._end, self._order = path, data, start, end, order
        self._words: Floats | None = None if order else self._read()
        self._at = 0 if self._words is not None else start

    def _read(self) -> Floats:
        """All numbers of a section in text. Raises InputErrors with the line of what is none."""
        text = self._data[self._start : self._end]
        try:
            found = np.array(text.split(), dtype=np.float64)
            if np.isfinite(found).all():
                return found
        except ValueError:
            pass
        for number, line in enumerate(text.splitlines(), self.line(self._start)):
            if not all(_is_number(word) for word in line.split()):
                shown = line.decode("latin-1").strip()[:60]
                raise wrong_line(self._path, number, f"'{shown}'", "numbers")
        raise self.refuse("words", "numbers")

    def line(self, at: int) -> int:
        """Number of the line at a byte."""
        return self._data[:at].count(b"\n") + 1

    def refuse(self, got: str, expected: str, do: str = "") -> Exception:
        """A mistake in this section; in text with the line that it begins in."""
        return wrong_line(self._path, self.line(self._start) - 1, got, expected, do)

    def take(self, count: int, kind: str) -> NDArray[np.float64]:
        """The next numbers.

        Parameters
        ----------
        kind : str
            I of four bytes, q of eight, d.
        """
        if count < 0:
            raise self.refuse(f"{count} numbers", "a count of at least 0")
        if self._words is not None:
            found = self._words[self._at : self._at + count]
            self._at += count
        else:
            size = 4 if kind == "i" else 8
            stop = min(self._at + count * size, self._end)
            found = np.frombuffer(self._data[self._at : stop - (stop - self._at) % size], self._order + kind[0])
            self._at += count * size
        if len(found) < count:
            raise self.refuse("a section that ends too early", f"{count - len(found)} numbers more")
        return found.astype(np.float64) if kind == "d" else found

    def whole(self, count: int, kind: str = "i") -> Integers:
        """The next whole numbers."""
        return self.take(count, kind).astype(np.int64)

    def one(self, kind: str = "i") -> int:
        """The next whole number."""
        return int(self.whole(1, kind)[0])

    def head(self) -> int:
        """The count that the section begins with, which is text in binary files of version 2, too."""
        if self._words is not None:
            return self.one()
        end = self._data.find(b"\n", self._at, self._end)
        word = self._data[self._at : end].strip()
        if not word.isdigit():
            raise self.refuse("no count", "a whole number")
        self._at = end + 1
        return int(word)

    def numbered_places(self, count: int) -> tuple[Integers, Floats]:
        """Numbers and places of nodes that alternate, in binary."""
        size = 28
        if self._at + size * count > self._end:
            raise self.refuse("a section that ends too early", f"{count} nodes")
        kind = [("number", f"{self._order}i4"), ("place", f"{self._order}f8", 3)]
        found = np.frombuffer(self._data[self._at : self._at + size * count], kind)
        self._at += size * count
        return found["number"].astype(np.int64), found["place"].astype(np.float64)

    @property
    def remaining(self) -> int:
        """How many numbers of text are left; 0 in binary."""
        return 0 if self._words is None else len(self._words) - self._at


def _is_number(word: bytes) -> bool:
    try:
        return isfinite(float(word))
    except ValueError:
        return False


def read_gmsh(path: Path, data: bytes) -> Gathered:
    """What a mesh of Gmsh has. Sets are its physical groups, those without a name as "physical 3".

    Raises InputError for what is no such file, InputErrors with the line.
    """
    sections = dict(_sections(path, data))
    if "MeshFormat" not in sections:
        raise InputError("", got=f"'{path.name}', which has no $MeshFormat", expected="a mesh of Gmsh")
    words = data[slice(*sections["MeshFormat"])].split(b"\n", 1)
    version, is_binary, *_ = [*words[0].decode("latin-1").split(), "", ""]
    order = ""
    if is_binary == "1":
        order = "<" if words[1][:4] == np.array(1, "<i4").tobytes() else ">"
    if version not in ("2", "2.1", "2.2", "4.1"):
        raise wrong_line(
            path, 2, f"version '{version[:20]}' of the format", "2.2 or 4.1", "save it with 'gmsh -format msh41 -save'"
        )
    for needed in ("Nodes", "Elements"):
        if needed not in sections:
            raise InputError("", got=f"'{path.name}' without ${needed}", expected="nodes and elements")
    names = _names(path, data, sections)
    opened: dict[str, _Section] = {
        name: _Section(path, data, *sections[name], order)
        for name in ("Nodes", "Elements", "Entities")
        if name in sections
    }
    left_out = Tally()
    for name in sections:
        if name not in _READ:
            known = name in _WITHOUT_EFFECT
            why = _WITHOUT_EFFECT.get(name, "a section that is not known")
            line = data[: sections[name][0]].count(b"\n")
            left_out.add(f"${name}", Makes.NOTHING if known else Makes.UNKNOWN, why, line)
    old = version != "4.1"
    found = _version_2(opened["Nodes"], opened["Elements"], names) if old else _version_4(opened, names)
    return found._replace(stated=Stated(left_out=left_out.found))


def _sections(path: Path, data: bytes) -> Iterator[tuple[str, tuple[int, int]]]:
    """Names of all sections, and where they begin and end."""
    at = 0
    while (start := data.find(b"$", at)) >= 0:
        line = data.find(b"\n", start)
        name = data[start + 1 : line].strip().decode("latin-1")
        end = data.find(b"$End" + name.encode("latin-1"), line)
        if line < 0 or end < 0:
            number = data[:start].count(b"\n") + 1
            raise wrong_line(path, number, f"${name[:40]} without its end", f"$End{name[:40]}", "the file is cut off")
        yield name, (line + 1, end)
        at = end + len(name) + 4


def _names(path: Path, data: bytes, sections: dict[str, tuple[int, int]]) -> dict[Group, str]:
    """Names of physical groups."""
    if "PhysicalNames" not in sections:
        return {}
    start, end = sections["PhysicalNames"]
    first, names = data[:start].count(b"\n") + 1, {}
    for number, line in enumerate(data[start:end].decode("utf-8", "replace").splitlines(), first):
        if number == first or not line.strip():
            continue
        numbers, _, name = line.strip().partition('"')
        try:
            dimension, tag = (int(word) for word in numbers.split())
        except ValueError:
            raise wrong_line(path, number, f"'{line.strip()[:60]}'", 'a dimension, a number and a "name"') from None
        names[dimension, tag] = name.rpartition('"')[0]
    return names


def _version_2(nodes: _Section, elements: _Section, names: dict[Group, str]) -> Gathered:
    binary = not nodes.remaining
    count = nodes.head()
    if binary:
        numbers, points = nodes.numbered_places(count)
    else:
        if nodes.remaining != 4 * count:
            raise nodes.refuse(f"{nodes.remaining} numbers for {count} nodes", "a number and x, y, z each")
        table = nodes.take(4 * count, "d").reshape(-1, 4)
        numbers, points = table[:, 0].astype(np.int64), table[:, 1:]
    members: dict[Group, list[Integers]] = {}
    node_members: dict[Group, list[Integers]] = {}
    blocks = []
    for code, tags, rows in _elements_2(elements, elements.head(), binary):
        group, cells = rows[:, 1] if tags else np.zeros(len(rows), np.int64), rows[:, 1 + tags :]
        if code == _POINT:
            _into(node_members, 0, group, cells[:, 0])
            continue
        kind = _TYPES[code]
        blocks.append(_block(kind, rows[:, 0], cells))
        _into(members, KINDS[kind].dimension, group, rows[:, 0])
    # an element of several groups stands there once for each of them
    return Gathered(numbers, points, blocks, _sets(node_members, names), _sets(members, names), repeats=True)


def _elements_2(section: _Section, count: int, binary: bool) -> Iterator[tuple[int, int, Integers]]:
    """Type, number of tags, and rows of number, tags and nodes, of elements that have both in common."""
    if binary:
        while count > 0:
            code, several, tags = section.whole(3)
            width = 1 + int(tags) + _width(section, int(code))
            if several < 1:
                raise section.refuse(f"a block of {several} elements", "at least one")
            yield int(code), int(tags), section.whole(int(several) * width).reshape(-1, width)
            count -= int(several)
        return
    values = section.whole(section.remaining)
    flat, starts, at = values.tolist(), [], 0
    widths: dict[int, int] = {}
    for _ in range(count):
        if at + 3 > len(flat):
            raise section.refuse("fewer elements than stated", f"{count}")
        starts.append(at)
        code = flat[at + 1]
        if code not in widths:
            widths[code] = _width(section, code)
        at += 3 + flat[at + 2] + widths[code]
    if at != len(flat):
        raise section.refuse(f"{len(flat)} numbers in {count} elements", f"{at}")
    begin = np.array(starts, np.int64)
    for code, tags in np.unique(np.stack([values[begin + 1], values[begin + 2]], axis=1), axis=0).tolist():
        own = begin[(values[begin + 1] == code) & (values[begin + 2] == tags)]
        columns = np.r_[0, 3 : 3 + tags + widths[code]]
        yield code, tags, values[own[:, None] + columns]


def _version_4(opened: dict[str, _Section], names: dict[Group, str]) -> Gathered:
    groups = _entities(opened["Entities"]) if "Entities" in opened else {}
    nodes, elements = opened["Nodes"], opened["Elements"]
    numbers, points = [np.zeros(0, np.int64)], [np.zeros((0, 3))]
    for _ in range(int(nodes.whole(4, "q")[0])):
        dimension, _, parametric = nodes.whole(3)
        count = nodes.one("q")
        numbers.append(nodes.whole(count, "q"))
        width = 3 + (max(int(dimension), 0) if parametric else 0)
        points.append(nodes.take(count * width, "d").reshape(count, width)[:, :3])
    members: dict[Group, list[Integers]] = {}
    node_members: dict[Group, list[Integers]] = {}
    blocks = []
    for _ in range(int(elements.whole(4, "q")[0])):
        dimension, entity, code = elements.whole(3).tolist()
        count, width = elements.one("q"), 1 + _width(elements, code)
        rows = elements.whole(count * width, "q").reshape(count, width)
        for group in groups.get((dimension, entity), ()):
            if code == _POINT:
                node_members.setdefault((0, group), []).append(rows[:, 1])
            else:
                members.setdefault((dimension, group), []).append(rows[:, 0])
        if code != _POINT:
            blocks.append(_block(_TYPES[code], rows[:, 0], rows[:, 1:]))
    of_nodes, of_cells = (_sets(one, names) for one in (node_members, members))
    return Gathered(np.concatenate(numbers), np.concatenate(points), blocks, of_nodes, of_cells, repeats=True)


def _entities(section: _Section) -> dict[Group, list[int]]:
    """Physical groups of every entity, by its dimension and number; signs say only how a group is turned."""
    counts = section.whole(4, "q").tolist()
    groups = {}
    for dimension, count in enumerate(counts):
        for _ in range(count):
            entity = section.one()
            section.take(6 if dimension else 3, "d")
            groups[dimension, entity] = np.abs(section.whole(section.one("q"))).tolist()
            if dimension:
                section.whole(section.one("q"))
    return groups


def _width(section: _Section, code: int) -> int:
    """Nodes of an element of this type."""
    if code == _POINT:
        return 1
    if code not in _TYPES:
        what = _OTHERS.get(code, "one of higher order")
        raise section.refuse(
            f"an element of type {code}, {what}",
            "lines, triangles, quadrilaterals, tetrahedra or hexahedra, linear or quadratic",
        )
    return KINDS[_TYPES[code]].nodes


def _block(kind: str, numbers: Integers, nodes: Integers) -> CellBlock:
    return CellBlock(kind, numbers, nodes[:, _ORDER[kind]] if kind in _ORDER else nodes)


def _into(members: dict[Group, list[Integers]], dimension: int, groups: Integers, numbers: Integers) -> None:
    """Add the members of each group; group 0 is none."""
    for group in np.unique(np.abs(groups)).tolist():
        if group:
            members.setdefault((dimension, group), []).append(numbers[np.abs(groups) == group])


def _sets(members: dict[Group, list[Integers]], names: dict[Group, str]) -> dict[str, Integers]:
    """Sets by name; groups of one name are one set."""
    together: dict[str, list[Integers]] = {}
    for group, some in members.items():
        together.setdefault(names.get(group) or f"physical {group[1]}", []).extend(some)
    return {name: np.concatenate(some) for name, some in together.items()}
