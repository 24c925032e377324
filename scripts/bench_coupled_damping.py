"""Simulation of modes that damping couples, as wool in a cavity does, against the same modes damped one by one.

CPU seconds of one run on one thread, and their ratio: a ball of 2.5 kg on a floor of 100 modes over a ceiling of 100
with 60 to 400 modes of the air between. Wool takes 8300 1/s from the air. What is made once for a basis, the complex
modes and their oscillators, is printed by itself; compilation is not counted. Then frequency responses of the same
modes, against a dense solution of each line. At the end the shipped joist floor under the rubber ball, with wool and
without; its bases take a minute.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from femstruct.impact.batch import simulate_batch
from femstruct.impact.scene import Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.cases import read_study
from femstruct.laws.hertz import Hertz
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.modal.damping import with_damping
from femstruct.modal.frf import frf
from femstruct.modal.oscillators import oscillators_of
from femstruct.model.probe import Probe
from femstruct.workflow.bases import add_cavities, solve
from femstruct.workflow.staging import build_scene as staged

STRUCTURE = 100  # modes of the floor, and as many of the ceiling, up to REACH
REACH = 450.0  # [Hz]; modes of the air reach ten times as far
MODEL = Path(__file__).parents[1] / "models" / "joist_ceiling.study.yaml"
WOOL = 8300.0  # [1/s]: 10 kPa s/m2 over the density of the air


def floor_with_wool(air: int, seed: int = 0) -> tuple[ModalBasis, ModalBasis, Probe]:
    """(damped one by one, with wool, a point of the floor): made-up modes, near ones of them mixed by the wool."""
    rng = np.random.default_rng(seed)
    spread = [np.linspace(5.0, REACH, STRUCTURE), np.linspace(6.0, REACH, STRUCTURE), np.linspace(20, 10 * REACH, air)]
    hz = np.sort(np.concatenate(spread))
    k, omega = len(hz), 2.0 * np.pi * hz
    near = np.exp(-np.abs(np.log(hz[:, None] / hz)) / 0.3)
    turn, _ = np.linalg.qr(np.eye(k) + 0.1 * near * rng.standard_normal((k, k)))
    rates = np.zeros(k)
    rates[rng.permutation(k)[:air]] = WOOL
    basis, points = given_modes(list(hz), [0.015] * k, {"p": list(0.06 * rng.standard_normal(k))})
    wool = (turn.T * rates) @ turn + np.diag(0.03 * omega)
    return basis, replace(basis, viscous=0.5 * (wool + wool.T)), points["p"].probe("z")


def seconds(call: Callable[[], object], repeats: int = 3) -> float:
    """Least CPU seconds of a call."""
    spent = []
    for _ in range(repeats):
        start = time.process_time()
        call()
        spent.append(time.process_time() - start)
    return min(spent)


def struck(place: Probe, law: Law) -> Scene:
    """A ball of 2.5 kg at 5 m/s."""
    return Scene((Body("ball", 2.5, -5.0),), (Contact("c", "ball", place, law),), gravity=9.81)


def frequency_responses(wool: ModalBasis, place: Probe) -> Iterator[tuple[str, float]]:
    """A point receptance of 4,000 lines, against numpy's solution of one in forty of them."""
    hz, k = np.linspace(5.0, REACH, 4000), len(wool.omega)
    some = 2.0 * np.pi * hz[::40]
    shape = place.of(wool.shapes)

    def dense() -> np.ndarray:
        left = [np.diag(wool.omega**2 - w**2) + 1j * (w * wool.viscous + wool.hysteretic) for w in some]
        return np.array([shape @ np.linalg.solve(one, shape) for one in left])

    found = frf(wool, place, place, hz)[::40]
    yield f"{k} modes, frf: largest difference [1]", float(np.abs(found - dense()).max() / np.abs(found).max())
    spent = {"frf": seconds(lambda: frf(wool, place, place, hz)) / len(hz), "dense": seconds(dense) / len(some)}
    for name, cpu in spent.items():
        yield f"{k} modes, {name}: ms a line", 1e3 * cpu
    yield f"{k} modes, frf: ratio", spent["frf"] / spent["dense"]


def joist_floor() -> Iterator[tuple[str, float]]:
    """The joist floor with a ceiling on hangers under the rubber ball, with loose and with held wool and without."""
    shipped, held = (read_study(MODEL, overrides) for overrides in ((), ("cavities.void.fill.frame=held",)))
    asked = {"no wool": (shipped, "no wool"), "loose wool": (shipped, "wool"), "held wool": (held, "wool")}
    runs = {}
    for name, (plan, wanted) in asked.items():
        case = next(one for one in plan.cases if one.name == wanted)
        solved = solve(case.study.structure, case.study.extent, case.studies)
        basis = add_cavities(with_damping(solved.basis, case.study.damping), solved)
        scene = staged(next(iter(case.drops.values())), solved.places, basis)
        runs[name] = (basis, scene, Clock(1.5, 5e3))
        found = oscillators_of(basis)
        assert found is not None
        yield f"joist floor, {name}: oscillators", len(found.omega)
        simulate(*runs[name])
    spent = {name: seconds(lambda run=run: simulate(*run), 6) for name, run in runs.items()}
    for name, cpu in spent.items():
        yield f"joist floor, {name}: simulate ms", 1e3 * cpu
    for name in ("loose wool", "held wool"):
        yield f"joist floor, {name}: ratio", spent[name] / spent["no wool"]


def main() -> Iterator[tuple[str, float]]:
    """All values by name, as they come."""
    yield "load average", os.getloadavg()[0]
    for air in (60, 400):
        plain, wool, place = floor_with_wool(air)
        name = f"{len(wool.omega)} modes"
        yield f"{name}: oscillators, once, s", seconds(lambda w=wool: oscillators_of(w), 1)
        for kind, law, clock in (
            ("collocation", Hertz(3e6), Clock(0.5, 20e3)),
            ("exact march", Linear(2e5), Clock(0.1, 20e3)),
        ):
            scene, spent = struck(place, law), {}
            for which, basis in (("diagonal", plain), ("wool", wool)):
                simulate(basis, scene, Clock(1e-3, 20e3))
                spent[which] = seconds(lambda b=basis, s=scene, c=clock: simulate(b, s, c))
                yield f"{name}, {kind}, {which}: simulate ms", 1e3 * spent[which]
            yield f"{name}, {kind}: ratio", spent["wool"] / spent["diagonal"]
        vary, clock = {"ball.velocity": -np.linspace(3.0, 6.0, 16)}, Clock(0.1, 20e3)
        scene, spent = struck(place, Hertz(3e6)), {}
        for which, basis in (("diagonal", plain), ("wool", wool)):
            spent[which] = seconds(lambda b=basis, s=scene, v=vary, c=clock: simulate_batch(b, s, c, v, 1), 1)
            yield f"{name}, batch of 16, {which}: ms a run", 1e3 * spent[which] / 16
        yield f"{name}, batch of 16: ratio", spent["wool"] / spent["diagonal"]
        yield from frequency_responses(wool, place)
    yield from joist_floor()
    yield "load average", os.getloadavg()[0]


if __name__ == "__main__":
    for name, value in main():
        print(f"{name:45s} {value:12.4g}", flush=True)
