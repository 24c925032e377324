"""Sound power and sound energy as results of a study: a simply supported steel plate in a baffle."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.integrate import dblquad

from acoustics.receivers import Receiver
from femstruct.errors import InputErrors
from femstruct.files.results_file import write_results
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.sound.placed import placed
from femstruct.sound.surfaces import pressure_per_force
from femstruct.study.results import CaseResult, StudyResult
from femstruct.view.page import report
from femstruct.view.plots import figures
from femstruct.view.sound_figures import room_directivity, sound_energy
from femstruct.view.terminal import study_tables
from femstruct.workflow.bases import solve_all
from femstruct.workflow.check import inspect_file
from femstruct.workflow.run import run_study, without_rooms

A, B, H = 0.5, 0.4, 3e-3
E, NU, RHO = 210e9, 0.3, 7850.0
BENDING = E * H**3 / (12 * (1 - NU**2))
RC = 343.0 * 1.21
ZETA = 0.02

MODEL = f"""
materials: {{steel: {{E: {E}, nu: {NU}, rho: {RHO}}}}}
parts: {{plate: {{type: plate, material: steel, thickness: {H}, origin: [1, 2, 0.3], size: [{A}, {B}],
  mesh: [12, 10]}}}}
supports: {{edges: {{on: plate, edge: all, fix: simple}}}}
points: {{P: {{on: plate, at: [0.2, 0.15]}}, C: {{on: plate, at: center}}}}
surfaces: {{low: {{on: plate, side: below}}, top: {{on: plate, side: above}}}}
damping: {{ratio: {ZETA}}}
"""
STUDY = """
model: plate.yaml
modes: {up_to: 2 kHz}
loads: {push: {at: P.z, half_sine: {amplitude: -10 N, frequency: 60.5 Hz}}}
record: {P.z: velocity}
time: {duration: 500 ms, sampling: 12 kHz}
frf: {push: {drive: P.z, response: open.power, kind: power, band: [4 Hz, 700 Hz], step: 1 Hz}}
rooms:
  open: {below: low, directivity: [200 Hz, 500 Hz]}
  roof: {above: top, receivers: {mic: [0.1, 0.2, 2]}}
"""


def natural(m: int, n: int) -> float:
    """Frequency [Hz] of a mode in closed form."""
    return float(np.pi / 2 * np.sqrt(BENDING / (RHO * H)) * ((m / A) ** 2 + (n / B) ** 2))


def efficiency(m: int, n: int, frequency: float) -> float:
    """Wallace 1972, eq. 7: 64 k^2 a b / (pi^6 m^2 n^2) times the integral of the directivity over the quarter space."""
    k = 2 * np.pi * frequency / 343.0

    def side(q: int, alpha: float) -> float:
        wave = np.cos(alpha / 2) if q % 2 else np.sin(alpha / 2)
        return float(wave / ((alpha / (q * np.pi)) ** 2 - 1)) ** 2

    def inner(theta: float, phi: float) -> float:
        along = side(m, k * A * np.sin(theta) * np.cos(phi)) * side(n, k * B * np.sin(theta) * np.sin(phi))
        return float(along * np.sin(theta))

    whole = dblquad(inner, 0, np.pi / 2, 0, np.pi / 2)[0]
    return float(64 * k**2 * A * B / (np.pi**6 * m**2 * n**2) * whole)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("power")
    (made / "plate.yaml").write_text(MODEL, encoding="utf-8")
    (made / "hit.study.yaml").write_text(STUDY, encoding="utf-8")
    return made


@pytest.fixture(scope="module")
def result(folder: Path) -> StudyResult:
    return run_study(read_study(folder / "hit.study.yaml"))


@pytest.fixture(scope="module")
def case(result: StudyResult) -> CaseResult:
    return result.cases["as given"]


def test_power_is_what_arrives_far_away(folder: Path, case: CaseResult) -> None:
    """|p|^2 / (rho c) over a half sphere of 40 m by Rayleigh's integral, for a force of 1 N rms."""
    answer = case.frf["push"]
    assert answer.unit == "W/N^2" and answer.sound is not None
    chosen = slice(40, None, 110)
    plan = read_study(folder / "hit.study.yaml")
    study = plan.cases[0].study
    room = next(one for one in study.rooms if one.name == "open")
    places = solve_all(plan.cases)["as given"].places
    height, share = np.polynomial.legendre.leggauss(12)
    height, share, around = (height + 1) / 2, share / 2, 2 * np.pi * np.arange(24) / 24
    ring = np.sqrt(1 - height**2)
    receivers = [
        Receiver(f"{z:.3f} {a:.3f}", [40 * r * np.cos(a), 40 * r * np.sin(a), -40 * z])
        for z, r in zip(height, ring, strict=True)
        for a in around
    ]
    drive = places.point("P", "test").probe("z")
    hz = answer.frequency_hz[chosen]
    p, _ = pressure_per_force(case.basis, drive, placed(room.room, places.surfaces["low"]), receivers, hz)
    arrived = 40.0**2 / RC * (np.repeat(share, 24) * 2 * np.pi / 24) @ np.abs(p) ** 2
    # 1e-3: the size of the plate over the distance
    assert answer.sound.power[chosen] == pytest.approx(arrived.tolist(), rel=1e-3)
    assert (answer.sound.power < answer.sound.put_in).all()


