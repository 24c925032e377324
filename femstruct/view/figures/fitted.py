"""A measured history beside what was found for it, and what is left over."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.files.atomic import refuse_unwritable_file
from femstruct.view.figures.drawing import BASELINE, COLOURS, finish, legend_above, new_figure, panels
from femstruct.view.tables.scales import scaled

SUFFIXES = (".png", ".pdf", ".svg")


def refuse_picture(path: Path) -> None:
    """Raise InputError for a name that is no picture's, or a folder that is not there."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError("--picture", got=f"'{path.suffix}'", expected=f"a name that ends in {', '.join(SUFFIXES)}")
    refuse_unwritable_file(path)


def fit_figure(t: Floats, measured: Floats, computed: Floats, channel: str, unit: str) -> Figure:
    """Measured and computed history [n] over t [s] above, measured less computed below: noise, if the law is right."""
    factor, shown = scaled(unit, float(np.abs(measured).max()))
    figure = new_figure(10.0, 7.0, f"{channel}: measured, and the best fit")
    above, below = panels(figure, 2, 1, between=0.5, top=0.75, sharex=True, height_ratios=(2, 1))[:, 0]
    above.plot(1e3 * t, factor * measured, ".", color=COLOURS[1], markersize=3, label="measured")
    above.plot(1e3 * t, factor * computed, color=BASELINE, linewidth=1, label="computed")
    below.plot(1e3 * t, factor * (measured - computed), color=COLOURS[0], linewidth=0.8)
    finish(above, "", f"{channel} [{shown}]")
    finish(below, "time [ms]", f"measured less computed [{shown}]")
    legend_above(above)
    return figure
