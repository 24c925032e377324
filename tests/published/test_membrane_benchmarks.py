"""Cook's membrane and the beams of MacNeal and Harder in their plane, with the membrane of quadrilaterals.

The ratios asked for are those of a separate prototype of the same element, to the digits it printed.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from femstruct.elements import membrane

REFERENCE = json.loads((Path(__file__).parents[1] / "data" / "shells.json").read_text(encoding="utf-8"))
CASES = {case["name"]: case for case in REFERENCE["statics"]}


def isotropic(E, nu, t):
    return E * t / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])


def grid(nx, ny):
    """Places in the unit square and cells of nx x ny; the nodes run along y first."""
    nodes = np.array([(i / nx, j / ny) for i in range(nx + 1) for j in range(ny + 1)])
    first = np.array([i * (ny + 1) + j for i in range(nx) for j in range(ny)])
    return nodes, np.stack([first, first + ny + 1, first + ny + 2, first + 1], axis=1)


def deflection(nodes, cells, A, held, forces, drilling=1.0):
    """Displacements [nodes, 3] under forces {node: (Fx, Fy)}, with all of `held` fixed."""
    dofs = (cells[:, :, None] * 3 + np.arange(3)).reshape(len(cells), 12)
    K = membrane.stiffness(nodes[cells], A, drilling)
    place = np.repeat(dofs, 12, axis=1).ravel(), np.tile(dofs, (1, 12)).ravel()
    free = np.setdiff1d(np.arange(3 * len(nodes)), (np.asarray(held)[:, None] * 3 + np.arange(3)).ravel())
    load = np.zeros((len(nodes), 3))
    for node, force in forces.items():
        load[node, :2] += force
    moved = np.zeros(load.size)
    moved[free] = spsolve(coo_array((K.ravel(), place)).tocsc()[free][:, free], load.ravel()[free])
    return moved.reshape(-1, 3)


def cook(n, drilling=1.0):
    nodes, cells = grid(n, n)
    x, y = 48 * nodes[:, 0], 44 * nodes[:, 0] + nodes[:, 1] * (44 - 28 * nodes[:, 0])
    right = np.flatnonzero(nodes[:, 0] == 1)
    share = np.full(len(right), 1 / n)
    share[[0, -1]] /= 2
    forces = {node: (0.0, each) for node, each in zip(right, share, strict=True)}
    moved = deflection(
        np.stack([x, y], axis=1), cells, isotropic(1, 1 / 3, 1), np.flatnonzero(x == 0), forces, drilling
    )
    return moved[right[n // 2], 1]


@pytest.mark.parametrize(("n", "expected"), [(4, 23.3), (16, 23.86)])
def test_cooks_membrane(n, expected):
    assert cook(n) == pytest.approx(expected, rel=2e-3)  # the digits printed: 23.3 for n = 4


def test_cooks_membrane_converges():
    assert cook(32) == pytest.approx(CASES["cook"]["reference"], rel=3e-3)  # h^2: 1.2e-3 here, and the reference's 5e-4


@pytest.mark.parametrize(("n", "most"), [(4, 5e-3), (16, 1.5e-3), (32, 1e-3)])
def test_the_tie_of_the_rotation_matters_little(n, most):
    for factor in (0.1, 10.0):
        assert abs(cook(n, factor) / cook(n) - 1) < most


@pytest.mark.parametrize(("shape", "expected"), [("rectangles", 0.99), ("trapezoids", 0.90), ("parallelograms", 0.97)])
def test_straight_beam(shape, expected):
    case = CASES["straight_beam"]
    nodes, cells = grid(6, 1)
    places = nodes * [case["L"], case["h"]]
    inner = (nodes[:, 0] > 0) & (nodes[:, 0] < 1)
    top, column = nodes[:, 1] == 1, np.rint(6 * nodes[:, 0]).astype(int)
    if shape == "trapezoids":
        places[:, 0] += inner * np.where(top, -0.1, 0.1) * np.where(column % 2, 1, -1)
    if shape == "parallelograms":
        places[:, 0] += inner * top * 0.1
        places[:, 0] -= inner * ~top * 0.1
    left, right = np.flatnonzero(nodes[:, 0] == 0), np.flatnonzero(nodes[:, 0] == 1)
    A = isotropic(case["E"], case["nu"], case["t"])
    shear = deflection(places, cells, A, left, dict.fromkeys(right, (0.0, 0.5)))
    # two digits
    assert shear[right, 1].mean() / case["reference"]["in_plane_shear"] == pytest.approx(expected, abs=0.006)
    pull = deflection(places, cells, A, left, dict.fromkeys(right, (0.5, 0.0)))
    # the clamped end holds the lateral contraction
    assert pull[right, 0].mean() == pytest.approx(case["reference"]["extension"], rel=0.02)


@pytest.mark.parametrize(("n", "expected"), [(6, 1.00), (12, 1.01), (24, 1.00)])
def test_curved_beam_under_a_radial_force(n, expected):
    case = CASES["curved_beam"]
    nodes, cells = grid(n, 1)
    radius = case["r_in"] + nodes[:, 1] * (case["r_out"] - case["r_in"])
    angle = nodes[:, 0] * np.pi / 2
    places = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    tip = np.flatnonzero(nodes[:, 0] == 1)
    A = isotropic(case["E"], case["nu"], case["t"])
    moved = deflection(places, cells, A, np.flatnonzero(nodes[:, 0] == 0), dict.fromkeys(tip, (0.0, 0.5)))
    assert moved[tip, 1].mean() / case["reference"]["in_plane"] == pytest.approx(expected, abs=0.008)  # two digits
