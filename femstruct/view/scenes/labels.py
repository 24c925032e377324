"""Names and marks in the picture of a model: points, supports, joints, springs, surfaces, rooms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any, Final

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.model.fastened import Tie
from femstruct.model.model import Model
from femstruct.sound.placed import Placed
from femstruct.study.asked import RoomPlan
from femstruct.study.room_surfaces import placed_room

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
    named = merged(labels, 1e-6 * float(np.linalg.norm(np.ptp(model.mesh.points, axis=0))))
    named = runs(named, low, high)
    for before, label in zip(named, apart(named, low, high), strict=True):
        if (label.place != before.place).any():
            plotter.add_lines(np.stack([before.place, label.place]), color=label.colour, width=1)
        plotter.add_point_labels(
            label.place[None], [label.name], text_color=label.colour, font_size=20, shape="rounded_rect",
            shape_color="white", shape_opacity=0.75, margin=2, show_points=False, always_visible=True, bold=False,
        )  # fmt: skip
    marked = {label.colour for label in labels}
    return [(words, colour) for colour, words in MEANING.items() if colour in marked], box


def merged(labels: Sequence[Label], near: float) -> list[Label]:
    """One label a place: the names found within `near` [m] of each other together, in the colour of what says most
    of the place: what holds it rather than that it has a name.

    >>> at = np.zeros(3)
    >>> found = merged([Label("left", at, POINT), Label("foot", at, SUPPORT)], near=1e-6)
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

    low, high [3] : as of `apart`.

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


def apart(labels: Sequence[Label], low: Floats, high: Floats) -> list[Label]:
    """Labels that would cover an earlier one, moved up, or down where that is less, until they cover none.

    low, high [3] : the box of all that is drawn [m], whose height in the picture tells the size of a letter.

    >>> at = np.zeros(3)
    >>> first, second = apart([Label("left", at, POINT), Label("foot", at, SUPPORT)], at - 1.0, at + 1.0)
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


def thinned(places: Floats) -> Floats:
    """Of places [m, 3] that are more than `MOST_MARKS` one in each cube, as large as it takes; else all of them.

    >>> along = np.linspace(0.0, 1.0, 51)
    >>> grid = np.stack(np.meshgrid(along, along, [0.0]), axis=-1).reshape(-1, 3)
    >>> len(grid), 100 <= len(thinned(grid)) <= MOST_MARKS, len(thinned(grid[:400]))
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
    dots = np.concatenate([thinned(where) for _, where in places])
    plotter.add_points(dots, color=colour, point_size=SIZE, render_points_as_spheres=True)
    return [Label(name, where[(where @ np.array([1.0, 1.0, 1.0])).argmax()], colour) for name, where in places]


def _room(plotter: Any, plan: RoomPlan, room: Placed, before: str) -> list[Label]:
    """The outline of a room beside its surface, and its receivers; returns their names. before : those of receivers."""
    edges, named = room.from_room(plan.room.outline), []
    if len(edges):
        ends = edges.reshape(-1, 3)
        plotter.add_lines(ends, color=ROOM, width=2)
        low = ends[ends[:, 2] <= ends[:, 2].min() + LEVEL * np.ptp(ends, axis=0).max()]
        named = [Label(plan.name, low[low.sum(axis=1).argmax()], ROOM)]
    receivers = [(before + item.name, room.from_room(item.position)[None]) for item in plan.receivers]
    return [*named, *_marks(plotter, receivers, ROOM)]
