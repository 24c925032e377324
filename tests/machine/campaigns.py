"""Sweeps and searches: each row against events in scipy, and the best of what was tried."""

from __future__ import annotations

import copy
from itertools import product
from typing import Any

import numpy as np

from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.impacts import clear, expected_of_given_modes, numbers_right, oscillator, path_of, scene, times_of
from tests.machine.laws import LAWS

_WHY = "both integrate to 1e-9 and better; peaks of motions between samples 1/200 of the window apart"


def _struck(rng: np.random.Generator) -> dict[str, Any]:
    """A body on an oscillator; some laws count their dashpot with its mass, which is varied."""

    def draw() -> dict[str, Any]:
        structure = oscillator(rng)
        structure["structure"] = {"type": "oscillator", "mass": structure["structure"]["mass"], "frequency": 20.0}
        structure["structure"]["frequency"] = float(f"{rng.uniform(5, 60):.4g}")
        return scene(rng, structure, str(rng.choice(LAWS)), turns=float(rng.uniform(2, 5)))

    return dict(clear(draw, numbers_right))


def _axes(rng: np.random.Generator, model: Model) -> dict[str, list[float]]:
    """What is varied, and its values."""
    mass, f = model["study"]["bodies"]["a"]["mass"], model["structure"]["structure"]["frequency"]
    return {
        "bodies.a.mass": [float(f"{mass * one:.4g}") for one in np.sort(rng.uniform(0.5, 2, 3))],
        "structure.frequency": [float(f"{f * one:.4g}") for one in np.sort(rng.uniform(0.7, 1.5, 2))],
    }


def _row(model: Model, mass: float, frequency: float) -> dict[str, Any]:
    other: Any = copy.deepcopy(model)
    other["study"]["bodies"]["a"]["mass"] = mass
    other["structure"]["structure"]["frequency"] = frequency
    return {"study": other["study"], "structure": other["structure"]}


def _contact(model: Model) -> str:
    return "hit" if "hit" in model["study"].get("contacts", {}) else "a on m"


def _peak(model: Model) -> list[float]:
    """Of the contact force, and of the structure's displacement."""
    path = path_of(model)
    return [path.peak(_contact(model)), float(np.abs(path.moved("m", times_of(model))).max())]


def _said(model: Model) -> tuple[dict[str, Any], dict[str, Any]]:
    study = {"model": "structure.yaml", **model["study"]}
    return study, {"structure": model["structure"]}


def _number(row: Model, name: str) -> float:
    return float(row["cases"]["as given"]["numbers"][name])


