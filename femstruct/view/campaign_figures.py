"""Pictures of campaigns: envelopes of bands, fronts, searches, parallel coordinates, numbers over what varied."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Final

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from acoustics.levels.standards import band_quantity_of
from femstruct.arrays import Floats
from femstruct.files.campaign_tables import case_of_pictures, changing, unchanged
from femstruct.study.campaigns import FEWEST, INDICES, UNROUNDED, Flags, Listed, Scattered, Swept, influences
from femstruct.study.optima import Found, Front, nondominated
from femstruct.view.campaign_answers import in_unit
from femstruct.view.drawing import BASELINE, case_lines, finish, legend_above, new_figure, panels

# ----------------------------------------------------------------------------------------------------------------------
# Spectra of all samples as envelopes: the median of each third octave and the range in which it lies.
# ----------------------------------------------------------------------------------------------------------------------

GROUPS: Final = (("rated", "rated bands"), ("levels", "third octaves"))  # of summary.json, and what they are called
LEVELS: Final = "L_Fmax"  # of the third octaves of a receiver
KEY: Final = "bands_db"
MOST_ROOMS: Final = 4  # rooms and receivers in one picture


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
    return dict(list(found.items())[:MOST_ROOMS])


# ----------------------------------------------------------------------------------------------------------------------
# Numbers of a campaign over what varied: curves over one path, maps over two, points over each of several.
# ----------------------------------------------------------------------------------------------------------------------

AS_GIVEN: Final = "as given"
MOST_CURVES: Final = 6  # numbers in one picture
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

    Parameters
    ----------
    case : str
        Of what shows only one; if none, the baseline or the case in which more numbers change.
    """
    same = unchanged(rows, names)
    case = case or case_of_pictures(rows, names)
    known = [name for name in names if np.isfinite(rows.numbers[:, :, rows.names.index(name)]).any()]
    drawn = ([name for name in known if name not in same] or known)[:MOST_CURVES]
    several = [j for j in range(len(rows.paths)) if len({texts[j] for texts in rows.texts}) > 1]
    numeric = [j for j in several if np.isfinite(rows.values[:, j]).all()]
    if not drawn or not numeric:
        return None
    if len(several) == 1 and rows.method != INDICES:
        return _curves(rows, drawn, numeric[0])
    shown = [name for name in drawn if np.isfinite(rows.of(name, case)).any()]
    shown = ([name for name in changing(rows, names, case) if name in known] or shown)[:MOST_CURVES]
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
        scale, shown = shown_unit(rows.unit_of(name), rows.numbers[:, :, rows.names.index(name)])
        for case, line in case_lines(rows.cases, rows.baseline).items():
            y, sound = scale * rows.of(name, case)[order], rows.trusted(case)[order]
            own.plot(x, np.where(sound, y, np.nan), marker=".", label=case, **line)
            _cross(own, x, y, sound, line["color"])
        _limit(own, rows, name, scale)
        _level(own, shown)
        number_axis(own, x)
        finish(own, axis_label(rows.paths[k], unit) if number == len(names) - 1 else "", axis_label(name, shown))
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
        scale, shown = shown_unit(rows.unit_of(name), rows.of(name, case))
        table = np.full((len(ys), len(xs)), np.nan)
        table[j, i] = np.where(rows.trusted(case), scale * rows.of(name, case), np.nan)
        x, y = (factor * one for (factor, _), one in zip(scales, (xs, ys), strict=True))
        drawn = own.pcolormesh(edges(x), edges(y), table, shading="flat", cmap="viridis")
        bar = figure.colorbar(drawn, ax=own)
        bar.ax.tick_params(labelsize=8)
        blank = "" if np.isfinite(table).all() else " (white: no number)"
        own.set_title(axis_label(name, shown) + blank, fontsize=10, loc="left")
        limit = rows.limits.get(name)
        whole = np.isfinite(table).all() and min(table.shape) > 1
        if limit is not None and whole and table.min() < scale * limit < table.max():
            own.contour(x, y, table, levels=[scale * limit], colors="white", linewidths=1.2)
            own.plot([], [], color="white", linewidth=1.2, label=f"limit {scale * limit:.4g} {shown}".rstrip())
            own.legend(fontsize=8, loc="upper right", facecolor="0.35", labelcolor="white", framealpha=0.8)
        number_axis(own, x)
        number_axis(own, y, vertical=True)
        _ticks_at(own.xaxis, x)
        _ticks_at(own.yaxis, y)
        finish(own, *(axis_label(rows.paths[k], scale[1]) for k, scale in zip(numeric, scales, strict=True)))
    for own in grid[len(names) :]:
        own.set_visible(False)
    return figure


