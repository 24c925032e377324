"""What a study records: histories of points, forces, bodies and rooms, with their peaks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import nan
from typing import Any, Final, NamedTuple

import numpy as np
import scipy

from acoustics.room_response import RoomResponse
from acoustics.rooms.box_pressure import extend_to_rest, fast_length
from femstruct.arrays import Floats, Integers
from femstruct.conventions import GRAVITY
from femstruct.elements.stresses import von_mises
from femstruct.errors import Finding, InputError, list_some
from femstruct.evaluations.evaluation import Evaluation, Quoted
from femstruct.evaluations.known_evaluations import EVALUATIONS
from femstruct.impact.fatigue import Fatigue, SNLine, counted, counted_on_planes, most_damaged
from femstruct.impact.resampled import ENOUGH, FOLDED, SAMPLES_OF_A_PERIOD, average_motion, last_mode_hz, resample
from femstruct.impact.response import ContactHistory, Event, Response, ground_contact_force, transmitted_share
from femstruct.impact.simulate import simulate
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.statics import UP
from femstruct.modal.steady import Amount
from femstruct.model.materials import Orthotropic
from femstruct.model.probe import StressPlaces
from femstruct.model.structure import Structure
from femstruct.study.asked import FatigueRequest, PeakRule, Record, RoomPlan
from femstruct.study.recorded import GROUND_WITH_WEIGHT, NET_FORCE, Channel, LargestStress
from femstruct.study.structures import ModesModel
from femstruct.study.study import Study
from femstruct.units import readable_unit
from femstruct.workflow.bases import Places, axis_of, planned_contacts, weighs, weight_of_bodies
from femstruct.workflow.staging import ordered

# ----------------------------------------------------------------------------------------------------------------------
# Peaks of recorded histories: between the samples, in the first impact and in all, and what they are filtered with.
# ----------------------------------------------------------------------------------------------------------------------

FILTER_ORDER = 4
AHEAD = 6.0  # periods of a low-pass after which nothing of what follows is left in it, e^-2.4 a period backwards
SETTLED = 10.0  # periods of a band's lowest edge after which a filter of order 4 has forgotten
PEAK_NOISE_FLOOR = 1e-9  # share of the largest value below which a peak is rounding, or a filter's tail


def filter_sentence(rule: PeakRule) -> str:
    """What every peak went through."""
    if rule.lowpass_hz is None:
        return "no filter"
    filtered = f"low-pass {rule.lowpass_hz:g} Hz (Butterworth, order {FILTER_ORDER}, forwards and backwards)"
    return f"{filtered}; contact forces: no filter"


def first_window(rule: PeakRule, response: Response) -> float:
    """End of the first impact [s]: its window after the first closing, or until a contact closes again.

    A preloaded contact is a clamp that may rattle: it neither begins nor ends an impact.
    """
    closed = closings(response)
    start = min((event.t for event in closed), default=0.0)
    if rule.first_impact is not None:
        return start + rule.first_impact
    seen: set[str] = set()
    for event in closed:
        if event.contact in seen:
            return event.t
        seen.add(event.contact)
    return float(response.t[-1])


def closings(response: Response) -> list[Event]:
    """The closings that begin and end impacts: those of contacts without a preload."""
    clamps = {contact.name for contact in response.scene.contacts if contact.preload > 0.0}
    return [event for event in response.events if event.what == "closes" and event.contact not in clamps]


def run_first_impact(response: Response, window: float) -> Response | None:
    """The same scene up to the end of the first impact alone, on a grid that shows its pulses, where that of the run
    need not: it follows those of the largest forces, which come later. None where they do not, or nothing struck.

    Parameters
    ----------
    window : float
        End of the first impact [s].
    """
    later = any(one.peak_time > window for one in response.contacts.values())
    if not later or not any(0.0 <= event.t < window for event in closings(response)):
        return None
    clock = response.clock
    sampling = float(np.ceil(window * clock.sampling)) / window  # so that it ends with the window
    run = simulate(response.basis, response.scene, replace(clock, duration=window, sampling=sampling))
    return resample(run) or run


def continue_after_window(response: Response, rule: PeakRule) -> Response:
    """The same run and what comes after its window, as far ahead as a low-pass looks: what still vibrates at the end
    goes on, and a filter that took it to stop there would ring."""
    assert rule.lowpass_hz is not None
    clock = response.clock
    more = int(np.ceil(AHEAD * clock.sampling / rule.lowpass_hz))
    duration = (len(response.t) + more) / clock.sampling
    return simulate(response.basis, response.scene, replace(clock, duration=duration))


def raise_peaks(peaks: tuple[float, float], values: Floats) -> tuple[float, float]:
    """Peaks in the first impact and in the whole record, and at least those of values in the first impact."""
    first = float(np.abs(values).max(initial=0.0))
    return max(peaks[0], first), max(peaks[1], first)


class Before(NamedTuple):
    """A history before its first sample: `level` at the start, to which it came by `rate` a second."""

    level: float = 0.0
    rate: float = 0.0


AT_REST: Final = Before()


def in_band(values: Floats, sampling: float, band: tuple[float, float], before: Before = AT_REST) -> Floats:
    """Histories [.., nt] between two frequencies: Butterworth, order 4, forwards and backwards; low-pass if one is 0.

    Parameters
    ----------
    before : Before
        What they were before the start; nothing, of a structure at rest. After the end they keep their last value: of
        what still changes there, give what follows (`continue_after_window`) and leave its end out.

    Notes
    -----
    The first sample is no state of rest: an acceleration jumps when a dashpot is struck. What was before is a straight
    line, which a low-pass leaves as it is and a band-pass removes; the rest begins from zero, and so does the filter.

    The impulse of 2 N s of a triangle on 1 kg, its acceleration below 50 Hz: dv 2 f (pi/8) / sin(pi/8)

    Examples
    --------
    >>> t = np.arange(80000) / 400e3
    >>> found = in_band(np.maximum(4000.0 * (1.0 - 1000.0 * t), 0.0), 400e3, (0.0, 50.0))
    >>> round(float(found.max() / (2.0 * 2.0 * 50.0 * (np.pi / 8) / np.sin(np.pi / 8))), 2)
    1.0
    """
    low, high = band
    if low > 0.0:
        sos = scipy.signal.butter(FILTER_ORDER, (low, high), "bandpass", fs=sampling, output="sos")
    else:
        sos = scipy.signal.butter(FILTER_ORDER, high, "lowpass", fs=sampling, output="sos")
    count, tail = values.shape[-1], int(SETTLED * sampling / (low or high))
    line = before.level + before.rate * np.arange(count + tail) / sampling
    found = np.empty(values.shape)
    for row, out in zip(values.reshape(-1, count), found.reshape(-1, count), strict=True):  # long tails, one at a time
        whole = np.concatenate((row, np.full(tail, row[-1]))) - line
        there = scipy.signal.sosfilt(sos, whole)[::-1]
        back, _ = scipy.signal.sosfilt(sos, there, zi=scipy.signal.sosfilt_zi(sos) * there[0])
        out[:] = back[::-1][:count]
    return found if low > 0.0 else found + line[:count]


@dataclass(frozen=True)
class Peaks:
    """How peaks are found. window : end of the first impact [s]. count : of samples in the whole window, where
    histories go on after it."""

    rule: PeakRule
    sampling: float
    window: float
    count: int | None = None

    def of(self, values: Floats, before: Before = AT_REST) -> tuple[float, float]:
        """Peaks of |values| in the first impact and in the whole record."""
        if self.rule.lowpass_hz is not None:
            values = in_band(values, self.sampling, (0.0, self.rule.lowpass_hz), before)
        size = np.abs(values[: self.count])
        largest = float(size.max())
        first = float(size[np.arange(len(size)) / self.sampling <= self.window].max(initial=0.0))
        return first if first > PEAK_NOISE_FLOOR * largest else 0.0, largest

    def of_contact(self, values: Floats, contact: ContactHistory) -> tuple[float, float]:
        """The peaks of a contact's force, never filtered: its law is followed between the samples, and a low-pass
        filter would hide what the contact has to carry."""
        first, largest = replace(self, rule=replace(self.rule, lowpass_hz=None)).of(values)
        whole = max(contact.peak_force, largest)
        return whole if contact.peak_time <= self.window else first, whole


def refine_pressure(pressure: Floats, response: Response) -> tuple[Floats, int]:
    """A pressure [nt] on a finer grid where its samples are coarse, and by what factor: it has nothing above the last
    mode, so its samples say what lies between them; nan where they do not."""
    last, sampling = last_mode_hz(response.basis), response.clock.sampling
    if sampling >= ENOUGH * last:
        return pressure, 1
    if sampling < FOLDED * last:
        return np.full_like(pressure, nan), 1
    factor = int(np.ceil(SAMPLES_OF_A_PERIOD * last / sampling))
    count = len(pressure)
    length = fast_length(2 * count)
    fine = scipy.fft.irfft(scipy.fft.rfft(extend_to_rest(pressure[None], length)[0]), factor * length)[: factor * count]
    return np.asarray(factor * fine, dtype=np.float64), factor


# ----------------------------------------------------------------------------------------------------------------------
# The equivalent stress of a part over time: largest anywhere at every sample, and largest ever at every place.
# ----------------------------------------------------------------------------------------------------------------------

AT_ONCE: Final = 4_000_000
"""Stresses that are evaluated at once, 32 MB: of all places at as many samples as that makes."""
UNEVEN: Final = 0.2
"""Share of the largest stress by which the cells at its place may differ, and by which it may fall to the next ones."""
AROUND: Final = 4  # places next to one in a grid of cells
SAME: Final = 1e-9  # of the extent of a part: ends of bars that meet are one place


class Walked(NamedTuple):
    """history [nt] : the largest equivalent stress anywhere. largest [p], sample [p] : the largest ever, and when."""

    history: Floats
    largest: Floats
    sample: Integers


def walk_stresses(places: StressPlaces, shapes: Floats, q: Floats) -> Walked:
    """The equivalent stress of von Mises over time.

    Parameters
    ----------
    shapes : Floats [node, 7, k]
        Mass-normalised.
    q : Floats [k, nt]
        Modal coordinates.

    Notes
    -----
    Every place at every sample is looked at and none is kept: memory does not grow with their product.
    """
    rows = places.of(shapes).reshape(-1, shapes.shape[2])
    count, components, samples = len(places.places), len(places.components), q.shape[1]
    history, largest, sample = np.empty(samples), np.full(count, -1.0), np.zeros(count, np.int64)
    step = max(1, AT_ONCE // max(len(rows), 1))
    for first in range(0, samples, step):
        found = (rows @ q[:, first : first + step]).reshape(count, components, -1)
        equivalent = von_mises(found, places.components)
        history[first : first + step] = equivalent.max(axis=0)
        then = equivalent.argmax(axis=1)
        peak = equivalent[np.arange(count), then]
        higher = peak > largest
        largest[higher], sample[higher] = peak[higher], first + then[higher]
    return Walked(history, largest, sample)


def largest_stress(places: StressPlaces, response: Response, q: Floats) -> tuple[Floats, LargestStress]:
    """The largest equivalent stress anywhere [nt] [Pa], and at every place the largest ever.

    Parameters
    ----------
    q : Floats [k, nt]
        The modal coordinates of the response, filtered or not.
    """
    found = walk_stresses(places, response.basis.shapes, q)
    times = response.t[found.sample]
    then = q[:, found.sample[int(found.largest.argmax())]]
    return found.history, judged(places, response.basis.shapes, found.largest, _at(places, then), times)


def stress_at_place(places: StressPlaces, place: int, response: Response, q: Floats) -> LargestStress:
    """The largest equivalent stress of one place alone, which counts for the most stressed one, and how well the mesh
    resolves it there.

    Parameters
    ----------
    q : Floats [k, nt]
        The modal coordinates of the response.
    """
    shapes = response.basis.shapes
    own = von_mises(places.at(place).of(shapes) @ q, places.components)[0]
    sample, largest = int(own.argmax()), np.zeros(len(places.places))
    largest[place] = own[sample]
    times = np.where(largest > 0.0, response.t[sample], 0.0)
    return judged(places, shapes, largest, _at(places, q[:, sample]), times)


def stress_at_rest(places: StressPlaces, displacement: Floats, weight: bool = False) -> LargestStress:
    """The equivalent stress at every place of a structure at rest.

    Parameters
    ----------
    displacement : Floats [n_nodes, 7]
        Of its nodes.
    weight : bool
        Whether it weighs.
    """
    shapes, q = displacement[:, :, None], np.ones((1, 1))
    stresses = places.of(shapes)
    if weight and places.carried is not None:
        stresses = stresses + GRAVITY * places.carried[:, :, UP, None]
    largest: Floats = von_mises(stresses, places.components)[:, 0]
    return judged(places, shapes, largest, _at(places, q[:, 0]))


def _at(places: StressPlaces, q: Floats) -> Amount:
    """The equivalent stress at one instant, from its modal coordinates [k]."""
    return lambda stresses: von_mises(stresses @ q, places.components)


def judged(
    places: StressPlaces, shapes: Floats, largest: Floats, amount: Amount, times: Floats | None = None
) -> LargestStress:
    """Where a part is stressed most, and how well the mesh resolves it there.

    Bars are judged by the length of their waves alone: moments that are linear along a bar are exact at its ends,
    however steep, and no point of a beam is stressed infinitely.

    Parameters
    ----------
    largest : Floats [p]
        Equivalent stresses [Pa].
    amount : Amount
        How that of the most stressed place follows from the shapes; it is asked of the places beside, too.
    times : Floats | None [p]
        When each was largest [s], 0 where that means nothing.
    """
    worst = int(largest.argmax())
    next_to = _neighbours(places, worst)
    peak = float(largest[worst]) or 1.0
    around = places.around(worst)
    jump = 0.0 if around is None else float(np.ptp(amount(around.of(shapes)))) / peak
    uneven = places.carried is None and len(next_to)
    falls = 1.0 - float(amount(places.of(shapes)[next_to]).mean()) / peak if uneven else 0.0
    return LargestStress(
        places.places, places.sides, largest, np.zeros(len(largest)) if times is None else times, jump, falls
    )


def _neighbours(places: StressPlaces, place: int) -> Integers:
    """Numbers of the nearest other places on the same side, as many as a grid has around one."""
    alike = np.arange(place % len(places.sides), len(places.places), len(places.sides))
    apart = np.linalg.norm(places.places[alike] - places.places[place], axis=1)
    other = apart > SAME * float(np.ptp(places.places, axis=0).max())
    found: Integers = alike[other][np.argsort(apart[other], kind="stable")[:AROUND]]
    return found


def orthotropic_findings(structure: object, names: Iterable[str]) -> Iterator[Finding]:
    """Parts of these names whose material has no equivalent stress that tells its strength.

    Parameters
    ----------
    structure : object
        With parts, or in closed form.
    """
    parts = structure.parts if isinstance(structure, Structure) else ()
    chosen = set(names)
    for part in parts:
        made_of = [one.name for one in part.materials() if isinstance(one, Orthotropic)]
        if part.name in chosen and made_of:
            yield Finding(
                "stress-of-orthotropic",
                f"{part.name}: do not judge its strength by the stress of von Mises, which supposes a metal: "
                f"{list_some(made_of)} is orthotropic, with strengths of its own along and across its axes. Look at "
                f"xx, yy and xy along them: 'frf --response {part.name}.stress' prints them where it is stressed most",
            )


def uneven(found: LargestStress) -> float:
    """The share of the largest stress that the mesh leaves open; 0 where that is no more than allowed."""
    share = max(found.jump, found.falls)
    return share if share > UNEVEN else 0.0


def stress_findings(stresses: Mapping[str, LargestStress | None]) -> Iterator[Finding]:
    """Largest stresses that the mesh does not resolve, by what they are called."""
    for name, found in stresses.items():
        if found is None or not uneven(found):
            continue
        how = (
            f"Between the cells that meet there it jumps by {100 * found.jump:.0f} %"
            if found.jump > found.falls
            else f"One cell further it is {100 * found.falls:.0f} % smaller"
        )
        yield Finding(
            "stress-uneven",
            f"{name}: do not quote its peak of {1e-6 * found.largest.max():.4g} MPa at {found.where}. {how}, more than "
            f"the {100 * UNEVEN:.0f} % allowed: the mesh does not resolve it. Use a finer mesh. If the stress then "
            "grows, it is infinite in the model, at a force or support on a point (use the nodes of a set or a patch) "
            "or at a re-entrant corner or clamped edge (quote the stress one thickness away)",
            {"jump": found.jump, "falls": found.falls, "allowed": UNEVEN, "peak_pa": float(found.largest.max())},
        )


# ----------------------------------------------------------------------------------------------------------------------
# What a study records.
# ----------------------------------------------------------------------------------------------------------------------

STRESS = "stress"
UNITS = {
    "displacement": "m",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "force": "N",
    "travel": "m",
    "pressure": "Pa",
    STRESS: "Pa",
}

MOTIONS = ("displacement", "velocity", "acceleration")
AXES = "xyz"
GROUND = "ground"
SIDEWAYS = 1e-6  # of the largest: the eigen solver leaves shapes a residual of 1e-9, their forces about 1e-7


def record(study: Study, places: Places, response: Response, rooms: Mapping[str, RoomResponse]) -> dict[str, Channel]:
    """All channels of a case: what the study records, the net force where contacts meet the structure, and pressures.

    Their peaks are those between the samples too (`femstruct.impact.resampled`), nan where they cannot be found.

    Raises InputError when a record names something that has no such quantity.
    """
    seen, kept = resample(response), histories(study, places, response)
    pressures = {
        name: one
        for plan in study.rooms
        if plan.name in rooms
        for name, one in _pressures(plan, rooms[plan.name]).items()
    }
    stresses = {str(request): request.target for request in study.records if request.what == STRESS}
    if seen is None:
        return _without_peaks(study, places, response, kept | pressures, stresses)
    plain = study.peaks.lowpass_hz is None
    onward = seen if plain else continue_after_window(seen, study.peaks)
    moves = onward if plain else average_motion(onward)
    fine = kept if moves is response else kept | histories(study, places, moves)
    peaks = Peaks(study.peaks, seen.clock.sampling, first_window(study.peaks, seen), len(seen.t))
    alone = run_first_impact(seen, peaks.window)
    moving = alone if plain else None  # a filter needs what comes later
    before = before_start(study, places, seen)
    found = {name: peaks.of(fine[name][0], before.get(name, AT_REST)) for name in kept}
    if moving is not None:
        found = {n: raise_peaks(found[n], values) for n, (values, _) in histories(study, places, moving).items()}
    for name, one in _contacts(study, seen).items():
        found[name] = peaks.of_contact(fine[name][0], seen.contacts[one])
        if alone is not None:
            found[name] = raise_peaks(found[name], np.array([alone.contacts[one].peak_force]))
    of_pressures, silent = _peaks_of_pressures(pressures, response, peaks)
    found |= of_pressures
    channels = {
        name: Channel(name, values, unit, *found[name], silent_after=silent.get(name))
        for name, (values, unit) in (kept | pressures).items()
    }
    for name, pair in _peaks_by_modes(study, places, moves, moving, peaks, before).items():
        channels[name] = replace(channels[name], by_modes=pair)
    if stresses:
        channels |= _stresses(stresses, study.peaks, places, _Motions(response, seen, onward, moving))
    met = bool(response.contacts)
    return channels if met else {name: replace(channel, struck=False) for name, channel in channels.items()}


def _without_peaks(
    study: Study,
    places: Places,
    response: Response,
    kept: Mapping[str, tuple[Floats, str]],
    stresses: Mapping[str, str],
) -> dict[str, Channel]:
    """Channels of a motion whose samples do not say what is between them: only contact forces have peaks.

    Parameters
    ----------
    kept : Mapping[str, tuple[Floats, str]]
        Histories and their units, by channel.
    stresses : Mapping[str, str]
        Parts by channel.
    """
    found = dict(kept)
    for name, part in stresses.items():
        rows = places.stresses(part, f"record.{part}")
        found[name] = walk_stresses(rows, response.basis.shapes, response.q).history, UNITS[STRESS]
    told = _known_without_samples(study, response)
    blank = (nan, nan)
    return {name: Channel(name, values, unit, *told.get(name, blank)) for name, (values, unit) in found.items()}


_Pairs = dict[str, tuple[float, float]]  # peaks in the first impact and in the whole record, by channel


def _peaks_of_pressures(
    pressures: Mapping[str, tuple[Floats, str]], response: Response, peaks: Peaks
) -> tuple[_Pairs, _Pairs]:
    """Peaks of pressures between their samples; and, where there is a filter, those with silence after the end."""
    found: _Pairs = {}
    silent: _Pairs = {}
    for name, (pressure, _) in pressures.items():
        values, factor = refine_pressure(pressure, response)
        heard = replace(peaks, sampling=factor * response.clock.sampling, count=values.shape[-1])
        found[name] = heard.of(values)
        if peaks.rule.lowpass_hz is not None:
            silent[name] = heard.of(np.append(values, 0.0))
    return found, silent


def _peaks_by_modes(
    study: Study,
    places: Places,
    moves: Response,
    first: Response | None,
    peaks: Peaks,
    rest: Mapping[str, Before],
) -> _Pairs:
    """Peaks of recorded motions of the modes alone; none where there are no residual vectors.

    Parameters
    ----------
    first : Response | None
        The first impact by itself, where it is looked at closer.
    rest : Mapping[str, Before]
        What histories were before the start.
    """
    true = np.array([kind != "residual" for kind in moves.basis.kind])
    found: _Pairs = {}
    for name, (what, row) in motion_rows(study, places, moves.basis).items() if not true.all() else ():
        pair = peaks.of(row_motion(moves, what, row * true), rest.get(name, AT_REST))
        found[name] = pair if first is None else raise_peaks(pair, row_motion(first, what, row * true))
    return found


class _Motions(NamedTuple):
    """The motion of a case as its stresses are looked for in it.

    kept : as it is recorded. seen : with samples that show what is between them. onward : with what comes after it,
    which a filter needs. alone : the first impact by itself, where it is looked at closer.
    """

    kept: Response
    seen: Response
    onward: Response
    alone: Response | None


def _stresses(parts: Mapping[str, str], rule: PeakRule, places: Places, motions: _Motions) -> dict[str, Channel]:
    """Histories of the largest equivalent stress of parts, by channel, with their peaks. What is filtered is the
    motion: the stress of von Mises of a filtered motion is one, a filtered stress of von Mises is not."""
    seen, alone = motions.seen, motions.alone
    shapes, q = seen.basis.shapes, seen.q
    if rule.lowpass_hz is not None:
        q = in_band(motions.onward.q, seen.clock.sampling, (0.0, rule.lowpass_hz))[:, : len(seen.t)]
    kept = q if seen is motions.kept and rule.lowpass_hz is None else motions.kept.q
    true = np.array([kind != "residual" for kind in seen.basis.kind])
    early = seen.t <= first_window(rule, seen)

    def largest(history: Floats, rows: StressPlaces, shapes: Floats) -> tuple[float, float]:
        pair = float(history[early].max(initial=0.0)), float(history.max())
        return pair if alone is None else raise_peaks(pair, walk_stresses(rows, shapes, alone.q).history)

    found: dict[str, Channel] = {}
    for name, part in parts.items():
        rows = places.stresses(part, f"record.{part}")
        peaks, stressed = largest_stress(rows, seen, q)
        values = peaks if kept is q else walk_stresses(rows, shapes, kept).history
        by_modes = None if true.all() else largest(walk_stresses(rows, shapes * true, q).history, rows, shapes * true)
        found[name] = Channel(name, values, UNITS[STRESS], *largest(peaks, rows, shapes), by_modes, stressed)
    return found


def histories(study: Study, places: Places, response: Response) -> dict[str, tuple[Floats, str]]:
    """What a study records of the motion and of forces, and the net forces, by channel: values [nt] and their unit.
    Stresses are no sums of modes and are not among them."""
    found: dict[str, tuple[Floats, str]] = {}
    for request in study.records:
        if request.what != STRESS:
            found |= _recorded(request, study, places, response)
    if (weight := _limited_weight(study, response.basis)) is not None:
        found[GROUND_WITH_WEIGHT] = (found["ground force"][0] - weight, "N")  # z is up: a negative force on the ground
    return found | {f"{NET_FORCE}{name}": (force, "N") for name, force in _net_forces(study, places, response).items()}


def weight_on_ground(study: Study, basis: ModalBasis) -> float | None:
    """Weight of all that stands on the ground [N]; None without gravity, and where modes are given, which do not say
    their mass."""
    known = basis.total_mass > 0.0 or not basis.modes.stop
    return basis.total_mass * GRAVITY + weight_of_bodies(study) if weighs(study) and known else None


def _limited_weight(study: Study, basis: ModalBasis) -> float | None:
    """The same where a limit is of the force with it, else None."""
    if all(limit.name != GROUND_WITH_WEIGHT for limit in study.limits):
        return None
    weight, recorded = weight_on_ground(study, basis), any(str(one) == "ground force" for one in study.records)
    if weight is None or not recorded:
        got = "modes that do not say their mass" if weighs(study) and recorded else "no gravity, or no record of ground"
        expected, do = "a structure whose mass is known, gravity: true and record: {ground: force}", ""
        raise InputError(f"limits.{GROUND_WITH_WEIGHT}", got=got, expected=expected, do=do)
    return weight


def before_start(study: Study, places: Places, response: Response) -> dict[str, Before]:
    """What the recorded histories were before the first sample, by channel, where that is not nothing: bodies and free
    structures flew, preloads and weights were held. Supported structures, and all accelerations and forces that come
    with the blow, were not there."""
    scene, found = response.scene, dict[str, Before]()
    held = {contact.name: contact.preload for contact in scene.contacts}
    pressed = held | {link.name: link.preload for link in scene.links if link.release_at == 0.0}
    if (flown := _flown(response)) is not None:
        for name, (what, row) in motion_rows(study, places, response.basis).items():
            speed = float(row @ flown)
            found[name] = {"displacement": Before(0.0, speed), "velocity": Before(speed)}.get(what, AT_REST)
    for request in study.records:
        if request.what == "force" and request.target in pressed:
            found[str(request)] = Before(pressed[request.target])
        elif (
            request.target in response.bodies and (before := _body_before(request, study, places, response)) is not None
        ):
            found[str(request)] = before
    if (weight := _limited_weight(study, response.basis)) is not None:
        found[GROUND_WITH_WEIGHT] = Before(-weight)
    for name, contact, sign in _touched(study, places, response):
        net = f"{NET_FORCE}{name}"
        found[net] = Before(found.get(net, AT_REST).level + sign * held[contact])
    return found


def _flown(response: Response) -> Floats | None:
    """Modal velocities [k] with which a free structure flew before the first sample; None where nothing moved."""
    rigid = np.array([kind == "rigid" for kind in response.basis.kind], dtype=bool)
    return None if response.scene.velocity is None else np.where(rigid, response.scene.velocity, 0.0)


def _body_before(wanted: Record, study: Study, places: Places, response: Response) -> Before | None:
    """What a history of a body was before the first sample: it flew, and fell where it has a weight; None for forces.

    One that strikes later is held until then and does not fall.
    """
    scene, body = response.scene, response.bodies[wanted.target]
    late = {blows.body for blows in scene.blows if blows.times[0] > 0.0}
    pulled = next(
        -scene.gravity * (one.falls and one.name not in late) for one in scene.bodies if one.name == wanted.target
    )
    at, rate = float(body.displacement[0]), float(body.velocity[0])
    if wanted.what == "displacement":
        return Before(at, rate)
    if wanted.what == "velocity":
        return Before(rate, pulled)
    if wanted.what == "acceleration":
        return Before(pulled)
    if wanted.what == "travel":
        target = next(one.target for one in study.bodies if one.name == wanted.target)
        return Before(at, rate - _speed_before(target, study, places, response))
    return None


def _speed_before(name: str, study: Study, places: Places, response: Response) -> float:
    """Speed of a body, a point or the ground along the axis of the bodies before the first sample [m/s]."""
    if name in response.bodies:
        return float(response.bodies[name].velocity[0])
    flown, row = _flown(response), _row_along(name, study, places, response)
    return 0.0 if flown is None or row is None else float(row @ flown)


def refuse_absent_forces(study: Study, basis: ModalBasis) -> None:
    """Raise InputError for a recorded force that nothing of the structure, its contacts and links has."""
    pairs = {contact.name: contact.between for contact in planned_contacts(study)}
    pairs |= {link.name: link.between for link in study.links}
    on_ground = any(GROUND in between for between in pairs.values())
    rows = {name.rpartition(".")[0] for name in basis.outputs}
    for request in study.records:
        target = request.target
        if request.what != "force" or target in pairs or target in rows or (target == GROUND and on_ground):
            continue
        if target != GROUND:
            expected, do = "a part, joint or support that carries a force", "record another one"
        elif isinstance(study.structure, ModesModel):
            expected = "given modes and a link or contact between one of their points and the ground"
            do = "write what is fixed to the ground as a link, and give the modes of the structure without it"
        else:
            expected = "a support, spring, foundation, link or contact that is fixed to the ground"
            do = "add one, or do not record it"
        raise InputError(f"record.{target}", got=f"no force of '{target}'", expected=expected, do=do)


def _contacts(study: Study, response: Response) -> dict[str, str]:
    """The contacts whose forces are recorded, by channel."""
    recorded = {str(one): one.target for one in study.records if one.what == "force"}
    return {name: target for name, target in recorded.items() if target in response.contacts}


def _known_without_samples(study: Study, response: Response) -> dict[str, tuple[float, float]]:
    """Peaks of contact forces, that of the first impact nan where it is not the largest of all."""
    end = first_window(study.peaks, response)
    contacts = {name: response.contacts[one] for name, one in _contacts(study, response).items()}
    return {name: (c.peak_force if c.peak_time <= end else nan, c.peak_force) for name, c in contacts.items()}


def _recorded(request: Record, study: Study, places: Places, response: Response) -> dict[str, tuple[Floats, str]]:
    target, what, unit = request.target, request.what, UNITS[request.what]
    bodies = {body.name: body for body in study.bodies}
    if target in response.bodies:
        body = response.bodies[target]
        if what == "travel":
            placed_on = motion_of(bodies[target].target, study, places, response)
            return {str(request): (body.displacement - placed_on, unit)}
        if what in MOTIONS:
            return {str(request): (getattr(body, what), unit)}
    if what == "force":
        if target in response.contacts:
            return {str(request): (response.contacts[target].force, unit)}
        if target in response.links:
            return {str(request): (response.links[target], unit)}
        rows = {
            axis: response.basis.outputs[key] for axis in AXES if (key := f"{target}.{axis}") in response.basis.outputs
        }
        direct = ground_contact_force(response) if target == GROUND else None
        if rows or direct is not None:
            return _forces(target, rows, response, {} if direct is None else {axis_of(study): direct})
    name, _, direction = target.rpartition(".")
    if what in MOTIONS and name:
        row = places.point(name, f"record.{target}").probe(direction).of(response.basis.shapes)
        return {str(request): (row_motion(response, what, row), unit)}
    raise InputError(
        f"record.{target}",
        got=f"'{what}' of '{target}'",
        expected="motion of POINT.x, displacement, velocity, acceleration or travel of a body, or force of a contact, "
        "link, spring, foundation, support, joint or ground",
    )


def motion_rows(study: Study, places: Places, basis: ModalBasis) -> dict[str, tuple[str, Floats]]:
    """What a study records of the motion of points, by channel: which motion, and its modal row [k]."""
    rows: dict[str, tuple[str, Floats]] = {}
    bodies = {body.name for body in study.bodies}
    for request in study.records:
        name, _, direction = request.target.rpartition(".")
        if request.what in MOTIONS and name and request.target not in bodies:
            probe = places.point(name, f"record.{request.target}").probe(direction)
            rows[str(request)] = (request.what, probe.of(basis.shapes))
    return rows


def row_motion(response: Response, what: str, row: Floats) -> Floats:
    """Displacement, velocity or acceleration of a row of modes [nt]."""
    return {"displacement": response.displacement, "velocity": response.velocity}.get(what, response.acceleration)(row)


def _forces(
    target: str, rows: Mapping[str, ForceRow], response: Response, beside: Mapping[str, Floats]
) -> dict[str, tuple[Floats, str]]:
    """The vertical force under the plain name, and the horizontal ones that are more than the rounding of mode shapes
    beside the largest.

    Parameters
    ----------
    beside : Mapping[str, Floats]
        What else there is along an axis.
    """
    found = {axis: _summed(response, row) + transmitted_share(response, row.direct) for axis, row in rows.items()}
    found |= {axis: force + found.get(axis, 0.0) for axis, force in beside.items()}
    largest = max((np.abs(force).max() for force in found.values()), default=0.0)
    named = {f"{target} force": (found["z"], "N")} if "z" in found else {}
    for axis in "xy":
        if axis in found and np.abs(found[axis]).max() > SIDEWAYS * largest:
            named[f"{target} force {axis}"] = (found[axis], "N")
    return named


def _summed(response: Response, row: ForceRow) -> Floats:
    """What the motion makes of a force [nt] [N]; its parts that are zero take no time."""
    parts = (
        (response.displacement, row.stiffness),
        (response.velocity, row.damping),
        (response.acceleration, row.inertia),
    )
    return sum((motion(of) for motion, of in parts if of.any()), np.zeros(len(response.t)))


def motion_of(name: str, study: Study, places: Places, response: Response) -> Floats:
    """Displacement [nt] of a body, a point or the ground along the axis of the bodies [m]."""
    if name in response.bodies:
        return response.bodies[name].displacement
    if name == "ground":
        return np.zeros(len(response.t))
    row = _row_along(name, study, places, response)
    return np.zeros(len(response.t)) if row is None else response.displacement(row)


def _row_along(name: str, study: Study, places: Places, response: Response) -> Floats | None:
    """Modal row [k] of a point along the axis of the bodies; None for a body and the ground."""
    if name in response.bodies or name == GROUND:
        return None
    return places.point(name, "bodies").probe(axis_of(study)).of(response.basis.shapes)


def _net_forces(study: Study, places: Places, response: Response) -> dict[str, Floats]:
    """Sum of all contact forces on every point of the structure that contacts touch, positive along the axis."""
    sums: dict[str, Floats] = {}
    for name, contact, sign in _touched(study, places, response):
        sums[name] = sums.get(name, 0.0) + sign * response.contacts[contact].force
    return sums


def _touched(study: Study, places: Places, response: Response) -> Iterator[tuple[str, str, float]]:
    """Points of the structure that contacts touch, each with its contact and which way that pushes it."""
    for planned in planned_contacts(study):
        for name, sign in zip(ordered(study, places, planned), (1.0, -1.0), strict=True):
            if name != GROUND and name not in response.bodies:
                yield name, planned.name, sign


def _pressures(plan: RoomPlan, room: RoomResponse) -> dict[str, tuple[Floats, str]]:
    return {f"{plan.name}.{receiver.name} pressure": (room.p[i], "Pa") for i, receiver in enumerate(plan.receivers)}


# ----------------------------------------------------------------------------------------------------------------------
# Peaks that depend on the modes left out: reported with the peak of the modes alone beside them.
#
# Residual vectors hold the static share of all modes beyond the last one at the places that are pushed. A displacement
# or a velocity hardly feels them; the acceleration of the struck point may be theirs for a half, and then moves with
# the number of modes and with the mesh.
# ----------------------------------------------------------------------------------------------------------------------

CONVERGED = 0.05  # of a peak: what residual vectors may make of it
MISSED = 0.02  # of a peak: what samples may miss of it before cycles are counted from them
CUT_OFF = 0.01  # of a peak: what a low-pass may make of where a pressure ends
CHANGED = 5.0  # per cent: by how much a change against the baseline may depend on them


def fatigues(study: Study, channels: Mapping[str, Channel], places: Places, response: Response) -> dict[str, Fatigue]:
    """Rainflow cycles of the histories that a study asks for, by name.

    Of a stress the components at the place with the most damage are counted: the recorded history, which is the largest
    equivalent stress anywhere, has no sign, and what is largest once need not be what comes often. Histories without
    residual vectors are counted beside them.
    """
    found: dict[str, Fatigue] = {}
    basis = response.basis
    true = np.array([kind != "residual" for kind in basis.kind])
    motions = {} if true.all() else motion_rows(study, places, basis)
    for request in (one for one in study.fatigue if not one.under):
        channel = channels[request.of]
        if channel.stressed is not None:
            part = request.of.rpartition(" ")[0]
            everywhere, q = places.stresses(part, f"fatigue.{request.name}.of"), response.q
            place = most_damaged(everywhere.of(basis.shapes), q, everywhere.components, request.sn)
            stressed = stress_at_place(everywhere, place, response, q)
            rows = everywhere.at(place)
            in_modes, names, where = rows.of(basis.shapes)[0], rows.components, stressed.where
            alone = None if true.all() else (in_modes * true) @ q
            open_share = uneven(stressed)
            axes = None if rows.axes is None else rows.axes[0]
            one = counted_on_planes(
                request.of,
                in_modes @ q,
                components=names,
                line=request.sn,
                place=where,
                alone=alone,
                uneven=open_share,
                axes=axes,
            )
        else:
            what, row = motions.get(request.of, ("", None))
            alone = None if row is None else row_motion(response, what, row * true)
            one = counted(request.of, channel.unit, channel.values, request.sn, alone=alone)
        found[request.name] = replace(one, converged=converged(channel) and not _differs(one, request.sn))
    return found


def converged(channel: Channel) -> bool:
    """Whether neither the modes left out, the mesh nor the end of the window change more than a little of its peak."""
    by_modes = channel.by_modes is None or max(map(_apart, _both(channel))) <= CONVERGED
    return by_modes and not _cut_off(channel) and (channel.stressed is None or not uneven(channel.stressed))


def _differs(found: Fatigue, line: SNLine | None) -> bool:
    """Whether ranges are others without residual vectors than peaks may be, or damage by what that makes of it."""
    if found.largest_modes_alone is None:
        return False
    if _apart((found.largest, found.largest_modes_alone)) > CONVERGED:
        return True
    if line is None or found.damage is None or found.damage_modes_alone is None:
        return False
    return _apart((found.damage, found.damage_modes_alone)) > 1.0 - float((1.0 - CONVERGED) ** line.slope)


def damage_findings(found: Mapping[str, Fatigue]) -> Iterator[Finding]:
    """Damage, or without an S-N line ranges, that rest on a peak which is not to be quoted."""
    for name, one in found.items():
        if one.converged:
            continue
        factor, unit = readable_unit(one.unit, one.largest)
        if one.damage is None:
            quantity, alone, beside = (
                f"largest range of {factor * one.largest:.4g} {unit}",
                one.largest_modes_alone,
                None,
            )
            others = [] if alone is None else [f"{factor * alone:.4g} {unit} without the residual vectors"]
        else:
            quantity, alone, beside = f"damage of {one.damage:.3g}", one.damage_modes_alone, one.damage_beside
            others = [] if alone is None else [f"{alone:.3g} without the residual vectors"]
            others += [] if beside is None else [f"{beside:.3g} with the smaller stress beside the most stressed place"]
        yield Finding(
            "damage-not-converged",
            f"{name}: do not quote its {quantity}: {one.channel} changes with the modes or the mesh"
            f"{'. It is ' if others else ''}{', and '.join(others)}. Compute more modes, or "
            "a finer mesh where it is uneven. A low-pass of 'peaks' does not filter what is counted",
            {
                key: value
                for key, value in (
                    ("damage", one.damage), ("largest_range", one.largest), ("modes_alone", alone), ("beside", beside)
                )
                if value is not None
            },
        )  # fmt: skip


def fatigue_findings(study: Study, channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Histories whose cycles are counted and whose peaks the samples miss."""
    for request in (one for one in study.fatigue if not one.under):
        yield from _missed(request, channels[request.of], study.peaks.lowpass_hz is not None)


