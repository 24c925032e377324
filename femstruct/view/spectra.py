"""Figures over frequency: frequency responses, sound spectra, third octaves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from acoustics.levels.sound_levels import Levels, level_spectrum
from femstruct.arrays import Floats
from femstruct.conventions import GRAVITY
from femstruct.evaluations.shock import ShockRequest, ShockSpectrum
from femstruct.files.tables import OF_EVALUATIONS, doubtful_answers
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady import HarmonicAnswer, RandomAnswer, Vibrated, with_axis
from femstruct.study.asked import per_hertz
from femstruct.study.results import CaseResult, Frf, StudyResult
from femstruct.view.answer_tables import first_drop_place
from femstruct.view.console import digits, scaled
from femstruct.view.drawing import (
    TOTAL,
    case_colours,
    case_lines,
    finish,
    legend_above,
    mode_lines,
    new_figure,
    panels,
    thin_history,
    unit_text,
)

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
    modes = numbered_modes(result.cases[result.plan.baseline].basis)
    mode_lines(above, modes, low, high)
    frequencies = mode_lines(below, modes, low, high, numbers=False)
    finish(above, "", f"|{request.kind}|" + ("" if frf.unit == "1" else f" in {unit_text(frf.unit)}"))
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
    pressures = {name: found for name in result.cases if (found := _pressure(result, name, receiver)) is not None}
    if not pressures:
        return None
    basis = result.cases[result.plan.baseline].basis
    dt, first, _ = next(iter(pressures.values()))
    top = min(max(end for _, _, end in pressures.values()), spectrum_end_hz(basis, 1.0 / dt))
    totals = {name: found for name in pressures if (found := _pressure(result, name, receiver, total=True)) is not None}
    legend = 0.155 * (len(pressures) + len(totals))  # inches
    where = f", source at {place}" if (place := first_drop_place(result)) else ""
    figure = new_figure(11.0, 6.8 + 2 * legend, f"Sound at {receiver}{where}")
    (above,), (below,) = panels(figure, 2, 1, between=0.75 + legend, top=0.55 + legend)
    peak = -np.inf
    for name, (step, p, end), look, after in (
        *((name, found, {"linewidth": 0.9}, "") for name, found in pressures.items()),
        *((name, found, TOTAL, WITH_OWN) for name, found in totals.items()),
    ):
        frequency, level = level_spectrum(p, step)
        shown = (frequency >= LOWEST_HZ) & (frequency <= min(top, end))
        x, y = thin_history(frequency[shown], level[shown], most=3000)
        above.semilogx(x, y, **(drawn[name] | look), label=f"{name}{after}")
        peak = max(peak, float(np.fmax.reduce(level[shown], initial=-np.inf)))
    above.set_xlim(LOWEST_HZ, top)
    if np.isfinite(peak):
        above.set_ylim(peak - DYNAMIC_RANGE_DB, peak + 6)
    label = mode_lines(above, numbered_modes(basis), LOWEST_HZ, top)
    resolution = 1.0 / (dt * len(first))
    finish(above, label, f"level of lines {resolution:.3g} Hz apart, dB re 20 µPa")
    legend_above(above, up=12)
    plain_ticks(above)
    _bands(below, result, receiver)
    return figure


def _level_text(level: Levels) -> str:
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
    shown_levels = [level for row in values.values() for level in row.tolist() if np.isfinite(level)] or [0.0]
    highest = max(shown_levels)
    lowest = max(min(shown_levels), highest - DYNAMIC_RANGE_DB)
    floor = 10.0 * np.floor((lowest - 3.0) / 10.0)
    for number, (name, row) in enumerate(values.items()):
        x = np.arange(len(centres)) + (number - (len(levels) - 1) / 2) * width
        level = levels[name]
        label = f"{name}: {_level_text(level)}"
        here = np.isfinite(row)
        axes.bar(x[here], row[here] - floor, width, bottom=floor, color=colours[name], label=label)
        total = result.cases[name].heard.total_levels.get(receiver)
        if total is not None:
            row = np.array([total.bands_db[centre] for centre in centres])[here]
            x = x[here]
            highest = max(highest, float(np.fmax.reduce(row, initial=0.0)))
            label = f"{name}{WITH_OWN}: {_level_text(total)}"
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


def spectrum_end_hz(basis: ModalBasis, sampling: float) -> float:
    """The highest frequency of a spectrum [Hz]: where the modal basis ends, half the sampling at most.

    An octave above the highest of modes that are given; of bodies alone there is nothing that is left out.
    """
    given = BEYOND_GIVEN * float(basis.frequency_hz.max(initial=0.0))
    return min(basis.complete_below_hz or given or np.inf, 0.5 * sampling)


def numbered_modes(basis: ModalBasis) -> dict[int, float]:
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


# ----------------------------------------------------------------------------------------------------------------------
# Figures of what shakes: shock response spectra, answers to harmonic and random excitations, ranges of fatigue.
# ----------------------------------------------------------------------------------------------------------------------

FAINT: Final = 1e-6  # of the largest amplitude or density: less is rounding, or nobody's concern
PLAIN: Final = 100.0  # between the ends of an axis: below it ticks have plain numbers
BETWEEN: Final = ", "  # an excitation and a channel in the name of a picture


def spectra_of(case: CaseResult) -> Mapping[str, ShockSpectrum]:
    """The shock response spectra of a case, by name."""
    return case.evaluations.get(ShockRequest.key(), {})


def shock_spectra(result: StudyResult, name: str) -> Figure:
    """The largest acceleration of an oscillator over its natural frequency, upwards or downwards, in all cases."""
    drawn = case_lines(result.cases, result.plan.baseline)
    found = {case: spectra_of(item)[name] for case, item in result.cases.items() if name in spectra_of(item)}
    one = next(iter(found.values()))
    title = f"{name}: shock response spectrum of {one.channel}, damping {100 * one.damping_ratio:g} %"
    figure = new_figure(9.0, 4.6, title)
    ((axes,),) = panels(figure, 1, 1, between=0.15, top=0.55 + 0.155 * len(found), left=1.15)
    for case, spectrum in found.items():
        doubtful = doubtful_answers(result.cases[case], ShockRequest.key(), name)
        label = f"{case} ? : do not quote, see {OF_EVALUATIONS}" if doubtful else case
        axes.loglog(spectrum.frequency_hz, spectrum.maximax, **drawn[case], linewidth=1.3, label=label)
    axes.set_xlim(one.frequency_hz[0], one.frequency_hz[-1])
    finish(axes, "natural frequency in Hz", "largest |acceleration| in m/s²")
    legend_above(axes, up=12)
    plain_ticks(axes)
    return figure


def answered(cases: Mapping[str, CaseResult]) -> list[str]:
    """Names of the pictures, EXCITATION, CHANNEL."""
    return list(
        dict.fromkeys(
            f"{name}{BETWEEN}{channel}"
            for case in cases.values()
            for name, one in case.vibration.items()
            for channel in one.answers
        )
    )


def vibration_answer(result: StudyResult, name: str) -> Figure:
    """Amplitude or power spectral density along frequency in all cases, in the unit of the tables, with the modes by
    number and, thin and grey on an axis of its own, what excites."""
    excitation, _, channel = name.partition(BETWEEN)
    drawn = case_lines(result.cases, result.plan.baseline)
    found = {
        case: item.vibration[excitation].answers[channel]
        for case, item in result.cases.items()
        if excitation in item.vibration and channel in item.vibration[excitation].answers
    }
    first = next(iter(found.values()))
    harmonic = isinstance(first, HarmonicAnswer)
    excited = next(item.vibration[excitation] for item in result.cases.values() if excitation in item.vibration)
    title = f"{with_axis(channel, first.unit)}, excited by {excitation} ({excited.kind}, {excited.excited_by})"
    figure = new_figure(9.0, 4.6, title)
    ((axes,),) = panels(figure, 1, 1, between=0.15, top=0.55 + 0.155 * (len(found) + 1), left=1.15, right=1.0)
    factor, unit = scaled(first.unit, max(map(_size, found.values())))
    peak = 0.0
    for case, answer in found.items():
        power = 1 if isinstance(answer, HarmonicAnswer) else 2
        values = factor**power * (np.abs(answer.values) if isinstance(answer, HarmonicAnswer) else answer.psd)
        level = answer.largest if isinstance(answer, HarmonicAnswer) else answer.rms
        label = f"{case}: {'largest' if power == 1 else 'rms'} {digits(factor * level)} {unit}"
        axes.semilogx(answer.frequency_hz, values, **drawn[case], linewidth=1.1, label=label)
        peak = max(peak, float(values.max()))
    if peak > 0.0:  # what cannot move has no logarithm
        lowest = min(float(line.get_ydata().min()) for line in axes.get_lines())
        _decades(axes, max(lowest, FAINT * peak), peak)
    low, high = float(first.frequency_hz[0]), float(first.frequency_hz[-1])
    axes.set_xlim(low, high)
    modes = numbered_modes(result.cases[result.plan.baseline].basis)
    label = mode_lines(axes, modes, low, high, of=" of the baseline" if len(result.cases) > 1 else "")
    shown = unit if harmonic else per_hertz(unit)
    finish(axes, label, f"{'amplitude' if harmonic else 'power spectral density'} in {unit_text(shown)}")
    _excitation(axes, excited)
    legend_above(axes, up=12)
    plain_ticks(axes)
    return figure


def _size(answer: HarmonicAnswer | RandomAnswer) -> float:
    """What the unit of an answer is chosen by, as in the tables."""
    return answer.largest if isinstance(answer, HarmonicAnswer) else answer.peak or answer.rms


def _excitation(axes: Axes, excited: Vibrated) -> None:
    """What excites, on an axis at the right with its unit, and its entry in the legend of the answers."""
    beside = axes.twinx()
    values, unit = excited.excitation, excited.unit
    if unit == per_hertz("m/s^2"):  # as shakers are spoken of
        values, unit = values / GRAVITY**2, "g^2/Hz"
    look: dict[str, Any] = {"color": "0.6", "linewidth": 0.7, "linestyle": "--"}
    beside.semilogx(excited.frequency_hz, values, **look)
    _decades(beside, 0.3 * float(values.min()), 3.0 * float(values.max()))
    beside.set_ylabel(f"excitation in {unit_text(unit)}", color="0.4")
    beside.tick_params(axis="y", which="both", colors="0.4")
    axes.plot([], [], **look, label="excitation, axis at the right")


def _decades(axes: Axes, low: float, high: float) -> None:
    """A logarithmic axis from below `low` to above `high`; over few decades with plain numbers, also between them."""
    axes.set_yscale("log")
    axes.set_ylim(low / 1.5, 1.5 * high)
    if high / low < PLAIN:
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.4g}"))
        axes.yaxis.set_minor_locator(NullLocator())


def range_spectrum(result: StudyResult, name: str) -> Figure:
    """How many cycles have a range of so much or more, in all cases."""
    drawn = case_lines(result.cases, result.plan.baseline)
    found = {case: item.fatigue[name] for case, item in result.cases.items() if name in item.fatigue}
    one = next(iter(found.values()))
    factor, unit = scaled(one.unit, max(cycles.largest for cycles in found.values()))
    figure = new_figure(9.0, 4.6, f"{name}: ranges of {one.channel}, cycles of one record")
    ((axes,),) = panels(figure, 1, 1, between=0.15, top=0.55 + 0.155 * len(found), left=1.15)
    for case, cycles in found.items():
        above = np.cumsum(cycles.counts[::-1])[::-1]
        label = (
            case
            if cycles.damage is None
            else f"{case}: damage {cycles.damage:.3g}{'' if cycles.converged else ' ? (damage-not-converged)'}"
        )
        axes.semilogx(above, factor * cycles.ranges, **drawn[case], drawstyle="steps-post", linewidth=1.2, label=label)
    axes.set_ylim(0.0)
    finish(axes, "cycles with this range or more", f"range in {unit}")
    legend_above(axes, up=12)
    return figure
