"""Measured reductions of coverings: taken off the levels of a tapping machine, on floors like the laboratory's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import log10, pi
from typing import Final

import numpy as np

from acoustics.levels.bands import band_edges, third_octave_bands
from acoustics.levels.ending import shown
from acoustics.levels.methods import Method
from femstruct.errors import Finding, InputError
from femstruct.impact.scene.impact_sources import HAMMER_MASS, TAPPING_MACHINE
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import frf
from femstruct.study.acting import Covering, PlacedBody
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.rated_rooms import method_for

HEAVY_DB: Final = 1.0  # of the force of hammers that a heavy floor takes at most: single numbers are of whole decibels
LINES: Final = 12  # in a third octave
_ALL_HZ: Final = 1e6


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


def covered_floor(studies: Sequence[Study], places: Places, basis: ModalBasis) -> list[Finding]:
    """What is to be known of a covering on this floor. basis : damped, with residual vectors for the hammers.

    Raises InputError for one that was measured on a floor of another kind.

    Notes
    -----
    A hammer strikes as a source of the mobility 1 / (j omega m) does: on a floor of the mobility Y its force is
    1 / |1 + j omega m Y| of that on a rigid one. A floor is heavy if that is less than 1 dB in every rated band, over
    all hammers and lines: what a covering does to hammers there is what it does in the laboratory.
    """
    covering = covering_of(studies[0])
    if covering is None:
        return []
    hammers = list(
        {one.target: one for study in studies for one in study.bodies if one.source == TAPPING_MACHINE}.values()
    )
    methods = [method for plan in studies[0].rooms if (method := method_for(plan, studies[0])) is not None]
    if not methods:
        return []
    taken, mobility = _taken(hammers, methods[0], places, basis)
    worst = max(taken, key=lambda band: taken[band], default=0.0)
    heavy = not taken or taken[worst] <= HEAVY_DB
    own = 1.0 / (2 * pi * worst * HAMMER_MASS) if taken else 0.0
    numbers = (
        f"at {worst:g} Hz its mobility is {mobility.get(worst, 0.0):.2g} m/(N s), that of a hammer {own:.2g}, and the "
        f"force of the hammers is {taken.get(worst, 0.0):.1f} dB less than on a rigid floor"
    )
    if heavy != (covering.measured_on == "heavy"):
        machine = hammers[0].name.rpartition(".")[0] or hammers[0].name
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
            f"rated levels are lower by the measured reduction of the covering; sounds, histories and other levels are "
            f"those of the bare floor. The floor is {covering.measured_on} as that of the laboratory: {numbers}",
            {"taken_db": taken.get(worst, 0.0), "allowed_db": HEAVY_DB, "band_hz": worst},
        )
    ]


def _taken(
    hammers: Sequence[PlacedBody], method: Method, places: Places, basis: ModalBasis
) -> tuple[dict[float, float], dict[float, float]]:
    """What a floor takes of the force of hammers {band [Hz]: [dB]}, and its mobility (rms) there, in the third octaves
    of the rated bands. Above its modes the mobility is taken to be real, and that of the last octave with modes, as of
    plates: without that a light floor would be heavy for want of modes."""
    low, high = method.bands_hz[0], method.bands_hz[-1]
    rated = {band: centre for band, centre in third_octave_bands(_ALL_HZ).items() if low <= band <= high}
    end = basis.complete_below_hz or np.inf
    bands = {band: centre for band, centre in rated.items() if shown(centre, end, 3)}
    if not bands:
        return {}, {}
    lines = np.array([np.geomspace(*band_edges(centre), LINES) for centre in bands.values()])
    probes = [places.point(one.target, f"bodies.{one.name}").probe("z") for one in hammers]
    found = np.array([frf(basis, probe, probe, lines.ravel(), "mobility") for probe in probes]).reshape(
        -1, *lines.shape
    )
    felt = np.mean(np.abs(1.0 + 2j * pi * lines * HAMMER_MASS * found) ** 2, axis=(0, 2))
    size = np.sqrt(np.mean(np.abs(found) ** 2, axis=(0, 2)))
    taken = {band: 10.0 * log10(one) for band, one in zip(bands, felt.tolist(), strict=True)}
    mobility = dict(zip(bands, size.tolist(), strict=True))
    real = float(found.real[:, -3:].mean())
    for band in rated.keys() - bands.keys():
        taken[band] = 10.0 * log10(1.0 + (2 * pi * rated[band] * HAMMER_MASS * real) ** 2)
        mobility[band] = real
    return taken, mobility
