"""Bodies as they are written."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from math import inf, sqrt
from typing import Annotated, Any, Literal, get_args

from femstruct.conventions import GRAVITY
from femstruct.impact.laws.law import Law
from femstruct.impact.scene.impact_sources import BETWEEN_BLOWS, HAMMERS, TAPPING_MACHINE, scattered
from femstruct.language.laws.known_laws import AnyLaw
from femstruct.language.laws.law import Ends, LawSpec, Site
from femstruct.language.not_computed import FALLING_PARTS, instead_of
from femstruct.language.study.sources.covering import CoveringSpec
from femstruct.language.study.sources.standard_source import (
    SCATTERED,
    SOURCES,
    UNCORRELATED,
    from_source,
    refuse_beside_source,
)
from femstruct.language.yaml import (
    Count,
    Duration,
    Here,
    Instant,
    Length,
    MassKg,
    Quantity,
    Refers,
    Spec,
    Text,
    brought,
    word_of,
)
from femstruct.study.acting import BodySide, PlacedBody, Repeat

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

    model_config = brought("every", "count")

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
            late = tuple(scattered(self.count, self.seed or 1)[:, hammer].tolist())
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
    model_config = brought("mass")

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

    def check_in(self, here: Here, count: int, others: Collection[str], laws: list[LawSpec], heard: bool) -> None:
        """Note what is wrong with it.

        count : how many bodies it stands for. others : names of bodies and of the ground. laws : of its contacts.
        heard : whether its own sound is computed, in open air with receivers on its side.
        """
        there = here.at(self.side)
        expected = f"a point of {HAMMERS} places, or of {HAMMERS} for each position"
        machine = self.source == TAPPING_MACHINE
        if machine and self.target in (*here.names.points, *here.names.places, *others):  # else its name is wrong
            told = f"{count} place{'s' if count > 1 else ''} for the {HAMMERS} hammers of a tapping machine"
            there.need(count == HAMMERS, told, expected, "100 mm apart, in a line")
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
        if self.radius is None or heard or any(law.takes_radius for law in laws):
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
        """Note one that would pass through the place it moves to; joined : whether a contact or link names it."""
        here.need(
            joined or self.contact is not None or not self.start_speed,
            f"a body that moves towards '{self.target}', without a contact: it would pass through",
            "a law between it and what it strikes",
            "add 'contact: {type: hertz, stiffness: 1 MN/m^1.5}', or name it in 'contacts' or 'links'",
        )

    def build(self, name: str, law: Law | None) -> PlacedBody:
        """The body it describes; law : of its own contact, None where there is none."""
        blows, dropped = self.blows.noun() if self.blows is not None else None, self.drop_height is not None
        return PlacedBody(
            name,
            self.mass,
            self.side,
            self.target,
            self.start_speed,
            dropped,
            law,
            blows,
            self.source,
            self.radius,
            self.covering.noun() if self.covering is not None else None,
        )


def ends_of(bodies: Mapping[str, BodySpec], a: str, b: str) -> Ends:
    """Mass and meeting speed of two ends. The speed is that of the one body that is placed at the other end and moves
    towards it; not when the other end moves as well."""
    meeting = {name: bodies[name] for name in (a, b) if name in bodies}
    masses = [body.mass for body in meeting.values()]
    mass = 1.0 / sum(1.0 / one for one in masses) if masses else None
    moving = [name for name, body in meeting.items() if body.start_speed]
    placed = [name for name in moving if meeting[name].target == (b if name == a else a)]
    speed = meeting[placed[0]].start_speed if len(moving) == len(placed) == 1 else None
    first, second = (inf if name not in meeting else meeting[name].radius for name in (a, b))
    if first is None or second is None or min(first, second) == inf:
        return Ends(mass, speed, None)
    return Ends(mass, speed, (first, second))


def law_of(spec: LawSpec, ends: Ends, here: Here, sources: dict[str, str]) -> Law | None:
    """The contact law of a spec that stands here; None with a mistake noted.

    sources : is given the texts of the files that the law names, by their names.
    """
    return here.make(lambda: spec.law(Site(ends, here, sources)))
