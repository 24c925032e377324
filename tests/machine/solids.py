"""Bars and blocks of solid elements from mesh files, against bars in closed form and boxes by Ritz."""

from __future__ import annotations

import io
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import meshio
import numpy as np

from tests.independent.frames import Skeleton, Tube, section, tip_at_rest
from tests.independent.linear import Linear
from tests.independent.solids import Box, isotropic, orthotropic, turned
from tests.machine.bars import a_material
from tests.machine.columns import ANSWERS, Subject, case_of
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.plates import between

Draft = dict[str, Any]
G: Final = 9.80665
_EDGES: Final = {
    "hexahedron": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    "tetra": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
}
_SIX: Final = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))


def grid(sides: Floats, cells: tuple[int, int, int], kind: str) -> tuple[Floats, Floats]:
    """Nodes [n, 3] and cells of a box from the origin."""
    lines = [np.linspace(0, side, count + 1) for side, count in zip(sides, cells, strict=True)]
    nodes = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    k = np.arange(len(nodes)).reshape([count + 1 for count in cells])
    low, high = slice(None, -1), slice(1, None)
    base = [(low, low), (high, low), (high, high), (low, high)]
    hexes = np.stack([k[x, y, z] for z in (low, high) for x, y in base], axis=-1).reshape(-1, 8)
    plain = kind.rstrip("0123456789")
    found = hexes if plain == "hexahedron" else np.vstack([hexes[:, list(one)] for one in _SIX])
    if kind == plain:
        return nodes, found
    pairs = np.sort(found[:, np.array(_EDGES[plain])], axis=-1)
    own, inverse = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    middle = len(nodes) + inverse.reshape(pairs.shape[:2])
    return np.vstack([nodes, nodes[own].mean(axis=1)]), np.hstack([found, middle])


def mesh_text(nodes: Floats, cells: Floats, kind: str, ending: str) -> str:
    """A file of a format that has them."""
    with tempfile.TemporaryDirectory() as place, redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        path = Path(place) / f"m.{ending}"
        form: Any = {"msh": "gmsh22", "vtu": "vtu"}[ending]
        meshio.write(path, meshio.Mesh(nodes, [(kind, cells)]), file_format=form, binary=False)
        return path.read_text(encoding="utf-8")


def _bar(
    rng: np.random.Generator, kinds: tuple[str, ...], cells: tuple[int, int, int], axis: int
) -> tuple[Draft, str, str]:
    """A bar along a global axis, its first end clamped: the model, its file's name and text."""
    length, width, height = (float(one) for one in (rng.uniform(1.5, 2), *rng.uniform(0.08, 0.13, 2)))
    kind, ending = str(rng.choice(kinds)), str(rng.choice(["msh", "vtu"]))
    nodes, found = grid(np.array([length, width, height]), cells, kind)
    turned = np.roll(nodes, axis, axis=1)  # x of the bar is then that axis, right-handed
    e = 1e-5
    end = turned.max(axis=0) + e
    end[axis] = e
    draft: Draft = {
        "materials": {"m": a_material(rng)},
        "parts": {"b": {"type": "solid", "mesh": f"b.{ending}", "material": "m"}},
        "points": {"tip": {"on": "b", "at": np.roll([length, 0, 0], axis).tolist()}},
        "supports": {"wall": {"on": "b", "box": [[-e, -e, -e], end.tolist()], "fix": "clamped"}},
        "damping": {"ratio": 0.01},
        "sides": {"length": length, "width": width, "height": height},
    }
    return draft, f"b.{ending}", mesh_text(turned, found, kind, ending)


def _inner(model: Model) -> Draft:
    return {key: one for key, one in model.items() if key != "sides"}


def _clear(door: Door) -> None:
    usual = ("nothing-holds-it", "coarse-mesh", "stress-uneven", "modal-mass-low", "locking", "linear-tet", "sags-far")
    door.told[:] = [one for one in door.told if not one.startswith(usual)]


