"""The noun of a cavity: a flat box of air between two surfaces, with wool in all or a part of its depth."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats, freeze, frozen, positive
from acoustics.cavities.equivalent_fluid import Wool
from acoustics.errors import AcousticsError
from acoustics.rooms.box import Box

AIR_FACTOR: Final = 2.0
WOOL_FACTOR: Final = 2.0
_WHOLE: Final = 1e-9  # of the depth: wool this much thinner fills it


@dataclass(frozen=True, eq=False)
class Cavity:
    """Air between two parallel surfaces that move, its four sides rigid.

    size : lengths of the sides and the depth [3] [m]. wool : what fills it, against the second surface; thickness : of
    the wool [m], all of the depth if left out.

    Raises AcousticsError: lengths that cannot be, wool thicker than the cavity, a thickness without wool.

    >>> cavity = Cavity([4.0, 0.6, 0.2], wool=Wool(10e3), thickness=0.1)
    >>> [(float(layer.box.size[2]), layer.wool is None) for layer in cavity.layers]
    [(0.1, False), (0.1, True)]
    """

    size: Floats
    air: Air = field(default_factory=Air)
    wool: Wool | None = None
    thickness: float | None = None

    def __post_init__(self) -> None:
        size = frozen("cavity.size", self.size, (3,))
        if (size <= 0).any():
            raise AcousticsError("cavity.size", got=f"{size.tolist()} m", expected="positive lengths")
        if self.thickness is not None:
            thickness = positive("fill.thickness", self.thickness, "m")
            if self.wool is None:
                raise AcousticsError("fill.thickness", got="a thickness without wool", expected="wool")
            if thickness > size[2] * (1 + _WHOLE):
                raise AcousticsError(
                    "fill.thickness", got=f"{thickness:g} m", expected=f"at most the depth, {size[2]:g} m"
                )
        freeze(self, size=size)

    @property
    def layers(self) -> tuple[Layer, ...]:
        """From the second surface to the first."""
        depth = float(self.size[2])
        if self.wool is None:
            return (Layer(Box(self.size, self.air), None),)
        within = self.wool.pores(self.air)
        if self.thickness is None or self.thickness >= depth * (1 - _WHOLE):
            return (Layer(Box(self.size, within), self.wool, self.wool.rate(self.air)),)
        flat = self.size[:2]
        return (
            Layer(Box(np.append(flat, self.thickness), within), self.wool, self.wool.rate(self.air)),
            Layer(Box(np.append(flat, depth - self.thickness), self.air), None),
        )

    def kept_hz(self, top_hz: float) -> float:
        """Up to where modes of the air are to be coordinates of their own, for motions up to `top_hz` [Hz].

        Notes
        -----
        Modes left out follow statically. Of air without losses that leaves (f / f_n)^2 of them, and 2 of the top is
        kept. In wool a mode follows only below f_n^2 2 pi rho / sigma: WOOL_FACTOR times that is kept: 1 % at the
        top of the band, less below (4 x 3 x 0.2 m).

        >>> Cavity([4, 3, 0.2]).kept_hz(100.0), round(Cavity([4, 3, 0.2], wool=Wool(10e3)).kept_hz(100.0))
        (200.0, 725)
        """
        if self.wool is None:
            return AIR_FACTOR * top_hz
        slow = np.sqrt(top_hz * self.wool.flow_resistivity / (2 * np.pi * self.wool.pores(self.air).rho))
        return float(max(AIR_FACTOR * top_hz, WOOL_FACTOR * slow))


@dataclass(frozen=True, eq=False)
class Layer:
    """A part of the depth with one fluid. box : its size and the air in its pores. rate : of its thermal pole [1/s]."""

    box: Box
    wool: Wool | None
    rate: float = 0.0
