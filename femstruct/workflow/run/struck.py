"""What a study does to its structure, from the impact to what is heard: once, or once for every place of a source."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import Final

from acoustics.errors import Advice
from acoustics.levels.ending import ended
from acoustics.levels.sound_levels import Levels
from acoustics.room_response import RoomResponse
from femstruct.errors import Finding
from femstruct.impact.compiled.workers import compilation
from femstruct.impact.engine.needed_units import have
from femstruct.impact.estimate import ErrorEstimate, error_of
from femstruct.impact.result.response import Response
from femstruct.impact.scene.bodies import Clock
from femstruct.impact.simulate import simulate
from femstruct.impact.unresolved import unresolved_findings
from femstruct.modal.basis import ModalBasis
from femstruct.sound.surface import surface_velocities
from femstruct.study.asked import TimePlan
from femstruct.study.machine import Verdict
from femstruct.study.result import Drop, OwnSound
from femstruct.study.room_surfaces import placed_room
from femstruct.study.study import Study
from femstruct.workflow.judgement.blank_bands import room_silent
from femstruct.workflow.judgement.impact_findings import impact_findings, room_findings, sampled_findings
from femstruct.workflow.judgement.source_findings import source_findings, walking_findings
from femstruct.workflow.run.needed_kernels import units_of
from femstruct.workflow.stages.measured.covered import reduced
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.rated_rooms import band_levels, blows_of, method_for
from femstruct.workflow.stages.room_transfers import RoomTransfers
from femstruct.workflow.stages.staging import scene
from femstruct.workflow.stages.struck_bodies import levels_by_receiver, own_findings, sound_of_bodies

STEADY: Final = (
    "blow-before-rest",
    "structure-not-decayed",
    "surface-not-decayed",
)  # so it should be of a machine that runs on
NUMBER: Final = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")
MEMBER: Final = re.compile(r"\w\.\d+\b")  # of an array: hammer.2

Stopwatch = Callable[[str], AbstractContextManager[object]]


@dataclass(frozen=True, eq=False)
class Struck:
    """One simulation: the motion and what the march leaves it wrong by, None where nobody asked, the pressures, the
    levels by "ROOM.RECEIVER", the levels of every room that is to be rated {room: [receivers: {band: [dB]}]}, reasons
    to trust it less, and what striking bodies are heard themselves."""

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


def strike(
    studies: Mapping[str, Study],
    time: TimePlan,
    places: Places,
    basis: ModalBasis,
    vacuo: ModalBasis,
    stage: Stopwatch,
    transfers: RoomTransfers,
    estimated: bool = True,
) -> dict[str, Struck]:
    """Studies that differ in where a source strikes, simulated: impacts, their errors, rooms, levels, by drop.

    basis : damped, with the air that reacts on the structure; vacuo : without it. stage : measures a stage by its name.
    transfers : of rooms computed before. estimated : whether the error of each is, which takes a second simulation.

    Raises what the stages raise.

    Notes
    -----
    The pressures of all but the first drop are forgotten once their levels are known; what a room costs is paid once.
    """
    first = next(iter(studies.values()))
    needed = units_of(basis, scene(first, places, basis), clock_of(time))
    if not have(needed):  # others than the laws of its contacts told: fast modes take another march
        with stage("kernels"), compilation(needed) as running:
            running.wait()
    with stage("impact"):
        responses = {drop: _hit(study, time, places, basis) for drop, study in studies.items()}
    with stage("error estimate"):
        errors = {drop: error_of(response) if estimated else None for drop, response in responses.items()}
    with stage("room"):
        ends = {plan.name: plan.heard_to_hz(basis.complete_below_hz) for plan in first.rooms}
        rooms = _rooms(first, places, responses, ends, transfers)
    struck = {}
    for drop, study in studies.items():
        with stage("levels"):
            whole = {name: by_drop.pop(drop) for name, by_drop in rooms.items()}
            own = {name: ended(one, ends[name]) for name, one in whole.items()}
            heard = levels_by_receiver(own, whole)
            bands = {
                plan.name: reduced(
                    study,
                    band_levels(
                        study,
                        method,
                        whole[plan.name],
                        ends[plan.name],
                        [heard[f"{plan.name}.{one.name}"] for one in plan.receivers],
                    ),
                )
                for plan in study.rooms
                if (method := method_for(plan, study)) is not None
            }
            bodies = sound_of_bodies(study, places, responses[drop], own, whole)
        findings = (
            *findings_of(study, responses[drop], errors[drop], vacuo, own, heard),
            *room_findings(own_findings(study, places, responses[drop], bodies)),
        )
        kept = own if drop == next(iter(studies)) else {}
        struck[drop] = Struck(responses[drop], errors[drop], kept, heard, bands, findings, bodies)
    return struck


def _hit(study: Study, time: TimePlan, places: Places, basis: ModalBasis) -> Response:
    return simulate(basis, scene(study, places, basis), clock_of(time))


def clock_of(time: TimePlan) -> Clock:
    """Window, sampling and quiet time of an impact."""
    return Clock(time.duration, time.sampling, time.quiet)


def findings_of(
    study: Study,
    response: Response,
    errors: ErrorEstimate | None,
    vacuo: ModalBasis,
    rooms: Mapping[str, RoomResponse],
    heard: Mapping[str, Levels],
) -> tuple[Finding, ...]:
    """What is to be known of an impact and of what is heard of it. vacuo : without air that reacts on the modes."""
    told: list[tuple[str, Advice | Finding]] = [
        (name, advice) for name, one in rooms.items() for advice in one.findings
    ]
    told += [(name, advice) for name, levels in heard.items() for advice in levels.findings]
    told += [(name, room_silent()) for name, one in rooms.items() if not one.p.any()]
    found = (
        *sampled_findings(study, response),
        *impact_findings(vacuo, response),
        *source_findings(study, response),
        *walking_findings(study, vacuo),
        *(() if errors is None else unresolved_findings(errors, study.accuracy.within if study.accuracy else None)),
        *room_findings(told),
    )
    return tuple(one for one in found if blows_of(study) != "tapping" or one.code not in STEADY)


def told_once(told: Mapping[str, Sequence[Finding]]) -> list[Finding]:
    """Findings of all drops {place: ...}: of those with one code the ones of the first drop that has it, and of others
    what is severe where the first is not; each with its place where there are several.

    >>> told = {"p.1": [Finding("a", "one")], "p.2": [Finding("a", "two"), Finding("b", "three")]}
    >>> [found.message for found in told_once(told)]
    ['one (blows at p.1)', 'three (blows at p.2)']
    """
    found: list[Finding] = []
    known: dict[str, bool] = {}  # code: whether it was severe
    for place, findings in told.items():
        findings = members_once(findings)
        new = [one for one in findings if one.code not in known or (one.severe and not known[one.code])]
        known |= {one.code: one.severe or known.get(one.code, False) for one in new}
        after = f" (blows at {place})" if len(told) > 1 else ""
        found += [replace(one, message=one.message + after) for one in new]
    return found


def members_once(findings: Sequence[Finding]) -> list[Finding]:
    """Findings that say the same of every member of an array, but for its number and numbers, told of the first.

    >>> told = [Finding("a", f"hammer.{i} lasts {3 + i} ms") for i in (1, 2, 3)]
    >>> [found.message for found in members_once(told)]
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
    """What is heard in every room, by drop; ends : up to which frequency of each is of interest [Hz]."""
    rooms = {}
    for plan in study.rooms:
        if not plan.receivers and (plan.coupling == "two-way" or plan.room.open_air is not None):
            continue
        moving = surface_velocities(list(responses.values()), placed_room(plan, places.surfaces))
        pressures = transfers.heard(moving, plan.room, plan.receivers, ends[plan.name])
        rooms[plan.name] = dict(zip(responses, pressures, strict=True))
    return rooms
