"""Which files of a folder are a run's own: what an earlier run left there and this one does not make is removed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from femstruct.errors import FemstructError
from femstruct.files.atomic import completed, replacing

NAME: Final = "written_by_femstruct.json"  # the list, kept in the folder itself
WRITTEN, EARLIER = "written by the last run", "left by earlier runs"

Sizes = Mapping[str, int]  # bytes by name


@contextmanager
def owning(folder: Path, *, finished: bool = True) -> Iterator[list[str]]:
    """Keep a list in a folder of what is written to it here; at the end remove what earlier runs left there and this
    one did not write. Yields the names that are removed, once they are.

    finished : False for a run with cases missing, which removes nothing.

    Only files that the list names are ever removed, and only while they have the size it tells: what somebody else put
    there or changed is theirs. When the writing is interrupted nothing is removed, and the list tells what is of
    this run and what of earlier ones, for the next run to clear.

    >>> import tempfile
    >>> def write(folder, *names):
    ...     with owning(folder) as removed:
    ...         for name in names:
    ...             with replacing(folder / name) as temporary:
    ...                 _ = temporary.write_text("x")
    ...     return removed
    >>> with tempfile.TemporaryDirectory() as name:
    ...     write(Path(name), "a.wav", "b.wav"), write(Path(name), "b.wav")
    ([], ['a.wav'])
    """
    earlier = _listed(folder)
    removed: list[str] = []
    with completed() as paths:
        try:
            yield removed
        except BaseException:
            with suppress(FemstructError):  # what interrupted says more
                _list(folder, paths, earlier)
            raise
    mine = {path.stat().st_ino for path in paths}  # a name may differ in case only
    for name, size in earlier.items() if finished else ():
        if _is_still(folder / name, size) and (folder / name).stat().st_ino not in mine:
            with suppress(OSError):
                (folder / name).unlink()
                removed.append(name)
    _list(folder, paths, {name: size for name, size in earlier.items() if name not in removed})


def _is_still(path: Path, size: int) -> bool:
    """Whether a file is there as it was written."""
    return path.is_file() and not path.is_symlink() and path.stat().st_size == size


def _list(folder: Path, paths: list[Path], earlier: Sizes) -> None:
    """Write the list: what is written here now, and what of earlier runs is still there as it was."""
    written = {path.name: path.stat().st_size for path in paths if path.parent == folder}
    left = {name: size for name, size in earlier.items() if name not in written and _is_still(folder / name, size)}
    told = {"what": "bytes of the files in this folder that femstruct wrote", WRITTEN: written, EARLIER: left}
    with replacing(folder / NAME) as temporary:
        temporary.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")


def _listed(folder: Path) -> Sizes:
    """Files of earlier runs; of a list that is not there or is not ours none."""
    try:
        told = json.loads((folder / NAME).read_text(encoding="utf-8"))
        lists = [told[EARLIER], told[WRITTEN]]
        sizes = {name: size for one in lists for name, size in one.items() if isinstance(size, int)}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return {}
    return {name: size for name, size in sizes.items() if Path(name).name == name}
