"""Harmonic motion of modes that damping couples, many lines of one factorisation, against a dense solution a line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from femstruct.errors import NotConverged
from femstruct.modal import coupled_damping as along_frequency
from femstruct.modal.closed_form import given_modes
from femstruct.modal.coupled_damping import CoupledModes
from femstruct.modal.frf import frf

MISSED = 1.1e-12  # of the force: lines are accepted at 1e-12, and a dense solution misses 1e-14


def modes_with_two_materials(count: int, dashpots: int, seed: int) -> tuple[CoupledModes, np.ndarray]:
    """Modes to 400 Hz, some far above, half of their energy in a material with six times the losses; their dashpots."""
    rng = np.random.default_rng(seed)
    hz = np.concatenate([rng.uniform(5.0, 400.0, count - count // 10), rng.uniform(800.0, 5000.0, count // 10)])
    omega = 2.0 * np.pi * np.sort(hz)
    turn, _ = np.linalg.qr(rng.standard_normal((count, count)))
    share = turn[:, : count // 2] @ turn[:, : count // 2].T
    hysteretic = 0.002 * np.diag(omega**2) + 0.01 * omega[:, None] * share * omega
    places = rng.standard_normal((count, dashpots))
    return CoupledModes(omega**2, 0.3 * places @ places.T, hysteretic), rng.standard_normal(count)


def matrices(modes: CoupledModes, omega: np.ndarray) -> np.ndarray:
    """[lines, k, k]."""
    whole = 1j * (omega[:, None, None] * modes.viscous + modes.hysteretic)
    return whole + np.diag(modes.squared) - omega[:, None, None] ** 2 * np.eye(len(modes.squared))


def along(modes: CoupledModes, forces: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """[lines, k]; every line comes exactly once."""
    found = np.full((len(omega), len(forces)), np.nan, dtype=complex)
    for lines, q in modes.along(forces, omega):
        assert np.isnan(found[lines]).all()
        found[lines] = q
    assert not np.isnan(found).any()
    return found


def same(modes: CoupledModes, forces: np.ndarray, omega: np.ndarray) -> None:
    """Every line is that of LU with pivoting, as far as what it misses of the force goes through its own matrix."""
    found, whole = along(modes, forces, omega), matrices(modes, omega)
    expected = np.linalg.solve(whole, np.broadcast_to(forces[:, None], (*whole.shape[:2], 1)))[:, :, 0]
    softest = 1.0 / np.linalg.svd(whole, compute_uv=False).min(axis=1, initial=np.inf)
    off = np.linalg.norm(found - expected, axis=1)
    assert (off <= MISSED * np.linalg.norm(forces) * softest).all()
    assert (off <= 1e-10 * np.linalg.norm(expected, axis=1)).all()  # a wrong line is off by 1; measured 2e-11


@pytest.mark.parametrize("dashpots", [0, 3])
@pytest.mark.parametrize("seed", range(3))
def test_every_line_is_that_of_a_dense_solution(dashpots: int, seed: int):
    modes, forces = modes_with_two_materials(60, dashpots, seed)
    omega = 2.0 * np.pi * np.linspace(1.0, 450.0, 400)
    same(modes, forces, omega)


def test_lines_in_any_order_and_twice():
    modes, forces = modes_with_two_materials(30, 2, 7)
    omega = 2.0 * np.pi * np.array([200.0, 10.0, 10.0, 399.0, 200.0, 11.0, 10.0])
    same(modes, forces, omega)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_few_lines(count: int):
    modes, forces = modes_with_two_materials(10, 1, 1)
    omega = 2.0 * np.pi * np.array([20.0, 30.0])[:count]
    assert along(modes, forces, omega).shape == (count, 10)
    same(modes, forces, omega)


def test_modes_without_stiffness_and_forces_on_one_mode():
    """A frame of wool that nothing holds but its dashpots, pushed through the air alone."""
    modes, _ = modes_with_two_materials(40, 40, 3)
    squared, still = modes.squared.copy(), slice(0, 15)
    squared[still] = 0.0
    hysteretic = modes.hysteretic.copy()
    hysteretic[still], hysteretic[:, still] = 0.0, 0.0
    floating, forces = CoupledModes(squared, modes.viscous, hysteretic), np.eye(40)[20]
    omega = 2.0 * np.pi * np.linspace(0.5, 300.0, 300)
    same(floating, forces, omega)


def test_no_force_is_no_motion():
    modes, forces = modes_with_two_materials(10, 1, 1)
    assert not along(modes, 0.0 * forces, np.array([1.0, 2.0])).any()


def test_nothing_is_accepted_that_misses_its_equation(monkeypatch):
    """With one vector a factorisation, nearly every line must be solved by itself, and is."""
    monkeypatch.setattr(along_frequency, "MOST", 1)
    modes, forces = modes_with_two_materials(25, 2, 5)
    omega = 2.0 * np.pi * np.linspace(1.0, 450.0, 60)
    same(modes, forces, omega)


def test_a_factorisation_serves_many_lines(monkeypatch):
    """120 modes: fewer than one for fifty of 4,000 lines."""
    count = []
    made = CoupledModes._matrix
    monkeypatch.setattr(CoupledModes, "_matrix", lambda self, omega: (count.append(omega), made(self, omega))[1])
    modes, forces = modes_with_two_materials(120, 4, 2)
    along(modes, forces, 2.0 * np.pi * np.linspace(1.0, 400.0, 4000))
    assert len(count) < 4000 / 50


def test_a_line_at_which_something_without_damping_resonates_is_named():
    free = CoupledModes(np.array([1.0, 4.0, 9.0]), np.diag([0.1, 0.1, 0.0]), np.zeros((3, 3)))
    with pytest.raises(NotConverged, match=r"singular matrix at 0\.4775 Hz.*add damping"):
        along(free, np.ones(3), np.array([1.0, 3.0]))


@pytest.mark.parametrize("coupling", [0.0, 0.5])
def test_who_waits_is_given_the_number_of_lines_that_are_done_up_to_all(coupling: float):
    basis, points = given_modes([20.0, 50.0], [0.02, 0.03], {"P": [0.5, -0.4]})
    here, heard = points["P"].probe("z"), list[int]()
    frf(replace(basis, viscous=basis.viscous + coupling), here, here, np.linspace(1.0, 80.0, 300), tell=heard.append)
    assert heard == sorted(set(heard)) and heard[-1] == 300 and min(heard) > 1
