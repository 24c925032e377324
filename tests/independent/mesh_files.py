"""Meshes of all kinds of cells as the manuals of their formats write them: Nastran, Abaqus, I-DEAS and Gmsh.

Nodes of a cell here: corners, then the middles of `EDGES` in their order. Each format orders middles by its own list of
edges, from its manual.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

Floats = np.ndarray
Pairs = tuple[tuple[int, int], ...]

_RING3: Final[Pairs] = ((0, 1), (1, 2), (2, 0))
_RING4: Final[Pairs] = ((0, 1), (1, 2), (2, 3), (3, 0))
_TOP: Final[Pairs] = ((4, 5), (5, 6), (6, 7), (7, 4))
_UP: Final[Pairs] = ((0, 4), (1, 5), (2, 6), (3, 7))
_TET: Final[Pairs] = (*_RING3, (0, 3), (1, 3), (2, 3))
EDGES: Final[Mapping[str, Pairs]] = {"tri6": _RING3, "quad8": _RING4, "tet10": _TET, "hex20": (*_RING4, *_TOP, *_UP)}
CORNERS: Final = {"tri3": 3, "tri6": 3, "quad4": 4, "quad8": 4, "tet4": 4, "tet10": 4, "hex8": 8, "hex20": 8}
_NASTRAN: Final[Mapping[str, Pairs]] = {**EDGES, "hex20": (*_RING4, *_UP, *_TOP)}
_GMSH: Final[Mapping[str, Pairs]] = {
    **EDGES,
    "tet10": ((0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1)),
    "hex20": ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)),
}
_GMSH_TYPE: Final = {"tri3": 2, "quad4": 3, "tet4": 4, "hex8": 5, "tri6": 9, "tet10": 11, "quad8": 16, "hex20": 17}
_UNV_TYPES: Final = {  # plane stress, plane strain, plate, membrane, axisymmetric, thin shell
    "tri3": (41, 51, 61, 74, 81, 91), "tri6": (42, 52, 62, 72, 82, 92), "quad4": (44, 54, 64, 71, 84, 94),
    "quad8": (45, 55, 65, 75, 85, 95), "tet4": (111,), "tet10": (118,), "hex8": (115,), "hex20": (116,),
}  # fmt: skip
_UNV: Final[Mapping[str, tuple[int | tuple[int, int], ...]]] = {  # a pair is the middle between two corners
    "tri6": (0, (0, 1), 1, (1, 2), 2, (2, 0)),
    "quad8": (0, (0, 1), 1, (1, 2), 2, (2, 3), 3, (3, 0)),
    "tet10": (0, (0, 1), 1, (1, 2), 2, (2, 0), (0, 3), (1, 3), (2, 3), 3),
    "hex20": (0, (0, 1), 1, (1, 2), 2, (2, 3), 3, (3, 0), (0, 4), (1, 5), (2, 6), (3, 7),
              4, (4, 5), 5, (5, 6), 6, (6, 7), 7, (7, 4)),
}  # fmt: skip
_CARD: Final = {
    "tri3": "CTRIA3", "tri6": "CTRIA6", "quad4": "CQUAD4", "quad8": "CQUAD8", "tet4": "CTETRA", "tet10": "CTETRA",
    "hex8": "CHEXA", "hex20": "CHEXA",
}  # fmt: skip
_TYPE: Final = {
    "tri3": "S3", "tri6": "STRI65", "quad4": "S4R", "quad8": "S8R", "tet4": "C3D4", "tet10": "C3D10", "hex8": "C3D8I",
    "hex20": "C3D20R",
}  # fmt: skip


@dataclass(frozen=True)
class Group:
    """Cells of one kind with a name, and the name of nodes of theirs. cells [c, k] : nodes from 0."""

    name: str
    kind: str
    cells: Floats
    held: str
    nodes: tuple[int, ...]

    @property
    def dimension(self) -> int:
        return 2 if self.kind[:3] in ("tri", "qua") else 3


@dataclass(frozen=True)
class Meshed:
    """Nodes [n, 3] and groups; numbers [n] of nodes in the file."""

    points: Floats
    groups: tuple[Group, ...]
    numbers: Floats

    def rows(self) -> list[tuple[int, int, Group, Floats]]:
        """Number of each cell, from 1, of its group, from 1, the group, and its nodes by their numbers."""
        every = [(at + 1, one, cell) for at, one in enumerate(self.groups) for cell in one.cells]
        return [(number, at, one, self.numbers[cell]) for number, (at, one, cell) in enumerate(every, 1)]


def _ordered(kind: str, nodes: Floats, edges: Mapping[str, Pairs]) -> list[int]:
    """Corners, then the middles of these edges."""
    if kind not in EDGES:
        return [int(one) for one in nodes]
    middle = {frozenset(pair): at + CORNERS[kind] for at, pair in enumerate(EDGES[kind])}
    order = [*range(CORNERS[kind]), *(middle[frozenset(pair)] for pair in edges[kind])]
    return [int(nodes[at]) for at in order]


def nastran(mesh: Meshed) -> str:
    """Free fields, continued lines; a property for each group, PSHELL or PSOLID, SPC1 of its held nodes."""
    lines = ["BEGIN BULK"]
    lines += [f"GRID,{n},,{x!r},{y!r},{z!r}" for n, (x, y, z) in zip(mesh.numbers, mesh.points.tolist(), strict=True)]
    for number, at, one, nodes in mesh.rows():
        words = [_CARD[one.kind], str(number), str(at), *map(str, _ordered(one.kind, nodes, _NASTRAN))]
        lines.append(",".join(words[:9]))
        lines += ["," + ",".join(words[k : k + 8]) for k in range(9, len(words), 8)]
    for at, one in enumerate(mesh.groups, 1):
        lines.append(f"PSHELL,{at},1,.01,1,,1" if one.dimension == 2 else f"PSOLID,{at},1")
        held = [str(mesh.numbers[node]) for node in one.nodes]
        lines += [f"SPC1,{at},123456,{','.join(held[k : k + 6])}" for k in range(0, len(held), 6)]
    return "\n".join([*lines, "MAT1,1,2.1+11,,.3,7850.", "ENDDATA", ""])


def abaqus(mesh: Meshed) -> str:
    """Numbers of a cell over several lines; a set of elements and one of nodes for each group, the latter generated
    where its numbers are in steps."""
    lines = ["*NODE"]
    lines += [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in zip(mesh.numbers, mesh.points.tolist(), strict=True)]
    for at, one in enumerate(mesh.groups, 1):
        lines.append(f"*ELEMENT, TYPE={_TYPE[one.kind]}, ELSET={one.name}")
        for number, of, _, nodes in mesh.rows():
            if of == at:
                words = [str(number), *map(str, _ordered(one.kind, nodes, EDGES))]
                lines += [", ".join(words[k : k + 10]) + ("," if k + 10 < len(words) else "")
                          for k in range(0, len(words), 10)]  # fmt: skip
        held = sorted(int(mesh.numbers[node]) for node in one.nodes)
        steps = set(np.diff(held).tolist())
        if len(steps) == 1:
            lines += [f"*NSET, NSET={one.held}, GENERATE", f"{held[0]}, {held[-1]}, {steps.pop()}"]
        else:
            lines += [f"*NSET, NSET={one.held}", ", ".join(map(str, held))]
    return "\n".join([*lines, ""])


def unv(mesh: Meshed, groups: int = 2467) -> str:
    """Data sets 2411, 2412 and 2467 or 2477: groups of elements and of nodes."""
    lines = ["    -1", "   164", "         1SI: Meter (newton)         2", "    -1", "    -1", "  2411"]
    for number, (x, y, z) in zip(mesh.numbers, mesh.points.tolist(), strict=True):
        lines += [f"{number:10d}{1:10d}{1:10d}{11:10d}", f"{x:25.16E}{y:25.16E}{z:25.16E}".replace("E", "D")]
    lines += ["    -1", "    -1", "  2412"]
    for number, _, one, nodes in mesh.rows():
        order = _UNV.get(one.kind, tuple(range(CORNERS[one.kind])))
        middle = {frozenset(pair): at + CORNERS[one.kind] for at, pair in enumerate(EDGES.get(one.kind, ()))}
        row = [nodes[step if isinstance(step, int) else middle[frozenset(step)]] for step in order]
        types = _UNV_TYPES[one.kind]
        lines.append("".join(f"{word:10d}" for word in (number, types[number % len(types)], 1, 1, 7, len(row))))
        lines += ["".join(f"{node:10d}" for node in row[k : k + 8]) for k in range(0, len(row), 8)]
    lines += ["    -1", "    -1", f"  {groups}"]
    for at, one in enumerate(mesh.groups, 1):
        own = [(8, number) for number, of, _, _ in mesh.rows() if of == at]
        for code, name, members in (
            (2 * at, one.name, own),
            (2 * at + 1, one.held, [(7, mesh.numbers[node]) for node in one.nodes]),
        ):
            lines += ["".join(f"{word:10d}" for word in (code, 0, 0, 0, 0, 0, 0, len(members))), name]
            words = [word for kind, number in members for word in (kind, number, 0, 0)]
            lines += ["".join(f"{word:10d}" for word in words[k : k + 8]) for k in range(0, len(words), 8)]
    return "\n".join([*lines, "    -1", ""])


def _physical(mesh: Meshed) -> list[tuple[int, int, str]]:
    """Dimension, number and name of groups: cells, then points for the held nodes."""
    cells = [(one.dimension, at, one.name) for at, one in enumerate(mesh.groups, 1)]
    return [*cells, *((0, 50 + at, one.held) for at, one in enumerate(mesh.groups, 1))]


def _names(mesh: Meshed) -> bytes:
    groups = _physical(mesh)
    rows = [f'{dimension} {number} "{name}"' for dimension, number, name in groups]
    return "\n".join(["$PhysicalNames", str(len(groups)), *rows, "$EndPhysicalNames", ""]).encode()


def gmsh_2(mesh: Meshed, order: str = "") -> bytes:
    """Version 2.2 in text, or binary of an order of bytes, < or >."""
    rows = [
        (number, _GMSH_TYPE[one.kind], at, _ordered(one.kind, nodes, _GMSH)) for number, at, one, nodes in mesh.rows()
    ]
    held = [(at, node) for at, one in enumerate(mesh.groups, 1) for node in one.nodes]
    rows += [(len(rows) + k, 15, 50 + at, [int(mesh.numbers[node])]) for k, (at, node) in enumerate(held, 1)]
    places = list(zip(mesh.numbers.tolist(), mesh.points.tolist(), strict=True))
    if not order:
        text = [f"$Nodes\n{len(places)}", *(f"{n} {x!r} {y!r} {z!r}" for n, (x, y, z) in places), "$EndNodes"]
        text += ["$Elements", str(len(rows))]
        text += [f"{n} {code} 2 {at} {at} {' '.join(map(str, nodes))}" for n, code, at, nodes in rows]
        return (
            b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + _names(mesh) + "\n".join([*text, "$EndElements", ""]).encode()
        )
    data = b"$MeshFormat\n2.2 1 8\n" + struct.pack(f"{order}i", 1) + b"\n$EndMeshFormat\n" + _names(mesh)
    data += f"$Nodes\n{len(places)}\n".encode() + b"".join(struct.pack(f"{order}i3d", n, *at) for n, at in places)
    data += f"\n$EndNodes\n$Elements\n{len(rows)}\n".encode()
    for kind in dict.fromkeys(code for _, code, _, _ in rows):
        own = [row for row in rows if row[1] == kind]
        data += struct.pack(f"{order}3i", kind, len(own), 2)
        data += b"".join(struct.pack(f"{order}{3 + len(nodes)}i", n, at, at, *nodes) for n, _, at, nodes in own)
    return data + b"\n$EndElements\n"


def gmsh_4(mesh: Meshed, order: str = "") -> bytes:
    """Version 4.1 in text, or binary of an order of bytes, < or >; an entity for each group, and one for each held
    node."""
    binary = bool(order)

    def pack(kinds: str, *values: float) -> bytes:
        """kinds : i of four bytes, q of eight, d."""
        if not binary:
            return (" ".join(repr(one) for one in values) + "\n").encode()
        return struct.pack(order + kinds, *values)

    points = [(at, node) for at, one in enumerate(mesh.groups, 1) for node in one.nodes]
    by_dimension = [(dimension, [(at, one) for at, one in enumerate(mesh.groups, 1) if one.dimension == dimension])
                    for dimension in (1, 2, 3)]  # fmt: skip
    end = b"\n" if binary else b""
    data = f"$MeshFormat\n4.1 {int(binary)} 8\n".encode() + (struct.pack(f"{order}i", 1) + b"\n" if binary else b"")
    data += b"$EndMeshFormat\n" + _names(mesh) + b"$Entities\n"
    data += pack("4q", len(points), *(len(some) for _, some in by_dimension))
    for number, (at, node) in enumerate(points, 1):
        data += pack("i3dqi", number, *mesh.points[node].tolist(), 1, 50 + at)
    for _, some in by_dimension:
        for at, one in some:
            ends = mesh.points[np.unique(one.cells)]
            box = [*ends.min(axis=0).tolist(), *ends.max(axis=0).tolist()]
            data += pack("i6dqiqi", at, *box, 1, -at if one.dimension == 2 else at, 1, 1)
    data += end + b"$EndEntities\n$Nodes\n"
    half = len(mesh.points) // 2
    parts: Sequence[slice] = (slice(0, half), slice(half, None))
    numbers = mesh.numbers.tolist()
    data += pack("4q", 2, len(numbers), min(numbers), max(numbers))
    for number, part in enumerate(parts):
        own, places = numbers[part], mesh.points[part].tolist()
        parametric = number == 1
        data += pack("3iq", 2, 1, int(parametric), len(own))
        data += b"".join(pack("q", one) for one in own)
        data += b"".join(pack("5d" if parametric else "3d", *at, *((0.5, 0.25) if parametric else ())) for at in places)
    rows = mesh.rows()
    data += (
        end + b"$EndNodes\n$Elements\n" + pack("4q", len(mesh.groups) + len(points), len(rows) + len(points), 1, 999)
    )
    for at, one in enumerate(mesh.groups, 1):
        own_rows = [(n, _ordered(one.kind, nodes, _GMSH)) for n, of, _, nodes in rows if of == at]
        data += pack("3iq", one.dimension, at, _GMSH_TYPE[one.kind], len(own_rows))
        data += b"".join(pack(f"{1 + len(nodes)}q", n, *nodes) for n, nodes in own_rows)
    for number, (_, node) in enumerate(points, 1):
        data += pack("3iq", 0, number, 15, 1) + pack("2q", len(rows) + number, numbers[node])
    return data + end + b"$EndElements\n"
