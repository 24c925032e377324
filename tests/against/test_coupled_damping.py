"""Modes that damping couples against the matrix exponential and scipy's integrators: heavy, stiff, defective."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import femstruct.impact.simulate as engine
import femstruct.modal.oscillators as making
from femstruct.errors import NotConverged
from femstruct.impact.batch import simulate_batch
from femstruct.impact.scene import Blows, Body, Clock, Contact, HalfSine, Load, Scene
from femstruct.impact.shares import energy_by_holder, mode_energies
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.modal.basis import Holder, ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.modal.frf import frf
from femstruct.modal.oscillators import oscillators
from femstruct.model.probe import Probe

WOOL = 8300.0  # 1/s: 10 kPa s/m2 over the density of air


def based(hz: np.ndarray, damping: np.ndarray, shape: np.ndarray) -> tuple[ModalBasis, Probe]:
    """Modes with a full damping matrix, and a point of them."""
    basis, points = given_modes(list(hz), [0.0] * len(hz), {"p": list(shape)})
    return replace(basis, viscous=damping), points["p"].probe("z")


def with_wool(count: int, seed: int) -> tuple[ModalBasis, Probe]:
    """Modes from 15 to 900 Hz, a third of whose motion goes through wool."""
    rng = np.random.default_rng(seed)
    hz = np.sort(rng.uniform(15.0, 900.0, count))
    turn, _ = np.linalg.qr(np.eye(count) + 0.2 * rng.standard_normal((count, count)))
    rates = np.where(np.arange(count) % 3 == 0, WOOL, 0.0)
    damping = (turn * rates) @ turn.T + np.diag(0.03 * 2 * np.pi * hz)
    return based(hz, 0.5 * (damping + damping.T), 0.3 * rng.standard_normal(count))


def flow_of(basis: ModalBasis) -> np.ndarray:
    """The matrix of [q; q'], dense."""
    k = len(basis.omega)
    return np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(basis.omega**2), -basis.time_damping]])


def struck_by_hand(basis: ModalBasis, place: Probe, spring: float, mass: float, speed: float, t: np.ndarray):
    """[q; x; q'; x'] of a ball on a linear spring that only pushes, by matrix exponentials between its events."""
    phi, k = place.of(basis.shapes), len(basis.omega)
    row = np.append(phi, -1.0)  # indentation: the floor up to the ball less the ball
    root = np.append(np.ones(k), mass)
    stiffness, damping = np.zeros((k + 1, k + 1)), np.zeros((k + 1, k + 1))
    stiffness[:k, :k], damping[:k, :k] = np.diag(basis.omega**2), basis.time_damping
    flows = []
    for contact in (0.0, spring):
        pull = (stiffness + contact * np.outer(row, row)) / root[:, None]
        flows.append(np.block([[np.zeros((k + 1, k + 1)), np.eye(k + 1)], [-pull, -damping / root[:, None]]]))
    state, now, closed, out = np.zeros(2 * k + 2), 0.0, True, np.empty((2 * k + 2, len(t)))
    state[-1] = speed
    step = (t[1] - t[0]) / 4.0
    steps = [expm(flow * step) for flow in flows]
    for i in range(len(t)):
        while now < t[i] - 1e-15:
            after = steps[closed] @ state
            depth = row @ after[: k + 1]
            if (depth < 0.0) == closed:

                def indented(h, state=state, closed=closed):
                    return row @ (expm(flows[closed] * h) @ state)[: k + 1]

                here = brentq(indented, 1e-9 * step, step, xtol=1e-18, rtol=1e-15)
                state = expm(flows[not closed] * (step - here)) @ (expm(flows[closed] * here) @ state)
                closed = not closed
            else:
                state = after
            now += step
        out[:, i] = state
    return out


