"""Peaks do not depend on how densely a run is sampled: closed forms whose peaks lie between the samples."""

from __future__ import annotations

import json
from math import ceil
from pathlib import Path

import numpy as np
import pytest
import scipy
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.impact.resampled import resample
from femstruct.impact.scene import Clock, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.cases import read_study
from femstruct.modal.closed_form import given_modes, oscillator
from femstruct.study.asked import PeakRule
from femstruct.study.recorded import Channel
from femstruct.study.results import CaseResult
from femstruct.workflow.recorded_channels import Peaks, converged, cut_off_findings, in_band, refine_pressure
from femstruct.workflow.run import run_study

LOW = 0.995  # two of 32 samples a period beside the top of a sine: 1 - (pi / 32)^2 / 2
SWEEP = [500.0, 900.0, 1e3, 1.7e3, 2e3, 3.3e3, 5e3, 12e3, 31e3, 48e3]
ONE_MODE = "structure: {type: oscillator, mass: 2 kg, stiffness: 20 MN/m}\npoints: {m: {}}\n"
TWO_MODES = "structure: {type: modes, frequency: [150 Hz, 2 kHz], ratio: [1 %, 1 %], points: {hit: [0.9, -1.1]}}\n"
STUDY = """model: model.yaml
bodies: {ball: {mass: 50 g, above: PLACE, speed: 1 m/s, contact: {type: linear, stiffness: 2 MN/m}}}
record: {PLACE.z: RECORDED, ball on PLACE: force}
time: {duration: 20 ms, sampling: SAMPLING}
"""


def written(
    folder: Path, sampling: float, model: str, recorded: str = "[velocity, displacement]", more: str = ""
) -> Path:
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    path, place = folder / "hit.study.yaml", "m" if model == ONE_MODE else "hit"
    text = STUDY.replace("PLACE", place).replace("RECORDED", recorded).replace("SAMPLING", f"{sampling!r} Hz")
    path.write_text(text + more, encoding="utf-8")
    return path


def run(path: Path) -> CaseResult:
    return run_study(read_study(path)).cases["as given"]


@pytest.mark.parametrize("sampling", SWEEP)
@pytest.mark.parametrize("what", ["displacement", "velocity", "acceleration"])
def test_the_peak_of_two_modes_is_that_of_their_sum(sampling: float, what: str) -> None:
    """Modes that begin with 1 m/s: x = sin(w t) / w; weighted so that both count and nothing is large at the start."""
    omega = 2.0 * np.pi * np.array([130.0, 2000.0])
    window = round(0.004 * sampling) / sampling - 1.0 / 64e3  # a record ends a sample before its window
    phase = np.outer(omega, np.linspace(0.0, window, 200_001))
    row = {"displacement": omega, "velocity": np.ones(2), "acceleration": 1.0 / omega}[what] * [1.0, -1.0]
    form = np.cos(phase) if what == "velocity" else np.sin(phase)
    true = float(np.abs(form[0] - form[1]).max())
    basis, _ = given_modes([130.0, 2000.0], [0.0, 0.0], {"p": [1.0, 1.0]})
    asked = simulate(basis, Scene((), velocity=np.ones(2)), Clock(0.004, sampling))
    near = resample(asked)
    assert near is not None and (near is asked) == (sampling >= 32e3)
    found = float(np.abs(getattr(near, what)(row)).max())
    missed = 1.0 - LOW if near is not asked else (np.pi / 16.0) ** 2 / 2.0  # of the second mode, of two as large
    assert (1.0 - missed) * true <= found <= 1.02 * true  # what the last sample of 64 kHz may add


