"""Thin plates on edges, springs and foundations, against Kirchhoff's plate by Ritz."""

from __future__ import annotations

import copy
from math import pi
from typing import Any, Final

import numpy as np

from tests.independent.ritz import PX, PY, Panel, Ply, W, iso, section
from tests.machine.framework import Case, Door, Floats, Model, capability

_EDGES: Final = ("x0", "x1", "y0", "y1")
_KNOBS = ("materials.m",)
_COUNT = 4
CLT: Final = {  # standard designs (husfabrik.eu), layers [mm], those across in between
    "CLT100 L3": (30, 40, 30), "CLT120 L3": (40, 40, 40), "CLT160 L5": (40, 20, 40, 20, 40),
    "CLT200 L5": (40, 40, 40, 40, 40),
}  # fmt: skip
_RITZ = "16 cells a side, and polynomials of order 10 at free edges: both below 1e-3 for the first four modes"


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """A number of four digits."""
    return float(f"{rng.uniform(low, high):.4g}")


def material(rng: np.random.Generator, ortho: bool) -> dict[str, Any]:
    """Isotropic, or as timber is."""
    rho = between(rng, 400, 8000)
    if not ortho:
        return {"E": float(f"{10 ** rng.uniform(9.5, 11.3):.4g}"), "nu": between(rng, 0.1, 0.4), "rho": rho}
    E1 = float(f"{10 ** rng.uniform(9.8, 10.3):.4g}")
    G = [float(f"{E1 * rng.uniform(0.04, 0.2):.4g}") for _ in range(3)]
    return {
        "E": [E1, float(f"{E1 * rng.uniform(0.1, 0.6):.4g}")],
        "G": G,
        "nu": between(rng, 0.1, 0.35),
        "rho": rho,
    }


def edges(rng: np.random.Generator, kinds: tuple[str, ...] = ("simple", "clamped", "free")) -> dict[str, str]:
    """What holds every edge: enough of it."""
    while True:
        drawn = {name: str(rng.choice(kinds)) for name in _EDGES}
        words = list(drawn.values())
        if "clamped" in words or words.count("simple") >= 2:
            return drawn


def plate(rng: np.random.Generator, ortho: bool = False) -> dict[str, Any]:
    """A plate of 60 to 150 thicknesses, its edges held at random."""
    a, b = between(rng, 1.0, 2.0), between(rng, 1.0, 2.0)
    part: dict[str, Any] = {"type": "plate", "origin": [0, 0, 0], "size": [a, b], "mesh": [16, 16], "in_plane": "rigid"}
    h = float(f"{a / rng.uniform(60, 150):.4g}")
    if ortho:
        part["layers"] = [["m", h, float(f"{rng.uniform(-90, 90):.3g}")]]
        part["layers"][0][2] = f"{part['layers'][0][2]} deg"
    else:
        part |= {"material": "m", "thickness": h}
    return {
        "materials": {"m": material(rng, ortho)},
        "parts": {"p": part},
        "points": {"q": {"on": "p", "at": [between(rng, 0.2 * a, 0.45 * a), between(rng, 0.2 * b, 0.8 * b)]}},
        "supports": {name: {"on": "p", "edge": name, "fix": how} for name, how in edges(rng).items() if how != "free"},
        "damping": {"ratio": 0.01},
    }


def ply(made: Model, thickness: float, angle: float = 0.0) -> Ply:
    """A layer of a material of the model; angle in degrees."""
    if not isinstance(made["E"], list):
        return iso(made["E"], made["nu"], thickness, made["rho"], made.get("loss_factor", 0.0))
    (E1, E2), (G12, G23, G31) = made["E"], made["G"]
    loss = made.get("loss_factor", 0.0)
    return Ply(E1, E2, made["nu"], G12, G23, G31, thickness, angle * pi / 180, made["rho"], loss)


def plies(model: Model, part: str = "p") -> list[Ply]:
    """The layers of a part, from the lower face up."""
    made, of = model["materials"], model["parts"][part]
    if "layers" not in of:
        return [ply(made[of["material"]], of["thickness"])]
    if "like" in of["layers"]:
        of_clt = enumerate(CLT[of["layers"]["like"]])
        return [ply(made[of["layers"]["of"]], each / 1e3, 90.0 * (number % 2)) for number, each in of_clt]
    laid = of["layers"]["boards"] if "boards" in of["layers"] else of["layers"]
    rows = [(one[0], one[1], float(str(one[2]).split()[0]) if len(one) > 2 else 0.0) for one in laid]
    return [ply(made[name], thickness, angle) for name, thickness, angle in rows]


