"""Plates and slabs in space, alone and above each other, read for the independent formulation by Ritz.

Plates are Kirchhoff's and rigid in their planes; slabs have shear and stretch. What acts off the middle has rigid arms.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from tests.independent.linear import Floats, Linear
from tests.independent.ritz import PX, PY, Box, Panel, Section, U, V, W, section
from tests.machine.framework import Model
from tests.machine.plates import plies
from tests.machine.skeletons import LAYERS

_SIDES = {"side 1": "y0", "side 2": "x1", "side 3": "y1", "side 4": "x0"}
_HARD = {"simple hard": "hard"}
_STIFF = 1e4  # times as stiff: a plate that does not stretch
Spots = tuple[Floats, Floats]
"""Places [n, 2] in a sheet's own coordinates, and the weight of each [n]."""


@dataclass
class Sheet:
    """A panel in space: rows of R are its axes, corner its origin, middle that of its thickness above its nodes."""

    panel: Panel
    R: Floats
    corner: Floats
    thickness: float
    middle: float
    holes: tuple[Box, ...] = ()
    first: int = 0

    def own(self, local: Floats, z: float | Floats) -> Floats:
        """Motions [n, 3, c] along its own axes of places on arms of z."""
        x, y = np.asarray(local, float).T
        rows = self.panel.rows
        arm = np.broadcast_to(np.asarray(z, float), x.shape)[:, None]
        return np.stack([rows(x, y, U) + arm * rows(x, y, PX), rows(x, y, V) + arm * rows(x, y, PY), rows(x, y, W)], 1)

    def turns(self, local: Floats) -> Floats:
        """Rotations [n, 3, c] about its own axes; none about its normal."""
        x, y = np.asarray(local, float).T
        px, py = self.panel.rows(x, y, PX), self.panel.rows(x, y, PY)
        return np.stack([-py, px, np.zeros_like(px)], 1)

    def face(self, side: str) -> float:
        return self.middle + {"below": -0.5, "middle": 0.0, "above": 0.5}[side] * self.thickness


def read(model: Model, order: int = 11) -> Linear:
    """The independent form of a model of plates and slabs."""
    return read_form(model, order).linear(model)


def read_form(model: Model, order: int = 11) -> Form:
    """The same before it is closed: more may be added."""
    parts = model["parts"]
    sheets, of_loss = {}, []
    first = 0
    for name, part in parts.items():
        if part["type"] in ("plate", "slab"):
            sheets[name], lossy = _sheet(model, name, order)
            sheets[name].first = first
            first += len(sheets[name].panel.K)
            of_loss.append(lossy)
    form = Form(sheets, block_diag(*of_loss), first)
    for part in parts.values():
        if part["type"] in _HANGS:
            _HANGS[part["type"]](form, part, model)
    for one in model.get("supports", {}).values():
        if "on" in one:
            _support(form, one)
    for one in model.get("constraints", {}).values():
        _rests(form, one, model)
    return form


def _sheet(model: Model, name: str, order: int) -> tuple[Sheet, Floats]:
    """It and the lossy part of its own stiffness."""
    part = model["parts"][name]
    thin = part["type"] == "plate"
    a, b = part["size"] if thin else part["outline"][2]
    of, lossy, h = _rigidities(model, name)
    if thin:  # Kirchhoff's have no rotary inertia
        of = replace(of, mass=(of.mass[0], 0.0, 0.0))
    panel = Panel(a, b, thin=thin, order=order, flat=thin and _moves_along(model, part)).add(of)
    holes = tuple(_rectangle(one["rectangle"], one["at"]) for one in part.get("holes", ()))
    H = panel.stiffness(lossy)
    for box in holes:
        panel.K -= panel.stiffness(of, box)
        panel.M -= panel.inertia(of, box)
        H -= panel.stiffness(lossy, box)
    n = np.asarray(part.get("normal", [0, 0, 1.0]), float)
    n /= np.linalg.norm(n)
    x = np.asarray(part.get("x_direction", [1.0, 0, 0]), float)
    x = x - (x @ n) * n
    x /= np.linalg.norm(x)
    R = np.array([x, np.cross(n, x), n])
    corner = np.asarray(part.get("origin", [0, 0, 0]), float)
    return Sheet(panel, R, corner, h, part.get("offset", 0.0), holes), H


