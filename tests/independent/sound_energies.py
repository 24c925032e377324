"""Sound energy that a baffled rectangle sends to one side after a half sine of a force, from spectra and modes.

A history has twice |V(f)|^2 of each frequency above 0 in the integral of its square: so is the energy twice |F(f)|^2
times the power that 1 N rms makes there. A rigid rectangle radiates rho c S sigma, modes by a matrix that changes
slowly along frequency: w rho / (2 pi) times the double integral of two shapes and sin(k R) / R (Rayleigh).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil, pi

import numpy as np
from scipy.integrate import cumulative_simpson
from scipy.interpolate import CubicSpline

from tests.independent.levels import a_weighting, exact
from tests.independent.pistons import Oscillator
from tests.independent.plates import SupportedPlate
from tests.independent.statistical_energies import by_distance

Floats = np.ndarray
PICO = 1e-12  # J


def half_sine(amplitude: float, hz: float, f: Floats) -> Floats:
    """Fourier transform [N s] of the first half period of a sine, beside its removable singularity."""
    w, own = 2 * pi * f, 2 * pi * hz * (1 + 1e-9)
    return np.asarray(amplitude * own * (1 + np.exp(-1j * w * pi / own)) / (own**2 - w**2))


@dataclass(frozen=True)
class Sent:
    """Densities over frequency [J/Hz], evenly spaced: sound, that of plane waves of the same motion, and what the force
    gives."""

    f: Floats
    sound: Floats
    plane: Floats
    given: Floats

    def between(self, density: Floats, low: float, high: float) -> float:
        """Energy between two frequencies [J]."""
        whole = np.concatenate([[0.0], cumulative_simpson(density, x=self.f)])
        return float(np.diff(CubicSpline(self.f, whole)([low, high]))[0])

    def bands(self, thirds: Sequence[float]) -> Floats:
        """Level [dB re 1 pJ] and 10 lg of the radiation efficiency of third octaves, one after the other."""
        edges = [(exact(one) / 10**0.05, exact(one) * 10**0.05) for one in thirds]
        sound = np.array([self.between(self.sound, *both) for both in edges])
        plane = np.array([self.between(self.plane, *both) for both in edges])
        return 10 * np.log10([*sound / PICO, *sound / plane])

    def numbers(self, end: float) -> Floats:
        """Level, with A weighting, 10 lg of the efficiency and of the share of what is given, all below a frequency but
        that."""
        weighted = self.sound * a_weighting(self.f) ** 2
        sound, heard, plane = (self.between(one, self.f[0], end) for one in (self.sound, weighted, self.plane))
        given = self.between(self.given, self.f[0], self.f[-1])
        return 10 * np.log10([sound / PICO, heard / PICO, sound / plane, sound / given])


def of_piston(
    piston: Oscillator, sides: tuple[float, float], push: tuple[float, float], air: Mapping[str, float], f: Floats
) -> Sent:
    """Of a rigid rectangle that a half sine (amplitude [N], frequency [Hz]) pushes."""
    area, rho_c = sides[0] * sides[1], air["rho"] * air["c"]
    force = half_sine(*push, f)
    mobility = 2j * pi * f / piston.dynamic(2j * pi * f)
    some = np.linspace(f[0], f[-1], ceil((f[-1] - f[0]) / 10) + 1)
    sigma = CubicSpline(some, [by_distance(2 * pi * one / air["c"], 0.0, sides) for one in some.tolist()])(f)
    plane = 2 * rho_c * area * np.abs(force * mobility) ** 2
    return Sent(f, plane * sigma, plane, 2 * np.abs(force) ** 2 * mobility.real)


def of_plate(
    plate: SupportedPlate, at: Sequence[float], loss: float, push: tuple[float, float], air: Mapping[str, float],
    f: Floats, up_to: float, points: int = 28,
) -> Sent:  # fmt: skip
    """The same of a simply supported plate that is pushed at a place; loss : twice its damping ratio."""
    x, wx = np.polynomial.legendre.leggauss(points)
    px, py = plate.a * (x + 1) / 2, plate.b * (x + 1) / 2
    weights = (np.outer(wx, wx) * plate.a * plate.b / 4).ravel()
    places = np.stack(np.meshgrid(px, py, indexing="ij"), axis=-1).reshape(-1, 2)
    apart = np.sqrt(((places[:, None] - places[None]) ** 2).sum(axis=-1))
    scale = 2 / np.sqrt(plate.rho * plate.h * plate.a * plate.b)
    modes = plate.modes(up_to)
    shapes = np.array([
        scale * np.outer(np.sin(m * pi * px / plate.a), np.sin(n * pi * py / plate.b)).ravel() for _, m, n in modes
    ])  # fmt: skip
    driven = np.array([plate.shape(m, n, at) for _, m, n in modes])
    w, own = 2 * pi * f, 2 * pi * np.array([one for one, _, _ in modes])[:, None]
    force = half_sine(*push, f)
    rates = driven[:, None] * 1j * w / (own**2 - w**2 + 1j * loss * own * w) * force
    some = np.linspace(f[0], f[-1], 25)
    flows = shapes * weights
    resists = CubicSpline(some, [
        one * air["rho"] * flows @ (2 * pi * one / air["c"] * np.sinc(2 * one / air["c"] * apart)) @ flows.T
        for one in some.tolist()
    ])  # fmt: skip
    sound = np.array([float((rate.conj() @ resists(one) @ rate).real) for one, rate in zip(f, rates.T, strict=True)])
    moved = (np.abs(rates) ** 2).sum(axis=0) / (plate.rho * plate.h)  # int v^2 dS
    given = (np.conj(force) * (driven @ rates)).real
    return Sent(f, 2 * sound, 2 * air["rho"] * air["c"] * moved, 2 * given)
