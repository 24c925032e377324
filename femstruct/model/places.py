"""Named points and surfaces of a meshed structure."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from femstruct.arrays import Floats
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import InputError, some_of
from femstruct.model.geometry import distance_to_rectangle, distance_to_segments, from_plate
from femstruct.model.interpolation import block_rows, frame_rows, plate_rows, sparse_rows
from femstruct.model.mesh import Mesh
from femstruct.model.model import BlockMesh, FrameMesh, PlateMesh
from femstruct.model.parts import PlaceOn, Side, SurfaceOn
from femstruct.model.patches import patch_rows
from femstruct.model.probe import Point, Surface
from femstruct.model.regions import area_points, region_box

STEEP = float(np.cos(np.radians(45.0)))
SURFACE_ORDER = 3
"""Gauss points a direction in each cell of a surface: exact for the volume a cell displaces, and for its second moment
with a linear weight; the deflection of a cell is cubic."""


def locate_points(
    places: tuple[PlaceOn, ...],
    mesh: Mesh,
    plates: Mapping[str, PlateMesh],
    frames: Mapping[str, FrameMesh],
    blocks: Mapping[str, BlockMesh],
    tolerance: float,
) -> dict[str, Point]:
    """Every named point by name; several places of one name are NAME.1, NAME.2.

    Raises InputError for a point off its part, saying by how much.
    """
    points = {}
    for place in places:
        for number, at in enumerate(place.at):
            name = place.name if len(place.at) == 1 else f"{place.name}.{number + 1}"
            position = np.asarray(at, dtype=np.float64)
            if place.patch is not None and place.on not in plates:
                raise InputError(f"points.{name}.patch", got=f"a patch on {place.on}", expected="one on a plate")
            if place.on in plates:
                points[name] = _point_of_plate(name, place, position, plates[place.on], tolerance)
            elif place.on in frames:
                points[name] = _point_of_frame(name, place, position, frames[place.on], mesh, tolerance)
            elif place.on in blocks:
                points[name] = _point_of_block(name, place, position, blocks[place.on], tolerance)
            else:
                expected = some_of([*plates, *frames, *blocks])
                raise InputError(
                    f"points.{name}.on", got=f"'{place.on}'", expected=f"a plate, frame or block: {expected}"
                )
    return points


def locate_surface(surface: SurfaceOn, mesh: Mesh, plates: Mapping[str, PlateMesh], tolerance: float) -> Surface:
    """A named surface: quadrature points over its region, outward normal, and the displacement along it.

    Raises InputError for a side of a plate steeper than 45 degrees, which is neither above nor below.
    """
    where = f"surfaces.{surface.name}"
    if surface.on not in plates:
        raise InputError(f"{where}.on", got=f"'{surface.on}'", expected=f"a plate: {some_of(plates)}")
    if surface.region.kind not in ("whole", "rectangle"):
        raise InputError(f"{where}.region", got=surface.region.kind, expected="whole or a rectangle")
    plate = plates[surface.on]
    if abs(plate.axes[2, 2]) < STEEP - 1e-12:
        angle = np.degrees(np.arccos(abs(plate.axes[2, 2])))
        raise InputError(
            f"{where}.side", got=f"'{surface.side}' of a plate at {angle:.0f} degrees", expected="at most 45 degrees"
        )
    normal = side_normal(plate, surface.side)
    box = region_box(f"{where}.region", surface.on, plate.part.size, surface.region, tolerance)
    local, weights = area_points(plate.x, plate.y, box, tolerance, SURFACE_ORDER)
    nodes, rows = plate_rows(plate, local)
    along_normal = np.einsum("j,pjkc->pkc", normal, rows[:, :3])[:, None]
    return Surface(
        surface.name,
        points=from_plate(plate.part, plate.axes, local),
        weights=weights,
        normal=normal,
        corner=from_plate(plate.part, plate.axes, np.array([box[0], box[2]])),
        along=plate.axes[:2],
        size=np.array([box[1] - box[0], box[3] - box[2]]),
        rows=sparse_rows(nodes, along_normal, mesh.n_nodes),
    )


def side_normal(plate: PlateMesh, side: Side) -> Floats:
    """Unit normal out of the named side. Above is up along global z; on a plate normal to the horizontal it is the
    side of the plate's own normal."""
    up = 1.0 if plate.axes[2, 2] > 0 or abs(plate.axes[2, 2]) < STEEP - 1e-12 else -1.0
    normal: Floats = plate.axes[2] * (up if side == "above" else -up)
    return normal


