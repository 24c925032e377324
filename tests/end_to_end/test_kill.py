"""A run killed at any instant leaves complete files, the old ones or the new ones."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import pytest
from scipy.io import wavfile

from femstruct.files.writing import COMING, NAME

ROOT = Path(__file__).parents[2]
STUDY = ROOT / "models" / "three_bodies.study.yaml"
RUN = [sys.executable, "-c", "from femstruct.cli import main; main()", "run", str(STUDY), "-o"]
TITLES = ("Ball, mass and damper in a row, all contacts touching", "another title")


def title(folder: Path) -> str:
    """The title in the results file, which must be complete; every other file must be whole as well."""
    for path in folder.iterdir():
        if path.name.startswith("."):
            continue  # temporaries, swept by the next run
        if path.suffix == ".json":
            json.loads(path.read_text())
        elif path.suffix == ".wav":
            wavfile.read(path)
        elif path.suffix == ".png":
            assert path.read_bytes().endswith(b"IEND\xaeB`\x82"), path
        elif path.suffix == ".svg":
            assert path.read_text().rstrip().endswith("</svg>"), path
    with h5py.File(folder / "results.h5") as file:
        assert file.attrs["complete"]
        found, summary = str(file.attrs["title"]), file["summary"].asstr()[()]
    if COMING not in json.loads((folder / NAME).read_text()):  # a kill in that instant is told
        assert json.loads((folder / "summary.json").read_text()) == json.loads(summary)
        assert f"<h1>{found}</h1>" in (folder / "report.html").read_text()
    return found


# A kill costs a whole run; the write itself is killed more often, without one, in robustness/test_files_kill.py.
@pytest.mark.parametrize("kills", [3, pytest.param(30, marks=pytest.mark.stress)])
def test_killed_runs_leave_complete_files(tmp_path: Path, kills: int) -> None:
    folder = tmp_path / "results"
    begin = time.perf_counter()
    subprocess.run([*RUN, str(folder)], check=True, capture_output=True, cwd=ROOT)
    duration = time.perf_counter() - begin
    assert title(folder) == TITLES[0]
    choose = random.Random(4)
    seen = set()
    for _ in range(kills):
        process = subprocess.Popen(
            [*RUN, str(folder), "--set", f"title={TITLES[1]}"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=ROOT,
        )
        # most of the writing happens in the last half of a run
        time.sleep(duration * choose.uniform(0.3, 1.1))
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        seen.add(title(folder))
    assert seen <= set(TITLES)
    subprocess.run([*RUN, str(folder)], check=True, capture_output=True, cwd=ROOT)
    assert not [path for path in folder.iterdir() if path.name.startswith(".")], "temporaries of dead runs are swept"
