"""Strange names, places and streams: one clear line and exit 2, before the work."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csc_array

from femstruct.cli import app
from femstruct.errors import InputError, InputErrors, NotConverged
from femstruct.exits import leave_with
from femstruct.files.writing import refuse_unwritable, replacing
from femstruct.impact import collocation as collocate
from femstruct.impact import simulate
from femstruct.language.cases import read_study
from femstruct.language.models import read_model_file
from femstruct.modal import eigen as krylov
from femstruct.modal import eigen as solve

MODELS = Path(__file__).parents[2] / "models"
OSCILLATOR, STUDY = str(MODELS / "oscillator.yaml"), str(MODELS / "three_bodies.study.yaml")
MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
COMMANDS = {
    "check": ["check", OSCILLATOR],
    "check --json": ["check", OSCILLATOR, "--json"],
    "modes": ["modes", OSCILLATOR],
    "frf": ["frf", OSCILLATOR, "--drive", "m.x", "--response", "m.x", "--band", "1:10"],
    "schema": ["schema", "model"],
    "help": ["--help"],
}


def left(words: list[str | bytes], **options: object) -> tuple[int, str]:
    """Exit code and stderr of a command."""
    done = subprocess.run([sys.executable, "-m", "femstruct", *words], stderr=subprocess.PIPE, timeout=120, **options)
    return done.returncode, done.stderr.decode()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
@pytest.mark.parametrize("command", COMMANDS)
def test_a_full_output_is_one_line(command: str) -> None:
    with Path("/dev/full").open("w") as full:
        code, told = left(COMMANDS[command], stdout=full)
    assert (code, told) == (2, "printing: got No space left on device, expected room for what is printed\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
def test_nobody_who_reads_errors_changes_the_code() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([sys.executable, "-m", "femstruct", "check", "nowhere.yaml"], stderr=full, timeout=60)
    assert done.returncode == 2


@pytest.mark.skipif(sys.platform == "win32", reason="descriptors that are closed")
def test_a_closed_output_is_no_bug() -> None:
    assert left(COMMANDS["check"], preexec_fn=lambda: os.close(1)) == (0, "")


@pytest.mark.skipif(sys.platform != "linux", reason="names of bytes")
@pytest.mark.parametrize(
    "words",
    [
        ["check", b"caf\xe9.yaml"],
        ["run", STUDY, "-o", b"\xe9"],
        ["run", STUDY, "-o", b"a\nb"],
        ["check", OSCILLATOR, "--picture", b"\xe9.png"],
        ["check", OSCILLATOR, "--set", b"title=\xe9"],
        ["identify", STUDY, "--measured", b"\xff.csv", "--channel", "x", "--fit", "a=1"],
    ],
)
def test_words_that_are_no_text_are_one_line(words: list[str | bytes], tmp_path: Path) -> None:
    code, told = left(words, cwd=tmp_path)
    assert code == 2
    assert told.startswith("the command line, ") and told.count("\n") == 1 and "UTF-8" in told
    assert list(tmp_path.iterdir()) == []


def test_a_folder_in_thousands_of_folders_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"got a path of 2\d\d\d folders, expected at most 100") as refused:
        refuse_unwritable(tmp_path.joinpath(*["d"] * 2000))
    assert len(str(refused.value)) < 1000
    assert list(tmp_path.iterdir()) == []


def test_what_is_in_the_way_of_a_file_stays(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    for name, told in (("folder", "a folder of that name"), ("pipe", "a pipe or a device of that name")):
        with pytest.raises(InputError, match=told), replacing(tmp_path / name):
            pass
    assert (tmp_path / "folder").is_dir() and (tmp_path / "pipe").is_fifo()


@pytest.mark.parametrize(
    ("cases", "told"),
    [
        ('{"": {}}', "the name ''"),
        ('{".": {}}', r"the name '\.'"),
        ('{" .. ": {}}', r"the name ' \.\. '"),
        ('{"a\\nb": {}}', "a name with a tab or a new line"),
        ('{"a\\ud800": {}}', r"no text \(U\+D800\)"),
        ("{_a: {}}", "a name that does not begin with _"),
        (f"{{{'x' * 81}: {{}}}}", "a name of 81 characters, expected at most 80"),
        ("{a/b: {}, a b: {}}", "'a b' and 'a/b', whose files would have one name"),
    ],
)
def test_names_of_cases_become_names_of_files(cases: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    (tmp_path / "a.study.yaml").write_text(f"model: model.yaml\ncases: {cases}\n", encoding="utf-8")
    with pytest.raises(InputErrors, match=told):
        read_study(tmp_path / "a.study.yaml")


def test_lists_and_names_in_messages_are_cut(tmp_path: Path) -> None:
    names = ", ".join(f"point_{n}: {{}}" for n in range(300))
    (tmp_path / "model.yaml").write_text(MODEL.replace("m: {}", names), encoding="utf-8")
    (tmp_path / "a.study.yaml").write_text("model: model.yaml\nrecord: {x.z: velocity}\n", encoding="utf-8")
    with pytest.raises(InputErrors) as refused:
        read_study(tmp_path / "a.study.yaml")
    assert "292 more" in str(refused.value) and len(str(refused.value)) < 700
    (tmp_path / "many.yaml").write_text(MODEL + "".join(f"k{n}: 1\n" for n in range(1000)), encoding="utf-8")
    with pytest.raises(InputErrors) as refused:
        read_model_file(tmp_path / "many.yaml")
    assert len(str(refused.value).splitlines()) == 41 and str(refused.value).endswith("and 960 more mistakes")
    (tmp_path / "long.yaml").write_text(MODEL + f"{'k' * 100_000}: 1\n", encoding="utf-8")
    with pytest.raises(InputErrors) as refused:
        read_model_file(tmp_path / "long.yaml")
    assert len(str(refused.value)) < 1500


PLATE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 2 mm, origin: [0, 0, 0.3], size: [0.4, 0.3], mesh: [4, 3]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
"""


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("7850", "0"), "got a structure without mass, expected some mass; give a density"),
        (("[0, 0, 0.3]", "[1e305, 0, 0.3]"), "got 1e+305, expected a length between 1e-30 and 1e+06 m"),
        (("E: 210 GPa", "E: 1e-40 GPa"), "correct its power of ten"),
    ],
)
def test_numbers_that_nothing_can_be_computed_with(
    change: tuple[str, str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "model.yaml").write_text(PLATE.replace(*change), encoding="utf-8")
    assert leave_with(lambda: app(["modes", str(tmp_path / "model.yaml"), "--count", "3"])) == 2
    err = capsys.readouterr().err
    assert told in err and err.count("\n") == 1


def test_errors_are_text_beside_json_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As the README says: stdout has JSON or nothing."""
    (tmp_path / "model.yaml").write_text(PLATE.replace("7850", "7850 kg"), encoding="utf-8")
    assert leave_with(lambda: app(["modes", str(tmp_path / "model.yaml"), "--json"])) == 2
    told = capsys.readouterr()
    assert told.out == "" and "expected a density" in told.err


def test_more_modes_than_anybody_waits_for_are_refused_with_their_number(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solve, "MOST_MODES", 3)
    (tmp_path / "model.yaml").write_text(PLATE.replace("[4, 3]", "[16, 12]"), encoding="utf-8")
    assert leave_with(lambda: app(["modes", str(tmp_path / "model.yaml"), "--up-to", "1 kHz"])) == 2
    assert "modes below 1000 Hz, expected at most 3; lower the frequency" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("asked", "got"), [(("--up-to", "1 kHz"), "modes below 1000 Hz of 768"), (("--count", "4"), "got 4 modes of 768")]
)
def test_more_shapes_than_memory_holds_are_refused(
    asked: tuple[str, str],
    got: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A rib with an end 750 m away has 2720 modes of 56,997 degrees of freedom: 3 GB and many minutes."""
    monkeypatch.setattr(solve, "MOST_COMPONENTS", 3 * 768)
    (tmp_path / "model.yaml").write_text(PLATE.replace("[4, 3]", "[16, 12]"), encoding="utf-8")
    assert leave_with(lambda: app(["modes", str(tmp_path / "model.yaml"), *asked])) == 2
    assert f"{got} degrees of freedom, expected at most 3 of so many; " in capsys.readouterr().err


def test_modes_that_do_not_converge_are_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stiffnesses of 1 and 1e16 left the search growing for minutes."""
    monkeypatch.setattr(krylov, "MOST_VECTORS", 20)
    M = csc_array(np.eye(500))
    space = krylov.Krylov(M, lambda b: b / np.linspace(1.0, 2.0, 500)[:, None])
    with pytest.raises(NotConverged, match=r"got 4 modes to .* of their eigenvalues with \d+ vectors, expected 1e-13"):
        krylov.converge(space, 4, 1e-13)


def test_a_window_of_no_samples_is_refused(tmp_path: Path) -> None:
    """It was simulated for minutes."""
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    body = "bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}"
    time = "time: {duration: 20 ms, sampling: 5e-11 kHz}"
    (tmp_path / "a.study.yaml").write_text(f"model: model.yaml\n{body}\n{time}\n", encoding="utf-8")
    with pytest.raises(InputErrors, match=r"time: got 1e-09 samples, expected at least 5"):
        read_study(tmp_path / "a.study.yaml")


def test_what_does_not_converge_is_told_with_its_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Modes at the beginning of the model, an impact at the body that it is about."""
    text = PLATE.replace("[4, 3]", "[16, 12]") + "points: {m: {on: plate, at: center}}\n"
    (tmp_path / "model.yaml").write_text(text, encoding="utf-8")
    body = "bodies:\n  ball: {mass: 10 g, above: m, speed: 1 m/s, contact: {type: hertz, stiffness: 1e9}}\n"
    study = "model: model.yaml\nmodes: {count: 4}\n" + body + "time: {duration: 20 ms, sampling: 50 kHz}\n"
    (tmp_path / "a.study.yaml").write_text(study, encoding="utf-8")
    with monkeypatch.context() as patched:
        for module in (simulate, collocate):
            patched.setattr(module, "MAX_STEPS", 20)
        assert leave_with(lambda: app(["impact", str(tmp_path / "a.study.yaml")])) == 3
    assert f"{tmp_path / 'a.study.yaml'}:4:3: not converged: impact: got 20 steps by t = " in capsys.readouterr().err

    def gives_up(*_: object) -> None:
        raise NotConverged("modes", got="4 modes", expected="5")

    monkeypatch.setattr(solve, "converge", gives_up)
    assert leave_with(lambda: app(["modes", str(tmp_path / "model.yaml")])) == 3
    assert f"{tmp_path / 'model.yaml'}:1:1: not converged: modes: got 4 modes, expec" in capsys.readouterr().err
