"""Rooms as they are written: a class for each kind, found by the keys that only it has, and what other packages add."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, ClassVar, Final, Literal, Self

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.half_space import HalfSpace
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from acoustics.fields.sound_field import SoundField
from acoustics.levels.standards import STANDARDS, method_of, refuse_source, sources_of
from acoustics.losses import Losses, losses_from_beta, losses_from_loss_factor, losses_from_t60, losses_from_t60_bands
from acoustics.meshed.cavity_mesh import CavityMesh
from acoustics.meshed.finite_elements import cut_box, probe
from acoustics.meshed.meshed_coupling import HELD
from acoustics.meshed.walls import MOST_ABSORBED, AnyWall, Wall, YieldingWall, absorbing
from acoustics.receivers import Receiver
from acoustics.rooms.box_coupling import Leak
from femstruct.declared import exactly_one
from femstruct.errors import quote_value
from femstruct.files.cavity_meshes import read_mesh
from femstruct.files.text_tables import beside
from femstruct.impact.scene import BETWEEN_BLOWS, HAMMERS, TAPPING_MACHINE
from femstruct.language.bodies import BodySpec
from femstruct.language.materials import AirSpec
from femstruct.language.structures import places
from femstruct.language.window import TimeSpec
from femstruct.quantities import (
    FREQUENCY,
    Duration,
    Frequency,
    Length,
    LossFactor,
    Position2,
    Position3,
    Quantity,
    Ratio,
    SideLength,
    refuse,
)
from femstruct.study.asked import FEWEST_ROOMS, RoomPlan
from femstruct.yaml.reader import Here, members, nearest
from femstruct.yaml.spec import (
    BandFile,
    Spec,
    SurfaceName,
    Text,
    by_band,
    read_by,
    several,
    word_or,
    words_of,
)

# ----------------------------------------------------------------------------------------------------------------------
# Losses of a room and absorption of its walls, as they are written.
# ----------------------------------------------------------------------------------------------------------------------

SCALE_HZ: Final = 1000.0  # a wall's one admittance is the same at all frequencies: this is as good as any
_SECONDS: Final = Quantity(
    ("time",),
    above=0.0,
    least=1e-3,
    most=120.0,
    too_small="a plain number is in seconds: did you mean {thousandfold:g} s?",
    too_large="a plain number is in seconds: did you mean {number:g} ms?",
)
"""The longest reverberation known is 112 s at 125 Hz, in an oil tank under a hill (T. J. Cox, A. G. Kilpatrick,
J. Acoust. Soc. Am. 137 (2015) 1602, doi:10.1121/1.4908218); in a millisecond sound has gone 0.3 m."""
_SHARE: Final = Quantity(("ratio",), least=0.0, most=MOST_ABSORBED)
_t60 = by_band(_SECONDS, "a reverberation time for one band or more", "write it like {63 Hz: 0.9 s, 125 Hz: 0.8 s}")
_absorption = by_band(_SHARE, "an absorption coefficient for one band or more", "write it like {125 Hz: 0.1}")
ByBand = float | dict[float, float] | None
SpecificImpedance = Quantity(("specific impedance",), least=0.0)


class LossesSpec(Spec):
    """How sound dies away: a damping ratio or loss factor at a frequency, or a reverberation time."""

    short = "t60"
    beta: Annotated[float, Quantity(("ratio",), above=0.0, below=1.0)] | None = None
    loss_factor: LossFactor | None = None
    t60: Annotated[ByBand, read_by(_t60, Duration | BandFile | dict[str, Duration])] = None
    at: Frequency | None = None

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        exactly_one(given, ("beta", "loss_factor", "t60"))
        if ("t60" in given) == ("at" in given):
            raise refuse(
                "t60 with a frequency" if "at" in given else "no frequency",
                "'at' with beta or loss_factor only",
                "write it like {beta: 1.16 %, at: 293 Hz}",
            )

    @property
    def asked(self) -> dict[float, float]:
        """The reverberation times that are given by bands."""
        return self.t60 if isinstance(self.t60, dict) else {}

    @property
    def shortest(self) -> float | None:
        """The shortest reverberation time that is given [s]."""
        return min(self.asked.values()) if isinstance(self.t60, dict) else self.t60

    def losses(self, form: Literal["causal", "source"]) -> Losses:
        """The losses it describes."""
        if isinstance(self.t60, dict):
            return losses_from_t60_bands(self.t60)
        if self.t60 is not None:
            return losses_from_t60(self.t60)
        at = self.at or 0.0
        if self.beta is not None:
            return losses_from_beta(self.beta, at, form)
        return losses_from_loss_factor(self.loss_factor or 0.0, at, form)


class WallSpec(Spec):
    """What a wall absorbs: a random-incidence absorption coefficient, one or by frequency, or its impedance. Or a
    compliant wall: mass, stiffness and resistance, each per area, one or more of them. A resistance without the others
    is an impedance.
    """

    absorption: Annotated[ByBand, read_by(_absorption, Ratio | BandFile | dict[str, Ratio])] = None
    impedance: Annotated[float, Quantity(("specific impedance",), above=0.0)] | None = None
    mass: Annotated[float, Quantity(("mass/area",), above=0.0)] | None = None
    stiffness: Annotated[float, Quantity(("stiffness/area",), least=0.0)] = 0.0
    resistance: Annotated[float, SpecificImpedance] = 0.0

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        alternatives = ("mass", "stiffness", "resistance")
        exactly_one(
            given, ("absorption", "impedance", *([key for key in alternatives if key in given][:1] or alternatives))
        )

    @model_validator(mode="after")
    def _of_something(self) -> Self:
        if (self.absorption, self.impedance, self.mass) == (None, None, None) and not self.stiffness + self.resistance:
            raise refuse("a wall of no mass, no stiffness and no resistance", "one of them above 0")
        return self

    @property
    def absorbs(self) -> bool:
        """Whether it takes up sound."""
        most = max(self.absorption.values()) if isinstance(self.absorption, dict) else self.absorption
        return bool(most or self.impedance or self.resistance)

    def wall(self, air: Air) -> AnyWall:
        """The wall it describes."""
        if self.mass is not None or self.stiffness > 0:
            return YieldingWall(self.mass or 0.0, self.stiffness, self.resistance)
        if self.absorption is None:
            return Wall({SCALE_HZ: air.rho * air.c / (self.impedance or self.resistance)})
        return absorbing(self.absorption)


# ----------------------------------------------------------------------------------------------------------------------
# What every room of a study file has, open air too; its kinds follow.
# ----------------------------------------------------------------------------------------------------------------------


def _receivers(value: object) -> object:
    expected = "[x, y, z] from the room's lower corner"
    if not isinstance(value, list):
        raise refuse(quote_value(value), expected, "of several places write [[x, y, z], [x, y, z]]")
    found = places(value)
    for place in found:
        if len(place) != 3:
            raise refuse(f"{len(place)} coordinates", expected)
    return found


Receivers = Annotated[tuple[tuple[float, float, float], ...], read_by(_receivers, Position3 | list[Position3])]


@dataclass(frozen=True)
class StudyRequests:
    """What a study says that its rooms depend on. powers : ROOM.power of all that are asked for."""

    time: TimeSpec | None
    bodies: Sequence[BodySpec]
    powers: Sequence[str]
    rooms: Mapping[str, RoomSpec]


def _require_a_sign(schema: dict[str, Any], kind: type[RoomSpec]) -> None:
    """Its schema fits no room of another kind: one of its signs is there."""
    if kind.signs:
        schema["anyOf"] = [{"required": [sign]} for sign in kind.signs]


class RoomSpec(Spec):
    """A room beside a surface: a kind says which keys it has and what it makes of them.

    signs : keys by which the kind is known. is_open : whether it has a sound power.
    """

    model_config = ConfigDict(json_schema_extra=_require_a_sign)
    signs: ClassVar[tuple[str, ...]] = ()
    is_open: ClassVar[bool] = False

    air: AirSpec = AirSpec()
    receivers: dict[str, Receivers] = Field(default_factory=dict)

    @property
    def standards(self) -> tuple[str, ...]:
        """Standards by which its levels are stated."""
        return ()

    @property
    def listeners(self) -> list[str]:
        """The names of all receivers: NAME, or NAME.1, NAME.2, ... of several places."""
        return [receiver.name for receiver in self.heard_at()]

    def heard_at(self) -> list[Receiver]:
        """The receivers it has."""
        receivers: list[Receiver] = []
        for name, found in self.receivers.items():
            receivers += [
                Receiver(one, np.array(place)) for one, place in zip(members(name, len(found)), found, strict=True)
            ]
        return receivers

    def check_in(self, here: Here, name: str, requests: StudyRequests) -> None:
        """Note what is wrong with it in a study."""
        self.air.check(here.at("air"))
        for receiver, found in self.receivers.items():
            for place in found:
                self.check_receiver(here.at("receivers", receiver), place)

    def check_receiver(self, here: Here, place: tuple[float, float, float]) -> None:
        """Note a receiver at an impossible place."""

    @abstractmethod
    def build(self, here: Here, name: str, sources: dict[str, str], shaped: dict[str, ShapedRoom]) -> RoomPlan | None:
        """The room with its receivers; None with mistakes noted.

        Parameters
        ----------
        sources : dict[str, str]
            Is given a digest of its mesh's file.
        shaped : dict[str, ShapedRoom]
            Rooms from meshes that other cases have, by all that is said of them; is given this one.
        """


# ----------------------------------------------------------------------------------------------------------------------
# What rooms under a surface have in common, as it is written.
# ----------------------------------------------------------------------------------------------------------------------

MOST_ROOMS: Final = 100  # each is half a second or so


def _ensemble(value: object) -> object:
    """A number of rooms: none, or so many that their spread means something."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise refuse(quote_value(value), "a whole number of rooms", "leave 'ensemble' out for 10")
    if value != 0 and not FEWEST_ROOMS <= value <= MOST_ROOMS:
        expected = f"{FEWEST_ROOMS} or more, or 0 for none" if value < FEWEST_ROOMS else f"at most {MOST_ROOMS}"
        raise refuse(f"{value} rooms", expected, "leave 'ensemble' out for 10")
    return value


