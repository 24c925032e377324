"""Studies from YAML against bodies and modes by events, a formulation that shares no line with the packages."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from femstruct import read_study, run_study
from tests.independent.contact_events import Again, Chain, Touch, linear, power, run

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
        "record: {a: velocity, b: [displacement, travel], lay: force}\n"
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
