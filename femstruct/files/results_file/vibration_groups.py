"""What answers harmonic and random excitations, in the results file: one table along frequency for all channels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from femstruct.files.results_file.datasets import put
from femstruct.modal.steady.answers import HarmonicAnswer, RandomAnswer
from femstruct.study.recorded import DAMPED_FORCE
from femstruct.study.steady_vibration import per_hertz

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py


FORCES: Final = f", {DAMPED_FORCE}"


def write_answers(target: h5py.Group, answers: Mapping[str, HarmonicAnswer | RandomAnswer]) -> None:
    """A dataset for every answer to one excitation, along the frequencies of that, which stand in the group around."""
    target["frequency_hz"] = target.parent["frequency_hz"]
    for channel, answer in answers.items():
        where = {"where": answer.where or None}
        if isinstance(answer, HarmonicAnswer):
            most = {"largest": answer.largest, "largest_at_hz": answer.largest_at_hz, **where}
            about = f"Amplitude, exp(+j omega t){FORCES if channel.endswith(' force') else ''}"
            put(target, channel, answer.values, answer.unit, about, ("frequency_hz",), most)
            continue
        numbers = {"rms": answer.rms, "zero_upcrossings_hz": answer.crossings, "expected_peak": answer.peak, **where}
        about = f"Power spectral density, one-sided{FORCES if channel.endswith(' force') else ''}"
        put(target, channel, answer.psd, per_hertz(answer.unit), about, ("frequency_hz",), numbers)
