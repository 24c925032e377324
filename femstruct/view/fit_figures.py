"""Measured beside computed numbers of a fit: histories with what is left over, responses, frequencies, levels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from femstruct.errors import InputError
from femstruct.files.writing import refuse_unwritable_file
from femstruct.study.asked import Beside
from femstruct.view.console import scaled
from femstruct.view.drawing import BASELINE, COLOURS, finish, legend_above, new_figure, panels, unit_text

SUFFIXES = (".png", ".pdf", ".svg")
MOST: Final = 6  # sets of data in one picture
WIDTH: Final = 10.0  # inches
LINE: Final = 0.19  # inches from a line of text to the next
MEASURED: Final = "measured, ± 2 standard deviations"
ROWS: Final = {"history": 2, "frf": 2, "modes": 1, "levels": 1}  # panels of each kind


def refuse_picture(path: Path) -> None:
    """Raise InputError for a name that is no picture's, or a folder that is not there."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError("--picture", got=f"'{path.suffix}'", expected=f"a name that ends in {', '.join(SUFFIXES)}")
    refuse_unwritable_file(path)


def fit_figure(beside: Sequence[Beside], title: str, found: Sequence[str] = ()) -> Figure:
    """A panel or two for every set of data, the first six: measured points, the computed line, what is left over.

    `found` are lines below the title: the parameters with their intervals.
    """
    shown = beside[:MOST]
    rows = sum(ROWS[one.kind] for one in shown)
    top = 0.75 + LINE * len(found)
    height = top + 0.5 + 2.7 * rows
    figure = new_figure(WIDTH, height, f"{title}: measured, and the best fit")
    for i, line in enumerate(map(unit_text, found)):
        figure.text(0.09 / WIDTH, 1.0 - (0.33 + LINE * i) / height, line, fontsize=9, ha="left", va="top", color="0.25")
    axes = iter(panels(figure, rows, 1, between=0.75, top=top)[:, 0])
    for one in shown:
        own = [next(axes) for _ in range(ROWS[one.kind])]
        {"history": _history, "frf": _response, "modes": _modes, "levels": _levels}[one.kind](one, own)
        legend_above(own[0])
    return figure


def _history(one: Beside, axes: Sequence[Axes]) -> None:
    factor, unit = scaled(one.unit, float(np.abs(one.measured).max()))
    above, below = axes
    _both(above, 1e3 * one.along, factor * one.measured, factor * one.computed)
    below.plot(1e3 * one.along, factor * (one.measured - one.computed), color=COLOURS[0], linewidth=0.8)
    finish(above, "time [ms]", f"{one.name} [{unit}]")
    finish(below, "time [ms]", f"measured less computed [{unit}]")


def _response(one: Beside, axes: Sequence[Axes]) -> None:
    above, below = axes
    _both(above, one.along, np.abs(one.measured), np.abs(one.computed))
    above.set_yscale("log")
    measured, computed = (np.degrees(np.angle(values)) for values in (one.measured, one.computed))
    computed[1:][np.abs(np.diff(computed)) > 180.0] = np.nan  # no line across a turn
    _both(below, one.along, measured, computed)
    below.set_yticks([-180, -90, 0, 90, 180])
    finish(above, "frequency [Hz]", f"|{one.name}|\n[{unit_text(one.unit)}]")
    finish(below, "frequency [Hz]", "phase [°]")


def _modes(one: Beside, axes: Sequence[Axes]) -> None:
    own = axes[0]
    off = 100.0 * (one.computed / one.measured - 1.0)
    scatter = 100.0 * one.scatter / one.measured
    own.errorbar(one.along, np.zeros(len(off)), 2.0 * scatter, fmt=".", color=COLOURS[1], capsize=3, label=MEASURED)
    own.plot(one.along, off, "x", color=BASELINE, label="computed")
    for x, y, hertz in zip(one.along, off, one.measured, strict=True):
        own.annotate(f"{hertz:.4g} Hz", (x, y), xytext=(4, 4), textcoords="offset points", fontsize=7, color="0.4")
    own.set_xticks(one.along)
    finish(own, f"measured mode ({one.name})", "computed less measured\nfrequency [%]")


def _levels(one: Beside, axes: Sequence[Axes]) -> None:
    own = axes[0]
    own.errorbar(one.along, one.measured, 2.0 * one.scatter, fmt=".", color=COLOURS[1], capsize=3, label=MEASURED)
    own.plot(one.along, one.computed, "x-", color=BASELINE, linewidth=1, label="computed")
    own.set_xscale("log")
    own.set_xticks(one.along, [f"{band:g}" for band in one.along])
    own.minorticks_off()
    finish(own, "band [Hz]", f"{one.name} [dB]")


def _both(axes: Axes, x: np.ndarray, measured: np.ndarray, computed: np.ndarray) -> None:
    axes.plot(x, measured, ".", color=COLOURS[1], markersize=3, label="measured")
    axes.plot(x, computed, color=BASELINE, linewidth=1, label="computed")
