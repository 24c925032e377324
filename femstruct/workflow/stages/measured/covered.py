"""Measured reductions of coverings: taken off the levels of a tapping machine, on floors like the laboratory's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from acoustics.levels.ensemble import Ensemble
from acoustics.statistical.statistical_bands import StatisticalBands
from femstruct.errors import Finding, InputError
from femstruct.impact.scene.impact_sources import HAMMER_MASS, TAPPING_MACHINE
from femstruct.modal.basis import ModalBasis
from femstruct.study.acting import Covering
from femstruct.study.study import Study
from femstruct.workflow.stages.measured.taken_force import taken_force
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.rated_rooms import method_for

HEAVY_DB: Final = 1.0  # of the force of hammers that a heavy floor takes at most: single numbers are of whole decibels


def covering_of(study: Study) -> Covering | None:
    """What lies below the tapping machine of a study, None for a bare floor."""
    return next((body.covering for body in study.bodies if body.covering is not None), None)


def reduced(study: Study, levels: Sequence[Mapping[float, float]]) -> list[Mapping[float, float]]:
    """Levels of a tapping machine at receivers {band [Hz]: [dB]}, less the reduction of a covering below it.

    Notes
    -----
    Delta L is the ratio of the forces with and without covering, on a floor whose mobility is far below that of a
    hammer: L_n = L_n,bare - Delta L in every band (ISO 717-2, ISO 12354-2).
    """
    covering = covering_of(study)
    if covering is None:
        return list(levels)
    less = covering.reduction_db
    return [{band: level - less.get(band, 0.0) for band, level in one.items()} for one in levels]


def reduced_rooms(
    study: Study, statistical: Mapping[str, StatisticalBands], ensembles: Mapping[str, Ensemble]
) -> tuple[dict[str, StatisticalBands], dict[str, Ensemble]]:
    """Statistical energies and ensembles of rated rooms, by name, less the reduction of a covering in every band."""
    covering = covering_of(study)
    if covering is None:
        return dict(statistical), dict(ensembles)
    less = covering.reduction_db
    bands = {plan.name: method.bands_hz for plan in study.rooms if (method := method_for(plan, study)) is not None}
    lower = {
        name: replace(
            one,
            levels_db={band: level - less.get(band, 0.0) for band, level in one.levels_db.items()},
            alike_db={band: level - less.get(band, 0.0) for band, level in one.alike_db.items()},
        )
        for name, one in statistical.items()
    }
    members = {
        name: replace(one, members_db=one.members_db - np.array([less.get(band, 0.0) for band in bands[name]]))
        for name, one in ensembles.items()
    }
    return lower, members


def covered_floor(studies: Sequence[Study], places: Places, basis: ModalBasis) -> list[Finding]:
    """What is to be known of a covering on this floor. basis : damped, with residual vectors for the hammers.

    Raises InputError for one that was measured on a floor of another kind, and for one without all rated bands.

    Notes
    -----
    A floor is heavy if it takes less than 1 dB of the force of the hammers (`taken_force`) in every rated band: what a
    covering does to hammers there is what it does in the laboratory.
    """
    covering = covering_of(studies[0])
    if covering is None:
        return []
    struck = {one.target: one for study in studies for one in study.bodies if one.source == TAPPING_MACHINE}
    hammers = list(struck.values())
    methods = [method for plan in studies[0].rooms if (method := method_for(plan, studies[0])) is not None]
    machine = hammers[0].name.rpartition(".")[0] or hammers[0].name
    missing = [band for one in methods for band in one.bands_hz if band not in covering.reduction_db]
    if missing:
        got = f"a covering without a reduction at {missing[0]:g} Hz"
        raise InputError(f"bodies.{machine}.covering", got=got, expected="one in every band that is rated")
    probes = [places.point(one.target, f"bodies.{one.name}").probe("z") for one in hammers]
    rated = (methods[0].bands_hz[0], methods[0].bands_hz[-1]) if methods else (0.0, 0.0)
    found = taken_force(basis, probes, HAMMER_MASS, rated, beyond=True)
    if found is None:
        return []
    heavy = found.taken_db <= HEAVY_DB
    numbers = (
        f"at {found.band_hz:g} Hz its mobility is {found.floor:.2g} m/(N s), that of a hammer {found.own:.2g}, and the "
        f"force of the hammers is {found.taken_db:.1f} dB less than on a rigid floor"
    )
    if heavy != (covering.measured_on == "heavy"):
        here = "heavy" if heavy else "light"
        do = (
            "leave out 'measured_on: light', with the Delta L of a heavy floor"
            if heavy
            else "give the Delta L_t of a light floor with 'measured_on: light', or the covering as a layer"
        )
        raise InputError(
            f"bodies.{machine}.covering",
            got=f"a reduction measured on a {covering.measured_on} floor, on a {here} one: {numbers}",
            expected=f"less than {HEAVY_DB:g} dB on heavy floors, as a reduction is a ratio of forces",
            do=do,
        )
    return [
        Finding(
            "covering-in-ratings",
            "rated levels are lower by the measured reduction of the covering; sound files, L_AFmax, histories and all "
            f"other levels are those of the bare floor. The floor is {covering.measured_on} as that of the laboratory: "
            f"{numbers}",
            {"taken_db": found.taken_db, "allowed_db": HEAVY_DB, "band_hz": found.band_hz},
        )
    ]
