"""The structured mesher: a Structure becomes a Model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import expect
from femstruct.errors import FemstructError, InputError, list_some
from femstruct.model.layout import Layout, Segment, SharedLine, Track, lines_under, stretch_inside
from femstruct.model.model import Mesh, Model
from femstruct.model.part import Elastic, Inert, Meshed, Part, Tie
from femstruct.model.plates_and_bars import membrane_plates, offsets_to_write, steadied
from femstruct.model.probe import Point
from femstruct.model.regions import (
    Region,
    clip,
    distance_to_rectangle,
    distance_to_segments,
    intersection_line,
    to_rectangle,
)
from femstruct.model.structure import AirBetween, Constraint, Joint, PlaceOn, Structure, Support, SurfaceOn, extent
from femstruct.model.supports_and_joints import elastic_edges, joint, shared_nodes, shared_tie, support

# ----------------------------------------------------------------------------------------------------------------------
# Where nodes are needed: by the parts themselves, by regions, supports, joints, and points that carry something.
# ----------------------------------------------------------------------------------------------------------------------

_PARALLEL = 1e-6  # sine of an angle: less is rounding
_ROUNDING = 1e-9  # of a diagonal of cells
RELATIVE_TOLERANCE = 1e-6
"""Places closer than this share of the structure's extent are one place."""


def plan_layout(structure: Structure) -> Layout:
    """The layout of a structure: all that asks for a node has asked.

    Raises InputError for sizes that cannot be, for names that do not exist, and for joined parts that do not touch.
    """
    layout = Layout(RELATIVE_TOLERANCE * extent(structure))
    layout.taken = tuple(some for part in structure.parts for some in part.taken())
    for part in structure.parts:
        part.lay_out(layout)
    for part in structure.parts:
        part.needs(layout)
    for surface in structure.surfaces:
        layout.on_region(f"surfaces.{surface.name}.region", surface.on, surface.region)
    for held in structure.supports:
        if held.line is not None:
            layout.on_region(f"supports.{held.name}.line", held.on or "", Region("line", line=held.line))
    for constraint in structure.constraints:
        constraint.needs(layout, {point.name: point for point in structure.points})
    _carrying_points(structure, layout)
    for joined in structure.joints:
        _joint(layout, joined, {part.name: part for part in structure.parts})
    _points_of_bars(structure, layout)
    layout.stretched = membrane_plates(structure, layout)
    return layout


def _carrying_points(structure: Structure, layout: Layout) -> None:
    """Springs, masses and supports hold a node; a point that is only struck or recorded does not."""
    used = {name for part in structure.parts for name in part.carriers()}
    used |= {support.at for support in structure.supports}
    used |= {name for constraint in structure.constraints for name in constraint.holds()}
    for point in structure.points:
        numbered = {f"{point.name}.{number + 1}" for number in range(len(point.at))}
        for number, place in enumerate(point.at):
            if point.name in used or (f"{point.name}.{number + 1}" in used & numbered):
                _carrying_place(layout, point, np.asarray(place, dtype=np.float64))


def _points_of_bars(structure: Structure, layout: Layout) -> None:
    """Nodes at all points of bars, and where else they are loaded: a force between the nodes of a bar bends it less
    than it should, by P L^3 / 192 E I in its middle, and its moment there is not seen. Where bars have the nodes of a
    plate, the plate's size counts."""
    for point in structure.points:
        for place in point.at if point.on in layout.segments else ():
            layout.on_bars(point.on, np.asarray(place, dtype=np.float64), own=True)
    for name, at in layout.loaded:
        layout.on_bars(name, at, own=True)


def _carrying_place(layout: Layout, point: PlaceOn, place: Floats) -> None:
    if point.on in layout.rectangles:
        layout.on_rectangle(point.on, np.clip(place[:2], 0.0, layout.rectangles[point.on].size))
    elif point.on in layout.segments:
        layout.on_bars(point.on, place)


