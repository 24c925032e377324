"""What every evaluation of a recorded history has: what it takes, and the noun with its numbers that it gives.

An evaluation is a module of this package with a frozen class and nothing to enter anywhere else:
`known_evaluations` finds it, and its fields with their quantities are its keys in study files. JSON, the results file,
spreadsheets, the tables of the terminal and of the page are made of what its answer declares.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Final, Literal, NamedTuple

from femstruct.arrays import Floats
from femstruct.declared import Refers
from femstruct.errors import Finding, InputError
from femstruct.reported import OWN_UNIT, reported

Of = Annotated[str, Refers()]
"""The point and direction of a recorded motion, "POINT.z"."""
PLACES: Final = ("s", "Hz", "1")  # units of numbers that say when and where, or what was asked


class Quoted(NamedTuple):
    """A number of an answer that is quoted: its name in tables or in words, in `unit`; hz : up to which frequency it
    needs modes, 0 where that is not said."""

    name: str
    value: float
    unit: str
    hz: float = 0.0


class Evaluation(ABC):
    """What is asked of one recorded motion of a point. Its class says what holds for all of its kind:

    gives : the noun of its answers. The `table` of that says what they are together; its `key` is the word of the kind
    in study files, in JSON and in results. name : its own. of : the point and direction, "POINT.z".
    """

    gives: ClassVar[Any]
    name: str
    of: str

    @classmethod
    def key(cls) -> str:
        """The word of its kind, "shock_spectra"."""
        word: str = cls.gives.table.key
        return word

    def mistakes(self, sampling: float | None) -> Iterator[InputError]:
        """What is wrong with its fields together, and with the sampling [Hz] where there is one: of each `where` is the
        field, "" for all."""
        yield from ()

    @property
    @abstractmethod
    def quantity(self) -> Literal["displacement", "velocity", "acceleration"]:
        """Which recorded motion it takes."""

    @property
    def channel(self) -> str:
        """The recorded channel, "POINT.z acceleration"."""
        return f"{self.of} {self.quantity}"

    @abstractmethod
    def answer(self, values: Floats, sampling: float) -> Any:
        """The noun with the numbers, of the channel's samples [nt] in SI units and their sampling [Hz]. A number that
        is `Reported` with a symbol has a column in the tables that are read."""

    def quoted(self, answer: Any) -> tuple[Quoted, ...]:
        """The numbers of an answer that must not depend on the modes left out; those of its columns in tables."""
        kind: object = type(answer)
        columns = {field: about for field, about in reported(kind).items() if about.symbol}
        return tuple(
            Quoted(about.symbol, float(value), answer.unit if about.unit == OWN_UNIT else about.unit)
            for field, about in columns.items()
            if about.unit not in PLACES and isinstance(value := getattr(answer, field), int | float)
        )

    def doubts(self, complete_below_hz: float) -> Iterator[Finding]:
        """What is to be known where the modes are complete below a frequency [Hz]."""
        yield from ()
