"""Block Lanczos with full orthogonalisation for (K - sigma M)^-1 M: several right-hand sides at once, no restart."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, csr_array

from femstruct.arrays import Floats
from femstruct.errors import NotConverged

# Solves of several right-hand sides read the factor once. More of them at once need more vectors in all; rigid modes,
# up to six of one eigenvalue, are found together. Where a vector takes 4 MB and more, fewer of them are worth a tenth
# of the time: 20 modes of a million unknowns take 150 MB less.
BLOCK, BLOCK_OF_MANY = 8, 6
MANY = 500_000  # unknowns
MOST_VECTORS = 400
_GONE = 1e-12  # of its length: what is left of a vector that lies in the space already


class Krylov:
    """An M-orthonormal basis Q of a Krylov space of (K - sigma M)^-1 M, and H = Q^T M (K - sigma M)^-1 M Q on it.

    The first `expanded` columns of Q have been multiplied; their images lie in Q altogether.
    """

    def __init__(self, M: csc_array, solve: Callable[[Floats], Floats]) -> None:
        self._M, self._solve = csr_array(M.T), solve
        self._heaviest = float(M.diagonal().max())
        self._block = BLOCK if M.shape[0] < MANY else BLOCK_OF_MANY
        self._rng = np.random.default_rng(0)
        self._Q = np.empty((M.shape[0], 0), order="F")
        self._H: Floats = np.zeros((0, 0))
        self._weighed: list[Floats] = []  # M times the columns that wait, in the blocks they came in
        self._columns = self.expanded = 0
        self.widen()

    def widen(self) -> None:
        """Add directions that chance chooses: they find what the others had no part of."""
        start = self._solve(self._M @ self._rng.standard_normal((self._M.shape[0], self._block)))
        size = float(np.linalg.norm(start, axis=0).max())
        self._append(*self._orthogonal(start)[1:], size)

    def expand(self) -> bool:
        """Multiply the next block; False where the space holds all that it can reach."""
        if not self._weighed:
            return False
        images = self._solve(self._weighed.pop(0))
        new = slice(self.expanded, self.expanded + images.shape[1])
        size = float(np.linalg.norm(images, axis=0).max())
        shares, left, weighed = self._orthogonal(images)
        before = self._columns
        triangle = self._append(left, weighed, size)
        self._H[:before, new] = shares
        self._H[before : self._columns, new] = triangle
        self.expanded = new.stop
        return True

    def ritz(self) -> tuple[Floats, Floats, Floats]:
        """Eigenvalues of (K - sigma M)^-1 M, descending, their vectors in Q, and the lengths of their residuals."""
        m = self.expanded
        inner = self._H[:m, :m]
        values, vectors = eigh(0.5 * (inner + inner.T))
        values, vectors = values[::-1], vectors[:, ::-1]
        return values, vectors, np.linalg.norm(self._H[m : self._columns, :m] @ vectors, axis=0)

    def shapes(self, vectors: Floats) -> Floats:
        """Shapes [n, k] of vectors [expanded, k] in Q."""
        product: Floats = self._Q[:, : self.expanded] @ vectors
        return product

    def _orthogonal(self, vectors: Floats) -> tuple[Floats, Floats, Floats]:
        """(shares of Q in the vectors, what is left of them, M times what is left); in the place of the vectors."""
        basis = self._Q[:, : self._columns]
        total = basis.T @ (self._M @ vectors)
        vectors -= basis @ total
        weighed = self._M @ vectors
        again = basis.T @ weighed  # rounding of the first pass: too small to weigh once more
        vectors -= basis @ again
        return total + again, vectors, weighed

    def _append(self, vectors: Floats, weighed: Floats, size: float) -> Floats:
        """M-orthonormal columns for the vectors, of which those that are rounding are dropped; returns R of Q R."""
        triangle: Floats = np.eye(vectors.shape[1])
        floor = (_GONE * size) ** 2 * self._heaviest
        for _ in range(2):
            gram = vectors.T @ weighed
            squared, turn = eigh(0.5 * (gram + gram.T))
            kept = squared > max(floor, _GONE**2 * squared[-1])
            root = np.sqrt(squared[kept])
            triangle = (root[:, None] * turn[:, kept].T) @ triangle
            vectors, weighed = vectors @ (turn[:, kept] / root), weighed @ (turn[:, kept] / root)
            if not len(root):
                return triangle
            floor = 0.0
        count = vectors.shape[1]
        self._reserve(self._columns + count)
        self._Q[:, self._columns : self._columns + count] = vectors
        self._weighed.append(weighed)
        self._columns += count
        return triangle

    def _reserve(self, columns: int) -> None:
        held = self._Q.shape[1]
        if columns > held:
            basis, inner = _room(len(self._Q), max(columns, 2 * held, 32 * BLOCK))
            basis[:, :held], inner[:held, :held] = self._Q, self._H
            self._Q, self._H = basis, inner


def _room(rows: int, columns: int) -> tuple[Floats, Floats]:
    """Q and H for so many columns; memory is taken only by those that are written."""
    return np.empty((rows, columns), order="F"), np.zeros((columns, columns))


def converge(space: Krylov, k: int, tol: float) -> tuple[Floats, Floats]:
    """The k largest eigenvalues of (K - sigma M)^-1 M, descending, and their shapes [n, k]; fewer if there are fewer.

    tol : residual over eigenvalue; where rounding does not let it be reached, the space grows until it is complete.

    Raises NotConverged where that would take more than MOST_VECTORS, some ten times what it takes as a rule.
    """
    look = k
    while True:
        if space.expanded >= look:
            values, vectors, residuals = space.ritz()
            if (residuals[:k] <= tol * values[:k]).all():
                return values[:k], space.shapes(vectors[:, :k])
            if space.expanded > max(MOST_VECTORS, 6 * k):
                reached = float((residuals[:k] / values[:k]).max())
                raise NotConverged(
                    "modes",
                    got=f"{k} modes to {reached:.1g} of their eigenvalues with {space.expanded} vectors",
                    expected=f"{tol:.1g}",
                    do="stiffnesses or masses lie too far apart: look for a mistaken unit or size, or ask for fewer",
                )
            look = space.expanded + max(BLOCK, space.expanded // 20)
        if not space.expand():
            values, vectors, _ = space.ritz()
            real = values[:k] > 1e-13 * values[0]  # massless shapes have no finite frequency
            return values[:k][real], space.shapes(vectors[:, :k][:, real])
