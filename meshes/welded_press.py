"""Makes welded_press.msh with Gmsh: the frame of a gap press, welded of plates, and its ram, a block; in millimetres.

    python meshes/welded_press.py [SIZE OF A CELL in mm]

Two C-shaped side plates stand 500 mm apart; table, crown, throat and covers close them to boxes. Sets: sides, table,
crown, throat, covers of shells, frame of all of them, ram of hexahedra. Needs Gmsh (pip install gmsh).
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import gmsh

X = (0.0, 400.0, 900.0)  # back, throat, front
Y = (-250.0, 250.0)
Z = (0.0, 600.0, 1100.0, 1600.0)  # ground, table, crown, top
RAM = (520.0, -130.0, 850.0, 260.0, 260.0, 220.0)  # lower corner and sides


def main(path: Path, cell: float = 50.0) -> None:
    """Write the mesh: rectangles between the lines above, each of equal cells."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("welded press")
    throat = (X[1], Z[1])
    sides = [(y, x, z) for y in Y for x in pairwise(X) for z in pairwise(Z) if (x[0], z[0]) != throat]
    made = {
        "sides": [rectangle((x[0], y, z[0]), (x[1], y, z[1])) for y, x, z in sides],
        "table": [level(Z[1], X[1:])],
        "crown": [level(Z[2], X[1:])],
        "throat": [upright(X[1], Z[1:3])],
        "covers": [level(z, x) for z in (Z[0], Z[3]) for x in pairwise(X)]
        + [upright(X[0], z) for z in pairwise(Z)]
        + [upright(X[2], z) for z in (Z[:2], Z[2:])],
    }
    flat = [(2, tag) for tags in made.values() for tag in tags]
    _, pieces = gmsh.model.occ.fragment(flat, [])  # edges in common
    box = gmsh.model.occ.addBox(*RAM)
    gmsh.model.occ.synchronize()
    owner = [name for name, tags in made.items() for _ in tags]
    for name in (*made, "frame"):
        found = [tag for one, piece in zip(owner, pieces, strict=True) if name in (one, "frame") for _, tag in piece]
        gmsh.model.addPhysicalGroup(2, found, name=name)
    gmsh.model.addPhysicalGroup(3, [box], name="ram")
    for _, tag in gmsh.model.getEntities(1):
        gmsh.model.mesh.setTransfiniteCurve(tag, 1 + round(gmsh.model.occ.getMass(1, tag) / cell))
    for _, tag in gmsh.model.getEntities(2):
        gmsh.model.mesh.setTransfiniteSurface(tag)
        gmsh.model.mesh.setRecombine(2, tag)
    gmsh.model.mesh.setTransfiniteVolume(box)
    gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.write(str(path))
    gmsh.finalize()


def rectangle(low: tuple[float, float, float], high: tuple[float, float, float]) -> int:
    """A plate between two corners, across the axis along which they do not differ."""
    (x, y, z), (u, v, w) = low, high
    corners = [low, (u, y, z) if u > x else (x, v, z), high, (x, y, w) if w > z else (x, v, z)]
    points = [gmsh.model.occ.addPoint(*corner) for corner in corners]
    lines = [gmsh.model.occ.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    return int(gmsh.model.occ.addPlaneSurface([gmsh.model.occ.addCurveLoop(lines)]))


def level(z: float, x: tuple[float, ...]) -> int:
    """A plate across z between the sides."""
    return rectangle((x[0], Y[0], z), (x[1], Y[1], z))


def upright(x: float, z: tuple[float, ...]) -> int:
    """A plate across x between the sides."""
    return rectangle((x, Y[0], z[0]), (x, Y[1], z[1]))


if __name__ == "__main__":
    main(Path(__file__).with_suffix(".msh"), *map(float, sys.argv[1:]))
