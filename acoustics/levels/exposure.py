"""Impact force exposure levels: how hard a standard source strikes, octave by octave."""

from __future__ import annotations

from typing import Final

import numpy as np

from acoustics.arrays import Floats, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.levels.decibels import decibel
from acoustics.levels.filters import band_passes

EXPOSURE_BANDS_HZ: Final = (31.5, 63.0, 125.0, 250.0, 500.0)
LEAST_SAMPLING_HZ: Final = 1600.0  # for the octave at 500 Hz


def force_exposure_levels(force: Floats, dt: float) -> dict[float, float]:
    """Impact force exposure level {nominal centre [Hz]: [dB]} in the octaves 31.5 to 500 Hz of a force `force` [nt]
    [N] sampled every `dt` [s]; nan of no force.

    Raises AcousticsError: a shape other than [nt], numbers that are not finite, a sampling too low for these octaves.

    Notes
    -----
    L_FE = 10 lg(integral of F^2 dt / (1 N^2 1 s)) of the force filtered by an octave, the filters of
    `acoustics.levels.bands`. The force is zero before and after the record, over which the filters ring out: a force
    that has not ended by then is cut.

    References
    ----------
    ISO 16283-2:2020 annex A, ISO 10140-5 annex F, JIS A 1418-2 (https://kikakurui.com/a1/A1418-2-2019-01.html).

    A step of 1 N and back, whose spectrum is 1 / (pi f) |sin(pi f T)|:

    >>> round(force_exposure_levels(np.ones(4800), 1 / 48e3)[500.0], 1)
    -38.4
    """
    force = frozen("force", force, (None,))
    sampling_hz = 1 / positive("dt", dt, "s")
    if sampling_hz < LEAST_SAMPLING_HZ * (1 - 1e-9):
        raise AcousticsError("dt", got=f"{sampling_hz:g} Hz", expected=f"{LEAST_SAMPLING_HZ:g} Hz or more")
    passes, found = band_passes(len(force), sampling_hz, 1, thinned=False), {}
    for nominal in EXPOSURE_BANDS_HZ:
        heard = passes[nominal].of(np.fft.rfft(force, passes[nominal].length), 0.0).values
        found[nominal] = decibel(float(heard @ heard) * dt)
    return found
