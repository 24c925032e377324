"""A study that is run again at every change: what it takes from the run before, and that its numbers are those of a new
run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.language.cases import read_study
from femstruct.study.results import CaseResult, StudyResult
from femstruct.study.study import Case
from femstruct.workflow.case import run_case
from femstruct.workflow.run import KeptStages, run_again, run_study
from femstruct.workflow.watch import Round, rounds

ROOT = Path(__file__).parents[2]
MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {p: {type: plate, material: steel, thickness: 5 mm, origin: [0, 0, 0], size: [0.6, 0.4], mesh: 50 mm}}
supports: {s: {on: p, edge: all, fix: simple}}
points: {a: {on: p, at: [0.2, 0.15]}, b: {on: p, at: [0.4, 0.2]}}
surfaces: {under: {on: p, side: below}}
damping: {ratio: 1 %}
"""
STUDY = """
model: plate.yaml
modes: {up_to: 1 kHz}
bodies: {ball: {mass: 5 g, above: a, speed: 1 m/s, contact: {type: linear, stiffness: 100 kN/m}}}
rooms: {box: {size: [0.6, 0.4, 0.3], under: under, losses: {t60: 0.3 s},
              receivers: {mic: [0.1, 0.1, 0.1]}}}
record: {b.z: velocity}
time: {duration: 20 ms, sampling: 20 kHz}
cases: {as given: {}, heavy: {bodies.ball.mass: 10 g}}
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "plate.yaml").write_text(MODEL, encoding="utf-8")
    path = tmp_path / "hit.study.yaml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def same(one: StudyResult, other: StudyResult) -> None:
    """All numbers to the last bit, but those of rooms: another choice of cosines leaves out another 1e-4 at most."""
    assert list(one.cases) == list(other.cases)
    for name, case in one.cases.items():
        twin = other.cases[name]
        assert [finding.code for finding in case.findings] == [finding.code for finding in twin.findings]
        assert np.array_equal(case.channels["b.z velocity"].values, twin.channels["b.z velocity"].values)
        for room, heard in case.rooms.items():
            p = twin.rooms[room].p
            assert np.abs(heard.p - p).max() < 1e-4 * np.abs(p).max()
        for receiver in case.levels:
            bands = [np.array([*each.levels[receiver].bands_db.values()]) for each in (case, twin)]
            assert np.allclose(*bands, rtol=0, atol=1e-3, equal_nan=True)  # dB: 1e-4 of the pressure is 9e-4 dB
    assert one.comparison.cases.keys() == other.comparison.cases.keys()


@pytest.mark.parametrize(
    ("change", "reused"),
    [
        ("cases.heavy.bodies.ball.mass=12 g", "the modes, case 'as given'"),
        ("bodies.ball.speed=2 m/s", "the modes"),
        ("rooms.box.receivers.mic=[0.2, 0.1, 0.1]", "the modes"),
        ("bodies.ball.above=b", "nothing"),  # residual vectors are for another place
        ("modes.up_to=1.2 kHz", "nothing"),
        ("parts.p.thickness=6 mm", "nothing"),
        ("damping.ratio=2 %", "the modes"),
    ],
)
def test_a_second_run_is_equal_to_a_new_one(study: Path, change: str, reused: str) -> None:
    _, kept = run_again(read_study(study), KeptStages())
    plan = read_study(study, (change,))
    again, later = run_again(plan, kept)
    assert later.reused == reused
    same(again, run_study(plan))


def test_a_case_hangs_on_the_damping_of_the_baseline(study: Path) -> None:
    """Modes of another thickness take the baseline's damping: a change there is a change of theirs."""
    text = STUDY.replace("heavy: {bodies.ball.mass: 10 g}", "thick: {parts.p.thickness: 6 mm}")
    study.write_text(text, encoding="utf-8")
    _, kept = run_again(read_study(study), KeptStages())
    study.write_text(text.replace("6 mm}", "6 mm, bodies.ball.mass: 6 g}"), encoding="utf-8")
    plan = read_study(study)
    again, later = run_again(plan, kept)
    assert later.reused == "the modes, case 'as given'"
    same(again, run_study(plan))
    damped = read_study(study, ("damping.ratio=3 %",))
    again, later = run_again(damped, kept)
    assert later.reused == "the modes"
    same(again, run_study(damped))


def test_a_case_hangs_on_the_structure_of_the_baseline(study: Path) -> None:
    """Modes of the given plate take the dampings of those modes of the baseline's that look like them."""
    cases = "cases: {thin: {parts.p.thickness: 4 mm}, given: {}}\ncompare: {baseline: thin}\n"
    study.write_text(STUDY.splitlines()[0] + STUDY.partition("cases:")[0] + cases, encoding="utf-8")
    _, kept = run_again(read_study(study), KeptStages())
    study.write_text(study.read_text(encoding="utf-8").replace("4 mm", "4.5 mm"), encoding="utf-8")
    assert run_again(read_study(study), kept)[1].reused == "the modes"


def watched(study: Path, folder: Path, *edits: Callable[[], object]) -> list[Round]:
    """The rounds of a watch during which files are edited, one edit a round."""
    left, found = list(edits), []
    looks = 0

    def wait() -> bool:
        nonlocal looks
        looks += 1
        if looks % 4 == 1:
            if not left:
                return False
            left.pop(0)()
        return True

    for one in rounds(study, (), "", folder, wait=wait):
        found.append(one)
        looks = 0
    return found


def test_it_runs_again_at_every_saved_change_and_survives_mistakes(study: Path, tmp_path: Path) -> None:
    def write(text: str) -> Callable[[], object]:
        return lambda: study.write_text(text, encoding="utf-8")

    found = watched(
        study,
        tmp_path / "out",
        write(STUDY.replace("10 g", "12 g")),
        write(STUDY.replace("10 g", "[")),
        lambda: study.unlink(),
        write(STUDY.replace("10 g", "14 g")),
        lambda: (tmp_path / "plate.yaml").write_text(MODEL.replace("5 mm", "5.5 mm"), encoding="utf-8"),
    )
    assert [one.reused for one in found] == [
        "nothing",
        "the modes, case 'as given'",
        "nothing",
        "the modes, case 'as given'",
        "nothing",
    ]
    assert isinstance(found[2].error, InputErrors) and found[2].result is None
    assert found[4].result is not None
    assert (tmp_path / "out" / "summary.json").exists()
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".json", ".wav", ".html"}


def test_ctrl_c_in_the_middle_of_a_round_ends_the_watch(
    study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The baseline is finished, the other case is not: half a round is neither written nor kept."""

    def until_heavy(case: Case, *arguments: Any, **options: Any) -> CaseResult:
        if case.name == "heavy":
            raise KeyboardInterrupt
        return run_case(case, *arguments, **options)

    monkeypatch.setattr("femstruct.workflow.run.run_case", until_heavy)
    with pytest.raises(KeyboardInterrupt):
        watched(study, tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(os.name != "posix", reason="Ctrl-C is sent as a signal")
def test_ctrl_c_writes_all_files_of_the_last_run(study: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = subprocess.Popen(
        [sys.executable, "-m", "femstruct", "run", "--watch", "--no-pictures", str(study), "-o", str(out)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    try:
        assert process.stderr is not None
        for line in process.stderr:
            if "waiting for a change" in line:
                break
        assert "reused: nothing" in line and not (out / "results.h5").exists()
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        assert process.returncode in (0, 3)
    finally:
        process.kill()
    assert (out / "results.h5").exists()
