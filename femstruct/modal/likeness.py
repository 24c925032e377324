"""Which mode of one basis is which of another: the modal assurance criterion, of single modes and of groups."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from femstruct.arrays import Floats, Integers
from femstruct.errors import FemstructError, InputError
from femstruct.modal.basis import ModalBasis

NEAR_EQUAL: Final = 1e-3
"""Relative width of a group of frequencies: a change of the structure by this much mixes the shapes within it."""
_TURNED: Final = 1e-7  # of a shape: what is left of one that the others of its group already have
TIE: Final = 1e-6  # what the MAC of single modes counts beside that of groups: it decides between equal ones alone


def mac(a: ModalBasis, b: ModalBasis) -> Floats:
    """Modal assurance criterion of the modes of two bases, |a . b|^2 / (|a|^2 |b|^2) [ka, kb], residuals left out.

    Shapes are compared on the nodes that both have: the same position, and the same turn among nodes at one position.
    Only translations count, and every node alike: a finely meshed part weighs more than a coarse one, so values are
    a measure of likeness, not orthogonality.

    Raises FemstructError when the bases have no node in common.

    Source: R. J. Allemang, D. L. Brown, Proc. 1st Int. Modal Analysis Conf. (1982) 110-116.
    """
    return mac_of(*_shared_shapes(a, b))


def mac_of(a: ArrayLike, b: ArrayLike) -> Floats:
    """Modal assurance criterion |a^H b|^2 / (|a|^2 |b|^2) [ka, kb] of shapes [n, ka] and [n, kb], real or complex.

    Raises InputError for shapes at different numbers of places. A shape that moves nothing is like no other: 0.

    >>> mac_of([[1.0], [1.0]], [[1.0, 1.0], [-1.0, 0.0]]).round(3).tolist()
    [[0.0, 0.5]]
    """
    first, second = np.asarray(a), np.asarray(b)
    if first.ndim != 2 or second.ndim != 2 or len(first) != len(second):
        expected = "two tables of shapes, [n, ka] and [n, kb], at the same n places"
        raise InputError("mac", got=f"{first.shape} and {second.shape}", expected=expected)
    sizes = np.outer(_squared(first).sum(axis=0), _squared(second).sum(axis=0))
    products = _squared(first.conj().T @ second)
    values: Floats = np.divide(products, sizes, out=np.zeros_like(sizes), where=sizes > 0)
    return values


@dataclass(frozen=True, eq=False)
class Pairing:
    """Which mode of b is which of a.

    mac [ka, kb] : of single modes. likeness [ka, kb] : of each mode with the group of near-equal frequencies that the
    other one belongs to; `mac` where neither is in a group. partner [ka] : index of the mode most alike of b.
    groups_a, groups_b : number of the group of every mode [ka], [kb].
    """

    mac: Floats
    likeness: Floats
    partner: Integers
    groups_a: Integers
    groups_b: Integers

    def alike(self, mode: int) -> float:
        """Likeness of a mode of a, counted from 0, and its partner."""
        return float(self.likeness[mode, self.partner[mode]])


def pairing(a: ModalBasis, b: ModalBasis, near: float = NEAR_EQUAL) -> Pairing:
    """The modes of two bases paired by shape; modes of near-equal frequencies count as one space.

    Parameters
    ----------
    near : float
        Relative width of a group of frequencies [1]; rigid modes are a group.

    Raises
    ------
    FemstructError
        As `mac`.

    Examples
    --------
    The two modes (1, 2) and (2, 1) of a square plate may be turned into each other by any angle; each is then like one
    of the others by half, and wholly in the space of both:

    >>> from dataclasses import replace
    >>> from femstruct.modal.closed_form import given_modes
    >>> one, _ = given_modes([50.0, 50.0], [0.0, 0.0], {"P": [1.0, 0.0], "Q": [0.0, 1.0]}, at={"P": 0.0, "Q": 1.0})
    >>> turn = np.array([[1.0, -1.0], [1.0, 1.0]]) / np.sqrt(2.0)
    >>> found = pairing(one, replace(one, shapes=one.shapes @ turn))
    >>> found.mac.round(6).tolist(), found.partner.tolist(), round(found.alike(0), 6)
    ([[0.5, 0.5], [0.5, 0.5]], [0, 1], 1.0)
    """
    return pairing_of(*_shared_shapes(a, b), a.frequency_hz[a.modes], b.frequency_hz[b.modes], near)


def pairing_of(
    a: NDArray[Any], b: NDArray[Any], frequency_a: ArrayLike, frequency_b: ArrayLike, near: float = NEAR_EQUAL
) -> Pairing:
    """Shapes a [n, ka] and b [n, kb], real or complex, paired; frequencies [ka], [kb] [Hz], ascending.

    Notes
    -----
    A mode beside a group: the largest MAC it can have with any combination of the group's modes (S2MAC), which is the
    squared cosine of the angle between it and their space. Two groups: that of a mode of the smaller one with the
    space of the larger; of equal ones the smaller value from either side. A single mode takes the partner that is most
    alike, whoever else takes it; of modes in groups every one takes its own. A group with as many modes as there are
    places is like everything: then the places are too few.

    Source: W. D'Ambrogio, A. Fregolent, Mechanical Systems and Signal Processing 17 (2003) 599-610,
    doi:10.1006/mssp.2002.1468.
    """
    single = mac_of(a, b)
    groups_a, groups_b = near_equal(frequency_a, near), near_equal(frequency_b, near)
    counts_a, counts_b = np.bincount(groups_a)[groups_a], np.bincount(groups_b)[groups_b]
    in_b, in_a = _in_spaces(a, b, groups_b), _in_spaces(b, a, groups_a).T
    size_a, size_b = counts_a[:, None], counts_b[None, :]
    likeness = np.where(size_a < size_b, in_b, np.where(size_a > size_b, in_a, np.minimum(in_a, in_b)))
    likeness = np.where((size_a == 1) & (size_b == 1), single, likeness)
    return Pairing(single, likeness, _partners(likeness, single, counts_a, counts_b), groups_a, groups_b)


def near_equal(frequency_hz: ArrayLike, near: float = NEAR_EQUAL) -> Integers:
    """Number of the group of every frequency [k]; a group is at most `near` wide, relative to its lowest one.

    Parameters
    ----------
    frequency_hz : ArrayLike [k]
        Ascending; those of rigid modes, zero, are a group.

    Examples
    --------
    >>> near_equal([0.0, 0.0, 50.0, 50.01, 50.2]).tolist()
    [0, 0, 1, 1, 2]
    """
    frequency = np.asarray(frequency_hz, dtype=np.float64)
    groups = np.zeros(len(frequency), dtype=np.int64)
    first = 0
    for i in range(1, len(frequency)):
        if frequency[i] > frequency[first] * (1.0 + near):
            first = i
        groups[i] = groups[i - 1] + (first == i)
    return groups


def _partners(likeness: Floats, single: Floats, counts_a: Integers, counts_b: Integers) -> Integers:
    """Index of the most alike of b [ka]; of modes that meet a group, each takes its own while there are enough."""
    if not likeness.shape[1]:
        return np.zeros(len(likeness), dtype=np.int64)
    value = likeness + TIE * single
    partner: Integers = np.where((counts_a > 1)[:, None], value, likeness).argmax(axis=1).astype(np.int64)
    among = np.flatnonzero((counts_a > 1) | (counts_b[partner] > 1))
    rows, columns = scipy.optimize.linear_sum_assignment(value[among], maximize=True)
    partner[among[rows]] = columns
    return partner


def _in_spaces(a: NDArray[Any], b: NDArray[Any], groups: Integers) -> Floats:
    """Share [ka, kb] of each shape of a that lies in the space of the group of b that each mode of b belongs to, where
    it is of several."""
    shares = np.zeros((a.shape[1], b.shape[1]))
    sizes = _squared(a).sum(axis=0)
    for group in np.flatnonzero(np.bincount(groups) > 1):
        members = groups == group
        vectors, values, _ = np.linalg.svd(b[:, members], full_matrices=False)
        space = vectors[:, values > _TURNED * values.max(initial=0.0)]
        inside = _squared(space.conj().T @ a).sum(axis=0)
        shares[:, members] = np.divide(inside, sizes, out=np.zeros_like(sizes), where=sizes > 0)[:, None]
    return shares


def _squared(values: NDArray[Any]) -> Floats:
    return np.asarray(np.abs(values) ** 2, dtype=np.float64)


def _shared_shapes(a: ModalBasis, b: ModalBasis) -> tuple[Floats, Floats]:
    """Displacements [3 n, k] of the modes of two bases at the nodes that both have."""
    in_a, in_b = _common_nodes(a.points, b.points)
    if not len(in_a):
        raise FemstructError("mac", got="no node in common", expected="two bases of one structure")
    first, second = (
        basis.shapes[nodes][:, :3, basis.modes].reshape(3 * len(nodes), -1) for basis, nodes in ((a, in_a), (b, in_b))
    )
    return first, second


def share_nodes(a: ModalBasis, b: ModalBasis) -> bool:
    """Whether two bases have a node in common, so that their shapes can be compared.

    >>> from femstruct.modal.closed_form import given_modes
    >>> one, _ = given_modes([50.0], [0.0], {"P": [1.0]}, at={"P": 0.0})
    >>> other, _ = given_modes([50.0], [0.0], {"P": [1.0]}, at={"P": 2.0})
    >>> share_nodes(one, one), share_nodes(one, other)
    (True, False)
    """
    return bool(len(a.points) and len(b.points) and len(_common_nodes(a.points, b.points)[0]))


def _common_nodes(a: Floats, b: Floats) -> tuple[Integers, Integers]:
    """Indices of the nodes both sets of points [n, 3] have, by position and turn at that position."""
    size = max(float(np.ptp(a, axis=0).max()), float(np.ptp(b, axis=0).max()))
    size = size or float(max(np.abs(a).max(), np.abs(b).max())) or 1.0  # one node each
    rounded = np.round(np.concatenate([a, b]) / (1e-7 * size)).astype(np.int64)
    _, place = np.unique(rounded, axis=0, return_inverse=True)
    of_a, of_b = place[: len(a)].ravel(), place[len(a) :].ravel()
    keys_a, keys_b = (np.stack([of, _turn(of)], axis=1) for of in (of_a, of_b))
    base = np.int64(1 + max(int(keys_a[:, 1].max(initial=0)), int(keys_b[:, 1].max(initial=0))))
    _, in_a, in_b = np.intersect1d(keys_a @ [base, 1], keys_b @ [base, 1], assume_unique=True, return_indices=True)
    return in_a.astype(np.int64), in_b.astype(np.int64)


def _turn(place: Integers) -> Integers:
    """How many earlier entries have the same value [n]."""
    order = np.argsort(place, kind="stable")
    _, first, counts = np.unique(place[order], return_index=True, return_counts=True)
    turn = np.empty_like(place)
    turn[order] = np.arange(len(place)) - np.repeat(first, counts)
    return turn
