"""Files of a run that take their places in a folder together; what an earlier run left there and this one does not
make is removed."""

from __future__ import annotations

import json
import os
import shutil
import signal
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from femstruct.errors import FemstructError
from femstruct.files.atomic import refuse_unwritable_file, replacing, stale, temporary_name
from femstruct.files.set_aside import kept_beside

NAME: Final = "written_by_femstruct.json"  # the list, kept in the folder itself
WRITTEN, EARLIER = "written by the last run", "left by earlier runs"
INPUTS: Final = "inputs of the last run"  # a name for all that it hangs on
COMING: Final = "being replaced by a run that has not finished: some are older than others"

Sizes = Mapping[str, int]  # bytes by name


@dataclass(frozen=True)
class Stage:
    """Where a run writes its files before they take their places, and what became of those that were there.

    removed : files of earlier runs that are gone, filled in at the end. older : those that are kept. aside : the
    folder in which an earlier run of other inputs is now.
    """

    path: Path
    removed: list[str] = field(default_factory=list)
    older: list[str] = field(default_factory=list)
    aside: list[Path] = field(default_factory=list)


@contextmanager
def together(folder: Path, *, finished: bool = True, inputs: str = "", keep: bool = False) -> Iterator[Stage]:
    """A stage to write to, a hidden folder inside `folder`; at the end its files take their places all at once, and
    what earlier runs left there and this one did not write is removed.

    finished : False for a run with cases missing, which removes nothing: what it keeps is told as older. inputs : a
    name for all that the run hangs on. keep : an earlier run of other inputs is first kept in a folder beside this one,
    with a number (`files.set_aside`).

    When the writing is interrupted, or the disk is full, the folder is as it was before. Ctrl-C waits while files take
    their places; where the process is killed in that instant, the list in the folder tells so. Only files that the list
    names are ever removed, and only while they have the size it tells: what somebody else put there or changed is
    theirs.

    >>> import tempfile
    >>> def write(folder, *names):
    ...     with together(folder) as stage:
    ...         for name in names:
    ...             _ = (stage.path / name).write_text("x")
    ...     return stage.removed
    >>> with tempfile.TemporaryDirectory() as name:
    ...     write(Path(name), "a.wav", "b.wav"), write(Path(name), "b.wav")
    ([], ['a.wav'])
    """
    for left in stale(folder / "run"):
        shutil.rmtree(left, ignore_errors=True)
    stage = Stage(temporary_name(folder / "run"))
    try:
        try:
            stage.path.mkdir()
        except OSError as error:
            raise FemstructError(
                str(folder),
                got=f"{error.strerror} while making a folder in it",
                expected="room and permission to write",
                do="free space or choose another folder with -o",
            ) from None
        yield stage
        with _undisturbed():
            _take_places(stage, folder, finished, inputs, keep)
    finally:
        shutil.rmtree(stage.path, ignore_errors=True)


def _take_places(stage: Stage, folder: Path, finished: bool, inputs: str, keep: bool) -> None:
    names = sorted(path.name for path in stage.path.iterdir())
    for name in names:
        refuse_unwritable_file(folder / name)
    earlier, before = _listed(folder)
    there_still = [name for name, size in earlier.items() if _is_still(folder / name, size)]
    if keep and there_still and inputs != before:
        stage.aside.append(kept_beside(folder, [*there_still, NAME]))
        finished = True  # of the earlier run nothing is needed here any more
    sizes = {name: (stage.path / name).stat().st_size for name in names}
    _list(folder, {COMING: names, INPUTS: inputs, WRITTEN: sizes, EARLIER: earlier})
    for name in names:
        (stage.path / name).replace(folder / name)
    mine = {(folder / name).stat().st_ino for name in names}  # a name may differ in case only
    for name, size in earlier.items():
        there = _is_still(folder / name, size) and (folder / name).stat().st_ino not in mine
        if there and finished:
            with suppress(OSError):
                (folder / name).unlink()
                stage.removed.append(name)
        elif there:
            stage.older.append(name)
    kept = {name: size for name, size in earlier.items() if name not in names and _is_still(folder / name, size)}
    _list(folder, {INPUTS: inputs, WRITTEN: sizes, EARLIER: kept})


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Ctrl-C and requests to terminate wait until the end, where the system can make them wait."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _is_still(path: Path, size: int) -> bool:
    """Whether a file is there as it was written."""
    return path.is_file() and not path.is_symlink() and path.stat().st_size == size


def _list(folder: Path, told: Mapping[str, object]) -> None:
    """Write the list: what is written here now, and what of earlier runs is still there as it was."""
    whole = {"what": "bytes of the files in this folder that femstruct wrote", **told}
    with replacing(folder / NAME) as temporary:
        temporary.write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")


def _listed(folder: Path) -> tuple[Sizes, str]:
    """Files of earlier runs, and the inputs of the last; of a list that is not there or is not ours none."""
    try:
        if os.path.getsize(folder / NAME) > 10_000_000:  # noqa: PTH202
            return {}, ""
        told = json.loads((folder / NAME).read_text(encoding="utf-8"))
        lists = [told[EARLIER], told[WRITTEN]]
        sizes = {name: size for one in lists for name, size in one.items() if isinstance(size, int)}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}, ""
    own = {name: size for name, size in sizes.items() if Path(name).name == name and "\0" not in name}
    return own, str(told.get(INPUTS, ""))
