"""Frames as bars between nodes: what they have at their nodes, their matrices, and what points read of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import N_COMPONENTS, UZ
from femstruct.elements import frame, placement
from femstruct.elements.frame import nodes_per_bar
from femstruct.elements.quadrature import gauss_interval
from femstruct.errors import InputError
from femstruct.model.grid.geometry import distance_to_segments
from femstruct.model.grid.layout import Segment
from femstruct.model.grid.scatter import scattered
from femstruct.model.materials.loss_by_frequency import Loss, refuse_laboratory
from femstruct.model.meshed import Drawn, Meshed, OwnDofs, Spread, nodal_dofs, refuse_not_global, refuse_patch
from femstruct.model.model import Model
from femstruct.model.probe import Point, StressPlaces
from femstruct.model.region import Region
from femstruct.model.rows import carried, flat_rows, sparse_rows
from femstruct.model.structure import PlaceOn
from femstruct.parts.of_frames import loaded_bar
from femstruct.parts.of_frames.frame_lines import frame_segments
from femstruct.tags import stored_as

if TYPE_CHECKING:
    from femstruct.parts.frame import Frame

BETWEEN = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Places along every bar where it is looked at: what an even load adds is a parabola, largest anywhere. Its peak is
missed by p L^2 / 128 at most; a simply supported bar has p L^2 / 8, in its middle."""


@stored_as("frame mesh/1")
@dataclass(frozen=True, eq=False)
class FrameMesh(Meshed):
    """A frame as bars.

    first : number of its first node. stands [n, 3] : places of its nodes [m]. bars [b, k] : the two end nodes, then the
    middle one of bars of three. start, end [b, 3] : ends of the flexible bars, at the tips of the rigid arms [m].
    arms [b, k, 3] : from the nodes to the flexible bar, global axes [m]. axes [b, 3, 3] : rows are local x, y, z.
    covering : mass that lies evenly along all of it beside its own [kg/m].
    """

    part: Frame
    first: int
    stands: Floats
    bars: Integers
    start: Floats
    end: Floats
    arms: Floats
    axes: Floats
    covering: float = 0.0

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
        return refuse_laboratory(f"parts.{self.name}.material", self.part.material.loss_factor)

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

    def pieces(self, tolerance: float) -> tuple[Segment, ...]:
        """The straight pieces of its lines, each of one or more bars."""
        return frame_segments(self.part, tolerance)

    def reach(self, direction: Floats) -> float:
        """How far sections reach from the axis of the bars along a direction [3] [m]; 0 without an outline."""
        if not self.part.section.outline:
            return 0.0
        return float((self.axes[:, 1:] @ direction @ np.array(self.part.section.outline).T).max())

    def motion_at(self, places: Floats, tolerance: float) -> tuple[Integers, Floats]:
        """They move with the nearest place of its bars, through rigid arms."""
        nearest = [distance_to_segments(place, self.start, self.end) for place in places]
        bars = np.array([int(np.argmin(distances)) for distances, _ in nearest], dtype=np.int64)
        shares = np.array([along[bar] for bar, (_, along) in zip(bars, nearest, strict=True)])
        nodes, rows = self.rows(bars, shares)
        return nodes, carried(rows, places - self._along(bars, shares))

    def section_forces(self, bars: Integers, shares: Floats) -> Floats:
        """Rows [p, 6, k, 7] of N Vy Vz [N] and T My Mz [N m] at places along bars, as
        `femstruct.elements.frame.resultants`, from the components of their nodes."""
        part, (E, G, section) = self.part, self.part.along
        A, Iy, Iz, J, ky, kz = section.A, section.Iy, section.Iz, section.J, section.ky, section.kz
        local = frame.resultants(part.element, self.lengths[bars], shares, E, G, A, Iy, Iz, J, ky, kz)
        return self._on_nodes(local, bars)

    def stresses(self, n_nodes: int) -> StressPlaces:
        """Stretch, bending and torsion at both ends of every bar and between them, at the outermost points of its
        section; what shear forces add is left out. The largest shear stress of torsion is taken for every point, on the
        safe side."""
        section = self.part.section
        if not section.outline:
            raise InputError(
                f"parts.{self.name}.section",
                got=f"'{section.name}' by its constants, without an outline",
                expected="an outline for stresses",
                do="give the section by its shape, such as {shape: box, ..}",
            )
        bars, shares = self._looked_at()
        rows = self._at_outline(self.section_forces(bars, shares))
        load = self._load()[bars]
        added = [loaded_bar.forces(self.part.element, load[..., i], self.lengths[bars], shares) for i in range(3)]
        carried = self._at_outline(np.stack(added, axis=-1)[:, :, None])
        count, points = len(bars), len(section.outline)
        across = np.einsum("pc,bcj->bpj", np.array(section.outline), self.axes[bars][:, 1:])
        nodes = np.repeat(self.bars[bars], points, axis=0)
        return StressPlaces(
            (self._along(bars, shares)[:, None] + across).reshape(-1, 3),
            ("xx", "xy"),
            sparse_rows(nodes, rows.reshape(count * points, 2, -1, N_COMPONENTS), n_nodes),
            tuple(f"at y = {1e3 * a:.4g} mm, z = {1e3 * b:.4g} mm of the section" for a, b in section.outline),
            axes=np.repeat(self.axes[bars], points, axis=0),
            carried=carried.reshape(-1, 2, 3),
        )

    def moved(self, displacement: Floats, weight: float) -> Floats:
        """Of places along its bars, with what they sag between their nodes."""
        part, (E, G, section) = self.part, self.part.along
        bars, shares = self._looked_at()
        nodes, rows = self.rows(bars, shares)
        found = np.einsum("pikc,pkc->pi", rows[:, :3], displacement[nodes])
        A, Iy, Iz, ky, kz = section.A, section.Iy, section.Iz, section.ky, section.kz
        load, lengths = weight * self._load()[bars, :, UZ], self.lengths[bars]
        sagged = loaded_bar.deflection(part.element, load, lengths, shares, E, G, A, Iy, Iz, ky, kz)
        return np.asarray(found + np.einsum("pi,pij->pj", sagged, self.axes[bars]))

    def _looked_at(self) -> tuple[Integers, Floats]:
        """Bars [p] and shares [p] of their length: `BETWEEN` of each."""
        count = len(self.bars)
        return np.repeat(np.arange(count), len(BETWEEN)), np.tile(BETWEEN, count)

    def _along(self, bars: Integers, shares: Floats) -> Floats:
        """Places [p, 3] on the axes of bars [m]."""
        return np.asarray(self.start[bars] + shares[:, None] * (self.end - self.start)[bars])

    def _at_outline(self, forces: Floats) -> Floats:
        """Stresses xx and xy [p, o, 2, k, c] at the outermost points of the section, of section forces [p, 6, k, c]."""
        section = self.part.section
        y, z = np.array(section.outline).T[:, :, None, None]
        N, T, My, Mz = (forces[:, None, i] for i in (0, 3, 4, 5))
        normal = N / section.A + My * z / section.Iy - Mz * y / section.Iz
        shear = np.broadcast_to(T * section.twist_arm / section.J, normal.shape)
        return np.stack([normal, shear], axis=2)

    def _load(self) -> Floats:
        """Forces per length along local x, y, z [b, 3, 3] [N s^2/m^2] of bars that accelerate along global x, y, z."""
        return np.asarray(-(self.part.material.rho * self.part.section.A + self.covering) * self.axes)

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
        (position,) = self._along(np.array([bar]), shares[[bar]])
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
