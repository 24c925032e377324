"""A mapping checked against its schema: pydantic's findings as our sentences."""

from __future__ import annotations

import re
import types
from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Annotated, Any, Final, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from femstruct.errors import quote_value
from femstruct.units import QuantityError
from femstruct.yaml.reader import Mistakes, Steps, Tree, dotted, near_name, near_one, nearest
from femstruct.yaml.spec import OF_FILE, Opened, Spec

S = TypeVar("S", bound=BaseModel)
NUMBER_LIKE: Final = re.compile(r"\d+([eE][+-]?\d+)?( .*)?")  # what is left of a number cut at a decimal comma
GIVEN: Final = "given"  # the kind that is told by its own keys, not by a word
COMMA: Final = "write decimals with a point: a comma begins the next item"


def validate(
    schema: type[S], value: Any, tree: Tree, mistakes: Mistakes, sources: dict[str, str] | None = None
) -> S | None:
    """The mapping as its schema; None, and every mistake noted with its position, when it does not fit.

    Parameters
    ----------
    sources : dict[str, str] | None
        Is given the texts of the tables that the mapping names, by their names.
    """
    try:
        return schema.model_validate(value, context=Opened(tree.file, {} if sources is None else sources))
    except ValidationError as error:
        found = error.errors(include_url=False)
        unknown = [one for one in found if one["type"] == "extra_forbidden"] + _unknown_without_kind(found, schema)
        meant = {  # a misspelt key is one mistake, not two
            (
                *one["loc"][:-1],
                _instead(schema, one["loc"])[0] or near_name(str(one["loc"][-1]), _allowed(schema, one["loc"][:-1])),
            )
            for one in unknown
        }
        cut = {_cut_at_comma(one, value) for one in unknown}
        for one in unknown:
            _note(one, schema, tree, mistakes)
        for one in found:
            noted = one["type"] == "extra_forbidden" or one["loc"] in cut or _missing(one, schema) in meant
            if not noted:
                _note(one, schema, tree, mistakes)
        return None


def _cut_at_comma(unknown: Any, value: Any) -> Steps | None:
    """The place of the value before an unknown key that is the rest of a number: 0,008 has become 0 and a key 008."""
    key = unknown["loc"][-1]
    for step in _steps(unknown["loc"][:-1], value, absent=False):
        value = value[step]
    keys = list(value)
    number = keys.index(key) if key in keys else 0
    return (*unknown["loc"][:-1], keys[number - 1]) if number and NUMBER_LIKE.fullmatch(str(key)) else None


def _unknown_without_kind(found: Iterable[Any], schema: type[BaseModel]) -> list[Any]:
    """The keys that no kind of a noun has, of mappings that do not say which kind they are."""
    return [
        {"type": "extra_forbidden", "loc": (*one["loc"], key), "input": value}
        for one in found
        if one["type"] == "union_tag_not_found" and isinstance(one["input"], dict)
        for key, value in one["input"].items()
        if key not in _allowed(schema, one["loc"])
    ]


def _missing(error: Any, schema: type[BaseModel]) -> Steps | None:
    """The place of a key that is missing, of its kind too; None for another mistake."""
    if error["type"] == "union_tag_not_found":
        return (*error["loc"], _key_of_kind(schema, error["loc"]))
    return error["loc"] if error["type"] == "missing" else None


def _key_of_kind(schema: type[BaseModel], loc: Steps) -> str:
    """The key that tells the kinds apart that may stand at a pydantic location."""
    return "shape" if "shape" in _allowed(schema, loc) else "type"


def _note(error: Any, schema: type[BaseModel], tree: Tree, mistakes: Mistakes) -> None:
    loc, kind = error["loc"], error["type"]
    if kind == OF_FILE:
        for line in error["ctx"]["lines"].splitlines():
            mistakes.note(line)
        return
    if kind == "union_tag_invalid":
        loc = (*loc, _key_of_kind(schema, loc))
    steps = _steps(loc, tree.value, absent=kind == "missing")
    if kind == "missing" and isinstance(loc[-1], int):
        steps = steps[:-1]
    at = tree.position(steps, of_key=kind == "extra_forbidden" or (kind == "missing" and isinstance(loc[-1], str)))
    got, expected, do = _noted(kind, error["input"], error.get("ctx", {}), loc, schema) or ("", error["msg"], "")
    mistakes.add(at, dotted(steps), got=got or quote_value(error["input"]), expected=expected, do=do)


