"""Footsteps that were recorded on a stiff plate, on floors that may give way to a foot."""

from __future__ import annotations

from typing import Final

from femstruct.errors import Finding
from femstruct.modal.basis import ModalBasis
from femstruct.study.asked import Spot
from femstruct.study.study import Study
from femstruct.workflow.stages.measured.taken_force import taken_force
from femstruct.workflow.stages.places import Places

FOOT_KG: Final = 4.6  # foot and shank, 6.1 % of 75 kg: D. A. Winter, Biomechanics and Motor Control of Human Movement
STEP_HZ: Final = (20.0, 100.0)  # what a step excites that a floor answers with sound
TAKEN_DB: Final = 1.0


def footstep_findings(study: Study, places: Places, basis: ModalBasis) -> list[Finding]:
    """Recorded footsteps on floors whose mobility is no longer far below that of a foot. basis : damped."""
    found = []
    for load in study.loads:
        if not load.footstep or not isinstance(load.on, Spot):
            continue
        probe = places.point(load.on.name, f"loads.{load.name}").probe("z")
        taken = taken_force(basis, [probe], FOOT_KG, STEP_HZ)
        if taken is not None and taken.taken_db > TAKEN_DB:
            found.append(
                Finding(
                    "footstep-on-light-floor",
                    f"{load.name}: its force was recorded on a stiff plate. In the third octave at {taken.band_hz:g} "
                    f"Hz the mobility of this floor is {taken.floor:.2g} m/(N s), that of a foot of {FOOT_KG:g} kg "
                    f"{taken.own:.2g}: there the force is about {taken.taken_db:.1f} dB less than what was recorded",
                    {"band_hz": taken.band_hz, "taken_db": taken.taken_db, "floor": taken.floor, "foot": taken.own},
                )
            )
    return found
