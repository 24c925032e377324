"""Identification against closed forms: half sines, the normal distribution of the estimates, and laws of rank."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from scipy.integrate import quad

from femstruct.arrays import Floats
from femstruct.errors import FemstructError, InputError
from femstruct.impact.collisions import LASTS, LOSES, pulse_of
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes
from femstruct.workflow.fit import Fit, Left, combinations, fit, fit_findings, fit_parameters, parameter

ROUNDING = 1e-11  # steps and rounding: 6e-14 here at most

MASS, SPEED = 0.2, 1.5
SAMPLES, SAMPLING = 80, 8e3
T = np.arange(SAMPLES) / SAMPLING


def engine(values: Mapping[str, float]) -> Floats:
    """Force of a mass on a wall by the engine, linear law."""
    law = Linear(values["k"], values.get("c", 0.0))
    speed, mass = values.get("v", SPEED), values.get("m", MASS)
    scene = Scene((Body("m", mass, -speed),), (Contact("hit", "m", GROUND, law),))
    return simulate(given_modes([], [], {})[0], scene, Clock(SAMPLES / SAMPLING, SAMPLING)).contacts["hit"].force


def half_sine(k: float) -> Floats:
    """v sqrt(k m) sin(sqrt(k / m) t) until pi sqrt(m / k)."""
    w = np.sqrt(k / MASS)
    return SPEED * np.sqrt(k * MASS) * np.sin(w * T) * (w * T < np.pi)


def lossy(values: Mapping[str, float]) -> Floats:
    """Linear law with a dashpot that may not pull: the damped sine until its force is zero, then nothing."""
    k, c = values["k"], values["c"]
    decay = c / (2 * MASS)
    w = np.sqrt(k / MASS - decay**2)
    d = SPEED / w * np.exp(-decay * T) * np.sin(w * T)
    rate = SPEED * np.exp(-decay * T) * (np.cos(w * T) - decay / w * np.sin(w * T))
    force = k * d + c * rate
    return force * np.logical_and.accumulate(force > 0)


def noisy(clean: Floats, seed: int, share: float = 0.02) -> Floats:
    return clean + share * clean.max() * np.random.default_rng(seed).standard_normal(len(clean))


def codes(found: Fit) -> set[str]:
    return {finding.code for finding in fit_findings(found)}


def test_engine_on_a_half_sine_and_its_interval() -> None:
    """The history is the closed form, and so is its derivative by k; the engine knows of neither."""
    k, step = 4e4, 1.0
    measured = noisy(half_sine(k), 3)
    found = fit(engine, measured, {"k": 2e4})
    slope = (half_sine(k + step) - half_sine(k - step)) / (2 * step)
    left = measured - half_sine(found.values["k"])
    expected = np.sqrt(left @ left / (SAMPLES - 1) / (slope @ slope))
    # the step of a derivative is 1e-3, its error 1e-6; a sample at the end of the contact adds some 1e-4
    assert found.deviations["k"] == pytest.approx(expected, rel=1e-3)
    assert abs(found.values["k"] - k) < 3 * expected
    t95 = 1.9905  # Student's t, 97.5 %, 79 degrees of freedom, from tables
    # four decimals
    assert (found.high["k"] - found.low["k"]) / (2 * found.deviations["k"]) == pytest.approx(t95, abs=1e-4)
    assert not codes(found)


def test_exact_data_give_exact_parameters() -> None:
    truth = {"k": 4e4, "c": 20.0}
    found = fit(engine, engine(truth), {"k": 1e4, "c": 80.0})
    assert found.values == pytest.approx(truth, rel=1e-6)  # differences of 1e-3 turn the last step by 1e-6 of itself
    assert not codes(found)


def test_intervals_cover_the_truth_as_often_as_they_say() -> None:
    """400 draws of noise on the engine's force, found by the closed form: 95 % +- 1.1 %, binomially."""
    truth, start, draws = {"k": 4e4, "c": 20.0}, {"k": 3.6e4, "c": 25.0}, 400
    clean = engine(truth)
    assert clean == pytest.approx(lossy(truth), abs=1e-9 * clean.max())  # linear laws are exact to rounding
    hits = {"k": 0, "c": 0}
    for seed in range(draws):
        found = fit(lossy, noisy(clean, seed), start)
        for name, value in truth.items():
            hits[name] += found.low[name] <= value <= found.high[name]
    for count in hits.values():
        assert abs(count / draws - 0.95) < 3 * np.sqrt(0.95 * 0.05 / draws)


def test_pulse_of_a_half_sine_gives_its_spring() -> None:
    """k = m (pi / T)^2: an independent start value."""
    for k in (3e4, 5e4, 9e4):
        pulse = pulse_of(T, half_sine(k))
        # crossings of 80 samples by straight lines: a hundredth of the duration
        assert pulse.duration == pytest.approx(np.pi * np.sqrt(MASS / k), rel=0.01)
        assert pulse.impulse == pytest.approx(2 * MASS * SPEED, rel=0.01)


