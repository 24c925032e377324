"""Cells that a part takes from a mesh: quadratic ones are cut, normals agree, sets and boxes are found."""

from __future__ import annotations

import numpy as np
import pytest

from femstruct.errors import InputError
from femstruct.model.flat_cells import area_vectors, flat_cells, nodes_at_one_place
from femstruct.model.imported_mesh import KINDS, ImportedMesh
from femstruct.model.regions import Region
from femstruct.model.shell_cells import nearest_places

CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])[[0, 1, 3, 2, 4, 5, 7, 6]]


def mesh_of(points: object, cells: dict[str, object], **more: object) -> ImportedMesh:
    points, first, numbers = np.asarray(points, float), 1, {}
    for kind, some in cells.items():
        numbers[kind] = np.arange(first, first + len(np.asarray(some)))
        first += len(numbers[kind])
    return ImportedMesh("a", points, np.arange(1, len(points) + 1), cells, numbers, **more)  # type: ignore[arg-type]


def test_normals_of_a_closed_patch_point_outwards_however_its_cells_are_numbered() -> None:
    faces = np.array(KINDS["hex8"].faces)
    rng = np.random.default_rng(3)
    for _ in range(20):
        turned = np.array([face if rng.random() < 0.5 else face[::-1] for face in faces])
        quads, triangles = turned[:4], np.array([piece for f in turned[4:] for piece in (f[[0, 1, 2]], f[[0, 2, 3]])])
        cells = flat_cells(mesh_of(CUBE, {"quad4": quads, "tri3": triangles}), None)
        outwards = cells.points[cells.corners].mean(axis=1) - 0.5
        assert (np.einsum("mi,mi->m", outwards, area_vectors(cells.points, cells.corners)) > 0).all()
        assert cells.two_sided and set(cells.patches) == {0}


def test_an_open_patch_keeps_the_sides_of_the_greater_area_and_patches_are_apart() -> None:
    strip = [[x, y, 0.0] for x in (0.0, 1.0, 3.0) for y in (0.0, 1.0)]
    far = [[x, y, 5.0] for x in (0.0, 1.0) for y in (0.0, 1.0)]
    quads = [[0, 2, 3, 1], [2, 3, 5, 4], [6, 7, 9, 8]]  # up, down and larger, down
    cells = flat_cells(mesh_of(strip + far, {"quad4": quads}), None)
    assert area_vectors(cells.points, cells.corners)[:, 2].tolist() == [-1.0, -2.0, -1.0]
    assert cells.turned.tolist() == [1, 0, 0]
    assert cells.patches.tolist() == [0, 0, 1]
    assert cells.held_together().tolist() == [0] * 6 + [1] * 4


def test_a_strip_of_moebius_has_no_two_sides() -> None:
    count = 12
    angle = 2.0 * np.pi * np.arange(count) / count
    across = np.stack([np.cos(angle / 2) * np.cos(angle), np.cos(angle / 2) * np.sin(angle), np.sin(angle / 2)], axis=1)
    middle = 3.0 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([middle + across, middle - across])
    near, far = np.arange(count), count + np.arange(count)
    ahead, beyond = np.roll(near, -1), np.roll(far, -1)
    ahead[-1], beyond[-1] = far[0], near[0]  # half a turn: the edges change places
    assert not flat_cells(mesh_of(points, {"quad4": np.stack([near, ahead, beyond, far], axis=1)}), None).two_sided


def test_three_cells_at_one_edge_are_three_patches() -> None:
    """Where a web stands on a flange no side of one is that of another."""
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, -1, 0], [0, -1, 0], [1, 0, 1], [0, 0, 1]]
    quads = [[0, 1, 2, 3], [0, 1, 4, 5], [0, 1, 6, 7]]
    cells = flat_cells(mesh_of(points, {"quad4": quads}), None)
    assert cells.patches.tolist() == [0, 1, 2]
    # but the two that go on in one plane, over the third, are turned alike: here one of them, of equal areas
    vectors = area_vectors(cells.points, cells.corners)
    assert vectors[0, 2] == vectors[1, 2] and cells.turned[2] == 0 and cells.turned[:2].sum() == 1


