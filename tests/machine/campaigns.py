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
