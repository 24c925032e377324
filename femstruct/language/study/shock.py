"""Shock response spectra as they are asked for."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated, Final

from femstruct.impact.result.shock import SAMPLES
from femstruct.language.study.window import TimeSpec
from femstruct.language.yaml import Band, Count, Here, Ratio, Refers, Spec, Text, nearest
from femstruct.study.asked import ShockRequest

SUFFIX: Final = " acceleration"


class ShockSpec(Spec):
    """The largest accelerations of oscillators that stand where an acceleration is recorded: of: POINT.z, their damping
    ratio, the band of their frequencies and how many there are an octave."""

    makes = ShockRequest
    of: Annotated[Text, Refers()]
    damping: Ratio = 0.05
    band: Band
    per_octave: Count = 12

    def check_in(self, here: Here, records: Mapping[str, Collection[str]], time: TimeSpec | None) -> None:
        """Note what is wrong with its channel and band."""
        known = [target for target, wanted in records.items() if "acceleration" in wanted]
        expected = "a recorded acceleration, such as 'record: {P.z: acceleration}'"
        here.at("of").need(self.of in known, f"'{self.of}'", expected, nearest(self.of, known))
        (low, high), there = self.band, here.at("band")
        there.need(0.0 < low < high, f"{low:g} to {high:g} Hz", "a rising band above 0 Hz")
        if time is not None and high > time.sampling / SAMPLES:
            got = f"{high:g} Hz, {time.sampling / high:.3g} samples a period"
            do = f"sample at {SAMPLES * high:g} Hz, or end the band at {time.sampling / SAMPLES:g} Hz"
            there.wrong(got, f"{SAMPLES:g} samples a period or more", do)
