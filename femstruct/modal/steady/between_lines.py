"""The largest value of a frequency response, also between its lines, and whether its lines show it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady.resonances import natural, resonances
from femstruct.modal.superposition import Complex
from femstruct.tags import stored_as

MISSED: Final = 0.05  # of the largest value, by which the lines may be lower
PLACES: Final = 8  # the highest lines and natural frequencies, around which is looked
NARROWER: Final = 128  # times as narrow is the next round: where damping couples modes, rounds cost, and lines do not
AROUND: Final = np.linspace(-1.0, 1.0, 2 * NARROWER + 1)  # of a width
ROUNDS: Final = 2  # 128^-2 of a step: 1e-6 of a peak whose half-power bandwidth is a twentieth of the step
FOLLOWED: Final = 1000  # modes, up to which their coupling by damping is looked into: 6 s, and 90 s of 2,400
DIGITS: Final = (5.0, 2.0, 1.0)  # of a step that is proposed

Respond = Callable[[Floats], Complex]


@stored_as("largest value between lines/1")
@dataclass(frozen=True)
class Highest:
    """The largest value of a response in a band, on its lines or between them.

    frequency_hz : where [Hz]. size : magnitude there. line : the largest magnitude on a line. step : from line to line
    [Hz]. needed : a step [Hz] that shows the value to 5 %; that of the lines where they do.
    """

    frequency_hz: float
    size: float
    line: float
    step: float
    needed: float

    @property
    def missed(self) -> float:
        """Share of the value by which the lines are lower [1]."""
        return 1.0 - self.line / self.size if self.size > 0.0 else 0.0

    def on(self, lines_hz: Floats, sizes: Floats) -> Highest:
        """The same of finer lines in that band, where its own lines miss it.

        lines_hz [nf] : equally spaced [Hz]. sizes [nf] : magnitudes there.

        >>> Highest(11.97, 0.0342, 0.0116, 1.0, 0.2).on(np.array([11.8, 12.0, 12.2]), np.array([0.01, 0.0335, 0.02]))
        Highest(frequency_hz=11.97, size=0.0342, line=0.0335, step=0.2, needed=0.2)
        """
        top = int(sizes.argmax())
        line, step = float(sizes[top]), round(float(lines_hz[1] - lines_hz[0]), 12)
        hz, size = (self.frequency_hz, self.size) if self.size >= line else (float(lines_hz[top]), line)
        return Highest(hz, size, line, step, step if line >= (1.0 - MISSED) * size else self.needed)


def highest(respond: Respond, basis: ModalBasis, lines_hz: Floats, sizes: Floats) -> Highest | None:
    """The largest response in the band of some lines, by what lies between them, too.

    respond : values [n] at frequencies [n] [Hz]. lines_hz [nf] : equally spaced [Hz]. sizes [nf] : magnitudes there.
    None where there is no such number: one line or none, or a mode without damping in the band.

    Notes
    -----
    Looked for around the highest lines and natural frequencies, so that a resonance much narrower than the step is
    found; where damping couples up to 1000 modes, around the frequencies at which they swing with it. What is no
    resonance of the structure and narrower than the step can be missed: a transmissibility is largest where the driven
    point stands still.

    >>> from femstruct.modal.analytic import oscillator
    >>> from femstruct.modal.damping import Damping, LossFactor, with_damping
    >>> from femstruct.modal.frf import frf
    >>> basis, points = oscillator(2.0, stiffness=50.0)
    >>> damped, here = with_damping(basis, Damping(LossFactor(0.04))), points["m"].probe("x")
    >>> lines = np.array([0.5, 0.7, 0.9])
    >>> found = highest(lambda f: frf(damped, here, here, f), damped, lines, abs(frf(damped, here, here, lines)))
    >>> round(found.size, 9), round(found.missed, 2), found.needed
    (0.5, 0.83, 0.01)
    """
    low, high = (float(one) for one in lines_hz[[0, -1]]) if len(lines_hz) else (0.0, 0.0)
    own, half = (resonances if len(basis.omega) <= FOLLOWED else natural)(basis).inside(low, high)
    if len(lines_hz) < 2 or (half <= 0.0).any():
        return None
    step = float(lines_hz[1] - low)
    hz = np.concatenate((lines_hz, own))
    values = np.concatenate((sizes, np.abs(respond(own))))
    width = np.concatenate((np.full(len(sizes), step), np.minimum(step, 2.0 * half)))
    best = np.argsort(values)[-PLACES:]
    hz, values, width = hz[best], values[best], width[best]
    for _ in range(ROUNDS):
        tried = np.clip(hz[:, None] + width[:, None] * AROUND, low, high)
        found = np.abs(respond(tried.ravel())).reshape(tried.shape)
        at = found.argmax(axis=1)[:, None]
        hz, values = (np.take_along_axis(one, at, 1)[:, 0] for one in (tried, found))
        width = width / NARROWER
    top, line = int(values.argmax()), float(sizes.max())
    size = float(values[top])
    shown = line >= (1.0 - MISSED) * size
    needed = step if shown else _step_for(respond, float(hz[top]), (1.0 - MISSED) * size, lines_hz)
    return Highest(float(hz[top]), size, line, step, needed)


def missed_peak(one: Highest | None, unit: str) -> tuple[Finding, ...]:
    """A finding where the lines of a response are lower than its largest value by more than 5 %; unit : of the values.

    >>> missed_peak(Highest(11.97, 0.0342, 0.0116, 1.0, 0.2), "m/(N s^2)")[0].values["needed_hz"]
    0.2
    """
    if one is None or one.missed <= MISSED:
        return ()
    size, line = (f"{value:.3g} {unit}".removesuffix(" 1") for value in (one.size, one.line))
    message = (
        f"the largest value, {size} at {one.frequency_hz:.5g} Hz, is between two lines. The lines are {one.step:g} Hz "
        f"apart, and the largest value on one is {line}, {100.0 * one.missed:.0f} % lower. "
        f"Use a step of {one.needed:g} Hz or less"
    )
    values = {"peak": one.size, "peak_hz": one.frequency_hz, "largest_line": one.line}
    return (Finding("peak-between-lines", message, values | {"step_hz": one.step, "needed_hz": one.needed}),)


def _step_for(respond: Respond, peak_hz: float, least: float, lines_hz: Floats) -> float:
    """The largest step [Hz] of one digit whose lines are never so far from a peak that they are below `least`."""
    step = lines_hz[1] - lines_hz[0]
    decades = 10.0 ** (np.floor(np.log10(step)) - np.arange(8.0))
    steps = (decades[:, None] * DIGITS).ravel()
    steps = steps[steps < step]
    ends = np.clip(peak_hz + np.array([[-0.5], [0.5]]) * steps, lines_hz[0], lines_hz[-1])
    enough = (np.abs(respond(ends.ravel())).reshape(ends.shape) >= least).all(axis=0)
    return float(steps[enough.argmax() if enough.any() else -1])
