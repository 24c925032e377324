"""Measured sources of a study where they stand: the power they send into the structure, and levels in its rooms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite, nan
from typing import Final, NamedTuple

import numpy as np

from acoustics.errors import Advice
from acoustics.levels.bands import band_edges, octave_bands, third_octave_bands
from acoustics.levels.decibels import decibel
from acoustics.levels.ending import shown
from acoustics.levels.sound_levels import REFERENCE_PA
from acoustics.levels.weighting import frequency_weighting
from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import moves
from femstruct.modal.steady.band_spectrum import BandSpectrum
from femstruct.modal.steady.installed import Contacts, band_integrals, contact_forces, receiver_mobility
from femstruct.modal.steady.resonances import Resonances
from femstruct.modal.steady.resonant_lines import resonant_lines
from femstruct.modal.steady.with_source import resonances_with
from femstruct.modal.superposition import Complex
from femstruct.model.probe import Probe
from femstruct.sound.surface import pressure_per_force
from femstruct.study.asked import RoomPlan
from femstruct.study.measured_source import InstalledSource, MeasuredSource, SourceLevels
from femstruct.study.room_surfaces import placed_room
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.vibrations import refuse_undamped

PICOWATT: Final = 1e-12
FINENESS: Final = 10.0  # of lines along frequency: mean squares within .6 %, .03 dB
ROOM_LINES: Final = 1.5  # in half the half-power bandwidth of a room mode: trapezia of a resonance within 2e-4
OPEN_DB: Final = 1.0  # of power that the missing phase leaves open and that is told
PLACES: Final = 200  # along frequency, where the reverberation times of rooms are looked at
_HALF_T60: Final = 3.0 * np.log(10.0) / (2.0 * np.pi)  # half the half-power bandwidth of a mode, times T60
_ALL_HZ: Final = 1e6  # a sampling that has all bands

Told = list[tuple[str, Advice | Finding]]


class _Bands(NamedTuple):
    """Bands of a source: nominal centres, exact ones, edges [n, 2] [Hz]."""

    nominal: tuple[float, ...]
    exact: tuple[float, ...]
    edges: Floats


def installed_sources(study: Study, places: Places, basis: ModalBasis) -> tuple[dict[str, InstalledSource], Told]:
    """What the measured sources of a study do, by name, and what is to be known of it, by source.

    basis : damped, with the air of two-way rooms.

    Raises InputError for contacts that cannot move, a number of spectra that is not that of the contacts, mobilities
    that do not cover the bands, and modes without damping.
    """
    found: dict[str, InstalledSource] = {}
    told: Told = []
    for one in study.sources:
        found[one.name], more = _installed(one, study, places, basis)
        told += [(one.name, finding) for finding in more]
    return found, told


def _installed(
    one: MeasuredSource, study: Study, places: Places, basis: ModalBasis
) -> tuple[InstalledSource, list[Advice | Finding]]:
    probes, where = places.contacts(one), f"sources.{one.name}"
    bands = _bands(one)
    known = [
        i for i, centre in enumerate(bands.exact) if shown(centre, basis.complete_below_hz or np.inf, one.fraction)
    ]
    _refuse(one, probes, bands, known, basis)
    heard = [plan for plan in study.rooms if plan.receivers]
    excited = ", ".join(str(spot) for spot in one.at)
    if not known:
        blank = dict.fromkeys(bands.nominal, nan)
        return InstalledSource(excited, one.what, blank, blank, blank), [*_beyond(one, bands, basis.complete_below_hz)]
    edges = bands.edges[known]
    refuse_undamped(where, (float(edges.min()), float(edges.max())), basis)
    lines = _lines(basis, edges, heard)
    together = resonances_with(basis, probes, one.mobility, lines)
    if len(together.hz):
        lines = _lines(basis, edges, heard, together)
    impedance = one.mobility.impedance(lines)
    contacts = contact_forces(receiver_mobility(basis, probes, lines), impedance, one.mobility.has_phase)
    driven = _Driven(one, contacts, impedance, lines, edges, len(probes), known)
    power = {
        word: _by_band(bands, known, driven.integrated(contacts.power * share), PICOWATT)
        for word, share in (("power_db", 1.0), ("least_db", contacts.least), ("most_db", contacts.most))
    }
    levels: dict[str, SourceLevels] = {}
    told: list[Advice | Finding] = []
    for plan in heard:
        pressures, advice = _pressures(plan, places, basis, probes, contacts, lines)
        told += [*advice, *_unrated(one, plan)]
        if plan.complete_below_hz < (basis.complete_below_hz or np.inf):
            told += _beyond(one, bands, plan.complete_below_hz, plan.name)
        for receiver, p in zip(plan.receivers, pressures, strict=True):
            levels[f"{plan.name}.{receiver.name}"] = _levels(plan, p, driven, bands, basis)
    told += _beyond(one, bands, basis.complete_below_hz or np.inf)
    return InstalledSource(excited, one.what, **power, levels=levels), [*told, *_open(one, power)]


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
        if not moves(basis, probe):
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
    together : of the structure with the source on it."""
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
    per_force, told = [], dict[str, Advice]()
    for probe in probes:
        p, advice = pressure_per_force(basis, probe, room, plan.receivers, lines)
        per_force.append(p)
        told |= {one.code: one for one in advice}
    found: Complex = np.einsum("arf,aif->rif", np.array(per_force), contacts.forces)
    return found, tuple(told.values())


def _levels(plan: RoomPlan, p: Complex, driven: _Driven, bands: _Bands, basis: ModalBasis) -> SourceLevels:
    """Levels at one receiver of pressures per blocked force [contacts, nf]."""
    end = plan.heard_to_hz(basis.complete_below_hz or np.inf)
    squares = np.abs(p) ** 2
    weighted = np.abs(frequency_weighting(driven.lines, "A")) ** 2
    complete = [shown(bands.exact[i], end, driven.source.fraction) for i in driven.known]
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
    blank = [i for i, centre in enumerate(bands.exact) if not shown(centre, end_hz, one.fraction)]
    if not blank:
        return []
    first, top = bands.nominal[blank[0]], float(bands.edges.max())
    levels = "its A-weighted levels are of those below"
    told = f"the modes end at {end_hz:.4g} Hz: its bands from {first:g} Hz on are blank, and {levels}"
    if room:
        told = (
            f"the modes of {room} end at {end_hz:.4g} Hz: there its bands from {first:g} Hz on are blank, and {levels}"
        )
    return [
        Finding(
            "source-beyond-modes",
            f"{told}. Ask for modes up to {top:.4g} Hz",
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
