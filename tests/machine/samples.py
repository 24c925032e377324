"""Samples of a campaign, what is told of them, and the best of ranges, for a ball on a mass in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from statistics import NormalDist
from typing import Any, Final

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import qmc, spearmanr

from tests.machine.framework import Case, Door, Floats, Model, capability

Draft = dict[str, Any]
_WHY: Final = "velocities at samples 1/80 of a contact apart; a spring of 1e-4 of the contact's"
_FORCE, _SPEED = "ball on m peak force", "m.z velocity"
_QUANTILES: Final = (0.05, 0.5, 0.95)


def hit(mass: float, speed: float, k: float, other: float, spring: float) -> tuple[float, float]:
    """Largest force [N] of a ball that meets a mass on a spring through a linear contact, and largest speed of it
    [m/s]: both move as the two modes do until they part."""
    M = np.array([mass, other])
    stiff = np.array([[k, -k], [-k, k + spring]])
    root = 1 / np.sqrt(M)
    squares, shapes = np.linalg.eigh(root[:, None] * stiff * root)
    omega, shapes = np.sqrt(squares.clip(min=0.0)), root[:, None] * shapes
    start = shapes.T @ (M * [speed, 0.0])
    t = np.linspace(0, 1.3 * pi / omega[-1], 40001)[1:]
    moved = shapes @ (start[:, None] * np.sin(omega[:, None] * t) / omega[:, None])
    speeds = shapes @ (start[:, None] * np.cos(omega[:, None] * t))
    force = k * (moved[0] - moved[1])
    parted = int(np.argmax(force < 0))
    return float(force[:parted].max()), float(np.abs(speeds[1, :parted]).max())


def _study(k: float, m: float, v: float, duration: str = "10 ms") -> Draft:
    contact = {"type": "linear", "stiffness": f"{k} N/m"}
    return {
        "model": "mass.yaml",
        "bodies": {"ball": {"mass": f"{m} kg", "above": "m", "speed": f"{v} m/s", "contact": contact}},
        "record": {"m.z": "velocity"},
        "time": {"duration": duration, "sampling": "25 kHz"},
    }


def _mass(other: float, spring: float) -> Draft:
    kind = {"type": "oscillator", "mass": f"{other} kg", "stiffness": f"{spring} N/m"}
    return {"structure": kind, "points": {"m": {}}}


def _points(method: str, count: int, dimension: int, seed: int) -> Floats:
    """As scipy draws them."""
    rng = np.random.default_rng(seed)
    if method == "latin hypercube":
        return np.asarray(qmc.LatinHypercube(dimension, rng=rng).random(count))
    whole = 2 ** int(np.ceil(np.log2(count)))
    return np.asarray(qmc.Sobol(dimension, rng=rng).random(whole)[:count])


def _told(values: Floats, varied: Floats) -> list[float]:
    """Mean, deviation, quantiles, and 2 more than how it follows the ranks of each path."""
    ranks = [2 + float(spearmanr(values, one).statistic) for one in varied.T]
    return [values.mean(), values.std(ddof=1), *np.quantile(values, _QUANTILES), *ranks]


def _wilson(held: int, count: int) -> list[float]:
    z = NormalDist().inv_cdf(0.975)
    middle, p = count + z**2, held / count
    half = z * np.sqrt(p * (1 - p) / count + z**2 / (4 * count**2)) * count / middle
    centre = (held + z**2 / 2) / middle
    return [p, max(centre - half, 0.0), min(centre + half, 1.0)]


def _statistics(found: Draft, number: str, case: str, above: str = "") -> list[float]:
    of = next(one for one in found["statistics"] if (one["number"], one["case"], one["above"]) == (number, case, above))
    ranks = [2 + one for one in of["follows"]]
    return [of["mean"], of["deviation"], *(of["quantiles"][f"{100 * q:g} %"] for q in _QUANTILES), *ranks]


@capability("sweeps: drawn samples, what is told of them, and limits", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Two cases; rows that are kept are taken up again; and the rows that a batch makes."""
    count, seed = 13, int(rng.integers(1, 1000))
    k, other = (float(f"{one:.4g}") for one in (rng.uniform(0.8e6, 1.2e6), rng.uniform(0.8, 1.2)))
    harder = float(f"{k * rng.uniform(1.5, 3):.4g}")
    study = _study(k, 1.0, 1.0)
    study["cases"] = {"one": {"bodies.ball.contact.stiffness": f"{k} N/m"},
                      "two": {"bodies.ball.contact.stiffness": f"{harder} N/m"}}  # fmt: skip
    study["vary"] = {
        "bodies.ball.mass": {"from": "0.5 kg", "to": "1.5 kg", "scale": "log"},
        "bodies.ball.speed": {"normal": {"mean": "1 m/s", "sd": "10 %"}},
        "structure.mass": {"uniform": [f"{0.8 * other} kg", f"{1.2 * other} kg"]},
        "structure.stiffness": {"values": ["80 N/m", "90 N/m", "100 N/m"]},
    }
    methods = ("latin hypercube", "sobol")
    lines: dict[str, list[list[float]]] = {}
    for method in methods:
        u = _points(method, count, 4, seed)
        speeds = [1 + 0.1 * NormalDist().inv_cdf(one) for one in u[:, 1]]
        springs = np.array([80.0, 90.0, 100.0])[np.floor(3 * u[:, 3]).astype(int)]
        varied = np.column_stack([0.5 * 3 ** u[:, 0], speeds, other * (0.8 + 0.4 * u[:, 2]), springs])
        lines[method] = varied.tolist()
    ordered = np.sort([hit(m, v, k, big, spring)[1] for m, v, big, spring in lines[methods[0]]])
    limit = float(f"{ordered[8:10].mean():.6g}")
    study["limits"] = {_SPEED: f"{limit} m/s"}
    draft: Draft = {"study": study, "k": [k, harder], "lines": lines, "limit": limit, "mass": _mass(other, 90.0)}

    def asked(model: Model, door: Door) -> Floats:
        out = []
        for method in methods:
            inner = {**model["study"], "samples": {"count": count, "method": method, "seed": seed}}
            words = ("--no-pictures", "--workers", "1")
            again = [("sweep", "model.yaml", *words)] if method == "sobol" else []
            found = door.ask(inner, "sweep", *words, first=again, mass=model["mass"])
            quick = door.ask(inner, "sweep", *words, "--only", _FORCE, mass=model["mass"])
            for case in ("one", "two"):
                rows = [one["cases"][case]["numbers"] for one in found["samples"]]
                out += [one[_FORCE] for one in rows] + [one[_SPEED] for one in rows]
                out += [one["cases"][case]["numbers"][_FORCE] for one in quick["samples"]]
                out += _statistics(found, _FORCE, case) + _statistics(found, _SPEED, case)
                limit = next(one for one in found["limits"] if one["case"] == case and one["number"] == _SPEED)
                share = limit["share"]
                out += [limit["held"] + 1, limit["exceeded"] + 1, limit["limit"]["high"]]
                out += [1 + share["value"], 1 + share["low"], 1 + share["high"]]
            out += _statistics(found, _FORCE, "two", "one")
        door.told = []
        return np.array(out)

    def right(model: Model, _: Door) -> Floats:
        out: list[float] = []
        for method in methods:
            varied, forces = np.array(model["lines"][method]), []
            for stiffness in model["k"]:
                both = np.array([hit(m, v, stiffness, big, spring) for m, v, big, spring in varied])
                forces.append(both[:, 0])
                held = int((both[:, 1] <= model["limit"]).sum())
                out += [*both[:, 0], *both[:, 1], *both[:, 0], *_told(both[:, 0], varied), *_told(both[:, 1], varied)]
                out += [held + 1, count - held + 1, model["limit"], *(1 + one for one in _wilson(held, count))]
            out += _told(forces[1] - forces[0], varied)
        return np.array(out)

    return Case(draft, asked, right, 1e-3, _WHY, each=True)


