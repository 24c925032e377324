"""Model: a structure with its mesh, its parts, and everything fastened to their nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import FemstructError, InputError, list_some
from femstruct.model.part import Elastic, Inert, Meshed, Tie
from femstruct.model.probe import Point, Surface
from femstruct.model.structure import HARD, SIMPLE, Structure
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Mesh: nodes, cells and which part they belong to.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("mesh/1")
@dataclass(frozen=True, eq=False)
class Mesh:
    """Nodes and cells of all parts; every part has nodes of its own, joints are equations between them.

    points [n, 3] : coordinates of the nodes [m].
    quads [q, 4] : corner nodes of plate cells, in the order (0, 0) (0, b) (a, b) (a, 0) along the plate's own axes.
    bars [b, 2] : end nodes of bars.
    nodes : by part.
    """

    points: Floats
    quads: Integers
    bars: Integers
    nodes: Mapping[str, Integers]

    def __post_init__(self) -> None:
        points = frozen("Mesh points", self.points, (None, 3))
        freeze(
            self,
            points=points,
            quads=frozen_integers("Mesh quads", self.quads, (None, 4)),
            bars=frozen_integers("Mesh bars", self.bars, (None, 2)),
            nodes={name: frozen_integers(f"Mesh nodes of {name}", rows, (None,)) for name, rows in self.nodes.items()},
        )
        for name, cells in (("quads", self.quads), ("bars", self.bars)):
            if cells.size and not (cells.min() >= 0 and cells.max() < len(points)):
                raise FemstructError(f"Mesh {name}", got="a node that is not there", expected=f"0..{len(points) - 1}")

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.points)


# ----------------------------------------------------------------------------------------------------------------------
# The model: a structure with its mesh, its parts, and what is fastened to their nodes.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("meshed model/1")
@dataclass(frozen=True, eq=False)
class Model:
    """A structure ready to be assembled.

    parts : those with nodes of their own, by name. points, surfaces : by name; several places of a point are NAME.1,
    NAME.2. elastics : springs, foundations and joints with stiffness. inerts : masses. ties : supports and joints.

    Raises FemstructError: rows that do not fit the mesh.

    A plate with a point on it: where the point is, and how many nodes carry the plate:

    >>> from femstruct import Material, PlaceOn, Plate, Structure, mesh_structure
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> plate = Plate("plate", steel, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=(4, 3))
    >>> model = mesh_structure(Structure("a plate", (plate,), points=(PlaceOn("middle", "plate", at=((0.25, 0.2),)),)))
    >>> model.points["middle"].position.tolist(), model.mesh.n_nodes, model.parts["plate"].quads.shape
    ([0.25, 0.2, 0.0], 20, (12, 4))
    """

    structure: Structure
    mesh: Mesh
    parts: Mapping[str, Meshed]
    elastics: tuple[Elastic, ...]
    inerts: tuple[Inert, ...]
    ties: tuple[Tie, ...]
    points: Mapping[str, Point]
    surfaces: Mapping[str, Surface]

    def __post_init__(self) -> None:
        fastened: tuple[Elastic | Inert | Tie, ...] = (*self.elastics, *self.inerts, *self.ties)
        for item in fastened:
            if item.rows.shape[1] != self.mesh.n_nodes * N_COMPONENTS:
                raise FemstructError(
                    item.name,
                    got=f"{item.rows.shape[1]} columns",
                    expected=f"{self.mesh.n_nodes} nodes x {N_COMPONENTS}",
                )

    def places(self, name: str) -> tuple[Point, ...]:
        """All places of a point: one, or NAME.1, NAME.2 and so on."""
        if name in self.points:
            return (self.points[name],)
        several: list[Point] = []
        while (key := f"{name}.{len(several) + 1}") in self.points:
            several.append(self.points[key])
        if not several:
            raise FemstructError("points", got=f"'{name}'", expected=" or ".join(sorted(self.points)) or "a point")
        return tuple(several)


# ----------------------------------------------------------------------------------------------------------------------
# Named places of a meshed structure, as rows on nodal components.
# ----------------------------------------------------------------------------------------------------------------------


def places_of(where: str, name: str, model: Model) -> tuple[Point, ...]:
    """The places of a named point; InputError when there is none of that name."""
    known = {point.name for point in model.structure.points} | set(model.points)
    if name not in known:
        raise InputError(where, got=f"'{name}'", expected=f"a point: {list_some(sorted(known)) or 'there is none'}")
    return model.places(name)


def place_of(where: str, name: str, model: Model) -> Point:
    """The place of a named point; InputError when there is none of that name, and when it has several places."""
    first, *more = places_of(where, name, model)
    if more:
        got = f"'{name}', which has {len(more) + 1} places"
        raise InputError(where, got=got, expected="one place", do=f"write one of them, as {first.name}")
    return first


def component_numbers(where: str, directions: object) -> list[int]:
    """Numbers of the components out of x y z rx ry rz; InputError for any other."""
    if not isinstance(directions, tuple) or not set(directions) <= set(DIRECTIONS):
        raise InputError(where, got=f"{directions}", expected=f"directions out of {', '.join(DIRECTIONS)}")
    return [DIRECTIONS.index(direction) for direction in directions]


def some_component_numbers(where: str, directions: object) -> list[int]:
    """As `component_numbers`; InputError for none, too."""
    if not directions:
        raise InputError(where, got="none", expected=f"one or more of {', '.join(DIRECTIONS)}")
    return component_numbers(where, directions)


def point_rows(point: Point, arm: Floats, model: Model) -> csr_array:
    """Six rows of the motion at the end of a rigid arm [3] from a point: u + r x arm."""
    return arm_rows(point, arm[None], range(len(DIRECTIONS)), model)


def arm_rows(point: Point, arms: Floats, held: Sequence[int], model: Model) -> csr_array:
    """Rows [p * h, n_nodes * 7] of the motion at the ends of rigid arms [p, 3] from a point: of each the components
    `held` [h] out of x y z rx ry rz."""
    motion = np.tile(np.eye(len(DIRECTIONS)), (len(arms), 1, 1))
    x, y, z = arms.T
    motion[:, 0, 4], motion[:, 1, 5], motion[:, 2, 3] = z, x, y
    motion[:, 0, 5], motion[:, 1, 3], motion[:, 2, 4] = -y, -z, -x
    columns = point.nodes * N_COMPONENTS + point.components
    weights = (motion[:, list(held)] @ point.weights).reshape(-1, len(columns))
    rows = np.repeat(np.arange(len(weights)), len(columns))
    entries = (weights.ravel(), (rows, np.tile(columns, len(weights))))
    return csr_array(entries, shape=(len(weights), model.mesh.n_nodes * N_COMPONENTS))


# ----------------------------------------------------------------------------------------------------------------------
# Facts of a meshed model for its reader: masses, the box around it, how many nodes and cells.
# ----------------------------------------------------------------------------------------------------------------------


def part_masses(model: Model) -> dict[str, float]:
    """Mass of every part that has one, by name [kg]."""
    masses = {name: part.mass for name, part in model.parts.items()}
    for inert in model.inerts:
        masses[inert.name] = masses.get(inert.name, 0.0) + inert.total
    return {name: mass for name, mass in masses.items() if mass > 0}


def simple_edges(model: Model) -> dict[str, str]:
    """Whether simple supports of edges are "hard" or "soft", by name: those of thin plates, and of sets and boxes of
    slabs and shells that hold no rotation, or the tangential one alone."""
    found = {}
    for item in model.structure.supports:
        part = None if item.on is None else model.parts.get(item.on)
        if part is None or not part.has_rotations or not len(part.quads):
            continue
        if item.region is None:
            if item.fix in (*SIMPLE, "roller") and (item.edge is not None or item.line is not None):
                found[item.name] = "hard"
        elif item.fix == HARD:
            found[item.name] = "hard"
        elif item.fix and item.fix != "clamped" and (item.fix in SIMPLE or set(item.fix) <= set(DIRECTIONS[:3])):
            found[item.name] = "soft"
    return found


def refuse_unweighed(model: Model, axes: str, what: str) -> None:
    """Raise InputError for parts that accelerations along some of the axes push as is not known."""
    for name, part in model.parts.items():
        if lost := [axis for axis in axes if axis in part.unweighed]:
            raise InputError(
                f"parts.{name}",
                got=f"{what} of matrices that hold some of their nodes along {lost[0]}, and do not say what mass lies "
                "between those and the rest",
                expected="matrices without supports, a lumped mass matrix, or a file of femstruct export",
                do="write the supports in the model",
            )


@dataclass(frozen=True, eq=False)
class ModelFacts:
    """What `check` reports of a model.

    masses : by part [kg]; total_mass [kg]; low, high [3] : corners of the box around nodes and blocks [m].
    counts : nodes, faces of cells (of plates, shells and solids), bars, blocks where there are any.
    """

    masses: dict[str, float]
    total_mass: float
    low: Floats
    high: Floats
    counts: dict[str, int]

    def __post_init__(self) -> None:
        freeze(self, low=frozen("low", self.low, (3,)), high=frozen("high", self.high, (3,)))


def model_facts(model: Model) -> ModelFacts:
    """Masses by part, the box around the structure, and the numbers of nodes and cells."""
    masses = part_masses(model)
    mesh = model.mesh
    corners = np.concatenate([mesh.points, *(part.bounds for part in model.parts.values())])
    counts = {"nodes": mesh.n_nodes, "faces of cells": len(mesh.quads), "bars": len(mesh.bars)}
    rigid = sum(part.rigid for part in model.parts.values())
    counts |= {"blocks": rigid} if rigid else {}
    return ModelFacts(masses, sum(masses.values()), corners.min(axis=0), corners.max(axis=0), counts)


# ----------------------------------------------------------------------------------------------------------------------
# Finer points between the nodes, moved by the elements' own shape functions: for smooth pictures and files.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Refined:
    """A subdivided model.

    points [p, 3] : [m]. quads [q, 4] : corners of pieces of plates and faces of blocks, in turn.
    lines [l, 2] : ends of pieces of bars.
    rows [3 p, n_nodes * 7] : x, y, z displacements of the points from the nodal components. parts : names of the parts;
    part_of_point [p] : the part of each point, as a place in `parts`.
    """

    points: Floats
    quads: Integers
    lines: Integers
    rows: csr_array
    parts: tuple[str, ...]
    part_of_point: Integers

    def __post_init__(self) -> None:
        points = frozen("Refined points", self.points, (None, 3))
        freeze(
            self,
            points=points,
            quads=frozen_integers("Refined quads", self.quads, (None, 4)),
            lines=frozen_integers("Refined lines", self.lines, (None, 2)),
            part_of_point=frozen_integers("Refined part_of_point", self.part_of_point, (len(points),)),
        )

    def displacement(self, shapes: Floats) -> Floats:
        """Displacements [p, 3, k] of the points in nodal shapes [n_nodes, 7, k]."""
        count = shapes.shape[2]
        moved: Floats = self.rows @ shapes.reshape(shapes.shape[0] * shapes.shape[1], count)  # -1 fails without nodes
        return moved.reshape(len(self.points), 3, count)


def refine_model(model: Model, divisions: int = 4, along: int | None = None) -> Refined:
    """The model with every cell side and every bar divided into equal pieces; blocks are boxes.

    Parameters
    ----------
    divisions : int
        Pieces a side.
    along : int | None
        Pieces of a bar, as many if nothing is said.

    Raises
    ------
    InputError
        When there is not at least one.
    """
    if divisions < 1:
        raise InputError("divisions", got=f"{divisions}", expected="at least 1")
    points: list[Floats] = []
    rows: list[csr_array] = []
    owners: list[Integers] = []
    quads = [np.empty((0, 4), np.int64)]
    lines = [np.empty((0, 2), np.int64)]
    first = 0
    for number, part in enumerate(model.parts.values()):
        drawn = part.drawn(divisions, along or divisions, model.mesh.n_nodes)
        points.append(drawn.points)
        rows.append(drawn.rows)
        quads.append(first + drawn.quads)
        lines.append(first + drawn.lines)
        owners.append(np.full(len(drawn.points), number))
        first += len(drawn.points)
    return Refined(
        np.concatenate(points),
        np.concatenate(quads),
        np.concatenate(lines),
        csr_array(vstack(rows)),
        tuple(model.parts),
        np.concatenate(owners),
    )
