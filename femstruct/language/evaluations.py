"""Evaluations of recorded histories as they are written: what each declares, by its key."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Final

from femstruct.evaluations.evaluation import Evaluation
from femstruct.evaluations.known_evaluations import EVALUATIONS
from femstruct.language.window import TimeSpec
from femstruct.yaml.reader import Here, nearest
from femstruct.yaml.spec import Spec, spec_of


class EvaluationSpec(Spec):
    """What is asked of one recorded motion of a point."""

    def check_in(self, here: Here, records: Mapping[str, Collection[str]], time: TimeSpec | None) -> None:
        """Note what is wrong with its channel, and its keys with the sampling."""
        request: Evaluation | None = here.make(lambda: self.noun(name=""))
        if request is None:
            return
        known = {f"{target} {what}": target for target, quantities in records.items() for what in quantities}
        targets = [target for one, target in known.items() if one.endswith(f" {request.quantity}")]
        expected = f"a recorded {request.quantity}, such as 'record: {{P.z: {request.quantity}}}'"
        do = nearest(request.of, targets)
        here.at("of").need(request.channel in known, f"'{request.of}'", expected, do)
        for one in request.mistakes(None if time is None else time.sampling):
            here.at(*filter(None, (one.where,))).wrong(one.got, one.expected, one.do)


EVALUATION_KINDS: Final[Mapping[str, type[EvaluationSpec]]] = {
    key: spec_of(kind, "", EvaluationSpec) for key, kind in EVALUATIONS.items()
}
