"""Levels of a blow's sound, against the same sound through filters of scipy and the texts of the standards."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from scipy.signal import butter, lfilter, sosfilt

from tests.independent import levels
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.rooms import between, even, plate_of, room, rounded
from tests.machine.rooms import plate_structure as structure_of

_RATE: Final = 25600.0  # Hz
_WHY = "0.05 dB and less: the program fades the end of a record and keeps some samples of a band; filters of scipy"
_ASIDE = ("coarse-mesh", "band-not-settled", "one-way-resonance", "structure-not-decayed", "sound-not-decayed", "level")


def struck(rng: np.random.Generator) -> dict[str, Any]:
    """A ball on a thin plate over a small room that is quiet again within the record."""
    first = 0.0
    while first < 40.0:  # quieter by 90 dB and more at the end
        structure = structure_of(rng)
        first = plate_of(structure)[0].modes(1e5)[0][0]
    structure["damping"] = {"ratio": even(rng, 0.04, 0.08)}
    box = room(rng, structure, 1)
    box["losses"] = {"t60": even(rng, 0.2, 0.4)}
    mass = structure["materials"]["m"]["rho"] * structure["parts"]["p"]["thickness"] * 0.02
    study = {
        "modes": {"up_to": rounded(max(15 * first, 200.0))},
        "rooms": {"room": box},
        "bodies": {"ball": {"mass": rounded(mass), "drop_height": 0.1, "above": "q",
                            "contact": {"type": "hertz", "stiffness": between(rng, 1e5, 1e7)}}},
        "time": {"duration": 1.2, "sampling": _RATE},
    }  # fmt: skip
    return {"study": study, "structure": structure}


def _answers(model: Model, door: Door) -> dict[str, Any]:
    found = door.ask({"model": "s.yaml", **model["study"]}, "run", "--no-pictures", s=model["structure"])
    door.told = []  # of the sound, whatever it is
    case: dict[str, Any] = found["cases"]["as given"]
    return case


def _pressure(model: Model, door: Door) -> Floats:
    found = door.histories({"model": "s.yaml", **model["study"]}, s=model["structure"])
    return np.asarray(found["room.mic pressure"])


def fast_level(square: Floats, rate: float, seconds: float) -> float:
    keep = np.exp(-1 / rate / seconds)
    return float(10 * np.log10(lfilter([1 - keep], [1, -keep], square).max() / levels.P0**2))


@capability("levels: single numbers of its own sound", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Peaks, A-weighted Fast, Slow, Impulse (35 ms, then held) and exposure."""

    def asked(model: Model, door: Door) -> Floats:
        found = _answers(model, door)["levels"]["room.mic"]
        return np.array([found[f"l_{one}_db"] for one in ("peak", "cpeak", "afmax", "asmax", "aimax", "ae", "aeq")])

    def right(model: Model, door: Door) -> Floats:
        p = _pressure(model, door)
        heard = levels.passed(p, _RATE, levels.a_filter)[: len(p)]
        energy = float((heard**2).sum()) / _RATE
        once = 10 * np.log10(energy / levels.P0**2)
        mean = 10 * np.log10(model["study"]["time"]["duration"])
        peak = 20 * np.log10(np.abs(p).max() / levels.P0)
        flat = 20 * np.log10(np.abs(levels.passed(p, _RATE, levels.c_filter)).max() / levels.P0)
        return np.array(
            [peak, flat, *(fast_level(heard**2, _RATE, one) for one in (0.125, 1.0, 0.035)), once, once - mean]
        )

    return Case(struck(rng), asked, right, 1e-5, "the same sound through the same filters: rounding", each=True)


def band_passed(p: Floats, nominal: float, fraction: int) -> Floats:
    edge = 10 ** (0.15 / fraction)
    at = levels.exact(nominal)
    sos = butter(4, [at / edge, at * edge], "bandpass", fs=_RATE, output="sos")
    return np.asarray(sosfilt(sos, np.r_[p, np.zeros(int(_RATE))]))


@capability("levels: bands of its own sound", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Largest Fast level in third octaves and octaves, exposure in third octaves; blank where the modes end."""

    def asked(model: Model, door: Door) -> Floats:
        found = _answers(model, door)["levels"]["room.mic"]
        end = found["complete_below_hz"]
        rows = (("bands_db", _THIRDS), ("octaves_db", _OCTAVES), ("exposure_db", _THIRDS))
        beyond = [found[key][f"{band:g}"] for key, bands in rows for band in bands if band > 1.13 * end]
        if any(one is not None for one in beyond):
            return np.array([np.nan])
        return np.array([found[key][f"{band:g}"] for key, bands in rows for band in _inside(model, bands)])

    def right(model: Model, door: Door) -> Floats:
        p = _pressure(model, door)
        thirds = {band: band_passed(p, band, 3) for band in _inside(model, _THIRDS)}
        octaves = {band: band_passed(p, band, 1) for band in _inside(model, _OCTAVES)}
        fast = [fast_level(one**2, _RATE, 0.125) for one in (*thirds.values(), *octaves.values())]
        once = [10 * np.log10(float((one**2).sum()) / _RATE / levels.P0**2) for one in thirds.values()]
        return np.array([*fast, *once])

    return Case(struck(rng), asked, right, 1.5e-3, _WHY, each=True)


_THIRDS: Final = (25, 31.5, 40, 50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000)
_OCTAVES: Final = (31.5, 63, 125, 250, 500, 1000, 2000)


def _inside(model: Model, bands: tuple[float, ...]) -> list[float]:
    """Well below where the modes end, and where there is sound enough."""
    end = model["study"]["modes"]["up_to"]
    first = plate_of(model["structure"])[0].modes(1e5)[0][0]
    return [band for band in bands if 0.5 * first < band < end / (2.5 if bands is _OCTAVES else 1.6)]
