"""The collocation integration for laws that are not linear: steps through Gauss points, and the events between them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.compiled.kernels import Matrix, Vector, kernel, unit
from femstruct.compiled.records import CONSTANT, LINK, System
from femstruct.impact.contact_events import (
    DONE,
    FULL,
    LIFTED,
    NO_FORCES,
    OF_PLACE,
    OF_SPEED,
    OPENS,
    STALLS,
    STEPS,
    TOO_MANY_EVENTS,
    RunRecord,
    Standing,
    apply_blow,
    balance_ledger_row,
    confirm,
    ended,
    log_changes,
    log_event,
    log_initial_blow,
    may_continue,
    peaks,
    peaks_at_start,
    settle_events,
    standing_room,
    start_ledger,
    store_row,
    store_state,
    travels,
    update_status,
)
from femstruct.impact.energies import MODES, fill_ledger_row, integrate_losses, part_energies
from femstruct.impact.propagation import (
    AWAY,
    CLAMPED,
    CLOSED,
    DISPLACEMENT_ROUNDING,
    LONGER,
    LONGEST_DOUBLINGS,
    OPEN,
    PLACES,
    PRELOAD,
    STAGES,
    Rule,
    State,
    StepTrial,
    Tables,
    advance,
    copy_to,
    law,
    load_at,
    net_force,
    rows_now,
    sense,
    step_workspace,
    try_step,
)
from femstruct.impact.system import Compiled

# ----------------------------------------------------------------------------------------------------------------------
# Watching the contacts: what a step may do before a contact changes its status. No excursion is missed.
#
# Over a step the rows' displacements are interpolated at start, nodes and end. Bernstein coefficients bound the
# interpolant, and a remainder from every mode's energy and the forces' derivatives bounds what it can miss: Lagrange's
# form for modes slow beside the step, the norm of the interpolation for fast ones. A step in which a change of status
# cannot be excluded is halved until it can, or until it is one tick long or what is watched moves by no more than its
# rounding: there the change happens.
# ----------------------------------------------------------------------------------------------------------------------

RELATIVE = 1e-12  # relative to the largest value in the step: rounding of the Bernstein coefficients
AMPLIFIED = 400.0  # rounding of the values in the Bernstein coefficients: the norm of that matrix is 375
SAFE, CHANGES, UNCERTAIN, SHARP = 0, 1, 2, 3
PLACE_MISSED, RATE_MISSED, PLACE_ROUNDING, RATE_ROUNDING = 0, 1, 2, 3  # columns of what is unknown of an interface


@kernel
def interpolation_errors(
    level: int, system: System, state: State, tables: Tables, trial: StepTrial, out: Floats
) -> None:
    """Per interface what interpolation can miss of displacement and velocity, and their rounding: out [i, 4]."""
    r, rule = len(system.rows), tables.rule
    derivatives = trial.derivatives
    derivatives[:] = 0.0
    for a in range(r):
        for j in range(STAGES):
            for s in range(STAGES):
                derivatives[a, j] += rule.slopes[j, s] * trial.forces[a, s]
            derivatives[a, j] = abs(derivatives[a, j])
            derivatives[a, STAGES] = max(derivatives[a, STAGES], 4.6 * abs(trial.forces[a, j]))
    place, rate, push = tables.stray[level, 0], tables.stray[level, 1], tables.stray_push[level]
    out[:] = 0.0
    coupled = len(system.turn) > 0
    for i in range(len(system.omega)):
        z, v = abs(state.z[i]), abs(state.v[i])
        if z != 0.0 or v != 0.0:
            norm = system.omega[i] * z + v
            for a in range(len(out)):
                row = abs(system.rows[a, i])
                out[a, PLACE_ROUNDING] += row * z
                out[a, RATE_ROUNDING] += row * v
                if coupled:
                    tilt, squared = abs(system.tilts[a, i]), system.omega[i] * system.omega[i]
                    out[a, PLACE_MISSED] += tilt * rate[i] * norm
                    out[a, RATE_MISSED] += tilt * squared * place[i] * norm
                    out[a, PLACE_ROUNDING] += tilt * v
                    out[a, RATE_ROUNDING] += tilt * (squared * z + system.damping[i] * v)
                    out[a, PLACE_MISSED] += row * place[i] * norm
                    row = abs(system.rows[a, i] - system.tilts[a, i] * system.damping[i])
                    out[a, RATE_MISSED] += row * rate[i] * norm
                else:
                    out[a, PLACE_MISSED] += row * place[i] * norm
                    out[a, RATE_MISSED] += row * rate[i] * norm
    for a in range(len(out)):
        for b in range(r):
            for j in range(STAGES + 1):
                out[a, PLACE_MISSED] += push[0, j, a, b] * derivatives[b, j]
                out[a, RATE_MISSED] += push[1, j, a, b] * derivatives[b, j]
        out[a, PLACE_ROUNDING] *= DISPLACEMENT_ROUNDING
        out[a, RATE_ROUNDING] *= DISPLACEMENT_ROUNDING


@kernel
def first_excursion(values: Floats, margin: float, stray: float, rule: Rule) -> tuple[int, float]:
    """Whether the function with these values at the places exceeds the margin, and where first it is seen to do so.

    SHARP where it moves by less than the margin in all of the step: a shorter one would not find the place any better,
    and in much shorter ones the state itself stands still, each change being lost in rounding.
    """
    largest, moves = 0.0, 0.0
    for i in range(PLACES):
        largest = max(largest, abs(values[i]))
        moves = max(moves, abs(values[i] - values[0]))
    found = SHARP if moves <= margin else CHANGES
    doubt = AMPLIFIED * margin + RELATIVE * largest
    margin += RELATIVE * largest
    for i in range(PLACES):
        if values[i] > margin:
            if i == 0:
                return found, 0.0
            low, high = rule.places[i - 1], rule.places[i]
            for _ in range(60):
                middle = 0.5 * (low + high)
                if _interpolant(values, middle, rule) > margin:
                    high = middle
                else:
                    low = middle
            return found, low
    bound = -np.inf
    for i in range(PLACES):
        coefficient = 0.0
        for j in range(PLACES):
            coefficient += rule.bernstein[i, j] * values[j]
        bound = max(bound, coefficient)
    return (SAFE if bound + stray <= doubt else UNCERTAIN), 1.0


@kernel
def _interpolant(values: Floats, theta: float, rule: Rule) -> float:
    top, bottom = 0.0, 0.0
    for i in range(PLACES):
        distance = theta - rule.places[i]
        if distance == 0.0:
            return float(values[i])
        weight = rule.barycentric[i] / distance
        top += weight * values[i]
        bottom += weight
    return top / bottom


@kernel
def watch(
    system: System, state: State, rule: Rule, trial: StepTrial, bounds: Floats, loaded: Floats
) -> tuple[int, float]:
    """First change of status in a trial step: SAFE, CHANGES or SHARP with the part before it, or UNCERTAIN."""
    values = trial.watched
    answer, part = SAFE, 1.0
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK or state.status[a] == AWAY:
            continue
        clamps = system.interfaces[a]["tensile"] == 0 and system.interfaces[a]["closing"] > 0.0
        constant, by_depth, by_speed = sense(system, a)
        stray, margin, status = bounds[a, PLACE_MISSED], bounds[a, PLACE_ROUNDING], state.status[a]
        # indentation must stay negative when open, positive when closed; a dashpot beside the spring pulls before that
        if status != CLOSED or not clamps or by_depth == 0.0:
            side = 1.0 if status == OPEN else -1.0
            for p in range(PLACES):
                values[p] = side * (trial.place[a, p] + system.interfaces[a]["offset"])
            code, where = first_excursion(values, margin, stray, rule)
            answer, part = _first(answer, part, code, where)
        if clamps and status != OPEN:
            side = -1.0 if status == CLOSED else 1.0
            for p in range(PLACES):
                depth = trial.place[a, p] + system.interfaces[a]["offset"]
                values[p] = side * (constant + by_depth * depth + by_speed * trial.rate[a, p])
            margin = by_depth * bounds[a, PLACE_ROUNDING] + by_speed * bounds[a, RATE_ROUNDING]
            stray = by_depth * bounds[a, PLACE_MISSED] + by_speed * bounds[a, RATE_MISSED]
            code, where = first_excursion(values, margin, stray, rule)
            answer, part = _first(answer, part, code, where)
        if system.interfaces[a]["preload"] > 0.0 and status == CLOSED:
            side = -1.0 if loaded[a] > 0.0 else 1.0
            values[0] = side * _ends(trial.forces[a], rule.at_start)
            values[PLACES - 1] = side * _ends(trial.forces[a], rule.at_end)
            for p in range(STAGES):
                values[p + 1] = side * trial.forces[a, p]
            code, where = first_excursion(values, least_excess(system, bounds, a), 0.0, rule)
            answer, part = _first(answer, part, code, where)
    return answer, part


@kernel
def least_excess(system: System, bounds: Floats, a: int) -> float:
    """What the force of a preloaded contact must differ from its preload by for its sign to be known."""
    _, by_place, by_rate, _ = law(system, a, system.interfaces[a]["offset"], 0.0)
    rounding = by_place * bounds[a, PLACE_ROUNDING] + by_rate * bounds[a, RATE_ROUNDING]
    return float(max(PRELOAD * system.interfaces[a]["preload"], rounding))


@kernel
def _ends(forces: Floats, weights: Floats) -> float:
    total = 0.0
    for j in range(STAGES):
        total += weights[j] * forces[j]
    return total


@kernel
def _first(answer: int, part: float, code: int, where: float) -> tuple[int, float]:
    """The earlier of two changes; a change comes before a doubt, a doubt before a sharp change, that before nothing."""
    if code in (CHANGES, SHARP):
        part = min(part, where)
    if answer == CHANGES or code == CHANGES:
        return CHANGES, part
    if answer == UNCERTAIN or code == UNCERTAIN:
        return UNCERTAIN, part
    return max(answer, code), part


@kernel
def switch(system: System, state: State, trial: StepTrial, bounds: Floats, a: int) -> int:
    """Status of contact a at the end of a step of one tick."""
    if state.status[a] == AWAY:
        return AWAY
    p = PLACES - 1
    delta, speed = trial.place[a, p] + system.interfaces[a]["offset"], trial.rate[a, p]
    margin = bounds[a, PLACE_ROUNDING]
    constant, by_depth, by_speed = sense(system, a)
    psi = constant + by_depth * delta + by_speed * speed
    clamps = system.interfaces[a]["tensile"] == 0 and system.interfaces[a]["closing"] > 0.0
    psi_margin = by_depth * margin + by_speed * bounds[a, RATE_ROUNDING]
    if state.status[a] == OPEN:
        if delta > margin:
            return CLOSED if psi > 0.0 or not clamps else CLAMPED
        return OPEN
    if state.status[a] == CLOSED:
        if clamps and psi < -psi_margin:
            return CLAMPED if delta > margin else OPEN
        if clamps and by_depth > 0.0:
            return CLOSED
        return OPEN if delta < -margin else CLOSED
    if delta < -margin:
        return OPEN
    return CLOSED if psi > psi_margin else CLAMPED


# ----------------------------------------------------------------------------------------------------------------------
# One trial step: its forces, its error, and whether a contact changes in it. Compiled by itself.
# ----------------------------------------------------------------------------------------------------------------------

REFUSED = -1  # a step whose error is too large, or whose forces were not found
ERROR, PART = 0, 1  # columns of what is found


class Workspace(NamedTuple):
    """Work space of an integration. trial : of its steps, with their work space. here : between two steps. bounds [m,
    4] : what interpolation can miss of an interface, and rounding. work [s + 4, n]. found [2] : of a trial step: its
    error over what is allowed, and the part of it before the first change of status.
    """

    trial: StepTrial
    here: Standing
    bounds: Matrix
    work: Matrix
    found: Vector


def collocation_workspace(system: System) -> Workspace:
    """Work space for integrations of a system of this size."""
    return Workspace(
        trial=step_workspace(system),
        here=standing_room(system),
        bounds=np.zeros((len(system.interfaces), 4)),
        work=np.zeros((STAGES + 4, len(system.omega))),
        found=np.zeros(2),
    )


@unit(seconds=6.0)
def attempt(
    now: float, level: int, system: System, state: State, tables: Tables, scratch: Workspace, tolerance: float
) -> int:
    """Try a step of tick 2^level from now on; what the watch over the contacts says of it, or REFUSED.

    One that is a tick long is taken whatever its error, as long as its forces were found.
    """
    error = try_step(now, level, system, state, tables, scratch.trial, tolerance)
    scratch.found[ERROR] = error
    if not error < np.inf or (error > 1.0 and level > 0):
        return REFUSED
    interpolation_errors(level, system, state, tables, scratch.trial, scratch.bounds)
    answer, part = watch(system, state, tables.rule, scratch.trial, scratch.bounds, scratch.here.loaded)
    scratch.found[PART] = part
    return answer


# ----------------------------------------------------------------------------------------------------------------------
# What pushes the modes on a grid of times: moments of the forces, from which their transform follows to the grid's
# own frequency.
# ----------------------------------------------------------------------------------------------------------------------

LONG = 8.0  # spacings of a step, of which a cell then sees little: two points in it are enough
OUTER, INNER = 0.06943184420297371, 0.33000947820757187  # Gauss points of four, and their weights
OF_OUTER, OF_INNER = 0.17392742256872692, 0.32607257743127305
OF_TWO = 0.21132486540518713  # of two


@kernel
def gather(t: float, h: float, rule: Rule, trial: StepTrial, record: RunRecord) -> None:
    """Add what the forces of a step from t to t + h push to moments [r, cells + 2]: the integrals of each force times a
    hat of the spacing's width around each time of the grid [N s]."""
    moments, spacing = record.moments, record.spacing[0]
    first, last = int(t / spacing), int((t + h) / spacing)
    last = min(last, moments.shape[1] - 2)
    if first >= last:
        for s in range(STAGES):
            at = (t + rule.nodes[s] * h) / spacing - first
            for a in range(len(moments)):
                push = rule.weights[s] * h * trial.forces[a, s]
                moments[a, first] += push * (1.0 - at)
                moments[a, first + 1] += push * at
        return
    low = 0.0
    for cell in range(first, last + 1):
        high = min(((cell + 1) * spacing - t) / h, 1.0)
        width = high - low
        if width <= 0.0:
            continue
        coarse = h > LONG * spacing
        for i in range(2 if coarse else 4):
            from_low, place, weight = _cell_point(i, coarse)
            theta = low + place * width if from_low else high - place * width
            _add_point((t + theta * h) / spacing - cell, theta, weight * width * h, cell, rule, trial, record)
        low = high