def _surface(value: object) -> object:
    """The name of a surface."""
    if not isinstance(value, str):
        raise refuse(quote_value(value), "the name of a surface, or a list of them", "write it like x0: wall face")
    return value


SurfaceNames = Annotated[tuple[SurfaceName, ...], read_by(several(_surface), SurfaceName | list[SurfaceName])]
Size = tuple[SideLength, SideLength, SideLength]
_Animated = Frequency | Literal["pulse"]
_animated = several(word_or({"pulse": None}, FREQUENCY))


class LeakSpec(Spec):
    """An opening of the room to still air: its area and length, or its inertance; and its resistance to flow."""

    one_of = (("area", "inertance"),)

    area: Annotated[float, Quantity(("area",), above=0.0)] | None = None
    length: Length | None = None
    inertance: Annotated[float, Quantity(("inertance",), above=0.0)] | None = None
    resistance: Annotated[float, Quantity(("flow resistance",), least=0.0)] = 0.0

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        if ("area" in given) != ("length" in given):
            raise refuse(
                "an area without a length" if "area" in given else "a length without an area",
                "both, or an inertance",
                "write it like {area: 10 cm^2, length: 30 mm}",
            )

    def leak(self, rho: float) -> Leak:
        """The leak it describes, of air of a density [kg/m^3]."""
        plug = rho * (self.length or 0.0) / (self.area or 1.0)
        return Leak(plug if self.inertance is None else self.inertance, self.resistance)