def _missed(request: FatigueRequest, channel: Channel, filtered: bool) -> Iterator[Finding]:
    """Samples that miss the peak of a history.

    Parameters
    ----------
    filtered : bool
        Its peak is another one.
    """
    short = 0.0 if filtered or not channel.whole > 0.0 else 1.0 - float(np.abs(channel.values).max()) / channel.whole
    if short > MISSED:
        slope = request.sn.slope if request.sn is not None else SNLine.slope
        damage = 1.0 - (1.0 - short) ** slope
        yield Finding(
            "fatigue-coarsely-sampled",
            f"{request.name}: the largest sample of {request.of} is {100.0 * short:.1f} % below its peak, so ranges "
            f"are too small, and damage by up to {100.0 * damage:.0f} %. Sample faster",
            {"short": short, "allowed": MISSED, "peak": channel.whole},
        )


def peak_findings(channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Channels of which residual vectors make more than a little."""
    for name, channel in channels.items():
        if channel.by_modes is None:
            continue
        pairs = _both(channel)
        peak, alone = max(pairs, key=_apart)
        window = " in the first impact" if (peak, alone) != pairs[0] else ""
        if _apart((peak, alone)) > CONVERGED:
            factor, unit = readable_unit(channel.unit, max(peak, alone))
            yield Finding(
                "peak-not-converged",
                f"{name}: do not quote its peak{window}. It is {factor * peak:.4g} {unit}, and "
                f"{factor * alone:.4g} {unit} without the residual vectors (the static correction for the modes that "
                "are left out), so it changes with the number of modes and with the mesh. Give the study "
                "'peaks: {lowpass: F}' with F below the last mode",
                {"peak": peak, "modes_alone": alone, "apart": _apart((peak, alone)), "allowed": CONVERGED},
            )


def cut_off_findings(channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Low-passed pressures whose peak depends on what follows the window, the worst of all as one finding."""
    cut = [one for one in channels.values() if _cut_off(one)]
    if cut:
        worst = max(cut, key=lambda one: max(map(_apart, _ends(one))))
        peak, silent = max(_ends(worst), key=_apart)
        factor, unit = readable_unit(worst.unit, max(peak, silent))
        more = f" (and {len(cut) - 1} more)" if len(cut) > 1 else ""
        yield Finding(
            "pressure-cut-off",
            f"{worst.name}: do not quote its low-passed peak{more}. It is {factor * peak:.4g} {unit} if the pressure "
            f"stays as it is at the end of the window, and {factor * silent:.4g} {unit} if there is silence then. Give "
            "the study a longer time",
            {"peak": peak, "silent": silent, "apart": _apart((peak, silent)), "allowed": CUT_OFF},
        )


def _ends(channel: Channel) -> list[tuple[float, float]]:
    """Its peaks with either end of the window, in the first impact and in all."""
    pair = channel.silent_after or (channel.first_impact, channel.whole)
    return list(zip((channel.first_impact, channel.whole), pair, strict=True))


def _cut_off(channel: Channel) -> bool:
    return max(map(_apart, _ends(channel))) > CUT_OFF


def change_findings(reference: Mapping[str, Channel], channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Changes of peaks against the baseline's that are others in the modes alone."""
    for name, channel in channels.items():
        found = two_changes(reference[name], channel) if name in reference else None
        if found is not None and not agree(found):
            whole, modes = found
            yield Finding(
                "change-not-converged",
                f"{name}: do not quote the change of its peak against the baseline. It is {whole:+.1f} %, and "
                f"{modes:+.1f} % without the residual vectors (the static correction for the modes that are left out)",
                {"change_percent": whole, "modes_alone_percent": modes, "allowed": CHANGED},
            )


def two_changes(before: Channel, after: Channel) -> tuple[float, float] | None:
    """By how much a peak changes, and in the modes alone [%], where the two differ most; None for other channels."""
    if before is after or before.by_modes is None or after.by_modes is None:
        return None
    changes = [
        (100.0 * (then / peak - 1.0), 100.0 * (alone_then / alone - 1.0))
        for (peak, alone), (then, alone_then) in zip(_both(before), _both(after), strict=False)
        if peak > 0.0 and alone > 0.0
    ]
    return max(changes, key=lambda change: abs(change[0] - change[1]), default=None)


def agree(changes: tuple[float, float]) -> bool:
    """Whether two changes are one to what may be quoted."""
    return abs(changes[0] - changes[1]) <= CHANGED


def _both(channel: Channel) -> list[tuple[float, float]]:
    """Its peaks with residual vectors and without, of the windows that tables have: the whole one first."""
    assert channel.by_modes is not None
    first, whole = zip((channel.first_impact, channel.whole), channel.by_modes, strict=True)
    return [whole, first] if channel.struck else [whole]


def _apart(peaks: tuple[float, float]) -> float:
    """Difference of two peaks, as a share of the larger."""
    larger = max(peaks)
    return abs(peaks[0] - peaks[1]) / larger if larger > 0.0 else 0.0


# ----------------------------------------------------------------------------------------------------------------------
# What a study asks of recorded histories one by one: shock response spectra, perception, and what others add.
# ----------------------------------------------------------------------------------------------------------------------

Answers = Mapping[str, Mapping[str, Any]]  # by kind and name
STATIC: Final = "the residual vectors (the static correction for the modes that are left out)"


class LessStatic(NamedTuple):
    """The same impact with less of the residual vectors, also in the force: what is kept of each mode [k], how that is
    said in short and before `STATIC`, and how far numbers may be apart then, as a share."""

    response: Response
    scales: Floats
    short: str
    method: str
    allowed: float


class OtherImpulse(NamedTuple):
    """By how many times what a body gives the structure is larger by another way, and that way."""

    times: float
    method: str


def empty_evaluations() -> Answers:
    """Every kind of evaluation, with nothing where nothing is simulated."""
    return {key: {} for key in EVALUATIONS}


def evaluate_histories(
    study: Study,
    places: Places,
    response: Response,
    channels: Mapping[str, Channel],
    beside: Sequence[LessStatic] = (),
    pushes: Sequence[OtherImpulse] = (),
) -> tuple[Answers, tuple[Finding, ...]]:
    """The answers, and what is to be known of them; every kind is there, with nothing where nothing is asked.

    They see the means of the motion about each sample, not its samples (`femstruct.impact.resampled`).

    Parameters
    ----------
    beside : Sequence[LessStatic]
        The same impact with less of the residual vectors, where contacts reach beyond the modes.
    pushes : Sequence[OtherImpulse]
        What blows give by another way; all numbers are in proportion to it.
    """
    found: dict[str, dict[str, Any]] = {key: {} for key in EVALUATIONS}
    findings: list[Finding] = []
    if not study.evaluations:
        return found, ()
    means, sampling = average_motion(response), response.clock.sampling
    others = [(one, average_motion(one.response)) for one in beside]
    true = np.array([kind != "residual" for kind in response.basis.kind])
    rows = motion_rows(study, places, response.basis)
    for one in study.evaluations:
        what, row = rows.get(one.channel, ("", None))
        values: Floats = channels[one.channel].values if row is None else row_motion(means, what, row)
        answer = found.setdefault(one.key(), {})[one.name] = one.answer(values, sampling)
        if row is None or true.all():
            continue
        alone = _Other(
            one.answer(row_motion(means, what, row * true), sampling), "modes alone", f"without {STATIC}", CONVERGED
        )
        less = [
            _Other(
                one.answer(row_motion(other, what, row * kept.scales), sampling),
                kept.short,
                f"{kept.method} {STATIC}",
                kept.allowed,
            )
            for kept, other in others
        ]
        less += [
            _Other(one.answer(push.times * values, sampling), push.method, push.method, CONVERGED) for push in pushes
        ]
        findings += _beside(one, answer, [alone, *less], response.basis.complete_below_hz)
    return found, tuple(findings)


class _Other(NamedTuple):
    """The same answer by another way, said in short and in a sentence, and how far its numbers may be apart."""

    answer: Any
    short: str
    method: str
    allowed: float


def _beside(one: Evaluation, answer: Any, others: Sequence[_Other], complete_below_hz: float) -> Iterator[Finding]:
    """Numbers of an answer that residual vectors change by more than a little, or that are beyond the modes."""
    numbers = one.quoted(answer)
    by_ways = [(other, one.quoted(other.answer)) for other in others]
    worst: list[tuple[float, Quoted, Quoted, _Other]] = []
    for i, whole in enumerate(numbers):
        pairs = [(_quoted_apart(whole, found[i]) / other.allowed, whole, found[i], other) for other, found in by_ways]
        most = max(pairs, key=lambda pair: pair[0])
        if most[0] > 1.0 or max(whole.hz, most[2].hz) > complete_below_hz:
            worst.append(most)
    if not worst:
        return
    _, whole, changed, other = max(worst, key=lambda pair: pair[0])
    factor, unit = readable_unit(whole.unit, max(whole.value, changed.value))
    more = f". So are {len(worst)} of its {len(numbers)} numbers" if worst[1:] else ""
    values = {"allowed": other.allowed, "apart": _quoted_apart(whole, changed)}
    for _, a, b, which in worst:
        values |= {a.name: a.value, f"{b.name}, {which.short}": b.value}
    yield Finding(
        "evaluation-not-converged",
        f"{one.key()}.{one.name}: do not quote its {whole.name}. It is {factor * whole.value:.4g} {unit}, and "
        f"{factor * changed.value:.4g} {unit} {other.method}, so it may change with the number of modes "
        f"and with the mesh{more}. Compute more modes",
        values,
    )


def _quoted_apart(a: Quoted, b: Quoted) -> float:
    larger = max(abs(a.value), abs(b.value))
    return abs(a.value - b.value) / larger if larger > 0.0 else 0.0
