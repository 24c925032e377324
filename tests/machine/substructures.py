"""A block on legs that are matrices of another program or were reduced: any answer of it."""

from __future__ import annotations

import io
from collections.abc import Mapping
from functools import partial
from typing import Any, Final

import numpy as np
from scipy.io import mmwrite

from tests.independent.frames import Floats, Skeleton
from tests.independent.linear import Linear
from tests.machine.any_frame import linear
from tests.machine.bars import a_material, a_section
from tests.machine.columns import ANSWERS, Subject, case_of
from tests.machine.framework import Case, Model, capability
from tests.machine.plates import between
from tests.machine.skeletons import SIX, read

Draft = dict[str, Any]
_SAME: Final = "the same matrices, of legs that weigh a hundredth of the block; residual vectors, and rounding"
_ASIDE: Final = ("one-mass-dominates", "modal-mass-low", "implausible", "matrices", "reduced", "sags-far")


def _legs(rng: np.random.Generator) -> Draft:
    """Three legs under a block."""
    size = np.array([between(rng, 0.9, 1.2), between(rng, 0.9, 1.2), between(rng, 0.4, 0.6)])
    corner, height = rng.uniform(0.2, 0.5, 3).round(3), between(rng, 0.6, 0.9)
    heads = np.array([[0.2, 0.25, 0.0], [0.75, 0.2, 0.0], [0.45, 0.8, 0.0]]) * size + corner
    heads[:, 2] = height
    lines = []
    for head in heads.round(4):
        foot = head * [1, 1, 0] + np.array([*rng.uniform(-0.1, 0.1, 2).round(3), 0.0])
        lines.append([foot.tolist(), head.tolist()])
    block: Draft = {"type": "block", "mass": 1.0, "size": size.tolist(), "center": (size * 0.45).round(3).tolist()}
    block["origin"] = [float(corner[0]), float(corner[1]), height]
    draft: Draft = {
        "materials": {"m": a_material(rng)},
        "sections": {"s": a_section(rng)},
        "parts": {
            "legs": {"type": "frame", "material": "m", "section": "s", "mesh": 0.1, "lines": lines},
            "block": block,
        },
        "joints": {"j": {"connect": ["legs", "block"]}},
        "points": {
            "d": {"on": "block", "at": size.tolist()},
            "e": {"on": "block", "at": (size * [0.1, 0.9, 0.5]).round(3).tolist()},
        },
        "damping": {"ratio": 0.01},
    }
    for k, (foot, _) in enumerate(lines):
        draft["points"][f"foot {k}"] = {"on": "legs", "at": foot}
        draft.setdefault("supports", {})[f"floor {k}"] = {"at": f"foot {k}", "fix": "clamped"}
    block["mass"] = float(f"{100 * draft['materials']['m']['rho'] * 3 * height * 0.004:.4g}")
    block["inertia"] = (0.1 * block["mass"] * rng.uniform(0.8, 1.2, 3)).round(2).tolist()
    return draft


def _answers(rng: np.random.Generator, draft: Draft, form: Any, answers: tuple[str, ...], **more: Any) -> Case:
    ways = [f"{place}.{rng.choice(['x', 'y', 'z'])}" for place in "de"]
    return case_of(rng, Subject(draft, form, ways[:1], ways, 1e-4, _SAME, aside=_ASIDE, answers=answers, **more))


def _losing(rng: np.random.Generator, draft: Draft) -> tuple[str, ...]:
    """Half of the draws lose in the legs; which answers are asked then."""
    if rng.random() < 0.5:
        return ANSWERS
    draft["parts"]["legs"]["loss_factor"] = between(rng, 0.06, 0.15)
    draft["damping"] = {"from": "materials"}
    return ("losses", "frf", "vibration")


@capability("substructures: a block on legs of a frame", "independent")
def _(rng: np.random.Generator) -> Case:
    return _answers(rng, _legs(rng), lambda model: linear(*read(model)), ANSWERS)


def _by_parts(rng: np.random.Generator, draft: Draft, legs: Draft) -> tuple[Draft, Floats]:
    """The model with such legs, shifted by some way from where their file has them; their heads reach into the block:
    they do so when they are moved a little."""
    way = rng.uniform(0.2, 0.6, 3).round(3)
    block = draft["parts"]["block"]
    block = {**block, "origin": (np.array(block["origin"]) + way - [0.0, 0.0, 0.1]).round(6).tolist()}
    taker: Draft = {
        "parts": {"legs": {**legs, "origin": way.tolist()}, "block": block},
        "joints": draft["joints"],
        "points": {name: one for name, one in draft["points"].items() if one["on"] == "block"},
        "damping": {"ratio": 0.01},
    }
    return taker, way


