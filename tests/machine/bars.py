"""Stocky frames in space: any section, arms, joints, springs, bodies and supports, at rest and in their modes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from tests.independent.frames import Floats, Skeleton
from tests.machine.framework import Case, Door, Model, capability
from tests.machine.skeletons import SIX, read

Draft = dict[str, Any]
_MODES = 5
_REST = "bars are exact at their ends; rounding"
_WAVES = "bars of 0.08 m: the error of a mode falls with the fourth power of their length, below 1e-3"
KNOBS: tuple[str, ...] = ()


def a_section(rng: np.random.Generator, shapes: tuple[str, ...] = ("rectangle", "circle", "tube", "box", "I")) -> Draft:
    big, thin = rng.uniform(0.05, 0.1, 2), float(rng.uniform(0.05, 0.09))
    shape = str(rng.choice(shapes))
    if shape == "circle":
        return {"shape": shape, "diameter": float(big[0])}
    if shape == "tube":
        return {"shape": shape, "outer": float(big[0]), "thickness": float(big[0] * rng.uniform(0.1, 0.4))}
    sides = {"shape": shape, "width": float(big[0]), "height": float(big[1])}
    if shape == "box":
        return {**sides, "thickness": float(big.min() * thin)}
    return {**sides, "web": float(big[0] * thin), "flange": float(big[1] * thin)} if shape == "I" else sides


def a_material(rng: np.random.Generator) -> Draft:
    return {
        "E": float(10 ** rng.uniform(9.8, 11.3)),
        "nu": float(rng.uniform(0.05, 0.4)),
        "rho": float(rng.uniform(4e2, 8e3)),
    }


def away(rng: np.random.Generator, low: float = 0.6, high: float = 1.2) -> Floats:
    """A way in any direction."""
    way = rng.normal(size=3)
    return np.round(way / np.linalg.norm(way) * rng.uniform(low, high), 3)


def a_frame(
    rng: np.random.Generator, stretches: int = 2, reach: tuple[float, float] = (0.6, 1.2), **more: Any
) -> Draft:
    """A clamped line of stocky bars; points: root, its corner, tip, and mid between root and corner."""
    corners = [np.zeros(3)]
    for _ in range(stretches):
        corners.append(corners[-1] + away(rng, *reach))
    mid = corners[0] + 0.5 * (corners[1] - corners[0])
    part: Draft = {
        "type": "frame", "material": "m", "section": "s", "mesh": 0.08, "lines": [[one.tolist() for one in corners]],
        **more,
    }  # fmt: skip
    if rng.random() < 0.6:
        part["orientation"] = away(rng).tolist()
    named = {"root": corners[0], "mid": mid, "corner": corners[1], "tip": corners[-1]}
    return {
        "materials": {"m": a_material(rng)},
        "sections": {"s": a_section(rng)},
        "parts": {"f": part},
        "points": {name: {"on": "f", "at": at.tolist()} for name, at in named.items()},
        "supports": {"wall": {"at": "root", "fix": "clamped"}},
        "damping": {"ratio": 0.01},
    }


def push(rng: np.random.Generator, *points: str) -> dict[tuple[str, str], float]:
    """Forces at points."""
    sizes = np.round(rng.normal(size=(len(points), 3)) * 100, 1)
    return {(point, one): float(size) for point, row in zip(points, sizes, strict=True)
            for one, size in zip("xyz", row, strict=True)}  # fmt: skip


def words(forces: Mapping[tuple[str, str], float]) -> list[str]:
    return [f"{point}.{one}={size} N" for (point, one), size in forces.items()]


def loaded(
    bones: Skeleton, where: Mapping[str, int], forces: Mapping[tuple[str, str], float], weight: float = 0.0
) -> Floats:
    """Forces of all points; two may be at one place."""
    F = bones.load({}, weight)
    for (point, one), size in forces.items():
        F[6 * where[point] + SIX.index(one)] += size
    return F


def at_rest(
    model: Model, forces: Mapping[tuple[str, str], float], points: tuple[str, ...], weight: float = 0.0
) -> Floats:
    bones, where = read(model)
    moved = bones.rest(loaded(bones, where, forces, weight))
    return np.concatenate([moved[6 * where[p] : 6 * where[p] + 6] for p in points])


def rest_case(
    draft: Draft, forces: Mapping[tuple[str, str], float], points: tuple[str, ...] = ("tip", "mid"),
    tolerance: float = 1e-6, reason: str = _REST, weight: bool = False,
) -> Case:  # fmt: skip
    """Displacements and turns of points at rest, in the largest's measure."""

    def asked(model: Model, door: Door) -> Floats:
        found = door.statics(model, *words(forces), weight=weight)["points"]
        return np.concatenate([np.array(found[p]) for p in points])

    def right(model: Model, _: Door) -> Floats:
        return at_rest(model, forces, points, 9.80665 if weight else 0.0)

    return Case(draft, asked, right, tolerance, reason, KNOBS)


