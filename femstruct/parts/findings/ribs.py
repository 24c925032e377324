"""Lines of bars that run along a plate, and the strip of plate that belongs to each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats
from femstruct.model.grid.geometry import distance_to_rectangle, to_rectangle
from femstruct.model.model import Model
from femstruct.model.structure import Joint
from femstruct.parts.of_frames.frame_mesh import FrameMesh, frames_of
from femstruct.parts.of_plates.plate_mesh import PlateMesh

_TOUCHING = 1e-6  # of the plate's longer side


@dataclass(frozen=True, eq=False)
class RibLine:
    """Bars of a frame that lie on one straight line in a plate.

    along [2] : its direction in the plate's coordinates, across : where it is across that [m]. arm : from the
    mid-surface to the bars, along the normal [m]. spacing : least distance of its nodes, length : of all of it [m].
    axes [3, 3] : of its first bar.
    """

    frame: FrameMesh
    joint: Joint
    along: Floats
    across: float
    arm: float
    spacing: float
    length: float
    axes: Floats


def rib_lines(plate: PlateMesh, joint: Joint, model: Model) -> list[RibLine]:
    """The straight lines of bars that a joint fastens to a plate along it."""
    names = {joint.a, joint.b}
    others = [frame for frame in frames_of(model) if frame.name in names]
    if plate.part.name not in names or not others:
        return []
    frame, size = others[0], plate.part.size
    ends = to_rectangle(plate.part, plate.axes, model.mesh.points[frame.bars[:, :2]])
    inside = (distance_to_rectangle(ends, size) <= _TOUCHING * max(size)).all(axis=1)
    steps = ends[:, 1, :2] - ends[:, 0, :2]
    spacing = np.linalg.norm(steps, axis=1)
    arms = (frame.arms[:, :2] @ plate.axes[2]).mean(axis=1)
    groups: dict[tuple[int, ...], list[int]] = {}
    for bar in np.flatnonzero(inside & (spacing > _TOUCHING * max(size))):
        along = steps[bar] / spacing[bar]
        along = along if (along > -1e-9).all() or along[0] > 1e-9 else -along
        across = float(along[0] * ends[bar, 0, 1] - along[1] * ends[bar, 0, 0])
        key = (*np.round(1e4 * along).astype(int), round(1e4 * across / max(size)))
        groups.setdefault(tuple(int(one) for one in key), []).append(int(bar))
    lines = []
    for bars in groups.values():
        first = bars[0]
        along = steps[first] / spacing[first]
        along = along if (along > -1e-9).all() or along[0] > 1e-9 else -along
        across = float(along[0] * ends[first, 0, 1] - along[1] * ends[first, 0, 0])
        arm = float(arms[bars][np.argmax(np.abs(arms[bars]))])
        step = spacing[bars]
        lines.append(RibLine(frame, joint, along, across, arm, float(step.min()), float(step.sum()), frame.axes[first]))
    return lines


def strip_width(plate: PlateMesh, line: RibLine, others: list[RibLine]) -> float:
    """Width of the plate that belongs to a rib: half way to the next ones beside it, or to the edges [m]."""
    corners = np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) * np.asarray(plate.part.size)
    edges = line.along[0] * corners[:, 1] - line.along[1] * corners[:, 0]
    beside = [other.across for other in others if abs(other.along @ line.along) > 1.0 - 1e-6]
    tiny = 1e-6 * float(np.ptp(edges))
    below = [(line.across + one) / 2.0 for one in beside if one < line.across - tiny]
    above = [(line.across + one) / 2.0 for one in beside if one > line.across + tiny]
    return float(min(above, default=edges.max()) - max(below, default=edges.min()))


def percent(share: float) -> str:
    """A share for a message, in two digits.

    >>> percent(0.0123), percent(2.5)
    ('1.2 %', '250 %')
    """
    return f"{100.0 * share:.2g} %" if share < 0.995 else f"{100.0 * share:.0f} %"
