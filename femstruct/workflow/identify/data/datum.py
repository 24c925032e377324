"""One set of measured data as a fit takes it, and how its scatter is written."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError
from femstruct.study.matched import Beside
from femstruct.units import quantity
from femstruct.workflow.identify.needs import Needs
from femstruct.workflow.identify.trial import Change, Trial

DOUBTED: Final = 0.2  # a share that has its % sign: 0.5 is 50 %, where 0.5 % may be meant
_SCATTERED: Final = re.compile(r"(?P<file>.+?)\s+(?:\+-|\+/-|±)\s*(?P<scatter>.+)")


@dataclass(frozen=True, eq=False)
class Datum(ABC):
    """A set of n measured numbers, such as natural frequencies or one frequency response.

    name : of its file or channel. known : whether its scatter was stated; else it has the weight of a usual one.
    """

    name: str
    known: bool

    @property
    @abstractmethod
    def needs(self) -> Needs:
        """What of a trial it is compared with."""

    @property
    @abstractmethod
    def size(self) -> float:
        """Norm of the residuals if all of what was measured were missing [1]."""

    @property
    def tracks(self) -> int:
        """How many series of neighbours its residuals are, such as samples in time, of which noise is independent; 0 of
        what has no order."""
        return 0

    @property
    def doubt(self) -> str:
        """What may be wrong with the comparison itself where residuals are large; "" for nothing."""
        return ""

    @abstractmethod
    def residuals(self, trial: Trial) -> Floats:
        """Computed less measured over the scatter [n]."""

    def count(self, trial: Trial) -> int:
        """How many independent numbers the residuals are: fewer than there are where some are combined or projected."""
        return len(self.residuals(trial))

    def slopes(self, trial: Trial, change: Change) -> Floats | None:
        """Derivatives [n] of the residuals by one parameter; None where differences are to be taken."""
        return None

    @abstractmethod
    def beside(self, trial: Trial) -> Sequence[Beside]:
        """Measured beside computed."""

    def findings(self, first: Trial, last: Trial) -> tuple[Finding, ...]:
        """What limits the trust in the comparison itself, of the trial at the start and that at the end."""
        return ()


def file_and_scatter(text: str, option: str, dimension: str, most: float = np.inf) -> tuple[Path, float | None]:
    """A file and its scatter, one standard deviation, of a text ``FILE +- SCATTER`` or ``FILE``.

    most : of it, as `scatter_of`. Raises InputError that begins with the option's name.

    >>> file_and_scatter("floor.csv +- 0.5 %", "--modes", "ratio")
    (PosixPath('floor.csv'), 0.005)
    """
    found = _SCATTERED.fullmatch(text.strip())
    if found is None:
        return Path(text.strip()), None
    return Path(found["file"]), scatter_of(found["scatter"], option, dimension, most)


def scatter_of(text: str, option: str, dimension: str, most: float = np.inf) -> float:
    """A scatter as it is written, above zero; raises as `file_and_scatter`.

    most : the largest that says anything. A share above `DOUBTED`, or a quarter of the most, needs its % sign: so a
    forgotten one is told.
    """
    try:
        value = quantity(text, dimension)
    except InputError as error:
        raise InputError(option, got=error.got, expected=f"{error.expected}, behind +-", do=error.do) from None
    if not value > 0.0:
        raise InputError(option, got=f"a scatter of {text}", expected="one above 0")
    if dimension != "ratio" or value <= min(DOUBTED, 0.25 * most):
        return value
    plain, shown = "%" not in text, f"{100.0 * value:g} %"
    if value > most:
        do = f"did you mean {value:g} %?" if plain else "state the standard deviation of repeated tests"
        raise InputError(option, got=f"a scatter of {shown}", expected=f"{100.0 * most:g} % or less", do=do)
    if plain:
        do = f"write {shown} if it is meant"
        raise InputError(option, got=f"a scatter of {text}: {shown}?", expected=f"a per cent sign: {value:g} %?", do=do)
    return value


def norm(values: Floats) -> float:
    """Root of the sum of squares."""
    return float(np.linalg.norm(values))
