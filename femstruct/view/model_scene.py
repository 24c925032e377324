"""Pictures in three dimensions: mode shapes on one sheet, the model with its names."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import count
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Final, TypeVar

import matplotlib as mpl
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import FemstructError, InputError
from femstruct.files.writing import file_name, refuse_unwritable_file, replacing
from femstruct.modal.basis import ModalBasis
from femstruct.model.model import Model, Refined, refine_model
from femstruct.model.part import Tie
from femstruct.sound.cavity_coupling import WOOL
from femstruct.sound.placed import Placed
from femstruct.study.asked import RoomPlan
from femstruct.study.placed_rooms import placed_room
from femstruct.study.results import StudyResult
from femstruct.view.drawing import BASELINE, COLOURS, new_figure, panels

# ----------------------------------------------------------------------------------------------------------------------
# Whether this machine can draw in three dimensions.
# ----------------------------------------------------------------------------------------------------------------------

_WINDOW: Final = "VTK_DEFAULT_OPENGL_WINDOW"
_CHOSEN: Final = "FEMSTRUCT_OPENGL_WINDOW"  # in a process that may crash: drawn with, untried
WAYS: Final = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow", "")  # without a display; "" for VTK's own choice
_PROBE: Final = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(8, 8)
window.AddRenderer(vtkRenderer())
window.Render()
"""
LEFT_OUT: Final = (
    "Pictures of shapes left out: no OpenGL on this machine; on Debian or Ubuntu, install libegl1 and libgl1-mesa-dri."
)


class NoOpenGL(FemstructError):
    """This machine cannot draw in three dimensions."""


def require_opengl() -> None:
    """Choose how VTK draws off screen; raises NoOpenGL when no way works.

    Without OpenGL libraries VTK does not raise, it crashes; so each way is tried once in another process.
    """
    if _CHOSEN in os.environ:
        return
    window = _working_window()
    if window is None:
        raise NoOpenGL(LEFT_OUT)
    if window:
        os.environ[_WINDOW] = window


def choose(window: str) -> None:
    """Let this process draw with a render window of VTK, "" for its own choice, without trying whether that works."""
    os.environ[_CHOSEN] = window
    if window:
        os.environ[_WINDOW] = window


@cache
def _working_window() -> str | None:
    """The render window to ask VTK for, "" for its own choice; None when all of them crash."""
    chosen = os.environ.get(_WINDOW)
    headless = sys.platform.startswith("linux")
    backends = (chosen,) if chosen else WAYS if headless else ("",)
    return next((backend for backend in backends if _draws(backend)), None)


def _draws(window: str) -> bool:
    environment = {**os.environ, _WINDOW: window} if window else dict(os.environ)
    try:
        probe = subprocess.run([sys.executable, "-c", _PROBE], env=environment, capture_output=True, timeout=60)
    except subprocess.TimeoutExpired:
        return False
    return probe.returncode == 0


# ----------------------------------------------------------------------------------------------------------------------
# Drawing in a process of its own: beside this one, and no loss where VTK crashes for want of OpenGL.
# ----------------------------------------------------------------------------------------------------------------------

R = TypeVar("R")
FORKS: Final = sys.platform.startswith("linux")  # elsewhere a process of its own would have to be sent all results


def draw_in_process(draw: Callable[[], R]) -> Callable[[], R]:
    """Begin to draw in another process, where that is cheap; what is returned waits for it and tells its answer.

    A crash in one way of drawing is answered by the next way; after the last one NoOpenGL is raised. What `draw` raises
    is raised. Where processes are not forked, it is called here when its answer is asked for.

    >>> draw_in_process(lambda: 6 * 7)()
    42
    """
    if not FORKS:
        return draw
    backends = (
        [os.environ.get("VTK_DEFAULT_OPENGL_WINDOW", "")] if "VTK_DEFAULT_OPENGL_WINDOW" in os.environ else [*WAYS]
    )
    first = _begin(draw, backends[0])

    def answer() -> R:
        for number, backend in enumerate(backends):
            process, pipe = _begin(draw, backend) if number else first
            try:
                good, received = pipe.recv()
            except EOFError:
                continue  # it crashed
            finally:
                process.join()
            if not good:
                raise received
            found: R = received
            return found
        raise NoOpenGL(LEFT_OUT)

    return answer


def _begin(draw: Callable[[], Any], backend: str) -> tuple[Any, Connection]:
    context = get_context("fork")
    pipe, ours = context.Pipe(duplex=False)
    process = context.Process(target=_draw, args=(draw, backend, ours), daemon=True)
    process.start()
    ours.close()
    return process, pipe


