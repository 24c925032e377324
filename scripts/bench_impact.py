"""Impact engine against scipy's RK45 (rtol 1e-6) in one run on one thread: CPU seconds, ratios, errors, a flop bound.

The truth of both is the engine itself at a tolerance of 1e-12. Ratios are of one run, since machines are noisy; single
runs are those of a batch, whose tables are made once. Compilation is not counted; what a new process waits for is
printed as the warm start.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg.blas import daxpy

from femstruct.impact.batch import Batch, simulate_batch
from femstruct.impact.exact import COARSE, ORDER, is_piecewise_linear
from femstruct.impact.propagation import PLACES, POINTS, STAGES
from femstruct.impact.scene import Body, Clock, Contact, Link, Scene
from femstruct.impact.simulate import simulate
from femstruct.impact.system import compile_scene
from femstruct.language.cases import read_study
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.workflow.bases import damp_basis, solve_all
from femstruct.workflow.staging import build_scene as staged

FLOOR = Path(__file__).parents[1] / "models" / "floor_tennis_ball.study.yaml"
TOLERANCE = 1e-5  # of the Hertz ball: its error is 1e-9, that of RK45 2e-5


@dataclass(frozen=True)
class Case:
    """A scene on a basis, the same as a right-hand side [displacements; speeds], and its start."""

    name: str
    basis: ModalBasis
    scene: Scene
    clock: Clock
    rate: Callable[[float, np.ndarray], np.ndarray]
    start: np.ndarray


def cpu(call: Callable[[], object], repeats: int = 1) -> float:
    """Least CPU seconds of a call."""
    spent = []
    for _ in range(repeats):
        start = time.process_time()
        call()
        spent.append(time.process_time() - start)
    return min(spent)


def hertz_ball(modes: int = 30) -> Case:
    """Hertz ball on a simply supported plate's modes, 0.5 s."""
    number = np.arange(1, modes + 1)
    frequency, shape = 40.0 * number**1.05, 0.8 * np.sin(0.37 * np.pi * number)
    basis, points = given_modes(list(frequency), [0.01] * modes, {"p": list(shape)})
    k, m, v, w = 1e8, 0.05, 1.0, basis.omega
    scene = Scene((Body("ball", m, -v),), (Contact("c", "ball", points["p"].probe("z"), Hertz(k)),))

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        delta = shape @ y[:modes] - y[modes]
        force = k * delta**1.5 if delta > 0 else 0.0
        speeds = y[modes + 1 : 2 * modes + 1]
        return np.concatenate((speeds, [y[-1]], -shape * force - w**2 * y[:modes] - 0.02 * w * speeds, [force / m]))

    return Case(
        "hertz ball, 30 modes",
        basis,
        scene,
        Clock(0.5, 1e4, tolerance=TOLERANCE),
        rate,
        np.concatenate((np.zeros(2 * modes + 1), [-v])),
    )


def press() -> Case:
    """Press: slider and damper on two modes, linear contacts, a one-way link, 3 ms."""
    basis, points = given_modes(
        [40 / (2 * np.pi), 1777 / (2 * np.pi)], [0.0, 0.0], {"b": [0.14, 0.392], "f": [0.14, -0.07]}
    )
    b, f = points["b"].probe("z"), points["f"].probe("z")
    ks, kd, phi, base = 1.2 * 6000.0**2, 3.5 * 6000.0**2, np.array([0.14, 0.392]), np.array([0.14, -0.07])
    scene = Scene(
        (Body("slider", 1.2, -1.2), Body("damper", 3.5)),
        (Contact("s", "slider", b, Linear(ks)), Contact("d", b, "damper", Linear(kd))),
        (Link("l", "damper", f, 1.8e3, opening=7e2),),
    )
    w = basis.omega

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        bed, under = phi @ y[:2], base @ y[:2]
        slider, damper = max(0.0, ks * (bed - y[2])), max(0.0, kd * (y[3] - bed))
        speed = base @ y[4:6] - y[7]
        link = 1.8e3 * (under - y[3]) + (7e2 * speed if speed < 0 else 0.0)
        modal = phi * (damper - slider) - base * link - w**2 * y[:2]
        return np.concatenate((y[4:], modal, [slider / 1.2, (link - damper) / 3.5]))

    return Case("press, 2 modes", basis, scene, Clock(3e-3, 1e4), rate, np.array([0, 0, 0, 0, 0, 0, -1.2, 0.0]))


