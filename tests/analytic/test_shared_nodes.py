"""Parts of one mesh file that share nodes are as one part of all cells; shells turn on solids, and it is said."""

from __future__ import annotations

import numpy as np
import pytest

import femstruct as fs
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.model import Model
from femstruct.parts.joint_findings import shared_node_findings

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)


def strip() -> ImportedMesh:
    """A sheet of 1 m x 0.5 m in 8 x 4 cells, its halves the sets "a" and "b", the edge x = 0 "held"."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(0.0, 0.5, 5), indexing="ij")
    n = np.arange(45).reshape(9, 5)
    cells = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
    points = np.stack([x, y, 0.0 * x], axis=-1).reshape(-1, 3)
    sets = {"a": {"quad4": np.arange(16)}, "b": {"quad4": np.arange(16, 32)}}
    return ImportedMesh(
        "s.inp", points, n.ravel() + 1, {"quad4": cells}, {"quad4": np.arange(32)}, {"held": n[0]}, sets
    )


def sheets(*names: str | None, joints: tuple[fs.Joint, ...] = ()) -> Model:
    mesh = strip()
    parts = tuple(fs.Shell(f"p{i}", mesh, STEEL, 0.01, named=name) for i, name in enumerate(names))
    held = fs.Support("rest", "clamped", on="p0", region=fs.Region("set", named="held"))
    return fs.mesh_structure(fs.Structure("s", parts, joints, supports=(held,)))


def codes(model: Model) -> dict[str, bool]:
    return {one.code: one.severe for one in shared_node_findings(model)}


def test_two_sets_of_a_file_are_one_part() -> None:
    """They were two pieces, one of them free."""
    two, one = sheets("a", "b"), sheets(None)
    found, right = (fs.modal_basis(fs.assemble(model), count=6).frequency_hz for model in (two, one))
    assert found == pytest.approx(right, rel=1e-8)  # rounding of eigenvalues
    assert codes(two) == {"parts-share-nodes": False} and codes(one) == {}
    rest = fs.statics(two, fs.assemble(two), [], weight=True)
    assert abs(rest.forces["p0 and p1"][2]) == pytest.approx(9.80665 * 7850.0 * 0.01 * 0.25, rel=1e-9)  # half of it


def test_a_joint_takes_the_place_of_shared_nodes() -> None:
    """A hinge where one is written: the outer half falls, one motion without stiffness."""
    hinged = sheets("a", "b", joints=(fs.Joint("hinge", "p0", "p1", kind="pinned"),))
    assert codes(hinged) == {} and {tie.name for tie in hinged.ties} == {"rest", "hinge"}
    assert fs.modal_basis(fs.assemble(hinged), count=3).n_rigid == 1


def fin(rows_on: int, up: bool) -> ImportedMesh:
    """A cube of 0.1 m in 4 x 4 x 4 cells and a sheet of 0.3 m from the middle of its top on, so many rows of cells of
    which lie on it before it goes on, upwards or along."""
    line = np.linspace(0.0, 0.1, 5)
    grid = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1)
    n = np.arange(125).reshape(5, 5, 5)
    steps = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cubes = np.stack([n[a : a + 4, b : b + 4, c : c + 4] for a, b, c in steps], axis=-1).reshape(-1, 8)
    start = 4 - rows_on
    more = np.arange(1, 6) * 0.05
    beyond = [[(0.1, y, 0.1 + s) if up else (0.1 + s, y, 0.1) for y in line] for s in more]
    rows = np.concatenate([n[start:, :, 4], 125 + np.arange(25).reshape(5, 5)])
    sheet = np.stack([rows[:-1, :-1], rows[1:, :-1], rows[1:, 1:], rows[:-1, 1:]], axis=-1).reshape(-1, 4)
    points = np.concatenate([grid.reshape(-1, 3), np.array(beyond).reshape(-1, 3)])
    cells = {"hex8": cubes, "quad4": sheet}
    return ImportedMesh(
        "f.bdf", points, np.arange(150), cells, {kind: np.arange(len(c)) for kind, c in cells.items()}, {}
    )


def on_cube(mesh: ImportedMesh, *joints: fs.Joint) -> Model:
    parts = fs.Solid("cube", mesh, STEEL), fs.Shell("fin", mesh, STEEL, 0.002)
    return fs.mesh_structure(fs.Structure("s", parts, joints))


@pytest.mark.parametrize("up", [False, True])
def test_a_shell_on_a_line_of_a_solid_is_a_hinge_and_one_that_lies_on_it_is_not(up: bool) -> None:
    """Seven motions without stiffness against six, and the length of the hinge: the side of the cube."""
    hinge = on_cube(fin(0, up))
    (remark, found) = shared_node_findings(hinge)
    assert remark.code == "parts-share-nodes" and not remark.severe
    assert found.code == "shared-nodes-hinge" and found.severe
    assert found.values["length_m"] == pytest.approx(0.1, rel=1e-12)  # rounding
    assert fs.modal_basis(fs.assemble(hinge), count=9).n_rigid == 7
    lying = on_cube(fin(2, up))
    assert codes(lying) == {"parts-share-nodes": False}
    assert fs.modal_basis(fs.assemble(lying), count=8).n_rigid == 6
    held = on_cube(fin(0, up), fs.Joint("weld", "fin", "cube"))
    assert codes(held) == {} and fs.modal_basis(fs.assemble(held), count=8).n_rigid == 6
