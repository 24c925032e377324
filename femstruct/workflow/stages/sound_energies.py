"""Sound energies: what the surfaces of a study send into the open in a record."""

from __future__ import annotations

from acoustics.errors import Advice
from acoustics.open_air.half_space import HalfSpace
from femstruct.errors import Finding
from femstruct.impact.result.response import Response
from femstruct.sound.power import Radiated, not_taken, radiated_by
from femstruct.study.study import Study
from femstruct.workflow.stages.coupled_air import ceiling
from femstruct.workflow.stages.places import Places


def sound_energies(
    study: Study, places: Places, response: Response
) -> tuple[dict[str, Radiated], list[tuple[str, Advice | Finding]]]:
    """What was radiated into every half space, by name, and what is to be known of it, by name."""
    radiated: dict[str, Radiated] = {}
    told: list[tuple[str, Advice | Finding]] = []
    for plan in study.rooms:
        if isinstance(plan.room, HalfSpace):
            surface = ceiling(plan, places)
            radiated[plan.name], found = radiated_by(response, surface, plan.room, plan.directivity, plan.name)
            told += [(plan.name, one) for one in found]
    everywhere = sum(one.energy.energy_j for one in radiated.values())
    told += [(name, one) for one in not_taken(everywhere, response.ledger.end.lost_modes) for name in radiated]
    return radiated, told
