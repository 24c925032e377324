"""When a tapping machine's sound is averaged, and what is told when the room has not filled by then."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from femstruct.impact.scene import TAPPING_MACHINE
from femstruct.language.cases import read_study
from femstruct.modal.closed_form import given_modes
from femstruct.study.study import Study
from femstruct.workflow.impact_findings import source_findings
from femstruct.workflow.rated_rooms import averaging_window, overlap_findings, rated_findings
from femstruct.workflow.run import run_study, without_rooms

MODES = given_modes((5000.0,), (0.01,), {"p": (1.0,)})[0]
MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 0.15 m, origin: [0, 0, 2.5], size: [3, 2], mesh: [6, 4]}}
points: {feet: {on: slab, at: [[1, 1], [1.1, 1], [1.2, 1], [1.3, 1], [1.4, 1]]}}
surfaces: {ceiling: {on: slab, side: below}}
"""
STUDY = """model: model.yaml
modes: {up_to: 800 Hz}
bodies: {h: {source: tapping machine, above: feet, contact: {type: linear, stiffness: 2 MN/m}, blows: {BLOWS}}}
time: {duration: LENGTH, sampling: 8 kHz}
rooms: {room: {size: [3, 2, 2.5], under: ceiling, losses: {t60: T60}, receivers: {mic: [1, 1, 1]}, levels: ISO 717-2}}
"""


def study(folder: Path, count: int, length: str, t60: str = "0.5 s") -> Study:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    text = STUDY.replace("BLOWS", f"count: {count}, timing: regular").replace("LENGTH", length).replace("T60", t60)
    (folder / "one.study.yaml").write_text(text, encoding="utf-8")
    return read_study(folder / "one.study.yaml").cases[0].study


@pytest.mark.parametrize(
    ("count", "length", "window"),
    [
        (1, "0.5 s", (0.0, 0.5)),
        (2, "3 s", (0.5, 1.0)),  # the machine stops before the record does
        (9, "1.7 s", (1.0, 1.5)),  # the record ends within a turn
        (8, "4 s", (2.0, 4.0)),
    ],
)
def test_whole_turns_of_the_later_half_are_averaged(tmp_path: Path, count: int, length: str, window) -> None:
    assert averaging_window(study(tmp_path, count, length)) == pytest.approx(window)


@pytest.mark.parametrize(
    ("count", "t60", "told"),
    [(1, "0.5 s", "is then silent"), (2, "3 s", "0.46 dB below"), (2, "0.5 s", ""), (8, "3 s", "")],
)
def test_a_room_that_fills_slowly_is_told(tmp_path: Path, count: int, t60: str, told: str) -> None:
    """What is missing of the steady mean square after a time t is 10^(-6 t / T60): with 3 s, .1 of it after .5 s."""
    one = study(tmp_path, count, "4 s", t60)
    codes = {
        found.code: found for found in (*rated_findings(one.rooms[0], one), *overlap_findings(one.rooms[0], one, MODES))
    }
    assert -10 * np.log10(1 - 0.1) == pytest.approx(0.46, abs=5e-3)  # two decimals
    assert ("tapping-not-steady" in codes) == bool(told)
    if told:
        assert told in codes["tapping-not-steady"].message


def test_what_hammers_keep_of_their_speed_is_told(tmp_path: Path) -> None:
    """On a spring and dashpot of ratio 0.2, with a slab a thousand times heavier: the closed form for a spring that
    cannot pull. The range is that of 1 + e from 1 to 2."""
    damping = 0.2 * 2 * np.sqrt(0.5 * 2e6)
    text = STUDY.replace("stiffness: 2 MN/m", f"stiffness: 2 MN/m, damping: {damping}").replace(
        "BLOWS", "count: 1, timing: regular"
    )
    text = text.replace("LENGTH", "0.5 s").replace("T60", "0.5 s").replace(", levels: ISO 717-2", "")
    (tmp_path / "model.yaml").write_text(MODEL.replace("0.15 m", "0.4 m"), encoding="utf-8")
    (tmp_path / "one.study.yaml").write_text(text, encoding="utf-8")
    case = run_study(without_rooms(read_study(tmp_path / "one.study.yaml"))).cases["as given"]
    told = [found for found in case.findings if found.code == "hammers-rebound"]
    assert len(told) == 1
    assert told[0].message.startswith("h: the hammers rebound from this floor with ")
    found = told[0].values
    # let go where the force is zero: e = exp(-zeta / sqrt(1 - zeta^2) atan2(...)), Brilliantov and Poeschel (2005)
    root = np.sqrt(1 - 0.2**2)
    wanted = np.exp(-0.2 / root * (np.pi + np.arctan2(-2 * 0.2 * root, 1 - 2 * 0.2**2)))
    assert found["restitution"] == pytest.approx(wanted, abs=0.02)  # what the slab takes: 2 zeta_plate, m / Z T = 1 %
    assert found["lower_db"] + found["higher_db"] == pytest.approx(20 * np.log10(2))
    assert found["lower_db"] == pytest.approx(20 * np.log10(1 + found["restitution"]))


