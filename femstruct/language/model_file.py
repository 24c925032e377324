"""The model file: parts and what joins, holds and damps them, or one structure in closed form."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from femstruct.language import parts
from femstruct.language.materials import AnyMaterialSpec, AnySection, CavitySpec, LikeSpec
from femstruct.language.parts import Library, PartSpec
from femstruct.language.structures import (
    ConstraintSpec,
    DampingSpec,
    GivenModesSpec,
    JointSpec,
    PointSpec,
    StructureSpec,
    SupportSpec,
    SurfaceSpec,
)
from femstruct.model.structure import Structure
from femstruct.study.structures import StructureModel
from femstruct.yaml.reader import Here, Names, members
from femstruct.yaml.spec import Spec, Text, any_of, check_references, kinds_of

# ----------------------------------------------------------------------------------------------------------------------
# The kinds of parts a model file can have: every module here that has a `PartSpec` with a `type` is one, and what
# other packages add as entry points of the group `femstruct.language.parts`.
# ----------------------------------------------------------------------------------------------------------------------

PART_KINDS: tuple[type[PartSpec], ...] = kinds_of(parts, PartSpec)

if TYPE_CHECKING:
    AnyPart = PartSpec
else:
    AnyPart = any_of(PART_KINDS)


# ----------------------------------------------------------------------------------------------------------------------
# The model file.
# ----------------------------------------------------------------------------------------------------------------------

_OF_PARTS = ("parts", "joints", "supports", "constraints", "surfaces", "cavities", "materials", "sections")


class ModelSpec(Spec):
    """A model file: parts and what joins, holds and damps them, or one closed-form structure."""

    title: Text | None = None
    materials: dict[str, AnyMaterialSpec] = Field(default_factory=dict)
    sections: dict[str, AnySection] = Field(default_factory=dict)
    parts: dict[str, AnyPart] = Field(default_factory=dict)
    joints: dict[str, JointSpec] = Field(default_factory=dict)
    points: dict[str, PointSpec] = Field(default_factory=dict)
    surfaces: dict[str, SurfaceSpec] = Field(default_factory=dict)
    cavities: dict[str, CavitySpec] = Field(default_factory=dict)
    supports: dict[str, SupportSpec] = Field(default_factory=dict)
    constraints: dict[str, ConstraintSpec] = Field(default_factory=dict)
    damping: DampingSpec = DampingSpec()
    structure: StructureSpec | None = None

    def names(self) -> Names:
        """The names it offers to itself and to a study."""
        counts = {name: point.count for name, point in self.points.items()}
        if isinstance(self.structure, GivenModesSpec):
            counts |= dict.fromkeys(self.structure.points, 1)
        places = [one for name, count in counts.items() for one in members(name, count)]
        known: dict[str, list[str]] = {words: [] for kind in PART_KINDS for words in kind.known_as}
        for name, part in self.parts.items():
            for words in part.known_as:
                known[words].append(name)
        known |= {"material": [*self.materials], "section": [*self.sections], "surface": [*self.surfaces]}
        known["point"] = list(dict.fromkeys([*counts, *places]))
        forces = frozenset({*self.parts, *self.joints, *self.supports, *self.constraints, "ground"})
        return Names(counts, frozenset(places), forces, known)

    def check(self, here: Here) -> None:
        """Every name it uses is there, of the right kind, and its keys agree with each other."""
        if self.structure is not None:
            for group in _OF_PARTS:
                here.at(group).need(
                    not getattr(self, group),
                    f"'{group}' beside 'structure'",
                    "one of them",
                    f"remove '{group}'",
                    of_key=True,
                )
        else:
            here.need(
                self.parts,
                "no parts",
                "'parts' or 'structure'",
                "add 'parts: ...', or 'structure: none' for a study of bodies only",
            )
        check_references(ModelSpec, here)
        for group in _OF_PARTS:
            for name, one in getattr(self, group).items():
                one.check(here.at(group, name))
        self.damping.check(here.at("damping"))
        if self.damping.source is not None:
            for name, material in self.materials.items():
                if isinstance(material, LikeSpec):
                    material.check_losses(here.at("materials", name))
            for name, part in self.parts.items():
                part.check_losses(here.at("parts", name))
        for name, point in self.points.items():
            there = here.at("points", name)
            if self.structure is None:
                point.check_on(there, self.parts)
                continue
            there.at("patch").need(
                point.patch is None, f"a patch of structure '{self.structure.type}'", "a patch on a plate", "remove it"
            )
            self.structure.check_point(there, point)

    def build(self, title: str, here: Here, sources: dict[str, str]) -> StructureModel | None:
        """The structure it describes; None with mistakes noted.

        Parameters
        ----------
        sources : dict[str, str]
            Is given the digests of files it names.
        """
        closed = self.structure
        if closed is not None:
            return here.at("structure").make(lambda: closed.structure(self.points))
        materials = here.each("materials", self.materials, lambda _, name, one: one.noun(name=name))
        sections = here.each("sections", self.sections, lambda _, name, one: one.noun(name=name))
        if here.mistakes.lines:
            return None
        of = Library(materials, sections, here.tree.file, sources)
        parts = here.each("parts", self.parts, lambda _, name, one: one.build(name, of))
        points = tuple(one.place_on(name, self.parts) for name, one in self.points.items())
        constraints = here.each("constraints", self.constraints, lambda _, name, one: one.noun(name=name))
        supports = here.each("supports", self.supports, lambda _, name, one: one.of(name, materials))
        groups = {group: getattr(self, group).items() for group in ("joints", "surfaces", "cavities")}
        nouns: Any = {group: tuple(one.noun(name=name) for name, one in items) for group, items in groups.items()}
        nouns |= {"constraints": tuple(constraints.values()), "supports": tuple(supports.values())}
        return Structure(title, tuple(parts.values()), points=points, **nouns)
