"""Joints, supports, offsets and foundations against closed forms and against the null space of the equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.sparse import csr_array
from scipy.sparse.linalg import eigsh

from femstruct.assembly.matrices import assemble
from femstruct.assembly.ties import RANK, eliminate, number_dofs
from femstruct.conventions import GRAVITY
from femstruct.modal.statics import sag_displacements
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.regions import Region
from femstruct.model.sections import circle, rectangle
from femstruct.model.structure import Joint, PlaceOn, Structure, Support
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.joint_findings import joint_spring_findings
from femstruct.parts.mass import Mass
from femstruct.parts.plate import Plate
from femstruct.parts.spring import Spring

ROUNDING = 1e-13  # rounding: 4e-16 here at most

STEEL = Material("steel", 206e9, 0.3, 7850.0)
KINDS = ("hermite12", "acm12", "bfs16")


def frequencies(structure: Structure) -> NDArray[np.float64]:
    assembly = assemble(mesh_structure(structure))
    values = eigh(assembly.K.toarray(), assembly.M.toarray(), eigvals_only=True)
    return np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi)


def lowest(structure: Structure, count: int) -> NDArray[np.float64]:
    """By shift-invert, which knows low frequencies beside very high ones; a dense solver does not."""
    assembly = assemble(mesh_structure(structure))
    values = eigsh(
        assembly.K, count, assembly.M, sigma=-1e3, return_eigenvectors=False, v0=np.ones(assembly.K.shape[0])
    )
    return np.sqrt(np.sort(values)) / (2 * np.pi)


def plate(name: str, origin: tuple[float, float, float], size: tuple[float, float], **more: object) -> Plate:
    return Plate(name, STEEL, 0.01, origin, size, 0.1, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", KINDS)
def test_two_plates_joined_in_a_plane_are_one(kind: str) -> None:
    whole = plate("whole", (0, 0, 0), (0.6, 0.3), element=kind)
    left, right = (plate(name, (x, 0, 0), (0.3, 0.3), element=kind) for name, x in (("left", 0.0), ("right", 0.3)))
    turned = plate("right", (0.3, 0.3, 0), (0.3, 0.3), element=kind, x_direction=(0.0, -1.0, 0.0))
    one = frequencies(Structure("one", (whole,)))
    for other in (right, turned):
        two = frequencies(Structure("two", (left, other), (Joint("seam", "left", "right"),)))
        assert len(one) == len(two)
        assert two[6:] == pytest.approx(one[6:], rel=1e-8)  # dense solver
        assert two[:6] == pytest.approx(np.zeros(6), abs=1e-4 * one[6])  # square roots of rounding: 1e-6 here


def test_a_pinned_seam_is_a_hinge() -> None:
    left, right = (plate(name, (x, 0, 0), (0.3, 0.3)) for name, x in (("left", 0.0), ("right", 0.3)))
    hinged = frequencies(Structure("two", (left, right), (Joint("seam", "left", "right", kind="pinned"),)))
    # One more motion without strain: the fold. The in-plane tie keeps both flat.
    assert np.count_nonzero(hinged < 1e-3 * hinged[7]) == 7
    loose = frequencies(
        Structure("two", (left, right), (Joint("seam", "left", "right", stiffness={"rx": 0.0, "ry": 0.0, "rz": 0.0}),))
    )
    assert loose[7:12] == pytest.approx(hinged[7:12], rel=ROUNDING)


@pytest.mark.parametrize("cells", [4, 8])
def test_springs_of_a_seam_are_as_many_as_its_nodes_and_that_is_said(cells: int) -> None:
    """A stiff flap that is clamped beyond the seam turns under its weight by M / (n k), n being the nodes of the seam:
    what is said is that n k."""
    left, right = (
        replace(plate(name, (x, 0, 0), (0.3, 0.3)), thickness=0.1, mesh=(cells, cells))
        for name, x in (("left", 0.0), ("right", 0.3))
    )
    seam = Joint("seam", "left", "right", stiffness={"ry": 10.0})
    model = mesh_structure(Structure("two", (left, right), (seam,), supports=(Support("wall", "clamped", on="left"),)))
    (said,) = joint_spring_findings(model)
    assert said.values["springs"] == cells + 1
    assert f"together ry {10 * (cells + 1)} N m/rad" in said.message
    turned = sag_displacements(assemble(model))
    assert turned is not None
    about = turned[model.parts["right"].nodes, 4]
    exact = model.parts["right"].mass * GRAVITY * 0.15 / (10.0 * (cells + 1))
    assert about == pytest.approx(np.full(len(about), exact), rel=1e-4)  # springs 1e5 times softer than it


def test_springs_at_ends_of_bars_are_of_any_mesh() -> None:
    """Two legs of one frame on a plate of a single cell: both stand on it, and neither is another's neighbour."""
    base = replace(plate("base", (0, 0, 0), (0.3, 0.3)), mesh=(1, 1))
    feet = [((x, 0.0, 0.0), (x, 0.0, 0.5)) for x in (0.0, 0.3)]
    legs = Frame("legs", STEEL, rectangle("s", 0.02, 0.02), tuple(feet), mesh=0.1)
    joint = Joint("hinges", "legs", "base", stiffness={"ry": 10.0})
    assert joint_spring_findings(mesh_structure(Structure("s", (base, legs), (joint,)))) == ()


