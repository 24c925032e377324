"""Frames: bars along lines, with rigid arms where they are eccentric."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
import scipy
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers
from femstruct.declared import checked
from femstruct.elements import frame
from femstruct.elements.frame import nodes_per_bar
from femstruct.elements.placement import directions
from femstruct.errors import Finding, InputError
from femstruct.model.given import Given, given
from femstruct.model.grid.layout import Grids, Layout
from femstruct.model.imported.stated.left_out import Makes
from femstruct.model.materials.bar import of_bar
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.part import Part
from femstruct.model.region import Vector
from femstruct.model.section import Section
from femstruct.parts.of_frames.frame_lines import frame_segments
from femstruct.parts.of_frames.frame_mesh import FrameMesh
from femstruct.parts.plausibility import section_findings
from femstruct.tags import stored_as

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

    def stands_for(self) -> frozenset[Makes]:
        return frozenset((Makes.BARS,))

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
        return FrameMesh(self, first, points, first + bars, ends[:, 0], ends[:, 1], arms, axes, covering)


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
