"""Springs of joints along edges and faces, which are as many as the mesh has nodes there.

A joint with a stiffness has one spring at every pair of joined nodes. At the ends of bars that is what is meant. Where
neighbouring nodes are joined, as along an edge or over a face, a finer mesh has more springs, and the joint is stiffer.
"""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import Finding
from femstruct.model.meshed import Meshed
from femstruct.model.model import Model


def joint_spring_findings(model: Model) -> tuple[Finding, ...]:
    """Joints with a stiffness that join neighbouring nodes of a part: those of one bar, or two corners of one cell."""
    found = []
    for joint in model.structure.joints:
        values = {axis: joint.stiffness[axis] for axis in DIRECTIONS if joint.stiffness.get(axis)}
        springs = [one for one in model.elastics if one.name == joint.name]
        if not values or not springs:
            continue
        joined = np.unique(springs[0].rows.indices // N_COMPONENTS).astype(np.int64)
        parts = [model.parts[name] for name in (joint.a, joint.b)]
        if not all(_neighbours(part, joined) for part in parts if not part.rigid):
            continue
        count = len(springs[0].stiffness) // len(values)
        total = ", ".join(
            f"{axis} {count * value:.4g} {'N/m' if len(axis) == 1 else 'N m/rad'}" for axis, value in values.items()
        )
        found.append(
            Finding(
                "joint-springs-by-node",
                f"{joint.name}: the joint of {joint.a} and {joint.b} has a spring at each of {count} pairs of nodes, "
                f"together {total}. With another mesh it has more or fewer, and another stiffness",
                {"springs": count},
            )
        )
    return tuple(found)


def _neighbours(part: Meshed, joined: Integers) -> bool:
    """Whether two ends of one bar, or two corners of one cell of a part are among nodes."""
    return any(bool((np.isin(cells, joined).sum(axis=1) > 1).any()) for cells in (part.lines, part.quads) if len(cells))
