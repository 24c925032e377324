"""Strict quantities: a number and a unit of a known dimension, or a plain number in SI units.

The table is short on purpose. General unit libraries read ``1,5 m`` as 15 m and ``40 rad/s`` as 40 Hz; here both
are refused, and so is every unit that is not in the table.
"""

from __future__ import annotations

import difflib
import math
import re
import unicodedata
from collections.abc import Collection, Mapping, Sequence
from decimal import Decimal, DecimalException
from fractions import Fraction
from functools import lru_cache
from typing import Final, NamedTuple

from femstruct.errors import InputError, quote_value

# ----------------------------------------------------------------------------------------------------------------------
# The units that are known, and the dimensions of quantities: tables, short on purpose.
# ----------------------------------------------------------------------------------------------------------------------

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


# ----------------------------------------------------------------------------------------------------------------------
# Strict quantities.
# ----------------------------------------------------------------------------------------------------------------------


class QuantityError(InputError, ValueError):
    """A text or number that is not the quantity it should be."""


_WITHOUT_RAD: Final = (
    "rotational stiffness",
    "rotational stiffness/length",
    "rotational damping",
)  # N*m is as good as N*m/rad

_NUMBER: Final = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_QUANTITY: Final = re.compile(rf"({_NUMBER})\s*(.*)", re.ASCII | re.DOTALL)
_COMMA: Final = re.compile(r"[+-]?\d+,\d[\d.,]*", re.ASCII)
_FACTOR: Final = re.compile(r"([^\W\d_]+|%|°|1)\^?(-?\d+(?:\.\d+)?|\(-?\d+/[1-9]\d*\))?")
_TYPED: Final = "µ°⁻¹²³"  # read as they are
_RAISED: Final = str.maketrans("⁻¹²³", "-123")
_PRINTED: Final = str.maketrans(dict.fromkeys("\u2212\u2013", "-") | dict.fromkeys("\u2018\u2019\u201c\u201d\u201e"))
_NEAR: Final = 0.75  # how alike an unknown unit and a known one are: kHzz and kHz; not dm and m
_TWINS: Final = ("u", "\N{GREEK SMALL LETTER MU}")  # written as the micro sign
_KINDS: Final = frozenset(unit.exponents for unit in UNITS.values())
_STRESSES: Final = 1e4  # Pa
_FREE_FALL: Final = Unit(Decimal("9.80665"), DIMENSIONS["acceleration"].exponents)  # g of an acceleration
_LONGEST: Final = 80  # characters; no quantity needs more


def quantity(value: object, dimension: str) -> float:
    """Value in SI units of a text such as ``5 mm``, or of a plain number, which is taken to be in SI units.

    Parameters
    ----------
    dimension : str
        A key of `DIMENSIONS`, such as "length" or "stiffness/area".

    Raises
    ------
    QuantityError
        Another dimension, an unknown unit (with the nearest known one), a decimal comma, rad/s or rpm for a frequency
        (with the value in Hz), nan, infinity, a boolean, anything that is not a quantity.

    Notes
    -----
    The number is scaled in decimal arithmetic: 70 % is 0.7, not 0.7000000000000001. Of an acceleration g is 9.80665
    m/s^2, of a mass a gram.

    Examples
    --------
    >>> quantity("5.9 GPa", "pressure"), quantity("40 Ns/m", "damping"), quantity(7850, "density")
    (5900000000.0, 40.0, 7850.0)
    >>> quantity("2 g", "acceleration"), quantity("2 g", "mass")
    (19.6133, 0.002)
    """
    return quantity_of(value, (dimension,))[0]


def power_stiffness(value: object, exponent: float) -> float:
    """Stiffness k of a force k d^n in SI units [N/m^n], n from 1 to 9.

    Raises QuantityError: as `quantity`.

    >>> round(power_stiffness("2 N/mm^1.2", 1.2), 6), round(2 * 1000**1.2, 6)
    (7962.143411, 7962.143411)
    """
    unit = f"N/m^{exponent:g}" if exponent != 1.0 else "N/m"
    exponents = (Fraction(1), 1 - Fraction(str(float(exponent))), Fraction(-2), *powers()[3:])
    return _read(value, {"stiffness of a power": Dimension("a stiffness", unit, f"1e6 {unit}", exponents)})[0]