def test_a_seam_of_stiff_springs_is_rigid() -> None:
    left, right = (plate(name, (x, 0, 0), (0.3, 0.3), element="acm12") for name, x in (("left", 0.0), ("right", 0.3)))
    stiff = frequencies(Structure("two", (left, right), (Joint("seam", "left", "right", stiffness={"ry": 1e8}),)))
    whole = frequencies(Structure("one", (plate("whole", (0, 0, 0), (0.6, 0.3), element="acm12"),)))
    # The springs are 1e4 times stiffer than a cell, so the fold adds 1e-4 of its bending.
    assert stiff[6:9] == pytest.approx(whole[6:9], rel=1e-3)
    assert stiff[6] < whole[6]


def test_a_beam_hinged_in_the_middle() -> None:
    """Clamped ends, hinge in the middle: symmetric modes are those of a cantilever (no shear passes the hinge),
    antisymmetric ones of a clamped-pinned beam. Roots of the frequency equations, Euler-Bernoulli."""
    section = circle("rod", 0.01)
    left, right = (
        Frame(name, STEEL, section, (line,), 0.05, element="euler")
        for name, line in (
            ("left", ((0.0, 0.0, 0.0), (0.5, 0.0, 0.0))),
            ("right", ((0.5, 0.0, 0.0), (1.0, 0.0, 0.0))),
        )
    )
    points = (PlaceOn("start", "left", ((0.0, 0.0, 0.0),)), PlaceOn("end", "right", ((1.0, 0.0, 0.0),)))
    supports = (Support("A", "clamped", at="start"), Support("B", "clamped", at="end"))
    joint = Joint("hinge", "left", "right", kind="pinned")
    found = frequencies(Structure("hinged", (left, right), (joint,), points, supports=supports))
    roots = np.array([1.8751040687, 3.9266023120, 4.6940911330])
    exact = (roots / 0.5) ** 2 * np.sqrt(206e9 * section.Iy / (7850 * section.A)) / (2 * np.pi)
    assert found[:6] == pytest.approx(np.repeat(exact, 2), rel=1e-4)  # ten elements a half: 3e-5 in the third, h^4


def test_crossing_frames_share_a_node_and_a_line_meets_its_own_middle() -> None:
    rod = circle("rod", 0.01)
    beam = Frame("beam", STEEL, rod, (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),))
    stem = Frame("stem", STEEL, rod, (((0.3, 0.0, 0.0), (0.3, 0.0, 0.4)),), 0.2)
    joined = mesh_structure(Structure("T", (beam, stem), (Joint("T", "beam", "stem"),)))
    assert len(joined.parts["beam"].bars) == 2
    own = Frame("both", STEEL, rod, (beam.lines[0], stem.lines[0]), 0.2)
    one = frequencies(Structure("one", (replace(own, mesh=0.2),)))
    two = frequencies(Structure("two", (replace(beam, mesh=0.2), stem), (Joint("T", "beam", "stem"),)))
    assert two[6:20] == pytest.approx(one[6:20], rel=1e-8)  # dense solver, of rounding at the highest: 4e-10 here


