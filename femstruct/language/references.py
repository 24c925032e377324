"""The second pass over both files: names, and what the keys of one mapping say about each other."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from femstruct.language.reader import Mistakes, Steps, Tree, dotted, nearest
from femstruct.language.schema_model import (
    FoundationSpec,
    FrameSpec,
    ISpec,
    MassSpec,
    ModelSpec,
    PlateSpec,
    PointSpec,
    SpringSpec,
)
from femstruct.language.schema_study import SIDES, StudySpec

POINT_DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz", "n")
FORCES = ("force", "force_x", "force_y", "force_z")
_NAMESPACE = ("parts", "joints", "points", "surfaces", "supports", "bodies", "contacts", "links", "loads", "rooms")
_ALL_NAMED = (*_NAMESPACE, "materials", "sections", "frf")


@dataclass(frozen=True)
class Names:
    """What the names of a model and a study stand for. points : how many places each has, 1 for one."""

    points: dict[str, int]
    places: frozenset[str]
    forces: frozenset[str]

    @classmethod
    def of(cls, model: ModelSpec) -> Names:
        """The names a model offers to a study."""
        counts = {name: _count(spec) for name, spec in model.points.items()}
        if model.structure is not None and model.structure.type == "modes":
            counts |= dict.fromkeys(model.structure.points, 1)
        places = {name for name, count in counts.items() if count == 1}
        places |= {f"{name}.{n}" for name, count in counts.items() if count > 1 for n in range(1, count + 1)}
        return cls(counts, frozenset(places), frozenset({*model.parts, *model.joints, *model.supports, "ground"}))


def _count(spec: PointSpec) -> int:
    return len(spec.at) if isinstance(spec.at, tuple) else 1


class _Checker:
    def __init__(self, tree: Tree, mistakes: Mistakes) -> None:
        self.tree, self.mistakes = tree, mistakes

    def wrong(self, steps: Steps, got: str, expected: str, do: str = "", of_key: bool = False) -> None:
        self.mistakes.add(self.tree.position(steps, of_key), dotted(steps), got=got, expected=expected, do=do)

    def known(self, steps: Steps, name: str, kind: str, known: Iterable[str]) -> bool:
        names = list(known)
        if name in names:
            return True
        do = nearest(name, names) if names else f"there are none: add '{kind.split()[-1]}s:'"
        self.wrong(steps, f"'{name}'", f"the name of a {kind}", do)
        return False

    def place(self, steps: Steps, name: str, names: Names, also: Iterable[str] = ()) -> None:
        """A single place, or one of the other names."""
        extra = list(also)
        if name in names.places or name in extra:
            return
        if name in names.points:
            count = names.points[name]
            self.wrong(steps, f"'{name}', which has {count} places", "one place", f"write {name}.1 to {name}.{count}")
            return
        do = nearest(name, [*names.places, *extra])
        words = "point" if not extra else "point, body or ground" if "ground" in extra else "point or body"
        self.wrong(steps, f"'{name}'", f"the name of a {words}", do or "there are no points: add 'points:'")

    def spot(self, steps: Steps, text: str, names: Names, forces: Iterable[str] = (), of_key: bool = False) -> None:
        """An address: POINT.direction, or NAME.force where forces are allowed."""
        name, _, what = text.rpartition(".")
        known_forces = list(forces)
        if what in FORCES and known_forces:
            if name not in known_forces:
                self.wrong(steps, f"'{text}'", "a force of the structure", nearest(name, known_forces), of_key)
            return
        if not name or what not in POINT_DIRECTIONS:
            example = f"write it like {name or text}.z" if (name or text) in names.points else "write it like O_f.z"
            expected = f"POINT.{'|'.join(POINT_DIRECTIONS)}" + (" or NAME.force" if known_forces else "")
            self.wrong(steps, f"'{text}'", expected, example, of_key)
            return
        if name in names.places:
            return
        if name in names.points:
            do = f"write {name}.1.{what} to {name}.{names.points[name]}.{what}"
            self.wrong(steps, f"'{text}', which has several places", "one place", do, of_key)
            return
        known = sorted(names.places)
        self.wrong(steps, f"'{text}'", "a direction of a point", nearest(name, known) or "there are no points", of_key)


def check_names(model: Tree | None, study: Tree | None, mistakes: Mistakes) -> None:
    """Names contain no dots, and no two things share one."""
    seen: dict[str, str] = {}
    for tree in (model, study):
        if tree is None:
            continue
        check = _Checker(tree, mistakes)
        for group in _ALL_NAMED:
            named = tree.value.get(group)
            for name in named if isinstance(named, dict) else ():
                steps = (group, name)
                if "." in name or "[" in name or not name.strip():
                    clean = name.replace(".", "_").replace("[", "_") or "a name"
                    check.wrong(steps, f"the name '{name}'", "a name without dots", f"write {clean}", of_key=True)
                elif name == "ground":
                    check.wrong(steps, "the name 'ground'", "another name", "ground is what does not move", of_key=True)
                elif group in _NAMESPACE and name in seen:
                    got = f"'{name}', which names one of the {seen[name]} already"
                    check.wrong(steps, got, "one name for one thing", "rename one", of_key=True)
                elif group in _NAMESPACE:
                    seen[name] = group


def check_model(model: ModelSpec, tree: Tree, mistakes: Mistakes) -> None:
    """Every name a model uses is there, of the right kind, and its keys agree with each other."""
    check = _Checker(tree, mistakes)
    names = Names.of(model)
    plates = [name for name, part in model.parts.items() if isinstance(part, PlateSpec)]
    lined = [name for name, part in model.parts.items() if isinstance(part, PlateSpec | FrameSpec)]
    if model.structure is not None:
        for group in ("parts", "joints", "supports", "surfaces", "materials", "sections"):
            if getattr(model, group):
                check.wrong((group,), f"'{group}' beside 'structure'", "one of them", f"remove '{group}'", of_key=True)
    elif not model.parts:
        check.wrong((), "no parts", "'parts' or 'structure'", "add 'parts: ...', or 'structure: none' for bodies alone")
    for name, section in model.sections.items():
        _check_section(check, ("sections", name), section)
    for name, part in model.parts.items():
        steps: Steps = ("parts", name)
        if isinstance(part, PlateSpec | FrameSpec):
            check.known((*steps, "material"), part.material, "material", model.materials)
        if isinstance(part, FrameSpec):
            check.known((*steps, "section"), part.section, "section", model.sections)
        if isinstance(part, FoundationSpec) and check.known((*steps, "on"), part.on, "plate", plates):
            _check_spread(check, steps, part)
        if isinstance(part, SpringSpec):
            _check_spring(check, steps, part, names)
        if isinstance(part, MassSpec):
            _check_mass(check, steps, part, names, plates)
    for name, joint in model.joints.items():
        for number, part_name in enumerate(joint.connect):
            check.known(("joints", name, "connect", number), part_name, "part", lined)
        if joint.connect[0] == joint.connect[1]:
            check.wrong(("joints", name, "connect"), f"'{joint.connect[0]}' twice", "two different parts")
    for name, point in model.points.items():
        _check_point(check, ("points", name), point, model, lined)
    for name, surface in model.surfaces.items():
        check.known(("surfaces", name, "on"), surface.on, "plate", plates)
        if surface.region.rim is not None or surface.region.line is not None:
            check.wrong(("surfaces", name, "region"), "a rim or line", "an area", "use whole or rectangle")
    for name, support in model.supports.items():
        here: Steps = ("supports", name)
        if support.at is not None:
            check.known((*here, "at"), support.at, "point", [*names.points, *names.places])
            if support.edge is not None or support.line is not None:
                check.wrong(here, "an edge or line of a point", "a point alone, or 'on: PART' with an edge")
        elif support.on is not None:
            check.known((*here, "on"), support.on, "plate" if support.edge or support.line else "part", lined)
            if support.edge is None and support.line is None and isinstance(support.fix, str):
                do = "add edge: all, or list the directions as in [x, y]"
                check.wrong((*here, "fix"), f"'{support.fix}' for a whole part", "an edge, a line or directions", do)
    for mode in model.damping.modes:
        if not re.fullmatch("[1-9][0-9]{0,5}", mode):
            check.wrong(("damping", "modes", mode), f"'{mode}'", "a mode number from 1", of_key=True)


def _check_section(check: _Checker, steps: Steps, section: object) -> None:
    if isinstance(section, ISpec):
        return
    thickness = getattr(section, "thickness", None)
    if thickness is not None:
        smallest = min(getattr(section, key) for key in ("diameter", "width", "height") if hasattr(section, key))
        if not 2 * thickness < smallest:
            check.wrong((*steps, "thickness"), f"{thickness:g} m", f"less than half of {smallest:g} m")


def _check_spread(check: _Checker, steps: Steps, part: FoundationSpec) -> None:
    along = part.region.rim is not None or part.region.line is not None
    right = "stiffness/length" if along else "stiffness/area"
    unit = "N/m^2 (per length of a rim or line)" if along else "N/m^3 (per area)"
    for key in ("normal", "shear"):
        measured = getattr(part.stiffness, key)
        if measured.dimension not in (None, right):
            other = "N/m^3" if along else "N/m^2"
            check.wrong((*steps, "stiffness", key), f"a stiffness in {other}", unit, "match the unit to the region")
    if not (part.stiffness.normal.value or part.stiffness.shear.value):
        check.wrong((*steps, "stiffness"), "no stiffness at all", "a positive normal or shear stiffness")


def _check_spring(check: _Checker, steps: Steps, part: SpringSpec, names: Names) -> None:
    first, second = part.between
    known = [*names.points, *names.places]
    if first == "ground":
        check.wrong((*steps, "between", 0), "'ground'", "a point first", f"write [{second}, ground]")
    else:
        check.known((*steps, "between", 0), first, "point", known)
    if second != "ground":
        check.known((*steps, "between", 1), second, "point", [*known, "ground"])
    if not any((*part.stiffness.model_dump().values(), *part.damping.model_dump().values())):
        check.wrong(steps, "no stiffness and no damping", "one of them", "add stiffness: {z: ...}", of_key=True)


def _check_mass(check: _Checker, steps: Steps, part: MassSpec, names: Names, plates: list[str]) -> None:
    if (part.at is None) == (part.on is None):
        check.wrong(
            steps, "both 'at' and 'on'" if part.at else "no place", "one of at: POINT and on: PART", of_key=True
        )
        return
    along = part.region is not None and (part.region.rim is not None or part.region.line is not None)
    allowed = ("mass",) if part.at is not None else ("mass", "mass/length") if along else ("mass", "mass/area")
    if part.mass.dimension not in (None, *allowed):
        units = {"mass": "kg", "mass/length": "kg/m", "mass/area": "kg/m^2"}
        got = f"a mass in {units[part.mass.dimension or 'mass']}"
        where = "at a point" if part.at is not None else "along a rim or line" if along else "over an area"
        check.wrong((*steps, "mass"), f"{got} {where}", " or ".join(units[one] for one in allowed))
    if part.at is not None:
        check.known((*steps, "at"), part.at, "point", [*names.points, *names.places])
        if part.region is not None:
            check.wrong((*steps, "region"), "a region at a point", "a region on a part", "use on: PART", of_key=True)
    elif part.on is not None:
        check.known((*steps, "on"), part.on, "plate", plates)


def _check_point(check: _Checker, steps: Steps, point: PointSpec, model: ModelSpec, lined: list[str]) -> None:
    if model.structure is None:
        for key in ("on", "at"):
            if getattr(point, key) is None:
                check.wrong(steps, "nothing", f"'{key}'", f"add '{key}: ...'", of_key=True)
        if point.on is not None and check.known((*steps, "on"), point.on, "part", lined):
            part = model.parts[point.on]
            wanted = 2 if isinstance(part, PlateSpec) else 3
            if point.at == "center" and wanted == 3:
                check.wrong((*steps, "at"), "center of a frame", "global coordinates", "write [x, y, z]")
            if isinstance(point.at, tuple) and any(len(one) != wanted for one in point.at):
                got = f"{len(point.at[0])} coordinates"
                check.wrong((*steps, "at"), got, f"{wanted} on a {part.type}", "global axes" if wanted == 3 else "")
        return
    kind = model.structure.type
    if kind in ("none", "modes"):
        where = "the structure's own 'points'" if kind == "modes" else "no points: there is no structure"
        check.wrong(steps, f"a point of structure '{kind}'", where, "move or remove it", of_key=True)
    elif kind == "oscillator":
        if point.at is not None or point.on is not None:
            check.wrong(steps, "a place", "{} for a point of an oscillator")
    else:
        length = getattr(model.structure, "length", 0.0)
        for one in point.at if isinstance(point.at, tuple) else ((length / 2,),) if point.at else ():
            if len(one) != 1 or not 0 <= one[0] <= length:
                got = f"{one[0]:g} m" if len(one) == 1 else f"{len(one)} coordinates"
                check.wrong((*steps, "at"), got, f"a position from 0 to {length:g} m along it")
        if point.at is None:
            check.wrong(steps, "nothing", "'at'", "add 'at: 0'", of_key=True)
        if point.on is not None:
            check.wrong((*steps, "on"), "'on'", f"a position along the {kind} only", "remove it", of_key=True)


def check_study(study: StudySpec, tree: Tree, model: ModelSpec, mistakes: Mistakes) -> None:
    """Every name a study uses is there, of the right kind, and its keys agree with each other."""
    check = _Checker(tree, mistakes)
    names = Names.of(model)
    ends = [*study.bodies, "ground"]
    if study.modes is None and model.structure is None:
        check.wrong((), "no modes", "how many modes to use", "add 'modes: {up_to: 3 kHz}'")
    for name, request in study.frf.items():
        here: Steps = ("frf", name)
        for key in ("drive", "response"):
            check.spot((*here, key), getattr(request, key), names, names.forces)
        if not request.band[0] < request.band[1]:
            check.wrong((*here, "band"), f"{request.band[0]:g} to {request.band[1]:g} Hz", "a rising band [low, high]")
        elif (request.band[1] - request.band[0]) / request.step > 1e6:
            check.wrong((*here, "step"), f"{request.step:g} Hz", "at most a million lines", "take a wider step")
    for name, body in study.bodies.items():
        key = next(side for side in SIDES if getattr(body, side) is not None)
        check.place(
            ("bodies", name, key), getattr(body, key), names, [*(n for n in study.bodies if n != name), "ground"]
        )
    for group, items in (("contacts", study.contacts), ("links", study.links)):
        for name, item in items.items():
            for number, end in enumerate(item.between):
                check.place((group, name, "between", number), end, names, ends)
            if item.between[0] == item.between[1]:
                check.wrong((group, name, "between"), f"'{item.between[0]}' twice", "two different ends")
    for name, contact in study.contacts.items():
        if contact.gap and contact.preload:
            got = f"a gap of {contact.gap:g} m and a preload of {contact.preload:g} N"
            check.wrong(("contacts", name), got, "one of them", "a preloaded contact is closed: remove the gap")
    for name, link in study.links.items():
        if not (link.stiffness or link.damping.closing or link.damping.opening or link.preload):
            check.wrong(("links", name), "no stiffness and no damping", "one of them", of_key=True)
    _check_contacts(check, study)
    _check_loads(check, study, names, model)
    for address in study.initial.velocity or {}:
        check.spot(("initial", "velocity", address), address, names, of_key=True)
        rotation = address.rpartition(".")[2] in ("rx", "ry", "rz")
        measured = (study.initial.velocity or {})[address]
        if measured.dimension not in (None, "angular speed" if rotation else "speed"):
            check.wrong(("initial", "velocity", address), f"a {measured.dimension}", "rad/s" if rotation else "m/s")
    if study.initial.rigid is not None:
        check.place(("initial", "rigid", "about"), study.initial.rigid.about, names)
    _check_records(check, study, names)
    for name, room in study.rooms.items():
        check.known(("rooms", name, "under"), room.under, "surface", model.surfaces)
        if room.losses is not None and room.losses.t60 is not None and room.form == "source":
            check.wrong(
                ("rooms", name, "form"), "the source's form with t60", "beta or loss_factor", "leave out 'form'"
            )
        for receiver, places in room.receivers.items():
            for place in places:
                if not all(0 <= x <= length for x, length in zip(place, room.size, strict=True)):
                    steps: Steps = ("rooms", name, "receivers", receiver)
                    size = " x ".join(f"{length:g}" for length in room.size)
                    check.wrong(steps, f"{list(place)} m", f"a point of the room, {size} m", "from its lower corner")
    moving = study.bodies or study.loads or study.initial.velocity or study.initial.rigid or study.record or study.rooms
    if moving and study.time is None:
        check.wrong((), "no time", "how long to simulate", "add 'time: {duration: 1 s, sampling: 48 kHz}'")
    if study.compare is not None and study.cases:
        check.known(("compare", "baseline"), study.compare.baseline, "case", study.cases)


def _check_contacts(check: _Checker, study: StudySpec) -> None:
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


def _check_loads(check: _Checker, study: StudySpec, names: Names, model: ModelSpec) -> None:
    for name, load in study.loads.items():
        here: Steps = ("loads", name)
        if load.at is not None:
            check.spot((*here, "at"), load.at, names)
        elif load.body is not None:
            check.known((*here, "body"), load.body, "body", study.bodies)
        elif load.on is not None:
            check.known((*here, "on"), load.on, "surface", model.surfaces)
        if load.half_sine is not None:
            right = "pressure" if load.on is not None else "force"
            if load.half_sine.amplitude.dimension not in (None, right):
                where = (*here, "half_sine", "amplitude")
                check.wrong(
                    where, f"a {load.half_sine.amplitude.dimension}", f"a {right}", "surfaces take Pa, points N"
                )


def _check_records(check: _Checker, study: StudySpec, names: Names) -> None:
    own = [
        f"{name} on {body.above or body.below or body.before or body.after}"
        for name, body in study.bodies.items()
        if body.contact is not None
    ]
    forced = [*names.forces, *study.contacts, *study.links, *own]
    for target, wanted in study.record.items():
        steps: Steps = ("record", target)
        for what in wanted:
            if target in study.bodies:
                if what not in ("displacement", "velocity", "travel"):
                    check.wrong(steps, f"'{what}' of a body", "displacement, velocity or travel")
            elif target in forced:
                if what != "force":
                    check.wrong(steps, f"'{what}' of '{target}'", "force")
            elif what in ("force", "travel"):
                words = "a body" if what == "travel" else "a contact, link, part, joint, support or ground"
                known = list(study.bodies) if what == "travel" else forced
                check.wrong(steps, f"'{target}'", f"the name of {words}", nearest(target, known), of_key=True)
            elif "." in target:
                check.spot(steps, target, names, of_key=True)
            else:
                known = [*study.bodies, *(f"{place}.z" for place in names.places)]
                do = nearest(target, known)
                check.wrong(steps, f"'{target}'", "a direction of a point, or a body", do, of_key=True)