def modes_case(draft: Draft, tolerance: float = 2e-3, reason: str = _WAVES, count: int = _MODES) -> Case:
    def right(model: Model, _: Door) -> Floats:
        return read(model)[0].modes(count)[0]

    return Case(draft, lambda model, door: door.modes(model, count), right, tolerance, reason, KNOBS)


def either(rng: np.random.Generator, draft: Draft, *points: str) -> Case:
    """At rest or in its modes, by lot."""
    if rng.random() < 0.5:
        return modes_case(draft)
    return rest_case(draft, push(rng, *points), points)


@capability("bars: at rest", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng, int(rng.integers(1, 4)), element=str(rng.choice(["timoshenko", "timoshenko18"])))
    return rest_case(draft, push(rng, "tip", "corner"), ("tip", "corner"))


@capability("bars: natural frequencies", "independent")
def _(rng: np.random.Generator) -> Case:
    return modes_case(a_frame(rng, int(rng.integers(1, 4))))


@capability("bars: a force between nodes", "independent")
def _(rng: np.random.Generator) -> Case:
    """One bar a stretch: the point is between its nodes, or takes one."""
    draft = a_frame(rng)
    del draft["parts"]["f"]["mesh"]
    return rest_case(draft, push(rng, "mid"), ("mid", "tip"))


@capability("bars: arms at their ends", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng, 1)
    arms = [away(rng, 0.02, 0.1).tolist() for _ in range(2)]
    draft["parts"]["f"]["offsets"] = dict(zip(("start", "end"), arms, strict=True))
    del draft["points"]["mid"]
    return either(rng, draft, "tip")


@capability("bars: a line beside its places", "independent")
def _(rng: np.random.Generator) -> Case:
    """Both arms alike, across the bar."""
    draft = a_frame(rng, 1)
    along = np.array(draft["points"]["tip"]["at"])
    arm = np.cross(along, away(rng))
    arm = (arm / np.linalg.norm(arm) * rng.uniform(0.02, 0.1)).tolist()
    draft["parts"]["f"]["offsets"] = {"start": arm, "end": arm}
    return either(rng, draft, "tip", "mid")


def second(rng: np.random.Generator, draft: Draft, start: Floats, end: Floats, **joint: Any) -> Draft:
    """A second frame of its own section and material, joined."""
    draft["sections"]["t"], draft["materials"]["n"] = a_section(rng), a_material(rng)
    lines = [[np.asarray(one).tolist() for one in (start, end)]]
    draft["parts"]["g"] = {"type": "frame", "material": "n", "section": "t", "mesh": 0.08, "lines": lines}
    draft["points"]["end"] = {"on": "g", "at": lines[0][1]}
    draft["points"]["foot"] = {"on": "g", "at": lines[0][0]}
    draft["joints"] = {"j": {"connect": ["f", "g"], **joint}}
    return draft


