"""What a study says before it has a structure: its contacts, its axis, and what rests on what under gravity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from femstruct.conventions import GRAVITY
from femstruct.errors import InputError
from femstruct.study.acting import PlacedBody, PlannedContact, PlannedLink
from femstruct.study.asked import Spot
from femstruct.study.study import Study


def planned_contacts(study: Study) -> tuple[PlannedContact, ...]:
    """Named contacts of a study, and those its bodies bring along, named "BODY on TARGET"."""
    own = tuple(
        PlannedContact(f"{body.name} on {body.target}", (body.name, body.target), body.law)
        for body in study.bodies
        if body.law is not None
    )
    return (*study.contacts, *own)


def axis_of(study: Study) -> Literal["x", "z"]:
    """The axis all bodies of a study move along: x where they are placed before and after, z above and below.

    Without bodies it is the axis of what the study starts or pushes, z where that is both; where nothing is, of what
    frequency responses and vibrations drive.
    """
    if study.bodies:
        return "x" if any(body.side in ("before", "after") for body in study.bodies) else "z"
    pushed = pushed_along(study)
    if pushed:
        return "x" if pushed == {"x"} else "z"
    spots = [request.drive for request in study.frf]
    spots += [one.on for one in study.vibration if isinstance(one.on, Spot)]
    shaken = any(one.on == "x" for one in study.vibration)
    return "x" if shaken or any(spot.what == "x" for spot in spots) else "z"


def pushed_along(study: Study) -> set[str]:
    """Which of x and z a study starts or pushes its structure along. What starts as a whole along both, or has gravity,
    comes down on what it meets."""
    spots = [spot for spot, _ in study.initial.velocities]
    spots += [load.on for load in study.loads if isinstance(load.on, Spot)]
    found = {spot.what for spot in spots if spot.what in ("x", "z")}
    rigid = study.initial.rigid
    if rigid is not None and any(rigid.velocity):
        x, _, z = rigid.velocity
        falls = study.time is not None and study.time.gravity
        found |= {"x"} if x and not z and not falls else {"z"}
    return found | ({"z"} if study.walks else set[str]())


def refuse_mixed_axes(study: Study) -> None:
    """Raise InputError for bodies along two axes, or contacts and links whose axis nothing says."""
    along_x = [body.name for body in study.bodies if body.side in ("before", "after")]
    along_z = [body.name for body in study.bodies if body.side in ("above", "below")]
    if along_x and along_z:
        raise InputError(
            f"bodies.{along_z[0]}",
            got=f"above or below, while {along_x[0]} is before or after",
            expected="bodies that move along one axis",
        )
    joins = [f"contacts.{one.name}" for one in study.contacts] + [f"links.{one.name}" for one in study.links]
    if joins and not study.bodies and len(pushed_along(study)) > 1:
        raise InputError(
            joins[0],
            got="starts and loads along x and along z",
            expected="one of them: without bodies it is the axis of contacts and links",
            do="remove those along the other, or add a body: above or below for z, before or after for x",
        )


@dataclass(frozen=True)
class Rest:
    """Gravity on a body that links carry: its weight with all that lies on it [N], and how far it has sunk [m]."""

    body: str
    weight: float
    sag: float


def rest_states(study: Study) -> tuple[Rest, ...]:
    """Weights and static sags of the bodies that links carry; empty without gravity.

    Notes: the structure and the contacts under lying bodies are taken as rigid beside the links.
    """
    return _carried(study) if weighs(study) else ()


def weights_on(study: Study) -> dict[str, float]:
    """What bodies that hang on links or lie weigh at the points of the structure that hold them [N], with gravity in
    the study and without, as the structure's own weight; empty where they move along x."""
    if axis_of(study) != "z":
        return {}
    bodies, lying = {body.name for body in study.bodies}, lying_bodies(study)
    sags = {rest.body: rest.sag for rest in _carried(study)}
    found: dict[str, float] = {}
    for body in lying.values():
        if body.target not in (*bodies, "ground"):
            found[body.target] = found.get(body.target, 0.0) + mass_on(body, lying) * GRAVITY
    for link in _holding(study):
        for end, other in (link.between, link.between[::-1]):
            if end not in (*bodies, "ground") and other in sags:
                found[end] = found.get(end, 0.0) + link.stiffness * sags[other]
    return found