def test_efficiency_at_the_first_resonance(case: CaseResult) -> None:
    """Where one mode of the plate is nearly alone, its own efficiency."""
    answer = case.frf["push"]
    assert answer.sound is not None
    line = int(np.abs(answer.frequency_hz - natural(1, 1)).argmin())
    exact = efficiency(1, 1, answer.frequency_hz[line])
    assert answer.sound.efficiency[line] == pytest.approx(exact, rel=2e-3)  # the other modes


def test_energy_of_a_pulse_is_power_times_its_spectrum(case: CaseResult) -> None:
    """J = 2 int P |F|^2 df of the power over frequency and the pulse's spectrum: one by time, the other by lines."""
    answer, found = case.frf["push"], case.radiated["open"]
    assert answer.sound is not None
    f, w, w0 = answer.frequency_hz, 2 * np.pi * answer.frequency_hz, 2 * np.pi * 60.5
    force = 10 * w0 / (w0**2 - w**2) * (1 + np.exp(-1j * w * np.pi / w0))  # of half a sine
    wanted = 2 * np.trapezoid(answer.sound.power * np.abs(force) ** 2, f)
    assert found.energy.energy_j == pytest.approx(wanted, rel=1e-3)  # above 700 Hz, and the pulse between samples
    above, below = case.radiated["roof"].energy.energy_j, found.energy.energy_j
    assert above == pytest.approx(below, rel=1e-6)  # both sides move alike


def test_share_of_a_mode_is_its_loss_factor(folder: Path) -> None:
    """Of one mode: rho c sigma / (omega m'') over 2 zeta of what is lost."""
    pulse = STUDY.replace(
        "at: P.z, half_sine: {amplitude: -10 N, frequency: 60.5 Hz}",
        "at: C.z, half_sine: {amplitude: 10 N, frequency: 50 Hz}",
    )
    path = folder / "centre.study.yaml"
    path.write_text(pulse, encoding="utf-8")
    case = run_study(read_study(path)).cases["as given"]
    assert case.response is not None
    lost, found = case.response.ledger.end.lost_modes, case.radiated["open"]
    f = natural(1, 1)
    exact = RC * efficiency(1, 1, f) / (2 * np.pi * f * RHO * H) / (2 * ZETA)
    # 5 %: the pulse itself moves the plate below its resonance, where it radiates less
    assert found.energy.energy_j / lost == pytest.approx(exact, rel=0.05)
    assert found.given_j == pytest.approx(case.response.ledger.end.work, rel=1e-6)  # the same work, summed by samples
    assert found.share == pytest.approx(found.energy.energy_j / found.given_j)


