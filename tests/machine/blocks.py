"""Rigid blocks on springs and mats, and structures in closed form."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from scipy.optimize import brentq

from tests.independent.frames import Floats
from tests.machine.bars import a_material, a_section, modes_case, push, rest_case
from tests.machine.framework import Case, Door, Model, capability
from tests.machine.skeletons import SIX

Draft = dict[str, Any]
_EXACT = "six motions of one body, without a mesh; rounding"


def a_block(rng: np.random.Generator) -> Draft:
    """On springs at three corners; points on other corners and inside."""
    size, origin = np.round(rng.uniform(0.3, 1.0, 3), 3), np.round(rng.normal(size=3), 3)
    mass = float(rng.uniform(50, 500))
    part: Draft = {"type": "block", "mass": mass, "origin": origin.tolist(), "size": size.tolist()}
    if rng.random() < 0.5:
        part["center"] = (size * rng.uniform(0.3, 0.7, 3)).tolist()
    if rng.random() < 0.5:
        part["inertia"] = (mass * 0.1 * rng.uniform(0.8, 1.2, 3)).tolist()
    corners = {"a": (0, 0, 0), "b": (1, 0, 0), "c": (0, 1, 0), "d": (1, 1, 1), "inside": tuple(rng.uniform(0, 1, 3))}
    draft: Draft = {
        "parts": {"m": part},
        "points": {name: {"on": "m", "at": (size * share).tolist()} for name, share in corners.items()},
        "damping": {"ratio": 0.02},
    }
    stiff = mass * (2 * pi * rng.uniform(3, 8)) ** 2 / 3
    for one in "abc":
        chosen = {axis: float(stiff * rng.uniform(0.3, 2)) for axis in "xyz"}
        turns = {axis: float(stiff * 0.1 * rng.uniform(0.3, 2)) for axis in SIX[3:] if rng.random() < 0.3}
        draft["parts"][f"k{one}"] = {"type": "spring", "between": [one, "ground"], "stiffness": {**chosen, **turns}}
    return draft


def _mat(rng: np.random.Generator, draft: Draft) -> Draft:
    for name in ("ka", "kb", "kc"):
        del draft["parts"][name]
    size = np.array(draft["parts"]["m"]["size"])
    mat: Draft = {"type": "foundation", "on": "m", "stiffness": {"normal": float(10 ** rng.uniform(5, 7))}}
    mat["stiffness"]["shear"] = float(mat["stiffness"]["normal"] * rng.uniform(0.1, 0.6))
    if rng.random() < 0.5:
        sides = size[:2] * rng.uniform(0.5, 0.8, 2)
        at = sides / 2 + (size[:2] - sides) * rng.uniform(0, 1, 2)
        mat["region"] = {"rectangle": sides.tolist(), "at": at.tolist()}
    draft["parts"]["mat"] = mat
    return draft


@capability("blocks: modes on springs", "independent")
def _(rng: np.random.Generator) -> Case:
    return modes_case(a_block(rng), 1e-7, _EXACT, 6)


@capability("blocks: at rest under weight and a force", "independent")
def _(rng: np.random.Generator) -> Case:
    return rest_case(
        a_block(rng), push(rng, "d", "inside"), ("d", "inside"), weight=True, tolerance=1e-8, reason=_EXACT
    )


@capability("blocks: on a mat", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = _mat(rng, a_block(rng))
    if rng.random() < 0.5:
        return modes_case(draft, 1e-7, _EXACT, 6)
    return rest_case(draft, push(rng, "d"), ("a", "d"), weight=True, tolerance=1e-8, reason=_EXACT)


@capability("blocks: on legs of a frame", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_block(rng)
    part = draft["parts"]["m"]
    low, size = np.array(part["origin"]), np.array(part["size"])
    lines = []
    for share in ((0, 0), (1, 0), (0.3, 1)):
        head = np.round(low + size * [*share, 0], 6)
        lines.append([np.round(head - [0, 0, 0.7], 6).tolist(), head.tolist()])
    draft["materials"], draft["sections"] = {"m": a_material(rng)}, {"s": a_section(rng)}
    draft["parts"]["legs"] = {"type": "frame", "material": "m", "section": "s", "mesh": 0.1, "lines": lines}
    draft["joints"] = {"j": {"connect": ["legs", "m"]}}
    for number, line in enumerate(lines):
        draft["points"][f"foot {number}"] = {"on": "legs", "at": line[0]}
        draft.setdefault("supports", {})[f"floor {number}"] = {"at": f"foot {number}", "fix": "clamped"}
    for name in ("ka", "kb", "kc"):
        del draft["parts"][name]
    near = "what touches is joined within 1e-6 m, of legs of 0.7 m: 3e-6 / 0.7; then modes of the mesh"
    if rng.random() < 0.5:
        return modes_case(draft)
    return rest_case(draft, push(rng, "d"), ("d",), 2e-5, near)


def _beam_roots(ends: tuple[str, str], count: int) -> Floats:
    """Elastic roots beta L of beams; with 1 / cosh so that nothing overflows."""
    words = frozenset(ends)
    if words == {"pinned"}:
        return pi * np.arange(1, count + 1)
    if words in ({"clamped"}, {"free"}):
        at, shift = (lambda x: np.cos(x) - 1 / np.cosh(x)), 1.5
    elif words == {"clamped", "free"}:
        at, shift = (lambda x: np.cos(x) + 1 / np.cosh(x)), 0.5
    else:
        at, shift = (lambda x: np.cos(x) * np.tanh(x) - np.sin(x)), 1.25
    return np.array([brentq(at, (n + shift - 0.4) * pi, (n + shift + 0.4) * pi, xtol=1e-13) for n in range(count)])


@capability("closed form: a beam", "independent")
def _(rng: np.random.Generator) -> Case:
    ends = tuple(str(one) for one in rng.choice(["pinned", "free", "clamped"], 2))
    draft: Draft = {
        "structure": {
            "type": "beam", "length": float(rng.uniform(0.5, 5)), "ends": list(ends),
            "EI": float(10 ** rng.uniform(0, 6)), "mass_per_length": float(10 ** rng.uniform(-1, 2)), "modes": 8,
        },
        "damping": {"ratio": 0.01},
    }  # fmt: skip

    def asked(model: Model, door: Door) -> Floats:
        return door.modes(model, 8)

    def right(model: Model, _: Door) -> Floats:
        s = model["structure"]
        free = {("free", "free"): 2, ("free", "pinned"): 1}.get(tuple(sorted(s["ends"])), 0)  # type: ignore[call-overload]
        roots = _beam_roots(tuple(s["ends"]), 8 - free)
        elastic = roots**2 / 2 / pi / s["length"] ** 2 * np.sqrt(s["EI"] / s["mass_per_length"])
        return np.r_[np.zeros(free), elastic]

    return Case(draft, asked, right, 1e-9, "roots to rounding", ("structure",))


@capability("closed form: a rod", "independent")
def _(rng: np.random.Generator) -> Case:
    draft: Draft = {
        "structure": {
            "type": "rod", "length": float(rng.uniform(0.5, 5)), "E": float(10 ** rng.uniform(9, 11.3)),
            "rho": float(rng.uniform(500, 8000)), "area": float(10 ** rng.uniform(-4, -2)), "modes": 6,
        },
        "points": {"p": {"at": 0.0}},
        "damping": {"ratio": 0.01},
    }  # fmt: skip

    def right(model: Model, _: Door) -> Floats:
        s = model["structure"]
        return np.arange(6) / 2 / s["length"] * np.sqrt(s["E"] / s["rho"])

    return Case(draft, lambda model, door: door.modes(model, 6), right, 1e-9, "n c / 2 L to rounding", ("structure",))


@capability("closed form: response of a beam", "independent")
def _(rng: np.random.Generator) -> Case:
    """Receptance of a pinned beam by its modal sum, of as many modes."""
    place, other = (float(one) for one in rng.uniform(0.1, 0.9, 2))
    length, EI, mass = float(rng.uniform(1, 3)), float(10 ** rng.uniform(2, 4)), float(rng.uniform(1, 10))
    draft: Draft = {
        "structure": {
            "type": "beam", "length": length, "ends": ["pinned", "pinned"], "EI": EI, "mass_per_length": mass,
            "modes": 40,
        },
        "points": {"p": {"at": place * length}, "q": {"at": other * length}},
        "damping": {"ratio": float(rng.uniform(0.03, 0.1))},
    }  # fmt: skip
    first = pi / 2 / length**2 * np.sqrt(EI / mass)

    def asked(model: Model, door: Door) -> Floats:
        band = f"{0.5 * first} Hz:{1.6 * first} Hz"
        found = door.ask(model, "frf", "--drive", "p.z", "--response", "q.z", "--band", band, "--step", f"{first / 50}",
                         "--kind", "receptance")  # fmt: skip
        return np.r_[found["real"], found["imag"]]

    def right(model: Model, _: Door) -> Floats:
        s, n = model["structure"], np.arange(1, 41)
        w = 2 * pi * (0.5 * first + first / 50 * np.arange(56))[:, None]
        own = (n * pi / s["length"]) ** 2 * np.sqrt(s["EI"] / s["mass_per_length"])
        shapes = [np.sin(n * pi * model["points"][p]["at"] / s["length"]) for p in "pq"]
        terms = shapes[0] * shapes[1] * 2 / s["mass_per_length"] / s["length"]
        H = (terms / (own**2 - w**2 + 2j * model["damping"]["ratio"] * own * w)).sum(axis=1)
        return np.r_[H.real, H.imag]

    return Case(
        draft, asked, right, 1e-5, "terms beyond the fortieth fall with the fourth power: 1 / 3 / 40^3 of the first"
    )
