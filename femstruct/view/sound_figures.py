"""Figures of sound: levels over time, rated rooms, maps of pressure, power and directivity, struck bodies."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any, Final

import numpy as np
import scipy
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from acoustics.levels.bands import decibels
from acoustics.levels.rated import RatedRoom
from acoustics.levels.sound_levels import REFERENCE_PA, level_history
from acoustics.open_air.power import Directivity
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.rooms.box_harmonic import PressureMap
from femstruct.arrays import Floats
from femstruct.sound.surfaces import surface_velocity
from femstruct.study.placed_rooms import placed_room
from femstruct.study.results import StudyResult
from femstruct.view.answer_tables import first_drop_place, rating_text
from femstruct.view.console import scaled
from femstruct.view.drawing import (
    COLOURS,
    TOTAL,
    case_colours,
    case_lines,
    finish,
    legend_above,
    mode_lines,
    new_figure,
    panels,
    thin_history,
)
from femstruct.view.spectra import DYNAMIC_RANGE_DB, distinct, numbered_modes, plain_ticks
from femstruct.view.undrawn import no_closed_room, no_levels, no_own_sound, no_rating, no_sound_energy

# ----------------------------------------------------------------------------------------------------------------------
# Figures of sound: levels over time as a meter shows them, and rooms rated by the standards.
# ----------------------------------------------------------------------------------------------------------------------

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
    where = f", source at {place}" if (place := first_drop_place(result)) else ""
    figure = new_figure(11.0, 0.9 + rows * (2.3 + legend), f"Level over time in {room}: A-weighted, Fast{where}")
    grid = panels(figure, rows, columns, between=0.55 + legend, top=0.5 + legend, sharex=True, sharey=True)
    panes: list[Axes] = grid.ravel().tolist()
    loudest = -np.inf
    for axes, receiver in zip(panes, names, strict=False):
        for name, case in cases.items():
            drawn: list[tuple[RoomResponse, str, dict[str, Any]]] = [(case.rooms[room], name, {"linewidth": 1.0})]
            if room in case.heard.total:
                drawn.append((case.heard.total[room], f"{name} with the bodies' own sound", TOTAL))
            for response, case_label, look in drawn:
                for p, one in zip(response.p, response.receivers, strict=True):
                    if one.name == receiver:
                        level = level_history(p, response.dt)
                        x, y = thin_history(response.t, level)
                        largest = float(np.fmax.reduce(level))
                        label = (
                            f"{case_label}: largest {largest:.1f} dB"
                            if np.isfinite(largest)
                            else f"{case_label}: silent"
                        )
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
    shown_levels = [level for one in shown.values() for level in one.bands_db.values() if np.isfinite(level)] or [0.0]
    highest, lowest = max(shown_levels), min(shown_levels)
    floor = 10.0 * np.floor((max(lowest, highest - SHOWN_DB) - 3.0) / 10.0)
    for number, (name, one) in enumerate(shown.items()):
        x = np.arange(len(one.bands_hz), dtype=np.float64) + (number - (len(shown) - 1) / 2) * width
        _draw_levels(axes, one, x, width, label=_label(name, one), bottom=floor, color=colours[name])
        _draw_ensemble(axes, one, x + 0.25 * width)
    _draw_curves(axes, first)
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


def _draw_levels(axes: Axes, one: RatedRoom, x: Floats, width: float, bottom: float, **look: Any) -> None:
    """A bar for the level of each band that is known, with its standard deviation; statistical ones are hatched."""
    levels, spread = (np.array(list(values.values())) for values in (one.bands_db, one.spread_db))
    known = np.isfinite(levels)
    x, levels, spread = x[known], levels[known], spread[known]
    if np.isfinite(spread).any():
        spread = np.where(np.isfinite(spread), spread, 0.0)  # of what is statistical
        look |= {"yerr": spread, "error_kw": {"ecolor": SPREAD, "elinewidth": 0.8}}
    drawn = axes.bar(x, levels - bottom, width, bottom=bottom, **look)
    for band, bar in zip(np.array(one.bands_hz)[known].tolist(), drawn, strict=True):
        if band in one.statistical_hz:
            bar.set(hatch="///", edgecolor="white", linewidth=0.0)


def _draw_ensemble(axes: Axes, one: RatedRoom, x: Floats) -> None:
    """The mean over rooms and places and its interval, in the bands whose level is known."""
    known = np.isfinite(np.array(list(one.bands_db.values())))
    means, low, high = (np.array(list(values.values()))[known] for values in (one.mean_db, one.low_db, one.high_db))
    if np.isfinite(means).any():
        look: dict[str, Any] = {"markersize": 3.6, "color": "black", "elinewidth": 1.6, "capsize": 0.0, "mfc": "white"}
        mean, _, (ends,) = axes.errorbar(x[known], means, yerr=[means - low, high - means], fmt="D", **look)
        ends.set_path_effects(OUTLINED)
        mean.set_zorder(ends.get_zorder() + 0.1)


def _draw_curves(axes: Axes, baseline: RatedRoom) -> None:
    """What the single numbers of the baseline hold its bands against."""
    compared = {symbol: rating for symbol, rating in baseline.curves.items() if rating.curve_db}
    for style, (symbol, rating) in zip(CURVES, compared.items(), strict=False):
        curve, label = list(rating.curve_db.values()), f"{symbol} of the baseline: {rating.curve}"
        look: dict[str, Any] = {"color": "0.2", "linestyle": style, "linewidth": 1.1, "path_effects": OUTLINED}
        axes.plot(np.arange(len(curve)), curve, label=label, **look)


def _label(name: str, rated: RatedRoom) -> str:
    numbers = ", ".join(f"{symbol} {rating_text(one)}" for symbol, one in rated.curves.items())
    return f"{name}: {numbers}" if numbers else name


# ----------------------------------------------------------------------------------------------------------------------
# Maps of the pressure on a plane of a room.
# ----------------------------------------------------------------------------------------------------------------------

MOST: Final = 4
PROMINENT: Final = 6.0  # dB a peak stands above the valleys beside it
SILENCE: Final = 1e-6  # share of the loudest line below which there are no peaks, only rounding
NEAR: Final = 0.02
COLUMNS: Final = 2  # of panes: what is wider cannot be read on paper
PHASES: Final = "Re P / max |P|, red and blue of opposite phase"
RIM: Final = (withStroke(linewidth=2.5, foreground="white"),)  # to be read on any colour


def pressure_maps(result: StudyResult, room: str) -> Figure | None:
    """Pressure on the horizontal plane of a room's first receiver, at the most prominent peaks of the baseline.

    None where `no_pressure_map` says why.
    """
    if no_pressure_map(result, room):
        return None
    case, frequencies = result.cases[result.plan.baseline], receiver_peaks(result, room)
    plan = next(item for item in case.case.study.rooms if item.name == room)
    model = result.models[case.basis_key]
    assert model is not None and case.response is not None
    moving = surface_velocity(case.response, placed_room(plan, model.surfaces))
    height = float(plan.receivers[0].position[2])
    drawn = plan.room.pressure_map(moving, list(frequencies.values()), at=height)
    title = f"{result.plan.baseline}: pressure in {room} at z = {height:g} m"
    return draw_map(drawn, list(frequencies), plan.receivers, title, line_spacing(case.rooms[room]))


def no_pressure_map(result: StudyResult, room: str) -> str:
    """Why there is no map of a room, "" where there is one."""
    return no_closed_room(result, room) or (
        "" if receiver_peaks(result, room) else "no peak stands out of the spectrum"
    )


def receiver_peaks(result: StudyResult, room: str) -> dict[str, float]:
    """The loudest peaks of the baseline's sound at a room's first receiver: names and frequencies [Hz].

    Only those that stand out of what is beside them, and none above the modal basis or the room's own modes, where the
    answer is not complete.
    A peak within 2 % of a mode of the structure carries that mode's number, any other is one of the room's or of the
    force.
    """
    case = result.cases[result.plan.baseline]
    response = case.rooms[room]
    spectrum = np.abs(response.spectrum[0])
    level = 20.0 * np.log10(np.maximum(spectrum, SILENCE * spectrum.max(initial=0.0)) + np.finfo(float).tiny)
    tops, _ = scipy.signal.find_peaks(level, prominence=PROMINENT)
    tops = tops[response.frequency_hz[tops] <= min(case.basis.complete_below_hz, response.complete_below_hz)]
    chosen = np.sort(tops[np.argsort(-level[tops])[:MOST]])
    elastic = np.flatnonzero([kind == "elastic" for kind in case.basis.kind])
    named = {}
    for frequency in response.frequency_hz[chosen].tolist():
        away = np.abs(case.basis.frequency_hz[elastic] / frequency - 1.0)
        near = int(elastic[away.argmin()]) + 1 if elastic.size and away.min() < NEAR else 0
        named[f"mode {near}, {frequency:.1f} Hz" if near else f"{frequency:.1f} Hz"] = frequency
    return named


def line_spacing(response: RoomResponse) -> float:
    """Distance of the lines of a record's spectrum [Hz]."""
    return float(response.frequency_hz[1])


