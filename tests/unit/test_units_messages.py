"""What a quantity is refused for, and what the message tells its writer."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from femstruct.units import DIMENSIONS, QuantityError, quantity, quantity_of

REFUSED = [
    ("5 mm", "pressure", r"got '5 mm', which is a length, expected a pressure \[Pa\]"),
    ("1,5 m", "length", r"with a comma.*write a decimal point: 1\.5 m"),
    ("1,000,000 N", "force", "leave out the commas"),
    ("40 rad/s", "frequency", r"an angular speed.*6\.3662 Hz"),
    ("3000 rpm", "frequency", r"an angular speed.*in Hz it is 50 Hz"),
    ("3 1/s", "frequency", r"write 3 Hz for cycles per second"),
    (float("nan"), "length", "finite"),
    (float("inf"), "length", "finite"),
    ("nan", "length", "expected a length"),
    ("1e999 m", "length", "finite"),
    ("1e99999999999999 m", "length", "within reach"),
    (10**4000, "length", "finite"),
    (True, "length", "got true"),
    (None, "length", "got nothing"),
    ({"a": 1}, "length", "got a mapping {a: 1}, expected"),
    ([1.0], "length", r"got a list \[1\.0\], expected"),
    ([], "length", "got a list, expected"),
    (["1 m"] * 100, "length", r"got a list \[1 m, 1 m, 1 m, 1 m, 1 m, 1 m, \.\.\.\], expected"),
    ("5 gpa", "pressure", "did you mean 'GPa'"),
    ("5 xyz", "pressure", "known units of a pressure: Pa, mPa, hPa, kPa, MPa, GPa, bar, mbar$"),
    ("8 inch", "length", "unknown unit 'inch', .*; known units of a length: m, nm, µm, mm, cm, km$"),  # was: 'min'?
    ("8 dm", "length", "known units of a length: m, "),  # was: 'm'?
    ("8 MM", "length", "did you mean 'mm'"),
    ("3 kHzz", "frequency", "did you mean 'kHz'"),
    ("7.85 kg/dm3", "density", "unknown unit 'dm', .*; write it like 7850 kg/m\\^3$"),
    ("7850 KG/m3", "density", "did you mean 'kg'"),
    ("40 N/m*s", "damping", "product after a division"),
    ("2 Nms/rad", "rotational damping", "unknown unit 'Nms'"),
    ("5 m/", "length", "write it like 5 mm"),
    ("5 m^99", "length", "write it like 5 mm"),
    ("5 m^(1/0)", "length", "write it like 5 mm"),
    ("m", "length", "write it like 5 mm"),
    ("5 %", "length", "which is a ratio"),
]


@pytest.mark.parametrize(("text", "dimension", "message"), REFUSED)
def test_refusals_say_what_to_do(text: object, dimension: str, message: str) -> None:
    with pytest.raises(QuantityError, match=message):
        quantity(text, dimension)


@pytest.mark.parametrize("text", ["40 N*s/m", "40 Ns/m", "40 N s/m", "40 N·s/m", "40N*s/m", "0.04 kN*s/m", " 40 ", 40])
def test_ways_to_write_a_dashpot(text: object) -> None:
    assert quantity(text, "damping") == 40.0


@pytest.mark.parametrize(("text", "value"), [("2 m2", 2.0), ("2 m²", 2.0), ("2 m**2", 2.0), ("2e4 cm^2", 2.0)])
def test_ways_to_write_an_area(text: str, value: float) -> None:
    assert quantity(text, "area") == value


def test_percent_is_scaled_in_decimals() -> None:
    assert quantity("70 %", "ratio") == 0.7  # 70 * 0.01 in binary is 0.7000000000000001


def test_dimension_tells_total_from_per_length_and_per_area() -> None:
    family = ("mass", "mass/length", "mass/area")
    assert quantity_of("2 kg", family) == (2.0, "mass")
    assert quantity_of("2 kg/m", family) == (2.0, "mass/length")
    assert quantity_of("2 g/cm^2", family) == (20.0, "mass/area")
    assert quantity_of(2, family) == (2.0, None)


@pytest.mark.parametrize("name", DIMENSIONS)
def test_examples_of_the_messages_are_read(name: str) -> None:
    dimension = DIMENSIONS[name]
    quantity(dimension.example, name)
    assert quantity(f"1 {dimension.unit}", name) == 1.0


@given(st.text(), st.sampled_from(sorted(DIMENSIONS)))
def test_any_text_is_a_quantity_or_a_quantity_error(text: str, dimension: str) -> None:
    try:
        quantity(text, dimension)
    except QuantityError as error:
        assert "\n" not in str(error)


@given(st.from_regex(r"[0-9.,eE+-]{1,6} ?[kMGmuN·*/^()a-z0-9 %°-]{0,12}", fullmatch=True))
def test_near_misses_are_quantities_or_quantity_errors(text: str) -> None:
    with contextlib.suppress(QuantityError):
        quantity(text, "length")
