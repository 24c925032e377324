"""Stiff slabs and shells that move as bodies, on soft springs, hangers and what a mesh file states: any answer."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any, Final

import numpy as np

from tests.independent.frames import Floats, Skeleton
from tests.independent.linear import Linear
from tests.machine.any_frame import linear
from tests.machine.columns import ANSWERS, Subject, case_of
from tests.machine.framework import Case, Model, capability
from tests.machine.plates import between
from tests.machine.skeletons import six

Draft = dict[str, Any]
Spots = tuple[Floats, Floats]
"""Places [n, 2] in a slab's coordinates, and the share of each [n]."""
_WHY: Final = "first own modes of the slabs are 1e3 times those on springs: 1e-6 of compliance, more beside a spring"
_ASIDE: Final = (
    "implausible",
    "coarse-mesh",
    "modal-mass-low",
    "stress-uneven",
    "thick-plate",
    "thick-for-short-waves",
    "sags-far",
    "few-elastic",
    "one-mass-dominates",
    "parts-not-joined",
    "hangers-overloaded",
)
_POUND, _INCH = 4.4482216, 0.0254  # N, m
_HANGERS: Final = {  # Acoustic Isolation Hangers ARH-1 with a gum rubber element: largest load, its static deflection
    "hanger ARH-1-20": (65.0, 5 / 16),
    "hanger ARH-1-40": (120.0, 1 / 4),
    "hanger ARH-1-70": (200.0, 3 / 16),
}


class Stiff:
    """Slabs and plates as bodies, what hangs on them, and the places of points."""

    def __init__(self, model: Model) -> None:
        self.bones, self.model, self.bodies = Skeleton(), model, {}
        for name, part in model["parts"].items():
            if part["type"] in ("slab", "plate"):
                self.bodies[name] = self._sheet(part)
        self.points = {name: self.spot(one["on"], [*one["at"], 0.0]) for name, one in model["points"].items()}
        for part in model["parts"].values():
            if part["type"] in _HANGS:
                _HANGS[part["type"]](self, part)
        for one in model.get("supports", {}).values():
            if one["fix"] == "clamped":
                self.bones.hold(self.bodies[one["on"]])

    def _sheet(self, part: Model) -> int:
        (a, b), h = _sides(part), part["thickness"]
        mass = self.model["materials"][part["material"]]["rho"] * a * b * h
        at = self.bones.place(_origin(part) + [a / 2, b / 2, 0.0] @ turn(part))
        spin = np.array([b * b + h * h, a * a + h * h, a * a + b * b]) / 12
        self.bones.body(at, mass, turn(part).T @ np.diag(mass * spin) @ turn(part))
        return at

    def spot(self, name: str, local: Any) -> int:
        """A place that moves with a sheet; heights are from its middle."""
        part = self.model["parts"][name]
        at = self.bones.place(_origin(part) + np.asarray(local, float) @ turn(part))
        self.bones.follow(self.bodies[name], at)
        return at

    def linear(self) -> Linear:
        return linear(self.bones, self.points)


def turn(part: Model) -> Floats:
    """Rows: its axes."""
    n = np.asarray(part.get("normal", [0.0, 0.0, 1.0]), float)
    n = n / np.linalg.norm(n)
    x = np.asarray(part.get("x_direction", [1.0, 0.0, 0.0]), float)
    x = x - (x @ n) * n
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(n, x), n])


def _origin(part: Model) -> Floats:
    return np.asarray(part.get("origin", [0.0, 0.0, 0.0]), float)


def _sides(part: Model) -> Floats:
    return np.array(part["size"] if part["type"] == "plate" else part["outline"][2], float)


def _form(model: Model) -> Linear:
    return Stiff(model).linear()


def _spring(made: Stiff, part: Mapping[str, Any]) -> None:
    point = made.points[part["between"][0]]
    made.bones.spring(point, None, six(part.get("stiffness")), six(part.get("damping")))


def _number(said: Any) -> float:
    return float(str(said).split()[0])


