"""What every element must hold: symmetry, rigid motion, exact mass, constant strain, invariance, scaling."""

import numpy as np
import pytest

from femstruct.elements import frame, members, plate
from femstruct.elements.polynomials import gauss_interval

ROUNDING = 1e-13  # rounding: 5e-16 here at most

CELLS = [(1.0, 1.0), (0.4, 0.1), (0.03, 0.11)]  # square, stretched along x, stretched along y
FRAME = {"E": 210e9, "G": 80e9, "A": 3e-4, "Iy": 2e-8, "Iz": 5e-8, "J": 4e-8, "ky": 0.8, "kz": 0.6}
ISOTROPIC = plate.rigidity(2.1e11, 0.3, 0.002)


def gauss_square():
    """Places xi, eta and weights of 4 x 4 points: exact to degree 7 each way, that of bicubics squared in the mass."""
    points, weights = gauss_interval(4)
    return np.repeat(points, 4), np.tile(points, 4), np.outer(weights, weights).ravel()


def corners(a, b):
    return np.array([0, 0, a, a]), np.array([0, b, b, 0])


def nodal(kind, w, w_x, w_y, w_xy):
    return np.stack([w, w_y, -w_x, w_xy], axis=1)[:, : plate.dofs_per_node(kind)].ravel()


def frame_stiffness(kind, length=0.7, **changes):
    s = FRAME | changes
    return frame.stiffness(kind, length, s["E"], s["G"], s["A"], s["Iy"], s["Iz"], s["J"], s["ky"], s["kz"])[0]


def frame_mass(kind, length=0.7, rho=7800.0, **changes):
    s = FRAME | changes
    return frame.mass(kind, length, rho, s["A"], s["Iy"], s["Iz"], s["ky"], s["kz"], s["E"], s["G"])[0]


def frame_rows(kind, xi, length=0.7):
    s = FRAME
    return frame.interpolate(kind, length, xi, s["E"], s["G"], s["A"], s["Iy"], s["Iz"], s["ky"], s["kz"])


def frame_places(kind):
    """Where the nodes of a bar are, from 0 to 1, in the order of their DOFs."""
    return np.array([0.0, 1.0, 0.5])[: frame.nodes_per_bar(kind)]


def frame_motion(kind, **fields):
    """Nodal values of fields u, v, w, rx, ry, rz along a bar, each a function of the place from 0 to 1."""
    s = frame_places(kind)
    values = np.zeros((len(s), 6))
    for name, field in fields.items():
        values[:, ("u", "v", "w", "rx", "ry", "rz").index(name)] = field(s)
    return values.ravel()


def frame_rigid(kind, length=0.7):
    """Six rigid motions of the local DOFs: three shifts, three rotations about end i."""

    def one(s):
        return np.ones_like(s)

    shifts = [frame_motion(kind, **{name: one}) for name in ("u", "v", "w", "rx")]
    turns = [
        frame_motion(kind, ry=one, w=lambda s: -length * s),
        frame_motion(kind, rz=one, v=lambda s: length * s),
    ]
    return np.array([*shifts, *turns])


