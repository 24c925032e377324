"""Impacts against scipy: DOP853 at its tightest, and the matrix exponential for coupled damping."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from femstruct.impact.scene import GROUND, Body, Clock, Contact, HalfSine, Link, Load, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes, oscillator

ROUNDING = 1e-10  # steps and rounding: 9e-13 here at most


def test_linear_three_bodies_while_all_touch() -> None:
    """Ball on mass on spring, damper behind: three coupled oscillators in closed form until the first opens."""
    rb, rd, wb, wd = 0.5, 0.8, 30.0, 40.0
    basis, points = oscillator(1.0, stiffness=1.0, axis="z")
    place = points["m"].probe("z")
    kb, kd = rb * wb**2, rd * wd**2
    scene = Scene(
        (Body("ball", rb, -1.0), Body("damper", rd)),
        (Contact("ball", "ball", place, Linear(kb)), Contact("damper", place, "damper", Linear(kd))),
    )
    response = simulate(basis, scene, Clock(0.5, 2000.0))
    mass = np.array([1.0, rb, rd])
    stiffness = np.array([[1.0 + kb + kd, -kb, -kd], [-kb, kb, 0.0], [-kd, 0.0, kd]])
    values, vectors = np.linalg.eigh(stiffness / np.sqrt(np.outer(mass, mass)))
    omega, start = np.sqrt(values), vectors.T @ (np.sqrt(mass) * np.array([0.0, -1.0, 0.0]))
    touching = response.t < response.contacts["ball"].first_open
    t = response.t[touching]
    exact = (vectors @ (start[:, None] / omega[:, None] * np.sin(np.outer(omega, t)))) / np.sqrt(mass)[:, None]
    found = np.stack((response.q[0], response.bodies["ball"].displacement, response.bodies["damper"].displacement))
    assert touching.sum() > 100
    assert np.abs(found[:, touching] - exact).max() < 1e-12 * np.abs(exact).max()  # rounding of some hundred steps


def test_linear_three_bodies_to_the_end() -> None:
    """The same with events, against DOP853 stopped and restarted at every opening and closing."""
    rb, rd, wb, wd = 0.5, 0.8, 30.0, 40.0
    basis, points = oscillator(1.0, stiffness=1.0, axis="z")
    place = points["m"].probe("z")
    kb, kd = rb * wb**2, rd * wd**2
    scene = Scene(
        (Body("ball", rb, -1.0), Body("damper", rd)),
        (Contact("ball", "ball", place, Linear(kb)), Contact("damper", place, "damper", Linear(kd))),
    )
    response = simulate(basis, scene, Clock(8.0, 500.0))

    def depth(y: np.ndarray) -> tuple[float, float]:
        return y[0] - y[1], y[2] - y[0]

    state, t, closed = np.array([0.0, 0, 0, 0, -1, 0]), 0.0, [True, True]
    while t < response.t[-1]:

        def rate(_: float, y: np.ndarray, on: tuple[bool, ...] = tuple(closed)) -> np.ndarray:
            a, b = depth(y)
            fb, fd = kb * a * on[0], kd * b * on[1]
            # displacements run along z: the ball sits above the mass, the damper below
            return np.array([y[3], y[4], y[5], -y[0] - fb + fd, fb / rb, -fd / rd])

        events = []
        for i in (0, 1):

            def crossing(_: float, y: np.ndarray, i: int = i) -> float:
                return depth(y)[i]

            crossing.terminal, crossing.direction = True, -1.0 if closed[i] else 1.0  # type: ignore[attr-defined]
            events.append(crossing)
        part = solve_ivp(
            rate, (t, response.t[-1]), state, "DOP853", events=events, rtol=1e-13, atol=1e-15, max_step=0.01
        )
        t, state = part.t[-1], part.y[:, -1]
        for i in (0, 1):
            if len(part.t_events[i]):
                closed[i] = not closed[i]
    found = [response.q[0, -1], response.bodies["ball"].displacement[-1], response.bodies["damper"].displacement[-1]]
    assert len(response.events) >= 4
    assert np.abs(np.array(found) - state[:3]).max() < 3e-12 * np.abs(state[:3]).max()  # DOP853's own error


def _plain(basis: ModalBasis, rows: dict[str, np.ndarray], t: np.ndarray) -> np.ndarray:
    """Hertz ball with dashpot on one place, linear one-way link of a damper between two, written out in numpy."""
    w, c = basis.omega, basis.time_damping
    k, f, s = len(w), rows["f"], rows["s"]

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        q, x, v, u = y[:k], y[k : k + 2], y[k + 2 : 2 * k + 2], y[2 * k + 2 :]
        ball, ball_rate = f @ q - x[0], f @ v - u[0]
        hertz = max(0.0, 3.7e5 * ball**1.5 + 150 * ball**0.5 * ball_rate) if ball > 0 else 0.0
        damper = x[1] - f @ q
        hit = 6.1e8 * damper**1.5 if damper > 0 else 0.0
        approach, speed = s @ q - x[1], s @ v - u[1]
        link = 507 * approach + (40 * speed if speed < 0 else 0.0)
        force = np.concatenate((f * (hit - hertz) - s * link, [hertz / 0.054, (link - hit) / 0.45]))
        return np.concatenate((v, u, force - np.concatenate((w**2 * q + c @ v, [0, 0]))))

    start = np.zeros(2 * k + 4)
    start[2 * k + 2] = -2.0
    return solve_ivp(rate, (0, t[-1]), start, "DOP853", t_eval=t, rtol=1e-11, atol=1e-15, max_step=2e-5).y


@pytest.mark.parametrize("coupled", [False, True])
def test_ball_and_damper_on_a_small_floor(coupled: bool) -> None:
    """Two Hertz contacts, one with a clamped dashpot, and a one-way link; diagonal and full damping."""
    f, s = np.array([0.5, 1.5, -1.1, 0.9, 2.0]), np.array([0.5, -0.2, 0.25, 0.1, 0.05])
    basis, points = given_modes([20.0, 151, 274, 448, 9000], [0.06, 0.018, 0.01, 0.019, 0.02], {"f": f, "s": s})
    if coupled:
        dashpots = 8.0 * np.outer(f, f) + 20.0 * np.outer(s, s)
        basis = replace(basis, viscous=basis.viscous + dashpots)
    top, slab = points["f"].probe("z"), points["s"].probe("z")
    scene = Scene(
        (Body("ball", 0.054, -2.0), Body("damper", 0.45)),
        (
            Contact("ball", "ball", top, Hertz(3.7e5, 150.0)),
            Contact("damper", top, "damper", Hertz(6.1e8)),
        ),
        (Link("link", "damper", slab, 507.0, 0.0, 40.0),),
    )
    response = simulate(basis, scene, Clock(0.02, 20e3))
    y = _plain(basis, {"f": f, "s": s}, response.t)
    # DOP853 steps over the kinks of the clamp and of the square root: its error, not ours (ours moves 1e-9)
    assert np.abs(response.q - y[:5]).max() < 2e-8 * np.abs(y[:5]).max()
    assert np.abs(response.qd - y[7:12]).max() < ROUNDING * np.abs(y[7:12]).max()
    assert np.abs(response.bodies["damper"].velocity - y[13]).max() < ROUNDING * np.abs(y[13]).max()
    assert response.ledger.residual < ROUNDING


def test_coupled_damping_against_the_matrix_exponential() -> None:
    """Free decay of four modes, one rigid, with a strong full damping matrix."""
    basis, _ = given_modes([0.0, 10.0, 11.0, 90.0], [0.0, 0.01, 0.01, 0.02], {"p": [1.0, 1.0, 1.0, 1.0]})
    root = np.random.default_rng(4).standard_normal((4, 3)) * 3.0
    basis = replace(basis, viscous=basis.viscous + root @ root.T)
    speed = np.array([1.0, -2.0, 0.5, 3.0])
    response = simulate(basis, Scene(velocity=speed), Clock(0.5, 1000.0))
    a = np.block([[np.zeros((4, 4)), np.eye(4)], [-np.diag(basis.omega**2), -basis.time_damping]])
    start = np.concatenate((np.zeros(4), speed))
    for i in (1, 7, 100, 499):
        exact = expm(a * response.t[i]) @ start
        assert np.abs(np.concatenate((response.q[:, i], response.qd[:, i])) - exact).max() < ROUNDING
    assert response.ledger.residual < 1e-12  # steps and rounding: 6e-15 here


def test_coupled_equals_diagonal_in_rotated_coordinates() -> None:
    """Two modes of one frequency, rotated: a diagonal damping becomes full, the motion stays."""
    angle = 0.6
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    plain, points = given_modes([50.0, 50.0], [0.02, 0.3], {"p": [1.0, 0.4]})
    turned, turned_points = given_modes([50.0, 50.0], [0.0, 0.0], {"p": turn @ np.array([1.0, 0.4])})
    turned = replace(turned, viscous=turn @ plain.viscous @ turn.T)
    answers = []
    for basis, p in ((plain, points["p"]), (turned, turned_points["p"])):
        scene = Scene(
            (Body("b", 0.3, -1.0),),
            (Contact("c", "b", p.probe("z"), Hertz(1e6, 50.0)),),
            loads=(Load("l", p.probe("z"), HalfSine(20.0, 30.0)),),
        )
        answers.append(simulate(basis, scene, Clock(0.2, 2000.0)))
    assert np.abs(turn @ answers[0].q - answers[1].q).max() < ROUNDING * np.abs(answers[0].q).max()
    lost = [answer.ledger.end.lost_modes for answer in answers]
    assert lost[1] == pytest.approx(lost[0], rel=ROUNDING)


def test_two_bodies_and_ground_need_no_modes() -> None:
    """A chain of bodies on a spring to the ground, no structure, against DOP853."""
    scene = Scene(
        (Body("a", 0.2, -1.0), Body("b", 0.5)),
        (Contact("c", "a", "b", Linear(2e4, 3.0), gap=1e-3),),
        (Link("l", "b", GROUND, 900.0, 2.0, 2.0),),
    )
    response = simulate(given_modes([], [], {})[0], scene, Clock(0.3, 2000.0))

    def rate(_: float, y: np.ndarray) -> list[float]:
        delta, speed = y[1] - y[0] - 1e-3, y[3] - y[2]
        force = max(0.0, 2e4 * delta + 3 * speed) if delta > 0 else 0.0
        return [y[2], y[3], force / 0.2, (-force - 900 * y[1] - 2 * y[3]) / 0.5]

    y = solve_ivp(rate, (0, 0.3), [0, 0, -1.0, 0], "DOP853", t_eval=response.t, rtol=1e-10, atol=1e-14, max_step=5e-5).y
    # DOP853 steps over the jump of the dashpot at closing
    assert np.abs(response.bodies["b"].displacement - y[1]).max() < 1e-7 * np.abs(y[1]).max()
