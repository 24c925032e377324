"""Cases beside their baseline: peaks in percent, bands and modes in decibels, modes by shape."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isfinite, nan
from typing import Final, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from acoustics.levels.rated import RatedRoom
from femstruct.arrays import Floats
from femstruct.errors import InputError, list_some
from femstruct.files.study_tables import growth
from femstruct.impact.blow_by_blow import AT_REST, structure_energy
from femstruct.impact.resampled import ENOUGH, resample, samples_of_a_pulse
from femstruct.impact.response import EnergyBalance, Response
from femstruct.modal.basis import ModalBasis
from femstruct.modal.likeness import pairing, share_nodes
from femstruct.study.asked import SETTLED, Companion, EnergyShare, GroundForce, Limit, Machine, Rest, Verdict
from femstruct.study.recorded import NET_FORCE, Channel
from femstruct.study.results import CaseComparison, CaseResult, Comparison, Drop, PeakChange
from femstruct.study.study import Study
from femstruct.workflow.bases import Places, Solved, planned_contacts, weighs
from femstruct.workflow.check import block_modes
from femstruct.workflow.recorded_channels import (
    agree,
    closings,
    converged,
    filter_sentence,
    histories,
    motion_of,
    record,
    two_changes,
    weight_on_ground,
)
from femstruct.workflow.staging import ordered

# ----------------------------------------------------------------------------------------------------------------------
# A channel of a case beside that of the baseline, in decibels at the modes of the baseline.
# ----------------------------------------------------------------------------------------------------------------------

NEAR = 0.02  # a spectral peak belongs to a mode within 2 % of its frequency
FINENESS = 0.2  # Hz between spectral lines at most, so that 2 % of the lowest modes holds some, ...
PADDING = 100  # ... but no more lines than that many times the record's own: two in 2 % of the lowest mode it shows
RESOLVED: Final = 0.25  # of the lower of two samplings: above it, what is folded differs between them
STILL: Final = 1e-9  # of the other case: 180 dB less, or more, is rounding of what does not move
_ROUNDING: Final = 1e-9  # of a count of samples


class Spectra:
    """Amplitude spectra of channels, held by who compares cases: a channel that is compared again keeps its own."""

    def __init__(self) -> None:
        self._kept: WeakKeyDictionary[Channel, tuple[tuple[float, int], Floats]] = WeakKeyDictionary()

    def of(self, channel: Channel, sampling: float, count: int | None = None) -> Floats:
        """|FFT| of the first samples of a record, all if None, padded with zeros; sampling [Hz]."""
        values = channel.values[:count]
        key = sampling, len(values)
        kept = self._kept.get(channel)
        if kept is not None and kept[0] == key:
            return kept[1]
        least_length = min(sampling / FINENESS, PADDING * len(values))
        length = 2 ** int(np.ceil(np.log2(max(2 * len(values), least_length))))
        spectrum = np.abs(np.fft.rfft(values, length))
        self._kept[channel] = key, spectrum
        return spectrum


def mode_attenuation(reference: CaseResult, result: CaseResult, channel: str, spectra: Spectra) -> dict[int, float]:
    """Attenuation [dB] of a channel's spectrum at the baseline's own peaks, by the number of the mode they belong to.

    A mode is listed when the baseline's spectrum has a local maximum within 2 % of its frequency; a net force, which
    has no peaks at modes, is compared at the frequency of every mode. A record shorter than one period of a mode does
    not show it, nor does a room above its own modes, nor what moves with rounding errors alone in either case. The
    spectrum is that of the whole record, not windowed; of repeated blows it is a comb of their interval, and no mode is
    listed.

    Notes
    -----
    Of two records the longer one is cut to the other, and both spectra are taken at the same frequencies: the integral
    of x exp(-2 pi i f t) over time. Where the samplings are equal it is compared line by line of the FFT; where they
    differ, as sums over each record's own samples, the first of which counts half, up to a quarter of the lower
    sampling.
    """
    if reference.response is None or result.response is None or reference.response.blows or result.response.blows:
        return {}
    own, other = reference.channels[channel], result.channels[channel]
    samplings = reference.response.clock.sampling, result.response.clock.sampling
    window = min(len(one.values) / sampling for one, sampling in zip((own, other), samplings, strict=True))
    counts = [int(window * sampling * (1.0 + _ROUNDING)) for sampling in samplings]
    before = spectra.of(own, samplings[0], counts[0])
    step = samplings[0] / (2.0 * (len(before) - 1))
    found = dict(_lines(reference, channel, before, step, 1.0 / window))
    if samplings[0] == samplings[1]:
        after = spectra.of(other, samplings[1], counts[1])
        pairs = {mode: (float(before[line]), float(after[line])) for mode, line in found.items()}
    else:
        pairs = {
            mode: (
                spectral_size(own.values[: counts[0]], samplings[0], line * step),
                spectral_size(other.values[: counts[1]], samplings[1], line * step),
            )
            for mode, line in found.items()
            if line * step <= RESOLVED * min(samplings)
        }
    return {mode: float(20.0 * np.log10(a / b)) for mode, (a, b) in pairs.items() if min(a, b) > STILL * max(a, b)}


def _lines(
    reference: CaseResult, channel: str, before: Floats, step: float, slowest: float
) -> Iterator[tuple[int, int]]:
    """Modes by number, each with the line of the baseline's spectrum it is compared at.

    Parameters
    ----------
    step, slowest : float [Hz]
        Between lines; one period in the record.
    """
    rooms = reference.case.study.rooms
    highest = min((plan.complete_below_hz for plan in rooms if channel.startswith(f"{plan.name}.")), default=np.inf)
    top = np.flatnonzero((before[1:-1] > before[:-2]) & (before[1:-1] >= before[2:])) + 1
    for number, (kind, frequency) in enumerate(zip(reference.basis.kind, reference.basis.frequency_hz, strict=True), 1):
        near = top[slice(*np.searchsorted(top, np.array([1.0 - NEAR, 1.0 + NEAR]) * frequency / step))]
        if channel.startswith(NET_FORCE):
            near = np.array([round(frequency / step)])
        if kind == "elastic" and slowest <= frequency <= highest and near.size and near[-1] < len(before):
            yield number, int(near[before[near].argmax()])


def spectral_size(values: Floats, sampling: float, frequency: float) -> float:
    """|Integral of x exp(-2 pi i f t)| over a record [nt] that begins at t = 0 [unit s]; sampling, frequency [Hz].

    >>> t = np.arange(20_000) / 20e3
    >>> round(spectral_size(np.exp(-30.0 * t), 20e3, 0.0), 6)  # 1 / 30
    0.033333
    """
    turns = np.exp((-2j * np.pi * frequency / sampling) * np.arange(len(values)))
    return float(abs(values @ turns - 0.5 * values[0])) / sampling


# ----------------------------------------------------------------------------------------------------------------------
# Cases beside their baseline.
# ----------------------------------------------------------------------------------------------------------------------

NO_NODE: Final = "modes are not compared: the structures have no node in common"
SAME: Final = 1e-9  # relative rounding of a duration


def compare(baseline: str, results: Mapping[str, CaseResult], spectra: Spectra) -> Comparison:
    """All other cases beside the baseline.

    Parameters
    ----------
    spectra : Spectra
        Of channels that were compared before; those of these cases are added.

    Notes
    -----
    When all force enters a linear structure at one point, every output has the spectrum of that force times its own
    transfer function, so all attenuations of one mode are equal, and equal to that of the net force.
    """
    reference = results[baseline]
    others = {name: _beside(reference, result, spectra) for name, result in results.items() if name != baseline}
    return Comparison(baseline, others, filter_sentence(reference.case.study.peaks))


def _beside(reference: CaseResult, result: CaseResult, spectra: Spectra) -> CaseComparison:
    shared = [name for name in reference.channels if name in result.channels]
    alike = _comparable(reference.basis, result.basis)
    return CaseComparison(
        peaks={name: _peak_change(reference.channels[name], result.channels[name]) for name in shared},
        bands_db={
            name: _band_attenuation(levels.bands_db, result.levels[name].bands_db)
            for name, levels in reference.levels.items()
            if name in result.levels
        },
        modes_db={name: mode_attenuation(reference, result, name, spectra) for name in shared} if alike else {},
        frequencies=mode_table(reference.basis, result.basis) if alike else {},
        notes=tuple(_notes(reference, result, alike)),
    )


def _comparable(reference: ModalBasis, basis: ModalBasis) -> bool:
    """Whether the modes of two bases can be those of one structure; without modes there is nothing to tell them by."""
    return not (reference.modes.stop and basis.modes.stop) or share_nodes(reference, basis)


def _notes(reference: CaseResult, result: CaseResult, alike: bool) -> Iterator[str]:
    """Sentences on what of a case and its baseline is not compared, or not as a whole."""
    if not alike:
        yield NO_NODE
    first, second = (filter_sentence(one.case.study.peaks) for one in (reference, result))
    if first != second:
        yield f"its peaks have another filter than those of the baseline: {second}"
    if reference.response is None or result.response is None:
        return
    clock, own = reference.response.clock, result.response.clock
    modes = alike and not (reference.response.blows or result.response.blows)
    if not np.isclose(clock.duration, own.duration, rtol=SAME, atol=0.0):
        shorter = min(clock.duration, own.duration)
        over = f"; modes are compared over the first {shorter:g} s" if modes else ""
        whole = "peaks and levels are of each one's whole window"
        yield f"its window is {own.duration:g} s, that of the baseline {clock.duration:g} s: {whole}{over}"
    if own.sampling != clock.sampling and modes:
        top = RESOLVED * min(clock.sampling, own.sampling)
        samplings = f"its sampling is {own.sampling:g} Hz, that of the baseline {clock.sampling:g} Hz"
        yield f"{samplings}: modes are compared up to {top:g} Hz"


def _peak_change(reference: Channel, channel: Channel) -> PeakChange:
    def percent(before: float, after: float) -> float | None:
        return 100.0 * (after / before - 1.0) if before > 0.0 else None

    changes = two_changes(reference, channel)
    return PeakChange(
        percent(reference.first_impact, channel.first_impact),
        percent(reference.whole, channel.whole),
        converged=changes is None or agree(changes),
    )


def _band_attenuation(reference: Mapping[float, float], levels: Mapping[float, float]) -> dict[float, float]:
    return {
        centre: reference[centre] - levels[centre]
        for centre in reference
        if centre in levels and np.isfinite(reference[centre]) and np.isfinite(levels[centre])
    }


def mode_table(reference: ModalBasis, basis: ModalBasis) -> dict[int, tuple[int, float, float]]:
    """The mode most alike to each of the baseline's, its frequency [Hz] and the MAC; empty for the same basis.

    Empty, too, for a basis without a mode. Where frequencies are near-equal the MAC is that with their space, and every
    mode of it has its own partner.
    """
    if not (reference.modes.stop and basis.modes.stop):
        return {}
    if reference.omega.shape == basis.omega.shape and np.array_equal(reference.shapes, basis.shapes):
        return {}
    pairs = pairing(reference, basis)
    return {
        mode + 1: (int(partner) + 1, float(basis.frequency_hz[partner]), pairs.alike(mode))
        for mode, partner in enumerate(pairs.partner)
    }


# ----------------------------------------------------------------------------------------------------------------------
# Verdicts on the limits of a study. A limit that is exceeded is a result, not a failure: it has no exit code.
# ----------------------------------------------------------------------------------------------------------------------

T = TypeVar("T")
SAME_INTERVAL = 1e-9  # relative rounding of an interval that is a difference of two times


def verdicts(case: CaseResult) -> tuple[Verdict, ...]:
    """What came of every limit of a case: peaks are those of the whole window, through the filter of `peaks`.

    Where a source strikes several places, of each limit the worst over the drops; ratings are of all drops together.
    """
    if case.response is None:
        return ()
    limits = case.case.study.limits
    own = _of_one_run(limits, case.channels, case.response) if not case.drops else _worst(case.drops)
    found = iter(own)
    return tuple(
        _rating(limit, _known(limit, limit.room, case.rated)) if limit.room else next(found) for limit in limits
    )


def drop_verdicts(study: Study, places: Places, response: Response) -> tuple[Verdict, ...]:
    """What came of the limits of one drop of several, but for those of ratings."""
    if not any(not limit.room for limit in study.limits):
        return ()
    return _of_one_run(study.limits, record(study, places, response, {}), response)


def _of_one_run(limits: Sequence[Limit], channels: Mapping[str, Channel], response: Response) -> tuple[Verdict, ...]:
    """Without those of ratings, which are of all drops."""
    exact = {f"{name} force" for name in response.contacts}
    least = set(channels) - exact if samples_of_a_pulse(response) < ENOUGH else set()
    return tuple(
        _settled(limit, response)
        if limit.name == SETTLED
        else _peak(limit, _known(limit, limit.name, channels), limit.name in least)
        for limit in limits
        if not limit.room
    )


def _known(limit: Limit, name: str, found: Mapping[str, T]) -> T:
    """What a limit is of. Raises InputError for what is not recorded, or not rated: a study in Python may have it."""
    if name not in found:
        what = "a rated room" if limit.room else f"a recorded channel or {SETTLED}"
        raise InputError(f"limits.{limit.name}", got=f"'{name}'", expected=f"{what}: {list_some(found)}".rstrip(": "))
    return found[name]


def _worst(drops: Mapping[str, Drop]) -> tuple[Verdict, ...]:
    """Of every limit the verdict of the worst drop, with its place."""
    by_limit = zip(*(drop.verdicts for drop in drops.values()), strict=True)
    found = []
    for several in by_limit:
        place, worst = max(zip(drops, several, strict=True), key=lambda pair: _badness(pair[1]))
        found.append(replace(worst, name=_common([one.name for one in several]), at=place))
    return tuple(found)


def _badness(verdict: Verdict) -> tuple[int, float]:
    """Exceeded is worse than not seen, and that than met; then the larger value is, and most of all none."""
    rank = 2 if verdict.met is False else 1 if verdict.met is None else 0
    return rank, np.inf if verdict.value is None else verdict.value


def _common(names: Sequence[str]) -> str:
    """What a limit is called for all drops.

    >>> _common(["ball on drops.1 force", "ball on drops.2 force"])
    'ball on drops force'
    """
    words = zip(*(name.split(" ") for name in names), strict=True)
    return " ".join(one[0] if len(set(one)) == 1 else one[0].rpartition(".")[0] for one in words)


def _rating(limit: Limit, room: RatedRoom) -> Verdict:
    """The number that the room's standards state, as a building code asks for it; of a lower bound it can only be told
    that it is too high."""
    if room.rating is None:  # withheld
        return Verdict(limit.name, None, limit.value, "dB", None, least=True)
    value = room.rating.value_db
    if not room.rating.blank_hz:
        met, beyond = value <= limit.value, room.rating.statistical
        return Verdict(limit.name, value, limit.value, "dB", met, statistical=beyond)
    least = value if isfinite(value) else None
    return Verdict(limit.name, least, limit.value, "dB", False if value > limit.value else None, least=True)


def _peak(limit: Limit, channel: Channel, least: bool) -> Verdict:
    """least : whether the peak is a lower bound."""
    if not isfinite(channel.whole):  # its samples are too coarse to tell
        return Verdict(limit.name, None, limit.value, channel.unit, None, least=True)
    met = channel.whole <= limit.value
    verdict = None if met and least else met
    sure = converged(channel)
    return Verdict(limit.name, channel.whole, limit.value, channel.unit, verdict, least=least, converged=sure)


def _settled(limit: Limit, response: Response) -> Verdict:
    """The longest time to rest; not at rest in an interval no shorter than the limit is an answer, too."""
    waits = settling(response)
    seen = min((interval for after, interval in waits if after is None), default=0.0)
    late = any(
        after > limit.value if after is not None else interval >= limit.value * (1.0 - SAME_INTERVAL)
        for after, interval in waits
    )
    times = [after for after, _ in waits if after is not None]
    value = max(times) if times and len(times) == len(waits) else None
    met = False if late else None if value is None else True
    return Verdict(limit.name, value, limit.value, "s", met, seen if value is None else None)


def settling(response: Response) -> tuple[tuple[float | None, float], ...]:
    """After every blow, the time until the structure has less than 1 % of its largest energy for good [s], None when it
    has not in its interval, and that interval [s], to the end of the window at most.

    Without blows: once, from the first closing on (from the start where nothing closes).
    """
    if response.blows:
        return tuple((blow.rest_after, blow.interval) for blow in response.blows)
    start = min((event.t for event in closings(response)), default=0.0)
    energy = structure_energy(response.motion, response.basis.omega)
    loud = np.flatnonzero(energy > AT_REST * energy.max(initial=0.0))
    if not loud.size:
        return ((0.0, float(response.t[-1]) - start),)
    after = float(response.t[min(loud[-1] + 1, len(energy) - 1)]) - start
    return ((after if loud[-1] + 1 < len(energy) else None, float(response.t[-1]) - start),)


# ----------------------------------------------------------------------------------------------------------------------
# What a press engineer must see first, one row a case: ground force, travels, sags, rest, dampers, energy, growth.
#
# It is made for studies with blows, and of those that record the force on the ground.
# ----------------------------------------------------------------------------------------------------------------------

GROUND_FORCE = "ground force"


def is_machine_study(study: Study) -> bool:
    """Whether a study is about a machine: something strikes again and again, or the force on the ground is recorded."""
    recorded = any(str(record) == GROUND_FORCE for record in study.records)
    return recorded or any(body.blows is not None for body in study.bodies)


def machines(baseline: str, cases: Mapping[str, CaseResult], solved: Mapping[str, Solved]) -> dict[str, Machine]:
    """A row for every case that was simulated; none at all unless one of them is about a machine."""
    if not any(is_machine_study(case.case.study) for case in cases.values()):
        return {}
    ground = cases[baseline].channels.get(GROUND_FORCE)
    reference = ground.whole if ground is not None and cases[baseline].response is not None else None
    return {
        name: _machine(case, case.response, solved[name], None if name == baseline else reference)
        for name, case in cases.items()
        if case.response is not None
    }


def _machine(case: CaseResult, response: Response, own: Solved, reference: float | None) -> Machine:
    study, model = case.case.study, own.model
    striking = impacting_bodies(study)
    waits = settling(response) if response.blows else ()
    afters = [after for after, _ in waits if after is not None]
    separation = response.ledger.at_separation
    pressed = GROUND_FORCE in case.channels and weighs(study)
    near = resample(response) if pressed or set(response.bodies) - striking else response
    return Machine(
        ground=_ground(case, reference, own.places, near),
        travels={
            name: channel.whole
            for name, channel in case.channels.items()
            if name.endswith(" displacement") and name.rpartition(" ")[0] not in response.bodies
        },
        sags=own.under_all(study),
        modes=() if model is None else block_modes(model, case.basis),
        rest=Rest(max(afters) if len(afters) == len(waits) else None, min(i for _, i in waits)) if waits else None,
        companions={
            name: _companion(name, study, own.places, response, near)
            for name in response.bodies
            if name not in striking
        },
        at_separation=None if separation is None else energy_share(separation, response, striking, apart=True),
        at_end=energy_share(response.ledger.end, response, striking),
        growth={
            name: growth([blow for blow in response.blows if blow.body == name])
            for name in dict.fromkeys(blow.body for blow in response.blows)
        },
    )


def impacting_bodies(study: Study) -> set[str]:
    """The bodies with blows; where there are none, those that start with a speed."""
    repeated = {body.name for body in study.bodies if body.blows is not None}
    return repeated or {body.name for body in study.bodies if body.speed}


def _ground(case: CaseResult, reference: float | None, places: Places, near: Response | None) -> GroundForce | None:
    """near : the run with samples that show its peaks, None where there is none."""
    channel, study = case.channels.get(GROUND_FORCE), case.case.study
    if channel is None:
        return None
    pressed = None
    weight = weight_on_ground(study, case.basis)
    if weight is not None and near is not None:
        values = channel.values if near is case.response else histories(study, places, near)[GROUND_FORCE][0]
        pressed = float(np.abs(values - weight).max())  # z is up: the weight is a negative force on the ground
    beside = reference is not None and reference > 0.0 and channel.whole > 0.0
    ratio = channel.whole / reference if beside and reference else None
    return GroundForce(
        dynamic=channel.whole,
        with_weight=pressed,
        percent=None if ratio is None else 100.0 * (ratio - 1.0),
        attenuation_db=None if ratio is None else float(-20.0 * np.log10(ratio)),
    )


def _companion(name: str, study: Study, places: Places, response: Response, near: Response | None) -> Companion:
    body = next(body for body in study.bodies if body.name == name)
    beside = nan if near is None else near.bodies[name].displacement - motion_of(body.target, study, places, near)
    mine = [
        response.contacts[planned.name]
        for planned in planned_contacts(study)
        if name in ordered(study, places, planned)
    ]
    seated = any(contact.force[-1] > 0.0 for contact in mine) if mine else None
    return Companion(float(np.abs(beside).max()), sum(contact.closings for contact in mine), seated)


def energy_share(balance: EnergyBalance, response: Response, striking: set[str], apart: bool = False) -> EnergyShare:
    """Where the energy put in until an instant is. A contact or link between a striking body and another one counts as
    the striking body's.

    Parameters
    ----------
    apart : bool
        All contacts are without force. What a damped spring still holds then is lost, nothing takes it back.
    """
    start, scene = response.ledger.start, response.scene
    joins = {join.name: {end for end in (join.upper, join.lower) if isinstance(end, str)} for join in scene.contacts}
    joins |= {join.name: {end for end in (join.upper, join.lower) if isinstance(end, str)} for join in scene.links}
    held = {**balance.contacts, **balance.links}
    lost = {**balance.lost_contacts, **balance.lost_links}
    strike = [name for name, ends in joins.items() if ends & striking]
    others = [name for name, ends in joins.items() if ends and not ends & striking]
    plain = [name for name, ends in joins.items() if not ends]
    springs = sum(held[name] for name in strike)
    kinetic = {True: 0.0, False: 0.0}
    for name, energy in balance.bodies.items():
        kinetic[name in striking] += energy
    stored = sum(start.bodies.values()) + start.structure + sum(start.contacts.values()) + sum(start.links.values())
    return EnergyShare(
        t=balance.t,
        put_in=stored + balance.work + balance.blows,
        forged=sum(lost[name] for name in strike) + (springs if apart else 0.0),
        strikers=kinetic[True] + (0.0 if apart else springs),
        structure=balance.structure + sum(held[name] for name in plain),
        companions=kinetic[False] + sum(held[name] + lost[name] for name in others),
        dissipated=balance.lost_modes + sum(lost[name] for name in plain),
    )
