"""Steady vibration of given modes and oscillators under random and harmonic forces and shaken supports."""

from __future__ import annotations

from collections.abc import Callable
from math import log, pi, sqrt
from typing import Any, Final

import numpy as np

from tests.independent import vibration as vb
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.impacts import answered, modes_of, oscillator
from tests.machine.laws import between, rounded

_MOTIONS: Final = ("displacement", "velocity", "acceleration")
_KNOBS = ("structure.structure.ratio",)


def _driven(rng: np.random.Generator) -> dict[str, Any]:
    """Modes with a point P that is driven, and Q that answers, in a band over all of them."""
    frequency = sorted(between(rng, 5, 200) for _ in range(int(rng.integers(1, 5))))
    points = {name: {"shape": [rounded(float(rng.uniform(-1, 1))) for _ in frequency], "at": 0.0} for name in "PQ"}
    ratio = [between(rng, 0.003, 0.2) for _ in frequency]
    low, high = rounded(frequency[0] * rng.uniform(0.2, 0.9)), rounded(frequency[-1] * rng.uniform(1.1, 3))
    line = [[f, between(rng, 0.01, 10)] for f in (low, rounded(sqrt(low * high)), high)]
    noise = {"at": "P.z", "psd": [[f, f"{s!r} N^2/Hz"] for f, s in line], "duration": between(rng, 10, 3600)}
    hum = {"at": "P.z", "harmonic": [[f, f"{s!r} N"] for f, s in line]}
    study = {
        "modes": {"count": len(frequency)},
        "record": {"Q.z": list(_MOTIONS)},
        "vibration": {"noise": noise, "hum": hum},
    }
    structure = {"structure": {"type": "modes", "frequency": frequency, "ratio": ratio, "points": points}}
    return {"study": study, "structure": structure, "line": line}


def _answer(model: Model, what: str) -> Callable[[Floats], Floats]:
    """Size of Q's motion per force at P, of the frequency in Hz."""
    omega, ratio, shapes = modes_of(model["structure"])
    of, power = vb.receptance(omega, ratio, shapes["P"], shapes["Q"]), _MOTIONS.index(what)
    return lambda f: np.abs(of(2 * pi * f) * (2j * pi * f) ** power)


def _moments(model: Model, what: str) -> Floats:
    line, answer = model["line"], _answer(model, what)
    force = vb.log_log([(f, s) for f, s in line])
    peaks = [*model["structure"]["structure"]["frequency"], line[1][0]]
    return vb.moments(lambda f: answer(f) ** 2 * force(f), line[0][0], line[-1][0], peaks)


def _case(model: dict[str, Any], what: Any, right: Any, tolerance: float, why: str) -> Case:
    def asked(model: Model, door: Door) -> Floats:
        return np.array(what(answered(model, door)))

    return Case(model, asked, lambda model, _: np.array(right(model)), tolerance, why, _KNOBS)


_LINES = "the program's frequency lines; a resonance in between misses 0.2 % at most"
_EULER: Final = 0.5772156649


def _numbers(answer: Any, name: str, *keys: str) -> list[float]:
    return [answer["vibration"][name]["answers"][f"Q.z {what}"][key] for what in _MOTIONS for key in keys]


def _relative(right: list[float], found: list[float]) -> list[float]:
    return [got / size for got, size in zip(found, right, strict=True)]


def _compared(rng: np.random.Generator, name: str, key: str, right: Any, tolerance: float, why: str) -> Case:
    """Each motion's number over its right value: 1."""
    model = _driven(rng)

    def asked(model: Model, door: Door) -> Floats:
        found = _numbers(answered(model, door), name, key)
        return np.array(_relative([right(model, what) for what in _MOTIONS], found))

    return Case(model, asked, lambda *_: np.ones(len(_MOTIONS)), tolerance, why, _KNOBS)


@capability("vibration: rms under a random force", "independent")
def _(rng: np.random.Generator) -> Case:
    return _compared(rng, "noise", "rms", lambda model, what: sqrt(_moments(model, what)[0]), 2e-3, _LINES)


@capability("vibration: zero upcrossings under a random force", "independent")
def _(rng: np.random.Generator) -> Case:
    def right(model: Model, what: str) -> float:
        m = _moments(model, what)
        return sqrt(m[2] / m[0])

    return _compared(rng, "noise", "zero_upcrossings_hz", right, 2e-3, _LINES)