def test_a_rigid_arm_shortens_a_cantilever() -> None:
    def cantilever(offset: float) -> NDArray[np.float64]:
        frame = Frame("bar", STEEL, rectangle("s", 0.02, 0.03), (((0, 0, 0), (1.0, 0, 0)),), 0.1)
        frame = replace(frame, start_offset=(offset, 0.0, 0.0))
        return frequencies(
            Structure(
                "arm",
                (frame,),
                points=(PlaceOn("foot", "bar", ((0.0, 0.0, 0.0),)),),
                supports=(Support("wall", "clamped", at="foot"),),
            )
        )

    short = Frame("bar", STEEL, rectangle("s", 0.02, 0.03), (((0.2, 0, 0), (1.0, 0, 0)),), 0.1)
    exact = frequencies(
        Structure(
            "short",
            (short,),
            points=(PlaceOn("foot", "bar", ((0.2, 0.0, 0.0),)),),
            supports=(Support("wall", "clamped", at="foot"),),
        )
    )
    assert cantilever(0.2) == pytest.approx(exact, rel=1e-8)  # dense solver
    assert cantilever(0.0)[0] < 0.9 * exact[0]


def test_heave_sway_and_yaw_of_a_rigid_slab_on_its_rim() -> None:
    stiff = Material("stiff", 1e14, 0.3, 2400.0)
    slab = Plate("slab", stiff, 0.03, (0.0, 0.0, 0.0), (0.6, 0.5), 0.2)
    foam = Foundation("foam", "slab", Region("rim", (0.5, 0.4)), 2e5, 7e4, side="middle")
    found = lowest(Structure("slab", (slab, foam)), 6)
    mass, length = 2400 * 0.03 * 0.6 * 0.5, 1.8
    heave, sway = (np.sqrt(k * length / mass) / (2 * np.pi) for k in (2e5, 7e4))
    # Second moments of the rim's length: about its own middle, straight sides of 0.5 and 0.4 m.
    along_x = 2 * 0.5**3 / 12 + 2 * 0.4 * 0.25**2
    along_y = 2 * 0.4**3 / 12 + 2 * 0.5 * 0.2**2
    rock = [
        np.sqrt(2e5 * moment / (mass * side**2 / 12)) / (2 * np.pi) for moment, side in ((along_x, 0.6), (along_y, 0.5))
    ]
    yaw = np.sqrt(7e4 * (along_x + along_y) / (mass * (0.6**2 + 0.5**2) / 12)) / (2 * np.pi)
    expected = np.sort([heave, sway, sway, *rock, yaw])
    # The slab bends: its own modes lie 300 times higher, which leaves 1e-5.
    assert found == pytest.approx(expected, rel=2e-5)
    # On the lower face the shear has an arm of 15 mm: sway and rock of each direction are coupled.
    pairs = []
    for moment, side in ((along_x, 0.6), (along_y, 0.5)):
        K = [[7e4 * length, -7e4 * length * 0.015], [-7e4 * length * 0.015, 2e5 * moment + 7e4 * length * 0.015**2]]
        pairs.append(np.sqrt(eigh(K, np.diag([mass, mass * side**2 / 12]), eigvals_only=True)) / (2 * np.pi))
    found = lowest(Structure("slab", (slab, replace(foam, side="below"))), 6)
    assert found == pytest.approx(np.sort([heave, yaw, *np.concatenate(pairs)]), rel=2e-5)  # as above