def _points(rows: Swept, names: Sequence[str], numeric: Sequence[int], case: str) -> Figure:
    title = titled(rows, case)
    figure = new_figure(1.3 + 3.0 * len(numeric), 1.1 + 2.4 * len(names), title)
    grid = panels(figure, len(names), len(numeric), between=0.35, top=0.75, sharex="col", sharey="row")
    sound = rows.trusted(case)
    for row, name in enumerate(names):
        scale, shown = shown_unit(rows.unit_of(name), rows.of(name, case))
        for column, k in enumerate(numeric):
            own, (factor, unit) = grid[row, column], shown_unit(rows.units[k], rows.values[:, k])
            x, y = factor * rows.values[:, k], scale * rows.of(name, case)
            own.plot(x[sound], y[sound], ".", color=BASELINE, markersize=4)
            _cross(own, x, y, sound, "#d55e00")
            _limit(own, rows, name, scale)
            _level(own, shown)
            number_axis(own, x)
            last = row == len(names) - 1
            finish(own, axis_label(rows.paths[k], unit) if last else "", axis_label(name, shown) if column == 0 else "")
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


def axis_label(name: str, unit: str) -> str:
    """The label of an axis."""
    return f"{name} [{unit}]" if unit else name


# ----------------------------------------------------------------------------------------------------------------------
# A front of designs: two goals as a curve, three as pairs; and how it grew with the designs that were tried.
# ----------------------------------------------------------------------------------------------------------------------

HELD, EXCEEDED, MEMBER, KNEE = "#8fbbd9", "#cccccc", "#0072b2", "#d55e00"


def front_figure(found: Front) -> Figure:
    """Each pair of goals, and the hypervolume over the designs tried."""
    pairs = list(combinations(range(len(found.units)), 2))
    figure = new_figure(9.0, 1.5 + 3.6 * len(pairs) + 2.3, found.search.title)
    heights = [3.6] * len(pairs) + [1.8]
    axes = panels(figure, len(heights), 1, between=0.65, top=1.35, gridspec_kw={"height_ratios": heights})[:, 0]
    for own, (i, j) in zip(axes, pairs, strict=False):
        _pair(own, found, i, j)
    legend_above(axes[0])
    course = np.array(found.convergence).reshape(-1, 2)
    axes[-1].step(course[:, 0], 100.0 * course[:, 1], where="post", color=MEMBER, marker=".", markersize=4)
    axes[-1].set_xlim(left=0.0)
    finish(axes[-1], "designs tried", "hypervolume\n[% of its box]")
    return figure


def _pair(axes: Axes, found: Front, i: int, j: int) -> None:
    """All designs over two goals; the front of these two alone as a line."""
    scales = [shown_unit(found.units[g], found.goals[:, g]) for g in (i, j)]
    x, y = (factor * found.goals[:, g] for g, (factor, _) in zip((i, j), scales, strict=True))
    member = np.isin(np.arange(found.designs), found.members)
    dots: dict[str, Any] = {"linestyle": "none", "marker": "."}
    if found.search.limits:
        axes.plot(x[~found.held], y[~found.held], color=EXCEEDED, markersize=4, label="exceeds a limit", **dots)
    beaten, word = found.held & ~member, "holds all limits" if found.search.limits else "other designs"
    axes.plot(x[beaten], y[beaten], color=HELD, markersize=4, label=word, **dots)
    axes.plot(x[member], y[member], color=MEMBER, markersize=6, label="front", **dots)
    own = np.flatnonzero(member)
    if len(own):
        line = own[nondominated(found.small[own][:, [i, j]])]
        line = line[np.argsort(x[line])]
        axes.plot(x[line], y[line], color=MEMBER, linewidth=0.9)
    if found.knee is not None:
        axes.plot(x[found.knee], y[found.knee], "*", color=KNEE, markersize=13, label=f"knee: design {found.knee}")
    for k in dict.fromkeys(found.ends.values()):
        right = x[k] > 0.5 * (np.nanmin(x) + np.nanmax(x))
        side: dict[str, Any] = {"ha": "right", "xytext": (-5, 7)} if right else {"ha": "left", "xytext": (7, 3)}
        axes.annotate(f"design {k}", (x[k], y[k]), textcoords="offset points", fontsize=8, color="0.3", **side)
    for values, vertical in ((x, False), (y, True)):
        if np.isfinite(values[found.held]).any():
            number_axis(axes, values[np.isfinite(values)], vertical=vertical)
    goals = [found.search.goals[g] for g in (i, j)]
    words = [f"{one.name} [{unit}]" if unit else one.name for one, (_, unit) in zip(goals, scales, strict=True)]
    if found.search.over:
        words[1] += f"\n{100.0 * found.search.quantile:g} % quantiles of {found.search.samples} samples"
    finish(axes, *words)


