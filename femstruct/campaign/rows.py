"""Numbers of a case by name, rows kept as they come, and what a campaign leaves behind."""

from __future__ import annotations

import json
import sqlite3
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from difflib import get_close_matches
from math import isfinite, nan, pi
from pathlib import Path
from typing import Any, Final, NamedTuple

from femstruct.errors import FemstructError, InputError
from femstruct.files.campaign_files import SWEEP, TABLE, write_found, write_front_table, write_swept, write_table
from femstruct.files.study_tables import case_table
from femstruct.files.writing import contents, move_together
from femstruct.study.asked import SETTLED
from femstruct.study.campaigns import EXCEEDED, MET, UNKNOWN, UNROUNDED, Swept, limit_name, value_name, verdict_name
from femstruct.study.optima import Found, Front
from femstruct.study.results import CaseResult
from femstruct.workflow.case_comparison import verdicts
from femstruct.workflow.provenance import Progress

# ----------------------------------------------------------------------------------------------------------------------
# The numbers of a case by name: those that are asked for first, in the words of `limits:`, then all others.
# ----------------------------------------------------------------------------------------------------------------------

MODES: Final = 10  # natural frequencies among the numbers
APART: Final = " / "  # between the steps of a name
_LEFT_OUT: Final = ("basis", "outcome", "findings", "error_estimate", "accuracy")
_UNITS: Final = {
    "hz": "Hz", "db": "dB", "n": "N", "s": "s", "m": "m", "j": "J", "pa": "Pa", "w": "W", "kg": "kg", "rad": "rad",
    "percent": "%",
}  # fmt: skip


class Number(NamedTuple):
    """A number and its unit; nan where it cannot be had, for a reason that the findings give."""

    value: float
    unit: str


def numbers_of(case: CaseResult) -> dict[str, Number]:
    """All numbers of a case by name.

    The first are the main ones (`main_numbers`); the names of the others are their paths in summary.json, as in
    "levels / living.middle / bands_db / 63". Between them are limits, `numbers_of_limit`.
    """
    own = dict(main_numbers(case))
    own |= _of_limits(case)
    for name, number in _flat({key: one for key, one in case_table(case).items() if key not in _LEFT_OUT}):
        own.setdefault(name, number)
    return own


def only_numbers(cases: Mapping[str, Mapping[str, Number]], only: Sequence[str]) -> dict[str, dict[str, Number]]:
    """The numbers of these names, by case. A case may be without some, such as one without the body that they are of;
    all may be without one of a table where there is none, such as a time of separation.

    Raises InputError for a name of no number of any case.

    >>> cases = {"bare": {"total mass": Number(2.0, "kg")}, "damped": {"total mass": Number(2.0, "kg")}}
    >>> only_numbers(cases, ["total mass"])["bare"]
    {'total mass': Number(value=2.0, unit='kg')}
    """
    known = {name for numbers in cases.values() for name in numbers}
    tables = {name.partition(APART)[0] for name in known if APART in name}
    for name in only:
        table, apart, _ = name.partition(APART)
        if name not in known and not (apart and table in tables):
            near = get_close_matches(name, known, n=1, cutoff=0.5)
            do = f"did you mean '{near[0]}'?" if near else "femstruct sweep STUDY --plan lists the main ones"
            raise InputError("samples.only", got=f"'{name}'", expected="a number of the study", do=do)
    return {case: choose_numbers(own, only) for case, own in cases.items()}


def choose_numbers(numbers: Mapping[str, Number], only: Sequence[str]) -> dict[str, Number]:
    """The numbers of these names that there are, each with its limit, what is compared with it, and the verdict."""
    of_limit = (limit_name, value_name, verdict_name)
    with_limits = (each for name in only for each in (name, *(one(name) for one in of_limit)))
    return {name: numbers[name] for name in with_limits if name in numbers}


def numbers_of_limit(name: str, limit: float, unit: str, value: float | None, met: bool | None) -> dict[str, Number]:
    """A limit, what is compared with it and the verdict as numbers of a row.

    Parameters
    ----------
    met : bool | None
        None where the run cannot tell.

    Examples
    --------
    >>> [one.value for one in numbers_of_limit("settled", 0.7, "s", None, False).values()]
    [0.7, nan, 0.0]
    """
    verdict = UNKNOWN if met is None else MET if met else EXCEEDED
    return {
        limit_name(name): Number(limit, unit),
        value_name(name): _number(None if met is None else value, unit),
        verdict_name(name): Number(verdict, "1"),
    }


