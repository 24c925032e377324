"""Values as results files keep them: tags, nouns as plain tables, and what nobody reads."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Collection, Mapping
from copy import copy
from dataclasses import is_dataclass, replace
from enum import Enum
from functools import cache, partial
from hashlib import sha256
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple, NoReturn, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from acoustics import tags as of_acoustics
from femstruct import tags
from femstruct.arrays import Floats
from femstruct.errors import FemstructError
from femstruct.files.datasets import group, put, put_text
from femstruct.files.results_format_4 import tag_of_format_4
from femstruct.files.tagged_modules import MODULES

if TYPE_CHECKING:
    import h5py

    from femstruct.impact.motion import Motion
    from femstruct.modal.basis import ModalBasis
    from femstruct.study.results import CaseResult, StudyResult


# ----------------------------------------------------------------------------------------------------------------------
# The tag of a noun that is stored, and the noun of a tag that is read.
# ----------------------------------------------------------------------------------------------------------------------

Fields = Mapping[str, Any]
_OURS: Final = ("femstruct", "acoustics")
_GROUPS: Final = (  # of packages that add nouns
    "femstruct.evaluations",
    "femstruct.laws",
    "femstruct.language.parts",
    "femstruct.language.rooms",
)


class Newer(NamedTuple):
    """What became of a tag that no noun has any more: the tag of today, and what makes its fields of those of then."""

    tag: str
    fields: Callable[[Fields], Fields]


NEWER: Final[Mapping[str, Newer]] = MappingProxyType({})  # a noun that gets another meaning has an entry here


def tag_of(kind: Any) -> str:
    """The tag of a class or of a function; of somebody's own without one, where it stands.

    Raises FemstructError for one of this project, or of an installed package that adds to it, that has no tag.

    >>> from femstruct.errors import Finding
    >>> tag_of(Finding), tag_of(print)
    ('finding/1', 'builtins:print')
    """
    found = tags.TAGS.get(kind) or of_acoustics.TAGS.get(kind)
    if found is not None:
        return found
    name = f"{kind.__module__}:{kind.__qualname__}"
    package = _package(name)
    added = isinstance(kind, type) and package in {_package(point.module) for point in _added()}
    if "<" not in name and (package in _OURS or added):  # what is made inside a function, nobody finds again
        prefix = "" if package in _OURS else f"{package}: "
        raise FemstructError(
            "results",
            got=f"{name}, which has no tag",
            expected="nouns with tags",
            do=f"write @stored_as('{prefix}WORDS OF THE FIELD/1') above it, from femstruct.tags or acoustics.tags",
        )
    return name


def kind_of(tag: str) -> Any:
    """The class or function that has a tag, or what a file of format 4, or of somebody's own, names by its module.

    Raises FemstructError for what this version does not know, and for packages that are not installed.

    >>> kind_of("finding/1").__name__, kind_of("femstruct.errors:Finding").__name__
    ('Finding', 'Finding')
    """
    tag = tag_of_format_4(tag) or tag
    owner, _, own = tag.rpartition(": ")
    if "/" not in own:
        return _by_module(tag)
    found = _known(tag)
    if found is None and owner:
        for point in _points_of(owner, tag):
            import_module(point.module)
        found = _known(tag)
    elif found is None and tag in MODULES:
        import_module(MODULES[tag])
        found = _known(tag)
    if found is None:
        writer = f"the version of {owner or 'femstruct'} that wrote it"
        raise FemstructError("results", got=f"'{tag}'", expected="a noun that this version knows", do=f"use {writer}")
    return found


def _known(tag: str) -> Any:
    return tags.KINDS.get(tag) or of_acoustics.KINDS.get(tag)


def is_stored_class(kind: Any) -> bool:
    """Whether it is a class of nouns: nothing else is made of what a file says."""
    return isinstance(kind, type) and (is_dataclass(kind) or hasattr(kind, "_fields") or issubclass(kind, Enum))


def _by_module(name: str) -> Any:
    """What another package has under a name: only of packages that add parts or laws anything is imported."""
    module, _, word = name.partition(":")
    if _package(name) in _OURS:
        raise FemstructError("results", got=f"'{name}'", expected="a noun of femstruct")
    _points_of(_package(name), name)
    found: Any = import_module(module)
    for part in word.split("."):
        found = getattr(found, part)
    return found


def _points_of(package: str, name: str) -> list[EntryPoint]:
    found = [point for point in _added() if _package(point.module) == package]
    if not found:
        got, do = f"'{name}'", f"install the package '{package}'"
        raise FemstructError("results", got=got, expected="nouns of femstruct", do=do)
    return found


def _added() -> list[EntryPoint]:
    return [point for group in _GROUPS for point in entry_points(group=group)]


def _package(name: str) -> str:
    return name.partition(":")[0].partition(".")[0]


# ----------------------------------------------------------------------------------------------------------------------
# What no reader of a results file uses and most of its bytes would be: left out, unless a study says `save: modal`.
# ----------------------------------------------------------------------------------------------------------------------

T = TypeVar("T")
MOTION: Final = "the motion of the modes"
PUSHES: Final = "the forces that push the modes"


class NotKept:
    """What stands in a noun for something that its file does not have: whoever uses it is told so.

    >>> NotKept("the motion of the modes").turn
    Traceback (most recent call last):
    ...
    femstruct.errors.FemstructError: the motion of the modes: got a results file without it, expected the whole; run \
