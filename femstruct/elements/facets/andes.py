"""Membrane strains of triangles with drilling rotations: Felippa's optimal member of the ANDES family (OPT).

The strain is a mean, that of a triangle whose sides move as parabolas, and a part linear in the cell without a mean,
assumed from the rotations of the corners beside that of the whole. Bending in its plane is exact for one aspect of
rectangles cut in two, in any direction; no tie of RZ to the displacements is needed, and there is no parameter.

Reference: C. A. Felippa, Comput. Methods Appl. Mech. Eng. 192 (2003) 2125-2168, doi:10.1016/S0045-7825(03)00253-6.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats

N_DOFS: Final = 9
SMALLEST: Final = 0.01
"""Of the factor (1 - 4 nu^2) / 2 of the linear strains: Felippa's bound, with which the stiffness keeps its rank."""
_SHARE: Final = 1.5  # of the rotations in the mean strain: alpha_b
_BETA: Final = np.array([[1.0, 2.0, 1.0], [0.0, 1.0, -1.0], [-1.0, -1.0, -2.0]])
_TURNED: Final = [2, 0, 1]


def strain_rows(corners: Floats, areas: Floats, A: Floats, at: Floats) -> Floats:
    """Rows of (u_x, v_y, u_y + v_x) at places from all u, all v, all RZ: [n, g, 3, 9].

    corners [n, 3, 2] : counterclockwise; areas [n]; A [3, 3] or [n, 3, 3] : membrane stiffness, whose Poisson's ratio
    sets the size of the linear part; at [n, g, 3] : shares of the corners.
    """
    shares = np.sqrt(2.25 * linear_factor(A))
    linear = np.einsum("ngc,ncij->ngij", at, _natural(corners, areas)) * np.reshape(shares, (-1, 1, 1, 1))
    into_xy = _from_natural(corners) * (2.0 * areas / 3.0)[:, None, None]
    parts = into_xy[:, None] @ linear @ _beside_the_whole(corners, areas)[:, None]
    rows: Floats = _mean(corners, areas)[:, None] + parts
    return rows


def linear_factor(A: Floats) -> Floats:
    """(1 - 4 nu^2) / 2 but at least 0.01; nu of a laminate is that of its mean over all directions.

    >>> round(float(linear_factor(np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]]))), 12)
    0.32
    """
    straight = 3.0 * (A[..., 0, 0] + A[..., 1, 1]) + 2.0 * A[..., 0, 1] + 4.0 * A[..., 2, 2]
    across = A[..., 0, 0] + A[..., 1, 1] + 6.0 * A[..., 0, 1] - 4.0 * A[..., 2, 2]
    factor: Floats = np.maximum((1.0 - 4.0 * (across / straight) ** 2) / 2.0, SMALLEST)
    return factor


def _around(corners: Floats) -> tuple[Floats, Floats, Floats]:
    """Vectors [n, 3, 2] of each corner i with the next j and the one before k: k - j, i - k, j - i."""
    following, before = np.roll(corners, -1, axis=1), np.roll(corners, 1, axis=1)
    return before - following, corners - before, following - corners


def _mean(corners: Floats, areas: Floats) -> Floats:
    """Rows [n, 3, 9] of the mean strain: forces of a constant stress on the sides, shared with the rotations."""
    opposite, towards, away = _around(corners)
    (x_kj, y_kj), (x_ik, y_ik), (x_ji, y_ji) = (np.moveaxis(of, -1, 0) for of in (opposite, towards, away))
    rows = np.zeros((len(corners), 3, 3, 3))
    rows[:, 0, 0] = rows[:, 2, 1] = -y_kj
    rows[:, 1, 1] = rows[:, 2, 0] = x_kj
    rows[:, 0, 2] = -y_kj * (y_ik - y_ji) * _SHARE / 6.0
    rows[:, 1, 2] = -x_kj * (x_ik - x_ji) * _SHARE / 6.0
    rows[:, 2, 2] = (x_ji * y_ji - x_ik * y_ik) * _SHARE / 3.0
    return rows.reshape(-1, 3, N_DOFS) / (2.0 * areas)[:, None, None]


def _beside_the_whole(corners: Floats, areas: Floats) -> Floats:
    """Rows [n, 3, 9] of RZ at the corners less the rotation of the triangle as a whole."""
    opposite, _, _ = _around(corners)
    rows = np.zeros((len(corners), 3, 3, 3))
    rows[:, :, 0] = opposite[:, None, :, 0] / (4.0 * areas)[:, None, None]
    rows[:, :, 1] = opposite[:, None, :, 1] / (4.0 * areas)[:, None, None]
    rows[:, :, 2] = np.eye(3)
    return rows.reshape(-1, 3, N_DOFS)


def _natural(corners: Floats, areas: Floats) -> Floats:
    """Strains along the sides at each corner from the rotations of `_beside_the_whole`, over 2 A / 3: [n, 3, 3, 3]."""
    squares = (_around(corners)[2] ** 2).sum(axis=-1)
    at_corners = [_BETA]
    for _ in range(2):  # the same seen from the next corner
        at_corners.append(at_corners[-1][_TURNED][:, _TURNED])
    strains: Floats = np.array(at_corners)[None] / squares[:, None, :, None]
    return strains


def _from_natural(corners: Floats) -> Floats:
    """Strains (xx, yy, 2 xy) from those along the three sides: [n, 3, 3]."""
    sides = _around(corners)[2]
    x, y = np.moveaxis(sides / np.linalg.norm(sides, axis=-1, keepdims=True), -1, 0)
    into_xy: Floats = np.linalg.inv(np.stack([x * x, y * y, x * y], axis=-1))
    return into_xy
