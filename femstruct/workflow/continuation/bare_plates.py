"""Floors that statistical energies are for: one bare plate under standard blows; of others, why not."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Final

import numpy as np

from acoustics.statistical.energies import RadiatingPlate
from acoustics.statistical.infinite_plate import InfinitePlate
from femstruct.arrays import Floats
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, Ratio, Rayleigh
from femstruct.model.materials.lay_up import Smeared, section_of
from femstruct.model.materials.loss_by_frequency import loss_at
from femstruct.model.materials.plate_section import PlateSection
from femstruct.model.structure import Structure, Support, SurfaceOn
from femstruct.parts.plate import Plate
from femstruct.parts.slab import Slab
from femstruct.study.asked import RoomPlan
from femstruct.study.study import Study

HAMMER_HEAD_M: Final = 0.015  # radius of a tapping machine's hammer, ISO 10140-5 annex E
ASKEW: Final = 1e-6  # of the rigidities: coupling of bending and twist of layers at an angle


def bare_plate(plan: RoomPlan, study: Study, patch_m: float = 0.0) -> RadiatingPlate | str:
    """The plate above a room whose levels can be had by statistical energies; a reason where there is none.

    patch_m : radius of the disc that is struck [m].
    """
    structure = study.structure
    reason = _not_bare(structure) or _struck_otherwise(study) or _other_air(plan)
    if reason or not isinstance(structure, Structure):
        return reason
    (part,) = structure.parts
    assert isinstance(part, Plate | Slab), "seen above"
    surface = next((one for one in structure.surfaces if one.name == plan.under), None)
    if surface is None or surface.on != part.name or not (sides := _sides(surface, part)):
        return f"'{plan.under}' is no rectangle of it"
    section = section_of(part.material, part.thickness)
    loss = loss_law(study.damping, section)
    if not (loss(np.array([100.0, 1000.0])) > 0).all():
        return "it has no damping"
    return RadiatingPlate(infinite(section), part.size[0] * part.size[1], sides, loss, patch_m)


def alike(plate: RadiatingPlate, study: Study) -> RadiatingPlate:
    """The plate by the theory that its modes are of: plates are thin, slabs shear."""
    thin = isinstance(study.structure, Structure) and any(isinstance(part, Plate) for part in study.structure.parts)
    whole = plate.plate.thin if thin else plate.plate
    return RadiatingPlate(whole, plate.area, plate.sides, plate.loss_factor, plate.patch_m)


def infinite(section: PlateSection) -> InfinitePlate:
    """The infinite plate of a section; its bending about the neutral surface."""
    D = section.bending
    rigidity = (float(D[0, 0]), float(D[1, 1]), float(D[0, 1]), float(D[2, 2]))
    shear = (float(section.As[0, 0]), float(section.As[1, 1]))
    return InfinitePlate(section.m0, rigidity, shear, section.m2 - section.m1**2 / section.m0)


def loss_law(damping: Damping, section: PlateSection) -> Callable[[Floats], Floats]:
    """Loss factor [nf] of frequencies [nf] [Hz] by the general law of a structure's damping; what single modes have
    instead counts for these alone."""

    def of(frequency_hz: Floats) -> Floats:
        omega, base = 2 * np.pi * frequency_hz, damping.base
        match base:
            case Ratio(value):
                return np.full(len(omega), 2.0 * value)
            case LossFactor(value):
                return np.full(len(omega), value)
            case Rayleigh(alpha, beta):
                return np.asarray(alpha / omega + beta * omega)
            case FromMaterials():
                return loss_at(section.loss_factor, frequency_hz)

    return of


def _not_bare(structure: object) -> str:
    """Why a structure is not one bare rectangular plate; "" where it is."""
    if not isinstance(structure, Structure):
        return "the structure has no parts"
    if len(structure.parts) != 1:
        return f"the floor has {len(structure.parts)} parts"
    (part,) = structure.parts
    if not isinstance(part, Plate | Slab):
        return f"'{part.name}' is neither a plate nor a slab"
    if isinstance(part.material, Smeared):
        return f"'{part.name}' is given by smeared rigidities, whose ribs or hollows have waves of their own"
    if isinstance(part, Slab) and (len(part.outline) != 4 or part.holes):
        return f"'{part.name}' is not a rectangle without openings"
    D = section_of(part.material, part.thickness).bending
    if max(abs(D[0, 2]), abs(D[1, 2])) > ASKEW * min(D[0, 0], D[1, 1]):
        return f"layers of '{part.name}' are at an angle to its edges"
    if structure.joints or structure.constraints:
        return f"'{part.name}' is tied by joints or constraints"
    sprung = [one.name for one in structure.supports if not _held(one)]
    return f"'{sprung[0]}' is an edge with stiffness or losses of its own" if sprung else ""


def _held(support: Support) -> bool:
    """Whether a support holds and neither gives way nor takes energy."""
    return not any(getattr(support, word, None) for word in ("stiffness", "walls"))


def _struck_otherwise(study: Study) -> str:
    """What acts on the floor beside one source of blows; "" for nothing."""
    others = [one.name for group in (study.links, study.contacts, study.loads, study.walks) for one in group]
    others += [body.name for body in study.bodies if not body.source or not body.law]
    return f"'{others[0]}' acts on the floor" if others else "" if study.bodies else "nothing strikes the floor"


def _other_air(plan: RoomPlan) -> str:
    """Why a room is not one with a diffuse field of its own losses under one surface; "" where it is."""
    if plan.room.losses.kind == "none":
        return "the room has no reverberation time"
    if not plan.room.all_walls_area < inf:
        return f"{plan.room.word} has no diffuse field of one reverberation time"
    return "several surfaces radiate into the room, or a wall of it" if plan.walls or plan.on else ""


def _sides(surface: SurfaceOn, part: Plate | Slab) -> tuple[float, float] | None:
    """Sides of the rectangle that radiates [m]; None for another form."""
    region = surface.region
    if region.kind == "whole":
        return part.size
    return region.size if region.kind == "rectangle" else None
