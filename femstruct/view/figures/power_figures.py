"""Figures of what goes into the open: sound energy by third octaves, sound power over frequency, directivities."""

from __future__ import annotations

from math import isfinite
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from acoustics.levels.decibels import decibels
from acoustics.open_air.directivity import Directivity
from femstruct.study.result import StudyResult
from femstruct.view.figures.drawing import COLOURS, case_colours, finish, legend_above, mode_lines, new_figure, panels
from femstruct.view.figures.spectra import DYNAMIC_RANGE_DB, distinct, numbered, plain_ticks
from femstruct.view.figures.undrawn import no_sound_energy
from femstruct.view.tables.rated_table import struck_first

FLOOR_DB: Final = -40.0  # of a directivity
REFERENCE_W: Final = 1e-12
NOT_RADIATED: Final = "the baseline radiates nothing there"
LEAST_EFFICIENCY_SHOWN: Final = 1e-4  # radiation efficiency below which no more is drawn


def sound_energy(result: StudyResult, room: str) -> Figure | None:
    """Sound energy levels and radiation efficiencies by third octaves in all cases; None if nothing radiates there.

    Bands end where the modal basis does.
    """
    cases = {name: case.radiated[room].energy for name, case in result.cases.items() if room in case.radiated}
    if no_sound_energy(result, room):
        return None
    colours = case_colours(result.cases, result.plan.baseline)
    bands = [
        band
        for band in next(iter(cases.values())).bands_hz
        if any(isfinite(energy.bands_db.get(band, -np.inf)) for energy in cases.values())
    ]
    legend = 0.155 * len(cases)
    where = f", source at {place}" if (place := struck_first(result)) else ""
    figure = new_figure(11.0, 6.8 + legend, f"Sound energy into {room}{where}")
    (above,), (below,) = panels(figure, 2, 1, between=0.75, top=0.55 + legend)
    known = {name: np.array([e.bands_db.get(band, -np.inf) for band in bands]) for name, e in cases.items()}
    levels = {name: np.where(np.isnan(row), -np.inf, row) for name, row in known.items()}
    highest = max(float(row.max()) for row in levels.values())
    lowest = min(float(row[np.isfinite(row)].min(initial=highest)) for row in levels.values())
    floor = 10.0 * np.floor((max(lowest, highest - DYNAMIC_RANGE_DB) - 3.0) / 10.0)
    width = 0.8 / len(cases)
    for number, (name, energy) in enumerate(cases.items()):
        x = np.arange(len(bands)) + (number - (len(cases) - 1) / 2) * width
        radiates = isfinite(energy.level_db)
        levels_of = f"L_J {energy.level_db:.1f} dB, L_JA {energy.weighted_db:.1f} dB" if radiates else "nothing"
        label = f"{name}: {levels_of}"
        above.bar(x, np.maximum(levels[name] - floor, 0.0), width, bottom=floor, color=colours[name], label=label)
        efficiency = np.array([energy.bands_efficiency.get(band, np.nan) for band in bands])
        shown = np.where(efficiency > LEAST_EFFICIENCY_SHOWN, efficiency, np.nan)
        below.semilogy(np.arange(len(bands)), shown, "o-", color=colours[name], markersize=4, linewidth=1.0)
    below.axhline(1.0, color="0.6", linewidth=0.8)
    for axes in (above, below):
        axes.set_xticks(range(len(bands)), [f"{band:g}" for band in bands], fontsize=8)
        axes.set_xlim(-0.6, len(bands) - 0.4)
    above.set_ylim(floor, highest + 4.0)
    finish(above, "", "L_J in dB re 1 pJ")
    legend_above(above)
    above.grid(False, axis="x")
    finish(below, "third octave, nominal centre in Hz", "radiation efficiency")
    _plain(below)
    return figure


def sound_power(result: StudyResult, name: str) -> Figure:
    """Sound power per force, beside the input power of the force, and the radiation efficiency, over frequency.

    Cases whose answer is the same share one line.
    """
    colours = case_colours(result.cases, result.plan.baseline)
    lines = distinct({case: item.frf[name] for case, item in result.cases.items() if name in item.frf})
    request = next(iter(lines.values())).request
    per = "(N m)²" if request.drive.what.startswith("r") else "N²"
    figure = new_figure(9.0, 5.8, f"{name}: sound power, {request.drive} to {request.response.name}")
    (above,), (below,) = panels(
        figure, 2, 1, between=0.15, top=0.55 + 0.155 * (len(lines) + 1), left=1.0, right=0.3, sharex=True,
        height_ratios=(2, 1),
    )  # fmt: skip
    peak, least = -np.inf, np.inf
    for cases, line in lines.items():
        if line.sound is None:
            continue
        colour, label = colours[cases[0]], ", ".join(cases)
        level = _level(line.sound.power)
        above.semilogx(line.frequency_hz, level, color=colour, linewidth=1.1, label=label)
        above.semilogx(line.frequency_hz, _level(line.sound.put_in), ":", color=colour, linewidth=0.9)
        below.loglog(
            line.frequency_hz, np.maximum(line.sound.efficiency, LEAST_EFFICIENCY_SHOWN), color=colour, linewidth=1.0
        )
        least = min(least, float(np.fmin.reduce(level)))
        peak = max(peak, float(np.fmax.reduce(level)), float(np.fmax.reduce(_level(line.sound.put_in))))
    above.plot([], [], ":", color="0.3", label="input power of the force")
    low, high = request.band
    above.set_xlim(low, high)
    if isfinite(peak):
        above.set_ylim(max(least - 6, peak - DYNAMIC_RANGE_DB), peak + 6)
    below.axhline(1.0, color="0.6", linewidth=0.8)
    modes = numbered(result.cases[result.plan.baseline].basis)
    mode_lines(above, modes, low, high)
    label = mode_lines(below, modes, low, high, numbers=False)
    finish(above, "", f"L_W in dB re 1 pW/{per}")
    legend_above(above, up=12)
    finish(below, label, "radiation efficiency")
    plain_ticks(below)
    _plain(below)
    return figure


