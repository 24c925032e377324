"""Frames: bars along lines, with rigid arms where they are eccentric."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
import scipy
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import N_COMPONENTS
from femstruct.declared import checked
from femstruct.elements import frame, placement
from femstruct.elements.frame import nodes_per_bar
from femstruct.elements.placement import directions
from femstruct.elements.quadrature import gauss_interval
from femstruct.errors import Finding, InputError
from femstruct.model.given import Given, given
from femstruct.model.grid.geometry import distance_to_segments
from femstruct.model.grid.layout import Grids, Layout
from femstruct.model.grid.scatter import scattered
from femstruct.model.materials.bar import of_bar
from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.model import Model
from femstruct.model.part import Drawn, Meshed, OwnDofs, Part, Spread, nodal_dofs, refuse_not_global, refuse_patch
from femstruct.model.probe import Point, StressPlaces
from femstruct.model.region import Region, Vector
from femstruct.model.rows import flat_rows, sparse_rows
from femstruct.model.section import Section
from femstruct.model.structure import PlaceOn
from femstruct.parts.frame_lines import frame_segments
from femstruct.parts.plausibility import section_findings

MOST_BARS = 100_000  # more is a slip of a unit, and does not fit into memory


@dataclass(frozen=True)
@checked("parts")
class Frame(Part):
    """Bars along polylines of global points; coincident ends of its own lines are joined.

    material : of an orthotropic one x is along the bars, y and z along those of the section. mesh : largest element
    length [m], None for one element a segment; a line that lies in a plate it is joined to takes the plate's nodes
    instead. orientation : a vector the section's local z
    (its height) points along as nearly as it can.
    element : timoshenko18, a bar of three nodes whose frequencies converge with the fourth power of its length;
    timoshenko, of two, with the second where shear matters; euler, without shear and rotary inertia.
    start_offset, end_offset : rigid arms from the first and last point of every line to the ends of the flexible bar,
    global axes [m]. Where both are the same the whole line is eccentric: its nodes stay on the line, joined there to
    what it touches, and every bar hangs beside it on arms at both ends, as a rib under a plate does. A rib has no
    width there: plates swing about its middle, where broad joists let them swing about their flanks. Two different
    arms go over into each other along the line; one at an end alone leaves the other points of the line where they
    are. What differs along the line itself only shortens or lengthens the bar.

    A post of steel, 40 mm square and 0.7 m high, clamped at its foot; 68.20 Hz without shear and rotary inertia:

    >>> from femstruct import Material, PlaceOn, Structure, Support, assemble, mesh_structure, modal_basis
    >>> from femstruct.model.section import rectangle
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> lines = (((0.0, 0.0, 0.0), (0.0, 0.0, 0.7)),)
    >>> post = Frame("post", steel, rectangle("bar", 0.04, 0.04), lines, mesh=0.1)
    >>> foot = PlaceOn("foot", "post", at=((0.0, 0.0, 0.0),))
    >>> held = Support("floor", "clamped", at="foot")
    >>> model = mesh_structure(Structure("a post", (post,), points=(foot,), supports=(held,)))
    >>> [round(float(f), 2) for f in modal_basis(assemble(model), up_to=100.0).frequency_hz]  # both ways
    [68.03, 68.03]
    """

    name: str
    material: AnyMaterial
    section: Section
    lines: tuple[tuple[Vector, ...], ...]
    mesh: float | None = None
    orientation: Vector | None = None
    element: frame.FrameElement = "timoshenko18"
    start_offset: Vector = (0.0, 0.0, 0.0)
    end_offset: Vector = (0.0, 0.0, 0.0)

    def described(self) -> tuple[Given, ...]:
        return given(self, {"lines": "m", "mesh": "m", "start_offset": "m", "end_offset": "m"})

    def corners(self) -> Floats:
        return np.array([point for line in self.lines for point in line], dtype=np.float64).reshape(-1, 3)

    def materials(self) -> tuple[AnyMaterial, ...]:
        return (self.material,)

    @property
    def along(self) -> tuple[float, float, Section]:
        """E and G along its bars [Pa], and the section with the shear coefficients that go with them."""
        return of_bar(self.material, self.section)

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        return section_findings(self.name, self.section, self.lines)

    def lay_out(self, layout: Layout) -> None:
        segments = frame_segments(self, layout.tolerance)
        size = self.mesh if self.mesh is not None else inf
        if not size > 0:
            raise InputError(f"parts.{self.name}.mesh", got=f"{size:g} m", expected="a positive length")
        total = sum(float(np.linalg.norm(segment.end - segment.start)) for segment in segments)
        if total > MOST_BARS * size:
            raise InputError(
                f"parts.{self.name}.mesh",
                got=f"{size:g} m, {total / size:.3g} bars",
                expected=f"at most {MOST_BARS} bars",
                do=f"use {total / MOST_BARS:.2g} m or more",
            )
        layout.add_bars(self.name, self.corners(), segments, size)

    def meshed(self, layout: Layout, grids: Grids, first: int) -> FrameMesh:
        """Bars of every straight piece between nodes; where they have a rigid arm the node is the foot of the arm.
        Middle nodes of bars of three come after all ends."""
        tips, feet, middles = [], [], []
        for segment in layout.segments[self.name]:
            share = (grids[segment.key] / grids[segment.key][-1])[:, None]
            places = (1.0 - share) * segment.start + share * segment.end
            stands = places - ((1.0 - share) * segment.arms[0] + share * segment.arms[1])
            middles.append((stands[:-1] + stands[1:]) / 2.0)
            line = self.lines[int(segment.key[1])]
            stands[0], stands[-1] = line[int(segment.key[2])], line[int(segment.key[2]) + 1]
            tips.append(np.stack([places[:-1], places[1:]], axis=1))
            feet.append(np.stack([stands[:-1], stands[1:]], axis=1))
        ends, stands = np.concatenate(tips), np.concatenate(feet)
        points, numbers = _merged(stands.reshape(-1, 3), layout.tolerance)
        bars, arms = numbers.reshape(-1, 2), ends - stands
        if nodes_per_bar(self.element) == 3:
            middle = np.concatenate(middles)
            bars = np.column_stack([bars, len(points) + np.arange(len(bars))])
            points = np.concatenate([points, middle])
            arms = np.concatenate([arms, (ends.mean(axis=1) - middle)[:, None]], axis=1)
        try:
            axes = directions(ends[:, 0], ends[:, 1], self.orientation)
        except InputError as error:
            raise InputError(f"parts.{self.name}.{error.where}", got=error.got, expected=error.expected) from error
        return FrameMesh(self, first, points, first + bars, ends[:, 0], ends[:, 1], arms, axes)


@dataclass(frozen=True, eq=False)
class FrameMesh(Meshed):
    """A frame as bars.

    first : number of its first node. stands [n, 3] : places of its nodes [m]. bars [b, k] : the two end nodes, then the
    middle one of bars of three. start, end [b, 3] : ends of the flexible bars, at the tips of the rigid arms [m].
    arms [b, k, 3] : from the nodes to the flexible bar, global axes [m]. axes [b, 3, 3] : rows are local x, y, z.
    """

    part: Frame
    first: int
    stands: Floats
    bars: Integers
    start: Floats
    end: Floats
    arms: Floats
    axes: Floats

    def __post_init__(self) -> None:
        where = f"parts.{self.part.name}"
        k = nodes_per_bar(self.part.element)
        bars = frozen_integers(f"{where} bars", self.bars, (None, k))
        n = len(bars)
        freeze(
            self,
            stands=frozen(f"{where} places", self.stands, (None, 3)),
            bars=bars,
            start=frozen(f"{where} start", self.start, (n, 3)),
            end=frozen(f"{where} end", self.end, (n, 3)),
            arms=frozen(f"{where} arms", self.arms, (n, k, 3)),
            axes=frozen(f"{where} axes", self.axes, (n, 3, 3)),
        )

    @property
    def name(self) -> str:
        return self.part.name

    @property
    def places(self) -> Floats:
        return self.stands

    @property
    def lumps(self) -> Floats:
        half = self.part.material.rho * self.part.section.A * self.lengths / 2.0
        lumps = np.zeros(len(self.stands))
        np.add.at(lumps, self.lines - self.first, half[:, None])
        return lumps

    @property
    def held_together(self) -> list[Integers]:
        return list(self.bars)

    @property
    def lines(self) -> Integers:
        return self.bars[:, :2]

    @property
    def lengths(self) -> Floats:
        """Lengths of the flexible bars [b] [m]."""
        lengths: Floats = np.linalg.norm(self.end - self.start, axis=1)
        return lengths

    @property
    def mass(self) -> float:
        return self.part.material.rho * self.part.section.A * float(self.lengths.sum())

    @property
    def loss_factor(self) -> Loss:
        return self.part.material.loss_factor

    @property
    def girth(self) -> float:
        section = self.part.section
        return float(np.sqrt((section.Iy + section.Iz) / section.A))

    def beside(self, nodes: Integers) -> Floats:
        found = np.zeros((len(self.stands), 3))
        found[(self.bars - self.first).ravel()] = self.arms.reshape(-1, 3)
        return found[nodes - self.first]

    def dofs(self) -> OwnDofs:
        return nodal_dofs(len(self.places), 6)

    def stiffness_and_mass(self) -> tuple[csr_array, csr_array]:
        numbers = np.arange(6 * len(self.places)).reshape(-1, 6)
        part, (E, G, section), lengths = self.part, self.part.along, self.lengths
        A, Iy, Iz, ky, kz = section.A, section.Iy, section.Iz, section.ky, section.kz
        local = (
            frame.stiffness(part.element, lengths, E, G, A, Iy, Iz, section.J, ky, kz),
            frame.mass(part.element, lengths, part.material.rho, A, Iy, Iz, ky, kz, E, G),
        )
        of_bars = numbers[self.bars - self.first].reshape(len(self.bars), -1)
        at_nodes = [
            placement.with_offsets(placement.to_global(matrix, self.axes), *np.moveaxis(self.arms, 1, 0))
            for matrix in local
        ]
        return scattered(at_nodes[0], at_nodes[1], of_bars, 6 * len(self.places))

    def rows(self, bars: Integers, shares: Floats) -> tuple[Integers, Floats]:
        """Motion of places along bars from the components of their nodes.

        bars [p] : which; shares [p] : from 0 at the start to 1 at the end of the flexible part.

        Returns nodes [p, k] and rows [p, 6, k, 7], k nodes a bar: three displacements and three rotations, global axes.
        """
        part, (E, G, section) = self.part, self.part.along
        local = frame.interpolate(
            part.element,
            self.lengths[bars],
            shares,
            E,
            G,
            section.A,
            section.Iy,
            section.Iz,
            section.ky,
            section.kz,
        )
        turn = placement.rotation(self.axes[bars], 1)
        return self.bars[bars], self._on_nodes(np.swapaxes(turn, -1, -2) @ local, bars)

    def _on_nodes(self, local: Floats, bars: Integers) -> Floats:
        """Rows [p, r, k, 7] on the components of the nodes of bars, from rows [p, r, 6 k] on their local DOFs."""
        k = self.bars.shape[1]
        arms = placement.rigid_arms(*np.moveaxis(self.arms[bars], 1, 0))
        rows = local @ placement.rotation(self.axes[bars], k) @ arms
        padded = np.zeros((*rows.shape[:2], k, N_COMPONENTS))
        padded[..., :6] = rows.reshape(*rows.shape[:2], k, 6)
        return padded

    def section_forces(self, bars: Integers, shares: Floats) -> Floats:
        """Rows [p, 6, k, 7] of N Vy Vz [N] and T My Mz [N m] at places along bars, as
        `femstruct.elements.frame.resultants`, from the components of their nodes."""
        part, (E, G, section) = self.part, self.part.along
        A, Iy, Iz, J, ky, kz = section.A, section.Iy, section.Iz, section.J, section.ky, section.kz
        local = frame.resultants(part.element, self.lengths[bars], shares, E, G, A, Iy, Iz, J, ky, kz)
        return self._on_nodes(local, bars)

    def stresses(self, n_nodes: int) -> StressPlaces:
        """Stretch, bending and torsion at both ends of every bar, at the outermost points of its section; what shear
        forces add is left out. The largest shear stress of torsion is taken for every point, on the safe side."""
        section = self.part.section
        if not section.outline:
            raise InputError(
                f"parts.{self.name}.section",
                got=f"'{section.name}' by its constants, without an outline",
                expected="an outline for stresses",
                do="give the section by its shape, such as {shape: box, ..}",
            )
        bars, shares = np.repeat(np.arange(len(self.bars)), 2), np.tile([0.0, 1.0], len(self.bars))
        forces = self.section_forces(bars, shares)
        y, z = np.array(section.outline).T[:, :, None, None]
        N, T, My, Mz = (forces[:, None, i] for i in (0, 3, 4, 5))
        normal = N / section.A + My * z / section.Iy - Mz * y / section.Iz
        shear = np.broadcast_to(T * section.twist_arm / section.J, normal.shape)
        rows = np.stack([normal, shear], axis=2)
        count, points = len(bars), len(section.outline)
        ends = np.stack([self.start, self.end], axis=1).reshape(-1, 3)
        across = np.einsum("pc,bcj->bpj", np.array(section.outline), self.axes[bars][:, 1:])
        nodes = np.repeat(self.bars[bars], points, axis=0)
        return StressPlaces(
            (ends[:, None] + across).reshape(-1, 3),
            ("xx", "xy"),
            sparse_rows(nodes, rows.reshape(count * points, 2, -1, N_COMPONENTS), n_nodes),
            tuple(f"at y = {1e3 * a:.4g} mm, z = {1e3 * b:.4g} mm of the section" for a, b in section.outline),
        )

    def point(self, name: str, place: PlaceOn, at: Floats, tolerance: float) -> Point:
        where, up = f"points.{name}", np.array([0.0, 0.0, 1.0])
        refuse_patch(name, place)
        refuse_not_global(name, at)
        apart = np.linalg.norm(self.places - at, axis=1)
        if apart.min() <= tolerance:
            node = int(np.argmin(apart))
            return Point(name, self.places[node], np.full(6, self.first + node), np.arange(6), np.eye(6), up)
        distances, shares = distance_to_segments(at, self.start, self.end)
        bar = int(np.argmin(distances))
        if distances[bar] > tolerance:
            raise InputError(
                f"{where}.at",
                got=f"({at[0]:g}, {at[1]:g}, {at[2]:g}) m, {distances[bar]:.4g} m off {self.name}",
                expected="a place on its axis",
            )
        nodes, rows = self.rows(np.array([bar]), shares[[bar]])
        position = self.start[bar] + shares[bar] * (self.end[bar] - self.start[bar])
        return Point(name, position, *flat_rows(nodes, rows, np.ones(1)), normal=up)

    def spread(self, where: str, region: Region, tolerance: float, order: int) -> Spread:
        if region.kind != "whole":
            raise InputError(where, got=f"a {region.kind} of a frame", expected="all of the frame")
        places, shares = gauss_interval(order)
        bars = np.repeat(np.arange(len(self.bars)), order)
        weights = self.lengths[bars] * np.tile(shares, len(self.bars))
        return Spread(*self.rows(bars, np.tile(places, len(self.bars))), weights, "length", "frame")

    def drawn(self, divisions: int, along: int, n_nodes: int) -> Drawn:
        bars = np.repeat(np.arange(len(self.bars)), along + 1)
        share = np.tile(np.linspace(0.0, 1.0, along + 1), len(self.bars))
        nodes, rows = self.rows(bars, share)
        places = (1.0 - share)[:, None] * self.start[bars] + share[:, None] * self.end[bars]
        n = np.arange(len(bars)).reshape(len(self.bars), along + 1)
        pieces = np.stack([n[:, :-1], n[:, 1:]], axis=-1).reshape(-1, 2)
        return Drawn(places, sparse_rows(nodes, rows[:, :3], n_nodes), np.empty((0, 4), np.int64), pieces)


def frames_of(model: Model) -> list[FrameMesh]:
    """The frames of a model."""
    return [part for part in model.parts.values() if isinstance(part, FrameMesh)]


def _merged(places: Floats, tolerance: float) -> tuple[Floats, Integers]:
    """Distinct places, in the order of their first appearance, and the number of each given one."""
    pairs = scipy.spatial.KDTree(places).query_pairs(tolerance, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(places), len(places)))
    labels = connected_components(graph, directed=False)[1]
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return places[first[order]], rank[inverse]
