"""Unlike meshes that are joined under a constant stress or moment, which goes across exactly."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from tests.independent.mesh_files import CORNERS, EDGES, Group, Meshed
from tests.machine.formats import vtu
from tests.machine.framework import Case, Door, Floats, Model, capability

Draft = dict[str, Any]
_SIX: Final = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
_LEVER: Final = 0.05  # m, of the pairs of forces
_EXACT: Final = "all elements and joints have constant strains exactly; rounding of the solution"


def pieces(counts: Sequence[int], corners: Floats, kind: str) -> tuple[Floats, Floats]:
    """Nodes [n, 3] and cells between corners [2, 2, .., 3] of a box or of a rectangle, of one kind of cell."""
    lines = [np.linspace(0, 1, count + 1) for count in counts]
    places = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(counts))
    nodes = np.zeros((len(places), 3))
    for at in np.ndindex(*(2,) * len(counts)):
        weight = np.prod([places[:, k] if one else 1 - places[:, k] for k, one in enumerate(at)], axis=0)
        nodes += weight[:, None] * corners[at]
    k = np.arange(len(nodes)).reshape([count + 1 for count in counts])
    low, high = slice(None, -1), slice(1, None)
    ring = [(low, low), (high, low), (high, high), (low, high)]
    if len(counts) == 2:
        return nodes, np.stack([k[one] for one in ring], axis=-1).reshape(-1, 4)
    cells = np.stack([k[(*one, z)] for z in (low, high) for one in ring], axis=-1).reshape(-1, 8)
    cells = np.vstack([cells[:, list(one)] for one in _SIX]) if CORNERS[kind] == 4 else cells
    if kind in EDGES:
        pairs = np.sort(cells[:, np.array(EDGES[kind])], axis=-1)
        own, inverse = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
        cells = np.hstack([cells, len(nodes) + inverse.reshape(pairs.shape[:2])])
        nodes = np.vstack([nodes, nodes[own].mean(axis=1)])
    return nodes, cells


def file_of(nodes: Floats, cells: Floats, kind: str) -> str:
    return vtu(Meshed(nodes, (Group("all", kind, cells, "foot", ()),), np.arange(len(nodes)) + 1))


def box_of(nodes: Floats) -> list[list[float]]:
    return [(nodes.min(axis=0) - 1e-6).tolist(), (nodes.max(axis=0) + 1e-6).tolist()]


def _ends(counts: Sequence[int], force: float) -> Floats:
    """Forces at the nodes of a face of equal cells, or of a line, whose stress is constant."""
    one = [np.r_[0.5, np.ones(count - 1), 0.5] / count for count in counts]
    found: Floats = force * (np.outer(*one).ravel() if len(one) == 2 else one[0])
    return found


def _three(rng: np.random.Generator, kind: str, seam: bool) -> tuple[Draft, dict[str, str], list[str], Floats]:
    """Three bricks in a row along x, the middle one of a kind between oblique faces: the model, its files, forces at
    its end, and the places of the end."""
    width, height = rng.uniform(0.15, 0.3, 2)
    ends = np.cumsum([0.0, *rng.uniform(0.2, 0.4, 3)])
    lean = [(0.0, 0.0), tuple(rng.uniform(-0.2, 0.2, 2)), tuple(rng.uniform(-0.2, 0.2, 2)), (0.0, 0.0)]
    face = np.array([[[0.0, 0.0], [0.0, height]], [[width, 0.0], [width, height]]])
    faces = [
        np.concatenate([(x + face @ np.array(by))[..., None], face], axis=-1) for x, by in zip(ends, lean, strict=True)
    ]
    counts = [(1, 2, 1), (1, 3, 2), (2, 1, 3)]
    parts, files, grids = {}, {}, []
    for at, (name, cells) in enumerate(zip("abc", counts, strict=True)):
        of = kind if name == "b" else "hex8"
        nodes, own = pieces(cells, np.stack(faces[at : at + 2]), of)
        files[f"{name}.vtu"] = file_of(nodes, own, of)
        parts[name] = {"type": "solid", "mesh": f"{name}.vtu", "material": "m"}
        grids.append(nodes)
    inner: Draft = {"parts": parts, "damping": {"ratio": 0.01}}
    root = np.flatnonzero(grids[0][:, 0] < 1e-9)
    inner["points"] = {"p": {"on": "a", "at": [0.0, 0.0, 0.0]}, "q": {"on": "a", "at": [0.0, float(width), 0.0]}}
    inner["supports"] = {
        "root": {"on": "a", "box": box_of(grids[0][root]), "fix": ["x"]},
        "one": {"at": "p", "fix": ["y", "z"]}, "two": {"at": "q", "fix": ["z"]},
    }  # fmt: skip
    if seam:

        def side(name: str, face: Floats) -> Draft:
            return {"on": name, "box": box_of(face.reshape(-1, 3))}

        inner["constraints"] = {
            "s": {"seam": side("b", faces[1]), "onto": side("a", faces[1])},
            "t": {"seam": side("c", faces[2]), "onto": side("b", faces[2])},
        }  # fmt: skip
    else:
        inner["joints"] = {f"j{one}": {"connect": [one, "b"], "kind": "pinned"} for one in "ac"}
    tip = grids[2][grids[2][:, 0] > ends[3] - 1e-9]
    inner["points"] |= {f"t{k}": {"on": "c", "at": at.tolist()} for k, at in enumerate(tip)}
    pull = float(rng.uniform(1e3, 2e3))
    forces = [f"t{k}.x={one!r} N" for k, one in enumerate(_ends(counts[2][1:], pull).tolist())]
    return inner, files, forces, np.column_stack([np.tile([pull, width * height], (len(tip), 1)), tip])


@capability("joints: bricks of unlike faces under tension", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Each kind of cell between bricks of eight nodes, by joints and by seams: u = sigma / E (x, -nu y, -nu z)."""
    made = {"E": float(f"{rng.uniform(1e10, 2e11):.4g}"), "nu": float(f"{rng.uniform(0.1, 0.4):.3g}"), "rho": 2000.0}
    every = [
        _three(rng, kind, seam) for kind, seam in (("hex8", False), ("tet4", True), ("hex20", True), ("tet10", False))
    ]
    draft: Draft = {"materials": {"m": made}, "bricks": [one[0] for one in every]}

    def asked(model: Model, door: Door) -> Floats:
        out = []
        for inner, (_, files, forces, places) in zip(model["bricks"], every, strict=True):
            words = [word for one in forces for word in ("--force", one)]
            found = door.ask({**inner, "materials": model["materials"]}, "statics", *words, **files)
            moved = np.array([found["points"][f"t{k}"][:3] for k in range(len(places))])
            across = [one[0] for name, one in found["forces_n"].items() if name in ("ja", "jc", "s", "t")]
            out.append(np.r_[moved.ravel() * 1e9, found["forces_n"]["root"][0] / 1e3, np.abs(across) / 1e3])
        door.told = []
        return np.concatenate(out)

    def right(model: Model, _: Door) -> Floats:
        E, nu = model["materials"]["m"]["E"], model["materials"]["m"]["nu"]
        out = []
        for _inner, _files, _forces, places in every:
            strain = places[:, :1] / places[:, 1:2] / E
            out.append(np.r_[(strain * places[:, 2:] * [1, -nu, -nu]).ravel() * 1e9, [places[0, 0] / 1e3] * 3])
        return np.concatenate(out)

    return Case(draft, asked, right, 1e-6, _EXACT)


