"""What an optimisation is asked for, what it found, and fronts of several goals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np

from femstruct.arrays import Floats, freeze, frozen_with_gaps
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.study.campaigns import UNROUNDED, Flags, Listed, Scattered, Swept
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Designs of which none is better than another in all goals: which they are, how much they gain, where they bend.
# ----------------------------------------------------------------------------------------------------------------------

BEYOND: Final = 0.1  # of the front's extent, from its worst values to the reference point of the hypervolume
BULGE: Final = 0.02  # of the extents: a knee stands out by more than this in front of the straight line


def nondominated(small: Floats) -> Flags:
    """Which designs no other one beats: none is as small in all goals and smaller in one [n]. small [n, g].

    Of designs that are equal in all goals, the first.

    >>> nondominated(np.array([[1.0, 3.0], [2.0, 2.0], [2.0, 3.0], [2.0, 2.0]])).tolist()
    [True, True, False, False]
    """
    found, front = np.zeros(len(small), dtype=bool), np.empty((0, small.shape[1]))
    for k in np.lexsort(small.T[::-1]):  # what beats a design, and the first of its equals, comes before it
        if not (front <= small[k]).all(axis=1).any():
            front, found[k] = np.vstack([front, small[k]]), True
    return found


def hypervolume(small: Floats, reference: Floats) -> float:
    """The volume of all that designs beat, up to a reference point. small [n, g], reference [g], two or three goals.

    Exact: strips of two goals; slices of such along a third (Zitzler and Thiele 1998).

    Two designs, whose rectangles overlap:

    >>> hypervolume(np.array([[0.0, 2.0], [1.0, 0.0]]), np.array([3.0, 3.0]))  # 3 x 1 + 2 x 3 - 2 x 1
    7.0
    """
    inside = small[(small < reference).all(axis=1)]
    if not len(inside):
        return 0.0
    if len(reference) == 2:
        x, y = inside[np.lexsort((inside[:, 1], inside[:, 0]))].T
        lowest = np.minimum.accumulate(y)
        return float(np.sum(np.diff(x, append=reference[0]) * (reference[1] - lowest)))
    order = inside[np.argsort(inside[:, 2], kind="stable")]
    heights = np.diff(order[:, 2], append=reference[2])
    return sum(
        float(high) * hypervolume(order[: k + 1, :2], reference[:2]) for k, high in enumerate(heights) if high > 0.0
    )


def scaled(small: Floats, front: Floats) -> Floats:
    """Goals [n, g] in terms of a front [m, g]: 0 at its best value of each goal, 1 at its worst."""
    low, extent = front.min(axis=0), np.ptp(front, axis=0)
    return np.asarray((small - low) / np.where(extent > 0.0, extent, np.maximum(np.abs(low), 1e-300)))


def share(small: Floats, front: Floats) -> float:
    """The hypervolume of designs [n, g] as a share of the box between the best values of a front [m, g] and a point a
    tenth of its extent beyond its worst ones."""
    g = front.shape[1]
    reference = np.full(g, 1.0 + BEYOND)
    return hypervolume(np.maximum(scaled(small, front), 0.0), reference) / float(np.prod(reference))


def knee(front: Floats) -> int | None:
    """The design of a front [m, g] that lies farthest in front of the straight line (or plane) through its ends, with
    every goal in terms of its extent (Das 1999); None where the front is straight or bends the other way, and where
    the ends make no such plane.

    Beyond a knee a little more of one goal costs much of another.

    >>> knee(np.array([[0.0, 10.0], [0.2, 1.0], [1.0, 0.0]])), knee(np.array([[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]]))
    (1, None)
    """
    if len(front) < 3 or not (np.ptp(front, axis=0) > 0.0).all():
        return None
    points = scaled(front, front)
    ends = points[points.argmin(axis=0)]
    if np.linalg.matrix_rank(ends) < len(ends):
        return None
    across = np.linalg.solve(ends, np.ones(len(ends)))  # the plane is where points @ across = 1
    along = points @ across
    return int(np.argmin(along)) if (across > 0.0).all() and along.min() < 1.0 - BULGE else None


def picked(front: Floats, first: Sequence[int], most: int) -> list[int]:
    """Some designs of a front [n, g] that show all of it: the first ones, then always the one farthest from all that
    are picked, with every goal in terms of its extent; in the order of the front.

    >>> picked(np.array([[0.0, 4.0], [0.1, 3.9], [2.0, 2.0], [4.0, 0.0]]), first=(0, 3), most=3)
    [0, 2, 3]
    """
    points, found = scaled(front, front), list(dict.fromkeys(first))
    while len(found) < min(most, len(front)):
        apart = np.linalg.norm(points[:, None] - points[found], axis=-1).min(axis=1, initial=np.inf)
        apart[found] = -1.0
        found.append(int(np.argmax(apart)))
    return sorted(found)


# ----------------------------------------------------------------------------------------------------------------------
# What an optimisation is asked for, and what it found.
# ----------------------------------------------------------------------------------------------------------------------

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


# ----------------------------------------------------------------------------------------------------------------------
# What a search for two or three goals at once found: a front of designs, of which none is better in all of them.
# ----------------------------------------------------------------------------------------------------------------------

GAIN: Final = 0.01  # of the hypervolume, in the last fifth of the designs: below it more runs change a front little
End = Literal["", "lower", "upper"]


@stored_as("front of designs/1")
@dataclass(frozen=True, eq=False)
class Front:
    """The best designs of a search with g goals and m limits, of n that were tried.

    units [g] : of the goals. goals [n, g] : of all designs, quantiles where something scatters, ratings before
    rounding; nan where a finding forbids trust or a number is missing. limited [n, m] : the values that are limited.
    held [n] : which hold all limits and are to be trusted. at [n][p] : the end of its range at which a path is, ""
    inside. members : numbers of the designs on the front, by their first goal, the best first; none where no design
    holds all limits. convergence : after each generation (designs tried, hypervolume of those that held all limits), as
    a share of the box between the best values of the front and a point a tenth of its extent beyond its worst ones.
    runs : of the study. spent : whether all runs were made; else no new design came up. interrupted : whether it was
    stopped before its end. rows : of all designs, in their order.

    Notes
    -----
    Designs have their numbers from 0 on, in the order in which they were tried; `search.samples` rows belong to each.
    """

    search: Search
    units: tuple[str, ...]
    goals: Floats
    limited: Floats
    held: Flags
    at: tuple[tuple[End, ...], ...]
    members: tuple[int, ...]
    convergence: tuple[tuple[int, float], ...]
    runs: int
    spent: bool
    interrupted: bool
    rows: Swept

    def __post_init__(self) -> None:
        n = len(self.held)
        freeze(
            self,
            goals=frozen_with_gaps("goals of designs", self.goals, (n, len(self.units))),
            limited=frozen_with_gaps("limited numbers of designs", self.limited, (n, len(self.search.limits))),
        )

    @property
    def designs(self) -> int:
        """How many were tried."""
        return len(self.held)

    @property
    def left_out(self) -> int:
        """Designs with a finding that forbids trust, or without a number."""
        return int(np.isnan(self.goals).any(axis=1).sum())

    @property
    def small(self) -> Floats:
        """The goals with the sign with which they are to be small [n, g]."""
        return np.asarray(self.goals * [one.sign for one in self.search.goals])

    @property
    def feasible(self) -> bool:
        """Whether any design holds all limits."""
        return bool(self.held.any())

    @property
    def nearest(self) -> int | None:
        """Where no design holds all limits, the number of the one that exceeds them least."""
        sound = np.flatnonzero(np.isfinite(self.goals).all(axis=1))
        if self.feasible or not len(sound):
            return None
        limits = np.array(list(self.search.limits.values()))
        excess = np.maximum((self.limited[sound] - limits) / np.abs(np.where(limits, limits, 1.0)), 0.0)
        return int(sound[np.argmin(np.where(np.isnan(excess), NOT_AT_REST, excess).sum(axis=1))])

    @property
    def ends(self) -> Mapping[str, int]:
        """The design of the front that is best in each goal, by its name."""
        members = np.array(self.members)
        if not len(members):
            return {}
        best = members[self.small[members].argmin(axis=0)]
        return {one.name: int(k) for one, k in zip(self.search.goals, best, strict=True)}

    @property
    def knee(self) -> int | None:
        """The number of the design where the front bends most, None where it does not bend towards better designs."""
        members = self.members
        found = knee(self.small[list(members)]) if members else None
        return None if found is None else members[found]

    @property
    def still_improving(self) -> bool:
        """Whether the runs ended while the front still got better: by more than 1 % of its hypervolume in the last
        fifth of the designs."""
        course = self.convergence
        before = [volume for count, volume in course if count <= LATE * self.designs]
        return self.spent and bool(course) and (before[-1] if before else 0.0) < (1.0 - GAIN) * course[-1][1]

    @property
    def flat(self) -> tuple[str, ...]:
        """Goals that are the same for all designs."""
        known = self.goals[np.isfinite(self.goals).all(axis=1)]
        if len(known) < 2:
            return ()
        same = np.ptp(known, axis=0) <= SAME * np.abs(known).max(axis=0)
        return tuple(one.name for one, alike in zip(self.search.goals, same, strict=True) if alike)

    def texts(self, design: int) -> dict[str, str]:
        """What was chosen for a design, by path, as a file writes it."""
        own = self.rows.texts[design * self.search.samples]
        return {one.path: text for one, text in zip(self.search.designs, own, strict=False)}

    def notes(self, design: int) -> list[str]:
        """What a design of the front stands out by: best in a goal, the knee."""
        best = [f"best {name}" for name, k in self.ends.items() if k == design]
        return best + (["knee"] if design == self.knee else [])


def members_of(small: Floats, held: Flags) -> tuple[int, ...]:
    """Numbers of the designs on the front, of those that hold all limits, by their first goal. small [n, g], held [n].

    >>> members_of(np.array([[2.0, 1.0], [1.0, 2.0], [0.0, 0.0]]), np.array([True, True, False]))
    (1, 0)
    """
    numbers = np.flatnonzero(held)
    best = numbers[nondominated(small[numbers])]
    return tuple(best[np.lexsort(small[best].T[::-1])].tolist())


def convergence_of(
    small: Floats, held: Flags, members: Sequence[int], counts: Sequence[int]
) -> tuple[tuple[int, float], ...]:
    """The hypervolume of what held all limits after so many designs, in terms of a front. Example: `pareto_front`."""
    if not members:
        return ()
    front = small[list(members)]
    known = [small[:count][held[:count]] for count in counts]
    shares = [share(one[nondominated(one)], front) for one in known]
    return tuple(zip(counts, shares, strict=True))
