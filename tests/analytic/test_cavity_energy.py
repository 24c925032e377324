"""Pistons on a cavity with wool in time: another integrator, and where the energy goes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import femstruct as fs
from acoustics.air import Air
from acoustics.rooms.cavities import Cavity, Wool
from femstruct.impact.shares import mode_energies
from femstruct.sound.cavity_coupling import AIR, WOOL
from tests.analytic.test_cavities_coupled import LOWER, MASSES, UPPER, two_pistons
from tests.data.cavities_by_hand import matrices, pistons

CLOSES = 1e-6  # what is asked of the energies of structure, air and wool
PUSH = fs.HalfSine(-100.0, 50.0)
FILLS = {
    "held": (Wool(1e4, 40.0, "held"), None),
    "limp": (Wool(1e4, 40.0), None),
    "half": (Wool(1e4, 40.0), 0.1),
}


@pytest.mark.parametrize("fill", FILLS)
def test_pistons_on_wool_in_time(fill: str) -> None:
    wool, thickness = FILLS[fill]
    cavity = Cavity([1, 1, 0.2], Air(), wool, thickness)
    basis, placed, _ = two_pistons(cavity, (5.0, 8.0))
    coupled = fs.with_cavities(basis, [placed], up_to_hz=1000.0)
    load = fs.Load("push", UPPER, PUSH)
    response = fs.simulate(coupled, fs.Scene(loads=(load,)), fs.Clock(0.1, 2e3))
    # all coordinates of the air, none left out, by another integrator
    M, C, K = matrices(pistons(cavity, 1000.0), basis.omega**2)
    n, inverse = len(M), np.linalg.inv(M)
    row = np.zeros(n)
    row[0] = -(MASSES[0] ** -0.5)  # its coordinate counts downwards here: into the cavity

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        push = -100.0 * np.sin(2 * np.pi * 50.0 * t) if t < 0.01 else 0.0
        return np.concatenate([y[n:], inverse @ (row * push - C @ y[n:] - K @ y[:n])])

    jacobian = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ K, -inverse @ C]])
    t = response.t[response.t >= 0.01]
    begun = solve_ivp(rates, (0.0, 0.01), np.zeros(2 * n), "Radau", rtol=1e-8, atol=1e-12, jac=jacobian)
    run = solve_ivp(rates, (0.01, t[-1]), begun.y[:, -1], "Radau", t_eval=t, rtol=1e-8, atol=1e-12, jac=jacobian)
    for place, number, sign in ((UPPER, 0, -1.0), (LOWER, 1, 1.0)):
        found = response.velocity(place.of(coupled.shapes))[response.t >= 0.01]
        expected = sign * MASSES[number] ** -0.5 * run.y[n + number]
        # coordinates left out: ALLOWED; the other integrator 1e-5
        assert np.abs(found - expected).max() < 2e-3 * np.abs(expected).max()
    assert response.ledger.residual < CLOSES
    shares, end = mode_energies(response), response.ledger.end
    assert set(shares.held_at_end) == {"structure", AIR, WOOL}
    assert sum(shares.held_at_end.values()) == pytest.approx(end.structure, rel=CLOSES)
    assert all(energy >= 0.0 for energy in shares.held_at_end.values())
    assert end.lost_modes > 0.0
