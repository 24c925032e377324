"""Hertz impacts at the strictest setting, and their error estimate, against DOP853 at its tightest tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from femstruct.impact.collocation import collocate, levels_for, state_at_start
from femstruct.impact.contact_events import empty_record
from femstruct.impact.numerical_error import STRICTEST, error_of
from femstruct.impact.propagation import collocation_rule, tabulated
from femstruct.impact.response import Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.impact.system import compile_scene
from femstruct.language.cases import read_study
from femstruct.laws.hertz import Hertz
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import beam, given_modes
from femstruct.model.probe import Probe
from femstruct.workflow.bases import damp_basis, solve_all
from femstruct.workflow.staging import build_scene

ROUNDING = 1e-10  # steps and rounding: 2e-13 here at most

ACCURACY = 1e-6  # what is asked of a peak force
MODELS = Path(__file__).parents[2] / "models"
NONE = given_modes([], [], {})[0]


@dataclass(frozen=True, eq=False)
class Hit:
    """A body of `mass` meets a place of modes with `speed`: force d^0.5 (k d + c d'), never pulling, no gap."""

    mass: float
    speed: float
    k: float
    basis: ModalBasis
    shape: np.ndarray
    c: float = 0.0

    @property
    def contact_time(self) -> float:
        """On a wall."""
        return 2.9433 * (5 * self.mass * self.speed**2 / (4 * self.k)) ** 0.4 / self.speed

    def force(self, y: np.ndarray) -> np.ndarray:
        n = len(self.shape)
        d, u = self.shape @ y[:n] - y[n], self.shape @ y[n + 1 : -1] - y[-1]
        return np.maximum(np.maximum(d, 0.0) ** 0.5 * (self.k * d + self.c * u), 0.0)

    def reference(self, until: float, times: np.ndarray) -> tuple[np.ndarray, float]:
        """Forces at times, and the largest force."""
        n, p, w = len(self.shape), self.shape, self.basis.omega
        stiffness, damping = w**2, np.diag(self.basis.time_damping)

        def rate(_: float, y: np.ndarray) -> np.ndarray:
            q, u = y[:n], y[n + 1 : -1]
            f = float(self.force(y))
            return np.concatenate((y[n + 1 :], -p * f - stiffness * q - damping * u, [f / self.mass]))

        def turns(t: float, y: np.ndarray) -> float:
            """Rate of the force, times d^0.5."""
            d, u, a = (float(p @ part[:n] - part[n]) for part in (y, y[n + 1 :], rate(t, y)[n + 1 :]))
            return 1.5 * self.k * d * u + self.c * (0.5 * u**2 + d * a)

        start = np.zeros(2 * n + 2)
        start[-1] = -self.speed

        def run(end: float, at: np.ndarray | None) -> Any:
            return solve_ivp(
                rate, (0.0, end), start, "DOP853", t_eval=at, events=turns, rtol=1e-13,
                atol=1e-15 * self.speed * self.contact_time, first_step=1e-6 * self.contact_time,
            )  # fmt: skip

        path = run(until, times)
        top = int(np.argmax(self.force(path.y_events[0].T)))
        # once more, to end there: between its steps DOP853 is less accurate than at their ends
        peak = float(self.force(run(path.t_events[0][top], None).y[:, -1]))
        return self.force(path.y), peak

    def simulated(self, place: object, clock: Clock) -> Response:
        contact = Contact("c", "b", place, Hertz(self.k, self.c))  # type: ignore[arg-type]
        return simulate(self.basis, Scene((Body("b", self.mass, -self.speed),), (contact,)), clock)


def test_two_spheres() -> None:
    """Peak force of a free collision in closed form, at the strictest setting and, within its estimate, at others."""
    masses, speeds, k = (0.2, 0.7), (-2.0, 0.5), 1e8
    reduced, meeting = np.prod(masses) / sum(masses), speeds[1] - speeds[0]
    peak = k * (5 * reduced * meeting**2 / (4 * k)) ** 0.6
    lasting = 2.9433 * (5 * reduced * meeting**2 / (4 * k)) ** 0.4 / meeting
    scene = Scene(
        (Body("a", masses[0], speeds[0]), Body("b", masses[1], speeds[1])), (Contact("c", "a", "b", Hertz(k)),)
    )
    after = (np.dot(masses, speeds) + masses[0] * -meeting) / sum(masses)  # elastic: b leaves a at the speed they met
    for tolerance in (1e-2, 1e-7, 1e-8, 1e-9, STRICTEST):
        response = simulate(NONE, scene, Clock(1.5 * lasting, 200 / lasting, tolerance=tolerance))
        estimate = error_of(response)
        found = estimate.first_peak["c"]
        assert abs(found.value - peak) <= 3 * found.error
        assert abs(response.bodies["b"].velocity[-1] - after) <= 3 * estimate.velocity["b"].error
        assert found.relative < ACCURACY
        assert found.value == response.contacts["c"].peak_force  # the estimate is of the run that was made
    assert abs(found.value - peak) < 1e-13 * peak  # rounding of some hundred steps


def test_order_of_equal_steps_is_that_of_the_onset() -> None:
    """Steps halved, none chosen by its error: d^1.5 begins like t^1.5, which no polynomial follows, so the impulse of
    the first step and with it the peak force is wrong by h^2.5. Chosen steps get to rounding (above)."""
    mass, speed, k = 1.0, 1.0, 1e6
    peak = k * (5 * mass * speed**2 / (4 * k)) ** 0.6
    lasting = 2.9433 * (5 * mass * speed**2 / (4 * k)) ** 0.4 / speed
    scene = Scene((Body("b", mass, -speed),), (Contact("c", "b", GROUND, Hertz(k)),))
    compiled = compile_scene(NONE, scene, Clock(64 * lasting, 8 / lasting))
    errors = []
    for halvings in range(6):
        record = empty_record(compiled.system, compiled.n_samples)
        tables = tabulated(compiled.system, levels_for(compiled.halvings), collocation_rule())
        collocate(compiled, np.inf, tables, state_at_start(compiled), record, halvings)
        errors.append(abs(record.peak[0, 0] / peak - 1))
    orders = -np.diff(np.log2(errors))
    assert orders == pytest.approx(2.5, abs=0.02)  # measured 2.499 to 2.501


def test_sphere_on_supported_beam_with_sub_impacts() -> None:
    """Timoshenko's sphere of 20 mm on a beam of 10 x 10 x 307 mm, 20 modes: every sub-impact's force, 1e-6."""
    E, rho, nu, radius, length, speed = 2.16e11, 7960.0, 0.3, 0.02, 0.307, 0.01
    mass, k = 4 / 3 * np.pi * radius**3 * rho, 4 / 3 * E / (2 * (1 - nu**2)) * np.sqrt(radius)
    basis, points = beam(length, E * 0.01**4 / 12, rho * 1e-4, ("pinned", "pinned"), 20, {"mid": length / 2})
    place = points["mid"].probe("z")
    hit = Hit(mass, speed, k, basis, place.of(basis.shapes))
    clock = Clock(2e-3, 1e6, tolerance=STRICTEST)
    response = hit.simulated(place, clock)
    contact = response.contacts["c"]
    forces, peak = hit.reference(clock.duration, response.t)
    starts = [event.t for event in response.events if event.what == "closes"]
    assert len(starts) >= 2  # the case is what it says
    for begin, end in zip(starts, [*starts[1:], np.inf], strict=True):
        within = (response.t >= begin) & (response.t < end)
        largest = forces[within].max()
        assert contact.force[within].max() == pytest.approx(largest, rel=ACCURACY)
        assert np.abs(contact.force[within] - forces[within]).max() < ACCURACY * largest
    assert contact.peak_force == pytest.approx(peak, rel=ACCURACY)


@pytest.mark.parametrize(("mass", "k", "c"), [(0.054, 3.7e5, 150.0), (0.045, 3.3e7, 500.0)], ids=["tennis", "acrylic"])
def test_ball_on_a_floor_of_many_modes(mass: float, k: float, c: float) -> None:
    """The balls of the shipped floors, dropped from 0.23 m on 30 damped modes up to 3 kHz: peak force, 1e-6."""
    rng = np.random.default_rng(5)
    modes, points = given_modes(
        np.linspace(20.0, 3000.0, 30).tolist(), [0.02] * 30, {"p": rng.normal(0.0, 0.6, 30).tolist()}
    )
    place = points["p"].probe("z")
    hit = Hit(mass, (2 * 9.81 * 0.23) ** 0.5, k, modes, place.of(modes.shapes), c)
    clock = Clock(4 * hit.contact_time, 100 / hit.contact_time, tolerance=STRICTEST)
    response = hit.simulated(place, clock)
    _, peak = hit.reference(clock.duration, response.t)
    assert response.contacts["c"].peak_force == pytest.approx(peak, rel=ACCURACY)
    assert error_of(response).first_peak["c"].relative < ACCURACY


@pytest.mark.parametrize("study", ["floor_tennis_ball", "floor_acrylic_ball"])
def test_ball_on_the_shipped_floor(study: str) -> None:
    """The ball of a shipped study on all modes and residual vectors of the shipped floor, without its damper: force and
    peak, at the strictest setting and at the one of every study; the acrylic ball strikes twice."""
    plan = read_study(MODELS / f"{study}.study.yaml")
    case = next(case for case in plan.cases if case.name == plan.baseline)
    solved = solve_all([case])[case.name]
    basis = damp_basis(case, {case.name: solved}, case)
    assert "residual" in basis.kind and basis.modes.stop > 80
    assert not (basis.time_damping - np.diag(np.diag(basis.time_damping))).any()  # as `Hit` has it
    shipped = build_scene(case.study, solved.places, basis)
    (body,), (contact,) = shipped.bodies, shipped.contacts
    assert isinstance(contact.law, Hertz) and isinstance(contact.lower, Probe) and contact.gap == 0.0
    hit = Hit(
        body.mass,
        -body.velocity,
        contact.law.stiffness,
        basis,
        contact.lower.of(basis.shapes),
        contact.law.damping,
    )
    window = (2.5 if study == "floor_tennis_ball" else 6.0) * hit.contact_time
    strict, usual = (
        simulate(basis, shipped, Clock(window, 100 / hit.contact_time, tolerance=tolerance))
        for tolerance in (STRICTEST, 1e-8)
    )
    forces, peak = hit.reference(window, strict.t)
    found = strict.contacts[contact.name]
    assert found.closings == (1 if study == "floor_tennis_ball" else 2)
    # both march by 1e-13 a step: measured 4e-15 and 3e-14 of the peak, 1e-6 is asked
    assert found.peak_force == pytest.approx(peak, rel=1e-11)
    assert np.abs(found.force - forces).max() < ROUNDING * peak
    assert usual.contacts[contact.name].peak_force == pytest.approx(peak, rel=ROUNDING)
    for run in (strict, usual):
        estimate = error_of(run).first_peak[contact.name]
        assert abs(run.contacts[contact.name].peak_force - peak) <= 3 * estimate.error
        assert estimate.relative < ROUNDING


def _ratios(count: int) -> np.ndarray:
    """True error over estimated error of the largest force, of random bodies, modes, windows, samplings, tolerances."""
    rng = np.random.default_rng(1)
    ratios = []
    for _ in range(count):
        n, mass, k, speed = (
            int(rng.integers(1, 7)),
            10 ** rng.uniform(-2, 0),
            10 ** rng.uniform(6, 9),
            rng.uniform(0.2, 4),
        )
        time = 2.9433 * (5 * mass * speed**2 / (4 * k)) ** 0.4 / speed
        frequencies, ratio = np.sort(rng.uniform(0.02, 3, n) / time), rng.uniform(0, 0.1, n)
        shape = rng.normal(size=n) / np.sqrt(mass) * rng.uniform(0.1, 1)
        basis, points = given_modes(frequencies.tolist(), ratio.tolist(), {"p": shape.tolist()})
        hit = Hit(mass, speed, k, basis, shape)
        clock = Clock(
            time * 10 ** rng.uniform(1.5, 2.5), rng.uniform(1, 30) / time, tolerance=10 ** rng.uniform(-6, -1)
        )
        response = hit.simulated(points["p"].probe("z"), clock)
        estimate = error_of(response)
        # until the second impact, or long enough for the first
        closed = [event.t for event in response.events if event.what == "closes"]
        until = closed[1] if len(closed) > 1 else min(clock.duration, 6 * time)
        _, peak = hit.reference(until, np.array([until]))
        found = estimate.first_peak["c"]
        ratios.append(abs(found.value - peak) / found.error)
    return np.array(ratios)


def _is_honest(ratios: np.ndarray) -> None:
    assert np.mean(ratios <= 3.0) >= 0.95
    assert np.median(ratios) >= 0.1


def test_estimate_of_random_impacts() -> None:
    _is_honest(_ratios(25))


@pytest.mark.stress
def test_estimate_of_200_random_impacts() -> None:
    _is_honest(_ratios(200))


def test_chaotic_end_does_not_spoil_the_first_peak() -> None:
    """A ball caught between a wall and a vibrating mass: the first peak is known far better than the end."""
    basis, points = given_modes([40.0, 310.0], [0.0, 0.0], {"p": [1.5, 1.1]})
    place = points["p"].probe("z")
    scene = Scene(
        (Body("b", 0.3, -1.0),),
        (Contact("floor", "b", place, Hertz(1e8)), Contact("wall", GROUND, "b", Hertz(1e8), gap=2e-3)),
    )
    estimate = error_of(simulate(basis, scene, Clock(0.5, 2e4, tolerance=1e-4)))
    assert estimate.first_until < 0.1
    assert estimate.first_peak["floor"].relative < 1e-6  # steps of 1e-4: 7e-9 here
    assert estimate.velocity["b"].relative > 1e3 * estimate.first_peak["floor"].relative