# ----------------------------------------------------------------------------------------------------------------------
# How an optimisation went: the best goal over the designs tried, all designs over each path that was chosen, and the
# best one beside what it is held against.
# ----------------------------------------------------------------------------------------------------------------------

HELD_COLOUR, EXCEEDED_COLOUR, BEST = "#0072b2", "#bbbbbb", "#d55e00"
DASHES: Final = ("--", ":")  # of the case as written and of the baseline
DOTS: Final = (".", "x")  # the same where nothing joins them
MOST_DESIGNS: Final = 0.9  # of the designs are always shown
FAR: Final = 1.5  # of the height that these take: others so far beyond are only counted
MARGIN: Final = 0.06  # of the height, and of a range, beside what is shown


def optimum_figure(found: Found) -> Figure:
    """Designs that hold all limits, those that exceed one, and the best with what scatters; lines are the cases that it
    is held against. Of what scatters the quantile; the last panels show it sample by sample."""
    search = found.search
    factor, unit = shown_unit(found.unit, found.goals)
    chosen = search.goal in [one.path for one in search.designs]  # a goal that does not scatter
    over = [] if chosen else [j for j, one in enumerate(search.over) if isinstance(one, Scattered)]
    count = 1 + len(search.designs)
    figure = new_figure(9.0, 3.9 + 2.7 * (count - 1 + len(over)), search.title)
    axes = panels(figure, count + len(over), 1, between=0.65, top=1.5)[:, 0]
    label = axis_label(found.goal_name, unit).replace(UNROUNDED, f"\n{UNROUNDED.strip()}")
    tried = np.arange(1, len(found.goals) + 1, dtype=np.float64)
    _designs(axes[0], tried, found, factor)
    steps, value = np.array(found.history).T if found.history else np.empty((2, 0))
    axes[0].step(steps, factor * value, where="post", color=BASELINE, linewidth=1, label="best so far")
    axes[0].xaxis.set_major_locator(MaxNLocator(integer=True))
    finish(axes[0], "designs tried", label)
    for j, own in enumerate(axes[1:count]):
        finish(own, _over_path(own, j, found, factor), label)
    for j, own in zip(over, axes[count:], strict=True):
        finish(own, _over_scatter(own, j, found, factor), label)
    legend_above(axes[0])
    return figure


def _over_path(axes: Axes, j: int, found: Found, factor: float) -> str:
    """All designs over one path, whose whole range is shown; returns the label of its axis."""
    rows, one = found.rows, found.search.designs[j]
    values, unit = rows.values[:: found.search.samples, j], ""
    if not np.isfinite(values).all():  # a list of words or of places
        assert isinstance(one, Listed)
        texts = [texts[j] for texts in rows.texts[:: found.search.samples]]
        _designs(axes, np.array([float(one.texts.index(text)) for text in texts]), found, factor)
        axes.set_xticks(range(len(one.texts)), list(one.texts))
        axes.set_xlim(-0.5, len(one.texts) - 0.5)
        return rows.paths[j]
    scale, unit = shown_unit(rows.units[j], values)
    _designs(axes, scale * values, found, factor)
    if isinstance(one, Listed):
        number_axis(axes, scale * values)
        return axis_label(rows.paths[j], unit)
    low, high = scale * one.first, scale * one.second
    if one.law == "log-uniform":
        logarithmic(axes, high / low)
        beside = (high / low) ** (0.5 * MARGIN)
        axes.set_xlim(low / beside, high * beside)
    else:
        beside = 0.5 * MARGIN * (high - low)
        axes.set_xlim(low - beside, high + beside)
    return axis_label(rows.paths[j], unit)


