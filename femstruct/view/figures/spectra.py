"""Figures over frequency: frequency responses, sound spectra, third octaves."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from acoustics.levels.sound_levels import Levels, level_spectrum
from femstruct.arrays import Floats
from femstruct.modal.basis import ModalBasis
from femstruct.study.result import Frf, StudyResult
from femstruct.view.figures.drawing import (
    TOTAL,
    case_colours,
    case_lines,
    finish,
    legend_above,
    mode_lines,
    new_figure,
    panels,
    readable,
    thinned,
)
from femstruct.view.tables.rated_table import struck_first

DYNAMIC_RANGE_DB: Final = 90.0
LOWEST_HZ: Final = 5.0
WITH_OWN: Final = " with the bodies' own sound"
OVER_BARS: Final = "#d62728"
BEYOND_GIVEN: Final = 2.0  # times the highest of modes that are given, which are complete to no frequency


def frequency_response(result: StudyResult, name: str) -> Figure:
    """Magnitude and phase of a frequency response in all cases, with the modes of the baseline by number.

    Cases whose structure is the same share one line.
    """
    drawn = case_lines(result.cases, result.plan.baseline)
    lines = distinct({case: item.frf[name] for case, item in result.cases.items() if name in item.frf})
    frf = next(iter(lines.values()))
    request = frf.request
    figure = new_figure(9.0, 5.8, f"{name}: {request.kind}, {request.drive} to {request.response}")
    top = 0.55 + 0.155 * len(lines)
    (above,), (below,) = panels(figure, 2, 1, between=0.15, top=top, left=1.15, sharex=True, height_ratios=(2, 1))
    for cases, line in lines.items():
        look, label = drawn[cases[0]], ", ".join(cases)
        size = np.abs(line.values)
        if size.any():
            above.loglog(line.frequency_hz, np.where(size > 0.0, size, np.nan), **look, linewidth=1.1, label=label)
        else:  # nothing joins both ends: 0 has no place on a logarithmic axis
            above.plot([], [], **look, linewidth=1.1, label=f"{label}: 0")
        below.semilogx(line.frequency_hz, np.degrees(np.angle(line.values)), **look, linewidth=1.0)
    low, high = request.band
    low = low or min(request.step, 0.1 * high)  # 0 Hz has no place on a logarithmic axis
    above.set_xlim(low, high)
    below.set_ylim(-190, 190)
    below.set_yticks([-180, -90, 0, 90, 180])
    modes = numbered(result.cases[result.plan.baseline].basis)
    mode_lines(above, modes, low, high)
    frequencies = mode_lines(below, modes, low, high, numbers=False)
    finish(above, "", f"|{request.kind}|" + ("" if frf.unit == "1" else f" in {readable(frf.unit)}"))
    legend_above(above, up=12)
    finish(below, frequencies, "phase in degrees")
    plain_ticks(below)
    return figure


def sound(result: StudyResult, receiver: str) -> Figure | None:
    """Spectrum and third octaves of the pressure at a receiver ("ROOM.NAME") in all cases; None without such receiver.

    Frequencies end where the modal basis or the modes of the room do: above, the answer is not complete. With the
    bodies' own sound a line is thicker and dashed.
    """
    drawn = case_lines(result.cases, result.plan.baseline)
    heard = {name: found for name in result.cases if (found := _pressure(result, name, receiver)) is not None}
    if not heard:
        return None
    basis = result.cases[result.plan.baseline].basis
    dt, first, _ = next(iter(heard.values()))
    top = min(max(end for _, _, end in heard.values()), shown_to(basis, 1.0 / dt))
    totals = {name: found for name in heard if (found := _pressure(result, name, receiver, total=True)) is not None}
    legend = 0.155 * (len(heard) + len(totals))  # inches
    where = f", source at {place}" if (place := struck_first(result)) else ""
    figure = new_figure(11.0, 6.8 + 2 * legend, f"Sound at {receiver}{where}")
    (above,), (below,) = panels(figure, 2, 1, between=0.75 + legend, top=0.55 + legend)
    peak = -np.inf
    for name, (step, p, end), look, after in (
        *((name, found, {"linewidth": 0.9}, "") for name, found in heard.items()),
        *((name, found, TOTAL, WITH_OWN) for name, found in totals.items()),
    ):
        frequency, level = level_spectrum(p, step)
        shown = (frequency >= LOWEST_HZ) & (frequency <= min(top, end))
        x, y = thinned(frequency[shown], level[shown], most=3000)
        above.semilogx(x, y, **(drawn[name] | look), label=f"{name}{after}")
        peak = max(peak, float(np.fmax.reduce(level[shown], initial=-np.inf)))
    above.set_xlim(LOWEST_HZ, top)
    if np.isfinite(peak):
        above.set_ylim(peak - DYNAMIC_RANGE_DB, peak + 6)
    label = mode_lines(above, numbered(basis), LOWEST_HZ, top)
    resolution = 1.0 / (dt * len(first))
    finish(above, label, f"level of lines {resolution:.3g} Hz apart, dB re 20 µPa")
    legend_above(above, up=12)
    plain_ticks(above)
    _bands(below, result, receiver)
    return figure


def _told(level: Levels) -> str:
    known = np.isfinite(level.l_peak_db)
    return f"L_peak {level.l_peak_db:.1f} dB, L_AFmax {level.l_afmax_db:.1f} dB" if known else "silent"


def _bands(axes: Axes, result: StudyResult, receiver: str) -> None:
    colours = case_colours(result.cases, result.plan.baseline)
    levels = {name: case.levels[receiver] for name, case in result.cases.items() if receiver in case.levels}
    if not levels:
        return
    known = [level.bands_db for level in levels.values()]
    centres = [centre for centre in known[0] if any(np.isfinite(one.get(centre, np.nan)) for one in known)]
    width = 0.8 / len(levels)
    values = {name: np.array([one.bands_db.get(c, np.nan) for c in centres]) for name, one in levels.items()}
    heard = [level for row in values.values() for level in row.tolist() if np.isfinite(level)] or [0.0]
    highest = max(heard)
    lowest = max(min(heard), highest - DYNAMIC_RANGE_DB)
    floor = 10.0 * np.floor((lowest - 3.0) / 10.0)
    for number, (name, row) in enumerate(values.items()):
        x = np.arange(len(centres)) + (number - (len(levels) - 1) / 2) * width
        level = levels[name]
        label = f"{name}: {_told(level)}"
        here = np.isfinite(row)
        axes.bar(x[here], row[here] - floor, width, bottom=floor, color=colours[name], label=label)
        total = result.cases[name].heard.total_levels.get(receiver)
        if total is not None:
            row = np.array([total.bands_db[centre] for centre in centres])[here]
            x = x[here]
            highest = max(highest, float(np.fmax.reduce(row, initial=0.0)))
            label = f"{name}{WITH_OWN}: {_told(total)}"
            axes.hlines(row, x - 0.5 * width, x + 0.5 * width, color=OVER_BARS, linewidth=2.0, label=label)
    axes.set_xticks(range(len(centres)), [f"{centre:g}" for centre in centres], fontsize=8)
    axes.set_xlim(-0.6, len(centres) - 0.4)
    axes.set_ylim(floor, highest + 4.0)
    finish(axes, "third octave, nominal centre in Hz", "L_Fmax in dB re 20 µPa")
    legend_above(axes)
    axes.grid(False, axis="x")


def _pressure(
    result: StudyResult, case: str, receiver: str, *, total: bool = False
) -> tuple[float, Floats, float] | None:
    """Sampling interval [s], pressure [nt] [Pa] at ROOM.NAME, of the structure or with the bodies themselves, and where
    it ends [Hz]."""
    for room, response in (result.cases[case].heard.total if total else result.cases[case].rooms).items():
        for row, item in zip(response.p, response.receivers, strict=True):
            if f"{room}.{item.name}" == receiver:
                return response.dt, row, response.complete_below_hz
    return None


def distinct(responses: dict[str, Frf]) -> dict[tuple[str, ...], Frf]:
    """Responses by the cases that share them."""
    groups: list[tuple[list[str], Frf]] = []
    for name, frf in responses.items():
        for names, other in groups:
            if frf.values.shape == other.values.shape and np.array_equal(frf.values, other.values):
                names.append(name)
                break
        else:
            groups.append(([name], frf))
    return {tuple(names): frf for names, frf in groups}


def shown_to(basis: ModalBasis, sampling: float) -> float:
    """The highest frequency of a spectrum [Hz]: where the modal basis ends, half the sampling at most.

    An octave above the highest of modes that are given; of bodies alone there is nothing that is left out.
    """
    given = BEYOND_GIVEN * float(basis.frequency_hz.max(initial=0.0))
    return min(basis.complete_below_hz or given or np.inf, 0.5 * sampling)


def numbered(basis: ModalBasis) -> dict[int, float]:
    """Natural frequencies [Hz] of the elastic modes by their number, counted from 1."""
    return {
        number: float(frequency)
        for number, (frequency, kind) in enumerate(zip(basis.frequency_hz, basis.kind, strict=True), 1)
        if kind == "elastic"
    }


def plain_ticks(axes: Axes) -> None:
    """100 rather than 10^2, and 2 and 5 between the decades."""
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_locator(NullLocator())
