"""Cells just within and just beyond the limits of their shapes, which are told by their numbers."""

from __future__ import annotations

import re
from typing import Any, Final

import numpy as np
from scipy.optimize import brentq

from tests.machine.framework import Case, Door, Floats, Model, Refused, capability

Draft = dict[str, Any]
_WORDS: Final = ("with a sharp corner", "with a blunt corner", "warped", "long and narrow")
_SHARP, _BLUNT, _WARPED, _LONG = range(4)


def _leaning(angle: float) -> Floats:
    """A rhomb with that corner [deg]."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return np.array([[0, 0, 0], [1, 0, 0], [1 + c, s, 0], [c, s, 0]])


def _bulged(angle: float) -> Floats:
    """A kite with one blunt corner."""
    return np.array([[-1, 0, 0], [0, -1 / np.tan(np.radians(angle) / 2), 0], [1, 0, 0], [0, 1.5, 0]])


def _lifted(angle: float) -> Floats:
    """A square with a corner out of its plane, so that normals at two opposite corners lean by that much [deg]."""

    def square(up: float) -> Floats:
        return np.array([[0, 0, 0], [1, 0, 0], [1, 1, up], [0, 1, 0]])

    def miss(up: float) -> float:
        at = square(up)
        normals = [np.cross(at[(k + 1) % 4] - at[k], at[k - 1] - at[k]) for k in range(4)]
        leans = [
            normals[k] @ normals[k + 2] / np.linalg.norm(normals[k]) / np.linalg.norm(normals[k + 2]) for k in (0, 1)
        ]
        return float(np.degrees(np.arccos(min(leans))) - angle)

    return square(float(brentq(miss, 0.01, 1.0)))


def _rectangle(aspect: float) -> Floats:
    return np.array([[0, 0, 0], [aspect, 0, 0], [aspect, 1, 0], [0, 1, 0]])


def _apex(angle: float) -> Floats:
    """A triangle with two equal sides and that angle between them [deg]."""
    half = np.radians(angle) / 2
    return np.array([[-np.sin(half), 0, 0], [np.sin(half), 0, 0], [0, np.cos(half), 0]])


def _needle(aspect: float) -> Floats:
    """A triangle whose longest side squared over its area is that much, in terms of an even one."""
    high = aspect / np.sqrt(3) + np.sqrt(aspect**2 / 3 - 0.25)
    return np.array([[-0.5, 0, 0], [0.5, 0, 0], [0, high, 0]])


# A cell by the limit it is about, and which faults it has just within and just beyond.
_MADE: Final = {
    "rhomb": (_leaning, 30.0, -1, (), (_SHARP, _BLUNT)),
    "kite": (_bulged, 150.0, 1, (), (_BLUNT,)),
    "lifted": (_lifted, 20.0, 1, (), (_WARPED,)),
    "rectangle": (_rectangle, 20.0, 1, (), (_LONG,)),
    "apex": (_apex, 120.0, 1, (), (_BLUNT,)),
    "needle": (_needle, 20.0, 1, (), (_LONG,)),
}


@capability("elements: bad shapes are told, and impossible ones refused", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    cells, faults = [], []
    for make, limit, way, within, beyond in _MADE.values():
        for sign, some in ((-1, within), (1, beyond)):
            cells += [make(limit * (1 + 0.01 * sign * way))] * 2
            faults += [some] * 2
    order = rng.permutation(len(cells))
    cells, faults = [cells[k] for k in order], [faults[k] for k in order]
    draft: Draft = {"materials": {"m": {"E": 2e11, "nu": 0.3, "rho": 7800.0}}, "size": rng.uniform(0.5, 2)}

    def deck(cells: list[Floats], size: float) -> str:
        lines, elements, first = ["*NODE"], [], 1
        for k, cell in enumerate(cells):
            flip = cell[::-1] if k % 2 else cell
            at = (np.roll(flip, k, axis=0) * size + [0.0, 0.0, 3.0 * k]) @ turn.T
            lines += [f"{first + j}, {x!r}, {y!r}, {z!r}" for j, (x, y, z) in enumerate(at.tolist())]
            own = ", ".join(str(first + j) for j in range(len(cell)))
            elements += [f"*ELEMENT, TYPE=S{len(cell)}", f"{k + 1}, {own}"]
            first += len(cell)
        return "\n".join([*lines, *elements, ""])

    def told(model: Model, door: Door, cells: list[Floats]) -> Floats:
        inner: Draft = {"materials": model["materials"], "damping": {"ratio": 0.01}}
        inner["parts"] = {"p": {"type": "shell", "mesh": "a.inp", "material": "m", "thickness": 0.005 * model["size"]}}
        inner["supports"] = {"all": {"on": "p", "fix": ["x", "y", "z"]}}
        found = door.ask(inner, "statics", "--weight", **{"a.inp": deck(cells, model["size"])})["findings"]
        one = next(one for one in found if one["code"] == "bad-cells")
        counts = [re.search(rf"(\d+) {word}", one["message"]) for word in _WORDS]
        return np.array([one["values"]["cells"], *(int(at[1]) if at else 0 for at in counts)])

    def asked(model: Model, door: Door) -> Floats:
        found = told(model, door, cells)
        refused = []
        for bad in (_bulged(181.0), np.zeros((3, 3)), np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])):
            try:
                told(model, door, [*cells, bad])
                refused.append(0.0)
            except Refused:
                refused.append(1.0)
        door.told = []
        return np.r_[found, refused]

    def right(_: Model, __: Door) -> Floats:
        return np.r_[sum(map(bool, faults)), [sum(k in some for some in faults) for k in range(4)], 1, 1, 1]

    return Case(draft, asked, right, 1e-12, "numbers of cells; they are whole")
