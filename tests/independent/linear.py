"""Linear structures by their matrices: modes, losses, rest, and what shakes them, for any formulation that makes some.

Coordinates are free of supports. H is the lossy part of the stiffness, C that of dashpots. Answers are of full matrices
at every frequency: no modal sum, but for a damping ratio, which is one of modes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.linalg import eig, eigh

Floats = np.ndarray
Way = tuple[str, str]  # a place and a direction
GRAVITY = 9.80665


@dataclass(frozen=True)
class Law:
    """Damping of the whole: ratio of every mode, loss factor of the stiffness, alpha M + beta K; own : H counts."""

    ratio: float = 0.0
    loss: float = 0.0
    alpha: float = 0.0
    beta: float = 0.0
    own: bool = False


@dataclass(frozen=True)
class Linear:
    """K, M, C, H [n, n]; rows : of motions [n], by place and direction; rides : M times a ride along x, y, z [3, n];
    varying : of frequencies [Hz], by what H is to be multiplied there."""

    K: Floats
    M: Floats
    C: Floats
    H: Floats
    rows: Mapping[Way, Floats]
    rides: Floats
    varying: Callable[[Floats], Floats] = np.ones_like

    def modes(self, count: int | None = None) -> tuple[Floats, Floats]:
        """Natural frequencies [Hz] above rest, and shapes of unit modal mass [n, modes]."""
        size = float(np.trace(self.K) / np.trace(self.M)) * 1e-9
        values, shapes = eigh(self.M, self.K + size * self.M)
        kept = values > 1e-14 * values[-1]
        values, shapes = values[kept][::-1], shapes[:, kept][:, ::-1]
        squares = 1 / values - size
        moving = squares > 1e-3 * size
        return (np.sqrt(squares[moving]) / 2 / pi)[:count], (shapes / np.sqrt(values))[:, moving][:, :count]

    def losses(self, count: int) -> Floats:
        """Loss factors of modes: what H takes of their energy of strain."""
        own, shapes = self.modes(count)
        lost, whole = (np.einsum("nk,nm,mk->k", shapes, one, shapes) for one in (self.H, self.K))
        return np.asarray(self.varying(own) * lost / whole)

    def _alike(self) -> float | None:
        """What H is of K, if it is the same everywhere."""
        share = float(np.trace(self.H) / np.trace(self.K))
        return share if np.abs(self.H - share * self.K).max() <= 1e-12 * np.abs(self.K).max() else None

    def load(self, forces: Mapping[Way, float], weight: bool = False) -> Floats:
        found = -GRAVITY * self.rides[2] * weight
        for way, size in forces.items():
            found = found + size * self.rows[way]
        return np.asarray(found)

    def rest(self, load: Floats) -> Floats:
        return np.linalg.solve(self.K, load)

    def shaken(self, frequency: Floats, load: Floats, law: Law) -> Floats:
        """Complex coordinates [frequency, n] under a load e^{jwt}."""
        lines, lossy = np.asarray(frequency, float), self._alike() if law.own else 0.0
        if not self.C.any() and lossy is not None:
            own, shapes = self.modes()
            if len(own) == len(self.K):  # modes are all there is, and are not coupled
                w0, w, loss = 2 * pi * own, 2 * pi * lines[:, None], law.loss + lossy * self.varying(lines)[:, None]
                rates = 2 * law.ratio * w0 + law.alpha + law.beta * w0**2
                return np.asarray((shapes.T @ load) / (w0**2 * (1 + 1j * loss) - w**2 + 1j * w * rates) @ shapes.T)
        C, H = self.C + law.alpha * self.M + law.beta * self.K, law.own * self.H
        if law.ratio:
            own, shapes = self.modes()
            lean = self.M @ shapes
            C = C + (lean * (4 * pi * law.ratio * own)) @ lean.T
        return np.array([
            np.linalg.solve(self.K * (1 + 1j * law.loss) + 1j * more * H + 1j * w * C - w**2 * self.M, load)
            for w, more in zip(2 * pi * lines, self.varying(lines), strict=True)
        ])  # fmt: skip

    def poles(self, count: int, law: Law) -> Floats:
        """Complex eigenvalues with dashpots, above the real axis, by size; all motions must have mass."""
        C, none = self.C + law.alpha * self.M + law.beta * self.K, np.zeros_like(self.K)
        unit = np.eye(len(self.K))
        values = eig(np.block([[none, unit], [-self.K, -C]]), np.block([[unit, none], [none, self.M]]))[0]
        upper = values[np.isfinite(values) & (values.imag > 0)]
        return np.asarray(upper[np.argsort(abs(upper))][:count])
