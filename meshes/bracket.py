"""Makes bracket.msh: an angle bracket 80 x 60 x 70 mm of 8 mm steel with a rib, held by two bolts, of tetrahedra.

    python meshes/bracket.py [SIZE OF A CELL in mm]

Named: body (the solid), bolts (the faces of the two holes), back (the face against the wall), seat (the top of the
shelf). Needs gmsh (`pip install gmsh`).
"""

from __future__ import annotations

import sys
from pathlib import Path

import gmsh

WIDTH, DEPTH, HEIGHT, THICK = 60.0, 80.0, 70.0, 8.0  # mm; the wall is at y = 0, the shelf at the top
HOLE, HOLES_AT, RADIUS = 9.0, ((15.0, 22.0), (45.0, 22.0)), 6.0


def main(cell: float = 8.0) -> None:
    """The bracket, its named groups and its mesh of the second order, to bracket.msh."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    make = gmsh.model.occ
    back = make.addBox(0, 0, 0, WIDTH, THICK, HEIGHT)
    shelf = make.addBox(0, 0, HEIGHT - THICK, WIDTH, DEPTH, THICK)
    corners = [(THICK, 14.0), (DEPTH - 20.0, HEIGHT - THICK), (THICK, HEIGHT - THICK)]
    points = [make.addPoint(WIDTH / 2 - THICK / 2, y, z) for y, z in corners]
    lines = [make.addLine(points[i], points[(i + 1) % 3]) for i in range(3)]
    rib = make.extrude([(2, make.addPlaneSurface([make.addCurveLoop(lines)]))], THICK, 0, 0)
    parts, _ = make.fuse([(3, back)], [(3, shelf), *(one for one in rib if one[0] == 3)])
    holes = [(3, make.addCylinder(x, -1, z, 0, THICK + 2, 0, HOLE / 2)) for x, z in HOLES_AT]
    parts, _ = make.cut(parts, holes)
    make.synchronize()
    faces = {tag: gmsh.model.occ.getCenterOfMass(2, tag) for _, tag in gmsh.model.getEntities(2)}
    round_ = [tag for tag in faces if gmsh.model.getType(2, tag) == "Cylinder"]
    groups = {
        "bolts": round_,
        "back": [tag for tag, (_, y, _z) in faces.items() if abs(y) < 1e-6],
        "seat": [tag for tag, (_, _y, z) in faces.items() if abs(z - HEIGHT) < 1e-6],
    }
    for name, tags in groups.items():
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in parts], name="body")
    gmsh.option.setNumber("Mesh.MeshSizeMax", cell)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 10)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.RandomSeed", 1)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(Path(__file__).with_suffix(".msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
