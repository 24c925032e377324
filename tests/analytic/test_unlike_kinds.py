"""A wall inside of the cells of a floor, and a rib between lines of cells: order of convergence, and balance of power.

Cells do not have the kinks that a line load makes inside of them, which costs an energy in proportion to their size:
order one, and frequencies from above. Parts that lose by factors of their own balance whatever the mesh.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import csr_array

import femstruct as fs
from femstruct.model.model import Model
from femstruct.model.sections import rectangle

Array = NDArray[np.float64]
WOOD = fs.Material("wood", E=11e9, nu=0.3, rho=450.0)
CONCRETE = fs.Material("concrete", E=30e9, nu=0.2, rho=2400.0)
WALL_AT = 4.0 / 3.0  # m: a third of a cell beside a line of cells of 0.8 m and every half of it
RIB_AT = 8.0 / 15.0  # m: a third of a cell beside a line of cells of 0.1 m and every half of it


def outline(a: float, b: float) -> tuple[tuple[float, float], ...]:
    return (0.0, 0.0), (a, 0.0), (a, b), (0.0, b)


def wall_on_floor(mesh: float, unlike: bool) -> Model:
    """A floor of 4 m x 3 m, held at its rim, and a wall of 3 m x 2 m; their nodes coincide or not."""
    through = () if unlike else ((WALL_AT, 0.0),)
    floor = fs.Slab("floor", CONCRETE, 0.2, outline(4.0, 3.0), mesh=mesh, through=through)
    turned = {"origin": (WALL_AT, 0.0, 0.0), "normal": (1.0, 0.0, 0.0), "x_direction": (0.0, 1.0, 0.0)}
    wall = fs.Slab("wall", CONCRETE, 0.15, outline(3.0, 2.0), mesh=0.8 * mesh if unlike else mesh, **turned)  # type: ignore[arg-type]
    return held((floor, wall), "floor", "wall")


def ribbed(mesh: float, unlike: bool) -> Model:
    """A floor of 2 m x 1.2 m with a rib under it, along it and eccentric."""
    through = () if unlike else ((1.0, RIB_AT),)
    floor = fs.Slab("floor", WOOD, 0.04, outline(2.0, 1.2), mesh=mesh, through=through)
    under = (0.0, 0.0, -0.07)
    line = (((0.0, RIB_AT, 0.0), (2.0, RIB_AT, 0.0)),)
    section = rectangle("b", 0.06, 0.1)
    rib = fs.Frame("rib", WOOD, section, line, mesh=mesh, start_offset=under, end_offset=under)
    return held((floor, rib), "floor", "rib")


def held(parts: tuple[fs.Slab | fs.Frame, ...], floor: str, other: str) -> Model:
    rim = fs.Support("rim", "simple hard", on=floor, region=fs.Region("set", named="rim"))
    joint = fs.Joint("line", other, floor)
    return fs.mesh_structure(fs.Structure("unlike", parts, (joint,), supports=(rim,)))


def first(model: Model, mode: int) -> float:
    basis = fs.modal_basis(fs.assemble(model), count=mode + 2)
    return float(basis.frequency_hz[basis.modes][mode])


@pytest.mark.parametrize(
    ("build", "mode", "meshes", "fine"),
    [
        (wall_on_floor, 0, (0.8, 0.4, 0.2), 0.1),
        (wall_on_floor, 1, (0.8, 0.4, 0.2), 0.1),
        (ribbed, 2, (0.2, 0.1, 0.05), 0.025),
    ],
)
def test_a_line_inside_of_cells_converges_to_one_on_lines_of_cells(build, mode: int, meshes, fine: float) -> None:
    """From above, and at each halving to 0.7 of what it was or less: order one is 0.5, beside the error of elements."""
    right = first(build(fine, unlike=False), mode)
    errors = np.array([first(build(mesh, unlike=True), mode) / right - 1.0 for mesh in meshes])
    assert (errors > 0.0).all()
    assert (errors[1:] < 0.7 * errors[:-1]).all()
    assert errors[-1] < 0.015  # measured: 0.2 m for waves of 3 m


@pytest.mark.parametrize("build", [wall_on_floor, ribbed])
def test_power_that_goes_in_is_lost_in_both_parts_and_goes_through_the_joint(build) -> None:
    """A force on the floor, loss factors of 2 % and 7 %: what the joint takes from one it gives to the other, and its
    forces have no sum and no moment. Dense, with matrices of each part alone."""
    model = build({wall_on_floor: 0.5, ribbed: 0.2}[build], unlike=True)
    losses = {"floor": 0.02, "wall": 0.07, "rib": 0.07}
    n = 7 * model.mesh.n_nodes
    parts: dict[str, tuple[Array, Array]] = {}
    for name, part in model.parts.items():
        own, (K, M) = part.dofs(), part.stiffness_and_mass()
        components = 7 * part.first + own.rows
        onto = csr_array((own.values, (own.columns, components)), shape=(own.count, n))
        assert K is not None
        parts[name] = (onto.T @ K @ onto).toarray(), (onto.T @ M @ onto).toarray()
    T = fs.assemble(model).dofs.T.toarray()
    force = np.zeros(n)
    at = np.linalg.norm(model.mesh.points - np.array([1.0, 1.0, 0.0]), axis=1)
    force[7 * int(at.argmin()) + 2] = 1.0
    points = model.mesh.points
    rigid = np.zeros((len(points), 7, 6))
    rigid[:, :6] = np.eye(6)
    for axis in range(3):
        rigid[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], points)
    other = model.structure.joints[0].a
    of_other = np.repeat(np.isin(np.arange(len(points)), model.parts[other].nodes), 7)
    for hertz in (15.0, 60.0, 170.0):
        omega = 2.0 * np.pi * hertz
        dynamic = {name: K * (1.0 + 1j * losses[name]) - omega**2 * M for name, (K, M) in parts.items()}
        whole = sum(dynamic.values())
        moved = T @ np.linalg.solve(T.T @ whole @ T, T.T @ force)
        goes_in = 0.5 * omega * np.imag(moved.conj() @ force)
        lost = {name: 0.5 * omega * losses[name] * np.real(moved.conj() @ K @ moved) for name, (K, _) in parts.items()}
        assert goes_in / sum(lost.values()) == pytest.approx(1.0, rel=1e-8)  # rounding of a dense solution
        on_other = dynamic[other] @ moved  # all that acts on it but its inertia: the joint alone
        assert np.abs(on_other[~of_other]).max() == 0.0
        tie = model.ties[-1].rows.toarray()
        multipliers = np.linalg.lstsq(tie[:, of_other].T, on_other[of_other], rcond=None)[0]
        left = tie[:, of_other].T @ multipliers - on_other[of_other]
        assert np.abs(left).max() < 1e-7 * np.abs(on_other).max()  # rounding of least squares
        forces = tie.T @ multipliers  # on both sides
        through = 0.5 * omega * np.imag(moved.conj()[of_other] @ forces[of_other])
        back = 0.5 * omega * np.imag(moved.conj()[~of_other] @ forces[~of_other])
        assert through / lost[other] == pytest.approx(1.0, rel=1e-6)  # rounding of least squares
        assert back / through == pytest.approx(-1.0, rel=1e-6)  # the same
        assert np.abs(rigid.reshape(n, 6).T @ forces).max() < 1e-9 * np.abs(forces).sum()  # rounding of rows
