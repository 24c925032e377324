"""20 modes of a square plate and the proof that none is missing, against scipy's eigsh(K, 20, M, sigma=0) as it comes:
of bfs16 elements and of quadrilaterals of shells; and how many elements a second are made and put together.

CPU seconds, one BLAS thread (set OMP_NUM_THREADS=1 before the start), best of `rounds` taken in turns in one process,
and the largest memory of each solver's modes in a process of its own. `modes` is everything: analysis, choice of the
shift, factor, modes and count, with each of the sparse solvers at hand. `assembled` is a whole model from its mesh to
K and M. Of several divisions, time and memory are fitted as powers of the number of unknowns. eigsh is left out beyond
200 divisions; 500 are a million unknowns of bfs16.

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
from femstruct.assembly.matrices import assemble
from femstruct.elements import plate, quad_shell, triangle_shell
from femstruct.modal.eigen import modes
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.structure import Structure
from femstruct.parts.plate import Plate
from femstruct.parts.shell import Shell
from femstruct.sparse import SOLVERS

COUNT = 20
MOST_BY_EIGSH = 200  # divisions


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


def square_shell(n: int) -> tuple[csc_array, csc_array]:
    """The same plate, a hundredth thick, of n x n quadrilaterals of shells; the edges are held in their plane too."""
    x, y = (places.ravel() for places in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij"))
    nodes = np.stack([x, y, 0 * x], axis=1)
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    cells = np.stack([first, first + n + 1, first + n + 2, first + 1], axis=1)
    dofs = (cells[:, :, None] * 6 + np.arange(6)).reshape(len(cells), -1).astype(np.int32)
    place = np.repeat(dofs, 24, axis=1).ravel(), np.tile(dofs, (1, 24)).ravel()
    on_x, on_y = (x == 0) | (x == 1), (y == 0) | (y == 1)
    edge = on_x | on_y
    held = np.stack([edge, edge, edge, on_x, on_y, edge], axis=1)
    free = np.flatnonzero(~held.ravel()).astype(np.int32)
    t, D = 0.01, np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    shear = 5 / 6 * 12 / t**2 * 0.35 * np.eye(2)
    stiff = quad_shell.stiffness(nodes[cells], 12 / t**2 * D, 0 * D, D, shear)
    K, M = (
        csc_array(coo_array((matrix.ravel(), place), shape=(held.size, held.size)))[free][:, free]
        for matrix in (stiff, quad_shell.mass(nodes[cells], 1.0, 0.0, t**2 / 12))
    )
    return K, M


def elements_per_second(count: int = 20_000, rounds: int = 3) -> dict[str, float]:
    """K and M of shell elements in global axes, per second of CPU: distorted, all equal, and triangles."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    distorted = square + np.random.default_rng(1).uniform(-0.2, 0.2, (count, 4, 3)) * [1, 1, 0.3]
    D = np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    cases = {
        "distorted_quads": (quad_shell, distorted),
        "equal_quads": (quad_shell, square + np.arange(count)[:, None, None] * [1.0, 0.0, 0.0]),
        "distorted_triangles": (triangle_shell, distorted[:, :3]),
    }
    rates = {}
    for name, (element, corners) in cases.items():
        best = np.inf
        for _ in range(rounds):
            start = time.process_time()
            element.stiffness(corners, D, 0 * D, D, np.eye(2))
            element.mass(corners, 1.0, 0.0, 0.1)
            best = min(best, time.process_time() - start)
        rates[f"{name}_per_s"] = count / best
    return rates


