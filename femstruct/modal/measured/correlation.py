"""How the modes of a model fit measured ones: shapes at the measured places, and which mode is which."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.modal.basis import ModalBasis
from femstruct.modal.likeness import Pairing, pairing_of
from femstruct.modal.measured.measurement import MeasuredModes
from femstruct.model.refine import Refined

NEAR_MEASURED: Final = 0.01
"""Relative width of a group of frequencies beside measured ones: a model differs by more, which mixes shapes within."""
FAR: Final = 0.05  # of the size of the model: a sensor may stand on an edge that is not modelled, not beside it

ROUNDING: Final = 1e-9  # of a distance: no cell that may be the nearest is left out


@dataclass(frozen=True, eq=False)
class Correlation:
    """Measured modes beside those of a model.

    pairs : measured modes as rows, the model's as columns. distances [n] : of the measured places from the model [m].
    directions : how many displacements are compared.
    """

    pairs: Pairing
    distances: Floats
    directions: int

    @property
    def too_few(self) -> bool:
        """Whether a group has as many modes as displacements are compared: everything would be like it."""
        groups = (self.pairs.groups_a, self.pairs.groups_b)
        return self.directions <= max(int(np.bincount(group).max(initial=0)) for group in groups)


def correlation(measured: MeasuredModes, basis: ModalBasis, shown: Refined, near: float = NEAR_MEASURED) -> Correlation:
    """Which mode of a model each measured one is, by the modal assurance criterion in the measured directions.

    shown : the model subdivided (`refined`); measured places take the motion of the nearest place on it.

    Raises InputError where measured places are farther from the model than 5 % of its size, and where nothing is
    measured or there is nothing to compare it with.
    """
    size = float(np.ptp(shown.points, axis=0).max(initial=0.0))
    if not measured.directed.any():
        raise InputError("measured modes", got="no displacement other than 0", expected="shapes")
    if not basis.modes.stop:
        raise InputError("modes of the model", got="none", expected="modes to compare", do="ask for more of them")
    carry, distances = carried_to(shown, measured.points)
    if distances.max(initial=0.0) > FAR * size:
        far, place = float(distances.max()), measured.points[int(distances.argmax())]
        told = ", ".join(f"{x:.4g}" for x in place)
        raise InputError(
            "measured places",
            got=f"one at ({told}) m, {far:.4g} m from a model of {size:.4g} m",
            expected="places on the model",
            do="give the file's unit of length with --length, or move the origin of the model",
        )
    moved = shown.displacement(basis.shapes[:, :, basis.modes])
    count = moved.shape[2]
    at = (carry @ moved.reshape(len(shown.points), -1)).reshape(len(measured.points), 3, count)
    own = at[measured.directed]
    pairs = pairing_of(measured.measured_shapes, own, measured.frequency_hz, basis.frequency_hz[basis.modes], near)
    return Correlation(pairs, distances, len(own))


def carried_to(shown: Refined, points: Floats) -> tuple[csr_array, Floats]:
    """Weights [m, p] of the points of a subdivided model that give the motion at the places nearest to `points` [m, 3],
    and how far those are [m].

    >>> corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> plate = Refined(corners, [[0, 1, 2, 3]], np.zeros((0, 2)), csr_array((12, 28)), ("plate",), [0, 0, 0, 0])
    >>> weights, distances = carried_to(plate, np.array([[0.75, 0.25, 0.5], [2.0, 0.5, 0.0]]))
    >>> weights.toarray().tolist(), distances.tolist()
    ([[0.25, 0.5, 0.25, 0.0], [0.0, 0.5, 0.5, 0.0]], [0.5, 1.0])
    """
    quads, lines = shown.quads, shown.lines
    alone = np.setdiff1d(np.arange(len(shown.points)), np.concatenate([quads.ravel(), lines.ravel()]))
    cells = np.concatenate(
        [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], lines[:, [0, 1, 1]], np.stack([alone] * 3, axis=1)]
    )
    corners = shown.points[cells]
    rows: list[Integers] = []
    weights: list[Floats] = []
    distances = np.empty(len(points))
    middles = corners.mean(axis=1)
    reach = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1, initial=0.0)
    for number, place in enumerate(points):
        most = np.linalg.norm(shown.points - place, axis=1).min(initial=np.inf) * (1.0 + ROUNDING)
        near = np.flatnonzero(np.linalg.norm(middles - place, axis=1) - reach * (1.0 + ROUNDING) <= most)
        best, weight, distances[number] = _nearest(place, corners[near])
        rows.append(cells[near[best]])
        weights.append(weight)
    indptr = 3 * np.arange(len(points) + 1)
    shape = (len(points), len(shown.points))
    if not rows:
        return csr_array(shape), distances
    carry = csr_array((np.concatenate(weights), np.concatenate(rows), indptr), shape=shape)
    carry.sum_duplicates()
    return carry, distances


def _nearest(place: Floats, corners: Floats) -> tuple[int, Floats, float]:
    """The triangle [t, 3, 3] nearest to a place, the weights of its corners there, and the distance."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    options = [_inside(place, a, b, c)]
    for i, j in ((0, 1), (1, 2), (2, 0)):
        start, side = corners[:, i], corners[:, j] - corners[:, i]
        length = (side**2).sum(axis=1)
        along = np.divide(((place - start) * side).sum(axis=1), length, out=np.zeros(len(length)), where=length > 0)
        along = np.clip(along, 0.0, 1.0)
        weight = np.zeros((len(along), 3))
        weight[:, i] += 1.0 - along
        weight[:, j] += along
        options.append(weight)
    weights = np.stack(options)
    apart = np.linalg.norm(np.einsum("otk,tkx->otx", weights, corners) - place, axis=2)
    apart[0, np.isnan(apart[0])] = np.inf
    option, cell = np.unravel_index(int(apart.argmin()), apart.shape)
    return int(cell), weights[option, cell], float(apart[option, cell])


def _inside(place: Floats, a: Floats, b: Floats, c: Floats) -> Floats:
    """Weights [t, 3] of the corners at the foot of the perpendicular; nan where it is not inside."""
    first, second, to = b - a, c - a, place - a
    ff, fs, ss = ((x * y).sum(axis=1) for x, y in ((first, first), (first, second), (second, second)))
    tf, ts = (to * first).sum(axis=1), (to * second).sum(axis=1)
    area = ff * ss - fs**2
    flat = area > 1e-12 * ff * ss
    v, w = (
        np.divide(top, area, out=np.full_like(area, np.nan), where=flat)
        for top in (ss * tf - fs * ts, ff * ts - fs * tf)
    )
    weights = np.stack([1.0 - v - w, v, w], axis=1)
    weights[~(weights >= 0.0).all(axis=1)] = np.nan
    return np.asarray(weights)
