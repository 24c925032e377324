"""Elastic layers against slabs with openings: rigid parts apart, equilibrium, and the floating floor against plates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from femstruct.assembly.matrices import assemble
from femstruct.errors import InputError
from femstruct.modal.reduction import modal_basis
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.regions import Region
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.block import Block
from femstruct.parts.foundation import Foundation
from femstruct.parts.plate import Plate
from femstruct.parts.slab import Slab

ROUNDING = 1e-11  # rounding: 3e-13 here at most
CONCRETE = Material("concrete", 30e9, 0.2, 2400.0)
SCREED = Material("screed", 20e9, 0.2, 2000.0)
WHOLE = Region("whole")
L_SHAPE = ((1.0, 0.5), (5.0, 0.5), (5.0, 2.5), (3.0, 2.5), (3.0, 4.5), (1.0, 4.5))
OPENING = ((0.7, 0.8), (2.05, 2.0))
FLOOR = Slab("floor", CONCRETE, 0.2, L_SHAPE, 0.45, (OPENING,), origin=(0.3, -0.2, 1.0), offset=-0.02)
# over its whole box, 0.04 m above its upper face
COVER = Plate("cover", SCREED, 0.06, (1.3, 0.3, 1.15), (4.0, 4.0), (3, 5))
WOOL = Foundation("wool", "cover", WHOLE, 9e6, 4e6, to="floor")
EVERYWHERE = Region("box", box=((-1.0, -1.0, -1.0), (3.0, 3.0, 3.0)))


def rigid(points, motion):
    """Components [n, 7] of nodes that move together with the shift and turn [6] about the origin."""
    moved = np.zeros((len(points), 7))
    moved[:, :3], moved[:, 3:6] = motion[:3] + np.cross(motion[3:], points), motion[3:]
    return moved


def strained(parts, motions):
    """Twice the energy of the wool where parts move rigidly, by name."""
    model = mesh_structure(Structure("floating", parts))
    assembly = assemble(model)
    T = assembly.dofs.T.toarray()
    wanted = np.zeros((model.mesh.n_nodes, 7))
    for name, motion in motions.items():
        own = model.mesh.nodes[name]
        wanted[own] = rigid(model.mesh.points[own], motion)
    free = np.linalg.lstsq(T, wanted.ravel(), rcond=None)[0]
    assert np.abs(T @ free - wanted.ravel()).max() < ROUNDING
    return free @ (assembly.part_stiffness["wool"] @ free)


@pytest.mark.parametrize("named_first", ["cover", "floor"])
def test_parts_that_move_rigidly_shear_and_press_what_both_cover(named_first):
    """The energy of the even layer where the slab is, by its area and moments about the middle of the gap."""
    wool = WOOL if named_first == "cover" else replace(WOOL, on="floor", to="cover")
    motions = dict(zip(("cover", "floor"), np.random.default_rng(5).standard_normal((2, 6)), strict=True))
    found = strained((FLOOR, COVER, wool), motions)
    nodes, weights = np.polynomial.legendre.leggauss(3)  # exact: squares of linear motions
    exact = 0.0
    boxes = (1.0, 5.0, 0.5, 2.5, 1), (1.0, 3.0, 2.5, 4.5, 1), (1.7, 2.4, 1.6, 2.4, -1)
    for x0, x1, y0, y1, sign in boxes:
        x, y = (x0 + x1) / 2 + (x1 - x0) / 2 * nodes, (y0 + y1) / 2 + (y1 - y0) / 2 * nodes
        points = np.stack([*np.meshgrid(x + 0.3, y - 0.2, indexing="ij"), np.full((3, 3), 1.1)], axis=-1).reshape(-1, 3)
        apart = rigid(points, motions["cover"] - motions["floor"])[:, :3]
        each = np.outer(weights, weights).ravel() * (x1 - x0) * (y1 - y0) / 4.0
        exact += sign * float(each @ (4e6 * apart[:, 0] ** 2 + 4e6 * apart[:, 1] ** 2 + 9e6 * apart[:, 2] ** 2))
    assert found == pytest.approx(exact, rel=ROUNDING)


def test_a_load_on_the_cover_goes_through_the_layer_into_the_supports():
    held = Support("rim", ("x", "y", "z"), on="floor", region=Region("set", named="rim"))
    mid = PlaceOn("mid", "cover", ((1.3, 1.1),))
    model = mesh_structure(Structure("floating", (FLOOR, COVER, WOOL), points=(mid,), supports=(held,)))
    assembly = assemble(model)
    load = (model.points["mid"].probe("z").row(len(assembly.points)) @ assembly.dofs.T).toarray()[0]
    u = spsolve(assembly.K, load)
    assert assembly.forces["wool"].stiffness @ u == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)  # rounding: of a solve
    assert assembly.forces["ground"].stiffness @ u == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)  # rounding: of a solve


def test_a_floating_floor_bounces_on_a_slab_as_on_a_plate():
    """sqrt(s' (1/m1 + 1/m2)) / 2 pi of two free flat parts of one size."""
    slab = Slab("slab", CONCRETE, 0.18, ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)), 0.5)
    screed = Plate("screed", SCREED, 0.05, (0.0, 0.0, 0.145), (4.0, 3.0), (3, 5))
    wool = Foundation("wool", "screed", WHOLE, 9e6, to="slab")
    basis = modal_basis(assemble(mesh_structure(Structure("floating floor", (slab, screed, wool)))), up_to=60.0)
    expected = np.sqrt(9e6 * (1 / (2400 * 0.18) + 1 / (2000 * 0.05))) / (2 * np.pi)
    assert np.abs(basis.frequency_hz / expected - 1.0).min() < 1e-9  # the eigensolver's


