"""Who refers to whom: one table, read off the schemas, for checking names and for removing what a name takes along."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Annotated, Any, Final, Literal, NamedTuple, get_args, get_origin

from femstruct.language.yaml.here import Here
from femstruct.language.yaml.spec import Refers, Spec
from femstruct.language.yaml.tree import Steps

EACH: Final = "*"  # in a path: every name of a mapping, every item of a list, a single value that stands for one


class Reference(NamedTuple):
    """Where a file names something. path : keys from the root, EACH, and ("type", WORD) for kinds of one noun."""

    path: tuple[str | int | tuple[str, str], ...]
    refers: Refers


@cache
def references(schema: type[Spec]) -> tuple[Reference, ...]:
    """All places of a file where a name stands."""
    return tuple(_walked(schema, (), ()))


def _walked(annotation: Any, metadata: tuple[Any, ...], path: tuple[Any, ...]) -> Iterator[Reference]:
    yield from (Reference(path, one) for one in metadata if isinstance(one, Refers))
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        yield from _walked(inside[0], inside[1:], path)
    elif origin is dict:
        yield from _walked(inside[1], (), (*path, EACH))
    elif origin is tuple and Ellipsis not in inside:
        for number, one in enumerate(inside):
            yield from _walked(one, (), (*path, number))
    elif origin is not Literal and inside:
        for one in inside:
            yield from _walked(one, (), (*path, EACH) if origin in (list, tuple) else path)
    elif isinstance(annotation, type) and issubclass(annotation, Spec):
        fields = annotation.model_fields
        kind = get_args(fields["type"].annotation) if "type" in fields else ()
        here = (*path, ("type", kind[0])) if kind else path
        for key, field in fields.items():
            yield from _walked(field.annotation, tuple(field.metadata), (*here, field.alias or key))


def found(value: Any, path: tuple[Any, ...], steps: Steps = ()) -> Iterator[tuple[Steps, str]]:
    """Every name that a tree has at a path, with its steps."""
    if not path:
        if isinstance(value, str):
            yield steps, value
        return
    step, rest = path[0], path[1:]
    if step == EACH and not isinstance(value, dict | list):
        yield from found(value, rest, steps)
    elif isinstance(step, tuple):
        if isinstance(value, dict) and value.get(step[0]) == step[1]:
            yield from found(value, rest, steps)
    else:
        items = dict(enumerate(value)) if isinstance(value, list) else value if isinstance(value, dict) else {}
        for key in items if step == EACH else [step] if step in items else ():
            yield from found(items[key], rest, (*steps, key))


def check_references(schema: type[Spec], here: Here) -> None:
    """Note the names in a file that nothing of their kind has."""
    for path, refers in references(schema):
        for steps, name in found(here.tree.value, path) if refers.kind else ():
            here.at(*steps).known(name, refers.kind)
