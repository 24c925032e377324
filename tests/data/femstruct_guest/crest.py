"""How far the peak of a velocity stands above its root mean square."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.evaluations.evaluation import Evaluation, Of
from femstruct.reported import Held, Reported
from femstruct.tags import stored_as


@stored_as("femstruct_guest: crest factor/1")
@dataclass(frozen=True)
class Crest:
    """Crest factor of a history."""

    table: ClassVar = Held("Crest factors", "One crest factor", key="crest_factors")
    rms: Annotated[float, Reported("m/s", "Root mean square")]
    factor: Annotated[float, Reported("1", "Peak over the root mean square", symbol="crest factor")]


@stored_as("femstruct_guest: crest factor request/1")
@dataclass(frozen=True)
@checked("crest_factors")
class CrestRequest(Evaluation):
    """The peak of a recorded velocity over its root mean square, of: POINT.z."""

    gives: ClassVar = Crest
    name: str
    of: Of

    @property
    def quantity(self) -> Literal["velocity"]:
        """It takes velocities."""
        return "velocity"

    def answer(self, values: Floats, sampling: float) -> Crest:
        """Of all samples."""
        rms = float(np.sqrt(np.mean(values**2)))
        return Crest(rms, float(np.abs(values).max()) / rms)
