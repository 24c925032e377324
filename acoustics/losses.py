"""How sound dies away in a room: losses by damping ratio, loss factor or reverberation time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, log, pi, sqrt
from typing import Final, Literal

import numpy as np

from acoustics.arrays import Floats, freeze, positive
from acoustics.errors import AcousticsError
from acoustics.tags import stored_as

_SINGLE_MODES: Final = 2000.0  # sqrt(m^3/s)/s, of T and V in SI units
DECAY_OF_T60: Final = 3 * log(10)  # gamma T60: exp(-gamma T60) is -60 dB, which is 10^-3, hence ln(10^6) / 2 = 6.9078

LossKind = Literal["none", "kelvin_voigt", "constant_decay", "decay_and_relaxation", "source"]
_PARAMETERS: Final = {
    "none": (),
    "kelvin_voigt": ("relaxation_time",),
    "constant_decay": ("decay_rate",),
    "decay_and_relaxation": ("decay_rate", "relaxation_time"),
    "source": ("beta",),
}


@stored_as("losses of a room/1")
@dataclass(frozen=True, eq=False)
class Losses:
    """How sound dies away in the room; the parameters its kind needs, and no other.

    kind : with s = j omega,
        ``none``;
        ``kelvin_voigt``, k^2 = -s^2 / (c^2 (1 + s tau)), `relaxation_time` tau [s]: the damping ratio grows with
        frequency, omega tau / 2;
        ``constant_decay``, k^2 = -(s^2 + 2 gamma s) / c^2, `decay_rate` gamma [1/s]: one reverberation time for all
        modes, uniform compression without loss;
        ``decay_and_relaxation``, k^2 = -(s^2 + 2 gamma s) / (c^2 (1 + s tau)): both, so that a mode decays with
        gamma + omega^2 tau / 2;
        ``source``, k = omega (1 - j beta) / c, `beta` [-]: one damping ratio for all modes.

    Raises AcousticsError: a parameter missing, of another kind, or negative.

    Notes
    -----
    All but the last are causal. That is not, whatever the sign of beta (its phase 2 beta is the same at all
    frequencies); with the sign of the dissertation it comes from, k = omega (1 + j beta) / c, the response would
    even come before its cause, so that the sign is corrected here.
    """

    kind: LossKind = "none"
    relaxation_time: float = 0.0
    decay_rate: float = 0.0
    beta: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in _PARAMETERS:
            raise AcousticsError("losses.kind", got=repr(self.kind), expected=f"one of {', '.join(_PARAMETERS)}")
        for name in ("relaxation_time", "decay_rate", "beta"):
            value = float(getattr(self, name))
            if name in _PARAMETERS[self.kind]:
                positive(f"losses.{name}", value, "")
            elif value != 0:
                raise AcousticsError(
                    f"losses.{name}", got=f"{value:g}", expected=f"nothing with kind {self.kind}", do="leave it out"
                )
            freeze(self, **{name: value})
        if self.beta >= 1:
            raise AcousticsError("losses.beta", got=f"{self.beta:g}", expected="less than 1 (1.16 % is 0.0116)")


def losses_from_beta(beta: float, frequency_hz: float, form: str = "causal") -> Losses:
    """Losses with the damping ratio `beta` [-] at `frequency_hz` [Hz].

    Parameters
    ----------
    form : str
        ``causal``: Kelvin-Voigt air with tau = 2 beta / omega_ref, so the frequency matters much: take the first mode
        of the room. ``source``: the same beta at all frequencies; the frequency has no effect on it and is only
        checked.

    Examples
    --------
    >>> losses = losses_from_beta(0.0116, 293)
    >>> [round(modal_damping_ratio(losses, f), 4) for f in (19.9, 293, 1700)]
    [0.0008, 0.0116, 0.0673]
    """
    beta = positive("losses.beta", beta, "")
    omega = 2 * pi * positive("losses.at", frequency_hz, "Hz")
    if form == "causal":
        return Losses("kelvin_voigt", relaxation_time=2 * beta / omega)
    if form == "source":
        return Losses("source", beta=beta)
    raise AcousticsError("losses.form", got=repr(form), expected="causal or source")


def losses_from_loss_factor(eta: float, frequency_hz: float, form: str = "causal") -> Losses:
    """Losses with the loss factor `eta` = 2 beta [-] at `frequency_hz` [Hz]; see `losses_from_beta`.

    >>> round(modal_damping_ratio(losses_from_loss_factor(0.0232, 293), 293), 6)
    0.0116
    """
    return losses_from_beta(positive("losses.loss_factor", eta, "") / 2, frequency_hz, form)


def losses_from_t60(t60: float) -> Losses:
    """Losses with the reverberation time `t60` [s] at all frequencies: decay rate gamma = 3 ln(10) / T60.

    >>> round(losses_from_t60(1.0).decay_rate, 4)
    6.9078
    """
    return Losses("constant_decay", decay_rate=DECAY_OF_T60 / positive("losses.t60", t60, "s"))


def losses_from_t60_bands(t60_s: Mapping[float, float]) -> Losses:
    """Losses nearest to reverberation times {frequency [Hz]: T60 [s]}: a decay rate and a relaxation time.

    Raises AcousticsError: no band, a frequency or time that is not positive.

    Notes
    -----
    A mode decays with gamma + omega^2 tau / 2. Two parameters cannot follow any curve: they are the ones >= 0 with
    the least sum of squares of the relative errors of the decay rates 3 ln(10) / T60. A T60 that rises with frequency
    is out of their reach; `t60_of` tells what became of it.

    >>> losses = losses_from_t60_bands({63.0: 0.9, 125.0: 0.8, 500.0: 0.5})
    >>> [round(t60_of(losses, f), 2) for f in (63.0, 125.0, 500.0)]
    [0.87, 0.84, 0.5]
    """
    if not t60_s:
        raise AcousticsError("losses.t60", got="no band", expected="a reverberation time at one frequency or more")
    omega = 2 * pi * np.array([positive("losses.t60 frequency", f, "Hz") for f in t60_s])
    rates = DECAY_OF_T60 / np.array([positive(f"losses.t60 at {f:g} Hz", t, "s") for f, t in t60_s.items()])
    columns = np.stack((np.ones(len(omega)), omega**2 / 2), axis=1) / rates[:, None]
    found = [np.array([one @ np.ones(len(omega)) / (one @ one), 0.0]) for one in columns.T]
    found[1] = found[1][::-1]
    if len(np.unique(omega)) > 1:
        found.append(np.linalg.lstsq(columns / np.abs(columns).max(axis=0), np.ones(len(omega)))[0])
        found[-1] /= np.abs(columns).max(axis=0)
    allowed = [pair for pair in found if (pair >= 0).all()]
    gamma, tau = min(allowed, key=lambda pair: float(((columns @ pair - 1) ** 2).sum()))
    if not tau > 0:
        return Losses("constant_decay", decay_rate=gamma)
    if not gamma > 0:
        return Losses("kelvin_voigt", relaxation_time=tau)
    return Losses("decay_and_relaxation", relaxation_time=tau, decay_rate=gamma)


def single_modes_hz(t60_s: float, volume: float) -> float:
    """Up to where modes of a room stand alone [Hz]: above 2000 sqrt(T / V) three or more overlap.

    Parameters
    ----------
    t60_s : float
        Reverberation time [s]; volume [m^3].

    References
    ----------
    M. R. Schroeder, J. Acoust. Soc. Am. 99, 3240 (1996), doi:10.1121/1.414868.

    Examples
    --------
    >>> single_modes_hz(0.5, 50.0)
    200.0
    """
    return _SINGLE_MODES * sqrt(t60_s / volume)


def t60_of(losses: Losses, frequency_hz: float) -> float:
    """Reverberation time [s] of a room mode at `frequency_hz` [Hz] under these losses; infinite without any.

    >>> round(t60_of(losses_from_t60(0.5), 100.0), 6)
    0.5
    """
    decay = 2 * pi * frequency_hz * modal_damping_ratio(losses, frequency_hz)
    return DECAY_OF_T60 / decay if decay > 0 else inf


def modal_damping_ratio(losses: Losses, frequency_hz: float) -> float:
    """Damping ratio [-] of a room mode at `frequency_hz` [Hz] under these losses.

    Raises AcousticsError: a frequency not above 0 (the uniform mode has none).

    >>> modal_damping_ratio(losses_from_beta(0.0116, 293, "source"), 50.0)
    0.0116
    """
    return float(modal_damping_ratios(losses, np.array([positive("frequency", frequency_hz, "Hz")]))[0])


def modal_damping_ratios(losses: Losses, frequency_hz: Floats) -> Floats:
    """As `modal_damping_ratio`, of many modes [n] at frequencies above 0 [Hz]."""
    omega = 2 * pi * frequency_hz
    ratios: Floats = omega * losses.relaxation_time / 2 + losses.decay_rate / omega + losses.beta  # of other kinds 0
    return ratios
