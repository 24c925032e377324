"""Orders of the march on a smooth law, fitted over lengths of one step, against DOP853 at its tightest tolerance.

The contact closes at t = 0 and stays closed: a stiffening spring with a dashpot that is its factor, smooth where
indented, so that nothing but the polynomials of the step is wrong. `test_impact_hertz` has the order of an onset.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from femstruct.impact.collocation import CollocationSteps, collocation_workspace, integrate, levels_for, state_at_start
from femstruct.impact.contact_events import DONE, STEPS, empty_record
from femstruct.impact.propagation import STAGES, collocation_rule, tabulated
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.system import compile_scene
from femstruct.laws.cubic import Cubic
from femstruct.modal.closed_form import given_modes

NONE = given_modes([], [], {})[0]
CUBIC, DISSIPATION, WEIGHT = 1.0, 1.0, 0.3  # stiffness and mass are 1
SCENE = Scene(
    (Body("b", 1.0, -1.0, falls=True),),
    (Contact("c", "b", GROUND, Cubic(1.0, CUBIC, DISSIPATION, tensile=True)),),
    gravity=WEIGHT,
)


def one_step(length: float) -> tuple[np.ndarray, float]:
    """Displacement and velocity of the body, and the largest force, after one step whatever its error."""
    compiled = compile_scene(NONE, SCENE, Clock(length, 1.0 / length))
    system, state, record = compiled.system, state_at_start(compiled), empty_record(compiled.system, 0)
    level = compiled.halvings
    tables = tabulated(system, levels_for(level), collocation_rule())
    steps = CollocationSteps(level, top_level=level, tolerance=np.inf, max_steps=10, paced=10)
    how = integrate(system, state, tables, collocation_workspace(system), record, steps)
    assert (how, record.totals[STEPS]) == (DONE, 1.0)
    return np.concatenate((state.z, state.v)), float(record.peak[0, 0])


def exact(length: float) -> tuple[np.ndarray, float]:
    """The same by scipy; the force grows to the end."""

    def force(y: np.ndarray) -> float:
        return float((-y[0] - CUBIC * y[0] ** 3) * (1.0 - DISSIPATION * y[1]))

    run = solve_ivp(
        lambda _, y: [y[1], force(y) - WEIGHT], (0.0, length), [0.0, -1.0], "DOP853", rtol=1e-13, atol=1e-15,
        max_step=length / 20,
    )  # fmt: skip
    return run.y[:, -1], force(run.y[:, -1])


def order(lengths: np.ndarray, errors: list[float]) -> float:
    return float(np.polyfit(np.log(lengths), np.log(errors), 1)[0])


def test_a_step_is_wrong_by_twice_the_points() -> None:
    """Gauss's points: the state after a step of h is wrong by h^(2 s + 1), so that a march of equal steps is of order
    2 s. Single pairs of lengths scatter: the parts of the error change their signs at lengths of their own."""
    lengths = np.geomspace(0.6, 1.2, 25)
    errors = [float(np.linalg.norm(one_step(h)[0] - exact(h)[0])) for h in lengths]
    assert 1e-13 < min(errors) < 1e-11 < 1e-9 < max(errors)  # above rounding, of scipy too, over four decades
    assert abs(order(lengths, errors) - (2 * STAGES + 1)) < 0.7  # measured 17.1


def test_forces_inside_a_step_are_of_the_order_of_the_points() -> None:
    """The polynomial through s points misses h^s of the force at the end of the step, where it is largest."""
    lengths = np.geomspace(0.07, 0.2, 15)
    errors = [abs(one_step(h)[1] - exact(h)[1]) for h in lengths]
    assert 1e-14 < min(errors) < 1e-12 < 1e-10 < max(errors)  # above rounding, over two decades
    assert abs(order(lengths, errors) - STAGES) < 0.4  # measured 8.2
