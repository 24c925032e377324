"""The second pass over a study file: its names, and what its keys say about each other."""

from __future__ import annotations

from collections.abc import Mapping

from femstruct.impact.scene.impact_sources import HAMMERS, TAPPING_MACHINE
from femstruct.language.arrays import array_sizes, drop_counts, joined, members, spread
from femstruct.language.limits import check_limits
from femstruct.language.model.model import ModelSpec
from femstruct.language.references_rooms import check_power, check_pressure, check_rooms
from femstruct.language.schema_study import SIDES, BodySpec, StudySpec, TimeSpec
from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.here import Names
from femstruct.language.yaml.reader import Mistakes, Steps, Tree, nearest

MOST_SAMPLES, FEWEST_SAMPLES = 20_000_000, 5


def check_study(study: StudySpec, tree: Tree, model: ModelSpec, mistakes: Mistakes) -> None:
    """Every name a study uses is there, of the right kind, and its keys agree with each other."""
    check = Checker(tree, mistakes)
    names = model.names()
    sizes = array_sizes(study, names)
    each = members(sizes)
    if study.modes is None and model.structure is None:
        check.wrong((), "no modes", "how many modes to use", "add 'modes: {up_to: 3 kHz}'")
    _check_requests(check, study, names)
    _check_ends(check, study, names, sizes)
    for name, contact in study.contacts.items():
        if contact.gap and contact.preload:
            got = f"a gap of {contact.gap:g} m and a preload of {contact.preload:g} N"
            check.wrong(("contacts", name), got, "one of them", "a preloaded contact is closed: remove the gap")
    for name, link in study.links.items():
        if not (link.stiffness or link.damping.closing or link.damping.opening or link.preload):
            check.wrong(("links", name), "no stiffness and no damping", "one of them", of_key=True)
    _check_contacts(check, study)
    _check_blows(check, study)
    _check_radii(check, study)
    _check_drops(check, study, names)
    _check_loads(check, study, names, model, each)
    for address in study.initial.velocity or {}:
        check.spot(("initial", "velocity", address), address, names, of_key=True)
        rotation = address.rpartition(".")[2] in ("rx", "ry", "rz")
        measured = (study.initial.velocity or {})[address]
        if measured.dimension not in (None, "angular speed" if rotation else "speed"):
            check.wrong(("initial", "velocity", address), f"a {measured.dimension}", "rad/s" if rotation else "m/s")
    if study.initial.rigid is not None:
        check.place(("initial", "rigid", "about"), study.initial.rigid.about, names)
    _check_records(check, study, names)
    check_limits(check, study)
    check_rooms(check, study, model)
    if study.time is not None:
        _check_time(check, study, study.time)
    _check_accuracy(check, study, model)
    moving = (
        study.bodies or study.loads or study.initial.velocity or study.initial.rigid or study.record or study.limits
    )
    heard = any(request.kind in ("pressure", "power") for request in study.frf.values())
    if (moving or (study.rooms and not heard)) and study.time is None:
        check.wrong((), "no time", "how long to simulate", "add 'time: {duration: 1 s, sampling: 48 kHz}'")
    if study.compare is not None and study.cases:
        check.known(("compare", "baseline"), study.compare.baseline, "case", study.cases)


def _check_requests(check: Checker, study: StudySpec, names: Names) -> None:
    """Frequency responses: their addresses, bands and steps."""
    for name, request in study.frf.items():
        here: Steps = ("frf", name)
        check.spot((*here, "drive"), request.drive, names, names.forces)
        if request.kind == "power" or request.response.endswith(".power"):
            check_power(check, study, name, request)
        elif (request.kind == "pressure") or request.response.endswith(".pressure"):
            check_pressure(check, study, name, request)
        else:
            check.spot((*here, "response"), request.response, names, names.forces)
        if not request.band[0] < request.band[1]:
            check.wrong((*here, "band"), f"{request.band[0]:g} to {request.band[1]:g} Hz", "a rising band [low, high]")
        elif (request.band[1] - request.band[0]) / request.step > 1e6:
            check.wrong((*here, "step"), f"{request.step:g} Hz", "at most a million lines", "take a wider step")