_LEVELS: Final = "; ".join(f"{one}: of a {' or a '.join(sources_of([one]))}" for one in STANDARDS)


class ClosedSpec(RoomSpec):
    """A room under a surface, or among several."""

    one_of = (("size", "mesh"),)
    only_with = (("mesh", ("ceiling",)), ("ceiling", ("mesh",)))
    refused = ("directivity",)

    size: Size | None = None
    under: SurfaceName | None = None
    surfaces: dict[str, SurfaceNames] = Field(default_factory=dict)
    at: Position2 | None = None
    losses: LossesSpec | None = None
    form: Literal["causal", "source"] = "causal"
    coupling: Literal["one-way", "two-way"] = "one-way"
    leak: LeakSpec | None = None
    animate: Annotated[tuple[float | None, ...], read_by(_animated, _Animated | list[_Animated])] = ()
    levels: Annotated[tuple[str, ...], words_of(STANDARDS)] = Field(default=(), description=_LEVELS)
    beyond_modes: Literal["statistical", "blank"] = "statistical"
    ensemble: Annotated[int, read_by(_ensemble, Annotated[int, Field(ge=0, le=MOST_ROOMS)])] = 10

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        if "directivity" in given:
            raise refuse("'directivity' beside 'under'", "open air, 'above' or 'below'", "a room reflects sound")
        exactly_one(given, ("under", "above", "below"), or_none=True)
        if not any(given.get(key) for key in ("under", "above", "below", "surfaces")):
            expected = "exactly one of under, above, below, or surfaces"
            raise refuse("none of under, above, below", expected, "add 'under: SURFACE'")

    @property
    def moved(self) -> set[str]:
        """All surfaces that move its air."""
        named = {name for names in self.surfaces.values() for name in names}
        return named | ({self.under} if self.under is not None else set())

    @property
    def standards(self) -> tuple[str, ...]:
        return self.levels

    @property
    def takes_up_sound(self) -> bool:
        """Whether it has a reverberation time."""
        return self.losses is not None

    def losses_of(self) -> Losses:
        """The losses it describes."""
        return self.losses.losses(self.form) if self.losses is not None else Losses()

    def check_in(self, here: Here, name: str, requests: StudyRequests) -> None:
        super().check_in(here, name, requests)
        form, t60 = here.at("form"), self.losses is not None and self.losses.t60 is not None
        source = self.form == "source"
        form.need(not (source and t60), "the source's form with t60", "beta or loss_factor", "leave out 'form'")
        here.at("animate").need(
            self.receivers or not self.animate,
            "a moving picture without receivers",
            "a receiver to cut the room at",
            "add 'receivers:'",
        )
        if self.levels:
            self._check_levels(here, requests)
        self._check_sound_crosses(here)
        here.at("beyond_modes").need(
            self.levels or self.beyond_modes == "statistical",
            "'beyond_modes' in a room without levels",
            "a room that is rated",
            "add 'levels: [ISO 16283-2, ISO 717-2]'",
            of_key=True,
        )
        if self.coupling == "one-way":
            here.at("leak").need(
                self.leak is None, "a leak with one-way coupling", "coupling: two-way", "add it", of_key=True
            )
            return
        form.need(
            not source or requests.time is None,
            "the source's form with two-way coupling in time",
            "causal",
            "leave out 'form'",
        )
        closed = {other: room for other, room in requests.rooms.items() if isinstance(room, ClosedSpec)}
        both = {other: room for other, room in closed.items() if room.coupling == "two-way"}
        others = [other for other, room in both.items() if room.moved & self.moved]
        if others[0] == name:
            return
        shared = sorted(both[others[0]].moved & self.moved)[0]
        here.at("under" if shared == self.under else "surfaces").wrong(
            f"'{shared}', which '{others[0]}' with two-way coupling is under already",
            "another surface",
            "one of the two can be one-way",
        )

    def check_receiver(self, here: Here, place: tuple[float, ...]) -> None:
        """Note a receiver that is not in a box."""
        if self.size is not None:
            inside = all(0 <= x <= length for x, length in zip(place, self.size, strict=True))
            size = " x ".join(f"{length:g}" for length in self.size)
            here.need(inside, f"{list(place)} m", f"a point of the room, {size} m", "from its lower corner")

    def _check_sound_crosses(self, here: Here) -> None:
        """Sound of a box goes from wall to wall at least once while it dies away."""
        shortest = self.losses.shortest if self.losses is not None else None
        if self.size is None or shortest is None:
            return
        x, y, z = self.size
        between = 4.0 * x * y * z / (2.0 * (x * y + y * z + z * x)) / self.air.c
        here.at("losses", "t60").need(
            shortest >= between,
            f"{1e3 * shortest:g} ms, less than sound takes from wall to wall, {1e3 * between:.2g} ms",
            "a reverberation time: sound falls by 60 dB in it",
            f"did you mean {1e3 * shortest:g} s?",
        )

    def _check_levels(self, here: Here, requests: StudyRequests) -> None:
        """Levels need compatible standards that rate the source, a receiver, a reverberation time to
        take out, and a sampling that has their bands."""
        there, tapping = here.at("levels"), any(body.source == TAPPING_MACHINE for body in requests.bodies)
        there.need(
            self.receivers, "levels without receivers", "at least one receiver", "add 'receivers: {mic: [x, y, z]}'"
        )
        try:
            method = method_of(self.levels, "tapping" if tapping else "heavy")
            for body in requests.bodies:
                refuse_source(self.levels, body.source or "")
        except AcousticsError as error:
            there.wrong(error.got, error.expected, error.do)
            return
        for body in requests.bodies:
            covering = body.covering if tapping else None
            missing = covering.missing(method.bands_hz) if covering is not None else []
            there.need(
                not missing,
                f"a covering without a reduction at {missing[0]:g} Hz" if missing else "",
                f"one in every {method.bands} that is rated, {method.bands_hz[0]:g} to {method.bands_hz[-1]:g} Hz",
                "add it to 'covering.reduction'",
            )
        there.need(
            method.correct is None or self.takes_up_sound,
            f"{method.measured_by} in a room without losses",
            "its reverberation time",
            "add 'losses: {t60: 0.5 s}'",
        )
        if requests.time is None:
            return
        least, highest, sampling = method.least_sampling_hz, method.bands_hz[-1], requests.time.sampling
        there.need(
            sampling >= least,
            f"a sampling of {sampling:g} Hz",
            f"{least:g} Hz or more for the bands up to {highest:g} Hz",
            "sample faster",
        )
        turn, duration = HAMMERS * BETWEEN_BLOWS, requests.time.duration
        here.outside(2).at("time", "duration").need(
            not tapping or duration >= turn,
            f"a tapping machine for {duration:g} s",
            f"{turn:g} s or more: one turn of its five hammers",
            "simulate longer",
        )

    @abstractmethod
    def room(
        self, here: Here, receivers: list[Receiver], sources: dict[str, str], shaped: dict[str, ShapedRoom]
    ) -> SoundField | None:
        """The room it describes; None with mistakes noted.

        Parameters
        ----------
        sources, shaped : dict[str, str], dict[str, ShapedRoom]
            See `build`.
        """

    def build(self, here: Here, name: str, sources: dict[str, str], shaped: dict[str, ShapedRoom]) -> RoomPlan | None:
        receivers = self.heard_at()
        room = self.room(here, receivers, sources, shaped)
        if room is None:
            return None
        for wall in self.surfaces:
            here.at("surfaces", wall).make(partial(room.on_wall, wall))
        if not all(wall in room.movable for wall in self.surfaces):
            return None
        first, moved = self._placing(room)
        offset = (0.0, 0.0)
        if self.at is not None:
            middle = room.middle_of(first)[room.along(first)].tolist()
            offset = (self.at[0] - middle[0], self.at[1] - middle[1])
        leak = self.leak.leak(self.air.rho) if self.leak is not None else None
        t60, places = self.losses.asked if self.losses is not None else {}, tuple(receivers)
        placing, *others = moved.pop(first) if self.under is None else (self.under,)
        further = {first: tuple(others)} if others else {}
        further |= {wall: further.get(wall, ()) + names for wall, names in moved.items()}
        walls = {wall: names[0] if len(names) == 1 else names for wall, names in further.items()}
        plan = RoomPlan(
            name,
            room,
            under=placing,
            receivers=places,
            offset=offset,
            coupling=self.coupling,
            leak=leak,
            t60_asked=t60,
            levels=self.levels,
            animate=self.animate,
        )
        made = replace(
            plan,
            walls=walls,
            beyond_modes=self.beyond_modes,
            ensemble=self.ensemble,
            on=first if self.under is None and first != room.movable[0] else "",
        )
        here.at("ensemble").need(
            "ensemble" not in self.model_fields_set or not self.ensemble or not made.why_no_ensemble,
            f"an ensemble, and {made.why_no_ensemble}",
            "none",
            "remove 'ensemble', or write 0",
            of_key=True,
        )
        return made

    def _placing(self, room: SoundField) -> tuple[str, dict[str, tuple[str, ...]]]:
        """The wall whose first surface places the room, and all that `surfaces` names."""
        ceiling = room.movable[0]
        named = dict(self.surfaces)
        return (ceiling if self.under is not None or ceiling in named else next(iter(named))), named


