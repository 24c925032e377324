"""Pressure of a simply supported plate per force, in boxes of air and in the open, by closed-form modes and relations.

A case's model has a "study" and its "structure"; `plate_of` and `box_of` read both again, by themselves.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from math import log, pi
from typing import Any, Final

import numpy as np
from scipy.optimize import nnls

from tests.independent.plates import (
    Box,
    SupportedPlate,
    motion_with_air_of_box,
    power_in_the_open,
    pressure_in_box,
    pressure_in_the_open,
    pressure_of_motion,
)
from tests.machine.framework import Case, Door, Floats, Model, capability

BEYOND: Final = 100  # times its first mode: modes of the reference
_KNOBS = ("study.rooms.room.losses", "structure.materials.m")
_WHY = "plate of 18 x 18 cells with modes to 20 times the first, residuals beyond; sums of the reference: 0.3 % each"
_SAME = "the same sums in another order: rounding of eigensolutions, and of frequencies near a resonance"


def rounded(x: float) -> float:
    """Five digits."""
    return float(f"{x:.5g}")


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """A number of five digits, evenly along its logarithm."""
    return rounded(float(np.exp(rng.uniform(log(low), log(high)))))


def even(rng: np.random.Generator, low: float, high: float) -> float:
    """A number of five digits between two."""
    return rounded(float(rng.uniform(low, high)))


# ---- drawn


def plate_structure(rng: np.random.Generator, cells: int = 18) -> dict[str, Any]:
    """A thin plate on four simple supports, struck at q, above 'low' and below 'up'."""
    a = even(rng, 0.8, 3.0)
    b = rounded(a * float(rng.uniform(0.5, 1.3)))
    ratio = even(rng, 0.003, 0.05)
    material = {"E": between(rng, 3e9, 2e11), "nu": even(rng, 0.0, 0.4), "rho": between(rng, 500, 7800)}
    return {
        "materials": {"m": material},
        "parts": {
            "p": {
                "type": "plate", "material": "m", "thickness": rounded(min(between(rng, 0.004, 0.03), a / 30, b / 30)),
                "origin": [even(rng, -2, 2) for _ in range(3)], "size": [a, b], "mesh": [cells, cells],
                "element": "bfs16",
            }
        },
        "points": {"q": {"on": "p", "at": [rounded(a * float(rng.uniform(0.1, 0.9))),
                                           rounded(b * float(rng.uniform(0.1, 0.9)))]}},
        "surfaces": {"low": {"on": "p", "side": "below"}, "up": {"on": "p", "side": "above"}},
        "supports": {"e": {"on": "p", "edge": "all", "fix": "simple"}},
        "damping": {"ratio": ratio} if rng.random() < 0.5 else {"loss_factor": 2 * ratio},
    }  # fmt: skip


def losses(rng: np.random.Generator, first: float, kinds: int = 4) -> dict[str, Any]:
    """Losses of a room whose first mode is there [Hz]."""
    kind = int(rng.integers(kinds))
    ratio, at = even(rng, 0.002, 0.03), rounded(first * float(rng.uniform(0.7, 2)))
    if kind < 3:
        return [{"t60": even(rng, 0.2, 3)}, {"beta": ratio, "at": at}, {"loss_factor": 2 * ratio, "at": at}][kind]
    start, fall = float(rng.uniform(0.3, 2.5)), float(rng.uniform(-0.15, 0.4))
    bands = (63.0, 125.0, 250.0, 500.0)
    return {"t60": {f"{band:g} Hz": rounded(start * (63.0 / band) ** fall) for band in bands}}


def room(rng: np.random.Generator, structure: Model, kinds: int = 4) -> dict[str, Any]:
    """A box under the plate, with one microphone."""
    a, b = structure["parts"]["p"]["size"]
    size = [even(rng, a, a + 1), even(rng, b, b + 1), even(rng, 0.8, 3.0)]
    air = {"c": even(rng, 320, 360), "rho": even(rng, 1.0, 1.4)}
    return {
        "size": size,
        "at": [even(rng, a / 2, size[0] - a / 2), even(rng, b / 2, size[1] - b / 2)],
        "under": "low",
        "losses": losses(rng, air["c"] / 2 / max(size), kinds),
        "air": air,
        "receivers": {"mic": [rounded(s * float(rng.uniform(0, share))) for s, share in zip(size, (1, 1, 0.8),
                                                                                         strict=True)]},
    }  # fmt: skip


def scene(rng: np.random.Generator, kinds: int = 4) -> dict[str, Any]:
    """A plate over a box, and its pressure per force over some frequencies."""
    structure = plate_structure(rng)
    first = plate_of(structure)[0].modes(1e5)[0][0]
    low, high = rounded(first * float(rng.uniform(0.1, 0.5))), rounded(first * float(rng.uniform(2, 6)))
    study = {
        "modes": {"up_to": rounded(20 * first)},
        "rooms": {"room": room(rng, structure, kinds)},
        "frf": {
            "f": {
                "drive": "q.z", "response": "room.mic.pressure", "kind": "pressure", "band": [low, high],
                "step": rounded((high - low) / int(rng.integers(5, 20))),
            }
        },
    }  # fmt: skip
    return {"study": study, "structure": structure}


def open_scene(rng: np.random.Generator) -> dict[str, Any]:
    """A plate in a baffle beside open air, above or below it."""
    model = scene(rng)
    side = 1 if rng.random() < 0.5 else -1
    place = [even(rng, -2, 2), even(rng, -2, 2), rounded(side * float(rng.uniform(0.3, 3)))]
    air = model["study"]["rooms"]["room"]["air"]
    beside = {"above": "up"} if side > 0 else {"below": "low"}
    model["study"]["rooms"] = {"room": {**beside, "air": air, "receivers": {"mic": place}}}
    return model


# ---- read again


def plate_of(structure: Model) -> tuple[SupportedPlate, float, bool]:
    """The plate, its loss factor (2 x damping ratio), and whether that is of the stiffness."""
    part, damping = structure["parts"]["p"], structure["damping"]
    plate = SupportedPlate(*part["size"], part["thickness"], **structure["materials"]["m"])
    return plate, damping.get("loss_factor", 2 * damping.get("ratio", 0.0)), "loss_factor" in damping


def losses_of(stated: Mapping[str, Any]) -> dict[str, float]:
    """Decay rate and relaxation time; of bands those >= 0 of the least relative errors of 3 ln 10 / T60."""
    if "t60" not in stated:
        ratio = stated["beta"] if "beta" in stated else stated["loss_factor"] / 2
        return {"tau": 2 * ratio / (2 * pi * stated["at"])}
    if not isinstance(stated["t60"], Mapping):
        return {"gamma": 3 * log(10) / stated["t60"]}
    hz = np.array([float(band.split()[0]) for band in stated["t60"]])
    wanted = 3 * log(10) / np.array(list(stated["t60"].values()))
    of_tau = (2 * pi * hz) ** 2 / 2
    found, _ = nnls(np.column_stack([1 / wanted, of_tau / of_tau.max() / wanted]), np.ones(len(hz)))
    return {"gamma": float(found[0]), "tau": float(found[1] / of_tau.max())}


def box_of(stated: Model) -> Box:
    """The box of a room."""
    air = stated.get("air", {"c": 343.0, "rho": 1.21})
    return Box(tuple(stated["size"]), **air, **losses_of(stated.get("losses", {"beta": 0.0, "at": 1.0})))


def corner_of(stated: Model, plate: SupportedPlate) -> tuple[float, float]:
    """Of the plate in the ceiling."""
    return stated["at"][0] - plate.a / 2, stated["at"][1] - plate.b / 2


def parts_of(values: Floats) -> Floats:
    """Real and imaginary parts, one after the other."""
    return np.concatenate([np.real(values), np.imag(values)])


def lines_of(model: Model) -> Floats:
    """Frequencies of its response [Hz]: from one end to the other, a step apart."""
    asked = model["study"]["frf"]["f"]
    low, high = asked["band"]
    return np.asarray(low + asked["step"] * np.arange(int((high - low) / asked["step"] * (1 + 1e-9)) + 1))


def responses(model: Model, door: Door, name: str = "f", **beside: str) -> Floats:
    """A frequency response of the study, on the lines that it should have. beside : further files."""
    found = door.histories({"model": "structure.yaml", **model["study"]}, structure=model["structure"], **beside)
    if not np.allclose(found[f"{name} frf_hz"], lines_of(model), rtol=1e-9):
        return np.array([np.nan])
    return np.asarray(found[f"{name} frf"])


def _asked(model: Model, door: Door) -> Floats:
    return parts_of(responses(model, door))


def _first(model: Model) -> float:
    return float(plate_of(model["structure"])[0].modes(1e5)[0][0])


def _in_box(model: Model, _: Door, name: str = "room") -> Floats:
    """Real and imaginary parts of pressure per force."""
    plate, loss, hysteretic = plate_of(model["structure"])
    stated, at = model["study"]["rooms"][name], model["structure"]["points"]["q"]["at"]
    place = stated["receivers"]["mic"]
    return parts_of(
        pressure_in_box(
            box_of(stated), plate, corner_of(stated, plate), at, place, lines_of(model), loss, BEYOND * _first(model),
            orders=16, hysteretic=hysteretic,
        )
    )  # fmt: skip


# ---- independent answers


@capability("rooms: pressure per force in a box", "independent")
def _(rng: np.random.Generator) -> Case:
    return Case(scene(rng), _asked, _in_box, 0.01, _WHY, _KNOBS)


@capability("rooms: loudspeaker in a box", "independent")
def _(rng: np.random.Generator) -> Case:
    """Velocity of the plate per volume velocity of a source in the room is minus the pressure there per force."""
    model = scene(rng)
    model["study"]["frf"]["f"] |= {"drive": "room.mic.volume_velocity", "response": "q.z", "kind": "mobility"}
    return Case(model, _asked, lambda model, door: -_in_box(model, door), 0.01, _WHY, _KNOBS)


@capability("rooms: air that pushes back", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = scene(rng, kinds=3)
    model["study"]["rooms"]["room"]["coupling"] = "two-way"

    def right(model: Model, _: Door) -> Floats:
        plate, loss, hysteretic = plate_of(model["structure"])
        stated, lines = model["study"]["rooms"]["room"], lines_of(model)
        box, corner = box_of(stated), corner_of(stated, plate)
        at, up = model["structure"]["points"]["q"]["at"], 30 * _first(model)
        shapes, moved = motion_with_air_of_box(box, plate, corner, at, lines, loss, up, hysteretic=hysteretic)
        place = stated["receivers"]["mic"]
        return parts_of(pressure_of_motion(box, plate, corner, shapes, moved, place, lines))

    return Case(model, _asked, right, 0.01, "modes of plate and air end, both at rest beyond: 0.5 % each", _KNOBS)


@capability("rooms: pressure per force in the open", "independent")
def _(rng: np.random.Generator) -> Case:
    def right(model: Model, _: Door) -> Floats:
        plate, loss, hysteretic = plate_of(model["structure"])
        stated, at = model["study"]["rooms"]["room"], model["structure"]["points"]["q"]["at"]
        more = {"hysteretic": hysteretic, **stated["air"]}
        place = stated["receivers"]["mic"]
        return parts_of(pressure_in_the_open(plate, at, place, lines_of(model), loss, BEYOND * _first(model), **more))

    return Case(open_scene(rng), _asked, right, 0.01, _WHY, ("structure.materials.m",))


@capability("rooms: power per force in the open", "independent")
def _(rng: np.random.Generator) -> Case:
    model = open_scene(rng)
    model["study"]["frf"]["f"] |= {"response": "room.power", "kind": "power"}
    model["structure"]["parts"]["p"]["mesh"] = [26, 26]  # at a resonance 18 x 18 are up to 1.5 % off, 26 x 26 0.4 %

    def asked(model: Model, door: Door) -> Floats:
        return np.real(responses(model, door))

    def right(model: Model, _: Door) -> Floats:
        plate, loss, hysteretic = plate_of(model["structure"])
        stated, at = model["study"]["rooms"]["room"], model["structure"]["points"]["q"]["at"]
        more = {"hysteretic": hysteretic, **stated["air"]}
        return power_in_the_open(plate, at, lines_of(model), loss, 40 * _first(model), **more)

    return Case(model, asked, right, 0.01, _WHY, ("structure.materials.m",))


# ---- relations


@capability("rooms: mirrored", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Room, microphone, plate and struck place seen in a mirror along x or y."""
    axis = int(rng.integers(2))

    def right(model: Model, door: Door) -> Floats:
        other: Any = copy.deepcopy(model)
        stated, point = other["study"]["rooms"]["room"], other["structure"]["points"]["q"]["at"]
        whole, side = stated["size"][axis], other["structure"]["parts"]["p"]["size"][axis]
        stated["at"][axis] = whole - stated["at"][axis]
        stated["receivers"]["mic"][axis] = whole - stated["receivers"]["mic"][axis]
        point[axis] = side - point[axis]
        return _asked(other, door)

    return Case(scene(rng), _asked, right, 1e-5, _SAME, _KNOBS)


