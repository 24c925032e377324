"""What every contact law has: code for the engine, its numbers as the engine keeps them, and what it knows of itself.

A law is a module of this package with a frozen class and nothing to enter anywhere else: `registry` finds it, and its
fields with their quantities are its keys in study files. d is the indentation [m], d' its rate [m/s], positive while
the ends approach.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import InitVar, dataclass
from typing import Annotated, Any, ClassVar, Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, freeze
from femstruct.compiled.records import NUMBERS, Records
from femstruct.declared import units_of
from femstruct.errors import Finding, InputError
from femstruct.laws.restitution import dissipation_for
from femstruct.model.materials import Given, given_fields
from femstruct.quantities import Quantity

Kernel = Callable[..., Any]
RESTITUTION_MISSED = 0.05  # of a restitution: Lankarani and Nikravesh's law misses it from 0.79 down
MISSED = "restitution-missed"

_PERCENT: Final = "30 % is 0.3: did you mean {number:g} %?"
HARDLY: Final = "for one that hardly returns write 'restitution: 5 %'"
_STAYS: Final = (
    "for a blow that gives nothing back write '{type: linear, stiffness: .., tensile: true, restitution: 0}'; "
    f"{HARDLY}"
)
Restitution = Annotated[float, Quantity(("ratio",), above=0.0, most=1.0, too_large=_PERCENT, at_limit=_STAYS)]
AnyRestitution = Annotated[float, Quantity(("ratio",), least=0.0, most=1.0, too_large=_PERCENT)]
MeetingSpeed = Annotated[float, Quantity(("speed",), above=0.0)]
Dissipation = Annotated[float, Quantity(("dissipation",), least=0.0)]
PositiveStiffness = Annotated[float, Quantity(("stiffness",), above=0.0)]


class Code(NamedTuple):
    """Kernels of a spring and its dashpot; laws may share one. system, a : the interface whose numbers they read.

    spring(system, a, d) : force, its slope, and the energy it holds, all zero or straight on for d <= 0.
    force(system, a, d, d') : force without a clamp, its derivatives to d and d', and the dashpot's part of the force
    over d'; None where the dashpot is a factor of the spring: s(d) (1 + chi d'). A law of its own force that is not
    tensile has the sign of stiffness d + damping d' while it is indented: by that its contact is clamped.
    beside(system, a, rest, x) : energy at rest + x, less that at rest and the work of the force there, where a formula
    loses no digits; None for the difference itself.
    """

    spring: Kernel
    force: Kernel | None = None
    beside: Kernel | None = None


class StoredLaw(NamedTuple):
    """Numbers of a law as the engine keeps them: see `System.interfaces`. damping : chi of a factor; rows [p, 6]."""

    stiffness: float = 0.0
    damping: float = 0.0
    shape: float = 0.0
    rows: Floats = np.zeros((0, NUMBERS))
    force_at: int = 0
    energy_at: int = 0


class Law(ABC):
    """A contact law. Its class says what holds for all of its kind:

    word : its `type` in a study file, "" for one that no file can tell. code : its kernels.
    sides : of its ends' approach, on which it acts. straight : whether it is a spring and a dashpot that are constant.
    varies : which of its fields may differ between the runs of a batch, and where the engine keeps each.
    doubts : codes of the findings it may have, and whether they are severe.

    Its fields are annotated with their quantities. A field that is an `InitVar` is a key of study files and a name in
    Python that is not kept: others follow from it. Study files tell what is called mass (of the striking body, or the
    reduced one of two), at_speed (with which it starts) and radius (of both ends) where they do not state it.
    """

    word: ClassVar[str] = ""
    code: ClassVar[Code]
    sides: ClassVar[tuple[float, ...]] = (1.0,)
    straight: ClassVar[bool] = False
    varies: ClassVar[Mapping[str, str]] = {}
    doubts: ClassVar[Mapping[str, bool]] = {}
    tensile: bool

    def described(self) -> tuple[Given, ...]:
        """What is given of it, for tables of the inputs and for comparing cases."""
        return given_fields(self, units_of(self))

    @property
    @abstractmethod
    def stored(self) -> StoredLaw:
        """Its numbers as the engine keeps them."""

    @abstractmethod
    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]."""

    def findings(self, contact: str, deepest: float) -> tuple[Finding, ...]:
        """What speaks against the law in a run.

        Parameters
        ----------
        deepest : float
            Largest indentation of its contact [m].
        """
        return ()

    @property
    def doubted_from(self) -> Mapping[str, float]:
        """The same for many runs: by code, the indentation [m] above which a run has the finding; -inf for any."""
        return {}

    def settling_time(self, mass: Floats, columns: Mapping[str, Floats]) -> Floats | None:
        """How long after they met bodies are at rest together [runs] [s], inf where they part; None of a law that
        never holds its bodies.

        Parameters
        ----------
        mass : Floats [runs] or [1]
            Reduced, of both [kg].
        columns : Mapping[str, Floats]
            Of its fields that vary [runs].
        """
        return None

    @staticmethod
    def rests(preload: Floats, laws: Records) -> Floats | None:
        """Indentations at rest under preloads [runs] [m], by numbers of the engine; None without a closed form."""
        return None

    @staticmethod
    def quickest(spring: Floats, dashpot: Floats, speed: Floats) -> Floats | None:
        """Rates [1/s] of steps in which the law may be left out without giving more speed than is allowed; None where
        nobody has worked them out.

        Parameters
        ----------
        spring, dashpot : Floats
            Its numbers times the mobility behind it over the speed allowed.
        speed : Floats [m/s]
            Of meeting.
        """
        return None


@dataclass(frozen=True, kw_only=True)
class FactorLaw(Law):
    """f = s(d) (1 + chi d'): a law with a field `dissipation` chi [s/m], or the restitution at a speed [m/s], from
    which chi follows exactly."""

    at_most_one_of: ClassVar = (("dissipation", "restitution"),)
    only_with: ClassVar = (("at_speed", ("restitution",)),)

    restitution: InitVar[Restitution | None] = None
    at_speed: InitVar[MeetingSpeed | None] = None

    def __post_init__(self, restitution: float | None, at_speed: float | None) -> None:
        if restitution is not None:
            freeze(self, dissipation=dissipation_for(restitution, meeting_speed(self.word, at_speed)))


def meeting_speed(word: str, speed: float | None) -> float:
    """The speed [m/s] that a restitution of a law holds at. Raises InputError where nothing tells it."""
    if speed is None:
        got, do = "a restitution without a meeting speed", "add 'at_speed: 2 m/s'"
        raise InputError(f"{word} law restitution", got=got, expected="at_speed", do=do)
    return speed


def refuse_unless_positive(where: str, value: float) -> None:
    """Raise InputError unless a value is positive."""
    if not value > 0:
        raise InputError(where, got=f"{value:g}", expected=f"a positive {where.split()[-1]}")


def misses(required: float, returned: float) -> bool:
    """Whether a restitution is not what was asked for."""
    return abs(returned - required) > RESTITUTION_MISSED


def missed_restitution(contact: str, owner: str, required: float, returned: float, speed: float) -> tuple[Finding, ...]:
    """The finding of a law that misses its restitution at its meeting speed [m/s]."""
    if not misses(required, returned):
        return ()
    return (
        Finding(
            MISSED,
            f"Contact '{contact}' requires a restitution of {required:g} at {speed:g} m/s; the law of {owner} gives "
            f"{returned:.3f}. This law is valid near 1; hunt-crossley gives the required value.",
            {"restitution": required, "returned": returned, "speed_m_s": speed},
        ),
    )
