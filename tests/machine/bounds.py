"""Numbers just within and just beyond their bounds: accepted, then refused at their place or answered with a finding.

Each bound is worked out here from what the documents say of it, often from other numbers that are drawn.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from scipy.optimize import brentq

from tests.machine.framework import Case, Door, Floats, Model, Refused, capability

Draft = dict[str, Any]
_G: Final = 9.80665


@dataclass(frozen=True)
class Bound:
    """limit : of a number with which `make` makes a model. less : whether it is accepted below it, else above. where :
    the place that is told beyond, or the code of a finding after an "=". command, beside : how it is asked."""

    where: str
    limit: float
    make: Callable[[float], Draft]
    less: bool = True
    command: tuple[str, ...] = ("check",)
    beside: Mapping[str, Any] = field(default_factory=dict)

    def values(self, near: float) -> tuple[float, float]:
        """Within, and beyond; of a limit of 0 that much on either side."""
        by = near * (abs(self.limit) or 1e-3) * (1 if self.less else -1)
        return self.limit - by, self.limit + by


def _verdict(door: Door, one: Bound, value: float) -> float:
    """0 accepted, 1 refused at the place or with the finding, -1 anything else."""
    try:
        found = door.ask(one.make(value), *one.command, **one.beside)
    except Refused as told:
        lines = [line for line in str(told).splitlines() if line.strip()]
        at = re.match(r"\S*model\.yaml:\d+:\d+: ([^:]*): ", lines[0])
        place = at[1].replace("[", ".[") if at else ""
        there = f"{place}.".startswith(f"{one.where}.") and len(lines) == 1
        return 1.0 if there else -1.0
    return float(one.where.startswith("=") and one.where[1:] in [each["code"] for each in found["findings"]])


def _case(rng: np.random.Generator, bounds: Sequence[Bound], some: int) -> Case:
    """Some of them by lot, each within and beyond; very near, or not so near."""
    chosen = [bounds[k] for k in rng.permutation(len(bounds))[:some]]
    near = [float(10 ** rng.uniform(-4, -1.5)) for _ in chosen]

    def asked(model: Model, door: Door) -> Floats:
        found = [_verdict(door, one, value) for one, by in zip(chosen, near, strict=True) for value in one.values(by)]
        door.told.clear()
        return np.array(found)

    wheres = {"bounds": [one.where for one in chosen], "near": near}
    return Case(wheres, asked, lambda *_: np.tile([0.0, 1.0], len(chosen)), 1e-12, "yes or no")


def _plate(material: Draft, /, **part: Any) -> Draft:
    """A plate held at its edges."""
    made = {"type": "plate", "material": "m", "thickness": 0.02, "origin": [0, 0, 0], "size": [1.0, 0.8], "mesh": 0.4}
    made = {key: one for key, one in {**made, **part}.items() if one is not None}
    return {
        "materials": {"m": {"E": 3e10, "nu": 0.2, "rho": 2400.0, **material}}, "parts": {"p": made},
        "supports": {"e": {"on": "p", "edge": "all", "fix": "simple"}}, "damping": {"ratio": 0.01},
    }  # fmt: skip


def _slab(material: Draft, /, **part: Any) -> Draft:
    made: Draft = {"type": "slab", "material": "m", "thickness": 0.1, "mesh": 0.5, "origin": [0, 0, 0]}
    made |= {"outline": [[0, 0], [2, 0], [2, 1.6], [0, 1.6]], **part}
    draft = _plate(material)
    return {**draft, "parts": {"p": made}, "supports": {"e": {"on": "p", "set": "rim", "fix": "simple"}}}


def _flat(a: float, b: float, axes: Floats) -> str:
    """The mesh of a rectangle of 2 x 2 cells along two axes."""
    at = [u * axes[0] * a / 2 + v * axes[1] * b / 2 for v in range(3) for u in range(3)]
    nodes = [f"{k + 1}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in enumerate(np.array(at).tolist())]
    first = [1, 2, 4, 5]
    cells = [f"{k + 1}, {n}, {n + 1}, {n + 4}, {n + 3}" for k, n in enumerate(first)]
    return "\n".join(["*NODE", *nodes, "*ELEMENT, TYPE=S4, ELSET=ALL", *cells, ""])


def _shell(material: Draft, /, **part: Any) -> Draft:
    draft = _plate(material)
    made = {"type": "shell", "mesh": "a.inp", "material": "m", "thickness": 0.02, **part}
    return {**draft, "parts": {"p": made}, "supports": {"e": {"on": "p", "fix": ["x", "y", "z"]}}}


# ---- materials and lay-ups


def _ratios(rng: np.random.Generator) -> list[Bound]:
    """Contraction of orthotropic materials: of each pair, then of all together, where their energy vanishes."""
    E = (10 ** rng.uniform(9, 10.5, 3)).tolist()
    G = (10 ** rng.uniform(8, 9.5, 3)).tolist()
    found = []
    for pair in range(3):
        i, j = pair, (pair + 1) % 3
        found.append(("materials.m", float(np.sqrt(E[i] / E[j])), np.eye(3)[pair]))
    way = rng.uniform(0.3, 1, 3) * np.sqrt([E[k] / E[(k + 1) % 3] for k in range(3)]) * rng.choice([-1, 1], 3)

    def least(size: float) -> float:
        xy, yz, zx = size * way / E
        strains = np.diag(1 / np.array(E)) - np.array([[0, xy, zx], [xy, 0, yz], [zx, yz, 0]])
        scale = np.sqrt(E)
        return float(np.linalg.eigvalsh(strains * np.outer(scale, scale))[0])

    found.append(("materials.m", float(brentq(least, 1e-3, 10)), way))
    return [
        Bound(where, limit, lambda x, way=way: _plate({"E": E, "G": G, "nu": (x * way).tolist(), "rho": 450.0}))
        for where, limit, way in found
    ]


def _solids(rng: np.random.Generator) -> list[Bound]:
    """What no material has, and what hardly one has: density, speed of a wave along a bar, losses."""
    rho, E, f = float(10 ** rng.uniform(2.5, 3.8)), float(10 ** rng.uniform(9.5, 11)), float(10 ** rng.uniform(1.5, 3))
    fast, none = "=implausible-material", "=implausible-damping"
    heavy, light, loose = float(rng.uniform(1200, 8000)), float(rng.uniform(200, 1000)), float(rng.uniform(0.1, 0.35))
    times: Callable[[float], Draft] = lambda x: {"loss_factor": {"reverberation_times": {f"{f} Hz": f"{x} s"}}}  # noqa: E731
    return [
        Bound("materials.m.nu", 0.5, lambda x: _plate({"nu": x})),
        Bound("materials.m.nu", -1.0, lambda x: _plate({"nu": x}), less=False),
        Bound("materials.m.rho", 1e5, lambda x: _plate({"rho": x})),
        Bound(fast, 23000.0, lambda x: _plate({"rho": x, "E": x * 2e7})),
        Bound(fast, 1.0, lambda x: _plate({"rho": x, "E": x * 1e4}), less=False),
        Bound(fast, 20e3, lambda x: _plate({"rho": rho, "E": rho * x**2})),
        Bound(fast, 300.0, lambda x: _plate({"rho": heavy, "nu": loose, "E": heavy * x**2}), less=False),
        Bound(fast, 2.0, lambda x: _plate({"rho": light, "E": light * x**2}), less=False),
        Bound(fast, 2.0, lambda x: _plate({"rho": heavy, "nu": 0.45, "E": heavy * x**2}), less=False),
        Bound(fast, 1100.0, lambda x: _plate({"rho": x, "nu": loose, "E": x * 150.0**2})),
        Bound(fast, 0.4, lambda x: _plate({"rho": heavy, "nu": x, "E": heavy * 150.0**2}), less=False),
        Bound("materials.m.loss_factor", 1.5, lambda x: _plate({"loss_factor": x})),
        Bound("materials.m.loss_factor", 2.2 / f / 1.5, lambda x: _plate(times(x)), less=False),
        Bound("materials.m.loss_factor", 0.0, lambda x: _plate({"loss_factor": x}), less=False),
        Bound(none, 0.5, lambda x: _plate({"E": E, "rho": E / 1e7, "loss_factor": x})),
        Bound(none, 1e9, lambda x: _plate({"E": x, "rho": 1000.0, "loss_factor": 0.7})),
    ]


def _lay_ups(rng: np.random.Generator) -> list[Bound]:
    Dx, Dy = (10 ** rng.uniform(5, 7, 2)).tolist()
    Ax, Ay = (10 ** rng.uniform(7, 9, 2)).tolist()

    def smeared(**other: Any) -> Draft:
        return _plate({}, material=None, smeared={"D": [Dx, Dy, 0, 1e5], "S": [1e7, 1e7], "mass": 80.0, **other})

    def boards(bond: float) -> Draft:
        return _plate({}, material=None, thickness=None, layers={"boards": [["m", 0.01], ["m", 0.02]], "bond": bond})

    def layer(x: float) -> Draft:
        return _plate({}, material=None, thickness=None, layers=[["m", 0.02], ["m", x]])

    return [
        Bound("parts.p", float(np.sqrt(Dx * Dy)), lambda x: smeared(D=[Dx, Dy, x, 1e5])),
        Bound("parts.p.smeared", 0.0, lambda x: smeared(D=[Dx, Dy, x, 1e5]), less=False),
        Bound("parts.p", float(np.sqrt(Ax * Ay)), lambda x: smeared(A=[Ax, Ay, x, 1e8])),
        Bound("parts.p.smeared", 0.0, lambda x: smeared(mass=x), less=False),
        Bound("parts.p", 0.0, lambda x: smeared(S=[x, 1e7]), less=False),
        Bound("parts.p", 0.0, lambda x: smeared(D=[Dx, x, 0, 1e5]), less=False),
        Bound("parts.p.layers", 1.0, boards),
        Bound("parts.p.layers", 0.0, boards, less=False),
        Bound("parts.p", 0.0, layer, less=False),
    ]


@capability("language: bounds of materials and lay-ups", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case(rng, [*_ratios(rng), *_solids(rng), *_lay_ups(rng)], 12)


# ---- parts and sections


def _thickness(rng: np.random.Generator) -> list[Bound]:
    """Thicker than wide, a foil, or as soft as a cloth."""
    a, b = np.sort(rng.uniform(0.4, 1.5, 2))[::-1].tolist()
    axes = np.eye(3)[rng.permutation(3)]
    wide = float(rng.uniform(1.1, 2.5))
    rho, nu, h = float(rng.uniform(300, 1000)), float(rng.uniform(0.05, 0.35)), float(b * rng.uniform(0.008, 0.05))
    soft = 5 * rho * h * _G * b**4 / (384 * 0.05 * b) * 12 * (1 - nu**2) / h**3  # sags by 5 % of b
    outline = [[0, 0], [a, 0], [a, b], [0, b]]
    foil, sags = "=implausible-thickness", "=implausible-stiffness"
    thick: Callable[..., Draft] = lambda x, **more: _plate({}, thickness=x, size=[a, b], **more)  # noqa: E731
    cloth: Draft = {"rho": rho, "nu": nu, "E": soft * 0.5}
    inp = {"a.inp": _flat(1.3 * wide, wide, axes)}
    small = {"a.inp": _flat(a, b, axes)}
    return [
        Bound("parts.p.thickness", b, thick),
        Bound("parts.p.thickness", 0.0, thick, less=False),
        Bound("parts.p.thickness", b, lambda x: _slab({}, thickness=x, outline=outline)),
        Bound("parts.p.thickness", 0.0, lambda x: _slab({}, thickness=x), less=False),
        Bound("parts.p.thickness", wide, lambda x: _shell({}, thickness=x), beside=inp),
        Bound("parts.p.thickness", max(b, 1.0), lambda x: _shell({}, thickness=x), beside=small),
        Bound("parts.p.thickness", 0.0, lambda x: _shell({}, thickness=x), less=False, beside=small),
        Bound("parts.p.thickness", 0.0, lambda x: _shell({}, thickness={"ALL": x}), less=False, beside=small),
        Bound("parts.p.nonstructural", 0.0, lambda x: _shell({}, nonstructural=x), less=False, beside=small),
        Bound(foil, 1e-4 * b, thick, less=False),
        Bound(foil, 1e-4 * b, lambda x: _slab({}, thickness=x, outline=outline), less=False),
        Bound(sags, soft, lambda x: _plate({**cloth, "E": x}, thickness=h, size=[a, b]), less=False),
        Bound(sags, b / 200, lambda x: _plate({**cloth, "E": soft / 30}, thickness=x, size=[a, b])),
        Bound(sags, 0.4, lambda x: _plate({**cloth, "nu": x, "E": 0.5 * soft}, thickness=h, size=[a, b]), less=False),
    ]  # fmt: skip


def _frame(section: Draft, length: float = 1.0, **part: Any) -> Draft:
    made = {"type": "frame", "material": "m", "section": "s", "lines": [[[0, 0, 0], [length, 0, 0]]], **part}
    return {
        "materials": {"m": {"E": 2e11, "nu": 0.3, "rho": 7800.0}}, "sections": {"s": section}, "parts": {"f": made},
        "points": {"a": {"on": "f", "at": [0, 0, 0]}}, "supports": {"e": {"at": "a", "fix": "clamped"}},
        "damping": {"ratio": 0.01},
    }  # fmt: skip


def _sections(rng: np.random.Generator) -> list[Bound]:
    b, h = rng.uniform(0.05, 0.2, 2).tolist()
    A = float(10 ** rng.uniform(-4, -2))
    long, odd = float(rng.uniform(0.3, 3)), "=implausible-section"
    plain = {"A": A, "Iy": A**2 / 12, "Iz": A**2 / 12, "J": A**2 / 6}
    square: Callable[[float], Draft] = lambda x: {"shape": "rectangle", "width": x, "height": x}  # noqa: E731
    huge = float(rng.uniform(1.2, 3))
    thin = {"shape": "rectangle", "width": b, "height": 0.01}
    eye = {"shape": "I", "width": b, "height": h, "web": b / 20, "flange": h / 20}
    return [
        Bound("sections.s", b / 2, lambda x: _frame({"shape": "tube", "outer": b, "thickness": x})),
        Bound("sections.s", min(b, h) / 2,
              lambda x: _frame({"shape": "box", "width": b, "height": h, "thickness": x})),
        Bound("sections.s", b, lambda x: _frame({**eye, "web": x})),
        Bound("sections.s", h / 2, lambda x: _frame({**eye, "flange": x})),
        Bound("sections.s.width", 0.0, lambda x: _frame({**square(0.1), "width": x}), less=False),
        Bound("sections.s.Iy", 0.0, lambda x: _frame({**plain, "Iy": x}), less=False),
        Bound(odd, 1e-5 * A**2, lambda x: _frame({**plain, "Iz": x}, 0.01), less=False),
        Bound(odd, 1e2 * A**2, lambda x: _frame({**plain, "Iy": x})),
        Bound(odd, 0.1 / 10, lambda x: _frame(square(0.1), x), less=False),
        Bound(odd, huge / 2, lambda x: _frame(square(huge), x), less=False),
        Bound(odd, 0.01 / 12**0.5 * 3e4, lambda x: _frame(thin, x)),
        Bound("parts.f.mesh", 0.0, lambda x: _frame(square(0.1), long, mesh=x if x <= 0 else long / 3), less=False),
    ]  # fmt: skip


def _places(rng: np.random.Generator) -> list[Bound]:
    """What must lie on a part, or within it."""
    at = [float(rng.uniform(0.3, 0.7)), float(rng.uniform(0.2, 0.6))]
    room = min(at[0], at[1], 1.0 - at[0], 0.8 - at[1])
    half = [float(rng.uniform(0.02, room)), 2 * min(at[1], 0.8 - at[1])]
    mass = float(10 ** rng.uniform(0, 3))
    side = float(rng.uniform(0.2, 0.8))

    def point(**said: Any) -> Draft:
        return {**_plate({}), "points": {"q": {"on": "p", **said}}}

    def hole(x: float) -> Draft:
        return _slab({}, holes=[{"rectangle": [side, x], "at": [1.0, 0.7]}])

    def body(x: float) -> Draft:
        made = {"type": "block", "origin": [0, 0, 0], "size": [1.0, 0.5, x], "mass": mass}
        kept = {"type": "spring", "between": ["q", "ground"], "stiffness": dict.fromkeys(("x", "y", "z"), 1e6)}
        turned = {**kept["stiffness"], **dict.fromkeys(("rx", "ry", "rz"), 1e6)}
        return {"parts": {"b": made, "k": {**kept, "stiffness": turned}},
                "points": {"q": {"on": "b", "at": [0.5, 0.2, 0.0]}}, "damping": {"ratio": 0.01}}  # fmt: skip

    return [
        Bound("points.q.at", 1.0, lambda x: point(at=[x, at[1]])),
        Bound("points.q.at", 0.0, lambda x: point(at=[at[0], x]), less=False),
        Bound("points.q.patch", room, lambda x: point(at=at, patch=x)),
        Bound("points.q.patch", half[1], lambda x: point(at=at, patch=[half[0], x])),
        Bound("parts.p.holes", 1.4, hole),
        Bound("parts.p.through", 1.6, lambda x: _slab({}, through=[[at[0], x]])),
        Bound("parts.p.holes", 0.0, hole, less=False),
        Bound("=implausible-mass", mass / 0.5 / 5.0, body),
        Bound("=implausible-mass", mass / 0.5 / 23000.0, body, less=False),
    ]


@capability("language: bounds of parts and sections", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case(rng, [*_thickness(rng), *_sections(rng), *_places(rng)], 12)


# ---- laws, bodies, loads, rooms


def _blow(law: Draft, **body: Any) -> Draft:
    """A body that strikes an oscillator."""
    made = {"mass": 2.0, "above": "m", "drop_height": 0.1, "contact": law, **body}
    if "speed" in body:
        del made["drop_height"]
    return {"model": "structure.yaml", "bodies": {"a": made}, "time": {"duration": 0.1, "sampling": 1e4}}


_SPRUNG: Final = {"structure": {"type": "oscillator", "mass": 3.0, "frequency": 20.0}, "points": {"m": {}},
                  "damping": {"ratio": 0.02}}  # fmt: skip


def _laws(rng: np.random.Generator) -> list[Bound]:
    k, e = float(10 ** rng.uniform(5, 8)), float(rng.uniform(0.3, 0.9))
    d, f = np.cumsum(rng.uniform(1e-4, 1e-3, 3)).tolist(), np.cumsum(rng.uniform(10, 1e3, 3)).tolist()
    there, lossy = "bodies.a.contact", {"type": "hunt-crossley", "stiffness": k}
    beside = {"structure": _SPRUNG}

    def bound(where: str, limit: float, law: Callable[[float], Draft], less: bool = False, **body: Any) -> Bound:
        return Bound(where, limit, lambda x: _blow(law(x), **body), less, beside=beside)

    def table(x: float, column: int) -> Draft:
        rows = [[0.0, 0.0], *([a, b] for a, b in zip(d, f, strict=True))]
        rows[2][column] = x
        return {"type": "table", "curve": rows}

    found = [
        bound(f"{there}.stiffness", 0.0, lambda x: {"type": "linear", "stiffness": x}),
        bound(f"{there}.damping", 0.0, lambda x: {"type": "linear", "stiffness": k, "damping": x}),
        bound(f"{there}.restitution", 0.0, lambda x: {"type": "linear", "stiffness": k, "restitution": x}),
        bound(f"{there}.duration", 0.0, lambda x: {"type": "linear", "duration": x, "restitution": e}),
        bound(f"{there}.dissipation", 0.0, lambda x: {**lossy, "dissipation": x}),
        bound(f"{there}.exponent", 1.0, lambda x: {**lossy, "exponent": x}),
        bound(f"{there}.exponent", 9.0, lambda x: {**lossy, "exponent": x}, less=True),
        bound(f"{there}.at_speed", 0.0, lambda x: {**lossy, "restitution": e, "at_speed": x}),
        bound(f"{there}.cubic", 0.0, lambda x: {"type": "cubic", "stiffness": k, "cubic": x}),
        bound(f"{there}.stiffness", 0.0, lambda x: {"type": "cubic", "stiffness": x, "cubic": 1e12}),
        bound(f"{there}.curve", d[0], lambda x: table(x, 0)),
        bound(f"{there}.curve", d[2], lambda x: table(x, 0), less=True),
        bound(f"{there}.curve", f[0], lambda x: table(x, 1)),
        bound(f"{there}.curve", f[2], lambda x: table(x, 1), less=True),
    ]
    for word in ("linear", "hunt-crossley", "flores", "lankarani-nikravesh"):
        law = {"type": word, "stiffness": k}
        found.append(bound(f"{there}.restitution", 1.0, lambda x, law=law: {**law, "restitution": x}, less=True))
    linear = {"type": "linear", "stiffness": k}
    for key, limit, less in (("drop_height", 100.0, True), ("speed", 1000.0, True), ("mass", 0.0, False)):
        found.append(Bound(f"bodies.a.{key}", limit, lambda x, key=key: _blow(linear, **{key: x}), less, beside=beside))
    return found


def _rooms(rng: np.random.Generator) -> list[Bound]:
    """A box below a plate: what is in it and what its losses are."""
    size = [float(one) for one in rng.uniform(1.5, 3, 3).round(2)]
    a, b, (x, y, z) = 1.0, 0.8, size
    across = 2 * x * y * z / (x * y + y * z + z * x)  # mean free path, 4 V / S
    plate = {
        **_plate({}),
        "surfaces": {"low": {"on": "p", "side": "below"}},
        "points": {"q": {"on": "p", "at": "center"}},
    }
    blow = {"a": {"mass": 0.1, "above": "q", "drop_height": 0.1, "contact": {"type": "linear", "stiffness": 1e6}}}

    def room(**said: Any) -> Draft:
        own = {"size": size, "at": [a / 2, b / 2], "under": "low", "losses": {"t60": 0.5},
               "receivers": {"mic": [0.3, 0.4, 0.5]}, **said}  # fmt: skip
        time = {"duration": 0.05, "sampling": 8e3}
        return {"model": "structure.yaml", "modes": {"up_to": 900.0}, "rooms": {"r": own}, "bodies": blow, "time": time}

    def bound(where: str, limit: float, make: Callable[[float], Draft], less: bool = True) -> Bound:
        return Bound(f"rooms.r{where}", limit, make, less, beside={"structure": plate})

    def mic(axis: int) -> Callable[[float], Draft]:
        return lambda x: room(receivers={"mic": [x if k == axis else 0.3 for k in range(3)]})

    found = [bound("", size[k], mic(k)) for k in range(3)]
    found += [bound("", 0.0, mic(int(rng.integers(3))), less=False)]
    return [
        *found,
        bound(".losses.t60", 120.0, lambda x: room(losses={"t60": x})),
        bound(".losses.t60", across / 343.0, lambda x: room(losses={"t60": x}), less=False),
        bound(".losses.beta", 1.0, lambda x: room(losses={"beta": x, "at": 100.0})),
        bound(".losses.beta", 0.0, lambda x: room(losses={"beta": x, "at": 100.0}), less=False),
        bound("", size[0] - a / 2, lambda x: room(at=[x, b / 2])),
        bound("", b / 2, lambda x: room(at=[a / 2, x]), less=False),
    ]


@capability("language: bounds of rooms", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case(rng, _rooms(rng), 4)


@capability("language: bounds of laws and bodies", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case(rng, _laws(rng), 10)
