"""Impact engine against scipy's RK45 (rtol 1e-6) in one run: CPU seconds, ratios, errors. Prints a table.

The truth of both is the engine itself at a tolerance of 1e-12.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from femstruct.impact.bodies import Body, Clock, Contact, Link, Scene
from femstruct.impact.laws import Hertz, Linear
from femstruct.impact.simulate import simulate
from femstruct.modal.analytic import given_modes


def cpu(call: Callable[[], object], repeats: int) -> float:
    """Least CPU seconds of a call."""
    spent = []
    for _ in range(repeats):
        start = time.process_time()
        call()
        spent.append(time.process_time() - start)
    return min(spent)


def hertz_ball(modes: int = 30) -> dict[str, float]:
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

    start = np.concatenate((np.zeros(2 * modes + 1), [-v]))
    return _compare("hertz ball", lambda tol: simulate(basis, scene, Clock(0.5, 4e3, tolerance=tol)), rate, start)


def two_modes() -> dict[str, float]:
    """Press: slider and damper on two modes, linear contacts, 3 ms."""
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

    start = np.array([0, 0, 0, 0, 0, 0, -1.2, 0.0])
    return _compare("press", lambda tol: simulate(basis, scene, Clock(3e-3, 1e4, tolerance=tol)), rate, start)


def _compare(
    name: str, run: Callable[[float], object], rate: Callable[..., np.ndarray], y: np.ndarray
) -> dict[str, float]:
    truth, ours = run(1e-12), run(1e-8)
    body = next(iter(truth.bodies))  # type: ignore[attr-defined]
    end = truth.t[-1]  # type: ignore[attr-defined]

    def reference() -> np.ndarray:
        return solve_ivp(rate, (0.0, end), y, "RK45", rtol=1e-6, atol=1e-10).y[:, -1]

    fast, slow = cpu(lambda: run(1e-8), 5), cpu(reference, 1)
    exact = truth.bodies[body].velocity[-1]  # type: ignore[attr-defined]
    n = len(y) // 2
    k = n - len(truth.bodies)  # type: ignore[attr-defined]
    return {
        f"{name}: engine ms": 1e3 * fast,
        f"{name}: RK45 ms": 1e3 * slow,
        f"{name}: ratio": slow / fast,
        f"{name}: engine error": abs(ours.bodies[body].velocity[-1] - exact) / abs(exact),  # type: ignore[attr-defined]
        f"{name}: RK45 error": abs(reference()[n + k] - exact) / abs(exact),
    }


def main() -> dict[str, float]:
    """All cases; values by name."""
    return {**hertz_ball(), **two_modes()}


if __name__ == "__main__":
    for name, value in main().items():
        print(f"{name:28s} {value:12.4g}")
