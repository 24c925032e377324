"""A room heard through a coarse sampling: the bands that it has are those of a fine one."""

from __future__ import annotations

import numpy as np
import pytest

from acoustics.errors import AcousticsError
from acoustics.fields.rectangular import Room
from acoustics.levels.bands import truncate_response
from acoustics.levels.sound_levels import sound_levels
from acoustics.losses import losses_from_t60
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.rooms.box_pressure import pressure, pressures
from acoustics.rooms.room_advice import sampling_advice, third_octave_missed_db
from acoustics.source import SurfaceVelocity

ROOM = Room([3.0, 2.0, 2.5], losses=losses_from_t60(0.4))
HERE = [Receiver("mic", [0.8, 0.7, 1.2])]


def heard(sampling: float) -> dict[float, float]:
    """Largest Fast levels under a patch that is pushed in for 20 ms and back: its velocity jumps, so that its spectrum
    goes on beyond any sampling."""
    t = (np.arange(int(0.4 * sampling)) + 0.5) / sampling
    rate = np.where(t < 0.02, 1.0, np.where(t < 0.04, -1.0, 0.0)) * 1e-3
    x, y = np.meshgrid(np.linspace(0.9, 1.5, 7), np.linspace(0.6, 1.0, 5), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 2.5)])
    ceiling = SurfaceVelocity(points, np.full(x.size, 0.01), np.ones((x.size, 1)), [rate], 1 / sampling)
    return dict(sound_levels(pressure(ceiling, ROOM, HERE, orders=8).p[0], 1 / sampling).bands_db)


@pytest.mark.parametrize("sampling", [2000.0, 4000.0])
def test_bands_of_a_coarse_sampling_are_those_of_a_fine_one(sampling: float) -> None:
    """Without the fade at the end of the band they were 40 dB too high, at all frequencies."""
    coarse, fine = heard(sampling), heard(32e3)
    assert max(coarse) >= 630.0
    for band in (63.0, 125.0, 250.0, 500.0, 630.0):
        # samples of a jump, whose spectrum goes as 1/f, fold fs - f onto f, at worst in phase; .3 dB for the next fold
        # and for the lobes of 25 Hz that the two samplings place differently
        folded = 20 * np.log10(1 + band / (sampling - band))
        assert coarse[band] == pytest.approx(fine[band], abs=folded + 0.3), band  # both as said above


def test_several_motions_of_one_ceiling_are_heard_as_each_alone() -> None:
    """What the room costs is shared, nothing else: two motions, in phase and against each other."""
    t = np.arange(1600) / 4e3
    x, y = np.meshgrid((np.arange(12) + 0.5) / 4, (np.arange(8) + 0.5) / 4, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 2.5)])
    shapes = np.column_stack(
        [np.sin(np.pi * x.ravel() / 3) * np.sin(np.pi * y.ravel() / 2), np.cos(np.pi * x.ravel() / 3)]
    )
    pulse = np.where(t < 0.02, np.sin(np.pi * t / 0.02) ** 2, 0.0)
    moving = [
        SurfaceVelocity(points, np.full(x.size, 1 / 16), shapes, rates, 1 / 4e3)
        for rates in ([pulse, pulse], [np.roll(pulse, 40), -3 * pulse])
    ]
    both = pressures(moving, ROOM, HERE)
    for surface, together in zip(moving, both, strict=True):
        alone = pressure(surface, ROOM, HERE).p
        # the search for orders ends where the last ones add less than 1e-4, for the worse of the two
        assert np.abs(together.p - alone).max() < 1e-3 * np.abs(alone).max()
        exact = pressure(surface, ROOM, HERE, orders=9).p
        shared = pressures(moving, ROOM, HERE, orders=9)[moving.index(surface)].p
        np.testing.assert_allclose(shared, exact, rtol=0, atol=1e-13 * np.abs(exact).max())  # rounding: none here
    other = SurfaceVelocity(points, np.full(x.size, 1 / 16), 2 * shapes, [pulse, pulse], 1 / 4e3)
    with pytest.raises(AcousticsError, match="motions of one surface"):
        pressures([moving[0], other], ROOM, HERE)
    with pytest.raises(AcousticsError, match="surfaces: got none"):
        pressures([], ROOM, HERE)


def test_advice_on_samples_gains_something_and_is_not_given_for_less_than_a_tenth() -> None:
    """9.4 samples a period: "misses about 0.02 dB. Sampling at 8480 Hz leaves 0.03 dB"."""
    assert not sampling_advice(848.0, 9.4 * 848.0) and not sampling_advice(0.0, 8e3)
    (told,) = sampling_advice(1000.0, 4000.0)
    assert told.values["missed_db"] == pytest.approx(0.2, rel=1e-9)  # the measured table, at 4 samples
    left = third_octave_missed_db(told.values["needed_hz"] / 1000.0)
    assert left < told.values["missed_db"] and f"leaves {left:.1g} dB" in told.message
    assert not sampling_advice(1000.0, told.values["needed_hz"])


def test_sound_that_ends_at_the_last_mode_needs_no_samples_for_more() -> None:
    """A surface up to 1204 Hz, sampled at 6 kHz, and modes up to 300 Hz: no band beyond them is shown."""
    advice = sampling_advice(1204.0, 6000.0)
    assert advice and advice[0].values["source_highest_hz"] == 1204.0
    heard = RoomResponse(tuple(HERE), np.arange(600) / 6e3, np.zeros((1, 600)), advice)
    assert truncate_response(heard, 1500.0).findings == advice
    assert truncate_response(heard, 300.0).findings == ()
    (less,) = truncate_response(heard, 1150.0).findings  # 5.2 samples a period of it
    assert less.values["source_highest_hz"] == 1150.0
