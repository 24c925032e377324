"""Rows of a sweep by the batch engine beside full runs: CPU seconds, and how far their numbers are apart.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python scripts/bench_sweep.py

The floor that is shipped, one microphone, impact numbers vary: a row by the batch engine, of peaks of channels, by a
full run, and the impact alone, in the same process.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from femstruct.campaign.sweep import sweep
from femstruct.language.campaigns import read_campaign
from femstruct.study.campaigns import Swept

FLOOR = Path(__file__).parents[1] / "models" / "floor_tennis_ball.study.yaml"
VARY = ("bodies.damper.mass=uniform(0.3 kg, 0.9 kg)", "bodies.ball.mass=uniform(40 g, 60 g)")
LEVEL, FORCE, PEAK = "box.mic L_AFmax", "ball on floor force", "B.z acceleration"


def timed(count: int, only: tuple[str, ...]) -> tuple[float, Swept]:
    """CPU seconds and rows of so many samples."""
    campaign = read_campaign(FLOOR, VARY, case="damper 0.6", count=count, only=only)
    start = time.process_time()
    rows = sweep(campaign, workers=1)
    return time.process_time() - start, rows


def measured() -> Iterator[tuple[str, float]]:
    """Names and numbers, to be printed. What is made once is taken off by two numbers of samples."""
    timed(2, (FORCE,))  # kernels and imports
    per_row = {}
    asked = {
        "impact alone": ((FORCE,), (64, 320)),
        "peaks of channels": ((PEAK,), (16, 48)),
        "with a microphone": ((LEVEL,), (64, 320)),
        "full run": ((), (4, 12)),
    }
    for what, (only, counts) in asked.items():
        (few, _), (many, _) = (timed(count, only) for count in counts)
        per_row[what] = (many - few) / (counts[1] - counts[0])
        yield f"floor, 97 modes, {what}: ms a row", 1e3 * per_row[what]
    yield "full run over batch row with a microphone", per_row["full run"] / per_row["with a microphone"]
    batch, full = timed(8, (LEVEL, FORCE))[1], timed(8, ())[1]
    yield "levels apart, dB", float(np.abs(batch.of(LEVEL) - full.of(LEVEL)).max())
    yield "forces apart, relative", float(np.abs(batch.of(FORCE) / full.of(FORCE) - 1.0).max())


if __name__ == "__main__":
    for words, number in measured():
        print(f"{words}: {number:.3g}")
