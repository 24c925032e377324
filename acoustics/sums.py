"""What is heard at many places, kept as few histories of cosines until the end: one product of matrices a height."""

from __future__ import annotations

import numpy as np

from acoustics.arrays import Floats
from acoustics.orders import SEEN


class Sums:
    """Pressure at places, as it grows cosine by cosine.

    Where cosines are fewer than listeners at a height, their histories are kept and mixed only once, at the end: a
    thousand histories are too much to be added up again and again.
    """

    def __init__(self, places: Floats, nt: int) -> None:
        self.places, self.nt = places, nt
        self.heights, plane = np.unique(places[:, 2], return_inverse=True)
        self.rows = [np.flatnonzero(plane == height) for height in range(len(self.heights))]
        self._mixes: list[list[Floats]] = [[] for _ in self.rows]
        self._histories: list[list[Floats]] = [[] for _ in self.rows]
        self._plain: list[Floats | None] = [None] * len(self.rows)

    def add(self, height: int, mix: Floats | None, history: Floats) -> None:
        """Add histories [n, nt] of cosines, mixed by mix [n_here, n]; of the listeners themselves where it is None."""
        before = self._plain[height]
        if mix is None:
            self._plain[height] = history if before is None else before + history
        else:
            self._mixes[height].append(mix)
            self._histories[height].append(history)

    def energies(self) -> Floats:
        """Energy at every place [n], sums of squares."""
        energy = np.zeros(len(self.places))
        for height, rows in enumerate(self.rows):
            plain = self._plain[height]
            if plain is None and self._mixes[height]:
                energy[rows] = energy_of(np.hstack(self._mixes[height]), np.vstack(self._histories[height]))
            elif plain is not None:
                whole = self._whole(height)
                energy[rows] = energy_of(None, whole)
        return energy

    def pressure(self) -> Floats:
        """Pressure at every place [n, nt], read-only."""
        wholes = [self._whole(height) for height in range(len(self.rows))]
        p = wholes[0]
        if len(wholes) > 1:
            p = np.empty((len(self.places), self.nt))
            for rows, whole in zip(self.rows, wholes, strict=True):
                p[rows] = whole
        p.flags.writeable = False
        return p

    def _whole(self, height: int) -> Floats:
        plain = self._plain[height]
        if not self._mixes[height]:
            return np.zeros((len(self.rows[height]), self.nt)) if plain is None else plain
        mixed: Floats = np.hstack(self._mixes[height]) @ np.vstack(self._histories[height])
        if plain is not None:
            mixed += plain
        return mixed


def energy_of(mix: Floats | None, history: Floats) -> Floats:
    """Sums of squares [n_here] of mix @ history, by the products of the histories; of histories where mix is None.

    From some 16,000 samples at least, which tell well enough.
    """
    every = max(1, history.shape[1] // SEEN)
    history = history[:, ::every]
    if mix is None:
        return np.asarray(every * np.einsum("rt,rt->r", history, history))
    mix = mix * np.sqrt(every)
    energy: Floats = np.einsum("rn,rn->r", mix @ (history @ history.T), mix)
    return energy.clip(0.0)
