"""What `check` says of a file is what the file says."""

from __future__ import annotations

from pathlib import Path

import pytest

from femstruct.view.structure_tables import show_inspection
from femstruct.workflow.check import inspect_file

MODELS = Path(__file__).parents[2] / "models"


def test_a_study_tells_its_cases_bodies_and_window(capsys: pytest.CaptureFixture[str]) -> None:
    table = inspect_file(MODELS / "contact_laws.study.yaml").table()
    show_inspection(table)
    shown = capsys.readouterr().out
    assert table["bodies"] == {"ball": {"mass_kg": 0.1, "side": "above", "target": "ground", "speed_m_s": 2.0}}
    assert "8 cases: hunt-crossley, published" in shown and "ball: 0.1 kg, above ground, towards it at 2 m/s" in shown
    assert "no modes: bodies only" in shown and "damping" not in shown
    assert "cases" not in inspect_file(MODELS / "bodies_only.yaml").table()


def test_a_study_is_checked_with_its_own_modes() -> None:
    """So its findings are those of its run: modes up to 2.5 kHz, not the 30 that are solved for of a model."""
    study, model = (inspect_file(MODELS / name) for name in ("press_clamped.study.yaml", "press_clamped.yaml"))
    assert study.basis.complete_below_hz == pytest.approx(2500.0)
    assert model.basis.complete_below_hz > 4000.0
    assert any("the bending wavelength at 2500 Hz" in finding.message for finding in study.findings)
    (coarse, *_) = (one.message for one in model.findings if one.code in ("coarse-mesh", "thick-for-short-waves"))
    assert coarse.endswith(f". {model.basis.complete_below_hz:.4g} Hz is where the modes that are looked at end")


def test_a_room_of_a_kind_that_says_other_things_is_shown_by_their_names(capsys: pytest.CaptureFixture[str]) -> None:
    table = inspect_file(MODELS / "floor_tennis_ball.study.yaml").table()
    show_inspection(table)
    assert "room box: one-way coupling; first modes 293.1, 361.7, 465.6 Hz; damping " in capsys.readouterr().out
    show_inspection({**table, "rooms": {"box": {"size_m": [1, 2, 3], "reflections": "none"}}})
    assert "room box: size_m [1, 2, 3]; reflections none" in capsys.readouterr().out


def test_modes_beyond_those_of_interest_that_do_not_converge_take_nothing_from_a_check(tmp_path, monkeypatch):
    """A model file asks for no number of modes: 30 are a habit. Where none converge, that is the answer."""
    from femstruct.errors import NotConverged
    from femstruct.workflow import check as inspect

    path = tmp_path / "a.yaml"
    path.write_text("structure: {type: oscillator, mass: 1 kg, frequency: 5 Hz}\npoints: {m: {}}\n", encoding="utf-8")
    whole, solve, found = inspect.inspect_file(path), inspect.solve, 10

    def only_some(structure, extent, *others):
        if extent.count > found:
            raise NotConverged("modes", got="37 modes to 3e-13", expected="1e-13")
        return solve(structure, extent, *others)

    monkeypatch.setattr(inspect, "solve", only_some)
    fewer = inspect.inspect_file(path)
    (one,) = [one for one in fewer.findings if one.code == "fewer-modes-than-usual"]
    assert one.message.startswith("30 modes did not converge: 37 modes to 3e-13, expected 1e-13. The first 10 are")
    assert fewer.table()["first_frequencies_hz"] == whole.table()["first_frequencies_hz"]
    found = 0
    with pytest.raises(NotConverged, match="37 modes"):
        inspect.inspect_file(path)
