"""What every assembly must be: symmetric, blind to rotation and numbering, with the mass of its parts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from femstruct.assembly.matrices import Assembly, assemble
from femstruct.errors import SingularSystem
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import model_facts, refine_model
from femstruct.model.regions import Region
from femstruct.model.sections import rectangle
from femstruct.model.structure import Joint, PlaceOn, Structure, Support, SurfaceOn
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.mass import Mass
from femstruct.parts.plate import Plate
from femstruct.parts.spring import Spring
from femstruct.parts.wave_findings import model_findings

ROUNDING = 1e-13  # rounding: 9e-16 here at most

STEEL = Material("steel", 206e9, 0.3, 7850.0)
ACRYLIC = Material("acrylic", 5.9e9, 0.35, 1171.875)
KINDS = ("hermite12", "acm12", "bfs16")


def table(kind: str = "bfs16", legs_first: bool = False) -> Structure:
    """A plate on a rim bar, four legs, and a second plate below on foam, with loose masses."""
    top = Plate("top", ACRYLIC, 0.005, (0.0, 0.0, 0.1), (0.4, 0.3), (3, 4), kind)
    base = Plate("base", STEEL, 0.02, (-0.1, -0.1, 0.0), (0.6, 0.5), 0.2, kind)
    corners = [(0.0, 0.0), (0.4, 0.0), (0.4, 0.3), (0.0, 0.3)]
    ring = tuple((x, y, 0.1) for x, y in [*corners, corners[0]])
    bar = Frame("bar", STEEL, rectangle("flat", 0.01, 0.006), (ring,), 0.03)
    legs = Frame(
        "legs", STEEL, rectangle("post", 0.012, 0.02), tuple(((x, y, 0.0), (x, y, 0.1)) for x, y in corners), 0.1
    )
    foam = Foundation("foam", "base", Region("rim", (0.5, 0.4)), 2e5, 7e4)
    added = Mass("added", 0.3, at="P")
    rim = Mass("rim", 2.0, on="base", region=Region("rim", (0.4, 0.3)), per="length")
    parts = (legs, base, bar, top, foam, added, rim) if legs_first else (top, base, bar, legs, foam, added, rim)
    return Structure(
        "table",
        parts,
        (Joint("bar on top", "bar", "top"), Joint("legs on top", "legs", "top"), Joint("legs on base", "base", "legs")),
        (PlaceOn("P", "top", ((0.1, 0.12),)), PlaceOn("Q", "top", ((0.17, 0.21),))),
        (SurfaceOn("ceiling", "base", "below", Region("rectangle", (0.5, 0.4))),),
    )


def turned(structure: Structure, turn: Rotation) -> Structure:
    """The structure rotated in space about the origin, its sections and plate axes with it."""

    def move(vector: tuple[float, ...]) -> tuple[float, float, float]:
        x, y, z = turn.apply(vector)
        return float(x), float(y), float(z)

    parts = []
    for part in structure.parts:
        if isinstance(part, Plate):
            x = part.x_direction or (1.0, 0.0, 0.0)
            part = replace(part, origin=move(part.origin), normal=move(part.normal), x_direction=move(x))
        elif isinstance(part, Frame):
            lines = tuple(tuple(move(point) for point in line) for line in part.lines)
            part = replace(
                part,
                lines=lines,
                orientation=move(part.orientation or (0.3, 0.2, 1.0)),
                start_offset=move(part.start_offset),
            )
        parts.append(part)
    return replace(structure, parts=tuple(parts), surfaces=())


def frequencies(assembly: Assembly) -> NDArray[np.float64]:
    values = eigh(assembly.K.toarray(), assembly.M.toarray(), eigvals_only=True)
    return np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi)


@pytest.mark.parametrize("kind", KINDS)
def test_rotation_in_space_changes_no_frequency(kind: str) -> None:
    upright = table(kind)
    parts = tuple(
        replace(part, orientation=(0.3, 0.2, 1.0)) if isinstance(part, Frame) else part for part in upright.parts
    )
    first = frequencies(assemble(mesh_structure(replace(upright, parts=parts))))
    turn = Rotation.from_rotvec([0.4, -0.7, 1.1])
    second = frequencies(assemble(mesh_structure(turned(upright, turn))))
    # A dense solver knows an eigenvalue to a few eps times the largest, 1e10 times the squares of the first ones; all
    # from the 20th of some 180 modes up are known to 1e-10, the low ones are compared on the scale of the 20th.
    assert np.abs(second - first)[:20].max() <= 1e-8 * first[20]
    assert np.abs(second / first - 1)[20:].max() <= 1e-9  # rounding: 3e-12 here


def test_rotation_of_a_plate_to_ten_digits() -> None:
    plate = Plate("p", ACRYLIC, 0.005, (0.1, 0.2, 0.3), (0.4, 0.3), (4, 4))
    supports = (Support("rim", "simple", "p", edge="all"),)
    first = frequencies(assemble(mesh_structure(Structure("a", (plate,), supports=supports))))
    there = turned(Structure("a", (plate,), supports=supports), Rotation.from_rotvec([0.4, -0.7, 1.1]))
    second = frequencies(assemble(mesh_structure(there)))
    assert second[:10] == pytest.approx(first[:10], rel=ROUNDING)


def test_order_of_parts_changes_no_frequency() -> None:
    first = frequencies(assemble(mesh_structure(table())))
    second = frequencies(assemble(mesh_structure(table(legs_first=True))))
    assert np.abs(second / first - 1).max() <= 1e-8  # dense solver, as above


@pytest.mark.parametrize("kind", KINDS)
def test_matrices_are_symmetric_and_parts_add_up(kind: str) -> None:
    assembly = assemble(mesh_structure(turned(table(kind), Rotation.from_rotvec([0.4, -0.7, 1.1]))))
    bed = Foundation("bed", "p", Region("whole"), 1e6, 1e5)
    plate = Plate("p", STEEL, 0.01, (0.0, 0.0, 0.0), (0.4, 0.3), (3, 2), kind, normal=(1.0, 2.0, 3.0))
    untied = assemble(mesh_structure(Structure("bed", (plate, bed))))
    for matrix in (assembly.K, assembly.M, assembly.C, untied.K, untied.M):
        assert abs(matrix - matrix.T).max() == 0.0
    total = sum(part.toarray() for part in assembly.part_stiffness.values())
    assert np.abs(total - assembly.K.toarray()).max() <= 1e-14 * np.abs(total).max()  # order of summation


def test_mass_is_the_sum_of_the_parts() -> None:
    model = mesh_structure(table())
    assembly = assemble(model)
    facts = model_facts(model)
    by_hand = {
        "top": 1171.875 * 0.005 * 0.4 * 0.3,
        "base": 7850 * 0.02 * 0.6 * 0.5,
        "bar": 7850 * 0.01 * 0.006 * 1.4,
        "legs": 7850 * 0.012 * 0.02 * 0.4,
        "added": 0.3,
        "rim": 2.0 * 1.4,
    }
    assert facts.masses == pytest.approx(by_hand, rel=1e-13)  # rounding
    assert assembly.total_mass == pytest.approx(sum(by_hand.values()), rel=1e-14)  # rounding: none here
    # A free structure moves as a whole: r^T M r through the matrices.
    translations = rigid_motion(assembly)[:, :3]
    # rounding: 1e-13 here
    assert translations.T @ assembly.M @ translations == pytest.approx(assembly.total_mass * np.eye(3), abs=1e-11)
    # rounding: 1e-13 here
    assert assembly.momentum @ translations == pytest.approx(assembly.total_mass * np.eye(3), abs=1e-11)


def rigid_motion(assembly: Assembly) -> NDArray[np.float64]:
    """Free degrees of freedom [n_free, 6] of the six rigid motions, by least squares on the nodes."""
    points = assembly.points
    motion = np.zeros((len(points), 7, 6))
    motion[:, :3, :3] = np.eye(3)
    motion[:, 3:6, 3:] = np.eye(3)
    for axis in range(3):
        motion[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], points)
    wanted = motion.reshape(-1, 6)
    T = assembly.dofs.T.toarray()
    free = np.linalg.lstsq(T, wanted, rcond=None)[0]
    assert np.abs(T @ free - wanted).max() <= 1e-10  # the map can move the structure rigidly
    return free


def test_rigid_motion_of_a_free_structure_strains_nothing() -> None:
    structure = table()
    parts = tuple(
        replace(part, start_offset=(0.01, 0.02, 0.01), end_offset=(0.0, 0.005, -0.02))
        if isinstance(part, Frame) and part.name == "legs"
        else part
        for part in structure.parts
        if part.name != "foam"
    )
    model = mesh_structure(replace(structure, parts=parts))
    legs = model.parts["legs"]
    arms = [[0.01, 0.02, 0.01], [0.0, 0.005, -0.02], [0.005, 0.0125, 0.0]]  # in the middle: across the leg alone
    assert legs.arms[0] == pytest.approx(np.array(arms))  # one bar a leg
    assert model.mesh.points[legs.bars[0]] == pytest.approx(np.array([[0, 0, 0.0], [0, 0, 0.1], [0, 0, 0.045]]))
    assembly = assemble(model)
    motion = rigid_motion(assembly)
    residual = np.linalg.norm(assembly.K @ motion, axis=0)
    scale = np.abs(assembly.K.toarray()).max() * np.linalg.norm(motion, axis=0)
    assert (residual / scale).max() <= ROUNDING


@pytest.mark.parametrize("kind", KINDS)
def test_rigid_motion_of_a_fine_plate_in_space(kind: str) -> None:
    plate = Plate("p", STEEL, 0.01, (1.0, 2.0, 3.0), (1.0, 1.0), (100, 100), kind, normal=(1.0, 2.0, 3.0))
    model = mesh_structure(Structure("fine", (plate,)))
    assembly = assemble(model)
    mesh = model.parts["p"]
    x, y = (grid.ravel() for grid in np.meshgrid(mesh.x, mesh.y, indexing="ij"))
    per_node = 4 if kind == "bfs16" else 3
    motion = np.zeros((len(x), per_node, 3))
    motion[:, 0] = np.stack([np.ones_like(x), y, x], axis=1)
    motion[:, 1, 1], motion[:, 2, 2] = 1.0, -1.0
    free = np.concatenate([motion.reshape(-1, 3), np.zeros((3, 3))])
    residual = np.linalg.norm(assembly.K @ free, axis=0)
    assert (residual / (np.abs(assembly.K.data).max() * np.linalg.norm(free, axis=0))).max() <= ROUNDING


def test_listening_points_move_no_frequency_and_carrying_points_have_nodes() -> None:
    structure = table()
    first = assemble(mesh_structure(structure))
    moved = replace(structure, points=(structure.points[0], PlaceOn("Q", "top", ((0.0731, 0.2319),))))
    second = assemble(mesh_structure(moved))
    assert np.array_equal(first.K.toarray(), second.K.toarray())
    model = mesh_structure(structure)
    top = model.parts["top"]
    assert 0.1 in top.x and 0.12 in top.y  # the added mass
    assert 0.17 not in top.x and 0.21 not in top.y
    base = model.parts["base"]
    for line in (0.05, 0.1, 0.5, 0.55):  # foam rim, legs
        assert np.abs(base.x - line).min() <= ROUNDING
    assert np.diff(base.x).max() <= 0.2 + ROUNDING


def test_frame_lines_take_the_nodes_of_the_plate() -> None:
    model = mesh_structure(table())
    bar, top = model.parts["bar"], model.parts["top"]
    assert len(bar.bars) == 2 * (len(top.x) - 1) + 2 * (len(top.y) - 1)
    points = model.mesh.points
    edge = points[top.grid[:, 0]]
    assert all(np.linalg.norm(points[model.mesh.nodes["bar"]] - place, axis=1).min() <= ROUNDING for place in edge)


def test_a_bar_keeps_its_size_outside_the_plate() -> None:
    plate = Plate("p", STEEL, 0.01, (0.0, 0.0, 0.0), (0.4, 0.3), (2, 3))
    rib = Frame("rib", STEEL, rectangle("r", 0.01, 0.01), (((-0.2, 0.1, 0.0), (0.4, 0.1, 0.0)),), 0.05)
    model = mesh_structure(Structure("rib", (plate, rib), (Joint("j", "rib", "p"),)))
    assert len(model.parts["rib"].bars) == 4 + 2
    assert model.parts["p"].x == pytest.approx([0.0, 0.2, 0.4])


def test_an_oblique_line_gives_the_plate_crossings_at_its_own_nodes() -> None:
    plate = Plate("p", STEEL, 0.01, (0.0, 0.0, 0.0), (0.4, 0.3), (2, 2))
    rib = Frame("rib", STEEL, rectangle("r", 0.01, 0.01), (((0.0, 0.0, 0.0), (0.4, 0.3, 0.0)),), 0.13)
    model = mesh_structure(Structure("rib", (plate, rib), (Joint("j", "rib", "p"),)))
    (tie,) = model.ties
    assert len(model.parts["rib"].bars) == 4  # 0.5 m in pieces of at most 0.13 m
    assert tie.rows.shape[0] == 6 * 5


def test_interpolated_points_follow_a_rigid_motion() -> None:
    structure = replace(
        table(),
        points=(*table().points, PlaceOn("L", "legs", ((0.4, 0.3, 0.033),)), PlaceOn("B", "bar", ((0.1, 0.0, 0.1),))),
    )
    parts = tuple(
        replace(part, start_offset=(0.0, 0.0, 0.02)) if isinstance(part, Frame) and part.name == "legs" else part
        for part in structure.parts
        if part.name != "foam"
    )
    model = mesh_structure(replace(structure, parts=parts))
    assembly = assemble(model)
    nodal = (assembly.dofs.T @ rigid_motion(assembly)).reshape(-1, 7, 6)
    for name, point in model.points.items():
        for number, direction in enumerate(("x", "y", "z", "rx", "ry", "rz")):
            expected = np.zeros(6)
            if number < 3:
                expected[number] = 1.0
                expected[3:] = np.cross(np.eye(3), point.position)[:, number]
            else:
                expected[number] = 1.0
            # rounding: 4e-14 here
            assert point.probe(direction).of(nodal) == pytest.approx(expected, abs=1e-11), (name, direction)
    surface = model.surfaces["ceiling"]
    assert surface.normal == pytest.approx([0, 0, -1])
    assert surface.weights.sum() == pytest.approx(0.5 * 0.4, rel=ROUNDING)
    # rounding: 2e-15 here
    assert surface.shapes(nodal)[:, 2] == pytest.approx(-np.ones(len(surface.points)), abs=1e-12)
    fine = refine_model(model, 3)
    moved = fine.displacement(nodal)
    assert moved[:, :, 3] == pytest.approx(np.cross([1.0, 0.0, 0.0], fine.points), abs=1e-12)  # rounding: 3e-15 here


@pytest.mark.parametrize("kind", KINDS)
def test_a_point_follows_a_cubic_deflection_exactly(kind: str) -> None:
    """w = x^3 - 2 x + 3 y, with x^2 y^3 for bfs16, from its nodal values, on a plate in any plane."""
    plate = Plate("p", STEEL, 0.01, (1.0, 2.0, 3.0), (0.4, 0.3), (3, 2), kind, normal=(1.0, 2.0, 3.0))
    x0, y0 = 0.37, 0.19
    model = mesh_structure(Structure("p", (plate,), points=(PlaceOn("P", "p", ((x0, y0),)),)))
    mesh = model.parts["p"]
    mixed = 1.0 if kind == "bfs16" else 0.0

    def field(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        w = x**3 - 2 * x + 3 * y + mixed * (x**2 * y**3)
        wx = 3 * x**2 - 2 + mixed * 2 * x * y**3
        wy = 3 + mixed * 3 * x**2 * y**2
        return np.stack([w, wy, -wx, mixed * 6 * x * y**2], axis=-1)

    x, y = (grid.ravel() for grid in np.meshgrid(mesh.x, mesh.y, indexing="ij"))
    nodal = np.zeros((len(x), 7, 1))
    values = field(x, y)
    nodal[:, :3, 0] = values[:, :1] * mesh.axes[2]
    nodal[:, 3:6, 0] = values[:, 1:2] * mesh.axes[0] + values[:, 2:3] * mesh.axes[1]
    nodal[:, 6, 0] = values[:, 3]
    w, rx, ry, _ = field(np.array(x0), np.array(y0))
    point = model.points["P"]
    moved = np.array([point.probe(direction).of(nodal)[0] for direction in ("x", "y", "z", "rx", "ry", "rz")])
    assert moved[:3] == pytest.approx(w * mesh.axes[2], abs=ROUNDING)
    assert moved[3:] == pytest.approx(rx * mesh.axes[0] + ry * mesh.axes[1], abs=ROUNDING)
    assert point.probe("n").of(nodal)[0] == pytest.approx(w, abs=ROUNDING)


def test_a_simply_supported_edge_stays_straight_between_nodes() -> None:
    plate = Plate("p", STEEL, 0.01, (0.0, 0.0, 0.0), (0.4, 0.3), (2, 2))
    edges = (PlaceOn("a", "p", ((0.13, 0.0),)), PlaceOn("b", "p", ((0.4, 0.07),)))
    support = Support("rim", "simple", "p", edge="all")
    model = mesh_structure(Structure("p", (plate,), points=edges, supports=(support,)))
    T = assemble(model).dofs.T
    for point, free, held in ((model.points["a"], "rx", "ry"), (model.points["b"], "ry", "rx")):
        for direction in ("x", "y", "z", "rz", held):
            assert abs(point.probe(direction).row(model.mesh.n_nodes) @ T).sum() == 0.0
        assert abs(point.probe(free).row(model.mesh.n_nodes) @ T).sum() > 0.0


def test_a_dof_without_stiffness_and_mass_is_named() -> None:
    weightless = replace(ACRYLIC, rho=0.0)
    plate = Plate("film", weightless, 0.001, (0.0, 0.0, 0.0), (0.4, 0.3), (2, 2))
    with pytest.raises(SingularSystem, match="film shift along x"):
        assemble(mesh_structure(Structure("film", (plate,))))


def test_labels_name_part_node_and_component() -> None:
    assembly = assemble(mesh_structure(table()))
    assert assembly.dofs.labels[0] == "top node 0 (0, 0, 0.1) deflection"
    assert len(assembly.dofs.labels) == assembly.K.shape[0] == len(list(assembly.dofs.labels))


def test_findings_give_the_twist_defect_in_numbers() -> None:
    model = mesh_structure(table("hermite12"))
    findings = [finding for finding in model_findings(model) if finding.code == "twist-defect"]
    assert len(findings) == 2
    assert findings[0].values["largest_excess"] >= findings[0].values["mean_excess"] > 0
    assert not any(finding.code == "twist-defect" for finding in model_findings(mesh_structure(table())))


def test_findings_estimate_the_shear_left_out() -> None:
    """A concrete slab 0.66 x 0.57 x 0.03 m: Mindlin's first free frequencies are 0.7 % and more below Kirchhoff's."""
    concrete = Material("concrete", 22.25e9, 0.1, 2400.0)
    slab = Plate("slab", concrete, 0.03, (0.0, 0.0, 0.0), (0.66, 0.57), 0.2)
    (finding,) = model_findings(mesh_structure(Structure("slab", (slab,))))
    assert finding.code == "thick-plate"
    assert finding.values["first_frequency_excess"] == pytest.approx(0.0073, abs=5e-5)  # half a unit of the last digit
    assert model_findings(mesh_structure(Structure("thin", (replace(slab, thickness=0.01),)))) == ()


def test_dashpots_go_into_C_and_springs_apart_strain_nothing() -> None:
    lower = Plate("lower", STEEL, 0.01, (0.0, 0.0, 0.0), (0.4, 0.3), (2, 2))
    upper = Plate("upper", STEEL, 0.01, (0.0, 0.0, 0.2), (0.4, 0.3), (2, 2))
    places = ((0.1, 0.1), (0.3, 0.1), (0.2, 0.25))
    mounts = Spring("mounts", "low", "up", (3e4, 2e4, 1e5, 0, 0, 50.0), (30.0, 20.0, 40.0, 0, 0, 0))
    structure = Structure(
        "sandwich", (lower, upper, mounts), points=(PlaceOn("low", "lower", places), PlaceOn("up", "upper", places))
    )
    assembly = assemble(mesh_structure(structure))
    motion = rigid_motion(assembly)
    for matrix in (assembly.K, assembly.C):
        scale = np.abs(matrix.toarray()).max() * np.linalg.norm(motion, axis=0)
        assert (np.linalg.norm(matrix @ motion, axis=0) / scale).max() <= ROUNDING
    assert assembly.C.nnz > 0
