"""Frames against frequency equations, closed-form deflections and rigid geometry."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from femstruct.elements import frame
from femstruct.elements import members as placement
from femstruct.errors import InputError

ROUNDING = 1e-13  # rounding: 4e-16 here at most

REFERENCE = json.loads((Path(__file__).parents[1] / "data" / "elements.json").read_text(encoding="utf-8"))["frame"]
IN_PLANE = {"C": (1, 5), "P": (1,), "F": ()}
SECTION = {"E": 210e9, "G": 80e9, "A": 3e-4, "Iy": 2e-8, "Iz": 5e-8, "J": 4e-8, "ky": 0.8, "kz": 0.6}


def element_stiffness(kind, length, s):
    return frame.stiffness(kind, length, s["E"], s["G"], s["A"], s["Iy"], s["Iz"], s["J"], s["ky"], s["kz"])


def element_mass(kind, length, rho, s):
    return frame.mass(kind, length, rho, s["A"], s["Iy"], s["Iz"], s["ky"], s["kz"], s["E"], s["G"])


def assembled(points, members, kind, rho, s, orientation=None):
    """K, M of members (pairs of points), dense; the middle nodes of bars of three come after the points."""
    points, members = np.asarray(points, dtype=float), np.asarray(members)
    start, end = points[members[:, 0]], points[members[:, 1]]
    length = np.linalg.norm(end - start, axis=1)
    R = placement.directions(start, end, orientation)
    nodes, count = members, len(points)
    if frame.nodes_per_bar(kind) == 3:
        nodes = np.column_stack([members, count + np.arange(len(members))])
        count += len(members)
    dofs = (nodes[:, :, None] * 6 + np.arange(6)).reshape(len(members), -1)
    matrices = np.zeros((2, 6 * count, 6 * count))
    for k, local in enumerate((element_stiffness(kind, length, s), element_mass(kind, length, rho, s))):
        np.add.at(matrices[k], (dofs[:, :, None], dofs[:, None, :]), placement.to_global(local, R))
    return matrices


def line(n, length=1.0):
    points = np.zeros((n + 1, 3))
    points[:, 0] = np.linspace(0, length, n + 1)
    return points, np.stack([np.arange(n), np.arange(1, n + 1)], axis=1)


def omegas(K, M, free):
    return np.sqrt(np.abs(eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)))


def bending(ends, n, kind="euler", s=None):
    """omega of bending in x-y of a line of length, EI and mass per length 1."""
    s = s or {"E": 1.0, "G": 1.0, "A": 1.0, "Iy": 1.0, "Iz": 1.0, "J": 1.0, "ky": 1.0, "kz": 1.0}
    K, M = assembled(*line(n), kind, 1.0, s)
    in_plane = {6 * node + component for node in range(len(K) // 6) for component in IN_PLANE["C"]}
    held = set(IN_PLANE[ends[0]]) | {6 * n + component for component in IN_PLANE[ends[1]]}
    return omegas(K, M, sorted(in_plane - held))


@pytest.mark.parametrize("ends", ["CF", "CC", "PP", "CP"])
def test_beam_roots_and_order(ends):
    roots = np.array(REFERENCE["beam_betaL"][{"CC": "CC/FF", "CP": "CP/FP"}.get(ends, ends)])
    n = np.array([4, 8, 16])
    error = np.array([np.abs(bending(ends, k)[:3] / roots**2 - 1) for k in n])
    # consistent mass: (beta h)^4 / 1440, at 16 elements 1.5e-4 for the third root of CC
    assert error[2].max() <= 2e-4
    fitted = -np.polyfit(np.log(n), np.log(error[:, 0]), 1)[0]
    assert fitted == pytest.approx(4.0, abs=0.1)  # the next order at 4 elements: 0.02 here


def test_roots_of_the_table_solve_their_frequency_equations():
    equations = {
        "CF": lambda b: np.cos(b) * np.cosh(b) + 1,
        "CC/FF": lambda b: np.cos(b) * np.cosh(b) - 1,
        "CP/FP": lambda b: np.tan(b) - np.tanh(b),
        "PP": np.sin,
    }
    for name, equation in equations.items():
        for root in REFERENCE["beam_betaL"][name]:
            # rounding: 1e-13 here
            assert brentq(equation, root - 0.01, root + 0.01, xtol=1e-14) == pytest.approx(root, rel=1e-12)


@pytest.mark.parametrize("n", [1, 2, 4, 8])
def test_cantilever_errors_equal_the_table(n):
    expected = REFERENCE[f"CF_freq_err_pct_{n}el"]
    roots = np.array(REFERENCE["beam_betaL"]["CF"])[: len(expected)]
    got = 100 * (bending("CF", n)[: len(expected)] / roots**2 - 1)
    # 8 elements: an error of 2e-4 % is a difference of nearly equal numbers, good to 1e-9 of the frequency
    np.testing.assert_allclose(got, expected, rtol=1e-6, atol=1e-7)


def test_free_beam_in_both_planes_and_rigid_modes():
    s = {"E": 1.0, "G": 1.0, "A": 1.0, "Iy": 4.0, "Iz": 1.0, "J": 1.0, "ky": 1.0, "kz": 1.0}
    K, M = assembled(*line(8), "euler", 1.0, s)
    root = REFERENCE["beam_betaL"]["CC/FF"][0] ** 2
    planes = [[6 * node + c for node in range(9) for c in pair] for pair in ((1, 5), (2, 4))]
    for plane, stiffer in zip(planes, (1, 2), strict=True):
        values = omegas(K, M, plane)
        assert values[:2].max() <= 1e-3  # square root of rounding, 1e-16 of omega_max^2 = 1e9
        assert values[2] == pytest.approx(stiffer * root, rel=3e-4)  # (beta h)^4 / 1440, h = 1/8: 8e-5 here


def timoshenko_pinned(mode, EI, kGA, rhoA, rhoI, length):
    """Lower root of omega^4 rhoI rhoA / kGA - omega^2 (rhoA + k^2 (rhoI + EI rhoA / kGA)) + EI k^4 = 0."""
    k = mode * np.pi / length
    a, b, c = rhoI * rhoA / kGA, -(rhoA + k**2 * (rhoI + EI * rhoA / kGA)), EI * k**4
    return np.sqrt((-b - np.sqrt(b**2 - 4 * a * c)) / (2 * a))


def test_timoshenko_pinned_beam_against_the_closed_form():
    s = {"E": 1.0, "G": 0.4, "A": 1.0, "Iy": 1.0, "Iz": 0.01, "J": 1.0, "ky": 0.85, "kz": 1.0}
    exact = np.array([timoshenko_pinned(m, 0.01, 0.34, 1.0, 0.01, 1.0) for m in (1, 2, 3)])
    n = np.array([8, 16, 32])
    error = np.array([np.abs(bending("PP", k, "timoshenko", s)[:3] / exact - 1) for k in n])
    assert error[-1].max() <= 4e-3
    # the static shape functions are exact for end loads, not for inertia: second order where shear matters
    assert -np.polyfit(np.log(n), np.log(error[:, 0]), 1)[0] == pytest.approx(2.0, abs=0.1)
    assert bending("PP", 32, "euler", s)[0] / exact[0] > 1.1


# a section of L / i = 10, as deep as half its length, where shear takes a third off the third mode, and a slender one
@pytest.mark.parametrize("radius", [0.1, 0.003])
@pytest.mark.parametrize("graded", [False, True])
def test_the_bar_of_three_nodes_converges_with_the_fourth_power(radius, graded):
    I = radius**2  # noqa: E741 (the second moment)
    s = {"E": 1.0, "G": 0.4, "A": 1.0, "Iy": 1.0, "Iz": I, "J": 1.0, "ky": 0.85, "kz": 1.0}
    exact = np.array([timoshenko_pinned(m, I, 0.34, 1.0, I, 1.0) for m in (1, 2, 3)])
    n, errors = np.array([8, 16, 32]), []
    for count in n:
        points, members = line(count)
        if graded:  # neighbours differ by up to a quarter of their length
            points[:, 0] += 0.5 * np.sin(2 * np.pi * points[:, 0]) / (2 * np.pi)
        K, M = assembled(points, members, "timoshenko18", 1.0, s)
        free = sorted({6 * node + c for node in range(len(K) // 6) for c in (1, 5)} - {1, 6 * count + 1})
        errors.append(omegas(K, M, free)[:3] / exact - 1)
    errors = np.array(errors)
    assert (errors > 0).all()  # a conforming element with exact integrals: frequencies from above
    assert errors[-1].max() <= 2e-5  # (k h)^4 / 1440: 1.2e-5 here
    for mode in range(3):
        # the next order at 8 bars: 0.09 here
        assert -np.polyfit(np.log(n), np.log(errors[:, mode]), 1)[0] == pytest.approx(4.0, abs=0.15)


# free rods and shafts: m pi c, of bars with two nodes from above with (k h)^2 / 24, of three with the fourth power
@pytest.mark.parametrize(("kind", "order"), [("euler", 2.0), ("timoshenko", 2.0), ("timoshenko18", 4.0)])
@pytest.mark.parametrize("component", [0, 3])
def test_order_of_stretch_and_torsion(kind, order, component):
    s = {"E": 1.0, "G": 0.4, "A": 1.0, "Iy": 0.5, "Iz": 0.5, "J": 0.3, "ky": 1.0, "kz": 1.0}
    speed = 1.0 if component == 0 else np.sqrt(0.4 * 0.3)
    n = np.array([4, 8, 16])
    errors = []
    for count in n:
        K, M = assembled(*line(count), kind, 1.0, s)
        found = omegas(K, M, [6 * node + component for node in range(len(K) // 6)])
        errors.append(found[2] / (2 * np.pi * speed) - 1)  # after the rigid motion and the first
    # the next order at 4 bars: 0.08 here
    assert -np.polyfit(np.log(n), np.log(errors), 1)[0] == pytest.approx(order, abs=0.1)


def test_a_stocky_clamped_beam_against_its_frequency_equation():
    """Clamped and free, length over radius of gyration 10: the roots of the 4 x 4 determinant of the exact solution."""
    EI, kGA, rhoA, rhoI = 0.01, 0.34, 1.0, 0.01

    def determinant(omega):
        # w = exp(r x): EI kGA r^4 + omega^2 (EI rhoA + kGA rhoI) r^2 + omega^2 rhoA (omega^2 rhoI - kGA) = 0
        squares = np.roots([EI * kGA, omega**2 * (EI * rhoA + kGA * rhoI), omega**2 * rhoA * (omega**2 * rhoI - kGA)])
        r = np.concatenate([np.sqrt(squares.astype(complex)), -np.sqrt(squares.astype(complex))])
        turn = (kGA * r**2 + rhoA * omega**2) / (kGA * r)  # theta over w, from the balance of forces
        end = np.exp(r)
        rows = [np.ones(4), turn, EI * turn * r * end, kGA * (r - turn) * end]
        return np.linalg.det(np.array(rows)) / np.prod([r[i] - r[j] for i in range(4) for j in range(i)])

    found = bending(
        "CF", 16, "timoshenko18", {"E": 1.0, "G": 0.4, "A": 1.0, "Iy": 1.0, "Iz": EI, "J": 1.0, "ky": 0.85, "kz": 1.0}
    )[:4]
    for omega in found:
        values = np.array([determinant(omega * (1 + shift)) for shift in (-1e-4, 0.0, 1e-4)])
        part = values.real if np.abs(values.real).max() > np.abs(values.imag).max() else values.imag
        assert part[0] * part[2] < 0  # a root within 1e-4, where 16 elements are good to 2e-5


def test_portal_of_three_equal_members():
    """Fixed feet, inextensible members: roots of the slope-deflection frequency equations, swaying or not."""
    n = 8
    s = {"E": 1.0, "G": 1.0, "A": 1.0, "Iy": 1e-8, "Iz": 1e-8, "J": 1e-8, "ky": 1.0, "kz": 1.0}  # EA L^2 / EI = 1e8
    up, across = np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1)[1:]
    points = [(0, 0, z) for z in up] + [(x, 0, 1) for x in across] + [(1, 0, z) for z in up[::-1][1:]]
    members = np.stack([np.arange(3 * n), np.arange(1, 3 * n + 1)], axis=1)
    K, M = assembled(points, members, "euler", 1.0, s)
    free = [6 * node + c for node in range(1, 3 * n) for c in (0, 2, 4)]
    roots = REFERENCE["portal_fixed_equal_members_betaL"]
    # Slope-deflection functions have a pole at the clamped-clamped root, where the joints stay still and the end
    # moments of column and beam balance: a symmetric mode that a search for sign changes leaves out of the table.
    still_joints = REFERENCE["beam_betaL"]["CC/FF"][0]
    exact = np.sort(np.array([*roots["antisym"], *roots["sym"], still_joints]))
    beta = np.sqrt(omegas(K, M, free)[: len(exact)] / 1e-4)
    np.testing.assert_allclose(beta, exact, rtol=7e-4)  # 8 elements: (beta h)^4 / 1440 = 5e-4 at 7.43
    corner = free.index(6 * n)
    force = np.zeros(len(free))
    force[corner] = 1e-8
    sway = np.linalg.solve(K[np.ix_(free, free)], force)[corner]
    assert sway == pytest.approx(5 / 84, rel=1e-6)  # H h^3 / EI; stretching of the members is 1e-8 of it


@pytest.mark.parametrize("kind", frame.KINDS)
def test_cantilever_deflections(kind):
    """Tip force and couple across both axes, axial force, torque: the textbook's, with shear for timoshenko."""
    length, s = 0.7, SECTION
    flexibility = np.linalg.inv(element_stiffness(kind, length, s)[0, 6:, 6:])
    sheared = kind != "euler"
    assert flexibility[0, 0] == pytest.approx(length / (s["E"] * s["A"]), rel=ROUNDING)
    assert flexibility[3, 3] == pytest.approx(length / (s["G"] * s["J"]), rel=ROUNDING)
    for move, turn, sign, inertia, k in ((1, 5, 1, "Iz", "ky"), (2, 4, -1, "Iy", "kz")):
        EI, shear = s["E"] * s[inertia], sheared * length / (s[k] * s["G"] * s["A"])
        assert flexibility[move, move] == pytest.approx(length**3 / (3 * EI) + shear, rel=ROUNDING)
        assert flexibility[move, turn] == pytest.approx(sign * length**2 / (2 * EI), rel=ROUNDING)
        assert flexibility[turn, turn] == pytest.approx(length / EI, rel=ROUNDING)