def _point_of_plate(name: str, place: PlaceOn, at: Floats, plate: PlateMesh, tolerance: float) -> Point:
    if len(at) != 2:
        raise InputError(f"points.{name}.at", got=f"{len(at)} numbers", expected="[x, y] from the plate's corner")
    off = float(distance_to_rectangle(np.append(at, 0.0), plate.part.size))
    if off > tolerance:
        raise InputError(
            f"points.{name}.at",
            got=f"({at[0]:g}, {at[1]:g}) m, {off:.4g} m off {plate.part.name}",
            expected=f"a place within {plate.part.size[0]:g} m x {plate.part.size[1]:g} m",
        )
    local = np.clip(at, 0.0, plate.part.size)
    position = from_plate(plate.part, plate.axes, local)
    if place.patch is not None:
        rows_of = patch_rows(f"points.{name}", plate, local, place.patch, tolerance)
        return Point(name, position, *rows_of, normal=side_normal(plate, place.side))
    nodes, rows = plate_rows(plate, local[None])
    return Point(name, position, *_flat(nodes[0], rows[0]), normal=side_normal(plate, place.side))


def _point_of_frame(name: str, place: PlaceOn, at: Floats, frame: FrameMesh, mesh: Mesh, tolerance: float) -> Point:
    if len(at) != 3:
        raise InputError(f"points.{name}.at", got=f"{len(at)} numbers", expected="[x, y, z], global")
    up = np.array([0.0, 0.0, 1.0])
    own = mesh.nodes[frame.part.name]
    apart = np.linalg.norm(mesh.points[own] - at, axis=1)
    if apart.min() <= tolerance:
        node = own[int(np.argmin(apart))]
        return Point(name, mesh.points[node], np.full(6, node), np.arange(6), np.eye(6), up)
    distances, shares = distance_to_segments(at, frame.start, frame.end)
    bar = int(np.argmin(distances))
    if distances[bar] > tolerance:
        raise InputError(
            f"points.{name}.at",
            got=f"({at[0]:g}, {at[1]:g}, {at[2]:g}) m, {distances[bar]:.4g} m off {place.on}",
            expected="a place on its axis",
        )
    nodes, rows = frame_rows(frame, np.array([bar]), shares[[bar]])
    position = frame.start[bar] + shares[bar] * (frame.end[bar] - frame.start[bar])
    return Point(name, position, *_flat(nodes[0], rows[0]), normal=up)


def _point_of_block(name: str, place: PlaceOn, at: Floats, block: BlockMesh, tolerance: float) -> Point:
    if len(at) != 3:
        raise InputError(f"points.{name}.at", got=f"{len(at)} numbers", expected="[x, y, z] from the lower corner")
    size = np.asarray(block.part.size)
    off = float(np.linalg.norm(at - np.clip(at, 0.0, size)))
    if off > tolerance:
        raise InputError(
            f"points.{name}.at",
            got=f"({at[0]:g}, {at[1]:g}, {at[2]:g}) m, {off:.4g} m off {block.part.name}",
            expected=f"a place within {size[0]:g} m x {size[1]:g} m x {size[2]:g} m",
        )
    position = np.asarray(block.part.origin) + np.clip(at, 0.0, size)
    nodes, rows = block_rows(block, position[None])
    up = 1.0 if place.side == "above" else -1.0
    return Point(name, position, *_flat(nodes[0], rows[0]), normal=np.array([0.0, 0.0, up]))


def _flat(nodes: np.ndarray, rows: Floats) -> tuple[np.ndarray, np.ndarray, Floats]:
    """Nodes, components and weights [6, m] of the components that matter."""
    weights = rows.reshape(6, -1)
    used = np.flatnonzero((weights != 0.0).any(axis=0))
    return np.repeat(nodes, N_COMPONENTS)[used], np.tile(np.arange(N_COMPONENTS), len(nodes))[used], weights[:, used]
