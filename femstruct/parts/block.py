"""Rigid blocks: machines, anvils, foundations of concrete."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.declared import checked
from femstruct.errors import Finding, InputError
from femstruct.model.imported_mesh import Makes
from femstruct.model.layout import Grids, Layout
from femstruct.model.materials import Given, given_fields
from femstruct.model.part import Drawn, FilledBox, Meshed, OwnDofs, Part, nodal_dofs, refuse_patch
from femstruct.model.probe import Point
from femstruct.model.regions import Vector, carry_along_arms, flat_rows, sparse_rows
from femstruct.model.structure import PlaceOn
from femstruct.parts.plausibility import density_findings
from femstruct.tags import stored_as


@stored_as("block/1")
@dataclass(frozen=True)
@checked("parts")
class Block(Part):
    """A rigid body: a box along the global axes; `origin` is its lower corner (least x, y and z).

    mass [kg]; size : along x, y, z [m]. center : the centre of mass from the lower corner [m], None for the middle.
    inertia : moments about the centre of mass along x, y, z, which are its principal axes [kg m^2]; None for those of
    a uniform box of this mass and size.

    A machine of 1.2 t, and its moment of inertia about the vertical:

    >>> machine = Block("machine", 1200.0, origin=(0.0, 0.0, 0.0), size=(1.0, 0.8, 0.6))
    >>> machine.middle, machine.moments[2]
    ((0.5, 0.4, 0.3), 164.0)
    """

    name: str
    mass: float
    origin: Vector
    size: Vector
    center: Vector | None = None
    inertia: Vector | None = None

    def stands_for(self) -> frozenset[Makes]:
        return frozenset((Makes.MASSES,))

    def described(self) -> tuple[Given, ...]:
        return given_fields(self, {"mass": "kg", "origin": "m", "size": "m", "center": "m", "inertia": "kg m^2"})

    @property
    def middle(self) -> Vector:
        """Middle of the box from its lower corner [m]."""
        a, b, c = self.size
        return a / 2.0, b / 2.0, c / 2.0

    @property
    def moments(self) -> Vector:
        """Moments of inertia about the centre of mass along x, y, z [kg m^2]; m (b^2 + c^2) / 12 for the box."""
        if self.inertia is not None:
            return self.inertia
        x, y, z = (self.mass * side**2 / 12.0 for side in self.size)
        return y + z, z + x, x + y

    def corners(self) -> Floats:
        for key, values in (("mass", (self.mass,)), ("size", self.size), ("inertia", self.moments)):
            if not min(values) > 0:
                raise InputError(f"parts.{self.name}.{key}", got=f"{min(values):g}", expected="positive values")
        return np.array([self.origin, np.add(self.origin, self.size)], dtype=np.float64)

    def body(self) -> FilledBox:
        origin, size = (np.asarray(one, dtype=np.float64) for one in (self.origin, self.size))
        return FilledBox(origin, np.eye(3), size, across=None)

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        return density_findings(self.name, self.mass, self.size)

    def lay_out(self, layout: Layout) -> None:
        layout.boxes[self.name] = self
        layout.bodies[self.name] = self.body()

    def meshed(self, layout: Layout, grids: Grids, first: int) -> BlockMesh:
        return BlockMesh(self, first)


@stored_as("block mesh/1")
@dataclass(frozen=True, eq=False)
class BlockMesh(Meshed):
    """A rigid block: one node, `first`, at its centre of mass."""

    part: Block
    first: int
    rigid: ClassVar[bool] = True

    @property
    def name(self) -> str:
        return self.part.name

    @property
    def places(self) -> Floats:
        inside = self.part.middle if self.part.center is None else self.part.center
        return np.add(self.part.origin, inside)[None]

    @property
    def mass(self) -> float:
        return self.part.mass

    @property
    def lumps(self) -> Floats:
        return np.array([self.mass])

    @property
    def box(self) -> Floats:
        return self.part.corners()

    @property
    def bounds(self) -> Floats:
        return self.part.corners()

    def dofs(self) -> OwnDofs:
        return nodal_dofs(1, 6)

    def stiffness_and_mass(self) -> tuple[None, csr_array]:
        """Nothing that deforms; mass and moments of inertia at its centre of mass."""
        values = np.array([self.part.mass] * 3 + list(self.part.moments))
        return None, csr_array((values, (np.arange(6), np.arange(6))), shape=(6, 6))

    def motion_at(self, places: Floats, tolerance: float) -> tuple[Integers, Floats]:
        rows = np.zeros((len(places), 6, 1, N_COMPONENTS))
        rows[:, :, 0, :6] = np.eye(6)
        return np.full((len(places), 1), self.first), carry_along_arms(rows, places - self.places[0])

    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        where = f"points.{name}"
        refuse_patch(name, place)
        if len(at) != 3:
            raise InputError(f"{where}.at", got=f"{len(at)} numbers", expected="[x, y, z] from the lower corner")
        size = np.asarray(self.part.size)
        off = float(np.linalg.norm(at - np.clip(at, 0.0, size)))
        if off > tolerance:
            raise InputError(
                f"{where}.at",
                got=f"({at[0]:g}, {at[1]:g}, {at[2]:g}) m, {off:.4g} m off {self.name}",
                expected=f"a place within {size[0]:g} m x {size[1]:g} m x {size[2]:g} m",
            )
        position = np.asarray(self.part.origin) + np.clip(at, 0.0, size)
        up = 1.0 if place.side == "above" else -1.0
        rows = flat_rows(*self.motion_at(position[None], tolerance), np.ones(1))
        return Point(name, position, *rows, normal=np.array([0.0, 0.0, up]))

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        """The six faces, each with corners of its own, so that every face has edges."""
        square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
        faces = [np.insert(square, axis, side, axis=1) for axis in range(3) for side in (0, 1)]
        low, high = self.box
        places = low + np.concatenate(faces) * (high - low)
        nodes, rows = self.motion_at(places, 0.0)
        quads = np.arange(len(places)).reshape(-1, 4)
        return Drawn(places, sparse_rows(nodes, rows[:, :3], n_nodes), quads, np.empty((0, 2), np.int64))
