"""Tables of text as analysers write them: opened, decoded, split into cells, their heads and units read."""

from __future__ import annotations

import csv
import io
import os
import re
import stat
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError, InputErrors, quote_value, sentence
from femstruct.units import DIMENSIONS, QuantityError, quantity

# ----------------------------------------------------------------------------------------------------------------------
# Lines of a mesh file in text, and mistakes in them by file and line.
# ----------------------------------------------------------------------------------------------------------------------

_NUL: Final = "\0"


def wrong_line(path: Path, number: int, got: str, expected: str, do: str = "") -> InputErrors:
    """A mistake in a line, counted from 1."""
    return InputErrors((f"{path}:{number}:1: {sentence('', got, expected, do)}",))


def lines_of(path: Path, data: bytes) -> list[str]:
    """The lines of a file in UTF-8, or in Latin-1 as old programs write it. Raises InputErrors for what is no text."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if _NUL in text:
        raise wrong_line(path, text[: text.index(_NUL)].count("\n") + 1, "a file that is no text", "a mesh in text")
    return text.splitlines()


def integers(path: Path, lines: Iterable[tuple[int, Sequence[str]]]) -> Integers:
    """All whole numbers of numbered lines of words, in a row. Raises InputErrors with the line of another word."""
    found: list[int] = []
    for number, words in lines:
        try:
            found += map(int, words)
        except ValueError:
            raise wrong_line(path, number, quote_value(", ".join(words)), "whole numbers") from None
    return np.array(found, dtype=np.int64)


def floats(path: Path, lines: Iterable[tuple[int, Sequence[str]]]) -> Floats:
    """All numbers of numbered lines of words, one after the other; exponents with D, as Fortran writes them, too."""
    found: list[float] = []
    for number, words in lines:
        try:
            some = [float(word.replace("D", "E").replace("d", "e")) for word in words]
        except ValueError:
            raise wrong_line(path, number, quote_value(", ".join(words)), "numbers") from None
        if not np.isfinite(some).all():
            raise wrong_line(path, number, quote_value(", ".join(words)), "finite numbers")
        found += some
    return np.array(found)


# ----------------------------------------------------------------------------------------------------------------------
# Opening what a user names: ordinary files only, of a bounded size, and from a study only where it says so.
# ----------------------------------------------------------------------------------------------------------------------

_KINDS: Final = (
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)
_PLAINLY: Final = "a path from this file's folder, such as ../meshes/room.msh"


def content(path: Path, most: int, what: str) -> bytes:
    """The bytes of an ordinary file.

    Parameters
    ----------
    what : str
        What it should be, such as "a YAML file".

    Raises
    ------
    InputError
        For a file that is not there, a folder, a pipe or a device (which may never end), a file of more than `most`
        bytes, and what the system does not let us read.
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
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(str(path), got=f"'{path}', which cannot be read ({reason})", expected=what) from None
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


# ----------------------------------------------------------------------------------------------------------------------
# Text of files that analysers wrote: UTF-8, UTF-16 and what Windows has in Germany, Japan and Korea.
# ----------------------------------------------------------------------------------------------------------------------

_EXPECTED: Final = "a table of text in UTF-8, UTF-16, cp1252, Shift-JIS or cp949"
_SAVE: Final = "save it as 'CSV UTF-8'"
_MARKS: Final = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
_NULS: Final = 0.1  # of a file, at least
_HIGH: Final = re.compile(rb"[\x80-\xff]+")
_SIGNS: Final = r"\x00-\x7f\u00b0\u00b1\u00b2\u00b3\u00b5\u00b7\u00d7\u0394\u03bc\u2103\u2126\u3380-\u33dd"  # of units
_WESTERN: Final = re.compile(rf"[{_SIGNS}\u00a0\u00c0-\u00f6\u00f8-\u00ff\u2013\u2014\u2018-\u201e\u20ac]*")
_JAPANESE: Final = re.compile(rf"[{_SIGNS}\u3000-\u30ff\u4e00-\u9fff\uff01-\uff5e]*")
_KOREAN: Final = re.compile(rf"[{_SIGNS}\u3000-\u303f\uac00-\ud7a3\uff01-\uff5e]*")
_HANGUL: Final = re.compile("[\uac00-\ud7a3]")
_KANJI: Final = re.compile("[\u3040-\u30ff\u4e00-\u9fff]")
_KNOWN: Final = (  # in this order: plain Korean is no Shift-JIS, but the wider cp949 has most of its pairs
    ("euc_kr", _KOREAN, _HANGUL),
    ("cp932", _JAPANESE, _KANJI),
    ("cp949", _KOREAN, _HANGUL),
)


