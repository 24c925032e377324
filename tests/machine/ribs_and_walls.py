"""Ribs under slabs at any angle to their meshes, walls that stand inside of slabs on meshes of their own: any answer.

The reference has edges of elements along ribs and feet; the program has cells that neither keep to. Where a line loads
the inside of cells, moments jump that cells do not: order one in their side, which several meshes take out. At a third
and a sixth of the drawn side a wall along the mesh lies at 1/3 and 2/3 of a cell, where that error is alike.

A side on which ribs end is free, clamped or held along z. Held in its plane but free to turn, a slab would take the
thrust of a rib on its face as a moment at a point, under which a plate turns without limit. A wall ends inside or on a
free side: on a held one its load would go to a point of its foot, under which the corner of a wall gives way.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, Final

import numpy as np

from tests.independent.frames import section as shape
from tests.independent.linear import Floats, Linear
from tests.independent.ritz import section
from tests.independent.spectral_plates import PX, PY, Bar, Built, Plate, U, V, W, between_lines
from tests.machine.any_sheet import ASIDE
from tests.machine.columns import Ask, Subject, case_of, law_of, way
from tests.machine.framework import Case, Door, Model, capability
from tests.machine.plates import between, material, plies

Draft = dict[str, Any]
Turn = tuple[Floats, Floats]
"""Origin of a part and its axes, rows x, y, normal."""
_SIDES: Final = {"y0": "side 1", "x1": "side 2", "y1": "side 3", "x0": "side 4"}
_HELD: Final[dict[str, tuple[tuple[int, ...], tuple[int, ...]]]] = {  # of sides across x and across y
    "simple": ((U, V, W), (U, V, W)), "simple hard": ((U, V, W, PY), (U, V, W, PX)),
    "clamped": ((U, V, W, PX, PY),) * 2, "z": ((W,), (W,)),
}  # fmt: skip
_FACE: Final = {"below": -0.5, "middle": 0.0, "above": 0.5}
_ORDER: Final = 7
_END: Final = 0.1  # of a line: elements at its ends, where stresses are large
_TIMES: Final = {"ribs": (2, 4, 8), "wall": (3, 6)}
_MOVES: Final = 0.15  # of the largest of the first mode: places that move by less are not looked at
_ASIDE: Final = (
    *(*ASIDE, "joint-inside-cells", "wide-ribs", "arched-plate", "implausible"),
    *("one-mass-dominates", "stress-of-orthotropic"),
)
_RIBS: Final = (
    "cells of a half, a fourth and an eighth, orders one and two taken out: what is left of twelve draws mostly below "
    "2e-3, 1.4e-2 where ribs along the mesh lie elsewhere in its cells each time; polynomials of order 7: 1e-3"
)
_WALLS: Final = (
    "cells of a third and a sixth, order one taken out, where moments jump at a wall that turns little: what is left "
    "of fifteen draws below 1.7e-2, mostly 3e-3"
)
# What is moved at rest goes with 1 / f^2: twice of that.


def _finer(model: Model, ask: Ask) -> Floats:
    """Of oblique ribs without what goes with the side of the cells and with its square: f(h) = f + a h + b h^2 at h,
    h/2, h/4. Of walls without the first alone, of meshes in which they lie alike in their cells."""
    found = []
    for times in _TIMES["wall" if "w" in model["parts"] else "ribs"]:
        finer: Any = copy.deepcopy(model)
        for part in finer["parts"].values():
            if "mesh" in part:
                part["mesh"] /= times
        found.append(np.asarray(ask(finer)))
    if len(found) == 2:
        return np.asarray(2 * found[1] - found[0])
    return np.asarray((found[0] - 6 * found[1] + 8 * found[2]) / 3)


def _placed(part: Model) -> Turn:
    n = np.array(part.get("normal", [0, 0, 1]), float)
    x = np.array(part.get("x_direction", [1, 0, 0]), float)
    n, x = n / np.linalg.norm(n), x / np.linalg.norm(x)
    return np.array(part.get("origin", [0, 0, 0]), float), np.array([x, np.cross(n, x), n])


def _in_plane(part: Model, places: Floats) -> Floats:
    """Coordinates [n, 2] of places in space."""
    origin, axes = _placed(part)
    return np.asarray((np.asarray(places, float) - origin) @ axes[:2].T)


def _mesh(size: Sequence[float], lines: Sequence[Floats]) -> Floats:
    """Elements of a rectangle of which edges lie on lines [2, 2] side by side; these may begin and end inside of it."""
    along = int(np.argmax(np.abs(np.subtract(*lines[0])) / size))
    length, width, (start, end) = size[along], size[1 - along], lines[0][:, along]
    on = start + (end - start) * np.array([0, _END, 0.5, 1 - _END, 1])
    beside = [2 * start - on[1], 2 * end - on[-2]]
    near = 0.03 * length  # no elements that are thinner
    kept = [0.0, length, *(one for one in on if 1e-9 < one < length - 1e-9)]
    kept += [one for one in beside if near < one < length - near]
    rows = np.sort(kept)
    inner = [np.interp(rows, one[:, along], one[:, 1 - along]) for one in lines]
    columns = np.array([np.zeros_like(rows), *inner, np.full_like(rows, width)])
    places = np.stack([columns, np.tile(rows, (len(columns), 1))], axis=-1)
    return between_lines(places if along else places.swapaxes(0, 1)[..., ::-1])


def _plate(model: Model, name: str, quads: Floats) -> Plate:
    of = plies(model, name)
    h, mat = sum(one.thickness for one in of), model["parts"].get("mat")
    springs = (0.0, 0.0, 0.0)
    if name == "p" and mat:
        springs = mat["stiffness"]["normal"], mat["stiffness"]["shear"], _FACE[mat["side"]] * h
    lossy = section(of, lossy=True)
    loss = mat.get("loss_factor", 0.0) if mat else 0.0
    return Plate(quads, section(of), *_placed(model["parts"][name]), lossy, springs, loss)


def _bar(model: Model, rib: Model) -> Bar:
    slab = model["parts"]["p"]
    h, arm = sum(one.thickness for one in plies(model)), _placed(slab)[1] @ np.array(rib["offsets"]["start"])
    made, side = model["materials"][rib["material"]], dict(model["sections"][rib["section"]])
    start, end = (tuple(one) for one in _in_plane(slab, rib["lines"][0]).tolist())
    of, face, G = (
        shape(side.pop("shape"), **side),
        float(np.clip(arm[2], -h / 2, h / 2)),
        made["E"] / 2 / (1 + made["nu"]),
    )
    return Bar(start, end, tuple(arm.tolist()), face, of, made["E"], G, made["rho"], made.get("loss_factor", 0.0))


def _side(name: str, a: float, b: float) -> tuple[tuple[float, float], tuple[float, float]]:
    return {"y0": ((0, 0), (a, 0)), "x1": ((a, 0), (a, b)), "y1": ((0, b), (a, b)), "x0": ((0, 0), (0, b))}[name]


def built(model: Model, order: int = _ORDER) -> Built:
    """The structure of a model with ribs or a wall."""
    parts = model["parts"]
    slab, wall = parts["p"], parts.get("w")
    bars = [_bar(model, one) for one in parts.values() if one["type"] == "frame"]
    lines = [np.array([one.start, one.end]) for one in bars]
    if wall:
        (long, high), (origin, axes) = wall["outline"][2], _placed(wall)
        foot = _in_plane(slab, np.array([origin, origin + long * axes[0]]))
        lines = [foot if foot.sum(axis=1).argmax() else foot[::-1]]
    plates = {"p": _plate(model, "p", _mesh(slab["outline"][2], lines))}
    if wall:
        grid = np.meshgrid(np.array([0, _END, 0.5, 1 - _END, 1]) * long, np.array([0, 0.15, 1]) * high, indexing="ij")
        plates["w"] = _plate(model, "w", between_lines(np.stack(grid, axis=-1)))
    found = Built(plates, order)
    for one in bars:
        found.rib("p", one)
    if wall:
        found.stand("w", (0, 0), (long, 0), "p")
    for one in model["supports"].values():
        name = next(key for key, word in _SIDES.items() if word == one["set"])
        fix = one["fix"] if isinstance(one["fix"], str) else "".join(one["fix"])
        found.hold(one["on"], *_side(name, *parts[one["on"]]["outline"][2]), _HELD[fix][name[0] == "y"])
    return found


@lru_cache(maxsize=4)
def _linear(text: str, ways: tuple[str, ...], order: int) -> Linear:
    model = json.loads(text)
    found, rows = built(model, order), {}
    for words in ways:
        place, direction = way(words)
        at = model["points"][place]
        rows[place, direction] = found.row(at["on"], *at["at"], direction)
    return found.linear(rows, 20)


def form(model: Model, ways: tuple[str, ...], order: int = _ORDER) -> Linear:
    """A model's structure in its first modes, kept: an answer asks for it some times, and damping is no part of it."""
    said = {key: model[key] for key in ("materials", "sections", "parts", "points", "supports") if key in model}
    return _linear(json.dumps(said), ways, order)


