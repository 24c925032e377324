"""simulate_batch: thousands of impacts on one basis, a row of metrics each."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, Integers
from femstruct.errors import Finding
from femstruct.impact.batch_march import RESIDUAL, SEPARATED, STATUS, STEPS, Fleet, Variation, run_some, variation
from femstruct.impact.blow_by_blow import (
    NOT_TRUSTED,
    JudgedRun,
    drifts,
    left_out_finding,
    lifted_finding,
    run_findings,
    unresolved,
)
from femstruct.impact.contact_events import DONE, TROUBLE
from femstruct.impact.energies import BODIES, STRUCTURE, TIME
from femstruct.impact.response import Endings, Flags, Outcome, outcomes_of
from femstruct.impact.scene import Clock, Scene
from femstruct.laws.registry import DOUBTS
from femstruct.modal.basis import ModalBasis

# ----------------------------------------------------------------------------------------------------------------------
# What is known of many runs of one scene: columns of numbers, how each ended, and what speaks against it.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Energies:
    """Energies of all runs at one instant of each [runs], in J: terms of `EnergyBalance`, nan where there is none."""

    t: Floats
    bodies: Mapping[str, Floats]
    structure: Floats
    contacts: Mapping[str, Floats]
    links: Mapping[str, Floats]
    lost_modes: Floats
    lost_contacts: Mapping[str, Floats]
    lost_links: Mapping[str, Floats]
    work: Floats
    blows: Floats


@dataclass(frozen=True, eq=False)
class Lifts:
    """Blows of a body that fall into the window; how often it is lifted off while its contact acts [runs], lying still
    left out; number of the blow after which it first is, the contact force then [N], and for how long it was closed [s]
    (nan where never)."""

    blows: int
    count: Floats
    number: Floats
    force: Floats
    since: Floats


@dataclass(frozen=True, eq=False)
class Batch:
    """Metrics of many runs of one scene, each [runs]; a run that failed has nan, and says why in `trouble`.

    basis, clock; tick [s] : what times of events are resolved to, zero where all runs took the exact integration;
    varied : the scene as given and the columns of numbers that took its place.
    status : 0 for a run that reached its end. outcome : None for one that did not. steps : of the integration.
    peak_force [N], peak_time [s], deepest indentation [m], closings, first_open [s] (nan if never), shortest [s] of its
    closings (infinite where none ended) and, for a contact that is closed at the end, closed_since [s], by contact.
    separated : whether the collision ended; at_separation, end : energies.
    end_velocity [m/s], travel [m] : of the bodies; travel is the largest displacement either way.
    residual : of the energy ledger, as in `EnergyLedger`. lifts : by body that strikes several times.
    flags [runs] by the code of a finding: for which runs it holds; "failed" is that of a run with a status.
    heard [runs, x] : what a listener made of each, of no columns without one.

    What is said against run i is `findings(i)`; `simulate(batch.basis, batch.scene(i), batch.clock)` has its histories.
    The example of `simulate_batch` reads one.
    """

    basis: ModalBasis
    clock: Clock
    tick: float
    varied: Variation
    status: Integers
    outcome: tuple[Outcome | None, ...]
    steps: Integers
    peak_force: Mapping[str, Floats]
    peak_time: Mapping[str, Floats]
    deepest: Mapping[str, Floats]
    closings: Mapping[str, Floats]
    first_open: Mapping[str, Floats]
    shortest: Mapping[str, Floats]
    closed_since: Mapping[str, Floats]
    separated: Floats
    at_separation: Energies
    end: Energies
    end_velocity: Mapping[str, Floats]
    travel: Mapping[str, Floats]
    residual: Floats
    lifts: Mapping[str, Lifts]
    flags: Mapping[str, Flags]
    at_receivers: Floats = field(default_factory=lambda: np.zeros((0, 0)))

    def scene(self, i: int) -> Scene:
        """The scene of run i, for `simulate`: the same impact with its histories."""
        return self.varied(i)

    def trouble(self, i: int) -> str:
        """Why run i failed, "" if it did not."""
        return TROUBLE.get(int(self.status[i]), "")

    @property
    def severe(self) -> Flags:
        """Whether a run has a finding that says not to trust it [runs]."""
        drifting: Flags = drifts(self.residual, NOT_TRUSTED)
        of_laws = [self.flags[code] for code, severe in DOUBTS.items() if severe]
        severe: Flags = np.logical_or.reduce([self.flags["failed"], drifting, *of_laws])
        return severe

    def findings(self, i: int) -> tuple[Finding, ...]:
        """Reasons to trust run i less, in the words of `simulate`.

        Those that take histories or samples are not among them (a structure that still rings, few samples in a contact,
        rest between blows): `simulate(basis, batch.scene(i), clock)` has them.
        """
        if trouble := self.trouble(i):
            return (
                Finding("failed", f"Run {i} has no result: {trouble}.", {"status": float(self.status[i])}, severe=True),
            )
        outcome, scene = self.outcome[i], self.scene(i)
        assert outcome is not None
        closed = {name: float(since[i]) for name, since in self.closed_since.items() if not np.isnan(since[i])}
        run = JudgedRun(
            float(self.residual[i]),
            outcome,
            self.clock.duration,
            self.tick,
            closed,
            {name: float(deepest[i]) for name, deepest in self.deepest.items()},
            {name: float(shortest[i]) for name, shortest in self.shortest.items()},
        )
        found = list(run_findings(scene.contacts, run))
        for plan in scene.blows:
            lifts = self.lifts[plan.body]
            if lifts.count[i]:
                first = (int(lifts.count[i]), int(lifts.number[i]), float(lifts.force[i]), float(lifts.since[i]))
                found.append(lifted_finding(plan, *first))
            if lifts.blows < plan.count:
                found.append(left_out_finding(plan, lifts.blows, self.clock.duration))
        return tuple(found)


def batch_of(basis: ModalBasis, clock: Clock, varied: Variation, fleet: Fleet, table: Floats) -> Batch:
    """The columns of the table with names."""
    table.flags.writeable = False
    rows = _Rows(table, fleet, tuple(body.name for body in varied.scene.bodies))
    at, contacts = fleet.columns, fleet.compiled.contacts
    status = table[:, STATUS].astype(np.int64)
    closed: dict[str, Flags] = {
        name: np.asarray((one > 0.0).any(axis=1)) for name, one in rows.sides(at.closed).items()
    }
    endings = Endings(
        fleet.clock.duration,
        last={name: np.fmax.reduce(one, axis=1) for name, one in rows.sides(at.last).items()},
        closed=closed,
        gain=rows.of_bodies(at.gain),
    )
    outcomes = outcomes_of(varied.scene, endings, len(table), varied.columns)
    outcome = tuple(one if ended else None for one, ended in zip(outcomes, status == DONE, strict=True))
    deepest = {name: one.max(axis=1) for name, one in rows.sides(at.deepest).items()}
    shortest = {name: one.min(axis=1) for name, one in rows.sides(at.shortest).items()}
    lifts = {plan.body: rows.lifts(number, plan.body) for number, plan in enumerate(varied.scene.blows)}
    tick = 0.0 if fleet.exact else fleet.compiled.system.tick
    flags = _flags(varied.scene, outcome, table[:, RESIDUAL], deepest, shortest, tick, lifts)
    batch = Batch(
        basis=basis,
        clock=clock,
        tick=tick,
        varied=varied,
        status=status,
        outcome=outcome,
        steps=table[:, STEPS].astype(np.int64),
        peak_force=rows.at_largest(at.peak),
        peak_time=rows.at_largest(at.peak_time),
        deepest=deepest,
        closings={name: one.sum(axis=1) for name, one in rows.sides(at.closings).items()},
        first_open={name: _earliest(one) for name, one in rows.sides(at.first_open).items()},
        shortest=shortest,
        closed_since={name: np.where(closed[name], endings.last[name], np.nan) for name in contacts},
        separated=table[:, SEPARATED],
        at_separation=rows.energies(at.separation),
        end=rows.energies(at.end),
        end_velocity=rows.of_bodies(at.velocity),
        travel=rows.of_bodies(at.travel),
        residual=table[:, RESIDUAL],
        lifts=lifts,
        flags=flags,
    )
    for whole in (status, batch.steps, *flags.values()):
        whole.flags.writeable = False
    return batch


@dataclass(frozen=True, eq=False)
class _Rows:
    """The table of a batch [runs, columns], read by names of contacts, links and bodies."""

    table: Floats
    fleet: Fleet
    bodies: tuple[str, ...]

    def sides(self, first: int) -> dict[str, Floats]:
        """Columns of the contacts' sides [runs, sides]; a stop has two."""
        return {name: self.table[:, [first + a for a in rows]] for name, rows in self.fleet.compiled.contacts.items()}

    def at_largest(self, first: int) -> dict[str, Floats]:
        """Of the side on which the force is largest."""
        largest = {name: one.argmax(axis=1)[:, None] for name, one in self.sides(self.fleet.columns.peak).items()}
        return {name: np.take_along_axis(one, largest[name], axis=1)[:, 0] for name, one in self.sides(first).items()}

    def of_bodies(self, first: int) -> dict[str, Floats]:
        return {name: self.table[:, first + i] for i, name in enumerate(self.bodies)}

    def lifts(self, number: int, body: str) -> Lifts:
        """Of the plan of blows of this number."""
        at, i = self.fleet.columns, self.bodies.index(body)
        columns = (at.lifts, at.lift_number, at.lift_force, at.lift_since)
        blows = int((self.fleet.compiled.system.strikes["over"] == number).sum())
        return Lifts(blows, *(self.table[:, first + i] for first in columns))

    def energies(self, first: int) -> Energies:
        compiled = self.fleet.compiled
        interfaces = len(compiled.system.interfaces)
        held = first + BODIES + len(self.bodies)
        lost = held + interfaces + 1
        return Energies(
            t=self.table[:, first + TIME],
            bodies=self.of_bodies(first + BODIES),
            structure=self.table[:, first + STRUCTURE],
            contacts={name: one.sum(axis=1) for name, one in self.sides(held).items()},
            links={name: self.table[:, held + a] for name, a in compiled.links.items()},
            lost_modes=self.table[:, held + interfaces],
            lost_contacts={name: one.sum(axis=1) for name, one in self.sides(lost).items()},
            lost_links={name: self.table[:, lost + a] for name, a in compiled.links.items()},
            work=self.table[:, lost + interfaces],
            blows=self.table[:, lost + interfaces + 1],
        )


