"""Bodies as they are written."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from math import inf, pi, sqrt
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, get_args

from pydantic import ValidationInfo

from femstruct.conventions import GRAVITY
from femstruct.declared import Refers
from femstruct.errors import quote_value
from femstruct.impact.scene import (
    BANG_MACHINE,
    BETWEEN_BLOWS,
    DROPPED,
    HAMMER_DROP,
    HAMMER_MASS,
    HAMMERS,
    RUBBER_BALL,
    TAPPING_MACHINE,
    blow_scatter,
)
from femstruct.language.laws import LAW_KINDS, Ends, LawSpec, Site
from femstruct.language.not_computed import FALLING_PARTS, instead_of
from femstruct.laws.law import Law
from femstruct.quantities import (
    Dashpot,
    Duration,
    Frequency,
    Gap,
    Instant,
    Length,
    MassKg,
    Quantity,
    Ratio,
    Stiffness,
    refuse,
)
from femstruct.study.acting import BodySide, Covering, PlacedBody, PlannedContact, PlannedLink, Repeat
from femstruct.yaml.reader import Here, Names, members
from femstruct.yaml.spec import BandFile, Count, Spec, Text, any_of, brought_by_key, by_band, read_by, word_of
from femstruct.yaml.spec import Ends as EndsOfContact

if TYPE_CHECKING:
    AnyLaw = LawSpec
else:
    AnyLaw = any_of(LAW_KINDS)


# ----------------------------------------------------------------------------------------------------------------------
# Coverings below a tapping machine, as laboratories measure them.
# ----------------------------------------------------------------------------------------------------------------------

_DECIBEL = Quantity(
    ("level",),
    least=-20.0,
    most=80.0,
    too_small="what a covering takes off is positive",
    too_large="coverings reach 40 dB or so",
    words="a reduction",
)
_WORDS = ("a reduction for each band", "write it like {100 Hz: 2 dB, 125 Hz: 3 dB, ..} or {file: NAME}")
_READ = by_band(_DECIBEL, *_WORDS)


def _reduction(value: object, info: ValidationInfo) -> object:
    if not isinstance(value, dict):
        raise refuse(quote_value(value), *_WORDS)
    return _READ(value, info)


class CoveringSpec(Spec):
    """What a covering takes off the impact sound of a tapping machine, by band: Delta L, measured on a heavy reference
    floor (ISO 10140-3), or Delta L_t of a light one. It is a ratio of forces, so that floors must be alike: a study
    with the other kind of floor is refused."""

    makes = Covering
    called = (("reduction", "reduction_db"),)

    reduction: Annotated[dict[float, float], read_by(_reduction, BandFile | dict[str, Annotated[float, _DECIBEL]])]
    measured_on: Literal["heavy", "light"] = "heavy"

    def missing(self, bands: tuple[float, ...]) -> list[float]:
        """Bands that it lacks [Hz]."""
        return [band for band in bands if band not in self.reduction]


# ----------------------------------------------------------------------------------------------------------------------
# Standard sources in a study file: `source: rubber ball` is a body of the standard's mass, drop height and law.
# ----------------------------------------------------------------------------------------------------------------------

SOURCES: Final = (*DROPPED, TAPPING_MACHINE)
UNCORRELATED: Final = "uncorrelated"
SCATTERED: Final = "scattered"


def refuse_beside_source(body: Mapping[str, Any], of_blows: Collection[str]) -> None:
    """Refuse keys that a `source` brings itself, and a tapping machine without a law or whose hammers strike at given
    times.

    Parameters
    ----------
    of_blows : Collection[str]
        The keys that blows can have.
    """
    name = str(body["source"])
    tapping = name == TAPPING_MACHINE
    brought = ["mass", "drop_height", "speed", "below", "before", "after"] + ([] if tapping else ["contact"])
    given = [key for key in brought if key in body]
    if given:
        statement = (
            "is above a place" if given[0] in ("below", "before", "after") else f"has its own {_SOURCE_WORDS[given[0]]}"
        )
        raise refuse(
            f"'{given[0]}' with a {name}", f"only a source: it {statement}", f"remove '{given[0]}', or 'source'"
        )
    if tapping and "contact" not in body:
        raise refuse(
            "a tapping machine without a contact",
            "the law between its hammers and this floor",
            "add 'contact: {type: hertz, radius: 0.5 m, E: [210 GPa, ...], nu: [0.3, ...]}'",
        )
    blows = body.get("blows")
    if tapping and isinstance(blows, Mapping) and set(blows) <= set(of_blows):
        _refuse_blows(blows)


def _refuse_blows(blows: Mapping[str, Any]) -> None:
    given = [key for key in ("every", "first") if key in blows]
    if given:
        raise refuse(
            f"'blows.{given[0]}' of a tapping machine",
            f"only a count: every hammer strikes every {HAMMERS * BETWEEN_BLOWS:g} s, in turn",
            f"remove '{given[0]}'",
        )
    if blows.get("timing", UNCORRELATED) == UNCORRELATED and blows.get("count", 1) != 1:
        raise refuse(
            f"'blows.count' {blows['count']} of a tapping machine whose blows are uncorrelated",
            "no count: one blow of each hammer represents all",
            "remove 'count'; or add 'timing: regular', or scattered, for turns of blows 0.1 s apart",
        )


def from_source(body: Mapping[str, Any]) -> dict[str, Any]:
    """The keys of a body whose `source` is given, with those that the source brings; of one that is none, with those
    that any would bring, so that it is one mistake."""
    name = str(body["source"])
    if name not in SOURCES:
        turns = {"blows": _turns(body["blows"])} if "blows" in body else {}
        return {"mass": HAMMER_MASS, **body, **turns}
    if name != TAPPING_MACHINE:
        return {**body, **_dropped(name)}
    return {**body, "mass": HAMMER_MASS, "drop_height": HAMMER_DROP, "blows": _turns(body.get("blows", {}))}


def _turns(blows: Any) -> Any:
    """The blows of a hammer, with what the machine brings; as they are where they are no mapping."""
    if not isinstance(blows, Mapping):
        return blows
    return {"count": 1, "timing": UNCORRELATED, **blows, "every": HAMMERS * BETWEEN_BLOWS}


def first_blow_time(number: int, apart: float = BETWEEN_BLOWS) -> float:
    """When hammer `number`, from 1, strikes first [s].

    >>> first_blow_time(1), first_blow_time(3), first_blow_time(3, 0.4)
    (0.0, 0.2, 0.8)
    """
    return (number - 1) * apart


_SOURCE_WORDS: Final = {"mass": "mass", "drop_height": "drop height", "speed": "speed", "contact": "contact law"}


def _dropped(name: str) -> dict[str, Any]:
    pad, fist, source = RUBBER_BALL.law, BANG_MACHINE.law, DROPPED[name]
    curve = [list(pair) for pair in zip(pad.indentations.tolist(), pad.forces.tolist(), strict=True)]
    contacts = {
        "rubber ball": {"type": pad.word, "curve": curve, "dissipation": pad.dissipation, "smooth": pad.smooth},
        "bang machine": {"type": fist.word, "stiffness": fist.stiffness, "damping": fist.damping},
    }
    return {"mass": source.mass, "drop_height": source.drop_height, "contact": contacts[name]}


# ----------------------------------------------------------------------------------------------------------------------
# Bodies as they are written.
# ----------------------------------------------------------------------------------------------------------------------

SIDES: tuple[BodySide, ...] = get_args(BodySide)
FAST = "a plain number is in metres a second: did you mean {number:g} mm/s?"
HIGH = "a plain number is in metres: did you mean {number:g} mm? For a high speed give 'speed'"
Beside = Annotated[Text, Refers()]
DropSpeed = Annotated[float, Quantity(("speed",), least=0.0, most=1000.0, too_large=FAST)]
DropHeight = Annotated[float, Quantity(("length",), least=0.0, most=100.0, too_large=HIGH)]
"""It falls without air: a ball of 10 cm and 1 kg is 10 % slower than that after 100 m."""


class BlowsSpec(Spec):
    """A body that strikes several times: at first, first + every, ... it is given its starting state again. A tapping
    machine brings its own every.

    timing: of a tapping machine. uncorrelated, if left out: each hammer strikes once, a fifth of the duration after the
    one before, and levels are those of ten such blows a second whose sounds add in energy, as those of a real machine
    do; regular: `count` turns of blows exactly 0.1 s apart, to listen to, or for a machine measured to be so regular;
    scattered: `count` turns of blows that come up to 10 ms early or late, within the tolerances of ISO 10140-5, and
    alike for the same seed.
    """

    model_config = brought_by_key("every", "count")

    makes = Repeat
    count: Count
    every: Duration
    first: Instant = 0.0
    timing: Literal["regular", "uncorrelated", "scattered"] | None = None
    seed: Count | None = None

    def given(self) -> dict[str, Any]:
        late: tuple[float, ...] = ()
        if self.timing == SCATTERED:
            hammer = round(self.first / BETWEEN_BLOWS) % HAMMERS
            late = tuple(blow_scatter(self.count, self.seed or 1)[:, hammer].tolist())
        return {
            "count": self.count,
            "every": self.every,
            "first": self.first,
            "alone": self.timing == UNCORRELATED,
            "late": late,
        }


class BodySpec(Spec):
    """A point mass beside a place or another body, at rest, dropped or thrown; or a standard source above a place.

    A source has its own mass, drop height and contact law; the hammers of a tapping machine have their turns in place
    of a law.
    radius: of a rigid sphere that moves with the body. Its own sound is computed in the half space on its side, and a
    hertz law without a radius uses this one.
    """

    instead = instead_of(FALLING_PARTS, "part", "parts", "structure")
    one_of = (SIDES,)
    at_most_one_of = (("drop_height", "speed"),)
    model_config = brought_by_key("mass")

    source: Annotated[str, word_of(SOURCES)] | None = None
    mass: MassKg
    above: Beside | None = None
    below: Beside | None = None
    before: Beside | None = None
    after: Beside | None = None
    drop_height: DropHeight | None = None
    speed: DropSpeed | None = None
    contact: AnyLaw | None = None
    radius: Length | None = None
    blows: BlowsSpec | None = None
    covering: CoveringSpec | None = None

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        if given.get("source") in SOURCES:
            refuse_beside_source(given, BlowsSpec.keys())

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        return given if given.get("source") is None else from_source(given)

    @property
    def side(self) -> BodySide:
        """On which side of its target it is."""
        return next(side for side in SIDES if getattr(self, side) is not None)

    @property
    def target(self) -> str:
        """What it is placed beside."""
        return str(getattr(self, self.side))

    @property
    def start_speed(self) -> float:
        """Speed with which it starts towards its target [m/s]."""
        return sqrt(2 * GRAVITY * self.drop_height) if self.drop_height is not None else self.speed or 0.0

    def check_in(
        self, here: Here, count: int, others: Collection[str], laws: list[LawSpec], has_receivers: bool
    ) -> None:
        """Note what is wrong with it.

        Parameters
        ----------
        count : int
            How many bodies it stands for.
        others : Collection[str]
            Names of bodies and of the ground.
        laws : list[LawSpec]
            Of its contacts.
        has_receivers : bool
            Whether its own sound is computed, in open air with receivers on its side.
        """
        there = here.at(self.side)
        expected = f"a point of {HAMMERS} places, or of {HAMMERS} for each position"
        machine = self.source == TAPPING_MACHINE
        if machine and self.target in (*here.names.points, *here.names.places, *others):  # else its name is wrong
            got = f"{count} place{'s' if count > 1 else ''} for the {HAMMERS} hammers of a tapping machine"
            there.need(count == HAMMERS, got, expected, "100 mm apart, in a line")
        if here.names.points.get(self.target, 1) == 1:
            there.place(self.target, others)
        here.at("covering").need(
            machine or self.covering is None,
            "a measured reduction below a body that is no tapping machine",
            "a tapping machine: a Delta L is what a covering takes of the force of its hammers",
            "give the covering as a contact law, or as a layer of the model",
        )
        if self.blows is not None:
            there, moves = here.at("blows"), self.speed or self.drop_height
            there.need(moves, "no speed", "a body that strikes", "add 'speed:' or 'drop_height:'")
            there.at("timing").need(
                machine or not (self.blows.timing is not None),
                "a body that is no tapping machine",
                "no timing: each body strikes at its given time",
                "remove it",
            )
            there.at("seed").need(
                self.blows.seed is None or self.blows.timing == SCATTERED,
                "a seed of blows that are not scattered",
                "'timing: scattered' beside it",
                "add it, or remove 'seed'",
            )
        if self.radius is None or has_receivers or any(law.takes_radius for law in laws):
            return
        do = "remove it: the own sound of bodies that move along x is not computed"
        if self.side in ("above", "below"):
            do = f"add 'rooms.open: {{{self.side}: SURFACE, receivers: {{mic: [x, y, z]}}}}', or remove it"
        here.at("radius").wrong(
            f"a radius, and no receivers {self.side} a surface",
            "open air on the side of the body, or a hertz law without a radius",
            do,
        )

    def check_strikes(self, here: Here, joined: bool) -> None:
        """Note one that would pass through the place it moves to.

        Parameters
        ----------
        joined : bool
            Whether a contact or link names it.
        """
        here.need(
            joined or self.contact is not None or not self.start_speed,
            f"a body that moves towards '{self.target}', without a contact: it would pass through",
            "a law between it and what it strikes",
            "add 'contact: {type: hertz, stiffness: 1 MN/m^1.5}', or name it in 'contacts' or 'links'",
        )

    def build(self, name: str, law: Law | None) -> PlacedBody:
        """The body it describes.

        Parameters
        ----------
        law : Law | None
            Of its own contact, None where there is none.
        """
        blows, dropped = self.blows.noun() if self.blows is not None else None, self.drop_height is not None
        return PlacedBody(
            name,
            self.mass,
            side=self.side,
            target=self.target,
            speed=self.start_speed,
            dropped=dropped,
            law=law,
            blows=blows,
            source=self.source,
            radius=self.radius,
            covering=self.covering.noun() if self.covering is not None else None,
        )


def ends_of(bodies: Mapping[str, BodySpec], a: str, b: str) -> Ends:
    """Mass and meeting speed of two ends. The speed is that of the one body that is placed at the other end and moves
    towards it; not when the other end moves as well."""
    ends = {name: bodies[name] for name in (a, b) if name in bodies}
    masses = [body.mass for body in ends.values()]
    mass = 1.0 / sum(1.0 / one for one in masses) if masses else None
    moving = [name for name, body in ends.items() if body.start_speed]
    placed = [name for name in moving if ends[name].target == (b if name == a else a)]
    speed = ends[placed[0]].start_speed if len(moving) == len(placed) == 1 else None
    first, second = (inf if name not in ends else ends[name].radius for name in (a, b))
    if first is None or second is None or min(first, second) == inf:
        return Ends(mass, speed, None)
    return Ends(mass, speed, (first, second))


def law_of(spec: LawSpec, ends: Ends, here: Here, sources: dict[str, str]) -> Law | None:
    """The contact law of a spec that stands here; None with a mistake noted.

    Parameters
    ----------
    sources : dict[str, str]
        Is given the texts of the files that the law names, by their names.
    """
    return here.make(lambda: spec.law(Site(ends, here, sources)))


# ----------------------------------------------------------------------------------------------------------------------
# Arrays of bodies: a body at a point of several places is one body each, with its contacts and links.
#
# A standard source is one body, whose places are struck one after the other: one simulation for each.
# ----------------------------------------------------------------------------------------------------------------------


def array_sizes(bodies: Mapping[str, BodySpec], names: Names) -> dict[str, int]:
    """How many each body of an array is: at a point of several places, or on another array; a tapping machine's
    hammers are five at whatever multiple of five places."""
    sizes: dict[str, int] = {}
    for _ in bodies:  # each round finds what lies on what the last one found
        for name, body in bodies.items():
            count = sizes.get(body.target, names.points.get(body.target, 1))
            if body.source == TAPPING_MACHINE and not count % HAMMERS:
                count = HAMMERS
            if count > 1 and not (body.source in DROPPED and body.target in names.points):
                sizes[name] = count
    return sizes


def drop_counts(bodies: Mapping[str, BodySpec], names: Names) -> dict[str, int]:
    """How many places each standard source of several is to strike: those of a point, five for a tapping machine."""
    at_once = dict.fromkeys(DROPPED, 1) | {TAPPING_MACHINE: HAMMERS}
    sources = {name: body for name, body in bodies.items() if body.source in at_once}
    counts = {name: names.points.get(one.target, 1) // at_once[one.source or ""] for name, one in sources.items()}
    return {name: count for name, count in counts.items() if count > 1}


def array_size_of(ends: tuple[str, str], sizes: Mapping[str, int], names: Names) -> list[int]:
    """How many places each end stands for: [] unless an array of bodies is one of them."""
    if not any(end in sizes for end in ends):
        return []
    return [sizes.get(end, names.points.get(end, 1)) for end in ends]


def bodies_of(sizes: Mapping[str, int]) -> list[str]:
    """The names of all bodies of arrays.

    >>> bodies_of({"damper": 2})
    ['damper.1', 'damper.2']
    """
    return [one for name, size in sizes.items() for one in members(name, size)]


# ----------------------------------------------------------------------------------------------------------------------
# Contacts as they are written: a law between two ends.
# ----------------------------------------------------------------------------------------------------------------------


class BetweenSpec(Spec):
    """What acts between two ends: points, bodies or the ground."""

    between: EndsOfContact

    def check_ends(self, here: Here, sizes: Mapping[str, int], ends: Collection[str]) -> None:
        """Note what its ends are not.

        Parameters
        ----------
        sizes : Mapping[str, int]
            Of arrays of bodies.
        ends : Collection[str]
            Names of bodies and the ground.
        """
        counts, there = array_size_of(self.between, sizes, here.names), here.at("between")
        there.need(
            len({count for count in counts if count > 1}) <= 1,
            " and ".join(f"{count} {end}" for count, end in zip(counts, self.between, strict=False)),
            "as many of both, or one",
            "name one of them, as NAME.1",
        )
        for number, end in enumerate(self.between):
            if not counts or counts[number] == 1:
                there.at(number).place(end, ends)
        there.need(self.between[0] != self.between[1], f"'{self.between[0]}' twice", "two different ends")


class ContactSpec(BetweenSpec):
    """A unilateral law between two ends.

    gap: opening at t = 0. preload: force that the contact has at rest; what presses it there, such as a spring or a
    screw, is in balance with it and is left out: a link needs no preload for it.
    """

    law: AnyLaw
    gap: Gap = 0.0
    preload: Annotated[float, Quantity(("force",), least=0.0)] = 0.0

    def check_in(self, here: Here, with_blows: Collection[str]) -> None:
        """Note keys that do not agree.

        Parameters
        ----------
        with_blows : Collection[str]
            Bodies that are lifted off at every blow.
        """
        here.need(
            not (self.gap and self.preload),
            f"a gap of {self.gap:g} m and a preload of {self.preload:g} N",
            "one of them",
            "a preloaded contact is closed: remove the gap",
        )
        held = [end for end in self.between if end in with_blows] if self.preload else []
        here.at("preload").need(
            not held,
            f"a preload on '{''.join(held[:1])}', which is lifted off at every blow",
            "none",
            "remove it, or the blows",
        )

    def build(
        self, here: Here, name: str, bodies: Mapping[str, BodySpec], sources: dict[str, str]
    ) -> PlannedContact | None:
        """The contact it describes; None with a mistake noted.

        Parameters
        ----------
        sources : dict[str, str]
            See `law_of`.
        """
        law = law_of(self.law, ends_of(bodies, *self.between), here.at("law"), sources)
        if law is None:
            return None
        if self.preload:
            law.indentation(self.preload)  # a table may end below it
        return PlannedContact(name, self.between, law, self.gap, self.preload)


def check_contacts(here: Here, contacts: Mapping[str, ContactSpec], bodies: Mapping[str, BodySpec]) -> None:
    """A body that owns its contact agrees with the named one between the same ends; so do two named ones."""
    by_ends: dict[frozenset[str], str] = {}
    for name, contact in contacts.items():
        first = by_ends.setdefault(frozenset(contact.between), name)
        here.at("contacts", name).need(
            first == name or contacts[first].gap != contact.gap,
            f"a second contact between {' and '.join(contact.between)} (the first is '{first}')",
            "one contact, or another gap",
            "remove one",
            of_key=True,
        )
    for name, body in bodies.items():
        own, named = f"{name} on {body.target}", by_ends.get(frozenset((name, body.target)))
        if body.contact is None:
            continue
        here.at("bodies", name).at("contact").need(
            named is None or contacts[named].law == body.contact,
            f"a contact that disagrees with 'contacts.{named}' between the same ends",
            "one contact, or two that agree",
            "remove one of them",
            of_key=True,
        )
        here.at("contacts", own).need(
            named is not None or own not in contacts,
            "the name of a body's own contact",
            "another name",
            "rename it",
            of_key=True,
        )


# ----------------------------------------------------------------------------------------------------------------------
# Links as they are written: a spring and dashpot between two ends.
# ----------------------------------------------------------------------------------------------------------------------


class OneWaySpec(Spec):
    """A dashpot with one constant while its ends approach and another while they move apart."""

    closing: Dashpot = 0.0
    opening: Dashpot = 0.0


def _dashpot(value: object) -> object:
    constant = value if isinstance(value, dict) else Quantity(("damping",), least=0.0).read(value)
    return constant if isinstance(value, dict) else {"closing": constant, "opening": constant}


class LinkSpec(BetweenSpec):
    """A spring and dashpot that both pull and push.

    frequency, ratio: in place of stiffness and damping, the natural frequency and damping ratio of its body when the
    other end is held, as tuned dampers are given: k = m (2 pi f)^2, c = 2 ratio sqrt(k m).
    A link has no force at t = 0, or at release_at: what it carries at rest, such as weight, is in balance and left out.
    preload: a force that is not in balance then and pushes the ends apart, as that of a spring that is released. Of a
    spring that holds a contact closed the force is the preload of the contact alone: both act.
    """

    at_most_one_of = (("stiffness", "frequency"), ("damping", "ratio"))

    makes = PlannedLink
    only_written = ("frequency", "ratio", "damping")
    stiffness: Stiffness = 0.0
    frequency: Frequency | None = None
    ratio: Ratio | None = None
    damping: Annotated[OneWaySpec, read_by(_dashpot, Dashpot | OneWaySpec)] = OneWaySpec()
    release_at: Instant = 0.0
    preload: Annotated[float, Quantity(("force",))] = 0.0

    def given(self) -> dict[str, Any]:
        return {**super().given(), **self.damping.noun()}

    def build(self, name: str, bodies: Mapping[str, BodySpec]) -> PlannedLink:
        """The link it describes, tuned to its body."""
        link: PlannedLink = self.noun(name=name)
        if self.frequency is None and self.ratio is None:
            return link
        mass = next(bodies[end].mass for end in self.between if end in bodies)
        stiffness = mass * (2.0 * pi * self.frequency) ** 2 if self.frequency is not None else self.stiffness
        if self.ratio is None:
            return replace(link, stiffness=stiffness)
        damping = 2.0 * self.ratio * sqrt(stiffness * mass)
        return replace(link, stiffness=stiffness, closing=damping, opening=damping)

    def check_in(self, here: Here, with_blows: Collection[str]) -> None:
        """Note a link of nothing, and one to a body that is lifted off at every blow (struck)."""
        here.need(
            self.stiffness or self.frequency or self.damping.closing or self.damping.opening or self.preload,
            "no stiffness and no damping" if self.ratio is None else "a damping ratio without stiffness or frequency",
            "one of them" if self.ratio is None else "'frequency' or 'stiffness' beside 'ratio'",
            of_key=True,
        )
        for number, end in enumerate(self.between):
            here.at("between", number).need(
                end not in with_blows,
                f"'{end}', which is lifted off at every blow",
                "a body without blows",
                "remove one of them",
            )

    def check_tuned(self, here: Here, bodies: Collection[str]) -> None:
        """Note a frequency or ratio of a link that does not hold one body alone."""
        held = [end for end in self.between if end in bodies]
        for word in ("frequency", "ratio"):
            here.at(word).need(
                getattr(self, word) is None or len(held) == 1,
                f"a {word} of a link between {'two bodies' if held else 'two places'}",
                "one body, at one end: they are those of this body while the other end is held",
                "give 'stiffness' and 'damping'",
                of_key=True,
            )
