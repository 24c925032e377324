"""Levels of a piston that a ball strikes over a box, from events, Laplace's integral and filters of scipy; ratings."""

from __future__ import annotations

import copy
from math import log10, pi, sqrt
from typing import Any, Final

import numpy as np
from scipy.optimize import minimize_scalar

from tests.independent import contact_events as ev
from tests.independent import levels
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.heard import band_passed, fast_level
from tests.machine.impacts import G
from tests.machine.laws import between, rounded
from tests.machine.pistons import box_of, piston_of, piston_structure
from tests.machine.rooms import even

_RATE: Final = 25600.0  # Hz
_HIGHEST: Final = 2000.0  # Hz, towards which the transform fades; beyond it the blow has nothing that is heard
_THIRDS: Final = (50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630)
_WHY = "0.03 dB: the blow beyond 1 kHz, where modes end; the fade of a record, samples of a band and of a path"


def struck(rng: np.random.Generator) -> dict[str, Any]:
    """A ball on a stiff plate that is a piston over a room, quiet again within the record."""
    structure = piston_structure(rng, even(rng, 40, 90))
    structure["damping"] = {"ratio": even(rng, 0.04, 0.08)}
    a, b = structure["parts"]["p"]["size"]
    size = [even(rng, a + 0.5, 4.0), even(rng, b + 0.5, 4.0), even(rng, 1.8, 3.0)]
    mass = rounded(piston_of(structure).mass * float(rng.uniform(0.005, 0.02)))
    room = {
        "size": size, "at": [even(rng, a / 2, size[0] - a / 2), even(rng, b / 2, size[1] - b / 2)], "under": "low",
        "losses": {"t60": even(rng, 0.2, 0.35)}, "air": {"c": even(rng, 330, 350), "rho": even(rng, 1.1, 1.3)},
        "receivers": {"mic": [even(rng, 0, size[0]), even(rng, 0, size[1]), even(rng, 0, 0.7 * size[2])]},
        "levels": ["ISO 16283-2" if rng.random() < 0.7 else "ISO 717-2"], "ensemble": 0,
    }  # fmt: skip
    stiffness = rounded(mass * (pi / between(rng, 2.5e-3, 3e-3)) ** 2)
    law = {"type": "linear", "stiffness": stiffness, "damping": rounded(0.1 * sqrt(stiffness * mass))}
    ball = {"mass": mass, "drop_height": even(rng, 0.05, 0.3), "above": "q", "contact": law}
    study = {
        "modes": {"up_to": 1000.0}, "rooms": {"room": room}, "bodies": {"ball": ball},
        "time": {"duration": 1.5, "sampling": _RATE},
    }  # fmt: skip
    return {"study": study, "structure": structure}


def heard(model: Model) -> Floats:
    """Pressure at the microphone: the velocity of events through the box, transformed along a line that is damped to
    1e-6 at the end of twice the record."""
    study, structure = model["study"], model["structure"]
    piston, room = piston_of(structure), study["rooms"]["room"]
    ball, count = study["bodies"]["ball"], int(study["time"]["duration"] * _RATE)
    law = ev.linear(ball["contact"]["stiffness"], ball["contact"]["damping"])
    touch = ev.Touch("hit", "ball", "q", law)
    chain = ev.Chain(
        [2 * pi * piston.hz], [piston.loss / 2], {"q": [1 / sqrt(piston.mass)]}, {"ball": ball["mass"]}, [touch],
        start={"ball": -sqrt(2 * G * ball["drop_height"])},
    )  # fmt: skip
    path = ev.run(chain, count / _RATE, 1e-10, 1e-3)
    t = np.arange(count) / _RATE
    n, less = 2 * count, np.log(1e6) * _RATE / (2 * count)
    s = less + 2j * pi * np.fft.rfftfreq(n, 1 / _RATE)
    some = s.imag < 2 * pi * _HIGHEST
    spectrum = np.fft.rfft(-path.speed("q", t) * np.exp(-less * t), n)
    spectrum[some] *= box_of(room, structure, 24).per_velocity(s[some], room["receivers"]["mic"])
    spectrum *= (1 + np.cos(pi * np.clip(2.5 * s.imag / (2 * pi * _HIGHEST) - 1.5, 0, 1))) / 2
    return np.asarray(np.fft.irfft(spectrum, n)[:count] * np.exp(less * t))


def fast_gain(t60: float) -> float:
    """Largest Fast mean square of a decay over its first value, by search: T60 / 1.7275 s is its time over Fast's."""
    c = t60 / 1.7275
    late = minimize_scalar(lambda x: -(np.exp(-x / c) - np.exp(-x)) / (1 - 1 / c), method="bounded",
                           bounds=(1e-3, 10.0), options={"xatol": 1e-10})  # fmt: skip
    return float(-late.fun)


def standardised_by(room: Model) -> float:
    """What standardising to 50 m^3 and 0.5 s adds to largest Fast levels [dB]."""
    return 10 * log10(float(np.prod(room["size"])) / 50 * fast_gain(0.5) / fast_gain(room["losses"]["t60"]))


