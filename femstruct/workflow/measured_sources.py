"""Measured sources of a study where they stand: the power they send into the structure, and levels in its rooms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isfinite, log10, nan, pi
from typing import Final, NamedTuple

import numpy as np

from acoustics.errors import Advice
from acoustics.levels.bands import band_edges, decibel, is_below, octave_bands, third_octave_bands
from acoustics.levels.rated import Ensemble
from acoustics.levels.sound_levels import REFERENCE_PA
from acoustics.levels.statistical import StatisticalBands
from acoustics.levels.weighting import frequency_weighting
from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError
from femstruct.impact.response import Response
from femstruct.impact.scene import HAMMER_MASS, TAPPING_MACHINE
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import Complex, frf, moves_probe
from femstruct.modal.installed_sources import (
    Contacts,
    band_integrals,
    contact_forces,
    receiver_mobility,
    resonances_with,
)
from femstruct.modal.steady import BandSpectrum, Resonances, resonant_lines
from femstruct.model.probe import Probe
from femstruct.sound.flanking import SurfaceShares, separate_leak, surface_shares
from femstruct.sound.radiated_power import Radiated, energy_advice, radiated_sound
from femstruct.sound.surfaces import moving_modes, pressure_per_force, surface_velocity
from femstruct.study.acting import Covering, InstalledSource, MeasuredSource, SourceLevels
from femstruct.study.asked import RoomPlan, Spot
from femstruct.study.placed_rooms import placed_room
from femstruct.study.study import Study
from femstruct.workflow.bases import Places
from femstruct.workflow.rated_rooms import method_for
from femstruct.workflow.responses import refuse_undamped

# ----------------------------------------------------------------------------------------------------------------------
# What a floor takes of the force of a mass that strikes it: how light it is against hammers and feet.
# ----------------------------------------------------------------------------------------------------------------------

LINES: Final = 12  # in a third octave
# ----------------------------------------------------------------------------------------------------------------------
# Measured sources of a study where they stand.
# ----------------------------------------------------------------------------------------------------------------------

_ALL_HZ: Final = 1e6


class Taken(NamedTuple):
    """The third octave in which a floor takes most of a force [Hz], how much of it [dB], and mobilities there of the
    floor (rms over places and lines) and of the mass [m/(N s)]."""

    band_hz: float
    taken_db: float
    floor: float
    own: float


def floor_force(
    basis: ModalBasis, places: Sequence[Probe], mass: float, band: tuple[float, float], beyond: bool = False
) -> Taken | None:
    """What a floor takes of the force of a mass [kg] at places, in third octaves from one nominal centre to another
    [Hz]; None where modes end below them.

    Parameters
    ----------
    beyond : bool
        Whether to go on above the modes, with a mobility that is real and that of the last octave with modes, as of
        plates: a light floor would else be heavy for want of modes.

    Notes
    -----
    A mass strikes as a source of the mobility 1 / (j omega m) does: on a floor of the mobility Y its force is
    1 / |1 + j omega m Y| of that on a rigid one.
    """
    centres = third_octave_bands(_ALL_HZ, lowest_hz=10.0).items()
    bands = {nominal: centre for nominal, centre in centres if band[0] <= nominal <= band[1]}
    end = basis.complete_below_hz or np.inf
    known = [nominal for nominal, centre in bands.items() if is_below(centre, end, 3)]
    if not known:
        return None
    lines = np.array([np.geomspace(*band_edges(bands[nominal]), LINES) for nominal in known])
    found = np.array([frf(basis, probe, probe, lines.ravel(), "mobility") for probe in places]).reshape(
        -1, *lines.shape
    )
    felt = np.mean(np.abs(1.0 + 2j * pi * lines * mass * found) ** 2, axis=(0, 2))
    size = np.sqrt(np.mean(np.abs(found) ** 2, axis=(0, 2)))
    taken = {one: (10.0 * log10(a), b) for one, a, b in zip(known, felt.tolist(), size.tolist(), strict=True)}
    real = float(found.real[:, -3:].mean())
    for nominal in bands.keys() - taken.keys() if beyond else ():
        taken[nominal] = (10.0 * log10(1.0 + (2 * pi * bands[nominal] * mass * real) ** 2), real)
    worst = max(sorted(taken), key=lambda nominal: taken[nominal][0])
    return Taken(worst, *taken[worst], 1.0 / (2 * pi * bands[worst] * mass))


# ----------------------------------------------------------------------------------------------------------------------
# Measured reductions of coverings: taken off the levels of a tapping machine, on floors like the laboratory's.
# ----------------------------------------------------------------------------------------------------------------------

HEAVY_DB: Final = 1.0  # of the force of hammers that a heavy floor takes at most: single numbers are of whole decibels


def covering_of(study: Study) -> Covering | None:
    """What lies below the tapping machine of a study, None for a bare floor."""
    return next((body.covering for body in study.bodies if body.covering is not None), None)


def apply_reduction(study: Study, levels: Sequence[Mapping[float, float]]) -> list[Mapping[float, float]]:
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


def apply_reduction_to_rooms(
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


def covering_findings(studies: Sequence[Study], places: Places, basis: ModalBasis) -> list[Finding]:
    """What is to be known of a covering on this floor.

    Parameters
    ----------
    basis : ModalBasis
        Damped, with residual vectors for the hammers.

    Raises
    ------
    InputError
        For one that was measured on a floor of another kind, and for one without all rated bands.

    Notes
    -----
    A floor is heavy if it takes less than 1 dB of the force of the hammers (`floor_force`) in every rated band: what a
    covering does to hammers there is what it does in the laboratory.
    """
    covering = covering_of(studies[0])
    if covering is None:
        return []
    hammers_by_target = {one.target: one for study in studies for one in study.bodies if one.source == TAPPING_MACHINE}
    hammers = list(hammers_by_target.values())
    methods = [method for plan in studies[0].rooms if (method := method_for(plan, studies[0])) is not None]
    machine = hammers[0].name.rpartition(".")[0] or hammers[0].name
    missing = [band for one in methods for band in one.bands_hz if band not in covering.reduction_db]
    if missing:
        got = f"a covering without a reduction at {missing[0]:g} Hz"
        raise InputError(f"bodies.{machine}.covering", got=got, expected="one in every band that is rated")
    probes = [places.point(one.target, f"bodies.{one.name}").probe("z") for one in hammers]
    rated = (methods[0].bands_hz[0], methods[0].bands_hz[-1]) if methods else (0.0, 0.0)
    found = floor_force(basis, probes, HAMMER_MASS, rated, beyond=True)
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


# ----------------------------------------------------------------------------------------------------------------------
# Footsteps that were recorded on a stiff plate, on floors that may give way to a foot.
# ----------------------------------------------------------------------------------------------------------------------

FOOT_KG: Final = 4.6  # foot and shank, 6.1 % of 75 kg: D. A. Winter, Biomechanics and Motor Control of Human Movement
STEP_HZ: Final = (20.0, 100.0)  # what a step excites that a floor answers with sound
TAKEN_DB: Final = 1.0


def footstep_findings(study: Study, places: Places, basis: ModalBasis) -> list[Finding]:
    """Recorded footsteps on floors whose mobility is no longer far below that of a foot.

    Parameters
    ----------
    basis : ModalBasis
        Damped.
    """
    found = []
    for load in study.loads:
        if not load.footstep or not isinstance(load.on, Spot):
            continue
        probe = places.point(load.on.name, f"loads.{load.name}").probe("z")
        taken = floor_force(basis, [probe], FOOT_KG, STEP_HZ)
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


PICOWATT: Final = 1e-12
FINENESS: Final = 10.0  # of lines along frequency: mean squares within .6 %, .03 dB
ROOM_LINES: Final = 1.5  # in half the half-power bandwidth of a room mode: trapezia of a resonance within 2e-4
OPEN_DB: Final = 1.0  # of power that the missing phase leaves open and that is told
PLACES: Final = 200  # along frequency, where the reverberation times of rooms are looked at
_HALF_T60: Final = 3.0 * np.log(10.0) / (2.0 * np.pi)  # half the half-power bandwidth of a mode, times T60

RoomFindings = list[tuple[str, Advice | Finding]]


class _Bands(NamedTuple):
    """Bands of a source: nominal centres, exact ones, edges [n, 2] [Hz]."""

    nominal: tuple[float, ...]
    exact: tuple[float, ...]
    edges: Floats


def installed_sources(
    study: Study, places: Places, basis: ModalBasis
) -> tuple[dict[str, InstalledSource], RoomFindings]:
    """What the measured sources of a study do, by name, and what is to be known of it, by source.

    Parameters
    ----------
    basis : ModalBasis
        Damped, with the air of two-way rooms.

    Raises
    ------
    InputError
        For contacts that cannot move, a number of spectra that is not that of the contacts, mobilities that do not
        cover the bands, and modes without damping.
    """
    found: dict[str, InstalledSource] = {}
    findings: RoomFindings = []
    for one in study.sources:
        found[one.name], more = _installed(one, study, places, basis)
        findings += [(one.name, finding) for finding in more]
    return found, findings


def _installed(
    one: MeasuredSource, study: Study, places: Places, basis: ModalBasis
) -> tuple[InstalledSource, list[Advice | Finding]]:
    probes, where = places.contacts(one), f"sources.{one.name}"
    bands = _bands(one)
    known = [
        i for i, centre in enumerate(bands.exact) if is_below(centre, basis.complete_below_hz or np.inf, one.fraction)
    ]
    _refuse(one, probes, bands, known, basis)
    with_receivers = [plan for plan in study.rooms if plan.receivers]
    excited = ", ".join(str(spot) for spot in one.at)
    if not known:
        blank = dict.fromkeys(bands.nominal, nan)
        return InstalledSource(excited, one.what, blank, blank, blank), [*_beyond(one, bands, basis.complete_below_hz)]
    edges = bands.edges[known]
    refuse_undamped(where, (float(edges.min()), float(edges.max())), basis)
    lines = _lines(basis, edges, with_receivers)
    together = resonances_with(basis, probes, one.mobility, lines)
    if len(together.hz):
        lines = _lines(basis, edges, with_receivers, together)
    impedance = one.mobility.impedance(lines)
    contacts = contact_forces(receiver_mobility(basis, probes, lines), impedance, one.mobility.has_phase)
    driven = _Driven(one, contacts, impedance, lines, edges, len(probes), known)
    power = {
        word: _by_band(bands, known, driven.integrated(contacts.power * share), PICOWATT)
        for word, share in (("power_db", 1.0), ("least_db", contacts.least), ("most_db", contacts.most))
    }
    levels: dict[str, SourceLevels] = {}
    findings: list[Advice | Finding] = []
    for plan in with_receivers:
        pressures, advice = _pressures(plan, places, basis, probes, contacts, lines)
        findings += [*advice, *_unrated(one, plan)]
        if plan.complete_below_hz < (basis.complete_below_hz or np.inf):
            findings += _beyond(one, bands, plan.complete_below_hz, plan.name)
        for receiver, p in zip(plan.receivers, pressures, strict=True):
            levels[f"{plan.name}.{receiver.name}"] = _levels(plan, p, driven, bands, basis)
    findings += _beyond(one, bands, basis.complete_below_hz or np.inf)
    return InstalledSource(excited, one.what, **power, levels=levels), [*findings, *_open(one, power)]


class _Driven(NamedTuple):
    """A source with its contact forces along lines [Hz], in bands with edges [n, 2], numbers `known` of all."""

    source: MeasuredSource
    contacts: Contacts
    impedance: Complex
    lines: Floats
    edges: Floats
    contacts_there: int
    known: Sequence[int]

    def integrated(self, values: Floats) -> Floats:
        """Sums over contacts [b] of values per blocked force squared [contacts, nf], in every band."""
        if self.source.what == "free velocity":
            values = values * np.abs(self.impedance) ** 2
        spectra = self.source.spectra if len(self.source.spectra) > 1 else self.source.spectra * self.contacts_there
        found = np.zeros(len(self.edges))
        for one, spectrum in zip(values, spectra, strict=True):
            if isinstance(spectrum, BandSpectrum):
                found += spectrum.psd[list(self.known)] * band_integrals(one, self.lines, self.edges)
            else:
                found += band_integrals(one * spectrum.at(self.lines), self.lines, self.edges)
        return found


def _bands(one: MeasuredSource) -> _Bands:
    """The bands in which a source is known: those it is given in, or third octaves that its lines fill."""
    all_bands = octave_bands(_ALL_HZ) if one.fraction == 1 else third_octave_bands(_ALL_HZ, lowest_hz=10.0)
    first = one.spectra[0]
    if isinstance(first, BandSpectrum):
        nominal = tuple(band for band, _ in first.values)
        return _Bands(nominal, tuple(float(np.sqrt(low * high)) for low, high in first.edges), first.edges)
    low, high = first.band
    inside = {
        band: (centre, band_edges(centre))
        for band, centre in all_bands.items()
        if band_edges(centre)[0] >= low * (1 - 1e-9) and band_edges(centre)[1] <= high * (1 + 1e-9)
    }
    if not inside:
        got = f"lines from {low:g} to {high:g} Hz"
        raise InputError(f"sources.{one.name}", got=got, expected="a third octave or more: its lower to its upper edge")
    edges = np.array([edge for _, edge in inside.values()])
    return _Bands(tuple(inside), tuple(centre for centre, _ in inside.values()), edges)


def _refuse(
    one: MeasuredSource, probes: Sequence[Probe], bands: _Bands, known: Sequence[int], basis: ModalBasis
) -> None:
    where = f"sources.{one.name}"
    for probe, spot in zip(probes, one.at if len(one.at) == len(probes) else one.at[:1] * len(probes), strict=True):
        if not moves_probe(basis, probe):
            expected = "a direction in which the structure can move"
            raise InputError(f"{where}.at", got=f"'{spot}', which no mode moves", expected=expected)
    if len(one.spectra) not in (1, len(probes)):
        got, expected = f"{len(one.spectra)} spectra for {len(probes)} contacts", "one for all, or one for each"
        raise InputError(where, got=got, expected=expected)
    low, high = one.mobility.band
    outside = [bands.nominal[i] for i in known if not (low <= bands.exact[i] <= high)]
    if outside:
        got = f"a mobility from {low:.4g} to {high:.4g} Hz beside a band at {outside[0]:g} Hz"
        raise InputError(where, got=got, expected="a mobility in every band of the source", do="leave out the band")


def _lines(basis: ModalBasis, edges: Floats, rooms: Sequence[RoomPlan], together: Resonances | None = None) -> Floats:
    """Lines along frequency that follow the resonances of the structure and are dense enough for those of rooms.

    Parameters
    ----------
    together : Resonances | None
        Of the structure with the source on it.
    """
    low, high = float(edges.min()), float(edges.max())
    also = np.unique(edges)
    if rooms:
        # as many as the slowest room needs there: losses of the air leave low modes far narrower than high ones
        hz = np.geomspace(low, high, PLACES)
        times = np.array([[plan.room.t60(f) for f in hz.tolist()] for plan in rooms])
        a_hertz = ROOM_LINES / _HALF_T60 * np.where(np.isfinite(times), times, 0.0).max(axis=0)
        lines = np.append(0.0, np.cumsum(0.5 * (a_hertz[1:] + a_hertz[:-1]) * np.diff(hz)))
        also = np.append(also, np.interp(np.arange(np.ceil(lines[-1]) + 1), lines, hz))
    return resonant_lines(basis, (low, high), tuple(also.tolist()), FINENESS, together)


def _pressures(
    plan: RoomPlan,
    places: Places,
    basis: ModalBasis,
    probes: Sequence[Probe],
    contacts: Contacts,
    lines: Floats,
) -> tuple[Complex, tuple[Advice, ...]]:
    """Pressures per blocked force of each contact [receivers, contacts, nf], and advice."""
    room = placed_room(plan, places.surfaces)
    per_force, advised = [], dict[str, Advice]()
    for probe in probes:
        p, advice = pressure_per_force(basis, probe, room, plan.receivers, lines)
        per_force.append(p)
        advised |= {one.code: one for one in advice}
    found: Complex = np.einsum("arf,aif->rif", np.array(per_force), contacts.forces)
    return found, tuple(advised.values())


def _levels(plan: RoomPlan, p: Complex, driven: _Driven, bands: _Bands, basis: ModalBasis) -> SourceLevels:
    """Levels at one receiver of pressures per blocked force [contacts, nf]."""
    end = plan.heard_to_hz(basis.complete_below_hz or np.inf)
    squares = np.abs(p) ** 2
    weighted = np.abs(frequency_weighting(driven.lines, "A")) ** 2
    complete = [is_below(bands.exact[i], end, driven.source.fraction) for i in driven.known]
    by_band = _by_band(bands, driven.known, np.where(complete, driven.integrated(squares), nan), REFERENCE_PA**2)
    total = float(driven.integrated(squares * weighted)[complete].sum())
    return SourceLevels(by_band, decibel(total / REFERENCE_PA**2))


def _by_band(bands: _Bands, known: Sequence[int], values: Floats, reference: float) -> dict[float, float]:
    """Levels by band, nan of those that are not known."""
    found = dict.fromkeys(bands.nominal, nan)
    for i, value in zip(known, values.tolist(), strict=True):
        found[bands.nominal[i]] = decibel(value / reference)
    return found


def _beyond(one: MeasuredSource, bands: _Bands, end_hz: float, room: str = "") -> list[Finding]:
    """What modes that end at a frequency leave blank of a source: of the structure, or of a room by name."""
    blank = [i for i, centre in enumerate(bands.exact) if not is_below(centre, end_hz, one.fraction)]
    if not blank:
        return []
    first, top = bands.nominal[blank[0]], float(bands.edges.max())
    levels = "its A-weighted levels are of those below"
    message = f"the modes end at {end_hz:.4g} Hz: its bands from {first:g} Hz on are blank, and {levels}"
    if room:
        message = (
            f"the modes of {room} end at {end_hz:.4g} Hz: there its bands from {first:g} Hz on are blank, and {levels}"
        )
    return [
        Finding(
            "source-beyond-modes",
            f"{message}. Ask for modes up to {top:.4g} Hz",
            {"complete_below_hz": end_hz, "first_blank_hz": first, "needed_hz": top},
        )
    ]


def _open(one: MeasuredSource, power: Mapping[str, Mapping[float, float]]) -> list[Finding]:
    """How much of the power the missing phase of the source's mobility leaves open."""
    if one.mobility.has_phase:
        return []
    middle, least, most = (power[word] for word in ("power_db", "least_db", "most_db"))
    ranges = {band: most[band] - least[band] for band in middle if isfinite(middle[band])}
    worst = max(ranges, key=lambda band: ranges[band])
    if ranges[worst] <= OPEN_DB:
        return []
    lower, higher = middle[worst] - least[worst], most[worst] - middle[worst]
    return [
        Finding(
            "source-phase-unknown",
            f"its mobility is given without phase: at {worst:g} Hz its power may be {lower:.1f} dB lower "
            f"to {higher:.1f} dB higher. Give its complex mobility",
            {"band_hz": worst, "lower_db": lower, "higher_db": higher},
        )
    ]


