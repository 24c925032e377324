"""Where the scripts put their pictures."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

from matplotlib.figure import Figure

RESULTS = Path("results")


def save(figure: Figure, name: str) -> None:
    """Write results/NAME.png."""
    RESULTS.mkdir(exist_ok=True)
    figure.savefig(RESULTS / f"{name}.png", dpi=130)
