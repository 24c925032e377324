"""A room heard through a coarse sampling: the bands that it has are those of a fine one."""

from __future__ import annotations

import numpy as np
import pytest

from acoustics import AcousticsError, Receiver, Room, SurfaceVelocity, losses_from_t60, pressure, sound_levels
from acoustics.rooms.box_pressure import pressures

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
