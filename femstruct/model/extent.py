"""How large a structure is, and whether its parts have a size at all."""

from __future__ import annotations

from itertools import product

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.model.geometry import plate_axes
from femstruct.model.parts import Block, Frame, Plate, Structure


def extent(structure: Structure) -> float:
    """Largest side of the box around a structure [m]."""
    corners: list[Floats] = []
    for part in structure.parts:
        if isinstance(part, Plate):
            _check_plate(part)
            axes = plate_axes(part)
            corners += [
                np.asarray(part.origin) + i * part.size[0] * axes[0] + j * part.size[1] * axes[1]
                for i, j in product((0.0, 1.0), repeat=2)
            ]
        elif isinstance(part, Frame):
            corners += [np.asarray(point, dtype=np.float64) for line in part.lines for point in line]
        elif isinstance(part, Block):
            _check_block(part)
            corners += [np.asarray(part.origin, dtype=np.float64), np.add(part.origin, part.size)]
    if not corners:
        raise InputError("parts", got="no plate, frame or block", expected="at least one")
    return float(np.ptp(np.stack(corners), axis=0).max())


def _check_plate(plate: Plate) -> None:
    for name, value in (("thickness", plate.thickness), ("size", min(plate.size))):
        if not value > 0:
            raise InputError(f"parts.{plate.name}.{name}", got=f"{value:g} m", expected="a positive length")


def _check_block(block: Block) -> None:
    """Raise InputError for sides, a mass or moments of inertia that are not positive."""
    where = f"parts.{block.name}"
    for key, values in (("mass", (block.mass,)), ("size", block.size), ("inertia", block.moments)):
        if not min(values) > 0:
            raise InputError(f"{where}.{key}", got=f"{min(values):g}", expected="positive values")