@pytest.mark.parametrize("kind", frame.KINDS)
def test_frequencies_do_not_turn_with_the_frame(kind):
    """An L in space with a section of two stiffnesses, turned at random with its orientation vectors."""
    points = np.array([[0, 0, 0], [0.4, 0, 0], [0.8, 0, 0], [0.8, 0.3, 0.1], [0.8, 0.6, 0.2]])
    members = [[0, 1], [1, 2], [2, 3], [3, 4]]
    orientation = np.array([0.2, -0.1, 1.0])
    free = np.arange(6, 30 if frame.nodes_per_bar(kind) == 2 else 54)
    still = omegas(*assembled(points, members, kind, 7800.0, SECTION, orientation), free)
    turn = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    turned = omegas(*assembled(points @ turn.T, members, kind, 7800.0, SECTION, turn @ orientation), free)
    rounding = np.finfo(float).eps * (still.max() / still.min()) ** 2  # of K, over the lowest omega^2
    np.testing.assert_allclose(turned, still, rtol=rounding)  # 3e-10 at most on two processors


def test_rigid_arms_in_line_with_the_member():
    """Cantilever with stiff ends d1 and d2: force at the far node, closed form."""
    length, d1, d2 = 0.7, 0.2, 0.15
    K = element_stiffness("euler", length, SECTION)
    K = placement.with_offsets(K, [[d1, 0, 0]], [[-d2, 0, 0]])[0]
    EI = SECTION["E"] * SECTION["Iz"]
    flexibility = np.linalg.inv(K[6:, 6:])
    end = length**3 / 3 + d2 * length**2 / 2
    turn = length**2 / 2 + d2 * length
    assert flexibility[1, 1] == pytest.approx((end + turn * d2) / EI, rel=ROUNDING)
    # the force 1 at the far node is met at the near node by 1 and by the whole arm d1 + L + d2
    reaction = K[:6, 6:] @ flexibility[:, 1]
    assert reaction[1] == pytest.approx(-1, rel=ROUNDING)
    assert reaction[5] == pytest.approx(-(d1 + length + d2), rel=ROUNDING)