@pytest.mark.parametrize("kind", plate.KINDS)
@pytest.mark.parametrize(("a", "b"), CELLS)
class TestPlate:
    def test_symmetry_is_exact(self, kind, a, b):
        for matrix in (plate.stiffness(kind, [a], [b], ISOTROPIC)[0], plate.mass(kind, [a], [b], 3.0)[0]):
            assert np.array_equal(matrix, matrix.T)

    def test_three_zero_energy_modes_and_no_more(self, kind, a, b):
        K = plate.stiffness(kind, [a], [b], ISOTROPIC)[0]
        scale = 1 / np.sqrt(K.diagonal())
        values = np.linalg.eigvalsh(K * np.outer(scale, scale))
        assert (np.abs(values) < 1e-13).sum() == 3  # rounding of a matrix with unit diagonal
        assert values[3] > 1e-4  # the softest deformation of a 4:1 cell is 1e-3

    def test_mass_and_rotary_sums_are_exact(self, kind, a, b):
        M = plate.mass(kind, [a], [b], 3.0)[0]
        x, y = corners(a, b)
        none = np.zeros(4)
        one = none + 1
        motions = np.array([nodal(kind, one, none, none, none), nodal(kind, x, one, none, none)])
        motions = np.vstack([motions, nodal(kind, y, none, one, none)])
        exact = 3 * a * b * np.array([[1, a / 2, b / 2], [a / 2, a**2 / 3, a * b / 4], [b / 2, a * b / 4, b**2 / 3]])
        np.testing.assert_allclose(motions @ M @ motions.T, exact, rtol=1e-13)  # rounding
        assert np.linalg.eigvalsh(M).min() > 0

    def test_energy_of_constant_curvature_in_any_direction(self, kind, a, b):
        """Curvatures along axes turned by an angle; for hermite12 the twist part carries its known excess."""
        for angle in (0.0, 0.4, np.pi / 4):
            turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            xx, xy, yy = (turn @ np.diag([0.7, -0.4]) @ turn.T)[[0, 0, 1], [0, 1, 1]]
            x, y = corners(a, b)
            w = (xx * x**2 + 2 * xy * x * y + yy * y**2) / 2
            u = nodal(kind, w, xx * x + xy * y, xy * x + yy * y, np.full(4, xy))
            curvature = np.array([xx, yy, 2 * xy])
            D = ISOTROPIC.copy()
            if kind == "hermite12":
                D[2, 2] *= 1 + plate.twist_excess(b / a, 0.3)
            energy = u @ plate.stiffness(kind, [a], [b], ISOTROPIC)[0] @ u
            assert energy == pytest.approx(a * b * curvature @ D @ curvature, rel=1e-12)  # rounding: 5e-14 here
            if kind != "hermite12":
                got = plate.moments(kind, [a], [b], [0.3], [0.9], ISOTROPIC)[0] @ u
                # rounding: 4e-15 here
                np.testing.assert_allclose(got, -ISOTROPIC @ curvature, rtol=0, atol=1e-12 * np.abs(got).max())

    def test_pure_twist(self, kind, a, b):
        x, y = corners(a, b)
        u = nodal(kind, x * y, y, x, np.ones(4))
        ratio = u @ plate.stiffness(kind, [a], [b], ISOTROPIC)[0] @ u / (4 * a * b * ISOTROPIC[2, 2])
        excess = float(plate.twist_excess(b / a, 0.3)) if kind == "hermite12" else 0.0
        assert ratio == pytest.approx(1 + excess, rel=1e-12)  # rounding: 9e-15 here

    def test_the_moments_do_the_work_the_stiffness_stores(self, kind, a, b):
        """One constitutive matrix: u K u equals the integral of moments times curvatures."""
        xi, eta, weights = gauss_square()
        full, a_, b_ = np.full(16, 1.0), np.full(16, a), np.full(16, b)
        D = np.array([[3.0, 0.7, 0.2], [0.7, 5.0, -0.4], [0.2, -0.4, 1.3]])
        moments = plate.moments(kind, a_, b_, xi, eta, D)
        curvatures = -np.linalg.solve(D, moments)
        work = -np.einsum("g,gki,gkj->ij", weights * full * a * b, curvatures, moments)
        K = plate.stiffness(kind, [a], [b], D)[0]
        assert np.abs(work - K).max() <= 1e-12 * np.abs(K).max()  # rounding: 1e-15 here

    def test_mass_equals_the_integral_of_its_own_rows(self, kind, a, b):
        xi, eta, weights = gauss_square()
        w = plate.interpolate(kind, np.full(16, a), np.full(16, b), xi, eta)[:, 0]
        M = plate.mass(kind, [a], [b], 3.0)[0]
        # rounding: 5e-16 here
        assert np.abs(w.T @ (3.0 * a * b * weights[:, None] * w) - M).max() <= 1e-14 * np.abs(M).max()

    def test_rows_at_the_corners_are_the_dofs(self, kind, a, b):
        xi, eta = np.array(plate.CORNERS, dtype=float).T
        per_node = plate.dofs_per_node(kind)
        rows = plate.interpolate(kind, np.full(4, a), np.full(4, b), xi, eta)[:, :per_node]
        np.testing.assert_allclose(rows.reshape(4 * per_node, -1), np.eye(4 * per_node), atol=ROUNDING / min(a, b))

    def test_turning_and_mirroring_the_cell_changes_nothing(self, kind, a, b):
        per_node = plate.dofs_per_node(kind)
        mirrored = ([3, 2, 1, 0], np.array([1, 1, -1, -1.0]))  # x -> a - x
        half_turn = ([2, 3, 0, 1], np.array([1, -1, -1, 1.0]))
        for D in (ISOTROPIC, np.diag([3.0, 5.0, 2.0])):
            K, M = plate.stiffness(kind, [a], [b], D)[0], plate.mass(kind, [a], [b], 1.0)[0]
            for nodes, signs in (mirrored, half_turn):
                dofs = (np.array(nodes)[:, None] * per_node + np.arange(per_node)).ravel()
                sign = np.tile(signs[:per_node], 4)
                for matrix in (K, M):
                    turned = np.outer(sign, sign) * matrix[np.ix_(dofs, dofs)]
                    # rounding: none here
                    np.testing.assert_allclose(turned, matrix, rtol=0, atol=1e-14 * np.abs(matrix).max())

    def test_exchanging_x_and_y(self, kind, a, b):
        """A quarter turn: x' = y, y' = a - x, so RX' = RY, RY' = -RX and the twist changes sign."""
        D = np.diag([3.0, 5.0, 2.0])
        per_node = plate.dofs_per_node(kind)
        turn = np.zeros((4 * per_node, 4 * per_node))
        components = [(0, 0, 1.0), (1, 2, 1.0), (2, 1, -1.0), (3, 3, -1.0)][:per_node]
        for new, old in enumerate([3, 0, 1, 2]):
            for row, column, sign in components:
                turn[new * per_node + row, old * per_node + column] = sign
        other = plate.stiffness(kind, [b], [a], D[[1, 0, 2]][:, [1, 0, 2]])[0]
        K = plate.stiffness(kind, [a], [b], D)[0]
        # rounding: 2e-16 here
        np.testing.assert_allclose(turn.T @ other @ turn, K, rtol=0, atol=1e-14 * np.abs(K).max())

    def test_scaling_laws(self, kind, a, b):
        K = plate.stiffness(kind, [a], [b], plate.rigidity(7.0, 0.25, 0.1))[0]
        for E, t, size in ((14.0, 0.1, 1.0), (7.0, 0.3, 1.0), (7.0, 0.1, 5.0)):
            changed = plate.stiffness(kind, [a * size], [b * size], plate.rigidity(E, 0.25, t))[0]
            length = np.tile(np.array([1, 1 / size, 1 / size, 1 / size**2])[: plate.dofs_per_node(kind)], 4)
            expected = np.outer(1 / length, 1 / length) * K * (E / 7) * (t / 0.1) ** 3 / size**2
            # rounding: 4e-16 here
            np.testing.assert_allclose(changed, expected, rtol=0, atol=1e-14 * np.abs(expected).max())


