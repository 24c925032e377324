"""A machine under a shock and its conventional remedies, against integrals of their equations of motion by scipy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.workflow.run import run_study

STUDY = Path(__file__).parents[2] / "models" / "conventional_remedies.study.yaml"
SHOCK, PULSE = 2e3, 10e-3  # [N], [s]
STIFFNESS = 100.0 * (2 * np.pi * 5.0) ** 2


@pytest.fixture(scope="module")
def study() -> StudyResult:
    return run_study(read_study(STUDY, ("time.duration=0.1 s",)))


def _largest(M: np.ndarray, C: np.ndarray, K: np.ndarray) -> float:
    """Largest displacement of the first mass in 0.1 s; the first one is pushed."""
    n, inverse = len(M), np.linalg.inv(M)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        push = np.zeros(n)
        push[0] = -SHOCK * np.sin(np.pi * t / PULSE) if t < PULSE else 0.0
        return np.concatenate([y[n:], inverse @ (push - K @ y[:n] - C @ y[n:])])

    found = solve_ivp(rate, (0, 0.1), np.zeros(2 * n), "DOP853", np.linspace(0, 0.1, 5001), rtol=1e-9, atol=1e-12,
                      max_step=1e-4)  # fmt: skip
    return float(np.abs(found.y[0]).max())


@pytest.mark.parametrize(("case", "mass"), [("flexible", 100.0), ("added mass", 120.0)])
def test_one_mass(study: StudyResult, case: str, mass: float) -> None:
    damping = 2 * 0.02 * np.sqrt(STIFFNESS * mass)
    expected = _largest(np.diag([mass]), np.array([[damping]]), np.array([[STIFFNESS]]))
    # 2e-5: samples at 5 kHz beside the peak, and five digits of the frequency in the file
    assert study.cases[case].channels["m.z displacement"].whole == pytest.approx(expected, rel=2e-5)


def test_absorber(study: StudyResult) -> None:
    k, c, own = 13708.0, 261.8, 2 * 0.02 * np.sqrt(STIFFNESS * 100.0)
    tie = np.array([[1.0, -1.0], [-1.0, 1.0]])
    expected = _largest(np.diag([100.0, 20.0]), np.diag([own, 0.0]) + c * tie, np.diag([STIFFNESS, 0.0]) + k * tie)
    # samples of the peak: 5e-7 here
    assert study.cases["absorber"].channels["m.z displacement"].whole == pytest.approx(expected, rel=2e-5)


def test_what_the_file_says(study: StudyResult) -> None:
    printed = {"flexible": 3.92, "bumper": 3.07, "absorber": 3.59, "added mass": 3.58, "impact damper": 3.28}
    for case, value in (printed | {"preview": 1.74}).items():
        # half a unit of the last digit
        assert 1e3 * study.cases[case].channels["m.z displacement"].whole == pytest.approx(value, abs=6e-3)
    assert study.cases["bumper"].channels["net force on m"].whole == pytest.approx(534, abs=0.5)
