"""The machine itself: what it must find, that it draws the same again, and a fixed seed of it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import verify

from tests.independent.frames import Tube, clamped_frequencies, tip_at_rest
from tests.machine import coverage, running
from tests.machine.framework import Capability, Case, Door, Model, Refused, capabilities

NAME = "frames: tip at rest"


def _planted(rng: np.random.Generator) -> Case:
    """A reference that is 1 % wrong."""
    case = capabilities()[NAME].draw(rng)
    return replace(case, right=lambda model, door: 1.01 * case.right(model, door))


def test_a_planted_fault_is_found_shrunk_and_written(tmp_path: Path) -> None:
    planted = Capability(NAME, "independent", _planted)
    found = running.check(planted, 1, 0)
    assert found.verdict == "fault"
    assert np.allclose(np.array(found.right) / np.array(found.got), 1.01, rtol=1e-5)  # 1 % planted; answers to 1e-6
    (path,) = running.write([found], tmp_path)
    text = path.read_text(encoding="utf-8")
    assert "# got " in text and "# right " in text and "rho: 0.0" not in text
    drawn = planted.case(1, 0).model
    assert len(found.model) < len(running.as_yaml(drawn))


def test_the_same_seed_makes_the_same_checks() -> None:
    one = capabilities()[NAME]
    first, again = one.case(3, 5), one.case(3, 5)
    assert first.model == again.model and first.model != one.case(3, 6).model != one.case(4, 6).model
    assert running.judge(NAME, 5, first) == running.judge(NAME, 5, again)


def test_what_is_no_answer_is_told_apart() -> None:
    case = capabilities()[NAME].case(1, 1)
    bad = {**case.model, "parts": {}}
    assert running.judge(NAME, 1, replace(case, asked=lambda _, door: door.modes(bad, 1))).verdict == "refused"
    assert running.judge(NAME, 1, replace(case, right=lambda *_: 1 / 0)).verdict == "generator"
    assert running.judge(NAME, 1, replace(case, asked=lambda *_: _spin()), limit=0.2).verdict == "slow"
    assert running.judge(NAME, 1, replace(case, asked=lambda *_: np.array([np.nan] * 3))).verdict == "fault"
    assert running.judge(NAME, 1, replace(case, asked=lambda *_: _told())).verdict == "refused"


def _spin() -> np.ndarray:
    while True:
        pass


def _told() -> np.ndarray:
    raise Refused("no")


def test_a_capability_that_does_not_exist_is_answered_with_those_that_do(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["verify.py", "--capability", "nosuch", "--seconds", "1"])
    with pytest.raises(SystemExit):
        verify.main()
    assert "got nosuch" in (told := capsys.readouterr().err) and NAME in told


def test_lines_that_checks_of_a_capability_reach_are_put_together() -> None:
    found = [
        running.Checked("a", 0, "right", seconds=3.0, lines={"x.py": [1, 2]}),
        running.Checked("a", 1, "right", seconds=2.0, lines={"x.py": [2, 5], "y.py": [7]}),
    ]
    assert running.reached(found) == {"a": {"seconds": 2.0, "lines": {"x.py": [1, 2, 5], "y.py": [7]}}}


def test_a_fault_that_the_unchanged_program_has_too_is_no_difference() -> None:
    """It is asked once, of faults whose verdict is not kept, and where a verdict was about time."""
    asked: list[tuple[str, int]] = []

    def unchanged(one: running.Checked) -> str:
        asked.append((one.capability, one.index))
        return "fault" if one.index == 2 else "right"

    differing = running.differs({"a 0": "right", "a 1": "right"}, unchanged)
    verdicts = [
        (0, "right"),
        (0, "fault"),
        (2, "fault"),
        (3, "fault"),
        (4, "told"),
        (1, "slow"),
        (3, "fault"),
        (1, "slow"),
    ]
    found = [differing(running.Checked("a", index, verdict)) for index, verdict in verdicts]
    assert found == [False, True, False, True, False, True, True, True] and asked == [("a", 2), ("a", 3), ("a", 1)]
    assert running.differs({})(running.Checked("a", 9, "crashed"))


def test_interval_of_a_rate() -> None:
    assert running.interval(0, 100) == pytest.approx((0.0, 1 - 0.025 ** (1 / 100)))  # closed form without faults
    assert running.interval(0, 0) == (0.0, 1.0)


def test_the_machine_knows_the_program_by_its_door_alone() -> None:
    here = Path(__file__).resolve().parent
    for path in [*here.glob("*.py"), *(here.parent / "independent").glob("*.py")]:
        assert not re.search(r"^\s*(from|import) (femstruct|acoustics)", path.read_text(encoding="utf-8"), re.M), path


def test_frames_by_hand() -> None:
    tube = Tube(0.02, 0.004, 2e11, 0.3, 7800.0)
    tip = tip_at_rest(tube, np.array([[0.0, 0, 0], [2, 0, 0]]), np.array([0.0, 0, -5]))
    assert tip[2] == pytest.approx(-5 * 2**3 / 3 / tube.E / tube.second_moment)  # F L^3 / 3 E I
    bent = tip_at_rest(tube, np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 0]]), np.array([0.0, 0, -5]))
    EI, GJ = tube.E * tube.second_moment, tube.E / 2.6 * 2 * tube.second_moment
    assert bent[2] == pytest.approx(-5 * (2**3 / 3 / EI + 1 / 3 / EI + 2 / GJ))  # both bend, the first twists
    own = clamped_frequencies(tube, np.array([[0.0, 0, 0], [2, 0, 0]]), 1)[0]
    inertia = tube.rho * tube.area
    assert own == pytest.approx(1.8751041**2 / 2 / pi * np.sqrt(EI / inertia) / 4, rel=1e-6)  # mesh error of 12 bars


def test_a_fixed_seed_finds_nothing() -> None:
    """One check of each capability but the slow ones, of at most seven of a family such as "impacts": 20 s."""
    families: dict[str, list[Capability]] = {}
    for one in capabilities().values():
        if not one.slow:
            families.setdefault(one.name.partition(":")[0], []).append(one)
    chosen = [one for family in families.values() for one in family[:: -(-len(family) // 7)]]
    found = running.run(chosen, seed=1, seconds=120, count=1)
    assert [one for one in found if one.verdict != "right"] == []
    assert {one.capability for one in found} == {one.name for one in chosen}


@pytest.mark.stress
def test_ten_minutes_find_nothing() -> None:
    chosen = list(capabilities().values())
    found = running.run(chosen, seed=2, seconds=600, workers=2)
    assert [one for one in found if one.verdict != "right"] == [], running.table(chosen, found)


def test_a_wrong_answer_with_a_finding_that_takes_trust_is_told() -> None:
    case = capabilities()[NAME].case(1, 2)

    def coarse(model: Model, door: Door) -> np.ndarray:
        door.modes(model, 30)  # bars longer than the waves of the last: coarse-mesh
        return np.zeros(3)

    found = running.judge(NAME, 2, replace(case, asked=coarse))
    assert found.verdict == "told" and "coarse-mesh" in found.words


LEAST = 400  # cells; raised when there are more


def test_cells_that_checks_reach_only_grow() -> None:
    kept = coverage.stored()
    known = {f"{key} | {column}" for key, column in coverage.cells()}
    assert len(set(kept) & known) >= LEAST
    assert {check[0] for check in kept.values()} <= set(capabilities())  # a renamed one draws others: survey it again
    fast = [(cell, check) for cell, check in kept.items() if check[0].startswith(("bars: ", "blocks: "))]
    for cell, check in fast[:: max(1, len(fast) // 8)]:
        assert _reaches(cell, check), cell


@pytest.mark.stress
def test_every_cell_is_still_reached() -> None:
    checks: dict[tuple[Any, ...], list[str]] = {}
    for cell, check in coverage.stored().items():
        checks.setdefault(tuple(check), []).append(cell)
    assert [cell for check, cells in checks.items() for cell in _left_out(cells, check)] == []


def _reaches(cell: str, check: list[Any]) -> bool:
    return not _left_out([cell], check)


def _left_out(cells: Sequence[str], check: Sequence[Any]) -> list[str]:
    """Cells that a check does not reach; it is asked once for all of them."""
    name, seed, index = check
    found = coverage.reached(capabilities()[name], seed, index, frozenset(cell.split(" | ")[0] for cell in cells))
    there = {f"{one.key} | {one.column}" for one in found if one.off <= 1}
    return [cell for cell in cells if cell not in there]


def test_a_cell_is_reached_only_where_the_program_follows() -> None:
    """A program that takes no notice of E: the answer has moved, and it is off."""
    case = capabilities()[NAME].case(1, 0)
    deaf = Capability(NAME, "independent", lambda _: replace(case, asked=lambda _, door: case.asked(case.model, door)))
    found = coverage.reached(deaf, 1, 0, frozenset(("materials.E",)))
    assert [one.off > 10 for one in found] == [True]
