"""The structured mesher: a Structure becomes a Model."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers
from femstruct.elements.frame import nodes_per_bar
from femstruct.elements.placement import directions
from femstruct.errors import InputError
from femstruct.model.attachments import foundation, lumped_mass, spread_mass, springs
from femstruct.model.geometry import from_plate
from femstruct.model.gridlines import Key
from femstruct.model.holding import joint, support
from femstruct.model.mesh import Mesh
from femstruct.model.model import BlockMesh, Elastic, FrameMesh, Inert, Model, PlateMesh, Tie
from femstruct.model.parts import Block, Foundation, Frame, Mass, Plate, Spring, Structure
from femstruct.model.places import locate_points, locate_surface
from femstruct.model.planning import Plan
from femstruct.model.segments import Segment


def mesh_structure(structure: Structure) -> Model:
    """The meshed model of a structure.

    Plates have rectangular grids, bars run along their lines, a block has one node. Nodes are put where joints, regions
    and their edges, supports, and points that carry a spring, a mass or a support need them; sizes and divisions of the
    parts are the least density between. A point that is only pushed or listened to is interpolated and moves no node.
    A frame line lying in a plate it is joined to takes the plate's nodes, whatever its own size. Every part has nodes
    of its own; parts are connected by joints, which are equations, and by springs and foundations.

    Raises InputError, naming the part or joint, where joined parts do not touch, a region, point or line leaves its
    part, or a name does not exist.

    >>> from femstruct.model.material import Material
    >>> acrylic = Material("acrylic", E=5.9e9, nu=0.35, rho=1171.875)
    >>> floor = Plate("floor", acrylic, 0.005, origin=(0.0, 0.0, 0.0), size=(0.4, 0.32), mesh=(4, 3))
    >>> mesh_structure(Structure("a floor", (floor,))).mesh.quads.shape
    (12, 4)
    """
    _check_names(structure)
    plan = Plan(structure)
    grids = plan.settled()
    points: list[Floats] = []
    plates: dict[str, PlateMesh] = {}
    frames: dict[str, FrameMesh] = {}
    blocks: dict[str, BlockMesh] = {}
    nodes: dict[str, Integers] = {}
    cells: dict[str, Integers] = {}
    n_nodes = n_quads = n_bars = 0
    for part in structure.parts:
        if isinstance(part, Plate):
            plates[part.name], places = _mesh_plate(part, plan.axes_of[part.name], grids, n_nodes)
            cells[part.name] = np.arange(n_quads, n_quads + len(plates[part.name].cells))
            n_quads += len(cells[part.name])
        elif isinstance(part, Frame):
            frames[part.name], places = _mesh_frame(part, plan.segments[part.name], grids, n_nodes, plan.tolerance)
            cells[part.name] = np.arange(n_bars, n_bars + len(frames[part.name].bars))
            n_bars += len(cells[part.name])
        elif isinstance(part, Block):
            center = np.add(part.origin, part.middle if part.center is None else part.center)
            blocks[part.name], places = BlockMesh(part, n_nodes, center), center[None]
        else:
            continue
        nodes[part.name] = np.arange(n_nodes, n_nodes + len(places))
        n_nodes += len(places)
        points.append(places)
    mesh = Mesh(
        np.concatenate(points),
        quads=np.concatenate([np.empty((0, 4), np.int64), *(plate.cells for plate in plates.values())]),
        bars=np.concatenate([np.empty((0, 2), np.int64), *(frame.bars[:, :2] for frame in frames.values())]),
        nodes=nodes,
        cells=cells,
    )
    located = locate_points(structure.points, mesh, plates, frames, blocks, plan.tolerance)
    bare = Model(structure, mesh, plates, frames, (), (), (), located, {}, blocks)
    elastics, inerts, ties = _attachments(structure, bare, plan.tolerance)
    surfaces = {item.name: locate_surface(item, mesh, plates, plan.tolerance) for item in structure.surfaces}
    return Model(structure, mesh, plates, frames, elastics, inerts, ties, located, surfaces, blocks)


def _attachments(
    structure: Structure, bare: Model, tolerance: float
) -> tuple[tuple[Elastic, ...], tuple[Inert, ...], tuple[Tie, ...]]:
    elastics: list[Elastic] = []
    inerts: list[Inert] = []
    for part in structure.parts:
        if isinstance(part, Foundation):
            elastics.append(foundation(part, bare, tolerance))
        elif isinstance(part, Spring):
            elastics.append(springs(part, bare))
        elif isinstance(part, Mass):
            inerts.append(lumped_mass(part, bare) if part.at is not None else spread_mass(part, bare, tolerance))
    ties = [support(item, bare, tolerance) for item in structure.supports]
    for item in structure.joints:
        tie, elastic = joint(item, bare, tolerance)
        ties += [tie] if tie is not None else []
        elastics += [elastic] if elastic is not None else []
    return tuple(elastics), tuple(inerts), tuple(ties)


def _mesh_plate(part: Plate, axes: Floats, grids: Mapping[Key, Floats], first: int) -> tuple[PlateMesh, Floats]:
    x, y = grids[part.name, 0], grids[part.name, 1]
    nodes = first + np.arange(len(x) * len(y)).reshape(len(x), len(y))
    local = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    return PlateMesh(part, axes, x, y, nodes), from_plate(part, axes, local)


def _mesh_frame(
    part: Frame, segments: tuple[Segment, ...], grids: Mapping[Key, Floats], first: int, tolerance: float
) -> tuple[FrameMesh, Floats]:
    """Bars of every segment between nodes; where they have a rigid arm the node is the foot of the arm. Middle nodes of
    bars of three come after all ends."""
    tips, feet, middles = [], [], []
    for segment in segments:
        share = (grids[segment.key] / grids[segment.key][-1])[:, None]
        places = (1.0 - share) * segment.start + share * segment.end
        stands = places - ((1.0 - share) * segment.arms[0] + share * segment.arms[1])
        middles.append((stands[:-1] + stands[1:]) / 2.0)
        line = part.lines[int(segment.key[1])]
        stands[0], stands[-1] = line[int(segment.key[2])], line[int(segment.key[2]) + 1]
        tips.append(np.stack([places[:-1], places[1:]], axis=1))
        feet.append(np.stack([stands[:-1], stands[1:]], axis=1))
    ends, stands = np.concatenate(tips), np.concatenate(feet)
    points, numbers = _merged(stands.reshape(-1, 3), tolerance)
    bars, arms = first + numbers.reshape(-1, 2), ends - stands
    if nodes_per_bar(part.element) == 3:
        middle = np.concatenate(middles)
        bars = np.column_stack([bars, first + len(points) + np.arange(len(bars))])
        points = np.concatenate([points, middle])
        arms = np.concatenate([arms, (ends.mean(axis=1) - middle)[:, None]], axis=1)
    try:
        axes = directions(ends[:, 0], ends[:, 1], part.orientation)
    except InputError as error:
        raise InputError(f"parts.{part.name}.{error.where}", got=error.got, expected=error.expected) from error
    return FrameMesh(part, bars, ends[:, 0], ends[:, 1], arms, axes), points


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


def _check_names(structure: Structure) -> None:
    groups = {
        "parts": structure.parts,
        "joints": structure.joints,
        "points": structure.points,
        "surfaces": structure.surfaces,
        "supports": structure.supports,
    }
    seen: dict[str, str] = {"ground": "the ground"}
    for group, items in groups.items():
        for item in items:
            if item.name in seen:
                raise InputError(
                    f"{group}.{item.name}", got=f"a name taken by {seen[item.name]}", expected="a new name"
                )
            seen[item.name] = f"{group}.{item.name}"
