"""Plates and slabs that barely bend on what carries them, which moves them as bodies: any answer of each."""

from __future__ import annotations

from functools import partial
from math import pi
from typing import Any

import numpy as np

from tests.independent.linear import Floats
from tests.machine.columns import ANSWERS, Subject, case_of
from tests.machine.framework import Case, capability
from tests.machine.plates import CLT, between, plies
from tests.machine.sheets import read
from tests.machine.skeletons import LAYERS

Draft = dict[str, Any]
_WHY = (
    "bodies, which bending changes by 1e-3 and its mesh by a tenth of that; rotary inertia about "
    "the normal of slabs (h^2 / 12 too much): (h / a)^2 / 4, below 1e-3; lines of vibration"
)
_ASIDE = (
    "thick-for-short-waves", "coarse-mesh", "modal-mass-low", "stress-uneven", "thick-plate", "sags-far", "few-elastic",
    "stiff-layer", "implausible-material",
)  # fmt: skip
_SIDES = {"x0": "side 4", "x1": "side 2", "y0": "side 1", "y1": "side 3"}


def _answers(
    rng: np.random.Generator, draft: Draft, *ways: str, accuracy: float = 1e-3, order: int = 3, why: str = _WHY,
    answers: tuple[str, ...] = ANSWERS,
) -> Case:  # fmt: skip
    """Under a force at d along the first way's axis."""
    subject = Subject(
        draft, partial(read, order=order), (f"d.{ways[0][-1]}",), ways, accuracy, why, aside=_ASIDE, answers=answers
    )
    return case_of(rng, subject)


def _sheet(rng: np.random.Generator, kind: str, times: float = 1.0) -> Draft:
    """A stiff one with two points, held by nothing; times : as long and wide."""
    a, b = times * between(rng, 1.0, 1.6), times * between(rng, 1.0, 1.6)
    part: Draft = {"type": kind, "material": "m", "thickness": between(rng, 0.03, 0.04)}
    if kind == "plate":
        part |= {"origin": [0, 0, 0], "size": [a, b], "mesh": [4, 4], "in_plane": "elastic"}
    else:
        part |= {"outline": [[0, 0], [a, 0], [a, b], [0, b]], "mesh": max(a, b) / 5}
    q = [between(rng, 0.05 * a, 0.2 * a), between(rng, 0.05 * b, 0.4 * b)]
    d = [between(rng, 0.75 * a, 0.95 * a), between(rng, 0.6 * b, 0.95 * b)]
    return {
        "materials": {"m": {"E": 2e13, "nu": 0.3, "rho": between(rng, 1500, 8000)}},
        "parts": {"p": part},
        "points": {"q": {"on": "p", "at": q}, "d": {"on": "p", "at": d}},
        "damping": {"ratio": 0.02},
    }


def _sides(draft: Draft) -> Floats:
    part = draft["parts"]["p"]
    return np.array(part["size"] if part["type"] == "plate" else part["outline"][2], float)


def _per_area(rng: np.random.Generator, draft: Draft) -> float:
    """Springs on which it moves at 4 to 8 Hz."""
    mass = sum(one.rho * one.thickness for one in plies(draft))
    return float(f"{mass * (2 * pi * rng.uniform(4, 8)) ** 2:.5g}")


def _mat(rng: np.random.Generator, draft: Draft, lossy: float = 0.4) -> Draft:
    """Below it, above, or at its middle."""
    k = _per_area(rng, draft)
    mat: Draft = {
        "type": "foundation", "on": "p", "region": "whole", "side": str(rng.choice(["below", "above", "middle"])),
        "stiffness": {"normal": k, "shear": k * between(rng, 0.5, 1.5)},
    }  # fmt: skip
    if rng.random() < lossy:
        mat["loss_factor"], draft["damping"] = between(rng, 0.06, 0.2), {"from": "materials"}
    draft["parts"]["mat"] = mat
    return mat


def _ways(rng: np.random.Generator, *places: str) -> list[str]:
    """Two axes of each place."""
    return [f"{place}.{one}" for place in places for one in rng.choice(["x", "y", "z"], 2, replace=False)]


