"""Radiation efficiency of a rectangle in a rigid baffle that carries a diffuse field of bending waves."""

from __future__ import annotations

from math import ceil, hypot, pi
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats, frozen, positive
from acoustics.statistical.infinite_plate import Waves

_MORE: Final = 16  # nodes of a Gauss rule beyond half a node for each radian
_DIRECTIONS: Final = (16, 0.35)  # of waves in a quarter turn: at least, and for each radian over the diagonal


def diffuse_radiation(waves: Waves, frequency_hz: Floats, sides: tuple[float, float], air: Air) -> Floats:
    """Radiation efficiency [nf] of bending waves of all directions on a rectangle, smooth through coincidence.

    waves : at the frequencies [nf] [Hz]; each direction has the share of the motion that its mobility has. sides :
    of the rectangle, along the plate's x and y [m].

    Notes
    -----
    The sound power of a motion with the correlation C(u, v) between places u, v apart, over that of a plane wave:

        sigma = 2 k / (pi a b) int_0^a int_0^b (a - u)(b - v) C(u, v) sin(k r) / r du dv,  r^2 = u^2 + v^2,

    C the mean of cos(k_x u) cos(k_y v) over the directions, J0(k_B r) of an isotropic plate. Edges move as the middle
    does: the field is that of an infinite plate. sigma tends to 1/sqrt(1 - f_c/f) far above the critical frequency.

    References
    ----------
    X. Yu, C. Hopkins, JASA Express Lett. 1, 062801 (2021), of isotropic plates: one integral over r.

    A concrete slab of 5 x 4 m above and below its critical frequency of 98 Hz:

    >>> from acoustics.statistical.infinite_plate import isotropic_plate
    >>> f, slab = np.array([50.0, 160.0, 630.0]), isotropic_plate(30e9, 0.2, 2400.0, 0.18, thin=True)
    >>> diffuse_radiation(slab.waves(f), f, (5.0, 4.0), Air()).round(2).tolist()
    [0.33, 1.57, 1.09]
    """
    a, b = (positive("sides", side, "m") for side in sides)
    frequency = frozen("frequency", frequency_hz, (len(waves.wavenumber),))
    return np.array(
        [_efficiency(2 * pi * f / air.c, waves, number, a, b) for number, f in enumerate(frequency.tolist())]
    )


def _efficiency(k: float, waves: Waves, number: int, a: float, b: float) -> float:
    """At one frequency: a double Gauss rule, whose kernel is a product in every direction."""
    share = waves.mobility[number] / waves.mobility[number].sum()
    plate = waves.wavenumber[number]
    angle, plate, share = _finer(waves.angle, plate, share, float(plate.max()) * hypot(a, b))
    fastest = k + float(plate.max())
    (u, du), (v, dv) = (_gauss(side, fastest) for side in (a, b))
    correlation = (np.cos(np.outer(plate * np.cos(angle), u)) * share[:, None]).T @ np.cos(
        np.outer(plate * np.sin(angle), v)
    )
    r = np.hypot(u[:, None], v)
    return float(2 * k / (pi * a * b) * (du * (a - u)) @ (correlation * np.sin(k * r) / r) @ (dv * (b - v)))


def _finer(angle: Floats, plate: Floats, share: Floats, reach: float) -> tuple[Floats, Floats, Floats]:
    """More directions, where waves from neighbours would part before they have crossed the rectangle."""
    wanted = ceil(_DIRECTIONS[0] + _DIRECTIONS[1] * reach)
    if wanted <= len(angle):
        return angle, plate, share
    more: Floats = np.asarray((np.arange(wanted) + 0.5) * (pi / 2 / wanted), dtype=np.float64)
    # both are smooth, and even about the plate's axes
    known = np.concatenate([-angle[:2][::-1], angle, pi - angle[-2:][::-1]])
    found = [np.interp(more, known, np.concatenate([one[:2][::-1], one, one[-2:][::-1]])) for one in (plate, share)]
    return more, found[0], found[1] / found[1].sum()


def _gauss(side: float, fastest: float) -> tuple[Floats, Floats]:
    """Nodes and weights over a side for waves up to a wavenumber."""
    nodes, weights = np.polynomial.legendre.leggauss(ceil(0.5 * fastest * side) + _MORE)
    return side / 2 * (nodes + 1), side / 2 * weights
