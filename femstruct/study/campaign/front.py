"""What a search for two or three goals at once found: a front of designs, of which none is better in all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from femstruct.arrays import Floats, freeze, frozen_with_gaps
from femstruct.study.campaign.pareto import knee, nondominated, share
from femstruct.study.campaign.sought import LATE, NOT_AT_REST, SAME, Search
from femstruct.study.campaign.swept import Flags, Swept
from femstruct.tags import stored_as

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
        told = self.convergence
        before = [volume for count, volume in told if count <= LATE * self.designs]
        return self.spent and bool(told) and (before[-1] if before else 0.0) < (1.0 - GAIN) * told[-1][1]

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
