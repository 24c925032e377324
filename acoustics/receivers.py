"""Receivers: named places in a room or in the open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acoustics.arrays import Floats, freeze, frozen
from acoustics.errors import AcousticsError
from acoustics.tags import stored_as


@stored_as("receiver/1")
@dataclass(frozen=True, eq=False)
class Receiver:
    """A receiver, a point whose pressure is computed: a name and a position [3] from the room's lower corner [m]."""

    name: str
    position: Floats

    def __post_init__(self) -> None:
        freeze(self, position=frozen(f"receiver {self.name}.position", self.position, (3,)))


def positions(receivers: Sequence[Receiver]) -> Floats:
    """Where the receivers are [n, 3] [m].

    Raises AcousticsError when there are none.
    """
    if not receivers:
        raise AcousticsError("receivers", got="none", expected="at least one", do="add a receiver")
    return np.stack([receiver.position for receiver in receivers])
