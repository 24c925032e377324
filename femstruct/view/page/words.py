"""Inputs in words: numbers in the units people use, places, rows of numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any, Final

from femstruct.model.given import Given

_PREFIXES: Final = {  # unit: (size, shown unit), the largest first
    "m": ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm")),
    "s": ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")),
    "kg": ((1.0, "kg"), (1e-3, "g")),
    "N": ((1e6, "MN"), (1e3, "kN"), (1.0, "N")),
    "Pa": ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa")),
    "N m": ((1e6, "MN m"), (1e3, "kN m"), (1.0, "N m")),
    "N/m": ((1e9, "GN/m"), (1e6, "MN/m"), (1e3, "kN/m"), (1.0, "N/m")),
    "N/m^2": ((1e9, "GN/m^2"), (1e6, "MN/m^2"), (1e3, "kN/m^2"), (1.0, "N/m^2")),
    "N/m^3": ((1e9, "GN/m^3"), (1e6, "MN/m^3"), (1e3, "kN/m^3"), (1.0, "N/m^3")),
    "Pa s/m^2": ((1e3, "kPa s/m^2"), (1.0, "Pa s/m^2")),
    "N s/m": ((1e3, "kN s/m"), (1.0, "N s/m")),
    "Hz": ((1e4, ""), (1.0, "Hz")),
    "m^2": ((1.0, "m^2"), (1e-6, "mm^2")),
    "m^4": ((1.0, "m^4"), (1e-12, "mm^4")),
}
MODE: Final = "mode "  # begins the names of damping ratios of single modes
_PERCENT: Final = (
    "ratio",
    "damping ratio",
    "loss factor",
    MODE,
)  # begin the names of shares that are told in percent
_EACH: Final = ("E", "G", "D", "S", "A")  # moduli and rigidities along axes, whose sizes differ: each in its own unit
LARGE: Final = 1e7  # from there on whole numbers have an exponent
ROUNDING: Final = 1e-9  # of a drop height that was made a speed
_LONG: Final = 6  # more values, or places, are counted


def spoken(one: Given) -> str:
    """An input with its name.

    >>> spoken(Given("thickness", 0.18, "m")), spoken(Given("size", (5.0, 4.0), "m"))
    ('thickness 180 mm', 'size 5 x 4 m')
    >>> spoken(Given("band", (1.0, 500.0), "Hz")), spoken(Given("loss factor", 0.02))
    ('band 1 to 500 Hz', 'loss factor 2 %')
    >>> spoken(Given("mode 4", 0.06))
    'mode 4: 6 %'
    """
    if one.what == "lines":
        return f"{len(one.value)} line{'s' if len(one.value) > 1 else ''}"
    numbered = ":" if one.what.startswith(MODE) else ""  # "mode 4 6 %" would be of mode 46
    return f"{one.what}{numbered} {amount(one)}"


def amount(one: Given) -> str:
    """Its value and unit.

    >>> amount(Given("E", 30e9, "Pa")), amount(Given("A", 4.62e-5, "m^2")), amount(Given("side", "below"))
    ('30 GPa', '46.2 mm²', 'below')
    >>> amount(Given("at", ((1.0, 0.5), (2.0, 0.5)), "m"))
    '(1, 0.5) m, (2, 0.5) m'
    >>> amount(Given("reverberation time", {"63 Hz": 0.55, "125 Hz": 0.5}, "s"))
    '63 Hz 550 ms, 125 Hz 500 ms'
    >>> amount(Given("E", (11e9, 370e6), "Pa"))
    '11 GPa, 370 MPa'
    """
    value, unit = one.value, one.unit
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    if isinstance(value, float | int):
        return _percent(value) if not unit and one.what.startswith(_PERCENT) else _number([value], unit)
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {amount(Given(one.what, each, unit))}" for name, each in value.items())
    if isinstance(value, tuple):
        return _several(one.what, value, unit)
    return getattr(value, "__name__", str(value))


def _several(what: str, values: tuple[Any, ...], unit: str) -> str:
    if all(isinstance(value, float | int) for value in values):
        if len(values) > _LONG:
            return f"{len(values)} values, {_number([min(values), max(values)], unit, ' to ')}"
        if what in _EACH:
            return ", ".join(_number([value], unit) for value in values)
        if what in ("size", "mesh", "patch"):
            return _number(values, unit, " x ")
        return _number(values, unit, " to ") if what == "band" else _number(values, unit, ", ", "({})")
    if what == "between":
        return " and ".join(values)
    if len(values) > _LONG and not all(isinstance(value, str) for value in values):
        return f"{len(values)} places"
    return ", ".join(value if isinstance(value, str) else amount(Given(what, value, unit)) for value in values)


def _percent(value: float) -> str:
    return f"{100.0 * value:.5g} %"


def _number(values: Iterable[float], unit: str, between: str = "", frame: str = "{}") -> str:
    """Numbers in one unit that fits the largest; those in a frame are places, whose unit stays."""
    numbers = list(values)
    largest = max(map(abs, numbers), default=0.0)
    scales = _PREFIXES.get(unit, ()) if frame == "{}" and largest else ()
    size, shown = next((scale for scale in scales if scale[1] and largest >= scale[0] * (1.0 - ROUNDING)), (1.0, unit))
    told = frame.format(between.join(_digits(value / size) for value in numbers))
    return f"{told} {superscript(shown)}".strip()


def _digits(value: float) -> str:
    """Whole numbers in full, others with five digits.

    >>> _digits(20000.0), _digits(1171.875), _digits(-0.2)
    ('20000', '1171.9', '-0.2')
    """
    whole = value == round(value) and abs(value) < LARGE
    return f"{value:.0f}" if whole else f"{value:.5g}"


def superscript(unit: str) -> str:
    """A unit as it is printed.

    >>> superscript("kg/m^3"), superscript("N/m^1.5")
    ('kg/m³', 'N/m^1.5')
    """
    return re.sub(r"\^([234])(?![.\d])", lambda found: "²³⁴"[int(found[1]) - 2], unit)