@capability("vibration: expected peak under a random force", "independent")
def _(rng: np.random.Generator) -> Case:
    def right(model: Model, what: str) -> float:  # Davenport 1964
        m = _moments(model, what)
        g = sqrt(2 * log(sqrt(m[2] / m[0]) * model["study"]["vibration"]["noise"]["duration"]))
        return sqrt(m[0]) * (g + _EULER / g)

    return _compared(rng, "noise", "expected_peak", right, 3e-3, _LINES)


@capability("vibration: largest answer to a harmonic force", "independent")
def _(rng: np.random.Generator) -> Case:
    def right(model: Model, what: str) -> float:
        structure, line = model["structure"]["structure"], model["line"]
        low, high = line[0][0], line[-1][0]
        peaks = zip(structure["frequency"], structure["ratio"], strict=True)
        near = [f * (1 + z * np.linspace(-8, 8, 2001)) for f, z in peaks]
        f = np.clip(np.concatenate([np.geomspace(low, high, 20000), *near]), low, high)
        return float((_answer(model, what)(f) * vb.log_log([(a, b) for a, b in line])(f)).max())

    return _compared(rng, "hum", "largest", right, 2e-3, _LINES)


@capability("vibration: Dirlik's damage under a random force", "independent")
def _(rng: np.random.Generator) -> Case:
    model = _driven(rng)
    slope = between(rng, 2, 8)
    line = {"range": between(rng, 0.1, 10), "slope": slope, "at": between(rng, 1e4, 1e7)}
    model["study"]["fatigue"] = {"f": {"of": "Q.z acceleration", "under": "noise", "sn": line}}

    def right(model: Model) -> float:
        sn, noise = model["study"]["fatigue"]["f"]["sn"], model["study"]["vibration"]["noise"]
        return vb.dirlik(_moments(model, "acceleration"), sn["slope"], sn["range"], sn["at"], noise["duration"])

    why = "lines of the program miss a moment by 0.2 %, which counts slope times; and 1 % for tables of ranges"
    tolerance = 0.01 + 2e-3 * slope  # the reason is why
    return _case(model, lambda answer: [answer["fatigue"]["f"]["damage"]], lambda model: [right(model)], tolerance, why)


def _shaken(rng: np.random.Generator) -> dict[str, Any]:
    """An oscillator on a shaken base."""
    structure = oscillator(rng)
    structure["damping"]["ratio"] = between(rng, 0.003, 0.2)
    f = modes_of(structure)[0][0] / 2 / pi
    band = [rounded(f * rng.uniform(0.1, 0.9)), rounded(f * rng.uniform(1.2, 8))]
    size, hum = between(rng, 0.001, 0.1), between(rng, 0.01, 2)
    vibration = {
        "n": {"base": "z", "psd": f"{size!r} g^2/Hz", "band": band, "duration": between(rng, 10, 1000)},
        "h": {"base": "z", "harmonic": f"{hum!r} g", "band": band},
    }
    if rng.random() < 0.5:  # the band begins on the slope of its resonance
        band[0] = rounded(f * rng.uniform(0.9, 1.1))
    study = {"modes": {"count": 1}, "record": {"m.z": ["acceleration", "displacement"]}, "vibration": vibration}
    return {"study": study, "structure": structure}


@capability("vibration: an oscillator on a shaken base", "independent")
def _(rng: np.random.Generator) -> Case:
    def asked(answer: Any) -> list[float]:
        return [answer["vibration"]["n"]["answers"]["m.z acceleration"]["rms"] / vb.G]

    def right(model: Model) -> list[float]:
        (omega,), (ratio,), _ = modes_of(model["structure"])
        noise = model["study"]["vibration"]["n"]
        size, (low, high) = float(noise["psd"].split()[0]), noise["band"]
        m = vb.moments(
            lambda f: np.abs(vb.transmitted(omega, ratio, 2 * pi * f)) ** 2 * size, low, high, [omega / 2 / pi]
        )
        return [sqrt(m[0])]

    return _case(_shaken(rng), asked, right, 2e-3, _LINES)


@capability("vibration: largest acceleration on a harmonic base", "independent")
def _(rng: np.random.Generator) -> Case:
    def right(model: Model) -> list[float]:
        (omega,), (ratio,), _ = modes_of(model["structure"])
        hum = model["study"]["vibration"]["h"]
        f = np.linspace(*hum["band"], 200_001)
        return [
            float(np.abs(vb.transmitted(omega, ratio, 2 * pi * f)).max()) * float(hum["harmonic"].split()[0]) * vb.G
        ]

    def asked(answer: Any) -> list[float]:
        return [answer["vibration"]["h"]["answers"]["m.z acceleration"]["largest"]]

    return _case(_shaken(rng), asked, right, 2e-3, _LINES)
