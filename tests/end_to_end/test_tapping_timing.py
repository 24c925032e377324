"""When a tapping machine strikes: single blows that add in energy, by default, or turns exactly 0.1 s apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from acoustics.levels.sound_levels import sound_levels
from femstruct.errors import InputErrors
from femstruct.language.cases import read_study
from femstruct.study.results import CaseResult
from femstruct.workflow.run import run_study

MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 0.14 m, origin: [0, 0, 2.5], size: [4, 3], mesh: [12, 9]}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points: {feet: {on: slab, at: [[1, 1], [1.1, 1], [1.2, 1], [1.3, 1], [1.4, 1]]}, hit: {on: slab, at: [1.2, 1]}}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: 8 %}
"""
STUDY = """model: model.yaml
modes: {up_to: 1010 Hz}
bodies: {h: BODY}
time: {duration: LENGTH, sampling: 7.6 kHz}
rooms: {lab: {size: [4, 3, 2.5], under: ceiling, losses: {t60: 0.4 s}, receivers: {mic: [1, 1, 1]}, levels: ISO 717-2}}
"""
MACHINE = "{source: tapping machine, above: feet, contact: {type: linear, stiffness: 2 MN/m}BLOWS}"
# one of its hammers by hand, 40 mm, at one of its feet
HAMMER = "{mass: 0.5 kg, above: feet.NUMBER, drop_height: 40 mm, contact: {type: linear, stiffness: 2 MN/m}}"
RATED = (100.0, 125.0, 160.0, 200.0, 250.0, 315.0, 400.0, 500.0, 630.0, 800.0)


def run(folder: Path, body: str, length: str = "1.5 s") -> CaseResult:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    text = STUDY.replace("BODY", body).replace("LENGTH", length)
    (folder / "one.study.yaml").write_text(text, encoding="utf-8")
    return run_study(read_study(folder / "one.study.yaml")).cases["as given"]


def rated(case: CaseResult) -> list[float]:
    return [case.rated["lab"].bands_db[band] for band in RATED]


def test_levels_are_ten_single_blows_a_second(tmp_path: Path) -> None:
    """p^2 = 10 / s times the mean over the hammers of int p_k^2 dt, each simulated alone."""
    exposures = []
    for number in range(1, 6):
        response = run(tmp_path, HAMMER.replace("NUMBER", str(number)), "0.7 s").rooms["lab"]
        exposures.append([sound_levels(response.p[0], response.dt).exposure_db[band] for band in RATED])
    wanted = 10 * np.log10(10.0 * np.mean(10 ** (np.array(exposures) / 10), axis=0))
    case = run(tmp_path, MACHINE.replace("BLOWS", ""))
    # 0.3 s in which the room falls by 45 dB lie between the blows; sounds end at 1010 Hz, bands by 0.1 dB there
    assert rated(case) == pytest.approx(wanted.tolist(), abs=0.12)
    assert case.response is not None
    # the start of a blow is a time that is given: rounding
    assert [blow.t for blow in case.response.blows] == pytest.approx([0.0, 0.3, 0.6, 0.9, 1.2], abs=1e-14)
    assert "blows-overlap" not in {one.code for one in case.findings}
    same = run(tmp_path, MACHINE.replace("BLOWS", ", blows: {timing: uncorrelated}"))
    assert rated(same) == rated(case)


def test_regular_turns_stay_and_hang_on_their_lines(tmp_path: Path) -> None:
    single = run(tmp_path, MACHINE.replace("BLOWS", ""))
    turns = run(tmp_path, MACHINE.replace("BLOWS", ", blows: {count: 3, timing: regular}"))
    assert turns.response is not None
    # the same
    assert [blow.t for blow in turns.response.blows] == pytest.approx([0.1 * i for i in range(15)], abs=1e-14)
    off = np.subtract(rated(turns), rated(single))
    # lines 10 Hz apart: bands of one or two modes differ by decibels, those of many by little
    assert np.abs(off[:4]).max() > 1.0 and np.abs(off[-2:]).max() < 1.0


def test_blows_that_overlap_are_told(tmp_path: Path) -> None:
    case = run(tmp_path, MACHINE.replace("BLOWS", ""), "0.75 s")
    (found,) = (one for one in case.findings if one.code == "blows-overlap")
    # T60 of the slab's modes at 100 Hz: 2.2 / (0.08 * 100 Hz) = 0.28 s, of the room 0.4 s
    assert found.values["fallen_db"] == pytest.approx(60 * 0.15 / 0.4, rel=1e-12)  # rounding
    assert "the room" in found.message and "duration: 1.3 s" in found.message


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (
            MACHINE.replace("BLOWS", ", blows: {count: 2}"),
            "got 'blows.count' 2 of a tapping machine whose blows are uncorrelated.*add 'timing: regular'",
        ),
        (MACHINE.replace("BLOWS", ", blows: {timing: odd}"), "bodies.h.blows.timing"),
        (
            HAMMER.replace("NUMBER", "1").replace("}}", "}, blows: {count: 2, every: 0.1 s, timing: regular}}"),
            "blows.timing: got a body that is no tapping machine",
        ),
    ],
)
def test_what_has_no_effect_is_refused(tmp_path: Path, body: str, told: str) -> None:
    with pytest.raises(InputErrors, match=told):
        run(tmp_path, body)
