"""Names and marks in the picture of a model: points, supports, springs, surfaces, rooms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats
from femstruct.conventions import N_COMPONENTS
from femstruct.model.model import Model
from femstruct.model.probe import Surface
from femstruct.study.study import RoomPlan

POINT, SUPPORT, SPRING, SURFACE, ROOM = "#d62728", "#2ca02c", "#ff7f0e", "#1f77b4", "#9467bd"
SIZE: Final = 13  # of marks, in pixels


def add_labels(plotter: Any, model: Model, rooms: Sequence[RoomPlan]) -> None:
    """Add marks and names of everything but the parts' own faces to a plotter."""
    grounded = [(tie.name, tie.rows) for tie in model.ties if tie.grounded]
    springs = [(item.name, item.rows) for item in model.elastics]
    masses = [(item.name, item.rows) for item in model.inerts]
    _marks(plotter, [(name, _where(model, rows)) for name, rows in grounded], SUPPORT, "supports")
    _marks(plotter, [(name, _where(model, rows)) for name, rows in springs], SPRING, "springs, foundations")
    _marks(plotter, [(name, _where(model, rows)) for name, rows in masses], "black", "masses")
    _marks(plotter, [(name, point.position[None]) for name, point in model.points.items()], POINT, "points")
    for surface in model.surfaces.values():
        corners = _corners(surface)
        plotter.add_lines(np.concatenate([corners, corners[:1]]), color=SURFACE, width=3, connected=True)
        _name(plotter, [surface.name], corners[:1], SURFACE)
    for plan in rooms:
        if plan.under in model.surfaces:
            _room(plotter, plan, model.surfaces[plan.under])


def _where(model: Model, rows: csr_array) -> Floats:
    """Nodes that rows act on [m, 3]."""
    places: Floats = model.mesh.points[np.unique(rows.indices // N_COMPONENTS)]
    return places


def _marks(plotter: Any, places: Sequence[tuple[str, Floats]], colour: str, label: str) -> None:
    """Dots at all places of each name, and the name once, at the place farthest out in view."""
    places = [(name, where) for name, where in places if len(where)]
    if not places:
        return
    dots = np.concatenate([where for _, where in places])
    plotter.add_points(dots, color=colour, point_size=SIZE, render_points_as_spheres=True, label=label)
    seen = np.array([where[(where @ np.array([1.0, 1.0, 1.0])).argmax()] for _, where in places])
    _name(plotter, [name for name, _ in places], seen, colour)


def _name(plotter: Any, names: Sequence[str], where: Floats, colour: str) -> None:
    plotter.add_point_labels(
        where, list(names), text_color=colour, font_size=15, shape="rounded_rect", shape_color="white",
        shape_opacity=0.75, margin=2, show_points=False, always_visible=True, bold=False,
    )  # fmt: skip


def _corners(surface: Surface) -> Floats:
    first, second = surface.along * surface.size[:, None]
    corners: Floats = surface.corner + np.array([0 * first, first, first + second, second])
    return corners


def _room(plotter: Any, plan: RoomPlan, surface: Surface) -> None:
    """The outline of a room below its surface, and its receivers."""
    lx, ly, lz = plan.room.size
    middle = surface.corner + surface.size @ surface.along / 2.0 - np.asarray(plan.offset) @ surface.along
    lower = middle + surface.normal * lz - np.array([lx, ly]) / 2.0 @ surface.along
    frame = np.stack([*surface.along, -surface.normal])
    corner = np.array([[x, y, z] for z in (0, lz) for x, y in ((0, 0), (lx, 0), (lx, ly), (0, ly))]) @ frame + lower
    pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    plotter.add_lines(corner[np.array(pairs).ravel()], color=ROOM, width=2)
    _name(plotter, [plan.name], corner[[corner[:4].sum(axis=1).argmax()]], ROOM)
    receivers = [(f"{plan.name}.{item.name}", (item.position @ frame + lower)[None]) for item in plan.receivers]
    _marks(plotter, receivers, ROOM, "receivers")
