"""Structures that cannot be meshed are refused in one sentence that names the parts and the numbers."""

from __future__ import annotations

from dataclasses import replace

import pytest

from femstruct.errors import InputError
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.regions import Region
from femstruct.model.sections import circle
from femstruct.model.structure import Joint, PlaceOn, Structure, Support, SurfaceOn
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.mass import Mass
from femstruct.parts.plate import Plate
from femstruct.parts.spring import Spring

STEEL = Material("steel", 206e9, 0.3, 7850.0)
FLOOR = Plate("floor", STEEL, 0.01, (0.0, 0.0, 0.0), (0.4, 0.3), 0.2)
WALL = replace(FLOOR, name="wall", normal=(0.0, -1.0, 0.0))
OTHER = replace(FLOOR, name="other", origin=(0.3, 0.1, 0.0))
ABOVE = replace(FLOOR, name="other", origin=(0.0, 0.0, 0.05))
POST = Frame("post", STEEL, circle("rod", 0.01), (((0.1, 0.1, 0.02), (0.1, 0.1, 0.4)),))
CENTER = PlaceOn("P", "floor", ((0.2, 0.15),))
BASE = Structure("base", (FLOOR, POST), points=(CENTER,))

FAULTS = {
    "apart": (
        replace(BASE, joints=(Joint("j", "post", "floor"),)),
        r"joints.j: got post and floor 0.02 m apart, expected parts that touch",
    ),
    "point off": (
        replace(BASE, points=(PlaceOn("P", "floor", ((0.45, 0.15),)),)),
        r"points.P.at: got \(0.45, 0.15\) m, 0.05 m off floor",
    ),
    "point off bar": (
        replace(BASE, points=(PlaceOn("P", "post", ((0.1, 0.13, 0.1),)),)),
        r"points.P.at: got .* 0.03 m off post",
    ),
    "several points": (
        replace(BASE, points=(PlaceOn("P", "floor", ((0.1, 0.1), (0.1, 0.5))),)),
        r"points.P.2.at: got .* 0.2 m off floor",
    ),
    "region beyond": (
        replace(BASE, parts=(FLOOR, Foundation("foam", "floor", Region("rim", (0.5, 0.2)), 1e5))),
        r"parts.foam.region: got a region that reaches 0.05 m beyond floor",
    ),
    "mesh too fine": (
        replace(BASE, parts=(replace(FLOOR, mesh=1e-5),)),
        r"parts.floor.mesh: got 1e-05 m, 4e\+04 divisions of a side of 0.4 m, expected at most 2000 divisions",
    ),
    "too many divisions": (
        replace(BASE, parts=(replace(FLOOR, mesh=(4, 2001)),)),
        r"parts.floor.mesh: got 2001 divisions, expected 1 to 2000",
    ),
    "too many cells": (
        replace(BASE, parts=(replace(FLOOR, mesh=(1000, 1000)),)),
        r"parts.floor.mesh: got 1e\+06 cells, expected at most 300000; use cells of 0.00063 m or more",
    ),
    "too many cells by size": (
        replace(BASE, parts=(replace(FLOOR, mesh=5e-4),)),  # 800 x 600
        r"parts.floor.mesh: got 4.8e\+05 cells, expected at most 300000",
    ),
    "too many bars": (
        replace(BASE, parts=(FLOOR, replace(POST, mesh=1e-6))),
        r"parts.post.mesh: got 1e-06 m, 3.8e\+05 bars, expected at most 100000 bars; use 3.8e-06 m or more",
    ),
    "region of a frame": (
        replace(BASE, parts=(FLOOR, POST, Mass("m", 1.0, on="post", region=Region("rectangle", (0.1, 0.1))))),
        r"parts.m.region: got a rectangle of a frame, expected all of the frame",
    ),
    "oblique line": (
        replace(BASE, supports=(Support("s", "simple", "floor", line=((0.1, 0.1), (0.2, 0.2))),)),
        r"supports.s.line: got a line over 0.1 m x 0.1 m, expected a line along x or y",
    ),
    "unknown plate": (
        replace(BASE, surfaces=(SurfaceOn("S", "roof"),)),
        r"surfaces.S.region: got 'roof', expected a plate: floor",
    ),
    "steep side": (
        Structure("steep", (WALL,), surfaces=(SurfaceOn("S", "wall"),)),
        r"surfaces.S.side: got 'above' of a plate at 90 degrees",
    ),
    "unknown joint": (
        replace(BASE, joints=(Joint("j", "post", "flor"),)),
        r"joints.j: got 'flor', expected a part with nodes: floor, post",
    ),
    "unknown point": (
        replace(BASE, parts=(FLOOR, Spring("k", "Q", None, (1e3, 0, 0, 0, 0, 0)))),
        r"parts.k.between: got 'Q', expected a point: P",
    ),
    "no stiffness": (
        replace(BASE, parts=(FLOOR, Spring("k", "P", None))),
        r"parts.k: got stiffness and damping",
    ),
    "negative mass": (replace(BASE, parts=(FLOOR, Mass("m", -1.0, at="P"))), r"parts.m.mass: got -1"),
    "mass per": (
        replace(BASE, parts=(FLOOR, Mass("m", 1.0, on="floor", per="length"))),
        r"parts.m.mass: got a mass per length over a whole, expected kg or per area",
    ),
    "taken name": (
        replace(BASE, points=(PlaceOn("floor", "floor", ((0.1, 0.1),)),)),
        r"points.floor: got a name taken by parts.floor",
    ),
    "overlap": (
        Structure("two", (FLOOR, OTHER), (Joint("j", "floor", "other"),)),
        r"plates floor and other: got an overlap of 0.1 m x 0.2 m in one plane",
    ),
    "parallel": (
        Structure("two", (FLOOR, ABOVE), (Joint("j", "floor", "other"),)),
        r"plates floor and other: got mid-surfaces about 0.05 m apart",
    ),
    "oblique plates": (
        Structure(
            "two", (FLOOR, replace(WALL, origin=(0.2, 0.15, 0), normal=(1.0, 1.0, 0.0))), (Joint("j", "floor", "wall"),)
        ),
        r"plates floor and wall: got a common line oblique to the sides of floor",
    ),
    "mesh": (Structure("m", (replace(FLOOR, mesh=0.0),)), r"parts.floor.mesh: got 0 m"),
    "divisions": (Structure("m", (replace(FLOOR, mesh=(0, 2)),)), r"parts.floor.mesh: got 0 divisions"),
    "thickness": (Structure("m", (replace(FLOOR, thickness=-0.01),)), r"parts.floor.thickness: got -0.01 m"),
    "x_direction": (
        Structure("m", (replace(FLOOR, x_direction=(1.0, 0.0, 1.0)),)),
        r"parts.floor.x_direction: got \[1.0, 0.0, 1.0\]",
    ),
    "orientation": (
        Structure("m", (replace(POST, orientation=(0.0, 0.0, 2.0)),)),
        r"parts.post.orientation: got a vector parallel to the member",
    ),
    "no length": (
        Structure("m", (replace(POST, lines=(((0, 0, 0), (0, 0, 0), (0, 0, 1)),)),)),
        r"parts.post.lines\[0\]: got two points 0 m apart",
    ),
    "nothing": (Structure("m", ()), r"parts: got no part with a size, expected a plate, a frame or a block"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_are_one_sentence(fault: str) -> None:
    structure, message = FAULTS[fault]
    with pytest.raises(InputError, match=message) as caught:
        mesh_structure(structure)
    assert "\n" not in str(caught.value)


def test_the_sound_one_is_meshed() -> None:
    assert mesh_structure(BASE).mesh.n_nodes > 0
