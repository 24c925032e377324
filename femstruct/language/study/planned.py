"""A study file as a whole: what its nouns must be to each other, and the study that is made of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from acoustics.fields.shaped import ShapedRoom
from femstruct.language.model.model import ModelSpec
from femstruct.language.rooms.room import Asked
from femstruct.language.study.body import ends_of, law_of
from femstruct.language.study.body_arrays import array_sizes, bodies_of, drop_counts
from femstruct.language.study.contact import check_contacts
from femstruct.language.study.limit import check_limits, limited_room
from femstruct.language.study.record import check_records
from femstruct.language.study.spread import spread
from femstruct.language.study.study import StudySpec
from femstruct.language.yaml import Here, check_references, members
from femstruct.modal.damping import Damping
from femstruct.study.acting import PlannedLoad, PlannedWalk
from femstruct.study.asked import Extent, Limit, Record
from femstruct.study.extents import as_many
from femstruct.study.structures import StructureModel
from femstruct.study.study import Study


def check_study(study: StudySpec, here: Here, model: ModelSpec) -> None:
    """Every name it uses is there, of the right kind, and its keys agree with each other and with the model.

    here : the study file, with the names of the model.
    """
    structure = model.structure.type if model.structure is not None else None
    here.need(study.modes or structure, "no modes", "how many modes to use", "add 'modes: {up_to: 3 kHz}'")
    check_references(StudySpec, here)
    for name, request in study.frf.items():
        request.check_in(here.at("frf", name), study.rooms)
    for key, name, evaluation in study.evaluations():
        evaluation.check_in(here.at(key, name), study.record, study.time)
    random = [name for name, one in study.vibration.items() if one.psd is not None and one.duration is not None]
    for name, one in study.fatigue.items():
        one.check_in(here.at("fatigue", name), study.record, study.time, random)
    for name, excitation in study.vibration.items():
        excitation.check_in(here.at("vibration", name), study.record, study.rooms)
    for name, source in study.sources.items():
        source.check_in(here.at("sources", name))
    study.check_campaign(here)
    sizes = array_sizes(study.bodies, here.names)
    ends = [*study.bodies, *bodies_of(sizes), "ground"]
    struck = [name for name, body in study.bodies.items() if body.blows is not None]
    for name, body in study.bodies.items():
        own = [name, *members(name, sizes.get(name, 1))]
        laws = [one.law for one in study.contacts.values() if name in one.between]
        laws += [body.contact] if body.contact is not None else []
        body.check_in(
            here.at("bodies", name),
            sizes.get(name, 1),
            [end for end in ends if end not in own],
            laws,
            any(room.receivers and getattr(room, body.side, None) is not None for room in study.rooms.values()),
        )
        here.at("bodies", name, "covering").need(
            body.covering is None or any(room.standards for room in study.rooms.values()),
            "a covering, and no room whose levels are rated",
            "a room with 'levels'",
            "add 'levels: [ISO 16283-2, ISO 717-2]' to it",
        )
    for group in ("contacts", "links"):
        for name, one in getattr(study, group).items():
            one.check_ends(here.at(group, name), sizes, ends)
            one.check_in(here.at(group, name), struck)
    for name, link in study.links.items():
        link.check_tuned(here.at("links", name), study.bodies)
    check_contacts(here, study.contacts, study.bodies)
    _check_strikes(study, here, sizes, ends)
    counts = drop_counts(study.bodies, here.names)
    for name in list(counts)[1:]:
        here.at("bodies", name, "above").wrong(
            f"a second source of several places (the first is '{next(iter(counts))}')",
            "one",
            f"give '{name}' one place",
        )
    for name, load in study.loads.items():
        load.check_in(here.at("loads", name), [*study.bodies, *bodies_of(sizes)])
    study.initial.check(here.at("initial"))
    if _check_records(study, here, ends):  # limits are of what is recorded
        check_limits(here, study.limits, study.record, study.rooms, study.time is not None and study.time.gravity)
    powers = [one.response for one in study.frf.values() if one.kind == "power"]
    asked = Asked(study.time, [*study.bodies.values()], powers, study.rooms)
    for name, room in study.rooms.items():
        room.check_in(here.at("rooms", name), name, asked)
    if study.time is not None:
        study.time.check(here.at("time"))
        study.time.carries(here.at("peaks", "lowpass"), study.peaks.lowpass or 0.0)
    if study.accuracy is not None:
        first, there = study.modes.up_to if study.modes is not None else None, here.at("accuracy")
        study.accuracy.check_in(there, study.time, structure, first)
        there.need(
            study.record or study.contacts or any(body.contact is not None for body in study.bodies.values()),
            "no record and no contact",
            "something to compare",
            "add 'record: {POINT.z: acceleration}'",
        )
    start = study.initial.velocity or study.initial.rigid
    heard = study.sources or any(one.of_room for one in study.frf.values())
    recorded = study.record and not study.vibration
    moving = study.bodies or study.loads or start or recorded or study.limits or (study.rooms and not heard)
    do = "add 'time: {duration: 1 s, sampling: 48 kHz}'"
    here.need(study.time is not None or not moving, "no time", "how long to simulate", do)
    if study.compare is not None and study.cases:
        here.at("compare", "baseline").known(study.compare.baseline, "case", study.cases)


def _check_strikes(study: StudySpec, here: Here, sizes: Mapping[str, int], ends: Collection[str]) -> None:
    """Note bodies that would pass through what they move to; a misspelt end of a contact is one mistake, not two."""
    between = {end for one in (*study.contacts.values(), *study.links.values()) for end in one.between}
    if between <= {*here.names.points, *here.names.places, *ends}:
        for name, body in study.bodies.items():
            own = [name, *members(name, sizes.get(name, 1))]
            body.check_strikes(here.at("bodies", name), not between.isdisjoint(own))


def _check_records(study: StudySpec, here: Here, ends: Collection[str]) -> bool:
    """Whether all records are right; notes those that are not, but for contacts of bodies at an unknown place."""
    places = {*here.names.points, *here.names.places, *ends}
    unplaced = tuple(f"{name} on " for name, body in study.bodies.items() if body.target not in places)
    records = {target: what for target, what in study.record.items() if not target.startswith(unplaced)}
    parted = spread(study, here.names)
    forced = [*here.names.forces, *study.contacts, *parted.contacts, *study.links, *parted.links]
    for spec in (study, parted):
        forced += [f"{name} on {body.target}" for name, body in spec.bodies.items() if body.contact is not None]
    before = len(here.mistakes.lines)
    check_records(here, records, [*dict.fromkeys((*study.bodies, *parted.bodies))], [*dict.fromkeys(forced)])
    return len(here.mistakes.lines) == before and len(records) == len(study.record)


def study_of(
    study: StudySpec,
    title: str,
    structure: StructureModel,
    damping: Damping,
    here: Here,
    sources: dict[str, str],
    shaped: dict[str, ShapedRoom],
) -> Study | None:
    """The study of a checked study file on a structure; None with mistakes noted.

    sources : is given the texts of the files that the study file names, by their names. shaped : rooms from meshes
    that other cases have, by all that is said of them; is given this one's.
    """
    named = {frozenset(contact.between) for contact in study.contacts.values()}
    laws = {}
    for name, body in study.bodies.items():
        if body.contact is not None and frozenset((name, body.target)) not in named:
            ends, there = ends_of(study.bodies, name, body.target), here.at("bodies", name, "contact")
            laws[name] = law_of(body.contact, ends, there, sources)
    bodies = here.each("bodies", study.bodies, lambda _, name, one: one.build(name, laws.get(name)))
    contacts = here.each(
        "contacts", study.contacts, lambda there, name, one: one.build(there, name, study.bodies, sources)
    )
    links = here.each("links", study.links, lambda _, name, one: one.build(name, study.bodies))
    loads = here.each("loads", study.loads, lambda there, name, one: one.build(there, name, sources)).values()
    measured = here.each("sources", study.sources, lambda _, name, one: one.noun(name=name))
    rooms = here.each("rooms", study.rooms, lambda there, name, one: one.build(there, name, sources, shaped))
    extent = study.modes.noun() if study.modes is not None else Extent()
    known = here.at("modes").make(lambda: as_many(structure, extent))
    if here.mistakes.lines or known is None:
        return None
    return Study(
        title,
        known,
        damping,
        extent,
        tuple(one.noun(name=name) for name, one in study.frf.items()),
        tuple(bodies.values()),
        tuple(contacts.values()),
        tuple(links.values()),
        tuple(load for load in loads if isinstance(load, PlannedLoad)),
        tuple(load for load in loads if isinstance(load, PlannedWalk)),
        study.initial.noun(),
        tuple(Record(target, what) for target, wanted in study.record.items() for what in wanted),
        study.time.noun(quiet=study.quiet) if study.time is not None else None,
        study.peaks.noun(),
        tuple(rooms.values()),
        tuple(Limit(name, one.value, limited_room(name)) for name, one in study.limits.items()),
        save_modal=study.save == "modal",
        accuracy=study.accuracy.noun() if study.accuracy is not None else None,
        evaluations=tuple(one.noun(name=name) for _, name, one in study.evaluations()),
        vibration=tuple(one.noun(name=name) for name, one in study.vibration.items()),
        fatigue=tuple(one.noun(name=name) for name, one in study.fatigue.items()),
        sources=tuple(measured.values()),
    )
