"""What building nouns from specs shares: refusals of constructors become mistakes with positions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, TypeVar

from acoustics.errors import AcousticsError
from femstruct.errors import FemstructError
from femstruct.language.yaml.reader import Mistakes, Steps, Tree, dotted

T = TypeVar("T")


class Builder:
    """Makes nouns, and turns what their constructors refuse into mistakes with positions."""

    def __init__(self, tree: Tree, mistakes: Mistakes) -> None:
        self.tree, self.mistakes = tree, mistakes

    def make(self, steps: Steps, maker: Callable[[], T]) -> T | None:
        """What `maker` makes, or None with the refusal noted at a path."""
        try:
            return maker()
        except (FemstructError, AcousticsError) as error:
            path = dotted(steps)
            inner = error.where.removeprefix(f"{path}.")
            if inner != error.where and (*steps, inner) in self.tree.keys:
                steps, path = (*steps, inner), f"{path}.{inner}"
            got = error.got or str(error)
            self.mistakes.add(self.tree.position(steps), path, got=got, expected=error.expected, do=error.do)
            return None

    def each(self, group: str, specs: Mapping[str, Any], maker: Callable[[str, Any], T | None]) -> dict[str, T]:
        """One noun for every name of a group; those refused are left out."""
        made = {name: self.make((group, name), partial(maker, name, spec)) for name, spec in specs.items()}
        return {name: noun for name, noun in made.items() if noun is not None}
