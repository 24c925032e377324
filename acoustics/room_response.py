"""The sound at the receivers of a room, as a record of pressures."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from acoustics.arrays import Complexes, Floats, freeze, frozen
from acoustics.errors import AcousticsError, Advice
from acoustics.receivers import Receiver
from acoustics.tags import stored_as


@stored_as("room response/1")
@dataclass(frozen=True, eq=False)
class RoomResponse:
    """Pressure at the receivers of a room.

    receivers : in the order of the rows.
    t : [nt], times from 0, equally spaced [s].
    p : [n_receivers, nt], pressure, positive when compressed [Pa].
    findings : advice on how far to trust it.
    complete_below_hz : there is no sound above it, since what makes it is not known there; see
    `acoustics.levels.bands`.

    Notes
    -----
    `spectrum` is the finite Fourier transform P(f) = dt rfft(p) [Pa/Hz] of the record as it stands, no window, at
    `frequency_hz` = 0, 1/T, ..., f_s/2. Parseval: sum p^2 dt = df (|P_0|^2 + 2 sum |P_q|^2 + |P_N/2|^2).
    """

    receivers: tuple[Receiver, ...]
    t: Floats
    p: Floats
    findings: tuple[Advice, ...] = ()
    complete_below_hz: float = inf

    def __post_init__(self) -> None:
        t = frozen("response.t", self.t, (None,))
        if len(t) < 2:
            raise AcousticsError("response.t", got=f"{len(t)} samples", expected="at least 2")
        p = frozen("response.p", self.p, (len(self.receivers), len(t)))
        freeze(self, t=t, p=p, receivers=tuple(self.receivers), findings=tuple(self.findings))

    @property
    def dt(self) -> float:
        """Sampling interval [s]."""
        return float((self.t[-1] - self.t[0]) / (len(self.t) - 1))

    @property
    def frequency_hz(self) -> Floats:
        """Frequencies of the spectrum [nf] [Hz]."""
        return np.asarray(np.fft.rfftfreq(len(self.t), self.dt), dtype=np.float64)

    @property
    def spectrum(self) -> Complexes:
        """Fourier transform of the pressure [n_receivers, nf] [Pa/Hz], made anew at each call."""
        return self.dt * np.fft.rfft(self.p, axis=1)
