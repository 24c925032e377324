"""What takes part in an impact: bodies, contacts, links, loads; standard sources; a walker."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import sqrt
from types import MappingProxyType
from typing import Any, Final, Generic, TypeVar

import numpy as np

from femstruct.arrays import Floats, freeze, frozen
from femstruct.conventions import GRAVITY
from femstruct.declared import Positive, checked
from femstruct.errors import InputError
from femstruct.laws.hertz import Hertz
from femstruct.laws.law import Law
from femstruct.laws.registry import LAWS
from femstruct.laws.tabulated import Tabulated
from femstruct.model.probe import Probe
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Bodies, contacts, links and loads of an impact, between probes of a modal basis, bodies and ground.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("ground/1")
@dataclass(frozen=True)
class Ground:
    """An end that does not move."""


GROUND = Ground()

End = Probe | str | Ground  # a place of the structure, a body by its name, or the ground


@stored_as("body/1")
@dataclass(frozen=True)
@checked("bodies")
class Body:
    """A point mass that moves along one axis (z up, for most); its displacement is zero at t = 0.

    mass [kg]; velocity at t = 0 [m/s], positive along the axis; falls : the weight acts on it when there is gravity
    (a body that rests on links at t = 0 is in equilibrium with its weight, which then does no more work).

    A ball that falls 0.23 m strikes with sqrt(2 g h):

    >>> ball = Body("ball", 0.054, velocity=-((2 * 9.80665 * 0.23) ** 0.5))
    >>> round(ball.velocity, 3)
    -2.124
    """

    name: str
    mass: float
    velocity: float = 0.0
    falls: bool = False

    def __post_init__(self) -> None:
        if not self.mass > 0:
            raise InputError(f"bodies.{self.name}.mass", got=f"{self.mass:g} kg", expected="a positive mass")


@stored_as("contact/1")
@dataclass(frozen=True, eq=False)
@checked(
    "contacts",
    law=f"{' or '.join(one.__name__ for one in LAWS)}; "
    "for another law use OwnLaw(force, energy, ..) or Tabulated(indentations, forces)",
)
class Contact:
    """A unilateral law between an upper and a lower end: indentation = lower - upper - gap.

    Its force pushes the upper end along the axis and the lower end back. gap [m] : opening at t = 0.
    preload [N] : force at the rest state, which the rest of the system holds; needs a gap of 0.

    upper, lower : the name of a body, a probe of the structure (`model.points["P"].probe("z")`), or GROUND.
    law : of `femstruct.laws`; `OwnLaw` takes functions of yours, `Tabulated` measured points.

    >>> from femstruct.laws.hertz import Hertz
    >>> Contact("ball on ground", upper="ball", lower=GROUND, law=Hertz(3.7e5, damping=150.0)).law.stiffness
    370000.0
    """

    name: str
    upper: End
    lower: End
    law: Law
    gap: float = 0.0
    preload: float = 0.0

    def __post_init__(self) -> None:
        if not self.gap >= 0:
            raise InputError(f"contacts.{self.name}.gap", got=f"{self.gap:g} m", expected="a gap >= 0")
        if not self.preload >= 0:
            raise InputError(f"contacts.{self.name}.preload", got=f"{self.preload:g} N", expected="a preload >= 0")
        if self.preload and self.gap:
            raise InputError(
                f"contacts.{self.name}",
                got=f"a preload of {self.preload:g} N and a gap of {self.gap:g} m",
                expected="one of them",
                do="a preloaded contact is closed: remove the gap",
            )


@stored_as("link/1")
@dataclass(frozen=True, eq=False)
@checked("links")
class Link:
    """A bilateral spring and dashpot between an upper and a lower end, elongation = upper - lower.

    stiffness [N/m]; closing, opening : dashpot [N s/m] while the ends approach and while they move apart;
    release_at [s] : the link acts from this time on only, measured from the elongation it has then;
    preload [N] : compression it is released with, pushing its ends apart.

    A mass on a spring to the ground, struck to 1 m/s, comes to v sqrt(m / k) = 0.1 m:

    >>> from femstruct.impact.simulate import simulate
    >>> from femstruct.modal.closed_form import given_modes
    >>> spring = Link("spring", upper="mass", lower=GROUND, stiffness=100.0)
    >>> scene = Scene((Body("mass", 1.0, 1.0),), links=(spring,))
    >>> response = simulate(given_modes([], [], {})[0], scene, Clock(1.0, 1e3))
    >>> round(float(response.bodies["mass"].displacement.max()), 4)
    0.1
    """

    name: str
    upper: End
    lower: End
    stiffness: float = 0.0
    closing: float = 0.0
    opening: float = 0.0
    release_at: float = 0.0
    preload: float = 0.0

    def __post_init__(self) -> None:
        for word in ("stiffness", "closing", "opening", "release_at"):
            if not getattr(self, word) >= 0:
                raise InputError(f"links.{self.name}.{word}", got=f"{getattr(self, word):g}", expected="a value >= 0")


@stored_as("load history by half sines/1")
@dataclass(frozen=True, eq=False)
@checked("half sine")
class HalfSine:
    """amplitude sin(2 pi frequency t) over its first half period, then nothing: [N] or [Pa] on a surface, [Hz].

    >>> HalfSine(amplitude=2e3, frequency=50.0)  # 10 ms long
    HalfSine(amplitude=2000.0, frequency=50.0)
    """

    amplitude: float
    frequency: Positive


@stored_as("load history by table/1")
@dataclass(frozen=True, eq=False)
@checked("table")
class Table:
    """A force history by straight lines between samples, zero outside them: times [s], values [N] or [Pa].

    >>> Table([0.0, 1e-3, 2e-3], [0.0, 500.0, 0.0]).values.max()
    np.float64(500.0)
    """

    times: Floats
    values: Floats

    def __post_init__(self) -> None:
        times = frozen("load times", self.times, (None,))
        freeze(self, times=times, values=frozen("load values", self.values, times.shape))
        if len(times) < 2 or not (np.diff(times) > 0).all():
            raise InputError("load times", got="times that do not increase", expected="two or more increasing times")


@stored_as("load/1")
@dataclass(frozen=True, eq=False)
@checked("loads")
class Load:
    """A force history on a probe (a point's direction, a surface's pressure) or on a body.

    first [s] : when its own time begins; it comes `count` times in all, every `every` [s]. Where one is not over when
    the next begins, they add. Positive forces push along the positive direction: down is negative.

    1 N s on a free mass of 2 kg leave it with 0.5 m/s:

    >>> from femstruct.impact.simulate import simulate
    >>> from femstruct.modal.closed_form import given_modes
    >>> push = Load("push", "mass", Table([0.0, 0.5, 1.0], [0.0, 2.0, 0.0]))
    >>> response = simulate(given_modes([], [], {})[0], Scene((Body("mass", 2.0),), loads=(push,)), Clock(2.0, 100.0))
    >>> round(float(response.bodies["mass"].velocity[-1]), 9)
    0.5
    """

    name: str
    on: Probe | str
    history: HalfSine | Table
    first: float = 0.0
    every: float = 0.0
    count: int = 1

    def __post_init__(self) -> None:
        _refuse_timing(f"loads.{self.name}", self.first, self.every, self.count)


@stored_as("blows of a body/1")
@dataclass(frozen=True, eq=False)
@checked("blows")
class Blows:
    """A body that strikes `count` times: at first, first + every, first + 2 every, ... [s].

    At every blow it is lifted off and given its starting state again: its displacement is that of `over`, what it is
    above (below, before, after), so that its gap to that is the one it started with, and its velocity is the one it
    started with, in space, not relative to what it strikes. In between it is free: it rebounds, flies on, falls back
    under gravity. Until its first blow it is held still, without contact and without weight.

    late : how much later each blow comes [s]; none where all are in time.
    """

    body: str
    over: End
    every: float
    count: int
    first: float = 0.0
    late: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        where = f"bodies.{self.body}.blows"
        _refuse_timing(where, self.first, self.every, self.count)
        if self.late and not (
            len(self.late) == self.count and min(self.late) >= 0.0 and (np.diff(self.times) > 0).all()
        ):
            got, expected = f"{len(self.late)} delays of {self.count} blows", "one >= 0 each, one blow after the other"
            raise InputError(f"{where}.late", got=got, expected=expected)

    @property
    def times(self) -> Floats:
        """When it strikes [count] [s]."""
        found = self.first + self.every * np.arange(self.count)
        return np.asarray(found + np.array(self.late or 0.0), dtype=np.float64)


@stored_as("scene/1")
@dataclass(frozen=True, eq=False)
@checked("scene")
class Scene:
    """Everything that takes part in an impact, and its initial state.

    velocity [k] : modal velocities at t = 0, None for a structure at rest. gravity [m/s^2], 0 for none.
    blows : bodies that strike more than once, in the order in which they are placed when they strike together.

    >>> from femstruct.laws.linear import Linear
    >>> wall = Contact("wall", upper="ball", lower=GROUND, law=Linear(1e4))
    >>> scene = Scene(bodies=(Body("ball", 1.0, -2.0),), contacts=(wall,))
    >>> [contact.name for contact in scene.contacts]
    ['wall']
    """

    bodies: tuple[Body, ...] = ()
    contacts: tuple[Contact, ...] = ()
    links: tuple[Link, ...] = ()
    loads: tuple[Load, ...] = ()
    velocity: Floats | None = None
    gravity: float = 0.0
    blows: tuple[Blows, ...] = ()

    def __post_init__(self) -> None:
        if self.velocity is not None:
            freeze(self, velocity=frozen("scene.velocity", self.velocity, (None,)))


@stored_as("clock/1")
@dataclass(frozen=True)
@checked("time")
class Clock:
    """How long to simulate and how densely to sample: duration [s], sampling [Hz], quiet [s], relative tolerance.

    quiet : a separation counts as the end of the collision when no contact closes again within this time.
    tolerance : relative error allowed in contact and link forces per step.

    >>> Clock(duration=0.5, sampling=48e3).sampling
    48000.0
    """

    duration: float
    sampling: float
    quiet: float = 0.0
    tolerance: float = field(default=1e-8)

    def __post_init__(self) -> None:
        for word in ("duration", "sampling", "tolerance"):
            if not getattr(self, word) > 0:
                raise InputError(f"time.{word}", got=f"{getattr(self, word):g}", expected="a positive value")


def _refuse_timing(where: str, first: float, every: float, count: int) -> None:
    if not first >= 0:
        raise InputError(f"{where}.first", got=f"{first:g} s", expected="a time >= 0")
    if count < 1 or (count > 1 and not every > 0):
        raise InputError(where, got=f"{count} times, every {every:g} s", expected="a count and a time between")


# ----------------------------------------------------------------------------------------------------------------------
# Standard impact sources: the rubber ball, the bang machine and the tapping machine, and what they must do on a rigid
# floor.
#
# The contact laws of the ball and the bang machine are fitted to the tables of the standards, which give what a source
# does, not what it is made of: mass, drop height, force exposure in octaves, restitution and duration of the contact.
# ----------------------------------------------------------------------------------------------------------------------

L = TypeVar("L", bound=Law)
EXPOSURE_ALLOWED_DB: Final = MappingProxyType({31.5: 1.0, 63.0: 1.5, 125.0: 1.5, 250.0: 2.0, 500.0: 2.0})
RESTITUTION: Final = (0.8, 0.1)  # and what is allowed
CONTACT_S: Final = (20e-3, 2e-3)


@dataclass(frozen=True, eq=False)
class StandardSource(Generic[L]):
    """A source that is dropped: mass [kg], drop height [m], contact law, and its table.

    exposure_db : impact force exposure level on a rigid floor by octave {nominal [Hz]: [dB re 1 N^2 s]}; allowed are
    `EXPOSURE_ALLOWED_DB`, and the same `RESTITUTION` and `CONTACT_S` for both.
    """

    mass: float
    drop_height: float
    law: L
    exposure_db: Mapping[float, float]

    @property
    def speed(self) -> float:
        """Speed at the floor [m/s]."""
        return sqrt(2.0 * GRAVITY * self.drop_height)


def _ball() -> Tabulated:
    """s(d) = k d + f0 (1 - exp(-d / d0)), a spring with a stiff skin, times (1 + chi d'); out to a third of the ball.

    Its four numbers are fitted by least squares to the table below: k 51.8 kN/m, f0 335 N, d0 .827 mm, chi .0596 s/m.
    """
    depth = 1e-3 * np.array([0, 0.2, 0.4, 0.6, 0.8, 1, 1.3, 1.6, 2, 2.5, 3, 4, 5, 7, 10, 15, 20, 30, 40, 50, 60])
    return Tabulated(
        depth, 51.848e3 * depth - 335.13 * np.expm1(-depth / 0.82695e-3), dissipation=0.059583, smooth=True
    )


# ISO 16283-2:2020 table A.1 = ISO 10140-5 table F.1 = JIS A 1418-2 table A.2, and JIS A 1418-2 table A.1, as quoted in
# https://github.com/jmrplens/phonometry (building/measurement/heavy_impact.py) and
# https://kikakurui.com/a1/A1418-2-2019-01.html
RUBBER_BALL: Final[StandardSource[Tabulated]] = StandardSource(
    2.5, 1.0, _ball(), MappingProxyType({31.5: 39.0, 63.0: 31.0, 125.0: 23.0, 250.0: 17.0, 500.0: 12.5})
)
BANG_MACHINE: Final[StandardSource[Hertz]] = StandardSource(
    7.3,
    0.85,
    Hertz(857_926.0, 1277.5),  # fitted by least squares
    MappingProxyType({31.5: 47.0, 63.0: 40.0, 125.0: 22.0, 250.0: 11.5, 500.0: 5.5}),
)
DROPPED: Final[Mapping[str, StandardSource[Any]]] = MappingProxyType(
    {"rubber ball": RUBBER_BALL, "bang machine": BANG_MACHINE}
)

# ISO 10140-5 annex E, ISO 16283-2 annex A: five hammers strike in turn, ten blows a second in all, at .886 +- .022 m/s
TAPPING_MACHINE: Final = "tapping machine"
HAMMERS: Final = 5
HAMMER_MASS: Final = 0.5  # kg
HAMMER_DROP: Final = 0.040  # m
BETWEEN_BLOWS: Final = 0.1  # s
SINGLE_WITHIN_S: Final = 0.020  # a single interval, and the mean of them: ISO 10140-5 annex E, from memory
MEAN_WITHIN_S: Final = 0.005


def blow_scatter(turns: int, seed: int) -> Floats:
    """How much later than evenly the blows of a tapping machine come [turns, hammers] [s], repeatable by its seed.

    Each is up to 10 ms early or late, all alike probable and independent, and 10 ms later than that: every interval
    between two blows is then within 100 +- 20 ms, and the mean of n of them within 20 ms / n of 100 ms: for a turn
    within 5 ms. Of the lines of an even machine sinc^2(2 f 10 ms) of the power is left: above 50 Hz none.

    >>> late = blow_scatter(2, seed=1)
    >>> late.shape, bool((late >= 0).all() and (late <= SINGLE_WITHIN_S).all())
    ((2, 5), True)
    """
    found: Floats = np.random.default_rng(seed).uniform(0.0, SINGLE_WITHIN_S, (turns, HAMMERS))
    return found


# ----------------------------------------------------------------------------------------------------------------------
# A walker: the vertical force of footsteps as a Fourier series, at one place or handed on along a path.
# ----------------------------------------------------------------------------------------------------------------------

PACES_HZ: Final = (1.0, 2.8)  # of the coefficients below
# Design values of CCIP-016 (M. Willford, P. Young, A Design Guide for Footfall Induced Vibration of Structures, 2006):
# (offset, slope over the harmonic's frequency, most), as quoted in
# https://github.com/knippershelbig/StructuralDesignKit_Holz (StructuralDesignKitLibrary/Vibrations/Vibrations -
# Legacy.cs, HarmonicCoefficient); the first is 0.41 (f - 0.95), at most 0.56
_DESIGN: Final = ((-0.41 * 0.95, 0.41, 0.56), (0.069, 0.0056, np.inf), (0.033, 0.0064, np.inf), (0.013, 0.0065, np.inf))
_FINE: Final = 32  # points to a period of the highest harmonic: straight lines miss (2 pi / 32)^2 / 8 = .5 % of it


def design_harmonics(pace_hz: float) -> tuple[float, ...]:
    """Amplitudes of the first four harmonics of a walker's force over the weight [1], design values of CCIP-016.

    Raises InputError: a pace outside 1 to 2.8 Hz.

    >>> [round(a, 3) for a in design_harmonics(2.0)]
    [0.43, 0.091, 0.071, 0.065]
    """
    if not PACES_HZ[0] <= pace_hz <= PACES_HZ[1]:
        raise InputError("pace", got=f"{pace_hz:g} Hz", expected=f"{PACES_HZ[0]:g} to {PACES_HZ[1]:g} Hz")
    return tuple(min(start + slope * h * pace_hz, most) for h, (start, slope, most) in enumerate(_DESIGN, 1))


@stored_as("walk/1")
@dataclass(frozen=True)
@checked("walk")
class Walk:
    """A walker of `mass` [kg] with `pace` steps a second [Hz], `steps` of them, and the amplitudes of the harmonics of
    the force over the weight [1], the first at the pace.

    Notes
    -----
    The force, downwards, is m g (1 + sum a_h sin(2 pi h f t)). It increases over the first step and decreases over the
    last as half a cosine. There is no phase in the source of `design_harmonics`. Heel strikes are left out: it
    covers resonance of a floor with a harmonic, not floors whose first mode is above them, and not audible footsteps.

    >>> from femstruct.impact.scene import design_harmonics
    >>> Walk(80.0, pace=2.0, steps=8, harmonics=design_harmonics(2.0)).steps
    8
    """

    mass: float
    pace: float
    steps: int
    harmonics: tuple[float, ...]

    def __post_init__(self) -> None:
        for word in ("mass", "pace"):
            if not getattr(self, word) > 0:
                raise InputError(word, got=f"{getattr(self, word):g}", expected="a positive value")
        if self.steps < 2:
            raise InputError(
                "steps",
                got=f"{self.steps}",
                expected="2 or more: the force increases over the first and decreases over the last",
            )
        if not self.harmonics:
            raise InputError("harmonics", got="none", expected="one or more")

    @property
    def duration(self) -> float:
        """Time of all steps [s]."""
        return self.steps / self.pace

    @property
    def highest_hz(self) -> float:
        """Frequency of the last harmonic [Hz]."""
        return len(self.harmonics) * self.pace

    def force(self, t: Floats) -> Floats:
        """Force at the times `t` [nt] [s], downwards [N].

        >>> walk = Walk(70.0, 2.0, 6, (0.4, 0.1))
        >>> float(walk.force(np.array([1.0]))[0].round(3))  # between two steps all sines are zero: the weight
        686.465
        """
        order = np.arange(1, len(self.harmonics) + 1)
        series = 1.0 + np.sin(2 * np.pi * self.pace * np.outer(t, order)) @ np.asarray(self.harmonics)
        ends = np.clip(np.minimum(t, self.duration - t) * self.pace, 0.0, 1.0)
        return np.asarray(self.mass * GRAVITY * series * 0.5 * (1.0 - np.cos(np.pi * ends)))

    def tables(self, places: int) -> tuple[Table, ...]:
        """Force histories along z (downwards is negative) of every place of a path that is walked from the first place
        to the last, at an even speed: between two places the force is shared as it is nearer to one or the other."""
        count = int(np.ceil(self.duration * self.highest_hz * _FINE)) + 1
        t = np.linspace(0.0, self.duration, count)
        force = self.force(t)
        along = (places - 1) * t / self.duration
        return tuple(Table(t, -force * np.clip(1.0 - np.abs(along - i), 0.0, 1.0)) for i in range(places))
