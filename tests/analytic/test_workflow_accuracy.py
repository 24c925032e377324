"""The asked accuracy: on a rod whose contact force is known on paper, against eight times the modes, and refused."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.files.results_file import write_results
from femstruct.files.study_tables import summary
from femstruct.impact.resampled import mean_acceleration
from femstruct.language.cases import read_study
from femstruct.study.results import CaseResult, StudyResult
from femstruct.view.terminal import show_study
from femstruct.workflow.recorded_channels import in_band
from femstruct.workflow.run import run_study

ROD = """
structure: {type: rod, length: 2 m, E: 200 GPa, rho: 7850, area: 314.16 mm2, modes: MODES}
points: {left: {at: 0 m}, right: {at: 2 m}}
"""
HIT = """
model: model.yaml
bodies: {ball: {mass: 2.5 kg, before: left, speed: 1 m/s, contact: {type: linear, stiffness: 100 MN/m}}}
record: {left.x: acceleration, right.x: acceleration}
time: {duration: 3 ms, sampling: 100 kHz}
"""
PLATE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [0.5, 0.4], mesh: MESH}}
points: {off: {on: plate, at: [0.17, 0.11]}, far: {on: plate, at: [0.35, 0.28]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
damping: {ratio: 2 %}
"""
DROP = """
model: model.yaml
modes: {up_to: 450 Hz}
bodies: {ball: {mass: 4.11 g, above: off, drop_height: 5 cm, contact: {type: hertz, stiffness: 1e7}}}
record: {off.z: acceleration, far.z: acceleration}
time: {duration: 0.1 s, sampling: 96 kHz}
peaks: {first_impact: 5 ms}
"""


def run(folder: Path, model: str, study: str) -> StudyResult:
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    (folder / "hit.study.yaml").write_text(study, encoding="utf-8")
    return run_study(read_study(folder / "hit.study.yaml"))


def apart(one: CaseResult, other: CaseResult, band: tuple[float, float], window: float) -> float:
    """The largest difference of any recorded acceleration in the band, over its largest value."""
    largest = 0.0
    for name in one.channels:
        if name.endswith("acceleration"):
            assert one.response is not None
            a, b = (in_band(case.channels[name].values, one.response.clock.sampling, band) for case in (one, other))
            within = one.response.t <= window
            largest = max(largest, float(np.abs(a - b)[within].max() / np.abs(b)[within].max()))
    return largest


@pytest.mark.parametrize(("within", "band"), [(0.05, (0.0, 5000.0)), (0.04, (200.0, 3000.0))])
def test_a_rod_is_as_accurate_as_asked(tmp_path: Path, within: float, band: tuple[float, float]) -> None:
    asked = f"accuracy: {{within: {within}, band: [{band[0]}, {band[1]}]}}\n"
    case = run(tmp_path, ROD.replace("MODES", "5"), HIT + asked).cases["as given"]
    check = case.accuracy
    assert check is not None and check.holds
    # what is recorded at 100 kHz may be aliased, and is then said to be; the check goes by displacements
    assert {finding.code for finding in case.findings} <= {"motion-coarsely-sampled"}
    modes = case.basis.modes.stop
    assert modes == check.used_modes > 5
    fine = HIT.replace("100 kHz", "2 MHz")  # beyond all modes: at 100 kHz they would be heard at wrong frequencies
    own = run(tmp_path, ROD.replace("MODES", str(modes)), fine).cases["as given"]
    many = run(tmp_path, ROD.replace("MODES", str(8 * modes)), fine).cases["as given"]
    error = apart(own, many, band, check.window)
    assert error <= within
    assert error > within / 20  # it is the modes that were found to do, not all there could be
    # Before the reflection returns (2 L / c = 0.79 ms) the rod is a dashpot Z: m Z f'' + m k f' + k Z f = 0, f' = k v
    m, k, z = 2.5, 1e8, 314.16e-6 * np.sqrt(200e9 * 7850)
    a, w = 0.5 * k / z, np.sqrt(k / m - (0.5 * k / z) ** 2 + 0j)
    t = np.linspace(0, 7e-4, 20001)
    exact = float((k / w * np.exp(-a * t) * np.sin(w * t)).real.max())
    assert case.response is not None
    assert case.response.contacts["ball on left"].peak_force == pytest.approx(exact, rel=within)


