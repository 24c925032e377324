"""Layers whose losses are mostly in shear, as of a damped core, of thin plates, which have no shear that could lose."""

from __future__ import annotations

from femstruct.errors import Finding
from femstruct.model.materials.lay_up import Laminate
from femstruct.model.materials.loss_by_frequency import loss_at
from femstruct.model.model import Model
from femstruct.parts.of_plates.plate_mesh import plates_of

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