def _strips(rng: np.random.Generator, angle: float, seam: bool) -> tuple[Draft, dict[str, str], Draft]:
    """Two strips of shells, the second turned up by an angle about the line on which they meet."""
    one, two, width, thick = (float(f"{x:.3g}") for x in rng.uniform([0.3, 0.3, 0.2, 0.004], [0.6, 0.6, 0.3, 0.008]))
    along = np.array([np.cos(angle), 0.0, np.sin(angle)])
    lines = [np.zeros(3), np.array([one, 0, 0]), np.array([one, 0, 0]) + two * along]
    across = np.array([0.0, width, 0.0])
    counts = [(3, int(rng.integers(2, 4))), (4, 5)]
    parts, files, grids = {}, {}, []
    for name, cells, start, end in zip("ab", counts, lines, lines[1:], strict=False):
        corners = np.array([[start, start + across], [end, end + across]])
        nodes, own = pieces(cells, corners, "quad4")
        files[f"{name}.vtu"] = file_of(nodes, own, "quad4")
        parts[name] = {"type": "shell", "mesh": f"{name}.vtu", "material": "m", "thickness": thick}
        grids.append(nodes)
    inner: Draft = {"parts": parts, "damping": {"ratio": 0.01}}
    edge = box_of(np.array([lines[1], lines[1] + across]))
    inner["supports"] = {"root": {"on": "a", "box": box_of(np.array([lines[0], across])), "fix": "clamped"}}
    if seam:
        inner["constraints"] = {"s": {"seam": {"on": "b", "box": edge}, "onto": {"on": "a", "box": edge}}}
    else:
        inner["joints"] = {"j": {"connect": ["a", "b"]}}
    tip = grids[1][-6:]
    tops = tip + np.array([0.0, 0.0, _LEVER])
    parts["levers"] = {
        "type": "frame", "material": "m", "section": "s",
        "lines": [[a.tolist(), b.tolist()] for a, b in zip(tip, tops, strict=True)],
    }  # fmt: skip
    inner["sections"] = {"s": {"shape": "rectangle", "width": 0.01, "height": 0.01}}
    inner["joints"] = {**inner.get("joints", {}), "stand": {"connect": ["levers", "b"]}}
    inner["points"] = {f"t{k}": {"on": "b", "at": at.tolist()} for k, at in enumerate(tip)}
    inner["points"] |= {f"u{k}": {"on": "levers", "at": at.tolist()} for k, at in enumerate(tops)}
    sizes = {"one": one, "two": two, "width": width, "thick": thick, "angle": angle}
    return inner, files, sizes