def test_a_basis_that_does_is_left_alone(tmp_path: Path) -> None:
    plain = run(tmp_path, ROD.replace("MODES", "200"), HIT).cases["as given"]
    asked = "accuracy: {within: 5 %, band: [0 Hz, 5 kHz]}\n"
    case = run(tmp_path, ROD.replace("MODES", "200"), HIT + asked).cases["as given"]
    assert case.accuracy is not None and case.accuracy.used_modes == 200
    assert case.basis_key == plain.basis_key
    for name, channel in plain.channels.items():
        assert np.array_equal(channel.values, case.channels[name].values)


def test_a_beam_grows_by_its_count(tmp_path: Path) -> None:
    beam = """
structure: {type: beam, length: 0.4 m, ends: [clamped, free], EI: 20, mass_per_length: 0.5 kg/m, modes: MODES}
points: {tip: {at: 0.4 m}, middle: {at: 0.2 m}}
"""
    hit = """
model: model.yaml
bodies: {ball: {mass: 20 g, above: tip, speed: 1 m/s, contact: {type: hertz, stiffness: 1e6}}}
record: {middle.z: acceleration}
time: {duration: 20 ms, sampling: 100 kHz}
peaks: {first_impact: 5 ms}
"""
    asked = "accuracy: {within: 1 %, band: [0 Hz, 1 kHz]}\n"
    case = run(tmp_path, beam.replace("MODES", "4"), hit + asked).cases["as given"]
    check = case.accuracy
    assert check is not None and check.holds
    assert check.used_modes in (8, 16, 32)
    fine = hit.replace("100 kHz", "2 MHz").replace("20 ms", "6 ms")
    own = run(tmp_path, beam.replace("MODES", str(check.used_modes)), fine).cases["as given"]
    many = run(tmp_path, beam.replace("MODES", str(8 * check.used_modes)), fine).cases["as given"]
    assert apart(own, many, (0.0, 1000.0), check.window) <= 0.01


def test_a_plate_hit_by_a_steel_ball(tmp_path: Path) -> None:
    """A contact of 0.6 ms on modes up to 450 Hz: residual vectors do not make up for modes away from it."""
    asked = "accuracy: {within: 1 %, band: [0 Hz, 300 Hz]}\n"
    result = run(tmp_path, PLATE.replace("MESH", "[24, 20]"), DROP + asked)
    case = result.cases["as given"]
    check = case.accuracy
    assert check is not None and check.holds
    assert case.basis.complete_below_hz == check.used_hz > 450.0
    assert result.bases[case.basis_key].modes.stop == check.used_modes
    fine = DROP.replace("96 kHz", "1 MHz").replace("0.1 s", "20 ms")  # beyond all modes and residual vectors
    few, own, many = (
        run(tmp_path, PLATE.replace("MESH", "[24, 20]"), fine.replace("450 Hz", up_to)).cases["as given"]
        for up_to in ("450 Hz", f"{check.used_hz} Hz", "4 kHz")
    )
    assert apart(own, many, (0.0, 300.0), check.window) <= 0.01 < apart(few, many, (0.0, 300.0), check.window)


def test_a_mesh_that_carries_no_more_stops_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = "accuracy: {within: 0.1 %, band: [0 Hz, 300 Hz]}\n"
    result = run(tmp_path, PLATE.replace("MESH", "[10, 8]"), DROP + asked)
    case = result.cases["as given"]
    check = case.accuracy
    assert check is not None and not check.holds
    assert (check.smaller_hz, check.larger_hz, check.used_hz) == pytest.approx((225.0, 450.0, 450.0))
    (finding,) = (found for found in case.findings if found.code == "accuracy-not-reached")
    assert finding.severe and "The mesh is fine enough for bending waves up to 3" in finding.message
    assert finding.values["reached"] == check.share > finding.values["asked"] == 0.001
    show_study(result, {})
    told = capsys.readouterr().out
    assert "forbids trust, accuracy-not-reached" in told and "0.1 % required; used: " in told
    table = json.loads(json.dumps(summary(result), allow_nan=False))["cases"]["as given"]["accuracy"]
    assert table["holds"] is False and table["reached"] == check.share
    assert table["largest"]["off.z acceleration"]["unit"] == "m/s^2"
    write_results(tmp_path / "results.h5", result)
    with h5py.File(tmp_path / "results.h5") as file:
        kept = file["cases/as given/accuracy"]
        assert kept["largest/share"][()].max() == check.share and not kept.attrs["holds"]


