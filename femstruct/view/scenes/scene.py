"""Pictures in three dimensions: mode shapes on one sheet, the model with its names."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.files.atomic import file_name, refuse_unwritable_file, replacing
from femstruct.modal.basis import ModalBasis
from femstruct.model.model import Model
from femstruct.model.refine import Refined, refined
from femstruct.sound.cavities import WOOL
from femstruct.study.asked import RoomPlan
from femstruct.study.result import StudyResult
from femstruct.view.scenes.labels import add_labels
from femstruct.view.scenes.legends import draw_colours, draw_legend
from femstruct.view.scenes.opengl import NoOpenGL, require_opengl

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

    fine = refined(model, DIVISIONS, ALONG)
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
    fine, legend = refined(model, 1), list[tuple[str, str]]()
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
    """Write what a plotter shows; cut : without the white around it; drawn : draws on the image."""
    from PIL import Image, ImageOps

    image = Image.fromarray(plotter.screenshot(None, return_img=True))
    plotter.close()
    drawn(image)
    if cut:
        image = ImageOps.expand(image.crop(ImageOps.invert(image).getbbox()), MARGIN, "white")
    with replacing(path) as temporary:
        image.save(temporary)  # which has the suffix of path
