"""Boxes cut into cells, with walls that absorb, between pistons: by closed-form cosines that these walls couple."""

from __future__ import annotations

from math import log, pi
from typing import Any, Final

import numpy as np

from tests.independent.absorbing_box import AbsorbingBox
from tests.machine import rooms_of_walls as walls
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.rooms import between, lines_of, losses_of, parts_of, responses, rounded

Draft = dict[str, Any]
_SUM: Final = 10.0  # times the first mode of the room: where the reference's modes end
_WHY = "six quadratic cells to a wave at twice the band: 1e-3 / 16 of a mode, over its losses; sums of cosines end"
_ASIDE = "coupled-absorption"  # says that bands are an approximation between modes, which the reference makes too


def absorbing(rng: np.random.Generator, model: Draft, count: int) -> Draft:
    """With absorption on some walls, one or by bands, some of which move."""
    room, first = model["study"]["rooms"]["room"], model["first"]
    room.pop("form", None)
    chosen = sorted(str(one) for one in rng.choice(walls.WALLS, count, replace=False))
    stated: Draft = {}
    for wall in chosen:
        alpha = between(rng, 0.02, 0.4)
        bands = [rounded(first * one) for one in (0.5, 1.2, 2.2)]
        if rng.random() < 0.5:
            shares = rng.uniform(0.5, 1.5, 3)
            stated[wall] = {"absorption": {f"{hz:g} Hz": rounded(alpha * one)
                                           for hz, one in zip(bands, shares, strict=True)}}  # fmt: skip
        else:
            stated[wall] = {"absorption": alpha}
    room["walls"] = stated
    room["modes"] = {"up_to": rounded(3 * first)}
    return model


def box_of(model: Model, up_to: float) -> AbsorbingBox:
    room = model["study"]["rooms"]["room"]
    stated: dict[str, dict[float, float]] = {}
    for wall, one in room.get("walls", {}).items():
        alpha = one["absorption"]
        bands = (
            {float(hz.split()[0]): value for hz, value in alpha.items()} if isinstance(alpha, dict) else {1e3: alpha}
        )
        stated[wall] = bands
    lost = losses_of(room["losses"]) if "losses" in room else {}
    return AbsorbingBox(tuple(room["size"]), stated, up_to, **room["air"], **lost)


def heard(model: Model, s: Floats) -> Floats:
    """Pressures [n, nf] per velocity of each piston: of rigid walls by all cosines, and what absorption adds."""
    box, pistons = box_of(model, _SUM * model["first"]), walls.pistons_of(model)
    place = model["study"]["rooms"]["room"]["receivers"]["mic"]
    more = [box.per_velocity(s, one, place) - box.per_velocity(s, one, place, rigid=True) for one in pistons]
    return np.asarray(walls.box_of(model).at(s, pistons, place) + more)


def _right(model: Model, _: Door) -> Floats:
    asked, pistons = model["study"]["frf"]["f"], walls.pistons_of(model)
    s, backwards = 2j * pi * lines_of(model), "volume_velocity" in asked["drive"]
    forces = np.zeros((len(s), len(pistons)), complex)
    forces[:, model["walls"].index(asked["response" if backwards else "drive"][3:-2])] = 1.0
    v = walls.motions(model, s, forces) * [one.inward for one in pistons]
    found = np.einsum("nf,fn->f", heard(model, s), v)
    return parts_of(-found if backwards else found)


def _told(door: Door, found: Floats) -> Floats:
    door.told[:] = [one for one in door.told if not one.startswith(_ASIDE)]
    return walls.stiff_told(door, found)


