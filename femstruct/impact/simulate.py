"""simulate: a scene on a modal basis through time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, wait
from threading import Thread
from typing import Any, Final, TypeVar

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.compiled.kernels import CompiledUnit
from femstruct.compiled.store import load_code
from femstruct.declared import expect
from femstruct.errors import Finding, NotConverged
from femstruct.impact.batch_march import run_many
from femstruct.impact.blow_by_blow import (
    JudgedRun,
    blow_findings,
    blow_table,
    decay_findings,
    run_findings,
    sampling_findings,
)
from femstruct.impact.collocation import (
    MAX_STEPS,
    Ended,
    collocate,
    integrate,
    levels_for,
    report_steps,
    state_at_start,
)
from femstruct.impact.contact_events import (
    CLOSES,
    DONE,
    DRIFT,
    NO_FORCES,
    STALLS,
    STICKS,
    TOO_MANY_EVENTS,
    TOO_MANY_STEPS,
    WORKED,
    ContactForces,
    RunRecord,
    empty_record,
    fill_forces,
    motion_of,
    part_history,
)
from femstruct.impact.energies import TIME, ledger
from femstruct.impact.exact import ExactSteps, exact_rule, exact_workspace, integrate_exactly, is_piecewise_linear
from femstruct.impact.motion import DISPLACEMENT, VELOCITY, Motion, coordinates, row_motion, sampled_motion
from femstruct.impact.propagation import State, collocation_rule, tabulated
from femstruct.impact.response import (
    BodyHistory,
    ContactHistory,
    Endings,
    EnergyLedger,
    Event,
    Outcome,
    Response,
    gain_of,
    outcomes_of,
)
from femstruct.impact.scene import Clock, Scene
from femstruct.impact.system import Compiled, compile_scene
from femstruct.modal.basis import ModalBasis

# ----------------------------------------------------------------------------------------------------------------------
# Runs the compiled solver in a worker thread, so that Ctrl-C still works.
# ----------------------------------------------------------------------------------------------------------------------

CHECK_INTERVAL = 0.2  # seconds between two checks for Ctrl-C, which a plain wait would not notice

R = TypeVar("R")


def run_in_thread(call: Callable[[], R], stop: Integers) -> R:
    """What a call returns or raises, from a thread of its own.

    Parameters
    ----------
    stop : Integers [1]
        The call looks at it and ends when it is not zero; it is set when the wait is interrupted (Ctrl-C), which is
        then raised at once.

    Examples
    --------
    >>> import numpy as np
    >>> run_in_thread(lambda: 6 * 7, np.zeros(1, dtype=np.int64))
    42
    """
    job: Future[R] = Future()

    def work() -> None:
        try:
            job.set_result(call())
        except BaseException as failure:
            job.set_exception(failure)

    Thread(target=work, daemon=True).start()
    try:
        while not wait([job], timeout=CHECK_INTERVAL).done:
            pass
    except BaseException:
        stop[0] = 1
        raise
    return job.result()


# ----------------------------------------------------------------------------------------------------------------------
# Which compiled kernels a simulation needs.
# ----------------------------------------------------------------------------------------------------------------------

Units = Sequence[CompiledUnit[..., Any]]

BY_COLLOCATION: Final[Units] = (integrate, fill_forces)
EXACTLY: Final[Units] = (integrate_exactly, fill_forces)
ALL: Final[Units] = (integrate, fill_forces, integrate_exactly, run_many)


def have(units: Units) -> bool:
    """Whether all of these units are in the store."""
    return all(load_code(unit) is not None for unit in units)


# ----------------------------------------------------------------------------------------------------------------------
# A scene on a modal basis through time.
# ----------------------------------------------------------------------------------------------------------------------

LEDGER_ROWS = 512  # at least


def simulate(basis: ModalBasis, scene: Scene, clock: Clock) -> Response:
    """Motion, forces and energies of an impact, sampled at n / sampling for n = 0 .. duration * sampling - 1.

    When all laws are linear, and no mode is so fast that it makes the steps too many (`femstruct.impact.exact`
    says how many), the motion between events is a power series and events are roots of polynomials: exact to rounding,
    whatever `clock.tolerance`. Otherwise modes move exactly under forces that are polynomials over a step; the forces
    of closed contacts and of links are found by Gauss collocation with 8 points, in steps whose error is held by
    `clock.tolerance`; steps end where a contact closes or opens. The samples come from the same motion and do not
    depend on the steps.

    Raises NotConverged when the steps run out or shrink to nothing, a contact force cannot be found, or contacts switch
    without end: never a result cut short; it names the contact that is nearest to a change.
    FemstructError for a scene that contradicts itself.

    Notes: a contact is never missed: see `femstruct.impact.collocation` and `femstruct.impact.exact`. A
    contact that touches without speed closes when the leading derivative of its indentation is positive. Damping of
    the modes is `basis.time_damping`. Modes that it couples move as the oscillators of their complex modes, exactly
    (`femstruct.modal.coupled_damping`): these are made once for a basis, and a run then takes up to three times as long
    as with modes that nothing couples. Where hundreds creep back, as over wool, sums of few exponentials stand for
    them, good to 1e-11. Closings and openings within rounding are not reported
    (`femstruct.impact.contact_events`). The integration runs beside the thread that waits
    for it, so that Ctrl-C ends it at once.

    A ball of 1 kg strikes a wall through a spring of pi^2 N/m: half a period of contact, 1 s.

    >>> from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
    >>> from femstruct.laws.linear import Linear
    >>> from femstruct.modal.closed_form import given_modes
    >>> wall = Contact("wall", upper="ball", lower=GROUND, law=Linear(np.pi**2))
    >>> response = simulate(given_modes([], [], {})[0], Scene((Body("ball", 1.0, -1.0),), (wall,)), Clock(2.0, 100.0))
    >>> [(event.what, round(event.t, 9)) for event in response.events]
    [('closes', 0.0), ('opens', 1.0)]
    >>> round(response.contacts["wall"].peak_force, 9) == round(np.pi, 9)
    True
    """
    expect("simulate basis", basis, ModalBasis, "modal_basis makes one of an Assembly")
    expect("simulate scene", scene, Scene, "Scene((body, ..), (contact, ..)) is one")
    expect("simulate clock", clock, Clock, "Clock(duration, sampling) is one, in s and Hz")
    compiled = compile_scene(basis, scene, clock)
    system, nt = compiled.system, compiled.n_samples
    state = state_at_start(compiled)
    record = empty_record(system, nt)
    exact = is_piecewise_linear(system, nt / clock.sampling)
    run = _exactly if exact else _by_collocation
    end, motion = run_in_thread(lambda: run(compiled, clock, state, record), record.stop)
    if end.how != DONE:
        raise _not_converged(end, compiled, state, clock)
    part_history(compiled, record, end.rows)
    log = _events(compiled, record, end.events)
    _join_peaks(record)
    separation = _separation(record.events[: end.events], record.event_rows[: end.events], clock)
    history = record.history[: end.rows]
    book = ledger(history, separation, float(record.totals[WORKED]), float(record.totals[DRIFT]), scene, compiled)
    felt = _felt(compiled, motion, state, record)
    contacts = {
        name: _contact(name, rows, compiled, record, felt.place, felt.force, log)
        for name, rows in compiled.contacts.items()
    }
    blows = blow_table(record, motion, basis.omega, compiled, scene, clock, log)
    bodies = _bodies(scene, compiled, motion, state, felt.push)
    endings = _endings(compiled, nt / clock.sampling, log, record, bodies)
    (outcome,) = outcomes_of(scene, endings, runs=1)
    judged = _judged(compiled, record, endings, outcome, book.residual, clock, 0.0 if exact else system.tick)
    return Response(
        basis=basis,
        scene=scene,
        clock=clock,
        t=np.arange(nt) / clock.sampling,
        motion=motion,
        pushed=compiled.pushed,
        pushes=felt.push,
        bodies=bodies,
        contacts=contacts,
        links={name: felt.force[a] for name, a in compiled.links.items()},
        events=log,
        blows=blows,
        ledger=book,
        outcome=outcome,
        findings=(
            *_findings(judged, book, contacts, scene, clock, rings=bool(system.reach[1] > 0.0)),
            *blow_findings(blows, scene, clock),
        ),
    )


def _not_converged(end: Ended, compiled: Compiled, state: State, clock: Clock) -> NotConverged:
    """Why an integration ended before the window did, and the contact to look at."""
    when = f"t = {end.when:g} s"
    trouble = {
        TOO_MANY_STEPS: f"{MAX_STEPS} steps by {when}",
        TOO_MANY_EVENTS: f"{end.events} closings and openings by {when}: a contact chatters",
        NO_FORCES: f"no contact force at {when}",
        STICKS: f"contacts or one-way dashpots that switch endlessly at {when}",
        STALLS: f"{when} after the last {report_steps(compiled.system)} steps: {MAX_STEPS} such steps are too few",
    }
    return NotConverged(
        "impact",
        got=trouble[end.how] + _suspect(compiled, state),
        expected=f"to reach t = {clock.duration:g} s",
        do="check stiffnesses and masses there, or use a larger tolerance",
    )


def _events(compiled: Compiled, record: RunRecord, count: int) -> tuple[Event, ...]:
    """The closings and openings that a run logged."""
    names = {a: name for name, rows in compiled.contacts.items() for a in rows}
    return tuple(
        Event(float(row[TIME]), names[int(a)], "closes" if what == CLOSES else "opens")
        for (a, what, _, _), row in zip(record.events[:count], record.event_rows[:count], strict=True)
    )


def _join_peaks(record: RunRecord) -> None:
    """Peaks since the last blow join those of the blows before, and the largest of all is that of the run."""
    for a, number in enumerate(record.latest):
        record.strike_peak[number, a] = record.peak[a]
        record.peak[a] = record.strike_peak[record.strike_peak[:, a, 0].argmax(), a]


def _felt(compiled: Compiled, motion: Motion, state: State, record: RunRecord) -> ContactForces:
    """Forces of all interfaces and loads at the samples, from the motion."""
    system, nt = compiled.system, compiled.n_samples
    m, r = len(system.interfaces), len(system.rows)
    place, speed = (row_motion(motion, what, system.rows[:m], system.tilts[:m]) for what in (DISPLACEMENT, VELOCITY))
    felt = ContactForces(place, speed, np.empty((m, nt)), np.empty((r, nt)))
    fill_forces(system, state, compiled.halvings, record, felt)
    return felt


def _bodies(scene: Scene, compiled: Compiled, motion: Motion, state: State, push: Floats) -> dict[str, BodyHistory]:
    """Motions of the bodies and what pushes them.

    Parameters
    ----------
    push : Floats [r, nt]
        Forces of all rows.
    """
    k, modes = compiled.system.n_modes, compiled.pushed.shape[1]
    displacement, velocity = (
        coordinates(motion, what, modes, modes + len(scene.bodies)) / compiled.scale[k:, None]
        for what in (DISPLACEMENT, VELOCITY)
    )
    last, felt = state.v[k:] / compiled.scale[k:], (compiled.rows[:, modes:].T @ push) / compiled.scale[k:, None]
    return {
        b.name: BodyHistory(displacement[i], velocity[i], felt[i], float(last[i])) for i, b in enumerate(scene.bodies)
    }


def _exactly(compiled: Compiled, clock: Clock, state: State, record: RunRecord) -> tuple[Ended, Motion]:
    """The integration of piecewise-linear systems; its ledger has no fewer than LEDGER_ROWS."""
    system, nt = compiled.system, compiled.n_samples
    end = nt / clock.sampling
    steps = ExactSteps(end, interval=1.0 / clock.sampling, longest=end / LEDGER_ROWS, max_steps=MAX_STEPS)
    how = integrate_exactly(system, state, exact_rule(), exact_workspace(system), record, steps)
    kept = record.kept[0]
    return Ended.of(how, record), sampled_motion(record.z[:kept].T, record.v[:kept].T, system)


def _by_collocation(compiled: Compiled, clock: Clock, state: State, record: RunRecord) -> tuple[Ended, Motion]:
    """The integration for laws that are not linear."""
    system = compiled.system
    tables = tabulated(system, levels_for(compiled.halvings), collocation_rule())
    ended = collocate(compiled, clock.tolerance, tables, state, record)
    if ended[0] != DONE:
        return ended, sampled_motion(record.z[:0].T, record.v[:0].T)
    return ended, motion_of(record, system, compiled.halvings, tables, compiled.turn)


def _suspect(compiled: Compiled, state: State) -> str:
    """The contact whose indentation is nearest to zero, beside the terms it is summed from; "" without contacts."""
    system = compiled.system
    nearness = {}
    for name, rows in compiled.contacts.items():
        terms = [np.append(system.rows[a] * state.z, system.interfaces["offset"][a]) for a in rows]
        nearness[name] = min(abs(float(t.sum())) / (float(np.abs(t).sum()) or 1.0) for t in terms)
    if not nearness:
        return ""
    return f"; the contact nearest to a change is '{min(nearness, key=lambda name: nearness[name])}'"


def _separation(events: Integers, rows: Floats, clock: Clock) -> Floats | None:
    """Ledger row of the first instant, after the first closing, with all contacts open and none closing again within
    `quiet`; the window must be long enough to show that."""
    closings = rows[events[:, 1] == CLOSES, TIME]
    for (_, what, all_open, _), row in zip(events, rows, strict=True):
        if what == CLOSES or not all_open:
            continue
        again = closings[closings > row[TIME]]
        if row[TIME] + clock.quiet <= clock.duration and not (again.size and again[0] <= row[TIME] + clock.quiet):
            separated: Floats = row
            return separated
    return None


def _contact(
    name: str,
    rows: tuple[int, ...],
    compiled: Compiled,
    record: RunRecord,
    place: Floats,
    force: Floats,
    log: tuple[Event, ...],
) -> ContactHistory:
    offset = compiled.system.interfaces["offset"]
    mine = [event for event in log if event.contact == name]
    opened = [event.t for event in mine if event.what == "opens"]
    peak = max(rows, key=lambda a: float(record.peak[a, 0]))
    sides = [place[a] + offset[a] for a in rows]
    return ContactHistory(
        force=force[rows[0]] - (force[rows[1]] if len(rows) > 1 else 0.0),
        indentation=np.maximum.reduce(sides),
        peak_force=float(record.peak[peak, 0]),
        peak_time=float(record.peak[peak, 1]),
        closings=sum(event.what == "closes" for event in mine),
        first_open=opened[0] if opened else None,
    )


def _endings(
    compiled: Compiled, duration: float, log: Sequence[Event], record: RunRecord, bodies: Mapping[str, BodyHistory]
) -> Endings:
    """What the outcome is told from, of one run."""
    last = {event.contact: event.t for event in log}
    rows = compiled.contacts.items()
    return Endings(
        duration,
        last={name: np.array([last.get(name, np.nan)]) for name in compiled.contacts},
        closed={name: np.array([any(record.closed[a] > 0.0 for a in mine)]) for name, mine in rows},
        gain={name: np.array([gain_of(body.velocity, body.end_velocity, duration)]) for name, body in bodies.items()},
    )


def _judged(
    compiled: Compiled,
    record: RunRecord,
    endings: Endings,
    outcome: Outcome,
    residual: float,
    clock: Clock,
    tick: float,
) -> JudgedRun:
    """What findings look at.

    Parameters
    ----------
    residual : float
        Of the ledger.
    tick : float [s]
        The shortest step, 0 for an integration without one.
    """
    rows = compiled.contacts.items()
    return JudgedRun(
        residual=residual,
        outcome=outcome,
        duration=clock.duration,
        tick=tick,
        closed_since={name: float(endings.last[name][0]) for name, closed in endings.closed.items() if closed[0]},
        deepest={name: float(max(record.deepest[a] for a in mine)) for name, mine in rows},
        lasting={name: float(min(record.shortest[a] for a in mine)) for name, mine in rows},
    )


def _findings(
    run: JudgedRun,
    book: EnergyLedger,
    contacts: Mapping[str, ContactHistory],
    scene: Scene,
    clock: Clock,
    rings: bool,
) -> tuple[Finding, ...]:
    """What is to be known of a run.

    Parameters
    ----------
    rings : bool
        Whether the structure loses energy, so that its decay can be judged.
    """
    peaks = {name: contact.peak_force for name, contact in contacts.items()}
    return (
        *run_findings(scene.contacts, run),
        *(decay_findings(float(book.structure.max()), book.end.structure, clock.duration) if rings else ()),
        *sampling_findings(run.lasting, peaks, clock.sampling),
    )
