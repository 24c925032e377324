"""Levels of a tapping machine on a piston over a box, by one blow in events; what a covering takes off; its rating."""

from __future__ import annotations

from math import log10, pi, sqrt
from typing import Any, Final

import numpy as np

from tests.independent import contact_events as ev
from tests.independent import levels
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.impacts import G
from tests.machine.laws import between, rounded
from tests.machine.pistons import box_of, piston_of
from tests.machine.rated import answer_of, mean_of, struck
from tests.machine.rooms import even

_COMPARED: Final = levels.THIRDS[:9]  # to 630 Hz
_STEP: Final = 0.25  # Hz, of a decay of 6 Hz and more
_WHY = "0.03 dB: digital filters beside Butterworth's; what of a blow is still there at the next"


def tapped(rng: np.random.Generator) -> dict[str, Any]:
    """A tapping machine on the piston of `struck`, with a covering in half of the draws."""
    model = struck(rng)
    study, structure = model["study"], model["structure"]
    part, room = structure["parts"]["p"], study["rooms"]["room"]
    structure["points"]["h"] = {
        "on": "p", "at": [[rounded(part["size"][0] / 2 + 0.1 * (n - 2)), part["size"][1] / 2] for n in range(5)],
    }  # fmt: skip
    stiffness = rounded(0.5 * (pi / between(rng, 5e-4, 1.5e-3)) ** 2)
    law = {"type": "linear", "stiffness": stiffness}  # a dashpot's force begins with a jump, which samples fold
    taps: dict[str, Any] = {"source": "tapping machine", "above": "h", "contact": law}
    if rng.random() < 0.7:
        taps["covering"] = {"reduction": {f"{band} Hz": even(rng, 3, 30) for band in levels.THIRDS}}
    study["bodies"] = {"taps": taps}
    room["levels"], room["receivers"]["two"] = ["ISO 16283-2", "ISO 717-2"], [even(rng, 0, one) for one in room["size"]]
    room["receivers"]["two"][2] = rounded(0.6 * room["receivers"]["two"][2])
    study["modes"] = {"up_to": 4000.0}
    study["time"] = {"duration": 2.0, "sampling": 7600.0}
    return model


def levels_of(model: Model) -> Floats:
    """Third octaves of ten blows a second whose energies add, at both microphones, as they are in the room."""
    study, structure = model["study"], model["structure"]
    piston, room = piston_of(structure), study["rooms"]["room"]
    law = study["bodies"]["taps"]["contact"]
    touch = ev.Touch("hit", "hammer", "q", ev.linear(law["stiffness"]))
    chain = ev.Chain(
        [2 * pi * piston.hz], [piston.loss / 2], {"q": [1 / sqrt(piston.mass)]}, {"hammer": 0.5}, [touch],
        start={"hammer": -sqrt(2 * G * 0.04)},
    )  # fmt: skip
    rate, seconds = 40960.0, 0.5
    path = ev.run(chain, seconds, 1e-10, 1e-3)
    v = path.speed("q", np.arange(int(rate * seconds)) / rate)
    f = _STEP * np.arange(int(1200 / _STEP))[1:]
    spectrum = np.fft.rfft(v, int(rate / _STEP))[1 : len(f) + 1] / rate
    found = []
    for name in ("mic", "two"):
        p = spectrum * box_of(room, structure, 30).per_velocity(2j * pi * f, room["receivers"][name])
        row = []
        for band in _COMPARED:
            at = levels.exact(band)
            low, high = at / 10**0.05, at * 10**0.05
            passed = 1 / (1 + ((f * f - low * high) / (f * (high - low))) ** 8)
            row.append(10 * log10(10 * 2 * _STEP * float((np.abs(p) ** 2 * passed).sum()) / levels.P0**2))
        found.append(row)
    return np.array(found)


def _covered(model: Model) -> Floats:
    """What the covering takes off."""
    covering = model["study"]["bodies"]["taps"].get("covering", {"reduction": {}})
    return np.array([covering["reduction"].get(f"{band} Hz", 0.0) for band in levels.THIRDS])


def _standardised(model: Model) -> float:
    return -10 * log10(model["study"]["rooms"]["room"]["losses"]["t60"] / 0.5)


@capability("levels: a tapping machine on a piston, bare or covered", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    def asked(model: Model, door: Door) -> Floats:
        rated = answer_of(model, door)["rated"]["room"]["bands_db"]
        return np.array([rated[f"{band:g}"] for band in _COMPARED])

    def right(model: Model, _: Door) -> Floats:
        return mean_of(levels_of(model)) - _covered(model)[: len(_COMPARED)] + _standardised(model)

    return Case(tapped(rng), asked, right, 5e-4, _WHY)


@capability("levels: rating of a tapping machine by its own bands", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    def asked(model: Model, door: Door) -> Floats:
        found = answer_of(model, door)["rated"]["room"]["numbers"]
        return np.array([found[one][key] for one in ("L'_nT,w", "L_i,w") for key in ("value_db", "C_I")])

    def right(model: Model, door: Door) -> Floats:
        bands = np.array(list(answer_of(model, door)["rated"]["room"]["bands_db"].values()))
        both = [levels.impact_rating((bands - more).tolist()) for more in (0.0, _standardised(model))]
        return np.array(both, float).ravel()

    return Case(tapped(rng), asked, right, 1e-6, "whole decibels")
