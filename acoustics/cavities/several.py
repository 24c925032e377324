"""Several cavities beside the surfaces of one structure as one: they share its coordinates and nothing else."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acoustics.arrays import Floats
from acoustics.cavities.cavity_air import CavityAir


def together(airs: Sequence[CavityAir], k: int) -> CavityAir:
    """The air of several cavities over the k coordinates of the structure and all of their own.

    >>> from acoustics.cavities.cavity import Cavity
    >>> from acoustics.cavities.cavity_air import cavity_air
    >>> from acoustics.source import SurfaceShapes
    >>> still, moves = (SurfaceShapes([[0.5, 0.5, 0]], [1.0], [[x]]) for x in (0.0, 1.0))
    >>> one = cavity_air(Cavity([1.0, 1.0, 0.2]), moves, still, up_to_hz=200.0)
    >>> both = together([one, one], 1)
    >>> bool((both.compression**2).sum() == 2 * (one.compression**2).sum()), float(both.mass[0, 0] / one.mass[0, 0])
    (True, 2.0)
    """
    thermal = [len(air.viscous) - len(air.mass) - air.frames for air in airs]
    modes = [len(air.mass) - k - air.face - air.loose for air in airs]
    sizes = np.array([[air.face for air in airs], modes, [air.loose for air in airs]])
    sizes = np.concatenate([sizes, [[air.frames for air in airs], thermal]])
    starts = k + np.concatenate([[0], np.cumsum(sizes.ravel())])[:-1].reshape(sizes.shape)
    total = k + int(sizes.sum())
    moving = k + int(sizes[:3].sum())
    mass, viscous = np.zeros((moving, moving)), np.zeros((total, total))
    rows: list[Floats] = []
    for air, start, size in zip(airs, starts.T, sizes.T, strict=True):
        at = np.concatenate([np.arange(k), *(np.arange(a, a + n) for a, n in zip(start, size, strict=True))])
        at = at.astype(np.int64)
        own = at[: len(air.mass)]
        mass[np.ix_(own, own)] += air.mass
        viscous[np.ix_(at, at)] += air.viscous
        row = np.zeros((len(air.compression), moving))
        row[:, own] = air.compression
        rows.append(row)
    return CavityAir(
        frequency_hz=np.sort(np.concatenate([air.frequency_hz for air in airs])),
        compression=np.concatenate(rows),
        mass=mass,
        face=int(sizes[0].sum()),
        loose=int(sizes[2].sum()),
        viscous=viscous,
        frames=int(sizes[3].sum()),
        complete_below_hz=min(air.complete_below_hz for air in airs),
    )
