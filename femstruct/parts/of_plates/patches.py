"""Patches of a plate: a point that stands for the mean over a small disc or rectangle around it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers
from femstruct.elements.quadrature import gauss_interval
from femstruct.errors import InputError
from femstruct.model.region import Pair
from femstruct.model.rows import sparse_rows

ORDER = 3  # Gauss points across each piece of a cell: its deflection is cubic
ORDER_ROUND = 12  # along the arc, where the length of a chord is a cosine


def patch_points(
    where: str,
    name: str,
    size: Pair,
    grid: tuple[Floats, Floats],
    center: Floats,
    patch: float | Pair,
    tolerance: float,
) -> tuple[Floats, Floats]:
    """Places [p, 2] and shares [p] whose mean motion is that of a patch, in a plate's coordinates [m].

    name, size, grid : of the plate, its grid lines along x and y. center [2]. patch : radius of a disc, or the sides of
    a rectangle [m].

    By virtual work a force on this mean is spread evenly over the patch: it keeps the force and its moment about any
    point. Rotations are means as well.

    Raises InputError for a patch that reaches beyond its plate.
    """
    reach = np.array([patch, patch] if isinstance(patch, float) else patch) * (1.0 if isinstance(patch, float) else 0.5)
    beyond = float(max((reach - center).max(), (center + reach - size).max()))
    if beyond > tolerance:
        raise InputError(
            f"{where}.patch",
            got=f"a patch that reaches {beyond:.4g} m beyond {name}",
            expected=f"a patch inside {size[0]:g} m x {size[1]:g} m",
            do="make it smaller, or move the point",
        )
    return _disc(*grid, center, patch) if isinstance(patch, float) else _rectangle(*grid, center, reach)


def patch_turning(
    where: str,
    centers: Floats,
    reach: float,
    size: Pair,
    axes: Floats,
    motion: Callable[[Floats], tuple[Integers, Floats]],
    n_nodes: int,
) -> csr_array:
    """Rows [m, n_nodes * 7] of the rotation about the normal of crosses that reach so far [m] around places of a plate.

    centers [m, 2] : in its coordinates [m]. size, axes : of the plate. motion : nodes [p, k] and rows [p, 6, k, 7] of
    places of it. The ends of a cross, as far as they lie on the plate, and its middle move as the plate does; the
    rotation is that of the rigid motion that fits them best. By virtual work a torque on it is forces at the ends.

    Raises InputError, of `where`, for a cross of which no end lies on the plate.
    """
    arms = reach * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    places = (centers[:, None] + arms).reshape(-1, 2)
    inside = ((places >= 0.0) & (places <= size)).all(axis=1)
    owner = np.repeat(np.arange(len(centers)), len(arms))[inside]
    places = places[inside]
    count = np.bincount(owner, minlength=len(centers))[:, None]
    middle = np.zeros((len(centers), 2))
    np.add.at(middle, owner, places)
    off = places - (middle / count)[owner]
    square = np.bincount(owner, weights=(off**2).sum(axis=1), minlength=len(centers))
    if not square.all():
        got = (
            f"a joint with a bar whose section reaches {reach:.3g} m, beyond {size[0]:g} m x {size[1]:g} m on all sides"
        )
        raise InputError(where, got=got, expected="a section that lies on it", do="correct the section of the bar")
    pulls = (off[:, :1] * axes[1] - off[:, 1:] * axes[0]) / square[owner, None]
    nodes, rows = motion(places)
    each = sparse_rows(nodes, np.einsum("pi,pikc->pkc", pulls, rows[:, :3])[:, None], n_nodes)
    gathered = csr_array((np.ones(len(owner)), (owner, np.arange(len(owner)))), shape=(len(centers), len(owner)))
    return csr_array(gathered @ each)


def _rectangle(x: Floats, y: Floats, center: Floats, reach: Floats) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] and shares [p] of a rectangle, piece by piece of the cells it covers."""
    across, along = (
        _pieces(lines, at - half, at + half, ORDER) for lines, at, half in zip((x, y), center, reach, strict=True)
    )
    places = np.stack(np.meshgrid(across[0], along[0], indexing="ij"), axis=-1).reshape(-1, 2)
    shares = np.outer(across[1], along[1]).ravel()
    return places, shares / shares.sum()


def _disc(x: Floats, y: Floats, center: Floats, radius: float) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] and shares [p] of a disc: chords at x = r sin(angle), cut where grid lines cross the rim."""
    columns = (x - center[0]) / radius
    rows = (y - center[1]) / radius
    crossings = np.arccos(np.abs(rows[np.abs(rows) < 1.0]))
    cuts = np.concatenate((np.arcsin(columns[np.abs(columns) < 1.0]), crossings, -crossings))
    angles, widths = _pieces(cuts, -0.5 * np.pi, 0.5 * np.pi, ORDER_ROUND)
    places, shares = [], []
    for angle, width in zip(angles, widths, strict=True):
        half = radius * np.cos(angle)
        along, lengths = _pieces(y, center[1] - half, center[1] + half, ORDER)
        places.append(np.stack([np.full_like(along, center[0] + radius * np.sin(angle)), along], axis=1))
        shares.append(width * half * lengths)  # dx = r cos(angle) d(angle)
    weights = np.concatenate(shares)
    return np.concatenate(places), weights / weights.sum()


def _pieces(lines: Floats, low: float, high: float, order: int) -> tuple[Floats, Floats]:
    """Gauss points and weights on low to high, in pieces between the lines."""
    ends = np.concatenate(([low], np.sort(lines[(lines > low) & (lines < high)]), [high]))
    steps = np.diff(ends)
    points, weights = gauss_interval(order)
    return (ends[:-1, None] + steps[:, None] * points).ravel(), (steps[:, None] * weights).ravel()
