"""Springs, point masses, foundations and what the small element functions refuse."""

import numpy as np
import pytest

from femstruct.elements import frame, lumped, plate
from femstruct.elements.foundation import winkler
from femstruct.elements.quadrature import gauss_interval, gauss_square
from femstruct.errors import InputError

VALUES = np.array([[2.0, 3.0, 5.0, 7.0, 11.0, 13.0]])


def test_spring_force_grows_with_the_difference_of_its_ends():
    K = lumped.spring(VALUES)[0]
    together = np.tile(np.arange(1.0, 7.0), 2)
    assert not (K @ together).any()
    apart = np.r_[np.zeros(6), np.ones(6)]
    np.testing.assert_array_equal(K @ apart, np.r_[-VALUES[0], VALUES[0]])


def test_turned_spring_pushes_along_its_own_axis():
    R = frame.directions([[0, 0, 0]], [[1, 2, 2]])
    K = lumped.spring([[9.0, 0, 0, 0, 0, 4.0]], R)[0]
    axis, third = R[0, 0], R[0, 2]
    np.testing.assert_allclose(K[:3, :3], 9 * np.outer(axis, axis), atol=1e-14)
    np.testing.assert_allclose(K[3:6, 3:6], 4 * np.outer(third, third), atol=1e-14)
    np.testing.assert_allclose(K[:6, 6:], -K[:6, :6])


def test_point_mass_has_its_kinetic_energy():
    inertia = np.array([[[2.0, -0.1, 0], [-0.1, 3.0, 0.2], [0, 0.2, 4.0]]])
    M = lumped.point_mass([5.0], inertia)[0]
    velocity, spin = np.array([1.0, 2.0, 3.0]), np.array([0.5, -1.0, 2.0])
    v = np.r_[velocity, spin]
    assert v @ M @ v == pytest.approx(5 * velocity @ velocity + spin @ inertia[0] @ spin, rel=1e-14)


def test_foundation_under_a_whole_cell_carries_the_rigid_plate():
    """Uniform stiffness k under a rigid plate: k a b down, k a b^3 / 12 about the middle line."""
    a, b, k = 0.3, 0.2, 7e6
    xi, eta, weights = gauss_square(4)
    w = plate.interpolate("acm12", np.full(16, a), np.full(16, b), xi, eta)[:, :1]
    rows = w * np.array([0.0, 0.0, 1.0])[:, None]
    K = winkler(rows, weights * a * b, np.diag([0.0, 0.0, k]))
    heave = np.tile([1.0, 0, 0], 4)
    y = np.array([0, b, b, 0]) - b / 2
    roll = np.stack([y, np.ones(4), np.zeros(4)], axis=1).ravel()
    assert heave @ K @ heave == pytest.approx(k * a * b, rel=1e-13)
    assert roll @ K @ roll == pytest.approx(k * a * b**3 / 12, rel=1e-12)
    assert abs(heave @ K @ roll) <= 1e-13 * k * a * b**2


def test_foundation_takes_batches_and_a_stiffness_per_point():
    rng = np.random.default_rng(2)
    rows, weights, stiffness = rng.random((3, 5, 3, 8)), rng.random((3, 5)), rng.random((3, 5, 3, 3))
    expected = sum(weights[1, g] * rows[1, g].T @ stiffness[1, g] @ rows[1, g] for g in range(5))
    np.testing.assert_allclose(winkler(rows, weights, stiffness)[1], expected, rtol=1e-13)


@pytest.mark.parametrize("n", [1, 2, 4])
def test_gauss_points_are_exact_to_degree_2n_minus_1_and_not_beyond(n):
    points, weights = gauss_interval(n)
    assert weights @ points ** (2 * n - 1) == pytest.approx(1 / (2 * n), rel=1e-14)
    assert abs(weights @ points ** (2 * n) - 1 / (2 * n + 1)) > 1e-6


def test_what_is_refused():
    with pytest.raises(InputError, match="expected hermite12 or acm12 or bfs16"):
        plate.stiffness("q4", [1.0], [1.0], np.eye(3))
    with pytest.raises(InputError, match=r"b: got -1\.0"):
        plate.mass("acm12", [1.0], [-1.0], 1.0)
    with pytest.raises(InputError, match="asymmetric"):
        plate.stiffness("acm12", [1.0], [1.0], [[1, 0.3, 0], [0.2, 1, 0], [0, 0, 1]])
    with pytest.raises(InputError, match="shape"):
        plate.stiffness("acm12", [1.0], [1.0], np.eye(2))
    with pytest.raises(InputError, match=r"nu: got 1\.2"):
        plate.rigidity(1.0, 1.2, 1.0)
    with pytest.raises(InputError, match="thickness: got nan"):
        plate.rigidity(1.0, 0.2, float("nan"))
    with pytest.raises(InputError, match="zero or above"):
        lumped.spring(-VALUES)
    with pytest.raises(InputError, match="shape"):
        lumped.spring(VALUES[0])
    with pytest.raises(InputError, match=r"mass: got -1\.0"):
        lumped.point_mass([-1.0], np.zeros((1, 3, 3)))
    with pytest.raises(InputError, match="asymmetric tensor"):
        lumped.point_mass([1.0], [[[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]])
