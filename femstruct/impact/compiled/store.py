"""Where machine code is kept: one file a unit, with a checksum, in the first folder that can be written.

A file that is damaged is told in one line, removed and made again. Files are written whole, by renaming, so that
several processes and versions do not disturb each other.
"""

from __future__ import annotations

import atexit
import hashlib
import logging
import os
import shutil
import sys
import tempfile
import time
from functools import cache
from pathlib import Path
from typing import Any, Final

from femstruct.impact.compiled.kernels import Unit

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


def _path(unit: Unit[..., Any], place: Path) -> Path:
    return place / f"{unit.symbol[-40:]}-{unit.fingerprint[:32]}{SUFFIX}"


def kept(unit: Unit[..., Any]) -> bytes | None:
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


def keep(unit: Unit[..., Any], code: bytes, place: Path) -> None:
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
