"""Pictures in three dimensions, each in a process of its own; and what is told where there is no OpenGL."""

import runpy
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import matplotlib.colors
import matplotlib.image
import numpy as np
import pytest

from femstruct.errors import InputError
from femstruct.language.models import read_model
from femstruct.view import model_scene as opengl
from femstruct.view import model_scene as scene
from femstruct.view.model_scene import (
    LEFT_OUT,
    MASS,
    PART_COLOURS,
    POINT,
    SUPPORT,
    VIEW,
    Label,
    NoOpenGL,
    _resting,
    merge_labels,
    picture_model,
    runs,
    separate_labels,
    shapes_all,
)

DATA = Path(__file__).parents[1] / "data" / "study_by_hand.py"
BY_HAND = runpy.run_path(str(DATA))
DRAW = """
import runpy, sys
from pathlib import Path
from acoustics import Receiver, Room
from femstruct import assemble, modal_basis, read_model
from femstruct.view.model_scene import picture_model, picture_modes, shapes_all
made = runpy.run_path(sys.argv[1])
result = made["study_by_hand"]()
folder = Path(sys.argv[2])
paths, told = shapes_all(result, folder)
assert not told and [path.name for path in paths] == ["mode_shapes.png"], (paths, told)
picture_model(result.models["abc123"], result.cases["without damper"].case.study.rooms, folder / "model.png")
portal = read_model(sys.argv[3])
picture_modes(portal, modal_basis(assemble(portal), up_to=20.0), folder / "portal.png")
"""
MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture
def no_opengl(monkeypatch):
    monkeypatch.setattr(opengl, "_PROBE", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    opengl._working_window.cache_clear()
    yield
    opengl._working_window.cache_clear()


def test_without_opengl_shapes_are_left_out_with_a_sentence(no_opengl, tmp_path):
    paths, told = shapes_all(BY_HAND["study_by_hand"](), tmp_path)
    assert paths == [] and told == LEFT_OUT
    assert list(tmp_path.iterdir()) == []


def test_without_opengl_the_picture_of_a_model_is_refused(no_opengl, tmp_path):
    with pytest.raises(NoOpenGL, match="libegl1"):
        picture_model(BY_HAND["model_by_hand"](), (), tmp_path / "model.png")


def test_a_structure_in_closed_form_has_no_picture(tmp_path):
    with pytest.raises(InputError, match="closed form"):
        picture_model(None, (), tmp_path / "model.png")


def test_a_name_that_is_no_picture_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"ends in \.png"):
        picture_model(BY_HAND["model_by_hand"](), (), tmp_path / "model.pnf")


def test_a_picture_makes_no_folder(tmp_path):
    with pytest.raises(InputError, match="no folder"):
        picture_model(BY_HAND["model_by_hand"](), (), tmp_path / "new" / "model.png")
    assert list(tmp_path.iterdir()) == []


def test_names_of_one_place_are_one_label():
    at, near, far = np.array([0.1, 0.2, 0.0]), np.array([0.1, 0.2, 1e-9]), np.array([0.3, 0.2, 0.0])
    given = [Label("foot", at, POINT), Label("tip", far, POINT), Label("clamp", near, SUPPORT), Label("foot", at, MASS)]
    made = merge_labels(given, near=1e-6)
    assert [(label.name, label.colour) for label in made] == [("foot, clamp", SUPPORT), ("tip", POINT)]


def test_names_give_way_up_and_down_and_lists_have_one():
    """Names at one place stood in a tower as high as there are names."""
    low, high, at = np.zeros(3), np.full(3, 2.0), np.ones(3)
    names = [Label(name, at, POINT) for name in ("pump", "motor", "seat", "tip", "anvil")]
    moved = np.array([VIEW[1] @ (label.place - at) for label in separate_labels(names, low, high)])
    assert moved[0] == 0.0 and (moved > 0).sum() == (moved < 0).sum() == 2
    assert np.diff(np.sort(moved)).min() > 0.0 and np.abs(moved).max() < 3.0 * np.diff(np.sort(moved)).min()
    feet = [Label(f"feet.{i}", at + 0.02 * (i - 1) * np.array([1.0, -1.0, 0.0]), POINT) for i in range(1, 6)]
    away = at + np.array([-1.0, 1.0, 0.0])
    far, other = Label("feet.6", away, POINT), Label("feet.7", away, SUPPORT)
    assert [label.name for label in runs([*feet, far, other], low, high)] == ["feet.1 to 5", "feet.6", "feet.7"]


def test_a_part_that_hardly_moves_does_not_hide_those_that_do():
    """A deck over a ceiling: in modes of the ceiling it is drawn faintly, in a mode of both it is not."""
    fine = SimpleNamespace(parts=("deck", "ceiling", "none"), part_of_point=np.array([0, 0, 1, 1]))
    ceiling, both = np.zeros((4, 3)), np.zeros((4, 3))
    ceiling[:, 2], both[:, 2] = [0.0, 0.05, 1.0, -0.8], [0.0, 0.3, 1.0, 0.0]
    assert _resting(fine, ceiling).tolist() == [True, True, False, False]
    assert not _resting(fine, both).any() and not _resting(fine, np.zeros((4, 3))).any()


