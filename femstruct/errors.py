"""What can go wrong, as sentences: errors stop the work, findings are stored with the results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

from femstruct.tags import stored_as

LONGEST: Final = 300  # characters of what was got, expected or meant: more is not read
MOST_LINES: Final = 40  # mistakes told at once
MOST_NAMES: Final = 8
_ITEMS: Final = 6  # of a list or a mapping that are shown


def shorten(text: str, most: int = LONGEST) -> str:
    """A text without its middle where it is too long to be read.

    >>> shorten("a" * 1000, 30), shorten("short")
    ('aaaaaaaaaaaaaaa ... aaaaaaaaaa', 'short')
    """
    half = most // 2
    return text if len(text) <= most else f"{text[:half]} ... {text[half + 5 - most :]}"


def list_some(names: Iterable[object], most: int = MOST_NAMES) -> str:
    """Names in a sentence, the first of them where they are many.

    >>> list_some("abc"), list_some(range(100), 3)
    ('a, b, c', '0, 1, 2 and 97 more')
    """
    shown = [str(name) for name in names]
    more = f" and {len(shown) - most} more" if len(shown) > most else ""
    return ", ".join(shorten(name, 60) for name in shown[:most]) + more


def quote_value(value: object) -> str:
    """The value as its writer knows it, cut short."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict | list | tuple):
        kind = "a mapping" if isinstance(value, dict) else "a list"
        inside = _inside(value)
        return f"{kind} {inside}" if inside else kind
    if isinstance(value, int) and abs(value) > 10**18:
        return "a very large number"
    words = " ".join(str(value)[:200].split())
    words = words if len(words) <= 60 else f"{words[:57]}..."
    return f"'{words}'" if isinstance(value, str) else words


def _inside(value: object, deepest: int = 2) -> str:
    """A list or mapping as a file has it, its middle left out where it is long; "" of an empty one.

    >>> _inside([1, "2 mm"]), _inside({"x": [1, 2]})
    ('[1, 2 mm]', '{x: [1, 2]}')
    """
    if isinstance(value, dict | list | tuple):
        if not value or not deepest:
            return "" if deepest == 2 else "{..}" if isinstance(value, dict) else "[..]"
        if isinstance(value, dict):
            parts = [f"{key}: {_inside(one, deepest - 1)}" for key, one in list(value.items())[:_ITEMS]]
        else:
            parts = [_inside(one, deepest - 1) for one in value[:_ITEMS]]
        parts += ["..."] if len(value) > _ITEMS else []
        return shorten(f"{{{', '.join(parts)}}}" if isinstance(value, dict) else f"[{', '.join(parts)}]", 60)
    return quote_value(value).strip("'")


def sentence(where: str, got: str = "", expected: str = "", do: str = "") -> str:
    """``where: got this, expected that; do this``, each part cut where it is too long to be read."""
    clauses = ", ".join(f"{word} {shorten(text)}" for word, text in (("got", got), ("expected", expected)) if text)
    whole = ": ".join(text for text in (shorten(where), clauses) if text)
    return f"{whole}; {shorten(do)}" if do else whole


class FemstructError(Exception):
    """Base of all errors femstruct raises on purpose: where, what was got, what was expected, what to do.

    >>> str(FemstructError("parts.slab.thickness", got="-3 mm", expected="a positive length", do="remove the sign"))
    'parts.slab.thickness: got -3 mm, expected a positive length; remove the sign'
    """

    def __init__(self, where: str, *, got: str = "", expected: str = "", do: str = "") -> None:
        self.where, self.got, self.expected, self.do = where, got, expected, do
        super().__init__(sentence(where, got, expected, do))


class InputError(FemstructError):
    """The input cannot mean anything: exit code 2."""


class InputErrors(InputError):
    """All the mistakes of one pass over the input, a line each."""

    def __init__(self, errors: tuple[str, ...]) -> None:
        super().__init__("")
        self.errors = errors

    def __str__(self) -> str:
        lines = [shorten(line, 4 * LONGEST) for line in self.errors[:MOST_LINES]]
        more = len(self.errors) - MOST_LINES
        return "\n".join([*lines, f"and {more} more mistakes"] if more > 0 else lines)


class SingularSystem(InputError):
    """K and M share a null vector: a mechanism without mass. Names the node and the component."""


class NotConverged(FemstructError):
    """A numerical service gave up rather than return a guess: exit code 3.

    position : ``file:line:column: `` of what it is about, where that is known.

    >>> error = NotConverged("impact", got="20 steps by t = 0.1 s", expected="to reach t = 1 s")
    >>> error.position = "press.study.yaml:12:3: "
    >>> error.text
    'press.study.yaml:12:3: not converged: impact: got 20 steps by t = 0.1 s, expected to reach t = 1 s'
    """

    position: str = ""

    @property
    def text(self) -> str:
        """The error as it is told: where, and what did not converge."""
        return f"{self.position}not converged: {self}"


@stored_as("finding/1")
@dataclass(frozen=True)
class Finding:
    """A reason not to trust a result, or to trust it less, with the numbers that say so.

    code : short stable name, such as ``twist-defect``.
    message : one sentence for a person.
    values : the numbers of the message, SI units in their names.
    severe : a result with a severe finding is not to be trusted (exit code 3).
    """

    code: str
    message: str
    values: Mapping[str, float] = field(default_factory=dict)
    severe: bool = False
