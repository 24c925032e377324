"""Walkers: the force against its series, resonance and a path against integrals by DOP853."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from femstruct.errors import FemstructError, InputErrors
from femstruct.impact.scene import Walk, design_harmonics
from femstruct.language.cases import read_study
from femstruct.study.results import CaseResult
from femstruct.workflow.run import run_study

ROUNDING = 1e-13  # rounding: 1e-15 here at most

WALK = Walk(70.0, 2.0, 8, (0.4, 0.1, 0.05))
G = 70.0 * 9.80665


def run(folder: Path, model: str, study: str) -> CaseResult:
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    (folder / "one.study.yaml").write_text(f"model: model.yaml\n{study}", encoding="utf-8")
    return run_study(read_study(folder / "one.study.yaml")).cases["as given"]


def series(t):
    """The force by hand, downwards, in its middle part."""
    return G * (1 + 0.4 * np.sin(4 * np.pi * t) + 0.1 * np.sin(8 * np.pi * t) + 0.05 * np.sin(12 * np.pi * t))


def whole(t: float) -> float:
    """With its first and last step."""
    rise = min(1.0, max(0.0, min(t, 4.0 - t) / 0.5))
    return float(series(t)) * np.sin(0.5 * np.pi * rise) ** 2


def test_design_amplitudes_by_pace():
    """CCIP-016 as quoted: .41 (f - .95) up to .56, .069 + .0056 f, .033 + .0064 f, .013 + .0065 f, f the harmonic's."""
    for pace in (1.0, 1.8, 2.8):
        wanted = (min(0.41 * (pace - 0.95), 0.56), 0.069 + 0.0112 * pace, 0.033 + 0.0192 * pace, 0.013 + 0.026 * pace)
        assert design_harmonics(pace) == pytest.approx(wanted, rel=ROUNDING)
    assert design_harmonics(2.5)[0] == 0.56
    with pytest.raises(FemstructError, match=r"pace: got 3 Hz, expected 1 to 2\.8 Hz"):
        design_harmonics(3.0)


def test_the_force_is_its_series_and_is_shared_along_the_path():
    t = np.linspace(0.5, 3.5, 301)
    np.testing.assert_allclose(WALK.force(t), series(t), rtol=ROUNDING)
    assert WALK.force(np.array([0.0, 4.0])).tolist() == pytest.approx([0.0, 0.0], abs=1e-9)
    tables = WALK.tables(5)
    times = tables[0].times
    values = np.array([table.values for table in tables])
    np.testing.assert_allclose(-values.sum(axis=0), WALK.force(times), rtol=ROUNDING, atol=1e-9)
    moving = values[:, 1:-1]
    at = (np.arange(5) @ moving) / moving.sum(axis=0)  # where the force acts, in places: an even walk
    np.testing.assert_allclose(at, times[1:-1], rtol=0, atol=1e-9)  # 4 s along 4 lengths


def test_on_the_spot_an_oscillator_resonates_with_the_second_harmonic(tmp_path: Path) -> None:
    mass, frequency, ratio = 2000.0, 4.0, 0.02
    model = f"""structure: {{type: oscillator, mass: {mass}, frequency: {frequency}}}
points: {{m: {{}}}}
damping: {{ratio: {ratio}}}
"""
    case = run(tmp_path, model, """modes: {count: 1}
loads: {me: {along: m, walking: {mass: 70 kg, pace: 2 Hz, steps: 8, harmonics: [0.4, 0.1, 0.05]}}}
record: {m.z: velocity}
time: {duration: 5 s, sampling: 1 kHz}
""")  # fmt: skip
    omega = 2 * np.pi * frequency
    t = np.arange(5000) / 1e3
    exact = solve_ivp(
        lambda t, y: [y[1], -whole(t) / mass - 2 * ratio * omega * y[1] - omega**2 * y[0]],
        (0, 5), [0.0, 0.0], "DOP853", t_eval=t, rtol=1e-9, atol=1e-12, max_step=0.01,
    )  # fmt: skip
    # straight lines of 32 points to the third harmonic's period miss .22 % of the second's amplitude
    error = np.abs(case.channels["m.z velocity"].values - exact.y[1]).max() / np.abs(exact.y[1]).max()
    assert error < 3e-3  # 1.3e-3 here
    assert {one.code for one in case.findings} & {"walking-below-modes", "walking-low-frequency-only"} == set()


