"""How the program leaves: its exit codes, and one clear line for what went wrong."""

from __future__ import annotations

import atexit
import errno
import os
import re
import signal
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from threading import enumerate as enumerate_threads
from threading import main_thread
from typing import Any, Final, NoReturn

from femstruct.errors import FemstructError, InputError, NotConverged

GOOD, OUR_BUG, BAD_INPUT, NOT_TRUSTED, INTERRUPTED = 0, 1, 2, 3, 130

_NO_ROOM: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF, errno.EPIPE)
_NO_TEXT: Final = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff]")
_NO_NAME: Final = re.compile("[\t\n]")


def leave_with(work: Callable[[], object]) -> int:
    """The exit code after some work that may end with SystemExit: of what it raises else, a line is told on stderr."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by who started us
            setattr(sys, name, Path(os.devnull).open("w"))  # noqa: SIM115 (for as long as we run)
    try:
        code = _code_of(work)
        sys.stdout.flush()
    except KeyboardInterrupt:
        code = INTERRUPTED
    except Exception as error:
        code = tell(error)
    for stream in (sys.stdout, sys.stderr):
        _give_up(stream)
    return code


def end(code: int) -> NoReturn:
    """End the process at once: to free all it holds, piece by piece, takes a fifth of the time of a short command."""
    if any(thread is not main_thread() and not thread.daemon for thread in enumerate_threads()):
        sys.exit(code)  # waits for them
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        _give_up(stream)
    os._exit(code)


def heed_signals() -> None:
    """A reader that has seen enough (``| head``) is no bug of ours; a request to terminate ends the work as Ctrl-C."""
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    signal.signal(signal.SIGTERM, _interrupt)


def _interrupt(number: int, frame: object) -> None:
    raise KeyboardInterrupt


def _code_of(work: Callable[[], object]) -> int:
    try:
        work()
    except SystemExit as leaving:
        if isinstance(leaving.code, str):
            print(leaving.code, file=sys.stderr)
            return OUR_BUG
        return leaving.code or GOOD
    return GOOD


def _give_up(stream: Any) -> None:
    """Whatever a stream could not write is dropped, lest the interpreter complains once more at its end."""
    try:
        stream.flush()
    except (OSError, ValueError):
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def refuse_unreadable_words(options: Mapping[str, object]) -> None:
    """Raise InputError for words of the command line that cannot be printed, stored, or used in a name."""
    for name, value in options.items():
        for word in value if isinstance(value, list) else [value]:
            found = _NO_TEXT.search(str(word)) or (isinstance(word, Path) and _NO_NAME.search(str(word)))
            if isinstance(word, str | Path) and found:
                shown = str(word).encode("ascii", "backslashreplace").decode("ascii")
                raise InputError(
                    f"the command line, {name.strip('_')}",
                    got=ascii(shown) if found[0] in "\t\n" else f"'{shown}'",
                    expected="text in UTF-8 without control characters",
                    do="rename it",
                )


def tell(error: Exception) -> int:
    """Say what went wrong on stderr, and with which exit code to leave."""
    with suppress(OSError, ValueError):  # stderr may be full, too
        if isinstance(error, NotConverged):
            print(error.text, file=sys.stderr)
        elif isinstance(error, FemstructError) or _of_acoustics(error):
            print(error, file=sys.stderr)
        elif isinstance(error, OSError) and error.errno in _NO_ROOM:
            print(f"printing: got {error.strerror}, expected room for what is printed", file=sys.stderr)
        elif isinstance(error, MemoryError):
            print(f"memory: got {error or 'none left'}, expected enough; make the model smaller", file=sys.stderr)
        else:
            import traceback

            traceback.print_exception(error)
            print("This is a bug in femstruct, not in your input; please report the lines above.", file=sys.stderr)
            return OUR_BUG
    return NOT_TRUSTED if isinstance(error, NotConverged) else BAD_INPUT


def _of_acoustics(error: Exception) -> bool:
    """Whether the package acoustics refused something; it is not loaded only to be asked."""
    wing = sys.modules.get("acoustics.errors")
    return wing is not None and isinstance(error, wing.AcousticsError)
