"""What is asked of a study: modes, frequency responses, records, time, limits, rooms and who listens in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from femstruct.declared import NotNegative, Positive, checked
from femstruct.errors import InputError
from femstruct.model.region import Pair
from femstruct.tags import stored_as

if TYPE_CHECKING:  # a model's modes need none of these
    from acoustics.fields.sound_field import SoundField
    from acoustics.receivers import Receiver
    from acoustics.rooms.box_two_way import Leak

FEWEST_ROOMS: Final = 3  # whose spread means something
VOLUME_VELOCITY: Final = "volume_velocity"  # of a point source in a room
SETTLED: Final = "settled"  # the limit of the time to rest
FrfKind = Literal["receptance", "mobility", "accelerance", "transmissibility", "pressure", "power"]
RecordedQuantity = Literal["displacement", "velocity", "acceleration", "force", "travel", "stress"]


@stored_as("spot/1")
@dataclass(frozen=True)
@checked("spot")
class Spot:
    """A quantity with an address: a point's direction ("O_f", "z") or a force of the structure ("ground", "force").

    what : x y z rx ry rz n for a point; "force" (along z), "force_x", "force_y" or "force_z" for a spring,
    foundation, support, joint or "ground"; "pressure" for a receiver, named ROOM.RECEIVER; "power" for an open room; as
    a drive, "volume_velocity" for a point source at a receiver's place.

    >>> str(Spot("middle", "z")), str(Spot("ground", "force")), str(Spot("room.bed", "pressure"))
    ('middle.z', 'ground.force', 'room.bed.pressure')
    """

    name: str
    what: str

    def __str__(self) -> str:
        return f"{self.name}.{self.what}"


@stored_as("extent of the modes/1")
@dataclass(frozen=True)
@checked("modes")
class Extent:
    """How many modes: all up to a frequency [Hz], or the lowest `count`, all there are where those are fewer.

    >>> Extent(up_to_hz=3000.0), Extent(count=20)
    (Extent(up_to_hz=3000.0, count=None), Extent(up_to_hz=None, count=20))
    """

    up_to_hz: float | None = None
    count: int | None = None


@stored_as("frequency response request/1")
@dataclass(frozen=True)
@checked("frf")
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
    step: Positive

    def __post_init__(self) -> None:
        _refuse_unless_rising(f"frf.{self.name}.band", self.band)

    @property
    def of_room(self) -> bool:
        """Whether a receiver or a source in a room is one of its ends."""
        return self.kind in ("pressure", "power") or self.drive.what == VOLUME_VELOCITY


@stored_as("record/1")
@dataclass(frozen=True)
@checked("record")
class Record:
    """A channel to keep. target : a point's direction, a force's name, a body, a contact or a link; of a stress, the
    largest anywhere in a part, the part.

    >>> str(Record("middle.z", "velocity")), str(Record("ball on middle", "force"))
    ('middle.z velocity', 'ball on middle force')
    """

    target: str
    what: RecordedQuantity

    def __str__(self) -> str:
        return f"{self.target} {self.what}"


@stored_as("time plan/1")
@dataclass(frozen=True)
@checked("time")
class TimePlan:
    """Window [s], sampling [Hz], gravity, and the quiet time [s] that ends a collision.

    >>> TimePlan(duration=2.0, sampling=48e3, gravity=True).quiet
    0.0
    """

    duration: Positive
    sampling: Positive
    gravity: bool = False
    quiet: NotNegative = 0.0


@stored_as("peak rule/1")
@dataclass(frozen=True)
@checked("peaks")
class PeakRule:
    """Which peaks to report: those of the first impact (its window [s], or None for until the next contact closes),
    beside those of the whole window; lowpass [Hz] is applied before, None for none, but never to forces of contacts.

    The peaks of the first 20 ms, under 5 kHz:

    >>> PeakRule(first_impact=20e-3, lowpass_hz=5e3).lowpass_hz
    5000.0
    """

    first_impact: Positive | None = 20e-3
    lowpass_hz: Positive | None = None


@stored_as("accuracy rule/1")
@dataclass(frozen=True)
@checked("accuracy")
class AccuracyRule:
    """How far more modes may still change what is recorded: a share [1], in a band [Hz], over the first impact.

    up_to_hz : modes are added up to this frequency at most, None for what the mesh can carry.

    Velocities below 500 Hz to 1 %:

    >>> AccuracyRule(within=0.01, band=(0.0, 500.0)).up_to_hz is None
    True
    """

    within: Positive
    band: Pair
    up_to_hz: Positive | None = None

    def __post_init__(self) -> None:
        _refuse_unless_rising("accuracy.band", self.band)


@stored_as("limit/1")
@dataclass(frozen=True)
@checked("limits")
class Limit:
    """What should not be exceeded: by the largest |value| of a recorded channel ("die.z displacement"), in its unit,
    by the time to rest ("settled") [s], by the rating of a room ("bedroom rating") [dB], or by the force on the ground
    with the weight of all that stands there ("ground force with weight") [N].

    room : whose rating it is; "" for the others.

    At most 600 kN on the ground, at rest within a second, and 58 dB in a bedroom:

    >>> limits = Limit("ground force", 600e3), Limit("settled", 1.0), Limit("bedroom rating", 58.0, room="bedroom")
    >>> [limit.room for limit in limits]
    ['', '', 'bedroom']
    """

    name: str
    value: float
    room: str = ""


@stored_as("room plan/1")
@dataclass(frozen=True)
@checked("rooms")
class RoomPlan:
    """A room under a radiating surface, or the half space beside it, and its receivers.

    under : the surface that places it; on : the wall that it lies on, where it is not the ceiling. walls : further
    surfaces, one or several, by the wall of the room that they move.
    offset : of the surface's centre from the middle of its wall [m], the two axes of the room along it.
    coupling : one-way, the air does not react on the structure, or two-way. leak : of a two-way room.
    t60_asked : reverberation times that its losses were made from {frequency [Hz]: [s]}, empty for other losses.
    levels : standards by which it is rated, of `acoustics.levels.methods.STANDARDS`.
    animate : frequencies [Hz] of which a moving picture is made, None for the pulse.
    beyond_modes : what rated bands have that the modes do not reach: levels of statistical energies, of bare plates,
    or nothing. ensemble : rooms of nearly its size over which low rated bands are found, 0 for none; it has none where
    there is a `why_no_ensemble`.
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
    walls: Mapping[str, str | tuple[str, ...]] = field(default_factory=dict)
    beyond_modes: Literal["statistical", "blank"] = "statistical"
    ensemble: int = 10
    on: str = ""

    @property
    def moved(self) -> tuple[tuple[str, str], ...]:
        """All surfaces that move its air, (wall, surface), the one that places it first."""
        further = ((wall, (some,) if isinstance(some, str) else some) for wall, some in self.walls.items())
        first = (self.on or self.room.movable[0], self.under)
        return (first, *((wall, name) for wall, names in further for name in names))

    def __post_init__(self) -> None:
        if 0 != self.ensemble < FEWEST_ROOMS:
            expected = f"{FEWEST_ROOMS} rooms or more, or 0 for none"
            raise InputError(f"rooms.{self.name}.ensemble", got=f"{self.ensemble}", expected=expected)
        if self.coupling == "two-way" and not self.room.pushes_back:
            raise InputError(f"rooms.{self.name}.coupling", got=f"two-way with {self.room.word}", expected="one-way")

    @property
    def why_no_ensemble(self) -> str:
        """Why its low bands cannot be had over an ensemble; "" where they can."""
        if not self.levels:
            return "no standard rates the room"
        if self.coupling != "one-way":
            return "the air reacts on the floor, which would have to be computed for every room"
        if self.room.varied(np.ones(3)) is None:
            return f"{self.room.word} has no sides that can be varied"
        if self.walls or self.on:
            return "several surfaces radiate into the room, or a wall of it"
        return "" if self.room.losses.kind != "none" else "the room has no reverberation time"

    def heard_to_hz(self, complete_below_hz: float) -> float:
        """Where the sound of a structure ends [Hz] whose modes are complete below a frequency."""
        return min(complete_below_hz, self.complete_below_hz)

    @property
    def complete_below_hz(self) -> float:
        """Where what the room knows of itself ends [Hz], infinite without an end."""
        return self.room.complete_up_to_hz


def _refuse_unless_rising(where: str, band: Pair) -> None:
    if not 0.0 <= band[0] < band[1]:
        raise InputError(where, got=f"{band[0]:g} to {band[1]:g} Hz", expected="a rising band (low, high)")
