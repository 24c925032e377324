"""Elastic layers between two parts: equilibrium, closed forms of rigid and floating parts, grids that do not match."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import spsolve

from femstruct.assembly.matrices import assemble
from femstruct.errors import FemstructError
from femstruct.modal.damping import Damping, FromMaterials, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.regions import Region
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.block import Block
from femstruct.parts.foundation import Foundation
from femstruct.parts.plate import Plate

ROUNDING = 1e-12  # rounding: 7e-15 here at most

CONCRETE = Material("concrete", 30e9, 0.2, 2400.0)
SCREED = Material("screed", 20e9, 0.2, 2000.0)
WHOLE = Region("whole")
ANVIL = Block("anvil", 25e3, (-0.9, -0.7, 1.55), (1.8, 1.4, 1.26), center=(0.8, 0.75, 0.5))
BASE = Block("base", 45e3, (-2.0, -1.5, 0.0), (4.0, 3.0, 1.5))
PAD = Foundation("pad", "base", WHOLE, 1.6e9, 0.5e9, 0.1, to="anvil")


def cross_matrix(r):
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])


def carried(r):
    """Motion at the tip of a rigid arm r from that at its foot [6, 6]."""
    return np.block([[np.eye(3), -cross_matrix(r)], [np.zeros((3, 3)), np.eye(3)]])


def even(normal, shear, a, b):
    """Stiffness [6, 6] of a horizontal layer a x b between rigid faces, at its middle: area and its second moments."""
    second = np.diag([normal * a * b**3 / 12, normal * b * a**3 / 12, shear * (a * b**3 + b * a**3) / 12])
    return np.block([[np.diag([shear, shear, normal]) * a * b, np.zeros((3, 3))], [np.zeros((3, 3)), second]])


def floating(region=WHOLE, normal=9e6, shear=0.0, upper_mesh=(3, 5), eta=0.0, size=(4.0, 3.0)):
    """A screed of 50 mm on 30 mm of wool on a slab of 180 mm; the gap is that between their faces."""
    slab = Plate("slab", CONCRETE, 0.18, (0.0, 0.0, 0.0), (4.0, 3.0), (4, 3))
    screed = Plate("screed", SCREED, 0.05, (0.0, 0.0, 0.09 + 0.03 + 0.025), size, upper_mesh)
    wool = Foundation("wool", "screed", region, normal, shear, eta, to="slab")
    return Structure("floating floor", (slab, screed, wool), points=(PlaceOn("mid", "screed", ((1.3, 1.1),)),))


def test_a_floating_screed_bounces_on_its_wool():
    """sqrt(s' (1/m1 + 1/m2)) / 2 pi: both move as plates, whatever their bending stiffness, as the wool is even."""
    basis = with_damping(modal_basis(assemble(mesh_structure(floating(eta=0.2))), up_to=60.0), Damping(FromMaterials()))
    expected = np.sqrt(9e6 * (1 / (2400 * 0.18) + 1 / (2000 * 0.05))) / (2 * np.pi)
    at = int(np.argmin(np.abs(basis.frequency_hz - expected)))
    assert basis.frequency_hz[at] == pytest.approx(expected, rel=1e-9)  # the eigensolver's 1e-9
    assert basis.damping_ratio[at] == pytest.approx(0.1, rel=ROUNDING)
    # Both are free: three motions in the plane and heave and two tilts together, and without shear three in the plane
    # of each.
    assert basis.n_rigid == 9


@pytest.mark.parametrize("shear", [0.0, 4e6])
@pytest.mark.parametrize("upper", ["level", "steep"])
def test_a_rigid_motion_of_both_strains_nothing(shear, upper):
    structure = floating(shear=shear)
    if upper == "steep":  # two walls face to face, the second turned by a quarter
        first = Plate("screed", SCREED, 0.05, (0.0, 0.0, 0.0), (4.0, 3.0), (3, 5), normal=(0.0, 1.0, 0.0))
        second = Plate(
            "slab", CONCRETE, 0.18, (3.5, 0.2, -2.0), (3.0, 4.0), (4, 3), normal=(0.0, -1.0, 0.0), x_direction=(0, 0, 1)
        )
        structure = replace(structure, parts=(first, second, structure.parts[2]), points=())
    assembly = assemble(mesh_structure(structure))
    points = assembly.points
    motion = np.zeros((len(points), 7, 6))
    motion[:, :3, :3], motion[:, 3:6, 3:] = np.eye(3), np.eye(3)
    for axis in range(3):
        motion[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], points)
    T = assembly.dofs.T.toarray()
    free = np.linalg.lstsq(T, motion.reshape(-1, 6), rcond=None)[0]
    assert np.abs(T @ free - motion.reshape(-1, 6)).max() < ROUNDING
    wool = assembly.part_stiffness["wool"]
    assert np.abs(wool @ free).max() < ROUNDING * np.abs(wool).max() * np.abs(free).max() * 10


