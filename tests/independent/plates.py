"""A simply supported thin plate by its closed-form modes, and what its motion does to boxes of air and to open air."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

Floats = np.ndarray


@dataclass(frozen=True)
class SupportedPlate:
    """Kirchhoff's plate a x b x h on four simply supported edges; loss : loss factor of every mode (2 x damping ratio).

    Modes sin(m pi x / a) sin(n pi y / b) / sqrt(rho h a b / 4), w = sqrt(D / rho h) ((m pi / a)^2 + (n pi / b)^2).
    """

    a: float
    b: float
    h: float
    E: float
    nu: float
    rho: float

    def modes(self, up_to_hz: float) -> list[tuple[float, int, int]]:
        """(frequency [Hz], m, n), ascending."""
        bending = self.E * self.h**3 / 12 / (1 - self.nu**2)
        root = sqrt(bending / (self.rho * self.h))
        found = [
            (root * ((m * pi / self.a) ** 2 + (n * pi / self.b) ** 2) / (2 * pi), m, n)
            for m in range(1, 200)
            for n in range(1, 200)
        ]
        return sorted(one for one in found if one[0] <= up_to_hz)

    def shape(self, m: int, n: int, at: Sequence[float]) -> float:
        """A mass-normalised mode at a place from its corner."""
        scale = 2 / sqrt(self.rho * self.h * self.a * self.b)
        return float(scale * np.sin(m * pi * at[0] / self.a) * np.sin(n * pi * at[1] / self.b))


def sine_on_cosine(m: int, length: float, start: float, order: int, whole: float) -> float:
    """Integral of sin(m pi (x - start) / length) cos(order pi x / whole) over the sine's length."""
    p, q = m * pi / length, order * pi / whole

    def part(k: float, shift: float) -> float:  # integral of sin(k u + shift), u from 0 to length
        if abs(k) * length < 1e-12:
            return float(np.sin(shift) * length)
        return float((np.cos(shift) - np.cos(k * length + shift)) / k)

    return 0.5 * (part(p + q, q * start) + part(p - q, -q * start))


@dataclass(frozen=True)
class Box:
    """A rectangular room with rigid walls, by its cosine modes; the air of it loses by two constants: gamma, the decay
    rate of all modes, and tau, a relaxation time.

    p_n = rho c^2 (s + 2 gamma) (1 + s tau) V_n / (L_n V (s^2 + 2 gamma s + w_n^2 (1 + s tau))), V_n the flow into the
    room weighted by the mode, L_n its mean square: of the wave equation weighted by cosines over the volume.
    """

    size: tuple[float, float, float]
    c: float = 343.0
    rho: float = 1.21
    gamma: float = 0.0
    tau: float = 0.0

    def per_flow(self, s: Floats, orders: tuple[int, int], place: Sequence[float], height: float, most: int) -> Floats:
        """Pressure at a place of all modes of two horizontal orders, per flow weighted by their cosines at a height.

        A sum over vertical orders to `most`, and the rest of its slow tail as at rest: the sum of cosines over squares
        is a polynomial of the heights.
        """
        x, y, z = place
        lx, ly, lz = self.size
        i, j = orders
        level = np.cos(i * pi * x / lx) * np.cos(j * pi * y / ly)
        mean = (0.5 if i else 1.0) * (0.5 if j else 1.0)
        k = np.arange(most + 1)
        w = self.c * pi * np.sqrt((i / lx) ** 2 + (j / ly) ** 2 + (k / lz) ** 2)
        lam = mean * np.where(k > 0, 0.5, 1.0)
        vertical = np.cos(k * pi * z / lz) * np.cos(k * pi * height / lz) / lam
        s = np.asarray(s)[:, None]
        soft = 1 + s * self.tau
        total = (soft * vertical / (s**2 + 2 * self.gamma * s + w**2 * soft)).sum(axis=1)
        # tail: k > most of 2 cos cos / (c pi k / lz)^2, with all of cos(k t) / k^2 = pi^2 / 6 - pi t / 2 + t^2 / 4
        tail = 0.0
        for t in (pi * abs(z - height) / lz, pi * (z + height) / lz):
            whole = pi**2 / 6 - pi * t / 2 + t * t / 4
            tail += whole - float((np.cos(k[1:] * t) / k[1:] ** 2).sum())
        total = total + tail / mean * (lz / (self.c * pi)) ** 2
        volume = lx * ly * lz
        return self.rho * self.c**2 * level / volume * (s[:, 0] + 2 * self.gamma) * total


