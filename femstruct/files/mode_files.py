"""Modes of structures and of rooms as files that ParaView, PyVista and meshio open."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from femstruct.files.datasets import DIVISIONS, mode_name, nodes_alone
from femstruct.files.writing import replacing
from femstruct.modal.basis import ModalBasis
from femstruct.model.model import Model, refine_model
from femstruct.study.asked import RoomPlan

# ----------------------------------------------------------------------------------------------------------------------
# Mode shapes as an unstructured grid of VTK (.vtu), for ParaView, PyVista and meshio.
# ----------------------------------------------------------------------------------------------------------------------

MODES: Final = 40


def write_vtu(basis: ModalBasis, model: Model | None, path: str | Path, count: int = MODES) -> Path:
    """Write the first modes of a structure as vectors at the points of its subdivided elements, one array a mode.

    Arrays are named as "mode 04 19.93 Hz": mass-normalised displacements [kg^-0.5], single precision. The cells have
    the number of their part. A basis in closed form (model None) is its points.
    """
    import meshio  # type: ignore[import-untyped]

    shown = nodes_alone(basis) if model is None else refine_model(model, DIVISIONS)
    modes = range(min(count, basis.modes.stop))
    moved = shown.displacement(basis.shapes[:, :, : len(modes)])
    lone = np.setdiff1d(np.arange(len(shown.points)), np.concatenate([shown.quads.ravel(), shown.lines.ravel()]))
    kinds = {"quad": shown.quads, "line": shown.lines, "vertex": lone[:, None]}
    cells = [(kind, some) for kind, some in kinds.items() if len(some)]
    mesh = meshio.Mesh(
        shown.points.copy(),
        cells,
        point_data={mode_name(basis, mode): np.array(moved[:, :, mode], dtype=np.float32) for mode in modes},
        cell_data={"part": [shown.part_of_point[some[:, 0]] for _, some in cells]},
    )
    with replacing(path) as temporary:
        mesh.write(temporary, file_format="vtu")
    return Path(path)


# ----------------------------------------------------------------------------------------------------------------------
# Modes of rooms as files that ParaView opens.
# ----------------------------------------------------------------------------------------------------------------------

COUNT: Final = 20


def write_room_modes(plan: RoomPlan, path: str | Path, count: int = COUNT) -> Path | None:
    """Write the first modes of a room with rigid walls as an unstructured grid of VTK (.vtu), one array a mode.

    Arrays are named as the modes of the structure, "mode 01 23.21 Hz", the uniform mode not counted; pressure, of unit
    mean square over the room. None for a room that has no cells to draw, as a half space.
    """
    import meshio

    if not plan.room.bounded:
        return None
    grid = plan.room.grid()
    hz, shapes = plan.room.mode_shapes(grid.points, count)
    names = [f"mode {number:02d} {frequency:.2f} Hz" for number, frequency in enumerate(hz.tolist(), 1)]
    kind = "hexahedron" if grid.cells.shape[1] == 8 else "tetra"
    mesh = meshio.Mesh(
        grid.points.copy(), [(kind, grid.cells)], point_data=dict(zip(names, shapes.T.astype("f4"), strict=True))
    )
    with replacing(path) as temporary:
        mesh.write(temporary, file_format="vtu")
    return Path(path)
