"""Points as they are written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal, get_args

from femstruct.errors import shown_as
from femstruct.language.parts.part import MESHED, PartSpec
from femstruct.language.yaml import (
    LENGTH,
    Coordinate,
    Here,
    Length,
    Quantity,
    Refers,
    Spec,
    Text,
    nearest,
    read_by,
    refuse,
    so_many,
)
from femstruct.model.region import Side
from femstruct.model.structure import PlaceOn
from femstruct.units import QuantityError, quantity

AtWord = Literal["center", "top", "bottom"]
_WRITTEN = AtWord | Coordinate | list[Coordinate] | list[list[Coordinate]]


def coordinates(value: object) -> tuple[float, ...]:
    """The coordinates of one place [m]."""
    if not isinstance(value, list) or not 1 <= len(value) <= 3:
        raise refuse(shown_as(value), "a list of coordinates", "write center, [x, y] or [[x, y], [x, y]]")
    return tuple(Quantity(("length",)).read(one) for one in value)


def places(value: object) -> tuple[tuple[float, ...], ...]:
    """The coordinates of one place or of several."""
    if isinstance(value, list) and value and all(isinstance(one, list) for one in value):
        return tuple(coordinates(one) for one in value)
    return (coordinates(value),)


def _at(value: object) -> object:
    """A word, a position along a bar, [x, y], [x, y, z], or a list of positions."""
    if isinstance(value, str) and value in get_args(AtWord):
        return value
    if isinstance(value, list):
        return places(value)
    try:
        return ((quantity(value, "length"),),)
    except QuantityError as error:
        raise refuse(error.got, "center, [x, y] or [[x, y], [x, y]]", nearest(str(value), get_args(AtWord))) from None


_PATCH_MEANT = "write it like 5 mm or [20 mm, 30 mm]"
_patch = so_many(LENGTH.read, (2,), "a radius, or two sides", _PATCH_MEANT, or_one=True)
"""The radius of a disc, or the two sides of a rectangle."""


class PointSpec(Spec):
    """A named place; of a rod or beam a position along it, of an oscillator nothing. On a plate it may be a patch. Of a
    part that is a mesh it may be the mean of a set. at: of a plate or slab in its own coordinates, from its origin; of
    a block from its lower corner, its origin; of frames, meshes and matrices in global coordinates."""

    at_most_one_of = (("at", "set"),)

    on: Annotated[Text, Refers()] | None = None
    at: Annotated[AtWord | tuple[tuple[float, ...], ...], read_by(_at, _WRITTEN)] | None = None
    side: Side = "above"
    patch: Annotated[float | tuple[float, float] | None, read_by(_patch, Length | list[Length])] = None
    set: Text | None = None

    @property
    def count(self) -> int:
        """How many places it has."""
        return len(self.at) if isinstance(self.at, tuple) else 1

    def check_on(self, here: Here, parts: Mapping[str, PartSpec]) -> None:
        """Note what is wrong with it as a point on a part."""
        for key in ("on", "at") if self.set is None else ("on",):
            here.need(getattr(self, key) is not None, "nothing", f"'{key}'", f"add '{key}: ...'", of_key=True)
        if self.on is None or not here.at("on").known(self.on, "part" if self.set is None else MESHED):
            return
        part = parts[self.on]
        if self.at is not None:
            part.check_place(here.at("at"), self.at)
        here.at("patch").need(
            self.patch is None or "plate" in part.known_as,
            f"a patch on a {part.type}",
            "a patch on a plate",
            "remove it",
        )

    def place_on(self, name: str, parts: Mapping[str, PartSpec]) -> PlaceOn:
        """The place it describes."""
        on = self.on or ""
        if self.set is not None:
            return PlaceOn(name, on, (), self.side, self.patch, self.set)
        at = self.at if isinstance(self.at, tuple) else (parts[on].named_places[self.at or ""],)
        return PlaceOn(name, on, at, self.side, self.patch)
