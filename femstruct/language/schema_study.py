"""The study file: what happens to the structure. Units become SI here; names are checked in `references`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, model_validator

from femstruct.impact.scene.walking import PACES_HZ
from femstruct.language.laws.known_laws import AnyLaw
from femstruct.language.model.directions import Dashpot, Stiffness
from femstruct.language.schema_rooms import RoomSpec
from femstruct.language.sources import SOURCES, from_source
from femstruct.language.yaml.spec import (
    Count,
    Duration,
    Flag,
    Frequency,
    Gap,
    Instant,
    Length,
    MassKg,
    Measured,
    Quantity,
    Ratio,
    Spec,
    Speed,
    Text,
    only,
    read_by,
    refuse,
)
from femstruct.study.study import FrfKind
from femstruct.units import shown_as

_Quantity = Literal["displacement", "velocity", "acceleration", "force", "travel"]
QUANTITIES = ("displacement", "velocity", "acceleration", "force", "travel")
UNTIL_NEXT = "until next contact"
Force = Annotated[float, Quantity(("force",), least=0.0)]
Preload = Annotated[float, Quantity(("force",))]
DropSpeed = Annotated[
    float,
    Quantity(
        ("speed",),
        least=0.0,
        most=1000.0,
        too_large="a plain number is in metres a second: did you mean {number:g} mm/s?",
    ),
]
DropHeight = Annotated[
    float,
    Quantity(
        ("length",),
        least=0.0,
        most=100.0,
        too_large="a plain number is in metres: did you mean {number:g} mm? For a high speed give 'speed'",
    ),
]
"""It falls without air: a ball of 10 cm and 1 kg is 10 % slower than that after 100 m."""


class ModesSpec(Spec):
    """How many modes: all up to a frequency, or the lowest ones."""

    one_of = (("up_to", "count"),)

    up_to: Frequency | None = None
    count: Count | None = None


class FrfSpec(Spec):
    """A frequency response; addresses are POINT.x, NAME.force, of kind pressure ROOM.RECEIVER.pressure, or of kind
    power, sound power over the mean square of the force, ROOM.power."""

    drive: Text
    response: Text
    kind: FrfKind
    band: tuple[Annotated[float, Quantity(("frequency",), least=0.0)], Frequency]
    step: Frequency


SIDES = ("above", "below", "before", "after")


_Source = Literal["rubber ball", "bang machine", "tapping machine"]


def _mass_or_source(schema: dict[str, Any]) -> None:
    schema["required"] = [name for name in schema["required"] if name != "mass"]


def _every_or_source(schema: dict[str, Any]) -> None:
    schema["required"] = [name for name in schema["required"] if name not in ("every", "count")]


class BlowsSpec(Spec):
    """A body that strikes several times: at first, first + every, ... it is given its starting state again. A tapping
    machine brings its own every.

    timing: of a tapping machine. uncorrelated, if left out: each hammer strikes once, a fifth of the duration after the
    one before, and levels are those of ten such blows a second whose sounds add in energy, as those of a real machine
    do; regular: `count` turns of blows exactly 0.1 s apart, to listen to, or for a machine measured to be so regular.
    """

    model_config = ConfigDict(json_schema_extra=_every_or_source)

    count: Count
    every: Duration
    first: Instant = 0.0
    timing: Literal["regular", "uncorrelated"] | None = None


class BodySpec(Spec):
    """A point mass beside a place or another body, at rest, dropped or thrown; or a standard source above a place.

    A source has its own mass, drop height and contact law; the hammers of a tapping machine have their turns in place
    of a law.
    radius: of a rigid sphere that moves with the body. Its own sound is computed in the half space on its side, and a
    hertz law without a radius uses this one.
    """

    one_of = (SIDES,)
    at_most_one_of = (("drop_height", "speed"),)
    model_config = ConfigDict(json_schema_extra=_mass_or_source)

    source: _Source | None = None
    mass: MassKg
    above: Text | None = None
    below: Text | None = None
    before: Text | None = None
    after: Text | None = None
    drop_height: DropHeight | None = None
    speed: DropSpeed | None = None
    contact: AnyLaw | None = None
    radius: Length | None = None
    blows: BlowsSpec | None = None

    @model_validator(mode="before")
    @classmethod
    def _from_source(cls, value: Any) -> Any:
        return from_source(value) if isinstance(value, dict) and value.get("source") in SOURCES else value

    @property
    def target(self) -> str:
        """What it is placed beside."""
        return self.above or self.below or self.before or self.after or ""


class ContactSpec(Spec):
    """A unilateral law between two ends; gap and preload are those of the rest state."""

    between: tuple[Text, Text]
    law: AnyLaw
    gap: Gap = 0.0
    preload: Force = 0.0


class OneWaySpec(Spec):
    """A dashpot with one constant while its ends approach and another while they move apart."""

    closing: Dashpot = 0.0
    opening: Dashpot = 0.0


def _dashpot(value: object) -> object:
    if isinstance(value, dict):
        return value
    constant = Quantity(("damping",), least=0.0).read(value)
    return {"closing": constant, "opening": constant}


class LinkSpec(Spec):
    """A spring and dashpot that both pull and push."""

    between: tuple[Text, Text]
    stiffness: Stiffness = 0.0
    damping: Annotated[OneWaySpec, read_by(_dashpot, Dashpot | OneWaySpec)] = OneWaySpec()
    release_at: Instant = 0.0
    preload: Preload = 0.0


class HalfSineSpec(Spec):
    """The first half period of a sine."""

    amplitude: Annotated[Measured, Quantity(("force", "pressure"), which=True)]
    frequency: Frequency


class WalkingSpec(Spec):
    """A walking person: mass, steps per second, number of steps, and amplitudes of the harmonics of the force over the
    weight, by default those of CCIP-016 for this pace."""

    mass: MassKg
    pace: Frequency
    steps: Count
    harmonics: Annotated[list[Ratio], Field(min_length=1, max_length=20)] | None = None

    @model_validator(mode="after")
    def _known_pace(self) -> WalkingSpec:
        if self.harmonics is None and not PACES_HZ[0] <= self.pace <= PACES_HZ[1]:
            low, high = PACES_HZ
            raise refuse(f"a pace of {self.pace:g} Hz", f"{low:g} to {high:g} Hz", "or give its 'harmonics: [..]'")
        if self.steps < 2:
            raise refuse("1 step", "2 or more: the force increases over the first and decreases over the last")
        return self


def _along(value: object) -> object:
    return tuple(value) if isinstance(value, list) and value else (value,)


class LoadSpec(Spec):
    """A force history on a point's direction or a body, or a pressure history on a surface; once or repeated. Or a
    person who walks along places. A force is positive along its direction: downwards it is negative. A file has two
    columns, time and value, separated by a comma; what comes before t = 0 is left out."""

    one_of = (("at", "body", "on", "along"), ("half_sine", "file", "walking"))
    needs = (("along", ("walking",)), ("walking", ("along",)))

    at: Text | None = None
    along: Annotated[tuple[Text, ...] | None, read_by(_along, Text | list[Text])] = None
    walking: WalkingSpec | None = None
    body: Text | None = None
    on: Text | None = None
    half_sine: HalfSineSpec | None = None
    file: Text | None = None
    first: Instant = 0.0
    every: Duration | None = None
    count: Count | None = None


Spin = Annotated[float, Quantity(("angular speed",))]


class RigidMotionSpec(Spec):
    """A structure that moves as a whole."""

    about: Text
    velocity: tuple[Speed, Speed, Speed] = (0.0, 0.0, 0.0)
    spin: tuple[Spin, Spin, Spin] = (0.0, 0.0, 0.0)


class InitialSpec(Spec):
    """Start velocities of points, or of the whole structure."""

    at_most_one_of = (("velocity", "rigid"),)

    velocity: dict[str, Annotated[Measured, Quantity(("speed", "angular speed"), which=True)]] | None = None
    rigid: RigidMotionSpec | None = None


def _recorded(value: object) -> object:
    wanted = value if isinstance(value, list) and value else [value]
    for one in wanted:
        only(QUANTITIES)(one)
    return tuple(wanted)


class TimeSpec(Spec):
    """The window, how densely it is sampled, and whether there is gravity."""

    duration: Duration
    sampling: Frequency
    gravity: Flag = False


def _first_impact(value: object) -> object:
    return None if value == UNTIL_NEXT else Quantity(("time",), above=0.0).read(value)


def _lowpass(value: object) -> object:
    return None if value == "none" else Quantity(("frequency",), above=0.0).read(value)


class PeaksSpec(Spec):
    """Which peaks are reported, and what they are filtered with."""

    first_impact: Annotated[float | None, read_by(_first_impact, Literal["until next contact"] | Duration)] = 20e-3
    lowpass: Annotated[float | None, read_by(_lowpass, Literal["none"] | Frequency)] = None


class AccuracySpec(Spec):
    """Add modes until what is recorded in a band changes by no more than a share in the first impact."""

    within: Annotated[float, Quantity(("ratio",), above=0.0, below=1.0)]
    band: tuple[Annotated[float, Quantity(("frequency",), least=0.0)], Frequency]
    up_to: Frequency | None = None


def _changes(value: object) -> object:
    """A case is checked where it is applied; here only its form."""
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise refuse(shown_as(value), "a mapping of paths to values", "write it like {bodies.damper.mass: 0.9 kg}")
    return value


LIMITED = ("length", "speed", "acceleration", "force", "time", "angle", "angular speed", "level")
LimitValue = Annotated[Measured, Quantity(LIMITED, above=0.0, which=True)]


class CompareSpec(Spec):
    """Which case the others are compared with."""

    baseline: Text


class StudySpec(Spec):
    """A study file."""

    title: Text | None = None
    model: Text
    modes: ModesSpec | None = None
    accuracy: AccuracySpec | None = None
    frf: dict[str, FrfSpec] = Field(default_factory=dict)
    bodies: dict[str, BodySpec] = Field(default_factory=dict)
    contacts: dict[str, ContactSpec] = Field(default_factory=dict)
    links: dict[str, LinkSpec] = Field(default_factory=dict)
    loads: dict[str, LoadSpec] = Field(default_factory=dict)
    initial: InitialSpec = InitialSpec()
    record: dict[str, Annotated[tuple[str, ...], read_by(_recorded, _Quantity | list[_Quantity])]] = Field(
        default_factory=dict
    )
    time: TimeSpec | None = None
    peaks: PeaksSpec = PeaksSpec()
    limits: dict[str, LimitValue] = Field(default_factory=dict)
    quiet: Instant = 0.0
    rooms: dict[str, RoomSpec] = Field(default_factory=dict)
    cases: dict[str, Annotated[dict[str, Any], read_by(_changes, dict[str, Any] | None)]] = Field(default_factory=dict)
    compare: CompareSpec | None = None
    save: Literal["modal"] | None = None
