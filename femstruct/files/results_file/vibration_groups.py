"""Answers to harmonic and random excitations, and cycles of fatigue, in the results file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from femstruct.files.results_file.datasets import axis, group, put
from femstruct.files.tables.described import write_described
from femstruct.impact.result.fatigue import Fatigue
from femstruct.modal.steady.answers import HarmonicAnswer, Vibrated
from femstruct.study.steady_vibration import per_hertz

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py


def write_vibration(target: h5py.Group, found: Mapping[str, Vibrated]) -> None:
    """A group for every excitation: its spectrum, and a dataset for every answer along frequency."""
    for name, one in found.items():
        place = group(target, name, "One excitation")
        write_described(place, one)
        frequency = axis(place, "frequency_hz", one.frequency_hz, "Hz", "Frequency, lines as dense as resonances need")
        put(place, "excitation", one.excitation, one.unit, "What excites", (frequency,))
        answers = group(place, "answers", "What answers, by channel")
        answers["frequency_hz"] = place["frequency_hz"]
        for channel, answer in one.answers.items():
            where = {"where": answer.where or None}
            if isinstance(answer, HarmonicAnswer):
                most = {"largest": answer.largest, "largest_at_hz": answer.largest_at_hz, **where}
                put(answers, channel, answer.values, answer.unit, "Amplitude, exp(+j omega t)", (frequency,), most)
                continue
            counted = {"zero_upcrossings_hz": answer.crossings, "expected_peak": answer.peak}
            numbers = {"rms": answer.rms, **counted, **where}
            about = "Power spectral density, one-sided"
            put(answers, channel, answer.psd, per_hertz(answer.unit), about, (frequency,), numbers)
        if one.base is not None:
            moved = group(place, "base", "What of the structure a base moves")
            axis(moved, "mode", np.arange(1, len(one.base.mass) + 1), "1", "Mode number")
            write_described(moved, one.base)


def write_fatigue(target: h5py.Group, found: Mapping[str, Fatigue]) -> None:
    """A group for every channel that is counted: cycles by range, for tables and pictures; `damage` is that of the
    ranges themselves."""
    for name, one in found.items():
        place = group(target, name, "Rainflow cycles, ASTM E1049-85")
        write_described(place, one)
        about = "Upper end of the class of ranges; damage from these is too high, the attribute damage is exact"
        ranges = axis(place, "range", one.ranges, one.unit, about)
        put(place, "counts", one.counts, "1", "Cycles, halves among them", (ranges,))
