"""Plates whose loss factor holds losses at their edges and by radiation already, beside models of these."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from femstruct.errors import Finding
from femstruct.model.materials.loss_by_frequency import LABORATORY, Loss, LossByFrequency
from femstruct.model.model import Model
from femstruct.parts.findings.shell_waves import shells_of
from femstruct.parts.of_plates.plate_mesh import plates_of

HEAVIEST = 800.0  # kg/m^2
AIR = 413.0  # Pa s/m: characteristic impedance
AT_HZ = 100.0
RADIATED = 0.05  # of a loss factor: by radiation to one side, with an efficiency of one


def total_loss_findings(model: Model, two_way: Mapping[str, str] | None = None) -> tuple[Finding, ...]:
    """Parts with a total loss factor, of a laboratory or measured, at whose edges the model has losses of its own, or
    whose radiation is modelled; and those that are too heavy for that of a laboratory.

    two_way : names of rooms whose air reacts on the structure, by the surface that radiates into them.
    """
    losses: dict[str, Loss] = {one.name: one.part.section.loss_factor for one in plates_of(model)}
    losses |= {one.name: one.loss_factor for one in shells_of(model)}
    masses = {one.name: one.per_area for one in plates_of(model)}
    masses |= {one.name: float(np.mean(one.per_area)) for one in shells_of(model)}
    found = []
    for name, loss in losses.items():
        if not isinstance(loss, LossByFrequency) or not loss.total:
            continue
        counted = _edges(name, model, losses)
        if AIR / (2.0 * np.pi * AT_HZ * masses[name]) > RADIATED * float(loss.at(AT_HZ)):
            counted += _radiation(name, model, two_way or {})
        if counted:
            kind = f"that of a laboratory ({loss})" if loss.total == LABORATORY else "from reverberation times"
            found.append(
                Finding(
                    "losses-counted-twice",
                    f"{name}: its loss factor is {kind} and holds the losses at its edges and by radiation. The model "
                    f"has some of them as well: {', '.join(counted)}. Give {name} the internal loss factor of its "
                    "material",
                    {"modelled": float(len(counted))},
                )
            )
        if loss.mass > HEAVIEST:
            found.append(
                Finding(
                    "laboratory-too-heavy",
                    f"{name} has {loss.mass:.4g} kg/m^2; m' / (485 sqrt f) of ISO 12354-1 is for less than "
                    f"{HEAVIEST:g} kg/m^2",
                    {"mass_per_area": loss.mass},
                )
            )
    return tuple(found)


def _radiation(name: str, model: Model, two_way: Mapping[str, str]) -> list[str]:
    """Rooms whose air takes vibration away from a part, in words."""
    surfaces = [one.name for one in model.structure.surfaces if one.on == name]
    return [f"the air of {two_way[one]} (two-way)" for one in surfaces if one in two_way]


def _edges(name: str, model: Model, plates: Collection[str]) -> list[str]:
    """What takes vibration away from a part at its edges, in words."""
    structure = model.structure
    own = [one for one in structure.supports if one.on == name]
    edges = [f"{one.name} (springs with losses)" for one in own if one.loss_factor]
    walls = [f"{one.name} (walls at the edge)" for one in own if one.walls]
    joined = [
        f"{one.name} (joined to {one.b if one.a == name else one.a})"
        for one in structure.joints
        if name in (one.a, one.b) and {one.a, one.b} <= set(plates)
    ]
    return [*edges, *walls, *joined]
