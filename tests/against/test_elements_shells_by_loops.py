"""Shell elements against slow derivations written another way: fields, differences and loops in place of tables.

The square is the usual one from -1 to 1 with corners counterclockwise; strains come from differences of the fields,
exact since no field is more than quadratic in either coordinate; arms and axes are applied field by field. The
triangle has the printed tables of Felippa (2003) and the side equations of Katili (1993), solved side by side.
"""

import numpy as np

from femstruct.elements import quad_shell, triangle_shell
from femstruct.elements import triangle_shell as andes

A = np.array([[3.0, 0.7, 0.2], [0.7, 5.0, -0.4], [0.2, -0.4, 1.3]])
B = np.array([[0.3, 0.1, 0.05], [0.0, -0.2, 0.1], [0.1, 0.02, 0.2]])
D = np.array([[0.9, 0.2, 0.1], [0.2, 0.7, -0.1], [0.1, -0.1, 0.4]])
AS = np.array([[0.8, 0.1], [0.1, 0.6]])
QUAD = np.array([[0.2, 0.1, 0.35], [1.4, 0.0, 0.1], [1.1, 1.2, 0.3], [0.3, 0.8, 0.0]])
TRIANGLE = np.array([[0.1, 0.0, 0.4], [1.2, 0.3, 0.1], [0.4, 1.0, 0.6]])
M0, M1, M2 = 3.0, 0.2, 0.4
ROUNDING = 1e-11  # rounding: differences of steps of 1/8


def gauss(n):
    points, weights = np.polynomial.legendre.leggauss(n)
    return [(x, y, a * b) for x, a in zip(points, weights, strict=True) for y, b in zip(points, weights, strict=True)]


def slope(field, x, y):
    """Derivatives of a field of two coordinates, exact for quadratic ones."""
    h = 0.125
    return (field(x + h, y) - field(x - h, y)) / (2 * h), (field(x, y + h) - field(x, y - h)) / (2 * h)


def axes_of_quad(p):
    """The two lines that halve the angles between the middles' lines, turned by an eighth of a circle."""
    normal = np.cross(p[2] - p[0], p[3] - p[1])
    normal /= np.linalg.norm(normal)
    r, s = p[1] + p[2] - p[0] - p[3], p[2] + p[3] - p[0] - p[1]
    r, s = r / np.linalg.norm(r), s / np.linalg.norm(s)
    half = (r + s) / np.linalg.norm(r + s)
    x = np.cross(half, normal) + half
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(normal, x), normal])


