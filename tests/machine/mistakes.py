"""A model with one mistake: refused, and told with the place of it. The model without one is taken."""

from __future__ import annotations

import copy
import re
from typing import Any, Final

import numpy as np

from tests.machine.framework import Case, Door, Floats, Model, Refused, capability

Draft = dict[str, Any]
_GONE: Final = object()
_PLATE: Final = {"type": "plate", "material": "m", "size": [2.0, 1.5], "thickness": 0.02, "mesh": 0.5}
_SMEARED: Final = {"D": [6e6, 2e6, 1e5, 5e5], "S": [1e7, 1e7], "mass": 84.0}


def _smeared(**other: Any) -> Draft:
    """A plate of smeared ribs."""
    part = {key: one for key, one in _PLATE.items() if key != "material"}
    return {**part, "origin": [0, 0, 0], "smeared": {**_SMEARED, **other}}


_TIMES: Final = {"reverberation_times": {"63 Hz": "0.4 s"}}
_EDGE: Final = {"on": "p", "edge": "x0"}
_HUNG: Final = {"normal": "1 MN/m"}
_HANGERS: Final = {"type": "hangers", "between": ["p", "c"], "stiffness": {"normal": "1 MN/m^2"}}


def _base() -> Draft:
    return {
        "materials": {
            "m": {"E": "30 GPa", "nu": 0.2, "rho": 2400},
            "t": {"E": ["11 GPa", "0.4 GPa"], "G": ["0.7 GPa", "0.05 GPa"], "nu": 0.3, "rho": 450},
        },
        "sections": {"s": {"shape": "rectangle", "width": 0.05, "height": 0.1}},
        "parts": {
            "p": {**_PLATE, "origin": [0, 0, 0]}, "c": {**_PLATE, "origin": [0, 0, -0.3]},
            "f": {"type": "frame", "material": "m", "section": "s", "mesh": 0.5, "lines": [[[0, 0.5, 0], [2, 0.5, 0]]]},
            "g": {"type": "frame", "material": "m", "section": "s", "mesh": 0.5, "lines": [[[0, 0.5, 0], [0, 0.5, 2]]]},
            "h": {"type": "hangers", "between": ["p", "c"], "stiffness": _HUNG, "spacing": [0.5, 0.5]},
            "i": {"type": "inertia", "at": "b", "mass": 2, "inertia": [0.1, 0.1, 0.1]},
            "k": {"type": "spring", "between": ["a", "ground"], "stiffness": {"z": "1 kN/m"}},
        },
        "points": {
            "a": {"on": "p", "at": [0.4, 0.3]}, "b": {"on": "g", "at": [0, 0.5, 2]}, "d": {"on": "p", "at": "center"},
        },
        "joints": {"j": {"connect": ["f", "p"]}, "l": {"connect": ["f", "g"]}},
        "supports": {"e": {"on": "p", "edge": "x0", "fix": "simple"}, "z": {"on": "c", "edge": "all", "fix": "simple"},
                     "t": {"at": "b", "fix": ["x", "y"]}},
        "constraints": {"r": {"rigid": "a", "to": "d"}},
        "damping": {"ratio": 0.01},
    }  # fmt: skip


