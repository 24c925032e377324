"""Of the modes of a room only those are made that may be kept, however far the modes of the structure go."""

from __future__ import annotations

import numpy as np
import pytest

from acoustics.rooms import box_coupling as box_two_way
from acoustics.rooms.box import Box, room_modes
from acoustics.rooms.box_coupling import MOST, NO_END, kept_modes

_NO_END = np.full(3, NO_END)


def test_a_stiff_structure_asks_for_no_more_modes_than_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """300 modes of a living room end at 350 Hz; up to 5 kHz there are 663 000."""
    asked: list[float] = []

    def watched(room: Box, up_to_hz: float) -> tuple[np.ndarray, np.ndarray]:
        asked.append(up_to_hz)
        return room_modes(room, up_to_hz)

    monkeypatch.setattr(box_two_way, "room_modes", watched)
    kept_modes(Box([5.0, 4.0, 2.5]), 5000.0, _NO_END)
    assert max(asked) < 400.0


@pytest.mark.parametrize("size", [[5.0, 4.0, 2.5], [40.0, 0.5, 0.3], [3.0, 3.0, 3.0]])
@pytest.mark.parametrize("finest", [NO_END, 4])
def test_they_are_the_lowest_of_all(size: list[float], finest: int) -> None:
    room = Box(size)
    frequency_hz, indices, complete = kept_modes(room, 3000.0, np.full(3, finest))
    every_hz, every = room_modes(room, 3000.0)
    beyond = (np.arange(len(every)) >= MOST) | (every > finest).any(axis=1)
    low = every_hz < complete * (1 - 1e-9)
    assert complete == (every_hz[beyond.argmax()] if beyond.any() else 3000.0)
    assert np.array_equal(indices, every[low]) and np.array_equal(frequency_hz, every_hz[low])