def test_rigid_arms_beside_the_member():
    """Axial force at a node e beside the axis: stretching plus bending by N e, u = N (L / EA + e^2 L / EI)."""
    length, e = 0.7, 0.05
    for arm, inertia in (([0, e, 0], "Iz"), ([0, 0, e], "Iy")):
        K = placement.with_offsets(element_stiffness("timoshenko", length, SECTION), [[0, 0, 0]], [arm])[0]
        exact = length / (SECTION["E"] * SECTION["A"]) + e**2 * length / (SECTION["E"] * SECTION[inertia])
        assert np.linalg.inv(K[6:, 6:])[0, 0] == pytest.approx(exact, rel=ROUNDING)


def test_rigid_arms_against_stiff_members():
    """A member in space with both arms oblique, against the same arms as members 1e4 times stiffer each way."""
    start, end = np.array([0.1, 0.05, -0.1]), np.array([0.8, 0.3, 0.2])
    nodes = np.array([[0, 0, 0], start, end, [0.9, 0.2, 0.4]])
    stiff = SECTION | {name: SECTION[name] * 1e4 for name in ("A", "Iy", "Iz", "J")}
    K = np.zeros((24, 24))
    for (i, j), s in (((0, 1), stiff), ((1, 2), SECTION), ((2, 3), stiff)):
        length = np.linalg.norm(nodes[j] - nodes[i])
        block = placement.to_global(
            element_stiffness("euler", length, s), placement.directions(nodes[[i]], nodes[[j]])
        )[0]
        dofs = np.r_[6 * i : 6 * i + 6, 6 * j : 6 * j + 6]
        K[np.ix_(dofs, dofs)] += block
    explicit = np.linalg.inv(K[6:, 6:])[12:, 12:]
    R = placement.directions(start, end)
    member = placement.to_global(element_stiffness("euler", np.linalg.norm(end - start), SECTION), R)
    offset = placement.with_offsets(member, start - nodes[0], end - nodes[3])[0]
    got = np.linalg.inv(offset[6:, 6:])
    np.testing.assert_allclose(got, explicit, rtol=0, atol=5e-4 * np.abs(explicit).max())  # stiff, not rigid