@pytest.mark.parametrize(
    ("region", "per"), [("whole", "area"), ("rectangle", "area"), ("line", "length"), ("rim", "length")]
)
def test_springs_and_spread_masses_give_the_heave_frequency(region: str, per: str) -> None:
    stiff = Material("stiff", 1e14, 0.3, 2400.0)
    slab = Plate("slab", stiff, 0.03, (0.0, 0.0, 0.0), (0.6, 0.5), (2, 2))
    regions = {
        "whole": (Region("whole"), 0.3),
        "rectangle": (Region("rectangle", (0.3, 0.2)), 0.06),
        "line": (Region("line", line=((0.1, 0.25), (0.5, 0.25))), 0.4),
        "rim": (Region("rim", (0.3, 0.2)), 1.0),
    }
    place, measure = regions[region]
    springs = Spring("mounts", "feet", None, (0.0, 0.0, 1e4, 0.0, 0.0, 0.0))
    feet = PlaceOn("feet", "slab", ((0.1, 0.1), (0.5, 0.1), (0.5, 0.4), (0.1, 0.4)))
    guide = Support("guide", ("x", "y", "rx", "ry"), at="feet")
    for unit, value in ((per, 5.0), ("total", 5.0 * measure)):
        load = Mass("load", value, on="slab", region=place, per=unit)  # type: ignore[arg-type]
        found = lowest(Structure("slab", (slab, springs, load), points=(feet,), supports=(guide,)), 1)
        mass = 2400 * 0.03 * 0.3 + 5.0 * measure
        assert found[0] == pytest.approx(np.sqrt(4e4 / mass) / (2 * np.pi), rel=1e-5)  # slab 1e6 times stiffer


def corner() -> Structure:
    """Three plates meeting in a corner, a bar along one edge and a brace across."""
    floor = plate("floor", (0, 0, 0), (0.3, 0.2))
    wall = plate("wall", (0, 0, 0), (0.3, 0.4), normal=(0.0, -1.0, 0.0))
    side = plate("side", (0, 0, 0), (0.2, 0.4), normal=(1.0, 0.0, 0.0), x_direction=(0.0, 1.0, 0.0))
    rod = circle("rod", 0.01)
    bar = Frame("bar", STEEL, rod, (((0, 0, 0), (0, 0, 0.4)),), 0.2)
    brace = Frame("brace", STEEL, rod, (((0.3, 0.2, 0.0), (0.3, 0.0, 0.4)),), 0.2)
    pairs = [("floor", "wall"), ("floor", "side"), ("wall", "side"), ("bar", "wall"), ("bar", "side"), ("bar", "floor")]
    pairs += [("brace", "floor"), ("brace", "wall")]
    return Structure("corner", (floor, wall, side, bar, brace), tuple(Joint(f"{a} on {b}", a, b) for a, b in pairs))


def test_elimination_spans_the_null_space_of_the_equations() -> None:
    model = mesh_structure(corner())
    dofs = number_dofs(model)
    equations = np.concatenate([(tie.rows @ dofs.output).toarray() for tie in model.ties])
    solved = eliminate(csr_array(equations))
    rank = np.linalg.matrix_rank(equations, tol=1e-9)
    assert rank < len(equations)  # there are redundant ones
    assert solved.E.shape == (dofs.count, dofs.count - rank)
    assert np.linalg.matrix_rank(solved.E.toarray()) == dofs.count - rank
    assert np.abs(equations @ solved.E.toarray()).max() <= 1e-12  # rounding of a few sums
    assert len(np.unique(solved.kept)) == len(np.unique(solved.pivots)) == rank


@pytest.mark.parametrize("seed", range(5))
def test_elimination_of_arbitrary_equations(seed: int) -> None:
    random = np.random.default_rng(seed)
    dense = random.standard_normal((30, 40)) * (random.random((30, 40)) < 0.12)
    dense[20:] = random.standard_normal((10, 20)) @ dense[:20] * (random.random((10, 1)) < 0.7)
    solved = eliminate(csr_array(dense))
    rank = np.linalg.matrix_rank(dense, tol=1e-9)
    assert solved.E.shape == (40, 40 - rank)
    scale = max(1.0, np.abs(solved.E.toarray()).max()) * np.abs(dense).max()
    assert np.abs(dense @ solved.E.toarray()).max() <= ROUNDING * scale


@pytest.mark.parametrize("unit", [1e-14, 1e14])
def test_the_unit_of_an_equation_does_not_matter(unit: float) -> None:
    random = np.random.default_rng(6)
    dense = random.integers(-2, 3, (12, 20)).astype(float)
    scaled = np.where(np.arange(12) % 2, 1.0, unit)[:, None] * dense
    one, other = eliminate(csr_array(dense)), eliminate(csr_array(scaled))
    assert np.array_equal(one.kept, other.kept) and np.array_equal(one.pivots, other.pivots)
    assert np.abs((one.E - other.E).toarray()).max() <= 1e-12  # rounding of a dozen sums


