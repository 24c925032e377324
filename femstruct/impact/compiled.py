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
# options of njit; its type stubs leave some out. What a kernel does not say it takes from its first caller
_OPTIONS: Final[dict[str, Any]] = {"cache": True, "error_model": "numpy", "_nrt": False, "fastmath": False}
_COUNTED: Final[dict[str, Any]] = {**_OPTIONS, "_nrt": True}
_SUMS: Final[dict[str, Any]] = {**_OPTIONS, "fastmath": {"reassoc", "contract", "nsz"}}


def kernel(function: F) -> F:
    """The function, compiled at its first call and cached; typed like the Python it was written in."""
    return cast(F, njit(**_OPTIONS)(function))


def making(function: F) -> F:
    """As `kernel`, for what makes arrays and is not called in every step."""
    return cast(F, njit(**_COUNTED)(function))


def released(function: F) -> F:
    """As `kernel`, and other threads run meanwhile."""
    return cast(F, njit(**_OPTIONS, nogil=True)(function))


def summing(function: F) -> F:
    """As `kernel`, for plain sums: the order of the terms is the compiler's, so that it can use vectors."""
    return cast(F, njit(**_SUMS)(function))


def inlined(function: F) -> F:
    """As `kernel`, written into what calls it: for the few parts of a step that take some hundred arguments, whose
    passing costs more than the call does."""
    return cast(F, njit(**_OPTIONS, forceinline=True)(function))


def inlined_sum(function: F) -> F:
    """As `summing`, and `inlined`."""
    return cast(F, njit(**_SUMS, forceinline=True)(function))
