"""Rooms of cells under a piston, in closed form: boxes as meshes of files, and with a floor that absorbs or yields."""

from __future__ import annotations

import io
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from math import pi
from pathlib import Path
from typing import Any, Final

import meshio
import numpy as np

from tests.independent.pistons import Tube
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.pistons import box_of, piston_of, scene
from tests.machine.rooms import between, even, lines_of, losses_of, parts_of, responses, rounded
from tests.machine.solids import grid

Draft = dict[str, Any]
_WHY = "quadratic cells of an eighth of a wave and less: the fourth power, 1e-4 of a mode, times its height; the plate"
_FACES: Final = {"tetra": ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)), "hexahedron": ((0, 1, 2, 3), (4, 5, 6, 7))}


def _mesh(model: Model) -> str:
    """The box as a file of Gmsh, with its ceiling by name."""
    said = model["box"]
    size, cells, kind = np.array(said["size"]), tuple(said["cells"]), said["kind"]
    nodes, found = grid(size, cells, kind)
    sides = np.concatenate([found[:, list(one)] for one in _FACES[kind]])
    top = sides[np.isclose(nodes[sides][:, :, 2], size[2]).all(axis=1)]
    blocks = [("triangle" if kind == "tetra" else "quad", top), (kind, found)]
    tags = [np.full(len(block), tag) for tag, (_, block) in enumerate(blocks, 1)]
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    mesh = meshio.Mesh(nodes, blocks, cell_data=data, field_data={"top": np.array([1, 2])})
    with tempfile.TemporaryDirectory() as place, redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        path = Path(place) / "box.msh"
        meshio.write(path, mesh, file_format="gmsh22", binary=False)
        return path.read_text(encoding="utf-8")


def _told(door: Door, found: Floats) -> Floats:
    stiff = ("implausible-material", "thick-plate")
    door.told[:] = [one for one in door.told if not one.startswith(stiff)]
    return parts_of(found)


@capability("rooms: a piston over a box of cells", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = scene(rng, "one-way")
    room = model["study"]["rooms"]["room"]
    room.pop("form", None)
    size = room.pop("size")
    cell = max(size) / 9
    model["box"] = {
        "size": size,
        "cells": [int(np.ceil(side / cell)) for side in size],
        "kind": str(rng.choice(["hexahedron", "tetra"])),
    }
    room |= {"mesh": "box.msh", "ceiling": "top"}

    def asked(model: Model, door: Door) -> Floats:
        return _told(door, responses(model, door, **{"box.msh": _mesh(model)}))

    def right(model: Model, _: Door) -> Floats:
        stated, structure = model["study"]["rooms"]["room"], model["structure"]
        box = box_of({**stated, "size": model["box"]["size"]}, structure)
        s, place = 2j * pi * lines_of(model), stated["receivers"]["mic"]
        sign = -1.0 if "volume_velocity" in model["study"]["frf"]["f"]["drive"] else 1.0
        return parts_of(sign * box.per_force(piston_of(structure), s, place, False, None))

    return Case(model, asked, right, 0.01, _WHY)


@capability("rooms: a piston over a floor that gives way", "independent")
def _(rng: np.random.Generator) -> Case:
    """The whole ceiling moves: plane waves up to an impedance, or to a mass on a spring and a dashpot, both ways."""
    model = scene(rng, str(rng.choice(["one-way", "two-way"])))
    room, structure = model["study"]["rooms"]["room"], model["structure"]
    part = structure["parts"]["p"]
    room.pop("form", None)
    narrow = even(rng, 0.2, 0.3)
    part["size"] = [rounded(narrow * side) for side in part["size"]]
    structure["points"]["q"]["at"] = [side / 2 for side in part["size"]]
    structure["parts"]["k"]["stiffness"]["z"] *= narrow**2
    height, air = room["size"][2], room["air"]
    room["size"] = [*part["size"], height]
    room.pop("at")
    room["receivers"]["mic"][:2] = [rounded(side * float(rng.uniform(0, 1))) for side in part["size"]]
    first = air["c"] / 2 / height
    stiff = air["rho"] * air["c"] ** 2 / height
    if room["coupling"] == "one-way":
        wall = {"impedance": rounded(air["rho"] * air["c"] * between(rng, 3, 30))}
    else:
        own = 2 * pi * first * float(rng.uniform(0.3, 1.5))
        soft = stiff * between(rng, 1, 10)
        wall = {"stiffness": rounded(soft), "mass": rounded(soft / own**2), "resistance": rounded(0.2 * soft / own)}
    room["walls"] = {"floor": wall}
    room["modes"] = {"up_to": rounded(6 * first)}
    study = model["study"]
    study["frf"]["f"] |= {"band": [rounded(0.3 * first), rounded(1.8 * first)], "step": rounded(first / 25)}
    study["modes"]["up_to"] = rounded(6 * first)

    def asked(model: Model, door: Door) -> Floats:
        return _told(door, responses(model, door))

    return Case(model, asked, _over_a_floor, 0.01, _WHY)


def _over_a_floor(model: Model, _: Door) -> Floats:
    stated, structure = model["study"]["rooms"]["room"], model["structure"]
    s, wall = 2j * pi * lines_of(model), stated["walls"]["floor"]
    if "impedance" in wall:
        impedance = wall["impedance"] + 0 * s
    else:
        impedance = wall["resistance"] + s * wall["mass"] + wall["stiffness"] / s
    a, b, height = stated["size"]
    tube = Tube(a * b, height, **stated["air"], **losses_of(stated["losses"]))
    both = stated["coupling"] == "two-way"
    found = tube.per_force(piston_of(structure), s, stated["receivers"]["mic"][2], impedance, both)
    return parts_of(-found if "volume_velocity" in model["study"]["frf"]["f"]["drive"] else found)
