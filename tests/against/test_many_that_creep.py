"""Hundreds of motions that creep back, told by sums of few exponentials, against all of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import femstruct.impact.system as compiling
import femstruct.modal.oscillators as finishing
from femstruct.impact.batch import simulate_batch
from femstruct.impact.response import Response
from femstruct.impact.scene import Body, Clock, Contact, HalfSine, Load, Scene
from femstruct.impact.shares import energy_by_holder_over_time, mode_energies
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.modal.basis import Holder, ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.modal.oscillators import oscillators_of, relaxing_of, under_forces
from femstruct.model.probe import Probe

STEPS = 1e-8  # tolerance of collocation: what its steps may miss


def woolly(seed: int = 0, rings: int = 12, creeps: int = 110) -> tuple[ModalBasis, Probe, Probe]:
    """Modes that swing and modes in wool, which takes 3 to 9 times 10^3 1/s, and two places."""
    rng = np.random.default_rng(seed)
    k = rings + creeps
    hz = np.sort(rng.uniform(20.0, 400.0, k))
    turn, _ = np.linalg.qr(np.eye(k) + 0.02 * rng.standard_normal((k, k)))
    rates = np.zeros(k)
    rates[rng.permutation(k)[:creeps]] = rng.uniform(6e3, 9e3, creeps)
    viscous = (turn.T * rates) @ turn + np.diag(0.03 * 2 * np.pi * hz)
    shapes = {"p": list(0.3 * rng.standard_normal(k)), "o": list(0.3 * rng.standard_normal(k))}
    basis, points = given_modes(list(hz), [0.0] * k, shapes)
    half = np.diag(np.arange(k) % 2.0)
    holders = {
        "a": Holder(half, half * basis.omega**2),
        "b": Holder(np.eye(k) - half, (np.eye(k) - half) * basis.omega**2),
    }
    basis = replace(basis, viscous=0.5 * (viscous + viscous.T), holders=holders)
    return basis, points["p"].probe("z"), points["o"].probe("z")


def all_of_them(basis: ModalBasis, scene: Scene, clock: Clock) -> Response:
    """A run by all oscillators."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiling, "under_forces", lambda found, forces: found)
        return simulate(basis, scene, clock)


def test_sums_are_the_exponentials() -> None:
    """Values and derivatives, at times between those at which they were fitted; each root once, in its place."""
    rng = np.random.default_rng(1)
    slow, fast = rng.uniform(30.0, 90.0, 250), 10 ** rng.uniform(3.0, 4.9, 250)
    which, found = relaxing_of(np.sqrt(slow * fast), slow + fast)
    assert found is not None and found.number == len(which) == 250
    assert found.rates == pytest.approx(-np.array([slow, fast])[:, which], rel=1e-12)  # rounding
    t = np.append(0.0, 10 ** rng.uniform(-7.0, 0.0, 400))
    sums = np.exp(t[:, None] * found.nodes)
    for part in range(2):
        truth = np.exp(t[:, None] * found.rates[part])
        assert np.abs(sums @ found.weights[part].T - truth).max() < 2e-11  # FITTED at the times of the fit
        derivative = (sums * found.nodes) @ found.weights[part].T
        assert np.abs(derivative - truth * found.rates[part]).max() < 2e-11 * np.abs(found.nodes).max()  # the same


def test_what_swings_or_is_critical_is_left_alone() -> None:
    w = np.full(60, 100.0)
    assert relaxing_of(w, np.full(60, 10.0))[1] is None
    assert relaxing_of(w, np.full(60, 200.0))[1] is None
    assert relaxing_of(w[:2], np.full(2, 900.0))[1] is None


