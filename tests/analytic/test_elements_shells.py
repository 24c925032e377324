"""Shell elements against closed forms of plates, thin to thick, and folded ones against three-dimensional solids."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from femstruct.elements import quad_shell, triangle_shell
from femstruct.elements.flat_elements import angles, frames, rotate_resultants, rotate_rigidities

HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "shells_by_hand.py"))
Shell, all_of, grid, halves, isotropic = (HAND[name] for name in ("Shell", "all_of", "grid", "halves", "isotropic"))
UX, UY, UZ, RX, RY, RZ = range(6)
STEEL = {"E": 210e9, "nu": 0.3, "rho": 7850.0}


def merged(*patches):
    """Nodes and cells of patches (nodes [n, 3], cells); nodes at one place are one."""
    offsets = np.cumsum([0] + [len(nodes) for nodes, _ in patches])
    places = np.concatenate([nodes for nodes, _ in patches])
    _, first, of = np.unique(np.rint(places * 1e6), axis=0, return_index=True, return_inverse=True)
    return places[first], np.concatenate(
        [of.ravel()[cells + k] for (_, cells), k in zip(patches, offsets, strict=False)]
    )


def patch(origin, along, across, nx, ny):
    square, cells = grid(nx, ny)
    return np.array(origin) + square @ np.array([along, across], dtype=float), cells


def folded(t, *patches):
    nodes, cells = merged(*patches)
    rho = STEEL["rho"]
    return Shell(nodes, cells, isotropic(STEEL["E"], STEEL["nu"], t), (rho * t, 0.0, rho * t**3 / 12))


def angle(nx, ny):
    return folded(
        0.008, patch([0, 0, 0], [4, 0, 0], [0, 0.2, 0], nx, ny), patch([0, 0, 0], [4, 0, 0], [0, 0, 0.2], nx, ny)
    )


def box(n):
    x, y, z = round(1 / n), round(0.8 / n), round(0.5 / n)
    walls = [patch([0, y0, 0], [1, 0, 0], [0, 0, 0.5], x, z) for y0 in (0, 0.8)]
    walls += [patch([x0, 0, 0], [0, 0.8, 0], [0, 0, 0.5], y, z) for x0 in (0, 1)]
    return folded(0.006, patch([0, 0, 0], [1, 0, 0], [0, 0.8, 0], x, y), *walls)


def beam():
    """An I of 3 m, flanges 150 x 10 and web 8 over 280 mm; the ends of the web inside the flanges have no mass."""
    flanges = [patch([0, -0.075, z], [3, 0, 0], [0, 0.15, 0], 60, 4) for z in (-0.145, 0.145)]
    nodes, cells = merged(*flanges, patch([0, 0, -0.145], [3, 0, 0], [0, 0, 0.29], 60, 6))
    in_flange = np.arange(len(cells)) < 2 * 60 * 4
    thick, thin = (isotropic(STEEL["E"], STEEL["nu"], t) for t in (0.010, 0.008))
    each = tuple(np.where(in_flange[:, None, None], a, b) for a, b in zip(thick, thin, strict=True))
    t = np.where(in_flange, 0.010, 0.008 * 0.28 / 0.29)
    return Shell(nodes, cells, each, (STEEL["rho"] * t, 0 * t, STEEL["rho"] * t**3 / 12))


def test_angle():
    """Long, open and thin: it stretches where it bends and twists. Solids, here and below: degree 4 or 5, two codes."""
    solid = [20.126, 31.543, 46.284, 48.859, 65.966, 84.548]
    got = angle(80, 4).frequencies([], 12, shift=-1e3)[6:]
    np.testing.assert_allclose(got, solid, rtol=1e-2)  # cells of 50 mm, and the corner counted twice: 4.5e-3 here


def test_open_box():
    solid = [14.14, 31.88, 41.252, 49.836, 50.802, 63.28]
    got = box(0.05).frequencies([], 12, shift=-1e3)[6:]
    np.testing.assert_allclose(got, solid, rtol=1e-2)  # cells of 50 mm: 5e-3 here


def test_i_beam():
    """Clamped at one end: bending both ways, torsion, a web that bows."""
    solid = [10.532, 18.817, 38.2, 64.63, 84.31, 162.16]
    beam_ = beam()
    got = beam_.frequencies(all_of(beam_.near(x=0.0)), 6, shift=-1e3)
    np.testing.assert_allclose(got, solid, rtol=2e-2)  # cells of 50 mm, and the web in the flanges: 1.5e-2 here


def supported(kind, n, t, moved=0.0):
    """A unit square plate on hard supports, with E such that D is 1, and its DOFs held."""
    nu = 0.3
    square, quads = grid(n, n)
    inner = ((square > 0) & (square < 1)).all(axis=1)
    places = square + moved / n * inner[:, None] * np.random.default_rng(7).uniform(-1, 1, square.shape)
    nodes = np.hstack([places, np.zeros((len(square), 1))])
    rigidities = isotropic(12 * (1 - nu**2) / t**3, nu, t)
    plate = Shell(nodes, quads if kind == "quads" else halves(quads), rigidities, (1.0, 0.0, t**2 / 12))
    on_x, on_y = (np.flatnonzero((square[:, axis] == 0) | (square[:, axis] == 1)) for axis in (0, 1))
    held = [all_of(np.arange(len(nodes)), UX, UY, RZ), all_of(on_x, UZ, RX), all_of(on_y, UZ, RY)]
    return plate, np.unique(np.concatenate(held))


def navier(t, terms=199):
    """Centre deflection of the unit square under a unit pressure, by Mindlin's theory with 5/6, D = 1, nu = 0.3."""
    m = np.arange(1, terms + 1, 2)
    k2 = np.pi**2 * (m[:, None] ** 2 + m**2)
    shear = 1 / (5 / 6 * 6 * (1 - 0.3) / t**2)  # D / (k G t)
    sign = (-1.0) ** ((m - 1) // 2)
    return (16 / np.pi**2 * np.outer(sign / m, sign / m) * (1 + shear * k2) / k2**2).sum()


def centre_deflection(kind, n, t, moved=0.0):
    plate, held = supported(kind, n, t, moved=moved)
    pressure = plate.tributary[:, None] * np.eye(6)[UZ]
    middle = (n // 2) * (n + 1) + n // 2
    return plate.moved(held, pressure)[middle, UZ] if not moved else plate.moved(held, pressure)[:, UZ].max()


@pytest.mark.parametrize(("kind", "most"), [("quads", 5.5e-3), ("triangles", 1.4e-2)])
@pytest.mark.parametrize("t", [1e-4, 1e-3, 1e-2, 0.1])
def test_no_locking(kind, most, t):
    """The error with 8 x 8 elements is about the same at any thickness, and goes with h^2."""
    exact = navier(t)
    coarse, fine = (1 - centre_deflection(kind, n, t) / exact for n in (8, 16))
    assert abs(coarse) < most
    if t < 0.05:
        assert 1.8 < np.log2(coarse / fine) < 2.2


def test_no_locking_of_distorted_quadrilaterals():
    """Inner nodes moved by up to 30 % of a side, a thousandth thin."""
    exact = navier(1e-3)
    coarse, fine = (1 - centre_deflection("quads", n, 1e-3, moved=0.3) / exact for n in (8, 32))
    assert abs(coarse) < 2e-2  # 1.3e-2 with other random places
    assert abs(fine) < 2e-3  # h^2 of it


@pytest.mark.parametrize("kind", ["quads", "triangles"])
def test_elements_that_are_shorter_than_the_plate_is_thick(kind):
    """The first four frequencies by Mindlin's theory of a plate 0.3 thick, elements of a sixth of that."""
    t = 0.3
    plate, held = supported(kind, 20, t)
    shear, inertia = 5 / 6 * 6 * (1 - 0.3) / t**2, t**2 / 12
    exact = []
    for m, n in ((1, 1), (1, 2), (2, 1), (2, 2)):
        k2 = np.pi**2 * (m * m + n * n)
        # w and its slope: [[S k2, S k], [S k, k2 + S]] against [1, inertia]
        K = np.array([[shear * k2, shear * np.sqrt(k2)], [shear * np.sqrt(k2), k2 + shear]])
        exact.append(np.sqrt(np.linalg.eigvals(K / [[1.0], [inertia]]).min()) / (2 * np.pi))
    got = plate.frequencies(held, 4)
    np.testing.assert_allclose(got, exact, rtol=1.4e-2)  # h^2, the last 7e-3 and 1.3e-2 here


@pytest.mark.parametrize("kind", ["quads", "triangles"])
def test_moments_and_shear_forces_of_a_plate_under_pressure(kind):
    """Bending and twisting moments and shear forces by Navier, mean error in the middles of the elements.

    In quadrilaterals both converge with h^2. In triangles the moments do with h, and the shear forces of a thin plate
    stay a tenth off: they are what is left of the balance of the sides.
    """
    errors = []
    for n in (12, 24):
        plate, held = supported(kind, n, 0.01)
        pressure = plate.tributary[:, None] * np.eye(6)[UZ]
        moved = plate.moved(held, pressure).reshape(-1)
        corners = plate.nodes[plate.cells]
        middle = np.full(len(corners), 0.5 if kind == "quads" else 1 / 3)
        element = quad_shell if kind == "quads" else triangle_shell
        rows = element.resultants(corners, middle, middle, *plate.rigidities)
        got = np.einsum("nki,ni->nk", rows, moved[plate.dofs])
        x, y = corners.mean(axis=1)[:, :2].T
        angle = np.arctan2(*np.swapaxes(frames(corners)[:, 0, 1::-1], 0, 1))
        got = np.einsum("nki,ni->nk", rotate_resultants(np.broadcast_to(np.eye(8), (len(x), 8, 8)), -angle), got)
        m = np.arange(1, 80, 2) * np.pi
        k2 = m[:, None] ** 2 + m**2
        w = 16 / np.outer(m, m) / k2**2
        sx, cx, sy, cy = np.sin(np.outer(x, m)), np.cos(np.outer(x, m)), np.sin(np.outer(y, m)), np.cos(np.outer(y, m))
        m1, m2 = m[:, None] ** 2, m**2

        def total(left, amount, right):
            return np.einsum("pi,ij,pj->p", left, amount, right)

        exact = np.stack(
            [
                total(sx, w * (m1 + 0.3 * m2), sy),
                total(sx, w * (m2 + 0.3 * m1), sy),
                -0.7 * total(cx, w * np.outer(m, m), cy),
                total(cx, w * k2 * m[:, None], sy),
                total(sx, w * k2 * m, cy),
            ],
            axis=1,
        )
        errors.append(np.abs(got[:, 3:] - exact).mean(axis=0) / np.abs(exact).max(axis=0))
    coarse, fine = errors
    if kind == "quads":
        assert ((fine < 2.5e-3) & (coarse / fine > 3.5)).all()  # half of the bending wave in 24 elements, with h^2
    else:
        assert ((fine < [9e-3] * 3 + [0.08] * 2) & (coarse / fine > [2.0] * 3 + [1.1] * 2)).all()  # with h, and hardly


@pytest.mark.parametrize(("kind", "most"), [("quads", 3e-4), ("triangles", 1e-3)])
def test_layers_that_couple_stretching_and_bending(kind, most):
    """Two layers at right angles, 40 times as stiff along as across, a fifth thick; Navier's form with B11 = -B22."""
    E, nu, G, t = 40.0, 0.25, 0.6, 0.2
    free = 1 - nu**2 / E
    along, across, mixed = E / free, 1 / free, nu / free
    A = np.array([[(along + across) / 2, mixed, 0], [mixed, (along + across) / 2, 0], [0, 0, G]]) * t
    B = np.diag([1.0, -1.0, 0.0]) * (across - along) * t**2 / 8
    D, As = A * t**2 / 12, 0.605 * t * np.diag([0.55, 0.55])
    m0, m2 = t, t**3 / 12
    p = np.pi
    # u cos sin, v sin cos, w sin sin, leans as u and v
    K = np.array(
        [
            [A[0, 0] + A[2, 2], A[0, 1] + A[2, 2], 0, B[0, 0], 0],
            [A[0, 1] + A[2, 2], A[1, 1] + A[2, 2], 0, 0, B[1, 1]],
            [0, 0, As[0, 0] + As[1, 1], As[0, 0] / p, As[1, 1] / p],
            [B[0, 0], 0, As[0, 0] / p, D[0, 0] + D[2, 2] + As[0, 0] / p**2, D[0, 1] + D[2, 2]],
            [0, B[1, 1], As[1, 1] / p, D[0, 1] + D[2, 2], D[1, 1] + D[2, 2] + As[1, 1] / p**2],
        ]
    )
    exact = np.sqrt(np.linalg.eigvals(p**2 * K / np.array([m0, m0, m0, m2, m2])[:, None]).real.min()) / (2 * p)
    found = []
    for n in (16, 32):
        square, quads = grid(n, n)
        nodes = np.hstack([square, np.zeros((len(square), 1))])
        cells = quads if kind == "quads" else halves(quads)
        R = frames(nodes[cells])
        to_x = angles(R, [1.0, 0.0, 0.0])
        plate = Shell(nodes, cells, tuple(rotate_rigidities(of, to_x) for of in (A, B, D, As)), (m0, 0.0, m2))
        on_x, on_y = (np.flatnonzero((square[:, axis] == 0) | (square[:, axis] == 1)) for axis in (0, 1))
        held = np.union1d(all_of(on_x, UY, UZ, RX), all_of(on_y, UX, UZ, RY))
        found.append(plate.frequencies(held, 1)[0])
    assert (4 * found[1] - found[0]) / 3 == pytest.approx(exact, rel=most)  # what h^2 leaves
    assert found[1] == pytest.approx(exact, rel=5e-3)  # h^2
    uncoupled = np.sqrt(np.linalg.eigvals(p**2 * K[2:, 2:] / np.array([m0, m2, m2])[:, None]).real.min()) / (2 * p)
    assert uncoupled > 1.2 * exact


def plane_wave(kind, cells, angle):
    """Frequency of a bending wave of length 1 in a regular mesh without end, over that of a thin plate, less 1.

    Equations of the middle node of four squares, the motion of the others being that of the wave.
    """
    t, nu, h = 1e-4, 0.3, 1.0 / cells
    square, quads = grid(2, 2)
    nodes = np.hstack([2 * h * square, np.zeros((9, 1))])
    rigidities = isotropic(12 * (1 - nu**2) / t**3, nu, t)
    plate = Shell(nodes, quads if kind == "quads" else halves(quads), rigidities, (1.0, 0.0, t**2 / 12))
    wave = 2 * np.pi * np.array([np.cos(angle), np.sin(angle)])
    phases = np.exp(1j * (nodes - nodes[4])[:, :2] @ wave)
    own = all_of([4], UZ, RX, RY)
    K, M = (of.toarray()[own].reshape(3, 9, 6)[..., UZ : RY + 1] for of in (plate.K, plate.M))
    K, M = (np.einsum("inj,n->ij", of, phases) for of in (K, M))
    return np.sqrt(eigh(K, M, eigvals_only=True)[0]) / (2 * np.pi) ** 2 - 1


def test_a_bending_wave_along_the_sides_of_quadrilaterals():
    """(k h)^2 / 24 too high: linear fields whose one shear strain vanishes are as stiff as tan^2 x sin^2 x for x^4,
    x = k h / 2, and sides that bow have the right mass. Straight sides would add (k h)^2 / 12."""
    for cells in (8, 16):
        x = np.pi / cells
        of_mass = 0.12 * x**4  # the sides bow with the leans of the corners, which are tan x / x too large
        assert 1 + plane_wave("quads", cells, 0.0) == pytest.approx(np.tan(x) * np.sin(x) / x**2, abs=of_mass)
    x2 = (2 * np.pi / 64) ** 2
    assert plane_wave("quads", 64, 0.0) == pytest.approx(x2 / 24, rel=2e-3)  # the next term, 1.7e-3 by the closed form


@pytest.mark.parametrize("kind", ["quads", "triangles"])
def test_cells_a_bending_wave(kind):
    """Eight cells a wave keep it within 3 % in any direction, six within 5 %, with the square of their size."""
    angles_ = np.radians([0, 30, 45, 60, 90, 135])
    eight, six, many = (np.abs([plane_wave(kind, n, a) for a in angles_]).max() for n in (8, 6, 16))
    assert 0.015 < eight < 0.03 and six < 0.05
    assert np.log2(eight / many) == pytest.approx(2.0, abs=0.1)  # the order
