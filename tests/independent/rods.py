"""Rods and beams in closed form: frequencies and shapes of unit modal mass, at places along them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi, sqrt

import numpy as np
from scipy.optimize import brentq

Floats = np.ndarray
Found = tuple[list[float], dict[str, list[float]]]  # angular frequencies, and of each place one value a mode


def rod(length: float, E: float, rho: float, area: float, modes: int, at: Mapping[str, float]) -> Found:
    """A free rod: cosines; the first mode is rigid."""
    mass, n = rho * area * length, np.arange(modes)
    size = np.where(n > 0, sqrt(2 / mass), sqrt(1 / mass))
    shapes = {name: (size * np.cos(n * pi * x / length)).tolist() for name, x in at.items()}
    return (n * pi / length * sqrt(E / rho)).tolist(), shapes


def beam_roots(ends: Sequence[str], count: int) -> Floats:
    """Roots beta L of the frequency equations."""
    pair = "".join(sorted(one[0] for one in ends))  # c f p
    if pair == "pp":
        return np.arange(1, count + 1) * pi
    if pair in ("cc", "ff"):
        return np.array([brentq(lambda x: np.cos(x) - 1 / np.cosh(x), n + 0.5, n + 2.6) for n in _near(count, 1.5)])
    if pair == "cf":
        return np.array([brentq(lambda x: np.cos(x) + 1 / np.cosh(x), n + 0.5, n + 2.6) for n in _near(count, 0.5)])
    return np.array(
        [brentq(lambda x: np.sin(x) - np.cos(x) * np.tanh(x), n + 0.5, n + 2.6) for n in _near(count, 1.25)]
    )


def _near(count: int, shift: float) -> list[float]:
    """Where brackets of 2.1 begin, about (n + shift) pi."""
    return [float((n + shift) * pi - 1.55) for n in range(count)]


def beam(
    length: float, ends: Sequence[str], EI: float, mass_per_length: float, modes: int, at: Mapping[str, float]
) -> Found:
    """A beam whose first modes are rigid where its ends let it: of cos, sin and what decays from each end, the one that
    meets the four conditions."""
    free = {("free", "free"): 2, ("free", "pinned"): 1}.get(tuple(sorted(ends)), 0)  # type: ignore[call-overload]
    omega, shapes = [0.0] * free, {name: [] for name in at}  # type: dict[str, list[float]]
    x, w = np.polynomial.legendre.leggauss(200)
    x, w = length * (x + 1) / 2, w * length / 2
    middle = {"free": length / 2, "pinned": 0.0 if ends[0] == "pinned" else length}
    for rigid in range(free):
        turned = rigid == 1 or free == 1
        pivot = middle["pinned" if free == 1 else "free"]
        norm = sqrt(mass_per_length * float((w * ((x - pivot) ** 2 if turned else 1.0)).sum()))
        for name, place in at.items():
            shapes[name].append((place - pivot if turned else 1.0) / norm)
    for root in beam_roots(ends, modes - free):
        b = root / length
        rows = [row for end, place in zip(ends, (0.0, length), strict=True) for row in _held(end, b, place, length)]
        mix = np.linalg.svd(np.array(rows))[2][-1]
        norm = sqrt(mass_per_length * float((w * (mix @ _parts(b, x, length, 0)) ** 2).sum()))
        for name, place in at.items():
            shapes[name].append(float(mix @ _parts(b, np.array([place]), length, 0)[:, 0]) / norm)
        omega.append(float(b * b * sqrt(EI / mass_per_length)))
    return omega, shapes


def _parts(b: float, x: Floats, length: float, order: int) -> Floats:
    """cos, sin, exp(-b x), exp(-b (L - x)), or their derivatives over b."""
    turn = order * pi / 2
    return np.array([
        np.cos(b * x + turn), np.sin(b * x + turn), (-1.0) ** order * np.exp(-b * x), np.exp(-b * (length - x)),
    ])  # fmt: skip


def _held(end: str, b: float, place: float, length: float) -> list[Floats]:
    orders = {"pinned": (0, 2), "free": (2, 3), "clamped": (0, 1)}[end]
    return [_parts(b, np.array([place]), length, order)[:, 0] for order in orders]
