"""Levels of standard blows on a bare plate over a box by statistical energies, beyond modes that end early: levels,
modes in bands, scatter, bands that are filled or left blank, and how modes agree with them.

A case's model has a "study" and its "structure"; `floor_of` and `room_of` read both again, by themselves.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from math import log10, pi, sqrt
from typing import Any, Final

import numpy as np
from scipy.interpolate import PchipInterpolator

from tests.independent import contact_events as ev
from tests.independent import levels
from tests.independent import statistical_energies as se
from tests.independent.ritz import section
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.impacts import G
from tests.machine.laws import between, draw_law, law_of, rounded
from tests.machine.plates import plies
from tests.machine.rated import answer_of, fast_gain
from tests.machine.rooms import even, losses_of

Draft = dict[str, Any]
LOW_THIRDS: Final = (50, 63, 80, *levels.THIRDS[:9])  # ISO 717-2 annex D, of the ball
OCTAVES: Final = {"tapping machine": (125, 250, 500, 1000, 2000), "bang machine": (63, 125, 250, 500)}
HEAD: Final = 0.015  # m, radius of a hammer
MANY: Final = 4.0  # modes in a band from which on levels follow the statistics
_MACHINE: Final = (0.5, 0.04)  # mass [kg] and drop height [m] of a hammer, ISO 10140-5 annex E
# the sources' own: mass [kg], drop height [m]; laws fitted to the tables of JIS A 1418-2, as the program states them
_DROPPED: Final = {"rubber ball": (2.5, 1.0), "bang machine": (7.3, 0.85)}
_DEPTHS: Final = 1e-3 * np.array([0, 0.2, 0.4, 0.6, 0.8, 1, 1.3, 1.6, 2, 2.5, 3, 4, 5, 7, 10, 15, 20, 30, 40, 50, 60])
_FROM: Final = ("modes", "statistical", "blank")
_LIGHT = "0.005 dB: 161 lines in a filter's band, straight lines between directions of waves on the rectangle"
_HEAVY = "0.005 dB: rates of four stages are moved apart by 1e-4 each, so that they differ"
_BANG = "0.02 dB: 20 us between samples of a force that begins with the square root of time"
_EXACT = "closed forms; slopes of waves and means over angles to 1e-9"
_BESIDE = "0.005 dB of levels, and of differences of some decibels"


# ---- drawn


def _material(rng: np.random.Generator, ortho: bool) -> Draft:
    E = between(rng, 8e9, 4e10)
    if not ortho:
        return {"E": E, "nu": even(rng, 0.1, 0.35), "rho": even(rng, 1000, 2600)}
    moduli = [rounded(E * float(rng.uniform(0.03, 0.1))) for _ in range(2)]
    return {
        "E": [E, rounded(E * float(rng.uniform(0.1, 0.6)))], "G": [moduli[0], *sorted(moduli)],
        "nu": even(rng, 0.1, 0.35), "rho": even(rng, 400, 1200),
    }  # fmt: skip


def _made(rng: np.random.Generator, model: Draft, kind: str) -> None:
    """What the plate is of: one material, one with axes, glued layers crosswise, or layers that lose differently."""
    part, h = model["parts"]["p"], rounded(float(rng.uniform(0.05, 0.2)))
    model["materials"] = {"m": _material(rng, kind in ("ortho", "crosswise"))}
    own = model["materials"]["m"]
    if kind == "plain":
        part |= {"material": "m", "thickness": h}
    elif kind == "ortho":
        part["layers"] = [["m", h, "0 deg" if rng.random() < 0.5 else "90 deg"]]
    elif kind == "crosswise":
        turns = ["0 deg", "90 deg"] * 4
        first, count = int(rng.integers(2)), int(rng.integers(2, 6))
        part["layers"] = [["m", rounded(h / count * float(rng.uniform(0.7, 1.3))), turns[first + n]]
                          for n in range(count)]  # fmt: skip
    else:  # with one Poisson's ratio, whose layers bend by the same shares in every motion
        model["materials"]["n"] = own | {"E": between(rng, 5e9, 4e10), "rho": even(rng, 800, 2600)}
        part["layers"] = [[name, rounded(h / 3 * float(rng.uniform(0.6, 1.4)))] for name in ("m", "n", "m")]


def _damped(rng: np.random.Generator, model: Draft) -> None:
    """Losses of the plate, one law for all modes."""
    kind, loss = int(rng.integers(4)), even(rng, 0.01, 0.08)
    if kind == 3:
        model["damping"] = {"from": "materials"}
        for one in model["materials"].values():
            one["loss_factor"] = even(rng, 0.01, 0.08)
        if len(model["materials"]) == 1 and rng.random() < 0.5:
            model["materials"]["m"]["loss_factor"] = {"80 Hz": loss, "500 Hz": even(rng, 0.01, 0.08)}
    else:
        rayleigh = {"alpha": rounded(loss * 2 * pi * 60), "beta": rounded(loss / (2 * pi * 800))}
        model["damping"] = [{"ratio": loss / 2}, {"loss_factor": loss}, {"rayleigh": rayleigh}][kind]


def _floor(rng: np.random.Generator, kind: str) -> Draft:
    """A plate on its edges, with some modes and as coarse as these need."""
    a, b = even(rng, 3, 5.5), even(rng, 2.5, 4.5)
    slab = rng.random() < 0.5
    part: Draft = {"type": "slab" if slab else "plate"}
    part |= {"outline": [[0, 0], [a, 0], [a, b], [0, b]]} if slab else {"origin": [0, 0, 0], "size": [a, b]}
    part["mesh"] = 0.5
    rim = "side 1", "side 2", "side 3", "side 4"
    supports = {f"e{n}": {"on": "p", "set": name, "fix": "simple"} for n, name in enumerate(rim)}
    model: Draft = {
        "parts": {"p": part}, "points": {}, "surfaces": {"low": {"on": "p", "side": "below"}},
        "supports": supports if slab else {"e": {"on": "p", "edge": "all", "fix": "simple"}},
    }  # fmt: skip
    _made(rng, model, kind)
    _damped(rng, model)
    if not slab and rng.random() < 0.5:
        sides = [rounded(a * float(rng.uniform(0.5, 0.9))), rounded(b * float(rng.uniform(0.5, 0.9)))]
        model["surfaces"]["low"]["region"] = {"rectangle": sides, "at": [a / 2, b / 2]}
    return model


def _over(rng: np.random.Generator, structure: Model) -> Draft:
    """A box that the plate covers, or a part of it."""
    size = [rounded(one + even(rng, 0.0, 1.0)) for one in _sides(structure)]
    times: Any = even(rng, 0.3, 2.0)
    if rng.random() < 0.4:
        times = {f"{band} Hz": rounded(times * (63 / band) ** even(rng, 0.0, 0.3)) for band in (63, 250, 1000)}
    return {
        "size": [*size, even(rng, 2.0, 3.5)], "under": "low", "losses": {"t60": times},
        "air": {"c": even(rng, 325, 355), "rho": even(rng, 1.05, 1.35)}, "ensemble": 0,
    }  # fmt: skip


def studied(rng: np.random.Generator, source: str, kind: str) -> Draft:
    """Blows of a source at some places on a plate, heard at some places of the box below, by the standards for it."""
    structure = _floor(rng, kind)
    a, b = _whole(structure)
    room, light = _over(rng, structure), source == "tapping machine"
    drops = int(rng.integers(1, 3 if light else 4))
    if light:
        at = [[rounded(0.3 * a + 0.1 * n), rounded(b * float(rng.uniform(0.2, 0.8)))] for _ in range(drops)
              for n in range(5)]  # fmt: skip
        body: Draft = {"source": source, "contact": _law(rng)}
        heavy = se.point_mobility(plate_of(structure), 3150.0) < 2.5e-5  # of a hammer 1e-4: a reduction stands for it
        if rng.random() < 0.5 and heavy:
            body["covering"] = {"reduction": {f"{band} Hz": even(rng, 3, 30) for band in levels.THIRDS}}
    else:
        at = [[rounded(a * float(rng.uniform(0.2, 0.8))), rounded(b * float(rng.uniform(0.2, 0.8)))]
              for _ in range(drops)]  # fmt: skip
        body = {"source": source}
    structure["points"]["q"] = {"on": "p", "at": at if len(at) > 1 else at[0]}
    room["receivers"] = {
        f"mic{n}": [rounded(one * float(rng.uniform(0.1, 0.9))) for one in room["size"]]
        for n in range(int(rng.integers(1, 5)))
    }
    iso = source == "rubber ball" or (light and rng.random() < 0.6)
    room["levels"] = ["ISO 16283-2"] if rng.random() < 0.6 else ["ISO 717-2"]
    if not iso:
        room["levels"] = ["JIS A 1419-2"]
    study: Draft = {
        "modes": {"up_to": 40.0}, "rooms": {"room": room}, "bodies": {"s": body | {"above": "q"}},
        "time": {"duration": 0.5, "sampling": 7600.0 if light else 2000.0},
    }  # fmt: skip
    return {"study": study, "structure": structure}


def _law(rng: np.random.Generator) -> Any:
    """Of a hammer and the plate, from steel on stone to a carpet, with forces that begin at 0."""
    kind = str(rng.choice(["linear", "hertz", "hunt-crossley", "cubic", "flores", "lankarani-nikravesh"]))
    mass, drop = _MACHINE
    while True:
        law = draw_law(rng, mass, sqrt(2 * G * drop), between(rng, 1.5e-4, 4e-3), kind)
        if kind != "linear" or not {"damping", "restitution"} & set(law):
            law.pop("tensile", None)
            return law


# ---- read again


def _whole(structure: Model) -> tuple[float, float]:
    """Sides of the plate."""
    part = structure["parts"]["p"]
    return tuple(part["size"] if "size" in part else part["outline"][2])


def _sides(structure: Model) -> tuple[float, float]:
    """Of what radiates."""
    region = structure["surfaces"]["low"].get("region", {})
    return tuple(region.get("rectangle", _whole(structure)))


def plate_of(structure: Model) -> se.Plate:
    """With shear, crosswise or plain."""
    laid = plies(structure)
    of = section(laid)
    each = [(section([one]), one) for one in laid]
    layers = [
        [(own.A / one.thickness, float(own.S[axis, axis]) * 6 / 5 / one.thickness, one.thickness) for own, one in each]
        for axis in (0, 1)
    ]
    shear = (se.shear_stiffness(layers[0], 0), se.shear_stiffness(layers[1], 1))
    return se.layered(of.A, of.B, of.D, shear, of.mass)


def _lost(structure: Model, f: float) -> float:
    """Loss factor of the plate at a frequency."""
    damping = structure["damping"]
    if "ratio" in damping or "loss_factor" in damping:
        return float(damping.get("loss_factor", 2 * damping.get("ratio", 0.0)))
    if "rayleigh" in damping:
        omega = 2 * pi * f
        return float(damping["rayleigh"]["alpha"] / omega + damping["rayleigh"]["beta"] * omega)
    laid, made = plies(structure), structure["materials"]
    names = [one[0] for one in structure["parts"]["p"].get("layers", [["m"]])]
    if len(set(names)) == 1:
        told = made[names[0]]["loss_factor"]
        if not isinstance(told, Mapping):
            return float(told)
        points = [(float(key.split()[0]), one) for key, one in told.items()]
        return float(np.interp(np.log(f), np.log([one for one, _ in points]), [one for _, one in points]))
    z = np.cumsum([0.0, *(one.thickness for one in laid)])
    stiff = np.array([one.E1 for one in laid])
    neutral = float(stiff @ np.diff(z**2) / 2 / (stiff @ np.diff(z)))
    bends = stiff * np.diff((z - neutral) ** 3)  # shares of the energy, the same in all motions by one Poisson's ratio
    return float(np.average([made[name]["loss_factor"] for name in names], weights=bends))


def room_of(model: Model) -> se.Room:
    told = model["study"]["rooms"]["room"]
    lost = losses_of(told["losses"])
    return se.Room(tuple(told["size"]), lost["gamma"], lost.get("tau", 0.0), told["air"]["c"], told["air"]["rho"])


def thirds_of(model: Model) -> dict[int, tuple[int, ...]]:
    """Bands of the standards, each with its third octaves."""
    (body,), (standard,) = model["study"]["bodies"].values(), model["study"]["rooms"]["room"]["levels"]
    if standard.startswith("ISO"):
        return {band: (band,) for band in (LOW_THIRDS if body["source"] == "rubber ball" else levels.THIRDS)}
    every = (50, 63, 80, *levels.THIRDS)
    return {band: every[every.index(band) - 1 : every.index(band) + 2] for band in OCTAVES[body["source"]]}


def floor_of(model: Model, thin: bool = False) -> se.Floor:
    structure = model["structure"]
    light = model["study"]["bodies"]["s"]["source"] == "tapping machine"
    plate = plate_of(structure)
    thirds = [one for some in thirds_of(model).values() for one in some]
    lost = {band: _lost(structure, levels.exact(band)) for band in thirds}
    a, b = _whole(structure)
    return se.Floor(plate.thin if thin else plate, a * b, _sides(structure), lost, HEAD if light else 0.0)


def exposures_of(model: Model) -> dict[int, float]:
    """Of one blow on the resistance of the infinite plate at the middle of the bands."""
    body = model["study"]["bodies"]["s"]
    thirds = [one for some in thirds_of(model).values() for one in some]
    resistance = 1 / se.point_mobility(plate_of(model["structure"]), sqrt(thirds[0] * thirds[-1]))
    mass, drop = _MACHINE if body["source"] == "tapping machine" else _DROPPED[body["source"]]
    speed = sqrt(2 * G * drop)
    if body["source"] == "tapping machine":
        law = law_of(body["contact"], mass, speed)
    elif body["source"] == "bang machine":
        law = ev.hertz(857_926.0, 1277.5)
    else:
        forces = 51.848e3 * _DEPTHS + 335.13 * (1 - np.exp(-_DEPTHS / 0.82695e-3))
        spring = PchipInterpolator(_DEPTHS, forces)
        law = ev.factored(lambda d, _: float(spring(d)), 0.059583)
    t, force = se.blow(mass, speed, law, resistance)
    return {band: se.exposure(levels.exact(band), t, force) for band in thirds}


def levels_of(model: Model, thin: bool = False) -> Floats:
    """In the room, not standardised, by band."""
    floor, room, exposed = floor_of(model, thin), room_of(model), exposures_of(model)
    found = []
    for some in thirds_of(model).values():
        if model["study"]["bodies"]["s"]["source"] == "tapping machine":  # ten blows a second
            found.append(sum(se.steady(floor, room, band, 10 * exposed[band]) for band in some))
        else:
            found.append(se.largest(floor, room, {band: exposed[band] for band in some}, 1 if len(some) == 3 else 3))
    covering = model["study"]["bodies"]["s"].get("covering", {"reduction": {}})["reduction"]
    less = [covering.get(f"{band} Hz", 0.0) for band in thirds_of(model)]
    return np.array([se.decibels(one) for one in found]) - less


def counts_of(model: Model) -> Floats:
    """Modes by band, of the theory of plates that the part has, and the scatter to expect."""
    plate, room, (a, b) = plate_of(model["structure"]), room_of(model), _whole(model["structure"])
    plate = plate.thin if model["structure"]["parts"]["p"]["type"] == "plate" else plate
    bands = thirds_of(model)
    fraction = 3 if all(len(some) == 1 for some in bands.values()) else 1
    at = np.array([levels.exact(band) for band in bands])
    width = np.array([se.width(band, fraction) for band in bands])
    modes = se.modes_per_hz(plate, at, a * b) * width
    receivers = len(model["study"]["rooms"]["room"]["receivers"])
    told = zip(modes.tolist(), width.tolist(), at.tolist(), strict=True)
    return np.array([modes, [se.scatter(n, wide, room.t60(f), _drops(model), receivers) for n, wide, f in told]])


def _drops(model: Model) -> int:
    at = model["structure"]["points"]["q"]["at"]
    places = len(at) if isinstance(at[0], list) else 1
    return places // 5 if model["study"]["bodies"]["s"]["source"] == "tapping machine" else places


# ---- asked


def _correction(model: Model) -> Floats:
    """What standardising adds in every band, by the reverberation times there."""
    room, told = room_of(model), model["study"]["rooms"]["room"]["levels"]
    bands = thirds_of(model)
    if told != ["ISO 16283-2"]:
        return np.zeros(len(bands))
    times = [room.t60(float(band)) for band in bands]
    if model["study"]["bodies"]["s"]["source"] == "tapping machine":
        return np.array([-10 * log10(one / 0.5) for one in times])
    return np.array([10 * log10(room.volume / 50) - 10 * log10(fast_gain(one) / fast_gain(0.5)) for one in times])


def _told(model: Model, door: Door) -> dict[str, Any]:
    rated: dict[str, Any] = answer_of(model, door)["rated"]["room"]
    return rated


def _numbers(values: Mapping[str, Any]) -> list[float]:
    """0 where there is none."""
    return [0.0 if one is None else float(one) for one in values.values()]


def _levels_case(model: Model, tolerance: float, why: str) -> Case:
    """By statistics, and as they stand in bands with a mode or more."""

    def asked(model: Model, door: Door) -> Floats:
        rated = _told(model, door)
        return np.array([*_numbers(rated["statistical"]["levels_db"]), *_numbers(rated["bands_db"])])

    def right(model: Model, _: Door) -> Floats:
        found = levels_of(model)
        return np.array([*found, *np.where(counts_of(model)[0] >= 1, found + _correction(model), 0.0)])

    return Case(model, asked, right, tolerance, why)


def _kind(rng: np.random.Generator) -> str:
    return str(rng.choice(["plain", "plain", "ortho", "crosswise", "layers"]))


@capability("levels by energies: a tapping machine on a plate", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _levels_case(studied(rng, "tapping machine", _kind(rng)), 1e-4, _LIGHT)


@capability("levels by energies: a rubber ball on a plate", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _levels_case(studied(rng, "rubber ball", _kind(rng)), 1e-4, _HEAVY)


@capability("levels by energies: a bang machine on a plate", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _levels_case(studied(rng, "bang machine", _kind(rng)), 4e-4, _BANG)


@capability("levels by energies: modes in bands, scatter, what is filled", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Of one plate with bands beyond its modes filled, and left blank as is asked; what the finding says of them."""
    model = studied(rng, str(rng.choice(["tapping machine", "rubber ball", "bang machine"])), _kind(rng))

    def asked(model: Model, door: Door) -> Floats:
        case = answer_of(model, door)
        rated, found = case["rated"]["room"], {one["code"]: one["values"] for one in case["findings"]}
        said = [found["statistical-bands"][key] for key in ("bands", "first_hz", "scatter_db", "few_modes")]
        room = model["study"]["rooms"]["room"] | {"beyond_modes": "blank"}
        left = _told(model | {"study": model["study"] | {"rooms": {"room": room}}}, door)
        told = rated["statistical"]
        words = [_FROM.index(one) for some in (rated, left) for one in some["bands_from"].values()]
        none = [float(left[key] is None) for key in ("statistical", "statistical_agreement")]
        blank = [len(left["bands_db"]) - sum(one is None for one in left["bands_db"].values())]
        return np.array([*_numbers(told["modes"]), *_numbers(told["scatter_db"]), *words, *none, *blank, *said]) + 1

    def right(model: Model, _: Door) -> Floats:
        modes, scatter = counts_of(model)
        words, filled = [*np.where(modes >= 1, 1, 2), *[2] * len(modes)], modes >= 1
        first = list(thirds_of(model))[int(np.argmax(filled))]
        said = [filled.sum(), first, scatter[filled].max(), (filled & (modes < MANY)).sum()]
        return np.array([*modes, *scatter, *words, 1, 1, 0, *said]) + 1

    return Case(model, asked, right, 1e-8, _EXACT, each=True)


