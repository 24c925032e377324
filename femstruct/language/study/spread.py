"""A study with one body for every member of its arrays, and one study for every place that a source strikes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from femstruct.impact.scene.impact_sources import BETWEEN_BLOWS, DROPPED, HAMMERS, TAPPING_MACHINE
from femstruct.language.study.body import BlowsSpec, BodySpec
from femstruct.language.study.body_arrays import array_sizes, bodies_of, drop_counts, joined
from femstruct.language.study.contact import ContactSpec
from femstruct.language.study.link import LinkSpec
from femstruct.language.study.load import LoadSpec
from femstruct.language.study.sources.standard_source import UNCORRELATED, turn
from femstruct.language.study.study import StudySpec
from femstruct.language.yaml import Measured, Names

Joining = TypeVar("Joining", ContactSpec, LinkSpec)


def drops(study: StudySpec, names: Names) -> dict[str, StudySpec]:
    """The studies of all places that a standard source is to strike, one each, by the place; {} for one place."""
    found: dict[str, StudySpec] = {}
    for name, count in drop_counts(study.bodies, names).items():
        body = study.bodies[name]
        for i in range(count):
            several = f"{i * HAMMERS + 1}-{(i + 1) * HAMMERS}"
            found[f"{body.target}.{i + 1 if body.source in DROPPED else several}"] = spread(study, names, i)
    return found


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
    sizes = array_sizes(study.bodies, names)
    if not sizes:
        return study
    arrays = {**{name: count for name, count in names.points.items() if count > 1}, **sizes}
    skipped = dict.fromkeys(drop_counts(study.bodies, names), drop * HAMMERS)

    def nth(end: str, i: int) -> str:
        return f"{end}.{i}" if end in arrays else end

    def apart(specs: Mapping[str, Joining]) -> dict[str, Joining]:
        found: dict[str, Joining] = {}
        for name, spec in specs.items():
            (first, second), counts = spec.between, joined(spec.between, sizes, names)
            for i in range(1, max(counts) + 1) if counts else ():
                found[f"{name}.{i}"] = spec.model_copy(update={"between": (nth(first, i), nth(second, i))})
            if not counts:
                found[name] = spec
        return found

    bodies: dict[str, BodySpec] = {}
    loads: dict[str, LoadSpec] = {}
    for name, body in study.bodies.items():
        for i in range(1, sizes.get(name, 1) + 1):
            changes: dict[str, object] = {}
            if name in sizes:
                changes[body.side] = nth(body.target, i + skipped.get(name, 0))
            if body.source == TAPPING_MACHINE and body.blows is not None:
                changes["blows"] = body.blows.model_copy(update={"first": turn(i, _apart(study, body.blows))})
            bodies[nth(name, i)] = body.model_copy(update=changes)
    for name, load in study.loads.items():
        of = sizes.get(load.body or "", 0)
        loads |= {f"{name}.{i}": load.model_copy(update={"body": f"{load.body}.{i}"}) for i in range(1, of + 1)}
        if not of:
            loads[name] = load
    contacts, links = apart(study.contacts), apart(study.links)
    own = {f"{name} on {study.bodies[name].target}": name for name in sizes}

    def each(target: str) -> list[str]:
        """What a record of an array stands for: one of every member, else itself."""
        if target in sizes:
            return bodies_of({target: sizes[target]})
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
    parted = {"bodies": bodies, "contacts": contacts, "links": links, "loads": loads}
    return study.model_copy(update={**parted, "record": record, "limits": limits})


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
