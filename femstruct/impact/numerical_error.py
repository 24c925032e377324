"""How far a run is from its contact forces and end velocities: the same integration at a strict tolerance.

The difference of two runs is the error of the worse one, as long as the better one is much better; it costs about
as much as the run, and takes no theory of the steps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.collocation import MAX_STEPS, Ended, collocate, levels_for, state_at_start
from femstruct.impact.contact_events import (
    CERTAIN,
    CLOSES,
    COUNTS,
    DONE,
    MOST_EVENTS,
    TOO_MANY_EVENTS,
    RunRecord,
    empty_record,
    settle_events,
)
from femstruct.impact.energies import TIME
from femstruct.impact.exact import (
    THETA,
    ExactSteps,
    exact_rule,
    exact_workspace,
    integrate_exactly,
    is_piecewise_linear,
    largest_rate,
)
from femstruct.impact.propagation import Tables, collocation_rule, tabulated
from femstruct.impact.response import Response
from femstruct.impact.scene import Scene
from femstruct.impact.simulate import run_in_thread
from femstruct.impact.system import Compiled, compile_scene
from femstruct.reported import Reported
from femstruct.tags import stored_as

STRICTER = 100.0
STRICT = 1e-10  # at the latest here the tolerance limits every step; a loose one need not
FINER = 1  # halvings of the longest step, for the same reason
SHORTER = (0.83, 0.7, 0.59)  # of the shortest step of an exact integration: others round otherwise
STRICTEST = 1e-13  # tolerance below which the steps are those of rounding
LEAST_ERROR = 1e-13  # of a peak force or a speed: what no tolerance takes away
FAINT = 1e-9  # of the largest force or speed of all: one below is rounding of the others, and is compared with that


@stored_as("number with its error/1")
@dataclass(frozen=True)
class Resolved:
    """A number of a run and its estimated error, in the same unit; scale : what the error is small against, the number
    itself for a force, the largest speed of a body for its velocity."""

    value: Annotated[float, Reported("see unit", "Number of the run")]
    error: Annotated[float, Reported("see unit", "Estimated error of it")]
    scale: Annotated[float, Reported("see unit", "What the error is small against")]

    @property
    def relative(self) -> Annotated[float, Reported("1", "The error as a share of what it is small against")]:
        """The error as a share of the scale [1]."""
        return self.error / self.scale if self.scale > 0.0 else 0.0


@stored_as("error estimate/1")
@dataclass(frozen=True)
class ErrorEstimate:
    """What a run is wrong by: peak forces [N] by contact, velocities at the end of the window [m/s] by body.

    tolerance : of the run, None for an exact integration, whose error is rounding alone; against : of the run it was
    compared with, None where it was not. first_peak : of the contacts that closed before any contact closed again; peak
    : of the whole window. first_until [s] : when a contact closed again; the end of the window when none did.
    """

    tolerance: Annotated[float | None, Reported("1", "Tolerance of the run, none of exact integration")]
    against: Annotated[float | None, Reported("1", "Tolerance of the run it is compared with")]
    first_until: Annotated[float, Reported("s", "When a contact closes again", "first_until_s")]
    first_peak: Mapping[str, Resolved]
    peak: Mapping[str, Resolved]
    velocity: Mapping[str, Resolved]

    @property
    def exact(self) -> bool:
        """Whether the error is rounding alone: the integration takes no steps that could be wrong."""
        return self.tolerance is None


def error_of(response: Response) -> ErrorEstimate:
    """Error of the steps of a run: its difference to the same run at 1e-10, or at a hundredth of its tolerance.

    Returns an ErrorEstimate; its forces are peaks between the samples. Errors of the model (laws, modes, damping) are
    not in it. Where the stricter run finds no end the errors are infinite.

    Notes: after the first impact a window may be chaotic: then the error at its end says that its end is not to be
    known, while the first peaks hold. The longest step is halved too, since a loose tolerance may not be what limits
    the steps. An exact integration has no steps to be wrong, only rounding: its error is the largest difference to
    three integrations in shorter steps, which round otherwise, and the residual of its energy ledger. The ledger alone
    misses what a grazing contact or many collisions make of rounding; integrations without samples are short. Measured
    on 200 random impacts (`tests/against/test_impact_hertz.py`) and against 40 digits
    (`tests/against/test_impact_exact.py`).

    A ball of 1 kg on a wall by Hertz: the peak is k (5 m v^2 / 4 k)^(3/5).

    >>> from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
    >>> from femstruct.laws.hertz import Hertz
    >>> from femstruct.impact.simulate import simulate
    >>> from femstruct.modal.closed_form import given_modes
    >>> wall = Contact("wall", upper="ball", lower=GROUND, law=Hertz(1e6))
    >>> scene = Scene((Body("ball", 1.0, -1.0),), (wall,))
    >>> found = error_of(simulate(given_modes([], [], {})[0], scene, Clock(0.02, 1e4, tolerance=1e-4)))
    >>> peak = found.first_peak["wall"]
    >>> abs(peak.value - 1e6 * (5 / 4e6) ** 0.6) < 3 * peak.error, peak.relative < 1e-4
    (True, True)
    """
    compiled = compile_scene(response.basis, response.scene, response.clock)
    if is_piecewise_linear(compiled.system, compiled.n_samples / response.clock.sampling):
        none = tabulated(compiled.system, 0, collocation_rule())
        others = [_Again(compiled, response.scene, none, None, shorter=part) for part in SHORTER]
        own = others[0].with_first(_of(response))
        found = [again.run() for again in others]
        return _compared(response, own, found, None, None, LEAST_ERROR + response.ledger.residual)
    tolerance = response.clock.tolerance
    if not response.bodies and not response.events:  # a forced vibration: nothing here to be wrong
        return ErrorEstimate(tolerance, None, response.clock.duration, {}, {}, {})
    against = max(min(tolerance / STRICTER, STRICT), min(tolerance, STRICTEST))
    tables = tabulated(compiled.system, levels_for(compiled.halvings), collocation_rule())
    own = _Again(compiled, response.scene, tables, tolerance).with_first(_of(response))
    other = _Again(compiled, response.scene, tables, against, finer=FINER).run()
    return _compared(response, own, [other], tolerance, against, LEAST_ERROR)


Peaks = Mapping[str, tuple[float, float]]  # largest forces [N] and their times [s] by contact


class _Run(NamedTuple):
    """One integration: peaks of the whole window, velocities [b] at the end [m/s]; log : when, which contact, whether
    it closes. until [s] : when a contact closes again, None if never; first : peaks until then."""

    ended: bool
    peak: Peaks
    velocity: Floats
    log: Sequence[tuple[float, str, bool]]
    until: float | None
    first: Peaks


def _of(response: Response) -> _Run:
    """What a run says itself."""
    return _Run(
        ended=True,
        peak={name: (contact.peak_force, contact.peak_time) for name, contact in response.contacts.items()},
        velocity=np.array([body.end_velocity for body in response.bodies.values()]),
        log=[(event.t, event.contact, event.what == "closes") for event in response.events],
        until=None,
        first={},
    )


@dataclass(frozen=True, eq=False)
class _Again:
    """A scene to be integrated once more, at a tolerance; None for the exact integration, then without samples.

    tables : shared by all integrations of the scene. finer : halvings of the longest step of collocation; shorter :
    steps of the exact integration, of the shortest it would take.
    """

    compiled: Compiled
    scene: Scene
    tables: Tables
    tolerance: float | None
    finer: int = 0
    shorter: float = 1.0

    def run(self) -> _Run:
        """The whole window."""
        return self.with_first(self._integrate(MOST_EVENTS))

    def with_first(self, whole: _Run) -> _Run:
        """The same run and its first peaks; peaks are those since the start, so they may take a shorter integration."""
        preloaded, seen = {contact.name for contact in self.scene.contacts if contact.preload > 0.0}, set()
        for number, (t, name, closes) in enumerate(whole.log):
            if closes and name in seen:
                hidden = any(when > t for _, when in whole.peak.values())
                return whole._replace(until=t, first=self._integrate(number).peak if hidden else whole.peak)
            if closes and name not in preloaded:
                seen.add(name)
        return whole._replace(first=whole.peak)

    def _integrate(self, events: int) -> _Run:
        """To the end, or until there is no room for another event that counts."""
        slots = events
        while True:
            run, missing = self._integrated(slots, events)
            if missing <= 0:
                return run
            slots += missing

    def _integrated(self, slots: int, events: int) -> tuple[_Run, int]:
        """With as many slots for events; and how many of those that count it stops short of."""
        compiled, system = self.compiled, self.compiled.system
        state = state_at_start(compiled)
        record = empty_record(system, 0 if self.tolerance is None else compiled.n_samples)
        record = record._replace(events=record.events[:slots], event_rows=record.event_rows[:slots])
        if self.tolerance is None:
            end = compiled.n_samples * 2.0**compiled.halvings * system.tick
            longest = self.shorter * THETA / max(largest_rate(system), THETA / end)
            scratch = exact_workspace(system)
            steps = ExactSteps(end, interval=np.inf, longest=longest, max_steps=MAX_STEPS)
            ended = run_in_thread(
                lambda: Ended.of(integrate_exactly(system, state, exact_rule(), scratch, record, steps), record),
                record.stop,
            )
        else:
            tolerance = self.tolerance
            ended = run_in_thread(
                lambda: collocate(compiled, tolerance, self.tables, state, record, self.finer), record.stop
            )
        names = {a: name for name, rows in compiled.contacts.items() for a in rows}
        k, count = system.n_modes, ended.events
        if ended.how == TOO_MANY_EVENTS:
            record.events[record.newest[record.newest >= 0], COUNTS] = CERTAIN  # what they lead to is not integrated
            count = settle_events(record, count, len(system.interfaces))
        run = _Run(
            ended=ended.how == DONE,
            peak={name: _peak(record, rows) for name, rows in compiled.contacts.items()},
            velocity=state.v[k:] / compiled.scale[k:],
            log=[
                (float(row[TIME]), names[int(a)], bool(what == CLOSES))
                for (a, what, _, _), row in zip(record.events[:count], record.event_rows, strict=False)
            ],
            until=None,
            first={},
        )
        return run, events - count if ended.how == TOO_MANY_EVENTS else 0


def _peak(record: RunRecord, rows: Sequence[int]) -> tuple[float, float]:
    """Of some interfaces, since the last blow or before."""
    found = np.vstack((record.peak[list(rows)], record.strike_peak[:, list(rows)].reshape(-1, 2)))
    force, time = found[found[:, 0].argmax()]
    return float(force), float(time)


def _compared(
    response: Response,
    own: _Run,
    others: Sequence[_Run],
    tolerance: float | None,
    against: float | None,
    rounding: float,
) -> ErrorEstimate:
    """The largest differences to other runs.

    Parameters
    ----------
    rounding : float
        What all may be wrong by, as a share.
    """
    ended = all(other.ended for other in others)

    speeds = {name: float(np.abs(body.velocity).max()) for name, body in response.bodies.items()}
    fastest = FAINT * max(speeds.values(), default=0.0)

    def resolved(value: float, beside: Sequence[float], scale: float) -> Resolved:
        apart = max(abs(value - one) for one in beside)
        return Resolved(value, apart + rounding * scale if ended else np.inf, scale)

    def forces(mine: Peaks, theirs: Sequence[Peaks]) -> dict[str, Resolved]:
        found = {}
        least = FAINT * max((force for peaks in (mine, *theirs) for force, _ in peaks.values()), default=0.0)
        for name, (force, _) in mine.items():
            beside = [peaks[name][0] for peaks in theirs]
            if (scale := max(force, least, *beside)) > 0.0:
                found[name] = resolved(force, beside, scale)
        return found

    return ErrorEstimate(
        tolerance,
        against,
        response.clock.duration if own.until is None else own.until,
        forces(own.first, [other.first for other in others]),
        forces(own.peak, [other.peak for other in others]),
        {
            name: resolved(
                body.end_velocity,
                [float(other.velocity[i]) for other in others],
                max(speeds[name], fastest),
            )
            for i, (name, body) in enumerate(response.bodies.items())
        },
    )


# ----------------------------------------------------------------------------------------------------------------------
# Peaks and end velocities of a run whose estimated numerical error is too large.
# ----------------------------------------------------------------------------------------------------------------------

UNRESOLVED = 1e-3  # of a peak force: what its estimated error may be; told from there on
NOT_TRUSTED = 1e-2  # and severe from here on
ASKED = 0.1  # share of an asked accuracy that the integration may take


def unresolved_findings(errors: ErrorEstimate, within: float | None = None) -> tuple[Finding, ...]:
    """Contacts whose peak force the integration may miss by more than 0.1 %, or by a tenth of the accuracy that is
    asked for; a body whose velocity at the end it may miss by more than 1 % of its largest.

    Parameters
    ----------
    within : float | None
        The share asked for [1], None where none is.
    """
    allowed = UNRESOLVED if within is None else min(UNRESOLVED, ASKED * within)
    found = []
    for name, peak in errors.peak.items():
        if peak.relative <= allowed:
            continue
        found.append(
            Finding(
                "contact-unresolved",
                f"Contact '{name}': its peak force of {peak.value:.4g} N may be wrong by {peak.error:.3g} N, "
                f"{100 * peak.relative:.2g} %; {100 * allowed:g} % is allowed. {_instead(errors, allowed)}",
                {
                    "peak_force_n": peak.value,
                    "error_n": peak.error,
                    "relative": peak.relative,
                    "allowed": allowed,
                    "first_until_s": errors.first_until,
                },
                severe=peak.relative > NOT_TRUSTED,
            )
        )
    name, speed = max(errors.velocity.items(), key=lambda item: item[1].relative, default=("", None))
    if speed is not None and speed.relative > NOT_TRUSTED:
        found.append(
            Finding(
                "end-unresolved",
                f"{name} ends with {speed.value:.4g} m/s, which may be wrong by {speed.error:.3g} m/s, "
                f"{100 * speed.relative:.2g} % of its largest speed: the end of this window cannot be determined",
                {"velocity_m_s": speed.value, "error_m_s": speed.error, "relative": speed.relative},
            )
        )
    return tuple(found)


def _instead(errors: ErrorEstimate, allowed: float) -> str:
    """What to use, or to do, where a peak of the whole window is not resolved."""
    worst = max((one.relative for one in errors.first_peak.values()), default=0.0)
    if errors.first_peak and worst <= allowed:
        firsts = ", ".join(f"{name} {one.value:.4g} N" for name, one in errors.first_peak.items())
        return (
            f"Each collision multiplies the errors before it. Peaks until {errors.first_until:.4g} s, when a contact "
            f"closes again, have an error of at most {100 * worst:.1g} % ({firsts}). Use these, shorten the window, or "
            "study the scatter of many runs"
        )
    if errors.tolerance is None:
        return "The contact is so light that rounding determines its force"
    return f"The time steps do not resolve it: use a smaller tolerance than {errors.tolerance:g}"