@capability("any answer: stiff slabs on mats", "independent")
def _(rng: np.random.Generator) -> Case:
    """With openings, or mats that are smaller."""
    draft = _sheet(rng, "slab")
    part, (a, b) = draft["parts"]["p"], _sides(draft)
    mat = _mat(rng, draft)
    if rng.random() < 0.7:
        hole = {"rectangle": [between(rng, 0.4 * a, 0.5 * a), between(rng, 0.35 * b, 0.45 * b)]}
        part["holes"] = [hole | {"at": [between(rng, 0.4 * a, 0.6 * a), between(rng, 0.66 * b, 0.72 * b)]}]
        draft["points"]["q"]["at"][1], draft["points"]["d"]["at"][0] = 0.1 * b, 0.9 * a
        mat["region"] = {"rectangle": [between(rng, 0.5 * a, 0.9 * a), 0.36 * b], "at": [a / 2, 0.2 * b]}
    else:
        sides = (np.array([a, b]) * rng.uniform(0.6, 0.8, 2)).round(3)
        at = (sides / 2 + ([a, b] - sides) * rng.uniform(0.2, 0.8, 2)).round(3)
        mat["region"] = {"rectangle": sides.tolist(), "at": at.tolist()}
    return _answers(rng, draft, *_ways(rng, "q", "d"))


def _leaning(rng: np.random.Generator, kind: str) -> Case:
    """In space, held by springs along global axes beside a mat that is its own."""
    draft = _sheet(rng, kind)
    part, (a, b) = draft["parts"]["p"], _sides(draft)
    lean = between(rng, 0.4, 1.2)
    if rng.random() < 0.5:
        part |= {"normal": [0, lean, 1], "x_direction": [1, 0, 0]}
    else:
        part |= {"normal": [0, 0, 1], "x_direction": [1, lean, 0]}
    part["origin"] = rng.uniform(-2, 2, 3).round(3).tolist()
    if kind == "slab" and rng.random() < 0.5:
        part["offset"] = float(f"{rng.uniform(-0.4, 0.4):.4g}")
    part["thickness"] = between(rng, 0.012, 0.018)
    stiffness = _mat(rng, draft, 0.2)["stiffness"]
    stiffness["shear"] = stiffness["normal"] * between(rng, 0.1, 0.3)
    k = stiffness["normal"] * a * b
    sizes = {axis: float(f"{k * size:.4g}") for axis, size in zip("xyz", rng.uniform(0.1, 1.5, 3), strict=True)}
    draft["parts"]["post"] = {"type": "spring", "between": ["q", "ground"], "stiffness": sizes}
    return _answers(rng, draft, f"q.{rng.choice(['x', 'y'])}", "d.y")


@capability("any answer: stiff slabs that lean", "independent")
def _(rng: np.random.Generator) -> Case:
    return _leaning(rng, "slab")


@capability("any answer: stiff plates that lean", "independent")
def _(rng: np.random.Generator) -> Case:
    return _leaning(rng, "plate")


def _stacked(rng: np.random.Generator, kind: str) -> Case:
    """Two with a thick layer between, the lower on a mat."""
    draft = _sheet(rng, kind)
    part = draft["parts"]["p"]
    draft["parts"]["low"] = {**part, "origin": [0, 0, -between(rng, 0.5, 0.8)]}
    draft["points"]["r"] = {"on": "low", "at": draft["points"]["q"]["at"]}
    mat = _mat(rng, draft)
    mat |= {"on": "low", "side": "below"}
    draft["parts"]["layer"] = {"type": "foundation", "between": ["p", "low"], "stiffness": dict(mat["stiffness"])}
    if rng.random() < 0.5:
        part["origin"] = [0, 0, 0.1]
    return _answers(rng, draft, *_ways(rng, "q", "r"))


@capability("any answer: stiff slabs on each other", "independent")
def _(rng: np.random.Generator) -> Case:
    return _stacked(rng, "slab")


@capability("any answer: stiff plates on each other", "independent")
def _(rng: np.random.Generator) -> Case:
    return _stacked(rng, "plate")


