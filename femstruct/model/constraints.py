"""Constraints between places: averages, linear equations, rigid links and spiders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.declared import checked
from femstruct.errors import InputError, list_some
from femstruct.model.model import (
    Model,
    arm_rows,
    component_numbers,
    place_of,
    places_of,
    point_rows,
    some_component_numbers,
)
from femstruct.model.part import Tie
from femstruct.model.regions import Region, node_rows, sparse_rows
from femstruct.model.structure import Constraint
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Averages: a point that moves as the rigid motion that fits the motion of others best.
# ----------------------------------------------------------------------------------------------------------------------

ORDER: Final = 2  # Gauss points a direction of each cell of a region
UNDETERMINED: Final = 1e-9  # of the largest: a rotation that the places resist by less is about a line they lie on
_FORCES = np.concatenate([np.eye(3), np.zeros((3, 3))])


@stored_as("average of points/1")
@dataclass(frozen=True)
@checked("constraints")
class Average(Constraint):
    """A point that moves as the rigid motion that fits the shifts of others best; it does not stiffen them.

    of : names of points, all of the same weight. on, over : a part and a region of it, weighted by its area or length.
    directions : out of x y z rx ry rz, global, in which the point follows. A force on the point is shared among the
    others as a group of bolts shares it: equal parts, and what balances the moment, proportional to the distance from
    their middle. The force recorded is the one on the others.

    A machine of 300 kg that rests on four feet, whose plate stays as flexible as it is:

    >>> Average("rests", "underside", of=("feet",), directions=("x", "y", "z")).of
    ('feet',)

    Notes
    -----
    With the rigid motions B [3 p, 6] of the places about the point and their weights W, the motion of the point is
    (B^T W B)^-1 B^T W u: least squares. Known from other programs as RBE3 or distributing coupling.
    """

    name: str
    point: str
    of: tuple[str, ...] = ()
    on: str | None = None
    over: Region | None = None
    directions: tuple[str, ...] = DIRECTIONS

    def __post_init__(self) -> None:
        where = f"constraints.{self.name}"
        some_component_numbers(f"{where}.directions", self.directions)
        if not self.of and self.on is None:
            raise InputError(f"{where}.of", got="nothing", expected="points, or a region of a part")
        if self.of and self.on is not None:
            raise InputError(f"{where}.of", got=f"points and a region of {self.on}", expected="one of them")
        if self.point in self.of:
            raise InputError(f"{where}.of", got=f"'{self.point}' itself", expected="other points")

    def holds(self) -> Mapping[str, tuple[str, ...]]:
        return dict.fromkeys((self.point, *self.of), DIRECTIONS)

    def region(self) -> tuple[str, Region] | None:
        return None if self.on is None else (self.on, self.over or Region("whole"))

    def tie(self, model: Model, tolerance: float) -> Tie:
        where = f"constraints.{self.name}"
        point = place_of(f"{where}.average", self.point, model)
        shifts, weights = self._shifts(model, tolerance)
        held = component_numbers(f"{where}.directions", self.directions)
        fitted = fitted_motion(_places(shifts, point.position, model.mesh.points), weights)
        if fitted is None or np.abs(fitted.lost[held]).max(initial=0.0) > UNDETERMINED:
            raise InputError(
                f"{where}.of",
                got="places on one line, or one place alone, which do not determine the motion of the point",
                expected="three places that are not on one line",
                do="name more places, or those directions only that they determine, as in directions: [x, y, z]",
            )
        rows = point_rows(point, np.zeros(3), model) - csr_array(fitted.motion) @ shifts
        return Tie(self.name, csr_array(csr_array(rows)[held]), _FORCES[held], grounded=False)

    def _shifts(self, model: Model, tolerance: float) -> tuple[csr_array, Floats]:
        """Shifts of the places [3 p, n_nodes * 7] and their weights [p]."""
        where = f"constraints.{self.name}.of"
        if self.on is None:
            points = [one for name in self.of for one in places_of(where, name, model)]
            rows = [point_rows(one, np.zeros(3), model)[:3] for one in points]
            return csr_array(vstack(rows)), np.full(len(points), 1.0 / len(points))
        part = model.parts.get(self.on)
        spread = None if part is None else part.spread(where, self.over or Region("whole"), tolerance, ORDER)
        if spread is None:
            known = list_some([name for name, one in model.parts.items() if not one.rigid])
            raise InputError(f"{where}.on", got=f"'{self.on}'", expected=f"a part that can be averaged: {known}")
        rows_of_all = sparse_rows(spread.nodes, spread.rows[:, :3], model.mesh.n_nodes)
        return rows_of_all, spread.weights / spread.weights.sum()


@dataclass(frozen=True, eq=False)
class MotionFit:
    """motion [6, 3 p] : that of the point from the shifts of the places. lost [6, l] : what they do not determine of
    it, rotations times the spread of the places."""

    motion: Floats
    lost: Floats


def fitted_motion(places: Floats, weights: Floats) -> MotionFit | None:
    """The rigid motion at the origin that fits shifts of places [p, 3] best; None where all of them are at one.

    Fitted about their middle, where shifts and rotations do not mix, and carried from there on a rigid arm.
    """
    middle = weights @ places
    off = places - middle
    size = float(np.sqrt(weights @ (off**2).sum(axis=1)))
    if not size > UNDETERMINED * float(np.linalg.norm(places, axis=1).max()):
        return None
    turns = np.cross(np.eye(3)[:, None], off[None] / size)  # [axis, place, 3]
    B = np.concatenate([np.tile(np.eye(3), (len(places), 1)), turns.reshape(3, -1).T], axis=1)
    weighed = np.repeat(weights, 3)[:, None] * B
    values, vectors = np.linalg.eigh(B.T @ weighed)
    kept = values > UNDETERMINED
    arm = np.concatenate([np.eye(3), np.cross(np.eye(3), -middle / size).T], axis=1)
    carried = np.concatenate([arm, np.eye(3, 6, 3)])
    best = carried @ (vectors[:, kept] / values[kept]) @ (weighed @ vectors[:, kept]).T
    best[3:] /= size
    return MotionFit(best, carried @ vectors[:, ~kept])


def _places(shifts: csr_array, at: Floats, nodes: Floats) -> Floats:
    """Where places are from one [3], by what rotations of all nodes about it do to them [p, 3]."""
    turned = np.zeros((len(nodes), N_COMPONENTS, 3))
    turned[:, 3:6] = np.eye(3)
    for axis in range(3):
        turned[:, :3, axis] = np.cross(np.eye(3)[axis], nodes - at)
    felt = (shifts @ turned.reshape(-1, 3)).reshape(-1, 3, 3)
    return np.stack([felt[:, 1, 2], felt[:, 2, 0], felt[:, 0, 1]], axis=1)


# ----------------------------------------------------------------------------------------------------------------------
# Linear equations between directions of points.
# ----------------------------------------------------------------------------------------------------------------------

_BALANCED: Final = 1e-9  # of the largest coefficient: forces that add up to less are rounding


@stored_as("equation of points/1")
@dataclass(frozen=True)
@checked("constraints")
class Equation(Constraint):
    """A sum of displacements, each by its factor, that stays zero.

    terms : factors by POINT.direction, out of x y z rx ry rz n [1, or m for rotations beside shifts].

    Where the forces of the terms add up to nothing, as those of two points that move alike, the force recorded is the
    one of the first term on the others. Elsewhere, as for a lever whose pivot is not in the model, the rest of it goes
    to the ground: it is a part of the force on the ground, and the force recorded.

    Two points that rise alike, and one that sinks twice as much as another rises:

    >>> alike = Equation("alike", {"left.z": 1.0, "right.z": -1.0})
    >>> lever = Equation("lever", {"short.z": 2.0, "long.z": 1.0})
    >>> list(lever.holds())
    ['short', 'long']
    """

    name: str
    terms: Mapping[str, float]

    def __post_init__(self) -> None:
        where = f"constraints.{self.name}.equation"
        if len(self.terms) < 2:
            got = f"{len(self.terms)} term" + ("" if len(self.terms) == 1 else "s")
            raise InputError(where, got=got, expected="two or more", do="hold a point alone with a support")
        for spot, factor in self.terms.items():
            if not factor:
                raise InputError(where, got=f"0 for {spot}", expected="a factor", do="leave the term out")
            if spot.rpartition(".")[2] not in (*DIRECTIONS, "n"):
                raise InputError(where, got=f"'{spot}'", expected="POINT.direction, out of x y z rx ry rz n")

    def holds(self) -> Mapping[str, tuple[str, ...]]:
        found: dict[str, tuple[str, ...]] = {}
        for spot in self.terms:
            name, _, direction = spot.rpartition(".")
            found[name] = (*found.get(name, ()), direction)
        return found

    def tie(self, model: Model, tolerance: float) -> Tie:
        where, n_nodes = f"constraints.{self.name}.equation", model.mesh.n_nodes
        total = csr_array((1, n_nodes * N_COMPONENTS))
        pushes = []
        for spot, factor in self.terms.items():
            name, _, direction = spot.rpartition(".")
            point = place_of(where, name, model)
            total = csr_array(total + factor * point.probe(direction).row(n_nodes))
            pushes.append(factor * _unit(direction, point.normal))
        net = np.sum(pushes, axis=0)
        largest = max(abs(factor) for factor in self.terms.values())
        if np.abs(net).max() > _BALANCED * largest:
            return Tie(self.name, total, net[None], grounded=True)
        return Tie(self.name, total, pushes[0][None], grounded=False)


def _unit(direction: str, normal: Floats) -> Floats:
    """The global direction of a force along a direction of a point [3]; zero for rotations."""
    if direction == "n":
        return normal
    unit: Floats = np.concatenate([np.eye(3), np.zeros((3, 3))])[DIRECTIONS.index(direction)]
    return unit


# ----------------------------------------------------------------------------------------------------------------------
# Rigid links and spiders: places that follow another on rigid arms.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("rigid link/1")
@dataclass(frozen=True)
@checked("constraints")
class RigidLink(Constraint):
    """All of `to`, and all nodes of a region, follow a point as one rigid body: a link, or a spider.

    to : names of points; all places of those with several. on, of : a part that is a mesh, and the set or box of it
    whose nodes follow. directions : out of x y z rx ry rz, global, in which they follow; nodes of solids have shifts
    only. The force recorded is the sum of those on all that follows. A bar end is released by a link to it without the
    directions that are free.

    A mass on a rigid arm, 0.3 m above a plate:

    >>> arm = RigidLink("arm", "seat", to=("head",))
    >>> arm.directions
    ('x', 'y', 'z', 'rx', 'ry', 'rz')
    """

    name: str
    point: str
    to: tuple[str, ...] = ()
    on: str | None = None
    of: Region | None = None
    directions: tuple[str, ...] = DIRECTIONS

    def __post_init__(self) -> None:
        where = f"constraints.{self.name}"
        some_component_numbers(f"{where}.directions", self.directions)
        if not self.to and self.on is None:
            raise InputError(f"{where}.to", got="nothing", expected="points, or a set or a box of a part")
        if self.point in self.to:
            raise InputError(f"{where}.to", got=f"'{self.point}' itself", expected="other points")

    def holds(self) -> Mapping[str, tuple[str, ...]]:
        return dict.fromkeys((self.point, *self.to), DIRECTIONS)

    def region(self) -> tuple[str, Region] | None:
        return None if self.on is None else (self.on, self.of or Region("whole"))

    def tie(self, model: Model, tolerance: float) -> Tie:
        where = f"constraints.{self.name}"
        first = place_of(f"{where}.rigid", self.point, model)
        held = component_numbers(f"{where}.directions", self.directions)
        rows, directions = [], []
        for point in (one for name in self.to for one in places_of(f"{where}.to", name, model)):
            moved = point_rows(first, point.position - first.position, model)
            rows.append((moved - point_rows(point, np.zeros(3), model))[held])
            directions.append(_FORCES[held])
        if self.on is not None:
            part = model.parts.get(self.on)
            if part is None:
                raise InputError(f"{where}.to.on", got=f"'{self.on}'", expected=f"a part: {list_some(model.parts)}")
            kept = held if part.has_rotations else [number for number in held if number < 3]
            if not kept:
                got = f"rotations of nodes of {self.on}, which have none"
                raise InputError(f"{where}.directions", got=got, expected="x, y or z")
            nodes = part.within(f"{where}.to", self.of or Region("whole"), tolerance)
            moved = arm_rows(first, model.mesh.points[nodes] - first.position, kept, model)
            each = np.tile(np.eye(N_COMPONENTS)[kept], (len(nodes), 1))
            rows.append(csr_array(moved - node_rows(np.repeat(nodes, len(kept)), each, model.mesh.n_nodes)))
            directions.append(np.tile(_FORCES[kept], (len(nodes), 1)))
        return Tie(self.name, csr_array(vstack(rows)), np.concatenate(directions), grounded=False)
