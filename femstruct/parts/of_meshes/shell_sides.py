"""Sides of a shell: which way its surfaces face."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.model.imported.facing import faces_towards, outwards
from femstruct.model.imported.flat_cells import FlatCells
from femstruct.model.region import Facing, Side
from femstruct.parts.of_meshes.cells_mesh import CLOSED


def signs_of_side(where: str, name: str, cells: FlatCells, chosen: Integers, side: Facing) -> Floats:
    """1 or -1 for each cell [q + t], its normal out of the named side or into it; 0 for those that are not chosen.

    Patch by patch, since where three cells meet at an edge no patch says how the next one is turned. Above and below
    are told as for a plate; where neither side is up, above is that of the cells' own normals.

    where, name : for messages. Raises InputError for a closed patch, whose normals add to nothing, and for one sided
    as a Moebius strip.
    """
    vectors, areas = cells.normals * cells.areas[:, None], cells.areas
    signs = np.zeros(len(areas))
    for patch in np.unique(cells.patches[chosen]):
        own = chosen[cells.patches[chosen] == patch]
        whole = vectors[own].sum(axis=0)
        if np.linalg.norm(whole) < CLOSED * areas[own].sum():
            got = f"all of {name}, which is closed"
            raise InputError(where, got=got, expected="a side of it", do="name a set, or a box")
        if not faces_towards(whole, side):
            got, expected = f"the side of {name} towards {side}, to which it is not turned", "within 45 degrees of it"
            raise InputError(where.replace(".region", ".side"), got=got, expected=expected)
        signs[own] = np.sign(outwards(whole, side) @ whole)
    if not cells.two_sided:
        raise InputError(where, got=f"a side of {name}, which has only one, as a Moebius strip", expected="two")
    return signs


def mean_normal(cells: FlatCells, nodes: Integers, side: Side) -> Floats:
    """Unit normal [3] out of the named side of the cells around nodes, counted in the part, by their areas."""
    touching = np.isin(cells.corners, nodes).any(axis=1)
    return outwards((cells.normals * cells.areas[:, None])[touching].sum(axis=0), side)
