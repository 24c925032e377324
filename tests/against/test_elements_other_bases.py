"""Plate elements against the same spaces built another way: monomials in global coordinates, 40 digits."""

import mpmath
import numpy as np
import pytest

from femstruct.elements import plate

ROUNDING = 1e-13  # rounding: 2e-16 here at most

TERMS = {
    "acm12": [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (3, 1), (1, 3)],
    "bfs16": [(i, j) for i in range(4) for j in range(4)],
}
D = np.array([[3.0, 0.7, 0.2], [0.7, 5.0, -0.4], [0.2, -0.4, 1.3]])  # fully anisotropic: every pair of curvatures acts
CELLS = [(0.013, 0.008), (1.7, 0.35), (0.2, 2.1)]


def falling(power, order):
    result = 1
    for k in range(order):
        result *= power - k
    return result


def monomial(term, order, x, y):
    """Derivative of x^i y^j; order (p, q)."""
    (i, j), (p, q) = term, order
    if i < p or j < q:
        return mpmath.mpf(0)
    return falling(i, p) * falling(j, q) * x ** (i - p) * y ** (j - q)


def shapes(kind, a, b):
    """Monomial coefficients of the shape functions, one a column, in the DOFs w, w_y, -w_x (, w_xy)."""
    terms = TERMS["bfs16" if kind == "hermite12" else kind]
    rows = []
    for x, y in ((0, 0), (0, b), (a, b), (a, 0)):
        for order, sign in (((0, 0), 1), ((0, 1), 1), ((1, 0), -1), ((1, 1), 1))[: len(terms) // 4]:
            rows.append([sign * monomial(term, order, mpmath.mpf(x), mpmath.mpf(y)) for term in terms])
    coefficients = mpmath.matrix(rows) ** -1
    keep = [k for k in range(len(terms)) if kind != "hermite12" or k % 4 != 3]
    return terms, np.array(coefficients.tolist(), dtype=object)[:, keep]


def moment_matrix(terms, left, right, a, b):
    """Integrals over the cell of the products of two derivatives of the monomials."""
    result = np.empty((len(terms), len(terms)), dtype=object)
    for row, (i, j) in enumerate(terms):
        for column, (k, m) in enumerate(terms):
            factor = falling(i, left[0]) * falling(j, left[1]) * falling(k, right[0]) * falling(m, right[1])
            p, q = i + k - left[0] - right[0] + 1, j + m - left[1] - right[1] + 1
            result[row, column] = mpmath.mpf(factor) * a**p * b**q / (p * q) if factor else mpmath.mpf(0)
    return result


@pytest.mark.parametrize("kind", plate.KINDS)
@pytest.mark.parametrize(("a", "b"), CELLS)
def test_stiffness_mass_shapes_and_moments(kind, a, b):
    with mpmath.workdps(40):
        exact_a, exact_b = mpmath.mpf(a), mpmath.mpf(b)
        terms, columns = shapes(kind, exact_a, exact_b)
        orders = ((2, 0), (0, 2), (1, 1))
        energy = sum(
            (1 + (p == 2)) * (1 + (q == 2)) * D[p, q] * moment_matrix(terms, orders[p], orders[q], exact_a, exact_b)
            for p in range(3)
            for q in range(3)
        )
        K = (columns.T @ energy @ columns).astype(float)
        M = (columns.T @ moment_matrix(terms, (0, 0), (0, 0), exact_a, exact_b) @ columns).astype(float)
        xi, eta = 0.3125, 0.8125
        at = (exact_a * mpmath.mpf(xi), exact_b * mpmath.mpf(eta))
        rows = {
            order: (np.array([monomial(term, order, *at) for term in terms], dtype=object) @ columns).astype(float)
            for order in ((0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (0, 2))
        }
    got = plate.stiffness(kind, [a], [b], D)[0]
    size = np.sqrt(np.outer(K.diagonal(), K.diagonal()))
    # 1e-14: a handful of roundings in double precision, relative to the diagonal where terms cancel
    assert np.abs((got - K) / size).max() <= 1e-14
    np.testing.assert_allclose(plate.mass(kind, [a], [b], 1.0)[0], M, rtol=1e-14, atol=0)
    expected = np.array([rows[0, 0], rows[0, 1], -rows[1, 0], rows[1, 1]])
    np.testing.assert_allclose(plate.interpolate(kind, [a], [b], [xi], [eta])[0], expected, rtol=ROUNDING, atol=1e-14)
    curvatures = np.array([rows[2, 0], rows[0, 2], 2 * rows[1, 1]])
    moments = plate.moments(kind, [a], [b], [xi], [eta], D)[0]
    np.testing.assert_allclose(moments, -D @ curvatures, rtol=ROUNDING, atol=ROUNDING * np.abs(moments).max())
