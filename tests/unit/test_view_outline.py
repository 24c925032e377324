"""The picture of the model on every page: in three dimensions, or in lines where a machine has no OpenGL."""

from __future__ import annotations

import os
import runpy
import signal
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import femstruct.view.model_scene as scene
from femstruct.view.model_scene import CHARACTER, VIEW, Label, outline, separate_labels
from femstruct.workflow.run import write_all

BY_HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))


def test_lines_are_the_edges_of_plates_and_bars_in_isometric_view() -> None:
    model = BY_HAND["model_by_hand"]()
    rooms = BY_HAND["study_by_hand"]().cases["without damper"].case.study.rooms
    floor, post, box = outline(model, rooms).axes[0].collections
    assert [one.get_label() for one in (floor, post, box)] == ["floor", "post", "box"]
    lengths = {len(one.get_segments()) for one in (floor,)}
    assert lengths == {32} and len(post.get_segments()) == 2 and len(box.get_segments()) == 12
    plate = np.concatenate(floor.get_segments())
    corners = np.array([[0.0, 0.0, 0.0], [0.4, 0.32, 0.0]]) @ VIEW.T
    assert plate[:, 1].max() == pytest.approx(corners[0, 1]) and plate[:, 1].min() == pytest.approx(corners[1, 1])
    assert np.concatenate(post.get_segments())[:, 1].min() == pytest.approx(-0.2 * np.sqrt(2.0 / 3.0))


def test_names_cover_no_other() -> None:
    """A letter is as wide and high as the drawing's are: 10 names at one place and beside it are all readable."""
    places = [np.array([0.01 * (number % 3), 0.0, 0.02 * (number % 2)]) for number in range(10)]
    low, high = np.zeros(3), np.ones(3)
    labels = separate_labels(
        [Label(f"receiver {number}", place, "red") for number, place in enumerate(places)], low, high
    )
    wide = np.sqrt(2.0)  # of the unit cube, seen isometrically; it is 2 sqrt(2 / 3) high
    letter = np.array(CHARACTER) * max(wide, 2.0 * np.sqrt(2.0 / 3.0))
    at = np.array([VIEW @ label.place for label in labels])
    for one in range(10):
        for other in range(one):
            beside = abs(at[one, 0] - at[other, 0]) >= letter[0] * len("receiver 0")
            assert beside or abs(at[one, 1] - at[other, 1]) >= letter[1] * (1.0 - 1e-9)  # rounding
    assert at[:, 0] == pytest.approx([(VIEW @ place)[0] for place in places], abs=1e-12)  # none is moved aside


def test_the_page_has_its_model_without_opengl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scene, "require_opengl", lambda: os.kill(os.getpid(), signal.SIGKILL))
    _, told = write_all(BY_HAND["study_by_hand"](), tmp_path)
    assert "libegl1" in told and not (tmp_path / "mode_shapes.png").exists()
    with Image.open(tmp_path / "model.png") as image:
        assert image.size == (800, 560)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert page.index('alt="Model"') < page.index("<h2>Results")
