"""`modes:` of a study also counts for structures in closed form, and too few modes are told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.language.cases import read_study
from femstruct.workflow.check import inspect_file
from femstruct.workflow.run import run_study

GIVEN = "structure: {type: modes, frequency: [6 Hz, 95 Hz], ratio: [4 %, 1 %], points: {bed: [0.02, 0.018]}}\n"
ROD = "structure: {type: rod, length: 2 m, E: 206 GPa, rho: 7850, area: 3.14e-4, modes: 4}\npoints: {end: {at: 0}}\n"
BEAM = (
    "structure: {type: beam, length: 0.4 m, ends: [pinned, free], EI: 5.9 N*m^2, mass_per_length: 0.3 kg/m, modes: 4}\n"
    "points: {end: {at: 0.4 m}}\n"
)
PLATE = (
    "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}\n"
    "parts:\n  sheet: {type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [0.5, 0.4], "
    "mesh: [4, 4]}\n"
    "points: {end: {on: sheet, at: center}}\nsupports: {edges: {on: sheet, edge: all, fix: simple}}\n"
)


def study(folder: Path, model: str, modes: str, more: str = "") -> Path:
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    place = "bed" if "bed:" in model else "end"
    axis = "after" if model == ROD else "above"
    (folder / "hit.study.yaml").write_text(
        f"model: model.yaml\nmodes: {modes}\n"
        f"bodies: {{ball: {{mass: 1 kg, {axis}: {place}, speed: 1 m/s}}}}\n"
        f"contacts: {{hit: {{between: [ball, {place}], law: {{type: linear, stiffness: 1 MN/m}}}}}}\n"
        f"time: {{duration: 10 ms, sampling: 10 kHz}}\n{more}",
        encoding="utf-8",
    )
    return folder / "hit.study.yaml"


# rod: c / 2 L = 1280.7 Hz apart from 0; pinned-free beam: 0, 68.0, 220.4 and 459.9 Hz (docstrings of the closed forms)
@pytest.mark.parametrize(
    ("model", "modes", "expected"),
    [
        (GIVEN, "{count: 1}", [6.0]),
        (GIVEN, "{up_to: 50 Hz}", [6.0]),
        (GIVEN, "{count: 9}", [6.0, 95.0]),
        (ROD, "{count: 2}", [0.0, 1280.7]),
        (ROD, "{up_to: 3 kHz}", [0.0, 1280.7, 2561.3]),
        (BEAM, "{up_to: 100 Hz}", [0.0, 68.0]),
    ],
)
def test_closed_forms_have_the_modes_that_are_asked_for(
    tmp_path: Path, model: str, modes: str, expected: list[float]
) -> None:
    basis = inspect_file(study(tmp_path, model, modes)).basis
    np.testing.assert_allclose(basis.frequency_hz[basis.modes], expected, atol=0.05)  # digits of the docstrings


def test_given_modes_without_one_left_are_refused_where_it_says_so(tmp_path: Path) -> None:
    with pytest.raises(InputErrors, match=r"study\.yaml:2:\d+: modes\.up_to: got 0\.4 Hz, expected the first mode"):
        read_study(study(tmp_path, GIVEN, "{up_to: 0.4}"))


def test_given_modes_ascend(tmp_path: Path) -> None:
    with pytest.raises(InputErrors, match=r"model\.yaml:1:\d+: structure\.frequency: got \[95, 6\] Hz"):
        inspect_file(study(tmp_path, GIVEN.replace("6 Hz, 95 Hz", "95 Hz, 6 Hz"), "{count: 1}"))


def test_a_band_below_the_first_mode_is_told_and_cases_are_compared(tmp_path: Path) -> None:
    more = "record: {end.z: velocity}\ncases: {thin: {}, thick: {parts.sheet.thickness: 4 mm}}\n"
    result = run_study(read_study(study(tmp_path, PLATE, "{up_to: 0.4}", more)))
    for case in result.cases.values():
        (found,) = (finding for finding in case.findings if finding.code == "no-modes")
        assert found.severe
        assert found.values["modes"] == 0


def test_check_tells_of_given_modes_what_is_given(tmp_path: Path) -> None:
    seen = inspect_file(study(tmp_path, GIVEN, "{count: 2}"))
    assert seen.damping == ("damping: the ratios given with the modes",)
    assert seen.positions == {"bed": None}
    model = tmp_path / "model.yaml"
    model.write_text(GIVEN.replace("bed: [0.02, 0.018]", "bed: {shape: [1, 1], at: 2 m}"), encoding="utf-8")
    assert inspect_file(model).positions == {"bed": (0.0, 0.0, 2.0)}
    model.write_text(GIVEN + "damping: {ratio: 2 %}\n", encoding="utf-8")
    (told,) = inspect_file(model).damping
    assert "added to the ratios given" in told


@pytest.mark.parametrize("model", [GIVEN, ROD])
def test_a_force_on_the_ground_that_nothing_carries_is_refused_by_check(tmp_path: Path, model: str) -> None:
    path = study(tmp_path, model, "{count: 2}", "record: {ground: force}\n")
    with pytest.raises(InputErrors, match=r"6:10: record\.ground: got no force of 'ground', expected .*ground"):
        inspect_file(path)
    held = path.read_text(encoding="utf-8") + "links: {stop: {between: [ball, ground], stiffness: 1 kN/m}}\n"
    path.write_text(held, encoding="utf-8")
    assert inspect_file(path).basis.total_mass >= 0.0