@pytest.mark.parametrize("sampling", [300.0, 700.0, 1e3, 2.3e3, 5e3, 21e3, 200e3])
def test_a_struck_oscillator_has_the_amplitude_of_its_energy(tmp_path: Path, sampling: float) -> None:
    """Two masses on two springs while the ball is on: after it the velocity's peak is sqrt(v^2 + w^2 x^2)."""
    stiff, soft, mass, ball = 2e6, 20e6, 2.0, 0.05
    squares, shapes = np.linalg.eigh([[(stiff + soft) / mass, -stiff / np.sqrt(mass * ball)],
                                      [-stiff / np.sqrt(mass * ball), stiff / ball]])  # fmt: skip
    omega, scale = np.sqrt(squares), 1.0 / np.sqrt([mass, ball])
    start = shapes.T @ np.array([0.0, -np.sqrt(ball)])  # modal velocities of the ball's -1 m/s
    t = np.linspace(1e-7, 1e-3, 1_000_001)
    x, v = (scale[:, None] * (shapes @ (start[:, None] * one)) for one in (
        np.sin(np.outer(omega, t)) / omega[:, None], np.cos(np.outer(omega, t))))  # fmt: skip
    over = int(np.argmax(x[1] - x[0] > 0.0))  # the ball leaves
    amplitude = float(np.hypot(v[0, over], np.sqrt(soft / mass) * x[0, over]))
    case = run(written(tmp_path, sampling, ONE_MODE))
    found = {name: channel.whole for name, channel in case.channels.items()}
    closed = 1.0 - 2e-6  # what a step of the closed form, 1 ns, makes of it
    assert LOW * amplitude <= found["m.z velocity"] <= amplitude / closed
    assert LOW * amplitude <= found["m.z displacement"] * np.sqrt(soft / mass) <= amplitude / closed
    force = stiff * float((x[0, :over] - x[1, :over]).max())
    assert LOW * force <= found["ball on m force"] <= force / closed


def test_a_limit_has_one_verdict_whatever_the_sampling(tmp_path: Path) -> None:
    """It was met at 1 kHz and exceeded at 48 kHz."""
    peaks, limits = [], "limits: {hit.z velocity: LIMIT}\npeaks: {first_impact: 5 ms}\n"
    for sampling in SWEEP:
        result = run_study(read_study(written(tmp_path, sampling, TWO_MODES, more=limits.replace("LIMIT", "0.05 m/s"))))
        channel = result.cases["as given"].channels["hit.z velocity"]
        peaks.append((channel.first_impact, channel.whole))
        sampled = float(np.abs(channel.values).max())
        found = [one for one in result.cases["as given"].findings if "sampled_peak" in one.values]
        assert [one.code for one in found] == ["motion-coarsely-sampled"] * len(found)
        if sampled < 0.9 * channel.whole:  # both numbers, of the channel that misses most
            assert found[0].values["peak"] > found[0].values["sampled_peak"]
        assert result.verdicts["as given"][0].value == channel.whole
    spread = np.ptp(peaks, axis=0) / np.max(peaks, axis=0)
    assert (spread < (np.pi / 16.0) ** 2 / 2.0).all()  # 31 and 48 kHz are not seen closer: 16 samples a period


def test_a_contact_has_its_largest_force_whatever_the_filter_and_the_sampling(tmp_path: Path) -> None:
    """A limit of 5 kN was met by a force of 5.8 kN, filtered to 4.2 kN."""
    name, verdicts = "ball on m force", []
    for sampling in (4e3, 48e3):
        for low in ("none", "400 Hz"):
            path = written(tmp_path, sampling, ONE_MODE, more=f"peaks: {{lowpass: {low}}}\n")
            case = run(path)
            largest = case.response.contacts["ball on m"].peak_force
            assert case.channels[name].whole == pytest.approx(largest, rel=1e-9)  # the engine's own rounding
            limits = f"peaks: {{lowpass: {low}}}\nlimits: {{{name}: {0.99 * largest:.9g} N}}\n"
            result = run_study(read_study(written(tmp_path, sampling, ONE_MODE, more=limits)))
            verdicts.append(result.verdicts["as given"][0].met)
    assert verdicts == [False] * 4


