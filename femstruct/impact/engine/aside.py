"""Runs the compiled solver in a worker thread, so that Ctrl-C still works."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, wait
from threading import Thread
from typing import TypeVar

from femstruct.arrays import Integers

CHECK_INTERVAL = 0.2  # seconds between two checks for Ctrl-C, which a plain wait would not notice

R = TypeVar("R")


def run_aside(call: Callable[[], R], stop: Integers) -> R:
    """What a call returns or raises, from a thread of its own.

    stop [1] : the call looks at it and ends when it is not zero; it is set when the wait is interrupted (Ctrl-C), which
    is then raised at once.

    >>> import numpy as np
    >>> run_aside(lambda: 6 * 7, np.zeros(1, dtype=np.int64))
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
