"""Shock response spectra against closed forms, an integrator, and as a study reports them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from femstruct.errors import InputError, InputErrors
from femstruct.evaluations.shock import ShockRequest, shock_spectrum
from femstruct.files.results_file import read_results, write_results
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

SAMPLING = 50e3


def half_sine(duration: float, length: float = 0.05) -> np.ndarray:
    t = np.arange(round(length * SAMPLING)) / SAMPLING
    return np.where(t < duration, 100.0 * np.sin(np.pi * t / duration), 0.0)


def test_a_half_sine_is_amplified_by_1_77_at_most() -> None:
    """Harris, Shock and Vibration Handbook: the undamped maximax of a half sine is 1.77 where f T is about 0.8; far
    below it is that of the change of velocity, 2 pi f dv; far above the pulse itself."""
    duration = 11e-3
    frequencies = np.geomspace(1.0, 2000.0, 300)
    found = shock_spectrum(half_sine(duration), SAMPLING, frequencies, 0.0)
    assert found.largest == pytest.approx(177.0, rel=3e-3)  # three digits
    assert found.largest_at_hz * duration == pytest.approx(0.81, abs=0.02)  # of the grid of frequencies
    dv = 100.0 * 2 * duration / np.pi
    assert found.maximax[0] == pytest.approx(2 * np.pi * dv, rel=1e-3)  # (f T)^2 / 2 at 1 Hz
    assert found.maximax[-1] == pytest.approx(100.0, rel=0.05)  # it still rings by 1 / (2 f T)


@pytest.mark.parametrize("ratio", [0.01, 0.03, 0.05])
def test_the_largest_of_a_spectrum_is_that_of_a_resonance(ratio: float) -> None:
    """A base that hums: sqrt(1 + 4 zeta^2) / 2 zeta at its frequency, wherever that lies between the lines."""
    rate, t = 4000.0, np.arange(0.0, 0.08 / ratio, 1.0 / 4000.0)
    for hum in 97.0 * 2.0 ** (np.arange(7) / 97.0):
        found = ShockRequest("s", "m.z", ratio, (20.0, 400.0)).answer(np.sin(2 * np.pi * hum * t), rate)
        right = np.sqrt(1 + 4 * ratio**2) / (2 * ratio)
        assert 0.965 * right < found.largest < 1.005 * right  # 3 % of the lines, .5 % of samples and of the start


@pytest.mark.parametrize(("frequency", "ratio"), [(30.0, 0.05), (90.0, 0.0), (400.0, 0.2)])
def test_as_an_integrator_has_it(frequency: float, ratio: float) -> None:
    """x'' + 2 zeta w (x' - y') + w^2 (x - y) = 0 by Runge-Kutta, the acceleration straight between its samples."""
    rng = np.random.default_rng(2)
    coarse = np.concatenate([[0.0], rng.normal(size=24), [0.0]])
    t = np.arange(round(0.05 * SAMPLING)) / SAMPLING
    base = np.interp(t, np.linspace(0.0, 0.045, len(coarse)), coarse)
    w = 2 * np.pi * frequency

    def rates(time: float, state: np.ndarray) -> list[float]:
        away, speed = state
        return [speed, -np.interp(time, t, base) - 2 * ratio * w * speed - w**2 * away]

    end = t[-1] + 1.0 / frequency
    exact = solve_ivp(rates, (0.0, end), [0.0, 0.0], rtol=1e-8, atol=1e-12, max_step=2e-4, dense_output=True)
    times = np.arange(0.0, end, 1.0 / SAMPLING)
    away, speed = exact.sol(times)
    absolute = -2 * ratio * w * speed - w**2 * away
    found = shock_spectrum(base, SAMPLING, np.array([frequency]), ratio)
    assert found.positive[0] == pytest.approx(absolute.max(), rel=1e-3)  # samples of both are apart by less
    assert found.negative[0] == pytest.approx(-absolute.min(), rel=1e-3)  # samples of both are apart by less


def test_what_it_refuses() -> None:
    with pytest.raises(InputError, match="at most a tenth of the sampling, 100 Hz"):
        shock_spectrum(np.zeros(10), 1000.0, np.array([101.0]), 0.05)
    with pytest.raises(InputError, match="a ratio from 0 to below 1"):
        shock_spectrum(np.zeros(10), 1000.0, np.array([10.0]), 1.0)


MODEL = "structure: {type: oscillator, mass: 2 kg, frequency: 40 Hz}\npoints: {m: {}}\n"
STUDY = """
model: model.yaml
bodies: {ball: {mass: 0.5 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
record: {m.z: acceleration}
shock_spectra: {seat: {of: m.z, band: [10 Hz, 1 kHz], damping: 3 %, per_octave: 6}}
time: {duration: 0.2 s, sampling: 20 kHz}
"""


def written(folder: Path, old: str = "", new: str = "") -> Path:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = folder / "hit.study.yaml"
    path.write_text(STUDY.replace(old, new) if old else STUDY, encoding="utf-8")
    return path


def test_python_takes_what_files_take() -> None:
    """Texts with units; what is wrong is told by its argument."""
    given = ShockRequest("foot", "foot.z", "5 %", ("5 Hz", "2 kHz"))  # type: ignore[arg-type]
    assert given == ShockRequest("foot", "foot.z", 0.05, (5.0, 2000.0))
    with pytest.raises(InputError, match=r"shock_spectra\.foot\.damping: got 5, expected a ratio below 1; 2 % is 0.02"):
        ShockRequest("foot", "foot.z", 5, (5.0, 2000.0))
    with pytest.raises(
        InputError, match=r"shock_spectra\.foot\.band: got '2 s', which is a time, expected a frequency"
    ):
        ShockRequest("foot", "foot.z", 0.05, (5.0, "2 s"))  # type: ignore[arg-type]


def test_a_study_reports_it(tmp_path: Path) -> None:
    result = run_study(read_study(written(tmp_path)))
    case = result.cases["as given"]
    found = case.evaluations["shock_spectra"]["seat"]
    assert len(found.frequency_hz) == round(6 * np.log2(100.0)) + 1
    own = case.channels["m.z acceleration"].values
    again = shock_spectrum(own, 20e3, found.frequency_hz, 0.03)
    # the spectrum is that of the displacement; samples miss half an interval where the force sets in: 0.13 % here
    np.testing.assert_allclose(found.maximax, again.maximax, rtol=2e-3)
    table = json.loads(json.dumps(summary(result)))["cases"]["as given"]["shock_spectra"]["seat"]
    assert table["largest"] == pytest.approx(found.largest, rel=1e-12)  # the digits of JSON
    write_results(tmp_path / "results.h5", result)
    kept = read_results(tmp_path / "results.h5").cases["as given"].evaluations["shock_spectra"]["seat"]
    np.testing.assert_array_equal(kept.positive, found.positive)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("of: m.z", "of: m.x", "a recorded acceleration"),
        ("[10 Hz, 1 kHz]", "[10 Hz, 4 kHz]", "4000 Hz, 5 samples a period"),
        ("[10 Hz, 1 kHz]", "[1 kHz, 10 Hz]", "band"),
        ("damping: 3 %", "damping: 300 %", "damping"),
        ("per_octave: 6", "per_octave: 0", "per_octave"),
    ],
)
def test_mistakes_have_their_line(old: str, new: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputErrors) as refused:
        read_study(written(tmp_path, old, new))
    assert told in str(refused.value)
    assert "hit.study.yaml:5:" in str(refused.value)