def by_ritz(model: Model, thin: bool = True, order: int = 10) -> Panel:
    """The plate of a model with its edges, masses, springs and foundations."""
    a, b = model["parts"]["p"]["size"]
    panel = Panel(a, b, thin=thin, order=order).add(section(plies(model)))
    for one in model["supports"].values():
        if isinstance(one.get("fix"), str):
            panel.hold(one["edge"], one["fix"])
        elif "fix" not in one:
            x, y, w = panel.edge(one["edge"])
            for what, key in ((W, "z"), (PX if one["edge"][0] == "x" else PY, "about edge")):
                f = panel.rows(x, y, what)
                panel.K += one["stiffness"].get(key, 0.0) * (f.T * w) @ f
    for one in model["parts"].values():
        if one["type"] == "mass":
            f = panel.at(*model["points"][one["at"]]["at"])
            panel.M += one["mass"] * np.outer(f, f)
        elif one["type"] == "spring":
            f = panel.at(*model["points"][one["between"][0]]["at"])
            panel.K += one["stiffness"]["z"] * np.outer(f, f)
        elif one["type"] == "foundation":
            box = None
            if one["region"] != "whole":
                (sx, sy), (x, y) = one["region"]["rectangle"], one["region"]["at"]
                box = (x - sx / 2, x + sx / 2, y - sy / 2, y + sy / 2)
            panel.K += panel.spread(one["stiffness"]["normal"], 0.0, 0.0, box)
    return panel


def aside(door: Door, *codes: str) -> None:
    """Findings on accuracy that the check itself measures do not count."""
    usual = ("coarse-mesh", "modal-mass-low", "stress-uneven", "thick-plate", "sags-far", *codes)
    door.told[:] = [one for one in door.told if not one.startswith(usual)]


def frequencies(model: Model, door: Door) -> Floats:
    """The first natural frequencies that the program finds."""
    found = door.modes(model, _COUNT)
    aside(door)
    return found[found > 1e-3]


def modes_case(model: Model, tolerance: float = 2e-3, why: str = _RITZ, order: int = 10) -> Case:
    """Natural frequencies beside those of Ritz."""

    def right(model: Model, _: Door) -> Floats:
        return by_ritz(model, order=order).modes(_COUNT)[0]

    return Case(model, frequencies, right, tolerance, why, _KNOBS, each=True)


@capability("plates: natural frequencies", "independent")
def _(rng: np.random.Generator) -> Case:
    return modes_case(plate(rng))


@capability("plates: orthotropic and turned", "independent")
def _(rng: np.random.Generator) -> Case:
    return modes_case(plate(rng, ortho=True), 3e-3)


