"""The nouns of the catalogue: ranks, thresholds and entries."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final


class Rank(Enum):
    """How much a finding takes from a result, the most first."""

    FORBIDS = "forbids trust"
    LIMITS = "limits trust"
    REMARK = "remark"


FORBIDS: Final = Rank.FORBIDS
LIMITS: Final = Rank.LIMITS
REMARK: Final = Rank.REMARK
MEANING: Final = {
    FORBIDS: "the result is not to be trusted; exit code 3",
    LIMITS: "the result holds with a stated error, or in part",
    REMARK: "the result holds; this is worth knowing",
}
CHOSEN: Final = "engineering judgement"


@dataclass(frozen=True)
class Threshold:
    """A threshold: from where on a finding is raised or, with `forbids`, forbids trust.

    value : in the unit that `of` names. of : what the number is of; "% of .." shows a share in per cent.
    reason : why it is this number. source : a publication, a test of ours, or `CHOSEN`. home : the constant that the
    program computes with, "file.NAME"; "" for a number that a standard or another field of a noun holds.

    >>> Threshold(0.05, "% of a peak", "more changes a quoted figure", CHOSEN, "recorded_channels.CONVERGED").shown
    '5 % of a peak'
    """

    value: float
    of: str
    reason: str
    source: str
    home: str
    forbids: bool = False

    @property
    def shown(self) -> str:
        """The number with its unit."""
        return f"{100 * self.value if self.of.startswith('%') else self.value:.6g} {self.of}"


@dataclass(frozen=True)
class Entry:
    """What is known of a code before it is raised.

    sentence : what it means. rank : how much it takes from a result, as a rule. do : what the user can do.
    when : in which case it is raised. limits : the thresholds of it. forbids : in which case it forbids trust although
    its rank is lower; "" where it never does.
    """

    code: str
    sentence: str
    rank: Rank
    when: str
    do: str
    limits: tuple[Threshold, ...] = ()
    forbids: str = ""