def test_shapes_and_model_are_drawn(tmp_path):
    try:
        opengl.require_opengl()
    except NoOpenGL as reason:
        pytest.skip(str(reason))
    subprocess.run([sys.executable, "-c", DRAW, str(DATA), str(tmp_path), str(MODELS / "portal.yaml")], check=True)
    sheet = matplotlib.image.imread(tmp_path / "mode_shapes.png")[..., :3]
    assert sheet.shape == (634, 1360, 3)  # a title above five elastic modes on two rows of four
    assert sheet[:34].min() < 0.3  # the title is there
    first, second = sheet[34:284, :340], sheet[34:284, 340:680]
    red = lambda pane: int((pane[..., 0] - pane[..., 2] > 0.4).sum())  # noqa: E731
    blue = lambda pane: int((pane[..., 2] - pane[..., 0] > 0.4).sum())  # noqa: E731
    assert red(first) > 1000 and blue(first) == 0  # mode (1,1) goes one way
    assert red(second) > 1000 and blue(second) > 300  # mode (2,1) both ways, the lower side partly hidden
    model = matplotlib.image.imread(tmp_path / "model.png")
    assert model.shape[0] <= 950 + 24 and model.shape[1] <= 1300 + 24 and np.ptp(model[..., :3]) > 0.5
    colour = matplotlib.colors.to_rgb(PART_COLOURS[0])  # the legend has it pure, with black words beside it
    pure = np.argwhere((np.abs(model[:60, :60, :3] - colour) < 2e-3).all(axis=2))  # rounding to a byte: 1/510
    assert len(pure) > 100 and np.ptp(pure, axis=0).max() < 20
    assert model[:60, 30:200, :3].max(axis=2).min() < 0.1
    bar = sheet[25, 28:149]  # from blue to red
    assert bar[0, 2] > bar[0, 0] + 0.4 and bar[-1, 0] > bar[-1, 2] + 0.4
    shown = model[..., :3].min(axis=2) < 1.0  # cut to what is drawn, with twelve white pixels around
    for filled in (shown.any(axis=0), shown.any(axis=1)):
        assert not filled[:12].any() and not filled[-12:].any() and filled[12] and filled[-13]
    words = sheet[34 + 300 - 22 : 34 + 300 - 6, :340]  # at the foot of the first pane, clear of the plate
    assert words.min() < 0.3 and np.abs(words[..., 0] - words[..., 2]).max() < 0.1
    portal = matplotlib.image.imread(tmp_path / "portal.png")[34:, :340, :3]  # bars alone have no faces to outline
    assert red(portal) > 50


BULK = """BEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,1.,1.,0.
GRID,4,,0.,1.,0.
CQUAD4,1,1,1,2,3,4
PSHELL,1,1,0.01
MAT1,1,2.1+11,,0.3,7850.
SPC1,1,123456,1,2
ENDDATA
"""
STATED = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts:
  plate: {type: shell, mesh: plate.bdf, material: steel, thickness: 10 mm}
  rest: {type: attachments, mesh: plate.bdf, take: supports}
points:
  one: {on: plate, at: [500 mm, 500 mm, 0]}
  long name beside it: {on: plate, at: [501 mm, 500 mm, 0]}
"""


def test_what_is_not_drawn_has_no_legend_and_what_gives_way_has_a_line(tmp_path, monkeypatch):
    pyvista = pytest.importorskip("pyvista")
    (tmp_path / "plate.bdf").write_text(BULK, encoding="utf-8")
    (tmp_path / "stated.yaml").write_text(STATED, encoding="utf-8")
    model = read_model(tmp_path / "stated.yaml")
    told, lines = [], []
    draw, add = scene.draw_legend, pyvista.Plotter.add_lines
    monkeypatch.setattr(scene, "draw_legend", lambda image, entries: (told.extend(entries), draw(image, entries)))
    monkeypatch.setattr(
        pyvista.Plotter, "add_lines", lambda self, ends, **look: (lines.append(ends), add(self, ends, **look))
    )
    try:
        scene.picture_model(model, (), tmp_path / "model.png")
    except NoOpenGL as error:
        pytest.skip(str(error))
    assert [name for name, _ in told] == ["plate", "points", "supports"]
    (leader,) = lines
    np.testing.assert_allclose(leader[0], [0.501, 0.5, 0.0], atol=1e-12)  # rounding
    assert abs(VIEW[0] @ (leader[1] - leader[0])) < 1e-9 < abs(VIEW[1] @ (leader[1] - leader[0]))  # up or down in view
