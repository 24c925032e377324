"""The plates by Ritz against closed forms and printed numbers."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from tests.independent.ritz import PX, Panel, U, W, iso, section


def _root(D: float, mass: float, a: float) -> float:
    return sqrt(D / mass) / a**2 / (2 * pi)


def test_thin_plates_by_their_printed_numbers() -> None:
    """Leissa (1973): SSSS in closed form, CCCC 35.99, free 13.49 (nu .3); a cantilever 3.471, 8.507 (Liew and others,
    1990, below the 3.492 of fewer terms)."""
    h = 0.01
    of = section([iso(2e11, 0.3, h, 7800)])
    unit = _root(of.D[0, 0], of.mass[0], 1.0)
    for edges, printed in (("simple", 2 * pi**2), ("clamped", 35.99)):
        panel = Panel(1.0, 1.0, thin=True, order=10).add(of)
        for name in ("x0", "x1", "y0", "y1"):
            panel.hold(name, edges)
        # rotary inertia of h / a = 0.01 takes 4e-4; digits of the table
        assert panel.modes(1)[0][0] / unit == pytest.approx(printed, rel=1e-3)
    bent = Panel(1.0, 1.0, thin=True, order=10).add(of).hold("x0", "clamped")
    assert bent.modes(2)[0] / unit == pytest.approx([3.471, 8.507], rel=1e-3)  # digits of the table, rotary inertia
    free = Panel(1.0, 1.0, thin=True, order=10).add(of)
    assert free.modes(1)[0][0] / unit == pytest.approx(13.49, rel=2e-3)  # digits of the table, rotary inertia


def test_a_thick_plate_by_navier() -> None:
    """Hard simple supports, in closed form: Mindlin's w^2 of the wave k^2 = 2 pi^2 / a^2."""
    E, nu, h, rho = 3e10, 0.2, 0.2, 2400.0
    of = section([iso(E, nu, h, rho)])
    panel = Panel(1.0, 1.0, order=9).add(of)
    for name in ("x0", "x1", "y0", "y1"):
        panel.hold(name, "hard")
    k2, S, D, (I0, _, I2) = 2 * pi**2, of.S[0, 0], of.D[0, 0], of.mass
    # (S k2 - I0 w2) (D k2 + S - I2 w2) = S^2 k2
    roots = np.roots([I0 * I2, -(I0 * (D * k2 + S) + I2 * S * k2), S * D * k2 * k2])
    assert panel.modes(1)[0][0] == pytest.approx(sqrt(min(roots.real)) / (2 * pi), rel=1e-6)  # Ritz of order 9


def test_a_bimetal_strip_and_a_block_on_springs() -> None:
    """Coupling: a plate on one edge, pulled at its reference plane, bends by B; rigid on springs it sinks and tilts."""
    of = section([iso(1e9, 0.0, 0.01), iso(4e9, 0.0, 0.01)])
    e1, e2 = 1e9 * 0.01, 4e9 * 0.01
    assert of.A[0, 0] == pytest.approx(e1 + e2) and of.B[0, 0] == pytest.approx((e2 - e1) * 0.005)
    assert section([iso(1e9, 0.0, 0.02)], offset=0.03).D[0, 0] == pytest.approx(1e9 * (0.02**3 / 12 + 0.02 * 0.03**2))
    stiff = Panel(1.0, 2.0, order=3).add(section([iso(1e14, 0.0, 0.2)]))
    stiff.K += stiff.spread(1e6, 4e5, -0.1)
    q = stiff.rest(-1e3 * stiff.at(0.5, 1.0))
    assert stiff.at(0.5, 1.0) @ q == pytest.approx(-1e3 / 2e6, rel=1e-6)  # rigid to E h^3 / k a^4 = 1e-5 of a per mille
    pushed = stiff.rest(10.0 * stiff.at(0.5, 1.0, U))
    tilt, arm = stiff.at(0.5, 1.0, PX) @ pushed, 0.1
    # by hand: the force on the middle has the arm to the sheared face; its moment tilts the springs' second moment
    assert tilt == pytest.approx(-arm * 10.0 * -1 / (1e6 * 2 / 12), rel=1e-5)
    assert stiff.at(0.5, 1.0, W) @ pushed == pytest.approx(0.0, abs=1e-12)  # rounding of a motion of 1e-5 m
