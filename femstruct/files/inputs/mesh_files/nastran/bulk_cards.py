"""Cards of the bulk data of Nastran: free, small and large fields, with their continuations, as words.

Fields are those of the Quick Reference Guide, "Format of Bulk Data Entries". meshio 5.3 reads nodes and elements but
neither sets nor properties, and takes coordinates of any coordinate system as they are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from math import isfinite, nan
from pathlib import Path
from typing import Final, NamedTuple

from femstruct.errors import InputError, InputErrors, shown_as
from femstruct.files.inputs.mesh_files.text_lines import lines_of, wrong_line
from femstruct.files.inputs.opening import beside, content

LARGEST: Final = 500_000_000  # bytes
_DEEPEST: Final = 5  # files that include files
_SMALL, _LARGE = 8, 16
_GOES_ON = re.compile(r"(^|,)\s*[+*](?!\d|\.)\w*\s*$")  # a mark of continuation as the last field of a line
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD]?[+-]?\d+)?")
_BARE_EXPONENT = re.compile(r"^([+-]?(?:\d+\.?\d*|\.\d+))([+-]\d+)$")


class Line(NamedTuple):
    """A line of a file, from 1."""

    path: Path
    number: int
    text: str


class Card(NamedTuple):
    """A card. number : of its first line, from 1. fields : after its name, all continuations in one row. seen : those
    that have been read, counted from 0: what is left at the end is named."""

    path: Path
    number: int
    name: str
    fields: list[str]
    seen: set[int]

    def refuse(self, got: str, expected: str, do: str = "") -> InputErrors:
        """A mistake in it."""
        return wrong_line(self.path, self.number, f"{self.name} with {got}", expected, do)

    def field(self, index: int) -> str:
        """A field, counted from 0 after the name; "" beyond its end."""
        self.seen.add(index)
        return self.fields[index] if index < len(self.fields) else ""

    @property
    def unread(self) -> list[int]:
        """Fields with something in them that nobody has read."""
        return [index for index, word in enumerate(self.fields) if word and index not in self.seen]

    def whole(self, index: int, default: int | None = None) -> int:
        """A whole number; `default` where the field is empty, refused without one."""
        word = self.field(index)
        if not word and default is not None:
            return default
        try:
            return int(word)
        except ValueError:
            raise self.refuse(f"{shown_as(word)} in field {index + 2}", "a whole number") from None

    def real(self, index: int, default: float | None = None) -> float:
        """A number, also as 1.5-3; `default` where the field is empty, refused without one."""
        word = self.field(index)
        if not word and default is not None:
            return default
        found = _BARE_EXPONENT.match(word)
        plain = f"{found[1]}e{found[2]}" if found else word.replace("D", "E").replace("d", "e")
        try:
            number = float(plain)
        except ValueError:
            number = nan
        if not isfinite(number):
            raise self.refuse(f"{shown_as(word)} in field {index + 2}", "a number")
        return number

    def several(self, first: int) -> list[int]:
        """Whole numbers from a field on, FIRST THRU LAST written out."""
        self.seen.update(range(first, len(self.fields)))
        words = [word for word in self.fields[first:] if word]
        numbers: list[int] = []
        at = 0
        while at < len(words):
            if at + 2 < len(words) and words[at + 1].upper() == "THRU":
                if not (words[at].isdigit() and words[at + 2].isdigit()):
                    raise self.refuse(f"'{' '.join(words[at : at + 3])}'", "FIRST THRU LAST")
                numbers += range(int(words[at]), int(words[at + 2]) + 1)
                at += 3
            elif words[at].isdigit():
                numbers.append(int(words[at]))
                at += 1
            else:
                raise self.refuse(shown_as(words[at]), "whole numbers, or FIRST THRU LAST")
        return numbers


def cards_of(path: Path, lines: list[str]) -> tuple[list[Line], list[Card], bool]:
    """Lines of the case control, cards of the bulk data up to ENDDATA, and whether there is one.

    Lines of files that it includes stand in their places. Raises InputErrors for a file that ends before its last card
    does, and for a whole one, with BEGIN BULK, that has no ENDDATA: Nastran asks for it, so that such a file is cut.
    Bulk data alone is often written without.
    """
    every = list(_with_included([Line(path, number, line) for number, line in enumerate(lines, 1)], depth=0))
    begin = next((n for n, one in enumerate(every) if re.match(r"\s*BEGIN\s+BULK", one.text, re.IGNORECASE)), -1)
    found: list[Card] = []
    ended, last = False, ""
    for one in every[begin + 1 :]:
        text = one.text.split("$", 1)[0].rstrip()
        if not text.strip():
            continue
        if text.strip().upper().startswith("ENDDATA"):
            ended = True
            break
        last = text
        name, fields = _split(one, text)
        if name == "" or name[0] in "+*":
            if not found:
                raise wrong_line(one.path, one.number, "a continuation of nothing", "a card before it")
            found[-1].fields.extend(fields)
        else:
            found.append(Card(one.path, one.number, name.rstrip("*").upper(), fields, set()))
    goes_on = not ended and _GOES_ON.search(last if "," in last else last.expandtabs(_SMALL)[72:80]) is not None
    if found and not ended and (goes_on or begin >= 0):
        got = f"the end of the file {'within' if goes_on else 'after'} {found[-1].name} of line {found[-1].number}"
        expected = "its continuation" if goes_on else "ENDDATA"
        do = "the file is cut: write it again" if goes_on else "is the file cut? If not, write ENDDATA as its last line"
        raise wrong_line(path, len(lines), got, expected, do)
    return every[: begin + 1], found, ended


def _with_included(lines: list[Line], depth: int) -> Iterator[Line]:
    """All lines, those of INCLUDE 'FILE' replaced by those of the file, which is sought beside the one that names it.

    A name may go on over lines until its quotation mark. Raises InputErrors with the line for a file that is not there,
    and for files that include each other.
    """
    at = 0
    while at < len(lines):
        one = lines[at]
        at += 1
        found = re.match(r"\s*INCLUDE\b\s*(.*)", one.text, re.IGNORECASE)
        if found is None:
            yield one
            continue
        name = found[1].strip()
        while name[:1] in ("'", '"') and name.count(name[0]) < 2 and at < len(lines):
            name += lines[at].text.strip()
            at += 1
        if depth > _DEEPEST:
            raise wrong_line(one.path, one.number, "files that include each other", "an end to it")
        name = name.split("$", 1)[0].strip().strip("'\"").replace("\\", "/")
        try:
            inner = beside(str(one.path), name)
            texts = lines_of(inner, content(inner, LARGEST, "an included file"))
        except InputError as error:
            if getattr(error, "errors", ()):
                raise
            raise wrong_line(one.path, one.number, error.got, error.expected, error.do) from None
        yield from _with_included([Line(inner, number, text) for number, text in enumerate(texts, 1)], depth + 1)


def _split(line: Line, text: str) -> tuple[str, list[str]]:
    """Name of a line, or its mark of continuation, and its fields: eight, or four of a large one.

    Raises InputErrors for more, which would be lost: a field behind the last is the mark of continuation, in words.
    """
    if "," in text:
        name, *fields = (word.strip() for word in text.split(","))
        if fields and re.fullmatch(r"[+*](?!\d|\.).*", fields[-1]):
            fields.pop()  # the mark of the line that goes on
        count = 4 if name.endswith("*") or name.startswith("*") else 8
        behind = [word for word in fields[count:] if word]
        if len(behind) > 1 or any(_NUMBER.fullmatch(word) for word in behind):
            got = f"{len(fields)} fields behind {name or 'a continuation'}"
            do = "write the others in a line of their own that begins with a comma"
            raise wrong_line(line.path, line.number, got, f"{count} in a line", do)
        return name, [*fields[:count], *[""] * (count - len(fields))]
    text = text.expandtabs(_SMALL)
    name = text[:_SMALL].strip()
    width = _LARGE if name.endswith("*") or name.startswith("*") else _SMALL
    row = text[_SMALL:72].ljust(64)
    return name, [row[at : at + width].strip() for at in range(0, 64, width)]
