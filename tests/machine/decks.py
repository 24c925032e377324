"""One mesh as decks and mesh files write it, in every way that means the same, beside its plainest."""

from __future__ import annotations

import io
import re
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from tests.machine.bars import a_material
from tests.machine.framework import Case, Door, Floats, Model, Refused, capability

Draft = dict[str, Any]
_SAME = "the same nodes and cells, coordinates to ten digits; tolerance of the eigensolution"


def _mesh(rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Nodes [n, 3] of a bent plate, quadrilaterals [c, 4], and which are in its second half [c]."""
    n, m = int(rng.integers(4, 8)), int(rng.integers(3, 6))
    a, b, rise = rng.uniform(0.5, 1.0, 3) * [1, 1, 0.3]
    x, y = np.meshgrid(np.linspace(0, a, n + 1), np.linspace(0, b, m + 1))
    nodes = np.column_stack([x.ravel(), y.ravel(), rise * (x.ravel() / a) ** 2])
    k = np.arange((n + 1) * (m + 1)).reshape(m + 1, n + 1)
    quads = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], axis=-1).reshape(-1, 4)
    return nodes.round(6), quads, nodes[quads].mean(axis=1)[:, 0] > a / 2


def _draft(rng: np.random.Generator, nodes: Floats) -> Draft:
    made = a_material(rng)
    e = 1e-4
    low, high = nodes.min(axis=0) - e, nodes.max(axis=0) + e
    box = [low.tolist(), [e, float(high[1]), float(high[2])]]
    return {
        "materials": {"m": made},
        "parts": {
            "p": {"type": "shell", "mesh": "p.bdf", "material": "m", "thickness": float(rng.uniform(2e-3, 6e-3))}
        },
        "supports": {"foot": {"on": "p", "box": box, "fix": "clamped"}},
        "damping": {"ratio": 0.01},
    }


def plain_deck(nodes: Floats, quads: Floats) -> str:
    """Free fields, in order."""
    lines = ["BEGIN BULK"]
    lines += [f"GRID,{i + 1},,{x:.9f},{y:.9f},{z:.9f}" for i, (x, y, z) in enumerate(nodes)]
    lines += [f"CQUAD4,{i + 1},1,{','.join(str(one + 1) for one in quad)}" for i, quad in enumerate(quads)]
    return "\n".join([*lines, "ENDDATA", ""])


def _modes(model: Model, door: Door, **files: str) -> Floats:
    return np.array(door.ask(model, "modes", "--count", "4", **files)["frequency_hz"])


def _case(rng: np.random.Generator, nodes: Floats, quads: Floats, name: str, text: str, **more: Any) -> Case:
    """The part from a file of that name beside the plain deck."""
    draft = {**_draft(rng, nodes), "file": {"name": name, "text": text}, "more": more}
    plain = plain_deck(nodes, quads)

    def asked(model: Model, door: Door) -> Floats:
        inner: Any = {key: one for key, one in model.items() if key not in ("file", "more")}
        inner["parts"] = {"p": {**model["parts"]["p"], "mesh": model["file"]["name"], **model["more"]}}
        return _modes(inner, door, **{model["file"]["name"]: model["file"]["text"]})

    def right(model: Model, door: Door) -> Floats:
        inner = {key: one for key, one in model.items() if key not in ("file", "more")}
        return _modes(inner, door, **{"p.bdf": plain})

    return Case(draft, asked, right, 1e-7, _SAME)


@capability("decks: other formats of mesh files", "relation")
def _(rng: np.random.Generator) -> Case:
    nodes, quads, _ = _mesh(rng)
    kind = str(rng.choice(["msh 2", "msh 4", "vtu", "inp", "unv"]))
    if kind == "unv":
        return _case(rng, nodes, quads, "q.unv", _unv(nodes, quads))
    if kind == "inp":
        return _case(rng, nodes, quads, "q.inp", _inp(rng, nodes, quads))
    mesh = meshio.Mesh(nodes, [("quad", quads)])
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / f"q.{kind.split()[0]}"
        form: Any = {"msh 2": "gmsh22", "msh 4": "gmsh", "vtu": "vtu"}[kind]
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):  # of tags that are not there
            meshio.write(path, mesh, file_format=form, binary=False)
        return _case(rng, nodes, quads, path.name, path.read_text(encoding="utf-8"))


def _unv(nodes: Floats, quads: Floats) -> str:
    """Datasets 2411 and 2412 of I-DEAS."""
    out = io.StringIO()
    print("    -1\n  2411", file=out)
    for i, (x, y, z) in enumerate(nodes):
        print(f"{i + 1:10d}{1:10d}{1:10d}{11:10d}\n{x:25.16E}{y:25.16E}{z:25.16E}", file=out)
    print("    -1\n    -1\n  2412", file=out)
    for i, quad in enumerate(quads):
        print(f"{i + 1:10d}{94:10d}{1:10d}{1:10d}{7:10d}{4:10d}", file=out)
        print("".join(f"{one + 1:10d}" for one in quad), file=out)
    print("    -1", file=out)
    return out.getvalue()


def _inp(rng: np.random.Generator, nodes: Floats, quads: Floats) -> str:
    """Keywords in either case, comments, and numbers of nodes that leave some out."""
    step, first = int(rng.integers(1, 5)), int(rng.integers(1, 100))
    upper = bool(rng.random() < 0.5)
    lines = ["** a comment", "*NODE" if upper else "*Node"]
    lines += [f"{first + step * i}, {x:.9f}, {y:.9f}, {z:.9f}" for i, (x, y, z) in enumerate(nodes)]
    lines += ["*ELEMENT, TYPE=S4, ELSET=ALL" if upper else "*Element, type=S4, elset=all"]
    lines += [f"{7 + i}, {', '.join(str(first + step * one) for one in quad)}" for i, quad in enumerate(quads)]
    return "\n".join([*lines, "**", ""])


@capability("decks: fields and numbers of Nastran", "relation")
def _(rng: np.random.Generator) -> Case:
    """Small, large and free fields, numbers with gaps, cards in another order, comments, exponents without E."""
    nodes, quads, _ = _mesh(rng)
    number = 10 + np.sort(rng.choice(5 * len(nodes), len(nodes), replace=False))
    cards = [_grid(rng, int(number[i]), at) for i, at in enumerate(nodes)]
    cards += [_quad(rng, i + 1, number[quad].tolist()) for i, quad in enumerate(quads)]
    if rng.random() < 0.5:
        rng.shuffle(cards)
    head = ["$ a deck", "SOL 103", "CEND", "BEGIN BULK"] if rng.random() < 0.5 else ["BEGIN BULK"]
    return _case(rng, nodes, quads, "q.bdf", "\n".join([*head, *cards, "ENDDATA", ""]))


def _grid(rng: np.random.Generator, number: int, at: Floats) -> str:
    kind = int(rng.integers(4))
    if kind == 0:
        return f"GRID,{number},,{','.join(f'{one:.9f}' for one in at)}"
    if kind == 1:  # large fields
        x, y, z = (f"{one:16.9f}" for one in at)
        return f"GRID*   {number:16d}{'':16}{x}{y}\n*       {z}"
    if kind == 2:  # 1.5-3 is 1.5E-3
        return f"GRID,{number},,{','.join(_short(one) for one in at)}"
    return f"GRID    {number:<8d}{'':8}" + "".join(f"{one:8.6f}" for one in at)


def _short(x: float) -> str:
    mantissa, power = f"{x:.9E}".split("E")
    return f"{mantissa}{int(power):+d}"


def _quad(rng: np.random.Generator, number: int, quad: list[int]) -> str:
    turn = int(rng.integers(4))
    quad = quad[turn:] + quad[:turn]
    if rng.random() < 0.5:
        return f"CQUAD4  {number:8d}{1:8d}" + "".join(f"{one:8d}" for one in quad)
    return f"CQUAD4, {number}, 1, {', '.join(map(str, quad))}"


@capability("decks: a scale of lengths", "relation")
def _(rng: np.random.Generator) -> Case:
    nodes, quads, _ = _mesh(rng)
    unit, size = [("mm", 1e3), ("cm", 1e2), (0.0254, 1 / 0.0254)][int(rng.integers(3))]
    return _case(rng, nodes, quads, "q.bdf", plain_deck(nodes * size, quads), scale=unit)


@capability("decks: thickness, material and supports of the deck", "relation")
def _(rng: np.random.Generator) -> Case:
    """What the model states beside what the deck does."""
    nodes, quads, half = _mesh(rng)
    draft = _draft(rng, nodes)
    made, thin = draft["materials"]["m"], draft["parts"]["p"]["thickness"]
    thick = float(f"{thin * rng.uniform(1.2, 2):.5g}")
    thin = float(f"{thin:.5g}")
    lines = ["BEGIN BULK", f"PSHELL,1,1,{thin},1", f"PSHELL,2,1,{thick},1"]
    lines += [f"MAT1,1,{made['E']:.8E},,{made['nu']:.8f},{made['rho']:.8f}"]
    lines += [f"GRID,{i + 1},,{x:.9f},{y:.9f},{z:.9f}" for i, (x, y, z) in enumerate(nodes)]
    lines += [
        f"CQUAD4,{i + 1},{1 + int(second)},{','.join(str(one + 1) for one in quad)}"
        for i, (quad, second) in enumerate(zip(quads, half, strict=True))
    ]
    feet = [i + 1 for i, at in enumerate(nodes) if at[0] < 1e-6]
    lines += [f"SPC1,1,123456,{','.join(map(str, feet[k : k + 6]))}" for k in range(0, len(feet), 6)]
    text = "\n".join([*lines, "ENDDATA", ""])
    made = {"E": float(f"{made['E']:.8E}"), "nu": float(f"{made['nu']:.8f}"), "rho": float(f"{made['rho']:.8f}")}
    draft |= {"materials": {"m": made}, "thick": [thin, thick]}

    def asked(model: Model, door: Door) -> Floats:
        inner: Any = {
            "materials": model["materials"],
            "parts": {
                "p": {"type": "shell", "mesh": "q.bdf", "material": "m"},
                "held": {"type": "attachments", "mesh": "q.bdf", "take": ["supports"], "supports": ["SPC 1"]},
            },
            "damping": {"ratio": 0.01},
        }
        return _modes(inner, door, **{"q.bdf": text})

    def right(model: Model, door: Door) -> Floats:
        thin, thick = model["thick"]
        inner: Any = {key: one for key, one in model.items() if key != "thick"}
        inner["parts"] = {"p": {**model["parts"]["p"], "mesh": "q.inp", "thickness": {"THIN": thin, "THICK": thick}}}
        return _modes(inner, door, **{"q.inp": _sets(nodes, quads, half)})

    return Case(draft, asked, right, 1e-7, _SAME)


def _sets(nodes: Floats, quads: Floats, half: Floats) -> str:
    lines = ["*NODE", *(f"{i + 1}, {x:.9f}, {y:.9f}, {z:.9f}" for i, (x, y, z) in enumerate(nodes))]
    for name, chosen in (("THIN", ~half), ("THICK", half)):
        lines.append(f"*ELEMENT, TYPE=S4, ELSET={name}")
        lines += [f"{i + 1}, {', '.join(str(one + 1) for one in quads[i])}" for i in np.flatnonzero(chosen)]
    return "\n".join([*lines, ""])


def _layered(rng: np.random.Generator, nodes: Floats, quads: Floats, half: Draft, symmetric: bool) -> dict[str, str]:
    """Decks of Nastran and of Abaqus that state a lay-up, whole or half of it."""
    rows = "".join(f",{1},{mm / 1e3:.7f},{angle},YES" for mm, angle in half)
    words = f"PCOMP,1,,,,,,,{'SYM' if symmetric else ''}".split(",") + rows.split(",")[1:]
    cards = [",".join(words[k : k + 8]) for k in range(1, len(words), 8)]
    laid = "\n,".join(["PCOMP," + cards[0], *cards[1:]]) + "\nMAT1,1,7.+10,,0.3,2700.\nENDDATA"
    section = [
        "*MATERIAL, NAME=M1", "*ELASTIC", "7e10, 0.3", "*DENSITY", "2700.",
        f"*SHELL SECTION, ELSET=ALL, COMPOSITE{', SYMMETRIC' if symmetric else ''}",
        *(f"{mm / 1e3:.7f}, 3, M1, {angle}" for mm, angle in half), "",
    ]  # fmt: skip
    return {
        "q.bdf": plain_deck(nodes, quads).replace("ENDDATA", laid),
        "q.inp": _inp(rng, nodes, quads) + "\n".join(section),
    }


@capability("decks: layers are answered with what to write", "independent")
def _(rng: np.random.Generator) -> Case:
    """A lay-up that a deck states, whole or half of it where it is symmetric, and a shell without layers."""
    nodes, quads, _ = _mesh(rng)
    half = [[float(f"{rng.uniform(0.3, 3):.4g}"), float(rng.choice([0.0, 45.0, -30.0, 90.0]))]
            for _ in range(int(rng.integers(2, 4)))]  # fmt: skip
    texts = [_layered(rng, nodes, quads, half, symmetric) for symmetric in (False, True)]
    draft: Draft = {**_draft(rng, nodes), "half": half}
    del draft["parts"]["p"]["thickness"]

    def asked(model: Model, door: Door) -> Floats:
        found = []
        for name, text in (pair for decks in texts for pair in decks.items()):
            inner: Any = {key: one for key, one in model.items() if key != "half"}
            inner["parts"] = {"p": {**model["parts"]["p"], "mesh": name}}
            try:
                door.ask(inner, "modes", "--count", "1", **{name: text})
            except Refused as told:
                found += re.findall(r"\[[^\[\],]+, ([0-9.e-]+) mm(?:, ([-0-9.]+) deg)?\]", str(told))
        return np.array([[float(mm), float(angle or 0)] for mm, angle in found]).ravel()

    def right(model: Model, _: Door) -> Floats:
        half = model["half"]
        return np.array([*(2 * half), *(2 * (half + half[::-1]))], float).ravel()

    return Case(draft, asked, right, 1e-6, "four digits, which are drawn so")
