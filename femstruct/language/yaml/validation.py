"""A mapping checked against its schema: pydantic's findings as our sentences."""

from __future__ import annotations

import re
import types
from collections.abc import Iterator
from typing import Annotated, Any, Final, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from femstruct.language.yaml.spec import LATER
from femstruct.language.yaml.tree import Mistakes, Steps, Tree, dotted, near_name, nearest
from femstruct.units import shown_as

S = TypeVar("S", bound=BaseModel)
NUMBER_LIKE: Final = re.compile(r"\d+([eE][+-]?\d+)?( .*)?")  # what is left of a number cut at a decimal comma


def validate(schema: type[S], value: Any, tree: Tree, mistakes: Mistakes) -> S | None:
    """The mapping as its schema; None, and every mistake noted with its position, when it does not fit."""
    try:
        return schema.model_validate(value)
    except ValidationError as error:
        found = error.errors(include_url=False)
        meant = {
            (*one["loc"][:-1], near_name(str(one["loc"][-1]), _allowed(schema, one["loc"][:-1])))
            for one in found
            if one["type"] == "extra_forbidden"
        }
        for one in found:
            if not (one["type"] == "missing" and one["loc"] in meant):  # a misspelt key is one mistake, not two
                _note(one, schema, tree, mistakes)
        return None


def _note(error: Any, schema: type[BaseModel], tree: Tree, mistakes: Mistakes) -> None:
    loc, kind = error["loc"], error["type"]
    if kind == "union_tag_invalid":
        loc = (*loc, "shape" if "rectangle" in error["ctx"]["expected_tags"] else "type")
    steps = _steps(loc, tree.value, absent=kind != "refused")
    if kind == "missing" and isinstance(loc[-1], int):
        steps = steps[:-1]
    at = tree.position(steps, of_key=kind == "extra_forbidden" or (kind == "missing" and isinstance(loc[-1], str)))
    got, expected, do = _told(kind, error["input"], error.get("ctx", {}), loc, schema) or ("", error["msg"], "")
    mistakes.add(at, dotted(steps), got=got or shown_as(error["input"]), expected=expected, do=do)


def _told(
    kind: str, given: Any, context: dict[str, Any], loc: Steps, schema: type[BaseModel]
) -> tuple[str, str, str] | None:
    """What was got ("" for the value as it is shown), what is expected, what to do; None for what pydantic says."""
    match kind:
        case "refused":
            return context["got"], context["expected"], context["do"]
        case "extra_forbidden":
            return _told_of_key(str(loc[-1]), loc, _allowed(schema, loc[:-1]))
        case "missing" if isinstance(loc[-1], int):
            return "a list that is too short", f"at least {loc[-1] + 1} values", ""
        case "missing":
            return "nothing", f"'{loc[-1]}'", f"add '{loc[-1]}: ...'"
        case "too_long":
            return f"{context['actual_length']} values", f"{context['max_length']}", ""
        case "too_short":
            return f"{context['actual_length']} values", f"at least {context['min_length']}", ""
        case "tuple_type" | "list_type":
            return "", "a list", "write it like [1, 2]"
        case "dict_type" | "model_type" | "model_attributes_type":
            return "", "a mapping", "write it like {name: value}"
        case "union_tag_not_found" if not isinstance(given, dict):
            return "", "a mapping", "write it like {type: ..., ...}"
        case "union_tag_not_found":
            known = " | ".join(tag for one in _at(schema, loc) for tag in _tags(one))
            return "no 'type'", "a key 'type'", f"add type: {known}" if known else "add 'type: ...'"
        case "union_tag_invalid":
            words, word = [tag.strip(" '") for tag in context["expected_tags"].split(",")], context["tag"]
            later = f", which is {LATER}" if word in ("shell", "solid") else ""
            return f"'{word}'{later}", f"one of {', '.join(words)}", "" if later else nearest(word, words)
        case "literal_error":
            words = re.findall("'([^']*)'", context["expected"])
            return "", f"one of {', '.join(words)}", nearest(str(given), words) if given else ""
    return None


_LATER_KEYS: Final = ("layers", "file", "set", "scale")  # of parts


def _told_of_key(key: str, loc: Steps, known: list[str]) -> tuple[str, str, str]:
    if loc[0] == "parts" and key in _LATER_KEYS and len(loc) <= 4:
        return f"'{key}', which is {LATER}", "a model or study without it", "remove it"
    comma = "write decimals with a point: a comma begins the next item"
    do = comma if NUMBER_LIKE.fullmatch(key) else nearest(key, known)
    return f"the unknown key '{key}'", "a key of the language", do


def _steps(loc: Steps, value: Any, absent: bool = True) -> Steps:
    """A pydantic location without the tags of its unions: only what is in the tree, and a last missing key (`absent`;
    what refuses a whole mapping misses none, and its last step may be a tag)."""
    steps: list[str | int] = []
    tagged = False
    for number, step in enumerate(loc):
        if not tagged and isinstance(value, dict) and step in (value.get("type"), value.get("shape")):
            tagged = True  # a tag, though a key of that mapping may have the same name
            continue
        in_list = isinstance(value, list) and isinstance(step, int) and step < len(value)
        if in_list or (isinstance(value, dict) and step in value):
            value, tagged = value[step], False
        elif number < len(loc) - 1 or not absent:
            continue
        steps.append(step)
    return tuple(steps)


def _allowed(schema: Any, loc: Steps) -> list[str]:
    """The keys of the mapping that a pydantic location points at."""
    return [key for one in _at(schema, loc) for key in _fields(one)]


def _fields(schema: Any) -> dict[str, Any]:
    """The annotations of a mapping's keys; none for what is no mapping of the language."""
    fields = schema.model_fields if isinstance(schema, type) and issubclass(schema, BaseModel) else {}
    return {info.alias or name: info.annotation for name, info in fields.items()}


def _tags(schema: Any) -> tuple[str, ...]:
    """By which words a kind is told from the others."""
    fields = _fields(schema)
    literal = fields.get("type", fields.get("shape"))
    return get_args(literal) if literal is not None else ("given",)


def _at(schema: Any, loc: Steps) -> list[Any]:
    """What may stand at a pydantic location."""
    known = [schema]
    for step in loc:
        if step in [getattr(one, "__name__", "") for one in known]:
            continue  # a kind that is told by its keys: a misspelt one may have been meant for another kind
        inside = [_fields(one).get(str(step)) for one in known] + [
            get_args(one)[get_origin(one) is dict] for one in known if get_origin(one) in (dict, list, tuple)
        ]
        tagged = [one for one in known if step in _tags(one)] if len(known) > 1 else []
        known = tagged or [one for each in inside if each is not None for one in _alternatives(each)]
    return known


def _alternatives(annotation: Any) -> Iterator[Any]:
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        yield from _alternatives(inside[0])
    elif origin in (Union, types.UnionType):
        for one in inside:
            yield from _alternatives(one)
    elif annotation is not type(None):
        yield annotation