class QuadFields:
    """u v w, leans b and RZ of one element in its own axes for unit DOFs [24 + 2], as functions of the square."""

    def __init__(self, corners):
        self.R = axes_of_quad(corners)
        own = (corners - corners.mean(axis=0)) @ self.R.T
        self.x, self.y, self.z = own.T
        motion = np.zeros((4, 6, 26))
        for node in range(4):
            shift, turn = np.zeros((3, 26)), np.zeros((3, 26))
            shift[:, 6 * node : 6 * node + 3] = self.R
            turn[:, 6 * node + 3 : 6 * node + 6] = self.R
            arm = np.array([0.0, 0.0, -self.z[node]])  # from the node down to the mean plane
            motion[node, :3] = shift + np.cross(turn, arm, axisa=0, axisb=0, axisc=0)
            motion[node, 3:] = turn
        self.motion = motion

    def N(self, k, a, b):
        sign = [(-1, -1), (1, -1), (1, 1), (-1, 1)][k]
        return (1 + sign[0] * a) * (1 + sign[1] * b) / 4

    def side(self, k, a, b):
        """Parabola of the side from corner k to the next."""
        return [(1 - a * a) * (1 - b), (1 + a) * (1 - b * b), (1 - a * a) * (1 + b), (1 - a) * (1 - b * b)][k] / 2

    def bilinear(self, component):
        return lambda a, b: sum(self.N(k, a, b) * self.motion[k, component] for k in range(4))

    def place(self, a, b):
        return np.array([sum(self.N(k, a, b) * of[k] for k in range(4)) for of in (self.x, self.y)])

    def in_plane(self, component):
        def field(a, b):
            total = self.bilinear(component)(a, b)
            for i in range(4):
                j = (i + 1) % 4
                outward = [-(self.y[j] - self.y[i]), self.x[j] - self.x[i]][component]
                total = total + self.side(i, a, b) * outward * (self.motion[i, 5] - self.motion[j, 5]) / 8
            return total

        return field

    def deflection(self, a, b):
        """Bilinear, and on each side the parabola of a beam whose ends lean: w' = -lean on both."""
        total = self.bilinear(2)(a, b)
        for i in range(4):
            j = (i + 1) % 4
            along = np.array([self.x[j] - self.x[i], self.y[j] - self.y[i]])
            leans = [along @ np.array([self.motion[k, 4], -self.motion[k, 3]]) for k in (i, j)]
            total = total + self.side(i, a, b) * (leans[1] - leans[0]) / 8
        return total

    def with_bubble(self, component):
        def field(a, b):
            total = self.in_plane(component)(a, b)
            total[24 + component] += (1 - a * a) * (1 - b * b)
            return total

        return field

    def jacobian(self, a, b):
        return np.array(slope(self.place, a, b))

    def gradient(self, field, a, b):
        return np.linalg.solve(self.jacobian(a, b), np.array(slope(field, a, b)))

    def strains(self, a, b):
        u, v = self.gradient(self.with_bubble(0), a, b), self.gradient(self.with_bubble(1), a, b)
        lean_x = self.gradient(self.bilinear(4), a, b)
        lean_y = -self.gradient(self.bilinear(3), a, b)
        return np.array([u[0], v[1], u[1] + v[0], lean_x[0], lean_y[1], lean_x[1] + lean_y[0]])

    def along(self, a, b):
        """Shear strains along both coordinates at a place, from the fields themselves."""
        lean = np.array([self.bilinear(4)(a, b), -self.bilinear(3)(a, b)])
        return np.array(slope(self.bilinear(2), a, b)) + self.jacobian(a, b) @ lean

    def shears(self, a, b):
        first = (1 - b) / 2 * self.along(0, -1)[0] + (1 + b) / 2 * self.along(0, 1)[0]
        second = (1 - a) / 2 * self.along(-1, 0)[1] + (1 + a) / 2 * self.along(1, 0)[1]
        return np.linalg.solve(self.jacobian(a, b), np.array([first, second]))

    def matrices(self):
        law = np.block([[A, B], [B.T, D]])
        K, M = np.zeros((2, 26, 26))
        for share, points in ((0.99, gauss(2)), (0.01, gauss(3))):
            for a, b, weight in points:
                rows = self.strains(a, b)
                K += share * weight * np.linalg.det(self.jacobian(a, b)) * rows.T @ law @ rows
        for a, b, weight in gauss(2):
            rows = self.shears(a, b)
            K += weight * np.linalg.det(self.jacobian(a, b)) * rows.T @ AS @ rows
        u, v = self.gradient(self.in_plane(0), 0, 0), self.gradient(self.in_plane(1), 0, 0)
        tie = self.bilinear(5)(0, 0) - (v[0] - u[1]) / 2
        K += A[2, 2] * 4 * np.linalg.det(self.jacobian(0, 0)) * np.outer(tie, tie)
        for a, b, weight in gauss(4):
            moving = [self.in_plane(0)(a, b), self.in_plane(1)(a, b), self.deflection(a, b)]
            turning = [self.bilinear(component)(a, b) for component in (3, 4, 5)]
            density = sum(M0 * np.outer(of, of) for of in moving) + sum(M2 * np.outer(of, of) for of in turning)
            first = np.outer(moving[0], turning[1]) - np.outer(moving[1], turning[0])
            M += weight * np.linalg.det(self.jacobian(a, b)) * (density + M1 * (first + first.T))
        bubble = np.linalg.solve(K[24:, 24:], K[24:, :24])
        return K[:24, :24] - K[:24, 24:] @ bubble, M[:24, :24]


def test_quadrilateral():
    """Warped and distorted, of a coupled anisotropic laminate."""
    K, M = QuadFields(QUAD).matrices()
    np.testing.assert_allclose(quad_shell.stiffness(QUAD[None], A, B, D, AS)[0], K, atol=ROUNDING * np.abs(K).max())
    np.testing.assert_allclose(quad_shell.mass(QUAD[None], M0, M1, M2)[0], M, atol=ROUNDING * np.abs(M).max())


