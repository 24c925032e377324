"""Mode shapes as a VTKHDF group, which ParaView and VTK open."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.files.results_file.datasets import put
from femstruct.modal.basis import ModalBasis
from femstruct.model.model import Model
from femstruct.model.refine import Refined, refined
from femstruct.model.rows import node_rows

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

VERSION: Final = (2, 2)
VTK_VERTEX, VTK_LINE, VTK_QUAD = 1, 3, 9
DIVISIONS: Final = 3


def mode_name(basis: ModalBasis, mode: int) -> str:
    """Name of a mode, counted from 0, by its number counted from 1 and its frequency.

    It sorts in the order of the modes.
    """
    return f"mode {mode + 1:02d} {basis.frequency_hz[mode]:.2f} Hz"


def write_vtkhdf(file: h5py.File, basis: ModalBasis, model: Model | None, *, count: int = 40) -> None:
    """Add the group /VTKHDF: the structure as an unstructured grid, its first `count` modes as vectors at its points.

    Plates are subdivided with their own shape functions and bars with theirs, so a warped mode is smooth; a basis in
    closed form (model None) is its points. The vectors are mass-normalised displacements [1/sqrt(kg)], single
    precision.

    References: VTK File Formats, "VTKHDF File Format", version 2.2, UnstructuredGrid.
    """
    shown = bare(basis) if model is None else refined(model, DIVISIONS)
    target = file.create_group("VTKHDF")
    target.attrs["Version"] = np.array(VERSION, dtype=np.int64)
    kind = b"UnstructuredGrid"
    import h5py

    target.attrs.create("Type", kind, dtype=h5py.string_dtype("ascii", len(kind)))
    target.attrs["description"] = "Mode shapes of the baseline on its subdivided elements"
    _write_cells(target, shown)
    put(target, "NumberOfPoints", np.array([len(shown.points)]), "1", "Number of points", ())
    put(target, "Points", shown.points, "m", "Points at rest", ())
    data = target.create_group("PointData")
    modes = range(min(count, basis.modes.stop))
    moved = shown.displacement(basis.shapes[:, :, : len(modes)])
    for mode in modes:
        values = np.ascontiguousarray(moved[:, :, mode], dtype=np.float32)
        put(data, mode_name(basis, mode), values, "kg^-0.5", "Mass-normalised displacement", ())
    fields = target.create_group("FieldData")
    put(fields, "frequency_hz", basis.frequency_hz[: len(modes)], "Hz", "Natural frequencies of the shown modes", ())
    put(fields, "damping_ratio", basis.damping_ratio[: len(modes)], "1", "Damping ratios of the shown modes", ())


def bare(basis: ModalBasis) -> Refined:
    """The nodes alone, for a basis in closed form, which has no elements."""
    count = len(basis.points)
    translations = np.tile(np.eye(3, N_COMPONENTS), (count, 1))
    return Refined(
        basis.points,
        np.empty((0, 4), dtype=np.int64),
        np.empty((0, 2), dtype=np.int64),
        node_rows(np.repeat(np.arange(count), 3), translations, count),
        ("structure",),
        np.zeros(count, dtype=np.int64),
    )


def _write_cells(target: h5py.Group, shown: Refined) -> None:
    drawn = np.concatenate([shown.quads.ravel(), shown.lines.ravel()])
    lone: Integers = np.setdiff1d(np.arange(len(shown.points)), drawn)
    connectivity = np.concatenate([drawn, lone])
    counts = (len(shown.quads), len(shown.lines), len(lone))
    sizes, types = np.repeat([4, 2, 1], counts), np.repeat([VTK_QUAD, VTK_LINE, VTK_VERTEX], counts)
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    put(target, "Connectivity", connectivity, "1", "Points of the cells", ())
    put(target, "Offsets", offsets, "1", "Where each cell starts", ())
    put(target, "Types", types.astype(np.uint8), "1", "Kinds of cells, VTK's numbers", ())
    put(target, "NumberOfCells", np.array([len(types)]), "1", "Number of cells", ())
    put(target, "NumberOfConnectivityIds", np.array([len(connectivity)]), "1", "Length of Connectivity", ())
    cells = target.create_group("CellData")
    part = shown.part_of_point[connectivity[offsets[:-1]]]
    put(cells, "part", part, "1", f"Part, by number: {', '.join(shown.parts)}", ())