def _a_slab(rng: np.random.Generator, ends: Mapping[str, tuple[str, ...]]) -> Draft:
    """Of 7 to 9 cells a side; ends : what may hold sides on which a line ends. One in four lies on a mat, free."""
    cell = between(rng, 0.12, 0.25)
    a, b = (round(float(one * cell), 6) for one in rng.integers(7, 10, 2))
    h = float(f"{min(a, b) / rng.uniform(15, 40):.4g}")
    ortho = bool(rng.random() < 0.3)
    part: Draft = {"type": "slab", "outline": [[0, 0], [a, 0], [a, b], [0, b]], "mesh": cell}
    layer = ["m", h, f"{between(rng, -90, 90)} deg"]
    part |= {"layers": [layer]} if ortho else {"material": "m", "thickness": h}
    model: Draft = {
        "materials": {"m": material(rng, ortho), "n": material(rng, False)}, "sections": {}, "parts": {"p": part},
        "points": {}, "joints": {}, "supports": {}, "damping": {"ratio": 0.01},
    }  # fmt: skip
    E = model["materials"]["m"]["E"][0] if ortho else model["materials"]["m"]["E"]
    model["materials"]["n"]["E"] = float(f"{E * 10 ** rng.uniform(-0.3, 0.7):.4g}")  # enough to matter
    if rng.random() < 0.25:
        k = float(f"{E * h**3 / a**4 * 10 ** rng.uniform(1, 2):.4g}")
        model["parts"]["mat"] = {
            "type": "foundation", "on": "p", "stiffness": {"normal": k, "shear": k * between(rng, 0.3, 1)},
            "side": str(rng.choice(list(_FACE))), "region": "whole",
        }  # fmt: skip
        return model
    while True:
        held = {name: str(rng.choice(ends.get(name, ("free", *_HELD)))) for name in _SIDES}
        words = list(held.values())
        if ("clamped" in words or len(words) - words.count("free") >= 2) and {*words} - {"free", "z"}:
            break
    for name, fix in held.items():
        if fix != "free":
            model["supports"][name] = {"on": "p", "set": _SIDES[name], "fix": ["z"] if fix == "z" else fix}
    return model


