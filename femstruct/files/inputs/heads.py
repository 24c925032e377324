"""Heads of columns, names and units, and what the unit makes of the numbers below: ``T20 [s]``, ``Kraft in N``,
``L_F / dB re 1 µN``."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from femstruct.dimensions import DIMENSIONS
from femstruct.errors import InputError, shown_as
from femstruct.units import QuantityError, quantity

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
    """Name and unit of a column from the cells above its numbers, from the top. dimension : what its unit should be.

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
            "", got=shown_as(head.cell) if error.got[:1] == "'" else error.got, expected=error.expected, do=error.do
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
        raise InputError("", got=shown_as(unit.removeprefix("1 ")), expected=error.expected, do=error.do) from None


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
