"""What a floor takes of the force of a mass that strikes it: how light it is against hammers and feet."""

from __future__ import annotations

from collections.abc import Sequence
from math import log10, pi
from typing import Final, NamedTuple

import numpy as np

from acoustics.levels.bands import band_edges, third_octave_bands
from acoustics.levels.ending import shown
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import frf
from femstruct.model.probe import Probe

LINES: Final = 12  # in a third octave
_ALL_HZ: Final = 1e6


class Taken(NamedTuple):
    """The third octave in which a floor takes most of a force [Hz], how much of it [dB], and mobilities there of the
    floor (rms over places and lines) and of the mass [m/(N s)]."""

    band_hz: float
    taken_db: float
    floor: float
    own: float


def taken_force(
    basis: ModalBasis, places: Sequence[Probe], mass: float, band: tuple[float, float], beyond: bool = False
) -> Taken | None:
    """What a floor takes of the force of a mass [kg] at places, in third octaves from one nominal centre to another
    [Hz]; None where modes end below them.

    beyond : whether to go on above the modes, with a mobility that is real and that of the last octave with modes, as
    of plates: a light floor would else be heavy for want of modes.

    Notes
    -----
    A mass strikes as a source of the mobility 1 / (j omega m) does: on a floor of the mobility Y its force is
    1 / |1 + j omega m Y| of that on a rigid one.
    """
    centres = third_octave_bands(_ALL_HZ, lowest_hz=10.0).items()
    wanted = {nominal: centre for nominal, centre in centres if band[0] <= nominal <= band[1]}
    end = basis.complete_below_hz or np.inf
    known = [nominal for nominal, centre in wanted.items() if shown(centre, end, 3)]
    if not known:
        return None
    lines = np.array([np.geomspace(*band_edges(wanted[nominal]), LINES) for nominal in known])
    found = np.array([frf(basis, probe, probe, lines.ravel(), "mobility") for probe in places]).reshape(
        -1, *lines.shape
    )
    felt = np.mean(np.abs(1.0 + 2j * pi * lines * mass * found) ** 2, axis=(0, 2))
    size = np.sqrt(np.mean(np.abs(found) ** 2, axis=(0, 2)))
    taken = {one: (10.0 * log10(a), b) for one, a, b in zip(known, felt.tolist(), size.tolist(), strict=True)}
    real = float(found.real[:, -3:].mean())
    for nominal in wanted.keys() - taken.keys() if beyond else ():
        taken[nominal] = (10.0 * log10(1.0 + (2 * pi * wanted[nominal] * mass * real) ** 2), real)
    worst = max(sorted(taken), key=lambda nominal: taken[nominal][0])
    return Taken(worst, *taken[worst], 1.0 / (2 * pi * wanted[worst] * mass))