@pytest.mark.parametrize("sampling", [1e3, 10e3, 48e3])
def test_a_short_first_impact_before_a_longer_and_harder_one(tmp_path: Path, sampling: float) -> None:
    """A pin strikes at 1 m/s for some 30 us, between two samples; a slow load then presses it with 2 kN. Its first
    force is m v e^(-zeta w t) (w (1 - 2 zeta^2) sin(d t) + 2 zeta d cos(d t)) w / d, d = w sqrt(1 - zeta^2)."""
    (tmp_path / "model.yaml").write_text(ONE_MODE.replace("2 kg", "1000 t"), encoding="utf-8")
    path, mass, stiffness, zeta = tmp_path / "press.study.yaml", 0.01, 1e8, 0.4
    damping = 2.0 * zeta * np.sqrt(stiffness * mass)
    path.write_text(
        "model: model.yaml\nbodies: {pin: {mass: 10 g, above: m, speed: 1 m/s}}\n"
        f"contacts: {{wall: {{between: [pin, m], gap: 1.03 mm, "
        f"law: {{type: linear, stiffness: {stiffness}, damping: {damping}}}}}}}\n"
        "loads: {press: {body: pin, half_sine: {amplitude: -2 kN, frequency: 2 Hz}, first: 3 ms}}\n"
        f"record: {{wall: force, m.z: acceleration}}\ntime: {{duration: 200 ms, sampling: {sampling}}}\n"
        "peaks: {first_impact: 1 ms}\n",
        encoding="utf-8",
    )
    t, w = np.linspace(0.0, 30e-6, 100_001), np.sqrt(stiffness / mass)
    d = w * np.sqrt(1.0 - zeta**2)
    rising = w * (1.0 - 2.0 * zeta**2) * np.sin(d * t) + 2.0 * zeta * d * np.cos(d * t)
    first = float((mass * np.exp(-zeta * w * t) * rising * w / d).max())
    found = run(path).channels
    assert found["wall force"].whole > 1.9 * first  # 2 kN, slowly, and what the pin adds when it falls back
    assert found["wall force"].first_impact == pytest.approx(first, rel=1e-6)  # 1 g of a million: the wall gives way
    assert LOW * first <= found["m.z acceleration"].first_impact * 1e6 <= first * (1.0 + 1e-6)


@pytest.mark.parametrize(("sampling", "told"), [(1e3, True), (3.9e3, True), (4.1e3, False), (48e3, False)])
def test_check_says_what_the_run_says(tmp_path: Path, sampling: float, told: bool) -> None:
    path = written(tmp_path, sampling, TWO_MODES)
    before = json.loads(CliRunner().invoke(app, ["check", str(path), "--json"]).stdout)["findings"]
    codes = [one["message"] for one in before if one["code"] == "motion-coarsely-sampled"]
    assert len(codes) == told
    after = [one for one in run(path).findings if "last_mode_hz" in one.values]
    assert [one.message for one in after] == codes and not any(one.severe for one in after)
    if told:
        assert after[0].values["last_mode_hz"] == pytest.approx(2e3, rel=1e-12)  # given
        assert after[0].values["samples"] == pytest.approx(sampling / 2e3, rel=1e-12)  # a quotient


def test_sound_from_too_few_samples_is_forbidden_before_it_is_computed() -> None:
    path = Path(__file__).parents[2] / "models" / "slab_outdoors.study.yaml"  # modes up to 272 Hz
    codes = []
    for sampling in ("400 Hz", "12 kHz"):
        ended = CliRunner().invoke(app, ["check", str(path), "--set", f"time.sampling={sampling}", "--json"])
        found = [one for one in json.loads(ended.stdout)["findings"] if one["code"] == "motion-coarsely-sampled"]
        codes.append((ended.exit_code, [one["severe"] for one in found]))
    assert codes == [(3, [True]), (0, [])]