def _over(length: float, step: float) -> Floats:
    """Centred, as many as fit nearest."""
    count = max(1, int(length / step + 0.5))
    return np.asarray((length - (count - 1) * step) / 2 + step * np.arange(count))


def _run(start: Floats, end: Floats) -> Spots:
    """Of a line, exact for products of two linear motions: Gauss's two places."""
    shares = np.array([[0.5 - 0.5 / np.sqrt(3)], [0.5 + 0.5 / np.sqrt(3)]])
    return start + shares * (end - start), np.full(2, float(np.linalg.norm(end - start)) / 2)


def _pattern(part: Mapping[str, Any], sides: Floats) -> Spots:
    """Where hangers are."""
    if "at" in part:
        return np.array(part["at"], float), np.ones(len(part["at"]))
    if "along" in part:
        k = "xy".index(part["along"])
        runs = []
        for off in _over(sides[1 - k], part["spacing"]):
            ends = np.zeros((2, 2))
            ends[:, 1 - k], ends[1, k] = off, sides[k]
            runs.append(_run(*ends))
        return np.vstack([one for one, _ in runs]), np.concatenate([share for _, share in runs])
    steps = np.atleast_1d(part["spacing"])
    X, Y = np.meshgrid(_over(sides[0], steps[0]), _over(sides[1], steps[-1]), indexing="ij")
    return np.column_stack([X.ravel(), Y.ravel()]), np.ones(X.size)


def _hangers(made: Stiff, part: Mapping[str, Any]) -> None:
    """In the middle of the gap of two slabs above each other with one corner."""
    upper, lower = (made.model["parts"][name] for name in part["between"])
    R = turn(lower)
    down = float(R[2] @ (_origin(upper) - _origin(lower)))
    middle = (down - upper["thickness"] / 2 + lower["thickness"] / 2) / 2
    if "like" in part:
        load, sag = _HANGERS[part["like"]]
        stiffness = [0.0, 0.0, load * _POUND / sag / _INCH]
    else:
        stiffness = [_number(part["stiffness"].get(key, 0.0)) for key in ("shear", "shear", "normal")]
    along = np.zeros((6, 6))
    along[:3, :3] = R.T @ np.diag(stiffness) @ R
    apart = np.kron([[1.0, -1.0], [-1.0, 1.0]], along)
    for (x, y), share in zip(*_pattern(part, _sides(lower)), strict=True):
        ends = [made.spot(part["between"][0], [x, y, middle - down]), made.spot(part["between"][1], [x, y, middle])]
        made.bones.add("K", ends, share * apart)
        made.bones.add("H", ends, share * _number(part.get("loss_factor", 0.0)) * apart)
        for one in ends:
            made.bones.body(one, share * _number(part.get("mass", 0.0)) / 2)


def _mass(made: Stiff, part: Mapping[str, Any]) -> None:
    """Over a region; in all, per length or per area."""
    sides, region = _sides(made.model["parts"][part["on"]]), part["region"]
    if region == "whole":
        region = {"rectangle": sides}
    if "line" in region:
        local, share = _run(*np.array(region["line"], float))
    else:
        size = np.array(region.get("rectangle", region.get("rim")), float)
        low = np.array(region.get("at", sides / 2), float) - size / 2
        if "rim" in region:
            corners = low + size * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
            runs = [_run(corners[k], corners[k + 1]) for k in range(4)]
            local, share = np.vstack([one for one, _ in runs]), np.concatenate([share for _, share in runs])
        else:
            (x, u), (y, v) = (_run(np.zeros(1), np.array([one])) for one in size)
            local = low + np.array([[p[0], q[0]] for p in x for q in y])
            share = np.outer(u, v).ravel()
    per = "kg/m" in str(part["mass"])
    for (x, y), one in zip(local, share if per else share / share.sum(), strict=True):
        made.bones.body(made.spot(part["on"], [x, y, 0.0]), float(_number(part["mass"]) * one))


_HANGS: Final = {"spring": _spring, "hangers": _hangers, "mass": _mass}