def _over_scatter(axes: Axes, j: int, found: Found, factor: float) -> str:
    """The goal of the best design and of what it is held against, sample by sample, over a path that scatters."""
    rows, s, column = found.rows, found.search.samples, len(found.search.designs) + j
    joined = "-" if len(found.search.over) == 1 else ""  # over one of several a line would join what is not beside it
    own = slice(found.best, found.best + s)
    x, y = rows.values[own, column], rows.of(found.goal_name)[own]
    scale, unit = shown_unit(rows.units[column], x)
    order = np.argsort(x)
    word = "best design" if found.feasible else "exceeds limits least"
    axes.plot(scale * x[order], factor * y[order], f"*{joined}", color=BEST, markersize=8, linewidth=1, label=word)
    for one, dashes, dot in zip(found.references, DASHES, DOTS, strict=False):
        if not one.why:
            name = f"{one.name}, as written" if one.chosen else f"{one.name}, the baseline"
            beside = factor * (y - one.less)[order]
            mark = f".{dashes}" if joined else dot
            axes.plot(scale * x[order], beside, mark, color=BASELINE, linewidth=1, markersize=5, label=name)
    axes.legend(fontsize=8, frameon=False)
    return axis_label(rows.paths[column], unit)


def _designs(axes: Axes, x: Floats, found: Found, factor: float) -> None:
    """All designs over one number, the best as a star with its least and largest over what scatters."""
    goal, held, best = factor * found.goals, found.held, found.best // found.search.samples
    if found.search.limits:
        axes.plot(x[~held], goal[~held], ".", color=EXCEEDED_COLOUR, markersize=4, label="exceeds a limit")
    word = "holds all limits" if found.search.limits else "designs"
    if found.search.over:
        word += f", {100.0 * found.search.quantile:g} % quantile of {found.search.samples} samples"
    axes.plot(x[held], goal[held], ".", color=HELD_COLOUR, markersize=4, label=word)
    if found.search.over and np.isfinite(found.ends).all():
        axes.plot([x[best]] * 2, factor * np.array(found.ends), "-", color=BEST, linewidth=1)
    if np.isfinite(goal[best]):
        word = ("best" if found.feasible else "exceeds limits least") + (
            ", least and largest" if found.search.over else ""
        )
        axes.plot(x[best], goal[best], "*", color=BEST, markersize=11, label=word)
    for one, dashes in zip(found.references, DASHES, strict=False):
        if not one.why:
            name = f"{one.name}, as written" if one.chosen else f"{one.name}, the baseline"
            axes.axhline(factor * one.goal, color=BASELINE, linewidth=0.9, linestyle=dashes, label=name)
    _height(axes, goal, factor * np.array([*found.ends, *(one.goal for one in found.references)]))


def _height(axes: Axes, goal: Floats, others: Floats) -> None:
    """The heights that are shown: those of all but a few designs that are far beyond, which are counted."""
    known, others = goal[np.isfinite(goal)], others[np.isfinite(others)]
    if len(known) < 2:
        return
    middle = np.quantile(known, [0.5 * (1.0 - MOST_DESIGNS), 0.5 * (1.0 + MOST_DESIGNS)])
    low, high = min(middle[0], *others), max(middle[1], *others)
    far = FAR * (high - low)
    low, high = (own if abs(own - end) < far else end for own, end in ((known.min(), low), (known.max(), high)))
    low, high = min(low, *others), max(high, *others)
    beside = MARGIN * (high - low) or MARGIN * abs(high) or MARGIN
    axes.set_ylim(low - beside, high + beside)
    beyond = int(((known < low) | (known > high)).sum())
    if beyond:
        words = f"{beyond} design{'s' * (beyond > 1)} beyond this height"
        axes.text(0.995, 1.01, words, transform=axes.transAxes, ha="right", va="bottom", fontsize=8, color="0.4")


