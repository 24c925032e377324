"""How large the cells of a rectangle are: as asked for, within what a machine can hold."""

from __future__ import annotations

from femstruct.errors import InputError
from femstruct.model.region import Pair

MOST_DIVISIONS = 2000  # of a side
MOST_CELLS = 300_000  # 1.6 million of them were killed by a machine of some gigabytes


def cell_sides(where: str, size: Pair, mesh: float | tuple[int, int]) -> Pair:
    """Largest sides of cells along both directions [m]; mesh : a largest side [m], or the least number of divisions.

    Raises InputError for a mesh that is not positive, and for one that fills the memory of most machines: there the
    system kills the run without a word.

    >>> cell_sides("parts.floor.mesh", (4.0, 3.0), (8, 2)), cell_sides("parts.floor.mesh", (4.0, 3.0), 0.5)
    ((0.5, 1.5), (0.5, 0.5))
    """
    along, across = (_cell_side(where, size[direction], mesh, direction) for direction in (0, 1))
    cells = size[0] / along * (size[1] / across)
    if cells > MOST_CELLS * (1.0 + 1e-9):
        side = (size[0] * size[1] / MOST_CELLS) ** 0.5
        raise InputError(
            where, got=f"{cells:.3g} cells", expected=f"at most {MOST_CELLS}", do=f"use cells of {side:.2g} m or more"
        )
    return along, across


def _cell_side(where: str, side: float, mesh: float | tuple[int, int], direction: int) -> float:
    if isinstance(mesh, tuple):
        if not 1 <= mesh[direction] <= MOST_DIVISIONS:
            raise InputError(where, got=f"{mesh[direction]} divisions", expected=f"1 to {MOST_DIVISIONS}")
        return side / mesh[direction]
    if not mesh > 0:
        raise InputError(where, got=f"{mesh:g} m", expected="a positive length")
    if side > MOST_DIVISIONS * mesh * (1.0 + 1e-9):
        raise InputError(
            where,
            got=f"{mesh:g} m, {side / mesh:.3g} divisions of a side of {side:g} m",
            expected=f"at most {MOST_DIVISIONS} divisions",
            do=f"use {side / MOST_DIVISIONS:.2g} m or more",
        )
    return mesh