def line_level(size: Floats, apart_hz: float) -> Floats:
    """Levels of lines [dB re 20 uPa] with the magnitude |P| [Pa/Hz] of a record's Fourier transform, as spectra have
    them: the rms of a line is sqrt(2) |P| df.

    >>> float(line_level(np.array([1.0 / np.sqrt(2.0)]), 1.0).round(2)[0])  # 1 Pa
    93.98
    """
    return decibels((np.sqrt(2.0) * apart_hz * size / REFERENCE_PA) ** 2)


def draw_map(
    drawn: PressureMap, names: Sequence[str], receivers: Sequence[Receiver], title: str, apart_hz: float
) -> Figure:
    """A pane a frequency: the pressure in phase with its largest value, red compressed and blue rarefied.

    Parameters
    ----------
    drawn : PressureMap
        Normal to z.
    names : Sequence[str]
        One a frequency. The range of the level over the plane stands above each pane.
    apart_hz : float
        Of the lines that have these levels [Hz].
    """
    count = len(drawn.frequency_hz)
    columns = min(count, COLUMNS)
    rows = -(-count // columns)
    width, height = 1.6 + 3.3 * columns, 0.6 + 3.3 * rows
    figure = new_figure(width, height, f"{title}; levels of lines {apart_hz:.3g} Hz apart\n{PHASES}")
    grid = panels(figure, rows, columns, between=0.9, top=0.95, right=0.85)
    for unused in grid.ravel()[count:]:
        unused.remove()
    images = []
    for axes, spectrum, name in zip(grid.ravel()[:count], drawn.spectrum, names, strict=True):
        level = line_level(np.abs(spectrum), apart_hz)
        level = level[np.isfinite(level)]  # nan outside the room
        largest = spectrum.ravel()[np.nanargmax(np.abs(spectrum))]
        shown = np.real(spectrum / largest) if largest else np.zeros(spectrum.shape)
        half = [0.5 * (along[1] - along[0]) for along in (drawn.first, drawn.second)]  # a pixel is centred on its point
        ends = [(along[0], along[-1]) for along in (drawn.first, drawn.second)]
        sides = np.ravel([(low - by, high + by) for (low, high), by in zip(ends, half, strict=True)]).tolist()
        image = axes.imshow(
            shown.T, origin="lower", extent=sides, cmap="RdBu_r", vmin=-1.0, vmax=1.0, interpolation="bilinear"
        )
        axes.set_xlim(*ends[0])
        axes.set_ylim(*ends[1])
        images.append(image)
        for receiver in receivers:
            axes.plot(*receiver.position[:2], "k+", markersize=9, path_effects=RIM)
            axes.annotate(
                receiver.name, receiver.position[:2], (5, 5), textcoords="offset points", fontsize=8, path_effects=RIM
            )  # fmt: skip
        axes.set_aspect("equal")
        axes.set_title(f"{name}\n{level.min():.0f} to {level.max():.0f} dB re 20 µPa", fontsize=8)
        axes.set_xlabel("x in m")
        axes.tick_params(labelsize=8)
    for axes in grid[:, 0]:
        axes.set_ylabel("y in m")
    scale = figure.add_axes((1.0 - 0.65 / width, 0.6 / height, 0.13 / width, 1.0 - 1.5 / height))
    figure.colorbar(images[-1], cax=scale, ticks=(-1.0, 0.0, 1.0), label="of the largest")
    return figure


# ----------------------------------------------------------------------------------------------------------------------
# Figures of what goes into the open: sound energy by third octaves, sound power over frequency, directivities.
# ----------------------------------------------------------------------------------------------------------------------

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
    where = f", source at {place}" if (place := first_drop_place(result)) else ""
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
    modes = numbered_modes(result.cases[result.plan.baseline].basis)
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
            axes.plot(
                angle,
                shown,
                color=COLOURS[number % len(COLOURS)],
                linewidth=1.3,
                label=_directivity_text(pattern, line),
            )
        figure.text(
            0.255 + 0.49 * circle, 0.04, f"from the normal towards {side}", fontsize=9, ha="center", color="0.3"
        )
    figure.legend(
        *figure.axes[0].get_legend_handles_labels(), fontsize=8, loc="upper left", frameon=False, labelspacing=0.3,
        bbox_to_anchor=(0.05 / width, 1.0 - 0.3 / height), borderaxespad=0.0,
    )  # fmt: skip
    return figure


def _directivity_text(pattern: Directivity, line: int) -> str:
    circle, angle = pattern.loudest(line)
    where = "on the normal" if angle == 0.0 else f"at {angle:+.0f}° towards {pattern.sides[circle]}"
    return (
        f"{pattern.frequency_hz[line]:.4g} Hz, dB re its maximum, {where}: {pattern.index_db[line]:+.1f} dB re the "
        "mean over the half sphere"
    )


# ----------------------------------------------------------------------------------------------------------------------
# The click and the ring: the own sound of striking bodies and the sound of the structure.
# ----------------------------------------------------------------------------------------------------------------------

CLICK: Final = 0.05  # of the largest own pressure, which a click stays above while it lasts
AROUND: Final = 8.0  # clicks shown after the first one
MOST_RECEIVERS: Final = 4  # receivers shown


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
    rows = min(MOST_RECEIVERS, len(own.receivers))
    where = f", source at {place}" if (place := first_drop_place(result)) else ""
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
            x, y = thin_history(1e3 * own.t[shown], factor * p[shown])
            largest, one = scaled("Pa", float(np.abs(p).max()))
            peak = f"{label}: peak {largest * float(np.abs(p).max()):.3g} {one} in the record"
            axes.plot(x, y, color=colour, linestyle=style, linewidth=1.0, label=peak)
        axes.set_xlim(1e3 * own.t[shown][0], 1e3 * own.t[shown][-1])
        finish(axes, "time in ms", f"{receiver.name}: pressure in {unit}")
        legend_above(axes)
    return figure