def _of_limits(case: CaseResult) -> dict[str, Number]:
    found: dict[str, Number] = {}
    for limit, one in zip(case.case.study.limits, verdicts(case), strict=False):  # no impact has no verdicts
        found |= numbers_of_limit(limit.name, limit.value, one.unit, one.value, one.met)
    return found


def main_numbers(case: CaseResult) -> Iterator[tuple[str, Number]]:
    """What a limit can be set to, and what else is asked of a case first: the time to rest where it is limited, ratings
    and levels of rooms, the peaks of recorded channels in the whole window, the energy in the structure when the
    contacts have opened (at the end where they do not), peak forces of contacts, peaks of frequency responses, natural
    frequencies, the mass. There is no rating where bands are blank that it needs."""
    for verdict in verdicts(case):
        if verdict.name == SETTLED:
            yield SETTLED, _number(verdict.value, "s")
    for name, room in case.rated.items():
        known = None if room.rating is None or room.rating.blank_hz else room.rating
        yield f"{name} rating", _number(None if known is None else known.value_db, "dB")
        yield f"{name} rating{UNROUNDED}", _number(None if known is None else known.unrounded_db, "dB")
    of_drop = f" of {next(iter(case.drops))}" if len(case.drops) > 1 else ""
    for name, one in (case.heard.total_levels or case.levels).items():
        yield f"{name} L_AFmax{of_drop}", _number(one.l_afmax_db, "dB")
    for name, channel in case.channels.items():
        yield name, _number(channel.whole, channel.unit)
    if case.response is not None:
        ledger = case.response.ledger
        yield "structure energy", _number((ledger.at_separation or ledger.end).structure, "J")
        for name, contact in case.response.contacts.items():
            if f"{name} force" in case.channels:
                continue  # the same number
            yield f"{name} peak force", _number(contact.peak_force, "N")
    for name, response in case.frf.items():
        yield f"{name} peak", _number(response.peak, response.unit)
    basis = case.basis
    for number, omega in enumerate(basis.omega[basis.modes][:MODES], 1):
        yield f"mode {number} frequency", _number(float(omega) / (2.0 * pi), "Hz")
    yield "total mass", _number(basis.total_mass, "kg")


def _number(value: float | None, unit: str) -> Number:
    return Number(nan if value is None or not isfinite(value) else float(value), unit)


def _flat(table: Mapping[str, Any], before: tuple[str, ...] = ()) -> Iterator[tuple[str, Number]]:
    """Numbers of nested mappings, named by their path. A mapping's "unit" is that of the numbers beside it."""
    unit = table.get("unit")
    for key, one in table.items():
        steps = (*before, str(key))
        if isinstance(one, Mapping):
            yield from _flat(one, steps)
        elif isinstance(one, int | float):
            yield APART.join(steps), _number(float(one), unit if isinstance(unit, str) else _unit(steps))


def _unit(steps: tuple[str, ...]) -> str:
    """The unit that the last word of a key states, else that of a mapping around it.

    >>> _unit(("levels", "a.b", "bands_db", "63")), _unit(("contacts", "a", "closings"))
    ('dB', '')
    """
    for step in reversed(steps):
        _, joined, last = step.rpartition("_")
        if joined and last in _UNITS:
            return _UNITS[last]
    return "J" if steps[0] == "energy" and steps[-1] != "ledger_residual" else ""