@capability("plates: layers", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = plate(rng)
    model["materials"]["n"] = material(rng, True)
    part = model["parts"]["p"]
    h, core, turn = part.pop("thickness") / 4, part.pop("material"), f"{between(rng, 0, 90)} deg"
    part["layers"] = [["n", h, turn], [core, 2 * h], ["n", h, turn]]
    return modes_case(model, 3e-3)


@capability("plates: masses and springs at points", "independent")
def _(rng: np.random.Generator) -> Case:
    model = plate(rng)
    a, b = model["parts"]["p"]["size"]
    weight = sum(one.rho * one.thickness for one in plies(model)) * a * b
    model["points"]["r"] = {"on": "p", "at": [between(rng, 0.6 * a, 0.8 * a), between(rng, 0.2 * b, 0.8 * b)]}
    model["parts"]["lump"] = {"type": "mass", "at": "q", "mass": float(f"{weight * rng.uniform(0.05, 0.5):.4g}")}
    first = by_ritz(model).modes(1)[0][0]
    k = float(f"{weight * (2 * pi * first) ** 2 * rng.uniform(0.1, 1.0):.4g}")
    model["parts"]["prop"] = {"type": "spring", "between": ["r", "ground"], "stiffness": {"z": k}}
    return modes_case(model, 1e-2, "polynomials of order 20 where the force of a point acts; 16 cells a side", 20)


@capability("plates: foundation", "independent")
def _(rng: np.random.Generator) -> Case:
    model = plate(rng)
    a, b = model["parts"]["p"]["size"]
    mass = sum(one.rho * one.thickness for one in plies(model))
    first = by_ritz(model).modes(1)[0][0]
    k = float(f"{mass * (2 * pi * first) ** 2 * rng.uniform(0.3, 4.0):.4g}")
    region: Any = "whole"
    if rng.random() < 0.6:
        sx, sy = between(rng, 0.3 * a, 0.6 * a), between(rng, 0.3 * b, 0.6 * b)
        region = {"rectangle": [sx, sy], "at": [between(rng, sx / 2, a - sx / 2), between(rng, sy / 2, b - sy / 2)]}
    model["parts"]["mat"] = {"type": "foundation", "on": "p", "region": region, "stiffness": {"normal": k}}
    return modes_case(model, 3e-3)


@capability("plates: elastic edges", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = plate(rng)
    a, _ = model["parts"]["p"]["size"]
    D = section(plies(model)).D[0, 0]
    model["supports"] = {
        name: {
            "on": "p",
            "edge": name,
            "stiffness": {
                "z": float(f"{D / a**3 * 10 ** rng.uniform(1, 3):.4g}"),
                "about edge": float(f"{D / a * 10 ** rng.uniform(-1, 1):.4g}"),
            },
        }
        for name in _EDGES
    } | {"in plane": {"on": "p", "edge": "x0", "fix": ["x", "y"]}}
    return modes_case(model, 3e-3)


def _deflection(model: Model, load: Any, forces: tuple[str, ...], weight: bool) -> Case:
    def right(model: Model, _: Door) -> Floats:
        panel = by_ritz(model, order=20)
        x, y = model["points"]["q"]["at"]
        coefficients = panel.rest(load(panel, model))
        return np.array([panel.at(x, y) @ coefficients])

    def asked(model: Model, door: Door) -> Floats:
        found = np.array(door.statics(model, *forces, weight=weight)["points"]["q"])[2:3]
        aside(door)
        return found

    return Case(model, asked, right, 1e-2, "polynomials of order 20 where a force acts; 16 cells a side", _KNOBS)


@capability("plates: sag under weight", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    def load(panel: Panel, model: Model) -> Floats:
        return panel.weight(sum(one.rho * one.thickness for one in plies(model)))

    return _deflection(plate(rng, ortho=bool(rng.random() < 0.5)), load, (), True)


@capability("plates: deflection away from a force", "independent")
def _(rng: np.random.Generator) -> Case:
    model = plate(rng)
    a, b = model["parts"]["p"]["size"]
    model["points"]["r"] = {"on": "p", "at": [between(rng, 0.6 * a, 0.8 * a), between(rng, 0.2 * b, 0.8 * b)]}

    def load(panel: Panel, model: Model) -> Floats:
        return -100.0 * panel.at(*model["points"]["r"]["at"])

    return _deflection(model, load, ("r.z=-100 N",), False)


@capability("plates: turned and moved in space", "relation")
def _(rng: np.random.Generator) -> Case:
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]

    def right(model: Model, door: Door) -> Floats:
        other: Any = copy.deepcopy(model)
        other["parts"]["p"] |= {"origin": [1.0, -2.0, 0.5], "normal": q[:, 2].tolist(), "x_direction": q[:, 0].tolist()}
        other["points"] = {}
        return frequencies(other, door)

    return Case(
        plate(rng, bool(rng.random() < 0.5)), frequencies, right, 1e-6, "tolerance of the eigensolution", _KNOBS
    )


@capability("plates: units as text", "relation")
def _(rng: np.random.Generator) -> Case:
    def right(model: Model, door: Door) -> Floats:
        other: Any = copy.deepcopy(model)
        m, p = other["materials"]["m"], other["parts"]["p"]
        m |= {"E": f"{m['E'] / 1e9!r} GPa", "rho": f"{m['rho'] / 1e3!r} t/m^3"}
        p |= {"thickness": f"{p['thickness'] * 1e3!r} mm", "size": [f"{one * 1e2!r} cm" for one in p["size"]]}
        return frequencies(other, door)

    return Case(plate(rng), frequencies, right, 1e-8, "rounding of products", _KNOBS)


@capability("plates: stiff edges are supports", "limit")
def _(rng: np.random.Generator) -> Case:
    model = plate(rng)

    def right(model: Model, door: Door) -> Floats:
        other: Any = copy.deepcopy(model)
        a = other["parts"]["p"]["size"][0]
        D = section(plies(other)).D[0, 0]
        for one in other["supports"].values():
            stiff = {"z": 1e8 * D / a**3, "about edge": 1e7 * D / a if one.pop("fix") == "clamped" else 0.0}
            one["stiffness"] = {key: value for key, value in stiff.items() if value}
        other["supports"]["in plane"] = {"on": "p", "edge": "x0", "fix": ["x", "y"]}
        return frequencies(other, door)

    return Case(model, frequencies, right, 1e-4, "springs 1e6 times as stiff as the plate", _KNOBS)


@capability("plates: E and density doubled", "relation")
def _(rng: np.random.Generator) -> Case:
    def right(model: Model, door: Door) -> Floats:
        other: Any = copy.deepcopy(model)
        for key in ("E", "rho"):
            other["materials"]["m"][key] *= 2
        return frequencies(other, door)

    return Case(plate(rng), frequencies, right, 1e-8, "the same ratio; tolerance of the eigensolution", _KNOBS)
