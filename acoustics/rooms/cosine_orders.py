"""Which cosines of the ceiling a response needs: grown from few, until more add less than a stated share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acoustics.arrays import Floats, Integers
from acoustics.errors import AcousticsError
from acoustics.losses import modal_damping_ratios
from acoustics.rooms.box import Box
from acoustics.rooms.box_transfer import horizontal_wavenumber, project
from acoustics.source import SurfaceVelocity

ENOUGH: Final = 1e-4  # share (rms, 0.001 dB) of the last orders in the pressure at which no more are added
SEEN: Final = 1 << 14  # samples of the record that tell well enough how much a cosine moves
FIRST_ORDERS: Final = 3  # cosines l, m to begin with, all of them evaluated
FINER: Final = 0.1  # share of the most driven cosine above which one that is left out keeps the search going
GROWTH: Final = 0.15  # of a large set of orders by its next block
MOST: Final = 40  # orders beyond those of the band that the search for convergence may add


def square(n_l: int, n_m: int) -> Integers:
    """All pairs of orders below n_l and n_m [n_l n_m, 2]."""
    grid = np.stack(np.meshgrid(np.arange(n_l), np.arange(n_m), indexing="ij"), axis=-1)
    return grid.reshape(-1, 2).astype(np.int64)


def not_in(block: Integers, done: Integers) -> Integers:
    """Orders of a block that have not been done."""
    width = 1 + max(block.max(initial=0), done.max(initial=0))
    return block[~np.isin(block @ [width, 1], done @ [width, 1])]


def order_blocks(room: Box, orders: int | None, highest_hz: float) -> list[Integers]:
    """Growing sets of cosines; the last two orders, which tell the truncation, are a block of their own."""
    if orders is not None:
        if orders < 1:
            raise AcousticsError("orders", got=str(orders), expected="at least 1")
        return [square(n, n) for n in sorted({max(1, orders - 2), orders})]
    most = max(max(band_orders(room, highest_hz)) + MOST, FIRST_ORDERS + 2)
    sizes = [FIRST_ORDERS]
    while sizes[-1] + 2 <= most:
        sizes.append(min(most, sizes[-1] + max(2, int(GROWTH * sizes[-1]))))
    return [square(n, n) for n in sizes]


def band_orders(room: Box, highest_hz: float) -> tuple[int, int]:
    """Cosines that propagate below a frequency, in both directions, and three more."""
    n_l, n_m = (int(np.ceil(2 * length * highest_hz / room.air.c)) + 3 for length in room.size[:2].tolist())
    return n_l, n_m


def resolved_orders(room: Box, points: Floats) -> Integers:
    """Highest orders l, m [2] that points of the ceiling [p, 3] integrate, four of them to a wave; 0 for a lone point.

    Beyond them sums over the points see other waves than are there.
    """
    extent = np.ptp(points[:, :2], axis=0)
    many = [len(np.unique(points[:, axis].round(9))) for axis in (0, 1)]
    per_length = np.divide(many, extent, out=np.zeros(2), where=extent > 0)
    return np.asarray(0.5 * per_length * room.size[:2], dtype=np.int64)


def undriven(surfaces: Sequence[SurfaceVelocity], room: Box, done: Integers, highest_hz: float) -> bool:
    """Whether no cosine of the sources' band that is left out is driven nearly as much as those that are in.

    surfaces : motions of one surface. Blocks that add nothing end the search; a surface that moves in a pattern finer
    than the last block would end it too early.
    """
    left = not_in(square(*band_orders(room, highest_hz)), done)
    patterns = [np.abs(project(surfaces[0], room, some)) for some in (left, done)]
    return all(
        (patterns[0] @ one.sizes).max(initial=0.0) <= FINER * (patterns[1] @ one.sizes).max() for one in surfaces
    )


def audible(
    coefficients: Floats, products: Sequence[Floats], room: Box, orders: Integers, quietest: Sequence[float]
) -> NDArray[np.bool_]:
    """Which cosines `orders` [n, 2] could matter: the others, each in resonance all the time, would together stay below
    ENOUGH.

    coefficients [n, k] : of the modes in them. products : of every motion, as `moved` tells them. quietest : of each,
        the energy of what is heard so far at the quietest receiver, a sum of squares [Pa^2].

    Notes
    -----
    A resonance of cosine (l, m) makes no more than rho c^2 v / (Lz zeta omega_lm) of the velocity v; motions that only
    rounding or a mesh without symmetry excites are left out so.
    """
    k_lm = horizontal_wavenumber(room, orders)
    omega = room.air.c * np.where(k_lm > 0, k_lm, np.pi / float(room.size[:2].max()))
    ratio = modal_damping_ratios(room.losses, omega / (2 * np.pi))
    kept = np.zeros(len(orders), dtype=bool)
    for product, energy in zip(products, quietest, strict=True):
        loudest = np.sqrt(np.einsum("nk,nk->n", coefficients @ product, coefficients).clip(0.0))
        loudest *= room.air.bulk_modulus / float(room.size[2])
        bound = np.divide(loudest, ratio * omega, out=np.full_like(loudest, np.inf), where=ratio > 0)
        quiet = np.argsort(bound)
        together = np.sqrt(np.cumsum(bound[quiet] ** 2))
        kept[quiet[together >= ENOUGH * np.sqrt(energy)]] = True
    return kept


def moved(surface: SurfaceVelocity) -> Floats:
    """Summed products of the modal rates [k, k]: a motion c @ rates has the sum of squares c @ products @ c. From some
    16,000 samples at least, which tell well enough."""
    every = max(1, surface.rates.shape[1] // SEEN)
    seen = surface.rates[:, ::every]
    products: Floats = every * (seen @ seen.T)
    return products
