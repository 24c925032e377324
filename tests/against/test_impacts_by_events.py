"""Studies from YAML against bodies and modes by events, a formulation that shares no line with the packages."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from femstruct.language.cases import read_study
from femstruct.study.results import CaseResult
from femstruct.workflow.run import run_study
from tests.independent.contact_events import Again, Chain, Spring, Touch, linear, power, run

G = 9.80665


@pytest.mark.parametrize("gravity", [False, True])
def test_a_body_on_the_ground_is_struck_twice(tmp_path: Path, gravity: bool) -> None:
    """Without a structure: the one that lies there is a companion of the blows, its travel what it moves."""
    (tmp_path / "none.yaml").write_text("structure: none\n")
    study = tmp_path / "two.study.yaml"
    study.write_text(
        "model: none.yaml\n"
        "bodies:\n"
        "  b: {mass: 0.8 kg, above: ground}\n"
        "  a: {mass: 0.5 kg, above: b, speed: 2 m/s, contact: {type: linear, stiffness: 760 kN/m, damping: 300 N*s/m},"
        " blows: {count: 2, every: 5.95 ms}}\n"
        "contacts: {lay: {between: [b, ground], law: {type: hunt-crossley, stiffness: 3e9 N/m^1.5, dissipation: .3}}}\n"
        "record: {a: [velocity, acceleration], b: [displacement, travel, acceleration], lay: force}\n"
        f"time: {{duration: 15 ms, sampling: 10 kHz, gravity: {str(gravity).lower()}}}\n"
    )
    case = next(iter(run_study(read_study(study)).cases.values()))
    weigh = G if gravity else 0.0
    lay = Touch("lay", "b", None, power(3e9, 1.5, 0.3), preload=0.8 * weigh)
    path = run(
        Chain(
            bodies={"b": 0.8, "a": 0.5},
            touches=[lay, Touch("hit", "a", "b", linear(760e3, 300.0))],
            weights={"a": -0.5 * weigh},
            start={"a": -2.0},
            again=[Again("a", "b", (5.95e-3,))],
        ),
        15e-3,
        max_step=1e-4,
    )
    t = case.response.t
    moved = path.moved("b", t)
    close = 1e-7 * np.abs(moved).max()  # DOP853 at 1e-11 against ours at 1e-9, through four contacts
    assert np.abs(case.channels["b displacement"].values - moved).max() < close
    assert np.abs(case.channels["b travel"].values - moved).max() < close  # the ground does not move
    # the reference integrates to rtol 1e-11, events of both included
    assert np.abs(case.channels["a velocity"].values - path.speed("a", t)).max() < 1e-7 * 2.0
    # as above
    assert case.response.contacts["lay"].peak_force == pytest.approx(path.peak("lay"), rel=1e-7)
    for name in "ab":
        right = path.acceleration(name, t)
        found = case.channels[f"{name} acceleration"].values
        # as above, in forces of the law's stiffness times it
        assert np.abs(found - right).max() < 1e-6 * np.abs(right).max()


def test_a_low_pass_of_a_body_sees_its_change_of_velocity(tmp_path: Path) -> None:
    """The force of a linear law with restitution jumps where a body touches; before it the body falls at -g."""
    (tmp_path / "none.yaml").write_text("structure: none\n")
    study = tmp_path / "one.study.yaml"
    law = "{type: linear, stiffness: 1 MN/m, damping: 1 kN*s/m}"
    study.write_text(
        "model: none.yaml\n"
        f"bodies: {{ram: {{mass: 5 kg, above: ground, speed: 1 m/s, contact: {law}}}}}\n"
        "record: {ram: acceleration}\nlimits: {ram acceleration: 5 g}\npeaks: {lowpass: 20 Hz}\n"
        "time: {duration: 150 ms, sampling: 2 kHz, gravity: true}\n"
    )
    result = run_study(read_study(study))
    case = result.cases["as given"]
    touch = Touch("hit", "ram", None, linear(1e6, 1e3))
    path = run(Chain(bodies={"ram": 5.0}, touches=[touch], weights={"ram": -5.0 * G}, start={"ram": -1.0}), 0.4)
    fine = 200e3  # the change of velocity in 5 us, -g before and after
    held = np.full(int(0.3 * fine), -G)
    a = np.concatenate([held, fine * np.diff(path.speed("ram", np.arange(int(0.4 * fine) + 1) / fine))])
    low = sosfiltfilt(butter(4, 20.0, fs=fine, output="sos"), a)
    right = np.abs(low[len(held) : len(held) + int(0.15 * fine)]).max()
    assert case.channels["ram acceleration"].whole == pytest.approx(
        right, rel=1e-3
    )  # steps of 5 us, ends of the filter
    (verdict,) = result.verdicts["as given"]
    assert verdict.limit == pytest.approx(5.0 * G, rel=1e-12) and verdict.met is bool(
        right < 5.0 * G
    )  # rounding of 5 g


CLAMPED = """
model: none.yaml
bodies: {part: {mass: 2 kg, above: ground}}
contacts: {seat: {between: [part, ground], preload: 100 N, law: {type: linear, stiffness: 1 MN/m, damping: 3 kN*s/m}}}
links: {screw: {between: [ground, part], stiffness: 200 kN/m}}
record: {part: displacement, seat: force}
time: {duration: 50 ms, sampling: 10 kHz}
"""


def clamped(folder: Path, old: str = "", new: str = "") -> CaseResult:
    (folder / "none.yaml").write_text("structure: none\n")
    (folder / "s.study.yaml").write_text(CLAMPED.replace(old, new) if old else CLAMPED)
    return run_study(read_study(folder / "s.study.yaml")).cases["as given"]


def test_what_presses_a_contact_needs_no_preload_of_its_own(tmp_path: Path) -> None:
    """A preload of a contact alone is a state of rest; with one of the link, too, 100 N more come from nowhere."""
    rest = clamped(tmp_path)
    assert not rest.channels["part displacement"].values.any()
    assert rest.channels["seat force"].values == pytest.approx(100.0, rel=1e-12)  # rounding
    assert "preloads-add" not in {one.code for one in rest.findings}
    both = clamped(tmp_path, "200 kN/m}", "200 kN/m, preload: 100 N}")
    # ends that a link drives apart: the part up; its contact opens where the rest is reached
    chain = Chain(
        bodies={"part": 2.0},
        touches=[Touch("seat", "part", None, linear(1e6, 3e3), preload=100.0)],
        springs=[Spring("part", None, 2e5, push=100.0)],
    )
    moved = run(chain, 0.05, max_step=1e-4).moved("part", both.response.t)
    assert np.abs(moved).max() > 1e-5
    # DOP853 at 1e-11 against ours, through events
    assert both.channels["part displacement"].values == pytest.approx(moved, abs=1e-7 * np.abs(moved).max())
    (told,) = [one for one in both.findings if one.code == "preloads-add"]
    assert "pushes 'part' from the start, beside the 100 N of contact 'seat'" in told.message
    later = clamped(tmp_path, "200 kN/m}", "200 kN/m, preload: 100 N, release_at: 10 ms}")
    assert "preloads-add" not in {one.code for one in later.findings}
