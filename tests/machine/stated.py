"""What decks state beside their mesh, taken as it is, beside the same that the model states itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from tests.machine.bars import a_material
from tests.machine.framework import Case, Door, Floats, Model, capability

Draft = dict[str, Any]
_SAME: Final = "the same structure; coordinates to twelve digits, tolerance of the eigensolution"
_SIX: Final = ("x", "y", "z", "rx", "ry", "rz")
_LONG, _WIDE = 6, 4  # cells


@dataclass(frozen=True)
class Plate:
    """A bent plate of two halves: nodes [n, 3], cells [c, 4] of nodes from 0, of the second half [c], its numbers."""

    nodes: Floats
    cells: Floats
    second: Floats
    made: Draft

    def node(self, i: int, j: int) -> int:
        """Number, from 1, of a node by its place along and across."""
        return i * (_WIDE + 1) + j + 1

    @property
    def edge(self) -> list[int]:
        return [self.node(0, j) for j in range(_WIDE + 1)]

    @property
    def links(self) -> list[tuple[int, list[int]]]:
        """Nodes that lead, and those that follow each; no node is of two."""
        of = self.node
        return [
            (of(6, 0), [of(5, 0), of(5, 1), of(6, 1)]),
            (of(6, 2), [of(5, 2), of(6, 3)]),
            (of(4, 1), [of(4, 2), of(3, 1)]),
            (of(4, 3), [of(2, 3)]),
        ]

    @property
    def mean(self) -> int:
        """A node that follows those of `meant`."""
        return self.node(4, 4)

    @property
    def meant(self) -> list[int]:
        return [self.node(3, 3), self.node(3, 4), self.node(5, 4), self.node(5, 3)]

    @property
    def tip(self) -> int:
        return self.node(_LONG, _WIDE)

    @property
    def area(self) -> float:
        """Of the second half."""
        a, b, c, d = (self.nodes[self.cells[self.second][:, k]] for k in range(4))
        return float(np.linalg.norm(np.cross(c - a, d - b), axis=1).sum() / 2)


def a_plate(rng: np.random.Generator) -> Plate:
    a, b, rise = rng.uniform(0.6, 1.0, 3) * [1, 0.7, 0.2]
    x = np.repeat(np.linspace(0, a, _LONG + 1), _WIDE + 1)
    y = np.tile(np.linspace(0, b, _WIDE + 1), _LONG + 1)
    nodes = np.column_stack([x, y, rise * (x / a) ** 2])
    k = np.arange(len(nodes)).reshape(_LONG + 1, _WIDE + 1)
    cells = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    thin = float(f"{rng.uniform(4e-3, 6e-3):.4g}")
    weigh = 7800 * thin
    made: Draft = {
        "thickness": [thin, float(f"{thin * rng.uniform(1.3, 2):.4g}")],
        "spread": [float(f"{weigh * one:.4g}") for one in rng.uniform(0.3, 0.8, 2)],
        "total": float(f"{weigh * a * b / 2 * rng.uniform(0.2, 0.5):.4g}"),
        "mass": float(f"{weigh * a * b * rng.uniform(0.2, 0.5):.4g}"),
        "offset": rng.uniform(-0.05, 0.05, 3).round(4).tolist(),
        "inertia": (weigh * a * b * 0.002 * np.r_[rng.uniform(0.8, 1.2, 3), rng.uniform(-0.3, 0.3, 3)]).tolist(),
    }  # fmt: skip
    return Plate(nodes, cells, np.repeat(np.arange(_LONG), _WIDE) >= _LONG // 2, made)


def _whole(plate: Plate, material: Draft, name: str, sets: tuple[str, str]) -> Draft:
    """Two shells of a file, joined by the nodes they share, and points at the named nodes."""
    names = {"tip": plate.tip, "lead": plate.links[0][0], "mean": plate.mean}
    parts = {
        part: {"type": "shell", "mesh": name, "set": of, "material": "m"}
        for part, of in zip(("low", "high"), sets, strict=True)
    }
    points = {point: {"on": "high", "at": plate.nodes[node - 1].tolist()} for point, node in names.items()}
    return {"materials": {"m": material}, "parts": parts, "points": points, "damping": {"ratio": 0.01}}


def _answers(inner: Model, door: Door, files: Mapping[str, str]) -> Floats:
    """Motion of the points under weight and a force, forces and natural frequencies."""
    rest = door.ask(inner, "statics", "--weight", "--force", "tip.y=20 N", **files)
    own = door.ask(inner, "modes", "--count", "5", **files)["frequency_hz"]
    moved = np.array([rest["points"][one] for one in ("tip", "lead", "mean")])
    return np.r_[moved.ravel() / np.abs(moved).max(), np.abs(moved).max(), np.array(own)]


Link = tuple[int, list[int], tuple[str, ...]]


def _by_hand(
    plate: Plate, material: Draft, held: Mapping[int, tuple[str, ...]], links: Sequence[Link], weights: Floats,
    body: Draft,
) -> Draft:  # fmt: skip
    """The model that states all of it. held : directions by node. links : a node, those that follow it, and in what.
    weights [4] : of the nodes that another follows in its shifts."""
    inner = _whole(plate, material, "plain.inp", ("LOW", "HIGH"))
    spread = [plate.made["spread"][0], plate.made["spread"][1] + plate.made["total"] / plate.area]
    for part, thick, more in zip(("low", "high"), plate.made["thickness"], spread, strict=True):
        inner["parts"][part] |= {"thickness": thick, "nonstructural": more}
    inner["supports"], inner["constraints"] = {}, {}
    half = plate.nodes[plate.node(_LONG // 2, 0) - 1][0]
    for node in {*held, *plate.meant, plate.mean, *(one for lead, led, _ in links for one in (lead, *led))}:
        part = "low" if plate.nodes[node - 1][0] < half + 1e-9 else "high"
        inner["points"][f"n{node}"] = {"on": part, "at": plate.nodes[node - 1].tolist()}
    for node, fix in held.items():
        inner["supports"][f"s{node}"] = {"at": f"n{node}", "fix": list(fix)}
    for lead, led, follows in links:
        to = [f"n{one}" for one in led]
        inner["constraints"][f"link {lead} {led[0]}"] = {"rigid": f"n{lead}", "to": to, "directions": list(follows)}
    rows = _fitted(plate.nodes[np.array(plate.meant) - 1] - plate.nodes[plate.mean - 1], weights)
    spots = [f"n{node}.{axis}" for node in plate.meant for axis in "xyz"]
    for axis, row in zip("xyz", rows, strict=True):
        factors = {spot: float(one) for spot, one in zip(spots, row, strict=True) if abs(one) > 1e-12}
        inner["constraints"][f"mean {axis}"] = {"equation": {f"n{plate.mean}.{axis}": -1.0, **factors}}
    inner["parts"]["body"] = {"type": "inertia", "at": "tip", **body}
    return inner


def _fitted(arms: Floats, weights: Floats) -> Floats:
    """Shift of the rigid motion that fits weighted shifts at arms [k, 3] best, from these [3, 3 k]."""
    motion = np.vstack([np.hstack([np.eye(3), np.cross(np.eye(3), arm)]) for arm in arms])
    weighed = np.repeat(weights, 3)[:, None] * motion
    return np.linalg.solve(motion.T @ weighed, weighed.T)[:3]


def _plain(plate: Plate) -> str:
    lines = ["*NODE", *(f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in enumerate(plate.nodes.tolist(), 1))]
    for name, own in (("LOW", ~plate.second), ("HIGH", plate.second)):
        lines.append(f"*ELEMENT, TYPE=S4, ELSET={name}")
        lines += [f"{c + 1}, {', '.join(str(one + 1) for one in plate.cells[c])}" for c in np.flatnonzero(own)]
    return "\n".join([*lines, ""])


def _case(plate: Plate, material: Draft, taker: Draft, files: dict[str, str], plain: Draft) -> Case:
    draft = {"materials": {"m": material}, "taker": taker, "plain": plain}

    def asked(model: Model, door: Door) -> Floats:
        return _answers({**model["taker"], "materials": model["materials"]}, door, files)

    def right(model: Model, door: Door) -> Floats:
        inner = {**model["plain"], "materials": model["materials"]}
        return _answers(inner, door, {"plain.inp": _plain(plate)})

    return Case(draft, asked, right, 2e-7, _SAME)


class _Systems:
    """Coordinate systems of a deck, each with its origin and axes, and places in them."""

    def __init__(self, rng: np.random.Generator, plate: Plate) -> None:
        self.kinds = {1: "R", 2: "C", 3: "S", 4: "R", 5: "C", 6: "S"}
        self.frames: dict[int, tuple[Floats, Floats]] = {}
        self.cards: list[str] = []
        of = {1: 0, 2: 1, 3: 2}
        for number, base in of.items():
            axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            axes *= np.linalg.det(axes)
            origin = np.array([0.3, 0.2, 0.1]) + rng.uniform(1, 2, 3) * rng.choice([-1, 1], 3)
            self.frames[number] = origin, axes
            three = [origin, origin + axes[2], origin + 0.7 * axes[0] + 0.4 * axes[2]]
            words = [f"{one:.12g}" for at in three for one in self.into(base, at)]
            name = f"CORD2{self.kinds[number]}"
            self.cards += [f"{name},{number},{base},{','.join(words[:6])}", f",{','.join(words[6:])}"]
        three_nodes = [plate.node(0, 0), plate.node(2, 1), plate.node(1, 3)]
        origin, along, to = (plate.nodes[node - 1] for node in three_nodes)
        z = (along - origin) / np.linalg.norm(along - origin)
        y = np.cross(z, to - origin)
        y /= np.linalg.norm(y)
        self.by_nodes = three_nodes
        for number in (4, 5, 6):
            self.frames[number] = origin, np.stack([np.cross(y, z), y, z])
        nodes = ",".join(map(str, three_nodes))
        self.cards += [f"CORD1R,4,{nodes},7,{nodes}", f"CORD1C,5,{nodes}", f"CORD1S,6,{nodes}"]
        self.kinds[7], self.frames[7] = "R", self.frames[4]

    def into(self, number: int, at: Floats) -> list[float]:
        """Coordinates of a place in a system; angles in degrees."""
        if not number:
            return [float(one) for one in at]
        origin, axes = self.frames[number]
        x, y, z = axes @ (at - origin)
        if self.kinds[number] == "R":
            return [x, y, z]
        turn = float(np.degrees(np.arctan2(y, x)))
        if self.kinds[number] == "C":
            return [float(np.hypot(x, y)), turn, z]
        r = float(np.sqrt(x**2 + y**2 + z**2))
        return [r, float(np.degrees(np.arccos(z / r))), turn]


def _grids(rng: np.random.Generator, plate: Plate, systems: _Systems, held: Mapping[int, str]) -> list[str]:
    """GRID in large fields, in systems by turns, those that name none in that of GRDSET; held by their own PS."""
    lines = []
    for at, place in enumerate(plate.nodes):
        number = at + 1
        # what a system by nodes stands on is in the basic one or in one by points
        system = (0, 1, 2, 3, 4, 5, 6, 7)[at % (4 if number in systems.by_nodes else 8)]
        words = [
            f"{one:16.9E}" if abs(one) < 1e-4 else f"{one:16.12f}" if one > -100.0 else f"{one:16.11f}"
            for one in systems.into(system, place)
        ]  # of 16 characters, angles beyond -100 degrees, too
        shown = f"{'' if system == 2 else system!s:>16}" if system != 2 else " " * 16
        moving, fixed = ("", held.get(number, ""))
        lines.append(f"GRID*   {number:16d}{shown}{words[0]}{words[1]}*A{at}")
        lines.append(f"*A{at:<6d}{words[2]}{moving:>16}{fixed:>16}")
    return lines


@capability("decks: all that Nastran states beside its mesh", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Coordinate systems, sections, mass on cells, sets, supports, links, masses, their factor, and files in files."""
    plate, material = a_plate(rng), a_material(rng)
    made, systems = plate.made, _Systems(rng, plate)
    factor = float(rng.choice([1.0, 0.001]))
    mass = {key: made[key] / factor for key in ("mass", "total")}
    spread = [one / factor for one in made["spread"]]
    ixx, iyy, izz, ixy, iyz, izx = (one / factor for one in made["inertia"])
    high = [c + 1 for c in np.flatnonzero(plate.second)]
    own, moved, alone = plate.node(2, 0), plate.node(3, 0), plate.node(3, 2)
    free = [plate.node(6, 1), plate.node(6, 3)]
    a, b = plate.node(4, 0), plate.node(2, _WIDE)
    control = [
        "SOL 103",
        "CEND",
        "TITLE = a plate",
        "NSM = 7",
        "SPC = 10",
        f"SET 5 = 1 THRU {high[0] - 2},",
        f" {high[0] - 1}",
    ]
    low_thick, high_thick = made["thickness"]
    lines = [
        f"PSHELL,1,1,{low_thick},1,,1,,{spread[0]:.9E}",
        f"PSHELL  {2:8d}{1:8d}{high_thick:8.6f}{1:8d}{'':8}{1:8d}",
    ]
    lines += [f"NSM1,7,PSHELL,{spread[1]:.9E},2", f"NSML1,7,ELEMENT,{mass['total']:.9E},{high[0]},THRU,{high[-1]}"]
    lines += [
        f"NSM1,8,PSHELL,{spread[1]:.9E},1,2",
        f"PARAM,WTMASS,{factor}",
        f"SET1,6,{high[0]},THRU,{high[-2]},{high[-1]}",
    ]
    lines += [
        f"SPC1,1,123456,{plate.edge[0]},THRU,{plate.edge[-1]}",
        f"SPC,2,{own},3,0.,{moved},24,0.",
        f"SPC,2,{alone},2",
        "SPCADD,10,1,2",
    ]
    lines += [f"SPC1,3,123456,{plate.tip}", "GRDSET,,2", *systems.cards]
    lines += [f"SET3,9,GRID,{free[0]},{free[1]}"]
    (lead, led), (other, others) = plate.links[:2]
    small = "".join(f"{one:8d}" for one in led[:2])
    lines += [f"RBE2    {901:8d}{lead:8d}{'1235':>8}{small}{'':24}+B", f"+B      {led[2]:8d}{1e-5:8.1E}"]
    lines += [f"RBE2,904,{other},123456,{','.join(map(str, others))}"]
    lines += [f"RBE3,902,,{plate.mean},123,2.5,123,{','.join(map(str, plate.meant[:2]))},+C"]
    lines += [f"+C,1.5,312,{','.join(map(str, plate.meant[2:]))}"]
    lines += [f"CONM2,903,{plate.tip},0,{mass['mass']:.9E},{','.join(map(str, made['offset']))},"]
    lines += [f",{ixx:.9E},{ixy:.9E},{iyy:.9E},{izx:.9E},{iyz:.9E},{izz:.9E}", f"MAT1,1,{material['E']:.6E},,.3,7800."]
    cells = [f"CQUAD4  {c + 1:8d}{1 + int(second):8d}" + "".join(f"{one + 1:8d}" for one in plate.cells[c])
             for c, second in enumerate(plate.second)]  # fmt: skip
    grids = _grids(rng, plate, systems, {a: "1", b: "34"})
    text = "\n".join(
        [*control, "BEGIN BULK", "$ a comment", *lines, "INCLUDE 'cells.dat'", *grids, "ENDDATA", "no card"]
    )
    taker = _whole(plate, material, "deck.bdf", ("SET 5", "SET 6"))
    taker["parts"]["held"] = {"type": "attachments", "mesh": "deck.bdf", "take": ["supports", "links", "masses"]}
    held: dict[int, tuple[str, ...]] = dict.fromkeys(plate.edge, _SIX)
    held |= {
        own: ("z",),
        moved: ("y", "rx"),
        alone: ("y",),
        free[0]: ("z",),
        free[1]: ("z",),
        a: ("x",),
        b: ("z", "rx"),
    }
    taker["supports"] = {"props": {"on": "high", "set": "SET 9", "fix": ["z"]}}
    body = {key: made[key] for key in ("mass", "offset", "inertia")}
    links = [(lead, led, ("x", "y", "z", "ry")), (other, others, _SIX)]
    plain = _by_hand(plate, material, held, links, np.array([2.5, 2.5, 1.5, 1.5]), body)
    return _case(plate, material, taker, {"deck.bdf": text, "cells.dat": "\n".join(cells) + "\n"}, plain)