def answering(own: float, w: Floats | float, loss: float, hysteretic: bool) -> Floats:
    """w_n^2 - w^2 + j eta w_n w of a dashpot, j eta w_n^2 of a loss factor of the stiffness."""
    return np.asarray(own**2 - w * w + 1j * loss * own * (own if hysteretic else w))


def pressure_in_box(
    box: Box, plate: SupportedPlate, corner: Sequence[float], drive: Sequence[float], receiver: Sequence[float],
    frequency: Floats, loss: float, up_to_hz: float, most: int = 60, orders: int = 12, hysteretic: bool = False,
) -> Floats:  # fmt: skip
    """Pressure per upward force on a plate in the ceiling of a box, by harmonic modes of both; the plate moves up out
    of the room, so a velocity upward is a flow out. corner : of the plate in the ceiling. drive : from its corner."""
    w = 2 * pi * frequency
    s = 1j * w
    modes = plate.modes(up_to_hz)
    motion = [1j * w * plate.shape(m, n, drive) / answering(2 * pi * f, w, loss, hysteretic) for f, m, n in modes]
    scale = 2 / sqrt(plate.rho * plate.h * plate.a * plate.b)
    total = np.zeros(len(frequency), complex)
    for i in range(orders):
        for j in range(orders):
            flow = np.zeros(len(frequency), complex)
            for (_, m, n), q in zip(modes, motion, strict=True):
                along = sine_on_cosine(m, plate.a, corner[0], i, box.size[0])
                across = sine_on_cosine(n, plate.b, corner[1], j, box.size[1])
                flow = flow - q * scale * along * across
            if np.abs(flow).max() > 0:
                total = total + flow * box.per_flow(s, (i, j), receiver, box.size[2], most)
    return total


def motion_with_air_of_box(
    box: Box, plate: SupportedPlate, corner: Sequence[float], drive: Sequence[float], frequency: Floats, loss: float,
    up_to_hz: float, most: int = 60, orders: int = 12, hysteretic: bool = False,
) -> tuple[list[tuple[int, int]], Floats]:  # fmt: skip
    """Modes (m, n) and their amplitudes [modes, nf] per upward force on a plate in the ceiling, the air pushing back.

    The pressure under the ceiling is the sum of P_ij cos cos over orders, each from its own flow -s sum B q; on a mode
    it pushes up with B: (D + s sum P_ij B B^T) q = shape at the drive, B being the integral of a mode with a cosine.
    """
    modes = plate.modes(up_to_hz)
    scale = 2 / sqrt(plate.rho * plate.h * plate.a * plate.b)
    s = 2j * pi * frequency
    own = [answering(2 * pi * f, 2 * pi * frequency, loss, hysteretic) for f, _, _ in modes]
    stiff = np.zeros((len(frequency), len(modes), len(modes)), complex)
    stiff[:, range(len(modes)), range(len(modes))] = np.array(own).T
    for i in range(orders):
        along = [sine_on_cosine(m, plate.a, corner[0], i, box.size[0]) for _, m, _ in modes]
        for j in range(orders):
            across = [sine_on_cosine(n, plate.b, corner[1], j, box.size[1]) for _, _, n in modes]
            weights = scale * np.array(along) * np.array(across)
            under = box.per_flow(s, (i, j), (0.0, 0.0, box.size[2]), box.size[2], most)
            stiff += (s * under)[:, None, None] * np.outer(weights, weights)
    driven = np.array([plate.shape(m, n, drive) for _, m, n in modes], complex)
    amplitudes = np.linalg.solve(stiff, np.broadcast_to(driven[:, None], (len(frequency), len(modes), 1)))[..., 0]
    return [(m, n) for _, m, n in modes], amplitudes.T


