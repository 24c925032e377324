"""Matrices of other programs: OUTPUT4 of Nastran in all its forms, HDF5, numpy and Matrix Market, at rest."""

from __future__ import annotations

import io
import struct
from itertools import groupby
from typing import Any, Final

import h5py
import numpy as np
from scipy.io import mmwrite
from scipy.sparse import coo_array, csc_array, csr_array

from tests.machine.framework import Case, Door, Floats, Model, capability

Draft = dict[str, Any]
G: Final = 9.80665
_DOFS: Final = [(0, one) for one in range(6)] + [(1, one) for one in (2, 0, 1)] + [(2, one) for one in range(3)]
_SIX: Final = ("x", "y", "z", "rx", "ry", "rz")


def _stretches(column: Floats) -> list[tuple[int, list[float]]]:
    """First row, from 1, and values of what is not zero in a row."""
    rows = np.flatnonzero(column).tolist()
    runs = [[row for _, row in some] for _, some in groupby(enumerate(rows), lambda one: one[1] - one[0])]
    return [(run[0] + 1, column[run].tolist()) for run in runs]


def binary(matrices: dict[str, Floats], order: str, form: str, single: bool = False, wide: bool = False) -> bytes:
    """form : dense, packed (heads of stretches in one number) or two (in two). wide : whole numbers of eight bytes."""
    word, size = ("q", 8) if wide else ("i", 4)
    real, each = ("f", 1) if single and not wide else ("d", 1 if wide else 2)

    def record(content: bytes) -> bytes:
        mark = struct.pack(f"{order}i", len(content))
        return mark + content + mark

    data = b""
    for name, matrix in matrices.items():
        n, kind = len(matrix), 1 if single and not wide else 2
        rows = -n if form == "two" else n
        data += record(struct.pack(f"{order}4{word}", n, rows, 6, kind) + name.ljust(2 * size).encode())
        for k, column in enumerate(matrix.T, 1):
            runs = _stretches(column)
            if form == "dense":
                first, last = runs[0][0], runs[-1][0] + len(runs[-1][1]) - 1
                values = column[first - 1 : last]
                head = struct.pack(f"{order}3{word}", k, first, each * len(values))
                data += record(head + struct.pack(f"{order}{len(values)}{real}", *values))
                continue
            body = b""
            for row, some in runs:
                words = each * len(some) + 1
                heads = (words, row) if form == "two" else (row + 65536 * words,)
                body += struct.pack(f"{order}{len(heads)}{word}", *heads)
                body += struct.pack(f"{order}{len(some)}{real}", *some)
            data += record(struct.pack(f"{order}3{word}", k, 0, len(body) // size) + body)
        data += record(struct.pack(f"{order}3{word}", n + 1, 1, each) + struct.pack(f"{order}{real}", 1.0))
    return data


def text(matrices: dict[str, Floats], form: str, wide: bool = False, bare: bool = False) -> str:
    """As `binary`; wide : whole numbers of 16 characters. bare : exponents without a letter."""
    size, lines = 16 if wide else 8, []

    def numbers(values: list[float]) -> list[str]:
        words = [f"{one:24.16E}" for one in values]
        words = [one.replace("E", "D") for one in words] if bare else words
        return ["".join(words[k : k + 3]) for k in range(0, len(words), 3)]

    def whole(*some: int) -> str:
        return "".join(f"{one:{size}d}" for one in some)

    for name, matrix in matrices.items():
        n = len(matrix)
        end = "|I16" if wide else ""
        lines.append(f"{whole(n, -n if form == 'two' else n)}{6:8d}{2:8d}{name:8}1P,3E24.16{end}")
        for k, column in enumerate(matrix.T, 1):
            runs = _stretches(column)
            if form == "dense":
                first, last = runs[0][0], runs[-1][0] + len(runs[-1][1]) - 1
                lines += [whole(k, first, last - first + 1), *numbers(column[first - 1 : last].tolist())]
                continue
            heads = 2 if form == "two" else 1
            lines.append(whole(k, 0, sum(2 * len(some) + heads for _, some in runs)))
            for row, some in runs:
                words = 2 * len(some) + 1
                lines.append(whole(words, row) if form == "two" else f"{row + 65536 * words:{2 * size}d}")
                lines += numbers(some)
        lines += [whole(n + 1, 1, 1), *numbers([1.0])]
    return "\n".join([*lines, ""])


def _hdf5(M: Floats, K: Floats, points: Floats) -> bytes:
    """M sparse by rows, K by columns."""
    out = io.BytesIO()
    with h5py.File(out, "w") as file:
        for name, matrix, form in (("M", csr_array(M), "csr"), ("K", csc_array(K), "csc")):
            group = file.create_group(name)
            group.attrs["format"] = form
            group.attrs["shape"] = matrix.shape
            for part in ("data", "indices", "indptr"):
                group[part] = getattr(matrix, part)
        file["nodes"], file["components"] = (np.array(some) for some in zip(*_DOFS, strict=True))
        file["points"] = points
    return out.getvalue()


def _npz(M: Floats, K: Floats, points: Floats) -> bytes:
    out = io.BytesIO()
    nodes, components = (np.array(some) for some in zip(*_DOFS, strict=True))
    np.savez(out, M=M, K=K, nodes=nodes, components=components, points=points)
    return out.getvalue()


def _market(matrix: Floats) -> bytes:
    out = io.BytesIO()
    mmwrite(out, coo_array(matrix))
    return out.getvalue()


def _table(points: Floats, words: bool) -> str:
    """Columns in another order, directions by number or word, blank lines."""
    rows = ["direction, node, z, y, x" if words else "node,x,y,z,direction"]
    for node, component in _DOFS:
        x, y, z = points[node].tolist()
        direction = _SIX[component] if words else str(component + 1)
        rows.append(
            f"{direction}, N{node}, {z!r}, {y!r}, {x!r}" if words else f"{node + 7},{x!r},{y!r},{z!r},{direction}"
        )
    return "\n".join([*rows[:4], "", *rows[4:], ""])


@capability("exchange: matrices of other programs", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Shifts under weight and a force, of matrices in metres and in millimetres."""
    n = len(_DOFS)

    def band(size: float, rest: float) -> Floats:
        """Positive, with zeros between: stretches of several lengths."""
        made = rng.normal(size=(n, n)) * (rng.random((n, n)) < 0.3)
        return np.asarray(size * (made @ made.T + rest * np.eye(n)))

    M, K = band(2.0, 3.0), band(3e5, 1.0)
    points = rng.uniform(-1, 1, (3, 3)).round(4)
    single = [np.float32(one).astype(float) for one in (M, K)]
    usual, other = {"MGG": M, "KGG": K}, {"HEAVY": M, "HELD": K}
    own = {"M": single[0], "K": single[1]}
    words, numbers = {"nodes": "t.csv"}, {"nodes": "u.csv"}
    names = {"names": {"M": "heavy", "K": "HELD"}}
    files: dict[str, tuple[Draft, str | bytes]] = {
        "a.op4": (words, binary(usual, "<", "dense")),
        "b.op4": (numbers, binary(usual, ">", "packed")),
        "c.op4": (words, binary(usual, "<", "two")),
        "d.op4": (words, binary(own, "<", "dense", single=True)),
        "e.op4": (words | names, binary(other, "<", "packed", wide=True)),
        "f.op4": (words, text(usual, "dense")),
        "g.op4": (numbers, text(usual, "packed", bare=True)),
        "h.op4": (words, text({"KAA": K, "MAA": M}, "two", wide=True)),
        "i.op4": (words, binary({"KXX": single[1], "MXX": single[0]}, ">", "two", single=True)),
        "j.h5": ({}, _hdf5(M, K, points)),
        "k.npz": ({}, _npz(M, K, points)),
        "l.npz": ({"scale": "mm"}, _npz(M, K, points * 1e3)),
    }
    beside: dict[str, str | bytes] = {"t.csv": _table(points, True), "u.csv": _table(points, False)}
    beside |= {"M.mtx": _market(M), "K.mtx": _market(K)}
    force = rng.uniform(20, 90, 3)
    draft: Draft = {
        "points": {f"n{k}": {"on": "w", "at": at.tolist()} for k, at in enumerate(points)},
        "damping": {"ratio": 0.01},
    }

    def asked(model: Model, door: Door) -> Floats:
        parts = {name: {"file": name, **more} for name, (more, _) in files.items()}
        parts["mtx"] = {"file": {"M": "M.mtx", "K": "K.mtx"}, **words}
        out = []
        loads = [word for k, one in enumerate(force.tolist()) for word in ("--force", f"n{k}.y={one!r} N")]
        for name, part in parts.items():
            inner = {**model, "parts": {"w": {"type": "matrices", **part}}}
            mine = {name: files[name][1]} if name in files else {}
            found = door.ask(inner, "statics", "--weight", *loads, **beside, **mine)["points"]
            out.append([found[f"n{node}"][component] for node, component in _DOFS])
        door.told = []
        return np.array(out)

    def right(_: Model, __: Door) -> Floats:
        def rest(M: Floats, K: Floats, weight: float) -> Floats:
            falls = np.array([float(component == 2) for _, component in _DOFS])
            push = np.array([force[node] if component == 1 else 0.0 for node, component in _DOFS])
            return np.linalg.solve(K, push - weight * (M @ falls))

        plain, less = rest(M, K, G), rest(*single, G)
        small = rest(M, K, 1e3 * G) * [1e-3 if component < 3 else 1.0 for _, component in _DOFS]
        some = {"d.op4": less, "i.op4": less, "l.npz": small}
        return np.array([*(some.get(name, plain) for name in files), plain])

    return Case(draft, asked, right, 1e-8, "the same matrices; rounding", each=True)
