"""A mapping checked against its schema: pydantic's findings as our sentences."""

from __future__ import annotations

import re
import types
from typing import Annotated, Any, Final, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError

from femstruct.language.yaml.reader import Mistakes, Steps, Tree, dotted, near_name, nearest
from femstruct.language.yaml.spec import LATER
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
    loc: Steps = error["loc"]
    kind: str = error["type"]
    context: dict[str, Any] = error.get("ctx", {})
    steps = _steps(loc, tree.value, absent=kind != "refused")
    got, expected, do, of_key = shown_as(error["input"]), str(error["msg"]), "", False
    if kind == "refused":
        got, expected, do = context["got"], context["expected"], context["do"]
    elif kind == "extra_forbidden":
        key = str(loc[-1])
        known = _allowed(schema, loc[:-1])
        got, of_key = f"the unknown key '{key}'", True
        expected, do = "a key of the language", nearest(key, known)
        if NUMBER_LIKE.fullmatch(key):
            do = "write decimals with a point: a comma begins the next item"
        if _is_later(loc):
            got, expected, do = f"'{key}', which is {LATER}", "a model or study without it", "remove it"
    elif kind == "missing" and isinstance(loc[-1], int):
        steps = steps[:-1]
        got, expected = "a list that is too short", f"at least {loc[-1] + 1} values"
    elif kind == "missing":
        got, expected, do, of_key = "nothing", f"'{loc[-1]}'", f"add '{loc[-1]}: ...'", True
    elif kind == "too_long":
        got, expected = f"{context['actual_length']} values", f"{context['max_length']}"
    elif kind == "too_short":
        got, expected = f"{context['actual_length']} values", f"at least {context['min_length']}"
    elif kind in ("tuple_type", "list_type"):
        expected, do = "a list", "write it like [1, 2]"
    elif kind in ("dict_type", "model_type", "model_attributes_type"):
        expected, do = "a mapping", "write it like {name: value}"
    elif kind == "union_tag_not_found":
        got = "no 'type'"
        known = _tags(_descend(schema, loc))
        expected, do = "a key 'type'", f"add type: {' | '.join(known)}" if known else "add 'type: ...'"
        if not isinstance(error["input"], dict):
            got, expected, do = shown_as(error["input"]), "a mapping", "write it like {type: ..., ...}"
    elif kind == "union_tag_invalid":
        known = [tag.strip(" '") for tag in context["expected_tags"].split(",")]
        word = context["tag"]
        steps = _steps((*loc, "shape" if "rectangle" in known else "type"), tree.value)
        later = word in ("shell", "solid")
        got = f"'{word}'" + (f", which is {LATER}" if later else "")
        expected, do = f"one of {', '.join(known)}", "" if later else nearest(word, known)
    elif kind == "literal_error":
        words = re.findall("'([^']*)'", context["expected"])
        expected, do = f"one of {', '.join(words)}", nearest(str(error["input"]), words) if error["input"] else ""
    mistakes.add(tree.position(steps, of_key), dotted(steps), got=got, expected=expected, do=do)


_LATER_KEYS: Final = (
    ("parts", "*", "layers"), ("parts", "*", "file"), ("parts", "*", "set"), ("parts", "*", "scale"),
)  # fmt: skip


def _is_later(loc: Steps) -> bool:
    short = (loc[0], "*", loc[-1]) if len(loc) > 1 else loc
    return short in _LATER_KEYS and len(loc) <= 4


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
    found = _descend(schema, loc)
    if isinstance(found, type) and issubclass(found, BaseModel):
        return [field.alias or name for name, field in found.model_fields.items()]
    return []


def _descend(schema: Any, loc: Steps) -> Any:
    """The annotation a pydantic location points at."""
    for step in loc:
        schema = _bare(schema)
        if isinstance(schema, type) and issubclass(schema, BaseModel):
            by_key = {info.alias or name: info.annotation for name, info in schema.model_fields.items()}
            schema = by_key.get(str(step))
        elif get_origin(schema) is dict:
            schema = get_args(schema)[1]
        elif get_origin(schema) in (tuple, list):
            schema = get_args(schema)[0]
        elif get_origin(schema) in (Union, types.UnionType):
            schema = next((member for member in get_args(schema) if step in _own_tags(member)), None)
        else:
            return None
    return _bare(schema)


def _bare(schema: Any) -> Any:
    while True:
        if get_origin(schema) is Annotated:
            schema = get_args(schema)[0]
        elif get_origin(schema) in (Union, types.UnionType) and type(None) in get_args(schema):
            members = [member for member in get_args(schema) if member is not type(None)]
            schema = members[0] if len(members) == 1 else Union[tuple(members)]  # noqa: UP007 (made at run time)
        else:
            return schema


def _own_tags(member: Any) -> tuple[str, ...]:
    tags = (
        tuple(one.tag for one in get_args(member)[1:] if isinstance(one, Tag))
        if get_origin(member) is Annotated
        else ()
    )
    bare = _bare(member)
    fields = bare.model_fields if isinstance(bare, type) and issubclass(bare, BaseModel) else {}
    return tags or (tuple(get_args(fields["type"].annotation)) if "type" in fields else ())


def _tags(union: Any) -> list[str]:
    if get_origin(union) not in (Union, types.UnionType):
        return []
    return [tag for member in get_args(union) for tag in _own_tags(member)]