def readable_unit(unit: str, largest: float) -> tuple[float, str]:
    """A factor and the unit of numbers in sentences: of stresses MPa, as in tables; sound is never beyond 10 kPa.

    >>> readable_unit("Pa", 6.855e7), readable_unit("Pa", 0.2), readable_unit("N", 1e6)
    ((1e-06, 'MPa'), (1.0, 'Pa'), (1.0, 'N'))
    """
    return (1e-6, "MPa") if unit == "Pa" and largest >= _STRESSES else (1.0, unit)


def quantity_of(value: object, dimensions: Sequence[str]) -> tuple[float, str | None]:
    """Value in SI units and which of several dimensions it has; None for a plain number, which does not tell.

    The dimension of a quantity says whether it is total, per length or per area.

    >>> quantity_of("2 kg/m", ("mass", "mass/length", "mass/area"))
    (2.0, 'mass/length')
    """
    return _read(value, {name: DIMENSIONS[name] for name in dimensions})


def _read(value: object, dimensions: Mapping[str, Dimension]) -> tuple[float, str | None]:
    expected = " or ".join(f"{one.words} [{one.unit}]" for one in dimensions.values())
    sample = next(iter(dimensions.values())).example
    example = f"write it like {sample}"
    shown = quote_value(value)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return _finite(value, shown, expected), None
    if not isinstance(value, str) or isinstance(value, bool):
        raise QuantityError("quantity", got=shown, expected=expected, do=example)
    text = " ".join(value.split())  # blanks of any width
    typed = "".join(one if one in _TYPED else unicodedata.normalize("NFKC", one) for one in text).translate(_PRINTED)
    if typed != text and _QUANTITY.fullmatch(typed):
        strange = next(one for one in text if one not in typed)
        got = f"{shown} with the character {strange} (U+{ord(strange):04X})"
        raise QuantityError("quantity", got=got, expected=expected, do=f"type it as {typed}")
    if _COMMA.match(text):
        do = f"write a decimal point: {text.replace(',', '.', 1)}" if text.count(",") == 1 else "leave out the commas"
        raise QuantityError("quantity", got=f"{shown} with a comma", expected=expected, do=do)
    match = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST else None
    if match is None:
        raise QuantityError("quantity", got=shown, expected=expected, do=example)
    number, unit_text = match.groups()
    if not unit_text:
        return _finite(float(number), shown, expected), None
    falls = unit_text == "g" and "acceleration" in dimensions and "mass" not in dimensions
    unit = _FREE_FALL if falls else _known_unit(unit_text) or _unit(unit_text, shown, expected, sample, dimensions)
    try:
        scaled = _finite(float(Decimal(number) * unit.factor), shown, expected)
    except DecimalException:
        raise QuantityError("quantity", got=shown, expected=expected, do="give a number within reach") from None
    for name, dimension in dimensions.items():
        if unit.exponents in _accepted(name, dimension.exponents):
            return scaled, name
    raise QuantityError(
        "quantity",
        got=f"{shown}, which is {_words(unit.exponents)}",
        expected=expected,
        do=_hint(scaled, unit.exponents, dimensions) or example,
    )


def _finite(number: float, shown: str, expected: str) -> float:
    try:
        result = float(number)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise QuantityError("quantity", got=shown, expected=f"{expected}, a finite number", do="give a finite number")
    return result


@lru_cache(maxsize=256)
def _known_unit(text: str) -> Unit | None:
    """The unit of a text that has been read before or can be read; None for one that cannot, so that it is told."""
    try:
        return _unit(text, "", "", "", {})
    except QuantityError:
        return None


