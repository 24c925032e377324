"""The air and the wool of a cavity as a mechanical system joined to its two surfaces, passive by its form.

Coordinates: q of the surfaces, the amplitudes y of the modes kept, and where wool fills a part of the depth the
displacement w of the face between wool and air, by cosines. Two layers are two boxes with that face between them: air
slides along it, as it does. Mass, compression and drag are sums over the layers (`layer_fields`).

Motions of the face that displace no volume have no stiffness. They are written so that the modes follow them without
compression, and have no part in the stiffness at all (`loose`).

Wool adds, per field a of unit mass (y, and what the boundaries move of the modes left out):
- held: a dashpot sigma / rho on a' to the ground. Modes left out drag as well as weigh.
- limp: the same dashpot between a' and the velocity of a frame of mass rho_1 / rho.
- compression: isothermal, with the rest of the adiabatic stiffness, 1 - 1 / gamma, as a spring in series with a
  dashpot. A mass on the joint of the two, so small that it resonates at `STILL_HZ`, makes it a coordinate
  like all others.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.linalg import block_diag

from acoustics.arrays import Floats, Integers
from acoustics.cavities.cavity import Cavity, Layer
from acoustics.cavities.equivalent_fluid import GAMMA
from acoustics.cavities.layer_fields import LayerFields, layer_fields, multiplicity
from acoustics.rooms.box import Box
from acoustics.rooms.box_transfer import overlaps
from acoustics.rooms.cosine_orders import resolved_orders
from acoustics.source import SurfaceShapes

MOST: Final = 400  # modes of a cavity kept where nobody says how many
FINEST: Final = 64  # cosines in one direction at most
STILL_HZ: Final = 30e3  # of the thermal coordinates: they miss 2e-4 of the modulus at 1 kHz, 3e-6 at 100 Hz
LIGHT: Final = 1e-6  # of a unit modal mass: frames that weigh less are left out


@dataclass(frozen=True, eq=False)
class CavityAir:
    """The air of a cavity over [q; inner; loose], N in all, and more coordinates that only drag moves.

    frequency_hz [n] : of the modes kept. compression [r, N] : the potential energy is |compression x|^2 / 2. mass
    [N, N] : of the air. face : how many of the first inner coordinates are the mean motion of a face between wool and
    air. loose : how many of the last coordinates have no stiffness. viscous [N + e, N + e] : damping.
    frames : how many of the e are frames of limp wool, at 0 Hz; the others are thermal, at STILL_HZ. complete_below_hz
    : no mode is left out below it.
    """

    frequency_hz: Floats
    compression: Floats
    mass: Floats
    face: int
    loose: int
    viscous: Floats
    frames: int
    complete_below_hz: float


def cavity_air(cavity: Cavity, first: SurfaceShapes, second: SurfaceShapes, up_to_hz: float) -> CavityAir:
    """The air of a cavity joined to the shapes of its surfaces, modes up to a frequency as coordinates.

    first, second : at z = depth and z = 0, points in the cavity's own x and y; displacements into the cavity [p, k] in
    the same k coordinates.

    Two pistons of 1 kg/m^2 over air 0.2 m deep, against each other: the spring rho c^2 / d (1 / m_1 + 1 / m_2)

    >>> cavity = Cavity([1.0, 1.0, 0.2])
    >>> one, other = (SurfaceShapes([[0.5, 0.5, 0]], [1.0], [row]) for row in ([1.0, 0.0], [0.0, 1.0]))
    >>> air = cavity_air(cavity, one, other, up_to_hz=100.0)
    >>> round(float((air.compression.T @ air.compression).sum()) / (4 * cavity.air.bulk_modulus / 0.2), 9)
    1.0
    """
    flat, finest, complete = _flat(cavity, (first, second), up_to_hz)
    layers = cavity.layers
    k, face = first.shapes.shape[1], flat if len(layers) == 2 else flat[:0]
    found = [_fields(cavity, layers, i, (first, second), face, flat, up_to_hz, finest) for i in range(len(layers))]
    n_boundary = k + len(face)
    counts = [len(one.frequency_hz) for one in found]
    starts = n_boundary + np.concatenate([[0], np.cumsum(counts)]).astype(int)
    total = int(starts[-1])
    rest = np.concatenate([one.remainder for one in found])
    mass = block_diag(rest.T @ rest, np.eye(total - n_boundary))
    rows, fields = [], []
    for layer, one, at in zip(layers, found, starts.tolist(), strict=False):
        rows.append(_compressed(layer, one, at, total))
        fields.append(_unit_fields(one, at, total) if layer.wool is not None else np.zeros((0, total)))
    turn = _arranged(rows, k, len(face), total)
    loose = max(len(face) - 1, 0)
    rows, fields = [row @ turn for row in rows], [field @ turn for field in fields]
    for row in rows:  # by construction; what is left is rounding
        row[:, total - loose :] = 0.0
        row[1:, : k + min(len(face), 1)] = 0.0
    viscous, frames = _losses(layers, rows, fields, total)
    relaxed = [row / np.sqrt(GAMMA) if layer.rate > 0 else row for layer, row in zip(layers, rows, strict=True)]
    return CavityAir(
        frequency_hz=np.sort(np.concatenate([one.frequency_hz for one in found])),
        compression=np.concatenate(relaxed),
        mass=turn.T @ mass @ turn,
        face=min(len(face), 1),
        loose=loose,
        viscous=viscous,
        frames=frames,
        complete_below_hz=complete,
    )


def _flat(cavity: Cavity, surfaces: tuple[SurfaceShapes, ...], up_to_hz: float) -> tuple[Integers, Integers, float]:
    """Cosines [m, 2] with modes up to a frequency, the highest that both surfaces resolve [2], and where modes end."""
    box = Box(cavity.size, cavity.air)
    finest = np.min([resolved_orders(box, one.points) for one in surfaces], axis=0).clip(0, FINEST)
    slowest = min(layer.box.air.c for layer in cavity.layers)
    counts = (2 * up_to_hz * cavity.size[:2] / slowest).astype(int) + 1
    orders = np.stack(np.meshgrid(*map(np.arange, counts + 1), indexing="ij"), axis=-1).reshape(-1, 2).astype(np.int64)
    hz = slowest / 2 * np.sqrt(((orders / cavity.size[:2]) ** 2).sum(axis=1))
    beyond = (orders > finest).any(axis=1)
    complete = float(hz[beyond].min(initial=up_to_hz))
    kept = orders[(hz <= up_to_hz) & ~beyond]
    return kept[np.argsort(hz[(hz <= up_to_hz) & ~beyond], kind="stable")], finest, complete


def _fields(
    cavity: Cavity,
    layers: tuple[Layer, ...],
    number: int,
    surfaces: tuple[SurfaceShapes, SurfaceShapes],
    face: Integers,
    flat: Integers,
    up_to_hz: float,
    finest: Integers,
) -> LayerFields:
    """The fields of one layer over [q; w]."""
    first, second = surfaces
    k = first.shapes.shape[1]
    box = Box(cavity.size, cavity.air)
    # w of unit size moves about a unit mass
    scale = np.sqrt(box.ceiling_area / (cavity.air.rho * float(cavity.size[2]) * multiplicity(face)))

    def outer(surface: SurfaceShapes, orders: Integers) -> Floats:
        weighted = surface.weights[:, None] * surface.shapes
        return np.hstack([overlaps(box, orders, surface.points, weighted), np.zeros((len(orders), len(face)))])

    def between(orders: Integers, sign: float) -> Floats:
        same = (orders[:, None] == face).all(axis=2)
        return np.hstack([np.zeros((len(orders), k)), sign * scale * same])

    def boundaries(orders: Integers) -> tuple[Floats, Floats]:
        lower = outer(second, orders) if number == 0 else between(orders, 1.0)
        upper = outer(first, orders) if number == len(layers) - 1 else between(orders, -1.0)
        return lower, upper

    return layer_fields(layers[number].box, flat, up_to_hz, boundaries, finest)


def _compressed(layer: Layer, one: LayerFields, at: int, total: int) -> Floats:
    """Rows b of a layer over all coordinates: its adiabatic energy is |b x|^2 / 2."""
    rows = np.zeros((len(one.displaced), total))
    rows[:, : one.displaced.shape[1]] = np.sqrt(layer.box.air.bulk_modulus / layer.box.volume) * one.displaced
    rows[1:, at : at + len(one.frequency_hz)] = -np.diag(2 * np.pi * one.frequency_hz)
    return rows


def _unit_fields(one: LayerFields, at: int, total: int) -> Floats:
    """Rows a of a layer over all coordinates: its kinetic energy is |a x'|^2 / 2, of modes kept and left out."""
    n = len(one.frequency_hz)
    fields = np.zeros((n + len(one.remainder), total))
    fields[:n, at : at + n] = np.eye(n)
    fields[n:, : one.remainder.shape[1]] = one.remainder
    return fields