# What is changed, to what, and the place that is told.
_MISTAKES: Final[list[tuple[str, Any, str]]] = [
    ("supports.e.fix", _GONE, "supports.e"),
    ("supports.e.fix", "welded", "supports.e.fix"),
    ("supports.e.fix", ["z", "up"], "supports.e.fix"),
    ("supports.e.edge", "x2", "supports.e.edge"),
    ("supports.e", {"on": "p", "stiffness": {"z": 1e6}}, "supports.e"),
    ("supports.e", {"on": "p", "edge": "x0", "fix": "clamped", "stiffness": {"about edge": 1e4}}, "supports.e.fix"),
    ("supports.e", {"on": "p", "edge": "x0", "fix": "simple", "stiffness": {"z": 1e6}}, "supports.e.stiffness.z"),
    ("supports.e", {"on": "p", "edge": "x0", "walls": 2}, "supports.e"),
    ("supports.e", {**_EDGE, "walls": 5, "wall": {"material": "m", "thickness": 0.2}}, "supports.e.walls"),
    ("supports.e", {**_EDGE, "walls": 1, "wall": {"material": "t", "thickness": 0.2}}, "supports.e"),
    ("supports.e", {**_EDGE, "walls": 1, "wall": {"material": "m", "thickness": 4}}, "supports.e.wall"),
    ("supports.e", {"on": "p", "fix": "simple"}, "supports.e.fix"),
    ("supports.e", {"on": "p", "edge": "x0", "line": [[0, 0], [0, 1]], "fix": "simple"}, "supports.e"),
    ("supports.e.fix", "simple soft", "supports.e.fix"),
    ("supports.e.on", "nobody", "supports.e.on"),
    ("supports.e", {"on": "f", "edge": "x0", "fix": "simple"}, "supports.e.on"),
    ("supports.t.at", "nobody", "supports.t.at"),
    ("supports.t.fix", "simple hard", "supports.t.fix"),
    ("supports.t.edge", "x0", "supports.t"),
    ("points.a.at", _GONE, "points.a"),
    ("points.a.at", "middle", "points.a.at"),
    ("points.a.at", [0.1, 0.2, 0.3, 0.4], "points.a.at"),
    ("points.a.on", "nobody", "points.a.on"),
    ("points.b.patch", 0.1, "points.b.patch"),
    ("points.a.patch", [0.1, 0.2, 0.3], "points.a.patch"),
    ("points.a.set", "some", "points.a"),
    ("joints.j.connect", ["f", "f"], "joints.j.connect"),
    ("joints.j.kind", "glued", "joints.j.kind"),
    ("joints.j.slip", "1 MN/m^2", "joints.j.slip"),
    ("joints.j", {"connect": ["f", "p"], "kind": "sliding", "slip": "1 MN/m^2", "width": 0.1}, "joints.j.width"),
    ("joints.j", {"connect": ["f", "p"], "kind": "sliding", "slip": "1 MN/m^3"}, "joints.j.slip"),
    ("joints.j", {"connect": ["f", "p"], "kind": "sliding", "stiffness": {"x": 1e6}}, "joints.j.stiffness"),
    ("joints.j.stiffness", {"x": 0}, "joints.j.stiffness.x"),
    ("joints.j.stiffness", {"x": "1 MN/m", "y": "1 MN/m^2"}, "joints.j.stiffness.x"),
    ("joints.j.sets", {"f": "some"}, "joints.j.sets.f"),
    ("constraints.r.to", _GONE, "constraints.r"),
    ("constraints.r.to", "nobody", "constraints.r.to"),
    ("constraints.r.to", 7, "constraints.r.to"),
    ("constraints.r.to", {"on": "p"}, "constraints.r.to"),
    ("constraints.r.of", "d", "constraints.r"),
    ("constraints.r", {"equation": {"a.z": 1, "d.up": -1}}, "constraints.r.equation.d.up"),
    ("constraints.r", {"equation": {"a.z": 1, "d.z": -1}, "directions": ["z"]}, "constraints.r"),
    ("constraints.r.directions", ["z", "w"], "constraints.r.directions"),
    ("materials.m.G", ["1 GPa", "1 GPa"], "materials.m"),
    ("materials.t.G", _GONE, "materials.t"),
    ("materials.m.nu", [0.1, 0.2, 0.3], "materials.m"),
    ("materials.m.loss_factor", 2, "materials.m.loss_factor"),
    ("materials.m.loss_factor", {**_TIMES, "internal": 0.01}, "materials.m.loss_factor"),
    ("materials.m.loss_factor", {"reverberation_times": {"63 Hz": "0.001 s"}}, "materials.m.loss_factor"),
    ("materials.m.E", ["1 GPa"], "materials.m"),
    ("parts.h.spacing", _GONE, "parts.h"),
    ("parts.h.along", "x", "parts.h"),
    ("parts.h.at", [[0.5, 0.5]], "parts.h"),
    ("parts.h.like", "anything", "parts.h"),
    ("parts.h.between", ["p", "p"], "parts.h"),
    ("parts.h", {**_HANGERS, "spacing": [0.5]}, "parts.h.along"),
    ("parts.h", {**_HANGERS, "along": "x", "spacing": [0.5, 0.5]}, "parts.h.spacing"),
    ("parts.h", {**_HANGERS, "along": "x"}, "parts.h.spacing"),
    ("parts.h", {**_HANGERS, "between": ["f", "c"], "spacing": [0.5]}, "parts.h.spacing"),
    ("parts.h.stiffness", {"normal": "1 MN/m", "shear": "1 MN/m^2"}, "parts.h"),
    ("parts.i.inertia", [0.1, 0.1, 0.1, 0.1], "parts.i.inertia"),
    ("parts.i.at", "nobody", "parts.i.at"),
    ("parts.k.between", ["a", "a"], "parts.k"),
    ("parts.k.stiffness", {"up": 1e3}, "parts.k.stiffness"),
    ("parts.p.layers", [["m", 0.02]], "parts.p"),
    ("parts.p.material", _GONE, "parts.p"),
    ("parts.p.material", "nothing", "parts.p.material"),
    ("parts.p.thickness", -0.02, "parts.p.thickness"),
    ("parts.p", _smeared(D=[0, 2e6, 1e5, 5e5]), "parts.p"),
    ("parts.p", _smeared(D=[6e6, 0, 1e-9, 5e5]), "parts.p"),
    ("parts.p", _smeared(D=[6e6, 2e6, 1e5, 0]), "parts.p"),
    ("parts.p", _smeared(D=[6e6, 2e6, 3.5e6, 5e5]), "parts.p"),
    ("parts.p", _smeared(S=[0, 1e7]), "parts.p"),
    ("parts.p", _smeared(S=[1e7, 0]), "parts.p"),
    ("parts.p", _smeared(A=[6e8, 2e8, 1e7, 0]), "parts.p"),
    ("parts.p", _smeared(A=[6e8, 2e8, 3.5e8, 1e8]), "parts.p"),
    ("parts.p", _smeared(mass=0), "parts.p.smeared.mass"),
    ("parts.f.section", "nothing", "parts.f.section"),
    ("parts.f.type", "truss", "parts.f.type"),
    ("sections.s.shape", "star", "sections.s"),
    ("sections.s.height", _GONE, "sections.s"),
    ("damping", {"ratio": 0.01, "loss_factor": 0.02}, "damping"),
    ("damping", {"rayleigh": {}}, "damping.rayleigh"),
    ("damping", {"ratio": 0.01, "modes": {"0": {"ratio": 0.1, "near": "5 Hz"}}}, "damping.modes.0"),
]


def _changed(path: str, value: Any) -> Draft:
    model = _base()
    *way, last = path.split(".")
    there = model
    for key in way:
        there = there[key]
    if value is _GONE:
        del there[last]
    else:
        there[last] = copy.deepcopy(value)
    return model


@capability("language: one mistake is refused at its place", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    order = rng.permutation(len(_MISTAKES)).tolist()

    def asked(model: Model, door: Door) -> Floats:
        door.ask(model, "statics", "--weight")  # nothing is wrong with it
        door.told = []
        found = []
        for number in order:
            path, value, where = _MISTAKES[number]
            try:
                door.ask(_changed(path, value), "statics", "--weight")
                found.append(0.0)
            except Refused as told:
                lines = [one for one in str(told).splitlines() if one.strip()]
                at = re.match(r"\S*model\.yaml:\d+:\d+: ([^:]*): ", lines[0])
                there = at is not None and f"{at[1]}.".startswith(f"{where}.") and len(lines) == 1
                found.append(1.0 if there else -1.0)
        return np.array(found)

    return Case(_base(), asked, lambda *_: np.ones(len(_MISTAKES)), 1e-12, "yes or no")
