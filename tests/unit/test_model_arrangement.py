"""Findings about how a structure is put together: loose and falling pieces, held and doubled parts, one heavy mass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from femstruct.errors import Finding
from femstruct.model.materials import EdgeWall, Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.part import Part
from femstruct.model.regions import Region
from femstruct.model.sections import Section, rectangle
from femstruct.model.structure import Joint, PlaceOn, Structure, Support
from femstruct.parts.arrangement_findings import arrangement_findings, duplicate_findings
from femstruct.parts.block import Block
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.inertia import Inertia
from femstruct.parts.joint_findings import pieces
from femstruct.parts.mass import Mass
from femstruct.parts.plate import Plate
from femstruct.parts.slab import Slab
from femstruct.parts.spring import Spring

STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0)
SECTION = rectangle("bar", 0.02, 0.02)
TOP = Plate("top", STEEL, 0.01, (0.0, 0.0, 0.7), (1.2, 0.8), 0.2)
CORNERS = [(x, y) for x in (0.0, 1.2) for y in (0.0, 0.8)]
LEGS = Frame("legs", STEEL, SECTION, tuple(((x, y, 0.0), (x, y, 0.7)) for x, y in CORNERS))
FEET = PlaceOn("feet", "legs", tuple((x, y, 0.0) for x, y in CORNERS))
STAND = Support("floor", "clamped", at="feet")
GLUE = Joint("glue", "legs", "top")
TABLE = Structure("table", (TOP, LEGS), (GLUE,), (FEET,), supports=(STAND,))


def told(structure: Structure, joined=(), gravity: bool = False) -> tuple[Finding, ...]:
    return arrangement_findings(mesh_structure(structure), joined, gravity)


def the(found: tuple[Finding, ...]) -> Finding:
    (one,) = found
    return one


def test_nothing_is_said_of_a_table_or_of_a_free_plate() -> None:
    assert told(TABLE, gravity=True) == ()
    assert told(Structure("free", (TOP,))) == ()
    assert duplicate_findings(TABLE) == ()


def test_a_top_that_no_joint_holds_is_told_with_where_it_touches() -> None:
    found = the(told(replace(TABLE, joints=())))
    assert (found.code, found.severe) == ("parts-not-joined", True)
    assert found.message.startswith("legs (4 pieces): no connection to top, although parts touch at (")
    assert found.values["pieces"] == 5  # every leg by itself, and the top


def test_each_leg_is_a_piece_of_its_own() -> None:
    """Three joined legs and one 5 cm too short: the short one, not the frame, is what nothing joins."""
    lines = (*LEGS.lines[:3], ((1.2, 0.8, 0.0), (1.2, 0.8, 0.65)))
    structure = replace(TABLE, parts=(TOP, replace(LEGS, lines=lines)))
    found = the(told(structure))
    assert "legs (the piece at (1.2, 0.8, 0) m): no connection to top, legs. " in found.message
    assert "Each vibrates separately" in found.message
    assert not found.severe  # it is held at its foot, and touches nothing


@pytest.mark.parametrize("kind", ["plate", "slab"])
def test_a_rib_that_hangs_in_the_air_is_told(kind: str) -> None:
    """A bar of 30 x 60 mm under a plate of 10 mm: 35 mm below its middle it touches it, 37 mm below it does not."""
    slab = Slab("top", STEEL, 0.01, ((0.0, 0.0), (1.2, 0.0), (1.2, 0.8), (0.0, 0.8)), 0.2)
    top = replace(TOP, origin=(0.0, 0.0, 0.0)) if kind == "plate" else slab

    def found(z: float, section: Section) -> Finding:
        rib = Frame("rib", STEEL, section, (((0.0, 0.4, z), (1.2, 0.4, z)),), mesh=0.3)
        points = (PlaceOn("a", "rib", ((0.0, 0.4, z),)), PlaceOn("b", "rib", ((1.2, 0.4, z),)))
        held = tuple(Support(f"hold {name}", "clamped", at=name) for name in "ab")
        box = Region("box", box=((-1.0, -1.0, -1.0), (2.0, 0.1, 1.0)))
        on = {"edge": "all"} if kind == "plate" else {"region": box}
        top_held = Support("edges", "clamped", on="top", **on)
        structure = Structure("s", (top, rib), (), points, supports=(*held, top_held))
        return next(one for one in told(structure) if one.code == "parts-not-joined")

    upright, flat = rectangle("r", 0.03, 0.06), rectangle("r", 0.06, 0.03)
    near = found(-0.035, upright)
    assert near.severe
    assert "although the bars of rib lie 35 mm beside the middle of top at (0, 0.4, -0.035) m" in near.message
    for z, section in ((-0.037, upright), (-0.035, flat)):
        far = found(z, section)
        assert not far.severe and "beside the middle" not in far.message
    assert "lie 20 mm beside" in found(-0.02, flat).message


def test_what_floats_is_severe_and_what_a_study_joins_is_not_told() -> None:
    lid = Plate("lid", STEEL, 0.01, (0.0, 0.0, 0.8), (1.2, 0.8), 0.4)
    middle = PlaceOn("middle", "top", ((0.6, 0.4),)), PlaceOn("under", "lid", ((0.6, 0.4),))
    structure = replace(TABLE, parts=(*TABLE.parts, lid), points=(FEET, *middle))
    found = the(told(structure))
    assert found.severe
    assert "lid: no connection to top, legs. It can move freely" in found.message
    assert found.values["free_motions"] == 6
    assert told(structure, joined=[("middle", "under")]) == ()
    spring = Spring("spring", "middle", "under", (0.0, 0.0, 1e5, 0.0, 0.0, 0.0))
    assert told(replace(structure, parts=(*structure.parts, spring))) == ()
    felt = Foundation("felt", "lid", Region("whole"), 1e6, to="top")
    assert told(replace(structure, parts=(*structure.parts, felt))) == ()


def test_two_structures_that_are_both_held_vibrate_by_themselves() -> None:
    lid = Plate("lid", STEEL, 0.01, (0.0, 0.0, 0.8), (1.2, 0.8), 0.4)
    held = Support("walls", "simple", on="lid", edge="all")
    found = the(told(replace(TABLE, parts=(*TABLE.parts, lid), supports=(STAND, held))))
    assert not found.severe
    assert "Each vibrates separately" in found.message


# what holds the top, and which of its motions are left free: along x and y, and about z, do not raise it
HELD = {
    "nothing": ((), 6, True),
    "two edges, up and down": (tuple(Support(e, ("z",), on="top", edge=e) for e in ("x0", "x1")), 3, False),
    "one edge, up and down": ((Support("e", ("z",), on="top", edge="x0"),), 4, True),
    "its corners": ((Support("e", ("z",), at="corners"),), 3, False),
    "sideways only": ((Support("e", ("x", "y"), on="top", edge="all"),), 3, True),
}


@pytest.mark.parametrize("name", HELD)
def test_weight_needs_supports_that_balance_it(name: str) -> None:
    supports, free, falls = HELD[name]
    corners = PlaceOn("corners", "top", tuple(CORNERS))
    structure = Structure("top", (TOP,), points=(corners,), supports=supports)
    (piece,) = pieces(mesh_structure(structure))
    assert (len(piece.free), piece.falls) == (free, falls)
    assert piece.mass == pytest.approx(1.2 * 0.8 * 0.01 * 7850)
    assert told(structure, gravity=False) == ()
    found = told(structure, gravity=True)
    assert [(one.code, one.severe) for one in found] == [("nothing-carries-weight", True)] * falls


def test_a_body_on_one_spring_below_its_centre_of_mass_does_not_fall() -> None:
    """Three rotations and two shifts are free, its weight moves none of them; beside its centre it tips over."""
    block = Block("block", 100.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    spring = Spring("spring", "foot", None, (0.0, 0.0, 1e6, 0.0, 0.0, 0.0))
    for x, falls in ((0.5, False), (0.4, True)):
        foot = PlaceOn("foot", "block", ((x, 0.5, 0.0),))
        (piece,) = pieces(mesh_structure(Structure("s", (block, spring), points=(foot,))))
        assert (len(piece.free), piece.falls) == (5, falls)


UP = replace(TOP, name="up", normal=(1.0, 0.0, 0.0), x_direction=(0.0, 1.0, 0.0))
TURNED = Support("e", (), on="top", edge="all", stiffness={"about edge": 40e3})
BRICK = EdgeWall(Material("brick", E=5e9, nu=0.2, rho=1400.0), 0.175)
FOOT = Support("foot", ("z",), on="up", edge="y0")
# what holds a plate, and what forbids trust without gravity and with it
TURNING = {
    "alone": (TOP, (TURNED,), ["edge-only-turned"], ["nothing-carries-weight"]),
    "with springs across": (TOP, (replace(TURNED, stiffness={"about edge": 40e3, "z": 1e6}),), [], []),
    "on a pinned edge": (TOP, (replace(TURNED, fix="simple"),), [], []),
    "with another support": (TOP, (TURNED, Support("c", ("z",), at="corners")), [], []),
    "sideways only": (
        TOP, (TURNED, Support("s", ("x", "y"), on="top", edge="all")), ["edge-only-turned"], ["nothing-carries-weight"],
    ),
    "walls at an edge that is not pinned": (
        TOP, (Support("w", ("x",), on="top", edge="all", walls=(BRICK,)),), ["edge-only-turned"],
        ["nothing-carries-weight"],
    ),
    "walls at a pinned edge": (TOP, (Support("w", "simple", on="top", edge="all", walls=(BRICK,)),), [], []),
    "standing on its foot": (UP, (replace(TURNED, on="up"), FOOT), *(["edge-only-turned"],) * 2),
}  # fmt: skip


@pytest.mark.parametrize("name", TURNING)
def test_an_edge_that_is_only_held_against_rotation_lets_its_part_move_away(name: str) -> None:
    plate, supports, without, with_gravity = TURNING[name]
    corners = PlaceOn("corners", plate.name, tuple(CORNERS))
    structure = Structure("turned", (plate,), points=(corners,), supports=supports)
    assert [one.code for one in told(structure, gravity=False) if one.severe] == without
    assert [one.code for one in told(structure, gravity=True) if one.severe] == with_gravity


def test_extra_masses_weigh_where_they_are() -> None:
    """A plate on a line of supports through its middle balances, and with a mass beside the line it does not."""
    line = Support("line", ("z",), on="top", line=((0.6, 0.0), (0.6, 0.8)))
    point = PlaceOn("p", "top", ((0.9, 0.4),))
    balanced = Structure("s", (TOP,), points=(point,), supports=(line,))
    assert told(balanced, gravity=True) == ()
    loaded = replace(balanced, parts=(TOP, Mass("m", 1.0, at="p")))
    assert [found.code for found in told(loaded, gravity=True)] == ["nothing-carries-weight"]


@pytest.mark.parametrize("fix", ["simple", "clamped"])
def test_a_mesh_of_one_cell_on_its_edges_moves_nowhere(fix) -> None:
    coarse = replace(TOP, mesh=(1, 1))
    edges = Support("edges", fix, on="top", edge="all")
    found = the(told(Structure("s", (coarse,), supports=(edges,))))
    assert (found.code, found.severe) == ("nothing-moves", True)
    assert "top: supports hold the deflection of every node (4)" in found.message
    assert told(Structure("s", (replace(TOP, mesh=(2, 2)),), supports=(edges,))) == ()


def test_bars_and_blocks_held_everywhere() -> None:
    ends = PlaceOn("ends", "bar", ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
    pins = Support("pins", "simple", at="ends")
    for element, held in (("timoshenko", True), ("timoshenko18", False)):  # the third node moves
        bar = Frame("bar", STEEL, SECTION, (ends.at,), element=element)
        found = told(Structure("s", (bar,), points=(ends,), supports=(pins,)))
        assert bool(found) == held
    block = Block("block", 100.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    held = Support("still", ("x", "y", "z"), on="block")
    assert [found.code for found in told(Structure("s", (block, TOP), supports=(held,)))][-1] == "nothing-moves"


def test_a_mass_of_a_million_times_the_rest_is_told() -> None:
    point = PlaceOn("p", "top", ((0.9, 0.4),))
    rest = 1.2 * 0.8 * 0.01 * 7850
    for factor, dominates in ((0.9e6, False), (1.1e6, True)):
        heavy = Mass("heavy", factor * rest, at="p")
        found = told(Structure("s", (TOP, heavy), points=(point,)))
        assert [one.code for one in found] == ["one-mass-dominates"] * dominates
    assert found[0].severe
    assert "heavy has" in found[0].message


def twice(*parts: Part, joints=(), points=()) -> tuple[Finding, ...]:
    return duplicate_findings(Structure("s", parts, joints, points))


# height above the first, turned about its normal or not, and the share of 10 mm that both fill
@pytest.mark.parametrize(
    ("height", "turned", "share"), [(0.0, False, 1.0), (0.0, True, 1.0), (2e-3, False, 0.8), (8e-3, False, 0.2)]
)
def test_two_plates_in_one_place(height: float, turned: bool, share: float) -> None:
    along, origin = ((0.0, 1.0, 0.0), (1.2, 0.0, 0.7 + height)) if turned else (None, (0.3, 0.1, 0.7 + height))
    again = replace(TOP, name="again", origin=origin, x_direction=along)
    found = the(twice(TOP, again))
    assert (found.code, found.severe) == ("overlapping-parts", share > 0.5)
    assert found.values["share"] == pytest.approx(share)
    assert found.message.startswith("top and again overlap: ")


def test_plates_and_blocks_beside_each_other_are_two() -> None:
    assert twice(TOP, replace(TOP, name="above", origin=(0.0, 0.0, 0.71))) == ()
    assert twice(TOP, replace(TOP, name="beside", origin=(1.2, 0.0, 0.7))) == ()
    assert twice(TOP, replace(TOP, name="wall", normal=(1.0, 0.0, 0.0))) == ()
    block = Block("block", 100.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    assert twice(block, replace(block, name="next", origin=(1.0, 0.0, 0.0))) == ()
    inside = replace(block, name="inside", size=(0.5, 0.5, 0.5))
    assert the(twice(block, inside)).severe
    assert twice(block, inside, joints=(Joint("one body", "block", "inside"),)) == ()


def test_a_line_given_twice_is_told_whatever_its_points() -> None:
    line = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    frame = Frame("rail", STEEL, SECTION, (line, ((0.75, 0.0, 0.0), (0.25, 0.0, 0.0))))
    found = the(twice(frame))
    assert (found.code, found.severe) == ("overlapping-lines", True)
    assert "rail has a line twice, 1 straight piece of 0.5 m" in found.message
    other = Frame("other", STEEL, rectangle("r", 0.03, 0.01), (line,))
    one = Frame("one", STEEL, SECTION, (line,))
    assert the(twice(one, other)).severe
    assert not the(twice(one, other, joints=(Joint("bolted", "one", "other"),))).severe  # a bar made of two
    for apart in (((1.0, 0, 0), (2.0, 0, 0)), ((0.0, 0, 0), (0.0, 1, 0)), ((0.0, 0.01, 0), (1.0, 0.01, 0))):
        assert twice(one, replace(other, lines=(apart,))) == ()
    ring = Frame("ring", STEEL, SECTION, (((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 0)),))
    assert twice(ring) == ()


def test_masses_springs_and_layers_given_twice() -> None:
    points = (
        PlaceOn("p", "top", ((0.3, 0.4),)),
        PlaceOn("q", "top", ((0.3, 0.4),)),
        PlaceOn("r", "top", ((0.5, 0.4),)),
    )
    mass = Mass("one", 2.0, at="p")
    again = the(twice(TOP, mass, Mass("two", 2.0, at="q"), points=points))
    assert (again.code, again.severe) == ("duplicate-part", True)
    assert again.message.startswith("one and two are one mass in one place, given twice")
    for other in (Mass("two", 2.5, at="p"), Mass("two", 2.0, at="r")):
        assert twice(TOP, mass, other, points=points) == ()
    stiff = (0.0, 0.0, 1e5, 0.0, 0.0, 0.0)
    springs = Spring("a", "p", "r", stiff), Spring("b", "r", "q", stiff)
    assert "one spring" in the(twice(TOP, *springs, points=points)).message
    layers = (Foundation(name, "top", Region("whole"), 1e6) for name in ("felt", "cork"))
    assert "felt and cork are one layer" in the(twice(TOP, *layers)).message
    spread = (Mass(name, 5.0, on="top", region=Region("rim", (1.0, 0.6)), per="length") for name in ("m", "n"))
    assert "m and n are one mass" in the(twice(TOP, *spread)).message
    pumps = [Inertia(name, at, 8.0, (0.1, 0.1, 0.2), offset=(0.0, 0.0, 0.05)) for name, at in (("m", "p"), ("n", "q"))]
    assert "m and n are one concentrated body" in the(twice(TOP, *pumps, points=points)).message
    for other in (replace(pumps[1], at="r"), replace(pumps[1], products=(0.01, 0.0, 0.0))):
        assert twice(TOP, pumps[0], other, points=points) == ()


@pytest.mark.parametrize(("normal", "shear", "free"), [(1e6, 1e6, 0), (1e6, 0.0, 3), (0.0, 1e6, 3)])
def test_a_layer_resists_along_its_normal_and_in_its_plane(normal: float, shear: float, free: int) -> None:
    """24 000 displacements of 500 cells, of which some thousand are looked at: all three directions are among them."""
    bed = Foundation("bed", "top", Region("whole"), normal, shear)
    (piece,) = pieces(mesh_structure(Structure("s", (replace(TOP, mesh=(20, 25)), bed))))
    assert len(piece.free) == free
    assert piece.falls == (normal == 0.0)


def test_pieces_of_a_large_model_cost_little() -> None:
    """A graph, no pairs of nodes: 40 000 of them within a second or so."""
    model = mesh_structure(Structure("s", (replace(TOP, mesh=(200, 200)),)))
    (piece,) = pieces(model)
    assert len(piece.nodes) == 201**2
    assert np.linalg.matrix_rank(piece.free) == 6
