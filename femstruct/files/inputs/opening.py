"""Opening what a user names: ordinary files only, of a bounded size, and from a study only where it says so."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Final

from femstruct.errors import InputError

_KINDS: Final = (
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)
_PLAINLY: Final = "a path from this file's folder, such as ../meshes/room.msh"


def content(path: Path, most: int, what: str) -> bytes:
    """The bytes of an ordinary file; what : what it should be, such as "a YAML file".

    Raises InputError for a file that is not there, a folder, a pipe or a device (which may never end), a file of more
    than `most` bytes, and what the system does not let us read.
    """
    try:
        # without waiting for somebody to write into a pipe
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        try:
            found = os.fstat(descriptor)
            _refuse_kind(path, found.st_mode, what)
            with os.fdopen(descriptor, "rb", closefd=False) as file:
                data = file.read(most + 1)
        finally:
            os.close(descriptor)
    except FileNotFoundError:
        raise InputError(str(path), got=f"no file '{path}'", expected=what) from None
    except (OSError, ValueError) as error:
        told = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(str(path), got=f"'{path}', which cannot be read ({told})", expected=what) from None
    if len(data) > most:
        size = max(found.st_size, len(data))
        raise InputError(str(path), got=f"a file of {size} bytes", expected=f"at most {most}")
    return data


def _refuse_kind(path: Path, mode: int, what: str) -> None:
    if stat.S_ISDIR(mode):
        raise InputError(str(path), got=f"the folder '{path}'", expected=what, do="name a file in it")
    if kind := next((words for is_it, words in _KINDS if is_it(mode)), ""):
        raise InputError(str(path), got=f"'{path}', which is {kind}", expected=what)


def beside(file: str, name: str) -> Path:
    """The path of a file that another file names, from its folder.

    Raises InputError unless the path is relative, leaves the folder only by ``..`` at its beginning, and no link leads
    out of where that is: whoever reads a study sees what it opens.

    >>> beside("studies/drop.study.yaml", "../models/floor.yaml").as_posix()
    'studies/../models/floor.yaml'
    """
    if not name.strip() or "\0" in name:
        raise InputError(file, got="a name with a NUL" if "\0" in name else "no name", expected="the name of a file")
    path = Path(name)
    steps = path.parts
    up = next((number for number, step in enumerate(steps) if step != ".."), len(steps))
    if path.is_absolute() or path.drive or path.root:
        raise InputError(file, got=f"the absolute path '{name}'", expected=_PLAINLY)
    if ".." in steps[up:]:
        raise InputError(file, got=f"'{name}', with '..' behind a name", expected=_PLAINLY)
    folder = Path(file).parent
    try:
        top = folder.joinpath(*steps[:up]).resolve()
        inside = (folder / path).resolve().is_relative_to(top)
    except (OSError, RuntimeError):  # a circle of links, a name that is too long: reading it will tell
        inside = True
    if not inside:
        raise InputError(file, got=f"'{name}', a link that leads out of '{top}'", expected=_PLAINLY)
    return folder / path