def _plain(axes: Axes) -> None:
    """0.1 rather than 10^-1 along y, and 2 and 5 between the decades."""
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(NullLocator())


def _level(power: Any) -> Any:
    return decibels(power / REFERENCE_W)


def room_directivity(result: StudyResult, room: str) -> Figure | None:
    """Where the baseline's sound energy in a room goes at the frequencies asked for, or at the loudest ones."""
    if no_room_directivity(result, room):
        return None
    pattern = result.cases[result.plan.baseline].radiated[room].pattern
    return _polar(pattern, f"Directivity of the sound into {room}", result)


def no_room_directivity(result: StudyResult, room: str) -> str:
    """Why there is no directivity of a room, "" where there is one."""
    radiated = result.cases[result.plan.baseline].radiated.get(room)
    return NOT_RADIATED if radiated is None or not _lines(radiated.pattern) else ""


def power_directivity(result: StudyResult, name: str) -> Figure | None:
    """Where the sound of a harmonic force goes, in the baseline."""
    frf = result.cases[result.plan.baseline].frf.get(name)
    if frf is None or frf.sound is None or no_power_directivity(result, name):
        return None
    title = f"{name}: directivity, {frf.request.drive} to {frf.request.response.name}"
    return _polar(frf.sound.pattern, title, result)


def no_power_directivity(result: StudyResult, name: str) -> str:
    """Why there is no directivity of a harmonic force, "" where there is one."""
    frf = result.cases[result.plan.baseline].frf.get(name)
    return NOT_RADIATED if frf is None or frf.sound is None or not _lines(frf.sound.pattern) else ""


def _lines(pattern: Directivity) -> list[int]:
    """The frequencies at which something radiates, by their numbers."""
    return [line for line in range(len(pattern.frequency_hz)) if pattern.pressure[line].max() > 0]


def _polar(pattern: Directivity, title: str, result: StudyResult) -> Figure:
    lines = _lines(pattern)
    case = f" in '{result.plan.baseline}'" if len(result.cases) > 1 else ""
    legend = 0.17 * len(lines)
    figure = new_figure(10.0, 3.3 + legend, f"{title}{case}")
    width, height = figure.get_size_inches()
    angle, level = np.radians(pattern.angle_deg), pattern.level_db
    for circle, side in enumerate(pattern.sides):
        # Half of the square that polar axes keep for a circle is empty: it may reach beyond the figure.
        size = 0.43 * width / height
        axes = figure.add_axes((0.04 + 0.49 * circle, 0.13 - size / 4, 0.43, size), projection="polar")
        assert isinstance(axes, PolarAxes)
        axes.set_theta_zero_location("N")
        axes.set_theta_direction(-1)
        axes.set_thetamin(-90.0)
        axes.set_thetamax(90.0)
        axes.set_ylim(FLOOR_DB, 0.0)
        rings = np.arange(FLOOR_DB, 1.0, 10.0)
        axes.set_yticks(rings, ["" if ring in (0.0, FLOOR_DB) else f"{ring:g} dB" for ring in rings])
        axes.tick_params("y", labelsize=7, labelcolor="0.4")
        axes.set_rlabel_position(-90.0)
        axes.set_xticks(np.radians(np.arange(-90, 91, 30)), ["", "-60°", "-30°", "0°", "+30°", "+60°", ""])
        axes.tick_params("x", labelsize=8)
        axes.grid(True, color="0.85", linewidth=0.6)
        for number, line in enumerate(lines):
            shown = np.maximum(level[line, circle], FLOOR_DB)
            axes.plot(angle, shown, color=COLOURS[number % len(COLOURS)], linewidth=1.3, label=_told(pattern, line))
        figure.text(
            0.255 + 0.49 * circle, 0.04, f"from the normal towards {side}", fontsize=9, ha="center", color="0.3"
        )
    figure.legend(
        *figure.axes[0].get_legend_handles_labels(), fontsize=8, loc="upper left", frameon=False, labelspacing=0.3,
        bbox_to_anchor=(0.05 / width, 1.0 - 0.3 / height), borderaxespad=0.0,
    )  # fmt: skip
    return figure


def _told(pattern: Directivity, line: int) -> str:
    circle, angle = pattern.loudest(line)
    where = "on the normal" if angle == 0.0 else f"at {angle:+.0f}° towards {pattern.sides[circle]}"
    return (
        f"{pattern.frequency_hz[line]:.4g} Hz, dB re its maximum, {where}: {pattern.index_db[line]:+.1f} dB re the "
        "mean over the half sphere"
    )
