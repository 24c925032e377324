"""The YAML of chapter 5 and the functions of scripts/systems agree; 5.45 is the optimum where it claims to be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from systems import boat, hull
from systems import pinned_beam as pinned

from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

MODELS = Path(__file__).parents[2] / "models"


def test_boat_study_is_the_closed_form() -> None:
    """a / a0 = (2 sqrt(2) / 9) sqrt((1 + mu) / mu) at 5.45, derived from the two-mass equations for omega = 0."""
    result = run_study(read_study(MODELS / "boat_wave.study.yaml"))
    peaks = {name: case.channels["m.z acceleration"].whole for name, case in result.cases.items()}
    # the stiffness in the file has five digits, and the peak is that of samples 1/1000 of a pulse apart
    assert peaks["damper"] / peaks["no damper"] == pytest.approx(boat.ratio_at_optimum(0.6), rel=2e-5)


@pytest.mark.parametrize("mu", [0.3, 0.7, 1.4])
def test_optimum_of_5_45(mu: float) -> None:
    gamma, low = boat.best(mu)
    assert gamma == pytest.approx(boat.optimum(mu), rel=3e-5)  # where the search stops in a flat minimum: 3e-7 here
    assert low == pytest.approx(boat.ratio_at_optimum(mu), rel=1e-5)  # samples of the peak: 2e-7 here


def test_optimum_departs_where_the_peak_splits() -> None:
    """An independent computation: at 0.1 the best is 7 % below 5.45."""
    assert boat.best(0.1)[0] == pytest.approx(2.658264, abs=3e-4)  # a flat minimum


@pytest.mark.parametrize(("mu", "elastic", "other"), [(0.3, 20.0, 0.6498), (0.3, 10.0, 0.6476)])
def test_hull_against_another_engine(mu: float, elastic: float, other: float) -> None:
    """A bending hull at 5.45: digits of an independent engine; how many modes it had matters for softer hulls."""
    assert boat.hull_ratio(mu, boat.optimum(mu), elastic) == pytest.approx(other, abs=1e-4)  # four decimals


def test_shipped_hull_is_the_identified_one() -> None:
    """293 and 388 Hz, which it was found from; the acceleration ratio of the study is that of the functions."""
    own = hull.identified()
    # where the fit stops: 3e-7 here
    assert hull.frequencies(own.basis, own.model) == pytest.approx((293.0, 388.0), rel=1e-5)
    result = run_study(read_study(MODELS / "foam_hull_wave.study.yaml"))
    model, shipped = (getattr(result, name)[result.cases["damper"].basis_key] for name in ("models", "bases"))
    assert hull.frequencies(shipped, model) == pytest.approx((293.0, 388.0), rel=1e-4)  # digits of the file
    peaks = {name: case.channels["A.z acceleration"].values.max() for name, case in result.cases.items()}
    # 1e-3: the study has residual vectors for the damper and the water, the functions have 20 modes
    assert peaks["damper"] / peaks["no damper"] == pytest.approx(hull.ratio(own, 0.3, boat.optimum(0.3)), rel=1e-3)


def test_a_stiff_hull_under_a_slow_wave_is_two_rigid_masses() -> None:
    """As E grows 400 times, bending is 200 times the wave's frequency: the closed form of 5.45, with the front end as
    good a place as any. What is left falls as the square of that ratio."""
    own = hull.identified()
    model, basis = hull.solved(0.05, own.thickness, 400.0 * own.E, count=20)
    stiff = hull.Hull(0.05, own.thickness, 400.0 * own.E, model, basis)
    # bending at 200 times the wave's frequency: 1.2e-3 here
    assert hull.ratio(stiff, 0.6, boat.optimum(0.6)) == pytest.approx(boat.ratio_at_optimum(0.6), rel=2e-3)


def test_beam_at_the_first_separation() -> None:
    """Printed digits of an independent event-driven engine, without a damper."""
    end = pinned.separation(pinned.fall(9.0))
    # six decimals
    assert end.modes == pytest.approx([0.720991, 0.041368, 0.007661, 0.04423, 0.005412, 0.015221], abs=1e-6)
    assert 1e3 * end.t == pytest.approx(0.6604, abs=1e-4)  # four decimals


def test_beam_study_is_the_beam_of_the_functions() -> None:
    result = run_study(read_study(MODELS / "pinned_beam_wave.study.yaml"))
    parameters = {"no damper": (0.0, 0.0), "five": (0.3, 5.0), "point P": (0.3, 17.9), "forty": (0.3, 40.0)}
    for case, (mu, damper) in parameters.items():
        response = result.cases[case].response
        assert response is not None
        found, expected = pinned.separation(response), pinned.separation(pinned.fall(9.0, mu, damper))
        # 1e-6: the stiffnesses in the file have seven digits
        assert found.t == pytest.approx(expected.t, rel=1e-6)
        assert found.modes == pytest.approx(expected.modes, abs=1e-6)


# An independent event-driven engine: 6 modes, wave contact 5e5 N/m, up to 1.5 ms; largest and least acceleration of the
# free end [m/s^2] with a damper by 5.45, and with its mass fixed to the middle.
ENDS = {0.1: ((368.407, -398.454), (375.741, -423.207)), 0.4: ((221.66, -238.526), (196.703, -252.335))}


def test_accelerations_of_the_free_end() -> None:
    """3e-4: their samples. The middle of the beam, which is no end, is another matter: 433.5 and -346.5."""
    _, free = pinned.accelerations(5e5)
    assert (free.max(), free.min()) == pytest.approx((509.43, -544.983), rel=3e-4)
    for mu, (damper, added) in ENDS.items():
        _, values = pinned.accelerations(5e5, mu, boat.optimum(mu))
        assert (values.max(), values.min()) == pytest.approx(damper, rel=3e-4)
        _, values = pinned.accelerations(5e5, added=mu)
        assert (values.max(), values.min()) == pytest.approx(added, rel=3e-4)
    _, middle = pinned.accelerations(5e5, place="middle")
    assert (middle.max(), middle.min()) == pytest.approx((433.5, -346.5), abs=0.05)  # one decimal


def test_acceleration_study_is_the_fall_of_the_functions() -> None:
    result = run_study(read_study(MODELS / "pinned_beam_acceleration.study.yaml"))
    for case, mu in {"no damper": 0.0, "damper 0.1": 0.1, "damper 0.2": 0.2, "damper 0.4": 0.4}.items():
        _, expected = pinned.accelerations(5e5, mu, boat.optimum(mu) if mu else 0.0)
        channel = result.cases[case].channels["free end.z acceleration"]
        # of the largest: the stiffnesses in the file have seven digits
        assert channel.values == pytest.approx(expected, abs=1e-5 * float(np.abs(expected).max()))


def test_accelerations_with_twelve_modes() -> None:
    """The same engine: the order of damper and added mass is the other way round."""
    _, damper = pinned.accelerations(5e5, 0.1, boat.optimum(0.1), modes=12)
    assert (damper.max(), damper.min()) == pytest.approx((443.984, -812.97), rel=3e-4)  # their samples
    _, added = pinned.accelerations(5e5, modes=12, added=0.1)
    assert added.min() == pytest.approx(-628.915, rel=3e-4)


@pytest.mark.parametrize(
    ("mu", "places"),
    [(0.1, [(2.87, 0.789)]), (0.3, [(2.026, 0.7017), (3.7, 0.7063)]), (0.6, [(1.365, 0.6098), (2.612, 0.6131)])],
)
def test_lowest_places_of_the_beam_s_energy(mu: float, places: list[tuple[float, float]]) -> None:
    """The same engine, on its grid; ours has steps of 0.01."""
    wave = 4.7e3 / (2 * np.pi * float(pinned.frequencies()[1]))
    found = pinned.minima(wave, mu, np.linspace(0.3, 5.0, 471))
    assert np.array(found[: len(places)]) == pytest.approx(np.array(places), abs=0.02)  # two steps: the minima are flat
    # four decimals, and other places on the grid
    assert [energy for _, energy in found[: len(places)]] == pytest.approx([energy for _, energy in places], abs=2e-4)


def test_many_runs_are_single_runs() -> None:
    ratios = np.array([5.0, 17.9, 40.0])
    alone = [pinned.separation(pinned.fall(9.0, 0.3, float(ratio))).beam for ratio in ratios]
    assert pinned.beam_energies(9.0, 0.3, ratios) == pytest.approx(alone, rel=1e-13)  # rounding: 8e-16 here


def test_energies_are_all_there() -> None:
    end = pinned.separation(pinned.fall(9.0, 0.3, 5.0))
    # rounding: 1e-15 here
    assert float(np.sum(end.modes)) + end.wave + end.spring + end.damper == pytest.approx(1.0, abs=1e-12)
