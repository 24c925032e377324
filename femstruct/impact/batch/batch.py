"""simulate_batch: thousands of impacts on one basis, a row of metrics each."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.impact.batch.fleet import Fleet, run_some
from femstruct.impact.batch.metrics import Batch, batch_of
from femstruct.impact.batch.vary import variation
from femstruct.impact.scene.bodies import Clock, Scene
from femstruct.modal.basis import ModalBasis

CHUNK, EXACT_CHUNK = 64, 512  # runs between two looks at the keyboard; those of the exact march are short
CHUNKS = 4  # of every thread, at least, where runs differ in length
LISTENED = 8  # runs whose pushes are in memory at once, of every thread
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

    vary : columns [runs] by name: BODY.mass, BODY.velocity, CONTACT.gap, CONTACT.preload, what the contact's law has of
        stiffness, damping, exponent, cubic and dissipation, LINK.stiffness, LINK.closing, LINK.opening, LINK.preload,
        and LOAD.amplitude of a half sine.
    clock : as for `simulate`; nothing is sampled, so that the sampling rate plays no part.
    threads : all cores if None. The results do not depend on it.
    progress : told how many runs are done, of how many.
    listener : makes further numbers of every run, `Batch.heard`, of what pushes the modes.

    Raises InputError for unknown names, and columns of unequal length or none; FemstructError for values that a body,
    contact or link refuses. A run that fails has its row, and raises nothing.

    Notes: the marches of `simulate`. All runs take the exact one when the stiffest laws and the lightest bodies of any
    run allow it. Otherwise steps are longer, since nothing is sampled; an event ends a step so short that the force in
    it is below the tolerance. The tables of the modes are made once for all runs. A row is of the whole window: blow by
    blow tells `simulate`. Runs are judged as by `simulate`: `Batch.outcome`, `Batch.flags`, `Batch.findings`.

    A ball hits a wall through a spring at three speeds; the force is v sqrt(k m), the contact half a period:

    >>> from femstruct.impact.scene.bodies import GROUND, Body, Contact
    >>> from femstruct.impact.laws.linear import Linear
    >>> from femstruct.modal.analytic import given_modes
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
    fleet = Fleet.of(basis, varied, window, heard=listener is not None)
    heard = np.empty((varied.runs, 0 if listener is None else listener.width))
    table, stop = np.empty((varied.runs, fleet.columns.width)), np.zeros(1, dtype=np.int64)
    workers, done = threads or os.cpu_count() or 1, 0
    chunk = min(EXACT_CHUNK, -(-varied.runs // workers))
    if not fleet.exact:
        chunk = min(CHUNK, -(-varied.runs // (CHUNKS * workers)))
    if listener is not None:
        chunk = min(chunk, LISTENED)
    starts = range(0, varied.runs, chunk)

    def run(start: int) -> None:
        some = slice(start, start + chunk)
        if listener is None:
            run_some(fleet, start, table[some], stop)
            return
        moments = run_some(fleet, start, table[some], stop, listener.cells, listener.spacing)
        system = fleet.compiled.system
        heard[some] = listener.of(moments, system.sign[:, None] * system.rows[:, : system.n_modes])

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
    return replace(batch_of(basis, clock, varied, fleet, table), heard=heard)