def _check_ends(check: Checker, study: StudySpec, names: Names, sizes: Mapping[str, int]) -> None:
    """What bodies stand on, and what contacts and links are between."""
    ends = [*study.bodies, *members(sizes), "ground"]
    for name, body in study.bodies.items():
        side, target = next(side for side in SIDES if getattr(body, side) is not None), body.target
        if body.source == TAPPING_MACHINE and sizes.get(name, 1) != HAMMERS:
            got = f"{sizes.get(name, 1)} places for the {HAMMERS} hammers of a tapping machine"
            expected = f"a point of {HAMMERS} places, or of {HAMMERS} for each position"
            check.wrong(("bodies", name, side), got, expected, "100 mm apart, in a line")
        if names.points.get(target, 1) == 1:
            own = [name, *members({name: sizes.get(name, 0)})]
            check.place(("bodies", name, side), target, names, [end for end in ends if end not in own])
    for group, items in (("contacts", study.contacts), ("links", study.links)):
        for name, item in items.items():
            counts = joined(item.between, sizes, names)
            if len({count for count in counts if count > 1}) > 1:
                told = " and ".join(f"{n} {end}" for n, end in zip(counts, item.between, strict=True))
                check.wrong((group, name, "between"), told, "as many of both, or one", "name one of them, as NAME.1")
            for number, end in enumerate(item.between):
                if not counts or counts[number] == 1:
                    check.place((group, name, "between", number), end, names, ends)
            if item.between[0] == item.between[1]:
                check.wrong((group, name, "between"), f"'{item.between[0]}' twice", "two different ends")


def _check_time(check: Checker, study: StudySpec, time: TimeSpec) -> None:
    if time.duration * time.sampling > MOST_SAMPLES:
        got = f"{time.duration * time.sampling:.3g} samples"
        check.wrong(("time",), got, f"at most {MOST_SAMPLES:.0e}", "shorten the duration or lower the sampling")
    if time.duration * time.sampling < FEWEST_SAMPLES:
        got = f"{time.duration * time.sampling:.3g} samples"
        check.wrong(("time",), got, f"at least {FEWEST_SAMPLES}", "lengthen the duration or raise the sampling")
    if study.peaks.lowpass is not None and not study.peaks.lowpass < time.sampling / 2:
        got = f"{study.peaks.lowpass:g} Hz"
        check.wrong(
            ("peaks", "lowpass"), got, f"less than half the sampling, {time.sampling / 2:g} Hz", "sample faster"
        )


def _check_accuracy(check: Checker, study: StudySpec, model: ModelSpec) -> None:
    """An accuracy needs a simulation that records something, a band below half the sampling, and modes to add."""
    asked = study.accuracy
    if asked is None:
        return
    here: Steps = ("accuracy",)
    low, high = asked.band
    if not low < high:
        check.wrong((*here, "band"), f"{low:g} to {high:g} Hz", "a rising band [low, high]")
    if study.time is None:
        check.wrong(here, "no time", "an impact to be accurate about", "add 'time: {duration: 1 s, sampling: 48 kHz}'")
    elif not high < study.time.sampling / 2:
        limit = f"less than half the sampling, {study.time.sampling / 2:g} Hz"
        check.wrong((*here, "band"), f"{high:g} Hz", limit, "sample faster")
    if not (study.record or study.contacts or any(body.contact is not None for body in study.bodies.values())):
        check.wrong(here, "no record and no contact", "something to compare", "add 'record: {POINT.z: acceleration}'")
    kind = model.structure if isinstance(model.structure, str) else getattr(model.structure, "type", "")
    if kind in ("none", "modes"):
        got = "a structure of given modes" if kind == "modes" else "no structure"
        check.wrong(here, got, "a structure that has more modes to add", "remove 'accuracy'")
    first = study.modes.up_to if study.modes is not None else None
    if asked.up_to is not None and first is not None and asked.up_to < first and model.structure is None:
        check.wrong((*here, "up_to"), f"{asked.up_to:g} Hz", f"at least modes.up_to, {first:g} Hz")


def _check_contacts(check: Checker, study: StudySpec) -> None:
    """A body that owns its contact agrees with the named one between the same ends; so do two named ones."""
    by_ends: dict[frozenset[str], str] = {}
    for name, contact in study.contacts.items():
        ends = frozenset(contact.between)
        first = by_ends.setdefault(ends, name)
        if first != name and study.contacts[first].gap == contact.gap:
            got = f"a second contact between {' and '.join(contact.between)} (the first is '{first}')"
            check.wrong(("contacts", name), got, "one contact, or another gap", "remove one", of_key=True)
    for name, body in study.bodies.items():
        target = body.above or body.below or body.before or body.after or ""
        named = by_ends.get(frozenset((name, target)))
        if body.contact is not None and named is not None and study.contacts[named].law != body.contact:
            steps: Steps = ("bodies", name, "contact")
            got = f"a contact that disagrees with 'contacts.{named}' between the same ends"
            check.wrong(steps, got, "one contact, or two that agree", "remove one of them", of_key=True)
        if body.contact is not None and named is None and f"{name} on {target}" in study.contacts:
            steps = ("contacts", f"{name} on {target}")
            check.wrong(steps, "the name of a body's own contact", "another name", "rename it", of_key=True)