def _rigidities(model: Model, name: str) -> tuple[Section, Section, float]:
    """Of a sheet, what of them is lossy, and its thickness."""
    part = model["parts"][name]
    offset = part.get("offset", 0.0)
    if smeared := part.get("smeared"):
        of, loss = _smeared(smeared, part["thickness"], offset), smeared.get("loss_factor", 0.0)
        return of, Section(loss * of.A, loss * of.B, loss * of.D, loss * of.S), part["thickness"]
    laid = plies(model, name)
    both = [section(laid, offset, lossy=lossy) for lossy in (False, True)]
    bond = part["layers"]["bond"] if "layers" in part and "bond" in part["layers"] else 1.0
    if bond < 1.0:  # the share of the way from boards that bend alone, about the middle of all
        alone = [sum(section([one], lossy=lossy).D for one in laid) for lossy in (False, True)]
        both = [
            Section(of.A, bond * of.B, bond * of.D + (1 - bond) * D, of.S, of.mass)
            for of, D in zip(both, alone, strict=True)
        ]
    if _unstretched(part):
        both = [Section(_STIFF * of.A, of.B, of.D, of.S, of.mass) for of in both]
    return both[0], both[1], float(sum(one.thickness for one in laid))


def _moves_along(model: Model, part: Mapping[str, Any]) -> bool:
    """Whether a plate moves in its plane: as it says, or where something pulls it that way."""
    pulled = any(one["type"] == "foundation" and "shear" in one.get("stiffness", {}) for one in model["parts"].values())
    return pulled or part.get("in_plane") == "elastic"


def _unstretched(part: Mapping[str, Any]) -> bool:
    """Whether it moves there as a body."""
    return part["type"] == "plate" and (part.get("element") == "hermite12" or part.get("in_plane") == "rigid")


def _rectangle(sides: Any, middle: Any) -> Box:
    (sx, sy), (x, y) = sides, middle
    return x - sx / 2, x + sx / 2, y - sy / 2, y + sy / 2


def _smeared(said: Mapping[str, Any], h: float, offset: float) -> Section:
    """Rigidities of a deck about its nodes; those of the membrane are of a homogeneous plate where none are said."""

    def square(one: Any) -> Floats:
        return np.array([[one[0], one[2], 0], [one[2], one[1], 0], [0, 0, one[3]]], float)

    D = square(said["D"])
    A = square(said["A"]) if "A" in said else 12 / h**2 * D
    m = said["mass"]
    mass = (m, m * offset, m * (h**2 / 12 + offset**2))
    return Section(A, offset * A, D + offset**2 * A, np.diag(said["S"]).astype(float), mass)


class Form:
    """Matrices of all sheets, as they grow."""

    def __init__(self, sheets: Mapping[str, Sheet], H: Floats, size: int) -> None:
        self.sheets, self.size, self.H = sheets, size, H
        self.K = block_diag(*[one.panel.K for one in sheets.values()])
        self.M = block_diag(*[one.panel.M for one in sheets.values()])
        self.C = np.zeros((size, size))
        self.ties: list[Floats] = []  # rows [n, c] of what stays zero, over all sheets

    def whole(self, name: str, rows: Floats) -> Floats:
        """Rows [.., c] of a sheet among all coefficients."""
        sheet = self.sheets[name]
        found = np.zeros((*rows.shape[:-1], self.size))
        found[..., sheet.first : sheet.first + rows.shape[-1]] = rows
        return found

    def springs(self, rows: Floats, sizes: Floats, loss: float = 0.0) -> None:
        """Springs of stiffnesses [n, d] along motions [n, d, c]."""
        K = np.einsum("nda,nd,ndb->ab", rows, sizes, rows, optimize=True)
        self.K += K
        self.H += loss * K

    def masses(self, name: str, local: Floats, sizes: Floats) -> None:
        """Masses at places of a sheet, in its middle surface of nodes; they move every way."""
        rows = self.whole(name, self.sheets[name].own(local, 0.0))
        self.M += np.einsum("nda,n,ndb->ab", rows, sizes, rows, optimize=True)

    def linear(self, model: Model) -> Linear:
        held = [
            self.whole(name, np.vstack([one / np.abs(one).max() for one in sheet.panel.held if one.any()]))
            for name, sheet in self.sheets.items()
            if any(one.any() for one in sheet.panel.held)
        ]
        held += [one / np.abs(one).max() for one in self.ties]
        if held:
            _, s, V_ = np.linalg.svd(np.vstack(held), full_matrices=True)
            T = V_[int(np.sum(s > 1e-9 * s[0])) :].T
        else:
            T = np.eye(self.size)
        rows = {}
        for name, point in model["points"].items():
            if point["on"] not in self.sheets:
                continue
            sheet = self.sheets[point["on"]]
            at = np.array([point["at"]], float)
            moved = [sheet.own(at, 0.0)[0], sheet.turns(at)[0]]
            both = np.vstack([sheet.R.T @ self.whole(point["on"], one) for one in moved]) @ T
            rows |= {(name, one): both[k] for k, one in enumerate(("x", "y", "z", "rx", "ry", "rz"))}
        K, M, C, H = (T.T @ one @ T for one in (self.K, self.M, self.C, self.H))
        return Linear(K, M, C, H, rows, self._rides() @ self.M @ T)

    def _rides(self) -> Floats:
        """Coefficients [3, c] of a unit motion of all along x, y, z; plates that are rigid in their planes stay."""
        found = np.zeros((3, self.size))
        for sheet in self.sheets.values():
            n = sheet.panel.n**2
            for place, k in enumerate(sheet.panel.fields):
                if k in (U, V, W):
                    found[:, sheet.first + place * n] += sheet.R[k]
        return found


