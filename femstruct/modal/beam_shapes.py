"""Bending of a uniform beam in closed form: wave numbers and shapes between any two classical ends."""

from __future__ import annotations

from typing import Final, Literal

import numpy as np

from femstruct.arrays import Floats

End = Literal["pinned", "free", "clamped"]
CONDITIONS: Final[dict[str, tuple[int, int]]] = {"pinned": (0, 2), "free": (2, 3), "clamped": (0, 1)}
"""Orders of the derivatives of w that vanish at an end."""


def rigid_shapes(ends: tuple[End, End]) -> tuple[tuple[float, float], ...]:
    """a + b x / L of the rigid motions the ends allow, orthogonal over the beam."""
    if set(ends) == {"free"}:
        return ((1.0, 0.0), (-1.0, 2.0))
    if set(ends) == {"pinned", "free"}:
        return ((0.0, 1.0),) if ends[0] == "pinned" else ((1.0, -1.0),)
    return ()


def roots(ends: tuple[End, End], count: int) -> Floats:
    """beta L of the first elastic modes: Newton from the roots without the exponentially small terms."""
    n = np.arange(1, count + 1, dtype=np.float64)
    kinds = {*ends}
    if kinds == {"pinned"}:
        return n * np.pi
    if "pinned" in kinds:  # tan z = tanh z
        z = (n + 0.25) * np.pi
        for _ in range(8):
            z = z - (np.sin(z) - np.tanh(z) * np.cos(z)) / (
                np.cos(z) + np.tanh(z) * np.sin(z) - np.cos(z) * _sech(z) ** 2
            )
        return z
    sign = 1.0 if kinds == {"clamped", "free"} else -1.0  # cos z = -+ 1 / cosh z
    z = (n - 0.5) * np.pi if sign > 0 else (n + 0.5) * np.pi
    for _ in range(8):
        z = z - (np.cos(z) + sign * _sech(z)) / (-np.sin(z) - sign * np.tanh(z) * _sech(z))
    return z


def _sech(z: Floats) -> Floats:
    return 2.0 * np.exp(-z) / (1.0 + np.exp(-2.0 * z))


def terms(root: float, s: Floats, order: int) -> Floats:
    """The order-th derivative by s of cos, sin, e^{-z s} and e^{-z (1 - s)} at s [n] -> [n, 4], z = root."""
    phase = root * s[:, None] + order * np.pi / 2.0
    decay, rise = np.exp(-root * s[:, None]), np.exp(-root * (1.0 - s[:, None]))
    return root**order * np.concatenate([np.cos(phase), np.sin(phase), (-1.0) ** order * decay, rise], axis=1)


def amplitudes_of(ends: tuple[End, End], root: float) -> Floats:
    """Amplitudes of the four terms that meet the conditions at both ends."""
    rows = [
        terms(root, np.array([s]), order)[0] / root**order
        for s, end in ((0.0, ends[0]), (1.0, ends[1]))
        for order in CONDITIONS[end]
    ]
    amplitudes: Floats = np.linalg.svd(np.array(rows))[2][-1]
    return amplitudes


def sign_of(shape: Floats) -> float:
    """The sign of the largest value, of the first where several are alike to 0.1 %."""
    size = np.abs(shape)
    return float(np.sign(shape[np.argmax(size >= 0.999 * size.max())]))
