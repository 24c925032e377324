"""Study: everything one simulation needs, resolved and in SI units, before anything is computed.

Names still stand for places here ("O_f", "ball"); the workflow turns them into probes once the model is meshed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from femstruct.errors import FemstructError
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

FrfKind = Literal["receptance", "mobility", "accelerance", "transmissibility", "pressure", "power"]


@dataclass(frozen=True)
class Spot:
    """A quantity with an address: a point's direction ("O_f", "z") or a force of the structure ("ground", "force").

    what : x y z rx ry rz n for a point; "force" (along z), "force_x", "force_y" or "force_z" for a spring,
    foundation, support, joint or "ground"; "pressure" for a receiver, named ROOM.RECEIVER; "power" for an open room.
    """

    name: str
    what: str

    def __str__(self) -> str:
        return f"{self.name}.{self.what}"


@dataclass(frozen=True)
class Extent:
    """How many modes: all up to a frequency [Hz], or the lowest `count`, all there are where those are fewer."""

    up_to_hz: float | None = None
    count: int | None = None


@dataclass(frozen=True)
class FrfRequest:
    """A frequency response asked for: drive, response, kind, band [Hz] and step [Hz]."""

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
    source : the standard source it is, None for any other body. radius : of a rigid sphere that is heard itself [m],
    None for a body that is not.
    """

    name: str
    mass: float
    side: Literal["above", "below", "before", "after"]
    target: str
    speed: float = 0.0
    dropped: bool = False
    law: Law | None = None
    blows: Repeat | None = None
    source: str | None = None
    radius: float | None = None


@dataclass(frozen=True)
class PlannedContact:
    """A contact between two named ends (points, bodies or ground), gap [m] and preload [N] of the rest state."""

    name: str
    between: tuple[str, str]
    law: Law
    gap: float = 0.0
    preload: float = 0.0


@dataclass(frozen=True)
class PlannedLink:
    """A spring and dashpot between two named ends; see `femstruct.impact.scene.bodies.Link`."""

    name: str
    between: tuple[str, str]
    stiffness: float = 0.0
    closing: float = 0.0
    opening: float = 0.0
    release_at: float = 0.0
    preload: float = 0.0


@dataclass(frozen=True)
class PlannedLoad:
    """A force history [N] on a point's direction or a body, or a pressure history [Pa] on a surface."""

    name: str
    on: Spot | str
    kind: Literal["point", "body", "surface"]
    history: HalfSine | Table
    repeat: Repeat = Repeat()


@dataclass(frozen=True)
class PlannedWalk:
    """Somebody who walks along places, one after the other, or stays at one; a point may have several places."""

    name: str
    along: tuple[str, ...]
    walk: Walk
    repeat: Repeat = Repeat()


@dataclass(frozen=True)
class RigidMotion:
    """A structure that starts moving as a whole: velocity [m/s] and spin [rad/s] about a named point."""

    about: str
    velocity: Vector
    spin: Vector


@dataclass(frozen=True)
class InitialMotion:
    """Start velocities of points' directions [m/s] (spread over the modes that can follow), or of the whole."""

    velocities: tuple[tuple[Spot, float], ...] = ()
    rigid: RigidMotion | None = None


@dataclass(frozen=True)
class Record:
    """A channel to keep. target : a point's direction, a force's name, a body, a contact or a link."""

    target: str
    what: Literal["displacement", "velocity", "acceleration", "force", "travel"]

    def __str__(self) -> str:
        return f"{self.target} {self.what}"


@dataclass(frozen=True)
class TimePlan:
    """Window [s], sampling [Hz], gravity, and the quiet time [s] that ends a collision."""

    duration: float
    sampling: float
    gravity: bool = False
    quiet: float = 0.0


@dataclass(frozen=True)
class PeakRule:
    """Which peaks to report: those of the first impact (its window [s], or None for until the next contact closes),
    beside those of the whole window; lowpass [Hz] is applied before, None for none."""

    first_impact: float | None = 20e-3
    lowpass_hz: float | None = None


@dataclass(frozen=True)
class AccuracyRule:
    """How far more modes may still change what is recorded: a share [1], in a band [Hz], over the first impact.

    up_to_hz : modes are added up to this frequency at most, None for what the mesh can carry.
    """

    within: float
    band: Pair
    up_to_hz: float | None = None


@dataclass(frozen=True)
class Limit:
    """What should not be exceeded: by the largest |value| of a recorded channel ("die.z displacement"), in its unit,
    by the time to rest ("settled") [s], or by the rating of a room ("bedroom rating") [dB].

    room : whose rating it is; "" for the others.
    """

    name: str
    value: float
    room: str = ""


@dataclass(frozen=True)
class RoomPlan:
    """A room under a radiating surface, or the half space beside it, and who listens there.

    under : the surface that places it. walls : further surfaces, by the wall of the room that they move.
    offset : of the surface's centre from the ceiling's centre [m], room axes.
    coupling : one-way, the air does not push back, or two-way. leak : of a room that pushes back.
    t60_asked : reverberation times that its losses were made from {frequency [Hz]: [s]}, empty for other losses.
    levels : standards by which it is rated, of `acoustics.levels.methods.STANDARDS`.
    animate : frequencies [Hz] of which a moving picture is made, None for the pulse.
    directivity : frequencies [Hz] at which the directivity of a half space is shown, the loudest if empty.
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
        """Where what is heard of a structure ends [Hz] whose modes are complete below a frequency."""
        return min(complete_below_hz, self.complete_below_hz)

    @property
    def complete_below_hz(self) -> float:
        """Where what the room knows of itself ends [Hz], infinite without an end."""
        return self.room.complete_up_to_hz


@dataclass(frozen=True)
class Study:
    """All inputs of one simulation, in SI units.

    structure, damping : the model. extent : how many modes its basis has. frf : frequency responses asked for.
    bodies, contacts, links, loads, walks, initial : what meets, and how it starts. records : histories to keep.
    time : the window, None when nothing is simulated. peaks : which peaks are reported. rooms : who listens.
    limits : what the verdicts of a case are about. save_modal : whether the modal coordinates go into the results
    file. accuracy : None to use the modes asked for.
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


@dataclass(frozen=True)
class Case:
    """One column of the comparison: a study, and what makes it differ from the file (path -> text of the value).

    drops : the same study for every place that its standard source strikes, by the place ("drops.2"); the first is
    `study`. Empty where there is one place or no source.
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
    name: YAML, and CSV of loads.

    positions : (file, line, column) of every path of the files, for messages.
    """

    title: str
    cases: tuple[Case, ...]
    baseline: str
    sources: Mapping[str, str]
    positions: Mapping[str, tuple[str, int, int]] = field(default_factory=dict)
