"""One case of a study through all its stages: damping, responses, impacts, rooms, levels, and what is told of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final

from acoustics.errors import Advice
from acoustics.levels.bands import truncate_response
from acoustics.levels.rated import RatedRoom
from acoustics.levels.sound_levels import Levels
from acoustics.room_response import RoomResponse
from femstruct.compiled.store import compilation
from femstruct.errors import Finding
from femstruct.findings.catalogue import rank_findings
from femstruct.impact.exact import is_piecewise_linear
from femstruct.impact.fatigue import Fatigue
from femstruct.impact.numerical_error import ErrorEstimate, error_of, unresolved_findings
from femstruct.impact.resampled import last_mode_hz
from femstruct.impact.response import Response
from femstruct.impact.scene import Clock, Scene
from femstruct.impact.shares import ModeEnergies, mode_energies
from femstruct.impact.simulate import BY_COLLOCATION, EXACTLY, Units, have, simulate
from femstruct.impact.system import compile_scene
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady import Vibrated
from femstruct.sound.flanking import SurfaceShares
from femstruct.sound.radiated_power import Radiated
from femstruct.sound.surfaces import coupling_findings, surface_velocities
from femstruct.study.acting import InstalledSource
from femstruct.study.asked import VOLUME_VELOCITY, TimePlan, Verdict
from femstruct.study.placed_rooms import placed_room
from femstruct.study.recorded import Channel
from femstruct.study.results import NO_OWN_SOUND, AccuracyCheck, CaseResult, Drop, Frf, OwnSound
from femstruct.study.study import Case, Study
from femstruct.workflow.accuracy import accuracy_findings
from femstruct.workflow.bases import Places, Solved, damp_basis
from femstruct.workflow.case_comparison import drop_verdicts
from femstruct.workflow.coupled_air import RoomTransfers, couple_rooms, coupled_key, weight_on_air
from femstruct.workflow.impact_findings import (
    aliased_findings,
    coarse_sampling,
    force_findings,
    force_shares_beyond_modes,
    impact_findings,
    impulse_ratios,
    mark_forces,
    missed_peaks,
    missed_pulses,
    room_findings,
    runs_with_less_static_share,
    sampled_findings,
    sensitive_forces,
    source_findings,
    walking_findings,
)
from femstruct.workflow.measured_sources import (
    apply_reduction,
    apply_reduction_to_rooms,
    covering_findings,
    footstep_findings,
    installed_sources,
    shares_by_surface,
    sound_energies,
)
from femstruct.workflow.provenance import Progress, Stopwatch
from femstruct.workflow.rated_floors import (
    Drops,
    ensemble_findings,
    room_ensembles,
    statistical_findings,
    statistical_rooms,
)
from femstruct.workflow.rated_rooms import (
    band_levels,
    blows_of,
    coincidence_findings,
    method_for,
    overlap_findings,
    rate_rooms,
)
from femstruct.workflow.recorded_channels import (
    cut_off_findings,
    damage_findings,
    empty_evaluations,
    evaluate_histories,
    fatigue_findings,
    fatigues,
    motion_rows,
    peak_findings,
    record,
    refuse_absent_forces,
    stress_findings,
)
from femstruct.workflow.responses import frequency_response, random_fatigues, vibrations
from femstruct.workflow.staging import build_scene, levels_by_receiver, own_findings, sound_of_bodies
from femstruct.workflow.study_findings import all_findings, blank_findings, room_silent, study_findings

# ----------------------------------------------------------------------------------------------------------------------
# Which compiled kernels a study needs, told before its modes are known and once they are.
# ----------------------------------------------------------------------------------------------------------------------


def expected_units(cases: Sequence[Case]) -> Units:
    """Kernels that the cases take by the laws of their contacts: what can be compiled while the modes are solved."""
    studies = [case.study for case in cases if case.study.time is not None]
    if not studies:
        return ()
    laws = [body.law for study in studies for body in study.bodies if body.law is not None]
    laws += [contact.law for study in studies for contact in study.contacts]
    blows = any(body.blows is not None for study in studies for body in study.bodies)
    return EXACTLY if not blows and all(law.straight for law in laws) else BY_COLLOCATION


def units_of(basis: ModalBasis, scene: Scene, clock: Clock) -> Units:
    """Kernels that a run of this scene takes."""
    compiled = compile_scene(basis, scene, clock)
    exact = is_piecewise_linear(compiled.system, compiled.n_samples / clock.sampling)
    return EXACTLY if exact else BY_COLLOCATION


# ----------------------------------------------------------------------------------------------------------------------
# What a study does to its structure, from the impact to what is heard: once, or once for every place of a source.
# ----------------------------------------------------------------------------------------------------------------------

STEADY: Final = (
    "blow-before-rest",
    "structure-not-decayed",
    "surface-not-decayed",
)  # so it should be of a machine that runs on
NUMBER: Final = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")
MEMBER: Final = re.compile(r"\w\.\d+\b")  # of an array: hammer.2

Timed = Callable[[str], AbstractContextManager[object]]


@dataclass(frozen=True, eq=False)
class DropRun:
    """One simulation: the motion and what the integration leaves it wrong by, None where nobody asked, the pressures,
    the levels by "ROOM.RECEIVER", the levels of every room that is to be rated {room: [receivers: {band: [dB]}]},
    reasons to trust it less, and what striking bodies are heard themselves."""

    response: Response
    errors: ErrorEstimate | None
    rooms: Mapping[str, RoomResponse]
    levels: Mapping[str, Levels]
    bands_db: Mapping[str, Sequence[Mapping[float, float]]]
    findings: tuple[Finding, ...]
    heard: OwnSound

    def drop(self, verdicts: tuple[Verdict, ...]) -> Drop:
        """What is kept of a blow at one of several places: numbers, no histories."""
        peaks = {name: contact.peak_force for name, contact in self.response.contacts.items()}
        return Drop(self.response.outcome.value, peaks, self.levels, self.heard.total_levels, verdicts)


def simulate_drops(
    studies: Mapping[str, Study],
    time: TimePlan,
    places: Places,
    basis: ModalBasis,
    vacuo: ModalBasis,
    stage: Timed,
    transfers: RoomTransfers,
    estimated: bool = True,
) -> dict[str, DropRun]:
    """Studies that differ in where a source strikes, simulated: impacts, their errors, rooms, levels, by drop.

    Raises what the stages raise.

    Parameters
    ----------
    basis : ModalBasis
        Damped, with the air that reacts on the structure.
    vacuo : ModalBasis
        Without it.
    stage : Timed
        Measures a stage by its name.
    transfers : RoomTransfers
        Of rooms computed before.
    estimated : bool
        Whether the error of each is, which takes a second simulation.

    Notes
    -----
    The pressures of all but the first drop are forgotten once their levels are known; what a room costs is paid once.
    """
    first = next(iter(studies.values()))
    needed = units_of(basis, build_scene(first, places, basis), clock_of(time))
    if not have(needed):  # others than the laws of its contacts told: fast modes take another integration
        with stage("kernels"), compilation(needed) as running:
            running.wait()
    with stage("impact"):
        responses = {drop: _hit(study, time, places, basis) for drop, study in studies.items()}
    with stage("error estimate"):
        errors = {drop: error_of(response) if estimated else None for drop, response in responses.items()}
    with stage("room"):
        ends = {plan.name: plan.heard_to_hz(basis.complete_below_hz) for plan in first.rooms}
        rooms = _rooms(first, places, responses, ends, transfers)
    runs = {}
    for drop, study in studies.items():
        with stage("levels"):
            whole = {name: by_drop.pop(drop) for name, by_drop in rooms.items()}
            own = {name: truncate_response(one, ends[name]) for name, one in whole.items()}
            levels = levels_by_receiver(own, whole)
            bands = {
                plan.name: apply_reduction(
                    study,
                    band_levels(
                        study,
                        method,
                        whole[plan.name],
                        ends[plan.name],
                        [levels[f"{plan.name}.{one.name}"] for one in plan.receivers],
                    ),
                )
                for plan in study.rooms
                if (method := method_for(plan, study)) is not None
            }
            bodies = sound_of_bodies(study, places, responses[drop], own, whole)
        findings = (
            *findings_of(study, responses[drop], errors[drop], vacuo, own, levels),
            *room_findings(own_findings(study, places, responses[drop], bodies)),
        )
        kept = own if drop == next(iter(studies)) else {}
        runs[drop] = DropRun(responses[drop], errors[drop], kept, levels, bands, findings, bodies)
    return runs


def _hit(study: Study, time: TimePlan, places: Places, basis: ModalBasis) -> Response:
    return simulate(basis, build_scene(study, places, basis), clock_of(time))


def clock_of(time: TimePlan) -> Clock:
    """Window, sampling and quiet time of an impact."""
    return Clock(time.duration, time.sampling, time.quiet)


def findings_of(
    study: Study,
    response: Response,
    errors: ErrorEstimate | None,
    vacuo: ModalBasis,
    rooms: Mapping[str, RoomResponse],
    levels_by_receiver: Mapping[str, Levels],
) -> tuple[Finding, ...]:
    """What is to be known of an impact and of what is heard of it.

    Parameters
    ----------
    vacuo : ModalBasis
        Without air that reacts on the modes.
    """
    noted: list[tuple[str, Advice | Finding]] = [
        (name, advice) for name, one in rooms.items() for advice in one.findings
    ]
    noted += [(name, advice) for name, levels in levels_by_receiver.items() for advice in levels.findings]
    noted += [(name, room_silent()) for name, one in rooms.items() if not one.p.any()]
    found = (
        *sampled_findings(study, response),
        *impact_findings(vacuo, response),
        *source_findings(study, response),
        *walking_findings(study, vacuo),
        *(() if errors is None else unresolved_findings(errors, study.accuracy.within if study.accuracy else None)),
        *room_findings(noted),
    )
    return tuple(one for one in found if blows_of(study) != "tapping" or one.code not in STEADY)


def merge_drop_findings(by_place: Mapping[str, Sequence[Finding]]) -> list[Finding]:
    """Findings of all drops {place: ...}: of those with one code the ones of the first drop that has it, and of others
    what is severe where the first is not; each with its place where there are several.

    >>> told = {"p.1": [Finding("a", "one")], "p.2": [Finding("a", "two"), Finding("b", "three")]}
    >>> [found.message for found in merge_drop_findings(told)]
    ['one (blows at p.1)', 'three (blows at p.2)']
    """
    found: list[Finding] = []
    known: dict[str, bool] = {}  # code: whether it was severe
    for place, findings in by_place.items():
        findings = merge_member_findings(findings)
        new = [one for one in findings if one.code not in known or (one.severe and not known[one.code])]
        known |= {one.code: one.severe or known.get(one.code, False) for one in new}
        after = f" (blows at {place})" if len(by_place) > 1 else ""
        found += [replace(one, message=one.message + after) for one in new]
    return found


def merge_member_findings(findings: Sequence[Finding]) -> list[Finding]:
    """Findings that say the same of every member of an array, but for its number and numbers, told of the first.

    >>> told = [Finding("a", f"hammer.{i} lasts {3 + i} ms") for i in (1, 2, 3)]
    >>> [found.message for found in merge_member_findings(told)]
    ['hammer.1 lasts 4 ms (and 2 more)']
    """
    alike: dict[tuple[str, bool, str], list[Finding]] = {}
    for one in findings:
        what = NUMBER.sub("#", one.message) if MEMBER.search(one.message) else one.message
        alike.setdefault((one.code, one.severe, what), []).append(one)
    return [
        replace(one, message=f"{one.message} (and {len(more)} more)") if more else one for one, *more in alike.values()
    ]


def _rooms(
    study: Study,
    places: Places,
    responses: Mapping[str, Response],
    ends: Mapping[str, float],
    transfers: RoomTransfers,
) -> dict[str, dict[str, RoomResponse]]:
    """What is heard in every room, by drop.

    Parameters
    ----------
    ends : Mapping[str, float]
        Up to which frequency of each is of interest [Hz].
    """
    rooms = {}
    for plan in study.rooms:
        if not plan.receivers and (plan.coupling == "two-way" or plan.room.open_air is not None):
            continue
        moving = surface_velocities(list(responses.values()), placed_room(plan, places.surfaces))
        pressures = transfers.pressures(moving, plan.room, plan.receivers, ends[plan.name])
        rooms[plan.name] = dict(zip(responses, pressures, strict=True))
    return rooms


# ----------------------------------------------------------------------------------------------------------------------
# What the history of an impact tells: recorded channels, the energy by modes, cycles; and a case of nothing else.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class History:
    """What the history of one impact tells, and what is to be known of it."""

    channels: Mapping[str, Channel]
    shares: ModeEnergies
    fatigue: Mapping[str, Fatigue]
    evaluations: Mapping[str, Mapping[str, Any]]
    findings: tuple[Finding, ...]


def evaluate_history(
    study: Study, places: Places, basis: ModalBasis, response: Response, rooms: Mapping[str, RoomResponse]
) -> History:
    """All that a study asks of the history of an impact, and of the pressures in its rooms.

    Raises InputError when a record names something that has no such quantity.
    """
    channels, shares = record(study, places, response, rooms), force_shares_beyond_modes(basis, response)
    beyond = sensitive_forces(study, response, shares)
    rows = motion_rows(study, places, basis).items()
    accelerations = {name: row for name, (what, row) in rows if what == "acceleration"}
    evaluations, of_evaluations = evaluate_histories(
        study, places, response, channels, runs_with_less_static_share(study, response, shares), impulse_ratios(beyond)
    )
    found = (
        *aliased_findings(response, accelerations),
        *missed_peaks(study, response, channels),
        *missed_pulses(study, response),
        *peak_findings(channels),
        *cut_off_findings(channels),
        *of_evaluations,
        *force_findings(beyond),
        *fatigue_findings(study, channels),
        *stress_findings({name: channel.stressed for name, channel in channels.items()}),
    )
    cycles = fatigues(study, channels, places, response)
    return History(mark_forces(channels, beyond), mode_energies(response), cycles, evaluations, found)


def run_impact(case: Case, key: str, places: Places, basis: ModalBasis, scene: Scene) -> CaseResult:
    """A case of one impact: its history and what follows from that, without rooms, frequency responses and steady
    vibration, and without an estimate of the integration's error.

    Raises what simulating and recording raise.

    Parameters
    ----------
    key : str
        Of the structure.
    basis : ModalBasis
        Damped.
    scene : Scene
        Takes the place of the study's.
    """
    study = replace(case.study, limits=tuple(limit for limit in case.study.limits if not limit.room))
    assert study.time is not None
    refuse_absent_forces(study, basis)
    response = simulate(basis, scene, clock_of(study.time))
    history = evaluate_history(study, places, basis, response, {})
    findings = [
        *findings_of(study, response, None, basis, {}, {}),
        *history.findings,
        *damage_findings(history.fatigue),
    ]
    return CaseResult(
        case=replace(case, study=study),
        basis_key=key,
        basis=basis,
        response=response,
        frf={},
        channels=history.channels,
        rooms={},
        levels={},
        findings=rank_findings(findings),
        accuracy=None,
        shares=history.shares,
        evaluations=history.evaluations,
        fatigue=history.fatigue,
    )


# ----------------------------------------------------------------------------------------------------------------------
# One case of a study through all its stages.
# ----------------------------------------------------------------------------------------------------------------------


def run_case(
    case: Case,
    solved: Mapping[str, Solved],
    baseline: Case,
    clock: Stopwatch,
    accuracy: AccuracyCheck | None = None,
    *,
    transfers: RoomTransfers,
    estimated: bool = True,
) -> CaseResult:
    """One case through every stage that its study asks for.

    Parameters
    ----------
    accuracy : AccuracyCheck | None
        What came of asking for one.
    transfers : RoomTransfers
        Of rooms computed before.
    estimated : bool
        Whether the error of the integration is.
    """
    study, own = case.study, solved[case.name]
    with clock("damping", case.name):
        basis = damp_basis(case, solved, baseline)
    with clock("judgement", case.name):
        findings = findings_before_run(case, own, basis, accuracy)
    noted: list[tuple[str, Advice | Finding]] = []
    vacuo, vibrated = basis, dict[str, Vibrated]()
    if any(plan.coupling == "two-way" for plan in study.rooms):
        with clock("coupling", case.name):
            basis, found_of_air = couple_rooms(vacuo, study.rooms, own.places)
            noted += found_of_air
    with clock("frf", case.name) as how_far:
        responses, advised = _responses(study, own.places, basis, how_far)
        noted += advised
    if study.vibration:
        with clock("vibration", case.name):
            vibrated, uneven = vibrations(study, own.places, basis)
            findings += uneven
    installed, found_of_sources = _sources(case, own.places, basis, clock)
    noted += found_of_sources
    whole: DropRun | None = None
    radiated, by_surface, cycles = dict[str, Radiated](), dict[str, SurfaceShares](), dict[str, Fatigue]()
    channels: Mapping[str, Channel] = {}
    shares, drops, rated, evaluations = None, dict[str, Drop](), {}, empty_evaluations()
    if study.time is not None:
        refuse_absent_forces(study, basis)
        studies, timed = case.drops or {"": study}, partial(clock, case=case.name)
        runs = simulate_drops(
            studies, study.time, own.places, basis, vacuo, timed, transfers=transfers, estimated=estimated
        )
        whole = next(iter(runs.values()))  # of the other drops only numbers are kept
        drops = _drops(case, runs, own.places)
        with clock("levels", case.name):
            told_of = evaluate_history(study, own.places, basis, whole.response, whole.rooms)
            shares, channels, evaluations = told_of.shares, told_of.channels, told_of.evaluations
            cycles, findings = dict(told_of.fatigue), [*findings, *told_of.findings]
        if any(plan.room.open_air is not None or len(plan.moved) > 1 for plan in study.rooms):
            with clock("sound energy", case.name):
                radiated, found_of_sound = sound_energies(study, own.places, whole.response)
                by_surface = shares_by_surface(study, own.places, whole.response, basis.complete_below_hz)
            noted += [*found_of_sound, *_silent(study, radiated)]
        findings += merge_drop_findings({place: one.findings for place, one in runs.items()})
        rated = _rated(case, runs, own.places, vacuo, clock)
        noted += [*_of_bands(rated), *weight_on_air(whole.response, vacuo, study.rooms)]
        with clock("judgement", case.name):
            noted += room_mode_findings(study, own.places, basis, vacuo)
    cycles |= random_fatigues(study, vibrated, own.places, basis)
    return CaseResult(
        case=case,
        basis_key=coupled_key(own.key, study.rooms),
        basis=basis,
        response=None if whole is None else whole.response,
        frf=responses,
        channels=channels,
        rooms={} if whole is None else whole.rooms,
        levels={} if whole is None else whole.levels,
        findings=rank_findings([*findings, *room_findings(noted), *damage_findings(cycles)]),
        accuracy=accuracy,
        shares=shares,
        rated=rated,
        drops=drops,
        errors=None if whole is None else whole.errors,
        radiated=radiated,
        heard=NO_OWN_SOUND if whole is None else whole.heard,
        evaluations=evaluations,
        vibration=vibrated,
        fatigue=cycles,
        sources=installed,
        by_surface=by_surface,
    )


def findings_before_run(case: Case, own: Solved, basis: ModalBasis, accuracy: AccuracyCheck | None) -> list[Finding]:
    """What is to be known of a case before anything happens in it.

    Parameters
    ----------
    basis : ModalBasis
        Damped.
    """
    return [
        *all_findings(own, basis, case.studies, case.study.frf),
        *study_findings(case, own.places),
        *coarse_sampling(case.study, last_mode_hz(basis), len(basis.omega)),
        *(accuracy_findings(accuracy) if accuracy is not None else ()),
        *covering_findings(case.studies, own.places, basis),
        *footstep_findings(case.study, own.places, basis),
    ]


def _sources(
    case: Case, places: Places, basis: ModalBasis, clock: Stopwatch
) -> tuple[dict[str, InstalledSource], list[tuple[str, Advice | Finding]]]:
    """What measured sources do, by name, and what is to be known of it."""
    if not case.study.sources:
        return {}, []
    with clock("sources", case.name):
        return installed_sources(case.study, places, basis)


def _rated(
    case: Case, drop_runs: Mapping[str, DropRun], places: Places, vacuo: ModalBasis, clock: Stopwatch
) -> dict[str, RatedRoom]:
    """Every room that is to be rated, by name, from all drops; what is beyond the modes and over an ensemble."""
    study, runs = case.study, list(drop_runs.values())
    drops = Drops(case.drops or {"": study}, {place: one.response for place, one in drop_runs.items()})
    with clock("ensemble", case.name):
        ensembles = room_ensembles(drops, places, vacuo)
    with clock("levels", case.name):
        beside = apply_reduction_to_rooms(study, statistical_rooms(study, len(runs)), ensembles)
        return rate_rooms(study, [one.bands_db for one in runs], *beside)


def _silent(study: Study, radiated: Mapping[str, Radiated]) -> list[tuple[str, Finding]]:
    """What is to be known of open air where nobody listens and that nothing moves, by room."""
    still = {name for name, one in radiated.items() if one.energy.energy_j == 0.0}
    return [(plan.name, room_silent()) for plan in study.rooms if plan.name in still and not plan.receivers]


def _of_bands(rated: Mapping[str, RatedRoom]) -> list[tuple[str, Advice | Finding]]:
    """What is to be known of bands beyond the modes and of low ones, by room."""
    found = {name: (*statistical_findings(room), *ensemble_findings(room)) for name, room in rated.items()}
    return [(name, one) for name, findings in found.items() for one in findings]


def _drops(case: Case, runs: Mapping[str, DropRun], places: Places) -> dict[str, Drop]:
    """What is kept of every place that a source strikes, with the verdicts on it."""
    found = ((place, runs[place], study) for place, study in case.drops.items())
    return {place: one.drop(drop_verdicts(study, places, one.response)) for place, one, study in found}


def _responses(
    study: Study, places: Places, basis: ModalBasis, progress: Progress
) -> tuple[dict[str, Frf], list[tuple[str, Advice | Finding]]]:
    """The frequency responses a study asks for, by name, and what is to be known of them."""
    found: dict[str, Frf] = {}
    noted: list[tuple[str, Advice | Finding]] = []
    for request in study.frf:
        found[request.name], advised = frequency_response(request, places, basis, study.rooms, progress)
        end = request.drive if request.drive.what == VOLUME_VELOCITY else request.response
        own = f"frf.{request.name}"
        noted += [(own if isinstance(one, Finding) else end.name, one) for one in advised]
    return found, noted


def room_mode_findings(
    study: Study, places: Places, basis: ModalBasis, vacuo: ModalBasis
) -> list[tuple[str, Advice | Finding]]:
    """What the modes tell of rooms, by room.

    Parameters
    ----------
    basis : ModalBasis
        With the air that reacts on the structure.
    vacuo : ModalBasis
        Without it.
    """
    noted: list[tuple[str, Advice | Finding]] = []
    for plan in study.rooms:
        room = placed_room(plan, places.surfaces)
        found: list[Advice | Finding] = [
            *overlap_findings(plan, study, vacuo),
            *blank_findings(plan, study, basis.complete_below_hz),
            *coincidence_findings(plan, study, room, vacuo),
            *(coupling_findings(vacuo, room) if plan.coupling == "one-way" else ()),
        ]
        noted += [(plan.name, one) for one in found]
    return noted
