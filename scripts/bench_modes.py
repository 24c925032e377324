"""20 modes of a square plate and the proof that none is missing, against scipy's eigsh(K, 20, M, sigma=0) as it comes.

CPU seconds, one BLAS thread (set OMP_NUM_THREADS=1 before the start), best of `rounds` taken in turns in one process,
and the largest memory of each solver's modes in a process of its own. `modes` is everything: analysis, choice of the
shift, factor, modes and count, with each of the sparse solvers at hand.

    OMP_NUM_THREADS=1 python scripts/bench_modes.py [divisions ...]
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import eigsh

from femstruct.arrays import Floats
from femstruct.elements import plate
from femstruct.modal.solve import modes
from femstruct.sparse.solvers import SOLVERS

COUNT = 20


def square_plate(n: int) -> tuple[csc_array, csc_array]:
    """K and M of a simply supported square plate of n x n bfs16 elements; D = 1, mass per area 1, side 1."""
    ix, iy = (index.ravel() for index in np.meshgrid(np.arange(n, dtype=np.int32), np.arange(n, dtype=np.int32)))
    first = iy * (n + 1) + ix
    cells = np.stack([first, first + n + 1, first + n + 2, first + 1], axis=1)
    dofs = (cells[:, :, None] * 4 + np.arange(4, dtype=np.int32)).reshape(len(cells), -1)
    place = np.repeat(dofs, 16, axis=1).ravel(), np.tile(dofs, (1, 16)).ravel()
    sides = np.full(len(cells), 1.0 / n)
    D = np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    x, y = np.divmod(np.arange((n + 1) ** 2), n + 1)[::-1]
    held = np.zeros(((n + 1) ** 2, 4), dtype=bool)
    held[:, 0] = (x == 0) | (x == n) | (y == 0) | (y == n)
    held[:, 1] = (x == 0) | (x == n)
    held[:, 2] = (y == 0) | (y == n)
    free = np.flatnonzero(~held.ravel()).astype(np.int32)
    shape = (held.size, held.size)
    K, M = (
        csc_array(coo_array((matrix.ravel(), place), shape=shape))[free][:, free]
        for matrix in (plate.stiffness("bfs16", sides, sides, D), plate.mass("bfs16", sides, sides, 1.0))
    )
    return K, M


def largest_memory(n: int, solver: str) -> float:
    """Peak memory [MB] of a process that solves for the modes of the plate of n x n; nan where Linux is not there."""
    status = Path("/proc/self/status")
    if not status.exists():
        return float("nan")
    code = (
        "import sys; from bench_modes import *; "
        "modes(*square_plate(int(sys.argv[1])), count=COUNT, solver=sys.argv[2])\n"
        f"print(next(line for line in open('{status}') if line.startswith('VmHWM')).split()[1])"
    )
    command = [sys.executable, "-c", code, str(n), solver]
    return float(subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, check=True).stdout) / 1024


def main(divisions: tuple[int, ...] = (50, 100), rounds: int = 2) -> dict[str, float]:
    """CPU seconds of each way, their ratios and peak memory, by number of divisions."""
    results: dict[str, float] = {}
    for n in divisions:
        K, M = square_plate(n)
        ways: dict[str, Callable[[], Floats]] = {
            f"modes_{solver}": lambda K=K, M=M, solver=solver: modes(K, M, count=COUNT, solver=solver).eigenvalues
            for solver in SOLVERS
        }
        ways["eigsh"] = lambda K=K, M=M: eigsh(K, COUNT, M=M, sigma=0)[0]
        best = dict.fromkeys(ways, np.inf)
        for _ in range(rounds):
            for name, way in ways.items():
                start = time.process_time()
                values = np.sort(way())
                best[name] = min(best[name], time.process_time() - start)
                results[f"{name}_{n}_first_mode_error"] = abs(float(np.sqrt(values[0])) / (2.0 * np.pi**2) - 1.0)
        results |= {f"{name}_{n}_s": seconds for name, seconds in best.items()}
        for solver in SOLVERS:
            results[f"eigsh_over_modes_{solver}_{n}"] = best["eigsh"] / best[f"modes_{solver}"]
            results[f"peak_mb_{solver}_{n}"] = largest_memory(n, solver)
    return results


if __name__ == "__main__":
    chosen = tuple(int(argument) for argument in sys.argv[1:]) or (50, 100)
    for key, value in main(chosen).items():
        print(f"{key:36s} {value:.3g}")