def test_what_is_asked_is_the_line(tmp_path: Path) -> None:
    """The same two bases hold for a little more than they differ by, and not for a little less."""
    plate = PLATE.replace("MESH", "[10, 8]")
    asked = "accuracy: {within: 0.1 %, band: [0 Hz, 300 Hz]}\n"
    first = run(tmp_path, plate, DROP + asked).cases["as given"].accuracy
    assert first is not None
    for share, holds in ((1.01 * first.share, True), (0.99 * first.share, False)):
        check = run(tmp_path, plate, DROP + asked.replace("0.1 %", f"{share!r}")).cases["as given"].accuracy
        assert check is not None and (check.share, check.holds) == (pytest.approx(first.share), holds)


def test_a_stated_cap_stops_it(tmp_path: Path) -> None:
    asked = "accuracy: {within: 0.01 %, band: [0 Hz, 300 Hz], up_to: 1.2 kHz}\n"
    case = run(tmp_path, PLATE.replace("MESH", "[24, 20]"), DROP + asked).cases["as given"]
    check = case.accuracy
    assert check is not None and not check.holds
    assert check.larger_hz == check.used_hz == case.basis.complete_below_hz == pytest.approx(900.0)
    assert "limit of the modes is 1200 Hz" in next(f for f in case.findings if f.severe).message


def test_cases_of_one_structure_share_what_the_hardest_needs(tmp_path: Path) -> None:
    cases = """
accuracy: {within: 1 %, band: [0 Hz, 300 Hz]}
cases:
  soft: {bodies.ball.contact.stiffness: 1e5}
  hard: {}
  heavier plate: {parts.plate.thickness: 4 mm}
  does not ask: {remove: [accuracy]}
"""
    result = run(tmp_path, PLATE.replace("MESH", "[24, 20]"), DROP + cases)
    soft, hard, other = (result.cases[name] for name in ("soft", "hard", "heavier plate"))
    assert soft.accuracy is not None and hard.accuracy is not None and other.accuracy is not None
    assert soft.accuracy.used_hz == hard.accuracy.used_hz > 450.0
    assert soft.accuracy.share < hard.accuracy.share
    assert soft.basis_key == hard.basis_key == result.cases["does not ask"].basis_key != other.basis_key
    assert result.cases["does not ask"].accuracy is None
    assert other.accuracy.holds and other.basis.damping_ratio[0] == pytest.approx(0.02)


def test_every_mode_is_accurate(tmp_path: Path) -> None:
    model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
    study = HIT.replace("before: left", "above: m").replace("left.x: acceleration, right.x", "m.z")
    case = run(tmp_path, model, study + "accuracy: {within: 1 %, band: [0 Hz, 1 kHz]}\n").cases["as given"]
    assert case.accuracy is not None and case.accuracy.holds and case.accuracy.worst is None


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("{within: 1 %}", "band"),
        ("{within: 1 %, band: [5 kHz, 1 kHz]}", "accuracy.band: got 5000 to 1000 Hz, expected a rising band"),
        ("{within: 1 %, band: [0 Hz, 60 kHz]}", "accuracy.band: got 60000 Hz, expected less than half the sampling"),
        ("{within: 0, band: [0 Hz, 1 kHz]}", "accuracy.within: got 0, expected a positive value"),
        ("{within: 3, band: [0 Hz, 1 kHz]}", "did you mean 3 %"),
        ("{within: 1 %, band: [0 Hz, 1 kHz], modes: 3}", "accuracy.modes"),
        ("{within: 1 %, band: [0 Hz, 1 kHz], up_to: 3 s}", "accuracy.up_to"),
    ],
)
def test_mistakes_are_told(tmp_path: Path, asked: str, told: str) -> None:
    with pytest.raises(InputErrors) as caught:
        run(tmp_path, ROD.replace("MODES", "20"), HIT + f"accuracy: {asked}\n")
    assert told in str(caught.value)


