"""What every evaluation of a recorded history has in a study file."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated, ClassVar

from femstruct.language.study.window import TimeSpec
from femstruct.language.yaml import Here, Refers, Spec, Text, nearest


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
