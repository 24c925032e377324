"""Patches of a plate: a point that stands for the mean over a small disc or rectangle around it."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.elements.quadrature import gauss_interval
from femstruct.errors import InputError
from femstruct.model.interpolation import plate_rows
from femstruct.model.model import PlateMesh
from femstruct.model.parts import Pair

ORDER = 3  # Gauss points across each piece of a cell: its deflection is cubic
ORDER_ROUND = 12  # along the arc, where the length of a chord is a cosine


def patch_rows(
    where: str, plate: PlateMesh, center: Floats, patch: float | Pair, tolerance: float
) -> tuple[Integers, Integers, Floats]:
    """Nodes [m], components [m] and weights [6, m] of the mean motion of a patch, global axes.

    center [2] : in the plate's coordinates [m]. patch : radius of a disc, or the sides of a rectangle along them [m].

    By virtual work a force on this mean is spread evenly over the patch: it keeps the force and its moment about any
    point. Rotations are means as well.

    Raises InputError for a patch that reaches beyond its plate.
    """
    reach = np.array([patch, patch] if isinstance(patch, float) else patch) * (1.0 if isinstance(patch, float) else 0.5)
    beyond = float(max((reach - center).max(), (center + reach - plate.part.size).max()))
    if beyond > tolerance:
        raise InputError(
            f"{where}.patch",
            got=f"a patch that reaches {beyond:.4g} m beyond {plate.part.name}",
            expected=f"a patch inside {plate.part.size[0]:g} m x {plate.part.size[1]:g} m",
            do="make it smaller, or move the point",
        )
    places, shares = _disc(plate, center, patch) if isinstance(patch, float) else _rectangle(plate, center, reach)
    nodes, rows = plate_rows(plate, np.clip(places, 0.0, plate.part.size))
    used, owner = np.unique(nodes, return_inverse=True)
    weights = np.zeros((len(used), 6, N_COMPONENTS))
    by_node = np.moveaxis(rows, 2, 1) * shares[:, None, None, None]
    np.add.at(weights, owner.reshape(nodes.shape), by_node)
    flat = np.moveaxis(weights, 1, 0).reshape(6, -1)
    matter = np.flatnonzero((flat != 0.0).any(axis=0))
    return used[matter // N_COMPONENTS], matter % N_COMPONENTS, flat[:, matter]


def _rectangle(plate: PlateMesh, center: Floats, reach: Floats) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] and shares [p] of a rectangle, piece by piece of the cells it covers."""
    across, along = (
        _pieces(lines, at - half, at + half, ORDER)
        for lines, at, half in zip((plate.x, plate.y), center, reach, strict=True)
    )
    places = np.stack(np.meshgrid(across[0], along[0], indexing="ij"), axis=-1).reshape(-1, 2)
    shares = np.outer(across[1], along[1]).ravel()
    return places, shares / shares.sum()


def _disc(plate: PlateMesh, center: Floats, radius: float) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] and shares [p] of a disc: chords at x = r sin(angle), cut where grid lines cross the rim."""
    columns = (plate.x - center[0]) / radius
    rows = (plate.y - center[1]) / radius
    crossings = np.arccos(np.abs(rows[np.abs(rows) < 1.0]))
    cuts = np.concatenate((np.arcsin(columns[np.abs(columns) < 1.0]), crossings, -crossings))
    angles, widths = _pieces(cuts, -0.5 * np.pi, 0.5 * np.pi, ORDER_ROUND)
    places, shares = [], []
    for angle, width in zip(angles, widths, strict=True):
        half = radius * np.cos(angle)
        along, lengths = _pieces(plate.y, center[1] - half, center[1] + half, ORDER)
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
