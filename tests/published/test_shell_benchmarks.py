"""Beams and shells of MacNeal and Harder, the obstacle course and plates of NAFEMS, with flat shell elements.

Values in the table are those of a separate prototype of the same elements, to the digits it printed; references with
their sources stand in `tests/data/shells.json`.
"""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest

DATA = Path(__file__).parents[1] / "data"
REFERENCE = json.loads((DATA / "shells.json").read_text(encoding="utf-8"))
CASES = {case["name"]: case for case in (*REFERENCE["statics"], *REFERENCE["nafems"])}
HAND = runpy.run_path(str(DATA / "shells_by_hand.py"))
Shell, all_of, grid, halves, isotropic = (HAND[name] for name in ("Shell", "all_of", "grid", "halves", "isotropic"))
UX, UY, UZ, RX, RY, RZ = range(6)


def meshed(kind, nx, ny, places, by_turns=False):
    """Nodes by a function of places in the unit square, and cells, the diagonals of triangles by turns or not."""
    square, quads = grid(nx, ny)
    turned = by_turns & (np.array(np.divmod(quads[:, 0], ny + 1)).sum(axis=0) % 2 == 1)
    return places(*square.T), quads if kind == "quads" else halves(quads, turned), square


def symmetric(nodes, normal):
    """DOFs held on a plane of symmetry with its normal along an axis."""
    return all_of(nodes, normal, *(RX + k for k in range(3) if k != normal))


def load(shell, forces):
    result = np.zeros((len(shell.nodes), 6))
    for nodes, component, each in forces:
        result[nodes, component] += each
    return result


def ends(square, axis=0):
    return np.flatnonzero(square[:, axis] == 0), np.flatnonzero(square[:, axis] == 1)


def shares(count):
    """Of a force spread evenly along an edge, at its nodes."""
    each = np.full(count, 1.0 / (count - 1))
    each[[0, -1]] /= 2
    return each


def tip(shell, square, component):
    """Mean motion of the end x = 1 of the square under a unit force spread along it, the end x = 0 clamped."""
    root, end = ends(square)
    force = load(shell, [(end, component, shares(len(end)))])
    return (shell.moved(all_of(root), force)[end, component] * shares(len(end))).sum()


def straight_beam(kind, shape):
    case = CASES["straight_beam"]

    def places(x, y):
        inner, top = (x > 0) & (x < 1), np.where(y == 1, 1.0, -1.0)
        side = {"rectangles": 0.0, "trapezoids": -top * np.where(np.rint(6 * x) % 2, 1, -1), "parallelograms": top}
        return np.stack([case["L"] * x + 0.1 * inner * side[shape], case["h"] * y, 0 * x], axis=1)

    nodes, cells, square = meshed(kind, 6, 1, places)
    shell = Shell(nodes, cells, isotropic(case["E"], case["nu"], case["t"]))
    return tip(shell, square, UZ) / case["reference"]["out_of_plane_shear"]


def curved_beam(kind, n):
    case = CASES["curved_beam"]

    def places(x, y):
        radius = case["r_in"] + y * (case["r_out"] - case["r_in"])
        return np.stack([radius * np.cos(x * np.pi / 2), radius * np.sin(x * np.pi / 2), 0 * x], axis=1)

    nodes, cells, square = meshed(kind, n, 1, places)
    shell = Shell(nodes, cells, isotropic(case["E"], case["nu"], case["t"]))
    return tip(shell, square, UZ) / case["reference"]["out_of_plane"]


def twisted_beam(kind, nx, ny, t):
    """Tip displacements along the tip's width and across it."""
    case = CASES["twisted_beam"]
    reference = case["reference"]["t=.32" if t == 0.32 else "t=.0032, per unit load"]

    def places(x, y):
        s, angle = case["w"] * (y - 0.5), x * np.pi / 2
        return np.stack([case["L"] * x, s * np.cos(angle), s * np.sin(angle)], axis=1)

    nodes, cells, square = meshed(kind, nx, ny, places)
    shell = Shell(nodes, cells, isotropic(case["E"], case["nu"], t))
    return tip(shell, square, UZ) / reference["in_plane"], tip(shell, square, UY) / reference["out_of_plane"]