def _lean(rng: np.random.Generator, model: Draft) -> None:
    """All of it turned and moved in space, but for what is held along an axis of that."""
    if any(one["fix"] == ["z"] for one in model["supports"].values()):
        return
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn[:, 0] *= np.linalg.det(turn)
    moved = rng.uniform(-2, 2, 3).round(3)
    for part in model["parts"].values():
        if part["type"] == "slab":
            origin, axes = _placed(part)
            part["origin"] = (moved + turn @ origin).tolist()
            part |= {"normal": (turn @ axes[2]).tolist(), "x_direction": (turn @ axes[0]).tolist()}
        elif part["type"] == "frame":
            part["lines"] = [(moved + np.array(part["lines"][0]) @ turn.T).tolist()]
            part["offsets"] = {key: (turn @ np.array(arm)).tolist() for key, arm in part["offsets"].items()}
            part["orientation"] = turn[:, 2].tolist()


def _losing(rng: np.random.Generator, model: Draft) -> None:
    for one in [*model["materials"].values(), *(one for one in model["parts"].values() if one["type"] == "foundation")]:
        one["loss_factor"] = between(rng, 0.05, 0.15)
    model["damping"] = {"from": "materials"}


def _subject(model: Draft, seen: tuple[str, ...], accuracy: float, why: str) -> Subject | None:
    """Of the places that the first mode moves; None where it moves the drive too little, or nothing else."""
    ways = ("d.z", *seen)
    found = form(model, ways)
    first = found.modes(1)[1][:, 0]
    moves = {one: abs(float(found.rows[way(one)] @ first)) for one in ways}
    kept = tuple(one for one in ways if moves[one] > _MOVES * max(moves.values()))
    if kept[0] != "d.z" or len(kept) < 2:
        return None
    return Subject(
        model, lambda one: form(one, ways), kept[:1], kept[1:], accuracy, why, _finer, _ASIDE, ("materials",)
    )


