"""One-dimensional grids of plate sides and bars: nodes where something needs them, and shared along common lines."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError

Key = tuple[str | int, ...]
"""(plate, 0 | 1) for a side of a plate, (frame, line, segment) for a segment of a frame."""

_ROUNDS = 100


@dataclass
class Axis:
    """Grid of a side from 0 to `length`: the required places, and no interval longer than `size` [m].

    Places closer than `tolerance` to one already there are the same place. In the stretches `given` the nodes are those
    of a plate, whatever the size.
    """

    length: float
    size: float
    tolerance: float
    required: list[float] = field(default_factory=list)
    given: list[tuple[float, float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.required = [0.0, self.length]

    def require(self, *places: float) -> bool:
        """Add places; True when one of them is new."""
        new = False
        for place in places:
            if min(abs(place - other) for other in self.required) > self.tolerance:
                self.required.append(place)
                new = True
        return new

    def grid(self) -> Floats:
        """Ascending places [n + 1]: equal intervals between required ones."""
        fixed = np.sort(np.array(self.required))
        # A side of exactly three sizes has three intervals, whatever its rounding.
        counts = np.maximum(1, np.ceil(np.diff(fixed) / self.size - 1e-9)).astype(int)
        middles = (fixed[:-1] + fixed[1:]) / 2.0
        for start, end in self.given:
            counts[(middles > start) & (middles < end)] = 1
        pieces = [
            np.linspace(low, high, count, endpoint=False)
            for low, high, count in zip(fixed[:-1], fixed[1:], counts, strict=True)
        ]
        return np.concatenate([*pieces, fixed[-1:]])


@dataclass(frozen=True)
class Track:
    """A stretch of an axis: the place `start` is the beginning of the shared line, `end` its end."""

    key: Key
    start: float
    end: float


@dataclass(frozen=True)
class SharedLine:
    """Two axes that run along one line; nodes of `source` are put on `target` too."""

    source: Track
    target: Track


def settle(axes: dict[Key, Axis], lines: list[SharedLine]) -> dict[Key, Floats]:
    """Grids of all axes, after the nodes of shared lines have travelled from axis to axis until nothing changes.

    Raises InputError when they do not settle.
    """
    for _ in range(_ROUNDS):
        changed = [_pass_on(axes, line) for line in lines]
        if not any(changed):
            return {key: axis.grid() for key, axis in axes.items()}
    raise InputError("mesh", got="grid lines that multiply endlessly", expected="joined parts with compatible grids")


def _pass_on(axes: dict[Key, Axis], line: SharedLine) -> bool:
    source, target = line.source, line.target
    axis = axes[source.key]
    places = axis.grid()
    low, high = sorted((source.start, source.end))
    inside = places[(places >= low - axis.tolerance) & (places <= high + axis.tolerance)]
    share = (inside - source.start) / (source.end - source.start)
    moved = target.start + share * (target.end - target.start)
    return axes[target.key].require(*np.clip(moved, 0.0, axes[target.key].length).tolist())