def test_power_put_in_is_that_of_an_infinite_plate_on_average(folder: Path) -> None:
    """1 / (8 sqrt(D m'')) over frequency and places (Cremer, Heckl): a plate of 35 modes in the band, five places."""
    big = MODEL.replace(f"size: [{A}, {B}],\n  mesh: [12, 10]", "size: [1.2, 0.95], mesh: [18, 15]")
    spots = [[0.31, 0.22], [0.45, 0.41], [0.77, 0.3], [0.52, 0.68], [0.2, 0.55]]
    big = big.replace("points: {P: {on: plate, at: [0.2, 0.15]}", f"points: {{P: {{on: plate, at: {spots}}}")
    (folder / "big.yaml").write_text(big, encoding="utf-8")
    asked = "".join(
        f"  f{i}: {{drive: P.{i}.z, response: open.power, kind: power, band: [150 Hz, 1100 Hz], step: 4 Hz}}\n"
        for i in range(1, 6)
    )
    text = f"model: big.yaml\nmodes: {{up_to: 1.8 kHz}}\nfrf:\n{asked}rooms: {{open: {{above: top}}}}\n"
    (folder / "big.study.yaml").write_text(text, encoding="utf-8")
    case = run_study(read_study(folder / "big.study.yaml")).cases["as given"]
    put_in = np.mean([one.sound.put_in.mean() for one in case.frf.values() if one.sound is not None])
    # 10 %: 30 modes at five places leave this much
    assert put_in == pytest.approx(1 / (8 * np.sqrt(BENDING * RHO * H)), rel=0.10)


def test_everything_is_stored_and_told(result: StudyResult, case: CaseResult, tmp_path: Path) -> None:
    found = case.radiated["open"]
    write_results(tmp_path / "results.h5", result)
    table = summary(result)["cases"]["as given"]["sound_energy"]["open"]
    assert table["energy_j"] == found.energy.energy_j
    assert table["l_j_db"] == pytest.approx(10 * np.log10(found.energy.energy_j / 1e-12))
    assert table["bands_db"]["100"] == found.energy.bands_db[100.0]
    assert sorted(table["directivity"]) == ["200", "500"]
    with h5py.File(tmp_path / "results.h5") as file:
        stored = file["cases/as given/sound_energy/open"]
        total = stored["density"][()].sum() * stored["frequency_hz"][1]
        assert total == pytest.approx(stored.attrs["energy_j"], rel=1e-12)  # rounding
        assert stored["directivity/pressure"].shape == (2, 2, 181)
        assert [name.decode() for name in stored["directivity/side"][()]] == ["x", "y"]
        power = file["cases/as given/frf/push"]
        assert power["response"].attrs["unit"] == "W/N^2"
        assert power["efficiency"].shape == power["response"].shape == power["put_in"].shape
    assert "sound energy radiated by surfaces into the open" in report(result)
    (grid,) = (one for one in study_tables(result) if one.title.startswith("sound energy"))
    assert [row[0] for row in grid.rows] == ["open", "roof"]
    assert grid.rows[0][2] == f"{found.energy.level_db:.1f}"


def test_directivity_is_drawn_at_the_frequencies_asked_for(result: StudyResult, case: CaseResult) -> None:
    assert case.radiated["open"].pattern.frequency_hz.tolist() == [200.0, 500.0]
    figure = room_directivity(result, "open")
    assert figure is not None
    labels = [str(line.get_label()) for line in figure.axes[1].get_lines()]
    assert labels[0].startswith("200 Hz") and labels[1].startswith("500 Hz")
    names = set(figures(result))
    assert {"sound_energy_open.png", "directivity_open.png", "frf_push.png", "directivity_push.png"} <= names
    loud = case.radiated["roof"].pattern.frequency_hz  # not asked for: the loudest
    assert loud[0] == pytest.approx(natural(1, 1), rel=0.05)  # the loudest line beside the resonance


def test_nobody_needs_to_listen(case: CaseResult, folder: Path) -> None:
    assert "open" not in case.rooms and "roof" in case.rooms
    table = inspect_file(folder / "hit.study.yaml").table()["rooms"]["open"]
    assert table == {"side": "below", "receivers_m": {}, "directivity_hz": [200.0, 500.0]}
    (impact,) = without_rooms(read_study(folder / "hit.study.yaml")).cases
    assert not impact.study.rooms and not impact.study.frf


