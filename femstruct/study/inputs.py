"""What a study is made of: its inputs as values, group by group, and what differs between two cases."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, is_dataclass, replace
from math import pi, sqrt
from typing import Any, Final, NamedTuple

from femstruct.conventions import GRAVITY
from femstruct.model.lay_ups import LayUp, materials_of
from femstruct.model.materials import AnyMaterial, Given, comparable, given_fields, of_material, of_section
from femstruct.model.sections import Section
from femstruct.model.structure import HARD, SOFT, AirBetween, Joint, Structure, Support
from femstruct.study.acting import PlacedBody, PlannedContact, PlannedLink, PlannedLoad
from femstruct.study.asked import FatigueRequest, RoomPlan, Vibration
from femstruct.study.study import Study

UNITS: Final = {  # of the fields of a study's nouns
    "mass": "kg", "mass_per_length": "kg/m", "length": "m", "area": "m^2", "E": "Pa", "rho": "kg/m^3", "EI": "N m^2",
    "frequency_hz": "Hz", "stiffness": "N/m", "closing": "N s/m", "opening": "N s/m", "release_at": "s", "gap": "m",
    "preload": "N", "duration": "s", "sampling": "Hz", "quiet": "s", "first_impact": "s", "lowpass_hz": "Hz",
    "band": "Hz", "step": "Hz", "up_to_hz": "Hz", "every": "s", "first": "s", "pace": "Hz", "velocity": "m/s",
    "spin": "rad/s", "alpha": "1/s", "beta": "s", "near_hz": "Hz", "relaxation_time": "s", "decay_rate": "1/s",
    "frequency": "Hz", "at": "m", "radius": "m", "times": "s", "slip": "N/m^2",
}  # fmt: skip

CAVITY: Final = {
    "depth": "m", "c": "m/s", "rho": "kg/m^3", "up_to": "Hz", "flow_resistivity": "Pa s/m^2", "density": "kg/m^3",
    "thickness": "m", "width": "m",
}  # fmt: skip

COUNTED: Final = {  # in the name of a channel: its unit
    "stress": "Pa", "force": "N", "displacement": "m", "travel": "m", "velocity": "m/s", "acceleration": "m/s^2",
    "pressure": "Pa",
}  # fmt: skip
SPELT: Final = 12  # more points of a spectrum are counted
LEAK: Final = {"inertance": "kg/m^4", "resistance": "Pa s/m^3"}
ENDS: Final = {"_hz": "Hz", "_m": "m", "_s": "s"}  # of names that have a unit


class Item(NamedTuple):
    """One noun of the inputs: its name, its kind in a word, and what is given of it."""

    name: str
    kind: str
    given: tuple[Given, ...]


class Difference(NamedTuple):
    """What two cases give of one noun: before, in the baseline, and after. Empty for a noun that is not there."""

    group: str
    name: str
    before: tuple[Given, ...]
    after: tuple[Given, ...]


@dataclass(frozen=True)
class Inputs:
    """The inputs of a study by group ("materials", "parts", "bodies", .. "analysis"); no group is empty."""

    groups: Mapping[str, tuple[Item, ...]]


def inputs(study: Study) -> Inputs:
    """All inputs of a study.

    >>> from femstruct.modal.damping import Damping, Ratio
    >>> from femstruct.study.structures import OscillatorModel
    >>> from femstruct.study.asked import Extent
    >>> oscillator = OscillatorModel(mass=2.0, frequency_hz=None, stiffness=800.0, points={"m": 1.0})
    >>> asked = inputs(Study("hit", oscillator, Damping(Ratio(0.02)), Extent(count=1)))
    >>> asked.groups["structure"][0].given[0]
    Given(what='mass', value=2.0, unit='kg')
    """
    structure = study.structure
    groups: dict[str, list[Item]] = {"materials": [], "sections": []}
    if isinstance(structure, Structure):
        groups["parts"] = [Item(part.name, _word(part), part.described()) for part in structure.parts]
        _name_nouns(groups)
        groups["supports"] = [_item(_named_edge(one), "support") for one in structure.supports]
        groups["joints"] = [_joint(one) for one in structure.joints]
        groups["constraints"] = [_item(one, _word(one)) for one in structure.constraints]
        groups["points"] = [_item(one, "point") for one in structure.points]
        groups["surfaces"] = [_item(one, "surface") for one in structure.surfaces]
        groups["cavities"] = [_cavity(one) for one in structure.cavities]
    else:
        groups["structure"] = [
            Item("structure", _word(structure).removesuffix(" model"), given_fields(structure, UNITS))
        ]
    groups["bodies"] = [_body(one) for one in study.bodies]
    groups["contacts"] = [_contact(one) for one in study.contacts]
    groups["links"] = [_link(one, study.bodies) for one in study.links]
    groups["loads"] = [
        *(_load(one) for one in study.loads),
        *(_item(one, "walker") for one in study.walks),
    ]
    groups["rooms"] = [_room(one) for one in study.rooms]
    groups["frequency responses"] = [_item(one, one.kind, without=("kind",)) for one in study.frf]
    groups["fatigue"] = [_fatigue(one) for one in study.fatigue]
    groups["vibration"] = [_vibration(one) for one in study.vibration]
    groups["analysis"] = [Item(name, "", found) for name, found in _analysis(study).items() if found]
    return Inputs({name: tuple(items) for name, items in groups.items() if items})


def differences(baseline: Inputs, case: Inputs) -> tuple[Difference, ...]:
    """What a case gives otherwise than the baseline; of a noun that both have only what is not alike."""
    found = []
    for group in dict.fromkeys((*baseline.groups, *case.groups)):
        first, second = ({one.name: one for one in side.groups.get(group, ())} for side in (baseline, case))
        for name in dict.fromkeys((*first, *second)):
            before, after = (_all(side.get(name)) for side in (first, second))
            if before != after:
                both = bool(before and after)
                left = tuple(one for one in before if not (both and one in after))
                right = tuple(one for one in after if not (both and one in before))
                found.append(Difference(group, name, left, right))
    return tuple(found)


def _all(item: Item | None) -> tuple[Given, ...]:
    return () if item is None else (*([Given("kind", item.kind)] if item.kind else []), *item.given)


def _word(noun: object) -> str:
    """The class of a noun in words.

    >>> from acoustics.air import Air
    >>> _word(Air())
    'air'
    """
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(noun).__name__).lower()


def _item(noun: Any, kind: str, without: tuple[str, ...] = ()) -> Item:
    return Item(noun.name, kind, _flat(one for one in given_fields(noun, UNITS) if one.what not in without))


def _named_edge(item: Support) -> Support:
    """A simple support with the word for what it is: of a thin plate's edge hard, of a set or box soft."""
    if item.fix != "simple" or (item.region is None and item.edge is None and item.line is None):
        return item
    return replace(item, fix=HARD if item.region is None else SOFT)


