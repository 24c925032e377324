"""Small full systems of equations, solved in place: a kernel makes no arrays, as a library would."""

from __future__ import annotations

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel


@kernel
def solve_dense(matrix: Floats, right: Floats, size: int) -> bool:
    """Gauss elimination with row pivots of the first `size` rows and columns, in place; the answer is in `right`.
    False for a singular matrix."""
    for i in range(size):
        pivot = i
        for m in range(i + 1, size):
            if abs(matrix[m, i]) > abs(matrix[pivot, i]):
                pivot = m
        if not abs(matrix[pivot, i]) > 0.0:
            return False
        if pivot != i:
            for j in range(i, size):
                matrix[i, j], matrix[pivot, j] = matrix[pivot, j], matrix[i, j]
            right[i], right[pivot] = right[pivot], right[i]
        for m in range(i + 1, size):
            factor = matrix[m, i] / matrix[i, i]
            if factor != 0.0:
                for j in range(i + 1, size):
                    matrix[m, j] -= factor * matrix[i, j]
                right[m] -= factor * right[i]
    for i in range(size - 1, -1, -1):
        total = right[i]
        for j in range(i + 1, size):
            total -= matrix[i, j] * right[j]
        right[i] = total / matrix[i, i]
    return True