@pytest.mark.parametrize("marching", ["exact march", "collocation"])
def test_a_ball_on_a_floor_with_wool(marching: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Motion of all modes and of the ball, through a contact and after, of both marches."""
    if marching == "collocation":
        monkeypatch.setattr(engine, "is_piecewise_linear", lambda *_: False)
    basis, place = with_wool(12, 1)
    scene = Scene((Body("ball", 0.4, -1.0),), (Contact("c", "ball", place, Linear(4e5)),))
    response = simulate(basis, scene, Clock(0.03, 8e3))
    y = struck_by_hand(basis, place, 4e5, 0.4, -1.0, response.t)
    allowed = 1e-10 if marching == "exact march" else 1e-8  # rounding of the steps by hand; collocation's tolerance
    assert np.abs(response.q - y[:12]).max() < allowed * np.abs(y[:12]).max()
    assert np.abs(response.qd - y[13:25]).max() < allowed * np.abs(y[13:25]).max()
    assert np.abs(response.bodies["ball"].velocity - y[25]).max() < allowed
    assert response.events[-1].what == "opens"
    assert response.ledger.residual < 1e-11  # rounding, and 1e-8 squared of collocation: 3e-13 and 1e-12 here
    for modes in (np.array([2, 7]), np.arange(12)):
        assert np.allclose(response.velocities(modes), response.qd[modes], rtol=0, atol=1e-13)  # rounding


def test_what_the_damping_takes_is_its_power() -> None:
    """The ledger's losses, made of a form of the state, against the integral of q' C q' over all samples."""
    basis, place = with_wool(20, 2)
    push = Load("push", place, HalfSine(300.0, 120.0))
    response = simulate(basis, Scene(loads=(push,)), Clock(0.05, 200e3))
    speed = response.qd
    power = (speed * (basis.time_damping @ speed)).sum(axis=0)
    taken = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]))]) / 200e3
    ledger = response.ledger
    # trapezoids of 5 us: 4e-5 of the energy here, and a quarter of it at twice the rate
    assert np.abs(np.interp(ledger.t, response.t, taken) - ledger.lost_modes)[:-1].max() < 1e-4 * ledger.lost_modes[-1]
    assert np.diff(ledger.lost_modes).min() > -1e-12 * ledger.lost_modes[-1]  # rounding: damping gives nothing back
    assert ledger.residual < 1e-12  # rounding: 1e-14 here
    whole = 0.5 * (speed**2 + (basis.omega[:, None] * response.q) ** 2).sum(axis=0)
    inside = np.interp(response.t, ledger.t, ledger.structure)
    assert np.abs(whole - inside)[np.isin(response.t, ledger.t)].max() < 1e-12 * whole.max()  # the same formula


def test_energies_at_the_separation() -> None:
    """Energies of modes and of holders at the end of a collision add up to the ledger's own term."""
    basis, place = with_wool(12, 3)
    turn, _ = np.linalg.qr(np.random.default_rng(8).standard_normal((12, 12)))
    half = turn[:, :5] @ turn[:, :5].T
    two = {"a": Holder(half, np.diag(basis.omega**2)), "b": Holder(np.eye(12) - half, np.zeros((12, 12)))}
    basis = replace(basis, holders=two)
    scene = Scene((Body("ball", 0.4, -1.0),), (Contact("c", "ball", place, Hertz(2e7)),))
    response = simulate(basis, scene, Clock(0.02, 20e3))
    found, apart = mode_energies(response), response.ledger.at_separation
    assert apart is not None and found.at_separation is not None
    # the instant of the opening within its step, and rounding
    assert sum(group.energy for group in found.at_separation) == pytest.approx(apart.structure, rel=1e-9)
    assert sum(found.held_at_separation.values()) == pytest.approx(apart.structure, rel=1e-9)
    assert sum(found.held_at_end.values()) == pytest.approx(response.ledger.end.structure, rel=1e-9)
    assert apart.total == pytest.approx(0.2, rel=1e-9)  # the ball's, 0.4 kg at 1 m/s
    last = energy_by_holder(basis, response.q[:, -1], response.qd[:, -1])
    assert sum(last.values()) == pytest.approx(response.ledger.structure[-2], rel=0.1)  # a sample before the end


def test_batches_and_blows_are_as_single_runs() -> None:
    """Runs of a batch with wool, by both marches, and with blows, against runs by themselves."""
    basis, place = with_wool(12, 4)
    for law, blows in ((Hertz(2e7), ()), (Linear(4e5), ()), (Hertz(2e7), (Blows("ball", place, 0.01, 3),))):
        falls = Body("ball", 0.4, -1.0, falls=True)
        scene = Scene((falls,), (Contact("c", "ball", place, law),), gravity=9.81, blows=blows)
        clock = Clock(1 / 32, 8192.0)
        batch = simulate_batch(basis, scene, clock, {"ball.mass": [0.4, 0.9]}, threads=1)
        for i in range(2):
            alone = simulate(basis, batch.scene(i), clock)
            # tolerance of collocation, whose ticks differ
            assert batch.peak_force["c"][i] == pytest.approx(alone.contacts["c"].peak_force, rel=1e-7)
            assert batch.end_velocity["ball"][i] == pytest.approx(alone.bodies["ball"].end_velocity, rel=1e-7)
            for term in ("structure", "lost_modes", "work"):
                expected = getattr(alone.ledger.end, term)
                assert getattr(batch.end, term)[i] == pytest.approx(expected, rel=1e-6, abs=1e-9), (
                    law,
                    term,
                )  # the same
            assert batch.residual[i] < 1e-9  # of the ledgers: 1e-11 here
            assert alone.ledger.residual < 1e-9
            assert len(alone.blows) == (3 if blows else 0)


