"""What leaves as a file and is taken back, reduced parts, and mesh files, against the whole and closed forms."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from tests.independent.frames import Floats
from tests.machine.bars import a_frame, a_material, a_section, away, push, words
from tests.machine.framework import Case, Door, Model, capability
from tests.machine.skeletons import read

Draft = dict[str, Any]


def _taken(rng: np.random.Generator) -> tuple[Draft, Draft]:
    """A frame that is exported with its support, and the model that takes it back."""
    whole = a_frame(rng)
    whole["parts"]["w"] = {"type": "mass", "at": "corner", "mass": float(rng.uniform(1, 10))}
    points = {name: {"on": "w", "at": whole["points"][name]["at"]} for name in ("tip", "corner")}
    form = str(rng.choice(["npz", "mtx"]))
    part = {"type": "matrices", "file": "whole.npz"}
    if form == "mtx":
        part = {"type": "matrices", "file": "whole.json"}
    return {"form": form, "whole": whole}, {"parts": {"w": part}, "points": points, "damping": {"ratio": 0.01}}


def _whole(model: Model) -> dict[str, Any]:
    return {"first": [("export", "whole.yaml", "--to", model["form"])], "whole": model["whole"]}


@capability("exchange: matrices taken back", "independent")
def _(rng: np.random.Generator) -> Case:
    """Modes, and at rest under a force and weight."""
    draft, taker = _taken(rng)
    forces = push(rng, "tip")

    def asked(model: Model, door: Door) -> Floats:
        own = door.ask(taker, "modes", "--count", "4", **_whole(model))["frequency_hz"]
        more = [word for one in words(forces) for word in ("--force", one)]
        rest = door.ask(taker, "statics", *more, "--weight", **_whole(model))["points"]["tip"]
        return np.r_[own / np.max(own), np.array(rest) / np.max(np.abs(rest)), np.max(own), np.max(np.abs(rest))]

    def right(model: Model, _: Door) -> Floats:
        bones, where = read(model["whole"])
        F = bones.load({}, 9.80665)
        for (_point, axis), size in forces.items():
            F[6 * where["tip"] + "xyz".index(axis)] += size
        rest = bones.rest(F)[6 * where["tip"] :][:6]
        own = bones.modes(4)[0]
        return np.r_[own / own.max(), rest / np.abs(rest).max(), own.max(), np.abs(rest).max()]

    return Case(draft, asked, right, 1e-3, "mesh of the exported model")


@capability("exchange: matrices taken back are shaken", "relation")
def _(rng: np.random.Generator) -> Case:
    """The base of a part that is held inside."""
    draft, taker = _taken(rng)
    axis = str(rng.choice(["x", "y", "z"]))
    first = float(read(draft["whole"])[0].modes(1)[0][0])
    study = {
        "model": "m.yaml", "modes": {"up_to": f"{20 * first} Hz"},
        "vibration": {"v": {"base": axis, "harmonic": "1 m/s^2", "band": [0.5 * first, 1.5 * first]}},
        "record": {f"tip.{axis}": "acceleration"},
    }  # fmt: skip

    def answer(found: dict[str, Any]) -> Floats:
        return np.array(
            [found["cases"]["as given"]["vibration"]["v"]["answers"][f"tip.{axis} acceleration"]["largest"]]
        )

    def asked(model: Model, door: Door) -> Floats:
        return answer(door.ask(study, "run", "--no-pictures", m=taker, **_whole(model)))

    def right(model: Model, door: Door) -> Floats:
        return answer(door.ask(study, "run", "--no-pictures", m=model["whole"]))

    return Case(draft, asked, right, 1e-4, "the same matrices; residual vectors of other points")


@capability("exchange: a reduced part", "independent")
def _(rng: np.random.Generator) -> Case:
    """A frame reduced, with another joined to its tip."""
    whole = a_frame(rng)
    tip = np.array(whole["points"]["tip"]["at"])
    end = (tip + away(rng)).round(3)
    whole["sections"]["t"] = a_section(rng)
    whole["parts"]["g"] = {
        "type": "frame", "material": "m", "section": "t", "mesh": 0.08, "lines": [[tip.tolist(), end.tolist()]],
    }  # fmt: skip
    whole["joints"] = {"j": {"connect": ["f", "g"]}}
    whole["points"]["end"] = {"on": "g", "at": end.tolist()}
    if rng.random() < 0.5:
        whole["supports"]["other"] = {"at": "end", "fix": "simple"}

    def asked(model: Model, door: Door) -> Floats:
        taker: Any = {**model, "parts": {**model["parts"], "f": {"type": "reduced", "file": "f.npz"}}}
        taker["points"] = {name: model["points"][name] for name in ("tip", "end")}
        held = {"wall": {"on": "f", "set": "wall", "fix": "clamped"}}
        taker["supports"] = {name: held.get(name, one) for name, one in model["supports"].items()}
        first = [("reduce", "whole.yaml", "--part", "f", "-o", "f.npz", "--count", "30")]
        return np.array(door.ask(taker, "modes", "--count", "4", first=first, whole=model)["frequency_hz"])

    def right(model: Model, _: Door) -> Floats:
        return read(model)[0].modes(4)[0]

    return Case(whole, asked, right, 2e-3, "thirty modes of the held part, and the mesh")


def _mesh(kind: str, sides: Floats, cells: tuple[int, int], turn: Floats) -> str:
    """A rectangle of quadrilaterals in millimetres."""
    n, m = cells
    places = [
        turn @ [x * 1e3, y * 1e3, 0] for y in np.linspace(0, sides[1], m + 1) for x in np.linspace(0, sides[0], n + 1)
    ]
    number = np.arange((n + 1) * (m + 1)).reshape(m + 1, n + 1) + 1
    quads = [
        (number[j, i], number[j, i + 1], number[j + 1, i + 1], number[j + 1, i]) for j in range(m) for i in range(n)
    ]
    if kind == "bdf":
        lines = ["BEGIN BULK"]
        lines += [f"GRID,{k + 1},,{x:.9f},{y:.9f},{z:.9f}" for k, (x, y, z) in enumerate(places)]
        lines += [f"CQUAD4,{k + 1},1,{','.join(map(str, quad))}" for k, quad in enumerate(quads)]
        return "\n".join([*lines, "ENDDATA", ""])
    lines = ["*NODE", *(f"{k + 1}, {x:.9f}, {y:.9f}, {z:.9f}" for k, (x, y, z) in enumerate(places))]
    lines += [
        "*ELEMENT, TYPE=S4, ELSET=ALL",
        *(f"{k + 1}, {', '.join(map(str, quad))}" for k, quad in enumerate(quads)),
    ]
    return "\n".join([*lines, ""])


@capability("exchange: a plate of a mesh file", "independent")
def _(rng: np.random.Generator) -> Case:
    """Free or on a bed of springs is not Navier's: held along its rim by a box about each side, thin."""
    sides = rng.uniform(0.5, 1.0, 2).round(3)
    thick = float(sides.min() / rng.uniform(80, 150))
    kind = str(rng.choice(["bdf", "inp"]))
    draft: Draft = {
        "materials": {"m": a_material(rng)},
        "parts": {"p": {"type": "shell", "mesh": f"plate.{kind}", "scale": "mm", "material": "m", "thickness": thick}},
        "supports": {},
        "damping": {"ratio": 0.01},
    }  # fmt: skip
    a, b = (float(one) for one in sides)
    e = 1e-4
    boxes = {"w": ([-e, -e, -e], [e, b + e, e]), "o": ([a - e, -e, -e], [a + e, b + e, e]),
             "s": ([-e, -e, -e], [a + e, e, e]), "n": ([-e, b - e, -e], [a + e, b + e, e])}  # fmt: skip
    for name, box in boxes.items():
        turn = "rx" if name in "wo" else "ry"  # no turn of the edge about its normal
        draft["supports"][name] = {"on": "p", "box": [list(corner) for corner in box], "fix": ["x", "y", "z", turn]}
    text = _mesh(kind, sides, (20, 20), np.eye(3))

    def asked(model: Model, door: Door) -> Floats:
        return np.array(door.ask(model, "modes", "--count", "3", **{f"plate.{kind}": text})["frequency_hz"])

    def right(model: Model, _: Door) -> Floats:
        m, h = model["materials"]["m"], model["parts"]["p"]["thickness"]
        D = m["E"] * h**3 / 12 / (1 - m["nu"] ** 2)
        waves = np.sort([(i / a) ** 2 + (j / b) ** 2 for i in range(1, 6) for j in range(1, 6)])[:3]
        return pi / 2 * waves * np.sqrt(D / m["rho"] / h)

    return Case(
        draft,
        asked,
        right,
        1.5e-2,
        "20 cells along a side: (pi n / 20)^2 / 12 of n = 3 and below; shear of thin plates",
    )
