"""How an optimisation went: the best goal over the designs tried, and all designs over each path that was chosen."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from femstruct.arrays import Floats
from femstruct.study.campaign.sought import Found
from femstruct.study.campaign.varied import Listed
from femstruct.view.campaigns.swept_figure import named, number_axis, shown_unit
from femstruct.view.figures.drawing import BASELINE, finish, legend_above, new_figure, panels

HELD, EXCEEDED, BEST = "#0072b2", "#bbbbbb", "#d55e00"


def optimum_figure(found: Found) -> Figure:
    """Designs that hold all limits, those that exceed one, and the best; of what scatters the quantile."""
    rows, search, goal = found.rows, found.search, found.goals
    s, paths = search.samples, range(len(search.designs))
    factor, unit = shown_unit(found.unit, goal)
    label = named(search.goal, unit)
    label += f"\n{100.0 * search.quantile:g} % quantile of {s} samples" if search.over else ""
    figure = new_figure(9.0, 3.6 + 2.7 * len(paths), search.title)
    axes = panels(figure, 1 + len(paths), 1, between=0.65, top=1.15)[:, 0]
    _designs(axes[0], np.arange(1, len(goal) + 1, dtype=np.float64), found, factor)
    count, value = np.array(found.history).T if found.history else np.empty((2, 0))
    axes[0].step(count, factor * value, where="post", color=BASELINE, linewidth=1, label="best so far")
    axes[0].xaxis.set_major_locator(MaxNLocator(integer=True))
    finish(axes[0], "designs tried", label)
    for j, own in zip(paths, axes[1:], strict=True):
        values, told = rows.values[::s, j], ""
        if np.isfinite(values).all():
            scale, told = shown_unit(rows.units[j], values)
            _designs(own, scale * values, found, factor)
            one = search.designs[j]
            if isinstance(one, Listed):
                number_axis(own, scale * values)
            elif one.law == "log-uniform":
                own.set_xscale("log")
        else:  # a list of words or of places
            texts = [one[j] for one in rows.texts[::s]]
            known = list(dict.fromkeys(texts))
            _designs(own, np.array([float(known.index(one)) for one in texts]), found, factor)
            own.set_xticks(range(len(known)), known)
        finish(own, named(rows.paths[j], told), label)
    legend_above(axes[0])
    return figure


def _designs(axes: Axes, x: Floats, found: Found, factor: float) -> None:
    """All designs over one number, the best as a star."""
    goal, held, best = factor * found.goals, found.held, found.best // found.search.samples
    if found.search.limits:
        axes.plot(x[~held], goal[~held], ".", color=EXCEEDED, markersize=4, label="exceeds a limit")
    word = "holds all limits" if found.search.limits else "designs"
    axes.plot(x[held], goal[held], ".", color=HELD, markersize=4, label=word)
    axes.plot(x[best], goal[best], "*", color=BEST, markersize=11, label="best")
