"""Concentrated bodies: a mass with its moments and products of inertia, its centre beside the point it is fixed to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.model.imported_mesh import Makes
from femstruct.model.materials import Given, given_fields
from femstruct.model.model import Model, places_of, point_rows
from femstruct.model.part import Inert, Part
from femstruct.model.regions import Vector
from femstruct.tags import stored_as

MOMENT_ROUNDING = 1e-6  # of the largest moment: moments are written with a few digits


@stored_as("inertia/1")
@dataclass(frozen=True)
@checked("parts")
class Inertia(Part):
    """A rigid body without stiffness, small beside what it is fixed to; at every place of a point.

    mass : of each place [kg]. offset : its centre of mass from the point, global axes [m]. moments : Ixx, Iyy, Izz
    about its centre of mass along the global axes, such as Ixx = integral of (y^2 + z^2) dm [kg m^2]; products : Ixy,
    Iyz, Izx, such as Ixy = integral of x y dm, which stand with a minus in the tensor of inertia.

    Raises InputError for a mass that is not positive, and for a tensor that no body has: principal moments are not
    negative, and none is larger than the sum of the two others.

    A thin disc, heavy about its axis:

    >>> disc = Inertia("disc", "hub", mass=2.0, moments=(0.01, 0.01, 0.02))
    >>> disc.principal()[0].round(9).tolist()
    [0.01, 0.01, 0.02]
    """

    name: str
    at: str
    mass: float
    moments: Vector = (0.0, 0.0, 0.0)
    products: Vector = (0.0, 0.0, 0.0)
    offset: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        where = f"parts.{self.name}"
        if not self.mass > 0:
            raise InputError(f"{where}.mass", got=f"{self.mass:g}", expected="a positive mass")
        principal, _ = self.principal()
        moments = ", ".join(f"{value:.4g}" for value in principal)
        if principal[0] < -MOMENT_ROUNDING * principal[2]:
            got = f"principal moments of {moments} kg*m^2"
            raise InputError(f"{where}.inertia", got=got, expected="none below zero", do="check the signs")
        if principal[0] + principal[1] < (1.0 - MOMENT_ROUNDING) * principal[2]:
            raise InputError(
                f"{where}.inertia",
                got=f"principal moments of {moments} kg*m^2",
                expected="none larger than the sum of the two others, as those of every body",
                do="give them about the centre of mass, [Ixx, Iyy, Izz, Ixy, Iyz, Izx] with Ixy = integral of x y dm",
            )

    def stands_for(self) -> frozenset[Makes]:
        return frozenset((Makes.MASSES,))

    def described(self) -> tuple[Given, ...]:
        return given_fields(self, {"mass": "kg", "moments": "kg m^2", "products": "kg m^2", "offset": "m"})

    def principal(self) -> tuple[Floats, Floats]:
        """Principal moments [3], ascending [kg m^2], and their axes as rows [3, 3]."""
        xy, yz, zx = self.products
        tensor = np.diag(self.moments) - np.array([[0.0, xy, zx], [xy, 0.0, yz], [zx, yz, 0.0]])
        values, axes = np.linalg.eigh(tensor)
        return values, axes.T

    def carriers(self) -> tuple[str, ...]:
        return (self.at,)

    def identity(self, places: Mapping[str, object]) -> tuple[object, ...]:
        return "concentrated body", self.mass, self.moments, self.products, self.offset, places.get(self.at, self.at)

    def fastened(self, model: Model, tolerance: float) -> tuple[Inert]:
        points = places_of(f"parts.{self.name}.at", self.at, model)
        moments, axes = self.principal()
        motions = [point_rows(point, np.asarray(self.offset), model) for point in points]
        turns = [csr_array(csr_array(axes) @ motion[3:]) for motion in motions]
        rows = csr_array(vstack([*(motion[:3] for motion in motions), *turns]))
        count = len(points)
        masses = np.concatenate([np.full(3 * count, self.mass), np.tile(moments.clip(min=0.0), count)])
        return (Inert(self.name, rows, masses, count),)
