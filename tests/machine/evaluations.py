"""Shock spectra, weighted vibration and fatigue of points that bodies strike, or beside them, over all laws."""

from __future__ import annotations

import functools
import json
from typing import Any, Final

import numpy as np

from tests.independent import contact_events as ev
from tests.independent import vibration as vb
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.impacts import answered, base_of, chain_of, given_modes, modes_of, oscillator, scene
from tests.machine.laws import LAWS, between

_CURVES: Final = {"Wk": vb.w_k, "Wd": vb.w_d, "Wm": vb.w_m}
_KNOBS = ("structure",)
_FILTERS = "the program's digital filters miss the curves by up to 0.9 % at 80 Hz, and its samples the peak of a blow"


def struck(rng: np.random.Generator, kind: str = "", beside: bool = True) -> dict[str, Any]:
    """One blow; beside : what is judged is another point than the struck one, where there is one."""
    while True:
        structure = oscillator(rng) if rng.random() < 0.5 else given_modes(rng, 10.0)
        omega = modes_of(structure)[0]
        if omega[0] > 60.0:
            break
    model = scene(rng, structure, kind or str(rng.choice(LAWS)))
    study, base = model["study"], base_of(structure)
    point = "Q" if base == "P" and beside else base
    time = study["time"]["duration"] / 6
    duration = float(f"{min(max(16.0 / omega[0], 0.1), 0.6):.6g}")
    study["time"] = {"duration": duration, "sampling": float(np.ceil(max(5000.0, 100 / time, 3.2 * omega[-1])))}
    study["record"] = {f"{point}.z": ["displacement", "velocity", "acceleration"]}
    return {**model, "point": point}


@functools.lru_cache(maxsize=4)
def _motion(text: str) -> tuple[Floats, Floats, Floats, float]:
    """Displacement, velocity and acceleration of the point, and the step."""
    model = json.loads(text)
    time = model["study"]["time"]
    # sixty in a contact, whose pieces change there and back
    steps = 60 * time["duration"] * time["sampling"] / 100
    path = ev.run(chain_of(model), time["duration"], 1e-10, time["duration"] / max(steps, 200))
    t = np.linspace(0, time["duration"], int(min(max(3 * time["sampling"] * time["duration"], 6000), 15000)) + 1)
    point = model["point"]
    return path.moved(point, t), path.speed(point, t), path.acceleration(point, t), float(t[1])


def _of(model: Model) -> tuple[Floats, Floats, Floats, float]:
    return _motion(json.dumps(model))


def _spectrum(rng: np.random.Generator, kind: str, beside: bool) -> Case:
    model = struck(rng, kind, beside)
    ratio = float(rng.choice([0.03, 0.05, 0.1]))
    band = [between(rng, 5, 20), between(rng, 60, 300)]
    model["study"]["shock_spectra"] = {"s": {"of": f"{model['point']}.z", "damping": ratio, "band": band}}

    def asked(model: Model, door: Door) -> Floats:
        return np.array([answered(model, door)["shock_spectra"]["s"]["largest"]])

    def right(model: Model, _: Door) -> Floats:
        f = np.geomspace(*band, 120)
        return np.array([np.max(vb.shock_spectrum(*_of(model)[2:], f, ratio))])

    return Case(model, asked, right, 0.03, "frequencies of the spectrum between those of the other; samples", _KNOBS)


def _felt(rng: np.random.Generator, weighting: str, key: str, kind: str, beside: bool) -> Case:
    model = struck(rng, kind, beside)
    model["study"]["perception"] = {"w": {"of": f"{model['point']}.z", "weighting": weighting}}

    def asked(model: Model, door: Door) -> Floats:
        return np.array([answered(model, door)["perception"]["w"][key]])

    def right(model: Model, _: Door) -> Floats:
        _, speed, rate, step = _of(model)
        if weighting == "KB":
            return np.array([vb.running_rms(vb.weighted(speed * 1e3, 1 / step, vb.kb), 1 / step, 0.125).max()])
        rate = np.r_[rate[0] / 2, rate[1:]]  # where it jumps from rest, a sum has the mean
        felt = vb.weighted(rate, 1 / step, _CURVES[weighting])
        dose = (np.sum(felt**4) * step) ** 0.25
        return np.array([dose if key == "vdv" else vb.running_rms(felt, 1 / step, 1.0).max()])

    return Case(model, asked, right, 0.02, _FILTERS, _KNOBS)


def _over_laws(name: str, draw: Any, slow: bool = False) -> None:
    """A capability of points beside the struck one, and one of the struck point, over all laws in turn."""
    for place, beside in (("beside a blow", True), ("at the struck point", False)):

        @capability(f"evaluations: {name} {place}", "independent", slow=slow)
        def _(rng: np.random.Generator, beside: bool = beside) -> Case:
            case: Case = draw(rng, str(rng.choice(LAWS)), beside)
            return case


_over_laws("shock spectrum", _spectrum)
for _weighting in ("KB", "Wk", "Wd", "Wm"):
    _over_laws(_weighting, lambda rng, kind, beside, w=_weighting: _felt(rng, w, "largest", kind, beside), slow=True)
_over_laws(
    "vibration dose",
    lambda rng, kind, beside: _felt(rng, str(rng.choice(list(_CURVES))), "vdv", kind, beside),
    slow=True,
)


@capability("evaluations: rainflow damage of a blow", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = struck(rng)
    slope = float(rng.uniform(2, 6))
    line = {"range": between(rng, 1e-3, 0.1), "slope": slope, "at": between(rng, 1e3, 1e6)}
    model["study"]["fatigue"] = {"f": {"of": f"{model['point']}.z displacement", "sn": line}}

    def asked(model: Model, door: Door) -> Floats:
        return np.array([answered(model, door)["fatigue"]["f"]["damage"]])

    def right(model: Model, _: Door) -> Floats:
        return np.array([vb.miner(vb.rainflow(_of(model)[0]), line["slope"], line["range"], line["at"])])

    why = "samples miss a peak by 0.3 % at most, which counts up to six times"
    return Case(model, asked, right, 0.02, why, _KNOBS)
