"""The published schema of summary.json: what runs write fits it, and what does not belong there does not."""

from __future__ import annotations

import json
import runpy
from copy import deepcopy
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.files.study_tables import summary
from femstruct.files.summary_schema import summary_schema
from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

ROOT = Path(__file__).parents[2]
SCHEMA = summary_schema()
FITS = jsonschema.Draft202012Validator(SCHEMA)
# Whatever tests write to results files is compared, too (tests/conftest.py).
# Machines with sags, blocks and repeated blows, a wave, random vibration, stresses, bodies alone.
SHIPPED = ("press", "forging_hammer", "bracket_shaker", "tennis_ball_drop", "pinned_beam_wave")


def mistakes(told: Any) -> list[str]:
    return [f"{'/'.join(map(str, one.absolute_path))}: {one.message[:200]}" for one in FITS.iter_errors(told)]


def written(result: Any) -> Any:
    return json.loads(json.dumps(summary(result), allow_nan=False))


def test_it_is_a_schema_and_printed() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    done = CliRunner().invoke(app, ["schema", "summary"])
    assert done.exit_code == 0 and json.loads(done.stdout) == SCHEMA
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"


@pytest.mark.parametrize("name", SHIPPED)
def test_summaries_of_shipped_studies_fit(name: str) -> None:
    assert mistakes(written(run_study(read_study(ROOT / "models" / f"{name}.study.yaml")))) == []


@pytest.fixture(scope="module")
def by_hand() -> Any:
    return written(runpy.run_path(str(ROOT / "tests" / "data" / "study_by_hand.py"))["study_by_hand"]())


def test_a_summary_by_hand_fits(by_hand: Any) -> None:
    assert mistakes(by_hand) == []


@pytest.mark.parametrize(
    ("place", "value", "told"),
    [
        (("cases", "without damper", "levels", "box.mic", "l_peak_db"), "loud", "is not of type 'number', 'null'"),
        (("cases", "without damper", "contacts", "ball on floor", "colour"), 1.0, "'colour' was unexpected"),
        (("cases", "without damper", "outcome"), "It broke.", "is not one of"),
        (("cases", "without damper", "peaks", "O_f.z velocity"), {}, "'first_impact' is a required property"),
        (("findings",), None, "is not of type 'array'"),
    ],
)
def test_what_does_not_belong_there_is_refused(by_hand: Any, place: tuple[str, ...], value: Any, told: str) -> None:
    changed = deepcopy(by_hand)
    inner = changed
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    assert any(told in one for one in mistakes(changed))


def test_units_and_words_are_those_that_are_declared() -> None:
    levels = SCHEMA["$defs"]["Levels"]["properties"]
    assert levels["l_ae_db"] == {
        "type": ["number", "null"],
        "description": "A-weighted sound exposure level [dB re 20 µPa]",
    }
    assert {"l_ae_db", "bands_db"} <= set(SCHEMA["$defs"]["Levels"]["required"])
