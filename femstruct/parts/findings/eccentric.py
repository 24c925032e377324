"""Ribs beside a plate that is said to be rigid in its own plane: how much too stiff they are.

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

from femstruct.errors import Finding
from femstruct.model.grid.layers import layer_of
from femstruct.model.model import Model
from femstruct.parts.findings.ribs import RibLine, face_of, percent, rib_lines, strip_width
from femstruct.parts.foundation import NOTABLE, Foundation, glue_ratio
from femstruct.parts.of_plates.plate_mesh import PlateMesh, rigid_plates
from femstruct.parts.plate import Plate

SEVERE = 1e-2  # of a frequency


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


def rib_errors(model: Model) -> tuple[RibError, ...]:
    """The errors of every line of bars that are joined to a plate through arms out of its plane."""
    found = []
    for plate in rigid_plates(model).values():
        lines = [line for joint in model.structure.joints for line in rib_lines(face_of(plate), joint, model)]
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
        if isinstance(part, Foundation) and set(part.ends) <= plates.keys():
            told += _layer(part, *(plates[name] for name in part.ends))
    return tuple(told)


def _told(error: RibError) -> Finding:
    bends, twists = (percent(np.sqrt(ratio) - 1.0) for ratio in (error.bending, error.torsion))
    return Finding(
        "eccentric-bars",
        f"{error.frame} on {error.plate}: the bars are {1e3 * error.arm:.3g} mm from the mid-surface of the plate, "
        f"which is rigid in its plane. A rib with its strip of plate is {error.bending:.3g} times too stiff in bending "
        f"(frequencies up to {bends} too high). It is {error.torsion:.3g} times too stiff in torsion (up to {twists} "
        f"too high) with nodes {1e3 * error.spacing:.3g} mm apart, and more with a finer mesh. A plate with 'in_plane: "
        "elastic' has neither error",
        {
            "bending_ratio": error.bending,
            "torsion_ratio": error.torsion,
            "frequency_excess": error.excess,
            "arm_m": error.arm,
            "spacing_m": error.spacing,
        },
        severe=error.excess > SEVERE,
    )


def _error(plate: PlateMesh, line: RibLine, others: list[RibLine]) -> RibError:
    part, (E, G, section) = plate.part, line.frame.part.along
    angle = float(np.arctan2(line.along[1], line.along[0]))
    base = part.section.turned(-angle)  # along the rib
    b, e = strip_width(face_of(plate), line, others), abs(line.arm)
    normal = plate.axes[2]
    sideways = np.cross(normal, line.along @ plate.axes[:2])
    upright = section.Iy * (line.axes[2] @ normal) ** 2 + section.Iz * (line.axes[1] @ normal) ** 2
    lateral = section.Iy * (line.axes[2] @ sideways) ** 2 + section.Iz * (line.axes[1] @ sideways) ** 2
    shear = section.A * (section.kz * (line.axes[2] @ sideways) ** 2 + section.ky * (line.axes[1] @ sideways) ** 2)
    alone = float(base.bending[0, 0]) * b + E * upright
    slip = _slip(plate, line)
    rigid = alone + e**2 / (1.0 / (E * section.A) + slip)
    true = alone + e**2 / (1.0 / (E * section.A) + 1.0 / (base.stretching() * b) + slip)
    twist = 4.0 * float(base.bending[2, 2]) * b + G * section.J
    false = 0.0
    if line.joint.kind != "pinned" and not set(line.joint.stiffness) & {"rx", "ry", "rz"}:
        clamped = 12.0 * E * lateral / line.spacing**2
        phi = 0.0 if line.frame.part.element == "euler" else clamped / (G * shear)
        false = clamped * e**2 / (1.0 + phi)
    names = line.frame.part.name, part.name
    return RibError(*names, e, line.spacing, float(rigid / true), float(1.0 + false / twist))


def _slip(plate: PlateMesh, line: RibLine) -> float:
    """1 / (E A) of springs between rib and plate along it, for one half wave over its length; 0 for a rigid joint."""
    along = line.along @ plate.axes[:2]
    if line.joint.kind == "sliding":
        return float(np.pi**2 / (line.joint.slip * line.length**2)) if line.joint.slip > 0.0 else np.inf
    for axis, direction in enumerate(("x", "y", "z")):
        if direction in line.joint.stiffness and abs(along[axis]) > 0.7:
            stiffness = line.joint.stiffness[direction]
            spacing = 1.0 if line.joint.per == "length" else line.spacing
            return float(np.pi**2 * spacing / (stiffness * line.length**2)) if stiffness > 0.0 else np.inf
    return 0.0


def _layer(part: Foundation, *plates: Plate) -> list[Finding]:
    """A layer so stiff in shear that plates would stretch before it yields: two act as one section, and one is held by
    its face."""
    bodies = {one.name: one.body() for one in plates}
    layer = layer_of(part, bodies, 1e-9 * max(side for one in plates for side in one.size))
    ratio = glue_ratio(layer, part.spread_shear(layer), *plates)
    excess = float(np.sqrt(ratio) - 1.0)
    if excess <= NOTABLE:
        return []
    both = len(plates) > 1
    plane = "in their planes, but they are rigid there" if both else "in its plane, but it is rigid there"
    return [
        Finding(
            "stiff-layer",
            f"{part.name} is so stiff in shear that {' and '.join(bodies)} would stretch {plane}: {ratio:.3g} times "
            f"too stiff in bending, frequencies up to {percent(excess)} too high",
            {"bending_ratio": ratio, "frequency_excess": excess},
            severe=excess > SEVERE,
        )
    ]
