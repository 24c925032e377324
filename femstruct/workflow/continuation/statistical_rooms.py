"""Rated bands by statistical energies, of every room under one bare plate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from acoustics.levels.bands import band_edges, octave_bands, third_octave_bands
from acoustics.levels.methods import Method
from acoustics.losses import t60_of
from acoustics.statistical.energies import DiffuseRoom, RadiatingPlate, largest_levels, steady_levels
from acoustics.statistical.statistical_bands import FEWEST, StatisticalBands, expected_scatter
from femstruct.arrays import Floats
from femstruct.impact.scene.impact_sources import BETWEEN_BLOWS
from femstruct.study.asked import RoomPlan
from femstruct.study.study import Study
from femstruct.workflow.continuation.bare_plates import HAMMER_HEAD_M, alike, bare_plate
from femstruct.workflow.continuation.blow_forces import blow_exposures
from femstruct.workflow.stages.rated_rooms import method_for

_MOST_HZ: Final = 1e6


def statistical_plate(plan: RoomPlan, study: Study) -> RadiatingPlate | str:
    """The plate whose statistical energies stand where a room's bands are blank; why there is none, "" if not asked."""
    method = method_for(plan, study)
    if method is None or plan.beyond_modes == "blank":
        return ""
    return bare_plate(plan, study, HAMMER_HEAD_M if method.blows == "tapping" else 0.0)


def fillable(plate: RadiatingPlate, study: Study, method: Method) -> tuple[float, ...]:
    """Rated bands that statistical energies may state: those with a mode of the plate or more."""
    modes = _modes(alike(plate, study), method)
    return tuple(band for band, count in modes.items() if count >= FEWEST)


def statistical_rooms(study: Study, drops: int) -> dict[str, StatisticalBands]:
    """Of every rated room under a bare plate, by name. drops : at how many places the source strikes."""
    found = {plan.name: statistical_bands(plan, study, drops) for plan in study.rooms}
    return {name: one for name, one in found.items() if one is not None}


def statistical_bands(plan: RoomPlan, study: Study, drops: int) -> StatisticalBands | None:
    """Levels of a rated room by statistical energies, in all bands that its standards have; None for other floors.

    drops : at how many places the source strikes.

    Notes
    -----
    Blows of a tapping machine are taken as uncorrelated, ten a second, whatever the study's interval: lines of blows at
    regular intervals have the same mean.
    """
    method, plate = method_for(plan, study), statistical_plate(plan, study)
    if method is None or isinstance(plate, str):
        return None
    thirds = _thirds(method)
    exposure = blow_exposures(study.bodies, plate.plate, thirds)
    room = DiffuseRoom(plan.room.volume, plan.room.all_walls_area, plan.room.losses, plan.room.air)
    levels, beside = (_levels(one, room, exposure, method) for one in (plate, alike(plate, study)))
    modes, (centres, width) = _modes(alike(plate, study), method), _widths(method)
    t60 = np.array([t60_of(room.losses, centre) for centre in centres.tolist()])
    scatter = expected_scatter(np.array(list(modes.values())), width, t60, drops, len(plan.receivers))
    return StatisticalBands(levels, beside, modes, dict(zip(method.bands_hz, scatter.tolist(), strict=True)))


def _modes(plate: RadiatingPlate, method: Method) -> dict[float, float]:
    """How many modes of a plate are in each band of a method."""
    centres, width = _widths(method)
    found = plate.plate.modes_per_hz(centres, plate.area) * width
    return dict(zip(method.bands_hz, found.tolist(), strict=True))


def _widths(method: Method) -> tuple[Floats, Floats]:
    """Exact centres and widths of the bands of a method [Hz]."""
    every = octave_bands(_MOST_HZ) if method.fraction == 1 else third_octave_bands(_MOST_HZ)
    centres = np.array([every[band] for band in method.bands_hz])
    edges = np.array([band_edges(centre, method.fraction) for centre in centres.tolist()])
    return centres, edges[:, 1] - edges[:, 0]


def _levels(
    plate: RadiatingPlate, room: DiffuseRoom, exposure: dict[float, float], method: Method
) -> dict[float, float]:
    if method.blows == "heavy":
        return largest_levels(plate, room, exposure, method.fraction)
    thirds = steady_levels(plate, room, {band: one / BETWEEN_BLOWS for band, one in exposure.items()})
    if method.fraction == 3:
        return thirds
    members = _members(method)
    return {band: float(10 * np.log10(sum(10 ** (thirds[one] / 10) for one in members[band]))) for band in members}


def _thirds(method: Method) -> tuple[float, ...]:
    """Third octaves of a method's bands."""
    return (
        method.bands_hz if method.fraction == 3 else tuple(one for three in _members(method).values() for one in three)
    )


def _members(method: Method) -> dict[float, Sequence[float]]:
    """The third octaves of each octave, by nominal centres."""
    thirds = list(third_octave_bands(_MOST_HZ))
    return {band: thirds[thirds.index(band) - 1 : thirds.index(band) + 2] for band in method.bands_hz}
