"""Rows as they come, kept so that neither a kill nor a power cut loses one that was finished."""

from __future__ import annotations

import json
import sqlite3
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from math import isfinite, nan
from pathlib import Path
from typing import Final

from femstruct.campaign.numbers import Number
from femstruct.errors import FemstructError, InputError
from femstruct.files.set_aside import moved

BESIDE: Final = (
    ".h5",
    ".csv",
    ".html",
    ".png",
    ".front.csv",
    ".parallel.png",
    ".bands.png",
)  # suffixes of what rows become


@dataclass(frozen=True)
class Row:
    """A sample in one case. findings, severe : codes of all, and of those that forbid trust. trouble : why there are no
    numbers, "" where there are."""

    sample: int
    case: str
    numbers: Mapping[str, Number]
    findings: tuple[str, ...] = ()
    severe: tuple[str, ...] = ()
    trouble: str = ""


class Journal:
    """Rows in a file, by sample.

    Notes
    -----
    A database of SQLite: what `append` has returned from stays, whenever the process is killed; what was under way is
    not there at all.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self._path, self._connection = path, connection

    def append(self, rows: Sequence[Row]) -> None:
        """Keep the rows of whole samples. Raises FemstructError where the disk refuses."""
        packed = [(row.sample, row.case, _packed(row)) for row in rows]
        try:
            with self._connection:
                self._connection.executemany("insert or replace into rows values (?, ?, ?)", packed)
        except sqlite3.Error as error:
            raise FemstructError(
                str(self._path), got=f"{error} while writing", expected="room and permission to write", do="free space"
            ) from error

    def remove(self) -> None:
        """Take the file away, as if it had never been."""
        self._path.unlink(missing_ok=True)

    def rows(self) -> list[Row]:
        """All that is kept, by sample."""
        found = self._connection.execute("select sample, case_name, packed from rows order by sample, rowid")
        return [_unpacked(sample, case, packed) for sample, case, packed in found]


@contextmanager
def opened(path: Path, campaign: str) -> Iterator[Journal]:
    """The journal of a campaign, new or gone on with. campaign : a name for all that it was made from.

    Raises InputError for a file that is no journal, or that of another campaign.
    """
    try:
        with closing(sqlite3.connect(path)) as connection:
            connection.execute("pragma synchronous = full")
            with connection:
                connection.execute("create table if not exists campaign (name text)")
                connection.execute(
                    "create table if not exists rows (sample integer, case_name text, packed blob, "
                    "primary key (sample, case_name))"
                )
                known = connection.execute("select name from campaign").fetchone()
                if known is None:
                    connection.execute("insert into campaign values (?)", (campaign,))
            if known is not None and known[0] != campaign:
                raise InputError(
                    str(path),
                    got="rows of another campaign",
                    expected="those of this one",
                    do="choose another with -o",
                )
            yield Journal(path, connection)
    except sqlite3.DatabaseError as error:
        raise InputError(str(path), got=f"{error}", expected="rows of a campaign", do="remove the file") from None


def is_of(path: Path, campaign: str) -> bool:
    """Whether a journal is that of a campaign."""
    try:
        with opened(path, campaign):
            return True
    except InputError:
        return False


def moved_aside(path: Path, campaign: str) -> Path | None:
    """Give the files of another campaign names with a number, as sweep.1.h5; returns that of its rows, None where there
    are none. What else is in the folder stays as it is."""
    if not path.exists() or is_of(path, campaign):
        return None
    own = [path.with_suffix(suffix) for suffix in (path.suffix, *BESIDE)]
    return moved(own)[0]


def _packed(row: Row) -> bytes:
    numbers = {name: [one.value if isfinite(one.value) else None, one.unit] for name, one in row.numbers.items()}
    told = [numbers, row.findings, row.severe, row.trouble]
    return zlib.compress(json.dumps(told, allow_nan=False).encode(), 1)


def _unpacked(sample: int, case: str, packed: bytes) -> Row:
    numbers, findings, severe, trouble = json.loads(zlib.decompress(packed))
    read = {name: Number(nan if value is None else value, unit) for name, (value, unit) in numbers.items()}
    return Row(sample, case, read, tuple(findings), tuple(severe), trouble)