def _ribbed(rng: np.random.Generator) -> Draft:
    """One rib or two from side to side, under, in or above a slab; a drive d, q and r on either side of them."""
    swap = bool(rng.random() < 0.5)
    model = _a_slab(rng, dict.fromkeys(("x0", "x1") if swap else ("y0", "y1"), ("free", "clamped", "z")))
    part = model["parts"]["p"]
    size = np.array(part["outline"][2])[:: -1 if swap else 1]  # across ribs, and along them
    h, number = sum(one.thickness for one in plies(model)), int(rng.integers(1, 3))
    edges = np.linspace(0.22, 0.72, number + 1)
    for k in range(number):
        width, height = between(rng, 0.5 * h, 2 * h), between(rng, h, 3 * h)
        side: Draft = {"shape": str(rng.choice(["rectangle", "box", "I"])), "width": width, "height": height}
        thin = between(rng, 0.06, 0.12) * min(width, height)
        side |= {"box": {"thickness": thin}, "I": {"web": thin, "flange": thin}}.get(side["shape"], {})
        model["sections"][f"s{k}"] = side
        at = rng.uniform(edges[k] + 0.03, edges[k + 1] - 0.03, 2) * size[0]
        ends = np.array([[at[0], 0, 0], [at[1], size[1], 0]]).round(4)
        ends = ends[:, [1, 0, 2]] if swap else ends
        up = float(rng.choice([-1, -1, 1, 0])) * (h + height) / 2
        model["parts"][f"r{k}"] = {
            "type": "frame", "material": "n", "section": f"s{k}", "mesh": part["mesh"], "lines": [ends.tolist()],
            "offsets": {"start": [0.0, 0.0, up], "end": [0.0, 0.0, up]},
        }  # fmt: skip
        model["joints"][f"j{k}"] = {"connect": [f"r{k}", "p"]}
    for name, low, next_to in (("q", 0.08, 0.3), ("d", 0.79, 0.2), ("r", 0.79, 0.6)):
        at = np.array([rng.uniform(low, low + 0.08), rng.uniform(next_to, next_to + 0.2)]) * size
        model["points"][name] = {"on": "p", "at": at[:: -1 if swap else 1].round(4).tolist()}
    if rng.random() < 0.4:
        _lean(rng, model)
    if rng.random() < 0.4:
        _losing(rng, model)
    return model


def _walled(rng: np.random.Generator) -> Draft:
    """A wall inside of a slab or from side to side, along its mesh or not; q and r on the slab, t on the wall."""
    swap, through, oblique = (bool(one) for one in rng.random(3) < [0.5, 0.4, 0.6])
    ends_on = (("x0", "x1") if swap else ("y0", "y1")) if through else ()
    model = _a_slab(rng, dict.fromkeys(ends_on, ("free",)))
    part = model["parts"]["p"]
    size, cell = np.array(part["outline"][2])[:: -1 if swap else 1], part["mesh"]
    h = sum(one.thickness for one in plies(model))
    cells = np.round(size / cell)
    on = (np.floor(rng.uniform(0.35, 0.65) * cells[0]) + 1 / 9) * cell  # 1/3 and 2/3 of cells of 1/3 and 1/6 of it
    low, high = (0.0, size[1]) if through else (rng.uniform(low, low + 0.15) * size[1] for low in (0.12, 0.7))
    off = rng.uniform(0.1, 0.2) * size[0] * rng.choice([-1, 1]) if oblique else 0.0
    ends = np.array([[on - off, low], [on + off, high]]).round(6)
    ends = ends[:, ::-1] if swap else ends
    along = np.append(ends[1] - ends[0], 0.0)
    long = float(np.linalg.norm(along))
    along /= long
    tall = between(rng, 0.3 * long, 0.7 * long)
    model["parts"]["w"] = {
        "type": "slab", "outline": [[0, 0], [long, 0], [long, tall], [0, tall]], "material": "n",
        "mesh": cell * between(rng, 0.7, 1.2), "thickness": float(f"{h * rng.uniform(0.5, 1.5):.4g}"),
        "origin": [*ends[0].tolist(), 0.0], "x_direction": along.tolist(), "normal": [along[1], -along[0], 0.0],
    }  # fmt: skip
    model["joints"]["foot"] = {"connect": ["w", "p"]}
    if rng.random() < 0.3:
        fix = str(rng.choice(["simple", "simple hard", "clamped"]))
        model["supports"]["top"] = {"on": "w", "set": "side 3", "fix": fix}
    for name, low, next_to in (("q", 0.08, 0.3), ("d", 0.76, 0.2), ("r", 0.76, 0.6)):
        at = np.array([rng.uniform(low, low + 0.12), rng.uniform(next_to, next_to + 0.2)]) * size
        model["points"][name] = {"on": "p", "at": at[:: -1 if swap else 1].round(4).tolist()}
    model["points"]["t"] = {"on": "w", "at": [round(long * rng.uniform(0.3, 0.7), 4), round(0.6 * tall, 4)]}
    if rng.random() < 0.4:
        _lean(rng, model)
    if rng.random() < 0.4:
        _losing(rng, model)
    return model