@pytest.mark.parametrize("kind", plate.KINDS)
def test_a_batch_is_its_cells_one_by_one(kind):
    a, b = np.array(CELLS).T
    D = np.array([ISOTROPIC, 2 * ISOTROPIC, np.diag([1.0, 2.0, 3.0])])
    K, M = plate.stiffness(kind, a, b, D), plate.mass(kind, a, b, [1.0, 2.0, 3.0])
    for n in range(3):
        # rounding: 3e-14 here
        assert K[n] == pytest.approx(plate.stiffness(kind, a[n], b[n], D[n])[0], rel=1e-14, abs=1e-12)
        # rounding: none here
        assert M[n] == pytest.approx(plate.mass(kind, a[n], b[n], n + 1.0)[0], rel=1e-14, abs=1e-18)


@pytest.mark.parametrize("kind", plate.KINDS)
def test_numbering_of_the_nodes_changes_no_frequency(kind, plate_grid):
    one = plate_grid(kind, 5, 4, 1.0, 0.7).lambdas("FFFF", 6)
    other = plate_grid(kind, 5, 4, 1.0, 0.7, numbering=3).lambdas("FFFF", 6)
    np.testing.assert_allclose(one, other, rtol=1e-10)  # rounding of two different factors


@pytest.mark.parametrize("kind", frame.KINDS)
class TestFrame:
    def test_symmetry_is_exact(self, kind):
        R = members.directions([[0, 0, 0]], [[0.3, 0.2, 0.6]])
        for matrix in (frame_stiffness(kind), frame_mass(kind)):
            assert np.array_equal(matrix, matrix.T)
            arms = [[[0.1, 0, 0.2]], [[0, 0.3, 0]], [[0.05, 0.15, 0.1]]][: frame.nodes_per_bar(kind)]
            turned = members.with_offsets(members.to_global(matrix[None], R), *arms)[0]
            assert np.array_equal(turned, turned.T)

    def test_six_zero_energy_modes_and_no_more(self, kind):
        K = frame_stiffness(kind)
        scale = 1 / np.sqrt(K.diagonal())
        values = np.linalg.eigvalsh(K * np.outer(scale, scale))
        assert (np.abs(values) < 1e-13).sum() == 6  # rounding; the seventh is asked for below
        assert values[6] > (1e-2 if len(K) == 12 else 1e-4)  # with a node more, bending is softer beside shear
        assert np.abs(K @ frame_rigid(kind).T).max() <= ROUNDING * np.abs(K).max()

    def test_mass_and_rotary_sums_are_exact(self, kind):
        length, rho = 0.7, 7800.0
        sums = frame_rigid(kind) @ frame_mass(kind) @ frame_rigid(kind).T
        mass = rho * FRAME["A"] * length
        np.testing.assert_allclose(sums.diagonal()[:3], mass, rtol=1e-14)  # rounding: 1e-16 here
        assert sums[1, 5] == pytest.approx(mass * length / 2, rel=ROUNDING)
        assert sums[3, 3] == pytest.approx(rho * (FRAME["Iy"] + FRAME["Iz"]) * length, rel=1e-14)  # rounding: none here
        rotary = kind != "euler"
        for k, inertia in ((4, "Iy"), (5, "Iz")):
            exact = mass * length**2 / 3 + rotary * rho * FRAME[inertia] * length
            assert sums[k, k] == pytest.approx(exact, rel=ROUNDING)
        assert np.linalg.eigvalsh(frame_mass(kind)).min() > 0

    def test_energy_of_constant_strain(self, kind):
        """Stretch, torsion and pure bending about both axes; pure bending has no shear, so all kinds agree."""
        length, K = 0.7, frame_stiffness(kind)
        for component, rigidity in (("u", FRAME["E"] * FRAME["A"]), ("rx", FRAME["G"] * FRAME["J"])):
            u = frame_motion(kind, **{component: lambda s: length * s})
            assert u @ K @ u == pytest.approx(rigidity * length, rel=ROUNDING)
        for move, turn, sign, inertia in (("v", "rz", 1, "Iz"), ("w", "ry", -1, "Iy")):
            u = frame_motion(
                kind, **{move: lambda s: (length * s) ** 2 / 2, turn: lambda s, way=sign: way * length * s}
            )
            assert u @ K @ u == pytest.approx(FRAME["E"] * FRAME[inertia] * length, rel=1e-12)  # rounding: 2e-13 here

    def test_exchanging_the_ends(self, kind):
        """A half turn about local z: x and y change sign, for shifts and rotations alike."""
        nodes = frame.nodes_per_bar(kind)
        ends = np.r_[6:12, 0:6, 12 : 6 * nodes]
        sign = np.tile([-1.0, -1.0, 1.0], 2 * nodes)
        for matrix in (frame_stiffness(kind), frame_mass(kind)):
            turned = np.outer(sign, sign) * matrix[np.ix_(ends, ends)]
            np.testing.assert_allclose(turned, matrix, rtol=0, atol=1e-14 * np.abs(matrix).max())  # rounding: none here

    def test_exchanging_y_and_z(self, kind):
        """A quarter turn about local x: y' = z, z' = -y."""
        quarter = np.array([[[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]]])
        swapped = {"Iy": FRAME["Iz"], "Iz": FRAME["Iy"], "ky": FRAME["kz"], "kz": FRAME["ky"]}
        for of in (frame_stiffness, frame_mass):
            turned = members.to_global(of(kind, **swapped)[None], quarter)[0]
            # rounding: none here
            np.testing.assert_allclose(turned, of(kind), rtol=0, atol=1e-14 * np.abs(turned).max())

    def test_scaling_laws(self, kind):
        """Twice the modulus: twice K; all lengths by s: K of unit displacement by s; mass by s^3."""
        s = 3.0
        scaled = {"A": FRAME["A"] * s**2, **{name: FRAME[name] * s**4 for name in ("Iy", "Iz", "J")}}
        scale = np.tile(np.repeat([1.0, s], 3), frame.nodes_per_bar(kind))
        doubled = frame_stiffness(kind, E=2 * FRAME["E"], G=2 * FRAME["G"])
        np.testing.assert_allclose(doubled, 2 * frame_stiffness(kind), rtol=1e-14)  # rounding: none here
        expected = s * np.outer(scale, scale) * frame_stiffness(kind)
        np.testing.assert_allclose(frame_stiffness(kind, 0.7 * s, **scaled), expected, rtol=ROUNDING)
        expected = s**3 * np.outer(scale, scale) * frame_mass(kind)
        np.testing.assert_allclose(frame_mass(kind, 0.7 * s, **scaled), expected, rtol=ROUNDING)

    def test_mass_equals_the_integral_of_its_own_rows(self, kind):
        xi, weights = gauss_interval(4)
        rows = frame_rows(kind, xi)
        polar = FRAME["Iy"] + FRAME["Iz"]
        bending = [0.0, 0.0] if kind == "euler" else [FRAME["Iy"], FRAME["Iz"]]
        inertia = 7800 * np.array([FRAME["A"], FRAME["A"], FRAME["A"], polar, *bending])
        M = np.einsum("gci,c,gcj->ij", 0.7 * weights[:, None, None] * rows, inertia, rows)
        # rounding: 2e-15 here
        np.testing.assert_allclose(M, frame_mass(kind), rtol=1e-12, atol=1e-14 * np.abs(M).max())

    def test_rows_at_the_nodes_are_the_dofs(self, kind):
        count = 6 * frame.nodes_per_bar(kind)
        rows = frame_rows(kind, frame_places(kind)).reshape(count, count)
        np.testing.assert_allclose(rows, np.eye(count), atol=1e-15)  # rounding: none here


