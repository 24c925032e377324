"""Where machine code is kept, and who makes it: files with checksums, processes that compile."""

from __future__ import annotations

import atexit
import hashlib
import logging
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from ctypes import CFUNCTYPE, c_double, c_int64, c_void_p
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Event, Lock, Thread
from typing import Any, Final

import llvmlite.binding as llvm

from femstruct.compiled.kernels import CompiledUnit, units_called
from femstruct.errors import FemstructError

# ----------------------------------------------------------------------------------------------------------------------
# Where machine code is kept: one file a unit, with a checksum, in the first folder that can be written.
#
# A file that is damaged is told in one line, removed and made again. Files are written whole, by renaming, so that
# several processes and versions do not disturb each other.
# ----------------------------------------------------------------------------------------------------------------------

_LOG = logging.getLogger("femstruct")
SUFFIX: Final = ".unit"
SWEPT: Final = 60 * 86400.0  # seconds without use after which the code of another version is removed


def folders() -> tuple[Path, ...]:
    """Where machine code may be kept, best first: FEMSTRUCT_CACHE, beside this package, the user's cache folder."""
    given = os.environ.get("FEMSTRUCT_CACHE")
    user = {
        "win32": os.environ.get("LOCALAPPDATA", "~/AppData/Local"),
        "darwin": "~/Library/Caches",
    }.get(sys.platform, os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    usual = (Path(__file__).with_name("__pycache__"), Path(user).expanduser() / "femstruct")
    return (Path(given).expanduser(), *usual) if given else usual


@cache
def folder() -> Path:
    """The first of the folders that takes a file; where none does one for this process alone, removed at its end."""
    for place in folders():
        try:
            place.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=place):
                return place
        except OSError:
            continue
    own = tempfile.mkdtemp(prefix="femstruct-")
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return Path(own)


def _path(unit: CompiledUnit[..., Any], place: Path) -> Path:
    return place / f"{unit.symbol[-40:]}-{unit.fingerprint[:32]}{SUFFIX}"


def load_code(unit: CompiledUnit[..., Any]) -> bytes | None:
    """The machine code of a unit, None where there is none."""
    path = _path(unit, folder())
    try:
        content = path.read_bytes()
    except OSError:
        return None
    checksum, code = content[:32], content[32:]
    if hashlib.sha256(code).digest() == checksum and code:
        return code
    _LOG.warning("the compiled kernel %s is damaged; it is removed and compiled again", path)
    path.unlink(missing_ok=True)
    return None


def store_code(unit: CompiledUnit[..., Any], code: bytes, place: Path) -> None:
    """Keep the machine code of a unit in a folder."""
    with tempfile.NamedTemporaryFile(dir=place, suffix=".part", delete=False) as file:
        file.write(hashlib.sha256(code).digest() + code)
    Path(file.name).replace(_path(unit, place))


def sweep(place: Path) -> None:
    """Remove code that has not been used for long."""
    for path in (*place.glob(f"*{SUFFIX}"), *place.glob("*.part")):
        try:
            last = path.stat()
            if time.time() - max(last.st_mtime, last.st_atime) > SWEPT:
                path.unlink(missing_ok=True)
        except OSError:
            continue


# ----------------------------------------------------------------------------------------------------------------------
# Compilation in processes of its own, one a core: this one goes on with something else, and never imports numba.
# ----------------------------------------------------------------------------------------------------------------------

START: Final = 1.5  # seconds until a process is ready to compile
LOOK: Final = 0.1  # seconds between two looks at what is done
Report = Callable[[str], None]


@dataclass(eq=False)
class Compilation:
    """Units on their way to machine code. done : of them; failures : what a process said before it gave up. pace : how
    much longer than expected the last one took until it was done."""

    units: Sequence[CompiledUnit[..., Any]]
    cores: int
    began: float = field(default_factory=time.monotonic)
    done: list[CompiledUnit[..., Any]] = field(default_factory=list)
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

    def wait(self, report: Report = lambda message: None) -> None:
        """Return when all is compiled.

        Parameters
        ----------
        report : Report
            Called every second.

        Raises
        ------
        FemstructError
            For a failure.
        """
        last_report = 0.0
        while any(thread.is_alive() for thread in self.threads):
            if time.monotonic() - last_report > 1.0:
                report(self.message)
                last_report = time.monotonic()
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
def compilation(units: Sequence[CompiledUnit[..., Any]]) -> Iterator[Compilation]:
    """Compile what of these units, and of those they call, is missing, in processes beside this one.

    They are ended with the block, whatever ends it.
    """
    missing = [unit for unit in _with_called(units) if load_code(unit) is None]
    missing.sort(key=lambda unit: -unit.seconds)
    cores = min(len(missing), os.cpu_count() or 1)
    run = Compilation(missing, max(cores, 1))
    queue: SimpleQueue[CompiledUnit[..., Any]] = SimpleQueue()
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


def _with_called(units: Sequence[CompiledUnit[..., Any]]) -> list[CompiledUnit[..., Any]]:
    return list(dict.fromkeys(one for unit in units for one in (unit, *units_called(unit))))


def _work(run: Compilation, queue: SimpleQueue[CompiledUnit[..., Any]]) -> None:
    """Give one process unit after unit until none is left."""
    command = [sys.executable, "-W", "ignore", "-m", "femstruct.compiled", str(folder())]
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


def code_of(units: Sequence[CompiledUnit[..., Any]]) -> dict[str, bytes]:
    """Machine code by symbol, of the store or made now. Raises FemstructError where it cannot be made."""
    found = {unit.symbol: load_code(unit) for unit in units}
    if None in found.values():
        with compilation(units) as running:
            running.wait()
        found = {unit.symbol: load_code(unit) for unit in units}
    missing = [symbol for symbol, code in found.items() if code is None]
    if missing:
        raise FemstructError(
            "kernels",
            got=f"no machine code of {missing[0]} in {folder()}",
            expected="the code that was just compiled",
            do="set FEMSTRUCT_CACHE to a folder that keeps files",
        )
    return {symbol: code for symbol, code in found.items() if code is not None}


# ----------------------------------------------------------------------------------------------------------------------
# Machine code of units into this process, by LLVM's own linker.
# ----------------------------------------------------------------------------------------------------------------------

_TYPES: Final[dict[str, Any]] = {"int": c_int64, "bool": c_int64, "float": c_double, "tuple": c_void_p}
_LOCK = Lock()
_ENGINES: Final[list[llvm.ExecutionEngine]] = []  # their code lives as long as they do


def native(unit: CompiledUnit[..., Any]) -> Any:
    """A unit's C function; the units it calls are loaded with it, or compiled where no run before has.

    Threads go on while it runs.
    """
    with _LOCK:  # of several threads that need a unit for the first time one compiles it
        code = code_of((unit, *units_called(unit)))
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        engine = llvm.create_mcjit_compiler(
            llvm.parse_assembly(""), llvm.Target.from_default_triple().create_target_machine()
        )
        for piece in code.values():
            engine.add_object_file(llvm.ObjectFileRef.from_data(piece))
        engine.finalize_object()
        address = engine.get_function_address(unit.symbol)
        _ENGINES.append(engine)
    assert address, unit.symbol
    return CFUNCTYPE(c_int64, *(_TYPES[slot.kind] for slot in unit.slots))(address)
