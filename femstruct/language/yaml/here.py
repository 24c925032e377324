"""Where something stands in a file: what is wrong with it is noted there, and so is what its noun refuses."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

from acoustics.errors import AcousticsError
from femstruct.conventions import DIRECTIONS
from femstruct.errors import FemstructError, InputErrors
from femstruct.language.yaml.tree import Mistakes, Position, Steps, Tree, dotted, mapping_in, near_one, nearest

T = TypeVar("T")
POINT_DIRECTIONS = (*DIRECTIONS, "n")
GROUPS = {
    "material": "materials",
    "section": "sections",
    "surface": "surfaces",
    "point": "points",
    "case": "cases",
    "body": "bodies",
}  # of a file; what else has a name is a part
FORCES = ("force", "force_x", "force_y", "force_z")


def members(name: str, count: int) -> list[str]:
    """The names of the places of a point, or of the bodies of an array.

    >>> members("foot", 1), members("foot", 2)
    (['foot'], ['foot.1', 'foot.2'])
    """
    return [name] if count == 1 else [f"{name}.{number}" for number in range(1, count + 1)]


@dataclass(frozen=True)
class Names:
    """What names stand for. points : how many places each has. places : single ones, of several NAME.1, NAME.2, ...
    forces : what has a force. known : all names of a kind, by the words for it that messages use."""

    points: Mapping[str, int] = field(default_factory=dict)
    places: Collection[str] = ()
    forces: Collection[str] = ()
    known: Mapping[str, Collection[str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Here:
    """A place in a file, and the names that what stands there may use."""

    tree: Tree
    mistakes: Mistakes
    names: Names = Names()
    steps: Steps = ()

    def at(self, *steps: str | int) -> Here:
        """A place inside of this one."""
        return Here(self.tree, self.mistakes, self.names, (*self.steps, *steps))

    def outside(self, count: int) -> Here:
        """The place that this one is in, so many steps up."""
        return Here(self.tree, self.mistakes, self.names, self.steps[:-count])

    @property
    def path(self) -> str:
        return dotted(self.steps)

    @property
    def position(self) -> Position:
        return self.tree.position(self.steps)

    def wrong(self, got: str, expected: str, do: str = "", of_key: bool = False) -> None:
        """Note a mistake, at the value that stands here or at its key."""
        self.mistakes.add(self.tree.position(self.steps, of_key), self.path, got=got, expected=expected, do=do)

    def need(self, ok: object, got: str, expected: str, do: str = "", of_key: bool = False) -> bool:
        """Whether all is well; notes a mistake where it is not."""
        if not ok:
            self.wrong(got, expected, do, of_key)
        return bool(ok)

    def make(self, maker: Callable[[], T]) -> T | None:
        """What `maker` makes; None with its refusal noted here, or at the key of this mapping that it is about."""
        try:
            return maker()
        except InputErrors as errors:  # lines with their own places
            for line in errors.errors:
                self.mistakes.note(line)
            return None
        except (FemstructError, AcousticsError) as error:
            inner = error.where.removeprefix(f"{self.path}.")
            (self.at(inner) if inner != error.where and (*self.steps, inner) in self.tree.keys else self).wrong(
                error.got or str(error), error.expected, error.do
            )
            return None

    def each(self, group: str, specs: Mapping[str, Any], maker: Callable[[Here, str, Any], T | None]) -> dict[str, T]:
        """One noun for every name of a group; those refused are left out."""
        there = {name: self.at(group, name) for name in specs}
        made = {name: there[name].make(partial(maker, there[name], name, spec)) for name, spec in specs.items()}
        return {name: noun for name, noun in made.items() if noun is not None}

    def known(self, name: str, kind: str, also: Collection[str] = ()) -> bool:
        """Whether something of a kind has this name, or it is one of the others; noted where not."""
        names = [*self.names.known.get(kind, ()), *also]
        if name not in names:
            part = mapping_in(mapping_in(self.tree.value, "parts"), name).get("type")
            group = next((key for key in self.tree.value if name in mapping_in(self.tree.value, key)), "")
            is_what = f", of type {part}" if part else f", one of the {group}" if group else ""
            self.wrong(
                f"'{name}'{is_what}",
                f"the name of a {kind}{' with nodes' if part and kind == 'part' else ''}",
                nearest(name, names) if names else f"there are none: add one to '{GROUPS.get(kind, 'parts')}:'",
            )
        return name in names

    def place(self, name: str, also: Collection[str] = ()) -> None:
        """Note what is neither a single place nor one of the other names."""
        known, several = [*self.names.places, *also], self.names.points.get(name)
        if name in known:
            return
        if several:
            self.wrong(f"'{name}', which has {several} places", "one place", f"write {name}.1 to {name}.{several}")
            return
        words = "point" if not also else "point, body or ground" if "ground" in also else "point or body"
        near = near_one(name, [*known, *self.names.points]) or nearest(name, known)
        self.wrong(f"'{name}'", f"the name of a {words}", near or "there are no points: add 'points:'")

    def spot(self, text: str, forces: bool = False, of_key: bool = False) -> None:
        """Note what is no address: POINT.direction, or NAME.force where forces are allowed."""
        name, _, what = text.rpartition(".")
        points, places, got = self.names.points, self.names.places, f"'{text}'"
        if forces and what in FORCES:
            if name not in self.names.forces:
                self.wrong(got, "a force of the structure", nearest(name, self.names.forces), of_key)
        elif not name or what not in POINT_DIRECTIONS:
            self.wrong(
                got,
                f"POINT.{'|'.join(POINT_DIRECTIONS)}" + (" or NAME.force" if forces else ""),
                f"write it like {name or text}.z" if (name or text) in points else "write it like O_f.z",
                of_key,
            )
        elif name in points and name not in places:
            self.wrong(
                f"{got}, which has several places",
                "one place",
                f"write {name}.1.{what} to {name}.{points[name]}.{what}",
                of_key,
            )
        elif name not in places:
            self.wrong(got, "a direction of a point", nearest(name, sorted(places)) or "there are no points", of_key)