def _joint(layout: Layout, joint: Joint, parts: Mapping[str, Part]) -> None:
    if joint.a == joint.b:
        raise InputError(f"joints.{joint.name}", got=f"'{joint.a}' twice", expected="two parts")
    known = layout.rectangles.keys() | layout.segments.keys() | layout.boxes.keys()
    if not {joint.a, joint.b} <= known:
        _at_corners(layout, [part for end in (joint.a, joint.b) if (part := parts.get(end)) is not None])
    elif joint.a in layout.boxes or joint.b in layout.boxes:
        _on_box(layout, *((joint.b, joint.a) if joint.a in layout.boxes else (joint.a, joint.b)))
    elif joint.a in layout.rectangles and joint.b in layout.rectangles:
        _rectangle_on_rectangle(layout, joint)
    elif joint.a in layout.segments and joint.b in layout.segments:
        _bars_on_bars(layout, joint)
    elif joint.a in layout.segments:
        _bars_on_rectangle(layout, joint, joint.a, joint.b)
    else:
        _bars_on_rectangle(layout, joint, joint.b, joint.a)


def _at_corners(layout: Layout, parts: Sequence[Part]) -> None:
    """Nodes of plates and frames at the corners of the parts they are joined to, of kinds whose nodes are their own."""
    for part in parts:
        for other in parts:
            corners = other.corners() if other is not part else np.zeros((0, 3))
            if part.name in layout.rectangles:
                rectangle = layout.rectangles[part.name]
                local = to_rectangle(rectangle, layout.axes_of[part.name], corners)
                met = distance_to_rectangle(local, rectangle.size) <= layout.tolerance
                for place in np.unique(np.clip(local[met, :2], 0.0, rectangle.size), axis=0):
                    layout.on_rectangle(part.name, place)
            for segment in layout.segments.get(part.name, ()):
                near = np.minimum(
                    *(_from_line(corners, *ends) for ends in (segment.feet, [segment.start, segment.end]))
                )
                for corner in corners[near <= layout.tolerance]:
                    layout.on_bars(part.name, corner)
                layout.share(segment, corners[near <= layout.tolerance])
                _between_nodes(layout, segment, other, corners[near <= layout.tolerance])


def _between_nodes(layout: Layout, segment: Segment, other: Part, common: Floats) -> None:
    """Bars no longer than the cells that they lie on beside the nodes there, as oblique ribs do: they are joined at
    their ends alone.

    Parameters
    ----------
    common : Floats [n, 3]
        Nodes on the bars, which divide them already.
    """
    body = other.body()
    if not np.isfinite(other.cell_size) or body is None or body.across is None:
        return
    local = (segment.feet - body.corner) @ body.axes.T
    heights = (other.corners()[:1] - segment.feet) @ body.axes[body.across]
    if np.abs(heights).max() > layout.tolerance:
        return
    size = float(body.size[0]), float(body.size[1])
    stretch = clip(local[0], local[1], size, layout.tolerance)
    if stretch is None:
        return
    along = segment.feet[1] - segment.feet[0]
    shares = np.sort(np.concatenate([stretch, (common - segment.feet[0]) @ along / (along @ along)]))
    wide = np.diff(shares) * np.linalg.norm(along) > np.sqrt(2.0) * other.cell_size * (1.0 + _ROUNDING)
    middles = segment.feet[0] + ((shares[1:] + shares[:-1])[wide, None] / 2.0) * along
    apart = np.linalg.norm(middles[:, None] - other.corners()[None], axis=2).min(axis=1)
    axis = layout.grids[segment.key]
    if (apart <= other.cell_size).any():  # elsewhere they lie over an opening
        axis.size = min(axis.size, other.cell_size)


def _from_line(places: Floats, start: Floats, end: Floats) -> Floats:
    """Distances of places [n, 3] from a segment [m]."""
    along = end - start
    share = np.clip((places - start) @ along / (along @ along), 0.0, 1.0)
    distances: Floats = np.linalg.norm(start + share[:, None] * along - places, axis=1)
    return distances


