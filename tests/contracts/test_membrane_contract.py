"""What the membrane of quadrilaterals must hold: symmetry, rigid motion, exact mass, constant strain, invariance."""

import json
from pathlib import Path

import numpy as np
import pytest

from femstruct.elements import membrane
from femstruct.elements.flat_elements import square_points
from femstruct.elements.plate import CORNERS
from femstruct.errors import InputError

REFERENCE = json.loads((Path(__file__).parents[1] / "data" / "shells.json").read_text(encoding="utf-8"))
ROUNDING = 1e-13  # rounding: 2e-15 here at most

CELLS = {
    "square": [[0, 0], [1, 0], [1, 1], [0, 1]],
    "4 to 1": [[0, 0], [4, 0], [4, 1], [0, 1]],
    "distorted": [[0, 0], [1, 0.1], [1.3, 0.9], [-0.1, 0.8]],
    "clockwise": [[0.3, 0.1], [0.2, 0.9], [1.1, 1.2], [1.4, 0.0]],
}
ANISOTROPIC = np.array([[3.0, 0.7, 0.2], [0.7, 5.0, -0.4], [0.2, -0.4, 1.3]])


def isotropic(E, nu, t):
    return E * t / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])


STEEL = isotropic(2.1e11, 0.3, 0.002)
each_cell = pytest.mark.parametrize("xy", [np.array(xy, dtype=float) for xy in CELLS.values()], ids=list(CELLS))


def motion(xy, u, v, rz):
    """Nodal values of fields of x and y."""
    x, y = xy.T
    return np.stack([u(x, y) + 0 * x, v(x, y) + 0 * x, rz(x, y) + 0 * x], axis=1).ravel()


def rigid(xy):
    """Shifts along x and y, and a rotation about the origin."""
    shifts = [motion(xy, lambda x, y, k=k: k, lambda x, y, k=k: 1 - k, lambda x, y: 0) for k in (1, 0)]
    return np.array([*shifts, motion(xy, lambda x, y: -y, lambda x, y: x, lambda x, y: 1)])


def mapped(xy, points=None):
    """xi, eta, places and areas of points of the unit square by the bilinear map; 4 x 4 are exact for the mass."""
    xi, eta, weights = points or square_points(4)
    N = np.array([(xi if i else 1 - xi) * (eta if j else 1 - eta) for i, j in CORNERS]).T
    by_xi = np.array([(1 if i else -1) * (eta if j else 1 - eta) for i, j in CORNERS]).T @ xy
    by_eta = np.array([(xi if i else 1 - xi) * (1 if j else -1) for i, j in CORNERS]).T @ xy
    return xi, eta, N @ xy, weights * np.abs(np.linalg.det(np.stack([by_xi, by_eta], axis=1)))