def test_a_path_along_a_beam_is_a_moving_force(tmp_path: Path) -> None:
    """Pinned beam, first mode: phi = sqrt(2 / m L) sin(pi x / L) with x = L t / 4 s; 17 places miss (pi / 16)^2 / 8 of
    the shape between them, .5 %."""
    length, per_length, stiffness = 10.0, 100.0, 2e6
    places = ", ".join(f"p{i}" for i in range(17))
    points = ", ".join(f"p{i}: {{at: {length * i / 16}}}" for i in range(17))
    beam = f"length: {length}, ends: [pinned, pinned], EI: {stiffness}, mass_per_length: {per_length}, modes: 1"
    model = f"""structure: {{type: beam, {beam}}}
points: {{{points}}}
damping: {{ratio: 2 %}}
"""
    case = run(tmp_path, model, f"""modes: {{count: 1}}
loads: {{me: {{along: [{places}], walking: {{mass: 70 kg, pace: 2 Hz, steps: 8, harmonics: [0.4, 0.1, 0.05]}}}}}}
record: {{p8.z: [displacement, velocity]}}
time: {{duration: 5 s, sampling: 1 kHz}}
""")  # fmt: skip
    omega = (np.pi / length) ** 2 * np.sqrt(stiffness / per_length)
    top = np.sqrt(2 / (per_length * length))
    t = np.arange(5000) / 1e3
    exact = solve_ivp(
        lambda t, y: [
            y[1],
            -whole(t) * top * np.sin(np.pi * min(t, 4.0) / 4.0) - 0.04 * omega * y[1] - omega**2 * y[0],
        ],
        (0, 5), [0.0, 0.0], "DOP853", t_eval=t, rtol=1e-9, atol=1e-12, max_step=0.01,
    )  # fmt: skip
    for channel, values in (("displacement", exact.y[0]), ("velocity", exact.y[1])):
        error = np.abs(case.channels[f"p8.z {channel}"].values - top * values).max() / np.abs(top * values).max()
        assert error < 1e-2, channel  # .5 %, as said above


def test_what_a_walker_cannot_tell_is_said(tmp_path: Path) -> None:
    model = "structure: {type: oscillator, mass: 2 t, frequency: 15 Hz}\npoints: {m: {}}\n"
    case = run(tmp_path, model, """modes: {count: 1}
loads: {me: {along: m, walking: {mass: 70 kg, pace: 2 Hz, steps: 2}}}
record: {m.z: velocity}
time: {duration: 1 s, sampling: 1 kHz}
""")  # fmt: skip
    found = next(one for one in case.findings if one.code == "walking-below-modes")
    assert (found.values["highest_hz"], found.values["first_mode_hz"]) == (8.0, pytest.approx(15.0))


@pytest.mark.parametrize(
    ("load", "told"),
    [
        ("along: m, walking: {mass: 70 kg, pace: 4 Hz, steps: 9}", "got a pace of 4 Hz, expected 1 to 2.8 Hz"),
        ("along: m, walking: {mass: 70 kg, pace: 2 Hz, steps: 1}", "got 1 step, expected 2 or more"),
        ("along: q, walking: {mass: 70 kg, pace: 2 Hz, steps: 9}", "got 'q', expected the name of a point"),
        ("at: m.z, walking: {mass: 70 kg, pace: 2 Hz, steps: 9}", "walking without along"),
        ("along: m, half_sine: {amplitude: 1 N, frequency: 2 Hz}", "along without walking"),
    ],
)
def test_mistakes_are_told_with_their_line(tmp_path: Path, load: str, told: str) -> None:
    model = "structure: {type: oscillator, mass: 2 t, frequency: 15 Hz}\npoints: {m: {}}\n"
    study = f"modes: {{count: 1}}\nloads: {{me: {{{load}}}}}\ntime: {{duration: 1 s, sampling: 1 kHz}}\n"
    with pytest.raises(InputErrors, match=told):
        run(tmp_path, model, study)
