"""perception: how strongly people feel a recorded vibration."""

from __future__ import annotations

from femstruct.impact.evaluations.perception import HIGHEST_HZ, SAMPLES, PerceptionRequest, Weighting
from femstruct.language.evaluations.evaluation import EvaluationSpec
from femstruct.language.yaml import Here


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
