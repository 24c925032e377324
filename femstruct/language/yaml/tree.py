"""A file as plain values that remember the line and column of every key, and the mistakes in it."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any
from unicodedata import normalize

from femstruct.errors import InputErrors, sentence, some_of

Steps = tuple[str | int, ...]  # from the root to a value: keys and list indices


@dataclass(frozen=True)
class Position:
    """A place in a file, counted from 1; line 0 for what has no lines, such as the command line."""

    file: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}" if self.line else self.file


@dataclass
class Mistakes:
    """The mistakes found so far, a line each, without repetition."""

    lines: list[str] = field(default_factory=list)

    def add(self, position: Position, path: str, *, got: str = "", expected: str = "", do: str = "") -> None:
        """Note one mistake as ``file:line:column: path: got, expected; do``."""
        self.note(": ".join(part for part in (str(position), sentence(path, got, expected, do)) if part))

    def note(self, line: str) -> None:
        """Note a mistake that is already a sentence."""
        line = " ".join(line.split())
        if line not in self.lines:
            self.lines.append(line)

    def stop_if_any(self) -> None:
        """Raise InputErrors when there are mistakes."""
        if self.lines:
            raise InputErrors(tuple(self.lines))


@dataclass(frozen=True)
class Tree:
    """A YAML file as mappings, lists, texts, numbers, booleans and None, and where each of them stands.

    keys : where the key (or list item) of a path begins. values : where its value begins. text : the file verbatim.
    """

    file: str
    value: Any
    keys: Mapping[Steps, Position]
    values: Mapping[Steps, Position]
    text: str

    def position(self, steps: Steps, of_key: bool = False) -> Position:
        """Where a value (or its key) stands; of a path that is not there, where its nearest ancestor's key does."""
        if not of_key and steps in self.values:
            return self.values[steps]
        while steps and steps not in self.keys:
            steps = steps[:-1]
        return self.keys.get(steps, Position(self.file, 1, 1))


def mapping_in(value: Any, key: str) -> dict[str, Any]:
    """The mapping at a key of a mapping, empty where there is none."""
    found = value.get(key) if isinstance(value, dict) else None
    return found if isinstance(found, dict) else {}


def dotted(steps: Steps) -> str:
    """A path as people write it.

    >>> dotted(("parts", "slab", "origin", 2))
    'parts.slab.origin[2]'
    """
    text = ""
    for step in steps:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else step
    return text


def nearest(name: str, known: Iterable[object]) -> str:
    """``did you mean 'x'?`` with the known name nearest to this one; the known names when none is near."""
    if meant := near_one(name, known):
        return meant
    names = sorted({str(one) for one in known})
    return f"known here: {some_of(names)}" if names else ""


def near_one(name: str, known: Iterable[object]) -> str:
    """``did you mean 'x'?`` with the nearest name, empty when none is near: for where the known ones are told already.

    >>> near_one("herz", ("hertz", "cubic")), near_one("q", ("x", "y")), near_one("C30", ("wall C30", "slab C30"))
    ("did you mean 'hertz'?", '', 'did you mean one of slab C30, wall C30?')
    """
    several = _holding(name, known := [str(one) for one in known])
    if len(several) > 1:
        return f"did you mean one of {some_of(several)}?"
    near = near_name(name, known)
    if near and near != name and normalize("NFKC", near).split() == normalize("NFKC", name).split():
        return f"'{near}' looks alike, but has other characters (Unicode): copy it from there"
    return f"did you mean '{near}'?" if near else ""


def near_name(name: str, known: Iterable[object]) -> str:
    """The only known name of which this one is some words, or the one nearest to it; empty when none is near.

    >>> near_name("C30/37", ("C30", "concrete C30/37")), near_name("C31", ("C30", "concrete C30/37"))
    ('concrete C30/37', 'C30')
    """
    folded = {_folded(one): one for one in sorted({str(one) for one in known}, reverse=True)}
    holding = _holding(name, folded.values())
    near = difflib.get_close_matches(_folded(name[:100]), folded, n=1, cutoff=0.6)
    return holding[0] if len(holding) == 1 else folded[near[0]] if near else ""


def _holding(name: str, known: Iterable[str]) -> list[str]:
    """The known names of which a name is some words, but none where one of them is the name in other letters."""
    folded, text = {one: _folded(one) for one in sorted({*known})}, _folded(name[:100])
    return [] if text in folded.values() else [one for one in folded if f" {text} " in f" {folded[one]} "]


def _folded(name: str) -> str:
    return normalize("NFC", name).lower()
