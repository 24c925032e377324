"""Contracts of the eigen service: nothing missed, nothing added, nothing that changes from run to run."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.sparse import block_array, csc_array, diags_array

from femstruct.assembly.matrices import assemble
from femstruct.errors import FemstructError, InputError, SingularSystem
from femstruct.modal import eigen
from femstruct.modal import eigen as solve
from femstruct.modal.eigen import _dense, count_below, fix_signs, modes
from femstruct.modal.reduction import modal_basis
from femstruct.modal.residuals import residual_vectors
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.sections import rectangle
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.frame import Frame

TWO_PI = 2.0 * np.pi


def chain(n, stiffness=1.0, mass=1.0, free=False):
    """n masses in a row on springs, held at the left end unless free; omega is known in closed form."""
    main = np.full(n, 2.0)
    main[-1] = 1.0
    main[0] = 1.0 if free else 2.0
    K = stiffness * diags_array([-np.ones(n - 1), main, -np.ones(n - 1)], offsets=[-1, 0, 1])
    return csc_array(K), csc_array(mass * diags_array(np.ones(n)))


@pytest.mark.parametrize("n", [5, 40, 900])  # full matrices below 300, Lanczos above
def test_a_chain_has_its_closed_form_frequencies(n):
    K, M = chain(n, free=True)
    found = modes(K, M, count=min(n, 12))
    exact = 4.0 * np.sin(np.arange(len(found.eigenvalues)) * np.pi / (2 * n)) ** 2
    # rounding of K against the lowest omega^2: eps * 4 / omega_1^2 = 1e-16 * 4 / 1e-5
    np.testing.assert_allclose(found.eigenvalues, exact, rtol=1e-10, atol=0)
    assert found.n_rigid == 1


@pytest.mark.parametrize(("nx", "ny", "lx", "ly"), [(24, 24, 1.0, 1.0), (6, 6, 1.0, 1.0), (30, 12, 2.0, 1.0)])
def test_a_free_plate_has_three_rigid_modes_and_every_elastic_one(plate_grid, nx, ny, lx, ly):
    grid = plate_grid("bfs16", nx, ny, lx, ly)
    found = modes(grid.K, grid.M, count=30)
    assert found.n_rigid == 3
    assert (found.eigenvalues[:3] == 0).all()
    assert found.eigenvalues[3] > 0
    for place in (5, 12, 29):  # the count between neighbours that are apart: an independent factor for each
        gaps = np.diff(found.eigenvalues[:30])
        at = place - 1 - int(np.argmax(gaps[place - 1 : place - 4 : -1]))
        level = 0.5 * (found.eigenvalues[at] + found.eigenvalues[at + 1])
        assert count_below(grid.K, grid.M, level) == at + 1
    # Cholesky of the Gram matrix leaves rounding times the number of degrees of freedom
    np.testing.assert_allclose(found.shapes.T @ (grid.M @ found.shapes), np.eye(30), atol=1e-10)


def test_degenerate_pairs_of_a_square_plate_are_all_found(plate_grid):
    grid = plate_grid("bfs16", 20, 20)
    free = grid.free(grid.held("SSSS"))
    K, M = csc_array(grid.K[free][:, free]), csc_array(grid.M[free][:, free])
    found = modes(K, M, count=40)
    m, n = np.meshgrid(np.arange(1, 13), np.arange(1, 13))
    exact = np.sort((np.pi**2 * (m**2 + n**2)).ravel())[:40]
    # discretisation: 20 elements to 8 half waves in the highest; the next frequency is at least 1 % away
    np.testing.assert_allclose(np.sqrt(found.eigenvalues), exact, rtol=1.5e-3)


def test_up_to_returns_what_count_returns(plate_grid):
    grid = plate_grid("acm12", 14, 10, 1.3, 1.0)
    counted = modes(grid.K, grid.M, count=25)
    limit = float(np.sqrt(counted.eigenvalues[20])) / TWO_PI * (1 + 1e-6)
    upto = modes(grid.K, grid.M, up_to_hz=limit)
    assert len(upto.eigenvalues) == 21
    assert upto.complete_below == pytest.approx((TWO_PI * limit) ** 2)
    # two shifts, two factors: rounding of K over omega^2 at this mesh
    np.testing.assert_allclose(upto.eigenvalues, counted.eigenvalues[:21], rtol=1e-10, atol=1e-9)
    assert counted.complete_below > counted.eigenvalues[-1]


def test_a_limit_on_a_frequency_includes_it():
    K, M = chain(30)
    exact = 4.0 * np.sin((np.arange(30) + 0.5) * np.pi / 61) ** 2
    found = modes(K, M, up_to_hz=float(np.sqrt(exact[4])) / TWO_PI * (1 + 1e-12))
    assert len(found.eigenvalues) == 5


def test_two_runs_agree_in_every_bit(plate_grid):
    grid = plate_grid("bfs16", 16, 16)
    first, second = (modes(grid.K, grid.M, count=12) for _ in range(2))
    assert np.array_equal(first.eigenvalues, second.eigenvalues)
    assert np.array_equal(first.shapes, second.shapes)


def test_seven_mechanisms_are_seven_rigid_modes():
    parts = [chain(80, stiffness=10.0 ** (i - 3), free=True) for i in range(7)]
    K = csc_array(block_array([[parts[i][0] if i == j else None for j in range(7)] for i in range(7)]))
    M = csc_array(diags_array(np.ones(7 * 80)))
    found = modes(K, M, count=12)
    assert found.n_rigid == 7
    # the softest chain alone has the first elastic mode
    assert found.eigenvalues[7] == pytest.approx(1e-3 * 4 * np.sin(np.pi / 160) ** 2, rel=1e-9)


def portal(held=False):
    """A bent bar in space, free unless its feet are held."""
    steel = Material("steel", 206e9, 0.3, 7850.0)
    line = ((0.0, 0.0, 0.0), (0.1, 0.2, 0.5), (0.4, 0.1, 0.6), (0.4, 0.1, 0.0))
    bars = Frame("bars", steel, rectangle("bar", 12e-3, 10e-3), (line,), mesh=0.05)
    feet = PlaceOn("foot", "bars", ((0.0, 0.0, 0.0), (0.4, 0.1, 0.0)))
    supports = (Support("feet", "clamped", at="foot"),) if held else ()
    return assemble(mesh_structure(Structure("portal", (bars,), points=(feet,), supports=supports)))


def test_a_free_frame_has_six_rigid_modes_and_all_its_mass():
    basis = modal_basis(portal(), count=14)
    assert basis.n_rigid == 6
    assert basis.frequency_hz[6] > 1.0
    np.testing.assert_allclose(basis.modal_mass.sum(axis=1), basis.total_mass, rtol=1e-13)  # rounding: 8e-16 here
    assert modal_basis(portal(held=True), count=4).n_rigid == 0


def test_a_limit_far_below_the_first_elastic_mode():
    assembly = portal()
    rigid = modes(assembly.K, assembly.M, up_to_hz=1e-3)  # here K - mu M itself is rounding only
    assert rigid.n_rigid == len(rigid.eigenvalues) == 6
    assembly = portal(held=True)
    none = modal_basis(assembly, up_to=0.1)
    assert none.kind == ()
    assert none.complete_below_hz == pytest.approx(0.1)
    assert [finding.code for finding in none.findings] == ["no-modes"]


def test_a_massless_mechanism_is_named():
    K, M = chain(6)
    shape = np.zeros((8, 8))
    shape[:6, :6] = K.toarray()
    shape[6:, 6:] = [[1.0, -1.0], [-1.0, 1.0]]  # a spring between two massless places, held by nothing
    mass = block_diag(M.toarray(), np.zeros((2, 2)))
    labels = tuple(f"node {i} UX" for i in range(8))
    with pytest.raises(SingularSystem, match=r"node [67] UX: got neither stiffness nor mass"):
        modes(csc_array(shape), csc_array(mass), count=3, labels=labels)


def test_an_untouched_degree_of_freedom_is_named():
    K = csc_array(np.diag([1.0, 0.0, 2.0]))
    M = csc_array(np.diag([1.0, 0.0, 1.0]))
    with pytest.raises(SingularSystem, match="plate node 1 RZ"):
        modes(K, M, count=1, labels=("a", "plate node 1 RZ", "c"))


def test_massless_but_stiff_degrees_of_freedom_have_no_modes():
    K, _ = chain(10)
    mass = np.ones(10)
    mass[4] = 0.0
    found = modes(K, csc_array(np.diag(mass)), count=10)
    assert len(found.eigenvalues) == 9


def test_negative_stiffness_is_refused():
    K, M = chain(5, free=True)
    with pytest.raises(FemstructError, match="no negative stiffness"):
        modes(csc_array(K - 0.05 * M), M, count=3)


def test_a_lost_mode_is_noticed_and_fetched(monkeypatch, plate_grid):
    grid = plate_grid("bfs16", 16, 16)
    sound = modes(grid.K, grid.M, count=8)
    genuine, calls = solve._lowest, []

    def forgetful(pencil, k, asked, attempt, labels):
        values, shapes, sigma = genuine(pencil, k + 1, asked, attempt, labels)
        calls.append(k)
        if len(calls) == 1:  # one of the pair 6, 7 is lost at first
            values, shapes = np.delete(values, 6), np.delete(shapes, 6, axis=1)
        return values[:k], shapes[:, :k], sigma

    monkeypatch.setattr(solve, "_lowest", forgetful)
    again = modes(grid.K, grid.M, count=8)
    assert len(calls) == 2
    np.testing.assert_allclose(again.eigenvalues, sound.eigenvalues, rtol=1e-12)  # rounding: 6e-15 here


def test_an_untrustworthy_count_is_refused():
    # A zero on the diagonal needs an off-diagonal pivot: the signs of the others then say nothing.
    K = csc_array(np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.5], [0.0, 0.5, 3.0]]))
    assert eigen.count_below(K, csc_array(np.eye(3)), 1.0) in (None, 1)
    assert eigen.count_below(csc_array(np.diag([1.0, 2.0, 3.0])), csc_array(np.eye(3)), 2.0) is None


def test_ties_do_not_turn_the_sign():
    shapes = np.array([[-1.0, 1.0 - 1e-9], [0.2, 0.0], [1.0 + 1e-12, -1.0]])
    turned = fix_signs(shapes, np.ones(3))
    assert turned[0, 0] > 0
    assert turned[0, 1] > 0


@pytest.mark.parametrize("given", [{}, {"count": 2, "up_to_hz": 3.0}, {"count": 0}, {"count": 6}, {"up_to_hz": -1.0}])
def test_what_cannot_be_asked(given):
    K, M = chain(5)
    with pytest.raises(FemstructError, match="modes"):
        modes(K, M, **given)


def test_low_and_high_modes_of_full_matrices_are_right():
    """Ten stiff springs from the ground, twenty soft ones behind them: omega^2 of 0.006 to 4e9, against 40 digits.

    By the inverse alone the high modes would be wrong by 5e-8, directly the low ones by more than themselves.
    """
    springs = np.array([1e9] * 10 + [1.0] * 20)
    off = -springs[1:]
    K = csc_array(diags_array([off, springs + np.append(springs[1:], 0.0), off], offsets=[-1, 0, 1]))
    found = modes(K, csc_array(diags_array(np.ones(30))), count=30)
    with mpmath.workdps(40):
        exact = mpmath.eigsy(mpmath.matrix(K.toarray().tolist()), eigvals_only=True)
    assert found.eigenvalues == pytest.approx([float(value) for value in exact], rel=1e-11)  # rounding, 2e-14 here


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("shift", [None, -0.12])  # as the modes leave it; twice the first omega^2 that is left out
def test_static_response_with_residual_vectors_is_exact(free, shift):
    """The load is answered by the modes left out, too; of a free chain, what its motion as a whole leaves over."""
    K, M = chain(60, free=free)
    load = np.eye(60)[:, [23]]
    found = modes(K, M, count=4)
    if shift is not None:
        found = replace(found, sigma=shift)
    values, vectors = residual_vectors(K, M, found, load)
    elastic = slice(found.n_rigid, None)
    shapes = np.concatenate([found.shapes[:, :4], vectors], axis=1)[:, elastic]
    modal = shapes @ (shapes[23] / np.concatenate([found.eigenvalues[:4], values])[elastic])
    exact = np.linalg.pinv(K.toarray()) @ load[:, 0]
    assert modal == pytest.approx(exact, abs=1e-11 * np.abs(exact).max())  # rounding, 3e-13 here


@pytest.mark.parametrize("free", [False, True])
def test_residual_vectors_leave_out_the_fourth_power_of_frequency(free):
    """A static correction alone would leave out the second power; masses differ, so that the dynamic one needs them."""
    n, kept = 60, 4
    K, _ = chain(n, free=free)
    M = csc_array(diags_array(1.0 + 8.0 * np.arange(n) % 7))
    load = np.zeros((n, 1))
    load[23] = 1.0
    found = modes(K, M, count=kept + 1)
    beyond = np.sqrt(found.eigenvalues[kept])
    found = modes(K, M, count=kept)
    values, vectors = residual_vectors(K, M, found, load)
    shapes = np.concatenate([found.shapes[:, :kept], vectors], axis=1)
    squared = np.concatenate([found.eigenvalues[:kept], values])
    parts = np.array([0.1, 0.2])  # of the first frequency left out; below, rounding shows
    missing = []
    for omega in parts * beyond:
        exact = np.linalg.solve((K - omega**2 * M).toarray(), load[:, 0])
        modal = shapes @ (shapes[23] / (squared - omega**2))
        missing.append(np.linalg.norm(modal - exact))
    # the next order at a fifth of the frequency: 0.08 here
    assert np.diff(np.log(missing))[0] / np.log(2.0) == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("n", [3, 40])
@pytest.mark.parametrize("spread", [0.0, 1e-15, 1e-9])
def test_a_group_of_equal_frequencies_may_be_all_there_is(n, spread):
    """n masses on as many springs of their own, alike: omega^2 = k / m, by full matrices that join two halves."""
    k = 1e5 * (1.0 + spread * np.arange(n) / n)
    found = modes(csc_array(diags_array(k)), csc_array(diags_array(np.full(n, 99.0))), count=n)
    np.testing.assert_allclose(found.eigenvalues, 1e5 / 99.0, rtol=1e-8)  # the spread
    np.testing.assert_allclose(99.0 * found.shapes.T @ found.shapes, np.eye(n), atol=1e-12)  # rounding
    assert found.n_rigid == 0


def test_a_stiffness_beyond_rounding_is_refused_in_words() -> None:
    """Full matrices whose shifted stiffness is indefinite: its smallest values are lost in the largest."""
    K = csc_array(np.diag([1e30, 1.0]) + np.array([[0.0, 1e20], [1e20, 0.0]]))
    with pytest.raises(InputError, match="the smallest are lost in rounding, expected stiffness within 15 decades"):
        _dense(K, csc_array(np.eye(2)), -1e-3, 1)
