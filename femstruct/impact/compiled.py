"""The one place where kernels are compiled: numba, cached on disk, IEEE division.

Kernels count no references to the arrays they touch: each count is an atomic operation, and those of a march took two
thirds of its time. So a kernel makes no array and assigns none to a slice (numba refuses to compile it); what makes
arrays is `making`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """The function, compiled at its first call and cached; typed like the Python it was written in."""
    return cast(F, njit(cache=True, error_model="numpy", _nrt=False)(function))


def making(function: F) -> F:
    """As `kernel`, for what makes arrays and is not called in every step."""
    return cast(F, njit(cache=True, error_model="numpy", _nrt=True)(function))


def released(function: F) -> F:
    """As `kernel`, and other threads run meanwhile."""
    return cast(F, njit(cache=True, error_model="numpy", _nrt=False, nogil=True)(function))


def summing(function: F) -> F:
    """As `kernel`, for plain sums: the order of the terms is the compiler's, so that it can use vectors."""
    return cast(F, njit(cache=True, error_model="numpy", _nrt=False, fastmath={"reassoc", "contract", "nsz"})(function))
