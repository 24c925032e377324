"""What rooms under a surface have in common, as it is written."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, Final, Literal

from pydantic import Field

from acoustics.errors import AcousticsError
from acoustics.fields.shaped import ShapedRoom
from acoustics.fields.sound_field import SoundField
from acoustics.levels.methods import STANDARDS, method_of, refuse_source, sources_of
from acoustics.losses import Losses
from acoustics.receivers import Receiver
from acoustics.rooms.box_two_way import Leak
from femstruct.errors import shown_as
from femstruct.impact.scene.impact_sources import BETWEEN_BLOWS, HAMMERS, TAPPING_MACHINE
from femstruct.language.rooms.losses import LossesSpec
from femstruct.language.rooms.room import Asked, RoomSpec
from femstruct.language.yaml import (
    FREQUENCY,
    Frequency,
    Here,
    Length,
    Position2,
    Quantity,
    SideLength,
    Spec,
    SurfaceName,
    exactly_one,
    read_by,
    refuse,
    several,
    word_or,
    words_of,
)
from femstruct.study.asked import FEWEST_ROOMS, RoomPlan

MOST_ROOMS: Final = 100  # each is half a second or so


def _ensemble(value: object) -> object:
    """A number of rooms: none, or so many that their spread means something."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise refuse(shown_as(value), "a whole number of rooms", "leave 'ensemble' out for 10")
    if value != 0 and not FEWEST_ROOMS <= value <= MOST_ROOMS:
        expected = f"{FEWEST_ROOMS} or more, or 0 for none" if value < FEWEST_ROOMS else f"at most {MOST_ROOMS}"
        raise refuse(f"{value} rooms", expected, "leave 'ensemble' out for 10")
    return value


def _surface(value: object) -> object:
    """The name of a surface."""
    if not isinstance(value, str):
        raise refuse(shown_as(value), "the name of a surface, or a list of them", "write it like x0: wall face")
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
    needs = (("mesh", ("ceiling",)), ("ceiling", ("mesh",)))
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

    def check_in(self, here: Here, name: str, asked: Asked) -> None:
        super().check_in(here, name, asked)
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
            self._check_levels(here, asked)
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
            not source or asked.time is None,
            "the source's form with two-way coupling in time",
            "causal",
            "leave out 'form'",
        )
        closed = {other: room for other, room in asked.rooms.items() if isinstance(room, ClosedSpec)}
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
            told = " x ".join(f"{length:g}" for length in self.size)
            here.need(inside, f"{list(place)} m", f"a point of the room, {told} m", "from its lower corner")

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

    def _check_levels(self, here: Here, asked: Asked) -> None:
        """Levels need compatible standards that rate the source, a receiver, a reverberation time to
        take out, and a sampling that has their bands."""
        there, tapping = here.at("levels"), any(body.source == TAPPING_MACHINE for body in asked.bodies)
        there.need(
            self.receivers, "levels without receivers", "at least one receiver", "add 'receivers: {mic: [x, y, z]}'"
        )
        try:
            method = method_of(self.levels, "tapping" if tapping else "heavy")
            for body in asked.bodies:
                refuse_source(self.levels, body.source or "")
        except AcousticsError as error:
            there.wrong(error.got, error.expected, error.do)
            return
        for body in asked.bodies:
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
        if asked.time is None:
            return
        least, highest, sampling = method.least_sampling_hz, method.bands_hz[-1], asked.time.sampling
        there.need(
            sampling >= least,
            f"a sampling of {sampling:g} Hz",
            f"{least:g} Hz or more for the bands up to {highest:g} Hz",
            "sample faster",
        )
        turn, duration = HAMMERS * BETWEEN_BLOWS, asked.time.duration
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
        """The room it describes; None with mistakes noted. sources, shaped : see `build`."""

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
        asked, heard = self.losses.asked if self.losses is not None else {}, tuple(receivers)
        placing, *others = moved.pop(first) if self.under is None else (self.under,)
        further = {first: tuple(others)} if others else {}
        further |= {wall: further.get(wall, ()) + names for wall, names in moved.items()}
        walls = {wall: names[0] if len(names) == 1 else names for wall, names in further.items()}
        plan = RoomPlan(name, room, placing, heard, offset, self.coupling, leak, asked, self.levels, self.animate)
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
