"""Drawing in a process of its own: its answer, what it raises, and crashes for want of OpenGL."""

from __future__ import annotations

import os
import runpy
import signal
from pathlib import Path

import pytest

from femstruct.errors import FemstructError
from femstruct.study.results import StudyResult
from femstruct.view.model_scene import FORKS, LEFT_OUT, WAYS, NoOpenGL, draw_in_process
from femstruct.workflow.run import NO_PICTURES, write_all

BY_HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))
pytestmark = pytest.mark.skipif(not FORKS, reason="drawn in this process there")


def test_its_answer_comes_back() -> None:
    here = os.getpid()
    assert draw_in_process(lambda: (os.getpid() != here, "drawn"))() == (True, "drawn")


def test_what_it_raises_is_raised() -> None:
    def fails() -> None:
        raise FemstructError("picture", got="a wall", expected="a window")

    with pytest.raises(FemstructError, match="picture: got a wall"):
        draw_in_process(fails)()


def test_a_crash_is_answered_by_the_next_way(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("VTK_DEFAULT_OPENGL_WINDOW", raising=False)

    def crashes_with_the_first() -> str:
        if os.environ["FEMSTRUCT_OPENGL_WINDOW"] == WAYS[0]:
            os.kill(os.getpid(), signal.SIGKILL)
        return os.environ["FEMSTRUCT_OPENGL_WINDOW"]

    assert draw_in_process(crashes_with_the_first)() == WAYS[1]
    assert "FEMSTRUCT_OPENGL_WINDOW" not in os.environ


def test_after_the_last_way_it_says_what_to_install() -> None:
    with pytest.raises(NoOpenGL, match="libegl1"):
        draw_in_process(lambda: os.kill(os.getpid(), signal.SIGKILL))()
    assert "libegl1" in LEFT_OUT


def test_a_run_without_pictures_says_so(tmp_path: Path) -> None:
    result: StudyResult = BY_HAND["study_by_hand"]()
    _, told = write_all(result, tmp_path, pictures=False)
    assert told == NO_PICTURES and not list(tmp_path.glob("*.png"))
    assert (tmp_path / "report.html").exists() and (tmp_path / "results.h5").exists()
