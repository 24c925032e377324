"""Figures of sound: levels over time as a meter shows them, and rooms rated by the standards."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from acoustics.levels.rated import RatedRoom
from acoustics.levels.sound_levels import level_history
from acoustics.room_response import RoomResponse
from femstruct.study.result import StudyResult
from femstruct.view.figures.drawing import (
    TOTAL,
    case_colours,
    case_lines,
    finish,
    legend_above,
    new_figure,
    panels,
    thinned,
)
from femstruct.view.figures.undrawn import no_levels, no_rating
from femstruct.view.tables.rated_table import struck_first, told

SHOWN_DB: Final = 50.0  # below the loudest that is drawn
CURVES: Final = ("--", ":", "-.")  # of the single numbers in their order
SPREAD: Final = "0.45"  # colour of its lines
OUTLINED: Final = (withStroke(linewidth=3.2, foreground="white"),)  # what lies on dark bars would be lost


def levels_over_time(result: StudyResult, room: str) -> Figure | None:
    """L_AF(t) at every receiver of a room in all cases, a panel each; the legend gives the largest. None if nobody
    hears it. Dashed: with the sound of striking bodies themselves.

    Where a source strikes several places it is the first of them.
    """
    cases = {name: case for name, case in result.cases.items() if room in case.rooms and case.rooms[room].receivers}
    if no_levels(result, room):
        return None
    looks = case_lines(result.cases, result.plan.baseline)
    names = list(dict.fromkeys(one.name for case in cases.values() for one in case.rooms[room].receivers))
    rows = -(-len(names) // 2)
    columns = min(2, len(names))
    legend = 0.155 * (len(cases) + sum(room in case.heard.total for case in cases.values()))  # inches
    where = f", source at {place}" if (place := struck_first(result)) else ""
    figure = new_figure(11.0, 0.9 + rows * (2.3 + legend), f"Level over time in {room}: A-weighted, Fast{where}")
    grid = panels(figure, rows, columns, between=0.55 + legend, top=0.5 + legend, sharex=True, sharey=True)
    panes: list[Axes] = grid.ravel().tolist()
    loudest = -np.inf
    for axes, receiver in zip(panes, names, strict=False):
        for name, case in cases.items():
            drawn: list[tuple[RoomResponse, str, dict[str, Any]]] = [(case.rooms[room], name, {"linewidth": 1.0})]
            if room in case.heard.total:
                drawn.append((case.heard.total[room], f"{name} with the bodies' own sound", TOTAL))
            for response, who, look in drawn:
                for p, one in zip(response.p, response.receivers, strict=True):
                    if one.name == receiver:
                        level = level_history(p, response.dt)
                        x, y = thinned(response.t, level)
                        largest = float(np.fmax.reduce(level))
                        label = f"{who}: largest {largest:.1f} dB" if np.isfinite(largest) else f"{who}: silent"
                        axes.plot(x, y, **(looks[name] | look), label=label)
                        loudest = max(loudest, largest) if np.isfinite(largest) else loudest
        finish(axes, "", f"{receiver}: L_AF in dB re 20 µPa")
        legend_above(axes)
    for axes in panes[len(names) :]:
        axes.set_visible(False)
    for axes in panes[: len(names)][-columns:]:  # the lowest of each column
        axes.set_xlabel("time in s")
        axes.tick_params(labelbottom=True)
    panes[0].set_xlim(0.0, max(float(case.rooms[room].t[-1]) for case in cases.values()))
    if np.isfinite(loudest):
        panes[0].set_ylim(loudest - SHOWN_DB, loudest + 3.0)
    return figure


def rated_bands(result: StudyResult, room: str) -> Figure | None:
    """Bands of a rated room in all cases, with what they spread over drops and receivers (one standard deviation to
    each side), and what its single numbers hold them against as curves; None if nobody rates it.

    The curves belong to the baseline: reference curves shifted to a number, the curve of a grade, or the levels that
    would put equal parts into a sum, so that what exceeds them decides it; a number that is but a bound has none. Cases
    with other bands are not drawn, nor are bands beyond the modes; those of statistical energies are hatched.
    """
    rated = {name: case.rated[room] for name, case in result.cases.items() if room in case.rated}
    if no_rating(result, room):
        return None
    colours = case_colours(result.cases, result.plan.baseline)
    first = rated.get(result.plan.baseline) or next(iter(rated.values()))
    kind = (first.band_quantity, first.bands_hz)
    shown = {name: one for name, one in rated.items() if (one.band_quantity, one.bands_hz) == kind}
    title = f"Impact sound in {room}: {', '.join(first.standards)}, {first.drops} drops x {first.receivers} receivers"
    spread_over = any(np.isfinite(list(one.spread_db.values())).any() for one in shown.values())
    over_rooms = any(one.ensemble for one in shown.values())
    lines = 0.155 * (len(shown) + len(first.curves) + spread_over + over_rooms)  # inches of the legend
    figure = new_figure(11.0, 4.6 + lines, title)
    ((axes,),) = panels(figure, 1, 1, between=0.5, top=0.55 + lines)
    width = 0.8 / len(shown)
    heard = [level for one in shown.values() for level in one.bands_db.values() if np.isfinite(level)] or [0.0]
    highest, lowest = max(heard), min(heard)
    floor = 10.0 * np.floor((max(lowest, highest - SHOWN_DB) - 3.0) / 10.0)
    for number, (name, one) in enumerate(shown.items()):
        x = np.arange(len(one.bands_hz)) + (number - (len(shown) - 1) / 2) * width
        levels, spread = (np.array(list(values.values())) for values in (one.bands_db, one.spread_db))
        known = np.isfinite(levels)
        x, levels, spread = x[known], levels[known], spread[known]
        bars: dict[str, Any] = {}
        if np.isfinite(spread).any():
            spread = np.where(np.isfinite(spread), spread, 0.0)  # of what is statistical
            bars = {"yerr": spread, "error_kw": {"ecolor": SPREAD, "elinewidth": 0.8}}
        bars |= {"bottom": floor, "color": colours[name]}
        drawn = axes.bar(x, levels - floor, width, label=_label(name, one), **bars)
        for band, bar in zip(np.array(one.bands_hz)[known].tolist(), drawn, strict=True):
            if band in one.statistical_hz:
                bar.set(hatch="///", edgecolor="white", linewidth=0.0)
        means = np.array(list(one.mean_db.values()))[known]
        if np.isfinite(means).any():
            low, high = (np.array(list(limits.values()))[known] for limits in (one.low_db, one.high_db))
            look = {"fmt": "D", "markersize": 3.6, "color": "black", "elinewidth": 1.6, "capsize": 0.0, "mfc": "white"}
            mean, _, (ends,) = axes.errorbar(x + 0.25 * width, means, yerr=[means - low, high - means], **look)
            ends.set_path_effects(OUTLINED)
            mean.set_zorder(ends.get_zorder() + 0.1)
    compared = {symbol: rating for symbol, rating in first.curves.items() if rating.curve_db}
    for style, (symbol, rating) in zip(CURVES, compared.items(), strict=False):
        curve, label = list(rating.curve_db.values()), f"{symbol} of the baseline: {rating.curve}"
        look = {"color": "0.2", "linestyle": style, "linewidth": 1.1, "path_effects": OUTLINED}
        axes.plot(np.arange(len(curve)), curve, label=label, **look)
    axes.set_xticks(range(len(first.bands_hz)), [f"{band:g}" for band in first.bands_hz], fontsize=8)
    axes.set_xlim(-0.6, len(first.bands_hz) - 0.4)
    axes.set_ylim(floor, max(highest, *axes.get_ylim()) + 2.0)
    hatched = "; hatched: statistical" if any(one.statistical_hz for one in shown.values()) else ""
    if spread_over:
        axes.plot(
            [], [], color=SPREAD, linewidth=0.8, label="standard deviation over drops and receivers, to each side"
        )
    if over_rooms:
        label = "mean over rooms and places, and 90 % interval"
        axes.plot([], [], "D-", color="black", mfc="white", markersize=3.6, linewidth=1.6, label=label)
    if not all(np.isfinite(list(one.bands_db.values())).all() for one in shown.values()):
        hatched += "; no bar: beyond the modes"
    finish(axes, f"{first.method.bands}, nominal centre in Hz{hatched}", f"{first.band_quantity} in dB re 20 µPa")
    legend_above(axes)
    axes.grid(False, axis="x")
    return figure


def _label(name: str, rated: RatedRoom) -> str:
    numbers = ", ".join(f"{symbol} {told(one)}" for symbol, one in rated.curves.items())
    return f"{name}: {numbers}" if numbers else name
