"""What is in one place twice: plates and blocks that fill the same space, lines and masses that are given again."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import scipy

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.model.part import Body
from femstruct.model.structure import Structure, bodies_of, extent
from femstruct.parts.frame import Frame

SAME = 1e-6  # of the structure's size: places closer are one
REACHES = 0.01  # of the thinner part: less is a rounded dimension
INSIDE = 0.5  # of the thinner part: from here on it is in the other's place
MOST_LINES = 3000  # straight pieces compared each with each


def twice_findings(structure: Structure) -> tuple[Finding, ...]:
    """Two parts in one place, a line given twice, and a mass, spring or layer given again; all with their names."""
    size = extent(structure)
    joined = {frozenset((joint.a, joint.b)) for joint in structure.joints}
    found: list[Finding] = []
    for one, other in combinations(bodies_of(structure).items(), 2):
        found += _in_one_place(one, other, SAME * size, frozenset((one[0], other[0])) in joined)
    found += _cells(structure, SAME * size, joined)
    found += _lines(structure, SAME * size, joined)
    found += _given_again(structure)
    return tuple(found)


def _in_one_place(one: tuple[str, Body], other: tuple[str, Body], tolerance: float, joined: bool) -> list[Finding]:
    """Two plates with parallel faces, or two blocks, of which one reaches into the other."""
    (name, (corner, axes, sides, flat)), (other_name, (second, others, second_sides, other_flat)) = one, other
    if flat != other_flat or (flat is None and joined):  # joined blocks may be made of boxes
        return []
    turn = others @ axes.T
    if np.abs(np.abs(turn) - np.round(np.abs(turn))).max() > SAME or abs(turn[2, 2]) < 0.5:
        return []
    start = (second - corner) @ axes.T
    end = start + second_sides @ np.round(turn)
    shared = np.minimum(np.maximum(start, end), sides) - np.maximum(np.minimum(start, end), 0.0)
    if shared[:2].min() <= tolerance or shared[2] <= REACHES * min(sides[2], second_sides[2]):
        return []
    share = float(shared[2] / min(sides[2], second_sides[2]))
    area = " x ".join(f"{side:.4g}" for side in shared[:2])
    return [
        Finding(
            "overlapping-parts",
            f"{name} and {other_name} overlap: {area} m over {1e3 * shared[2]:.4g} mm, {100 * share:.0f} % of "
            "the thinner one: mass and stiffness count twice there. The origin of a plate is on its mid-surface",
            {"depth_m": float(shared[2]), "share": share},
            severe=share > INSIDE,
        )
    ]


def _cells(structure: Structure, tolerance: float, joined: set[frozenset[str]]) -> list[Finding]:
    """Parts of meshes that have cells in one place, as of a set and of one that contains it."""
    found = []
    middles = [(part.name, places) for part in structure.parts if len(places := part.middles())]
    for (one, first), (other, second) in combinations(middles, 2):
        distances = np.asarray(scipy.spatial.KDTree(first).query(second)[0])
        same = np.flatnonzero(distances <= tolerance)
        if not len(same) or frozenset((one, other)) in joined:  # joined shells may be the layers of one wall
            continue
        share = len(same) / min(len(first), len(second))
        place = ", ".join(f"{value:.4g}" for value in second[same[0]])
        found.append(
            Finding(
                "overlapping-parts",
                f"{one} and {other} have {len(same)} cells in one place, {100 * share:.0f} % of the smaller one, the "
                f"first at ({place}) m: mass and stiffness count twice there. Give each part a set of its own",
                {"cells": len(same), "share": share},
                severe=share > INSIDE,
            )
        )
    return found


def _lines(structure: Structure, tolerance: float, joined: set[frozenset[str]]) -> list[Finding]:
    """Straight pieces of frames that lie on each other."""
    names, pieces = [], []
    for part in structure.parts:
        if isinstance(part, Frame):
            for line in part.lines:
                points = np.asarray(line, dtype=np.float64)
                names += [part.name] * (len(points) - 1)
                pieces.append(np.stack([points[:-1], points[1:]], axis=1) + np.asarray(part.start_offset))
    if not names:
        return []
    ends = np.concatenate(pieces)
    told: dict[tuple[str, str], tuple[Floats, float, int]] = {}
    for first, second, shared in _overlapping(ends, tolerance):
        key = (names[first], names[second])
        middle = ends[second].mean(axis=0)
        at, length, count = told.get(key, (middle, 0.0, 0))
        told[key] = (at, length + shared, count + 1)
    return [_line_twice(*key, at, length, count, frozenset(key) in joined) for key, (at, length, count) in told.items()]


def _line_twice(one: str, other: str, at: Floats, length: float, count: int, joined: bool) -> Finding:
    which = f"{one} has a line twice" if one == other else f"{one} and {other} have a line in one place"
    place = ", ".join(f"{value:.4g}" for value in at)
    return Finding(
        "overlapping-lines",
        f"{which}, {count} straight piece{'s' if count > 1 else ''} of {length:.4g} m, the first near ({place}) m: "
        "mass and stiffness count twice there" + (". This is correct for a built-up bar" if joined else ""),
        {"length_m": length, "pieces": count},
        severe=one == other or not joined,
    )


def _overlapping(ends: Floats, tolerance: float) -> list[tuple[int, int, float]]:
    """Pairs of straight pieces [n, 2, 3] that share more than a point, and the length they share [m]."""
    found = []
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1)
    unit = along / np.where(length > 0.0, length, 1.0)[:, None]
    for first in range(min(len(ends), MOST_LINES) - 1):
        rest = slice(first + 1, MOST_LINES)
        place = np.stack([(ends[rest, i] - start[first]) @ unit[first] for i in (0, 1)], axis=1)
        off = np.stack(
            [np.linalg.norm(ends[rest, i] - start[first] - place[:, i, None] * unit[first], axis=1) for i in (0, 1)],
            axis=1,
        )
        shared = np.minimum(place.max(axis=1), length[first]) - np.maximum(place.min(axis=1), 0.0)
        others = np.flatnonzero((off.max(axis=1) <= tolerance) & (shared > 10.0 * tolerance))
        found += [(first, first + 1 + int(other), float(shared[other])) for other in others]
    return found


def _given_again(structure: Structure) -> list[Finding]:
    """Parts that are equal in all but their names."""
    places = {point.name: (point.on, point.at) for point in structure.points}
    numbered = {
        f"{point.name}.{number}": (point.on, (at,))
        for point in structure.points
        for number, at in enumerate(point.at, 1)
    }
    seen: dict[object, str] = {}
    found = []
    for part in structure.parts:
        identity = part.identity({**numbered, **places})
        if identity is None:
            continue
        if identity in seen:
            found.append(
                Finding(
                    "duplicate-part",
                    f"{seen[identity]} and {part.name} are one {identity[0]} in one place, given twice: remove one, "
                    "or replace both by their sum",
                    {"times": 2},
                    severe=True,
                )
            )
        seen.setdefault(identity, part.name)
    return found