def scordelis_lo(kind, n, drilling=1.0):
    """A quarter of the roof: diaphragm at x = 0, symmetry at x = L / 2 and at the crown."""
    case = CASES["scordelis_lo"]
    half = np.radians(case["half_angle_deg"])

    def places(x, y):
        return np.stack([x * case["L"] / 2, case["R"] * np.sin(half * y), case["R"] * np.cos(half * y)], axis=1)

    nodes, cells, square = meshed(kind, n, n, places, by_turns=True)
    shell = Shell(nodes, cells, isotropic(case["E"], case["nu"], case["t"]), drilling=drilling)
    diaphragm, middle = ends(square)
    crown, _ = ends(square, 1)
    held = np.concatenate([all_of(diaphragm, UY, UZ), symmetric(middle, UX), symmetric(crown, UY)])
    weight = load(shell, [(slice(None), UZ, -90.0 * shell.tributary)])
    edge = np.flatnonzero((square == 1).all(axis=1))
    return -shell.moved(held, weight)[edge[0], UZ] / case["reference"]


def pinched_cylinder(kind, n, drilling=1.0):
    """An eighth: diaphragm at x = 0, symmetry at x = L / 2 and at both ends of the quarter of the circle."""
    case = CASES["pinched_cylinder"]

    def places(x, y):
        angle = y * np.pi / 2
        return np.stack([x * case["L"] / 2, case["R"] * np.sin(angle), case["R"] * np.cos(angle)], axis=1)

    nodes, cells, square = meshed(kind, n, n, places)
    shell = Shell(nodes, cells, isotropic(case["E"], case["nu"], case["t"]), drilling=drilling)
    diaphragm, middle = ends(square)
    top, side = ends(square, 1)
    held = [all_of(diaphragm, UY, UZ), symmetric(middle, UX), symmetric(top, UY), symmetric(side, UZ)]
    under = np.intersect1d(middle, top)
    moved = shell.moved(np.unique(np.concatenate(held)), load(shell, [(under, UZ, -0.25)]))
    return -moved[under[0], UZ] / case["reference"]


def hemisphere(kind, n, drilling=1.0):
    """A quarter with a hole of 18 degrees at the pole, pulled along x and pushed along y at the equator."""
    case = CASES["hemisphere"]
    top = np.radians(90 - case["hole_deg"])

    def places(x, y):
        angle, height = x * np.pi / 2, y * top
        return case["R"] * np.stack(
            [np.cos(height) * np.cos(angle), np.cos(height) * np.sin(angle), np.sin(height)], axis=1
        )

    nodes, cells, square = meshed(kind, n, n, places)
    shell = Shell(nodes, cells, isotropic(case["E"], case["nu"], case["t"]), drilling=drilling)
    along_x, along_y = ends(square)
    equator, _ = ends(square, 1)
    pulled, pushed = np.intersect1d(along_x, equator), np.intersect1d(along_y, equator)
    held = np.concatenate([symmetric(along_x, UY), symmetric(along_y, UX), all_of(pulled, UZ)])
    moved = shell.moved(np.unique(held), load(shell, [(pulled, UX, 1.0), (pushed, UY, -1.0)]))
    return moved[pulled[0], UX] / 0.0930  # the middle of the values quoted: 0.0924, 0.0930 and 0.094


def raasch(kind, n, width, drilling=1.0):
    case = CASES["raasch_hook"]
    first, second = np.radians(case["arc1_deg"]), np.radians(case["arc2_deg"])

    def places(x, y):
        along = x * (case["R1"] * first + case["R2"] * second)
        near = np.minimum(along / case["R1"], first)
        far = np.maximum((along - case["R1"] * first) / case["R2"], 0.0)
        # clamped at the small arc; the centre of the large one lies beyond their common tangent
        across = case["R1"] * np.sin(near) + case["R2"] * (np.sin(first) - np.sin(first - far))
        up = case["R1"] * (1 - np.cos(near)) + case["R2"] * (np.cos(first - far) - np.cos(first))
        return np.stack([across, up, case["width"] * y], axis=1)

    nodes, cells, square = meshed(kind, n, width, places)
    shell = Shell(nodes, cells, isotropic(case["E"], case["nu"], case["t"]), drilling=drilling)
    return tip(shell, square, UZ)


