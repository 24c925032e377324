"""Read-only arrays for the frozen nouns of the package acoustics."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acoustics.errors import AcousticsError

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Integers = NDArray[np.int64]
Array = TypeVar("Array", Floats, Complexes)


def frozen(name: str, values: ArrayLike, shape: tuple[int | None, ...], *, blanks: bool = False) -> Floats:
    """Read-only float64 array of `values`; None in `shape` accepts any length.

    Copies, unless the array is read-only down to the memory it looks at (then nobody else can change it).

    Parameters
    ----------
    blanks : bool
        Whether nan may stand where a value is not known.

    Raises
    ------
    AcousticsError
        When the shape is another or a value is not finite.

    Examples
    --------
    >>> frozen("size", [1, 2], (2,)).flags.writeable
    False
    """
    return _frozen(name, _numbers(name, values, np.float64), shape, blanks)


def frozen_complex(name: str, values: ArrayLike, shape: tuple[int | None, ...]) -> Complexes:
    """Read-only complex128 array of `values`, as `frozen`."""
    return _frozen(name, _numbers(name, values, np.complex128), shape)


def _numbers(name: str, values: ArrayLike, dtype: type[np.generic]) -> NDArray[Any]:
    try:
        if dtype is np.float64 and np.iscomplexobj(values):  # numpy would drop what is imaginary, with a warning
            raise TypeError
        return np.asarray(values, dtype=dtype)
    except (ValueError, TypeError, OverflowError):
        got = " ".join(repr(values).split())
        kind = "real numbers" if dtype is np.float64 else "numbers"
        raise AcousticsError(name, got=got, expected=f"{kind}, in rows of equal length") from None


def _frozen(name: str, array: Array, shape: tuple[int | None, ...], blanks: bool = False) -> Array:
    if len(array.shape) != len(shape) or any(e is not None and g != e for g, e in zip(array.shape, shape, strict=True)):
        raise AcousticsError(name, got=f"shape {array.shape}", expected=f"shape {shape}".replace("None", "any"))
    if not (np.isfinite(array) | (blanks & np.isnan(array))).all():
        raise AcousticsError(name, got="nan or infinity", expected="finite numbers")
    if not _sealed(array):
        array = array.copy()
        array.flags.writeable = False
    return array


def _sealed(array: Floats | Complexes) -> bool:
    """Whether neither the array nor any array it is a view of can be written to."""
    base: object = array
    while isinstance(base, np.ndarray):
        if base.flags.writeable:
            return False
        base = base.base
    return base is None


def freeze(instance: object, **fields: Any) -> None:
    """Set fields of a frozen dataclass from its own ``__post_init__``."""
    for name, value in fields.items():
        object.__setattr__(instance, name, value)


def positive(name: str, value: float, unit: str) -> float:
    """`value` as a float when it is finite and above zero, else AcousticsError."""
    number = float(value)
    if not (np.isfinite(number) and number > 0):
        raise AcousticsError(name, got=f"{number:g} {unit}".strip(), expected="a positive finite number")
    return number
