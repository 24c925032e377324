"""Flat shells of mesh files, with all that the model says of them: any answer of each."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from functools import partial
from math import atan2, degrees
from typing import Any, Final

import numpy as np

from tests.independent.linear import Floats, Linear
from tests.independent.ritz import Panel, Ply, Section, section
from tests.machine.columns import Ask, Subject, case_of
from tests.machine.framework import Case, Model, capability
from tests.machine.plates import between, material, ply
from tests.machine.sheets import Form, Sheet

Draft = dict[str, Any]
_WHY: Final = "cells of a twelfth and a 24th of a side, extrapolated, polynomials of order 9: below 3e-3"
_ASIDE: Final = (
    "implausible",
    "coarse-mesh",
    "modal-mass-low",
    "stress-uneven",
    "thick-plate",
    "thick-for-short-waves",
    "sags-far",
    "few-elastic",
    "layers-shear",
    "mesh-in-other-units",
)
_LAID: Final = {  # husfabrik.eu, standard designs of CLT panels: layers [mm], crosswise
    "CLT60 L3": (20, 20, 20),
    "CLT80 L3": (30, 20, 30),
    "CLT90 L3": (30, 30, 30),
    "CLT100 L3": (30, 40, 30),
    "CLT120 L3": (40, 40, 40),
    "CLT100 L5": (20, 20, 20, 20, 20),
    "CLT120 L5": (30, 20, 20, 20, 30),
    "CLT140 L5": (40, 20, 20, 20, 40),
    "CLT160 L5": (40, 20, 40, 20, 40),
    "CLT180 L5": (40, 30, 40, 30, 40),
    "CLT200 L5": (40, 40, 40, 40, 40),
}


def deck(sides: Floats, cells: int) -> str:
    """A rectangle of quadrilaterals in the plane z = 0, as Nastran writes it."""
    x, y = (np.linspace(0, side, cells + 1) for side in sides)
    number = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1) + 1
    lines = ["BEGIN BULK"]
    lines += [f"GRID,{number[j, i]},,{x[i]:.9f},{y[j]:.9f},0." for j in range(cells + 1) for i in range(cells + 1)]
    quads = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
    lines += [f"CQUAD4,{k + 1},1,{','.join(map(str, quad))}" for k, quad in enumerate(quads)]
    return "\n".join([*lines, "ENDDATA", ""])


def _beside(model: Model, sides: Floats) -> Mapping[str, str]:
    """The mesh file, whose name says how fine it is."""
    name = model["parts"]["p"]["mesh"]
    return {name: deck(sides, int(name.removesuffix(".bdf")[1:]))}


def _refined(model: Model, ask: Ask) -> Floats:
    found = []
    for cells in (12, 24):
        finer: Any = copy.deepcopy(model)
        finer["parts"]["p"]["mesh"] = f"p{cells}.bdf"
        found.append(ask(finer))
    return np.asarray((4 * found[1] - found[0]) / 3)


def _section(model: Model, lossy: bool = False) -> tuple[Section, float]:
    """Rigidities about the nodes and the whole thickness."""
    part, made = model["parts"]["p"], model["materials"]
    x = part.get("orientation", [1.0, 0.0, 0.0])
    lean, bond = degrees(atan2(x[1], x[0])), 1.0
    plies: list[Ply]
    if "thickness" in part:
        plies = [ply(made[part["material"]], part["thickness"], lean)]
    elif "like" in (said := part["layers"]):
        rows = _LAID[said["like"]]
        plies = [ply(made[said["of"]], one / 1e3, lean + 90 * (k % 2)) for k, one in enumerate(rows)]
    else:
        bond = said["bond"]
        plies = [ply(made[name], one, lean + float(turn.split()[0])) for name, one, turn in said["boards"]]
    glued = section(plies, lossy=lossy)
    D = bond * glued.D + (1 - bond) * sum(section([one], lossy=lossy).D for one in plies)
    B, e = bond * glued.B, part.get("offset", 0.0)
    more = 0.0 if lossy else part.get("nonstructural", 0.0)
    I0, I1, I2 = glued.mass[0] + more, glued.mass[1], glued.mass[2]
    mass = (I0, I1 + e * I0, I2 + 2 * e * I1 + e * e * I0)
    found = Section(glued.A, B + e * glued.A, D + 2 * e * B + e * e * glued.A, glued.S, mass)
    return found, sum(one.thickness for one in plies)


def _form(model: Model, sides: Floats, order: int = 9) -> Linear:
    part = model["parts"]["p"]
    a, b = np.asarray(sides) * part["scale"]
    of, h = _section(model)
    panel = Panel(float(a), float(b), order=order).add(of)
    lossy = panel.stiffness(_section(model, lossy=True)[0])
    for name, one in model["supports"].items():
        panel.hold(name, one["fix"])
    points = {name: {"on": "p", "at": one["at"][:2]} for name, one in model["points"].items()}
    sheet = Sheet(panel, np.eye(3), np.zeros(3), h, part.get("offset", 0.0))
    return Form({"p": sheet}, lossy, len(panel.K)).linear({"points": points})


def _shell(rng: np.random.Generator, slender: float, long: float = 1.0) -> tuple[Draft, Floats]:
    """Held along one edge, or along two; slender : a side over the thickness, or up to twice; long : along y."""
    a, b = between(rng, 1.2, 2.0), between(rng, 1.2 * long, 2.0 * long)
    h, scale = float(f"{a / rng.uniform(slender, 2 * slender):.4g}"), float(rng.choice([0.5, 2.0, 1e-3]))
    part: Draft = {"type": "shell", "mesh": "p24.bdf", "scale": scale, "material": "m", "thickness": h}
    e = 1e-4
    kinds = ["clamped", str(rng.choice(["free", "clamped", "simple"]))]
    boxes = {"x0": [[-e, -9.0, -e], [e, 9.0, e]], "x1": [[a - e, -9.0, -e], [a + e, 9.0, e]]}
    held = {name: {"on": "p", "box": boxes[name], "fix": fix} for name, fix in zip(boxes, kinds, strict=True)}
    draft: Draft = {
        "materials": {"m": material(rng, False)},
        "parts": {"p": part},
        "points": {name: {"on": "p", "at": [round(x * a, 6), round(y * b, 6), 0.0]}
                   for name, x, y in (("q", 5 / 12, 1 / 2), ("d", 3 / 4, 1 / 4))},
        "supports": {name: one for name, one in held.items() if one["fix"] != "free"},
        "damping": {"ratio": 0.01},
    }  # fmt: skip
    return draft, np.array([a, b]) / scale


def _answers(
    rng: np.random.Generator, draft: Draft, sides: Floats, *ways: str, accuracy: float = 4e-3, order: int = 9
) -> Case:
    form, beside = partial(_form, sides=sides, order=order), partial(_beside, sides=sides)
    return case_of(rng, Subject(draft, form, ("d.z",), ways, accuracy, _WHY, _refined, _ASIDE, pushed=False,
                                beside=beside))  # fmt: skip


@capability("shells: any answer of a flat one", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    draft, sides = _shell(rng, 25.0)
    part = draft["parts"]["p"]
    if rng.random() < 0.7:
        part["offset"] = float(f"{part['thickness'] * rng.uniform(-1.5, 1.5):.4g}")
    if rng.random() < 0.7:
        part["nonstructural"] = float(f"{draft['materials']['m']['rho'] * part['thickness'] * rng.uniform(3, 9):.4g}")
    if rng.random() < 0.3:
        draft["materials"]["m"]["loss_factor"] = between(rng, 0.06, 0.12)
        draft["damping"] = {"from": "materials"}
    # At the corners of clamped and free edges both converge slowly: of 14 draws polynomials of order 13 are up to
    # 2.7e-3 from those of order 9, with an offset or without.
    return _answers(rng, draft, sides, str(rng.choice(["q.x", "q.z"])) if "offset" in part else "q.z")


@capability("shells: any answer of one with directions", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Clamped all round: corners of free edges would need polynomials of a high order."""
    draft, sides = _shell(rng, 40.0, 2.0)
    part = draft["parts"]["p"]
    a, b = (float(one) for one in sides * part["scale"])
    e, high, low = 1e-4, [9.0, 9.0, 9.0], [-9.0, -9.0, -9.0]
    boxes = {"x0": [low, [e, *high[1:]]], "x1": [[a - e, *low[1:]], high], "y0": [low, [9.0, e, 9.0]],
             "y1": [[-9.0, b - e, -9.0], high]}  # fmt: skip
    draft["supports"] = {name: {"on": "p", "box": box, "fix": "clamped"} for name, box in boxes.items()}
    made = material(rng, True)
    made["E"][1] = made["E"][0] * 0.1
    draft["materials"]["m"] = made
    turned = rng.uniform(0.3, 1.2) * rng.choice([-1, 1])
    part["orientation"] = [float(np.cos(turned)), float(np.sin(turned)), 0.0]
    return _answers(rng, draft, sides, "q.z", accuracy=4e-3, order=11)


