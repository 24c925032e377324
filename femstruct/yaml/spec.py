"""What both schemas are made of: quantities, words and keys that exclude each other, as pydantic reads them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, field
from functools import cache, reduce
from operator import or_
from pathlib import Path
from types import ModuleType, UnionType
from typing import Annotated, Any, ClassVar, Final, Literal, NamedTuple, TypeVar, Union, get_args, get_origin

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    create_model,
    model_validator,
)
from pydantic_core import PydanticCustomError

from femstruct.declared import Count as AnyCount
from femstruct.declared import Declared, Refers, declared, refuse_together
from femstruct.errors import FemstructError, InputError, InputErrors, quote_value
from femstruct.files.band_tables import read_bands
from femstruct.files.text_tables import beside, wrong_in
from femstruct.model.materials import MOST_LOSSES
from femstruct.plugins import added_kinds, with_added
from femstruct.quantities import CELL, FREQUENCY, Quantity, refuse
from femstruct.units import QuantityError
from femstruct.yaml.reader import Here, Steps, near_one


class Spec(BaseModel):
    """A mapping of the language: unknown keys are refused, and keys that exclude each other.

    one_of : groups of keys of which a file gives exactly one. at_most_one_of : groups of which it may give one.
    only_with : keys that mean nothing without others. makes : the noun with the same fields, and a name where it has
    one.
    called : what the noun calls keys for which it has another word. only_written : keys that the noun does not have.
    refused : keys of other kinds that `refuse_keys` refuses. instead : keys of other kinds that are unknown here,
    each with the key that says it and how. short : the key that is meant by a value alone.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=False, arbitrary_types_allowed=True)
    one_of: ClassVar[tuple[tuple[str, ...], ...]] = ()
    at_most_one_of: ClassVar[tuple[tuple[str, ...], ...]] = ()
    only_with: ClassVar[tuple[tuple[str, tuple[str, ...]], ...]] = ()
    makes: ClassVar[Callable[..., Any]] = dict
    called: ClassVar[tuple[tuple[str, str], ...]] = ()
    only_written: ClassVar[tuple[str, ...]] = ()
    refused: ClassVar[tuple[str, ...]] = ()
    instead: ClassVar[tuple[tuple[str, str, str], ...]] = ()
    short: ClassVar[str] = ""

    def given(self) -> dict[str, Any]:
        """The values of the noun's keys, in its words, mappings as nouns; not the word that tells the kind."""
        left_out = ("type", "shape", *self.only_written)
        values = {key: getattr(self, key) for key in type(self).model_fields if key not in left_out}
        nouns = {key: value.noun() if isinstance(value, Spec) else value for key, value in values.items()}
        return {dict(self.called).get(key, key): value for key, value in nouns.items()}

    def noun(self, **others: Any) -> Any:
        """The noun it describes.

        Parameters
        ----------
        others : Any
            What the keys do not say, or not in the noun's words.
        """
        return type(self).makes(**{**self.given(), **others})

    @classmethod
    def keys(cls) -> set[str]:
        """The keys it has or refuses by name, as a file writes them."""
        return {*(info.alias or name for name, info in cls.model_fields.items()), *cls.refused}

    @classmethod
    def meant_by(cls, value: object) -> str:
        """The mapping that is meant by a value alone, "" where that is not known."""
        single = cls.short and isinstance(value, str | int | float) and not isinstance(value, bool)
        return f"{{{cls.short}: {value}}}" if single else ""

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        """Raise what `refuse` makes of keys that cannot be together, before any of them is read."""

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        """The mapping with what a key of it brings along."""
        return given

    def check(self, here: Here) -> None:
        """Note what is wrong with its keys together, and with the names in it."""

    @model_validator(mode="before")
    @classmethod
    def _exclusive(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        if value.keys() <= cls.keys():  # else a key that is missing may be there, misspelt
            cls._refuse_together(value)
        return cls.completed(value)

    @classmethod
    def _refuse_together(cls, value: Mapping[str, Any]) -> None:
        cls.refuse_keys(value)
        refuse_together(cls, value)


def brought_by_key(*names: str) -> ConfigDict:
    """The schema of a mapping of which another key may bring these: a source its mass, a wool its density."""

    def loosen(schema: dict[str, Any]) -> None:
        schema["required"] = [name for name in schema["required"] if name not in names]

    return ConfigDict(json_schema_extra=loosen)


def _text(value: object) -> str:
    if not isinstance(value, str):
        do = "" if value is None else "put quotes around it if it is meant as text"
        raise refuse(quote_value(value), "a name or text", do)
    if not value.strip():
        raise refuse("an empty text", "a name or text")
    return value


def _flag(value: object) -> bool:
    if not isinstance(value, bool):
        raise refuse(quote_value(value), "true or false")
    return value


def _count(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 < value <= 100_000:
        raise refuse(quote_value(value), "a whole number from 1 to 100000")
    return value


Text = Annotated[str, BeforeValidator(_text)]
Flag = Annotated[bool, BeforeValidator(_flag)]
Count = Annotated[int, BeforeValidator(_count)]
MaterialLossFactor = Annotated[
    float,
    Quantity(("ratio",), least=0.0, most=MOST_LOSSES, too_large="2 % is 0.02: did you mean {number:g} %?"),
]
CellSide = Annotated[float, CELL, Field(description="largest side of an element [m]")]
PointName = Annotated[Text, Refers("point")]
SurfaceName = Annotated[Text, Refers("surface")]
End = Annotated[Text, Refers(goes_with="bodies")]
Ends = Annotated[tuple[End, End], Field(description="its two ends: names of points or bodies, or ground")]


def read_by(reader: Callable[..., object], written: Any) -> BeforeValidator:
    """Annotation of a field that `reader` makes of what may be written in the file (for the JSON Schema)."""
    return BeforeValidator(reader, json_schema_input_type=written)


def only(words: Sequence[str], expected: str = "", do: str = "") -> Callable[[object], object]:
    """Validator of a field that takes some words; others are refused with the nearest.

    Parameters
    ----------
    expected : str
        In place of all words.
    do : str
        What to do where none is near.
    """

    def read(value: object) -> object:
        if isinstance(value, str) and value in words:
            return value
        near = near_one(str(value), words) if value else ""
        raise refuse(quote_value(value), expected or f"one of {', '.join(words)}", near or do)

    return read


def word_of(words: Sequence[str]) -> BeforeValidator:
    """Annotation of a text that is one of these words."""
    return read_by(only(words), Literal.__getitem__(tuple(words)))


def words_of(words: Sequence[str]) -> BeforeValidator:
    """Annotation of a tuple of some of these words; one may stand alone."""
    literal: Any = Literal.__getitem__(tuple(words))
    return read_by(several(only(words)), literal | list[literal])


def several(read: Callable[[Any], object]) -> Callable[[object], object]:
    """Reader of one value or a list of them, as a tuple."""
    return lambda value: tuple(read(one) for one in (value if isinstance(value, list) and value else [value]))


def so_many(
    read: Callable[[Any], object],
    counts: Sequence[int],
    expected: str,
    do: str,
    *,
    many: str = "",
    or_one: bool = False,
) -> Callable[[object], object]:
    """Reader of a list of one of these numbers of values, as a tuple.

    Parameters
    ----------
    many : str
        What the values are, to tell how many there were.
    or_one : bool
        Whether one may stand without a list.
    """

    def reader(value: object) -> object:
        if or_one and not isinstance(value, list):
            return read(value)
        if not isinstance(value, list | tuple) or len(value) not in counts:
            got = f"{len(value)} {many}" if many and isinstance(value, list) else quote_value(value)
            raise refuse(got, expected, do)
        return tuple(read(one) for one in value)

    return reader


def word_or(words: Mapping[str, object], quantity: Quantity) -> Callable[[object], object]:
    """Reader of a quantity, or of a word that stands for something."""
    return lambda value: words[value] if isinstance(value, str) and value in words else quantity.read(value)


# ----------------------------------------------------------------------------------------------------------------------
# Who refers to whom: one table, read off the schemas, for checking names and for removing what a name takes along.
# ----------------------------------------------------------------------------------------------------------------------

EACH: Final = "*"  # in a path: every name of a mapping, every item of a list, a single value that stands for one


class NameReference(NamedTuple):
    """Where a file names something. path : keys from the root, EACH, and ("type", WORD) for kinds of one noun."""

    path: tuple[str | int | tuple[str, str], ...]
    refers: Refers


@cache
def references(schema: type[Spec]) -> tuple[NameReference, ...]:
    """All places of a file where a name stands."""
    return tuple(_walked(schema, (), ()))


def _walked(annotation: Any, metadata: tuple[Any, ...], path: tuple[Any, ...]) -> Iterator[NameReference]:
    yield from (NameReference(path, one) for one in metadata if isinstance(one, Refers))
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


def names_at(value: Any, path: tuple[Any, ...], steps: Steps = ()) -> Iterator[tuple[Steps, str]]:
    """Every name that a tree has at a path, with its steps."""
    if not path:
        if isinstance(value, str):
            yield steps, value
        return
    step, rest = path[0], path[1:]
    if step == EACH and not isinstance(value, dict | list):
        yield from names_at(value, rest, steps)
    elif isinstance(step, tuple):
        if isinstance(value, dict) and value.get(step[0]) == step[1]:
            yield from names_at(value, rest, steps)
    else:
        items = dict(enumerate(value)) if isinstance(value, list) else value if isinstance(value, dict) else {}
        for key in items if step == EACH else [step] if step in items else ():
            yield from names_at(items[key], rest, (*steps, key))


def check_references(schema: type[Spec], here: Here) -> None:
    """Note the names in a file that nothing of their kind has."""
    for path, refers in references(schema):
        for steps, name in names_at(here.tree.value, path) if refers.kind else ():
            here.at(*steps).known(name, refers.kind)


# ----------------------------------------------------------------------------------------------------------------------
# The kinds of one noun, such as the parts or the contact laws: classes that nothing else has to name, and what other
# packages add.
# ----------------------------------------------------------------------------------------------------------------------


def kinds_of(module: ModuleType, base: type[BaseModel]) -> tuple[Any, ...]:
    """The classes that a module makes of `base`, of those with a `type` or `signs` of their own, in its order; then
    those that other packages add to the group of entry points of its name.

    Raises FemstructError for one of another package that has no word, or one that is taken.
    """
    classes = [one for one in vars(module).values() if isinstance(one, type) and one.__module__ == module.__name__]
    own = [one for one in classes if issubclass(one, base) and _words(one)]
    return with_added(own, added_kinds(module.__name__, base), _words)


def _words(kind: type[BaseModel]) -> tuple[str, ...]:
    """What tells a kind: the word of its `type`, or keys that no other kind has."""
    field = kind.model_fields.get("type")
    return get_args(field.annotation) if field is not None else getattr(kind, "signs", ())


def spec_of(noun: type, word: str, base: type[Spec]) -> Any:
    """The mapping of the language that a noun declares: a key for each thing that it is given, with its quantity.

    Parameters
    ----------
    word : str
        Its `type`, "" where another key says its kind.
    base : type[Spec]
        What all kinds of it have, and the keys that are written in another form than they are given to the noun. Its
        `name` is the key of the mapping itself.
    """
    first, *_ = (noun.__doc__ or "").split("\n\n")
    said = {name: one for name, one in declared(noun).items() if one.key.name is not None and name != "name"}
    keys = {one.key.name or name: one for name, one in said.items()}
    own: dict[str, Any] = {"type": (Literal.__getitem__(word), ...)} if word else {}
    own |= {key: _written(noun, key, one) for key, one in keys.items() if key not in base.model_fields}
    about, name = " ".join(first.split()), f"{noun.__name__}Spec"
    made: Any = create_model(name, __base__=base, __module__=noun.__module__, __doc__=about, **own)
    made.makes, made.called = noun, tuple((one.key.name, name) for name, one in declared(noun).items() if one.key.name)
    for rule in ("one_of", "at_most_one_of", "only_with"):
        setattr(made, rule, (*getattr(base, rule), *getattr(noun, rule, ())))
    return made


def _written(noun: type, key: str, one: Declared) -> tuple[Any, Any]:
    """Annotation and default of a key; a default that nothing has stated yet is none."""
    if one.annotation in (float, int):
        got, expected = f"{key}: {one.annotation.__name__}", "its quantity, as in `thickness: Length`"
        raise FemstructError(f"{noun.__module__}.{noun.__name__}", got=got, expected=expected)
    annotation = _in_file(one.annotation)
    default = one.key.default if one.key.default is not MISSING else one.default
    if default is MISSING:
        return annotation, ...
    return (annotation | None if default is None else annotation), default


def _in_file(annotation: Any) -> Any:
    """What may be written of what Python takes: texts that are not empty, numbers that are not too large."""
    origin, inside = get_origin(annotation), get_args(annotation)
    if annotation in _FORMS:
        return _FORMS[annotation]
    if origin is Annotated:
        return Annotated.__class_getitem__((_in_file(inside[0]), *inside[1:]))
    return reduce(or_, map(_in_file, inside)) if origin in (Union, UnionType) else annotation


_FORMS: Final[dict[Any, Any]] = {bool: Flag, str: Text, AnyCount: Count}


def union_of(kinds: Iterable[Any]) -> Any:
    """The annotation of what is one of these kinds."""
    return reduce(or_, kinds)


def any_of(kinds: Iterable[Any]) -> Any:
    """The annotation of a field that holds one of these kinds, told apart by their `type`."""
    return Annotated[union_of(kinds), Field(discriminator="type")]


# ----------------------------------------------------------------------------------------------------------------------
# Quantities by frequency: one for all, one for each band, or a table of bands in a file beside the YAML file.
# ----------------------------------------------------------------------------------------------------------------------

T = TypeVar("T")
OF_FILE: Final = "of_file"  # a mistake that has its own place, in another file


@dataclass(frozen=True)
class Opened:
    """What a YAML file that is checked may open. file : its name. sources : is given the texts of tables, by name."""

    file: str
    sources: dict[str, str] = field(default_factory=dict)


class BandFile(Spec):
    """A table of bands as an analyser wrote it, beside this file. column : of several columns of values, the name of
    the one that is meant."""

    file: Text
    column: Text | None = None


def by_band(quantity: Quantity, expected: str, do: str) -> Callable[[object, ValidationInfo], object]:
    """Reader of a quantity, of one for each frequency, or of a table of bands: {file: NAME, column: NAME}."""

    def read(value: object, info: ValidationInfo) -> object:
        if not isinstance(value, dict):
            return quantity.read(value)
        if not value:
            raise refuse("no band", expected, do)
        if "file" in value:
            return band_file(value, quantity, info)
        return each_band(value, quantity.read)

    return read


def each_band(value: Mapping[str, Any], read: Callable[[Any], T]) -> dict[float, T]:
    """What `read` makes of the value at each frequency [Hz], each of them once."""
    found: dict[float, T] = {}
    for band, one in value.items():
        frequency = FREQUENCY.read(band)
        if frequency in found:
            raise refuse(f"{frequency:g} Hz twice", "each frequency once", "remove one of them")
        found[frequency] = read(one)
    return found


def band_file(value: dict[str, Any], quantity: Quantity, info: ValidationInfo) -> dict[float, float]:
    """Values by band of a table {file: NAME, column: NAME}, each within the limits of its quantity."""
    column = value.get("column") or ""
    if not isinstance(column, str):
        raise refuse(quote_value(value), "the name of a column", "write it like {file: t60.csv, column: T20}")

    def made(path: Path, sources: dict[str, str]) -> dict[float, float]:
        found = read_bands(path, quantity.dimensions[0], sources, column)
        for one in found.values():
            try:
                quantity.read(one.value)
            except QuantityError as error:
                wrong = InputError("", got=f"{one.value:g}", expected=error.expected, do=error.do)
                raise wrong_in(path, one.line, wrong) from None
        return {band: one.value for band, one in found.items()}

    return made_of_file(value, info, made, ("file", "column"))


def made_of_file(
    value: dict[str, Any],
    info: ValidationInfo,
    maker: Callable[[Path, dict[str, str]], T],
    keys: Sequence[str] = ("file",),
) -> T:
    """What `maker` makes of the path of {file: NAME} and the texts of files; its mistakes keep their own places."""
    others, name, opened = [key for key in value if key not in keys], value.get("file"), info.context
    if others:
        raise refuse(f"the key '{others[0]}' beside 'file'", " and ".join(f"'{key}'" for key in keys), "remove it")
    if not isinstance(name, str):
        raise refuse(quote_value(name), "the name of a file", "write it like {file: t60.csv}")
    if not isinstance(opened, Opened):
        raise refuse(f"the file '{name}'", "values", "files are read where a YAML file names them")
    try:
        return maker(beside(opened.file, name), opened.sources)
    except InputErrors as errors:
        raise PydanticCustomError(OF_FILE, OF_FILE, {"lines": "\n".join(errors.errors)}) from None
    except FemstructError as error:
        raise refuse(error.got, error.expected, error.do) from None
