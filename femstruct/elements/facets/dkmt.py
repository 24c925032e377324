"""Bending and transverse shear of triangles: the discrete Kirchhoff-Mindlin triangle (DKMT) of Katili.

The lean of the fibres (beta_x = RY, beta_y = -RX) is linear but for a parabola along each side, whose size follows from
the moment and shear balance of the side as a beam; the shear strain that belongs to it is constant along the side and
carried linearly into the cell. Thin plates are those of Kirchhoff along the sides, thick ones those of Mindlin.

Reference: I. Katili, Int. J. Numer. Methods Eng. 36 (1993) 1859-1883, doi:10.1002/nme.1620361106.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.elements.facets.motion import side_shears

N_DOFS: Final = 9


def bending_rows(corners: Floats, areas: Floats, D: Floats, As: Floats, at: Floats) -> tuple[Floats, Floats]:
    """Rows of the curvatures [n, g, 3, 9] and of the shear strains [n, g, 2, 9] at places, from all w, beta_x, beta_y.

    corners [n, 3, 2] : counterclockwise; areas [n]; D [3, 3] or [n, 3, 3], As [2, 2] or [n, 2, 2] : bending and shear
    rigidities, whose ratio says how much of a side's motion is shear; at [n, g, 3] : shares of the corners.
    """
    sides = np.roll(corners, -1, axis=1) - corners
    length = np.linalg.norm(sides, axis=2)
    c, s = np.moveaxis(sides / length[..., None], -1, 0)
    share = _shear_share(c, s, length, D, As)
    lean = side_shears(corners) * (-1.5 / (length * (1.0 + share)))[..., None]
    by_x, by_y = _gradients(corners, areas)
    curvatures = np.zeros((*at.shape[:2], 3, N_DOFS))
    curvatures[:, :, 0, 3:6] = curvatures[:, :, 2, 6:] = by_x[:, None]
    curvatures[:, :, 1, 6:] = curvatures[:, :, 2, 3:6] = by_y[:, None]
    following = np.roll(at, -1, axis=2)
    bent_x, bent_y = (4.0 * (at * np.roll(of, -1, axis=1)[:, None] + following * of[:, None]) for of in (by_x, by_y))
    c, s = c[:, None], s[:, None]
    curvatures += np.stack([bent_x * c, bent_y * s, bent_y * c + bent_x * s], axis=2) @ lean[:, None]
    return curvatures, _carried(c, s, at) @ (lean * (-share / 1.5)[..., None])[:, None]


def _shear_share(c: Floats, s: Floats, length: Floats, D: Floats, As: Floats) -> Floats:
    """12 D / (As L^2) of each side [n, 3], with the rigidities along it."""
    bent = np.stack([c * c, s * s, 2.0 * c * s], axis=2)
    sheared = np.stack([c, s], axis=2)
    ratio: Floats = ((bent @ D) * bent).sum(axis=2) / ((sheared @ As) * sheared).sum(axis=2)
    return 12.0 * ratio / length**2


def _gradients(corners: Floats, areas: Floats) -> tuple[Floats, Floats]:
    """Derivatives by x and y of the shares of the corners: [n, 3] each."""
    opposite = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
    twice = 2.0 * areas[:, None]
    return -opposite[..., 1] / twice, opposite[..., 0] / twice


def _carried(c: Floats, s: Floats, at: Floats) -> Floats:
    """Shear strain at places from that along sides, at a corner that of its two sides, then linear: [n, g, 2, 3]."""
    c_before, s_before = np.roll(c, 1, axis=2), np.roll(s, 1, axis=2)
    share = at / (c_before * s - s_before * c)
    own, before = (
        np.stack([-s_before, c_before], axis=2) * share[:, :, None],
        np.stack([s, -c], axis=2) * share[:, :, None],
    )
    result: Floats = own + np.roll(before, -1, axis=3)
    return result
