"""How an optimisation went: the best goal over the designs tried, all designs over each path that was chosen, and the
best one beside what it is held against."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from femstruct.arrays import Floats
from femstruct.study.campaign.sought import Found
from femstruct.study.campaign.swept import UNROUNDED
from femstruct.study.campaign.varied import Listed, Scattered
from femstruct.view.campaigns.swept_figure import logarithmic, named, number_axis, shown_unit
from femstruct.view.figures.drawing import BASELINE, finish, legend_above, new_figure, panels

HELD, EXCEEDED, BEST = "#0072b2", "#bbbbbb", "#d55e00"
DASHES: Final = ("--", ":")  # of the case as written and of the baseline
DOTS: Final = (".", "x")  # the same where nothing joins them
MOST: Final = 0.9  # of the designs are always shown
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
    label = named(found.goal_name, unit).replace(UNROUNDED, f"\n{UNROUNDED.strip()}")
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
    values, told = rows.values[:: found.search.samples, j], ""
    if not np.isfinite(values).all():  # a list of words or of places
        assert isinstance(one, Listed)
        texts = [texts[j] for texts in rows.texts[:: found.search.samples]]
        _designs(axes, np.array([float(one.texts.index(text)) for text in texts]), found, factor)
        axes.set_xticks(range(len(one.texts)), list(one.texts))
        axes.set_xlim(-0.5, len(one.texts) - 0.5)
        return rows.paths[j]
    scale, told = shown_unit(rows.units[j], values)
    _designs(axes, scale * values, found, factor)
    if isinstance(one, Listed):
        number_axis(axes, scale * values)
        return named(rows.paths[j], told)
    low, high = scale * one.first, scale * one.second
    if one.law == "log-uniform":
        logarithmic(axes, high / low)
        beside = (high / low) ** (0.5 * MARGIN)
        axes.set_xlim(low / beside, high * beside)
    else:
        beside = 0.5 * MARGIN * (high - low)
        axes.set_xlim(low - beside, high + beside)
    return named(rows.paths[j], told)


def _over_scatter(axes: Axes, j: int, found: Found, factor: float) -> str:
    """The goal of the best design and of what it is held against, sample by sample, over a path that scatters."""
    rows, s, column = found.rows, found.search.samples, len(found.search.designs) + j
    joined = "-" if len(found.search.over) == 1 else ""  # over one of several a line would join what is not beside it
    own = slice(found.best, found.best + s)
    x, y = rows.values[own, column], rows.of(found.goal_name)[own]
    scale, told = shown_unit(rows.units[column], x)
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
    return named(rows.paths[column], told)


def _designs(axes: Axes, x: Floats, found: Found, factor: float) -> None:
    """All designs over one number, the best as a star with its least and largest over what scatters."""
    goal, held, best = factor * found.goals, found.held, found.best // found.search.samples
    if found.search.limits:
        axes.plot(x[~held], goal[~held], ".", color=EXCEEDED, markersize=4, label="exceeds a limit")
    word = "holds all limits" if found.search.limits else "designs"
    if found.search.over:
        word += f", {100.0 * found.search.quantile:g} % quantile of {found.search.samples} samples"
    axes.plot(x[held], goal[held], ".", color=HELD, markersize=4, label=word)
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
    middle = np.quantile(known, [0.5 * (1.0 - MOST), 0.5 * (1.0 + MOST)])
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
