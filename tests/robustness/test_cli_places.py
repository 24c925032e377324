"""Folders that cannot be made are refused before the work, and a reader that stops early is no bug."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from femstruct.errors import InputError
from femstruct.files.writing import refuse_unwritable


def test_a_folder_with_too_long_a_name_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"got a folder that cannot be made \(File name too long\)"):
        refuse_unwritable(tmp_path / ("x" * 300))
    with pytest.raises(InputError, match=r"cannot be made \(File name too long\)"):
        refuse_unwritable(tmp_path / "results" / ("x" * 300))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="a folder in which nobody may make one")
def test_a_folder_where_none_can_be_made_is_refused() -> None:
    with pytest.raises(InputError, match=r"/proc"):
        refuse_unwritable(Path("/proc/results/floor"))


def test_a_folder_that_can_be_made_is_not_left_behind(tmp_path: Path) -> None:
    refuse_unwritable(tmp_path / "results" / "floor")
    refuse_unwritable(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not hasattr(signal, "SIGPIPE"), reason="no such signal here")
def test_a_reader_that_stops_early_is_no_bug_of_ours() -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "femstruct", "schema", "study"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as schema:
        assert schema.stdout is not None and schema.stderr is not None
        schema.stdout.read(10)  # its 74 kB do not fit into the pipe
        schema.stdout.close()
        told = schema.stderr.read()
        schema.wait()
    assert (schema.returncode, told) == (-signal.SIGPIPE, b"")
