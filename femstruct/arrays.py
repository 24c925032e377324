"""Read-only arrays for the frozen nouns."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from femstruct.errors import InputError

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def frozen(name: str, values: ArrayLike, shape: tuple[int | None, ...]) -> Floats:
    """Read-only float64 copy of `values`; None in `shape` accepts any length.

    Raises InputError for what are no numbers in rows of equal length, for another shape, and for values that are not
    finite.

    >>> frozen("size", [1, 2], (2,)).flags.writeable
    False
    """
    array = _copied(name, values, np.float64)
    _check_shape(name, array.shape, shape)
    if not np.isfinite(array).all():
        raise InputError(name, got="nan or infinity", expected="finite numbers")
    array.flags.writeable = False
    return array


def frozen_with_gaps(name: str, values: ArrayLike, shape: tuple[int | None, ...]) -> Floats:
    """Read-only float64 copy of `values`, of which some may be nan: there is no number.

    >>> frozen_with_gaps("levels", [1.0, np.nan], (2,)).tolist()
    [1.0, nan]
    """
    array = _copied(name, values, np.float64)
    _check_shape(name, array.shape, shape)
    array.flags.writeable = False
    return array


def frozen_integers(name: str, values: ArrayLike, shape: tuple[int | None, ...]) -> Integers:
    """Read-only int64 copy of `values`; None in `shape` accepts any length. 0.5 is refused, 2.0 is 2."""
    array = _copied(name, values, np.int64)
    if not np.array_equal(array, np.asarray(values)):
        raise InputError(name, got=" ".join(repr(values).split()), expected="whole numbers")
    _check_shape(name, array.shape, shape)
    array.flags.writeable = False
    return array


def freeze(instance: object, **arrays: Any) -> None:
    """Set fields of a frozen dataclass from its own ``__post_init__``."""
    for name, value in arrays.items():
        object.__setattr__(instance, name, value)


def _copied(name: str, values: ArrayLike, dtype: type[np.generic]) -> NDArray[Any]:
    try:
        if np.iscomplexobj(values):  # numpy would drop what is imaginary, with a warning
            raise TypeError
        return np.array(values, dtype=dtype)
    except (ValueError, TypeError, OverflowError):
        got = " ".join(repr(values).split())
        raise InputError(name, got=got, expected="real numbers, in rows of equal length") from None


def _check_shape(name: str, got: tuple[int, ...], expected: tuple[int | None, ...]) -> None:
    if len(got) != len(expected) or any(e is not None and g != e for g, e in zip(got, expected, strict=True)):
        raise InputError(name, got=f"shape {got}", expected=f"shape {expected}".replace("None", "any"))
