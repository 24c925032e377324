"""Rated levels that single runs do not give: statistics above the modes, rooms and places of a laboratory below."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import repeat
from math import inf, isfinite, log
from typing import Final

import numpy as np

from acoustics.arrays import Complexes
from acoustics.fields.sound_field import SoundField
from acoustics.levels.bands import band_edges, decibels, nominal_bands, passes_below
from acoustics.levels.rated import Ensemble, RatedRoom
from acoustics.levels.sound_levels import REFERENCE_SQUARED, exposures, largest_fast
from acoustics.levels.standards import Method, energy_average
from acoustics.levels.statistical import (
    FEWEST,
    MANY,
    Agreement,
    DiffuseRoom,
    RadiatingPlate,
    StatisticalBands,
    expected_scatter,
    largest_levels,
    steady_levels,
)
from acoustics.losses import single_modes_hz, t60_of
from acoustics.source import SurfaceShapes
from femstruct.arrays import Floats, Integers
from femstruct.errors import Finding
from femstruct.impact.response import Response
from femstruct.impact.scene import BETWEEN_BLOWS, Body
from femstruct.laws.law import Law
from femstruct.modal.basis import ModalBasis
from femstruct.modal.oscillators import Oscillators
from femstruct.model.lay_ups import Smeared, section_of
from femstruct.model.structure import PlaceOn, Structure, Support, SurfaceOn
from femstruct.parts.plate import Plate
from femstruct.parts.slab import Slab
from femstruct.sound.floor_blows import (
    blow_exposures,
    blow_spectrum,
    coupled_oscillators,
    driven_rates,
    infinite_plate,
    loss_law,
    simulated_rates,
)
from femstruct.sound.surfaces import is_at_rest
from femstruct.study.acting import PlacedBody
from femstruct.study.asked import RoomPlan
from femstruct.study.placed_rooms import placed_room
from femstruct.study.study import Study
from femstruct.workflow.bases import Places, weighs
from femstruct.workflow.rated_rooms import averaging_window, blow_interval, method_for

# ----------------------------------------------------------------------------------------------------------------------
# Floors that statistical energies are for: one bare plate under standard blows; of others, why not.
# ----------------------------------------------------------------------------------------------------------------------

HAMMER_HEAD_M: Final = 0.015  # radius of a tapping machine's hammer, ISO 10140-5 annex E
ASKEW: Final = 1e-6  # of the rigidities: coupling of bending and twist of layers at an angle


def bare_plate(plan: RoomPlan, study: Study, patch_m: float = 0.0) -> RadiatingPlate | str:
    """The plate above a room whose levels can be had by statistical energies; a reason where there is none.

    Parameters
    ----------
    patch_m : float
        Radius of the disc that is struck [m].
    """
    structure = study.structure
    reason = _not_bare(structure) or _other_excitation(study) or _other_air(plan)
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
    return RadiatingPlate(infinite_plate(section), part.size[0] * part.size[1], sides, loss, patch_m)


def alike(plate: RadiatingPlate, study: Study) -> RadiatingPlate:
    """The plate by the theory that its modes are of: plates are thin, slabs shear."""
    thin = isinstance(study.structure, Structure) and any(isinstance(part, Plate) for part in study.structure.parts)
    whole = plate.plate.thin if thin else plate.plate
    return RadiatingPlate(whole, plate.area, plate.sides, plate.loss_factor, plate.patch_m)


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


def _other_excitation(study: Study) -> str:
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


# ----------------------------------------------------------------------------------------------------------------------
# Places of source and microphones, and sides of rooms, drawn as a laboratory would choose them.
# ----------------------------------------------------------------------------------------------------------------------

SIDES: Final = 0.05  # by which the sides of a room differ, to each direction
FROM_EDGES_M: Final = 0.5  # of the floor and of the room's walls, ISO 16283-2; ...
FROM_CEILING_M: Final = 1.0
AT_MOST: Final = 0.2  # ... of a side that is short
NEAR: Final = 1e-6  # of a part's size, by which a place may be off it


def draw_sides(rooms: int, rng: np.random.Generator) -> Floats:
    """Factors [rooms, 3] of a room's sides, evenly spread over +-5 % (a Latin hypercube).

    >>> factors = draw_sides(10, np.random.default_rng(1))
    >>> bool(((factors > 0.95) & (factors < 1.05)).all()), factors.mean(axis=0).round(2).tolist()
    (True, [1.0, 1.0, 1.0])
    """
    ranks = np.array([rng.permutation(rooms) for _ in range(3)]).T
    return np.asarray(1.0 - SIDES + 2.0 * SIDES * (ranks + rng.random((rooms, 3))) / rooms)


def draw_receivers(size: Floats, receivers: int, sets: int, rng: np.random.Generator) -> Floats:
    """Places of microphones [sets, receivers, 3] in a room of a size [3] [m]: 0.5 m from its walls and floor, 1 m from
    its ceiling; the receivers of all sets are at the same heights.

    >>> spots = draw_receivers(np.array([5.0, 4.0, 2.5]), 4, 6, np.random.default_rng(1))
    >>> spots.shape, bool((spots > 0.5).all()), bool((spots < [4.5, 3.5, 1.5]).all())
    ((6, 4, 3), True, True)
    """
    low = np.minimum(FROM_EDGES_M, AT_MOST * size)
    high = size - np.minimum(np.array([FROM_EDGES_M, FROM_EDGES_M, FROM_CEILING_M]), 2 * AT_MOST * size)
    spots = rng.random((sets, receivers, 3))
    spots[:, :, 2] = spots[0, :, 2]
    return np.asarray(low + spots * (high - low))


def draw_drops(
    studies: Sequence[Study], places: Places, basis: ModalBasis, sets: int, rng: np.random.Generator
) -> list[list[Floats]] | None:
    """For each set, for each drop, rows [h, k] of all modes where its bodies strike a floor: each drop moved as it is,
    0.5 m from the edges of its rectangle; None where something else than these bodies acts, or the floor is no
    rectangle."""
    targets = [_impact_places(study) for study in studies]
    known = [one for one in targets if one is not None]
    if len(known) < len(targets):
        return None
    found: list[list[Floats]] = []
    for _ in range(sets):
        rows = []
        for place, part, at in known:
            size, half = np.array(part.size), np.ptp(at, axis=0) / 2.0
            edge = np.minimum(FROM_EDGES_M, AT_MOST * size) + half
            if (2.0 * edge >= size).any():
                return None
            centre = edge + rng.random(2) * (size - 2.0 * edge)
            moved = at - (at.max(axis=0) + at.min(axis=0)) / 2.0 + centre
            rows.append(_rows(place, part, moved, places, basis))
        found.append(rows)
    return found


def _rows(place: PlaceOn, part: Plate | Slab, at: Floats, places: Places, basis: ModalBasis) -> Floats:
    """Motion across the floor in every mode [h, k] at places [h, 2] of a part."""
    near = NEAR * max(part.size)
    points = [
        places.parts[part.name].point(place.name, replace(place, at=(tuple(one.tolist()),)), one, near) for one in at
    ]
    return np.array([one.probe("z").of(basis.shapes) for one in points])


def _impact_places(study: Study) -> tuple[PlaceOn, Plate | Slab, Floats] | None:
    """Which points of which rectangular floor a source strikes, and where [h, 2]; None for other floors or blows."""
    structure = study.structure
    if study.links or study.contacts or study.loads or study.walks or not isinstance(structure, Structure):
        return None
    own = [body for body in study.bodies if body.source and body.law is not None]
    if not own or len(own) < len(study.bodies) or any(body.side != "above" for body in own):
        return None
    parts = {part.name: part for part in structure.parts}
    at, found = [], None
    for body in own:
        name, _, number = body.target.rpartition(".")
        place = next((one for one in structure.points if one.name in (body.target, name)), None)
        part = None if place is None else parts.get(place.on)
        if place is None or place.named or not isinstance(part, Plate | Slab) or not _rectangular(part):
            return None
        found = place, part
        at.append(place.at[int(number) - 1 if place.name != body.target else 0])
    return None if found is None else (*found, np.array(at, dtype=np.float64))


def _rectangular(part: Plate | Slab) -> bool:
    """Whether its places run from its corner over a whole rectangle."""
    if isinstance(part, Plate):
        return True
    return len(part.outline) == 4 and not part.holes and min(min(one) for one in part.outline) == 0.0


# ----------------------------------------------------------------------------------------------------------------------
# What is to be known of low bands: those of a room and places that are far from what others would have.
# ----------------------------------------------------------------------------------------------------------------------

BEYOND_DB: Final = 1.0  # by which a band may be outside the interval before it is said


def ensemble_findings(rated: RatedRoom) -> tuple[Finding, ...]:
    """A finding of one room where single bands of it lie outside the interval of rooms and places like its own."""
    if rated.ensemble is None:
        return ()
    off = {}
    for band, level, one in zip(rated.bands_hz, rated.bands_db.values(), rated.intervals, strict=True):
        beyond = max(level - one.high, one.low - level)
        if beyond > BEYOND_DB:
            off[band] = level - one.mean
    if not off:
        return ()
    worst = max(off, key=lambda band: abs(off[band]))
    listed = ", ".join(f"{band:g} Hz by {above:+.1f} dB" for band, above in off.items())
    return (
        Finding(
            "band-of-one-room",
            f"levels of this room and these places differ from the mean of {rated.ensemble.rooms} rooms with sides "
            f"within 5 % and of other {rated.ensemble.moved}: {listed}. Nine measurements of ten are nearer to that "
            "mean: use it",
            {"bands": len(off), "worst_hz": worst, "worst_db": off[worst], "rooms": rated.ensemble.rooms},
        ),
    )


# ----------------------------------------------------------------------------------------------------------------------
# Low bands of rated rooms over an ensemble: rooms of nearly one size, places of source and microphones drawn anew.
#
# Only rooms are evaluated again: with one-way coupling the floor's modes and the force of a blow stay what they are.
# ----------------------------------------------------------------------------------------------------------------------

SETS: Final = 8  # of places in each room: with four, intervals of single bands scatter by 12 to 19 %, so by 7 to 12 %
HIGHEST_HZ: Final = 400.0  # of small rooms, too
BESIDE: Final = 1.4  # of the last band's centre: lines that its filter lets through
MODES_UP_TO: Final = 1.6  # of the highest line: modes above it hardly move at these
LASTS_S: Final = {"heavy": (0.3, 0.3), "tapping": (0.3, 0.6)}  # of the records: and of the longest reverberation time
LONGEST_DECAY_S: Final = 4.0  # reverberation time that is looked at
FOLDED: Final = 7.0  # exponent by which what comes after is smaller


@dataclass(frozen=True, eq=False)
class Drops:
    """The drops of a case: their studies and what came of them, by place."""

    studies: Mapping[str, Study]
    responses: Mapping[str, Response]


def low_bands(plan: RoomPlan, method: Method, end_hz: float) -> dict[float, float]:
    """Rated bands {nominal: exact centre} [Hz] of modes below an end, in which modes of the room stand alone."""
    every = nominal_bands(method.fraction)
    centres = {band: every[band] for band in method.bands_hz}
    t60 = t60_of(plan.room.losses, method.bands_hz[0])
    top = min(HIGHEST_HZ * 10**0.01, single_modes_hz(t60, plan.room.volume)) if isfinite(t60) else 0.0
    end = plan.heard_to_hz(end_hz)
    return {b: centre for b, centre in centres.items() if centre <= top and passes_below(centre, end, method.fraction)}


def room_ensembles(drops: Drops, places: Places, basis: ModalBasis) -> dict[str, Ensemble]:
    """Of every rated room of a case that can have one, by name.

    Parameters
    ----------
    basis : ModalBasis
        Damped, without the rooms' air.
    """
    study = next(iter(drops.studies.values()))
    found = {}
    for plan in study.rooms:
        method = method_for(plan, study)
        if method is None or plan.ensemble == 0 or plan.why_no_ensemble:
            continue
        bands = low_bands(plan, method, basis.complete_below_hz)
        placed = placed_room(plan, places.surfaces)
        if bands and not all(is_at_rest(one, placed) for one in drops.responses.values()):
            found[plan.name] = _ensemble(plan, method, bands, drops, places, basis)
    return found


def _ensemble(
    plan: RoomPlan, method: Method, bands: Mapping[float, float], drops: Drops, places: Places, basis: ModalBasis
) -> Ensemble:
    rng = np.random.default_rng(13)
    placed = placed_room(plan, places.surfaces)
    rows = draw_drops(list(drops.studies.values()), places, basis, plan.ensemble * SETS, rng)
    window = _machine_runs(method, drops) if rows is None else None
    s = _lines(plan, method, bands, basis, window)
    (surface,) = placed.shapes(basis)
    modes = np.flatnonzero(basis.frequency_hz <= MODES_UP_TO * float(s[-1].imag) / (2 * np.pi))
    found = coupled_oscillators(basis, modes)
    if found is not None:  # air of cavities, frames of wool and their heat do not move the room's surface
        modes = modes[surface.shapes[:, modes].any(axis=0)]
    surface = SurfaceShapes(surface.points, surface.weights, surface.shapes[:, modes])
    motions, moved = _motions(
        drops, rows, basis=basis, modes=modes, found=found, s=s, sets=plan.ensemble * SETS, window=window
    )
    every = BETWEEN_BLOWS if window is None else window[1] - window[0]
    members, corrections = [], []
    for factors in draw_sides(plan.ensemble, rng):
        room = plan.room.varied(factors)
        assert room is not None, "seen before"
        transfers = _room_transfers(room, plan.room, surface, s, len(plan.receivers), rng)
        t60 = {band: t60_of(room.losses, band) for band in method.bands_hz}
        flat = dict.fromkeys(method.bands_hz, 0.0)
        correction = flat if method.correct is None else method.correct(flat, room.volume, t60)
        for receivers in transfers:
            members.append(_member(receivers, next(motions), s, bands, method, every))
            corrections.append(list(correction.values()))
    whole = np.full((len(members), len(method.bands_hz)), np.nan)
    whole[:, [method.bands_hz.index(band) for band in bands]] = members
    return Ensemble(whole, np.array(corrections), plan.ensemble, moved)


def _machine_runs(method: Method, drops: Drops) -> tuple[float, float] | None:
    """From when to when a tapping machine's sound is averaged [s] where its blows overlap; None for single blows."""
    study = next(iter(drops.studies.values()))
    return None if method.blows == "heavy" or blow_interval(study) else averaging_window(study)


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
    lasts = least + share * min(max(room, floor if isfinite(floor) else room), LONGEST_DECAY_S)
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
    other; what is drawn anew.

    Parameters
    ----------
    rows : list[list[Floats]] | None
        Of `draw_drops`.
    window : tuple[float, float] | None
        Of a machine that runs on [s].
    """
    studies = list(drops.studies.values())
    runs = list(drops.responses.values())
    if rows is None:
        stays = [_as_simulated(study, run, modes, s, window) for study, run in zip(studies, runs, strict=True)]
        return repeat(stays, sets), "microphones"
    forces = [
        np.array([blow_spectrum(run, _moving(body), s, weighs=weighs(study)) for body in study.bodies])
        for study, run in zip(studies, runs, strict=True)
    ]
    pushes, ends = np.concatenate(forces), np.cumsum([len(force) for force in forces])[:-1]
    motions = (
        list(np.split(driven_rates(basis, modes, found, np.concatenate(of_set), pushes, s), ends)) for of_set in rows
    )
    return motions, "places of the source, microphones"


def _moving(body: PlacedBody) -> Body:
    """A body of a study as it begins to move."""
    towards = 1.0 if body.side in ("below", "before") else -1.0
    return Body(body.name, body.mass, towards * body.speed)


def _as_simulated(
    study: Study, run: Response, modes: Integers, s: Complexes, window: tuple[float, float] | None
) -> Complexes:
    """Modal rates of the blows of a run where they struck [h, k, nf]: one, one for each hammer of a machine whose blows
    are apart, or that of all blows in the window [s] of one that runs on."""
    if window is not None:
        return simulated_rates(run, modes, s, window[0], window[1] - window[0])[None]
    alone = blow_interval(study)
    starts = {blow.body: blow.t for blow in reversed(run.blows)} if alone else {}
    lasts = alone if alone else run.clock.duration
    return np.stack([simulated_rates(run, modes, s, start, lasts) for start in starts.values() or (0.0,)])


def _room_transfers(
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
    spots = draw_receivers(2.0 * np.asarray(room.middle) * np.array([1.0, 1.0, 0.5]), receivers, SETS, rng)
    transfers = room.transfers(moved, spots.reshape(-1, 3), s)
    return list(transfers.reshape(SETS, receivers, *transfers.shape[1:]))


def _member(
    transfers: Complexes,
    motion: Sequence[Complexes],
    s: Complexes,
    bands: Mapping[float, float],
    method: Method,
    every: float,
) -> Floats:
    """Level of one set of places [b] [dB], averaged as the standard does.

    Parameters
    ----------
    every : float
        Time for which one spectrum of a tapping machine stands [s].
    """
    places = []
    for rates in motion:
        spectra = np.einsum("rkf,hkf->rhf", transfers, rates, optimize=True)
        flat = spectra.reshape(-1, len(s))
        if method.blows == "heavy":
            squares = largest_fast(flat, s, bands, method.fraction).reshape(*spectra.shape[:2], -1)
        else:
            squares = exposures(flat, s, bands, method.fraction).reshape(*spectra.shape[:2], -1) / every
        levels = decibels(squares.mean(axis=1) / REFERENCE_SQUARED)
        places.append(energy_average(levels, axis=0))
    return method.average(np.array(places))


# ----------------------------------------------------------------------------------------------------------------------
# What is to be known of rated bands that are statistical, and of modes and statistics that differ.
# ----------------------------------------------------------------------------------------------------------------------


def statistical_findings(rated: RatedRoom) -> tuple[Finding, ...]:
    """Findings of one room: which of its bands are statistical, and how those of its modes agree with them."""
    if rated.statistical is None:
        return ()
    beside = rated.agreement
    return (*_filled(rated, beside), *(() if beside is None or beside.agree else (_differs(beside),)))


def _filled(rated: RatedRoom, beside: Agreement | None) -> tuple[Finding, ...]:
    """Bands beyond the modes, with what is to be expected of one floor."""
    bands, statistical = rated.statistical_hz, rated.statistical
    if not bands or statistical is None:
        return ()
    scatter = [statistical.scatter_db[band] for band in bands]
    few = [band for band in bands if statistical.modes[band] < MANY]
    remark = f"; the plate has fewer than {MANY:g} modes in those up to {max(few):g} Hz" if few else ""
    agreed = "no comparison of modes and statistics is possible: no band has both with enough modes"
    if beside is not None:
        agreed = f"where modes and statistics can be compared: {_beside(beside)}"
    return (
        Finding(
            "statistical-bands",
            f"the rated {rated.method.bands}s {bands_in_words(bands)} lie beyond the modes and are from statistical "
            f"energies of plate and room: a single floor differs from them by {min(scatter):.1f} to "
            f"{max(scatter):.1f} dB (standard deviation){remark}; {agreed}",
            {
                "bands": len(bands),
                "first_hz": bands[0],
                "scatter_db": max(scatter),
                "few_modes": len(few),
            },
        ),
    )


def _differs(beside: Agreement) -> Finding:
    return Finding(
        "statistical-disagrees",
        f"levels of modes and of statistical energies differ by more than scatter explains: {_beside(beside)}; "
        f"{beside.allowed_db:.1f} dB is allowed. Check the mesh, the loss factor and the reverberation time",
        {"mean_db": beside.mean_db, "allowed_db": beside.allowed_db, "bands": beside.bands},
    )


def _beside(beside: Agreement) -> str:
    scatter = f", standard deviation {beside.deviation_db:.1f} dB" if isfinite(beside.deviation_db) else ""
    bands = "1 band" if beside.bands == 1 else f"{beside.bands} bands"
    return f"modal levels are {beside.mean_db:+.1f} dB above statistical ones on the mean of {bands}{scatter}"


def bands_in_words(bands: Sequence[float]) -> str:
    """Bands in words.

    >>> bands_in_words((250.0, 315.0, 400.0)), bands_in_words((500.0,))
    ('250 to 400 Hz', '500 Hz')
    """
    return f"{bands[0]:g} to {bands[-1]:g} Hz" if len(bands) > 1 else f"{bands[0]:g} Hz"


# ----------------------------------------------------------------------------------------------------------------------
# Rated bands by statistical energies, of every room under one bare plate.
# ----------------------------------------------------------------------------------------------------------------------


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
    """Of every rated room under a bare plate, by name.

    Parameters
    ----------
    drops : int
        At how many places the source strikes.
    """
    found = {plan.name: statistical_bands(plan, study, drops) for plan in study.rooms}
    return {name: one for name, one in found.items() if one is not None}


def statistical_bands(plan: RoomPlan, study: Study, drops: int) -> StatisticalBands | None:
    """Levels of a rated room by statistical energies, in all bands that its standards have; None for other floors.

    Parameters
    ----------
    drops : int
        At how many places the source strikes.

    Notes
    -----
    Blows of a tapping machine are taken as uncorrelated, ten a second, whatever the study's interval: lines of blows at
    regular intervals have the same mean.
    """
    method, plate = method_for(plan, study), statistical_plate(plan, study)
    if method is None or isinstance(plate, str):
        return None
    thirds = _thirds(method)
    exposure = blow_exposures(_blows(study), plate.plate, thirds)
    room = DiffuseRoom(plan.room.volume, plan.room.all_walls_area, plan.room.losses, plan.room.air)
    levels, beside = (_levels(one, room, exposure, method) for one in (plate, alike(plate, study)))
    modes, (centres, width) = _modes(alike(plate, study), method), _widths(method)
    t60 = np.array([t60_of(room.losses, centre) for centre in centres.tolist()])
    scatter = expected_scatter(np.array(list(modes.values())), width, t60, drops, len(plan.receivers))
    return StatisticalBands(levels, beside, modes, dict(zip(method.bands_hz, scatter.tolist(), strict=True)))


def _blows(study: Study) -> list[tuple[float, float, Law]]:
    """Mass [kg], speed [m/s] and law of what strikes, each with a law of its own (`_other_excitation`)."""
    return [(body.mass, body.speed, body.law) for body in study.bodies if body.law is not None]


def _modes(plate: RadiatingPlate, method: Method) -> dict[float, float]:
    """How many modes of a plate are in each band of a method."""
    centres, width = _widths(method)
    found = plate.plate.modes_per_hz(centres, plate.area) * width
    return dict(zip(method.bands_hz, found.tolist(), strict=True))


def _widths(method: Method) -> tuple[Floats, Floats]:
    """Exact centres and widths of the bands of a method [Hz]."""
    every = nominal_bands(method.fraction)
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
    thirds = list(nominal_bands(3))
    return {band: thirds[thirds.index(band) - 1 : thirds.index(band) + 2] for band in method.bands_hz}
