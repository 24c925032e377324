"""The level of nothing is no number: it is blank, with its reason, where nothing moves and nothing acts."""

from __future__ import annotations

import json
from math import isnan
from pathlib import Path

import numpy as np
import pytest

from acoustics.levels.sound_levels import (
    a_levels,
    equivalent_levels,
    force_exposure_levels,
    level_history,
    level_spectrum,
    sound_levels,
)
from tests.data.command_line import femstruct

pytestmark = pytest.mark.filterwarnings("error")
DT = 1 / 8000.0

MODEL = """
title: Two slabs that nothing joins
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts:
  upper: {type: plate, material: concrete, thickness: 100 mm, origin: [0, 0, 3], size: [3, 2], mesh: 500 mm}
  lower: {type: plate, material: concrete, thickness: 80 mm, origin: [0, 0, 0], size: [3, 2.5], mesh: 500 mm}
supports: {a: {on: upper, edge: all, fix: simple}, b: {on: lower, edge: all, fix: simple}}
points: {above: {on: upper, at: [1.1, 1.3]}, below: {on: lower, at: [1.1, 1.3]}}
surfaces: {first: {on: upper, side: below}, second: {on: lower, side: below}}
damping: {loss_factor: 5 %}
"""
STUDY = """
title: A ball on one of them
model: m.yaml
modes: {up_to: 130 Hz}
bodies: {ball: {source: rubber ball, above: above}}
record: {below.z: velocity}
time: {duration: 0.5 s, sampling: 6 kHz}
frf: {heard: {kind: pressure, drive: above.z, response: under.mic.pressure, band: [20 Hz, 100 Hz], step: 10 Hz}}
rooms:
  under:
    size: [3, 2.5, 3]
    surfaces: {ceiling: second}
    losses: {t60: 0.5 s}
    levels: ISO 717-2
    receivers: {mic: [0.9, 0.6, 1.2], far: [1.9, 1.6, 1.2]}
limits: {under rating: 50 dB}
cases: {upper: {}, lower: {bodies.ball.above: below}}
compare: {baseline: lower}
"""


def test_levels_of_nothing_are_no_numbers() -> None:
    """All kinds of levels of zeros: nan, where they were near -206 dB, and nothing divides by it with a warning."""
    nothing = np.zeros(4000)
    levels = sound_levels(nothing, DT)
    assert levels.peak_pa == 0.0
    assert all(isnan(one) for one in levels.single_numbers.values())
    for one in (levels.bands_db, levels.octaves_db, levels.exposure_db, equivalent_levels(nothing, DT)):
        assert all(isnan(level) for level in one.values())
    assert all(isnan(one) for one in a_levels(nothing, DT))
    assert np.isnan(level_history(nothing, DT)).all()
    assert np.isnan(level_spectrum(nothing, DT)[1]).all()
    assert all(isnan(one) for one in force_exposure_levels(nothing, DT).values())


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict, str]:
    folder = tmp_path_factory.mktemp("silence")
    (folder / "m.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "s.study.yaml").write_text(STUDY, encoding="utf-8")
    told = femstruct("run", "s.study.yaml", "-o", "r", cwd=folder)
    assert told.returncode == 0
    assert "Warning" not in told.stderr
    return json.loads((folder / "r" / "summary.json").read_text(encoding="utf-8")), told.stdout


def test_a_room_whose_surface_stands_still_has_blank_levels_and_says_why(ran: tuple[dict, str]) -> None:
    """The struck slab is not joined to the room's: its levels were -185 dB, those of rounding errors."""
    summary, told = ran
    still = summary["cases"]["upper"]
    assert still["levels"]["under.mic"]["peak_pa"] == 0.0
    assert still["levels"]["under.mic"]["l_afmax_db"] is None
    rated = still["rated"]["under"]
    for key in ("bands_db", "mean_db", "low_db", "high_db"):
        assert set(rated[key].values()) == {None}, key
    assert rated["numbers"]["L_iA,Fmax"]["value_db"] is None
    assert still["limits"]["under rating"]["verdict"] == "not known"
    assert "room-silent" in {one["code"] for one in still["findings"]}
    assert "room-silent: under: none of its surfaces moves: its levels are blank" in told
    assert "blank: beyond the modes, or silent" in told
    assert "nan" not in told.lower().replace("resonance", "")


def test_the_other_case_is_heard_and_nothing_is_said_of_rounding(ran: tuple[dict, str]) -> None:
    """No attenuation of 280 dB at modes, which was the ratio of rounding errors."""
    summary, _ = ran
    heard = summary["cases"]["lower"]
    assert heard["levels"]["under.mic"]["l_afmax_db"] > 40.0
    assert "room-silent" not in {one["code"] for one in heard["findings"]}
    beside = summary["comparison"]["upper"]
    assert not beside["modes_db_by_channel"].get("under.mic pressure")
    assert not beside["modes_db_by_channel"].get("below.z velocity")
    assert not beside["bands_db_by_receiver"]["under.mic"]


def test_open_air_beside_what_stands_still(tmp_path: Path) -> None:
    """Nobody listens: the energy is 0, and why is said."""
    text = STUDY[: STUDY.index("frf:")] + "rooms: {outside: {above: third}}\n" + STUDY[STUDY.index("cases:") :]
    (tmp_path / "m.yaml").write_text(MODEL.replace("surfaces: {", "surfaces: {third: {on: lower, side: above}, "))
    (tmp_path / "s.study.yaml").write_text(text, encoding="utf-8")
    told = femstruct("run", "s.study.yaml", "--no-pictures", "--json", cwd=tmp_path)
    cases = json.loads(told.stdout)["cases"]
    assert cases["upper"]["sound_energy"]["outside"]["energy_j"] == 0.0
    codes = {name: {one["code"] for one in case["findings"]} for name, case in cases.items()}
    assert "room-silent" in codes["upper"] - codes["lower"]
