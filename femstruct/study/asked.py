"""What is asked of a study: modes, frequency responses, records, time, limits, rooms and who listens in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats, freeze, frozen
from femstruct.declared import NotNegative, Positive, checked
from femstruct.errors import InputError
from femstruct.modal.steady import Spectrum
from femstruct.model.regions import Pair
from femstruct.reported import Reported
from femstruct.tags import stored_as

if TYPE_CHECKING:
    from acoustics.fields.sound_field import SoundField
    from acoustics.receivers import Receiver
    from acoustics.rooms.box_coupling import Leak
    from femstruct.impact.fatigue import SNLine


# ----------------------------------------------------------------------------------------------------------------------
# Fatigue as it is asked for: whose cycles are counted, and by what line they do damage.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("fatigue request/1")
@dataclass(frozen=True)
@checked("fatigue")
class FatigueRequest:
    """Rainflow cycles of a recorded channel, and the damage they do by an S-N line; of a stress, at the place of its
    part with the most damage, on the worst plane. under : the random excitation of `vibration` that it answers, with a
    duration; "" for the history in time.

    A weld of detail category 71 in a portal:

    >>> from femstruct import SNLine
    >>> FatigueRequest("weld", "portal stress", SNLine(71e6, category=True)).sn.slope
    3.0
    """

    name: str
    of: str
    sn: SNLine | None = None
    under: str = ""


# ----------------------------------------------------------------------------------------------------------------------
# What is asked of a study.
# ----------------------------------------------------------------------------------------------------------------------

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
    levels : standards by which it is rated, of `acoustics.levels.standards.STANDARDS`.
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


# ----------------------------------------------------------------------------------------------------------------------
# Steady excitations as they are asked for: harmonic or random, a force, a pressure or a base that moves.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("vibration/1")
@dataclass(frozen=True)
@checked("vibration")
class Vibration:
    """A steady excitation of a structure, by itself: what else a study does to it has no part in its answers.

    on : a point's direction (kind "point"), a surface that a uniform pressure acts on ("surface"), or "x", "y", "z"
    ("base"): everything that stands on the ground moves along it as one. what : "harmonic", `spectrum` being amplitudes
    [N, N m, Pa, m/s^2], or "psd", one-sided power spectral densities of them [their unit^2/Hz]. duration [s] : of a
    random one, for the expected largest values.

    A shaker under a machine, 10 minutes of 0.01 g^2/Hz from 20 to 500 Hz:

    >>> from femstruct.conventions import GRAVITY
    >>> level = 0.01 * GRAVITY**2
    >>> Vibration("shaker", "z", "base", "psd", Spectrum(((20.0, level), (500.0, level))), duration=600.0).unit
    '(m/s^2)^2/Hz'
    """

    name: str
    on: Spot | str
    kind: Literal["point", "surface", "base"]
    what: Literal["harmonic", "psd"]
    spectrum: Spectrum
    duration: Positive | None = None

    @property
    def unit(self) -> str:
        """Of the values of its spectrum."""
        turned = isinstance(self.on, Spot) and self.on.what.startswith("r")
        unit = {"point": "N m" if turned else "N", "surface": "Pa", "base": "m/s^2"}[self.kind]
        return unit if self.what == "harmonic" else per_hertz(unit)

    @property
    def place_text(self) -> str:
        """Where it acts, in a word."""
        return f"base {self.on}" if self.kind == "base" else str(self.on)


def per_hertz(unit: str) -> str:
    """The unit of the power spectral density of something.

    >>> per_hertz("N"), per_hertz("m/s^2")
    ('N^2/Hz', '(m/s^2)^2/Hz')
    """
    return f"{unit}^2/Hz" if unit.isalpha() else f"({unit})^2/Hz"


# ----------------------------------------------------------------------------------------------------------------------
# What was measured beside what a fit computes for it, as tables and pictures show it.
# ----------------------------------------------------------------------------------------------------------------------

MeasuredKind = Literal["history", "modes", "frf", "levels"]


@dataclass(frozen=True, eq=False)
class Beside:
    """Measured beside computed numbers [n] of one kind, real or complex, in `unit`.

    along [n] : time [s], frequency or band [Hz], or the number of the measured mode, from 1. scatter [n] : the standard
    deviation that was taken, in `unit`. notes [n] : what belongs to a number, such as the partner of a mode; empty for
    none.

    >>> modes = Beside("modes", "floor.csv", "Hz", [1.0], [20.0], [21.0], [0.2], ("mode 4",))
    >>> float((modes.computed / modes.measured)[0])
    1.05
    """

    kind: MeasuredKind
    name: str
    unit: str
    along: Floats
    measured: NDArray[Any]
    computed: NDArray[Any]
    scatter: Floats
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        along = frozen("Beside along", self.along, (None,))
        freeze(self, along=along, scatter=frozen("Beside scatter", self.scatter, along.shape))
        for name in ("measured", "computed"):
            values = np.array(getattr(self, name))
            if values.shape != along.shape:
                raise InputError(f"Beside {name}", got=f"shape {values.shape}", expected=f"{along.shape}")
            values.flags.writeable = False
            freeze(self, **{name: values})


# ----------------------------------------------------------------------------------------------------------------------
# What is asked of a machine on its foundation, by case: forces, travels, rest, energies, and verdicts on limits.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("verdict/1")
@dataclass(frozen=True)
class Verdict:
    """A limit and what came of it, both in `unit`.

    value : None where there is none: a structure that is not at rest in time; `seen` is then for how long it was looked
    at [s]. met : None where that is too short to tell. at : the place whose drop is the worst, where a source strikes
    several; "" for one. least : whether the value is a lower bound, of a rating some of whose bands are blank.
    converged : False where the verdict rests on a peak that changes with the modes left out or with the mesh.
    statistical : whether bands of a rating are from statistical energies.
    """

    name: str
    value: Annotated[float | None, Reported("see unit", "What came out")]
    limit: Annotated[float, Reported("see unit", "What it should not exceed")]
    unit: Annotated[str, Reported("1", "Unit of value, limit and margin")]
    met: bool | None
    seen: float | None = None
    at: Annotated[str, Reported("1", "Place of the worst drop, where there are several")] = ""
    least: Annotated[bool, Reported("1", "Whether the value is a lower bound", "at_least")] = False
    converged: Annotated[bool, Reported("1", "Whether modes left out and the mesh change little of the value")] = True

    statistical: Annotated[bool, Reported("1", "Whether bands of the rating are statistical")] = False

    @property
    def verdict(self) -> Annotated[str, Reported("1", "met, exceeded, not seen, not known")]:
        """What it says in a word.

        >>> Verdict("ground force", 7.0, 6.0, "N", False).verdict
        'exceeded'
        """
        unknown = "not known" if self.least else "not seen"
        return unknown if self.met is None else "met" if self.met else "exceeded"

    @property
    def margin(self) -> Annotated[float | None, Reported("see unit", "What is left up to the limit, negative beyond")]:
        """What is left up to the limit, negative beyond it; None where that is not known."""
        return None if self.value is None or self.least else self.limit - self.value


@stored_as("sag under weight/1")
@dataclass(frozen=True)
class Sag:
    """How far a part has sunk under the weight of all [m]: its lowest node, of a block the centre of mass.

    tilt : angle a block leans by [rad], None for other parts.
    """

    part: str
    sag: float
    tilt: float | None


@stored_as("block mode/1")
@dataclass(frozen=True)
class BlockMode:
    """A mode in which mainly blocks move. number : from 1; shares : of its kinetic energy, by "BLOCK direction"."""

    number: int
    frequency_hz: float
    ratio: float
    shares: dict[str, float]


@stored_as("ground force/1")
@dataclass(frozen=True)
class GroundForce:
    """Vertical force on the ground [N]: the largest the motion adds, the largest with the weight of all that stands
    there (None without gravity, and of given modes, which do not say their mass), and the first beside the baseline's,
    in percent and as an attenuation [dB] (None for the baseline itself)."""

    dynamic: float
    with_weight: float | None
    percent: float | None
    attenuation_db: float | None


@stored_as("time to rest/1")
@dataclass(frozen=True)
class Rest:
    """Time from a blow to rest: the longest of all blows [s], None where one is not at rest before the next; and the
    shortest interval it was looked for in [s]."""

    after: float | None
    interval: float


@stored_as("companion of a machine/1")
@dataclass(frozen=True)
class Companion:
    """A body that does not strike: an impact damper, a tuned mass.

    travel : largest distance from where it was beside what it was placed at [m]. closings : of its contacts, in all;
    of one that lies or is clamped, how often its force rose above what it has at rest: it need not have left.
    seated : whether one of them carries a force at the end; None without contacts.
    """

    travel: float
    closings: int
    seated: bool | None


@stored_as("energy share/1")
@dataclass(frozen=True)
class EnergyShare:
    """Where the energy put in until t [s] is [J]; the five add up to `put_in` within the ledger's residual.

    forged : lost in the contacts of what strikes, and when they have just ended what their springs still hold.
    strikers : what those bodies keep, the springs of closed contacts included.
    structure : kinetic and elastic. companions : kinetic, stored and lost in the bodies that do not strike and what
    joins them. dissipated : lost in the structure's modes and dashpots.
    """

    t: float
    put_in: float
    forged: float
    strikers: float
    structure: float
    companions: float
    dissipated: float


@stored_as("machine/1")
@dataclass(frozen=True)
class Machine:
    """One case of a machine on its foundation.

    ground : None where the force on the ground is not recorded. travels : largest |displacement| of every recorded
    point [m]. sags, modes : at rest, and of its blocks; as `check` tells them. rest : None without blows.
    companions : by name. at_separation, at_end : where the energy is when the first contact has ended (None if it does
    not) and at the end. growth : by striking body, the structure's largest energy after its last blow over the first's.
    """

    ground: GroundForce | None
    travels: Mapping[str, float]
    sags: tuple[Sag, ...]
    modes: tuple[BlockMode, ...]
    rest: Rest | None
    companions: Mapping[str, Companion]
    at_separation: EnergyShare | None
    at_end: EnergyShare
    growth: Mapping[str, float | None]
