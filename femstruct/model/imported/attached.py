"""What a structure takes of what a mesh file states beside its cells, and on which nodes: supports, links, masses.

A node of the file is one node, however many parts of ours have it: what is attached to it is attached to all of them. A
node that leads a link and is of no cell, as the middle of a spider, gets a node of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from femstruct.arrays import Integers, freeze, frozen_integers
from femstruct.errors import InputError, some_of
from femstruct.model.imported.cell_kinds import KINDS
from femstruct.model.imported.imported_mesh import ImportedMesh, StatedHold, StatedLink, StatedMass
from femstruct.model.imported.stated.left_out import Makes

Users = Sequence[tuple[ImportedMesh, Mapping[str, Integers]]]
"""Meshes of files with the rows of the cells that parts take of them, by kind."""
TAKEN: Final = ("supports", "links", "masses")
SETS_SHOWN: Final = 6


@dataclass(frozen=True, eq=False)
class Attached:
    """What is taken of a file, by rows of its points, on nodes that parts have.

    take : out of `TAKEN`. alone [n] : rows that get a node of their own. left : what could not be taken, in words.
    """

    mesh: ImportedMesh
    take: tuple[str, ...]
    holds: tuple[StatedHold, ...]
    links: tuple[StatedLink, ...]
    masses: tuple[StatedMass, ...]
    alone: Integers
    left: tuple[str, ...]

    def __post_init__(self) -> None:
        freeze(self, alone=frozen_integers(f"mesh {self.mesh.source} alone", self.alone, (None,)))


def same_file(one: ImportedMesh, other: ImportedMesh) -> bool:
    """Whether two meshes are of one file, read with one unit of length."""
    return one is other or (one.source == other.source and np.array_equal(one.points, other.points))


def refuse_missing(where: str, mesh: ImportedMesh, take: Sequence[str]) -> None:
    """Raise InputError for what is to be taken and the file does not state."""
    stated = dict(zip(TAKEN, (mesh.stated.holds, mesh.stated.links, mesh.stated.masses), strict=True))
    having = [word for word, some in stated.items() if some]
    wrong = [word for word in take if word not in having]
    if wrong or not take:
        unmade = {"supports": Makes.SUPPORTS, "links": Makes.LINKS, "masses": Makes.MASSES}
        left = [one.named for one in mesh.stated.left_out if wrong and one.makes is unmade[wrong[0]]]
        some = f"{wrong[0]}, which {mesh.source} states only as {some_of(left, 3)}, which are not read" if left else ""
        raise InputError(
            where,
            got=some or (f"{wrong[0]}, which {mesh.source} does not state" if wrong else "nothing"),
            expected=some_of(having) or f"supports, links or masses, of which {mesh.source} states none that is read",
            do=f"write {wrong[0] if wrong[0] != 'links' else 'joints or constraints'} in the model" if left else "",
        )


def supports_of(where: str, mesh: ImportedMesh, named: Sequence[str]) -> tuple[StatedHold, ...]:
    """Held nodes of the named sets of supports; without names of those that the file puts to use, or of its only one.

    Raises InputError for a set that is not there, and where nothing says which of several is meant.
    """
    known = list(dict.fromkeys(one.name for one in mesh.stated.holds))
    unknown = [name for name in named if name not in known]
    if unknown:
        raise InputError(where, got=f"'{unknown[0]}'", expected=f"sets of supports: {some_of(known, SETS_SHOWN)}")
    wanted = named or [name for name in known if name in mesh.stated.active] or known
    if not named and len(wanted) == len(known) > 1 and not mesh.stated.active:
        raise InputError(
            where,
            got=f"supports of {mesh.source}, which has {len(known)} sets of them",
            expected=f"'supports' beside, those that hold: {some_of(known, SETS_SHOWN)}",
            do=f"write supports: [{known[0]}], or all of them",
        )
    return tuple(one for one in mesh.stated.holds if one.name in wanted)


def attached(mesh: ImportedMesh, take: Sequence[str], holds: Sequence[StatedHold], users: Users) -> Attached:
    """What is taken of a file where parts have its nodes. holds : those of its supports that are meant."""
    there, turning = _nodes_of(mesh, users)
    held = tuple(holds) if "supports" in take else ()
    masses = mesh.stated.masses if "masses" in take else ()
    every = mesh.stated.links if "links" in take else ()
    matter = np.zeros(len(there), dtype=bool)  # what nodes without a cell are needed for
    matter[np.array([*(one.node for one in masses), *(one.node for one in every)], np.int64)] = True
    matter[_together(one.nodes for one in held)] = True
    placed, links = _reached(there, matter, every)
    leading = np.zeros(len(there), dtype=bool)
    leading[np.array([one.node for one in links if one.weights is None], np.int64)] = True
    kept_holds = tuple(replace(one, nodes=one.nodes[placed[one.nodes]]) for one in held)
    kept_masses = tuple(one for one in masses if placed[one.node])
    counted = (
        (len(np.unique(_together(one.nodes[~placed[one.nodes]] for one in held))), "held nodes that no part has"),
        (len(every) - len(links), "links between nodes that no part has"),
        (sum(int((~placed[one.nodes]).sum()) for one in links), "nodes of links that no part has"),
        (len(masses) - len(kept_masses), "masses at nodes that no part has"),
    )
    return Attached(
        mesh,
        tuple(take),
        tuple(one for one in kept_holds if len(one.nodes)),
        tuple(replace(one, nodes=one.nodes[placed[one.nodes]]) for one in links),
        kept_masses,
        np.flatnonzero((placed & ~there) | (leading & ~turning)),
        tuple(f"{count} {words}" for count, words in counted if count),
    )


def _nodes_of(mesh: ImportedMesh, users: Users) -> tuple[np.ndarray, np.ndarray]:
    """Which nodes of a file are of cells that parts take, and which of those turn, as nodes of shells do."""
    there, turning = np.zeros((2, len(mesh.points)), dtype=bool)
    for other, cells in users:
        if same_file(mesh, other):
            for kind, rows in cells.items():
                nodes = mesh.cells[kind][rows]
                there[nodes] = True
                turning[nodes] |= KINDS[kind].dimension < 3
    return there, turning


def _reached(
    there: np.ndarray, matter: np.ndarray, links: Sequence[StatedLink]
) -> tuple[np.ndarray, tuple[StatedLink, ...]]:
    """Which nodes are of parts or led to by links from them, and the links that join some of them."""
    placed = there.copy()
    while True:
        live = [one for one in links if placed[one.node] or placed[one.nodes].any()]
        grown = placed.copy()
        for one in live:
            grown[one.node] = True
            grown[one.nodes] |= matter[one.nodes]
        if np.array_equal(grown, placed):
            of_all = {True: np.all, False: np.any}  # the mean of some of the nodes would be another one
            return placed, tuple(one for one in live if of_all[one.weights is not None](placed[one.nodes]))
        placed = grown


def _together(some: Iterable[Integers]) -> Integers:
    return np.concatenate([np.zeros(0, np.int64), *some])
