"""The one interface to solvers of sparse symmetric systems: analysed once by pattern, factored for any values on it.

Dense fronts by LAPACK serve where nothing else is installed, SuperLU of SciPy where the matrix is complex. rslab (the
`fast` extra) is taken where it is installed. Of all of them the analysis serves every factor and every count.
"""

from __future__ import annotations

from functools import cached_property
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from femstruct.arrays import Floats
from femstruct.sparse.fronts import Fronts
from femstruct.sparse.patterns import Pattern, Values

# Diagonal pivots in a symmetric order. Without SymmetricMode this ordering is a hundred times slower.
_SYMMETRIC = {"SymmetricMode": True}
# Nearly diagonal pivots keep the sparsity; off-diagonal ones are taken where three digits are lost.
_COMPLEX_PIVOT = 1e-3
# Least eigenvalue, of a matrix scaled to a diagonal of terms of size 1, under which its sign may be rounding: that of a
# free frame has been seen to be wrong at 2e-17. Inside the spectrum of a plate of 200 x 200 it is 1e-9.
_LEAST_PIVOT = 1e-13


class ZeroPivot(Exception):
    """The matrix is singular to working precision."""


class Factored(Protocol):
    """A factor of a symmetric matrix A."""

    def solve(self, load: Values, /) -> Any:
        """A^-1 load, of [n] or [n, m], real or complex as A is."""


class Analysis(Protocol):
    """A pattern analysed: factors of matrices on it, and counts of their negative eigenvalues."""

    def factor(self, values: Values) -> Factored:
        """Factor of the matrix of these values, real symmetric or complex symmetric; raises ZeroPivot."""

    def negative(self, values: Floats, scale: Floats) -> int | None:
        """Number of negative eigenvalues; None where rounding may have decided one.

        scale [n] : size of the terms each diagonal entry is summed from.

        Source: Sylvester's law of inertia; B. N. Parlett, The Symmetric Eigenvalue Problem, section 3.3.
        """


class Solver(Protocol):
    """What analyses a pattern."""

    def __call__(self, pattern: Pattern, /) -> Analysis: ...


class LapackFronts:
    """Nested dissection and dense fronts of what is real; SuperLU, with minimum degree, of what is complex."""

    def __init__(self, pattern: Pattern) -> None:
        self._pattern = pattern

    def factor(self, values: Values) -> Factored:
        try:
            if not np.iscomplexobj(values):
                return self._fronts.factor(values)
            A = self._pattern.matrix(values)
            return splu(A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=_COMPLEX_PIVOT, options=_SYMMETRIC)
        except (LinAlgError, RuntimeError) as error:
            raise ZeroPivot(str(error)) from error

    def negative(self, values: Floats, scale: Floats) -> int | None:
        return self._fronts.negative(values, scale)

    @cached_property
    def _fronts(self) -> Fronts:
        return Fronts(self._pattern)


class Rslab:
    """Approximate minimum degree and Bunch-Kaufman pivots within supernodes."""

    def __init__(self, pattern: Pattern) -> None:
        self._pattern, self._size = pattern, pattern.size
        kept = np.flatnonzero(self._lower).astype(np.int32)
        parts = (np.ones(len(kept)), pattern.indices[kept], np.searchsorted(kept, pattern.indptr))
        lower = csc_array(parts, shape=(pattern.size, pattern.size))
        # Its default races several orderings, which costs four times the factor.
        self._analysis = import_module("rslab").analyze(lower, path="ldlt", ordering="amd", threads=1)

    def factor(self, values: Values) -> Factored:
        return self._factored(values)

    def negative(self, values: Floats, scale: Floats) -> int | None:
        try:
            factored = self._factored(values)
        except ZeroPivot:
            return None
        root = np.sqrt(scale)
        shape = np.random.default_rng(1).standard_normal(self._size)
        shape = root * factored.solve(root * shape)  # twice: towards the shape of the least eigenvalue
        least = float(np.linalg.norm(shape)) / float(np.linalg.norm(root * factored.solve(root * shape)))
        return factored.negative if least > _LEAST_PIVOT else None

    @property
    def _lower(self) -> NDArray[np.bool_]:
        """Which entries are on and below the diagonal; found again for each factor, in a hundredth of its time."""
        return np.asarray(self._pattern.indices >= self._pattern.owner)

    def _factored(self, values: Values) -> _RslabFactor:
        try:
            return _RslabFactor(self._analysis.factor(values[self._lower]))
        except RuntimeError as error:
            raise ZeroPivot(str(error)) from error


class _RslabFactor:
    def __init__(self, factor: Any) -> None:
        self._factor = factor

    @property
    def negative(self) -> int:
        """Negative eigenvalues by the pivots."""
        return int(self._factor.inertia[1])

    def solve(self, load: Values) -> Values:
        answer: Values
        if load.ndim == 1:
            answer = self._factor.solve(np.ascontiguousarray(load))
        else:
            answer = self._factor.solve_many(np.ascontiguousarray(load))
        return answer


SOLVERS: Final[dict[str, Solver]] = {"LAPACK fronts": LapackFronts} | ({"rslab": Rslab} if find_spec("rslab") else {})
"""Those at hand, by name; the fastest last."""
FASTEST: Final[str] = list(SOLVERS)[-1]
