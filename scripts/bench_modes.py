"""Factor and 20 modes of a square plate, against scipy's eigsh(K, 20, M, sigma=0) as it comes, in the same process.

CPU seconds, one BLAS thread (set OMP_NUM_THREADS=1 before the start), best of `rounds` taken in turns. `modes` includes
the choice of the shift and the proof of completeness; `bare` is its factor and Lanczos alone.

    OMP_NUM_THREADS=1 python scripts/bench_modes.py [divisions ...]
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import LinearOperator, eigsh

from femstruct.arrays import Floats
from femstruct.elements import plate
from femstruct.modal.factor import factorise
from femstruct.modal.solve import modes

COUNT = 20


def square_plate(n: int) -> tuple[csc_array, csc_array]:
    """K and M of a simply supported square plate of n x n bfs16 elements; D = 1, mass per area 1, side 1."""
    ix, iy = (index.ravel() for index in np.meshgrid(np.arange(n), np.arange(n)))
    first = iy * (n + 1) + ix
    cells = np.stack([first, first + n + 1, first + n + 2, first + 1], axis=1)
    dofs = (cells[:, :, None] * 4 + np.arange(4)).reshape(len(cells), -1)
    place = np.repeat(dofs, 16, axis=1).ravel(), np.tile(dofs, (1, 16)).ravel()
    sides = np.full(len(cells), 1.0 / n)
    D = np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    x, y = np.divmod(np.arange((n + 1) ** 2), n + 1)[::-1]
    held = np.zeros(((n + 1) ** 2, 4), dtype=bool)
    held[:, 0] = (x == 0) | (x == n) | (y == 0) | (y == n)
    held[:, 1] = (x == 0) | (x == n)
    held[:, 2] = (y == 0) | (y == n)
    free = np.flatnonzero(~held.ravel())
    shape = (held.size, held.size)
    K, M = (
        csc_array(coo_array((matrix.ravel(), place), shape=shape))[free][:, free]
        for matrix in (plate.stiffness("bfs16", sides, sides, D), plate.mass("bfs16", sides, sides, 1.0))
    )
    return K, M


def bare(K: csc_array, M: csc_array) -> Floats:
    """One symmetric factor at a known shift and Lanczos: the least that shift-invert costs."""
    factor = factorise(K, M, -0.5 * (2.0 * np.pi**2) ** 2)
    inverse = LinearOperator(K.shape, matvec=factor.solve, dtype=np.float64)
    start = factor.solve(M @ np.random.default_rng(0).standard_normal(K.shape[0]))
    values: Floats = eigsh(K, COUNT, M=M, sigma=factor.sigma, OPinv=inverse, v0=start, tol=1e-9)[0]
    return values


def main(divisions: tuple[int, ...] = (50, 100), rounds: int = 2) -> dict[str, float]:
    """CPU seconds of each way and their ratios, by number of divisions."""
    results: dict[str, float] = {}
    for n in divisions:
        K, M = square_plate(n)
        ways: dict[str, Callable[[], Floats]] = {
            "modes": lambda K=K, M=M: modes(K, M, count=COUNT).eigenvalues,
            "bare": lambda K=K, M=M: bare(K, M),
            "eigsh": lambda K=K, M=M: eigsh(K, COUNT, M=M, sigma=0)[0],
        }
        best = dict.fromkeys(ways, np.inf)
        for _ in range(rounds):
            for name, way in ways.items():
                start = time.process_time()
                values = np.sort(way())
                best[name] = min(best[name], time.process_time() - start)
                results[f"{name}_{n}_first_mode_error"] = abs(float(np.sqrt(values[0])) / (2.0 * np.pi**2) - 1.0)
        results |= {f"{name}_{n}_s": seconds for name, seconds in best.items()}
        results[f"eigsh_over_modes_{n}"] = best["eigsh"] / best["modes"]
        results[f"eigsh_over_bare_{n}"] = best["eigsh"] / best["bare"]
    return results


if __name__ == "__main__":
    chosen = tuple(int(argument) for argument in sys.argv[1:]) or (50, 100)
    for key, value in main(chosen).items():
        print(f"{key:32s} {value:.3g}")