def _spots(form: Form, name: str, region: Any, per_length: bool = False) -> Spots:
    """Gauss's places of a region of a sheet, or of a line or a rim along its length."""
    panel = form.sheets[name].panel
    if region in (None, "whole"):
        boxes = [panel.points(), *(panel.points(box) for box in form.sheets[name].holes)]
        signs = [1.0] + [-1.0] * (len(boxes) - 1)
        x, y, w = (np.concatenate(one) for one in zip(*boxes, strict=True))
        return np.column_stack([x, y]), w * np.repeat(signs, [len(one[0]) for one in boxes])
    if "line" in region:
        return _along(panel, np.array(region["line"], float))
    sides = np.array(region.get("rectangle", region.get("rim")), float)
    middle = np.array(region.get("at", [panel.a / 2, panel.b / 2]), float)
    low, high = middle - sides / 2, middle + sides / 2
    if "rim" in region:
        corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]], low])
        runs = [_along(panel, corners[k : k + 2]) for k in range(4)]
        return np.vstack([one for one, _ in runs]), np.concatenate([w for _, w in runs])
    x, y, w = panel.points((low[0], high[0], low[1], high[1]))
    return np.column_stack([x, y]), w


def _along(panel: Panel, ends: Floats) -> Spots:
    g, w = np.polynomial.legendre.leggauss(panel.n + 1)
    share = (g[:, None] + 1) / 2
    return ends[0] + share * (ends[1] - ends[0]), w * float(np.linalg.norm(ends[1] - ends[0])) / 2


def _foundation(form: Form, part: Mapping[str, Any], _: Model) -> None:
    said = part.get("stiffness") or {"normal": LAYERS[part["like"]]}
    sizes = [said.get(key, 0.0) for key in ("shear", "shear", "normal")]
    loss = part.get("loss_factor", 0.0)
    if "on" in part:
        name = part["on"]
        sheet = form.sheets[name]
        local, w = _spots(form, name, part.get("region"))
        rows = form.whole(name, sheet.own(local, sheet.face(part.get("side", "below"))))
        form.springs(rows, np.outer(w, sizes), loss)
        return
    a, b = _common(form, part["between"])
    x, y, w = form.sheets[part["between"][0]].panel.points((0.0, a, 0.0, b))
    _between(form, part["between"], np.column_stack([x, y]), w, np.array(sizes), loss)


def _common(form: Form, names: Any) -> tuple[float, float]:
    """Sides of what two sheets with one corner have in common."""
    panels = [form.sheets[name].panel for name in names]
    return min(one.a for one in panels), min(one.b for one in panels)


def _between(form: Form, names: Any, local: Floats, w: Floats, sizes: Floats, loss: float) -> Floats:
    """Springs between two sheets above each other with one corner, in the middle of their gap; the rows."""
    upper, lower = sorted((form.sheets[name] for name in names), key=lambda one: -one.corner[2])
    middle = 0.5 * (upper.corner[2] + upper.face("below") + lower.corner[2] + lower.face("above"))
    rows = [form.whole(name, one.own(local, middle - one.corner[2])) for name in names for one in (form.sheets[name],)]
    form.springs(rows[0] - rows[1], np.outer(w, sizes), loss)
    return np.stack(rows)