@pytest.mark.parametrize("kind", ["euler", "timoshenko"])
def test_rows_equal_the_static_shape_of_a_refined_member(kind):
    """The shape functions are exact for loads at the ends: a node in between, unloaded, lies on them."""
    first, second = frame_stiffness(kind, 0.7 * 0.3), frame_stiffness(kind, 0.7 * 0.7)
    K = np.zeros((18, 18))
    K[:12, :12] += first
    K[6:, 6:] += second
    ends, middle = np.r_[0:6, 12:18], np.r_[6:12]
    inner = -np.linalg.solve(K[np.ix_(middle, middle)], K[np.ix_(middle, ends)])
    np.testing.assert_allclose(frame_rows(kind, [0.3])[0], inner, atol=ROUNDING)
    condensed = K[np.ix_(ends, ends)] + K[np.ix_(ends, middle)] @ inner
    np.testing.assert_allclose(condensed, frame_stiffness(kind), atol=ROUNDING * np.abs(K).max())


def test_a_bar_of_three_nodes_without_load_on_the_middle_one_is_that_of_two():
    """The bar of two nodes is exact for loads at its ends, and was derived in another way."""
    K, exact = frame_stiffness("timoshenko18"), frame_stiffness("timoshenko")
    inner = -np.linalg.solve(K[12:, 12:], K[12:, :12])
    np.testing.assert_allclose(K[:12, :12] + K[:12, 12:] @ inner, exact, atol=ROUNDING * np.abs(K).max())
    for place in (0.1, 0.3, 0.5, 0.8):
        rows = frame_rows("timoshenko18", [place])[0]
        np.testing.assert_allclose(
            rows[:, :12] + rows[:, 12:] @ inner, frame_rows("timoshenko", [place])[0], atol=ROUNDING
        )


