"""Bars under an even load between their ends: what it adds to what the motion of their nodes tells.

The deflection of a bar between nodes that do not move, under a load p per length and fixed at both ends, is

    v = p L^4 s^2 (1 - s)^2 / 24 E I + p L^2 s (1 - s) / 2 k G A,    E I v'' = p L^2 (1 - 6 s + 6 s^2) / 12

The ends of a bar move exactly under consistent loads; between them its polynomials leave this out, but for what the
middle node of "timoshenko18" has of it: all of the stretch and of the shear, and nothing of the bending.

Reference: J. S. Przemieniecki, Theory of Matrix Structural Analysis (McGraw-Hill 1968), section 5.6.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements.frame import nodes_per_bar


def forces(kind: str, load: Floats, length: ArrayLike, place: ArrayLike) -> Floats:
    """Section forces [m, 6] N Vy Vz [N], T My Mz [N m] that an even load adds to those of the nodes, without shear.

    kind : "euler", "timoshenko" or "timoshenko18"; load [m, 3] : along local x, y, z [N/m]; length [m] of the bars [m];
    place [m] : from 0 at end i to 1 at end j.

    Half-way along a bar of 2 m under 12 N/m, fixed at both ends: p L^2 / 24, and p L^2 / 12 at its ends:

    >>> forces("euler", np.array([[0.0, 12.0, 0.0]] * 2), 2.0, np.array([0.0, 0.5]))[:, 5]
    array([ 4., -2.])
    """
    length, s = np.asarray(length, dtype=np.float64), np.asarray(place, dtype=np.float64)
    found = np.zeros((len(load), 6))
    if nodes_per_bar(kind) == 2:
        found[:, 0] = load[:, 0] * length * (0.5 - s)
    bending = length**2 * (1.0 - 6.0 * s + 6.0 * s**2) / 12.0
    found[:, 4], found[:, 5] = -load[:, 2] * bending, load[:, 1] * bending
    return found


def deflection(
    kind: str,
    load: Floats,
    length: ArrayLike,
    place: ArrayLike,
    E: float,
    G: float,
    A: float,
    Iy: float,
    Iz: float,
    ky: float,
    kz: float,
) -> Floats:
    """Displacement [m, 3] of the axis along local x, y, z [m] that an even load adds to that of the nodes.

    Arguments as `forces`, with the constants of `femstruct.elements.frame.stiffness`.

    >>> moved = deflection("euler", np.array([[0.0, 384.0, 0.0]]), 1.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    >>> moved.tolist()  # p L^4 / 384 E I
    [[0.0, 1.0, 0.0]]
    """
    length, s = np.asarray(length, dtype=np.float64), np.asarray(place, dtype=np.float64)
    bent, between = (length**2 * s * (1.0 - s)) ** 2 / 24.0, length**2 * s * (1.0 - s) / 2.0
    found = np.zeros((len(load), 3))
    found[:, 1], found[:, 2] = load[:, 1] * bent / (E * Iz), load[:, 2] * bent / (E * Iy)
    if nodes_per_bar(kind) == 2:
        found[:, 0] = load[:, 0] * between / (E * A)
    if kind == "timoshenko":
        found[:, 1] += load[:, 1] * between / (ky * G * A)
        found[:, 2] += load[:, 2] * between / (kz * G * A)
    return found
