"""The YAML of chapter 5 and the functions of scripts/systems agree; 5.45 is the optimum where it claims to be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from systems import boat
from systems import pinned_beam as pinned

from femstruct import read_study, run_study

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
    assert gamma == pytest.approx(boat.optimum(mu), rel=1e-4)
    assert low == pytest.approx(boat.ratio_at_optimum(mu), rel=1e-5)


def test_optimum_departs_where_the_peak_splits() -> None:
    """An independent computation: at 0.1 the best is 7 % below 5.45."""
    assert boat.best(0.1)[0] == pytest.approx(2.658264, abs=3e-4)  # a flat minimum


@pytest.mark.parametrize(("mu", "elastic", "other"), [(0.3, 20.0, 0.6498), (0.3, 10.0, 0.6476)])
def test_hull_against_another_engine(mu: float, elastic: float, other: float) -> None:
    """A bending hull at 5.45: digits of an independent engine; how many modes it had matters for softer hulls."""
    assert boat.hull_ratio(mu, boat.optimum(mu), elastic) == pytest.approx(other, abs=1e-4)


def test_beam_at_the_first_separation() -> None:
    """Printed digits of an independent event-driven engine, without a damper."""
    end = pinned.separation(pinned.fall(9.0))
    assert end.modes == pytest.approx([0.720991, 0.041368, 0.007661, 0.04423, 0.005412, 0.015221], abs=1e-6)
    assert 1e3 * end.t == pytest.approx(0.6604, abs=1e-4)


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


def test_energies_are_all_there() -> None:
    end = pinned.separation(pinned.fall(9.0, 0.3, 5.0))
    assert float(np.sum(end.modes)) + end.wave + end.spring + end.damper == pytest.approx(1.0, abs=1e-9)
