"""Faults that users found: each `NAME.expect.yaml` in `tests/data/found` is a test, by that alone.

It says what to run and which number of the answer (`--json`) is right; CONTRIBUTING explains its five lines.
"""

from __future__ import annotations

import json
import shlex
import shutil
from pathlib import Path
from typing import Any, Final

import pytest
from ruamel.yaml import YAML

from tests.data.command_line import femstruct

FOUND: Final = Path(__file__).parents[1] / "data" / "found"
END: Final = ".expect.yaml"
KEYS: Final = {"run", "value", "right", "within", "why"}


def fault_of(expected: Path, folder: Path) -> str:
    """What is wrong with a case, "" if nothing is; its command runs in another folder, with copies of the files."""
    told = YAML(typ="safe").load(expected.read_text(encoding="utf-8"))
    if not isinstance(told, dict) or set(told) != KEYS:
        return f"{expected.name}: got {told if not isinstance(told, dict) else sorted(told)}, expected {sorted(KEYS)}"
    words = shlex.split(str(told["run"]))
    missing = [word for word in words if word.endswith(".yaml") and not (expected.parent / word).exists()]
    if missing:
        return f"{expected.name}: {missing[0]} is not in {expected.parent.name}/: put it beside {expected.name}"
    shutil.copytree(expected.parent, folder, dirs_exist_ok=True)
    more = ["--no-pictures", "-o", "out"] if words[0] == "run" else []
    ended = femstruct(*words, *more, "--json", cwd=folder)
    if ended.returncode not in (0, 3):  # 3: right, with a finding that forbids trust
        return f"{expected.name}: '{told['run']}' ended with {ended.returncode}: {ended.stderr.strip()}"
    try:
        got = float(_at(json.loads(ended.stdout), str(told["value"])))
    except (KeyError, TypeError, ValueError) as error:
        return f"{expected.name}: value: {error}"
    try:
        right = float(told["right"])
        within = float(str(told["within"]).removesuffix("%")) / 100.0
    except ValueError as error:
        return f"{expected.name}: {error}, expected 'right' as a number in the unit of the answer, 'within' as '0.5 %'"
    if "%" not in str(told["within"]):
        return f"{expected.name}: within: got {told['within']}, expected a share such as '0.5 %'"
    if abs(got - right) <= within * abs(right):
        return ""
    return (
        f"{expected.name}: {told['value']} is {got:.6g}, right is {right:.6g} within {told['within']} ({told['why']})"
    )


def _at(answer: Any, path: str) -> Any:
    """What stands in an answer at names and numbers (from 0) with / between them."""
    for word in path.split("/"):
        known = [str(one) for one in (range(len(answer)) if isinstance(answer, list) else answer)]
        if word not in known:
            raise KeyError(f"got {word} of {path}, expected one of {', '.join(known)}")
        answer = answer[int(word) if isinstance(answer, list) else word]
    return answer


@pytest.mark.parametrize("name", sorted(path.name.removesuffix(END) for path in FOUND.glob(f"*{END}")))
def test_what_a_user_found_is_right(name: str, tmp_path: Path) -> None:
    fault = fault_of(FOUND / f"{name}{END}", tmp_path / "here")
    assert not fault, fault


def test_every_file_that_is_found_belongs_to_a_test() -> None:
    """A model put there without a right value would be tested by nobody."""
    said = " ".join(path.read_text(encoding="utf-8") for path in FOUND.glob("*.yaml"))
    unused = [path.name for path in FOUND.iterdir() if not path.name.endswith(END) and path.name not in said]
    assert not unused, f"{unused}: named by no *{END}"


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("right: 5.0e-4", "right: 5.2e-4", "points/pushed/4 is 0.0005002"),
        ("right: 5.0e-4", "right: 0", "right is 0 within"),
        ("shear_of_a_foundation.yaml", "other.yaml", "other.yaml is not in cases/"),
        ("points/pushed/4", "points/pulled/4", "got pulled of points/pulled/4, expected one of pushed"),
        ("points/pushed/4", "points/pushed", "value: "),
        ("pushed.x=10 kN", "pulled.x=10 kN", "ended with 2"),
        ("right: 5.0e-4", "right: 0.5 mm", "expected 'right' as a number in the unit of the answer"),
        (" %", "", "expected a share such as '0.5 %'"),
        ("within:", "about:", "expected ['right', 'run', 'value', 'why', 'within']"),
    ],
)
def test_the_door_is_red_where_it_should_be(tmp_path: Path, old: str, new: str, told: str) -> None:
    cases = tmp_path / "cases"
    cases.mkdir()
    name = f"shear_of_a_foundation{END}"
    shutil.copy(FOUND / "shear_of_a_foundation.yaml", cases)
    text = (FOUND / name).read_text(encoding="utf-8")
    assert old in text
    (cases / name).write_text(text.replace(old, new), encoding="utf-8")
    assert told in fault_of(cases / name, tmp_path / "here")
