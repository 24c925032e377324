"""Which compiled kernels a simulation needs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from femstruct.impact.batch.batch_march import run_many
from femstruct.impact.collocation.collocation_march import march
from femstruct.impact.compiled.kernels import Unit
from femstruct.impact.compiled.store import kept
from femstruct.impact.engine.sampling import feel
from femstruct.impact.exact.exact_march import exact_march

Units = Sequence[Unit[..., Any]]

BY_COLLOCATION: Final[Units] = (march, feel)
EXACTLY: Final[Units] = (exact_march, feel)
ALL: Final[Units] = (march, feel, exact_march, run_many)


def have(units: Units) -> bool:
    """Whether all of these units are in the store."""
    return all(kept(unit) is not None for unit in units)
