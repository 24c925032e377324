"""Shells of free quadrilaterals against three-dimensional solids: a rib beside a plate, an angle, an open box.

The solids are those of `test_plates_that_stretch`: p-version bricks, two programs agree to 0.2 %. Folds and ribs are
lines here and have a width there, up to 0.9 %.
"""

from __future__ import annotations

import numpy as np
import pytest

import femstruct as fs
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.sections import rectangle

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
SOLID = {
    "rib plate": [35.822, 65.42, 84.457, 89.843, 94.559, 160.448],
    "angle": [20.126, 31.543, 46.284, 48.859, 65.966, 84.548],
    "box": [14.14, 31.88, 41.252, 49.836, 50.802, 63.28],
}
Sheet = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


def welded(sheets: list[Sheet], cell: float, fixed: object = None) -> ImportedMesh:
    """Rectangles, each by a corner and its two sides, of cells whose inner nodes are moved by a sixth of them; nodes at
    one place are one. fixed(points) : nodes that stay."""
    rng, places, quads = np.random.default_rng(8), [], []
    for corner, one, other in (np.array(each) for each in sheets):
        counts = [max(1, round(float(np.linalg.norm(side)) / cell)) for side in (one, other)]
        x, y = np.meshgrid(*(np.linspace(0.0, 1.0, n + 1) for n in counts), indexing="ij")
        points = corner + x[..., None] * one + y[..., None] * other
        moves = rng.uniform(-1, 1, (*x.shape, 2)) / 6.0
        moves[[0, -1]] = moves[:, [0, -1]] = 0.0
        if fixed is not None:
            moves[fixed(points)] = 0.0  # type: ignore[operator]
        points = points + moves[..., :1] * one / counts[0] + moves[..., 1:] * other / counts[1]
        n = sum(len(some) for some in places) + np.arange(x.size).reshape(x.shape)
        quads.append(np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4))
        places.append(points.reshape(-1, 3))
    every = np.concatenate(places)
    _, first, number = np.unique(np.round(every / 1e-6), axis=0, return_index=True, return_inverse=True)
    cells = number.ravel()[np.concatenate(quads)]
    return ImportedMesh(
        "welded", every[first], np.arange(len(first)), {"quad4": cells}, {"quad4": np.arange(len(cells))}
    )


def elastic_hz(structure: fs.Structure, rigid: int = 6) -> np.ndarray:
    basis = fs.modal_basis(fs.assemble(fs.mesh_structure(structure)), count=rigid + 6)
    assert basis.n_rigid == rigid
    return np.asarray(basis.frequency_hz[basis.modes])[rigid : rigid + 6]


def on_the_rib(points: np.ndarray) -> np.ndarray:
    return np.abs(points[..., 1] - 0.4) < 1e-9


@pytest.mark.parametrize("beside", [False, True])
def test_a_rib_beside_a_plate(beside: bool) -> None:
    """beside : a lone sheet in another plane is in the same mesh: the shell is not flat, and is where the rib is."""
    sheets: list[Sheet] = [((0, 0, 0), (1.0, 0, 0), (0, 0.8, 0))]
    lone: list[Sheet] = [((5.0, 0, 0), (0.1, 0, 0), (0, 0, 0.1))]
    plate = fs.Shell("plate", welded(sheets + lone * beside, 0.025, on_the_rib), STEEL, 0.008)
    down = (0.0, 0.0, -(0.008 + 0.06) / 2.0)
    line = ((0.0, 0.4, 0.0), (1.0, 0.4, 0.0))
    rib = fs.Frame("rib", STEEL, rectangle("r", 0.01, 0.06), (line,), start_offset=down, end_offset=down)
    found = elastic_hz(fs.Structure("ribbed", (plate, rib), (fs.Joint("weld", "rib", "plate"),)), 12 if beside else 6)
    assert found == pytest.approx(SOLID["rib plate"], rel=7e-3)  # the width of the weld: 0.6 % low in the first


def angle(cell: float) -> np.ndarray:
    legs: list[Sheet] = [((0, 0, 0), (4.0, 0, 0), (0, 0.2, 0)), ((0, 0, 0), (4.0, 0, 0), (0, 0, 0.2))]
    return elastic_hz(fs.Structure("angle", (fs.Shell("angle", welded(legs, cell), STEEL, 0.008),)))


def test_an_angle_of_one_folded_mesh() -> None:
    assert angle(0.025) == pytest.approx(SOLID["angle"], rel=3e-3)  # cells of 25 mm


@pytest.mark.stress
def test_an_angle_drifts_as_its_free_edges_come_to_shear() -> None:
    """From 50 to 12.5 mm: within a thickness (8 mm) of a free edge the twisting moment goes over into a shear force,
    which only cells of that size see. Without shear strains the drift is 0.01 %."""
    assert angle(0.0125) == pytest.approx(angle(0.05), rel=5e-3)  # 0.4 % lower


def test_an_open_box_of_one_folded_mesh() -> None:
    walls: list[Sheet] = [((0, y, 0), (1.0, 0, 0), (0, 0, 0.5)) for y in (0.0, 0.8)]
    walls += [((x, 0, 0), (0, 0.8, 0), (0, 0, 0.5)) for x in (0.0, 1.0)]
    mesh = welded([((0, 0, 0), (1.0, 0, 0), (0, 0.8, 0)), *walls], 0.025)
    found = elastic_hz(fs.Structure("box", (fs.Shell("box", mesh, STEEL, 0.006),)))
    assert found == pytest.approx(SOLID["box"], rel=4e-3)  # the width of the folds: 0.3 % low
