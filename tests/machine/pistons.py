"""Pressure of a stiff plate that moves as a piston in the ceiling of a box, by closed form: losses, leaks, both ways.

A case's model has a "study" and its "structure"; `piston_of` and `box_of` read both again, by themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import Any

import numpy as np

from tests.independent.pistons import CeilingPiston, Oscillator, ceiling_piston
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.of_files import deck
from tests.machine.rooms import between, even, lines_of, losses_of, parts_of, responses, rounded
from tests.machine.solids import grid, mesh_text

_KNOBS = ("study.rooms.room.losses", "structure.materials.m.rho")  # with another E it is no piston
_WHY = "a plate of 1e5 times the stiffness of its spring yields 1e-5 of its motion, 3e-4 near the force; 12 x 12 cells"
_LIGHT = (
    "a plug lighter than the air before it, of whose mass 16 cells do not resolve 1.2e-4, over losses of 0.03: 4e-3"
)
_COUPLED = "what damping couples is left out below 1e-3 of the motion of plate and air, several times that of a peak"


def piston_structure(rng: np.random.Generator, hz: float) -> dict[str, Any]:
    """A plate too stiff to bend, guided by its edges, on a spring at its middle."""
    a, b, thickness = even(rng, 0.8, 2.0), even(rng, 0.8, 2.0), 0.05
    rho = between(rng, 500, 5000)
    stiffness = rounded(rho * a * b * thickness * (2 * pi * hz) ** 2)
    ratio = even(rng, 0.01, 0.05)
    return {
        "materials": {"m": {"E": 1e15, "nu": 0.3, "rho": rho}},
        "parts": {
            "p": {"type": "plate", "material": "m", "thickness": thickness, "origin": [0, 0, 0], "size": [a, b],
                  "mesh": [12, 12]},
            "k": {"type": "spring", "between": ["q", "ground"], "stiffness": {"z": stiffness}},
        },
        "points": {"q": {"on": "p", "at": [a / 2, b / 2]}},
        "surfaces": {"low": {"on": "p", "side": "below"}},
        "supports": {"e": {"on": "p", "edge": "all", "fix": ["x", "y", "rx", "ry"]}},
        "damping": {"ratio": ratio} if rng.random() < 0.5 else {"loss_factor": 2 * ratio},
    }  # fmt: skip


def losses_near(rng: np.random.Generator, hz: float) -> dict[str, Any]:
    kind, ratio = int(rng.integers(3)), even(rng, 0.005, 0.03)
    at = rounded(hz * float(rng.uniform(0.8, 1.3)))
    return [{"t60": even(rng, 0.2, 0.8)}, {"beta": ratio, "at": at}, {"loss_factor": 2 * ratio, "at": at}][kind]


def _leak(rng: np.random.Generator, volume: float, c: float, rho: float, hz: float) -> dict[str, Any]:
    """An opening whose plug resonates with the air of the room near a frequency."""
    inertance = rho * c * c / volume / (2 * pi * hz * float(rng.uniform(0.7, 1.3))) ** 2
    resistance = {"resistance": rounded(inertance * 2 * pi * hz * float(rng.uniform(0.03, 0.1)))}
    if rng.random() < 0.5:
        return {"inertance": rounded(inertance), **resistance}
    area = between(rng, 1e-3, 1e-2)
    return {"area": area, "length": rounded(inertance * area / rho), **resistance}


def scene(rng: np.random.Generator, coupling: str, leaks: bool = False) -> dict[str, Any]:
    """A piston whose natural frequency is near the first modes of its room; with a leak near that of its plug."""
    size = [even(rng, 2.0, 4.0), even(rng, 2.0, 4.0), even(rng, 1.5, 3.0)]
    air = {"c": even(rng, 320, 360), "rho": even(rng, 1.0, 1.4)}
    first = air["c"] / 2 / max(size)
    own = rounded(first * float(rng.uniform(0.15, 0.4) if leaks else rng.uniform(0.7, 1.3)))
    structure = piston_structure(rng, own)
    a, b = structure["parts"]["p"]["size"]
    room: dict[str, Any] = {
        "size": size, "air": air, "under": "low", "losses": losses_near(rng, first),
        "at": [even(rng, a / 2, size[0] - a / 2), even(rng, b / 2, size[1] - b / 2)],
        "receivers": {"mic": [rounded(s * float(rng.uniform(0, 0.9))) for s in size]},
    }  # fmt: skip
    if "t60" not in room["losses"]:
        room["form"] = str(rng.choice(["causal", "source"]))
    room["coupling"] = coupling
    if leaks:
        structure["parts"]["p"]["mesh"] = [16, 16]
        room["leak"] = _leak(rng, float(np.prod(size)), air["c"], air["rho"], own)
    low, high = (rounded(share * (own if leaks else first)) for share in (0.3, 2.0))
    heard = {"drive": "q.z", "response": "room.mic.pressure", "kind": "pressure"}
    if rng.random() < 0.3:
        heard = {"drive": "room.mic.volume_velocity", "response": "q.z", "kind": "mobility"}
    if rng.random() < 0.4:  # at a fifth of the height, of which the program makes all exponentials from one
        room["receivers"]["mic"][2] = round(size[2] * int(rng.integers(1, 5)) / 5, 9)
    step = rounded(high / 60)
    frf = {"f": {**heard, "band": [low, high], "step": step}}
    study = {"modes": {"up_to": rounded(12 * first)}, "rooms": {"room": room}, "frf": frf}
    return {"study": study, "structure": structure}


def piston_of(structure: Model) -> Oscillator:
    """The plate on its spring."""
    part, damping = structure["parts"]["p"], structure["damping"]
    mass = structure["materials"]["m"]["rho"] * part["thickness"] * part["size"][0] * part["size"][1]
    hz = np.sqrt(structure["parts"]["k"]["stiffness"]["z"] / mass) / (2 * pi)
    return Oscillator(mass, hz, damping.get("loss_factor", 2 * damping.get("ratio", 0.0)), "loss_factor" in damping)


def lost_in(stated: Model) -> Mapping[str, float]:
    """What the losses of a room are, in their form; names as of `tests.independent.box_pistons.PistonsBox`."""
    told = stated["losses"]
    if stated.get("form") == "source":
        return {"beta": told["beta"] if "beta" in told else told["loss_factor"] / 2}
    return dict(losses_of(told))


def box_of(stated: Model, structure: Model, orders: int = 80) -> CeilingPiston:
    """The box of a room and the piston in its ceiling."""
    a, b = structure["parts"]["p"]["size"]
    piston = (stated["at"][0] - a / 2, stated["at"][1] - b / 2, a, b)
    return ceiling_piston(tuple(stated["size"]), piston, **stated["air"], **lost_in(stated), orders=orders)


def _right(model: Model, _: Door) -> Floats:
    stated, structure = model["study"]["rooms"]["room"], model["structure"]
    s = 2j * pi * lines_of(model)
    leak = None
    if "leak" in stated:
        told = stated["leak"]
        inertance = told.get("inertance", stated["air"]["rho"] * told.get("length", 0.0) / told.get("area", 1.0))
        leak = s * inertance + told["resistance"]
    place, both = stated["receivers"]["mic"], stated.get("coupling") == "two-way"
    found = box_of(stated, structure).per_force(piston_of(structure), s, place, both, leak)
    sign = -1.0 if "volume_velocity" in model["study"]["frf"]["f"]["drive"] else 1.0
    return parts_of(sign * found)


def _asked(model: Model, door: Door) -> Floats:
    found = responses(model, door)
    stiff = ("implausible-material", "thick-plate")
    door.told[:] = [one for one in door.told if not one.startswith(stiff)]
    return parts_of(found)


@capability("rooms: a piston over a box", "independent")
def _(rng: np.random.Generator) -> Case:
    return Case(scene(rng, "one-way"), _asked, _right, 1e-3, _WHY, _KNOBS)


def _as_part(structure: dict[str, Any], kind: str) -> tuple[dict[str, Any], dict[str, str]]:
    """The structure with its piston as a part of another kind, guided all over, and the mesh file that it names."""
    plate = structure["parts"]["p"]
    (a, b), thickness = plate["size"], plate["thickness"]
    shell: dict[str, Any] = {"type": kind, "material": plate["material"]}
    low = {"on": "p", "side": "below"}
    if kind == "slab":
        shell |= {
            "thickness": thickness,
            "outline": [[0, 0], [a, 0], [a, b], [0, b]],
            "mesh": 0.12,
            "origin": [0, 0, 0],
        }
        guided, texts = ["x", "y", "rx", "ry", "rz"], {}
    elif kind == "shell":
        shell |= {"thickness": thickness, "mesh": "p.bdf"}
        guided, texts = ["x", "y", "rx", "ry", "rz"], {"p.bdf": deck(np.array([a, b]), 12)}
    else:
        shell |= {"mesh": "p.msh"}
        nodes, cells = grid(np.array([a, b, thickness]), (12, 12, 1), "hexahedron")
        guided, texts = ["x", "y"], {"p.msh": mesh_text(nodes, cells, "hexahedron", "msh")}
        low["region"] = {"box": [[-1.0, -1.0, -1e-6], [a + 1, b + 1, 1e-6]]}
    round_it = [[-1.0, -1.0, -1.0], [a + 1, b + 1, 1.0]]
    spring = structure["parts"]["k"]
    middle = [a / 2, b / 2] if kind == "slab" else [a / 2, b / 2, 0.0]
    made = {
        **structure, "parts": {"p": shell, "k": spring}, "points": {"q": {"on": "p", "at": middle}},
        "surfaces": {"low": low}, "supports": {"e": {"on": "p", "box": round_it, "fix": guided}},
    }  # fmt: skip
    return made, texts


@capability("rooms: a piston of a slab, a shell or a solid", "independent")
def _(rng: np.random.Generator) -> Case:
    """One that the box knows by its sides, mass and spring alone: its surface is that of another kind of part."""
    model, kind = scene(rng, "one-way"), str(rng.choice(["slab", "shell", "solid"]))

    def asked(model: Model, door: Door) -> Floats:
        made, texts = _as_part(dict(model["structure"]), kind)
        found = responses({**model, "structure": made}, door, **texts)
        door.told.clear()  # of a stiff part, whatever it is
        return parts_of(found)

    return Case(model, asked, _right, 1e-3, _WHY, _KNOBS)


@capability("rooms: a piston on the air of a box", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return Case(scene(rng, "two-way"), _asked, _right, 5e-3, _COUPLED, _KNOBS)


@capability("rooms: a piston on the air of a box that leaks", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return Case(scene(rng, "two-way", leaks=True), _asked, _right, 5e-3, _LIGHT, _KNOBS)
