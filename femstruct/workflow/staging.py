"""Names become probes: the scene of a study, once its structure has points to hit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from acoustics.errors import AcousticsError, Advice
from acoustics.levels.sound_levels import Levels, response_levels
from acoustics.open_air.sphere import TOUCHING, refuse_inside, sphere_pressures
from acoustics.room_response import RoomResponse
from femstruct.arrays import Floats
from femstruct.conventions import GRAVITY
from femstruct.errors import Finding, InputError, list_some
from femstruct.impact.response import Response
from femstruct.impact.scene import GROUND, Blows, Body, Contact, End, Link, Load, Scene
from femstruct.modal.basis import ModalBasis
from femstruct.model.probe import Probe
from femstruct.model.structure import Structure
from femstruct.parts.mass import Mass
from femstruct.sound.radiated_power import moved_advice, sphere_of
from femstruct.study.acting import InitialMotion, PlacedBody, PlannedContact, PlannedLink
from femstruct.study.asked import RoomPlan, Spot
from femstruct.study.placed_rooms import placed_room
from femstruct.study.results import OwnSound
from femstruct.study.structures import BeamModel, ModesModel, RodModel
from femstruct.study.study import Study
from femstruct.workflow.bases import (
    Places,
    axis_of,
    mass_on,
    other_excitations,
    planned_contacts,
    refuse_mixed_axes,
    refuse_unsupported,
    resting_bodies,
    supported_bodies,
    weighs,
)

LUMPED = 0.9  # of what moves with a point that is given a velocity: what must be a mass there
HORIZONTAL = np.cos(np.radians(45.0))


def build_scene(study: Study, places: Places, basis: ModalBasis | None = None) -> Scene:
    """Bodies, contacts, links and loads of a study between probes.

    Parameters
    ----------
    basis : ModalBasis | None
        For start velocities of the structure, and to see that what is hit can move.

    Raises
    ------
    InputError
        When a place is missing or ambiguous, when it cannot be told which end of a contact is above, or when gravity
        leaves a body without a state of rest.

    Notes
    -----
    Bodies above and below move along z, bodies before and after along x, where gravity does not act. The end that is
    higher (further along x) is the upper one; a body is just above or below what it was placed on.
    """
    stage = _Stage(study, places)
    refuse_mixed_axes(study)
    contacts = tuple(stage.contact(contact) for contact in planned_contacts(study))
    links = tuple(stage.link(link) for link in study.links)
    refuse_unsupported(study)
    resting = supported_bodies(study)
    bodies = tuple(_body(body, body.name not in resting) for body in study.bodies)
    if basis is not None:
        _refuse_immovable(basis, contacts, links, stage.axis)
    if basis is not None:
        for spot, _ in study.initial.velocities:
            _refuse_massless(spot, study, places, basis)
    velocity = _modal_velocity(study.initial, places, basis) if basis is not None else None
    gravity = GRAVITY if weighs(study) else 0.0
    return Scene(bodies, contacts, links, stage.loads(), velocity, gravity, stage.blows())


def ordered(study: Study, places: Places, planned: PlannedContact) -> tuple[str, str]:
    """Names of the upper and the lower end of a contact."""
    return _Stage(study, places).names(planned.between, f"contacts.{planned.name}")


def force_probes(study: Study, places: Places) -> dict[str, Probe]:
    """All places where forces act on the structure, by address: each gets residual vectors in the basis.

    The air of a two-way room is one of them.
    """
    stage = _Stage(study, places)
    pairs = [contact.between for contact in planned_contacts(study)] + [link.between for link in study.links]
    ends = {end for pair in pairs for end in pair}
    probes = {
        f"{end}.{stage.axis}": stage.end(end, "contacts")
        for end in sorted(ends)
        if end != "ground" and end not in stage.bodies
    }
    found = {address: probe for address, probe in probes.items() if isinstance(probe, Probe)}
    for load in stage.loads():
        if isinstance(load.on, Probe):
            found[f"load {load.name}"] = load.on
    return found | other_excitations(study, places)


@dataclass(frozen=True)
class _Stage:
    study: Study
    places: Places

    @property
    def bodies(self) -> dict[str, PlacedBody]:
        return {body.name: body for body in self.study.bodies}

    @property
    def axis(self) -> str:
        return axis_of(self.study)

    def end(self, name: str, asked_by: str) -> End:
        if name == "ground":
            return GROUND
        if name in self.bodies:
            return name
        point = self.places.point(name, asked_by)
        if self.axis == "z" and abs(point.normal[2]) < HORIZONTAL:
            raise InputError(
                asked_by,
                got=f"{name} on a part inclined by {np.degrees(np.arccos(abs(point.normal[2]))):.0f} deg",
                expected="a part within 45 deg of horizontal, where above and below are defined",
            )
        return point.probe(self.axis)

    def height(self, name: str, asked_by: str, depth: int = 0) -> tuple[float, int]:
        """Position along the axis and, at one place, the order of what lies on it: greater is above."""
        if name == "ground":
            return (-np.inf, 0)
        if name not in self.bodies:
            return (float(self.places.point(name, asked_by).position["xyz".index(self.axis)]), 0)
        body = self.bodies[name]
        if depth > len(self.bodies):
            raise InputError(
                f"bodies.{name}",
                got="bodies placed on each other in a circle",
                expected="one of them on the structure or the ground",
            )
        at, rank = self.height(body.target, f"bodies.{name}", depth + 1)
        return (at, rank + (1 if body.side in ("above", "after") else -1))

    def names(self, between: tuple[str, str], asked_by: str) -> tuple[str, str]:
        """The two ends, the upper one first."""
        self._refuse_unknown_heights(between, asked_by)
        heights = [self.height(name, asked_by) for name in between]
        if heights[0] == heights[1]:
            raise InputError(
                f"{asked_by}.between",
                got=f"{between[0]} and {between[1]} at one height",
                expected="one end above the other",
                do=f"move one of them along {self.axis}, or put a body between",
            )
        return between if heights[0] > heights[1] else (between[1], between[0])

    def _refuse_unknown_heights(self, between: tuple[str, str], asked_by: str) -> None:
        """Points of given modes are nowhere unless they say: what stands at one is neither above nor below another."""
        structure = self.study.structure
        if not isinstance(structure, ModesModel) or "ground" in between:
            return
        at = {name for name in map(self._stands_at, between) if name in structure.points}
        if len(at) == 2 and not at <= structure.at.keys():
            raise InputError(
                f"{asked_by}.between",
                got=f"{between[0]} and {between[1]}, at points of given modes without positions",
                expected="positions that tell which end is above the other",
                do=f"write structure.points.{min(at - structure.at.keys())} as {{shape: [..], at: 0.2 m}}",
            )

    def _stands_at(self, name: str) -> str:
        """The point at which a body stands, maybe on other bodies; a point itself."""
        seen: set[str] = set()
        while name in self.bodies and name not in seen:
            seen.add(name)
            name = self.bodies[name].target
        return name

    def ordered(self, between: tuple[str, str], asked_by: str) -> tuple[End, End]:
        upper, lower = self.names(between, asked_by)
        return self.end(upper, asked_by), self.end(lower, asked_by)

    def contact(self, planned: PlannedContact) -> Contact:
        where = f"contacts.{planned.name}"
        upper, lower = self.ordered(planned.between, where)
        preload = planned.preload + self.resting_weight(planned)
        return Contact(planned.name, upper, lower, planned.law, planned.gap, preload)

    def resting_weight(self, planned: PlannedContact) -> float:
        """Weight of a body that lies still on the contact when gravity starts [N]."""
        if not weighs(self.study):
            return 0.0
        lying = resting_bodies(self.study)
        here = [body for body in lying.values() if {body.name, body.target} == set(planned.between)]
        return sum(mass_on(body, lying) for body in here) * GRAVITY

    def link(self, planned: PlannedLink) -> Link:
        upper, lower = self.ordered(planned.between, f"links.{planned.name}")
        return Link(
            planned.name,
            upper,
            lower=lower,
            stiffness=planned.stiffness,
            closing=planned.closing,
            opening=planned.opening,
            release_at=planned.release_at,
            preload=planned.preload,
        )

    def loads(self) -> tuple[Load, ...]:
        loads = []
        for load in self.study.loads:
            where = f"loads.{load.name}"
            if load.kind == "point" and not isinstance(load.on, str):
                on: Probe | str = self.places.point(load.on.name, where).probe(load.on.what)
            elif load.kind == "surface":
                if load.on not in self.places.surfaces:
                    expected = f"a surface: {list_some(self.places.surfaces)}"
                    raise InputError(f"{where}.on", got=f"'{load.on}'", expected=expected)
                on = self.places.surfaces[str(load.on)].pressure()
            else:
                on = str(load.on)
            again = load.repeat
            loads.append(Load(load.name, on, load.history, again.first, again.every, again.count))
        for walker in self.study.walks:
            where, again = f"loads.{walker.name}", walker.repeat
            path = [place for name in walker.along for place in self.places.of(name, where)]
            for place, history in zip(path, walker.walk.tables(len(path)), strict=True):
                name = f"{walker.name} at {place}"
                probe = self.places.point(place, where).probe("z")
                loads.append(Load(name, probe, history, again.first, again.every, again.count))
        return tuple(loads)

    def blows(self) -> tuple[Blows, ...]:
        """Bodies that strike several times; what lies below another body is placed before it."""
        planned = [(body, body.blows) for body in self.study.bodies if body.blows is not None]
        planned.sort(key=lambda pair: abs(self.height(pair[0].name, f"bodies.{pair[0].name}")[1]))
        return tuple(
            Blows(
                body.name,
                self.end(body.target, f"bodies.{body.name}"),
                again.every,
                again.count,
                again.first,
                again.late,
            )
            for body, again in planned
        )


def _refuse_immovable(basis: ModalBasis, contacts: Sequence[Contact], links: Sequence[Link], axis: str) -> None:
    """A place that no mode moves is held, or moves along another axis than its bodies: hitting it is a mistake."""
    pairs = [(f"contacts.{contact.name}", contact.upper, contact.lower) for contact in contacts]
    pairs += [(f"links.{link.name}", link.upper, link.lower) for link in links]
    for where, *ends in pairs:
        for end in ends:
            if isinstance(end, Probe) and not end.of(basis.shapes).any():
                raise InputError(
                    where,
                    got=f"an end that no mode moves along {axis}",
                    expected="a place that can move along the axis of the bodies",
                    do="connect it to `ground` if it is fixed",
                )


def _refuse_massless(spot: Spot, study: Study, places: Places, basis: ModalBasis) -> None:
    """A start velocity of a point of something that is elastic all around moves the less of it the more modes there
    are, down to nothing: it needs a rigid part, or a mass that is most of what moves."""
    where, structure = f"initial.velocity.{spot}", study.structure
    point = places.point(spot.name, where)
    if isinstance(structure, Structure):
        here = [name for name, part in places.parts.items() if np.isin(part.nodes, point.nodes).any()]
        if not here or any(places.parts[name].rigid for name in here):
            return
        names = {spot.name, spot.name.rpartition(".")[0]}
        lumps = [part.mass for part in structure.parts if isinstance(part, Mass) and part.at in names]
        mass = 0.0 if spot.what.startswith("r") else sum(lumps)
    elif isinstance(structure, RodModel | BeamModel):
        mass = 0.0
    else:
        return
    row = point.probe(spot.what).of(basis.shapes)
    moving = 1.0 / float(row @ row) if row.any() else np.inf
    if mass < LUMPED * moving < np.inf:
        turns, has = spot.what.startswith("r"), f"has a mass of {mass:.3g} kg" if mass else "is elastic all around"
        reason = "" if turns else f": with these modes {moving:.3g} kg move with it, and fewer with more modes"
        raise InputError(
            where,
            got=f"a start velocity of a point that {has}{reason}",
            expected="a point of a rigid block, or a mass at the point that is most of what moves",
            do=f"add a part {{type: mass, mass: 2 kg, at: {spot.name}}}, let a body strike it, push it with 'loads', "
            "or start all of a free structure with 'initial: {rigid: ..}'",
        )


def _body(body: PlacedBody, falls: bool) -> Body:
    towards = 1.0 if body.side in ("below", "before") else -1.0
    return Body(body.name, body.mass, towards * body.speed, falls)


def _modal_velocity(initial: InitialMotion, places: Places, basis: ModalBasis) -> Floats | None:
    """Modal velocities with the given point velocities and the least kinetic energy, or of a rigid motion."""
    if initial.rigid is not None:
        about = places.point(initial.rigid.about, "initial.rigid.about")
        arm = basis.points - about.position
        velocities = np.concatenate(
            [
                np.asarray(initial.rigid.velocity) + np.cross(initial.rigid.spin, arm),
                np.tile(initial.rigid.spin, (len(arm), 1)),
            ],
            axis=1,
        )
        rigid = np.array([kind == "rigid" for kind in basis.kind])
        shapes = basis.shapes[:, :6, rigid].reshape(velocities.size, int(rigid.sum()))
        q, *_ = np.linalg.lstsq(shapes, velocities.ravel(), rcond=None)
        missed = np.abs(shapes @ q - velocities.ravel()).max() / np.abs(velocities).max() if velocities.any() else 0.0
        if missed > 1e-6:
            raise InputError(
                "initial.rigid",
                got=f"a motion that its {int(rigid.sum())} rigid-body modes do not contain ({100 * missed:.3g} %)",
                expected="a structure that is free to move like this",
                do="remove the supports and springs that prevent it",
            )
        moving = np.zeros(len(basis.omega))
        moving[rigid] = q
        return moving
    if not initial.velocities:
        return None
    rows = np.array(
        [
            places.point(spot.name, f"initial.velocity.{spot}").probe(spot.what).of(basis.shapes)
            for spot, _ in initial.velocities
        ]
    )
    values = np.array([value for _, value in initial.velocities])
    velocity: Floats = np.linalg.lstsq(rows, values, rcond=None)[0]
    if not np.allclose(rows @ velocity, values, rtol=1e-9, atol=1e-12):
        raise InputError(
            "initial.velocity",
            got="start velocities that the modes cannot combine",
            expected="velocities of independent directions that move in some mode",
        )
    return velocity


# ----------------------------------------------------------------------------------------------------------------------
# The own sound of striking bodies in open air: which of them, where they are, and what is left out.
# ----------------------------------------------------------------------------------------------------------------------


def spheres_before(plan: RoomPlan, study: Study, places: Places) -> dict[str, tuple[float, Floats]]:
    """Radius [m] and centre [3] [m] of all bodies with a radius that are in the air of a half space, by name.

    Centres are in the coordinates of the half space, from its surface's centre. Empty for a room.

    Raises InputError for a receiver inside a sphere.

    Notes
    -----
    A body is its radius above (below) what it is placed on, where it is pushed; what gap there is at the start is then
    closed. A body that is placed on another one is above the top of its sphere.
    """
    space = plan.room.open_air
    if space is None or not plan.receivers:
        return {}
    found = {}
    for body in study.bodies:
        centre = _from_surface(body, plan, study, places)
        height = None if centre is None else float(centre @ space.normal)
        if body.radius is None or centre is None or height is None or height < body.radius * (1 - TOUCHING):
            continue
        if _upward(body) * space.normal[2] < 0:  # placed below what is above the surface
            continue
        try:
            refuse_inside(body.radius, centre, plan.receivers)
        except AcousticsError as error:
            raise InputError(f"rooms.{plan.name}.receivers", got=error.got, expected=error.expected) from error
        found[body.name] = (body.radius, centre)
    return found


def sound_of_bodies(
    study: Study,
    places: Places,
    response: Response,
    rooms: Mapping[str, RoomResponse],
    whole: Mapping[str, RoomResponse],
) -> OwnSound:
    """The own sound of striking bodies in open air, and the total with that of the structure, by room.

    Parameters
    ----------
    rooms : Mapping[str, RoomResponse]
        Of the structure, which end where its modes do.
    whole : Mapping[str, RoomResponse]
        The same before.

    Raises
    ------
    InputError
        As `spheres_before` does.
    """
    sounds = {plan.name: _own_sound(plan, study, places, response) for plan in study.rooms if plan.name in rooms}
    own = {name: one for name, one in sounds.items() if one is not None}
    total = {name: replace(rooms[name], p=rooms[name].p + one.p, findings=()) for name, one in own.items()}
    both = {name: replace(total[name], p=whole[name].p + one.p) for name, one in own.items()}
    return OwnSound(own, total, levels_by_receiver(own, own), levels_by_receiver(total, both))


def levels_by_receiver(rooms: Mapping[str, RoomResponse], whole: Mapping[str, RoomResponse]) -> dict[str, Levels]:
    """Levels of the pressures in rooms, by "ROOM.RECEIVER"; their bands of the whole pressures, before they ended."""
    return {
        f"{room}.{receiver}": levels
        for room, response in rooms.items()
        for receiver, levels in response_levels(response, whole[room]).items()
    }


def _own_sound(plan: RoomPlan, study: Study, places: Places, response: Response) -> RoomResponse | None:
    """Pressures that the bodies in the air of a half space make themselves; None where there are none."""
    placed, space = spheres_before(plan, study, places), plan.room.open_air
    if not placed or space is None:
        return None
    spheres = [sphere_of(response, name, *sphere, space) for name, sphere in placed.items()]
    radiated = sphere_pressures(spheres, space, plan.receivers)
    moved = [advice for name, (radius, _) in placed.items() for advice in moved_advice(response, name, radius)]
    return replace(radiated, findings=(*radiated.findings, *moved))


def own_findings(
    study: Study, places: Places, response: Response, sound: OwnSound
) -> list[tuple[str, Advice | Finding]]:
    """How far to trust the sound of bodies, by room; bodies that strike on the side of receivers and are
    not heard; radii of no use."""
    findings: list[tuple[str, Advice | Finding]] = [
        (name, one) for name, own in sound.own.items() for one in own.findings
    ]
    sounding: set[str] = set()
    for plan in study.rooms:
        sounding |= spheres_before(plan, study, places).keys()
        silent = [body.name for body in study.bodies if _left_out(body, plan, study, places, response)]
        if silent:
            verb = "strike" if len(silent) > 1 else "strikes"
            findings.append(
                (
                    plan.name,
                    Finding(
                        "own-sound-left-out",
                        f"{list_some(silent)} {verb} on the side of the receivers: its direct sound is not computed, "
                        "which may "
                        "be louder than that of the surface at high frequencies. Give a 'radius' if the body is "
                        "roughly "
                        "spherical",
                        {"bodies": len(silent)},
                    ),
                )
            )
    listening = [plan for plan in study.rooms if plan.room.open_air is not None and plan.receivers]
    for body in study.bodies:
        if body.radius is not None and body.name not in sounding and listening:
            finding = Finding(
                "radius-unused",
                f"{body.name} is not in front of the surface of {list_some(plan.name for plan in listening)}: its "
                f"radius of {1e3 * body.radius:g} mm has no effect",
                {"radius_m": body.radius},
            )
            findings.append((body.name, finding))
    return findings


def _left_out(body: PlacedBody, plan: RoomPlan, study: Study, places: Places, response: Response) -> bool:
    """Whether a body without a radius strikes something in the air of a half space with receivers."""
    space = plan.room.open_air
    if body.radius is not None or space is None or not plan.receivers:
        return False
    centre = _from_surface(body, plan, study, places)
    strikes = any(
        response.contacts[contact.name].closings
        for contact in response.scene.contacts
        if body.name in (contact.upper, contact.lower)
    )
    on_side = _upward(body) * space.normal[2] > 0
    return strikes and on_side and centre is not None and float(centre @ space.normal) > -1e-9


def _from_surface(body: PlacedBody, plan: RoomPlan, study: Study, places: Places) -> Floats | None:
    """Centre of a body from that of a surface [3] [m]; None for one that moves along x, or over the ground."""
    if body.side not in ("above", "below"):
        return None
    found = _centre(body, {one.name: one for one in study.bodies}, places, ())
    if found is None:
        return None
    return np.asarray(found - placed_room(plan, places.surfaces).first.centre)


def _centre(body: PlacedBody, bodies: Mapping[str, PlacedBody], places: Places, seen: Sequence[str]) -> Floats | None:
    """Centre of a body when it touches what it is placed on, global axes [3] [m]."""
    if body.target == "ground" or body.name in seen:
        return None
    radii, carrier = body.radius or 0.0, bodies.get(body.target)
    if carrier is None:
        at = places.point(body.target, f"bodies.{body.name}").position
    else:
        found = _centre(carrier, bodies, places, (*seen, body.name))
        if found is None:
            return None
        at, radii = found, radii + (carrier.radius or 0.0)
    centre: Floats = at + np.array([0.0, 0.0, _upward(body) * radii])
    return centre


def _upward(body: PlacedBody) -> float:
    return 1.0 if body.side == "above" else -1.0
