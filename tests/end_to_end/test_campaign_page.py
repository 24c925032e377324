"""The page of a campaign says what was asked and found, and shows the pictures; it needs nothing else."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.view.campaign_answers import value_text

MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
STUDY = """
title: A hit <hard>
model: model.yaml
bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
record: {m.z: velocity}
limits: {m.z velocity: 1.2 m/s}
time: {duration: 10 ms, sampling: 10 kHz}
vary: {bodies.ball.mass: {from: 0.5 kg, to: 2 kg, steps: 3}, bodies.ball.contact.stiffness: {values: [1 MN/m, 4 MN/m]}}
optimise:
  maximise: m.z velocity
  limits: {ball on m peak force: 900 N}
  vary: {bodies.ball.mass: {from: 0.5 kg, to: 2 kg}}
  runs: 30
"""


def text_of(page: str) -> str:
    return re.sub(r"<(?!/?(h1|pre)\b)[^>]+>", " ", page)


@pytest.mark.parametrize("what", ["sweep", "optimise"])
def test_page_of_a_campaign(what: str, tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    study = tmp_path / "hit.study.yaml"
    study.write_text(STUDY, encoding="utf-8")
    run = CliRunner().invoke(app, [what, str(study), "-o", str(tmp_path / "out"), "--workers", "1"])
    assert run.exit_code == 0, run.output
    page = (tmp_path / "out" / f"{what}.html").read_text(encoding="utf-8")
    assert f"{what}.html" in run.output and "<h1>A hit &lt;hard&gt;</h1>" in page
    assert "What was asked" in page and "bodies.ball.mass" in page and "hit.study.yaml" in page
    assert page.count("data:image/png;base64,") == 1 and "http" not in re.sub(r"base64,[^\"]*", "", page)
    shown = text_of(page)
    lines = [line for line in run.output.splitlines() if line.startswith(("A hit", "30 designs"))]
    assert lines
    for line in lines:  # what the terminal says stands on the page
        assert " ".join(line.replace("<", "&lt;").replace(">", "&gt;").split()) in " ".join(shown.split())


def test_stiffness_is_written_in_a_unit_that_is_easy_to_read() -> None:
    assert value_text(4e6, "N/m", "") == "4 MN/m" and value_text(2.5e8, "N/m^1.5", "") == "250 MN/m^1.5"
