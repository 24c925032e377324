"""Findings on cavities that need no modes: how they lie, and what crosses them."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.model.materials.air_between import AirBetween
from femstruct.model.model import Model
from femstruct.sound.placed_cavity import placed_cavities

DEEP: Final = 0.5  # of the depth that what crosses a cavity takes of it
WITHIN: Final = 0.02  # of the sides: what lies nearer to them closes the cavity there


def cavity_findings(model: Model) -> tuple[Finding, ...]:
    """Cavities whose depth or sides do not fit their surfaces, and those that joists cross.

    Raises InputError: as `placed_cavities` does.
    """
    found: list[Finding] = []
    for cavity in model.structure.cavities:
        found += placed_cavities(cavity, model.surfaces)[1]
        if cavity.bays is None:
            found += _crossed(model, cavity)
    return tuple(found)


def _crossed(model: Model, cavity: AirBetween) -> list[Finding]:
    """A finding on every frame that runs through the air of a cavity along its surfaces."""
    first, second = (model.surfaces[name] for name in (cavity.first, cavity.second))
    axes = np.vstack([first.along, first.normal])
    corners = (first.outline - first.outline[0]) @ axes.T
    low, high = corners[:, :2].min(axis=0), corners[:, :2].max(axis=0)
    margin = WITHIN * (high - low)
    apart = float((second.centre - first.centre) @ first.normal)
    found = []
    for name, part in model.parts.items():
        if not len(part.lines):
            continue
        places: Floats = (model.mesh.points[part.lines] - first.outline[0]) @ axes.T  # [lines, 2, 3]
        middle, along = places.mean(axis=1), np.ptp(places, axis=1)
        inside = ((middle[:, :2] > low + margin) & (middle[:, :2] < high - margin)).all(axis=1)
        level = along[:, 2] < DEEP * np.linalg.norm(along, axis=1)
        between = (middle[:, 2] > -DEEP * apart) & (middle[:, 2] < apart * (1.0 + DEEP))
        crossing = inside & level & between
        if crossing.any():
            across = middle[crossing][:, :2]
            axis = int(np.ptp(across, axis=0).argmin()) if crossing.sum() > 1 else 0
            at = np.unique(across[:, axis].round(3))
            found.append(
                Finding(
                    "cavity-crossed",
                    f"{name} runs through the cavity {cavity.name}, and air flows past it there as if it were not: if "
                    "it closes the cavity, every bay is one of its own. Name them with 'bays'",
                    {"lines": float(crossing.sum()), "first_place_m": float(at[0])},
                )
            )
    return found
