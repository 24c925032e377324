"""The scale model of floor, frame and slab against an independent run of the same input.

That run: its own bfs16 and hermite12 plates and Euler bars, its own mesh of the slab; four digits are given.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh

from femstruct.assembly.matrices import assemble
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.regions import Region
from femstruct.model.sections import rectangle
from femstruct.model.structure import Joint, Structure
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.plate import Plate


def floor_frame_slab(kind: Literal["hermite12", "bfs16"], bars: Literal["euler", "timoshenko"] = "euler") -> Structure:
    acrylic = Material("acrylic", 5.9e9, 0.35, 1171.875)
    steel = Material("steel", 206e9, 0.3, 7850.0)
    concrete = Material("concrete", 22.25e9, 0.1, 2400.0)
    bar, post = rectangle("bar", 7.216e-3, 6.405e-3), rectangle("post", 15.73e-3, 15.73e-3)
    around = [(-0.2, -0.16), (0, -0.16), (0.2, -0.16), (0.2, 0), (0.2, 0.16), (0, 0.16), (-0.2, 0.16), (-0.2, 0)]
    parts = (
        Plate(
            "floor", acrylic, 0.005, (-0.2, -0.16, 0.08), (0.4, 0.32), (16, 16), kind, in_plane="rigid"
        ),  # as that run has them
        Plate("slab", concrete, 0.03, (-0.33, -0.285, 0.0), (0.66, 0.57), 0.03, kind, in_plane="rigid"),
        Frame("edge", steel, bar, (tuple((x, y, 0.08) for x, y in [*around, around[0]]),), 0.02, element=bars),
        Frame("posts", steel, post, tuple(((x, y, 0.0), (x, y, 0.08)) for x, y in around), 0.04, element=bars),
        Foundation("foam", "slab", Region("rim", (0.58, 0.47)), 2.21e5, 7.3e4),
    )
    joints = (
        Joint("edge on floor", "edge", "floor"),
        Joint("posts on floor", "posts", "floor"),
        Joint("posts on slab", "posts", "slab"),
    )
    return Structure("floor, frame, slab", parts, joints)


@pytest.mark.parametrize(
    ("kind", "expected", "below_3_khz"),
    [
        ("hermite12", {4: 19.90, 7: 152.7, 10: 272.8, 12: 345.5, 15: 452.6}, 91),
        ("bfs16", {4: 19.90, 7: 150.9, 10: 272.6, 12: 345.3, 15: 448.3}, 93),
    ],
)
def test_floor_frame_slab(kind: Literal["hermite12", "bfs16"], expected: dict[int, float], below_3_khz: int) -> None:
    model = mesh_structure(floor_frame_slab(kind))
    assembly = assemble(model)
    start = np.ones(assembly.K.shape[0])
    values = eigsh(assembly.K, 100, assembly.M, sigma=-1e3, return_eigenvectors=False, v0=start)
    found = np.sqrt(np.sort(values)) / (2 * np.pi)
    # Four digits are given, and the two meshes of the slab differ.
    assert {mode: found[mode - 1] for mode in expected} == pytest.approx(expected, rel=4e-4)
    assert np.count_nonzero(found < 3000.0) == below_3_khz
    assert assembly.total_mass == pytest.approx(29.60196, rel=1e-6)  # digits