def test_mass_beyond_a_rigid_arm_has_its_moment_of_inertia():
    M = placement.with_offsets(element_mass("euler", 0.7, 7800.0, SECTION), [[0, 0, 0.3]], [[0, 0, 0.3]])[0]
    mass = 7800.0 * SECTION["A"] * 0.7
    about_x = np.zeros(12)
    about_x[[3, 9]] = 1  # both nodes turn about the x axis, 0.3 m under the member
    exact = mass * 0.3**2 + 7800.0 * (SECTION["Iy"] + SECTION["Iz"]) * 0.7
    assert about_x @ M @ about_x == pytest.approx(exact, rel=ROUNDING)


@pytest.mark.parametrize("kind", frame.KINDS)
def test_section_forces_of_a_cantilever_are_those_of_statics(kind):
    """Six loads on the tip at once: N, V, T are theirs all along, moments grow with the lever arm."""
    load = np.array([3.0, -2.0, 5.0, 0.7, 1.1, -0.4])
    K = element_stiffness(kind, 0.7, SECTION)[0]
    u = np.zeros(len(K))
    u[6:] = np.linalg.solve(K[6:, 6:], np.pad(load, (0, len(K) - 12)))
    x = np.array([0.0, 0.2, 0.7])
    constants = (SECTION[key] for key in ("E", "G", "A", "Iy", "Iz", "J", "ky", "kz"))
    got = frame.resultants(kind, 0.7, x / 0.7, *constants) @ u
    arm = 0.7 - x
    exact = np.tile(load, (3, 1))
    exact[:, 4] -= arm * load[2]
    exact[:, 5] += arm * load[1]
    np.testing.assert_allclose(got, exact, rtol=0, atol=1e-11)  # rounding of N of EA / L = 9e7 N/m: 2e-13 here