@each_cell
class TestMembrane:
    def test_symmetry_is_exact(self, xy):
        for matrix in (membrane.stiffness(xy, ANISOTROPIC)[0], membrane.mass(xy, 3.0, 0.1)[0]):
            assert np.array_equal(matrix, matrix.T)

    def test_three_zero_energy_modes_and_no_more(self, xy):
        """Of a lone cell: a fourth is what 2 x 2 points alone leave."""
        K = membrane.stiffness(xy, STEEL)[0]
        scale = 1 / np.sqrt(K.diagonal())
        values = np.linalg.eigvalsh(K * np.outer(scale, scale))
        assert (np.abs(values) < 1e-13).sum() == 3  # rounding of a matrix with unit diagonal
        assert values[3] > 1e-5  # the share of 3 x 3 points: 8e-5 of the largest in the square
        np.testing.assert_allclose(K @ rigid(xy).T, 0, atol=ROUNDING * np.abs(K).max())

    def test_mass_and_rotary_sums_are_exact(self, xy):
        """Rigid motions, whose inertia is m0 times the moments of area, and m2 times the area for the rotation."""
        _, _, (x, y), areas = (part.T for part in mapped(xy))
        M = membrane.mass(xy, 3.0, 0.4)[0]
        area, sx, sy = areas.sum(), areas @ x, areas @ y
        exact = 3.0 * np.array([[area, 0, -sy], [0, area, sx], [-sy, sx, areas @ (x**2 + y**2)]])
        exact[2, 2] += 0.4 * area
        np.testing.assert_allclose(rigid(xy) @ M @ rigid(xy).T, exact, atol=ROUNDING * np.abs(exact).max())
        assert np.linalg.eigvalsh(M).min() > 0
        assert np.linalg.eigvalsh(membrane.mass(xy, 3.0, 0.0)[0])[1] > 0  # equal RZ move nothing

    def test_mass_equals_the_integral_of_its_own_rows(self, xy):
        xi, eta, _, areas = mapped(xy)
        rows = membrane.interpolate(np.broadcast_to(xy, (16, 4, 2)), xi, eta)
        density = np.array([3.0, 3.0, 0.4])
        M = np.einsum("g,gki,k,gkj->ij", areas, rows, density, rows)
        np.testing.assert_allclose(membrane.mass(xy, 3.0, 0.4)[0], M, atol=ROUNDING * np.abs(M).max())

    def test_rows_at_the_corners_are_the_dofs(self, xy):
        xi, eta = np.array(CORNERS, dtype=float).T
        rows = membrane.interpolate(np.broadcast_to(xy, (4, 4, 2)), xi, eta)
        np.testing.assert_allclose(rows.reshape(12, 12), np.eye(12), atol=ROUNDING)

    def test_energy_and_forces_of_constant_strain(self, xy):
        """Any linear motion with the rotation that belongs to it, in a fully anisotropic material."""
        gradient = np.array([[0.3, -0.2], [0.5, 0.7]])
        q = motion(
            xy,
            lambda x, y: gradient[0, 0] * x + gradient[0, 1] * y,
            lambda x, y: gradient[1, 0] * x + gradient[1, 1] * y,
            lambda x, y: (gradient[1, 0] - gradient[0, 1]) / 2,
        )
        strain = np.array([gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]])
        area = mapped(xy)[3].sum()
        K = membrane.stiffness(xy, ANISOTROPIC)[0]
        assert q @ K @ q == pytest.approx(area * strain @ ANISOTROPIC @ strain, rel=ROUNDING)
        forces = membrane.resultants(np.broadcast_to(xy, (3, 4, 2)), [0.2, 0.5, 1.0], [0.9, 0.5, 0.0], ANISOTROPIC) @ q
        np.testing.assert_allclose(forces, np.tile(ANISOTROPIC @ strain, (3, 1)), rtol=1e-12)  # rounding: 2e-15 here

    def test_the_forces_do_the_work_the_stiffness_stores(self, xy):
        """One constitutive matrix: without the tie of RZ, u K u is the integral of forces times strains."""
        xi, eta, _, areas = mapped(xy, membrane.integration_points())
        forces = membrane.resultants(np.broadcast_to(xy, (len(xi), 4, 2)), xi, eta, ANISOTROPIC)
        work = np.einsum("g,gki,gkj->ij", areas, np.linalg.solve(ANISOTROPIC, forces), forces)
        K = membrane.stiffness(xy, ANISOTROPIC, drilling=0.0)[0]
        np.testing.assert_allclose(work, K, atol=1e-12 * np.abs(K).max())  # rounding: 1e-15 here

    def test_numbering_of_the_corners_changes_nothing(self, xy):
        """Starting at any corner and going round either way."""
        for order in ([1, 2, 3, 0], [2, 3, 0, 1], [3, 2, 1, 0], [0, 3, 2, 1]):
            dofs = (np.array(order)[:, None] * 3 + np.arange(3)).ravel()
            for of in (lambda c: membrane.stiffness(c, ANISOTROPIC)[0], lambda c: membrane.mass(c, 3.0, 0.4)[0]):
                whole = of(xy)
                np.testing.assert_allclose(
                    of(xy[order]), whole[np.ix_(dofs, dofs)], atol=ROUNDING * np.abs(whole).max()
                )

    def test_turning_the_cell_turns_its_matrices(self, xy):
        angle = 0.7
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        dofs = np.kron(np.eye(4), np.block([[turn, np.zeros((2, 1))], [np.zeros((1, 2)), np.eye(1)]]))
        for of in (lambda c: membrane.stiffness(c, STEEL)[0], lambda c: membrane.mass(c, 3.0, 0.4)[0]):
            whole = dofs @ of(xy) @ dofs.T
            np.testing.assert_allclose(
                of(xy @ turn.T + [3.0, -2.0]), whole, atol=1e-12 * np.abs(whole).max()
            )  # rounding: 1e-15 here

    def test_scaling_laws(self, xy):
        """Twice A: twice K. All lengths by s: rotations count s times as much, and the mass s^2."""
        K, M = membrane.stiffness(xy, STEEL)[0], membrane.mass(xy, 3.0, 0.4)[0]
        s = 5.0
        scale = np.tile([1.0, 1.0, s], 4)
        np.testing.assert_allclose(membrane.stiffness(xy, 2 * STEEL)[0], 2 * K, rtol=1e-12)  # rounding: none here
        expected = np.outer(scale, scale) * K
        np.testing.assert_allclose(
            membrane.stiffness(s * xy, STEEL)[0], expected, atol=ROUNDING * np.abs(expected).max()
        )
        expected = s**2 * np.outer(scale, scale) * M
        other = membrane.mass(s * xy, 3.0, 0.4 * s**2)[0]
        np.testing.assert_allclose(other, expected, atol=ROUNDING * np.abs(expected).max())


