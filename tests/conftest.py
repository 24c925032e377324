"""What all tests share: one thread a process, compiled kernels, and a rectangular plate meshed with one kind of
element, assembled without the package's own assembly."""

# ruff: noqa: E402 (the number of threads is read when numpy is imported)
from __future__ import annotations

import compileall
import os
import signal

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # as the command line has it; two processes of two threads wait for each other

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import HealthCheck, settings
from jsonschema import Draft202012Validator
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh, splu

from femstruct.compiled.store import code_of
from femstruct.elements import plate
from femstruct.impact.simulate import ALL

if TYPE_CHECKING:
    from femstruct.study.results import StudyResult

# A clock in a test says how busy the machine is, not whether the code is right.
settings.register_profile("femstruct", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("femstruct")

W, RX, RY, TWIST = range(4)
HELD = {  # on an edge of constant x: what is fixed; on an edge of constant y RX and RY change places
    "S": (W, RX),
    "C": (W, RX, RY, TWIST),
    "F": (),
}


def pytest_configure(config: pytest.Config) -> None:
    """Compile modules and kernels once, before processes that test beside each other would each do it; and hear the
    keyboard, which a shell switches off in what it starts in the background.

    Where Python is told to write no bytecode (PYTHONDONTWRITEBYTECODE), a command that a test starts spends a third of
    its time on compiling modules.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if not hasattr(config, "workerinput"):
        for package in ("femstruct", "acoustics"):
            compileall.compile_dir(Path(__file__).parents[1] / package, quiet=2)
        code_of(ALL)


@pytest.fixture(autouse=True, scope="session")
def summaries_fit_their_schema() -> Iterator[None]:
    """What any test writes to a results file has a summary that fits the published schema."""
    from femstruct.files import results_file as results
    from femstruct.files.summary_schema import summary_schema

    fits, summary = Draft202012Validator(summary_schema()), results.summary

    def fitting(result: StudyResult) -> dict[str, Any]:
        told = summary(result)
        mistakes = [f"{'/'.join(map(str, one.absolute_path))}: {one.message[:300]}" for one in fits.iter_errors(told)]
        assert not mistakes, f"femstruct schema summary: {mistakes[:10]}"
        return told

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(results, "summary", fitting)
        yield


@dataclass(frozen=True)
class PlateGrid:
    """nx x ny cells on lx x ly: K, M (sparse) and the DOF of every (node, component); nodes run along x first."""

    kind: str
    points: NDArray[np.float64]
    cells: NDArray[np.int64]
    K: sp.csc_array
    M: sp.csc_array
    D: NDArray[np.float64]

    @property
    def per_node(self) -> int:
        return plate.dofs_per_node(self.kind)

    def dof(self, nodes: NDArray[np.int64] | int, component: int) -> NDArray[np.int64]:
        return np.atleast_1d(nodes) * self.per_node + component

    def held(self, edges: str) -> NDArray[np.int64]:
        """DOFs fixed by edge conditions, a letter each for x0, x1, y0, y1."""
        x, y = self.points.T
        sides = (x == x.min(), x == x.max(), y == y.min(), y == y.max())
        dofs = []
        for number, (side, letter) in enumerate(zip(sides, edges, strict=True)):
            for component in HELD[letter]:
                along_y = component if number < 2 or component not in (RX, RY) else RX + RY - component
                if along_y < self.per_node:
                    dofs.append(self.dof(side.nonzero()[0], along_y))
        return np.unique(np.concatenate(dofs)) if dofs else np.array([], dtype=np.int64)

    def free(self, held: NDArray[np.int64]) -> NDArray[np.int64]:
        return np.setdiff1d(np.arange(self.K.shape[0]), held)

    def static(self, held: NDArray[np.int64], force: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacement under a force; splu of the symmetric positive definite free part."""
        free = self.free(held)
        factor = symmetric_factor(self.K[free][:, free])
        displacement = np.zeros_like(force)
        displacement[free] = factor.solve(force[free])
        return displacement

    def lambdas(self, edges: str, count: int) -> NDArray[np.float64]:
        """omega lx^2 sqrt(m / D) of the first modes that are not rigid, for a mass per area of 1."""
        free = self.free(self.held(edges))
        K, M = self.K[free][:, free], self.M[free][:, free]
        lx = np.ptp(self.points[:, 0])
        unit = self.D[0, 0] / lx**4  # omega^2 of lambda = 1
        rigid = 3 if edges == "FFFF" else 0
        shift = -10.0 * unit
        factor = symmetric_factor((K - shift * M).tocsc())
        operator = sp.linalg.LinearOperator(K.shape, matvec=factor.solve, dtype=np.float64)
        start = np.random.default_rng(1).standard_normal(K.shape[0])
        values = eigsh(K, k=count + rigid, M=M, sigma=shift, OPinv=operator, v0=start, return_eigenvectors=False)
        return np.sqrt(np.sort(values)[rigid:] / unit)


def symmetric_factor(matrix: sp.csc_array) -> sp.linalg.SuperLU:
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def _plate_grid(
    kind: str, nx: int, ny: int, lx: float = 1.0, ly: float = 1.0, nu: float = 0.3, numbering: int | None = None
) -> PlateGrid:
    ix, iy = (index.ravel() for index in np.meshgrid(np.arange(nx), np.arange(ny)))
    first = iy * (nx + 1) + ix
    cells = np.stack([first, first + nx + 1, first + nx + 2, first + 1], axis=1)
    y, x = (
        place.ravel() for place in np.meshgrid(np.linspace(0, ly, ny + 1), np.linspace(0, lx, nx + 1), indexing="ij")
    )
    if numbering is not None:
        place_of = np.random.default_rng(numbering).permutation(len(x))
        cells = place_of[cells]
        x, y = x[np.argsort(place_of)], y[np.argsort(place_of)]
    D = plate.rigidity(1.0, nu, 12.0 ** (1 / 3)) * (1 - nu**2)  # Eh^3 / 12 / (1 - nu^2) = 1
    per_node = plate.dofs_per_node(kind)
    dofs = (cells[:, :, None] * per_node + np.arange(per_node)).reshape(len(cells), -1)
    a, b = np.full(len(cells), lx / nx), np.full(len(cells), ly / ny)
    rows = np.repeat(dofs, dofs.shape[1], axis=1).ravel()
    columns = np.tile(dofs, (1, dofs.shape[1])).ravel()
    shape = (len(x) * per_node,) * 2
    K, M = (
        sp.csc_array(sp.coo_array((matrix.ravel(), (rows, columns)), shape=shape))
        for matrix in (plate.stiffness(kind, a, b, D), plate.mass(kind, a, b, 1.0))
    )
    return PlateGrid(kind, np.stack([x, y], axis=1), cells, K, M, D)


@pytest.fixture(scope="session")
def plate_grid() -> Callable[..., PlateGrid]:
    """plate_grid(kind, nx, ny, lx, ly, nu, numbering): an assembled plate with D = 1 and a mass per area of 1."""
    return _plate_grid
