"""Joints along circles of other polygons: rings in rings, tubes on rings, tubes on tubes, against equal polygons.

Chords of one polygon are up to r (1 - cos(pi / n)) off those of the other, inside or outside of its cells.
"""

from __future__ import annotations

import numpy as np
import pytest

import femstruct as fs
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.model import Model
from femstruct.parts.joint_findings import joint_open_findings

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)


def ring(radii: tuple[float, float], rows: int, n: int, z: tuple[float, float] = (0.0, 0.0), turn: float = 0.0):
    """A ring, cone or tube between two circles of n chords each; turn : of its first node [rad]."""
    r, height = np.linspace(*radii, rows + 1)[:, None], np.linspace(*z, rows + 1)[:, None]
    angle = turn + np.arange(n) * 2.0 * np.pi / n
    points = np.stack([r * np.cos(angle), r * np.sin(angle), height + 0.0 * angle], axis=-1).reshape(-1, 3)
    k = np.arange((rows + 1) * n).reshape(rows + 1, n)
    cells = np.stack([k[:-1], k[1:], np.roll(k[1:], -1, 1), np.roll(k[:-1], -1, 1)], axis=-1).reshape(-1, 4)
    numbers = {"quad4": np.arange(len(cells))}
    return ImportedMesh("r.msh", points, np.arange(len(points)), {"quad4": cells}, numbers, {})


def joined(one: ImportedMesh, other: ImportedMesh) -> Model:
    parts = fs.Shell("one", one, STEEL, 0.01), fs.Shell("other", other, STEEL, 0.01)
    return fs.mesh_structure(fs.Structure("s", parts, (fs.Joint("line", "one", "other"),)))


def inner(n: int, turn: float = 0.0) -> ImportedMesh:
    return ring((0.2, 0.5), 4, n, turn=turn)


def tube(n: int, turn: float = 0.0) -> ImportedMesh:
    return ring((0.5, 0.5), 6, n, (0.0, 1.0), turn)


def outer(n: int, turn: float = 0.0) -> ImportedMesh:
    return ring((0.5, 1.0), 5, n, turn=turn)


def above(n: int, turn: float = 0.0) -> ImportedMesh:
    return ring((0.5, 0.5), 5, n, (1.0, 2.0), turn)


@pytest.mark.parametrize("shapes", [(inner, outer), (tube, outer), (tube, above)], ids=["rings", "tube", "tubes"])
@pytest.mark.parametrize(
    ("one", "two", "turn", "beside"),
    [(16, 24, 0.0, 0.03), (24, 16, 0.07, 0.03), (12, 40, 0.05, 0.03), (32, 48, 0.03, 0.01), (48, 32, 0.03, 0.01)],
)
def test_circles_of_other_chords_are_joined_all_along(shapes, one: int, two: int, turn: float, beside: float) -> None:
    """A tube of 12 chords on a ring of 40 was 10 % too low, and tubes of two turned meshes were refused."""
    model = joined(shapes[0](one), shapes[1](two, turn))
    points = model.mesh.points
    motions = np.zeros((len(points), 7, 6))
    motions[:, :6] = np.eye(6)
    for axis in range(3):
        motions[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], points)
    assert np.abs(model.ties[0].rows @ motions.reshape(-1, 6)).max() < 1e-12  # rounding
    assert joint_open_findings(model) == ()
    basis, *same = (
        fs.modal_basis(fs.assemble(some), count=10)
        for some in (model, joined(shapes[0](one), shapes[1](one)), joined(shapes[0](two), shapes[1](two)))
    )
    assert basis.n_rigid == 6
    low, high = (at_end([some.frequency_hz[6:] for some in same], axis=0) for at_end in (np.min, np.max))
    # Between those of equal polygons of either number of chords, and a share beside them that falls as its square.
    assert (basis.frequency_hz[6:] > (1.0 - beside) * low).all()
    assert (basis.frequency_hz[6:] < (1.0 + beside) * high).all()


def test_a_corner_is_no_curve() -> None:
    """Squares 20 mm apart, which are no chords of one circle: what lies beside their corners is not joined."""
    with pytest.raises(fs.InputError, match="without a common node"):
        joined(inner(4), ring((0.5 + 0.02 * np.sqrt(2.0), 1.0), 3, 4))


def solid_ring(radii: tuple[float, float], n: int, rows: int) -> ImportedMesh:
    flat = ring(radii, 2, n)
    layers = np.linspace(0.0, 0.3, rows + 1)
    points = np.concatenate([flat.points + np.array([0.0, 0.0, z]) for z in layers])
    quads, count = flat.cells["quad4"], len(flat.points)
    cells = np.concatenate([np.hstack([quads + k * count, quads + (k + 1) * count]) for k in range(rows)])
    return ImportedMesh("s.msh", points, np.arange(len(points)), {"hex8": cells}, {"hex8": np.arange(len(cells))}, {})


def test_curved_faces_of_solids_of_other_chords_are_open_and_said_with_their_area() -> None:
    """Every third node of 24 coincides with every second of 16: the rest was open without a word."""
    parts = tuple(
        fs.Solid(name, solid_ring(radii, n, 2), STEEL)
        for name, radii, n in (("one", (0.2, 0.5), 16), ("other", (0.5, 1.0), 24))
    )
    model = fs.mesh_structure(fs.Structure("s", parts, (fs.Joint("face", "one", "other", kind="pinned"),)))
    (found, *_) = joint_open_findings(model)
    assert found.code == "joint-open" and found.severe
    side = 16 * 2.0 * 0.5 * np.sin(np.pi / 16) * 0.3
    assert found.values["open_m2"] == pytest.approx(side, rel=0.05)  # seen at 64 places of each cell