def _rectangle_on_rectangle(layout: Layout, joint: Joint) -> None:
    reach = max(layout.tolerance, joint.reach or 0.0)  # to the face of a plate, from the edge of another
    start, end = intersection_line(layout.rectangles[joint.a], layout.rectangles[joint.b], reach)
    tracks = []
    for name in (joint.a, joint.b):
        ends = to_rectangle(layout.rectangles[name], layout.axes_of[name], np.stack([start, end]))
        ends[:, :2] = np.clip(ends[:, :2], 0.0, layout.rectangles[name].size)
        layout.on_rectangle(name, ends[0])
        layout.on_rectangle(name, ends[1])
        direction = int(np.argmax(np.abs(ends[1] - ends[0])))
        tracks.append(Track((name, direction), float(ends[0, direction]), float(ends[1, direction])))
    if np.linalg.norm(end - start) > layout.tolerance:
        layout.shared += [SharedLine(tracks[0], tracks[1]), SharedLine(tracks[1], tracks[0])]


def _bars_on_bars(layout: Layout, joint: Joint) -> None:
    nearest = inf
    for one, other in ((joint.a, joint.b), (joint.b, joint.a)):
        starts, ends = np.stack([segment.feet for segment in layout.segments[other]], axis=1)
        for vertex in layout.vertices[one]:
            nearest = min(nearest, float(distance_to_segments(vertex, starts, ends)[0].min()))
            layout.on_bars(other, vertex)
    for segment in layout.segments[joint.a]:
        for facing in layout.segments[joint.b]:
            crossing, apart = _crossing(segment.feet, facing.feet)
            nearest = min(nearest, apart)
            if apart <= layout.tolerance:
                layout.on_bars(joint.a, crossing)
                layout.on_bars(joint.b, crossing)
    if nearest > (joint.reach or 0.0):
        _refuse_apart(layout, joint, nearest)


def _crossing(one: Floats, other: Floats) -> tuple[Floats, float]:
    """The place [3] of a segment [2, 3] where the line of another is nearest, between the ends of both, and how far
    they are apart there [m]; infinite for parallel ones, and where that is beyond an end."""
    a, b, away = one[1] - one[0], other[1] - other[0], other[0] - one[0]
    normal = np.cross(a, b)
    square = float(normal @ normal)
    if square <= _PARALLEL**2 * float(a @ a) * float(b @ b):
        return one[0], inf
    s, t = float(np.cross(away, b) @ normal) / square, float(np.cross(away, a) @ normal) / square
    place = one[0] + s * a
    if not (0.0 <= s <= 1.0 and 0.0 <= t <= 1.0):
        return place, inf
    return place, float(np.linalg.norm(place - other[0] - t * b))


def _bars_on_rectangle(layout: Layout, joint: Joint, frame: str, plate: str) -> None:
    size, tolerance = layout.rectangles[plate].size, layout.tolerance
    vertices = layout.vertices[frame]
    local = to_rectangle(layout.rectangles[plate], layout.axes_of[plate], vertices)
    distances = distance_to_rectangle(local, size)
    for vertex in local[distances <= tolerance]:
        layout.on_rectangle(plate, np.clip(vertex[:2], 0.0, size))
    touching = bool((distances <= tolerance).any())
    for segment in layout.segments[frame]:
        touching |= _segment_on_rectangle(layout, segment, plate)
    if not touching:
        feet, arms = (np.concatenate([getattr(one, of) for one in layout.segments[frame]]) for of in ("feet", "arms"))
        corner, normal = np.asarray(layout.rectangles[plate].origin), layout.axes_of[plate][2]
        _refuse_apart(
            layout, joint, float(distances.min()), offsets_to_write((frame, plate), feet, arms, corner, normal)
        )


