"""Every sparse solver at hand against full matrices: solves, counts of eigenvalues, and the same modes from each."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from bench_modes import square_plate
from scipy.linalg import eigh, eigvalsh
from scipy.sparse import block_diag, csc_array, diags_array, eye_array, random_array

from femstruct.modal.eigen import BLOCK, Krylov, Pencil, converge, modes
from femstruct.sparse import SOLVERS, Fronts, ZeroPivot, aligned, dissect

ROUNDING = 1e-12  # rounding: 5e-15 here at most

RSLAB = pytest.param("rslab", marks=pytest.mark.skipif("rslab" not in SOLVERS, reason="the fast extra is missing"))
EVERY = pytest.mark.parametrize("solver", ["LAPACK fronts", RSLAB])


def symmetric(n, seed, density=0.02):
    """A random symmetric matrix of both signs with a full diagonal."""
    rng = np.random.default_rng(seed)
    half = random_array((n, n), density=density, rng=rng, data_sampler=rng.standard_normal)
    return csc_array(half + half.T + diags_array(rng.standard_normal(n) * 2.0))


@EVERY
@pytest.mark.parametrize("columns", [None, 1, 7])
def test_solves_agree_with_full_matrices(solver, columns):
    n, rng = 200, np.random.default_rng(3)
    A = csc_array(symmetric(n, 1) + 20.0 * eye_array(n))
    load = rng.standard_normal(n if columns is None else (n, columns))
    pattern, (values,) = aligned([A])
    answer = SOLVERS[solver](pattern).factor(values).solve(load)
    np.testing.assert_allclose(answer, np.linalg.solve(A.toarray(), load), rtol=ROUNDING, atol=ROUNDING)


@EVERY
def test_solves_inside_the_spectrum_agree_with_full_matrices(solver):
    K, M = square_plate(16)
    pattern, (stiffness, mass) = aligned([K, M])
    middle = float(np.median(eigh(K.toarray(), M.toarray(), eigvals_only=True)))
    load = np.random.default_rng(9).standard_normal((K.shape[0], 3))
    for level in (0.3, 0.9, 3.0):  # heads of both signs
        factor = SOLVERS[solver](pattern).factor(stiffness - level * middle * mass)
        exact = np.linalg.solve((K - level * middle * M).toarray(), load)
        # Pivots are sought within a front only: some digits more are lost than of 1e-12 by the full matrix.
        np.testing.assert_allclose(factor.solve(load), exact, rtol=0, atol=1e-8 * np.abs(exact).max())


@EVERY
def test_one_analysis_serves_every_sum_real_and_complex_symmetric(solver):
    n, rng = 150, np.random.default_rng(4)
    first, second = symmetric(n, 5), symmetric(n, 6, density=0.05)  # of different patterns
    pattern, (a, b) = aligned([first, second])
    analysis = SOLVERS[solver](pattern)
    for factor in (1.0, 2.5 + 1.0j, 30.0 - 7.0j):
        full = first.toarray() + factor * second.toarray() + 40.0 * (1.0 + factor) * np.eye(n)
        values = a + factor * b
        values[pattern.diagonal] += 40.0 * (1.0 + factor)
        load = rng.standard_normal((n, 3)).astype(values.dtype)
        answer = analysis.factor(values).solve(load)
        np.testing.assert_allclose(answer, np.linalg.solve(full, load), rtol=ROUNDING, atol=ROUNDING)


@EVERY
def test_counts_agree_with_the_eigenvalues_of_full_matrices(solver):
    K, M = symmetric(300, 7), csc_array(diags_array(np.random.default_rng(8).uniform(0.5, 2.0, 300)))
    exact = eigvalsh(K.toarray(), M.toarray())
    pencil = Pencil.of(K, M, solver)
    for place in (0, 1, 20, 150, 298):
        level = 0.5 * (exact[place] + exact[place + 1])
        assert pencil.count_below(level) == place + 1
    assert pencil.count_below(exact[0] - 1.0) == 0
    assert pencil.count_below(exact[-1] + 1.0) == 300


@EVERY
def test_counts_of_a_plate_agree_with_full_matrices(solver):
    K, M = square_plate(16)
    exact = eigh(K.toarray(), M.toarray(), eigvals_only=True)
    pencil = Pencil.of(K, M, solver)
    gaps = np.flatnonzero(np.diff(exact[:200]) > 1e-3 * exact[:199])
    for place in gaps[::12]:
        assert pencil.count_below(0.5 * (exact[place] + exact[place + 1])) == place + 1
    assert pencil.count_below(float(exact[0]) * (1 + 1e-15)) in (None, 0, 1)


@EVERY
def test_a_singular_matrix_is_refused(solver):
    pattern, (values,) = aligned([csc_array(np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))])
    with pytest.raises(ZeroPivot):
        SOLVERS[solver](pattern).factor(values)


@pytest.mark.skipif("rslab" not in SOLVERS, reason="the fast extra is missing")
def test_both_solvers_find_the_same_modes():
    K, M = square_plate(40)
    first, second = (modes(K, M, count=25, solver=solver) for solver in ("LAPACK fronts", "rslab"))
    # Rounding of K over omega^2 is 1e-10 on this mesh.
    np.testing.assert_allclose(first.eigenvalues, second.eigenvalues, rtol=1e-9)
    assert first.complete_below == pytest.approx(second.complete_below, rel=1e-9)
    apart = np.diff(first.eigenvalues, prepend=0) > 1e-3 * first.eigenvalues[0]
    alone = np.flatnonzero(apart[:-1] & apart[1:])  # pairs of one frequency may turn
    assert len(alone) >= 3
    # rounding: 1e-13 here
    np.testing.assert_allclose(
        first.shapes[:, alone], second.shapes[:, alone], atol=1e-10 * np.abs(first.shapes).max(), rtol=0
    )


def test_fronts_eliminate_every_unknown_once_and_neighbours_share_a_branch():
    K, _ = square_plate(24)
    pattern, _ = aligned([K])
    fronts = dissect(pattern)
    owner = np.empty(pattern.size, dtype=int)
    for i, front in enumerate(fronts):
        owner[front.unknowns] = i
    assert sorted(np.concatenate([front.unknowns for front in fronts])) == list(range(pattern.size))
    parent = np.full(len(fronts), -1)
    for i, front in enumerate(fronts):
        parent[list(front.children)] = i
    assert (parent[:-1] > np.arange(len(fronts) - 1)).all()
    above = [{i} for i in range(len(fronts))]
    for i in range(len(fronts) - 2, -1, -1):
        above[i] |= above[parent[i]]
    one, other = owner[pattern.indices], owner[pattern.owner]
    assert all(max(a, b) in above[min(a, b)] for a, b in zip(one, other, strict=True))


def test_counts_of_pieces_that_nothing_joins_and_of_one_that_joins_all():
    parts = block_diag([symmetric(n, n, density=0.05) for n in (400, 1, 90, 700)], format="csc")
    n = parts.shape[0]
    hub = np.zeros((n, 1))
    hub[::3] = 0.01
    joined = csc_array(parts + csc_array(hub @ np.eye(1, n, 250)) + csc_array(np.eye(1, n, 250).T @ hub.T))
    for matrix in (csc_array(parts), joined):
        pattern, (values,) = aligned([matrix])
        exact = int(np.count_nonzero(eigvalsh(matrix.toarray()) < 0))
        assert Fronts(pattern).negative(values, np.ones(n)) == exact


def test_more_equal_modes_than_a_block_are_fetched_by_widening():
    n, copies = 500, BLOCK + 3
    squared = np.concatenate([np.ones(copies), np.linspace(2.0, 50.0, n - copies)])
    space = Krylov(csc_array(eye_array(n)), lambda load: load / squared[:, None])
    converge(space, 2, 1e-10)  # forgets all but two of the copies, and what waits
    space.widen()
    values, shapes = converge(space, copies, 1e-10)
    np.testing.assert_allclose(values, 1.0, rtol=ROUNDING)
    np.testing.assert_allclose(shapes[copies:], 0.0, atol=1e-9)  # rounding: 2e-12 here


def test_without_the_extra_the_fronts_of_lapack_are_taken():
    code = (
        "import importlib.util as u; find = u.find_spec\n"
        "u.find_spec = lambda name, *rest: None if name == 'rslab' else find(name, *rest)\n"
        "from femstruct.sparse import FASTEST; print(FASTEST)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.strip() == "LAPACK fronts"
