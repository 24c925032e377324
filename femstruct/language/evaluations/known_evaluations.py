"""The kinds of evaluations a study file can ask for, by their keys: every module here that has an `EvaluationSpec` with
`signs` is one, and what other packages add as entry points of the group `femstruct.language.evaluations`."""

from __future__ import annotations

from femstruct.language import evaluations
from femstruct.language.evaluations.evaluation import EvaluationSpec
from femstruct.language.yaml.discovery import kinds_of

KINDS: dict[str, type[EvaluationSpec]] = {kind.signs[0]: kind for kind in kinds_of(evaluations, EvaluationSpec)}
