"""The click and the ring: the own sound of striking bodies and the sound of the structure."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.figure import Figure

from femstruct.study.result import StudyResult
from femstruct.view.figures.drawing import COLOURS, finish, legend_above, new_figure, panels, thinned
from femstruct.view.figures.undrawn import no_own_sound
from femstruct.view.tables.rated_table import struck_first
from femstruct.view.tables.scales import scaled

CLICK: Final = 0.05  # of the largest own pressure, which a click stays above while it lasts
AROUND: Final = 8.0  # clicks shown after the first one
MOST: Final = 4  # receivers shown


def own_sounds(result: StudyResult, room: str) -> Figure | None:
    """First sound at the receivers of a room, of the baseline: of the bodies, of the structure, and in total; None
    where no body has own sound."""
    if no_own_sound(result, room):
        return None
    name = result.plan.baseline
    if room not in result.cases[name].heard.own:
        name = next(name for name, case in result.cases.items() if room in case.heard.own)
    case = result.cases[name]
    own, borne, total = case.heard.own[room], case.rooms[room], case.heard.total[room]
    rows = min(MOST, len(own.receivers))
    where = f", source at {place}" if (place := struck_first(result)) else ""
    left = f" ({len(own.receivers) - rows} more in results.h5)" if len(own.receivers) > rows else ""
    figure = new_figure(11.0, 0.9 + 2.9 * rows, f"First sound in {room}, case {name}{where}{left}")
    grid = panels(figure, rows, 1, between=1.15, top=0.95)
    for (axes,), receiver, own_p, borne_p, total_p in zip(grid, own.receivers, own.p, borne.p, total.p, strict=False):
        loud = np.flatnonzero(np.abs(own_p) >= CLICK * np.abs(own_p).max())
        gaps = np.flatnonzero(np.diff(own.t[loud]) > 1e-3) if loud.size else np.empty(0, dtype=int)
        begin, end = (loud[0], loud[gaps[0] if gaps.size else -1]) if loud.size else (0, len(own.t) - 1)
        lasts = own.t[end] - own.t[begin] + own.dt
        shown = (own.t >= own.t[begin] - lasts) & (own.t <= own.t[begin] + AROUND * lasts)
        factor, unit = scaled("Pa", max(float(np.abs(p[shown]).max(initial=0.0)) for p in (own_p, borne_p, total_p)))
        lines = (
            (borne_p, "the structure radiates", COLOURS[0], "-"),
            (own_p, "the bodies themselves", COLOURS[1], "-"),
            (total_p, "total", "#222222", "--"),
        )
        for p, label, colour, style in lines:
            x, y = thinned(1e3 * own.t[shown], factor * p[shown])
            largest, one = scaled("Pa", float(np.abs(p).max()))
            peak = f"{label}: peak {largest * float(np.abs(p).max()):.3g} {one} in the record"
            axes.plot(x, y, color=colour, linestyle=style, linewidth=1.0, label=peak)
        axes.set_xlim(1e3 * own.t[shown][0], 1e3 * own.t[shown][-1])
        finish(axes, "time in ms", f"{receiver.name}: pressure in {unit}")
        legend_above(axes)
    return figure
