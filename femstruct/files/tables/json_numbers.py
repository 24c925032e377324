"""Numbers as JSON takes them."""

from __future__ import annotations

from math import isfinite


def number(value: float | None) -> float | None:
    """A number for JSON, which knows neither nan nor infinity: None instead.

    >>> number(1), number(float("nan"))
    (1.0, None)
    """
    return None if value is None or not isfinite(value) else float(value)


def label(value: float) -> str:
    """A frequency as a key of a table, without a trailing zero.

    >>> label(63.0), label(31.5)
    ('63', '31.5')
    """
    return f"{float(value):.6g}"
