"""Sound energy that a struck piston or plate sends into the open in a record: levels, efficiencies, by third octaves.

A case's model has a "study" and its "structure"; `sent_of` reads both again, by itself.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from tests.independent import sound_energies as sound
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.pistons import piston_of, piston_structure
from tests.machine.rated import answer_of
from tests.machine.rooms import even, plate_of, plate_structure, rounded

Draft = dict[str, Any]
_THIRDS: Final = (25, 31.5, 40, 50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000)
BEYOND: Final = 3.0  # times the modes of the program: those of the reference, at rest there
_STIFF = "0.01 dB: 20 x 20 cells, lines of a record of 4 s that are 0.25 Hz wide in bands of 5.8 Hz and more"
_BENT = "0.04 dB: 18 x 18 cells, modes that end where A weighting is largest; lines as wide"


def _pushed(rng: np.random.Generator, structure: Draft, first: float, up_to: float, seconds: float) -> Draft:
    """A half sine on the middle or another place of a plate beside open air."""
    hz = rounded(first * float(rng.uniform(0.7, 2.5)))
    structure["surfaces"] = {"low": {"on": "p", "side": "below"}, "up": {"on": "p", "side": "above"}}
    beside = {"above": "up"} if rng.random() < 0.5 else {"below": "low"}
    air = {"c": even(rng, 320, 360), "rho": even(rng, 1.0, 1.4)}
    study: Draft = {
        "modes": {"up_to": rounded(up_to)}, "rooms": {"room": {**beside, "air": air}},
        "loads": {"push": {"at": "q.z", "half_sine": {"amplitude": even(rng, 10, 200), "frequency": hz}}},
        "time": {"duration": rounded(seconds), "sampling": rounded(8 * up_to)},
    }  # fmt: skip
    return {"study": study, "structure": structure}


def _on_spring(rng: np.random.Generator) -> Draft:
    """A piston of which all, or a rectangle, is beside the air."""
    own = even(rng, 40, 90)
    structure = piston_structure(rng, own)
    structure["damping"], structure["parts"]["p"]["mesh"] = {"ratio": even(rng, 0.03, 0.08)}, [20, 20]
    model = _pushed(rng, structure, own, 6 * own, even(rng, 4, 6))
    if rng.random() < 0.4:
        a, b = structure["parts"]["p"]["size"]
        region = {"rectangle": [rounded(0.05 * int(rng.integers(6, 10)) * 2 * one) for one in (a, b)]}
        for one in structure["surfaces"].values():
            one["region"] = region
    return model


def _bending(rng: np.random.Generator) -> Draft:
    """A simply supported plate whose first mode is heard."""
    while True:
        structure = plate_structure(rng)
        first = plate_of(structure)[0].modes(1e4)[0][0]
        if 20 < first < 80:
            structure["damping"] = {"ratio": even(rng, 0.02, 0.06)}
            return _pushed(rng, structure, first, 10 * first, even(rng, 4, 6))


def sent_of(model: Model) -> sound.Sent:
    study, structure = model["study"], model["structure"]
    push, air = study["loads"]["push"]["half_sine"], study["rooms"]["room"]["air"]
    told, end = (push["amplitude"], push["frequency"]), study["modes"]["up_to"]
    if "k" in structure["parts"]:
        piston, part = piston_of(structure), structure["parts"]["p"]
        sides = structure["surfaces"]["low"].get("region", {"rectangle": part["size"]})["rectangle"]
        return sound.of_piston(piston, tuple(sides), told, air, _lines(end, piston.loss * piston.hz))
    plate, loss, _ = plate_of(structure)
    f = _lines(end, loss * plate.modes(end)[0][0])
    return sound.of_plate(plate, structure["points"]["q"]["at"], loss, told, air, f, BEYOND * end)


def _lines(end: float, width: float) -> Floats:
    """From nearly 0 to a frequency, sixteen in the width of a resonance."""
    f = np.linspace(0, end, int(16 * end / width) + 1)
    f[0] = 1e-6 * f[1]
    return f


def _thirds(model: Model, share: float) -> list[float]:
    """Third octaves below a share of where modes end."""
    return [one for one in _THIRDS if 10**0.05 * one < share * model["study"]["modes"]["up_to"]]


def _case(model: Model, share: float, tolerance: float, why: str) -> Case:
    """Numbers of the record and its third octaves in decibels, efficiencies as ten times their logarithm."""

    def asked(model: Model, door: Door) -> Floats:
        found = answer_of(model, door)["sound_energy"]["room"]
        bands = [f"{one:g}" for one in _thirds(model, share)]
        ratios = [found["efficiency"], found["share_of_given"], *(found["bands_efficiency"][one] for one in bands)]
        return np.array([found["l_j_db"], found["l_ja_db"], *(found["bands_db"][one] for one in bands),
                         *(10 * np.log10(ratios))])  # fmt: skip

    def right(model: Model, _: Door) -> Floats:
        sent, bands = sent_of(model), _thirds(model, share)
        whole, levels = sent.numbers(model["study"]["modes"]["up_to"]), sent.bands(bands)
        return np.array([*whole[:2], *levels[: len(bands)], *whole[2:], *levels[len(bands) :]])

    return Case(model, asked, right, tolerance, why)


@capability("sound energy: a piston that is pushed in the open", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case(_on_spring(rng), 0.9, 2e-4, _STIFF)


@capability("sound energy: a plate that is pushed in the open", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case(_bending(rng), 0.5, 6e-4, _BENT)
