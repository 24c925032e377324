"""What acts on a structure: bodies, contacts, links, loads, walkers, measured sources, and how all start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Final, Literal

from acoustics.reported import Axis
from acoustics.reported import Reported as OfSound
from femstruct.declared import Count, NotNegative, Positive, checked
from femstruct.errors import InputError
from femstruct.modal.installed_sources import ForceSource, SourceMobility
from femstruct.modal.steady import BandSpectrum, Spectrum
from femstruct.model.regions import Vector
from femstruct.reported import Held
from femstruct.study.asked import Spot
from femstruct.tags import stored_as

if TYPE_CHECKING:
    from femstruct.impact.scene import HalfSine, Table, Walk
    from femstruct.laws.law import Law


# ----------------------------------------------------------------------------------------------------------------------
# Structure-borne sources that were measured by themselves, where a study puts them, and what came of it.
# ----------------------------------------------------------------------------------------------------------------------

_BAND: Final = Axis("band_hz", "Hz", "Nominal centre of the band")
_DB: Final = "dB re 20 µPa"
_PW: Final = "dB re 1 pW"


@stored_as("measured source/1")
@dataclass(frozen=True)
@checked("sources")
class MeasuredSource:
    """A machine whose blocked force or free velocity was measured, and its mobility (EN 15657): by itself, without
    phase between contacts, so that it has levels by band and no history.

    at : its contacts, a point's direction each; a point of several places is a contact at each. spectra : rms values in
    bands, or power spectral densities, of each contact, or one for all: forces [N] or velocities [m/s]. mobility : at
    each contact.

    Raises InputError for no contact or no spectrum, for contacts in different bands, and for a free velocity without a
    mobility.

    Notes
    -----
    Contacts act as if they were not correlated: powers and mean squares of pressures add up (EN 15657, EN 12354-5).

    A pump on two feet of 2 kg:

    >>> from femstruct.modal.installed_sources import RigidMass
    >>> force = BandSpectrum(((50.0, 4.0), (63.0, 3.0), (80.0, 3.5)))
    >>> feet = (Spot("foot.1", "z"), Spot("foot.2", "z"))
    >>> MeasuredSource("pump", feet, "blocked force", (force,), RigidMass(2.0)).fraction
    3
    """

    name: str
    at: tuple[Spot, ...]
    what: Literal["blocked force", "free velocity"]
    spectra: tuple[BandSpectrum | Spectrum, ...]
    mobility: SourceMobility

    def __post_init__(self) -> None:
        if not self.at or not self.spectra:
            raise InputError(f"sources.{self.name}", got="no contact or no spectrum", expected="one or more of both")
        kinds = {(type(one), self._bands(one)) for one in self.spectra}
        if len(kinds) > 1:
            got = "spectra of contacts in different bands"
            raise InputError(f"sources.{self.name}", got=got, expected="the same bands at all contacts")
        if self.what == "free velocity" and isinstance(self.mobility, ForceSource):
            got, do = "a free velocity of a source of infinite mobility", "give its mobility, or its blocked force"
            raise InputError(f"sources.{self.name}.free_velocity", got=got, expected="a source with a mobility", do=do)

    @staticmethod
    def _bands(one: BandSpectrum | Spectrum) -> object:
        return (
            (one.fraction, [band for band, _ in one.values]).__repr__() if isinstance(one, BandSpectrum) else one.band
        )

    @property
    def fraction(self) -> Literal[1, 3]:
        """Of an octave are the bands of its results: 3 for thirds."""
        first = self.spectra[0]
        return first.fraction if isinstance(first, BandSpectrum) else 3

    @property
    def band(self) -> tuple[float, float]:
        """From where to where it is known [Hz]."""
        return self.spectra[0].band


@stored_as("source levels/1")
@dataclass(frozen=True, eq=False)
class SourceLevels:
    """Sound of a measured source at one receiver. bands_db : levels of the mean square {nominal centre [Hz]: [dB]}, nan
    where modes end below the band. l_aeq_db : A-weighted, of the bands that are not blank."""

    bands_db: Annotated[Mapping[float, float], OfSound(_DB, "Level of the mean square in the band", axis=_BAND)]
    l_aeq_db: Annotated[float, OfSound(_DB, "A-weighted level of the bands that are given", symbol="L_Aeq")]

    def __post_init__(self) -> None:
        object.__setattr__(self, "bands_db", MappingProxyType(dict(self.bands_db)))


@stored_as("installed source/1")
@dataclass(frozen=True, eq=False)
class InstalledSource:
    """What a measured source does where it stands. power_db : structure-borne sound power into the structure, by band,
    nan where its modes end below; least_db, most_db : between which it lies, as far as the phase of the source's
    mobility is not known. levels : by "ROOM.RECEIVER".
    """

    excited_by: Annotated[str, OfSound("1", "Where it acts")]
    what: Annotated[str, OfSound("1", "What was measured of it")]
    power_db: Annotated[Mapping[float, float], OfSound(_PW, "Structure-borne sound power", axis=_BAND)]
    least_db: Annotated[Mapping[float, float], OfSound(_PW, "Least power for any phase of the source", axis=_BAND)]
    most_db: Annotated[Mapping[float, float], OfSound(_PW, "Largest power for any phase of the source", axis=_BAND)]
    levels: Annotated[
        Mapping[str, SourceLevels], Held("Levels at the receivers, ROOM.RECEIVER", "Levels at one receiver")
    ] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("power_db", "least_db", "most_db", "levels"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))


# ----------------------------------------------------------------------------------------------------------------------
# What acts on a structure: bodies, contacts, links, loads, walkers, and how all start.
# ----------------------------------------------------------------------------------------------------------------------

BodySide = Literal["above", "below", "before", "after"]


@stored_as("repetition of blows/1")
@dataclass(frozen=True)
@checked("repeat")
class Repeat:
    """When something comes: `count` times, at first, first + every, first + 2 every, ... [s].

    alone : whether blows of a machine are far enough apart for each to be a sound of its own. late : how much later
    each comes [s], none where all are in time; of bodies only.

    Ten blows a second, as those of a tapping machine, for a second:

    >>> Repeat(count=10, every=0.1).every
    0.1
    """

    count: Count = 1
    every: NotNegative = 0.0
    first: NotNegative = 0.0
    alone: bool = False
    late: tuple[float, ...] = ()


@stored_as("covering/1")
@dataclass(frozen=True)
@checked("covering")
class Covering:
    """A covering below a tapping machine, as a laboratory measured it: reduction_db : {nominal centre [Hz]: Delta L
    [dB]}, on a heavy reference floor (ISO 10140-3), or on a light one (Delta L_t).

    A study is refused whose floor is of the other kind (`covering_findings`), or whose rated bands it lacks.

    >>> Covering({500.0: 21.0, 630.0: 24.5}).measured_on
    'heavy'
    """

    reduction_db: Mapping[float, float]
    measured_on: Literal["heavy", "light"] = "heavy"


@stored_as("placed body/1")
@dataclass(frozen=True)
@checked("bodies")
class PlacedBody:
    """A body where the study puts it: mass [kg], on which side of what, moving towards it with `speed` [m/s].

    speed is sqrt(2 g h) of a drop height h; `dropped` says that it falls (its weight acts when there is gravity).
    law : of its own contact, None where a named contact or nothing joins them.
    blows : when it is given this start again; None for a body that strikes once. See
    `femstruct.impact.scene.Blows`.
    source : the standard source it is, None for any other body. radius : of a rigid sphere with own sound [m], None for
    a body without. covering : below a tapping machine; its levels are lower by that.

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
    radius: Positive | None = None
    covering: Covering | None = None


