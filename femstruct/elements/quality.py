"""Shape of shell elements: angles, warp and aspect, and which of them cost accuracy.

The limits were measured with the elements of `femstruct.elements.quad_shell` and `femstruct.elements.triangle_shell`,
against the same number of cells without the fault: the first four frequencies of a supported square plate, the
deflection of a beam 12 x 2 bent in its plane by cells that lean to and fro, and a strip twisted by 90 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError

SHARPEST: Final = np.radians(30.0)
"""Corner of a quadrilateral. With 30 degrees a plate's frequencies err five times as much as with squares, a beam bends
5 % too little; with 15 degrees it is ten times and 7 %; with 45 degrees three times and 2 %."""
BLUNTEST: Final = {4: np.radians(150.0), 3: np.radians(120.0)}
"""Corner, by the number of corners. Of triangles with 117, 135 and 153 degrees a beam bends 7, 11 and 27 % too little;
thin ones with a right angle keep within 2 %, so that a sharp corner of a triangle is no fault."""
MOST_WARPED: Final = np.radians(20.0)
"""Angle between the two halves of a quadrilateral: the twisted strip errs by 4 % with 31 degrees, 2 % with 24, 0.6 %
with 17."""
NO_AREA: Final = 1e-12
"""Of the square of the longest side: rounding of coordinates."""
LONGEST: Final = 20.0
"""Aspect: rectangles of 16 to 1 lost nothing, so this is where a slip in the mesh becomes the likelier reason."""


@dataclass(frozen=True)
class Shapes:
    """Shapes of n elements of one number of corners.

    corners : 3 or 4. sharpest, bluntest [n] : smallest and largest angle at a corner in the mean plane [rad]; pi or
    more where a quadrilateral is not convex, nan where an element has no area. warp [n] : angle between the normals of
    the halves of a quadrilateral, the larger of both diagonals [rad]; zero for triangles. aspect [n] : square of the
    longest side over the area, 1 for squares and equilateral triangles, a / b for rectangles; infinite without area.
    """

    corners: int
    sharpest: Floats
    bluntest: Floats
    warp: Floats
    aspect: Floats

    def faults(self) -> dict[str, Integers]:
        """Numbers of the elements with each fault, the worst first; only faults that some element has.

        "impossible" : no area, not convex, or two corners in one place, so that no matrices can be made. "sharp",
        "blunt", "warped", "long" : beyond the limits above.

        >>> shapes([[[0, 0, 0], [30, 0, 0], [30, 1, 0], [0, 1, 0]]]).faults()
        {'long': array([0])}
        """
        impossible = ~((self.sharpest > 0.0) & (self.bluntest < np.pi))
        sharp = (self.sharpest < SHARPEST) & (self.corners == 4)
        measured = {
            "impossible": (impossible, np.where(np.isnan(self.bluntest), np.inf, self.bluntest)),
            "sharp": (sharp & ~impossible, -self.sharpest),
            "blunt": ((self.bluntest > BLUNTEST[self.corners]) & ~impossible, self.bluntest),
            "warped": ((self.warp > MOST_WARPED) & ~impossible, self.warp),
            "long": ((self.aspect > LONGEST) & ~impossible, self.aspect),
        }
        found = {name: np.flatnonzero(bad) for name, (bad, _) in measured.items()}
        return {name: which[np.argsort(-measured[name][1][which])] for name, which in found.items() if len(which)}


def shapes(corners: ArrayLike) -> Shapes:
    """Shapes of elements [n, 3, 3] or [n, 4, 3] from their corners in space [m]; InputError for another shape.

    >>> of = shapes([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    >>> np.degrees([of.sharpest[0], of.bluntest[0]]).round(9), of.aspect.round(3)
    (array([45., 90.]), array([1.732]))
    """
    points = np.asarray(corners, dtype=np.float64)
    if points.ndim != 3 or points.shape[1] not in (3, 4) or points.shape[2] != 3:
        raise InputError("corners", got=f"shape {points.shape}", expected="shape (n, 3, 3) or (n, 4, 3)")
    ahead, behind = np.roll(points, -1, axis=1) - points, np.roll(points, 1, axis=1) - points
    halves = np.cross(ahead, behind)  # normals of the triangles at the corners
    normal = halves.sum(axis=1)
    size = np.linalg.norm(normal, axis=1)
    longest = (ahead**2).sum(axis=2).max(axis=1)
    flat = ~(size > NO_AREA * longest)
    normal = normal / np.where(flat, 1.0, size)[:, None]
    upright = [(vector * normal[:, None]).sum(axis=2) for vector in (ahead, behind)]
    sine = (halves * normal[:, None]).sum(axis=2)
    angle = np.arctan2(sine, (ahead * behind).sum(axis=2) - upright[0] * upright[1])
    angle = np.where(flat[:, None], np.nan, np.mod(angle, 2.0 * np.pi))
    unit, warp = (0.25, _between(halves)) if points.shape[1] == 4 else (1.0 / 6.0 * 4.0 / np.sqrt(3.0), 0.0 * size)
    aspect = np.where(flat, np.inf, longest / np.where(flat, 1.0, size * unit))
    return Shapes(points.shape[1], angle.min(axis=1), angle.max(axis=1), warp, aspect)


def _between(normals: Floats) -> Floats:
    """Larger of the angles [n] between the normals at opposite corners [n, 4, 3]."""
    first, second = normals[:, :2], normals[:, 2:]
    sine = np.linalg.norm(np.cross(first, second), axis=2)
    result: Floats = np.arctan2(sine, (first * second).sum(axis=2)).max(axis=1)
    return result
