"""Raw degrees of freedom, before ties: those of all parts, one part after the other, and the components they make."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.model.meshed import OwnDofs
from femstruct.model.model import Model


@dataclass(frozen=True, eq=False)
class RawDofs:
    """Numbers of the raw degrees of freedom.

    count : how many. parts : first number and degrees of freedom, by part. output [n_nodes * 7, count] : nodal
    components from raw degrees of freedom. translations [count, 3] : unit translations along x, y, z.
    """

    count: int
    parts: Mapping[str, tuple[int, OwnDofs]]
    output: csr_array
    translations: Floats

    def placed(self, name: str, matrix: csr_array) -> csr_array:
        """A matrix on the degrees of freedom of one part [n, n] among all of them [count, count]."""
        first, own = self.parts[name]
        before, after = np.zeros(first), np.full(self.count - first - own.count, matrix.nnz)
        indptr = np.concatenate([before, matrix.indptr, after]).astype(matrix.indptr.dtype)
        return csr_array((matrix.data, matrix.indices + matrix.indices.dtype.type(first), indptr), (self.count,) * 2)


def number_dofs(model: Model) -> RawDofs:
    """Numbers for all raw degrees of freedom of a model, and the map to nodal components."""
    parts: dict[str, tuple[int, OwnDofs]] = {}
    rows: list[Integers] = []
    columns: list[Integers] = []
    values: list[Floats] = []
    count = 0
    for name, part in model.parts.items():
        own = part.dofs()
        used = own.values != 0.0
        rows.append(own.rows[used] + part.first * N_COMPONENTS)
        columns.append(own.columns[used] + count)
        values.append(own.values[used])
        parts[name] = count, own
        count += own.count
    at = np.concatenate(rows), np.concatenate(columns)
    output = csr_array((np.concatenate(values), at), shape=(model.mesh.n_nodes * N_COMPONENTS, count))
    return RawDofs(count, parts, output, np.concatenate([own.translations for _, own in parts.values()]))


class DofLabels(Sequence[str]):
    """Names of degrees of freedom for messages, made when asked for: "floor node 12 (0.1, 0.2, 0) deflection"."""

    def __init__(self, model: Model, dofs: RawDofs, kept: Integers) -> None:
        self._model, self._kept = model, kept
        # Not the maps to nodal components, which take as much memory as K.
        self._parts = {name: (first, own.count, own.labels, own.extra) for name, (first, own) in dofs.parts.items()}

    def __len__(self) -> int:
        return len(self._kept)

    def __iter__(self) -> Iterator[str]:
        return (self._label(int(raw)) for raw in self._kept)

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[str, ...]: ...
    def __getitem__(self, index: int | slice) -> str | tuple[str, ...]:
        if isinstance(index, slice):
            return tuple(self._label(int(raw)) for raw in self._kept[index])
        return self._label(int(self._kept[index]))

    def _label(self, raw: int) -> str:
        for name, (first, count, labels, extra) in self._parts.items():
            if first <= raw < first + count:
                at_nodes = count - len(extra)
                if raw - first >= at_nodes:
                    return f"{name} {extra[raw - first - at_nodes]}"
                node, component = divmod(raw - first, len(labels))
                part = self._model.parts[name]
                place = ", ".join(f"{value:.6g}" for value in part.places[node])
                return f"{name} node {part.first + node} ({place}) {labels[component]}"
        raise IndexError(raw)