@pytest.mark.parametrize("kind", ["tri6", "quad8", "quad9"])
def test_a_quadratic_cell_is_cut_where_its_nodes_are(kind: str) -> None:
    """On an arch whose middle nodes are off the straight edges: the cut keeps them, so its area is larger."""
    of = KINDS[kind]
    flat = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])[: of.corners]
    nodes = [*flat, *(flat[list(edge)].mean(axis=0) for edge in of.edges), flat.mean(axis=0)][: of.nodes]
    x, y = np.array(nodes).T
    points = np.column_stack([x, y, x * (2.0 - x)])
    cells = flat_cells(mesh_of(points, {kind: [np.arange(of.nodes)]}), None)
    assert len(cells.corners) == 4
    plan = area_vectors(cells.points, cells.corners)[:, 2]
    # rounding: the plan is that of the whole cell
    assert plan.min() > 0 and plan.sum() == pytest.approx(2.0 if of.corners == 3 else 4.0, rel=1e-15)
    assert cells.points[:, 2].max() == 1.0  # the middle of the arch is there, of a quad8 too
    assert (cells.rows == -1).sum() == (kind == "quad8")


def test_sets_and_boxes_find_nodes_and_cells() -> None:
    points = [[x, y, 0.0] for x in (0.0, 1.0, 2.0) for y in (0.0, 1.0)]
    sets = {"left": {"quad4": [0]}, "right": {"tri3": [0, 1]}, "edge": {"line2": [0]}}
    cells = {"line2": [[0, 1]], "quad4": [[0, 2, 3, 1]], "tri3": [[2, 4, 5], [2, 5, 3]]}
    mesh = mesh_of(points, cells, cell_sets=sets, node_sets={"foot": [5]})
    found = flat_cells(mesh, None)
    assert found.in_set(mesh, "left").tolist() == [True, False, False]
    named = {name: found.nodes_within(mesh, Region("set", named=name), 0.0).tolist() for name in mesh.set_names}
    assert named == {"left": [0, 1, 2, 3], "right": [2, 3, 4, 5], "edge": [0, 1], "foot": [5]}
    box = Region("box", box=((2.1, 1.1, 0.1), (0.9, 0.9, -0.1)))
    assert found.nodes_within(mesh, box, 0.0).tolist() == [3, 5]
    right = flat_cells(mesh, "right")
    assert len(right.points) == 4 and len(right.quads) == 0
    assert right.nodes_within(mesh, Region("set", named="edge"), 0.0).tolist() == []
    with pytest.raises(InputError, match="'edge', a set without triangles or quadrilaterals"):
        flat_cells(mesh, "edge")


def test_nodes_at_one_place_that_are_two_are_found() -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 1e-9]]
    cells = flat_cells(mesh_of(points, {"quad4": [[0, 1, 2, 3], [4, 5, 6, 7]]}), None)
    assert sorted(map(sorted, nodes_at_one_place(cells.points, 1e-6).tolist())) == [[1, 4], [2, 7]]


def test_the_nearest_place_is_nearer_than_every_sample_of_every_cell() -> None:
    """Cells of very different sizes, in which one whose middle is far may be nearest; each sampled 61 by 61 times."""
    x = np.array([0.0, 0.1, 0.2, 3.0, 3.1])
    points = np.array([[a, b, 0.3 * a] for a in x for b in (0.0, 0.2, 2.0)])
    quads = np.array([[3 * i + j, 3 * i + j + 3, 3 * i + j + 4, 3 * i + j + 1] for i in range(4) for j in range(2)])
    triangles = np.concatenate([quads[-2:, :3], quads[-2:][:, [0, 2, 3]]])
    cells = flat_cells(mesh_of(points, {"quad4": quads[:-2], "tri3": triangles}), None)
    s, t = (one.ravel() for one in np.meshgrid(*[np.linspace(0.0, 1.0, 61)] * 2))
    weights = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1)
    samples = np.einsum("pk,nki->npi", weights, cells.points[cells.corners]).reshape(-1, 3)
    places = np.random.default_rng(2).uniform([-1.0, -1.0, -1.0], [4.0, 3.0, 2.0], (200, 3))
    found = nearest_places(cells, places)
    for at, position in zip(places, found.positions, strict=True):
        sampled = np.linalg.norm(samples - at, axis=1).min()
        off = float(np.linalg.norm(position - at))
        assert off <= sampled + 1e-12  # rounding
        assert off >= sampled - 0.06  # samples are 0.05 m apart in the largest cell