def test_peaks_that_do_not_fit_into_memory_are_blank_and_their_limits_not_known(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("femstruct.impact.resampled.MOST_STATES", 200.0)
    path = written(tmp_path, 1e3, TWO_MODES, more="limits: {hit.z velocity: 1 m/s}\n")
    for command in ("check", "run"):
        more = ["-o", str(tmp_path / "out"), "--no-pictures"] if command == "run" else []
        ended = CliRunner().invoke(app, [command, str(path), "--json", *more])
        assert ended.exit_code == 3, ended.output
    table = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["cases"]["as given"]
    first = table["findings"][0]
    assert first["code"] == "motion-coarsely-sampled" and first["severe"]
    assert table["peaks"]["hit.z velocity"]["whole"] is None
    assert table["limits"]["hit.z velocity"]["verdict"] == "not known"


def test_samples_are_not_taken_for_missing_modes(tmp_path: Path) -> None:
    """Peaks with and without residual vectors are compared on the finer grid: the same at any sampling."""
    model = Path(__file__).parents[2] / "models" / "small_plate.yaml"
    (tmp_path / "model.yaml").write_text(model.read_text(encoding="utf-8"), encoding="utf-8")
    text = STUDY.replace("PLACE", "off").replace("RECORDED", "[velocity, displacement]")
    peaks, codes = [], []
    for sampling in ("700 Hz", "100 kHz"):
        (tmp_path / "hit.study.yaml").write_text(text.replace("SAMPLING", sampling) + "modes: {up_to: 1 kHz}\n")
        case = run(tmp_path / "hit.study.yaml")
        codes.append([one.message for one in case.findings if one.code == "peak-not-converged"])
        channel = case.channels["off.z velocity"]
        assert channel.by_modes is not None
        peaks.append((channel.whole, *channel.by_modes))
    assert len(codes[0]) == len(codes[1])
    np.testing.assert_allclose(peaks[0], peaks[1], rtol=1.0 - LOW)


@pytest.mark.parametrize("frequency", [700.0, 1900.0])
def test_a_pressure_between_its_samples(frequency: float) -> None:
    """A tone in a record that begins and ends in silence, of 3.6 and 10 samples a period, peaks between two of them."""
    basis, _ = oscillator(1.0, frequency_hz=1900.0, axis="z")
    response = simulate(basis, Scene((), velocity=np.ones(1)), Clock(0.2, 6.9e3))
    t = response.t

    def tone(at: np.ndarray) -> np.ndarray:
        wave = np.sin(2.0 * np.pi * frequency * (at - 0.1003)) * np.exp(-(((at - 0.1) / 0.01) ** 2))
        return np.asarray(wave)

    fine, factor = refine_pressure(tone(t), response)
    assert factor * 6.9e3 >= 32 * 1900.0
    apart = np.abs(fine - tone(np.arange(len(fine)) / (factor * 6.9e3))).max()
    assert apart < 1e-9  # rounding: the tone has nothing above half the sampling (1e-300) and at the ends (1e-43)
    assert np.abs(tone(t)).max() < 0.999 * np.abs(fine).max()


@pytest.mark.parametrize("sampling", [300.0, 2e3, 17e3, 250e3])
def test_a_short_force_from_a_file_is_not_missed(tmp_path: Path, sampling: float) -> None:
    """A triangle of 0.1 ms and 100 N on 2 kg at 503 Hz: at its top a = F / m less w^2 x, x = F t^2 / 6 m."""
    lines = STUDY.replace("PLACE", "m").replace("RECORDED", "acceleration").replace("SAMPLING", f"{sampling!r} Hz")
    kept = [line.replace(", ball on m: force", "") for line in lines.splitlines() if not line.startswith("bodies")]
    kept.append("loads: {push: {at: m.z, file: push.csv}}")
    (tmp_path / "model.yaml").write_text(ONE_MODE, encoding="utf-8")
    (tmp_path / "push.csv").write_text("0.00123,0\n0.00128,100\n0.00133,0\n", encoding="utf-8")
    (tmp_path / "hit.study.yaml").write_text("\n".join(kept) + "\n", encoding="utf-8")
    true = 50.0 * (1.0 - 20e6 / 2.0 * 50e-6**2 / 6.0)
    found = run(tmp_path / "hit.study.yaml").channels["m.z acceleration"].whole
    # two of 16 samples over its width beside the top; the spring holds x back by (w t)^2 / 20 of the 0.4 %
    assert (1.0 - 1.0 / 32.0) * true <= found <= true * (1.0 + 1e-5)


@pytest.mark.parametrize("sampling", [300.0, 2e3, 30e3])
def test_a_force_from_a_file_pushes_at_once(tmp_path: Path, sampling: float) -> None:
    """100 N for 2 ms on 2 kg at 503 Hz: a = F / m at the start, x = 2 F / k half a period later."""
    (tmp_path / "push.csv").write_text("0,0\n1e-6,100\n0.002,100\n0.002001,0\n", encoding="utf-8")
    load = "loads: {push: {at: m.z, file: push.csv}}\n"
    text = written(tmp_path, sampling, ONE_MODE, "[displacement, acceleration]").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("bodies")]
    lines = [line.replace(", ball on m: force", "") for line in lines]
    (tmp_path / "hit.study.yaml").write_text("\n".join(lines) + "\n" + load, encoding="utf-8")
    case = run(tmp_path / "hit.study.yaml")
    assert case.channels["m.z displacement"].whole == pytest.approx(2.0 * 100.0 / 20e6, rel=1.0 - LOW)
    # after half a period the acceleration is -F / m; two of 16 samples beside it
    assert case.channels["m.z acceleration"].whole == pytest.approx(50.0, rel=(np.pi / 16.0) ** 2 / 2.0)


