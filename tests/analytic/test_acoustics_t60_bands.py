"""Reverberation times by band: the fit against its own law, against computed decays, and what it cannot do."""

from __future__ import annotations

import numpy as np
import pytest

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.rectangular import Room
from acoustics.levels.sound_levels import reverberation_time
from acoustics.losses import losses_from_t60_bands, t60_of
from acoustics.receivers import Receiver
from acoustics.rooms.box import room_modes
from acoustics.rooms.box_pressure import pressure
from acoustics.rooms.room_advice import t60_missed
from acoustics.source import SurfaceVelocity

LN = 3 * np.log(10)
BANDS = np.array([63.0, 125.0, 250.0, 500.0])


def test_times_of_a_decay_rate_and_a_relaxation_time_give_them_back():
    gamma, tau = 7.0, 4e-7
    times = {f: LN / (gamma + (2 * np.pi * f) ** 2 * tau / 2) for f in BANDS}
    losses = losses_from_t60_bands(times)
    assert (losses.kind, losses.decay_rate, losses.relaxation_time) == (
        "decay_and_relaxation",
        pytest.approx(gamma, rel=1e-13),  # rounding: 1e-16 here
        pytest.approx(tau, rel=1e-13),
    )
    assert t60_missed({f: t60_of(losses, f) for f in times}, times) == ()


def test_the_fit_is_the_least_of_all_that_are_not_negative():
    """A search over a fine grid around it finds no smaller sum of squares of the relative errors of the rates."""
    for times in ([0.9, 0.8, 0.6, 0.5], [0.4, 0.5, 0.7, 0.9], [2.0, 0.5, 0.12, 0.03], [0.9, 0.9, 0.9, 0.3]):
        wanted = LN / np.array(times)
        losses = losses_from_t60_bands(dict(zip(BANDS, times, strict=True)))

        def missed(gamma, tau, wanted=wanted):
            return float((((gamma + (2 * np.pi * BANDS) ** 2 * tau / 2) / wanted - 1) ** 2).sum())

        best = missed(losses.decay_rate, losses.relaxation_time)
        for gamma in np.linspace(0.0, wanted.max(), 60):
            for tau in np.linspace(0.0, 2 * (wanted / (np.pi * BANDS) ** 2 / 4).max(), 60):
                assert missed(gamma, tau) >= best * (1 - 1e-9)


def test_times_that_rise_are_told_with_both_numbers():
    asked = {63.0: 0.4, 125.0: 0.5, 250.0: 0.7, 500.0: 0.9}
    losses = losses_from_t60_bands(asked)
    assert losses.kind == "constant_decay"
    (advice,) = t60_missed({f: t60_of(losses, f) for f in asked}, asked)
    assert advice.values["asked_63_hz_s"] == 0.4
    assert advice.values["modelled_63_hz_s"] == pytest.approx(t60_of(losses, 63.0))
    assert "63 Hz 0.4 s / 0." in advice.message
    # T = sum T_i^2 / sum T_i = 0.684 s: 10 lg(0.684 / 0.4) and 10 lg(0.9 / 0.684)
    assert "up to 2.3 dB too high (63 Hz) and 1.2 dB too low (500 Hz), of steady sound" in advice.message


def test_a_room_rings_as_long_as_its_losses_say():
    """A mode struck alone decays with gamma + omega^2 tau / 2: read off the pressure by backward integration."""
    losses = losses_from_t60_bands({60.0: 0.5, 240.0: 0.2})
    room = Room([3.0, 2.0, 0.4], Air(343, 1.21), losses)  # its first modes lie across the floor
    (first, *_), _ = room_modes(room, 200.0)
    dt, count = 1 / 8000.0, 8000
    x, y = (np.stack(np.meshgrid(np.linspace(0, 3, 61), [0.5, 1.5], indexing="ij"), -1).reshape(-1, 2)).T
    weights = np.full(len(x), 6.0 / 122) * np.where((x == 0) | (x == 3), 0.5, 1.0) * 61 / 60
    t = np.arange(count) * dt
    rate = np.where(t < 0.1, np.sin(2 * np.pi * first * t) * np.sin(np.pi * t / 0.1) ** 2, 0.0)
    moving = SurfaceVelocity(
        np.stack((x, y, np.full(len(x), 0.4)), axis=1), weights, np.cos(np.pi * x / 3)[:, None], rate[None], dt
    )
    heard = pressure(moving, room, (Receiver("corner", [0.0, 1.0, 0.1]),))
    # .1 %: the line that is fitted to the ripple of the squared sine
    assert reverberation_time(heard.p[0, 900:], dt) == pytest.approx(t60_of(losses, first), rel=5e-3)


@pytest.mark.parametrize("times", [{}, {63.0: 0.0}, {0.0: 1.0}, {63.0: -1.0}])
def test_nothing_that_means_no_time_is_taken(times):
    with pytest.raises(AcousticsError):
        losses_from_t60_bands(times)