DIGITS = 2.1e-3  # three digits printed, and loads that were shared among nodes a little differently

TABLE = {
    "quads": {
        "straight": [0.980, 0.963, 0.978],
        "curved": [0.942, 0.960],
        "twisted": [(0.997, 1.001), (0.998, 0.999)],
        "twisted, thin": [(0.992, 1.001), (0.997, 0.999)],
        "scordelis": [1.048, 1.006, 0.998],
        "cylinder": [0.744, 0.930, 0.989],
        "hemisphere": [0.381, 0.957, 1.001],
        "raasch": [4.772, 4.854, 4.946],
    },
    "triangles": {
        "straight": [0.977, 0.978, 0.973],
        "curved": [0.879, 0.907],
        "twisted": [(0.995, 1.002), (0.997, 0.999)],
        "twisted, thin": [(0.046, 0.048), (0.389, 0.387)],
        "scordelis": [1.038, 1.003, 0.996],
        "cylinder": [0.944, 1.023, 1.019],
        "hemisphere": [0.086, 0.508, 0.939],
        "raasch": [4.654, 4.756, 4.876],
    },
}
each_kind = pytest.mark.parametrize("kind", TABLE)


@each_kind
def test_beams_of_macneal_and_harder_out_of_plane(kind):
    shapes = ("rectangles", "trapezoids", "parallelograms")
    got = [straight_beam(kind, shape) for shape in shapes]
    np.testing.assert_allclose(got, TABLE[kind]["straight"], atol=DIGITS)
    np.testing.assert_allclose([curved_beam(kind, n) for n in (6, 24)], TABLE[kind]["curved"], atol=DIGITS)


@each_kind
def test_twisted_beam(kind):
    """A beam of warped elements, thick and thin; without arms to the corners it keeps a quarter of its deflection."""
    for name, t in (("twisted", 0.32), ("twisted, thin", 0.0032)):
        got = [twisted_beam(kind, nx, ny, t) for nx, ny in ((12, 2), (24, 4))]
        np.testing.assert_allclose(got, TABLE[kind][name], atol=DIGITS)


@each_kind
def test_obstacle_course(kind):
    np.testing.assert_allclose([scordelis_lo(kind, n) for n in (4, 8, 16)], TABLE[kind]["scordelis"], atol=DIGITS)
    np.testing.assert_allclose([pinched_cylinder(kind, n) for n in (8, 16)], TABLE[kind]["cylinder"][:2], atol=DIGITS)
    np.testing.assert_allclose([hemisphere(kind, n) for n in (4, 8, 16)], TABLE[kind]["hemisphere"], atol=DIGITS)


@each_kind
def test_raaschs_hook(kind):
    got = [raasch(kind, n, width) for n, width in ((18, 3), (36, 5), (72, 10))]
    np.testing.assert_allclose(got, TABLE[kind]["raasch"], rtol=3e-3)  # a tip of four nodes: its mean is taken so or so
    # the reference has 2 %, and the meshes still rise by 1 % a halving
    assert got[-1] == pytest.approx(CASES["raasch_hook"]["reference"], rel=0.03)


@pytest.mark.stress
@each_kind
def test_pinched_cylinder_on_a_fine_mesh(kind):
    assert pinched_cylinder(kind, 32) == pytest.approx(TABLE[kind]["cylinder"][2], abs=DIGITS)


@pytest.mark.parametrize("factor", [0.1, 10.0])
def test_the_tie_of_the_rotation_about_the_normal_matters_little(factor):
    """Less than 1e-3 in curved shells on usual meshes; 0.4 % in Raasch's hook, which bends in its plane."""
    assert scordelis_lo("quads", 16, factor) == pytest.approx(scordelis_lo("quads", 16), rel=1e-3)
    assert hemisphere("quads", 16, factor) == pytest.approx(hemisphere("quads", 16), rel=1e-3)
    assert pinched_cylinder("quads", 16, factor) == pytest.approx(pinched_cylinder("quads", 16), rel=1e-3)
    assert raasch("quads", 36, 5, factor) == pytest.approx(raasch("quads", 36, 5), rel=0.005)  # 0.4 % here
