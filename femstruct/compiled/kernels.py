"""What a kernel is, and a unit: what is compiled, kept and loaded as one piece of machine code.

A kernel is a plain Python function of numbers and arrays that loops over them; from Python it runs as such, slowly.
A unit is a kernel that Python calls in compiled form, and that other units call without being compiled together
with it. A kernel makes no array and no named tuple, and reads no global but constants, kernels and units.
"""

from __future__ import annotations

import hashlib
import platform
import sys
from collections.abc import Callable, Iterator, Sequence
from ctypes import CFUNCTYPE, c_double, c_void_p
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import version
from pathlib import Path
from types import CodeType, FunctionType
from typing import Annotated, Any, Final, Generic, ParamSpec, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

from femstruct.arrays import Floats, Integers

# ----------------------------------------------------------------------------------------------------------------------
# How values are laid out for compiled kernels: by address, as words that a kernel reads where it needs them.
#
# A named tuple of arrays passed by value is some hundred numbers that the compiler takes apart at every call; that was
# most of the time it took. Laid out once a call it is one address.
# ----------------------------------------------------------------------------------------------------------------------

Vector = Annotated[Floats, 1]
Matrix = Annotated[Floats, 2]
Cube = Annotated[Floats, 3]
Floats4 = Annotated[Floats, 4]
Floats5 = Annotated[Floats, 5]
Floats6 = Annotated[Floats, 6]
Counts = Annotated[Integers, 1]
CountTable = Annotated[Integers, 2]

_PLAIN: Final = {"int": np.dtype(np.int64), "bool": np.dtype(np.int64), "float": np.dtype(np.float64)}


@dataclass(frozen=True)
class Slot:
    """A value and where its words begin. kind : "int", "bool", "float", "array" or "tuple".

    An array [ndim] of this dtype is its address and its lengths; a named tuple is the address of its own words.
    """

    name: str
    at: int
    kind: str
    dtype: np.dtype[Any] | None = None
    ndim: int = 0
    inner: TupleLayout | None = None


@dataclass(frozen=True)
class TupleLayout:
    """The slots of a named tuple, and how many words they take."""

    name: str
    slots: tuple[Slot, ...]
    words: int


@cache
def layout_of(kind: type) -> TupleLayout:
    """The layout of a named tuple by the types of its fields: int, bool, float, an array annotated with its number of
    dimensions (`Vector`, `Matrix`, ...) or its record dtype, or another named tuple.

    Raises TypeError for any other field.

    >>> from typing import NamedTuple
    >>> class Ball(NamedTuple):
    ...     mass: float
    ...     place: Vector
    >>> [(slot.name, slot.at, slot.kind) for slot in layout_of(Ball).slots], layout_of(Ball).words
    ([('mass', 0, 'float'), ('place', 1, 'array')], 3)
    """
    hints = get_type_hints(kind, include_extras=True)
    slots, at = [], 0
    for name in kind._fields:  # type: ignore[attr-defined]
        slot = slot_of(f"{kind.__name__}.{name}", name, at, hints[name])
        slots.append(slot)
        at += 1 + slot.ndim
    return TupleLayout(kind.__qualname__, tuple(slots), at)


def slot_of(where: str, name: str, at: int, hint: Any) -> Slot:
    """The slot of a value of this type. Raises TypeError for one that has no layout."""
    if get_origin(hint) is Annotated:
        values, extra = get_args(hint)[:2]
        if isinstance(extra, tuple):  # records: dtype, dimensions
            return Slot(name, at, "array", extra[0], extra[1])
        return Slot(name, at, "array", np.dtype(np.int64 if values == Integers else np.float64), extra)
    if isinstance(hint, type) and hint.__name__ in _PLAIN:
        return Slot(name, at, hint.__name__)
    if isinstance(hint, type) and hasattr(hint, "_fields"):
        return Slot(name, at, "tuple", inner=layout_of(hint))
    raise TypeError(f"{where}: {hint} has no layout for a kernel")


def laid_out(layout: TupleLayout, values: Sequence[Any], alive: list[Any]) -> int:
    """Address of the words of a named tuple.

    Parameters
    ----------
    alive : list[Any]
        Takes what must live as long as they are used.

    Raises
    ------
    TypeError
        For an array of another dtype or number of dimensions, or one that is not contiguous: a kernel would read
        something else.
    """
    words = np.empty(layout.words, dtype=np.int64)
    numbers = words.view(np.float64)
    for slot, value in zip(layout.slots, values, strict=True):
        if slot.kind == "array":
            if value.dtype != slot.dtype or value.ndim != slot.ndim or not value.flags.c_contiguous:
                raise TypeError(
                    f"{layout.name}.{slot.name}: got {value.dtype} in {value.ndim} dimensions, strides "
                    f"{value.strides}; expected contiguous {slot.dtype} in {slot.ndim}"
                )
            words[slot.at] = value.ctypes.data
            words[slot.at + 1 : slot.at + 1 + slot.ndim] = value.shape
        elif slot.kind == "float":
            numbers[slot.at] = value
        elif slot.inner is not None:
            words[slot.at] = laid_out(slot.inner, value, alive)
        else:
            words[slot.at] = int(value)
    alive.append(words)
    return int(words.ctypes.data)


# ----------------------------------------------------------------------------------------------------------------------
# Kernels, and units of them.
# ----------------------------------------------------------------------------------------------------------------------

F = TypeVar("F", bound=Callable[..., object])
P = ParamSpec("P")
R = TypeVar("R")

