"""Findings on losses of parts: layers that lose mostly in shear, and losses that are counted twice."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from femstruct.errors import Finding
from femstruct.model.lay_ups import Laminate
from femstruct.model.materials import LABORATORY, Loss, LossByFrequency, loss_at
from femstruct.model.model import Model
from femstruct.parts.plate import plates_of
from femstruct.parts.wave_findings import shells_of

# ----------------------------------------------------------------------------------------------------------------------
# Layers whose losses are mostly in shear, as of a damped core, of thin plates, which have no shear that could lose.
# ----------------------------------------------------------------------------------------------------------------------

APART, TIMES = 0.01, 1.5
"""Difference and ratio of two loss factors from which on it matters which of them a mode has."""
AT_HZ = 100.0


def layer_loss_findings(model: Model) -> tuple[Finding, ...]:
    """Thin plates of layers whose loss factor in transverse shear is another than in bending. Shells and slabs shear,
    and each of their layers loses by its own share of it."""
    found = []
    for name, material in {one.name: one.part.material for one in plates_of(model)}.items():
        if not isinstance(material, Laminate):
            continue
        section = material.section
        bends, shears = (float(loss_at(one, AT_HZ)) for one in (section.loss_factor, section.shear_loss_factor))
        low, high = sorted((bends, shears))
        if high - low <= APART or high <= TIMES * low:
            continue
        found.append(
            Finding(
                "layers-lose-in-shear",
                f"{name}: its layers have a loss factor of {100 * bends:.3g} % in bending and {100 * shears:.3g} % in "
                f"transverse shear, by their shares of the energy at {AT_HZ:g} Hz. A thin plate has no shear, so "
                "its modes have that of bending; the larger the share of shear in the deflection, the nearer is the "
                "truth to the other. 'type: slab' has both",
                {"bending_loss_factor": bends, "shear_loss_factor": shears},
            )
        )
    return tuple(found)


# ----------------------------------------------------------------------------------------------------------------------
# Plates whose loss factor holds losses at their edges and by radiation already, beside models of these.
# ----------------------------------------------------------------------------------------------------------------------

HEAVIEST = 800.0  # kg/m^2
AIR = 413.0  # Pa s/m: characteristic impedance
TOTAL_AT_HZ = 100.0
RADIATED = 0.05  # of a loss factor: by radiation to one side, with an efficiency of one


def total_loss_findings(model: Model, two_way: Mapping[str, str] | None = None) -> tuple[Finding, ...]:
    """Parts with a total loss factor, of a laboratory or measured, at whose edges the model has losses of its own, or
    whose radiation is modelled; and those that are too heavy for that of a laboratory.

    Parameters
    ----------
    two_way : Mapping[str, str] | None
        Names of rooms whose air reacts on the structure, by the surface that radiates into them.
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
        if AIR / (2.0 * np.pi * TOTAL_AT_HZ * masses[name]) > RADIATED * float(loss.at(TOTAL_AT_HZ)):
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
