"""From the numbers of a file to rows: nodes and cells as a file names them become one mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError, some_of
from femstruct.model.imported.imported_mesh import ImportedMesh, Stated


class Block(NamedTuple):
    """Cells of one kind as a file has them: numbers [m], and the numbers of their nodes [m, k]."""

    kind: str
    numbers: Integers
    nodes: Integers


class Gathered(NamedTuple):
    """What a reader finds in a file, everything by the numbers that the file gives.

    nodes [n], points [n, 3]; blocks of cells, whose numbers differ; node_sets, cell_sets : numbers by name.
    stated : with numbers in place of rows. repeats : cells of the same nodes are one, as where a file names an element
    once for each of its groups. included : other files that it names, whose text is part of it.
    """

    nodes: Integers
    points: Floats
    blocks: Sequence[Block]
    node_sets: Mapping[str, Integers]
    cell_sets: Mapping[str, Integers]
    stated: Stated = Stated()
    repeats: bool = False
    included: tuple[Path, ...] = ()


def imported(source: str, found: Gathered, scale: float) -> ImportedMesh:
    """The mesh of what a reader found; scale : metres in the file's unit of length.

    Raises InputError for numbers that occur twice or that nothing has.
    """
    nodes, rows = _ordered(found.nodes, "node")
    blocks = _by_kind(found.blocks)
    cells = {kind: _rows(nodes, rows, block.nodes, "node") for kind, block in blocks.items()}
    kept = {kind: _first_of_equals(one) if found.repeats else np.arange(len(one)) for kind, one in cells.items()}
    lone = {kind: np.unique(first) for kind, first in kept.items()}
    place = {kind: np.searchsorted(lone[kind], first) for kind, first in kept.items()}  # of each cell among those kept
    owners = np.concatenate([np.full(len(one), k) for k, one in enumerate(cells.values())] or [np.zeros(0, np.int64)])
    places = np.concatenate([*place.values(), np.zeros(0, np.int64)]).astype(np.int64)
    all_cells, order = _ordered(
        np.concatenate([*(b.numbers for b in blocks.values()), np.zeros(0, np.int64)]), "element"
    )
    sets: dict[str, dict[str, Integers]] = {}
    for name, numbers in found.cell_sets.items():
        at = _rows(all_cells, order, numbers, "element")
        of = {kind: np.unique(places[at[owners[at] == k]]) for k, kind in enumerate(cells)}
        sets[name] = {kind: some for kind, some in of.items() if len(some)}
    return ImportedMesh(
        source,
        found.points * scale,
        found.nodes,
        {kind: one[lone[kind]] for kind, one in cells.items()},
        {kind: block.numbers[lone[kind]] for kind, block in blocks.items()},
        {name: np.unique(_rows(nodes, rows, some, "node")) for name, some in found.node_sets.items()},
        sets,
        _in_rows(found.stated, nodes, rows, scale),
        merged=sum(len(cells[kind]) - len(one) for kind, one in lone.items()),
        scale=scale,
    )


_LENGTHS: Final = {"area": 2, "volume": 3, "total": 0}  # in the unit of an amount of mass


def _by_kind(blocks: Sequence[Block]) -> dict[str, Block]:
    together: dict[str, list[Block]] = {}
    for block in blocks:
        together.setdefault(block.kind, []).append(block)
    return {
        kind: Block(kind, np.concatenate([b.numbers for b in some]), np.concatenate([b.nodes for b in some]))
        for kind, some in together.items()
        if sum(len(b.numbers) for b in some)
    }


def _ordered(numbers: Integers, what: str) -> tuple[Integers, Integers]:
    """The numbers in ascending order, and the row of each."""
    order = np.argsort(numbers, kind="stable")
    ascending = numbers[order]
    twice = ascending[1:][np.diff(ascending) == 0]
    if len(twice):
        raise InputError("", got=f"{what} {twice[0]} twice", expected=f"numbers of {what}s that differ")
    return ascending, order


def _rows(ascending: Integers, order: Integers, wanted: Integers, what: str) -> Integers:
    """Rows of the wanted numbers."""
    at = np.minimum(np.searchsorted(ascending, wanted), max(len(ascending) - 1, 0))
    missing = wanted[ascending[at] != wanted] if len(ascending) else wanted.ravel()
    if missing.size:
        raise InputError(
            "", got=f"{what} {some_of(np.unique(missing), 3)}, which it does not have", expected=f"{what}s of its own"
        )
    return order[at].astype(np.int64)


def _first_of_equals(cells: Integers) -> Integers:
    """For each cell [m, k] the first one with the same nodes, in whatever order [m]."""
    _, first, group = np.unique(np.sort(cells, axis=1), axis=0, return_index=True, return_inverse=True)
    return first[group.ravel()].astype(np.int64)


def _in_rows(stated: Stated, nodes: Integers, rows: Integers, scale: float) -> Stated:
    """The same with rows of nodes for their numbers, and lengths in metres."""

    def of(numbers: Integers | int) -> Integers:
        return _rows(nodes, rows, np.atleast_1d(np.asarray(numbers, dtype=np.int64)), "node")

    return replace(
        stated,
        properties=tuple(
            replace(
                one,
                thickness=None if one.thickness is None else one.thickness * scale,
                layers=tuple(replace(layer, thickness=scale * layer.thickness) for layer in one.layers),
            )
            for one in stated.properties
        ),
        masses=tuple(
            replace(
                one,
                node=int(of(one.node)[0]),
                offset=(scale * one.offset[0], scale * one.offset[1], scale * one.offset[2]),
                inertia=tuple(scale**2 * x for x in one.inertia),
            )
            for one in stated.masses
        ),
        links=tuple(replace(one, node=int(of(one.node)[0]), nodes=of(one.nodes)) for one in stated.links),
        holds=tuple(replace(one, nodes=of(one.nodes)) for one in stated.holds),
        spread=tuple(replace(one, amount=one.amount / scale ** _LENGTHS[one.per]) for one in stated.spread),
    )