@capability("bars: frames joined at a corner", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    corner = np.array(draft["points"]["corner"]["at"])
    return either(rng, second(rng, draft, corner, corner + away(rng)), "end", "tip")


@capability("bars: a frame that crosses another", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    mid, way = np.array(draft["points"]["mid"]["at"]), away(rng)
    draft = second(rng, draft, mid - 0.4 * way, mid + 0.6 * way)
    return either(rng, draft, "end", "tip")


@capability("bars: a pinned joint", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    corner = np.array(draft["points"]["corner"]["at"])
    draft = second(rng, draft, corner, corner + away(rng), kind="pinned")
    draft["supports"]["other"] = {"at": "end", "fix": "clamped"}
    return either(rng, draft, "tip", "corner")


@capability("bars: a joint that gives way", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    corner = np.array(draft["points"]["corner"]["at"])
    m, s = draft["materials"]["m"], 0.07**4 / 12
    size = m["E"] * s
    chosen = [one for one in SIX if rng.random() < 0.6] or ["rz"]
    stiffness = {one: float(size * (1 if one[0] == "r" else 20) * 10 ** rng.uniform(-1, 1)) for one in chosen}
    draft = second(rng, draft, corner, corner + away(rng), stiffness=stiffness)
    draft["supports"]["other"] = {"at": "end", "fix": "simple"}
    return either(rng, draft, "tip", "corner")


def bending(draft: Draft) -> float:
    """A stiffness that matters [N/m]."""
    return float(draft["materials"]["m"]["E"] * 0.06**4)


@capability("bars: springs", "independent")
def _(rng: np.random.Generator) -> Case:
    """To the ground, and between frames that touch where no joint is."""
    draft = a_frame(rng)
    tip = np.array(draft["points"]["tip"]["at"])
    draft = second(rng, draft, tip, tip + away(rng))
    del draft["joints"]
    draft["supports"]["other"] = {"at": "end", "fix": "clamped"}
    size = bending(draft)
    for name, ends in (("k", ["tip", "foot"]), ("q", ["corner", "ground"])):
        draft["parts"][name] = {
            "type": "spring", "between": ends,
            "stiffness": {one: float(size * 10 ** rng.uniform(-1, 1)) for one in SIX if rng.random() < 0.7},
        }  # fmt: skip
    draft["parts"]["k"]["stiffness"]["z"] = size
    draft["parts"]["q"]["stiffness"]["x"] = size
    return either(rng, draft, "tip", "corner", "foot")


def bodies_on(
    rng: np.random.Generator, draft: Draft, mass: tuple[float, float], coupled: float, spread: float,
    arm: tuple[float, float],
) -> float:  # fmt: skip
    """A mass at the corner, in shares of what a metre of the frame weighs, and a body on an arm from the tip: inertia
    in shares of its mass, with products; that weight [kg]."""
    weigh = float(draft["materials"]["m"]["rho"] * 0.005)
    draft["parts"]["w"] = {"type": "mass", "at": "corner", "mass": float(weigh * rng.uniform(*mass))}
    spin = np.diag(rng.uniform(0.5, 0.7, 3)) + coupled * np.ones((3, 3))
    tensor = (0.5 * weigh * spread) * (spin + spin.T)
    draft["parts"]["b"] = {
        "type": "inertia", "at": "tip", "mass": weigh,
        "inertia": [*np.diag(tensor).tolist(), *(-float(tensor[i, j]) for i, j in ((0, 1), (1, 2), (2, 0)))],
        "offset": away(rng, *arm).tolist(),
    }  # fmt: skip
    return weigh


@capability("bars: masses and bodies", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    weigh = bodies_on(rng, draft, (0.2, 1), 0.05, 0.05, (0.05, 0.3))
    draft["parts"]["l"] = {"type": "mass", "on": "f", "mass": f"{float(weigh * rng.uniform(0.2, 1)):.6g} kg/m"}
    if rng.random() < 0.4:
        return rest_case(draft, {}, weight=True)
    return modes_case(draft)


@capability("bars: reactions", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng, 3)
    fixed = [one for one in SIX if rng.random() < 0.5] or ["z"]
    draft["supports"]["other"] = {"at": "tip", "fix": fixed}
    draft["supports"]["third"] = {"at": "corner", "fix": ["y"]}
    draft["parts"]["k"] = {"type": "spring", "between": ["mid", "ground"], "stiffness": {"x": bending(draft)}}
    heavy, forces = bool(rng.random() < 0.5), push(rng, "mid", "corner")

    def asked(model: Model, door: Door) -> Floats:
        found = door.statics(model, *words(forces), weight=heavy)["forces_n"]
        return np.concatenate([np.array(found[one]) for one in ("wall", "other", "third", "k")])

    def right(model: Model, _: Door) -> Floats:
        bones, where = read(model)
        load = loaded(bones, where, forces, 9.80665 * heavy)
        moved = bones.rest(load)
        pushes = bones.pushes(moved, load)
        held = [pushes[6 * where[model["supports"][s]["at"]] :][:3] for s in ("wall", "other", "third")]
        spring = model["parts"]["k"]["stiffness"]["x"] * moved[6 * where["mid"]]
        return np.concatenate([*held, [spring, 0, 0]])

    return Case(draft, asked, right, 1e-6, "equilibrium and bars exact at their ends; rounding", ())


@capability("bars: under their weight", "independent")
def _(rng: np.random.Generator) -> Case:
    why = "the weight on bars of 0.08 m as forces and moments of their ends: exact but for shear, (h / L)^2 of it"
    return rest_case(a_frame(rng), push(rng, "tip"), weight=True, tolerance=1e-5, reason=why)


@capability("bars: largest stress", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    draft["sections"]["s"] = a_section(rng, ("rectangle", "box", "I"))
    forces = push(rng, "tip")

    def asked(model: Model, door: Door) -> Floats:
        return np.array([door.statics(model, *words(forces))["stresses"]["f"]["largest_pa"]])

    def right(model: Model, _: Door) -> Floats:
        bones, where = read(model)
        moved = bones.rest(loaded(bones, where, forces))
        return np.array([np.abs(bones.stresses(moved)).max()])

    return Case(
        draft, asked, right, 1e-5, "N / A + M / W and the shear of torsion at the ends of bars; rounding", KNOBS
    )


@capability("bars: stress and motion between nodes, under weight", "independent")
def _(rng: np.random.Generator) -> Case:
    """One or a few bars a stretch, upright or leaning, each looked at in quarters of its length."""
    element = str(rng.choice(["euler", "timoshenko", "timoshenko18"]))
    draft = a_frame(rng, int(rng.integers(1, 3)), reach=(1.5, 4.0), element=element)
    part, points = draft["parts"]["f"], draft["points"]
    del points["mid"], part["mesh"]
    if rng.random() < 0.5:
        rise = float(np.round(rng.uniform(1.5, 4), 3))
        part["lines"][0] = [[0.0, 0.0, 0.0], [0.0, 0.0, rise]]
        points["corner"]["at"] = points["tip"]["at"] = [0.0, 0.0, rise]
        part["orientation"] = [1.0, 0.0, 0.0]
    draft["sections"]["s"] = a_section(rng, ("rectangle", "box", "I"))
    if rng.random() < 0.6:
        fix = [one for one in SIX[:5] if rng.random() < 0.5] or ["z"]
        draft["supports"]["other"] = {"at": "tip", "fix": fix}
    forces = push(rng, "corner") if rng.random() < 0.3 else {}

    def asked(model: Model, door: Door) -> Floats:
        found = door.statics(model, *words(forces), weight=True)
        door.told = [one for one in door.told if not one.startswith("stress")]
        return np.array([found["stresses"]["f"]["largest_pa"], found["parts_m"]["f"]])

    def right(model: Model, _: Door) -> Floats:
        bones, where = read(model)
        moved = bones.rest(loaded(bones, where, forces, 9.80665))
        far = np.linalg.norm(bones.between(moved, 5), axis=2)
        return np.array([np.abs(bones.stresses(moved, 5)).max(), far.max()])

    why = "N / A + M / W and the shear of torsion at the quarters of bars; rounding, and of slender bars some shear"
    return Case(draft, asked, right, 1e-5, why, KNOBS, each=True)


@capability("bars: a support that leans", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    lean = rng.normal(size=3)
    factors = {f"tip.{one}": float(size) for one, size in zip("xyz", lean, strict=True)}
    draft["constraints"] = {"track": {"equation": factors}}
    return either(rng, draft, "tip", "corner")


@capability("bars: a rigid link", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng, 3)
    draft["constraints"] = {"link": {"rigid": "mid", "to": "tip"}}
    return either(rng, draft, "tip", "corner")


@capability("bars: supports of some directions", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    draft["supports"]["wall"]["fix"] = "simple"
    draft["supports"]["other"] = {"at": "tip", "fix": [one for one in SIX if rng.random() < 0.7 or one in ("x", "ry")]}
    draft["supports"]["third"] = {
        "at": "corner",
        "fix": [one for one in SIX if rng.random() < 0.3 or one in ("z", "rx")],
    }
    return either(rng, draft, "mid")
