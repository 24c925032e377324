"""What is fitted, as the command line says it: PATH=START, or PATH=START:LOW:HIGH."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from femstruct.dimensions import DIMENSIONS
from femstruct.errors import InputError, InputErrors
from femstruct.units import QuantityError, quantity_of
from femstruct.workflow.identify.fit import parameter
from femstruct.workflow.identify.intervals import Parameter

_VALUE: Final = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")
_DO: Final = "write it like bodies.ball.contact.stiffness='4 kN/m' or materials.concrete.E='30 GPa:25 GPa:35 GPa'"


def parameters_of(texts: Sequence[str]) -> tuple[list[Parameter], dict[str, str]]:
    """Parameters and the unit of each, in which its start is written and its value is wanted.

    Raises InputError for texts that are none, without any, and for a path that stands there twice.

    >>> found, units = parameters_of(["materials.concrete.E=30 GPa:25000 MPa:35 GPa"])
    >>> found[0].low, found[0].high, units
    (25.0, 35.0, {'materials.concrete.E': 'GPa'})
    """
    found: list[Parameter] = []
    units: dict[str, str] = {}
    for text in texts:
        path, equals, written = (part.strip() for part in text.partition("="))
        start, *ends = written.split(":")
        read = _VALUE.fullmatch(start)
        if not equals or not path or read is None or len(ends) not in (0, 2):
            expected = "a path of the model or study, a number, and two bounds or none"
            raise InputError(f"--fit {text}", got="no PATH=START and no PATH=START:LOW:HIGH", expected=expected, do=_DO)
        if path in units:
            raise InputError(f"--fit {text}", got=f"'{path}' twice", expected="each path once")
        value, units[path] = float(read[1]), read[2]
        low, high = (_bound(text, end, value, units[path], start) for end in ends) if ends else (None, None)
        try:
            found.append(parameter(path, value, low, high))
        except InputError as error:
            got, do = _as_written(written, units[path]), _right_way(path, start, ends, low, high)
            raise InputError(f"--fit {text}", got=got, expected=error.expected, do=do) from None
    if not found:
        raise InputError("--fit", got="no parameter", expected="one or more PATH=START")
    return found, units


def _as_written(written: str, unit: str) -> str:
    """Start and bounds in words, each with its unit."""
    start, *ends = (one.strip() if re.search(r"[^\d.eE+-]", one) else f"{one.strip()} {unit}".rstrip()
                    for one in written.split(":"))  # fmt: skip
    return f"a start of {start}" + (f" and bounds of {ends[0]} and {ends[1]}" if ends else "")


def _right_way(path: str, start: str, ends: Sequence[str], low: float | None, high: float | None) -> str:
    """What to write where bounds are the wrong way round."""
    if low is None or high is None or not low > high:
        return ""
    return f"write {path}={start}:{ends[1]}:{ends[0]}"


def start_texts(texts: Sequence[str]) -> list[str]:
    """The same as changes of the files, PATH=START."""
    return [text.partition(":")[0] if "=" in text.partition(":")[0] else text for text in texts]


def refused_as_fit(texts: Sequence[str], errors: InputErrors) -> InputErrors:
    """Mistakes that name an override, as those of the parameter that it is of."""
    lines = errors.errors
    for text, start in zip(texts, start_texts(texts), strict=True):
        lines = tuple(line.replace(f"--set {start}", f"--fit {text}") for line in lines)
    return InputErrors(lines)


def _bound(text: str, end: str, start: float, unit: str, written: str) -> float:
    """A bound in the unit of the start; without a unit of its own it is in that."""
    read = _VALUE.fullmatch(end)
    if read is None:
        raise InputError(f"--fit {text}", got=f"a bound '{end}'", expected="a number", do=_DO)
    number = float(read[1])
    if read[2] in ("", unit):
        return number
    known = [*DIMENSIONS]
    try:
        (own, dimension), (first, of_start) = quantity_of(end.strip(), known), quantity_of(written.strip(), known)
    except QuantityError as error:
        raise InputError(f"--fit {text}", got=error.got, expected=f"a bound in {unit or 'SI units'}", do="") from None
    if dimension != of_start or not start:
        raise InputError(f"--fit {text}", got=f"a bound '{end}'", expected=f"one in {unit or 'SI units'}, as the start")
    return own / (first / start)
