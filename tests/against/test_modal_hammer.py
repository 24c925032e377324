"""A machine on springs with dashpots: modal answers against the matrices, forces k x + c v, loads that pass on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from femstruct.assembly.matrices import assemble
from femstruct.language.cases import read_study
from femstruct.language.models import read_model, read_model_file
from femstruct.modal.damping import Damping, FromMaterials, Ratio, with_damping
from femstruct.modal.frf import direct_frf, frf
from femstruct.modal.reduction import modal_basis
from femstruct.workflow.run import run_study

ROUNDING = 1e-12  # rounding: 3e-15 here at most

MODELS = Path(__file__).parents[2] / "models"
HAMMER = MODELS / "forging_hammer.yaml"
LINES = np.concatenate([np.linspace(0.5, 12.0, 24), np.linspace(15.0, 120.0, 22)])


@pytest.fixture(scope="module")
def hammer():
    model = read_model(HAMMER)
    return model, assemble(model)


def test_dashpots_couple_the_modes_and_all_answers_agree_with_the_matrices(hammer):
    """Twelve modes are all there are, so only rounding is left between the modal sum and the direct solution."""
    model, assembly = hammer
    basis = modal_basis(assembly, count=12)
    off = basis.viscous - np.diag(np.diag(basis.viscous))
    # Side on and rocking are pressed at 22 % of critical, by dashpots that are not shared out as the springs are.
    assert np.abs(off).max() > 0.02 * np.abs(basis.viscous).max()
    drive, listen = model.points["side"].probe("z"), model.points["corner"].probe("x")
    for damping, forces in ((Damping(FromMaterials()), ("isolators", "pad")), (Damping(Ratio(0.0)), ("ground", "pad"))):
        damped = with_damping(basis, damping)
        for response in (listen, drive):
            exact = direct_frf(assembly, drive, response, LINES, damping)
            # rounding: 2e-13 here
            assert np.abs(frf(damped, drive, response, LINES) - exact).max() < 1e-11 * np.abs(exact).max()
        for name in (f"{part}.{axis}" for part in forces for axis in "xz"):
            exact = direct_frf(assembly, drive, name, LINES, damping, "transmissibility")
            found = frf(damped, drive, damped.outputs[name], LINES, "transmissibility")
            assert np.abs(found - exact).max() < 1e-10 * np.abs(exact).max(), name  # rounding: 2e-13 here


def test_the_force_of_the_isolators_is_k_x_and_c_v(hammer):
    """At every line, from the motion of the four feet themselves."""
    model, assembly = hammer
    basis = with_damping(modal_basis(assembly, count=12), Damping(FromMaterials()))
    drive = model.points["side"].probe("z")
    for axis, k, c in (("x", 7.7e6, 92e3), ("y", 7.7e6, 92e3), ("z", 11e6, 132e3)):
        feet = sum(frf(basis, drive, model.points[f"feet.{i}"].probe(axis), LINES) for i in (1, 2, 3, 4))
        by_hand = (k + 2j * np.pi * LINES * c) * feet
        found = frf(basis, drive, basis.outputs[f"isolators.{axis}"], LINES, "transmissibility")
        assert np.abs(found - by_hand).max() <= ROUNDING * max(np.abs(by_hand).max(), 1.0)
        assert found == pytest.approx(frf(basis, drive, basis.outputs[f"ground.{axis}"], LINES, "transmissibility"))


def test_in_time_too(tmp_path):
    """A blow on the die, pushed to the side: what is recorded of the isolators is their law of the recorded feet."""
    (tmp_path / "forging_hammer.yaml").write_text(HAMMER.read_text())
    (tmp_path / "blow.study.yaml").write_text(
        """
model: forging_hammer.yaml
modes: {count: 12}
loads: {blow: {at: side.z, half_sine: {amplitude: -5 MN, frequency: 100 Hz}}}
record:
  feet.1.z: [displacement, velocity]
  feet.2.z: [displacement, velocity]
  feet.3.z: [displacement, velocity]
  feet.4.z: [displacement, velocity]
  isolators: force
  ground: force
time: {duration: 0.4 s, sampling: 4 kHz}
"""
    )
    case = next(iter(run_study(read_study(tmp_path / "blow.study.yaml")).cases.values()))
    values = {name: channel.values for name, channel in case.channels.items()}
    by_hand = sum(
        11e6 * values[f"feet.{i}.z displacement"] + 132e3 * values[f"feet.{i}.z velocity"] for i in (1, 2, 3, 4)
    )
    peak = np.abs(by_hand).max()
    assert np.abs(132e3 * values["feet.1.z velocity"]).max() > 0.05 * peak  # the dashpots matter
    assert np.abs(values["isolators force"] - by_hand).max() < ROUNDING * peak
    assert np.abs(values["ground force"] - by_hand).max() < ROUNDING * peak
    assert case.response is not None
    assert case.response.ledger.residual < ROUNDING


def test_a_load_beside_a_support_is_in_the_reaction(tmp_path):
    """Pushed slowly in a cell at its edge, a plate passes on what it is pushed with; a good part of it goes to the held
    nodes themselves, which do not move."""
    (tmp_path / "small_plate.yaml").write_text(
        (MODELS / "small_plate.yaml").read_text().replace("[0.17, 0.11]", "[0.005, 0.11]")
    )
    (tmp_path / "push.study.yaml").write_text(
        """
model: small_plate.yaml
modes: {up_to: 3 kHz}
loads: {push: {at: off.z, half_sine: {amplitude: -100 N, frequency: 0.5 Hz}}}
frf: {passed: {drive: off.z, response: ground.force, kind: transmissibility, band: [0.5 Hz, 1.5 Hz], step: 0.5 Hz}}
record: {ground: force, edges: force}
time: {duration: 1 s, sampling: 1 kHz}
"""
    )
    study = read_study(tmp_path / "push.study.yaml")
    case = next(iter(run_study(study).cases.values()))
    assert case.response is not None
    pushed = -100.0 * np.sin(np.pi * case.response.t)
    basis = case.response.basis
    through = basis.outputs["ground.z"].direct.meets(case.response.scene.loads[0].on)
    assert through > 0.05  # what was missing without it
    # The plate rings at 75.6 Hz after the kink at the start, by 0.5 / 75.6 of the load; damped with 1 % it has died
    # away after 0.5 s. The rest is inertia, (0.5 / 75.6)^2.
    for name in ("ground force", "edges force"):
        late = slice(500, 1000)
        assert np.abs(case.channels[name].values[late] - pushed[late]).max() < 2e-4 * 100.0  # inertia: 2.5e-5 here
    structure = read_model_file(tmp_path / "small_plate.yaml").structure
    assert structure == study.cases[0].study.structure
    assert case.frf["passed"].values == pytest.approx(1.0, rel=2e-3)  # 1 / (1 - (1.5 / 75.6)^2), and its losses
