"""Raw degrees of freedom, before ties: what each node and plate carries, and the components it makes of them.

A node of a plate has w, the two rotations about the plate's own axes and, for bfs16, the twist. In its own plane a
plate is rigid: u, v and the rotation about the normal of its centroid belong to the whole plate. A node of a frame has
its six global components, and so has the one of a block.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import COMPONENTS, N_COMPONENTS, TWIST
from femstruct.elements.plate import dofs_per_node
from femstruct.model.model import Model, PlateMesh

_OUT_OF_PLANE = ("deflection", "rotation about x", "rotation about y", "twist")
_IN_PLANE = ("shift along x", "shift along y", "rotation about the normal")


@dataclass(frozen=True, eq=False)
class RawDofs:
    """Numbers of the raw degrees of freedom.

    count : how many. of_nodes : by part [n_nodes of the part, DOFs per node]. in_plane : by plate [3].
    output [n_nodes * 7, count] : nodal components from raw degrees of freedom.
    """

    count: int
    of_nodes: Mapping[str, Integers]
    in_plane: Mapping[str, Integers]
    output: csr_array


def number_dofs(model: Model) -> RawDofs:
    """Numbers for all raw degrees of freedom of a model, and the map to nodal components."""
    of_nodes: dict[str, Integers] = {}
    in_plane: dict[str, Integers] = {}
    rows: list[Integers] = []
    columns: list[Integers] = []
    values: list[Floats] = []
    count = 0

    def add(row: Integers, column: Integers, value: Floats | float) -> None:
        shape = np.broadcast_shapes(np.shape(row), np.shape(column), np.shape(value))
        for store, entries in ((rows, row), (columns, column), (values, value)):
            store.append(np.broadcast_to(entries, shape).ravel())

    for name, nodes in model.mesh.nodes.items():
        base = nodes * N_COMPONENTS
        per_node = dofs_per_node(model.plates[name].part.element) if name in model.plates else 6
        dofs = count + np.arange(len(nodes) * per_node).reshape(-1, per_node)
        of_nodes[name] = dofs
        count += dofs.size
        if name not in model.plates:
            add(base[:, None] + np.arange(6), dofs, 1.0)
            continue
        plate = model.plates[name]
        in_plane[name] = count + np.arange(3)
        count += 3
        axes, x, y = plate.axes, *_from_centroid(plate)
        u, v, turn = in_plane[name]
        axis = np.arange(3)
        move = base[:, None] + axis
        add(move, dofs[:, :1], axes[2])
        add(move, u, axes[0])
        add(move, v, axes[1])
        add(move, turn, np.outer(x, axes[1]) - np.outer(y, axes[0]))
        add(move + 3, dofs[:, 1:2], axes[0])
        add(move + 3, dofs[:, 2:3], axes[1])
        add(move + 3, turn, axes[2])
        if per_node > 3:
            add(base + TWIST, dofs[:, 3], 1.0)
    entries = np.concatenate(values)
    used = entries != 0.0
    at = np.concatenate(rows)[used], np.concatenate(columns)[used]
    output = csr_array((entries[used], at), shape=(model.mesh.n_nodes * N_COMPONENTS, count))
    return RawDofs(count, of_nodes, in_plane, output)


def rigid_translations(model: Model, dofs: RawDofs) -> Floats:
    """Raw degrees of freedom of unit translations along x, y, z [n_raw, 3]."""
    shapes = np.zeros((dofs.count, 3))
    for name, numbers in dofs.of_nodes.items():
        if name in model.plates:
            axes = model.plates[name].axes
            shapes[numbers[:, 0]] = axes[2]
            shapes[dofs.in_plane[name][:2]] = axes[:2]
        else:
            shapes[numbers[:, :3]] = np.eye(3)
    return shapes


class DofLabels(Sequence[str]):
    """Names of degrees of freedom for messages, made when asked for: "floor node 12 (0.1, 0.2, 0) deflection"."""

    def __init__(self, model: Model, dofs: RawDofs, kept: Integers) -> None:
        self._model, self._dofs, self._kept = model, dofs, kept

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
        for name, numbers in self._dofs.in_plane.items():
            if raw in numbers:
                return f"{name} {_IN_PLANE[raw - int(numbers[0])]}, in its plane"
        for name, numbers in self._dofs.of_nodes.items():
            first = int(numbers[0, 0])
            if first <= raw < first + numbers.size:
                local, component = divmod(raw - first, numbers.shape[1])
                node = int(self._model.mesh.nodes[name][local])
                place = ", ".join(f"{value:.6g}" for value in self._model.mesh.points[node])
                words = _OUT_OF_PLANE if name in self._model.plates else COMPONENTS
                return f"{name} node {node} ({place}) {words[component]}"
        raise IndexError(raw)


def _from_centroid(plate: PlateMesh) -> tuple[Floats, Floats]:
    x, y = np.meshgrid(plate.x - plate.centroid[0], plate.y - plate.centroid[1], indexing="ij")
    return x.ravel(), y.ravel()