@pytest.mark.parametrize(("share", "rank"), [(0.3, 20), (3.0, 21)])
def test_an_equation_is_redundant_by_its_share_of_the_largest(share: float, rank: int) -> None:
    """20 equations repeated 20 times, one of them with a direction of its own of 6e-10 and 6e-9 of the longest column,
    which has the length sqrt(400)."""
    random = np.random.default_rng(7)
    base = np.concatenate([np.ones((20, 1)), random.uniform(-0.5, 0.5, (20, 20))], axis=1)
    equations = np.tile(base, (20, 1))
    turned, _ = np.linalg.qr(base.T, mode="complete")
    equations[0] += share * RANK * 20.0 * turned[:, -1]  # a direction that no other equation has
    assert len(eliminate(csr_array(equations)).kept) == rank


def test_plates_at_right_angles_have_six_rigid_motions() -> None:
    found = frequencies(corner())
    assert np.count_nonzero(found < 1e-3 * found[6]) == 6
    folded = frequencies(Structure("L", (corner().parts[0], corner().parts[1]), (Joint("fold", "floor", "wall"),)))
    assert np.count_nonzero(folded < 1e-3 * folded[6]) == 6


def test_parts_that_meet_within_rounding_are_not_held_by_it() -> None:
    """Seams that disagree by 1e-7 of the size: the redundant equations must stay redundant."""
    left = plate("left", (0, 0, 0), (0.3, 0.3))
    right = plate("right", (0.3, 1e-7, 5e-8), (0.3, 0.3), normal=(1e-7, 0.0, 1.0), x_direction=(1.0, 2e-7, -1e-7))
    posts = Frame("posts", STEEL, circle("rod", 0.01), tuple(((x, 0.3, -0.2), (x, 0.3, 1e-7)) for x in (0.0, 0.3, 0.6)))
    joints = (Joint("seam", "left", "right"), Joint("a", "posts", "left"), Joint("b", "right", "posts"))
    found = frequencies(Structure("nearly", (left, right, posts), joints))
    assert np.count_nonzero(found < 1e-3 * found[6]) == 6


def test_a_plate_standing_on_another_needs_a_line_of_nodes() -> None:
    floor = plate("floor", (0, 0, 0), (0.4, 0.3))
    rib = plate("rib", (0.07, 0.1, 0.0), (0.2, 0.05), normal=(0.0, -1.0, 0.0))
    model = mesh_structure(Structure("rib", (floor, rib), (Joint("weld", "rib", "floor"),)))
    mesh = model.parts["floor"]
    for line in (0.07, 0.27):
        assert np.abs(mesh.x - line).min() <= ROUNDING
    assert np.abs(mesh.y - 0.1).min() <= ROUNDING
    found = frequencies(Structure("rib", (floor, rib), (Joint("weld", "rib", "floor"),)))
    assert np.count_nonzero(found < 1e-3 * found[6]) == 6
    bare = frequencies(Structure("bare", (floor,)))
    assert found[6] > bare[6]  # the rib, rigid in its plane, stiffens more than its mass lowers


@pytest.mark.parametrize(("fix", "factor"), [("simple", 19.7392), ("clamped", 35.9852)])
def test_square_plates_on_all_edges(fix: str, factor: float) -> None:
    """lambda of SSSS is 2 pi^2; of CCCC 35.9852 (Leissa, Vibration of Plates, NASA SP-160, 1969, reproduced widely)."""
    square = Plate("p", STEEL, 0.01, (0.0, 0.0, 0.0), (1.0, 1.0), (8, 8), normal=(1.0, 1.0, 1.0))
    support = Support("rim", fix, "p", edge="all")  # type: ignore[arg-type]
    found = frequencies(Structure("square", (square,), supports=(support,)))
    D = 206e9 * 0.01**3 / 12 / (1 - 0.3**2)
    # bfs16 with eight cells a side: h^4, 0.02 % on the clamped one.
    assert found[0] == pytest.approx(factor * np.sqrt(D / (7850 * 0.01)) / (2 * np.pi), rel=4e-4)
