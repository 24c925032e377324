"""What a number of a noun is, said once, where it is computed: tables, files and pages read it from there."""

from __future__ import annotations

from typing import NamedTuple


class Axis(NamedTuple):
    """What numbers stand along: name, unit, description."""

    name: str
    unit: str
    long_name: str


class Reported(NamedTuple):
    """Of a field or property `x: Annotated[float, Reported("Pa", "Largest pressure")]`: unit and description.

    key : its name in JSON, its own if left out. axis : of a mapping, what its keys are. along : of an array, the fields
    that are its axes. symbol : the head of its row or column in tables that are read; "" where it is in none.

    >>> Reported("Pa", "Largest pressure").unit
    'Pa'
    """

    unit: str
    long_name: str
    key: str = ""
    axis: Axis | None = None
    along: tuple[str, ...] = ()
    symbol: str = ""