# ----------------------------------------------------------------------------------------------------------------------
# Open air beside a surface as it is written.
# ----------------------------------------------------------------------------------------------------------------------

_CLOSED: Final = (
    "size", "mesh", "ceiling", "walls", "modes", "at", "losses", "form", "coupling", "leak", "levels", "animate",
    "surfaces",
)  # fmt: skip


class HalfSpaceSpec(RoomSpec):
    """Open air in place of a room, and its receivers.

    above, below: the surface in an infinite rigid baffle beside which it is. Receivers are measured from the centre of
    the surface, global axes. The own sound of bodies with a radius there is computed too.
    directivity: frequencies at which it is drawn where open air sends its sound, the loudest when left out.
    """

    one_of = (("under", "above", "below"),)
    signs = ("above", "below")
    is_open: ClassVar[bool] = True
    refused = (*_CLOSED, "under")

    above: SurfaceName | None = None
    below: SurfaceName | None = None
    directivity: Annotated[tuple[float, ...], read_by(several(FREQUENCY.read), Frequency | list[Frequency])] = ()

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        side = "above" if "above" in given else "below"
        for key in [key for key in _CLOSED if key in given][:1]:
            expected = f"air and receivers: there is no room {side} a surface"
            raise refuse(f"'{key}' beside '{side}'", expected, "write 'under' for a room")

    def check_in(self, here: Here, name: str, requests: StudyRequests) -> None:
        """A directivity is of something that radiates, at frequencies that the sampling has."""
        super().check_in(here, name, requests)
        if self.directivity:
            there, moves = here.at("directivity"), requests.time is not None or f"{name}.power" in requests.powers
            there.need(
                moves,
                "a directivity of nothing that moves",
                "a simulation or a power",
                f"add 'time:', or a response of 'kind: power' to '{name}.power'",
            )
            if requests.time is not None:
                requests.time.carries(there, max(self.directivity))

    def check_receiver(self, here: Here, place: tuple[float, float, float]) -> None:
        side = "below" if self.above is None else "above"
        here.need(
            (place[2] > 0) == (self.above is not None),
            f"{list(place)} m",
            f"a point {side} the surface",
            "measure from the surface's centre, z up",
        )

    def build(self, here: Here, name: str, sources: dict[str, str], shaped: dict[str, ShapedRoom]) -> RoomPlan:
        space = HalfSpace(self.air.noun(), np.array([0.0, 0.0, 1.0 if self.above else -1.0]))
        surface = self.above or self.below or ""
        return RoomPlan(name, space, surface, tuple(self.heard_at()), directivity=self.directivity)


