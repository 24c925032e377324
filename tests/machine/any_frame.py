"""Frames in space and blocks with all that hangs on them: any answer of each."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.independent.frames import Skeleton
from tests.independent.linear import Linear
from tests.machine.bars import a_frame, away, bending, bodies_on, second
from tests.machine.blocks import a_block
from tests.machine.columns import ANSWERS, Subject, case_of
from tests.machine.framework import Case, Model, capability
from tests.machine.skeletons import SIX, read

Draft = dict[str, Any]
_WHY = "bars of 0.08 m: modes within 1e-3; residual vectors keep 1e-3 of the largest; at rest ends of bars are exact"


def linear(bones: Skeleton, where: dict[str, int]) -> Linear:
    """Without what holds it."""
    T = bones.free()
    K, M, C, H = (T.T @ bones.matrix(kind) @ T for kind in "KMCH")
    rows = {(name, one): T[6 * place + k] for name, place in where.items() for k, one in enumerate(SIX)}
    rides = [np.tile([axis == one for one in SIX], len(bones.at)).astype(float) for axis in "xyz"]
    return Linear(K, M, C, H, rows, np.array([T.T @ (bones.matrix("M") @ ride) for ride in rides]))


def _form(model: Model) -> Linear:
    return linear(*read(model))


def _answers(rng: np.random.Generator, draft: Draft, *places: str, answers: tuple[str, ...] = ANSWERS) -> Case:
    """Of places along any axis, under a force along the first."""
    ways = [f"{place}.{rng.choice(['x', 'y', 'z'])}" for place in places for _ in range(2)]
    return case_of(
        rng, Subject(draft, _form, ways[:1], list(dict.fromkeys(ways)), 1e-3, _WHY, answers=answers, at_rest=1e-5)
    )


@capability("any answer: sections by their constants", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    A = float(rng.uniform(3e-3, 8e-3))
    sizes = {key: float(A**2 * rng.uniform(0.06, 0.2)) for key in ("Iy", "Iz", "J")}
    draft["sections"]["s"] = {"A": A, **sizes, "ky": float(rng.uniform(0.3, 0.9)), "kz": float(rng.uniform(0.3, 0.9))}
    return _answers(rng, draft, "tip", "corner")


@capability("any answer: sections of all shapes", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng, element=str(rng.choice(["timoshenko", "timoshenko18"])))
    return _answers(rng, draft, "tip", "corner")


def _under_a_heavy_body(rng: np.random.Generator, draft: Draft) -> Case:
    """Ten thousand times as heavy as the frame."""
    bodies_on(rng, draft, (0.5e4, 1e4), 0.05, float(10 ** rng.uniform(-2, 0.5)), (0.2, 0.6))
    body = draft["parts"]["b"]
    body |= {"mass": 1e4 * body["mass"], "inertia": [1e4 * one for one in body["inertia"]]}
    why = "a frame of 1e-4 of its body's mass, whose own motion is within 1e-4; residual vectors"
    ways = [f"tip.{axis}" for axis in rng.permutation(["x", "y", "z"])[:2]]
    return case_of(rng, Subject(draft, _form, ways[:1], ways, 1e-4, why, at_rest=1e-5))


def _timber(rng: np.random.Generator) -> Draft:
    """A material of directions that shears ten times as easily as others, differently in both planes."""
    E = float(10 ** rng.uniform(9.8, 10.3))
    G = [float(E * share) for share in (rng.uniform(0.03, 0.1), rng.uniform(0.004, 0.01), rng.uniform(0.03, 0.1))]
    return {
        "E": [E, *(E * rng.uniform(0.03, 0.06, 2)).tolist()],
        "G": G,
        "nu": 0.3,
        "rho": float(rng.uniform(4e2, 7e2)),
    }


@capability("any answer: frames of timber", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    draft["materials"]["m"] = _timber(rng)
    return _answers(rng, draft, "tip", "corner")


@capability("any answer: a heavy body on stubs of timber", "independent")
def _(rng: np.random.Generator) -> Case:
    """So short that they shear as much as they bend; springs to the body, exact at their ends."""
    draft = a_frame(rng, int(rng.integers(1, 3)), reach=(0.25, 0.45))
    draft["materials"]["m"] = _timber(rng)
    if rng.random() < 0.5:
        big = rng.uniform(0.06, 0.1, 2).tolist()
        draft["sections"]["s"] = {"shape": "rectangle", "width": big[0], "height": big[1]}
    return _under_a_heavy_body(rng, draft)


@capability("any answer: rigid arms", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng, 1)
    draft["parts"]["f"]["offsets"] = {one: away(rng, 0.05, 0.2).tolist() for one in ("start", "end")}
    del draft["points"]["mid"]
    return _answers(rng, draft, "tip")


@capability("any answer: joints that give way", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    corner = np.array(draft["points"]["corner"]["at"])
    size = draft["materials"]["m"]["E"] * 0.07**4 / 12
    stiffness = {one: float(size * (1 if one[0] == "r" else 20) * 10 ** rng.uniform(-0.5, 0.7)) for one in SIX}
    draft = second(rng, draft, corner, corner + away(rng), stiffness=stiffness)
    return _answers(rng, draft, "end", "tip")


@capability("any answer: pinned joints", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    corner = np.array(draft["points"]["corner"]["at"])
    draft = second(rng, draft, corner, corner + away(rng), kind="pinned")
    draft["supports"]["other"] = {"at": "end", "fix": "clamped"}  # pinned at both ends it would spin
    return _answers(rng, draft, "tip", "corner")


@capability("any answer: springs and dashpots", "independent")
def _(rng: np.random.Generator) -> Case:
    """Of all six directions, to the ground and between two places."""
    draft = a_frame(rng)
    tip = np.array(draft["points"]["tip"]["at"])
    draft = second(rng, draft, tip, tip + away(rng))
    del draft["joints"]
    draft["supports"]["other"] = {"at": "end", "fix": "clamped"}
    size, (f, shapes) = bending(draft), read(draft)[0].modes(1)
    rate = 0.4 * np.pi * f[0] / float(np.abs(shapes[:, 0]).max()) ** 2
    for name, ends in (("k", ["tip", "foot"]), ("q", ["corner", "ground"])):
        draft["parts"][name] = {
            "type": "spring", "between": ends,
            "stiffness": {one: float(size * 10 ** rng.uniform(-1, 0.5)) for one in SIX},
        }  # fmt: skip
        if rng.random() < 0.6:
            draft["parts"][name]["damping"] = {one: float(rate * rng.uniform(0.3, 2)) for one in SIX}
    return _answers(rng, draft, "tip", "corner")


@capability("any answer: masses and bodies on frames", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    bodies_on(rng, draft, (0.5, 2), 0.15, 0.2, (0.2, 0.5))
    return _answers(rng, draft, "corner", "tip")


@capability("any answer: a leaning support and a link", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng, 3)
    lean = rng.normal(size=3)
    factors = {f"tip.{one}": float(size) for one, size in zip("xyz", lean, strict=True)}
    draft["constraints"] = {"track": {"equation": factors}, "link": {"rigid": "mid", "to": "corner"}}
    if rng.random() < 0.5:
        draft["supports"]["wall"]["fix"] = "simple"
        draft["supports"]["other"] = {"at": "corner", "fix": ["rx", "ry"]}
    return _answers(rng, draft, "tip", "corner")


@capability("any answer: what frames lose", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    corner = np.array(draft["points"]["corner"]["at"])
    draft = second(rng, draft, corner, corner + away(rng))
    for one in draft["materials"].values():
        one["loss_factor"] = float(rng.uniform(0.05, 0.15))
    draft["damping"] = {"from": "materials"}
    return _answers(rng, draft, "end", "tip", answers=("losses", "frf"))


@capability("any answer: blocks on springs and mats", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_block(rng)
    mass = draft["parts"]["m"]["mass"]
    if rng.random() < 0.6:
        for one in "abc":
            draft["parts"][f"k{one}"]["damping"] = {axis: float(mass * rng.uniform(0.5, 2)) for axis in "xyz"}
    if rng.random() < 0.6:
        size = np.array(draft["parts"]["m"]["size"])
        stiff = float(draft["parts"]["ka"]["stiffness"]["z"] / size[:2].prod())
        sides = (size[:2] * rng.uniform(0.4, 0.9, 2)).round(3)
        at = (sides / 2 + (size[:2] - sides) * rng.uniform(0, 1, 2)).round(3)
        region: Any = {"rectangle": sides.tolist(), "at": at.tolist()}
        stiffness = {"normal": stiff, "shear": float(stiff * rng.uniform(0.2, 1))}
        draft["parts"]["mat"] = {"type": "foundation", "on": "m", "region": region, "stiffness": stiffness}
    draft["damping"] = {"ratio": 0.03}
    ways = [f"{place}.{axis}" for place, axis in zip(("d", "inside"), rng.choice(["x", "y", "z"], 2), strict=True)]
    why = "six modes are all there are; rounding, and lines of vibration"
    return case_of(rng, Subject(draft, _form, ways[:1], ways, 1e-4, why))


@capability("any answer: a heavy body on a light frame", "independent")
def _(rng: np.random.Generator) -> Case:
    """Bars are springs to it, exact at their ends: small changes of any of their constants are seen."""
    draft = a_frame(rng, int(rng.integers(1, 3)))
    if rng.random() < 0.5:
        A = float(rng.uniform(3e-3, 8e-3))
        sizes = {key: float(A**2 * rng.uniform(0.06, 0.2)) for key in ("Iy", "Iz", "J")}
        factors = {key: float(rng.uniform(0.3, 0.6)) for key in ("ky", "kz")}
        draft["sections"]["s"] = {"A": A, **sizes, **factors}
    draft["materials"]["m"]["nu"] = float(rng.uniform(0.3, 0.45))
    return _under_a_heavy_body(rng, draft)


_TABLES = {  # Cremer, Heckl, Petersson, Structure-Borne Sound (2005), table 4.3
    "steel": {"E": 210e9, "nu": 0.31, "rho": 7800.0},
    "aluminium": {"E": 72e9, "nu": 0.34, "rho": 2700.0},
}


def _of_tables(model: Model) -> Linear:
    return _form({**model, "materials": {name: _TABLES[one["like"]] for name, one in model["materials"].items()}})


@capability("any answer: a material of the library", "independent")
def _(rng: np.random.Generator) -> Case:
    """With a mass at the tip."""
    draft = a_frame(rng)
    draft["materials"]["m"] = {"like": str(rng.choice(list(_TABLES)))}
    draft["parts"]["w"] = {"type": "mass", "at": "tip", "mass": float(rng.uniform(5, 20))}
    ways = [f"tip.{rng.choice(['x', 'y', 'z'])}"]
    return case_of(rng, Subject(draft, _of_tables, ways, ways, 1e-3, _WHY, at_rest=1e-5))