@capability("sweeps: rows of a grid", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    model = _struck(rng)
    model["vary"] = _axes(rng, model)

    def asked(model: Model, door: Door) -> Floats:
        study, beside = _said(model)
        words = [word for key, values in model["vary"].items() for word in ("--vary", f"{key}={_list(values)}")]
        found = door.ask(study, "sweep", *words, "--workers", "1", "--no-pictures", **beside)
        door.told = [one for one in door.told if not expected_of_given_modes(one)]
        names = (f"{_contact(model)} peak force", "m.z displacement")
        return np.array([[_number(row, name) for name in names] for row in found["samples"]]).T.ravel()

    def right(model: Model, _: Door) -> Floats:
        rows = [_peak(_row(model, *pair)) for pair in product(*model["vary"].values())]
        return np.array(rows).T.ravel()

    return Case(model, asked, right, 2e-4, _WHY, each=True)


def _list(values: list[float]) -> str:
    return ",".join(repr(one) for one in values)


@capability("sweeps: the best of some designs", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """The least force among designs that keep a limit on the motion of the structure."""
    while True:  # until no two designs are equally good, as where the first push of a dashpot is the largest
        model = _struck(rng)
        axes = _axes(rng, model)
        rows = {pair: _peak(_row(model, *pair)) for pair in product(*axes.values())}
        forces = np.sort([row[0] for row in rows.values()])
        if (np.diff(forces) > 1e-5 * forces[-1]).all():
            break
    moved = sorted(row[1] for row in rows.values())
    limit = float(f"{0.5 * (moved[3] + moved[4]):.6g}")
    model |= {"vary": axes, "limit": limit}

    def asked(model: Model, door: Door) -> Floats:
        study, beside = _said(model)
        name = f"{_contact(model)} peak force"
        words = [word for key, values in model["vary"].items() for word in ("--vary", f"{key}={_list(values)}")]
        words += ["--minimise", name, "--limit", f"m.z displacement={model['limit']} m", "--runs", "40"]
        found = door.ask(study, "optimise", *words, "--workers", "1", "--no-pictures", **beside)
        door.told = [one for one in door.told if not expected_of_given_modes(one)]
        return np.array([found["value"], *(one["value"] for one in found["design"])])

    def right(model: Model, _: Door) -> Floats:
        rows = {pair: _peak(_row(model, *pair)) for pair in product(*model["vary"].values())}
        pair = min((one for one in rows if rows[one][1] <= model["limit"]), key=lambda one: rows[one][0])
        return np.array([rows[pair][0], *pair])

    return Case(model, asked, right, 2e-4, _WHY, each=True)


@capability("sweeps: cases of other structures and other damping", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """A case that changes the structure alone has the law of the baseline, whichever that is, and its exceptions, which
    follow their mode; one that changes the damping has its own. By histories or by the engine of many impacts at once.
    """
    model = _struck(rng)
    own = model["structure"]["structure"]["frequency"]
    hz = {"own": own, "stiff": float(f"{own * rng.uniform(1.3, 2.5):.4g}"), "lossy": own}
    mode = bool(rng.random() < 0.5)
    size = {"own": float(f"{rng.uniform(0.02, 0.1):.4g}"), "lossy": float(f"{rng.uniform(0.12, 0.3):.4g}")}
    laws: dict[str, Any] = {one: {"rayleigh": {"alpha": f"{ratio * 12.6 * own!r} 1/s"}} for one, ratio in size.items()}
    if mode:
        laws = {one: {"ratio": 0.01, "modes": {"1": {"ratio": ratio, "near": own}}} for one, ratio in size.items()}
    changed = {"damping.modes.1.ratio": size["lossy"]} if mode else {"damping": laws["lossy"]}
    cases: dict[str, Any] = {"own": {}, "stiff": {"structure.frequency": hz["stiff"]}, "lossy": changed}
    order = [str(one) for one in rng.permutation(list(cases))]
    model |= {"cases": {one: cases[one] for one in order}}
    model["baseline"] = str(rng.choice([one for one in order if one != "stiff" or not mode]))
    model["masses"] = _axes(rng, model)["bodies.a.mass"][:2]
    some = bool(rng.random() < 0.6)

    def asked(model: Model, door: Door) -> Floats:
        study, beside = _said(model)
        study |= {"cases": model["cases"], "compare": {"baseline": model["baseline"]}}
        beside["structure"] = {**model["structure"], "damping": laws["own"]}
        names = (f"{_contact(model)} peak force", "m.z displacement")
        words = ["--vary", f"bodies.a.mass={_list(model['masses'])}", "--workers", "1", "--no-pictures"]
        words += [word for name in names for word in ("--only", name)] * some
        found = door.ask(study, "sweep", *words, **beside)
        door.told.clear()
        rows = [row["cases"][case]["numbers"] for row in found["samples"] for case in sorted(cases)]
        return np.array([[float(row[name]) for name in names] for row in rows]).T.ravel()

    def right(model: Model, _: Door) -> Floats:
        rows = []
        for mass in model["masses"]:
            for case in sorted(cases):
                of = case if case != "stiff" else "lossy" if model["baseline"] == "lossy" else "own"
                one = _row(model, mass, hz[case])
                falls = 1.0 if mode else 12.6 * own / (4 * np.pi * hz[case])  # alpha / 2 w
                one["structure"]["damping"] = {"ratio": size[of] * falls}
                rows.append(_peak(one))
        return np.array(rows).T.ravel()

    return Case(model, asked, right, 2e-4, _WHY, each=True)
