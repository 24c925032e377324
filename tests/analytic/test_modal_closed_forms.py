"""Closed-form bases against printed roots, energy identities and fine finite-element beams."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh

from femstruct.errors import InputError
from femstruct.modal.closed_form import beam, given_modes, oscillator, rod, roots
from femstruct.modal.damping import Damping, LossFactor, with_damping
from femstruct.modal.frf import frf

L, EI, MASS = 1.3, 7.0, 0.4
HELD = {"pinned": [0], "free": [], "clamped": [0, 1]}
ENDS = [
    ("pinned", "pinned"),
    ("free", "free"),
    ("clamped", "clamped"),
    ("clamped", "free"),
    ("free", "pinned"),
    ("pinned", "clamped"),
]


def element_beam(ends, n=60):
    """omega, deflections and slopes of a beam of n cubic elements, mass-normalised."""
    h = L / n
    k = EI / h**3 * np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], dtype=float)
    m = MASS * h / 420 * np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4.0]])
    scale = np.diag([1.0, h, 1.0, h])
    K, M = np.zeros((2 * n + 2, 2 * n + 2)), np.zeros((2 * n + 2, 2 * n + 2))
    for i in range(n):
        at = slice(2 * i, 2 * i + 4)
        K[at, at] += scale @ k @ scale
        M[at, at] += scale @ m @ scale
    held = HELD[ends[0]] + [2 * n + d for d in HELD[ends[1]]]
    free = np.setdiff1d(np.arange(2 * n + 2), held)
    values, vectors = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)])
    shapes = np.zeros((2 * n + 2, len(free)))
    shapes[free] = vectors
    return np.sqrt(values.clip(0)), shapes[0::2], shapes[1::2]


@pytest.mark.parametrize("ends", ENDS, ids="-".join)
def test_beam_agrees_with_fine_elements(ends):
    modes, n = 8, 60
    basis, points = beam(L, EI, MASS, ends, modes, {f"p{i}": i * L / n for i in range(n + 1)})
    omega, deflection, slope = element_beam(ends)
    # discretisation: cubic elements err by (k h)^4 / 1440, 2.8e-5 in mode 8; rigid modes carry rounding of K
    np.testing.assert_allclose(basis.omega, omega[:modes], rtol=4e-5, atol=1e-3 * omega[modes])
    elastic = basis.omega > 0
    np.testing.assert_allclose(basis.omega[elastic], omega[:modes][elastic], rtol=4e-5)
    w = np.stack([points[f"p{i}"].probe("z").of(basis.shapes) for i in range(n + 1)])
    ry = np.stack([points[f"p{i}"].probe("ry").of(basis.shapes) for i in range(n + 1)])
    turn = np.sign((w * deflection[:, :modes]).sum(axis=0))
    tolerance = 1e-4 * np.abs(w).max()  # shapes err as the square root of that of omega
    np.testing.assert_allclose(w[:, elastic], (turn * deflection[:, :modes])[:, elastic], atol=tolerance)
    expected = (-turn * slope[:, :modes])[:, elastic]
    np.testing.assert_allclose(ry[:, elastic], expected, atol=1e-4 * np.abs(ry).max())  # as the shapes: 5e-5 here


@pytest.mark.parametrize("ends", ENDS, ids="-".join)
def test_beam_shapes_are_orthonormal_and_do_not_overflow(ends):
    basis, _ = beam(L, EI, MASS, ends, 60)
    x, w = basis.points[:, 0], basis.shapes[:, 2]
    assert np.isfinite(w).all()
    # the stations are Simpson points, 8 a half wave: good to 1e-3 of the mean square
    weights = np.ones(len(x))
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    gram = MASS * L / (3 * (len(x) - 1)) * w.T @ (weights[:, None] * w)
    np.testing.assert_allclose(gram, np.eye(60), atol=2e-2)  # Simpson's rule in the highest modes
    np.testing.assert_allclose(gram[:20, :20], np.eye(20), atol=1e-4)  # 6e-7 here
    # effective masses cannot exceed the mass, and with 60 modes most of it is there
    assert 0.95 * MASS * L < basis.modal_mass[2].sum() <= MASS * L * (1 + 1e-9)


def test_roots_satisfy_the_frequency_equations():
    # the unbounded forms of the textbooks, while they do not overflow
    z = roots(("clamped", "free"), 5)
    np.testing.assert_allclose(np.cos(z) * np.cosh(z), -1.0, rtol=1e-8)  # the error of the root times cosh z = 7e5
    z = roots(("free", "free"), 5)
    np.testing.assert_allclose(np.cos(z) * np.cosh(z), 1.0, rtol=1e-7)  # as above, of cosh z = 1e7: 3e-8 here
    z = roots(("pinned", "clamped"), 5)
    np.testing.assert_allclose(np.tan(z), np.tanh(z), rtol=1e-12)  # rounding: 3e-15 here


def test_the_pinned_free_beam_of_chapter_5():
    # reference values: computed independently for the source's beam, 400 mm, EI 5.9 N m^2, 120 g
    basis, _ = beam(0.4, 5.9, 0.3, ("pinned", "free"), 6)
    assert basis.kind == ("rigid", *("elastic",) * 5)
    # five digits: 7e-6 here
    np.testing.assert_allclose(basis.frequency_hz[1:], [68.014, 220.41, 459.87, 786.40, 1200.01], rtol=2e-5)
    assert basis.complete_below_hz > 1200.01


def test_ground_force_of_a_cantilever_in_a_static_pull():
    basis, points = beam(L, EI, MASS, ("clamped", "free"), 200, {"tip": L})
    ground = frf(basis, points["tip"].probe("z"), basis.outputs["ground.z"], 0.0, "transmissibility")
    # the modal sum of a reaction converges as 1 / modes
    assert ground[0].real == pytest.approx(1.0, abs=5e-3)
    bend = frf(basis, points["tip"].probe("z"), points["tip"].probe("z"), 0.0)[0].real
    assert bend == pytest.approx(L**3 / (3 * EI), rel=1e-6)  # the sum converges as modes^-3


def test_rod_frequencies_and_normalisation():
    length, E, rho, area = 2.0, 206e9, 7850.0, 3.14e-4
    basis, points = rod(length, E, rho, area, 50, {"left": 0.0, "quarter": 0.5})
    c = np.sqrt(E / rho)
    np.testing.assert_allclose(basis.frequency_hz, np.arange(50) * c / (2 * length), rtol=1e-14)  # rounding: 2e-16 here
    # modal masses rho A L and rho A L / 2
    at_end = points["left"].probe("x").of(basis.shapes)
    np.testing.assert_allclose(at_end[0], 1 / np.sqrt(rho * area * length))
    np.testing.assert_allclose(at_end[1:], np.sqrt(2 / (rho * area * length)))
    assert basis.n_rigid == 1
    assert basis.modal_mass[0].sum() == pytest.approx(basis.total_mass)
    # drive-point receptance of a free rod: -cot(k L) / (E A k)
    rich, places = rod(length, E, rho, area, 1000, {"left": 0.0})
    f = np.array([200.0, 900.0])
    k = 2 * np.pi * f / c
    exact = -1 / (np.tan(k * length) * E * area * k)
    got = frf(rich, places["left"].probe("x"), places["left"].probe("x"), f)
    np.testing.assert_allclose(got.real, exact, rtol=4e-3)  # the sum converges as 1 / modes


def test_oscillator_resonates_at_its_quality_factor():
    basis, points = oscillator(3.0, frequency_hz=7.0)
    damped = with_damping(basis, Damping(LossFactor(0.05)))
    m = points["m"].probe("x")
    k = 3.0 * (2 * np.pi * 7.0) ** 2
    assert abs(frf(damped, m, m, 7.0)[0]) == pytest.approx(1 / (0.05 * k))
    assert abs(frf(damped, m, damped.outputs["ground.x"], 7.0, "transmissibility")[0]) == pytest.approx(
        abs(1 + 0.05j) / 0.05
    )
    free, _ = oscillator(3.0, stiffness=0.0)
    assert free.kind == ("rigid",)
    assert not free.outputs


def test_given_modes_are_taken_as_they_are():
    basis, points = given_modes([6.0, 280.0], [0.01, 0.02], {"bed": [0.14, 0.392], "frame": [0.14, -0.07]})
    np.testing.assert_allclose(points["frame"].probe("z").of(basis.shapes), [0.14, -0.07])
    np.testing.assert_allclose(basis.damping_ratio, [0.01, 0.02])


@pytest.mark.parametrize(
    "make",
    [
        lambda: beam(1.0, 1.0, 1.0, ("pinned", "hinged"), 3),
        lambda: beam(1.0, 1.0, 1.0, ("free", "free"), 3, {"p": 1.1}),
        lambda: rod(1.0, -1.0, 1.0, 1.0, 3),
        lambda: oscillator(1.0),
        lambda: oscillator(1.0, frequency_hz=1.0, stiffness=2.0),
        lambda: given_modes([2.0, 1.0], [0, 0], {}),
        lambda: given_modes([1.0, 2.0], [0, 0], {"p": [1.0]}),
    ],
)
def test_nonsense_is_refused(make):
    with pytest.raises(InputError):
        make()