def _draw(draw: Callable[[], Any], backend: str, pipe: Connection) -> None:
    choose(backend)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # what VTK says before it crashes; failures go through the pipe
    try:
        answer: tuple[bool, Any] = True, draw()
    except Exception as failure:
        answer = False, failure
    pipe.send(answer)
    pipe.close()
    os._exit(0)  # what this process inherited is not its own to clean up


# ----------------------------------------------------------------------------------------------------------------------
# Legends on pictures in three dimensions, in black text beside their colours: those of VTK have its colour.
# ----------------------------------------------------------------------------------------------------------------------

LETTERS: Final = 18  # height in pixels of a legend
SMALL: Final = 12  # of a title and a scale of colours
BAR: Final = (120, 10)  # pixels of a scale of colours


def draw_legend(image: Any, entries: Sequence[tuple[str, str]]) -> None:
    """Names beside their colours, in the upper left corner of an image.

    >>> from PIL import Image
    >>> image = Image.new("RGB", (200, 60), "white")
    >>> draw_legend(image, [("floor", "#ff0000")])
    >>> image.getpixel((18, 20)), min(image.crop((34, 0, 200, 60)).tobytes())  # its colour, black letters
    ((255, 0, 0), 0)
    """
    from PIL import ImageDraw

    draw, font = ImageDraw.Draw(image), _font(LETTERS)
    for number, (name, colour) in enumerate(entries):
        top = 12 + 1.4 * LETTERS * number
        draw.rectangle((12, top, 12 + 0.8 * LETTERS, top + 0.8 * LETTERS), fill=colour, outline="#444444")
        draw.text((12 + 1.3 * LETTERS, top + 0.4 * LETTERS), name, fill="black", font=font, anchor="lm")


