"""Shells of layers under constant moments, whose strains and curvatures are the same everywhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from tests.independent.mesh_files import Group, Meshed
from tests.machine.formats import vtu
from tests.machine.framework import Case, Door, Floats, Model, capability

Draft = dict[str, Any]
_LEVER: Final = 0.05  # m
_EXACT: Final = "elements have constant strains and curvatures exactly; rounding of the solution"


def _plies(model: Model) -> list[tuple[Floats, float]]:
    """Plane stiffness along the x of the lay-up, and thickness, of each layer."""
    found = []
    for name, thick, angle in model["layers"]:
        one = model["materials"][name]
        (Ex, Ey), (Gxy, _) = (
            (one["E"], one["G"]) if "G" in one else ((one["E"],) * 2, (one["E"] / 2 / (1 + one["nu"]),) * 2)
        )
        nu = one["nu"]
        soft = np.array([[1 / Ex, -nu / Ex, 0], [-nu / Ex, 1 / Ey, 0], [0, 0, 1 / Gxy]])
        c, s = np.cos(np.radians(float(angle.split()[0]))), np.sin(np.radians(float(angle.split()[0])))
        to = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])
        found.append((to.T @ np.linalg.inv(soft) @ to, thick))
    return found


def _bent(model: Model, moments: Sequence[float]) -> Floats:
    """Strains and curvatures [6] of the middle of the thickness under moments per length, without membrane forces."""
    plies = _plies(model)
    z = np.cumsum([0.0, *(thick for _, thick in plies)])
    z -= z[-1] / 2
    A, B, D = (sum(Q * (z[k + 1] ** n - z[k] ** n) / n for k, (Q, _) in enumerate(plies)) for n in (1, 2, 3))
    return np.linalg.solve(np.block([[A, B], [B, D]]), np.r_[0, 0, 0, moments])


def _sheet(rng: np.random.Generator, three: bool, turn: Floats, sides: Floats) -> tuple[Meshed, Floats]:
    """A flat mesh whose inner nodes are moved, turned in space; and its nodes in its own plane."""
    n, m = 4, 3
    x, y = np.meshgrid(np.linspace(0, sides[0], n + 1), np.linspace(0, sides[1], m + 1), indexing="ij")
    flat = np.column_stack([x.ravel(), y.ravel()])
    inner = ((flat > 1e-9) & (flat < sides - 1e-9)).all(axis=1)
    flat[inner] += rng.uniform(-0.15, 0.15, (int(inner.sum()), 2)) * sides / [n, m]
    k = np.arange(len(flat)).reshape(n + 1, m + 1)
    cells = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    if three:
        cells = np.vstack([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    nodes = np.column_stack([flat, np.zeros(len(flat))]) @ turn.T
    kind = "tri3" if three else "quad4"
    return Meshed(nodes, (Group("all", kind, cells, "foot", ()),), np.arange(len(flat)) + 1), flat


def _edges(flat: Floats, sides: Floats, moments: Sequence[float]) -> list[tuple[int, int, float]]:
    """Node, axis in the plane, and moment of it: Mx on both sides across x, My on those across y."""
    found = []
    for axis in (0, 1):
        other = 1 - axis
        for end, sign in ((0.0, -1), (sides[axis], 1)):
            own = np.flatnonzero(np.abs(flat[:, axis] - end) < 1e-9)
            own = own[np.argsort(flat[own, other])]
            shares = np.r_[0.5, np.ones(len(own) - 2), 0.5] / (len(own) - 1)
            size = sign * moments[axis] * sides[other]
            found += [(int(node), axis, float(size * share)) for node, share in zip(own, shares, strict=True)]
    return found


def _loaded(model: Model, mesh: Meshed, flat: Floats, turn: Floats, sides: Floats) -> tuple[Draft, list[str]]:
    """The model on levers along its normal, held at one node, and the pairs of forces on them."""
    normal = turn[:, 2]
    edges = _edges(flat, sides, model["moments"])
    nodes = sorted({node for node, _, _ in edges})
    tops = mesh.points + _LEVER * normal
    shell = {"type": "shell", "mesh": "m.vtu", "layers": model["layers"], "orientation": turn[:, 0].tolist()}
    levers = {
        "type": "frame", "material": "stiff", "section": "s",
        "lines": [[mesh.points[k].tolist(), tops[k].tolist()] for k in nodes],
    }  # fmt: skip
    points = {f"t{k}": {"on": "p", "at": mesh.points[k].tolist()} for k in range(len(flat))}
    points |= {f"u{k}": {"on": "levers", "at": tops[k].tolist()} for k in nodes}
    forces = []
    for node, axis, size in edges:
        pull = size / _LEVER * turn[:, axis]
        for one, x in zip("xyz", pull.tolist(), strict=True):
            forces += [f"u{node}.{one}={x!r} N", f"t{node}.{one}={-x!r} N"]
    inner: Draft = {
        "materials": model["materials"], "sections": {"s": {"shape": "rectangle", "width": 0.01, "height": 0.01}},
        "parts": {"p": shell, "levers": levers}, "points": points, "joints": {"j": {"connect": ["p", "levers"]}},
        "supports": {"one": {"at": "t0", "fix": "clamped"}}, "damping": {"ratio": 0.01},
    }  # fmt: skip
    return inner, forces


@capability("elements: shells of layers under moments", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Triangles and quadrilaterals in any plane: u, v, and w = -(kx x^2 + ky y^2 + kxy x y) / 2 of A, B, D."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    sides = rng.uniform([0.5, 0.4], [0.8, 0.6])
    wood = {
        "E": [float(f"{rng.uniform(8, 12) * 1e9:.4g}"), float(f"{rng.uniform(0.4, 2) * 1e9:.4g}")],
        "G": [float(f"{rng.uniform(0.5, 0.9) * 1e9:.4g}"), 1e8], "nu": 0.3, "rho": 450.0,
    }  # fmt: skip
    plain = {"E": float(f"{rng.uniform(5, 60) * 1e9:.4g}"), "nu": 0.25, "rho": 2000.0}
    names = ["wood", "plain", "wood"]
    drawn = zip(names, rng.uniform(2e-3, 6e-3, 3), rng.uniform(-80, 80, 3), strict=True)
    layers = [[name, float(f"{thick:.4g}"), f"{angle:.4g} deg"] for name, thick, angle in drawn]
    draft: Draft = {
        "materials": {"wood": wood, "plain": plain, "stiff": {"E": 2e11, "nu": 0.3, "rho": 7800.0}},
        "layers": layers, "moments": rng.uniform(5, 10, 2).tolist(),
    }  # fmt: skip
    meshes = [_sheet(rng, three, turn, sides) for three in (False, True)]

    def asked(model: Model, door: Door) -> Floats:
        out = []
        for mesh, flat in meshes:
            inner, forces = _loaded(model, mesh, flat, turn, sides)
            words = [word for one in forces for word in ("--force", one)]
            found = door.ask(inner, "statics", *words, **{"m.vtu": vtu(mesh)})
            moved = np.array([found["points"][f"t{k}"][:3] for k in range(len(flat))]) @ turn
            size = np.abs(moved).max(axis=0)
            out.append(np.r_[(moved / size).ravel(), np.log(size)])
        door.told = []
        return np.concatenate(out)

    def right(model: Model, _: Door) -> Floats:
        ex, ey, g, kx, ky, kxy = _bent(model, [*model["moments"], 0.0])
        out = []
        for _mesh, flat in meshes:
            x, y = flat.T
            moved = np.column_stack(
                [ex * x + g / 2 * y, ey * y + g / 2 * x, -(kx * x**2 + ky * y**2 + kxy * x * y) / 2]
            )
            size = np.abs(moved).max(axis=0)
            out.append(np.r_[(moved / size).ravel(), np.log(size)])
        return np.concatenate(out)

    return Case(draft, asked, right, 1e-6, _EXACT)