def test_few_samples_of_what_is_recorded_and_heard_have_one_need(tmp_path: Path) -> None:
    """Two findings of one code asked for 2 and for 10 samples in a period of the last mode."""
    (tmp_path / "plate.yaml").write_text(
        "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}\ndamping: {ratio: 1 %}\n"
        "parts: {p: {type: plate, material: steel, thickness: 5 mm, origin: [0, 0, 0], size: [0.6, 0.4], mesh: 0.1}}\n"
        "supports: {s: {on: p, edge: all, fix: simple}}\npoints: {a: {on: p, at: center}}\n"
        "surfaces: {low: {on: p, side: below}}\n",
        encoding="utf-8",
    )
    text = (
        "model: plate.yaml\nmodes: {count: 3}\nrecord: {a.z: velocity}\ntime: {duration: 50 ms, sampling: 100 Hz}\n"
        "bodies: {ball: {mass: 5 g, above: a, speed: 1 m/s, contact: {type: linear, stiffness: 100 kN/m}}}\n"
    )
    room = "rooms: {box: {size: [0.6, 0.4, 0.3], under: low, receivers: {mic: [0.1, 0.1, 0.1]}}}\n"
    for more, severe, samples in ((room, True, 10.0), ("", False, 2.0)):
        (tmp_path / "s.study.yaml").write_text(text + more, encoding="utf-8")
        told = json.loads(CliRunner().invoke(app, ["check", str(tmp_path / "s.study.yaml"), "--json"]).stdout)[
            "findings"
        ]
        (found,) = [one for one in told if one["code"] == "motion-coarsely-sampled"]
        assert found["severe"] is severe and found["values"]["needed"] == samples
        last = found["values"]["last_mode_hz"]
        assert found["message"].endswith(f"Sample at {ceil(samples * last)} Hz or more")
        assert found["message"].count("Sample at") == 1 and "at lower frequencies" in found["message"]


STRUCK = """model: model.yaml
bodies: {a: {mass: 1 kg, above: m, speed: 1 m/s}}
contacts: {c: {between: [a, m], law: {type: linear, stiffness: 1 MN/m, damping: 800 N*s/m}}}
record: {m.z: [acceleration, velocity], a: [velocity, displacement, travel], ground: force}
time: {duration: 0.3 s, sampling: 40 kHz}
peaks: {lowpass: 50 Hz}
"""


def own_low_pass(values: np.ndarray, before: np.ndarray, sampling: float, edge: float) -> np.ndarray:
    """The filter of the peaks by another form (one polynomial, no paddings of scipy) behind what was before."""
    b, a = scipy.signal.butter(4, edge, fs=sampling)
    whole = np.concatenate((before, values, np.full(len(before), values[-1])))
    there = scipy.signal.lfilter(b, a, whole - whole[-1])[::-1]
    return (scipy.signal.lfilter(b, a, there)[::-1] + whole[-1])[len(before) : -len(before)]


