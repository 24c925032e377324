"""What is beyond a joint, a spring or a layer goes through it: its force by adding up loads, whatever the meshes."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, Final

import numpy as np

from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.patches import box_of, file_of, pieces

Draft = dict[str, Any]
_G: Final = 9.80665
_RHO: Final = 1200.0
_SHIFTS: Final = ("x", "y", "z")


def _plate(at: list[float], size: list[float], mesh: list[int], kind: str) -> Draft:
    """A plate or a slab, thin."""
    made: Draft = {"type": kind, "material": "m", "thickness": 0.05, "origin": at}
    if kind == "plate":
        return {**made, "size": size, "mesh": mesh, "in_plane": "elastic"}
    a, b = size
    return {**made, "outline": [[0, 0], [a, 0], [a, b], [0, b]], "mesh": max(size) / max(mesh)}


def _bar(*places: list[float]) -> Draft:
    return {"type": "frame", "material": "m", "section": "s", "mesh": 0.3, "lines": [[list(one) for one in places]]}


def _gives(rng: np.random.Generator, size: float, per: str, turns: bool = True) -> Draft:
    """Springs of a joint in some directions, or none."""
    words = [*_SHIFTS, *(("rx", "ry", "rz") if turns else ())]
    chosen = [one for one in words if rng.random() < 0.4]
    unit = {True: f"N/m{per}", False: "N*m/rad" + {"": "", "^2": "/m"}[per]}
    spread = {one: f"{size * float(rng.uniform(0.5, 2)):.6g} {unit[one in _SHIFTS]}" for one in chosen}
    return {"stiffness": spread} if spread else {}


def _sheets(rng: np.random.Generator, kind: str, beside: bool) -> tuple[Draft, float]:
    """Two plates or slabs of unlike meshes, one beside the other or above it on a layer, or below on hangers."""
    a, b, c = rng.uniform(0.8, 1.5, 3).round(2).tolist()
    lift = 0.0 if beside else float(rng.uniform(0.2, 0.4)) * (-1 if kind == "hangers" else 1)
    of = "slab" if kind == "slab" else "plate"
    parts = {
        "a": _plate([0, 0, 0], [a, b], [4, int(rng.integers(3, 6))], of),
        "b": _plate([a if beside else 0, 0, lift], [c if beside else a, b], [3, int(rng.integers(3, 6))], of),
    }
    draft: Draft = {"parts": parts, "points": {"p": {"on": "a", "at": [0.4 * a, 0.3 * b]}}}
    long = c if beside else a
    draft["points"] |= {"q": {"on": "b", "at": [0.6 * long, 0.7 * b]}, "r": {"on": "b", "at": [0.8 * long, 0.2 * b]}}
    key = "edge" if of == "plate" else "set"
    edge = {"plate": "x0", "slab": "side 4"} if beside else {"plate": "all", "slab": "rim"}
    draft["supports"] = {"e": {"on": "a", key: edge[of], "fix": "clamped"}}
    if beside:
        draft["joints"] = {"j": {"connect": [], **_gives(rng, 1e8, "^2")}}
    elif kind == "hangers":
        hung = {"normal": "30 kN/m", "shear": "10 kN/m"}
        parts["j"] = {"type": "hangers", "between": ["a", "b"], "spacing": [0.4, 0.4], "stiffness": hung}
    else:
        layer = {"normal": "20 MN/m^3", "shear": "5 MN/m^3"}
        parts["j"] = {"type": "foundation", "between": [], "stiffness": layer}
    return draft, _RHO * 0.05 * long * b


def _bars(rng: np.random.Generator, on: str) -> tuple[Draft, float]:
    """A frame at the end of another, or along a plate."""
    if on == "plate":
        at = [[0.3, 0.3, 0.0], [1.2, 0.3, 0.0], [1.2, 0.3, 0.5]]
        parts = {"a": _plate([0, 0, 0], [1.5, 0.9], [5, 3], "plate"), "b": _bar(*at)}
        supports: Draft = {"e": {"on": "a", "edge": "all", "fix": "clamped"}}
        points: Draft = {"p": {"on": "a", "at": [0.4, 0.4]}}
        per = "^2"
    else:
        start = rng.uniform(0.6, 1, 3).round(2).tolist()
        at = [start, *(np.array(start) + rng.uniform(-1, 1, (2, 3)).round(2)).tolist()]
        parts = {"a": _bar([0.0, 0, 0], start), "b": _bar(*at)}
        points = {"p": {"on": "a", "at": start}, "foot": {"on": "a", "at": [0, 0, 0]}}
        supports, per = {"e": {"at": "foot", "fix": "clamped"}}, ""
    points |= {"q": {"on": "b", "at": at[1]}, "r": {"on": "b", "at": at[2]}}
    draft = {"parts": parts, "points": points, "supports": supports}
    gives = _gives(rng, 1e7, per, turns=on != "plate")
    if on == "plate" and rng.random() < 0.4:
        gives = {"kind": "sliding", "slip": "5 MN/m^2"}
    draft["joints"] = {"j": {"connect": [], **gives}}
    mass = 7800 * 0.05 * 0.08 * sum(float(np.linalg.norm(np.subtract(*pair))) for pair in pairwise(at))
    return draft, mass


def _bricks(rng: np.random.Generator) -> tuple[Draft, float, dict[str, str]]:
    """Two bricks of unlike faces."""
    width, height = rng.uniform(0.3, 0.6, 2).round(2).tolist()
    first, second = rng.uniform(0.3, 0.6, 2).round(2).tolist()
    files, parts, grids = {}, {}, {}
    for name, (low, high), counts in (
        ("a", (0.0, first), (2, 2, 1)), ("b", (first, first + second), (2, 1, int(rng.integers(2, 4)))),
    ):  # fmt: skip
        sides = np.array([low, high])[:, None, None], np.array([0, width])[None, :, None], np.array([0, height])
        nodes, cells = pieces(counts, np.stack(np.broadcast_arrays(*sides), axis=-1), "hex8")
        files[f"{name}.vtu"], grids[name] = file_of(nodes, cells, "hex8"), nodes
        parts[name] = {"type": "solid", "mesh": f"{name}.vtu", "material": "m"}
    root = grids["a"][grids["a"][:, 0] < 1e-9]
    draft: Draft = {
        "parts": parts,
        "supports": {"e": {"on": "a", "box": box_of(root), "fix": ["x", "y", "z"]}},
        "joints": {"j": {"connect": [], "kind": "pinned", **_gives(rng, 1e7, "", turns=False)}},
        "points": {"p": {"on": "a", "at": [first, 0.0, height]}, "q": {"on": "b", "at": [first + second, width, 0.0]},
                   "r": {"on": "b", "at": [first + second, 0.0, height]}},
    }  # fmt: skip
    return draft, _RHO * width * height * second, files


def _of_base(model: Model, kind: str) -> float:
    """Mass of what is on this side of the joint."""
    if kind == "bricks":
        at = model["points"]
        return _RHO * at["p"]["at"][0] * at["q"]["at"][1] * at["p"]["at"][2]
    part = model["parts"]["a"]
    if part["type"] == "frame":
        return 7800 * 0.05 * 0.08 * float(np.linalg.norm(part["lines"][0][1]))
    sides = part["size"] if "size" in part else part["outline"][2]
    return float(model["materials"]["m"]["rho"] * 0.05 * sides[0] * sides[1])


_KINDS: Final = ("plate beside", "slab beside", "plate layer", "slab layer", "hangers", "frame", "rib", "bricks")


@capability("joints: what is beyond a joint goes through it", "independent")
def _(rng: np.random.Generator) -> Case:
    """Under weight and forces on both sides, and what the ground has of all of it."""
    kind, files = str(rng.choice(_KINDS)), {}
    if kind == "bricks":
        draft, mass, files = _bricks(rng)
    elif kind in ("frame", "rib"):
        draft, mass = _bars(rng, "plate" if kind == "rib" else "frame")
    else:
        word = kind.split()[0]
        draft, mass = _sheets(rng, word, "beside" in kind)
    draft["materials"] = {"m": {"E": 2e10, "nu": 0.2, "rho": 7800.0 if kind in ("frame", "rib") else _RHO}}
    draft["sections"] = {"s": {"shape": "rectangle", "width": 0.05, "height": 0.08}}
    draft["damping"] = {"ratio": 0.01}
    if kind not in ("frame", "rib"):
        del draft["sections"]
    sign, order = (1.0, ["b", "a"]) if rng.random() < 0.5 else (-1.0, ["a", "b"])
    if "joints" in draft:
        draft["joints"]["j"]["connect"] = order
    elif kind == "hangers":
        sign = -1.0  # on the ceiling, which is the second
    else:
        draft["parts"]["j"]["between"] = order
    lump = round(float(rng.uniform(5, 50)), 2)
    draft["parts"]["lump"] = {"type": "mass", "at": "r", "mass": lump}
    forces = {f"{one}.{axis}": round(float(rng.normal() * 300), 1) for one in "pqr" for axis in _SHIFTS}
    said = [word for way, size in forces.items() for word in ("--force", f"{way}={size} N")]

    def asked(model: Model, door: Door) -> Floats:
        found = door.ask(model, "statics", "--weight", *said, **files)
        door.told.clear()
        own = found["forces_n"]
        return np.r_[own["j"], own["e"], own["ground"], 1e3 * ("j" in found["on_the_ground"])]

    def right(model: Model, door: Door) -> Floats:
        beyond = np.array([sum(forces[f"{one}.{axis}"] for one in "qr") for axis in _SHIFTS])
        beyond[2] -= _G * (mass + lump)
        near = np.array([forces[f"p.{axis}"] for axis in _SHIFTS]) - [0, 0, _G * _of_base(model, kind)]
        return np.r_[sign * beyond, beyond + near, beyond + near, 0.0]

    return Case(draft, asked, right, 1e-6, "equilibrium; rounding of the solution")
