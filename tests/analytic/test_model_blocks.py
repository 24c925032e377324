"""Rigid blocks against closed forms: mass and inertia, six degrees of freedom on springs, joints, and invariances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

from femstruct.assembly.matrices import assemble
from femstruct.errors import FemstructError
from femstruct.modal.reduction import modal_basis
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import model_facts, refine_model
from femstruct.model.regions import Region
from femstruct.model.sections import rectangle
from femstruct.model.structure import Joint, PlaceOn, Structure, Support
from femstruct.parts.block import Block
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.mass import Mass
from femstruct.parts.plate import Plate
from femstruct.parts.spring import Spring

ROUNDING = 1e-13  # rounding: 8e-16 here at most

STEEL = Material("steel", 206e9, 0.3, 7850.0)
BLOCK = Block("block", 450.0, (1.0, 2.0, -0.5), (4.0, 3.0, 1.5))
FEET = ((0.5, 0.5, 0.0), (3.5, 0.5, 0.0), (3.2, 2.5, 0.0), (0.5, 2.5, 0.3))
SIX = (7e4, 5e4, 11e4, 2e3, 3e3, 1e3)


def cross_matrix(r):
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])


def motion_of_place(r):
    """u + theta x r and theta, at a place r from the centre of mass, from the six motions there [6, 6]."""
    return np.block([[np.eye(3), -cross_matrix(r)], [np.zeros((3, 3)), np.eye(3)]])


def test_a_uniform_block_has_the_inertia_of_its_volume():
    """Quadrature over the box is exact for the quadratics in the integral of r x (omega x r)."""
    x, w = np.polynomial.legendre.leggauss(2)
    places = np.array([(a, b, c) for a in x for b in x for c in x]) * np.array(BLOCK.size) / 2
    weights = np.array([a * b * c for a in w for b in w for c in w]) / 8 * BLOCK.mass
    by_volume = sum(m * cross_matrix(r).T @ cross_matrix(r) for m, r in zip(weights, places, strict=True))
    assembly = assemble(mesh_structure(Structure("free", (BLOCK,))))
    # rounding: 1e-16 here
    assert assembly.M.toarray() == pytest.approx(np.diag([BLOCK.mass] * 3 + list(np.diag(by_volume))), rel=1e-14)
    assert assembly.total_mass == BLOCK.mass
    basis = modal_basis(assembly, count=6)
    assert basis.kind == ("rigid",) * 6
    assert basis.modal_mass.sum(axis=1) == pytest.approx([BLOCK.mass] * 3, rel=ROUNDING)


def test_a_block_is_worth_its_lumps():
    """A massless-looking block with three pairs of masses on it moves as one whose inertia is theirs."""
    arms = np.array([[0.7, 0, 0], [-0.7, 0, 0], [0, 0.9, 0], [0, -0.9, 0], [0, 0, 0.4], [0, 0, -0.4]])
    lumps = tuple(tuple(np.array(BLOCK.middle) + arm) for arm in arms)
    grain = replace(BLOCK, mass=1e-6, inertia=(1e-6, 1e-6, 1e-6))
    heavy = Structure("lumps", (grain, Mass("lumps", 75.0, at="at")), points=(PlaceOn("at", "block", lumps),))
    found = assemble(mesh_structure(heavy)).M.toarray()
    inertia = sum(75.0 * cross_matrix(arm).T @ cross_matrix(arm) for arm in arms)
    # rounding: 9e-14 here
    assert found == pytest.approx(np.diag([450.0] * 3 + list(np.diag(inertia))) + 1e-6 * np.eye(6), abs=1e-11)


@pytest.mark.parametrize("center", [None, (1.7, 1.6, 0.4)])
def test_a_block_on_springs_is_six_by_six(center):
    block = replace(BLOCK, center=center, inertia=None if center is None else (300.0, 500.0, 700.0))
    structure = Structure(
        "on springs", (block, Spring("springs", "feet", None, SIX)), points=(PlaceOn("feet", "block", FEET),)
    )
    basis = modal_basis(assemble(mesh_structure(structure)), count=6)
    from_center = np.array(FEET) - np.array(center or block.middle)
    K = sum(motion_of_place(r).T @ np.diag(SIX) @ motion_of_place(r) for r in from_center)
    omega = np.sqrt(eigh(K, np.diag([block.mass] * 3 + list(block.moments)), eigvals_only=True))
    assert basis.omega == pytest.approx(omega, rel=ROUNDING)


def test_sway_and_rocking_of_a_symmetric_block():
    """Two degrees of freedom each way: k (u - h t), k (h^2 - u h t) + k_z b^2, by the quadratic formula."""
    h, b, a = 0.75, 1.0, 1.5
    places = tuple((2 + i * a, 1.5 + j * b, 0.0) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    springs = Spring("springs", "feet", None, (4e4, 5e4, 6e4, 0, 0, 0))
    structure = Structure("symmetric", (BLOCK, springs), points=(PlaceOn("feet", "block", places),))
    basis = modal_basis(assemble(mesh_structure(structure)), count=6)
    m, (ix, iy, iz) = BLOCK.mass, BLOCK.moments
    squares = [4 * 6e4 / m, 4 * (4e4 * b**2 + 5e4 * a**2) / iz]
    for k, inertia, arm in ((2e5, ix, b), (1.6e5, iy, a)):
        sway, rock, coupling = k / m, (k * h**2 + 2.4e5 * arm**2) / inertia, k**2 * h**2 / (m * inertia)
        root = np.sqrt((sway - rock) ** 2 / 4 + coupling)
        squares += [(sway + rock) / 2 - root, (sway + rock) / 2 + root]
    assert np.sort(basis.omega**2) == pytest.approx(np.sort(squares), rel=ROUNDING)


def test_points_and_pictures_follow_the_block():
    places = ((0.0, 0.0, 0.0), (4.0, 3.0, 1.5), (1.0, 2.0, 0.7))
    model = mesh_structure(Structure("points", (BLOCK,), points=(PlaceOn("P", "block", places, side="below"),)))
    assembly = assemble(model)
    nodal = assembly.dofs.T.toarray().reshape(-1, 7, 6)
    for number, at in enumerate(places):
        point = model.points[f"P.{number + 1}"]
        assert point.position == pytest.approx(np.add(BLOCK.origin, at))
        assert point.normal[2] == -1.0
        rows = np.stack([point.probe(direction).of(nodal) for direction in ("x", "y", "z", "rx", "ry", "rz")])
        assert rows == pytest.approx(motion_of_place(np.array(at) - BLOCK.middle), abs=1e-14)  # rounding: none here
    box = refine_model(model)
    assert box.quads.shape == (6, 4)
    assert np.ptp(box.points, axis=0) == pytest.approx(BLOCK.size)
    moved = box.displacement(nodal)
    for place, shift in zip(box.points, moved, strict=True):
        # rounding: none here
        assert shift == pytest.approx(motion_of_place(place - np.add(BLOCK.origin, BLOCK.middle))[:3], abs=1e-14)
    facts = model_facts(model)
    assert (facts.high - facts.low) == pytest.approx(BLOCK.size)
    assert facts.masses == {"block": BLOCK.mass}
    assert facts.counts["blocks"] == 1


def cantilever(kind):
    """A strip with nu = 0, 0.2 m of it in a held block, 1 m free: a beam clamped where it leaves the block."""
    held = Block("foot", 50.0, (-0.2, -0.1, -0.3), (0.2, 0.4, 0.3))
    support = Support("floor", ("x", "y", "z", "rx", "ry", "rz"), on="foot")
    if kind == "frame":
        beam = Frame(
            "beam", STEEL, rectangle("s", 0.2, 0.01), (((-0.2, 0.1, -0.1), (1.0, 0.1, -0.1)),), 0.05, element="euler"
        )
    else:
        free = Material("strip", 206e9, 0.0, 7850.0)
        # Lying on the block: its mid-surface is half its thickness above the top.
        beam = Plate("beam", free, 0.01, (-0.2, 0.0, 0.005), (1.2, 0.2), (12, 2), kind)
    return Structure("cantilever", (held, beam), (Joint("seat", "beam", "foot"),), supports=(support,))


@pytest.mark.parametrize("kind", ["frame", "bfs16", "acm12", "hermite12"])
@pytest.mark.parametrize("turned", [False, True])
def test_what_is_joined_to_a_block_is_clamped_where_it_leaves_it(kind, turned):
    structure = cantilever(kind)
    if turned:
        structure = replace(structure, joints=(Joint("seat", "foot", "beam"),))
    first = modal_basis(assemble(mesh_structure(structure)), count=1).omega[0]
    exact = 1.8751040687**2 * np.sqrt(206e9 * 0.01**2 / 12 / 7850.0)
    # Twenty elements of the frame; ten of a plate, which as a strip free at its sides bends as a beam with nu = 0.
    assert first == pytest.approx(exact, rel=1e-4)


def test_a_joint_carries_the_load_to_the_block():
    model = mesh_structure(replace(cantilever("bfs16"), points=(PlaceOn("tip", "beam", ((1.2, 0.1),)),)))
    assembly = assemble(model)
    load = (model.points["tip"].probe("z").row(len(assembly.points)) @ assembly.dofs.T).toarray()[0]
    u = spsolve(assembly.K, load)
    for name in ("seat", "floor", "ground"):
        assert assembly.forces[name].stiffness @ u == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)  # rounding: 2e-12 here


def test_two_blocks_joined_are_one():
    upper = Block("upper", 300.0, (1.5, 2.5, 1.0), (1.0, 2.0, 2.0), center=(0.4, 1.1, 0.8))
    springs = Spring("springs", "feet", None, SIX)
    feet = (PlaceOn("feet", "block", FEET),)
    pair = Structure("pair", (BLOCK, upper, springs), (Joint("bolts", "block", "upper"),), feet)
    found = modal_basis(assemble(mesh_structure(pair)), count=6).omega
    centers = [np.add(BLOCK.origin, BLOCK.middle), np.add(upper.origin, upper.center)]
    M = np.zeros((6, 6))
    for block, center in zip((BLOCK, upper), centers, strict=True):
        here = motion_of_place(center - centers[0])
        M += here.T @ np.diag([block.mass] * 3 + list(block.moments)) @ here
    K = sum(motion_of_place(r).T @ np.diag(SIX) @ motion_of_place(r) for r in np.array(FEET) - BLOCK.middle)
    assert found == pytest.approx(np.sqrt(eigh(K, M, eigvals_only=True)), rel=ROUNDING)


def machine(turn=None, order=(0, 1, 2, 3, 4)):
    """A cube on springs over a plate, on a pad with another cube above; turned about the origin."""
    spin = turn or Rotation.identity()
    cube = Block("cube", 80.0, (0.2, 0.2, 0.3), (0.4, 0.4, 0.4), inertia=(3.0, 3.0, 3.0))
    parts = [
        cube,
        Plate("floor", STEEL, 0.02, (0.0, 0.0, 0.0), (0.9, 0.8), (4, 5)),
        Spring("mounts", "feet", "seats", (2e5, 2e5, 2e5, 100.0, 100.0, 100.0), (50.0, 50.0, 50.0, 0, 0, 0)),
        Foundation("bed", "floor", Region("whole"), 1e6, 2e5),
        Mass("extra", 5.0, at="top"),
    ]
    feet, seats = ((0.0, 0.0, 0.0), (0.4, 0.0, 0.0), (0.2, 0.4, 0.0)), ((0.2, 0.2), (0.6, 0.2), (0.4, 0.6))
    on_cube = [feet, ((0.1, 0.4, 0.35),)]
    if turn is not None:
        center = np.add(cube.origin, cube.middle)
        moved = spin.apply(center) - 1.0  # the box is only where points may be: make it large
        parts[0] = replace(cube, origin=tuple(moved), size=(2.0, 2.0, 2.0), center=(1.0, 1.0, 1.0))
        on_cube = [tuple(tuple(1.0 + spin.apply(np.subtract(at, cube.middle))) for at in places) for places in on_cube]
        axes = spin.as_matrix().T
        parts[1] = replace(parts[1], normal=tuple(axes[2]), x_direction=tuple(axes[0]))
    points = (PlaceOn("feet", "cube", on_cube[0]), PlaceOn("seats", "floor", seats), PlaceOn("top", "cube", on_cube[1]))
    return Structure("machine", tuple(parts[i] for i in order), points=points)


def test_turning_in_space_moves_no_frequency():
    turn = Rotation.from_rotvec([0.3, -0.7, 1.1])
    first, second = (modal_basis(assemble(mesh_structure(one)), count=12).omega for one in (machine(), machine(turn)))
    # The springs are the same along all axes, the cube's inertia too.
    assert second == pytest.approx(first, rel=1e-8)


def test_the_order_of_parts_moves_no_frequency():
    first, second = (
        modal_basis(assemble(mesh_structure(one)), count=12).omega
        for one in (machine(), machine(order=(4, 1, 3, 0, 2)))
    )
    assert second == pytest.approx(first, rel=1e-10)  # rounding: 6e-13 here


def test_a_quarter_turn_of_a_block_changes_its_axes_only():
    def on_springs(block, places, six):
        springs = Spring("springs", "feet", None, six)
        structure = Structure("turned", (block, springs), points=(PlaceOn("feet", "block", places),))
        return modal_basis(assemble(mesh_structure(structure)), count=6).omega

    turned = replace(BLOCK, size=(3.0, 4.0, 1.5))  # about z: (x, y) -> (b - y, x)
    places = tuple((3.0 - y, x, z) for x, y, z in FEET)
    swapped = (SIX[1], SIX[0], SIX[2], SIX[4], SIX[3], SIX[5])
    assert on_springs(turned, places, swapped) == pytest.approx(on_springs(BLOCK, FEET, SIX), rel=ROUNDING)


def with_point(*at):
    return Structure("s", (BLOCK,), points=(PlaceOn("P", "block", (at,)),))


def with_other(origin, kind="rigid"):
    other = replace(BLOCK, name="other", origin=origin)
    return Structure("s", (BLOCK, other), (Joint("j", "block", "other", kind),))


def with_plate(height, x_direction=None):
    plate = Plate("p", STEEL, 0.1, (1.0, 2.0, height), (1.0, 1.0), (2, 2), x_direction=x_direction)
    return Structure("s", (BLOCK, plate), (Joint("j", "block", "p"),))


REFUSED = {
    "off": (
        with_point(5.0, 0.0, 0.0),
        r"points\.P\.at: got .*, 1 m off block, expected a place within 4 m x 3 m x 1.5 m",
    ),
    "two numbers": (with_point(1.0, 0.0), r"points\.P\.at: got 2 numbers, expected \[x, y, z\] from the lower corner"),
    "flat": (Structure("s", (replace(BLOCK, size=(1.0, 0.0, 1.0)),)), r"parts\.block\.size: got 0, expected positive"),
    "apart": (with_other((9.0, 2.0, 0.0)), r"joints\.j: got block and other 4 m apart"),
    "pinned": (with_other((5.0, 2.0, 0.0), "pinned"), r"joints\.j: got a joint of two blocks that is not rigid"),
    "plate above": (with_plate(1.2), r"joints\.j: got block and p without a common place"),
    "plate at an angle": (with_plate(1.0, (1.0, 0.2, 0.0)), r"parts\.p: got a plate at an angle to block"),
    "edge": (
        Structure("s", (BLOCK,), supports=(Support("e", "clamped", "block", "x0"),)),
        r"supports\.e\.on: got 'block'",
    ),
    "mass": (Structure("s", (BLOCK, Mass("m", 1.0, on="block"))), r"parts\.m\.region: got 'block', expected a plate"),
    "no part": (replace(with_point(1.0, 1.0, 1.0), parts=(replace(BLOCK, name="b"),)), r"points\.P\.on: got 'block'"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name):
    structure, message = REFUSED[name]
    with pytest.raises(FemstructError, match=message):
        mesh_structure(structure)
