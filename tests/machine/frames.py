"""Bent frames in space, clamped at one end."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from tests.independent.frames import Floats, Tube, clamped_frequencies, tip_at_rest
from tests.machine.framework import Case, Door, Model, capability

_KNOBS = ("materials.m", "sections.s")
_MODES = 4


def _frame(rng: np.random.Generator) -> dict[str, Any]:
    """A tube through two to four corners, 1 m and more between them and slender: length over diameter above 30."""
    steps = rng.normal(size=(int(rng.integers(1, 4)), 3))
    steps *= (rng.uniform(1.0, 2.0, len(steps)) / np.linalg.norm(steps, axis=1))[:, None]
    corners = np.round(np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]), 3)
    outer = float(rng.uniform(0.01, 0.03))
    return {
        "materials": {
            "m": {"E": 10 ** rng.uniform(9.5, 11.3), "nu": rng.uniform(0.1, 0.4), "rho": rng.uniform(4e2, 8e3)}
        },
        "sections": {"s": {"shape": "tube", "outer": outer, "thickness": outer * float(rng.uniform(0.1, 0.4))}},
        "parts": {
            "f": {
                "type": "frame", "material": "m", "section": "s", "mesh": 0.15, "element": "euler",
                "lines": [corners.tolist()],
            }
        },
        "points": {"root": {"on": "f", "at": corners[0].tolist()}, "tip": {"on": "f", "at": corners[-1].tolist()}},
        "supports": {"wall": {"at": "root", "fix": "clamped"}},
        "damping": {"ratio": 0.01},
    }  # fmt: skip


def _tube(model: Model) -> Tube:
    return Tube(**{k: model["sections"]["s"][k] for k in ("outer", "thickness")}, **model["materials"]["m"])


def _corners(model: Model) -> Floats:
    return np.array(model["parts"]["f"]["lines"][0], dtype=float)


def _frequencies(model: Model, door: Door) -> Floats:
    return door.modes(model, _MODES)


@capability("frames: tip at rest", "independent")
def _(rng: np.random.Generator) -> Case:
    force = np.round(rng.normal(size=3) * 10, 2)

    def asked(model: Model, door: Door) -> Floats:
        words = (f"tip.{axis}={float(size)} N" for axis, size in zip("xyz", force, strict=True))
        return np.array(door.statics(model, *words)["points"]["tip"])[:3]

    def right(model: Model, _: Door) -> Floats:
        return tip_at_rest(_tube(model), _corners(model), force)[:3]

    return Case(_frame(rng), asked, right, 1e-6, "bars are exact at their ends; rounding of long ones", _KNOBS)


@capability("frames: reaction of a force at the tip", "independent")
def _(rng: np.random.Generator) -> Case:
    force = np.round(rng.normal(size=3) * 10, 2)

    def asked(model: Model, door: Door) -> Floats:
        words = (f"tip.{axis}={float(size)} N" for axis, size in zip("xyz", force, strict=True))
        return np.array(door.statics(model, *words)["forces_n"]["wall"])

    return Case(_frame(rng), asked, lambda *_: force, 1e-6, "equilibrium; rounding of the solution", _KNOBS)


@capability("frames: natural frequencies", "independent")
def _(rng: np.random.Generator) -> Case:
    def right(model: Model, _: Door) -> Floats:
        return clamped_frequencies(_tube(model), _corners(model), _MODES)

    why = "rotary inertia and mesh of slender bars: (n pi r / L)^2 / 2 and (k h)^4 / 720, below 1e-3 each"
    return Case(_frame(rng), _frequencies, right, 3e-3, why, _KNOBS)


@capability("frames: turned in space", "relation")
def _(rng: np.random.Generator) -> Case:
    turn = Rotation.random(rng=rng)

    def right(model: Model, door: Door) -> Floats:
        turned: Any = copy.deepcopy(model)
        corners = turn.apply(_corners(model))
        turned["parts"]["f"]["lines"] = [corners.tolist()]
        turned["points"]["root"]["at"], turned["points"]["tip"]["at"] = corners[0].tolist(), corners[-1].tolist()
        return _frequencies(turned, door)

    return Case(_frame(rng), _frequencies, right, 1e-6, "the same structure; tolerance of the eigensolution", _KNOBS)


@capability("frames: E and density doubled", "relation")
def _(rng: np.random.Generator) -> Case:
    def right(model: Model, door: Door) -> Floats:
        heavy: Any = copy.deepcopy(model)
        for name in ("E", "rho"):
            heavy["materials"]["m"][name] *= 2
        return _frequencies(heavy, door)

    return Case(_frame(rng), _frequencies, right, 1e-8, "the same ratio; tolerance of the eigensolution", _KNOBS)