# ----------------------------------------------------------------------------------------------------------------------
# Rows as they come, kept so that neither a kill nor a power cut loses one that was finished.
# ----------------------------------------------------------------------------------------------------------------------

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
def open_journal(path: Path, campaign: str) -> Iterator[Journal]:
    """The journal of a campaign, new or gone on with.

    Parameters
    ----------
    campaign : str
        A name for all that its rows hang on but for the files that some samples alone are read from, as the second of
        two models; these the journal knows from its rows.

    Raises
    ------
    InputError
        For a file that is no journal, that of another campaign, or with rows of files that have changed.
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
        with open_journal(path, campaign):
            return True
    except InputError:
        return False


def rename_previous(path: Path, campaign: str) -> Path | None:
    """Give the files of another campaign names with a number, as sweep.1.h5; returns that of its rows, None where there
    are none. Rows of which none has a number are removed. What else is in the folder stays as it is."""
    if not path.exists() or is_of(path, campaign):
        return None
    if not _has_numbers(path):
        path.unlink()
        return None
    own = [path.with_suffix(suffix) for suffix in (path.suffix, *BESIDE)]
    return move_together(own)[0]


def _has_numbers(path: Path) -> bool:
    """Whether rows of whatever campaign have any number; of what cannot be read nobody knows, and it may have."""
    try:
        with closing(sqlite3.connect(path)) as connection:
            return any(json.loads(zlib.decompress(one))[0] for (one,) in connection.execute("select packed from rows"))
    except (sqlite3.DatabaseError, zlib.error, ValueError):
        return True


def _packed(row: Row) -> bytes:
    numbers = {name: [one.value if isfinite(one.value) else None, one.unit] for name, one in row.numbers.items()}
    content = [numbers, row.findings, row.severe, row.trouble, row.again]
    return zlib.compress(json.dumps(content, allow_nan=False).encode(), 1)


def _unpacked(design: str, sample: int, case: str, packed: bytes) -> Row:
    numbers, findings, severe, trouble, again = json.loads(zlib.decompress(packed))
    read = {name: Number(nan if value is None else value, unit) for name, (value, unit) in numbers.items()}
    return Row(
        sample,
        case,
        numbers=read,
        findings=tuple(findings),
        severe=tuple(severe),
        trouble=trouble,
        again=again,
        design=tuple(json.loads(design)),
    )


# ----------------------------------------------------------------------------------------------------------------------
# What a campaign leaves behind: rows in a file, a table and a picture.
# ----------------------------------------------------------------------------------------------------------------------

PICTURE, PAGE = "sweep.png", "sweep.html"
OPTIMUM = ("optimise.h5", "optimise.csv", "optimise.png", "optimise.html")
FRONT = "optimise.front.csv"


def write_rows(
    rows: Swept,
    folder: Path,
    names: Sequence[str] = (),
    progress: Progress = lambda line: None,
    pictures: bool = True,
) -> list[Path]:
    """Write sweep.h5 with all numbers, sweep.csv, pictures and the page sweep.html with some; returns what was
    written.

    Parameters
    ----------
    names : Sequence[str]
        Of the numbers in the table and in the picture, the main ones if none.
    """
    folder.mkdir(parents=True, exist_ok=True)
    progress("writing the rows")
    write_swept(folder / SWEEP, rows)
    write_table(folder / TABLE, rows, names)
    written, saved = [folder / SWEEP, folder / TABLE], list[Path]()
    if pictures:
        from femstruct.view.campaign_figures import bands_figure, swept_figure, swept_parallel

        progress("pictures")
        chosen_names = names or rows.main
        figures = (swept_figure(rows, chosen_names), swept_parallel(rows, chosen_names), bands_figure(rows))
        saved = _saved(folder, zip((PICTURE, "sweep.parallel.png", "sweep.bands.png"), figures, strict=True))
    return [*written, *saved, _page(folder / PAGE, rows, saved, names)]


def write_optimum(
    found: Found | Front, folder: Path, progress: Progress = lambda line: None, pictures: bool = True
) -> list[Path]:
    """Write optimise.h5 with the answer and all numbers of all designs, optimise.csv, pictures, the page optimise.html,
    of a front optimise.front.csv too; returns what was written."""
    folder.mkdir(parents=True, exist_ok=True)
    answer, table = (folder / name for name in OPTIMUM[:2])
    progress("writing the rows")
    write_found(answer, found)
    goals = [one.name for one in found.search.goals]
    finer = [name + UNROUNDED for name in goals if name + UNROUNDED in found.rows.names]
    write_table(
        table, found.rows, [name for name in (*goals, *finer, *found.search.limits) if name in found.rows.names]
    )
    written, saved = [answer, table], list[Path]()
    if isinstance(found, Front):
        write_front_table(folder / FRONT, found)
        written.append(folder / FRONT)
    if pictures:
        from femstruct.view.campaign_figures import front_figure, front_parallel, optimum_figure

        progress("pictures")
        figures = (front_figure(found), front_parallel(found)) if isinstance(found, Front) else (optimum_figure(found),)
        saved = _saved(folder, zip((OPTIMUM[2], "optimise.parallel.png"), figures, strict=False))
    return [*written, *saved, _page(folder / OPTIMUM[3], found, saved)]


def _page(path: Path, answer: Swept | Found | Front, pictures: Sequence[Path], names: Sequence[str] = ()) -> Path:
    from femstruct.view.campaign_page import write_page

    return write_page(path, answer, {one.name: one.read_bytes() for one in pictures}, names)


def _saved(folder: Path, figures: Iterable[tuple[str, Any]]) -> list[Path]:
    """Write figures by name; those that are None are taken away, where they are of rows that were there before."""
    from femstruct.view.drawing import save

    written = []
    for name, figure in figures:
        if figure is None:
            (folder / name).unlink(missing_ok=True)
        else:
            written.append(save(figure, folder / name))
    return written