def _dense(rng: np.random.Generator) -> Draft:
    """A thin plate with four modes and more in bands below 250 Hz, and its modes to there."""
    source = str(rng.choice(["tapping machine", "rubber ball"]))
    model = studied(rng, source, str(rng.choice(["plain", "ortho"])))
    part = model["structure"]["parts"]["p"]
    h = even(rng, 0.03, 0.05)
    part["mesh"] = 0.25
    if "layers" in part:
        part["layers"][0][1] = h
    else:
        part["thickness"] = h
    model["study"]["modes"]["up_to"] = even(rng, 220, 320)
    model["study"]["bodies"]["s"].pop("covering", None)  # the plate is too light for it
    room = model["study"]["rooms"]["room"]
    if room["levels"] == ["JIS A 1419-2"]:  # which averages levels over places, where energies are compared
        room["levels"] = ["ISO 717-2"]
    return model


@capability("levels by energies: modes beside them", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """How many bands both have, the mean of modal less statistical levels, its deviation, and what it may be."""

    def asked(model: Model, door: Door) -> Floats:
        found = _told(model, door)["statistical_agreement"] or {}
        return np.array(_numbers({key: found.get(key) for key in ("bands", "mean_db", "deviation_db", "allowed_db")}))

    def right(model: Model, door: Door) -> Floats:
        rated = _told(model, door)
        modal = np.array(_numbers(rated["bands_db"])) - _correction(model)
        modes, scatter = counts_of(model)
        both = (modes >= MANY) & np.array([one == "modes" for one in rated["bands_from"].values()])
        if not both.any():
            return np.zeros(4)
        thin = model["structure"]["parts"]["p"]["type"] == "plate"
        off, n = (modal - levels_of(model, thin))[both], int(both.sum())
        allowed = max(1.0, 2 * sqrt(float((scatter[both] ** 2).sum())) / n)
        return np.array([n, off.mean(), off.std(ddof=1) if n > 1 else 0.0, allowed])

    return Case(_dense(rng), asked, right, 2e-3, _BESIDE)


# ---- floors that have none


def _with_a_mass(model: Draft, _: np.random.Generator) -> None:
    a, b = _whole(model["structure"])
    model["structure"]["points"]["w"] = {"on": "p", "at": [0.4 * a, 0.3 * b]}
    model["structure"]["parts"]["load"] = {"type": "mass", "at": "w", "mass": 40.0}


def _sprung(model: Draft, rng: np.random.Generator) -> None:
    held = model["structure"]["supports"]
    name = str(rng.choice(list(held)))
    del held[name]["fix"]
    held[name]["stiffness"] = {"z": between(rng, 1e7, 1e9)}


def _askew(model: Draft, rng: np.random.Generator) -> None:
    part = model["structure"]["parts"]["p"]
    h = part.pop("thickness", 0.0) or sum(one[1] for one in part["layers"])
    part.pop("material", None)
    model["structure"]["materials"]["m"] = {**_material(rng, True), "loss_factor": 0.03}
    model["structure"]["materials"].pop("n", None)
    part["layers"] = [["m", h, f"{even(rng, 5, 85)} deg"]]


def _smeared(model: Draft, rng: np.random.Generator) -> None:
    part, D = model["structure"]["parts"]["p"], between(rng, 1e6, 1e7)
    for key in ("material", "layers"):
        part.pop(key, None)
    part |= {"thickness": 0.2, "smeared": {"D": [D, D / 2, D / 10, D / 5], "S": [D * 20, D * 10], "mass": 90.0,
                                           "loss_factor": 0.03}}  # fmt: skip
    model["structure"]["materials"] = {}


def _undamped(model: Draft, _: np.random.Generator) -> None:
    model["structure"]["damping"] = {"from": "materials"}
    for one in model["structure"]["materials"].values():
        one.pop("loss_factor", None)


def _pushed(model: Draft, rng: np.random.Generator) -> None:
    a, b = _whole(model["structure"])
    model["structure"]["points"]["w"] = {"on": "p", "at": [0.4 * a, 0.3 * b]}
    push = {"amplitude": even(rng, 10, 100), "frequency": even(rng, 20, 200)}
    model["study"]["loads"] = {"push": {"at": "w.z", "half_sine": push}}


_OTHERS: Final = (_with_a_mass, _sprung, _askew, _smeared, _undamped, _pushed)


@capability("levels by energies: floors that have none", "limit", slow=True)
def _(rng: np.random.Generator) -> Case:
    """A plate as it is; with a mass on it, an edge on springs, layers askew, smeared rigidities, no losses, another
    force beside: no level by energies, and blank bands."""
    plain = studied(rng, "rubber ball", _kind(rng))
    models = {"plain": plain}
    for change in _OTHERS:
        models[change.__name__] = copy.deepcopy(plain)
        change(models[change.__name__], rng)

    def asked(models: Model, door: Door) -> Floats:
        told = [_told(model, door) for model in models.values()]
        return np.array([[one["statistical"] is None, *_blank(one)] for one in told], float)

    def right(models: Model, _: Door) -> Floats:
        few = counts_of(models["plain"])[0] < 1
        return np.array([[0, *few], *[[1] * (1 + len(few))] * len(_OTHERS)], float)

    return Case(models, asked, right, 1e-9, "yes or no")


def _blank(rated: Mapping[str, Any]) -> list[bool]:
    return [one == "blank" for one in rated["bands_from"].values()]
