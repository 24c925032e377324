"""From a line of YAML to decibels: functions are called in the order that docs/architecture.md gives."""

import re
import sys
from pathlib import Path
from types import FrameType

import pytest

from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8").split("## Three walks")[1].split("\n## ")[0]
WALKS = {
    key: re.findall(r"^\d+\. `([\w.]+)`: ", steps, re.MULTILINE)
    for key, steps in re.findall(r"^`([\w.]+)`\n\n((?:\d+\. .*\n)+)", PAGE, re.MULTILINE)
}
MOST_STOPS = 10


@pytest.fixture(scope="module")
def calls() -> list[str]:
    """Functions of both packages in the order of their first calls while a study is read and run."""
    first: dict[str, None] = {}

    def note(frame: FrameType, event: str, _: object) -> None:
        module = frame.f_globals.get("__name__", "")
        if event == "call" and module.startswith(("femstruct", "acoustics")):
            first.setdefault(f"{module}.{frame.f_code.co_qualname}")

    study = ROOT / "models" / "floor_tennis_ball.study.yaml"
    sys.setprofile(note)
    try:
        run_study(read_study(study, ("time.duration=0.2 s", "modes.up_to=300 Hz"), only="damper 0.6"))
    finally:
        sys.setprofile(None)
    return list(first)


def test_three_values_are_followed() -> None:
    assert list(WALKS) == ["bodies.damper.mass", "parts.slab.thickness", "rooms.box.losses"]


@pytest.mark.parametrize("key", WALKS)
def test_a_value_goes_forward_only(key: str, calls: list[str]) -> None:
    stops = WALKS[key]
    assert len(stops) <= MOST_STOPS
    missing = [stop for stop in stops if stop not in calls]
    assert not missing, f"docs/architecture.md names functions that are not called: {missing}"
    assert sorted(stops, key=calls.index) == stops
    assert stops[-1].endswith("response_levels")
