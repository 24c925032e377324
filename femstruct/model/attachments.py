"""What is fastened to plates, bars and blocks, as rows on nodal components: foundations, springs, masses."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.conventions import DIRECTIONS
from femstruct.elements.quadrature import gauss_interval
from femstruct.errors import InputError
from femstruct.model.anchors import ORDER, layer_points, motion_at, places_of, plate_of, point_rows, region_points
from femstruct.model.interpolation import frame_rows, plate_rows, sparse_rows
from femstruct.model.layers import layer_of
from femstruct.model.model import Elastic, Inert, Model
from femstruct.model.parts import Block, Foundation, Mass, Plate, Region, Spring

_SIX = len(DIRECTIONS)


def foundation(part: Foundation, model: Model, tolerance: float) -> Elastic:
    """A Winkler foundation at Gauss points: along its normal, and along both directions in its plane in shear.

    Between two parts it resists the motion of the first less that of the second, both carried to the middle of the gap.
    """
    where = f"parts.{part.name}"
    if not (part.normal >= 0 and part.shear >= 0 and part.normal + part.shear > 0):
        raise InputError(
            f"{where}.stiffness", got=f"{part.normal:g}, {part.shear:g}", expected="values >= 0, one above"
        )
    solids = {part.name: part for part in model.structure.parts if isinstance(part, Plate | Block)}
    layer = layer_of(part, solids, tolerance)
    ends = (part.on,) if part.to is None else (part.on, part.to)
    local, weights = layer_points(layer, part.region, ends, model, tolerance)
    values = np.array([part.shear, part.shear, part.normal])
    kept = values > 0
    motions = [motion_at(name, layer.places(local), layer.axes[kept], model, tolerance) for name in ends]
    stiffness = (weights[:, None] * values[kept]).ravel()
    return Elastic(
        part.name,
        motions[0] if part.to is None else csr_array(motions[0] - motions[1]),
        stiffness,
        np.zeros(stiffness.size),
        np.tile(layer.axes[kept], (len(local), 1)),
        grounded=part.to is None,
        loss_factor=part.loss_factor,
        places=np.zeros((0, 3)) if set(ends) & set(model.plates) else layer.places(local),
    )


def springs(part: Spring, model: Model) -> Elastic:
    """Springs between places, one for each pair, or one for each place to the ground.

    Two places apart from each other act in the middle between them, each through a rigid arm of its own rotation, so
    that a rigid motion of both strains nothing.
    """
    where = f"parts.{part.name}"
    values = np.array([part.stiffness, part.damping], dtype=np.float64)
    if not (np.isfinite(values) & (values >= 0)).all() or not values.any():
        raise InputError(
            where, got="stiffness and damping without one positive value", expected="values >= 0, one above"
        )
    kept = np.flatnonzero(values.any(axis=0))
    first = places_of(f"{where}.between", part.a, model)
    positions = np.stack([point.position for point in first])
    if part.b is None:
        matrices = [point_rows(point, np.zeros(3), model)[kept] for point in first]
    else:
        second = places_of(f"{where}.between", part.b, model)
        if len(first) != len(second) and min(len(first), len(second)) != 1:
            raise InputError(
                f"{where}.between", got=f"{len(first)} and {len(second)} places", expected="as many, or one of either"
            )
        count = max(len(first), len(second))
        positions = (positions + np.stack([point.position for point in second])) / 2.0
        matrices = []
        for one, other in zip(first * (count // len(first)), second * (count // len(second)), strict=True):
            half = (other.position - one.position) / 2.0
            matrices.append((point_rows(one, half, model) - point_rows(other, -half, model))[kept])
    count = len(matrices)
    directions = np.zeros((_SIX, 3))
    directions[:3] = np.eye(3)
    return Elastic(
        part.name,
        csr_array(vstack(matrices)),
        np.tile(values[0, kept], count),
        np.tile(values[1, kept], count),
        np.tile(directions[kept], (count, 1)),
        grounded=part.b is None,
        places=positions,
    )


def lumped_mass(part: Mass, model: Model) -> Inert:
    """A particle at every place of a point; the mass is that of each."""
    where = f"parts.{part.name}"
    if part.per != "total":
        raise InputError(f"{where}.mass", got=f"a mass per {part.per} at a point", expected="a mass in kg")
    _positive_mass(part)
    points = places_of(f"{where}.at", part.at or "", model)
    rows = csr_array(vstack([point_rows(point, np.zeros(3), model)[:3] for point in points]))
    return Inert(part.name, rows, np.full(rows.shape[0], part.mass))


def spread_mass(part: Mass, model: Model, tolerance: float) -> Inert:
    """Mass over an area or along lines of a plate, or along a frame; it follows the mid-surface or the axis."""
    where = f"parts.{part.name}"
    _positive_mass(part)
    region = part.region or Region("whole")
    frame = model.frames.get(part.on or "")
    if frame is not None and region.kind != "whole":
        raise InputError(f"{where}.region", got=f"a {region.kind} of a frame", expected="all of the frame")
    spread = "area" if region.kind in ("whole", "rectangle") and frame is None else "length"
    if part.per not in ("total", spread):
        raise InputError(
            f"{where}.mass",
            got=f"a mass per {part.per} over a {region.kind if frame is None else 'frame'}",
            expected=f"kg or per {spread}",
        )
    if frame is not None:
        places, shares = gauss_interval(ORDER)
        bars = np.repeat(np.arange(len(frame.bars)), ORDER)
        weights = frame.lengths[bars] * np.tile(shares, len(frame.bars))
        nodes, rows = frame_rows(frame, bars, np.tile(places, len(frame.bars)))
    else:
        plate = plate_of(f"{where}.on", part.on or "", model)
        local, weights = region_points(f"{where}.region", plate, region, tolerance)
        nodes, rows = plate_rows(plate, local)
    mass = part.mass * weights / (weights.sum() if part.per == "total" else 1.0)
    return Inert(part.name, sparse_rows(nodes, rows[:, :3], model.mesh.n_nodes), np.repeat(mass, 3))


def _positive_mass(part: Mass) -> None:
    if not part.mass > 0:
        raise InputError(f"parts.{part.name}.mass", got=f"{part.mass:g}", expected="a positive mass")
