"""Models of frames and blocks read for the independent formulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from tests.independent.frames import Floats, Section, Skeleton, section
from tests.machine.framework import Model

SIX = ("x", "y", "z", "rx", "ry", "rz")
_FIXED: Mapping[str, Sequence[str]] = {"clamped": SIX, "simple": SIX[:3]}
_NEAR = 1e-6  # places closer than this [m] are one
LAYERS: Mapping[str, float] = {  # s' [N/m^3] as measured (Hopkins, Sound Insulation, 2007, table A4)
    "layer rock wool 60 kg/m^3 30 mm": 10e6, "layer rock wool 100 kg/m^3 30 mm": 14e6,
    "layer rock wool 140 kg/m^3 30 mm": 19e6, "layer glass wool 36 kg/m^3 13 mm": 28e6,
}  # fmt: skip


def read(model: Model, order: int = 7) -> tuple[Skeleton, dict[str, int]]:
    """The independent form of a model, and the places of its points."""
    bones = Skeleton(order)
    parts = model["parts"]
    frames = {name: part for name, part in parts.items() if part["type"] == "frame"}
    cuts = _cuts(model, frames)
    nodes = {name: _bars(bones, name, part, cuts[name], model) for name, part in frames.items()}
    blocks = {name: _block(bones, part) for name, part in parts.items() if part["type"] == "block"}
    points = {}
    for name, point in model.get("points", {}).items():
        on = point["on"]
        if on in blocks:
            at = bones.place(np.add(parts[on]["origin"], point["at"]))
            bones.follow(blocks[on], at)
            points[name] = at
        else:
            points[name] = _nearest(bones, nodes[on], np.array(point["at"], float))
    for joint in model.get("joints", {}).values():
        _join(bones, joint, nodes, blocks, parts)
    _hang(bones, parts, blocks, points)
    for support in model.get("supports", {}).values():
        fixed = support["fix"]
        words = _FIXED[fixed] if isinstance(fixed, str) else fixed
        bones.hold(points[support["at"]], [SIX.index(one) for one in words])
    for one in model.get("constraints", {}).values():
        if "equation" in one:
            terms = (key.rsplit(".", 1) for key in one["equation"])
            bones.equation({(points[p], SIX.index(d)): one["equation"][f"{p}.{d}"] for p, d in terms})
        else:
            to, said = one["to"], one.get("directions", SIX)
            held = [SIX.index(axis) for axis in ([said] if isinstance(said, str) else said)]
            for follower in [to] if isinstance(to, str) else to:
                bones.follow(points[one["rigid"]], points[follower], held)
    return bones, points


def six(named: Mapping[str, float] | None) -> Floats:
    return np.array([(named or {}).get(one, 0.0) for one in SIX], float)


def _cuts(model: Model, frames: Mapping[str, Any]) -> dict[str, list[Floats]]:
    """Where bars of each frame have a place: at points on them and where joined frames meet them."""
    found = {name: [np.array(point["at"], float) for point in model.get("points", {}).values() if point["on"] == name]
             for name in frames}  # fmt: skip
    for joint in model.get("joints", {}).values():
        first, second = joint["connect"]
        if first in frames and second in frames:
            for a in _segments(frames[first]):
                for b in _segments(frames[second]):
                    meeting = _meeting(*a, *b)
                    if meeting is not None:
                        found[first].append(meeting)
                        found[second].append(meeting)
    return found


def _section(said: Mapping[str, Any]) -> Section:
    return section(**said) if "shape" in said else Section(**said)


def _segments(part: Mapping[str, Any]) -> list[tuple[Floats, Floats]]:
    return [tuple(np.array(pair, float)) for line in part["lines"] for pair in pairwise(line)]  # type: ignore[misc]


def _meeting(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats | None:
    """Where two stretches cross or touch; nothing if they are parallel or apart."""
    sides = np.column_stack([b - a, c - d])
    shares, _, rank, _ = np.linalg.lstsq(sides, c - a, rcond=1e-9)
    if rank < 2:
        for p, q in ((a, c), (a, d), (b, c), (b, d)):
            if np.linalg.norm(p - q) < _NEAR:
                return p
        return None
    if (shares < -_NEAR).any() or (shares > 1 + _NEAR).any():
        return None
    p, q = a + shares[0] * (b - a), c + shares[1] * (d - c)
    return p if np.linalg.norm(p - q) < _NEAR else None


def _bars(bones: Skeleton, name: str, part: Mapping[str, Any], cuts: Sequence[Floats], model: Model) -> list[int]:
    material, shape = model["materials"][part["material"]], _section(model["sections"][part["section"]])
    offsets = part.get("offsets", {})
    first, last = (np.array(offsets.get(end, np.zeros(3)), float) for end in ("start", "end"))
    extra = sum(
        one["mass"]["per_length"] if isinstance(one["mass"], Mapping) else float(str(one["mass"]).split()[0])
        for one in model["parts"].values() if one["type"] == "mass" and one.get("on") == name
    )  # fmt: skip
    up = part.get("orientation")
    E, G = _moduli(material)
    known: list[int] = []
    for a, b in _segments(part):
        along = b - a
        inside = [np.dot(c - a, along) / np.dot(along, along) for c in cuts]
        near = [np.linalg.norm(a + s * along - c) < _NEAR for s, c in zip(inside, cuts, strict=True)]
        shares = {0.0, 1.0} | {float(s) for s, ok in zip(inside, near, strict=True) if ok and _NEAR < s < 1 - _NEAR}
        stops: list[float] = []
        for s in sorted(shares):
            if not stops or s - stops[-1] > _NEAR:
                stops.append(s)
        ends = [_or_new(bones, known, a + s * along) for s in stops]
        arms = [first + s * (last - first) for s in stops]
        for (i, j), pair in zip(pairwise(ends), pairwise(arms), strict=True):
            loss = material.get("loss_factor", 0.0) if model.get("damping", {}).get("from") == "materials" else 0.0
            bones.bar(i, j, shape, E, G, material["rho"], up, pair, extra, loss, part.get("element") == "euler")
    return known


def _moduli(material: Mapping[str, Any]) -> tuple[float, float | tuple[float, float]]:
    """Along a bar, and of shear along y and z of its section."""
    if "G" in material:
        xy, _, zx = material["G"]
        return material["E"][0], (xy, zx)
    return material["E"], material["E"] / 2 / (1 + material["nu"])


def _or_new(bones: Skeleton, known: list[int], at: Floats) -> int:
    for one in known:
        if np.linalg.norm(bones.at[one] - at) < _NEAR:
            return one
    known.append(bones.place(at))
    return known[-1]


def _nearest(bones: Skeleton, known: Sequence[int], at: Floats) -> int:
    return min(known, key=lambda one: float(np.linalg.norm(bones.at[one] - at)))


def _block(bones: Skeleton, part: Mapping[str, Any]) -> int:
    size, mass = np.array(part["size"], float), part["mass"]
    center = size / 2 if part.get("center") is None else np.array(part["center"], float)
    squares = mass * size**2 / 12
    moments = part.get("inertia") or squares.sum() - squares
    at = bones.place(np.add(part["origin"], center))
    bones.body(at, mass, np.diag(moments))
    return at


def _join(
    bones: Skeleton, joint: Mapping[str, Any], nodes: Mapping[str, Sequence[int]], blocks: Mapping[str, int],
    parts: Mapping[str, Any],
) -> None:  # fmt: skip
    first, second = joint["connect"]
    if first in blocks or second in blocks:
        block, frame = (first, second) if first in blocks else (second, first)
        low = np.array(parts[block]["origin"], float)
        high = low + parts[block]["size"]
        pairs = [(blocks[block], one) for one in nodes[frame]
                 if ((bones.at[one] > low - _NEAR) & (bones.at[one] < high + _NEAR)).all()]  # fmt: skip
    else:
        pairs = [(a, b) for a in nodes[first] for b in nodes[second]
                 if np.linalg.norm(bones.at[a] - bones.at[b]) < _NEAR]  # fmt: skip
    if "reach" in joint:
        nearest = [_nearest(bones, nodes[second], bones.at[a]) for a in nodes[first]]
        pairs = [(a, b) for a, b in zip(nodes[first], nearest, strict=True)
                 if np.linalg.norm(bones.at[a] - bones.at[b]) < joint["reach"]]  # fmt: skip
    springs = six(joint.get("stiffness"))
    tied = [k for k in range(3 if joint.get("kind") == "pinned" else 6) if not springs[k]]
    for a, b in pairs:
        bones.follow(a, b, tied)
        if springs.any():
            bones.spring(a, b, springs)


def _hang(bones: Skeleton, parts: Mapping[str, Any], blocks: Mapping[str, int], points: Mapping[str, int]) -> None:
    """Springs, masses, bodies and mats."""
    for part in parts.values():
        if part["type"] == "spring":
            ends = [points[end] for end in part["between"] if end != "ground"]
            a, b = (ends[0], None) if len(ends) == 1 else ends
            bones.spring(a, b, six(part.get("stiffness")), six(part.get("damping")))
        elif part["type"] == "mass" and "at" in part:
            bones.body(points[part["at"]], part["mass"])
        elif part["type"] == "inertia":
            xx, yy, zz, xy, yz, zx = (*part.get("inertia", [0.0] * 3), 0.0, 0.0, 0.0)[:6]
            tensor = np.array([[xx, -xy, -zx], [-xy, yy, -yz], [-zx, -yz, zz]])
            bones.body(points[part["at"]], part["mass"], tensor, np.array(part.get("offset", np.zeros(3)), float))
        elif part["type"] == "foundation":
            _mat(bones, part, parts, blocks)


def _mat(bones: Skeleton, part: Mapping[str, Any], parts: Mapping[str, Any], blocks: Mapping[str, int]) -> None:
    """Springs per area below a block, on the ground or halfway to another below it; per length on a line or a rim."""
    names = [part["on"]] if "on" in part else part["between"]
    low = np.array(parts[names[0]]["origin"], float)
    if len(names) == 2:
        below = parts[names[1]]
        low[2] = 0.5 * (low[2] + below["origin"][2] + below["size"][2])
    said = part.get("stiffness") or {"normal": LAYERS[part["like"]]}
    sizes = np.array([said.get("shear", 0.0), said.get("shear", 0.0), said["normal"], 0, 0, 0])
    for spot, share in _spots(part.get("region", "whole"), np.array(parts[names[0]]["size"][:2], float)):
        ends = [bones.place(low + np.append(spot, 0.0)) for _ in names]
        for name, end in zip(names, ends, strict=True):
            bones.follow(blocks[name], end)
        bones.spring(ends[0], ends[1] if len(ends) == 2 else None, sizes * share, loss=part.get("loss_factor", 0.0))


def _spots(region: Any, size: Floats) -> list[tuple[Floats, float]]:
    """Gauss's places of a region and the weight of each: exact for motions that are linear along it."""
    gauss = np.array([-1.0, 1.0]) / np.sqrt(3)
    if region != "whole" and "line" in region:
        ends = np.array(region["line"], float)
        middle, half = ends.mean(axis=0), (ends[1] - ends[0]) / 2
        return [(middle + g * half, float(np.linalg.norm(half))) for g in gauss]
    sides = size if region == "whole" else np.array(region.get("rectangle", region.get("rim")), float)
    middle = size / 2 if region == "whole" or "at" not in region else np.array(region["at"], float)
    if region != "whole" and "rim" in region:
        x, y = sides / 2
        corners = middle + np.array([[-x, -y], [x, -y], [x, y], [-x, y], [-x, -y]])
        return [one for k in range(4) for one in _spots({"line": corners[k : k + 2]}, size)]
    return [(middle + np.array([g, h]) * sides / 2, sides.prod() / 4) for g in gauss for h in gauss]