def against_rk45(case: Case, truth: float, runs: int = 4096) -> dict[str, float]:
    """One run of a batch beside RK45, by the end velocity of the first body; what a batch costs once is 2 ms."""
    body = case.scene.bodies[0]
    spent = time.process_time()
    end = integrated(case, "RK45", 1e-6, 1e-10)
    slow = time.process_time() - spent
    vary = {f"{body.name}.velocity": np.full(runs, body.velocity)}
    found = batch_of(case, vary)
    fast = cpu(lambda: batch_of(case, vary), 3) / runs
    exact = is_piecewise_linear(compile_scene(case.basis, case.scene, case.clock).system, case.clock.duration)
    floor = multiply_adds(case, int(found.steps[0]), exact) / axpy_rate()
    return {
        f"{case.name}: ms a run": 1e3 * fast,
        f"{case.name}: RK45 ms": 1e3 * slow,
        f"{case.name}: ratio": slow / fast,
        f"{case.name}: error": abs(found.end_velocity[body.name][0] - truth) / abs(truth),
        f"{case.name}: RK45 error": abs(end - truth) / abs(truth),
        f"{case.name}: steps": float(found.steps[0]),
        f"{case.name}: flop bound ms": 1e3 * floor,
        f"{case.name}: part of the bound": floor / fast,
    }


