"""What every evaluation of a recorded history has: what it takes, and the noun with its numbers that it gives.

An evaluation is a module of this package with a frozen class and nothing to enter anywhere else: `known_evaluations`
finds it. JSON, the results file, spreadsheets, the tables of the terminal and of the page are made of what its answer
declares.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any, ClassVar, Literal

from femstruct.arrays import Floats
from femstruct.errors import Finding


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

    def doubts(self, complete_below_hz: float) -> Iterator[Finding]:
        """What is to be known where the modes are complete below a frequency [Hz]."""
        yield from ()
