"""Sound of a window that ends while its source still moves, and which bands a record has, by sampling and length."""

from __future__ import annotations

import copy
from math import pi
from typing import Any, Final

import numpy as np
from scipy.optimize import brentq
from scipy.signal import butter

from tests.independent import levels
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.laws import rounded
from tests.machine.pistons import piston_of
from tests.machine.rated import answer_of, heard, struck
from tests.machine.rooms import even

_RATE: Final = 3200.0  # Hz
_FINER: Final = 8  # times as fast is the reference sampled
_MIC: Final = "room.mic pressure"
_NOMINAL: Final = (16, 20, 25, 31.5, 40, 50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600,
                   2000, 2500, 3150, 4000, 5000, 6300, 8000, 10000, 12500)  # fmt: skip


def _short(rng: np.random.Generator) -> dict[str, Any]:
    """A piston that is still moving at the end of the record, struck softly."""
    model = struck(rng)
    law, mass = model["study"]["bodies"]["ball"]["contact"], model["study"]["bodies"]["ball"]["mass"]
    law["stiffness"] = rounded(mass * (pi / float(rng.uniform(6e-3, 1e-2))) ** 2)
    law["damping"] = 0.0
    own = piston_of(model["structure"]).hz
    model["structure"]["damping"] = {"ratio": even(rng, 0.005, 0.03)}
    model["study"]["time"] = {"duration": rounded(float(rng.uniform(1.5, 5)) / own), "sampling": _RATE}
    return model


@capability("rooms: a piston that still moves when the record ends", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """The same motion followed for longer, its sound cut where the record ends: what comes later is not heard."""

    model = _short(rng)
    count = int(model["study"]["time"]["duration"] * _RATE * (1 - 1e-9))

    def low(p: Floats) -> Floats:
        return np.asarray(p[:count] / np.abs(p[:count]).max())

    def asked(model: Model, door: Door) -> Floats:
        return low(np.asarray(door.histories({"model": "s.yaml", **model["study"]}, s=model["structure"])[_MIC]))

    def right(model: Model, _: Door) -> Floats:
        longer = copy.deepcopy(dict(model))
        longer["study"]["time"]["duration"] *= 1.6
        return low(heard(longer)[::_FINER])

    why = "a plate of cells that yields 1e-3, and the part of a blow that is faded out near half the sampling"
    return Case(model, asked, right, 3e-3, why)


def _reach(fraction: int) -> float:
    """How far over its centre the filter of a band must be given: what a third octave beyond, 10 dB louder, adds by
    the flank of a Butterworth filter of order 4 is 0.2 dB there."""
    edge = 10 ** (0.15 / fraction)

    def more(r: float) -> float:
        x = (r - 1 / r) / (edge - 1 / edge)
        return float(10 * np.log10(1 + 10 / (3 / fraction) / (1 + x**8)) - 0.2)

    return float(brentq(more, edge, 4.0, xtol=1e-12))


def _given(end: float, sampling: float, fraction: int) -> dict[float, float]:
    """By band: 2 if it has a level, 1 if it is blank for lack of modes, 0 if the record does not have it."""
    found, edge = {}, 10 ** (0.15 / fraction)
    for number, nominal in enumerate(_NOMINAL):
        at = levels.exact(nominal)
        there = nominal >= 25 and at * edge <= 0.47 * sampling and (fraction == 3 or number % 3 == 0)
        found[nominal] = (1.0 + (at * _reach(fraction) <= end)) * there
    return found


def _slowest(nominal: float) -> float:
    """Time in which the filter of a third octave decays by 60 dB, from its poles."""
    at, edge = levels.exact(nominal), 10**0.05
    poles = butter(4, [2 * pi * at / edge, 2 * pi * at * edge], "bandpass", analog=True, output="zpk")[1]
    return float(3 * np.log(10) / np.abs(poles.real).min())


@capability("levels: which bands a record has, and which have settled", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """By sampling, by where modes end, and by the length of the record."""
    model = struck(rng)
    sampling = float(round(10 ** rng.uniform(3.1, 4.2)))
    end = rounded(sampling * float(rng.uniform(0.1, 0.7)))
    model["study"]["modes"] = {"up_to": end}
    model["study"]["time"] = {"duration": rounded(float(rng.uniform(0.06, 0.3))), "sampling": sampling}
    del model["study"]["rooms"]["room"]["levels"]

    def asked(model: Model, door: Door) -> Floats:
        found = answer_of(model, door)
        level = found["levels"]["room.mic"]
        told = [one["values"] for one in found["findings"] if one["code"] == "band-not-settled"]
        out = [level["complete_below_hz"], told[0]["highest_hz"] if told else 0.0]
        for key in ("bands_db", "exposure_db", "octaves_db"):
            bands = level[key]
            out += [1.0 + (bands[f"{one:g}"] is not None) if f"{one:g}" in bands else 0.0 for one in _NOMINAL]
            out.append(len(bands))
        return np.array(out)

    def right(model: Model, _: Door) -> Floats:
        time, end = model["study"]["time"], float(model["study"]["modes"]["up_to"])
        thirds, octaves = (_given(end, time["sampling"], fraction) for fraction in (3, 1))
        slow = [one for one, there in thirds.items() if there and _slowest(one) > time["duration"]]
        out = [end, max(slow, default=0.0)]
        for given in (thirds, thirds, octaves):
            out += [*given.values(), sum(there > 0 for there in given.values())]
        return np.array(out)

    return Case(model, asked, right, 1e-9, "yes or no", each=True)
