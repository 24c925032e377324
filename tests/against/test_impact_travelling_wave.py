"""The rod between two masses (section 2.3) against travelling waves, an exact solution without modes.

u = f(t - x/c) + g(t + x/c); an end pushed by F moves with 2 x (arriving wave) + F / Z, Z = rho A c: each end is an
ordinary differential equation driven by what the other end sent L / c earlier. Every piece is a Taylor series that is
exact to rounding; pieces end where a contact opens or closes, where either echo of that arrives, and on a grid.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval
from scipy.optimize import brentq
from systems.rod import SPEED_OF_SOUND, RodCase, energies, hit

DEGREE = 24
Series = np.ndarray


@dataclass
class Mass:
    """A mass on a linear unilateral contact with an end of the rod; sign : +1 at the left end, -1 at the right one."""

    m: float
    k: float
    Z: float
    v: float
    sign: float
    delta: float = 0.0
    pieces: list[tuple[float, Series]] = field(default_factory=list)

    def series(self, arriving: Series, closed: bool) -> tuple[Series, Series, Series]:
        """Taylor series of indentation, velocity and contact force from here on.

        delta' = sign (v - 2 arriving) - F / Z and m v' = - sign F.
        """
        delta, v, force = np.zeros(DEGREE + 1), np.zeros(DEGREE + 1), np.zeros(DEGREE + 1)
        delta[0], v[0] = self.delta, self.v
        for n in range(DEGREE):
            force[n] = self.k * delta[n] if closed else 0.0
            delta[n + 1] = (self.sign * (v[n] - 2.0 * arriving[n]) - force[n] / self.Z) / (n + 1)
            v[n + 1] = -self.sign * force[n] / self.m / (n + 1)
        return delta, v, force

    def advance(self, arriving: Series, h: float) -> tuple[float, Series]:
        """Move on by h or to the next opening or closing; returns the time moved and the wave that leaves."""
        closed = self.delta > 0.0
        if self.delta == 0.0:
            leading = self.series(arriving, False)[0][1:]
            first = leading[np.abs(leading) > 0.0][:1]
            closed = bool(first.size and first[0] > 0.0)
        delta, v, force = self.series(arriving, closed)
        times = np.linspace(0.0, h, 17)[1:]
        past = np.nonzero((polyval(times, delta) < 0.0) if closed else (polyval(times, delta) > 0.0))[0]
        toggles = bool(past.size)
        if toggles:
            low = times[past[0] - 1] if past[0] else 1e-9 * h
            h = float(brentq(lambda t: polyval(t, delta), low, times[past[0]], xtol=1e-18, rtol=1e-15))
        return h, self.leave(arriving, delta, v, force, h, toggles)

    def leave(self, arriving: Series, delta: Series, v: Series, force: Series, h: float, toggles: bool) -> Series:
        self.pending = (0.0 if toggles else float(polyval(h, delta)), float(polyval(h, v)), delta, v)
        return arriving + self.sign * force / self.Z

    def settle(self, h: float, own: float) -> None:
        """Take the state at h, which may be before the end that this mass itself asked for."""
        at_end, v_end, delta, v = self.pending
        self.delta = at_end if h == own else float(polyval(h, delta))
        self.v = v_end if h == own else float(polyval(h, v))


def shifted(series: Series, by: float) -> Series:
    """Taylor series about a point further on."""
    moved = series.copy()
    for i in range(len(series) - 1):
        for j in range(len(series) - 2, i - 1, -1):
            moved[j] += by * moved[j + 1]
    return moved


def travelling_waves(case: RodCase, duration: float = 5e-3) -> tuple[float, float, float]:
    """Velocities of damper and ball in the end, and the damper's when the first wave arrives."""
    delay = case.length / SPEED_OF_SOUND
    Z = case.mass / case.length * SPEED_OF_SOUND
    left = Mass(case.ball, case.ball * (case.wb * case.first) ** 2, Z, 1.0, 1.0)
    right = Mass(case.damper, case.damper * (case.wd * case.first) ** 2, Z, 0.0, -1.0)
    rate = max(left.k / Z, right.k / Z, np.sqrt(left.k / left.m), np.sqrt(right.k / right.m))
    grid = int(np.ceil(2.0 * rate * delay))
    marks = sorted([*(delay * (j + 1) / grid for j in range(grid)), duration])
    sent: list[tuple[float, Series, Series]] = []  # start, wave leaving left, wave leaving right
    t, at, before_arrival = 0.0, 0, 0.0
    while t < duration * (1 - 1e-14):
        while marks and marks[0] <= t + 1e-15:
            heapq.heappop(marks)
        h = marks[0] - t
        from_right = from_left = np.zeros(DEGREE + 1)
        if t >= delay * (1 - 1e-14):
            while at + 1 < len(sent) and sent[at + 1][0] + delay <= t + 1e-15:
                at += 1
            by = t - delay - sent[at][0]
            from_left, from_right = shifted(sent[at][1], by), shifted(sent[at][2], by)
        else:
            before_arrival = right.v
        h_left, leaving_left = left.advance(from_right, h)
        h_right, leaving_right = right.advance(from_left, h)
        h = min(h_left, h_right)
        left.settle(h, h_left)
        right.settle(h, h_right)
        sent.append((t, leaving_left, leaving_right))
        t += h
        heapq.heappush(marks, t + delay)
    return right.v, left.v, before_arrival


