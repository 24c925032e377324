"""One case of a study through all its stages: damping, responses, impacts, rooms, levels, and what is told of them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from acoustics.errors import Advice
from acoustics.levels.rated import RatedRoom
from femstruct.errors import Finding
from femstruct.findings.catalogue import ranked
from femstruct.impact.closer import last_mode_hz
from femstruct.impact.result.fatigue import Fatigue
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady.answers import Vibrated
from femstruct.sound.flanking import SurfaceShares
from femstruct.sound.power import Radiated
from femstruct.sound.surface import coupling_findings
from femstruct.study.asked import VOLUME_VELOCITY
from femstruct.study.measured_source import InstalledSource
from femstruct.study.recorded import Channel
from femstruct.study.result import NO_OWN_SOUND, AccuracyCheck, CaseResult, Drop, Frf
from femstruct.study.room_surfaces import placed_room
from femstruct.study.study import Case, Study
from femstruct.workflow.compare.verdicts import judged
from femstruct.workflow.continuation.ensemble_findings import ensemble_findings
from femstruct.workflow.continuation.room_ensembles import Drops, room_ensembles
from femstruct.workflow.continuation.statistical_findings import statistical_findings
from femstruct.workflow.continuation.statistical_rooms import statistical_rooms
from femstruct.workflow.judgement.all_findings import all_findings
from femstruct.workflow.judgement.blank_bands import blank_findings, room_silent
from femstruct.workflow.judgement.coarse_sampling import coarse_sampling
from femstruct.workflow.judgement.impact_findings import room_findings
from femstruct.workflow.judgement.meeting import meeting_findings
from femstruct.workflow.judgement.study_findings import study_findings
from femstruct.workflow.progress import Progress
from femstruct.workflow.run.accuracy import accuracy_findings
from femstruct.workflow.run.impact_alone import of_history
from femstruct.workflow.run.provenance import Stopwatch
from femstruct.workflow.run.struck import Struck, strike, told_once
from femstruct.workflow.stages.coupled_air import coupled, coupled_key, weight_on_air
from femstruct.workflow.stages.measured.covered import covered_floor, reduced_rooms
from femstruct.workflow.stages.measured.footsteps import footstep_findings
from femstruct.workflow.stages.measured.installed_sources import installed_sources
from femstruct.workflow.stages.modal_bases import Solved, damped
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.rated_rooms import overlap_findings, rate_rooms
from femstruct.workflow.stages.recorded.channels import refuse_absent_forces
from femstruct.workflow.stages.recorded.evaluated import nothing_evaluated
from femstruct.workflow.stages.recorded.peaks import damage_findings
from femstruct.workflow.stages.responses import frequency_response
from femstruct.workflow.stages.room_transfers import RoomTransfers
from femstruct.workflow.stages.sound_energies import shares_by_surface, sound_energies
from femstruct.workflow.stages.vibrations import random_fatigues, vibrations


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
    """One case through every stage that its study asks for; accuracy : what came of asking for one; transfers : of
    rooms computed before; estimated : whether the error of the march is."""
    study, own = case.study, solved[case.name]
    with clock("damping", case.name):
        basis = damped(case, solved, baseline)
    with clock("judgement", case.name):
        findings = known_before(case, own, basis, accuracy)
    told: list[tuple[str, Advice | Finding]] = []
    vacuo, vibrated = basis, dict[str, Vibrated]()
    if any(plan.coupling == "two-way" for plan in study.rooms):
        with clock("coupling", case.name):
            basis, found_of_air = coupled(vacuo, study.rooms, own.places)
            told += found_of_air
    with clock("frf", case.name) as how_far:
        responses, advised = _responses(study, own.places, basis, how_far)
        told += advised
    if study.vibration:
        with clock("vibration", case.name):
            vibrated, uneven = vibrations(study, own.places, basis)
            findings += uneven
    installed, found_of_sources = _sources(case, own.places, basis, clock)
    told += found_of_sources
    whole: Struck | None = None
    radiated, by_surface, cycles = dict[str, Radiated](), dict[str, SurfaceShares](), dict[str, Fatigue]()
    channels: Mapping[str, Channel] = {}
    shares, drops, rated, evaluations = None, dict[str, Drop](), {}, nothing_evaluated()
    if study.time is not None:
        refuse_absent_forces(study, basis)
        timed = partial(clock, case=case.name)
        struck = strike(case.drops or {"": study}, study.time, own.places, basis, vacuo, timed, transfers, estimated)
        whole = next(iter(struck.values()))  # of the other drops only numbers are kept
        drops = _drops(case, struck, own.places)
        with clock("levels", case.name):
            told_of = of_history(study, own.places, basis, whole.response, whole.rooms)
            shares, channels, evaluations = told_of.shares, told_of.channels, told_of.evaluations
            cycles, findings = dict(told_of.fatigue), [*findings, *told_of.findings]
        if any(plan.room.open_air is not None or len(plan.moved) > 1 for plan in study.rooms):
            with clock("sound energy", case.name):
                radiated, found_of_sound = sound_energies(study, own.places, whole.response)
                by_surface = shares_by_surface(study, own.places, whole.response, basis.complete_below_hz)
            told += [*found_of_sound, *_silent(study, radiated)]
        findings += told_once({place: one.findings for place, one in struck.items()})
        rated = _rated(case, struck, own.places, vacuo, clock)
        told += [*_of_bands(rated), *weight_on_air(whole.response, vacuo, study.rooms)]
        with clock("judgement", case.name):
            told += known_of_rooms(study, own.places, basis, vacuo)
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
        findings=ranked([*findings, *room_findings(told), *damage_findings(cycles)]),
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


def known_before(case: Case, own: Solved, basis: ModalBasis, accuracy: AccuracyCheck | None) -> list[Finding]:
    """What is to be known of a case before anything happens in it. basis : damped."""
    return [
        *all_findings(own, basis, case.studies, case.study.frf),
        *study_findings(case, own.places),
        *coarse_sampling(case.study, last_mode_hz(basis), len(basis.omega)),
        *(accuracy_findings(accuracy) if accuracy is not None else ()),
        *covered_floor(case.studies, own.places, basis),
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
    case: Case, struck: Mapping[str, Struck], places: Places, vacuo: ModalBasis, clock: Stopwatch
) -> dict[str, RatedRoom]:
    """Every room that is to be rated, by name, from all drops; what is beyond the modes and over an ensemble."""
    study, runs = case.study, list(struck.values())
    drops = Drops(case.drops or {"": study}, {place: one.response for place, one in struck.items()})
    with clock("ensemble", case.name):
        ensembles = room_ensembles(drops, places, vacuo)
    with clock("levels", case.name):
        beside = reduced_rooms(study, statistical_rooms(study, len(runs)), ensembles)
        return rate_rooms(study, [one.bands_db for one in runs], *beside)


def _silent(study: Study, radiated: Mapping[str, Radiated]) -> list[tuple[str, Finding]]:
    """What is to be known of open air where nobody listens and that nothing moves, by room."""
    still = {name for name, one in radiated.items() if one.energy.energy_j == 0.0}
    return [(plan.name, room_silent()) for plan in study.rooms if plan.name in still and not plan.receivers]


def _of_bands(rated: Mapping[str, RatedRoom]) -> list[tuple[str, Advice | Finding]]:
    """What is to be known of bands beyond the modes and of low ones, by room."""
    found = {name: (*statistical_findings(room), *ensemble_findings(room)) for name, room in rated.items()}
    return [(name, one) for name, findings in found.items() for one in findings]


def _drops(case: Case, struck: Mapping[str, Struck], places: Places) -> dict[str, Drop]:
    """What is kept of every place that a source strikes, with the verdicts on it."""
    found = ((place, struck[place], study) for place, study in case.drops.items())
    return {place: one.drop(judged(study, places, one.response)) for place, one, study in found}


def _responses(
    study: Study, places: Places, basis: ModalBasis, progress: Progress
) -> tuple[dict[str, Frf], list[tuple[str, Advice | Finding]]]:
    """The frequency responses a study asks for, by name, and what is to be known of them."""
    found: dict[str, Frf] = {}
    told: list[tuple[str, Advice | Finding]] = []
    for request in study.frf:
        found[request.name], advised = frequency_response(request, places, basis, study.rooms, progress)
        end = request.drive if request.drive.what == VOLUME_VELOCITY else request.response
        own = f"frf.{request.name}"
        told += [(own if isinstance(one, Finding) else end.name, one) for one in advised]
    return found, told


def known_of_rooms(
    study: Study, places: Places, basis: ModalBasis, vacuo: ModalBasis
) -> list[tuple[str, Advice | Finding]]:
    """What the modes tell of rooms, by room. basis : with the air that reacts on the structure; vacuo : without it."""
    told: list[tuple[str, Advice | Finding]] = []
    for plan in study.rooms:
        room = placed_room(plan, places.surfaces)
        found: list[Advice | Finding] = [
            *overlap_findings(plan, study, vacuo),
            *blank_findings(plan, study, basis.complete_below_hz),
            *meeting_findings(plan, study, room, vacuo),
            *(coupling_findings(vacuo, room) if plan.coupling == "one-way" else ()),
        ]
        told += [(plan.name, one) for one in found]
    return told