CHIPBOARD = """
materials: {chipboard: {E: 3.347 GPa, nu: 0.3, rho: 760, loss_factor: 3 %}}
parts: {board: {type: plate, material: chipboard, thickness: 22 mm, origin: [0, 0, 0], size: [1.2, 1], mesh: 100 mm}}
supports: {rim: {on: board, edge: all, fix: simple}}
points: {feet: {on: board, side: above, at: [[0.4, 0.5], [0.5, 0.5], [0.6, 0.5], [0.7, 0.5], [0.8, 0.5]]}}
damping: {from: materials}
"""


def test_hammers_that_a_light_floor_meets_again_are_told_by_the_whole_blow(tmp_path: Path) -> None:
    """Without weight a hammer keeps what the impulse of all touches of its blow leaves it: e = I / (m v) - 1."""
    (tmp_path / "model.yaml").write_text(CHIPBOARD, encoding="utf-8")
    (tmp_path / "one.study.yaml").write_text(
        "model: model.yaml\nmodes: {up_to: 500 Hz}\ntime: {duration: 0.3 s, sampling: 200 kHz, gravity: false}\n"
        "bodies: {hammer: {source: tapping machine, above: feet, contact: {type: linear, stiffness: 50 MN/m}}}\n"
        "record: {" + ", ".join(f"hammer.{i} on feet.{i}: force" for i in range(1, 6)) + "}\n",
        encoding="utf-8",
    )
    case = run_study(read_study(tmp_path / "one.study.yaml")).cases["as given"]
    assert case.response is not None and case.response.contacts["hammer.1 on feet.1"].closings > 1
    forces = [case.channels[f"hammer.{i} on feet.{i} force"].values for i in range(1, 6)]
    impulse = float(np.mean(np.trapezoid(forces, dx=1.0 / 200e3, axis=1)))
    (told,) = [found for found in case.findings if found.code == "hammers-rebound"]
    # trapezes of 24 samples a touch or more
    assert told.values["restitution"] == pytest.approx(impulse / (0.5 * 0.886) - 1.0, abs=5e-3)


@pytest.mark.parametrize(
    ("after", "told"),
    [(0.8, "5.1 dB lower to 0.9 dB higher"), (-0.05, "may give levels 0.4 dB to 6.5 dB higher")],
)
def test_a_floor_that_gives_way_to_a_hammer_has_no_level_lower_by_less_than_nothing(after: float, told: str) -> None:
    """20 lg(1 + e) below and 20 lg(2 / (1 + e)) above; a hammer that still moves down when it is let go has e < 0."""
    hammer = SimpleNamespace(name="h.1", target="feet.1", source=TAPPING_MACHINE, speed=2.0)
    response: Any = SimpleNamespace(
        contacts={"h.1 on feet.1": SimpleNamespace(first_open=0.1, closings=1)},
        events=[SimpleNamespace(t=0.1, contact="h.1 on feet.1", what="opens")],
        blows=[],
        clock=SimpleNamespace(sampling=10.0),
        t=np.arange(3.0),
        bodies={"h.1": SimpleNamespace(velocity=np.full(3, 2.0 * after))},
    )
    study: Any = SimpleNamespace(bodies=[hammer])
    (found,) = source_findings(study, response)
    assert found.message.endswith(told)


@pytest.mark.parametrize(
    ("what", "told"),
    [
        (
            "bodies: {b: {source: bang machine, above: feet.1}}",
            "here the source is bang machine, for JIS A 1419-2 or KS F 2863-2",
        ),
        ("loads: {w: {along: feet.1, walking: {mass: 75 kg, pace: 2 Hz, steps: 4}}}", "here the source is w"),
        ("bodies: {b: {source: rubber ball, above: feet.1}}", ""),
    ],
)
def test_a_rating_of_a_bang_machine_or_a_walker_is_told(tmp_path: Path, what: str, told: str) -> None:
    """Numbers of ISO 717-2 are of the rubber ball and the tapping machine; of other blows they are only comparable."""
    study(tmp_path, 1, "1 s")  # writes the model
    lines = [what if line.startswith("bodies") else line for line in STUDY.splitlines()]
    text = "\n".join(lines).replace("LENGTH", "1 s").replace("T60", "0.5 s")
    (tmp_path / "other.study.yaml").write_text(text, encoding="utf-8")
    one = read_study(tmp_path / "other.study.yaml").cases[0].study
    codes = {
        found.code: found for found in (*rated_findings(one.rooms[0], one), *overlap_findings(one.rooms[0], one, MODES))
    }
    assert ("rating-of-other-blows" in codes) == bool(told)
    if told:
        assert told in codes["rating-of-other-blows"].message
