"""Plates and slabs with all that acts on them: any answer of each."""

from __future__ import annotations

import copy
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial
from math import pi
from typing import Any

import numpy as np

from tests.independent.linear import Floats, Linear
from tests.machine.columns import ANSWERS, Ask, Subject, as_it_is, case_of
from tests.machine.framework import Case, Door, Model, capability
from tests.machine.plates import between, edges, material, plies
from tests.machine.sheets import read

Draft = dict[str, Any]
_THIN = "16 cells a side and polynomials of order 11: below 2e-3"
_THICK = "cells of a third and a sixth, extrapolated, polynomials of order 11: below 4e-3"
_KINK = "16 cells a side, and polynomials of order 17 and more across a line where the shear force jumps"
ASIDE = (
    "thick-for-short-waves",
    "coarse-mesh",
    "modal-mass-low",
    "stress-uneven",
    "thick-plate",
    "sags-far",
    "few-elastic",
)
_SIDE = {"y0": "side 1", "x1": "side 2", "y1": "side 3", "x0": "side 4"}


def _refined(model: Model, ask: Ask) -> Floats:
    """Extrapolated from meshes of a third and a sixth of the cells' side."""
    found = []
    for times in (3, 6):
        finer: Any = copy.deepcopy(model)
        for part in finer["parts"].values():
            if part["type"] == "slab":
                part["mesh"] /= times
        found.append(ask(finer))
    return np.asarray((4 * found[1] - found[0]) / 3)


class _NotSettled(Exception):
    """The polynomials of the reference are not enough for a draw."""


def _settled(draw: Callable[[np.random.Generator], Case]) -> Callable[[np.random.Generator], Case]:
    """Draws until one is settled."""

    def drawn(rng: np.random.Generator) -> Case:
        for _ in range(20):
            with suppress(_NotSettled):
                return draw(rng)
        raise ValueError("20 draws whose reference is not settled")

    return drawn


def _answers(
    rng: np.random.Generator, draft: Draft, *ways: str, accuracy: float = 2e-3, order: int = 11, why: str = _THIN,
    reading: Callable[..., Linear] = read, answers: tuple[str, ...] = ANSWERS,
) -> Case:  # fmt: skip
    """Of places `ways` under a force at d; polynomials of two orders less agree to a quarter of the tolerance."""
    thick = any(part["type"] == "slab" for part in draft["parts"].values())
    refine = _refined if thick else as_it_is
    cases = []
    for less in (2, 0):
        form = partial(reading, order=order - less)
        subject = Subject(copy.deepcopy(draft), form, ("d.z",), ways, accuracy, why, refine, ASIDE,
                          answers=answers, pushed=not thick)  # fmt: skip
        cases.append(case_of(copy.deepcopy(rng) if less else rng, subject))
    rough, fine = (np.asarray(one.right(cases[1].model, Door())) for one in cases)
    size = np.abs(fine) if cases[1].each else np.abs(fine).max()
    if rough.shape != fine.shape or (np.abs(rough - fine) > 0.25 * cases[1].tolerance * size).any():
        raise _NotSettled
    return cases[1]


def _lean(rng: np.random.Generator, part: Draft) -> None:
    """In space, not far from level."""
    n = np.array([*rng.uniform(-0.5, 0.5, 2), 1.0])
    x = np.array([1.0, *rng.uniform(-0.4, 0.4, 2)])
    part |= {"normal": n.tolist(), "x_direction": (x - (x @ n) / (n @ n) * n).tolist()}
    part["origin"] = rng.uniform(-2, 2, 3).round(3).tolist()