def test_directions():
    start = np.zeros((4, 3))
    end = np.array([[2.0, 0, 0], [0, 0, 3.0], [1.0, 1.0, 0], [1.0, 2.0, 2.0]])
    R = placement.directions(start, end)
    np.testing.assert_allclose(R @ R.transpose(0, 2, 1), np.tile(np.eye(3), (4, 1, 1)), atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(R), 1, rtol=1e-14)
    np.testing.assert_allclose(R[:, 0], end / np.linalg.norm(end, axis=1)[:, None], rtol=1e-15)
    np.testing.assert_allclose(R[[0, 2], 2], [[0, 0, 1], [0, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(R[1, 2], [1, 0, 0], atol=1e-15)  # vertical: z looks along global x
    # as near to global z as a right angle to the member allows
    assert R[3, 2, 2] == pytest.approx(np.sqrt(1 - (2 / 3) ** 2), rel=1e-14)
    np.testing.assert_allclose(placement.directions([[0, 0, 0]], [[1, 0, 0]], [5, 3, 0])[0, 2], [0, 1, 0], atol=1e-15)


def test_what_frames_refuse():
    with pytest.raises(InputError, match="parallel to the member"):
        placement.directions([[0, 0, 0]], [[0, 0, 1]], [0, 0, -2])
    with pytest.raises(InputError, match="two ends in one place"):
        placement.directions([[1, 0, 0]], [[1, 0, 0]])
    with pytest.raises(InputError, match="zero vector"):
        placement.directions([[0, 0, 0]], [[0, 0, 1]], [0, 0, 0])
    with pytest.raises(InputError, match="euler or timoshenko"):
        element_stiffness("bernoulli", 1.0, SECTION)
    with pytest.raises(InputError, match=r"length: got 0\.0"):
        element_stiffness("euler", 0.0, SECTION)
    with pytest.raises(InputError, match=r"rho: got -1\.0"):
        element_mass("euler", 1.0, -1.0, SECTION)
