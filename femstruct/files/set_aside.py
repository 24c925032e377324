"""What an earlier run left is set aside under names with a number, where a later one would take its place."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from itertools import count
from pathlib import Path
from typing import Final

from femstruct.errors import FemstructError
from femstruct.files.atomic import stale, temporary_name

NAMELESS: Final = "run"  # what the files of a folder without a name are kept as


def numbered(paths: Sequence[Path]) -> list[Path]:
    """The same names with a number before the suffix, the first that none of them has yet.

    >>> [path.name for path in numbered([Path("no/such/sweep.rows"), Path("no/such/sweep.h5")])]
    ['sweep.1.rows', 'sweep.1.h5']
    """
    for number in count(1):
        new = [one.with_name(f"{one.stem}.{number}{one.suffix}") for one in paths]
        if not any(one.exists() for one in new):
            break
    return new


def moved(paths: Sequence[Path]) -> list[Path]:
    """Give files that belong together names with one number; those that are not there are left out of it."""
    new = numbered(paths)
    for old, other in zip(paths, new, strict=True):
        if old.exists():
            old.rename(other)
    return new


def kept_beside(folder: Path, names: Sequence[str]) -> Path:
    """Keep files of a folder in another one beside it, FOLDER.1 or the next number; returns that. The files stay where
    they are, too, until others take their places.

    The new folder is there with all of them or not at all, whenever the process is killed. Where nothing can be written
    beside the folder it is made inside.

    Raises FemstructError where neither can be written to.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     folder = Path(place, "floor")
    ...     folder.mkdir()
    ...     _ = (folder / "a.wav").write_text("x")
    ...     kept_beside(folder, ["a.wav"]).name, kept_beside(folder, ["a.wav"]).name
    ('floor.1', 'floor.2')
    """
    whole = folder.resolve()
    home = whole.parent if os.access(whole.parent, os.W_OK | os.X_OK) else whole
    name = whole.name or NAMELESS
    for left in stale(home / name):
        shutil.rmtree(left, ignore_errors=True)
    coming = temporary_name(home / name)
    try:
        coming.mkdir()
        for one in names:
            same_file(whole / one, coming / one)
        return _placed(coming, home, name, folder)
    except OSError as error:
        raise FemstructError(
            str(folder),
            got=f"{error.strerror} while keeping the earlier run",
            expected="room and permission to write beside it",
            do="free space, choose another folder with -o, or add --replace",
        ) from error
    finally:
        shutil.rmtree(coming, ignore_errors=True)


def _placed(coming: Path, home: Path, name: str, folder: Path) -> Path:
    """Give a folder the first number that is free; how it is called from where the other one is."""
    for number in count(1):
        place = home / f"{name}.{number}"
        if place.exists():
            continue
        try:
            coming.rename(place)
            break
        except OSError:
            if not place.exists():  # else another process was faster
                raise
    beside = folder.parent / place.name
    return beside if beside.resolve() == place else place


def same_file(source: Path, path: Path) -> None:
    """The same file under another name, or a copy of it."""
    try:
        os.link(source, path)
    except OSError:  # another disk, or one without such names
        shutil.copyfile(source, path)
