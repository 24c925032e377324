"""A front of designs: two goals as a curve, three as pairs; and how it grew with the designs that were tried."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from femstruct.study.campaign.front import Front
from femstruct.study.campaign.pareto import nondominated
from femstruct.view.campaigns.swept_figure import number_axis, shown_unit
from femstruct.view.figures.drawing import finish, legend_above, new_figure, panels

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
    told = np.array(found.convergence).reshape(-1, 2)
    axes[-1].step(told[:, 0], 100.0 * told[:, 1], where="post", color=MEMBER, marker=".", markersize=4)
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
