"""What can go wrong, as sentences: errors stop the work, findings are stored with the results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


class FemstructError(Exception):
    """Base of all errors femstruct raises on purpose: where, what was got, what was expected, what to do.

    >>> str(FemstructError("parts.slab.thickness", got="-3 mm", expected="a positive length", do="remove the sign"))
    'parts.slab.thickness: got -3 mm, expected a positive length; remove the sign'
    """

    def __init__(self, where: str, *, got: str = "", expected: str = "", do: str = "") -> None:
        self.where, self.got, self.expected, self.do = where, got, expected, do
        told = ", ".join(f"{word} {text}" for word, text in (("got", got), ("expected", expected)) if text)
        super().__init__("; ".join(text for text in (f"{where}: {told}" if told else where, do) if text))


class InputError(FemstructError):
    """The input cannot mean anything: exit code 2."""


class InputErrors(InputError):
    """All the mistakes of one pass over the input, a line each."""

    def __init__(self, errors: tuple[str, ...]) -> None:
        self.errors = errors
        super().__init__("\n".join(errors))


class SingularSystem(InputError):
    """K and M share a null vector: a mechanism without mass. Names the node and the component."""


class NotConverged(FemstructError):
    """A numerical service gave up rather than return a guess: exit code 3."""


@dataclass(frozen=True)
class Finding:
    """A reason not to believe a result, or to believe it less, with the numbers that say so.

    code : short stable name, such as ``twist-defect``.
    message : one sentence for a person.
    values : the numbers of the message, SI units in their names.
    severe : a result with a severe finding is not to be trusted (exit code 3).
    """

    code: str
    message: str
    values: Mapping[str, float] = field(default_factory=dict)
    severe: bool = False
