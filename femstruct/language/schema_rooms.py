"""Specs of rooms: size, air, losses and who listens."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from acoustics.levels.methods import STANDARDS
from acoustics.meshed.walls import MOST_ABSORBED
from femstruct.language.model.point import coordinates
from femstruct.language.yaml.spec import (
    Duration,
    Frequency,
    Length,
    LossFactor,
    Position2,
    Position3,
    Quantity,
    Ratio,
    Spec,
    Text,
    exactly_one,
    only,
    read_by,
    refuse,
)

_Standard = Literal["ISO 16283-2", "ISO 717-2", "JIS A 1419-2", "KS F 2863-2"]  # those of STANDARDS


_IN_AIR = "air has 343 m/s and 1.21 kg/m^3"
_Sound = Quantity(("speed",), above=0.0, least=50.0, most=2000.0, too_small=_IN_AIR, too_large=_IN_AIR)
"""From the heaviest gases (sulphur hexafluoride 134 m/s) to hydrogen, 1300 m/s, and water, 1480 m/s."""
_Fluid = Quantity(("density",), above=0.0, least=0.01, most=2000.0, too_small=_IN_AIR, too_large=_IN_AIR)
"""From air at a hundredth of an atmosphere to the heaviest liquids but metals."""


class AirSpec(Spec):
    """Speed of sound and density."""

    c: Annotated[float, _Sound] = 343.0
    rho: Annotated[float, _Fluid] = 1.21


_Seconds = Quantity(
    ("time",),
    above=0.0,
    least=1e-3,
    most=120.0,
    too_small="a plain number is in seconds: did you mean {thousandfold:g} s?",
    too_large="a plain number is in seconds: did you mean {number:g} ms?",
)
"""The longest reverberation known is 112 s at 125 Hz, in an oil tank under a hill (T. J. Cox, A. G. Kilpatrick,
J. Acoust. Soc. Am. 137 (2015) 1602, doi:10.1121/1.4908218); in a millisecond sound has gone 0.3 m."""
RoomSide = Annotated[
    float,
    Quantity(("length",), above=0.0, most=1000.0, too_large="a plain number is in metres: did you mean {number:g} mm?"),
]


def _t60(value: object) -> object:
    """One reverberation time, or one for each frequency."""
    if not isinstance(value, dict):
        return _Seconds.read(value)
    if not value:
        raise refuse(
            "no band", "a reverberation time for one band or more", "write it like {63 Hz: 0.9 s, 125 Hz: 0.8 s}"
        )
    return {Quantity(("frequency",), above=0.0).read(band): _Seconds.read(time) for band, time in value.items()}


def _absorption(value: object) -> object:
    """One absorption coefficient, or one for each frequency."""
    share = Quantity(("ratio",), least=0.0, most=MOST_ABSORBED)
    if not isinstance(value, dict):
        return share.read(value)
    if not value:
        raise refuse("no band", "an absorption coefficient for one band or more", "write it like {125 Hz: 0.1}")
    return {Quantity(("frequency",), above=0.0).read(band): share.read(alpha) for band, alpha in value.items()}


def _animated(value: object) -> object:
    """Frequencies, and the word pulse."""
    wanted = value if isinstance(value, list) and value else [value]
    return tuple(None if one == PULSE else Quantity(("frequency",), above=0.0).read(one) for one in wanted)


def _frequencies(value: object) -> object:
    wanted = value if isinstance(value, list) and value else [value]
    return tuple(Quantity(("frequency",), above=0.0).read(one) for one in wanted)


def _standards(value: object) -> object:
    wanted = value if isinstance(value, list) and value else [value]
    for one in wanted:
        only(STANDARDS)(one)
    return tuple(wanted)


class LossesSpec(Spec):
    """How sound dies away: a damping ratio or loss factor at a frequency, or a reverberation time."""

    beta: Annotated[float, Quantity(("ratio",), above=0.0, below=1.0)] | None = None
    loss_factor: LossFactor | None = None
    t60: Annotated[float | dict[float, float] | None, read_by(_t60, Duration | dict[str, Duration])] = None
    at: Frequency | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_law(cls, value: Any) -> Any:
        if isinstance(value, dict):
            exactly_one(value, ("beta", "loss_factor", "t60"))
            if ("t60" in value) == ("at" in value):
                got = "t60 with a frequency" if "at" in value else "no frequency"
                raise refuse(got, "'at' with beta or loss_factor only", "write it like {beta: 1.16 %, at: 293 Hz}")
        return value


def _receivers(value: object) -> object:
    if isinstance(value, list) and value and all(isinstance(one, list) for one in value):
        return tuple(_receivers_at(one) for one in value)
    return (_receivers_at(value),)


def _receivers_at(value: object) -> tuple[float, ...]:
    found = coordinates(value)
    if len(found) != 3:
        raise refuse(f"{len(found)} coordinates", "[x, y, z] from the room's lower corner")
    return found


Receivers = Annotated[
    tuple[tuple[float, float, float], ...],
    read_by(_receivers, Position3 | list[Position3]),
]


class LeakSpec(Spec):
    """An opening of the room to still air: its area and length, or its inertance; and its resistance to flow."""

    one_of = (("area", "inertance"),)

    area: Annotated[float, Quantity(("area",), above=0.0)] | None = None
    length: Length | None = None
    inertance: Annotated[float, Quantity(("inertance",), above=0.0)] | None = None
    resistance: Annotated[float, Quantity(("flow resistance",), least=0.0)] = 0.0

    @model_validator(mode="before")
    @classmethod
    def _plug(cls, value: Any) -> Any:
        if isinstance(value, dict) and ("area" in value) != ("length" in value):
            got = "an area without a length" if "area" in value else "a length without an area"
            raise refuse(got, "both, or an inertance", "write it like {area: 10 cm^2, length: 30 mm}")
        return value


_YIELDS = ("mass", "stiffness", "resistance")


class WallSpec(Spec):
    """What a wall absorbs: a random-incidence absorption coefficient, one or by frequency, or its impedance. Or a
    compliant wall: mass, stiffness and resistance, each per area, one or more of them. A resistance without the others
    is an impedance.
    """

    absorption: Annotated[float | dict[float, float] | None, read_by(_absorption, Ratio | dict[str, Ratio])] = None
    impedance: Annotated[float, Quantity(("specific impedance",), above=0.0)] | None = None
    mass: Annotated[float, Quantity(("mass/area",), above=0.0)] | None = None
    stiffness: Annotated[float, Quantity(("stiffness/area",), least=0.0)] = 0.0
    resistance: Annotated[float, Quantity(("specific impedance",), least=0.0)] = 0.0

    @model_validator(mode="before")
    @classmethod
    def _of_one_kind(cls, value: Any) -> Any:
        if isinstance(value, dict):
            yields = [key for key in _YIELDS if key in value][:1] or _YIELDS
            exactly_one(value, ("absorption", "impedance", *yields))
        return value

    @model_validator(mode="after")
    def _of_something(self) -> Self:
        if (self.absorption, self.impedance, self.mass) == (None, None, None) and not self.stiffness + self.resistance:
            raise refuse("a wall of no mass, no stiffness and no resistance", "one of them above 0")
        return self


class RoomModesSpec(Spec):
    """Up to which frequency the modes of a meshed room are computed."""

    up_to: Frequency


_CLOSED = ("size", "mesh", "ceiling", "walls", "modes", "at", "losses", "form", "coupling", "leak", "levels", "animate")


PULSE = "pulse"


class RoomSpec(Spec):
    """A room under a surface, and its receivers: a rectangular room by its size, any other by its mesh.

    above, below: open air in place of a room, on that side of a surface in an infinite rigid baffle. Receivers are then
    measured from the centre of the surface, global axes. The own sound of bodies with a radius there is computed too.

    mesh: a file of tetrahedra or hexahedra [m] with named surfaces, its own coordinates, z up.
    ceiling: the surface of the mesh that moves, or part of which does.
    walls: absorption or compliance of surfaces of the mesh; the others are rigid. Walls of a room with a size are
    x0, x1, y0, y1, floor and ceiling; it is then meshed with six cells a wavelength at `modes: {up_to: }`.
    modes: of a meshed room; by default up to the frequency that its mesh allows.
    at: centre of the surface in the ceiling, from the room's corner or in the mesh; by default the middle.
    coupling: one-way (the air does not react on the structure) or two-way.
    animate: a frequency, `pulse`, or a list of these: a moving picture of each.
    levels: standards for the levels of a standard source: ISO 16283-2 and ISO 717-2, or JIS A 1419-2 and KS F 2863-2.
    directivity: frequencies at which it is drawn where open air sends its sound, the loudest when left out.
    """

    one_of = (("under", "above", "below"),)
    needs = (("mesh", ("ceiling",)), ("ceiling", ("mesh",)))

    size: tuple[RoomSide, RoomSide, RoomSide] | None = None
    mesh: Text | None = None
    ceiling: Text | None = None
    walls: dict[str, WallSpec] = Field(default_factory=dict)
    modes: RoomModesSpec | None = None
    under: Text | None = None
    above: Text | None = None
    below: Text | None = None
    at: Position2 | None = None
    air: AirSpec = AirSpec()
    losses: LossesSpec | None = None
    form: Literal["causal", "source"] = "causal"
    receivers: dict[str, Receivers] = Field(default_factory=dict)
    coupling: Literal["one-way", "two-way"] = "one-way"
    leak: LeakSpec | None = None
    animate: Annotated[
        tuple[float | None, ...], read_by(_animated, Frequency | Literal["pulse"] | list[Frequency | Literal["pulse"]])
    ] = ()
    directivity: Annotated[tuple[float, ...], read_by(_frequencies, Frequency | list[Frequency])] = ()
    levels: Annotated[tuple[str, ...], read_by(_standards, _Standard | list[_Standard])] = ()

    @property
    def beside(self) -> str:
        """The key that names the surface: under, above or below."""
        return next(key for key in ("under", "above", "below") if getattr(self, key) is not None)

    @property
    def surface(self) -> str:
        """The surface that radiates."""
        return self.under or self.above or self.below or ""

    @model_validator(mode="before")
    @classmethod
    def _closed_or_open(cls, value: Any) -> Any:
        if isinstance(value, dict):
            if "under" in value:
                exactly_one(value, ("size", "mesh"))
                if "directivity" in value:
                    raise refuse(
                        "'directivity' beside 'under'", "open air, 'above' or 'below'", "a room reflects sound"
                    )
            if "size" in value and ("walls" in value) != ("modes" in value):
                got, wanted = ("walls", "modes") if "walls" in value else ("modes", "walls")
                do = (
                    "write 'modes: {up_to: 200 Hz}', up to which walls are included"
                    if wanted == "modes"
                    else f"remove '{got}'"
                )
                raise refuse(f"'{got}' of a room with a size", f"'{wanted}' beside '{got}'", do)
            side = next((key for key in ("above", "below") if key in value), None)
            closed = next((key for key in _CLOSED if key in value), None)
            if side is not None and closed is not None:
                got = f"'{closed}' beside '{side}'"
                raise refuse(got, f"air and receivers: there is no room {side} a surface", "write 'under' for a room")
        return value