def draw_colours(image: Any, title: str, meaning: str) -> None:
    """A title at the top of an image, and below it the scale of colours from -1 to 1 and what they mean.

    >>> from PIL import Image
    >>> image = Image.new("RGB", (400, 34), "white")
    >>> draw_colours(image, "case", "displacement")
    >>> image.getpixel((28, 25)), image.getpixel((28 + BAR[0], 25))  # blue and red
    ((58, 76, 192), (179, 3, 38))
    """
    from PIL import Image, ImageDraw

    (width, height), font, draw, middle = BAR, _font(SMALL), ImageDraw.Draw(image), 25
    row = (255 * mpl.colormaps["coolwarm"](np.linspace(0.0, 1.0, width + 1))[:, :3]).astype(np.uint8)
    image.paste(Image.fromarray(np.repeat(row[None], height, axis=0)), (28, middle - height // 2))
    draw.text((10, 9), title, fill="black", font=font, anchor="lm")
    draw.text((10, middle), "-1", fill="black", font=font, anchor="lm")
    draw.text((28 + width + 8, middle), f"1   {meaning}", fill="black", font=font, anchor="lm")


def _font(height: int) -> Any:
    from PIL import ImageFont

    return ImageFont.truetype(Path(mpl.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf"), height)


# ----------------------------------------------------------------------------------------------------------------------
# Names and marks in the picture of a model: points, supports, joints, springs, surfaces, rooms.
# ----------------------------------------------------------------------------------------------------------------------

POINT, SUPPORT, SPRING, MASS, SURFACE, ROOM = "#d62728", "#2ca02c", "#ff7f0e", "#000000", "#1f77b4", "#9467bd"
JOINT = "#8c564b"
MEANING: Final = {
    POINT: "points",
    SUPPORT: "supports",
    JOINT: "joints, links, seams",
    SPRING: "springs, foundations",
    MASS: "masses",
    SURFACE: "surfaces",
    ROOM: "rooms, receivers",
}
TELLING: Final = (SUPPORT, JOINT, SPRING, MASS, ROOM, SURFACE, POINT)
"""Colours by how much they say of a place where several names meet."""
SIZE: Final = 13  # of marks, in pixels
MOST_MARKS: Final = 400  # of one name: more of them hide what they are on
VIEW: Final = np.array([[-1.0, 1.0, 0.0], [-1.0, -1.0, 2.0]]) / np.sqrt([[2.0], [6.0]])
"""Isometric view: rows to the right and up, of unit length, as pyvista looks by `view_isometric`."""
CHARACTER: Final = (0.016, 0.034)  # of the height of a picture's contents: width and height of a letter
FELT: Final = 1e-6  # of the largest share in a row: less is rounding
LEVEL: Final = 1e-6  # of a room's size: corners that differ by less are of one height


@dataclass(frozen=True)
class Label:
    """A name at a place [m, 3] and the colour of what it names."""

    name: str
    place: Floats
    colour: str


def add_labels(
    plotter: Any, model: Model, rooms: Sequence[RoomPlan]
) -> tuple[list[tuple[str, str]], tuple[float, ...]]:
    """Add marks and names of everything but the parts' own faces to a plotter; returns what marks of a colour are, and
    the bounds of what is drawn, without the lines to labels that had to give way."""
    grounded = [tie for tie in model.ties if tie.grounded]
    joined = [(tie, _led(tie)) for tie in model.ties if not tie.grounded]
    springs = [(item.name, item.places if len(item.places) else _where(model, item.rows)) for item in model.elastics]
    masses = [(item.name, item.rows) for item in model.inerts]
    points = [(name, point.position[None]) for name, point in model.points.items()]
    labels = [
        *_marks(plotter, points, POINT),
        *_marks(plotter, [(tie.name, _where(model, tie.rows)) for tie in grounded], SUPPORT),
        *_marks(plotter, [(tie.name, model.mesh.points[hubs]) for tie, (hubs, _) in joined], JOINT),
        *_marks(plotter, springs, SPRING),
        *_marks(plotter, [(name, _where(model, rows)) for name, rows in masses], MASS),
    ]
    arms = np.concatenate([np.empty((0, 3)), *(spokes(model.mesh.points, *led) for _, led in joined)])
    if len(arms):
        plotter.add_lines(arms, color=JOINT, width=2)
    for surface in model.surfaces.values():
        corners = surface.outline
        plotter.add_lines(np.concatenate([corners, corners[:1]]), color=SURFACE, width=3, connected=True)
        labels.append(Label(surface.name, corners[0], SURFACE))
    for plan in rooms:
        if plan.under in model.surfaces:
            labels += _room(plotter, plan, placed_room(plan, model.surfaces), f"{plan.name}." if len(rooms) > 1 else "")
    box = tuple(plotter.bounds)
    low, high = np.reshape(box, (3, 2)).T
    named = merge_labels(labels, 1e-6 * float(np.linalg.norm(np.ptp(model.mesh.points, axis=0))))
    named = runs(named, low, high)
    for before, label in zip(named, separate_labels(named, low, high), strict=True):
        if (label.place != before.place).any():
            plotter.add_lines(np.stack([before.place, label.place]), color=label.colour, width=1)
        plotter.add_point_labels(
            label.place[None], [label.name], text_color=label.colour, font_size=20, shape="rounded_rect",
            shape_color="white", shape_opacity=0.75, margin=2, show_points=False, always_visible=True, bold=False,
        )  # fmt: skip
    marked = {label.colour for label in labels}
    return [(words, colour) for colour, words in MEANING.items() if colour in marked], box


def merge_labels(labels: Sequence[Label], near: float) -> list[Label]:
    """One label a place: the names found within `near` [m] of each other together, in the colour of what says most
    of the place: what holds it rather than that it has a name.

    >>> at = np.zeros(3)
    >>> found = merge_labels([Label("left", at, POINT), Label("foot", at, SUPPORT)], near=1e-6)
    >>> [(label.name, label.colour == SUPPORT) for label in found]
    [('left, foot', True)]
    """
    groups: list[list[Label]] = []
    for label in labels:
        same = next((group for group in groups if np.linalg.norm(group[0].place - label.place) <= near), None)
        if same is None:
            groups.append([label])
        else:
            same.append(label)
    names = (", ".join(dict.fromkeys(label.name for label in group)) for group in groups)
    return [
        Label(name, group[0].place, min((label.colour for label in group), key=TELLING.index))
        for name, group in zip(names, groups, strict=True)
    ]


def runs(labels: Sequence[Label], low: Floats, high: Floats) -> list[Label]:
    """Labels of the places of one list that follow each other and would cover each other as one, at the first of them.

    Parameters
    ----------
    low, high : Floats [3]
        As of `separate_labels`.

    Examples
    --------
    >>> right = np.array([-1.0, 1.0, 0.0])  # in the view
    >>> feet = [Label(f"feet.{i}", at * right, POINT) for i, at in enumerate((0.0, 0.02, 0.04, 0.9), 1)]
    >>> [label.name for label in runs(feet, np.zeros(3), np.full(3, 2.0))]
    ['feet.1 to 3', 'feet.4']
    """
    width, height = _letter(low, high)
    groups: list[list[Label]] = []
    for label in labels:
        before = groups[-1][-1] if groups else None
        if before is not None and _follows(before, label):
            across, up = np.abs(VIEW @ (label.place - before.place))
            if across < width * len(before.name) and up < height:
                groups[-1].append(label)
                continue
        groups.append([label])
    return [
        first if first is last else Label(f"{first.name} to {last.name.rpartition('.')[2]}", first.place, first.colour)
        for first, last in ((group[0], group[-1]) for group in groups)
    ]


def _follows(before: Label, label: Label) -> bool:
    """Whether a label is of the next place of the list of another: "feet.2" after "feet.1"."""
    (one, _, number), (other, _, following) = before.name.rpartition("."), label.name.rpartition(".")
    alike = one and one == other and before.colour == label.colour and number.isdecimal() and following.isdecimal()
    return bool(alike) and int(following) == int(number) + 1


def _letter(low: Floats, high: Floats) -> Floats:
    """Width and height of a letter in a picture of a box [2] [m]."""
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3) @ VIEW.T
    size: Floats = np.ptp(corners, axis=0).max() * np.array(CHARACTER)
    return size


def separate_labels(labels: Sequence[Label], low: Floats, high: Floats) -> list[Label]:
    """Labels that would cover an earlier one, moved up, or down where that is less, until they cover none.

    Parameters
    ----------
    low, high : Floats [3]
        The box of all that is drawn [m], whose height in the picture tells the size of a letter.

    Examples
    --------
    >>> at = np.zeros(3)
    >>> first, second = separate_labels([Label("left", at, POINT), Label("foot", at, SUPPORT)], at - 1.0, at + 1.0)
    >>> first.place.tolist(), bool(VIEW[1] @ second.place > 0.0), round(float(VIEW[0] @ second.place), 12)
    ([0.0, 0.0, 0.0], True, 0.0)
    """
    width, height = _letter(low, high)
    placed: list[Label] = []
    taken: list[tuple[float, float, float]] = []
    for label in labels:
        x, y = VIEW @ label.place
        end = x + width * (len(label.name) + 1)  # with its margins
        beside = [at for left, right, at in taken if x < right and left < end]
        steps = (sign * 0.25 * height * step for step in count() for sign in (1.0, -1.0))
        up = next(one for one in steps if all(abs(y + one - at) >= height for at in beside))
        taken.append((x, end, y + up))
        placed.append(Label(label.name, label.place + up * VIEW[1], label.colour))
    return placed


def _where(model: Model, rows: csr_array) -> Floats:
    """Nodes that rows act on [m, 3]."""
    places: Floats = model.mesh.points[np.unique(rows.indices // N_COMPONENTS)]
    return places


def _led(tie: Tie) -> tuple[Integers, Integers]:
    """Of each entry of the rows that hold displacements, the node with the largest share in its row, and its own."""
    rows = tie.rows[np.flatnonzero(tie.directions.any(axis=1))].tocoo()
    order = np.lexsort((-np.abs(rows.data), rows.row))
    row, node = rows.row[order], rows.col[order].astype(np.int64) // N_COMPONENTS
    first = np.maximum.accumulate(np.where(np.diff(row, prepend=-1) != 0, np.arange(len(row)), 0))
    shares = np.abs(rows.data[order])
    felt = shares > FELT * shares[first]
    return node[first][felt], node[felt]


def spokes(places: Floats, hubs: Integers, nodes: Integers) -> Floats:
    """Ends [2 m, 3] of lines from hubs [k] to other nodes [k], where they are apart; each line once.

    >>> places = np.array([[0.0, 0, 1], [1, 1, 0], [1, 1, 0], [-1, -1, 0]])
    >>> spokes(places, [0, 0, 0, 3, 1], [0, 1, 3, 0, 2]).reshape(2, 2, 3)[:, 1].tolist()
    [[1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]]
    """
    pairs = np.unique(np.sort(np.stack([hubs, nodes], axis=1), axis=1), axis=0)
    ends = places[pairs]
    far = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > LEVEL * np.linalg.norm(np.ptp(places, axis=0))
    return np.asarray(ends[far].reshape(-1, 3))


def thin_marks(places: Floats) -> Floats:
    """Of places [m, 3] that are more than `MOST_MARKS` one in each cube, as large as it takes; else all of them.

    >>> along = np.linspace(0.0, 1.0, 51)
    >>> grid = np.stack(np.meshgrid(along, along, [0.0]), axis=-1).reshape(-1, 3)
    >>> len(grid), 100 <= len(thin_marks(grid)) <= MOST_MARKS, len(thin_marks(grid[:400]))
    (2601, True, 400)
    """
    low, side = places.min(axis=0), float(np.ptp(places, axis=0).max()) / MOST_MARKS
    kept = places
    while len(kept) > MOST_MARKS and side > 0.0:
        side *= 1.5
        cubes = np.floor((places - low) / side + 0.5).astype(np.int64)
        kept = places[np.sort(np.unique(cubes, axis=0, return_index=True)[1])]
    return kept


def _marks(plotter: Any, places: Sequence[tuple[str, Floats]], colour: str) -> list[Label]:
    """Dots at the places of each name, thinned; returns the name once, at the place farthest out in view."""
    places = [(name, where) for name, where in places if len(where)]
    if not places:
        return []
    dots = np.concatenate([thin_marks(where) for _, where in places])
    plotter.add_points(dots, color=colour, point_size=SIZE, render_points_as_spheres=True)
    return [Label(name, where[(where @ np.array([1.0, 1.0, 1.0])).argmax()], colour) for name, where in places]


def _room(plotter: Any, plan: RoomPlan, room: Placed, before: str) -> list[Label]:
    """The outline of a room beside its surface, and its receivers; returns their names.

    Parameters
    ----------
    before : str
        Those of receivers.
    """
    edges, named = room.from_room(plan.room.outline), []
    if len(edges):
        ends = edges.reshape(-1, 3)
        plotter.add_lines(ends, color=ROOM, width=2)
        low = ends[ends[:, 2] <= ends[:, 2].min() + LEVEL * np.ptp(ends, axis=0).max()]
        named = [Label(plan.name, low[low.sum(axis=1).argmax()], ROOM)]
    receivers = [(before + item.name, room.from_room(item.position)[None]) for item in plan.receivers]
    return [*named, *_marks(plotter, receivers, ROOM)]


# ----------------------------------------------------------------------------------------------------------------------
# Pictures in three dimensions.
# ----------------------------------------------------------------------------------------------------------------------

MOST_MODES: Final = 12
PANE: Final = (340, 300)  # pixels of one mode
DIVISIONS: Final = 3
ALONG: Final = 8  # pieces of a bar, which is curved more than a cell of a plate
MOST_TICKS: Final = 5
HALVES: Final = 1e-9  # so that -0.1425 and 0.1425 are rounded alike, away from 0
THIN: Final = 0.08  # of the largest extent: no room for ticks
TICKS: Final = 15
MARGIN: Final = 12  # pixels around a picture of a model
POINTS: Final = 10  # of words below a shape
FITTING: Final = 34  # characters of this size in a pane
LEAST_RATIO: Final = 1e-4  # damping that is told in a picture
TITLE: Final = 34  # pixels above the panes
LIFT: Final = 0.12  # of half a pane: a shape stands above its words
DEFORMATION: Final = 0.06  # largest displacement in a picture, of the diagonal of the structure
STILL: Final = 0.1  # of the largest displacement: a part that moves less is drawn faintly
FAINT: Final = 0.15  # opacity
PART_COLOURS: Final = ("#9ecae1", "#fdae6b", "#636363", "#a1d99b", "#bcbddc", "#e7cb94", "#d6616b", "#8ca252")


def shapes_all(result: StudyResult, folder: str | Path) -> tuple[list[Path], str]:
    """A sheet of the first elastic modes for every distinct structure of a study, as PNG files in a folder.

    Returns the paths and, where something is left out, a sentence that says why ("" otherwise): a machine without
    OpenGL cannot draw, a structure in closed form has no shape to draw. Of no structure nothing is left out.
    """
    paths, rigid = list[Path](), False
    alike: dict[str, list[str]] = {}
    for name in dict.fromkeys((result.plan.baseline, *result.cases)):
        alike.setdefault(result.cases[name].basis_key, []).append(name)
    for key, (name, *others) in alike.items():
        model = result.models.get(key)
        if model is None:
            continue
        if "elastic" not in result.cases[name].basis.kind:
            rigid = True
            continue
        words = ("mode_shapes",) if name == result.plan.baseline else ("mode_shapes", name)
        path = Path(folder) / file_name(*words)
        try:
            picture_modes(model, result.cases[name].basis, path, ", ".join((name, *others)))
        except NoOpenGL as error:
            return paths, str(error)
        paths.append(path)
    known = any(case.basis.omega.size for case in result.cases.values())
    if rigid:
        return paths, "Pictures of shapes left out: all modes of a structure are rigid-body modes."
    return paths, "Pictures of shapes left out: the structure is in closed form." if known and not paths else ""


def baseline_model(result: StudyResult) -> Model | None:
    """The meshed model of a study's baseline; None for a structure in closed form, or of bodies alone."""
    model = result.models.get(result.cases[result.plan.baseline].basis_key)
    return model if model is not None and model.parts else None


def model_picture(result: StudyResult, folder: str | Path) -> tuple[list[Path], str]:
    """The model of the baseline with its names, its rooms and its receivers, as model.png in a folder.

    Returns as `shapes_all` does.
    """
    model = baseline_model(result)
    if model is None:
        return [], ""
    path = Path(folder) / file_name("model")
    try:
        picture_model(model, result.cases[result.plan.baseline].case.study.rooms, path)
    except NoOpenGL as error:
        return [], str(error)
    return [path], ""


def picture_modes(model: Model, basis: ModalBasis, path: str | Path, title: str = "", most: int = MOST_MODES) -> None:
    """Draw the first elastic modes on one sheet: deformed, smooth between the nodes, coloured by displacement.

    Each is scaled to the same largest displacement and coloured, red up and blue down, by the global direction it
    moves most in, which its title names beside number, frequency and damping ratio. Modes over wool are those without
    losses, and have no ratio: damping couples them.

    Raises NoOpenGL where VTK cannot draw.
    """
    modes = [mode for mode, kind in enumerate(basis.kind) if kind == "elastic"][:most]
    if not modes:
        raise InputError("modes", got="no elastic mode", expected="at least one to draw")
    require_opengl()
    import pyvista

    fine = refine_model(model, DIVISIONS, ALONG)
    moved = fine.displacement(basis.shapes[:, :, modes])
    columns = min(4, len(modes))
    rows = -(-len(modes) // columns)
    top: Any = [(0, slice(None))]
    plotter: Any = pyvista.Plotter(
        off_screen=True, shape=(rows + 1, columns), row_weights=[TITLE, *[PANE[1]] * rows], groups=top,
        window_size=[PANE[0] * columns, TITLE + PANE[1] * rows], border=False,
    )  # fmt: skip
    meaning = (
        "displacement along the axis named, over the largest of the mode, "
        f"which is drawn as {100 * DEFORMATION:.0f} % of the structure's diagonal; parts that hardly move are pale"
    )
    rest = _mesh(fine, fine.points)
    edges = rest  # of bars alone; of faces their boundary and folds
    if len(fine.quads):
        edges = rest.extract_feature_edges(
            boundary_edges=True, feature_edges=True, non_manifold_edges=True, manifold_edges=False
        )
    for place, mode in enumerate(modes):
        plotter.subplot(place // columns + 1, place % columns)
        direction = _draw_mode(plotter, fine, edges, moved[:, :, place])
        ratio = _damping(float(basis.damping_ratio[mode])) if WOOL not in basis.holders else "without losses"
        words = f"{mode + 1}:  {basis.frequency_hz[mode]:.2f} Hz,  {ratio},  {direction}"
        plotter.add_text(words, position=(10, 8), font_size=_font_size(words), color="black")
    plotter.set_background("white")
    save_scene(plotter, path, drawn=lambda image: draw_colours(image, title, meaning))


def _damping(ratio: float) -> str:
    """A damping ratio in words that a pane has room for.

    >>> _damping(0.0112), _damping(3.3e-7), _damping(0.0)
    ('damping 1.1 %', 'damping < 0.01 %', 'damping 0 %')
    """
    return "damping < 0.01 %" if 0.0 < ratio < LEAST_RATIO else f"damping {100.0 * ratio:.2g} %"


def _font_size(words: str) -> int:
    """Points of words that fit into a pane.

    >>> _font_size("9:  104.55 Hz,  damping 1 %,  y"), _font_size("12:  10145.25 Hz,  damping < 0.01 %,  x")
    (10, 8)
    """
    return min(POINTS, POINTS * FITTING // len(words))


def picture_model(model: Model | None, rooms: Sequence[RoomPlan], path: str | Path) -> None:
    """Draw a model with its names: parts, supports, springs and foundations, points, surfaces, rooms, axes in metres.

    Raises InputError for a structure in closed form, a name that is no picture's or a folder that is not there,
    NoOpenGL where VTK cannot draw.
    """
    if model is None:
        raise InputError("--picture", got="a structure in closed form", expected="a model with parts")
    if (suffix := Path(path).suffix.lower()) not in (".png", ".jpg", ".jpeg", ".tif"):
        raise InputError("--picture", got=f"'{suffix}'", expected="a name that ends in .png, .jpg or .tif")
    refuse_unwritable_file(Path(path))
    require_opengl()
    import pyvista

    plotter: Any = pyvista.Plotter(off_screen=True, window_size=[1300, 950])
    fine, legend = refine_model(model, 1), list[tuple[str, str]]()
    for number, name in enumerate(fine.parts):
        own = fine.part_of_point == number
        mesh = _mesh(fine, fine.points, own)
        if not mesh.n_cells:  # of supports and masses a mesh states there are marks
            continue
        colour = PART_COLOURS[number % len(PART_COLOURS)]
        solid = bool(own[fine.quads[:, 0]].any())
        look = {"opacity": 0.85, "show_edges": True, "edge_color": "#8a8a8a"} if solid else {"line_width": 5}
        plotter.add_mesh(mesh, color=colour, lighting=False, **look)  # in the colour of its legend
        legend.append((name, colour))
    marks, box = add_labels(plotter, model, rooms)
    legend += marks
    plotter.add_axes()
    plotter.view_isometric()
    add_scales(plotter, box)
    plotter.set_background("white")
    plotter.enable_parallel_projection()
    plotter.camera.zoom(0.85)  # what is tall keeps its scales and names inside
    save_scene(plotter, path, cut=True, drawn=lambda image: draw_legend(image, legend))


def add_scales(plotter: Any, bounds: Sequence[float] | None = None) -> None:
    """Scales in metres along the box of all that is drawn, or along `bounds` (x from, x to, y from, ..), with ticks
    where there is room for them; where a scale begins and ends its title says, since the ends of two scales meet in a
    corner."""
    from pyvista import convert_string_array

    box = plotter.bounds if bounds is None else bounds
    low, high = np.reshape(box, (3, 2)).T
    largest = float((high - low).max()) or 1.0
    share = (high - low) / largest
    decimals = max(0, 3 - int(np.floor(np.log10(3.0 * largest))))
    scales: dict[str, Any] = {}
    inner: dict[str, list[str]] = {}
    for axis, start, end, part in zip("xyz", low, high, share, strict=True):
        thin = part < THIN
        scales[f"{axis}title"] = f"{axis} {start:.{decimals}f} to {end:.{decimals}f} m"
        scales[f"show_{axis}labels"] = not thin
        count = int(min(1 + np.ceil(4.0 * part), MOST_TICKS))
        scales[f"n_{axis}labels"], ticks = _rounded(start, end, count, decimals)
        inner[axis] = ["", *ticks, ""] if ticks and not thin else [""]
    actor = plotter.show_bounds(bounds=box, grid=False, location="outer", font_size=TICKS, color="#444444", **scales)
    for number, words in enumerate(inner.values()):
        actor.SetAxisLabels(number, convert_string_array(np.array(words)))


def _rounded(start: float, end: float, count: int, decimals: int) -> tuple[int, list[str]]:
    """How many ticks, one more or less than `count`, have the roundest numbers, and those between the ends.

    >>> _rounded(0.0, 0.4, 4, 3), _rounded(0.0, 0.6, 5, 3)
    ((5, ['0.1', '0.2', '0.3']), (4, ['0.2', '0.4']))
    >>> _rounded(-0.285, 0.285, 5, 3)
    (5, ['-0.143', '0.000', '0.143'])
    """
    found = []
    for number in (count, count + 1, count - 1):
        between = (1.0 + HALVES) * np.linspace(start, end, number)[1:-1]
        inner = [f"{at:z.{decimals}f}" for at in between]
        while inner and decimals and all(tick.endswith("0") and "." in tick for tick in inner):
            inner = [tick[:-1].removesuffix(".") for tick in inner]
        found.append((number, inner))
    return min((one for one in found if one[1] or count < 3), key=lambda one: max(map(len, one[1]), default=0))


def _draw_mode(plotter: Any, fine: Refined, edges: Any, moved: Floats) -> str:
    """Add one deformed shape to the current pane; returns the direction it is coloured by."""
    diagonal = float(np.linalg.norm(np.ptp(fine.points, axis=0)))
    largest = float(np.linalg.norm(moved, axis=1).max())
    axis = int((moved**2).sum(axis=0).argmax())
    if edges.n_points:  # a ball has none
        plotter.add_mesh(edges, color="#b0b0b0", line_width=1)
    points = fine.points + moved * (DEFORMATION * diagonal / largest if largest else 0.0)
    resting = _resting(fine, moved)
    for own, opacity in ((~resting, 1.0), (resting, FAINT)):
        mesh = _mesh(fine, points, own)
        if mesh.n_cells:
            mesh["displacement"] = moved[:, axis] / largest if largest else moved[:, axis]
            plotter.add_mesh(
                mesh, scalars="displacement", cmap="coolwarm", clim=(-1.0, 1.0), show_scalar_bar=False, line_width=3,
                smooth_shading=False, opacity=opacity,
            )  # fmt: skip
    plotter.view_isometric()
    plotter.enable_parallel_projection()
    plotter.camera.zoom(0.95)
    plotter.camera.SetWindowCenter(0.0, -LIFT)
    return "xyz"[axis]


def _resting(fine: Refined, moved: Floats) -> NDArray[np.bool_]:
    """Points of parts that hardly move in a mode [n]: a deck at rest would hide the ceiling that moves below it."""
    size = np.linalg.norm(moved, axis=1)
    largest = np.array([size[fine.part_of_point == number].max(initial=0.0) for number in range(len(fine.parts))])
    still = largest < STILL * size.max(initial=0.0)
    found: NDArray[np.bool_] = still[fine.part_of_point] if len(still) else np.zeros(len(size), dtype=bool)
    return found


def _mesh(fine: Refined, points: Floats, own: Any = None) -> Any:
    """Faces and lines of a refined model, or of one part of it, at these points."""
    import pyvista

    quads = fine.quads if own is None else fine.quads[own[fine.quads[:, 0]]]
    lines = fine.lines if own is None else fine.lines[own[fine.lines[:, 0]]]
    mesh = pyvista.PolyData()
    mesh.points = np.ascontiguousarray(points)
    if len(quads):
        mesh.faces = np.insert(quads, 0, 4, axis=1).ravel()
    if len(lines):
        mesh.lines = np.insert(lines, 0, 2, axis=1).ravel()
    return mesh


def save_scene(
    plotter: Any, path: str | Path, cut: bool = False, drawn: Callable[[Any], None] = lambda image: None
) -> None:
    """Write what a plotter shows.

    Parameters
    ----------
    cut : bool
        Without the white around it.
    drawn : Callable[[Any], None]
        Draws on the image.
    """
    from PIL import Image, ImageOps

    image = Image.fromarray(plotter.screenshot(None, return_img=True))
    plotter.close()
    drawn(image)
    if cut:
        image = ImageOps.expand(image.crop(ImageOps.invert(image).getbbox()), MARGIN, "white")
    with replacing(path) as temporary:
        image.save(temporary)  # which has the suffix of path


# ----------------------------------------------------------------------------------------------------------------------
# The outline of a model in lines, for machines that cannot draw in three dimensions.
# ----------------------------------------------------------------------------------------------------------------------


def outline(model: Model, rooms: Sequence[RoomPlan]) -> Figure:
    """Edges of the parts, named points, rooms and receivers in isometric view; the sides of the box of all [m]."""
    fine = refine_model(model, 1)
    figure = new_figure(8.0, 5.6, "")
    axes = panels(figure, 1, 1, between=0.0, top=0.2)[0, 0]
    low, high = fine.points.min(axis=0), fine.points.max(axis=0)
    for number, name in enumerate(fine.parts):
        own = fine.part_of_point == number
        edges = np.concatenate([_edges(fine.quads[own[fine.quads[:, 0]]]), fine.lines[own[fine.lines[:, 0]]]])
        colour = COLOURS[number % len(COLOURS)]
        axes.add_collection(LineCollection(list(fine.points[edges] @ VIEW.T), colors=colour, label=name))
    marks = [Label(name, point.position, BASELINE) for name, point in model.points.items()]
    for plan in rooms:
        if plan.under in model.surfaces:
            room = placed_room(plan, model.surfaces)
            edges_of_room = room.from_room(plan.room.outline)
            lines = LineCollection(
                list(edges_of_room @ VIEW.T), colors=ROOM, linestyles="--", zorder=1, label=plan.name
            )
            axes.add_collection(lines)
            marks += [Label(item.name, room.from_room(item.position), ROOM) for item in plan.receivers]
    for mark, named in zip(marks, separate_labels(marks, low, high), strict=True):
        axes.plot(*(VIEW @ mark.place), ".", color=mark.colour)
        text = {"textcoords": "offset points", "fontsize": 8, "color": mark.colour}
        axes.annotate(mark.name, tuple(VIEW @ named.place), (4, 3), **text)
    sides = " x ".join(f"{side:.4g}" for side in high - low)
    axes.text(0.01, 0.01, f"structure: {sides} m along x, y, z", transform=axes.transAxes, fontsize=8)
    axes.autoscale()
    axes.set_aspect("equal")
    axes.margins(0.05)
    axes.set_axis_off()
    axes.legend(fontsize=8, loc="upper left", frameon=False)
    return figure


def _edges(quads: Integers) -> Integers:
    """Edges [e, 2] of faces that belong to one face alone; all of a body that is closed.

    >>> _edges(np.array([[0, 1, 4, 3], [1, 2, 5, 4]])).tolist()
    [[0, 1], [0, 3], [1, 2], [2, 5], [3, 4], [4, 5]]
    """
    sides = np.sort(np.concatenate([quads[:, [i, (i + 1) % 4]] for i in range(4)]), axis=1)
    found, count = np.unique(sides, axis=0, return_counts=True)
    return found[count == 1] if (count == 1).any() else found