def answer_of(model: Model, door: Door) -> dict[str, Any]:
    found = door.ask({"model": "s.yaml", **model["study"]}, "run", "--no-pictures", s=model["structure"])
    door.told = []  # of the sound, whatever it is
    case: dict[str, Any] = found["cases"]["as given"]
    return case


@capability("levels: of a piston over a box", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Peak, A-weighted Fast, Slow and exposure; largest Fast levels of third octaves as the standard states them."""

    def asked(model: Model, door: Door) -> Floats:
        case = answer_of(model, door)
        found, rated = case["levels"]["room.mic"], case["rated"]["room"]["bands_db"]
        once = [found[f"l_{one}_db"] for one in ("peak", "afmax", "asmax", "ae")]
        return np.array([*once, *(rated[f"{band:g}"] for band in _THIRDS[:9])])

    def right(model: Model, _: Door) -> Floats:
        p, room = heard(model), model["study"]["rooms"]["room"]
        weighted = levels.passed(p, _RATE, levels.a_filter)
        once = 10 * log10(float((weighted**2).sum()) / _RATE / levels.P0**2)
        peak = 20 * log10(np.abs(p).max() / levels.P0)
        single = [peak, *(fast_level(weighted**2, _RATE, one) for one in (0.125, 1.0)), once]
        more = standardised_by(room)
        standardised = more if room["levels"] == ["ISO 16283-2"] else 0.0
        bands = [fast_level(band_passed(p, band, 3) ** 2, _RATE, 0.125) + standardised for band in _THIRDS[:9]]
        return np.array([*single, *bands])

    return Case(struck(rng), asked, right, 3e-4, _WHY)


# ---- ratings

A_OF_THIRDS: Final = (-30.3, -26.2, -22.4, -19.1, -16.2, -13.2, -10.8, -8.7, -6.6, -4.8, -3.2, -1.9)  # ISO 717-2 D.3
OCTAVES: Final = (63, 125, 250, 500)
_INTERVAL: Final = ("low", "mean", "high")
GRADE_50: Final = (73.0, 63.0, 56.0, 50.0)  # JIS A 1419-2; KS F 2863-2 has the same curve, 10 dB higher


def mean_of(places: Floats) -> Floats:
    return np.asarray(10 * np.log10(np.mean(10 ** (places / 10), axis=0)))


def _tenths(x: Floats) -> Floats:
    return np.asarray(np.floor(10 * x + 0.5 + 1e-9) / 10)


def _ball(places: Floats) -> list[float]:
    """L_iA,Fmax: unrounded, and to an integer."""
    whole = levels.total((mean_of(places) + A_OF_THIRDS).tolist())
    return [whole, float(np.floor(whole + 0.5))]


def _grade(places: Floats) -> list[float]:
    """By JIS: the finest, the L number, the grade: the lowest curve in steps of 5 that is exceeded by 2 dB at most."""
    read = _tenths(mean_of(places))
    number = float((np.floor(read + 0.5) - GRADE_50).max()) + 50
    grade = next(one for one in range(-100, 300, 5) if number - one <= 2)
    return [float((read - GRADE_50).max()) + 50, number, float(grade)]


def _inverse_a(places: Floats) -> list[float]:
    """By KS: the curve, moved in steps of 0.1 and 1 dB, that is exceeded by 8 dB at most."""
    read, found = _tenths(mean_of(places)), []
    for steps in (10, 1):
        at = next(n for n in range(-100 * steps, 200 * steps)
                  if np.maximum(read - GRADE_50 - 10.0 - n / steps, 0).sum() <= 8.0 + 1e-6)  # fmt: skip
        found.append(60.0 + at / steps)
    return found


def _spread(of: Any, places: Floats) -> float:
    """Of the finest number at each microphone."""
    return float(np.std([of(one[None])[0] for one in places], ddof=1))


def _sourced(rng: np.random.Generator, source: str) -> dict[str, Any]:
    model = struck(rng)
    study = model["study"]
    room = study["rooms"]["room"]
    study["bodies"]["ball"] = {"source": source, "above": "q"}
    room["levels"] = ["ISO 16283-2", "ISO 717-2"] if source == "rubber ball" else ["JIS A 1419-2", "KS F 2863-2"]
    room["receivers"]["two"] = [even(rng, 0, size) for size in room["size"]]
    del room["ensemble"]
    return model


def _rated(model: Model, door: Door) -> tuple[dict[str, Any], Floats]:
    """What is rated, and the levels of its bands at both microphones."""
    case = answer_of(model, door)
    rated: dict[str, Any] = case["rated"]["room"]
    key = "bands_db" if rated["bands"] == "third octave" else "octaves_db"
    rows = [[case["levels"][f"room.{one}"][key][band] for band in rated["bands_db"]] for one in ("mic", "two")]
    return rated, np.array(rows)


def _between(some: list[dict[str, Any]]) -> list[float]:
    """That means are in the middle of their intervals, of bands and numbers that have them: differences, and 1."""
    found = []
    for one in some:
        low, mean, high = (np.nan if one[f"{name}_db"] is None else one[f"{name}_db"] for name in _INTERVAL)
        found += [(low + high) / 2 - mean, float(low < mean < high)]
    return found


def _intervals(rated: dict[str, Any], symbols: tuple[str, ...]) -> list[float]:
    low = list(rated["bands_db"])[:2]
    bands = [{f"{name}_db": rated[f"{name}_db"][band] for name in _INTERVAL} for band in low]
    return _between([*bands, *(rated["numbers"][one] for one in symbols)])


@capability("levels: rating of a rubber ball by its own bands", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    symbols = ("L'_iA,Fmax,V,T", "L_iA,Fmax")

    def asked(model: Model, door: Door) -> Floats:
        rated, _ = _rated(model, door)
        told = [rated["numbers"][one][key] for one in symbols for key in ("unrounded_db", "value_db")]
        spreads = [rated["numbers"][one]["receivers_spread_db"] for one in symbols]
        rows = [*rated["bands_db"].values(), *rated["spread_db"].values()]
        return np.array([*rows, *told, *spreads, *_intervals(rated, symbols)])

    def right(model: Model, door: Door) -> Floats:
        _, places = _rated(model, door)
        room = model["study"]["rooms"]["room"]
        more = standardised_by(room)
        rows = [*(mean_of(places) + more), *np.std(places, axis=0, ddof=1)]
        numbers = [*_ball(places + more), *_ball(places)]
        return np.array([*rows, *numbers, *[_spread(_ball, places)] * 2, *[0.0, 1.0] * 4])

    return Case(_sourced(rng, "rubber ball"), asked, right, 1e-6, "tables of ISO 717-2 and sums; a search of a maximum")


@capability("levels: rating of a bang machine by its own bands", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    symbols = ("L_i,Fmax,r,H(1)", "L_i,Fmax,AW")

    def asked(model: Model, door: Door) -> Floats:
        rated, _ = _rated(model, door)
        grade, inverse = (rated["numbers"][one] for one in symbols)
        told = [grade["unrounded_db"], grade["L number"], grade["value_db"]]
        told += [inverse["unrounded_db"], inverse["value_db"]]
        rows = [*rated["bands_db"].values(), *rated["spread_db"].values()]
        return np.array([*rows, *told, grade["receivers_spread_db"], inverse["receivers_spread_db"],
                         *_intervals(rated, symbols)])  # fmt: skip

    def right(model: Model, door: Door) -> Floats:
        _, places = _rated(model, door)
        rows = [*mean_of(places), *np.std(places, axis=0, ddof=1)]
        spreads = [_spread(_grade, places), _spread(_inverse_a, places)]
        return np.array([*rows, *_grade(places), *_inverse_a(places), *spreads, *[0.0, 1.0] * 4])

    return Case(_sourced(rng, "bang machine"), asked, right, 1e-6, "curves of JIS A 1419-2 and KS F 2863-2; rounding")


@capability("sweeps: levels of a piston over a box", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Balls of several masses, by full runs or by the engine of many impacts at once, in one process or in two."""
    model = struck(rng)
    for key in ("levels", "ensemble"):
        del model["study"]["rooms"]["room"][key]
    mass = model["study"]["bodies"]["ball"]["mass"]
    model["masses"] = [rounded(mass * float(rng.uniform(*one))) for one in ((0.6, 0.9), (1.1, 1.6))]
    keys = ("l_afmax_db", "l_asmax_db", "l_ae_db")
    names = [f"levels / room.mic / {key}" for key in keys] if rng.random() < 0.6 else ["room.mic L_AFmax"]
    workers = str(rng.choice(["1", "2"]))

    def asked(model: Model, door: Door) -> Floats:
        masses = ",".join(map(repr, model["masses"]))
        words = ["--vary", f"bodies.ball.mass={masses}", "--workers", workers, "--no-pictures"]
        words += [word for name in names for word in ("--only", name)] * (len(names) > 1)
        found = door.ask({"model": "s.yaml", **model["study"]}, "sweep", *words, s=model["structure"])
        door.told = []  # of a stiff plate
        return np.array([[row["cases"]["as given"]["numbers"][name] for name in names] for row in found["samples"]])

    def right(model: Model, _: Door) -> Floats:
        rows = []
        for one in model["masses"]:
            other: Any = copy.deepcopy({key: model[key] for key in ("study", "structure")})
            other["study"]["bodies"]["ball"]["mass"] = one
            p = levels.passed(heard(other), _RATE, levels.a_filter) ** 2
            once = 10 * log10(float(p.sum()) / _RATE / levels.P0**2)
            rows.append([fast_level(p, _RATE, 0.125), fast_level(p, _RATE, 1.0), once][: len(names)])
        return np.array(rows)

    return Case(model, asked, right, 3e-4, _WHY)
