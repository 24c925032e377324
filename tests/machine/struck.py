"""Rods, beams and given modes in closed form, struck, driven and walked on; stops, released links, repeated loads."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from tests.independent.vibration import receptance
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.impacts import (
    NOTHING,
    any_law,
    base_of,
    clear,
    given_modes,
    modes_of,
    motions,
    motions_right,
    oscillator,
    path_of,
    record,
    scene,
    times_of,
)
from tests.machine.laws import between, draw_law, rounded

_KNOBS = ("study.bodies", "study.contacts", "study.links", "study.loads", "structure")
_WHY = "both integrate to 1e-9 and better; draws whose answer hangs on rounding are drawn again"
_ENDS = ("pinned", "free", "clamped")


def rod(rng: np.random.Generator) -> dict[str, Any]:
    """A free rod with its ends P and Q; few modes, that are all there is."""
    length = between(rng, 0.5, 5)
    what = {
        "type": "rod", "length": length, "E": between(rng, 1e8, 1e11), "rho": between(rng, 500, 8000),
        "area": between(rng, 1e-4, 1e-2), "modes": int(rng.integers(3, 6)),
    }  # fmt: skip
    points = {"P": {"at": rounded(0.99 * length)}, "Q": {"at": rounded(0.01 * length)}}
    return {"structure": what, "points": points, "damping": {"ratio": rounded(float(rng.uniform(0.01, 0.08)))}}


def beam(rng: np.random.Generator) -> dict[str, Any]:
    """A beam with points P and Q; few modes, that are all there is."""
    length, ends = between(rng, 0.5, 5), [str(one) for one in rng.choice(_ENDS, 2)]
    hz, mass = between(rng, 10, 100), between(rng, 0.1, 30)
    what = {
        "type": "beam", "length": length, "ends": ends, "mass_per_length": mass,
        "EI": rounded(mass * (2 * pi * hz * (length / 3.5) ** 2) ** 2), "modes": int(rng.integers(3, 6)),
    }  # fmt: skip
    points = {name: {"at": rounded(length * float(rng.uniform(0.15, 0.85)))} for name in "PQ"}
    return {"structure": what, "points": points, "damping": {"ratio": rounded(float(rng.uniform(0.01, 0.08)))}}


def bare_modes(rng: np.random.Generator) -> dict[str, Any]:
    """Given modes whose points are their shapes alone."""
    structure = given_modes(rng)
    what = structure["structure"]
    what["points"] = {name: one["shape"] for name, one in what["points"].items()}
    return structure


_STRUCTURES = {"an oscillator": oscillator, "given modes": given_modes, "bare modes": bare_modes, "a rod": rod,
               "a beam": beam}  # fmt: skip


# ---- in frequency


def _first(structure: Model) -> float:
    return next(w for w in modes_of(structure)[0] if w) / 2 / pi


def _driven(draw: Any, rng: np.random.Generator) -> Case:
    structure = draw(rng)
    what = structure["structure"]
    if what["type"] == "modes":
        what["ratio"] = [rounded(float(rng.uniform(0.01, 0.08))) for _ in what["frequency"]]
    else:
        structure["damping"]["ratio"] = rounded(float(rng.uniform(0.01, 0.08)))
    names = sorted(modes_of(structure)[2])
    axis, hz = "x" if what["type"] == "rod" else "z", _first(structure)
    lines = rounded(0.2 * hz) + rounded(hz / 20) * np.arange(31)
    drive, answer = (str(rng.choice(names)) for _ in range(2))

    def asked(model: Model, door: Door) -> Floats:
        band = f"{lines[0]} Hz:{lines[-1] * (1 + 1e-12)} Hz"
        words = ("--drive", f"{drive}.{axis}", "--response", f"{answer}.{axis}", "--band", band)
        found = door.ask(model, "frf", *words, "--step", f"{float(lines[1] - lines[0])!r}", "--kind", "receptance")
        return np.r_[found["real"], found["imag"]]

    def right(model: Model, _: Door) -> Floats:
        omega, ratio, shapes = modes_of(model)
        found = receptance(omega, ratio, shapes[drive], shapes[answer])(2 * pi * lines)
        return np.r_[found.real, found.imag]

    return Case(structure, asked, right, 1e-6, "the same few modes; steps of frequencies round to 1e-9", ("structure",))


def _shaped(draw: Any, rng: np.random.Generator) -> Case:
    structure = draw(rng)

    def asked(model: Model, door: Door) -> Floats:
        return door.modes(model, len(modes_of(model)[0]))

    def right(model: Model, _: Door) -> Floats:
        return np.array(modes_of(model)[0]) / 2 / pi

    return Case(structure, asked, right, 1e-9, "closed forms to rounding", ("structure",))


def _in_frequency(name: str) -> None:
    @capability(f"structures: modes of {name}", "independent")
    def _(rng: np.random.Generator) -> Case:
        return _shaped(_STRUCTURES[name], rng)

    @capability(f"structures: response of {name}", "independent")
    def _(rng: np.random.Generator) -> Case:
        return _driven(_STRUCTURES[name], rng)


for _name in _STRUCTURES:
    _in_frequency(_name)


# ---- in time


def _of_motions(draw: Any) -> Case:
    return Case(clear(draw, motions_right), motions, motions_right, 1e-6, _WHY, _KNOBS)


def _along(model: dict[str, Any]) -> dict[str, Any]:
    """What strikes from above strikes the end of a rod instead."""
    study = model["study"]
    for body in study["bodies"].values():
        body["after"] = body.pop("above")
    study["record"] = {name.replace(".z", ".x"): what for name, what in study["record"].items()}
    return model


@capability("structures: a blow on a rod", "independent")
def _(rng: np.random.Generator) -> Case:
    """And a body at rest at its other end."""

    def draw() -> dict[str, Any]:
        model = _along(scene(rng, rod(rng)))
        study = model["study"]
        mass, speed = between(rng, 0.05, 2), study["bodies"]["a"].get("speed", 1.0)
        study["bodies"]["d"] = {"mass": mass, "before": "Q"}
        law = draw_law(rng, mass, speed, between(rng, 5e-4, 5e-3), any_law(rng), e=False)
        study["contacts"]["far"] = {"between": ["d", "Q"], "law": law}
        study["record"]["d"] = ["displacement", "velocity"]
        return model

    return _of_motions(draw)


@capability("structures: a blow on a beam", "independent")
def _(rng: np.random.Generator) -> Case:
    return _of_motions(lambda: scene(rng, beam(rng)))


@capability("structures: a blow on bare modes", "independent")
def _(rng: np.random.Generator) -> Case:
    return _of_motions(lambda: scene(rng, bare_modes(rng)))


def _some(rng: np.random.Generator) -> dict[str, Any]:
    return oscillator(rng) if rng.random() < 0.5 else given_modes(rng)


def _linked(rng: np.random.Generator) -> dict[str, Any]:
    """What is struck, with a body below on a link."""
    model = scene(rng, _some(rng), turns=20.0)
    study, base = model["study"], base_of(model["structure"])
    mass = between(rng, 0.05, 2)
    study["bodies"]["d"] = {"mass": mass, "below": base}
    k = rounded(mass * (2 * pi * between(rng, 10, 200)) ** 2)
    c = [rounded(float(rng.uniform(0.05, 0.5)) * 2 * (k * mass) ** 0.5) for _ in range(2)]
    study["links"] = {
        "hold": {"between": ["d", base], "stiffness": k, "damping": {"closing": c[0], "opening": c[1]}}
    }  # fmt: skip
    record(study, model["structure"])
    return model


def _force(model: dict[str, Any]) -> float:
    """About that of its blow."""
    study = model["study"]
    return float(study["bodies"]["a"]["mass"] * study["bodies"]["a"].get("speed", 1.0) / 2e-3)


@capability("impacts: a dashpot that closes and opens", "independent")
def _(rng: np.random.Generator) -> Case:
    return _of_motions(lambda: _linked(rng))


@capability("impacts: a link with a preload or released later", "independent")
def _(rng: np.random.Generator) -> Case:
    def draw() -> dict[str, Any]:
        model = _linked(rng)
        link = model["study"]["links"]["hold"]
        link["damping"] = link["damping"]["opening"]
        link["preload"] = rounded(float(rng.uniform(0.05, 0.5)) * _force(model))
        if rng.random() < 0.7:
            link["release_at"] = rounded(float(rng.uniform(0.1, 0.6)) * model["study"]["time"]["duration"])
        return model

    return _of_motions(draw)


@capability("impacts: a stop on both sides", "independent")
def _(rng: np.random.Generator) -> Case:
    def draw() -> dict[str, Any]:
        model = _linked(rng)
        study, base = model["study"], base_of(model["structure"])
        mass, reach = study["bodies"]["d"]["mass"], float(rng.uniform(1e-6, 1e-4))
        k = rounded(mass * (2 * pi * between(rng, 100, 500)) ** 2)
        law = {"type": "stop", "stiffness": k, "damping": rounded(float(rng.uniform(0.1, 0.6)) * (k * mass) ** 0.5)}
        study["contacts"]["bumper"] = {"between": ["d", base], "law": law, "gap": rounded(reach)}
        return model

    return _of_motions(draw)


@capability("impacts: loads that come again", "independent")
def _(rng: np.random.Generator) -> Case:
    def draw() -> dict[str, Any]:
        model = scene(rng, _some(rng), turns=12.0)
        study = model["study"]
        duration = study["time"]["duration"]
        push = {"amplitude": rounded(float(rng.uniform(0.2, 1)) * _force(model)),
                "frequency": rounded(float(rng.uniform(3, 10)) / duration)}  # fmt: skip
        study["loads"] = {
            "push": {"at": f"{base_of(model['structure'])}.z", "half_sine": push, "count": int(rng.integers(2, 4)),
                     "every": rounded(duration * float(rng.uniform(0.18, 0.3)))}
        }  # fmt: skip
        return model

    return _of_motions(draw)


@capability("impacts: blows that begin later", "independent")
def _(rng: np.random.Generator) -> Case:
    def draw() -> dict[str, Any]:
        model = scene(rng, NOTHING if rng.random() < 0.3 else _some(rng), turns=12.0)
        study = model["study"]
        duration = study["time"]["duration"]
        study["bodies"]["a"]["blows"] = {
            "count": 2,
            "every": rounded(duration / 3),
            "first": rounded(duration * float(rng.uniform(0.05, 0.3))),
        }
        return model

    return _of_motions(draw)


@capability("impacts: steps of a walker", "independent")
def _(rng: np.random.Generator) -> Case:
    """On an oscillator or given modes of some Hz."""

    def draw() -> dict[str, Any]:
        structure = given_modes(rng)
        what = structure["structure"]
        what["ratio"] = [rounded(float(rng.uniform(0.01, 0.08))) for _ in what["frequency"]]
        pace, steps = rounded(float(rng.uniform(1.4, 2.4))), int(rng.integers(3, 6))
        near = pace * int(rng.integers(1, 3)) * float(rng.uniform(0.95, 1.05))  # a harmonic
        what["frequency"] = [rounded(near * (1 + 1.7 * n)) for n in range(len(what["ratio"]))]
        harmonics = [rounded(float(rng.uniform(0.05, 0.4))) for _ in range(int(rng.integers(2, 4)))]
        walker = {"mass": between(rng, 50, 100), "pace": pace, "steps": steps, "harmonics": harmonics}
        duration = rounded(1.1 * steps / pace)
        study: dict[str, Any] = {
            "loads": {"walk": {"along": "P", "walking": walker}}, "bodies": {}, "record": {},
            "modes": {"count": len(what["frequency"])}, "time": {"duration": duration, "sampling": 200.0},
        }  # fmt: skip
        record(study, structure)
        del study["bodies"]
        return {"study": study, "structure": structure}

    fine = "straight lines between 32 points of a period keep all but (pi / 32)^2 / 3 of it, a rise 1.6 times that"
    return Case(clear(draw, motions_right), _displaced, _displaced_right, 5e-3, fine, _KNOBS)


def _displaced(model: Model, door: Door) -> Floats:
    found = door.histories({"model": "structure.yaml", **model["study"]}, structure=model["structure"])
    return np.concatenate([np.interp(times_of(model), found["t"], found[f"{one}.z displacement"]) for one in "PQ"])


def _displaced_right(model: Model, _: Door) -> Floats:
    path = path_of(model)
    return np.concatenate([path.moved(one, times_of(model)) for one in "PQ"])