def _unrated(one: MeasuredSource, plan: RoomPlan) -> list[Finding]:
    if not plan.levels:
        return []
    return [
        Finding(
            "source-unrated",
            f"{plan.name}: {' and '.join(plan.levels)} rate the blows of standard sources; the levels of "
            "a measured source stand by themselves, without a single number of these standards",
        )
    ]


# ----------------------------------------------------------------------------------------------------------------------
# Sound energies: what the surfaces of a study send into the open in a record, and which gives what to a room.
# ----------------------------------------------------------------------------------------------------------------------

FEWEST: Final = 2  # surfaces of a room among which there is something to share out


def sound_energies(
    study: Study, places: Places, response: Response
) -> tuple[dict[str, Radiated], list[tuple[str, Advice | Finding]]]:
    """What was radiated into every half space, by name, and what is to be known of it, by name."""
    radiated: dict[str, Radiated] = {}
    findings: list[tuple[str, Advice | Finding]] = []
    for plan in study.rooms:
        if plan.room.open_air is not None:
            room = placed_room(plan, places.surfaces)
            radiated[plan.name], found = radiated_sound(response, room, plan.directivity)
            findings += [(plan.name, one) for one in found]
    everywhere = sum(one.energy.energy_j for one in radiated.values())
    findings += [(name, one) for one in energy_advice(everywhere, response.ledger.end.lost_modes) for name in radiated]
    return radiated, findings


def shares_by_surface(study: Study, places: Places, response: Response, end_hz: float) -> dict[str, SurfaceShares]:
    """What each surface gives the air of every closed room that several move, by name.

    Parameters
    ----------
    end_hz : float
        Where modes end.
    """
    found: dict[str, SurfaceShares] = {}
    for plan in study.rooms:
        if len(plan.moved) < FEWEST or plan.room.open_air is not None:
            continue
        room = placed_room(plan, places.surfaces)
        motion = surface_velocity(response, room)
        if (volume := response.basis.volumes.get(plan.name)) is not None:
            area = sum(one.area for one in motion)
            motion = separate_leak(motion, volume[moving_modes([response], room)] / area)
        shares = surface_shares(motion, room, plan.receivers, plan.heard_to_hz(end_hz))
        found |= {} if shares is None else {plan.name: shares}
    return found
