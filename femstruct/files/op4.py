"""Matrices of Nastran's OUTPUT4: .op4, binary and text, dense and both sparse forms.

Records are those of OUTPUT4 in the DMAP Programmer's Guide of MSC Nastran: a head of a matrix (columns, rows, form,
type, name), a record for each column that is not zero, and one of a column beyond the last. A column is a stretch
of numbers from a first row on, or several stretches, each with a head of its own, where its first row is 0: length
and row as two numbers (BIGMAT, rows below zero in the head of the matrix) or packed into one. Lengths count words,
of which a number of double precision has two, or one where whole numbers have eight bytes.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from scipy.sparse import csc_array

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.files.text_tables import lines_of, wrong_line

MOST_COLUMNS: Final = 10_000_000  # of a matrix: more are of a damaged file
PACKED: Final = 65535  # rows, from which on heads of stretches are two numbers
_FORMAT: Final = re.compile(r"\s*(?:1P,)?(\d+)[EDG](\d+)\.\d+", re.IGNORECASE)
_BARE: Final = re.compile(r"(\d)([+-]\d+)$")  # an exponent of three digits, without its letter
_TEXT_DEFAULT: Final = (5, 16)  # numbers of a line and their width
_DOUBLE: Final = 2  # type of a real matrix of double precision; 1 is of single, 3 and 4 are complex
_REAL: Final = (1, _DOUBLE)


class _Head(NamedTuple):
    name: str
    rows: int
    columns: int
    type: int

    @property
    def two_numbers(self) -> bool:
        """Whether the heads of stretches are two numbers."""
        return self.rows < 0 or self.rows > PACKED


class _Stretch(NamedTuple):
    column: int
    row: int
    values: Floats


def read_op4(path: Path, data: bytes) -> dict[str, csc_array]:
    """Matrices of a file by name, in capitals.

    Raises InputError, with the line of a file in text, for what is no such file, is cut off, or is complex.

    >>> text = "       1       1       6       2K       1P,3E24.16\\n       1       1       1\\n  2.0E+02\\n"
    >>> read_op4(Path("a.op4"), (text + "       2       1       1\\n  1.0E+00\\n").encode())["K"].toarray().tolist()
    [[200.0]]
    """
    first = data[:4].ljust(4, b"\0")
    for order in "<>":
        size = struct.unpack(f"{order}i", first)[0]
        if size in (24, 48):
            matrices = _Binary(path, data, order, 8 if size == 48 else 4).matrices()
            break
    else:
        matrices = _Text(path, lines_of(path, data)).matrices()
    found: dict[str, csc_array] = {}
    for head, stretches in matrices:
        rows, columns, values = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)]
        for one in stretches:
            rows.append(one.row + np.arange(len(one.values)))
            columns.append(np.full(len(one.values), one.column))
            values.append(one.values)
        where: tuple[Integers, Integers] = np.concatenate(rows), np.concatenate(columns)
        found[head.name] = csc_array((np.concatenate(values), where), shape=(abs(head.rows), head.columns))
    if not found:
        raise InputError("", got=f"'{path.name}', which is empty", expected="matrices of OUTPUT4")
    return found


class _Binary:
    """A binary file, from one Fortran record to the next. order : of bytes. width : of whole numbers [bytes]."""

    def __init__(self, path: Path, data: bytes, order: str, width: int) -> None:
        self.path, self.data, self.order, self.width, self.at = path, data, order, width, 0

    def matrices(self) -> Iterator[tuple[_Head, list[_Stretch]]]:
        while self.at < len(self.data):
            record = self._record()
            if len(record) != 6 * self.width:
                raise self._wrong(f"a head of {len(record)} bytes")
            columns, rows, _, kind = self._whole(record, 4)
            name = record[4 * self.width :].decode("latin-1").strip(" \0").upper()
            head = _Head(name, rows, columns, kind)
            _refuse(head, self._wrong)
            yield head, list(self._columns(head))

    def _columns(self, head: _Head) -> Iterator[_Stretch]:
        while True:
            record = self._record()
            if len(record) < 3 * self.width:
                raise self._wrong(f"a column of {len(record)} bytes")
            column, row, words = self._whole(record, 3)
            if column > head.columns:
                return
            body = record[3 * self.width : (3 + words) * self.width]
            if column < 1 or words < 0 or len(body) != words * self.width:
                raise self._wrong(f"column {column} with {words} words in {len(record)} bytes")
            if row:
                yield self._stretch(head, column, row, body)
                continue
            while body:
                if head.two_numbers:
                    if len(body) < 2 * self.width:
                        raise self._wrong("a stretch without its row")
                    length, row = self._whole(body, 2)
                    length, body = length - 1, body[2 * self.width :]
                else:
                    length, row = divmod(self._whole(body, 1)[0], PACKED + 1)
                    length, body = length - 1, body[self.width :]
                if not 0 < length * self.width <= len(body):
                    raise self._wrong(f"a stretch of {length} words in column {column}")
                yield self._stretch(head, column, row, body[: length * self.width])
                body = body[length * self.width :]

    def _stretch(self, head: _Head, column: int, row: int, body: bytes) -> _Stretch:
        size = 8 if head.type == _DOUBLE else self.width
        if len(body) % size:
            raise self._wrong(f"{len(body)} bytes of numbers of {size} in column {column}")
        values = np.frombuffer(body, dtype=f"{self.order}f{size}").astype(np.float64)
        return _checked(_Stretch(column - 1, row - 1, values), head, self._wrong)

    def _record(self) -> bytes:
        start = self.at + 4
        (size,) = struct.unpack(f"{self.order}i", self.data[self.at : start].ljust(4, b"\0"))
        end = start + size
        if size <= 0 or self.data[self.at : start] != self.data[end : end + 4]:
            raise self._wrong("a record that is cut off")
        self.at = end + 4
        return self.data[start:end]

    def _whole(self, record: bytes, count: int) -> tuple[int, ...]:
        word = "q" if self.width == 8 else "i"
        return struct.unpack(f"{self.order}{count}{word}", record[: count * self.width])

    def _wrong(self, got: str) -> InputError:
        return InputError("", got=f"'{self.path.name}' with {got}, at byte {self.at}", expected="matrices of OUTPUT4")


class _Text:
    """A file in text. at : the line that comes next, from 0."""

    def __init__(self, path: Path, lines: list[str]) -> None:
        self.path, self.lines, self.at = path, lines, 0

    def matrices(self) -> Iterator[tuple[_Head, list[_Stretch]]]:
        while self.at < len(self.lines):
            line = self._line()
            if not line.strip():
                continue
            wide = line.rstrip().endswith("|I16")
            size = 16 if wide else 8
            columns, rows = self._whole(line, size, 2)
            _, kind = self._whole(line[2 * size :], 8, 2)
            name = line[2 * size + 16 : 2 * size + 24].strip().upper()
            layout = _FORMAT.match(line[2 * size + 24 :])
            each = (int(layout[1]), int(layout[2])) if layout else _TEXT_DEFAULT
            head = _Head(name, rows, columns, kind)
            if min(each) < 1:
                raise self._wrong("a format without numbers")
            _refuse(head, self._wrong)
            yield head, list(self._columns(head, size, each))

    def _columns(self, head: _Head, size: int, each: tuple[int, int]) -> Iterator[_Stretch]:
        double = 2 if head.type == _DOUBLE else 1
        while True:
            column, row, words = self._whole(self._line(), size, 3)
            if column > head.columns:
                self._numbers(1, each)
                return
            if column < 1:
                raise self._wrong(f"column {column}")
            if row:  # numbers, not words
                yield _checked(_Stretch(column - 1, row - 1, self._numbers(words, each)), head, self._wrong)
                continue
            while words > 0:
                if head.two_numbers:
                    length, row = self._whole(self._line(), size, 2)
                    words -= length + 1
                else:
                    length, row = divmod(self._whole(self._line(), 2 * size, 1)[0], PACKED + 1)
                    words -= length
                if length < 2:
                    raise self._wrong(f"a stretch of {length - 1} words")
                values = self._numbers((length - 1) // double, each)
                yield _checked(_Stretch(column - 1, row - 1, values), head, self._wrong)

    def _numbers(self, count: int, each: tuple[int, int]) -> Floats:
        in_line, width = each
        found: list[float] = []
        while len(found) < count:
            line = self._line()
            for at in range(min(in_line, count - len(found))):
                word = line[at * width : (at + 1) * width].strip().upper().replace("D", "E")
                try:
                    found.append(float(word if "E" in word else _BARE.sub(r"\1E\2", word)))
                except ValueError:
                    raise self._wrong(f"'{word[:40]}'", "a number") from None
        return np.array(found)

    def _line(self) -> str:
        if self.at >= len(self.lines):
            raise self._wrong("an end in the middle of a matrix")
        self.at += 1
        return self.lines[self.at - 1]

    def _whole(self, line: str, width: int, count: int) -> tuple[int, ...]:
        words = [line[at * width : (at + 1) * width] for at in range(count)]
        try:
            return tuple(int(word) for word in words)
        except ValueError:
            raise self._wrong(f"'{line.strip()[:40]}'", f"{count} whole numbers, {width} characters each") from None

    def _wrong(self, got: str, expected: str = "matrices of OUTPUT4") -> InputError:
        return wrong_line(self.path, max(self.at, 1), got, expected)


def _refuse(head: _Head, wrong: Callable[[str], InputError]) -> None:
    """Raise what `wrong` makes of a head that no matrix of ours has."""
    if not (0 < head.columns <= MOST_COLUMNS and 0 < abs(head.rows) <= MOST_COLUMNS):
        raise wrong(f"a matrix of {abs(head.rows)} rows and {head.columns} columns")
    if head.type not in _REAL:
        raise wrong(f"{head.name}, a matrix of type {head.type}" + (", complex" if head.type in (3, 4) else ""))


def _checked(one: _Stretch, head: _Head, wrong: Callable[[str], InputError]) -> _Stretch:
    if one.row < 0 or one.row + len(one.values) > abs(head.rows):
        raise wrong(f"rows {one.row + 1} to {one.row + len(one.values)} of {abs(head.rows)}")
    return one