@capability("rooms: plate and air twice as dense", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    def right(model: Model, door: Door) -> Floats:
        other: Any = copy.deepcopy(model)
        for name in ("E", "rho"):
            other["structure"]["materials"]["m"][name] *= 2
        other["study"]["rooms"]["room"]["air"]["rho"] *= 2
        return _asked(other, door)

    return Case(scene(rng), _asked, right, 1e-6, _SAME, _KNOBS)


@capability("rooms: other units", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Lengths in mm and cm, frequencies in kHz, moduli in MPa."""

    def right(model: Model, door: Door) -> Floats:
        other: Any = copy.deepcopy(model)
        part, stated = other["structure"]["parts"]["p"], other["study"]["rooms"]["room"]
        material, response = other["structure"]["materials"]["m"], other["study"]["frf"]["f"]
        part["thickness"] = f"{part['thickness'] * 1e3!r} mm"
        part["size"] = [f"{one * 1e2!r} cm" for one in part["size"]]
        stated["size"] = [f"{one * 1e3!r} mm" for one in stated["size"]]
        stated["receivers"]["mic"] = [f"{one * 1e2!r} cm" for one in stated["receivers"]["mic"]]
        material["E"] = f"{material['E'] / 1e6!r} MPa"
        response["band"] = [f"{one / 1e3!r} kHz" for one in response["band"]]
        response["step"] = f"{response['step'] / 1e3!r} kHz"
        found = door.histories({"model": "structure.yaml", **other["study"]}, structure=other["structure"])
        return parts_of(found["f frf"])

    return Case(scene(rng, kinds=3), _asked, right, 1e-6, _SAME, _KNOBS)


@capability("rooms: a second room first", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """What another room hears, and that it comes first, changes nothing here."""
    model = scene(rng)
    other = room(rng, model["structure"])

    def right(model: Model, door: Door) -> Floats:
        study = {**model["study"], "rooms": {"before": other, **model["study"]["rooms"]}}
        return _asked({**model, "study": study}, door)

    return Case(model, _asked, right, 1e-9, "the same sums: rounding", _KNOBS)


@capability("rooms: two surfaces are the sum of each", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """A plate and a copy of it 1 m lower, held by a spring to it, are the ceiling and the floor of a room."""
    model = scene(rng)
    structure, stated = model["structure"], model["study"]["rooms"]["room"]
    part = structure["parts"]["p"]
    x, y, z = part["origin"]
    structure["parts"]["lower"] = {**part, "origin": [x, y, round(z - stated["size"][2], 9)]}
    at = structure["points"]["q"]["at"]
    structure["points"]["r"] = {"on": "lower", "at": at}
    mass = structure["materials"]["m"]["rho"] * part["thickness"] * part["size"][0] * part["size"][1] / 4
    stiffness = rounded(mass * (2 * pi * _first(model)) ** 2 * float(rng.uniform(0.1, 2)))
    structure["parts"]["tie"] = {"type": "spring", "between": ["q", "r"], "stiffness": {"z": stiffness}}
    structure["surfaces"]["top"] = {"on": "lower", "side": "above"}
    structure["supports"]["l"] = {"on": "lower", "edge": "all", "fix": "simple"}
    stated["size"][:2] = part["size"]
    stated["receivers"]["mic"][:2] = [rounded(0.8 * side * float(rng.uniform(0.1, 1))) for side in part["size"]]
    del stated["under"], stated["at"]

    def with_surfaces(model: Model, door: Door, **surfaces: str) -> Floats:
        stated = {**model["study"]["rooms"]["room"], "surfaces": surfaces}
        return _asked({**model, "study": {**model["study"], "rooms": {"room": stated}}}, door)

    def asked(model: Model, door: Door) -> Floats:
        return with_surfaces(model, door, ceiling="low", floor="top")

    def right(model: Model, door: Door) -> Floats:
        return with_surfaces(model, door, ceiling="low") + with_surfaces(model, door, floor="top")

    return Case(model, asked, right, 1e-6, _SAME, _KNOBS)


# ---- limits


@capability("rooms: all bands of a reverberation time alike", "limit", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = scene(rng, kinds=1)
    time = model["study"]["rooms"]["room"]["losses"]["t60"]
    bands = {f"{band:g} Hz": time for band in (63, 125, 250, 500)}
    model["study"]["rooms"]["room"]["losses"] = {"t60": bands}
    return Case(model, _asked, _in_box, 0.01, _WHY, ("structure.materials.m",))


@capability("rooms: twice as far in the open", "limit")
def _(rng: np.random.Generator) -> Case:
    """Far away the pressure halves and comes r / c later."""
    model = open_scene(rng)
    place = np.array(model["study"]["rooms"]["room"]["receivers"]["mic"])
    size = max(model["structure"]["parts"]["p"]["size"])
    high = model["study"]["frf"]["f"]["band"][1]
    c = model["study"]["rooms"]["room"]["air"]["c"]
    far = 300 * size * max(1.0, size * high / c)
    place *= far / float(np.linalg.norm(place))
    model["study"]["rooms"]["room"]["receivers"]["mic"] = [rounded(one) for one in place]

    def right(model: Model, door: Door) -> Floats:
        other: Any = copy.deepcopy(model)
        stated = other["study"]["rooms"]["room"]
        mic = stated["receivers"]["mic"] = [2 * one for one in stated["receivers"]["mic"]]
        late = np.exp(2j * pi * lines_of(model) / stated["air"]["c"] * float(np.linalg.norm(mic)) / 2)
        return parts_of(2 * late * responses(other, door))

    return Case(model, _asked, right, 0.01, "terms of L / r and k L^2 / r, 1/300 each", ("structure.materials.m",))
