"""Rows of many nodes at once, against plain loops: turns of the surface of a solid, and rigid links to nodes."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import numpy as np
import pytest

import femstruct as fs
from femstruct.conventions import DIRECTIONS
from femstruct.elements import solid
from femstruct.errors import InputError
from femstruct.model.imported_mesh import ImportedMesh

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
COUNTS, SIZE = (4, 3, 2), (0.5, 0.3, 0.2)
SHIFT = fs.Region("box", box=((-1.0, -1.0, -1.0), (0.001, 1.0, 1.0)))  # the end at x = 0
REACH = 1e-9


def bricks(kind: str) -> ImportedMesh:
    """A box of warped hexahedra, or of tetrahedra, six in each cube, whose nodes have 3 to 6 facets."""
    lines = [np.arange(n + 1) for n in COUNTS]
    whole = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    number = {tuple(place): row for row, place in enumerate(whole.tolist())}
    cubes = [place for place in whole.tolist() if all(x < n for x, n in zip(place, COUNTS, strict=True))]
    if kind == "hex8":
        steps = np.rint(solid.reference_nodes("hex8")).astype(int)
        cells = [[number[tuple(cube + step)] for step in steps] for cube in np.array(cubes)]
    else:
        cells = []
        for cube in np.array(cubes):
            for order in permutations(np.eye(3, dtype=int)):
                ends = [number[tuple(cube + step)] for step in np.cumsum([np.zeros(3, int), *order], axis=0)]
                even = np.linalg.det(np.array(order)) > 0
                cells.append(ends if even else [ends[0], ends[2], ends[1], ends[3]])
    places = whole / COUNTS * SIZE
    places[:, 2] += 0.05 * places[:, 0] ** 2 + 0.1 * places[:, 0] * places[:, 1]
    rows = np.arange(len(whole))
    return ImportedMesh("bricks", places, 1 + rows, {kind: cells}, {kind: np.arange(1, len(cells) + 1)})


def meshed(kind: str, *constraints: fs.RigidLink) -> Any:
    """The box, and a shell of two warped cells beside it with a point in one of them."""
    corners = [[1, 0, 0], [1.5, 0, 2e-3], [2, 0, 0], [1, 0.6, 2e-3], [1.4, 0.5, 0], [2, 0.5, 4e-3]]
    cells = {"quad4": [[0, 1, 4, 3], [1, 2, 5, 4]]}
    tray = fs.Shell("tray", ImportedMesh("tray", corners, range(6), cells, {"quad4": [1, 2]}), STEEL, 5e-3)
    spot = fs.PlaceOn("spot", "tray", at=((1.225, 0.275, 1e-3),))
    parts = (fs.Solid("box", bricks(kind), STEEL), tray)
    return fs.mesh_structure(fs.Structure("a", parts, points=(spot,), constraints=constraints))


@pytest.mark.parametrize("kind", ["hex8", "tet4"])
def test_turns_of_a_surface_are_those_fitted_node_by_node(kind: str) -> None:
    """Of a motion that is no rigid one: least squares over all nodes that share a facet with each node."""
    model = meshed(kind)
    part, points = model.parts["box"], model.mesh.points
    outside = np.unique(part.quads)
    nodes = np.concatenate([outside[::-2], outside[:3], outside[:3]])  # in no order, some of them twice
    motion = np.zeros((model.mesh.n_nodes, 7))
    motion[:, :3] = np.random.default_rng(1).normal(size=(len(points), 3))
    fitted = []
    for node in nodes:
        around = sorted({int(other) for facet in part.quads if node in facet for other in facet})
        off = points[around] - points[around].mean(axis=0)
        moved = motion[around, :3] - motion[around, :3].mean(axis=0)
        turns = np.concatenate([[[0, z, -y], [-z, 0, x], [y, -x, 0]] for x, y, z in off])
        fitted.append(np.linalg.lstsq(turns, moved.ravel(), rcond=None)[0])
    found = (part.turned(nodes, model.mesh.n_nodes) @ motion.ravel()).reshape(-1, 3)
    assert found == pytest.approx(np.array(fitted), rel=1e-10, abs=1e-10 * np.abs(fitted).max())  # rounding of two fits


def test_a_node_inside_has_no_surface() -> None:
    model = meshed("hex8")
    part = model.parts["box"]
    inside = np.setdiff1d(part.nodes, part.quads)
    assert len(inside) == 3 * 2 * 1
    with pytest.raises(InputError, match=r"parts\.box: got a joint with a node inside it, expected one on its faces"):
        part.turned(np.append(part.quads[0], inside[:1]), model.mesh.n_nodes)


@pytest.mark.parametrize("directions", [DIRECTIONS, ("z", "x", "ry"), ("y",)])
@pytest.mark.parametrize("on", ["box", "tray"])
def test_rows_of_a_rigid_link_are_those_of_its_nodes_one_by_one(on: str, directions: tuple[str, ...]) -> None:
    """Each node less the point on its rigid arm, for a point within a cell and nodes with rotations and without."""
    region = SHIFT if on == "box" else fs.Region("whole")
    model = meshed("hex8", fs.RigidLink("link", "spot", on=on, of=region, directions=directions))
    (tie,) = model.ties
    point, part, n_nodes = model.points["spot"], model.parts[on], model.mesh.n_nodes
    motion = {one: point.probe(one).row(n_nodes).toarray()[0] for one in DIRECTIONS}
    turn = np.array([motion["rx"], motion["ry"], motion["rz"]])
    rows, forces = [], []
    for node in part.within("here", region, REACH):
        arm = model.mesh.points[node] - point.position
        for direction in directions if part.has_rotations else [one for one in directions if len(one) == 1]:
            number = DIRECTIONS.index(direction)
            row = motion[direction].copy()
            if number < 3:
                row += np.cross(turn, arm, axisa=0)[:, number]
            row[7 * node + number] -= 1.0
            rows.append(row)
            forces.append(np.eye(6, 3)[number])
    assert tie.rows.toarray() == pytest.approx(np.array(rows), abs=1e-14)  # rounding of products below 10
    assert np.array_equal(tie.directions, forces)
