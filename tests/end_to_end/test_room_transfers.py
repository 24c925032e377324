"""What a room costs is paid once: a second run takes its transfer, and hears the same."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from femstruct.language.cases import read_study
from femstruct.workflow.coupled_air import RoomTransfers
from femstruct.workflow.run import KeptStages, run_again, run_study

STUDY = Path(__file__).parents[2] / "models" / "floor_tennis_ball.study.yaml"
SHORT = ("time.duration=0.3 s",)


def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many transfer functions of a room are evaluated, a number for every call."""
    made: list[int] = []
    for name in ("acoustics.rooms.box_pressure", "acoustics.rooms.box_pressure"):
        stage = sys.modules[name]
        transfer = stage.transfer

        def spy(room, s, k_lm, z, transfer=transfer):
            made.append(len(s) * len(k_lm))
            return transfer(room, s, k_lm, z)

        monkeypatch.setattr(stage, "transfer", spy)
    return made


def test_a_second_run_takes_the_transfer_of_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    made = counted(monkeypatch)
    transfers = RoomTransfers()
    run_again(read_study(STUDY, SHORT, "without damper"), KeptStages(rooms=transfers))[0]
    assert made
    transfers.prepare()
    made.clear()
    other = (*SHORT, "bodies.ball.mass=0.08 kg")
    again = run_again(read_study(STUDY, other, "without damper"), KeptStages(rooms=transfers))[0].cases[
        "without damper"
    ]
    assert not made
    alone = run_study(read_study(STUDY, other, "without damper")).cases["without damper"]
    assert made
    for name, heard in alone.rooms.items():
        scale = np.abs(heard.p).max()
        # the search of either ends at 1e-4 of what is heard; the sums are the same but for that
        assert np.abs(again.rooms[name].p - heard.p).max() < 1e-4 * scale
        assert [one.code for one in again.rooms[name].findings] == [one.code for one in heard.findings]
    for name, levels in alone.levels.items():
        # 1e-4 of the pressure, as said above: 9e-4 dB
        assert again.levels[name].l_afmax_db == pytest.approx(levels.l_afmax_db, abs=1e-3)


def test_the_same_motion_is_heard_the_same_to_rounding(monkeypatch: pytest.MonkeyPatch) -> None:
    plan, transfers = read_study(STUDY, SHORT, "without damper"), RoomTransfers()
    first, again = (
        run_again(plan, KeptStages(rooms=transfers))[0].cases["without damper"].rooms["box"].p for _ in range(2)
    )
    # the weight of the transform amplifies rounding, and what lines of weight 1e-12 had, to the end of the record: 2e-8
    assert np.abs(again - first).max() < 1e-7 * np.abs(first).max()


def test_another_room_is_not_taken_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    transfers = RoomTransfers()
    run_again(read_study(STUDY, SHORT, "without damper"), KeptStages(rooms=transfers))[0]
    transfers.prepare()
    made = counted(monkeypatch)
    for other in ("rooms.box.receivers.mic=[0.3, 0.2, 0.06]", "time.sampling=40 kHz"):
        made.clear()
        run_again(read_study(STUDY, (*SHORT, other), "without damper"), KeptStages(rooms=transfers))[0]
        assert made, other
