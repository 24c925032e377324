"""Figures of shock response spectra."""

from __future__ import annotations

from matplotlib.figure import Figure

from femstruct.study.result import StudyResult
from femstruct.view.figures.drawing import case_lines, finish, legend_above, new_figure, panels
from femstruct.view.figures.spectra import plain_ticks


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
