"""Ribbed plates that their supports hold lengthways at both ends, so that they act as arches.

When a T of a plate and a rib bends, the ends of the plate slide along. Held there, at z from the common neutral axis,
it is pushed by a force N, the same all along the rib. For one half wave of amplitude w0 over the length L

    N = E A z 2 pi w0 / L^2,    energy N^2 L / 2 E A = (8 / pi^2) (E A z^2 / E I) times that of bending

with E A and E I of the T. The half wave is a bound from above: the ends turn back a little.

Checked against a model that is within 0.1 % of a three-dimensional solid (`tests/analytic/test_supports_in_plane.py`).
"""

from __future__ import annotations

import numpy as np

from femstruct.errors import Finding
from femstruct.model.grid.in_plane import planes_of
from femstruct.model.model import Model
from femstruct.parts.findings.connections import TOUCHING, held_with_joined
from femstruct.parts.findings.ribs import Face, RibLine, percent, rib_lines, stretching_faces, strip_width
from femstruct.parts.of_frames.frame_mesh import frames_of

NOTABLE = 1e-2  # of a frequency
_BOTH = 0.5  # of a rib's length: supports that are so far apart along it hold both ends
_HELD = 1e-9


def arched_findings(model: Model) -> tuple[Finding, ...]:
    """Plates that stretch, slabs and flat shells, with ribs beside them, held lengthways at both ends; the worst rib of
    each pair of parts."""
    worst: dict[tuple[str, str], float] = {}
    stretching = stretching_faces(model) if frames_of(model) else []
    planes = planes_of(model, TOUCHING * float(np.ptp(model.mesh.points, axis=0).max())) if stretching else []
    held = held_with_joined(model) if stretching else np.zeros((0, 3, 3))
    for plate in stretching:
        plane = next(names for names in planes if plate.name in names)
        nodes = np.concatenate([model.parts[name].nodes for name in sorted(plane)])
        lines = [line for joint in model.structure.joints for line in rib_lines(plate, joint, model)]
        for line in lines:
            along = line.along @ plate.axes[:2]
            places = model.mesh.points[nodes[np.einsum("i,nij,j->n", along, held[nodes], along) > _HELD]] @ along
            if line.arm != 0.0 and len(places) and np.ptp(places) > _BOTH * line.length:
                key = (line.frame.name, plate.name)
                worst[key] = max(worst.get(key, 0.0), arch_excess(plate, line, lines))
    return tuple(
        Finding(
            "arched-plate",
            f"Supports hold {plate} lengthways at both ends of its eccentric rib {frame}. Both act as an arch: "
            f"frequencies of bending are up to {percent(excess)} higher than with ends that can slide",
            {"frequency_excess": excess},
        )
        for (frame, plate), excess in worst.items()
        if excess > NOTABLE
    )


def arch_excess(plate: Face, line: RibLine, others: list[RibLine]) -> float:
    """Relative excess of the first frequency of a rib with its strip of plate over that with ends that slide [1]."""
    E, _, section = line.frame.part.along
    base = plate.section.turned(-float(np.arctan2(line.along[1], line.along[0])))
    width, normal = strip_width(plate, line, others), plate.axes[2]
    upright = section.Iy * (line.axes[2] @ normal) ** 2 + section.Iz * (line.axes[1] @ normal) ** 2
    rib, strip = E * section.A, base.stretching() * width
    off = line.arm * rib / (rib + strip)  # of the plate from the common neutral axis
    bending = float(base.bending[0, 0]) * width + E * upright + line.arm**2 * rib * strip / (rib + strip)
    return float(np.sqrt(1.0 + 8.0 / np.pi**2 * (rib + strip) * off**2 / bending) - 1.0)