def _carried(study: Study) -> tuple[Rest, ...]:
    carried, lying = carried_bodies(study), lying_bodies(study)
    names = [body.name for body in study.bodies if body.name in carried]
    weight = np.array([mass_on(body, lying) for body in study.bodies if body.name in carried]) * GRAVITY
    stiffness = np.zeros((len(names), len(names)))
    for link in _holding(study):
        row = np.array([float(name == link.between[0]) - float(name == link.between[1]) for name in names])
        stiffness += link.stiffness * np.outer(row, row)
    sag = np.linalg.solve(stiffness, weight)
    return tuple(Rest(*rest) for rest in zip(names, weight.tolist(), sag.tolist(), strict=True))


def carried_bodies(study: Study) -> set[str]:
    """Bodies that springs connect, from the start and maybe through other bodies, to something that is held."""
    bodies, carried = {body.name for body in study.bodies}, set[str]()
    links = _holding(study)
    while True:
        firm = [end for link in links for end in link.between if end not in bodies or end in carried]
        more = {end for link in links if set(link.between) & set(firm) for end in link.between if end in bodies}
        if more <= carried:
            return carried
        carried |= more


def _holding(study: Study) -> list[PlannedLink]:
    """Links that can carry a weight at the start: not dashpots alone, nor springs that act later."""
    return [link for link in study.links if link.stiffness > 0.0 and link.release_at == 0.0]


def lying_bodies(study: Study) -> dict[str, PlacedBody]:
    """Bodies that lie still on the structure, the ground, a carried body or each other, their contact closed."""
    closed = [set(contact.between) for contact in planned_contacts(study) if contact.gap == 0.0]
    bodies, carried = {body.name for body in study.bodies}, carried_bodies(study)
    candidates = [
        body
        for body in study.bodies
        if body.side == "above"
        and not (body.dropped or body.speed or body.name in carried)
        and {body.name, body.target} in closed
    ]
    lying: dict[str, PlacedBody] = {}
    for _ in candidates:  # each round lays another layer
        lying |= {b.name: b for b in candidates if b.target not in bodies or b.target in carried or b.target in lying}
    return lying


def at_rest(study: Study) -> set[str]:
    """Bodies whose weight something holds."""
    return carried_bodies(study) | lying_bodies(study).keys()


def mass_on(body: PlacedBody, lying: Mapping[str, PlacedBody]) -> float:
    """Mass of a body and of all that lies on it [kg]."""
    return body.mass + sum(mass_on(other, lying) for other in lying.values() if other.target == body.name)


def weighs(study: Study) -> bool:
    """Whether gravity acts along the axis of the bodies."""
    return study.time is not None and study.time.gravity and axis_of(study) == "z"


def weight_of_bodies(study: Study) -> float:
    """Weight of the bodies that are at rest at first [N]: hung on links or lying, all of it ends on the ground."""
    carried, lying = carried_bodies(study), lying_bodies(study)
    return sum(body.mass for body in study.bodies if body.name in carried or body.name in lying) * GRAVITY


def refuse_restless(study: Study) -> None:
    """Raise InputError when gravity acts on a body that neither rests nor falls."""
    if not weighs(study):
        return
    resting = at_rest(study)
    for body in study.bodies:
        if body.name not in resting and not body.dropped and body.speed == 0.0:
            under = next((one for one in study.bodies if one.name == body.target and one.name not in resting), None)
            closed = any(
                one.gap == 0.0 and {*one.between} == {body.name, body.target} for one in planned_contacts(study)
            )
            if under is not None and closed:
                raise InputError(
                    f"bodies.{body.name}",
                    got=f"a body at rest on '{under.name}', which falls at first",
                    expected="one that falls with it, or lies on something at rest",
                    do=f"give it the drop_height or speed of '{under.name}', or let that one lie: remove its drop",
                )
            raise InputError(
                f"bodies.{body.name}",
                got="a body without a spring or a closed contact that carries it",
                expected="a state of rest under gravity",
                do="give it a link or a contact without a gap, drop it (drop_height or speed), or write gravity: false",
            )
