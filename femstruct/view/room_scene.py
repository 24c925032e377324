"""Sound in a room in three dimensions: surfaces of equal pressure, and moving pictures of a tone or of the pulse."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import scipy

from acoustics.arrays import Complexes
from acoustics.fields.receiver_grids import RoomGrid
from acoustics.fields.sound_field import SoundField
from acoustics.receivers import Receiver
from femstruct.arrays import Floats
from femstruct.files.writing import file_name, replacing
from femstruct.model.model import Model
from femstruct.sound.surfaces import Motion, surface_velocity
from femstruct.study.asked import RoomPlan
from femstruct.study.placed_rooms import placed_room
from femstruct.study.recorded import LargestStress
from femstruct.study.results import CaseResult, StudyResult
from femstruct.view.model_scene import VIEW, Label, NoOpenGL, add_scales, require_opengl, save_scene, separate_labels
from femstruct.view.sound_figures import line_level, line_spacing, receiver_peaks
from femstruct.view.undrawn import no_closed_room

LEVELS: Final = (-0.75, -0.5, -0.25, 0.25, 0.5, 0.75)  # of the largest
SHARE: Final = "Re P over its largest magnitude"
PANE: Final = (560, 500)  # pixels
COLUMNS: Final = 2  # of panes: what is wider cannot be read on paper
MOST: Final = 4  # frequencies on one sheet
FRAMES: Final = 24
PULSE: Final = 48  # pictures of the pulse
CROSSINGS: Final = 3.0  # times the sound crosses the room while it is shown
STEP_MS: Final = 80  # how long a picture stands


def room_pictures(result: StudyResult, folder: str | Path) -> tuple[list[Path], str]:
    """Surfaces of equal pressure of every room of the baseline at its most prominent peaks, and what the study wants
    animated: PNG and GIF files.

    Returns the paths, and a sentence where a machine without OpenGL cannot draw ("" otherwise).
    """
    case, paths = result.cases[result.plan.baseline], []
    model = result.models.get(case.basis_key)
    for plan in case.case.study.rooms:
        room = plan.room
        if not room.bounded or model is None or case.response is None or plan.name not in case.rooms:
            continue
        moving, grid = surface_velocity(case.response, placed_room(plan, model.surfaces)), room.grid()
        try:
            require_opengl()
            peaks = dict(list(receiver_peaks(result, plan.name).items())[:MOST])
            if peaks:
                paths.append(Path(folder) / file_name("pressure_surfaces", plan.name))
                apart = line_spacing(case.rooms[plan.name])
                picture_surfaces(moving, grid, plan, peaks, paths[-1], result.plan.baseline, apart)
            for frequency in plan.animate:
                word = "pulse" if frequency is None else f"{frequency:g} Hz"
                paths.append((Path(folder) / file_name("animation", plan.name, word)).with_suffix(".gif"))
                animate(moving, grid, plan, frequency, paths[-1], result.plan.baseline)
        except NoOpenGL as error:
            return paths, str(error)
    return paths, ""


def no_room_pictures(result: StudyResult) -> str:
    """Why there are no pictures of rooms, "" where there are some."""
    plans = result.cases[result.plan.baseline].case.study.rooms
    missing = {plan.name: no_closed_room(result, plan.name) for plan in plans}
    closed = [plan for plan in plans if not missing[plan.name]]
    if any(plan.animate or receiver_peaks(result, plan.name) for plan in closed):
        return ""
    return next(
        (reason for reason in missing.values() if reason), "no peak stands out of the spectrum" if plans else "no room"
    )


def picture_surfaces(
    moving: Motion, grid: RoomGrid, plan: RoomPlan, peaks: dict[str, float], path: Path, title: str, apart_hz: float
) -> None:
    """Draw surfaces of equal pressure at some frequencies on one sheet, a pane each, in phase with the largest.

    Parameters
    ----------
    peaks : dict[str, float]
        {name: frequency [Hz]}.
    apart_hz : float
        Of the lines of the record's spectrum, whose levels are stated.

    Raises
    ------
    NoOpenGL
        Where VTK cannot draw.
    """
    import pyvista

    p = plan.room.spectrum(moving, np.array(list(peaks.values())), grid.points)
    columns = min(len(peaks), COLUMNS)
    rows = -(-len(peaks) // columns)
    size = [PANE[0] * columns, PANE[1] * rows]
    plotter: Any = pyvista.Plotter(off_screen=True, shape=(rows, columns), window_size=size, border=False)
    for pane, (name, own) in enumerate(zip(peaks, p.T, strict=True)):
        plotter.subplot(pane // columns, pane % columns)
        cells = _cells(grid)
        largest = own[np.abs(own).argmax()]
        cells[SHARE] = np.real(own / largest)
        surfaces = cells.contour(list(LEVELS), scalars=SHARE)
        look = {"scalars": SHARE, "cmap": "RdBu_r", "clim": (-1, 1), "show_scalar_bar": pane == 0}
        look["scalar_bar_args"] = _BAR | {"title": f"{SHARE}\n"}  # lifted off the numbers
        if surfaces.n_points:
            plotter.add_mesh(surfaces, opacity=0.75, smooth_shading=True, **look)
        else:  # nearly uniform: no surface lies in the room
            skin = cells.extract_surface(algorithm="dataset_surface")
            plotter.add_mesh(skin, opacity=0.6, lighting=False, **look)
        _furnish(plotter, cells, plan.receivers)
        level = float(line_level(np.abs(largest), apart_hz))
        low, high = float(cells[SHARE].min()), float(cells[SHARE].max())
        amount = (
            f"largest {level:.0f} dB re 20 µPa (lines {apart_hz:.3g} Hz apart); Re P from {low:.2f} to {high:.2f} of it"
        )
        words = f"{title}: {plan.name}, {name}\n{amount}"
        plotter.add_text(words, position="upper_left", font_size=9, color="black")
    plotter.set_background("white")
    _save(plotter, path)


_BAR: Final = {
    "color": "black", "title_font_size": 11, "label_font_size": 11, "n_labels": 3, "fmt": "%.1f", "width": 0.28,
    "height": 0.06, "position_x": 0.02, "position_y": 0.02,
}  # fmt: skip


def animate(moving: Motion, grid: RoomGrid, plan: RoomPlan, frequency_hz: float | None, path: Path, title: str) -> None:
    """Write a moving picture (GIF) of the pressure on the boundary and on two planes through the first receiver.

    Parameters
    ----------
    frequency_hz : float | None
        One period of that frequency, of the record's spectrum; None: the first milliseconds of the pulse.

    Raises
    ------
    NoOpenGL
        Where VTK cannot draw.
    """
    require_opengl()
    if frequency_hz is not None:
        p = plan.room.spectrum(moving, np.array([frequency_hz]), grid.points)[:, 0]
        _write(plan, grid, path, *_tone(p, frequency_hz, f"{title}: {plan.name}"))
    else:
        _write(plan, grid, path, *_pulse(moving, plan.room, grid, f"{title}: {plan.name}"))


_Frames = tuple[Callable[[int], Floats], int, float, str, Callable[[int], str]]


def _tone(p: Complexes, frequency_hz: float, title: str) -> _Frames:
    largest = float(np.abs(p).max()) or 1.0

    def frame(i: int) -> Floats:
        return np.asarray(np.real(p * np.exp(2j * np.pi * i / FRAMES)))

    def words(i: int) -> str:
        return f"{title}, {frequency_hz:g} Hz, {1e3 * i / FRAMES / frequency_hz:.1f} ms of a period"

    return frame, FRAMES, largest, "Re P [Pa/Hz]", words


def _pulse(moving: Motion, room: SoundField, grid: RoomGrid, title: str) -> _Frames:
    """From the surface's first motion until sound has crossed the room some times."""
    across = float(np.linalg.norm(np.ptp(grid.points, axis=0))) / room.air.c
    rates, dt = moving[0].rates, moving[0].dt
    size = np.sqrt(np.einsum("kt,kt->t", rates, rates))
    start = int(np.argmax(size > 1e-3 * size.max()))
    count = min(len(size), start + max(2, int(CROSSINGS * across / dt)))
    short = [replace(one, rates=one.rates[:, :count]) for one in moving]
    receivers = [Receiver(str(i), place) for i, place in enumerate(grid.points)]
    p = room.pressures([short], receivers)[0].p
    shown = np.linspace(start, count - 1, min(PULSE, count - start)).astype(int)

    def words(i: int) -> str:
        return f"{title}, t = {1e3 * shown[i] * dt:.1f} ms"

    return lambda i: p[:, shown[i]], len(shown), float(np.abs(p).max()) or 1.0, "p [Pa]", words


