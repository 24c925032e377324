"""Slabs with shear: thick, layered, off their middle, on foundations; what their layers lose; joints of two."""

from __future__ import annotations

import copy
from typing import Any, Final

import numpy as np

from tests.independent.ritz import PY, Panel, V, W, section
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.plates import aside, between, edges, material, plies

_COUNT: Final = 3
_CELLS: Final = 8
_KNOBS = ("materials.m",)
_WHY = "cells halved twice: what is left of an error of second order, by another halving below 3e-3"


def slab(rng: np.random.Generator, ortho: bool = False, slender: float = 15.0) -> dict[str, Any]:
    """A slab of 1 to 2 m with its edges held at random; slender : its side over its thickness, or up to three times."""
    a, b = between(rng, 1.0, 2.0), between(rng, 1.0, 2.0)
    h = float(f"{a / rng.uniform(slender, 3 * slender):.4g}")
    part: dict[str, Any] = {"type": "slab", "outline": [[0, 0], [a, 0], [a, b], [0, b]], "mesh": max(a, b) / _CELLS}
    if ortho:
        part["layers"] = [["m", h, f"{between(rng, -90, 90)} deg"]]
    else:
        part |= {"material": "m", "thickness": h}
    q = [between(rng, 0.25 * a, 0.75 * a), between(rng, 0.25 * b, 0.75 * b)]
    kinds = ("simple", "clamped", "free")
    sides = {"y0": "side 1", "x1": "side 2", "y1": "side 3", "x0": "side 4"}
    held = edges(rng, kinds).items()
    return {
        "materials": {"m": material(rng, ortho)},
        "parts": {"p": part},
        "points": {"q": {"on": "p", "at": q}},
        "supports": {name: {"on": "p", "set": sides[name], "fix": how} for name, how in held if how != "free"},
        "damping": {"ratio": 0.01},
    }


def by_ritz(model: Model, order: int = 9) -> Panel:
    """The slab of a model with its edges and foundation."""
    of = model["parts"]["p"]
    a, b = of["outline"][2]
    panel = Panel(a, b, order=order).add(section(plies(model), of.get("offset", 0.0)))
    for name, one in model["supports"].items():
        panel.hold(name, {"simple hard": "hard"}.get(one["fix"], one["fix"]))
    if mat := model["parts"].get("mat"):
        face = of.get("offset", 0.0) - sum(one.thickness for one in plies(model)) / 2
        panel.K += panel.spread(mat["stiffness"]["normal"], mat["stiffness"]["shear"], face)
    return panel


def refined(model: Model, ask: Any) -> Floats:
    """An answer of the program, extrapolated from meshes of h / 2 and h / 4 to none."""
    found = []
    for times in (2, 4):
        finer: Any = copy.deepcopy(model)
        finer["parts"]["p"]["mesh"] /= times
        found.append(np.asarray(ask(finer)))
    coarse, fine = found
    return np.asarray((4 * fine - coarse) / 3)


def frequencies(model: Model, door: Door) -> Floats:
    """The first elastic natural frequencies, extrapolated."""
    found = refined(model, lambda one: door.modes(one, _COUNT))
    aside(door)
    return found


def modes_case(model: Model, tolerance: float = 4e-3) -> Case:
    """Natural frequencies beside those of Ritz."""

    def right(model: Model, _: Door) -> Floats:
        return by_ritz(model).modes(_COUNT)[0]

    return Case(model, frequencies, right, tolerance, _WHY, _KNOBS, each=True)


@capability("slabs: natural frequencies of thick ones", "independent")
def _(rng: np.random.Generator) -> Case:
    return modes_case(slab(rng, slender=8.0), 6e-3)