def test_a_machine_stands_on_a_pad_on_a_slab():
    """A rigid block's heave on a stiff slab that is held: f = sqrt(s A / m) / 2 pi."""
    slab = Slab("slab", CONCRETE, 0.3, ((0.0, 0.0), (2.0, 0.0), (2.0, 1.5), (0.0, 1.5)), 0.25)
    block = Block("machine", 200.0, (0.5, 0.3, 0.17), (0.6, 0.4, 0.5))
    pad = Foundation("pad", "machine", WHOLE, 1e7, to="slab")
    held = Support("all", ("x", "y", "z", "rx", "ry", "rz"), on="slab", region=EVERYWHERE)
    basis = modal_basis(
        assemble(mesh_structure(Structure("machine", (slab, block, pad), supports=(held,)))), up_to=60.0
    )
    expected = np.sqrt(1e7 * 0.24 / 200.0) / (2 * np.pi)
    assert np.abs(basis.frequency_hz - expected).min() < 1e-9 * expected  # the eigensolver's


def test_a_plate_above_a_slab_with_shear_between_stretches_as_the_slab_does():
    model = mesh_structure(Structure("floating", (FLOOR, COVER, WOOL)))
    assert not model.parts["cover"].rigid_in_plane
    loose = mesh_structure(Structure("floating", (FLOOR, COVER, replace(WOOL, shear=0.0))))
    assert loose.parts["cover"].rigid_in_plane


