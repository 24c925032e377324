"""Frames: bars along lines, with rigid arms where they are eccentric."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import Protocol

import numpy as np
import scipy
from numpy.typing import ArrayLike
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import N_COMPONENTS, UZ
from femstruct.declared import checked
from femstruct.elements import frame, members
from femstruct.elements.frame import nodes_per_bar
from femstruct.elements.members import directions
from femstruct.elements.polynomials import gauss_interval
from femstruct.errors import Finding, InputError
from femstruct.model.imported_mesh import Makes
from femstruct.model.layout import Grids, Layout, Segment
from femstruct.model.materials import AnyMaterial, Given, Loss, given_fields, of_bar, refuse_laboratory
from femstruct.model.model import Model
from femstruct.model.part import Drawn, Meshed, OwnDofs, Part, RegionSpread, nodal_dofs, refuse_not_global, refuse_patch
from femstruct.model.probe import Point, StressPlaces
from femstruct.model.regions import Region, Vector, carry_along_arms, distance_to_segments, flat_rows, sparse_rows
from femstruct.model.scatter import scatter
from femstruct.model.sections import Section
from femstruct.model.structure import PlaceOn
from femstruct.parts.plausibility import section_findings
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Lines of frames as straight pieces, with the rigid arms between the line and the flexible bars.
# ----------------------------------------------------------------------------------------------------------------------


class Lines(Protocol):
    """What is said of the lines of a frame."""

    @property
    def name(self) -> str: ...
    @property
    def lines(self) -> tuple[tuple[Vector, ...], ...]: ...
    @property
    def start_offset(self) -> Vector: ...
    @property
    def end_offset(self) -> Vector: ...


def frame_segments(frame: Lines, tolerance: float) -> tuple[Segment, ...]:
    """The straight pieces of a frame's lines, moved by their rigid arms as `Frame` says.

    Raises InputError for a line of fewer than two points and for two consecutive points in one place.
    """
    segments = []
    if not frame.lines:
        raise InputError(f"parts.{frame.name}.lines", got="no lines", expected="at least one")
    for number, line in enumerate(frame.lines):
        where = f"parts.{frame.name}.lines[{number}]"
        if len(line) < 2:
            raise InputError(where, got=f"{len(line)} point", expected="at least two points")
        points = np.asarray(line, dtype=np.float64)
        offsets = _vertex_offsets(frame, points)
        tips = points + offsets
        lengths = np.minimum(*(np.linalg.norm(np.diff(ends, axis=0), axis=1) for ends in (points, tips)))
        if lengths.min() <= tolerance:
            raise InputError(where, got=f"two points {lengths.min():g} m apart", expected="a length above zero")
        for index, (start, end) in enumerate(pairwise(tips)):
            arms = offsets[index : index + 2]
            if (arms[0] != arms[1]).any():  # what an arm has along the line shortens the bar and is an end's own
                along = (points[index + 1] - points[index]) / np.linalg.norm(points[index + 1] - points[index])
                arms = arms - np.outer(arms @ along, along)
            segments.append(Segment((frame.name, number, index), start, end, arms))
    return tuple(segments)


def _vertex_offsets(frame: Lines, points: Floats) -> Floats:
    """Rigid arms at the points of a line [n, 3]: between two given ones linear in the distance along it."""
    first, last = np.asarray(frame.start_offset, dtype=np.float64), np.asarray(frame.end_offset, dtype=np.float64)
    if (first == last).all():
        return np.tile(first, (len(points), 1))
    offsets = np.zeros_like(points)
    if first.any() and last.any():
        length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        offsets = first + np.outer(length / max(length[-1], np.finfo(float).tiny), last - first)
    offsets[0], offsets[-1] = first, last
    return offsets


# ----------------------------------------------------------------------------------------------------------------------
# Bars under an even load between their ends: what it adds to what the motion of their nodes tells.
#
# The deflection of a bar between nodes that do not move, under a load p per length and fixed at both ends, is
#
#     v = p L^4 s^2 (1 - s)^2 / 24 E I + p L^2 s (1 - s) / 2 k G A,    E I v'' = p L^2 (1 - 6 s + 6 s^2) / 12
#
# The ends of a bar move exactly under consistent loads; between them its polynomials leave this out, but for what the
# middle node of "timoshenko18" has of it: all of the stretch and of the shear, and nothing of the bending.
#
# Reference: J. S. Przemieniecki, Theory of Matrix Structural Analysis (McGraw-Hill 1968), section 5.6.
# ----------------------------------------------------------------------------------------------------------------------


def forces(kind: str, load: Floats, length: ArrayLike, place: ArrayLike) -> Floats:
    """Section forces [m, 6] N Vy Vz [N], T My Mz [N m] that an even load adds to those of the nodes, without shear.

    Parameters
    ----------
    kind : str
        "euler", "timoshenko" or "timoshenko18".
    load : Floats [m, 3]
        Along local x, y, z [N/m]; length [m] of the bars [m].
    place : ArrayLike [m]
        From 0 at end i to 1 at end j.

    Examples
    --------
    Half-way along a bar of 2 m under 12 N/m, fixed at both ends: p L^2 / 24, and p L^2 / 12 at its ends:

    >>> forces("euler", np.array([[0.0, 12.0, 0.0]] * 2), 2.0, np.array([0.0, 0.5]))[:, 5]
    array([ 4., -2.])
    """
    length, s = np.asarray(length, dtype=np.float64), np.asarray(place, dtype=np.float64)
    found = np.zeros((len(load), 6))
    if nodes_per_bar(kind) == 2:
        found[:, 0] = load[:, 0] * length * (0.5 - s)
    bending = length**2 * (1.0 - 6.0 * s + 6.0 * s**2) / 12.0
    found[:, 4], found[:, 5] = -load[:, 2] * bending, load[:, 1] * bending
    return found


def deflection(
    kind: str,
    load: Floats,
    length: ArrayLike,
    place: ArrayLike,
    E: float,
    G: float,
    A: float,
    Iy: float,
    Iz: float,
    ky: float,
    kz: float,
) -> Floats:
    """Displacement [m, 3] of the axis along local x, y, z [m] that an even load adds to that of the nodes.

    Arguments as `forces`, with the constants of `femstruct.elements.frame.stiffness`.

    >>> moved = deflection("euler", np.array([[0.0, 384.0, 0.0]]), 1.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    >>> moved.tolist()  # p L^4 / 384 E I
    [[0.0, 1.0, 0.0]]
    """
    length, s = np.asarray(length, dtype=np.float64), np.asarray(place, dtype=np.float64)
    bent, between = (length**2 * s * (1.0 - s)) ** 2 / 24.0, length**2 * s * (1.0 - s) / 2.0
    found = np.zeros((len(load), 3))
    found[:, 1], found[:, 2] = load[:, 1] * bent / (E * Iz), load[:, 2] * bent / (E * Iy)
    if nodes_per_bar(kind) == 2:
        found[:, 0] = load[:, 0] * between / (E * A)
    if kind == "timoshenko":
        found[:, 1] += load[:, 1] * between / (ky * G * A)
        found[:, 2] += load[:, 2] * between / (kz * G * A)
    return found


# ----------------------------------------------------------------------------------------------------------------------
# Frames as bars between nodes: what they have at their nodes, their matrices, and what points read of them.
# ----------------------------------------------------------------------------------------------------------------------

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
            frame.stiffness(part.element, lengths, E=E, G=G, A=A, Iy=Iy, Iz=Iz, J=section.J, ky=ky, kz=kz),
            frame.mass(part.element, lengths, rho=part.material.rho, A=A, Iy=Iy, Iz=Iz, ky=ky, kz=kz, E=E, G=G),
        )
        of_bars = numbers[self.bars - self.first].reshape(len(self.bars), -1)
        at_nodes = [
            members.with_offsets(members.to_global(matrix, self.axes), *np.moveaxis(self.arms, 1, 0))
            for matrix in local
        ]
        return scatter(at_nodes[0], at_nodes[1], of_bars, 6 * len(self.places))

    def rows(self, bars: Integers, shares: Floats) -> tuple[Integers, Floats]:
        """Motion of places along bars from the components of their nodes.

        Parameters
        ----------
        bars : Integers [p]
            Which.
        shares : Floats [p]
            From 0 at the start to 1 at the end of the flexible part.

        Returns
        -------
        tuple[Integers, Floats]
            Nodes [p, k] and rows [p, 6, k, 7], k nodes a bar: three displacements and three rotations, global axes.
        """
        part, (E, G, section) = self.part, self.part.along
        local = frame.interpolate(
            part.element,
            self.lengths[bars],
            xi=shares,
            E=E,
            G=G,
            A=section.A,
            Iy=section.Iy,
            Iz=section.Iz,
            ky=section.ky,
            kz=section.kz,
        )
        turn = members.rotation(self.axes[bars], 1)
        return self.bars[bars], self._on_nodes(np.swapaxes(turn, -1, -2) @ local, bars)

    def _on_nodes(self, local: Floats, bars: Integers) -> Floats:
        """Rows [p, r, k, 7] on the components of the nodes of bars, from rows [p, r, 6 k] on their local DOFs."""
        k = self.bars.shape[1]
        arms = members.rigid_arms(*np.moveaxis(self.arms[bars], 1, 0))
        rows = local @ members.rotation(self.axes[bars], k) @ arms
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
        return nodes, carry_along_arms(rows, places - self._along(bars, shares))

    def section_forces(self, bars: Integers, shares: Floats) -> Floats:
        """Rows [p, 6, k, 7] of N Vy Vz [N] and T My Mz [N m] at places along bars, as
        `femstruct.elements.frame.resultants`, from the components of their nodes."""
        part, (E, G, section) = self.part, self.part.along
        A, Iy, Iz, J, ky, kz = section.A, section.Iy, section.Iz, section.J, section.ky, section.kz
        local = frame.resultants(
            part.element, self.lengths[bars], xi=shares, E=E, G=G, A=A, Iy=Iy, Iz=Iz, J=J, ky=ky, kz=kz
        )
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
        added = [forces(self.part.element, load[..., i], self.lengths[bars], shares) for i in range(3)]
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
        sagged = deflection(part.element, load, length=lengths, place=shares, E=E, G=G, A=A, Iy=Iy, Iz=Iz, ky=ky, kz=kz)
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

    def spread(self, where: str, region: Region, tolerance: float, order: int) -> RegionSpread:
        if region.kind != "whole":
            raise InputError(where, got=f"a {region.kind} of a frame", expected="all of the frame")
        places, shares = gauss_interval(order)
        bars = np.repeat(np.arange(len(self.bars)), order)
        weights = self.lengths[bars] * np.tile(shares, len(self.bars))
        return RegionSpread(*self.rows(bars, np.tile(places, len(self.bars))), weights, "length", "frame")

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


# ----------------------------------------------------------------------------------------------------------------------
# Frames.
# ----------------------------------------------------------------------------------------------------------------------

MOST_BARS = 100_000  # more is a slip of a unit, and does not fit into memory


@stored_as("frame/1")
@dataclass(frozen=True)
@checked("parts")
class Frame(Part):
    """Bars along polylines of global points; coincident ends of its own lines are joined.

    material : of an orthotropic one x is along the bars, y and z along those of the section. mesh : largest element
    length [m], None for one element a segment; a line that lies in a plate it is joined to takes the plate's nodes
    instead, and bars on a slab are no longer than its cells. orientation : a vector the section's local z
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
    >>> from femstruct.model.sections import rectangle
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

    def stands_for(self) -> frozenset[Makes]:
        return frozenset((Makes.BARS,))

    def described(self) -> tuple[Given, ...]:
        return given_fields(self, {"lines": "m", "mesh": "m", "start_offset": "m", "end_offset": "m"})

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
            corners = np.array(self.lines[int(segment.key[1])][int(segment.key[2]) :][:2])
            # A bar that its arm makes longer passes its own end, which is no place of the bar.
            apart = np.linalg.norm(stands[:, None] - corners, axis=2).min(axis=1)
            kept = np.r_[True, apart[1:-1] > layout.tolerance, True]
            places, stands = places[kept], stands[kept]
            middles.append((stands[:-1] + stands[1:]) / 2.0)
            stands[0], stands[-1] = corners
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
        covering = layout.covering.get(self.name, 0.0)
        return FrameMesh(
            self,
            first,
            stands=points,
            bars=first + bars,
            start=ends[:, 0],
            end=ends[:, 1],
            arms=arms,
            axes=axes,
            covering=covering,
        )


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