def _segment_on_rectangle(layout: Layout, segment: Segment, plate: str) -> bool:
    size, tolerance = layout.rectangles[plate].size, layout.tolerance
    ends = to_rectangle(layout.rectangles[plate], layout.axes_of[plate], segment.feet)
    heights = ends[:, 2]
    axis = layout.grids[segment.key]
    if np.abs(heights).max() > tolerance:
        if heights[0] * heights[1] > 0:
            return False
        share = heights[0] / (heights[0] - heights[1])
        place = ends[0] + share * (ends[1] - ends[0])
        if distance_to_rectangle(place, size) > tolerance:
            return False
        layout.on_rectangle(plate, np.clip(place[:2], 0.0, size))
        axis.require(float(share) * axis.length)
        return True
    stretch = clip(ends[0], ends[1], size, tolerance)
    if stretch is None:
        return False
    inside = [float(np.clip(share, 0.0, 1.0)) for share in stretch]
    places = [np.clip(ends[0] + share * (ends[1] - ends[0]), 0.0, [*size, inf]) for share in inside]
    for share, place in zip(inside, places, strict=True):
        axis.require(share * axis.length)
        layout.on_rectangle(plate, place)
    own = Track(segment.key, inside[0] * axis.length, inside[1] * axis.length)
    if own.end - own.start > tolerance:
        _share(layout, own, plate, places[0], places[1])
    return True


def _share(layout: Layout, own: Track, plate: str, start: Floats, end: Floats) -> None:
    """A frame line in a plate takes the plate's nodes; an oblique one gives it crossings at its own."""
    along = np.abs(end - start)[:2] > layout.tolerance
    for direction in np.flatnonzero(along):
        track = Track((plate, int(direction)), float(start[direction]), float(end[direction]))
        if along.all():
            layout.shared.append(SharedLine(own, track))
        else:
            layout.grids[own.key].given.append((own.start, own.end))
            layout.shared += [SharedLine(track, own), SharedLine(own, track)]


def _on_box(layout: Layout, name: str, box: str) -> None:
    """Nodes of a plate or frame where it enters and leaves a block."""
    solid = layout.boxes[box]
    if name in layout.rectangles:
        for place in lines_under(solid, layout.rectangles[name], layout.axes_of[name]):
            layout.on_rectangle(name, place)
    low = np.asarray(solid.origin)
    for segment in layout.segments.get(name, ()):
        middle, half = segment.feet.mean(axis=0), np.diff(segment.feet, axis=0)[0] / 2.0
        first, last = stretch_inside(middle[None], half, low - layout.tolerance, low + solid.size + layout.tolerance)
        if first[0] <= last[0]:
            length = layout.grids[segment.key].length
            layout.grids[segment.key].require(*((1.0 + share) / 2.0 * length for share in (first[0], last[0])))


def _refuse_apart(layout: Layout, joint: Joint, distance: float, do: str | None = None) -> None:
    if distance > layout.tolerance:
        raise InputError(
            f"joints.{joint.name}",
            got=f"{joint.a} and {joint.b} {distance:.4g} m apart",
            expected="parts that touch: an end or a line of a frame on the mid-surface of a plate or on a frame",
            do=do or "move one of them",
        )


# ----------------------------------------------------------------------------------------------------------------------
# The structured mesher.
# ----------------------------------------------------------------------------------------------------------------------


def mesh_structure(structure: Structure) -> Model:
    """The meshed model of a structure.

    Plates have rectangular grids, bars run along their lines, a block has one node. Nodes are put where joints, regions
    and their edges, supports, and points that carry a spring, a mass or a support need them, and at all points of
    frames; sizes and divisions of the parts are the least density between. A point of a plate that is only driven or
    recorded is interpolated and moves no node; so is one of bars where these have the nodes of a plate.
    A frame line lying in a plate it is joined to takes the plate's nodes, whatever its own size. Every part has nodes
    of its own; parts are connected by joints, which are equations, and by springs and foundations. Parts of one mesh
    file that share nodes there are joined at these.

    Raises InputError, naming the part or joint, where joined parts do not touch, a region, point or line leaves its
    part, or a name does not exist.

    >>> from femstruct.model.materials import Material
    >>> from femstruct.parts.plate import Plate
    >>> acrylic = Material("acrylic", E=5.9e9, nu=0.35, rho=1171.875)
    >>> floor = Plate("floor", acrylic, 0.005, origin=(0.0, 0.0, 0.0), size=(0.4, 0.32), mesh=(4, 3))
    >>> mesh_structure(Structure("a floor", (floor,))).mesh.quads.shape
    (12, 4)
    """
    expect("mesh_structure", structure, Structure, "Structure(title, (part, ..)) takes parts")
    _check_names(structure)
    layout = plan_layout(structure)
    grids, tolerance = layout.settled(), layout.tolerance
    parts: dict[str, Meshed] = {}
    first = 0
    for part in structure.parts:
        meshed = part.meshed(layout, grids, first)
        if meshed is not None:
            parts[part.name] = meshed
            first += len(meshed.places)
    mesh = _mesh_of(parts)
    points = _points(structure.points, parts, tolerance)
    bare = Model(structure, mesh, parts=parts, elastics=(), inerts=(), ties=(), points=points, surfaces={})
    elastics, inerts, ties = _fastened(structure, bare, tolerance)
    surfaces = {
        item.name: _part_of(f"surfaces.{item.name}.on", item.on, parts).surface(item, mesh.n_nodes, tolerance)
        for item in structure.surfaces
    }
    return Model(
        structure, mesh, parts=parts, elastics=elastics, inerts=inerts, ties=ties, points=points, surfaces=surfaces
    )


