"""Who runs tasks: this process, several of this machine, or those of a Dask scheduler."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from typing import Any, Final, Protocol

from femstruct.campaign.rows import Row
from femstruct.campaign.tasks import Work, run_task
from femstruct.errors import InputError

THREADS: Final = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "LP_NUM_THREADS")
AHEAD: Final = 2  # tasks handed out for each worker, so that none waits for the next
PATIENCE: Final = 5.0  # seconds that the threads of ended processes may take to end
LOOK: Final = 1.0  # seconds between two looks at what is done
GONE: Final = (
    "the process that ran it ended without an answer: it was killed, or there was not enough memory; "
    "the same command runs it once more"
)
Done = Callable[[list[Row]], None]
Tick = Callable[[], None]


class Crew(Protocol):
    """Who runs tasks: they call `done` with the rows as they come, and `tick` about once a second."""

    def __call__(self, tasks: Sequence[Work], done: Done, tick: Tick = lambda: None, /) -> None: ...


@contextmanager
def crew(workers: int, cluster: str = "") -> Iterator[Crew]:
    """This process for one worker, several for more, or the workers of a scheduler; processes end with the block.

    Parameters
    ----------
    cluster : str
        Address of a Dask scheduler, "" for none.

    Raises
    ------
    InputError
        Where no scheduler answers.
    """
    if cluster:
        with _of_scheduler(cluster) as (executor, size):
            yield partial(_by_scheduler, executor, size)
    elif workers == 1:
        yield _here
    else:
        with _one_thread_each(), _ignore_broken_pipes():
            processes = _Processes(workers)
            try:
                yield processes
            finally:
                processes.end()


def _here(tasks: Sequence[Work], done: Done, tick: Tick = lambda: None) -> None:
    for task in tasks:
        for rows in task.rows():
            done(rows)
            tick()


def _by_scheduler(executor: Executor, size: int, tasks: Sequence[Work], done: Done, tick: Tick = lambda: None) -> None:
    from distributed import KilledWorker

    for task in _hand_out(executor, list(tasks), AHEAD * size, done, tick, (KilledWorker,)):
        done(_rows_of_ended(task))


class _Processes:
    """Processes of this machine, started when they are first needed, and anew when one has died."""

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._executor: Executor | None = None
        self._others = set[Any]()
        self._threads = set[threading.Thread]()

    def __call__(self, tasks: Sequence[Work], done: Done, tick: Tick = lambda: None) -> None:
        """Tasks under way when a process dies are run again, one at a time; one that dies again costs its own samples
        only."""
        left, doubtful = list(tasks), list[Work]()
        while left:
            doubtful += self._until_broken(left, AHEAD * self._workers, done, tick)
        while doubtful:
            for task in self._until_broken(doubtful, 1, done, tick):
                done(_rows_of_ended(task))

    def _until_broken(self, tasks: list[Work], ahead: int, done: Done, tick: Tick) -> list[Work]:
        """Run tasks, taken from the list, until all are done or a process has died; those that were then under way."""
        if self._executor is None:
            self._others = set(multiprocessing.active_children())
            self._threads = set(threading.enumerate())
            self._executor = _pool(self._workers)
        lost = _hand_out(self._executor, tasks, ahead, done, tick)
        if lost:
            self.end()
        return lost

    def end(self) -> None:
        """End the processes, whatever they do; not those that somebody else had started before."""
        if self._executor is not None:
            results = getattr(self._executor, "_result_queue", None)
            self._executor.shutdown(wait=False, cancel_futures=True)
            for child in set(multiprocessing.active_children()) - self._others:
                child.kill()
            _close_for_writing(results)
            until = time.monotonic() + PATIENCE
            for thread in set(threading.enumerate()) - self._threads:  # they write to the processes
                thread.join(max(until - time.monotonic(), 0.0))
        self._executor = None


def _close_for_writing(results: Any) -> None:
    """Close this process's own end of the pipe for results: of one that a killed process has sent half of, the executor
    waits for the other half as long as anybody could write it, and this process would wait for the executor at its end.
    """
    if (writer := getattr(results, "_writer", None)) is not None:
        writer.close()


def _hand_out(
    executor: Executor,
    tasks: list[Work],
    ahead: int,
    done: Done,
    tick: Tick,
    given_up: tuple[type[Exception], ...] = (),
) -> list[Work]:
    """Give tasks to an executor, taken from the list, a few ahead. Returns those under way when it broke.

    Parameters
    ----------
    given_up : tuple[type[Exception], ...]
        What an executor raises for a task that it has tried several times, whose workers died.
    """
    running = dict[Future[list[Row]], Work]()
    while tasks or running:
        while tasks and len(running) < ahead:
            try:
                running[executor.submit(run_task, tasks[0])] = tasks[0]
            except BrokenProcessPool:
                return list(running.values())
            tasks.pop(0)
        ready, _ = wait(running, timeout=LOOK, return_when=FIRST_COMPLETED)
        tick()
        for future in ready:
            try:
                rows = future.result()
            except BrokenProcessPool:
                return list(running.values())
            except given_up:
                rows = _rows_of_ended(running[future])
            running.pop(future)
            done(rows)
    return []


def _rows_of_ended(task: Work) -> list[Row]:
    return [Row(number, "", {}, trouble=GONE, again=True) for number in task.numbers]


def _pool(workers: int) -> ProcessPoolExecutor:
    context = multiprocessing.get_context("spawn")  # a fork would copy locks of threads
    return ProcessPoolExecutor(workers, mp_context=context, initializer=_begin, initargs=(os.getpid(),))


def _begin(parent: int) -> None:
    """Of a process: Ctrl-C is for its parent, with which it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(LOOK)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def _ignore_broken_pipes() -> Iterator[None]:
    """Writing to a process that has been killed is an error of that write meanwhile, and not the end of this one."""
    if not hasattr(signal, "SIGPIPE") or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGPIPE, before)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """One thread of linear algebra for each process that is started meanwhile."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextmanager
def _of_scheduler(address: str) -> Iterator[tuple[Executor, int]]:
    """The executor of a Dask scheduler and how many tasks its workers run at a time."""
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "--cluster", got="no package 'distributed'", expected="it installed", do="pip install 'femstruct[cluster]'"
        ) from None
    try:
        client = Client(address, timeout=10)
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(
            f"--cluster {address}",
            got=f"no answer ({error or type(error).__name__})",
            expected="the address of a Dask scheduler",
            do="write it like tcp://192.168.0.5:8786",
        ) from None
    with client:
        yield client.get_executor(pure=False), max(sum(client.nthreads().values()), 1)
