"""Ribs beside the plate that they stiffen: how much too stiff they are, since plates are rigid in their own plane.

Two errors, both of the model and not of its mesh alone:

Bending. A rib at e from the mid-surface acts with the plate as a T: its neutral axis lies between both, where their
stretching balances. A plate that cannot stretch keeps it in its mid-surface. Per rib with a strip of plate of width b

    rigid   D b + E I_r + E A_r e^2
    true    D b + E I_r + e^2 E A_r E A_p / (E A_r + E A_p),    A_p = h b

Torsion. Where the plate twists along the rib, the rib's axis moves sideways by e times the twist, and its rotation
about the plate's normal is tied to the plate, which does not turn. So between any two nodes, a distance d apart, the
rib bends sideways as a beam clamped at both ends, which is a torsional stiffness that does not exist:

    12 E I_s e^2 / (d^2 (1 + phi)),    phi = 12 E I_s / (k G A d^2),  0 for bars without shear

It grows as the mesh is refined, up to k G A e^2, without a limit for bars without shear.

Checked against three-dimensional solids: T strips of timber and of concrete and a plate with one rib
(`tests/analytic/test_rigid_in_plane.py`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.model.grid.geometry import distance_to_rectangle, to_rectangle
from femstruct.model.grid.layers import layer_of
from femstruct.model.model import Model
from femstruct.model.structure import Joint
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import FrameMesh, frames_of
from femstruct.parts.plate import Plate, PlateMesh, rigid_plates

NOTABLE, SEVERE = 1e-3, 1e-2  # of a frequency
_TOUCHING = 1e-6  # of the plate's longer side


@dataclass(frozen=True)
class RibError:
    """How much too stiff a rib is with its plate: ratios of stiffness; arm [m], spacing of its nodes [m].

    bending : with a plate that cannot stretch over that with one that can. torsion : with what it is tied by over that
    without.
    """

    frame: str
    plate: str
    arm: float
    spacing: float
    bending: float
    torsion: float

    @property
    def excess(self) -> float:
        """Largest relative excess of a frequency [1]: the root of the larger ratio, less one."""
        return float(np.sqrt(max(self.bending, self.torsion)) - 1.0)


@dataclass(frozen=True, eq=False)
class _Line:
    """Bars of a frame that lie on one straight line in a plate: where across it [m], along what."""

    frame: FrameMesh
    joint: Joint
    along: Floats
    across: float
    arm: float
    spacing: float
    length: float
    axes: Floats


def rib_errors(model: Model) -> tuple[RibError, ...]:
    """The errors of every line of bars that are joined to a plate through arms out of its plane."""
    found = []
    for plate in rigid_plates(model).values():
        lines = [line for joint in model.structure.joints for line in _lines_on(plate, joint, model)]
        found += [_error(plate, line, lines) for line in lines if abs(line.arm) > 0.0]
    return tuple(found)


def eccentric_findings(model: Model) -> tuple[Finding, ...]:
    """Ribs and layers that a plate rigid in its own plane makes too stiff, the worst line of each pair of parts."""
    worst: dict[tuple[str, str], RibError] = {}
    for error in rib_errors(model):
        key = (error.frame, error.plate)
        if key not in worst or error.excess > worst[key].excess:
            worst[key] = error
    told = [_told(error) for error in worst.values() if error.excess > NOTABLE]
    plates = {name: plate.part for name, plate in rigid_plates(model).items()}
    for part in model.structure.parts:
        if isinstance(part, Foundation) and {part.on, part.to} <= plates.keys():
            told += _layer(part, plates[part.on], plates[str(part.to)])
    return tuple(told)


def _told(error: RibError) -> Finding:
    bends, twists = (_percent(np.sqrt(ratio) - 1.0) for ratio in (error.bending, error.torsion))
    return Finding(
        "eccentric-bars",
        f"{error.frame} on {error.plate}: the bars are {1e3 * error.arm:.3g} mm from the mid-surface of the plate, "
        "which "
        f"cannot stretch here. A rib with its strip of plate is {error.bending:.3g} times too stiff in bending "
        f"(frequencies up to {bends} too high). It is {error.torsion:.3g} times too stiff in torsion (up to "
        f"{twists} too "
        f"high) with nodes {1e3 * error.spacing:.3g} mm apart, and more with a finer mesh. Bars without 'offsets' have "
        "neither error, but they lack the stiffness of the offset",
        {
            "bending_ratio": error.bending,
            "torsion_ratio": error.torsion,
            "frequency_excess": error.excess,
            "arm_m": error.arm,
            "spacing_m": error.spacing,
        },
        severe=error.excess > SEVERE,
    )


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share < 0.995 else f"{100.0 * share:.0f} %"


def _lines_on(plate: PlateMesh, joint: Joint, model: Model) -> list[_Line]:
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
        lines.append(_Line(frame, joint, along, across, arm, float(step.min()), float(step.sum()), frame.axes[first]))
    return lines


def _error(plate: PlateMesh, line: _Line, others: list[_Line]) -> RibError:
    part, section, metal = plate.part, line.frame.part.section, line.frame.part.material
    base, h = part.material, part.thickness
    b, e = _strip(plate, line, others), abs(line.arm)
    normal = plate.axes[2]
    sideways = np.cross(normal, line.along @ plate.axes[:2])
    upright = section.Iy * (line.axes[2] @ normal) ** 2 + section.Iz * (line.axes[1] @ normal) ** 2
    lateral = section.Iy * (line.axes[2] @ sideways) ** 2 + section.Iz * (line.axes[1] @ sideways) ** 2
    shear = section.A * (section.kz * (line.axes[2] @ sideways) ** 2 + section.ky * (line.axes[1] @ sideways) ** 2)
    alone = base.E * h**3 * b / (12.0 * (1.0 - base.nu**2)) + metal.E * upright
    slip = _slip(plate, line)
    rigid = alone + e**2 / (1.0 / (metal.E * section.A) + slip)
    true = alone + e**2 / (1.0 / (metal.E * section.A) + 1.0 / (base.E * h * b) + slip)
    twist = base.G * h**3 * b / 3.0 + metal.G * section.J
    false = 0.0
    if line.joint.kind == "rigid" and not set(line.joint.stiffness) & {"rx", "ry", "rz"}:
        clamped = 12.0 * metal.E * lateral / line.spacing**2
        phi = 0.0 if line.frame.part.element == "euler" else clamped / (metal.G * shear)
        false = clamped * e**2 / (1.0 + phi)
    names = line.frame.part.name, part.name
    return RibError(*names, e, line.spacing, float(rigid / true), float(1.0 + false / twist))


def _slip(plate: PlateMesh, line: _Line) -> float:
    """1 / (E A) of springs between rib and plate along it, for one half wave over its length; 0 for a rigid joint."""
    along = line.along @ plate.axes[:2]
    for axis, direction in enumerate(("x", "y", "z")):
        if direction in line.joint.stiffness and abs(along[axis]) > 0.7:
            stiffness = line.joint.stiffness[direction]
            return float(np.pi**2 * line.spacing / (stiffness * line.length**2)) if stiffness > 0.0 else np.inf
    return 0.0


def _strip(plate: PlateMesh, line: _Line, others: list[_Line]) -> float:
    """Width of the plate that belongs to a rib: half way to the next ones beside it, or to the edges [m]."""
    corners = np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) * np.asarray(plate.part.size)
    edges = line.along[0] * corners[:, 1] - line.along[1] * corners[:, 0]
    beside = [other.across for other in others if abs(other.along @ line.along) > 1.0 - 1e-6]
    tiny = 1e-6 * float(np.ptp(edges))
    below = [(line.across + one) / 2.0 for one in beside if one < line.across - tiny]
    above = [(line.across + one) / 2.0 for one in beside if one > line.across + tiny]
    return float(min(above, default=edges.max()) - max(below, default=edges.min()))


def _layer(part: Foundation, first: Plate, second: Plate) -> list[Finding]:
    """A layer so stiff in shear that two plates would stretch before it yields: they act as one section.

    Per width and for one half wave over the longer side, S = k_s (L / pi)^2 is in series with E h of both plates.
    """
    if part.shear <= 0.0:
        return []
    layer = layer_of(part, {one.name: one.body() for one in (first, second)}, 1e-9 * max(*first.size, *second.size))
    apart = float(abs((np.asarray(second.origin) - np.asarray(first.origin)) @ layer.axes[2]))
    length = max(layer.box[1] - layer.box[0], layer.box[3] - layer.box[2])
    alone = sum(one.material.E * one.thickness**3 / (12.0 * (1.0 - one.material.nu**2)) for one in (first, second))
    slide = 1.0 / (part.shear * (length / np.pi) ** 2)
    stretch = sum(1.0 / (one.material.E * one.thickness) for one in (first, second))
    ratio = (alone + apart**2 / slide) / (alone + apart**2 / (slide + stretch))
    excess = float(np.sqrt(ratio) - 1.0)
    if excess <= NOTABLE:
        return []
    return [
        Finding(
            "stiff-layer",
            f"{part.name} is so stiff in shear that {first.name} and {second.name} would stretch in their planes, "
            "which "
            f"plates cannot here. Together they are {ratio:.3g} times too stiff in bending: frequencies up to "
            f"{_percent(excess)} too high",
            {"bending_ratio": float(ratio), "frequency_excess": excess},
            severe=excess > SEVERE,
        )
    ]
