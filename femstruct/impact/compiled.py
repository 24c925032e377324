"""The one place where kernels are compiled: numba, cached on disk, IEEE division."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """The function, compiled at its first call and cached; typed like the Python it was written in."""
    return cast(F, njit(cache=True, error_model="numpy")(function))


def released(function: F) -> F:
    """As `kernel`, and other threads run meanwhile."""
    return cast(F, njit(cache=True, error_model="numpy", nogil=True)(function))


def summing(function: F) -> F:
    """As `kernel`, for plain sums: the order of the terms is the compiler's, so that it can use vectors."""
    return cast(F, njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})(function))
