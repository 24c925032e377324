"""A study file as a whole: what its nouns must be to each other, and the study that is made of them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from pydantic import Discriminator, Field, Tag, create_model

from acoustics.fields.shaped import ShapedRoom
from femstruct.declared import Refers
from femstruct.errors import quote_value
from femstruct.impact.scene import BETWEEN_BLOWS, DROPPED, HAMMERS, TAPPING_MACHINE
from femstruct.language import rooms
from femstruct.language.bodies import (
    UNCORRELATED,
    BlowsSpec,
    BodySpec,
    ContactSpec,
    LinkSpec,
    array_size_of,
    array_sizes,
    bodies_of,
    check_contacts,
    drop_counts,
    ends_of,
    first_blow_time,
    law_of,
)
from femstruct.language.evaluations import EVALUATION_KINDS, EvaluationSpec
from femstruct.language.limits import FatigueSpec, Limits, check_limits, limited_room
from femstruct.language.loads import LoadSpec, MeasuredSourceSpec, VibrationSpec
from femstruct.language.model_file import ModelSpec
from femstruct.language.not_computed import BASE_IN_TIME, instead_of
from femstruct.language.requests import FrfSpec, InitialSpec
from femstruct.language.rooms import BoxRoomSpec, RoomSpec, StudyRequests
from femstruct.language.varied import CampaignSpec
from femstruct.language.window import AccuracySpec, ModesSpec, PeaksSpec, Recorded, TimeSpec, check_records
from femstruct.modal.damping import Damping
from femstruct.quantities import Instant, Measured, refuse
from femstruct.study.acting import PlannedLoad, PlannedWalk
from femstruct.study.asked import Extent, Limit, Record
from femstruct.study.structures import StructureModel, with_mode_count
from femstruct.study.study import Study
from femstruct.yaml.reader import Here, Names, members
from femstruct.yaml.spec import Spec, Text, check_references, kinds_of, read_by, union_of

# ----------------------------------------------------------------------------------------------------------------------
# The kinds of rooms a study file can have: every module here that has a `RoomSpec` with `signs` is one, what other
# packages add as entry points of the group `femstruct.language.rooms`, and the box, which has no sign.
# ----------------------------------------------------------------------------------------------------------------------

ROOM_KINDS: tuple[type[RoomSpec], ...] = (*kinds_of(rooms, RoomSpec), BoxRoomSpec)


def _kind(value: Any) -> str:
    """The first kind that has a sign among the keys; else it is a box."""
    keys = value if isinstance(value, dict) else {}
    return next(
        (one.__name__ for one in ROOM_KINDS if any(sign in keys for sign in one.signs)), ROOM_KINDS[-1].__name__
    )


if TYPE_CHECKING:
    AnyRoom = RoomSpec
else:
    AnyRoom = Annotated[union_of(Annotated[one, Tag(one.__name__)] for one in ROOM_KINDS), Discriminator(_kind)]


# ----------------------------------------------------------------------------------------------------------------------
# The study file: what happens to the structure.
# ----------------------------------------------------------------------------------------------------------------------


def _changes(value: object) -> object:
    """A case is checked where it is applied; here only its form."""
    if not isinstance(value, dict | None):
        raise refuse(quote_value(value), "a mapping of paths to values", "write it like {bodies.damper.mass: 0.9 kg}")
    return value or {}


Changes = Annotated[dict[str, Any], read_by(_changes, dict[str, Any] | None)]


class CompareSpec(Spec):
    """Which case the others are compared with."""

    baseline: Annotated[Text, Refers()]


class StudyKeys(CampaignSpec):
    """The keys of a study file but those of the evaluations of recorded histories, a key each kind."""

    instead = instead_of(BASE_IN_TIME, "base", "base_motion", "ground", "ground_motion", "earthquake")

    title: Text | None = None
    model: Text = Field(description="the model file, beside this one")
    modes: ModesSpec | None = None
    accuracy: AccuracySpec | None = None
    frf: dict[str, FrfSpec] = Field(default_factory=dict)
    bodies: dict[str, BodySpec] = Field(default_factory=dict)
    contacts: dict[str, ContactSpec] = Field(default_factory=dict)
    links: dict[str, LinkSpec] = Field(default_factory=dict)
    loads: dict[str, LoadSpec] = Field(default_factory=dict)
    initial: InitialSpec = InitialSpec()
    record: dict[str, Recorded] = Field(
        default_factory=dict,
        description="What histories are of. A force of a spring, foundation, support, joint or the ground has, beside "
        "k u and c v, its share of the damping of the modes: of a ratio in proportion to the elastic force.",
    )
    time: TimeSpec | None = None
    peaks: PeaksSpec = PeaksSpec()
    limits: Limits = Field(
        default_factory=dict,
        description="Of a recorded channel, TARGET QUANTITY, of the time to rest, settled, of a rating, ROOM rating. "
        "'ground force' is what the motion adds, 'ground force with weight' has the weight of all that stands there.",
    )
    quiet: Instant = 0.0
    rooms: dict[str, AnyRoom] = Field(default_factory=dict)
    cases: dict[str, Changes] = Field(
        default_factory=dict,
        description="Variants of the study by name: paths of the study or its model with their values there, and "
        "'add: {PATH: ..}', 'remove: [PATH, ..]'. These alone are computed; the first is the baseline: begin with an "
        "empty one, 'as built: {}'.",
    )
    compare: CompareSpec | None = None
    save: Literal["modal"] | None = Field(default=None, description="modal: keep the motion of all modes, too")
    vibration: dict[str, VibrationSpec] = Field(default_factory=dict)
    fatigue: dict[str, FatigueSpec] = Field(default_factory=dict)
    sources: dict[str, MeasuredSourceSpec] = Field(default_factory=dict)

    def evaluations(self) -> Iterator[tuple[str, str, EvaluationSpec]]:
        """What is asked of recorded histories: the key of its kind, its name, and what the file says of it."""
        for key in EVALUATION_KINDS:
            yield from ((key, name, one) for name, one in getattr(self, key).items())


if TYPE_CHECKING:
    StudySpec = StudyKeys
else:
    StudySpec = create_model(
        "StudySpec",
        __base__=StudyKeys,
        __doc__="A study file.",
        **{key: (dict[str, kind], Field(default_factory=dict)) for key, kind in EVALUATION_KINDS.items()},
    )


# ----------------------------------------------------------------------------------------------------------------------
# A study with one body for every member of its arrays, and one study for every place that a source strikes.
# ----------------------------------------------------------------------------------------------------------------------

Joining = TypeVar("Joining", ContactSpec, LinkSpec)


def drops(study: StudySpec, names: Names) -> dict[str, StudySpec]:
    """The studies of all places that a standard source is to strike, one each, by the place; {} for one place."""
    found: dict[str, StudySpec] = {}
    for name, count in drop_counts(study.bodies, names).items():
        body = study.bodies[name]
        for i in range(count):
            several = f"{i * HAMMERS + 1}-{(i + 1) * HAMMERS}"
            found[f"{body.target}.{i + 1 if body.source in DROPPED else several}"] = expand_arrays(study, names, i)
    return found


def _apart(study: StudySpec, blows: BlowsSpec) -> float:
    """Time between the blows of two hammers [s]; of uncorrelated ones each has its share of the record."""
    alone = blows.timing == UNCORRELATED and study.time is not None
    return study.time.duration / HAMMERS if alone and study.time is not None else BETWEEN_BLOWS


@dataclass(frozen=True)
class _Arrays:
    """Arrays of bodies, each of which stands for NAME.1, NAME.2, ...

    bodies : all of the study. sizes : how many bodies each array stands for. several : the same, and points of several
    places. skipped : places of the target of a source that it struck in earlier drops.
    """

    bodies: Mapping[str, BodySpec]
    sizes: Mapping[str, int]
    several: Collection[str]
    skipped: Mapping[str, int]

    def member(self, end: str, i: int) -> str:
        """The i-th of what an end of a contact stands for, from 1: itself where it is single."""
        return f"{end}.{i}" if end in self.several else end

    def target(self, name: str, i: int) -> str:
        """What the i-th body of an array moves to."""
        return self.member(self.bodies[name].target, i + self.skipped.get(name, 0))

    def apart(self, specs: Mapping[str, Joining], names: Names) -> dict[str, Joining]:
        """Contacts or links with one for each body of an array between whose ends they are, by NAME.1, NAME.2, ..."""
        found: dict[str, Joining] = {}
        for name, spec in specs.items():
            (first, second), counts = spec.between, array_size_of(spec.between, self.sizes, names)
            for i in range(1, max(counts) + 1) if counts else ():
                between = self.member(first, i), self.member(second, i)
                found[f"{name}.{i}"] = spec.model_copy(update={"between": between})
            if not counts:
                found[name] = spec
        return found

    def each(self, target: str, joining: Collection[str]) -> list[str]:
        """What a record of an array, of its contact or of one of the contacts and links (joining) of its bodies stands
        for: one of every body, else itself."""
        if target in self.sizes:
            return bodies_of({target: self.sizes[target]})
        for name, size in self.sizes.items():
            if target == f"{name} on {self.bodies[name].target}":
                return [f"{name}.{i} on {self.target(name, i)}" for i in range(1, size + 1)]
        return [name for name in joining if name.rpartition(".")[0] == target] or [target]


def expand_arrays(study: StudySpec, names: Names, drop: int = 0) -> StudySpec:
    """The study with NAME.1, NAME.2, ... in place of every array NAME: its bodies, what joins and pushes them, and
    what is recorded of them. Both ends of a contact or link go along in step; one that is single stays.

    Parameters
    ----------
    drop : int
        Which of the places of a standard source is struck, counted from 0.
    """
    study = _dropped(study, names, drop)
    sizes = array_sizes(study.bodies, names)
    if not sizes:
        return study
    several = {*(name for name, count in names.points.items() if count > 1), *sizes}
    skipped = dict.fromkeys(drop_counts(study.bodies, names), drop * HAMMERS)
    arrays = _Arrays(study.bodies, sizes, several, skipped)
    contacts, links = arrays.apart(study.contacts, names), arrays.apart(study.links, names)
    record: dict[str, tuple[str, ...]] = {}
    for target, quantities in study.record.items():
        for one in arrays.each(target, [*contacts, *links]):  # a member may be named beside its array
            record[one] = tuple(dict.fromkeys((*record.get(one, ()), *quantities)))
    limits: dict[str, Measured] = {}
    for name, limit in study.limits.items():
        target, space, what = name.rpartition(" ")
        for one in arrays.each(target, [*contacts, *links]) if target else [""]:
            limits.setdefault(f"{one}{space}{what}", limit)
    parted = {
        "bodies": _each_body(study, arrays),
        "contacts": contacts,
        "links": links,
        "loads": _on_each(study, sizes),
    }
    return study.model_copy(update={**parted, "record": record, "limits": limits})


def _each_body(study: StudySpec, arrays: _Arrays) -> dict[str, BodySpec]:
    """All bodies, those of an array one by one, each over its own place; hammers strike in turn."""
    found: dict[str, BodySpec] = {}
    for name, body in study.bodies.items():
        for i in range(1, arrays.sizes.get(name, 1) + 1):
            changes: dict[str, object] = {}
            if name in arrays.sizes:
                changes[body.side] = arrays.target(name, i)
            if body.source == TAPPING_MACHINE and body.blows is not None:
                changes["blows"] = body.blows.model_copy(
                    update={"first": first_blow_time(i, _apart(study, body.blows))}
                )
            found[arrays.member(name, i)] = body.model_copy(update=changes)
    return found


def _on_each(study: StudySpec, sizes: Mapping[str, int]) -> dict[str, LoadSpec]:
    """All loads, those on an array one for each of its bodies."""
    found: dict[str, LoadSpec] = {}
    for name, load in study.loads.items():
        of = sizes.get(load.body or "", 0)
        found |= {f"{name}.{i}": load.model_copy(update={"body": f"{load.body}.{i}"}) for i in range(1, of + 1)}
        if not of:
            found[name] = load
    return found


def _dropped(study: StudySpec, names: Names, drop: int) -> StudySpec:
    """The study with a source that is dropped at one of its places, and records and limits of its contact there."""
    bodies, record, limits = dict(study.bodies), dict(study.record), dict(study.limits)
    for name in drop_counts(study.bodies, names):
        body = study.bodies[name]
        if body.source not in DROPPED:
            continue
        place = f"{body.target}.{drop + 1}"
        bodies[name] = body.model_copy(update={"above": place})
        own, there = f"{name} on {body.target}", f"{name} on {place}"
        record = {there if target == own else target: what for target, what in record.items()}
        renamed = {limit: f"{there} {limit.rpartition(' ')[2]}" for limit in limits if limit.rpartition(" ")[0] == own}
        limits = {renamed.get(name, name): limit for name, limit in limits.items()}
    return study.model_copy(update={"bodies": bodies, "record": record, "limits": limits})


# ----------------------------------------------------------------------------------------------------------------------
# A study file as a whole.
# ----------------------------------------------------------------------------------------------------------------------


def check_study(study: StudySpec, here: Here, model: ModelSpec) -> None:
    """Every name it uses is there, of the right kind, and its keys agree with each other and with the model.

    Parameters
    ----------
    here : Here
        The study file, with the names of the model.
    """
    structure = model.structure.type if model.structure is not None else None
    here.need(study.modes or structure, "no modes", "how many modes to use", "add 'modes: {up_to: 3 kHz}'")
    check_references(StudySpec, here)
    _check_requests(study, here)
    study.check_campaign(here)
    sizes = array_sizes(study.bodies, here.names)
    ends = [*study.bodies, *bodies_of(sizes), "ground"]
    _check_bodies(study, here, sizes, ends)
    _check_contacts_and_links(study, here, sizes, ends)
    _check_one_source_moves(study, here)
    for name, load in study.loads.items():
        load.check_in(here.at("loads", name), [*study.bodies, *bodies_of(sizes)])
    study.initial.check(here.at("initial"))
    if _check_records(study, here, ends):  # limits are of what is recorded
        check_limits(here, study.limits, study.record, study.rooms, study.time is not None and study.time.gravity)
    powers = [one.response for one in study.frf.values() if one.kind == "power"]
    requests = StudyRequests(study.time, [*study.bodies.values()], powers, study.rooms)
    for name, room in study.rooms.items():
        room.check_in(here.at("rooms", name), name, requests)
    _check_time(study, here, structure)
    if study.compare is not None and study.cases:
        here.at("compare", "baseline").known(study.compare.baseline, "case", study.cases)


def _check_requests(study: StudySpec, here: Here) -> None:
    """Note what is wrong with what is asked of frequencies, recorded histories and measured sources."""
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


def _check_bodies(study: StudySpec, here: Here, sizes: Mapping[str, int], ends: Collection[str]) -> None:
    """Note what is wrong with bodies.

    Parameters
    ----------
    sizes : Mapping[str, int]
        Of arrays of them.
    ends : Collection[str]
        Names of bodies and of the ground.
    """
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


def _check_contacts_and_links(study: StudySpec, here: Here, sizes: Mapping[str, int], ends: Collection[str]) -> None:
    """Note contacts and links that join nothing or contradict each other, and bodies that need one and have none."""
    lifted = [name for name, body in study.bodies.items() if body.blows is not None]
    for group in ("contacts", "links"):
        for name, one in getattr(study, group).items():
            one.check_ends(here.at(group, name), sizes, ends)
            one.check_in(here.at(group, name), lifted)
    for name, link in study.links.items():
        link.check_tuned(here.at("links", name), study.bodies)
    check_contacts(here, study.contacts, study.bodies)
    _check_strikes(study, here, sizes, ends)


def _check_one_source_moves(study: StudySpec, here: Here) -> None:
    """Note a second source of several places: which of them are struck together would be open."""
    counts = drop_counts(study.bodies, here.names)
    for name in list(counts)[1:]:
        here.at("bodies", name, "above").wrong(
            f"a second source of several places (the first is '{next(iter(counts))}')",
            "one",
            f"give '{name}' one place",
        )


def _check_time(study: StudySpec, here: Here, structure: str | None) -> None:
    """Note a wrong or absent window, and an accuracy of nothing.

    Parameters
    ----------
    structure : str | None
        Its type, where it has no mesh.
    """
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
    do = "add 'time: {duration: 1 s, sampling: 48 kHz}'"
    here.need(study.time is not None or not _moves(study), "no time", "how long to simulate", do)


def _moves(study: StudySpec) -> bool:
    """Whether something of the study happens in time; rooms of sources, and records of vibration, do not."""
    start = study.initial.velocity or study.initial.rigid
    by_frequency = study.sources or any(one.of_room for one in study.frf.values())
    recorded = study.record and not study.vibration
    sounding = study.rooms and not by_frequency
    return any((study.bodies, study.loads, start, recorded, study.limits, sounding))


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
    parted = expand_arrays(study, here.names)
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

    Parameters
    ----------
    sources : dict[str, str]
        Is given the texts of the files that the study file names, by their names.
    shaped : dict[str, ShapedRoom]
        Rooms from meshes that other cases have, by all that is said of them; is given this one's.
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
    known = here.at("modes").make(lambda: with_mode_count(structure, extent))
    if here.mistakes.lines or known is None:
        return None
    return Study(
        title,
        known,
        damping=damping,
        extent=extent,
        frf=tuple(one.noun(name=name) for name, one in study.frf.items()),
        bodies=tuple(bodies.values()),
        contacts=tuple(contacts.values()),
        links=tuple(links.values()),
        loads=tuple(load for load in loads if isinstance(load, PlannedLoad)),
        walks=tuple(load for load in loads if isinstance(load, PlannedWalk)),
        initial=study.initial.noun(),
        records=tuple(Record(target, what) for target, quantities in study.record.items() for what in quantities),
        time=study.time.noun(quiet=study.quiet) if study.time is not None else None,
        peaks=study.peaks.noun(),
        rooms=tuple(rooms.values()),
        limits=tuple(Limit(name, one.value, limited_room(name)) for name, one in study.limits.items()),
        save_modal=study.save == "modal",
        accuracy=study.accuracy.noun() if study.accuracy is not None else None,
        evaluations=tuple(one.noun(name=name) for _, name, one in study.evaluations()),
        vibration=tuple(one.noun(name=name) for name, one in study.vibration.items()),
        fatigue=tuple(one.noun(name=name) for name, one in study.fatigue.items()),
        sources=tuple(measured.values()),
    )
