"""Heavy bodies on soft springs, joints and mats, which barely bend what they hang on: any answer of each."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from tests.machine.any_frame import linear
from tests.machine.bars import a_frame, away
from tests.machine.columns import ANSWERS, Subject, case_of
from tests.machine.framework import Case, Model, capability
from tests.machine.skeletons import LAYERS, SIX, read

Draft = dict[str, Any]
_RIGID = "motions of bodies are all there are; rounding, and lines of vibration"
_STIFF = "bars give way by a thousandth of what joints do, their mesh by a thousandth of that; lines of vibration"


def _answers(
    rng: np.random.Generator, draft: Draft, *places: str, accuracy: float = 1e-4, why: str = _RIGID,
    answers: tuple[str, ...] = ANSWERS,
) -> Case:  # fmt: skip
    """Of places along any axis, under a force along the first."""
    ways = [f"{place}.{rng.choice(['x', 'y', 'z'])}" for place in places for _ in range(2)]
    seen = list(dict.fromkeys(ways))

    def form(model: Model) -> Any:
        return linear(*read(model))

    return case_of(rng, Subject(draft, form, ways[:1], seen, accuracy, why, answers=answers))


def _springs(rng: np.random.Generator, draft: Draft, name: str = "m", hertz: float = 5.0) -> Draft:
    """All six, that make motions of a block of near frequencies."""
    part = draft["parts"][name]
    mass, size = part["mass"], np.array(part["size"])
    inertia = mass * (float(size @ size) - size**2) / 12
    six = np.r_[np.full(3, mass), inertia] * (2 * pi * hertz * rng.uniform(0.8, 1.2)) ** 2
    return {one: float(each * rng.uniform(0.6, 1.5)) for one, each in zip(SIX, six, strict=True)}


def _block(rng: np.random.Generator, name: str = "m", origin: Any = (0.0, 0.0, 0.0)) -> Draft:
    """One, with a point near its middle and others at a corner and inside."""
    size = np.round(rng.uniform(0.4, 0.8, 3), 3)
    part: Draft = {
        "type": "block", "mass": float(rng.uniform(50, 500)), "origin": list(origin), "size": size.tolist(),
    }  # fmt: skip
    places = {"foot": size * rng.uniform(0.4, 0.6, 3), "tip": size * rng.uniform(0.8, 1, 3), "in": size * 0.2}
    points = {f"{name} {key}": {"on": name, "at": at.tolist()} for key, at in places.items()}
    return {"parts": {name: part}, "points": points, "damping": {"ratio": 0.02}}


@capability("any answer: a body on a spring of all directions", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = _block(rng)
    stiffness = _springs(rng, draft)
    spring: Draft = {"type": "spring", "between": ["m foot", "ground"], "stiffness": stiffness}
    if rng.random() < 0.7:
        spring["damping"] = {key: size / 2 / pi / 5 * float(rng.uniform(0.08, 0.2)) for key, size in stiffness.items()}
    draft["parts"]["k"] = spring
    return _answers(rng, draft, "m tip", "m in")


@capability("any answer: a body on a joint that gives way", "independent")
def _(rng: np.random.Generator) -> Case:
    """A stub of a frame stands on the ground, another on it by a joint, and a body on that."""
    draft: Draft = {
        "materials": {"m": {"E": 2e11, "nu": 0.3, "rho": 7850.0}},
        "sections": {"s": {"shape": "rectangle", "width": 0.12, "height": 0.1}},
        "parts": {}, "points": {}, "damping": {"ratio": 0.02},
    }  # fmt: skip
    ends = np.round(np.array([np.zeros(3), away(rng, 0.2, 0.3)]).cumsum(axis=0), 3)
    ends = np.vstack([ends, ends[1] + away(rng, 0.2, 0.3)])
    for name, pair in (("f", ends[:2]), ("g", ends[1:])):
        draft["parts"][name] = {
            "type": "frame", "material": "m", "section": "s", "mesh": 0.05, "lines": [pair.tolist()],
        }  # fmt: skip
    draft["points"] = {"root": {"on": "f", "at": ends[0].tolist()}, "end": {"on": "g", "at": ends[2].tolist()}}
    mass, inertia = float(rng.uniform(200, 500)), rng.uniform(8, 20, 3)
    draft["parts"]["b"] = {
        "type": "inertia", "at": "end", "mass": mass, "inertia": inertia.tolist(),
        "offset": away(rng, 0.05, 0.1).tolist(),
    }  # fmt: skip
    six = np.r_[np.full(3, mass), inertia + mass * 0.08] * (2 * pi * 4) ** 2 * rng.uniform(0.6, 1.5, 6)
    some = [one for one in SIX if rng.random() < 0.8] or ["rx"]
    draft["joints"] = {"j": {"connect": ["f", "g"], "stiffness": {
        one: float(size) for one, size in zip(SIX, six, strict=True) if one in some
    }}}  # fmt: skip
    draft["supports"] = {"floor": {"at": "root", "fix": "clamped"}}
    return _answers(rng, draft, "end", why=_STIFF)


@capability("any answer: frames within reach", "independent")
def _(rng: np.random.Generator) -> Case:
    """A portal with one leg on an arm from the tip of a bar; the other is a little too far from it."""
    draft = a_frame(rng, 1)
    root, tip = (np.array(draft["points"][one]["at"]) for one in ("root", "tip"))
    up = np.cross(tip - root, away(rng))
    up /= np.linalg.norm(up)
    reach, other = 0.1, np.round(root + 0.7 * (tip - root), 6)
    feet = [tip + up * float(rng.uniform(0.07, 0.08)), other + up * reach * float(rng.uniform(1.02, 1.08))]
    portal = np.round([feet[0], tip + 0.5 * up, other + 0.6 * up, feet[1]], 6)
    draft["parts"]["f"] |= {"mesh": 0.1, "lines": [[root.tolist(), other.tolist(), tip.tolist()]]}
    draft["parts"]["g"] = draft["parts"]["f"] | {"lines": [portal.tolist()]}
    draft["points"] = {"root": draft["points"]["root"], "foot": {"on": "g", "at": portal[3].tolist()},
                       "top": {"on": "g", "at": portal[1].tolist()}}  # fmt: skip
    draft["joints"] = {"j": {"connect": ["g", "f"], "reach": reach}}
    return _answers(rng, draft, "foot", "top", accuracy=1e-3, why="bars of 0.1 m of three nodes: modes within 1e-3")


@capability("any answer: blocks on mats and on each other", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = _block(rng)
    part = draft["parts"]["m"]
    size, mass = np.array(part["size"]), part["mass"]
    per_area = float(mass * (2 * pi * rng.uniform(4, 8)) ** 2 / size[:2].prod())
    kind = str(rng.choice(["whole", "rectangle", "rim", "line", "like", "between"]))
    mat: Draft = {"type": "foundation", "on": "m"}
    loss = float(rng.uniform(0.06, 0.2))
    sides = (size[:2] * rng.uniform(0.5, 0.8, 2)).round(3)
    at = (sides / 2 + (size[:2] - sides) * rng.uniform(0.1, 0.9, 2)).round(3)
    regions: Draft = {
        "rectangle": {"rectangle": sides.tolist(), "at": at.tolist()},
        "rim": {"rim": sides.tolist(), "at": at.tolist()},
        "line": {"line": [[float(at[0]), 0.02], [float(at[0]), float(size[1] * rng.uniform(0.6, 0.85))]]},
    }  # fmt: skip
    mat["region"] = regions.get(kind, "whole")
    per = {"rim": per_area * size[0] / 3, "line": per_area * size[0]}.get(kind, per_area)
    mat["stiffness"] = {"normal": per, "shear": per * float(rng.uniform(0.3, 1))}
    draft["parts"]["mat"] = mat
    if kind == "line":  # it would tip over a line
        draft["parts"]["k"] = {"type": "spring", "between": ["m foot", "ground"], "stiffness": _springs(rng, draft)}
    elif kind == "like":
        del mat["stiffness"]
        mat["like"] = str(rng.choice(list(LAYERS)))
        part["mass"] = 3000.0
        draft["supports"] = {"upright": {"at": "m foot", "fix": ["x", "y", "rz"]}}
    elif kind == "between":
        other = _block(rng, "n", (0.0, 0.0, -1.5))
        other["parts"]["n"]["size"][2] = 1.4
        del mat["on"], mat["region"]
        mat["between"] = ["m", "n"]
        for one in ("parts", "points"):
            draft[one] |= other[one]
        draft["parts"]["k"] = {
            "type": "spring", "between": ["n foot", "ground"], "stiffness": _springs(rng, draft, "n"),
        }  # fmt: skip
        low = np.minimum(size[:2], other["parts"]["n"]["size"][:2])
        part["size"][:2] = other["parts"]["n"]["size"][:2] = low.tolist()
        for point in draft["points"].values():
            point["at"][:2] = np.minimum(point["at"][:2], low).tolist()
    if rng.random() < 0.6:
        mat["loss_factor"], draft["damping"] = loss, {"from": "materials"}
    return _answers(rng, draft, "m tip", "m in")


@capability("any answer: blocks tied in some directions", "independent")
def _(rng: np.random.Generator) -> Case:
    draft, other = _block(rng), _block(rng, "n", np.round(rng.uniform(1, 2, 3), 2).tolist())
    for one in ("parts", "points"):
        draft[one] |= other[one]
    for name in "mn":
        draft["parts"][f"k {name}"] = {
            "type": "spring", "between": [f"{name} foot", "ground"], "stiffness": _springs(rng, draft, name),
        }  # fmt: skip
    some = [one for one in SIX if rng.random() < 0.4] or ["z"]
    draft["constraints"] = {"tie": {"rigid": "m tip", "to": "n in", "directions": some}}
    if rng.random() < 0.5:
        factors = {f"m in.{rng.choice(['x', 'y', 'z'])}": 1.0, f"n tip.{rng.choice(['x', 'y', 'z'])}": 0.7}
        draft["constraints"] = {"lever": {"equation": factors}}
    return _answers(rng, draft, "m tip", "n tip")


@capability("any answer: short bars that shear", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng, 1, element=str(rng.choice(["euler", "timoshenko18"])))
    at = away(rng, 0.35, 0.5).tolist()
    draft["parts"]["f"]["lines"][0][1], draft["parts"]["f"]["mesh"] = at, 0.01
    draft["points"] = {"root": draft["points"]["root"], "tip": {"on": "f", "at": at}}
    return _answers(rng, draft, "tip", accuracy=1e-3, why="bars of 0.01 m, of two nodes: modes within 1e-3")