def test_a_batch_is_its_cells_one_by_one():
    cells = np.array(list(CELLS.values()))
    A = np.array([STEEL, 2 * STEEL, ANISOTROPIC, STEEL])
    K, M = membrane.stiffness(cells, A), membrane.mass(cells, [1.0, 2.0, 3.0, 4.0], 0.1)
    for n, xy in enumerate(cells):
        one = membrane.stiffness(xy, A[n])[0]
        np.testing.assert_allclose(K[n], one, atol=ROUNDING * np.abs(one).max())
        np.testing.assert_allclose(M[n], membrane.mass(xy, n + 1.0, 0.1)[0], atol=ROUNDING)


def patch(A, u, v, rz):
    """Errors of the inner nodes of the patch of MacNeal and Harder under a motion given at its four outer corners."""
    nodes, cells = np.array(REFERENCE["patch"]["nodes"]), np.array(REFERENCE["patch"]["quads"])
    K = np.zeros((24, 24))
    dofs = (cells[:, :, None] * 3 + np.arange(3)).reshape(5, 12)
    np.add.at(K, (dofs[:, :, None], dofs[:, None, :]), membrane.stiffness(nodes[cells], A))
    exact = motion(nodes, u, v, rz)
    inner = -np.linalg.solve(K[12:, 12:], K[12:, :12] @ exact[:12])
    forces = membrane.resultants(nodes[cells], np.full(5, 0.3), np.full(5, 0.8), A)
    whole = np.concatenate([exact[:12], inner])
    return np.abs(inner - exact[12:]).max() / np.abs(exact).max(), np.einsum("nki,ni->nk", forces, whole[dofs])


@pytest.mark.parametrize("t", REFERENCE["patch"]["t"])
def test_patch_of_distorted_cells(t):
    """Constant strain, alone and with a rotation, from the corners of the patch inwards: to 1e-10."""
    A = isotropic(1e6, 0.25, t)
    error, forces = patch(A, lambda x, y: 1e-3 * (x + y / 2), lambda x, y: 1e-3 * (y + x / 2), lambda x, y: 0)
    assert error < REFERENCE["patch"]["tolerance"]
    np.testing.assert_allclose(forces, np.tile(A @ [1e-3, 1e-3, 1e-3], (5, 1)), rtol=1e-10)  # stated in the docstring
    error, forces = patch(
        A, lambda x, y: 1e-3 * (x + 0.2 * y), lambda x, y: 1e-3 * (0.7 * y + 0.9 * x), lambda x, y: 3.5e-4
    )
    assert error < REFERENCE["patch"]["tolerance"]
    np.testing.assert_allclose(forces, np.tile(A @ [1e-3, 0.7e-3, 1.1e-3], (5, 1)), rtol=1e-10)


@pytest.mark.parametrize(
    ("xy", "said"),
    [
        ([[0, 0], [1, 0], [0, 1], [1, 1]], "cell 0: .*convex"),
        ([[0, 0], [1, 0], [0.2, 0.2], [0, 1]], "cell 0: .*convex"),
        ([[0, 0], [1, 0], [1, 1]], r"corners of cells: got shape \(1, 3, 2\)"),
    ],
)
def test_cells_that_are_no_quadrilateral_are_refused(xy, said):
    with pytest.raises(InputError, match=said):
        membrane.stiffness(xy, STEEL)


def test_rigidities_that_are_none_are_refused():
    for A, said in (
        (np.eye(2), "A: got shape"),
        (np.triu(np.ones((3, 3))), "A: .*symmetric"),
        (np.eye(3) * np.nan, "nan"),
    ):
        with pytest.raises(InputError, match=said):
            membrane.stiffness(CELLS["square"], A)
    with pytest.raises(InputError, match="m0"):
        membrane.mass(CELLS["square"], -1.0, 0.0)
