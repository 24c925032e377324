"""Lines of bars that run along a plate, and the strip of plate that belongs to each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats
from femstruct.model.grid.geometry import distance_to_rectangle, to_rectangle
from femstruct.model.materials.lay_up import section_of
from femstruct.model.materials.plate_section import PlateSection
from femstruct.model.model import Model
from femstruct.model.region import Pair, Vector
from femstruct.model.structure import Joint
from femstruct.parts.of_frames.frame_mesh import FrameMesh, frames_of
from femstruct.parts.of_meshes.shell_mesh import ShellMesh
from femstruct.parts.of_plates.plate_mesh import PlateMesh, plates_of

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


@dataclass(frozen=True, eq=False)
class Face:
    """A flat part that ribs can be beside: a plate, or the rectangle round a slab or a flat shell.

    origin : a corner of its mid-surface [m]; size : along its x and y [m]; axes [3, 3] : rows are its x, y and normal.
    section : of the thickest of its cells.
    """

    name: str
    origin: Vector
    size: Pair
    axes: Floats
    section: PlateSection

    @property
    def normal(self) -> Vector:
        """Unit vector."""
        x, y, z = self.axes[2].tolist()
        return x, y, z

    @property
    def x_direction(self) -> Vector:
        """Unit vector."""
        x, y, z = self.axes[0].tolist()
        return x, y, z


def face_of(plate: PlateMesh) -> Face:
    """A plate as ribs see it."""
    return Face(plate.name, plate.part.origin, plate.part.size, plate.axes, plate.part.section)


def stretching_faces(model: Model) -> list[Face]:
    """Flat parts that stretch in their planes: plates that do, slabs, and flat shells."""
    faces = [face_of(plate) for plate in plates_of(model) if plate.stretches]
    for part in model.parts.values():
        axes = part.own_axes if isinstance(part, ShellMesh) else None
        if isinstance(part, ShellMesh) and axes is not None:
            local = part.places @ axes.T
            low = local.min(axis=0)
            x, y, z = (low @ axes).tolist()
            a, b, _ = np.ptp(local, axis=0).tolist()
            section = section_of(part.part.material, float(part.thickness.max()))
            faces.append(Face(part.name, (x, y, z), (a, b), axes, section))
    return faces


def rib_lines(plate: Face, joint: Joint, model: Model) -> list[RibLine]:
    """The straight lines of bars that a joint fastens to a plate along it."""
    names = {joint.a, joint.b}
    others = [frame for frame in frames_of(model) if frame.name in names]
    if plate.name not in names or not others:
        return []
    frame, size = others[0], plate.size
    ends = to_rectangle(plate, plate.axes, model.mesh.points[frame.bars[:, :2]])
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


def edges_across(plate: Face, line: RibLine) -> tuple[float, float]:
    """Where the plate begins and ends across a rib [m], as `RibLine.across` counts."""
    corners = np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) * np.asarray(plate.size)
    edges = line.along[0] * corners[:, 1] - line.along[1] * corners[:, 0]
    return float(edges.min()), float(edges.max())


def strip_width(plate: Face, line: RibLine, others: list[RibLine]) -> float:
    """Width of the plate that belongs to a rib: half way to the next ones beside it, or to the edges [m]."""
    low, high = edges_across(plate, line)
    beside = [other.across for other in others if abs(other.along @ line.along) > 1.0 - 1e-6]
    tiny = 1e-6 * (high - low)
    below = [(line.across + one) / 2.0 for one in beside if one < line.across - tiny]
    above = [(line.across + one) / 2.0 for one in beside if one > line.across + tiny]
    return min(above, default=high) - max(below, default=low)


def percent(share: float) -> str:
    """A share for a message, in two digits.

    >>> percent(0.0123), percent(2.5)
    ('1.2 %', '250 %')
    """
    return f"{100.0 * share:.2g} %" if share < 0.995 else f"{100.0 * share:.0f} %"
