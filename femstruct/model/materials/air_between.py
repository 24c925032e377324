"""Cavities as a model has them: air between two surfaces of the structure, by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from femstruct.declared import NotNegative, Positive, checked
from femstruct.errors import InputError
from femstruct.tags import stored_as


@stored_as("fill of a cavity/1")
@dataclass(frozen=True)
@checked("cavities")
class Fill:
    """Wool in a cavity, against its second surface.

    flow_resistivity [Pa s/m^2]; density : of the bulk [kg/m^3]; thickness : [m], all of the depth if left out. frame :
    "limp", fibres that the air carries along, or "held", fibres at rest. like : the entry of the library, with its
    source.

    Raises InputError: numbers that are not positive, another frame.

    >>> Fill(flow_resistivity=10e3, density=40.0, thickness=0.1).frame
    'limp'
    """

    flow_resistivity: Positive
    density: Positive
    thickness: Positive | None = None
    frame: Literal["limp", "held"] = "limp"
    like: str = ""


@stored_as("bays of a cavity/1")
@dataclass(frozen=True)
@checked("cavities")
class Bays:
    """Joists that close a cavity: every bay between two of them is a cavity of its own.

    across : the axis of the first surface that they divide. at : where their middles are along it, from the corner of
    the cavity [m]. width : of a joist, which takes its place from the air [m].

    >>> Bays("y", at=(0.6, 1.2), width=0.045).at
    (0.6, 1.2)
    """

    across: Literal["x", "y"]
    at: tuple[float, ...]
    width: NotNegative = 0.0


@stored_as("cavity between parts/1")
@dataclass(frozen=True)
@checked("cavities")
class AirBetween:
    """Air between two parallel surfaces that face each other; its four sides are rigid.

    first, second : names of surfaces; wool lies against the second. depth [m]. c [m/s], rho [kg/m^3] : of the air.
    fill : wool; None for none. bays : where joists close it; None for one cavity. up_to : modes of the air up to it
    are coordinates of their own [Hz]; None for as many as the modes of the structure need, 400 at most.

    Raises InputError: numbers that are not positive, a surface beside itself, wool thicker than the cavity.

    The void between a floor and its ceiling, half filled:

    >>> AirBetween("void", "underside", "ceiling top", depth=0.2, fill=Fill(10e3, 40.0, thickness=0.1)).c
    343.0
    """

    name: str
    first: str
    second: str
    depth: Positive
    c: Positive = 343.0
    rho: Positive = 1.21
    fill: Fill | None = None
    bays: Bays | None = None
    up_to: Positive | None = None

    def __post_init__(self) -> None:
        where = f"cavities.{self.name}"
        if self.first == self.second:
            expected = "two surfaces that face each other"
            raise InputError(f"{where}.between", got=f"'{self.first}' twice", expected=expected)
        thickness = None if self.fill is None else self.fill.thickness
        if thickness is not None and thickness > self.depth * (1 + 1e-9):
            raise InputError(
                f"{where}.fill.thickness",
                got=f"{thickness:g} m of wool in a cavity {self.depth:g} m deep",
                expected="at most the depth",
                do="leave it out to fill the cavity",
            )