def _noted(
    kind: str, given: Any, context: dict[str, Any], loc: Steps, schema: type[BaseModel]
) -> tuple[str, str, str] | None:
    """What was got ("" for the value as it is shown), what is expected, what to do; None for what pydantic says."""
    match kind:
        case "value_error" if isinstance(refusal := context["error"], QuantityError):
            return refusal.got, refusal.expected, refusal.do
        case "extra_forbidden":
            got, expected, do = _describe_key(str(loc[-1]), _allowed(schema, loc[:-1]))
            return got, expected, _instead(schema, loc)[1] or do
        case "missing" if isinstance(loc[-1], int):
            return "a list that is too short", f"at least {loc[-1] + 1} values", ""
        case "missing":
            return "nothing", f"'{loc[-1]}'", f"add '{loc[-1]}: ...'"
        case "too_long":
            return f"{context['actual_length']} values", f"{context['max_length']}", _comma_in(given)
        case "too_short":
            return f"{context['actual_length']} values", f"at least {context['min_length']}", ""
        case "tuple_type" | "list_type":
            return "", "a list", "write it like [1, 2]"
        case "dict_type" | "model_type" | "model_attributes_type":
            return "", "a mapping", f"write it like {_meant(schema, loc, given) or '{name: value}'}"
        case "union_tag_not_found" if not isinstance(given, dict):
            return "", "a mapping", f"write it like {_meant(schema, loc, given) or '{type: ..., ...}'}"
        case "union_tag_not_found":
            key, known = _key_of_kind(schema, loc), " | ".join(_tags_at(schema, loc))
            return f"no '{key}'", f"a key '{key}'", f"add {key}: {known}" if known else f"add '{key}: ...'"
        case "union_tag_invalid":
            tags, word = [tag.strip(" '") for tag in context["expected_tags"].split(",")], context["tag"]
            words = [tag for tag in tags if tag != GIVEN]
            return f"'{word}'", f"one of {', '.join(words)}", near_one(word, words)
        case "literal_error":
            words = re.findall("'([^']*)'", context["expected"])
            return "", f"one of {', '.join(words)}", near_one(str(given), words) if given else ""
    return None


def _comma_in(given: Any) -> str:
    """What to do about a list that is too long where a number may have been cut at a decimal comma: 2,5 is 2 and 5."""
    whole = [type(one) is int for one in given] if isinstance(given, list) else []
    return COMMA if any(map(all, pairwise(whole))) else ""


def _describe_key(key: str, known: list[str]) -> tuple[str, str, str]:
    do = COMMA if NUMBER_LIKE.fullmatch(key) else nearest(key, known)
    if (word := key.partition(":")[0]) in known and word != key:
        do = "write a space after the colon"
    return f"the unknown key '{key}'", "a key of the language", do


def _steps(loc: Steps, value: Any, absent: bool = True) -> Steps:
    """A pydantic location without the tags of its unions: only what is in the tree, and a last missing key (`absent`;
    of other mistakes the last step may be a tag)."""
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


def _instead(schema: Any, loc: Steps) -> tuple[str, str]:
    """The key that says what an unknown one says of another kind, and how; nothing where it is none of these."""
    alternatives = [each for one in _specs(schema, loc[:-1]) for each in one.instead]
    return next(((key, do) for other, key, do in alternatives if other == loc[-1]), ("", ""))


def _meant(schema: Any, loc: Steps, value: Any) -> str:
    """The mapping that is meant by a value where a mapping is expected."""
    kinds = [tag for tag in _tags_at(schema, loc) if tag != GIVEN]
    if kinds:
        near = near_name(value, kinds) if isinstance(value, str) else ""
        return f"{{{_key_of_kind(schema, loc)}: {near or '...'}, ...}}"
    return next((text for one in _specs(schema, loc) if (text := one.meant_by(value))), "")


def _specs(schema: Any, loc: Steps) -> list[type[Spec]]:
    """The nouns that may stand at a pydantic location."""
    return [one for one in _at(schema, loc) if isinstance(one, type) and issubclass(one, Spec)]


def _tags_at(schema: Any, loc: Steps) -> list[str]:
    return [tag for one in _at(schema, loc) for tag in _tags(one)]


def _fields(schema: Any) -> dict[str, Any]:
    """The annotations of a mapping's keys; none for what is no mapping of the language."""
    fields = schema.model_fields if isinstance(schema, type) and issubclass(schema, BaseModel) else {}
    return {info.alias or name: info.annotation for name, info in fields.items()}


def _tags(schema: Any) -> tuple[str, ...]:
    """By which words a kind is told from the others."""
    fields = _fields(schema)
    literal = fields.get("type", fields.get("shape"))
    return get_args(literal) if literal is not None else (GIVEN,)


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
