"""Lines of a mesh file in text, and mistakes in them by file and line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputErrors, sentence, shown_as

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
            raise wrong_line(path, number, shown_as(", ".join(words)), "whole numbers") from None
    return np.array(found, dtype=np.int64)


def floats(path: Path, lines: Iterable[tuple[int, Sequence[str]]]) -> Floats:
    """All numbers of numbered lines of words, one after the other; exponents with D, as Fortran writes them, too."""
    found: list[float] = []
    for number, words in lines:
        try:
            some = [float(word.replace("D", "E").replace("d", "e")) for word in words]
        except ValueError:
            raise wrong_line(path, number, shown_as(", ".join(words)), "numbers") from None
        if not np.isfinite(some).all():
            raise wrong_line(path, number, shown_as(", ".join(words)), "finite numbers")
        found += some
    return np.array(found)
