"""Parts of matrices: reduced by femstruct, exported by it, or of another program; against the models they stand for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.errors import InputErrors
from femstruct.files.matrices_file import nodal
from femstruct.files.matrices_input import read_component
from femstruct.model.component import rigid_masses, rigid_resistance
from femstruct.study.asked import Extent
from femstruct.workflow.exchange import export_source, reduce_model

MATERIAL = "materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400, loss_factor: 1 %}}\n"
LEFT = "{type: plate, material: concrete, thickness: 180 mm, origin: [0, 0, 0], size: [3, 4], mesh: [12, 16]}"
RIGHT = "{type: plate, material: concrete, thickness: 180 mm, origin: [3, 0, 0], size: [2.5, 4], mesh: [10, 16]}"
WEST, EAST = "{on: left, edge: x0, fix: [x, y, z]}", "{on: right, edge: x1, fix: [x, y, z]}"
WEST_BOX = "{on: left, box: [[-0.01, -1, -1], [0.01, 5, 1]], fix: [x, y, z]}"
EAST_BOX = "{on: right, box: [[5.49, -1, -1], [5.51, 5, 1]], fix: [x, y, z]}"
TOP = 300.0  # Hz, twice the tenth frequency of the floor


def quiet(_: str) -> None:
    """Takes what is told of progress."""


def floor(folder: Path, name: str, left: str, right: str, west: str, east: str, at: str) -> Path:
    path = folder / f"{name}.yaml"
    path.write_text(
        f"{MATERIAL}parts:\n  left: {left}\n  right: {right}\n"
        f"joints: {{line: {{connect: [left, right]}}}}\npoints: {{p: {{on: left, at: {at}}}}}\n"
        f"supports:\n  west: {west}\n  east: {east}\n"
    )
    return path


def basis_of(path: Path) -> tuple[fs.Model, fs.ModalBasis]:
    model = fs.read_model(path)
    return model, fs.modal_basis(fs.assemble(model), count=10)


def test_a_floor_of_two_reduced_parts_is_the_floor(tmp_path: Path) -> None:
    whole = floor(tmp_path, "whole", LEFT, RIGHT, WEST, EAST, "[1.5, 2]")
    for part in ("left", "right"):
        found = reduce_model(whole, part, Extent(up_to_hz=TOP), tmp_path / f"{part}.npz", (), "", quiet)
        assert found["modes"] + found["residual vectors"] < 50
    files = ("{type: reduced, file: left.npz}", "{type: reduced, file: right.npz}")
    built = floor(tmp_path, "built", *files, WEST_BOX, EAST_BOX, "[1.5, 2, 0]")
    (one, exact), (other, basis) = basis_of(whole), basis_of(built)
    assert basis.frequency_hz == pytest.approx(exact.frequency_hz, rel=1e-4)  # what the issue asks for
    assert basis.frequency_hz == pytest.approx(exact.frequency_hz, rel=1e-6)  # 4e-7 measured, by the tenth
    assert basis.modal_mass == pytest.approx(exact.modal_mass, abs=1e-4 * exact.total_mass)  # squares of shapes' errors
    assert basis.total_mass == pytest.approx(exact.total_mass, rel=1e-12)  # rounding
    inside, there = (
        abs(model.points["p"].probe("z").of(found.shapes)) for model, found in ((one, exact), (other, basis))
    )
    assert there == pytest.approx(inside, abs=1e-3 * inside.max())  # shapes err by the root of what frequencies do
    assert fs.assemble(other).loss_factors["left"] == 0.01


def test_a_part_reduced_and_one_that_is_not_are_joined_at_their_nodes(tmp_path: Path) -> None:
    whole = floor(tmp_path, "whole", LEFT, RIGHT, WEST, EAST, "[1.5, 2]")
    reduce_model(whole, "left", Extent(up_to_hz=TOP), tmp_path / "left.npz", (), "", quiet)
    built = floor(tmp_path, "built", "{type: reduced, file: left.npz}", RIGHT, WEST_BOX, EAST, "[1.5, 2, 0]")
    (_, exact), (_, basis) = basis_of(whole), basis_of(built)
    assert basis.frequency_hz == pytest.approx(exact.frequency_hz, rel=1e-6)  # as above


def test_exported_matrices_are_the_part_that_they_are_of(tmp_path: Path) -> None:
    """Of elements without a twist: a file of matrices does not say which twists are one along a line."""
    left, right = (one.replace("}", ", element: acm12}") for one in (LEFT, RIGHT))
    (tmp_path / "alone.yaml").write_text(f"{MATERIAL}parts: {{left: {left}}}\n")
    export_source(tmp_path / "alone.yaml", "npz", tmp_path, None, (), "", quiet)
    export_source(tmp_path / "alone.yaml", "mtx", tmp_path, None, (), "", quiet)
    _, exact = basis_of(floor(tmp_path, "whole", left, right, WEST, EAST, "[1.5, 2]"))
    for file in ("alone.npz", "alone.json"):
        matrices = f"{{type: matrices, file: {file}}}"
        _, basis = basis_of(floor(tmp_path, "built", matrices, right, WEST_BOX, EAST, "[1.5, 2, 0]"))
        assert basis.frequency_hz == pytest.approx(exact.frequency_hz, rel=1e-9)  # rounding: the same matrices


def fan(folder: Path, **more: object) -> Path:
    """Two masses of 3 and 2 kg along z, 0.5 m apart, a spring of 800 N/m and a dashpot of 6 N s/m between them."""
    arrays = {
        "M": np.diag([3.0, 2.0]),
        "K": [[800.0, -800.0], [-800.0, 800.0]],
        "C": [[6.0, -6.0], [-6.0, 6.0]],
        "nodes": [0, 1],
        "components": [2, 2],
        "points": [[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]],
    }
    kept = {name: value for name, value in (arrays | more).items() if value is not None}
    np.savez(folder / "fan.npz", **kept)
    return folder / "fan.npz"


FAN = """
parts:
  fan: {type: matrices, file: fan.npz, origin: [1, 0, 0]}
  mount: {type: spring, between: [foot, ground], stiffness: {z: 500 N/m}}
