"""Plate elements against coefficients from independent exact symbolic integration, and separate prototypes."""

import json
from pathlib import Path

import numpy as np
import pytest

from femstruct.elements import plate

REFERENCE = json.loads((Path(__file__).parents[1] / "data" / "elements.json").read_text(encoding="utf-8"))
CELLS = [(0.05, 0.05, 0.3), (0.02, 0.031, 0.35), (3.0, 0.4, 0.0), (0.7, 2.9, 0.2), (1.0, 1.0, 0.49)]


def value(expression, **names):
    return eval(expression, {"__builtins__": {}}, names)


@pytest.mark.parametrize(("a", "b", "nu"), CELLS)
def test_all_78_stiffness_coefficients_of_hermite12(a, b, nu):
    E, t = 5.9e9, 0.005
    K = plate.stiffness("hermite12", [a], [b], plate.rigidity(E, nu, t))[0]
    entries = REFERENCE["plate12_symbolic"]["Khat_lower {i,j:[coef, unit]}"]
    assert len(entries) == 78
    prefactor = E * t**3 / (12 * (1 - nu**2) * a * b)
    for place, (coefficient, unit) in entries.items():
        i, j = (int(number) - 1 for number in place.split(","))
        exact = prefactor * value(coefficient, beta=b / a, nu=nu) * value(unit, a=a, b=b)
        # A coefficient is a sum of up to five terms; where they cancel, rounding is that of the diagonal (1e-15).
        rounding = 1e-15 * np.sqrt(K[i, i] * K[j, j])
        assert K[i, j] == pytest.approx(exact, rel=1e-12, abs=rounding), place  # rounding: 6e-15 here


@pytest.mark.parametrize(("a", "b", "nu"), CELLS)
def test_all_78_mass_coefficients_of_hermite12(a, b, nu):
    M = plate.mass("hermite12", [a], [b], 1190 * 0.005)[0]
    rows = REFERENCE["plate12_symbolic"]["Mhat"]
    exact = 1190 * 0.005 * a * b / 176400 * np.array([[value(entry, a=a, b=b) for entry in row] for row in rows])
    np.testing.assert_allclose(M, exact, rtol=1e-13)  # single products: a few roundings


def test_twist_energy_of_hermite12_is_that_of_the_formula_and_of_the_prototype():
    for name, ratio in REFERENCE["twist_defect"]["twist_energy_ratio"].items():
        nu, beta = (float(part.lstrip("nuba")) for part in name.split("_"))
        a, b = 0.1, 0.1 * beta
        # w = x y: w, RX = x, RY = -y at (0,0) (0,b) (a,b) (a,0); exact energy 2 D (1 - nu) a b / 2.
        x, y = np.array([0, 0, a, a]), np.array([0, b, b, 0])
        u = np.stack([x * y, x, -y], axis=1).ravel()
        D = plate.rigidity(1.0, nu, 1.0)
        energy = u @ plate.stiffness("hermite12", [a], [b], D)[0] @ u / 2
        exact = D[0, 0] * (1 - nu) * a * b
        assert energy / exact == pytest.approx(ratio, rel=1e-12)  # rounding: 1e-14 here
        assert 1 + plate.twist_excess(beta, nu) == pytest.approx(ratio, rel=1e-12)  # rounding: 2e-14 here


def test_centre_deflections_equal_those_of_separate_prototypes(plate_grid):
    cases = REFERENCE["statics"]["FE_centre_coef[H12,ACM,BFS]"]
    for edges in ("SSSS", "CCCC"):
        for load in ("q", "P"):
            for aspect, (nx, ny) in ((1, (8, 8)), (2, (16, 8)), (5, (32, 8))):
                expected = cases[f"stat_{edges}_{load}_asp{aspect}_{nx}x{ny}"]
                for kind, number in zip(("hermite12", "acm12", "bfs16"), expected, strict=True):
                    grid = plate_grid(kind, nx, ny, float(aspect), 1.0)
                    middle = grid.dof((ny // 2) * (nx + 1) + nx // 2, 0)
                    force = np.zeros(grid.K.shape[0])
                    if load == "P":
                        force[middle] = 1.0
                    else:
                        force[:: grid.per_node] = 1.0  # the mass matrix times a unit translation is a unit pressure
                        force = grid.M @ force
                    deflection = grid.static(grid.held(edges), force)[middle]
                    # in q ly^4 / D and P ly^2 / D; two codes of the same element differ by rounding of the solve
                    assert deflection == pytest.approx(number, rel=1e-9), (edges, load, aspect, kind)