def assembled_per_second(n: int = 100, rounds: int = 2) -> dict[str, float]:
    """Cells of n x n that are put together to K and M, per second of CPU, everything included: bfs16, equal and
    distorted shells."""
    steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    x, y = np.meshgrid(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, n + 1), indexing="ij")
    points = np.stack([x, y, 0.0 * x], axis=-1).reshape(-1, 3)
    numbers = np.arange(len(points))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = {"quad4": np.stack([first, first + n + 1, first + n + 2, first + 1], axis=1)}
    moved = points + np.random.default_rng(1).uniform(-0.2 / n, 0.2 / n, points.shape) * [1.0, 1.0, 0.0]
    parts = {
        "bfs16_cells": Plate("p", steel, 0.01, (0.0, 0.0, 0.0), (1.0, 1.0), (n, n)),
        "equal_shells": Shell("p", ImportedMesh("p", points, numbers, quads, {"quad4": first}), steel, 0.01),
        "distorted_shells": Shell("p", ImportedMesh("p", moved, numbers, quads, {"quad4": first}), steel, 0.01),
    }
    rates = {}
    for name, part in parts.items():
        model, best = mesh_structure(Structure("p", (part,))), np.inf
        for _ in range(rounds):
            start = time.process_time()
            assemble(model)
            best = min(best, time.process_time() - start)
        rates[f"{name}_assembled_per_s"] = n**2 / best
    return rates


def powers(results: dict[str, float], divisions: tuple[int, ...]) -> dict[str, float]:
    """Exponents of the number of unknowns in time and memory of each way, fitted to all divisions."""
    found = {}
    for key in [key for key in results if key.startswith(("modes_", "peak_mb")) and f"_{divisions[0]}" in key]:
        family = [results.get(key.replace(f"_{divisions[0]}", f"_{n}"), np.nan) for n in divisions]
        if len(divisions) > 1 and "error" not in key and np.isfinite(family).all():
            slope = np.polyfit(np.log(np.square(divisions)), np.log(family), 1)[0]
            found[key.replace(f"_{divisions[0]}", "") + "_power_of_unknowns"] = float(slope)
    return found


def largest_memory(structure: str, n: int, solver: str) -> float:
    """Peak memory [MB] of a process that solves for the modes of a structure of n x n; nan where Linux is not there."""
    status = Path("/proc/self/status")
    if not status.exists():
        return float("nan")
    code = (
        "import sys; from bench_modes import *; "
        f"modes(*{structure}(int(sys.argv[1])), count=COUNT, solver=sys.argv[2])\n"
        f"print(next(line for line in open('{status}') if line.startswith('VmHWM')).split()[1])"
    )
    command = [sys.executable, "-c", code, str(n), solver]
    return float(subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, check=True).stdout) / 1024


def main(divisions: tuple[int, ...] = (50, 100), rounds: int = 2) -> dict[str, float]:
    """CPU seconds of each way, their ratios and peak memory, by number of divisions."""
    results: dict[str, float] = elements_per_second() | assembled_per_second()
    for n, build in ((n, build) for n in divisions for build in (square_plate, square_shell)):
        K, M = build(n)
        label = f"{build.__name__}_{n}"
        ways: dict[str, Callable[[], Floats]] = {
            f"modes_{solver}": lambda K=K, M=M, solver=solver: modes(K, M, count=COUNT, solver=solver).eigenvalues
            for solver in SOLVERS
        }
        if n <= MOST_BY_EIGSH:
            ways["eigsh"] = lambda K=K, M=M: eigsh(K, COUNT, M=M, sigma=0)[0]
        best = dict.fromkeys(ways, np.inf)
        for _ in range(rounds):
            for name, way in ways.items():
                start = time.process_time()
                values = np.sort(way())
                best[name] = min(best[name], time.process_time() - start)
                results[f"{name}_{label}_first_mode_error"] = abs(float(np.sqrt(values[0])) / (2.0 * np.pi**2) - 1.0)
        results |= {f"{name}_{label}_s": seconds for name, seconds in best.items()}
        for solver in SOLVERS:
            if "eigsh" in best:
                results[f"eigsh_over_modes_{solver}_{label}"] = best["eigsh"] / best[f"modes_{solver}"]
            results[f"peak_mb_{solver}_{label}"] = largest_memory(build.__name__, n, solver)
    return results | powers(results, divisions)


if __name__ == "__main__":
    chosen = tuple(int(argument) for argument in sys.argv[1:]) or (50, 100)
    for key, value in main(chosen).items():
        print(f"{key:52s} {value:.3g}")
