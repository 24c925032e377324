"""What shell elements must hold: symmetry, rigid motion, exact mass, constant strain and curvature, invariance."""

import json
from pathlib import Path

import numpy as np
import pytest

from femstruct.elements import members, quad_shell, triangle_shell
from femstruct.elements.flat_elements import (
    angles,
    flatten,
    frames,
    matrices_by_kind,
    rotate_resultants,
    rotate_rigidities,
    square_points,
)
from femstruct.elements.membrane import integration_points
from femstruct.elements.plate import CORNERS
from femstruct.elements.triangle_shell import MIDDLES
from femstruct.errors import InputError

REFERENCE = json.loads((Path(__file__).parents[1] / "data" / "shells.json").read_text(encoding="utf-8"))
ROUNDING = 1e-12  # rounding: 3e-15 here, of matrices that were turned in space

TURN = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0]
TURN *= np.linalg.det(TURN)
STANDING = np.eye(3)[[2, 0, 1]]  # x and y of a plate become y and z
QUADS = {
    "square": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    "4 to 1": [[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0]],
    "distorted": [[0, 0, 0], [1, 0.1, 0], [1.3, 0.9, 0], [-0.1, 0.8, 0]],
}
WARPED = np.array([[0, 0, 0.1], [1, 0.1, -0.1], [1.3, 0.9, 0.1], [-0.1, 0.8, -0.1]])
TRIANGLES = {
    "half a square": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
    "4 to 1 triangle": [[0, 0, 0], [4, 0, 0], [1, 1, 0]],
    "triangle": [[0, 0, 0], [1, 0.2, 0.3], [0.3, 0.9, 0.1]],
}
SHAPES = {name: np.array(shape) @ TURN.T + [0.3, -2.0, 1.0] for name, shape in (QUADS | TRIANGLES).items()}
ALL = SHAPES | {"warped": WARPED @ TURN.T}
flat = pytest.mark.parametrize("corners", SHAPES.values(), ids=list(SHAPES))
every = pytest.mark.parametrize("corners", ALL.values(), ids=list(ALL))

Q = np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
T = 0.1
ISOTROPIC = (T * Q, 0 * Q, T**3 / 12 * Q, 5 / 6 * T * 0.35 * np.eye(2))
ANISOTROPIC = (
    np.array([[3.0, 0.7, 0.2], [0.7, 5.0, -0.4], [0.2, -0.4, 1.3]]),
    np.array([[0.3, 0.1, 0.05], [0.1, -0.2, 0.1], [0.05, 0.1, 0.2]]),
    np.array([[0.9, 0.2, 0.1], [0.2, 0.7, -0.1], [0.1, -0.1, 0.4]]),
    np.array([[0.8, 0.1], [0.1, 0.6]]),
)
ORTHOTROPIC = (np.diag([3.0, 5.0, 1.3]), np.zeros((3, 3)), np.diag([0.9, 0.7, 0.4]), np.diag([0.8, 0.6]))


def element(corners):
    return quad_shell if len(corners) == 4 else triangle_shell


def stiffness(corners, rigidities=ISOTROPIC, **changes):
    return element(corners).stiffness(corners[None], *rigidities, **changes)[0]


def mass(corners, m0=3.0, m1=0.0, m2=0.4):
    return element(corners).mass(corners[None], m0, m1, m2)[0]


def shares(corners, xi, eta):
    """Of the corners in places of the unit square or of the unit triangle."""
    if len(corners) == 3:
        return np.array([1 - xi - eta, xi, eta]).T
    return np.array([(xi if i else 1 - xi) * (eta if j else 1 - eta) for i, j in CORNERS]).T


def own_places(corners):
    return np.array(CORNERS if len(corners) == 4 else [(0, 0), (1, 0), (0, 1)], dtype=float).T


def gauss(corners, n=4):
    """xi, eta and weights; on the triangle by drawing a side of the square together."""
    xi, eta, weights = square_points(n)
    return (xi, eta, weights) if len(corners) == 4 else (xi, eta * (1 - xi), weights * (1 - xi))


def rigid(points):
    """Six rigid motions of nodes: three shifts, three rotations about the origin."""
    shifts = [np.hstack([np.tile(e, (len(points), 1)), np.zeros((len(points), 3))]).ravel() for e in np.eye(3)]
    turns = [np.hstack([np.cross(e, points), np.tile(e, (len(points), 1))]).ravel() for e in np.eye(3)]
    return np.array([*shifts, *turns])


