"""How an optimisation went: the best goal over the designs tried, and all designs over each path that was chosen."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from femstruct.study.campaign.sought import Found
from femstruct.view.campaigns.swept_figure import number_axis, shown_unit
from femstruct.view.figures.drawing import BASELINE, finish, legend_above, new_figure, panels

HELD, EXCEEDED, BEST = "#0072b2", "#bbbbbb", "#d55e00"


def optimum_figure(found: Found) -> Figure:
    """Designs that hold all limits, those that exceed one, and the best; of what scatters the quantile."""
    rows, search, goal, held = found.rows, found.search, found.goals, found.held
    s = search.samples
    numeric = [j for j in range(len(search.designs)) if np.isfinite(rows.values[:, j]).all()]
    factor, unit = shown_unit(found.unit, goal)
    label = f"{search.goal} [{unit}]" if unit else search.goal
    label += f"\n{100.0 * search.quantile:g} % quantile of {s} samples" if search.over else ""
    figure = new_figure(9.0, 3.6 + 2.7 * len(numeric), search.title)
    axes = panels(figure, 1 + len(numeric), 1, between=0.65, top=1.15)[:, 0]
    tried = np.arange(1, len(goal) + 1)
    for own, x in ((axes[0], tried), *((axes[1 + k], rows.values[::s, j]) for k, j in enumerate(numeric))):
        j = None if own is axes[0] else numeric[list(axes).index(own) - 1]
        scale, told = (1.0, "") if j is None else shown_unit(rows.units[j], rows.values[:, j])
        own.plot(scale * x[~held], factor * goal[~held], ".", color=EXCEEDED, markersize=4, label="exceeds a limit")
        own.plot(scale * x[held], factor * goal[held], ".", color=HELD, markersize=4, label="holds all limits")
        best = found.best // s
        own.plot(scale * x[best], factor * goal[best], "*", color=BEST, markersize=11, label="best")
        if j is None:
            count, value = np.array(found.history).T if found.history else np.empty((2, 0))
            own.step(count, factor * value, where="post", color=BASELINE, linewidth=1, label="best so far")
            finish(own, "designs tried", label)
        else:
            number_axis(own, scale * rows.values[:, j])
            finish(own, f"{rows.paths[j]} [{told}]" if told else rows.paths[j], label)
    legend_above(axes[0])
    return figure
