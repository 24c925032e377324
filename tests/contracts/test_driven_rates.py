"""Spectra of modal rates after blows against the dense equations of motion, line by line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.sound import floor_blows as blow_motions
from femstruct.sound.floor_blows import coupled_oscillators, driven_rates

RNG = np.random.default_rng(7)
K, PLACES = 24, 5
LOW = np.array([0, 1, 2, 4, 7, 8, 11])
ROWS = 0.3 * RNG.standard_normal((PLACES, K))
HEAVY = 9.0 + 2j * np.pi * np.arange(40) / 0.8  # from zero on, as those of a heavy blow
STEADY = 2j * np.pi * np.arange(1, 40) / 0.8
FORCES = RNG.standard_normal((PLACES, 40)) + 1j * RNG.standard_normal((PLACES, 40))


def floor(wool: float) -> ModalBasis:
    """Modes from 15 to 900 Hz, a third of whose motion goes through wool [1/s], which stops some before they swing."""
    hz = np.sort(RNG.uniform(15.0, 900.0, K))
    turn, _ = np.linalg.qr(np.eye(K) + 0.2 * RNG.standard_normal((K, K)))
    lost = (turn * np.where(np.arange(K) % 3 == 0, wool, 0.0)) @ turn.T
    basis, _ = given_modes(list(hz), [0.0] * K, {"p": [1.0] * K})
    return replace(basis, viscous=0.5 * (lost + lost.T) + np.diag(0.03 * 2 * np.pi * hz))


def test_modes_that_wool_couples_move_as_the_dense_equations(monkeypatch) -> None:
    basis = floor(8300.0)
    found = coupled_oscillators(basis, LOW)
    assert found is not None
    monkeypatch.setattr(blow_motions, "_CHUNK", 16 * K * PLACES)  # eight lines at a time
    for s in (HEAVY, STEADY):
        forces = FORCES[:, : len(s)]
        rates = driven_rates(basis, LOW, found, ROWS, forces, s)
        for line, one in enumerate(s):
            whole = one**2 * np.eye(K) + one * basis.time_damping + np.diag(basis.omega**2)
            wanted = one * np.linalg.solve(whole, (ROWS * forces[:, line, None]).T)[LOW].T
            assert np.abs(rates[:, :, line] - wanted).max() < 1e-9 * np.abs(wanted).max()  # what oscillators may miss


def test_modes_that_nothing_couples_move_by_themselves() -> None:
    """Each mode is the quotient of one oscillator, exactly."""
    basis = floor(0.0)
    assert coupled_oscillators(basis, LOW) is None
    rates = driven_rates(basis, LOW, None, ROWS, FORCES, HEAVY)
    own, squared = np.diag(basis.time_damping)[LOW], basis.omega[LOW] ** 2
    wanted = HEAVY * FORCES[:, None, :] * ROWS[:, LOW, None] / (HEAVY**2 + own[:, None] * HEAVY + squared[:, None])
    assert (rates == wanted).all()


def test_rounding_couples_nothing() -> None:
    basis = floor(0.0)
    noisy = replace(basis, viscous=basis.viscous + 1e-12)
    assert coupled_oscillators(noisy, LOW) is None
