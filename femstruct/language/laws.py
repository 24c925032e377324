"""Contact laws as they are written: what each declares, by its `type`, and what it needs to know of its two ends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Annotated, Any, Final

from pydantic import Field

from femstruct.declared import declared
from femstruct.errors import InputError
from femstruct.files.columns import read_columns
from femstruct.files.text_tables import beside
from femstruct.laws.hertz import Hertz
from femstruct.laws.law import Law
from femstruct.laws.registry import LAWS
from femstruct.laws.tabulated import Tabulated
from femstruct.quantities import Length, Quantity
from femstruct.yaml.reader import Here
from femstruct.yaml.spec import Spec, Text, read_by, spec_of

# ----------------------------------------------------------------------------------------------------------------------
# What every contact law of a study file has, and what it is given to become one.
#
# The keys of a law are what its noun declares (`femstruct.laws`). d is the indentation, d' its rate, positive while the
# ends approach.
# ----------------------------------------------------------------------------------------------------------------------


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


class LawSpec(Spec):
    """A contact law."""

    type: str

    @property
    def takes_radius(self) -> bool:
        """Whether it takes the radii of the bodies it stands between."""
        return False

    def law(self, site: Site) -> Law | None:
        """The law; None with a mistake noted. Raises FemstructError for what its constructor refuses."""
        return self.made(site, {})

    def made(self, site: Site, more: Mapping[str, Any]) -> Law:
        """The law of its keys, of what its place tells of the rest, and more."""
        given = {name: value for name, value in self.given().items() if value is not None}
        given |= more
        needs, names = dict(self.only_with), declared(type(self).makes)
        round_ends = tuple(one for one in site.ends.radii or () if one < inf)
        around = {"at_speed": site.ends.speed, "mass": site.ends.mass, "radius": round_ends or None}
        for key, value in around.items():
            name = dict(self.called).get(key, key)
            if name in names and value is not None and all(other in given for other in needs.get(key, ())):
                given.setdefault(name, value)
        try:
            law: Law = type(self).makes(**given)
        except InputError as error:
            where = f"{site.here.path}.{error.where.rpartition(' ')[2]}"  # the key that it is about
            raise InputError(where, got=error.got, expected=error.expected, do=error.do) from None
        return law


# ----------------------------------------------------------------------------------------------------------------------
# What is written in another form than it is given to the noun.
# ----------------------------------------------------------------------------------------------------------------------


def _radii(value: object) -> object:
    """One radius, of a sphere on a flat face, or two."""
    return value if isinstance(value, list) else [value]


class OfSpheres(LawSpec):
    """A law that takes one radius, or two in a list."""

    radius: (
        Annotated[
            tuple[Length, ...], Field(min_length=1, max_length=2), read_by(_radii, Length | tuple[Length, Length])
        ]
        | None
    ) = None

    @property
    def takes_radius(self) -> bool:
        return self.radius is None and getattr(self, "stiffness", None) is None


Depth = Annotated[float, Quantity(("length",), least=0.0)]
Push = Annotated[float, Quantity(("force",), least=0.0)]


class OfPoints(LawSpec):
    """A law of measured points: [[indentation, force], ...], or a CSV file of these columns."""

    one_of = (("curve", "file"),)
    only_written = ("curve", "file")

    curve: (
        Annotated[list[tuple[Depth, Push]], Field(min_length=2, description="[[indentation, force], ...]")] | None
    ) = None
    file: Annotated[Text, Field(description="a CSV file of indentations and forces")] | None = None

    def law(self, site: Site) -> Law | None:
        there = site.here.at("file" if self.curve is None else "curve")

        def of_columns(indentations: Any, forces: Any) -> Law:
            return self.made(site, {"indentations": indentations, "forces": forces})

        if self.curve is not None:
            columns: Any = zip(*self.curve, strict=True)
            return there.make(lambda: of_columns(*columns))
        path = beside(there.tree.file, self.file or "")
        return there.make(lambda: read_columns(path, ("length", "force"), site.sources, of_columns))


# ----------------------------------------------------------------------------------------------------------------------
# The kinds of contact laws a study file can have: every law with a word, with the keys that it declares.
# ----------------------------------------------------------------------------------------------------------------------

_OTHER_FORMS: Final[Mapping[Any, type[LawSpec]]] = {Hertz: OfSpheres, Tabulated: OfPoints}
LAW_KINDS: Final[tuple[type[LawSpec], ...]] = tuple(
    spec_of(law, law.word, _OTHER_FORMS.get(law, LawSpec)) for law in LAWS if law.word
)
