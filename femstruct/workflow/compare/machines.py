"""What a press engineer must see first, one row a case: ground force, travels, sags, rest, dampers, energy, growth.

It is made for studies with blows, and of those that record the force on the ground.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import nan

import numpy as np

from femstruct.files.tables.study_tables import growth
from femstruct.impact.closer import closer
from femstruct.impact.result.response import EnergyBalance, Response
from femstruct.study.machine import Companion, EnergyShare, GroundForce, Machine, Rest
from femstruct.study.result import CaseResult
from femstruct.study.study import Study
from femstruct.workflow.check.weight import block_modes
from femstruct.workflow.compare.verdicts import settling
from femstruct.workflow.stages.modal_bases import Solved
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.recorded.channels import histories, motion_of, weight_on_ground
from femstruct.workflow.stages.rest import planned_contacts, weighs
from femstruct.workflow.stages.staging import ordered

GROUND_FORCE = "ground force"


def about_a_machine(study: Study) -> bool:
    """Whether a study is about a machine: something strikes again and again, or the force on the ground is recorded."""
    recorded = any(str(record) == GROUND_FORCE for record in study.records)
    return recorded or any(body.blows is not None for body in study.bodies)


def machines(baseline: str, cases: Mapping[str, CaseResult], solved: Mapping[str, Solved]) -> dict[str, Machine]:
    """A row for every case that was simulated; none at all unless one of them is about a machine."""
    if not any(about_a_machine(case.case.study) for case in cases.values()):
        return {}
    told = cases[baseline].channels.get(GROUND_FORCE)
    reference = told.whole if told is not None and cases[baseline].response is not None else None
    return {
        name: _machine(case, case.response, solved[name], None if name == baseline else reference)
        for name, case in cases.items()
        if case.response is not None
    }


def _machine(case: CaseResult, response: Response, own: Solved, reference: float | None) -> Machine:
    study, model = case.case.study, own.model
    striking = strikers(study)
    waits = settling(response) if response.blows else ()
    afters = [after for after, _ in waits if after is not None]
    separation = response.ledger.at_separation
    pressed = GROUND_FORCE in case.channels and weighs(study)
    near = closer(response) if pressed or set(response.bodies) - striking else response
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


def strikers(study: Study) -> set[str]:
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

    apart : all contacts are without force. What a damped spring still holds then is lost, nothing takes it back.
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
