"""Cross-sections of bars: area, bending and torsion constants, from a shape or given."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, isfinite, pi, sin, tau

import numpy as np

from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.model.regions import Pair
from femstruct.tags import stored_as

ROUND = 16
"""Points of the outline of a round section: between them a bending stress is larger by 2 % at most."""


@stored_as("section/1")
@dataclass(frozen=True)
@checked("sections")
class Section:
    """Constants of a bar's cross-section; local y is its width, local z its height.

    A [m^2]; Iy, Iz : second moments of area about the local y and z axes [m^4]; J : torsion constant [m^4] (the polar
    moment only for circles and tubes); ky, kz : shear coefficients along y and z [1].
    outline : its outermost points (y, z) from the centroid [m], where stretch and bending stress it most; empty where
    it is not known: then the bar has section forces and no stresses. twist_arm : the largest shear stress of torsion
    over T / J [m].

    Raises InputError for a constant that is not positive.

    An IPE 100 by its table; `rectangle`, `circle`, `tube` and others make them of their sides:

    >>> Section("IPE 100", A=10.3e-4, Iy=171e-8, Iz=15.9e-8, J=1.2e-8, ky=0.55, kz=0.40).ky
    0.55
    >>> Section("slip", A=-1.0, Iy=1e-6, Iz=1e-6, J=1e-6)
    Traceback (most recent call last):
    ...
    femstruct.errors.InputError: sections.slip.A: got -1, expected a positive number
    """

    name: str
    A: float
    Iy: float
    Iz: float
    J: float
    ky: float = 5.0 / 6.0
    kz: float = 5.0 / 6.0
    outline: tuple[Pair, ...] = ()
    twist_arm: float = 0.0

    def __post_init__(self) -> None:
        _positive(self.name, A=self.A, Iy=self.Iy, Iz=self.Iz, J=self.J, ky=self.ky, kz=self.kz)


def rectangle(name: str, width: float, height: float) -> Section:
    """Solid rectangle, width along local y, height along local z.

    Iy = b h^3 / 12, J by Saint-Venant's series, shear coefficients 5/6.

    width [m] along local y, height [m] along local z.

    >>> round(rectangle("square", 0.1, 0.1).J / 0.1**4, 4)
    0.1406
    """
    _positive(name, width=width, height=height)
    narrow, wide = min(width, height), max(width, height)
    return Section(
        name,
        A=width * height,
        Iy=width * height**3 / 12.0,
        Iz=height * width**3 / 12.0,
        J=wide * narrow**3 / 3.0 * (1.0 - 192.0 / pi**5 * narrow / wide * _series(wide / narrow)),
        outline=_corners(width, height),
        twist_arm=narrow * (1.0 - 8.0 / pi**2 * _sides(wide / narrow)),
    )


def circle(name: str, diameter: float) -> Section:
    """Solid circle; J is the polar moment.

    diameter [m]. Shear coefficients as `tube`.

    >>> round(circle("bar", 0.02).ky, 4)
    0.8571
    """
    _positive(name, diameter=diameter)
    return _ring(name, diameter, 0.0)


def tube(name: str, outer: float, thickness: float) -> Section:
    """Round tube of an outer diameter and a wall thickness; J is the polar moment.

    Parameters
    ----------
    outer : float
        Outer diameter [m]; thickness [m].

    Notes
    -----
    Shear coefficient 6 (1 + m^2)^2 / (7 (1 + m^2)^2 + 20 m^2), m = inner / outer diameter: 6/7 for the solid,
    1/2 for the thin tube. Cowper, J. Applied Mechanics 33 (1966) 335, doi:10.1115/1.3625046, with nu = 0, as the 5/6 of
    the rectangle is; nu = 0.3 would raise them by 3 to 6 %.
    """
    _positive(name, outer=outer, thickness=thickness)
    if not 2.0 * thickness < outer:
        raise InputError(f"sections.{name}.thickness", got=f"{thickness:g} m", expected=f"less than {outer / 2:g} m")
    return _ring(name, outer, outer - 2.0 * thickness)


def box(name: str, width: float, height: float, thickness: float) -> Section:
    """Rectangular box of even wall thickness; width along local y and height along local z are outer sides.

    Parameters
    ----------
    width, height : float
        Outer sides along local y and z [m]; thickness [m].

    Notes
    -----
    J = 4 A_m^2 t / s (Bredt, thin-walled: A_m, s the area and length of the middle line), good to a few per cent
    for t below a tenth of the smaller side. Shear is carried by the two walls along it: k = their area / A.
    """
    _positive(name, width=width, height=height, thickness=thickness)
    if not 2.0 * thickness < min(width, height):
        raise InputError(
            f"sections.{name}.thickness", got=f"{thickness:g} m", expected=f"less than {min(width, height) / 2:g} m"
        )
    inner_width, inner_height = width - 2.0 * thickness, height - 2.0 * thickness
    middle_width, middle_height = width - thickness, height - thickness
    area = width * height - inner_width * inner_height
    return Section(
        name,
        A=area,
        Iy=(width * height**3 - inner_width * inner_height**3) / 12.0,
        Iz=(height * width**3 - inner_height * inner_width**3) / 12.0,
        J=2.0 * thickness * (middle_width * middle_height) ** 2 / (middle_width + middle_height),
        ky=2.0 * thickness * middle_width / area,
        kz=2.0 * thickness * middle_height / area,
        outline=_corners(width, height),
        twist_arm=middle_width * middle_height / (middle_width + middle_height),
    )


def i_section(name: str, width: float, height: float, web: float, flange: float) -> Section:
    """Doubly symmetric I: flanges along local y, web along local z; thicknesses of web and flange.

    Parameters
    ----------
    width, height : float
        Over all [m].
    web, flange : float
        Thicknesses [m].

    Notes
    -----
    J = sum of s t^3 / 3 over the walls (open thin-walled section, fillets neglected; warping is free). Shear
    along z is carried by the web, along y by 5/6 of the flanges.
    """
    _positive(name, width=width, height=height, web=web, flange=flange)
    if not (2.0 * flange < height and web < width):
        raise InputError(
            f"sections.{name}",
            got=f"web {web:g} m, flange {flange:g} m",
            expected=f"a web below {width:g} m and a flange below {height / 2:g} m",
        )
    clear = height - 2.0 * flange
    area = 2.0 * width * flange + clear * web
    return Section(
        name,
        A=area,
        Iy=(width * height**3 - (width - web) * clear**3) / 12.0,
        Iz=(2.0 * flange * width**3 + clear * web**3) / 12.0,
        J=(2.0 * width * flange**3 + (height - flange) * web**3) / 3.0,
        ky=5.0 / 6.0 * 2.0 * width * flange / area,
        kz=(height - flange) * web / area,
        outline=_corners(width, height),
        twist_arm=max(web, flange),
    )


def _ring(name: str, outer: float, inner: float) -> Section:
    second_moment = pi * (outer**4 - inner**4) / 64.0
    m = inner / outer
    shear = 6.0 * (1.0 + m**2) ** 2 / (7.0 * (1.0 + m**2) ** 2 + 20.0 * m**2)
    return Section(
        name,
        A=pi * (outer**2 - inner**2) / 4.0,
        Iy=second_moment,
        Iz=second_moment,
        J=2.0 * second_moment,
        ky=shear,
        kz=shear,
        outline=tuple((outer / 2.0 * cos(tau * i / ROUND), outer / 2.0 * sin(tau * i / ROUND)) for i in range(ROUND)),
        twist_arm=outer / 2.0,
    )


def _corners(width: float, height: float) -> tuple[Pair, ...]:
    return tuple((y * width / 2.0, z * height / 2.0) for y, z in ((-1, -1), (1, -1), (1, 1), (-1, 1)))


def _series(ratio: float) -> float:
    """Sum over odd n of tanh(n pi ratio / 2) / n^5; the tail beyond n = 2000 is below 1e-14."""
    n = np.arange(1.0, 2000.0, 2.0)
    return float(np.sum(np.tanh(n * pi * ratio / 2.0) / n**5))


def _sides(ratio: float) -> float:
    """Sum over odd n of 1 / (n^2 cosh(n pi ratio / 2)): what the short sides of a rectangle take off the shear stress
    in the middle of its long ones (Timoshenko and Goodier, Theory of Elasticity, section 109)."""
    n = np.arange(1.0, 100.0, 2.0)
    return float(np.sum(1.0 / (n**2 * np.cosh(np.minimum(n * pi * ratio / 2.0, 700.0)))))


def _positive(name: str, **values: float) -> None:
    for key, value in values.items():
        if not (isfinite(value) and value > 0):
            raise InputError(f"sections.{name}.{key}", got=f"{value:g}", expected="a positive number")
