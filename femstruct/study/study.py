"""Study: everything one simulation needs, resolved and in SI units, before anything is computed.

Names still stand for places here ("O_f", "ball"); the workflow turns them into probes once the model is meshed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal, get_args

from femstruct.errors import FemstructError, InputError
from femstruct.modal.damping import Damping
from femstruct.model.region import Pair, Vector
from femstruct.study.structures import StructureModel

if TYPE_CHECKING:  # a model's modes need none of these
    from acoustics.fields.sound_field import SoundField
    from acoustics.receivers import Receiver
    from acoustics.rooms.box_two_way import Leak
    from femstruct.impact.laws.law import Law
    from femstruct.impact.scene.bodies import HalfSine, Table
    from femstruct.impact.scene.walking import Walk

SETTLED: Final = "settled"  # the limit of the time to rest
FrfKind = Literal["receptance", "mobility", "accelerance", "transmissibility", "pressure", "power"]
BodySide = Literal["above", "below", "before", "after"]
RecordedQuantity = Literal["displacement", "velocity", "acceleration", "force", "travel"]


@dataclass(frozen=True)
class Spot:
    """A quantity with an address: a point's direction ("O_f", "z") or a force of the structure ("ground", "force").

    what : x y z rx ry rz n for a point; "force" (along z), "force_x", "force_y" or "force_z" for a spring,
    foundation, support, joint or "ground"; "pressure" for a receiver, named ROOM.RECEIVER; "power" for an open room.

    >>> str(Spot("middle", "z")), str(Spot("ground", "force")), str(Spot("room.bed", "pressure"))
    ('middle.z', 'ground.force', 'room.bed.pressure')
    """

    name: str
    what: str

    def __str__(self) -> str:
        return f"{self.name}.{self.what}"


@dataclass(frozen=True)
class Extent:
    """How many modes: all up to a frequency [Hz], or the lowest `count`, all there are where those are fewer.

    >>> Extent(up_to_hz=3000.0), Extent(count=20)
    (Extent(up_to_hz=3000.0, count=None), Extent(up_to_hz=None, count=20))
    """

    up_to_hz: float | None = None
    count: int | None = None


@dataclass(frozen=True)
class FrfRequest:
    """A frequency response asked for: drive, response, kind, band [Hz] and step [Hz].

    The mobility at the middle of a floor from 1 to 500 Hz:

    >>> middle = Spot("middle", "z")
    >>> FrfRequest("at the middle", middle, middle, "mobility", band=(1.0, 500.0), step=0.25).kind
    'mobility'
    """

    name: str
    drive: Spot
    response: Spot
    kind: FrfKind
    band: Pair
    step: float


@dataclass(frozen=True)
class Repeat:
    """When something comes: `count` times, at first, first + every, first + 2 every, ... [s].

    alone : whether blows of a machine are far enough apart for each to be a sound of its own.

    Ten blows a second, as those of a tapping machine, for a second:

    >>> Repeat(count=10, every=0.1).every
    0.1
    """

    count: int = 1
    every: float = 0.0
    first: float = 0.0
    alone: bool = False


@dataclass(frozen=True)
class PlacedBody:
    """A body where the study puts it: mass [kg], on which side of what, moving towards it with `speed` [m/s].

    speed is sqrt(2 g h) of a drop height h; `dropped` says that it falls (its weight acts when there is gravity).
    law : of its own contact, None where a named contact or nothing joins them.
    blows : when it is given this start again; None for a body that strikes once. See
    `femstruct.impact.scene.bodies.Blows`.
    source : the standard source it is, None for any other body. radius : of a rigid sphere with own sound [m], None for
    a body without.

    A ball of 54 g that is dropped from 0.23 m on a point, with its own contact:

    >>> from femstruct import Hertz
    >>> ball = PlacedBody("ball", 0.054, "above", "middle", (2 * 9.80665 * 0.23) ** 0.5, dropped=True, law=Hertz(3.7e5))
    >>> round(ball.speed, 3)
    2.124
    """

    name: str
    mass: float
    side: BodySide
    target: str
    speed: float = 0.0
    dropped: bool = False
    law: Law | None = None
    blows: Repeat | None = None
    source: str | None = None
    radius: float | None = None


@dataclass(frozen=True)
class PlannedContact:
    """A contact between two named ends (points, bodies or ground), gap [m] and preload [N] of the rest state.

    A damper that hangs 2 mm below the middle of a floor:

    >>> from femstruct import Linear
    >>> PlannedContact("stop", ("middle", "damper"), Linear(1e6, damping=40.0), gap=2e-3).gap
    0.002
    """

    name: str
    between: tuple[str, str]
    law: Law
    gap: float = 0.0
    preload: float = 0.0


@dataclass(frozen=True)
class PlannedLink:
    """A spring and dashpot between two named ends; see `femstruct.impact.scene.bodies.Link`.

    A damper on a soft spring, with a dashpot that brakes only while both part:

    >>> PlannedLink("hanger", ("damper", "slab"), stiffness=507.0, opening=40.0).closing
    0.0
    """

    name: str
    between: tuple[str, str]
    stiffness: float = 0.0
    closing: float = 0.0
    opening: float = 0.0
    release_at: float = 0.0
    preload: float = 0.0


@dataclass(frozen=True)
class PlannedLoad:
    """A force history [N] on a point's direction or a body, or a pressure history [Pa] on a surface.

    A half sine of 300 N over 8 ms on a point, downwards:

    >>> from femstruct import HalfSine
    >>> PlannedLoad("kick", Spot("middle", "z"), "point", HalfSine(-300.0, frequency=62.5)).kind
    'point'
    """

    name: str
    on: Spot | str
    kind: Literal["point", "body", "surface"]
    history: HalfSine | Table
    repeat: Repeat = Repeat()


@dataclass(frozen=True)
class PlannedWalk:
    """A person who walks along places, one after the other, or stays at one; a point may have several places.

    A person of 80 kg who stays at one place, eight steps at two a second:

    >>> from femstruct import Walk
    >>> from femstruct.impact.scene.walking import design_harmonics
    >>> PlannedWalk("neighbour", ("middle",), Walk(80.0, pace=2.0, steps=8, harmonics=design_harmonics(2.0))).walk.steps
    8
    """

    name: str
    along: tuple[str, ...]
    walk: Walk
    repeat: Repeat = Repeat()


@dataclass(frozen=True)
class RigidMotion:
    """A structure that starts moving as a whole: velocity [m/s] and spin [rad/s] about a named point.

    A hull that falls on the water with 3 m/s, without a spin:

    >>> RigidMotion("keel", velocity=(0.0, 0.0, -3.0), spin=(0.0, 0.0, 0.0)).velocity[2]
    -3.0
    """

    about: str
    velocity: Vector
    spin: Vector


@dataclass(frozen=True)
class InitialMotion:
    """Start velocities of points' directions [m/s] (spread over the modes that can follow), or of the whole.

    A plate whose middle starts upwards with 0.1 m/s:

    >>> InitialMotion(velocities=((Spot("middle", "z"), 0.1),)).rigid is None
    True
    """

    velocities: tuple[tuple[Spot, float], ...] = ()
    rigid: RigidMotion | None = None


@dataclass(frozen=True)
class Record:
    """A channel to keep. target : a point's direction, a force's name, a body, a contact or a link.

    >>> str(Record("middle.z", "velocity")), str(Record("ball on middle", "force"))
    ('middle.z velocity', 'ball on middle force')
    """

    target: str
    what: RecordedQuantity

    def __str__(self) -> str:
        return f"{self.target} {self.what}"


@dataclass(frozen=True)
class TimePlan:
    """Window [s], sampling [Hz], gravity, and the quiet time [s] that ends a collision.

    >>> TimePlan(duration=2.0, sampling=48e3, gravity=True).quiet
    0.0
    """

    duration: float
    sampling: float
    gravity: bool = False
    quiet: float = 0.0


@dataclass(frozen=True)
class PeakRule:
    """Which peaks to report: those of the first impact (its window [s], or None for until the next contact closes),
    beside those of the whole window; lowpass [Hz] is applied before, None for none.

    The peaks of the first 20 ms, under 5 kHz:

    >>> PeakRule(first_impact=20e-3, lowpass_hz=5e3).lowpass_hz
    5000.0
    """

    first_impact: float | None = 20e-3
    lowpass_hz: float | None = None


@dataclass(frozen=True)
class AccuracyRule:
    """How far more modes may still change what is recorded: a share [1], in a band [Hz], over the first impact.

    up_to_hz : modes are added up to this frequency at most, None for what the mesh can carry.

    Velocities below 500 Hz to 1 %:

    >>> AccuracyRule(within=0.01, band=(0.0, 500.0)).up_to_hz is None
    True
    """

    within: float
    band: Pair
    up_to_hz: float | None = None


@dataclass(frozen=True)
class Limit:
    """What should not be exceeded: by the largest |value| of a recorded channel ("die.z displacement"), in its unit,
    by the time to rest ("settled") [s], or by the rating of a room ("bedroom rating") [dB].

    room : whose rating it is; "" for the others.

    At most 600 kN on the ground, at rest within a second, and 58 dB in a bedroom:

    >>> limits = Limit("ground force", 600e3), Limit("settled", 1.0), Limit("bedroom rating", 58.0, room="bedroom")
    >>> [limit.room for limit in limits]
    ['', '', 'bedroom']
    """

    name: str
    value: float
    room: str = ""


@dataclass(frozen=True)
class RoomPlan:
    """A room under a radiating surface, or the half space beside it, and its receivers.

    under : the surface that places it. walls : further surfaces, by the wall of the room that they move.
    offset : of the surface's centre from the ceiling's centre [m], room axes.
    coupling : one-way, the air does not react on the structure, or two-way. leak : of a two-way room.
    t60_asked : reverberation times that its losses were made from {frequency [Hz]: [s]}, empty for other losses.
    levels : standards by which it is rated, of `acoustics.levels.methods.STANDARDS`.
    animate : frequencies [Hz] of which a moving picture is made, None for the pulse.
    directivity : frequencies [Hz] at which the directivity of a half space is shown, the loudest if empty.

    A bedroom below a floor, with a bed in it:

    >>> from acoustics.fields.rectangular import Room
    >>> from acoustics.receivers import Receiver
    >>> bed = Receiver("bed", [1.0, 1.0, 0.5])
    >>> RoomPlan("bedroom", Room([4.0, 3.5, 2.4]), under="ceiling", receivers=(bed,)).complete_below_hz
    inf
    """

    name: str
    room: SoundField
    under: str
    receivers: tuple[Receiver, ...]
    offset: Pair = (0.0, 0.0)
    coupling: Literal["one-way", "two-way"] = "one-way"
    leak: Leak | None = None
    t60_asked: Mapping[float, float] = field(default_factory=dict)
    levels: tuple[str, ...] = ()
    animate: tuple[float | None, ...] = ()
    directivity: tuple[float, ...] = ()
    walls: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.coupling == "two-way" and not self.room.pushes_back:
            raise FemstructError(
                f"rooms.{self.name}.coupling", got=f"two-way with {self.room.word}", expected="one-way"
            )

    def heard_to_hz(self, complete_below_hz: float) -> float:
        """Where the sound of a structure ends [Hz] whose modes are complete below a frequency."""
        return min(complete_below_hz, self.complete_below_hz)

    @property
    def complete_below_hz(self) -> float:
        """Where what the room knows of itself ends [Hz], infinite without an end."""
        return self.room.complete_up_to_hz


@dataclass(frozen=True)
class Study:
    """All inputs of one simulation, in SI units.

    structure, damping : the model. extent : how many modes its basis has. frf : frequency responses asked for.
    bodies, contacts, links, loads, walks, initial : what takes part, its initial state. records : histories to keep.
    time : the window, None when nothing is simulated. peaks : which peaks are reported. rooms : with their receivers.
    limits : what the verdicts of a case are about. save_modal : whether the modal coordinates go into the results
    file. accuracy : None to use the modes asked for.

    A ball of 50 g strikes the middle of a steel plate with 1 m/s. What the run found is in `cases` of its result: the
    modes, the histories and, of every contact, the largest force [N] and when it first opens [ms here]. A rigid plate
    would give 300 N:

    >>> import femstruct as fs
    >>> steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> plate = fs.Plate("plate", steel, 0.005, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=0.1)
    >>> structure = fs.Structure(
    ...     "a plate",
    ...     (plate,),
    ...     points=(fs.PlaceOn("middle", "plate", at=((0.25, 0.2),)),),
    ...     supports=(fs.Support("edges", "simple", on="plate", edge="all"),),
    ... )
    >>> study = Study(
    ...     "a ball on a plate",
    ...     structure,
    ...     fs.Damping(fs.Ratio(0.01)),
    ...     Extent(up_to_hz=2000.0),
    ...     bodies=(PlacedBody("ball", 0.05, "above", "middle", speed=1.0, law=fs.Hertz(1e8)),),
    ...     records=(Record("middle.z", "velocity"),),
    ...     time=TimePlan(duration=0.02, sampling=20e3),
    ... )
    >>> found = fs.run_study(Plan("a ball on a plate", (Case("as given", study),), baseline="as given"))
    >>> contact = found.cases["as given"].response.contacts["ball on middle"]
    >>> round(contact.peak_force), round(1e3 * contact.first_open, 2)
    (276, 0.62)
    """

    title: str
    structure: StructureModel
    damping: Damping
    extent: Extent
    frf: tuple[FrfRequest, ...] = ()
    bodies: tuple[PlacedBody, ...] = ()
    contacts: tuple[PlannedContact, ...] = ()
    links: tuple[PlannedLink, ...] = ()
    loads: tuple[PlannedLoad, ...] = ()
    walks: tuple[PlannedWalk, ...] = ()
    initial: InitialMotion = InitialMotion()
    records: tuple[Record, ...] = ()
    time: TimePlan | None = None
    peaks: PeakRule = PeakRule()
    rooms: tuple[RoomPlan, ...] = ()
    limits: tuple[Limit, ...] = ()
    save_modal: bool = False
    accuracy: AccuracyRule | None = None

    def __post_init__(self) -> None:
        for key, kind in (("structure", StructureModel), ("damping", Damping), ("extent", Extent)):
            if not isinstance(value := getattr(self, key), kind):
                names = " or ".join(one.__name__ for one in get_args(kind) or (kind,))
                raise InputError(f"study.{key}", got=f"{value!r}", expected=names)


@dataclass(frozen=True)
class Case:
    """One column of the comparison: a study, and what makes it differ from the file (path -> text of the value).

    drops : the same study for every place that its standard source strikes, by the place ("drops.2"); the first is
    `study`. Empty where there is one place or no source.

    >>> import femstruct as fs
    >>> ball = PlacedBody("ball", 0.1, "above", "ground")
    >>> study = Study("a fall", fs.NoStructure(), fs.Damping(), Extent(), bodies=(ball,))
    >>> Case("as given", study).studies == (study,)
    True
    """

    name: str
    study: Study
    changes: Mapping[str, str] = field(default_factory=dict)
    drops: Mapping[str, Study] = field(default_factory=dict)

    @property
    def studies(self) -> tuple[Study, ...]:
        """The studies to simulate, one for every drop."""
        return tuple(self.drops.values()) or (self.study,)


@dataclass(frozen=True)
class Plan:
    """A study file, read: its cases in order, which one is the baseline, and its files verbatim by
    name: YAML, and CSV of loads; none of a plan made in Python.

    positions : (file, line, column) of every path of the files, for messages.

    Two cases of a fall on the ground, with a ball of twice the mass in the second; `Study` has a whole one:

    >>> from dataclasses import replace
    >>> import femstruct as fs
    >>> ball = PlacedBody("ball", 0.1, "above", "ground", speed=2.0, law=fs.Linear(1e5))
    >>> light = Study("a fall", fs.NoStructure(), fs.Damping(), Extent(), bodies=(ball,), time=TimePlan(0.02, 50e3))
    >>> heavy = replace(light, bodies=(replace(ball, mass=0.2),))
    >>> plan = Plan("two falls", (Case("light", light), Case("heavy", heavy)), baseline="light")
    >>> contacts = [case.response.contacts["ball on ground"] for case in fs.run_study(plan).cases.values()]
    >>> [round(1e3 * contact.first_open, 4) for contact in contacts]  # pi sqrt(m / k) [ms]
    [3.1416, 4.4429]
    """

    title: str
    cases: tuple[Case, ...]
    baseline: str
    sources: Mapping[str, str] = field(default_factory=dict)
    positions: Mapping[str, tuple[str, int, int]] = field(default_factory=dict)
