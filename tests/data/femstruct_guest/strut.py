"""Struts: straight bars that only stretch, of two nodes with three degrees of freedom each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.sparse import csr_array

from femstruct.errors import InputError
from femstruct.model.materials import Material
from femstruct.model.part import Drawn, Meshed, Part, nodal_dofs
from femstruct.model.probe import Point
from femstruct.tags import stored_as


@stored_as("femstruct_guest: strut/1")
@dataclass(frozen=True)
class Strut(Part):
    """A bar from a start to an end [m], of an area [m^2]; both ends are hinges."""

    name: str
    material: Material
    area: float
    start: tuple[float, float, float]
    end: tuple[float, float, float]

    def corners(self):
        return np.array([self.start, self.end])

    def materials(self):
        return (self.material,)

    def meshed(self, layout, grids, first):
        return StrutMesh(self, first)


@stored_as("femstruct_guest: strut mesh/1")
@dataclass(frozen=True, eq=False)
class StrutMesh(Meshed):
    """A strut as one element: K = E A / L along it, M = rho A L / 6 [[2, 1], [1, 2]] in all directions."""

    part: Strut
    first: int
    has_rotations: ClassVar[bool] = False

    @property
    def name(self):
        return self.part.name

    @property
    def places(self):
        return self.part.corners()

    @property
    def lines(self):
        return self.nodes[None]

    @property
    def mass(self):
        return self.part.material.rho * self.part.area * float(np.linalg.norm(np.diff(self.places, axis=0)))

    @property
    def lumps(self):
        return np.full(2, self.mass / 2.0)

    def dofs(self):
        return nodal_dofs(2, 3)

    def stiffness_and_mass(self):
        along = np.diff(self.places, axis=0)[0]
        length = np.linalg.norm(along)
        one = self.part.material.E * self.part.area / length * np.outer(along, along) / length**2
        K = np.block([[one, -one], [-one, one]])
        M = np.kron(np.array([[2.0, 1.0], [1.0, 2.0]]), np.eye(3)) * self.mass / 6.0
        return csr_array(K), csr_array(M)

    def point(self, name, place, at, tolerance):
        apart = np.linalg.norm(self.places - at, axis=1)
        end = int(apart.argmin())
        if apart[end] > tolerance:
            raise InputError(f"points.{name}.at", got=f"{at} m", expected=f"an end of {self.name}")
        nodes = np.full(3, self.first + end)
        return Point(name, self.places[end], nodes, np.arange(3), np.eye(6)[:, :3], np.array([0.0, 0.0, 1.0]))

    def drawn(self, divisions, along, n_nodes):
        rows = np.zeros((6, n_nodes * 7))
        for end in (0, 1):
            rows[3 * end + np.arange(3), (self.first + end) * 7 + np.arange(3)] = 1.0
        return Drawn(self.places, csr_array(rows), np.empty((0, 4), np.int64), np.array([[0, 1]]))
