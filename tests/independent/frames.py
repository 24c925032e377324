"""Slender frames in space by dense matrices of the textbook: Euler and Bernoulli's bars with consistent mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi

import numpy as np
from scipy.linalg import eigh

Floats = np.ndarray


@dataclass(frozen=True)
class Tube:
    """A round tube of one material: bends alike in all directions, so it needs no direction across."""

    outer: float
    thickness: float
    E: float
    nu: float
    rho: float

    @property
    def area(self) -> float:
        return pi / 4 * (self.outer**2 - (self.outer - 2 * self.thickness) ** 2)

    @property
    def second_moment(self) -> float:
        return pi / 64 * (self.outer**4 - (self.outer - 2 * self.thickness) ** 4)


def matrices(tube: Tube, nodes: Floats, bars: Sequence[tuple[int, int]]) -> tuple[Floats, Floats]:
    """Stiffness and mass, six motions a node: x y z, then turns about them."""
    K = np.zeros((6 * len(nodes), 6 * len(nodes)))
    M = np.zeros_like(K)
    for start, end in bars:
        along = nodes[end] - nodes[start]
        length = float(np.linalg.norm(along))
        first = along / length
        second = np.cross(first, np.eye(3)[np.argmin(np.abs(first))])
        second /= np.linalg.norm(second)
        turn = np.kron(np.eye(4), np.array([first, second, np.cross(first, second)]))
        k, m = _bar(tube, length)
        at = np.r_[6 * start : 6 * start + 6, 6 * end : 6 * end + 6]
        K[np.ix_(at, at)] += turn.T @ k @ turn
        M[np.ix_(at, at)] += turn.T @ m @ turn
    return K, M


def _bar(tube: Tube, L: float) -> tuple[Floats, Floats]:
    k, m = np.zeros((12, 12)), np.zeros((12, 12))
    I, mass = tube.second_moment, tube.rho * tube.area * L  # noqa: E741
    pair, share = np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    G = tube.E / 2 / (1 + tube.nu)
    for at, stiffness, inertia in (
        ([0, 6], tube.E * tube.area / L, mass),
        ([3, 9], G * 2 * I / L, 2 * tube.rho * I * L),
    ):
        k[np.ix_(at, at)] += stiffness * pair
        m[np.ix_(at, at)] += inertia * share
    bend = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) * tube.E * I / L**3
    sway = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) * mass / 420
    for at, sign in (([1, 5, 7, 11], 1), ([2, 4, 8, 10], -1)):  # a turn about y lowers z
        size = np.array([1, sign * L, 1, sign * L])
        k[np.ix_(at, at)] += bend * np.outer(size, size)
        m[np.ix_(at, at)] += sway * np.outer(size, size)
    return k, m


def cut(corners: Floats, pieces: int) -> tuple[Floats, list[tuple[int, int]]]:
    """Nodes and bars of a line through corners, each stretch cut in equal pieces."""
    shares = np.arange(1, pieces + 1)[:, None] / pieces
    nodes = [corners[:1]] + [a + (b - a) * shares for a, b in pairwise(corners)]
    whole = np.vstack(nodes)
    return whole, [(i, i + 1) for i in range(len(whole) - 1)]


def tip_at_rest(tube: Tube, corners: Floats, force: Floats) -> Floats:
    """The six motions of the last corner under a force there; the first corner is clamped."""
    K, _ = matrices(tube, *cut(corners, 1))
    load = np.zeros(len(K))
    load[-6:-3] = force
    return np.linalg.solve(K[6:, 6:], load[6:])[-6:]


def clamped_frequencies(tube: Tube, corners: Floats, count: int, pieces: int = 12) -> Floats:
    """Natural frequencies [Hz]; the first corner is clamped."""
    K, M = matrices(tube, *cut(corners, pieces))
    return np.sqrt(eigh(K[6:, 6:], M[6:, 6:], eigvals_only=True)[:count]) / 2 / pi