def a_plate(rng: np.random.Generator, kinds: tuple[str, ...] = ("simple", "clamped", "free")) -> Draft:
    a, b = between(rng, 1.0, 2.0), between(rng, 1.0, 2.0)
    h = float(f"{a / rng.uniform(60, 150):.4g}")
    part = {"type": "plate", "origin": [0, 0, 0], "size": [a, b], "mesh": [16, 16], "in_plane": "rigid",
            "material": "m", "thickness": h}  # fmt: skip
    q = [between(rng, 0.3 * a, 0.45 * a), between(rng, 0.3 * b, 0.7 * b)]
    d = [between(rng, 0.6 * a, 0.75 * a), between(rng, 0.3 * b, 0.7 * b)]
    held = edges(rng, kinds)
    return {
        "materials": {"m": material(rng, False)},
        "parts": {"p": part},
        "points": {"q": {"on": "p", "at": q}, "d": {"on": "p", "at": d}},
        "supports": {name: {"on": "p", "edge": name, "fix": how} for name, how in held.items() if how != "free"},
        "damping": {"ratio": 0.01},
    }


def _stiff(draft: Draft, share: float) -> float:
    """Springs per area that are worth that share of the first mode's stiffness."""
    form = read(draft)
    mass = sum(one.rho * one.thickness for one in plies(draft))
    return float(f"{mass * (2 * pi * form.modes(1)[0][0]) ** 2 * share:.4g}")


def _losing(rng: np.random.Generator, draft: Draft) -> Draft:
    for one in draft["materials"].values():
        one["loss_factor"] = between(rng, 0.06, 0.12)
    draft["damping"] = {"from": "materials"}
    return draft


@capability("any answer: plates in space", "independent")
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = a_plate(rng)
    _lean(rng, draft["parts"]["p"])
    return _answers(rng, draft, "q.z")


@capability("any answer: plates of timber", "independent")
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = a_plate(rng, ("simple", "clamped"))
    draft["materials"]["m"] = material(rng, True)
    part = draft["parts"]["p"]
    part["layers"] = [[part.pop("material"), part.pop("thickness"), f"{between(rng, -90, 90)} deg"]]
    return _answers(rng, draft, "q.z")


@capability("any answer: plates of smeared ribs", "independent")
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = a_plate(rng)
    part = draft["parts"]["p"]
    made, h = draft["materials"].pop(part.pop("material")), part["thickness"]
    del draft["materials"]
    D = made["E"] * h**3 / 10
    part["smeared"] = {
        "D": [D, D * between(rng, 0.2, 1), D * between(rng, 0.05, 0.3), D * between(rng, 0.1, 0.4)],
        "S": [D * 1e3, D * 1e3], "mass": made["rho"] * h, "loss_factor": between(rng, 0.06, 0.12),
    }  # fmt: skip
    if rng.random() < 0.4:
        draft["damping"] = {"from": "materials"}
    return _answers(rng, draft, "q.z")


