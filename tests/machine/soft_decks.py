"""Decks that give way in one manner: bars that slip on slabs, boards that slip, decks soft in shear or in their plane,
slabs held over a strip; any answer of each."""

from __future__ import annotations

import copy
from functools import partial
from math import pi
from typing import Any

import numpy as np

from tests.independent.linear import Floats, Linear
from tests.machine.any_sheet import ASIDE, a_plate
from tests.machine.columns import Ask, Subject, case_of
from tests.machine.framework import Case, Model, capability
from tests.machine.plates import between
from tests.machine.sheets import read

Draft = dict[str, Any]


def _rod(model: Model) -> Linear:
    """A bar that moves along itself on springs per length: cosines, which are free at its ends."""
    part, made, of = model["parts"]["f"], model["materials"]["m"], model["sections"]["s"]
    start, end = np.array(part["lines"][0], float)
    L = float(np.linalg.norm(end - start))
    along, A, n = (end - start) / L, of["width"] * of["height"], np.arange(12)
    joint = model["joints"]["screws"]
    slip = float(joint["slip"].split()[0]) * joint.get("width", 1.0)
    mean = np.where(n > 0, 0.5, 1.0)
    K, M = (slip + made["E"] * A * (n * pi / L) ** 2) * mean * L, made["rho"] * A * mean * L
    rows = {}
    for name, point in model["points"].items():
        if point["on"] == "f":
            shape = np.cos(n * pi * float((np.array(point["at"]) - start) @ along) / L)
            rows |= {(name, axis): shape * along[k] for k, axis in enumerate("xyz")}
    rides = np.outer(along, made["rho"] * A * L * (n == 0))
    none = np.zeros((len(n), len(n)))
    return Linear(np.diag(K), np.diag(M), none, none, rows, rides)


