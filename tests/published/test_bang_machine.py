"""The shipped study of the bang machine against the grades that Japanese design data give for slabs of its kind."""

from __future__ import annotations

from pathlib import Path

import pytest

from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

MODELS = Path(__file__).parents[2] / "models"
PUBLISHED = {"150 mm": 60.0, "200 mm": 50.0}  # L-60 and L-50, slabs of 25 m^2 held at four sides


@pytest.mark.parametrize("edges", ["simple", pytest.param("clamped", marks=pytest.mark.stress)])
def test_slabs_have_the_grades_of_the_design_data(edges: str) -> None:
    """Architectural Institute of Japan, as http://www.dab.hi-ho.ne.jp/hirano-j/syaon_yuka.htm quotes it.

    Grades are in steps of 5 dB, and the data do not say what decides between neighbours: how the edges are held, which
    room is below. So one grade to each side. 150 mm come out in the published grade, 200 mm one grade worse;
    against the other table in the study's comment, of slabs of the area here, all three are one grade worse.
    """
    result = run_study(read_study(MODELS / "bang_machine.study.yaml", (f"supports.walls.fix={edges}",)))
    grades = {name: case.rated["bedroom"].numbers["L_i,Fmax,r,H(1)"] for name, case in result.cases.items()}
    for name, published in PUBLISHED.items():
        assert grades[name].value_db == pytest.approx(published, abs=5.0)
    assert grades["150 mm"].unrounded_db > grades["200 mm"].unrounded_db
    for case in result.cases.values():
        numbers = case.rated["bedroom"].numbers
        # the Korean number lets 8 dB exceed the curve, of which at most 8 are in the octave that decides the grade
        above = numbers["L_i,Fmax,r,H(1)"].unrounded_db - numbers["L_i,Fmax,AW"].unrounded_db
        assert 0.0 <= above <= 8.0 + 0.1
        assert not [one for one in case.findings if one.code.startswith("rating-")]
