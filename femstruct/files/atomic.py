"""Writing a file whole or not at all."""

from __future__ import annotations

import hashlib
import os
import re
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from femstruct.errors import FemstructError, InputError

_MARK = ".part-"
DEEPEST: Final = 100  # folders; no path of so many is meant
_LONGEST: Final = 150  # bytes of a file's name, of which most systems take 255, for a temporary one, too


def short(stem: str) -> str:
    """The name of a file without its suffix, the end of a long one replaced by what tells it from others.

    >>> short("history"), len(short("x" * 1000)), short("x" * 1000) == short("x" * 999)
    ('history', 150, False)
    """
    whole = stem.encode()
    if len(whole) <= _LONGEST:
        return stem
    told = "_" + hashlib.sha256(whole).hexdigest()[:10]
    return whole[: _LONGEST - len(told)].decode(errors="ignore") + told


def file_name(*words: str) -> str:
    """A file name that every system takes.

    >>> file_name("history", "ball on floor force")
    'history_ball_on_floor_force.png'
    """
    return short(re.sub(r"[^\w.+-]+", "_", "_".join(words))) + ".png"


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary name beside `path` to write to; on leaving it is synced to disk and takes the place of `path`.

    The file under `path` is at every instant the complete old one or the complete new one, whenever the process is
    killed or the disk is full. What dead processes of this machine left behind is swept first.

    Raises InputError when the folder is not there (it may be a slip of the pen), FemstructError when the system refuses
    the write; the old file is then untouched.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with replacing(Path(folder, "a.txt")) as temporary:
    ...         _ = temporary.write_text("complete")
    ...     Path(folder, "a.txt").read_text(), len(list(Path(folder).iterdir()))
    ('complete', 1)
    """
    path = Path(path)
    refuse_unwritable_file(path)
    temporary = temporary_name(path)
    try:
        for left in stale(path):
            left.unlink(missing_ok=True)
        yield temporary
        _sync(temporary)
        temporary.replace(path)
        _sync(path.parent)
    except OSError as error:
        raise FemstructError(
            str(path),
            got=f"{error.strerror or error} while writing",
            expected="room and permission to write",
            do="free space or choose another folder with -o; a file that was there before is untouched",
        ) from error
    finally:
        with suppress(OSError):  # there is nothing to remove, or the error on its way says more
            temporary.unlink()


def refuse_unwritable_file(path: Path) -> None:
    """Raise InputError when the folder of a file to be written is not there, or something else has its name."""
    if not os.path.isdir(path.parent):  # noqa: PTH112 (False, where pathlib raises)
        raise InputError(
            str(path),
            got=f"no folder '{path.parent}'",
            expected="a folder that is there",
            do="make it, or correct the name",
        )
    if os.path.exists(path) and not os.path.isfile(path):  # noqa: PTH110, PTH113
        raise InputError(
            str(path),
            got=f"{'a folder' if path.is_dir() else 'a pipe or a device'} of that name",
            expected="a name for a file",
            do="choose another name",
        )


def refuse_unwritable(folder: Path) -> None:
    """Raise InputError when a folder cannot be made or written to: better before the work than after it."""
    if len(folder.parts) > DEEPEST:
        raise InputError(
            str(folder),
            got=f"a path of {len(folder.parts)} folders",
            expected=f"at most {DEEPEST}",
            do="choose another one with -o",
        )
    try:
        _try_to_make(folder)
    except OSError as error:
        raise InputError(
            str(folder),
            got=f"a folder that cannot be made ({error.strerror})",
            expected="a folder to write to",
            do="choose another one with -o",
        ) from None


def _try_to_make(folder: Path) -> None:
    """Make a folder and remove it again; refuse what exists and cannot be written to."""
    existing = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise InputError(
            str(folder),
            got=f"{existing}, which is {'not writable' if existing.is_dir() else 'a file'}",
            expected="a folder to write to",
            do="choose another one with -o",
        )
    missing = [place for place in (folder, *folder.absolute().parents) if not place.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    finally:
        for place in missing:
            with suppress(OSError):  # it was not made
                place.rmdir()


def temporary_name(path: Path) -> Path:
    """A hidden name beside a path, that tells the machine and the process it belongs to."""
    return path.with_name(f".{path.stem}{_MARK}{socket.gethostname()}-{os.getpid()}{path.suffix}")


def stale(path: Path) -> list[Path]:
    """Temporaries of a path whose process, on this machine, no longer runs."""
    start = f".{path.stem}{_MARK}{socket.gethostname()}-"

    def is_stale(other: Path) -> bool:
        pid = other.name.removeprefix(start).removesuffix(path.suffix)
        named = other.name.startswith(start) and other.name.endswith(path.suffix)
        return named and pid.isdigit() and not _runs(int(pid))

    return [other for other in path.parent.iterdir() if is_stale(other)]


def _runs(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
