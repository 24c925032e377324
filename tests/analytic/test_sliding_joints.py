"""Joints that slide against a stiffness per length: partial composite action, and shear across a seam."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

import femstruct as fs
from femstruct.language.models import read_model
from femstruct.model.plates_and_bars import pieces_of
from femstruct.model.sections import rectangle
from femstruct.parts.rib_findings import rib_errors

TIMBER = fs.Material("timber", E=11e9, nu=0.0, rho=450.0)
L, WIDE, THICK, RIB, HIGH = 6.0, 0.3, 0.03, 0.06, 0.2  # m
ARM = (THICK + HIGH) / 2.0


def floor(joint: fs.Joint, mesh: float = 0.2, **changes) -> fs.Structure:
    board = fs.Plate("board", TIMBER, THICK, (0.0, -WIDE / 2.0, 0.0), (L, WIDE), (round(L / mesh), 2), **changes)
    down = (0.0, 0.0, -ARM)
    joist = fs.Frame(
        "joist",
        TIMBER,
        rectangle("r", RIB, HIGH),
        (((0.0, 0.0, 0.0), (L, 0.0, 0.0)),),
        element="euler",
        start_offset=down,
        end_offset=down,
    )
    ends = tuple(fs.Support(edge, "simple", on="board", edge=edge) for edge in ("x0", "x1"))
    straight = fs.Support("straight", ("y",), on="board", line=((0.0, WIDE / 2.0), (L, WIDE / 2.0)))
    return fs.Structure("floor", (board, joist), (joint,), supports=(*ends, straight))


def lowest(structure: fs.Structure) -> float:
    """The first mode that goes up and down [Hz]."""
    basis = fs.modal_basis(fs.assemble(fs.mesh_structure(structure)), count=8)
    return float(basis.frequency_hz[np.argmax(basis.modal_mass[2, :8])])


def exact(slip: float) -> float:
    """The mode of two beams with a shear layer is a sine: the gamma method of Eurocode 5, annex B, is exact for it."""
    board, rib = WIDE * THICK, RIB * HIGH
    alone = TIMBER.E * (WIDE * THICK**3 + RIB * HIGH**3) / 12.0
    slides = np.pi**2 / (slip * L**2) if slip else np.inf
    bending = alone + ARM**2 / (1.0 / (TIMBER.E * board) + 1.0 / (TIMBER.E * rib) + slides)
    return float(np.pi / (2.0 * L**2) * np.sqrt(bending / (TIMBER.rho * (board + rib))))


@pytest.mark.parametrize("slip", [0.0, 1e5, 1e6, 1e7, 1e8, 1e9])
def test_a_floor_nailed_to_its_joists(slip: float) -> None:
    found = lowest(floor(fs.Joint("nails", "joist", "board", "sliding", slip=slip)))
    # shear lag in the board, and the inertia of bars and board along it: 0.3 % at most here
    assert found == pytest.approx(exact(slip), rel=5e-3)


def test_a_stiff_joint_that_slides_is_rigid_and_the_mesh_does_not_matter() -> None:
    rigid = lowest(floor(fs.Joint("weld", "joist", "board")))
    nails = fs.Joint("nails", "joist", "board", "sliding", slip=1e13)
    assert lowest(floor(nails)) == pytest.approx(rigid, rel=1e-5)  # 1 / slip
    soft = replace(nails, slip=5e6)
    coarse, fine = (lowest(floor(soft, mesh)) for mesh in (0.2, 0.1))
    assert fine == pytest.approx(coarse, rel=1e-3)  # bars of 200 mm


def test_the_finding_for_plates_that_are_rigid_knows_the_slip() -> None:
    joint = fs.Joint("nails", "joist", "board", "sliding", slip=5e6)
    (error,) = rib_errors(fs.mesh_structure(floor(joint, in_plane="rigid")))
    alone = TIMBER.E * (WIDE * THICK**3 + RIB * HIGH**3) / 12.0
    slides, board, rib = np.pi**2 / (5e6 * L**2), 1.0 / (TIMBER.E * WIDE * THICK), 1.0 / (TIMBER.E * RIB * HIGH)
    expected = (alone + ARM**2 / (rib + slides)) / (alone + ARM**2 / (rib + board + slides))
    assert error.bending == pytest.approx(expected, rel=1e-12)  # rounding


def test_a_seam_of_two_plates_slides_by_the_force_over_its_stiffness() -> None:
    """One plate held, the other pulled along the seam of 0.8 m: F / (slip L) but for the shear of the plates."""
    hard = replace(TIMBER, E=1e15)
    held = fs.Plate("held", hard, 0.05, (0.0, 0.0, 0.0), (0.6, 0.8), 0.2, in_plane="elastic")
    pulled = replace(held, name="pulled", origin=(0.6, 0.0, 0.0))
    end = fs.PlaceOn("end", "pulled", ((0.3, 0.4),))
    seam = fs.Joint("seam", "held", "pulled", "sliding", slip=2e6)
    fixed = fs.Support("fixed", "clamped", on="held", edge="x0")
    model = fs.mesh_structure(fs.Structure("s", (held, pulled), (seam,), points=(end,), supports=(fixed,)))
    assembly, at = fs.assemble(model), model.points["end"]
    load = np.zeros(len(assembly.points) * 7)
    load[at.nodes * 7 + at.components] = 1e3 * at.weights[1]
    moved = assembly.dofs.T @ spsolve(assembly.K, assembly.dofs.T.T @ load)
    shift = at.weights[:2] @ moved[at.nodes * 7 + at.components]
    assert shift == pytest.approx([0.0, 1e3 / (2e6 * 0.8)], rel=1e-6, abs=1e-9)  # plates of 1e15 Pa
    force = assembly.forces["seam"]
    solved = spsolve(assembly.K, assembly.dofs.T.T @ load)
    assert force.stiffness @ solved + force.direct @ load == pytest.approx(
        [0.0, -1e3, 0.0], abs=1e-2
    )  # rounding of 1e15 Pa


TEXT = """
title: A joist under a board
materials: {timber: {E: 11 GPa, nu: 0, rho: 450}}
sections: {joist: {shape: rectangle, width: 60 mm, height: 200 mm}}
parts:
  board: {type: plate, material: timber, thickness: 30 mm, origin: [0, -0.15, 0], size: [6, 0.3], mesh: [30, 2]}
  joist:
    type: frame
    element: euler
    material: timber
    section: joist
    lines: [[[0, 0, 0], [6, 0, 0]]]
    offsets: {start: [0, 0, -115 mm], end: [0, 0, -115 mm]}
