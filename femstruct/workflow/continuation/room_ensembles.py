"""Low bands of rated rooms over an ensemble: rooms of nearly one size, places of source and microphones drawn anew.

Only rooms are evaluated again: with one-way coupling the floor's modes and the force of a blow stay what they are.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import repeat
from math import isfinite, log
from typing import Final

import numpy as np

from acoustics.arrays import Complexes
from acoustics.fields.sound_field import SoundField
from acoustics.levels.bands import octave_bands, third_octave_bands
from acoustics.levels.decibels import decibels
from acoustics.levels.ending import filtered
from acoustics.levels.ensemble import Ensemble
from acoustics.levels.iso import energy_average
from acoustics.levels.line_levels import REFERENCE_SQUARED, exposures, largest_fast
from acoustics.levels.methods import Method
from acoustics.losses import single_modes_hz, t60_of
from acoustics.source import SurfaceShapes
from femstruct.arrays import Floats, Integers
from femstruct.impact.result.response import Response
from femstruct.impact.scene.impact_sources import BETWEEN_BLOWS
from femstruct.modal.basis import ModalBasis
from femstruct.modal.coupled_damping.oscillator_set import Oscillators
from femstruct.sound.surface import at_rest
from femstruct.study.asked import RoomPlan
from femstruct.study.room_surfaces import placed_room
from femstruct.study.study import Study
from femstruct.workflow.continuation.blow_motions import blow_spectrum, coupled, driven_rates, simulated_rates
from femstruct.workflow.continuation.drawn_places import drawn_drops, drawn_receivers, drawn_sides
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.rated_rooms import apart, method_for, running
from femstruct.workflow.stages.rest import weighs

SETS: Final = 8  # of places in each room: with four, intervals of single bands scatter by 12 to 19 %, so by 7 to 12 %
HIGHEST_HZ: Final = 400.0  # of small rooms, too
BESIDE: Final = 1.4  # of the last band's centre: lines that its filter lets through
MODES_UP_TO: Final = 1.6  # of the highest line: modes above it hardly move at these
LASTS_S: Final = {"heavy": (0.3, 0.3), "tapping": (0.3, 0.6)}  # of the records: and of the longest reverberation time
LONGEST_S: Final = 4.0  # reverberation time that is looked at
FOLDED: Final = 7.0  # exponent by which what comes after is smaller
_MOST_HZ: Final = 1e6


@dataclass(frozen=True, eq=False)
class Drops:
    """The drops of a case: their studies and what came of them, by place."""

    studies: Mapping[str, Study]
    responses: Mapping[str, Response]


def low_bands(plan: RoomPlan, method: Method, end_hz: float) -> dict[float, float]:
    """Rated bands {nominal: exact centre} [Hz] of modes below an end, in which modes of the room stand alone."""
    every = octave_bands(_MOST_HZ) if method.fraction == 1 else third_octave_bands(_MOST_HZ)
    centres = {band: every[band] for band in method.bands_hz}
    t60 = t60_of(plan.room.losses, method.bands_hz[0])
    top = min(HIGHEST_HZ * 10**0.01, single_modes_hz(t60, plan.room.volume)) if isfinite(t60) else 0.0
    end = plan.heard_to_hz(end_hz)
    return {b: centre for b, centre in centres.items() if centre <= top and filtered(centre, end, method.fraction)}


def room_ensembles(drops: Drops, places: Places, basis: ModalBasis) -> dict[str, Ensemble]:
    """Of every rated room of a case that can have one, by name. basis : damped, without the rooms' air."""
    study = next(iter(drops.studies.values()))
    found = {}
    for plan in study.rooms:
        method = method_for(plan, study)
        if method is None or plan.ensemble == 0 or plan.why_no_ensemble:
            continue
        bands = low_bands(plan, method, basis.complete_below_hz)
        placed = placed_room(plan, places.surfaces)
        if bands and not all(at_rest(one, placed) for one in drops.responses.values()):
            found[plan.name] = _ensemble(plan, method, bands, drops, places, basis)
    return found


def _ensemble(
    plan: RoomPlan, method: Method, bands: Mapping[float, float], drops: Drops, places: Places, basis: ModalBasis
) -> Ensemble:
    rng = np.random.default_rng(13)
    placed = placed_room(plan, places.surfaces)
    rows = drawn_drops(list(drops.studies.values()), places, basis, plan.ensemble * SETS, rng)
    window = _machine_runs(method, drops) if rows is None else None
    s = _lines(plan, method, bands, basis, window)
    (surface,) = placed.shapes(basis)
    modes = np.flatnonzero(basis.frequency_hz <= MODES_UP_TO * float(s[-1].imag) / (2 * np.pi))
    found = coupled(basis, modes)
    if found is not None:  # air of cavities, frames of wool and their heat do not move the room's surface
        modes = modes[surface.shapes[:, modes].any(axis=0)]
    surface = SurfaceShapes(surface.points, surface.weights, surface.shapes[:, modes])
    motions, moved = _motions(drops, rows, basis, modes, found, s, plan.ensemble * SETS, window)
    every = BETWEEN_BLOWS if window is None else window[1] - window[0]
    members, corrections = [], []
    for factors in drawn_sides(plan.ensemble, rng):
        room = plan.room.varied(factors)
        assert room is not None, "seen before"
        ways = _ways(room, plan.room, surface, s, len(plan.receivers), rng)
        t60 = {band: t60_of(room.losses, band) for band in method.bands_hz}
        flat = dict.fromkeys(method.bands_hz, 0.0)
        correction = flat if method.correct is None else method.correct(flat, room.volume, t60)
        for receivers in ways:
            members.append(_member(receivers, next(motions), s, bands, method, every))
            corrections.append(list(correction.values()))
    whole = np.full((len(members), len(method.bands_hz)), np.nan)
    whole[:, [method.bands_hz.index(band) for band in bands]] = members
    return Ensemble(whole, np.array(corrections), plan.ensemble, moved)


