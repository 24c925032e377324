"""Numbers of a campaign over what varied: curves over one path, maps over two, points over each of several."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from femstruct.arrays import Floats
from femstruct.files.tables.sweep_tables import case_of_pictures, changing, unchanged
from femstruct.study.campaign.influence import influences
from femstruct.study.campaign.swept import Flags, Swept
from femstruct.study.campaign.varied import INDICES
from femstruct.view.campaigns.swept_table import in_unit
from femstruct.view.figures.drawing import BASELINE, case_lines, finish, legend_above, new_figure, panels

AS_GIVEN: Final = "as given"
MOST: Final = 6  # numbers in one picture
MOST_TICKS: Final = 8  # along one axis of a map
WIDE: Final = 30.0  # largest over smallest value of a path, from which on its axis is logarithmic
LEAST_DB: Final = 0.1  # of a picture's height
FEW_DECADES: Final = 2e3  # the same, from which on ticks are at powers of ten alone
LIMIT: Final[dict[str, Any]] = {"color": "#d55e00", "linewidth": 0.9, "linestyle": "--", "label": "limit"}
UNTRUSTED: Final[dict[str, Any]] = {"marker": "x", "linestyle": "none", "markersize": 5}


def swept_figure(rows: Swept, names: Sequence[str], case: str = "") -> Figure | None:
    """A picture of some numbers, the first six that differ if any do, over what varied; None where nothing varied is a
    number.

    Samples for indices: the shares of all paths in the variance. One path: a curve for every case. Two paths of a grid:
    a map of one case. Otherwise: points of one case over each path. Rows that findings forbid to trust are crosses.
    case : of what shows only one; if none, the baseline or the case in which more numbers change.
    """
    same = unchanged(rows, names)
    case = case or case_of_pictures(rows, names)
    known = [name for name in names if np.isfinite(rows.numbers[:, :, rows.names.index(name)]).any()]
    drawn = ([name for name in known if name not in same] or known)[:MOST]
    several = [j for j in range(len(rows.paths)) if len({texts[j] for texts in rows.texts}) > 1]
    numeric = [j for j in several if np.isfinite(rows.values[:, j]).all()]
    if not drawn or not numeric:
        return None
    if len(several) == 1 and rows.method != INDICES:
        return _curves(rows, drawn, numeric[0])
    shown = [name for name in drawn if np.isfinite(rows.of(name, case)).any()]
    shown = ([name for name in changing(rows, names, case) if name in known] or shown)[:MOST]
    if rows.method == INDICES:
        return _tornado(rows, shown, case)
    if len(numeric) == len(several) == 2 and not rows.drawn:
        return _maps(rows, shown, numeric, case)
    return _points(rows, shown, numeric, case)


def _curves(rows: Swept, names: Sequence[str], k: int) -> Figure:
    figure = new_figure(9.0, 1.1 + 2.6 * len(names), rows.title)
    axes = panels(figure, len(names), 1, between=0.55, top=0.75 + 0.16 * len(rows.cases), sharex=True)[:, 0]
    order = np.argsort(rows.values[:, k])
    factor, unit = shown_unit(rows.units[k], rows.values[:, k])
    x = factor * rows.values[order, k]
    for number, (name, own) in enumerate(zip(names, axes, strict=True)):
        scale, told = shown_unit(rows.unit_of(name), rows.numbers[:, :, rows.names.index(name)])
        for case, line in case_lines(rows.cases, rows.baseline).items():
            y, sound = scale * rows.of(name, case)[order], rows.trusted(case)[order]
            own.plot(x, np.where(sound, y, np.nan), marker=".", label=case, **line)
            _cross(own, x, y, sound, line["color"])
        _limit(own, rows, name, scale)
        _level(own, told)
        number_axis(own, x)
        finish(own, named(rows.paths[k], unit) if number == len(names) - 1 else "", named(name, told))
    _limit_named(axes[0], rows, names)
    if len(rows.cases) > 1 or set(names) & set(rows.limits):
        legend_above(axes[0])
    return figure


def _maps(rows: Swept, names: Sequence[str], numeric: Sequence[int], case: str) -> Figure:
    columns = min(2, len(names))
    high = -(-len(names) // columns)
    title = titled(rows, case)
    figure = new_figure(5.2 * columns + 0.6, 1.0 + 3.4 * high, title)
    grid: list[Axes] = panels(figure, high, columns, between=0.85, top=0.8, right=0.5).ravel().tolist()
    (xs, i), (ys, j) = (np.unique(rows.values[:, k], return_inverse=True) for k in numeric)
    scales = [shown_unit(rows.units[k], rows.values[:, k]) for k in numeric]
    for own, name in zip(grid, names, strict=False):
        scale, told = shown_unit(rows.unit_of(name), rows.of(name, case))
        table = np.full((len(ys), len(xs)), np.nan)
        table[j, i] = np.where(rows.trusted(case), scale * rows.of(name, case), np.nan)
        x, y = (factor * one for (factor, _), one in zip(scales, (xs, ys), strict=True))
        drawn = own.pcolormesh(edges(x), edges(y), table, shading="flat", cmap="viridis")
        bar = figure.colorbar(drawn, ax=own)
        bar.ax.tick_params(labelsize=8)
        blank = "" if np.isfinite(table).all() else " (white: no number)"
        own.set_title(named(name, told) + blank, fontsize=10, loc="left")
        limit = rows.limits.get(name)
        whole = np.isfinite(table).all() and min(table.shape) > 1
        if limit is not None and whole and table.min() < scale * limit < table.max():
            own.contour(x, y, table, levels=[scale * limit], colors="white", linewidths=1.2)
            own.plot([], [], color="white", linewidth=1.2, label=f"limit {scale * limit:.4g} {told}".rstrip())
            own.legend(fontsize=8, loc="upper right", facecolor="0.35", labelcolor="white", framealpha=0.8)
        number_axis(own, x)
        number_axis(own, y, vertical=True)
        _ticks_at(own.xaxis, x)
        _ticks_at(own.yaxis, y)
        finish(own, *(named(rows.paths[k], scale[1]) for k, scale in zip(numeric, scales, strict=True)))
    for own in grid[len(names) :]:
        own.set_visible(False)
    return figure


def _points(rows: Swept, names: Sequence[str], numeric: Sequence[int], case: str) -> Figure:
    title = titled(rows, case)
    figure = new_figure(1.3 + 3.0 * len(numeric), 1.1 + 2.4 * len(names), title)
    grid = panels(figure, len(names), len(numeric), between=0.35, top=0.75, sharex="col", sharey="row")
    sound = rows.trusted(case)
    for row, name in enumerate(names):
        scale, told = shown_unit(rows.unit_of(name), rows.of(name, case))
        for column, k in enumerate(numeric):
            own, (factor, unit) = grid[row, column], shown_unit(rows.units[k], rows.values[:, k])
            x, y = factor * rows.values[:, k], scale * rows.of(name, case)
            own.plot(x[sound], y[sound], ".", color=BASELINE, markersize=4)
            _cross(own, x, y, sound, "#d55e00")
            _limit(own, rows, name, scale)
            _level(own, told)
            number_axis(own, x)
            last = row == len(names) - 1
            finish(own, named(rows.paths[k], unit) if last else "", named(name, told) if column == 0 else "")
    _limit_named(grid[0, 0], rows, names)
    if set(names) & set(rows.limits):
        legend_above(grid[0, 0])
    return figure


def _tornado(rows: Swept, names: Sequence[str], case: str) -> Figure:
    """Shares of all paths in the variance of each number, the largest above, with their intervals."""
    title = titled(rows, case)
    high = 0.8 + 0.5 * len(rows.paths)
    figure = new_figure(9.5, 1.4 + high * len(names), title)
    grid = panels(figure, len(names), 1, between=0.75, top=1.0, left=3.2, sharex=True)[:, 0]
    for own, name in zip(grid, names, strict=True):
        found = sorted(influences(rows, name, case), key=lambda one: one.total[0])
        for up, word, colour in ((0.2, "alone", BASELINE), (-0.2, "total", "#0072b2")):
            shares = np.array([getattr(one, word) for one in found]).reshape(-1, 3) * 100.0
            reach = np.abs(shares[:, 1:] - shares[:, :1]).T
            label = "alone" if word == "alone" else "with all that it acts together with"
            own.barh(
                np.arange(len(found)) + up, shares[:, 0], 0.36, xerr=reach, color=colour, ecolor="0.5", label=label
            )
        own.set_yticks(range(len(found)), [one.path for one in found])
        own.set_title(name if found else f"{name}: it does not vary", fontsize=10, loc="right")
        finish(own, "share of the variance, and its 95 % interval [%]" if own is grid[-1] else "", "")
    legend_above(grid[0])
    return figure


def titled(rows: Swept, case: str) -> str:
    """The title of a picture of one case; a study without cases has one, as it is given."""
    return rows.title if rows.cases == (AS_GIVEN,) else f"{rows.title}: {case}"


def _cross(axes: Axes, x: Floats, y: Floats, sound: Flags, colour: str) -> None:
    """Rows that are not to be trusted."""
    if not sound.all():
        axes.plot(x[~sound], y[~sound], color=colour, **UNTRUSTED)


def _limit(axes: Axes, rows: Swept, name: str, scale: float) -> None:
    if name in rows.limits:
        axes.axhline(scale * rows.limits[name], **LIMIT)


def _limit_named(axes: Axes, rows: Swept, names: Sequence[str]) -> None:
    """The limits of other axes in the legend of these."""
    if names[0] not in rows.limits and set(names) & set(rows.limits):
        axes.plot([], [], **LIMIT)


def _level(axes: Axes, unit: str) -> None:
    """At least a tenth of a decibel of height, so that levels which hardly change look like it."""
    low, high = axes.get_ylim()
    if unit == "dB" and high - low < LEAST_DB:
        axes.set_ylim(0.5 * (low + high - LEAST_DB), 0.5 * (low + high + LEAST_DB))


def _ticks_at(axis: Axis, values: Floats) -> None:
    """Ticks at the values that were run, as many as can be read: cells about the first and the last go beyond them."""
    shown = values[:: -(-len(values) // MOST_TICKS)]
    axis.set_ticks(shown, [f"{value:.4g}" for value in shown])


def edges(values: Floats) -> Floats:
    """The edges of cells about rising values [n + 1]: half-way to the neighbours as the axis shows it, and as far
    beyond the ends.

    >>> edges(np.array([1.0, 2.0, 4.0])).round(3).tolist(), edges(np.array([1.0, 2.0, 3.0, 5.0])).tolist()
    ([0.707, 1.414, 2.828, 5.657], [0.5, 1.5, 2.5, 4.0, 6.0])
    """
    if len(values) < 2:
        half = 0.05 * abs(values[0]) or 0.5
        return np.array([values[0] - half, values[0] + half])
    logarithmic = _logarithmic(values)
    shown = np.log(values) if logarithmic else values
    between = 0.5 * (shown[1:] + shown[:-1])
    found = np.concatenate([[2.0 * shown[0] - between[0]], between, [2.0 * shown[-1] - between[-1]]])
    return np.exp(found) if logarithmic else found


def _logarithmic(values: Floats) -> bool:
    """Whether values are in logarithmic steps, or span more than a decade and a half."""
    steps = np.unique(values)
    even = len(steps) > 2 and steps[0] > 0.0 and np.allclose(np.diff(np.log(steps)), np.log(steps[1] / steps[0]))
    return bool(even or (values.min() > 0.0 and values.max() > WIDE * values.min()))


def number_axis(axes: Axes, values: Floats, *, vertical: bool = False) -> None:
    """A logarithmic axis for values in logarithmic steps, or over more than a decade and a half."""
    if _logarithmic(values):
        logarithmic(axes, float(values.max() / values.min()), vertical=vertical)


def logarithmic(axes: Axes, span: float, *, vertical: bool = False) -> None:
    """A logarithmic axis over a span of largest over smallest, with plain numbers at its ticks."""
    axis = axes.yaxis if vertical else axes.xaxis
    (axes.set_yscale if vertical else axes.set_xscale)("log")
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if span < FEW_DECADES else (1.0,)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def shown_unit(unit: str, values: Floats) -> tuple[float, str]:
    """A factor and the unit that values are drawn in."""
    return in_unit(unit, float(np.nanmax(np.abs(values), initial=0.0)))


def named(name: str, unit: str) -> str:
    """The label of an axis."""
    return f"{name} [{unit}]" if unit else name
