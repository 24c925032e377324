"""What a room needs beside its result is free when it is done: the command line collects cycles seldom."""

from __future__ import annotations

import gc

import numpy as np
import pytest

from acoustics.rooms.box import Box, transfer


@pytest.mark.parametrize("levels", [[0.5, 1.0, 1.5], [0.3, 0.77, 1.9]])
def test_a_transfer_leaves_no_cycle_that_holds_arrays(levels: list[float]) -> None:
    room = Box([4.0, 3.0, 2.5])
    s, k_lm = 2j * np.pi * np.arange(1.0, 9.0), np.arange(1.0, 4.0)
    transfer(room, s, k_lm, np.array(levels))
    gc.collect()
    gc.disable()
    try:
        found = transfer(room, s, k_lm, np.array(levels))
        assert len(found) == len(levels)
        assert gc.collect() == 0
    finally:
        gc.enable()