def moved(omega: np.ndarray, damping: np.ndarray, push: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
    """[Omega q; q'] after a blow by the oscillators, in closed form, and by the matrix exponential."""
    found, k = oscillators(omega, damping), len(omega)
    z, v = found.kicks @ push, found.drives @ push
    blocks = np.zeros((k, 2, 2))
    blocks[:, 0, 1], blocks[:, 1, 0], blocks[:, 1, 1] = 1.0, -(found.omega**2), -found.damping
    turned = np.stack([expm(block * t) for block in blocks])
    z, v = turned[:, 0, 0] * z + turned[:, 0, 1] * v, turned[:, 1, 0] * z + turned[:, 1, 1] * v
    mine = np.concatenate([omega * (found.places @ z + found.tilts @ v), found.swings @ z + found.rates @ v])
    whole = expm(np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(omega**2), -damping]]) * t)
    truth = whole @ np.concatenate([np.zeros(k), push])
    return mine, np.concatenate([omega * truth[:k], truth[k:]])


def exceptional(p: float) -> tuple[np.ndarray, np.ndarray]:
    """Two modes of 10 and 12 rad/s whose eigenvalues are the roots of (lambda^2 + p lambda + 120)^2, with one shape
    each: (lambda^2 + a lambda + 100)(lambda^2 + d lambda + 144) - b^2 lambda^2, compared term by term."""
    a = (2 * p * 120 - 2 * p * 100) / 44
    d = 2 * p - a
    b = np.sqrt(244 + a * d - p * p - 240)
    return np.array([10.0, 12.0]), np.array([[a, b], [b, d]])


@pytest.mark.parametrize("p", [3.0, 10.0, 2 * np.sqrt(120.0)])  # the last: one eigenvalue four times
def test_a_defective_matrix(p: float) -> None:
    omega, damping = exceptional(p)
    push = np.array([1.0, -0.4])
    for t in (1e-3, 0.1, 1.0):
        mine, truth = moved(omega, damping, push, t)
        assert np.abs(mine - truth).max() < 1e-8  # 1e-10 of the damping is added: 2e-10 here
    assert 0.0 < oscillators(omega, damping).added <= 1e-8
    basis, _ = based(omega / (2 * np.pi), damping, np.array([1.0, 0.3]))
    response = simulate(basis, Scene(velocity=push), Clock(1.0, 50.0))
    assert response.ledger.residual < 1e-8  # the same
    exact = expm(flow_of(basis) * response.t[-1]) @ np.append([0.0, 0.0], push)
    assert np.abs(np.append(response.q[:, -1], response.qd[:, -1]) - exact).max() < 1e-8


@pytest.mark.parametrize(
    "damping",
    [
        [[20.0, 0.1], [0.1, 20.0]],  # critical, coupled a little
        [[20.0, 20.0], [20.0, 20.0]],  # one dashpot on both: one motion without any
        [[40.0, 20.0], [20.0, 40.0]],  # sum critical three times, difference critical
    ],
)
def test_equal_pairs_about_critical(damping: list[list[float]]) -> None:
    for t in (1e-3, 0.1, 1.0):
        mine, truth = moved(np.array([10.0, 10.0]), np.array(damping), np.array([1.0, 0.2]), t)
        assert np.abs(mine - truth).max() < 1e-14  # rounding: a double root of one pair is none of the matrix


