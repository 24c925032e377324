"""Frames of wool and air that slides over it: coordinates without stiffness of whose places nobody asks, against the
matrix exponential and against oscillators that tell them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import femstruct.modal.coupled_damping as states
import femstruct.modal.oscillators as finishing
from femstruct.impact.batch import simulate_batch
from femstruct.impact.scene import Blows, Body, Clock, Contact, HalfSine, Load, Scene
from femstruct.impact.shares import energy_by_holder_over_time, mode_energies
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.modal.basis import Holder, ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.modal.coupled_damping import energies_of_states
from femstruct.modal.oscillators import oscillators, oscillators_of
from femstruct.model.probe import Probe

MODES = 14
STEPS = 1e-8  # tolerance of collocation: what its steps may miss


def with_frames(frames: int, seed: int = 0) -> tuple[ModalBasis, Probe]:
    """Modes from 15 to 900 Hz, dashpots of 10 to 1e6 1/s between them, and frames without stiffness no force meets."""
    rng = np.random.default_rng(seed)
    hz = np.append(np.zeros(frames), np.sort(rng.uniform(15.0, 900.0, MODES)))
    shape = np.append(np.zeros(frames), 0.3 * rng.standard_normal(MODES))
    rows = rng.standard_normal((frames + 5, len(hz)))
    rows[:frames, :frames] = np.diag(np.linspace(1.0, 2.0, frames))  # each frame goes with the air around it
    rates = np.append(np.full(frames, 900.0), [10.0, 300.0, 8e3, 9e3, 1e6])
    basis, points = given_modes(list(hz), [0.0] * len(hz), {"p": list(shape)})
    viscous = (rows.T * rates) @ rows / MODES + np.diag(0.03 * 2 * np.pi * hz)
    return replace(basis, viscous=0.5 * (viscous + viscous.T)), points["p"].probe("z")


def flow_of(basis: ModalBasis) -> np.ndarray:
    """The matrix of [q; q'], dense."""
    k = len(basis.omega)
    return np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(basis.omega**2), -basis.time_damping]])


@pytest.mark.parametrize("frames", [1, 2, 5, 8])
def test_an_oscillator_less_for_every_two_frames(frames: int) -> None:
    """What rings after a blow, by fewer oscillators and by the matrix exponential."""
    basis, place = with_frames(frames)
    found, k = oscillators_of(basis), len(basis.omega)
    assert found is not None
    assert len(found.omega) == k - frames // 2
    push = place.of(basis.shapes)
    response = simulate(basis, Scene(velocity=push), Clock(0.05, 2e3))
    truth = np.stack([expm(flow_of(basis) * t) @ np.append(np.zeros(k), push) for t in response.t], axis=1)
    # expm's own rounding of 1e6 1/s: 4e-11 here
    assert np.abs(response.qd - truth[k:]).max() < 1e-9 * np.abs(push).max()
    assert np.abs(response.q[frames:] - truth[frames:k]).max() < 1e-9 * np.abs(truth[frames:k]).max()  # the same
    assert response.ledger.residual < 1e-9  # rounding of 1e6 1/s
    travelled = np.diff(truth[:frames])  # frames are told from where they come to rest
    assert np.abs(np.diff(response.q[:frames]) - travelled).max() < 1e-9 * np.abs(travelled).max()  # the same


@pytest.mark.parametrize("law", [Hertz(2e7), Linear(4e5)])
def test_a_blow_is_the_same_with_fewer(law: Hertz | Linear) -> None:
    """All that a run tells, with frames of whose places nobody asks and with the same of which somebody does."""
    basis, place = with_frames(7, 1)
    told = replace(basis, momentum=np.where(basis.omega == 0.0, 1.0, basis.momentum))
    half = np.diag(np.repeat([1.0, 0.0], [10, 11]))
    holders = {
        "a": Holder(half, half * basis.omega**2),
        "b": Holder(np.eye(21) - half, (np.eye(21) - half) * basis.omega**2),
    }
    runs = []
    for one in (basis, told):
        one = replace(one, holders=holders)
        scene = Scene(
            (Body("ball", 0.4, -1.0, falls=True),),
            (Contact("c", "ball", place, law),),
            loads=(Load("push", place, HalfSine(30.0, 120.0)),),
            gravity=9.81,
            blows=(Blows("ball", place, 0.015, 2),),
        )
        runs.append(simulate(one, scene, Clock(0.03, 8e3)))
    few, all_of_them = runs
    assert few.motion.z.shape[1] == all_of_them.motion.z.shape[1] - 3
    for name in ("structure", "lost_modes", "work"):
        mine, theirs = getattr(few.ledger, name), getattr(all_of_them.ledger, name)
        assert mine == pytest.approx(theirs, abs=STEPS * all_of_them.ledger.structure.max())
    few_forces, forces = few.contacts["c"].force, all_of_them.contacts["c"].force
    assert few_forces == pytest.approx(forces, abs=10 * STEPS * forces.max())
    assert few.bodies["ball"].velocity == pytest.approx(all_of_them.bodies["ball"].velocity, abs=STEPS)
    assert few.qd == pytest.approx(all_of_them.qd, abs=STEPS * np.abs(few.qd).max())
    assert few.ledger.residual < STEPS
    shares, theirs = mode_energies(few), mode_energies(all_of_them)
    assert sum(shares.held_at_end.values()) == pytest.approx(few.ledger.end.structure, rel=1e-9)  # rounding
    assert shares.held_at_end == pytest.approx(theirs.held_at_end, rel=1e-6)  # of what is left: the tolerance above
    over, other = energy_by_holder_over_time(few, few.ledger.t), energy_by_holder_over_time(all_of_them, few.ledger.t)
    assert over["b"] == pytest.approx(other["b"], abs=STEPS * other["b"].max())
    mine, theirs_too = (one.displacement(place.of(basis.shapes)) for one in runs)
    assert mine == pytest.approx(theirs_too, abs=STEPS * np.abs(theirs_too).max())