points:
  foot: {on: fan, at: [1, 0, 0]}
  head: {on: fan, at: [1, 0, 0.5]}
"""


def test_matrices_of_another_program_are_a_part_with_springs_and_dashpots(tmp_path: Path) -> None:
    fan(tmp_path)
    (tmp_path / "fan.yaml").write_text(FAN)
    model = fs.read_model(tmp_path / "fan.yaml")
    assembly = fs.assemble(model)
    omega = fs.modal_basis(assembly, count=2).omega
    exact = np.linalg.eigvals(np.array([[1300.0 / 3.0, -800.0 / 3.0], [-400.0, 400.0]]))
    assert omega**2 == pytest.approx(np.sort(exact), rel=1e-12)  # rounding
    assert assembly.C.toarray() == pytest.approx(np.array([[6.0, -6.0], [-6.0, 6.0]]), rel=1e-12)  # rounding
    assert assembly.dofs.labels[1] == "fan node 1 UZ"
    assert model.points["head"].position.tolist() == [1.0, 0.0, 0.5]


def test_a_component_knows_whether_it_is_held(tmp_path: Path) -> None:
    six = {
        "M": np.eye(6), "K": np.zeros((6, 6)), "C": None, "nodes": [0] * 6, "components": range(6),
        "points": np.zeros((1, 3)),
    }  # fmt: skip
    assert read_component(fan(tmp_path, **six)).free
    held = read_component(fan(tmp_path))
    assert not held.free  # along x and y
    assert held.translations[:, 2] == pytest.approx(np.ones(2), rel=1e-12)  # rounding
    (finding,) = fs.Substructure("fan", held).implausible(lies=False)
    assert finding.code == "matrices-held"


@pytest.mark.parametrize(
    ("arrays", "old", "new", "told"),
    [
        ({}, "fan.npz", "pump.npz", "3:31: parts.fan.file: got no file"),
        ({}, "fan.npz", "fan.yaml", "parts.fan.file: got 'fan.yaml', which cannot be read"),
        ({"points": None}, "", "", "parts.fan.file: got 'fan.npz' without points, expected a node and a component"),
        ({"K": np.eye(3)}, "", "", "got (3, 3), expected (2, 2), a row for each degree of freedom"),
        ({"K": [[1.0, 2.0], [3.0, 4.0]]}, "", "", "expected a symmetric matrix"),
        ({"components": [2, 9]}, "", "", "got 2 to 9, expected 0 to 6"),
        ({"nodes": [0, 0]}, "", "", "got two degrees of freedom at node 0 UZ, expected one each"),
        ({"M": [[np.nan, 0.0], [0.0, 1.0]]}, "", "", "got a value that is not finite"),
        ({}, "at: [1, 0, 0]}", "at: [1, 0.2, 0]}", "points.foot.at: got (1, 0.2, 0) m, 0.2 m from the nearest node"),
        ({}, "at: [1, 0, 0]}", "set: feet}", "points.foot.set: got a set of fan, expected at: [x, y, z]"),
        ({}, "type: matrices", "type: reduced", "parts.fan.file: got 'fan.npz', which is not reduced"),
        ({}, "fan.npz,", "fan.npz, mass: t,", "parts.fan.mass: got the unknown key 'mass'"),
        ({}, "file: fan.npz", "file: /fan.npz", "parts.fan.file: got the absolute path '/fan.npz'"),
    ],
)
def test_a_mistake_is_one_clear_line(tmp_path: Path, arrays: dict[str, object], old: str, new: str, told: str) -> None:
    fan(tmp_path, **arrays)
    (tmp_path / "fan.yaml").write_text(FAN.replace(old, new))
    with pytest.raises(InputErrors) as caught:
        fs.read_model(tmp_path / "fan.yaml")
    assert told in str(caught.value)
    assert len(caught.value.errors) == 1


def frame_matrices(folder: Path, **order: np.ndarray) -> fs.Substructure:
    """A bent bar as a .npz of another program; order : of the points or of the rows of the map."""
    lines = "[[[0, 0, 0], [1, 0, 0]], [[1, 0, 0], [1, 1, 0.3]]]"
    bar = f"{{type: frame, material: steel, section: s, lines: {lines}, mesh: 0.1}}"
    steel = "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}\n"
    section = "sections: {s: {shape: rectangle, width: 20 mm, height: 40 mm}}\n"
    (folder / "bar.yaml").write_text(f"{steel}{section}parts: {{bar: {bar}}}\n")
    assembly = fs.assemble(fs.read_model(folder / "bar.yaml"))
    nodes, components = nodal(assembly.dofs)
    rows, places = (order.get(name, slice(None)) for name in ("rows", "points"))
    np.savez(
        folder / "bar.npz", M=assembly.M.toarray(), K=assembly.K.toarray(), nodes=nodes[rows],
        components=components[rows], points=assembly.points[places],
    )  # fmt: skip
    return fs.Substructure("bar", read_component(folder / "bar.npz"))


def test_matrices_in_the_order_of_their_table_raise_nothing(tmp_path: Path) -> None:
    part = frame_matrices(tmp_path)
    assert part.implausible(lies=False) == ()
    mass = 7850.0 * 8e-4 * (1.0 + 1.09**0.5)
    assert rigid_masses(part.component) == pytest.approx(np.full(3, mass), rel=1e-9)  # rho A L, rounding
    assert rigid_resistance(part.component) == pytest.approx(np.zeros(6), abs=1e-12)  # rounding


def test_a_table_in_another_order_than_the_matrices_limits_trust(tmp_path: Path) -> None:
    """By direction in place of by node: the masses tell. Two nodes in each other's place: rotations tell."""
    nodes, components = nodal(fs.assemble(fs.read_model(_bar_file(tmp_path))).dofs)
    (finding,) = frame_matrices(tmp_path, rows=np.lexsort((nodes, components))).implausible(lies=False)
    assert finding.code == "matrices-disorder" and not finding.severe
    x, y, z = (finding.values[f"mass_{axis}_kg"] for axis in "xyz")
    assert f"{x:.4g}, {y:.4g}, {z:.4g} kg" in finding.message and max(x, y, z) > 1.05 * min(x, y, z)
    swapped = np.arange(nodes.max() + 1)
    swapped[[7, 8]] = [8, 7]
    (finding,) = frame_matrices(tmp_path, points=swapped).implausible(lies=False)
    assert finding.code == "matrices-disorder"
    assert finding.values["shift_resisted"] < 1e-12  # rounding
    assert finding.values["turn_resisted"] > 1e-3  # ten times the threshold


def _bar_file(folder: Path) -> Path:
    frame_matrices(folder)
    return folder / "bar.yaml"


def test_matrices_on_springs_to_the_ground_are_held(tmp_path: Path) -> None:
    arrays = {
        "M": np.eye(6), "K": 3.0 * np.eye(6), "C": None, "nodes": [0] * 6, "components": range(6),
        "points": np.zeros((1, 3)),
    }  # fmt: skip
    (finding,) = fs.Substructure("fan", read_component(fan(tmp_path, **arrays))).implausible(lies=False)
    assert finding.code == "matrices-held"
    assert finding.values["shift_resisted"] == pytest.approx(1.0, rel=1e-9)  # rounding
