"""Quantities against pint, a general unit library, wherever both can read the text."""

import itertools

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from femstruct.units import DIMENSIONS, quantity

REGISTRY = pint.UnitRegistry()
CASES = [
    ("length", ["m", "mm", "cm", "um", "km", "nm"]),
    ("mass", ["kg", "g", "mg", "t"]),
    ("pressure", ["Pa", "kPa", "MPa", "GPa", "hPa", "bar", "N/mm^2", "N/m^2", "kg/m/s^2"]),
    ("stiffness", ["N/m", "kN/m", "N/mm", "MN/m"]),
    ("stiffness/length", ["N/m^2", "kN/m**2", "MPa"]),
    ("stiffness/area", ["N/m^3", "MN/m^3", "N/mm^3"]),
    ("rotational stiffness", ["N*m", "kN*m/rad", "N*mm"]),
    ("damping", ["N*s/m", "kN*s/m", "kg/s", "N*ms/mm"]),
    ("hertz stiffness", ["N/m^1.5", "kN/mm^1.5"]),
    ("hertz damping", ["N*s/m^1.5"]),
    ("dissipation", ["s/m", "ms/mm", "s/mm"]),
    ("time", ["s", "ms", "us", "min"]),
    ("angle", ["deg", "rad", "mrad"]),
    ("angular speed", ["rad/s", "deg/s", "rpm"]),
    ("speed", ["m/s", "mm/s", "m/min"]),
    ("acceleration", ["m/s^2", "mm/s/s"]),
    ("density", ["kg/m^3", "g/cm^3", "t/m^3"]),
    ("second moment", ["m^4", "cm^4", "mm^4"]),
    ("area", ["m^2", "cm^2"]),
    ("bending stiffness", ["N*m^2", "kN*m^2"]),
    ("moment", ["N*m", "J", "kJ"]),
    ("frequency", ["Hz", "kHz", "MHz"]),
]


@pytest.mark.parametrize(("dimension", "unit"), [(d, u) for d, units in CASES for u in units])
def test_units_scale_as_pint_does(dimension: str, unit: str) -> None:
    number = 3.7
    oracle = REGISTRY.Quantity(number, unit)
    expected = oracle.to("hertz").magnitude if dimension == "frequency" else oracle.to_base_units().magnitude
    assert quantity(f"{number} {unit}", dimension) == pytest.approx(expected, rel=1e-14)  # float rounding of pint


@given(st.decimals(min_value="-1e6", max_value="1e6", allow_nan=False, places=6), st.sampled_from(["", " ", "  "]))
def test_decimal_scaling_is_exact(number: object, space: str) -> None:
    assert quantity(f"{number}{space}mm", "length") == float(number.scaleb(-3))  # type: ignore[attr-defined]


def test_no_two_dimensions_hide_each_other() -> None:
    """The dimension tells total from per length from per area: these families must be told apart."""
    for family in (("mass", "mass/length", "mass/area"), ("stiffness", "stiffness/length", "stiffness/area")):
        for a, b in itertools.combinations(family, 2):
            assert DIMENSIONS[a].exponents != DIMENSIONS[b].exponents
