"""What is kept of a run: samples at their own times whatever the steps, peak forces, ledger rows, events."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.impact.compiled import kernel
from femstruct.impact.energy import ledger_width
from femstruct.impact.flow import drift
from femstruct.impact.forces import CLOSED, State, dot, law, load_at, net_force
from femstruct.impact.propagate import Trial
from femstruct.impact.rule import STAGES, Rule
from femstruct.impact.system import LINK, System
from femstruct.impact.tables import Tables, tabulate

MOST_EVENTS = 500_000


class Record(NamedTuple):
    """What is kept of a run.

    z, v [nt, n] at the samples; push [nt, r] : forces of all rows as they act on the coordinates; force, place [nt, m]
    of the interfaces. peak [m, 2] : force and its time; shortest [m] : least time from closing to opening [s].
    totals : [0] steps, [1] trials, [2] largest |total - start|, [3] largest |work|, then whether each contact counts
    as closed. history : ledger rows; events : interface, what, whether all are open then; event_rows : their ledger
    rows.
    """

    z: Floats
    v: Floats
    push: Floats
    force: Floats
    place: Floats
    peak: Floats
    shortest: Floats
    totals: Floats
    history: Floats
    events: Integers
    event_rows: Floats


def room_for(system: System, n_samples: int) -> Record:
    """Empty records of a run; memory is touched only where something is written.

    The history takes at most a row a sample while a contact is closed or a load acts, and 2048 more.
    """
    n, m, width = len(system.omega), len(system.interfaces), ledger_width(system)
    return Record(
        z=np.empty((n_samples, n)),
        v=np.empty((n_samples, n)),
        push=np.empty((n_samples, len(system.rows))),
        force=np.empty((n_samples, m)),
        place=np.empty((n_samples, m)),
        peak=np.zeros((m, 2)),
        shortest=np.full(m, np.inf),
        totals=np.zeros(4 + m),
        history=np.empty((n_samples + 2100, width)),
        events=np.empty((MOST_EVENTS, 3), dtype=np.int64),
        event_rows=np.empty((MOST_EVENTS, width)),
    )


@kernel
def inner_samples(t: int, level: int, halvings: int, system: System, state: State, rule: Rule, tables: Tables,
                   trial: Trial, record: Record, work: Floats) -> None:  # fmt: skip
    """Samples strictly inside a long step: the modes go through it in pieces, under the same polynomial forces."""
    if level <= halvings:
        return
    pieces = 1 << (level - halvings)
    if not tables.ready[halvings]:
        tabulate(halvings, system.tick * 2.0**halvings, system, rule, tables)
    z, v = state.z.copy(), state.v.copy()
    forces, modal = np.zeros_like(trial.forces), np.zeros_like(trial.modal)
    first = t >> halvings
    for j in range(pieces - 1):
        piece = rule.pieces[pieces - 1 + j]
        for a in range(len(forces)):
            for p in range(STAGES):
                total = 0.0
                for s in range(STAGES):
                    total += piece[p, s] * trial.forces[a, s]
                forces[a, p] = total
        for i in range(modal.shape[1]):
            for p in range(STAGES):
                total = 0.0
                for s in range(STAGES):
                    total += piece[p, s] * trial.modal[s, i]
                modal[p, i] = total
        drift(halvings, system, tables, forces, modal, z, v, work)
        sample(first + j + 1, (t + ((j + 1) << halvings)) * system.tick, system, state, z, v, record)


@kernel
def sample(index: int, now: float, system: System, state: State, z: Floats, v: Floats, record: Record) -> None:
    """Write one sample: coordinates, rates, what pushes them, and the interfaces' forces as they are felt."""
    m = len(system.interfaces)
    for a in range(len(system.rows)):
        if a < m:
            x, u = dot(system.rows[a], z), dot(system.rows[a], v)
            net = net_force(system, state, a, x, u)
            record.place[index, a] = x
            record.force[index, a] = (
                net if system.interfaces[a]["kind"] == LINK else net + system.interfaces[a]["preload"]
            )
        else:
            net = load_at(system, a - m, now)
        record.push[index, a] = system.sign[a] * net
    for i in range(len(z)):
        record.z[index, i], record.v[index, i] = z[i], v[i]


@kernel
def peaks_at_start(system: System, state: State, place: Floats, rate: Floats, record: Record) -> None:
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] != LINK and state.status[a] == CLOSED:
            record.peak[a, 0] = law(system, a, place[a] + system.interfaces[a]["offset"], rate[a])[0]


@kernel
def peaks(t: float, h: float, system: System, state: State, rule: Rule, trial: Trial, record: Record) -> None:
    """Largest force of each contact from the polynomials of the step: bracketed on the nodes, then golden section."""
    for a in range(len(system.interfaces)):
        if system.interfaces[a]["kind"] == LINK or state.status[a] != CLOSED:
            continue
        largest, at = -np.inf, 0
        for p in range(STAGES):
            if trial.forces[a, p] > largest:
                largest, at = trial.forces[a, p], p
        start, end = 0.0, 0.0
        for p in range(STAGES):
            start += rule.at_start[p] * trial.forces[a, p]
            end += rule.at_end[p] * trial.forces[a, p]
        largest = max(largest, start, end) + system.interfaces[a]["preload"]
        if largest < 0.9 * record.peak[a, 0]:
            continue
        low, high = rule.places[at], rule.places[at + 2]
        golden = 0.6180339887498949
        for _ in range(45):
            left, right = high - golden * (high - low), low + golden * (high - low)
            if _polynomial(trial.forces[a], left, rule) > _polynomial(trial.forces[a], right, rule):
                high = right
            else:
                low = left
        place = 0.5 * (low + high)
        force = _polynomial(trial.forces[a], place, rule) + system.interfaces[a]["preload"]
        for value, where in (
            (force, place),
            (start + system.interfaces[a]["preload"], 0.0),
            (end + system.interfaces[a]["preload"], 1.0),
        ):
            if value > record.peak[a, 0]:
                record.peak[a, 0], record.peak[a, 1] = value, t + where * h


@kernel
def _polynomial(values: Floats, theta: float, rule: Rule) -> float:
    """Lagrange's form through the Gauss nodes."""
    top, bottom = 0.0, 0.0
    for i in range(STAGES):
        distance = theta - rule.nodes[i]
        if distance == 0.0:
            return float(values[i])
        # barycentric weights of the places without both ends
        weight = rule.barycentric[i + 1] * (rule.nodes[i]) * (rule.nodes[i] - 1.0) / distance
        top += weight * values[i]
        bottom += weight
    return top / bottom