@stored_as("planned contact/1")
@dataclass(frozen=True)
@checked("contacts")
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


@stored_as("planned link/1")
@dataclass(frozen=True)
@checked("links")
class PlannedLink:
    """A spring and dashpot between two named ends; see `femstruct.impact.scene.Link`.

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


@stored_as("planned load/1")
@dataclass(frozen=True)
@checked("loads")
class PlannedLoad:
    """A force history [N] on a point's direction or a body, or a pressure history [Pa] on a surface.

    footstep : whether it is the force of a foot on a plate that did not move.

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
    footstep: bool = False


@stored_as("planned walk/1")
@dataclass(frozen=True)
@checked("loads")
class PlannedWalk:
    """A person who walks along places, one after the other, or stays at one; a point may have several places.

    A person of 80 kg who stays at one place, eight steps at two a second:

    >>> from femstruct import Walk
    >>> from femstruct.impact.scene import design_harmonics
    >>> PlannedWalk("neighbour", ("middle",), Walk(80.0, pace=2.0, steps=8, harmonics=design_harmonics(2.0))).walk.steps
    8
    """

    name: str
    along: tuple[str, ...]
    walk: Walk
    repeat: Repeat = Repeat()


@stored_as("rigid motion/1")
@dataclass(frozen=True)
@checked("initial.rigid")
class RigidMotion:
    """A structure that starts moving as a whole: velocity [m/s] and spin [rad/s] about a named point.

    A hull that falls on the water with 3 m/s, without a spin:

    >>> RigidMotion("keel", velocity=(0.0, 0.0, -3.0), spin=(0.0, 0.0, 0.0)).velocity[2]
    -3.0
    """

    about: str
    velocity: Vector
    spin: Vector


@stored_as("initial motion/1")
@dataclass(frozen=True)
@checked("initial")
class InitialMotion:
    """Start velocities of points' directions [m/s] (spread over the modes that can follow), or of the whole.

    A plate whose middle starts upwards with 0.1 m/s:

    >>> InitialMotion(velocities=((Spot("middle", "z"), 0.1),)).rigid is None
    True
    """

    velocities: tuple[tuple[Spot, float], ...] = ()
    rigid: RigidMotion | None = None
