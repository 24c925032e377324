"""Laws of contacts as their YAML states them, read and drawn."""

from __future__ import annotations

from collections.abc import Mapping
from math import acos, acosh, log, pi, sqrt
from typing import Any, Final

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from tests.independent import contact_events as ev

LAWS: Final = ("linear", "hertz", "hunt-crossley", "cubic", "flores", "lankarani-nikravesh", "table", "smooth table")


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """A number of six digits, evenly along its logarithm."""
    return rounded(float(np.exp(rng.uniform(log(low), log(high)))))


def rounded(x: float) -> float:
    """Six digits."""
    return float(f"{x:.6g}")


def swing(z: float) -> float:
    """omega t / 2 of a linear contact with a damping ratio z, until it no longer pushes."""
    if z == 1.0:
        return 1.0
    return acos(z) / sqrt(1 - z * z) if z < 1.0 else acosh(z) / sqrt(z * z - 1)


def ratio_of(e: float, tensile: bool) -> float:
    """Damping ratio with which a linear contact gives a restitution: until its length is back, or while it pushes."""
    loss = -log(e)
    if tensile:
        return loss / sqrt(pi**2 + loss**2)
    return float(brentq(lambda z: 2 * z * swing(z) - loss, 0, 1 / e + 1, xtol=1e-15))


def law_of(spec: Mapping[str, Any], mass: float, speed: float) -> ev.Law:
    """A law as its YAML states it. mass : what a restitution and a duration count; speed : of the first meeting."""
    kind, tensile, e = spec["type"], bool(spec.get("tensile")), spec.get("restitution")
    k, n = spec.get("stiffness", 0.0), spec.get("exponent", 1.5)
    speed = spec.get("at_speed", speed)
    if kind == "stop":
        return ev.linear(k, spec.get("damping", 0.0), tensile)
    if kind == "linear":
        if e is None:
            return ev.linear(k, spec.get("damping", 0.0), tensile)
        z = ratio_of(e, tensile)
        if "duration" in spec:
            angle = sqrt(pi**2 + log(e) ** 2) if tensile else 2 * swing(z)
            k = mass * (angle / spec["duration"]) ** 2
        return ev.linear(k, 2 * z * sqrt(k * mass), tensile)
    if kind == "hertz":
        if "radius" in spec:
            soft = sum((1 - nu**2) / E for E, nu in zip(spec["E"], spec["nu"], strict=True))
            k = 4 / 3 / soft * sqrt(spec["radius"])
        return ev.hertz(k, spec.get("damping", 0.0), tensile)
    if kind == "flores":
        return ev.power(k, n, 1.6 * (1 - e) / (e * speed), tensile)  # Machado et al. 2012, eq. 8/5 (1 - e) / e
    if kind == "lankarani-nikravesh":
        return ev.power(k, n, 0.75 * (1 - e * e) / speed, tensile)
    chi = spec.get("dissipation", 0.0) if e is None else ev.chi_of_restitution(e, speed)
    if kind == "hunt-crossley":
        return ev.power(k, n, chi, tensile)
    if kind == "cubic":
        return ev.cubic(k, spec["cubic"], chi, tensile)
    depths, forces = np.array(spec["curve"], dtype=float).T
    if not spec.get("smooth"):
        return ev.table(depths, forces, chi, tensile)
    spring = PchipInterpolator(depths, forces)
    end, slope = float(depths[-1]), float(spring.derivative()(depths[-1]))

    def force(d: float, piece: int) -> float:
        return float(forces[-1]) + slope * (d - end) if piece == len(depths) - 1 else float(spring(d))

    return ev.factored(force, chi, tensile, depths[1:].tolist())


def draw_law(rng: np.random.Generator, mass: float, speed: float, time: float, kind: str, e: bool = True) -> Any:
    """YAML of a law whose contact lasts about so long. e : it may state a restitution."""
    k = rounded(mass * (pi / time) ** 2)
    depth = speed * time / pi
    t = {"tensile": True} if rng.random() < 0.2 else {}
    way, back = int(rng.integers(3 if e else 2)), rounded(float(rng.uniform(0.15, 0.95)))
    if kind == "linear":
        damping = rounded(float(rng.uniform(0.05, 1.2)) * 2 * sqrt(k * mass))
        ways = [{"stiffness": k}, {"stiffness": k, "damping": damping}, {"stiffness": k, "restitution": back}]
        if way == 2 and rng.random() < 0.5:
            return {"type": kind, "duration": rounded(time), "restitution": back, **t}
        return {"type": kind, **ways[way], **t}
    if kind == "hertz":
        if way == 0 and rng.random() < 0.4:
            moduli = [between(rng, 1e9, 2e11), between(rng, 1e9, 2e11)]
            nu = [rounded(float(rng.uniform(0, 0.45))) for _ in moduli]
            return {"type": kind, "radius": between(rng, 0.005, 0.5), "E": moduli, "nu": nu}
        damping = {"damping": rounded(float(rng.uniform(0.05, 0.8)) * sqrt(k * mass / depth))} if way else {}
        return {"type": kind, "stiffness": rounded(k / sqrt(depth)), **damping, **t}
    n = rounded(float(rng.uniform(1.0, 3.0))) if rng.random() < 0.5 else 1.5
    meets = {"at_speed": rounded(speed * float(rng.uniform(0.5, 2)))} if not e or rng.random() < 0.5 else {}
    lost: dict[str, Any] = [{}, {"dissipation": rounded(float(rng.uniform(0.05, 2.0)) / speed)}, {}][way]
    if way == 2:
        lost = {"restitution": back, **meets}
    if kind in ("hunt-crossley", "flores", "lankarani-nikravesh"):
        own = lost if kind == "hunt-crossley" else {"restitution": back, **meets}
        return {"type": kind, "stiffness": rounded(k / depth ** (n - 1)), "exponent": n, **own, **t}
    if kind == "cubic":
        part = rounded(k * float(rng.uniform(0, 1)))
        return {"type": kind, "stiffness": part, "cubic": rounded((k - part / 2) / depth**2), **lost, **t}
    depths = np.concatenate([[0.0], np.cumsum(rng.uniform(0.2, 1.0, 4))]) * depth
    forces = np.concatenate([[0.0], np.cumsum(k * rng.uniform(0.3, 2.0, 4) * np.diff(depths))])
    curve = [[rounded(d), rounded(f)] for d, f in zip(depths, forces, strict=True)]
    return {"type": "table", "curve": curve, **({"smooth": True} if kind == "smooth table" else {}), **lost, **t}