def test_pulse_with_loss_gives_start_values() -> None:
    """Restitution from the impulse is exact but for the sums; the laws are within a third, as a lossy pulse is no half
    sine."""
    t = np.arange(2000) / 2e5
    for law in (Linear(4e4, 20.0), Hertz(1e6, 300.0)):
        scene = Scene((Body("m", MASS, -SPEED),), (Contact("hit", "m", GROUND, law),))
        response = simulate(given_modes([], [], {})[0], scene, Clock(0.01, 2e5))
        pulse = pulse_of(t, response.contacts["hit"].force)
        rebound = response.bodies["m"].velocity[-1] / SPEED
        assert pulse.restitution(MASS, SPEED) == pytest.approx(rebound, abs=2e-3)  # sums of samples: 2e-4 here
        started = pulse.linear(MASS, SPEED) if isinstance(law, Linear) else pulse.hertz(MASS, SPEED)
        assert started.stiffness == pytest.approx(law.stiffness, rel=0.33)  # a third, as said above
        assert started.damping == pytest.approx(law.damping, rel=0.33)  # a third


def test_constants_of_a_hertz_pulse() -> None:
    """It lasts 2.943 d_max / v in the textbooks; its dashpot loses what c d^0.5 d' does along sqrt(1 - x^2.5)."""
    assert abs(LASTS - 2.943) < 5e-4  # three decimals
    lost = 2.0 * quad(lambda u: 2.0 * u * u * np.sqrt(1.0 - u**5), 0.0, 1.0)[0]  # x = u^2
    assert abs(LOSES / lost - 1.0) < ROUNDING


def test_correlation_of_a_straight_line_that_falls() -> None:
    """Slope and offset of a line are correlated as numpy has them, whatever the sign of a start."""
    t = np.linspace(0.0, 3.0, 40)
    line = 5.0 - 2.0 * t + np.random.default_rng(2).normal(0.0, 0.1, 40)
    found = fit(lambda p: p["a"] * t + p["b"], line, {"a": -1.0, "b": 1.0})
    covariance = np.polyfit(t, line, 1, cov=True)[1]
    assert found.correlation[0, 1] == pytest.approx(
        covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1]), rel=ROUNDING
    )
    assert found.deviations["a"] == pytest.approx(np.sqrt(covariance[0, 0]), rel=ROUNDING)


def test_pulses_that_cannot_be_are_refused() -> None:
    with pytest.raises(FemstructError, match="does not return to zero"):
        pulse_of(T[:10], half_sine(1e4)[:10])
    with pytest.raises(FemstructError, match="check the gain of the sensor"):
        pulse_of(T, 3 * half_sine(4e4)).restitution(MASS, SPEED)


def test_what_the_data_cannot_determine_is_named() -> None:
    """A force is v sqrt(k m) sin(sqrt(k / m) t): two numbers, which do not give three."""
    measured = half_sine(4e4)
    found = fit(engine, measured, {"k": 3e4, "m": 0.25, "v": 1.2})
    assert found.values["k"] / found.values["m"] == pytest.approx(4e4 / MASS, rel=1e-6)  # the fit ends there
    assert found.values["m"] * found.values["v"] == pytest.approx(MASS * SPEED, rel=1e-6)
    # k, m and v have the same pulse when k and m grow by as much as v falls
    # derivatives are good to 1e-6
    assert found.open * np.sign(found.open[0, 0]) == pytest.approx(np.array([[1, 1, -1]]) / np.sqrt(3.0), abs=1e-4)
    assert np.isinf([found.high[name] for name in "kmv"]).all()
    with pytest.raises(InputError, match="fit other: got data that do not depend on it"):
        fit(engine, measured, {"k": 3e4, "other": 2.0})
    with pytest.raises(InputError, match="start of 0"):
        fit(engine, measured, {"k": 0.0})
    with pytest.raises(InputError, match="2 samples, expected more than 2"):
        fit(lambda values: np.array([values["a"], values["b"]]), np.ones(2), {"a": 1.0, "b": 1.0})


def test_a_parameter_that_is_not_there_ends_at_zero_and_says_so() -> None:
    """This noise would like the dashpot to push: its best value is the end of the range."""
    found = [fit(engine, noisy(half_sine(4e4), seed), {"k": 3e4, "c": 1.0}) for seed in range(4)]
    ends = [one for one in found if "fitted-zero" in codes(one)]
    assert ends  # half of all draws
    assert all(one.values["c"] < 1e-5 < one.high["c"] for one in ends)  # the start, not a tolerance