@capability("any answer: a bar that slips on a slab", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """The slab is held; it leans, so that the bar weighs along itself."""
    slope = between(rng, 0.2, 0.6)
    a, b = between(rng, 1.0, 1.5), between(rng, 0.5, 0.8)
    x = np.array([1.0, 0, -slope]) / np.hypot(1, slope)
    normal = np.array([slope, 0, 1.0]) / np.hypot(1, slope)
    ends = [(x * a * share + np.array([0, b / 2, 0])).tolist() for share in (0.0, 1.0)]
    rho, sides = between(rng, 2000, 8000), rng.uniform(0.05, 0.08, 2).round(3)
    slip = float(f"{rho * sides.prod() * (2 * pi * rng.uniform(5, 10)) ** 2:.5g}")
    screws: Draft = {"connect": ["f", "p"], "kind": "sliding"}
    screws |= {"slip": f"{slip / 0.04} N/m^3", "width": 0.04} if rng.random() < 0.7 else {"slip": f"{slip} N/m^2"}
    draft: Draft = {
        "materials": {"m": {"E": 2e11, "nu": 0.3, "rho": rho}},
        "sections": {"s": {"shape": "rectangle", "width": float(sides[0]), "height": float(sides[1])}},
        "parts": {
            "p": {"type": "slab", "outline": [[0, 0], [a, 0], [a, b], [0, b]], "mesh": b / 4, "material": "m",
                  "thickness": 0.05, "normal": normal.tolist(), "x_direction": x.tolist()},
            "f": {"type": "frame", "material": "m", "section": "s", "lines": [ends], "mesh": b / 4},
        },
        "joints": {"screws": screws},
        "points": {"d": {"on": "f", "at": ends[0]}, "q": {"on": "f", "at": ends[1]}},
        "supports": {"held": {"on": "p", "fix": ["x", "y", "z", "rx", "ry", "rz"]}},
        "damping": {"ratio": 0.02},
    }  # fmt: skip
    why = "the bar stretches by a thousandth of what it slips; lines of vibration"
    # Of two modes: beyond them it bends and turns between the nodes that the joint holds.
    return case_of(rng, Subject(draft, _rod, ("d.x",), ("q.x", "q.z"), 1e-3, why, count=2))


def _finer(model: Model, ask: Ask) -> Floats:
    """Extrapolated from the mesh and one of half its side."""
    fine: Any = copy.deepcopy(model)
    for part in fine["parts"].values():
        if "mesh" in part:
            part["mesh"] = [2 * one for one in part["mesh"]] if part["type"] == "plate" else part["mesh"] / 2
    return np.asarray((4 * np.asarray(ask(fine)) - np.asarray(ask(model))) / 3)


@capability("any answer: plates of boards", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    draft = a_plate(rng, ("simple", "clamped"))
    part = draft["parts"]["p"]
    each = [part.pop("material"), part.pop("thickness") / 2]
    part["layers"] = {"boards": [each, list(each)], "bond": between(rng, 0.6, 0.9)}
    why = "16 cells a side and polynomials of order 11: below 2e-3"
    form = partial(read, order=11)
    return case_of(rng, Subject(draft, form, ("d.z",), ("q.z",), 2e-3, why, aside=ASIDE, pushed=False))


def _deck(rng: np.random.Generator, kind: str, soft: str) -> Case:
    """Smeared, held all around; what is soft in its plane stands upright, so that it sags."""
    a, b, m, h = between(rng, 1.0, 1.5), between(rng, 1.0, 1.5), between(rng, 100, 300), 0.05
    least = float(f"{m * (rng.uniform(20, 30) * a) ** 2:.4g}")
    A, S, D = (least * (1.0 if soft == one else 20.0) for one in ("A", "S", "D"))
    part: Draft = {"type": kind, "thickness": h, "smeared": {
        "D": [D * a**2 / 10, D * a**2 / 10 * between(rng, 0.6, 1), D * a**2 / 40, D * a**2 / 30],
        "S": [S, S * between(rng, 0.6, 1)], "mass": m, "A": [A, A * between(rng, 0.6, 1), A * 0.25, A * 0.35],
    }}  # fmt: skip
    if kind == "plate":
        part |= {"origin": [0, 0, 0], "size": [a, b], "mesh": [14, 14], "in_plane": "elastic"}
    else:
        part |= {"outline": [[0, 0], [a, 0], [a, b], [0, b]], "mesh": max(a, b) / 10}
    if soft == "A":
        part |= {"normal": [0, -1, 0], "x_direction": [1, 0, 0]}
    sides = {"side 1": "y0", "side 2": "x1", "side 3": "y1", "side 4": "x0"}
    draft: Draft = {"parts": {"p": part}, "damping": {"ratio": 0.02}, "points": {
        "q": {"on": "p", "at": [0.4 * a, 0.45 * b]}, "d": {"on": "p", "at": [0.65 * a, 0.6 * b]},
    }}  # fmt: skip
    draft["supports"] = {
        edge: {"on": "p", **({"edge": edge} if kind == "plate" else {"set": side}), "fix": "clamped"}
        for side, edge in sides.items()
    }
    if kind == "slab":
        part["through"] = [point["at"] for point in draft["points"].values()]
        for one in draft["supports"].values():
            one["fix"] = "simple hard"
    if rng.random() < 0.4:
        part["smeared"]["loss_factor"], draft["damping"] = between(rng, 0.06, 0.12), {"from": "materials"}
    why = "10 or 14 cells a side and twice as many, extrapolated, and polynomials of order 7: below 3e-3"
    form, aside = partial(read, order=7), (*ASIDE, "layers-shear")
    return case_of(rng, Subject(draft, form, ("d.z",), ("q.z",), 3e-3, why, _finer, aside, pushed=False))


@capability("any answer: plates soft in their plane", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _deck(rng, "plate", "A")


@capability("any answer: slabs soft in their plane", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _deck(rng, "slab", "A")


@capability("any answer: slabs soft in shear", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _deck(rng, "slab", "S")


def _behind(model: Model, order: int) -> Linear:
    """The slab beyond the last line of nodes in a box, clamped there."""
    short: Any = copy.deepcopy(model)
    part = short["parts"]["p"]
    held = short["supports"]
    box = held["strip"]["box"] if "strip" in held else short["constraints"]["strip"]["to"]["box"]
    end = max(x for x, _ in part["through"] if x <= box[1][0])
    a, b = part["outline"][2]
    part["outline"] = [[0, 0], [a - end, 0], [a - end, b], [0, b]]
    short["points"] = {name: {"on": "p", "at": [short["points"][name]["at"][0] - end, short["points"][name]["at"][1]]}
                       for name in "qd"}  # fmt: skip
    short["parts"] = {"p": part}
    short |= {"supports": {"x0": {"on": "p", "set": "side 4", "fix": "clamped"}}, "constraints": {}}
    return read(short, order)


@capability("any answer: slabs held over a strip", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """In a box, by a support or by arms to a body that stands still."""
    a, b = between(rng, 1.0, 1.5), between(rng, 0.4, 0.6)
    x, y = 0.3 * a, 0.4 * b
    points = {"q": [0.6 * a, y], "d": [0.8 * a, y]}
    h = float(f"{a / rng.uniform(25, 40):.4g}")
    part: Draft = {"type": "slab", "outline": [[0, 0], [a, 0], [a, b], [0, b]], "mesh": a / 20, "material": "m",
                   "thickness": h, "through": [[x, y], [1.1 * x, y], *points.values()]}  # fmt: skip
    box = [[-1, -1, -1], [1.01 * x, b + 1, 1]]
    draft: Draft = {
        "materials": {"m": {"E": 1e10, "nu": 0.25, "rho": between(rng, 500, 3000)}},
        "parts": {"p": part},
        "points": {name: {"on": "p", "at": at} for name, at in points.items()},
        "supports": {"strip": {"on": "p", "box": box, "fix": "clamped"}},
        "damping": {"ratio": 0.02},
    }  # fmt: skip
    if rng.random() < 0.5:
        draft["parts"]["b"] = {"type": "block", "mass": 10.0, "origin": [-1, 0, 0], "size": [0.2, 0.2, 0.2]}
        draft["points"]["c"] = {"on": "b", "at": [0.1, 0.1, 0.1]}
        draft["supports"] = {"body": {"at": "c", "fix": "clamped"}}
        draft["constraints"] = {"strip": {"rigid": "c", "to": {"on": "p", "box": box}}}
    why = "20 and 40 cells a side, extrapolated, wider than what twists at free edges: below 6e-3"
    form = partial(_behind, order=9)
    aside, answers = (*ASIDE, "nothing-moves"), ("modes", "statics", "frf", "vibration")
    subject = Subject(
        draft, form, ("d.z",), ("q.z",), 6e-3, why, _finer, aside, answers=answers, pushed=False
    )  # fmt: skip
    return case_of(rng, subject)


@capability("any answer: a body that rests on a region", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """It moves up and down as what it rests on does on the average."""
    draft = a_plate(rng, ("simple", "clamped"))
    part, made = draft["parts"]["p"], draft["materials"]["m"]
    a, b = part["size"]
    at = [between(rng, 0.25 * a, 0.35 * a), between(rng, 0.25 * b, 0.35 * b)]
    region: Draft = {"on": "p", "rectangle": [between(rng, 0.2 * a, 0.3 * a), 0.3 * b], "at": at}
    mass = float(f"{made['rho'] * part['thickness'] * a * b * rng.uniform(4, 6):.4g}")
    draft["parts"]["body"] = {"type": "block", "mass": mass, "origin": [*at, 0.1], "size": [1, 1, 1]}
    draft["points"]["foot"] = {"on": "body", "at": [0, 0, 0]}
    draft["points"]["q"]["at"] = [0.45 * a, 0.45 * b]
    draft["supports"]["upright"] = {"at": "foot", "fix": ["x", "y", "rx", "ry", "rz"]}
    draft["constraints"] = {"rests": {"average": "foot", "of": region, "directions": ["z"]}}
    form, why = partial(read, order=15), "16 cells a side, and polynomials of order 15 across edges of the region"
    return case_of(rng, Subject(draft, form, ("d.z",), ("q.z",), 2e-3, why, aside=ASIDE, pushed=False))
