"""From a checked study file to a study."""

from __future__ import annotations

from typing import Literal

from acoustics.fields.shaped import ShapedRoom
from femstruct.impact.scene.bodies import HalfSine, Table
from femstruct.impact.scene.walking import Walk, design_harmonics
from femstruct.language.build_laws import ends_of, law_of, start_speed
from femstruct.language.build_rooms import room_of
from femstruct.language.extents import as_many
from femstruct.language.limits import limited_room
from femstruct.language.schema_study import SIDES, BodySpec, ContactSpec, LoadSpec, StudySpec
from femstruct.language.sources import UNCORRELATED
from femstruct.language.yaml.build import Builder
from femstruct.language.yaml.opening import beside
from femstruct.language.yaml.reader import Mistakes, Steps, Tree, dotted
from femstruct.language.yaml.tables import read_history
from femstruct.modal.damping import Damping
from femstruct.study.structures import StructureModel
from femstruct.study.study import (
    AccuracyRule,
    Extent,
    FrfRequest,
    InitialMotion,
    Limit,
    PeakRule,
    PlacedBody,
    PlannedContact,
    PlannedLink,
    PlannedLoad,
    PlannedWalk,
    Record,
    Repeat,
    RigidMotion,
    Spot,
    Study,
    TimePlan,
)


def study_of(
    study: StudySpec,
    title: str,
    structure: StructureModel,
    damping: Damping,
    tree: Tree,
    mistakes: Mistakes,
    sources: dict[str, str],
    shaped: dict[str, ShapedRoom],
) -> Study | None:
    """The study of a checked study file on a structure; None with mistakes noted.

    sources : is given the texts of the files that the study file names, by their names. shaped : rooms from meshes
    that other cases have, by all that is said of them; is given this one's.
    """
    builder = Builder(tree, mistakes)
    bodies = builder.each("bodies", study.bodies, lambda n, s: _body(n, s, study, builder, sources))
    contacts = builder.each("contacts", study.contacts, lambda n, s: _contact(n, s, study, builder, sources))
    links = builder.each(
        "links",
        study.links,
        lambda n, s: PlannedLink(
            n, s.between, s.stiffness, s.damping.closing, s.damping.opening, s.release_at, s.preload
        ),
    )
    loads = builder.each("loads", study.loads, lambda n, s: _load(n, s, builder, sources))
    rooms = builder.each("rooms", study.rooms, lambda n, s: room_of(n, s, builder, sources, shaped))
    extent = Extent(study.modes.up_to, study.modes.count) if study.modes is not None else Extent()
    known = builder.make(("modes",), lambda: as_many(structure, extent))
    if mistakes.lines or known is None:
        return None
    frf = tuple(
        FrfRequest(name, spot_of(one.drive), spot_of(one.response), one.kind, one.band, one.step)
        for name, one in study.frf.items()
    )
    records = tuple(Record(target, what) for target, wanted in study.record.items() for what in wanted)  # type: ignore[arg-type]
    time, asked = study.time, study.accuracy
    return Study(
        title=title,
        structure=known,
        damping=damping,
        extent=extent,
        frf=frf,
        bodies=tuple(bodies.values()),
        contacts=tuple(contacts.values()),
        links=tuple(links.values()),
        loads=tuple(load for load in loads.values() if isinstance(load, PlannedLoad)),
        walks=tuple(load for load in loads.values() if isinstance(load, PlannedWalk)),
        initial=_initial(study),
        records=records,
        time=TimePlan(time.duration, time.sampling, time.gravity, study.quiet) if time is not None else None,
        peaks=PeakRule(study.peaks.first_impact, study.peaks.lowpass),
        rooms=tuple(rooms.values()),
        limits=tuple(Limit(name, one.value, limited_room(name)) for name, one in study.limits.items()),
        save_modal=study.save == "modal",
        accuracy=AccuracyRule(asked.within, asked.band, asked.up_to) if asked is not None else None,
    )


def spot_of(text: str) -> Spot:
    """An address such as ``O_s.z`` or ``ground.force``.

    >>> spot_of("rail.2.z")
    Spot(name='rail.2', what='z')
    """
    name, _, what = text.rpartition(".")
    return Spot(name, what)


def _body(name: str, spec: BodySpec, study: StudySpec, builder: Builder, sources: dict[str, str]) -> PlacedBody:
    side = next(side for side in SIDES if getattr(spec, side) is not None)
    named = any({name, spec.target} == set(contact.between) for contact in study.contacts.values())
    law = None
    if spec.contact is not None and not named:
        ends = ends_of(study, name, spec.target)
        law = law_of(spec.contact, ends, builder, ("bodies", name, "contact"), sources)
    dropped = spec.drop_height is not None
    blows = None
    if spec.blows is not None:
        alone = spec.blows.timing == UNCORRELATED
        blows = Repeat(spec.blows.count, spec.blows.every, spec.blows.first, alone)
    speed = start_speed(spec)
    radius, source = spec.radius, spec.source
    return PlacedBody(name, spec.mass, side, spec.target, speed, dropped, law, blows, source, radius)  # type: ignore[arg-type]


def _contact(
    name: str, spec: ContactSpec, study: StudySpec, builder: Builder, sources: dict[str, str]
) -> PlannedContact | None:
    ends = ends_of(study, *spec.between)
    law = law_of(spec.law, ends, builder, ("contacts", name, "law"), sources)
    if law is None:
        return None
    if spec.preload:
        law.indentation(spec.preload)  # a table may end below it
    return PlannedContact(name, spec.between, law, spec.gap, spec.preload)


def _load(name: str, spec: LoadSpec, builder: Builder, sources: dict[str, str]) -> PlannedLoad | PlannedWalk | None:
    history: HalfSine | Table | None
    repeat = Repeat(spec.count or 1, spec.every or 0.0, spec.first)
    if spec.walking is not None:
        one = spec.walking
        harmonics = tuple(one.harmonics) if one.harmonics is not None else design_harmonics(one.pace)
        return PlannedWalk(name, spec.along or (), Walk(one.mass, one.pace, one.steps, harmonics), repeat)
    if spec.half_sine is not None:
        history = HalfSine(spec.half_sine.amplitude.value, spec.half_sine.frequency)
    else:
        steps: Steps = ("loads", name, "file")
        path = builder.make(steps, lambda: beside(builder.tree.file, spec.file or ""))
        if path is None:
            return None
        what = "pressure" if spec.on is not None else "force"
        at = builder.tree.position(steps)
        history = read_history(path, what, at, dotted(steps), builder.mistakes, sources)
        if history is None:
            return None
    if spec.at is not None:
        return PlannedLoad(name, spot_of(spec.at), "point", history, repeat)
    kind: Literal["body", "surface"] = "body" if spec.body is not None else "surface"
    return PlannedLoad(name, spec.body or spec.on or "", kind, history, repeat)


def _initial(study: StudySpec) -> InitialMotion:
    spec = study.initial
    velocities = tuple((spot_of(address), one.value) for address, one in (spec.velocity or {}).items())
    rigid = RigidMotion(spec.rigid.about, spec.rigid.velocity, spec.rigid.spin) if spec.rigid is not None else None
    return InitialMotion(velocities, rigid)
