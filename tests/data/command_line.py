"""The command line in this process: what a process of its own says, without the second it takes to start one.

What only a process shows (how it starts, ends, is killed, finds its streams) is tested with one: in `test_cli.py`,
`test_start.py`, `test_kill.py` and `test_cli_faults.py`.
"""

from __future__ import annotations

import contextlib
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from typer.main import get_command

import femstruct as package
from femstruct.cli import app
from femstruct.exits import leave_with

PROGRAM = get_command(app)


@dataclass(frozen=True)
class Ended:
    """What a command left with, and what it said; named as `subprocess.CompletedProcess` names it."""

    returncode: int
    stdout: str
    stderr: str


def femstruct(*words: str | Path, cwd: Path | None = None) -> Ended:
    """A command of the program, in a folder if one is given."""
    out, err = io.StringIO(), io.StringIO()
    there = contextlib.chdir(cwd) if cwd else contextlib.nullcontext()
    with there, contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = leave_with(lambda: PROGRAM([str(word) for word in words], prog_name="femstruct"))
    return Ended(code, out.getvalue(), err.getvalue())


def histories(study: Path) -> dict[str, np.ndarray] | str:
    """Histories of a study's first case by channel, "t", shock spectra as "NAME positive", frequency responses as
    "NAME frf"; or why it is refused.

    By the exported names of the package: the command line writes histories and responses to a file alone.
    """
    try:
        case = next(iter(package.run_study(package.read_study(study)).cases.values()))
    except package.FemstructError as told:
        return str(told)
    found = {name: np.array(one.values) for name, one in case.channels.items()}
    for name, one in case.evaluations.get("shock_spectra", {}).items():
        found |= {f"{name} {way}": np.array(getattr(one, way)) for way in ("frequency_hz", "positive", "negative")}
    found |= {f"{name} frf": np.array(one.values) for name, one in case.frf.items()}
    found |= {f"{name} frf_hz": np.array(one.frequency_hz) for name, one in case.frf.items()}
    return found | ({"t": np.array(case.response.t)} if case.response else {})
