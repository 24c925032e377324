"""What every simulated impact must keep: energy, momentum, time's direction, indifference to order and to steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from femstruct.arrays import Floats
from femstruct.errors import FemstructError, NotConverged
from femstruct.impact import collocation as collocate
from femstruct.impact import simulate as engine
from femstruct.impact.response import Outcome, Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, HalfSine, Link, Load, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.laws.stop import Stop
from femstruct.modal.closed_form import given_modes, oscillator, rod
from femstruct.model.probe import Point, Probe

ROUNDING = 1e-12  # steps and rounding: 6e-15 here at most

NONE = given_modes([], [], {})[0]


def plate(n: int = 20) -> tuple[engine.ModalBasis, dict[str, Point]]:
    """A floor over a slab with made-up mode shapes, the last two modes fast as residual vectors are."""
    rng = np.random.default_rng(7)
    f = np.concatenate(([12.0, 19.9, 23.0], np.linspace(150.0, 2500.0, n - 5), [1.2e4, 4e4]))
    shapes = {"f": list(rng.uniform(-2, 2, n)), "s": list(rng.uniform(-0.3, 0.3, n))}
    return given_modes(list(f), [0.02] * n, shapes)


def floor_scene(points: dict[str, Point], damper: float = 0.45) -> Scene:
    """Tennis ball, damper below the floor, one-way link to the slab, a push on the slab."""
    f, s = points["f"].probe("z"), points["s"].probe("z")
    return Scene(
        (Body("ball", 0.054, -2.1, falls=True), Body("damper", damper)),
        (Contact("ball on floor", "ball", f, Hertz(3.7e5, 150.0)), Contact("damper", f, "damper", Hertz(6.1e8))),
        (Link("link", "damper", s, 507.0, 0.0, 40.0),),
        (Load("push", s, HalfSine(5.0, 80.0)),),
        gravity=9.81,
    )


@pytest.fixture(scope="module")
def floor() -> Response:
    basis, points = plate()
    return simulate(basis, floor_scene(points), Clock(0.3, 20e3))


def test_ledger_closes(floor: Response) -> None:
    # the error allowed per step is 1e-9 of a contact's speed; some thousand steps
    assert floor.ledger.residual < 1e-8
    assert not [finding for finding in floor.findings if finding.severe]


def test_every_term_of_the_ledger_counts(floor: Response) -> None:
    """Leaving out any one term opens it by a thousand times what the acceptance allows."""
    end, start = floor.ledger.end, floor.ledger.start.total
    assert abs(end.total - start) < 1e-9 * start  # steps and rounding: 4e-12 here
    for term in ("structure", "lost_modes", "work"):
        assert abs(replace(end, **{term: 0.0}).total - start) > 1e-5 * start, term
    for term in ("bodies", "lost_contacts", "lost_links", "links"):
        kept = dict(getattr(end, term))
        for name in kept:
            if name != "damper" or term == "bodies":  # the damper's contact has no dashpot
                assert abs(replace(end, **{term: {**kept, name: 0.0}}).total - start) > 1e-6 * start, (term, name)
    assert end.lost_contacts["damper"] == 0.0
    middle = floor.ledger.stored.max()
    assert middle > 0.1 * start  # contacts do store energy on the way


def test_losses_over_time_end_as_the_ledger_does(floor: Response) -> None:
    """And the link's is what its dashpot takes of the speed between its ends, summed over the samples."""
    ledger, end = floor.ledger, floor.ledger.end
    for histories, ends in ((ledger.lost_contacts, end.lost_contacts), (ledger.lost_links, end.lost_links)):
        assert histories.keys() == ends.keys()
        for name, history in histories.items():
            assert history[0] == 0.0
            assert history[-1] == pytest.approx(ends[name], rel=ROUNDING, abs=0.0)
    assert ledger.lost_modes[-1] == pytest.approx(end.lost_modes, rel=ROUNDING)
    assert ledger.dissipated[-1] == pytest.approx(end.dissipated, rel=ROUNDING)
    moving = points_apart(floor)
    power = 40.0 * np.minimum(moving, 0.0) ** 2  # while the damper and the slab move apart
    taken = np.concatenate(([0.0], np.cumsum(power[1:] + power[:-1]) / (2.0 * floor.clock.sampling)))
    seen = np.interp(floor.t, ledger.t, ledger.lost_links["link"])
    # trapezoids between samples of 50 us, and rows of the ledger as far apart while nothing touches
    assert np.abs(seen - taken).max() < 1e-2 * taken[-1]


def points_apart(floor: Response) -> np.ndarray:
    """Speed at which the ends of the link approach, at the samples [nt] [m/s]."""
    link = floor.scene.links[0]
    assert isinstance(link.lower, Probe)
    return np.asarray(link.lower.of(floor.basis.shapes) @ floor.qd - floor.bodies["damper"].velocity)