def pressure_of_motion(
    box: Box, plate: SupportedPlate, corner: Sequence[float], shapes: Sequence[tuple[int, int]], amplitudes: Floats,
    receiver: Sequence[float], frequency: Floats, most: int = 60, orders: int = 12,
) -> Floats:  # fmt: skip
    """Pressure of upward amplitudes [modes, nf] of modes (m, n) of a plate in the ceiling."""
    scale = 2 / sqrt(plate.rho * plate.h * plate.a * plate.b)
    s = 2j * pi * frequency
    total = np.zeros(len(frequency), complex)
    for i in range(orders):
        along = np.array([sine_on_cosine(m, plate.a, corner[0], i, box.size[0]) for m, _ in shapes])
        for j in range(orders):
            across = np.array([sine_on_cosine(n, plate.b, corner[1], j, box.size[1]) for _, n in shapes])
            flow = -s * scale * ((along * across) @ amplitudes)
            total = total + flow * box.per_flow(s, (i, j), receiver, box.size[2], most)
    return total


def power_in_the_open(
    plate: SupportedPlate, drive: Sequence[float], frequency: Floats, loss: float, up_to_hz: float, c: float = 343.0,
    rho: float = 1.21, points: int = 24, hysteretic: bool = False,
) -> Floats:  # fmt: skip
    """Sound power of a plate in a baffle to one side, over the mean square of a force: w rho / (2 pi) times the double
    integral of v v* sin(k R) / R, by Gauss points."""
    x, wx = np.polynomial.legendre.leggauss(points)
    px, py = plate.a * (x + 1) / 2, plate.b * (x + 1) / 2
    weights = (np.outer(wx, wx) * plate.a * plate.b / 4).ravel()
    places = np.stack(np.meshgrid(px, py, indexing="ij"), axis=-1).reshape(-1, 2)
    apart = np.sqrt(((places[:, None] - places[None]) ** 2).sum(axis=-1))
    scale = 2 / sqrt(plate.rho * plate.h * plate.a * plate.b)
    shapes = [
        (f, plate.shape(m, n, drive), scale * np.outer(np.sin(m * pi * px / plate.a), np.sin(n * pi * py / plate.b)))
        for f, m, n in plate.modes(up_to_hz)
    ]
    found = []
    for hz in frequency:
        w = 2 * pi * hz
        v = sum(1j * w * at / answering(2 * pi * f, w, loss, hysteretic) * one for f, at, one in shapes)
        flow = np.asarray(v).ravel() * weights
        kernel = w / c * np.sinc(w / c * apart / pi)  # sin(k R) / R
        found.append(w * rho / (2 * pi) * float((flow.conj() @ kernel @ flow).real))
    return np.array(found)


def pressure_in_the_open(
    plate: SupportedPlate, drive: Sequence[float], place: Sequence[float], frequency: Floats, loss: float,
    up_to_hz: float, c: float = 343.0, rho: float = 1.21, points: int = 48,
    hysteretic: bool = False,
) -> Floats:  # fmt: skip
    """Rayleigh's integral j w rho / (2 pi) v exp(-j k r) / r over a plate in a baffle, per upward force, by Gauss
    points; place : from the plate's centre, above it. Below it the sign turns."""
    x, wx = np.polynomial.legendre.leggauss(points)
    px, py = plate.a * (x + 1) / 2, plate.b * (x + 1) / 2
    weights = np.outer(wx, wx) * plate.a * plate.b / 4
    dx, dy = px - plate.a / 2 - place[0], py - plate.b / 2 - place[1]
    r = np.sqrt(dx[:, None] ** 2 + dy[None, :] ** 2 + place[2] ** 2)
    found = np.zeros(len(frequency), complex)
    modes = plate.modes(up_to_hz)
    scale = 2 / sqrt(plate.rho * plate.h * plate.a * plate.b)
    for number, f in enumerate(frequency):
        w = 2 * pi * f
        green = np.exp(-1j * w / c * r) / r * weights
        for f0, m, n in modes:
            q = 1j * w * plate.shape(m, n, drive) / answering(2 * pi * f0, w, loss, hysteretic)
            one = np.outer(np.sin(m * pi * px / plate.a), np.sin(n * pi * py / plate.b)) * scale
            found[number] += 1j * w * rho / (2 * pi) * q * (green * one).sum()
    return found * np.sign(place[2])


def piston_power(radius: float, frequency: float, c: float, rho: float) -> float:
    """Radiated power of a baffled circular piston per mean square of its velocity: rho c S (1 - J1(2ka) / ka)."""
    from scipy.special import j1

    ka = 2 * pi * frequency / c * radius
    return float(rho * c * pi * radius**2 * (1 - j1(2 * ka) / ka))
