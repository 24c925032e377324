"""Which mode of one basis is which of another: the modal assurance criterion."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import FemstructError
from femstruct.modal.basis import ModalBasis


def mac(a: ModalBasis, b: ModalBasis) -> Floats:
    """Modal assurance criterion of the modes of two bases, |a . b|^2 / (|a|^2 |b|^2) [ka, kb], residuals left out.

    Shapes are compared on the nodes that both have: the same position, and the same turn among nodes at one position.
    Only translations count, and every node alike: a finely meshed part weighs more than a coarse one, so values are
    a measure of likeness, not orthogonality.

    Raises FemstructError when the bases have no node in common.

    Source: R. J. Allemang, D. L. Brown, Proc. 1st Int. Modal Analysis Conf. (1982) 110-116.
    """
    in_a, in_b = _common_nodes(a.points, b.points)
    if not len(in_a):
        raise FemstructError("mac", got="no node in common", expected="two bases of one structure")
    first = a.shapes[in_a][:, :3, a.modes].reshape(3 * len(in_a), -1)
    second = b.shapes[in_b][:, :3, b.modes].reshape(3 * len(in_b), -1)
    sizes = np.outer((first**2).sum(axis=0), (second**2).sum(axis=0))
    values: Floats = np.divide((first.T @ second) ** 2, sizes, out=np.zeros_like(sizes), where=sizes > 0)
    return values


def _common_nodes(a: Floats, b: Floats) -> tuple[Integers, Integers]:
    """Indices of the nodes both sets of points [n, 3] have, by position and turn at that position."""
    size = max(float(np.ptp(a, axis=0).max()), float(np.ptp(b, axis=0).max()), 1e-300)
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
