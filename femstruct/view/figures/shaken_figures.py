"""Figures of what shakes: shock response spectra, answers to harmonic and random excitations, ranges of fatigue."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from femstruct.modal.steady.answers import HarmonicAnswer, with_axis
from femstruct.study.result import CaseResult, StudyResult
from femstruct.study.steady_vibration import per_hertz
from femstruct.view.figures.drawing import case_lines, finish, legend_above, mode_lines, new_figure, panels, readable
from femstruct.view.figures.spectra import numbered, plain_ticks
from femstruct.view.tables.scales import scaled

BETWEEN: Final = ", "  # an excitation and a channel in the name of a picture


def shock_spectra(result: StudyResult, name: str) -> Figure:
    """The largest acceleration of an oscillator over its natural frequency, upwards or downwards, in all cases."""
    drawn = case_lines(result.cases, result.plan.baseline)
    found = {case: item.shock[name] for case, item in result.cases.items() if name in item.shock}
    one = next(iter(found.values()))
    title = f"{name}: shock response spectrum of {one.channel}, damping {100 * one.damping_ratio:g} %"
    figure = new_figure(9.0, 4.6, title)
    ((axes,),) = panels(figure, 1, 1, between=0.15, top=0.55 + 0.155 * len(found), left=1.15)
    for case, spectrum in found.items():
        axes.loglog(spectrum.frequency_hz, spectrum.maximax, **drawn[case], linewidth=1.3, label=case)
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
    """Amplitude or power spectral density along frequency in all cases, with the modes of the baseline by number."""
    excitation, _, channel = name.partition(BETWEEN)
    drawn = case_lines(result.cases, result.plan.baseline)
    found = {
        case: item.vibration[excitation].answers[channel]
        for case, item in result.cases.items()
        if excitation in item.vibration and channel in item.vibration[excitation].answers
    }
    first = next(iter(found.values()))
    excited = next(item.vibration[excitation] for item in result.cases.values() if excitation in item.vibration)
    figure = new_figure(
        9.0, 4.6, f"{with_axis(channel, first.unit)}, excited by {excitation} ({excited.kind}, {excited.excited_by})"
    )
    ((axes,),) = panels(figure, 1, 1, between=0.15, top=0.55 + 0.155 * len(found), left=1.15)
    for case, answer in found.items():
        if isinstance(answer, HarmonicAnswer):
            values, label = np.abs(answer.values), f"{case}: largest {answer.largest:.4g} {readable(answer.unit)}"
        else:
            values, label = answer.psd, f"{case}: rms {answer.rms:.4g} {readable(answer.unit)}"
        axes.semilogx(answer.frequency_hz, values, **drawn[case], linewidth=1.1, label=label)
        axes.set_yscale("log" if (values > 0.0).any() else axes.get_yscale())  # what cannot move has no logarithm
    low, high = float(first.frequency_hz[0]), float(first.frequency_hz[-1])
    axes.set_xlim(low, high)
    label = mode_lines(axes, numbered(result.cases[result.plan.baseline].basis), low, high)
    harmonic = isinstance(first, HarmonicAnswer)
    unit = readable(first.unit if harmonic else per_hertz(first.unit))
    finish(axes, label, f"{'amplitude' if harmonic else 'power spectral density'} in {unit}")
    legend_above(axes, up=12)
    plain_ticks(axes)
    return figure


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
