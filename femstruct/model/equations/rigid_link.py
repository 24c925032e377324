"""Rigid links and spiders: places that follow another on rigid arms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.declared import checked
from femstruct.errors import InputError, some_of
from femstruct.model.anchors import arm_rows, listed, place_of, places_of, point_rows, some_listed
from femstruct.model.equations.constraint import Constraint
from femstruct.model.fastened import Tie
from femstruct.model.model import Model
from femstruct.model.region import Region
from femstruct.model.rows import node_rows
from femstruct.tags import stored_as

_FORCES = np.concatenate([np.eye(3), np.zeros((3, 3))])


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
        some_listed(f"{where}.directions", self.directions)
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
        held = listed(f"{where}.directions", self.directions)
        rows, directions = [], []
        for point in (one for name in self.to for one in places_of(f"{where}.to", name, model)):
            moved = point_rows(first, point.position - first.position, model)
            rows.append((moved - point_rows(point, np.zeros(3), model))[held])
            directions.append(_FORCES[held])
        if self.on is not None:
            part = model.parts.get(self.on)
            if part is None:
                raise InputError(f"{where}.to.on", got=f"'{self.on}'", expected=f"a part: {some_of(model.parts)}")
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
