"""What is known of many runs of one scene: columns of numbers, how each ended, and what speaks against it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import Finding
from femstruct.impact.batch.batch_march import RESIDUAL, SEPARATED, STATUS, STEPS
from femstruct.impact.batch.fleet import Fleet
from femstruct.impact.batch.vary import Variation
from femstruct.impact.engine.booking import DONE, TROUBLE
from femstruct.impact.engine.energy import BODIES, STRUCTURE, TIME
from femstruct.impact.laws.registry import DOUBTS
from femstruct.impact.result.blow_by_blow import left_out_finding, lifted_finding
from femstruct.impact.result.contact_findings import (
    NOT_TRUSTED,
    Measured,
    drifts,
    run_findings,
    unresolved,
)
from femstruct.impact.result.outcome import Endings, Flags, outcomes_of
from femstruct.impact.result.response import Outcome
from femstruct.impact.scene.bodies import Clock, Scene
from femstruct.modal.basis import ModalBasis


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

    basis, clock; tick [s] : what times of events are resolved to, zero where all runs took the exact march;
    varied : the scene as given and the columns of numbers that took its place.
    status : 0 for a run that reached its end. outcome : None for one that did not. steps : of the march.
    peak_force [N], peak_time [s], deepest indentation [m], closings, first_open [s] (nan if never), shortest [s] of its
    closings (infinite where none ended) and, for a contact that is closed at the end, closed_since [s], by contact.
    separated : whether the collision ended; at_separation, end : energies.
    end_velocity [m/s], travel [m] : of the bodies; travel is the largest displacement either way.
    residual : of the energy ledger, as in `EnergyLedger`. lifts : by body that strikes several times.
    flags [runs] by the code of a finding: for which runs it holds; "failed" is that of a run with a status.

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
        """Reasons to believe run i less, in the words of `simulate`.

        Those that take histories or samples are not among them (a structure that still rings, few samples in a contact,
        rest between blows): `simulate(basis, batch.scene(i), clock)` has them.
        """
        if told := self.trouble(i):
            return (
                Finding("failed", f"Run {i} has no result: {told}.", {"status": float(self.status[i])}, severe=True),
            )
        outcome, scene = self.outcome[i], self.scene(i)
        assert outcome is not None
        closed = {name: float(since[i]) for name, since in self.closed_since.items() if not np.isnan(since[i])}
        run = Measured(
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
    compiled, at = fleet.compiled, fleet.columns
    m, bodies = len(compiled.system.interfaces), [body.name for body in varied.scene.bodies]
    table.flags.writeable = False
    status = table[:, STATUS].astype(np.int64)
    peaks = {name: [at.peak + a for a in rows] for name, rows in compiled.contacts.items()}
    largest = {name: table[:, rows].argmax(axis=1) for name, rows in peaks.items()}  # of the sides of a stop

    def chosen(first: int, name: str) -> Floats:
        rows = np.array([first + a for a in compiled.contacts[name]])
        values: Floats = np.take_along_axis(table[:, rows], largest[name][:, None], axis=1)[:, 0]
        return values

    def energies(first: int) -> Energies:
        held = first + BODIES + len(bodies)
        lost = held + m + 1
        contacts = compiled.contacts
        return Energies(
            t=table[:, first + TIME],
            bodies={name: table[:, first + BODIES + i] for i, name in enumerate(bodies)},
            structure=table[:, first + STRUCTURE],
            contacts={name: table[:, [held + a for a in rows]].sum(axis=1) for name, rows in contacts.items()},
            links={name: table[:, held + a] for name, a in compiled.links.items()},
            lost_modes=table[:, held + m],
            lost_contacts={name: table[:, [lost + a for a in rows]].sum(axis=1) for name, rows in contacts.items()},
            lost_links={name: table[:, lost + a] for name, a in compiled.links.items()},
            work=table[:, lost + m],
            blows=table[:, lost + m + 1],
        )

    def first_open(name: str) -> Floats:
        columns = table[:, [at.first_open + a for a in compiled.contacts[name]]]
        never = np.isnan(columns).all(axis=1)
        return np.where(never, np.nan, np.where(np.isnan(columns), np.inf, columns).min(axis=1))

    def last(name: str) -> Floats:
        found: Floats = np.fmax.reduce(table[:, [at.last + a for a in compiled.contacts[name]]], axis=1)
        return found

    done = status == DONE
    closed: dict[str, Flags] = {
        name: np.asarray((table[:, [at.closed + a for a in rows]] > 0.0).any(axis=1))
        for name, rows in compiled.contacts.items()
    }
    endings = Endings(
        fleet.clock.duration,
        last={name: last(name) for name in peaks},
        closed=closed,
        gain={name: table[:, at.gain + i] for i, name in enumerate(bodies)},
    )
    outcome = tuple(
        one if ended else None for one, ended in zip(outcomes_of(varied.scene, endings, len(table)), done, strict=True)
    )
    deepest = {name: table[:, [at.deepest + a for a in rows]].max(axis=1) for name, rows in compiled.contacts.items()}
    lifts = {
        plan.body: Lifts(
            int((compiled.system.strikes["over"] == number).sum()),
            *(
                table[:, first + bodies.index(plan.body)]
                for first in (at.lifts, at.lift_number, at.lift_force, at.lift_since)
            ),
        )
        for number, plan in enumerate(varied.scene.blows)
    }
    shortest = {name: table[:, [at.shortest + a for a in rows]].min(axis=1) for name, rows in compiled.contacts.items()}
    tick = 0.0 if fleet.exact else compiled.system.tick
    flags = _flags(varied.scene, outcome, table[:, RESIDUAL], deepest, shortest, tick, lifts)
    batch = Batch(
        basis=basis,
        clock=clock,
        tick=tick,
        varied=varied,
        status=status,
        outcome=outcome,
        steps=table[:, STEPS].astype(np.int64),
        peak_force={name: chosen(at.peak, name) for name in peaks},
        peak_time={name: chosen(at.peak_time, name) for name in peaks},
        deepest=deepest,
        closings={name: table[:, [at.closings + a for a in compiled.contacts[name]]].sum(axis=1) for name in peaks},
        first_open={name: first_open(name) for name in peaks},
        shortest=shortest,
        closed_since={name: np.where(closed[name], endings.last[name], np.nan) for name in peaks},
        separated=table[:, SEPARATED],
        at_separation=energies(at.separation),
        end=energies(at.end),
        end_velocity={name: table[:, at.velocity + i] for i, name in enumerate(bodies)},
        travel={name: table[:, at.travel + i] for i, name in enumerate(bodies)},
        residual=table[:, RESIDUAL],
        lifts=lifts,
        flags=flags,
    )
    for whole in (status, batch.steps, *flags.values()):
        whole.flags.writeable = False
    return batch


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