# ----------------------------------------------------------------------------------------------------------------------
# Parallel coordinates: a line for each sample or design across an axis for each path and each number.
# ----------------------------------------------------------------------------------------------------------------------

FEWEST_PATHS: Final = 3  # paths of a sweep, from which on points over each say too little of what acts together
MOST_NUMBERS: Final = 4  # numbers of a sweep
LISTED: Final = 8  # values of a path, up to which they are the ticks of its axis
LINES: Final = 1000  # in colour; more cover each other, and take long to draw
OTHER: Final = "#d0d0d0"
AXIS_MARGIN: Final = 0.04  # of an axis, beyond its values


@dataclass(frozen=True, eq=False)
class Along:
    """An axis: its name with the unit, the values [n] of all lines; words : what stands at 0, 1, 2 .. of one of words;
    listed : whether its values are few, and its ticks; limit : a value not to be exceeded."""

    name: str
    values: Floats
    words: tuple[str, ...] = ()
    limit: float | None = None
    listed: bool = False


def swept_parallel(rows: Swept, names: Sequence[str], case: str = "") -> Figure | None:
    """Samples of one case across what varied and some numbers, coloured by the first of them; None for fewer than
    three paths that vary. Rows that are not to be trusted are left out."""
    case = case or case_of_pictures(rows, names)
    several = [j for j in range(len(rows.paths)) if len({texts[j] for texts in rows.texts}) > 1]
    sound = rows.trusted(case)
    changing = [name for name in names if _spans(rows.of(name, case)[sound])][:MOST_NUMBERS]
    if len(several) < FEWEST_PATHS or not changing:
        return None
    axes = [_path(rows, j) for j in several] + [_number(rows, name, case) for name in changing]
    whole = sound & np.isfinite([rows.of(name, case) for name in changing]).all(axis=0)
    some = np.flatnonzero(whole)[:: -(-int(whole.sum()) // LINES) or 1]
    title = titled(rows, case) + (f" ({len(some)} of {whole.sum()} samples)" if len(some) < whole.sum() else "")
    shown = np.isin(np.arange(len(whole)), some)
    return _drawn(title, axes, len(several), shown, np.zeros_like(shown)) if len(some) else None


def front_parallel(found: Front) -> Figure | None:
    """Designs of a front across what was chosen, goals and limited numbers, coloured by the first goal; the others
    that hold all limits in grey. None for a front of fewer than two designs, and where its goals say it all."""
    search, s = found.search, found.search.samples
    if len(found.members) < 2 or len(search.designs) + len(search.goals) <= FEWEST_PATHS:
        return None
    axes = [_path(found.rows, j, s) for j in range(len(search.designs))]
    paths = len(axes)
    for one, unit, values in zip(search.goals, found.units, found.goals.T, strict=True):
        factor, shown = shown_unit(unit, values)
        axes.append(Along(axis_label(one.name, shown), factor * values))
    goals = [one.name for one in search.goals]
    for (name, limit), values in zip(search.limits.items(), found.limited.T, strict=True):
        if name in goals:
            continue
        factor, shown = shown_unit(found.rows.unit_of(name), values[found.held])
        axes.append(Along(axis_label(name, shown), factor * values, limit=factor * limit))
    member = np.isin(np.arange(found.designs), found.members)
    return _drawn(search.title, axes, paths, member, found.held & ~member)


def _spans(values: Floats) -> bool:
    known = values[np.isfinite(values)]
    return bool(known.size and known.min() < known.max())


def _path(rows: Swept, j: int, step: int = 1) -> Along:
    """What varied; words in the order in which they first stand."""
    values = rows.values[::step, j]
    few = len(set(values.tolist())) <= LISTED
    if np.isfinite(values).all():
        factor, unit = shown_unit(rows.units[j], values)
        return Along(axis_label(rows.paths[j], unit), factor * values, listed=few)
    texts = [one[j] for one in rows.texts[::step]]
    words = tuple(dict.fromkeys(texts))
    return Along(rows.paths[j], np.array([words.index(one) for one in texts], dtype=float), words)


def _number(rows: Swept, name: str, case: str) -> Along:
    factor, unit = shown_unit(rows.unit_of(name), rows.of(name, case))
    limit = rows.limits.get(name)
    return Along(axis_label(name, unit), factor * rows.of(name, case), limit=None if limit is None else factor * limit)


def _drawn(title: str, axes: Sequence[Along], colour: int, strong: Flags, weak: Flags) -> Figure:
    """colour : number of the axis that gives the lines their colour.

    Parameters
    ----------
    strong, weak : Flags [n]
        Lines in colour and in grey.
    """
    width = 1.6 + 1.75 * len(axes)
    figure = new_figure(width, 4.6, title)
    left, right, low, high = 0.8 / width, 1.0 - 1.5 / width, 0.05, 0.76
    places = np.linspace(0.0, 1.0, len(axes))
    host = figure.add_axes((left, low, right - left, high - low))
    shown = strong | weak
    heights = np.column_stack(
        [_upright(figure, host, place, one, shown) for place, one in zip(places, axes, strict=True)]
    )
    own = axes[colour].values[strong]
    norm = Normalize(float(own.min()), float(own.max()))
    order = np.argsort(-own, kind="stable")  # the smallest above all others
    lines = np.stack([np.broadcast_to(places, heights.shape), heights], axis=-1)
    thin = 1.2 if strong.sum() < 100 else 0.7
    host.add_collection(LineCollection(list(lines[weak]), colors=OTHER, linewidths=0.4, zorder=1))
    colours = colormaps["viridis"](norm(own[order]))
    host.add_collection(
        LineCollection(list(lines[strong][order]), colors=colours, linewidths=thin, zorder=2, alpha=0.8)
    )
    bar = figure.add_axes((1.0 - 0.95 / width, low, 0.16 / width, high - low))
    figure.colorbar(ScalarMappable(norm, "viridis"), cax=bar).ax.tick_params(labelsize=8)
    bar.set_ylabel(axes[colour].name, fontsize=8)
    host.set_xlim(0.0, 1.0)
    host.set_ylim(0.0, 1.0)
    host.axis("off")
    return figure


def _upright(figure: Figure, host: Axes, place: float, one: Along, shown: Flags) -> Floats:
    """An axis at a place of the picture; the heights of all lines on it [n], from 0 to 1."""
    x, y, width, height = host.get_position().bounds
    own = figure.add_axes((x + place * width, y, 1e-6, height), facecolor="none")
    values = one.values[shown]
    own.set_xticks([])
    if one.words:
        own.set_yticks(range(len(one.words)), [_broken(word) for word in one.words])
        own.set_ylim(-0.5, len(one.words) - 0.5)
    else:
        number_axis(own, values, vertical=True)
        logarithmic = own.get_yscale() == "log"
        scaled = np.log10(values) if logarithmic else values
        margin = AXIS_MARGIN * (np.ptp(scaled) or abs(scaled[0]) or 1.0)
        ends = scaled.min() - margin, scaled.max() + margin
        own.set_ylim(*(10.0**end if logarithmic else end for end in ends))
        if one.listed:
            own.set_yticks(np.unique(values), [f"{value:.4g}" for value in np.unique(values)])
            own.set_yticks([], minor=True)
    own.tick_params(labelsize=8, which="both")
    for label in own.get_yticklabels(which="both"):
        label.set_bbox({"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6})
    if one.limit is not None:
        own.plot(0.0, one.limit, "_", color="#d55e00", markersize=16, markeredgewidth=2, clip_on=True)
    own.set_title(_broken(one.name), fontsize=8, pad=9)
    low, high = (float(end) for end in own.get_ylim())
    if own.get_yscale() == "log":
        return np.asarray((np.log(one.values) - np.log(low)) / (np.log(high) - np.log(low)))
    return np.asarray((one.values - low) / (high - low))


def _broken(name: str) -> str:
    """A name in short lines, broken at its dots and words.

    >>> _broken("contacts.bed on damper.law.stiffness [MN/m]").split(chr(10))
    ['contacts.bed on', 'damper.law.', 'stiffness [MN/m]']
    """
    lines = [""]
    for word in name.replace(".", ". ").split(" "):
        joined = f"{lines[-1]}{'' if lines[-1].endswith('.') or not lines[-1] else ' '}{word}"
        if len(joined) <= 16 or not lines[-1]:
            lines[-1] = joined
        else:
            lines.append(word)
    return "\n".join(lines)
