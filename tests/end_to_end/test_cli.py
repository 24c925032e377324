"""The command line as a user meets it: exit codes, JSON, one-line errors, nothing written on bad input.

One of each kind in a process of its own (`started`), the others in this one.
"""

import json
import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.data.command_line import femstruct

ROOT = Path(__file__).parents[2]
MODELS = ROOT / "models"
PLATE, BODIES = str(MODELS / "small_plate.yaml"), str(MODELS / "three_bodies.study.yaml")


def started(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from femstruct.cli import main; main()", *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=_environment())


def _environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "error"}


def test_version() -> None:
    done = started("--version")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"femstruct {version('femstruct')}\n"


def test_modes_as_json() -> None:
    done = started("modes", PLATE, "--count", "6", "--json")
    assert done.returncode == 0, done.stderr
    table = json.loads(done.stdout)
    keys = {"frequency_hz", "damping_ratio", "kind", "rigid_body_modes", "complete_below_hz", "mass_kg", "findings"}
    assert keys <= set(table)
    D = 210e9 * 3e-3**3 / 12 / (1 - 0.3**2)
    first = 3.141592653589793 / 2 * (D / (7850 * 3e-3)) ** 0.5 * (1 / 0.5**2 + 1 / 0.4**2)
    assert table["frequency_hz"][0] == pytest.approx(first, rel=2e-4)  # bfs16 on 10 x 8 cells: 4th order
    assert table["damping_ratio"][0] == pytest.approx(0.01)  # loss factor 2 %


def test_modal_and_direct_frf_agree() -> None:
    words = ("frf", PLATE, "--drive", "off.z", "--response", "middle.z")
    options = ("--band", "20 Hz:200 Hz", "--step", "20 Hz", "--json")
    modal, direct = (json.loads(femstruct(*words, *options, "--method", m).stdout) for m in ("modal", "direct"))
    size = max(abs(complex(a, b)) for a, b in zip(direct["real"], direct["imag"], strict=True))
    for part in ("real", "imag"):
        # residual vectors leave 1e-3 of the largest output (two orders of the frequency)
        assert modal[part] == pytest.approx(direct[part], abs=1e-3 * size)


def test_impact_and_sound_as_json() -> None:
    done = started("impact", BODIES, "--json")
    assert done.returncode == 0, done.stderr
    (case,) = json.loads(done.stdout)["cases"].values()
    at = case["energy"]["at_separation"]
    assert at["damper"] / case["energy"]["input_j"] == pytest.approx(
        0.75469329, abs=5e-9
    )  # exact, by events: printed digits


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("run", "missing.study.yaml"), "missing.study.yaml"),
        (("modes", "."), "folder"),
        (("modes", PLATE, "--complex"), "--complex: got no --up-to"),
        (("modes", PLATE, "--count", "3", "--up-to", "100 Hz"), "one of them"),
        (("modes", PLATE, "--up-to", "100 rad/s"), "15.9"),
        (("run", BODIES, "--set", "bodies.ball.mas=1 kg"), "mass"),
        (("run", BODIES, "--set", "bodies.ball.mass=1 m"), "length"),
        (("frf", PLATE, "--drive", "of.z", "--response", "off.z", "--band", "1:2"), "off"),
        (("frf", PLATE, "--drive", "off.z", "--response", "off.z", "--band", "5"), "two freq"),
        (("dance",), "dance"),
    ],
)
def test_bad_input_is_told_in_a_line(words: tuple[str, ...], told: str, tmp_path: Path) -> None:
    done = femstruct(*words, cwd=tmp_path)
    assert done.returncode == 2, done.stderr
    assert told in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.iterdir())


def test_bad_input_ends_the_process_with_two() -> None:
    done = started("modes", ".")
    assert (done.returncode, done.stdout) == (2, "")
    assert "folder" in done.stderr and "Traceback" not in done.stderr


def test_a_point_off_its_part_is_told_with_its_line(tmp_path: Path) -> None:
    text = (MODELS / "small_plate.yaml").read_text().replace("at: [0.17, 0.11]", "at: [0.6, 0.11]")
    (tmp_path / "plate.yaml").write_text(text)
    done = femstruct("modes", "plate.yaml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("plate.yaml:8:"), done.stderr
    assert "off" in done.stderr
    assert "Traceback" not in done.stderr


def test_quiet_in_a_pipe() -> None:
    done = started("modes", str(MODELS / "portal.yaml"), "--json")
    assert done.stderr == ""
    json.loads(done.stdout)


def test_what_has_no_number_is_null(tmp_path: Path) -> None:
    done = femstruct("modes", str(MODELS / "oscillator.yaml"), "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["complete_below_hz"] is None  # all modes are there: no bound


@pytest.mark.parametrize("step", ["0", "1e-9"])
def test_frf_steps_that_cannot_be_are_refused(step: str) -> None:
    words = ("--drive", "off.z", "--response", "off.z", "--band", "1:100", "--step", step)
    done = femstruct("frf", PLATE, *words)
    assert done.returncode == 2
    assert done.stderr.startswith("--step: got")


def test_a_results_folder_that_cannot_be_is_refused_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = femstruct("run", str(MODELS / "three_bodies.study.yaml"), "-o", str(tmp_path / "file"))
    assert done.returncode == 2
    assert "folder to write to" in done.stderr
    assert "Traceback" not in done.stderr


def test_help_has_whole_sentences_and_runs_as_a_module() -> None:
    """On 80 columns, as in a pipe: no command's sentence ends in dots."""
    command = [sys.executable, "-m", "femstruct", "--help"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env={**_environment(), "COLUMNS": "80"})
    assert done.returncode == 0, done.stderr
    assert "check " in done.stdout and "..." not in done.stdout.partition("Commands:")[2]