def _pushed(rng: np.random.Generator, one: Subject) -> str:
    """A place that a force on the drive moves at rest, as none behind a stiff rib is."""
    of = one.form(one.draft)
    moved = of.rest(of.load({way(one.drives[0]): 1.0}))
    sizes = {place: abs(float(of.rows[way(place)] @ moved)) for place in one.seen}
    return str(rng.choice([place for place, size in sizes.items() if size > 0.3 * max(sizes.values())]))


def _receptance(rng: np.random.Generator, one: Subject) -> Case:
    """Receptance on lines below the first mode, where it is 1 / (f1^2 - f^2) and moves by 3 % with 1 % of f1."""
    if "from" not in one.draft["damping"]:
        one.draft["damping"] = {str(rng.choice(["ratio", "loss_factor"])): between(rng, 0.03, 0.1)}
    step = float(f"{one.form(one.draft).modes(1)[0][0] / 20:.3g}")
    lines, drive, response = step * np.arange(5, 13), one.drives[0], _pushed(rng, one)
    directly = ["--method", "direct"] if "from" in one.draft["damping"] else []

    def asked(model: Model, door: Door) -> Floats:
        def ask(finer: Model) -> Floats:
            words = ("--drive", drive, "--response", response, "--band", f"{lines[0]} Hz:{lines[-1]} Hz")
            found = one.ask(door, finer, "frf", *words, "--step", f"{step}", "--kind", "receptance", *directly)
            return np.r_[found["real"], found["imag"]]

        answer = one.refine(model, ask)
        one.clear(door)
        return answer

    def right(model: Model, _: Door) -> Floats:
        of = one.form(model)
        moved = of.shaken(lines, of.load({way(drive): 1.0}), law_of(model)) @ of.rows[way(response)]
        return np.r_[moved.real, moved.imag]

    return Case(
        one.draft, asked, right, 3 * one.accuracy, one.reason + "; on lines up to 0.6 of the first mode", one.knobs
    )


def _case(rng: np.random.Generator, one: Subject, answers: tuple[str, ...]) -> Case:
    answer = str(rng.choice(answers))
    return _receptance(rng, one) if answer == "frf" else case_of(rng, replace(one, answers=(answer,)))


def _ribbed_case(rng: np.random.Generator, *answers: str) -> Case:
    while True:
        one = _subject(_ribbed(rng), ("q.z", "r.z"), 1.5e-2, _RIBS)
        if one:
            return _case(rng, one, answers)


def _walled_case(rng: np.random.Generator, *answers: str) -> Case:
    while True:
        model = _walled(rng)
        across = "xyz"[int(np.abs(model["parts"]["w"]["normal"]).argmax())]
        one = _subject(model, ("q.z", "r.z", f"t.{across}"), 2e-2, _WALLS)
        if one:
            return _case(rng, one, answers)


@capability("ribs and walls: frequencies with oblique ribs", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _ribbed_case(rng, "modes")


@capability("ribs and walls: any answer with oblique ribs", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _ribbed_case(rng, "losses", "statics", "frf")


@capability("ribs and walls: frequencies with a wall", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _walled_case(rng, "modes")


@capability("ribs and walls: any answer with a wall", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _walled_case(rng, "losses", "statics", "frf")
