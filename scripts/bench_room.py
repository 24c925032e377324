"""Cost of a plane of receivers: matrix products against loops over cosines and receivers, in one run.

    python scripts/bench_room.py [receivers] [samples]

The last ones are of a bedroom with listeners at three heights, to 10 kHz: its transfer functions against their bound,
one complex exponential for every cosine and line, and against the formula with its own exponentials at each height.

Two loops do the same work for a few receivers and cosines and are scaled up: one with arrays along the frequencies,
whose answer is compared, and one in plain Python, line by line. The ratios count; seconds depend on the machine.
"""

from __future__ import annotations

import cmath
import sys
import time

import numpy as np

from acoustics.air import Air
from acoustics.fields.rectangular import Room
from acoustics.losses import losses_from_beta, losses_from_t60
from acoustics.receivers import Receiver
from acoustics.rooms.box import cosines, horizontal_wavenumber, project, transfer, vertical_wavenumber
from acoustics.rooms.box_pressure import extend_to_rest, pressure
from acoustics.source import SurfaceVelocity

ORDERS, WINDOW, RATE, FEW_LINES = 12, 10.0, 48e3, 20_000
BLOCK = 1 << 15  # complex numbers handled at once, as the package does


def main(n_receivers: int = 1000, n_samples: int = 32768) -> dict[str, float]:
    """CPU seconds of both ways, their ratio, and the largest relative difference on what the loop did."""
    room = Room([0.58, 0.47, 0.1], Air(340, 1.29), losses_from_beta(0.0116, 293))
    random = np.random.default_rng(1)
    surface = moving_ceiling(room, n_samples, random)
    places = np.column_stack([random.uniform(0.0, 1.0, (n_receivers, 2)) * room.size[:2], np.full(n_receivers, 0.05)])
    receivers = [Receiver(str(i), place) for i, place in enumerate(places)]
    start = time.process_time()
    response = pressure(surface, room, receivers, orders=ORDERS)
    together = time.process_time() - start

    few_receivers, few_orders = 2, 3
    start = time.process_time()
    slow = plain_loop(surface, room, places[:few_receivers], few_orders)
    alone = (time.process_time() - start) * (n_receivers / few_receivers) * (ORDERS / few_orders) ** 2
    fast = pressure(surface, room, receivers[:few_receivers], orders=few_orders).p
    lines = n_samples + 1  # of a transform of twice the record
    start = time.process_time()
    line_by_line(room, FEW_LINES)
    python = (time.process_time() - start) * (lines / FEW_LINES) * n_receivers * ORDERS**2
    return {
        "together_s": together,
        "array_loop_s": alone,
        "array_loop_ratio": alone / together,
        "python_loop_s": python,
        "python_loop_ratio": python / together,
        "difference": float(np.abs(fast - slow).max() / np.abs(slow).max()),
        "peak_pa": float(np.abs(response.p).max()),
        **bedroom(),
    }