def _laid(rng: np.random.Generator, kind: str) -> Case:
    """Of a panel of the library, or smeared, on a layer of the library or a mat."""
    of_library = bool(rng.random() < 0.6)
    draft = _sheet(rng, kind, 4.0 if of_library else 1.0)
    part = draft["parts"]["p"]
    del part["material"]
    if of_library:
        part["layers"] = {"like": str(rng.choice(list(CLT))), "of": "m"}
        del part["thickness"]
        E = [1e13, 4e12]
        draft["materials"]["m"] = {"E": E, "G": [4e12] * 3, "nu": 0.3, "rho": between(rng, 2000, 5000)}
        _mat(rng, draft)
    else:
        h, m = part["thickness"], between(rng, 300, 900)
        A = 1e12 * h
        part["smeared"] = {"D": [A * h**2 / 12] * 2 + [A * h**2 / 40] * 2, "S": [A / 4] * 2, "mass": m}
        part["smeared"]["A"] = [A, A, 0.3 * A, 0.3 * A]
        k = float(f"{m * (2 * pi * rng.uniform(4, 8)) ** 2:.5g}")
        draft["parts"]["mat"] = {
            "type": "foundation", "on": "p", "region": "whole", "side": str(rng.choice(["below", "middle", "above"])),
            "stiffness": {"normal": k, "shear": k * between(rng, 0.5, 1.5)},
        }  # fmt: skip
        del draft["materials"]
    return _answers(rng, draft, *_ways(rng, "q", "d"), accuracy=2e-3)


@capability("any answer: stiff slabs of panels and ribs", "independent")
def _(rng: np.random.Generator) -> Case:
    return _laid(rng, "slab")


@capability("any answer: stiff plates of panels and ribs", "independent")
def _(rng: np.random.Generator) -> Case:
    return _laid(rng, "plate")


@capability("any answer: stiff sheets on springs along edges", "independent")
def _(rng: np.random.Generator) -> Case:
    """And on a layer of the library that cannot shear; held in its plane."""
    kind = str(rng.choice(["plate", "slab"]))
    draft = _sheet(rng, kind)
    if kind == "plate":
        draft["parts"]["p"]["in_plane"] = "rigid"
    draft["supports"] = {"in plane": {"on": "p", "fix": ["x", "y"]}}
    k, size = _per_area(rng, draft), float(_sides(draft).min())
    lossy = rng.random() < 0.5
    for name in rng.permutation(list(_SIDES))[: rng.integers(2, 4)]:
        where = {"edge": str(name)} if kind == "plate" else {"set": _SIDES[str(name)]}
        one: Draft = {"on": "p", **where, "stiffness": {
            "z": float(f"{k * size * rng.uniform(0.1, 0.6):.4g}"),
            "about edge": float(f"{k * size**3 * rng.uniform(0.05, 0.3):.4g}"),
        }}  # fmt: skip
        if lossy:
            one["loss_factor"] = between(rng, 0.06, 0.2)
            draft["damping"] = {"from": "materials"}
        draft["supports"][str(name)] = one
    if rng.random() < 0.5:
        mat = {"type": "foundation", "on": "p", "region": "whole", "loss_factor": 0.1}
        draft["parts"]["mat"] = mat | {"like": str(rng.choice(list(LAYERS)))}
    return _answers(rng, draft, "q.z", "d.z")


@capability("any answer: plates glued to mats that shear", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Their edges on stiff springs. Rigid in their plane they bend less: the mat holds their lower face."""
    draft = _sheet(rng, "plate")
    part, made, (a, b) = draft["parts"]["p"], draft["materials"]["m"], _sides(draft)
    part["mesh"] = [16, 16]
    for name, share in (("q", (0.3, 0.45)), ("d", (0.6, 0.75))):
        draft["points"][name]["at"] = [between(rng, a * share[0], a * share[1]), between(rng, 0.3 * b, 0.7 * b)]
    D = made["E"] * part["thickness"] ** 3 / 12
    shear = 3 * made["E"] * part["thickness"] * (pi / min(a, b)) ** 2
    draft["parts"]["mat"] = {
        "type": "foundation", "on": "p", "region": "whole",
        "stiffness": {"normal": float(f"{D / a**4:.4g}"), "shear": float(f"{shear:.4g}")},
    }  # fmt: skip
    z = float(f"{D / a**3 * 1e3:.4g}")
    draft["supports"] = {name: {"on": "p", "edge": name, "stiffness": {"z": z}} for name in _SIDES}
    if rng.random() < 0.6:
        part["in_plane"] = str(rng.choice(["rigid", "elastic"]))
    else:
        del part["in_plane"]
        part["element"] = str(rng.choice(["hermite12", "bfs16"]))
    why = "16 cells a side, in their plane (k h)^2 / 24"
    return _answers(rng, draft, "q.z", "d.z", accuracy=5e-3, order=11, why=why)
