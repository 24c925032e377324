"""The second pass over a file: what is wrong with names and keys, noted with its place."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from femstruct.conventions import DIRECTIONS
from femstruct.language.yaml.here import Names
from femstruct.language.yaml.reader import Mistakes, Steps, Tree, dotted, nearest

POINT_DIRECTIONS = (*DIRECTIONS, "n")
FORCES = ("force", "force_x", "force_y", "force_z")
LONGEST_NAME: Final = 80  # characters


class Checker:
    def __init__(self, tree: Tree, mistakes: Mistakes) -> None:
        self.tree, self.mistakes = tree, mistakes

    def wrong(self, steps: Steps, got: str, expected: str, do: str = "", of_key: bool = False) -> None:
        self.mistakes.add(self.tree.position(steps, of_key), dotted(steps), got=got, expected=expected, do=do)

    def is_name(self, steps: Steps, name: str) -> bool:
        """Whether a name can be read in a line and used for a file; notes where it cannot."""
        if len(name) > LONGEST_NAME:
            got = f"a name of {len(name)} characters"
            self.wrong(steps, got, f"at most {LONGEST_NAME}", "shorten it", of_key=True)
        elif "\n" in name or "\t" in name:
            self.wrong(steps, "a name with a tab or a new line", "a name in one line", of_key=True)
        elif name.startswith("_"):  # legends of pictures leave such lines out
            self.wrong(steps, f"the name '{name}'", "a name that does not begin with _", "rename it", of_key=True)
        else:
            return True
        return False

    def known(self, steps: Steps, name: str, kind: str, known: Iterable[str]) -> bool:
        names = list(known)
        if name in names:
            return True
        do = nearest(name, names) if names else f"there are none: add '{kind.split()[-1]}s:'"
        self.wrong(steps, f"'{name}'", f"the name of a {kind}", do)
        return False

    def place(self, steps: Steps, name: str, names: Names, also: Iterable[str] = ()) -> None:
        """A single place, or one of the other names."""
        extra = list(also)
        if name in names.places or name in extra:
            return
        if name in names.points:
            count = names.points[name]
            self.wrong(steps, f"'{name}', which has {count} places", "one place", f"write {name}.1 to {name}.{count}")
            return
        do = nearest(name, [*names.places, *extra])
        words = "point" if not extra else "point, body or ground" if "ground" in extra else "point or body"
        self.wrong(steps, f"'{name}'", f"the name of a {words}", do or "there are no points: add 'points:'")

    def spot(self, steps: Steps, text: str, names: Names, forces: Iterable[str] = (), of_key: bool = False) -> None:
        """An address: POINT.direction, or NAME.force where forces are allowed."""
        name, _, what = text.rpartition(".")
        known_forces = list(forces)
        if what in FORCES and known_forces:
            if name not in known_forces:
                self.wrong(steps, f"'{text}'", "a force of the structure", nearest(name, known_forces), of_key)
            return
        if not name or what not in POINT_DIRECTIONS:
            example = f"write it like {name or text}.z" if (name or text) in names.points else "write it like O_f.z"
            expected = f"POINT.{'|'.join(POINT_DIRECTIONS)}" + (" or NAME.force" if known_forces else "")
            self.wrong(steps, f"'{text}'", expected, example, of_key)
            return
        if name in names.places:
            return
        if name in names.points:
            do = f"write {name}.1.{what} to {name}.{names.points[name]}.{what}"
            self.wrong(steps, f"'{text}', which has several places", "one place", do, of_key)
            return
        known = sorted(names.places)
        self.wrong(steps, f"'{text}'", "a direction of a point", nearest(name, known) or "there are no points", of_key)
