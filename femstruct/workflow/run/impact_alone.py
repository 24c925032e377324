"""What the history of an impact tells: recorded channels, the energy by modes, cycles; and a case of nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from acoustics.room_response import RoomResponse
from femstruct.errors import Finding
from femstruct.findings.catalogue import ranked
from femstruct.impact.result.fatigue import Fatigue
from femstruct.impact.result.response import Response
from femstruct.impact.result.shares import ModeEnergies, mode_energies
from femstruct.impact.scene.bodies import Scene
from femstruct.impact.simulate import simulate
from femstruct.modal.basis import ModalBasis
from femstruct.study.recorded import Channel
from femstruct.study.result import CaseResult
from femstruct.study.study import Case, Study
from femstruct.workflow.judgement.coarse_sampling import missed_peaks, missed_pulses
from femstruct.workflow.judgement.forces_beyond import force_findings, forces_beside, marked, other_pushes, with_less
from femstruct.workflow.judgement.impact_findings import aliased_findings, shares_beyond
from femstruct.workflow.run.struck import clock_of, findings_of
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.recorded.channels import motion_rows, record, refuse_absent_forces
from femstruct.workflow.stages.recorded.evaluated import evaluated
from femstruct.workflow.stages.recorded.peaks import (
    cut_off_findings,
    damage_findings,
    fatigue_findings,
    fatigues,
    peak_findings,
)
from femstruct.workflow.stages.recorded.stresses import stress_findings


@dataclass(frozen=True, eq=False)
class History:
    """What the history of one impact tells, and what is to be known of it."""

    channels: Mapping[str, Channel]
    shares: ModeEnergies
    fatigue: Mapping[str, Fatigue]
    evaluations: Mapping[str, Mapping[str, Any]]
    findings: tuple[Finding, ...]


def of_history(
    study: Study, places: Places, basis: ModalBasis, response: Response, rooms: Mapping[str, RoomResponse]
) -> History:
    """All that a study asks of the history of an impact, and of the pressures in its rooms.

    Raises InputError when a record names something that has no such quantity.
    """
    channels, shares = record(study, places, response, rooms), shares_beyond(basis, response)
    beyond = forces_beside(study, response, shares)
    rows = motion_rows(study, places, basis).items()
    accelerations = {name: row for name, (what, row) in rows if what == "acceleration"}
    evaluations, of_evaluations = evaluated(
        study, places, response, channels, with_less(study, response, shares), other_pushes(beyond)
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
    return History(marked(channels, beyond), mode_energies(response), cycles, evaluations, found)


def impact_alone(case: Case, key: str, places: Places, basis: ModalBasis, scene: Scene) -> CaseResult:
    """A case of one impact: its history and what follows from that, without rooms, frequency responses and steady
    vibration, and without an estimate of the march's error.

    key : of the structure. basis : damped. scene : takes the place of the study's.

    Raises what simulating and recording raise.
    """
    study = replace(case.study, limits=tuple(limit for limit in case.study.limits if not limit.room))
    assert study.time is not None
    refuse_absent_forces(study, basis)
    response = simulate(basis, scene, clock_of(study.time))
    told = of_history(study, places, basis, response, {})
    findings = [*findings_of(study, response, None, basis, {}, {}), *told.findings, *damage_findings(told.fatigue)]
    return CaseResult(
        case=replace(case, study=study),
        basis_key=key,
        basis=basis,
        response=response,
        frf={},
        channels=told.channels,
        rooms={},
        levels={},
        findings=ranked(findings),
        accuracy=None,
        shares=told.shares,
        evaluations=told.evaluations,
        fatigue=told.fatigue,
    )
