"""A row of the ledger; its verdict follows from its numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

REPRODUCED = "reproduced"
ASSUMED = "reproduced with an assumption"
NOT = "not reproducible"
INCONSISTENT = "source inconsistent"


@dataclass(frozen=True)
class Row:
    """A printed value and ours.

    where : chapter, table or figure, and the quantity. printed, ours : in `unit`.
    tolerance : largest |ours - printed| that counts as agreement; it is half a unit of the printed digits where
        nothing else is said, and `note` says what else.
    relation : "=", or "<" or ">" where the source gives a bound.
    assumption : what had to be assumed because the source does not say it.
    implied : what the source's own numbers give for the printed value, where they contradict it.
    why : needed where the two disagree.
    """

    where: str
    printed: float
    ours: float
    tolerance: float
    unit: str = "1"
    relation: Literal["=", "<", ">"] = "="
    assumption: str = ""
    implied: float | None = None
    why: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        if not self.tolerance >= 0:
            raise ValueError(f"{self.where}: tolerance {self.tolerance} is not a number >= 0")
        if self.implied is not None and self.agrees(self.implied):
            raise ValueError(f"{self.where}: {self.implied:g} does not contradict {self.printed:g}")
        if not self.agrees(self.ours) and not self.why:
            raise ValueError(f"{self.where}: {self.ours:g} is not {self.printed:g} and nothing says why")

    def agrees(self, value: float) -> bool:
        """Whether a value is the printed one, within the tolerance."""
        slack = self.tolerance * (1.0 + 1e-9)
        if self.relation == "<":
            return value <= self.printed + slack
        if self.relation == ">":
            return value >= self.printed - slack
        return abs(value - self.printed) <= slack

    @property
    def verdict(self) -> str:
        """One of the four verdicts, from the numbers alone."""
        if self.agrees(self.ours):
            return ASSUMED if self.assumption else REPRODUCED
        return NOT if self.implied is None else INCONSISTENT

    @property
    def sentence(self) -> str:
        """Assumption, reason and note in one cell."""
        parts = [
            f"assumed: {self.assumption}" if self.assumption else "",
            f"the source's own numbers give {self.implied:.4g}" if self.implied is not None else "",
            f"because {self.why}" if self.why and not self.agrees(self.ours) else "",
            self.note,
        ]
        return "; ".join(part for part in parts if part)