def _slab(rng: np.random.Generator) -> Draft:
    """Stiff, leaning, with points that are not on a line."""
    a, b = between(rng, 1.0, 2.0), between(rng, 1.0, 2.0)
    n, x = np.array([*rng.uniform(-0.5, 0.5, 2), 1.0]), np.array([1.0, *rng.uniform(-0.4, 0.4, 2)])
    part: Draft = {"type": "slab", "outline": [[0, 0], [a, 0], [a, b], [0, b]], "mesh": max(a, b) / 4, "material": "m",
                   "thickness": between(rng, 0.015, 0.02), "origin": rng.uniform(-1, 1, 3).round(3).tolist(),
                   "normal": n.tolist(), "x_direction": (x - (x @ n) / (n @ n) * n).tolist()}  # fmt: skip
    shares = {"a": (0.1, 0.15), "b": (0.85, 0.1), "c": (0.3, 0.9), "d": (0.7, 0.65)}
    points = {name: {"on": "low", "at": np.round([a, b] * np.array(one), 3).tolist()} for name, one in shares.items()}
    part["through"] = [one["at"] for one in points.values()]
    return {
        "materials": {"m": {"E": 1e15, "nu": 0.3, "rho": between(rng, 1000, 3000)}},
        "parts": {"low": part},
        "points": points,
        "damping": {"ratio": 0.03},
    }


def _mass_of(draft: Draft) -> float:
    part = draft["parts"]["low"]
    return float(draft["materials"]["m"]["rho"] * _sides(part).prod() * part["thickness"])


def _on_springs(rng: np.random.Generator, draft: Draft) -> Draft:
    k = _mass_of(draft) * (2 * np.pi * rng.uniform(2, 4)) ** 2 / 3
    for one in "abc":
        sizes = {axis: float(k * rng.uniform(0.5, 2)) for axis in "xyz"}
        draft["parts"][f"k{one}"] = {"type": "spring", "between": [one, "ground"], "stiffness": sizes}
    return draft


def _answers(
    rng: np.random.Generator, draft: Draft, accuracy: float = 1e-4, answers: tuple[str, ...] = ANSWERS
) -> Case:
    ways = [f"{place}.{rng.choice(['x', 'y', 'z'])}" for place in "da"]
    return case_of(rng, Subject(draft, _form, ways[:1], ways, accuracy, _WHY, aside=_ASIDE, answers=answers))


def _hung(rng: np.random.Generator) -> Draft:
    """A stiff ceiling below a floor that is held."""
    draft = _slab(rng)
    low = draft["parts"]["low"]
    floor = {key: one for key, one in low.items() if key != "through"}
    floor["origin"] = (_origin(low) + between(rng, 0.2, 0.5) * turn(low)[2]).tolist()
    draft["parts"]["floor"] = floor
    draft["supports"] = {f"edge {k}": {"on": "floor", "set": f"side {k}", "fix": "clamped"} for k in (1, 2, 3, 4)}
    return draft


