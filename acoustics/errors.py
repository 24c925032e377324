"""What the package acoustics refuses, and what it advises: errors stop the work, advice goes with the result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from acoustics.tags import stored_as


class AcousticsError(ValueError):
    """An input that cannot mean anything: where, what was got, what was expected, what to do.

    >>> str(AcousticsError("room.size", got="-1 m", expected="positive lengths", do="remove the sign"))
    'room.size: got -1 m, expected positive lengths; remove the sign'
    """

    def __init__(self, where: str, *, got: str = "", expected: str = "", do: str = "") -> None:
        self.where, self.got, self.expected, self.do = where, got, expected, do
        clauses = ", ".join(f"{word} {text}" for word, text in (("got", got), ("expected", expected)) if text)
        super().__init__("; ".join(text for text in (f"{where}: {clauses}" if clauses else where, do) if text))


@stored_as("advice on sound/1")
@dataclass(frozen=True)
class Advice:
    """A reason not to trust a result, or to trust it less, with the numbers that say so.

    code : short stable name, such as ``air-stiffness``.
    message : one sentence for a person.
    values : the numbers of the message, SI units in their names.
    """

    code: str
    message: str
    values: Mapping[str, float] = field(default_factory=dict)
