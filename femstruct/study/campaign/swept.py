"""What came of a campaign: a row of numbers for every sample and case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats, freeze, frozen_with_gaps
from femstruct.errors import InputError
from femstruct.study.campaign.varied import INDICES
from femstruct.tags import stored_as

UNROUNDED: Final = " before rounding"  # ends the name of a number of which the standard states a rounded one
MET, EXCEEDED, UNKNOWN = 1.0, 0.0, -1.0  # verdicts as numbers of a row
_LIMITS: Final = "limits / "  # begins the names of limits and verdicts, which are numbers of a row too
Flags = NDArray[np.bool_]


@stored_as("rows of a campaign/1")
@dataclass(frozen=True, eq=False)
class Swept:
    """Rows of n samples and c cases, with k numbers each, in SI units and dB.

    paths, units [p] : what varied. texts [n][p] : its values as a file writes them; values [n, p] : as numbers, nan for
    words and lists. method : how the samples were combined, as `Sampling` has it.
    cases [c], baseline. names, number_units [k] : of the numbers. main : how many of them, from the first on, are asked
    for first. numbers [c, n, k] : nan where there is none.
    done [n] : False for samples that were not run. severe [c][n], findings [c][n] : codes of those that forbid trust in
    a row, and of all. trouble [n] : why a sample has no numbers, "" where it has.
    limits : of the baseline in the first sample, by the name of the number that should not exceed it; rows have their
    own, `limit_name` and `verdict_name`. sources : the files of the study
    verbatim, by name. provenance : of the campaign. made : how rows were made, "" for full runs.

    `xarray.open_dataset("sweep.h5", engine="h5netcdf")` is the same as a labelled table.
    """

    title: str
    paths: tuple[str, ...]
    units: tuple[str, ...]
    texts: tuple[tuple[str, ...], ...]
    values: Floats
    method: str
    cases: tuple[str, ...]
    baseline: str
    names: tuple[str, ...]
    number_units: tuple[str, ...]
    main: tuple[str, ...]
    numbers: Floats
    done: Flags
    severe: tuple[tuple[tuple[str, ...], ...], ...]
    findings: tuple[tuple[tuple[str, ...], ...], ...]
    trouble: tuple[str, ...]
    limits: Mapping[str, float] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)
    made: str = ""

    def __post_init__(self) -> None:
        n, c = len(self.texts), len(self.cases)
        freeze(
            self,
            values=frozen_with_gaps("sweep values", self.values, (n, len(self.paths))),
            numbers=frozen_with_gaps("sweep numbers", self.numbers, (c, n, len(self.names))),
        )

    @property
    def drawn(self) -> bool:
        """Whether the samples are drawn from distributions, and not chosen."""
        return self.method != "grid"

    def of(self, name: str, case: str = "") -> Floats:
        """A number of all samples [n] by its name, in the baseline or another case.

        Raises InputError for a name or a case that is not there.
        """
        if name not in self.names:
            raise InputError("results", got=f"'{name}'", expected="a number of the study", do=self._near(name))
        case = case or self.baseline
        if case not in self.cases:
            raise InputError("case", got=f"'{case}'", expected=f"one of {', '.join(self.cases)}")
        return self.numbers[self.cases.index(case), :, self.names.index(name)]

    def told(self, name: str, case: str) -> Floats:
        """A number of all samples [n] of a case; nan where there is none of this name at all."""
        return self.of(name, case) if name in self.names else np.full(len(self.texts), np.nan)

    def trusted(self, case: str = "") -> Flags:
        """Whether the row of a sample was run and has no finding that forbids trust [n]."""
        at = self.cases.index(case or self.baseline)
        sound = np.array([not codes for codes in self.severe[at]])
        fine: Flags = self.done & sound & np.array([not one for one in self.trouble])
        return fine

    def unit_of(self, name: str) -> str:
        """The unit of a number."""
        return self.number_units[self.names.index(name)]

    def finer(self, names: Sequence[str]) -> list[str]:
        """These numbers, each that is rounded with itself before rounding after it.

        Raises InputError for a name that is not there.
        """
        both = [one for name in names if self.of(name) is not None for one in (name, name + UNROUNDED)]
        return [name for name in dict.fromkeys(both) if name in self.names]

    def _near(self, name: str) -> str:
        import difflib

        near = difflib.get_close_matches(name, self.names, n=1, cutoff=0.5)
        return f"did you mean '{near[0]}'?" if near else f"known here: {', '.join(self.main)}"


def limit_name(name: str) -> str:
    """The name of what a number should not exceed in a row.

    >>> limit_name("settled"), verdict_name("settled"), is_of_limit(limit_name("settled"))
    ('limits / settled / limit', 'limits / settled / verdict', True)
    """
    return f"{_LIMITS}{name} / limit"


def value_name(name: str) -> str:
    """The name of what a limit is compared with in a row: of several places that are struck the worst; nan where the
    run cannot tell."""
    return f"{_LIMITS}{name} / value"


def verdict_name(name: str) -> str:
    """The name of the verdict on a limit in a row: 1 met, 0 exceeded, -1 where the run cannot tell."""
    return f"{_LIMITS}{name} / verdict"


def is_of_limit(name: str) -> bool:
    """Whether a name of a row is that of a limit or a verdict."""
    return name.startswith(_LIMITS)


def independent(rows: Swept) -> Flags:
    """The samples that are independent of each other [n]: of those for indices the first two tables."""
    n = len(rows.texts)
    return np.arange(n) < (2 * n // (len(rows.paths) + 2) if rows.method == INDICES else n)
