"""Attachments: supports, rigid links and masses as a mesh file states them, on the nodes of the parts of that file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers, freeze, frozen_integers
from femstruct.conventions import DIRECTIONS
from femstruct.declared import checked
from femstruct.errors import Finding, InputError, list_some
from femstruct.model.attached import (
    TAKEN,
    Attached,
    Nodes,
    Users,
    attach_stated,
    average_rows,
    held_rows,
    idle_rows,
    inert_rows,
    link_rows,
    refuse_missing,
    same_file,
    supports_of,
)
from femstruct.model.imported_mesh import ImportedMesh, StatedHold
from femstruct.model.layout import Grids, Layout
from femstruct.model.materials import Given
from femstruct.model.model import Model
from femstruct.model.part import Drawn, Inert, Meshed, OwnDofs, Tie, nodal_dofs
from femstruct.model.probe import Point
from femstruct.model.structure import PlaceOn
from femstruct.parts.cells import GivenNodes, drawn_nodes, node_point
from femstruct.tags import stored_as

HEAVIEST: Final = 2e4  # kg per cube of the size of a structure: metal all through, the densest of which has 22600
_SIX: Final = len(DIRECTIONS)


@stored_as("attachments/1")
@dataclass(frozen=True)
@checked("parts")
class Attachments(GivenNodes):
    """What a mesh file states beside its cells, taken as it is: supports, links (rigid ones and averages), masses.

    take : out of "supports", "links", "masses". supports : names of the sets of supports that hold; none for those that
    the file puts to use, or for its only one. mass_unit : the unit of mass of the file [kg]; None for that which
    goes with newtons and seconds: kg of a file in metres, t of one in millimetres.

    They act on nodes of the shells and solids of the same file, read with the same scale. A node of it is one node:
    where several parts have it, all of them are held or follow. A node that leads a link and that no cell has,
    as the middle of a spider, becomes a node of this part: points and joints may be there. The force under the name of
    the part is that of all its supports; parts with `supports` of their own tell them apart.

    A plate of four nodes whose file holds two of them and puts 2 t on a third:

    >>> from femstruct.model.imported_mesh import StatedHold
    >>> from femstruct.model.imported_mesh import Stated, StatedMass
    >>> press = StatedMass(2, 2.0, (0.0, 0.0, 0.0), (0.0,) * 6)
    >>> stated = Stated(masses=(press,), holds=(StatedHold("a", [0, 3], (2,)),))
    >>> corners, cells = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], {"quad4": [range(4)]}
    >>> mesh = ImportedMesh("plate.inp", corners, range(4), cells, {"quad4": [1]}, stated=stated, scale=1e-3)
    >>> rest = Attachments("rest", mesh, ("supports", "masses"))
    >>> rest.unit, [one.name for one in rest.holds]
    (1000.0, ['a'])
    """

    name: str
    mesh: ImportedMesh
    take: tuple[str, ...]
    supports: tuple[str, ...] = ()
    mass_unit: float | None = None

    def __post_init__(self) -> None:
        """Raises InputError for what the file does not state, sets of supports that are not there, and a unit of mass
        that is not known."""
        where = f"parts.{self.name}"
        if unknown := [word for word in self.take if word not in TAKEN]:
            raise InputError(f"{where}.take", got=f"'{unknown[0]}'", expected=f"some of {', '.join(TAKEN)}")
        refuse_missing(f"{where}.take", self.mesh, self.take)
        if self.supports and "supports" not in self.take:
            raise InputError(f"{where}.supports", got="sets of supports", expected="'supports' among what is taken")
        if self.mass_unit is not None and "masses" not in self.take:
            raise InputError(f"{where}.mass_unit", got="a unit of mass", expected="'masses' among what is taken")
        if self.mass_unit is not None and not self.mass_unit > 0:
            raise InputError(f"{where}.mass_unit", got=f"{self.mass_unit:g} kg", expected="a positive mass")
        if "masses" in self.take and not self.unit:
            raise InputError(
                f"{where}.take",
                got=f"masses of a file whose unit of length is {self.mesh.scale:g} m",
                expected="'mass_unit' beside, the unit of mass of the file",
                do="write mass_unit: kg, or kilograms in it",
            )
        _ = self.holds

    @property
    def unit(self) -> float:
        """The unit of mass of the file [kg]; 0 where it is not known."""
        return self.mesh.unit_of_mass if self.mass_unit is None else self.mass_unit

    @property
    def holds(self) -> tuple[StatedHold, ...]:
        """Held nodes of the sets of supports that are taken."""
        return supports_of(f"parts.{self.name}.supports", self.mesh, self.supports) if "supports" in self.take else ()

    def described(self) -> tuple[Given, ...]:
        names = list(dict.fromkeys(one.name for one in self.holds))
        counted = [f"supports {list_some(names)}"] if names else []
        if "links" in self.take:
            counted.append(f"{len(self.mesh.stated.links)} links")
        masses = () if "masses" not in self.take else self.mesh.stated.masses
        unit = (Given("unit of mass", self.unit, "kg"),) if masses else ()
        counted += [f"{len(masses)} masses"] if masses else []
        return (Given("mesh", self.mesh.source), Given("takes", ", ".join(counted)), *unit)

    def corners(self) -> Floats:
        """The nodes that lead links or carry masses: plates and frames that are joined to it get nodes there."""
        stated = self.mesh.stated
        leading = [one.node for one in stated.links] if "links" in self.take else []
        carrying = [one.node for one in stated.masses] if "masses" in self.take else []
        return np.asarray(self.mesh.points[np.array([*leading, *carrying], np.int64)])

    def identity(self, places: Mapping[str, object]) -> tuple[object, ...]:
        return "attachments", self.mesh.source, self.mesh.scale, self.take, self.supports, self.mass_unit

    def attaches(self, users: Users) -> Attached:
        return attach_stated(self.mesh, self.take, self.holds, users)

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        """Masses that are heavier than metal as large as the mesh."""
        if "masses" not in self.take:
            return ()
        mass = self.unit * sum(one.mass for one in self.mesh.stated.masses)
        size = float(np.ptp(self.mesh.points, axis=0).max())
        if mass <= HEAVIEST * size**3:
            return ()
        return (
            Finding(
                "mesh-in-other-units",
                f"{self.name}: the masses of {self.mesh.source} are {mass:.4g} kg in all, with a unit of mass of "
                f"{self.unit:g} kg, and the mesh is {size:.4g} m large: metal all through would weigh "
                f"{HEAVIEST * size**3:.4g} kg. Did you mean 'mass_unit: kg'?",
                {"mass_kg": mass, "size_m": size},
            ),
        )

    def meshed(self, layout: Layout, grids: Grids, first: int) -> AttachmentsMesh | None:
        alone = self.attaches(layout.taken).alone
        return AttachmentsMesh(self, first, alone) if len(alone) else None

    def fastened(self, model: Model, tolerance: float) -> tuple[Inert | Tie, ...]:
        where = f"parts.{self.name}"
        structure = model.structure
        found = self.attaches(tuple(some for part in structure.parts for some in part.taken()))
        if not any(same_file(self.mesh, mesh) for part in structure.parts for mesh, _ in part.taken()):
            raise InputError(
                f"{where}.mesh",
                got=f"{self.mesh.source} with a unit of length of {self.mesh.scale:g} m, of which no part has a node",
                expected="the file and scale of a shell or solid",
                do="write the same 'mesh' and 'scale' as there",
            )
        nodes = Nodes(self.mesh, model.parts, model.mesh.points)
        made: list[Inert | Tie] = []
        if found.holds:
            made.append(Tie(self.name, *held_rows(found.holds, nodes), grounded=True))
        if found.links:
            pieces = [
                link_rows(one, nodes) if one.weights is None else average_rows(f"{where}.take", one, nodes)
                for one in found.links
            ]
            rows, directions = csr_array(vstack([one for one, _ in pieces])), np.concatenate([d for _, d in pieces])
            made.append(Tie(f"{self.name} links", rows, directions, grounded=False))
        if found.masses:
            made.append(Inert(self.name, *inert_rows(f"{where}.take", found.masses, nodes, self.unit)))
        others = any(self.name in (one.a, one.b) for one in structure.joints)
        others |= any(one.on == self.name for one in structure.points)
        if self.name in model.parts and not others:
            idle = idle_rows(model.parts[self.name].nodes, [one.rows for one in made], model.mesh.n_nodes)
            if idle.shape[0]:
                made.append(Tie(f"{self.name} idle", idle, np.zeros((idle.shape[0], 3)), grounded=False))
        return tuple(made)


@stored_as("attachments mesh/1")
@dataclass(frozen=True, eq=False)
class AttachmentsMesh(Meshed):
    """The nodes that lead links and that no cell has, or none that turns. rows [n] : of the points of the mesh."""

    part: Attachments
    first: int
    rows: Integers

    def __post_init__(self) -> None:
        freeze(self, rows=frozen_integers(f"parts.{self.part.name} rows", self.rows, (None,)))

    @property
    def name(self) -> str:
        return self.part.name

    @property
    def places(self) -> Floats:
        return np.asarray(self.part.mesh.points[self.rows])

    @property
    def of_file(self) -> tuple[ImportedMesh, Integers]:
        return self.part.mesh, self.rows

    @property
    def mass(self) -> float:
        return 0.0

    @property
    def lumps(self) -> Floats:
        return np.zeros(len(self.rows))

    @property
    def held_together(self) -> list[Integers]:
        return [self.nodes[[at]] for at in range(len(self.rows))]

    def dofs(self) -> OwnDofs:
        return nodal_dofs(len(self.rows), _SIX)

    def stiffness_and_mass(self) -> tuple[None, csr_array]:
        """Nothing that deforms, and no mass: those of the file are fastened to it."""
        return None, csr_array((_SIX * len(self.rows),) * 2)

    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        return node_point(name, place, at, self, "a node that leads a link", tolerance)

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        """Its nodes, which have no faces."""
        return drawn_nodes(self.places, self.nodes, np.empty((0, 4), np.int64), np.empty((0, 2), np.int64), n_nodes)