def test_shear_of_the_layer_has_arms_to_its_middle():
    """Moved apart by one metre the wool resists with its area; turned about y by one, slab and screed shear it by their
    arms to its middle, 0.09 + 0.015 m and 0.015 + 0.025 m."""
    assembly = assemble(mesh_structure(floating(normal=0.0, shear=4e6)))
    nodes = mesh_structure(floating()).mesh.nodes
    center = np.array([2.0, 1.5, 0.0])
    wool = assembly.part_stiffness["wool"]
    T = assembly.dofs.T.toarray()

    def moved(part, shift, turn):
        motion = np.zeros((len(assembly.points), 7))
        own = nodes[part]
        arm = assembly.points[own] - center
        arm[:, 2] = 0.0
        motion[own, :3], motion[own, 3:6] = shift + np.cross(turn, arm), turn
        return np.linalg.lstsq(T, motion.ravel(), rcond=None)[0]

    x, y, none = np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), np.zeros(3)
    for part, arm in (("slab", 0.105), ("screed", -0.040)):
        for shift, turn, slip in ((x, none, 1.0), (none, y, arm), (y, none, 1.0), (none, x, arm)):
            u = moved(part, shift, turn)
            assert u @ (wool @ u) == pytest.approx(4e6 * 12.0 * slip**2, rel=ROUNDING)


def test_energy_is_exact_on_grids_that_do_not_match():
    """w = x^3 y of the screed against w = x y^3 of the slab, in the rectangle they share of two shifted grids."""
    slab = Plate("slab", CONCRETE, 0.1, (0.0, 0.0, 0.0), (2.0, 1.0), (3, 2))
    screed = Plate("screed", SCREED, 0.04, (0.4, -0.2, 0.12), (1.1, 0.9), (2, 4))
    layer = Foundation("layer", "slab", WHOLE, 7.0, to="screed")
    model = mesh_structure(Structure("shifted", (slab, screed, layer)))
    assembly = assemble(model)
    values = np.zeros((model.mesh.n_nodes, 7))
    for name, field in (("slab", "x y^3"), ("screed", "x^3 y")):
        own = model.mesh.nodes[name]
        x, y = model.mesh.points[own, :2].T
        if field == "x^3 y":
            values[own, 2], values[own, 3], values[own, 4], values[own, 6] = x**3 * y, x**3, -3 * x**2 * y, 3 * x**2
        else:
            values[own, 2], values[own, 3], values[own, 4], values[own, 6] = x * y**3, 3 * x * y**2, -(y**3), 3 * y**2
    free = np.linalg.lstsq(assembly.dofs.T.toarray(), values.ravel(), rcond=None)[0]
    found = free @ (assembly.part_stiffness["layer"] @ free)
    nodes, weights = np.polynomial.legendre.leggauss(8)  # exact for degree 15 in one piece
    x, y = 0.95 + 0.55 * nodes[:, None], 0.35 + 0.35 * nodes
    exact = 7.0 * np.einsum("i,j,ij", 0.55 * weights, 0.35 * weights, (x**3 * y - x * y**3) ** 2)
    assert found == pytest.approx(exact, rel=ROUNDING)


@pytest.mark.parametrize("region", [WHOLE, Region("rectangle", (2.0, 1.0), at=(1.5, 1.0)), Region("rim", (3.0, 2.0))])
@pytest.mark.parametrize("swapped", [False, True])
def test_the_force_of_a_layer_is_the_load_it_carries(region, swapped):
    structure = floating(region, shear=4e6)
    if swapped:
        wool = replace(structure.parts[2], on="slab", to="screed")
        structure = replace(structure, parts=(*structure.parts[:2], wool))
    held = replace(structure, supports=(Support("walls", "simple", on="slab", edge="all"),))
    model = mesh_structure(held)
    assembly = assemble(model)
    load = (model.points["mid"].probe("z").row(len(assembly.points)) @ assembly.dofs.T).toarray()[0]
    u = spsolve(assembly.K, load)
    # On the second part: with the screed named first, down to the slab goes what pushes the screed.
    carried = assembly.forces["wool"].stiffness @ u
    assert carried == pytest.approx([0.0, 0.0, -1.0 if swapped else 1.0], abs=ROUNDING)
    assert assembly.forces["ground"].stiffness[[2]] @ u == pytest.approx([1.0], abs=ROUNDING)


def test_a_pad_between_blocks_is_twelve_by_twelve():
    """Stiffness of an even layer between rigid faces: area and second moments of area, at the middle of the gap."""
    held = Foundation("soil", "base", Region("rectangle", (3.0, 2.0)), 5e6, 2e6)
    basis = modal_basis(assemble(mesh_structure(Structure("hammer", (ANVIL, BASE, PAD, held)))), count=12)
    centers = [np.add(block.origin, block.center or block.middle) for block in (ANVIL, BASE)]
    middle = np.array([0.0, 0.0, 1.525])
    relative = np.concatenate([carried(middle - centers[0]), -carried(middle - centers[1])], axis=1)
    down = np.concatenate([np.zeros((6, 6)), carried(-centers[1])], axis=1)
    K = relative.T @ even(1.6e9, 0.5e9, 1.8, 1.4) @ relative + down.T @ even(5e6, 2e6, 3.0, 2.0) @ down
    M = np.diag([25e3] * 3 + list(ANVIL.moments) + [45e3] * 3 + list(BASE.moments))
    assert basis.omega == pytest.approx(np.sqrt(eigh(K, M, eigvals_only=True)), rel=1e-10)  # rounding: 1e-13 here