@capability("sweeps: who makes a number scatter", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Shares of the variance of three tables of samples, and ends of their intervals about them."""
    count, seed = 8, int(rng.integers(1, 1000))
    k = float(f"{rng.uniform(0.8e6, 1.2e6):.4g}")
    study = _study(k, 1.0, 1.0)
    study["vary"] = {
        "bodies.ball.mass": {"uniform": ["0.5 kg", "2 kg"]},
        "bodies.ball.speed": {"uniform": ["0.7 m/s", "1.6 m/s"]},
    }
    study["samples"] = {"count": count, "method": "sobol indices", "seed": seed}

    def asked(model: Model, door: Door) -> Floats:
        found = door.ask(model["study"], "sweep", "--no-pictures", "--workers", "1", mass=model["mass"])
        door.told = []
        shares = next(one["shares"] for one in found["influence"] if one["number"] == _FORCE)
        both = [shares[path][kind] for path in model["study"]["vary"] for kind in ("alone", "total")]
        rows = [one["cases"]["as given"]["numbers"][_FORCE] for one in found["samples"]]
        around = [float(one["low"] <= one["value"] <= one["high"]) for one in both]
        own = next(one for one in found["statistics"] if one["number"] == _FORCE)
        return np.array([*rows, *(3 + one["value"] for one in both), *around, own["count"], own["mean"]])

    def right(model: Model, _: Door) -> Floats:
        u = np.asarray(qmc.Sobol(4, rng=np.random.default_rng(seed)).random(count))
        a, b = u[:, :2], u[:, 2:]
        tables = [a, b, np.column_stack([b[:, 0], a[:, 1]]), np.column_stack([a[:, 0], b[:, 1]])]
        made = [[hit(0.5 + 1.5 * x, 0.7 + 0.9 * y, k, 1.0, 90.0)[0] for x, y in table] for table in tables]
        fa, fb, *mixed = (np.array(one) for one in made)
        both = np.r_[fa, fb]
        shares = [
            share / both.var() for one in mixed
            for share in (np.mean((fb - both.mean()) * (one - fa)), np.mean((fa - one) ** 2) / 2)
        ]  # fmt: skip
        return np.array([*np.concatenate(made), *(3 + one for one in shares), 1, 1, 1, 1, 2 * count, both.mean()])

    return Case({"study": study, "mass": _mass(1.0, 90.0)}, asked, right, 1e-3, _WHY, each=True)


def _sought(study: Draft, runs: int, **more: Any) -> Draft:
    return {**study, "optimise": {"runs": runs, **more}}


def _best(found: Draft) -> list[float]:
    return [found["value"], *(one["value"] for one in found["design"])]


@capability("sweeps: the best within a limit, and of what scatters", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """The fastest mass by a force, and the least force of a scattered speed, beside the case as it is written."""
    k, other = (float(f"{one:.4g}") for one in (rng.uniform(0.8e6, 1.2e6), rng.uniform(0.8, 1.2)))
    slow = float(f"{rng.uniform(0.5, 0.6):.3g}")
    speeds = [slow, 1.0, 1.3]
    share = rng.uniform(0.4, 0.5)  # of the momentum's, m / (m + M)
    most = float(f"{slow * np.sqrt(k * share * other):.6g}")
    study = _study(k, 1.0, 1.0)
    within = _sought(study, 90, maximise=_SPEED, limits={_FORCE: f"{most} N"}, vary={
        "bodies.ball.mass": {"from": "0.1 kg", "to": "2 kg"},
        "bodies.ball.speed": {"values": [f"{one} m/s" for one in speeds]},
    })  # fmt: skip
    seed, samples = int(rng.integers(1, 99)), 10
    robust = _sought(
        {**study, "vary": {"bodies.ball.speed": {"uniform": ["0.8 m/s", "1.2 m/s"]}}}, 250, seed=seed, minimise=_FORCE,
        robust={"over": ["bodies.ball.speed"], "quantile": "80 %", "samples": samples},
        vary={"bodies.ball.mass": {"from": "0.5 kg", "to": "2 kg"}},
    )  # fmt: skip

    def asked(model: Model, door: Door) -> Floats:
        words = ("--no-pictures", "--workers", "1")
        one = door.ask(model["within"], "optimise", *words, first=model["before"], mass=model["mass"])
        two = door.ask(model["robust"], "optimise", *words, mass=model["mass"])
        door.told = []
        written = two["references"][0]
        chosen, limit = two["design"][0], one["limits"][0]
        keys = [f"{one}{end}" for one in ("value", "mean") for end in ("", "_less_this", "_less_this_percent")]
        beside = [written[key] for key in keys]
        ends = [*two["over_the_scatter"], *written["over_the_scatter"]]
        flags = [float(chosen["at"] == "lower"), float(one["feasible"]), float(limit["met"])]
        return np.array([*_best(one), limit["value"], *_best(two), 1e3 * chosen["change_per_percent"] / k**0.5, *ends,
                         *beside, *np.sort(written["design_less_this"]), *flags])  # fmt: skip

    def right(model: Model, _: Door) -> Floats:
        mass = model["share"] * other / (1 - model["share"])
        u = _points("latin hypercube", samples, 1, seed)[:, 0]

        def forces(m: float) -> Floats:
            return np.array([hit(m, 0.8 + 0.4 * one, k, other, 90.0)[0] for one in u])

        best, written = forces(0.5), forces(1.0)
        quantile = [np.quantile(one, 0.8, method=_METHOD) for one in (best, written)]
        less, mean = quantile[0] - quantile[1], (best - written).mean()
        slope = np.quantile(forces(0.515), 0.8, method=_METHOD) - quantile[0]
        beside = [quantile[1], less, 100 * less / quantile[1], written.mean(), mean, 100 * mean / written.mean()]
        ends = [best.min(), best.max(), written.min(), written.max()]
        front = [2 * slow * model["share"], mass, slow, model["most"], quantile[0], 0.5, 1e3 * slope / k**0.5]
        return np.array([*front, *ends, *beside, *np.sort(best - written), 1, 1, 1])

    share = most**2 / (slow**2 * k * other)
    draft = {"within": within, "robust": robust, "mass": _mass(other, 90.0), "share": share, "most": most}
    values = {"mass": np.linspace(0.1, 2.0, 6).round(2).tolist(), "speed": speeds}
    tried = [
        word for key, some in values.items() for word in ("--vary", f"bodies.ball.{key}={','.join(map(str, some))}")
    ]
    swept = ("sweep", "model.yaml", *tried, "--workers", "1", "--no-pictures")
    draft["before"] = [swept] if rng.random() < 0.5 else []  # a search begins at the best rows of a sweep beside it
    return Case(draft, asked, right, 2e-3, f"{_WHY}; the search ends 1e-4 of its ranges from a limit", each=True)


_METHOD: Final = "linear"


def _front_told(found: Draft, sizes: Sequence[float]) -> list[float]:
    """What stands out of a front, from its designs alone."""
    one = np.array([[each["goals"]["bodies.ball.mass"], -each["goals"][_SPEED]] for each in found["front"]])
    low, high = one.min(axis=0), one.max(axis=0)
    corner = high + 0.1 * (high - low)
    widths = np.diff(np.r_[one[:, 0], corner[0]])
    share = float((widths * (corner[1] - one[:, 1])).sum() / np.prod(corner - low))
    bulge = 1 - ((one - low) / (high - low)).sum(axis=1)
    return [share, found["front"][int(bulge.argmax())]["design"], *sizes]


@capability("sweeps: a front of two goals", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """The lightest ball and the fastest mass within a limit: no design is better than another in both."""
    k, other = (float(f"{one:.4g}") for one in (rng.uniform(0.8e6, 1.2e6), rng.uniform(0.8, 1.2)))
    limit = float(f"{rng.uniform(0.8, 1.0):.4g}")
    study = _sought(
        _study(k, 1.0, 1.0), 48, minimise=["bodies.ball.mass"], maximise=[_SPEED], limits={_SPEED: f"{limit} m/s"},
        vary={
            "bodies.ball.mass": {"from": "0.1 kg", "to": "2 kg"},
            "bodies.ball.speed": {"values": ["0.5 m/s", "1 m/s"]},
        },
    )  # fmt: skip

    def asked(model: Model, door: Door) -> Floats:
        found = door.ask(model["study"], "optimise", "--no-pictures", "--workers", "1", mass=model["mass"])
        door.told = []
        goals = np.array([[one["goals"]["bodies.ball.mass"], one["goals"][_SPEED]] for one in found["front"]])
        ends = [found["ends"]["bodies.ball.mass"], found["ends"][_SPEED]]
        inside = (np.diff(goals, axis=0) > 0).all() and goals[:, 1].max() <= limit * (1 + 1e-9)
        off = [abs(hit(m, 1.0, k, other, 90.0)[1] / v - 1) for m, v in goals.tolist()]
        early = [0.0, *(one["share"] for one in found["hypervolume"] if one["designs"] <= 0.8 * found["designs"])]
        before = early[-1]
        share, knee, *first_last = _front_told(found, [found["front"][at]["design"] for at in (0, -1)])
        right = [
            inside, max(off) < 1e-3, found["designs"] == found["runs"], ends == first_last,
            knee == found["knee"], abs(share / found["hypervolume"][-1]["share"] - 1) < 1e-9, found["feasible"],
            found["still_improving"] == (found["spent"] and before < 0.99 * found["hypervolume"][-1]["share"]),
        ]  # fmt: skip
        return np.array([float(one) for one in right])

    return Case({"study": study, "mass": _mass(other, 90.0)}, asked, lambda *_: np.ones(8), 1e-12, "yes or no")


def _dashpot_force(share: float) -> float:
    """Largest force of a mass on a spring with a dashpot of a share of the critical, over that without it."""
    t = np.linspace(0.0, pi, 20001)
    ring = np.sqrt(1 - share**2)
    moved = np.exp(-share * t) * np.sin(ring * t) / ring
    speed = np.exp(-share * t) * (np.cos(ring * t) - share * np.sin(ring * t) / ring)
    return float((moved + 2 * share * speed).max())


@capability("sweeps: the dashpot of the least force", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Between a dashpot that hardly helps and one that pushes at once: a valley, without any limit."""
    k, m, other, v = (float(f"{rng.uniform(*one):.4g}") for one in ((0.8e6, 1.2e6), (0.5, 2), (0.8, 1.2), (0.7, 1.4)))
    study = _study(k, m, v, "15 ms")
    critical = 2 * np.sqrt(k * m * other / (m + other))
    low, high = (float(f"{share * critical:.4g}") for share in (0.05, 0.8))
    study["bodies"]["ball"]["contact"]["damping"] = f"{low} N*s/m"
    sought = _sought(study, 120, minimise=_FORCE, vary={
        "bodies.ball.contact.damping": {"from": f"{low} N*s/m", "to": f"{high} N*s/m"},
    })  # fmt: skip

    def asked(model: Model, door: Door) -> Floats:
        found = door.ask(model["sought"], "optimise", "--no-pictures", "--workers", "1", mass=model["mass"])
        door.told = []
        return np.array([found["value"], found["design"][0]["value"] / critical])

    def right(model: Model, _: Door) -> Floats:
        best = minimize_scalar(_dashpot_force, bounds=(0.05, 0.8), method="bounded", options={"xatol": 1e-6})
        return np.array([v * np.sqrt(k * m * other / (m + other)) * best.fun, best.x])

    why = f"{_WHY}; the valley is flat: a place 2e-3 off it is 1e-6 higher"
    return Case({"sought": sought, "mass": _mass(other, 90.0)}, asked, right, 2e-3, why, each=True)
