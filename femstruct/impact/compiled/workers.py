"""Compilation in processes of its own, one a core: this one goes on with something else, and never imports numba."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from threading import Event, Thread
from typing import Any, Final

from femstruct.errors import FemstructError
from femstruct.impact.compiled.kernels import Unit, units_called
from femstruct.impact.compiled.store import folder, kept, sweep

START: Final = 1.5  # seconds until a process is ready to compile
LOOK: Final = 0.1  # seconds between two looks at what is done
Told = Callable[[str], None]


@dataclass(eq=False)
class Compilation:
    """Units on their way to machine code. done : of them; failures : what a process said before it gave up. pace : how
    much longer than expected the last one took until it was done."""

    units: Sequence[Unit[..., Any]]
    cores: int
    began: float = field(default_factory=time.monotonic)
    done: list[Unit[..., Any]] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    processes: list[subprocess.Popen[str]] = field(default_factory=list)
    pace: float = 1.0
    stopped: Event = field(default_factory=Event)
    threads: list[Thread] = field(default_factory=list)

    @property
    def message(self) -> str:
        """What is being done, and about how long it still takes."""
        costs = [unit.seconds for unit in self.units]
        expected = START + max(sum(costs) / self.cores, max(costs, default=0.0))
        left = expected * self.pace - (time.monotonic() - self.began)
        number = min(len(self.done) + 1, len(self.units))
        return f"compiling {number} of {len(self.units)}, about {max(left, 1.0):.0f} s left"

    def wait(self, told: Told = lambda message: None) -> None:
        """Return when all is compiled; told : hears every second how far it is. Raises FemstructError for a failure."""
        said = 0.0
        while any(thread.is_alive() for thread in self.threads):
            if time.monotonic() - said > 1.0:
                told(self.message)
                said = time.monotonic()
            for thread in self.threads:
                thread.join(LOOK)
        if self.failures:
            raise FemstructError(
                "kernels",
                got=f"no machine code: {self.failures[0].strip().splitlines()[-1]}",
                expected="kernels that compile",
                do=f"check that {folder()} can be written and that numba works: python -c 'import numba'",
            )


@contextmanager
def compilation(units: Sequence[Unit[..., Any]]) -> Iterator[Compilation]:
    """Compile what of these units, and of those they call, is missing, in processes beside this one.

    They are ended with the block, whatever ends it.
    """
    missing = [unit for unit in _with_called(units) if kept(unit) is None]
    missing.sort(key=lambda unit: -unit.seconds)
    cores = min(len(missing), os.cpu_count() or 1)
    run = Compilation(missing, max(cores, 1))
    queue: SimpleQueue[Unit[..., Any]] = SimpleQueue()
    for one in missing:
        queue.put(one)
    if missing:
        sweep(folder())
    run.threads += [Thread(target=_work, args=(run, queue), daemon=True) for _ in range(cores)]
    for thread in run.threads:
        thread.start()
    try:
        yield run
    finally:
        run.stopped.set()
        for process in run.processes:
            process.kill()
        for thread in run.threads:
            thread.join()


def _with_called(units: Sequence[Unit[..., Any]]) -> list[Unit[..., Any]]:
    return list(dict.fromkeys(one for unit in units for one in (unit, *units_called(unit))))


def _work(run: Compilation, queue: SimpleQueue[Unit[..., Any]]) -> None:
    """Give one process unit after unit until none is left."""
    command = [sys.executable, "-W", "ignore", "-m", "femstruct.impact.compiled", str(folder())]
    try:
        process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
    except OSError as failure:
        run.failures.append(str(failure))
        return
    run.processes.append(process)
    assert process.stdin is not None and process.stdout is not None and process.stderr is not None
    expected = START
    with suppress(OSError), process:  # of a process that is gone nothing can be closed
        while not run.stopped.is_set() and not run.failures:
            try:
                unit = queue.get_nowait()
            except Empty:
                process.stdin.close()
                return
            try:
                process.stdin.write(unit.name + "\n")
                process.stdin.flush()
                answer = process.stdout.readline()
            except OSError:
                answer = ""
            if not answer:
                if not run.stopped.is_set():
                    run.failures.append(process.stderr.read() or "the process that compiles was ended")
                return
            expected += unit.seconds
            run.pace = (time.monotonic() - run.began) / expected
            run.done.append(unit)


def code_of(units: Sequence[Unit[..., Any]]) -> dict[str, bytes]:
    """Machine code by symbol, of the store or made now. Raises FemstructError where it cannot be made."""
    found = {unit.symbol: kept(unit) for unit in units}
    if None in found.values():
        with compilation(units) as running:
            running.wait()
        found = {unit.symbol: kept(unit) for unit in units}
    missing = [symbol for symbol, code in found.items() if code is None]
    if missing:
        raise FemstructError(
            "kernels",
            got=f"no machine code of {missing[0]} in {folder()}",
            expected="the code that was just compiled",
            do="set FEMSTRUCT_CACHE to a folder that keeps files",
        )
    return {symbol: code for symbol, code in found.items() if code is not None}