the study again with 'save: modal'
    """

    def __init__(self, what: str) -> None:
        self.what = what

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") and not name.startswith("__array"):
            raise AttributeError(name)  # what Python asks of any value
        self._refuse()

    def __getitem__(self, place: object) -> Any:
        self._refuse()

    def __len__(self) -> int:
        self._refuse()

    def _refuse(self) -> NoReturn:
        do = "run the study again with 'save: modal'"
        raise FemstructError(self.what, got="a results file without it", expected="the whole", do=do)


def without_unread(result: StudyResult) -> StudyResult:
    """The results as a file has them: without what only further simulations and evaluations would use.

    Notes
    -----
    Pages, tables, pictures, sounds, comparisons and exports are made of histories, shapes and levels. Left out are, of
    a case that does not say `save: modal`: the forces that push the modes (their channels are kept) and the motion of
    the modes, unless pictures of closed rooms are drawn of it, those of the baseline; of its basis, what couples the
    modes in the stiffness of parts and in what holds energy, which is nan then, beside the diagonals, the shares of
    each mode.
    """
    bases: dict[int, ModalBasis] = {}
    whole = {case.basis_key for case in result.cases.values() if case.case.study.save_modal}

    def basis_of(one: ModalBasis) -> ModalBasis:
        return bases.setdefault(id(one), _by_itself(one))

    def case_of(name: str, one: CaseResult) -> CaseResult:
        if one.case.study.save_modal:
            return one
        if one.response is None:
            return _with(one, basis=basis_of(one.basis))
        rooms = [plan for plan in one.case.study.rooms if plan.room.bounded and plan.name in one.rooms]
        drawn = name == result.plan.baseline and rooms and result.models.get(one.basis_key) is not None
        motion = _halved(one.response.motion) if drawn else NotKept(MOTION)
        left: dict[str, Any] = {"pushes": NotKept(PUSHES), "motion": motion}
        response = _with(one.response, basis=basis_of(one.response.basis), **left)
        return _with(one, basis=basis_of(one.basis), response=response)

    return replace(
        result,
        bases={key: one if key in whole else basis_of(one) for key, one in result.bases.items()},
        cases={name: case_of(name, one) for name, one in result.cases.items()},
    )


def with_derived(result: StudyResult) -> StudyResult:
    """The results that a file has, with what was left out because the rest of a noun says it, to the last bit."""

    def case_of(one: CaseResult) -> CaseResult:
        if one.response is None or isinstance(one.response.motion, NotKept) or len(one.response.motion.turn) == 4:
            return one
        motion = one.response.motion
        return _with(one, response=_with(one.response, motion=motion._replace(turn=_whole_turn(motion))))

    return _with(result, cases={name: case_of(one) for name, one in result.cases.items()})


def _halved(motion: Any) -> Any:
    """A motion of oscillators without what makes rates of their states: displacements say it."""
    if not isinstance(motion, NotKept) and len(motion.turn) == 4 and motion.turn.size:
        half = motion._replace(turn=motion.turn[:2])
        if np.array_equal(_whole_turn(half), motion.turn):
            return half
    return motion


def _whole_turn(motion: Motion) -> Floats:
    places, tilts = motion.turn
    k = motion.turn.shape[2]
    w, c = motion.omega[:k], motion.damping[:k]
    whole = np.array([places, tilts, -tilts * w**2, places - tilts * c])
    whole.flags.writeable = False
    return whole


def _by_itself(basis: ModalBasis) -> ModalBasis:
    holders = {
        name: _with(one, inertia=_diagonal(one.inertia), stiffness=_diagonal(one.stiffness))
        for name, one in basis.holders.items()
    }
    return _with(basis, part_stiffness=_diagonals(basis.part_stiffness), holders=holders)


def _diagonals(matrices: Mapping[str, Floats]) -> dict[str, Floats]:
    return {name: _diagonal(one) for name, one in matrices.items()}


def _diagonal(matrix: Floats) -> Floats:
    found = np.full_like(matrix, np.nan)
    np.fill_diagonal(found, np.diag(matrix))
    return found


def _with(noun: T, **fields: Any) -> T:
    """The noun with other fields, whatever it is that stands in them."""
    made = copy(noun)
    for name, value in fields.items():
        object.__setattr__(made, name, value)
    return made


# ----------------------------------------------------------------------------------------------------------------------
# Any frozen value as plain tables, its large arrays beside them, and whole back again.
#
# What a study found is a tree of frozen dataclasses: whoever adds a field to one of them finds it in the results file
# and in what is read from it, without a line here.
# ----------------------------------------------------------------------------------------------------------------------

Array = NDArray[Any]
Keep = Callable[[Array], object]  # puts an array somewhere, tells where
Fetch = Callable[[Any], Array]  # finds it there again

INLINE: Final = 128  # numbers of an array that stands in the tables themselves
_CLASS: Final = "is"  # no field of a dataclass can have this name


class Stored(NamedTuple):
    """A value in tables: every noun once, after those that it is made of, and the value in terms of them."""

    nouns: list[dict[str, Any]]
    value: Any


def store_value(value: object, keep: Keep) -> Stored:
    """A value made of dataclasses, named tuples, mappings, sequences, numbers, texts and arrays, ready for JSON.

    A noun that occurs twice is written once, and is one noun again when it is read. Of a function that
    is not of this project only the name is kept, as of a contact law of somebody's own.

    Parameters
    ----------
    keep : Keep
        Is given each array of more than a few numbers.

    Examples
    --------
    >>> from femstruct.errors import Finding
    >>> tables = store_value([Finding("mechanism", "It moves.", {"share": float("nan")})], keep=lambda array: None)
    >>> restore_value(tables, fetch=lambda place: None)
    [Finding(code='mechanism', message='It moves.', values={'share': nan}, severe=False)]
    """
    tables = _Tables(keep)
    content = tables.table(value)
    return Stored(tables.nouns, content)


class _Tables:
    """The nouns of a value while they are collected: each once, after those that it is made of."""

    def __init__(self, keep: Keep) -> None:
        self.nouns: list[dict[str, Any]] = []
        self._keep = keep
        self._known: dict[int, int] = {}  # numbers of nouns by their identity

    def table(self, one: Any) -> Any:
        """Any value as JSON has it."""
        if one is None or (isinstance(one, bool | int | str) and not isinstance(one, Enum)):
            return one
        if isinstance(one, float | np.floating):
            return float(one) if isfinite(one) else {"float": str(float(one))}
        if isinstance(one, np.generic):
            return self.table(one.item())
        if isinstance(one, np.ndarray):
            return self._array(one)
        if isinstance(one, NotKept):
            return {"not kept": one.what}
        if dataclasses.is_dataclass(one) or hasattr(one, "_fields"):
            return {"noun": self._noun(one)}
        if isinstance(one, Mapping | tuple | list | set | frozenset):
            return self._collection(one)
        if isinstance(one, csr_array):
            return {"rows": [self.table(part) for part in (one.data, one.indices, one.indptr, one.shape)]}
        if isinstance(one, Enum):
            return {"enum": [tag_of(type(one)), one.name]}
        if isinstance(one, complex):
            return {"complex": [self.table(one.real), self.table(one.imag)]}
        if callable(one):
            return {"function": tag_of(one if hasattr(one, "__qualname__") else type(one))}
        raise FemstructError("results", got=f"a {type(one).__qualname__}", expected="nouns, numbers, texts, arrays")

    def _array(self, one: Array) -> dict[str, Any]:
        if one.size > INLINE:
            return {"array": self._keep(one)}
        return {"small": [str(one.dtype), one.shape, [self.table(number) for number in one.ravel().tolist()]]}

    def _collection(self, one: Mapping[Any, Any] | Collection[Any]) -> Any:
        if isinstance(one, Mapping):
            kind = "view" if isinstance(one, MappingProxyType) else "map"
            return {kind: [[self.table(key), self.table(item)] for key, item in one.items()]}
        items = [self.table(item) for item in one]
        return items if isinstance(one, tuple) else {type(one).__name__: items}

    def _noun(self, one: Any) -> int:
        """Number of a noun, written where it is met first."""
        if id(one) not in self._known:
            names = getattr(one, "_fields", None) or [field.name for field in dataclasses.fields(one)]
            self.nouns.append({_CLASS: tag_of(type(one))} | {name: self.table(getattr(one, name)) for name in names})
            self._known[id(one)] = len(self.nouns) - 1
        return self._known[id(one)]


def restore_value(tables: Stored, fetch: Fetch) -> Any:
    """The value that was stored; arrays are read-only.

    Raises FemstructError for a class that is neither of this project nor of a package that adds to it.
    """
    nouns: list[Any] = []

    def value(content: Any) -> Any:
        if isinstance(content, list):
            return tuple(value(item) for item in content)
        if not isinstance(content, dict):
            return content
        ((kind, inside),) = content.items()
        return _READ[kind](inside, value) if kind in _READ else nouns[inside] if kind == "noun" else fetch(inside)

    for content in tables.nouns:
        fields: Mapping[str, Any] = {name: value(item) for name, item in content.items() if name != _CLASS}
        tag = tag_of_format_4(content[_CLASS]) or content[_CLASS]
        while tag in NEWER:
            tag, fields = NEWER[tag].tag, NEWER[tag].fields(fields)
        nouns.append(_made(tag, fields))
    return value(tables.value)


def _made(tag: str, fields: Mapping[str, Any]) -> Any:
    """A noun as it was: what its making checks and derives has been checked and derived.

    Fields that the file does not have are their defaults; those that the noun has no more are passed over.
    """
    kind = _class(tag)
    names, defaults = _fields(kind)
    values = {name: make() for name, make in defaults if name not in fields}
    values |= {name: item for name, item in fields.items() if name in names}
    if lacking := names - set(values):
        raise FemstructError("results", got=f"a '{tag}' without {', '.join(sorted(lacking))}", expected="all fields")
    if hasattr(kind, "_fields"):
        return kind(**values)
    made: object = object.__new__(kind)
    for name, item in values.items():
        object.__setattr__(made, name, item)
    return made


@cache
def _fields(kind: Any) -> tuple[frozenset[str], tuple[tuple[str, Callable[[], Any]], ...]]:
    """The names of all fields, and what makes those that need not be given."""
    if hasattr(kind, "_fields"):
        plain = kind._field_defaults
        return frozenset(kind._fields), tuple((name, partial(_same, plain[name])) for name in plain)
    made = []
    for field in dataclasses.fields(kind):
        if field.default_factory is not dataclasses.MISSING:
            made.append((field.name, field.default_factory))
        elif field.default is not dataclasses.MISSING:
            made.append((field.name, partial(_same, field.default)))
    return frozenset(field.name for field in dataclasses.fields(kind)), tuple(made)


def _same(value: Any) -> Any:
    return value


def _class(tag: str) -> Any:
    """A class of nouns by its tag.

    >>> _class("finding/1").__name__
    'Finding'
    """
    found = kind_of(tag)
    if not is_stored_class(found):
        raise FemstructError("results", got=f"'{tag}'", expected="a noun")
    return found


def _small(content: Any, value: Callable[[Any], Any]) -> Array:
    kind, shape, numbers = content
    made = np.array([value(number) for number in numbers], dtype=kind).reshape(shape)
    made.flags.writeable = False
    return made


def _rows(content: Any, value: Callable[[Any], Any]) -> csr_array:
    data, indices, starts, shape = (value(part) for part in content)
    return csr_array((data, indices, starts), shape=shape)


def _function(name: str, value: Callable[[Any], Any]) -> Callable[..., Any]:
    """A function with a tag; of any other what says that it is not in the file."""
    if "/" in name or tag_of_format_4(name):
        found: Callable[..., Any] = kind_of(name)
        return found

    def function(*_: object) -> Any:
        raise FemstructError(
            name,
            got="a function of which a results file has only the name",
            expected="itself",
            do="run the study again",
        )

    function.__module__, _, function.__qualname__ = name.partition(":")
    return function


def _member(content: Any, value: Callable[[Any], Any]) -> Enum:
    kind, name = content
    member: Enum = _class(kind)[name]
    return member


_READ: Final[Mapping[str, Callable[[Any, Callable[[Any], Any]], Any]]] = MappingProxyType(
    {
        "float": lambda told, value: float(told),
        "small": _small,
        "map": lambda told, value: {value(key): value(item) for key, item in told},
        "view": lambda told, value: MappingProxyType({value(key): value(item) for key, item in told}),
        "list": lambda told, value: [value(item) for item in told],
        "set": lambda told, value: {value(item) for item in told},
        "frozenset": lambda told, value: frozenset(value(item) for item in told),
        "rows": _rows,
        "enum": _member,
        "complex": lambda told, value: complex(*map(value, told)),
        "function": _function,
        "not kept": lambda told, value: NotKept(told),
    }
)


# ----------------------------------------------------------------------------------------------------------------------
# What a study found as one value in the results file, and back: nouns as a text, arrays where they stand already.
# ----------------------------------------------------------------------------------------------------------------------

Array_of_whole = NDArray[Any]
Place = tuple[str, int | None]  # a dataset, and the row of it that is meant, None for all of it
NOUNS: Final = "nouns"
NO_VARIABLE: Final = "This is a netCDF dimension but not a netCDF variable."  # says netCDF-4 of a bare length
SAMPLED: Final = 64  # numbers that arrays are told apart by at first sight
LEAST: Final = 4096  # bytes of a row of a table that may be an array of a noun


def write_whole(file: h5py.File, result: object, written: Mapping[str, Array_of_whole]) -> None:
    """Add the nouns of what was found to its file; of their arrays only those that no table has yet, each once.

    Parameters
    ----------
    written : Mapping[str, Array_of_whole]
        The large arrays of its tables, by the names of their datasets.
    """
    tables = json.dumps(store_value(result, _shelf(file, written)), allow_nan=False)
    put_text(file, NOUNS, tables, "The results as nouns (JSON)")


def read_whole(file: h5py.File) -> Any:
    """The nouns of what was found, as they were written."""
    read: dict[str, Array_of_whole] = {}

    def fetch(place: Place) -> Array_of_whole:
        name, row = place
        if name not in read:
            read[name] = file[name][()]
            read[name].flags.writeable = False
        return read[name] if row is None else read[name][row]

    return restore_value(Stored(*json.loads(file[NOUNS].asstr()[()])), fetch)


def _shelf(file: h5py.File, written: Mapping[str, Array_of_whole]) -> Callable[[Array_of_whole], Place]:
    """What finds an array among those of a file, or puts it there, and tells where."""
    known: dict[tuple[object, ...], list[tuple[Place, Array_of_whole]]] = {}
    shelf = group(file, "arrays", "Arrays of the nouns that are in no table")

    def keep(array: Array_of_whole) -> Place:
        array = np.ascontiguousarray(array)
        alike = known.setdefault(_print(array), [])
        for place, other in alike:
            if np.array_equal(_bytes(other), _bytes(array)):
                return place
        name = f"{len(shelf):06d}"
        axes = [_of_length(shelf, length) for length in array.shape]
        put(shelf, name, array, "as the noun's", "Array of a noun", axes)
        alike.append(((f"{shelf.name}/{name}", None), array))
        return alike[-1][0]

    for name, whole in written.items():
        known.setdefault(_print(whole), []).append(((name, None), whole))
        if whole.ndim > 1 and whole[0].nbytes >= LEAST:
            for number, row in enumerate(whole):
                known.setdefault(_print(row), []).append(((name, number), row))
    return keep


def _of_length(shelf: h5py.Group, length: int) -> str:
    """An axis without a meaning of its own."""
    name = f"of {length}"
    if name not in shelf:
        shelf.create_dataset(name, (length,), "i1").make_scale(NO_VARIABLE)  # takes no room: nothing is written to it
        shelf[name].attrs.update(unit="1", description="A length", sha256=sha256(bytes(length)).hexdigest())
    return name


def _bytes(array: Array_of_whole) -> Array_of_whole:
    """Its bytes: zeros of either sign, and nans, are told apart."""
    return np.ascontiguousarray(array).reshape(-1).view(np.uint8)


def _print(array: Array_of_whole) -> tuple[object, ...]:
    """What alike arrays have in common, and others hardly: a few of their numbers, from end to end."""
    flat = array.reshape(-1)
    return array.dtype, array.shape, flat[:: max(1, flat.size // SAMPLED)].tobytes()