def _write(
    plan: RoomPlan,
    grid: RoomGrid,
    path: Path,
    frame: Callable[[int], Floats],
    count: int,
    largest: float,
    unit: str,
    words: Callable[[int], str],
) -> None:
    import pyvista
    from PIL import Image

    cells = _cells(grid)
    place = plan.receivers[0].position
    cells[unit] = np.zeros(len(grid.points))
    planes = [cells.slice(normal=normal, origin=place) for normal in ("z", "y")]
    planes = [plane for plane in planes if plane.n_points]
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=[PANE[0] + 120, PANE[1] + 40])
    for number, plane in enumerate(planes):
        plotter.add_mesh(
            plane, scalars=unit, cmap="RdBu_r", clim=(-largest, largest), show_scalar_bar=number == 0,
            scalar_bar_args=_BAR | {"fmt": "%.2g", "title": f"{unit}\n"}, lighting=False, copy_mesh=False,
        )  # fmt: skip
    _furnish(plotter, cells, plan.receivers)
    plotter.set_background("white")
    pictures = []
    for i in range(count):
        cells[unit] = frame(i)
        for plane in planes:
            plane[unit] = plane.sample(cells)[unit]
        plotter.add_text(words(i), position="upper_left", font_size=9, color="black", name="words")
        pictures.append(Image.fromarray(plotter.screenshot(None, return_img=True)))
    plotter.close()
    # one set of colours for all: the scale must not change from picture to picture
    some = np.concatenate([np.asarray(one) for one in pictures[:: max(1, count // 6)]])
    colours = Image.fromarray(some).quantize(255)
    pictures = [one.quantize(palette=colours, dither=Image.Dither.NONE) for one in pictures]
    with replacing(path) as temporary:
        pictures[0].save(temporary, format="GIF", save_all=True, append_images=pictures[1:], duration=STEP_MS, loop=0)


def _cells(grid: RoomGrid) -> Any:
    import pyvista

    corners = grid.cells.shape[1]
    kind = pyvista.CellType.HEXAHEDRON if corners == 8 else pyvista.CellType.TETRA
    faces = np.insert(grid.cells, 0, corners, axis=1).ravel()
    return pyvista.UnstructuredGrid(faces, np.full(len(grid.cells), kind), grid.points.copy())


def _furnish(plotter: Any, cells: Any, receivers: tuple[Receiver, ...]) -> None:
    """The room's edges, its receivers, and scales in metres."""
    edges = cells.extract_surface(algorithm="dataset_surface").extract_feature_edges(20.0, boundary_edges=False)
    plotter.add_mesh(edges, color="#555555", line_width=2)
    if receivers:
        places = np.stack([one.position for one in receivers])
        plotter.add_point_labels(
            places, [one.name for one in receivers], point_color="black", point_size=9, font_size=12, shape=None,
            text_color="black", render_points_as_spheres=True, always_visible=True,
        )  # fmt: skip
    plotter.view_isometric()
    add_scales(plotter)
    plotter.enable_parallel_projection()
    plotter.camera.zoom(0.85)


def _save(plotter: Any, path: Path) -> None:
    from PIL import Image

    image = Image.fromarray(plotter.screenshot(None, return_img=True))
    plotter.close()
    with replacing(path) as temporary:
        image.save(temporary)


# ----------------------------------------------------------------------------------------------------------------------
# Pictures of the largest stresses of parts, in three dimensions.
# ----------------------------------------------------------------------------------------------------------------------

MEGA: Final = 1e-6
WIDTH: Final = 8  # pixels of a bar
SPOT: Final = "#d62728"
BESIDE: Final = 0.04  # of the extent of what is drawn: how far a label is moved from its spot, to each side


def stress_pictures(result: StudyResult, folder: str | Path) -> tuple[list[Path], str]:
    """The largest equivalent stress of every part it is recorded of, a picture a case, in a folder.

    Returns the paths and, where something is left out, why.
    """
    paths: list[Path] = []
    for name, case in result.cases.items():
        stressed = {record.target: case.channels[str(record)].stressed for record in _recorded(case)}
        model = result.models.get(case.basis_key)
        if not stressed or model is None:
            continue
        several = (name,) if len(result.cases) > 1 else ()
        path = Path(folder) / file_name("stress", *several)
        found = {part: one for part, one in stressed.items() if one is not None}
        try:
            picture_stresses(model, found, path, *several)
        except NoOpenGL as error:
            return paths, str(error)
        paths.append(path)
    return paths, ""


def picture_stresses(model: Model, stressed: dict[str, LargestStress], path: Path, title: str = "") -> None:
    """Draw parts coloured by the largest equivalent stress they ever have, and the most stressed place of each.

    Raises NoOpenGL where VTK cannot draw.
    """
    require_opengl()
    import pyvista

    plotter: Any = pyvista.Plotter(off_screen=True, window_size=[1300, 950])
    highest = MEGA * max(float(one.largest.max()) for one in stressed.values())
    for name, part in model.parts.items():
        mesh = pyvista.PolyData()
        mesh.points = part.places
        if len(part.quads):
            mesh.faces = np.insert(part.quads - part.first, 0, 4, axis=1).ravel()
        if len(part.lines):
            mesh.lines = np.insert(part.lines - part.first, 0, 2, axis=1).ravel()
        if name not in stressed:
            plotter.add_mesh(mesh, color="#d9d9d9", opacity=0.4, line_width=3)
            continue
        mesh["stress"] = MEGA * _at_nodes(part.places, stressed[name])
        plotter.add_mesh(
            mesh, scalars="stress", cmap="viridis", clim=(0.0, highest or 1.0), line_width=WIDTH,
            scalar_bar_args={
                "title": "von Mises in MPa", "vertical": True, "color": "black", "n_labels": 6,
                "position_x": 0.88, "position_y": 0.25, "height": 0.5, "width": 0.08, "title_font_size": 14,
            },
        )  # fmt: skip
    spots = np.array([one.places[one.worst] for one in stressed.values()])
    words = [f"{name}: {MEGA * one.largest.max():.4g} MPa" for name, one in stressed.items()]
    box = tuple(plotter.bounds)
    low, high = np.reshape(box, (3, 2)).T
    above = BESIDE * float(np.linalg.norm(high - low)) * VIEW.sum(axis=0)  # to the right and up: the spot is to be seen
    lifted = separate_labels([Label(*each, "black") for each in zip(words, spots + above, strict=True)], low, high)
    for spot, label in zip(spots, lifted, strict=True):
        plotter.add_lines(np.stack([spot, label.place]), color=SPOT, width=1)
    plotter.add_points(spots, color=SPOT, point_size=6)
    plotter.add_point_labels(
        np.array([label.place for label in lifted]), words, font_size=16, shape_color="white", shape_opacity=0.8,
        always_visible=True, text_color="black", show_points=False,
    )  # fmt: skip
    if title:
        plotter.add_text(title, position="upper_left", font_size=10, color="black")
    plotter.add_axes()
    plotter.view_isometric()
    add_scales(plotter, box)  # of the parts, without the lines to their labels
    plotter.set_background("white")
    plotter.enable_parallel_projection()
    plotter.camera.zoom(0.85)
    save_scene(plotter, path, cut=True)


def _recorded(case: CaseResult) -> list[Any]:
    if case.response is None:
        return []
    return [record for record in case.case.study.records if record.what == "stress"]


def _at_nodes(nodes: Floats, stressed: LargestStress) -> Floats:
    """At every node [n] the largest stress of the places next to it [Pa]: of both faces, of all points of a section.
    Nodes with no place of their own, such as those in the middle of bars, have that of their neighbour."""
    found = np.zeros(len(nodes))
    nearest = scipy.spatial.KDTree(nodes).query(stressed.places)[1]
    np.maximum.at(found, nearest, stressed.largest)
    bare = np.setdiff1d(np.arange(len(nodes)), nearest)
    known = np.unique(nearest)
    if len(bare):
        found[bare] = found[known[scipy.spatial.KDTree(nodes[known]).query(nodes[bare])[1]]]
    return found
