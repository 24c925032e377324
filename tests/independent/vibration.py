"""Steady vibration, shock spectra, what people feel, and fatigue, from textbooks; nothing of the packages."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import exp, gamma, pi, sqrt

import numpy as np

Floats = np.ndarray
G = 9.80665


def receptance(omega: Sequence[float], ratio: Sequence[float], drive: Sequence[float], answer: Sequence[float]) -> (
    Callable[[Floats], Floats]
):  # fmt: skip
    """Displacement per force of modes with unit modal mass, of the angular frequency."""

    def of(w: Floats) -> Floats:
        parts = zip(omega, ratio, drive, answer, strict=True)
        return sum(  # type: ignore[return-value]
            a * b / (o * o - w * w + 2j * z * o * w) for o, z, a, b in parts
        )

    return of


def transmitted(omega: float, ratio: float, w: Floats) -> Floats:
    """Absolute acceleration of an oscillator over that of its base."""
    return (omega**2 + 2j * ratio * omega * w) / (omega**2 - w * w + 2j * ratio * omega * w)


def moments(density: Callable[[Floats], Floats], low: float, high: float, peaks: Sequence[float]) -> Floats:
    """Moments 0, 1, 2, 4 [unit^2 Hz^n] of a one-sided density along frequency, by Gauss-Legendre on short pieces.

    peaks : frequencies [Hz] towards which the pieces grow shorter.
    """
    edges = {low, high}
    for peak in peaks:
        for step in np.geomspace(1e-5, 2.0, 90):
            edges |= {peak * (1 - step), peak * (1 + step)}
    edges |= set(np.geomspace(max(low, 1e-6 * high), high, 200)) | set(np.linspace(low, high, 60))
    cuts = np.array(sorted(edge for edge in edges if low <= edge <= high))
    nodes, weights = np.polynomial.legendre.leggauss(8)
    middle, half = 0.5 * (cuts[1:] + cuts[:-1]), 0.5 * np.diff(cuts)
    f = (middle[:, None] + half[:, None] * nodes).ravel()
    w = (half[:, None] * weights).ravel()
    values = density(f)
    return np.array([(w * values * f**n).sum() for n in (0, 1, 2, 4)])


def log_log(points: Sequence[tuple[float, float]]) -> Callable[[Floats], Floats]:
    """Straight lines in double logarithmic paper; nothing outside."""
    f, s = np.log(np.array(points, float)).T

    def of(frequency: Floats) -> Floats:
        inside = (frequency >= points[0][0] * (1 - 1e-12)) & (frequency <= points[-1][0] * (1 + 1e-12))
        return np.where(inside, np.exp(np.interp(np.log(frequency), f, s)), 0.0)

    return of


def dirlik(m: Floats, slope: float, stress: float, at: float, duration: float) -> float:
    """Damage of a Gaussian random history in a duration by Dirlik's ranges, N = at (stress / range)^slope.

    T. Dirlik, thesis, Warwick 1985; as in N. W. M. Bishop, F. Sherratt, Finite Element Based Fatigue Calculations.
    """
    m0, m1, m2, m4 = m
    x, g = m1 / m0 * sqrt(m2 / m4), m2 / sqrt(m0 * m4)
    d1 = 2 * (x - g * g) / (1 + g * g)
    r = (g - x - d1 * d1) / (1 - g - d1 + d1 * d1)
    d2 = (1 - g - d1 + d1 * d1) / (1 - r)
    d3 = 1 - d1 - d2
    q = 1.25 * (g - d3 - d2 * r) / d1
    k = slope
    mean = d1 * q**k * gamma(1 + k) + sqrt(2) ** k * gamma(1 + k / 2) * (d2 * abs(r) ** k + d3)
    return sqrt(m4 / m2) * duration * (2 * sqrt(m0)) ** k * mean / (at * stress**k)


def rayleigh_damage(m: Floats, slope: float, stress: float, at: float, duration: float) -> float:
    """Damage of a narrow band: ranges are twice Rayleigh's peaks."""
    return sqrt(m[2] / m[0]) * duration * (2 * sqrt(2 * m[0])) ** slope * gamma(1 + slope / 2) / (at * stress**slope)


def rainflow(history: Floats) -> list[tuple[float, float]]:
    """(range, count) by the counting of ASTM E1049-85, 5.4.4, step by step as the standard writes it."""
    turns = [float(history[0])]
    for before, here, after in zip(history[:-2], history[1:-1], history[2:], strict=True):
        if (here - before) * (after - here) < 0.0:
            turns.append(float(here))
    turns.append(float(history[-1]))
    found: list[tuple[float, float]] = []
    read: list[float] = []
    for turn in turns:
        read.append(turn)
        while len(read) >= 3:
            newest, before = abs(read[-1] - read[-2]), abs(read[-2] - read[-3])
            if newest < before:
                break
            if len(read) == 3:
                found.append((before, 0.5))
                read.pop(0)
            else:
                found.append((before, 1.0))
                del read[-3:-1]
    found += [(abs(b - a), 0.5) for a, b in pairwise(read)]
    return found