def _arranged(rows: list[Floats], k: int, n_face: int, total: int) -> Floats:
    """The coordinates in terms of [q; uniform motion of the face; modes; other motions of the face], modes being
    counted from where they follow the boundaries without compression."""
    turn = np.eye(total)
    first = k + n_face
    for row in rows:
        modes = row[1:, first:]
        own = np.flatnonzero(modes.any(axis=0))
        turn[first + own, :first] = row[1:, :first] / -np.diag(modes[:, own])[:, None]
    order = np.concatenate([np.arange(min(k + 1, first)), np.arange(first, total), np.arange(k + 1, first)])
    return turn[:, order.astype(int)]


def _losses(layers: tuple[Layer, ...], rows: list[Floats], fields: list[Floats], total: int) -> tuple[Floats, int]:
    """Damping [N + e, N + e] of drag and heat, and how many of the e are frames."""
    dashpots: list[tuple[Floats, Floats]] = []  # rows over the coordinates, and what is added over their own
    held = np.zeros((total, total))
    frames, thermal = [], []
    for layer, row, field in zip(layers, rows, fields, strict=True):
        if layer.wool is None:
            continue
        rho = layer.box.air.rho
        drag, bulk = layer.wool.flow_resistivity / rho, layer.wool.density / rho
        if layer.wool.frame == "held":
            held += drag * field.T @ field
        else:
            heavy = (field**2).sum(axis=1) * bulk > LIGHT
            frames.append((np.sqrt(drag) * field[heavy], np.sqrt(drag / bulk)))
        if layer.rate > 0:
            moved = row[row.any(axis=1)]
            share = 1.0 - 1.0 / GAMMA
            still = 2 * np.pi * STILL_HZ
            thermal.append((np.sqrt(share / (GAMMA * layer.rate)) * moved, still / np.sqrt(GAMMA * layer.rate)))
    dashpots = [*frames, *thermal]
    sizes = [len(row) for row, _ in dashpots]
    added = sum(sizes)
    viscous = np.zeros((total + added, total + added))
    viscous[:total, :total] = held
    at = total
    for (row, own), size in zip(dashpots, sizes, strict=True):
        both = np.hstack([row, np.zeros((size, added))])
        both[np.arange(size), at + np.arange(size)] = -own
        viscous += both.T @ both
        at += size
    return viscous, sum(len(row) for row, _ in frames)
