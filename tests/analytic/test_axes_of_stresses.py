"""Stresses and their local axes together are the stress in space, however a part lies and its cells are numbered."""

from __future__ import annotations

import numpy as np
import pytest

import femstruct as fs
from femstruct.impact.fatigue import counted_on_planes
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.sections import rectangle

E, NU = 210e9, 0.3
STEEL = fs.Material("steel", E=E, nu=NU, rho=7850.0)
A, B = np.array([0.6, 0.64, 0.48]), np.array([-0.8, 0.48, 0.36])  # unit, at right angles
N = np.cross(A, B)
PULLED = np.cos(0.4) * A + np.sin(0.4) * B  # in their plane
STRAIN = 1e-4


def cells(kind: str) -> ImportedMesh:
    """A patch in the plane of A and B: four distorted quadrilaterals, one of them turned over two corners, or eight
    triangles."""
    u = np.array([[0, 0], [0.5, 0.05], [1, 0], [0, 0.5], [0.55, 0.45], [1, 0.52], [0, 1], [0.47, 1], [1, 1]])
    quads = np.array([[0, 1, 4, 3], [2, 5, 4, 1], [7, 6, 3, 4], [4, 5, 8, 7]])
    own = quads if kind == "quad4" else np.concatenate([quads[:, [0, 1, 2]], quads[:, [2, 3, 0]]])
    return ImportedMesh("mesh", u @ [A, B], np.arange(1, 10), {kind: own}, {kind: np.arange(1, len(own) + 1)}, {})


def shell(kind: str, turned: bool = False) -> fs.Shell:
    """turned : of a material that has directions, along which its stresses are, and is as stiff along all of them."""
    if not turned:
        return fs.Shell("part", cells(kind), STEEL, thickness=0.01)
    G = E / (2 * (1 + NU))
    alike = fs.Orthotropic("alike", E=(E,) * 3, G=(G,) * 3, nu=NU, rho=7850.0)
    return fs.Shell("part", cells(kind), alike, thickness=0.01, orientation=tuple(A + 2.0 * B + N))


PLATE = fs.Plate(
    "part", STEEL, 0.01, (0.0, 0.0, 0.0), (1.0, 1.0), 0.5, normal=tuple(N), x_direction=tuple(A), in_plane="elastic"
)
FRAME = fs.Frame("part", STEEL, rectangle("s", 0.01, 0.02), (((0.0, 0.0, 0.0), tuple(PULLED)),), mesh=0.5)


@pytest.mark.parametrize(
    "part",
    [shell("quad4"), shell("tri3"), shell("quad4", turned=True), shell("tri3", turned=True), PLATE, FRAME],
    ids=["quads", "triangles", "turned quads", "turned triangles", "plate", "frame"],
)
def test_a_part_that_is_stretched_along_a_direction(part: fs.Part) -> None:
    """u = strain (d . x) d: E / (1 - nu^2) (d d + nu m m) strain in a plane, m across d; E strain in a bar. The plane
    of the largest normal stress is the one normal to d, within the 5 degrees between the planes that are looked at."""
    model = fs.mesh_structure(fs.Structure("p", (part,)))
    places = model.parts["part"].stresses(model.mesh.n_nodes)
    u = np.zeros((model.mesh.n_nodes, 7, 1))
    u[:, :3, 0] = STRAIN * (model.mesh.points @ PULLED)[:, None] * PULLED
    found = places.of(u)[:, :, 0]
    local = np.zeros((len(found), 3, 3))
    for i, name in enumerate(places.components):
        a, b = ("xyz".index(axis) for axis in name)
        local[:, a, b] = local[:, b, a] = found[:, i]
    assert places.axes is not None
    whole = np.swapaxes(places.axes, 1, 2) @ local @ places.axes
    across = np.cross(N, PULLED)
    flat = E * STRAIN / (1 - NU**2) * (np.outer(PULLED, PULLED) + NU * np.outer(across, across))
    expected = E * STRAIN * np.outer(PULLED, PULLED) if isinstance(part, fs.Frame) else flat
    np.testing.assert_allclose(
        whole, np.tile(expected, (len(whole), 1, 1)), atol=1e-6 * E * STRAIN
    )  # drilling, rounding
    t = np.sin(np.linspace(0.0, 20.0, 201))
    for i in (0, len(found) - 1):
        one = places.at(i)
        told = counted_on_planes("s", found[i][:, None] * t, one.components, None, "here", axes=one.axes[0])  # type: ignore[index]
        normal = np.array([float(x) for x in told.on.partition("(")[2].rstrip(")").split(",")])
        assert abs(normal @ PULLED) > np.cos(np.radians(2.5)) - 0.02  # half the 5 degrees; two digits
