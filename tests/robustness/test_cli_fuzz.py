"""Spoilt models and studies through the whole program: good, refused in words, or not to be trusted; never a bug."""

from __future__ import annotations

import json
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

SCRIPT = Path(__file__).with_name("mutations.py")
MUTATIONS: dict[str, Any] = runpy.run_path(str(SCRIPT))
SECONDS, MEGABYTES = 60, 2000  # of one case, the memory beside what the program and its kernels take
QUICK_MODELS, QUICK_STUDIES = 245, 55
SLOW = ("bedroom", "dwelling_floor", "tapping", "floor_frame_slab", "bang_machine", "floor_acrylic_ball",
    "floor_tennis_ball", "floor_two_way", "l_room", "lined_room", "forging_hammer", "press_hard", "slab_outdoors",
    "press", "long_floor", "portal", "joist_ceiling", "flanking_walls", "clt_floor")  # fmt: skip
FINE, OF_FINE = ("bracket", "bracket_shaker", "welded_press", "ribbed_slab"), 4  # a second each: one of four is run
WORKER = """
import faulthandler, json, pathlib, runpy, sys
mutations = runpy.run_path(sys.argv[1])
folder = pathlib.Path(sys.argv[2])
for number in map(int, sys.argv[4:]):
    path, name, done = mutations["spoilt"](folder, sys.argv[3], number)
    words = mutations["command_on"](path, name, sys.argv[3], number, folder / "out")
    print(json.dumps([number, words, f"{name}: {done}"]), flush=True)
    faulthandler.dump_traceback_later(60, exit=True)
    code, out, err = mutations["run_command"](words)
    faulthandler.cancel_dump_traceback_later()
    status = pathlib.Path("/proc/self/status")  # not ru_maxrss, which begins with that of the process before exec
    peak = int(status.read_text().split("VmHWM:")[1].split()[0]) / 1024 if status.exists() else 0.0
    print(json.dumps([code, err[-3000:], "Traceback" in out + err, peak]), flush=True)
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("spoilt")
    MUTATIONS["shipped"](made)
    return made


def fault(code: int, told: str) -> str:
    """What is wrong with how a command left; "" where nothing is."""
    if code not in (0, 2, 3):
        return f"exit {code}: {told[-1500:]}"
    if code == 2 and not told.strip():
        return "refused without a word"
    return "Traceback" if "Traceback" in told or "Warning" in told else ""


@pytest.mark.parametrize(("kind", "count"), [("model", QUICK_MODELS), ("study", QUICK_STUDIES)])
def test_spoilt_files_are_read_run_or_refused(kind: str, count: int, folder: Path) -> None:
    faults = []
    for seed in range(count):
        path, name, done = MUTATIONS["spoilt"](folder, kind, seed, SLOW)
        if name in FINE and seed % OF_FINE:
            continue
        words = MUTATIONS["command_on"](path, name, kind, seed, folder / "out", quick=True)
        code, _, told = MUTATIONS["run_command"](words)
        if wrong := fault(code, told):
            faults.append(f"{kind} {seed} {words[0]} {name}: {done}: {wrong}")
    assert not faults, "\n".join(faults)


@pytest.mark.stress
@pytest.mark.parametrize(("kind", "count"), [("model", 3000), ("study", 300)])
def test_many_spoilt_files(kind: str, count: int, tmp_path: Path) -> None:
    """A process a hundred of them; one that takes longer than SECONDS is ended by itself."""
    faults, size = [], 100 if kind == "model" else 10
    for start in range(0, count, size):
        own = tmp_path / str(start)
        MUTATIONS["shipped"](own)
        left = list(range(start, start + size))
        while left:
            command = [sys.executable, "-c", WORKER, str(SCRIPT), str(own), kind, *map(str, left)]
            done = subprocess.run(command, capture_output=True, text=True)
            lines = [json.loads(line) for line in done.stdout.splitlines()]
            asked, answers = lines[::2], lines[1::2]
            assert asked, done.stderr
            for (number, words, what), (code, told, traced, peak) in zip(asked, answers, strict=False):
                wrong = fault(code, told) or ("Traceback" if traced else "")
                wrong = wrong or (f"{peak:.0f} MB" if peak > MEGABYTES else "")
                if wrong:
                    faults.append(f"{kind} {number} {words[0]} {what}: {wrong}")
            if len(asked) > len(answers):
                number, words, what = asked[-1]
                faults.append(f"{kind} {number} {words[0]} {what}: ended or hung: {done.stderr[-1500:]}")
            left = left[len(asked) :]
    assert not faults, "\n".join(faults)
