"""Substructures: parts that are matrices from a file, of another program or of a reduction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS, TWIST
from femstruct.declared import checked
from femstruct.errors import Finding, InputError, list_some
from femstruct.model.component import Component, rigid_masses, rigid_resistance
from femstruct.model.flat_cells import FlatCells, flat_cells
from femstruct.model.imported_mesh import ImportedMesh, frame_across
from femstruct.model.layout import Grids, Layout
from femstruct.model.materials import Given, given_fields
from femstruct.model.part import Drawn, LossShare, Meshed, OwnDofs
from femstruct.model.probe import Point, Surface
from femstruct.model.regions import Region, Vector, sparse_rows
from femstruct.model.shell_cells import cross_turning, rows_at
from femstruct.model.structure import PlaceOn, SurfaceOn
from femstruct.parts.cells import GivenNodes, drawn_nodes, node_point, side_surface
from femstruct.tags import stored_as

_SIX = 6
UNWEIGHED = ". Nor do they say what mass lies between that and the rest: weight and motions of the base are refused"
UNEVEN = 1e-3  # of the largest of the masses along x, y, z: files of few digits have less
FLAT = 1e-9  # largest difference of the normals of cells in parallel planes
RESISTS = 1e-4  # energy of a rigid motion, of that of the diagonal of K: two swapped nodes have 1e-3 to 6e-2


@stored_as("substructure/1")
@dataclass(frozen=True)
@checked("parts")
class Substructure(GivenNodes):
    """A part that is given by matrices; joined, held and pointed at where it has nodes.

    component : the matrices and how nodes move with them. loss_factor : of its stiffness [1], None for that of the
    file. origin : how far it is shifted from where its file has it [m].

    Joints tie the nodes of its interface; the others only follow, so points may be there and supports may not. Points
    are at nodes; what is struck at one that is not of the interface lacks its local compliance. Rotations of nodes
    without any read zero.

    A mass of 2 kg on a spring of 200 N/m along z:

    >>> from scipy.sparse import csr_array
    >>> motion = csr_array(([1.0], ([2], [0])), shape=(7, 1))
    >>> nothing, M, K = csr_array((1, 1)), csr_array([[2.0]]), csr_array([[200.0]])
    >>> fan = Component("fan.npz", M, nothing, K, motion, [[0.0, 0.0, 0.0]], 2.0, ("z",), [0])
    >>> from femstruct import Structure, assemble, mesh_structure, modal_basis
    >>> model = mesh_structure(Structure("a fan", (Substructure("fan", fan),)))
    >>> modal_basis(assemble(model), count=1).omega.round(9).tolist()
    [10.0]
    """

    name: str
    component: Component
    loss_factor: float | None = None
    origin: Vector = (0.0, 0.0, 0.0)

    def described(self) -> tuple[Given, ...]:
        one = self.component
        size = f"{len(one.labels)} degrees of freedom, {len(one.points)} nodes, {len(one.interface)} of them to join"
        rest = (given_ for given_ in given_fields(self, {"origin": "m"}) if given_.what != "component")
        return (Given("matrices", f"{one.source} ({size})"), *rest)

    def corners(self) -> Floats:
        """Its interface: plates and frames that are joined to it get nodes there."""
        one = self.component
        return np.asarray(one.points[one.interface] + np.asarray(self.origin))

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        """Matrices that contradict their nodes, and supports inside of them, whose forces cannot be had."""
        one = self.component
        owner = f"{self.name}: the matrices of {one.source}"
        if not one.free:
            return (
                Finding(
                    "matrices-held",
                    f"{owner} cannot shift as a whole, so something in them is held: that force on the ground is not "
                    f"recorded{UNWEIGHED if one.unweighed else ''}.",
                    {"degrees_of_freedom": len(one.labels)},
                ),
            )
        masses, resists = rigid_masses(one), np.nan_to_num(rigid_resistance(one))
        uneven = bool(np.ptp(masses) > UNEVEN * np.abs(masses).max())
        held, turns = float(resists[:3].max()), float(resists[3:].max())
        if uneven or held < RESISTS <= turns:
            x, y, z = masses
            return (
                Finding(
                    "matrices-disorder",
                    f"{owner} do not fit their nodes. Mass along x, y and z: {x:.4g}, {y:.4g}, {z:.4g} kg, which must "
                    f"be equal. Energy of K in a rigid motion, of that of its diagonal: {held:.2g} in a shift, "
                    f"{turns:.2g} in a rotation, where a free part has 0. Are the rows of the table of nodes in the "
                    "order of those of the matrices?",
                    {"mass_x_kg": x, "mass_y_kg": y, "mass_z_kg": z, "shift_resisted": held, "turn_resisted": turns},
                ),
            )
        if held < RESISTS:
            return ()
        return (
            Finding(
                "matrices-held",
                f"{owner} resist a shift as a whole, so springs in them stand on the ground: that force is not "
                "recorded. If there are none, the rows of the table of nodes are not in the order of the matrices.",
                {"shift_resisted": held},
            ),
        )

    def meshed(self, layout: Layout, grids: Grids, first: int) -> SubstructureMesh:
        return SubstructureMesh(self, first)


@stored_as("substructure mesh/1")
@dataclass(frozen=True, eq=False)
class SubstructureMesh(Meshed):
    """The nodes of a component. first : number of its first node."""

    part: Substructure
    first: int

    @property
    def name(self) -> str:
        return self.part.name

    @property
    def places(self) -> Floats:
        return np.asarray(self.part.component.points + np.asarray(self.part.origin))

    @property
    def joinable(self) -> Integers:
        return self.first + self.part.component.interface

    @property
    def has_rotations(self) -> bool:
        used = np.flatnonzero(np.diff(self.part.component.motion.indptr))
        turning = (used % N_COMPONENTS >= 3) & (used % N_COMPONENTS < _SIX)
        return bool(np.isin(used[turning] // N_COMPONENTS, self.part.component.interface).any())

    @property
    def quads(self) -> Integers:
        return self.first + self.part.component.quads

    @property
    def lines(self) -> Integers:
        return self.first + self.part.component.lines

    @property
    def mass(self) -> float:
        return self.part.component.mass

    @property
    def lumps(self) -> Floats:
        """Its mass over its nodes, all alike: matrices do not say where it is."""
        return np.full(len(self.places), self.mass / len(self.places))

    @property
    def loss_factor(self) -> float:
        given_one = self.part.loss_factor
        return self.part.component.loss_factor if given_one is None else given_one

    @property
    def own_axes(self) -> Floats | None:
        axes = self.part.component.axes
        return axes if len(axes) else None

    @property
    def girth(self) -> float:
        return self.part.component.girth

    @property
    def depth(self) -> float:
        return self.part.component.depth

    def around(self, nodes: Integers) -> Meshed:
        """The plate or shell that it was, where its cells around the nodes are in parallel planes."""
        one = self.part.component
        if not self.depth or not len(one.quads):
            return self
        _, flat = self._cells()
        touching = np.isin(flat.rows[flat.corners], nodes - self.first).any(axis=1)
        normals = flat.normals[touching]
        if not len(normals) or np.abs(normals - normals[0]).max() > FLAT:
            return self
        across = np.concatenate([frame_across(normals[0], self.places)[0], normals[:1]])
        return FlatSubstructureMesh(self.part, self.first, flat, one.axes if len(one.axes) else across)

    def _cells(self) -> tuple[ImportedMesh, FlatCells]:
        """Its cells, as those of a shell between its nodes."""
        one = self.part.component
        three = one.quads[:, 2] == one.quads[:, 3]
        cells = {"quad4": one.quads[~three], "tri3": one.quads[three][:, :3]}
        named = {kind: some for kind, some in cells.items() if len(some)}
        numbers = {kind: np.arange(len(some)) for kind, some in named.items()}
        mesh = ImportedMesh(one.source, self.places, np.arange(len(self.places)), named, numbers)
        return mesh, flat_cells(mesh, None)

    def beside(self, nodes: Integers) -> Floats:
        beside = self.part.component.beside
        return beside[nodes - self.first] if len(beside) else super().beside(nodes)

    @property
    def clamped(self) -> Floats:
        return np.concatenate([np.eye(_SIX, N_COMPONENTS), self.flat])

    @property
    def flat(self) -> Floats:
        """No twist of a plate on a rigid face, as of the plate that it was."""
        return np.eye(N_COMPONENTS)[TWIST:] if len(self.part.component.axes) else super().flat

    def along(self, line: Floats) -> Floats:
        """The twist, with its sign along a line, as of the plate that it was."""
        axes = self.part.component.axes
        return self.flat if not len(axes) or abs(axes[0] @ line) > abs(axes[1] @ line) else -self.flat

    def dofs(self) -> OwnDofs:
        motion = self.part.component.motion.tocoo()
        rows, columns = motion.row.astype(np.int64), motion.col.astype(np.int64)
        return OwnDofs((), self.part.component.labels, rows, columns, motion.data, self.part.component.translations)

    def stiffness_and_mass(self) -> tuple[csr_array, csr_array]:
        return self.part.component.K, self.part.component.M

    @property
    def unweighed(self) -> tuple[str, ...]:
        return self.part.component.unweighed

    @property
    def beside_mass(self) -> Floats:
        return self.part.component.beside_mass

    def shares(self) -> list[LossShare]:
        """As of the layers that it was of, unless one loss factor is given for all."""
        return [] if self.part.loss_factor is not None else list(self.part.component.shares)

    def dashpots(self) -> csr_array | None:
        return self.part.component.C if self.part.component.C.nnz else None

    def within(self, where: str, region: Region, tolerance: float) -> Integers:
        """Nodes of its interface in a set or a box, or all of them."""
        sets = self.part.component.sets
        if region.kind == "set" and sets:
            named = region.named or ""
            if named not in sets:
                raise InputError(where, got=f"'{named}', no set of {self.name}", expected=list_some(sets))
            return np.asarray(self.first + sets[named])
        if region.kind not in ("whole", "box"):
            do = "its file has no sets; femstruct reduce writes them, by the names of supports and joints"
            raise InputError(where, got=f"a {region.kind} of {self.name}", expected="a box", do=do)
        nodes = self.part.component.interface
        if region.box is not None:
            low, high = np.asarray(region.box, dtype=np.float64)
            inside = (self.places[nodes] >= low - tolerance) & (self.places[nodes] <= high + tolerance)
            nodes = nodes[inside.all(axis=1)]
        if not len(nodes):
            raise InputError(
                where, got=f"a box without a node of the interface of {self.name}", expected="one with some"
            )
        return np.asarray(self.first + nodes)

    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        return node_point(name, place, at, self, "a node of it", tolerance)

    def surface(self, item: SurfaceOn, n_nodes: int, tolerance: float) -> Surface:
        """A side of its cells, all or in a box. They move as cells of shells between its nodes.

        Raises InputError for matrices without cells, and as of shells.
        """
        where, one = f"surfaces.{item.name}.region", self.part.component
        if not len(one.quads):
            got = f"a surface of {self.name}, whose matrices have nodes alone"
            raise InputError(where, got=got, expected="a part with cells", do="reduce the part with femstruct reduce")
        if item.region.kind not in ("whole", "box"):
            got = f"a {item.region.kind} of {self.name}"
            raise InputError(where, got=got, expected="whole, or a box", do="matrices have no sets")
        mesh, flat = self._cells()
        chosen = flat.cells_within(mesh, item.region, tolerance)
        if not len(chosen):
            got = f"a {item.region} without a cell of {self.name}"
            raise InputError(where, got=got, expected="one with cells")

        def motion(which: Integers, xi: Floats, eta: Floats) -> tuple[Integers, Floats]:
            nodes, rows = rows_at(flat, which, xi, eta)
            return self.first + flat.rows[nodes], rows

        return side_surface(item, self.name, flat, chosen, motion, n_nodes, (self.depth, 0.0))

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        one = self.part.component
        return drawn_nodes(self.places, self.nodes, one.quads, one.lines, n_nodes)


@stored_as("flat substructure mesh/1")
@dataclass(frozen=True, eq=False)
class FlatSubstructureMesh(SubstructureMesh):
    """A plate or shell that was reduced, where it is flat: bars are joined to it as to what it was. cells : between its
    nodes. axes [3, 3] : rows are its x, y and normal."""

    cells: FlatCells
    axes: Floats

    @property
    def own_axes(self) -> Floats:
        return self.axes

    @property
    def across(self) -> Floats:
        return np.asarray(self.axes[2] * self.depth)

    @property
    def drilling(self) -> Floats:
        return np.asarray(self.axes[2])

    def turning(self, nodes: Integers, reach: float, n_nodes: int) -> csr_array:
        """As of a shell of its cells."""
        corners, rows = cross_turning(self.cells, self.places[nodes - self.first], reach, self.axes)
        return sparse_rows(self.first + self.cells.rows[corners], rows, n_nodes)