def _unit(text: str, shown: str, expected: str, example: str, dimensions: Mapping[str, Dimension]) -> Unit:
    """Factor and exponents of a unit such as ``N*s/m``, ``kg/m^3``, ``m2`` or ``Ns/m``.

    Parameters
    ----------
    dimensions : Mapping[str, Dimension]
        It should have one of these, for what to do about an unknown one.
    """
    factor, total = Decimal(1), powers()
    divided = False
    for sign, token in re.findall(r"([*·/ ]?)([^*·/ ]*)", re.sub(r"\s*([*·/ ])\s*", r"\1", _protect(text)))[:-1]:
        if divided and sign != "/":
            raise QuantityError(
                "quantity",
                got=f"{shown}, a product after a division",
                expected=expected,
                do=f"put what divides last, each after its own /, as in {example}",
            )
        divided = divided or sign == "/"
        match = _FACTOR.fullmatch(token.replace("|", "/"))
        if match is None:
            raise QuantityError("quantity", got=shown, expected=expected, do=f"write it like {example}")
        symbol, power_text = match.groups()
        power = Fraction((power_text or "1").strip("()")) * (-1 if sign == "/" else 1)
        if abs(power) > 9:
            raise QuantityError("quantity", got=shown, expected=expected, do=f"write it like {example}")
        found = _symbol(symbol)
        if not found:
            got = f"{shown} with an unknown unit '{symbol}'"
            do = _instead(symbol, token == text, dimensions) or f"write it like {example}"
            raise QuantityError("quantity", got=got, expected=expected, do=do)
        for unit in found:
            factor *= unit.factor ** (Decimal(power.numerator) / power.denominator)
            total = tuple(old + power * new for old, new in zip(total, unit.exponents, strict=True))
    return Unit(factor, total)


def _protect(text: str) -> str:
    """Keep the slash of an exponent like ^(3/2) out of the way of the division; other ways to write an exponent."""
    plain = text.replace("**", "^").translate(_RAISED)
    return re.sub(r"\((-?\d+)/(\d+)\)", r"(\1|\2)", plain)


def _symbol(symbol: str) -> tuple[Unit, ...]:
    """The units that a symbol stands for, none for an unknown one."""
    if symbol in UNITS:
        return (UNITS[symbol],)
    if symbol == "1":
        return (Unit(Decimal(1), powers()),)
    joined = re.fullmatch(r"([kMm]?N)(s|m|mm)", symbol)  # Ns, Nm, kNm; Nms could be two things
    if joined:
        return (UNITS[joined[1]], UNITS[joined[2]])
    return ()


def _instead(symbol: str, alone: bool, dimensions: Mapping[str, Dimension]) -> str:
    """What to write for an unknown unit: the same letters as capitals or small, a near one of the same dimension, or
    the known ones of that dimension.

    Parameters
    ----------
    alone : bool
        Whether it is the whole unit.
    """
    exponents = [one.exponents for one in dimensions.values()]
    fitting = [name for name, unit in UNITS.items() if unit.exponents in exponents]
    folded = {name.lower(): name for name in (UNITS if not alone else fitting)}
    near = difflib.get_close_matches(symbol.lower(), folded, n=1, cutoff=_NEAR if alone else 1.0)
    if near and not (symbol.startswith("m") and symbol[1:] in UNITS):  # mHz is meant as neither Hz nor MHz
        return f"did you mean '{folded[near[0]]}'?"
    words = " or ".join(one.words for one in dimensions.values() if one.exponents in {*_KINDS} & {*exponents})
    listed = ", ".join(name for name in fitting if not name.startswith(_TWINS))
    return f"known units of {words}: {listed}" if alone and fitting else ""


def _accepted(name: str, exponents: Exponents) -> tuple[Exponents, ...]:
    if name in _WITHOUT_RAD:
        return exponents, (*exponents[:3], Fraction(0), *exponents[4:])
    return (exponents,)


def _words(exponents: Exponents) -> str:
    for dimension in DIMENSIONS.values():
        if dimension.exponents == exponents:
            return dimension.words
    parts = [
        f"{unit}^{power}"
        for unit, power in zip(("kg", "m", "s", "rad", "cycle", "dB"), exponents, strict=True)
        if power
    ]
    return f"in {' '.join(parts)}".replace("^1 ", " ").removesuffix("^1")


def _hint(scaled: float, exponents: Exponents, dimensions: Collection[str]) -> str:
    if "frequency" in dimensions and exponents == DIMENSIONS["angular speed"].exponents:
        return f"in Hz it is {scaled / (2 * math.pi):.6g} Hz"
    if "frequency" in dimensions and exponents == DIMENSIONS["rate"].exponents:
        return f"write {scaled:g} Hz for cycles per second, {scaled / (2 * math.pi):.6g} Hz for radians per second"
    return ""
