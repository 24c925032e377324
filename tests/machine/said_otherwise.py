"""The same frame said in another way, and limits that must be reached."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from tests.independent.frames import Floats
from tests.machine.bars import a_frame, away, bending, push, second, words
from tests.machine.framework import Case, Door, Model, capability

Draft = dict[str, Any]
_SAME = "the same structure; tolerance of the eigensolution"
_COUNT = 4


def _modes(model: Model, door: Door) -> Floats:
    return door.modes(model, _COUNT)


def _two(rng: np.random.Generator) -> Draft:
    draft = a_frame(rng)
    corner = np.array(draft["points"]["corner"]["at"])
    draft = second(rng, draft, corner, corner + away(rng))
    draft["parts"]["k"] = {"type": "spring", "between": ["end", "ground"], "stiffness": {"x": bending(draft)}}
    draft["parts"]["w"] = {"type": "mass", "at": "tip", "mass": float(rng.uniform(1, 5))}
    return draft


def _as_other(draft: Draft, other: Any, tolerance: float = 1e-6, reason: str = _SAME) -> Case:
    """Modes of a model and of another made of it."""

    def right(model: Model, door: Door) -> Floats:
        return _modes(other(copy.deepcopy(dict(model))), door)

    return Case(draft, _modes, right, tolerance, reason)


@capability("said otherwise: mirrored", "relation")
def _(rng: np.random.Generator) -> Case:
    def other(model: Draft) -> Draft:
        flip = np.array([1, -1, 1])
        for part in model["parts"].values():
            if part["type"] == "frame":
                part["lines"] = [(np.array(line) * flip).tolist() for line in part["lines"]]
                if "orientation" in part:
                    part["orientation"] = (np.array(part["orientation"]) * flip).tolist()
        for point in model["points"].values():
            point["at"] = (np.array(point["at"]) * flip).tolist()
        return model

    return _as_other(_two(rng), other)


@capability("said otherwise: units as text", "relation")
def _(rng: np.random.Generator) -> Case:
    def other(model: Draft) -> Draft:
        for one in model["materials"].values():
            one["E"], one["rho"] = f"{one['E'] / 1e9!r} GPa", f"{one['rho'] / 1e3!r} g/cm^3"
            one["nu"] = f"{one['nu'] * 100!r} %"
        for one in model["sections"].values():
            for key in set(one) - {"shape"}:
                one[key] = f"{one[key] * 1e3!r} mm"
        for part in model["parts"].values():
            if part["type"] == "frame":
                part["mesh"] = "8 cm"
                part["lines"] = [[[f"{x * 100!r} cm" for x in at] for at in line] for line in part["lines"]]
        model["parts"]["k"]["stiffness"]["x"] = f"{model['parts']['k']['stiffness']['x'] / 1e6!r} N/um"
        model["parts"]["w"]["mass"] = f"{model['parts']['w']['mass'] * 1e3!r} g"
        return model

    return _as_other(_two(rng), other)


@capability("said otherwise: parts in another order", "relation")
def _(rng: np.random.Generator) -> Case:
    def other(model: Draft) -> Draft:
        for key in ("materials", "sections", "parts", "points"):
            model[key] = dict(reversed(model[key].items()))
        model["joints"]["j"]["connect"].reverse()
        return model

    return _as_other(_two(rng), other)


@capability("said otherwise: a part split in two", "relation")
def _(rng: np.random.Generator) -> Case:
    def other(model: Draft) -> Draft:
        line = model["parts"]["f"]["lines"][0]
        model["parts"]["h"] = {**model["parts"]["f"], "lines": [line[1:]]}
        model["parts"]["f"]["lines"] = [line[:2]]
        model["points"]["tip"]["on"] = "h"
        model["joints"] = {"a": {"connect": ["f", "h"]}}
        return model

    return _as_other(a_frame(rng), other)


@capability("said otherwise: a line from its other end", "relation")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    first = np.array(draft["points"]["corner"]["at"])
    other_way = np.array(draft["points"]["tip"]["at"]) - first
    draft["parts"]["f"]["orientation"] = (np.cross(first, other_way) + 0.1 * first).tolist()

    def other(model: Draft) -> Draft:
        model["parts"]["f"]["lines"][0].reverse()
        return model

    return _as_other(draft, other)


@capability("said otherwise: superposition at rest", "relation")
def _(rng: np.random.Generator) -> Case:
    draft = _two(rng)
    first, then = push(rng, "tip"), push(rng, "end")

    def answer(model: Model, door: Door, *forces: str, weight: bool = False) -> Floats:
        found = door.statics(model, *forces, weight=weight)
        return np.r_[
            found["points"]["tip"], found["points"]["end"], np.array(found["forces_n"]["wall"]) / bending(draft)
        ]

    def asked(model: Model, door: Door) -> Floats:
        return answer(model, door, *words(first), *words(then), weight=True)

    def right(model: Model, door: Door) -> Floats:
        return answer(model, door, *words(first), weight=True) + answer(model, door, *words(then))

    return Case(draft, asked, right, 1e-8, "a linear structure; rounding")


@capability("said otherwise: a number by --set or in the file", "relation")
def _(rng: np.random.Generator) -> Case:
    draft = _two(rng)
    path = ["materials.m.E", "materials.n.rho", "parts.w.mass", "parts.k.stiffness.x", "materials.m.nu"][
        rng.integers(5)
    ]
    factor = float(rng.uniform(0.6, 1.2))

    def there(model: Draft) -> tuple[Draft, str]:
        *way, last = path.split(".")
        for key in way:
            model = model[key]
        return model, last

    def asked(model: Model, door: Door) -> Floats:
        holder, last = there(dict(model))
        words = ("--count", str(_COUNT), "--set", f"{path}={holder[last] * factor!r}")
        return np.array(door.ask(model, "modes", *words)["frequency_hz"])

    def right(model: Model, door: Door) -> Floats:
        changed = copy.deepcopy(dict(model))
        holder, last = there(changed)
        holder[last] *= factor
        return _modes(changed, door)

    return Case(draft, asked, right, 1e-12, "the same number; the same computation")


@capability("said otherwise: a number by a case or in the file", "relation")
def _(rng: np.random.Generator) -> Case:
    """The rms of a shaken frame."""
    model = _two(rng)
    values = [float(model["materials"]["m"]["E"] * factor) for factor in rng.uniform(0.7, 1.3, 2)]
    study = {
        "model": "m.yaml", "modes": {"up_to": "600 Hz"},
        "vibration": {"v": {"base": "z", "psd": 0.01, "band": [2.0, 150.0]}},
        "record": {"tip.z": "acceleration"},
    }  # fmt: skip
    draft = {"study": study, "m": model}

    def rms(case: dict[str, Any]) -> float:
        return float(case["vibration"]["v"]["answers"]["tip.z acceleration"]["rms"])

    def asked(model: Model, door: Door) -> Floats:
        cases = {f"c{k}": {"materials.m.E": value} for k, value in enumerate(values)}
        found = door.ask({**model["study"], "cases": cases}, "run", "--no-pictures", m=model["m"])
        return np.array([rms(found["cases"][f"c{k}"]) for k in range(2)])

    def right(model: Model, door: Door) -> Floats:
        answers = []
        for value in values:
            changed = copy.deepcopy(dict(model["m"]))
            changed["materials"]["m"]["E"] = value
            answers.append(rms(door.ask(model["study"], "run", "--no-pictures", m=changed)["cases"]["as given"]))
        return np.array(answers)

    return Case(draft, asked, right, 1e-9, "the same number; the same computation")


@capability("limits: a stiff spring is a support", "limit")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    axis = str(rng.choice(["x", "y", "z"]))
    draft["parts"]["k"] = {"type": "spring", "between": ["tip", "ground"], "stiffness": {axis: 1e5 * bending(draft)}}

    def other(model: Draft) -> Draft:
        del model["parts"]["k"]
        model["supports"]["held"] = {"at": "tip", "fix": [axis]}
        return model

    return _as_other(draft, other, 1e-3, "1e5 times stiffer than the frame")


@capability("limits: hardly any mass is none", "limit")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    draft["parts"]["w"] = {"type": "mass", "at": "tip", "mass": 1e-9}
    draft["parts"]["k"] = {"type": "spring", "between": ["corner", "ground"], "stiffness": {"x": 1e-6}}

    def other(model: Draft) -> Draft:
        del model["parts"]["w"], model["parts"]["k"]
        return model

    return _as_other(draft, other)


@capability("limits: a stiff joint is rigid, a soft one open", "limit")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    corner = np.array(draft["points"]["corner"]["at"])
    stiff = bool(rng.random() < 0.5)
    size = 1e4 * bending(draft) if stiff else 1e-6
    springs = dict.fromkeys(("rx", "ry", "rz"), size)
    draft = second(rng, draft, corner, corner + away(rng), stiffness=springs)
    draft["supports"]["other"] = {"at": "end", "fix": "clamped"}

    def other(model: Draft) -> Draft:
        joint = model["joints"]["j"]
        del joint["stiffness"]
        joint["kind"] = "rigid" if stiff else "pinned"
        return model

    return _as_other(draft, other, 2e-3, "1e4 times stiffer than the frame")
