"""The outline of a model in lines, for machines that cannot draw in three dimensions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from femstruct.arrays import Integers
from femstruct.model.model import Model
from femstruct.model.refine import refined
from femstruct.study.asked import RoomPlan
from femstruct.study.room_surfaces import placed_room
from femstruct.view.figures.drawing import BASELINE, COLOURS, new_figure, panels
from femstruct.view.scenes.labels import ROOM, VIEW, Label, apart


def outline(model: Model, rooms: Sequence[RoomPlan]) -> Figure:
    """Edges of the parts, named points, rooms and receivers in isometric view; the sides of the box of all [m]."""
    fine = refined(model, 1)
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
    for mark, named in zip(marks, apart(marks, low, high), strict=True):
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