def test_a_shift_is_found() -> None:
    """A history that begins 0.3 ms later, between two samples."""

    def shifted(values: Mapping[str, float]) -> Floats:
        return np.interp(T - values["late"], T, half_sine(values["k"]), left=0.0)

    found = fit(shifted, shifted({"k": 4e4, "late": 3e-4}), {"k": 3e4}, {"late": 1 / SAMPLING})
    assert found.values["late"] == pytest.approx(3e-4, rel=ROUNDING)
    assert found.values["k"] == pytest.approx(4e4, rel=ROUNDING)


def test_a_wrong_law_is_told() -> None:
    """A linear law on the force of a Hertz contact."""
    scene = Scene((Body("m", MASS, -SPEED),), (Contact("hit", "m", GROUND, Hertz(1e6)),))
    measured = simulate(given_modes([], [], {})[0], scene, Clock(SAMPLES / SAMPLING, SAMPLING)).contacts["hit"].force
    assert "residuals-not-noise" in codes(fit(engine, noisy(measured, 1), {"k": 4e4}))
    late = np.concatenate((np.zeros(30), half_sine(4e4)[:-30]))  # a record that began before the blow
    found = fit(engine, late, {"k": 4e4})
    severe = [finding for finding in fit_findings(found) if finding.severe]
    assert [finding.code for finding in severe] == ["poor-fit"]
    left = float(np.linalg.norm(found.residuals) / np.linalg.norm(late))
    assert severe[0].values["left_over"] == pytest.approx(left)


def test_coloured_noise_widens_by_its_own_factor() -> None:
    """Noise of correlation r from sample to sample: the advice is sqrt((1 + r) / (1 - r))."""
    rng, r, n = np.random.default_rng(5), 0.6, 4000
    noise = np.zeros(n)
    for i, one in enumerate(rng.standard_normal(n)[1:], start=1):
        noise[i] = r * noise[i - 1] + one
    found = fit(lambda values: values["mean"] * np.ones(n), 100.0 + noise, {"mean": 90.0})
    told = next(finding for finding in fit_findings(found) if finding.code == "residuals-not-noise")
    assert told.values["wider"] == pytest.approx(np.sqrt((1 + r) / (1 - r)), rel=0.1)  # r is known to 1 / sqrt(4000)
    # and the spread of such a mean is indeed that much larger than white noise's
    assert found.deviations["mean"] * told.values["wider"] == pytest.approx(1 / (1 - r) / np.sqrt(n), rel=0.1)


def test_data_that_hardly_tell_are_told() -> None:
    """Noise of 0.3 of the peak: half of what was measured is left over, but it is noise, and the law may be right."""
    found = fit(engine, noisy(engine({"k": 4e4, "c": 2.0}), 2, share=0.3), {"k": 3e4, "c": 3.0})
    assert codes(found) & {"parameter-open", "fitted-zero"}
    poor = next(finding for finding in fit_findings(found) if finding.code == "poor-fit")
    assert not poor.severe
    assert poor.values["left_over"] == pytest.approx(np.sqrt(1 - found.explained))


def test_stated_scatter_is_taken_unless_the_residuals_exceed_it() -> None:
    """A mean of 50 numbers of a stated scatter: its interval is 1.96 s / sqrt(50). With noise of three times that it is
    Student's of the residuals, and a finding has the ratio."""
    rng, s = np.random.default_rng(4), 0.2
    (one,) = [parameter("mean", 3.0)]
    for times in (1.0, 3.0):
        measured = 2.0 + times * s * rng.standard_normal(50)
        found = fit_parameters(lambda values, of=measured: (values["mean"] - of) / s, [one], 1.0, known=True)  # type: ignore[misc]
        half = 0.5 * (found.high["mean"] - found.low["mean"])
        rms = float(np.sqrt((found.residuals**2).mean()))
        told = {
            finding.code: finding for finding in fit_findings(found, [Left("floor", found.residuals, 0, True, 0.0, 50)])
        }
        if times == 1.0:
            assert found.known and not told
            assert half == pytest.approx(1.959964 * s / np.sqrt(50.0), rel=1e-6)  # seven digits
        else:
            t95 = 2.009575  # Student's t, 97.5 %, 49 degrees of freedom, from tables
            assert not found.known and half == pytest.approx(t95 * measured.std(ddof=1) / np.sqrt(50.0), rel=1e-6)
            assert told["fit-beyond-scatter"].values["times"] == pytest.approx(rms) and rms > 2.0
            assert not told["fit-beyond-scatter"].severe
    (worse,) = fit_findings(found, [Left("floor", 2.0 * found.residuals, 0, True, 0.0, 50)])
    assert worse.severe  # six times the scatter