@capability("decks: all that Abaqus states beside its mesh", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Sets of sets and by steps, sections, mass on cells, supports by their words, links, masses, and a file in it."""
    plate, material = a_plate(rng), a_material(rng)
    made = plate.made
    low, high = ([c + 1 for c in np.flatnonzero(own)] for own in (~plate.second, plate.second))
    nodes = [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in enumerate(plate.nodes.tolist(), 1)]
    lines = [
        "** a plate",
        "*Heading",
        " a plate",
        "*Part, name=one",
        "*NODE, NSET=all",
        *nodes[:10],
        "*Node",
        *nodes[10:],
    ]
    lines += ["*ELEMENT, TYPE=S4,", "ELSET=skin"]
    for c, cell in enumerate(plate.cells):
        words = [str(one + 1) for one in cell]
        lines += (
            [f"{c + 1}, {', '.join(words)}"] if c % 3 else [f"{c + 1}, {', '.join(words[:2])},", ", ".join(words[2:])]
        )
    lines += ["*ELSET, ELSET=even, GENERATE", f"2, {low[-1]}, 2", "*ELSET, ELSET=odd", ", ".join(map(str, low[::2]))]
    lines += ["*ELSET, ELSET=low", "even, ODD", "*ELSET, ELSET=high, GENERATE", f"{high[0]}, {high[-1]}"]
    lines += ["*NSET, NSET=edge, GENERATE", f"{plate.edge[0]}, {plate.edge[-1]}, 1"]
    lines += ["*NSET, NSET=led", ", ".join(map(str, plate.links[0][1])), "*NSET, NSET=lead", str(plate.links[0][0])]
    lines += ["*ELEMENT, TYPE=MASS, ELSET=lump", f"801, {plate.tip}", "*MASS, ELSET=LUMP", f"{made['mass']}"]
    thin, thick = made["thickness"]
    lines += ["*End Part", "*Assembly, name=a", "*Instance, name=b, part=one", "*End Instance", "*End Assembly"]
    lines += [
        "*SHELL SECTION, ELSET=Low, MATERIAL=steel",
        f"{thin}, 5",
        "*SHELL SECTION, MATERIAL=steel, ELSET=HIGH, OFFSET=0.",
    ]
    lines += [f"{thick}", "*INCLUDE, INPUT=more.inp", "*MATERIAL, NAME=steel", "*ELASTIC", f"{material['E']}, 0.3"]
    lines += ["*NONSTRUCTURAL MASS, ELSET=low, UNITS=MASS PER AREA", f"{made['spread'][0]}"]
    lines += ["*NONSTRUCTURAL MASS, ELSET=HIGH, UNITS=MASS PER VOLUME", f"{made['spread'][1] / thick!r}"]
    lines += ["*NONSTRUCTURAL MASS, ELSET=high, UNITS=TOTAL MASS", f"{made['total']}"]
    lines += ["*TRANSFORM, NSET=edge, TYPE=C", "0, 0, 0, 0, 0, 1"]
    means = {
        "XSYMM": ("x", "ry", "rz"), "YSYMM": ("y", "rx", "rz"), "ZSYMM": ("z", "rx", "ry"), "PINNED": ("x", "y", "z"),
        "XASYMM": ("y", "z", "rx"), "YASYMM": ("x", "z", "ry"), "ZASYMM": ("x", "y", "rz"),
    }  # fmt: skip
    some = [plate.node(*one) for one in ((1, 0), (1, 2), (1, 4), (2, 0), (2, 2), (2, 4), (3, 0))]
    some = rng.permutation(some).tolist()
    by_word = [f"{node}, {word}" for node, word in zip(some, means, strict=True)]
    one, two, three = plate.node(3, 2), plate.node(1, 1), plate.node(4, 0)
    lines += ["*BOUNDARY", "EDGE, ENCASTRE", *by_word, f"{plate.tip}, 1, 3, 0."]
    lines += ["*STEP", "*FREQUENCY", "3", "*BOUNDARY, OP=NEW", "edge, Encastre", *by_word]
    lines += [f"{one}, 3", f"{two}, 3, 4", f"{three}, 5, 5, 0.0", "*END STEP"]
    lines += ["*STEP", "*BOUNDARY", f"{plate.tip}, 3", "*END STEP"]
    (a, of_a), (b, of_b), (c, of_c), (d, of_d) = plate.links
    more = ["*NSET, NSET=meant", ", ".join(map(str, plate.meant[:2]))]
    more += ["*SURFACE, TYPE=NODE, NAME=mean face", "meant, 2.", *(f"{node}, 3." for node in plate.meant[2:])]
    more += [f"*COUPLING, CONSTRAINT NAME=a, REF NODE={plate.mean}, SURFACE=MEAN FACE", "*DISTRIBUTING", "1, 2", "3, 3"]
    more += ["*RIGID BODY, REF NODE=lead, PIN NSET=led", "*NSET, NSET=face, UNSORTED", ", ".join(map(str, [b, *of_b]))]
    more += ["*SURFACE, NAME=face, TYPE=NODE", "FACE", f"*COUPLING, CONSTRAINT NAME=b, REF NODE={b}, SURFACE=face"]
    more += [
        "*KINEMATIC",
        "1, 3",
        "5",
        f"*KINEMATIC COUPLING, REF NODE={c}",
        f"{of_c[0]}, 1, 2",
        f"{of_c[1]}, 3",
        f"{c}, 1",
    ]
    more += ["*NSET, NSET=d", f"{d}, {of_d[0]}", f"*RIGID BODY, TIE NSET=d, REF NODE={d}"]
    taker = _whole(plate, material, "deck.inp", ("low", "high"))
    taker["parts"]["held"] = {"type": "attachments", "mesh": "deck.inp", "take": ["supports", "links", "masses"]}
    held: dict[int, tuple[str, ...]] = dict.fromkeys(plate.edge, _SIX)
    held |= {**dict(zip(some, means.values(), strict=True)), one: ("z",), two: ("z", "rx"), three: ("ry",)}
    links = [(a, of_a, _SIX[:3]), (b, of_b, ("x", "y", "z", "ry")), (c, of_c[:1], ("x", "y")), (c, of_c[1:], ("z",)),
             (d, of_d, _SIX)]  # fmt: skip
    plain = _by_hand(plate, material, held, links, np.array([2.0, 2.0, 3.0, 3.0]), {"mass": made["mass"]})
    files = {"deck.inp": "\n".join([*lines, ""]), "more.inp": "\n".join([*more, ""])}
    return _case(plate, material, taker, files, plain)
