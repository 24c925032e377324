"""How far the steps of a run are from its contact forces and end velocities: the same march at a strict tolerance.

The difference of two runs is the error of the worse one, as long as the better one is much better; the steps of a run
cost little beside its samples, so this is cheap and takes no theory of the steps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.impact.collocate import collocate, state_at_start
from femstruct.impact.energy import TIME
from femstruct.impact.exact.choice import takes_exact_march
from femstruct.impact.march import CLOSES, DONE, levels_for
from femstruct.impact.response import Response
from femstruct.impact.sampling import Record, room_for
from femstruct.impact.system import Compiled, compile_scene
from femstruct.impact.tables import Tables, empty_tables

STRICTER = 100.0
STRICT = 1e-10  # at the latest here the tolerance limits every step; a loose one need not
FINER = 1  # halvings of the longest step, for the same reason
STRICTEST = 1e-13  # tolerance below which the steps are those of rounding
ROUNDING = 1e-13  # of a peak force or a speed: what no tolerance takes away


@dataclass(frozen=True)
class Resolved:
    """A number of a run and the estimated error of its steps, in the same unit; scale : what the error is small
    against, the number itself for a force, the largest speed of a body for its velocity."""

    value: float
    error: float
    scale: float

    @property
    def relative(self) -> float:
        """The error as a share of the scale [1]."""
        return self.error / self.scale if self.scale > 0.0 else 0.0


@dataclass(frozen=True)
class ErrorEstimate:
    """What the steps of a run are wrong by: peak forces [N] by contact, velocities at the end [m/s] by body.

    tolerance : of the run; against : of the run it was compared with, both None for an exact march, whose error is
    rounding. first_peak : of the contacts that closed before any contact closed again; peak : of the whole window.
    first_until [s] : when a contact closed again; the end of the window when none did.
    """

    tolerance: float | None = None
    against: float | None = None
    first_until: float = 0.0
    first_peak: Mapping[str, Resolved] = field(default_factory=dict)
    peak: Mapping[str, Resolved] = field(default_factory=dict)
    velocity: Mapping[str, Resolved] = field(default_factory=dict)

    @property
    def exact(self) -> bool:
        """Whether there are no steps that could be wrong."""
        return self.tolerance is None


def error_of(response: Response) -> ErrorEstimate:
    """Error of the steps of a run: its difference to the same run at 1e-10, or at a hundredth of its tolerance.

    Returns an ErrorEstimate; its forces are peaks between the samples. Errors of the model (laws, modes, damping) are
    not in it. Where the stricter run finds no end the errors are infinite.

    Notes: after the first impact a window may be chaotic: then the error at its end says that its end is not to be
    known, while the first peaks hold. The longest step is halved too, since a loose tolerance may not be what limits
    the steps. Measured on 200 random impacts: `tests/against/test_impact_hertz.py`.

    A ball of 1 kg on a wall by Hertz: the peak is k (5 m v^2 / 4 k)^(3/5).

    >>> from femstruct.impact.bodies import GROUND, Body, Clock, Contact, Scene
    >>> from femstruct.impact.laws import Hertz
    >>> from femstruct.impact.simulate import simulate
    >>> from femstruct.modal.analytic import given_modes
    >>> wall = Contact("wall", upper="ball", lower=GROUND, law=Hertz(1e6))
    >>> scene = Scene((Body("ball", 1.0, -1.0),), (wall,))
    >>> found = error_of(simulate(given_modes([], [], {})[0], scene, Clock(0.02, 1e4, tolerance=1e-4)))
    >>> peak = found.first_peak["wall"]
    >>> abs(peak.value - 1e6 * (5 / 4e6) ** 0.6) < 3 * peak.error, peak.relative < 1e-4
    (True, True)
    """
    compiled = compile_scene(response.basis, response.scene, response.clock)
    system, tolerance = compiled.system, response.clock.tolerance
    if takes_exact_march(system, compiled.n_samples / response.clock.sampling):
        return ErrorEstimate()
    against = max(min(tolerance / STRICTER, STRICT), min(tolerance, STRICTEST))
    tables = empty_tables(system, levels_for(compiled.halvings))
    clamps = {contact.name for contact in response.scene.contacts if contact.preload > 0.0}
    watched = np.ones(len(system.interfaces), dtype=bool)
    for name in clamps:
        watched[list(compiled.contacts[name])] = False
    own = _run(compiled, tolerance, tables, watched, 0)
    other = _run(compiled, against, tables, watched, FINER)

    def resolved(value: float, beside: float, scale: float) -> Resolved:
        return Resolved(value, abs(value - beside) + ROUNDING * scale if other.ended and own.ended else np.inf, scale)

    first: dict[str, Resolved] = {}
    whole: dict[str, Resolved] = {}
    for name, rows in compiled.contacts.items():
        for found, mine, beside in ((first, own.first, other.first), (whole, own.peak, other.peak)):
            value, compared = float(mine[list(rows)].max()), float(beside[list(rows)].max())
            if max(value, compared) > 0.0:
                found[name] = resolved(value, compared, max(value, compared))
    k = system.n_modes
    velocity = {
        body.name: resolved(
            float(own.velocity[k + i]),
            float(other.velocity[k + i]),
            float(np.abs(response.bodies[body.name].velocity).max()),
        )
        for i, body in enumerate(response.scene.bodies)
    }
    return ErrorEstimate(tolerance, against, own.until, first, whole, velocity)


class _Run(NamedTuple):
    """One march: peaks [m] before any contact closes again and in all, velocities [n] at the end."""

    ended: bool
    until: float
    first: Floats
    peak: Floats
    velocity: Floats


def _run(compiled: Compiled, tolerance: float, tables: Tables, watched: NDArray[np.bool_], finer: int) -> _Run:
    """The whole window, and once more to where a contact closes again: peaks are those since the start of a march."""
    state, record = state_at_start(compiled), room_for(compiled.system, compiled.n_samples)
    status, _, _, n_events = collocate(compiled, tolerance, tables, state, record, finer)
    whole, velocity = _peaks(record), state.v / compiled.scale
    seen: set[int] = set()
    for number, (a, what, _) in enumerate(record.events[:n_events]):
        if what != CLOSES or not watched[a]:
            continue
        if a in seen:
            until = float(record.event_rows[number, TIME])
            brief = room_for(compiled.system, compiled.n_samples)
            brief = brief._replace(events=brief.events[:number], event_rows=brief.event_rows[:number])
            again = state_at_start(compiled)
            collocate(compiled, tolerance, tables, again, brief, finer)  # ends with its room for events
            return _Run(status == DONE, until, _peaks(brief), whole, velocity)
        seen.add(int(a))
    end = compiled.n_samples * 2.0**compiled.halvings * compiled.system.tick
    return _Run(status == DONE, end, whole, whole, velocity)


def _peaks(record: Record) -> Floats:
    """Of every interface, since the last blow or before."""
    largest: Floats = np.maximum(record.peak[:, 0], record.strike_peak[:, :, 0].max(axis=0))
    return largest