def bedroom() -> dict[str, float]:
    """CPU seconds of the transfer functions of a bedroom, of their bound and of their formula, and the difference."""
    room = Room([5.0, 4.0, 2.5], losses=losses_from_t60(0.5))
    s, k_lm = 9.0 + 2j * np.pi * np.linspace(1.0, 10e3, 4000), np.linspace(0.0, 40.0, 256)
    levels = np.array([1.0, 1.2, 1.5])
    mu = -1j * vertical_wavenumber(room, s, k_lm)
    height, width = float(room.size[2]), max(1, BLOCK // len(k_lm))
    blocks = [slice(start, start + width) for start in range(0, len(s), width)]

    def formula(lines: slice) -> list[np.ndarray]:
        here = -1j * vertical_wavenumber(room, s[lines], k_lm)
        front = -room.air.rho * (s[lines] + 2 * room.losses.decay_rate) / (here * (1 - np.exp(2 * height * here)))
        return [front * (np.exp((height - z) * here) + np.exp((height + z) * here)) for z in levels.tolist()]

    taken = {}
    for name, work in (
        ("transfer_s", lambda lines: transfer(room, s[lines], k_lm, levels)),
        ("transfer_bound_s", lambda lines: np.exp(mu[:, lines])),
        ("transfer_formula_s", formula),
    ):
        start = time.process_time()
        for lines in blocks:
            work(lines)
        taken[name] = time.process_time() - start
    found, wanted = (np.array(way(blocks[1])) for way in (lambda b: transfer(room, s[b], k_lm, levels), formula))
    return {
        **taken,
        "transfer_over_bound": taken["transfer_s"] / taken["transfer_bound_s"],
        "formula_over_transfer": taken["transfer_formula_s"] / taken["transfer_s"],
        "transfer_difference": float(np.abs(found - wanted).max() / np.abs(wanted).max()),
    }


def moving_ceiling(room: Room, n_samples: int, random: np.random.Generator) -> SurfaceVelocity:
    """A ceiling of 30 x 24 points moving in 20 modes that ring at 20 to 600 Hz after a soft blow."""
    x, y = ((np.arange(n) + 0.5) / n * length for n, length in zip((30, 24), room.size[:2], strict=True))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    points = np.column_stack([grid, np.full(len(grid), room.size[2])])
    frequency_hz = np.linspace(20, 600, 20)
    phase = random.uniform(0, 2 * np.pi, (20, 2))
    waves = np.cos(np.outer(grid[:, 0], np.arange(20)) + phase[:, 0]) * np.cos(grid[:, [1]] * 5 + phase[:, 1])
    t = np.arange(n_samples) / RATE
    rates = np.sin(2 * np.pi * np.outer(frequency_hz, t)) * np.exp(-20 * t) * (1 - np.exp(-t / 2e-3)) ** 3
    return SurfaceVelocity(points, np.full(len(grid), room.ceiling_area / len(grid)), waves, rates, 1 / RATE)


def plain_loop(surface: SurfaceVelocity, room: Room, places: np.ndarray, orders: int) -> np.ndarray:
    """The same sum, one cosine and one receiver at a time."""
    n_samples = surface.rates.shape[1]
    length, decay = 2 * n_samples, WINDOW / (n_samples * surface.dt)
    weight = np.exp(-decay * surface.dt * np.arange(length))
    s = decay + 2j * np.pi * np.fft.rfftfreq(length, surface.dt)
    p = np.zeros((len(places), n_samples))
    for row, place in enumerate(places):
        for pair in np.ndindex(orders, orders):
            one = np.array([pair])
            velocity = np.fft.rfft(extend_to_rest(project(surface, room, one) @ surface.rates, length)[0] * weight)
            through = transfer(room, s, horizontal_wavenumber(room, one), place[2:])[0][0]
            here = cosines(room, one, place[None, :2])[0, 0]
            p[row] += here * np.fft.irfft(through * velocity, length)[:n_samples] / weight[:n_samples]
    return p


def line_by_line(room: Room, n_lines: int) -> complex:
    """The transfer of one cosine to one receiver at one frequency after the other, summed."""
    height, z, c, tau = float(room.size[2]), 0.05, room.air.c, room.losses.relaxation_time
    k_lm, total = 5.0, 0j
    for line in range(1, n_lines + 1):
        s = complex(70.0, 4.8 * line)
        mu = cmath.sqrt(-s * s / (c * c * (1 + s * tau)) - k_lm * k_lm)
        mu = mu if mu.imag <= 0 else -mu
        down, up = cmath.exp(-1j * mu * (height - z)), cmath.exp(-1j * mu * (height + z))
        total += room.air.rho * s * 1j * (down + up) / (mu * (1 - cmath.exp(-2j * mu * height))) * cmath.exp(1j * line)
    return total


if __name__ == "__main__":
    for name, value in main(*map(int, sys.argv[1:])).items():
        sys.stdout.write(f"{name:18} {value:.3g}\n")
