"""What the structure's own dashpots took of its losses: by Lyapunov's equation, and through a room's air."""

from __future__ import annotations

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from femstruct.impact.scene import Body, Clock, Contact, Scene
from femstruct.impact.shares import dashpot_losses, energy_shares, mode_energies
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.sound.coupling import with_cavity
from femstruct.sound.placed import placed

ROUNDING = 1e-13  # steps and rounding: 2e-16 here at most

COUPLING = runpy.run_path(str(Path(__file__).with_name("test_coupling.py")))
FREQUENCIES, RATIOS = [20.0, 33.0, 170.0], [0.02, 0.03, 0.01]
DASHPOTS = np.outer([3.0, -2.0, 4.0], [3.0, -2.0, 4.0]) + np.outer([0.0, 1.0, 2.0], [0.0, 1.0, 2.0])  # 1/s: two of them


def damped() -> ModalBasis:
    basis, _ = given_modes(FREQUENCIES, RATIOS, {"p": [0.5, 0.8, -0.6]})
    return replace(basis, viscous=basis.viscous + DASHPOTS, dashpots=DASHPOTS)


@pytest.mark.parametrize("sampling", [2e3, 2e4])
def test_free_decay_by_lyapunov(sampling: float) -> None:
    """Until all is lost a matrix takes x' P x of the start, with A' P + P A = -(its damping): no steps in time."""
    basis, start = damped(), np.array([1.0, -0.7, 2.0])
    a = np.block([[np.zeros((3, 3)), np.eye(3)], [-np.diag(basis.omega**2), -basis.viscous]])
    taken = np.block([[np.zeros((3, 3)), np.zeros((3, 3))], [np.zeros((3, 3)), DASHPOTS]])
    p = solve_continuous_lyapunov(a.T, -taken)
    expected = start @ p[3:, 3:] @ start
    response = simulate(basis, Scene(velocity=start), Clock(12.0, sampling))
    assert response.ledger.end.structure < ROUNDING * response.ledger.start.structure
    parted, found = dashpot_losses(response)
    assert parted is None
    # trapezoids over the samples: 170 Hz has 12 samples a period at 2 kHz
    assert found == pytest.approx(expected, rel=1e-3 if sampling < 1e4 else 1e-5)


def test_shares_after_an_impact() -> None:
    """By Hertz on coupled modes: of one proportional damping a fixed share, whatever happens; of none nothing."""
    basis, points = given_modes(FREQUENCIES, RATIOS, {"p": [0.5, 0.8, -0.6]})
    scene = Scene((Body("ball", 0.3, -1.0),), (Contact("c", "ball", points["p"].probe("z"), Hertz(1e7, 100.0)),))
    clock = Clock(0.3, 1e4)
    assert dashpot_losses(simulate(basis, scene, clock)) == (0.0, 0.0)
    response = simulate(replace(basis, dashpots=0.25 * basis.viscous), scene, clock)
    ledger, shares = response.ledger, mode_energies(response)
    assert ledger.at_separation is not None
    assert shares.dashpots_at_separation == pytest.approx(0.25 * ledger.at_separation.lost_modes, rel=ROUNDING)
    assert shares.dashpots_at_end == pytest.approx(0.25 * ledger.end.lost_modes, rel=ROUNDING)
    told = energy_shares(ledger.end, shares.end, shares.dashpots_at_end)
    assert sum(told.values()) == pytest.approx(1.0, rel=ROUNDING)
    assert told["lost in dashpots of the structure"] == pytest.approx(told["lost in modes"] / 3.0, rel=ROUNDING)


def test_dashpots_go_with_the_modes_into_a_room() -> None:
    """What two coupled bases with and without a dashpot differ by in damping is that dashpot."""
    piston, underside, box = (COUPLING[name] for name in ("piston", "underside", "box"))
    plain = piston(0.01)
    dashpot = np.array([[5.0]])
    held = replace(plain, viscous=plain.viscous + dashpot, dashpots=dashpot)
    leak = COUPLING["slit"](1e-3)
    joined, without = (with_cavity(one, placed(box(), underside()), leak=leak, up_to_hz=500.0) for one in (held, plain))
    assert np.abs(joined.dashpots).max() > 1.0
    assert joined.dashpots == pytest.approx(
        joined.viscous - without.viscous, abs=ROUNDING * np.abs(joined.viscous).max()
    )
    assert not without.dashpots.any()
