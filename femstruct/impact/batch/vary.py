"""What differs between the runs of a batch: numbers of a scene by name, a column over the runs each."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, frozen
from femstruct.errors import InputError
from femstruct.impact.scene.bodies import HalfSine, Scene

Place = tuple[str, int, str]  # field of the scene, index in it, attribute


@dataclass(frozen=True, eq=False)
class Variation:
    """A scene and the columns of numbers [runs] that take the place of its own."""

    scene: Scene
    columns: Mapping[str, Floats]
    runs: int

    def __call__(self, i: int) -> Scene:
        """The scene of run i."""
        scene, places = self.scene, variable(self.scene)
        for name, column in self.columns.items():
            scene = _with(scene, places[name], float(column[i]))
        return scene

    def column(self, name: str, otherwise: float) -> Floats:
        """The values of a name in all runs [runs], or [1] the one that all share."""
        return self.columns[name] if name in self.columns else np.array([otherwise])


def variation(scene: Scene, vary: Mapping[str, ArrayLike]) -> Variation:
    """The columns checked against the scene.

    Raises InputError for an unknown name, columns of unequal length, or no run; FemstructError for a value that is
    not finite or that its body, contact or link refuses.
    """
    places = variable(scene)
    columns: dict[str, Floats] = {}
    for name, values in vary.items():
        if name not in places:
            near = difflib.get_close_matches(name, places, n=1)
            do = f"did you mean '{near[0]}'?" if near else ""
            expected = f"one of {', '.join(places)}" if places else "a scene with names"
            raise InputError(f"vary.{name}", got="an unknown name", expected=expected, do=do)
        columns[name] = frozen(f"vary.{name}", values, (None,))
    lengths = {name: len(column) for name, column in columns.items()}
    if not lengths or not min(lengths.values()):
        raise InputError("vary", got="no run", expected="names with a value for every run")
    first, runs = next(iter(lengths.items()))
    for name, length in lengths.items():
        if length != runs:
            raise InputError(f"vary.{name}", got=f"{length} values", expected=f"{runs}, as {first} has")
    varied = Variation(scene, columns, runs)
    for column in columns.values():  # what a constructor refuses lies beyond a bound
        varied(int(column.argmin()))
        varied(int(column.argmax()))
    for contact in scene.contacts:
        gaps, preloads = (varied.column(f"{contact.name}.{w}", getattr(contact, w)) for w in ("gap", "preload"))
        varied(int((gaps * preloads).argmax()))
    return varied


def variable(scene: Scene) -> dict[str, Place]:
    """Names of all numbers of a scene that may vary, and where they are."""
    found: dict[str, Place] = {}
    for i, body in enumerate(scene.bodies):
        found |= {f"{body.name}.{word}": ("bodies", i, word) for word in ("mass", "velocity")}
    for i, contact in enumerate(scene.contacts):
        words = ("gap", "preload", *contact.law.varies)
        found |= {f"{contact.name}.{word}": ("contacts", i, word) for word in words}
    for i, link in enumerate(scene.links):
        words = ("stiffness", "closing", "opening", "preload")
        found |= {f"{link.name}.{word}": ("links", i, word) for word in words}
    for i, load in enumerate(scene.loads):
        if isinstance(load.history, HalfSine):
            found[f"{load.name}.amplitude"] = ("loads", i, "amplitude")
    return found


def numbers_of_scene(scene: Scene) -> dict[str, float]:
    """All numbers of a scene that may vary, by name.

    >>> from femstruct.impact.scene.bodies import Body
    >>> numbers_of_scene(Scene((Body("ball", 2.0, -1.0),)))
    {'ball.mass': 2.0, 'ball.velocity': -1.0}
    """
    return {name: _of(scene, place) for name, place in variable(scene).items()}


def _of(scene: Scene, place: Place) -> float:
    field, index, word = place
    item = getattr(scene, field)[index]
    if field == "contacts" and word in item.law.varies:
        return float(getattr(item.law, word))
    return float(getattr(item.history if field == "loads" else item, word))


def _with(scene: Scene, place: Place, value: float) -> Scene:
    field, index, word = place
    items: list[Any] = list(getattr(scene, field))
    item = items[index]
    if field == "contacts" and word in item.law.varies:
        items[index] = replace(item, law=replace(item.law, **{word: value}))
    elif field == "loads":
        items[index] = replace(item, history=replace(item.history, amplitude=value))
    else:
        items[index] = replace(item, **{word: value})
    changed: dict[str, Any] = {field: tuple(items)}
    return replace(scene, **changed)
