"""Stress along a frequency response: against beam theory and the full complex matrices."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.elements.stresses import von_mises_in_a_cycle
from femstruct.errors import InputError
from femstruct.language.models import read_model
from femstruct.view.structure_tables import show_frf
from femstruct.workflow.exchange import frfs_of
from femstruct.workflow.model_answers import frf_of

MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {flat: {shape: rectangle, width: 20 mm, height: 10 mm}}
parts:
  bar: {type: frame, material: steel, section: flat, lines: [[[0, 0, 0], [1, 0, 0]]], mesh: 100 mm}
points:
  foot: {on: bar, at: [0, 0, 0]}
  quarter: {on: bar, at: [0.21, 0, 0]}
  tip: {on: bar, at: [1, 0, 0]}
supports: {wall: {at: foot, fix: clamped}}
damping: {loss_factor: 4 %}
"""


def bar(folder: Path) -> Path:
    path = folder / "bar.yaml"
    path.write_text(MODEL, encoding="utf-8")
    return path


def test_far_below_its_first_mode_a_cantilever_is_stressed_as_at_rest(tmp_path: Path) -> None:
    """F L over b h^2 / 6 at the wall; at 0.21 m along the lever is shorter."""
    asked = {"band": "0 Hz:0.1 Hz", "step": "0.1 Hz", "kind": "", "method": "modal"}
    whole = frf_of(bar(tmp_path), "tip.z", "bar.stress", **asked)
    bent = 1.0 / (0.02 * 0.01**2 / 6)
    assert whole["real"][0] == pytest.approx(bent, rel=2e-3)  # |1 + 0.04 j|, and the shear beside the bending
    assert whole["unit"] == "Pa/N" and whole["place"].startswith("(0, ")
    part = frf_of(bar(tmp_path), "tip.z", "quarter.stress", **asked)
    assert part["real"][0] == pytest.approx(0.79 * bent, rel=2e-3)  # as above; a point of bars is looked at
    assert ", 0 m from quarter" in part["place"]


def test_components_are_those_of_the_full_matrices(tmp_path: Path) -> None:
    told = frf_of(bar(tmp_path), "tip.z", "quarter.stress", "2 Hz:120 Hz", "1 Hz", "", "modal")
    model = read_model(bar(tmp_path))
    assembly = fs.assemble(model)
    force = (model.points["tip"].probe("z").row(model.mesh.n_nodes) @ assembly.dofs.T).toarray()[0]
    K, M = assembly.K.toarray(), assembly.M.toarray()
    lines = np.array(told["frequency_hz"])
    u = np.array([np.linalg.solve(K * (1 + 0.04j) - (2 * np.pi * f) ** 2 * M, force) for f in lines]).T
    nodal = np.asarray(assembly.dofs.T @ u).reshape(model.mesh.n_nodes, 7, -1)
    places = model.parts["bar"].stresses(model.mesh.n_nodes)
    stress = places.of(nodal.real) + 1j * places.of(nodal.imag)
    there = np.isclose(places.places[:, 0], 0.21)
    equivalent = von_mises_in_a_cycle(stress[there], places.components).max(axis=0)
    within = 1e-3 * equivalent.max()  # stress of the modes up to 2.5 times the band, and residual vectors of the force
    np.testing.assert_allclose(told["real"], equivalent, atol=within)
    values = [np.array(one["real"]) + 1j * np.array(one["imag"]) for one in told["components"].values()]
    apart = np.abs(stress[there] - np.array(values)).max(axis=(1, 2))
    assert apart.min() < within


def test_the_stress_at_one_place_stands_beside_the_largest_anywhere(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A cantilever is stressed most at the wall near its resonances, elsewhere between them. Of a row the equivalent
    stress there is that of its components: sqrt(xx^2 + 3 xy^2), followed through a cycle."""
    told = frf_of(bar(tmp_path), "quarter.z", "bar.stress", "2 Hz:150 Hz", "0.5 Hz", "", "modal")
    anywhere, there = np.array(told["real"]), np.array(told["equivalent_there"])
    assert anywhere.argmax() == there.argmax()
    assert there.max() == pytest.approx(anywhere.max(), rel=1e-12)  # rounding
    assert (there <= anywhere * (1 + 1e-12)).all()
    assert (there < 0.9 * anywhere).any()
    xx, xy = (np.array(told["components"][name]["real"]) + 1j * np.array(told["components"][name]["imag"])
              for name in ("xx", "xy"))  # fmt: skip
    turns = np.exp(2j * np.pi * np.arange(3600) / 3600)[:, None]
    cycle = np.sqrt((xx * turns).real ** 2 + 3.0 * (xy * turns).real ** 2).max(axis=0)
    np.testing.assert_allclose(there, cycle, rtol=1e-6)  # of the steps along the cycle
    show_frf(told | {"response": "bar.stress", "drive": "quarter.z", "method": "modal", "findings": []})
    lines = capsys.readouterr().out.splitlines()
    assert lines[-len(there) - 1].split()[1:5] == ["frequency_hz", "largest_anywhere", "equivalent_there", "xx_real"]
    assert any(line.startswith("# there: all at (0, ") for line in lines)
    assert [float(x) for x in lines[-1].split()[1:3]] == pytest.approx([anywhere[-1], there[-1]], rel=1e-8)  # digits


def test_what_it_refuses(tmp_path: Path) -> None:
    asked = {"band": "2 Hz:20 Hz", "step": "", "kind": "", "method": "modal"}
    path = bar(tmp_path)
    with pytest.raises(InputError, match="got 'mobility' of a stress"):
        frf_of(path, "tip.z", "bar.stress", **(asked | {"kind": "mobility"}))
    with pytest.raises(InputError, match="got 'direct' of a stress"):
        frf_of(path, "tip.z", "bar.stress", **(asked | {"method": "direct"}))
    with pytest.raises(InputError, match="got 'top', expected one of"):
        frf_of(path, "tip.z", "top.stress", **asked)
    with pytest.raises(InputError, match=r"got 'bar.stress' with others"):
        frfs_of(path, ["tip.z"], ["tip.z", "bar.stress"], "2 Hz:20 Hz", "", "")
