"""The kinds of rooms a study file can have: every module here that has a `RoomSpec` with `signs` is one, what other
packages add as entry points of the group `femstruct.language.rooms`, and the box, which has no sign."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Discriminator, Tag

from femstruct.language import rooms
from femstruct.language.rooms.rectangular import BoxRoomSpec
from femstruct.language.rooms.room import RoomSpec
from femstruct.language.yaml.discovery import kinds_of, union_of

KINDS: tuple[type[RoomSpec], ...] = (*kinds_of(rooms, RoomSpec), BoxRoomSpec)


def _kind(value: Any) -> str:
    """The first kind that has a sign among the keys; else it is a box."""
    keys = value if isinstance(value, dict) else {}
    return next((one.__name__ for one in KINDS if any(sign in keys for sign in one.signs)), KINDS[-1].__name__)


if TYPE_CHECKING:
    AnyRoom = RoomSpec
else:
    AnyRoom = Annotated[union_of(Annotated[one, Tag(one.__name__)] for one in KINDS), Discriminator(_kind)]