def on_plane(corners, points):
    """Places [g, 3] on the mean plane and areas of points of the unit square or triangle."""
    xi, eta, weights = points
    R = frames(corners[None])
    xy = flatten(corners[None], R)[0][0]
    step = 0.125  # of differences, exact for the bilinear map
    by_xi, by_eta = (
        (shares(corners, xi + a, eta + b) - shares(corners, xi - a, eta - b)) @ xy / (2 * step)
        for a, b in ((step, 0), (0, step))
    )
    areas = weights * np.abs(np.linalg.det(np.stack([by_xi, by_eta], axis=1)))
    return shares(corners, xi, eta) @ xy @ R[0][:2] + corners.mean(axis=0), areas


def fields(corners, u=None, v=None, w=None, rx=None, ry=None, rz=None):
    """Nodal values in global axes of fields of x and y in the element's own axes."""
    R = frames(corners[None])
    x, y = flatten(corners[None], R)[0][0].T
    own = np.array([0 * x if of is None else of(x, y) + 0 * x for of in (u, v, w, rx, ry, rz)]).T
    return (own.reshape(-1, 2, 3) @ R[0]).ravel()


CONSTANT = {
    "stretch": ([0.3, 0.0, 0.0], {"u": lambda x, y: 0.3 * x}),
    "shear in the plane, with a rotation": ([0.0, 0.0, 0.7], {"v": lambda x, y: 0.7 * x, "rz": lambda x, y: 0.35}),
    "bending": (
        [0, 0, 0, -0.4, 0.6, 0.0],
        {"w": lambda x, y: 0.2 * x**2 - 0.3 * y**2, "rx": lambda x, y: -0.6 * y, "ry": lambda x, y: -0.4 * x},
    ),
    "twist": (
        [0, 0, 0, 0.0, 0.0, -1.0],
        {"w": lambda x, y: 0.5 * x * y, "rx": lambda x, y: 0.5 * x, "ry": lambda x, y: -0.5 * y},
    ),
    "transverse shear": ([0, 0, 0, 0, 0, 0, 2.0, -1.0], {"w": lambda x, y: 2 * x - y}),
}


def law(A, B, D, As):
    whole = np.zeros((8, 8))
    whole[:3, :3], whole[:3, 3:6], whole[3:6, :3], whole[3:6, 3:6], whole[6:, 6:] = A, B, B.T, D, As
    return whole


@every
def test_symmetry_is_exact(corners):
    for matrix in (stiffness(corners, ANISOTROPIC), mass(corners, m1=0.2)):
        assert np.array_equal(matrix, matrix.T)


@every
def test_six_zero_energy_modes_and_no_more(corners):
    """Of a lone cell; warped ones too."""
    K = stiffness(corners)
    values = np.linalg.eigvalsh(K)
    assert (np.abs(values) < 1e-10 * values[-1]).sum() == 6  # stated with the reference
    assert values[6] > 1e-5 * values[-1]  # stated with the reference
    np.testing.assert_allclose(K @ rigid(corners).T, 0, atol=ROUNDING * np.abs(K).max())
    coupled = stiffness(corners, ANISOTROPIC)
    np.testing.assert_allclose(coupled @ rigid(corners).T, 0, atol=ROUNDING * np.abs(coupled).max())


@every
def test_inertia_of_rigid_motions_is_exact(corners):
    """That of a plate with masses at three heights, and m2 once more about the normal."""
    places, areas = on_plane(corners, gauss(corners))
    normal = frames(corners[None])[0, 2]
    m0, m1, m2 = 3.0, 0.2, 0.4
    heights = np.array([-1.0, 0.0, 1.0])
    weights = np.array([(m2 - m1) / 2, m0 - m2, (m2 + m1) / 2])  # moments m0, m1, m2
    exact = np.zeros((6, 6))
    for height, weight in zip(heights, weights, strict=True):
        moving = rigid(places + height * normal).reshape(6, -1, 6)[:, :, :3]
        exact += np.einsum("g,agi,bgi->ab", weight * areas, moving, moving)
    exact[3:, 3:] += m2 * areas.sum() * np.outer(normal, normal)
    M = mass(corners, m0, m1, m2)
    np.testing.assert_allclose(rigid(corners) @ M @ rigid(corners).T, exact, atol=ROUNDING * np.abs(exact).max())
    assert np.linalg.eigvalsh(M).min() > 0