def decoded(path: Path, data: bytes) -> str:
    """The text of a file.

    Raises InputErrors, with the line, for what is no text and for text in an encoding that cannot be determined.

    Notes
    -----
    What has a byte order mark, or is right UTF-8, is that. Else an encoding is taken if all that is not ASCII is of its
    language: hangul of cp949; kana and kanji of Shift-JIS; single letters with accents between others, or signs of
    units, of cp1252. Numbers are ASCII in all of them.

    >>> decoded(Path("t.csv"), "Hz;Räume [s]".encode("cp1252")), decoded(Path("t.csv"), "주파수".encode("cp949"))
    ('Hz;Räume [s]', '주파수')
    >>> decoded(Path("t.csv"), "周波数、残響時間".encode("cp932")), decoded(Path("t.csv"), "63;1".encode("utf-16-le"))
    ('周波数、残響時間', '63;1')
    """
    for mark, name in _MARKS:
        if data.startswith(mark):
            return _strictly(path, data, name)
    first, second = data[::2].count(b"\0"), data[1::2].count(b"\0")  # every other byte of numbers in UTF-16
    if max(first, second) >= _NULS * len(data) > 10 * min(first, second):
        return _strictly(path, data, "utf-16-le" if second > first else "utf-16-be")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        return _legacy(path, data, error.start)
    return _text(path, text)


def _strictly(path: Path, data: bytes, encoding: str) -> str:
    try:
        return _text(path, data.decode(encoding))
    except UnicodeDecodeError as error:
        line = data[: error.start].decode(encoding, errors="replace").count("\n") + 1
        raise _wrong(path, line, f"a character that is not {encoding.upper()}") from None


def _legacy(path: Path, data: bytes, first: int) -> str:
    longest = max(map(len, _HIGH.findall(data)))  # bytes that are not ASCII side by side
    western = ("cp1252", _WESTERN, re.compile(""))
    for encoding, whole, telling in (western, *_KNOWN) if longest == 1 else (*_KNOWN, western):
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if whole.fullmatch(text) and telling.search(text) and not (encoding == "cp1252" and longest > 2):
            return _text(path, text)
    line = data[:first].count(b"\n") + 1
    raise _wrong(path, line, f"a character in an unknown encoding (byte 0x{data[first]:02x})")


def _text(path: Path, text: str) -> str:
    if "\0" in text:
        raise _wrong(path, text[: text.index("\0")].count("\n") + 1, "a file that is no text")
    return text


def _wrong(path: Path, line: int, got: str) -> InputErrors:
    return InputErrors((f"{path}:{line}:1: {sentence('', got, _EXPECTED, _SAVE)}",))


# ----------------------------------------------------------------------------------------------------------------------
# Tables of text as analysers write them: cells by line, whatever separates them and their decimals.
# ----------------------------------------------------------------------------------------------------------------------

