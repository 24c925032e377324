"""What mesh files state and no part of a structure uses: cells of other kinds or sets, masses, links, held nodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.errors import Finding, some_of
from femstruct.model.imported.attached import TAKEN, same_file
from femstruct.model.imported.imported_mesh import ImportedMesh
from femstruct.model.structure import Structure

WORDS: Final = {"line": "bars", "tri": "triangles", "quad": "quadrilaterals", "tet": "tetrahedra", "hex": "hexahedra"}
SHOWN: Final = 4  # kinds of what is not used
_OFFER: Final = "What the file states is taken as it is by a part"


def unused_findings(structure: Structure) -> tuple[Finding, ...]:
    """What is not used of each mesh file, whichever of its parts would use it."""
    by_file: dict[tuple[object, ...], list[tuple[str, ImportedMesh, Mapping[str, Integers]]]] = {}
    for part in structure.parts:
        for mesh, cells in part.taken():
            counts = tuple((kind, len(some)) for kind, some in mesh.cells.items())
            by_file.setdefault((mesh.source, len(mesh.points), counts), []).append((part.name, mesh, cells))
    return tuple(finding for users in by_file.values() for finding in _of_one(structure, users))


def _of_one(
    structure: Structure, users_of_it: list[tuple[str, ImportedMesh, Mapping[str, Integers]]]
) -> Iterator[Finding]:
    mesh, names = users_of_it[0][1], [name for name, _, _ in users_of_it]
    used = {kind: np.zeros(len(cells), dtype=bool) for kind, cells in mesh.cells.items()}
    for _, _, cells in users_of_it:
        for kind, rows in cells.items():
            used[kind][rows] = True
    users = tuple((other, cells) for _, other, cells in users_of_it)
    taken = [one for part in structure.parts if (one := part.attaches(users)) and same_file(mesh, one.mesh)]
    open_ones = dict(_beside(structure, mesh, names, {word for one in taken for word in one.take}))
    left = [words for one in taken for words in one.left]
    yield from _cut(mesh, names)
    told = [*_cells(mesh, used), *mesh.stated.left_out, *open_ones.values(), *left]
    if told:
        offer = "" if not open_ones else f". {_OFFER} {_written(mesh, list(open_ones))}"
        yield Finding(
            "mesh-states-more",
            f"{', '.join(names)}: {mesh.source} states what no part uses: {some_of(told, SHOWN)}. Their stiffness, "
            f"mass and supports are missing unless the model has them otherwise: write parts, masses, joints, supports"
            f"{offer}",
            {"kinds": len(told)},
        )


def _cut(mesh: ImportedMesh, names: list[str]) -> Iterator[Finding]:
    """What a file shows that ends too early: no word at its end, nodes without elements."""
    whose = f"{', '.join(names)}: {mesh.source}"
    if mesh.stated.open_end:
        yield Finding(
            "mesh-without-end", f"{whose} has no {mesh.stated.open_end}. If the file is cut, the rest is missing"
        )
    ours = np.zeros(len(mesh.points), dtype=bool)
    for nodes in (*mesh.cells.values(), *(one.nodes for one in mesh.stated.links)):
        ours[nodes.ravel()] = True
    ours[[one.node for one in mesh.stated.links] + [one.node for one in mesh.stated.masses]] = True
    if lone := int((~ours).sum()):
        yield Finding(
            "nodes-alone",
            f"{whose} has {lone} nodes of {len(ours)} that no element, link or mass uses, such as "
            f"{some_of(mesh.numbers[~ours].tolist(), SHOWN)}. They are left out. If they belong to the part, elements "
            "are missing: is the file cut?",
            {"nodes": lone},
        )


def _written(mesh: ImportedMesh, words: list[str]) -> str:
    """The part that takes something of a file, as it is written."""
    scale = {1.0: "", 1e-3: "scale: mm, "}.get(mesh.scale, f"scale: {mesh.scale:g}, ")
    return f"{{type: attachments, mesh: {mesh.source}, {scale}take: [{', '.join(words)}]}}"


def _cells(mesh: ImportedMesh, used: Mapping[str, np.ndarray]) -> Iterator[str]:
    """Cells that no part takes: elements by their type in the file, or those with nodes that no part has."""
    ours = np.zeros(len(mesh.points), dtype=bool)
    for kind, mask in used.items():
        ours[mesh.cells[kind][mask].ravel()] = True
    for kind, mask in used.items():
        numbers = mesh.cell_numbers[kind]
        left = ~mask
        for word, elements in mesh.stated.elements.items():
            of_type = left & np.isin(numbers, elements)
            if of_type.any():
                yield f"{of_type.sum()} {word} elements{_sets_of(mesh, kind, of_type)}"
            left &= ~of_type
        apart = left & ~ours[mesh.cells[kind]].all(axis=1)
        if apart.any():
            yield f"{apart.sum()} {WORDS[kind.rstrip('0123456789')]}{_sets_of(mesh, kind, apart)}"


def _sets_of(mesh: ImportedMesh, kind: str, which: np.ndarray) -> str:
    names = [name for name, of in mesh.cell_sets.items() if kind in of and which[of[kind]].any()]
    return f" (set {some_of(names, 3)})" if names else ""


def _beside(structure: Structure, mesh: ImportedMesh, names: list[str], taken: set[str]) -> Iterator[tuple[str, str]]:
    """Masses, links, and held nodes that no support of a set holds, by the word for what takes them; none taken."""
    stated = mesh.stated
    held = [
        mesh.nodes_of(one.region.named)
        for one in structure.supports
        if one.on in names and one.region is not None and one.region.named in mesh.set_names
    ]
    ours = np.concatenate([np.zeros(0, np.int64), *held])
    whole = any(one.on in names and one.region is None for one in structure.supports)
    open_ones = [one for one in stated.holds if not (whole or np.isin(one.nodes, ours).all())]
    counts = (len(open_ones), len(stated.links), len(stated.masses))
    for word, count, what in zip(TAKEN, counts, ("held sets", "links", "masses"), strict=True):
        if count and word not in taken:
            yield word, f"{count} {what}"
