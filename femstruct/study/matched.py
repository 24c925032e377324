"""What was measured beside what a fit computes for it, as tables and pictures show it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats, freeze, frozen
from femstruct.errors import InputError

MeasuredKind = Literal["history", "modes", "frf", "levels"]


@dataclass(frozen=True, eq=False)
class Beside:
    """Measured beside computed numbers [n] of one kind, real or complex, in `unit`.

    along [n] : time [s], frequency or band [Hz], or the number of the measured mode, from 1. scatter [n] : the standard
    deviation that was taken, in `unit`. notes [n] : what belongs to a number, such as the partner of a mode; empty for
    none.

    >>> modes = Beside("modes", "floor.csv", "Hz", [1.0], [20.0], [21.0], [0.2], ("mode 4",))
    >>> float((modes.computed / modes.measured)[0])
    1.05
    """

    kind: MeasuredKind
    name: str
    unit: str
    along: Floats
    measured: NDArray[Any]
    computed: NDArray[Any]
    scatter: Floats
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        along = frozen("Beside along", self.along, (None,))
        freeze(self, along=along, scatter=frozen("Beside scatter", self.scatter, along.shape))
        for name in ("measured", "computed"):
            values = np.array(getattr(self, name))
            if values.shape != along.shape:
                raise InputError(f"Beside {name}", got=f"shape {values.shape}", expected=f"{along.shape}")
            values.flags.writeable = False
            freeze(self, **{name: values})