def _earliest(times: Floats) -> Floats:
    """The least of the sides [runs, sides] that is not nan; nan where all are."""
    found: Floats = np.fmin.reduce(times, axis=1)
    return found


def _flags(
    scene: Scene,
    outcome: Sequence[Outcome | None],
    residual: Floats,
    deepest: Mapping[str, Floats],
    shortest: Mapping[str, Floats],
    tick: float,
    lifts: Mapping[str, Lifts],
) -> dict[str, Flags]:
    """Which runs have which finding; one that failed has no other."""
    failed = np.array([one is None for one in outcome])
    too_short, lifted, left_out = (np.zeros(len(failed), dtype=bool) for _ in range(3))
    doubts = {code: np.zeros(len(failed), dtype=bool) for code in DOUBTS}
    for contact in scene.contacts:
        too_short |= unresolved(shortest[contact.name], tick, residual)
        for code, depth in contact.law.doubted_from.items():
            doubts[code] |= deepest[contact.name] > depth
    for plan in scene.blows:
        lifted |= lifts[plan.body].count > 0.0
        left_out |= lifts[plan.body].blows < plan.count
    found = {
        "energy-drift": drifts(residual),
        "contact-closed-at-end": np.array([one is Outcome.CLOSED_AT_END for one in outcome]),
        "contact-unresolved": too_short,
        **doubts,
        "lifted-in-contact": lifted,
        "blows-left-out": left_out,
    }
    return {"failed": failed, **{code: flags & ~failed for code, flags in found.items()}}


