"""Modes of rooms as files that ParaView opens."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from acoustics.open_air.half_space import HalfSpace
from acoustics.rooms.receiver_grids import mode_shapes, room_grid
from femstruct.files.atomic import replacing
from femstruct.study.study import RoomPlan

COUNT: Final = 20


def write_room_modes(plan: RoomPlan, path: str | Path, count: int = COUNT) -> Path | None:
    """Write the first modes of a room with rigid walls as an unstructured grid of VTK (.vtu), one array a mode.

    Arrays are named as the modes of the structure, "mode 01 23.21 Hz", the uniform mode not counted; pressure, of unit
    mean square over the room. None for a half space, which has no modes.
    """
    import meshio  # type: ignore[import-untyped]

    room = plan.room
    if isinstance(room, HalfSpace):
        return None
    grid = room_grid(room)
    hz, shapes = mode_shapes(room, grid, count)
    names = [f"mode {number:02d} {frequency:.2f} Hz" for number, frequency in enumerate(hz.tolist(), 1)]
    kind = "hexahedron" if grid.cells.shape[1] == 8 else "tetra"
    mesh = meshio.Mesh(
        grid.points.copy(), [(kind, grid.cells)], point_data=dict(zip(names, shapes.T.astype("f4"), strict=True))
    )
    with replacing(path) as temporary:
        mesh.write(temporary, file_format="vtu")
    return Path(path)
