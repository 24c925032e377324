"""Writing files whole or not at all, and setting aside what an earlier run left."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import signal
import socket
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Final

from femstruct.errors import FemstructError, InputError

# ----------------------------------------------------------------------------------------------------------------------
# Writing a file whole or not at all.
# ----------------------------------------------------------------------------------------------------------------------

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
    suffix = "_" + hashlib.sha256(whole).hexdigest()[:10]
    return whole[: _LONGEST - len(suffix)].decode(errors="ignore") + suffix


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


# ----------------------------------------------------------------------------------------------------------------------
# What is in files now, by a digest of each: whether something that was made from them would be the same again.
# ----------------------------------------------------------------------------------------------------------------------


def contents(names: Iterable[str]) -> dict[str, str]:
    """A digest of every file, by its name; "" of what cannot be read.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "a.csv")
    ...     _ = path.write_text("1")
    ...     before = contents([str(path)])
    ...     _ = path.write_text("2")
    ...     before == contents([str(path)]), contents([folder])[folder]
    (False, '')
    """
    return {name: _digest(Path(name)) for name in dict.fromkeys(names)}


def _digest(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


# ----------------------------------------------------------------------------------------------------------------------
# What an earlier run left is set aside under names with a number, where a later one would take its place.
# ----------------------------------------------------------------------------------------------------------------------

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


def move_together(paths: Sequence[Path]) -> list[Path]:
    """Give files that belong together names with one number; those that are not there are left out of it."""
    new = numbered(paths)
    for old, other in zip(paths, new, strict=True):
        if old.exists():
            old.rename(other)
    return new


def move_previous_folder(folder: Path, names: Sequence[str]) -> Path:
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
    ...     move_previous_folder(folder, ["a.wav"]).name, move_previous_folder(folder, ["a.wav"]).name
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


# ----------------------------------------------------------------------------------------------------------------------
# Files of a run that take their places in a folder together; what an earlier run left there and this one does not
# make is removed.
# ----------------------------------------------------------------------------------------------------------------------

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
def staged_folder(folder: Path, *, finished: bool = True, inputs: str = "", keep: bool = False) -> Iterator[Stage]:
    """A stage to write to, a hidden folder inside `folder`; at the end its files take their places all at once, and
    what earlier runs left there and this one did not write is removed.

    When the writing is interrupted, or the disk is full, the folder is as it was before. Ctrl-C waits while files take
    their places; where the process is killed in that instant, the list in the folder tells so. Only files that the list
    names are ever removed, and only while they have the size it tells: what somebody else put there or changed is
    theirs.

    Parameters
    ----------
    finished : bool
        False for a run with cases missing, which removes nothing: what it keeps is told as older.
    inputs : str
        A name for all that the run hangs on.
    keep : bool
        An earlier run of other inputs is first kept in a folder beside this one, with a number (`files.set_aside`).

    Examples
    --------
    >>> import tempfile
    >>> def write(folder, *names):
    ...     with staged_folder(folder) as stage:
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
        stage.aside.append(move_previous_folder(folder, [*there_still, NAME]))
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


def _list(folder: Path, content: Mapping[str, object]) -> None:
    """Write the list: what is written here now, and what of earlier runs is still there as it was."""
    whole = {"what": "bytes of the files in this folder that femstruct wrote", **content}
    with replacing(folder / NAME) as temporary:
        temporary.write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")


def _listed(folder: Path) -> tuple[Sizes, str]:
    """Files of earlier runs, and the inputs of the last; of a list that is not there or is not ours none."""
    try:
        if os.path.getsize(folder / NAME) > 10_000_000:  # noqa: PTH202
            return {}, ""
        content = json.loads((folder / NAME).read_text(encoding="utf-8"))
        lists = [content[EARLIER], content[WRITTEN]]
        sizes = {name: size for one in lists for name, size in one.items() if isinstance(size, int)}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}, ""
    own = {name: size for name, size in sizes.items() if Path(name).name == name and "\0" not in name}
    return own, str(content.get(INPUTS, ""))