def _hangers(form: Form, part: Mapping[str, Any], _: Model) -> None:
    a, b = _common(form, part["between"])
    normal, shear = (_number(part["stiffness"].get(key, 0.0)) for key in ("normal", "shear"))
    if "at" in part:
        local = np.array(part["at"], float)
        w = np.ones(len(local))
    elif "along" in part:
        length, across = (a, b) if part["along"] == "x" else (b, a)
        panel, runs = form.sheets[part["between"][1]].panel, []
        for at in _regular(across, part["spacing"]):
            ends = np.array([[0, at], [length, at]])
            runs.append(_along(panel, ends if part["along"] == "x" else ends[:, ::-1]))
        local, w = np.vstack([one for one, _ in runs]), np.concatenate([w for _, w in runs])
    else:
        steps = np.atleast_1d(part["spacing"])
        X, Y = np.meshgrid(_regular(a, steps[0]), _regular(b, steps[-1]), indexing="ij")
        local = np.column_stack([X.ravel(), Y.ravel()])
        w = np.ones(len(local))
    rows = _between(form, part["between"], local, w, np.array([shear, shear, normal]), part.get("loss_factor", 0.0))
    mass = _number(part.get("mass", 0.0))
    for of_side in rows * bool(mass):
        form.M += np.einsum("nda,n,ndb->ab", of_side, w * mass / 2, of_side, optimize=True)


def _regular(length: float, step: float) -> Floats:
    """Centred, as many as fit nearest."""
    count = max(1, int(length / step + 0.5))
    return np.asarray((length - (count - 1) * step) / 2 + step * np.arange(count))


def _number(said: Any) -> float:
    return float(str(said).split()[0])


def _mass(form: Form, part: Mapping[str, Any], model: Model) -> None:
    if "at" in part:
        point = model["points"][part["at"]]
        form.masses(point["on"], np.array([point["at"]], float), np.array([_number(part["mass"])]))
        return
    local, w = _spots(form, part["on"], part.get("region"))
    per = str(part["mass"]).split()[1:] and "kg/m" in str(part["mass"])
    form.masses(part["on"], local, _number(part["mass"]) * (w if per else w / w.sum()))


def _spring(form: Form, part: Mapping[str, Any], model: Model) -> None:
    point = model["points"][part["between"][0]]
    sheet, at = form.sheets[point["on"]], np.array([point["at"]], float)
    both = np.vstack([sheet.R.T @ form.whole(point["on"], one[0]) for one in (sheet.own(at, 0.0), sheet.turns(at))])
    six = [[part.get(key, {}).get(one, 0.0) for one in ("x", "y", "z", "rx", "ry", "rz")]
           for key in ("stiffness", "damping")]  # fmt: skip
    form.springs(both[None], np.array([six[0]]))
    form.C += np.einsum("da,d,db->ab", both, np.array(six[1]), both)


def _support(form: Form, said: Mapping[str, Any]) -> None:
    name = said["on"]
    sheet = form.sheets[name]
    panel = sheet.panel
    edge = said.get("edge") or _SIDES.get(said.get("set", ""))
    if isinstance(said.get("fix"), list):  # along its plane, of all nodes; a plate that is rigid there has neither
        x, y, _ = panel.points()
        panel.held += [panel.rows(x, y, one) for one in (U, V)]
        return
    if "line" in said:
        local, _ = _along(panel, np.array(said["line"], float))
        panel.held.append(panel.rows(*local.T, W))
    elif "stiffness" in said:
        x, y, w = panel.edge(edge or "")
        about = PX if (edge or "")[0] == "x" else PY
        for what, key in ((W, "z"), (about, "about edge")):
            rows = form.whole(name, panel.rows(x, y, what))[:, None]
            size = said["stiffness"].get(key, 0.0)
            form.springs(rows, size * w[:, None], said.get("loss_factor", 0.0))
    else:
        panel.hold(edge or "", _HARD.get(said["fix"], said["fix"]))


def _rests(form: Form, said: Mapping[str, Any], model: Model) -> None:
    """A block that moves up and down as the rigid motion which fits a region of a level sheet best."""
    point, of = model["points"][said["average"]], said["of"]
    block, sheet = model["parts"][point["on"]], form.sheets[of["on"]]
    local, w = _spots(form, of["on"], {key: of[key] for key in ("rectangle", "at")})
    off = local + sheet.corner[:2] - np.add(block["origin"], point["at"])[:2]
    fit = np.column_stack([np.ones(len(w)), off[:, 1], -off[:, 0]])  # of heave and turns about x and y to deflections
    best = np.linalg.solve((fit.T * w) @ fit, fit.T * w)[0]
    row = best @ form.whole(of["on"], sheet.own(local, 0.0)[:, 2])
    form.M += block["mass"] * np.outer(row, row)


_HANGS = {"foundation": _foundation, "hangers": _hangers, "mass": _mass, "spring": _spring}
