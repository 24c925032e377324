"""Air and wool between two plates too stiff to bend, on springs at their corners: against waves across the depth."""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import Any

import numpy as np

from tests.independent.cavities import Fluid, Pair, Spot
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.rooms import between, even, parts_of, rounded

Draft = dict[str, Any]
_LINES = 40
_CELLS = 6
_JOISTS: tuple[tuple[int, ...], ...] = ((2,), (4,), (2, 4), (1, 3))  # lines of the mesh
_WHY = (
    "modes of the air end at twice the band or later and are at rest beyond, 1e-3 and less; a peak is times its height"
)
_WOOL = "coordinates of wool whose energy is below (2 %)^2 are left out; modes of its air end at 2.5 kHz"


def _plates(
    rng: np.random.Generator, depth: float, heavy: tuple[float, float], hertz: float, wide: float = 1.0
) -> Draft:
    """Two plates, one above the other, with a spring to the ground at each corner; resonances near a frequency."""
    size = [rounded(wide * even(rng, 0.6, 1.4)) for _ in range(2)]
    origin, thick = [even(rng, -1, 1) for _ in range(3)], 0.02
    masses = [between(rng, *heavy) for _ in range(2)]
    draft: Draft = {"materials": {}, "parts": {}, "points": {}, "supports": {}}
    for name, mass, up in zip(("lower", "upper"), masses, (0.0, depth + thick), strict=True):
        draft["materials"][f"of {name}"] = {"E": 1e15, "nu": 0.3, "rho": rounded(mass / thick)}
        draft["parts"][name] = {
            "type": "plate", "material": f"of {name}", "thickness": thick, "size": size, "mesh": [_CELLS, _CELLS],
            "origin": [*origin[:2], round(origin[2] + up, 9)],
        }  # fmt: skip
        draft["supports"][f"edges {name}"] = {"on": name, "edge": "all", "fix": ["x", "y"]}
        for k, share in enumerate(((0, 0), (1, 0), (0, 1), (1, 1))):
            corner = f"{name} {k}"
            draft["points"][corner] = {"on": name, "at": [size[0] * share[0], size[1] * share[1]]}
            stiff = mass * size[0] * size[1] / 4 * (2 * pi * hertz) ** 2
            stiffness = {"z": rounded(stiff * float(rng.uniform(0.5, 1.5)))}
            draft["parts"][f"spring {corner}"] = {
                "type": "spring",
                "between": [corner, "ground"],
                "stiffness": stiffness,
            }
    ratio = even(rng, 0.05, 0.15)
    draft["damping"] = {"ratio": ratio} if rng.random() < 0.5 else {"loss_factor": 2 * ratio}
    draft["surfaces"] = {"top": {"on": "lower", "side": "above"}, "under": {"on": "upper", "side": "below"}}
    draft["cavities"] = {
        "void": {
            "between": ["under", "top"], "depth": depth, "air": {"c": even(rng, 320, 360), "rho": even(rng, 1.0, 1.4)}
        }
    }  # fmt: skip
    return draft


def _case(rng: np.random.Generator, draft: Draft, low: float, high: float, tolerance: float, why: str) -> Case:
    """Displacement at a corner of one plate per force at a corner of either."""
    drive, response = (f"{rng.choice(['lower', 'upper'])} {rng.integers(4)}" for _ in range(2))
    step = rounded((high - low) / _LINES)
    frf = {"drive": f"{drive}.z", "response": f"{response}.z", "band": [rounded(low), step]}
    return Case({"structure": draft, "frf": frf}, _asked, _right, tolerance, why, ("structure.materials",))


def _lines(model: Model) -> Floats:
    low, step = model["frf"]["band"]
    return np.asarray(low + step * np.arange(_LINES + 1))


def _asked(model: Model, door: Door) -> Floats:
    said, lines = model["frf"], _lines(model)
    words = ["--drive", said["drive"], "--response", said["response"], "--kind", "receptance"]
    found = door.ask(
        model["structure"], "frf", *words, "--band", f"{lines[0]} Hz:{lines[-1]} Hz", "--step", f"{said['band'][1]} Hz"
    )
    usual = ("implausible-material", "thick-plate", "no-damping", "peak-between-lines", "held-wool")
    door.told[:] = [one for one in door.told if not one.startswith(usual)]  # the air of a cavity loses nothing
    if not np.allclose(found["frequency_hz"], lines, rtol=1e-9):
        return np.array([np.nan])
    return parts_of(np.array(found["real"]) + 1j * np.array(found["imag"]))


def _spot(model: Model, name: str) -> Spot:
    x, y = model["points"][name]["at"]
    return ("lower", "upper").index(name.split()[0]), x, y