def _reduced_form(model: Model, whole: Model) -> Linear:
    """As of the frame that was reduced, moved."""
    legs, frame = model["parts"]["legs"], whole["parts"]["legs"]
    moved = {**whole, "damping": model["damping"], "parts": {**model["parts"]}, "points": dict(model["points"])}
    lines = [(np.array(line) + legs["origin"]).tolist() for line in frame["lines"]]
    moved["parts"]["legs"] = {**frame, "lines": lines}
    moved["materials"] = {"m": {**whole["materials"]["m"], "loss_factor": legs.get("loss_factor", 0.0)}}
    for k, line in enumerate(lines):
        moved["points"][f"foot {k}"] = {"on": "legs", "at": line[0]}
    return linear(*read(moved))


@capability("substructures: a block on reduced legs", "independent")
def _(rng: np.random.Generator) -> Case:
    whole = _legs(rng)
    draft, _ = _by_parts(rng, whole, {"type": "reduced", "file": "legs.npz"})
    draft["supports"] = {name: {"on": "legs", "set": name, "fix": "clamped"} for name in whole["supports"]}
    answers = _losing(rng, draft)
    reduce = ("reduce", "whole.yaml", "--part", "legs", "-o", "legs.npz", "--count", "30")
    return _answers(rng, draft, partial(_reduced_form, whole=whole), answers, beside=lambda _: {"whole": whole},
                    first=(reduce,))  # fmt: skip


def _in_unit(matrix: Floats, unit: float) -> Floats:
    """Of metres from a matrix whose shifts are in a unit of length, its forces in newtons."""
    factor = np.tile([1 / unit] * 3 + [1.0] * 3, len(matrix) // 6)
    return unit * matrix * np.outer(factor, factor)


def _matrices(draft: Draft, unit: float) -> tuple[Floats, Floats, Floats]:
    """Stiffness and mass of the legs alone, and places, in a unit of length."""
    alone = {**draft, "parts": {"legs": draft["parts"]["legs"]}, "points": {}, "joints": {}, "supports": {}}
    bones, _ = read(alone, order=3)
    K, M = (_in_unit(bones.matrix(kind), 1 / unit) for kind in "KM")
    return K, M, np.array(bones.at) / unit


def _texts(K: Floats, M: Floats, places: Floats) -> Mapping[str, str]:
    rows = [f"{n + 1},{x!r},{y!r},{z!r},{one}" for n, (x, y, z) in enumerate(places.tolist()) for one in SIX]
    texts = {"legs.csv": "\n".join(["node,x,y,z,direction", *rows, ""])}
    for letter, matrix in (("K", K), ("M", M)):
        out = io.BytesIO()
        mmwrite(out, matrix, precision=17)
        texts[f"legs.{letter}.mtx"] = out.getvalue().decode("ascii")
    return texts


def _matrices_form(model: Model, K: Floats, M: Floats, places: Floats) -> Linear:
    part, block = model["parts"]["legs"], model["parts"]["block"]
    bones = Skeleton()
    at = part["scale"] * places + part["origin"]
    nodes = [bones.place(one) for one in at]
    for kind, matrix in (("K", K), ("M", M), ("H", part.get("loss_factor", 0.0) * K)):
        bones.add(kind, nodes, _in_unit(matrix, part["scale"]))
    low = np.array(block["origin"])
    body = bones.place(low + block["center"])
    bones.body(body, block["mass"], np.diag(block["inertia"]))
    feet = np.array(model["supports"]["floor"]["box"])
    for node, place in zip(nodes, at, strict=True):
        if ((place > feet[0]) & (place < feet[1])).all():
            bones.hold(node)
        elif ((place > low) & (place < low + block["size"])).all():
            bones.follow(body, node)
    points = {}
    for name, one in model["points"].items():
        points[name] = bones.place(low + one["at"])
        bones.follow(body, points[name])
    return linear(bones, points)


@capability("substructures: a block on legs of matrices", "independent")
def _(rng: np.random.Generator) -> Case:
    whole = _legs(rng)
    unit = float(rng.choice([1e-3, 0.5, 0.0254]))
    K, M, places = _matrices(whole, unit)
    legs: Draft = {"type": "matrices", "file": {"K": "legs.K.mtx", "M": "legs.M.mtx"}, "nodes": "legs.csv"}
    draft, way = _by_parts(rng, whole, {**legs, "scale": unit})
    foot = float(way[2])
    draft["supports"] = {"floor": {"on": "legs", "box": [[-9.0, -9.0, -9.0], [9.0, 9.0, foot + 0.1]], "fix": "clamped"}}
    answers = _losing(rng, draft)
    form = partial(_matrices_form, K=K, M=M, places=places)
    return _answers(rng, draft, form, answers, beside=lambda _: _texts(K, M, places))
