"""What varies, in words: ranges, lists and distributions in units that are easy to read."""

from __future__ import annotations

from femstruct.study.campaign.varied import Listed, Scattered
from femstruct.view.campaigns.swept_table import written


def range_of(one: Listed | Scattered) -> str:
    """The values that a path may take.

    >>> range_of(Scattered("bodies.damper.mass", "log-uniform", 50.0, 4000.0, "kg"))
    '50 kg .. 4000 kg, on a logarithmic scale'
    >>> range_of(Scattered("bodies.ram.speed", "normal", 6.0, 0.3, "m/s"))
    'normal: mean 6 m/s, deviation 300 mm/s'
    >>> range_of(Listed("points.centre.at", ("center", "[1, 2]")))
    'one of center, [1, 2]'
    """
    if isinstance(one, Listed):
        return f"one of {', '.join(one.texts)}"
    first, second = (written(value, one.unit, "") for value in (one.first, one.second))
    if one.law == "normal":
        return f"normal: mean {first}, deviation {second}"
    return f"{first} .. {second}" + (", on a logarithmic scale" if one.law == "log-uniform" else "")
