"""How values are laid out for compiled kernels: by address, as words that a kernel reads where it needs them.

A named tuple of arrays passed by value is some hundred numbers that the compiler takes apart at every call; that was
most of the time it took. Laid out once a call it is one address.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Final, get_args, get_origin, get_type_hints

import numpy as np

from femstruct.arrays import Floats, Integers

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
    inner: Layout | None = None


@dataclass(frozen=True)
class Layout:
    """The slots of a named tuple, and how many words they take."""

    name: str
    slots: tuple[Slot, ...]
    words: int


@cache
def layout_of(kind: type) -> Layout:
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
    return Layout(kind.__qualname__, tuple(slots), at)


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


def laid_out(layout: Layout, values: Sequence[Any], alive: list[Any]) -> int:
    """Address of the words of a named tuple; alive : takes what must live as long as they are used.

    Raises TypeError for an array of another dtype or number of dimensions, or one that is not contiguous: a kernel
    would read something else.
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
