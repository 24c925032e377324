"""Walls that stand at the edge of a plate and are not modelled: what they resist to its rotation, and take of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.model.material import Material
from femstruct.model.materials.loss_by_frequency import loss_at
from femstruct.tags import stored_as

WALLS_AT: Final = 100.0  # Hz: frequency at which a model holds their stiffness; it grows with the square root


@stored_as("wall at an edge/1")
@dataclass(frozen=True)
@checked("supports")
class EdgeWall:
    """A wall at the edge of a plate, as a semi-infinite plate: the bending waves that it takes do not return.

    material : isotropic. thickness [m].

    Raises InputError for a thickness or a density that is not positive.

    Notes
    -----
    Per length and radian its edge resists with B k (1 + j) where the edge is pinned, k = (m omega^2 / B)^(1/4) being
    the wave number of bending in the wall: a spring with a loss factor of 1 that grows with the root of frequency.
    With B (1 + j eta) of the material it is (1 + j eta)^(3/4) times that. The wave in the wall runs straight away from
    the edge; that of a mode with a wave number k_e along the edge does not, and resists with
    B [sqrt(k^2 + k_e^2) + j sqrt(k^2 - k_e^2)] (no losses where k_e > k). Walls of a real building return part of what
    they take; in the mean over frequency the semi-infinite wall holds (L. Cremer, M. Heckl, B. Petersson,
    Structure-Borne Sound, 3rd edition, chapter 6).

    A wall of masonry, 175 mm:

    >>> wall = EdgeWall(Material("masonry", E=5e9, nu=0.2, rho=1400.0), 0.175)
    >>> round(wall.stiffness(100.0) / 1e6, 3), round(wall.loss_factor, 3)
    (5.907, 1.0)
    """

    material: Material
    thickness: float

    def __post_init__(self) -> None:
        if not self.thickness > 0.0:
            got = f"{self.thickness:g} m"
            raise InputError("supports.wall.thickness", got=got, expected="a positive length")
        if not self.material.rho > 0.0:
            got = f"a wall of {self.material.name}, whose density is 0"
            raise InputError("supports.wall.material", got=got, expected="a material with mass")

    @property
    def _lossy(self) -> complex:
        """(1 + j) (1 + j eta)^(3/4) of its material."""
        loss = float(loss_at(self.material.loss_factor, WALLS_AT))
        return (1.0 + 1.0j) * (1.0 + 1.0j * loss) ** 0.75

    @property
    def bending(self) -> float:
        """Bending stiffness per width [N m]."""
        return self.material.E * self.thickness**3 / (12.0 * (1.0 - self.material.nu**2))

    def stiffness(self, frequency_hz: float) -> float:
        """Real part of its rotational stiffness per length at a frequency [N m/rad/m]."""
        mass = self.material.rho * self.thickness
        wave_number: float = (mass * (2.0 * math.pi * frequency_hz) ** 2 / self.bending) ** 0.25
        return self.bending * wave_number * self._lossy.real

    @property
    def loss_factor(self) -> float:
        """Of that stiffness [1]: imaginary over real part, at any frequency."""
        return self._lossy.imag / self._lossy.real
