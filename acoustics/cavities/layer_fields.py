"""One fluid between two moving boundaries: its modes, what the boundaries displace of them, and the mass of the rest.

Both boundaries displace INTO the fluid. P_n are the modes of the box with rigid walls, L_n the integral of P_n psi over
both boundaries, P_n being (-1)^nz at the upper one. With kappa = rho c^2 / V and the amplitudes y_n of the displacement
along the gradient of P_n, of unit modal mass,

    p_n = kappa L_n q - sqrt(kappa) omega_n y_n,        as in `acoustics.rooms.box_two_way`.

The modes left out are a mass of both boundaries. Summed over nz, those of the cosine (l, m) weigh, per product of the
boundaries' integrals I, rho eps_l eps_m / S times

    g_11 = coth(k h) / k, g_12 = 1 / (k sinh(k h));        (0, 0): g_11 = h / 3, g_12 = -h / 6,

less the terms 2 (+-1) / (h k_n^2) of those that are kept. Along I_1 + I_2 and I_1 - I_2 both are diagonal: even nz take
from the one, odd nz from the other, and neither becomes negative.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np

from acoustics.arrays import Floats, Integers
from acoustics.rooms.box import Box
from acoustics.rooms.box_transfer import horizontal_wavenumber
from acoustics.rooms.cosine_orders import not_in, square

SETTLED: Final = 1e-8  # largest mass the last cosines may add to a unit modal mass
BEYOND: Final = 8  # cosines of a block beyond the last one
ROUNDING: Final = 1e-14  # of a unit modal mass

Boundaries = Callable[[Integers], tuple[Floats, Floats]]
"""Integrals of cosines [n, 2] times displacements into the fluid over the lower and the upper boundary, each [n, N]."""


class LayerFields(NamedTuple):
    """What N coordinates of the boundaries displace.

    frequency_hz [n] : of the modes kept. displaced [1 + n, N] : L of the uniform mode and of those kept. remainder
    [r, N] : fields of the modes left out, R^T R is their mass; first those of the cosines with modes, one by one.
    """

    frequency_hz: Floats
    displaced: Floats
    remainder: Floats


def multiplicity(orders: Integers) -> Floats:
    """Product over the directions of 1 for order 0 and 2 for the others [n]."""
    product: Floats = np.where(orders > 0, 2.0, 1.0).prod(axis=1)
    return product


def layer_fields(box: Box, orders: Integers, up_to_hz: float, boundaries: Boundaries, finest: Integers) -> LayerFields:
    """Modes up to a frequency of the cosines `orders` [n, 2], and the others as mass.

    finest [2] : highest cosines that the boundaries resolve.

    A piston of 1 m^2 on air 0.2 m deep, no mode kept: a third of the air's mass moves with it.

    >>> from acoustics.air import Air
    >>> box, only = Box([1, 1, 0.2], Air(343, 1.2)), np.zeros((1, 2), dtype=np.int64)
    >>> moved = lambda orders: (np.zeros((len(orders), 1)), (orders == 0).all(axis=1)[:, None] * 1.0)
    >>> rest = layer_fields(box, only, 100.0, moved, np.zeros(2, dtype=np.int64)).remainder
    >>> (rest.T @ rest).round(6).tolist()
    [[0.08]]
    """
    indices = _kept(box, orders, up_to_hz)
    flat, place = np.unique(np.concatenate([np.zeros((1, 2), np.int64), indices[:, :2]]), axis=0, return_inverse=True)
    lower, upper = (part[place.ravel()] for part in boundaries(flat))
    with_uniform = np.concatenate([np.zeros((1, 3), np.int64), indices])
    upwards = np.where(with_uniform[:, 2] % 2 == 0, 1.0, -1.0)[:, None]
    displaced = np.sqrt(multiplicity(with_uniform))[:, None] * (lower + upwards * upper)
    frequency_hz: Floats = box.air.c / 2 * np.sqrt(((indices / box.size) ** 2).sum(axis=1))
    return LayerFields(frequency_hz, displaced, _remainder(box, orders, indices, boundaries, finest))


def _kept(box: Box, orders: Integers, up_to_hz: float) -> Integers:
    """Indices [n, 3] of the modes of these cosines up to a frequency, without the uniform one."""
    most = int(2 * up_to_hz * float(box.size[2]) / box.air.c) + 1
    every = np.concatenate([np.repeat(orders, most + 1, axis=0), np.tile(np.arange(most + 1), len(orders))[:, None]], 1)
    hz = box.air.c / 2 * np.sqrt(((every / box.size) ** 2).sum(axis=1))
    kept: Integers = every[(hz > 0) & (hz <= up_to_hz)].astype(np.int64)
    return kept


def _remainder(box: Box, orders: Integers, kept: Integers, boundaries: Boundaries, finest: Integers) -> Floats:
    """Fields [r, N] of the modes that are not kept: of the cosines `orders` one by one, then of finer ones, added until
    the last ones weigh nothing, together."""
    own = _fields(box, orders, kept, boundaries)
    resolved = [int(order) + 1 for order in finest]
    size = [int(orders[:, axis].max(initial=0)) + 1 for axis in (0, 1)]
    done, mass = orders, np.zeros((own.shape[1], own.shape[1]))
    while True:
        new = not_in(square(*size), done)
        part = np.zeros_like(mass)
        if len(new):
            rows = _fields(box, new, kept[:0], boundaries)
            part = rows.T @ rows
            mass += part
        settled = len(done) > len(orders) and np.diag(part).max(initial=0.0) < SETTLED
        done = np.concatenate([done, new])
        if settled or all(have >= most for have, most in zip(size, resolved, strict=True)):
            break
        size = [max(have, min(have + BEYOND, most)) for have, most in zip(size, resolved, strict=True)]
    squared, along = np.linalg.eigh(mass)
    heavy = squared > ROUNDING * max(float(squared.max(initial=0.0)), 1.0)
    return np.concatenate([own, np.sqrt(squared[heavy])[:, None] * along[:, heavy].T])


def _fields(box: Box, orders: Integers, kept: Integers, boundaries: Boundaries) -> Floats:
    """Two fields of every cosine [2 n, N]: boundaries against each other and together."""
    lower, upper = boundaries(orders)
    factor = box.air.rho / float(box.size[0] * box.size[1]) * multiplicity(orders)
    even, odd = np.sqrt(factor * _left_out(box, orders, kept))
    fields: Floats = np.concatenate([even[:, None] * (lower + upper), odd[:, None] * (lower - upper)])
    return fields


def _left_out(box: Box, orders: Integers, kept: Integers) -> Floats:
    """(g_11 + g_12) / 2 and (g_11 - g_12) / 2 of the cosines [n, 2] less the modes kept: [2, n] [m]."""
    h = float(box.size[2])
    k = horizontal_wavenumber(box, orders)
    uniform = k == 0
    safe = np.where(uniform, 1.0, k)
    half = np.tanh(0.5 * safe * h)
    # coth x + 1 / sinh x = coth(x / 2), coth x - 1 / sinh x = tanh(x / 2)
    even = np.where(uniform, h / 12, 0.5 / (safe * half))
    odd = np.where(uniform, h / 4, 0.5 * half / safe)
    whole = np.stack([even, odd])
    number = {tuple(pair): i for i, pair in enumerate(orders.tolist())}
    at = np.array([number.get(tuple(index[:2]), -1) for index in kept.tolist()], dtype=np.int64)
    own = kept[at >= 0]
    terms = np.where(own[:, 2] > 0, 2.0, 1.0) / h
    squared = ((own / box.size) ** 2).sum(axis=1) * np.pi**2
    np.subtract.at(whole, (own[:, 2] % 2, at[at >= 0]), terms / squared)
    return whole.clip(0.0)
