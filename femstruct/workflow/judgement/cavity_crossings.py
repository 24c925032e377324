"""Findings on cavities that need no modes: how they lie, and what crosses them."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding, some_of
from femstruct.model.materials.air_between import AirBetween, Bays
from femstruct.model.model import Model
from femstruct.sound.placed_cavity import all_cavities, shared

DEEP: Final = 0.5  # of the depth that what crosses a cavity takes of it
WITHIN: Final = 0.02  # of the sides: what lies nearer to them closes the cavity there
_STRAIGHT: Final = 0.1  # of its length that a bar runs aside and still lies along an axis


def cavity_findings(model: Model) -> tuple[Finding, ...]:
    """Cavities whose depth or sides do not fit their surfaces, those that joists cross, and bays beside their joists.

    Raises InputError: as `all_cavities` does.
    """
    found = list(all_cavities(model.structure.cavities, model.surfaces)[1])
    for cavity in model.structure.cavities:
        bars, sides = _bars(model, cavity)
        found += _crossed(cavity, bars) if cavity.bays is None else _beside(cavity, cavity.bays, bars, sides)
    return tuple(found)


def _bars(model: Model, cavity: AirBetween) -> tuple[dict[str, Floats], Floats]:
    """Bars of every frame that runs through the air of a cavity along its surfaces {frame: ends [k, 2, 2] [m]}, along x
    and y of the first from the corner of the cavity, and the sides of the cavity [2] [m]."""
    first, second = pair = model.surfaces[cavity.first], model.surfaces[cavity.second]
    axes = np.vstack([first.along, first.normal])
    low, high = shared(pair)
    margin = WITHIN * (high - low)
    apart = float((second.centre - first.centre) @ first.normal)
    found = {}
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
            found[name] = places[crossing][:, :, :2] - low
    return found, high - low


def _crossed(cavity: AirBetween, bars: dict[str, Floats]) -> list[Finding]:
    """A finding on every frame in a cavity that is described as one."""
    found = []
    for name, ends in bars.items():
        across = ends.mean(axis=1)
        axis = int(np.ptp(across, axis=0).argmin()) if len(across) > 1 else 0
        found.append(
            Finding(
                "cavity-crossed",
                f"{name} runs through the cavity {cavity.name}, and air flows past it there as if it were not: if "
                "it closes the cavity, every bay is one of its own. Name them with 'bays'",
                {"lines": float(len(ends)), "first_place_m": float(across[:, axis].round(3).min())},
            )
        )
    return found


def _beside(cavity: AirBetween, bays: Bays, bars: dict[str, Floats], sides: Floats) -> list[Finding]:
    """A finding on bays that end where no bar lies, although there are bars in the cavity."""
    if not bars:
        return []
    axis = 0 if bays.across == "x" else 1
    ends = np.concatenate(list(bars.values()))
    aside, lengths = np.ptp(ends[:, :, axis], axis=1), np.linalg.norm(np.ptp(ends, axis=1), axis=1)
    closing = ends[aside <= _STRAIGHT * lengths].mean(axis=1)[:, axis]
    near = max(bays.width / 2.0, WITHIN * float(sides[axis]))
    empty = [at for at in bays.at if not (np.abs(closing - at) <= near).any()]
    if not empty:
        return []
    there = some_of([f"{at:.4g}" for at in np.unique(closing.round(3))]) if len(closing) else ""
    lie = f"bars that close it lie at {bays.across} = {there} m" if there else f"no bar closes it across {bays.across}"
    return [
        Finding(
            "bays-beside-joists",
            f"{cavity.name}: no bar of {some_of(bars)} lies where its bays end, at {bays.across} = "
            f"{some_of([f'{at:.4g}' for at in empty])} m from the corner of the cavity; {lie}. Is 'across' the other "
            "axis, or another corner meant?",
            {"bays": len(bays.at) + 1, "ends_beside": len(empty), "first_place_m": empty[0]},
        )
    ]
