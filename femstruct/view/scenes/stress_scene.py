"""Pictures of the largest stresses of parts, in three dimensions."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
import scipy

from femstruct.arrays import Floats
from femstruct.files.atomic import file_name
from femstruct.model.model import Model
from femstruct.study.recorded import LargestStress
from femstruct.study.result import CaseResult, StudyResult
from femstruct.view.scenes.labels import VIEW, Label, apart
from femstruct.view.scenes.opengl import NoOpenGL, require_opengl
from femstruct.view.scenes.scene import add_scales, save_scene

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
        stressed = {wanted.target: case.channels[str(wanted)].stressed for wanted in _recorded(case)}
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
    lifted = apart([Label(*each, "black") for each in zip(words, spots + above, strict=True)], low, high)
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
    return [wanted for wanted in case.case.study.records if wanted.what == "stress"]


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