def test_motion_inside_a_quadrilateral():
    """In the mean plane: u and v bow with the drilling rotation, w with the leans."""
    fields = QuadFields(QUAD)
    for a, b in ((0.3, -0.6), (-1.0, 0.2)):
        expected = [fields.in_plane(0)(a, b), fields.in_plane(1)(a, b), fields.deflection(a, b)]
        height = sum(fields.N(k, a, b) * fields.z[k] for k in range(4))
        expected[0] = expected[0] + height * fields.bilinear(4)(a, b)  # out on the arm to the surface through the nodes
        expected[1] = expected[1] - height * fields.bilinear(3)(a, b)
        rows = quad_shell.interpolate(QUAD[None], [(1 + b) / 2], [(1 + a) / 2])[0, :3]
        np.testing.assert_allclose(fields.R @ rows, np.array(expected)[:, :24], atol=ROUNDING)


def felippa(x, y, factor):
    """Strains of OPT at the three corners from u v RZ corner by corner: tables as printed, numbers from 1."""
    x, y = dict(enumerate(x, 1)), dict(enumerate(y, 1))
    X = {(i, j): x[i] - x[j] for i in x for j in x}
    Y = {(i, j): y[i] - y[j] for i in x for j in x}
    area = (X[2, 1] * Y[3, 1] - X[3, 1] * Y[2, 1]) / 2
    alpha = 1.5
    L = []
    for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2)):
        L += [
            [Y[j, k], 0, X[k, j]],
            [0, X[k, j], Y[j, k]],
            [
                alpha / 6 * Y[j, k] * (Y[i, k] - Y[j, i]),
                alpha / 6 * X[k, j] * (X[k, i] - X[i, j]),
                alpha / 3 * (X[k, i] * Y[i, k] - X[i, j] * Y[j, i]),
            ],
        ]
    mean = np.array(L).T / (2 * area)
    l21, l32, l13 = (X[p] ** 2 + Y[p] ** 2 for p in ((2, 1), (3, 2), (1, 3)))
    T = np.array(
        [
            [X[3, 2], Y[3, 2], 4 * area, X[1, 3], Y[1, 3], 0, X[2, 1], Y[2, 1], 0],
            [X[3, 2], Y[3, 2], 0, X[1, 3], Y[1, 3], 4 * area, X[2, 1], Y[2, 1], 0],
            [X[3, 2], Y[3, 2], 0, X[1, 3], Y[1, 3], 0, X[2, 1], Y[2, 1], 4 * area],
        ]
    ) / (4 * area)
    Te = np.array(
        [
            [Y[2, 3] * Y[1, 3] * l21, Y[3, 1] * Y[2, 1] * l32, Y[1, 2] * Y[3, 2] * l13],
            [X[2, 3] * X[1, 3] * l21, X[3, 1] * X[2, 1] * l32, X[1, 2] * X[3, 2] * l13],
            [
                (Y[2, 3] * X[3, 1] + X[3, 2] * Y[1, 3]) * l21,
                (Y[3, 1] * X[1, 2] + X[1, 3] * Y[2, 1]) * l32,
                (Y[1, 2] * X[2, 3] + X[2, 1] * Y[3, 2]) * l13,
            ],
        ]
    ) / (4 * area**2)
    b1, b2, b3, b4, b5, b6, b7, b8, b9 = 1, 2, 1, 0, 1, -1, -1, -1, -2
    Q1 = [[b1 / l21, b2 / l21, b3 / l21], [b4 / l32, b5 / l32, b6 / l32], [b7 / l13, b8 / l13, b9 / l13]]
    Q2 = [[b9 / l21, b7 / l21, b8 / l21], [b3 / l32, b1 / l32, b2 / l32], [b6 / l13, b4 / l13, b5 / l13]]
    Q3 = [[b5 / l21, b6 / l21, b4 / l21], [b8 / l32, b9 / l32, b7 / l32], [b2 / l13, b3 / l13, b1 / l13]]
    corners = [2 * area / 3 * np.array(Q) for Q in (Q1, Q2, Q3)]
    K = (
        3
        / 4
        * factor
        * area
        * sum(
            (Te @ (corners[i] + corners[j]) / 2 @ T).T @ A @ (Te @ (corners[i] + corners[j]) / 2 @ T)
            for i, j in ((0, 1), (1, 2), (2, 0))
        )
    )
    strains = [mean + 1.5 * np.sqrt(factor) * Te @ Q @ T for Q in corners]
    return K + area * mean.T @ A @ mean, strains, area