def _flat(found: Any) -> tuple[Given, ...]:
    """The same with the fields of unnamed nouns in their place, and addresses as text."""
    flat: list[Given] = []
    for one in found:
        if hasattr(one.value, "described"):
            flat += [Given(one.what, one.value.word or _word(one.value)), *one.value.described()]
        elif is_dataclass(one.value) and type(one.value).__str__ is object.__str__:
            flat += given_fields(one.value, UNITS)
        else:
            flat.append(one._replace(value=str(one.value)) if is_dataclass(one.value) else one)
    return tuple(flat)


def _name_nouns(groups: dict[str, list[Item]]) -> None:
    """Give materials and sections of parts their own groups, and the parts their names."""
    for number, part in enumerate(groups["parts"]):
        named: list[Given] = []
        for one in part.given:
            noun = one.value
            if isinstance(noun, AnyMaterial | LayUp):
                made_of = materials_of(noun)
                groups["materials"] += [Item(material.name, "", of_material(material)) for material in made_of]
            elif isinstance(noun, Section):
                groups["sections"].append(Item(noun.name, "section", of_section(noun)))
            if isinstance(noun, LayUp):
                named += noun.described()
            else:
                named.append(one._replace(value=noun.name) if isinstance(noun, AnyMaterial | Section) else one)
        groups["parts"][number] = part._replace(given=tuple(named))
    for group in ("materials", "sections"):
        groups[group] = list(dict.fromkeys(groups[group]))


def _joint(joint: Joint) -> Item:
    item = _item(joint, f"{joint.kind} joint", without=("kind", "a", "b"))
    return item._replace(given=(Given("between", (joint.a, joint.b)), *item.given))


def _cavity(one: AirBetween) -> Item:
    """Its air, its fill and its bays."""
    nouns = [noun for noun in (one, one.fill, one.bays) if noun is not None]
    found = [what for noun in nouns for what in given_fields(noun, UNITS | CAVITY) if what.what not in ("fill", "bays")]
    return Item(one.name, "cavity with wool" if one.fill else "cavity", tuple(found))


def _body(body: PlacedBody) -> Item:
    shown = {"mass", "side", "target", "speed", "dropped", "source"}
    rest = _flat(one for one in given_fields(body, UNITS) if one.what not in shown)
    fall = [Given("drop height", body.speed**2 / (2.0 * GRAVITY), "m")] if body.dropped else []
    speed = [Given("speed", body.speed, "m/s")] if body.speed else []
    first = (Given("mass", body.mass, "kg"), Given(body.side, body.target), *fall, *speed)
    return Item(body.name, body.source or "body", (*first, *rest))


def _contact(contact: PlannedContact) -> Item:
    item = _item(contact, f"{contact.law.word or _word(contact.law)} contact")
    return item._replace(given=tuple(one for one in item.given if one.what != "law"))


def _load(load: PlannedLoad) -> Item:
    unit = "Pa" if load.kind == "surface" else "N"
    found = (
        one._replace(unit=unit) if one.what in ("amplitude", "values") else one
        for one in _flat(given_fields(load, UNITS))
    )
    return Item(load.name, f"load on a {load.kind}", tuple(one for one in found if one.what != "kind"))


