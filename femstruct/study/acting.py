"""What acts on a structure: bodies, contacts, links, loads, walkers, and how all start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from femstruct.declared import Count, NotNegative, Positive, checked
from femstruct.model.region import Vector
from femstruct.study.asked import Spot
from femstruct.tags import stored_as

if TYPE_CHECKING:  # a model's modes need none of these
    from femstruct.impact.laws.law import Law
    from femstruct.impact.scene.bodies import HalfSine, Table
    from femstruct.impact.scene.walking import Walk

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

    A study is refused whose floor is of the other kind (`covered_floor`), or whose rated bands it lacks.

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
    `femstruct.impact.scene.bodies.Blows`.
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
    >>> from femstruct.impact.scene.walking import design_harmonics
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
