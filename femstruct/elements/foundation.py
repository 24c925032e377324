"""Stiffness or mass spread over an area or a line, through the interpolation rows of any element."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats


def winkler(rows: ArrayLike, weights: ArrayLike, stiffness: ArrayLike) -> Floats:
    """Contribution of a spread spring (or mass) to the matrix of an element: sum over points of w rows^T k rows.

    rows [..., g, 3, nd] : displacement at g points from the DOFs of the element; a foundation between two parts has the
    difference of two such rows over the DOFs of both. weights [..., g] : area [m^2] or length [m] each point stands
    for. stiffness [3, 3] or [..., g, 3, 3] : per area [N/m^3] or per length [N/m^2], in the axes of the rows; a mass
    per area or per length times the identity gives the consistent mass instead.

    Returns [..., nd, nd], symmetric when the stiffness is.

    Notes: exact when the points are the Gauss points of a sufficient order (4 a direction for plates). Springs act both
    ways: a foundation does not lift off.

    >>> row = np.array([[[0.0, 0.0], [0.0, 0.0], [1.0, -1.0]]])
    >>> winkler(row, [0.5], np.diag([0.0, 0.0, 8.0]))
    array([[ 4., -4.],
           [-4.,  4.]])
    """
    displacement = np.asarray(rows, dtype=np.float64)
    per_point = np.asarray(stiffness, dtype=np.float64) * np.asarray(weights, dtype=np.float64)[..., None, None]
    contribution: Floats = (np.swapaxes(displacement, -1, -2) @ per_point @ displacement).sum(axis=-3)
    return contribution
