"""Reverberation time of a decay that was computed or measured."""

from __future__ import annotations

import numpy as np

from acoustics.arrays import Floats, frozen, positive
from acoustics.errors import AcousticsError


def reverberation_time(p: Floats, dt: float, *, top_db: float = -5.0, bottom_db: float = -35.0) -> float:
    """Time [s] in which the sound of a decaying history `p` [nt] [Pa] falls by 60 dB.

    top_db, bottom_db : part of the decay that a line is fitted to: -5 to -35 dB is T30 of ISO 3382-1, -5 to -25 T20.

    Raises AcousticsError: a history that does not fall to 10 dB below `bottom_db`, where what is left of the record
    would bend the line.

    Notes
    -----
    Backward integration (M. R. Schroeder, J. Acoust. Soc. Am. 37, 409 (1965), doi:10.1121/1.1909343), then a line by
    least squares through the level.

    >>> t = np.arange(48000) / 24e3
    >>> round(reverberation_time(np.sin(2000 * t) * 10 ** (-3 * t / 0.8), 1 / 24e3), 4)
    0.8
    """
    p = frozen("p", p, (None,))
    left = np.cumsum(p[::-1] ** 2)[::-1]
    if not left[0] > 0:
        raise AcousticsError("p", got="silence", expected="a decay")
    level = 10 * np.log10(np.maximum(left / left[0], 1e-30))
    # the last tenth of the record shows how far the decay got
    reached = float(level[int(0.9 * len(level))])
    if reached > bottom_db - 10:
        raise AcousticsError(
            "p", got=f"a decay to {reached:.1f} dB", expected=f"{bottom_db - 10:g} dB or lower", do="record longer"
        )
    part = (level <= top_db) & (level >= bottom_db)
    slope = np.polyfit(positive("dt", dt, "s") * np.flatnonzero(part), level[part], 1)[0]
    return float(-60 / slope)
