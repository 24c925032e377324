"""Figures of what shakes: shock response spectra, answers to harmonic and random excitations, ranges of fatigue."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from femstruct.conventions import GRAVITY
from femstruct.files.tables.finding_tables import OF_EVALUATIONS, doubtful_answers
from femstruct.impact.evaluations.shock import ShockRequest, ShockSpectrum
from femstruct.modal.steady.answers import HarmonicAnswer, RandomAnswer, Vibrated, with_axis
from femstruct.study.result import CaseResult, StudyResult
from femstruct.study.steady_vibration import per_hertz
from femstruct.view.figures.drawing import case_lines, finish, legend_above, mode_lines, new_figure, panels, readable
from femstruct.view.figures.spectra import numbered, plain_ticks
from femstruct.view.tables.scales import digits, scaled

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
        told = answer.largest if isinstance(answer, HarmonicAnswer) else answer.rms
        label = f"{case}: {'largest' if power == 1 else 'rms'} {digits(factor * told)} {unit}"
        axes.semilogx(answer.frequency_hz, values, **drawn[case], linewidth=1.1, label=label)
        peak = max(peak, float(values.max()))
    if peak > 0.0:  # what cannot move has no logarithm
        lowest = min(float(line.get_ydata().min()) for line in axes.get_lines())
        _decades(axes, max(lowest, FAINT * peak), peak)
    low, high = float(first.frequency_hz[0]), float(first.frequency_hz[-1])
    axes.set_xlim(low, high)
    modes = numbered(result.cases[result.plan.baseline].basis)
    label = mode_lines(axes, modes, low, high, of=" of the baseline" if len(result.cases) > 1 else "")
    shown = unit if harmonic else per_hertz(unit)
    finish(axes, label, f"{'amplitude' if harmonic else 'power spectral density'} in {readable(shown)}")
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
    beside.set_ylabel(f"excitation in {readable(unit)}", color="0.4")
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