joints: {nails: {connect: [joist, board], kind: sliding, slip: 5 MN/m^2}}
supports:
  ends: {on: board, edge: x0, fix: simple}
  others: {on: board, edge: x1, fix: simple}
  straight: {on: board, line: [[0, 0.15], [6, 0.15]], fix: [y]}
"""


def test_it_is_written_in_yaml(tmp_path) -> None:
    path = tmp_path / "floor.yaml"
    path.write_text(TEXT, encoding="utf-8")
    basis = fs.modal_basis(fs.assemble(read_model(path)), count=8)
    own = lowest(floor(fs.Joint("nails", "joist", "board", "sliding", slip=5e6)))
    assert np.abs(basis.frequency_hz - own).min() < 1e-6 * own  # the same model
    path.write_text(TEXT.replace("slip: 5 MN/m^2", "slip: 100 MN/m^3, width: 50 mm"), encoding="utf-8")
    assert read_model(path).structure.joints[0].slip == pytest.approx(5e6, rel=1e-15)  # rounding of a product
    for old, new, told in (
        (
            "slip: 5 MN/m^2",
            "slip: 5 MN/m^3",
            "joints.nails.slip: got a slip per area and no width, expected slip in N/m",
        ),
        ("slip: 5 MN/m^2", "slip: 5 MN/m^2, width: 1 m", "joints.nails.width: got a width and no slip per area"),
        ("kind: sliding", "kind: rigid", "joints.nails.slip: got a slip of a rigid joint, expected kind: sliding"),
        ("slip: 5 MN/m^2", "stiffness: {x: 5 MN/m}", "springs of a sliding joint, expected no stiffness"),
        (
            "slip: 5 MN/m^2",
            "slip: 5 MN/m",
            "joints.nails.slip: got '5 MN/m', which is a stiffness, expected a stiffness per length",
        ),
    ):
        path.write_text(TEXT.replace(old, new), encoding="utf-8")
        with pytest.raises(fs.InputError, match=told.replace("(", r"\(")):
            read_model(path)


def test_parts_that_touch_at_one_place_cannot_slide() -> None:
    plate = fs.Plate("plate", TIMBER, 0.03, (0.0, 0.0, 0.0), (1.0, 1.0), 0.25)
    post = fs.Frame("post", TIMBER, rectangle("r", 0.1, 0.1), (((0.5, 0.5, 0.0), (0.5, 0.5, -1.0)),))
    joint = fs.Joint("nail", "post", "plate", "sliding", slip=1e6)
    with pytest.raises(
        fs.InputError, match=r"joints\.nail\.kind: got sliding, and post and plate that touch at single"
    ):
        fs.mesh_structure(fs.Structure("s", (plate, post), (joint,)))
    with pytest.raises(fs.InputError, match="a slip of a rigid joint"):
        replace(joint, kind="rigid")
    with pytest.raises(fs.InputError, match="finite value >= 0"):
        replace(joint, slip=-1.0)
    with pytest.raises(fs.InputError, match="springs of a sliding joint"):
        replace(joint, stiffness={"x": 1.0})


def test_bars_between_offsets_of_one_node_run_along_nothing() -> None:
    """Two bars along x, and one whose ends are at one place: it has no direction and no length to slide along."""

    class Bars:
        first = 0
        places = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 0.0, 0.0]])
        lines = np.array([[0, 1], [1, 2], [2, 3]])

    pairs = np.stack([np.arange(4), np.arange(4) + 10], axis=1)
    found, along, lengths = pieces_of(Bars(), pairs)  # type: ignore[arg-type]
    assert found.tolist() == [[0, 10], [1, 11], [2, 12]]
    np.testing.assert_array_equal(along, np.tile([1.0, 0.0, 0.0], (3, 1)))
    assert lengths.tolist() == [0.5, 1.5, 1.0]
