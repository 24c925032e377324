"""Modes of rooms as files that ParaView opens."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from femstruct.files.atomic import replacing
from femstruct.study.asked import RoomPlan

COUNT: Final = 20


def write_room_modes(plan: RoomPlan, path: str | Path, count: int = COUNT) -> Path | None:
    """Write the first modes of a room with rigid walls as an unstructured grid of VTK (.vtu), one array a mode.

    Arrays are named as the modes of the structure, "mode 01 23.21 Hz", the uniform mode not counted; pressure, of unit
    mean square over the room. None for a room that has no cells to draw, as a half space.
    """
    import meshio  # type: ignore[import-untyped]

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
