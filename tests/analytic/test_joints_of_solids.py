"""Solids whose meshes do not match on the faces that touch: a joint holds them all over, as one block.

The exact motions are constant strains; the frequencies compared with are those of meshes whose nodes all coincide.
"""

from __future__ import annotations

import re

import numpy as np
import pytest
from numpy.typing import NDArray

import femstruct as fs
from femstruct.elements.solid import reference_nodes, shapes
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.model import Model
from femstruct.parts.joint_findings import joint_open_findings

Array = NDArray[np.float64]
Corner = tuple[float, float, float]
STUFF = fs.Material("stuff", E=1e9, nu=0.3, rho=1000.0)
TETRAHEDRA = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
STEPS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def box(kind: str, low: Corner, high: Corner, counts: tuple[int, int, int], moved: float = 0.0) -> ImportedMesh:
    """A box in so many hexahedra, or six times as many tetrahedra. moved : inner lines of nodes along z, as a share of
    a cell."""
    lines = [np.linspace(a, b, n + 1) for a, b, n in zip(low, high, counts, strict=True)]
    grid = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
    moves = np.random.default_rng(3).uniform(-moved, moved, (counts[0] + 1, counts[1] + 1, 1, 2))
    moves[[0, -1]] = moves[:, [0, -1]] = 0.0
    grid[..., :2] += moves * [lines[0][1] - lines[0][0], lines[1][1] - lines[1][0]]
    i, j, k = (one.ravel() for one in np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"))
    corners = np.stack([grid[i + a, j + b, k + c] for a, b, c in STEPS], axis=1)
    if kind.startswith("tet"):
        corners = corners[:, TETRAHEDRA].reshape(-1, 4, 3)
    values = shapes("tet4" if kind.startswith("tet") else "hex8", reference_nodes(kind))[0]
    nodes = np.einsum("nk,mkd->mnd", values, corners).reshape(-1, 3)
    _, first, number = np.unique(np.round(nodes, 9), axis=0, return_index=True, return_inverse=True)
    cells = number.ravel().reshape(len(corners), -1)
    numbers = {kind: np.arange(len(cells))}
    ends = {name: np.flatnonzero(nodes[first, 2] == at) for name, at in (("bottom", low[2]), ("top", high[2]))}
    return ImportedMesh("box.msh", nodes[first], np.arange(len(first)) + 1, {kind: cells}, numbers, ends)


def joined(*meshes: ImportedMesh, pairs: tuple[tuple[int, int], ...] = ((0, 1),), held: bool = False) -> Model:
    """Solids of these meshes, the first one's bottom held where asked."""
    parts = tuple(fs.Solid(f"p{i}", mesh, STUFF) for i, mesh in enumerate(meshes))
    joints = tuple(fs.Joint(f"j{a}{b}", f"p{a}", f"p{b}", kind="pinned") for a, b in pairs)
    bottom = fs.Support("held", ("x", "y", "z"), on="p0", region=fs.Region("set", named="bottom"))
    return fs.mesh_structure(fs.Structure("solids", parts, joints, supports=(bottom,) if held else ()))


def rigid_rows(model: Model) -> Array:
    """All equations of the joints on the six rigid motions of all nodes."""
    points = model.mesh.points
    found = np.zeros((len(points), 7, 6))
    found[:, :6] = np.eye(6)
    for axis in range(3):
        found[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], points)
    return np.concatenate([tie.rows @ found.reshape(-1, 6) for tie in model.ties if not tie.grounded])


def elastic(model: Model, count: int) -> Array:
    """Frequencies above the six rigid motions, which are all there are [Hz]."""
    basis = fs.modal_basis(fs.assemble(model), count=count + 6)
    assert basis.n_rigid == 6
    return np.asarray(basis.frequency_hz[6:])[:count]