@capability("slabs: orthotropic and turned", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return modes_case(slab(rng, ortho=True), 6e-3)


@capability("slabs: hard simple supports", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = slab(rng, slender=8.0)
    for one in model["supports"].values():
        one["fix"] = "simple hard"
    if len(model["supports"]) < 2:
        model["supports"] |= {"x0": {"on": "p", "set": "side 4", "fix": "simple hard"}}
        model["supports"] |= {"x1": {"on": "p", "set": "side 2", "fix": "simple hard"}}
    return modes_case(model)


@capability("slabs: off the middle of their nodes", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = slab(rng)
    h = model["parts"]["p"]["thickness"]
    model["parts"]["p"]["offset"] = float(f"{h * rng.uniform(-1, 1):.4g}")
    return modes_case(model, 6e-3)


def _layered(rng: np.random.Generator) -> dict[str, Any]:
    model = slab(rng, slender=80.0)
    model["materials"]["n"] = material(rng, True)
    model["materials"]["m"]["E"] = float(
        f"{10 ** rng.uniform(9.7, 10.3):.4g}"
    )  # As by 5/6 of G h: layers not far apart
    part = model["parts"]["p"]
    h, core = part.pop("thickness"), part.pop("material")
    turn = f"{between(rng, 0, 90)} deg"
    part["layers"] = [["n", float(f"{h * rng.uniform(0.2, 0.6):.4g}"), turn], [core, float(f"{h / 2:.4g}")]]
    return model


@capability("slabs: unsymmetric layers", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return modes_case(_layered(rng), 8e-3)


@capability("slabs: sag under weight", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = slab(rng)

    def right(model: Model, _: Door) -> Floats:
        panel = by_ritz(model)
        found = panel.rest(panel.weight(sum(one.rho * one.thickness for one in plies(model))))
        return np.array([panel.at(*model["points"]["q"]["at"]) @ found])

    def asked(model: Model, door: Door) -> Floats:
        found = refined(model, lambda one: door.statics(one, weight=True)["points"]["q"][2:3])
        aside(door)
        return found

    return Case(model, asked, right, 1e-2, _WHY, _KNOBS)


@capability("slabs: on a wall, held by a mat with shear", "independent")
def _(rng: np.random.Generator) -> Case:
    """Its weight acts along it, its middle is off the face that the mat holds: it slips, tilts and bends."""
    model = slab(rng)
    model["supports"] = {}
    part, made = model["parts"]["p"], model["materials"]["m"]
    h, (a, b) = part["thickness"], part["outline"][2]
    k = float(f"{made['E'] * h**3 / a**4 * 10 ** rng.uniform(-1, 1):.4g}")
    stiffness = {"normal": k, "shear": float(f"{k * rng.uniform(0.1, 1):.4g}")}
    model["parts"]["mat"] = {"type": "foundation", "on": "p", "region": "whole", "stiffness": stiffness}
    part |= {"offset": float(f"{h * rng.uniform(-1, 1):.4g}"), "normal": [1, 0, 0], "x_direction": [0, 1, 0]}

    def right(model: Model, _: Door) -> Floats:
        panel, of = by_ritz(model), section(plies(model), model["parts"]["p"]["offset"])
        x, y, w = panel.points()
        load = -9.80665 * w @ (of.mass[0] * panel.rows(x, y, V) + of.mass[1] * panel.rows(x, y, PY))
        found, at = panel.rest(load), model["points"]["q"]["at"]
        return np.array([panel.at(*at, V) @ found, panel.at(*at, W) @ found, -b * panel.at(*at, PY) @ found])

    def asked(model: Model, door: Door) -> Floats:
        def ask(one: Model) -> Floats:
            at = door.statics(one, weight=True)["points"]["q"]  # its own axes x, y, z are y, z, x here
            return np.array([at[2], at[0], b * at[4]])

        found = refined(model, ask)
        aside(door)
        return found

    return Case(model, asked, right, 5e-3, _WHY, _KNOBS)


@capability("slabs: what each layer loses", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = _layered(rng)
    for one in model["materials"].values():
        one["loss_factor"] = between(rng, 0.002, 0.1)
    model["damping"] = {"from": "materials"}
    if rng.random() < 0.7:  # springs below, that stretch it
        part = model["parts"]["p"]
        h, (a, _) = sum(one[1] for one in part["layers"]), part["outline"][2]
        k = float(f"{1e9 * h**3 / a**4 * 10 ** rng.uniform(0, 2):.4g}")
        stiffness = {"normal": k, "shear": k}
        mat = {"type": "foundation", "on": "p", "region": "whole", "stiffness": stiffness}
        model["parts"]["mat"] = mat | {"loss_factor": between(rng, 0.05, 0.3)}

    def right(model: Model, _: Door) -> Floats:
        panel = by_ritz(model)
        _, shapes = panel.modes(_COUNT)
        lossy = panel.stiffness(section(plies(model), lossy=True))
        if mat := model["parts"].get("mat"):
            bare = by_ritz({**model, "parts": {"p": model["parts"]["p"]}})
            lossy = lossy + mat["loss_factor"] * (panel.K - bare.K)
        above = np.einsum("ck,cd,dk->k", shapes, lossy, shapes)
        return np.asarray(above / np.einsum("ck,cd,dk->k", shapes, panel.K, shapes))

    def asked(model: Model, door: Door) -> Floats:
        found = refined(model, lambda one: 2 * np.array(door.ask(one, "modes", "--count", "3")["damping_ratio"]))
        aside(door)
        return found

    return Case(model, asked, right, 1e-2, _WHY + "; shear of layers by 5/6 of their moduli", _KNOBS, each=True)


def _two(model: Model, cut: float, second: float, gap: float = 0.0) -> Model:
    """The slab as two, side by side and joined; the second's cells are `second` times as long."""
    other: Any = copy.deepcopy(model)
    one = other["parts"].pop("p")
    a, b = one["outline"][2]
    left, right = copy.deepcopy(one), copy.deepcopy(one)
    left["outline"] = [[0, 0], [cut, 0], [cut, b], [0, b]]
    right["outline"] = [[cut, 0], [a, 0], [a, b], [cut, b]]
    right["mesh"] = one["mesh"] * second
    other["parts"] = {"l": left, "r": right}
    other["joints"] = {"j": {"connect": ["l", "r"]}}
    other["points"]["q"]["on"] = "l" if other["points"]["q"]["at"][0] < cut else "r"
    sides = {"y0": "side 1", "x1": "side 2", "y1": "side 3", "x0": "side 4"}
    fresh = {}
    for name, held in other["supports"].items():
        for part in {"x0": ("l",), "x1": ("r",)}.get(name, ("l", "r")):
            fresh[f"{name} {part}"] = held | {"on": part, "set": sides[name]}
    other["supports"] = fresh
    return other


@capability("slabs: two with unlike cells are one", "independent")
def _(rng: np.random.Generator) -> Case:
    model = slab(rng)
    a, _ = model["parts"]["p"]["outline"][2]
    cut, second = between(rng, 0.3 * a, 0.7 * a), between(rng, 0.6, 1.7)

    def right(model: Model, _: Door) -> Floats:
        return by_ritz(model).modes(_COUNT)[0]

    def asked(model: Model, door: Door) -> Floats:
        found = []
        for times in (2, 4):
            finer: Any = copy.deepcopy(model)
            finer["parts"]["p"]["mesh"] /= times
            found.append(door.modes(_two(finer, cut, second), _COUNT))
        aside(door)
        return np.asarray((4 * found[1] - found[0]) / 3)

    return Case(
        model, asked, right, 1e-2, _WHY + ", and cells that do not halve alike on both sides", _KNOBS, each=True
    )


@capability("slabs: turned in space", "relation")
def _(rng: np.random.Generator) -> Case:
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]

    def plain(model: Model, door: Door) -> Floats:
        found = door.modes(model, _COUNT)
        aside(door)
        return found

    def right(model: Model, door: Door) -> Floats:
        other: Any = copy.deepcopy(model)
        other["parts"]["p"] |= {"origin": [0.3, 2.0, -1.0], "normal": q[:, 2].tolist(), "x_direction": q[:, 0].tolist()}
        return plain(other, door)

    return Case(slab(rng, bool(rng.random() < 0.5)), plain, right, 1e-6, "tolerance of the eigensolution", _KNOBS)
