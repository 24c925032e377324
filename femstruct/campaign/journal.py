"""Rows as they come, kept so that neither a kill nor a power cut loses one that was finished."""

from __future__ import annotations

import json
import sqlite3
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from math import isfinite, nan
from pathlib import Path
from typing import Final

from femstruct.campaign.numbers import Number
from femstruct.errors import FemstructError, InputError
from femstruct.files.contents import contents
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
FORMAT: Final = "2"  # of the tables below: rows in tables of another are not gone on with
TABLES: Final = (
    "create table if not exists campaign (name text)",
    "create table if not exists files (path text primary key, digest text)",
    "create table if not exists rows (design text, sample integer, case_name text, packed blob, "
    "primary key (design, sample, case_name))",
)


@dataclass(frozen=True)
class Row:
    """A sample in one case. findings, severe : codes of all, and of those that forbid trust. trouble : why there are no
    numbers, "" where there are. again : whether the next command runs it again, as its run never came to an end.
    design : of a search its case and its texts ``PATH=VALUE``, which its number does not tell. files : digests of all
    that it was read from, by name; a journal keeps them once for all rows."""

    sample: int
    case: str
    numbers: Mapping[str, Number]
    findings: tuple[str, ...] = ()
    severe: tuple[str, ...] = ()
    trouble: str = ""
    again: bool = False
    design: tuple[str, ...] = ()
    files: Mapping[str, str] = field(default_factory=dict)


class Journal:
    """Rows in a file, by design and sample.

    Notes
    -----
    A database of SQLite: what `append` has returned from stays, whenever the process is killed; what was under way is
    not there at all.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self._path, self._connection = path, connection
        self._files = dict(connection.execute("select path, digest from files"))

    def append(self, rows: Sequence[Row]) -> list[Row]:
        """Keep the rows of whole samples, in place of those that they had before; returns them as they are kept.

        Raises FemstructError where the disk refuses, InputError where a file has changed since the rows before.
        """
        files = {path: digest for row in rows for path, digest in row.files.items()}
        for path, digest in files.items():
            if self._files.setdefault(path, digest) != digest:
                raise InputError(
                    path,
                    got="a file that was changed while rows were computed from it",
                    expected="the same content for all rows",
                    do="change it back to go on, or run the same command to begin again",
                )
        packed = [(json.dumps(row.design), row.sample, row.case, _packed(row)) for row in rows]
        try:
            with self._connection:
                whole = {one[:2] for one in packed}
                self._connection.executemany("delete from rows where design = ? and sample = ?", whole)
                self._connection.executemany("insert into rows values (?, ?, ?, ?)", packed)
                self._connection.executemany("insert or ignore into files values (?, ?)", files.items())
        except sqlite3.Error as error:
            raise FemstructError(
                str(self._path), got=f"{error} while writing", expected="room and permission to write", do="free space"
            ) from error
        return [_unpacked(*one) for one in packed]

    def remove(self) -> None:
        """Take the file away, as if it had never been."""
        self._path.unlink(missing_ok=True)

    def rows(self) -> list[Row]:
        """All that is kept, by sample; without their files."""
        found = self._connection.execute("select design, sample, case_name, packed from rows order by sample, rowid")
        return [_unpacked(*one) for one in found]

    def refuse_changed_files(self) -> None:
        """Raise InputError where a file is not as it was when rows were computed from it."""
        now = contents(self._files)
        if changed := next((path for path, digest in self._files.items() if now[path] != digest), ""):
            got = f"rows from before '{changed}' was changed"
            raise InputError(str(self._path), got=got, expected="those of this one", do="choose another with -o")


@contextmanager
def opened(path: Path, campaign: str) -> Iterator[Journal]:
    """The journal of a campaign, new or gone on with. campaign : a name for all that its rows hang on but for the files
    that some samples alone are read from, as the second of two models; these the journal knows from its rows.

    Raises InputError for a file that is no journal, that of another campaign, or with rows of files that have changed.
    """
    name = f"{FORMAT} {campaign}"
    try:
        with closing(sqlite3.connect(path)) as connection:
            connection.execute("pragma synchronous = full")
            with connection:
                for table in TABLES:
                    connection.execute(table)
                known = connection.execute("select name from campaign").fetchone()
                if known is None:
                    connection.execute("insert into campaign values (?)", (name,))
            if known is not None and known[0] != name:
                raise InputError(
                    str(path),
                    got="rows of another campaign",
                    expected="those of this one",
                    do="choose another with -o",
                )
            journal = Journal(path, connection)
            journal.refuse_changed_files()
            yield journal
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
    are none. Rows of which none has a number are removed. What else is in the folder stays as it is."""
    if not path.exists() or is_of(path, campaign):
        return None
    if not _has_numbers(path):
        path.unlink()
        return None
    own = [path.with_suffix(suffix) for suffix in (path.suffix, *BESIDE)]
    return moved(own)[0]


def _has_numbers(path: Path) -> bool:
    """Whether rows of whatever campaign have any number; of what cannot be read nobody knows, and it may have."""
    try:
        with closing(sqlite3.connect(path)) as connection:
            return any(json.loads(zlib.decompress(one))[0] for (one,) in connection.execute("select packed from rows"))
    except (sqlite3.DatabaseError, zlib.error, ValueError):
        return True


def _packed(row: Row) -> bytes:
    numbers = {name: [one.value if isfinite(one.value) else None, one.unit] for name, one in row.numbers.items()}
    told = [numbers, row.findings, row.severe, row.trouble, row.again]
    return zlib.compress(json.dumps(told, allow_nan=False).encode(), 1)


def _unpacked(design: str, sample: int, case: str, packed: bytes) -> Row:
    numbers, findings, severe, trouble, again = json.loads(zlib.decompress(packed))
    read = {name: Number(nan if value is None else value, unit) for name, (value, unit) in numbers.items()}
    return Row(sample, case, read, tuple(findings), tuple(severe), trouble, again, tuple(json.loads(design)))