WRONG = {
    # 0.56 m^2 of the opening and 0.06 m^2 in the corner of the L
    "over an opening": (Region("rectangle", (2.0, 2.0), at=(1.2, 1.3)), r"with 0\.62 m\^2 beside a slab or over"),
    "beside the leg": (Region("rectangle", (1.0, 1.0), at=(3.2, 3.2)), r"got a rectangle with 1 m\^2 beside a slab"),
    "along the box": (Region("rim", (4.0, 4.0)), r"got a rim with 4 m beside a slab .* region of cover and floor"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_a_named_region_off_the_slab_is_refused(name):
    region, message = WRONG[name]
    with pytest.raises(InputError, match=r"parts\.wool\.region: .*" + message):
        mesh_structure(Structure("wrong", (FLOOR, COVER, replace(WOOL, region=region))))


SIZE = (2.0, 1.4)
STIFF = Material("stiff", 30e13, 0.2, 2400.0)
FOOT = (0.7, 0.4)  # of a rectangle, and of a rim
WALL = Plate("s", STIFF, 0.06, (0, 0, 0), SIZE, (5, 4), normal=(0, 1, 0), x_direction=(1, 0, 0), in_plane="elastic")
MIDDLE = PlaceOn("middle", "s", ((1.0, 0.7),))
REGIONS = {
    "whole": (WHOLE, 2.8, 2.8 * 4.0 / 12),
    "rectangle": (Region("rectangle", FOOT), 0.28, 0.28 * 0.49 / 12),
    "rim": (Region("rim", FOOT), 2.2, 2 * 0.7**3 / 12 + 2 * 0.4 * 0.35**2),
}  # fmt: skip
STANDING = {
    "slab": (Slab("s", STIFF, 0.06, ((0, 0), (2.0, 0), SIZE, (0, 1.4)), 0.5), "below", 0.03),
    "slab, raised": (Slab("s", STIFF, 0.06, ((0, 0), (2.0, 0), SIZE, (0, 1.4)), 0.5, offset=0.05), "below", -0.02),
    "slab, from above": (
        Slab("s", STIFF, 0.06, ((0, 0), (2.0, 0), SIZE, (0, 1.4)), 0.5, offset=0.05), "above", -0.08,
    ),
    "slab, upside down": (
        Slab("s", STIFF, 0.06, ((0, 0), (2.0, 0), SIZE, (0, 1.4)), 0.5, normal=(0, 0, -1), x_direction=(1, 0, 0)),
        "below", 0.03,
    ),
    "plate": (Plate("s", STIFF, 0.06, (0, 0, 0), SIZE, (5, 4), in_plane="elastic"), "below", 0.03),
    "rigid plate": (Plate("s", STIFF, 0.06, (0, 0, 0), SIZE, (5, 4), element="hermite12"), "below", 0.03),
    "middle": (Plate("s", STIFF, 0.06, (0, 0, 0), SIZE, (5, 4), in_plane="elastic"), "middle", 0.0),
    "wall": (
        WALL, "-y", 0.03,
    ),
    "other side of a wall": (
        WALL, "y", -0.03,
    ),
}  # fmt: skip


@pytest.mark.parametrize("region", REGIONS)
@pytest.mark.parametrize("case", STANDING)
def test_shear_to_the_ground_tilts_what_stands_on_it(case, region):
    """A force in the plane through its own plane: it slides, and turns by the couple F h about the face; h is the arm
    from the place of the force to the face that is named, along the normal."""
    part, side, arm = STANDING[case]
    where, amount, second = REGIONS[region]
    mat = Foundation("mat", "s", where, 2e7, 5e6, side=side)
    model = mesh_structure(Structure("on a mat", (part, mat), points=(MIDDLE,)))
    assembly = assemble(model)
    normal = np.asarray(part.normal, dtype=float)
    if side == "below" and normal[2] < 0:
        normal = -normal
    probes = {d: model.points["middle"].probe(d) for d in ("x", "y", "z", "rx", "ry", "rz")}
    pushed = {d: (one.row(len(assembly.points)) @ assembly.dofs.T).toarray()[0] for d, one in probes.items()}
    u = spsolve(assembly.K, 1e4 * pushed["x"])
    tilt = 1e4 * arm / (2e7 * second)
    turned = np.array([pushed[d] @ u for d in ("rx", "ry", "rz")])
    # the face lies at -arm along the normal: it slides by F / k, and turns about n x x
    axis = np.cross(normal, np.array([1.0, 0.0, 0.0]))
    assert turned == pytest.approx(tilt * axis, abs=2e-3 * 1e4 * 0.03 / (2e7 * second))  # it bends a little
    assert pushed["x"] @ u == pytest.approx(1e4 / (5e6 * amount) + tilt * arm, rel=1e-3)  # it bends and stretches
    assert assembly.forces["ground"].stiffness @ u == pytest.approx(
        [1e4, 0.0, 0.0], abs=0.02
    )  # rounding: it is 1e6 times as stiff


def test_the_ground_below_a_slab_is_a_block_that_is_held():
    """A soft slab, bent by its mat: the same layer between it and a block that touches it and is held."""
    slab = Slab("s", CONCRETE, 0.06, ((0, 0), (2.0, 0), SIZE, (0, 1.4)), 0.25, offset=0.02)
    block = Block("b", 100.0, (-0.5, -0.5, -1.01), (3.0, 2.4, 1.0))
    foot = PlaceOn("foot", "b", ((1.5, 1.2, 0.0),))
    held = Support("held", "clamped", at="foot")
    found = []
    for parts, more in (
        ((slab, Foundation("mat", "s", WHOLE, 2e7, 5e6)), {"points": ()}),
        ((slab, block, Foundation("mat", "s", WHOLE, 2e7, 5e6, to="b")), {"points": (foot,), "supports": (held,)}),
    ):
        basis = modal_basis(assemble(mesh_structure(Structure("mat", parts, **more))), up_to=250.0)
        found.append(basis.frequency_hz[basis.modes])
    assert len(found[0]) > 8
    assert found[0] == pytest.approx(found[1], rel=1e-8)  # the eigensolver's 1e-9


def test_a_thin_plate_on_a_mat_of_much_shear_stretches_and_its_side_is_one_it_faces():
    plate = Plate("s", CONCRETE, 0.2, (0, 0, 0), SIZE, (5, 4))
    for shear, stretches in ((1e6, False), (5e10, True)):
        mat = Foundation("mat", "s", WHOLE, 2e7, shear)
        assert mesh_structure(Structure("mat", (plate, mat))).parts["s"].stretches == stretches
    with pytest.raises(InputError, match=r"parts\.mat\.side: got 'x', which s does not face"):
        mesh_structure(Structure("mat", (plate, Foundation("mat", "s", WHOLE, 2e7, 5e6, side="x"))))
    block = Block("s", 100.0, (0, 0, 0), (1.0, 1.0, 1.0))
    with pytest.raises(InputError, match=r"parts\.mat\.side: got 'above' of a block"):
        mesh_structure(Structure("mat", (block, Foundation("mat", "s", WHOLE, 2e7, 5e6, side="above"))))
