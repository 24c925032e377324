"""First root of a polynomial over a step: Bernstein coefficients bound it, so that no root is skipped.

A part of the step whose Bernstein coefficients are all positive has no root; one in which they change sign once has
exactly one (Descartes), which safeguarded Newton finds; any other is halved.
"""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel, summing
from femstruct.impact.exact.exact_constants import COARSE, DEPTH, ORDER

NEVER = 2.0
COEFFICIENT_ROUNDING = 2e-15  # of a Bernstein coefficient, relative to the sum of the powers' coefficients


@summing
def value_of(c: Floats, order: int, powers: Floats) -> float:
    """c[0] + c[1] theta + ... + c[order] theta^order, from the powers of theta: no term waits for another."""
    total = 0.0
    for k in range(order + 1):
        total += c[k] * powers[k]
    return float(total)


@summing
def magnitude(c: Floats, first: int, order: int) -> float:
    """|c[first]| + ... + |c[order]|: what these terms are at most on [0, 1]."""
    total = 0.0
    for k in range(first, order + 1):
        total += abs(c[k])
    return float(total)


@summing
def value_and_slope(c: Floats, lead: int, order: int, theta: float) -> tuple[float, float]:
    """c[lead] + c[lead + 1] theta + ... + c[order] theta^(order - lead), and its derivative."""
    value, slope = c[order], 0.0
    for k in range(order - 1, lead - 1, -1):
        slope = slope * theta + value
        value = value * theta + c[k]
    return value, slope


@kernel
def stays_positive(c: Floats, lead: int, order: int, coarse: Floats) -> bool:
    """Whether the first coefficients alone show that the polynomial is positive on [0, 1]."""
    rest, lowest = magnitude(c, lead + COARSE + 1, order), np.inf
    for j in range(COARSE + 1):
        lowest = min(lowest, value_of(c[lead:], min(j, order - lead), coarse[j]))
    return bool(lowest > rest)


@kernel
def first_descent(c: Floats, lead: int, order: int, bernstein: Floats, boxes: Floats, spans: Floats) -> float:
    """First place in (0, 1] where the polynomial c[lead:order + 1], not negative at 0, becomes negative; else NEVER.

    Excursions below zero smaller than rounding are none.
    """
    doubt, lowest = COEFFICIENT_ROUNDING * magnitude(c, lead, order), 0.0
    for j in range(ORDER + 1):
        boxes[0, j] = value_of(c[lead:], min(j, order - lead), bernstein[j])
        lowest = min(lowest, boxes[0, j])
    if lowest >= -doubt:
        return NEVER
    spans[0, 0], spans[0, 1] = 0.0, 1.0
    top = 0
    while top >= 0:
        low, high = spans[top, 0], spans[top, 1]
        changes, negative, sign, first = 0, 0, 0, 0
        for j in range(ORDER + 1):
            b = boxes[top, j]
            if abs(b) > doubt or (j == 0 and low == 0.0):  # where it starts it is positive, however little
                now = 1 if b > 0.0 else -1
                if now < 0:
                    negative += 1
                if first == 0:
                    first = now
                elif now != sign:
                    changes += 1
                sign = now
        if negative == 0:
            top -= 1
            continue
        if first < 0 or top == DEPTH - 1 or high - low < 1e-15:  # what lies before this part is not negative
            return float(low)
        if changes == 1:
            return crossing(c, lead, order, low, high, boxes[top, 0], boxes[top, ORDER])
        middle = 0.5 * (low + high)
        for j in range(ORDER + 1):  # de Casteljau: the left part goes on top, the right one stays
            boxes[top + 1, j] = boxes[top, 0]
            for i in range(ORDER - j):
                boxes[top, i] = 0.5 * (boxes[top, i] + boxes[top, i + 1])
        spans[top, 0], spans[top, 1] = middle, high
        spans[top + 1, 0], spans[top + 1, 1] = low, middle
        top += 1
    return NEVER


@kernel
def crossing(c: Floats, lead: int, order: int, low: float, high: float, at_low: float, at_high: float) -> float:
    """The one root between low, where the polynomial is not negative, and high, where it is: safeguarded Newton.

    at_low, at_high : its values there; the first guess is where a line through them crosses zero, but at neither end.
    """
    part = at_low / (at_low - at_high) if at_high < 0.0 < at_low else 0.5
    x = low + (high - low) * min(max(part, 0.1), 0.9)
    for _ in range(100):
        f, slope = value_and_slope(c, lead, order, x)
        if f == 0.0:
            return x
        if f > 0.0:
            low = x
        else:
            high = x
        step = -f / slope if slope != 0.0 else 0.0
        new = x + step
        if not low < new < high:
            if abs(step) <= 1e-16 and step != 0.0:
                return x
            new = 0.5 * (low + high)
        if new == x or high - low <= 1e-16 * high:
            return x
        x = new
    return x