def test_a_given_bound_is_named() -> None:
    found = fit_parameters(
        lambda values: np.array([values["a"] - 5.0]), [parameter("a", 2.0, 1.0, 4.0)], 5.0, known=True
    )
    assert found.at_bound == ("a",) and found.values["a"] == pytest.approx(4.0, rel=1e-6)  # the search keeps inside
    assert "parameter-at-bound" in codes(found)
    free = fit_parameters(
        lambda values: np.array([values["a"] - 3.9]), [parameter("a", 2.0, 1.0, 4.0)], 5.0, known=True
    )
    assert not free.at_bound and "parameter-at-bound" not in codes(free)


def test_intervals_beside_a_parameter_at_its_bound_are_those_with_it_fixed() -> None:
    """A line whose slope may be 0.5 at most, where it is 2: its offset is the mean of what a slope of 0.5 leaves."""
    x, s, n = np.linspace(0.0, 1.0, 40), 0.05, 40
    measured = 1.0 + 2.0 * x + s * np.random.default_rng(2).standard_normal(n)
    starts = [parameter("offset", 1.0), parameter("slope", 0.4, 0.1, 0.5)]
    found = fit_parameters(lambda values: values["offset"] + values["slope"] * x - measured, starts, 1.0)
    left = measured - 0.5 * x
    t39 = 2.022691  # Student's t, 97.5 %, 39 degrees of freedom, from tables
    half = 0.5 * (found.high["offset"] - found.low["offset"])
    assert found.values["offset"] == pytest.approx(left.mean(), rel=1e-6)  # as far as the bound is approached
    assert half == pytest.approx(t39 * left.std(ddof=1) / np.sqrt(n), rel=1e-6)  # seven digits of the table
    assert np.isnan([found.low["slope"], found.high["slope"], found.deviations["slope"]]).all()
    assert np.isnan(found.correlation[0, 1]) and found.correlation[0, 0] == pytest.approx(1.0)
    assert [found.why_no_interval(name) for name in found.values] == ["", "at its bound"]
    assert not combinations(found, {}, lambda values: x)


def test_what_is_hardly_distinguished_is_named_with_its_interval() -> None:
    """Slope and offset of a line far from its origin: of one per cent of noise the sum is known, the parts are not."""
    x = np.linspace(10.0, 10.2, 20)
    starts = [parameter("a", 1.0), parameter("b", 1.0)]

    def residuals(values: Mapping[str, float]) -> Floats:
        return ((values["a"] - 1.0) * x / 10.1 + values["b"] - 1.0) / 0.02

    found = fit_parameters(residuals, starts, 100.0, known=True)
    (one,) = combinations(found, {"a": "", "b": ""}, residuals)
    assert one.names == ("a", "b") and one.changes == pytest.approx((0.1, -0.1), rel=1e-3)  # the line is nearly flat
    spread = np.sqrt(np.linalg.inv(np.stack([x / 10.1, np.ones(20)]) @ np.stack([x / 10.1, np.ones(20)]).T).trace())
    assert one.half_along == pytest.approx(1.96 * 0.02 * spread, rel=1e-3)  # the other direction has 1e-4 of it
    (kept,) = one.kept
    assert kept.formula == "a + b" and kept.half == pytest.approx(1.96 * 0.02 / np.sqrt(20.0) / 2.0, rel=1e-2)  # nearly
    assert "hardly distinguish" in one.sentence and "parameters-not-distinguished" in {
        finding.code for finding in fit_findings(found, [], [one])
    }


def test_a_small_share_in_what_is_open_leaves_a_parameter_open() -> None:
    """Bending sees E / (1 - nu^2) alone: nu from .1 to .3 is 8 % of E, however well the frequencies are measured."""
    starts = [parameter("E", 28.0, 20.0, 45.0), parameter("nu", 0.2, 0.1, 0.3)]
    measured = np.array([29.35, 63.4, 82.95])

    def residuals(values: Mapping[str, float]) -> Floats:
        bending = values["E"] / 28.2 * (1.0 - 0.2**2) / (1.0 - values["nu"] ** 2)
        return (measured * (np.sqrt(bending) - 1.0)) / (0.005 * measured)

    found = fit_parameters(residuals, starts, 100.0, known=True)
    assert np.isinf(found.deviations["E"]) and np.isinf(found.deviations["nu"])
    (one,) = combinations(found, {"E": "GPa", "nu": ""}, residuals)
    nu = found.values["nu"]
    slope = -(1.0 - nu**2) / (2.0 * nu**2)  # dlog nu over dlog E where E / (1 - nu^2) stays
    assert one.names == ("E", "nu") and one.changes == pytest.approx((0.1, 0.1 * slope), rel=1e-3)  # differences
    (kept,) = one.kept
    # twice the scatter of a frequency, of three: 1.96 x 2 x 0.5 % / sqrt(3)
    assert kept.half == pytest.approx(1.96 * 2.0 * 0.005 / np.sqrt(3.0), rel=1e-3)
