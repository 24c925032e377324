"""shock_spectra: what a recorded acceleration does to oscillators that stand where it was recorded."""

from __future__ import annotations

from femstruct.impact.evaluations.shock import SAMPLES, ShockRequest
from femstruct.language.evaluations.evaluation import EvaluationSpec
from femstruct.language.yaml import Band, Count, Here, Ratio


class ShockSpec(EvaluationSpec):
    """The largest accelerations of oscillators that stand where an acceleration is recorded: of: POINT.z, their damping
    ratio, the band of their frequencies and how many there are an octave, by default as many as show a resonance within
    3 % (28 for 5 % of damping)."""

    makes = ShockRequest
    signs = (ShockRequest.key(),)
    damping: Ratio = 0.05
    band: Band
    per_octave: Count | None = None

    def check(self, here: Here) -> None:
        """Note a band that does not rise from above 0 Hz."""
        low, high = self.band
        here.at("band").need(0.0 < low < high, f"{low:g} to {high:g} Hz", "a rising band above 0 Hz")

    def check_sampling(self, here: Here, sampling: float) -> None:
        """Note a band that ends above a tenth of the sampling."""
        high = self.band[1]
        if high > sampling / SAMPLES:
            got = f"{high:g} Hz, {sampling / high:.3g} samples a period"
            do = f"sample at {SAMPLES * high:g} Hz, or end the band at {sampling / SAMPLES:g} Hz"
            here.at("band").wrong(got, f"{SAMPLES:g} samples a period or more", do)
