"""Damped modes of bases whose damping couples them, and what `modes` lists of a model with wool."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from femstruct.modal.closed_form import given_modes
from femstruct.modal.coupled_damping import damped_modes
from femstruct.study.asked import Extent
from femstruct.workflow.modes import modes_of

FREQUENCIES = [10.0, 14.0, 30.0, 31.0, 90.0]
MODEL = """
materials:
  heavy: {E: 30 GPa, nu: 0.2, rho: 2400, loss_factor: 2 %}
  board: {E: 2 GPa, nu: 0.3, rho: 860, loss_factor: 2 %}
parts:
  floor:   {type: plate, material: heavy, thickness: 60 mm, origin: [0, 0, 0.23], size: [2, 1.5], mesh: [6, 5]}
  ceiling: {type: plate, material: board, thickness: 25 mm, origin: [0, 0, 0], size: [2, 1.5], mesh: [6, 5]}
supports:
  walls: {on: floor, edge: all, fix: simple}
  rim:   {on: ceiling, edge: all, fix: simple}
surfaces: {underside: {on: floor, side: below}, top: {on: ceiling, side: above}}
damping: {from: materials}
cavities:
  void: {between: [underside, top], depth: 187.5 mm, fill: {flow_resistivity: 10 kPa*s/m^2, density: 40 kg/m^3}}
"""


def coupled(share: float):
    """Five modes over a damping matrix of which the share couples them."""
    basis, _ = given_modes(FREQUENCIES, [0.02] * 5, {"P": [1.0, 0.5, -0.4, 0.3, 0.2]})
    root = np.random.default_rng(3).standard_normal((5, 2)) * np.sqrt(share * basis.omega[:, None])
    momentum = np.random.default_rng(4).random((3, 5))
    return replace(basis, viscous=basis.viscous + root @ root.T, momentum=momentum, complete_below_hz=1e3)


@pytest.mark.parametrize("share", [1e-3, 0.1, 2.0])
def test_they_are_the_eigenvalues_of_the_state_matrix_that_swing(share: float) -> None:
    basis = coupled(share)
    k = len(basis.omega)
    state = np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(basis.omega**2), -basis.viscous]])
    values = np.linalg.eigvals(state)
    values = values[values.imag > 0.0]
    values = values[np.argsort(np.abs(values))]
    found = damped_modes(basis)
    assert found is not None
    assert found.frequency_hz == pytest.approx(np.abs(values) / (2 * np.pi), rel=1e-10)  # rounding: 1e-14 here
    assert found.damping_ratio == pytest.approx(-values.real / np.abs(values), rel=1e-9)  # rounding of real parts


def test_effective_masses_are_those_of_the_modes_where_little_couples_them() -> None:
    basis = coupled(1e-6)
    found = damped_modes(basis)
    assert found is not None
    assert found.modal_mass == pytest.approx(basis.modal_mass, rel=1e-4)  # the coupling: 1e-6 of each


def test_modes_over_wool_ring_with_some_per_cent(tmp_path: Path) -> None:
    """The diagonal of the damping matrix of the same model is above 100 % in every mode."""
    path = tmp_path / "wool.yaml"
    path.write_text(MODEL, encoding="utf-8")
    table = modes_of(path, Extent(up_to_hz=80.0))
    assert set(table["kind"]) == {"damped"}
    assert 0.01 < min(table["damping_ratio"]) < 0.2  # losses of the materials are 1 %
    assert max(table["damping_ratio"]) < 1.0
    assert table["frequency_hz"] == sorted(table["frequency_hz"])
    assert "implausible-damping" not in [finding["code"] for finding in table["findings"]]
