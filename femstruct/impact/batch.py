"""simulate_batch: thousands of impacts on one basis, a row of metrics each."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.impact.bodies import Clock, Scene
from femstruct.impact.energy import BODIES, STRUCTURE, TIME
from femstruct.impact.fleet import Fleet, run_some
from femstruct.impact.many import ENDED, RESIDUAL, SEPARATED, STATUS, STEPS
from femstruct.impact.march import DONE, TROUBLE
from femstruct.impact.response import Outcome
from femstruct.impact.vary import Variation, variation
from femstruct.modal.basis import ModalBasis

CHUNK, EXACT_CHUNK = 64, 512  # runs between two looks at the keyboard; those of the exact march are short
CHUNKS = 4  # of every thread, at least
OUTCOMES = (Outcome.NO_CONTACTS, Outcome.NEVER_TOUCHED, Outcome.SEPARATED, Outcome.CLOSED_AT_END)
Progress = Callable[[int, int], None]


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


@dataclass(frozen=True, eq=False)
class Batch:
    """Metrics of many runs of one scene, each [runs]; a run that failed has nan, and says why in `trouble`.

    basis, clock; varied : the scene as given and the columns of numbers that took its place.
    status : 0 for a run that reached its end. outcome : None for one that did not; CLOSED_AT_END also where bodies come
    to rest, which only their histories tell. steps : of the march.
    peak_force [N], peak_time [s], deepest indentation [m], closings, first_open [s] (nan if never) by contact.
    separated : whether the collision ended; at_separation, end : energies.
    end_velocity [m/s], travel [m] : of the bodies; travel is the largest displacement either way.
    residual : of the energy ledger, as in `EnergyLedger`.
    """

    basis: ModalBasis
    clock: Clock
    varied: Variation
    status: Integers
    outcome: tuple[Outcome | None, ...]
    steps: Integers
    peak_force: Mapping[str, Floats]
    peak_time: Mapping[str, Floats]
    deepest: Mapping[str, Floats]
    closings: Mapping[str, Floats]
    first_open: Mapping[str, Floats]
    separated: Floats
    at_separation: Energies
    end: Energies
    end_velocity: Mapping[str, Floats]
    travel: Mapping[str, Floats]
    residual: Floats

    def scene(self, i: int) -> Scene:
        """The scene of run i, for `simulate`: the same impact with its histories."""
        return self.varied(i)

    def trouble(self, i: int) -> str:
        """Why run i failed, "" if it did not."""
        return TROUBLE.get(int(self.status[i]), "")


def simulate_batch(
    basis: ModalBasis,
    scene: Scene,
    clock: Clock,
    vary: Mapping[str, ArrayLike],
    threads: int | None = None,
    progress: Progress = lambda done, runs: None,
) -> Batch:
    """Metrics of many impacts that differ in numbers of their bodies, contacts, links and loads.

    vary : columns [runs] by name: BODY.mass, BODY.velocity, CONTACT.gap, CONTACT.preload, what the contact's law has of
        stiffness, damping, exponent, cubic and dissipation, LINK.stiffness, LINK.closing, LINK.opening, LINK.preload,
        and LOAD.amplitude of a half sine.
    clock : as for `simulate`; nothing is sampled, so that the sampling rate plays no part.
    threads : all cores if None. The results do not depend on it, to the last bit.
    progress : told how many runs are done, of how many.

    Raises InputError for unknown names, columns of unequal length or none, and a scene with blows; FemstructError for
    values that a body, contact or link refuses. A run that fails has its row, and raises nothing.

    Notes: the marches of `simulate`. All runs take the exact one when the stiffest laws and the lightest bodies of any
    run allow it. Otherwise steps are longer, since nothing is sampled; an event ends a step so short that the force in
    it is below the tolerance. The tables of the modes are made once for all runs.

    A ball hits a wall through a spring at three speeds; the force is v sqrt(k m), the contact half a period:

    >>> from femstruct.impact.bodies import GROUND, Body, Contact
    >>> from femstruct.impact.laws import Linear
    >>> from femstruct.modal.analytic import given_modes
    >>> wall = Contact("wall", upper="ball", lower=GROUND, law=Linear(np.pi**2))
    >>> scene = Scene((Body("ball", 1.0, -1.0),), (wall,))
    >>> batch = simulate_batch(given_modes([], [], {})[0], scene, Clock(2.0, 100.0), {"ball.velocity": [-1, -2, -3]})
    >>> (batch.peak_force["wall"] / np.pi).round(9).tolist(), batch.first_open["wall"].round(9).tolist()
    ([1.0, 2.0, 3.0], [1.0, 1.0, 1.0])
    """
    if scene.blows:
        raise InputError("scene", got="blows", expected="a start and no more", do="simulate each by itself")
    varied = variation(scene, vary)
    # without samples the end of the window is the only one
    window = replace(clock, duration=max(round(clock.duration * clock.sampling), 1) / clock.sampling)
    window = replace(window, sampling=1.0 / window.duration)
    fleet = Fleet.of(basis, varied, window)
    table = np.empty((varied.runs, fleet.columns.width))
    workers, done = threads or os.cpu_count() or 1, 0
    chunk = min(EXACT_CHUNK if fleet.exact else CHUNK, -(-varied.runs // (CHUNKS * workers)))
    starts = range(0, varied.runs, chunk)
    with ThreadPoolExecutor(workers) as pool:
        jobs = {pool.submit(run_some, fleet, start, table[start : start + chunk]): start for start in starts}
        try:
            for job in as_completed(jobs):
                job.result()
                done += len(table[jobs[job] : jobs[job] + chunk])
                progress(done, varied.runs)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return _batch(basis, clock, varied, fleet, table)


def _batch(basis: ModalBasis, clock: Clock, varied: Variation, fleet: Fleet, table: Floats) -> Batch:
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
        )

    def first_open(name: str) -> Floats:
        columns = table[:, [at.first_open + a for a in compiled.contacts[name]]]
        never = np.isnan(columns).all(axis=1)
        return np.where(never, np.nan, np.where(np.isnan(columns), np.inf, columns).min(axis=1))

    batch = Batch(
        basis=basis,
        clock=clock,
        varied=varied,
        status=status,
        outcome=tuple(OUTCOMES[int(row[ENDED])] if row[STATUS] == DONE else None for row in table),
        steps=table[:, STEPS].astype(np.int64),
        peak_force={name: chosen(at.peak, name) for name in peaks},
        peak_time={name: chosen(at.peak_time, name) for name in peaks},
        deepest={name: table[:, [at.deepest + a for a in compiled.contacts[name]]].max(axis=1) for name in peaks},
        closings={name: table[:, [at.closings + a for a in compiled.contacts[name]]].sum(axis=1) for name in peaks},
        first_open={name: first_open(name) for name in peaks},
        separated=table[:, SEPARATED],
        at_separation=energies(at.separation),
        end=energies(at.end),
        end_velocity={name: table[:, at.velocity + i] for i, name in enumerate(bodies)},
        travel={name: table[:, at.travel + i] for i, name in enumerate(bodies)},
        residual=table[:, RESIDUAL],
    )
    for whole in (status, batch.steps):
        whole.flags.writeable = False
    return batch