# ----------------------------------------------------------------------------------------------------------------------
# Rectangular rooms as they are written.
# ----------------------------------------------------------------------------------------------------------------------


class BoxRoomSpec(ClosedSpec):
    """A rectangular room under a surface, and its receivers.

    at: centre of the surface in the ceiling, from the room's corner; by default the middle.
    surfaces: further surfaces of the structure, by the wall of the room that they move: here its ceiling alone.
    coupling: one-way (the air does not react on the structure) or two-way.
    animate: a frequency, `pulse`, or a list of these: a moving picture of each.
    levels: standards for the levels of a standard source: ISO 16283-2 and ISO 717-2, or JIS A 1419-2 and KS F 2863-2.
    ensemble: rooms with sides within 5 %, places of source and microphones drawn anew, over which low rated bands have
        a mean and an interval; 0 for none.
    beyond_modes: what rated bands have that the modes do not reach: statistical (the default), levels of statistical
        energies, which a single bare plate has, or blank.
    """

    size: Size

    def room(self, here: Here, receivers: Any, sources: Any, shaped: Any) -> Room:
        return Room(np.array(self.size), self.air.noun(), self.losses_of())


# ----------------------------------------------------------------------------------------------------------------------
# Rooms of any shape as they are written, and boxes with walls, which are cut into cells.
# ----------------------------------------------------------------------------------------------------------------------


