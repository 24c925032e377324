"""Named places of a meshed structure, as rows on nodal components."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import InputError, some_of
from femstruct.model.model import Model
from femstruct.model.probe import Point


def places_of(where: str, name: str, model: Model) -> tuple[Point, ...]:
    """The places of a named point; InputError when there is none of that name."""
    known = {point.name for point in model.structure.points} | set(model.points)
    if name not in known:
        raise InputError(where, got=f"'{name}'", expected=f"a point: {some_of(sorted(known)) or 'there is none'}")
    return model.places(name)


def place_of(where: str, name: str, model: Model) -> Point:
    """The place of a named point; InputError when there is none of that name, and when it has several places."""
    first, *more = places_of(where, name, model)
    if more:
        got = f"'{name}', which has {len(more) + 1} places"
        raise InputError(where, got=got, expected="one place", do=f"write one of them, as {first.name}")
    return first


def listed(where: str, directions: object) -> list[int]:
    """Numbers of the components out of x y z rx ry rz; InputError for any other."""
    if not isinstance(directions, tuple) or not set(directions) <= set(DIRECTIONS):
        raise InputError(where, got=f"{directions}", expected=f"directions out of {', '.join(DIRECTIONS)}")
    return [DIRECTIONS.index(direction) for direction in directions]


def some_listed(where: str, directions: object) -> list[int]:
    """As `listed`; InputError for none, too."""
    if not directions:
        raise InputError(where, got="none", expected=f"one or more of {', '.join(DIRECTIONS)}")
    return listed(where, directions)


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