def test_halving_the_tolerance_moves_nothing(floor: Response) -> None:
    basis, points = plate()
    for tolerance, allowed in ((5e-9, 1e-8), (1e-6, 1e-5)):
        other = simulate(basis, floor_scene(points), Clock(0.3, 20e3, tolerance=tolerance))
        for name, contact in floor.contacts.items():
            assert other.contacts[name].peak_force == pytest.approx(contact.peak_force, rel=allowed)
        assert np.abs(other.qd - floor.qd).max() < 10 * allowed * np.abs(floor.qd).max()


def test_samples_do_not_depend_on_sampling(floor: Response) -> None:
    basis, points = plate()
    other = simulate(basis, floor_scene(points), Clock(0.3, 4e3))
    # samples place the steps: 5e-9 here
    assert np.abs(floor.qdd[:, ::5] - other.qdd).max() < 5e-7 * np.abs(floor.qdd).max()
    assert np.abs(floor.q[:, ::5] - other.q).max() < 1e-8 * np.abs(floor.q).max()  # the same: 7e-11 here
    # the same: 5e-10 here
    assert other.contacts["damper"].peak_force == pytest.approx(floor.contacts["damper"].peak_force, rel=1e-8)


def test_samples_satisfy_the_equations_of_motion(floor: Response) -> None:
    """q'' + c q' + w^2 q equals the interfaces' forces at every sample, and a peak is no less than any sample."""
    basis, points = plate()
    f, s = (points[name].probe("z").of(basis.shapes) for name in "fs")
    push = np.where(floor.t < 0.5 / 80, 5 * np.sin(2 * np.pi * 80 * floor.t), 0.0)
    force = np.outer(f, floor.contacts["damper"].force - floor.contacts["ball on floor"].force)
    force += np.outer(s, push - floor.links["link"])
    left = floor.qdd + basis.time_damping @ floor.qd + (basis.omega**2)[:, None] * floor.q
    assert np.abs(left - force).max() < ROUNDING * np.abs(basis.omega.max() ** 2 * floor.q).max()
    for contact in floor.contacts.values():
        assert contact.peak_force >= contact.force.max() * (1 - 1e-9)
        assert contact.force.min() >= 0.0
        assert (contact.force[contact.indentation < 0] == 0).all()


def test_order_does_not_matter(floor: Response) -> None:
    basis, points = plate()
    scene = floor_scene(points)
    other = simulate(basis, replace(scene, bodies=scene.bodies[::-1], contacts=scene.contacts[::-1]), Clock(0.3, 20e3))
    # rounding, grown over some bounces
    assert np.abs(other.qd - floor.qd).max() < 1e-9 * np.abs(floor.qd).max()
    assert other.ledger.end.bodies["ball"] == pytest.approx(floor.ledger.end.bodies["ball"], rel=ROUNDING)


def test_two_runs_are_bit_equal(floor: Response) -> None:
    basis, points = plate()
    other = simulate(basis, floor_scene(points), Clock(0.3, 20e3))
    assert np.array_equal(other.qdd, floor.qdd)
    assert [event.t for event in other.events] == [event.t for event in floor.events]


def test_momentum_of_free_things() -> None:
    """A rod struck by a ball, a body behind it, nothing held: momentum stays."""
    basis, points = rod(2.0, 206e9, 7850.0, 3.14e-4, modes=12, points={"left": 0.0, "right": 2.0})
    left, right = points["left"].probe("x"), points["right"].probe("x")
    scene = Scene(
        (Body("ball", 0.9, -2.0), Body("d", 0.45)),
        (Contact("hit", "ball", left, Linear(1e7, 200.0)), Contact("pass", right, "d", Hertz(1e9, 100.0))),
        (Link("l", "d", right, 1e3, 10.0, 3.0),),
    )
    response = simulate(basis, scene, Clock(0.02, 50e3))
    rigid = response.qd[0] * np.sqrt(206e9 * 0 + 7850 * 3.14e-4 * 2.0)
    momentum = np.abs(rigid) * np.sign(response.qd[0] * left.of(basis.shapes)[0])
    momentum = momentum + 0.9 * response.bodies["ball"].velocity + 0.45 * response.bodies["d"].velocity
    assert np.abs(momentum + 1.8).max() < ROUNDING * 1.8