class RoomModesSpec(Spec):
    """Up to which frequency the modes of a meshed room are computed."""

    up_to: Frequency


class MeshedRoomSpec(ClosedSpec):
    """A room of any shape under a surface by its mesh, or a rectangular one with walls, and its receivers.

    mesh: a file of tetrahedra or hexahedra [m] with named surfaces, its own coordinates, z up.
    ceiling: the surface of the mesh that moves, or part of which does.
    walls: absorption or compliance of surfaces of the mesh; the others are rigid. Walls of a room with a size are
    x0, x1, y0, y1, floor and ceiling; it is then meshed with six cells a wavelength at `modes: {up_to: }`.
    modes: of a meshed room; by default up to the frequency that its mesh allows.
    at: centre of the surface in the ceiling, from the room's corner or in the mesh; by default the middle.
    surfaces: further surfaces of the structure, by the wall of the room that they move.
    coupling, animate, levels: as of a rectangular room.
    """

    signs = ("mesh", "ceiling", "walls", "modes")

    mesh: Text | None = Field(default=None, description="a file of tetrahedra or hexahedra [m]")
    ceiling: Text | None = None
    walls: dict[str, WallSpec] = Field(default_factory=dict)
    modes: RoomModesSpec | None = None

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        super().refuse_keys(given)
        got, needed, do = "modes", "walls", "remove 'modes'"
        if "walls" in given:
            got, needed, do = "walls", "modes", "write 'modes: {up_to: 200 Hz}', up to which walls are included"
        if "size" in given and ("walls" in given) != ("modes" in given):
            raise refuse(f"'{got}' of a room with a size", f"'{needed}' beside '{got}'", do)

    @property
    def takes_up_sound(self) -> bool:
        return super().takes_up_sound or any(wall.absorbs for wall in self.walls.values())

    def check_in(self, here: Here, name: str, requests: StudyRequests) -> None:
        here.at("form").need(self.form == "causal", "the source's form in a meshed room", "causal", "leave out 'form'")
        super().check_in(here, name, requests)

    def room(
        self, here: Here, receivers: list[Receiver], sources: dict[str, str], shaped: dict[str, ShapedRoom]
    ) -> ShapedRoom | None:
        """The room that another case has where all that is said of it is the same, else a new one."""
        shape = self.model_dump(include={"size", "mesh", "ceiling", "walls", "modes", "air", "losses"})
        key = repr((here.tree.file, shape))
        room = shaped[key] if key in shaped else self._new(here, sources)
        if room is None or not (self._all_inside(here, room, receivers) and self._held(here)):
            return None
        shaped[key] = room
        return room

    def _new(self, here: Here, sources: dict[str, str]) -> ShapedRoom | None:
        mesh, ceiling, air = self._cells(here, sources), self.ceiling or "ceiling", self.air.noun()
        if mesh is None:
            return None
        named = [(ceiling, here.at("ceiling")), *((wall, here.at("walls", wall)) for wall in self.walls)]
        for wall, there in named:
            if wall not in mesh.walls:
                known = ", ".join(mesh.walls) or "a mesh with named surfaces"
                missing = f"no surface of '{self.mesh}'" if self.mesh else "no wall of a room with a size"
                there.wrong(f"'{wall}', {missing}", known, nearest(wall, list(mesh.walls)))
                return None
        walls = {wall: one.wall(air) for wall, one in self.walls.items()}
        up_to = self.modes.up_to if self.modes is not None else None
        at_fault = here.at("walls" if self.ceiling is None else "ceiling")
        return at_fault.make(lambda: ShapedRoom(mesh, ceiling, air, self.losses_of(), walls, up_to))

    def _cells(self, here: Here, sources: dict[str, str]) -> CavityMesh | None:
        """The mesh of its file, or a box cut into cells; None with mistakes noted."""
        if self.size is not None:
            size, most, air = np.array(self.size), self.modes.up_to if self.modes is not None else 0.0, self.air.noun()
            return here.at("modes", "up_to").make(lambda: cut_box(size, most, air))
        return here.at("mesh").make(lambda: read_mesh(beside(here.tree.file, self.mesh or ""), sources))

    def _held(self, here: Here) -> bool:
        """Whether compliant walls have a stiffness where coupling is two-way; notes those without."""
        loose = [wall for wall, one in self.walls.items() if one.mass is not None and one.stiffness == 0.0]
        for wall in loose if self.coupling == "two-way" else ():
            here.at("walls", wall).wrong("a mass without a stiffness", HELD)
        return not loose or self.coupling == "one-way"

    def _all_inside(self, here: Here, room: ShapedRoom, receivers: list[Receiver]) -> bool:
        """Whether all receivers are in the mesh; notes those that are not."""
        sound = True
        for receiver in receivers:
            try:
                probe(room.mesh, receiver.position[None, :])
            except AcousticsError as error:
                here.at(
                    "receivers",
                    receiver.name if receiver.name in self.receivers else receiver.name.rpartition(".")[0],
                ).wrong(f"{receiver.position.tolist()} m, a point outside the mesh", error.expected)
                sound = False
        return sound