@capability("rooms: walls that absorb between pistons", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = absorbing(rng, walls.scene(rng, (0.7, 1.3), (500, 5000), True), int(rng.integers(1, 4)))
    model = walls.with_response(rng, walls.with_lever(rng, model))
    asked = model["study"]["frf"]["f"]
    asked |= {"band": [asked["band"][0], rounded(1.6 * model["first"])], "step": rounded(model["first"] / 20)}

    def answer(model: Model, door: Door) -> Floats:
        return _told(door, parts_of(responses(walls.written(model), door)))

    return Case(model, answer, _right, 0.01, _WHY)


# ---- in time

_RATE: Final = 2000.0  # Hz


@capability("rooms: a push in a room whose walls absorb", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """The spectrum of what is heard in time, up to where modes of the room matter."""
    model = absorbing(rng, walls.pushed(rng, False, True), int(rng.integers(1, 4)))
    model["study"]["time"]["sampling"] = _RATE
    model["study"]["modes"]["up_to"] = rounded(12 * model["first"])

    def lines(model: Model) -> Floats:
        return np.asarray(model["first"] * np.linspace(0.3, 1.6, 27))

    def asked(model: Model, door: Door) -> Floats:
        said = walls.written(model)
        found = door.histories({"model": "s.yaml", **said["study"]}, s=said["structure"])
        p, t = found["room.mic pressure"], found["t"]
        return _told(door, parts_of(np.exp(-2j * pi * np.outer(lines(model), t)) @ p / _RATE))

    def right(model: Model, _: Door) -> Floats:
        s = 2j * pi * lines(model)
        return parts_of(np.einsum("nf,nf->f", heard(model, s), walls.into(model, s)))

    return Case(model, asked, right, 0.01, _WHY)


# ---- what is said of a room


@capability("rooms: what is said of them", "independent")
def _(rng: np.random.Generator) -> Case:
    """Sides, first modes and how they are damped, of boxes and of such that are cut into cells."""
    model = walls.with_response(rng, walls.scene(rng, (0.7, 1.3), (500, 5000), True))
    if rng.random() < 0.5:
        model = absorbing(rng, model, int(rng.integers(1, 4)))

    def asked(model: Model, door: Door) -> Floats:
        said = walls.written(model)
        found = door.ask({"model": "s.yaml", **said["study"]}, "check", s=said["structure"])
        door.told[:] = []  # of the study, whatever it is
        room = found["rooms"]["room"]
        times = [room[key] for key in room if key.startswith("t60") or key.startswith("reverberation")]
        return np.array([*room["size_m"], *room["first_modes_hz"], *room["damping_ratio"].values(), *times])

    return Case(model, asked, _described, 1e-3, "cells: 1e-3 of a mode and less; six digits", each=True)


def _described(model: Model, _: Door) -> Floats:
    room = model["study"]["rooms"]["room"]
    box = box_of(model, 2.0 * model["first"] * max(room["size"]) / min(room["size"]))
    hz, taken = box.modes()[0], np.diag(box.absorbed())
    some = np.array([20.0, *hz[1:4]])
    ratios = pi * some * box.tau + box.gamma / (2 * pi * some)
    if room.get("form") == "source":
        ratios = np.full(4, walls.box_of(model).beta)
    ratios[1:] += 0.5 * box.c * taken[1:4] / (2 * pi * hz[1:4])
    once = [3 * log(10) / box.gamma] if "t60" in room["losses"] and "walls" not in room else []
    return np.array([*room["size"], *hz[1:4], *ratios, *once])


@capability("rooms: reverberation times that losses cannot have", "independent")
def _(rng: np.random.Generator) -> Case:
    """Bands whose times a decay rate and a relaxation time miss by more than a tenth, and by what."""
    model = walls.pushed(rng, False)
    room = model["study"]["rooms"]["room"]
    some = sorted(rng.choice([31.5, 63.0, 125.0, 250.0, 500.0, 1000.0], int(rng.integers(2, 6)), replace=False))
    room["losses"] = {"t60": {f"{band:g} Hz": between(rng, 0.3, 2.0) for band in some}}
    if rng.random() < 0.5:  # responses along frequency alone
        del model["study"]["time"]
        (push,) = model["study"].pop("loads").values()
        mic = next(iter(room["receivers"]))
        heard = {"drive": push["at"], "response": f"room.{mic}.pressure", "band": [50.0, 60.0], "step": 5.0}
        model["study"]["frf"] = {"f": {**heard, "kind": "pressure"}}

    def asked(model: Model, door: Door) -> Floats:
        said = walls.written(model)
        told = door.ask({"model": "s.yaml", **said["study"]}, "check", s=said["structure"])["findings"]
        door.told[:] = []  # of the study, whatever it is
        missed = next((one["values"] for one in told if one["code"] == "t60-missed"), {})
        names = [band.split()[0] for band in model["study"]["rooms"]["room"]["losses"]["t60"]]
        pairs = [missed.get(f"{way}_{name}_hz_s", 0.0) for name in names for way in ("asked", "modelled")]
        return np.array([1.0, *pairs])

    def right(model: Model, _: Door) -> Floats:
        stated, found = model["study"]["rooms"]["room"]["losses"], []
        lost = losses_of(stated)
        for band, time in stated["t60"].items():
            own = 2 * pi * float(band.split()[0])
            modelled = 3 * log(10) / (lost["gamma"] + own**2 * lost["tau"] / 2)
            found += [time, modelled] if abs(modelled / time - 1) > 0.1 else [0.0, 0.0]
        return np.array([1.0, *found])

    return Case(model, asked, right, 1e-6, "least squares of two numbers, six digits")