@pytest.mark.parametrize(("law", "told"), [(Hertz(2e7), False), (Linear(4e5), True)])
def test_a_blow_is_the_same(law: Hertz | Linear, told: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """All that a run tells, under one contact and a load at another place, by both marches; what free motion would
    lose as a bound and, told, state by state."""
    if told:
        monkeypatch.setattr(finishing, "LOSSES_ALIKE", 0.0)
    basis, place, other = woolly(seed=told)
    scene = Scene(
        (Body("ball", 0.4, -1.0, falls=True),),
        (Contact("c", "ball", place, law),),
        loads=(Load("push", other, HalfSine(30.0, 120.0)),),
        gravity=9.81,
    )
    few, whole = simulate(basis, scene, Clock(0.03, 8e3)), all_of_them(basis, scene, Clock(0.03, 8e3))
    assert few.motion.z.shape[1] < 0.7 * whole.motion.z.shape[1]
    most = whole.ledger.structure.max()
    for name in ("structure", "lost_modes", "work"):
        assert getattr(few.ledger, name) == pytest.approx(getattr(whole.ledger, name), abs=STEPS * most)
    forces = whole.contacts["c"].force
    assert few.contacts["c"].force == pytest.approx(forces, abs=STEPS * forces.max())
    assert few.bodies["ball"].velocity == pytest.approx(whole.bodies["ball"].velocity, abs=STEPS)
    assert few.q == pytest.approx(whole.q, abs=STEPS * np.abs(whole.q).max())
    assert few.qd == pytest.approx(whole.qd, abs=STEPS * np.abs(whole.qd).max())
    assert few.ledger.residual < STEPS
    shares = mode_energies(few)
    assert sum(shares.held_at_end.values()) == pytest.approx(few.ledger.end.structure, rel=1e-9)  # rounding
    for holder in basis.holders.values():
        assert holder.energy(few.q, few.qd) == pytest.approx(holder.energy(whole.q, whole.qd), abs=STEPS * most)


def test_a_batch_is_the_same() -> None:
    basis, place, _ = woolly(seed=3)
    scene, clock = Scene((Body("ball", 0.4, -1.0),), (Contact("c", "ball", place, Hertz(2e7)),)), Clock(1 / 64, 8192.0)
    batch = simulate_batch(basis, scene, clock, {"ball.mass": [0.4, 0.9]}, threads=1)
    for i in range(2):
        alone = all_of_them(basis, batch.scene(i), clock)
        assert batch.peak_force["c"][i] == pytest.approx(alone.contacts["c"].peak_force, rel=1e-7)  # its ticks differ
        assert batch.end.structure[i] == pytest.approx(alone.ledger.end.structure, rel=1e-6)  # the same
        assert batch.residual[i] < STEPS


def test_who_starts_in_motion_has_all_of_them() -> None:
    """A start of the structure is no force along the rows."""
    basis, place, _ = woolly(seed=4)
    push = place.of(basis.shapes)
    scene = Scene((Body("ball", 0.4, 0.0),), (Contact("c", "ball", place, Linear(4e5), gap=1.0),), velocity=push)
    few, whole = simulate(basis, scene, Clock(0.01, 8e3)), all_of_them(basis, scene, Clock(0.01, 8e3))
    assert np.array_equal(few.qd, whole.qd)


def test_too_many_forces_are_no_reason() -> None:
    """Where the sums for every force would be as many as all oscillators, all are taken; dependent rows are one."""
    basis, place, other = woolly(seed=5)
    found = oscillators_of(basis)
    assert found is not None and found.relaxing is not None
    row = place.of(basis.shapes)
    assert under_forces(found, np.eye(len(row))) is found
    assert under_forces(found, np.zeros((1, len(row)))) is found
    one = under_forces(found, row[None])
    two = under_forces(found, np.array([row, -3.0 * row, 0.0 * row]))
    assert len(one.omega) == len(two.omega) < len(under_forces(found, np.array([row, other.of(basis.shapes)])).omega)
    push = one.drives @ row
    assert (one.swings @ (one.kicks @ row) + one.rates @ push) == pytest.approx(
        row, abs=1e-9
    )  # FITTED, times the rates
    assert (one.places @ (one.kicks @ row) + one.tilts @ push) == pytest.approx(0.0 * row, abs=1e-13)  # the same


def test_samples_inside_long_steps_under_force() -> None:
    """Modes and weighted sums of them inside steps of many samples, while a soft spring pushes, against each other and
    against samples that are starts of steps."""
    basis, place, other = woolly(6, 6, 50)
    scene = Scene((Body("ball", 0.4, -1.0),), (Contact("c", "ball", place, Hertz(2e4)),))
    fine, coarse = simulate(basis, scene, Clock(0.004, 256e3)), simulate(basis, scene, Clock(0.004, 8e3))
    assert fine.motion.pushed.sum() > 5
    for row in (place.of(basis.shapes), other.of(basis.shapes)):
        for of_row, of_modes in ((fine.displacement(row), fine.q), (fine.velocity(row), fine.qd)):
            assert of_row == pytest.approx(row @ of_modes, abs=1e-12 * np.abs(of_row).max())  # rounding
    over = energy_by_holder_over_time(fine, fine.t[5::7])  # from the state at each sample by itself
    for name, holder in basis.holders.items():
        expected = holder.energy(fine.q[:, 5::7], fine.qd[:, 5::7])
        assert over[name] == pytest.approx(expected, abs=1e-12 * expected.max())  # rounding
    assert fine.q[:, ::32] == pytest.approx(coarse.q, abs=STEPS * np.abs(coarse.q).max())
    assert fine.qd[:, ::32] == pytest.approx(coarse.qd, abs=STEPS * np.abs(coarse.qd).max())
    forces = coarse.contacts["c"].force
    assert fine.contacts["c"].force[::32] == pytest.approx(forces, abs=STEPS * forces.max())