@capability("shells: any answer of boards and lay-ups", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Slender: shear of layers by 5/6 of their moduli is the program's nearly."""
    draft, sides = _shell(rng, 60.0)
    part = draft["parts"]["p"]
    h, E = part.pop("thickness"), 1e10
    draft["materials"]["m"] = {"E": [E, 0.3 * E], "G": [0.3 * E, 0.25 * E, 0.3 * E], "nu": 0.3, "rho": 500.0}
    part.pop("material")
    part["orientation"] = [1.0, 0.0, 0.0]
    if rng.random() < 0.5:
        for name, one in draft["points"].items():
            draft["points"][name] = {**one, "at": [4 * x for x in one["at"]]}
        for one in draft["supports"].values():
            one["box"] = [[4 * x for x in row] for row in one["box"]]
        part["layers"] = {"like": str(rng.choice(list(_LAID)[:4])), "of": "m"}
        sides = 4 * sides
    else:
        draft["materials"]["m"] = material(rng, False)
        draft["materials"]["n"] = draft["materials"]["m"] | {"rho": between(rng, 400, 8000), "nu": 0.2}
        boards = [[name, h / 4, "0 deg"] for name in "mnnm"]
        part["layers"] = {"boards": boards, "bond": between(rng, 0.5, 0.9)}
        return _answers(rng, draft, sides, "q.z", accuracy=3e-3)
    return _answers(rng, draft, sides, "q.z", accuracy=5e-3)
