"""Spectra of all samples as envelopes: the median of each third octave and the range in which it lies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acoustics.levels.methods import band_quantity_of
from femstruct.arrays import Floats
from femstruct.study.campaign.spread import FEWEST
from femstruct.study.campaign.swept import Swept
from femstruct.view.figures.drawing import case_lines, finish, legend_above, new_figure, panels

GROUPS: Final = (("rated", "rated bands"), ("levels", "third octaves"))  # of summary.json, and what they are called
LEVELS: Final = "L_Fmax"  # of the third octaves of a receiver
KEY: Final = "bands_db"
MOST: Final = 4  # rooms and receivers in one picture


def bands_figure(rows: Swept) -> Figure | None:
    """A panel for each room that is rated, else for each receiver, the first four; None where rows have no levels by
    band, or fewer than two rows are to be trusted.

    Of samples that are drawn, the median and the range from the 5 % to the 95 % quantile; of chosen ones, and of fewer
    than there are statistics of, all from the least to the largest.
    """
    spectra = _spectra(rows)
    sound = [case for case in rows.cases if rows.trusted(case).sum() > 1]
    if not spectra or not sound:
        return None
    drawn = rows.drawn and min(int(rows.trusted(case).sum()) for case in sound) >= FEWEST
    figure = new_figure(9.0, 1.4 + 0.16 * len(sound) + 3.1 * len(spectra), rows.title)
    axes = panels(figure, len(spectra), 1, between=0.65, top=0.95 + 0.16 * len(sound))[:, 0]
    look = case_lines(rows.cases, rows.baseline)
    ends = "5 % to 95 % of the samples" if drawn else "least to largest of the samples"
    for own, (name, bands) in zip(axes, spectra.items(), strict=True):
        for case in sound:
            _envelope(own, rows, bands, case, look[case], ends, drawn=drawn)
        place = range(len(bands))
        own.set_xticks(place, list(bands), fontsize=8 if len(bands) < 18 else 7)
        own.set_title(name, fontsize=10, loc="right")
        finish(own, "frequency in Hz" if own is axes[-1] else "", f"{_quantity(rows, name)} in dB re 20 µPa")
    legend_above(axes[0])
    return figure


def _quantity(rows: Swept, panel: str) -> str:
    """The symbol of the levels in a panel, as "rated bands: bedroom"; where it is not known what they are called."""
    group, _, place = panel.partition(": ")
    if group == GROUPS[1][1]:
        return LEVELS
    symbols = (name.split(" / ")[3] for name in rows.names if name.startswith(f"{GROUPS[0][0]} / {place} / numbers / "))
    return next(filter(None, map(band_quantity_of, symbols)), group)


def _envelope(
    axes: Axes, rows: Swept, bands: dict[str, str], case: str, look: dict[str, str], ends: str, *, drawn: bool
) -> None:
    values = np.column_stack([rows.of(name, case) for name in bands.values()])[rows.trusted(case)]
    low, middle, high = np.array([_quantiles(column, drawn=drawn) for column in values.T]).T
    x = np.arange(len(bands))
    axes.fill_between(x, low, high, color=look["color"], alpha=0.22, linewidth=0, label=f"{case}: {ends}")
    axes.plot(x, middle, **look, linewidth=1.3, marker=".", label=f"{case}: median")  # type: ignore[arg-type]


def _quantiles(values: Floats, *, drawn: bool) -> Sequence[float]:
    """Of a band, nan where any sample has no level in it: a median of the others would be of another set."""
    if not np.isfinite(values).all():
        return (np.nan,) * 3
    found: Sequence[float] = np.quantile(values, (0.05, 0.5, 0.95) if drawn else (0.0, 0.5, 1.0)).tolist()
    return found


def _spectra(rows: Swept) -> dict[str, dict[str, str]]:
    """Names of numbers by band, of each room or receiver: as "rated / bedroom / bands_db / 63"."""
    found: dict[str, dict[str, str]] = {}
    for group, words in GROUPS:
        for name in rows.names:
            steps = name.split(" / ")
            if len(steps) == 4 and steps[0] == group and steps[2] == KEY and np.isfinite(rows.of(name)).any():
                found.setdefault(f"{words}: {steps[1]}", {})[steps[3]] = name
        if found:
            break
    return dict(list(found.items())[:MOST])