LARGEST: Final = 50_000_000  # bytes
_NUMBER: Final = re.compile(r"[+-]?(\d+(\.\d*|,\d+)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
_GROUPED: Final = re.compile(
    r"[+-]?\d{1,3}(?:([ '\u2019\u00a0\u202f])\d{3}(?:\1\d{3})*(?:[.,]\d*)?|(?:,\d{3})+\.\d*"
    r"|(?:\.\d{3})+,\d*|(?:,\d{3}){2,}|(?:\.\d{3}){2,})",
    re.ASCII,
)
_BLANKS: Final = re.compile(r"\s+")
_LINES_READ: Final = 200  # lines by which separators are told


class TextRow(NamedTuple):
    """A line of a table: its number, from 1, and its cells."""

    line: int
    cells: list[str]


@dataclass(frozen=True)
class TextTable:
    """Lines of a table that are not empty and no comments (#). comma : whether its decimals have a comma."""

    path: Path
    rows: tuple[TextRow, ...]
    comma: bool

    def number(self, row: TextRow, cell: str) -> float | None:
        """The number in a cell; None for words. Raises InputErrors for thousands separators, and for decimals of
        another kind than those of the table."""
        if _GROUPED.fullmatch(cell):
            raise self.wrong(
                row, f"{quote_value(cell)}, a number with a thousands separator", "a number without", _LEAVE
            )
        if not _NUMBER.fullmatch(cell):
            return None
        if ("," in cell) != self.comma and ("," in cell or "." in cell):
            got = f"{quote_value(cell)} in a table whose decimals have a {'comma' if self.comma else 'point'}"
            raise self.wrong(row, got, "decimals of one kind and no thousands separators", _LEAVE)
        return float(cell.replace(",", "."))

    def refuse_longer(self, row: TextRow) -> None:
        """Raise InputErrors for a line with more cells than the first has, as decimal commas between commas make it."""
        count, heads = len(row.cells), len(self.rows[0].cells)
        if any(row.cells[heads:]):
            raise self.wrong(row, f"{count} cells below {heads} head{'s' * (heads > 1)}", "one below each", _SEMICOLONS)

    def wrong(self, row: TextRow, got: str, expected: str, do: str = "") -> InputErrors:
        """A mistake in one of its lines."""
        return wrong_in(self.path, row.line, InputError("", got=got, expected=expected, do=do))


_LEAVE: Final = "leave out thousands separators, and write all decimals alike"
_SEMICOLONS: Final = "where decimals have a comma, separate columns by semicolons"


def wrong_in(path: Path, line: int, error: InputError) -> InputErrors:
    """An error as that of a line of a file."""
    return InputErrors((f"{path}:{line}:1: {sentence('', error.got, error.expected, error.do)}",))


def read_grid(
    path: Path, sources: dict[str, str], what: str = "a CSV file beside the study", single: bool = False
) -> TextTable:
    """The table in a file.

    Parameters
    ----------
    sources : dict[str, str]
        Is given its text under its name.
    single : bool
        Whether one column alone is a table: below a head without a comma, numbers with one comma each are then
        decimals, not two columns.

    Raises
    ------
    InputError
        For a file that cannot be read, InputErrors for one that is no text.

    Notes
    -----
    Cells are separated by tabs, else semicolons, else commas, else blanks: by the first of these that half of the lines
    have, where commas inside of numbers between blanks are decimals. Decimals have a comma where any number has one
    that separates no cells.
    """
    text = decoded(path, content(path, LARGEST, what))
    sources[str(path)] = text
    return grid_of(path, text, single)


def grid_of(path: Path, text: str, single: bool = False) -> TextTable:
    """The table in a text.

    Parameters
    ----------
    path : Path
        For messages.
    single : bool
        As in `read_grid`.

    Examples
    --------
    >>> grid_of(Path("a.csv"), "Hz;T [s]\\n63;1,5\\n").rows[1], grid_of(Path("a.csv"), "63;1,5").comma
    (TextRow(line=2, cells=['63', '1,5']), True)
    >>> grid_of(Path("a.csv"), "f [Hz]\\n29,35\\n63", single=True).rows[1]
    TextRow(line=2, cells=['29,35'])
    """
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    separator = ";" if single and _is_one_column(lines) else _separator(lines[:_LINES_READ])
    try:
        if separator is None:
            found = [(number, _BLANKS.split(line.strip())) for number, line in enumerate(text.splitlines(), start=1)]
        else:
            reader = csv.reader(io.StringIO(text), delimiter=separator)
            found = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except csv.Error:
        raise InputError("", got=f"'{path}', which is no table", expected="a CSV file") from None
    rows = tuple(TextRow(number, cells) for number, cells in found if any(cells) and not cells[0].startswith("#"))
    numbers = [cell for row in rows for cell in row.cells if _NUMBER.fullmatch(cell)]
    commas, points = (any(mark in cell for cell in numbers) for mark in ",.")
    return TextTable(path, rows, commas and (separator != "," or not points))  # in a table of commas they are in quotes


def _is_one_column(lines: list[str]) -> bool:
    """Whether below words without a comma all lines are a number: 29,35 is then no pair."""
    head = next((i for i, line in enumerate(lines) if _NUMBER.fullmatch(line.strip())), 0)
    below = [_NUMBER.fullmatch(line.strip()) for line in lines[head:]]
    return head > 0 and all(below) and not any("," in line for line in lines[:head])


def _separator(lines: list[str]) -> str | None:
    """What separates the cells of lines; None for blanks."""
    for mark in "\t;":
        if 2 * sum(mark in line for line in lines) >= len(lines) > 0:
            return mark
    words = [line.split() for line in lines]
    blanks = [all(map(_NUMBER.fullmatch, some)) and len(some) > 1 for some in words]
    return None if lines and 2 * sum(blanks) >= len(lines) else ","


# ----------------------------------------------------------------------------------------------------------------------
# Heads of columns, names and units, and what the unit makes of the numbers below: ``T20 [s]``, ``Kraft in N``,
# ``L_F / dB re 1 µN``.
# ----------------------------------------------------------------------------------------------------------------------

Scale = Callable[[float], float]
_BRACKETS: Final = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<unit>[^\]]*)\]|\((?P<round>.*)\))\s*")
_LOOSE: Final = (re.compile(r"(?P<name>.+?)\s*/\s*(?P<unit>\S.*)"), re.compile(r"(?P<name>.+?)\s+in\s+(?P<unit>\S.*)"))
_LEVEL: Final = re.compile(r"dB(?:\s*\(?\s*(?:ref\.?|rel\.?|re\.?)\s*:?\s*(?P<reference>[^)]*)\)?)?\s*")
_DIVIDED: Final = re.compile(r"/\s*\(([^()]*)\)")
_REMARK: Final = re.compile(r"\w\s+\w|\w{7}")  # in parentheses: no unit, such as (mean of 6)
_NO_UNIT: Final = {"", "-", "1", "\u2013"}
_ROOT: Final = 20.0  # dB per decade of an amplitude