# ----------------------------------------------------------------------------------------------------------------------
# Thousands of impacts on one basis, a row of numbers each.
# ----------------------------------------------------------------------------------------------------------------------

CHUNK, EXACT_CHUNK = 64, 512  # runs between two looks at the keyboard; those of the exact integration are short
CHUNKS = 4  # of every thread, at least, where runs differ in length
RUNS_WITH_FORCES = 8  # runs whose pushes are in memory at once, of every thread
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Listener:
    """Who is told what pushes the modes in every run.

    spacing [s], cells : of a grid of times from 0. width : how many numbers it makes of a run. of : makes them,
    [c, width], of moments [c, r, cells + 2], the integrals of each force times a hat of the spacing's width around each
    time of the grid [N s], and of the modes' shares [r, k] where these forces act.
    """

    spacing: float
    cells: int
    width: int
    of: Callable[[Floats, Floats], Floats]


def simulate_batch(
    basis: ModalBasis,
    scene: Scene,
    clock: Clock,
    vary: Mapping[str, ArrayLike],
    threads: int | None = None,
    progress: Progress = lambda done, runs: None,
    listener: Listener | None = None,
) -> Batch:
    """Metrics of many impacts that differ in numbers of their bodies, contacts, links and loads.

    Parameters
    ----------
    clock : Clock
        As for `simulate`; nothing is sampled, so that the sampling rate plays no part.
    vary : Mapping[str, ArrayLike]
        Columns [runs] by name: BODY.mass, BODY.velocity, CONTACT.gap, CONTACT.preload, what the contact's law has of
        stiffness, damping, exponent, cubic and dissipation, LINK.stiffness, LINK.closing, LINK.opening, LINK.preload,
        and LOAD.amplitude of a half sine.
    threads : int | None
        All cores if None. The results do not depend on it.
    progress : Progress
        Told how many runs are done, of how many.
    listener : Listener | None
        Makes further numbers of every run, `Batch.at_receivers`, of what pushes the modes.

    Raises
    ------
    InputError
        For unknown names, and columns of unequal length or none; FemstructError for values that a body, contact or link
        refuses. A run that fails has its row, and raises nothing.

    Notes
    -----
    The integrations of `simulate`. All runs take the exact one when the stiffest laws and the lightest bodies of any
    run allow it. Otherwise steps are longer, since nothing is sampled; an event ends a step so short that the force in
    it is below the tolerance. The tables of the modes are made once for all runs. A row is of the whole window: blow by
    blow tells `simulate`. Runs are judged as by `simulate`: `Batch.outcome`, `Batch.flags`, `Batch.findings`.

    Examples
    --------
    A ball hits a wall through a spring at three speeds; the force is v sqrt(k m), the contact half a period:

    >>> from femstruct.impact.scene import GROUND, Body, Contact
    >>> from femstruct.laws.linear import Linear
    >>> from femstruct.modal.closed_form import given_modes
    >>> wall = Contact("wall", upper="ball", lower=GROUND, law=Linear(np.pi**2))
    >>> scene = Scene((Body("ball", 1.0, -1.0),), (wall,))
    >>> batch = simulate_batch(given_modes([], [], {})[0], scene, Clock(2.0, 100.0), {"ball.velocity": [-1, -2, -3]})
    >>> (batch.peak_force["wall"] / np.pi).round(9).tolist(), batch.first_open["wall"].round(9).tolist()
    ([1.0, 2.0, 3.0], [1.0, 1.0, 1.0])
    """
    varied = variation(scene, vary)
    # without samples the end of the window is the only one
    window = replace(clock, duration=max(round(clock.duration * clock.sampling), 1) / clock.sampling)
    window = replace(window, sampling=1.0 / window.duration)
    fleet = Fleet.of(basis, varied, window, with_receivers=listener is not None)
    received = np.empty((varied.runs, 0 if listener is None else listener.width))
    table, stop = np.empty((varied.runs, fleet.columns.width)), np.zeros(1, dtype=np.int64)
    workers, done = threads or os.cpu_count() or 1, 0
    chunk = min(EXACT_CHUNK, -(-varied.runs // workers))
    if not fleet.exact:
        chunk = min(CHUNK, -(-varied.runs // (CHUNKS * workers)))
    if listener is not None:
        chunk = min(chunk, RUNS_WITH_FORCES)
    starts = range(0, varied.runs, chunk)

    def run(start: int) -> None:
        some = slice(start, start + chunk)
        if listener is None:
            run_some(fleet, start, table[some], stop)
            return
        moments = run_some(fleet, start, table[some], stop, listener.cells, listener.spacing)
        system = fleet.compiled.system
        received[some] = listener.of(moments, system.sign[:, None] * system.rows[:, : system.n_modes])

    with ThreadPoolExecutor(workers) as pool:
        jobs = {pool.submit(run, start): start for start in starts}
        try:
            for job in as_completed(jobs):
                job.result()
                done += len(table[jobs[job] : jobs[job] + chunk])
                progress(done, varied.runs)
        except BaseException:
            stop[0] = 1
            pool.shutdown(cancel_futures=True)
            raise
    return replace(batch_of(basis, clock, varied, fleet, table), at_receivers=received)