def _machine_runs(method: Method, drops: Drops) -> tuple[float, float] | None:
    """From when to when a tapping machine's sound is averaged [s] where its blows overlap; None for single blows."""
    study = next(iter(drops.studies.values()))
    return None if method.blows == "heavy" or apart(study) else running(study)


def _lines(
    plan: RoomPlan,
    method: Method,
    bands: Mapping[float, float],
    basis: ModalBasis,
    window: tuple[float, float] | None,
) -> Complexes:
    """Complex frequencies [nf] [1/s] of spectra that last long enough for floor and room to fall silent; of whole turns
    of a machine that runs on, in its window [s], their own lines."""
    lowest, highest = min(bands.values()) / BESIDE, max(bands.values()) * BESIDE
    rated = (basis.frequency_hz >= lowest) & (basis.frequency_hz <= highest) & (basis.omega > 0)
    decay = np.diag(basis.time_damping)[rated].min(initial=np.inf)
    floor = 6 * log(10) / decay if decay > 0 else np.inf
    room = max(t60_of(plan.room.losses, band) for band in bands)
    least, share = LASTS_S[method.blows]
    lasts = least + share * min(max(room, floor if isfinite(floor) else room), LONGEST_S)
    lasts = lasts if window is None else window[1] - window[0]
    heavy = method.blows == "heavy"
    lines = np.arange(0 if heavy else 1, int(np.ceil(highest * 10 ** (0.15 / method.fraction) * lasts)) + 1)
    return np.asarray((FOLDED / lasts if heavy else 0.0) + 2j * np.pi * lines / lasts, dtype=np.complex128)


def _motions(
    drops: Drops,
    rows: list[list[Floats]] | None,
    basis: ModalBasis,
    modes: Integers,
    found: Oscillators | None,
    s: Complexes,
    sets: int,
    window: tuple[float, float] | None,
) -> tuple[Iterator[list[Complexes]], str]:
    """For every set of places, for each drop, spectra of the modal rates of its blows [h, k, nf], one set after the
    other; what is drawn anew. rows : of `drawn_drops`. window : of a machine that runs on [s]."""
    studies = list(drops.studies.values())
    runs = list(drops.responses.values())
    if rows is None:
        stays = [_as_simulated(study, run, modes, s, window) for study, run in zip(studies, runs, strict=True)]
        return repeat(stays, sets), "microphones"
    forces = [
        np.array([blow_spectrum(run, body, s, weighs=weighs(study)) for body in study.bodies])
        for study, run in zip(studies, runs, strict=True)
    ]
    pushes, ends = np.concatenate(forces), np.cumsum([len(force) for force in forces])[:-1]
    motions = (
        list(np.split(driven_rates(basis, modes, found, np.concatenate(of_set), pushes, s), ends)) for of_set in rows
    )
    return motions, "places of the source, microphones"


def _as_simulated(
    study: Study, run: Response, modes: Integers, s: Complexes, window: tuple[float, float] | None
) -> Complexes:
    """Modal rates of the blows of a run where they struck [h, k, nf]: one, one for each hammer of a machine whose blows
    are apart, or that of all blows in the window [s] of one that runs on."""
    if window is not None:
        return simulated_rates(run, modes, s, window[0], window[1] - window[0])[None]
    alone = apart(study)
    starts = {blow.body: blow.t for blow in reversed(run.blows)} if alone else {}
    lasts = alone if alone else run.clock.duration
    return np.stack([simulated_rates(run, modes, s, start, lasts) for start in starts.values() or (0.0,)])


def _ways(
    room: SoundField,
    nominal: SoundField,
    surface: SurfaceShapes,
    s: Complexes,
    receivers: int,
    rng: np.random.Generator,
) -> list[Complexes]:
    """Pressure over modal rates [r, k, nf] in one room at every set of microphones; its ceiling's middle stays where it
    is, above all places."""
    shift = np.asarray(room.middle) - np.asarray(nominal.middle)
    moved = SurfaceShapes(surface.points + shift, surface.weights, surface.shapes)
    spots = drawn_receivers(2.0 * np.asarray(room.middle) * np.array([1.0, 1.0, 0.5]), receivers, SETS, rng)
    ways = room.ways(moved, spots.reshape(-1, 3), s)
    return list(ways.reshape(SETS, receivers, *ways.shape[1:]))


def _member(
    ways: Complexes,
    motion: Sequence[Complexes],
    s: Complexes,
    bands: Mapping[float, float],
    method: Method,
    every: float,
) -> Floats:
    """Level of one set of places [b] [dB], averaged as the standard does. every : time for which one spectrum of a
    tapping machine stands [s]."""
    places = []
    for rates in motion:
        spectra = np.einsum("rkf,hkf->rhf", ways, rates, optimize=True)
        flat = spectra.reshape(-1, len(s))
        if method.blows == "heavy":
            squares = largest_fast(flat, s, bands, method.fraction).reshape(*spectra.shape[:2], -1)
        else:
            squares = exposures(flat, s, bands, method.fraction).reshape(*spectra.shape[:2], -1) / every
        levels = decibels(squares.mean(axis=1) / REFERENCE_SQUARED)
        places.append(energy_average(levels, axis=0))
    return method.average(np.array(places))