def integrated(case: Case, method: str, rtol: float, atol: float) -> float:
    """End velocity of the first body by scipy."""
    span = (0.0, case.clock.duration)
    found = solve_ivp(case.rate, span, case.start, method, t_eval=span[1:], rtol=rtol, atol=atol)
    return float(found.y[len(case.start) // 2 + len(case.basis.omega), -1])


def batch_of(case: Case, vary: dict[str, np.ndarray], tolerance: float | None = None) -> Batch:
    """Runs of a case on one thread, at its own tolerance if none is given."""
    clock = case.clock if tolerance is None else replace(case.clock, tolerance=tolerance)
    return simulate_batch(case.basis, case.scene, clock, vary, 1)


def multiply_adds(case: Case, steps: int, exact: bool) -> float:
    """What the march must do at least. Collocation, per step: free motion at the points, modal forces, flow, the loss
    form, and three Newton rounds for the rows. Exact march, per term of the series: coordinates and rows, and the state
    at the end; and one look at every row."""
    n, r = len(case.basis.omega) + len(case.scene.bodies), len(case.scene.contacts) + len(case.scene.links)
    if exact:
        return float(steps * (ORDER * (n * (2 * r + 3) + 4 * r + 2 * n) + r * (COARSE + 1) ** 2 / 2))
    modes = n * (4 * r * POINTS + r * STAGES + 2 * (2 + STAGES) + (STAGES + 2) * (STAGES + 3) + 4 * r)
    rows = 3 * (2 * r * r * POINTS * STAGES + r * STAGES**2 + (r * STAGES) ** 3 / 3) + r * PLACES**2
    return float(steps * (modes + rows))


def axpy_rate(length: int = 1024) -> float:
    """Multiply-adds per second of y += a x in the first cache."""
    x, y = np.ones(length), np.zeros(length)
    repeats = 20_000
    return length * repeats / cpu(lambda: [daxpy(x, y, a=0.5) for _ in range(repeats)], 3)


def many(case: Case, runs: int = 10_000) -> dict[str, float]:
    """As many different hits by the first body."""
    body, rng = case.scene.bodies[0], np.random.default_rng(1)
    vary = {
        f"{body.name}.velocity": body.velocity * rng.uniform(0.5, 2.0, runs),
        f"{body.name}.mass": body.mass * rng.uniform(0.5, 2.0, runs),
    }
    return {f"{case.name}: {runs:,} runs, s": cpu(lambda: batch_of(case, vary))}


def press_map(side: int = 100) -> dict[str, float]:
    """Mass and link stiffness of the press's damper, a map of side x side runs."""
    mass, stiffness = (grid.ravel() for grid in np.meshgrid(np.linspace(1, 8, side), np.linspace(5e2, 5e3, side)))
    case, vary = press(), {"damper.mass": mass, "l.stiffness": stiffness}
    return {f"press map {side} x {side}, s": cpu(lambda: batch_of(case, vary))}


def floor() -> dict[str, float]:
    """The shipped floor with ball, damper and one-way link, 2 s: in full, and a run of a batch."""
    plan = read_study(FLOOR)
    solved = solve_all(plan.cases)
    baseline = next(case for case in plan.cases if case.name == plan.baseline)
    case = next(case for case in plan.cases if case.name == "damper 0.6")
    basis, time_plan = damp_basis(case, solved, baseline), case.study.time
    assert time_plan is not None
    scene, clock = staged(case.study, solved[case.name].places, basis), Clock(time_plan.duration, time_plan.sampling)
    vary = {"damper.mass": np.linspace(0.3, 0.9, 64)}
    simulate_batch(basis, scene, clock, vary, 1)
    return {
        "floor, 97 modes: simulate ms": 1e3 * cpu(lambda: simulate(basis, scene, clock), 2),
        "floor, 97 modes: ms a run": 1e3 * cpu(lambda: simulate_batch(basis, scene, clock, vary, 1)) / 64,
    }


def warm_start() -> dict[str, float]:
    """CPU seconds until a new process has its kernels, imports apart."""
    code = (
        "import time; from femstruct.impact.simulate import BY_COLLOCATION as units; "
        "from femstruct.compiled.store import native; s = time.process_time(); "
        "[native(unit) for unit in units]; print(time.process_time() - s)"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {"warm start, s": float(answer.stdout)}


def cold_kernels() -> dict[str, float]:
    """Seconds to compile all kernels, as the clock has them and of all processes."""
    code = (
        "import os, time; from femstruct.impact.simulate import ALL; "
        "from femstruct.compiled.store import code_of; s = time.monotonic(); "
        "code_of(ALL); print(time.monotonic() - s, sum(os.times()[:4]))"
    )
    with tempfile.TemporaryDirectory() as empty:
        answer = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "FEMSTRUCT_CACHE": empty},
        )
    wall, used = (float(number) for number in answer.stdout.split())
    return {"cold kernels, s": wall, "cold kernels, CPU s": used}


def main() -> Iterator[tuple[str, float]]:
    """All values by name, as they come."""
    ball, two = hertz_ball(), press()
    yield "load average", os.getloadavg()[0]
    for case in (ball, two):  # compiles, or loads, and is not timed
        batch_of(case, {f"{case.scene.bodies[0].name}.velocity": np.full(2, -1.0)})
    yield from against_rk45(two, integrated(two, "DOP853", 1e-13, 1e-16)).items()
    yield from press_map().items()
    yield from against_rk45(
        ball, float(batch_of(ball, {"ball.velocity": -np.ones(1)}, 1e-12).end_velocity["ball"][0])
    ).items()
    yield from many(ball).items()
    yield from floor().items()
    yield from warm_start().items()
    yield from cold_kernels().items()
    yield "load average", os.getloadavg()[0]


if __name__ == "__main__":
    for name, value in main():
        print(f"{name:40s} {value:12.4g}", flush=True)
