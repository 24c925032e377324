"""Linear equations between directions of points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.model.anchors import place_of
from femstruct.model.equations.constraint import Constraint
from femstruct.model.fastened import Tie
from femstruct.model.model import Model
from femstruct.tags import stored_as

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