LEVEL: Final = 2  # of LLVM's optimisation: 3 takes half as long again and is not faster
MARK: Final = "_femstruct_sums"


def kernel(function: F) -> F:
    """Mark a function as one that compiled code may call."""
    setattr(function, MARK, False)
    return function


def summing(function: F) -> F:
    """As `kernel`, for plain sums: the order of the terms is the compiler's, so that it can use vectors."""
    setattr(function, MARK, True)
    return function


def call_at(address: int, x: float, y: float, numbers: Floats) -> float:
    """Value of the C function `double f(double, double, const double *)` at an address, as kernels call it.

    Parameters
    ----------
    numbers : Floats
        Begins where the pointer points to.
    """
    function = CFUNCTYPE(c_double, c_double, c_double, c_void_p)(int(address))
    return float(function(x, y, numbers.ctypes.data))


class CompiledUnit(Generic[P, R]):
    """A kernel that is compiled by itself. Its arguments are numbers and named tuples with a layout, its value an int.

    seconds : about how long it takes to compile, on a usual core: for the remaining time that is shown.
    """

    def __init__(self, function: Callable[P, R], seconds: float) -> None:
        assert isinstance(function, FunctionType)
        self.python: FunctionType = function
        self.seconds = seconds
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.symbol = self.name.replace(".", "_")
        self.__doc__, self.__name__, self.__wrapped__ = function.__doc__, function.__name__, function
        self.__module__ = function.__module__

    @cached_property
    def slots(self) -> tuple[Slot, ...]:
        """The arguments."""
        hints = get_type_hints(self.python, include_extras=True)
        code = self.python.__code__
        names = code.co_varnames[: code.co_argcount]
        return tuple(slot_of(f"{self.name}({name})", name, i, hints[name]) for i, name in enumerate(names))

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        alive: list[Any] = []
        names = [slot.name for slot in self.slots[len(args) :]]
        if kwargs.keys() != set(names):
            raise TypeError(f"{self.name}: got {', '.join(kwargs)}; expected {', '.join(names)}")
        given: tuple[Any, ...] = (*args, *(kwargs[name] for name in names))
        ready = [
            laid_out(slot.inner, value, alive) if slot.inner is not None else value
            for slot, value in zip(self.slots, given, strict=True)
        ]
        return self._native(*ready)  # type: ignore[no-any-return]

    @cached_property
    def _native(self) -> Any:
        from femstruct.compiled.store import native

        return native(self)

    @cached_property
    def fingerprint(self) -> str:
        """What the machine code depends on: the Python of all kernels in it, layouts, versions, and the processor."""
        digest = hashlib.sha256(_surroundings().encode())
        for function in kernels_of(self):
            digest.update(f"{function.__module__}.{function.__qualname__} {getattr(function, MARK, None)}".encode())
            digest.update(_code(function.__code__))
            digest.update(repr(sorted(_constants(function))).encode())
        units: list[CompiledUnit[..., Any]] = [self, *units_called(self)]
        for one in units:
            digest.update(f"{one.symbol} {one.slots}".encode())
        return digest.hexdigest()


def unit(seconds: float) -> Callable[[Callable[P, R]], CompiledUnit[P, R]]:
    """Make a kernel a unit.

    Parameters
    ----------
    seconds : float
        About how long it takes to compile.
    """

    def made(function: Callable[P, R]) -> CompiledUnit[P, R]:
        setattr(function, MARK, False)
        return CompiledUnit(function, seconds)

    return made


def kernels_of(unit: CompiledUnit[..., Any]) -> list[FunctionType]:
    """The functions that are compiled in a unit, its own first."""
    found = [unit.python]
    for function in found:
        found += [value for _, value in _globals(function) if hasattr(value, MARK) and value not in found]
    return found


def units_called(unit: CompiledUnit[..., Any]) -> list[CompiledUnit[..., Any]]:
    """The units that a unit needs beside itself, those that they need among them."""
    found: list[CompiledUnit[..., Any]] = []
    for one in (unit, *found):
        for function in kernels_of(one):
            for _, value in _globals(function):
                if isinstance(value, CompiledUnit) and value is not unit and value not in found:
                    found += [value, *(other for other in units_called(value) if other not in found)]
    return found


def _globals(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """What a function reads of its module, and of the function it was made in, by name."""
    for name in _names(function.__code__):
        if name in function.__globals__:
            yield name, function.__globals__[name]
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        yield name, cell.cell_contents


def _names(code: CodeType) -> tuple[str, ...]:
    inner = (name for const in code.co_consts if isinstance(const, CodeType) for name in _names(const))
    return (*code.co_names, *inner)


def _constants(function: FunctionType) -> Iterator[str]:
    for name, value in _globals(function):
        if isinstance(value, int | float | str | tuple):
            yield f"{name}={value!r}"


def _code(code: CodeType) -> bytes:
    consts = [_code(const) if isinstance(const, CodeType) else const for const in code.co_consts]
    return repr((code.co_code, consts, code.co_names, code.co_varnames)).encode()


@cache
def _surroundings() -> str:
    """Versions, processor, and the text of what translates."""
    here = Path(__file__).parent
    texts = [(here / name).read_bytes() for name in ("kernels.py", "translate.py")]
    versions = [version(package) for package in ("numba", "llvmlite", "numpy")]
    return repr((sys.version_info[:3], platform.machine(), _processor(), LEVEL, versions, texts))


@cache
def _processor() -> str:
    """The processor that machine code is made for, with what it can."""
    import llvmlite.binding as llvm

    return f"{llvm.get_host_cpu_name()} {llvm.get_host_cpu_features().flatten()}"
