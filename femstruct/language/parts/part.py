"""What a part of a model file is to the language; its kinds stand beside, one file each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Final

from femstruct.errors import FemstructError
from femstruct.language.not_computed import FALLING_PARTS, instead_of
from femstruct.language.yaml import Here, Refers, Spec, Text
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.part import Part
from femstruct.model.section import Section

COORDINATE_ROUNDING = 1e-9  # of a side: what a coordinate written in decimals may be off the edge
Places = str | tuple[tuple[float, ...], ...]
"""Where a point is, as it is written: center, top, bottom, or coordinates [m]."""
STRESSED: Final = "part with stresses"
MaterialName = Annotated[Text, Refers("material")]
MESHED: Final = "part that is a mesh"  # of a file: it has sets
FLOOR, CEILING = "plate, slab, block or frame", "plate or slab"  # what hangers are between
SectionName = Annotated[Text, Refers("section")]


@dataclass(frozen=True)
class Library:
    """What parts are made of, by name, and the model file, from whose folder they name others. sources : is given the
    digests of those."""

    materials: Mapping[str, AnyMaterial]
    sections: Mapping[str, Section]
    file: str = ""
    sources: dict[str, str] = field(default_factory=dict)


class PartSpec(Spec):
    """A part: a kind says what its keys are and which noun it `makes` of them.

    known_as : as what other names in the file find it: a part has nodes to join, hold and point at; on the edges and
    areas of a plate supports can be; surfaces are on a plate or shell; layers lie against a plate, slab or block;
    hangers are between a plate, slab, block or frame and a plate or slab; masses are spread along or over a plate or
    frame; a part that is a mesh has named sets; stresses can be recorded of a part with stresses.
    """

    known_as: ClassVar[tuple[str, ...]] = ()
    instead = instead_of(FALLING_PARTS, "drop_height", "falls", "gravity", "speed", "velocity")
    type: str

    def build(self, name: str, of: Library) -> Part:
        """The noun it describes."""
        return self.made_of(name, of)

    def made_of(self, name: str, of: Library, **more: Any) -> Part:
        """The noun, of what its keys name in the library. more : what the keys do not say themselves.

        Raises FemstructError where it `makes` no part.
        """
        found: dict[str, Any] = {"material": of.materials, "section": of.sections}
        named = {key: found[key][getattr(self, key)] for key in found if getattr(self, key, None) is not None}
        part = self.noun(name=name, **named, **more)
        if not isinstance(part, Part):
            kind = f"{type(self).__module__}.{type(self).__name__}"
            raise FemstructError(f"parts.{name}", got=f"a {type(part).__name__}", expected=f"a Part that {kind} makes")
        return part

    def check_place(self, here: Here, places: Places) -> None:
        """Note what is wrong with a point on it."""
        if isinstance(places, str):
            here.wrong(f"{places} of a {self.type}", "global coordinates", "write [x, y, z]")
        elif any(len(place) != 3 for place in places):
            here.wrong(f"{len(places[0])} coordinates", f"3 on a {self.type}", "global axes")

    def check_losses(self, here: Here) -> None:
        """Note a loss factor that damping from materials takes and neither the file nor the library gives."""

    @property
    def named_places(self) -> Mapping[str, tuple[float, ...]]:
        """Coordinates of those of center, top and bottom that it has."""
        return {}


def check_coordinates(
    here: Here, places: tuple[tuple[float, ...], ...], kind: str, size: tuple[float, ...], hint: str
) -> None:
    """Note coordinates of another number than the sides of a part, and places that are not on it."""
    if any(len(place) != len(size) for place in places):
        here.wrong(f"{len(places[0])} coordinates", f"{len(size)} on a {kind}", hint)
        return
    expected = f"a place on the {kind}, {' x '.join(f'{side:g} m' for side in size)}"
    do = f"measure from the {kind}'s own corner, along its own axes"
    for place in places:
        here.need(
            all(
                -COORDINATE_ROUNDING * side <= x <= side * (1 + COORDINATE_ROUNDING)
                for x, side in zip(place, size, strict=True)
            ),
            f"{list(place)} m",
            expected,
            do,
        )
