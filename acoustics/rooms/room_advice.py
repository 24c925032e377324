"""Advice on how far a room response can be trusted."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import log10
from typing import Final

import numpy as np

from acoustics.arrays import Integers
from acoustics.errors import Advice
from acoustics.rooms.box import Box, cosines, project
from acoustics.source import SurfaceVelocity

# Of the source's highest frequency. Measured by leaving out samples of shipped studies, a bang machine and two balls on
# a floor. At 30, 15, 7.5, 4 and 2 samples the worst of them misses 6e-5, 2e-3, 2e-3, 7e-3 and 7e-2 of the pressure's
# peak, 0.0001, 0.0015, 0.016, 0.11 and 0.6 dB of the A-weighted Fast level, 0.001, 0.006, 0.05, 0.2 and 2 dB of a third
# octave
MISSED_AT, MISSED_DB = np.array([2.0, 4.0, 7.5, 15.0, 30.0]), np.array([2.0, 0.2, 0.05, 0.006, 0.001])
COARSELY_SAMPLED: Final = "surface-coarsely-sampled"
ALLOWED_DB: Final = 0.1  # of a third octave: levels are quoted to one decimal
ADVISED: Final = 7.5  # samples a period
TRUNCATED: Final = 1e-3
DECAYED: Final = 1e-3
COARSE: Final = 0.05
T60_MISSED: Final = 0.10  # of a reverberation time; .4 dB of the standardised level


def source_advice(surface: SurfaceVelocity, room: Box, orders: Integers, highest_hz: float) -> tuple[Advice, ...]:
    """Advice on the sampling, the start, the decay and the spacing of the surface's velocity."""
    found = list(sampling_advice(highest_hz, 1 / surface.dt))
    size = surface.speed(4096)  # a ratio to the peak needs no more samples
    peak, start, end = float(size.max()), float(size[0]), float(size[-max(1, len(size) // 20) :].max())
    if start > DECAYED * peak:
        found.append(
            Advice(
                "surface-starts-moving",
                f"the surface already moves at t = 0 ({start / peak:.2g} of its peak): the jump excites the sampling "
                "frequency. Start from rest",
                {"start_ratio": start / peak},
            )
        )
    if end > DECAYED * peak:
        found.append(
            Advice(
                "surface-not-decayed",
                f"at the end of the record the surface moves with {100.0 * end / peak:.2g} % of its peak "
                f"({100.0 * DECAYED:g} % is allowed): spectra and levels are those of a truncated record. "
                "Simulate longer",
                {"end_ratio": end / peak},
            )
        )
    if (
        abs(surface.area / room.ceiling_area - 1) < 1e-6
        and (error := _quadrature_error(surface, room, orders)) > COARSE
    ):
        found.append(
            Advice(
                "ceiling-points-coarse",
                f"the {len(surface.weights)} points of the surface integrate the highest cosines of the room with "
                "an error of "
                f"{error:.2g}; use a finer mesh",
                {"quadrature_error": error, "points": float(len(surface.weights))},
            )
        )
    return tuple(found)


def sampling_advice(highest_hz: float, sampling_hz: float) -> tuple[Advice, ...]:
    """Advice where samples are too few for the highest frequency [Hz] that is heard of a surface."""
    missed, there = third_octave_missed_db(sampling_hz / highest_hz) if highest_hz > 0.0 else 0.0, ADVISED * highest_hz
    if missed <= ALLOWED_DB:
        return ()
    return (
        Advice(
            COARSELY_SAMPLED,
            f"the surface moves up to {highest_hz:.0f} Hz and is sampled at {sampling_hz:.0f} Hz, "
            f"{sampling_hz / highest_hz:.1f} samples a period: a third octave there misses about {missed:.1g} dB. "
            f"Sampling at {there:.0f} Hz leaves {third_octave_missed_db(ADVISED):.1g} dB",
            {"source_highest_hz": highest_hz, "sampling_hz": sampling_hz, "missed_db": missed, "needed_hz": there},
        ),
    )


def advice_below(findings: Iterable[Advice], complete_below_hz: float) -> tuple[Advice, ...]:
    """The same for sound that ends at a frequency [Hz]: samples need not carry what is above it."""
    kept: list[Advice] = []
    for one in findings:
        if one.code == COARSELY_SAMPLED and complete_below_hz < one.values["source_highest_hz"]:
            kept += sampling_advice(complete_below_hz, one.values["sampling_hz"])
        else:
            kept.append(one)
    return tuple(kept)


def third_octave_missed_db(samples: float) -> float:
    """What a third octave loses to sampling [dB]: the measured table above, between its entries by a power.

    Parameters
    ----------
    samples : float
        Of a period of its frequency.
    """
    return float(10 ** np.interp(np.log10(samples), np.log10(MISSED_AT), np.log10(MISSED_DB)))


def truncation(share: float, orders: Integers) -> tuple[Advice, ...]:
    """Advice ``orders-truncated`` when the last cosines still add more than 1e-3 of the pressure."""
    if share <= TRUNCATED or len(orders) <= 1:
        return ()
    return (
        Advice(
            "orders-truncated",
            f"the last orders, up to l = {orders[:, 0].max()}, m = {orders[:, 1].max()}, add {share:.2g} of the "
            "rms pressure: use more orders, or place the receiver further from the surface",
            {"share": share, "l_max": float(orders[:, 0].max()), "m_max": float(orders[:, 1].max())},
        ),
    )


def non_causal_advice(room: Box) -> tuple[Advice, ...]:
    """Advice ``non-causal-losses`` for losses of kind ``source``."""
    if room.losses.kind != "source":
        return ()
    return (
        Advice(
            "non-causal-losses",
            f"a constant damping ratio ({room.losses.beta:g}) is not causal even with its sign corrected: about "
            f"{200 * room.losses.beta:.2g} % of the pressure comes before its cause, and low frequencies are shifted "
            "in phase. Use a causal form of the losses",
            {"beta": room.losses.beta, "phase_rad": 2 * room.losses.beta},
        ),
    )


def t60_missed(modelled: Mapping[float, float], by_frequency: Mapping[float, float]) -> tuple[Advice, ...]:
    """Advice ``t60-missed`` when a reverberation time {frequency [Hz]: [s]} was asked for that the modelled one misses
    by more than 10 %, with what steady sound is then too loud, 10 lg of the one over the other, at worst."""
    missed = [f for f, required in by_frequency.items() if abs(modelled[f] / required - 1) > T60_MISSED]
    if not missed:
        return ()
    listed = ", ".join(f"{f:g} Hz {required:.3g} s / {modelled[f]:.3g} s" for f, required in by_frequency.items())
    off = {f: 10 * log10(modelled[f] / by_frequency[f]) for f in missed}
    ends = ((max(off, key=lambda f: off[f]), "high"), (min(off, key=lambda f: off[f]), "low"))
    worst = " and ".join(
        f"{abs(off[f]):.1f} dB too {word} ({f:g} Hz)" for f, word in ends if (off[f] > 0) == (word == "high")
    )
    values = {f"asked_{f:g}_hz_s": by_frequency[f] for f in missed} | {
        f"modelled_{f:g}_hz_s": modelled[f] for f in missed
    }
    return (
        Advice(
            "t60-missed",
            f"a decay rate and a relaxation time cannot give the required reverberation times; required / modelled: "
            f"{listed}. Levels in the room are up to {worst}, of steady sound; of blows by less",
            values,
        ),
    )


def _quadrature_error(surface: SurfaceVelocity, room: Box, orders: Integers) -> float:
    """Largest departure from 1 of the coefficient that the highest cosines have in themselves."""
    highest = orders[np.unique([orders[:, 0].argmax(), orders[:, 1].argmax(), orders.sum(axis=1).argmax()])]
    themselves = SurfaceVelocity(
        surface.points,
        surface.weights,
        cosines(room, highest, surface.points),
        np.zeros((len(highest), 2)),
        surface.dt,
    )
    return float(np.abs(np.diag(project(themselves, room, highest)) - 1).max())