def test_cases_are_compared(folder: Path) -> None:
    """Twice the force on the same plate: 6.02 dB more, in the tables and on the screen."""
    path = folder / "twice.study.yaml"
    path.write_text(STUDY + "cases: {once: {}, twice: {loads.push.half_sine.amplitude: -20 N}}\n", encoding="utf-8")
    both = run_study(read_study(path))
    # the air is linear: the steps alone differ
    assert summary(both)["comparison"]["twice"]["sound_energy_db"] == pytest.approx(
        {"open": 20 * np.log10(2), "roof": 20 * np.log10(2)}, abs=1e-6
    )
    (grid,) = (one for one in study_tables(both) if one.title.startswith("sound energy"))
    assert [(row[0], row[1], row[4]) for row in grid.rows] == [
        ("open", "once", ""),
        ("open", "twice", "+6.0"),
        ("roof", "once", ""),
        ("roof", "twice", "+6.0"),
    ]


def test_reasons_to_believe_it_less(folder: Path) -> None:
    """Few modes, a short record, air that matters; each with its numbers."""
    text = STUDY.replace("up_to: 2 kHz", "up_to: 150 Hz").replace("500 ms", "40 ms").replace("60.5 Hz", "900 Hz")
    path = folder / "little.study.yaml"
    path.write_text(text.replace("open: {below: low", "open: {air: {rho: 500}, below: low"), encoding="utf-8")
    case = run_study(read_study(path)).cases["as given"]
    told = {one.code: one for one in case.findings}
    assert told["sound-energy-beyond-modes"].values["complete_below_hz"] == 150.0
    assert told["sound-energy-beyond-modes"].values["share"] > 0.01
    assert told["sound-energy-not-decayed"].values["last_tenth"] > 0.01
    assert case.response is not None
    both = sum(one.energy.energy_j for one in case.radiated.values())  # of both sides of the plate
    ratio = both / case.response.ledger.end.lost_modes
    assert ratio > 0.1
    assert told["sound-energy-not-taken"].values["sound_over_losses"] == pytest.approx(ratio)
    assert told["power-beyond-modes"].values == {"highest_hz": 700.0, "complete_below_hz": 150.0}
    assert told["sound-energy-not-taken"].message.startswith("open, roof: ")


def test_silence(folder: Path, tmp_path: Path) -> None:
    """Nothing moves: no level, no picture, and nothing that fails."""
    path = folder / "silent.study.yaml"
    path.write_text(STUDY.replace("amplitude: -10 N", "amplitude: 0 N"), encoding="utf-8")
    silent = run_study(read_study(path))
    write_results(tmp_path / "results.h5", silent)
    table = summary(silent)["cases"]["as given"]["sound_energy"]
    assert table["open"]["l_j_db"] is None and table["open"]["energy_j"] == 0.0
    assert table["roof"]["directivity"] == {}
    assert sound_energy(silent, "open") is None and room_directivity(silent, "roof") is None
    assert "sound energy" in report(silent)


@pytest.mark.parametrize(
    ("change", "to", "told"),
    [
        ("response: open.power", "response: opne.power", "did you mean 'open.power'"),
        ("kind: power", "kind: mobility", r"'mobility' of a power"),
        ("response: open.power", "response: roof.mic.pressure", r"expected ROOM\.power"),
        ("band: [4 Hz", "band: [0 Hz", "a band above 0 Hz"),
        ("[200 Hz, 500 Hz]", "[200 Hz, 7 kHz]", "less than half the sampling, 6000 Hz"),
        ("[200 Hz, 500 Hz]", "[200 Hz, 5 m]", "a length"),
        ("open: {below: low,", "open: {size: [1, 1, 1], under: low,", "'directivity' beside 'under'"),
    ],
)
def test_what_is_wrong_is_said(folder: Path, change: str, to: str, told: str) -> None:
    path = folder / "wrong.study.yaml"
    assert change in STUDY
    path.write_text(STUDY.replace(change, to), encoding="utf-8")
    with pytest.raises(InputErrors, match=told) as refused:
        inspect_file(path)
    assert "wrong.study.yaml:" in str(refused.value)


def test_a_directivity_of_nothing_is_refused(folder: Path) -> None:
    path = folder / "still.study.yaml"
    text = "model: plate.yaml\nmodes: {up_to: 500 Hz}\nrooms: {open: {below: low, directivity: 100 Hz}}\n"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputErrors, match="a directivity of nothing that moves"):
        inspect_file(path)
