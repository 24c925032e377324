"""Units in which a number is easy to read: kN rather than 3e5 N."""

from __future__ import annotations

from math import isnan
from typing import Final

ROUNDING: Final = 1e-9  # of the largest of its kind: what is left of a solved system, shown as 0
ZEROS: Final = f"; 0: below {ROUNDING:g} of the largest in its unit"  # ends titles of tables with such
_SCALES: Final = {  # unit: (how much of the unit, shown unit), the largest first
    "m": ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")),
    "m/s": ((1.0, "m/s"), (1e-3, "mm/s"), (1e-6, "µm/s")),
    "m/s^2": ((1.0, "m/s²"), (1e-3, "mm/s²")),
    "rad": ((1.0, "rad"), (1e-3, "mrad")),
    "N": ((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN")),
    "Pa": ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa"), (1e-3, "mPa"), (1e-6, "µPa")),
    "N/m": ((1e9, "GN/m"), (1e6, "MN/m"), (1e3, "kN/m"), (1.0, "N/m")),
    "N/m^1.5": ((1e9, "GN/m^1.5"), (1e6, "MN/m^1.5"), (1e3, "kN/m^1.5"), (1.0, "N/m^1.5")),
    "N*s/m": ((1e6, "MN*s/m"), (1e3, "kN*s/m"), (1.0, "N*s/m")),
    "J": ((1e6, "MJ"), (1e3, "kJ"), (1.0, "J"), (1e-3, "mJ"), (1e-6, "µJ")),
}


def digits(value: float) -> str:
    """Four significant digits, without an exponent up to a million; "-" for what is not known.

    >>> digits(17553.2), digits(0.0123456), digits(2.5e7), digits(float("nan"))
    ('17550', '0.01235', '2.5e+07', '-')
    """
    if isnan(value):
        return "-"
    return f"{float(f'{value:.4g}'):.0f}" if 1e4 <= abs(value) < 1e6 else f"{value:.4g}"


def rounded(value: float, largest: float) -> float:
    """A number, or 0 where it is rounding beside the largest of its kind.

    >>> rounded(1.3e-12, 40.0), rounded(1.3e-3, 40.0)
    (0.0, 0.0013)
    """
    return 0.0 if abs(value) < ROUNDING * abs(largest) else value


def scaled(unit: str, largest: float) -> tuple[float, str]:
    """A factor and a unit in which `largest` is a number near 1..1000 to read.

    >>> scaled("m", 0.0042)
    (1000.0, 'mm')
    """
    scales = _SCALES.get(unit, ((1.0, unit),))
    if not largest:
        return 1.0, unit
    size, name = next((scale for scale in scales if largest >= scale[0]), scales[-1])
    return 1.0 / size, name