def test_batches_with_frames_are_as_single_runs() -> None:
    basis, place = with_frames(4, 2)
    scene = Scene((Body("ball", 0.4, -1.0),), (Contact("c", "ball", place, Hertz(2e7)),))
    clock = Clock(1 / 32, 8192.0)
    batch = simulate_batch(basis, scene, clock, {"ball.mass": [0.4, 0.9]}, threads=1)
    for i in range(2):
        alone = simulate(basis, batch.scene(i), clock)
        assert batch.peak_force["c"][i] == pytest.approx(alone.contacts["c"].peak_force, rel=1e-7)  # its ticks differ
        assert batch.end.structure[i] == pytest.approx(alone.ledger.end.structure, rel=1e-6)  # the same
        assert batch.residual[i] < STEPS


def some_states(basis: ModalBasis, place: Probe) -> tuple[np.ndarray, np.ndarray]:
    """States of its oscillators at 150 times after a blow, from 1 us to 1 s."""
    found = oscillators_of(basis)
    assert found is not None
    push = place.of(basis.shapes)
    z, v = found.kicks @ push, found.drives @ push
    flows = [expm(np.array([[0.0, 1.0], [-(w**2), -c]])[None] * np.geomspace(1e-6, 1.0, 150)[:, None, None])
             for w, c in zip(found.omega, found.damping, strict=True)]  # fmt: skip
    flow = np.stack(flows, axis=1)
    return flow[..., 0, 0] * z + flow[..., 0, 1] * v, flow[..., 1, 0] * z + flow[..., 1, 1] * v


@pytest.mark.parametrize("told", [False, True])
def test_energies_of_states_are_those_of_the_modes(told: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of many states at once, most oscillators being at rest, against squares of all modes; and what free motion loses,
    told state by state and as a bound."""
    if told:
        monkeypatch.setattr(finishing, "LOSSES_ALIKE", 0.0)
    basis, place = with_frames(6, 3)
    z, v = some_states(basis, place)
    found = oscillators(basis.omega, basis.time_damping, False)
    assert found.surplus.size == (told and 4 * len(found.omega) ** 2)
    q, qd = z @ found.places.T + v @ found.tilts.T, z @ found.swings.T + v @ found.rates.T
    squares = 0.5 * ((basis.omega * q) ** 2 + qd**2).sum(axis=1)
    held, surplus = energies_of_states(found, z, v, float(squares.max()))
    assert np.abs(held - squares).max() < 1e-13 * squares.max()  # rounding
    assert np.abs(held - squares)[squares > 1e-6 * squares.max()].max() < 1e-9 * squares.max()
    assert np.abs(surplus).max() < 1e-9 * squares.max()  # rounding of 1e6 1/s: 1e-12 here
    assert told or (surplus >= 0.0).all()
    monkeypatch.setattr(states, "ALIKE", 0.0)  # every state by its squares
    by_squares, _ = energies_of_states(found, z, v, float(squares.max()))
    assert by_squares == pytest.approx(squares, rel=1e-13)


def test_a_bound_of_the_losses_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is told as a bound is never less than what is told state by state."""
    basis, place = with_frames(6, 3)
    z, v = some_states(basis, place)
    bounded = oscillators(basis.omega, basis.time_damping, False)
    monkeypatch.setattr(finishing, "LOSSES_ALIKE", 0.0)
    exact = oscillators(basis.omega, basis.time_damping, False)
    _, most = energies_of_states(bounded, z, v, 1.0)
    _, surplus = energies_of_states(exact, z, v, 1.0)
    assert (np.abs(surplus) <= most * (1.0 + 1e-9) + 1e-25).all()  # rounding of both sums
    assert most.max() > 0.0


def test_damping_by_itself_is_the_diagonal() -> None:
    basis, _ = with_frames(3)
    lossy = replace(basis, hysteretic=np.diag(0.02 * basis.omega**2))
    assert np.array_equal(lossy.own_damping, np.diag(lossy.time_damping))