def _check_blows(check: Checker, study: StudySpec) -> None:
    """A body that strikes again and again has a speed to strike with, and nothing holds it."""
    struck = [name for name, body in study.bodies.items() if body.blows is not None]
    for name in struck:
        body = study.bodies[name]
        if not (body.speed or body.drop_height):
            check.wrong(("bodies", name, "blows"), "no speed", "a body that strikes", "add 'speed:' or 'drop_height:'")
        if body.blows is not None and body.blows.timing is not None and body.source != TAPPING_MACHINE:
            expected = "no timing: each body strikes at its given time"
            check.wrong(("bodies", name, "blows", "timing"), "a body that is no tapping machine", expected, "remove it")
    for name, link in study.links.items():
        for number, end in enumerate(link.between):
            if end in struck:
                got = f"'{end}', which is lifted off at every blow"
                check.wrong(("links", name, "between", number), got, "a body without blows", "remove one of them")
    for name, contact in study.contacts.items():
        held = [end for end in contact.between if end in struck]
        if contact.preload and held:
            got = f"a preload on '{held[0]}', which is lifted off at every blow"
            check.wrong(("contacts", name, "preload"), got, "none", "remove it, or the blows")


def _check_radii(check: Checker, study: StudySpec) -> None:
    """The radius of a body is that of what is heard on its side, or of a hertz law without its own."""
    for name, body in study.bodies.items():
        heard = [
            room for room in study.rooms.values() if room.receivers and getattr(room, _side(body), None) is not None
        ]
        laws = [one.law for one in study.contacts.values() if name in one.between]
        if body.contact is not None:
            laws.append(body.contact)
        touches = any(law.takes_radius for law in laws)
        if body.radius is not None and not heard and not touches:
            if _side(body) in ("above", "below"):
                do = f"add 'rooms.open: {{{_side(body)}: SURFACE, receivers: {{mic: [x, y, z]}}}}', or remove it"
            else:
                do = "remove it: the own sound of bodies that move along x is not computed"
            got = f"a radius, and no receivers {_side(body)} a surface"
            expected = "open air on the side of the body, or a hertz law without a radius"
            check.wrong(("bodies", name, "radius"), got, expected, do)


def _side(body: BodySpec) -> str:
    return next(side for side in SIDES if getattr(body, side) is not None)


def _check_drops(check: Checker, study: StudySpec, names: Names) -> None:
    """One source goes from place to place."""
    counts = drop_counts(study, names)
    for name in list(counts)[1:]:
        first = next(iter(counts))
        got = f"a second source of several places (the first is '{first}')"
        check.wrong(("bodies", name, "above"), got, "one", f"give '{name}' one place")


def _check_loads(check: Checker, study: StudySpec, names: Names, model: ModelSpec, each: list[str]) -> None:
    for name, load in study.loads.items():
        here: Steps = ("loads", name)
        if load.at is not None:
            check.spot((*here, "at"), load.at, names)
        elif load.body is not None:
            check.known((*here, "body"), load.body, "body", [*study.bodies, *each])
        elif load.on is not None:
            check.known((*here, "on"), load.on, "surface", model.surfaces)
        for place in load.along or ():
            check.known((*here, "along"), place, "point", [*names.points, *names.places])
        if (load.count is None) != (load.every is None):
            given, missing = ("count", "every") if load.every is None else ("every", "count")
            check.wrong((*here, given), f"'{given}' without '{missing}'", "both or none", f"add '{missing}: ...'")
        if load.half_sine is not None:
            right = "pressure" if load.on is not None else "force"
            if load.half_sine.amplitude.dimension not in (None, right):
                where = (*here, "half_sine", "amplitude")
                check.wrong(
                    where, f"a {load.half_sine.amplitude.dimension}", f"a {right}", "surfaces take Pa, points N"
                )


def _check_records(check: Checker, study: StudySpec, names: Names) -> None:
    parted = spread(study, names)
    bodies = dict.fromkeys((*study.bodies, *parted.bodies))
    own = [
        f"{name} on {body.target}"
        for spec in (study, parted)
        for name, body in spec.bodies.items()
        if body.contact is not None
    ]
    forced = list(dict.fromkeys((*names.forces, *study.contacts, *parted.contacts, *study.links, *parted.links, *own)))
    for target, wanted in study.record.items():
        steps: Steps = ("record", target)
        for what in wanted:
            if target in bodies:
                if what not in ("displacement", "velocity", "travel"):
                    check.wrong(steps, f"'{what}' of a body", "displacement, velocity or travel")
            elif target in forced:
                if what != "force":
                    check.wrong(steps, f"'{what}' of '{target}'", "force")
            elif what in ("force", "travel"):
                words = "a body" if what == "travel" else "a contact, link, part, joint, support or ground"
                known = list(bodies) if what == "travel" else forced
                check.wrong(steps, f"'{target}'", f"the name of {words}", nearest(target, known), of_key=True)
            elif "." in target:
                check.spot(steps, target, names, of_key=True)
            else:
                known = [*bodies, *(f"{place}.z" for place in names.places)]
                do = nearest(target, known)
                check.wrong(steps, f"'{target}'", "a direction of a point, or a body", do, of_key=True)
