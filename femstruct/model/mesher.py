"""The structured mesher: a Structure becomes a Model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from femstruct.declared import expect
from femstruct.errors import FemstructError, InputError, some_of
from femstruct.model.equations.constraint import Constraint
from femstruct.model.equations.elastic_edges import elastic_edges
from femstruct.model.equations.shared_nodes import shared_nodes, shared_tie
from femstruct.model.equations.supports_and_joints import joint, support
from femstruct.model.fastened import Elastic, Inert, Tie
from femstruct.model.grid.in_plane import steadied
from femstruct.model.grid.planning import planned
from femstruct.model.materials.air_between import AirBetween
from femstruct.model.mesh import Mesh
from femstruct.model.meshed import Meshed
from femstruct.model.model import Model
from femstruct.model.part import Part
from femstruct.model.probe import Point
from femstruct.model.structure import Joint, PlaceOn, Structure, Support, SurfaceOn


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

    >>> from femstruct.model.material import Material
    >>> from femstruct.parts.plate import Plate
    >>> acrylic = Material("acrylic", E=5.9e9, nu=0.35, rho=1171.875)
    >>> floor = Plate("floor", acrylic, 0.005, origin=(0.0, 0.0, 0.0), size=(0.4, 0.32), mesh=(4, 3))
    >>> mesh_structure(Structure("a floor", (floor,))).mesh.quads.shape
    (12, 4)
    """
    expect("mesh_structure", structure, Structure, "Structure(title, (part, ..)) takes parts")
    _check_names(structure)
    layout = planned(structure)
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
    bare = Model(structure, mesh, parts, (), (), (), points, {})
    elastics, inerts, ties = _fastened(structure, bare, tolerance)
    surfaces = {
        item.name: _part_of(f"surfaces.{item.name}.on", item.on, parts).surface(item, mesh.n_nodes, tolerance)
        for item in structure.surfaces
    }
    return Model(structure, mesh, parts, elastics, inerts, ties, points, surfaces)


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
        raise InputError(where, got=f"'{name}'", expected=f"a part with nodes: {some_of(parts)}")
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
