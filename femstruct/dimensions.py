"""The units that are known, and the dimensions of quantities: tables, short on purpose."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Final, NamedTuple

Exponents = tuple[Fraction, ...]  # of kg, m, s, rad, cycle and decibel


class Unit(NamedTuple):
    """A unit: how many SI units it is, and of which powers of the basic ones."""

    factor: Decimal
    exponents: Exponents


class Dimension(NamedTuple):
    """What a quantity is: in words, its SI unit, a quantity of it as it is written, and its powers of basic units."""

    words: str
    unit: str
    example: str
    exponents: Exponents


def powers(kg: float = 0, m: float = 0, s: float = 0, rad: float = 0, cycle: float = 0, db: float = 0) -> Exponents:
    """The powers of basic units.

    >>> [int(one) for one in powers(kg=1, m=-3)]
    [1, -3, 0, 0, 0, 0]
    """
    return tuple(Fraction(power) for power in (kg, m, s, rad, cycle, db))


_PI: Final = Decimal("3.14159265358979323846264338327950288")
_PREFIX: Final = {
    "": Decimal(1), "n": Decimal("1e-9"), "u": Decimal("1e-6"), "µ": Decimal("1e-6"), "μ": Decimal("1e-6"),
    "m": Decimal("1e-3"), "c": Decimal("1e-2"), "h": Decimal("1e2"), "k": Decimal("1e3"), "M": Decimal("1e6"),
    "G": Decimal("1e9"),
}  # fmt: skip
_SYMBOLS: Final = {  # symbol: (its prefixes, factor, exponents)
    "m": (("", "n", "u", "µ", "μ", "m", "c", "k"), Decimal(1), powers(m=1)),
    "g": (("", "u", "m", "k"), Decimal("1e-3"), powers(kg=1)),
    "t": (("",), Decimal(1000), powers(kg=1)),
    "s": (("", "n", "u", "µ", "μ", "m"), Decimal(1), powers(s=1)),
    "min": (("",), Decimal(60), powers(s=1)),
    "Hz": (("", "k", "M"), Decimal(1), powers(s=-1, cycle=1)),
    "rpm": (("",), 2 * _PI / 60, powers(s=-1, rad=1)),
    "rad": (("", "m"), Decimal(1), powers(rad=1)),
    "deg": (("",), _PI / 180, powers(rad=1)),
    "°": (("",), _PI / 180, powers(rad=1)),
    "N": (("", "u", "m", "k", "M", "G"), Decimal(1), powers(kg=1, m=1, s=-2)),
    "Pa": (("", "u", "m", "h", "k", "M", "G"), Decimal(1), powers(kg=1, m=-1, s=-2)),
    "bar": (("", "m"), Decimal(100000), powers(kg=1, m=-1, s=-2)),
    "J": (("", "m", "k"), Decimal(1), powers(kg=1, m=2, s=-2)),
    "%": (("",), Decimal("1e-2"), powers()),
    "dB": (("",), Decimal(1), powers(db=1)),  # a number of its own: no ratio
}  # fmt: skip
UNITS: Final = {
    prefix + symbol: Unit(_PREFIX[prefix] * factor, exponents)
    for symbol, (prefixes, factor, exponents) in _SYMBOLS.items()
    for prefix in prefixes
}

DIMENSIONS: Final = {
    "ratio": Dimension("a ratio", "1", "2 %", powers()),
    "length": Dimension("a length", "m", "5 mm", powers(m=1)),
    "area": Dimension("an area", "m^2", "3.14e-4 m^2", powers(m=2)),
    "second moment": Dimension("a second moment of area", "m^4", "2.1e-8 m^4", powers(m=4)),
    "angle": Dimension("an angle", "rad", "90 deg", powers(rad=1)),
    "mass": Dimension("a mass", "kg", "54 g", powers(kg=1)),
    "mass/length": Dimension("a mass per length", "kg/m", "1.2 kg/m", powers(kg=1, m=-1)),
    "mass/area": Dimension("a mass per area", "kg/m^2", "5 kg/m^2", powers(kg=1, m=-2)),
    "inertia": Dimension("a moment of inertia", "kg*m^2", "60 kg*m^2", powers(kg=1, m=2)),
    "density": Dimension("a density", "kg/m^3", "7850 kg/m^3", powers(kg=1, m=-3)),
    "time": Dimension("a time", "s", "20 ms", powers(s=1)),
    "level": Dimension("a level", "dB", "53 dB", powers(db=1)),
    "rate": Dimension("a rate", "1/s", "12 1/s", powers(s=-1)),
    "frequency": Dimension("a frequency", "Hz", "19.9 Hz", powers(s=-1, cycle=1)),
    "angular speed": Dimension("an angular speed", "rad/s", "3 rad/s", powers(s=-1, rad=1)),
    "speed": Dimension("a speed", "m/s", "1.2 m/s", powers(m=1, s=-1)),
    "acceleration": Dimension("an acceleration", "m/s^2", "9.81 m/s^2", powers(m=1, s=-2)),
    "force": Dimension("a force", "N", "1.5 kN", powers(kg=1, m=1, s=-2)),
    "pressure": Dimension("a pressure", "Pa", "5.9 GPa", powers(kg=1, m=-1, s=-2)),
    "moment": Dimension("a moment", "N*m", "3 N*m", powers(kg=1, m=2, s=-2)),
    "stiffness": Dimension("a stiffness", "N/m", "507 N/m", powers(kg=1, s=-2)),
    "stiffness/length": Dimension("a stiffness per length", "N/m^2", "2.2e5 N/m^2", powers(kg=1, m=-1, s=-2)),
    "stiffness/area": Dimension("a stiffness per area", "N/m^3", "10 MN/m^3", powers(kg=1, m=-2, s=-2)),
    "rotational stiffness": Dimension("a rotational stiffness", "N*m/rad", "1 kN*m/rad", powers(1, 2, -2, -1)),
    "rotational stiffness/length": Dimension(
        "a rotational stiffness per length", "N*m/m", "40 kN*m/m", powers(1, 1, -2, -1)
    ),
    "mobility": Dimension("a mobility", "m/s/N", "1e-5 m/s/N", powers(kg=-1, s=1)),
    "damping": Dimension("a damping constant", "N*s/m", "40 N*s/m", powers(kg=1, s=-1)),
    "rotational damping": Dimension("a rotational damping", "N*m*s/rad", "2 N*m*s/rad", powers(1, 2, -1, -1)),
    "hertz stiffness": Dimension("a Hertz stiffness", "N/m^1.5", "3.7e5 N/m^1.5", powers(1, -0.5, -2)),
    "hertz damping": Dimension("a Hertz damping", "N*s/m^1.5", "150 N*s/m^1.5", powers(1, -0.5, -1)),
    "dissipation": Dimension("a dissipation factor", "s/m", "0.3 s/m", powers(m=-1, s=1)),
    "inertance": Dimension("an inertance", "kg/m^4", "22 kg/m^4", powers(kg=1, m=-4)),
    "flow resistance": Dimension("a flow resistance", "Pa*s/m^3", "500 Pa*s/m^3", powers(kg=1, m=-4, s=-1)),
    "flow resistivity": Dimension("a flow resistivity", "Pa*s/m^2", "10 kPa*s/m^2", powers(kg=1, m=-3, s=-1)),
    "specific impedance": Dimension("a specific impedance", "Pa*s/m", "8 kPa*s/m", powers(kg=1, m=-2, s=-1)),
    "force psd": Dimension("a spectral density of a force", "N^2/Hz", "2 N^2/Hz", powers(2, 2, -3, 0, -1)),
    "speed psd": Dimension(
        "a spectral density of a velocity", "m^2/s^2/Hz", "1e-9 m^2/s^2/Hz", powers(0, 2, -1, 0, -1)
    ),
    "moment psd": Dimension("a spectral density of a moment", "N^2*m^2/Hz", "2 N^2*m^2/Hz", powers(2, 4, -3, 0, -1)),
    "pressure psd": Dimension("a spectral density of a pressure", "Pa^2/Hz", "4 Pa^2/Hz", powers(2, -2, -3, 0, -1)),
    "acceleration psd": Dimension(
        "a spectral density of an acceleration", "m^2/s^4/Hz", "1 m^2/s^4/Hz", powers(0, 2, -3, 0, -1)
    ),
    "bending stiffness": Dimension("a bending stiffness", "N*m^2", "25 N*m^2", powers(kg=1, m=3, s=-2)),
}  # fmt: skip
