"""Ribs that are drawn at their true height, beside the mid-surface that they are joined to: what to write instead."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.model.meshed import Meshed

_SMALL: Final = 1e-6  # of the extent of bars: a height that varies by less is the same


def offsets_to_write(names: tuple[str, str], feet: Floats, arms: Floats, corner: Floats, normal: Floats) -> str | None:
    """What moves lines of bars into a plane and leaves the bars where they are; None where they are not at one height
    over it, or have several offsets.

    names : of the bars and of what lies in the plane. feet, arms [n, 3] : places of their lines, and from there to
    their axes [m]. corner, normal [3] : of the plane.

    >>> feet = np.array([[0.1, 0.6, -0.07], [1.9, 0.6, -0.07]])
    >>> offsets_to_write(("rib", "slab"), feet, 0.0 * feet, np.zeros(3), np.array([0.0, 0.0, 1.0]))
    "if rib is a rib of slab, move its lines by [0, 0, 70 mm] into the mid-surface of slab and write 'offsets: {start: \
[0, 0, -70 mm], end: [0, 0, -70 mm]}'"
    """
    heights = (feet - corner) @ normal
    small = _SMALL * float(np.ptp(feet, axis=0).max(initial=0.0))
    height = float(heights.mean())
    if np.ptp(heights) > small or np.ptp(arms, axis=0).max() > small or abs(height) <= small:
        return None
    offset = written(height * normal + arms[0])
    return (
        f"if {names[0]} is a rib of {names[1]}, move its lines by {written(-height * normal)} into the mid-surface of "
        f"{names[1]} and write 'offsets: {{start: {offset}, end: {offset}}}'"
    )


def offsets_of(one: Meshed, other: Meshed) -> str | None:
    """The same, of two parts one of which has bars and the other lies in one plane."""
    for bars, flat in ((one, other), (other, one)):
        ends, axes = np.unique(bars.lines), flat.own_axes
        if len(ends) and not len(flat.lines) and axes is not None:
            feet = bars.places[ends - bars.first]
            return offsets_to_write((bars.name, flat.name), feet, bars.beside(ends), flat.places[0], axes[2])
    return None


def written(vector: Floats) -> str:
    """Lengths along x, y, z [m] as a model file has them."""
    size = float(np.abs(vector).max())
    return "[" + ", ".join("0" if abs(one) < _SMALL * size else f"{1e3 * one:.6g} mm" for one in vector) + "]"