def wave_energy(case: RodCase) -> float:
    """E_d+ / E_b- of travelling waves."""
    return case.damper * travelling_waves(case)[0] ** 2 / case.ball


@pytest.mark.parametrize(("wb", "wd", "other"), [(0.8, 0.8, 0.636844), (2.0, 2.0, 0.903186), (5.0, 5.0, 0.663459)])
def test_oracle_agrees_with_another_one(wb: float, wd: float, other: float) -> None:
    """An independent delay-differential solver, printed digits."""
    assert wave_energy(RodCase(wb, wd)) == pytest.approx(other, abs=6e-7)  # half a unit of the sixth digit: 4.5e-7 here


def test_before_the_echo_the_rod_is_a_dashpot() -> None:
    """Until 2 L / c the ball feels rho A c alone: m v' = -F, F = k delta, delta' = v - F / Z."""
    case = RodCase(0.8, 0.8, length=20.0, mass=50.0, ball=60.0)  # heavy: m omega_b > 2 Z, it does not come off
    k, Z = case.ball * (case.wb * case.first) ** 2, case.mass / case.length * SPEED_OF_SOUND
    t = 1.9 * case.length / SPEED_OF_SOUND
    matrix = np.array([[-k / Z, 1.0], [-k / case.ball, 0.0]])
    rates, shapes = np.linalg.eig(matrix)
    delta, v = (shapes @ np.diag(np.exp(rates * t)) @ np.linalg.solve(shapes, [0.0, 1.0])).real
    assert delta > 0  # in touch all the time
    assert travelling_waves(case, t)[1] == pytest.approx(v, rel=1e-12)  # rounding
    response = hit(replace(case, modes=400, residual=True), duration=t, sampling=2000 / t)
    found = (shapes @ np.diag(np.exp(rates * response.t[-1])) @ np.linalg.solve(shapes, [0.0, 1.0])).real[1]
    # what 400 modes with their residual flexibility leave
    assert response.bodies["ball"].velocity[-1] == pytest.approx(found, rel=1e-4)


@pytest.mark.parametrize(("wb", "wd"), [(0.8, 0.8), (2.0, 2.0)])
def test_modes_converge_to_the_waves_at_the_rate_expected(wb: float, wd: float) -> None:
    """Modes miss the static flexibility of those left out, 1/N; with it in series what is left falls with N^-2."""
    exact = wave_energy(RodCase(wb, wd))
    numbers = np.array([25, 50, 100, 200])
    errors = {
        residual: np.abs([energies(RodCase(wb, wd, int(n), residual))[0] - exact for n in numbers])
        for residual in (False, True)
    }
    slopes = {residual: np.polyfit(np.log(numbers), np.log(error), 1)[0] for residual, error in errors.items()}
    assert -1.35 < slopes[False] < -0.95
    assert -3.6 < slopes[True] < -1.85  # faster at first where the modes left out are well above the contacts
    assert 1e-3 < errors[False][1] < 2e-3  # 50 modes, as the source used
    assert errors[True][1] < 3e-5  # with residual vectors, 2.5e-5 here


def test_nothing_moves_before_the_wave_arrives() -> None:
    assert travelling_waves(RodCase(2.0, 2.0))[2] == 0.0