@capability("solids: hung", "independent")
def _(rng: np.random.Generator) -> Case:
    """By its first end, of a material that does not contract: it shortens by rho g L^2 / 2 E, standing on it."""
    draft, name, text = _bar(rng, ("hexahedron", "hexahedron20", "tetra10"), (6, 2, 2), 2)
    draft["materials"]["m"]["nu"] = 0.0
    if rng.random() < 0.4:  # along its length a material of directions is as stiff as one without
        made = draft["materials"]["m"]
        E = made["E"]
        made |= {"E": [E, 0.4 * E, 0.3 * E], "G": [0.1 * E, 0.08 * E, 0.12 * E]}
        draft["parts"]["b"] |= {"orientation": [0, 0, 1], "normal": [1, 0, 0]}

    def asked(model: Model, door: Door) -> Floats:
        found = door.ask(_inner(model), "statics", "--weight", **{name: text})
        _clear(door)
        return np.array(found["points"]["tip"])[[2]]

    def right(model: Model, _: Door) -> Floats:
        m, L = model["materials"]["m"], model["sides"]["length"]
        E = m["E"][0] if isinstance(m["E"], list) else m["E"]
        return np.array([-m["rho"] * G * L**2 / 2 / E])

    return Case(draft, asked, right, 1e-5, "exact at nodes, also of linear elements; rounding of tetrahedra's lumps")


