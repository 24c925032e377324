"""Data sets of a universal file, as dictionaries of pyuff: opened, read one by one, written one after the other."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Iterator
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.errors import InputError, InputErrors, sentence
from femstruct.files.atomic import replacing
from femstruct.files.inputs.opening import content

LARGEST: Final = 4 * 2**30  # bytes
_WHAT: Final = "a universal file (.uff, .unv)"
_MARK: Final = re.compile(rb"    -1(?=[\r\n]|\Z| {74})")  # behind binary data not at the beginning of a line
HEADER: Final = 151
LINES: Final = "lines"  # key of a data set that is written as it stands
Set = dict[Any, Any]


def pyuff() -> Any:
    """The package that reads and writes universal files. Raises InputError where it is not installed."""
    try:
        import pyuff as package
    except ImportError:
        raise InputError(
            "universal files",
            got="no package pyuff",
            expected="it installed",
            do="pip install '.[uff]' in the clone, or pip install pyuff",
        ) from None
    return package


def data_sets(path: Path, wanted: Iterable[int]) -> Iterator[tuple[int, int, Set | None]]:
    """(number, line, content) of the data sets of a file, in their order; content is None of those not wanted,
    and of a header that says things its own way: no number depends on it.

    line : where it begins. Raises InputError for a file that is none, InputErrors with the line of a data set that has
    no end or cannot be read.
    """
    package = pyuff()
    starts = _starts(path)
    file = package.UFF(str(path))
    known = frozenset(wanted)
    for index, (number, line) in enumerate(zip(file.get_set_types().tolist(), starts, strict=True)):
        if number not in known:
            yield number, line, None
            continue
        try:
            with redirect_stdout(io.StringIO()):  # pyuff prints what it does not know
                found = file.read_sets(index)
        except Exception as error:  # pyuff raises nothing more precise
            if number != HEADER:
                raise wrong_set(path, line, f"data set {number}, which cannot be read ({_reason(error)})") from None
            found = None
        yield number, line, found


def _reason(error: BaseException) -> str:
    """What pyuff stumbled over, below the sentences it puts over it."""
    while error.__context__ is not None:
        error = error.__context__
    return str(error)


def wrong_set(path: Path, line: int, got: str, expected: str = "", do: str = "") -> InputErrors:
    """A mistake in the data set that begins in a line."""
    expected = expected or "what the description of the data set says"
    return InputErrors((f"{path}:{line}:1: {sentence('', got, expected, do)}",))


def _starts(path: Path) -> list[int]:
    """Lines, counted from 1, in which data sets begin; those behind binary data count its bytes as text."""
    data = content(path, LARGEST, _WHAT)
    places = [mark.start() for mark in _MARK.finditer(data)]
    if not places:
        got = f"'{path}' without a line of -1 in columns 5 and 6"
        raise InputError(str(path), got=got, expected=_WHAT)
    ends = np.flatnonzero(np.frombuffer(data, np.uint8) == ord("\n"))
    lines: list[int] = (np.searchsorted(ends, places) + 1).tolist()
    if len(lines) % 2:
        raise wrong_set(path, lines[-1], "a data set without its end", "a line with -1", "the file is cut off")
    return lines[::2]


def write_sets(sets: Iterable[Set], path: Path) -> None:
    """Write data sets to a file, whole or not at all. Raises InputError for one that pyuff refuses."""
    package = pyuff()
    with replacing(path) as temporary, temporary.open("wb") as file:
        piece = temporary.with_name(f"{temporary.name}.set")  # pyuff reads all it has written after every set
        try:
            for one in sets:
                if LINES in one:
                    file.write(("\n".join(one[LINES]) + "\n").encode("ascii"))
                    continue
                try:
                    package.UFF(str(piece)).write_sets([one], mode="overwrite")
                except OSError:
                    raise
                except Exception as error:  # pyuff raises nothing more precise
                    got = f"a data set {one['type']} that cannot be written ({_reason(error)})"
                    raise InputError(str(path), got=got, expected="numbers that fit each other") from None
                file.write(piece.read_bytes())
        finally:
            piece.unlink(missing_ok=True)