@flat
def test_mass_equals_the_integral_of_its_own_rows(corners):
    xi, eta, _ = gauss(corners)
    _, areas = on_plane(corners, gauss(corners))
    rows = element(corners).interpolate(np.broadcast_to(corners, (16, *corners.shape)), xi, eta)
    M = np.einsum("g,gki,k,gkj->ij", areas, rows, [3.0] * 3 + [0.4] * 3, rows)
    np.testing.assert_allclose(mass(corners), M, atol=ROUNDING * np.abs(M).max())
    normal = frames(corners[None])[0, 2]
    lean = np.einsum("ijk,gjn,k->gin", levi_civita(), rows[:, 3:], normal)  # rotation x normal
    coupled = M + 0.2 * np.einsum("g,gin,gim->nm", areas, rows[:, :3], lean)
    coupled += 0.2 * np.einsum("g,gin,gim->mn", areas, rows[:, :3], lean)
    np.testing.assert_allclose(mass(corners, m1=0.2), coupled, atol=ROUNDING * np.abs(M).max())


def levi_civita():
    symbol = np.zeros((3, 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        symbol[i, j, k], symbol[i, k, j] = 1.0, -1.0
    return symbol


@every
def test_rows_at_the_corners_are_the_dofs(corners):
    count = len(corners)
    rows = element(corners).interpolate(np.broadcast_to(corners, (count, count, 3)), *own_places(corners))
    np.testing.assert_allclose(rows.reshape(6 * count, -1), np.eye(6 * count), atol=ROUNDING)


@every
def test_rows_move_rigidly(corners):
    """The surface through the nodes: bilinear between them, warped or not."""
    xi, eta = np.array([[0.2, 0.6, 0.5], [0.7, 0.4, 0.0]])
    moved = element(corners).interpolate(np.broadcast_to(corners, (3, *corners.shape)), xi, eta) @ rigid(corners).T
    expected = rigid(shares(corners, xi, eta) @ corners).reshape(6, 3, 6).transpose(1, 2, 0)
    np.testing.assert_allclose(moved, expected, atol=ROUNDING * 10)  # places of size 3


@flat
@pytest.mark.parametrize("state", CONSTANT)
def test_energy_and_resultants_of_constant_states(corners, state):
    """In a fully coupled, anisotropic laminate; the shear strains of DKMT are not constant where those of MITC4 are."""
    if element(corners) is triangle_shell and state == "transverse shear":
        return
    strain = np.zeros(8)
    given, motions = CONSTANT[state]
    strain[: len(given)] = given
    q = fields(corners, **motions)
    area = on_plane(corners, gauss(corners))[1].sum()
    forces = law(*ANISOTROPIC) @ strain
    assert q @ stiffness(corners, ANISOTROPIC) @ q == pytest.approx(area * strain @ forces, rel=ROUNDING)
    twice = np.broadcast_to(corners, (2, *corners.shape))
    got = element(corners).resultants(twice, [0.2, 1.0], [0.7, 0.0], *ANISOTROPIC) @ q
    np.testing.assert_allclose(got, np.tile(forces, (2, 1)), atol=1e-11)  # rounding: 2e-15 of forces of 5


@every
def test_the_resultants_do_the_work_the_stiffness_stores(corners):
    """One constitutive law: without the tie of RZ, u K u is the integral of forces times strains."""
    whole, points = law(*ANISOTROPIC), [(square_points(2), slice(6, 8)), (integration_points(), slice(0, 6))]
    if len(corners) == 3:
        points = [((*MIDDLES[:, 1:].T, np.full(3, 1 / 6)), slice(0, 8))]
    work = 0.0
    for (xi, eta, weights), part in points:
        _, areas = on_plane(corners, (xi, eta, weights))
        here = np.broadcast_to(corners, (len(areas), *corners.shape))
        rows = element(corners).resultants(here, xi, eta, *ANISOTROPIC)[:, part]
        work = work + np.einsum("g,gki,kl,glj->ij", areas, rows, np.linalg.inv(whole)[part, part], rows)
    K = stiffness(corners, ANISOTROPIC, **({"drilling": 0.0} if len(corners) == 4 else {}))
    np.testing.assert_allclose(work, K, atol=ROUNDING * np.abs(K).max())


@every
def test_the_first_corner_changes_nothing(corners):
    """With a material that has a direction in space, which is turned into each element's axes."""
    direction = TURN @ [1.0, 0.3, 0.2]

    def of(points):
        angle = angles(frames(points[None]), direction)
        return stiffness(points, [rotate_rigidities(each, angle) for each in ANISOTROPIC]), mass(points, m1=0.2)

    def along(points):
        """Resultants in the direction of the material, at the centre."""
        angle = angles(frames(points[None]), direction)
        centre = [[0.5], [0.5]] if len(points) == 4 else [[1 / 3], [1 / 3]]
        law_here = (rotate_rigidities(each, angle) for each in ANISOTROPIC)
        own = element(points).resultants(points[None], *centre, *law_here)
        return rotate_resultants(own, angle)[0]

    for first in range(1, len(corners)):
        order = np.roll(np.arange(len(corners)), -first)
        dofs = (order[:, None] * 6 + np.arange(6)).ravel()
        for got, whole in zip(of(corners[order]), of(corners), strict=True):
            np.testing.assert_allclose(got, whole[np.ix_(dofs, dofs)], atol=ROUNDING * np.abs(whole).max())
        whole = along(corners)
        np.testing.assert_allclose(along(corners[order]), whole[:, dofs], atol=ROUNDING * np.abs(whole).max())


@every
def test_going_round_the_other_way_changes_nothing(corners):
    """The normal turns over; a material that is alike above and below does not see it."""
    direction = TURN @ [1.0, 0.3, 0.2]
    order = np.arange(len(corners))[::-1]
    dofs = (order[:, None] * 6 + np.arange(6)).ravel()
    one, other = (
        stiffness(points, [rotate_rigidities(each, angles(frames(points[None]), direction)) for each in ORTHOTROPIC])
        for points in (corners, corners[order])
    )
    np.testing.assert_allclose(other, one[np.ix_(dofs, dofs)], atol=ROUNDING * np.abs(one).max())
    np.testing.assert_allclose(mass(corners[order]), mass(corners)[np.ix_(dofs, dofs)], atol=ROUNDING)


@every
def test_turning_the_element_in_space_turns_its_matrices(corners):
    turn = np.linalg.qr(np.random.default_rng(8).standard_normal((3, 3)))[0]
    turn *= np.linalg.det(turn)
    for of in (lambda c: stiffness(c, ANISOTROPIC), lambda c: mass(c, m1=0.2)):
        expected = members.to_global(
            of(corners)[None],
            turn.T[None],
        )[0]
        np.testing.assert_allclose(of(corners @ turn.T + 5.0), expected, atol=10 * ROUNDING * np.abs(expected).max())


@every
def test_scaling_laws(corners):
    """All lengths by s: A counts per length, D by s^2 more, rotations s times as much."""
    s = 5.0
    A, B, D, As = ANISOTROPIC
    scale = np.tile(np.repeat([1.0, s], 3), len(corners))
    expected = np.outer(scale, scale) * stiffness(corners, ANISOTROPIC)
    got = stiffness(s * corners, (A, s * B, s**2 * D, As))
    np.testing.assert_allclose(got, expected, atol=ROUNDING * np.abs(expected).max())
    expected = s**2 * np.outer(scale, scale) * mass(corners, 3.0, 0.2, 0.4)
    got = mass(s * corners, 3.0, 0.2 * s, 0.4 * s**2)
    np.testing.assert_allclose(got, expected, atol=ROUNDING * np.abs(expected).max())


@pytest.mark.parametrize("count", [3, 4])
def test_a_batch_is_its_elements_one_by_one(count):
    corners = np.array([shape for shape in ALL.values() if len(shape) == count])
    factors = np.array([1.0, 2.0, 0.5, 3.0])[: len(corners)]
    each = [factors[:, None, None] * of for of in ANISOTROPIC]
    K = element(corners[0]).stiffness(corners, *each)
    M = element(corners[0]).mass(corners, factors, 0.1, 0.2)
    for n, points in enumerate(corners):
        one = factors[n] * stiffness(points, ANISOTROPIC)
        np.testing.assert_allclose(K[n], one, atol=ROUNDING * np.abs(one).max())
        np.testing.assert_allclose(M[n], mass(points, factors[n], 0.1, 0.2), atol=ROUNDING)


def test_equal_elements_are_computed_once():
    """Those of a regular grid far from the origin, whose coordinates differ by rounding, beside a few others."""
    column, row = np.divmod(np.arange(600), 20)
    origin = np.stack([0.1 * column, 0.1 * row, 0 * row], axis=1)
    cells = SHAPES["square"] * 0.1 + origin[:, None] @ TURN.T + [30.0, 20.0, 10.0]
    cells[550:] += np.random.default_rng(2).uniform(-1e-3, 1e-3, (50, 4, 2)) @ TURN[:, :2].T
    asked = []

    def matrices(own_axes, xy, factors):
        asked.append(len(xy))
        return quad_shell.stiffness(xy @ own_axes[:, :2], *ANISOTROPIC) * factors[:, None, None]

    R = frames(cells)
    factors = np.where(np.arange(600) % 2, 2.0, 1.0)
    got = matrices_by_kind(24, matrices, R, flatten(cells, R)[0], factors)
    assert sum(asked) < 100  # 50 others, and two of each class that rounding makes
    alone = np.concatenate([quad_shell.stiffness(cell[None], *ANISOTROPIC) for cell in cells])
    # rounding of coordinates: 4e-15 of 30 m in elements of 0.1 m, and 1e-12 by which equal ones may differ
    np.testing.assert_allclose(got, alone * factors[:, None, None], atol=1e-10 * np.abs(alone).max())


@pytest.mark.parametrize("shape", ["quads", "triangles"])
@pytest.mark.parametrize("t", REFERENCE["patch"]["t"])
@pytest.mark.parametrize("state", [name for name in CONSTANT if name != "transverse shear"])  # no load is in balance
def test_patch_of_distorted_elements(state, t, shape):
    """Distorted elements in an upright plane, moved at their outer corners: the inner ones follow to 1e-10."""
    nodes = np.hstack([np.array(REFERENCE["patch"]["nodes"]), np.zeros((8, 1))])
    cells = np.array(REFERENCE["patch"]["quads"])
    if shape == "triangles":
        cells = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    count = len(cells)
    strain = np.zeros(8)
    given, motions = CONSTANT[state]
    strain[: len(given)] = given
    x, y = nodes[:, 0], nodes[:, 1]
    zero = 0 * x
    own = [motions[name](x, y) + zero if name in motions else zero for name in ("u", "v", "w", "rx", "ry", "rz")]
    exact = (np.array(own).T.reshape(-1, 2, 3) @ STANDING.T).reshape(-1)
    points = (nodes @ STANDING.T)[cells]
    q = 1e6 / (1 - 0.25**2) * np.array([[1, 0.25, 0], [0.25, 1, 0], [0, 0, 0.375]])
    coupling = 0.1 * t**2 * (t > 0.01)  # a thin one turns L / t times as much as it stretches: 1.6e-10 is left then
    rigidities = (t * q, coupling * q, t**3 / 12 * q, 5 / 6 * t * 4e5 * np.eye(2))
    dofs = (cells[:, :, None] * 6 + np.arange(6)).reshape(count, -1)
    K = np.zeros((48, 48))
    np.add.at(K, (dofs[:, :, None], dofs[:, None, :]), element(points[0]).stiffness(points, *rigidities))
    inner = -np.linalg.solve(K[24:, 24:], K[24:, :24] @ exact[:24])
    assert np.abs(inner - exact[24:]).max() < REFERENCE["patch"]["tolerance"] * np.abs(exact).max()
    whole = np.concatenate([exact[:24], inner])
    angle = angles(frames(points), STANDING @ [1.0, 0.0, 0.0])
    rows = element(points[0]).resultants(points, np.full(count, 0.3), np.full(count, 0.6), *rigidities)
    got = np.einsum("nki,ni->nk", rotate_resultants(rows, angle), whole[dofs])
    forces = law(*rigidities) @ strain
    # stated in the docstring; beside the stretching that a thin plate answers to motions of this size
    np.testing.assert_allclose(got, np.tile(forces, (count, 1)), atol=1e-10 * np.abs(law(*rigidities)).max())


def test_wrong_input_is_refused():
    corners = SHAPES["square"]
    A, B, D, As = ISOTROPIC
    wrong = [
        (lambda: stiffness(corners[[0, 1, 3, 2]]), "cell 0"),
        (lambda: stiffness(corners[[0, 1, 1, 0]]), "cell 0"),
        (lambda: quad_shell.stiffness(corners, *ISOTROPIC), "corners: got shape"),
        (lambda: stiffness(corners, (A, B, D, As[0])), "As: got shape"),
        (lambda: stiffness(corners, (A, np.nan * B, D, As)), "B: got nan"),
        (lambda: stiffness(corners, (A, B, np.triu(D + 1), As)), "D: .*symmetric"),
        (lambda: mass(corners, m0=-1.0), "m0"),
        (lambda: triangle_shell.stiffness(corners[None], *ISOTROPIC), "corners: got shape"),
        (lambda: stiffness(SHAPES["triangle"][[0, 1, 1]]), "cell 0"),
        (lambda: angles(frames(corners[None]), frames(corners[None])[0, 2]), "orientation at cell 0"),
    ]
    for build, said in wrong:
        with pytest.raises(InputError, match=said):
            build()