@pytest.mark.parametrize(
    ("model", "study", "told"),
    [
        ("structure: none\n", "bodies: {a: {mass: 1 kg, above: ground}}\ntime: {duration: 1 s, sampling: 10 kHz}\n"
         "record: {a: velocity}\n", "got no structure"),
        (ROD.replace("MODES", "5"), "bodies: {}\n", "got no time"),
        (ROD.replace("MODES", "5"), "time: {duration: 1 s, sampling: 10 kHz}\n", "got no record and no contact"),
        (PLATE.replace("MESH", "[4, 4]"), DROP.replace("model: model.yaml\n", ""), "got 100 Hz, expected at least"),
    ],
)  # fmt: skip
def test_what_cannot_be_accurate_is_refused(tmp_path: Path, model: str, study: str, told: str) -> None:
    asked = "accuracy: {within: 1 %, band: [0 Hz, 1 kHz], up_to: 100 Hz}\n"
    with pytest.raises(InputErrors) as caught:
        run(tmp_path, model, f"model: model.yaml\n{study}{asked}")
    assert told in str(caught.value)


def test_filters_know_that_it_was_at_rest_before() -> None:
    """A pulse at the very start, against the same pulse after a long silence."""
    sampling, silence = 96e3, np.zeros(20000)
    t = np.arange(4800) / sampling
    pulse = np.where(t < 0.6e-3, np.sin(np.pi * t / 0.6e-3), 0.0)
    for band in ((0.0, 300.0), (300.0, 2000.0)):
        exact = in_band(np.concatenate((silence, pulse, silence)), sampling, band)[20000:24800]
        # where the filter's ringing is cut
        assert np.abs(in_band(pulse, sampling, band) - exact).max() < 1e-6 * np.abs(exact).max()


def test_acceleration_from_displacement() -> None:
    """A sine in the band keeps its amplitude omega^2, one beyond half the sampling does not come back as another."""
    sampling, t = 50e3, np.arange(10000) / 50e3
    slow, fast = 2 * np.pi * 1000.0, 2 * np.pi * 49.5e3  # sampled, the fast one looks like 500 Hz
    x = np.sin(slow * t) / slow**2 + np.sin(fast * t) / fast**2
    found = in_band(mean_acceleration(x, sampling), sampling, (0.0, 2000.0))[4000:6000]
    amplitude = np.sqrt(2.0 * np.mean(found**2))
    # the filter passes 1 - (1 / 2)^8 at half its edge; the alias is down by (500 / 49500)^2; nine points err 1e-12
    assert amplitude == pytest.approx(1.0 / (1.0 + 0.5**8), abs=5e-4)


@pytest.mark.parametrize("coarse", ["5 kHz", "20 kHz"])
def test_the_accuracy_does_not_depend_on_the_sampling(tmp_path: Path, coarse: str) -> None:
    """Modes of the larger basis are at 25 kHz: at 5 kHz they would be seen in the band, and at 400 kHz the start of the
    motion was once taken for a blow of 86 km/s^2."""
    found = []
    for sampling in (coarse, "400 kHz"):
        study = HIT.replace("100 kHz", sampling) + "accuracy: {within: 5 %, band: [0 Hz, 2 kHz]}\n"
        check = run(tmp_path, ROD.replace("MODES", "20"), study).cases["as given"].accuracy
        assert check is not None
        found.append({name: (one.smaller, one.larger) for name, one in check.deviations.items()})
    for name, one in found[0].items():
        # of samples up to 1 / 50 kHz beside the peak of 2 kHz: (2 pi 2 / 50)^2 / 2 / 4
        assert one == pytest.approx(found[1][name], rel=8e-3)
