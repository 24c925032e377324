"""Loss factors that depend on frequency."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.errors import InputError

MOST_LOSSES = 1.5  # of rubbers at their glass transition; a few reach 2 in a narrow band, which one number is not


@dataclass(frozen=True)
@checked("loss_factor")
class LossByFrequency:
    """A loss factor given at some frequencies; between them straight over log f, beyond them that of the nearest.

    points : (frequency [Hz], loss factor [1]), ascending.

    Raises InputError for no point, for frequencies that are not positive or do not ascend, and for loss factors below 0
    or above 1.5.

    >>> loss = LossByFrequency(((63.0, 0.06), (252.0, 0.02)))
    >>> loss.at([20.0, 63.0, 126.0, 1000.0]).round(6).tolist()
    [0.06, 0.06, 0.04, 0.02]
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        frequencies = [frequency for frequency, _ in self.points]
        if not frequencies or not frequencies[0] > 0 or any(not low < high for low, high in pairwise(frequencies)):
            told = ", ".join(f"{frequency:g}" for frequency in frequencies)
            raise InputError("loss_factor", got=f"[{told}] Hz", expected="positive frequencies that ascend")
        for frequency, value in self.points:
            check_loss(f"loss_factor.{frequency:g} Hz", value)

    def __str__(self) -> str:
        return ", ".join(f"{100 * value:.5g} % at {frequency:g} Hz" for frequency, value in self.points)

    @property
    def band(self) -> tuple[float, float]:
        """The lowest and the highest frequency that it is given at [Hz]."""
        return self.points[0][0], self.points[-1][0]

    def at(self, frequency_hz: ArrayLike) -> Floats:
        """Loss factors [...] at frequencies [...] [Hz]; at 0 Hz that of the lowest."""
        frequencies, values = np.array(self.points).T
        asked = np.clip(np.asarray(frequency_hz, dtype=np.float64), *self.band)
        return np.asarray(np.interp(np.log(asked), np.log(frequencies), values))


Loss = float | LossByFrequency


def loss_at(loss: Loss, frequency_hz: ArrayLike) -> Floats:
    """Loss factors [...] at frequencies [...] [Hz] of one number or a table.

    >>> loss_at(0.02, [10.0, 20.0]).tolist()
    [0.02, 0.02]
    """
    if isinstance(loss, LossByFrequency):
        return loss.at(frequency_hz)
    return np.full(np.shape(frequency_hz), loss, dtype=np.float64)


def weighted(losses: Sequence[Loss], shares: ArrayLike) -> Loss:
    """The loss factor of what shares its energy between parts of these; one of them where all are alike.

    >>> weighted([0.01, LossByFrequency(((100.0, 0.03), (200.0, 0.05)))], [0.5, 0.5]).at([100.0, 200.0]).round(9)
    array([0.02, 0.03])
    """
    parts = np.asarray(shares, dtype=np.float64)
    if len(set(losses)) == 1:
        return losses[0]
    tables = [one for one in losses if isinstance(one, LossByFrequency)]
    if not tables:
        return float(parts @ np.array(losses, dtype=np.float64))
    grid = sorted({frequency for one in tables for frequency, _ in one.points})
    mean = parts @ np.array([loss_at(one, grid) for one in losses])
    return LossByFrequency(tuple(zip(grid, mean.tolist(), strict=True)))


def check_loss(where: str, loss: Loss) -> None:
    """Raise InputError for a loss factor that no material has; a table has compared its own."""
    if isinstance(loss, LossByFrequency) or 0 <= loss <= MOST_LOSSES:
        return
    raise InputError(
        where,
        got=f"{loss:g}",
        expected=f"a loss factor from 0 to {MOST_LOSSES:g}",
        do=f"2 % is 0.02: did you mean {loss:g} %?" if loss > 0 else "remove the sign",
    )
