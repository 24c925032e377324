"""What a kind of constraint offers: which places it is about, and the equations between them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from femstruct.conventions import DIRECTIONS
from femstruct.model.fastened import Tie
from femstruct.model.region import Region

if TYPE_CHECKING:
    from femstruct.model.grid.layout import Layout
    from femstruct.model.model import Model
    from femstruct.model.structure import PlaceOn

_IN_PLANE = 1e-6  # of a unit vector: less is rounding


class Constraint(ABC):
    """Homogeneous linear equations between places of parts, by name; the base of all kinds."""

    name: str

    @abstractmethod
    def holds(self) -> Mapping[str, tuple[str, ...]]:
        """The points it is about, and in which directions."""

    def region(self) -> tuple[str, Region] | None:
        """The part whose region it is about, and the region; None where it is about points alone."""
        return None

    @abstractmethod
    def tie(self, model: Model, tolerance: float) -> Tie:
        """Its equations. The force is the one on what follows, or on the ground where the equations do not balance."""

    def needs(self, layout: Layout, points: Mapping[str, PlaceOn]) -> None:
        """Ask for the grid lines of its region, and for plates that stretch where it pulls them in their planes."""
        region = self.region()
        if region is not None:
            part, where = region
            if part not in layout.segments:
                layout.on_region(f"constraints.{self.name}.region", part, where)
            layout.pulled |= {part} & layout.rectangles.keys()
        for name, directions in self.holds().items():
            place = points.get(name) or points.get(name.rpartition(".")[0])
            if place is not None and place.on in layout.rectangles:
                normal = layout.axes_of[place.on][2]
                if any(_is_in_plane(direction, normal) for direction in directions):
                    layout.pulled.add(place.on)


def _is_in_plane(direction: str, normal: np.ndarray) -> bool:
    """Whether a plate has to stretch or shear for a direction of a point on it; its rotations in the plane bend it."""
    if direction == "n":
        return False
    axis = np.eye(3)[DIRECTIONS.index(direction) % 3]
    along = float(abs(axis @ normal))
    return along > _IN_PLANE if direction.startswith("r") else float(np.sqrt(max(0.0, 1.0 - along**2))) > _IN_PLANE
