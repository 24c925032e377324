"""Contact laws as they are written: a class for each, found by its `type`, and what other packages add."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import Annotated, Any, Final, Literal

from pydantic import Field, ValidationInfo, field_validator

from femstruct.errors import shown_as
from femstruct.files.columns import read_columns
from femstruct.files.text_tables import beside
from femstruct.laws.cubic import Cubic
from femstruct.laws.flores import Flores
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.lankarani_nikravesh import LankaraniNikravesh
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.laws.restitution import dissipation_for
from femstruct.laws.stop import Stop
from femstruct.laws.tabulated import Tabulated
from femstruct.quantities import AnyRatio, Dashpot, Length, Modulus, Quantity, Stiffness, refuse
from femstruct.units import QuantityError, power_stiffness
from femstruct.yaml.reader import Here
from femstruct.yaml.spec import Flag, Spec, Text, read_by

# ----------------------------------------------------------------------------------------------------------------------
# What every contact law of a study file has, and what it is given to become one.
#
# A law is a module of this package with a `LawSpec` and nothing to enter anywhere else: the package finds it. d is the
# indentation, d' its rate, positive while the ends approach.
# ----------------------------------------------------------------------------------------------------------------------

Positive = Annotated[float, Quantity(("stiffness",), above=0.0)]
_PERCENT: Final = "30 % is 0.3: did you mean {number:g} %?"
HARDLY: Final = "for one that hardly returns write 'restitution: 5 %'"
STAYS: Final = (
    "for a blow that gives nothing back write '{type: linear, stiffness: .., tensile: true, restitution: 0}'; "
    f"{HARDLY}"
)
Restitution = Annotated[float, Quantity(("ratio",), above=0.0, most=1.0, too_large=_PERCENT, at_limit=STAYS)]
AnyRestitution = Annotated[
    float, Quantity(("ratio",), least=0.0, most=1.0, too_large=_PERCENT, too_small="remove the sign")
]
Exponent = Annotated[float, Quantity(("ratio",), least=1.0, most=9.0)]
MeetingSpeed = Annotated[float, Quantity(("speed",), above=0.0)]


@dataclass(frozen=True)
class Ends:
    """What a restitution needs to know of two ends: the striking mass [kg], that of a body alone or the reduced mass
    of two, None without a body; their closing speed [m/s], None where the file does not give it; their radii [m],
    infinite for what is no body, None where a body has none."""

    mass: float | None
    speed: float | None
    radii: tuple[float, float] | None


@dataclass(frozen=True)
class Site:
    """Where a law stands: its two ends, its place in the file, and the texts of the files that laws name, by their
    names, to which its own are added."""

    ends: Ends
    here: Here
    sources: dict[str, str]

    def meeting_speed(self, given: float | None) -> float | None:
        """The speed [m/s] that a restitution holds at: as given, or from the file; None with a mistake noted."""
        speed, there = given or self.ends.speed, self.here.at("restitution")
        there.need(speed, "a restitution without a meeting speed", "at_speed", "add 'at_speed: 2 m/s'")
        return speed


class LawSpec(Spec):
    """A contact law."""

    type: str
    tensile: Flag = False

    @property
    def takes_radius(self) -> bool:
        """Whether it takes the radii of the bodies it stands between."""
        return False

    def law(self, site: Site) -> Law | None:
        """The law; None with a mistake noted. Raises FemstructError for what its constructor refuses."""
        law: Law = self.noun()
        return law


class FactoredSpec(LawSpec):
    """f = s(d) (1 + chi d'): the dissipation chi, or the restitution at a speed. Without at_speed it is the speed with
    which a body placed at the other end starts."""

    at_most_one_of = (("dissipation", "restitution"),)
    needs = (("at_speed", ("restitution",)),)
    only_written = ("restitution", "at_speed")

    dissipation: Annotated[float, Quantity(("dissipation",), least=0.0)] = 0.0
    restitution: Restitution | None = None
    at_speed: MeetingSpeed | None = None

    def law(self, site: Site) -> Law | None:
        chi: float | None = self.dissipation
        if self.restitution is not None:
            speed = site.meeting_speed(self.at_speed)
            chi = None if speed is None else dissipation_for(self.restitution, speed)
        return None if chi is None else self.with_dissipation(chi, site)

    def with_dissipation(self, chi: float, site: Site) -> Law | None:
        """The law with a dissipation [s/m]; None with a mistake noted."""
        law: Law = self.noun(dissipation=chi)
        return law


class PowerSpec(LawSpec):
    """A spring k d^n; k in N/m^n, n = 1.5 unless given."""

    exponent: Exponent = 1.5
    stiffness: float

    @field_validator("stiffness", mode="before", json_schema_input_type=float | str)
    @classmethod
    def _power(cls, value: Any, info: ValidationInfo) -> Any:
        if "exponent" not in info.data:  # refused already
            return 1.0
        try:
            stiffness = power_stiffness(value, info.data["exponent"])
        except QuantityError as error:
            raise refuse(error.got, error.expected, error.do) from None
        if not stiffness > 0.0:
            raise refuse(shown_as(value), "a positive stiffness")
        return stiffness


class PublishedSpec(PowerSpec):
    """A spring k d^n whose dissipation an author gives by restitution and meeting speed."""

    only_written = ("at_speed",)

    restitution: Restitution
    at_speed: MeetingSpeed | None = None

    def law(self, site: Site) -> Law | None:
        speed = site.meeting_speed(self.at_speed)
        return None if speed is None else self.noun(speed=speed)


# ----------------------------------------------------------------------------------------------------------------------
# `type: cubic`.
# ----------------------------------------------------------------------------------------------------------------------


class CubicSpec(FactoredSpec):
    """f = (k d + k3 d^3) (1 + chi d')."""

    makes = Cubic
    type: Literal["cubic"]
    stiffness: Stiffness = 0.0
    cubic: Annotated[float, Quantity(("stiffness/area",), above=0.0)]


# ----------------------------------------------------------------------------------------------------------------------
# `type: flores`.
# ----------------------------------------------------------------------------------------------------------------------


class FloresSpec(PublishedSpec):
    """f = k d^n (1 + chi d') with the published chi = 8 (1 - e) / (5 e v): returns a little less than asked for."""

    makes = Flores
    type: Literal["flores"]


# ----------------------------------------------------------------------------------------------------------------------
# `type: hertz`.
# ----------------------------------------------------------------------------------------------------------------------


def _radii(value: object) -> object:
    """One radius, of a sphere on a flat face, or two."""
    return value if isinstance(value, list) else [value]


class HertzSpec(LawSpec):
    """f = k d^1.5 + c d^0.5 d', two rounded bodies: their stiffness, or E and nu of both and the radius (one, or two)
    where they touch, that of the bodies themselves when left out."""

    one_of = (("stiffness", "E"),)
    needs = (("radius", ("E", "nu")), ("E", ("nu",)), ("nu", ("E",)))

    type: Literal["hertz"]
    stiffness: Annotated[float, Quantity(("hertz stiffness",), above=0.0)] | None = None
    radius: (
        Annotated[
            tuple[Length, ...], Field(min_length=1, max_length=2), read_by(_radii, Length | tuple[Length, Length])
        ]
        | None
    ) = None
    E: tuple[Modulus, Modulus] | None = None
    nu: tuple[AnyRatio, AnyRatio] | None = None
    damping: Annotated[float, Quantity(("hertz damping",), least=0.0)] = 0.0

    @property
    def takes_radius(self) -> bool:
        return self.stiffness is None and self.radius is None

    def law(self, site: Site) -> Hertz | None:
        stiffness = self.stiffness
        if self.E is not None and self.nu is not None:
            radii = site.ends.radii
            if self.radius is not None:
                first, *second = self.radius
                radii = (first, second[0] if second else inf)
            if radii is None:
                site.here.wrong("a hertz law without a radius", "one", "add 'radius: 5 mm', or the radius of the body")
                return None
            stiffness = Hertz.of_spheres(radii, self.E, self.nu).stiffness
        assert stiffness is not None
        return Hertz(stiffness, self.damping, self.tensile)


# ----------------------------------------------------------------------------------------------------------------------
# `type: hunt-crossley`.
# ----------------------------------------------------------------------------------------------------------------------


class HuntCrossleySpec(PowerSpec, FactoredSpec):
    """f = k d^n (1 + chi d'), exactly the restitution asked for; k in N/m^n, n = 1.5 unless given."""

    makes = HuntCrossley
    type: Literal["hunt-crossley"]


# ----------------------------------------------------------------------------------------------------------------------
# `type: lankarani-nikravesh`.
# ----------------------------------------------------------------------------------------------------------------------


class LankaraniNikraveshSpec(PublishedSpec):
    """f = k d^n (1 + chi d') with the published chi = 3 (1 - e^2) / (4 v): for restitutions near 1 only."""

    makes = LankaraniNikravesh
    type: Literal["lankarani-nikravesh"]


# ----------------------------------------------------------------------------------------------------------------------
# `type: linear`.
# ----------------------------------------------------------------------------------------------------------------------


class LinearSpec(LawSpec):
    """f = k d + c d', spring and dashpot side by side (Kelvin and Voigt): k and c, or the restitution with k or with
    the duration of the contact. These count for the body alone against a wall, two bodies by their reduced mass. With
    tensile: true the restitution may be 0: nothing is given back, and the ends part only where something else pulls
    them apart, as a plate that swings back faster than a body falls."""

    one_of = (("stiffness", "duration"),)
    at_most_one_of = (("damping", "restitution"),)
    needs = (("duration", ("restitution",)),)

    type: Literal["linear"]
    stiffness: Positive | None = None
    damping: Dashpot = 0.0
    restitution: AnyRestitution | None = None
    duration: Annotated[float, Quantity(("time",), above=0.0)] | None = None

    def law(self, site: Site) -> Linear | None:
        if self.restitution is None:
            assert self.stiffness is not None
            return Linear(self.stiffness, self.damping, self.tensile)
        if site.ends.mass is None:
            site.here.at("restitution").wrong("a restitution between two ends without a body", "stiffness and damping")
            return None
        if not self.restitution:
            there = site.here.at("restitution")
            if not self.tensile:
                there.wrong(
                    "0 of a contact that does not pull",
                    "a positive value",
                    f"for a blow that gives nothing back write 'tensile: true' beside it; {HARDLY}",
                )
                return None
            if self.stiffness is None:
                there.wrong(
                    "0 with a duration", "a stiffness: ends that stay together do not part", "write 'stiffness'"
                )
                return None
        return Linear.returning(self.restitution, site.ends.mass, self.duration, self.stiffness, self.tensile)


# ----------------------------------------------------------------------------------------------------------------------
# `type: stop`.
# ----------------------------------------------------------------------------------------------------------------------


class StopSpec(LawSpec):
    """A bumper on both sides."""

    makes = Stop
    type: Literal["stop"]
    stiffness: Positive
    damping: Dashpot = 0.0


# ----------------------------------------------------------------------------------------------------------------------
# `type: table`.
# ----------------------------------------------------------------------------------------------------------------------

Depth = Annotated[float, Quantity(("length",), least=0.0)]
Push = Annotated[float, Quantity(("force",), least=0.0)]


class TableSpec(FactoredSpec):
    """f = s(d) (1 + chi d') through measured points: [[indentation, force], ...], or a CSV file of these columns.
    Between them are straight lines; with 'smooth: true' a curve of continuous slope (monotone cubics, PCHIP)."""

    one_of = (("curve", "file"),)

    type: Literal["table"]
    curve: Annotated[list[tuple[Depth, Push]], Field(min_length=2)] | None = None
    file: Text | None = None
    smooth: bool = False

    def with_dissipation(self, chi: float, site: Site) -> Tabulated | None:
        points, file = self.curve, site.here.at("file")
        if points is not None:
            columns: Any = zip(*points, strict=True)
            curve = site.here.at("curve").make(lambda: Tabulated(*columns))
        else:
            name, ends = self.file or "", ("length", "force")
            curve = file.make(lambda: read_columns(beside(file.tree.file, name), ends, site.sources, Tabulated))
        return None if curve is None else replace(curve, dissipation=chi, tensile=self.tensile, smooth=self.smooth)
