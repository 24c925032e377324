"""Where the stresses of a shell are largest: at its faces and those of its layers, node by node."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from femstruct.arrays import Floats
from femstruct.model.imported.flat_cells import FlatCells
from femstruct.model.imported.shell_cells import Sections
from femstruct.model.imported.shell_stresses import face_stresses
from femstruct.model.materials.lay_up import LayUp, stresses_of_resultants
from femstruct.model.probe import StressPlaces

if TYPE_CHECKING:
    from femstruct.parts.shell import Shell


def stresses_on_faces(
    shell: Shell, cells: FlatCells, thickness: Floats, sections: Sections, numbers: tuple[int, int]
) -> StressPlaces:
    """At both faces of every node, and of every layer, the front being that of the normals; the shear stress across the
    thickness is left out. Along the directions of the material, or of a cell at each place.

    thickness [q + t] : of the cells [m]; sections : their rigidities. numbers : of the first node, and of all nodes.
    Raises InputError for smeared ribs, whose stresses are unknown.
    """
    different, which = np.unique(thickness, return_inverse=True)
    each = [stresses_of_resultants(shell.material, float(t)) for t in different]
    kinds, of_faces = which.ravel(), np.stack([faces for _, faces in each])
    found = face_stresses(cells, sections, (kinds, of_faces), shell.shift, shell.x_direction, numbers)
    heights = np.stack([heights for heights, _ in each])[kinds[found.cells]] + shell.shift
    count = heights.shape[1]
    meets = (count * found.places[:, None] + np.arange(count)).ravel()
    places = cells.points[found.nodes][:, None] + heights[..., None] * found.axes[:, None, 2]
    words = tuple(f"{side} layer {n + 1}" for n in range(count // 2) for side in ("back", "front"))
    sides = ("front", "back") if count == 2 and not isinstance(shell.material, LayUp) else words
    axes = np.repeat(found.axes, count, axis=0)
    return StressPlaces(places.reshape(-1, 3), ("xx", "yy", "xy"), found.rows, sides, found.of_cells, meets, axes)