@capability("stiff: a ceiling on hangers", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = _hung(rng)
    a, b = draft["parts"]["low"]["outline"][2]
    k = _mass_of(draft) * (2 * np.pi * rng.uniform(2, 4)) ** 2
    part: Draft = {"type": "hangers", "between": ["floor", "low"]}
    kind, shear = str(rng.choice(["spacing", "at", "along"])), rng.uniform(0.2, 0.8)
    if kind == "along":
        step = between(rng, 0.2, 0.4)
        n = k / (a * b / step)
        part |= {"along": str(rng.choice(["x", "y"])), "spacing": step}
        part["stiffness"] = {"normal": f"{n:.5g} N/m^2", "shear": f"{n * shear:.5g} N/m^2"}
        part["mass"] = f"{_mass_of(draft) / (a * b / step):.5g} kg/m"
    else:
        n = k / 4 if kind == "at" else k * 0.16
        part["stiffness"] = {"normal": float(f"{n:.5g}"), "shear": float(f"{n * shear:.5g}")}
        part["mass"] = float(f"{_mass_of(draft) * n / k:.5g}")
        places = np.array([[0.15, 0.2], [0.8, 0.1], [0.7, 0.85], [0.2, 0.7]]) * [a, b]
        more = {"at": places.round(3).tolist()} if kind == "at" else {"spacing": [0.4 * a, 0.4 * b]}
        part |= more
    draft["parts"]["hung"] = part
    if rng.random() < 0.5:
        part["loss_factor"] = between(rng, 0.06, 0.2)
        draft["damping"] = {"from": "materials"}
        return _answers(rng, draft, answers=("losses", "frf", "vibration"))
    return _answers(rng, draft)


@capability("stiff: a ceiling on hangers of the library", "independent")
def _(rng: np.random.Generator) -> Case:
    """They push along their normal alone: springs hold it sideways."""
    draft = _hung(rng)
    a, b = draft["parts"]["low"]["outline"][2]
    word = str(rng.choice(list(_HANGERS)))
    places = np.array([[0.15, 0.2], [0.8, 0.1], [0.7, 0.85], [0.2, 0.7]]) * [a, b]
    draft["parts"]["hung"] = {
        "type": "hangers", "between": ["floor", "low"], "like": word, "at": places.round(3).tolist(),
    }  # fmt: skip
    load, sag = _HANGERS[word]
    k = load * _POUND / sag / _INCH
    for one in "ac":
        sizes = {axis: float(k * rng.uniform(0.5, 2)) for axis in "xy"}
        draft["parts"][f"k{one}"] = {"type": "spring", "between": [one, "ground"], "stiffness": sizes}
    return _answers(rng, draft)


def _region(rng: np.random.Generator, kind: str, plate: Floats, points: Floats) -> Any:
    """No line of it within 3 cm of one through a point: springs are lost in rounding of cells of 1 mm so stiff."""
    while kind != "whole":
        sides = (plate * rng.uniform(0.3, 0.6, 2)).round(3)
        at = (sides / 2 + (plate - sides) * rng.uniform(0.1, 0.8, 2)).round(3)
        x, y = between(rng, 0.2 * plate[0], 0.8 * plate[0]), (plate[1] * np.array([0.2, 0.8])).round(3).tolist()
        lines = [[x], y] if kind == "line" else np.transpose([at - sides / 2, at + sides / 2]).tolist()
        if all(np.abs(np.subtract.outer(points[:, k], lines[k])).min() > 0.03 for k in (0, 1)):
            return {"line": [[x, one] for one in y]} if kind == "line" else {kind: sides.tolist(), "at": at.tolist()}
    return "whole"


@capability("stiff: masses over regions", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = _slab(rng)
    part = draft["parts"]["low"]
    a, b = part.pop("outline")[2]
    del part["through"]
    part |= {"type": "plate", "size": [a, b], "mesh": [6, 6], "in_plane": "rigid"}
    draft = _on_springs(rng, draft)
    kind = str(rng.choice(["whole", "rectangle", "line", "rim"]))
    mass = _mass_of(draft) * rng.uniform(0.7, 1.5)
    region = _region(rng, kind, np.array([a, b]), np.array([one["at"] for one in draft["points"].values()]))
    said: Any = float(f"{mass:.5g}")
    if rng.random() < 0.5:
        said = f"{mass / b:.5g} kg/m" if kind in ("line", "rim") else f"{mass / a / b:.5g} kg/m^2"
    draft["parts"]["load"] = {"type": "mass", "on": "low", "region": region, "mass": said}
    # Thin plates have no rotary inertia: (h / b)^2 of that of a turn, half of it of a frequency, over losses of 6 %.
    return _answers(rng, draft, 1e-4 + 4 * (part["thickness"] / min(a, b)) ** 2)


def _deck(spots: Floats, mass: float, at: int) -> str:
    """A grid of five by five nodes, with a mass at one, a support of another and a link of two."""
    lines = ["SOL 101", "CEND", "SPC = 1", "BEGIN BULK"]
    lines += [f"GRID,{k + 1},,{x:.6f},{y:.6f},{z:.6f}" for k, (x, y, z) in enumerate(spots)]
    for k in range(16):
        first = k // 4 * 5 + k % 4 + 1
        lines.append(f"CQUAD4,{k + 1},1,{first},{first + 1},{first + 6},{first + 5}")
    lines += [f"CONM2,101,{at + 1},0,{mass!r}", "SPC1,1,123456,13", "RBE2,201,1,123456,2"]
    return "\n".join([*lines, "ENDDATA", ""])


def _attached_form(model: Model, spots: Floats, mass: float, at: int) -> Linear:
    """Two bodies; what the file states is on that which has its unit of length."""
    bones, bodies, parts = Skeleton(), {}, model["parts"]
    for name in ("low", "high"):
        part = parts[name]
        (a, b), t = part["scale"] * (spots[-1] - spots[0])[:2], part["thickness"]
        of = model["materials"]["m"]["rho"] * a * b * t
        bodies[name] = bones.place(part["scale"] * spots[12])
        bones.body(bodies[name], of, np.diag(of * np.array([b * b + t * t, a * a + t * t, a * a + b * b]) / 12))
    more = parts["more"]
    (on,) = [name for name in bodies if parts[name]["scale"] == more["scale"]]
    if more["take"] == "supports":
        bones.hold(bodies[on])
    elif more["take"] == "masses":
        place = bones.place(more["scale"] * spots[at])
        bones.follow(bodies[on], place)
        bones.body(place, mass * more.get("mass_unit", 1.0))
    points = {}
    for name, one in model["points"].items():
        points[name] = bones.place(np.array(one["at"]))
        bones.follow(bodies[one["on"]], points[name])
    for part in parts.values():
        if part["type"] == "spring":
            bones.spring(points[part["between"][0]], None, six(part["stiffness"]))
    return linear(bones, points)


@capability("stiff: what a mesh file attaches", "independent")
def _(rng: np.random.Generator) -> Case:
    """Two shells of one file in different units of length: on one of them is what the file states."""
    sides, corner = rng.uniform(0.8, 1.5, 2).round(3), rng.uniform(0.5, 1.5, 3).round(3)
    shares = np.array([[k % 5 / 4, k // 5 / 4, 0.0] for k in range(25)])
    spots = (shares * [*sides, 0.0] + corner).round(6)
    h, rho, at = between(rng, 0.015, 0.02), between(rng, 1000, 3000), int(rng.choice([4, 18, 20]))
    weigh = rho * h * float(sides.prod())
    mass, unit = float(f"{weigh * rng.uniform(0.5, 1.5):.4g}"), between(rng, 0.5, 2)
    shell = {"type": "shell", "mesh": "p.bdf", "material": "m", "thickness": h}
    draft: Draft = {
        "materials": {"m": {"E": 1e15, "nu": 0.3, "rho": rho}},
        "parts": {
            "low": {**shell, "scale": 1.0}, "high": {**shell, "scale": 1.1},
            "more": {"type": "attachments", "mesh": "p.bdf", "scale": 1.0, "take": "masses", "mass_unit": unit},
        },
        "points": {},
        "damping": {"ratio": 0.03},
    }  # fmt: skip
    if rng.random() < 0.5:  # kg beside metres
        del draft["parts"]["more"]["mass_unit"]
    k = weigh * (2 * np.pi * rng.uniform(2, 4)) ** 2 / 3
    for name in ("low", "high"):
        for letter, node in zip("abc", (6, 3, 22), strict=True):
            place = (draft["parts"][name]["scale"] * spots[node]).round(6)
            draft["points"][f"{name} {letter}"] = {"on": name, "at": place.tolist()}
            draft["parts"][f"{name} k{letter}"] = {
                "type": "spring", "between": [f"{name} {letter}", "ground"],
                "stiffness": {axis: float(k * rng.uniform(0.5, 2)) for axis in "xyz"},
            }  # fmt: skip
    ways = [f"{name}.z" for name in ("low a", "low b", "high a")]
    form = partial(_attached_form, spots=spots, mass=mass, at=at)
    return case_of(rng, Subject(draft, form, ways[:1], ways[: int(rng.integers(1, 4))], 1e-4, _WHY, aside=_ASIDE,
                                beside=lambda _: {"p.bdf": _deck(spots, mass, at)}))  # fmt: skip
