"""Parallel coordinates: a line for each sample or design across an axis for each path and each number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from femstruct.arrays import Floats
from femstruct.files.tables.sweep_tables import case_of_pictures
from femstruct.study.campaign.front import Front
from femstruct.study.campaign.swept import Flags, Swept
from femstruct.view.campaigns.swept_figure import named, number_axis, shown_unit, titled
from femstruct.view.figures.drawing import new_figure

FEWEST: Final = 3  # paths of a sweep, from which on points over each say too little of what acts together
MOST: Final = 4  # numbers of a sweep
LISTED: Final = 8  # values of a path, up to which they are the ticks of its axis
LINES: Final = 1000  # in colour; more cover each other, and take long to draw
OTHER: Final = "#d0d0d0"
MARGIN: Final = 0.04  # of an axis, beyond its values


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
    told = [name for name in names if _spans(rows.of(name, case)[sound])][:MOST]
    if len(several) < FEWEST or not told:
        return None
    axes = [_path(rows, j) for j in several] + [_number(rows, name, case) for name in told]
    whole = sound & np.isfinite([rows.of(name, case) for name in told]).all(axis=0)
    some = np.flatnonzero(whole)[:: -(-int(whole.sum()) // LINES) or 1]
    title = titled(rows, case) + (f" ({len(some)} of {whole.sum()} samples)" if len(some) < whole.sum() else "")
    shown = np.isin(np.arange(len(whole)), some)
    return _drawn(title, axes, len(several), shown, np.zeros_like(shown)) if len(some) else None


def front_parallel(found: Front) -> Figure | None:
    """Designs of a front across what was chosen, goals and limited numbers, coloured by the first goal; the others
    that hold all limits in grey. None for a front of fewer than two designs, and where its goals say it all."""
    search, s = found.search, found.search.samples
    if len(found.members) < 2 or len(search.designs) + len(search.goals) <= FEWEST:
        return None
    axes = [_path(found.rows, j, s) for j in range(len(search.designs))]
    paths = len(axes)
    for one, unit, values in zip(search.goals, found.units, found.goals.T, strict=True):
        factor, shown = shown_unit(unit, values)
        axes.append(Along(named(one.name, shown), factor * values))
    goals = [one.name for one in search.goals]
    for (name, limit), values in zip(search.limits.items(), found.limited.T, strict=True):
        if name in goals:
            continue
        factor, shown = shown_unit(found.rows.unit_of(name), values[found.held])
        axes.append(Along(named(name, shown), factor * values, limit=factor * limit))
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
        return Along(named(rows.paths[j], unit), factor * values, listed=few)
    texts = [one[j] for one in rows.texts[::step]]
    words = tuple(dict.fromkeys(texts))
    return Along(rows.paths[j], np.array([words.index(one) for one in texts], dtype=float), words)


def _number(rows: Swept, name: str, case: str) -> Along:
    factor, unit = shown_unit(rows.unit_of(name), rows.of(name, case))
    limit = rows.limits.get(name)
    return Along(named(name, unit), factor * rows.of(name, case), limit=None if limit is None else factor * limit)


def _drawn(title: str, axes: Sequence[Along], colour: int, strong: Flags, weak: Flags) -> Figure:
    """colour : number of the axis that gives the lines their colour. strong, weak [n] : lines in colour and in grey."""
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
        margin = MARGIN * (np.ptp(scaled) or abs(scaled[0]) or 1.0)
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