@capability("solids: bending modes of a slender bar", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Two planes; quadratic elements against bars with shear."""
    axis = int(rng.integers(3))
    draft, name, text = _bar(rng, ("hexahedron20", "tetra10"), (14, 2, 2), axis)

    def asked(model: Model, door: Door) -> Floats:
        found = door.ask(_inner(model), "modes", "--count", "2", **{name: text})
        _clear(door)
        return np.array(found["frequency_hz"])

    def right(model: Model, _: Door) -> Floats:
        m, of, bones = model["materials"]["m"], model["sides"], Skeleton()
        places = [bones.place(np.array([x, 0, 0])) for x in np.linspace(0, of["length"], 3)]
        shape = section("rectangle", width=of["width"], height=of["height"])
        for a, b in pairwise(places):
            bones.bar(a, b, shape, m["E"], m["E"] / 2 / (1 + m["nu"]), m["rho"])
        bones.hold(places[0])
        return bones.modes(2)[0]

    why = "a clamped end that cannot contract, nu^2 of it over the slenderness; 14 quadratic elements along it"
    return Case(draft, asked, right, 1.5e-2, why, each=True)


@capability("solids: four kinds of elements are one block", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Quadratic hexahedra and tetrahedra of a block that floats."""
    sides = rng.uniform(0.5, 1.0, 3)
    made = a_material(rng)
    draft: Draft = {
        "materials": {"m": made}, "parts": {"b": {"type": "solid", "mesh": "b.vtu", "material": "m"}},
        "damping": {"ratio": 0.01}, "sides": sides.tolist(),
    }  # fmt: skip

    def of(kind: str, cells: int, model: Model, door: Door) -> Floats:
        nodes, found = grid(np.array(model["sides"]), (cells,) * 3, kind)
        text = mesh_text(nodes, found, kind, "vtu")
        answer = door.ask(_inner(model), "modes", "--count", "9", **{"b.vtu": text})
        _clear(door)
        return np.array(answer["frequency_hz"])[6:]

    def asked(model: Model, door: Door) -> Floats:
        return of("tetra10", 4, model, door)

    def right(model: Model, door: Door) -> Floats:
        return of("hexahedron20", 4, model, door)

    return Case(draft, asked, right, 6e-3, "4 cells a side, of fourth order both: below 3e-3 each", each=True)


_BLOCK: Final = "8 quadratic cells along it and 5 across, polynomials of the sixth degree: below 1e-3"


def _elastic(model: Model) -> Floats:
    """Hooke's tensor along global axes."""
    part, made = model["parts"]["b"], model["materials"][model["parts"]["b"]["material"]]
    if not isinstance(made["E"], list):
        return isotropic(made["E"], made["nu"])
    x = np.array(part["orientation"], float)
    x = x / np.linalg.norm(x)
    z = np.array(part["normal"], float)
    z = z - (z @ x) * x
    z = z / np.linalg.norm(z)
    return turned(orthotropic(made["E"], made["G"], made["nu"]), np.array([x, np.cross(z, x), z]))


def _block(model: Model, sides: Floats) -> Linear:
    made = model["materials"][model["parts"]["b"]["material"]]
    box = Box(
        sides * model["parts"]["b"]["scale"],
        _elastic(model),
        made["rho"],
        made.get("loss_factor", 0.0),
        bool(model["supports"]),
    )
    return box.linear({name: one["at"] for name, one in model["points"].items()})


def _held(rng: np.random.Generator) -> tuple[Draft, Floats, str]:
    """A stocky block that slides along three walls, with points on a face that stays if the mesh is scaled."""
    sides = np.array([between(rng, 0.5, 0.9), between(rng, 0.4, 0.6), between(rng, 0.4, 0.6)])
    scale = float(rng.choice([0.5, 2.0, 1e-3]))
    nodes, cells = grid(sides / scale, (8, 5, 5), "hexahedron20")
    e = 1e-4
    L, w = (float(one) for one in sides[:2])
    draft: Draft = {
        "materials": {"m": a_material(rng)},
        "parts": {"b": {"type": "solid", "mesh": "b.vtu", "scale": scale, "material": "m"}},
        "points": {"q": {"on": "b", "at": [L / 2, 0.7 * w, 0.0]}, "d": {"on": "b", "at": [0.75 * L, 0.3 * w, 0.0]}},
        "damping": {"ratio": 0.01},
    }
    draft["materials"]["m"]["nu"] = between(rng, 0.1, 0.35)
    walls = {one: [[-9.0] * 3, [9.0] * k + [e] + [9.0] * (2 - k)] for k, one in enumerate("xyz")}
    draft["supports"] = {one: {"on": "b", "box": box, "fix": [one]} for one, box in walls.items()}
    return draft, sides / scale, mesh_text(nodes, cells, "hexahedron20", "vtu")


def _any(rng: np.random.Generator, made: tuple[Draft, Floats, str], accuracy: float, why: str) -> Case:
    draft, sides, text = made
    held = bool(draft["supports"])
    ways = [f"q.{axis}" for axis in rng.permutation(["x", "y"])]
    drive = f"d.{ways[0][-1]}"
    usual = (
        "coarse-mesh",
        "stress-uneven",
        "modal-mass-low",
        "sags-far",
        "stress-of",
        "implausible",
        "mesh-in-other-units",
    )
    return case_of(rng, Subject(
        draft, partial(_block, sides=sides), (drive,), ways, accuracy, why, aside=usual, pushed=False, reach=6.0,
        still=0 if held else 6, answers=ANSWERS if held else ("modes", "frf"), beside=lambda _: {"b.vtu": text},
    ))  # fmt: skip


@capability("solids: any answer of a block", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    made = _held(rng)
    if rng.random() < 0.4:
        made[0]["materials"]["m"]["loss_factor"] = between(rng, 0.06, 0.12)
        made[0]["damping"] = {"from": "materials"}
    return _any(rng, made, 2e-3, _BLOCK)


@capability("solids: any answer of a block with directions", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    made = _held(rng)
    draft = made[0]
    E = draft["materials"]["m"]["E"]
    draft["materials"]["m"] |= {
        "E": [E, E * between(rng, 0.1, 0.3), E * between(rng, 0.1, 0.3)],
        "G": [E * between(rng, 0.05, 0.1), E * between(rng, 0.03, 0.05), E * between(rng, 0.05, 0.1)],
        "nu": [between(rng, 0.1, 0.3), between(rng, 0.1, 0.3), 0.02],
    }
    up, across = rng.uniform(0.4, 1.1) * rng.choice([-1, 1]), rng.uniform(0.4, 1.1)
    draft["parts"]["b"] |= {
        "orientation": [float(np.cos(up)), 0.3, float(np.sin(up))],
        "normal": [0.2, float(np.sin(across)), float(np.cos(across))],
    }
    if rng.random() < 0.5:
        draft["supports"] = {}
        return _any(rng, made, 2e-2, _BLOCK + "; of a free one degrees six and eight differ by up to 2.5e-2 at a peak")
    return _any(
        rng, made, 1e-2, _BLOCK + "; where walls meet a material that leans degrees six and nine differ by 1.8e-2"
    )


@capability("joints: a bent bar on a rigid solid on springs", "independent")
def _(rng: np.random.Generator) -> Case:
    """The solid shifts and turns on springs under its corners, and carries the bar, which is clamped in it."""
    sides, kind = rng.uniform(0.4, 0.8, 3).round(3), str(rng.choice(["hexahedron", "tetra", "hexahedron20"]))
    nodes, cells = grid(sides, (2, 2, 2), kind)
    foot = (sides * [0.5, 0.5, 1.0]).round(6)
    middle = foot + rng.uniform([-0.3, -0.3, 0.8], [0.3, 0.3, 1.2])
    end = middle + rng.normal(size=3) * [0.7, 0.7, 0.1] + np.array([0.0, 0.0, 0.5])
    corners = np.array([foot, middle, end]).round(4)
    tube = Tube(0.03, float(rng.uniform(0.003, 0.006)), E=between(rng, 7e10, 2.1e11), nu=0.3, rho=7800.0)
    feet = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) * sides
    stiffness = rng.uniform(2e4, 1e5, 3).round(0)
    draft: Draft = {
        "materials": {"hard": {"E": 2e12, "nu": 0.3, "rho": 100.0}, "m": {"E": tube.E, "nu": tube.nu, "rho": tube.rho}},
        "sections": {"s": {"shape": "tube", "outer": tube.outer, "thickness": tube.thickness}},
        "parts": {
            "b": {"type": "solid", "mesh": "b.msh", "material": "hard"},
            "f": {"type": "frame", "material": "m", "section": "s", "mesh": 0.3, "element": "euler",
                  "lines": [corners.tolist()]},
        },
        "joints": {"j": {"connect": ["f", "b"]}},
        "points": {"tip": {"on": "f", "at": corners[-1].tolist()}},
        "damping": {"ratio": 0.01},
    }  # fmt: skip
    for k, place in enumerate(feet):
        draft["points"][f"c{k}"] = {"on": "b", "at": place.round(6).tolist()}
        draft["parts"][f"k{k}"] = {"type": "spring", "between": [f"c{k}", "ground"],
                                   "stiffness": dict(zip("xyz", stiffness.tolist(), strict=True))}  # fmt: skip
    force = np.round(rng.normal(size=3) * 10, 2)
    text = mesh_text(nodes, cells, kind, "msh")

    def asked(model: Model, door: Door) -> Floats:
        words = [f"tip.{axis}={float(size)} N" for axis, size in zip("xyz", force, strict=True)]
        found = door.ask(model, "statics", *(word for one in words for word in ("--force", one)), **{"b.msh": text})
        _clear(door)
        door.told[:] = [one for one in door.told if not one.startswith("implausible")]
        return np.array(found["points"]["tip"])[:3]

    def right(model: Model, _: Door) -> Floats:
        K, load = np.zeros((6, 6)), np.r_[force, np.cross(corners[-1] - foot, force)]
        for place in feet:
            moved = _carried(place - foot)
            K += moved.T @ np.diag(stiffness) @ moved
        rides = _carried(corners[-1] - foot) @ np.linalg.solve(K, load)
        return np.asarray(rides + tip_at_rest(tube, corners - foot, force)[:3])

    return Case(
        draft, asked, right, 1e-4, "a solid 1e6 times as stiff as springs and bar; bars are exact at their ends"
    )


def _carried(arm: Floats) -> Floats:
    """Shift [3, 6] of a place on a rigid body by the shift and the turn of another, from which it is `arm` away."""
    x, y, z = arm
    return np.hstack([np.eye(3), np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])])
