"""Cross-sections of bars: area, bending and torsion constants, from a shape or given."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Section:
    """Constants of a bar's cross-section; local y is its width, local z its height.

    A [m^2]; Iy, Iz : second moments of area about the local y and z axes [m^4]; J : torsion constant [m^4] (the polar
    moment only for circles and tubes); ky, kz : shear coefficients along y and z [1].
    """

    name: str
    A: float
    Iy: float
    Iz: float
    J: float
    ky: float = 5.0 / 6.0
    kz: float = 5.0 / 6.0
