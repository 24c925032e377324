"""Arrays of bodies: a body at a point of several places is one body each, with its contacts and links.

A standard source is one body, whose places are struck one after the other: a simulation each.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from femstruct.impact.scene.impact_sources import BETWEEN_BLOWS, DROPPED, HAMMERS, TAPPING_MACHINE
from femstruct.language.schema_study import SIDES, BlowsSpec, BodySpec, ContactSpec, LinkSpec, LoadSpec, StudySpec
from femstruct.language.sources import UNCORRELATED, turn
from femstruct.language.yaml.here import Names
from femstruct.language.yaml.spec import Measured

Ends = tuple[str, str]
Joining = TypeVar("Joining", ContactSpec, LinkSpec)


def array_sizes(study: StudySpec, names: Names) -> dict[str, int]:
    """How many each body of an array is: at a point of several places, or on another array; a tapping machine's
    hammers are five at whatever multiple of five places."""
    sizes: dict[str, int] = {}
    for _ in study.bodies:  # each round finds what lies on what the last one found
        for name, body in study.bodies.items():
            target = body.target
            count = sizes.get(target, names.points.get(target, 1))
            if body.source == TAPPING_MACHINE and not count % HAMMERS:
                count = HAMMERS
            if count > 1 and not (body.source in DROPPED and target in names.points):
                sizes[name] = count
    return sizes


def drop_counts(study: StudySpec, names: Names) -> dict[str, int]:
    """How many places each standard source of several is to strike: those of a point, five for a tapping machine."""
    found = {}
    for name, body in study.bodies.items():
        places = names.points.get(body.target, 1)
        count = places if body.source in DROPPED else places // HAMMERS if body.source == TAPPING_MACHINE else 1
        if count > 1:
            found[name] = count
    return found


def drops(study: StudySpec, names: Names) -> dict[str, StudySpec]:
    """The studies of all places that a standard source is to strike, one each, by the place; {} for one place."""
    found: dict[str, StudySpec] = {}
    for name, count in drop_counts(study, names).items():
        body = study.bodies[name]
        for i in range(count):
            start, end = i * HAMMERS + 1, (i + 1) * HAMMERS
            place = f"{body.target}.{i + 1}" if body.source in DROPPED else f"{body.target}.{start}-{end}"
            found[place] = spread(study, names, i)
    return found


def joined(ends: Ends, sizes: Mapping[str, int], names: Names) -> list[int]:
    """How many places each end stands for: [] unless an array of bodies is one of them."""
    if not any(end in sizes for end in ends):
        return []
    return [sizes.get(end, names.points.get(end, 1)) for end in ends]


def members(sizes: Mapping[str, int]) -> list[str]:
    """The names of all bodies of arrays.

    >>> members({"damper": 2})
    ['damper.1', 'damper.2']
    """
    return [f"{name}.{i}" for name, size in sizes.items() for i in range(1, size + 1)]


def _apart(study: StudySpec, blows: BlowsSpec) -> float:
    """Time between the blows of two hammers [s]; of uncorrelated ones each has its share of the record."""
    alone = blows.timing == UNCORRELATED and study.time is not None
    return study.time.duration / HAMMERS if alone and study.time is not None else BETWEEN_BLOWS


def spread(study: StudySpec, names: Names, drop: int = 0) -> StudySpec:
    """The study with NAME.1, NAME.2, ... in place of every array NAME: its bodies, what joins and pushes them, and what
    is recorded of them. Both ends of a contact or link go along in step; one that is single stays.

    drop : which of the places of a standard source is struck, counted from 0.
    """
    study = _dropped(study, names, drop)
    sizes = array_sizes(study, names)
    if not sizes:
        return study
    several = {**{name: count for name, count in names.points.items() if count > 1}, **sizes}
    skipped = dict.fromkeys(drop_counts(study, names), drop * HAMMERS)

    def nth(end: str, i: int) -> str:
        return f"{end}.{i}" if end in several else end

    def apart(specs: Mapping[str, Joining]) -> dict[str, Joining]:
        found: dict[str, Joining] = {}
        for name, spec in specs.items():
            counts = joined(spec.between, sizes, names)
            if not counts:
                found[name] = spec
            for i in range(1, max(counts, default=0) + 1):
                first, second = spec.between
                found[f"{name}.{i}"] = spec.model_copy(update={"between": (nth(first, i), nth(second, i))})
        return found

    bodies: dict[str, BodySpec] = {}
    for name, body in study.bodies.items():
        side, target = next(side for side in SIDES if getattr(body, side) is not None), body.target
        for i in range(1, sizes.get(name, 1) + 1):
            changes: dict[str, object] = {side: nth(target, i + skipped.get(name, 0))} if name in sizes else {}
            if body.source == TAPPING_MACHINE and body.blows is not None:
                changes["blows"] = body.blows.model_copy(update={"first": turn(i, _apart(study, body.blows))})
            bodies[nth(name, i)] = body.model_copy(update=changes)
    loads: dict[str, LoadSpec] = {}
    for name, load in study.loads.items():
        for i in range(1, sizes.get(load.body or "", 1) + 1):
            alone = load.body not in sizes
            loads[name if alone else f"{name}.{i}"] = (
                load if alone else load.model_copy(update={"body": f"{load.body}.{i}"})
            )
    contacts, links = apart(study.contacts), apart(study.links)
    own = {f"{name} on {study.bodies[name].target}": name for name in sizes}

    def each(target: str) -> list[str]:
        """What a record of an array stands for: one of every member, else itself."""
        if target in sizes:
            return members({target: sizes[target]})
        if target in own:
            name, on = own[target], study.bodies[own[target]].target
            return [f"{name}.{i} on {nth(on, i + skipped.get(name, 0))}" for i in range(1, sizes[name] + 1)]
        return [name for name in (*contacts, *links) if name.rpartition(".")[0] == target] or [target]

    record: dict[str, tuple[str, ...]] = {}
    for target, wanted in study.record.items():
        for one in each(target):  # a member may be named beside its array
            record[one] = tuple(dict.fromkeys((*record.get(one, ()), *wanted)))
    limits: dict[str, Measured] = {}
    for name, limit in study.limits.items():
        target, space, what = name.rpartition(" ")
        for one in each(target) if target else [""]:
            limits.setdefault(f"{one}{space}{what}", limit)
    return study.model_copy(
        update={
            "bodies": bodies,
            "contacts": contacts,
            "links": links,
            "loads": loads,
            "record": record,
            "limits": limits,
        }
    )


def _dropped(study: StudySpec, names: Names, drop: int) -> StudySpec:
    """The study with a source that is dropped at one of its places, and records and limits of its contact there."""
    bodies, record, limits = dict(study.bodies), dict(study.record), dict(study.limits)
    for name in drop_counts(study, names):
        body = study.bodies[name]
        if body.source not in DROPPED:
            continue
        place = f"{body.target}.{drop + 1}"
        bodies[name] = body.model_copy(update={"above": place})
        own = f"{name} on {body.target}"
        record = {f"{name} on {place}" if target == own else target: what for target, what in record.items()}
        limits = {
            f"{name} on {place} {limited.rpartition(' ')[2]}" if limited.rpartition(" ")[0] == own else limited: limit
            for limited, limit in limits.items()
        }
    return study.model_copy(update={"bodies": bodies, "record": record, "limits": limits})