@kernel
def _cell_point(i: int, coarse: bool) -> tuple[bool, float, float]:
    """Gauss point i of a cell, of two or of four: whether from its low end, else from its high one, how far, and its
    weight; both of its length."""
    if coarse:
        return i == 0, OF_TWO, 0.5
    if i in (0, 3):
        return i == 0, OUTER, OF_OUTER
    return i == 1, INNER, OF_INNER


@kernel
def _add_point(
    at: float, theta: float, share: float, cell: int, rule: Rule, trial: StepTrial, record: RunRecord
) -> None:
    """What one point of a cell adds.

    Parameters
    ----------
    at : float
        Where it is in the cell.
    theta : float
        And in the step, of which it has a share [s].
    """
    total, moments, shares = 0.0, record.moments, record.shares
    for i in range(STAGES):
        distance = theta - rule.nodes[i]
        if distance == 0.0:  # beside it: interpolation there is to rounding
            distance = 1e-17
        # barycentric weights of the places without both ends
        shares[i] = rule.barycentric[i + 1] * rule.nodes[i] * (rule.nodes[i] - 1.0) / distance
        total += shares[i]
    for a in range(len(moments)):
        push = 0.0
        for i in range(STAGES):
            push += shares[i] * trial.forces[a, i]
        push *= share / total
        moments[a, cell] += push * (1.0 - at)
        moments[a, cell + 1] += push * at