def _pair(model: Model) -> Pair:
    parts, (cavity,) = model["parts"], model["cavities"].values()
    masses = [model["materials"][f"of {name}"]["rho"] * parts[name]["thickness"] for name in ("lower", "upper")]
    air, fill = Fluid(**cavity["air"]), cavity.get("fill")
    layers = [(cavity["depth"], air)]
    if fill:
        wool = Fluid(
            **cavity["air"], sigma=fill["flow_resistivity"], bulk=fill["density"], limp=fill["frame"] == "limp"
        )
        thick = fill.get("thickness", cavity["depth"])
        layers = [(thick, wool), (cavity["depth"] - thick, air)] if "thickness" in fill else [(thick, wool)]
    bays: list[tuple[float, float, float]] = []
    if "bays" in cavity:
        said = cavity["bays"]
        stops = [0.0, *said["at"], parts["lower"]["size"][0]]
        joists = [0.0, *(said["width"] for _ in said["at"]), 0.0]
        bays = [(low, high, high - low - sum(joists[k : k + 2]) / 2) for k, (low, high) in enumerate(pairwise(stops))]
    springs = {
        _spot(model, part["between"][0]): part["stiffness"]["z"] for part in parts.values() if part["type"] == "spring"
    }
    return Pair(tuple(parts["lower"]["size"]), (masses[0], masses[1]), layers, springs, bays)


def _right(model: Model, _: Door) -> Floats:
    structure, said = model["structure"], model["frf"]
    ends = [_spot(structure, said[one].removesuffix(".z")) for one in ("drive", "response")]
    damping = structure["damping"]
    lost = damping.get("ratio", 0.0), damping.get("loss_factor", 0.0)
    return parts_of(_pair(structure).receptance(_lines(model), ends[0], ends[1], *lost))


def _air_spring(draft: Draft) -> float:
    """Mass-air-mass resonance of free plates [Hz]."""
    (cavity,) = draft["cavities"].values()
    air = cavity["air"]
    share = sum(1 / (one["rho"] * 0.02) for one in draft["materials"].values())
    return float(np.sqrt(air["rho"] * air["c"] ** 2 / cavity["depth"] * share) / 2 / pi)


@capability("cavities: two plates on springs and air", "independent")
def _(rng: np.random.Generator) -> Case:
    """A shallow one, over the resonance of both masses on the air, and their tilts."""
    draft = _plates(rng, even(rng, 0.05, 0.25), (5.0, 60.0), float(rng.uniform(10, 40)))
    top = _air_spring(draft)
    return _case(rng, draft, 0.2 * top, 1.5 * top, 3e-3, _WHY)


@capability("cavities: modes of the air across its depth", "independent")
def _(rng: np.random.Generator) -> Case:
    """A deep one, over its first modes between two light plates: across and along."""
    draft = _plates(rng, even(rng, 0.7, 1.6), (5.0, 20.0), float(rng.uniform(30, 60)), 0.7)
    (cavity,) = draft["cavities"].values()
    first = cavity["air"]["c"] / 2 / cavity["depth"]
    return _case(rng, draft, 0.5 * first, 1.6 * first, 0.01, _WHY)


@capability("cavities: bays between joists", "independent")
def _(rng: np.random.Generator) -> Case:
    """Each with air of its own, so that a tilt compresses it; joists stand on lines of the mesh."""
    draft = _plates(rng, even(rng, 0.05, 0.25), (5.0, 60.0), float(rng.uniform(10, 40)))
    (cavity,) = draft["cavities"].values()
    long = draft["parts"]["lower"]["size"][0]
    at = [round(long * one / _CELLS, 9) for one in _JOISTS[int(rng.integers(4))]]
    cavity["bays"] = {"across": "x", "at": at, "width": even(rng, 0.03, 0.08)}
    top = _air_spring(draft)
    return _case(rng, draft, 0.2 * top, 1.5 * top, 3e-3, _WHY)


@capability("cavities: wool in all or a part of the depth", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = _plates(rng, even(rng, 0.08, 0.3), (5.0, 60.0), float(rng.uniform(10, 40)), 0.4)
    (cavity,) = draft["cavities"].values()
    cavity["fill"] = {
        "flow_resistivity": between(rng, 5e3, 3e4),
        "density": even(rng, 15, 80),
        "frame": str(rng.choice(["limp", "held"])),
    }
    if rng.random() < 0.6:
        cavity["fill"]["thickness"] = rounded(cavity["depth"] * float(rng.uniform(0.3, 0.8)))
    if rng.random() < 0.5:  # else as far as the program says that it needs
        cavity["up_to"] = 4000.0
    top = _air_spring(draft)
    return _case(rng, draft, 0.2 * top, 1.5 * top, 0.01, _WOOL)