def passive(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A random passive system: modes with and without stiffness, equal ones, dashpots from 0.1 to 1e7 1/s."""
    rng = np.random.default_rng(seed)
    k = int(rng.integers(2, 24))
    omega = np.sort(10 ** rng.uniform(0.5, 4.0, k))
    omega[: rng.integers(0, 3)] = 0.0
    if rng.random() < 0.5:
        omega[-1] = omega[-2]
    count = int(rng.integers(1, k + 1))
    rows = rng.standard_normal((count, k)) * (rng.random((count, k)) < rng.uniform(0.2, 1.0))
    return omega, (rows.T * 10 ** rng.uniform(-1.0, 7.0 if seed % 5 == 0 else 4.0, count)) @ rows


@pytest.mark.parametrize("seeds", [range(16), pytest.param(range(16, 116), marks=pytest.mark.stress)])
def test_random_passive_systems(seeds: range) -> None:
    """Free vibration against the matrix exponential; energy never grows, and is what the losses will be."""
    for seed in seeds:
        omega, damping = passive(seed)
        push = np.random.default_rng(seed).standard_normal(len(omega))
        push /= np.linalg.norm(push)
        for t in (1e-4, 3e-2):
            mine, truth = moved(omega, damping, push, t)
            # what is added to a damping of 1e7 1/s at most, and expm's own rounding of 1e-16 times 1e7 1/s
            assert np.abs(mine - truth).max() < 1e-8, seed
        basis, _ = based(omega / (2 * np.pi), damping, np.ones(len(omega)))
        response = simulate(basis, Scene(velocity=push), Clock(0.05, 2e3))
        ledger = response.ledger
        assert np.diff(ledger.structure).max() < 1e-9, seed  # what is added to the damping, and rounding
        assert np.diff(ledger.lost_modes).min() > -1e-9, seed
        assert ledger.residual < 1e-8, seed  # the same


@pytest.mark.parametrize("fast", [1e6, 1e7, 1e9])
def test_a_relaxing_state_of_tiny_mass(fast: float) -> None:
    """A spring in series with a dashpot beside a mode, as the heat that wool takes: by a mode of its own, whose mass is
    so small that its fast root is at `fast` [1/s], against the equation of first order. It is heavier by that mass."""
    omega, share, slow = 300.0, 0.4, 4000.0
    inner = share * omega**2  # spring of the element over the mass
    mass = inner / (slow * fast)  # the element's mass for slow times fast = inner over mass
    rub = inner / slow  # e' = slow (x - e) without the mass
    stiff = np.array([[omega**2 + inner, -inner / np.sqrt(mass)], [-inner / np.sqrt(mass), inner / mass]])
    squared, turn = np.linalg.eigh(stiff)
    damping = turn.T @ np.diag([6.0, rub / mass]) @ turn
    basis, _ = based(np.sqrt(squared) / (2 * np.pi), 0.5 * (damping + damping.T), turn[0])
    response = simulate(basis, Scene(velocity=turn[0]), Clock(0.1, 2e3))
    first = np.array([[0, 1, 0], [-(omega**2) - inner, -6.0, inner], [slow, 0, -slow]])
    truth = np.stack([expm(first * t) @ [0.0, 1.0, 0.0] for t in response.t], axis=1)
    x = turn[0] @ response.q
    allowed = mass * omega * 0.1 + 1e-8  # phase that the mass costs until the end; rounding of 1e9 1/s
    assert np.abs(x - truth[0]).max() < allowed * np.abs(truth[0]).max()
    assert response.ledger.residual < 1e-8  # rounding of 1e9 1/s


def test_against_an_integrator_that_takes_stiff_systems() -> None:
    """A Hertz ball on modes with wool and one rate of 1e6 1/s against scipy's Radau."""
    basis, place = with_wool(6, 5)
    damping = basis.viscous.copy()
    damping += 1e6 * np.outer([0, 0, 0, 0, 1, 2.0], [0, 0, 0, 0, 1, 2.0])
    basis = replace(basis, viscous=damping)
    phi = place.of(basis.shapes)
    scene = Scene((Body("ball", 0.4, -1.0),), (Contact("c", "ball", place, Hertz(2e7)),))
    response = simulate(basis, scene, Clock(0.01, 5e3))

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        force = 2e7 * max(phi @ y[:6] - y[6], 0.0) ** 1.5
        inner = -(basis.omega**2) * y[:6] - damping @ y[7:13]
        return np.concatenate([y[7:], inner - phi * force, [force / 0.4]])

    start = np.zeros(14)
    start[-1] = -1.0
    y = solve_ivp(rate, (0, 0.01), start, "Radau", t_eval=response.t, rtol=1e-9, atol=1e-13).y
    # Radau's own error over the kinks of the contact: 2e-7 here
    assert np.abs(response.qd - y[7:13]).max() < 2e-6 * np.abs(y[7:13]).max()
    assert np.abs(response.bodies["ball"].velocity - y[13]).max() < 2e-6
    assert response.ledger.residual < 1e-9  # collocation: 1e-12 here


def test_frequency_responses_of_the_same_modes() -> None:
    """What a blow leaves, transformed, is the frequency response: time and frequency share the full matrix."""
    basis, place = with_wool(8, 6)
    phi = place.of(basis.shapes)
    found = oscillators(basis.omega, basis.time_damping)
    for hz in (20.0, 150.0, 700.0):
        s = 2j * np.pi * hz
        below = s**2 + s * found.damping + found.omega**2
        kick, drive = found.kicks @ phi, found.drives @ phi
        z, v = ((s + found.damping) * kick + drive) / below, (s * drive - found.omega**2 * kick) / below
        mine = phi @ (found.places @ z + found.tilts @ v)
        assert mine == pytest.approx(frf(basis, place, place, hz)[0], rel=1e-11)  # rounding


def test_no_oscillators_are_said_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(making, "PROVEN", 1e-30)
    with pytest.raises(NotConverged, match=r"modes coupled by damping: got no complex modes of 2 modes from 1\.592 Hz"):
        oscillators(np.array([10.0, 12.0]), np.array([[3.0, 1.0], [1.0, 2.0]]))
