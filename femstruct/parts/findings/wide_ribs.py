"""Ribs as wide as a share of the plate between them, which are fastened to it along lines.

The plate bends between the faces of ribs that do not turn, b of s narrower than between their lines: its waves there
have frequencies that are higher by (s / (s - b))^2. Ribs that turn, as most do, leave a part of it: chipboard on timber
joists of 45 mm every 600 mm is 5 to 6 % higher in three-dimensional solids, where the bound is 17 %
(`tests/analytic/test_plates_that_stretch.py`).
"""

from __future__ import annotations

import numpy as np

from femstruct.errors import Finding
from femstruct.model.model import Model
from femstruct.parts.findings.ribs import Face, RibLine, edges_across, percent, rib_lines, stretching_faces
from femstruct.parts.of_frames.frame_mesh import frames_of

NOTABLE = 0.05  # of a frequency, by the bound


def wide_rib_findings(model: Model) -> tuple[Finding, ...]:
    """Ribs whose width leaves less of a plate to bend than their lines do; the widest of each pair of parts."""
    worst: dict[tuple[str, str], tuple[float, float]] = {}
    for plate in stretching_faces(model) if frames_of(model) else ():
        lines = [line for joint in model.structure.joints for line in rib_lines(plate, joint, model)]
        for line in lines:
            wide, span = _between(plate, line, lines)
            key = (line.frame.name, plate.name)
            if wide < span and wide / span > np.divide(*worst.get(key, (0.0, 1.0))):
                worst[key] = wide, span
    return tuple(
        Finding(
            "wide-ribs",
            f"{frame} on {plate}: ribs {1e3 * wide:.3g} mm wide are fastened along lines {1e3 * span:.3g} mm apart, "
            f"and {plate} bends over {1e3 * (span - wide):.3g} mm between them. Modes in which it bends between ribs "
            f"are up to {percent(low)} too low, if the ribs do not turn. Modes in which the ribs bend too are right",
            {"width_m": wide, "strip_m": span, "frequency_too_low": low},
        )
        for (frame, plate), (wide, span) in worst.items()
        if (low := 1.0 - (1.0 - wide / span) ** 2) > NOTABLE
    )


def _between(plate: Face, line: RibLine, lines: list[RibLine]) -> tuple[float, float]:
    """What ribs cover of the span to the nearest line beside this one, and that span [m]; of a rib alone, both for a
    line as far away as twice its farther edge, half of the rib to each side."""
    wide = width_on(plate, line)
    beside = [other for other in lines if abs(other.along @ line.along) > 1.0 - 1e-6]
    low, high = edges_across(plate, line)
    apart = [(abs(other.across - line.across), other) for other in beside]
    apart = [(span, other) for span, other in apart if span > 1e-6 * (high - low)]
    if not apart:
        return wide, 2.0 * max(high - line.across, line.across - low)
    span, other = min(apart, key=lambda one: one[0])
    return (wide + width_on(plate, other)) / 2.0, span


def width_on(plate: Face, line: RibLine) -> float:
    """Width of the section of a rib across its line, in the plane of a plate [m]; 0 where its outline is unknown."""
    across = np.array([-line.along[1], line.along[0]]) @ plate.axes[:2]
    outline = np.array(line.frame.part.section.outline).reshape(-1, 2)
    return float(np.ptp(outline @ (line.axes[1:] @ across))) if len(outline) else 0.0
