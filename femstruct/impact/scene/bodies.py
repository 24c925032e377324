"""Bodies, contacts, links and loads of an impact, between probes of a modal basis, bodies and ground."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from femstruct.arrays import Floats, freeze, frozen
from femstruct.declared import Positive, checked
from femstruct.errors import InputError
from femstruct.impact.laws.law import Law
from femstruct.impact.laws.registry import LAWS
from femstruct.model.probe import Probe
from femstruct.tags import stored_as


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
    law : of `femstruct.impact.laws`; `OwnLaw` takes functions of yours, `Tabulated` measured points.

    >>> from femstruct.impact.laws.hertz import Hertz
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
    >>> from femstruct.modal.analytic import given_modes
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
    >>> from femstruct.modal.analytic import given_modes
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

    >>> from femstruct.impact.laws.linear import Linear
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
