"""Loss factors that depend on frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.tags import stored_as

LABORATORY: Final = "laboratory"
MEASURED: Final = "measured"
INTERNAL = 0.01  # ISO 12354-1: common homogeneous building materials
LABORATORY_BAND = (50.0, 5000.0)  # Hz
STEPS = 12  # an octave of points: 1e-4 of m' / (485 sqrt f) between them
DECAY = 2.2  # 6 ln 10 / 2 pi = 2.199, as the standards have it
MOST_LOSSES = 1.5  # of rubbers at their glass transition; a few reach 2 in a narrow band, which one number is not


@stored_as("loss factor by frequency/1")
@dataclass(frozen=True)
@checked("loss_factor")
class LossByFrequency:
    """A loss factor given at some frequencies; between them straight over log f, beyond them that of the nearest.

    points : (frequency [Hz], loss factor [1]), ascending. total : of what such a number holds beside the losses in the
    material itself, those at the edges and by radiation: "" for nothing of them, "measured" for one from structural
    reverberation times (`measured_losses`), "laboratory" for one of ISO 12354-1 (`laboratory_losses`), whose points are
    the internal losses until the mass per area of the plate is known (`of_plate`): mass [kg/m^2], 0 before.

    Raises InputError for no point, for frequencies that are not positive or do not ascend, and for loss factors below 0
    or above 1.5.

    >>> loss = LossByFrequency(((63.0, 0.06), (252.0, 0.02)))
    >>> loss.at([20.0, 63.0, 126.0, 1000.0]).round(6).tolist()
    [0.06, 0.06, 0.04, 0.02]
    """

    points: tuple[tuple[float, float], ...]
    total: Literal["", "measured", "laboratory"] = ""
    mass: float = 0.0

    def __post_init__(self) -> None:
        frequencies = [frequency for frequency, _ in self.points]
        if not frequencies or not frequencies[0] > 0 or any(not low < high for low, high in pairwise(frequencies)):
            told = ", ".join(f"{frequency:g}" for frequency in frequencies)
            raise InputError("loss_factor", got=f"[{told}] Hz", expected="positive frequencies that ascend")
        for frequency, value in self.points:
            check_loss(f"loss_factor.{frequency:g} Hz", value)

    def __str__(self) -> str:
        if self.total == LABORATORY:
            plate = f", {self.mass:.4g} kg/m^2" if self.mass else ""
            internal = self.points[0][1] - (edge_losses(self.mass, self.points[0][0]) if self.mass else 0.0)
            return f"ISO 12354-1 laboratory, internal {100 * internal:.4g} %{plate}"
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


def laboratory_losses(internal: float = INTERNAL) -> LossByFrequency:
    """The total loss factor of heavy plates in a laboratory, internal + m' / (485 sqrt f), m' their mass per area.

    internal : loss factor of the material itself [1]; ISO 12354-1 has 1 % for common homogeneous materials.

    Notes
    -----
    ISO 12354-1, annex C: for m' below 800 kg/m^2, at 50 Hz to 5 kHz; beyond, the value of the nearest of these. The
    second term is of the edges of the laboratory, so that edges with losses of their own count them twice.

    >>> from femstruct.model.materials.loss_by_frequency import of_plate
    >>> of_plate(laboratory_losses(0.006), 322.0).at([50.0, 200.0, 1000.0]).round(4).tolist()
    [0.0999, 0.0529, 0.027]
    """
    return LossByFrequency(((LABORATORY_BAND[0], internal), (LABORATORY_BAND[1], internal)), LABORATORY)


def measured_losses(times: Mapping[float, float]) -> LossByFrequency:
    """The total loss factors 2.2 / (f T) of structural reverberation times T [s] by frequency f [Hz].

    Raises InputError for times with which a loss factor is beyond 1.5.

    >>> measured_losses({100.0: 0.304, 50.0: 0.44}).at([50.0, 100.0]).round(4).tolist()
    [0.1, 0.0724]
    """
    found = [(frequency, DECAY / (frequency * time)) for frequency, time in sorted(times.items())]
    return LossByFrequency(tuple(found), MEASURED)


def of_plate(loss: Loss, mass: float) -> Loss:
    """The loss factor of a plate of a mass per area [kg/m^2]: one of a laboratory with its second term.

    >>> of_plate(0.02, 345.0)
    0.02
    """
    if not isinstance(loss, LossByFrequency) or loss.total != LABORATORY or loss.mass or not mass > 0.0:
        return loss
    low, high = LABORATORY_BAND
    frequencies = np.geomspace(low, high, round(STEPS * np.log2(high / low)) + 1)
    values = loss.at(frequencies) + edge_losses(mass, frequencies)
    points = tuple(zip(frequencies.tolist(), np.minimum(values, MOST_LOSSES).tolist(), strict=True))
    return LossByFrequency(points, LABORATORY, mass)


def edge_losses(mass: float, frequency_hz: ArrayLike) -> Floats:
    """m' / (485 sqrt f): what the edges of a laboratory take of a plate of a mass per area [kg/m^2] [1]."""
    return np.asarray(mass / (485.0 * np.sqrt(np.asarray(frequency_hz, dtype=np.float64))))


def refuse_laboratory(where: str, loss: Loss) -> Loss:
    """The loss factor of what is no plate; InputError for one of ISO 12354-1, which takes a mass per area."""
    if isinstance(loss, LossByFrequency) and loss.total == LABORATORY:
        got, expected = "a loss factor of ISO 12354-1 in a part without mass per area", "a plate, slab or shell"
        raise InputError(where, got=got, expected=expected, do="give it a material with a loss factor as a number")
    return loss


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
    for one in losses:
        refuse_laboratory("layers", one)
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