def test_a_structure_was_at_rest_before_a_blow_whose_force_jumps(tmp_path: Path) -> None:
    """A dashpot pushes with 800 N at once: the first sample, -80 m/s^2, was held for a state of rest (52.2 m/s^2).
    Bound of the peak below f: dv 2 f (pi / 8) / sin(pi / 8), reached by a blow much shorter than 1 / f."""
    model = "structure: {type: oscillator, mass: 10 kg, frequency: 5 Hz}\ndamping: {ratio: 2 %}\npoints: {m: {}}\n"
    (tmp_path / "model.yaml").write_text(model, encoding="utf-8")
    (tmp_path / "hit.study.yaml").write_text(STRUCK, encoding="utf-8")
    case = run(tmp_path / "hit.study.yaml")
    channels = case.channels
    dv = float(np.abs(channels["m.z velocity"].values).max())
    bound = dv * 2.0 * 50.0 * (np.pi / 8.0) / np.sin(np.pi / 8.0)
    # 2.4 ms of contact at 50 Hz: 1 - (2 pi 50 0.7 ms)^2 / 2 is 0.97; the spring takes some of it
    assert 0.95 * bound < channels["m.z acceleration"].whole < bound
    lead = np.arange(-40_000, 0) / 40e3  # 1 s, 50 periods of the edge
    body = channels["a displacement"].values
    (tmp_path / "on.study.yaml").write_text(STRUCK.replace("0.3 s", "0.5 s"), encoding="utf-8")
    onward = run(tmp_path / "on.study.yaml").channels  # ten periods of the edge further
    for name, before in {
        "m.z acceleration": 0.0 * lead,
        "m.z velocity": 0.0 * lead,
        "ground force": 0.0 * lead,
        "a velocity": np.full(len(lead), -1.0),
        "a displacement": -lead,
        "a travel": -lead,
    }.items():
        values, within = onward[name].values.copy(), 1e-6
        if name == "m.z acceleration":  # half an interval of the jump lies before it; the rest by trapezes
            values[0], within = 0.5 * values[0], 1e-4
        own = own_low_pass(values, before, 40e3, 50.0)[: len(channels[name].values)]
        # the polynomial's rounding at 50 Hz of 40 kHz is 1e-9; six periods ahead of the edge leave e^-14 = 6e-7
        assert channels[name].whole == pytest.approx(np.abs(own).max(), rel=within), name
    assert body[0] == 0.0


@pytest.mark.parametrize("lowpass", [22.0, 60.0])
def test_a_structure_that_rings_at_the_end_is_followed_beyond_it(lowpass: float, tmp_path: Path) -> None:
    """102 Hz behind a low-pass at 22 and 60 Hz: the motion, cut off at the end of the window, was taken to stay there,
    a step that the filter answered. Against the closed form of the ringing, and the
    gain of two passes of a Butterworth filter of order 4, 1 / (1 + (f / F)^8)."""
    w, z = 2.0 * np.pi * 102.0, 0.002
    model = "structure: {type: oscillator, mass: 10 kg, frequency: 102 Hz}\ndamping: {ratio: 0.2 %}\npoints: {m: {}}\n"
    (tmp_path / "model.yaml").write_text(model, encoding="utf-8")
    study = (
        "model: model.yaml\ninitial: {velocity: {m.z: 1 m/s}}\nrecord: {m.z: [acceleration, velocity, displacement]}\n"
        f"time: {{duration: 0.2537 s, sampling: 20 kHz}}\npeaks: {{lowpass: {lowpass:g} Hz}}\n"
    )
    (tmp_path / "ring.study.yaml").write_text(study, encoding="utf-8")
    channels = run(tmp_path / "ring.study.yaml").channels
    t = np.arange(int(3.0 * 20e3)) / 20e3
    wd = w * np.sqrt(1.0 - z**2)
    x = np.exp(-z * w * t) * np.sin(wd * t) / wd
    v = np.exp(-z * w * t) * (np.cos(wd * t) - z * w / wd * np.sin(wd * t))
    inside = t <= 0.2537
    lead = np.zeros(20_000)
    for name, values in {"m.z velocity": v, "m.z displacement": x}.items():
        own = own_low_pass(values, lead, 20e3, lowpass)[: inside.sum()]
        # the program sees means about each sample, of a start that jumps: half an interval of it
        assert channels[name].whole == pytest.approx(np.abs(own).max(), rel=0.02), name
        steady = 1.0 / (1.0 + (102.0 / lowpass) ** 8)  # of what still rings at the end
        assert (
            np.abs(own[-200:]).max() < 1.2 * steady * np.abs(values[inside][-400:]).max() + 1e-3 * channels[name].whole
        )