def test_a_pad_under_weight_is_pressed_evenly():
    held = Support("floor", ("x", "y", "z", "rx", "ry", "rz"), on="base")
    anvil = replace(ANVIL, center=None)
    model = mesh_structure(Structure("anvil", (anvil, BASE, PAD), supports=(held,)))
    assembly = assemble(model)
    u = spsolve(assembly.K, -9.81 * assembly.momentum[2])
    moved = (assembly.dofs.T @ u).reshape(-1, 7)[model.parts["anvil"].first]
    assert moved[2] == pytest.approx(-25e3 * 9.81 / (1.6e9 * 1.8 * 1.4), rel=ROUNDING)
    assert moved[[0, 1, 3, 4, 5]] == pytest.approx(0.0, abs=1e-15)  # rounding: none here
    # The first part named pushes the second: the base lifts the anvil.
    assert assembly.forces["pad"].stiffness @ u == pytest.approx([0.0, 0.0, 25e3 * 9.81], rel=1e-10, abs=1e-6)
    assert assembly.forces["ground"].stiffness @ u == pytest.approx([0.0, 0.0, -25e3 * 9.81], rel=1e-10, abs=1e-6)


@pytest.mark.parametrize("named_first", ["machine", "plate"])
def test_a_block_on_a_plate_presses_its_footprint(named_first):
    """Both moved rigidly, each in its own way: the energy is that of the even layer between, through both arms."""
    block = Block("machine", 200.0, (0.5, 0.3, 0.07), (0.6, 0.4, 0.5))
    plate = Plate("plate", CONCRETE, 0.1, (0.0, 0.0, 0.0), (2.0, 1.5), (5, 4))
    pad = Foundation("pad", named_first, WHOLE, 1e7, 3e6, to="plate" if named_first == "machine" else "machine")
    model = mesh_structure(Structure("machine", (plate, block, pad)))
    for lines, wanted in ((model.parts["plate"].x, (0.5, 1.1)), (model.parts["plate"].y, (0.3, 0.7))):
        assert all(np.abs(lines - at).min() < 1e-9 for at in wanted)  # grid lines at the edges of the pad
    assembly = assemble(model)
    T = assembly.dofs.T.toarray()
    motions = np.random.default_rng(3).standard_normal((2, 6))
    wanted = np.zeros((model.mesh.n_nodes, 7))
    for name, motion in zip(("machine", "plate"), motions, strict=True):
        for node in model.mesh.nodes[name]:
            wanted[node, :6] = carried(model.mesh.points[node]) @ motion
    free = np.linalg.lstsq(T, wanted.ravel(), rcond=None)[0]
    assert np.abs(T @ free - wanted.ravel()).max() < ROUNDING
    slip = carried(np.array([0.8, 0.5, 0.06])) @ (motions[0] - motions[1])  # faces at z = 0.05 and 0.07
    energy = free @ (assembly.part_stiffness["pad"] @ free)
    assert energy == pytest.approx(slip @ even(1e7, 3e6, 0.6, 0.4) @ slip, rel=ROUNDING)


WRONG = {
    "into each other": (
        replace(PAD, to="low"), r"parts\.pad\.between: got low reaching 0.3 m into base, .*half its thickness",
    ),
    "no face": (replace(PAD, to="far"), r"parts\.pad\.between: got base and far, which do not face each other"),
    "at an angle": (replace(PAD, to="turned"), r"parts\.pad\.between: got base and turned with sides at an angle"),
    "beyond the other": (
        replace(PAD, region=Region("rectangle", (2.0, 1.0))), r"parts\.pad\.region: .* reaches 0.1 m beyond anvil",
    ),
    "beyond the first": (
        replace(PAD, region=Region("rectangle", (5.0, 1.0))), r"parts\.pad\.region: .* reaches 0.5 m beyond base",
    ),
    "itself": (replace(PAD, to="base"), r"parts\.pad\.between: got 'base' twice"),
    "nobody": (replace(PAD, to="nobody"), r"parts\.pad\.between: got 'nobody', expected a plate, slab or block: base"),
    "nothing": (replace(PAD, normal=0.0, shear=0.0), r"parts\.pad\.stiffness: got 0, 0"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_refused(name):
    pad, message = WRONG[name]
    others = (
        Block("low", 1.0, (0.0, 0.0, 1.2), (1.0, 1.0, 1.0)),
        Block("far", 1.0, (9.0, 9.0, 1.2), (1.0, 1.0, 1.0)),
        Plate("turned", CONCRETE, 0.1, (0.0, 0.0, 3.0), (1.0, 1.0), (2, 2), x_direction=(1.0, 0.3, 0.0)),
    )
    with pytest.raises(FemstructError, match=message):
        mesh_structure(Structure("wrong", (BASE, ANVIL, *others, pad)))