def test_rows_of_a_bar_of_three_nodes_from_their_definition():
    """Parabola of rotation, straight line of shear strain, and the three deflections they must pass: six unknowns."""
    length, s = 0.7, np.array([0.0, 0.2, 0.45, 0.5, 0.9, 1.0])
    # unknowns: w(0), shear strain a + b s, rotation c + d s + e s^2; w = w(0) + L (integral of both)
    deflection = np.stack(
        [np.ones_like(s), *(length * s**n / n for n in (1, 2)), *(length * s**n / n for n in (1, 2, 3))]
    )
    rotation = np.stack([0 * s, 0 * s, 0 * s, np.ones_like(s), s, s**2])
    nodes = [0, 5, 3]  # the places of both ends and of the middle
    values = np.concatenate([[deflection[:, n], rotation[:, n]] for n in nodes])
    unknowns = np.linalg.inv(values)  # from w0 theta0 w1 theta1 wm thetam
    rows = frame_rows("timoshenko18", s, length)
    np.testing.assert_allclose(rows[:, 1][:, [1, 5, 7, 11, 13, 17]], deflection.T @ unknowns, atol=ROUNDING)
    np.testing.assert_allclose(rows[:, 5][:, [1, 5, 7, 11, 13, 17]], rotation.T @ unknowns, atol=ROUNDING)
    sign = np.array([1, -1] * 3)  # RY = -dw/dx
    np.testing.assert_allclose(rows[:, 2][:, [2, 4, 8, 10, 14, 16]], deflection.T @ unknowns * sign, atol=ROUNDING)