def _vibration(one: Vibration) -> Item:
    lasts = [] if one.duration is None else [Given("duration", one.duration, "s")]
    unit, factor = one.unit, 1.0
    if one.kind == "base" and one.what == "psd":  # as shakers are spoken of
        unit, factor = "g^2/Hz", GRAVITY**-2
    points = {f"{frequency:g} Hz": factor * value for frequency, value in one.spectrum.points}
    fields = [Given("spectrum", points, unit)]
    if len(points) > SPELT:
        lines, values = zip(*one.spectrum.points, strict=True)
        fields = [Given("spectrum", tuple(factor * value for value in values), unit), Given("at", lines, "Hz")]
    return Item(one.name, f"{one.what} at {one.place_text}", (*fields, *lasts))


def _fatigue(one: FatigueRequest) -> Item:
    """Cycles that are counted, with the S-N line in the unit of what is counted."""
    under = [Given("under", one.under)] if one.under else []
    line = []
    if one.sn is not None:
        unit = next((unit for word, unit in COUNTED.items() if word in one.of.split(" ")), "")
        size = Given("detail category" if one.sn.category else "range", one.sn.range, unit)
        line = (
            [size] if one.sn.category else [size, Given("endured", one.sn.at, "cycles"), Given("slope", one.sn.slope)]
        )
    return Item(one.name, "rainflow", (Given("of", one.of), *under, *line))


def _link(link: PlannedLink, bodies: Sequence[PlacedBody]) -> Item:
    """A link, with the frequency and damping ratio of its body while the other end is held, where it has one alone."""
    item = _item(link, "link")
    if link.closing == link.opening:
        alike = (one._replace(what="damping") if one.what == "closing" else one for one in item.given)
        item = item._replace(given=tuple(one for one in alike if one.what != "opening"))
    held = [one for one in bodies if one.name in link.between]
    if len(held) != 1 or not link.stiffness:
        return item
    critical = 2.0 * sqrt(link.stiffness * held[0].mass)
    tuned = [Given(f"frequency of {held[0].name}", sqrt(link.stiffness / held[0].mass) / (2.0 * pi), "Hz")]
    if link.closing == link.opening:
        tuned.append(Given(f"damping ratio of {held[0].name}", link.closing / critical))
    return item._replace(given=(*item.given, *tuned))


def _room(plan: RoomPlan) -> Item:
    room = plan.room
    t60 = {f"{frequency:g} Hz": seconds for frequency, seconds in plan.t60_asked.items()}
    receivers = {one.name: comparable(one.position) for one in plan.receivers}
    given_here = [Given(plan.on or "under", plan.under), *(Given(wall, name) for wall, name in plan.moved[1:])]
    given_here += [Given("reverberation time", t60, "s")] if t60 else []
    given_here += [Given("coupling", plan.coupling), *([] if plan.leak is None else given_fields(plan.leak, LEAK))]
    given_here += [Given("rated by", plan.levels)] if plan.levels else []
    air = [Given("speed of sound", room.air.c, "m/s"), Given("density of air", room.air.rho, "kg/m^3")]
    described = room.described()
    ratios: Any = described.pop("damping_ratio", {})
    given_here += [_with_unit(name, value) for name, value in described.items()]
    if ratios and not t60:
        given_here.append(Given("damping ratio", {f"{frequency} Hz": ratio for frequency, ratio in ratios.items()}))
    return Item(plan.name, room.word.removeprefix("a "), (*given_here, *air, Given("receivers", receivers, "m")))


def _with_unit(name: str, value: object) -> Given:
    """What a field says of itself, whose unit ends its name.

    >>> _with_unit("largest_cell_m", 0.5)
    Given(what='largest cell', value=0.5, unit='m')
    """
    end = next((end for end in ENDS if name.endswith(end)), "")
    return Given(name.removesuffix(end).replace("_", " "), comparable(value), ENDS.get(end, ""))


def _analysis(study: Study) -> dict[str, tuple[Given, ...]]:
    """How it is computed: damping, modes, window, peaks, accuracy."""
    damping = study.damping
    base = [
        one._replace(what=_word(damping.base)) if one.what == "value" else one
        for one in given_fields(damping.base, UNITS)
    ]
    modes = (Given(f"mode {one.number}", one.ratio or (one.loss_factor or 0.0) / 2.0) for one in damping.modes)
    start = [Given(f"start {spot}", speed, "m/s") for spot, speed in study.initial.velocities]
    return {
        "damping": (*(base or [Given("loss factor", "of the materials")]), *modes),
        "modes": given_fields(study.extent, UNITS),
        "start": (*start, *(given_fields(study.initial.rigid, UNITS) if study.initial.rigid is not None else ())),
        "window": () if study.time is None else given_fields(study.time, UNITS),
        "peaks": given_fields(study.peaks, UNITS),
        "accuracy": () if study.accuracy is None else given_fields(study.accuracy, UNITS),
    }
