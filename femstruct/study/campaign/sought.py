"""What an optimisation is asked for, and what it found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np

from femstruct.arrays import Floats, freeze, frozen_with_gaps
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.study.campaign.swept import UNROUNDED, Flags, Swept
from femstruct.study.campaign.varied import Listed, Scattered
from femstruct.tags import stored_as

FEWEST_RUNS: Final = 20
SAME: Final = 1e-9  # of a goal: differences below are rounding
LATE: Final = 0.8  # of the designs
WORTH: Final = 0.01  # of what half of the designs are worse than the best by
NEARLY: Final = 0.1  # of what the best design gains, that others may miss of it
VALLEYS: Final = 0.15  # of the ranges, that designs of different valleys lie apart at least
SMALL: Final = 0.01  # of the goal, instead, where it gains nothing or there is nothing beside it
NOT_AT_REST: Final = 1.0  # share by which a limit of the time to rest is exceeded where the window ends before it
MOST_GOALS: Final = 3  # of four and more NSGA-II finds nearly all designs to be on the front
Sense = Literal["minimise", "maximise"]


@stored_as("goal of a search/1")
@dataclass(frozen=True)
@checked("optimise")
class Goal:
    """A number of a study that is to be small or large, by its name in a sweep.

    >>> Goal("total mass").sense
    'minimise'
    """

    name: str
    sense: Sense = "minimise"

    @property
    def sign(self) -> float:
        """1 of what is to be small, -1 of what is to be large."""
        return 1.0 if self.sense == "minimise" else -1.0


@stored_as("search/1")
@dataclass(frozen=True)
@checked("optimise")
class Search:
    """A number of a study that is to be small or large, by a choice of other numbers of its files.

    file : of the study. goal : the number, by its name in a sweep, such as "ground force", or one of the paths that may
    be chosen, such as "bodies.damper.mass". also : one or two more
    goals, which make it a search for a front. designs : what may be chosen, ranges (uniform or log-uniform) or lists.
    limits : what other numbers of the same case should not exceed, by name, in SI units; limit_dimensions : of those
    that were written with a unit. case : "" for the baseline. overrides : texts ``PATH=VALUE`` for all.
    over : what scatters and cannot be chosen; quantile : the share of the scatter for which goal and limits are to
    hold; scatter : samples of it, the same for every design. runs : of the study at most, each sample counted. seed :
    another one searches otherwise. of_study : which of the limits the study states itself.

    Raises InputError where nothing can be chosen, for distributions among what may be, too few runs, more than three
    goals, and one that is asked for twice.

    The mass and the spring of a damper, for the least force on the ground:

    >>> mass = Scattered("bodies.damper.mass", "uniform", 0.5, 12.0, "kg")
    >>> Search("press.study.yaml", "ground force", (mass,), limits={"damper travel": 0.018}).sense
    'minimise'
    """

    file: str
    goal: str
    designs: tuple[Listed | Scattered, ...]
    sense: Sense = "minimise"
    limits: Mapping[str, float] = field(default_factory=dict)
    over: tuple[Listed | Scattered, ...] = ()
    quantile: float = 0.9
    scatter: int = 10
    runs: int = 400
    seed: int = 1
    case: str = ""
    overrides: tuple[str, ...] = ()
    title: str = ""
    limit_dimensions: Mapping[str, str] = field(default_factory=dict)
    also: tuple[Goal, ...] = ()
    of_study: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        names = [one.name for one in self.goals]
        again = next((one for one in self.goals if names.count(one.name) > 1), None)
        if again is not None:
            raise InputError(f"optimise.{again.sense}", got=f"'{again.name}' twice", expected="each goal once")
        if len(names) > MOST_GOALS:
            do = "set limits to the others"
            raise InputError(f"optimise.{self.sense}", got=f"{len(names)} goals", expected="one to three", do=do)
        if not self.designs:
            raise InputError("optimise.vary", got="nothing to choose", expected="one or more paths")
        paths = [one.path for one in (*self.designs, *self.over)]
        twice = next((path for path in paths if paths.count(path) > 1), None)
        if twice is not None:
            raise InputError(f"optimise.vary.{twice}", got="a path that varies twice", expected="each path once")
        words = next((one for one in self.designs if isinstance(one, Listed) and not one.numbers), None)
        if words is not None and words.path in names:
            do = "set it as a choice under 'vary:' alone"
            raise InputError(
                f"optimise.{self.sense}", got=f"'{words.path}', a list of words", expected="numbers", do=do
            )
        normal = next((one for one in self.designs if isinstance(one, Scattered) and one.law == "normal"), None)
        if normal is not None:
            expected = "a range {from, to} or a list of values"
            raise InputError(f"optimise.vary.{normal.path}", got="a distribution", expected=expected)
        if not 0.0 < self.quantile < 1.0:
            raise InputError("optimise.robust.quantile", got=f"{self.quantile:g}", expected="between 0 and 1")
        if self.runs < FEWEST_RUNS * self.samples:
            each = f", {self.samples} samples of the scatter for each (robust: samples)" if self.over else ""
            expected = f"{FEWEST_RUNS * self.samples} or more: {FEWEST_RUNS} designs{each}"
            raise InputError("optimise.runs", got=f"{self.runs} runs", expected=expected)

    @property
    def goals(self) -> tuple[Goal, ...]:
        """All goals, one of most searches."""
        return (Goal(self.goal, self.sense), *self.also)

    @property
    def samples(self) -> int:
        """Runs of the study for one design."""
        return self.scatter if self.over else 1


@stored_as("chosen value/1")
@dataclass(frozen=True)
class Chosen:
    """What an optimisation found for one path. text : as a file writes it. number : in SI units, nan for words. at :
    the end of its range that it lies at, "" inside. change : of the goal per 1 % of the range, from designs beside the
    best one, nan for lists and where there is none."""

    path: str
    text: str
    number: float
    unit: str
    at: Literal["", "lower", "upper"]
    change: float


@stored_as("reference of a search/1")
@dataclass(frozen=True, eq=False)
class Reference:
    """A case as its file has it, beside the best design, with the same samples of what scatters.

    name : of the case. chosen : whether it is the one whose numbers are chosen. goal, ends : as those of `Found`, nan
    where there are none. mean : of the goal over what scatters. less [s] : what the goal of the best design is above
    this one, sample by sample, negative where it is below. why : there are none, "" where there are.
    """

    name: str
    chosen: bool
    goal: float
    ends: tuple[float, float]
    mean: float
    less: Floats
    why: str = ""

    def __post_init__(self) -> None:
        freeze(self, less=frozen_with_gaps("less", self.less, (None,)))


@stored_as("optimum/1")
@dataclass(frozen=True, eq=False)
class Found:
    """The best design of an optimisation.

    goal : its value, in `unit`, of the quantile where something scatters; of a rating that before rounding. ends : its
    least and its largest over what scatters. limits : the values that are limited, by name, nan of a time to rest that
    the window ends before. feasible : whether any design holds all limits; the best is else the one that exceeds them
    least. best : the number of its first row. runs : of the study. designs : how many were tried; left_out : those with
    a finding that forbids trust, or without a number. goals [designs] : of all, nan for those. held [designs] : which
    hold all limits. history : (designs tried, best goal until then), where it improved. spent : whether all runs were
    made; else nothing got better any more. interrupted : whether it was stopped before its end. rows : of all designs,
    in their order.
    references : what the best design is held against: its case as written, and the baseline; none where it was stopped.
    begun : how many of the first designs are those of a sweep.
    """

    search: Search
    unit: str
    goal: float
    ends: tuple[float, float]
    chosen: tuple[Chosen, ...]
    limits: Mapping[str, float]
    feasible: bool
    best: int
    runs: int
    designs: int
    left_out: int
    goals: Floats
    held: Flags
    history: tuple[tuple[int, float], ...]
    spent: bool
    interrupted: bool
    rows: Swept
    references: tuple[Reference, ...] = ()
    begun: int = 0

    @property
    def goal_name(self) -> str:
        """The goal's name; that of the number before rounding where the named one is rounded."""
        finer = self.search.goal + UNROUNDED
        return finer if finer in self.rows.names else self.search.goal

    @property
    def flat(self) -> bool:
        """Whether the goal is the same for all designs, so that none of them is better than the others."""
        known = self.goals[np.isfinite(self.goals)]
        return bool(len(known) > 1 and np.ptp(known) <= SAME * np.abs(known).max())

    @property
    def still_improving(self) -> bool:
        """Whether the runs ended while the goal still got better: in the last fifth of the designs by more than 1 % of
        what half of all designs are worse than the best by."""
        late = [value for count, value in self.history if count > LATE * self.designs]
        early = [value for count, value in self.history if count <= LATE * self.designs]
        if not (self.spent and late):
            return False
        span = np.median(np.abs(self.goals[self.held] - self.goal))
        return not early or bool(abs(late[-1] - early[-1]) > WORTH * span)

    @property
    def gained_over(self) -> Reference | None:
        """The case that the best design is better than: as it is written, else the baseline; None where it is better
        than neither."""
        sign = self.search.goals[0].sign
        return next((one for one in self.references if not one.why and sign * (one.goal - self.goal) > 0.0), None)

    @property
    def nearly(self) -> Flags:
        """Which designs hold all limits and are nearly as good as the best [designs]: they keep 90 % of what it gains
        over its case as written, or are within 1 % of its goal where there is no gain."""
        over = self.gained_over
        within = SMALL * abs(self.goal) if over is None else NEARLY * abs(over.goal - self.goal)
        close: Flags = self.held & (np.abs(self.goals - self.goal) <= within)
        return close