def test_time_reversed() -> None:
    """Without losses the end, with speeds reversed, returns to the start."""
    basis, points = oscillator(1.0, stiffness=900.0, axis="z")
    place = points["m"].probe("z")
    chain = (Contact("a", "ball", place, Hertz(2e5)), Contact("b", place, "d", Linear(3e4)))
    clock = Clock(0.05, 20e3)
    there = simulate(basis, Scene((Body("ball", 0.3, -1.0), Body("d", 0.6)), chain), clock)
    end = there.ledger.at_separation
    assert end is not None
    # restart where all are apart: displacements there become gaps and the spring's preload cannot be given, so
    # reverse a scene whose structure has no stiffness
    free = given_modes([0.0], [0.0], {"m": [1.0]})
    place = free[1]["m"].probe("z")
    chain = (Contact("a", "ball", place, Hertz(2e5)), Contact("b", place, "d", Linear(3e4)))
    there = simulate(free[0], Scene((Body("ball", 0.3, -1.0), Body("d", 0.6)), chain), clock)
    gaps = {c: -float(there.contacts[c].indentation[-1]) for c in "ab"}
    assert min(gaps.values()) > 0
    back = simulate(
        free[0],
        Scene(
            (
                Body("ball", 0.3, -float(there.bodies["ball"].velocity[-1])),
                Body("d", 0.6, -float(there.bodies["d"].velocity[-1])),
            ),
            tuple(replace(c, gap=gaps[c.name]) for c in chain),
            velocity=-there.qd[:, -1],
        ),
        clock,
    )
    assert back.bodies["ball"].velocity[-1] == pytest.approx(1.0, abs=1e-10)  # steps and rounding: 7e-13 here
    assert abs(back.bodies["d"].velocity[-1]) < ROUNDING
    assert abs(back.qd[0, -1]) < 1e-10  # steps and rounding: 2e-13 here


def test_outcomes() -> None:
    far = Scene((Body("b", 1.0, -1.0),), (Contact("c", "b", GROUND, Linear(1e4), gap=5.0),))
    assert simulate(NONE, far, Clock(1.0, 100.0)).outcome is Outcome.NEVER_TOUCHED
    heavy = Scene((Body("b", 1.0, -1.0, falls=True),), (Contact("c", "b", GROUND, Linear(1e4, 190.0)),), gravity=9.81)
    rests = simulate(NONE, heavy, Clock(2.0, 1000.0))
    assert rests.outcome is Outcome.RESTING
    assert "contact-closed-at-end" not in [finding.code for finding in rests.findings]
    assert rests.contacts["c"].force[-1] == pytest.approx(9.81, rel=ROUNDING)
    assert rests.ledger.residual < ROUNDING
    short = simulate(NONE, replace(far, contacts=(Contact("c", "b", GROUND, Linear(1e6)),)), Clock(0.1, 1000.0))
    assert "contact-coarsely-sampled" in [finding.code for finding in short.findings]


def test_step_cap_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (engine, collocate):
        monkeypatch.setattr(module, "MAX_STEPS", 20)
    scene = Scene((Body("b", 1.0, -1.0),), (Contact("c", "b", GROUND, Hertz(1e4)),))
    with pytest.raises(NotConverged, match="20 steps by t = "):
        simulate(NONE, scene, Clock(1.0, 100.0))


@pytest.mark.parametrize(
    ("scene", "match"),
    [
        (Scene((Body("b", 1.0), Body("b", 2.0))), "'b' twice"),
        (Scene((Body("b", 1.0),), (Contact("c", "b", "d", Linear(1.0)),)), "expected a body: b"),
        (Scene((Body("b", 1.0),), (Contact("c", "b", GROUND, Stop(1.0), preload=1.0),)), "preload on a stop"),
        (Scene((Body("b", 1.0),), velocity=np.zeros(2)), "scene velocity"),
        (Scene(), "something that moves"),
    ],
)
def test_contradictions_are_refused(scene: Scene, match: str) -> None:
    with pytest.raises(FemstructError, match=match):
        simulate(NONE, scene, Clock(0.1, 100.0))


def test_histories_are_for_pictures(floor: Response) -> None:
    """The terms add up at every instant kept, not only at the end."""
    book = floor.ledger
    bodies: Floats = np.sum(list(book.bodies.values()), axis=0)
    total = bodies + book.structure + book.stored + book.dissipated - book.work
    assert np.abs(total - total[0]).max() <= 1e-9 * total[0]  # steps and rounding: 4e-12 here
    assert len(book.t) > 500


def test_the_ledger_follows_a_load() -> None:
    """A half-sine of 10 ms on a slow mass: a row a sample while it acts, later still enough for a curve."""
    basis, points = oscillator(2.0, stiffness=2.0 * (20 * np.pi) ** 2)
    scene = Scene(loads=(Load("hit", points["m"].probe("z"), HalfSine(100.0, 50.0)),))
    book = simulate(basis, scene, Clock(1.0, 4000.0)).ledger
    assert (np.diff(book.t[book.t <= 0.01]) <= 1.001 / 4000.0).all()
    assert np.diff(book.t).max() <= 1.0 / 500.0
