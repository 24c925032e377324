"""Contact laws with a collision on paper: energy integrals, elliptic and gamma functions, Lambert's relation."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq
from scipy.special import ellipk, gamma

from femstruct.errors import FemstructError, InputError
from femstruct.impact.batch import simulate_batch
from femstruct.impact.response import Outcome, Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.cubic import Cubic
from femstruct.laws.hertz import Hertz
from femstruct.laws.hunt_crossley import HuntCrossley
from femstruct.laws.lankarani_nikravesh import LankaraniNikravesh
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.laws.restitution import damping_ratio_for, dissipation_for, restitution_of
from femstruct.laws.stop import Stop
from femstruct.laws.tabulated import Tabulated
from femstruct.modal.closed_form import given_modes

ROUNDING = 1e-12  # rounding: 6e-15 here at most

NONE = given_modes([], [], {})[0]
PAD = (np.array([0.0, 0.4e-3, 1e-3, 1.5e-3, 3e-3]), np.array([0.0, 30.0, 60.0, 180.0, 900.0]))


def wall(law: Law, m: float, v: float, duration: float, gap: float = 0.0) -> Response:
    """A body of mass m meets the ground at v; duration : a little longer than the contact."""
    scene = Scene((Body("ball", m, -v),), (Contact("wall", "ball", GROUND, law, gap=gap),))
    return simulate(NONE, scene, Clock(duration, 200 / duration))


@pytest.mark.parametrize("tensile", [False, True])
@pytest.mark.parametrize("e", [0.02, 0.1353, 0.5, 0.9, 1.0])
def test_linear_by_restitution_and_duration(e: float, tensile: bool) -> None:
    """A body returns from a rigid wall with the restitution and after the duration asked for, at every speed."""
    m, lasting = 0.37, 2.3e-3
    for v in (0.01, 3.0):
        response = wall(Linear.returning(e, mass=m, duration=lasting, tensile=tensile), m, v, 2 * lasting)
        # exact motion: rounding, and the first open tick of 1e-16 s
        assert response.bodies["ball"].velocity[-1] == pytest.approx(e * v, rel=1e-10)
        assert response.contacts["wall"].first_open == pytest.approx(lasting, rel=ROUNDING)
        assert response.ledger.residual < 1e-12  # rounding: 1e-14 here
    law = Linear.returning(e, mass=m, stiffness=5e4, tensile=tensile)
    assert law.stiffness == 5e4
    assert wall(law, m, 1.0, 0.03).bodies["ball"].velocity[-1] == pytest.approx(e, rel=1e-10)


def test_a_restitution_of_0_holds_a_body_that_meets_a_wall() -> None:
    """Critical damping, x = v t e^(-w t): the force is largest at the touch, c v, and what it brings is all lost."""
    m, v, k = 0.37, 3.0, 5e4
    law = Linear.returning(0.0, mass=m, stiffness=k, tensile=True)
    response = wall(law, m, v, 0.1)
    w, t = np.sqrt(k / m), response.t
    # exact motion, sqrt of a sum: at its double root the two rates are 1e-8 apart
    assert -response.bodies["ball"].displacement == pytest.approx(v * t * np.exp(-w * t), abs=1e-8 * v / w)
    assert response.contacts["wall"].peak_force == pytest.approx(2.0 * np.sqrt(k * m) * v, rel=ROUNDING)
    assert response.contacts["wall"].first_open is None
    assert response.ledger.end.dissipated == pytest.approx(0.5 * m * v**2, rel=1e-8)  # e^(-2 w 0.1 s)
    assert response.outcome is Outcome.TOGETHER and not response.findings
    with pytest.raises(InputError, match="got a duration with restitution 0, expected a stiffness"):
        Linear.returning(0.0, mass=m, duration=1e-3, tensile=True)
    with pytest.raises(InputError, match="restitution: got 0"):
        Linear.returning(0.0, mass=m, stiffness=k)


def test_a_body_that_stays_moves_on_with_what_it_strikes() -> None:
    """Two free bodies end with their common speed."""
    law = Linear.returning(0.0, mass=0.2 * 0.5 / 0.7, stiffness=1e4, tensile=True)
    scene = Scene((Body("a", 0.2, -1.0), Body("b", 0.5, 0.3)), (Contact("c", "a", "b", law),))
    response = simulate(NONE, scene, Clock(0.1, 1e4))
    for body in response.bodies.values():
        assert body.end_velocity == pytest.approx((0.5 * 0.3 - 0.2) / 0.7, rel=1e-8)  # e^(-w 0.1 s)
    assert response.outcome is Outcome.TOGETHER


def test_which_contact_holds_and_in_which_run() -> None:
    """A contact that holds its bodies but never closes says nothing of another that is clamped; of many runs those stay
    together whose dashpot, stiffness and mass hold them: c^2 against 4 k m."""
    law = Linear(1e4, damping=1e3, tensile=True)
    clamped = Contact("clamp", "a", GROUND, Linear(1e6), preload=50.0)
    far = Contact("far", "b", "a", law, gap=1.0)
    scene = Scene((Body("a", 0.2), Body("b", 0.5, 0.0)), (clamped, far))
    assert simulate(NONE, scene, Clock(0.1, 1e4)).outcome is Outcome.HELD
    held = Scene((Body("a", 0.2, -1.0),), (Contact("wall", "a", GROUND, law),))
    vary = {"wall.damping": [100.0, 80.0, 100.0, 100.0], "wall.stiffness": [1e4, 1e4, 2e4, 1e4],
            "a.mass": [0.2, 0.2, 0.2, 0.3]}  # fmt: skip
    batch = simulate_batch(NONE, held, Clock(0.5, 1e4), vary)
    alone = [simulate(NONE, batch.scene(i), Clock(0.5, 1e4)).outcome for i in range(4)]
    assert list(batch.outcome) == alone == [Outcome.TOGETHER, *[Outcome.SEPARATED] * 3]


def test_two_bodies_count_with_their_reduced_mass() -> None:
    law = Linear.returning(0.6, mass=0.2 * 0.5 / 0.7, duration=1e-3)
    scene = Scene((Body("a", 0.2, -1.0), Body("b", 0.5, 0.3)), (Contact("c", "a", "b", law),))
    response = simulate(NONE, scene, Clock(3e-3, 1e5))
    parting = response.bodies["a"].velocity[-1] - response.bodies["b"].velocity[-1]
    assert parting == pytest.approx(0.6 * 1.3, rel=ROUNDING)
    assert response.contacts["c"].first_open == pytest.approx(1e-3, rel=ROUNDING)


@pytest.mark.parametrize("gap", [0.0, 1e-3])
def test_the_force_of_a_dashpot_starts_and_ends_at_its_clamp(gap: float) -> None:
    """A strong Kelvin-Voigt contact: c v at the first touch, which is its peak, zero at the end and never below."""
    m, k, v = 1.0, 1e4, 1.0
    c = 2 * 0.8 * np.sqrt(k * m)
    response = wall(Linear(k, c), m, v, 0.05, gap)
    touch = response.contacts["wall"]
    assert touch.peak_force == pytest.approx(c * v, rel=1e-9)  # falls from there on, for a ratio above 1/2
    assert touch.peak_time == pytest.approx(gap / v, abs=1e-9)
    assert touch.force.min() >= 0.0
    assert touch.first_open is not None
    before = touch.force[(response.t > touch.first_open - 5e-4) & (response.t < touch.first_open)]
    assert before.size > 0
    assert (before < 0.05 * c * v).all()  # force goes to zero while the spring is still pressed in
    assert touch.indentation[np.searchsorted(response.t, touch.first_open)] > 0.1 * v * np.sqrt(m / k)
    pulls = wall(Linear(k, c, tensile=True), m, v, 0.05, gap).contacts["wall"]
    assert pulls.force.min() < -0.02 * c * v


@pytest.mark.parametrize("e", [1e-3, 0.05, 0.3, 0.6, 0.95, 0.9985, 0.9995, 1 - 1e-6])
def test_dissipation_against_its_relation_in_many_digits(e: float) -> None:
    """a (1 + e) = ln((1 + a) / (1 - a e)), in 600 digits, and back."""
    a = dissipation_for(e, 2.5) * 2.5
    with mpmath.workdps(600):  # 1 - a e is 1e-434 for the smallest
        exact = mpmath.findroot(
            lambda w: (1 - mpmath.exp(-w)) * (1 + 1 / mpmath.mpf(e)) - mpmath.log1p((1 - mpmath.exp(-w)) / e) - w,
            [0.5 * min(1.5 * (1 - e), 1 / e), 2 / mpmath.mpf(e)],
            solver="anderson",
            maxsteps=500,
        )
        exact_a = (1 - mpmath.exp(-exact)) / e
        # where the series takes over, at 0.999, the logarithms have lost 5 digits of a, which are 1e-3 of those of e
        assert abs(a / exact_a - 1) < 1e-10
    # digits lost in 1 - e: 7e-14 here
    assert restitution_of(a / 2.5, 2.5) == pytest.approx(e, abs=1e-8 * (1 - e) + 2e-12)
    if e > 0.99:  # Hunt and Crossley's and Lankarani and Nikravesh's limits
        assert a == pytest.approx(1.5 * (1 - e), rel=2 * (1 - e))
        assert a == pytest.approx(0.75 * (1 - e**2), rel=2 * (1 - e))


@pytest.mark.parametrize(("e", "n"), [(0.05, 1.5), (0.4, 1.0), (0.4, 2.0), (0.7, 1.5), (0.95, 3.0)])
def test_hunt_crossley_returns_what_it_is_asked_for(e: float, n: float) -> None:
    """Whatever the exponent, the stiffness and the masses; faster collisions lose more, slower ones less."""
    v = 1.7
    law = HuntCrossley.returning(e, v, 1e6, n)
    depth = ((n + 1) * 0.3 * v**2 / 2e6) ** (1 / (n + 1))
    response = wall(law, 0.3, v, 30 * depth / v)
    assert response.bodies["ball"].velocity[-1] == pytest.approx(e * v, rel=1e-10)  # rounding: 7e-13 here
    assert response.ledger.residual < 1e-10  # rounding: 1e-12 here
    scene = Scene((Body("a", 0.2, -1.0), Body("b", 4.0, 0.7)), (Contact("c", "a", "b", law),))
    response = simulate(NONE, scene, Clock(0.2, 1e4))
    parting = response.bodies["a"].velocity[-1] - response.bodies["b"].velocity[-1]
    assert parting == pytest.approx(e * v, rel=1e-10)  # rounding: 3e-13 here
    slow, fast = (wall(law, 0.3, u, 60 * depth / u).bodies["ball"].velocity[-1] / u for u in (0.3, 6.0))
    assert fast < e < slow
    assert slow == pytest.approx(restitution_of(law.dissipation, 0.3), rel=1e-10)  # rounding: 7e-13 here


@pytest.mark.parametrize("n", [1.0, 1.5, 2.5])
def test_power_law_without_loss(n: float) -> None:
    """Peak ((n+1) m v^2 / 2 k)^(1/(n+1)), contact time 2 d / v sqrt(pi) Gamma(1 + 1/(n+1)) / Gamma(1/2 + 1/(n+1))."""
    m, v, k = 0.3, 1.7, 1e7
    depth = ((n + 1) * m * v**2 / (2 * k)) ** (1 / (n + 1))
    lasting = 2 * depth / v * np.sqrt(np.pi) * gamma(1 + 1 / (n + 1)) / gamma(0.5 + 1 / (n + 1))
    response = wall(HuntCrossley(k, n), m, v, 2 * lasting)
    assert response.contacts["wall"].peak_force == pytest.approx(k * depth**n, rel=1e-10)  # rounding: 4e-13 here
    assert response.contacts["wall"].first_open == pytest.approx(lasting, rel=1e-11)  # rounding: 2e-14 here
    assert response.bodies["ball"].velocity[-1] == pytest.approx(v, rel=1e-10)  # rounding: 3e-13 here
    assert response.ledger.residual < 1e-10  # rounding: 1e-12 here


@pytest.mark.parametrize("e", [0.3, 0.5, 0.7, 0.9])
def test_lankarani_nikravesh_says_what_it_misses(e: float) -> None:
    law = LankaraniNikravesh(1e8, e, 2.0)
    response = wall(law, 0.5, 2.0, 5e-3)
    returned = response.bodies["ball"].velocity[-1] / 2.0
    assert returned == pytest.approx(law.returns, rel=1e-10)  # rounding: 3e-13 here
    assert returned > e
    told = [finding for finding in response.findings if finding.code == "restitution-missed"]
    assert bool(told) == (e < 0.79)
    if told:
        assert told[0].values["restitution"] == e
        assert told[0].values["returned"] == pytest.approx(returned, rel=1e-10)  # rounding: 3e-13 here
        assert f"{returned:.3f}" in told[0].message


@pytest.mark.parametrize(("k", "k3"), [(1e5, 1e11), (0.0, 1e11), (1e5, 0.0)])
def test_cubic_collision_is_half_a_period_of_duffing(k: float, k3: float) -> None:
    """x'' + alpha x + beta x^3 = 0 is A cn: period 4 K(m) / W with W^2 = alpha + beta A^2, m = beta A^2 / 2 W^2."""
    m, v = 0.5, 2.0
    alpha, beta = k / m, k3 / m
    square = v**2 / alpha if beta == 0 else (np.sqrt(alpha**2 + 2 * beta * v**2) - alpha) / beta
    amplitude, w = np.sqrt(square), np.sqrt(alpha + beta * square)
    lasting = 2 * ellipk(beta * square / (2 * w**2)) / w
    response = wall(Cubic(k, k3), m, v, 1.5 * lasting)
    assert response.contacts["wall"].peak_force == pytest.approx(k * amplitude + k3 * amplitude**3, rel=ROUNDING)
    assert response.contacts["wall"].first_open == pytest.approx(lasting, rel=ROUNDING)
    assert response.bodies["ball"].velocity[-1] == pytest.approx(v, rel=ROUNDING)
    assert response.ledger.residual < 1e-12  # rounding: 1e-14 here
    e = 0.45
    lossy = wall(Cubic(k, k3, dissipation_for(e, v)), m, v, 4 * lasting)
    assert lossy.bodies["ball"].velocity[-1] == pytest.approx(e * v, rel=ROUNDING)
    assert lossy.ledger.residual < ROUNDING


def test_tabulated_collision_by_quadrature() -> None:
    """Depth where the integral of the table is the energy; contact time as the integral of 1 / speed."""
    m, v = 0.2, 2.0
    spring = PchipInterpolator(*PAD)
    energy = spring.antiderivative()
    depth = brentq(lambda d: energy(d) - 0.5 * m * v**2, 0.0, PAD[0][-1], xtol=1e-18)

    def slowness(angle: float) -> float:  # d = depth sin(angle): no singularity at the turning point
        d = depth * np.sin(angle)
        left = 2 / m * (energy(depth) - energy(d))
        return depth * np.cos(angle) / np.sqrt(left)

    kinks = list(np.arcsin(PAD[0][(PAD[0] > 0) & (PAD[0] < depth)] / depth))
    lasting = 2 * quad(slowness, 0.0, np.pi / 2 - 1e-7, points=kinks, epsabs=0, epsrel=1e-12, limit=200)[0]
    lasting += 2e-7 * depth / np.sqrt(depth * spring(depth) / m)  # the rest, where the integrand is level
    response = wall(Tabulated(*PAD, smooth=True), m, v, 1.5 * lasting)
    touch = response.contacts["wall"]
    assert touch.peak_force == pytest.approx(float(spring(depth)), rel=1e-9)  # steps over the kinks: 4e-11 here
    # the integrand's last part is taken as level over 1e-7 rad
    assert touch.first_open == pytest.approx(lasting, rel=1e-8)
    assert response.bodies["ball"].velocity[-1] == pytest.approx(v, rel=1e-9)  # steps over the kinks: 1e-11 here
    assert response.ledger.residual < 1e-8  # curvature jumps at the points; the step control finds them
    assert "beyond-table" not in [finding.code for finding in response.findings]
    lossy = wall(Tabulated(*PAD, dissipation=dissipation_for(0.6, v), smooth=True), m, v, 3 * lasting)
    assert lossy.bodies["ball"].velocity[-1] == pytest.approx(0.6 * v, rel=1e-8)
    assert lossy.ledger.residual < 1e-8


@pytest.mark.parametrize("damped", [0.0, 0.3])
def test_a_table_is_straight_between_its_points(damped: float) -> None:
    """A bilinear bumper, 0.5 kg at 1.24 m/s, against scipy with an event at its bend: by monotone cubics its force was
    another by 0.6 % and more."""
    m, v, low, high, bend = 0.5, 1.24, 0.4e6, 4e6, 0.2e-3

    def push(_: float, y: NDArray[np.float64]) -> list[float]:
        spring = low * y[0] if y[0] < bend else low * bend + high * (y[0] - bend)
        return [y[1], -spring * (1.0 + damped * y[1]) / m]

    def at_bend(_: float, y: NDArray[np.float64]) -> float:
        return float(y[0] - bend)

    def opens(_: float, y: NDArray[np.float64]) -> float:
        return float(y[0]) if y[1] < 0.0 else 1.0

    at_bend.terminal, opens.terminal = True, True  # type: ignore[attr-defined]
    t, y, peak = 0.0, np.array([0.0, v]), 0.0
    while y[1] > 0.0 or y[0] > 1e-12:
        run = solve_ivp(push, (t, 0.1), y, "DOP853", rtol=1e-12, atol=1e-16, events=(at_bend, opens), dense_output=True)
        fine = run.sol(np.linspace(t, run.t[-1], 20_001))
        peak = max(peak, float(np.max(-m * np.array([push(0.0, one)[1] for one in fine.T]))))
        t, y = float(run.t[-1]), run.y[:, -1]
        y = y + np.array([1e-15, 0.0]) * np.sign(y[1])  # past the bend
    law = Tabulated([0.0, bend, 1e-3], [0.0, low * bend, low * bend + high * (1e-3 - bend)], damped)
    response = wall(law, m, v, 1.2 * t)
    touch = response.contacts["wall"]
    assert touch.peak_force == pytest.approx(peak, rel=1e-7)  # its samples 1e-8, steps over the bend
    assert touch.first_open == pytest.approx(t, rel=1e-8)  # the steps' tolerance
    assert abs(response.bodies["ball"].velocity[-1]) == pytest.approx(abs(float(y[1])), rel=1e-8)  # the same
    assert response.ledger.residual < 1e-8  # the energy of each piece in closed form, and the steps
    curved = wall(replace(law, smooth=True), m, v, 1.2 * t).contacts["wall"].peak_force
    assert abs(curved / peak - 1.0) > 5e-3  # another law
    assert law.indentation(low * bend + 40.0) == pytest.approx(bend + 40.0 / high, rel=1e-14)  # rounding


def test_a_table_of_two_points_is_a_spring() -> None:
    response = wall(Tabulated([0.0, 1.0], [0.0, 1e5]), 0.4, 1.0, 0.01)
    assert response.contacts["wall"].peak_force == pytest.approx(np.sqrt(1e5 * 0.4), rel=ROUNDING)
    assert response.contacts["wall"].first_open == pytest.approx(np.pi * np.sqrt(0.4 / 1e5), rel=ROUNDING)


def test_beyond_the_table_is_a_severe_finding() -> None:
    m, v, k = 0.4, 1.0, 1e5
    depth = v * np.sqrt(m / k)
    response = wall(Tabulated([0.0, 0.5 * depth], [0.0, 0.5 * depth * k]), m, v, 0.01)
    told = [finding for finding in response.findings if finding.code == "beyond-table"]
    assert told[0].severe
    assert told[0].values["last_m"] == pytest.approx(0.5 * depth)
    # seen at the points of the steps, which do not fall on the turning point
    assert told[0].values["indentation_m"] == pytest.approx(depth, rel=1e-2)
    # along the last slope, as said
    assert response.contacts["wall"].peak_force == pytest.approx(k * depth, rel=1e-10)


LAWS: dict[str, tuple[Law, float, float]] = {  # law, preload, slope of its force there, by hand
    "hertz": (Hertz(1e6), 1e3, 1.5 * 1e6 * 0.1),  # d = 0.01
    "linear": (Linear(1e4), 7.0, 1e4),
    "hunt-crossley": (HuntCrossley(1e6, 2.0), 100.0, 2 * 1e6 * 0.01),
    "cubic": (Cubic(1e4, 1e10), 20.0, 1e4 + 3e10 * 1e-6),  # d = 1e-3
    "table": (
        Tabulated([0.0, 1e-3, 2e-3], [0.0, 10.0, 30.0], smooth=True),
        10.0,
        2 * 1e4 * 2e4 / 3e4,
    ),  # harmonic mean of slopes
}


@pytest.mark.parametrize("name", LAWS)
def test_small_motion_about_a_preload(name: str) -> None:
    """sqrt(slope / m) at the rest state, wherever the law has it; the energy is measured from there."""
    law, preload, slope = LAWS[name]
    m, v = 0.5, 1e-6
    w = np.sqrt(slope / m)
    scene = Scene((Body("b", m, v),), (Contact("held", "b", GROUND, law, preload=preload),))
    response = simulate(NONE, scene, Clock(10 / w, 20 * w))
    # the curvature of the law at an amplitude of 1e-8 m
    assert np.abs(response.bodies["b"].displacement - v / w * np.sin(w * response.t)).max() < 2e-4 * v / w
    assert response.contacts["held"].force[0] == pytest.approx(preload, rel=ROUNDING)


def test_a_stop_with_a_gap_turns_a_body_at_both_sides() -> None:
    """Between two stiff bumpers: free flight of twice the gap, half a period in each, forces of both signs."""
    m, k, v, gap = 0.2, 1e7, 1.5, 2e-3
    scene = Scene((Body("b", m, v),), (Contact("stop", "b", GROUND, Stop(k), gap=gap),))
    turn, flight = np.pi * np.sqrt(m / k), 2 * gap / v
    response = simulate(NONE, scene, Clock(3 * (turn + flight), 1e5))
    expected = [gap / v + i * (turn + flight) for i in range(3)]
    found = [event.t for event in response.events if event.what == "closes"]
    assert found == pytest.approx(expected, rel=ROUNDING)
    force = response.contacts["stop"].force
    assert force.max() == pytest.approx(v * np.sqrt(k * m), rel=1e-2)  # samples
    assert force.min() == pytest.approx(-v * np.sqrt(k * m), rel=1e-2)
    lossy = Stop(k, 2 * damping_ratio_for(0.5) * np.sqrt(k * m))
    scene = Scene((Body("b", m, v),), (Contact("stop", "b", GROUND, lossy, gap=gap),))
    response = simulate(NONE, scene, Clock(0.019, 1e5))
    assert response.contacts["stop"].closings == 3  # after about 1.3, 6.7 and 17.4 ms
    assert abs(response.bodies["b"].velocity[-1]) == pytest.approx(v * 0.5**3, rel=ROUNDING)
    assert response.ledger.residual < ROUNDING


def test_hertz_of_two_spheres() -> None:
    """Against the moduli one by one; a steel ball of 10 mm on steel is 1.088e10 N/m^1.5."""
    ball = Hertz.of_spheres((5e-3, np.inf), (206e9, 206e9), (0.3, 0.3))
    assert ball.stiffness == pytest.approx(4 / 3 * 206e9 / 2 / 0.91 * np.sqrt(5e-3), rel=1e-14)  # rounding: none here
    pair = Hertz.of_spheres((5e-3, 20e-3), (5.9e9, 210e9), (0.34, 0.3))
    compliance = (1 - 0.34**2) / 5.9e9 + (1 - 0.3**2) / 210e9
    # rounding: none here
    assert pair.stiffness == pytest.approx(4 / 3 / compliance * np.sqrt(5e-3 * 20e-3 / 25e-3), rel=1e-14)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: HuntCrossley(0.0), "hunt-crossley law stiffness: got 0.0, expected a positive stiffness"),
        (lambda: HuntCrossley(1.0, 0.5), "hunt-crossley law exponent: got 0.5, expected an exponent of at least 1"),
        (lambda: HuntCrossley(1.0, 1.5, -1.0), "dissipation: got -1.0, expected a dissipation factor of at least 0"),
        (lambda: HuntCrossley.returning(0.0, 1.0, 1.0), "restitution: got 0, expected a value above 0 and at most 1"),
        (lambda: HuntCrossley.returning(0.5, 0.0, 1.0), "meeting speed: got 0 m/s"),
        (lambda: LankaraniNikravesh(1.0, 1.2, 1.0), r"restitution: got 1\.2"),
        (lambda: Cubic(0.0, 0.0), "got no stiffness"),
        (lambda: Cubic(-1.0, 0.0), "cubic law stiffness: got -1.0, expected a stiffness of at least 0"),
        (lambda: Tabulated([0.0], [0.0]), "got 1 points, expected two or more"),
        (lambda: Tabulated([0.0, 1.0], [1.0, 2.0]), "a first force of 1 N, expected 0"),
        (lambda: Tabulated([0.0, 2.0, 1.0], [0.0, 1.0, 2.0]), "indentation 1 m after 2 m, expected a rise"),
        (lambda: Tabulated([0.0, 1.0, 2.0], [0.0, 1.0, 1.0]), "force 1 N after 1 N, expected a rise"),
        (lambda: Tabulated([0.0, 1.0], [0.0, 1.0]).indentation(2.0), "at most the last force of the table, 1 N"),
        (lambda: Linear.returning(0.5, 1.0), "either a duration or a stiffness"),
        (lambda: Linear.returning(0.5, 1.0, duration=0.0), "linear law duration: got 0"),
        (lambda: Hertz.of_spheres((np.inf, np.inf), (1e9, 1e9), (0.3, 0.3)), "two flat faces"),
        (lambda: Hertz.of_spheres((1.0, 1.0), (1e9, 1e9), (0.3, 0.7)), r"0\.3 and 0\.7"),
    ],
)
def test_laws_that_mean_nothing_are_refused(make: object, match: str) -> None:
    with pytest.raises(FemstructError, match=match):
        make()  # type: ignore[operator]
