"""How a structure is put together: what nothing joins, what nothing holds up, what cannot move, what a layer
does not fill.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from itertools import combinations

import numpy as np
import scipy

from femstruct.arrays import Floats
from femstruct.errors import Finding, list_some
from femstruct.model.elastic_layers import layer_of
from femstruct.model.model import Model, part_masses
from femstruct.model.part import FilledBox
from femstruct.model.structure import ABOUT, ACROSS, Structure, bodies_of, extent
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.joint_findings import Piece, held_directions, pieces, place_of_touch
from femstruct.parts.rib_findings import bars_beside

DOMINATES = 1e6  # of the rest: a mass of that share is ground, or a slip of a unit
HELD_ROUNDING = 1e-9
MOST_PIECES = 10  # of which it is looked whether they touch
WHOLE = 0.999  # of a side that a layer fills: less is more than rounding
_ALMOST = 1e-9  # of a gap: parts that touch, to rounding


def arrangement_findings(
    model: Model, joined: Iterable[tuple[str, str]] = (), gravity: bool = False
) -> tuple[Finding, ...]:
    """Pieces that nothing joins or holds up, parts that cannot move, and a mass beside which the rest is nothing.

    Parameters
    ----------
    joined : Iterable[tuple[str, str]]
        Pairs of points that contacts and links of a study hold together.
    gravity : bool
        Whether it has gravity.
    """
    found = pieces(model, joined)
    falling = _falling(found, gravity)
    falling_parts = {name for piece in found if gravity and piece.falls for name in piece.parts}
    return (
        *_unjoined(model, found),
        *falling,
        *_turned(model, found, falling_parts),
        *_held(model),
        *_dominating(model),
    )


def _names(piece: Piece) -> str:
    return list_some(piece.parts)


def _unjoined(model: Model, found: tuple[Piece, ...]) -> list[Finding]:
    """A finding for every piece beside the heaviest; pieces of the same parts, as loose legs of a frame, share one. The
    air of a cavity joins what is held."""
    alike: dict[tuple[str, ...], list[Piece]] = {}
    of_surface = {surface.name: surface.on for surface in model.structure.surfaces}
    in_air = {of_surface.get(name) for one in model.structure.cavities for name in (one.first, one.second)}
    for piece in found[1:]:
        if in_air.intersection(piece.parts) and not len(piece.free):
            continue
        alike.setdefault(piece.parts, []).append(piece)
    return [_loose(model, found, pieces_of) for pieces_of in alike.values()]


def _loose(model: Model, found: tuple[Piece, ...], alike: list[Piece]) -> Finding:
    pairs = [(piece, other) for piece in alike[:MOST_PIECES] for other in found[:MOST_PIECES] if other is not piece]
    touches = [at for pair in pairs if (at := place_of_touch(model, *pair)) is not None]
    reached = None if touches else next((one for pair in pairs if (one := bars_beside(model, *pair))), None)
    piece = next((one for one in alike if len(one.free)), alike[0])
    free = len(piece.free) > 0
    which = _names(piece)
    if len(alike) > 1:
        which += f" ({len(alike)} pieces)"
    elif any(not np.isin(model.mesh.nodes[name], piece.nodes).all() for name in piece.parts):
        which += f" (the piece at {_place(model.mesh.points[piece.nodes[0]])} m)"
    message = f"{which}: no connection to {_names(found[0])}"
    message += f", although parts touch at {_place(touches[0])} m. Is a joint missing?" if touches else "."
    if reached is not None:
        message = (
            f"{message[:-1]}, although the bars of {reached.bars} lie {_apart(reached.apart)} beside the middle of "
            f"{reached.face} at {_place(reached.place)} m, where their section reaches it. Is a joint missing? Write "
            f"their lines in it, 'offsets: {{start: {reached.offset}, end: {reached.offset}}}' there, and a joint."
        )
    message += " It can move freely" if free else " Each vibrates separately"
    return Finding(
        "parts-not-joined",
        f"{message}. Joints, layers and springs connect parts; so do contacts and links of a study",
        {"pieces": len(found), "free_motions": len(piece.free), "mass_kg": sum(one.mass for one in alike)},
        severe=free or bool(touches) or reached is not None or len(found[0].free) > 0,
    )


def _falling(found: tuple[Piece, ...], gravity: bool) -> list[Finding]:
    return [
        Finding(
            "nothing-carries-weight",
            f"{_names(piece)}: the study has gravity, and no support, layer or spring carries {piece.mass:.4g} kg: "
            "the part falls or tips over, which is not computed. Support it, or set gravity: false; to let it strike "
            "start it with its speed then, initial: {rigid: {about: POINT, velocity: [0, 0, -4.43 m/s]}} for 1 m",
            {"mass_kg": piece.mass, "free_motions": len(piece.free)},
            severe=True,
        )
        for piece in (found if gravity else ())
        if piece.falls
    ]


def _turned(model: Model, found: tuple[Piece, ...], fallen: Collection[str]) -> list[Finding]:
    """Edges whose springs or walls only resist rotation, of parts that nothing holds along their normal.

    Parameters
    ----------
    fallen : Collection[str]
        Parts of which it is said that they fall.
    """
    raised = []
    for item in model.structure.supports:
        turned = item.walls or (ABOUT in item.stiffness and ACROSS not in item.stiffness)
        if not turned or item.on is None or item.on in fallen:
            continue
        axes = model.parts[item.on].own_axes
        normal = np.eye(3)[2] if axes is None else axes[2]
        piece = next(one for one in found if item.on in one.parts)
        what, do = ("walls", "Write") if item.walls else ("springs", "Add 'z' to the stiffness, or write")
        if np.linalg.norm(piece.free[:, :3] @ normal) < 1.0 - HELD_ROUNDING:  # of a shift: one if nothing resists it
            continue
        raised.append(
            Finding(
                "edge-only-turned",
                f"{item.name}: the {what} of this edge resist its rotation alone, and "
                f"nothing holds {item.on} along its normal: all {piece.mass:.4g} kg of it can move away. "
                f"{do} 'fix: simple'",
                {"mass_kg": piece.mass, "free_motions": len(piece.free)},
                severe=True,
            )
        )
    return raised


def _held(model: Model) -> list[Finding]:
    """Parts of which every node is held: of a plate its deflection, of frames and blocks all three displacements."""
    held = held_directions(model)
    findings = []
    for name, part in model.parts.items():
        nodes = part.nodes
        if part.own_axes is not None:
            normal = part.own_axes[2]
            share = np.einsum("i,nij,j->n", normal, held[nodes], normal)
            what = "the deflection of every node"
        else:
            share = np.linalg.eigvalsh(held[nodes])[:, 0]
            what = "every node"
        if share.min(initial=1.0) > HELD_ROUNDING:
            findings.append(
                Finding(
                    "nothing-moves",
                    f"{name}: supports hold {what} ({len(nodes)}), so that it cannot move. Is the mesh too coarse, "
                    "or are "
                    "too many nodes held?",
                    {"nodes": len(nodes)},
                    severe=True,
                )
            )
    return findings


def _times(mass: float, rest: float) -> str:
    return f"{mass / rest:.1g} times less" if rest else "no mass"


def _dominating(model: Model) -> list[Finding]:
    masses = part_masses(model)
    if len(masses) < 2:
        return []
    name = max(masses, key=lambda one: masses[one])
    rest = sum(mass for one, mass in masses.items() if one != name)
    if masses[name] <= DOMINATES * rest:
        return []
    return [
        Finding(
            "one-mass-dominates",
            f"{name} has {masses[name]:.4g} kg, all other parts {rest:.4g} kg, {_times(masses[name], rest)}: {name} "
            "does not move. Check the units, or replace it by a support",
            {"mass_kg": masses[name], "rest_kg": rest},
            severe=True,
        )
    ]


def _apart(length: float) -> str:
    return f"{length:.3g} m" if length >= 1.0 else f"{1e3 * length:.3g} mm"


def _place(at: Floats) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in at) + ")"


def overhang_findings(model: Model) -> tuple[Finding, ...]:
    """Layers that fill all that two parts share, where that is not all of either of them."""
    parts, bodies = model.structure.parts, bodies_of(model.structure)
    layers = [part for part in parts if isinstance(part, Foundation) and part.region.kind == "whole"]
    return tuple(found for layer in layers if layer.to is not None for found in _overhang(layer, bodies))


def _overhang(part: Foundation, bodies: Mapping[str, FilledBox]) -> tuple[Finding, ...]:
    first, second = part.on, str(part.to)
    size = float(max(bodies[name].size.max() for name in (first, second)))
    layer = layer_of(part, bodies, _ALMOST * size)
    x0, x1, y0, y1 = layer.box
    filled = (x1 - x0) * (y1 - y0)
    sides = {}
    for name in (first, second):
        along = np.abs(layer.axes[:2] @ bodies[name].axes.T) @ bodies[name].size
        sides[name] = float(along[0] * along[1])
    name = min(sides, key=lambda one: sides[one])
    share = filled / sides[name]
    if share >= WHOLE:
        return ()
    return (
        Finding(
            "layer-overhang",
            f"{part.name} covers {filled:.4g} m^2, the common area of {first} and {second}, of the "
            f"{sides[name]:.4g} m^2 of {name}: {100 * (1 - share):.0f} % of {name} is not supported",
            {"filled_m2": filled, "side_m2": sides[name]},
        ),
    )


# ----------------------------------------------------------------------------------------------------------------------
# What is in one place twice: plates and blocks that fill the same space, lines and masses that are given again.
# ----------------------------------------------------------------------------------------------------------------------

SAME = 1e-6  # of the structure's size: places closer are one
REACHES = 0.01  # of the thinner part: less is a rounded dimension
INSIDE = 0.5  # of the thinner part: from here on it is in the other's place
MOST_LINES = 3000  # straight pieces compared each with each


def duplicate_findings(structure: Structure) -> tuple[Finding, ...]:
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


def _in_one_place(
    one: tuple[str, FilledBox], other: tuple[str, FilledBox], tolerance: float, joined: bool
) -> list[Finding]:
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
    shared_lines: dict[tuple[str, str], tuple[Floats, float, int]] = {}
    for first, second, shared in _overlapping(ends, tolerance):
        key = (names[first], names[second])
        middle = ends[second].mean(axis=0)
        at, length, count = shared_lines.get(key, (middle, 0.0, 0))
        shared_lines[key] = (at, length + shared, count + 1)
    return [
        _line_twice(*key, at, length, count, frozenset(key) in joined)
        for key, (at, length, count) in shared_lines.items()
    ]


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
