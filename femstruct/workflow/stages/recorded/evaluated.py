"""What a study asks of recorded histories one by one: shock response spectra, perception, and what others add."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from femstruct.impact.evaluations.known_evaluations import EVALUATIONS
from femstruct.study.recorded import Channel
from femstruct.study.study import Study


def evaluated(study: Study, channels: Mapping[str, Channel]) -> dict[str, dict[str, Any]]:
    """The answers by kind and name; every kind is there, with nothing where nothing is asked or simulated."""
    found: dict[str, dict[str, Any]] = {key: {} for key in EVALUATIONS}
    if study.time is not None:
        for one in study.evaluations:
            found.setdefault(one.key(), {})[one.name] = one.answer(channels[one.channel].values, study.time.sampling)
    return found