def _mesh_of(parts: Mapping[str, Meshed]) -> Mesh:
    return Mesh(
        np.concatenate([part.places for part in parts.values()]),
        np.concatenate([part.quads for part in parts.values()]),
        np.concatenate([part.lines for part in parts.values()]),
        {name: part.nodes for name, part in parts.items()},
    )


def _points(places: tuple[PlaceOn, ...], parts: Mapping[str, Meshed], tolerance: float) -> dict[str, Point]:
    """Every named point by name; several places of one name are NAME.1, NAME.2."""
    points = {}
    for place in places:
        for number, at in enumerate(place.at or ((),)):
            name = place.name if len(place.at) < 2 else f"{place.name}.{number + 1}"
            part = _part_of(f"points.{name}.on", place.on, parts)
            points[name] = part.point(name, place, np.asarray(at, dtype=np.float64), tolerance)
    return points


def _part_of(where: str, name: str, parts: Mapping[str, Meshed]) -> Meshed:
    if name not in parts:
        raise InputError(where, got=f"'{name}'", expected=f"a part with nodes: {list_some(parts)}")
    return parts[name]


def _fastened(
    structure: Structure, bare: Model, tolerance: float
) -> tuple[tuple[Elastic, ...], tuple[Inert, ...], tuple[Tie, ...]]:
    found = [one for part in structure.parts for one in part.fastened(bare, tolerance)]
    held = {item.name: support(item, bare, tolerance) for item in structure.supports if item.fix}
    found += steadied(held, bare, tolerance)
    found += [one for item in structure.supports for one in elastic_edges(item, bare, tolerance)]
    for item in structure.joints:
        found += [one for one in joint(item, bare, tolerance) if one is not None]
    found += [shared_tie(shared, bare) for shared in shared_nodes(bare)]
    found += [item.tie(bare, tolerance) for item in structure.constraints]
    elastics = tuple(one for one in found if isinstance(one, Elastic))
    inerts = tuple(one for one in found if isinstance(one, Inert))
    ties = tuple(one for one in found if isinstance(one, Tie))
    if len(elastics) + len(inerts) + len(ties) != len(found):
        raise FemstructError("parts", got="something fastened that is no Elastic, Inert or Tie", expected="one of them")
    return elastics, inerts, ties


def _check_names(structure: Structure) -> None:
    groups: dict[str, Sequence[Part | Joint | PlaceOn | SurfaceOn | Support | Constraint | AirBetween]] = {
        "parts": structure.parts,
        "joints": structure.joints,
        "points": structure.points,
        "surfaces": structure.surfaces,
        "supports": structure.supports,
        "constraints": structure.constraints,
        "cavities": structure.cavities,
    }
    seen: dict[str, str] = {"ground": "the ground"}
    for group, items in groups.items():
        for item in items:
            if item.name in seen:
                raise InputError(
                    f"{group}.{item.name}", got=f"a name taken by {seen[item.name]}", expected="a new name"
                )
            seen[item.name] = f"{group}.{item.name}"