def miner(cycles: Sequence[tuple[float, float]], slope: float, stress: float, at: float) -> float:
    """Sum of counts over the cycles that are endured."""
    return sum(count * (size / stress) ** slope for size, count in cycles) / at


def shock_spectrum(base: Floats, step: float, f: Floats, ratio: float) -> tuple[Floats, Floats]:
    """Largest upward and downward absolute accelerations of oscillators [Hz] on a base, and while they ring on.

    base [nt] : its acceleration, straight between samples a step apart; the oscillators' motion is exact for that:
    z'' + 2 r w z' + w^2 z = -a, z = start + slope t + exp(-r w t) (A cos + B sin).
    """
    w = 2 * pi * np.asarray(f, float)
    wd, c1 = w * sqrt(1 - ratio * ratio), ratio * w
    e, c, s = np.exp(-c1 * step), np.cos(wd * step), np.sin(wd * step)
    z, v = np.zeros(len(w)), np.zeros(len(w))
    up, down = np.zeros(len(w)), np.zeros(len(w))
    for a0, a1 in pairwise(base.tolist()):
        slope = (a0 - a1) / step / w**2
        start = -a0 / w**2 - 2 * ratio / w * slope
        A = z - start
        B = (v - slope + c1 * A) / wd
        z = start + slope * step + e * (A * c + B * s)
        v = slope + e * ((wd * B - c1 * A) * c - (c1 * B + wd * A) * s)
        felt = -(2 * c1 * v + w * w * z)  # absolute acceleration
        up, down = np.maximum(up, felt), np.maximum(down, -felt)
    ring = np.linspace(0, 1.2, 600)[:, None] / f
    A, B = z, (v + c1 * z) / wd
    decay, cos, sin = np.exp(-c1 * ring), np.cos(wd * ring), np.sin(wd * ring)
    felt = -decay * (2 * c1 * ((wd * B - c1 * A) * cos - (c1 * B + wd * A) * sin) + w * w * (A * cos + B * sin))
    return np.maximum(up, felt.max(axis=0)), np.maximum(down, -felt.min(axis=0))


# What people feel: transfer functions of DIN 45669-1 and ISO 2631-1 (annex A), ISO 2631-2


def _band(s: Floats, low: float, high: float) -> Floats:
    w1, w2 = 2 * pi * low, 2 * pi * high
    return s**2 / (s**2 + sqrt(2) * w1 * s + w1**2) * w2**2 / (s**2 + sqrt(2) * w2 * s + w2**2)


def kb(f: Floats) -> Floats:
    """Of a velocity: band limits of DIN 45669-1 at 0.8 and 100 Hz, 1 / sqrt(1 + (5.6 / f)^2)."""
    return _band(2j * pi * f, 0.8, 100.0) / (1 - 5.6j / np.maximum(f, 1e-12))


def w_k(f: Floats) -> Floats:
    """Of a vertical acceleration, ISO 2631-1."""
    s = 2j * pi * f
    w3 = w4 = 2 * pi * 12.5
    w5, w6 = 2 * pi * 2.37, 2 * pi * 3.35
    go = (1 + s / w3) / (1 + s / (0.63 * w4) + (s / w4) ** 2)
    step = (1 + s / (0.91 * w5) + (s / w5) ** 2) / (1 + s / (0.91 * w6) + (s / w6) ** 2) * (w5 / w6) ** 2
    return _band(s, 0.4, 100.0) * go * step


def w_d(f: Floats) -> Floats:
    """Of a horizontal acceleration, ISO 2631-1."""
    s, w = 2j * pi * f, 2 * pi * 2.0
    return _band(s, 0.4, 100.0) * (1 + s / w) / (1 + s / (0.63 * w) + (s / w) ** 2)


def w_m(f: Floats) -> Floats:
    """Of any acceleration in buildings, ISO 2631-2: 1 / (1 + s / w3) with 5.684 Hz."""
    s = 2j * pi * f
    return _band(s, 0.7943, 100.0) / (1 + s / (2 * pi * 5.684))


def weighted(history: Floats, sampling: float, curve: Callable[[Floats], Floats]) -> Floats:
    """A history, nothing before and after it, through a transfer function."""
    n = 1 << int(np.ceil(np.log2(len(history) + 8 * sampling)))
    spectrum = np.fft.rfft(history, n) * curve(np.fft.rfftfreq(n, 1 / sampling))
    return np.fft.irfft(spectrum, n)[: len(history)]


def running_rms(history: Floats, sampling: float, seconds: float) -> Floats:
    """Exponential mean of the square, its root: the square held straight between samples."""
    h = 1 / sampling
    keep = exp(-h / seconds)
    late = seconds / h * (1 - keep)
    square, mean = history**2, np.zeros(len(history))
    for i in range(1, len(history)):
        mean[i] = keep * mean[i - 1] + (late - keep) * square[i - 1] + (1 - late) * square[i]
    return np.sqrt(np.maximum(mean, 0.0))