@capability("joints: strips of unlike lines under a moment", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Without lateral contraction: a moment turns the end by M (L1 + L2) / E I, folded or not."""
    made = {"E": float(f"{rng.uniform(1e10, 2e11):.4g}"), "nu": 0.0, "rho": 2000.0}
    fold = float(rng.uniform(0.4, 1.8))
    every = [_strips(rng, angle, seam) for angle, seam in ((0.0, False), (0.0, True), (fold, False), (fold, True))]
    moment = float(rng.uniform(1, 3))
    draft: Draft = {"materials": {"m": made}, "strips": [one[0] for one in every]}

    def asked(model: Model, door: Door) -> Floats:
        out = []
        for inner, (_, files, _sizes) in zip(model["strips"], every, strict=True):
            pairs = _ends((5,), moment / _LEVER)
            forces = [f"t{k}.x={one!r} N" for k, one in enumerate(pairs.tolist())]
            forces += [f"u{k}.x={one!r} N" for k, one in enumerate((-pairs).tolist())]
            words = [word for one in forces for word in ("--force", one)]
            found = door.ask({**inner, "materials": model["materials"]}, "statics", *words, **files)
            moved = np.array([found["points"][f"t{k}"] for k in range(6)])
            out.append(np.r_[moved[:, 4] * 1e3, moved[:, 2] * 1e3, moved[:, 0] * 1e3])
        door.told = []
        return np.concatenate(out)

    def right(model: Model, _: Door) -> Floats:
        E, out = model["materials"]["m"]["E"], []
        for _inner, _files, one in every:
            inertia = one["width"] * one["thick"] ** 3 / 12
            bend = moment / (E * inertia)  # turned by -bend s about y, up along z
            first, second, turn = one["one"], one["two"], one["angle"]
            up, out_of_line = bend * first**2 / 2 + bend * first * second * np.cos(turn), bend * second**2 / 2
            z = up + out_of_line * np.cos(turn)
            x = -bend * first * second * np.sin(turn) - out_of_line * np.sin(turn)
            six = np.ones(6)
            out.append(np.r_[-bend * (first + second) * six * 1e3, z * six * 1e3, x * six * 1e3])
        return np.concatenate(out)

    return Case(draft, asked, right, 1e-5, f"{_EXACT}; nodes of a box")


@capability("joints: a rib between nodes of a strip under a moment", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Without lateral contraction, each of both with its share of the moment: they bend alike, and nothing pulls."""
    made = {"E": float(f"{rng.uniform(1e10, 2e11):.4g}"), "nu": 0.0, "rho": 2000.0}
    long, wide, thick = (float(f"{x:.3g}") for x in rng.uniform([0.5, 0.3, 0.004], [0.8, 0.4, 0.008]))
    side = float(f"{rng.uniform(0.01, 0.02):.3g}")
    at = float(f"{wide * rng.uniform(0.4, 0.6):.3g}")
    nodes, cells = pieces(
        (5, 6), np.array([[[0, 0, 0], [0, wide, 0]], [[long, 0, 0], [long, wide, 0]]], float), "quad4"
    )
    tip = nodes[-7:]
    stands = np.vstack([tip, [[long, at, 0.0]]])
    tops = stands + np.array([0.0, 0.0, _LEVER])
    frame: Draft = {"type": "frame", "material": "m", "section": "s"}
    rib = [[0.0, at, 0.0], [long, at, 0.0]]
    draft: Draft = {
        "materials": {"m": made},
        "sections": {"s": {"shape": "rectangle", "width": side, "height": side}},
        "parts": {
            "a": {"type": "shell", "mesh": "a.vtu", "material": "m", "thickness": thick},
            "rib": {**frame, "lines": [rib], "mesh": long / 200.3},
            "levers": {**frame, "lines": [[one.tolist(), top.tolist()] for one, top in zip(tip, tops, strict=False)]},
            "own": {**frame, "lines": [[stands[-1].tolist(), tops[-1].tolist()]]},
        },
        "joints": {
            "along": {"connect": ["rib", "a"]}, "stand": {"connect": ["levers", "a"]},
            "end": {"connect": ["own", "rib"]},
        },
        "supports": {
            "root": {"on": "a", "box": box_of(nodes[:7]), "fix": "clamped"},
            # Else its moment goes into the wall through shear of the strip, over sqrt(E I / G A) of some mm.
            "of rib": {"at": "foot", "fix": ["rx", "ry", "rz"]},
        },
        "damping": {"ratio": 0.01},
    }  # fmt: skip
    draft["points"] = {f"t{k}": {"on": "a", "at": one.tolist()} for k, one in enumerate(tip)}
    draft["points"] |= {"foot": {"on": "rib", "at": rib[0]}}
    draft["points"] |= {"t7": {"on": "rib", "at": stands[-1].tolist()}}
    draft["points"] |= {f"u{k}": {"on": "levers" if k < 7 else "own", "at": one.tolist()} for k, one in enumerate(tops)}
    draft["bend"] = float(rng.uniform(0.01, 0.03))

    def asked(model: Model, door: Door) -> Floats:
        E, bend = model["materials"]["m"]["E"], model["bend"]
        pairs = np.r_[_ends((6,), E * wide * thick**3 / 12 * bend), E * side**4 / 12 * bend] / _LEVER
        forces = [
            f"{name}{k}.x={sign * one!r} N"
            for k, one in enumerate(pairs.tolist())
            for name, sign in (("t", 1), ("u", -1))
        ]
        inner = {key: one for key, one in model.items() if key != "bend"}
        words = [word for one in forces for word in ("--force", one)]
        found = door.ask(inner, "statics", *words, **{"a.vtu": file_of(nodes, cells, "quad4")})
        door.told = []
        moved = np.array([found["points"][f"t{k}"] for k in range(8)])
        return np.r_[moved[:, 2] * 1e3, moved[:, 4] * 1e3, moved[:, 3] * 1e3]

    def right(model: Model, _: Door) -> Floats:
        eight = model["bend"] * np.ones(8) * 1e3
        return np.r_[eight * long**2 / 2, -eight * long, 0 * eight]

    return Case(
        draft,
        asked,
        right,
        1e-6,
        "the curvature is the same everywhere, which elements have exactly; rounding of bars of 1/200",
    )


@capability("joints: tubes of unlike facets under tension and torsion", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Longer by F L / E A and turned by T L / G J along each of them, by what their polygons have."""
    made = {"E": float(f"{rng.uniform(1e10, 2e11):.4g}"), "nu": 0.3, "rho": 2000.0}
    around = [int(one) for one in rng.permutation([40, 56])]
    radius, thick = float(f"{rng.uniform(0.1, 0.2):.3g}"), 0.002
    longs = rng.uniform(0.15, 0.25, 2).round(3).tolist()
    tubes, base = [], 0.0
    for n, long in zip(around, longs, strict=True):
        angle = np.repeat(np.arange(n) * 2 * np.pi / n, 5)
        height = base + np.tile(np.linspace(0, long, 5), n)
        k = np.arange(5 * n).reshape(n, 5)
        next_ = np.roll(k, -1, axis=0)
        cells = np.stack([k[:, :-1], next_[:, :-1], next_[:, 1:], k[:, 1:]], axis=-1).reshape(-1, 4)
        tubes.append((np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height]), cells))
        base += long
    files = {f"{name}.vtu": file_of(*one, "quad4") for name, one in zip("ab", tubes, strict=True)}
    top = tubes[1][0][4::5]
    draft: Draft = {
        "materials": {"m": made},
        "parts": {one: {"type": "shell", "mesh": f"{one}.vtu", "material": "m", "thickness": thick} for one in "ab"},
        "joints": {"j": {"connect": ["a", "b"]}},
        "supports": {"root": {"on": "a", "box": box_of(tubes[0][0][::5]), "fix": ["z", "x", "y"]}},
        "points": {f"t{k}": {"on": "b", "at": at.tolist()} for k, at in enumerate(top)},
        "damping": {"ratio": 0.01},
    }  # fmt: skip
    pull, twist = (float(one) for one in rng.uniform([500, 50], [900, 90]))
    round_ = np.column_stack([-top[:, 1], top[:, 0]]) / radius

    def asked(model: Model, door: Door) -> Floats:
        size, share = len(top), twist / radius / len(top)
        forces = [f"t{k}.z={pull / size!r} N" for k in range(size)]
        forces += [
            f"t{k}.{axis}={share * one[i]!r} N" for k, one in enumerate(round_.tolist()) for i, axis in enumerate("xy")
        ]
        words = [word for one in forces for word in ("--force", one)]
        found = door.ask(model, "statics", *words, **files)
        door.told = []
        moved = np.array([found["points"][f"t{k}"][:3] for k in range(size)])
        return np.array([moved[:, 2].mean(), (moved[:, :2] * round_).sum(axis=1).mean()])

    def right(model: Model, _: Door) -> Floats:
        E = model["materials"]["m"]["E"]
        out = np.zeros(2)
        for n, long in zip(around, longs, strict=True):
            edge, inside = 2 * n * radius * np.sin(np.pi / n), n * radius**2 * np.sin(2 * np.pi / n) / 2
            out += [pull * long / (E * edge * thick), radius * twist * long * edge / (E / 2.6 * 4 * inside**2 * thick)]
        return out

    why = "the foot holds contraction over sqrt(R t); facets are off each other by up to a quarter of the thickness"
    return Case(draft, asked, right, 2e-2, why, each=True)


@capability("joints: strips side by side of unlike cells under a moment", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Without lateral contraction both bend to w = M x^2 / 2 E I, along the line on which they meet."""
    made = {"E": float(f"{rng.uniform(1e10, 2e11):.4g}"), "nu": 0.0, "rho": 2000.0}
    long, thick = (float(f"{x:.3g}") for x in rng.uniform([0.5, 0.004], [0.8, 0.008]))
    sides = np.cumsum([0.0, *rng.uniform(0.1, 0.2, 2).round(3)])
    counts = [(int(rng.integers(5, 8)), 2), (int(rng.integers(8, 11)), 3)]
    draft: Draft = {"materials": {"m": made}, "parts": {}, "points": {}, "supports": {}, "damping": {"ratio": 0.01}}
    draft["sections"] = {"s": {"shape": "rectangle", "width": 0.01, "height": 0.01}}
    draft["joints"] = {"j": {"connect": ["a", "b"]}}
    files, tips = {}, {}
    for name, cells, low, high in zip("ab", counts, sides, sides[1:], strict=False):
        nodes, own = pieces(cells, np.array([[[0, low, 0], [0, high, 0]], [[long, low, 0], [long, high, 0]]]), "quad4")
        files[f"{name}.vtu"] = file_of(nodes, own, "quad4")
        draft["parts"][name] = {"type": "shell", "mesh": f"{name}.vtu", "material": "m", "thickness": thick}
        draft["supports"][f"root {name}"] = {"on": name, "box": box_of(nodes[: cells[1] + 1]), "fix": "clamped"}
        tips[name] = nodes[-cells[1] - 1 :]
        tops = tips[name] + np.array([0.0, 0.0, _LEVER])
        lines = [[one.tolist(), top.tolist()] for one, top in zip(tips[name], tops, strict=True)]
        draft["parts"][f"l{name}"] = {"type": "frame", "material": "m", "section": "s", "lines": lines}
        draft["joints"][f"stand {name}"] = {"connect": [f"l{name}", name]}
        draft["points"] |= {f"t{name}{k}": {"on": name, "at": one.tolist()} for k, one in enumerate(tips[name])}
        draft["points"] |= {f"u{name}{k}": {"on": f"l{name}", "at": one.tolist()} for k, one in enumerate(tops)}
    bend = float(rng.uniform(0.01, 0.03))

    def asked(model: Model, door: Door) -> Floats:
        EI = model["materials"]["m"]["E"] * thick**3 / 12
        words, names = [], []
        for name, cells, wide in zip("ab", counts, np.diff(sides).tolist(), strict=True):
            for k, pair in enumerate((_ends((cells[1],), EI * wide * bend) / _LEVER).tolist()):
                words += ["--force", f"t{name}{k}.x={pair!r} N", "--force", f"u{name}{k}.x={-pair!r} N"]
                names.append(f"t{name}{k}")
        found = door.ask(model, "statics", *words, **files)
        door.told = []
        moved = np.array([found["points"][one] for one in names])
        return np.r_[moved[:, 2] * 1e3, moved[:, 4] * 1e3, moved[:, 3] * 1e3]

    def right(_: Model, __: Door) -> Floats:
        some = np.ones(sum(len(one) for one in tips.values())) * bend * 1e3
        return np.r_[some * long**2 / 2, -some * long, 0 * some]

    return Case(draft, asked, right, 1e-5, _EXACT)
