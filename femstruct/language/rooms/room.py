"""What every room of a study file has, open air too; its kinds stand beside, one file each."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import ConfigDict, Field

from acoustics.fields.shaped import ShapedRoom
from acoustics.receivers import Receiver
from femstruct.errors import shown_as
from femstruct.language.air import AirSpec
from femstruct.language.model.point import places
from femstruct.language.study.body import BodySpec
from femstruct.language.study.window import TimeSpec
from femstruct.language.yaml import Here, Position3, Spec, members, read_by, refuse
from femstruct.study.asked import RoomPlan


def _receivers(value: object) -> object:
    expected = "[x, y, z] from the room's lower corner"
    if not isinstance(value, list):
        raise refuse(shown_as(value), expected, "of several places write [[x, y, z], [x, y, z]]")
    found = places(value)
    for place in found:
        if len(place) != 3:
            raise refuse(f"{len(place)} coordinates", expected)
    return found


Receivers = Annotated[tuple[tuple[float, float, float], ...], read_by(_receivers, Position3 | list[Position3])]


@dataclass(frozen=True)
class Asked:
    """What a study says that its rooms depend on. powers : ROOM.power of all that are asked for."""

    time: TimeSpec | None
    bodies: Sequence[BodySpec]
    powers: Sequence[str]
    rooms: Mapping[str, RoomSpec]


def _told_by_signs(schema: dict[str, Any], kind: type[RoomSpec]) -> None:
    """Its schema fits no room of another kind: one of its signs is there."""
    if kind.signs:
        schema["anyOf"] = [{"required": [sign]} for sign in kind.signs]


class RoomSpec(Spec):
    """A room beside a surface: a kind says which keys it has and what it makes of them.

    signs : keys by which the kind is known. is_open : whether it has a sound power.
    """

    model_config = ConfigDict(json_schema_extra=_told_by_signs)
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
        heard: list[Receiver] = []
        for name, found in self.receivers.items():
            heard += [
                Receiver(one, np.array(place)) for one, place in zip(members(name, len(found)), found, strict=True)
            ]
        return heard

    def check_in(self, here: Here, name: str, asked: Asked) -> None:
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

        sources : is given a digest of its mesh's file. shaped : rooms from meshes that other cases have, by all that
        is said of them; is given this one.
        """
