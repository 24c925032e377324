"""Evaluations of recorded histories as they are written, and what other packages add."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated, ClassVar

from femstruct.evaluations.perception import HIGHEST_HZ, SAMPLES, PerceptionRequest, Weighting
from femstruct.evaluations.shock import SAMPLES as SHOCK_SAMPLES
from femstruct.evaluations.shock import ShockRequest
from femstruct.language.window import TimeSpec
from femstruct.quantities import Band, Ratio
from femstruct.yaml.reader import Here, nearest
from femstruct.yaml.spec import Count, Refers, Spec, Text

# ----------------------------------------------------------------------------------------------------------------------
# What every evaluation of a recorded history has in a study file.
# ----------------------------------------------------------------------------------------------------------------------


class EvaluationSpec(Spec):
    """What is asked of one recorded motion of a point, of: POINT.z.

    makes : the evaluation. signs : its key in the study file, that of the evaluation.
    """

    signs: ClassVar[tuple[str, ...]] = ()
    of: Annotated[Text, Refers()]

    def check_in(self, here: Here, records: Mapping[str, Collection[str]], time: TimeSpec | None) -> None:
        """Note what is wrong with its channel, and its keys with the sampling."""
        self.check(here)
        channel = self.noun(name="").channel
        known = {f"{target} {what}": target for target, wanted in records.items() for what in wanted}
        quantity = channel.rpartition(" ")[2]
        targets = [target for one, target in known.items() if one.endswith(f" {quantity}")]
        expected = f"a recorded {quantity}, such as 'record: {{P.z: {quantity}}}'"
        here.at("of").need(channel in known, f"'{self.of}'", expected, nearest(self.of, targets))
        if time is not None:
            self.check_sampling(here, time.sampling)

    def check_sampling(self, here: Here, sampling: float) -> None:
        """Note what the sampling [Hz] is too low for."""


# ----------------------------------------------------------------------------------------------------------------------
# perception: how strongly people feel a recorded vibration.
# ----------------------------------------------------------------------------------------------------------------------


class PerceptionSpec(EvaluationSpec):
    """How strongly people feel a recorded motion, of: POINT.z. weighting: KB of a velocity (DIN 4150-2); of an
    acceleration Wk (vertical) or Wd (horizontal) of ISO 2631-1, or Wm of ISO 2631-2."""

    makes = PerceptionRequest
    signs = (PerceptionRequest.key(),)
    weighting: Weighting

    def check_sampling(self, here: Here, sampling: float) -> None:
        """Note a sampling that is too low for the weighting's filters."""
        least = SAMPLES * HIGHEST_HZ
        got, do = f"a sampling of {sampling:g} Hz", f"write 'sampling: {least:g} Hz' or more under 'time'"
        here.need(sampling >= least, got, f"{least:g} Hz or more for weightings up to {HIGHEST_HZ:g} Hz", do)


# ----------------------------------------------------------------------------------------------------------------------
# shock_spectra: what a recorded acceleration does to oscillators that stand where it was recorded.
# ----------------------------------------------------------------------------------------------------------------------


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
        if high > sampling / SHOCK_SAMPLES:
            got = f"{high:g} Hz, {sampling / high:.3g} samples a period"
            do = f"sample at {SHOCK_SAMPLES * high:g} Hz, or end the band at {sampling / SHOCK_SAMPLES:g} Hz"
            here.at("band").wrong(got, f"{SHOCK_SAMPLES:g} samples a period or more", do)