class Head(NamedTuple):
    """A column: its name and its unit as they are written, "" for none; the cell that has the unit."""

    name: str
    unit: str
    cell: str = ""


def head_of(cells: Sequence[str], dimension: str) -> Head:
    """Name and unit of a column from the cells above its numbers, from the top.

    Parameters
    ----------
    dimension : str
        What its unit should be.

    Examples
    --------
    >>> head_of(["T20 [s]"], "time")[:2], head_of(["Nachhallzeit / ms"], "time")[:2], head_of(["T30", "s"], "time")[:2]
    (('T20', 's'), ('Nachhallzeit', 'ms'), ('T30', 's'))
    """
    name, unit, there = "", "", ""
    for cell in cells:
        text = cell.strip()
        found = _BRACKETS.fullmatch(text)
        if found is not None and found["round"] and _REMARK.search(found["round"]) and not _LEVEL.match(found["round"]):
            text, found = found["name"].strip(), None
        loose = next((one for one in (pattern.fullmatch(text) for pattern in _LOOSE) if one is not None), None)
        if found is not None:
            inside = found["unit"] if found["unit"] is not None else found["round"]
            name, unit, there = found["name"] or name, inside.strip(), text
        elif loose is not None and _is_unit(loose["unit"], dimension):
            name, unit, there = loose["name"], loose["unit"], text
        elif text and _is_unit(text, dimension):
            unit, there = text, text
        elif text:
            name = text
    return Head(name.strip(), unit, there)


def scale_of(head: Head, dimension: str) -> Scale:
    """What makes SI units of the numbers of a column: plain numbers are in SI units, levels over their reference.

    Raises InputError for a unit of another dimension and for levels without a reference.

    >>> scale_of(Head("F", "kN"), "force")(2.0), round(scale_of(Head("L", "dB re 1 uN"), "force")(120.0), 9)
    (2000.0, 1.0)
    """
    try:
        factor, level = factor_of(head.unit, dimension)
    except InputError as error:
        raise InputError(
            "", got=quote_value(head.cell) if error.got[:1] == "'" else error.got, expected=error.expected, do=error.do
        ) from None
    return (lambda number: factor * 10.0 ** (number / _ROOT)) if level else (lambda number: factor * number)


def factor_of(unit: str, dimension: str) -> tuple[float, bool]:
    """(what a unit multiplies numbers with, whether these are levels over it). Raises as `scale_of`."""
    unit, named = unit.strip(), DIMENSIONS[dimension]
    if unit in _NO_UNIT:
        return 1.0, False
    level = _LEVEL.fullmatch(unit)
    if level is not None and dimension != "level":
        reference = (level["reference"] or "").strip()
        if not reference:
            do = f"write its reference: 'dB re 1e-6 {named.unit}'" if dimension == "force" else "give its reference"
            raise InputError("", got="levels in dB without their reference", expected=named.words, do=do)
        unit = reference if reference[0].isdigit() else f"1 {reference}"
    else:
        unit = f"1 {unit}"
    try:
        return quantity(_plain(unit), dimension), level is not None and dimension != "level"
    except QuantityError as error:
        raise InputError("", got=quote_value(unit.removeprefix("1 ")), expected=error.expected, do=error.do) from None


def _plain(unit: str) -> str:
    """A unit without parentheses: m/(N s) is m/N/s, (m/s)/N is m/s/N."""
    unit = unit.replace("\u00b5N", "uN").replace("\u03bcN", "uN")
    text = _DIVIDED.sub(lambda inside: "/" + "/".join(re.split(r"[*·\s]+", inside[1].strip())), unit)
    text = re.sub(r"\((\w+/\w+)\)", r"\1", text)
    return re.sub(r"/Ns\b", "/N/s", text)


def _is_unit(text: str, dimension: str) -> bool:
    try:
        factor_of(text, dimension)
    except InputError:
        return _LEVEL.fullmatch(text.strip()) is not None
    return True