def test_a_pressure_that_the_window_cuts_off_is_not_quoted() -> None:
    """30 Hz that go on: held at the end of the window, or silent, they are two numbers behind a low-pass at 10 Hz."""
    sampling = 4e3
    t = np.arange(4001) / sampling
    pressure = np.sin(2.0 * np.pi * 30.0 * t + 1.0)
    peaks = Peaks(PeakRule(lowpass_hz=10.0), sampling, 0.02, len(t))
    held, silent = peaks.of(pressure), peaks.of(np.append(pressure, 0.0))
    cut = Channel("room.mic pressure", pressure, "Pa", *held, silent_after=silent)
    quiet = Channel("room.far pressure", pressure, "Pa", *held, silent_after=held)
    (found,) = cut_off_findings({one.name: one for one in (cut, quiet)})
    assert found.code == "pressure-cut-off" and not converged(cut) and converged(quiet)
    assert {found.values["peak"], found.values["silent"]} <= {*held, *silent}


@pytest.mark.parametrize("lowest", [0.0, 20.0])
def test_a_filter_needs_no_room_before_the_start(lowest: float) -> None:
    """A jump at the first sample, and a history that is over long before its end, against zeros of 2 s around it."""
    sampling = 5e3
    t = np.arange(600) / sampling
    values = np.exp(-300.0 * t) * np.cos(900.0 * t)
    silence = np.zeros(10_000)
    wide = in_band(np.concatenate((silence, values, silence)), sampling, (lowest, 90.0))[10_000:10_600]
    # exp(-36) is left of it at its end, 1e-9 of the filter after ten periods of its lowest edge
    assert np.abs(in_band(values, sampling, (lowest, 90.0)) - wide).max() < 1e-8 * np.abs(wide).max()


def test_preloads_and_flights_were_there_before(tmp_path: Path) -> None:
    """Nothing happens: a weight lies on a contact, a carriage rolls free. Low-passed they are what they are."""
    (tmp_path / "model.yaml").write_text(
        "parts: {b: {type: block, mass: 10 kg, origin: [0, 0, 0], size: [1, 1, 1]}}\npoints: {m: {on: b, at: top}}\n",
        encoding="utf-8",
    )
    (tmp_path / "roll.study.yaml").write_text(
        "model: model.yaml\nmodes: {count: 6}\ninitial: {velocity: {m.z: 2 m/s}}\n"
        "record: {m.z: [velocity, displacement, acceleration]}\n"
        "time: {duration: 0.1 s, sampling: 2 kHz}\npeaks: {lowpass: 100 Hz}\n",
        encoding="utf-8",
    )
    channels = run(tmp_path / "roll.study.yaml").channels
    assert channels["m.z velocity"].whole == pytest.approx(2.0, rel=1e-9)  # rounding of the filter
    assert channels["m.z acceleration"].whole == 0.0
    (tmp_path / "none.yaml").write_text("structure: none\n", encoding="utf-8")
    (tmp_path / "lie.study.yaml").write_text(
        "model: none.yaml\nbodies: {x: {mass: 2 kg, above: ground}}\n"
        "contacts: {c: {between: [x, ground], law: {type: linear, stiffness: 1 MN/m}}}\n"
        "record: {x: [velocity, displacement], c: force}\n"
        "time: {duration: 0.1 s, sampling: 2 kHz, gravity: true}\npeaks: {lowpass: 100 Hz}\n",
        encoding="utf-8",
    )
    channels = run(tmp_path / "lie.study.yaml").channels
    assert channels["x velocity"].whole < 1e-12  # m/s
    assert channels["c force"].whole == pytest.approx(2.0 * 9.80665, rel=1e-12)