# ----------------------------------------------------------------------------------------------------------------------
# The integration through time: steps of tau 2^level, aligned to their length, so that samples fall on step ends.
#
# A change of status ends a step one tick wide; the alignment then lets steps grow by no more than a factor of two each,
# which is the graded mesh that the onset of a contact (indentation^1.5, ^0.5) needs.
# ----------------------------------------------------------------------------------------------------------------------

ERROR_BUDGET = 0.1  # share of the tolerance that a step may spend
LEDGER_ROWS = 2048  # at most, while nothing acts


class CollocationSteps(NamedTuple):
    """How an integration chooses its steps. halvings : of the sampling interval to a tick. top_level : of the longest
    step. tolerance : of the error of a step. max_steps : tried at most. paced : tried between two looks at the
    progress."""

    halvings: int
    top_level: int
    tolerance: float
    max_steps: int
    paced: int


@unit(seconds=9.0)
def integrate(
    system: System, state: State, tables: Tables, scratch: Workspace, record: RunRecord, steps: CollocationSteps
) -> int:
    """Run to the end; returns how it ended; when, and the numbers of ledger rows and events, are in record.ended.

    A record without samples is of one interval of 2^halvings ticks, and keeps the first and the last ledger row only.
    """
    history, samples, here, trial = record.history, len(record.at), scratch.here, scratch.trial
    per_sample = 1 << steps.halvings
    end = max(samples, 1) * per_sample
    stride = max(end // LEDGER_ROWS, 1)
    top_level = _longest_kept(steps.top_level, stride, samples)
    initial = _begin(system, state, scratch, record)
    n_history, n_events = 1, log_changes(0.0, system, state, here.loaded, history[0], 0, record)
    blow = _strikes_at_start(system, state, record)
    t, level, hint, kink = 0, top_level, -1, 0
    last, tried, seen = 0, 0, 0
    while t < end:
        how, tried, seen = _progress(may_continue(record, steps.max_steps), tried + 1, seen, t, end, steps)
        if how != DONE:
            return ended(record, how, t * system.tick, n_history, n_events)
        kink = _next_kink(system, kink, t)
        limit = _limit(system, kink, hint, t, end)
        acting = _acts(system, (t + 0.5 * min(limit - t, per_sample)) * system.tick)
        # what a load puts in is kept as finely as what it moves
        level = min(level, _longest(t, limit - t, top_level), steps.halvings if acting else top_level)
        now, h = t * system.tick, system.tick * float(1 << level)
        _begin_trial(scratch)
        answer = attempt(now, level, system, state, tables, scratch, steps.tolerance)
        error, part = scratch.found[ERROR], scratch.found[PART]
        if answer == REFUSED:
            if level == 0:
                return ended(record, NO_FORCES, now, n_history, n_events)
            level = max(level - _levels_down(error), 0)
            continue
        if level > 0 and answer in (UNCERTAIN, CHANGES):  # until the change is known, or sharp
            if answer == CHANGES:
                hint = t + int(part * (1 << level))
            level -= 1
            continue
        if samples > 0 and t % per_sample == 0:
            store_state(t // per_sample, max(level - steps.halvings, 0), state, trial, record)
        _note_step(now, h, system, state, tables.rule, scratch, record)
        here.lost[len(system.interfaces) + MODES] += advance(
            level, system, tables, trial.forces, state.z, state.v, scratch.work
        )
        before, t = t, t + (1 << level)
        now = t * system.tick
        _arrive(before, t, system, state, scratch, record)
        moment = now
        if answer in (CHANGES, SHARP):
            moment = now - (1.0 - part) * h
            _switch_contacts(moment, system, state, scratch)
        has_blow = blow < len(system.strikes) and system.strikes[blow]["tick"] <= t
        if has_blow:
            fill_ledger_row(now, system, state, here.place, here.lost, history[n_history])
            store_row(n_history, state, record)
            n_history += 1
            blow = _strike_bodies(now, t, blow, system, state, here, record)
            n_events = _log_lifted(t, system, state, history[n_history - 1], n_events, record)
            if n_events == FULL:
                return ended(record, TOO_MANY_EVENTS, now, n_history, len(record.events))
            moment = now
        _act(t, system, state, here)
        if not balance_ledger_row(now, initial, system, state, here, history[n_history], record):
            return ended(record, NO_FORCES, now, n_history, n_events)
        n_events = log_changes(moment, system, state, here.loaded, history[n_history], n_events, record)
        if n_events == FULL:
            return ended(record, TOO_MANY_EVENTS, now, n_history, len(record.events))
        busy = (acting or _total(here.loaded) > 0.0) and t - last >= per_sample
        if samples > 0 and (busy or has_blow or t - last >= stride or t == end):
            store_row(n_history, state, record)
            n_history += 1
            last = t
        record.totals[STEPS] += 1.0
        if error < LONGER:
            level += 1
    return ended(record, DONE, end * system.tick, n_history, settle_events(record, n_events, len(system.interfaces)))


@kernel
def _begin(system: System, state: State, scratch: Workspace, record: RunRecord) -> float:
    """Put every interface into its first status and open the ledger; returns the total that it is held against.

    Contacts that close at once, preloaded contacts and links without a release time act; the rest is open, touching or
    not, and closes when the leading derivative of its indentation says so.
    """
    here = scratch.here
    here.lost[:], here.loaded[:], here.closed_at[:] = 0.0, 0.0, 0.0
    rows_now(system, state.z, state.v, here.place, here.rate)
    for a in range(len(system.interfaces)):
        place, rate = here.place[a], here.rate[a]
        state.status[a] = OPEN
        if system.interfaces[a]["kind"] == LINK:
            if system.interfaces[a]["release"] <= 0:
                state.status[a] = CLOSED
        elif system.interfaces[a]["release"] > 0:
            state.status[a] = AWAY
        else:
            update_status(system, state, a, place, rate, 0.0)
            here.loaded[a] = 1.0 if state.status[a] == CLOSED and system.interfaces[a]["preload"] == 0.0 else 0.0
        if state.status[a] == CLOSED:
            state.force[a] = net_force(system, state, a, place, rate)
    for a in range(len(here.rate)):
        state.pace[a] = abs(here.rate[a])
    initial = start_ledger(system, state, here, record)
    peaks_at_start(system, state, here.place, here.rate, record)
    return initial


@kernel
def _progress(how: int, tried: int, seen: int, t: int, end: int, steps: CollocationSteps) -> tuple[int, int, int]:
    """How the integration goes on: STALLS where it came so little farther since the last look (seen) that all steps are
    gone before the end; steps tried since the last look, and where that was."""
    if tried < steps.paced:
        return how, tried, seen
    stalls = how == DONE and t - seen < steps.paced * (end / steps.max_steps)
    return STALLS if stalls else how, 0, t


@kernel
def _strikes_at_start(system: System, state: State, record: RunRecord) -> int:
    """Book the blows at t = 0, which are the start itself; returns the number of the next one."""
    blow = 0
    while blow < len(system.strikes) and system.strikes[blow]["tick"] == 0:
        log_initial_blow(system, blow, state, record)
        blow += 1
    return blow


@kernel
def _longest_kept(top: int, stride: int, samples: int) -> int:
    """Level of the longest step, of which a ledger row is the end, for rows that are about so many ticks apart; without
    samples the ledger has no rows on the way."""
    while samples > 0 and top > 0 and (1 << top) > 4 * stride:
        top -= 1
    return top


@kernel
def _next_kink(system: System, kink: int, t: int) -> int:
    """Number of the first kink after t."""
    while kink < len(system.kinks) and system.kinks[kink] <= t:
        kink += 1
    return kink


@kernel
def _limit(system: System, kink: int, hint: int, t: int, end: int) -> int:
    """Where the next step must end: at a kink, or at the place of a change that a trial has shown (hint)."""
    limit = end
    if kink < len(system.kinks):
        limit = min(limit, system.kinks[kink])
    if hint > t:
        limit = min(limit, hint)
    return limit


@kernel
def _begin_trial(scratch: Workspace) -> None:
    """A trial step begins where the rows are."""
    for a in range(len(scratch.here.place)):
        scratch.trial.place[a, 0], scratch.trial.rate[a, 0] = scratch.here.place[a], scratch.here.rate[a]


@kernel
def _levels_down(error: float) -> int:
    """How much shorter a step must be whose error is too large: it falls with a high power of the length."""
    return 1 if error < 300.0 else (2 if error < 1e6 else 4)


@kernel
def _note_step(
    t: float, h: float, system: System, state: State, rule: Rule, scratch: Workspace, record: RunRecord
) -> None:
    """What a step that is taken leaves in the record, before the state moves: peaks, moments, events that count, and
    what it dissipated."""
    peaks(t, h, system, state, rule, scratch.trial, record)
    travels(h, system, state, rule, scratch.trial, record)
    if record.moments.shape[1] > 0:
        gather(t, h, rule, scratch.trial, record)
    _confirm_step(system, state, scratch.trial, scratch.bounds, record)
    integrate_losses(h, system, state, rule, scratch.trial, scratch.here.lost)


@kernel
def _arrive(before: int, t: int, system: System, state: State, scratch: Workspace, record: RunRecord) -> None:
    """Rows as they are at the end of a step, and the largest speed that each of them had."""
    if before < record.late_at[0] <= t:
        copy_to(record.late, state.v)
    rows_now(system, state.z, state.v, scratch.here.place, scratch.here.rate)
    for a in range(len(system.rows)):
        for p in range(PLACES):
            state.pace[a] = max(state.pace[a], abs(scratch.trial.rate[a, p]))


@kernel
def _switch_contacts(moment: float, system: System, state: State, scratch: Workspace) -> None:
    """Status of every contact at the end of a step in which one of them changes.

    Parameters
    ----------
    moment : float
        When.
    """
    here, trial, bounds = scratch.here, scratch.trial, scratch.bounds
    for a in range(len(here.place)):
        trial.place[a, PLACES - 1], trial.rate[a, PLACES - 1] = here.place[a], here.rate[a]
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] != LINK:
            before = here.loaded[a]
            state.status[a] = switch(system, state, trial, bounds, a)
            here.loaded[a] = _is_loaded(system, state, a, here, least_excess(system, bounds, a))
            here.closed_at[a] = moment if here.loaded[a] > before else here.closed_at[a]


@kernel
def _strike_bodies(
    now: float, t: int, blow: int, system: System, state: State, here: Standing, record: RunRecord
) -> int:
    """Let all bodies strike whose blow is due; returns the number of the next one."""
    while blow < len(system.strikes) and system.strikes[blow]["tick"] <= t:
        apply_blow(now, t, blow, system, state, here, record)
        blow += 1
    return blow


@kernel
def _log_lifted(t: int, system: System, state: State, row: Floats, n_events: int, record: RunRecord) -> int:
    """Log that contacts open whose body was lifted off just now; returns the number of events, FULL where they are too
    many.

    Parameters
    ----------
    row : Floats
        Of the ledger, before the blow.
    """
    for a in range(len(system.interfaces)):
        if record.closed[a] > 0.0 and record.latest[a] >= 0 and system.strikes[record.latest[a]]["tick"] == t:
            if n_events == len(record.events):
                return FULL
            log_event(record, n_events, a, OPENS, LIFTED, row)
            part_energies(system, state, record.event_rows[n_events])
            n_events += 1
            record.closed[a] = 0.0
    return n_events


@kernel
def _act(t: int, system: System, state: State, here: Standing) -> None:
    """Release links whose time has come, and note the force of every interface that acts."""
    for a in range(len(system.interfaces)):
        link = system.interfaces[a]["kind"] == LINK
        if link and state.status[a] == OPEN and system.interfaces[a]["release"] <= t:
            state.status[a], state.rest[a] = CLOSED, here.place[a]
        acts = state.status[a] == CLOSED
        state.force[a] = net_force(system, state, a, here.place[a], here.rate[a]) if acts else 0.0


@kernel
def _acts(system: System, now: float) -> bool:
    """Whether a load other than the weight of bodies pushes."""
    acting = 0
    for i in range(len(system.loads)):
        if system.loads[i]["kind"] != CONSTANT and load_at(system, i, now) != 0.0:
            acting += 1
    return acting > 0


@kernel
def _total(values: Floats) -> float:
    total = 0.0
    for i in range(len(values)):
        total += values[i]
    return total


@kernel
def _longest(t: int, left: int, top: int) -> int:
    """Level of the longest step from t that is aligned to its length and fits into the room."""
    level = 0
    while level < top and (t >> level) & 1 == 0 and (2 << level) <= left:
        level += 1
    return level


@kernel
def _is_loaded(system: System, state: State, a: int, here: Standing, least: float) -> float:
    """Whether a contact counts as closed: it has a force, or one above its preload; as before where that differs by
    less than can be known."""
    if state.status[a] != CLOSED:
        return 0.0
    if system.interfaces[a]["preload"] == 0.0:
        return 1.0
    excess = net_force(system, state, a, here.place[a], here.rate[a])
    if abs(excess) <= least:
        return float(here.loaded[a])
    return 1.0 if excess > 0.0 else 0.0


@kernel
def _confirm_step(system: System, state: State, trial: StepTrial, bounds: Floats, record: RunRecord) -> None:
    """Let the events count whose contacts move beyond rounding in this step."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK:
            continue
        offset = system.interfaces[a]["offset"]
        still, moving = (
            bounds[a, PLACE_ROUNDING] / DISPLACEMENT_ROUNDING,
            bounds[a, RATE_ROUNDING] / DISPLACEMENT_ROUNDING,
        )
        record.size[a, OF_PLACE] = max(record.size[a, OF_PLACE], still + abs(offset))
        record.size[a, OF_SPEED] = max(record.size[a, OF_SPEED], moving)
        if record.newest[a] >= 0:
            for p in range(PLACES):
                if confirm(system, state, a, trial.place[a, p] + offset, trial.rate[a, p], record):
                    break


def levels_for(halvings: int) -> int:
    """Number of step lengths: from a tick to the longest step."""
    return halvings + LONGEST_DOUBLINGS + 1


# ----------------------------------------------------------------------------------------------------------------------
# One run of the integration for laws that are not linear, at a tolerance.
# ----------------------------------------------------------------------------------------------------------------------

MAX_STEPS = 20_000_000
STEPS_BETWEEN_CHECKS = (
    200_000  # steps tried between two looks at the progress, at least: enough for thousands of closings
)
WORK_BETWEEN_CHECKS = 5e7  # and their number times SELF + n: about 4 s where the modes are not thousands
SELF = 30  # what a step costs beside its coordinates, 2.1 us against 0.07 us for each of them


class Ended(NamedTuple):
    """How an integration ended, when [s], and how many ledger rows and events it left."""

    how: int
    when: float
    rows: int
    events: int

    @staticmethod
    def of(how: int, record: RunRecord) -> Ended:
        """What an integration that returned `how` has noted."""
        when, rows, events = record.ended
        return Ended(how, float(when), int(rows), int(events))


def state_at_start(compiled: Compiled) -> State:
    """The state that a scene starts from, before contacts close."""
    m, r = len(compiled.system.interfaces), len(compiled.system.rows)
    return State(
        z=compiled.start[0].copy(),
        v=compiled.start[1].copy(),
        status=np.zeros(m, dtype=np.int64),
        rest=np.zeros(m),
        pace=np.zeros(r),
        force=np.zeros(m),
    )


def collocate(
    compiled: Compiled, tolerance: float, tables: Tables, state: State, record: RunRecord, finer: int = 0
) -> Ended:
    """March to the end of the record; state and record are filled on the way.

    Parameters
    ----------
    tables : Tables
        Of all levels.
    finer : int
        How often the longest step is halved, which a loose tolerance takes wherever it can.
    """
    system = compiled.system
    top_level = levels_for(compiled.halvings) - 1
    if finer:
        end = compiled.n_samples << compiled.halvings
        longest = 4 * max(end // LEDGER_ROWS, 1)  # as the integration has it, for its ledger
        top_level = max(min(top_level, longest.bit_length() - 1) - finer, 0)
    steps = CollocationSteps(compiled.halvings, top_level, tolerance * ERROR_BUDGET, MAX_STEPS, report_steps(system))
    how = integrate(system, state, tables, collocation_workspace(system), record, steps)
    return Ended.of(how, record)


def report_steps(system: System) -> int:
    """Steps tried between two looks at the progress of a run alone: at a pace at which MAX_STEPS are too few it ends.

    One look takes some seconds, so that a run which gets nowhere does not take minutes to say so; a burst of collisions
    may still be that slow for a hundredth of the window or more.
    """
    return max(int(WORK_BETWEEN_CHECKS / (SELF + len(system.omega))), STEPS_BETWEEN_CHECKS)
