"""Figures of vibration over frequency: spectra of recorded velocities, accelerations and net forces in decibels."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.figure import Figure

from acoustics.levels.sound_levels import REFERENCE_PA, level_spectrum
from femstruct.study.result import StudyResult
from femstruct.view.figures.drawing import case_lines, finish, legend_above, mode_lines, new_figure, panels, thinned
from femstruct.view.figures.spectra import DYNAMIC_RANGE_DB, LOWEST_HZ, numbered, plain_ticks, shown_to
from femstruct.view.figures.undrawn import no_spectrum

REFERENCES: Final = {  # what a channel's name ends or begins with: reference of its decibels (SI) and how it is written
    "velocity": (1e-9, "1 nm/s"),
    "acceleration": (1e-6, "1 µm/s²"),
    "net force": (1.0, "1 N"),
}


def spectrum(result: StudyResult, channel: str) -> Figure | None:
    """Lines of a velocity, an acceleration or a net force in all cases, as recorded; None where `no_spectrum`
    says why.

    The rms of each line, so that cases compare line by line. Frequencies end where the modal basis does: above, the
    answer is not complete.
    """
    if no_spectrum(result, channel):
        return None
    reference = next(one for word, one in REFERENCES.items() if channel.endswith(word) or channel.startswith(word))
    cases = {
        name: case for name, case in result.cases.items() if channel in case.channels and case.response is not None
    }
    drawn = case_lines(result.cases, result.plan.baseline)
    basis = result.cases[result.plan.baseline].basis
    modes = numbered(basis)
    clocks = [case.response.clock for case in cases.values() if case.response is not None]
    top = min(shown_to(basis, clock.sampling) for clock in clocks)
    figure = new_figure(11.0, 3.9 + 0.155 * len(cases), f"Spectrum of {channel}   (whole record, no filter)")
    ((axes,),) = panels(figure, 1, 1, between=0.5, top=0.55 + 0.155 * len(cases))
    peak, lowest, low, spacing = -np.inf, np.inf, LOWEST_HZ, 0.0
    for name, case in cases.items():
        assert case.response is not None
        values, sampling = case.channels[channel].values, case.response.clock.sampling
        frequency, level = level_spectrum(values * (REFERENCE_PA / reference[0]), 1.0 / sampling)
        spacing = float(frequency[1])
        low = max(min(LOWEST_HZ, 0.5 * min(modes.values(), default=LOWEST_HZ)), spacing)
        shown = (frequency >= low) & (frequency <= top) & (frequency < 0.5 * sampling)  # the last line is half a line
        x, y = thinned(frequency[shown], level[shown], most=3000)
        axes.semilogx(x, y, **drawn[name], linewidth=0.9, label=name)
        peak = max(peak, float(np.fmax.reduce(level[shown], initial=-np.inf)))
        lowest = min(lowest, float(np.fmin.reduce(level[shown], initial=np.inf)))
    axes.set_xlim(low, top)
    if np.isfinite(peak):
        axes.set_ylim(max(lowest - 6, peak - DYNAMIC_RANGE_DB), peak + 6)
    label = mode_lines(axes, modes, low, top)
    finish(axes, label, f"level of lines {spacing:.3g} Hz apart, dB re {reference[1]}")
    legend_above(axes, up=12)
    plain_ticks(axes)
    return figure
