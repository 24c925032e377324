"""The one place where kernels are compiled: numba, cached on disk, IEEE division.

Kernels count no references to the arrays they touch: each count is an atomic operation, and those of a march took two
thirds of its time. So a kernel makes no array and assigns none to a slice (numba refuses to compile it); what makes
arrays is `making`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., object])
_SHARED: Final[dict[str, Any]] = {"cache": True, "error_model": "numpy"}
_UNCOUNTED: Final[dict[str, Any]] = {**_SHARED, "_nrt": False}  # an option of njit that its type stubs leave out


def kernel(function: F) -> F:
    """The function, compiled at its first call and cached; typed like the Python it was written in."""
    return cast(F, njit(**_UNCOUNTED)(function))


def making(function: F) -> F:
    """As `kernel`, for what makes arrays and is not called in every step."""
    return cast(F, njit(**_SHARED)(function))


def released(function: F) -> F:
    """As `kernel`, and other threads run meanwhile."""
    return cast(F, njit(**_UNCOUNTED, nogil=True)(function))


def summing(function: F) -> F:
    """As `kernel`, for plain sums: the order of the terms is the compiler's, so that it can use vectors."""
    return cast(F, njit(**_UNCOUNTED, fastmath={"reassoc", "contract", "nsz"})(function))
