"""Frequency responses as they are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from femstruct.declared import Refers
from femstruct.language.not_computed import BASE_IN_TIME, FALLING_PARTS, GROUND, instead_of
from femstruct.language.rooms import RoomSpec
from femstruct.quantities import Band, Frequency, Measured, Quantity, Speed
from femstruct.study.acting import InitialMotion, RigidMotion
from femstruct.study.asked import VOLUME_VELOCITY, FrfKind, FrfRequest, Spot
from femstruct.yaml.reader import Here, nearest
from femstruct.yaml.spec import Spec, Text


def parse_spot(text: str) -> Spot:
    """An address such as ``O_s.z`` or ``ground.force``.

    >>> parse_spot("rail.2.z")
    Spot(name='rail.2', what='z')
    """
    name, _, what = text.rpartition(".")
    return Spot(name, what)


class FrfSpec(Spec):
    """A frequency response; addresses are POINT.x, NAME.force (of parts and supports with its share of the damping of
    the modes), of kind pressure ROOM.RECEIVER.pressure, or of kind
    power, sound power over the mean square of the force, ROOM.power. As a drive ROOM.RECEIVER.volume_velocity is a
    point source at that place; of kind mobility the response is velocity per volume velocity."""

    makes = FrfRequest
    drive: Text
    response: Text
    kind: FrfKind
    band: Band
    step: Frequency

    def given(self) -> dict[str, Any]:
        return {**super().given(), "drive": parse_spot(self.drive), "response": parse_spot(self.response)}

    def check_in(self, here: Here, rooms: Mapping[str, RoomSpec]) -> None:
        """Note what is wrong with its addresses, band and step."""
        (low, high), there = self.band, here.at("response")
        if self.from_room:
            self._check_source(here, rooms)
        else:
            here.at("drive").spot(self.drive, forces=True)
        if self.from_room:
            there.spot(self.response)
        elif self.kind == "power" or self.response.endswith(".power"):
            self._check_receiver(
                here,
                "power",
                [f"{name}.power" for name, room in rooms.items() if room.is_open],
                "only rooms 'above' or 'below' a surface have a power",
            )
        elif self.kind == "pressure" or self.response.endswith(".pressure"):
            self._check_receiver(
                here,
                "pressure",
                [f"{name}.{one}.pressure" for name, room in rooms.items() for one in room.listeners],
                "there are no receivers: add 'rooms:'",
            )
        else:
            there.spot(self.response, forces=True)
        if here.at("band").need(low < high, f"{low:g} to {high:g} Hz", "a rising band [low, high]"):
            step, width = here.at("step"), high - low
            step.need(width / self.step <= 1e6, f"{self.step:g} Hz", "at most a million lines", "take a wider step")
            step.need(self.step <= width, f"{self.step:g} Hz", f"at most the width of the band, {width:g} Hz")

    @property
    def from_room(self) -> bool:
        """Whether a point source in a room drives."""
        return self.drive.endswith(f".{VOLUME_VELOCITY}")

    @property
    def of_room(self) -> bool:
        """Whether a receiver or a source in a room is one of its ends."""
        return self.from_room or self.kind in ("pressure", "power")

    def _check_source(self, here: Here, rooms: Mapping[str, RoomSpec]) -> None:
        """A point source is at ROOM.RECEIVER; what it moves is a mobility, and never at 0 Hz."""
        known = [f"{name}.{one}.{VOLUME_VELOCITY}" for name, room in rooms.items() for one in room.listeners]
        here.at("drive").need(
            self.drive in known,
            f"'{self.drive}'",
            f"ROOM.RECEIVER.{VOLUME_VELOCITY}",
            nearest(self.drive, known) or "there are no receivers: add 'rooms:'",
        )
        here.at("kind").need(
            self.kind == "mobility", f"'{self.kind}' of a volume velocity", "mobility", "write 'kind: mobility'"
        )
        here.at("band").need(self.band[0] > 0.0, "0 Hz", "a band above 0 Hz")

    def _check_receiver(self, here: Here, kind: str, known: list[str], none: str) -> None:
        """A pressure is that at ROOM.RECEIVER, a power is that of an open room, ROOM.power; never at 0 Hz."""
        if here.at("kind").need(self.kind == kind, f"'{self.kind}' of a {kind}", kind, f"write 'kind: {kind}'"):
            here.at("response").need(
                self.response in known,
                f"'{self.response}'",
                "ROOM.RECEIVER.pressure" if kind == "pressure" else "ROOM.power",
                nearest(self.response, known) or none,
            )
            here.at("band").need(self.band[0] > 0.0, "0 Hz", "a band above 0 Hz")


# ----------------------------------------------------------------------------------------------------------------------
# How a structure starts, as it is written.
# ----------------------------------------------------------------------------------------------------------------------

Spin = Annotated[float, Quantity(("angular speed",))]


class RigidMotionSpec(Spec):
    """A structure that moves as a whole."""

    makes = RigidMotion
    instead = instead_of(FALLING_PARTS, "drop_height", "falls", "gravity")
    about: Annotated[Text, Refers()]
    velocity: tuple[Speed, Speed, Speed] = (0.0, 0.0, 0.0)
    spin: tuple[Spin, Spin, Spin] = (0.0, 0.0, 0.0)


class InitialSpec(Spec):
    """Start velocities of points, or of the whole structure."""

    at_most_one_of = (("velocity", "rigid"),)

    makes = InitialMotion
    instead = (
        *instead_of(FALLING_PARTS, "drop_height", "falls", "gravity"),
        *instead_of(BASE_IN_TIME, "base", "ground", "acceleration"),
    )
    velocity: dict[str, Annotated[Measured, Quantity(("speed", "angular speed"), which=True)]] | None = None
    rigid: RigidMotionSpec | None = None

    def check(self, here: Here) -> None:
        for address, measured in (self.velocity or {}).items():
            there, turns = here.at("velocity", address), address.rpartition(".")[2] in ("rx", "ry", "rz")
            if not there.need(
                not address.startswith(GROUND), f"'{address}'", "a direction of a point", BASE_IN_TIME, of_key=True
            ):
                continue
            there.spot(address, of_key=True)
            right, unit = ("angular speed", "rad/s") if turns else ("speed", "m/s")
            there.need(measured.dimension in (None, right), f"a {measured.dimension}", unit)
        if self.rigid is not None:
            here.at("rigid", "about").place(self.rigid.about)
            moves, do = any((*self.rigid.velocity, *self.rigid.spin)), "add 'velocity: [0, 0, -1 m/s]'"
            here.at("rigid").need(moves, "no velocity and no spin", "a motion", do)

    def given(self) -> dict[str, Any]:
        velocities = tuple((parse_spot(address), one.value) for address, one in (self.velocity or {}).items())
        return {"velocities": velocities, "rigid": super().given()["rigid"]}
