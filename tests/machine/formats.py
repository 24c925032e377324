"""Every kind of cell and set in every format of mesh files, at rest, beside the same in VTK's files."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any, Final

import meshio
import numpy as np

from tests.independent import mesh_files
from tests.independent.mesh_files import CORNERS, EDGES, Group, Meshed
from tests.machine.bars import a_material
from tests.machine.framework import Case, Door, Floats, Model, capability

Draft = dict[str, Any]
_KINDS: Final = ("tri3", "tri6", "quad4", "quad8", "tet4", "tet10", "hex8", "hex20")
_IN_VTK: Final = {
    "tri3": "triangle", "tri6": "triangle6", "quad4": "quad", "quad8": "quad8", "tet4": "tetra", "tet10": "tetra10",
    "hex8": "hexahedron", "hex20": "hexahedron20",
}  # fmt: skip
_SIX: Final = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
_SAME: Final = "the same nodes and cells, written to the last digit; rounding of the solution"


def _piece(rng: np.random.Generator, kind: str, at: Floats) -> tuple[Floats, Floats]:
    """Nodes and cells of a small plate, or a small bar, at a place; no two cells alike."""
    flat = kind[:3] in ("tri", "qua")
    counts = (3, 2) if flat else (2, 1, 1)
    sides = rng.uniform(0.5, 0.9, 2) if flat else np.array([0.6, 0.3, 0.2]) * rng.uniform(0.8, 1.2, 3)
    lines = [np.linspace(0, side, count + 1) for side, count in zip(sides, counts, strict=True)]
    nodes = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(counts))
    nodes = np.column_stack([nodes, np.zeros((len(nodes), 3 - len(counts)))])
    inner = nodes[:, 0] > 0
    nodes[inner, :2] += rng.uniform(-0.02, 0.02, (int(inner.sum()), 2))
    k = np.arange(len(nodes)).reshape([count + 1 for count in counts])
    low, high = slice(None, -1), slice(1, None)
    ring = [(low, low), (high, low), (high, high), (low, high)]
    if flat:
        cells = np.stack([k[one] for one in ring], axis=-1).reshape(-1, 4)
        cells = np.vstack([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]]) if CORNERS[kind] == 3 else cells
    else:
        cells = np.stack([k[(*one, z)] for z in (low, high) for one in ring], axis=-1).reshape(-1, 8)
        cells = np.vstack([cells[:, list(one)] for one in _SIX]) if CORNERS[kind] == 4 else cells
    if kind in EDGES:
        pairs = np.sort(cells[:, np.array(EDGES[kind])], axis=-1)
        own, inverse = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
        cells = np.hstack([cells, len(nodes) + inverse.reshape(pairs.shape[:2])])
        nodes = np.vstack([nodes, nodes[own].mean(axis=1)])
    return nodes + at, cells


def _all_kinds(rng: np.random.Generator) -> Meshed:
    """A piece of every kind, apart from each other, with gaps in the numbers of nodes."""
    points, groups = np.zeros((0, 3)), []
    for place, kind in enumerate(rng.permutation(_KINDS)):
        nodes, cells = _piece(rng, str(kind), np.array([2.0 * place, 0.0, 0.5 * place]))
        foot = np.flatnonzero(nodes[:, 0] < 2.0 * place + 1e-9)
        first = len(points)
        held = tuple((first + foot).tolist())
        groups.append(Group(f"g_{kind}", str(kind), first + cells, f"foot_{kind}", held))
        points = np.vstack([points, nodes])
    numbers = 3 + np.cumsum(rng.integers(1, 3, len(points)))
    return Meshed(points, tuple(groups), numbers)


def vtu(mesh: Meshed) -> str:
    """Groups as values of a whole number, from 1, which stands at nodes for those that are held."""
    own = [np.full(len(one.cells), at) for at, one in enumerate(mesh.groups, 1)]
    feet = np.zeros(len(mesh.points), dtype=int)
    for at, one in enumerate(mesh.groups, 1):
        feet[list(one.nodes)] = at
    blocks = [(_IN_VTK[one.kind], one.cells) for one in mesh.groups]
    made = meshio.Mesh(mesh.points, blocks, point_data={"foot": feet}, cell_data={"g": own})
    with tempfile.TemporaryDirectory() as place, redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        meshio.write(Path(place) / "m.vtu", made, file_format="vtu", binary=False)
        return (Path(place) / "m.vtu").read_text(encoding="utf-8")


def _taken(model: Model, mesh: Meshed, name: str, sets: Callable[[int, Group], tuple[str, str]]) -> Draft:
    """A part for each group of a file. sets : its names of the cells and of the held nodes."""
    parts: Draft = {}
    inner: Draft = {"materials": model["materials"], "parts": parts, "supports": {}, "points": {}}
    for at, one in enumerate(mesh.groups, 1):
        cells, held = sets(at, one)
        part: Draft = {"type": "solid", "mesh": name, "material": "m", "set": cells}
        if one.dimension == 2:
            part |= {"type": "shell", "thickness": model["thickness"][at - 1]}
        parts[one.kind] = part
        inner["supports"][f"foot_{one.kind}"] = {"on": one.kind, "set": held, "fix": ["x", "y", "z"]}
        if one.dimension == 2:
            inner["supports"][f"foot_{one.kind}"]["fix"] = "clamped"
        far = one.cells[:, : CORNERS[one.kind]].ravel()
        tip = far[np.argmax(mesh.points[far] @ [1.0, 0.3, 0.2])]
        inner["points"][f"tip_{one.kind}"] = {"on": one.kind, "at": mesh.points[tip].tolist()}
    return inner


def _sag(answer: Draft, along: Floats) -> Floats:
    """The motion of each point under weight, along a direction that none of them is across."""
    return np.array([np.array(answer["points"][f"tip_{kind}"]) @ along for kind in _KINDS])


def _case(rng: np.random.Generator, formats: dict[str, Callable[[Meshed], str | bytes]]) -> Case:
    mesh = _all_kinds(rng)
    along = np.r_[rng.uniform(0.5, 1, 3), 0, 0, 0]
    draft: Draft = {"materials": {"m": a_material(rng)}, "thickness": rng.uniform(0.01, 0.02, len(_KINDS)).tolist()}

    def names(name: str) -> Callable[[int, Group], tuple[str, str]]:
        if name.endswith("bdf"):
            return lambda at, one: (f"PSHELL {at}" if one.dimension == 2 else f"PSOLID {at}", f"SPC {at}")
        return lambda at, one: (f"g={at}", f"foot={at}") if name.endswith("vtu") else (one.name, one.held)

    def rest(model: Model, door: Door, name: str, content: str | bytes) -> Floats:
        inner = _taken(model, mesh, name, names(name))
        answer = door.ask(inner, "statics", "--weight", **{name: content})
        return np.r_[_sag(answer, along), [answer["forces_n"][f"foot_{kind}"][2] for kind in _KINDS]]

    def asked(model: Model, door: Door) -> Floats:
        return np.array([rest(model, door, name, write(mesh)) for name, write in formats.items()])

    def right(model: Model, door: Door) -> Floats:
        return np.tile(rest(model, door, "m.vtu", vtu(mesh)), (len(formats), 1))

    return Case(draft, asked, right, 1e-7, _SAME, each=True)


@capability("formats: all cells and sets, Nastran, Abaqus, universal files", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case(
        rng,
        {
            "m.bdf": mesh_files.nastran,
            "m.inp": mesh_files.abaqus,
            "m.unv": mesh_files.unv,
            "n.unv": lambda mesh: mesh_files.unv(mesh, 2477),
        },
    )


@capability("formats: all cells and sets, Gmsh", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case(
        rng,
        {
            "a.msh": mesh_files.gmsh_2,
            "b.msh": lambda mesh: mesh_files.gmsh_2(mesh, "<"),
            "c.msh": lambda mesh: mesh_files.gmsh_2(mesh, ">"),
            "d.msh": mesh_files.gmsh_4,
            "e.msh": lambda mesh: mesh_files.gmsh_4(mesh, "<"),
            "f.msh": lambda mesh: mesh_files.gmsh_4(mesh, ">"),
        },
    )