def katili(x, y):
    """Leans and shear strains of DKMT as functions of the places in the triangle, DOFs w RX RY corner by corner."""
    lean = [np.zeros((2, 9)) for _ in range(3)]
    for k in range(3):
        lean[k][0, 3 * k + 2], lean[k][1, 3 * k + 1] = 1.0, -1.0
    middle, shear, direction = [], [], []
    for i in range(3):
        j = (i + 1) % 3
        t = np.array([x[j] - x[i], y[j] - y[i]])
        length = np.hypot(*t)
        t /= length
        bent = np.array([t[0] ** 2, t[1] ** 2, 2 * t[0] * t[1]])
        ratio = (bent @ D @ bent) / (t @ AS @ t)
        drop = np.zeros(9)
        drop[3 * j], drop[3 * i] = 1.0, -1.0
        # over the side: w' + lean + d 4 s (1 - s) has the mean of the balance of the beam, -8 d ratio / L^2
        straight = drop / length + t @ (lean[i] + lean[j]) / 2
        d = straight / (-8 * ratio / length**2 - 2 / 3)
        middle.append(np.outer(t, d))
        shear.append(-8 * ratio / length**2 * d)
        direction.append(t)
    at_corners = [
        np.linalg.solve(np.array([direction[k], direction[k - 1]]), np.array([shear[k], shear[k - 1]]))
        for k in range(3)
    ]

    def share(px, py):
        return np.linalg.solve(np.array([np.ones(3), x, y]), [1.0, px, py])

    def leans(px, py):
        s = share(px, py)
        return sum(s[k] * lean[k] + 4 * s[k] * s[(k + 1) % 3] * middle[k] for k in range(3))

    def shears(px, py):
        return sum(of * at for of, at in zip(share(px, py), at_corners, strict=True))

    return leans, shears


def test_triangle():
    """Tilted, of an anisotropic plate; its strains at the corners too, which the stiffness alone does not show."""
    e1 = (TRIANGLE[1] - TRIANGLE[0]) / np.linalg.norm(TRIANGLE[1] - TRIANGLE[0])
    normal = np.cross(TRIANGLE[1] - TRIANGLE[0], TRIANGLE[2] - TRIANGLE[0])
    R = np.array([e1, np.cross(normal / np.linalg.norm(normal), e1), normal / np.linalg.norm(normal)])
    x, y, _ = ((TRIANGLE - TRIANGLE[0]) @ R.T).T
    # Poisson's ratio of the mean over all directions
    angles = np.linspace(0, np.pi, 7)[:-1]
    c, s = np.cos(angles), np.sin(angles)
    along, across = np.array([c * c, s * s, 2 * c * s]), np.array([s * s, c * c, -2 * c * s])
    nu = np.einsum("ia,ij,ja->", along, A, across) / np.einsum("ia,ij,ja->", along, A, along)
    membrane_K, strains, area = felippa(x, y, (1 - 4 * nu**2) / 2)
    leans, shears = katili(x, y)
    bending = np.zeros((9, 9))
    for a, b, weight in gauss(3):  # the square drawn together to the triangle
        p, q = (1 + a) / 2, (1 + b) / 2 * (1 - a) / 2
        px, py = x[0] + p * (x[1] - x[0]) + q * (x[2] - x[0]), y[0] + p * (y[1] - y[0]) + q * (y[2] - y[0])
        by_x, by_y = slope(leans, px, py)
        rows = np.array([by_x[0], by_y[1], by_y[0] + by_x[1]])
        part = weight / 4 * (1 - a) / 2 * 2 * area
        bending += part * (rows.T @ D @ rows + shears(px, py).T @ AS @ shears(px, py))
    own = np.zeros((18, 18))
    plane = np.array([6 * n + k for n in range(3) for k in (0, 1, 5)])
    plate = np.array([6 * n + k for n in range(3) for k in (2, 3, 4)])
    own[np.ix_(plane, plane)], own[np.ix_(plate, plate)] = membrane_K, bending
    turn = np.kron(np.eye(6), R)
    K = turn.T @ own @ turn
    got = triangle_shell.stiffness(TRIANGLE[None], A, 0 * A, D, AS)[0]
    np.testing.assert_allclose(got, K, atol=ROUNDING * np.abs(K).max())
    xy = np.stack([x, y], axis=1)[None]
    rows = andes.strain_rows(xy, np.array([area]), A, np.eye(3)[None])[0][..., np.arange(9).reshape(3, 3).T.ravel()]
    np.testing.assert_allclose(rows, strains, atol=ROUNDING)
