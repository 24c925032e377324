"""What both schemas are made of: quantities in pydantic models, and pydantic's findings as our sentences."""

from __future__ import annotations

import types
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Final, NamedTuple, TypeVar, Union, get_args, get_origin

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationError,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from femstruct.language.reader import Mistakes, Steps, Tree, dotted, near_name, nearest
from femstruct.units import DIMENSIONS, QuantityError, quantity_of, shown_as

LATER: Final = "not yet in this version"
_QUANTITY_PATTERN: Final = (
    r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*[A-Za-z%°µμ1].*$|^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*$"
)


class Spec(BaseModel):
    """A mapping of the language: unknown keys are refused, and keys that exclude each other.

    one_of : groups of keys of which a file gives exactly one. at_most_one_of : groups of which it may give one.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=False, arbitrary_types_allowed=True)
    one_of: ClassVar[tuple[tuple[str, ...], ...]] = ()
    at_most_one_of: ClassVar[tuple[tuple[str, ...], ...]] = ()

    @model_validator(mode="before")
    @classmethod
    def _exclusive(cls, value: Any) -> Any:
        if isinstance(value, dict):
            for names in cls.one_of:
                exactly_one(value, names)
            for names in cls.at_most_one_of:
                exactly_one(value, names, or_none=True)
        return value


class Measured(NamedTuple):
    """A value in SI units and its dimension, None for a plain number."""

    value: float
    dimension: str | None


def refuse(got: object, expected: str, do: str = "") -> PydanticCustomError:
    """A refusal pydantic carries to its report; `got` is shown as a value unless it is a sentence already."""
    return PydanticCustomError("refused", "refused", {"got": str(got), "expected": expected, "do": do})


@dataclass(frozen=True)
class Quantity:
    """Annotation of a field that holds a quantity of one of these dimensions, within limits."""

    dimensions: tuple[str, ...]
    above: float | None = None
    least: float | None = None
    below: float | None = None
    which: bool = False

    def read(self, value: object) -> Any:
        """The value in SI units, or a Measured when `which` is set."""
        try:
            number, dimension = quantity_of(value, self.dimensions)
        except QuantityError as error:
            raise refuse(error.got, error.expected, error.do) from None
        named = DIMENSIONS[dimension or self.dimensions[0]]
        if self.above is not None and not number > self.above:
            raise refuse(shown_as(value), f"a positive value: {named.words}", f"write it like {named.example}")
        if self.least is not None and not number >= self.least:
            raise refuse(shown_as(value), f"{named.words} of at least {self.least:g}", "remove the sign")
        if self.below is not None and not number < self.below:
            raise refuse(
                shown_as(value), f"{named.words} below {self.below:g}", f"2 % is 0.02: did you mean {number:g} %?"
            )
        return Measured(number, dimension) if self.which else number

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        words = " or ".join(f"{DIMENSIONS[name].words} [{DIMENSIONS[name].unit}]" for name in self.dimensions)
        example = DIMENSIONS[self.dimensions[0]].example
        return {
            "anyOf": [{"type": "number"}, {"type": "string", "pattern": _QUANTITY_PATTERN}],
            "description": f"{words}; a plain number is in SI units",
            "examples": [example],
        }


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise refuse(shown_as(value), "a name or text", "put quotes around it if it is meant as text")
    if not value.strip():
        raise refuse("an empty text", "a name or text")
    return value


def _flag(value: object) -> bool:
    if not isinstance(value, bool):
        raise refuse(shown_as(value), "true or false")
    return value


def _count(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 < value <= 100_000:
        raise refuse(shown_as(value), "a whole number from 1 to 100000")
    return value


Text = Annotated[str, BeforeValidator(_text)]
Flag = Annotated[bool, BeforeValidator(_flag)]
Count = Annotated[int, BeforeValidator(_count)]
Ratio = Annotated[float, Quantity(("ratio",), least=0.0, below=1.0)]
AnyRatio = Annotated[float, Quantity(("ratio",))]
Factor = Annotated[float, Quantity(("ratio",), above=0.0)]
LossFactor = Annotated[float, Quantity(("ratio",), least=0.0, below=2.0)]
Coordinate = Annotated[float, Quantity(("length",))]
Component = Annotated[float, Quantity(("ratio",))]
Length = Annotated[float, Quantity(("length",), above=0.0)]
Gap = Annotated[float, Quantity(("length",), least=0.0)]
MassKg = Annotated[float, Quantity(("mass",), above=0.0)]
Frequency = Annotated[float, Quantity(("frequency",), above=0.0)]
Duration = Annotated[float, Quantity(("time",), above=0.0)]
Instant = Annotated[float, Quantity(("time",), least=0.0)]
Speed = Annotated[float, Quantity(("speed",))]
Position2 = tuple[Coordinate, Coordinate]
Position3 = tuple[Coordinate, Coordinate, Coordinate]
Direction3 = tuple[Component, Component, Component]


def read_by(reader: Callable[[Any], object], written: Any) -> BeforeValidator:
    """Annotation of a field that `reader` makes of what may be written in the file (for the JSON Schema)."""
    return BeforeValidator(reader, json_schema_input_type=written)


def only(words: Sequence[str], later: Sequence[str] = ()) -> Callable[[object], object]:
    """Validator of a field that takes some words; others are refused with the nearest."""

    def read(value: object) -> object:
        if isinstance(value, str) and value in words:
            return value
        if isinstance(value, str) and value in later:
            raise refuse(f"'{value}', which is {LATER}", f"one of {', '.join(words)}")
        raise refuse(shown_as(value), f"one of {', '.join(words)}", nearest(str(value), words) if value else "")

    return read


def exactly_one(spec: Mapping[str, object], names: Sequence[str], or_none: bool = False) -> None:
    """Refuse a mapping with several of these keys, or with none of them."""
    given = [name for name in names if name in spec]
    if len(given) > 1 or not (given or or_none):
        got = f"both {' and '.join(given)}" if given else f"none of {', '.join(names)}"
        raise refuse(got, f"exactly one of {', '.join(names)}", "remove all but one" if given else "add one")


S = TypeVar("S", bound=BaseModel)


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
    steps = _steps(loc, tree.value)
    got, expected, do, of_key = shown_as(error["input"]), str(error["msg"]), "", False
    if kind == "refused":
        got, expected, do = context["got"], context["expected"], context["do"]
    elif kind == "extra_forbidden":
        key = str(loc[-1])
        known = _allowed(schema, loc[:-1])
        got, of_key = f"the unknown key '{key}'", True
        expected, do = "a key of the language", nearest(key, known)
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
        got, expected = "nothing that tells its kind", "'type'"
        known = _tags(_descend(schema, loc))
        expected, do = "a key 'type'", f"add type: {' | '.join(known)}" if known else "add 'type: ...'"
        if not isinstance(error["input"], dict):
            got, expected, do = shown_as(error["input"]), "a mapping", "write it like {type: ..., ...}"
    elif kind == "union_tag_invalid":
        known = [tag.strip(" '") for tag in context["expected_tags"].split(",")]
        word = context["tag"]
        steps = _steps((*loc, "shape" if "rectangle" in known else "type"), tree.value)
        later = word in ("block", "shell", "solid")
        got = f"'{word}'" + (f", which is {LATER}" if later else "")
        expected, do = f"one of {', '.join(known)}", "" if later else nearest(word, known)
    elif kind == "literal_error":
        expected = f"one of {context['expected']}".replace("'", "")
    mistakes.add(tree.position(steps, of_key), dotted(steps), got=got, expected=expected, do=do)


_LATER_KEYS: Final = (
    ("parts", "*", "layers"), ("parts", "*", "file"), ("parts", "*", "set"), ("parts", "*", "scale"),
    ("parts", "*", "between"), ("bodies", "*", "blows"), ("bodies", "*", "source"), ("limits",),
    ("rooms", "*", "levels"),
)  # fmt: skip


def _is_later(loc: Steps) -> bool:
    short = (loc[0], "*", loc[-1]) if len(loc) > 1 else loc
    return short in _LATER_KEYS and len(loc) <= 4


def _steps(loc: Steps, value: Any) -> Steps:
    """A pydantic location without the tags of its unions: only what is in the tree, and a last missing key."""
    steps: list[str | int] = []
    for number, step in enumerate(loc):
        in_list = isinstance(value, list) and isinstance(step, int) and step < len(value)
        if in_list or (isinstance(value, dict) and step in value):
            value = value[step]
        elif number < len(loc) - 1:
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
    bare = _bare(member)
    for name in ("type", "shape"):
        if isinstance(bare, type) and issubclass(bare, BaseModel) and name in bare.model_fields:
            return tuple(get_args(bare.model_fields[name].annotation))
    return ("given",) if isinstance(bare, type) else ()


def _tags(union: Any) -> list[str]:
    if get_origin(union) not in (Union, types.UnionType):
        return []
    return [tag for member in get_args(union) for tag in _own_tags(member)]