@pytest.mark.parametrize(
    ("upper", "lower", "moved"),
    [
        ("hex8", "hex8", 0.0),
        ("hex8", "hex8", 0.2),
        ("tet4", "hex8", 0.2),
        ("tet10", "tet4", 0.2),
        ("tet10", "tet10", 0.2),
        ("hex20", "hex20", 0.2),
        ("hex27", "tet10", 0.0),
    ],
)
@pytest.mark.parametrize("swapped", [False, True])
def test_a_pulled_column_of_two_is_one(upper: str, lower: str, moved: float, swapped: bool) -> None:
    """The exact motion violates no equation, and leaves no force but at both ends."""
    meshes = [box(upper, (0, 0, 1), (1, 1, 2), (3, 2, 2), moved), box(lower, (0, 0, 0), (1, 1, 1), (2, 2, 1), moved)]
    model = joined(*(meshes[::-1] if swapped else meshes))
    assembly = fs.assemble(model)
    exact = np.zeros((model.mesh.n_nodes, 7))
    exact[:, :3] = model.mesh.points * [-STUFF.nu, -STUFF.nu, 1.0]
    assert np.abs(model.ties[0].rows @ exact.ravel()).max() < 1e-13  # rounding
    free = np.linalg.lstsq(assembly.dofs.T.toarray(), exact.ravel(), rcond=None)[0]
    assert assembly.dofs.T @ free == pytest.approx(exact.ravel(), abs=1e-12)  # rounding of least squares
    forces = assembly.K @ free
    node = np.array([int(re.findall(r"node (\d+)", label)[0]) for label in assembly.dofs.labels])
    inside = np.abs(assembly.points[node, 2] - 1.0) < 1.0 - 1e-6
    assert np.abs(forces[inside]).max() < 1e-10 * np.abs(forces[~inside]).max()  # rounding
    assert joint_open_findings(model) == ()


def test_a_held_column_is_stretched_by_its_weight_as_one_is() -> None:
    """Nu 0: rho g L^2 / 2 E at the top, wherever it is cut; quadratic cells have it exactly."""
    limp = fs.Material("limp", E=1e9, nu=0.0, rho=1000.0)
    meshes = box("hex20", (0, 0, 0), (1, 1, 1), (3, 2, 2)), box("tet10", (0, 0, 1), (1, 1, 2), (2, 3, 2))
    parts = tuple(fs.Solid(f"p{i}", mesh, limp) for i, mesh in enumerate(meshes))
    bottom = fs.Support("held", ("x", "y", "z"), on="p0", region=fs.Region("set", named="bottom"))
    joint = fs.Joint("j", "p0", "p1", kind="pinned")
    model = fs.mesh_structure(fs.Structure("column", parts, (joint,), supports=(bottom,)))
    rest = fs.statics(model, fs.assemble(model), [], weight=True)
    sunk = rest.displacement[model.mesh.points[:, 2] == 2.0, 2]
    assert sunk == pytest.approx(np.full(len(sunk), -9.80665e3 * 2.0**2 / (2.0 * 1e9)), rel=1e-9)  # rounding of a solve
    assert np.abs(rest.forces["j"]) == pytest.approx([0.0, 0.0, 9.80665e3], abs=1e-5)  # rounding of sums of 1e9


BLOCK, STUB = ((0, 0, 0), (4, 1, 1)), ((1.5, 0, 1), (2.5, 1, 2))
STEP = ((0, 0, 0), (2, 1, 1)), ((1, 0, 1), (3, 1, 2))


