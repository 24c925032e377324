"""What is fastened to nodes, as rows on their components: springs, masses, ties."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, freeze, frozen
from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.tags import stored_as


@stored_as("elastic connection/1")
@dataclass(frozen=True, eq=False)
class Elastic:
    """Springs and dashpots that act on generalised displacements: lumped, spread over a region, or in a joint.

    rows [m, n_nodes * 7] : the displacements. stiffness, damping [m] : of each, area and length included [N/m].
    directions [m, 3] : global direction of the force each makes, zero for rotations. grounded : whether the force goes
    to the ground or to a second part. places [q, 3] : where they act [m], for pictures; none where nodes show it.
    grows_from : frequency [Hz] at which it has this stiffness, where it grows with the square root of frequency, as
    that of the edge of a semi-infinite plate does; None for a stiffness of all frequencies.
    """

    name: str
    rows: csr_array
    stiffness: Floats
    damping: Floats
    directions: Floats
    grounded: bool
    loss_factor: Loss = 0.0
    places: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    grows_from: float | None = None

    def __post_init__(self) -> None:
        m = self.rows.shape[0]
        freeze(
            self,
            stiffness=frozen(f"{self.name} stiffness", self.stiffness, (m,)),
            damping=frozen(f"{self.name} damping", self.damping, (m,)),
            directions=frozen(f"{self.name} directions", self.directions, (m, 3)),
            places=frozen(f"{self.name} places", self.places, (None, 3)),
        )


@stored_as("attached inertia/1")
@dataclass(frozen=True, eq=False)
class Inert:
    """Mass without elasticity on generalised displacements.

    rows [m, n_nodes * 7] : global x, y, z displacements of its places, one place after the other, then rotations.
    mass [m] : of each place, three times [kg], then moments of inertia [kg m^2]. n_places : how many there are.
    """

    name: str
    rows: csr_array
    mass: Floats
    n_places: int

    @property
    def total(self) -> float:
        """What moves with a translation [kg]."""
        return float(self.mass[: 3 * self.n_places : 3].sum())

    def __post_init__(self) -> None:
        freeze(self, mass=frozen(f"{self.name} mass", self.mass, (self.rows.shape[0],)))


@stored_as("tie/1")
@dataclass(frozen=True, eq=False)
class Tie:
    """Displacements that are held at zero: a support, or the relative motion of the two sides of a joint.

    rows [m, n_nodes * 7]; directions [m, 3] : global direction of the force of each, zero for rotations.
    """

    name: str
    rows: csr_array
    directions: Floats
    grounded: bool

    def __post_init__(self) -> None:
        freeze(self, directions=frozen(f"{self.name} directions", self.directions, (self.rows.shape[0], 3)))
