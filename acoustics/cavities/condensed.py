"""Fewer coordinates for the air of a cavity: those that its surfaces move in a band, by how much they react on them.

The surfaces are moved harmonically in each of their coordinates, and what follows is kept in its principal directions:
modes of the air, layers that slide, frames and thermal coordinates each for themselves. Mass, stiffness and damping are
projected on them from both sides, so that they stay symmetric and passive, and what is left out of the reaction is the
square of what is left out of the motion.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from acoustics.arrays import Complexes, Floats, Integers
from acoustics.cavities.cavity_air import STILL_HZ, CavityAir

ALLOWED: Final = 0.02
"""Motion left out, as the root of its energy over that of a unit modal mass: costs 0.03 dB of the motion, or less."""
LINES: Final = 10  # frequencies at which the surfaces are moved
DECADES: Final = 1.7  # the lowest of them is the band's end over 50
_APART: Final = 1e-13  # of what two coordinates have of their own: rounding


def condensed(air: CavityAir, omega: Floats, top_hz: float, allowed: float = ALLOWED) -> CavityAir:
    """The same air with fewer coordinates of its own, for motions up to a frequency.

    omega [k] : circular frequencies of the coordinates of the surfaces: below its own, one reacts as a stiffness, and
    less is needed of what it moves.

    Two pistons with limp wool between them keep the frame that goes with both, and little else:

    >>> from acoustics.cavities.cavity import Cavity
    >>> from acoustics.cavities.cavity_air import cavity_air
    >>> from acoustics.cavities.equivalent_fluid import Wool
    >>> from acoustics.source import SurfaceShapes
    >>> one, other = (SurfaceShapes([[0.5, 0.5, 0]], [1.0], [row]) for row in ([0.1, 0.0], [0.0, 0.2]))
    >>> whole = cavity_air(Cavity([1.0, 1.0, 0.2], wool=Wool(10e3)), one, other, up_to_hz=3000.0)
    >>> few = condensed(whole, np.zeros(2), top_hz=100.0)
    >>> len(whole.viscous), len(few.viscous)
    (14, 8)
    """
    n, k = len(air.mass), len(omega)
    total = len(air.viscous)
    bound = k + air.face
    groups = [
        np.arange(bound, n - air.loose),
        np.arange(n - air.loose, n),
        np.arange(n, n + air.frames),
        np.arange(n + air.frames, total),
    ]
    mass, stiffness = _whole(air)
    own = np.diag(mass).copy()
    own[:bound] = 1.0
    scale = 1.0 / np.sqrt(own)
    mass, stiffness, damping = (scale[:, None] * one * scale for one in (mass, stiffness, air.viscous))
    lines = 2 * np.pi * top_hz * 10.0 ** -np.linspace(0.0, DECADES, LINES)
    middle = float(np.sqrt(lines[0] * lines[-1]))
    weigh = np.sqrt(1.0 + np.diag(damping) / middle + np.diag(stiffness) / middle**2)
    energy = [np.zeros((len(group), len(group))) for group in groups]
    blocks = _blocks(mass, stiffness, damping, bound)
    for w in lines.tolist():
        moved = _followed(mass, stiffness, damping, blocks, bound, w)
        moved[:, :k] *= np.minimum(1.0, np.divide(w, omega, out=np.ones(k), where=omega > w))
        moved *= weigh[:, None] * np.sqrt(middle / w)
        for gathered, group in zip(energy, groups, strict=True):
            part = moved[group]
            gathered += part.real @ part.real.T + part.imag @ part.imag.T
    kept = [_directions(gathered, weigh[group], allowed) for gathered, group in zip(energy, groups, strict=True)]
    turn = scale[:, None] * block_diag(np.eye(bound), *kept)
    turn[:bound, :bound] = np.eye(bound)
    moving = bound + kept[0].shape[1] + kept[1].shape[1]
    within = turn[:n, :moving]
    return replace(
        air,
        compression=air.compression @ within,
        mass=within.T @ air.mass @ within,
        loose=kept[1].shape[1],
        viscous=turn.T @ air.viscous @ turn,
        frames=kept[2].shape[1],
    )


def _whole(air: CavityAir) -> tuple[Floats, Floats]:
    """Mass and stiffness of all coordinates of the air."""
    added = len(air.viscous) - len(air.mass)
    still = np.concatenate([np.zeros(air.frames), np.full(added - air.frames, (2 * np.pi * STILL_HZ) ** 2)])
    return block_diag(air.mass, np.eye(added)), block_diag(air.compression.T @ air.compression, np.diag(still))


def _blocks(mass: Floats, stiffness: Floats, damping: Floats, bound: int) -> list[Integers]:
    """Coordinates of the air that do not act on each other [blocks, m], blocks of one size together."""
    joined = np.zeros_like(mass[bound:, bound:], dtype=bool)
    for matrix in (mass, stiffness, damping):
        part = matrix[bound:, bound:]
        root = np.sqrt(np.abs(np.diag(part)))
        joined |= np.abs(part) > _APART * np.outer(root, root)
    _, label = connected_components(csr_array(joined), directed=False)
    order = np.argsort(label, kind="stable")
    sizes = np.bincount(label, minlength=int(label.max(initial=-1)) + 1)
    found = []
    for size in np.unique(sizes):
        some = order[np.isin(label[order], np.flatnonzero(sizes == size))]
        found.append((bound + some.reshape(-1, int(size))).astype(np.int64))
    return found


def _followed(
    mass: Floats, stiffness: Floats, damping: Floats, blocks: list[Integers], bound: int, w: float
) -> Complexes:
    """Motion [all, bound] of the coordinates of the air when the others are moved by one each."""
    moved = np.zeros((len(mass), bound), dtype=np.complex128)
    for at in blocks:
        inside = np.ix_(at.ravel(), np.arange(bound))
        push = (w**2 * mass[inside] - 1j * w * damping[inside] - stiffness[inside]).reshape(*at.shape, bound)
        rows, columns = at[:, :, None], at[:, None, :]
        dynamic = stiffness[rows, columns] + 1j * w * damping[rows, columns] - w**2 * mass[rows, columns]
        moved[at] = np.linalg.solve(dynamic, push)
    return moved


def _directions(energy: Floats, weigh: Floats, allowed: float) -> Floats:
    """Orthonormal directions [n, m] in which coordinates move by more than what may be left out."""
    if not len(energy):
        return np.zeros((0, 0))
    squared, along = np.linalg.eigh(energy)
    needed = along[:, squared > allowed**2] / weigh[:, None]
    return np.linalg.qr(needed[:, ::-1])[0] if needed.size else needed