@pytest.mark.parametrize(
    ("shape", "kinds", "counts", "alike", "within"),
    [
        ((BLOCK, STUB), ("hex20", "hex20"), ((7, 2, 2), (3, 3, 2)), ((8, 2, 2), (2, 2, 2)), 0.015),
        (STEP, ("hex20", "hex20"), ((5, 3, 2), (3, 2, 2)), ((4, 2, 2), (4, 2, 2)), 0.015),
        (STEP, ("tet10", "hex20"), ((5, 3, 2), (3, 2, 2)), ((4, 2, 2), (4, 2, 2)), 0.015),
        (STEP, ("hex8", "hex8"), ((12, 6, 6), (9, 5, 5)), ((12, 6, 6), (12, 6, 6)), 0.015),
    ],
    ids=["stub", "step", "step tet10", "step hex8"],
)
def test_faces_that_lie_on_each_other_in_part_are_joined_there(shape, kinds, counts, alike, within) -> None:
    """A stub on a block, and two blocks that overhang each other, of unlike meshes against like ones."""
    unlike = joined(*(box(kind, *of, n) for kind, of, n in zip(kinds, shape, counts, strict=True)))
    assert np.abs(rigid_rows(unlike)).max() < 1e-12  # rounding
    same = joined(*(box(kinds[1], *of, n) for of, n in zip(shape, alike, strict=True)))
    assert elastic(unlike, 6) == pytest.approx(elastic(same, 6), rel=within)  # cells of a third to half a metre
    assert joint_open_findings(unlike) == ()


def test_bars_that_cross_without_a_node_on_each_other_are_one_body() -> None:
    """No node of either lies on the other: what is held is all that is linear over the area they share."""
    bars = ((-2, -0.3, 0), (2, 0.3, 0.6)), ((-0.3, -2, 0.6), (0.3, 2, 1.2))

    def crossed(along: int, across: int) -> Model:
        counts = (along, across, across), (across, along, across)
        return joined(*(box("hex20", *bar, n) for bar, n in zip(bars, counts, strict=True)))

    assert np.abs(rigid_rows(crossed(3, 1))).max() < 1e-12  # rounding
    fine = elastic(crossed(20, 3), 4)
    assert elastic(crossed(5, 1), 4) == pytest.approx(fine, rel=0.2)  # cells wider than the crossing are too stiff


def test_four_blocks_round_an_edge_are_one() -> None:
    """Each of another mesh; the edge in the middle is of all four."""
    corners = ((0, 0), (1, 0), (0, 1), (1, 1))
    counts = ((2, 2, 2), (3, 3, 2), (3, 2, 3), (2, 1, 2))
    meshes = [box("hex20", (x, y, 0), (x + 1, y + 1, 1), n) for (x, y), n in zip(corners, counts, strict=True)]
    four = joined(*meshes, pairs=((0, 1), (0, 2), (1, 3), (2, 3)))
    one = joined(box("hex20", (0, 0, 0), (2, 2, 1), (4, 4, 2)), pairs=())
    assert elastic(four, 6) == pytest.approx(elastic(one, 6), rel=0.015)  # cells of a third of a metre to a metre


def test_a_block_in_a_corner_of_two_planes_is_joined_to_both() -> None:
    """An L of two boxes and a third in its corner: both faces of it, the edge between them once."""
    lower, upright = box("hex20", (0, 0, 0), (3, 1, 1), (6, 2, 2)), box("hex20", (0, 0, 1), (1, 1, 3), (2, 2, 4))
    cells = {"hex20": np.concatenate([lower.cells["hex20"], upright.cells["hex20"] + len(lower.points)])}
    points = np.concatenate([lower.points, upright.points])
    _, first, number = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    cells = {"hex20": number.ravel()[cells["hex20"]]}
    corner = ImportedMesh("l.msh", points[first], np.arange(len(first)), cells, {"hex20": np.arange(40)}, {})
    unlike = joined(corner, box("hex20", (1, 0, 1), (2, 1, 2), (3, 3, 3)))
    assert np.abs(rigid_rows(unlike)).max() < 1e-12  # rounding
    same = joined(corner, box("hex20", (1, 0, 1), (2, 1, 2), (2, 2, 2)))
    assert elastic(unlike, 6) == pytest.approx(elastic(same, 6), rel=0.02)  # cells of half a metre