@capability("any answer: plates on springs over regions", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = a_plate(rng)
    a, b = draft["parts"]["p"]["size"]
    kind = str(rng.choice(["whole", "rectangle", "rim", "line"]))
    sx, sy = between(rng, 0.3 * a, 0.6 * a), between(rng, 0.3 * b, 0.6 * b)
    at = [between(rng, sx / 2, a - sx / 2), between(rng, sy / 2, b - sy / 2)]
    x = between(rng, 0.3 * a, 0.7 * a)
    region: Any = {"whole": "whole", "rectangle": {"rectangle": [sx, sy], "at": at}, "rim": {"rim": [sx, sy], "at": at},
                   "line": {"line": [[x, 0.0], [x, b]]}}[kind]  # fmt: skip
    k = _stiff(draft, rng.uniform(0.5, 2)) * {"rim": a / 4, "line": a}.get(kind, 1.0)
    loss = between(rng, 0.1, 0.3)
    draft["parts"]["mat"] = {
        "type": "foundation", "on": "p", "region": region, "stiffness": {"normal": k}, "loss_factor": loss,
    }  # fmt: skip
    if rng.random() < 0.5:
        _losing(rng, draft)
    else:
        del draft["parts"]["mat"]["loss_factor"]
    return _answers(rng, draft, "q.z", accuracy=4e-3, order=17, why=_KINK)


@capability("any answer: masses over regions of plates", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = a_plate(rng)
    part = draft["parts"]["p"]
    a, b = part["size"]
    weigh = draft["materials"]["m"]["rho"] * part["thickness"]
    kind = str(rng.choice(["whole", "rectangle", "line"]))
    sx, sy = between(rng, 0.3 * a, 0.6 * a), between(rng, 0.3 * b, 0.6 * b)
    at = [between(rng, sx / 2, a - sx / 2), between(rng, sy / 2, b - sy / 2)]
    x = between(rng, 0.3 * a, 0.7 * a)
    mass: Draft = {"type": "mass", "on": "p"}
    if kind == "line":
        mass |= {"region": {"line": [[x, 0.0], [x, b]]}, "mass": f"{weigh * a * between(rng, 0.5, 1):.4g} kg/m"}
    elif kind == "rectangle":
        mass |= {
            "region": {"rectangle": [sx, sy], "at": at},
            "mass": float(f"{weigh * a * b * between(rng, 0.5, 1):.4g}"),
        }
    else:
        mass |= {"mass": f"{weigh * between(rng, 0.5, 1):.4g} kg/m^2"}
    draft["parts"]["load"] = mass
    return _answers(rng, draft, "q.z", accuracy=4e-3, order=17, why=_KINK)


@capability("any answer: plates on elastic edges", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = a_plate(rng)
    part, made = draft["parts"]["p"], draft["materials"]["m"]
    a = part["size"][0]
    D = made["E"] * part["thickness"] ** 3 / 12 / (1 - made["nu"] ** 2)
    draft["supports"] = {
        name: {"on": "p", "edge": name, "stiffness": {
            "z": float(f"{D / a**3 * 10 ** rng.uniform(1.3, 2.3):.4g}"),
            "about edge": float(f"{D / a * 10 ** rng.uniform(0, 0.7):.4g}"),
        }} for name in ("x0", "x1", "y0", "y1")
    }  # fmt: skip
    draft["supports"]["in plane"] = {"on": "p", "edge": "x0", "fix": ["x", "y"]}
    if rng.random() < 0.6:
        for one in draft["supports"].values():
            if "stiffness" in one:
                one["loss_factor"] = between(rng, 0.1, 0.3)
        _losing(rng, draft)
    return _answers(rng, draft, "q.z")


@capability("any answer: plates over a wall", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = a_plate(rng, ("simple", "clamped"))
    a, b = draft["parts"]["p"]["size"]
    x = between(rng, 0.4 * a, 0.6 * a)
    draft["supports"]["wall"] = {"on": "p", "line": [[x, 0.0], [x, b]], "fix": "simple"}
    draft["points"]["q"]["at"][0] = between(rng, 0.15 * a, 0.25 * a)
    return _answers(rng, draft, "q.z", accuracy=5e-3, order=21, why=_KINK)


def _above(rng: np.random.Generator) -> Draft:
    """A second plate below the first, held in its plane alone."""
    draft = a_plate(rng, ("simple", "clamped"))
    part = draft["parts"]["p"]
    low: Draft = {**copy.deepcopy(part), "material": "n", "origin": [0, 0, -between(rng, 0.1, 0.3)]}
    low["thickness"] *= between(rng, 0.8, 1.3)
    draft["materials"]["n"] = material(rng, False)
    draft["parts"]["low"] = low
    draft["supports"]["in plane"] = {"on": "low", "edge": "x0", "fix": ["x", "y"]}
    draft["points"]["r"] = {"on": "low", "at": draft["points"]["q"]["at"]}
    return draft


def _alone(draft: Draft) -> Draft:
    """The first plate without the second."""
    held = {name: one for name, one in draft["supports"].items() if one["on"] == "p"}
    parts, points = {"p": draft["parts"]["p"]}, {name: draft["points"][name] for name in "qd"}
    return {**draft, "parts": parts, "points": points, "supports": held}


@capability("any answer: two plates with a layer between", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = _above(rng)
    k = _stiff(_alone(draft), rng.uniform(0.5, 2))
    layer: Draft = {"type": "foundation", "between": ["p", "low"], "stiffness": {"normal": k}}
    draft["parts"]["layer"] = layer
    if rng.random() < 0.5:
        _losing(rng, draft)
        layer["loss_factor"] = between(rng, 0.1, 0.3)
    return _answers(rng, draft, "q.z", "r.z")


@capability("any answer: a ceiling on hangers", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = _above(rng)
    part = draft["parts"]["p"]
    a, b = part["size"]
    k = _stiff(_alone(draft), rng.uniform(0.1, 0.3))  # soft: no deep kinks at pieces
    hung: Draft = {"type": "hangers", "between": ["p", "low"]}
    weigh = draft["materials"]["n"]["rho"] * draft["parts"]["low"]["thickness"]
    kind = str(rng.choice(["spacing", "at", "along"]))
    sx, sy = between(rng, 0.2 * a, 0.3 * a), between(rng, 0.2 * b, 0.3 * b)
    if kind == "along":
        hung |= {"along": str(rng.choice(["x", "y"])), "spacing": sx, "stiffness": {"normal": f"{k * sx:.4g} N/m^2"}}
        hung["mass"] = f"{weigh * sx * 0.2:.4g} kg/m"
    else:
        hung |= {"stiffness": {"normal": float(f"{k * sx * sy:.4g}")}, "mass": float(f"{weigh * sx * sy * 0.2:.4g}")}
        places = [[x * a, y * b] for x in (0.2, 0.75) for y in (0.15, 0.5, 0.8)]
        hung |= {"spacing": [sx, sy]} if kind == "spacing" else {"at": np.round(places, 3).tolist()}
    draft["parts"]["hung"] = hung
    if rng.random() < 0.5:
        _losing(rng, draft)
        hung["loss_factor"] = between(rng, 0.1, 0.3)
    return _answers(rng, draft, "q.z", "r.z", accuracy=4e-3, order=17, why=_KINK)


def _slab(rng: np.random.Generator, slender: float = 15.0) -> Draft:
    """Its edges held at random; slender : its side over its thickness, or up to twice."""
    a, b = between(rng, 1.0, 2.0), between(rng, 1.0, 2.0)
    h = float(f"{a / rng.uniform(slender, 2 * slender):.4g}")
    part: Draft = {"type": "slab", "outline": [[0, 0], [a, 0], [a, b], [0, b]], "mesh": max(a, b) / 8,
                   "material": "m", "thickness": h}  # fmt: skip
    q = [between(rng, 0.3 * a, 0.45 * a), between(rng, 0.3 * b, 0.7 * b)]
    d = [between(rng, 0.6 * a, 0.75 * a), between(rng, 0.3 * b, 0.7 * b)]
    part["through"] = [q, d]
    held = edges(rng, ("simple", "simple hard", "clamped", "free"))
    while sum(how == "free" for how in held.values()) > 2:
        held = edges(rng, ("simple", "simple hard", "clamped", "free"))
    return {
        "materials": {"m": material(rng, False)},
        "parts": {"p": part},
        "points": {"q": {"on": "p", "at": q}, "d": {"on": "p", "at": d}},
        "supports": {name: {"on": "p", "set": _SIDE[name], "fix": how} for name, how in held.items() if how != "free"},
        "damping": {"ratio": 0.01},
    }


@capability("any answer: slabs in space", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = _slab(rng)
    part = draft["parts"]["p"]
    _lean(rng, part)
    part["offset"] = float(f"{part['thickness'] * rng.uniform(-1, 1):.4g}")
    return _answers(rng, draft, "q.z", "q.x", accuracy=4e-3, why=_THICK)


@capability("any answer: slabs of smeared ribs", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = _slab(rng)
    part = draft["parts"]["p"]
    made, h = draft["materials"].pop(part.pop("material")), part["thickness"]
    part["mesh"] *= 2 / 3  # what an offset moves in its plane is small
    del draft["materials"]
    D, A = made["E"] * h**3 / 10, made["E"] * h
    part["smeared"] = {
        "D": [D, D * between(rng, 0.2, 1), D * between(rng, 0.05, 0.3), D * between(rng, 0.1, 0.4)],
        "S": [A * between(rng, 0.03, 0.2), A * between(rng, 0.03, 0.2)], "mass": made["rho"] * h,
        "A": [A, A * between(rng, 0.2, 1), A * between(rng, 0.05, 0.3), A * between(rng, 0.1, 0.4)],
        "loss_factor": between(rng, 0.06, 0.12),
    }  # fmt: skip
    part["offset"] = float(f"{h * rng.uniform(0.5, 1):.4g}")
    if rng.random() < 0.4:
        draft["damping"] = {"from": "materials"}
    return _answers(rng, draft, "q.z", "q.x", accuracy=4e-3, why=_THICK)


@capability("any answer: slabs on sheared mats", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    """Free but for springs below or above it, that shear."""
    draft = _slab(rng)
    part, made = draft["parts"]["p"], draft["materials"]["m"]
    draft["supports"] = {}
    h, a = part["thickness"], part["outline"][1][0]
    if rng.random() < 0.5:  # tilted: its weight runs along it
        _lean(rng, part)
    k = float(f"{made['E'] * h**3 / a**4 * 10 ** rng.uniform(0, 1):.4g}")
    draft["parts"]["mat"] = {
        "type": "foundation", "on": "p", "stiffness": {"normal": k, "shear": k * between(rng, 0.2, 1)},
        "side": str(rng.choice(["below", "above", "middle"])), "region": "whole",
    }  # fmt: skip
    if rng.random() < 0.6:
        draft["parts"]["mat"]["loss_factor"] = between(rng, 0.1, 0.3)
        _losing(rng, draft)
    return _answers(rng, draft, "q.z", "q.x", accuracy=4e-3, why=_THICK)


@capability("any answer: slabs of layers", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = _slab(rng, 80.0)  # shear of layers by 5/6 of their moduli is the program's nearly
    part = draft["parts"]["p"]
    h, core = part.pop("thickness"), part.pop("material")
    draft["materials"]["n"] = material(rng, True)
    draft["materials"]["m"]["E"] = float(f"{10 ** rng.uniform(9.7, 10.3):.4g}")
    turn = f"{between(rng, 0, 90)} deg"
    part["layers"] = [["n", float(f"{h * rng.uniform(0.2, 0.6):.4g}"), turn], [core, float(f"{h / 2:.4g}")]]
    if rng.random() < 0.5:
        _losing(rng, draft)
    return _answers(rng, draft, "q.z", accuracy=5e-3, why=_THICK)


def _by_frequency(model: Model, order: int) -> Linear:
    """A plate of one material whose losses depend on frequency: ISO 12354-1, annex C, or 2.2 / (f T)."""
    made, part = model["materials"]["m"], model["parts"]["p"]
    said = made["loss_factor"]
    plain = {**model, "materials": {"m": {**made, "loss_factor": 1.0}}}
    if "reverberation_times" in said:
        table = np.array([[float(f.split()[0]), t] for f, t in said["reverberation_times"].items()])
        values = 2.2 / table.prod(axis=1)

        def loss(f: Floats) -> Floats:
            return np.interp(np.log(f), np.log(table[:, 0]), values)
    else:

        def loss(f: Floats) -> Floats:
            edges = made["rho"] * part["thickness"] / 485 / np.sqrt(np.clip(f, 50.0, 5000.0))
            return np.asarray(said["internal"] + edges)

    return replace(read(plain, order), varying=loss)


@capability("any answer: plates that lose by frequency", "independent", slow=True)
@_settled
def _(rng: np.random.Generator) -> Case:
    draft = a_plate(rng, ("simple", "clamped"))
    first, made = float(read(draft).modes(1)[0][0]), draft["materials"]["m"]
    size = rng.uniform(0.06, 0.12)
    if rng.random() < 0.5:
        made["loss_factor"] = {"like": "ISO 12354-1 laboratory", "internal": float(f"{size:.4g}")}
        made["rho"] = between(rng, 300, 500)
    else:
        lines = [float(f"{first * one:.4g}") for one in (0.7, 1.2, 4.0)]
        times = [float(f"{2.2 / f / size / rng.uniform(0.8, 1.2):.4g}") for f in lines]
        made["loss_factor"] = {"reverberation_times": {f"{f} Hz": t for f, t in zip(lines, times, strict=True)}}
    draft["damping"] = {"from": "materials"}
    return _answers(rng, draft, "q.z", reading=_by_frequency, answers=("losses", "frf", "vibration"))
