"""An entry of the library: what is known of a material or a product, each value with the work that prints it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Final

from femstruct.errors import FemstructError

UNITS: Final[Mapping[str, str]] = {
    "E": "Pa",
    "G": "Pa",
    "nu": "",
    "rho": "kg/m^3",
    "loss_factor": "",
    "thickness": "m",
    "flow_resistivity": "Pa s/m^2",
    "stiffness": "N/m",
    "stiffness_per_length": "N/m^2",
    "stiffness_per_area": "N/m^3",
    "load": "N",
    "pressure": "Pa",
}
"""The properties that entries have, with their units in SI."""


class Use(Enum):
    """How a model takes an entry."""

    MATERIAL = "materials: {NAME: {like: ENTRY}}"
    LAY_UP = "layers: {like: ENTRY, of: MATERIAL}"
    HANGERS = "parts: {NAME: {type: hangers, like: ENTRY, ..}}"
    LAYER = "parts: {NAME: {type: foundation, like: ENTRY, ..}}"
    FILL = "cavities: {NAME: {fill: {like: ENTRY}, ..}}"
    NUMBERS = "numbers to be taken by hand"


@dataclass(frozen=True)
class Source:
    """A work that prints values. read : where they were read, if not in the work itself.

    >>> str(Source("EN 338:2016, table 1", "read at a maker's page"))
    "EN 338:2016, table 1 (read at a maker's page)"
    """

    work: str
    read: str = ""

    def __str__(self) -> str:
        return f"{self.work} ({self.read})" if self.read else self.work


@dataclass(frozen=True)
class Fact:
    """One property of an entry, in SI units.

    value : what a model takes; several along the axes of an orthotropic material; None where only a range is printed,
    and a model has to say it. between : the least and the largest that are printed. note : what the number is, where it
    is not simply printed: derived, an estimate of the author.
    """

    key: str
    value: float | tuple[float, ...] | None
    source: Source
    between: tuple[float, float] | None = None
    note: str = ""

    def __post_init__(self) -> None:
        if self.key not in UNITS or (self.value is None and self.between is None):
            raise FemstructError(f"library {self.key}", got="a fact without a number or a name", expected="both")

    @property
    def unit(self) -> str:
        """Its unit in SI."""
        return UNITS[self.key]


@dataclass(frozen=True)
class LibraryEntry:
    """A material or a product. layers : of a lay-up, thicknesses [m] with 0 or 90 degrees, from the lower face up."""

    name: str
    family: str
    use: Use
    what: str
    facts: tuple[Fact, ...]
    layers: tuple[tuple[float, int], ...] = ()

    def fact(self, key: str) -> Fact | None:
        """What is known of a property; None where no source gives it."""
        return next((one for one in self.facts if one.key == key), None)

    def value(self, key: str) -> float | tuple[float, ...] | None:
        """The value that a model takes; None where there is none, and a model has to give it."""
        found = self.fact(key)
        return None if found is None else found.value

    def number(self, key: str) -> float | None:
        """`value` of a property that is one number."""
        found = self.value(key)
        return None if isinstance(found, tuple) else found

    @property
    def works(self) -> tuple[Source, ...]:
        """The works behind it, each once."""
        return tuple(dict.fromkeys(one.source for one in self.facts))


# ----------------------------------------------------------------------------------------------------------------------
# Works that several families quote, and what they print in common.
# ----------------------------------------------------------------------------------------------------------------------

_COPY: Final = "read in the transcription of the public package phonometry"
HOPKINS: Final = Source("C. Hopkins, Sound Insulation, Elsevier 2007, table A2", _COPY)
HOPKINS_LAYERS: Final = Source("C. Hopkins, Sound Insulation, Elsevier 2007, table A3, p. 610", _COPY)
VIGRAN: Final = Source("T. E. Vigran, Building Acoustics, Taylor & Francis 2008, table 3.1, p. 88", _COPY)
VIGRAN_MODULI: Final = Source("T. E. Vigran, Building Acoustics, Taylor & Francis 2008, table 8.3, p. 318", _COPY)
ESTIMATE: Final = "an estimate of the author"


def of_vigran(E: float, nu: float, rho: tuple[float, float], loss_factor: tuple[float, float]) -> tuple[Fact, ...]:
    """A row of Vigran's table 3.1: E [Pa], and of density [kg/m^3] and loss factor the middle of what is printed.

    >>> [one.value for one in of_vigran(3.8e9, 0.2, (650.0, 800.0), (0.01, 0.03))]
    [3800000000.0, 0.2, 725.0, 0.02]
    """
    middle = "middle of the range"
    return (
        Fact("E", E, VIGRAN, note="dynamic"),
        Fact("nu", nu, VIGRAN, note="approximate"),
        Fact("rho", sum(rho) / 2.0, VIGRAN, rho, middle),
        Fact("loss_factor", sum(loss_factor) / 2.0, VIGRAN, loss_factor, f"internal, {middle}"),
    )


def of_hopkins(
    speed: float,
    nu: float,
    rho: float,
    loss_factor: float | None,
    estimated: bool = True,
    speeds: tuple[float, float] | None = None,
) -> tuple[Fact, ...]:
    """E, nu, rho and the internal loss factor of a row of Hopkins' table A2, which prints the speed c of longitudinal
    waves in plates [m/s]: E = rho c^2 (1 - nu^2).

    Parameters
    ----------
    estimated : bool
        Whether the loss factor is the author's estimate; all ratios nu but of metals and glass are.
    speeds : tuple[float, float] | None
        The range of c that is printed beside it.

    Examples
    --------
    >>> [round(one.value / 1e9, 2) for one in of_hopkins(3800.0, 0.2, 2200.0, 0.005) if one.key == "E"]
    [30.5]
    """
    per_speed = rho * (1.0 - nu**2)
    between = None if speeds is None else (per_speed * speeds[0] ** 2, per_speed * speeds[1] ** 2)
    facts = [
        Fact("E", per_speed * speed**2, HOPKINS, between, f"dynamic: rho c^2 (1 - nu^2) with c = {speed:g} m/s"),
        Fact("nu", nu, HOPKINS, note=ESTIMATE),
        Fact("rho", rho, HOPKINS),
    ]
    if loss_factor is not None:
        facts.append(Fact("loss_factor", loss_factor, HOPKINS, note=f"internal{', ' + ESTIMATE if estimated else ''}"))
    return tuple(facts)
