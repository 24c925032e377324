"""No contact is missed: random systems, scanned densely for penetration without force."""

from __future__ import annotations

import numpy as np
import pytest

from femstruct.impact.response import Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Link, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.cubic import Cubic
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.laws.stop import Stop
from femstruct.laws.tabulated import Tabulated
from femstruct.modal.closed_form import given_modes

SYSTEMS = 200
FACTORED = 30


def draw(seed: int, factored: bool = False) -> Response:
    """Up to six modes, three bodies, gaps, grazing speeds, stiffness ratios to 1e8 and mass ratios to 1e4.

    factored : laws whose dashpot is a factor, the others without.
    """
    rng = np.random.default_rng(seed)
    n, n_bodies = rng.integers(0, 7), rng.integers(1, 4)
    f = np.sort(10 ** rng.uniform(0, 3.5, n))
    if n and rng.random() < 0.3:
        f[0] = 0.0
    ratio = rng.choice([0.0, 0.01, 0.1, 1.0, 2.0], n)
    basis, points = given_modes(
        list(f), [float(r) if f_ else 0.0 for r, f_ in zip(ratio, f, strict=True)],
        {"p": list(rng.uniform(-2, 2, n)), "r": list(rng.uniform(-2, 2, n))},
    )  # fmt: skip
    ends = [points[name].probe("z") for name in "pr"] if n else []
    bodies = tuple(
        Body(f"b{i}", 10 ** rng.uniform(-2, 2), rng.choice([0.0, -1.0, 1.0, 1e-3]), falls=bool(rng.random() < 0.3))
        for i in range(n_bodies)
    )
    places = [*ends, *(body.name for body in bodies), GROUND]
    contacts, links = [], []
    for i in range(rng.integers(1, 4)):
        a, b = rng.choice(len(places), 2, replace=False)
        damping = rng.choice([0.0, 1.0])
        law: Law = [
            Hertz(10 ** rng.uniform(3, 9), damping * 10 ** rng.uniform(0, 2), bool(rng.random() < 0.3)),
            Linear(10 ** rng.uniform(1, 9), damping * 10 ** rng.uniform(0, 2), bool(rng.random() < 0.3)),
            Stop(10 ** rng.uniform(1, 7)),
        ][rng.integers(0, 3)]
        if factored:
            loss, pulls = damping * 10 ** rng.uniform(-2, 1.5), bool(rng.random() < 0.3)
            rises = np.cumsum(10 ** rng.uniform(-6, -3, 20))
            law = [
                HuntCrossley(10 ** rng.uniform(3, 9), rng.uniform(1, 3), loss, pulls),
                Cubic(rng.choice([0.0, 1.0]) * 10 ** rng.uniform(1, 7), 10 ** rng.uniform(6, 13), loss, pulls),
                Tabulated(np.append(0.0, rises), np.append(0.0, np.cumsum(10 ** rng.uniform(-1, 2, 20))), loss, pulls),
            ][rng.integers(0, 3)]
        gap = rng.choice([0.0, 10 ** rng.uniform(-7, -2)])
        preload = (
            10 ** rng.uniform(-1, 1 if factored else 2)
            if gap == 0 and not isinstance(law, Stop) and rng.random() < 0.3
            else 0.0
        )
        contacts.append(Contact(f"c{i}", places[a], places[b], law, gap, preload))
    for i in range(rng.integers(0, 3)):
        a, b = rng.choice(len(places), 2, replace=False)
        links.append(
            Link(f"l{i}", places[a], places[b], 10 ** rng.uniform(0, 5), rng.choice([0.0, 5.0]), rng.choice([0.0, 5.0]),
                 rng.choice([0.0, 0.01]), rng.choice([0.0, 3.0]))
        )  # fmt: skip
    velocity = rng.choice([0.0, 1.0], n) * rng.uniform(-1, 1, n)
    scene = Scene(bodies, tuple(contacts), tuple(links), (), velocity, 9.81)
    return simulate(basis, scene, Clock(0.05, 100e3))


@pytest.mark.parametrize("block", range(10))
def test_no_indentation_without_force(block: int) -> None:
    for seed in range(block * SYSTEMS // 10, (block + 1) * SYSTEMS // 10):
        response = draw(seed)
        assert np.isfinite(response.qdd).all()
        # 4e-11 here; of 20,000 some are left open, and say so
        assert response.ledger.residual < 1e-7 or response.findings, seed
        assert response.ledger.residual < 1e-6, seed  # the same
        for contact in response.scene.contacts:
            history, law = response.contacts[contact.name], contact.law
            depth = history.indentation
            spring = law.stiffness * np.maximum(depth, 0.0) ** (1.5 if isinstance(law, Hertz) else 1.0)
            touching = depth > 1e-13 + 1e-9 * np.abs(depth).max()
            if law.damping == 0.0:  # force at every sample with indentation, none without
                size = np.abs(history.force)
                # samples that solve for the force: rounding here; 1e-300: no force at all
                assert np.abs(size - spring)[touching].max(initial=0.0) <= 1e-6 * spring.max(initial=0.0) + 1e-300, seed
            assert (history.force[depth < 0] == 0).all(), seed
            pushed = np.abs(history.force) if isinstance(law, Stop) else history.force
            assert history.peak_force >= pushed.max() * (1 - 1e-6), seed
            if not contact.preload and touching.any():
                assert history.closings > 0, seed


@pytest.mark.parametrize("block", range(3))
def test_no_indentation_without_force_of_a_factored_law(block: int) -> None:
    for seed in range(1000 + block * FACTORED // 3, 1000 + (block + 1) * FACTORED // 3):
        response = draw(seed, factored=True)
        assert np.isfinite(response.qdd).all()
        assert response.ledger.residual < 1e-7, seed  # 3e-10 here
        for contact in response.scene.contacts:
            history, law = response.contacts[contact.name], contact.law
            depth = history.indentation
            touching = depth > 1e-13 + 1e-9 * np.abs(depth).max()
            assert (history.force[depth < -1e-15 * np.abs(depth).max()] == 0).all(), seed  # rounding of depths
            assert history.peak_force >= history.force.max() * (1 - 1e-6), seed
            assert law.tensile or history.force.min() >= -1e-9 * history.peak_force, seed
            if not law.dissipation:
                assert (history.force[touching] > 0).all(), seed
                back = np.array([law.indentation(f) for f in history.force[touching][::20] if f < _last(law)])
                found = depth[touching][::20][history.force[touching][::20] < _last(law)]
                # the law's inverse: 1e-13 here
                assert np.abs(back - found).max(initial=0.0) <= 1e-7 * depth.max(initial=0.0), seed
            if not contact.preload and touching.any():
                assert history.closings > 0, seed


def _last(law: Law) -> float:
    return law.forces[-1] if isinstance(law, Tabulated) else np.inf


def test_bounces_settle() -> None:
    """A ball bouncing to rest on a stiff lossy floor ends, closed, with its weight carried."""
    basis, points = given_modes([30.0, 400.0], [0.02, 0.02], {"p": [0.6, 1.0]})
    contact = Contact("c", "b", points["p"].probe("z"), Hertz(1e8, 2e4))
    response = simulate(basis, Scene((Body("b", 0.1, -0.3, falls=True),), (contact,), gravity=9.81), Clock(1.5, 5e3))
    # bounces that have not quite settled: 1e-3 here
    assert response.contacts["c"].force[-1] == pytest.approx(0.981, rel=0.05)
    assert response.contacts["c"].closings > 3
    assert response.ledger.residual < 1e-7  # the steps' tolerance: 1e-11 here
